//! Tables of traces as trajectories: who is where in which frame. Formats of pedestrian dynamics hold these alone.
//!
//! A frame is a row of time, from 0. Agents have ids from 1 in the order in which they come first, as
//! [`crate::data::tracks`] numbers them when it reads names.

use super::column::Value;
use super::format::Table;
use crate::base::geometry::Vec2;
use std::collections::BTreeMap;
use std::io;

/// An agent in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Number of the frame, from 0.
    pub(super) frame: i64,
    /// Number of the agent, from 1.
    pub(super) id: i64,
    /// Position, m.
    pub(super) position: Vec2,
    /// Velocity, m/s.
    #[cfg_attr(not(feature = "sqlite"), allow(dead_code, reason = "only SQLite has directions"))]
    pub(super) velocity: Vec2,
}

/// Makes points of rows.
pub(super) struct Trajectory {
    /// Seconds between two frames.
    interval: f64,
    time: usize,
    trial: usize,
    agent: usize,
    numbers: [usize; 4],
    ids: BTreeMap<String, i64>,
    /// The trial of the first row.
    known: Option<i64>,
}

impl Trajectory {
    /// Of a table.
    ///
    /// # Errors
    /// Where the table has no positions or no steady rate.
    pub(super) fn new(table: &Table) -> io::Result<Self> {
        let place = |name: &str| table.place(name).ok_or_else(|| refuse(format!("no column `{name}`")));
        if table.interval <= 0.0 {
            return Err(refuse("frames need a time between two rows that is always the same".to_owned()));
        }
        Ok(Self {
            interval: table.interval,
            time: place("time")?,
            trial: place("trial")?,
            agent: place("agent")?,
            numbers: [place("x")?, place("y")?, place("vx")?, place("vy")?],
            ids: BTreeMap::new(),
            known: None,
        })
    }

    /// The trial of the first row.
    #[cfg(feature = "sqlite")]
    pub(super) fn trial(&self) -> Option<i64> {
        self.known
    }

    /// The point of a row; `None` where its agent is absent.
    ///
    /// # Errors
    /// A row of a second trial.
    pub(super) fn point(&mut self, row: &[Value<'_>]) -> io::Result<Option<Point>> {
        if let Value::Whole(trial) = row[self.trial]
            && *self.known.get_or_insert(trial) != trial
        {
            return Err(refuse("the format holds one trial".to_owned()));
        }
        let number = |place: usize| match row[place] {
            Value::Number(number) => number,
            _ => f64::NAN,
        };
        let [x, y, vx, vy] = self.numbers.map(number);
        let Value::Word(name) = &row[self.agent] else { return Ok(None) };
        if x.is_nan() || y.is_nan() {
            return Ok(None);
        }
        let next = self.ids.len() as i64 + 1;
        let id = match self.ids.get(name.as_ref()) {
            Some(id) => *id,
            None => *self.ids.entry(name.to_string()).or_insert(next),
        };
        let frame = (number(self.time) / self.interval).round() as i64;
        Ok(Some(Point { frame, id, position: Vec2::new(x, y), velocity: Vec2::new(vx, vy) }))
    }
}

fn refuse(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}
