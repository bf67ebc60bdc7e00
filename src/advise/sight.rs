//! Who is taken into account in a cycle: everybody who was seen, and who is unseen but hidden from all sensors, projected.

use crate::base::geometry::{Polygon, Vec2};
use crate::compile::{Seen, Sighting};
use crate::data::tracks::Batch;
use crate::perception::{ConstantVelocity, Motion, Trace, TracePoint};

/// Ids of people whose id is unknown begin here, in the order of their traces.
const UNKNOWN: u32 = 1 << 31;

/// People are observed so far beyond the range, m: those who come into it have a trace already.
const MARGIN: f64 = 10.0;

/// The batches without observations far beyond the range of the user, m; `None` where the user's place is unknown.
pub(super) fn around(batches: &[Batch], traces: &[Trace], user: u32, range: f64) -> Option<Vec<Batch>> {
    let time = batches.first()?.time;
    let own = batches.iter().flat_map(|batch| &batch.seen).find(|one| one.id == Some(user));
    let projected = || {
        let end = traces.iter().find(|trace| trace.person == Some(user))?.end();
        Some(ConstantVelocity.project(&[end], time).first()?.position)
    };
    let centre = own.map(|one| one.position).or_else(projected)?;
    let mut near = batches.to_vec();
    for batch in &mut near {
        batch.seen.retain(|one| (one.position - centre).norm() <= range + MARGIN);
    }
    Some(near)
}

/// Somebody who is taken into account.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    /// Number of the trace.
    pub(super) trace: u64,
    /// Time of the last observation, s.
    pub(super) last: f64,
    pub(super) sighting: Sighting,
    /// Earlier positions with their times, s.
    pub(super) past: Vec<(f64, Vec2)>,
}

/// Everybody of the active traces at a time. Whoever is unseen is projected, and is left out where a sensor looks at the place;
/// a sensor without a field looks everywhere. `user` is never left out.
pub(super) fn followed(traces: &[Trace], batches: &[Batch], time: f64, user: Option<u64>) -> Vec<Followed> {
    let ends: Vec<TracePoint> = traces.iter().map(Trace::end).collect();
    let now = ConstantVelocity.project(&ends, time);
    let is_looked_at = |place: Vec2| {
        batches.iter().any(|batch| match &batch.field {
            None => true,
            Some(corners) => Polygon::new(corners.clone()).contains(place),
        })
    };
    let one = |(trace, point): (&Trace, TracePoint)| {
        let last = trace.end().time;
        let stays = last == time || Some(trace.number) == user || !is_looked_at(point.position);
        let velocity = point.velocity.unwrap_or_else(Vec2::zeros);
        let id = trace.person.unwrap_or(UNKNOWN | trace.number as u32);
        let sighting = Sighting::new(id, point.position, velocity);
        let past = trace.points.iter().map(|point| (point.time, point.position)).collect();
        stays.then_some(Followed { trace: trace.number, last, sighting, past })
    };
    traces.iter().zip(now).filter_map(one).collect()
}

/// What compilation gets of them: those within a range of the user, m, by ascending id; the user's id and that of the scenario
/// change places.
pub(super) fn seen(
    all: &[Followed],
    (user, written): (&Followed, u32),
    range: Option<f64>,
    groups: &[Vec<u32>],
) -> Seen {
    let own = user.sighting.id;
    let renamed = |id: u32| match id {
        id if id == own => written,
        id if id == written => own,
        id => id,
    };
    let is_near = |one: &&Followed| {
        range.is_none_or(|range| (one.sighting.position - user.sighting.position).norm() <= range)
    };
    let near: Vec<&Followed> = all.iter().filter(is_near).collect();
    let mut people: Vec<Sighting> =
        near.iter().map(|one| Sighting { id: renamed(one.sighting.id), ..one.sighting }).collect();
    people.sort_by_key(|one| one.id);
    let past = near.iter().map(|one| (renamed(one.sighting.id), one.past.clone())).collect();
    let group = |group: &Vec<u32>| {
        let mut ids: Vec<u32> = group.iter().map(|id| renamed(*id)).collect();
        ids.sort_unstable();
        ids
    };
    let mut groups: Vec<Vec<u32>> = groups.iter().map(group).collect();
    groups.sort();
    Seen { people, groups, past }
}
