//! Levels and stairs: whoever crosses the line of a portal goes on at its landing on the other island, as far behind the line
//! and as fast, turned as the portal turns. On stairs the driving speed is that of their table.
//!
//! Nobody is felt across a line, so a landing must have room for the body; else one stands at the line until there is. Two who
//! are in each other's way across one line, and in nobody else's, both pass.

use super::driver;
use super::plan::Occasion;
use super::program::Program;
use super::state::{Slot, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::{Lanes, Mask};
use crate::model::{Parameter, Portal, Scene, Storeys};

/// Whoever is not yet over a line is this far before it, m.
const HAIR: f64 = 1e-6;

/// The levels and stairs of a scene.
#[derive(Clone, Debug, Default)]
pub struct Stairwells {
    storeys: Storeys,
    /// The portals by which each island is left, each with a point of its line and the direction in which it is crossed.
    out: Vec<Vec<(usize, Vec2, Vec2)>>,
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

/// Who may stand where somebody lands.
struct Landings {
    /// Who was near the landing of each portal that is crossed, when the step ended.
    near: Vec<Vec<Slot>>,
    /// Who has crossed a line since.
    newcomers: Vec<Slot>,
}

impl Landings {
    /// Of the crossings of a step.
    fn of(storeys: &Storeys, state: &State, crossings: &[Crossing]) -> Self {
        let mut near = vec![Vec::new(); storeys.portals.len()];
        // The portals that lead to each island, with their landings, and how far from those somebody can be touched there.
        let mut into: Vec<Vec<(usize, Vec2, Vec2, f64)>> = vec![Vec::new(); storeys.islands.len()];
        for one in crossings {
            let reach = one.beyond + one.slot.of(&state.bodies[Parameter::Radius]);
            let Portal { landing, onward, islands, .. } = &storeys.portals[one.portal];
            let known = &mut into[islands[1] as usize];
            match known.iter_mut().find(|known| known.0 == one.portal) {
                Some((.., most)) => *most = if reach > *most { reach } else { *most },
                None => known.push((one.portal, landing.a, *onward, reach)),
            }
        }
        for (block, present) in state.present.iter().enumerate() {
            for lane in present.iter() {
                let slot = Slot { block, lane };
                for &(portal, a, onward, reach) in &into[slot.of(&state.whereabouts.island) as usize] {
                    let behind = (state.position(slot) - a).dot(&onward);
                    if behind < reach + slot.of(&state.bodies[Parameter::Radius]) {
                        near[portal].push(slot);
                    }
                }
            }
        }
        Self { near, newcomers: Vec::new() }
    }
}

/// Whether there is room beyond a line.
#[derive(Clone, Copy)]
enum Room {
    Free,
    /// But for the one of a crossing in the other direction.
    Against(usize),
    Taken,
}

impl Stairwells {
    /// Of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let storeys = scene.storeys.clone();
        let gate = |portal: usize| (portal, storeys.portals[portal].line.a, storeys.portals[portal].across);
        let out =
            (0..storeys.islands.len()).map(|island| storeys.out_of(island).map(gate).collect()).collect();
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
                let to = state.position(slot);
                for &(portal, a, across) in &self.out[island] {
                    if (to - a).dot(&across) <= 0.0 {
                        continue;
                    }
                    let steps = (Vec2::new(x[block].0[lane], y[block].0[lane]), to);
                    let is_flight = self.storeys.islands[island].height.is_none();
                    if let Some((share, beyond)) = crossed(&self.storeys.portals[portal], is_flight, steps) {
                        crossings.push(Crossing { slot, portal, share, beyond });
                        break;
                    }
                }
            }
        }
        if crossings.is_empty() {
            return;
        }
        let mut landings = Landings::of(&self.storeys, state, &crossings);
        let (mut done, mut carried) = (vec![false; crossings.len()], false);
        for k in 0..crossings.len() {
            if done[k] {
                continue;
            }
            let go_on: &[usize] = match self.room(state, &landings, (&crossings, &done), k) {
                Room::Free => &[k],
                Room::Against(other) if self.passes(state, &landings, (&crossings, &done), (k, other)) => {
                    &[k, other]
                }
                Room::Against(_) | Room::Taken => &[],
            };
            if go_on.is_empty() {
                self.hold(state, &crossings[k]);
            }
            done[k] = true;
            for &one in go_on {
                self.carry_on(program, state, &crossings[one]);
                landings.newcomers.push(crossings[one].slot);
                (done[one], carried) = (true, true);
            }
        }
        if carried {
            driver::ask(&program.drive, state);
        }
    }

    /// Puts somebody at the landing.
    fn carry_on(&self, program: &Program, state: &mut State, one: &Crossing) {
        let portal = &self.storeys.portals[one.portal];
        let (at, velocity) = (self.landing(state, one), portal.turned(state.velocity(one.slot)));
        let speed = &mut state.bodies[Parameter::Speed][one.slot.block].0[one.slot.lane];
        *speed /= one.slot.of(&state.whereabouts.share);
        self.put(program, state, one.slot, portal.islands[1] as usize, portal.speed);
        state.whereabouts.slow(&mut state.bodies, one.slot);
        state.driving.move_on(one.slot);
        if program.drive.has_driver(state.layout.agent_of(one.slot)) {
            state.plans.ask(one.slot, Occasion::Storey);
        }
        state.motion.put(one.slot, at, velocity);
    }

    /// Puts somebody back before the line, at rest across it.
    fn hold(&self, state: &mut State, one: &Crossing) {
        let across = self.storeys.portals[one.portal].across;
        let velocity = state.velocity(one.slot);
        let onto = velocity.dot(&across);
        let back = if onto > 0.0 { onto } else { 0.0 };
        let before = state.position(one.slot) - across * (one.beyond + HAIR);
        state.motion.put(one.slot, before, velocity - across * back);
    }

    /// Whether the one in somebody's way is free to pass, but for that one.
    fn passes(
        &self,
        state: &State,
        landings: &Landings,
        crossings: (&[Crossing], &[bool]),
        (one, other): (usize, usize),
    ) -> bool {
        match self.room(state, landings, crossings, other) {
            Room::Free => true,
            Room::Against(there) => there == one,
            Room::Taken => false,
        }
    }

    /// Whether there is room where somebody would go on.
    fn room(
        &self,
        state: &State,
        landings: &Landings,
        (all, done): (&[Crossing], &[bool]),
        k: usize,
    ) -> Room {
        let one = &all[k];
        let (at, radius) = (self.landing(state, one), one.slot.of(&state.bodies[Parameter::Radius]));
        let island = f64::from(self.storeys.portals[one.portal].islands[1]);
        let trial = state.layout.trial_of(one.slot.lane);
        let is_there = |slot: &&Slot| {
            slot.of(&state.whereabouts.island) == island && state.layout.trial_of(slot.lane) == trial
        };
        let mut found = Room::Free;
        for &slot in landings.near[one.portal].iter().chain(&landings.newcomers).filter(is_there) {
            let touch = radius + slot.of(&state.bodies[Parameter::Radius]);
            if (state.position(slot) - at).norm_squared() < touch * touch {
                let back = Storeys::reverse(one.portal);
                let comes = |other: &Crossing| other.slot == slot && other.portal == back;
                let other = all.iter().position(comes).filter(|other| !done[*other]);
                found = match (found, other) {
                    (Room::Free, Some(other)) => Room::Against(other),
                    _ => return Room::Taken,
                };
            }
        }
        found
    }

    /// Where somebody goes on, a radius from the sides of the stairs.
    fn landing(&self, state: &State, one: &Crossing) -> Vec2 {
        let portal = &self.storeys.portals[one.portal];
        let along = portal.landing.b - portal.landing.a;
        let least = (one.slot.of(&state.bodies[Parameter::Radius]) / along.norm()).min(0.5);
        let share = one.share.clamp(least, 1.0 - least);
        portal.landing.a + along * share + portal.onward * one.beyond
    }
}

/// Where and how far somebody has crossed the line of a portal. Beyond the end of a flight there is nothing, so whoever a crush
/// has thrown there has crossed its line.
fn crossed(portal: &Portal, is_flight: bool, (from, to): (Vec2, Vec2)) -> Option<(f64, f64)> {
    let beyond = (to - portal.line.a).dot(&portal.across);
    let before = (from - portal.line.a).dot(&portal.across);
    if beyond <= 0.0 || before > 0.0 && !is_flight {
        return None;
    }
    let at = if before > 0.0 { to } else { from + (to - from) * (before / (before - beyond)) };
    let along = portal.line.b - portal.line.a;
    let share = (at - portal.line.a).dot(&along) / along.norm_squared();
    (is_flight || (0.0..=1.0).contains(&share)).then_some((share, beyond))
}
