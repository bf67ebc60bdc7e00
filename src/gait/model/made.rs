//! Made steps and a made model for tests.

#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "tests may use the platform's functions")]

use super::columns::{COLUMNS, Columns};
use super::people::People;
use super::transition::{Process, Transition};
use super::*;
use crate::base::geometry::Vec2;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::gait::{Phase, RecordedStep, SPANS, Shape};

/// Steps of takes of four subjects: lengths, turns and durations that drift, with sway, from standing.
pub(super) fn steps(takes: u32, each: u32) -> Vec<RecordedStep> {
    let stream = Stream::of(TrialKey::default(), 3, Purpose::Test);
    let mut all = Vec::new();
    for take in 0..takes {
        let subject = take % 4;
        let own = 0.03 * (f64::from(subject) - 1.5);
        let (mut length, mut turn, mut foot) =
            (0.0, 0.0, if take % 8 < 4 { Foot::Left } else { Foot::Right });
        for number in 0..each {
            let draw = |k: u32| stream.normal_pair(((take * 100 + number) << 3) + k);
            let ([a, b], [c, d], [e, f]) = (draw(0), draw(1), draw(2));
            length = 0.6 * length + 0.025 * a;
            turn = 0.7 * turn + 0.08 * b;
            let side = if foot == Foot::Left { 1.0 } else { -1.0 };
            let long = (0.68 + own + length) * if number == 0 { 0.6 } else { 1.0 };
            let sway = 0.025 + 0.005 * c;
            let place = |k: usize| {
                let t = (k + 1) as f64 / SPANS as f64;
                let bump = side * sway * (std::f64::consts::PI * t).sin();
                Vec2::new(long * t + 0.003 * e * t * (1.0 - t), bump + 0.5 * turn * long * t * t)
            };
            let duration = 0.54 - 0.3 * length + 0.5 * own + 0.02 * d + 0.005 * f;
            let shape = Shape { landmarks: std::array::from_fn(place), duration }.aligned();
            let phase = if number == 0 { Phase::First } else { Phase::Inner };
            all.push(RecordedStep {
                take: format!("t{take:03}"),
                subject: format!("s{subject}"),
                number,
                foot,
                phase,
                span: (0.0, duration),
                width: 0.1,
                shape,
            });
            foot = foot.other();
        }
    }
    all
}

/// A model of round numbers, which no fit can change.
pub(super) fn small() -> LearnedGait {
    let row = |k: f64| -> Columns { std::array::from_fn(|c| k * ((c * 7 % 5) as f64 - 2.0) / 16.0) };
    let side = |sign: f64| -> Side {
        let center: Columns = std::array::from_fn(|c| match c {
            10 => 0.5,
            c if c % 2 == 0 => 0.0625 * (c + 2) as f64,
            _ => sign * 0.015_625,
        });
        let unit = |k: usize| -> Columns { std::array::from_fn(|c| f64::from(c == k)) };
        let points = vec![
            (0..8).map(|k| f64::from(k) / 4.0 - 1.0).collect(),
            (0..8).map(|k| f64::from(k * 3 % 8) / 4.0 - 1.0).collect(),
            vec![0.0; 8],
        ];
        let process = Process {
            lengths: vec![1.0, 1.5, 2.0],
            noise: 0.5,
            signals: vec![1.0, 0.5],
            points,
            weights: vec![vec![0.125; 8], (0..8).map(|k| f64::from(k) / 32.0 - 0.1).collect()],
            reduction: vec![0.015_625; 64],
            log_likelihood: -1.0,
        };
        let residuals: Vec<Columns> = (0..40).map(|k| row(f64::from(k) / 40.0 - 0.5)).collect();
        let places: Vec<f64> = (0..120).map(|k| f64::from(k * 37 % 120) / 60.0 - 1.0).collect();
        Side {
            basis: Basis {
                center,
                scale: [0.0625; COLUMNS],
                directions: vec![unit(8), unit(10)],
                spread: vec![0.5, 0.75],
                explained: vec![0.5, 0.5],
            },
            first: Density { steps: vec![row(-1.0), row(0.5)], kernel: vec![row(0.25)] },
            transition: Transition::Process(process),
            pairs: Pairs::new(&places, &residuals, 3),
            gaussian: vec![row(0.5), unit(9)],
            usual: 0.75,
        }
    };
    let mut people = People::fit(&[("a", [0.0; COLUMNS]), ("b", [0.01; COLUMNS])], false);
    people.loadings = vec![[0.01; COLUMNS]];
    LearnedGait {
        source: "made".into(),
        license: String::new(),
        as_published: false,
        residuals: Residuals::Nearest,
        people,
        sides: [side(1.0), side(-1.0)],
    }
}
