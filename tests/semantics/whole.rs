//! What holds for a monitor as a whole: memory, triggered implications, explanations, odd inputs.

use super::exhaustive::window;
use super::reference::Prefix;
use proptest::prelude::*;
use smc::base::lanes::{LANES, Mask};
use smc::base::tick::{Clock, Tick};
use smc::logic::{
    Aggregation, AtomId, Invalid, Monitor, Node, NodeId, Recording, Relation, SignalId, Term, Tree, explain,
};

fn soon_after(tree: &mut Tree) -> (NodeId, NodeId) {
    let a = tree.node(Node::Atom(AtomId(0)));
    let b = tree.node(Node::Atom(AtomId(1)));
    let not_a = tree.node(Node::Not(a));
    let soon = tree.node(Node::Finally(window(0, Some(20)), b));
    let implies = tree.node(Node::Or(vec![not_a, soon]));
    (tree.node(Node::Globally(window(0, Some(100)), implies)), implies)
}

#[test]
fn memory_does_not_depend_on_the_horizon() {
    let mut tree = Tree::default();
    let (root, _) = soon_after(&mut tree);
    let bytes = |horizon| Monitor::formula(&tree, root, Tick(horizon), Clock::Steps).unwrap().bytes();
    assert_eq!(bytes(120), bytes(1200));
    assert_eq!(bytes(1200), bytes(1_000_000));
}

#[test]
fn implications_tell_whether_they_were_triggered() {
    let mut tree = Tree::default();
    let (root, implies) = soon_after(&mut tree);
    let mut monitor = Monitor::formula(&tree, root, Tick(200), Clock::Steps).unwrap();
    for lane in 0..LANES {
        monitor.start(lane);
    }
    // Lane 1 is triggered at once, lane 2 after the last position that matters, lane 3 at the last.
    for state in 0..=120u64 {
        let a = (u8::from(state == 0) << 1) | (u8::from(state == 101) << 2) | (u8::from(state == 100) << 3);
        monitor.observe(Mask::ALL, &[Mask(a), Mask(0xff)], &[]);
    }
    assert_eq!(monitor.decided(), Mask::ALL);
    let found: Vec<_> = monitor.antecedents().collect();
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].implication, implies);
    assert_eq!(found[0].triggered, Mask(0b1010));
    assert_eq!(monitor.constant(), None);
}

#[test]
fn a_formula_of_constants_is_constant_and_decided_at_the_first_state() {
    let mut tree = Tree::default();
    let yes = tree.node(Node::Constant(true));
    let a = tree.node(Node::Atom(AtomId(0)));
    let either = tree.node(Node::Or(vec![a, yes]));
    let root = tree.node(Node::Globally(window(0, Some(5)), either));
    let mut monitor = Monitor::formula(&tree, root, Tick(9), Clock::Steps).unwrap();
    assert_eq!(monitor.constant(), Some(true));
    monitor.start(0);
    monitor.observe(Mask::ALL, &[], &[]);
    assert_eq!((monitor.decided(), monitor.decided_at()[0]), (Mask::lane(0), 0));
}

#[test]
fn a_lane_that_is_left_out_ends_and_odd_lanes_are_ignored() {
    let mut tree = Tree::default();
    let p = tree.node(Node::Atom(AtomId(0)));
    let root = tree.node(Node::Globally(window(0, Some(2)), p));
    let mut monitor = Monitor::formula(&tree, root, Tick(2), Clock::Steps).unwrap();
    monitor.start(0);
    monitor.start(1);
    monitor.start(4000);
    monitor.observe(Mask(0b11), &[Mask::ALL], &[]);
    monitor.observe(Mask(0b01), &[Mask::ALL], &[]);
    for _ in 0..9 {
        monitor.observe(Mask(0b11), &[Mask::ALL], &[]);
    }
    assert_eq!(monitor.decided(), Mask(0b01));
}

