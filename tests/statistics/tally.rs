//! Replications, draws by address, and the two rules of judgement.

use smc::base::random::{Purpose, Stream, TrialKey};

/// Uniform number of trial `index` of replication `run`; `arm` tells independent arms apart.
pub(crate) fn uniform(seed: u64, run: u32, arm: u16, index: u64) -> f64 {
    Stream::of(TrialKey { seed, index, branch: arm }, run, Purpose::Test).uniform(0)
}

/// Events and numbers of trials over replications.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) runs: f64,
    pub(crate) hits: f64,
    pub(crate) sum: f64,
    pub(crate) squares: f64,
}

impl Tally {
    pub(crate) fn over(runs: u32, mut run: impl FnMut(u32) -> (bool, f64)) -> Self {
        let mut tally = Self::default();
        for k in 0..runs {
            let (hit, n) = run(k);
            tally.runs += 1.0;
            tally.hits += f64::from(u8::from(hit));
            tally.sum += n;
            tally.squares += n * n;
        }
        tally
    }

    pub(crate) fn share(&self) -> f64 {
        self.hits / self.runs
    }

    pub(crate) fn mean(&self) -> f64 {
        self.sum / self.runs
    }

    /// A guarantee: no more events than `error` allows, plus three standard deviations.
    #[track_caller]
    pub(crate) fn guarantees(&self, error: f64) {
        assert!(self.hits <= self.allowed(error), "{self:?}: {} against {error}", self.share());
    }

    /// A negative control: more events than a guarantee of `error` allows.
    #[track_caller]
    pub(crate) fn breaks(&self, error: f64) {
        assert!(self.hits > self.allowed(error), "{self:?}: {} against {error}", self.share());
    }

    fn allowed(&self, error: f64) -> f64 {
        self.runs * error + 3.0 * (self.runs * error * (1.0 - error)).sqrt()
    }

    /// An exact target: within four standard deviations.
    #[track_caller]
    pub(crate) fn equals(&self, share: f64) {
        let spread = 4.0 * (self.runs * share * (1.0 - share)).sqrt();
        assert!((self.hits - self.runs * share).abs() <= spread, "{self:?}: {} is not {share}", self.share());
    }

    /// An exact mean number of trials: within four standard errors.
    #[track_caller]
    pub(crate) fn takes(&self, mean: f64) {
        let variance = self.squares / self.runs - self.mean() * self.mean();
        let error = 4.0 * (variance / self.runs).sqrt();
        assert!((self.mean() - mean).abs() <= error, "{} +- {error} is not {mean}", self.mean());
    }
}
