//! What traces and groups cost in a cycle of `smc advise`, by the number of people.
//!
//! `cargo bench --bench perception`: best of five. People walk on a square with one person on 4 m² or four on 1 m²; they are
//! projected well, as in traces.

#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a bench reads the clock and prints"
)]

use smc::base::geometry::Vec2;
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::data::tracks::{Batch, Observation};
use smc::perception::assignment::Costs;
use smc::perception::{Clustering, ConstantVelocity, Tracker, Tracking, clusters};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// The shortest of five times.
fn best(mut run: impl FnMut()) -> Duration {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed()
    };
    (0..5).map(time).min().unwrap_or_default()
}

fn main() {
    let stream = Stream::of(TrialKey::default(), 0, Purpose::Test);
    let costs = Costs::of(200, 200, |i, j| stream.uniform((i * 200 + j) as u32));
    println!("assignment 200 x 200, random costs: {:?}", best(|| drop(black_box(costs.assign()))));
    println!("| people | density (1/m²) | traces | groups |");
    for density in [0.25, 4.0] {
        for count in [200_u32, 700, 2000] {
            let side = (f64::from(count) / density).sqrt();
            let people: Vec<(Vec2, Vec2)> = (0..count)
                .map(|i| {
                    let ([x, y], [u, v]) = (stream.uniform_pair(2 * i), stream.uniform_pair(2 * i + 1));
                    (Vec2::new(x, y) * side, Vec2::new(u - 0.5, v - 0.5) * 2.0)
                })
                .collect();
            let batch = |time: f64| {
                let one =
                    |(p, v): &(Vec2, Vec2)| Observation { position: p + v * time, ..Observation::default() };
                Batch { time, seen: people.iter().map(one).collect(), ..Batch::default() }
            };
            let mut tracker = Tracker::new(Tracking::default());
            for time in [0.0, 0.4] {
                let _ = tracker.step(&[batch(time)], &mut ConstantVelocity);
            }
            let next = [batch(0.8)];
            let traces = best(|| drop(black_box(tracker.clone().step(&next, &mut ConstantVelocity))));
            let moving: Vec<(Vec2, Option<Vec2>)> = people.iter().map(|(p, v)| (*p, Some(*v))).collect();
            let groups = best(|| {
                black_box(clusters(&moving, &Clustering::default(), TrialKey::default(), 0, &|| false));
            });
            println!("| {count} | {density} | {traces:?} | {groups:?} |");
        }
    }
}
