//! Where a person is between two steps.

use super::placed::PlacedStep;
use crate::base::geometry::Vec2;
use crate::gait::{Foot, Stance};

/// A person between two steps of a walk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walker {
    /// Where the root is, m.
    pub at: Vec2,
    /// Direction of the path there, of length 1; `None` for somebody who stands in no particular direction.
    pub heading: Option<Vec2>,
    /// The steps before.
    pub stance: Stance,
    /// The foot that swings next.
    pub foot: Foot,
    /// The number of the next step, from 0. It addresses the draws.
    pub number: u32,
    /// Steps that are already chosen, the next one last.
    pub(super) planned: Vec<(PlacedStep, Stance)>,
}

impl Walker {
    /// A person who stands at a place, with a heading of length 1 or none.
    pub fn standing(at: Vec2, heading: Option<Vec2>) -> Self {
        Self { at, heading, ..Self::default() }
    }

    /// Forgets the steps that were chosen, for example for a new goal.
    pub fn forget_planned(&mut self) {
        self.planned.clear();
    }

    /// Stops the person at a place, for example after a push. The heading stays.
    pub fn stop_at(&mut self, at: Vec2) {
        *self = Self { at, stance: Stance::default(), planned: Vec::new(), ..std::mem::take(self) };
    }

    /// Makes a step.
    pub(super) fn make(&mut self, step: &PlacedStep, after: &Stance) {
        self.at = step.end();
        self.heading = Some(step.end_heading());
        self.stance = *after;
        self.foot = step.foot.other();
        self.number += 1;
    }
}
