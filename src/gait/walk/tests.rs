//! Walks of a plain gait: in the scene of Figure 5 of Agethen et al. 2018, on open floor, and where there is no way.

#![allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]

use super::*;
use crate::base::geometry::{Bounds, Shape as Area, Vec2};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::gait::{Draws, Foot, Gait, SPANS, Shape, Stance};
use crate::model::{Barrier, Obstacle, Scene};
use crate::route::grid::{ClearanceGrid, GoalField};
use crate::route::roadmap::FreeSpace;

/// Steps of 0.65 m, first steps of their own length; noise of length and direction, and a sway of 2.5 cm.
#[derive(Debug)]
struct PlainGait {
    first: f64,
    /// Standard deviation of the turn, degrees.
    noise: f64,
}

const GAIT: PlainGait = PlainGait { first: 0.37, noise: 5.0 };

/// As in the paper, walks begin with a step as of somebody who walks.
const FULL_FIRST_STEP: PlainGait = PlainGait { first: 0.7, noise: 5.0 };

impl Gait for PlainGait {
    fn step(&self, before: &Stance, foot: Foot, _share: f64, draws: Draws) -> Stance {
        let [a, b] = draws.normal_pair(0);
        let mean = if before.last.is_some() { 0.65 } else { self.first };
        let (length, turn) = (mean + 0.04 * a, self.noise.to_radians() * b);
        let side = if foot == Foot::Left { -0.025 } else { 0.025 };
        let at = |k: usize| {
            let t = (k + 1) as f64 / SPANS as f64;
            Vec2::new(length * t, side * (t * std::f64::consts::PI).sin() + 0.5 * length * turn * t * t)
        };
        let shape = Shape { landmarks: std::array::from_fn(at), duration: 0.53 };
        Stance { last: Some((foot, shape.aligned())), drift: before.drift }
    }

    fn length(&self) -> f64 {
        0.65
    }

    fn duration(&self) -> f64 {
        0.53
    }
}

const RADIUS: f64 = 0.25;

const BOXES: [[f64; 4]; 5] = [
    [1.2, 3.9, 2.6, 5.0],
    [2.9, 2.2, 4.3, 3.4],
    [0.8, 1.2, 2.0, 2.6],
    [4.6, 3.6, 5.8, 5.2],
    [4.7, 1.2, 5.3, 2.4],
];

fn stream(seed: u64) -> Stream {
    Stream::of(TrialKey { seed, index: 0, branch: 0 }, 0, Purpose::Test)
}

fn ground(boxes: &[[f64; 4]]) -> Ground {
    let area = |b: &[f64; 4]| Area::rectangle(Vec2::new(b[0], b[1]), Vec2::new(b[2], b[3]));
    let barrier = |b| Barrier { name: String::new(), obstacle: Obstacle::Solid(area(b)) };
    let scene = Scene { barriers: boxes.iter().map(barrier).collect(), ..Scene::default() };
    let free = FreeSpace::new(&scene, RADIUS);
    let bounds = Bounds { low: Vec2::zeros(), high: Vec2::new(6.5, 6.5) };
    let grid = ClearanceGrid::new(&free, &bounds, ClearanceGrid::SIDE);
    Ground::new(free, grid)
}

fn walk<'a>(ground: &'a Ground, field: &'a GoalField, goal: Vec2, seed: u64, search: Search) -> Walk<'a> {
    Walk { ground, field, goal, gait: &GAIT, share: 1.0, stream: stream(seed), search, around: &[] }
}

/// The least distance of the path from the boxes, at points much closer than those of the sweep.
fn least_distance(steps: &[PlacedStep], boxes: &[[f64; 4]]) -> f64 {
    let distance = |p: Vec2, b: &[f64; 4]| {
        let dx = (b[0] - p.x).max(p.x - b[2]).max(0.0);
        let dy = (b[1] - p.y).max(p.y - b[3]).max(0.0);
        (dx * dx + dy * dy).sqrt()
    };
    let places = steps.iter().flat_map(|step| (0..=400).map(move |k| step.place(f64::from(k) / 400.0)));
    places.flat_map(|p| boxes.iter().map(move |b| distance(p, b))).fold(f64::INFINITY, f64::min)
}

/// How often a walk stops: there the next step may begin in another direction.
fn stops_of_chain(steps: &[PlacedStep], start: Vec2) -> usize {
    assert_eq!(steps[0].start, start);
    assert!(steps.windows(2).all(|pair| (pair[1].start - pair[0].end()).norm() < 1e-9));
    steps.windows(2).filter(|pair| (pair[1].heading - pair[0].end_heading()).norm() > 1e-9).count()
}

