//! Random formulas and metrics over random signals: reading and moment of decision against the definition,
//! and other ends of the trial that must not change them.

use super::reference::{Jump, Signal};
use proptest::prelude::*;
use smc::base::decimal::Decimal;
use smc::base::tick::Tick;
use smc::logic::{
    Aggregation, AtomId, Node, NodeId, Operation, Reading, Relation, SignalId, SignalMonitor, Term, TermId,
    Tree, Window,
};

/// Jumps and bounds are multiples of so many ticks, so that averages cross whole numbers at whole ticks.
pub(crate) const GRID: u64 = 6;

const RELATIONS: [Relation; 6] = [
    Relation::Less,
    Relation::AtMost,
    Relation::Greater,
    Relation::AtLeast,
    Relation::Equal,
    Relation::Unequal,
];

/// Draws trees and signals; one seed gives the whole case.
pub(crate) struct Draw(pub(crate) u64);

/// Values that signals of decimals have.
const DECIMALS: [f64; 5] = [0.0, 0.1, 0.2, 0.3, 0.7];

impl Draw {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn window(&mut self, endless: bool) -> Window {
        let from = self.below(3) * self.below(2);
        let to = (!endless || self.below(3) > 0).then(|| Tick((from + self.below(4)) * GRID));
        Window { from: Tick(from * GRID), to }
    }

    fn node(&mut self, tree: &mut Tree, depth: u32, numbers: bool, endless: bool) -> NodeId {
        let kind = if depth == 0 { 0 } else { self.below(if numbers { 12 } else { 9 }) };
        let node = match kind {
            0 if self.below(20) == 0 => Node::Constant(self.below(2) == 0),
            0 => Node::Atom(AtomId(self.below(3) as u32)),
            1 => Node::Not(self.node(tree, depth - 1, numbers, endless)),
            2 | 3 => {
                let parts = (0..=self.below(3)).map(|_| self.node(tree, depth - 1, numbers, endless));
                let parts: Vec<NodeId> = parts.collect();
                if kind == 2 { Node::And(parts) } else { Node::Or(parts) }
            }
            4..=8 => {
                let w = self.window(endless);
                let x = self.node(tree, depth - 1, numbers, endless);
                match kind {
                    4 => Node::Finally(w, x),
                    5 => Node::Globally(w, x),
                    6 => Node::Until(w, x, self.node(tree, depth - 1, numbers, endless)),
                    7 => Node::WeakUntil(w, x, self.node(tree, depth - 1, numbers, endless)),
                    _ => Node::Release(w, x, self.node(tree, depth - 1, numbers, endless)),
                }
            }
            _ => {
                let x = self.term(tree, depth - 1, endless);
                let y = match self.below(3) {
                    0 => self.term(tree, depth - 1, endless),
                    _ => {
                        let scale = if self.below(2) == 0 { 1 } else { GRID };
                        tree.term(Term::Constant((self.below(4) * scale) as f64))
                    }
                };
                let relation = RELATIONS[self.below(6) as usize];
                if self.below(2) == 0 { Node::Compare(relation, x, y) } else { Node::Compare(relation, y, x) }
            }
        };
        tree.node(node)
    }

    /// A formula of comparisons, as a robustness has.
    pub(crate) fn margins(&mut self, tree: &mut Tree, depth: u32, endless: bool) -> NodeId {
        let kind = if depth == 0 { self.below(2) } else { self.below(12) };
        let node = match kind {
            0 | 1 if self.below(20) == 0 => Node::Constant(self.below(2) == 0),
            0..=2 => {
                let x = match self.below(4) {
                    0 if depth > 0 => self.term(tree, depth - 1, endless),
                    _ => tree.term(Term::Signal(SignalId(self.below(2) as u32))),
                };
                let y = match self.below(5) {
                    0 => tree.term(Term::Signal(SignalId(1))),
                    _ => tree.term(Term::Constant(self.below(8) as f64 / 2.0)),
                };
                let relation = RELATIONS[self.below(6) as usize];
                if self.below(2) == 0 { Node::Compare(relation, x, y) } else { Node::Compare(relation, y, x) }
            }
            3 => Node::Not(self.margins(tree, depth - 1, endless)),
            4 | 5 => {
                let parts = (0..=self.below(3)).map(|_| self.margins(tree, depth - 1, endless));
                let parts: Vec<NodeId> = parts.collect();
                if kind == 4 { Node::And(parts) } else { Node::Or(parts) }
            }
            _ => {
                let w = self.window(endless);
                let x = self.margins(tree, depth - 1, endless);
                match kind {
                    6 => Node::Finally(w, x),
                    7 => Node::Globally(w, x),
                    8 | 9 => Node::Until(w, x, self.margins(tree, depth - 1, endless)),
                    10 => Node::WeakUntil(w, x, self.margins(tree, depth - 1, endless)),
                    _ => Node::Release(w, x, self.margins(tree, depth - 1, endless)),
                }
            }
        };
        tree.node(node)
    }

