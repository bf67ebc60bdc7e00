//! Batches of one time, from several sensors, as cycles of an adviser.
//!
//! A cycle is complete when all sensors that were heard in the one before, or just after it, have been heard, or a later
//! batch comes. No clock is read, so the same lines give the same cycles. With one sensor each batch is a cycle of its
//! own, at once.

use super::clock::{Clocks, Timing};
use crate::base::visible::{shortened, visible};
use crate::data::tracks::Batch;

/// Most sensors of a cycle.
const MOST_SENSORS: usize = 256;

/// Batches waiting for others of their time.
#[derive(Clone, Debug, Default)]
pub struct Cycles {
    waiting: Vec<Batch>,
    /// The sensors of the last complete cycle.
    sensors: Vec<Option<String>>,
    /// Time of the last complete cycle, s.
    last: Option<f64>,
    clocks: Clocks,
    /// Whether it was said that there are too many sensors.
    is_full: bool,
}

/// The effect of a batch.
#[derive(Clone, Debug, Default)]
pub struct Pushed {
    /// The cycles that are complete now.
    pub complete: Vec<Vec<Batch>>,
    /// Why the batch is not used, or which clock is followed.
    pub note: Option<String>,
    /// Whether the note must not wait for the next cycle, which may never come.
    pub is_urgent: bool,
}

impl Cycles {
    /// Takes a batch.
    pub fn push(&mut self, batch: Batch) -> Pushed {
        let mut pushed = Pushed::default();
        let now = self.waiting.first().map(|first| first.time).or(self.last);
        let (of, at) = (sensor(&batch), seconds(batch.time));
        match self.clocks.read(batch.sensor.as_deref().unwrap_or_default(), batch.time, now) {
            Timing::InStep => {}
            Timing::Jumped { by, is_new, is_scaled } => {
                let far = seconds(by.abs());
                let side = if by > 0.0 { "after" } else { "before" };
                let unit = if is_scaled { "; is `t` in ms?" } else { "" };
                let said = format!("a batch{of} at {at} is {far} {side} the last one and is left out{unit}");
                return Pushed { note: is_new.then(|| shortened(said)), is_urgent: is_new, ..pushed };
            }
            Timing::Followed => {
                pushed.complete.extend(self.finish());
                (self.last, self.sensors) = (None, Vec::new());
                let said = format!("the clock{of} stays at {at} and is followed; traces begin anew");
                (pushed.note, pushed.is_urgent) = (Some(shortened(said)), true);
            }
        }
        if let Some((note, is_urgent)) = self.unused(&batch) {
            return Pushed { note: Some(shortened(note)), is_urgent, ..pushed };
        }
        if self.waiting.first().is_some_and(|first| batch.time > first.time) {
            pushed.complete.extend(self.finish());
        }
        self.waiting.push(batch);
        let is_heard = |sensor| self.waiting.iter().any(|batch| &batch.sensor == sensor);
        if self.sensors.iter().all(is_heard) {
            pushed.complete.extend(self.finish());
        }
        pushed
    }

