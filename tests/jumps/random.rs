//! Random small chains and random formulas: every verdict of the engine against a slow evaluation of the definition on
//! the trace, and shares of trials against uniformisation.

use super::chain::Chain;
use super::traces::{program, trace};
use super::{answered, compiled, count, fits};
use proptest::prelude::*;

/// Number of states of a chain.
const STATES: usize = 4;
/// Seconds up to the horizon, in quarters.
const HORIZON: u32 = 16;
/// Units of a quarter of a second. Times of jumps are rounded to multiples of eight, far finer than any
/// difference that matters here; so there is room for times between any two.
const QUARTER: i64 = 8 << 28;

/// A formula over the state of a chain; windows are in quarters of seconds.
#[derive(Clone, Debug)]
enum Formula {
    Is(usize),
    AtMost(usize),
    Not(Box<Formula>),
    Both(Box<Formula>, Box<Formula>),
    Either(Box<Formula>, Box<Formula>),
    Finally(u32, u32, Box<Formula>),
    Globally(u32, u32, Box<Formula>),
    Until(u32, u32, Box<Formula>, Box<Formula>),
    Weak(u32, Box<Formula>, Box<Formula>),
    Release(u32, Box<Formula>, Box<Formula>),
}

impl Formula {
    /// As it is written.
    fn text(&self) -> String {
        let seconds = |quarters: &u32| f64::from(*quarters) / 4.0;
        let window = |a: &u32, b: &u32| {
            if *a == 0 {
                format!("<={} s", seconds(b))
            } else {
                format!("[{} s, {} s]", seconds(a), seconds(b))
            }
        };
        match self {
            Self::Is(s) => format!("(c.s == {s})"),
            Self::AtMost(s) => format!("(c.s <= {s})"),
            Self::Not(p) => format!("!{}", p.text()),
            Self::Both(p, q) => format!("({} & {})", p.text(), q.text()),
            Self::Either(p, q) => format!("({} | {})", p.text(), q.text()),
            Self::Finally(a, b, p) => format!("(F{} {})", window(a, b), p.text()),
            Self::Globally(a, b, p) => format!("(G{} {})", window(a, b), p.text()),
            Self::Until(a, b, p, q) => format!("({} U{} {})", p.text(), window(a, b), q.text()),
            Self::Weak(b, p, q) => format!("({} W{} {})", p.text(), window(&0, b), q.text()),
            Self::Release(b, p, q) => format!("({} R{} {})", p.text(), window(&0, b), q.text()),
        }
    }

    /// How far ahead it looks, in quarters.
    fn reach(&self) -> u32 {
        match self {
            Self::Is(_) | Self::AtMost(_) => 0,
            Self::Not(p) => p.reach(),
            Self::Both(p, q) | Self::Either(p, q) => p.reach().max(q.reach()),
            Self::Finally(_, b, p) | Self::Globally(_, b, p) => b + p.reach(),
            Self::Until(_, b, p, q) | Self::Weak(b, p, q) | Self::Release(b, p, q) => {
                b + p.reach().max(q.reach())
            }
        }
    }

    /// Its truth at all times, from the definitions.
    fn truth(&self, states: &[(i64, usize)]) -> Truth {
        let of_state = |is: &dyn Fn(usize) -> bool| Truth {
            at: states.iter().map(|(time, _)| *time).collect(),
            point: states.iter().map(|(_, s)| is(*s)).collect(),
            gap: states.iter().map(|(_, s)| is(*s)).collect(),
        };
        let quarters = |a: u32, b: u32| (i64::from(a) * QUARTER, i64::from(b) * QUARTER);
        match self {
            Self::Is(s) => of_state(&|x| x == *s),
            Self::AtMost(s) => of_state(&|x| x <= *s),
            Self::Not(p) => p.truth(states).map(|p| !p),
            Self::Both(p, q) => {
                let (p, q) = (p.truth(states), q.truth(states));
                Truth::new(&[&p, &q], (0, 0), |x| p.value(x) && q.value(x))
            }
            Self::Either(p, q) => {
                let (p, q) = (p.truth(states), q.truth(states));
                Truth::new(&[&p, &q], (0, 0), |x| p.value(x) || q.value(x))
            }
            Self::Finally(a, b, p) => until(&Truth::always(), &p.truth(states), quarters(*a, *b)),
            Self::Globally(a, b, p) => {
                let p = p.truth(states).map(|p| !p);
                until(&Truth::always(), &p, quarters(*a, *b)).map(|found| !found)
            }
            Self::Until(a, b, p, q) => until(&p.truth(states), &q.truth(states), quarters(*a, *b)),
            Self::Weak(b, p, q) => {
                let both = Self::Either(
                    Box::new(Self::Until(0, *b, p.clone(), q.clone())),
                    Box::new(Self::Globally(0, *b, p.clone())),
                );
                both.truth(states)
            }
            Self::Release(b, p, q) => {
                let not = |f: &Self| f.truth(states).map(|f| !f);
                until(&not(p), &not(q), quarters(0, *b)).map(|found| !found)
            }
        }
    }
}

