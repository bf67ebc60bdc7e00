//! All Boolean traces up to length 8: verdict, and the state at which it falls.

use super::reference::{Prefix, holds};
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::tick::{Clock, Tick};
use smc::logic::{AtomId, Monitor, Node, NodeId, Tree, Window};

pub(crate) fn window(from: u64, to: Option<u64>) -> Window {
    Window { from: Tick(from), to: to.map(Tick) }
}

/// Verdict and deciding state of each of up to eight traces, run side by side.
fn monitored(tree: &Tree, root: NodeId, horizon: u64, traces: &[Vec<Vec<bool>>]) -> Vec<(bool, u64)> {
    let mut monitor = Monitor::formula(tree, root, Tick(horizon), Clock::Steps).unwrap();
    for lane in 0..traces.len() {
        monitor.start(lane);
    }
    let lanes = Mask(((1u16 << traces.len()) - 1) as u8);
    let mut verdicts = vec![None; traces.len()];
    for state in 0..=horizon as usize {
        let atoms: Vec<Mask> = (0..traces[0].len())
            .map(|atom| {
                let bits =
                    traces.iter().enumerate().map(|(lane, trace)| u8::from(trace[atom][state]) << lane);
                Mask(bits.fold(0, |all, bit| all | bit))
            })
            .collect();
        monitor.observe(lanes, &atoms, &[] as &[Lanes]);
        for lane in monitor.decided().iter() {
            let verdict = (monitor.truth().has(lane), monitor.decided_at()[lane]);
            let first = *verdicts[lane].get_or_insert(verdict);
            assert_eq!(first, verdict, "a verdict never changes");
        }
    }
    verdicts.into_iter().map(|v| v.expect("decided at the horizon")).collect()
}

/// All traces of `length` states over `atoms` atoms.
fn all_traces(atoms: usize, length: usize) -> impl Iterator<Item = Vec<Vec<bool>>> {
    (0u32..1 << (atoms * length)).map(move |bits| {
        (0..atoms).map(|a| (0..length).map(|s| bits >> (a * length + s) & 1 == 1).collect()).collect()
    })
}

fn check(tree: &Tree, root: NodeId, atoms: usize, length: usize) -> usize {
    let horizon = length as u64 - 1;
    if Monitor::formula(tree, root, Tick(horizon), Clock::Steps).is_err() {
        return 0;
    }
    let traces: Vec<_> = all_traces(atoms, length).collect();
    for eight in traces.chunks(LANES) {
        for (trace, (verdict, index)) in eight.iter().zip(monitored(tree, root, horizon, eight)) {
            let prefix =
                |seen| Prefix { tree, atoms: trace, signals: &[], seen, horizon, seconds: 1.0, known: None };
            let context = || format!("{:?} of {:?} on {trace:?}", root, tree.nodes);
            assert_eq!(prefix(index + 1).truth(root, 0), Some(verdict), "{}", context());
            assert_eq!(holds(tree, root, trace, 0, horizon), verdict, "{}", context());
            if index > 0 {
                assert_eq!(prefix(index).truth(root, 0), None, "too late: {}", context());
            }
        }
    }
    traces.len()
}

/// Operators over two operands.
fn operators(tree: &mut Tree, w: Window, p: NodeId, q: NodeId) -> Vec<NodeId> {
    [
        Node::Finally(w, p),
        Node::Globally(w, p),
        Node::Until(w, p, q),
        Node::WeakUntil(w, p, q),
        Node::Release(w, p, q),
    ]
    .into_iter()
    .map(|node| tree.node(node))
    .collect()
}

fn windows() -> Vec<Window> {
    [(0, Some(0)), (0, Some(1)), (0, Some(4)), (1, Some(1)), (1, Some(3)), (2, Some(5)), (0, None), (2, None)]
        .map(|(from, to)| window(from, to))
        .to_vec()
}

#[test]
fn single_operators_on_all_traces_up_to_length_8() {
    let mut tried = 0;
    for length in 1..=8 {
        for w in windows() {
            let mut tree = Tree::default();
            let p = tree.node(Node::Atom(AtomId(0)));
            let q = tree.node(Node::Atom(AtomId(1)));
            for root in operators(&mut tree, w, p, q) {
                // Every trace of the atoms that the operator reads.
                let two = matches!(
                    tree.nodes[root.0 as usize],
                    Node::Until(..) | Node::WeakUntil(..) | Node::Release(..)
                );
                tried += check(&tree, root, if two { 2 } else { 1 }, length);
            }
        }
    }
    assert!(tried > 1_000_000, "{tried}");
}

#[test]
fn nested_operators_on_all_traces_up_to_length_8() {
    let inner = [window(0, Some(2)), window(1, Some(1)), window(1, Some(3)), window(0, None)];
    let outer = [window(0, Some(3)), window(1, Some(2)), window(0, None), window(0, Some(0))];
    let mut tried = 0;
    for length in [4, 7, 8] {
        for (a, b) in inner.iter().flat_map(|a| outer.iter().map(move |b| (*a, *b))) {
            let mut tree = Tree::default();
            let p = tree.node(Node::Atom(AtomId(0)));
            let not_p = tree.node(Node::Not(p));
            let next = tree.node(Node::Finally(window(1, Some(1)), p));
            for one in operators(&mut tree, a, p, not_p) {
                let either = tree.node(Node::Or(vec![not_p, one]));
                let both = tree.node(Node::And(vec![p, one]));
                let odd = tree.node(Node::Or(vec![next, both]));
                for x in [one, either, both, odd] {
                    for root in operators(&mut tree, b, x, p) {
                        tried += check(&tree, root, 1, length);
                    }
                    for root in operators(&mut tree, b, not_p, x) {
                        tried += check(&tree, root, 1, length);
                    }
                }
            }
        }
    }
    assert!(tried > 300_000, "{tried}");
}

#[test]
fn two_levels_of_two_atoms_on_all_traces_up_to_length_5() {
    let mut tried = 0;
    for (a, b) in [(0, Some(2)), (1, Some(2)), (0, None)]
        .into_iter()
        .flat_map(|a| [(0, Some(2)), (1, Some(2)), (0, None)].into_iter().map(move |b| (a, b)))
    {
        let mut tree = Tree::default();
        let p = tree.node(Node::Atom(AtomId(0)));
        let q = tree.node(Node::Atom(AtomId(1)));
        let ones = operators(&mut tree, window(a.0, a.1), p, q);
        let others = operators(&mut tree, window(b.0, b.1), q, p);
        for &x in &ones {
            for &y in &others {
                let both = tree.node(Node::And(vec![x, y]));
                let chain = tree.node(Node::Or(vec![both, p]));
                for root in operators(&mut tree, window(0, Some(1)), x, y) {
                    tried += check(&tree, root, 2, 5);
                }
                for root in operators(&mut tree, window(0, Some(2)), chain, q) {
                    tried += check(&tree, root, 2, 5);
                }
            }
        }
    }
    assert!(tried > 300_000, "{tried}");
}
