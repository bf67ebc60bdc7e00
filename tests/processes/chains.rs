//! Random small chains and random formulas: estimates against the probability of all paths, and each
//! monitor against the definition on its own trace.

use super::{compiled, fits, shown};
use proptest::prelude::*;

/// Last state of a path.
const LAST: usize = 6;
/// Number of states of a chain.
const STATES: usize = 4;

/// A formula over the state of a chain.
#[derive(Clone, Debug)]
enum Formula {
    Is(usize),
    AtMost(usize),
    Not(Box<Formula>),
    Both(Box<Formula>, Box<Formula>),
    Either(Box<Formula>, Box<Formula>),
    Implies(Box<Formula>, Box<Formula>),
    Finally(usize, usize, Box<Formula>),
    Globally(usize, usize, Box<Formula>),
    Next(usize, Box<Formula>),
    Until(usize, usize, Box<Formula>, Box<Formula>),
    Weak(usize, usize, Box<Formula>, Box<Formula>),
    Release(usize, usize, Box<Formula>, Box<Formula>),
}

impl Formula {
    /// As it is written.
    fn text(&self) -> String {
        let window = |a: &usize, b: &usize| {
            if *a == 0 { format!("<=#{b}") } else { format!("[#{a}, {b} steps]") }
        };
        match self {
            Self::Is(s) => format!("(c.s == {s})"),
            Self::AtMost(s) => format!("(c.s <= {s})"),
            Self::Not(p) => format!("!{}", p.text()),
            Self::Both(p, q) => format!("({} & {})", p.text(), q.text()),
            Self::Either(p, q) => format!("({} | {})", p.text(), q.text()),
            Self::Implies(p, q) => format!("({} => {})", p.text(), q.text()),
            Self::Finally(a, b, p) => format!("(F{} {})", window(a, b), p.text()),
            Self::Globally(a, b, p) => format!("(G{} {})", window(a, b), p.text()),
            Self::Next(1, p) => format!("(X {})", p.text()),
            Self::Next(k, p) => format!("(X<=#{k} {})", p.text()),
            Self::Until(a, b, p, q) => format!("({} U{} {})", p.text(), window(a, b), q.text()),
            Self::Weak(a, b, p, q) => format!("({} W{} {})", p.text(), window(a, b), q.text()),
            Self::Release(a, b, p, q) => format!("({} R{} {})", p.text(), window(a, b), q.text()),
        }
    }

    /// How many states ahead it looks.
    fn reach(&self) -> usize {
        match self {
            Self::Is(_) | Self::AtMost(_) => 0,
            Self::Not(p) => p.reach(),
            Self::Both(p, q) | Self::Either(p, q) | Self::Implies(p, q) => p.reach().max(q.reach()),
            Self::Finally(_, b, p) | Self::Globally(_, b, p) | Self::Next(b, p) => b + p.reach(),
            Self::Until(_, b, p, q) | Self::Weak(_, b, p, q) | Self::Release(_, b, p, q) => {
                b + p.reach().max(q.reach())
            }
        }
    }

    /// By the definition, at a position of a path.
    fn holds(&self, path: &[usize], at: usize) -> bool {
        match self {
            Self::Is(s) => path[at] == *s,
            Self::AtMost(s) => path[at] <= *s,
            Self::Not(p) => !p.holds(path, at),
            Self::Both(p, q) => p.holds(path, at) && q.holds(path, at),
            Self::Either(p, q) => p.holds(path, at) || q.holds(path, at),
            Self::Implies(p, q) => !p.holds(path, at) || q.holds(path, at),
            Self::Finally(a, b, p) => (*a..=*b).any(|k| p.holds(path, at + k)),
            Self::Globally(a, b, p) => (*a..=*b).all(|k| p.holds(path, at + k)),
            Self::Next(k, p) => p.holds(path, at + k),
            Self::Until(a, b, p, q) => {
                (*a..=*b).any(|k| q.holds(path, at + k) && (0..k).all(|j| p.holds(path, at + j)))
            }
            Self::Weak(a, b, p, q) => {
                (0..=*b).all(|k| p.holds(path, at + k))
                    || Self::Until(*a, *b, p.clone(), q.clone()).holds(path, at)
            }
            Self::Release(a, b, p, q) => {
                let not = |f: &Self| Box::new(Self::Not(Box::new(f.clone())));
                !Self::Until(*a, *b, not(p), not(q)).holds(path, at)
            }
        }
    }
}

