//! Hybrid A* over drawn steps (Petereit et al. 2012; Agethen et al. 2018, Algorithm 1). Cells are closed by place, foot and
//! heading, and the heuristic is the length of the way among the barriers.

use super::candidate::{Candidate, Change, HEADING, Pose};
use super::course::Course;
use super::last::Chain;
use super::no_step::NoStep;
use super::placed::{PlacedStep, angle};
use super::task::{HybridAStar, Walk};
use crate::base::frontier::Frontier;
use crate::base::geometry::{Vec2, rotated};
use crate::gait::{Draws, Foot, Stance};
use crate::route::grid::Way;
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Headings that are told apart.
const HEADINGS: f64 = 16.0;

/// The steps of a search have draws from this number on; those of walks before.
const SEARCHED: u32 = 1 << 15;

/// Candidates of the last steps.
const LAST: u32 = 8;

/// In the paper a walk ends within this distance of the goal, m.
const TOLERANCE: f64 = 0.25;

/// A step in the tree.
struct Node {
    step: PlacedStep,
    after: Stance,
    before: Option<u32>,
    /// Length of the chords up to its end, m.
    length: f64,
    number: u32,
}

struct Tree {
    nodes: Vec<Node>,
    /// By the length of the whole walk: what is left of it, in bits, and the node.
    queue: Frontier<(u64, u32)>,
}

impl Tree {
    fn push(&mut self, found: &Candidate, left: f64, before: Option<u32>, number: u32) {
        let start = before.map_or(0.0, |k| self.nodes[k as usize].length);
        let length = start + found.length;
        self.queue.push(length + left, (left.to_bits(), self.nodes.len() as u32));
        self.nodes.push(Node { step: found.step, after: found.after, before, length, number });
    }

    /// The steps up to a node.
    fn chain(&self, last: u32) -> Chain {
        let nodes = std::iter::successors(Some(last), |k| self.nodes[*k as usize].before);
        let mut chain: Chain = nodes.map(|k| &self.nodes[k as usize]).map(|n| (n.step, n.after)).collect();
        chain.reverse();
        chain
    }
}

impl HybridAStar {
    /// Steps to the goal, or past those around whom the walk leads, the first one first. A person who stands begins with
    /// either foot, half of the starters in any direction.
    pub(super) fn steps(
        &self,
        walk: &Walk,
        (pose, way, number): (&Pose, &Way, u32),
    ) -> Result<Chain, NoStep> {
        let mut tree = Tree { nodes: Vec::new(), queue: Frontier::new() };
        let left = |found: &Candidate| {
            if self.is_as_published {
                (found.step.end() - walk.goal).norm()
            } else {
                found.way.length + HEADING * found.turning
            }
        };
        let draws =
            |expansion: u32, k: u32| Draws::of(walk.stream, SEARCHED + expansion, number % 128 * 32 + k % 32);
        let straight = Course::straight();
        let change = |k: u32, way: &Way| {
            let is_plain = self.is_as_published || k.is_multiple_of(2);
            if is_plain {
                Change::Never
            } else {
                Change::Steer {
                    share: f64::from(k) / f64::from(self.successors.max(1)),
                    course: way.is_straight.then_some(&straight),
                }
            }
        };
        let is_standing = pose.stance.last.is_none();
        for k in 0..self.starters.min(32) {
            let mut from = *pose;
            if is_standing && k % 2 == 1 {
                from.foot = pose.foot.other();
            }
            if is_standing && !self.is_as_published && k >= self.starters / 2 {
                let [u, _] = draws(0, k).uniform_pair(Draws::COUNT - 1);
                from.heading = rotated(pose.heading, (2.0 * u - 1.0) * PI);
            }
            for after in walk.drawn(&from, std::iter::once(draws(0, k))) {
                if let Some(found) =
                    walk.candidate(&from, way, after, change(k % self.successors.max(1), way))
                {
                    tree.push(&found, left(&found), None, number);
                }
            }
        }
        let reach = walk.ground.free().reach();
        let beyond = walk.around.iter().map(|other| (other.at - pose.at).norm() + other.radius + reach);
        let beyond = beyond.reduce(f64::max);
        let is_past = |from: &Pose, left: &Way| {
            beyond.is_some_and(|beyond| left.length < way.length && (from.at - pose.at).norm() > beyond)
        };
        let mut closed = BTreeSet::new();
        let mut expansions = 0;
        while let Some((_, (_, at))) = tree.queue.pop() {
            let Node { step, after, number, .. } = &tree.nodes[at as usize];
            let (step, from, next) = (*step, Pose::after(step, *after), number + 1);
            if !closed.insert(self.closing(&from)) || !self.is_clear(walk, &step) {
                continue;
            }
            expansions += 1;
            let Some(way) = walk.way(from.at) else { continue };
            if is_past(&from, &way) {
                return Ok(tree.chain(at));
            }
            if self.is_as_published {
                if (from.at - walk.goal).norm() <= TOLERANCE {
                    return Ok(tree.chain(at));
                }
            } else if let Some(steps) = walk.remaining(&from, &way)
                && let Ok(last) = walk.last_steps((&from, steps, next), LAST, None)
            {
                let mut chain = tree.chain(at);
                chain.extend(last);
                return Ok(chain);
            }
            if expansions >= self.expansions.min(32_000) {
                return Err(NoStep::Limit { expansions });
            }
            let drawn = walk.drawn(&from, (0..self.successors.min(32)).map(|k| draws(expansions, k)));
            for (k, after) in (0..).zip(drawn) {
                if let Some(found) = walk.candidate(&from, &way, after, change(k, &way)) {
                    tree.push(&found, left(&found), Some(at), next);
                }
            }
        }
        Err(NoStep::Exhausted { expansions })
    }

    fn is_clear(&self, walk: &Walk, step: &PlacedStep) -> bool {
        if self.is_as_published { walk.ground.is_end_free(step) } else { walk.is_clear(step) }
    }

    /// What is closed with a pose: cell, foot and heading.
    fn closing(&self, pose: &Pose) -> (i64, i64, bool, u8) {
        let at = pose.at / self.cell;
        let (x, y) = (at.x.floor() as i64, at.y.floor() as i64);
        if self.is_as_published {
            return (x, y, false, 0);
        }
        let share = angle(Vec2::x(), pose.heading) / (2.0 * PI) + 0.5;
        (x, y, pose.foot == Foot::Left, (share * HEADINGS) as u8 % HEADINGS as u8)
    }
}