    /// Why a batch in step with the others is not used, and whether that must be said at once.
    fn unused(&mut self, batch: &Batch) -> Option<(String, bool)> {
        let now = self.waiting.first().map(|first| first.time);
        let newest = now.or(self.last).filter(|newest| batch.time <= *newest)?;
        let (of, at, last) = (sensor(batch), seconds(batch.time), seconds(newest));
        if batch.time < newest {
            return Some((format!("a batch{of} at {at} came after one at {last} and is left out"), false));
        }
        let (is_heard, count) = match now {
            Some(_) => (self.waiting.iter().any(|other| other.sensor == batch.sensor), self.waiting.len()),
            None => (self.sensors.contains(&batch.sensor), self.sensors.len()),
        };
        if is_heard {
            return Some((format!("the batch{of} at {at} was repeated"), false));
        }
        if count >= MOST_SENSORS {
            let said = format!("more than {MOST_SENSORS} sensors at {at}: the batch{of} is left out");
            return Some((said, !std::mem::replace(&mut self.is_full, true)));
        }
        if now.is_some() {
            return None;
        }
        // A sensor that is heard for the first time just after a cycle is waited for in the next one.
        self.sensors.push(batch.sensor.clone());
        Some((format!("a batch{of} at {at} came after its cycle and is left out"), false))
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

/// The sensor of a batch in a note.
fn sensor(batch: &Batch) -> String {
    batch.sensor.as_deref().map_or(String::new(), |name| format!(" of `{}`", visible(name)))
}

/// A time in a note.
fn seconds(time: f64) -> String {
    let rounded = (time * 1e3).round() / 1e3;
    format!("{} s", if rounded.is_finite() { rounded } else { time })
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
            let Pushed { complete, note, .. } = cycles.push(batch(time, sensor));
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

    /// Times of the cycles of one or several sensors, and how many notes could not wait.
    fn run(batches: impl IntoIterator<Item = (f64, &'static str)>) -> (Vec<f64>, Vec<String>) {
        let (mut cycles, mut times, mut urgent) = (Cycles::default(), Vec::new(), Vec::new());
        for (time, sensor) in batches {
            let pushed = cycles.push(batch(time, sensor));
            times.extend(pushed.complete.iter().map(|cycle| cycle[0].time));
            urgent.extend(pushed.note.filter(|_| pushed.is_urgent));
        }
        times.extend(cycles.finish().map(|cycle| cycle[0].time));
        (times, urgent)
    }

    fn steps(count: u32, from: f64, step: f64) -> impl Iterator<Item = f64> {
        (0..count).map(move |k| from + step * f64::from(k))
    }

    #[test]
    fn one_wrong_time_is_left_out() {
        for wrong in [1000.0, 1e300, -1e300, 9.0, -700.0] {
            for sensor in ["a", "b"] {
                let lines = steps(40, 0.0, 0.4).enumerate().flat_map(|(k, t)| {
                    let wrong = (k == 12).then_some((wrong, sensor));
                    wrong.into_iter().chain([(t, "a")])
                });
                let (times, urgent) = run(lines);
                assert_eq!(times, steps(40, 0.0, 0.4).collect::<Vec<_>>(), "{wrong} {sensor}");
                assert_eq!(urgent.len(), 1, "{urgent:?}");
                assert!(urgent[0].len() < 90 && urgent[0].contains("is left out"), "{urgent:?}");
            }
        }
    }

    #[test]
    fn a_clock_that_stays_at_its_new_time_is_followed() {
        for from in [0.0, 500.0] {
            let alone = steps(50, 0.0, 0.4).chain(steps(20, from, 0.4)).map(|t| (t, "a"));
            let (times, urgent) = run(alone);
            assert_eq!((times.len(), urgent.len()), (69, 2), "{from} {urgent:?}");
            // Both sensors at once: the second one confirms the first.
            let both = |t: f64| [(t, "a"), (t, "b")];
            let (times, urgent) = run(steps(50, 0.0, 0.4).chain(steps(20, from, 0.4)).flat_map(both));
            assert_eq!((times.len(), urgent.len()), (70, 2), "{from} {times:?}");
            // The other sensor is silent: 2 s are lost.
            let a = steps(20, from, 0.4).map(|t| (t, "a"));
            let (times, urgent) = run(steps(50, 0.0, 0.4).flat_map(both).chain(a));
            assert_eq!((times.len(), urgent.len()), (50 + 15, 2), "{from} {times:?}");
        }
    }

    #[test]
    fn no_sensor_silences_another_one() {
        for of_b in [(0.0, 400.0), (0.0, 40.0), (1e9, 0.4), (-50.0, 0.4), (30.0, 0.05)] {
            for b_is_first in [false, true] {
                let lines = steps(50, 0.0, 0.4).enumerate().flat_map(|(k, t)| {
                    let b = (of_b.0 + of_b.1 * k as f64, "b");
                    if b_is_first && k > 0 { [b, (t, "a")] } else { [(t, "a"), b] }
                });
                let (times, urgent) = run(lines);
                let of_a = times.iter().filter(|time| steps(50, 0.0, 0.4).any(|t| t == **time));
                assert!(of_a.count() == 50 && urgent.len() <= 3, "{of_b:?} {times:?} {urgent:?}");
            }
        }
        // The wrong clock is there first, and alone.
        let late = steps(5, 0.0, 400.0).map(|t| (t, "b"));
        let lines = late.chain(
            steps(50, 0.0, 0.4).enumerate().flat_map(|(k, t)| [(2000.0 + 400.0 * k as f64, "b"), (t, "a")]),
        );
        let (times, urgent) = run(lines);
        assert!(times.iter().filter(|time| **time < 20.0).count() >= 40, "{times:?} {urgent:?}");
    }

    #[test]
    fn milliseconds_are_asked_about_and_used() {
        let (times, urgent) = run(steps(10, 0.0, 400.0).map(|t| (t, "a")));
        assert_eq!((times.len(), urgent.len()), (9, 2), "{urgent:?}");
        assert!(urgent[0].ends_with("is `t` in ms?"), "{urgent:?}");
    }

    #[test]
    fn sensors_are_counted() {
        let mut cycles = Cycles::default();
        let pushed: Vec<Pushed> = (0..2000).map(|k| cycles.push(batch(0.0, &k.to_string()))).collect();
        assert_eq!(pushed.iter().filter(|pushed| pushed.is_urgent).count(), 1);
        assert!(cycles.sensors.len() <= MOST_SENSORS && pushed[1999].note.as_ref().unwrap().contains("256"));
        let hidden = cycles.push(batch(0.0, "\u{202e}x")).note.unwrap();
        assert!(hidden.contains("`\\u{202e}x`"), "{hidden}");
    }
}