fn formula() -> impl Strategy<Value = Formula> {
    let leaf = prop_oneof![(0..STATES).prop_map(Formula::Is), (0..STATES).prop_map(Formula::AtMost)];
    leaf.prop_recursive(3, 12, 2, |inner| {
        let p = || inner.clone().prop_map(Box::new);
        let w = || (0usize..=2, 0usize..=2).prop_map(|(a, more)| (a, a + more));
        prop_oneof![
            p().prop_map(Formula::Not),
            (p(), p()).prop_map(|(p, q)| Formula::Both(p, q)),
            (p(), p()).prop_map(|(p, q)| Formula::Either(p, q)),
            (p(), p()).prop_map(|(p, q)| Formula::Implies(p, q)),
            (w(), p()).prop_map(|((a, b), p)| Formula::Finally(a, b, p)),
            (w(), p()).prop_map(|((a, b), p)| Formula::Globally(a, b, p)),
            (1usize..=2, p()).prop_map(|(k, p)| Formula::Next(k, p)),
            (w(), p(), p()).prop_map(|((a, b), p, q)| Formula::Until(a, b, p, q)),
            (w(), p(), p()).prop_map(|((a, b), p, q)| Formula::Weak(a, b, p, q)),
            (w(), p(), p()).prop_map(|((a, b), p, q)| Formula::Release(a, b, p, q)),
        ]
    })
    .prop_filter("looks beyond the horizon", |f| f.reach() <= LAST)
}

/// For each state the weights (of 8) of its successors; none where it stutters.
type Chain = Vec<Option<[u32; STATES]>>;

fn chain() -> impl Strategy<Value = Chain> {
    let row = (0u32..=8, 0u32..=8, 0u32..=8).prop_map(|(a, b, c)| {
        let mut cuts = [a, b, c];
        cuts.sort_unstable();
        [cuts[0], cuts[1] - cuts[0], cuts[2] - cuts[1], 8 - cuts[2]]
    });
    proptest::collection::vec(proptest::option::weighted(0.85, row), STATES)
}

fn scenario(chain: &Chain, coded: bool) -> String {
    let mut text = format!("horizon = {LAST} steps\nprocess c {{ var s: 0 .. {} = 0\n", STATES - 1);
    if coded {
        // A real variable that a guard reads keeps the process from becoming a table.
        text.push_str("var one: real = 1\n");
    }
    for (state, row) in chain.iter().enumerate() {
        let Some(row) = row else { continue };
        let guard = if coded { format!("s == {state} & one > 0") } else { format!("s == {state}") };
        let branches: Vec<String> =
            row.iter().enumerate().map(|(to, weight)| format!("{weight}/8: s = {to}")).collect();
        text.push_str(&format!("when {guard} -> {}\n", branches.join(" | ")));
    }
    text + "}\n"
}

/// The probability of a formula, path by path.
fn probability(chain: &Chain, formula: &Formula, path: &mut Vec<usize>, p: f64) -> f64 {
    if path.len() == LAST + 1 {
        return if formula.holds(path, 0) { p } else { 0.0 };
    }
    let state = path[path.len() - 1];
    let row = chain[state].unwrap_or_else(|| {
        let mut stay = [0; STATES];
        stay[state] = 8;
        stay
    });
    let mut sum = 0.0;
    for (to, weight) in row.into_iter().enumerate().filter(|(_, weight)| *weight > 0) {
        path.push(to);
        sum += probability(chain, formula, path, p * f64::from(weight) / 8.0);
        path.pop();
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn estimates_and_monitors_agree_with_enumeration(
        chain in chain(),
        formulas in proptest::collection::vec(formula(), 3),
        seed in any::<u64>(),
    ) {
        let queries: Vec<String> =
            formulas.iter().map(|f| format!("check P({}) >= 0.5\n", f.text())).collect();
        let study = compiled(&scenario(&chain, false), &queries.concat()).unwrap();
        let world = &study.worlds[0];
        // Equal columns are kept once: look them up by the queries.
        let columns: Vec<usize> = study
            .queries
            .iter()
            .map(|q| match &q.ask {
                smc::compile::study::Ask::Check { measure, .. } => measure.target.column,
                _ => unreachable!(),
            })
            .collect();
        let trials = shown(world, seed, 4000);
        for (formula, &column) in formulas.iter().zip(&columns) {
            let mut held = 0;
            for trial in &trials {
                let path: Vec<usize> = trial.traces.iter().map(|v| v[0] as usize).collect();
                prop_assert_eq!(trial.verdicts[column], formula.holds(&path, 0), "{} on {:?}", formula.text(), path);
                held += usize::from(trial.verdicts[column]);
            }
            let exact = probability(&chain, formula, &mut vec![0], 1.0);
            prop_assert!(fits(held, trials.len(), exact), "{}: {} of {}, {}", formula.text(), held, trials.len(), exact);
        }
        // Code and table take the same way, to the last bit.
        let coded = compiled(&scenario(&chain, true), &queries.concat()).unwrap();
        for (a, b) in trials.iter().zip(shown(&coded.worlds[0], seed, 400)) {
            let paths = [&a.traces, &b.traces].map(|t| t.iter().map(|v| v[0]).collect::<Vec<f64>>());
            prop_assert_eq!(&paths[0], &paths[1]);
        }
    }
}
