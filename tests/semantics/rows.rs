//! One test for each row of the table in `docs/semantics.md`.

use super::exhaustive::window;
use smc::base::decimal::Decimal;
use smc::base::lanes::{Lanes, Mask};
use smc::base::tick::{Clock, Tick};
use smc::logic::{
    Aggregation, AtomId, Invalid, Monitor, Node, NodeId, Relation, SignalId, Term, TermId, Tree, Window,
};

const P: NodeId = NodeId(0);
const Q: NodeId = NodeId(1);

/// A tree with the atoms p and q and one more node.
fn formula(node: Node) -> (Tree, NodeId) {
    let mut tree = Tree::default();
    tree.node(Node::Atom(AtomId(0)));
    tree.node(Node::Atom(AtomId(1)));
    let root = tree.node(node);
    (tree, root)
}

/// Runs one trial: `p` and `q` are strings of 0 and 1, one character a state. Verdict and deciding state.
fn run((tree, root): &(Tree, NodeId), horizon: u64, p: &str, q: &str) -> Option<(bool, u64)> {
    let mut monitor = Monitor::formula(tree, *root, Tick(horizon), Clock::Steps).unwrap();
    monitor.start(3);
    for state in 0..p.len() {
        let atoms = [p, q].map(|a| Mask(if a.as_bytes().get(state) == Some(&b'1') { 0xff } else { 0 }));
        monitor.observe(Mask::lane(3), &atoms, &[]);
        if monitor.decided().has(3) {
            return Some((monitor.truth().has(3), monitor.decided_at()[3]));
        }
    }
    None
}

/// Runs one trial of a metric.
fn measure((tree, root): &(Tree, TermId), horizon: u64, clock: Clock, signal: &[f64]) -> Option<(f64, u64)> {
    let mut monitor = Monitor::metric(tree, *root, Tick(horizon), clock).unwrap();
    monitor.start(0);
    for value in signal {
        monitor.observe(Mask::lane(0), &[Mask(u8::from(*value > 0.0))], &[Lanes::splat(*value)]);
        if monitor.decided().has(0) {
            return Some((monitor.value().0[0], monitor.decided_at()[0]));
        }
    }
    None
}

#[test]
fn finally_within_t_holds_if_p_holds_at_a_state_of_0_to_t() {
    let f = formula(Node::Finally(window(0, Some(3)), P));
    assert_eq!(run(&f, 9, "0001", ""), Some((true, 3)), "the end of the window counts");
    assert_eq!(run(&f, 9, "1", ""), Some((true, 0)), "so does its beginning");
    assert_eq!(run(&f, 9, "00001", ""), Some((false, 3)), "what comes after it does not");
}

#[test]
fn finally_within_0_is_p_now() {
    let f = formula(Node::Finally(window(0, Some(0)), P));
    assert_eq!(run(&f, 9, "1", ""), Some((true, 0)));
    assert_eq!(run(&f, 9, "01", ""), Some((false, 0)));
}

#[test]
fn both_ends_of_an_interval_are_closed() {
    let f = formula(Node::Finally(window(2, Some(4)), P));
    assert_eq!(run(&f, 9, "001", ""), Some((true, 2)));
    assert_eq!(run(&f, 9, "00001", ""), Some((true, 4)));
    assert_eq!(run(&f, 9, "110001", ""), Some((false, 4)));
    let g = formula(Node::Globally(window(2, Some(4)), P));
    assert_eq!(run(&g, 9, "00111", ""), Some((true, 4)));
    assert_eq!(run(&g, 9, "11011", ""), Some((false, 2)));
}

#[test]
fn next_looks_at_exactly_the_kth_state() {
    let next = formula(Node::Finally(window(1, Some(1)), P));
    assert_eq!(run(&next, 9, "01", ""), Some((true, 1)));
    assert_eq!(run(&next, 9, "10", ""), Some((false, 1)));
    let third = formula(Node::Globally(window(3, Some(3)), P));
    assert_eq!(run(&third, 9, "0001", ""), Some((true, 3)));
    assert_eq!(run(&third, 9, "1110", ""), Some((false, 3)));
}

#[test]
fn next_at_the_horizon_is_an_error() {
    let mut tree = Tree::default();
    let p = tree.node(Node::Atom(AtomId(0)));
    let next = tree.node(Node::Finally(window(1, Some(1)), p));
    let always = tree.node(Node::Globally(window(0, None), next));
    let made = Monitor::formula(&tree, always, Tick(9), Clock::Steps);
    assert_eq!(made.err(), Some(Invalid::BeyondHorizon { needed: 10, horizon: 9 }));
}

#[test]
fn until_needs_p_at_every_state_before_q() {
    let u = formula(Node::Until(window(0, Some(4)), P, Q));
    assert_eq!(run(&u, 9, "1110", "0001"), Some((true, 3)), "p need not hold where q does");
    assert_eq!(run(&u, 9, "1101", "0001"), Some((false, 2)));
    assert_eq!(run(&u, 9, "111111", "000001"), Some((false, 4)), "q comes too late");
}

