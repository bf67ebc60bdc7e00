//! The persons who calibrate: each person of a recording at one instant, of companions one alone, by time.

use crate::advise::groups;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::replay::evaluate::{PREDICTED, eligible};
use crate::replay::instants::Instant;
use crate::replay::situation::{Replay, sighting};
use std::collections::{BTreeMap, BTreeSet};

/// One instant of each person who moves and whose next seconds are recorded, drawn at random; by time.
pub(super) fn drawn(replay: &Replay, speed: f64, seed: u64) -> Vec<Instant> {
    let all = replay.everybody(replay.recording.step());
    let mut of_each: BTreeMap<u32, Vec<Instant>> = BTreeMap::new();
    for instant in eligible(replay, all, speed, PREDICTED) {
        of_each.entry(instant.person).or_default().push(instant);
    }
    let one = |(person, instants): (&u32, &Vec<Instant>)| {
        let key = TrialKey { seed, index: 0, branch: 0 };
        let uniform = Stream::of(key, *person & 0xff_ffff, Purpose::Resample).uniform(0);
        instants[((uniform * instants.len() as f64) as usize).min(instants.len() - 1)]
    };
    let mut drawn: Vec<Instant> = of_each.iter().map(one).collect();
    drawn.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.person.cmp(&b.person)));
    let mut known = BTreeSet::new();
    drawn.retain(|instant| {
        let group = companions(replay, *instant);
        let is_new = group.iter().all(|id| !known.contains(id));
        known.extend(group);
        is_new
    });
    drawn
}

/// Larger groups are no company but a crowd, whose members count each.
const COMPANY: usize = 5;

/// Somebody with those who walk along at an instant.
fn companions(replay: &Replay, Instant { time, person }: Instant) -> Vec<u32> {
    let people: Vec<_> = replay.recording.at(time).iter().map(|one| sighting(one.id, one)).collect();
    let group = groups(&people).into_iter().find(|group| group.contains(&person) && group.len() <= COMPANY);
    group.unwrap_or_else(|| vec![person])
}
