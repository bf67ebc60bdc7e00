//! Random formulas and metrics over lanes that start at different times and are filled again.

use super::reference::Prefix;
use proptest::prelude::*;
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::tick::{Clock, Tick};
use smc::logic::{
    Aggregation, AtomId, Monitor, Node, NodeId, Operation, Relation, SignalId, Term, TermId, Tree, Window,
};

pub(crate) const ATOMS: usize = 3;
pub(crate) const SIGNALS: usize = 2;

/// A formula or number before it is put into a tree.
#[derive(Clone, Debug)]
pub(crate) enum Sketch {
    Constant(bool),
    Atom(u32),
    Compare(u8, Box<Sketch>, Box<Sketch>),
    Not(Box<Sketch>),
    Join(bool, Vec<Sketch>),
    Unary(bool, (u64, Option<u64>), Box<Sketch>),
    Binary(u8, (u64, Option<u64>), Box<Sketch>, Box<Sketch>),
    Number(i8),
    Signal(u32),
    Combine(u8, Box<Sketch>, Box<Sketch>),
    Abs(Box<Sketch>),
    Window(u8, (u64, Option<u64>), Box<Sketch>),
    Later(u64, Box<Sketch>),
    AtEnd(Box<Sketch>),
    TimeUntil(Box<Sketch>),
}

impl Sketch {
    pub(crate) fn node(&self, tree: &mut Tree) -> NodeId {
        let w =
            |(from, to): &(u64, Option<u64>)| Window { from: Tick(*from), to: to.map(|to| Tick(from + to)) };
        let node = match self {
            Self::Constant(value) => Node::Constant(*value),
            Self::Atom(k) => Node::Atom(AtomId(*k)),
            Self::Compare(relation, x, y) => {
                let relation = [
                    Relation::Less,
                    Relation::AtMost,
                    Relation::Greater,
                    Relation::AtLeast,
                    Relation::Equal,
                    Relation::Unequal,
                ][usize::from(*relation)];
                Node::Compare(relation, x.term(tree), y.term(tree))
            }
            Self::Not(x) => Node::Not(x.node(tree)),
            Self::Join(and, parts) => {
                let parts = parts.iter().map(|x| x.node(tree)).collect();
                if *and { Node::And(parts) } else { Node::Or(parts) }
            }
            Self::Unary(always, window, x) => {
                let x = x.node(tree);
                if *always { Node::Globally(w(window), x) } else { Node::Finally(w(window), x) }
            }
            Self::Binary(kind, window, x, y) => {
                let (x, y) = (x.node(tree), y.node(tree));
                match kind {
                    0 => Node::Until(w(window), x, y),
                    1 => Node::WeakUntil(w(window), x, y),
                    _ => Node::Release(w(window), x, y),
                }
            }
            other => panic!("{other:?} is a number"),
        };
        tree.node(node)
    }

    fn term(&self, tree: &mut Tree) -> TermId {
        let w =
            |(from, to): &(u64, Option<u64>)| Window { from: Tick(*from), to: to.map(|to| Tick(from + to)) };
        let term = match self {
            Self::Number(value) => Term::Constant(f64::from(*value)),
            Self::Signal(k) => Term::Signal(SignalId(*k)),
            Self::Combine(operation, x, y) => {
                let operation = [
                    Operation::Add,
                    Operation::Subtract,
                    Operation::Multiply,
                    Operation::Divide,
                    Operation::Min,
                    Operation::Max,
                ][usize::from(*operation)];
                Term::Combine(operation, x.term(tree), y.term(tree))
            }
            Self::Abs(x) => Term::Abs(x.term(tree)),
            Self::Window(aggregation, window, x) => {
                let aggregation = [Aggregation::Min, Aggregation::Max, Aggregation::Sum, Aggregation::Mean]
                    [usize::from(*aggregation)];
                Term::Window(aggregation, w(window), x.term(tree))
            }
            Self::Later(by, x) => Term::Later(Tick(*by), x.term(tree)),
            Self::AtEnd(x) => Term::AtEnd(x.term(tree)),
            Self::TimeUntil(x) => Term::TimeUntil(x.node(tree)),
            other => panic!("{other:?} is a formula"),
        };
        tree.term(term)
    }

    /// Every bound is drawn short enough that most formulas fit the horizon.
    fn window(endless: bool) -> BoxedStrategy<(u64, Option<u64>)> {
        if endless {
            prop_oneof![
                3 => (0u64..3, (0u64..5).prop_map(Some)),
                1 => (0u64..2, Just(None)),
            ]
            .boxed()
        } else {
            (0u64..3, (0u64..5).prop_map(Some)).boxed()
        }
    }

