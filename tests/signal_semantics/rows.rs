//! One test for each row of the table on continuous time in `docs/semantics.md`.

use smc::base::decimal::Decimal;
use smc::base::tick::Tick;
use smc::logic::{
    Aggregation, AtomId, Invalid, Node, NodeId, Reading, Relation, SignalId, SignalMonitor, Term, TermId,
    Tree, Window,
};

const P: NodeId = NodeId(0);
const Q: NodeId = NodeId(1);
const X: TermId = TermId(0);
const TRUE: Reading = Reading::Truth(true);
const FALSE: Reading = Reading::Truth(false);

fn window(from: u64, to: Option<u64>) -> Window {
    Window { from: Tick(from), to: to.map(Tick) }
}

/// A tree with the atoms p and q, the number x, and more formulas; the last one is the root.
fn formula(nodes: Vec<Node>) -> (Tree, NodeId) {
    let mut tree = Tree::default();
    tree.node(Node::Atom(AtomId(0)));
    tree.node(Node::Atom(AtomId(1)));
    tree.term(Term::Signal(SignalId(0)));
    let root = nodes.into_iter().map(|node| tree.node(node)).last();
    (tree, root.unwrap())
}

fn metric(nodes: Vec<Node>, terms: Vec<Term>) -> (Tree, TermId) {
    let (mut tree, _) = formula([vec![Node::Constant(true)], nodes].concat());
    let root = terms.into_iter().map(|term| tree.term(term)).last();
    (tree, root.unwrap())
}

/// Runs one trial of ten seconds: at these times p, q and x become so.
fn run(monitor: Result<SignalMonitor, Invalid>, jumps: &[(f64, u8, u8, f64)]) -> (Reading, f64) {
    let mut monitor = monitor.unwrap();
    for &(time, p, q, x) in jumps {
        monitor.jump(time, &[p == 1, q == 1], &[x]);
    }
    (monitor.finish(), monitor.decided_at())
}

fn check((tree, root): &(Tree, NodeId), jumps: &[(f64, u8, u8)]) -> (Reading, f64) {
    let jumps: Vec<_> = jumps.iter().map(|&(time, p, q)| (time, p, q, 0.0)).collect();
    run(SignalMonitor::formula(tree, *root, Tick(10), Decimal::whole(1)), &jumps)
}

fn measure((tree, root): &(Tree, TermId), jumps: &[(f64, f64)]) -> (Reading, f64) {
    let jumps: Vec<_> = jumps.iter().map(|&(time, x)| (time, u8::from(x > 0.0), 0, x)).collect();
    run(SignalMonitor::metric(tree, *root, Tick(10), Decimal::whole(1)), &jumps)
}

#[test]
fn the_state_at_a_time_is_the_one_that_begins_there() {
    let f = formula(vec![Node::Finally(window(2, Some(2)), P)]);
    assert_eq!(check(&f, &[(0.0, 0, 0), (2.0, 1, 0)]), (TRUE, 2.0));
    assert_eq!(check(&f, &[(0.0, 1, 0), (2.0, 0, 0)]), (FALSE, 2.0));
}

#[test]
fn a_state_that_holds_for_a_microsecond_counts() {
    let brief = [(0.0, 0, 0), (3.0, 1, 0), (3.000_001, 0, 0)];
    assert_eq!(check(&formula(vec![Node::Finally(window(0, Some(5)), P)]), &brief), (TRUE, 3.0));
    // Nested too: p holds from 3 s on, right after any time just before that.
    let nested =
        formula(vec![Node::Finally(window(1, Some(1)), P), Node::Finally(window(0, Some(5)), NodeId(2))]);
    assert_eq!(check(&nested, &brief), (TRUE, 3.0));
}

