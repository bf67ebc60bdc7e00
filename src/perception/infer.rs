//! Traces and groups of a whole recording: Algorithms 2 and 3 at each instant, and what they agree with.

use super::clusters::{Clustering, clusters, instant_of};
use super::group_score::{GroupScore, Seen, score_groups};
use super::lineage::Lineage;
use super::lives::{Group, Series, lives, smooth};
use super::motion::Motion;
use super::score::{TrackScore, TrackTraces, score_tracks};
use super::trace::{Trace, TracePoint};
use super::tracker::{Tracker, Tracking, TrackingError};
use crate::base::geometry::Vec2;
use crate::base::math::median;
use crate::base::random::TrialKey;
use crate::data::tracks::Batch;
use std::collections::{BTreeMap, BTreeSet};

/// What is inferred, and how.
#[derive(Clone, Debug, Default)]
pub struct Inferring {
    /// Of traces.
    pub tracking: Tracking,
    /// Of groups.
    pub clustering: Clustering,
    /// Seed of the first centroids.
    pub key: TrialKey,
    /// Whether ids are withheld and used for the scores alone.
    pub is_anonymous: bool,
    /// Longest distance of successive times in an interval, s; the usual one unless given.
    pub longest_gap: Option<f64>,
    /// Annotated groups of ids.
    pub annotated: Option<Vec<Vec<u32>>>,
}

/// A trace and whose it is.
#[derive(Clone, Debug, PartialEq)]
pub struct InferredTrace {
    /// The trace, with all its points.
    pub trace: Trace,
    /// The ids that came with its observations, ascending, also those that were withheld.
    pub people: Vec<u32>,
}

/// One point of a trace in its group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InferredPoint {
    /// Number of the trace.
    pub trace: u64,
    /// Number of the group, changes of one instant ignored.
    pub group: u64,
    /// Time, place, velocity.
    pub point: TracePoint,
    /// The id that came with the observation, also if it was withheld.
    pub person: Option<u32>,
}

/// All that was inferred.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inference {
    /// Contiguous intervals, from and to, s.
    pub intervals: Vec<(f64, f64)>,
    /// All traces, by ascending number.
    pub traces: Vec<InferredTrace>,
    /// All points by time and trace.
    pub points: Vec<InferredPoint>,
    /// All groups, by ascending number.
    pub groups: Vec<Group>,
    /// Agreement with the ids, where there are any.
    pub tracks: Option<TrackScore>,
    /// Agreement with the annotated groups.
    pub score: Option<GroupScore>,
}

/// Infers traces and groups from batches in the order of time.
///
/// # Errors
/// Batches that are not in the order of time.
pub fn infer(
    batches: &[Batch],
    options: &Inferring,
    motion: &mut dyn Motion,
) -> Result<Inference, TrackingError> {
    let mut tracker = Tracker::new(options.tracking);
    let mut lineage = Lineage::new(options.tracking.longest);
    let mut points: Vec<InferredPoint> = Vec::new();
    let mut tracks = BTreeMap::<u32, TrackTraces>::new();
    let mut people = BTreeMap::<u64, BTreeSet<u32>>::new();
    let mut times = Vec::new();
    for instant in batches.chunk_by(|a, b| a.time == b.time) {
        let time = instant[0].time;
        let numbers = if options.is_anonymous {
            let withheld: Vec<Batch> = instant.iter().cloned().map(Batch::anonymous).collect();
            tracker.step(&withheld, motion)?
        } else {
            tracker.step(instant, motion)?
        };
        let mut person_of = BTreeMap::new();
        for (batch, numbers) in instant.iter().zip(&numbers) {
            for (id, number) in
                batch.seen.iter().zip(numbers).filter_map(|(one, number)| Some((one.id?, *number)))
            {
                person_of.entry(number).or_insert(id);
                people.entry(number).or_default().insert(id);
                let track = tracks.entry(id).or_default();
                // Several sensors may see the person at one time.
                if track.last().is_none_or(|last| last.0 != time) {
                    track.push((time, number));
                }
            }
        }
        let ends = tracker.active().iter().map(|trace| (trace.number, trace.end()));
        let seen: Vec<(u64, TracePoint)> = ends.filter(|(_, end)| end.time == time).collect();
        if seen.is_empty() {
            continue;
        }
        times.push(time);
        let placed: Vec<(Vec2, Option<Vec2>)> =
            seen.iter().map(|(_, end)| (end.position, end.velocity)).collect();
        let found = clusters(&placed, &options.clustering, options.key, instant_of(time), &|| false);
        let members: Vec<Vec<u64>> =
            found.iter().map(|cluster| cluster.iter().map(|k| seen[*k].0).collect()).collect();
        let groups = lineage.step(time, &members);
        let group_of: BTreeMap<u64, u64> = members
            .iter()
            .zip(groups)
            .flat_map(|(cluster, group)| cluster.iter().map(move |t| (*t, group)))
            .collect();
        points.extend(seen.iter().map(|(trace, point)| InferredPoint {
            trace: *trace,
            group: group_of.get(trace).copied().unwrap_or(0),
            point: *point,
            person: person_of.get(trace).copied(),
        }));
    }
    let raw = options.annotated.as_ref().map(|annotated| score_groups(&instants(&points), annotated));
    let mut series = BTreeMap::<u64, Series>::new();
    for point in &points {
        series.entry(point.trace).or_default().push((point.point.time, point.group));
    }
    smooth(&mut series);
    let mut next: BTreeMap<u64, std::vec::IntoIter<(f64, u64)>> =
        series.iter().map(|(trace, points)| (*trace, points.clone().into_iter())).collect();
    for point in &mut points {
        if let Some((_, group)) = next.get_mut(&point.trace).and_then(Iterator::next) {
            point.group = group;
        }
    }
    let mut traces = tracker.take_ended();
    traces.extend_from_slice(tracker.active());
    traces.sort_by_key(|trace| trace.number);
    let whose = |trace: Trace| {
        let people = people.get(&trace.number).map(|ids| ids.iter().copied().collect()).unwrap_or_default();
        InferredTrace { trace, people }
    };
    Ok(Inference {
        intervals: intervals(&times, options.longest_gap),
        traces: traces.into_iter().map(whose).collect(),
        points,
        groups: lives(&series),
        tracks: (!tracks.is_empty()).then(|| score_tracks(&tracks)),
        score: raw,
    })
}