/// A truth over time: at times (multiples of 8 units) and between them.
#[derive(Clone, Debug)]
struct Truth {
    at: Vec<i64>,
    point: Vec<bool>,
    /// Between each time and the next one.
    gap: Vec<bool>,
}

impl Truth {
    fn always() -> Self {
        Self { at: vec![0], point: vec![true], gap: vec![true] }
    }

    fn map(mut self, f: impl Fn(bool) -> bool) -> Self {
        self.point.iter_mut().chain(&mut self.gap).for_each(|value| *value = f(*value));
        self
    }

    fn value(&self, x: i64) -> bool {
        let k = self.at.partition_point(|at| *at <= x) - 1;
        if self.at[k] == x { self.point[k] } else { self.gap[k] }
    }

    /// The function with the values `f`, which changes only where the ends of a window meet a change of its
    /// operands.
    fn new(operands: &[&Self], (a, b): (i64, i64), f: impl Fn(i64) -> bool) -> Self {
        let mut at: Vec<i64> = vec![0];
        for operand in operands {
            at.extend(operand.at.iter().flat_map(|t| [t - a, t - b, *t]).filter(|t| *t >= 0));
        }
        at.sort_unstable();
        at.dedup();
        let point = at.iter().map(|t| f(*t)).collect();
        let gap = at.iter().map(|t| f(*t + 4)).collect();
        Self { at, point, gap }
    }
}

/// `p U[a, b] q`: q at some time of the window, and p at every time before it.
fn until(p: &Truth, q: &Truth, (a, b): (i64, i64)) -> Truth {
    Truth::new(&[p, q], (a, b), |x| {
        // The times that matter, and one between each two of them.
        let mut times: Vec<i64> =
            p.at.iter().chain(&q.at).copied().filter(|t| *t > x && *t < x + b).collect();
        times.extend([x, x + a, x + b]);
        times.sort_unstable();
        times.dedup();
        let between: Vec<i64> = times.windows(2).map(|pair| pair[0] + (pair[1] - pair[0]) / 2).collect();
        let inside = |t: &i64| between.contains(t);
        times.extend(&between);
        times.sort_unstable();
        times.iter().filter(|t| **t >= x + a && q.value(**t)).any(|goal| {
            // Of the open span around a time inside it, some lies before that time.
            let before = |t: &&i64| **t < *goal || (**t == *goal && inside(goal));
            times.iter().filter(before).all(|t| p.value(*t))
        })
    })
}

fn formula() -> impl Strategy<Value = Formula> {
    let leaf = prop_oneof![(0..STATES).prop_map(Formula::Is), (0..STATES).prop_map(Formula::AtMost)];
    leaf.prop_recursive(3, 12, 2, |inner| {
        let p = || inner.clone().prop_map(Box::new);
        let w = || (0u32..=4, 0u32..=6).prop_map(|(a, more)| (a, a + more));
        prop_oneof![
            p().prop_map(Formula::Not),
            (p(), p()).prop_map(|(p, q)| Formula::Both(p, q)),
            (p(), p()).prop_map(|(p, q)| Formula::Either(p, q)),
            (w(), p()).prop_map(|((a, b), p)| Formula::Finally(a, b, p)),
            (w(), p()).prop_map(|((a, b), p)| Formula::Globally(a, b, p)),
            (w(), p(), p()).prop_map(|((a, b), p, q)| Formula::Until(a, b, p, q)),
            (0u32..=6, p(), p()).prop_map(|(b, p, q)| Formula::Weak(b, p, q)),
            (0u32..=6, p(), p()).prop_map(|(b, p, q)| Formula::Release(b, p, q)),
        ]
    })
    .prop_filter("looks beyond the horizon", |f| f.reach() <= HORIZON)
}

