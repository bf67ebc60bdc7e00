//! Robustness on signals against its definition, written plainly over the places of `reference.rs`: both bounds after
//! every jump, and the sign against the Boolean monitor.

use super::random::{Draw, GRID};
use super::reference::Jump;
use proptest::prelude::*;
use smc::base::decimal::Decimal;
use smc::base::tick::Tick;
use smc::logic::{
    Aggregation, Invalid, Node, NodeId, Reading, Relation, SignalMonitor, SignalRobustness, Term, TermId,
    Tree, Window,
};

/// The least and the most that a margin can be.
type Ends = (f64, f64);

const OPEN: Ends = (f64::NEG_INFINITY, f64::INFINITY);

/// The first places of a trial.
struct Plain<'a> {
    tree: &'a Tree,
    jumps: &'a [Jump],
    horizon: u64,
    seen: u64,
}

fn best(all: impl Iterator<Item = Ends>) -> Ends {
    let none = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    all.fold(none, |x, y| (x.0.max(y.0), x.1.max(y.1)))
}

/// What is the same everywhere is as far as can be from the other answer.
fn always(truth: bool) -> Ends {
    let margin = if truth { f64::INFINITY } else { f64::NEG_INFINITY };
    (margin, margin)
}

fn not(x: Ends) -> Ends {
    (-x.1, -x.0)
}

fn worst(all: impl Iterator<Item = Ends>) -> Ends {
    not(best(all.map(not)))
}

impl Plain<'_> {
    fn state(&self, place: u64) -> Option<&Jump> {
        let known = place < self.seen;
        known.then(|| self.jumps.iter().rfind(|jump| jump.at <= place / 2).expect("the first is at 0"))
    }

    fn window(&self, w: Window, place: u64) -> std::ops::RangeInclusive<u64> {
        place + 2 * w.from.0..=w.to.map_or(2 * self.horizon, |to| place + 2 * to.0)
    }

    fn margin(&self, id: NodeId, at: u64) -> Ends {
        let is = |id: NodeId, sign: bool, k| if sign { self.margin(id, k) } else { not(self.margin(id, k)) };
        let until = |w: Window, p: NodeId, q: NodeId, sign: bool| {
            best(self.window(w, at).map(|goal| {
                let last = if goal % 2 == 1 && goal > at { goal + 1 } else { goal };
                worst([is(q, sign, goal)].into_iter().chain((at..last).map(|k| is(p, sign, k))))
            }))
        };
        match &self.tree.nodes[id.0 as usize] {
            Node::Constant(truth) => always(*truth),
            Node::Atom(_) => panic!("a robustness has no atoms"),
            Node::Compare(relation, x, y) => match (self.constant(*x), self.constant(*y)) {
                (Some(x), Some(y)) => Self::far(*relation, Some(x), Some(y)),
                (None, Some(c)) => self.against(*relation, *x, c, at),
                (Some(c), None) => self.against(relation.flipped(), *y, c, at),
                _ => Self::far(*relation, self.now(*x, at), self.now(*y, at)),
            },
            Node::Not(x) => not(self.margin(*x, at)),
            Node::And(parts) => worst(parts.iter().map(|x| self.margin(*x, at))),
            Node::Or(parts) => best(parts.iter().map(|x| self.margin(*x, at))),
            Node::Finally(w, x) => best(self.window(*w, at).map(|k| self.margin(*x, k))),
            Node::Globally(w, x) => worst(self.window(*w, at).map(|k| self.margin(*x, k))),
            Node::Until(w, p, q) => until(*w, *p, *q, true),
            Node::Release(w, p, q) => not(until(*w, *p, *q, false)),
            Node::WeakUntil(w, p, q) => {
                let all = worst((at..=*self.window(*w, at).end()).map(|k| self.margin(*p, k)));
                best([until(*w, *p, *q, true), all].into_iter())
            }
        }
    }

    fn constant(&self, id: TermId) -> Option<f64> {
        match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Combine(operation, x, y) => Some(operation.apply(self.constant(*x)?, self.constant(*y)?)),
            Term::Abs(x) => self.constant(*x).map(f64::abs),
            Term::Later(_, x) | Term::AtEnd(x) => self.constant(*x),
            _ => None,
        }
    }

    /// A number of the present state.
    fn now(&self, id: TermId, at: u64) -> Option<f64> {
        match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Signal(signal) => self.state(at).map(|state| state.signals[signal.0 as usize]),
            Term::Combine(operation, x, y) => {
                let known = self.constant(id);
                known.or_else(|| Some(operation.apply(self.now(*x, at)?, self.now(*y, at)?)))
            }
            Term::Abs(x) => self.now(*x, at).map(f64::abs),
            _ => panic!("not of the present state"),
        }
    }

    fn far(relation: Relation, x: Option<f64>, y: Option<f64>) -> Ends {
        let (Some(x), Some(y)) = (x, y) else { return OPEN };
        let margin = match relation {
            Relation::Less | Relation::AtMost => y - x,
            Relation::Greater | Relation::AtLeast => x - y,
            Relation::Equal => -(x - y).abs(),
            Relation::Unequal => (x - y).abs(),
        };
        (margin, margin)
    }

    fn against(&self, relation: Relation, x: TermId, c: f64, at: u64) -> Ends {
        use Relation::{AtLeast, AtMost, Equal, Greater, Less, Unequal};
        if let Some(x) = self.constant(x) {
            return Self::far(relation, Some(x), Some(c));
        }
        let all = |w: Window, x: TermId| self.window(w, at).map(move |k| self.against(relation, x, c, k));
        match (&self.tree.terms[x.0 as usize], relation) {
            (Term::Later(by, x), _) => self.against(relation, *x, c, at + 2 * by.0),
            (Term::AtEnd(x), _) => self.against(relation, *x, c, 2 * self.horizon),
            (Term::Window(Aggregation::Min, w, x), Less | AtMost)
            | (Term::Window(Aggregation::Max, w, x), Greater | AtLeast) => best(all(*w, *x)),
            (Term::Window(Aggregation::Min, w, x), Greater | AtLeast)
            | (Term::Window(Aggregation::Max, w, x), Less | AtMost) => worst(all(*w, *x)),
            (Term::TimeUntil(goal), _) => {
                let time = |place: u64| place as f64 / 2.0;
                let within = |relation: Relation| {
                    let soon = (at..=2 * self.horizon).filter(|&k| {
                        let wait = if k == at { 0.0 } else { time(k - k % 2) - time(at) };
                        relation.holds(wait, c)
                    });
                    best(soon.map(|k| self.margin(*goal, k)))
                };
                match relation {
                    Less | AtMost => within(relation),
                    Greater => not(within(AtMost)),
                    AtLeast => not(within(Less)),
                    Equal => worst([within(AtMost), not(within(Less))].into_iter()),
                    Unequal => best([not(within(AtMost)), within(Less)].into_iter()),
                }
            }
            _ => Self::far(relation, self.now(x, at), Some(c)),
        }
    }
}