    fn term(&mut self, tree: &mut Tree, depth: u32, endless: bool) -> TermId {
        let kind = if depth == 0 { self.below(5) } else { self.below(15) };
        let term = match kind {
            0 => Term::Constant(self.below(4) as f64),
            1..=4 => Term::Signal(SignalId(self.below(2) as u32)),
            5 | 6 => {
                let operation = [Operation::Add, Operation::Subtract, Operation::Min, Operation::Max]
                    [self.below(4) as usize];
                let x = self.term(tree, depth - 1, endless);
                Term::Combine(operation, x, self.term(tree, depth - 1, endless))
            }
            7 => Term::Abs(self.term(tree, depth - 1, endless)),
            8..=11 => {
                let aggregation = [Aggregation::Min, Aggregation::Max, Aggregation::Mean];
                let w = self.window(endless);
                Term::Window(aggregation[self.below(3) as usize], w, self.term(tree, depth - 1, endless))
            }
            12 => Term::Later(Tick(self.below(3) * GRID), self.term(tree, depth - 1, endless)),
            13 if endless => Term::AtEnd(self.term(tree, 0, endless)),
            _ if endless => Term::TimeUntil(self.node(tree, depth - 1, false, endless)),
            _ => Term::Signal(SignalId(0)),
        };
        tree.term(term)
    }

    /// Jumps at multiples of the grid, several at one time, states that last no time among them.
    pub(crate) fn jumps(&mut self, from: u64, horizon: u64) -> Vec<Jump> {
        let mut jumps = Vec::new();
        let (mut at, seldom) = (from, 1 + self.below(3));
        while at <= horizon {
            jumps.push(Jump {
                at,
                atoms: (0..3).map(|_| self.below(2) == 0).collect(),
                signals: (0..2).map(|_| self.below(4) as f64).collect(),
            });
            at += self.below(1 + seldom) * GRID;
        }
        jumps
    }
}

#[derive(Clone, Copy)]
enum Root {
    Formula(NodeId),
    Metric(TermId),
}

/// Runs a trial; also when the monitor first answered, if it did before the end.
fn observe(monitor: &mut SignalMonitor, jumps: &[Jump]) -> (Reading, f64) {
    monitor.start();
    for jump in jumps {
        if let Some(reading) = monitor.jump(jump.at as f64, &jump.atoms, &jump.signals) {
            assert!(monitor.decided_at() <= jump.at as f64, "only what is over is judged");
            return (reading, monitor.decided_at());
        }
    }
    (monitor.finish(), monitor.decided_at())
}

fn same(x: Reading, y: Reading) -> bool {
    match (x, y) {
        (Reading::Value(x), Reading::Value(y)) => x == y || (x - y).abs() <= 1e-12 * y.abs(),
        _ => x == y,
    }
}

