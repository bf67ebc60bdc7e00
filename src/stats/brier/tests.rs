//! Terms against values by hand and by definition.

use super::*;
use proptest::prelude::*;

fn prediction(person: u32, probability: f64, happened: bool) -> Prediction {
    Prediction { person, probability, happened }
}

fn scored(all: &[(f64, bool)]) -> BrierScore {
    let all =
        (0..).zip(all).map(|(person, (probability, happened))| prediction(person, *probability, *happened));
    Predictions::new(all.collect()).score().unwrap()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn terms_by_hand_in_two_bins_of_equal_probabilities() {
    let found = scored(&[(0.9, true), (0.1, false), (0.9, false), (0.1, false)]);
    assert_eq!((found.count, found.bins.len()), (4, 2));
    assert_eq!(found.bins[0], Bin { count: 2, low: 0.1, high: 0.1, mean: 0.1, share: 0.0 });
    let expected = [
        (found.base_rate, 0.25),
        (found.brier, (0.01 + 0.01 + 0.01 + 0.81) / 4.0),
        (found.reliability, 0.5 * 0.01 + 0.5 * 0.16),
        (found.resolution, 0.0625),
        (found.uncertainty, 0.1875),
        (found.within_bin_variance, 0.0),
        (found.within_bin_covariance, 0.0),
        (found.calibration_error, 0.5 * 0.1 + 0.5 * 0.4),
        (found.skill.unwrap(), 1.0 - 0.21 / 0.1875),
    ];
    assert!(expected.iter().all(|(found, expected)| near(*found, *expected)), "{found:?}");
    assert_eq!(found.histogram, [0, 2, 0, 0, 0, 0, 0, 0, 0, 2]);
}

#[test]
fn terms_by_hand_within_a_bin() {
    // Twenty predictions, so two a bin: 0.2 and 0.4 are in one, all others are 0 and do not happen.
    let all: Vec<(f64, bool)> = (0..18).map(|_| (0.0, false)).chain([(0.2, false), (0.4, true)]).collect();
    let found = scored(&all);
    assert_eq!(found.bins[1], Bin { count: 2, low: 0.2, high: 0.4, mean: 0.5 * (0.2 + 0.4), share: 0.5 });
    let expected = [
        (found.brier, (0.04 + 0.36) / 20.0),
        (found.reliability, 2.0 * 0.04 / 20.0),
        (found.within_bin_variance, 2.0 * 0.01 / 20.0),
        (found.within_bin_covariance, 2.0 * 0.05 / 20.0),
        (found.calibration_error, 2.0 * 0.2 / 20.0),
    ];
    assert!(expected.iter().all(|(found, expected)| near(*found, *expected)), "{found:?}");
}

#[test]
fn different_probabilities_fill_ten_equal_bins() {
    let all: Vec<(f64, bool)> = (0..100_u32).map(|k| (f64::from(k * 37 % 100) / 100.0, k % 3 == 0)).collect();
    let found = scored(&all);
    assert_eq!(found.bins.iter().map(|bin| bin.count).collect::<Vec<_>>(), [10; 10]);
    assert_eq!((found.bins[3].low, found.bins[3].high), (0.3, 0.39));
    assert_eq!(found.histogram, [10; 10]);
}

#[test]
fn special_predictors() {
    assert_eq!(Predictions::default().score(), None);
    assert_eq!(Predictions::new(vec![prediction(0, 0.5, true)]).weighted(&[0]), None);
    assert_eq!(Predictions::new(vec![prediction(7, 0.5, true)]).weighted(&[1]), None);
    let base = scored(&[(0.25, true), (0.25, false), (0.25, false), (0.25, false)]);
    assert_eq!((base.skill, base.calibration_error, base.bins.len()), (Some(0.0), 0.0, 1));
    let perfect = scored(&[(1.0, true), (0.0, false), (1.0, true)]);
    assert_eq!((perfect.brier, perfect.skill, perfect.reliability), (0.0, Some(1.0), 0.0));
    assert!(near(perfect.resolution, perfect.uncertainty));
    assert_eq!(perfect.histogram[9], 2, "1 is in the last tenth");
    assert_eq!(scored(&[(0.9, true), (0.8, true)]).skill, None, "all outcomes are alike");
}

/// The terms by definition: the bin of each prediction from how many are below it and how many equal it.
fn by_definition(all: &[Prediction]) -> [f64; 7] {
    let n = all.len() as f64;
    let outcome = |one: &Prediction| if one.happened { 1.0 } else { 0.0 };
    let bin = |one: &Prediction| {
        let below = all.iter().filter(|other| other.probability < one.probability).count();
        let equal = all.iter().filter(|other| other.probability == one.probability).count();
        10 * (2 * below + equal) / (2 * all.len())
    };
    let mean = |of: &dyn Fn(&Prediction) -> f64| all.iter().map(of).sum::<f64>() / n;
    let base = mean(&outcome);
    let in_bin = |one: &Prediction, of: &dyn Fn(&Prediction) -> f64| {
        let same: Vec<f64> = all.iter().filter(|other| bin(other) == bin(one)).map(of).collect();
        same.iter().sum::<f64>() / same.len() as f64
    };
    let p = |one: &Prediction| one.probability;
    let square = |x: f64| x * x;
    [
        mean(&|one| square(one.probability - outcome(one))),
        mean(&|one| square(in_bin(one, &p) - in_bin(one, &outcome))),
        mean(&|one| square(in_bin(one, &outcome) - base)),
        base * (1.0 - base),
        mean(&|one| square(one.probability - in_bin(one, &p))),
        mean(&|one| (one.probability - in_bin(one, &p)) * (outcome(one) - in_bin(one, &outcome))),
        mean(&|one| (in_bin(one, &p) - in_bin(one, &outcome)).abs()),
    ]
}

fn predictions() -> impl Strategy<Value = Vec<Prediction>> {
    let probability = prop_oneof![(0..=20_u32).prop_map(|k| f64::from(k) / 20.0), 0.0..=1.0_f64];
    let one = (0..8_u32, probability, any::<bool>());
    prop::collection::vec(one.prop_map(|(person, p, happened)| prediction(person, p, happened)), 1..60)
}

proptest! {
    #[test]
    fn terms_are_those_of_the_definition_and_add_up(all in predictions()) {
        let score = Predictions::new(all.clone()).score().unwrap();
        let found = [
            score.brier,
            score.reliability,
            score.resolution,
            score.uncertainty,
            score.within_bin_variance,
            score.within_bin_covariance,
            score.calibration_error,
        ];
        for (found, expected) in found.into_iter().zip(by_definition(&all)) {
            prop_assert!(near(found, expected), "{found} {expected}");
        }
        let sum = score.reliability - score.resolution + score.uncertainty + score.within_bin_variance
            - 2.0 * score.within_bin_covariance;
        prop_assert!(near(score.brier, sum));
        prop_assert_eq!(score.bins.iter().map(|bin| bin.count).sum::<u64>(), all.len() as u64);
        prop_assert_eq!(score.histogram.iter().sum::<u64>(), all.len() as u64);
        prop_assert!(score.bins.windows(2).all(|pair| pair[0].high < pair[1].low), "ties are in one bin");
    }

    #[test]
    fn the_order_does_not_matter(all in predictions()) {
        let forward = Predictions::new(all.clone()).score().unwrap();
        let backward = Predictions::new(all.into_iter().rev().collect()).score().unwrap();
        prop_assert_eq!(forward.bins.len(), backward.bins.len());
        prop_assert!(near(forward.reliability, backward.reliability));
    }

    #[test]
    fn a_weight_is_a_number_of_copies(all in predictions(), counts in prop::collection::vec(0..4_u32, 8)) {
        let copies = all.iter().flat_map(|one| vec![*one; counts[one.person as usize] as usize]).collect();
        let (weighted, copied) = (Predictions::new(all.clone()).weighted(&counts), Predictions::new(copies).score());
        prop_assert_eq!(weighted.is_some(), copied.is_some());
        if let (Some(weighted), Some(copied)) = (weighted, copied) {
            let brier = Predictions::new(all).brier(&counts).unwrap();
            prop_assert!(near(weighted.brier, copied.brier) && near(brier, copied.brier));
            prop_assert!(near(weighted.reliability, copied.reliability));
            prop_assert!(near(weighted.within_bin_covariance, copied.within_bin_covariance));
            let counts = |score: &BrierScore| score.bins.iter().map(|bin| bin.count).collect::<Vec<_>>();
            prop_assert_eq!((counts(&weighted), weighted.histogram), (counts(&copied), copied.histogram));
        }
    }
}
