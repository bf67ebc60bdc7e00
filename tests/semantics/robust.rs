//! Robustness against its plain definition, and its sign against the Boolean monitor.

use super::exhaustive::window;
use super::random::{Sketch, TestRandom};
use proptest::prelude::*;
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::tick::{Clock, Tick};
use smc::logic::{
    Aggregation, AtomId, Invalid, Monitor, Node, NodeId, Relation, Robustness, SignalId, Term, Tree, Window,
};

const ATOMS: usize = 3;

/// The definition: bounds of the robustness at a position when so many states have been seen.
struct Plain<'a> {
    tree: &'a Tree,
    margins: &'a [Vec<f64>],
    seen: u64,
    horizon: u64,
}

type Bounds = (f64, f64);

fn least(all: impl Iterator<Item = Bounds>) -> Bounds {
    all.fold((f64::INFINITY, f64::INFINITY), |a, b| (a.0.min(b.0), a.1.min(b.1)))
}

fn most(all: impl Iterator<Item = Bounds>) -> Bounds {
    not(least(all.map(not)))
}

fn not(a: Bounds) -> Bounds {
    (-a.1, -a.0)
}

impl Plain<'_> {
    fn until(&self, w: Window, at: u64, p: impl Fn(u64) -> Bounds, q: impl Fn(u64) -> Bounds) -> Bounds {
        most(self.states(w, at).map(|k| least((at..k).map(&p).chain([q(k)]))))
    }

    fn states(&self, w: Window, at: u64) -> std::ops::RangeInclusive<u64> {
        at + w.from.0..=w.to.map_or(self.horizon, |to| at + to.0)
    }

    fn of(&self, node: NodeId, at: u64) -> Bounds {
        let is = |x: &NodeId, k: u64| self.of(*x, k);
        match &self.tree.nodes[node.0 as usize] {
            Node::Constant(true) => (f64::INFINITY, f64::INFINITY),
            Node::Constant(false) => (f64::NEG_INFINITY, f64::NEG_INFINITY),
            Node::Atom(AtomId(k)) if at < self.seen => {
                let margin = self.margins[*k as usize][at as usize];
                (margin, margin)
            }
            Node::Atom(_) => (f64::NEG_INFINITY, f64::INFINITY),
            Node::Not(x) => not(is(x, at)),
            Node::And(parts) => least(parts.iter().map(|x| is(x, at))),
            Node::Or(parts) => most(parts.iter().map(|x| is(x, at))),
            Node::Finally(w, x) => most(self.states(*w, at).map(|k| is(x, k))),
            Node::Globally(w, x) => least(self.states(*w, at).map(|k| is(x, k))),
            Node::Until(w, p, q) => self.until(*w, at, |k| is(p, k), |k| is(q, k)),
            Node::WeakUntil(w, p, q) => {
                let always = least((at..=*self.states(*w, at).end()).map(|k| is(p, k)));
                most([self.until(*w, at, |k| is(p, k), |k| is(q, k)), always].into_iter())
            }
            Node::Release(w, p, q) => not(self.until(*w, at, |k| not(is(p, k)), |k| not(is(q, k)))),
            Node::Compare(..) => panic!("margins of atoms alone"),
        }
    }
}

fn margins(random: &mut TestRandom, states: u64) -> Vec<Vec<f64>> {
    (0..ATOMS)
        .map(|_| {
            let mut value = 1.0;
            (0..states)
                .map(|_| {
                    if random.below(3) == 0 {
                        // Never zero: its sign says nothing.
                        value = random.below(20) as f64 - 9.5;
                    }
                    value
                })
                .collect()
        })
        .collect()
}

