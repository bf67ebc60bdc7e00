//! The laws of a site: how the heading and the speed of its people change over the predicted time.
//!
//! They are the recorded changes themselves, so that they have the tails of the site: some turn, stop or hurry, whom no normal
//! law knows. Left and right are alike, so each turn counts to both sides.

use super::Calibration;
use crate::base::geometry::cross;
use crate::base::math::atan2;
use crate::compile::Site;
use crate::model::{Family, Law};
use crate::replay::evaluate::PREDICTED;
use crate::replay::instants::Instant;
use crate::replay::situation::Replay;

/// Slower than this nobody has a heading, m/s.
const STANDS: f64 = 0.05;

/// Turns, rad, and mean speeds over the present one, of some people.
pub(super) fn changes(replay: &Replay, people: &[Instant]) -> (Vec<f64>, Vec<f64>) {
    let (mut turns, mut paces) = (Vec::new(), Vec::new());
    for Instant { time, person } in people {
        let now = replay.recording.person_at(*person, *time);
        let then = replay.place_at(*person, time + PREDICTED);
        let (Some(now), Some(then)) = (now, then) else { continue };
        let (way, speed) = (then - now.position, now.velocity.norm());
        if speed > STANDS {
            paces.push(way.norm() / PREDICTED / speed);
            if way.norm() > STANDS * PREDICTED {
                turns.push(atan2(cross(now.velocity, way), now.velocity.dot(&way)));
            }
        }
    }
    turns.sort_by(f64::total_cmp);
    paces.sort_by(f64::total_cmp);
    (turns, paces)
}

/// The laws of these changes.
pub(super) fn laws(turns: &[f64], paces: &[f64]) -> Option<Site> {
    let both: Vec<f64> = turns.iter().flat_map(|turn| [-turn.abs(), turn.abs()]).collect();
    Some(Site { turn: one_of(both)?, pace: one_of(paces.to_vec())? })
}

/// One of some values, all alike; `None` without any.
fn one_of(mut values: Vec<f64>) -> Option<Law> {
    values.sort_by(f64::total_cmp);
    let weight = 1.0 / values.len() as f64;
    let mut options: Vec<(f64, f64)> = Vec::new();
    for value in values {
        match options.last_mut().filter(|last| last.0.total_cmp(&value).is_eq()) {
            Some(last) => last.1 += weight,
            None => options.push((value, weight)),
        }
    }
    let family = Family::Choice(options);
    let law = Law::Random { family, low: f64::NEG_INFINITY, high: f64::INFINITY };
    law.validate().is_ok().then_some(law)
}

impl Calibration {
    /// The laws of the site.
    pub fn site(&self) -> Option<Site> {
        laws(&self.turns, &self.paces)
    }
}
