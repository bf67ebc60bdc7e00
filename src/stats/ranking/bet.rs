//! The mixture of bets against "the rival is at least e better than the leader".

use crate::base::math;
use crate::stats::bets::geometric;

/// Number of bets in the mixture; the cost of a race hardly depends on it.
pub(super) const BETS: usize = 12;
const LEAST: f64 = 0.02;
const MOST: f64 = 0.95;
/// What rounding can add to the logarithm of a capital, for each trial: the factor and its logarithm are off by parts
/// in 1e16, and so are sums of logarithms, by parts of their size (below 1000: no capital of e^-1000 comes back).
/// It is taken off, so that the bound of the race holds for any number of trials.
pub(super) const ROUNDING: f64 = 1e-14;

/// The bets, in geometric steps.
pub(super) fn bets() -> [f64; BETS] {
    geometric(LEAST, MOST)
}

/// Gaps from which on bets are larger.
const WIDE: f64 = 0.25;

/// The bets on a gap. Where it is wide less can be lost in a trial, so they are larger: each factor `1 + bet * (gap - d)` is
/// still at least the one of a smaller gap, for each difference d.
pub(super) fn bets_on(gap: f64, epsilon: f64, bets: &[f64; BETS]) -> [f64; BETS] {
    let least = math::at_least(epsilon, WIDE);
    let scale = if gap > least { (1.0 - least) / math::at_least(1.0 - gap, 1e-6) } else { 1.0 };
    bets.map(|bet| bet * scale)
}

/// Logarithm of the number of bets: between the mean and the highest of them.
const LN_BETS: f64 = 2.484_906_649_788_000_4;

/// Terms so far below the highest change no bit of the sum: a dozen of them stay far below half a unit in its
/// last place.
const NOTHING: f64 = -45.0;

/// The logarithm of the mean of exponentials.
pub(super) fn log_mean(logs: &[f64; BETS]) -> f64 {
    let most = highest(logs);
    let counted = logs.iter().map(|log| log - most).filter(|log| *log > NOTHING);
    let sum: f64 = counted.map(math::exp).sum();
    most + math::ln(sum / BETS as f64)
}

/// The smaller of the logarithm of the mean and of `least`.
pub(super) fn log_mean_below(logs: &[f64; BETS], least: f64) -> f64 {
    if highest(logs) - LN_BETS >= least { least } else { math::at_most(log_mean(logs), least) }
}

/// How fast the evidence grows with each trial that a leader of this mean is certified within epsilon of an arm that
/// never fails: of the bet that grows fastest. Scores are taken to be 0 or 1, which is the slowest.
pub(super) fn growth(mean: f64, epsilon: f64) -> f64 {
    let of = |bet: &f64| {
        mean * math::ln(1.0 + bet * epsilon) + (1.0 - mean) * math::ln(1.0 + bet * (epsilon - 1.0))
    };
    bets().iter().map(of).fold(f64::NEG_INFINITY, math::at_least)
}

fn highest(logs: &[f64; BETS]) -> f64 {
    logs.iter().fold(f64::NEG_INFINITY, |a, b| math::at_least(a, *b))
}

/// The same where only the side of `threshold` matters: the mean lies between the highest term over their
/// number and the highest term, and mostly that decides.
pub(super) fn log_mean_near(logs: &[f64; BETS], threshold: f64) -> f64 {
    let most = highest(logs);
    if most < threshold {
        return most;
    }
    let least = most - LN_BETS;
    if least >= threshold { least } else { log_mean(logs) }
}

/// Whether the logarithm of the mean reaches a threshold. Bounds of the exponentials, `(1 - x/n)^n` and
/// `(1 + x/n)^-n`, mostly decide; what they leave open is computed.
pub(super) fn reaches(logs: &[f64; BETS], threshold: f64) -> bool {
    let most = highest(logs);
    if most < threshold {
        return false;
    }
    if most - LN_BETS >= threshold {
        return true;
    }
    let (mut low, mut high) = ([0.0; BETS], [0.0; BETS]);
    for k in 0..BETS {
        let part = (most - logs[k]) * (1.0 / 64.0);
        let (mut below, mut above) = (math::at_least(1.0 - part, 0.0), 1.0 / (1.0 + part));
        for _ in 0..6 {
            below *= below;
            above *= above;
        }
        (low[k], high[k]) = (below, above);
    }
    let wanted = BETS as f64 * math::exp(threshold - most);
    // The rounding of all this stays below the slack.
    if low.iter().sum::<f64>() > wanted * (1.0 + 1e-12) {
        true
    } else if high.iter().sum::<f64>() < wanted * (1.0 - 1e-12) {
        false
    } else {
        log_mean(logs) >= threshold
    }
}

/// Logarithms of the factors of one Boolean trial that the rival wins, ties or loses, for each bet.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    win: [f64; BETS],
    tie: [f64; BETS],
    lose: [f64; BETS],
}

impl Factors {
    /// For a gap, with the bets on it. Each factor is at least 0.05. The loops are vector code.
    pub(super) fn new(bets: &[f64; BETS], gap: f64) -> Self {
        let of = |d: f64| {
            let mut logs = [0.0; BETS];
            for (log, bet) in logs.iter_mut().zip(bets) {
                *log = math::ln(1.0 + bet * (gap - d));
            }
            logs
        };
        Self { win: of(1.0), tie: of(0.0), lose: of(-1.0) }
    }

    /// The logarithms of all bets' capital, less what rounding can have added.
    pub(super) fn logs(&self, wins: u64, ties: u64, losses: u64) -> [f64; BETS] {
        let (w, t, l) = (wins as f64, ties as f64, losses as f64);
        let rounding = ROUNDING * (w + t + l);
        std::array::from_fn(|k| w * self.win[k] + t * self.tie[k] + l * self.lose[k] - rounding)
    }
}