#[test]
fn deep_and_large_formulas_are_refused_not_run() {
    let mut tree = Tree::default();
    let mut deep = tree.node(Node::Atom(AtomId(0)));
    for k in 0..1000 {
        deep =
            tree.node(if k % 2 == 0 { Node::Not(deep) } else { Node::Until(window(0, Some(1)), deep, deep) });
    }
    assert!(Monitor::formula(&tree, deep, Tick(2000), Clock::Steps).is_ok());
    for _ in 0..100 {
        deep = tree.node(Node::Not(deep));
    }
    let made = Monitor::formula(&tree, deep, Tick(2000), Clock::Steps);
    assert!(matches!(made.err(), Some(Invalid::TooDeep { .. })));

    // 2^k different ranges of one part.
    let mut tree = Tree::default();
    let mut x = tree.node(Node::Atom(AtomId(0)));
    for k in 0..40 {
        let far = tree.node(Node::Finally(window(1 << k, Some(1 << k)), x));
        x = tree.node(Node::And(vec![x, far]));
    }
    let made = Monitor::formula(&tree, x, Tick(1 << 40), Clock::Steps);
    assert!(matches!(made.err(), Some(Invalid::TooLarge { .. })));

    let mut tree = Tree::default();
    let p = tree.node(Node::Atom(AtomId(0)));
    let far = tree.node(Node::Finally(window(0, Some(1 << 30)), p));
    let root = tree.node(Node::Globally(window(0, Some(5)), far));
    let made = Monitor::formula(&tree, root, Tick(1 << 31), Clock::Steps);
    assert!(matches!(made.err(), Some(Invalid::TooLarge { .. })));
    let made = Monitor::formula(&tree, root, Tick(u64::MAX), Clock::Steps);
    assert!(matches!(made.err(), Some(Invalid::TooLong { .. })));

    // Sums up to the horizon at every state come all at once there; the least of them in one pass.
    let mut tree = Tree::default();
    let x = tree.term(Term::Signal(SignalId(0)));
    let zero = tree.term(Term::Constant(0.0));
    let mut made = |aggregation, horizon| {
        let joined = tree.term(Term::Window(aggregation, window(0, None), x));
        let above = tree.node(Node::Compare(Relation::AtLeast, joined, zero));
        let root = tree.node(Node::Globally(window(0, None), above));
        Monitor::formula(&tree, root, Tick(horizon), Clock::Steps).err()
    };
    assert_eq!(made(Aggregation::Mean, 20_000), None);
    assert!(matches!(made(Aggregation::Mean, 400_000), Some(Invalid::TooMany { .. })));
    assert_eq!(made(Aggregation::Max, 400_000), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whoever sees nothing but the states that an explanation names comes to the same verdict.
    #[test]
    fn an_explanation_forces_the_verdict(
        sketch in super::random::Sketch::formula(3, false, true),
        states in proptest::collection::vec(0u8..8, 25),
    ) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        let horizon = 24;
        let Ok(mut monitor) = Monitor::formula(&tree, root, Tick(horizon), Clock::Steps) else {
            return Ok(());
        };
        let atoms: Vec<Vec<bool>> = (0..3).map(|a| states.iter().map(|s| s >> a & 1 == 1).collect()).collect();
        monitor.start(0);
        for state in 0..=horizon as usize {
            let masks: Vec<Mask> = atoms.iter().map(|atom| Mask(u8::from(atom[state]))).collect();
            monitor.observe(Mask::lane(0), &masks, &[]);
        }
        let recording = Recording {
            atoms: &|AtomId(k), state| atoms[k as usize][state as usize],
            signals: &|_, _| 0.0,
            seen: monitor.decided_at()[0] + 1,
            horizon: Tick(horizon),
            clock: Clock::Steps,
            stop: &|| false,
        };
        let found = explain(&tree, root, &recording).unwrap();
        prop_assert_eq!(found.verdict, Some(monitor.truth().has(0)));
        let named = |atom: u32, state: u64| {
            found.reasons.iter().any(|reason| {
                tree.nodes[reason.leaf.0 as usize] == Node::Atom(AtomId(atom))
                    && (reason.from.0..=reason.to.0).contains(&state)
            })
        };
        for reason in &found.reasons {
            let Node::Atom(AtomId(k)) = tree.nodes[reason.leaf.0 as usize] else { panic!() };
            prop_assert!((reason.from.0..=reason.to.0).all(|s| atoms[k as usize][s as usize] == reason.value));
        }
        let blind = Prefix {
            tree: &tree,
            atoms: &atoms,
            signals: &[],
            seen: recording.seen,
            horizon,
            seconds: 1.0,
            known: Some(&named),
        };
        prop_assert_eq!(blind.truth(root, 0), found.verdict);
    }
}
