//! From one step to the next: mean and variance of the scores of the successor. Predicting uses plain loops over `+ - *` and
//! `base::math` in a fixed order, so that a drawn step has the same bytes on every machine.

use super::basis::Scores;
use super::columns::COLUMNS;
use super::is_positive;
use crate::base::math;
use fearless_simd::{Level, Simd, dispatch};
use serde::{Deserialize, Serialize};

/// Inputs of a transition: the scores of a step and whether it began from standing; those beyond are 0.
pub(super) type Inputs = [f64; COLUMNS + 1];

/// Most points of a kernel.
pub(super) const MOST_POINTS: usize = 2000;

/// What gives the scores of the next step.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Transition {
    /// A Gaussian process.
    Process(Process),
    /// A linear function of the inputs, for comparison.
    Linear(Linear),
}

/// The posterior of a Gaussian process as a sum over points: with k the kernel between an input and the points, the mean of output
/// o is `weights[o]' k` and the variance is `signals[o] (1 + noise - k' reduction k)`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Process {
    /// Length scale of each input.
    pub(super) lengths: Vec<f64>,
    /// Variance of the noise over that of the signal.
    pub(super) noise: f64,
    /// Variance of the signal of each output.
    pub(super) signals: Vec<f64>,
    /// Coordinates of the points over the length scales: one list for each input, with points of no weight up to whole blocks.
    pub(super) points: Vec<Vec<f64>>,
    /// One list for each output.
    pub(super) weights: Vec<Vec<f64>>,
    /// Lower triangle by rows of whole blocks; entries off the diagonal count twice.
    pub(super) reduction: Vec<f64>,
    /// Logarithm of the marginal likelihood of all pairs, nats for each number.
    pub(super) log_likelihood: f64,
}

/// The outputs are `rows[o]' (inputs, 1)` with constant variances.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Linear {
    /// Coefficients of each output; the constant is the last one.
    pub(super) rows: Vec<Vec<f64>>,
    /// Variance of the residuals of each output.
    pub(super) variances: Vec<f64>,
}

/// Numbers that are multiplied and summed side by side; points come in blocks of as many.
pub(super) const LANES: usize = 8;

/// Sums of products of two lists of whole blocks, one for each lane.
#[inline(always)]
fn products(a: &[f64], b: &[f64]) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    for (x, y) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for l in 0..LANES {
            lanes[l] += x[l] * y[l];
        }
    }
    lanes
}

/// The sum of all lanes.
#[inline(always)]
fn total([p, q, r, s, t, u, v, w]: [f64; LANES]) -> f64 {
    ((p + q) + (r + s)) + ((t + u) + (v + w))
}

impl Process {
    /// `MOST` is a bound of the number of points. The widest vectors of the machine are used, with the same bits.
    #[inline(always)]
    fn predict<S: Simd, const MOST: usize>(
        &self,
        _: S,
        inputs: &Inputs,
        mean: &mut Scores,
        spread: bool,
    ) -> f64 {
        let mut kernel = [0.0; MOST];
        let count = self.points.first().map_or(0, Vec::len).min(MOST);
        let kernel = &mut kernel[..count];
        for ((points, length), input) in self.points.iter().zip(&self.lengths).zip(inputs) {
            let at = input / length;
            for (k, point) in kernel.iter_mut().zip(points) {
                *k += (at - point) * (at - point);
            }
        }
        // Blocks of fixed length become vector code.
        for block in kernel.chunks_exact_mut(LANES) {
            let squares: [f64; LANES] = std::array::from_fn(|l| block[l]);
            block.copy_from_slice(&squares.map(|square| math::exp(-0.5 * square)));
        }
        for (m, weights) in mean.iter_mut().zip(&self.weights) {
            *m = total(products(weights, kernel));
        }
        if !spread {
            return 1.0;
        }
        let (mut reduced, mut rows) = ([0.0; LANES], self.reduction.as_slice());
        for (i, k) in kernel.iter().enumerate() {
            let (row, rest) = rows.split_at((i / LANES + 1) * LANES);
            let row = products(row, kernel);
            for l in 0..LANES {
                reduced[l] += k * row[l];
            }
            rows = rest;
        }
        // Rounding must not make the variance smaller than that of the noise.
        math::at_least(1.0 - total(reduced), 0.0) + self.noise
    }
}

impl Transition {
    /// Writes the mean of the next scores and returns the factor of their variances; 1 if the spread is not asked for.
    pub(super) fn predict(&self, inputs: &Inputs, mean: &mut Scores, spread: bool) -> f64 {
        match self {
            Self::Process(process) => match process.points.first().map_or(0, Vec::len) {
                ..=128 => {
                    dispatch!(Level::new(), simd => process.predict::<_, 128>(simd, inputs, mean, spread))
                }
                _ => {
                    dispatch!(Level::new(), simd => process.predict::<_, MOST_POINTS>(simd, inputs, mean, spread))
                }
            },
            Self::Linear(linear) => {
                for (m, row) in mean.iter_mut().zip(&linear.rows) {
                    *m = row.last().copied().unwrap_or(0.0);
                    for (coefficient, input) in row[..row.len() - 1].iter().zip(inputs) {
                        *m += coefficient * input;
                    }
                }
                1.0
            }
        }
    }

    /// The variance of each output where the factor is 1.
    pub(super) fn variances(&self) -> &[f64] {
        match self {
            Self::Process(process) => &process.signals,
            Self::Linear(linear) => &linear.variances,
        }
    }

    /// The unit of an input in the distance between pairs.
    pub(super) fn unit(&self, input: usize) -> f64 {
        match self {
            Self::Process(process) => process.lengths[input],
            Self::Linear(_) => 1.0,
        }
    }

    /// Whether it takes and gives these numbers of scores and all its lists fit together.
    pub(super) fn fits(&self, inputs: usize, outputs: usize) -> bool {
        match self {
            Self::Process(p) => {
                let count = p.points.first().map_or(0, Vec::len);
                p.lengths.len() == inputs
                    && p.lengths.iter().copied().all(is_positive)
                    && is_positive(p.noise)
                    && p.points.len() == inputs
                    && p.points.iter().all(|list| list.len() == count)
                    && (1..=MOST_POINTS).contains(&count)
                    && count % LANES == 0
                    && p.weights.len() == outputs
                    && p.weights.iter().all(|list| list.len() == count)
                    && p.reduction.len() == count * (count / LANES + 1) * LANES / 2
                    && p.signals.len() == outputs
                    && p.signals.iter().copied().all(is_positive)
            }
            Self::Linear(l) => {
                l.rows.len() == outputs
                    && l.rows.iter().all(|row| row.len() == inputs + 1)
                    && l.variances.len() == outputs
                    && l.variances.iter().copied().all(is_positive)
            }
        }
    }
}
