//! Small continuous-time chains, solved by uniformisation (Jensen 1953): the jumps of a Poisson clock, of
//! which a few change nothing.

/// A chain; states are numbered, state 0 is the first.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    /// For each state its successors with their rates.
    pub(crate) rates: Vec<Vec<(usize, f64)>>,
}

impl Chain {
    /// The chain of all states that can be reached, and the states.
    pub(crate) fn explored<S: Clone + PartialEq>(
        first: S,
        moves: impl Fn(&S) -> Vec<(f64, S)>,
    ) -> (Self, Vec<S>) {
        let (mut states, mut rates) = (vec![first], Vec::new());
        while rates.len() < states.len() {
            let mut row = Vec::new();
            for (rate, next) in moves(&states[rates.len()]) {
                let at = states.iter().position(|s| *s == next).unwrap_or_else(|| {
                    states.push(next);
                    states.len() - 1
                });
                row.push((at, rate));
            }
            rates.push(row);
        }
        (Self { rates }, states)
    }

    /// The same chain, but some states are never left.
    fn frozen(&self, frozen: impl Fn(usize) -> bool) -> Self {
        let row = |(s, row): (usize, &Vec<(usize, f64)>)| if frozen(s) { Vec::new() } else { row.clone() };
        Self { rates: self.rates.iter().enumerate().map(row).collect() }
    }

    /// For each state, the expectation of a value of the state at a time, and its integral up to then.
    pub(crate) fn later(&self, value: &[f64], time: f64) -> (Vec<f64>, Vec<f64>) {
        let out = |row: &Vec<(usize, f64)>| row.iter().map(|(_, rate)| rate).sum::<f64>();
        let clock = self.rates.iter().map(out).fold(1e-3, f64::max);
        let mut now = value.to_vec();
        let (mut at, mut integral) = (vec![0.0; now.len()], vec![0.0; now.len()]);
        // Probability of k ticks, in logarithms, and of more than k.
        let mean = clock * time;
        let (mut ln_p, mut more) = (-mean, 1.0);
        let mut k = 0.0;
        while k < mean + 12.0 * mean.sqrt() + 60.0 {
            let p = f64::exp(ln_p);
            more -= p;
            for s in 0..now.len() {
                at[s] += p * now[s];
                integral[s] += more.max(0.0) / clock * now[s];
            }
            let step = |s: usize| {
                let stay = 1.0 - out(&self.rates[s]) / clock;
                self.rates[s].iter().fold(stay * now[s], |sum, (to, rate)| sum + rate / clock * now[*to])
            };
            now = (0..now.len()).map(step).collect();
            k += 1.0;
            ln_p += (mean / k).ln();
        }
        (at, integral)
    }

    /// For each state, the probability of `p U[from, to] q`, where a further value takes the place of q's truth.
    pub(crate) fn until(
        &self,
        p: impl Fn(usize) -> bool,
        q: impl Fn(usize) -> bool,
        (from, to): (f64, f64),
    ) -> Vec<f64> {
        let goal: Vec<f64> = (0..self.rates.len()).map(|s| f64::from(q(s))).collect();
        // From the beginning of the window on: goals stay goals, and where neither holds nothing is reached.
        let (reached, _) = self.frozen(|s| q(s) || !p(s)).later(&goal, to - from);
        if from == 0.0 {
            return reached;
        }
        // Before it p must hold, up to its beginning.
        let kept: Vec<f64> =
            reached.iter().enumerate().map(|(s, value)| if p(s) || q(s) { *value } else { 0.0 }).collect();
        let before = |s: usize| !p(s);
        // Who leaves p before the window is lost; who enters q but not p exactly there has measure zero.
        let kept: Vec<f64> =
            kept.iter().enumerate().map(|(s, value)| if before(s) { 0.0 } else { *value }).collect();
        let (found, _) = self.frozen(before).later(&kept, from);
        found.iter().enumerate().map(|(s, value)| if p(s) { *value } else { 0.0 }).collect()
    }
}

#[test]
fn a_single_jump_has_the_exponential_law() {
    let chain = Chain { rates: vec![vec![(1, 0.7)], vec![]] };
    let (at, integral) = chain.later(&[0.0, 1.0], 3.0);
    let gone = 1.0 - f64::exp(-2.1);
    assert!((at[0] - gone).abs() < 1e-12 && (at[1] - 1.0).abs() < 1e-12);
    assert!((integral[0] - (3.0 - gone / 0.7)).abs() < 1e-9 && (integral[1] - 3.0).abs() < 1e-9);
    let window = chain.until(|s| s == 0, |s| s == 1, (1.0, 3.0));
    assert!((window[0] - (f64::exp(-0.7) - f64::exp(-2.1))).abs() < 1e-12);
    assert_eq!(window[1], 0.0);
}
