//! Plans: which units the shards of a round consist of.

use super::Origin;
use super::unit::{Trials, Unit};
use serde::{Deserialize, Serialize};

/// Trials of a shard that are more than this times its share stay together with it.
const LEAST: u64 = 64;
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
pub struct Attempts(Vec<(Unit, u32)>);

impl Attempts {
    /// A shard did not bring these back.
    pub fn fail(&mut self, units: &[Unit]) {
        for unit in units {
            match self.0.iter_mut().find(|(known, _)| known.is_within(unit) && unit.is_within(known)) {
                Some((_, times)) => *times += 1,
                None => self.0.push((unit.clone(), 1)),
            }
        }
    }

    /// How many units were not brought back at least once.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The units that are given up.
    pub fn given_up(&self) -> impl Iterator<Item = &Unit> {
        self.0.iter().filter(|(_, times)| *times >= MOST_ATTEMPTS).map(|(unit, _)| unit)
    }

    /// Wanted units that were tried before, and others, without those that are given up and what follows these.
    fn sort(&self, wanted: &[Unit]) -> (Vec<Unit>, Vec<Unit>) {
        let (mut again, mut new) = (Vec::new(), Vec::new());
        for unit in wanted {
            let Unit::Trials(trials) = unit else {
                match self.0.iter().find(|(known, _)| known == unit) {
                    None => new.push(unit.clone()),
                    Some((_, times)) if *times < MOST_ATTEMPTS => again.push(unit.clone()),
                    Some(_) => {}
                }
                continue;
            };
            let mut from = trials.from;
            while from < trials.to {
                let failed = self.0.iter().filter_map(|(known, times)| match known {
                    Unit::Trials(known) if known.is_beside(trials) && known.to > from => {
                        Some((known, *times))
                    }
                    _ => None,
                });
                let here =
                    failed.clone().filter(|(known, _)| known.from <= from).max_by_key(|(_, times)| *times);
                let (to, list) = match here {
                    Some((_, MOST_ATTEMPTS..)) => break,
                    Some((known, _)) => (known.to, &mut again),
                    None => (failed.map(|(known, _)| known.from).min().unwrap_or(trials.to), &mut new),
                };
                let to = to.min(trials.to);
                list.push(Unit::Trials(Trials { from, to, ..trials.clone() }));
                from = to;
            }
        }
        (again, new)
    }
}

impl Plan {
    /// Deals wanted units out to `most` shards at most; `pace` is the time of a trial in seconds, if it is known. A unit that
    /// did not come back stands alone, so that nothing else is lost with it.
    pub fn deal(wanted: &[Unit], attempts: &Attempts, most: usize, pace: Option<f64>) -> Vec<Vec<Unit>> {
        let (again, new) = attempts.sort(wanted);
        let mut shards: Vec<Vec<Unit>> = again.into_iter().map(|unit| vec![unit]).collect();
        let all: u64 = new.iter().map(Unit::weight).sum();
        let worth = pace.map_or(all / LEAST, |pace| (all as f64 * pace / SHORT) as u64);
        let size = all.div_ceil(worth.clamp(1, most.max(1) as u64)).next_multiple_of(LEAST);
        let (mut shard, mut filled) = (Vec::new(), 0);
        for unit in new {
            let mut rest = Some(unit);
            while let Some(unit) = rest.take() {
                let room = size - filled;
                let unit = match unit {
                    Unit::Trials(trials) if trials.to - trials.from > room => {
                        let cut = trials.from + room;
                        rest = Some(Unit::Trials(Trials { from: cut, ..trials.clone() }));
                        Unit::Trials(Trials { to: cut, ..trials })
                    }
                    unit => unit,
                };
                filled += unit.weight();
                shard.push(unit);
                if filled >= size {
                    shards.push(std::mem::take(&mut shard));
                    filled = 0;
                }
            }
        }
        shards.extend(Some(shard).filter(|shard| !shard.is_empty()));
        shards
    }
}