fn all_reach_the_goal(search: Search, seeds: u64) {
    let ground = ground(&BOXES);
    let (start, goal) = (Vec2::new(0.5, 6.0), Vec2::new(6.0, 0.5));
    let field = GoalField::new(ground.grid(), goal);
    let mut stops = 0;
    for seed in 0..seeds {
        let walk = walk(&ground, &field, goal, seed, search);
        let steps = walk.whole(Walker::standing(start, None)).unwrap();
        stops += stops_of_chain(&steps, start);
        assert!((steps[steps.len() - 1].end() - goal).norm() < 1e-6);
        assert!(least_distance(&steps, &BOXES) >= RADIUS - 1e-9, "{seed}");
        assert!((10..25).contains(&steps.len()), "{seed}: {}", steps.len());
        assert_eq!(walk.whole(Walker::standing(start, None)).unwrap(), steps);
    }
    assert!(20 * stops < seeds as usize, "{stops}");
}

#[test]
fn guided_walks_reach_the_goal_and_no_step_meets_a_barrier() {
    all_reach_the_goal(Search::default(), 100);
}

#[test]
fn walks_of_hybrid_a_star_reach_the_goal_and_no_step_meets_a_barrier() {
    all_reach_the_goal(Search::HybridAStar(HybridAStar::default()), 50);
}

#[test]
fn published_walks_cross_obstacles_and_end_near_the_goal() {
    let ground = ground(&BOXES);
    let (start, goal) = (Vec2::new(0.5, 6.0), Vec2::new(6.0, 0.5));
    let field = GoalField::new(ground.grid(), goal);
    let mut crossing = 0;
    for seed in 0..5 {
        let search = Search::HybridAStar(HybridAStar::as_published());
        let gait = &PlainGait { first: 0.37, noise: 20.0 };
        let walk = Walk { gait, ..walk(&ground, &field, goal, seed, search) };
        let steps = walk.whole(Walker::standing(start, None)).unwrap();
        assert!((steps[steps.len() - 1].end() - goal).norm() <= 0.25);
        crossing += u32::from(least_distance(&steps, &BOXES) < RADIUS - 1e-9);
    }
    assert!(crossing >= 4, "{crossing}");
}

/// Median length, interquartile range and share of walks of two steps to a disc of this radius around a point ahead.
fn lengths(distance: f64, radius: f64, gait: &PlainGait, search: Search) -> (f64, f64, f64) {
    let ground = ground(&[]);
    let start = Vec2::new(1.0, 1.0);
    let center = start + Vec2::new(distance, 0.0);
    let field = GoalField::new(ground.grid(), center);
    let made = |seed| {
        let [u, v] = stream(seed).uniform_pair(u32::MAX);
        let (sin, cos) = (v * std::f64::consts::TAU).sin_cos();
        let goal = center + Vec2::new(cos, sin) * (radius * u.sqrt());
        let walk = Walk { gait, ..walk(&ground, &field, goal, seed, search) };
        let steps = walk.whole(Walker::standing(start, None)).ok()?;
        Some((steps.iter().map(PlacedStep::length).sum::<f64>(), steps.len()))
    };
    let walks: Vec<(f64, usize)> = (0..200).filter_map(made).collect();
    assert!(walks.len() >= 160, "{}", walks.len());
    let rank = |quarters: usize| walks.len() * quarters / 4;
    let mut lengths: Vec<f64> = walks.iter().map(|(length, _)| *length).collect();
    lengths.sort_by(f64::total_cmp);
    let of_two = walks.iter().filter(|(_, steps)| *steps == 2).count() as f64 / walks.len() as f64;
    (lengths[rank(2)], lengths[rank(3)] - lengths[rank(1)], of_two)
}

#[test]
fn walks_on_open_floor_are_as_long_as_captured_ones() {
    // Agethen et al. 2018, Table 1, captured medians; straight distances slightly below them.
    for (distance, captured) in [(2.3, 2.38), (2.2, 2.25), (3.0, 3.15), (2.35, 2.44), (1.0, 1.07)] {
        for radius in [0.0, 0.1, 0.2, 0.25] {
            let (median, _, _) = lengths(distance, radius, &GAIT, Search::default());
            assert!((median / captured - 1.0).abs() < 0.08, "{distance} {radius}: {median}");
            assert!(median > distance - 0.02, "{distance} {radius}: {median}");
        }
    }
    let (_, spread, of_two) = lengths(1.0, 0.25, &GAIT, Search::default());
    assert!(of_two >= 0.95 && (0.15..0.25).contains(&spread), "{of_two} {spread}");
}

