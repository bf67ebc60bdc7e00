//! Plans: which units the shards of a round consist of.

use super::Origin;
use super::unit::{Trials, Unit};
use crate::base::lanes::LANES;
use serde::{Deserialize, Serialize};

/// A slice of a unit is at least such a part of a shard: each world takes time to be made ready.
const PARTS: u64 = 16;
/// A shard takes at least so long where that is known, s: what a queue does for it takes time too.
const SHORT: f64 = 1.0;
/// A unit that so many shards did not bring back is given up.
const MOST_ATTEMPTS: u32 = 3;

/// The shards of a round.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// What is to be run.
    pub origin: Origin,
    /// Number of the round in its folder, from 1.
    pub round: u64,
    /// Largest number of trials of a query.
    pub max_trials: u64,
    /// The units of each shard.
    pub shards: Vec<Vec<Unit>>,
}

/// Units that shards did not bring back, and how often.
#[derive(Clone, Debug, Default)]
pub struct Attempts(pub Vec<(Unit, u32)>);

impl Attempts {
    /// Shards did not bring these back.
    pub fn fail(&mut self, shards: &[&[Unit]]) {
        for unit in shards.iter().copied().flatten() {
            match self.0.iter_mut().find(|(known, _)| known == unit) {
                Some((_, times)) => *times += 1,
                None => self.0.push((unit.clone(), 1)),
            }
        }
    }

    /// The units that are given up.
    pub fn given_up(&self) -> Vec<Unit> {
        self.0.iter().filter(|(_, times)| *times >= MOST_ATTEMPTS).map(|(unit, _)| unit.clone()).collect()
    }

    /// What is left of a wanted unit, and which of it was tried before: without what is given up and what follows that.
    fn pieces(&self, unit: &Unit) -> Vec<(Unit, bool)> {
        let Unit::Trials(trials) = unit else {
            let times = self.0.iter().find(|(known, _)| known == unit).map_or(0, |(_, times)| *times);
            return (times < MOST_ATTEMPTS).then(|| (unit.clone(), times > 0)).into_iter().collect();
        };
        let failed: Vec<(&Trials, u32)> = (self.0.iter())
            .filter_map(|(known, times)| match known {
                Unit::Trials(known) => Some((known, *times)),
                Unit::Run(_) => None,
            })
            .filter(|(known, _)| (known.world, known.advice) == (trials.world, trials.advice))
            .collect();
        let mut ends: Vec<u64> = failed.iter().flat_map(|(known, _)| [known.from, known.to]).collect();
        ends.retain(|end| (trials.from + 1..trials.to).contains(end));
        ends.extend([trials.from, trials.to]);
        ends.sort_unstable();
        let piece = |ends: &[u64]| {
            let (from, to) = (ends[0], ends[1]);
            let around = failed.iter().filter(|(known, _)| known.from <= from && to <= known.to);
            let times = around.map(|(_, times)| *times).max().unwrap_or(0);
            let unit = Unit::Trials(Trials { from, to, ..trials.clone() });
            (times < MOST_ATTEMPTS).then_some((unit, times > 0))
        };
        ends.dedup();
        ends.windows(2).map_while(piece).collect()
    }
}

impl Plan {
    /// Deals wanted units out to `most` shards at most; `pace` is the time of a trial in seconds, if it is known. Each shard
    /// gets a slice of each large unit, so that all take alike long. A unit that did not come back stands alone, so that
    /// nothing else is lost with it.
    pub fn deal(wanted: &[Unit], attempts: &Attempts, most: usize, pace: Option<f64>) -> Vec<Vec<Unit>> {
        let pieces = wanted.iter().flat_map(|unit| attempts.pieces(unit));
        let (again, new): (Vec<_>, Vec<_>) = pieces.partition(|(_, again)| *again);
        let all: u64 = new.iter().map(|(unit, _)| unit.weight()).sum();
        let lanes = LANES as u64;
        let worth = pace.map_or(all / lanes, |pace| (all as f64 * pace / SHORT) as u64);
        let count = worth.clamp(1, most.max(1) as u64);
        let mut shards: Vec<Vec<Unit>> = (0..count).map(|_| Vec::new()).collect();
        for (k, (unit, _)) in new.into_iter().enumerate() {
            let size = (unit.weight() / count).max(all / count / PARTS).max(1).next_multiple_of(lanes);
            let slices = unit.slices(size);
            for (slice, unit) in (0..).zip(slices) {
                // Small units go around.
                shards[(k + slice) % count as usize].push(unit);
            }
        }
        shards.extend(again.into_iter().map(|(unit, _)| vec![unit]));
        shards.retain(|shard| !shard.is_empty());
        shards
    }
}
