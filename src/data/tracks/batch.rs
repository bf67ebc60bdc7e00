//! Observations of one time and one sensor: the form in which traces are inferred from all sources.

use super::recording::{Recording, Velocity};
use crate::base::geometry::Vec2;
use std::collections::BTreeMap;

/// One person seen at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observation {
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s, if the sensor measures it.
    pub velocity: Option<Vec2>,
    /// Who it is, if that is known.
    pub id: Option<u32>,
}

/// What one sensor saw at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// Time, s.
    pub time: f64,
    /// Name of the sensor.
    pub sensor: Option<String>,
    /// Everybody whom it saw.
    pub seen: Vec<Observation>,
    /// Corners of the polygon that it can see, m; at least three.
    pub field: Option<Vec<Vec2>>,
}

impl Recording {
    /// One batch for each annotated frame, in the order of time, with ids ascending.
    ///
    /// Only recorded velocities are given. A seen velocity is the difference from the last position of a trace, so it
    /// belongs to whoever infers the trace.
    pub fn batches(&self) -> Vec<Batch> {
        let mut seen: BTreeMap<u32, Vec<Observation>> =
            self.frames().iter().map(|frame| (*frame, Vec::new())).collect();
        for person in self.people() {
            for sample in &person.samples {
                let velocity = sample.velocity.filter(|_| self.velocity() == Velocity::Recorded);
                let observation = Observation { position: sample.position, velocity, id: Some(person.id) };
                seen.entry(sample.frame).or_default().push(observation);
            }
        }
        let batch = |(frame, seen)| Batch { time: self.time_of(frame), sensor: None, seen, field: None };
        seen.into_iter().map(batch).collect()
    }
}

impl Batch {
    /// The batch without ids.
    #[must_use]
    pub fn anonymous(mut self) -> Self {
        self.seen.iter_mut().for_each(|observation| observation.id = None);
        self
    }
}