#[test]
fn a_state_that_lasts_no_time_does_not_count() {
    let f = formula(vec![Node::Finally(window(0, Some(5)), P)]);
    assert_eq!(check(&f, &[(0.0, 0, 0), (3.0, 1, 0), (3.0, 0, 0)]), (FALSE, 5.0));
    let g = formula(vec![Node::Globally(window(0, Some(5)), P)]);
    assert_eq!(check(&g, &[(0.0, 1, 0), (3.0, 0, 0), (3.0, 1, 0)]), (TRUE, 5.0));
}

#[test]
fn both_ends_of_an_interval_are_closed() {
    let f = formula(vec![Node::Finally(window(2, Some(4)), P)]);
    assert_eq!(check(&f, &[(0.0, 0, 0), (4.0, 1, 0)]), (TRUE, 4.0), "at the end alone");
    assert_eq!(check(&f, &[(0.0, 1, 0), (2.0, 0, 0)]), (FALSE, 4.0), "just before the beginning");
    assert_eq!(check(&f, &[(0.0, 1, 0), (2.5, 0, 0)]), (TRUE, 2.0));
    let g = formula(vec![Node::Globally(window(2, Some(4)), P)]);
    assert_eq!(check(&g, &[(0.0, 0, 0), (2.0, 1, 0), (4.0, 0, 0)]), (FALSE, 4.0));
}

#[test]
fn finally_within_0_is_p_now() {
    let f = formula(vec![Node::Finally(window(0, Some(0)), P)]);
    assert_eq!(check(&f, &[(0.0, 1, 0)]), (TRUE, 0.0));
    assert_eq!(check(&f, &[(0.0, 0, 0), (0.5, 1, 0)]), (FALSE, 0.0));
}

#[test]
fn until_looks_at_q_first_and_needs_p_at_every_instant_before() {
    let f = formula(vec![Node::Until(window(0, Some(4)), P, Q)]);
    assert_eq!(check(&f, &[(0.0, 0, 1)]), (TRUE, 0.0));
    assert_eq!(check(&f, &[(0.0, 1, 0), (3.0, 0, 1)]), (TRUE, 3.0));
    assert_eq!(check(&f, &[(0.0, 1, 0), (2.999, 0, 0), (3.0, 0, 1)]), (FALSE, 2.999));
    let late = formula(vec![Node::Until(window(2, Some(4)), P, Q)]);
    assert_eq!(check(&late, &[(0.0, 1, 1), (1.0, 0, 1)]), (FALSE, 1.0));
    assert_eq!(check(&late, &[(0.0, 1, 1)]), (TRUE, 2.0));
}

#[test]
fn an_interval_that_is_open_on_the_left_is_reached_only_through_p() {
    // Once p is over for a second: right after 2 s it was false for the whole last second.
    let g = Node::Globally(window(0, Some(1)), P);
    let since = |until| formula(vec![g.clone(), Node::Not(NodeId(2)), until]);
    // !(G<=1 p) begins right after 3 s, where p ends at 4 s with a point: q until there holds up to and with 3 s.
    let f = since(Node::Until(window(0, Some(5)), Q, NodeId(3)));
    assert_eq!(
        check(&f, &[(0.0, 1, 1), (3.0, 1, 0), (4.0, 0, 0)]).0,
        TRUE,
        "G<=1 p fails from 3 s on, closed"
    );
    assert_eq!(check(&f, &[(0.0, 1, 1), (2.5, 1, 0), (4.0, 0, 0)]).0, FALSE);
    // F<=1 p is false right after 3 s only if p ends at 3 s with it: from 3 s on.
    let within =
        formula(vec![Node::Finally(window(1, Some(1)), P), Node::Until(window(0, Some(5)), Q, NodeId(2))]);
    assert_eq!(
        check(&within, &[(0.0, 0, 1), (2.0, 0, 0), (3.0, 1, 0)]).0,
        TRUE,
        "q up to 2 s, p one second later"
    );
}

