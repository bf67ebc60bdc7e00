//! Levels and stairs: whoever crosses the line of a portal goes on at its landing on the other island, as far behind the line
//! and as fast, turned as the portal turns. On stairs the driving speed is that of their table.
//!
//! Nobody is felt across a line, so a landing must have room for the body; else one stands at the line until there is. Two who
//! want to pass each other across one line both may.

use super::driver;
use super::plan::Occasion;
use super::program::Program;
use super::state::{Layout, Slot, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::{Lanes, Mask};
use crate::model::{Parameter, Portal, Scene, Storeys};

/// Whoever is not yet over a line is this far before it, m.
const HAIR: f64 = 1e-6;

/// The levels and stairs of a scene.
#[derive(Clone, Debug, Default)]
pub struct Stairwells {
    storeys: Storeys,
    /// The portals by which each island is left.
    out: Vec<Vec<usize>>,
}

/// Somebody who crosses a line.
struct Crossing {
    slot: Slot,
    portal: usize,
    /// How far from the first end of the line, as a share of it.
    share: f64,
    /// How far behind it, m.
    beyond: f64,
}

impl Stairwells {
    /// Of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let storeys = scene.storeys.clone();
        let out = (0..storeys.islands.len()).map(|island| storeys.out_of(island).collect()).collect();
        Self { storeys, out }
    }

    /// Whether the plane has no levels.
    pub const fn is_empty(&self) -> bool {
        self.out.is_empty()
    }

    /// Notes on which island somebody starts; on stairs with the speed of who goes down.
    #[cold]
    pub(super) fn begin(&self, program: &Program, state: &mut State, slot: Slot, at: Vec2) {
        state.whereabouts.reserve(state.motion.x.len());
        let island = self.storeys.island_at(at);
        let into = self.storeys.portals.iter().rfind(|portal| portal.islands[1] as usize == island);
        self.put(program, state, slot, island, into.map_or(1.0, |portal| portal.speed));
        state.whereabouts.slow(&mut state.bodies, slot);
    }

    /// Puts somebody on an island.
    fn put(&self, program: &Program, state: &mut State, slot: Slot, island: usize, speed: f64) {
        let agent = state.layout.agent_of(slot);
        let is_level = self.storeys.islands[island].height.is_some();
        let own = if is_level { 1.0 } else { program.scenario.agents[agent].body.stairs };
        let origin = self.storeys.islands[island].origin;
        let here = &mut state.whereabouts;
        for (field, value) in [
            (&mut here.island, island as f64),
            (&mut here.origin_x, origin.x),
            (&mut here.origin_y, origin.y),
            (&mut here.share, speed * own),
        ] {
            field[slot.block].0[slot.lane] = value;
        }
    }

    /// Carries those who have crossed a line in a step of the slots `moved`, which began it at `x` and `y`.
    #[cold]
    #[inline(never)]
    pub(super) fn carry(
        &self,
        program: &Program,
        state: &mut State,
        (x, y): (&[Lanes], &[Lanes]),
        moved: &[Mask],
    ) {
        let mut crossings = Vec::new();
        for (block, &moved) in moved.iter().enumerate() {
            for lane in (moved & state.present[block]).iter() {
                let island = state.whereabouts.island[block].0[lane] as usize;
                let slot = Slot { block, lane };
                let steps = (Vec2::new(x[block].0[lane], y[block].0[lane]), state.position(slot));
                for &portal in &self.out[island] {
                    if let Some((share, beyond)) = crossed(&self.storeys.portals[portal], steps) {
                        crossings.push(Crossing { slot, portal, share, beyond });
                        break;
                    }
                }
            }
        }
        let mut carried = false;
        for one in &crossings {
            let portal = &self.storeys.portals[one.portal];
            let radius = one.slot.of(&state.bodies[Parameter::Radius]);
            let at = landing(portal, one, radius);
            let velocity = state.velocity(one.slot);
            let (to, v) = if self.has_room(state, &crossings, one, at, radius) {
                carried = true;
                let speed = &mut state.bodies[Parameter::Speed][one.slot.block].0[one.slot.lane];
                *speed /= one.slot.of(&state.whereabouts.share);
                self.put(program, state, one.slot, portal.islands[1] as usize, portal.speed);
                state.whereabouts.slow(&mut state.bodies, one.slot);
                state.driving.move_on(one.slot);
                if program.drive.has_driver(state.layout.agent_of(one.slot)) {
                    state.plans.ask(one.slot, Occasion::Storey);
                }
                (at, portal.turned(velocity))
            } else {
                let onto = velocity.dot(&portal.across);
                let back = if onto > 0.0 { onto } else { 0.0 };
                let before = state.position(one.slot) - portal.across * (one.beyond + HAIR);
                (before, velocity - portal.across * back)
            };
            let Slot { block, lane } = one.slot;
            let motion = &mut state.motion;
            for (field, value) in
                [(&mut motion.x, to.x), (&mut motion.y, to.y), (&mut motion.vx, v.x), (&mut motion.vy, v.y)]
            {
                field[block].0[lane] = value;
            }
        }
        if carried {
            driver::ask(&program.drive, state);
        }
    }

    /// Whether nobody stands where somebody would go on, but who wants to pass in the other direction.
    fn has_room(&self, state: &State, all: &[Crossing], one: &Crossing, at: Vec2, radius: f64) -> bool {
        let island = f64::from(self.storeys.portals[one.portal].islands[1]);
        let back = Storeys::reverse(one.portal);
        let slots = match state.layout {
            Layout::Trials => Mask::lane(one.slot.lane),
            Layout::Agents => Mask::ALL,
        };
        for (block, there) in state.whereabouts.island.iter().enumerate() {
            let near = there.compare(Lanes::splat(island), |a, b| a == b) & slots & state.present[block];
            for lane in near.iter() {
                let slot = Slot { block, lane };
                let touch = radius + slot.of(&state.bodies[Parameter::Radius]);
                let passes = || {
                    all.iter().any(|other| {
                        (other.slot.block, other.slot.lane) == (block, lane) && other.portal == back
                    })
                };
                if (state.position(slot) - at).norm_squared() < touch * touch && !passes() {
                    return false;
                }
            }
        }
        true
    }
}

/// Where and how far somebody has crossed the line of a portal.
fn crossed(portal: &Portal, (from, to): (Vec2, Vec2)) -> Option<(f64, f64)> {
    let beyond = (to - portal.line.a).dot(&portal.across);
    let before = (from - portal.line.a).dot(&portal.across);
    if beyond <= 0.0 || before > 0.0 {
        return None;
    }
    let at = from + (to - from) * (before / (before - beyond));
    let along = portal.line.b - portal.line.a;
    let share = (at - portal.line.a).dot(&along) / along.norm_squared();
    (0.0..=1.0).contains(&share).then_some((share, beyond))
}

/// Where somebody goes on, a radius from the sides of the stairs.
fn landing(portal: &Portal, one: &Crossing, radius: f64) -> Vec2 {
    let along = portal.landing.b - portal.landing.a;
    let least = (radius / along.norm()).min(0.5);
    let share = one.share.clamp(least, 1.0 - least);
    portal.landing.a + along * share + portal.onward * one.beyond
}
