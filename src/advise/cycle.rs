//! Batches of one time, from several sensors, as cycles of an adviser.
//!
//! A cycle is complete when all sensors that were heard in the one before, or just after it, have been heard, or a later
//! batch comes. No clock is read, so the same lines give the same cycles. With one sensor each batch is a cycle of its
//! own, at once.

use crate::data::tracks::Batch;

/// Batches waiting for others of their time.
#[derive(Clone, Debug, Default)]
pub struct Cycles {
    waiting: Vec<Batch>,
    /// The sensors of the last complete cycle.
    sensors: Vec<Option<String>>,
    /// Time of the last complete cycle, s.
    last: Option<f64>,
}

impl Cycles {
    /// Takes a batch; the cycles that are complete now, and a word where the batch is not used.
    pub fn push(&mut self, batch: Batch) -> (Vec<Vec<Batch>>, Option<String>) {
        let mut complete = Vec::new();
        let now = self.waiting.first().map(|first| first.time);
        let newest = now.or(self.last);
        let is_next = newest.is_none_or(|newest| batch.time > newest);
        if !is_next && now != Some(batch.time) {
            let of = batch.sensor.as_deref().map_or(String::new(), |name| format!(" of `{name}`"));
            let last = newest.unwrap_or(batch.time);
            // A sensor that is heard for the first time just after a cycle is waited for in the next one.
            if now.is_none() && self.last == Some(batch.time) {
                if self.sensors.contains(&batch.sensor) {
                    return (complete, Some(format!("the batch at {last} s was repeated")));
                }
                self.sensors.push(batch.sensor);
                return (
                    complete,
                    Some(format!("a batch{of} at {last} s came after its cycle and is left out")),
                );
            }
            let said = format!("a batch{of} at {} s came after one at {last} s and is left out", batch.time);
            return (complete, Some(said));
        }
        if now == Some(batch.time) && self.waiting.iter().any(|other| other.sensor == batch.sensor) {
            return (complete, Some(format!("the batch at {} s was repeated", batch.time)));
        }
        if is_next {
            complete.extend(self.finish());
        }
        self.waiting.push(batch);
        let is_heard = |sensor| self.waiting.iter().any(|batch| &batch.sensor == sensor);
        if self.sensors.iter().all(is_heard) {
            complete.extend(self.finish());
        }
        (complete, None)
    }

    /// What still waits, as the last cycle.
    pub fn finish(&mut self) -> Option<Vec<Batch>> {
        let cycle = std::mem::take(&mut self.waiting);
        self.last = cycle.first().map(|first| first.time).or(self.last);
        if cycle.is_empty() {
            return None;
        }
        self.sensors = cycle.iter().map(|batch| batch.sensor.clone()).collect();
        Some(cycle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(time: f64, sensor: &str) -> Batch {
        Batch { time, sensor: Some(sensor.to_owned()), ..Batch::default() }
    }

    #[test]
    fn a_cycle_waits_for_the_sensors_of_the_last_one() {
        let mut cycles = Cycles::default();
        let mut push = |time, sensor: &str| {
            let (complete, note) = cycles.push(batch(time, sensor));
            (complete.iter().map(Vec::len).collect::<Vec<_>>(), note.is_some())
        };
        assert_eq!(push(0.0, "a"), (vec![1], false));
        // A second sensor: too late for the first cycle, and waited for in the second.
        assert_eq!(push(0.0, "b"), (vec![], true));
        assert_eq!(push(0.4, "a"), (vec![], false), "`b` was heard and is waited for");
        assert_eq!(push(0.4, "a"), (vec![], true), "repeated");
        assert_eq!(push(0.4, "b"), (vec![2], false));
        assert_eq!(push(0.8, "a"), (vec![], false));
        // `b` is silent: a later batch ends the cycle, and is one, as only `a` was heard.
        assert_eq!(push(1.2, "a"), (vec![1, 1], false));
        assert_eq!(push(1.0, "a"), (vec![], true), "late");
        assert_eq!(cycles.finish(), None);
    }
}