fn check(tree: &Tree, root: Root, horizon: u64, draw: &mut Draw) -> Result<(), TestCaseError> {
    let second = Decimal::whole(1);
    let made = match root {
        Root::Formula(node) => SignalMonitor::formula(tree, node, Tick(horizon), second),
        Root::Metric(term) => SignalMonitor::metric(tree, term, Tick(horizon), second),
    };
    let Ok(mut monitor) = made else { return Err(TestCaseError::reject("not for this horizon")) };
    for _ in 0..3 {
        let jumps = draw.jumps(0, horizon);
        let found = observe(&mut monitor, &jumps);
        let at = |seen: u64| {
            let signal = Signal { tree, jumps: &jumps, horizon, seen };
            match root {
                Root::Formula(node) => signal.truth(node, 0).map(Reading::Truth),
                Root::Metric(term) => signal.number(term, 0).map(Reading::Value),
            }
        };
        // What is known stays known, so the first place that decides is found by bisection.
        let (mut open, mut decided) = (0, 2 * horizon + 1);
        while decided - open > 1 {
            let middle = u64::midpoint(open, decided);
            if at(middle).is_some() { decided = middle } else { open = middle }
        }
        let expected = at(decided).expect("known at the horizon");
        prop_assert!(
            same(found.0, expected),
            "{:?} instead of {:?} for {:?} {:?}",
            found,
            expected,
            tree,
            jumps
        );
        let instant = (decided - 1) / 2;
        // An interval decides at its beginning, or as a whole.
        let late = u64::from(decided % 2 == 0 && found.1 > instant as f64 + 0.5);
        prop_assert!(
            (found.1 - (instant + late) as f64).abs() < 1e-9,
            "at {} instead of {} {:?} {:?}",
            found.1,
            instant,
            tree,
            jumps
        );
        // The same beginning with another end.
        let mut other = jumps.clone();
        other.retain(|jump| jump.at <= instant);
        let start = (instant / GRID + 1 + draw.below(2)) * GRID;
        other.extend(draw.jumps(start, horizon));
        let again = observe(&mut monitor, &other);
        prop_assert!(same(again.0, found.0), "{:?} with the end {:?}", again, other);
    }
    Ok(())
}

/// Jumps whose signals are decimals, which sums round.
fn decimals(draw: &mut Draw, horizon: u64) -> Vec<Jump> {
    let mut jumps = draw.jumps(0, horizon);
    for jump in &mut jumps {
        jump.signals
            .iter_mut()
            .for_each(|signal| *signal = DECIMALS[*signal as usize + draw.below(2) as usize]);
    }
    jumps
}

/// A mean of decimals from the start, compared with a decimal, against the exact sum.
fn decimal_mean(seed: u64, horizon: u64) -> Result<(), TestCaseError> {
    let mut draw = Draw(seed);
    let mut tree = Tree::default();
    let x = tree.term(Term::Signal(SignalId(0)));
    let mean = tree.term(Term::Window(Aggregation::Mean, draw.window(true), x));
    let c = tree.term(Term::Constant(DECIMALS[draw.below(5) as usize]));
    let root = tree.node(Node::Compare(RELATIONS[draw.below(6) as usize], mean, c));
    let Ok(mut monitor) = SignalMonitor::formula(&tree, root, Tick(horizon), Decimal::whole(1)) else {
        return Err(TestCaseError::reject("not for this horizon"));
    };
    for _ in 0..8 {
        let jumps = decimals(&mut draw, horizon);
        let expected = Signal { tree: &tree, jumps: &jumps, horizon, seen: 2 * horizon + 1 }.truth(root, 0);
        let found = observe(&mut monitor, &jumps).0;
        prop_assert_eq!(Some(found), expected.map(Reading::Truth), "{:?} {:?}", tree, jumps);
    }
    Ok(())
}

