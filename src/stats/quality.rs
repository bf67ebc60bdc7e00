//! Quality of predicted probabilities with intervals over persons.
//!
//! Percentile intervals serve the Brier score and skills. The calibration error adds distances, so noise makes it
//! larger, in resamples more than in the sample; its interval is the basic one.

use super::bootstrap::{Bootstrap, Estimate};
use super::brier::{BrierScore, Predictions};

/// Quality of predictions.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// All terms and bins.
    pub score: BrierScore,
    /// Brier score; 0 is best.
    pub brier: Estimate,
    /// Expected calibration error; 0 is best.
    pub calibration_error: Estimate,
    /// 1 − brier / uncertainty: 1 is best, 0 as good as the base rate; `None` if all outcomes are alike.
    pub skill: Option<Estimate>,
    /// 1 − brier / other brier, where other predictions are compared; `None` if the other ones are perfect.
    pub skill_over_other: Option<Estimate>,
}

impl Quality {
    /// The quality of predictions; `None` without one. For the skill over another predictor, `compared` has the own
    /// and the other's predictions of the same instants.
    pub fn of(own: &Predictions, compared: Option<[&Predictions; 2]>, bootstrap: &Bootstrap) -> Option<Self> {
        let score = own.score()?;
        let [brier, calibration_error, skill] = bootstrap.estimates(|counts| {
            own.weighted(counts)
                .map_or([None; 3], |found| [Some(found.brier), Some(found.calibration_error), found.skill])
        });
        let skill_over_other = compared.and_then(|[own, other]| {
            bootstrap.estimate(|counts| {
                let other = other.brier(counts).filter(|brier| *brier > 0.0)?;
                Some(1.0 - own.brier(counts)? / other)
            })
        });
        let calibration_error = calibration_error?.reflected();
        Some(Self { score, brier: brier?, calibration_error, skill, skill_over_other })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::stats::brier::Prediction;

    /// Persons of 1 to 8 instants with probabilities near one of their own. The first predictions are calibrated up
    /// to the noise of 20 trials; the second say one half always.
    fn sample(index: u64, persons: u32) -> [Predictions; 2] {
        let stream = Stream::of(TrialKey { seed: 3, index, branch: 0 }, 0, Purpose::Test);
        let mut draw = 0;
        let mut uniform = || {
            draw += 1;
            stream.uniform(draw)
        };
        let mut own = Vec::new();
        for person in 0..persons {
            let (count, base) = (1 + (8.0 * uniform()) as u32, uniform());
            for _ in 0..count {
                let p = (base + 0.3 * (uniform() - 0.5)).clamp(0.0, 1.0);
                let happened = uniform() < p;
                let trials = (0..20).filter(|_| uniform() < p).count();
                own.push(Prediction { person, probability: trials as f64 / 20.0, happened });
            }
        }
        let half = own.iter().map(|one| Prediction { probability: 0.5, ..*one }).collect();
        [own, half].map(Predictions::new)
    }

    fn quality([own, half]: &[Predictions; 2], persons: usize, seed: u64) -> Quality {
        let bootstrap = Bootstrap { persons, draws: 199, seed, confidence: 0.95 };
        Quality::of(own, Some([own, half]), &bootstrap).unwrap()
    }

    /// 95 % with a standard deviation of 2.2 % in 100 samples. That of the calibration error is too short at small
    /// samples.
    #[test]
    fn intervals_contain_the_values_of_many_persons() {
        let [own, half] = sample(1 << 40, 40_000);
        let true_score = own.score().unwrap();
        let over = 1.0 - true_score.brier / half.score().unwrap().brier;
        let truth = [true_score.brier, true_score.skill.unwrap(), over, true_score.calibration_error];
        let mut covered = [0; 4];
        for index in 0..100 {
            let found = quality(&sample(index, 100), 100, index);
            let (skill, over) = (found.skill.unwrap(), found.skill_over_other.unwrap());
            let all = [found.brier, skill, over, found.calibration_error];
            for ((covered, one), truth) in covered.iter_mut().zip(all).zip(truth) {
                let [low, high] = one.interval.unwrap();
                assert!(low <= one.value && one.value <= high);
                *covered += i32::from(low <= truth && truth <= high);
            }
        }
        assert!(covered[..3].iter().all(|n| (88..=100).contains(n)) && covered[3] >= 75, "{covered:?}");
    }

    #[test]
    fn none_without_predictions_or_with_perfect_others() {
        let bootstrap = Bootstrap { persons: 2, draws: 99, seed: 0, confidence: 0.95 };
        assert_eq!(Quality::of(&Predictions::default(), None, &bootstrap), None);
        let of = |probability: f64| {
            let one = |person: u32| Prediction { person, probability, happened: true };
            Predictions::new(vec![one(0), one(1)])
        };
        let found = Quality::of(&of(0.5), Some([&of(0.5), &of(1.0)]), &bootstrap).unwrap();
        assert_eq!((found.skill, found.skill_over_other), (None, None));
        assert_eq!(found.brier, Estimate { value: 0.25, interval: Some([0.25; 2]) });
        let found = Quality::of(&of(1.0), Some([&of(1.0), &of(0.5)]), &bootstrap).unwrap();
        assert_eq!(found.skill_over_other.map(|one| one.value), Some(1.0));
    }
}
