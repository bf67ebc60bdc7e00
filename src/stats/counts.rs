//! Outcomes of trials and how many there were.

/// The outcome of one trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// It held.
    True,
    /// It did not hold.
    False,
    /// The trial ended before that was known.
    Unresolved,
}

impl From<bool> for Outcome {
    fn from(held: bool) -> Self {
        if held { Self::True } else { Self::False }
    }
}

/// Successes and failures among resolved trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Counts {
    /// Trials where it held.
    pub successes: u64,
    /// Trials where it did not.
    pub failures: u64,
}

impl Counts {
    /// All trials.
    pub const fn trials(self) -> u64 {
        self.successes + self.failures
    }

    /// Adds one trial.
    pub const fn add(&mut self, success: bool) {
        self.successes += success as u64;
        self.failures += !success as u64;
    }

    /// The share of successes; 1/2 before the first trial.
    pub fn share(self) -> f64 {
        if self.trials() == 0 { 0.5 } else { self.successes as f64 / self.trials() as f64 }
    }
}
