//! Demands on a model of gait, measured on recorded steps: `docs/gait-measured.md`.
//!
//! ```sh
//! cargo test --release --test suite gait_measured -- --ignored --nocapture
//! ```
//!
//! The CMU subjects in `HELD_OUT` and every fifth clip of each style of Bandai-Namco are held out; the models are fitted to the
//! rest. A style of Bandai-Namco counts as a subject. Numbers that miss a demand are printed and not asserted.

mod data;
mod relations;

use data::{Captured, HELD_OUT, Steps, WALKS};
use smc::base::geometry::{Bounds, Vec2};
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::gait::model::{LearnedGait, Method, Options, Person as Learned, score};
use smc::gait::walk::{Ground, PlacedStep, Search, Walk};
use smc::gait::{Draws, Foot, Gait, Phase, RecordedStep, Shape};
use smc::model::Scene;
use smc::route::grid::{ClearanceGrid, GoalField};
use smc::route::roadmap::FreeSpace;
use smc::stats::twosample::{self, Summary, energy_test, kolmogorov_smirnov};
use std::collections::BTreeMap;
use std::sync::Arc;

fn stream(seed: u64, index: u64) -> Stream {
    Stream::of(TrialKey { seed, index, branch: 0 }, 0, Purpose::Test)
}

fn end_of(shape: &Shape) -> Vec2 {
    shape.landmarks[shape.landmarks.len() - 1]
}

/// The angle of the end of the path of a step to its begin, rad.
fn turn(shape: &Shape) -> f64 {
    let end = shape.curve().tangent(1.0);
    end.y.atan2(end.x)
}

/// Deviation of the root path from its chord at a share, m, positive to the side of the foot that stands.
fn aside(foot: Foot, shape: &Shape, share: f64) -> f64 {
    let (place, chord) = (shape.curve().place(share), end_of(shape).normalize());
    let side = if foot == Foot::Left { -1.0 } else { 1.0 };
    side * (chord.x * place.y - chord.y * place.x)
}

/// Amplitude of the sway of a step: that of the half sine with the mean of its deviation, m.
fn sway(foot: Foot, shape: &Shape) -> f64 {
    let mean = (0..20).map(|k| aside(foot, shape, (f64::from(k) + 0.5) / 20.0)).sum::<f64>() / 20.0;
    mean * std::f64::consts::FRAC_PI_2
}

/// The largest deviation from the chord, m.
fn largest(foot: Foot, shape: &Shape) -> f64 {
    (1..20).map(|k| aside(foot, shape, f64::from(k) / 20.0).abs()).fold(0.0, f64::max)
}

