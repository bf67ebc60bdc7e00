//! Whether the left side of an implication was true, or was left open, somewhere: random left sides against the definition.

use super::random::{Sketch, TestRandom, Trial, settings, trial};
use super::reference::Prefix;
use proptest::prelude::*;
use smc::base::decimal::Decimal;
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::tick::{Clock, Tick};
use smc::logic::{Monitor, Node, NodeId, Tree, Window};

/// An implication below some windows, from the outermost in: `(always, from, to)`, without `to` up to the horizon.
struct Case {
    tree: Tree,
    root: NodeId,
    left: NodeId,
    implication: NodeId,
    /// The states that it is asked about.
    asked: (u64, u64),
    horizon: u64,
}

fn case(left: &Sketch, right: &Sketch, windows: &[(bool, u64, Option<u64>)], horizon: u64) -> Case {
    let mut tree = Tree::default();
    let left = left.node(&mut tree);
    let not = tree.node(Node::Not(left));
    let right = right.node(&mut tree);
    let implication = tree.node(Node::Or(vec![not, right]));
    let mut root = implication;
    for &(always, from, to) in windows.iter().rev() {
        let window = Window { from: Tick(from), to: to.map(|to| Tick(from + to)) };
        let node = if always { Node::Globally(window, root) } else { Node::Finally(window, root) };
        root = tree.node(node);
    }
    let asked = windows
        .iter()
        .fold((0, 0), |(lo, hi), &(_, from, to)| (lo + from, to.map_or(horizon, |to| hi + from + to)));
    Case { tree, root, left, implication, asked, horizon }
}

impl Case {
    /// What the definition says after the state `last`: the left side was not false at some state that was asked about.
    fn expected(&self, trial: &Trial, last: u64) -> bool {
        let prefix = Prefix {
            tree: &self.tree,
            atoms: &trial.atoms,
            signals: &trial.signals,
            seen: last + 1,
            horizon: self.horizon,
            seconds: 0.5,
            known: None,
        };
        // One that is true whatever the states are needs none.
        Prefix { seen: 0, ..prefix }.truth(self.left, 0) == Some(true)
            || (self.asked.0..=self.asked.1.min(last)).any(|at| prefix.truth(self.left, at) != Some(false))
    }

    /// Runs trials through the lanes, some to their verdict and some only for a while.
    fn run(&self, seed: u64) -> Result<(), TestCaseError> {
        let clock = Clock::Stepped(Decimal::parse("0.5").unwrap());
        let made = Monitor::formula(&self.tree, self.root, Tick(self.horizon), clock);
        let Ok(mut monitor) = made else { return Err(TestCaseError::reject("beyond the horizon")) };
        let mut random = TestRandom(seed);
        // The trial of each lane, the last state it was shown, and how many it will be shown at most.
        let mut lanes: Vec<Option<(Trial, Option<u64>, u64)>> = vec![None; LANES];
        for _ in 0..4 * self.horizon + 8 {
            for (k, lane) in lanes.iter_mut().enumerate() {
                let over = lane.as_ref().is_none_or(|(_, last, most)| {
                    monitor.decided().has(k) || last.is_some_and(|last| last + 1 >= *most)
                });
                if over && random.below(3) == 0 {
                    monitor.start(k);
                    let most = 1 + random.below(2 * self.horizon + 2);
                    *lane = Some((trial(&mut random, self.horizon + 1), None, most));
                }
            }
            for lane in lanes.iter().enumerate().filter(|(_, lane)| matches!(lane, Some((_, None, _)))) {
                self.compare(&monitor, lane.0, lane.1.as_ref())?;
            }
            let decided = monitor.decided();
            let mut mask = Mask::NONE;
            for (k, lane) in lanes.iter_mut().enumerate() {
                let Some((_, last, most)) = lane else { continue };
                let next = last.map_or(0, |last| last + 1);
                if !decided.has(k) && next < *most && next <= self.horizon {
                    *last = Some(next);
                    mask |= Mask::lane(k);
                }
            }
            let at = |lane: &Option<(Trial, Option<u64>, u64)>| {
                lane.as_ref().map_or((Trial::default(), 0), |(trial, last, _)| {
                    (trial.clone(), last.unwrap_or(0) as usize)
                })
            };
            let now: Vec<(Trial, usize)> = lanes.iter().map(at).collect();
            let atoms: Vec<Mask> = (0..super::random::ATOMS)
                .map(|a| {
                    let is =
                        |(trial, at): &(Trial, usize)| trial.atoms.get(a).is_some_and(|states| states[*at]);
                    Mask(now.iter().enumerate().fold(0, |m, (k, state)| m | u8::from(is(state)) << k))
                })
                .collect();
            let signals: Vec<Lanes> = (0..super::random::SIGNALS)
                .map(|s| {
                    Lanes(std::array::from_fn(|k| {
                        now[k].0.signals.get(s).map_or(7.0, |states| states[now[k].1])
                    }))
                })
                .collect();
            monitor.observe(mask, &atoms, &signals);
            for (k, lane) in lanes.iter().enumerate() {
                self.compare(&monitor, k, lane.as_ref())?;
            }
        }
        Ok(())
    }

    fn compare(
        &self,
        monitor: &Monitor,
        k: usize,
        lane: Option<&(Trial, Option<u64>, u64)>,
    ) -> Result<(), TestCaseError> {
        let Some((trial, last, _)) = lane else { return Ok(()) };
        let found = monitor.antecedents().find(|one| one.implication == self.implication);
        let found = found.is_some_and(|one| one.triggered.has(k));
        let expected = last.is_some_and(|last| self.expected(trial, last));
        prop_assert_eq!(found, expected, "lane {} after {:?}, asked {:?}", k, last, self.asked);
        Ok(())
    }
}

fn windows(endless: bool) -> BoxedStrategy<Vec<(bool, u64, Option<u64>)>> {
    let to = if endless {
        prop_oneof![(0u64..5).prop_map(Some), Just(None)].boxed()
    } else {
        (0u64..5).prop_map(Some).boxed()
    };
    proptest::collection::vec((any::<bool>(), 0u64..3, to), 0..3).boxed()
}

proptest! {
    #![proptest_config(settings(1000))]

    #[test]
    fn left_sides_with_bounds(
        left in Sketch::formula(2, true, false),
        right in Sketch::formula(2, false, false),
        windows in windows(false),
        seed in any::<u64>(),
        horizon in 6u64..18,
    ) {
        case(&left, &right, &windows, horizon).run(seed)?;
    }

    #[test]
    fn left_sides_up_to_the_horizon(
        left in Sketch::formula(2, true, true),
        right in Sketch::formula(1, false, true),
        windows in windows(true),
        seed in any::<u64>(),
        horizon in 3u64..10,
    ) {
        case(&left, &right, &windows, horizon).run(seed)?;
    }
}
