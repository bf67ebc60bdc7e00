//! Quality of predicted probabilities: the score of Brier (1950), and its terms (Murphy 1973) over bins.
//!
//! With N predictions, of which bin k has `n_k` with mean probability `p_k` and share of happened outcomes `o_k`, and
//! base rate o:
//!
//! - brier = `Σ (p_i − o_i)² / N`
//! - reliability = `Σ n_k (p_k − o_k)² / N`, how far probabilities are from shares: smaller is better
//! - resolution = `Σ n_k (o_k − o)² / N`, how much bins differ: larger is better
//! - uncertainty = o (1 − o), the score of predicting the base rate
//!
//! Probabilities in a bin differ, so two terms more make the sum exact (Stephenson, Coelho and Jolliffe 2008):
//!
//! - within-bin variance = `Σ (p_i − p_k)² / N`
//! - within-bin covariance = `Σ (p_i − p_k)(o_i − o_k) / N`, without the factor 2 of the sum
//! - brier = reliability − resolution + uncertainty + variance − 2 covariance
//!
//! The bins are tenths of the predictions, by ascending probability. Equal probabilities are in one bin, that of the
//! middle of their ranks. So no bin depends on the order of predictions, and there are fewer bins, of uneven counts,
//! where many probabilities are equal.

use serde::Serialize;

/// Most bins.
const BINS: u64 = 10;

/// A predicted probability and what happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Number of the person, from 0.
    pub person: u32,
    /// Predicted probability, 0..=1.
    pub probability: f64,
    /// Whether it happened.
    pub happened: bool,
}

/// Predictions that lie near each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Number of predictions.
    pub count: u64,
    /// Least probability.
    pub low: f64,
    /// Greatest probability.
    pub high: f64,
    /// Mean probability.
    pub mean: f64,
    /// Share of outcomes that happened.
    pub share: f64,
}

/// Quality of predictions.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BrierScore {
    /// Number of predictions.
    pub count: u64,
    /// Share of outcomes that happened.
    pub base_rate: f64,
    /// Mean squared difference of probability and outcome; 0 is best.
    pub brier: f64,
    /// Mean squared difference of probability and share over bins; 0 is best.
    pub reliability: f64,
    /// Variance of the share over bins.
    pub resolution: f64,
    /// Variance of the outcome.
    pub uncertainty: f64,
    /// Variance of the probability within bins.
    pub within_bin_variance: f64,
    /// Covariance of probability and outcome within bins.
    pub within_bin_covariance: f64,
    /// Expected calibration error: mean distance of probability and share over bins.
    pub calibration_error: f64,
    /// 1 − brier / uncertainty: 1 is best, 0 as good as the base rate; `None` if all outcomes are alike.
    pub skill: Option<f64>,
    /// Bins by ascending probability.
    pub bins: Vec<Bin>,
    /// Number of predictions in each tenth of 0..=1.
    pub histogram: [u64; 10],
}

/// Predictions by ascending probability.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Predictions(Vec<Prediction>);

impl Predictions {
    /// Predictions in any order.
    pub fn new(mut predictions: Vec<Prediction>) -> Self {
        predictions.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        Self(predictions)
    }

    /// Their quality; `None` without predictions.
    pub fn score(&self) -> Option<BrierScore> {
        scored(self.0.iter().map(|one| (one, 1)))
    }

    /// Their quality where each person counts so often; persons beyond the counts do not count.
    pub fn weighted(&self, counts: &[u32]) -> Option<BrierScore> {
        scored(self.counted(counts))
    }

    /// The Brier score alone, where each person counts so often.
    pub fn brier(&self, counts: &[u32]) -> Option<f64> {
        let (count, sum) = self.counted(counts).fold((0, 0.0), |(count, sum), (one, times)| {
            let error = one.probability - outcome(one);
            (count + u64::from(times), sum + f64::from(times) * error * error)
        });
        (count > 0).then(|| sum / count as f64)
    }

    fn counted<'a>(&'a self, counts: &'a [u32]) -> impl Iterator<Item = (&'a Prediction, u32)> {
        self.0.iter().map(|one| (one, counts.get(one.person as usize).copied().unwrap_or(0)))
    }
}

/// 1 if it happened, otherwise 0.
fn outcome(one: &Prediction) -> f64 {
    f64::from(u8::from(one.happened))
}

/// A prediction that counts so often.
struct Counted {
    probability: f64,
    outcome: f64,
    times: u32,
}

fn total(some: &[Counted]) -> u64 {
    some.iter().map(|one| u64::from(one.times)).sum()
}

fn sum(some: &[Counted], of: impl Fn(&Counted) -> f64) -> f64 {
    some.iter().map(|one| f64::from(one.times) * of(one)).sum()
}

/// The quality of predictions by ascending probability, each with how often it counts.
fn scored<'a>(predictions: impl Iterator<Item = (&'a Prediction, u32)>) -> Option<BrierScore> {
    let all: Vec<Counted> = predictions
        .filter(|(_, times)| *times > 0)
        .map(|(one, times)| Counted { probability: one.probability, outcome: outcome(one), times })
        .collect();
    let count = total(&all);
    if count == 0 {
        return None;
    }
    let n = count as f64;
    let base_rate = sum(&all, |one| one.outcome) / n;
    let uncertainty = base_rate * (1.0 - base_rate);
    let brier = sum(&all, |one| (one.probability - one.outcome) * (one.probability - one.outcome)) / n;
    let mut histogram = [0; 10];
    for one in &all {
        histogram[((10.0 * one.probability) as usize).min(9)] += u64::from(one.times);
    }
    let skill = (uncertainty > 0.0).then(|| 1.0 - brier / uncertainty);
    let mut score =
        BrierScore { count, base_rate, brier, uncertainty, skill, histogram, ..BrierScore::default() };
    for members in bins(&all) {
        let (Some(first), Some(last)) = (members.first(), members.last()) else { continue };
        let size = total(members);
        let k = size as f64;
        let (mean, share) = (sum(members, |one| one.probability) / k, sum(members, |one| one.outcome) / k);
        score.bins.push(Bin { count: size, low: first.probability, high: last.probability, mean, share });
        score.reliability += k / n * (mean - share) * (mean - share);
        score.resolution += k / n * (share - base_rate) * (share - base_rate);
        score.calibration_error += k / n * (mean - share).abs();
        let off = |one: &Counted| one.probability - mean;
        score.within_bin_variance += sum(members, |one| off(one) * off(one)) / n;
        score.within_bin_covariance += sum(members, |one| off(one) * (one.outcome - share)) / n;
    }
    Some(score)
}

/// Predictions by ascending probability, in bins that are not empty.
fn bins(all: &[Counted]) -> Vec<&[Counted]> {
    let count = total(all);
    let (mut before, mut start, mut end, mut last) = (0, 0, 0, 0);
    let mut bins = Vec::new();
    for equal in all.chunk_by(|a, b| a.probability == b.probability) {
        let here = total(equal);
        // The bin of the middle of the ranks `before .. before + here`.
        let bin = BINS * (2 * before + here) / (2 * count);
        if bin != last && end > start {
            bins.push(&all[start..end]);
            start = end;
        }
        last = bin;
        before += here;
        end += equal.len();
    }
    bins.push(&all[start..end]);
    bins
}

#[cfg(test)]
mod tests;