fn check(tree: &Tree, root: NodeId, horizon: u64, seed: u64) -> Result<(), TestCaseError> {
    let made = Robustness::new(tree, root, Tick(horizon), Clock::Steps);
    let boolean = Monitor::formula(tree, root, Tick(horizon), Clock::Steps);
    prop_assert_eq!(made.as_ref().err(), boolean.as_ref().err());
    let (Ok(mut robust), Ok(mut boolean)) = (made, boolean) else {
        return Err(TestCaseError::reject("beyond the horizon"));
    };
    let mut random = TestRandom(seed);
    let mut lanes: Vec<Option<(Vec<Vec<f64>>, u64)>> = vec![None; LANES];
    for _ in 0..3 * horizon + 8 {
        let mut mask = Mask::NONE;
        for (k, lane) in lanes.iter_mut().enumerate() {
            let settled = lane.is_some() && robust.settled().has(k);
            if (settled || lane.is_none()) && random.below(2) == 0 || random.below(50) == 0 {
                robust.start(k);
                boolean.start(k);
                *lane = Some((margins(&mut random, horizon + 1), 0));
            }
            if lane.is_some() {
                mask |= Mask::lane(k);
            }
        }
        let shown: Vec<Lanes> = (0..ATOMS)
            .map(|a| {
                Lanes(std::array::from_fn(|k| {
                    lanes[k]
                        .as_ref()
                        .map_or(3.0, |(trial, position)| trial[a][(*position).min(horizon) as usize])
                }))
            })
            .collect();
        let atoms: Vec<Mask> = shown.iter().map(|m| m.compare(Lanes::ZERO, |m, zero| m > zero)).collect();
        robust.observe(mask, &shown, &[]);
        boolean.observe(mask, &atoms, &[]);
        for (k, lane) in lanes.iter_mut().enumerate() {
            let Some((trial, position)) = lane else { continue };
            let seen = (*position + 1).min(horizon + 1);
            let (lower, upper) = Plain { tree, margins: trial, seen, horizon }.of(root, 0);
            prop_assert_eq!(
                (robust.lower().0[k], robust.upper().0[k]),
                (lower, upper),
                "lane {} at {}",
                k,
                position
            );
            prop_assert_eq!(robust.settled().has(k), lower == upper);
            // The sign is known exactly when the Boolean monitor decides, and is its verdict.
            let signed = lower > 0.0 || upper < 0.0;
            prop_assert_eq!(signed, boolean.decided().has(k));
            if signed {
                prop_assert_eq!(robust.lower().0[k] > 0.0, boolean.truth().has(k));
            }
            *position += 1;
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 3000, max_global_rejects: 1_000_000, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn bounds_are_those_of_the_definition(
        sketch in Sketch::formula(3, false, false), seed in any::<u64>(), horizon in 6u64..16,
    ) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        check(&tree, root, horizon, seed)?;
    }

    #[test]
    fn bounds_up_to_the_horizon_are_those_of_the_definition(
        sketch in Sketch::formula(2, false, true), seed in any::<u64>(), horizon in 0u64..10,
    ) {
        let mut tree = Tree::default();
        let root = sketch.node(&mut tree);
        check(&tree, root, horizon, seed)?;
    }
}

#[test]
fn comparisons_have_margins() {
    let mut tree = Tree::default();
    let gap = tree.term(Term::Signal(SignalId(0)));
    let limit = tree.term(Term::Constant(0.5));
    let apart = tree.node(Node::Compare(Relation::Greater, gap, limit));
    let always = tree.node(Node::Globally(window(0, Some(2)), apart));
    let least = tree.term(Term::Window(Aggregation::Min, window(0, Some(2)), gap));
    let same = tree.node(Node::Compare(Relation::Greater, least, limit));
    for root in [always, same] {
        let mut robust = Robustness::new(&tree, root, Tick(2), Clock::Steps).unwrap();
        robust.start(0);
        for (gap, upper) in [(2.0, 1.5), (0.75, 0.25), (1.0, 0.25)] {
            robust.observe(Mask::lane(0), &[], &[Lanes::splat(gap)]);
            assert_eq!(robust.upper().0[0], upper);
        }
        assert_eq!((robust.settled(), robust.lower().0[0]), (Mask::lane(0), 0.25));
    }
    let mean = tree.term(Term::Window(Aggregation::Mean, window(0, Some(2)), gap));
    let root = tree.node(Node::Compare(Relation::Greater, mean, limit));
    assert_eq!(Robustness::new(&tree, root, Tick(2), Clock::Steps).err(), Some(Invalid::NoMargin));
}
