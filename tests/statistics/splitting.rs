//! T24: splitting is unbiased, also where many paths share a level; its intervals are only asymptotic, and
//! they fail where the level does not see the way to the event.

use super::tally::uniform;
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::stats::splitting::{Adaptive, Effort, Flight, Scheme, Spread, Start};

/// A chain with fresh random numbers after each branching: the numbers of a path, and its states.
trait Chain {
    type State: Copy;
    fn first(&self) -> Self::State;
    fn next(&self, state: Self::State, key: TrialKey, step: u64) -> Self::State;
    /// The level, infinite at the event.
    fn level(&self, state: Self::State) -> f64;
    fn steps(&self) -> u64;
    /// Whether nothing more can come of a state.
    fn over(&self, state: Self::State) -> bool;
}

/// Runs the paths of one run; each keeps its states.
fn run<C: Chain>(chain: &C, scheme: &mut dyn Scheme, seed: u64, branch: u16) -> (f64, u64) {
    let (mut paths, mut steps): (Vec<Vec<C::State>>, u64) = (Vec::new(), 0);
    while !scheme.wanted().is_empty() {
        let mut flights = Vec::new();
        for start in scheme.wanted().to_vec() {
            let key = TrialKey { seed, index: paths.len() as u64, branch };
            let mut states = match start {
                Start::Anew => vec![chain.first()],
                Start::From { path, time } => paths[path][..=time as usize].to_vec(),
            };
            while (states.len() as u64) <= chain.steps() && !chain.over(states[states.len() - 1]) {
                let step = states.len() as u64;
                states.push(chain.next(states[states.len() - 1], key, step));
                steps += 1;
            }
            let mut flight = Flight::default();
            for (time, state) in states.iter().enumerate() {
                flight.rise(time as u64, chain.level(*state));
            }
            flights.push(flight);
            paths.push(states);
        }
        scheme.feed(flights);
    }
    (scheme.estimate(), steps)
}

/// x' = 0.9 x + N(0, 0.19) from its stationary law, 100 steps; the event is a state of at least `bound`.
struct Autoregression {
    bound: f64,
    /// In each step with so much probability the event comes out of the blue.
    hidden: f64,
}

impl Chain for Autoregression {
    type State = f64;
    fn first(&self) -> f64 {
        0.0
    }
    fn next(&self, x: f64, key: TrialKey, step: u64) -> f64 {
        let stream = Stream::of(key, 0, Purpose::Test);
        if stream.uniform(2 * step as u32 + 1) < self.hidden {
            return f64::INFINITY;
        }
        0.9 * x + 0.19f64.sqrt() * stream.normal_pair(2 * step as u32)[0]
    }
    fn level(&self, x: f64) -> f64 {
        if x >= self.bound { f64::INFINITY } else { x }
    }
    fn steps(&self) -> u64 {
        100
    }
    fn over(&self, x: f64) -> bool {
        x >= self.bound
    }
}

/// A gambler who wins a coin with probability 0.3 and stops at `goal` or ruined; many paths share a level.
struct Gambler {
    start: i32,
    goal: i32,
}

impl Chain for Gambler {
    type State = i32;
    fn first(&self) -> i32 {
        self.start
    }
    fn next(&self, coins: i32, key: TrialKey, step: u64) -> i32 {
        coins + if Stream::of(key, 0, Purpose::Test).uniform(step as u32) < 0.3 { 1 } else { -1 }
    }
    fn level(&self, coins: i32) -> f64 {
        if coins >= self.goal { f64::INFINITY } else { f64::from(coins) }
    }
    fn steps(&self) -> u64 {
        10_000
    }
    fn over(&self, coins: i32) -> bool {
        coins == 0 || coins == self.goal
    }
}

impl Gambler {
    /// ((q/p)^start - 1) / ((q/p)^goal - 1).
    fn exact(&self) -> f64 {
        let ratio: f64 = 0.7 / 0.3;
        (ratio.powi(self.start) - 1.0) / (ratio.powi(self.goal) - 1.0)
    }
}

