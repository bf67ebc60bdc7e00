//! The mixture of bets against "the rival is at least e better than the leader".

use crate::base::math;

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
    let mut bets = [0.0; BETS];
    for (k, bet) in bets.iter_mut().enumerate() {
        let part = k as f64 / (BETS - 1) as f64;
        *bet = math::exp(math::ln(LEAST) + part * math::ln(MOST / LEAST));
    }
    bets
}

/// The logarithm of the mean of exponentials.
pub(super) fn log_mean(logs: &[f64; BETS]) -> f64 {
    let most = highest(logs);
    let sum: f64 = logs.iter().map(|log| math::exp(log - most)).sum();
    most + math::ln(sum / BETS as f64)
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
    let least = most - math::ln(BETS as f64);
    if least >= threshold { least } else { log_mean(logs) }
}

/// Logarithms of the factors of one Boolean trial that the rival wins, ties or loses, for each bet.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    win: [f64; BETS],
    tie: [f64; BETS],
    lose: [f64; BETS],
}

impl Factors {
    /// For a gap, with the bets of the mixture. Each factor lies in [0.05, 3]. The loops are vector code.
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