#[test]
fn weak_until_and_release() {
    let w = formula(vec![Node::WeakUntil(window(0, Some(3)), P, Q)]);
    assert_eq!(check(&w, &[(0.0, 1, 0)]), (TRUE, 3.0));
    assert_eq!(check(&w, &[(0.0, 1, 0), (3.0, 0, 0)]), (FALSE, 3.0));
    let r = formula(vec![Node::Release(window(0, Some(3)), P, Q)]);
    assert_eq!(check(&r, &[(0.0, 0, 1), (2.0, 1, 1), (2.5, 1, 0)]), (TRUE, 2.0));
    assert_eq!(check(&r, &[(0.0, 0, 1), (2.0, 1, 0)]), (FALSE, 2.0));
}

#[test]
fn without_a_bound_the_horizon_is_the_end_and_counts() {
    let f = formula(vec![Node::Finally(window(0, None), P)]);
    assert_eq!(check(&f, &[(0.0, 0, 0), (10.0, 1, 0)]), (TRUE, 10.0));
    assert_eq!(check(&f, &[(0.0, 0, 0), (10.5, 1, 0)]), (FALSE, 10.0));
}

#[test]
fn aggregates_over_time() {
    let aggregate = |aggregation| metric(vec![], vec![Term::Window(aggregation, window(0, Some(4)), X)]);
    let jumps = [(0.0, 1.0), (1.0, 5.0), (2.0, 2.0), (4.0, 0.0)];
    assert_eq!(measure(&aggregate(Aggregation::Mean), &jumps), (Reading::Value(10.0 / 4.0), 4.0));
    assert_eq!(measure(&aggregate(Aggregation::Max), &jumps), (Reading::Value(5.0), 4.0));
    assert_eq!(measure(&aggregate(Aggregation::Min), &jumps), (Reading::Value(0.0), 4.0), "the end counts");
    let (tree, root) = aggregate(Aggregation::Sum);
    let made = SignalMonitor::metric(&tree, root, Tick(10), Decimal::whole(1));
    assert_eq!(made.unwrap_err(), Invalid::SumOverTime);
}

#[test]
fn a_time_average_that_moves_is_compared_exactly() {
    // The average over the next 4 s of a pulse of 1 s never exceeds 1/4, and reaches it.
    for (relation, expected) in [(Relation::AtLeast, TRUE), (Relation::Greater, FALSE)] {
        let (mut tree, _) = formula(vec![Node::Constant(true)]);
        let mean = tree.term(Term::Window(Aggregation::Mean, window(0, Some(4)), X));
        let quarter = tree.term(Term::Constant(0.25));
        let high = tree.node(Node::Compare(relation, mean, quarter));
        let root = tree.node(Node::Finally(window(0, Some(5)), high));
        let jumps = [(0.0, 0, 0, 0.0), (4.5, 0, 0, 1.0), (5.5, 0, 0, 0.0)];
        let monitor = SignalMonitor::formula(&tree, root, Tick(10), Decimal::whole(1));
        assert_eq!(run(monitor, &jumps).0, expected);
    }
}

#[test]
fn time_until_is_the_instant_of_the_jump() {
    let time = metric(vec![], vec![Term::TimeUntil(P)]);
    assert_eq!(
        measure(&time, &[(0.0, 0.0), (0.123_456_789, 1.0)]),
        (Reading::Value(0.123_456_789), 0.123_456_789)
    );
    assert_eq!(measure(&time, &[(0.0, 0.0)]), (Reading::Value(f64::INFINITY), 10.0));
    let nested = metric(vec![Node::Globally(window(0, None), P)], vec![Term::TimeUntil(NodeId(3))]);
    assert_eq!(measure(&nested, &[(0.0, 0.0), (2.5, 1.0)]), (Reading::Value(2.5), 10.0));
}

#[test]
fn the_value_at_the_end_is_the_one_holding_at_the_horizon() {
    let end = metric(vec![], vec![Term::AtEnd(X)]);
    assert_eq!(measure(&end, &[(0.0, 1.0), (10.0, 3.0)]), (Reading::Value(3.0), 10.0));
    assert_eq!(measure(&end, &[(0.0, 1.0), (10.1, 3.0)]), (Reading::Value(1.0), 10.0));
}