/// The people of each instant for the score of groups.
fn instants(points: &[InferredPoint]) -> Vec<Vec<Seen>> {
    let seen = |point: &InferredPoint| {
        Some((point.person?, point.group, point.point.velocity.map_or(0.0, |v| v.norm())))
    };
    points
        .chunk_by(|a, b| a.point.time == b.point.time)
        .map(|instant| instant.iter().filter_map(seen).collect())
        .collect()
}

// Contiguous intervals of a sequence of times: it is cut where successive ones are farther apart than usual.

/// Times whose distance is at most this much above the usual one are not cut: rounding, and clocks of sensors.
const TOLERANCE: f64 = 1.05;

/// First and last time of each interval, s, of ascending times. The usual distance is the median; `longest` replaces it.
pub fn intervals(times: &[f64], longest: Option<f64>) -> Vec<(f64, f64)> {
    let usual = || median(times.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(0.0);
    let longest = longest.unwrap_or_else(usual) * TOLERANCE;
    times.chunk_by(|a, b| b - a <= longest).map(|part| (part[0], part[part.len() - 1])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::motion::ConstantVelocity;
    use super::*;
    use crate::data::tracks::Observation;

    #[test]
    fn two_who_part_are_two_groups() {
        let one =
            |x: f64, y: f64, id| Observation { position: Vec2::new(x, y), velocity: None, id: Some(id) };
        let batches: Vec<Batch> = (0..20)
            .map(|k| {
                let t = f64::from(k) * 0.4;
                let apart = if k < 8 { 0.5 } else { 0.5 + 0.3 * f64::from(k - 7) };
                Batch { time: t, seen: vec![one(t, 0.0, 7), one(t, apart, 9)], ..Batch::default() }
            })
            .collect();
        let options =
            Inferring { is_anonymous: true, annotated: Some(vec![vec![7, 9]]), ..Inferring::default() };
        let found = infer(&batches, &options, &mut ConstantVelocity).unwrap();
        assert_eq!(found.traces.iter().map(|t| t.people.clone()).collect::<Vec<_>>(), [[7], [9]]);
        assert_eq!(found.intervals.len(), 1);
        assert_eq!(found.tracks.unwrap().unsplit, 2);
        assert_eq!(found.groups.len(), 2, "{:?}", found.groups);
        assert_eq!(found.groups[1].born, super::super::lives::Birth::Split(1));
        assert_eq!(found.points.len(), 40);
        assert!(found.score.unwrap().precision == 1.0);
    }

    #[test]
    fn a_long_distance_parts_them() {
        assert_eq!(intervals(&[0.0, 0.4, 0.8, 2.0, 2.4], None), [(0.0, 0.8), (2.0, 2.4)]);
        assert_eq!(intervals(&[0.0, 0.4, 0.8, 2.0, 2.4], Some(1.2)), [(0.0, 2.4)]);
        assert_eq!(intervals(&[3.0], None), [(3.0, 3.0)]);
        assert!(intervals(&[], None).is_empty());
    }
}
