//! Inference of traces from observations (Given-Wilson, Legay, Sedwards, Zendra, "Modelling of Machine-Aided Human
//! Group Motion", 2017, Algorithm 2), one time after the other.

use super::assignment::{Costs, assign_some};
use super::fusion::{Fused, fuse};
use super::motion::Motion;
use super::near;
use super::trace::{Trace, TracePoint, distance};
use crate::base::geometry::Vec2;
use crate::data::tracks::Batch;
use std::collections::BTreeMap;

/// Times that differ by less are equal, s: sums of steps are not exact.
const ROUNDING: f64 = 1e-6;
/// More than any assignment can cost.
const NEVER: f64 = 1e9;

/// What happens where there are more observations than traces, or fewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Padding {
    /// Pairs beyond the threshold are no pairs.
    ///
    /// Leaving an observation and a trace unmatched costs the threshold together.
    #[default]
    Gated,
    /// As published: dummy entries at the largest distance.
    ///
    /// The threshold comes after the assignment. It can exchange people when one leaves as another enters.
    Printed,
}

/// Options of a [`Tracker`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    /// Largest distance `D_trace` of an observation from the projection of its trace, m.
    pub threshold: f64,
    /// Longest time of a projection, s.
    pub longest: f64,
    /// Divides differences of velocity in `D_trace`.
    pub discount: f64,
    /// How unequal numbers are treated.
    pub padding: Padding,
    /// Largest `D_trace` of two observations of one person by different sensors, m.
    pub sensors_within: f64,
    /// Added to the distance for each second between the end of a trace and the last step, m/s: of two traces that are
    /// equally near, the one seen later is continued. Algorithm 2 has 0, and so has the published padding.
    pub waiting: f64,
    /// How many points a trace keeps at least; `None` for all. With a number, memory stays bounded.
    pub kept: Option<usize>,
}

impl Default for Tracking {
    fn default() -> Self {
        Self {
            threshold: 0.9,
            longest: 2.0,
            discount: 2.0,
            padding: Padding::Gated,
            sensors_within: 0.3,
            waiting: 0.2,
            kept: None,
        }
    }
}

/// Why observations were not used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrackingError {
    /// Batches at or before the time of the last ones.
    #[error("observations at {time} s came after those at {last} s")]
    Late {
        /// Their time, s.
        time: f64,
        /// The last time, s.
        last: f64,
    },
    /// Batches of different times.
    #[error("the batches of one step have the times {0} s and {1} s")]
    Mixed(f64, f64),
}

/// Active and ended traces.
#[derive(Clone, Debug)]
pub struct Tracker {
    options: Tracking,
    active: Vec<Trace>,
    ended: Vec<Trace>,
    next: u64,
    last: Option<f64>,
}

impl Tracker {
    /// A tracker that has seen nobody.
    pub const fn new(options: Tracking) -> Self {
        Self { options, active: Vec::new(), ended: Vec::new(), next: 1, last: None }
    }

    /// The active traces, by ascending number. Those seen at the last step end at its time.
    pub fn active(&self) -> &[Trace] {
        &self.active
    }

    /// Takes out the traces that have ended since the last call. Who never calls keeps them all.
    pub fn take_ended(&mut self) -> Vec<Trace> {
        std::mem::take(&mut self.ended)
    }

    /// Ends all traces: the next batches may be at any time.
    pub fn restart(&mut self) {
        self.ended.append(&mut self.active);
        self.last = None;
    }

    /// The time of the last step, s.
    pub const fn last(&self) -> Option<f64> {
        self.last
    }