#[test]
fn published_walks_of_one_metre_are_one_step() {
    let (median, _, of_two) =
        lengths(1.0, 0.0, &FULL_FIRST_STEP, Search::HybridAStar(HybridAStar::as_published()));
    assert!((0.75..0.9).contains(&median) && of_two < 0.3, "{median} {of_two}");
    let (median, _, of_two) = lengths(1.0, 0.0, &FULL_FIRST_STEP, Search::default());
    assert!((0.99..1.05).contains(&median) && of_two > 0.95, "{median} {of_two}");
}

#[test]
fn a_body_in_the_way_is_passed_without_contact() {
    let ground = ground(&[]);
    let (start, goal) = (Vec2::new(0.5, 3.0), Vec2::new(6.0, 3.0));
    let field = GoalField::new(ground.grid(), goal);
    let other = OtherBody { at: Vec2::new(3.2, 3.0), velocity: Vec2::zeros(), radius: RADIUS };
    for seed in 0..50 {
        let walk = walk(&ground, &field, goal, seed, Search::default());
        let gaps = |step: &PlacedStep| least_gap(step, RADIUS, &[other]);
        let mut walker = Walker::standing(start, None);
        let mut made = 0;
        while let Some(step) = walk.next(&mut walker, Some(&gaps)).unwrap() {
            assert!(
                (0..=100).all(|k| (step.place(f64::from(k) / 100.0) - other.at).norm() > 2.0 * RADIUS - 2e-3)
            );
            made += 1;
            assert!(made < 40, "{seed}");
        }
    }
    // On all sides of it: no step can be made, and the walker has not changed.
    let ring: Vec<OtherBody> = [(0.505, 0.0), (-0.505, 0.0), (0.0, 0.505), (0.0, -0.505)]
        .map(|(x, y)| OtherBody { at: start + Vec2::new(x, y), ..other })
        .to_vec();
    let gaps = |step: &PlacedStep| least_gap(step, RADIUS, &ring);
    let mut walker = Walker::standing(start, None);
    let walk = walk(&ground, &field, goal, 1, Search::default());
    assert_eq!(walk.next(&mut walker, Some(&gaps)), Err(NoStep::Crowded));
    assert_eq!(walker, Walker::standing(start, None));
}

#[test]
fn the_gap_to_a_moving_body_is_that_of_the_nearest_approach() {
    let at = |k: usize| Vec2::new((k + 1) as f64 / SPANS as f64, 0.0);
    let shape = Shape { landmarks: std::array::from_fn(at), duration: 0.5 };
    let step = PlacedStep::new(Foot::Left, Vec2::zeros(), Vec2::y(), shape);
    // It crosses the path at right angles, with the same speed: nearest when both are as far from the crossing.
    let other = OtherBody { at: Vec2::new(-0.7, 0.5), velocity: Vec2::new(2.0, 0.0), radius: 0.2 };
    let expected = (0..=10_000)
        .map(|k| f64::from(k) * 0.5e-4)
        .map(|t| (Vec2::new(0.0, 2.0 * t) - other.at - other.velocity * t).norm() - 0.5)
        .fold(f64::INFINITY, f64::min);
    assert!((least_gap(&step, 0.3, &[other]) - expected).abs() < 1e-6);
    assert_eq!(least_gap(&step, 0.3, &[]), f64::INFINITY);
}

#[test]
fn somebody_with_the_goal_behind_turns_with_the_first_steps() {
    let ground = ground(&[]);
    let (start, goal) = (Vec2::new(3.0, 3.0), Vec2::new(6.0, 3.0));
    let field = GoalField::new(ground.grid(), goal);
    for (behind, turns) in [(180.0_f64, 2), (120.0, 1), (-70.0, 1), (30.0, 0)] {
        let (sin, cos) = behind.to_radians().sin_cos();
        let walk = walk(&ground, &field, goal, 3, Search::default());
        let steps = walk.whole(Walker::standing(start, Some(Vec2::new(cos, sin)))).unwrap();
        let on_the_spot = steps.iter().take_while(|step| step.length() < 0.1).count();
        assert_eq!(on_the_spot, turns, "{behind}");
        for step in &steps {
            // Sway turns the path by up to 14 degrees in addition.
            let turn = placed::angle(step.heading, step.end_heading()).abs().to_degrees();
            let most = if step.length() < 0.7 * step.duration() { 91.0 } else { 50.0 + 14.0 };
            assert!(turn < most, "{behind}: {turn}");
        }
        assert!((steps[steps.len() - 1].end() - goal).norm() < 1e-6);
    }
}