/// Length (m), turn (rad), duration (s) and sway (m).
fn vector(foot: Foot, shape: &Shape) -> [f64; 4] {
    [end_of(shape).norm(), turn(shape), shape.duration, sway(foot, shape)]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
#[ignore = "fits models; see the head of the file"]
fn scores() {
    let Some(steps) = Steps::read() else { return };
    println!("{} steps to fit, {} held out", steps.train.len(), steps.held_out.len());
    let options = |method| Options { method, ..Options::default() };
    let all = [
        ("exact", options(Method::Exact)),
        ("sparse", options(Method::Sparse)),
        ("linear", options(Method::Linear)),
        ("as published", Options { as_published: true, ..Options::default() }),
    ];
    let is_cmu = |s: &RecordedStep| HELD_OUT.contains(&s.subject.as_str());
    let found = all.map(|(name, options)| {
        let model = steps.model(&options);
        let (cmu, actors): (Vec<_>, Vec<_>) = steps.held_out.iter().cloned().partition(is_cmu);
        [("all", steps.held_out.clone()), ("actors", actors), ("CMU", cmu)].map(|(who, held_out)| {
            let found = score(&model, &held_out);
            let (c, n) = (found.coverage, found.pairs);
            println!(
                "| {name} | {who} | {n} | {:.3} | {:.3} | {:.2} | {:.2} | {:.2} |",
                found.nlpd, found.crps, c.length, c.turn, c.duration
            );
            found
        })
    });
    let [exact, sparse, linear, published] = found.map(|of| of[0]);
    assert!((sparse.nlpd - exact.nlpd).abs() < 0.01 && (sparse.crps - exact.crps).abs() < 0.01);
    assert!(sparse.nlpd < linear.nlpd - 0.05 && sparse.nlpd < published.nlpd - 0.1);
    let c = found[1][1].coverage;
    let c = [c.length, c.turn, c.duration];
    assert!(c.iter().all(|share| (0.85..0.95).contains(share)), "{c:?}");
}

/// Walks of a gait that begin as a take and end where it ends: feet and shapes of the steps after the first two.
fn planned(captured: &Captured, people: &dyn Fn(u64) -> Learned, beyond: f64) -> Vec<Vec<PlacedStep>> {
    planned_to(captured, captured.goal() + captured.ending() * beyond, people)
}

fn planned_to(captured: &Captured, goal: Vec2, people: &dyn Fn(u64) -> Learned) -> Vec<Vec<PlacedStep>> {
    let mut scene = Scene::default();
    if captured.is_turn {
        scene.barriers.push(captured.inside());
    }
    let free = FreeSpace::new(&scene, 0.25);
    let places = captured.take.root.iter().copied();
    let around = Bounds::around(places).expect("a take has places");
    let bounds = Bounds { low: around.low - Vec2::repeat(3.0), high: around.high + Vec2::repeat(3.0) };
    let ground = Ground::new(free.clone(), ClearanceGrid::new(&free, &bounds, 0.2));
    let field = GoalField::new(ground.grid(), goal);
    let one = |index: u64| {
        let gait = people(index);
        let walk = Walk {
            ground: &ground,
            field: &field,
            goal,
            gait: &gait,
            share: 1.0,
            stream: stream(1, index),
            search: Search::default(),
            around: &[],
        };
        walk.whole(captured.walker()).unwrap_or_else(|none| panic!("{}: {none}", captured.take.name))
    };
    (0..WALKS).map(one).collect()
}

/// The person of a take: with the offset of its subject if the model knows it, else a drawn one for each walk.
fn person_of(model: &Arc<LearnedGait>, captured: &Captured, index: u64) -> Learned {
    model.recorded(&captured.take.subject).unwrap_or_else(|| {
        let normals = std::array::from_fn(|k| stream(2, index).normal_pair(k as u32)[0]);
        model.person(&normals)
    })
}

fn spread(values: &[f64]) -> f64 {
    let middle = mean(values);
    mean(&values.iter().map(|x| (x - middle) * (x - middle)).collect::<Vec<_>>()).sqrt()
}

fn column<const N: usize>(rows: &[[f64; N]], q: usize) -> Vec<f64> {
    rows.iter().map(|row| row[q]).collect()
}

/// Steps without the first two and the last two of a walk: those are given or lead to the goal point.
fn inner(steps: &[(Foot, Shape)]) -> Vec<[f64; 4]> {
    steps[..steps.len() - 2].iter().map(|(foot, shape)| vector(*foot, shape)).collect()
}

/// Drawn steps against captured ones, at most 200 of each: p, and p of the negative controls.
fn tested(name: &str, captured: &[[f64; 4]], drawn: &[[f64; 4]], spreads: &[f64; 4]) -> [f64; 4] {
    let pick = |from: &[[f64; 4]], procedure: u32| -> Vec<[f64; 4]> {
        let chosen = twosample::Draws { seed: 5, procedure }.subset(0, 200, from.len());
        chosen.iter().map(|k| from[*k]).collect()
    };
    let (a, b) = (pick(captured, 1), pick(drawn, 2));
    let middle: [f64; 4] = std::array::from_fn(|q| mean(&column(&b, q)));
    #[allow(clippy::type_complexity, reason = "a table of names and changes")]
    let controls: [(&str, &dyn Fn([f64; 4]) -> [f64; 4]); 4] = [
        ("as drawn", &|v| v),
        ("20 % slower", &|[length, turn, duration, sway]| [length, turn, 1.25 * duration, sway]),
        ("sway doubled", &|[length, turn, duration, sway]| [length, turn, duration, 2.0 * sway]),
        ("spread halved", &|v| std::array::from_fn(|q| 0.5 * (v[q] + middle[q]))),
    ];
    controls.map(|(what, change)| {
        let b: Vec<[f64; 4]> = b.iter().map(|v| change(*v)).collect();
        let scaled = |set: &[[f64; 4]]| -> Vec<Vec<f64>> {
            set.iter().map(|v| v.iter().zip(spreads).map(|(x, s)| x / s).collect()).collect()
        };
        let found = energy_test(&scaled(&a), &scaled(&b), 999, twosample::Draws { seed: 5, procedure: 3 });
        let each: Vec<String> = (0..4)
            .map(|q| {
                let (x, y) = (column(&a, q), column(&b, q));
                let p = kolmogorov_smirnov(&x, &y).p;
                format!("{:.3} ({:.3}) {:.3} ({:.3}) p {p:.3}", mean(&x), spread(&x), mean(&y), spread(&y))
            })
            .collect();
        let sizes = (a.len(), b.len());
        println!("{name}, {what} {sizes:?}: {:.3}, p {:.3} | {}", found.distance, found.p, each.join(" | "));
        found.p
    })
}

#[test]
#[ignore = "fits models; see the head of the file"]
fn walks() {
    let Some(steps) = Steps::read() else { return };
    let model = steps.model(&Options::default());
    let mut ratios = BTreeMap::<(bool, bool), Vec<[f64; 3]>>::new();
    let mut farther = BTreeMap::<bool, Vec<[f64; 3]>>::new();
    // Of all takes, of the straight ones and of turns.
    let mut sets = BTreeMap::<(bool, Option<bool>), [Vec<[f64; 4]>; 3]>::new();
    for (number, captured) in steps.captured.iter().enumerate() {
        let (is_known, rest) = (captured.is_known(), captured.rest());
        let people = |index| person_of(&model, captured, 1000 * number as u64 + index);
        let length: f64 = rest.iter().map(|s| s.shape.curve().length()).sum();
        let time: f64 = rest.iter().map(|s| s.shape.duration).sum();
        let ratio = |[l, t, n]: [f64; 3]| [l / length, t / time, n - rest.len() as f64];
        let walks = planned(captured, &people, 0.0);
        let all = |walk: &[PlacedStep]| {
            let (l, t) =
                (walk.iter().map(PlacedStep::length).sum(), walk.iter().map(PlacedStep::duration).sum());
            ratio([l, t, walk.len() as f64])
        };
        ratios.entry((is_known, captured.is_turn)).or_default().extend(walks.iter().map(|walk| all(walk)));
        if !captured.is_turn {
            let passed = planned(captured, &people, 2.5);
            let passed = passed.iter().map(|walk| ratio(captured.passed(walk)));
            farther.entry(is_known).or_default().extend(passed);
        }
        let seen = inner(&rest.iter().map(|s| (s.foot, s.shape)).collect::<Vec<_>>());
        let [mut led, mut alone] = [Vec::new(), Vec::new()];
        for (index, walk) in (0..).zip(&walks) {
            led.extend(inner(&walk.iter().map(|s| (s.foot, s.shape)).collect::<Vec<_>>()));
            let (person, mut walker) = (people(index), captured.walker());
            let one = |k: usize| {
                let draws = Draws::of(stream(3, 1000 * number as u64 + index), k as u32, 0);
                walker.stance = person.step(&walker.stance, walker.foot, 1.0, draws);
                walker.foot = walker.foot.other();
                walker.stance.last.expect("a step was made")
            };
            alone.extend(inner(&(0..rest.len()).map(one).collect::<Vec<_>>()));
        }
        for kind in [None, Some(captured.is_turn)] {
            let set = sets.entry((is_known, kind)).or_default();
            for (all, part) in set.iter_mut().zip([&seen, &led, &alone]) {
                all.extend(part);
            }
        }
    }
    let show = |name: &str, rows: &[[f64; 3]]| {
        let [length, time] = [0, 1].map(|q| Summary::of(&column(rows, q)));
        let near = rows.iter().filter(|r| r[2].abs() <= 1.0).count() as f64 / rows.len() as f64;
        println!(
            "| {name} | {} | {:.3} [{:.3}, {:.3}] | {:.3} [{:.3}, {:.3}] | {:.0} % | {:+.2} |",
            rows.len(),
            length.median,
            length.low_quartile,
            length.high_quartile,
            time.median,
            time.low_quartile,
            time.high_quartile,
            100.0 * near,
            mean(&column(rows, 2))
        );
        (length.median, near)
    };
    for ((is_known, is_turn), rows) in &ratios {
        let (length, _) = show(&format!("known {is_known}, turn {is_turn}"), rows);
        assert!(*is_turn && !is_known || (0.98..1.02).contains(&length));
    }
    let all: Vec<[f64; 3]> = ratios.values().flatten().copied().collect();
    let (length, near) = show("all", &all);
    assert!((0.98..1.02).contains(&length) && near >= 0.8);
    for (is_known, rows) in &farther {
        show(&format!("known {is_known}, straight, goal 2.5 m farther"), rows);
    }
    let inner: Vec<[f64; 4]> =
        steps.train.iter().filter(|s| s.phase == Phase::Inner).map(|s| vector(s.foot, &s.shape)).collect();
    let spreads = std::array::from_fn(|q| spread(&column(&inner, q)));
    println!("spreads {spreads:.3?}");
    for ((is_known, kind), [seen, led, alone]) in &sets {
        let name = format!("known {is_known}, turn {kind:?}");
        tested(&format!("{name}, to a goal"), seen, led, &spreads);
        let [p, controls @ ..] = tested(&format!("{name}, gait alone"), seen, alone, &spreads);
        if *is_known && kind.is_none() {
            assert!(p > 0.05 && controls.iter().all(|p| *p < 0.01), "{p} {controls:?}");
        }
    }
}
