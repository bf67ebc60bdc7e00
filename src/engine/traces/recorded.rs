//! A recording as a trace, so that a page plays it as it plays a trial. Between two observations people are on a straight
//! line.

use super::Trace;
use super::motion::{Membership, Motion, SPACING, Track, millimetres};
use crate::base::decimal::Decimal;
use crate::base::geometry::Vec2;
use crate::base::math::median;
use crate::base::tick::{Clock, Tick};
use crate::model::{Behaviours, Processes, Scenario, Scene};
use std::sync::Arc;

/// Bodies are drawn with this radius, mm: a recording has none.
const RADIUS: i32 = 200;
/// Times are sums of steps, s.
const CLOSE: f64 = 1e-6;

/// Somebody from coming in to leaving.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walk {
    /// The name.
    pub name: String,
    /// Times, s, and places, m, in the order of time.
    pub points: Vec<(f64, Vec2)>,
    /// From when on, s, in which group; in none for `None`.
    pub groups: Vec<(f64, Option<u64>)>,
}

/// Walks in a scene as a trace, which begins with the first of them at time 0. `None` without any.
pub fn recorded(title: &str, scene: Scene, walks: &[Walk]) -> Option<Trace> {
    let times = || walks.iter().flat_map(|walk| walk.points.iter().map(|(time, _)| *time));
    let from = times().reduce(f64::min)?;
    let end = times().fold(from, f64::max) - from;
    let spacing = spacing(walks);
    let first = |time: f64| ((time - from) / spacing - CLOSE).ceil().max(0.0) as usize;
    let track = |(agent, walk): (usize, &Walk)| {
        let (start, last) = (walk.points.first()?.0, walk.points.last()?.0);
        let frames = first(start)..first(last + spacing * (1.0 - CLOSE));
        let at = |frame: usize| millimetres(place(&walk.points, from + frame as f64 * spacing));
        let points: Vec<_> = frames.clone().map(at).collect();
        (!points.is_empty()).then(|| Track {
            agent,
            name: walk.name.clone(),
            radius: RADIUS,
            first: frames.start,
            points,
        })
    };
    let tracks = walks.iter().enumerate().filter_map(track).collect();
    let member = |(agent, walk): (usize, &Walk)| {
        let one =
            |(time, group): &(f64, Option<u64>)| Membership { first: first(*time), agent, group: *group };
        walk.groups.iter().map(one).collect::<Vec<_>>()
    };
    let mut memberships: Vec<Membership> = walks.iter().enumerate().flat_map(member).collect();
    memberships.sort_by_key(|one| one.first);
    let frames = (end / spacing + CLOSE).floor() as usize + 1;
    let scenario = Scenario {
        title: title.to_owned(),
        clock: Clock::Stepped(Decimal::whole(1)),
        horizon: Tick(0),
        scene,
        agents: Vec::new(),
        groups: Vec::new(),
        moves: Vec::new(),
        processes: Processes::default(),
        behaviours: Behaviours::default(),
        sources: Vec::new(),
        doors: Vec::new(),
    };
    let start = if from == 0.0 { String::new() } else { format!(", from {from} s on") };
    Some(Trace {
        scenario: Arc::new(scenario),
        trial: 0,
        recording: Some(format!("recording{start}")),
        option: None,
        motion: Motion::recorded((spacing, frames), tracks, memberships),
        end,
        shows: Vec::new(),
    })
}

/// The usual time between two observations of somebody, s.
fn spacing(walks: &[Walk]) -> f64 {
    let pairs = walks.iter().flat_map(|walk| walk.points.windows(2).map(|pair| pair[1].0 - pair[0].0));
    let usual = median(pairs.filter(|time| *time > CLOSE));
    usual.map_or(SPACING, |time| (time * 1e6).round() / 1e6).max(SPACING)
}

/// Where somebody is at a time.
fn place(points: &[(f64, Vec2)], time: f64) -> Vec2 {
    let next = points.partition_point(|(known, _)| *known <= time + CLOSE);
    match (points.get(next.wrapping_sub(1)), points.get(next)) {
        (Some((t0, from)), Some((t1, to))) => from + (to - from) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0),
        (Some((_, at)), None) | (None, Some((_, at))) => *at,
        (None, None) => Vec2::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_lie_at_the_times_of_observations() {
        let at = |x: f64| Vec2::new(x, 1.0);
        let points =
            |from: usize, to: usize| (from..to).map(|k| (7.0 + 0.4 * k as f64, at(k as f64))).collect();
        let groups = vec![(7.0, None), (7.8, Some(3))];
        let walks = [
            Walk { name: "a".into(), points: points(0, 5), groups },
            Walk { name: "b".into(), points: points(2, 4), groups: Vec::new() },
        ];
        let trace = recorded("r", Scene::default(), &walks).unwrap();
        let motion = &trace.motion;
        assert_eq!((motion.frames, motion.spacing), (5, 0.4));
        assert_eq!(
            motion.tracks[0].points.iter().map(|[x, _]| *x).collect::<Vec<_>>(),
            [0, 1000, 2000, 3000, 4000]
        );
        assert_eq!((motion.tracks[1].first, motion.tracks[1].points.len()), (2, 2));
        assert_eq!(motion.memberships[1], Membership { first: 2, agent: 0, group: Some(3) });
        assert_eq!(trace.recording.as_deref(), Some("recording, from 7 s on"));
        assert!((trace.end - 1.6).abs() < 1e-9);
        assert!(recorded("r", Scene::default(), &[]).is_none());
    }
}