#[test]
fn until_looks_at_q_first() {
    let u = formula(Node::Until(window(0, Some(4)), P, Q));
    assert_eq!(run(&u, 9, "0", "1"), Some((true, 0)), "p never needs to hold");
}

#[test]
fn an_interval_of_until_bounds_q_alone() {
    let u = formula(Node::Until(window(2, Some(4)), P, Q));
    assert_eq!(run(&u, 9, "110", "011"), Some((true, 2)), "q at 1 is too early, at 2 it counts");
    assert_eq!(run(&u, 9, "10", "11"), Some((false, 1)), "p must hold from the present state on");
}

#[test]
fn weak_until_may_wait_for_ever() {
    let w = formula(Node::WeakUntil(window(0, Some(3)), P, Q));
    assert_eq!(run(&w, 9, "1111", "0000"), Some((true, 3)));
    assert_eq!(run(&w, 9, "1110", "0000"), Some((false, 3)), "p is needed at the last state too");
    assert_eq!(run(&w, 9, "10", "01"), Some((true, 1)));
}

#[test]
fn release_keeps_q_up_to_and_with_p() {
    let r = formula(Node::Release(window(0, Some(3)), P, Q));
    assert_eq!(run(&r, 9, "001", "111"), Some((true, 2)), "released at the state where both hold");
    assert_eq!(run(&r, 9, "001", "110"), Some((false, 2)), "q is still needed there");
    assert_eq!(run(&r, 9, "0000", "1111"), Some((true, 3)), "never released");
}

#[test]
fn no_bound_ranges_up_to_the_horizon() {
    let f = formula(Node::Finally(window(0, None), P));
    assert_eq!(run(&f, 4, "00001", ""), Some((true, 4)), "the state at the horizon counts");
    assert_eq!(run(&f, 4, "00000", ""), Some((false, 4)));
    let g = formula(Node::Globally(window(0, None), P));
    assert_eq!(run(&g, 4, "11111", ""), Some((true, 4)));
    assert_eq!(run(&g, 4, "1111", ""), None, "open before the horizon");
    assert!(Monitor::formula(&f.0, f.1, Tick(0), Clock::Steps).is_ok(), "it fits into any horizon");
}

#[test]
fn a_horizon_that_is_too_short_is_an_error_with_both_numbers() {
    let (tree, root) = formula(Node::Globally(window(0, Some(500)), P));
    let made = Monitor::formula(&tree, root, Tick(499), Clock::Steps);
    let error = made.err().unwrap();
    assert_eq!(error, Invalid::BeyondHorizon { needed: 500, horizon: 499 });
    assert_eq!(error.to_string(), "the formula needs 500 steps, the horizon is 499 steps");
    assert!(Monitor::formula(&tree, root, Tick(500), Clock::Steps).is_ok());
}

#[test]
fn a_clock_without_steps_has_no_states() {
    let (tree, root) = formula(Node::Globally(window(0, Some(5)), P));
    assert_eq!(
        Monitor::formula(&tree, root, Tick(9), Clock::Jumps(Decimal::ONE)).err(),
        Some(Invalid::NoSteps)
    );
}

fn metric(make: impl FnOnce(&mut Tree, TermId) -> Term) -> (Tree, TermId) {
    let mut tree = Tree::default();
    tree.node(Node::Atom(AtomId(0)));
    let signal = tree.term(Term::Signal(SignalId(0)));
    let term = make(&mut tree, signal);
    let root = tree.term(term);
    (tree, root)
}

#[test]
fn aggregates_range_over_the_states_0_to_k() {
    let values = [4.0, 1.0, 3.0, 9.0];
    for (aggregation, expected) in [
        (Aggregation::Min, 1.0),
        (Aggregation::Max, 4.0),
        (Aggregation::Sum, 8.0),
        (Aggregation::Mean, 8.0 / 3.0),
    ] {
        let m = metric(|_, x| Term::Window(aggregation, window(0, Some(2)), x));
        assert_eq!(measure(&m, 9, Clock::Steps, &values), Some((expected, 2)));
    }
}

#[test]
fn sums_run_in_the_order_of_states() {
    let values = [1e16, 1.0, -1e16, 1.0];
    let m = metric(|_, x| Term::Window(Aggregation::Sum, window(0, Some(3)), x));
    assert_eq!(measure(&m, 9, Clock::Steps, &values), Some((1.0, 3)), "the first 1 is lost, the last is not");
}

#[test]
fn the_smallest_number_of_a_window_is_compared_state_by_state() {
    let mut tree = Tree::default();
    let gap = tree.term(Term::Signal(SignalId(0)));
    let least = tree.term(Term::Window(Aggregation::Min, window(0, Some(9)), gap));
    let limit = tree.term(Term::Constant(0.5));
    let root = tree.node(Node::Compare(Relation::Greater, least, limit));
    let mut monitor = Monitor::formula(&tree, root, Tick(9), Clock::Steps).unwrap();
    monitor.start(0);
    for value in [1.0, 0.7, 0.4] {
        assert!(monitor.decided().is_empty());
        monitor.observe(Mask::lane(0), &[], &[Lanes::splat(value)]);
    }
    assert_eq!((monitor.decided().has(0), monitor.truth().has(0), monitor.decided_at()[0]), (true, false, 2));
}