/// The level for a chain that starts at 0, by quadrature on a grid; exact to five digits.
fn exceeds(bound: f64) -> f64 {
    // Density of x below the bound after each step, by the midpoint rule.
    let (low, cells) = (-6.0, 1_600usize);
    let width = (bound - low) / cells as f64;
    let at = |k: usize| low + (k as f64 + 0.5) * width;
    let normal = |x: f64| (-x * x / 0.38).exp() / (0.38 * std::f64::consts::PI).sqrt();
    let kernel: Vec<f64> =
        (0..cells * cells).map(|k| normal(at(k / cells) - 0.9 * at(k % cells)) * width).collect();
    let mut density: Vec<f64> = (0..cells).map(|k| normal(at(k))).collect();
    for _ in 1..100 {
        density = (0..cells)
            .map(|k| kernel[k * cells..][..cells].iter().zip(&density).map(|(a, b)| a * b).sum())
            .collect();
    }
    // What is left below is not enough to tell; sum the flow over the bound instead.
    1.0 - density.iter().sum::<f64>() * width
}

struct Sums {
    runs: f64,
    sum: f64,
    squares: f64,
}

fn repeat(runs: u32, mut one: impl FnMut(u16) -> f64) -> Sums {
    let mut sums = Sums { runs: f64::from(runs), sum: 0.0, squares: 0.0 };
    for k in 0..runs {
        let x = one(k as u16);
        sums.sum += x;
        sums.squares += x * x;
    }
    sums
}

impl Sums {
    /// Mean and standard error, over `exact`.
    fn ratio(&self, exact: f64) -> (f64, f64) {
        let mean = self.sum / self.runs;
        let variance = self.squares / self.runs - mean * mean;
        (mean / exact, (variance / self.runs).sqrt() / exact)
    }

    #[track_caller]
    fn is(&self, exact: f64) {
        let (ratio, error) = self.ratio(exact);
        assert!((ratio - 1.0).abs() < 4.0 * error, "{ratio} +- {error}");
    }
}

fn adaptive<C: Chain>(chain: &C, count: usize, kill: usize, seed: u64, k: u16) -> f64 {
    run(chain, &mut Adaptive::new(count, kill, seed, k).unwrap(), seed, k).0
}

fn autoregression(runs: u32) {
    let chain = Autoregression { bound: 5.0, hidden: 0.0 };
    let sums = repeat(runs, |k| adaptive(&chain, 100, 10, 70, k));
    let (ratio, error) = sums.ratio(1.7964e-5);
    if runs >= 1000 {
        assert!((0.85..=1.15).contains(&ratio), "{ratio} +- {error}");
    }
    sums.is(1.7964e-5);
}

/// Integer levels: ties everywhere.
fn gambler(runs: u32) {
    let chain = Gambler { start: 2, goal: 14 };
    repeat(runs, |k| adaptive(&chain, 50, 5, 71, k)).is(chain.exact());
    repeat(runs, |k| adaptive(&chain, 20, 1, 72, k)).is(chain.exact());
    let levels: Vec<f64> = (2..14).step_by(2).map(f64::from).collect();
    repeat(runs, |k| run(&chain, &mut Effort::new(50, levels.clone(), 73, k).unwrap(), 73, k).0)
        .is(chain.exact());
}