#[test]
fn reasons_for_no_step_are_reported() {
    // A closed room.
    let room = [[1.0, 1.0, 3.0, 1.2], [1.0, 2.8, 3.0, 3.0], [1.0, 1.0, 1.2, 3.0], [2.8, 1.0, 3.0, 3.0]];
    let ground = ground(&room);
    let goal = Vec2::new(5.0, 5.0);
    let field = GoalField::new(ground.grid(), goal);
    let inside = Walker::standing(Vec2::new(2.0, 2.0), None);
    let to = |goal, search| walk(&ground, &field, goal, 1, search).whole(inside.clone());
    assert_eq!(to(goal, Search::default()), Err(NoStep::NoWay { x: 2.0, y: 2.0 }));
    assert_eq!(to(Vec2::new(0.9, 2.0), Search::default()), Err(NoStep::GoalBlocked));
    let few = HybridAStar { expansions: 2, ..HybridAStar::default() };
    let outside = Walker::standing(Vec2::new(0.3, 0.3), None);
    let walk = walk(&ground, &field, goal, 1, Search::HybridAStar(few));
    assert_eq!(walk.whole(outside), Err(NoStep::Limit { expansions: 2 }));
}

/// The shortest way between two places at least this far from all boxes: over points of the arcs around their corners.
fn shortest(boxes: &[[f64; 4]], from: Vec2, to: Vec2, apart: f64) -> Vec<Vec2> {
    let distance = |p: Vec2, b: &[f64; 4]| {
        Vec2::new((b[0] - p.x).max(p.x - b[2]).max(0.0), (b[1] - p.y).max(p.y - b[3]).max(0.0)).norm()
    };
    let is_clear = |a: Vec2, b: Vec2| {
        let count = ((b - a).norm() / 0.01).ceil() as usize;
        (0..=count).all(|k| {
            let place = a + (b - a) * (k as f64 / count.max(1) as f64);
            boxes.iter().all(|b| distance(place, b) > apart - 1e-4)
        })
    };
    let mut places = vec![from, to];
    for b in boxes {
        for (quarter, corner) in
            [(b[2], b[3]), (b[0], b[3]), (b[0], b[1]), (b[2], b[1])].into_iter().enumerate()
        {
            places.extend((0..=16).map(|k| {
                let (sin, cos) =
                    ((quarter as f64 + f64::from(k) / 16.0) * std::f64::consts::FRAC_PI_2).sin_cos();
                // A little farther, so that chords keep the distance as well.
                Vec2::new(corner.0, corner.1) + Vec2::new(cos, sin) * (apart * 1.0013)
            }));
        }
    }
    let mut known = vec![(f64::INFINITY, 0); places.len()];
    let mut open: Vec<usize> = (0..places.len()).collect();
    known[0].0 = 0.0;
    while let Some(next) = (0..open.len()).min_by(|a, b| known[open[*a]].0.total_cmp(&known[open[*b]].0)) {
        let at = open.swap_remove(next);
        for other in open.iter().copied() {
            let through = known[at].0 + (places[other] - places[at]).norm();
            if through < known[other].0 && is_clear(places[at], places[other]) {
                known[other] = (through, at);
            }
        }
    }
    let mut way = vec![1];
    while way[way.len() - 1] != 0 {
        way.push(known[way[way.len() - 1]].1);
    }
    way.into_iter().rev().map(|k| places[k]).collect()
}

#[test]
fn walks_around_two_obstacles_keep_to_the_shortest_way() {
    const TWO: [[f64; 4]; 2] = [[1.9, 3.15, 2.4, 5.5], [4.1, 0.8, 4.6, 3.25]];
    let (start, goal) = (Vec2::new(0.3, 3.25), Vec2::new(6.2, 3.25));
    let ground = ground(&TWO);
    let field = GoalField::new(ground.grid(), goal);
    let way = shortest(&TWO, start, goal, RADIUS + 0.05);
    let off = |p: Vec2| {
        let pieces = way.windows(2).map(|ends| {
            let along = ends[1] - ends[0];
            let share = ((p - ends[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (p - ends[0] - along * share).norm()
        });
        pieces.fold(f64::INFINITY, f64::min)
    };
    let mut worst: Vec<f64> = (0..100)
        .map(|seed| {
            let walk = walk(&ground, &field, goal, seed, Search::default());
            let steps = walk.whole(Walker::standing(start, None)).unwrap();
            let places = steps.iter().flat_map(|step| (0..=20).map(|k| step.place(f64::from(k) / 20.0)));
            places.map(off).fold(0.0, f64::max)
        })
        .collect();
    worst.sort_by(f64::total_cmp);
    assert!(worst[50] < 0.06 && worst[90] < 0.12, "{} {}", worst[50], worst[90]);
}