#[test]
fn what_needs_more_than_the_horizon_is_refused() {
    let f = formula(vec![Node::Finally(window(0, Some(11)), P)]);
    let made = SignalMonitor::formula(&f.0, f.1, Tick(10), Decimal::whole(1));
    assert_eq!(made.unwrap_err(), Invalid::BeyondHorizon { needed: 11, horizon: 10 });
    // p is needed at every instant before 3 s, so its window reaches every instant before 11 s.
    let f =
        formula(vec![Node::Finally(window(0, Some(8)), P), Node::Until(window(0, Some(3)), NodeId(2), Q)]);
    let made = SignalMonitor::formula(&f.0, f.1, Tick(10), Decimal::whole(1));
    assert_eq!(made.unwrap_err(), Invalid::BeyondHorizon { needed: 11, horizon: 10 });
    let f = formula(vec![Node::Finally(window(5, Some(3)), P)]);
    let made = SignalMonitor::formula(&f.0, f.1, Tick(10), Decimal::whole(1));
    assert_eq!(made.unwrap_err(), Invalid::EmptyWindow { from: 5, to: 3 });
}

#[test]
fn a_number_that_moves_with_time_is_compared_with_constants_only() {
    let (mut tree, _) = formula(vec![Node::Constant(true)]);
    let mean = tree.term(Term::Window(Aggregation::Mean, window(0, Some(4)), X));
    let low = tree.node(Node::Compare(Relation::Less, mean, X));
    let root = tree.node(Node::Globally(window(0, Some(5)), low));
    let made = SignalMonitor::formula(&tree, root, Tick(10), Decimal::whole(1));
    assert_eq!(made.unwrap_err(), Invalid::MovingNumber);
    assert!(SignalMonitor::formula(&tree, low, Tick(10), Decimal::whole(1)).is_ok(), "at the start it may");
}

#[test]
fn a_trial_of_too_many_pieces_is_unresolved() {
    // Nine seconds of pulses have to be kept until the first of them is over.
    let f = formula(vec![
        Node::Finally(window(9, Some(9)), P),
        Node::And(vec![NodeId(2), P]),
        Node::Finally(window(0, Some(1)), NodeId(3)),
    ]);
    let mut monitor = SignalMonitor::formula(&f.0, f.1, Tick(10), Decimal::whole(1)).unwrap();
    let mut pulses = |count: u32| {
        monitor.start();
        let pulse = |k: u32| f64::from(k) * 8.0 / f64::from(count);
        (0..count).find_map(|k| monitor.jump(pulse(k), &[k % 2 == 1, false], &[]))
    };
    assert_eq!(pulses(20_000), None);
    assert_eq!(pulses(20_000_000), Some(Reading::Unresolved));
    assert_eq!(pulses(20_000), None, "the next trial is not concerned");
}

/// Before there is a reading the last state is not judged: it may last, and be a case.
#[test]
fn the_state_at_which_a_trial_is_broken_off_may_be_a_case() {
    let (tree, root) = formula(vec![
        Node::Not(P),
        Node::Or(vec![NodeId(2), Q]),
        Node::Globally(window(0, Some(2)), NodeId(3)),
    ]);
    let mut monitor = SignalMonitor::formula(&tree, root, Tick(4), Decimal::parse("1").unwrap()).unwrap();
    assert_eq!((monitor.implications(), monitor.triggered()), (1, 0));
    let mut broken_off = |jumps: &[(f64, bool)]| {
        monitor.start();
        for &(time, a) in jumps {
            monitor.jump(time, &[a, true], &[]);
        }
        monitor.triggered()
    };
    assert_eq!(broken_off(&[(0.0, false), (1.0, true)]), 1);
    assert_eq!(broken_off(&[(0.0, false), (1.0, true), (1.0, false)]), 0);
    assert_eq!(broken_off(&[(0.0, false), (1.0, true), (1.5, false)]), 1);
    // Nobody asks there any more.
    assert_eq!(broken_off(&[(0.0, false), (2.5, true)]), 0);
}