    pub(crate) fn formula(depth: u32, numbers: bool, endless: bool) -> BoxedStrategy<Sketch> {
        let atom = prop_oneof![
            20 => (0..ATOMS as u32).prop_map(Sketch::Atom),
            1 => any::<bool>().prop_map(Sketch::Constant),
        ];
        if depth == 0 {
            return atom.boxed();
        }
        let inner = || Self::formula(depth - 1, numbers, endless);
        let w = || Self::window(endless);
        let temporal = prop_oneof![
            2 => (any::<bool>(), w(), inner()).prop_map(|(a, w, x)| Sketch::Unary(a, w, x.into())),
            2 => (0u8..3, w(), inner(), inner())
                .prop_map(|(k, w, x, y)| Sketch::Binary(k, w, x.into(), y.into())),
            1 => inner().prop_map(|x| Sketch::Not(x.into())),
            2 => (any::<bool>(), proptest::collection::vec(inner(), 0..4)).prop_map(|(a, v)| Sketch::Join(a, v)),
        ];
        if numbers {
            let number = || Self::number(depth - 1, endless);
            let side = || prop_oneof![1 => number(), 1 => (-2i8..3).prop_map(Sketch::Number)];
            prop_oneof![
                1 => atom,
                4 => temporal,
                3 => (0u8..6, number(), side())
                    .prop_map(|(r, x, y)| Sketch::Compare(r, x.into(), y.into())),
                1 => (0u8..6, side(), number())
                    .prop_map(|(r, x, y)| Sketch::Compare(r, x.into(), y.into())),
            ]
            .boxed()
        } else {
            prop_oneof![1 => atom, 4 => temporal].boxed()
        }
    }

    fn number(depth: u32, endless: bool) -> BoxedStrategy<Sketch> {
        let leaf = prop_oneof![
            5 => (0..SIGNALS as u32).prop_map(Sketch::Signal),
            1 => (-2i8..3).prop_map(Sketch::Number),
        ];
        if depth == 0 {
            return leaf.boxed();
        }
        let inner = || Self::number(depth - 1, endless);
        let w = || Self::window(endless);
        let bounded = prop_oneof![
            1 => leaf,
            2 => (0u8..6, inner(), inner()).prop_map(|(o, x, y)| Sketch::Combine(o, x.into(), y.into())),
            1 => inner().prop_map(|x| Sketch::Abs(x.into())),
            3 => (0u8..4, w(), inner()).prop_map(|(a, w, x)| Sketch::Window(a, w, x.into())),
            1 => (0u64..3, inner()).prop_map(|(k, x)| Sketch::Later(k, x.into())),
        ];
        if endless {
            // Below something that looks up to the horizon nothing may look further.
            prop_oneof![
                6 => bounded,
                1 => (0..SIGNALS as u32).prop_map(|k| Sketch::AtEnd(Sketch::Signal(k).into())),
                2 => Self::formula(depth - 1, false, true).prop_map(|x| Sketch::TimeUntil(x.into())),
            ]
            .boxed()
        } else {
            bounded.boxed()
        }
    }
}

/// One trial: each atom and each signal in each state.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trial {
    pub(crate) atoms: Vec<Vec<bool>>,
    pub(crate) signals: Vec<Vec<f64>>,
}

/// Draws trials that change seldom or often.
pub(crate) fn trial(random: &mut TestRandom, states: u64) -> Trial {
    let seldom = random.below(4) + 1;
    let mut atoms = vec![Vec::new(); ATOMS];
    for atom in &mut atoms {
        let mut value = random.below(2) == 0;
        for _ in 0..states {
            value ^= random.below(seldom + 1) == 0;
            atom.push(value);
        }
    }
    let mut signals = vec![Vec::new(); SIGNALS];
    for signal in &mut signals {
        let mut value = 0.0;
        for _ in 0..states {
            value = match random.below(12) {
                0 => f64::NAN,
                1 => -0.0,
                2..=4 => random.below(7) as f64 * 0.5 - 1.5,
                // Decimals, whose sums are rounded.
                5 => random.below(7) as f64 * 0.1,
                _ => value,
            };
            signal.push(value);
        }
    }
    Trial { atoms, signals }
}

/// A small generator of its own, so that one seed gives the whole run.
pub(crate) struct TestRandom(pub(crate) u64);