/// Whether a tree has nothing but what has a margin and what the plain evaluator knows.
fn is_plain(tree: &Tree) -> bool {
    let atoms = tree.nodes.iter().any(|node| matches!(node, Node::Atom(_)));
    // A window of one instant may become a number of its own.
    let windows = tree.terms.iter().any(|term| match term {
        Term::Window(aggregation, w, _) => *aggregation == Aggregation::Mean || w.to == Some(w.from),
        _ => false,
    });
    !atoms && !windows
}

fn check(seed: u64, depth: u32, horizon: u64) -> Result<(), TestCaseError> {
    let mut draw = Draw(seed);
    let mut tree = Tree::default();
    let endless = draw.below(2) == 0;
    let node = draw.margins(&mut tree, depth, endless);
    let (horizon, second) = (horizon * GRID, Decimal::whole(1));
    if !is_plain(&tree) {
        return Err(TestCaseError::reject("not plain"));
    }
    let mut robustness = match SignalRobustness::new(&tree, node, Tick(horizon), second) {
        Ok(made) if draw.below(2) == 0 => made.closely(),
        Ok(made) => made,
        Err(_) => return Err(TestCaseError::reject("not for this horizon")),
    };
    let mut monitor = SignalMonitor::formula(&tree, node, Tick(horizon), second)
        .map_err(|error| TestCaseError::fail(error.to_string()))?;
    for _ in 0..3 {
        let jumps = draw.jumps(0, horizon);
        robustness.start();
        monitor.start();
        let mut met: Option<Reading> = None;
        for (k, jump) in jumps.iter().enumerate() {
            met = monitor.jump(jump.at as f64, &jump.atoms, &jump.signals);
            let found = robustness.jump(jump.at as f64, &[], &jump.signals);
            if jump.at == 0 {
                // Nothing is over yet.
                continue;
            }
            let plain = Plain { tree: &tree, jumps: &jumps[..k], horizon, seen: 2 * jump.at };
            let expected = plain.margin(node, 0);
            prop_assert_eq!(
                (found.lower, found.upper),
                expected,
                "before {:?} of {:?} {:?}",
                jump,
                jumps,
                tree
            );
            // The sign is known where the verdict falls.
            if found.lower > 0.0 || found.upper < 0.0 {
                prop_assert_eq!(met, Some(Reading::Truth(found.lower > 0.0)));
            } else if found.lower < 0.0 && found.upper > 0.0 {
                prop_assert_eq!(met, None);
            }
        }
        let (found, truth) = (robustness.finish(), met.unwrap_or_else(|| monitor.finish()));
        let plain = Plain { tree: &tree, jumps: &jumps, horizon, seen: 2 * horizon + 1 };
        prop_assert_eq!((found.lower, found.upper), plain.margin(node, 0), "{:?} {:?}", jumps, tree);
        prop_assert!(found.is_settled());
        prop_assert!(found.lower == 0.0 || truth == Reading::Truth(found.lower > 0.0));
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

proptest! {
    #![proptest_config(settings(500))]

    #[test]
    fn margins_of_single_operators(seed in any::<u64>(), horizon in 0u64..8) {
        check(seed, 1, horizon)?;
    }

    #[test]
    fn margins_of_two_levels(seed in any::<u64>(), horizon in 2u64..9) {
        check(seed, 2, horizon)?;
    }
}

proptest! {
    #![proptest_config(settings(100))]

    #[test]
    fn margins_of_three_levels(seed in any::<u64>(), horizon in 3u64..7) {
        check(seed, 3, horizon)?;
    }
}

#[test]
fn a_number_of_several_states_has_no_margin() {
    let mut tree = Tree::default();
    let x = tree.term(Term::Signal(smc::logic::SignalId(0)));
    let w = Window { from: Tick(0), to: Some(Tick(2)) };
    let mean = tree.term(Term::Window(Aggregation::Mean, w, x));
    let least = tree.term(Term::Window(Aggregation::Min, w, x));
    let one = tree.term(Term::Constant(1.0));
    for (a, b) in [(mean, one), (least, x)] {
        let node = tree.node(Node::Compare(Relation::Greater, a, b));
        let made = SignalRobustness::new(&tree, node, Tick(5), Decimal::whole(1));
        assert_eq!(made.err(), Some(Invalid::NoMargin));
    }
}

#[test]
fn a_long_trial_with_much_that_is_open_is_worked_out_seldom_and_right() {
    // Up to the horizon every rise of x is followed by a fall: nothing is settled before the end.
    let mut tree = Tree::default();
    let (x, zero) = (tree.term(Term::Signal(smc::logic::SignalId(0))), tree.term(Term::Constant(0.0)));
    let high = tree.node(Node::Compare(Relation::Greater, x, zero));
    let low = tree.node(Node::Not(high));
    let endless = Window { from: Tick(0), to: None };
    let falls = tree.node(Node::Finally(endless, low));
    let follows = tree.node(Node::Or(vec![low, falls]));
    let root = tree.node(Node::Globally(endless, follows));
    let horizon = 20_000;
    let mut robustness = SignalRobustness::new(&tree, root, Tick(horizon), Decimal::whole(1)).unwrap();
    let mut value = 7u64;
    for at in 0..horizon {
        value = (value * 1_103_515_245 + 12_345) % (1 << 31);
        let x = (value >> 16) as f64 / 8192.0 - 2.0;
        let bounds = robustness.jump(at as f64, &[], &[if at + 1 == horizon { -0.5 } else { x }]);
        assert!(bounds.lower <= 0.5 && bounds.upper >= 0.5);
    }
    let bounds = robustness.finish();
    assert_eq!((bounds.lower, bounds.upper), (0.5, 0.5));
}