#[test]
fn time_until_is_in_seconds_and_infinite_if_it_never_comes() {
    let clock = Clock::Stepped(Decimal::ratio(1, 3).unwrap());
    let m = metric(|_, _| Term::TimeUntil(P));
    assert_eq!(measure(&m, 9, clock, &[0.0, 0.0, 0.0, 1.0]), Some((1.0, 3)), "three thirds are one, exactly");
    assert_eq!(measure(&m, 4, clock, &[0.0; 5]), Some((f64::INFINITY, 4)));
    assert_eq!(measure(&m, 4, clock, &[1.0]), Some((0.0, 0)));
}

#[test]
fn the_number_at_the_end_is_that_of_the_horizon() {
    let m = metric(|_, x| Term::AtEnd(x));
    assert_eq!(measure(&m, 3, Clock::Steps, &[5.0, 6.0, 7.0, 8.0, 9.0]), Some((8.0, 3)));
    let later = metric(|_, x| Term::Later(Tick(2), x));
    assert_eq!(measure(&later, 3, Clock::Steps, &[5.0, 6.0, 7.0, 8.0]), Some((7.0, 2)));
}

#[test]
fn a_comparison_with_no_number_is_false_either_way() {
    for relation in [
        Relation::Less,
        Relation::AtMost,
        Relation::Greater,
        Relation::AtLeast,
        Relation::Equal,
        Relation::Unequal,
    ] {
        let mut tree = Tree::default();
        let x = tree.term(Term::Signal(SignalId(0)));
        let zero = tree.term(Term::Constant(0.0));
        let root = tree.node(Node::Compare(relation, x, zero));
        let mut monitor = Monitor::formula(&tree, root, Tick(0), Clock::Steps).unwrap();
        monitor.start(0);
        monitor.observe(Mask::lane(0), &[], &[Lanes::splat(f64::NAN)]);
        assert!(monitor.decided().has(0) && !monitor.truth().has(0), "{relation:?}");
    }
}

#[test]
fn windows_nest_and_decide_as_soon_as_the_values_force_it() {
    let mut tree = Tree::default();
    let p = tree.node(Node::Atom(AtomId(0)));
    let soon = tree.node(Node::Finally(window(0, Some(2)), p));
    let root = tree.node(Node::Globally(window(0, Some(3)), soon));
    let f = (tree, root);
    assert_eq!(run(&f, 9, "000", ""), Some((false, 2)), "no p within two steps of the first state");
    assert_eq!(run(&f, 9, "001001", ""), Some((true, 5)));
    assert_eq!(run(&f, 9, "111100", ""), Some((true, 3)), "the last position needs no second look");
    let short = Monitor::formula(&f.0, f.1, Tick(4), Clock::Steps);
    assert_eq!(short.err(), Some(Invalid::BeyondHorizon { needed: 5, horizon: 4 }));
    assert!(Monitor::formula(&f.0, f.1, Tick(5), Clock::Steps).is_ok());
}

#[test]
fn an_empty_window_and_a_missing_part_are_errors() {
    let (tree, root) = formula(Node::Finally(Window { from: Tick(3), to: Some(Tick(2)) }, P));
    let made = Monitor::formula(&tree, root, Tick(9), Clock::Steps);
    assert_eq!(made.err(), Some(Invalid::EmptyWindow { from: 3, to: 2 }));
    let (tree, root) = formula(Node::Not(NodeId(77)));
    assert_eq!(Monitor::formula(&tree, root, Tick(9), Clock::Steps).err(), Some(Invalid::Malformed));
}

/// The time until what never holds is the same everywhere, and so is a comparison with it.
#[test]
fn a_time_that_never_comes_is_compared_at_once() {
    use smc::base::lanes::{Lanes, Mask};
    use smc::base::tick::{Clock, Tick};
    use smc::logic::{Monitor, Node, Operation, Relation, Term, Tree, Window};
    let mut tree = Tree::default();
    let never = tree.node(Node::Constant(false));
    let until = tree.term(Term::TimeUntil(never));
    let zero = tree.term(Term::Constant(0.0));
    let sum = tree.term(Term::Combine(Operation::Add, until, zero));
    for (x, y) in [(until, zero), (zero, until), (sum, zero), (until, sum)] {
        let equal = tree.node(Node::Compare(Relation::Equal, x, y));
        let window = Window { from: Tick(0), to: Some(Tick(1)) };
        let root = tree.node(Node::Finally(window, equal));
        let mut monitor = Monitor::formula(&tree, root, Tick(3), Clock::Steps).unwrap();
        monitor.start(0);
        monitor.observe(Mask::lane(0), &[], &[] as &[Lanes]);
        assert!(monitor.decided().has(0), "decided at the first state");
        assert_eq!(monitor.truth().has(0), x == until && y == sum);
    }
}