/// Giving up only `kill` of several paths with the same level is biased: the negative control.
fn biased_ties(runs: u32) {
    let chain = Gambler { start: 2, goal: 8 };
    let sums = repeat(runs, |k| {
        // The k-th smallest level, but only so many paths below it given up at random: (1 - kill / n) each.
        let (count, kill) = (20usize, 5usize);
        let mut made = 0u64;
        let mut coin = || {
            made += 1;
            uniform(74, u32::from(k), 1, made)
        };
        let path = |from: i32, number: u64| {
            let key = TrialKey { seed: 74, index: number, branch: k };
            let (mut coins, mut best, mut step) = (from, from, 0);
            while !chain.over(coins) {
                step += 1;
                coins = chain.next(coins, key, step);
                best = best.max(coins);
            }
            best
        };
        let mut number = 0;
        let mut live: Vec<i32> = (0..count)
            .map(|_| {
                number += 1;
                path(chain.start, number)
            })
            .collect();
        let mut weight = 1.0;
        for _ in 0..200 {
            live.sort_unstable();
            let level = live[kill - 1];
            if level == chain.goal || live[count - 1] == level {
                break;
            }
            weight *= 1.0 - kill as f64 / count as f64;
            for slot in 0..kill {
                let parent = kill + (coin() * (count - kill) as f64) as usize;
                // From just above the level of the k-th, even if the parent was not there.
                let from = live[parent].min(level + 1);
                number += 1;
                live[slot] = path(from, number).max(from);
            }
        }
        weight * live.iter().filter(|best| **best == chain.goal).count() as f64 / count as f64
    });
    let (ratio, error) = sums.ratio(chain.exact());
    assert!((ratio - 1.0).abs() > 4.0 * error, "{ratio} +- {error} ought to be biased");
}

/// A jump of 1e-8 a step that the level does not see: nearly all intervals lie far below 1e-6.
fn hidden_route(repetitions: u16) {
    let chain = Autoregression { bound: 6.5, hidden: 1e-8 };
    let (mut held, mut low) = (0, 0);
    for k in 0..repetitions {
        let estimates: Vec<f64> = (0..20).map(|r| adaptive(&chain, 100, 10, 75, 20 * k + r)).collect();
        let spread = Spread::of(&estimates, 0.05).unwrap();
        held += u32::from(spread.low <= 1e-6 && spread.high >= 1e-6);
        low += u32::from(spread.high < 1e-6);
    }
    assert!(
        held * 5 <= u32::from(repetitions) && low > 0,
        "{held} of {repetitions} intervals hold the truth"
    );
}

/// The lower bound of runs keeps its error whatever their law; what supposes a normal mean does not.
fn floors(repetitions: u32) {
    use super::tally::uniform;
    use smc::stats::splitting::floor;
    // Laws of mean 1: nearly always the same, sometimes nothing; seldom much; a product of many factors.
    type Law = fn(&dyn Fn(u32) -> f64) -> f64;
    let laws: [Law; 3] = [
        |u| if u(0) < 0.95 { 1.0 / 0.95 } else { 0.0 },
        |u| if u(0) < 0.02 { 50.0 } else { 0.0 },
        |u| (0..12).map(|k| if u(k) < 0.5 { 1.5 } else { 0.5 }).product(),
    ];
    let allowed = f64::from(repetitions) * 0.05 + 3.0 * (f64::from(repetitions) * 0.05 * 0.95).sqrt();
    let mut normal = 0;
    for (at, law) in laws.iter().enumerate() {
        let mut missed = 0;
        for k in 0..repetitions {
            let draws: Vec<f64> =
                (0..20).map(|run| law(&|n| uniform(80 + at as u64, k, run, u64::from(n)))).collect();
            missed += u32::from(floor(&draws, 0.05) > 1.0);
            normal += u32::from(at == 0 && Spread::of(&draws, 0.05).unwrap().low > 1.0);
        }
        assert!(f64::from(missed) <= allowed, "law {at}: {missed} of {repetitions}");
    }
    // 20 equal runs, with probability 0.95^20 = 0.36, leave no doubt to the normal law.
    assert!(f64::from(normal) > 0.3 * f64::from(repetitions), "{normal}");
}

#[test]
fn the_floor_keeps_its_error() {
    floors(400);
}

#[test]
fn t24_adaptive_splitting_is_unbiased() {
    autoregression(150);
}

#[test]
fn t24_ties_are_handled() {
    gambler(400);
    biased_ties(2_000);
}

#[test]
fn t24_a_hidden_route_breaks_the_interval() {
    hidden_route(5);
}

#[test]
#[ignore = "full number of replications"]
fn full_splitting() {
    let exact = exceeds(5.0);
    assert!((exact / 1.7964e-5 - 1.0).abs() < 0.01, "{exact}");
    autoregression(1_000);
    gambler(4_000);
    hidden_route(50);
    floors(4_000);
}