/// For each state the rates to all states, in thirds per second; many are 0, and some states are never left.
pub(crate) type Rates = Vec<[u32; STATES]>;

pub(crate) fn rates() -> impl Strategy<Value = Rates> {
    let rate = || prop_oneof![3 => Just(0u32), 4 => 1u32..=9];
    proptest::collection::vec([rate(), rate(), rate(), rate()], STATES)
}

pub(crate) fn scenario(rates: &Rates) -> String {
    let mut text =
        format!("horizon = {} s\nprocess c {{ var s: 0 .. {} = 0\n", f64::from(HORIZON) / 4.0, STATES - 1);
    for (from, row) in rates.iter().enumerate() {
        for (to, rate) in row.iter().enumerate() {
            if to != from && *rate > 0 {
                text.push_str(&format!("when s == {from} at {rate} /s / 3 -> s = {to}\n"));
            }
        }
    }
    // Keeps the clock one of jumps where nothing else does.
    text + "when s < 0 at 1 /s -> s = 0 }\n"
}

fn chain(rates: &Rates) -> Chain {
    let row = |(from, row): (usize, &[u32; STATES])| {
        let left = row.iter().enumerate().filter(|(to, rate)| *to != from && **rate > 0);
        left.map(|(to, rate)| (to, f64::from(*rate) / 3.0)).collect()
    };
    Chain { rates: rates.iter().enumerate().map(row).collect() }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn verdicts_are_those_of_the_definition(
        rates in rates(),
        formulas in proptest::collection::vec(formula(), 3),
        seed in 0u64..1_000_000,
    ) {
        const TRIALS: u64 = 150;
        let text = scenario(&rates);
        let queries: Vec<String> = formulas
            .iter()
            .map(|f| format!("estimate P({}) by fixed(trials = {TRIALS})\n", f.text()))
            .collect();
        let run = answered(&compiled(&text, &queries.concat()).unwrap(), seed, 1);
        let program = program(&text);
        let mut held = [0; 3];
        for index in 0..TRIALS {
            let eights = (QUARTER / 8) as f64 / 0.25;
            let states: Vec<(i64, usize)> = trace(&program, seed, index)
                .iter()
                .map(|(time, values)| (8 * (time * eights).round() as i64, values[0] as usize))
                .collect();
            for (held, formula) in held.iter_mut().zip(&formulas) {
                *held += u64::from(formula.truth(&states).value(0));
            }
        }
        for ((held, formula), result) in held.iter().zip(&formulas).zip(&run.results) {
            prop_assert_eq!(result.consumed.counts.successes, *held, "{} of {}", formula.text(), text);
        }
    }

    #[test]
    fn shares_are_those_of_uniformisation(
        rates in rates(),
        (p, q) in (0u32..16, 0u32..16),
        (from, more) in (0u32..=6, 0u32..=8),
    ) {
        const TRIALS: u64 = 3000;
        let is = |set: u32| move |s: usize| set >> s & 1 == 1;
        let words = |set: u32| {
            let words: Vec<String> = (0..STATES).filter(|s| is(set)(*s)).map(|s| format!("c.s == {s}")).collect();
            if words.is_empty() { "false".to_owned() } else { words.join(" | ") }
        };
        let to = from + more;
        let (a, b) = (f64::from(from) / 4.0, f64::from(to) / 4.0);
        let formula = format!("({}) U[{a} s, {b} s] ({})", words(p), words(q));
        let exact = chain(&rates).until(is(p), is(q), (a, b))[0];
        let held = count(&scenario(&rates), &formula, TRIALS);
        prop_assert!(fits(held, TRIALS, exact), "{}: {} of {}, {}", formula, held, TRIALS, exact);
    }
}