/// Further jumps at which the signals stay as they are change no bit of the reading and of its time.
fn undisturbed(seed: u64, depth: u32, metric: bool, horizon: u64) -> Result<(), TestCaseError> {
    let mut draw = Draw(seed);
    let mut tree = Tree::default();
    let endless = draw.below(2) == 0;
    let made = if metric {
        let of = draw.term(&mut tree, depth, endless);
        let mean = tree.term(Term::Window(Aggregation::Mean, draw.window(true), of));
        SignalMonitor::metric(&tree, mean, Tick(horizon), Decimal::whole(1))
    } else {
        let of = draw.term(&mut tree, 1, endless);
        let w = Window { from: Tick(0), to: Some(Tick(draw.below(4) * GRID)) };
        let mean = tree.term(Term::Window(Aggregation::Mean, draw.window(endless), of));
        let c = tree.term(Term::Constant(DECIMALS[draw.below(5) as usize]));
        let high = tree.node(Node::Compare(RELATIONS[draw.below(6) as usize], mean, c));
        let other = draw.node(&mut tree, depth, true, endless);
        let root = match draw.below(3) {
            0 => Node::Globally(w, high),
            1 => Node::Finally(w, high),
            _ => Node::Until(w, high, other),
        };
        let root = tree.node(root);
        SignalMonitor::formula(&tree, root, Tick(horizon), Decimal::whole(1))
    };
    let Ok(mut monitor) = made else { return Err(TestCaseError::reject("not for this horizon")) };
    for _ in 0..4 {
        let mut jumps: Vec<(f64, Jump)> = decimals(&mut draw, horizon)
            .into_iter()
            .map(|jump| (jump.at as f64 + draw.below(1000) as f64 * 1e-3 * draw.below(2) as f64, jump))
            .collect();
        jumps[0].0 = 0.0;
        jumps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut more = jumps.clone();
        for _ in 0..12 {
            let at = draw.below(horizon * 1_000_000) as f64 * 1e-6;
            let k = more.partition_point(|jump| jump.0 <= at);
            more.insert(k, (at, more[k - 1].1.clone()));
        }
        let mut run = |jumps: &[(f64, Jump)]| {
            monitor.start();
            for (at, jump) in jumps {
                monitor.jump(*at, &jump.atoms, &jump.signals);
            }
            let bits = match monitor.finish() {
                Reading::Value(value) => value.to_bits(),
                reading => u64::from(reading == Reading::Truth(true)),
            };
            (bits, monitor.decided_at().to_bits())
        };
        prop_assert_eq!(run(&jumps), run(&more), "{:?} {:?}", tree, more);
    }
    Ok(())
}

fn settings(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        max_global_rejects: 1_000_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn case(seed: u64, depth: u32, numbers: bool, metric: bool, horizon: u64) -> Result<(), TestCaseError> {
    let mut draw = Draw(seed);
    let mut tree = Tree::default();
    let endless = draw.below(2) == 0;
    let root = if metric {
        Root::Metric(draw.term(&mut tree, depth, endless))
    } else {
        Root::Formula(draw.node(&mut tree, depth, numbers, endless))
    };
    check(&tree, root, horizon * GRID, &mut draw)
}

proptest! {
    #![proptest_config(settings(1500))]

    #[test]
    fn single_operators(seed in any::<u64>(), horizon in 0u64..8) {
        case(seed, 1, false, false, horizon)?;
    }

    #[test]
    fn two_levels(seed in any::<u64>(), horizon in 2u64..9) {
        case(seed, 2, false, false, horizon)?;
    }

    #[test]
    fn over_numbers(seed in any::<u64>(), horizon in 2u64..9) {
        case(seed, 2, true, false, horizon)?;
    }

    #[test]
    fn metrics(seed in any::<u64>(), horizon in 1u64..9) {
        case(seed, 2, true, true, horizon)?;
    }

    #[test]
    fn means_of_decimals(seed in any::<u64>(), horizon in 1u64..9) {
        decimal_mean(seed, horizon * GRID)?;
    }

    #[test]
    fn means_do_not_depend_on_other_jumps(seed in any::<u64>(), horizon in 2u64..9) {
        undisturbed(seed, 1, true, horizon * GRID)?;
    }

    #[test]
    fn comparisons_of_means_do_not_depend_on_other_jumps(seed in any::<u64>(), horizon in 4u64..12) {
        undisturbed(seed, 1, false, horizon * GRID)?;
    }
}

proptest! {
    #![proptest_config(settings(250))]

    #[test]
    fn three_levels(seed in any::<u64>(), horizon in 3u64..7) {
        case(seed, 3, false, false, horizon)?;
    }

    #[test]
    fn three_levels_over_numbers(seed in any::<u64>(), horizon in 3u64..7) {
        case(seed, 3, true, false, horizon)?;
    }
}