    /// Continues the traces with all batches of one time; returns the number of the trace of each observation, for each
    /// batch; two observations of one batch at one place are one person. An empty list of batches changes nothing; a batch in which nobody is seen lets time pass.
    ///
    /// # Errors
    /// Batches that are not later than the last step, or of different times; they are not used.
    pub fn step(
        &mut self,
        batches: &[Batch],
        motion: &mut dyn Motion,
    ) -> Result<Vec<Vec<u64>>, TrackingError> {
        let Some(time) = batches.first().map(|batch| batch.time) else { return Ok(Vec::new()) };
        if let Some(other) = batches.iter().find(|batch| batch.time != time) {
            return Err(TrackingError::Mixed(time, other.time));
        }
        if let Some(last) = self.last.filter(|last| *last >= time || time.is_nan()) {
            return Err(TrackingError::Late { time, last });
        }
        let before = self.last.replace(time).unwrap_or(time);
        let (old, active) = std::mem::take(&mut self.active)
            .into_iter()
            .partition(|trace| time - trace.end().time > self.options.longest + ROUNDING);
        self.active = active;
        self.ended.extend::<Vec<Trace>>(old);
        let (people, places) = fuse(batches, self.options.sensors_within, self.options.discount);
        let ends: Vec<TracePoint> = self.active.iter().map(Trace::end).collect();
        let projected = motion.project(&ends, time);
        let assigned = self.assign(&people, &projected, before);
        let numbers: Vec<u64> =
            people.iter().zip(assigned).map(|(one, to)| self.append(one, to, time)).collect();
        Ok(places.iter().map(|place| place.iter().map(|k| numbers[*k]).collect()).collect())
    }

    /// The active trace of each person, by its place; `before` is the time of the last step.
    fn assign(&self, people: &[Fused], projected: &[TracePoint], before: f64) -> Vec<Option<usize>> {
        let owner: BTreeMap<u32, usize> =
            self.active.iter().enumerate().filter_map(|(k, trace)| Some((trace.person?, k))).collect();
        let mut assigned: Vec<Option<usize>> =
            people.iter().map(|one| owner.get(&one.mean.id?).copied()).collect();
        let mut is_free = vec![true; self.active.len().min(projected.len())];
        assigned.iter().flatten().for_each(|k| is_free[*k] = false);
        let open: Vec<usize> = (0..people.len()).filter(|i| assigned[*i].is_none()).collect();
        let free: Vec<usize> = (0..is_free.len()).filter(|k| is_free[*k]).collect();
        for (i, k) in self.pairs(people, projected, &open, &free, before) {
            assigned[i] = Some(k);
        }
        assigned
    }

    /// Pairs of an open person and a free trace.
    fn pairs(
        &self,
        people: &[Fused],
        projected: &[TracePoint],
        open: &[usize],
        free: &[usize],
        before: f64,
    ) -> Vec<(usize, usize)> {
        let Tracking { threshold, discount, padding, waiting, .. } = self.options;
        let apart = |i: usize, j: usize| {
            let (one, point) = (&people[open[i]].mean, &projected[free[j]]);
            if one.id.is_some() && self.active[free[j]].person.is_some() {
                return NEVER;
            }
            let waited = before - self.active[free[j]].end().time;
            let waited = if padding == Padding::Gated { waited } else { 0.0 };
            waiting * waited
                + distance((one.position, one.velocity), (point.position, point.velocity), discount)
        };
        // The smaller side is assigned as a whole, and dummy entries of equal cost do not move the least sum. A pair
        // that costs the threshold is then as good as leaving both unmatched.
        let pairs = match padding {
            Padding::Printed => Costs::of(open.len(), free.len(), apart).assign(),
            Padding::Gated => {
                let seen: Vec<Vec2> = open.iter().map(|i| people[*i].mean.position).collect();
                let expected: Vec<Vec2> = free.iter().map(|k| projected[*k].position).collect();
                let near = near::pairs(&seen, &expected, threshold).into_iter();
                let possible: Vec<_> =
                    near.map(|(i, j)| (i, j, apart(i, j))).filter(|pair| pair.2 <= threshold).collect();
                assign_some(open.len(), free.len(), &possible, threshold)
            }
        };
        let near = |(i, j): (usize, Option<usize>)| {
            j.filter(|j| apart(i, *j) <= threshold).map(|j| (open[i], free[j]))
        };
        pairs.into_iter().enumerate().filter_map(near).collect()
    }

