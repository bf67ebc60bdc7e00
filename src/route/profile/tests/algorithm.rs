//! How often the algorithm as printed fails, against an independent program (10 000 runs on the path of the paper).

use super::shape::{circle, paper_path, stream};
use crate::route::profile::{NeverReturns, Printed, printed};

/// Shares of runs with: wrong sign at an end, too few pieces, a profile; then shares of profiles that break a limit: in a piece,
/// in the join by acceleration, in the join by region, anywhere.
fn shares(speed: f64, acceleration: f64, runs: u32) -> [f64; 7] {
    let mut counts = [0u32; 7];
    for index in 0..runs {
        let stream = stream(u64::from(index), 5);
        let draw = |k| stream.uniform(k);
        match printed(&paper_path(), circle(speed, acceleration), 0.0, 0.0, None, draw).unwrap() {
            Printed::NeverReturns(NeverReturns::Start | NeverReturns::End) => counts[0] += 1,
            Printed::NeverReturns(NeverReturns::Pieces) => counts[1] += 1,
            Printed::NeverReturns(NeverReturns::Stuck) => {}
            Printed::Profile(profile) => {
                counts[2] += 1;
                let broken = profile.violations();
                counts[3] += u32::from(broken.piece_acceleration);
                counts[4] += u32::from(broken.join_acceleration);
                counts[5] += u32::from(broken.join_region);
                counts[6] += u32::from(broken.any());
                assert!(profile.duration() > 0.0);
            }
        }
    }
    let mut shares = counts.map(|count| 100.0 * f64::from(count) / f64::from(runs));
    for share in &mut shares[3..] {
        *share *= f64::from(runs) / f64::from(counts[2]);
    }
    shares
}

#[test]
fn the_printed_algorithm_fails_as_often_as_measured() {
    let cases = [
        (10.0, 2.0, [74.0, 8.5, 17.3, 32.0, 49.0, 43.0, 66.0]),
        (1.5, 0.8, [74.0, 8.7, 17.1, 3.2, 0.0, 0.0, 3.2]),
    ];
    for (speed, acceleration, expected) in cases {
        let found = shares(speed, acceleration, 10_000);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 2.0, "{found} {expected}");
        }
    }
}