impl TestRandom {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

#[derive(Clone, Copy)]
enum Root {
    Formula(NodeId),
    Metric(TermId),
}

/// What the definition says, and at which state.
fn expected(tree: &Tree, root: Root, trial: &Trial, horizon: u64, seconds: f64) -> (u64, bool, f64) {
    for seen in 1..=horizon + 1 {
        let prefix = Prefix {
            tree,
            atoms: &trial.atoms,
            signals: &trial.signals,
            seen,
            horizon,
            seconds,
            known: None,
        };
        match root {
            Root::Formula(node) => {
                if let Some(verdict) = prefix.truth(node, 0) {
                    return (seen - 1, verdict, 0.0);
                }
            }
            Root::Metric(term) => {
                if let Some(value) = prefix.number(term, 0) {
                    return (seen - 1, true, value);
                }
            }
        }
    }
    panic!("open at the horizon")
}

/// Runs trials through the lanes, each lane on its own schedule, and compares every verdict.
fn run(tree: &Tree, root: Root, horizon: u64, seed: u64) -> Result<(), TestCaseError> {
    let clock = Clock::Stepped(smc::base::decimal::Decimal::parse("0.5").unwrap());
    let made = match root {
        Root::Formula(node) => Monitor::formula(tree, node, Tick(horizon), clock),
        Root::Metric(term) => Monitor::metric(tree, term, Tick(horizon), clock),
    };
    let Ok(mut monitor) = made else { return Err(TestCaseError::reject("beyond the horizon")) };
    let bytes = monitor.bytes();
    let mut random = TestRandom(seed);
    let mut lanes: Vec<Option<(Trial, u64)>> = vec![None; LANES];
    let mut seen = 0;
    for _ in 0..4 * horizon + 8 {
        let mut mask = Mask::NONE;
        for (k, lane) in lanes.iter_mut().enumerate() {
            let decided = lane.is_some() && monitor.decided().has(k);
            // Now and then a trial is broken off, or a lane stays empty for a while.
            if (decided || lane.is_none()) && random.below(2) == 0 || random.below(40) == 0 {
                monitor.start(k);
                *lane = Some((trial(&mut random, horizon + 1), 0));
            } else if decided && random.below(2) == 0 {
                *lane = None;
            }
            if lane.is_some() {
                mask |= Mask::lane(k);
            }
        }
        let at = |lane: &Option<(Trial, u64)>, k: usize, numbers: bool| {
            lane.as_ref().map_or((true, 7.0), |(trial, position)| {
                let position = (*position).min(horizon) as usize;
                if numbers { (true, trial.signals[k][position]) } else { (trial.atoms[k][position], 0.0) }
            })
        };
        let atoms: Vec<Mask> = (0..ATOMS)
            .map(|a| Mask(lanes.iter().enumerate().fold(0, |m, (k, l)| m | u8::from(at(l, a, false).0) << k)))
            .collect();
        let signals: Vec<Lanes> =
            (0..SIGNALS).map(|s| Lanes(std::array::from_fn(|k| at(&lanes[k], s, true).1))).collect();
        let before = monitor.decided();
        monitor.observe(mask, &atoms, &signals);
        for (k, lane) in lanes.iter_mut().enumerate() {
            let Some((trial, position)) = lane else { continue };
            let (index, verdict, value) = expected(tree, root, trial, horizon, 0.5);
            prop_assert_eq!(monitor.decided().has(k), *position >= index, "lane {} at {}", k, position);
            if monitor.decided().has(k) {
                prop_assert_eq!(monitor.truth().has(k), verdict);
                prop_assert_eq!(monitor.decided_at()[k], index);
                if matches!(root, Root::Metric(_)) {
                    let found = monitor.value().0[k];
                    prop_assert!(found.to_bits() == value.to_bits() || found.is_nan() && value.is_nan());
                }
                seen += u32::from(!before.has(k));
            }
            *position += 1;
        }
    }
    prop_assert!(seen > 0);
    prop_assert_eq!(monitor.bytes(), bytes);
    Ok(())
}

pub(crate) fn settings(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        max_global_rejects: 1_000_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(settings(1500))]

    #[test]
    fn formulas_with_bounds(sketch in Sketch::formula(3, false, false), seed in any::<u64>(), horizon in 8u64..24) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        run(&tree, Root::Formula(root), horizon, seed)?;
    }

    #[test]
    fn formulas_up_to_the_horizon(sketch in Sketch::formula(2, false, true), seed in any::<u64>(), horizon in 0u64..14) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        run(&tree, Root::Formula(root), horizon, seed)?;
    }

    #[test]
    fn formulas_over_numbers(sketch in Sketch::formula(3, true, false), seed in any::<u64>(), horizon in 6u64..18) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        run(&tree, Root::Formula(root), horizon, seed)?;
    }

    #[test]
    fn formulas_over_numbers_up_to_the_horizon(sketch in Sketch::formula(3, true, true), seed in any::<u64>(), horizon in 3u64..10) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        run(&tree, Root::Formula(root), horizon, seed)?;
    }

    #[test]
    fn metrics(sketch in Sketch::number(3, true), seed in any::<u64>(), horizon in 4u64..12) {
        let mut tree = Tree::default();
        let root = sketch.term(&mut tree);
        run(&tree, Root::Metric(root), horizon, seed)?;
    }
}