    /// Appends a person to an active trace or to a new one; returns its number.
    fn append(&mut self, one: &Fused, to: Option<usize>, time: f64) -> u64 {
        let (position, velocity) = (one.mean.position, one.mean.velocity);
        let Some(trace) = to.and_then(|k| self.active.get_mut(k)) else {
            let number = self.next;
            self.next += 1;
            let points = vec![TracePoint { time, position, velocity }];
            self.active.push(Trace { number, person: one.mean.id, since: time, points });
            return number;
        };
        let end = trace.end();
        let seen = (position - end.position) / (time - end.time);
        trace.points.push(TracePoint { time, position, velocity: velocity.or(Some(seen)) });
        trace.person = trace.person.or(one.mean.id);
        if let Some(kept) = self.options.kept.map(|kept| kept.max(1))
            && trace.points.len() >= kept.saturating_mul(2)
        {
            trace.points.drain(..trace.points.len() - kept);
        }
        trace.number
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion::ConstantVelocity;
    use super::*;
    use crate::data::tracks::Observation;

    fn step(tracker: &mut Tracker, time: f64, seen: &[(f64, Option<u32>)]) -> Vec<u64> {
        let one =
            |&(x, id): &(f64, Option<u32>)| Observation { position: Vec2::new(x, 0.0), velocity: None, id };
        let batch = Batch { time, seen: seen.iter().map(one).collect(), ..Batch::default() };
        tracker.step(&[batch], &mut ConstantVelocity).unwrap().remove(0)
    }

    #[test]
    fn traces_are_continued_and_velocities_are_differences() {
        let mut tracker = Tracker::new(Tracking::default());
        assert_eq!(step(&mut tracker, 0.0, &[(0.0, None), (5.0, None)]), [1, 2]);
        assert_eq!(step(&mut tracker, 0.4, &[(4.9, None), (0.5, None)]), [2, 1]);
        assert_eq!(tracker.active()[0].end().velocity, Some(Vec2::new(1.25, 0.0)));
        assert_eq!(step(&mut tracker, 0.8, &[(1.0, None)]), [1]);
        // Projected over 1.2 s, the second is where it was last seen, a little farther on.
        assert_eq!(step(&mut tracker, 1.6, &[(4.6, None)]), [2]);
        assert_eq!(step(&mut tracker, 9.0, &[(4.6, None)]), [3]);
        assert_eq!(tracker.take_ended().len(), 2);
    }

    #[test]
    fn the_printed_padding_exchanges_people_and_the_gate_does_not() {
        // One stays near 0, one leaves at 0.8 and one enters at -0.8: the published sum is less if both move on.
        let sum = |padding| {
            let mut tracker = Tracker::new(Tracking { padding, ..Tracking::default() });
            step(&mut tracker, 0.0, &[(0.0, None), (0.8, None)]);
            step(&mut tracker, 0.4, &[(0.1, None), (-0.8, None)])
        };
        assert_eq!(sum(Padding::Gated), [1, 3]);
        assert_eq!(sum(Padding::Printed), [2, 1]);
    }

    #[test]
    fn an_id_pins_its_trace() {
        let mut tracker = Tracker::new(Tracking::default());
        assert_eq!(step(&mut tracker, 0.0, &[(0.0, Some(7)), (1.0, None)]), [1, 2]);
        // The device has moved far, and another person stands where it was.
        assert_eq!(step(&mut tracker, 0.4, &[(0.0, None), (3.0, Some(7))]), [3, 1]);
        // Without its device the person is seen by place.
        assert_eq!(step(&mut tracker, 0.8, &[(6.0, None), (3.0, Some(8))]), [1, 4]);
        assert_eq!(tracker.active()[1].person, None);
    }

    #[test]
    fn late_batches_are_refused_and_memory_is_bounded() {
        let mut tracker = Tracker::new(Tracking { kept: Some(3), ..Tracking::default() });
        for k in 0..1000 {
            step(&mut tracker, f64::from(k), &[(0.0, None)]);
            assert!(tracker.active()[0].points.len() < 6);
        }
        let late = Batch { time: 3.0, ..Batch::default() };
        assert!(matches!(tracker.step(&[late], &mut ConstantVelocity), Err(TrackingError::Late { .. })));
        let mixed = [Batch { time: 2000.0, ..Batch::default() }, Batch { time: 2001.0, ..Batch::default() }];
        assert!(matches!(tracker.step(&mixed, &mut ConstantVelocity), Err(TrackingError::Mixed(..))));
        assert_eq!(tracker.active()[0].since, 0.0);
    }
}
