//! The parts of a step between two evaluations of the slow force, for one part of one block of slots each: kick, drift,
//! driving and noise (`dynamics`, 1 to 4).

use super::composure;
use super::contact::Contacts;
use super::noise::{Draws, word_of};
use super::program::Program;
use super::rest::back;
use super::speed;
use super::state::{Layout, Moves, State, Still};
use super::vector::{Doubles, Part, Words};
use crate::base::lanes::{LANES, Mask};
use crate::base::math::exp;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// All that the slots of a step have in common.
pub(super) struct Mover<'a> {
    program: &'a Program,
    draws: Draws,
    /// Half a step, s.
    half: f64,
    /// Share of the noise that is left after a step in the collision-free speed model.
    forgets: f64,
}

impl<'a> Mover<'a> {
    /// For the step that begins at a state.
    pub(super) fn at(program: &'a Program, state: &State) -> Self {
        let forgets = exp(-program.dt / speed::FORGETS);
        Self { program, draws: Draws::at(state), half: 0.5 * program.dt, forgets }
    }

    /// Counter words of the agents of a block.
    #[inline(always)]
    pub(super) fn words(&self, still: &Still<'_>, block: usize) -> [u64; LANES] {
        let words = &self.program.noise.words;
        if !still.queues.reused.is_empty() {
            return self.words_of_later(still, block);
        }
        match still.layout {
            Layout::Trials => [u64::from(words[block]); LANES],
            Layout::Agents => {
                let own = &words[block * LANES..];
                let mut out = [0; LANES];
                for (out, &word) in out.iter_mut().zip(own) {
                    *out = u64::from(word);
                }
                out
            }
        }
    }

    /// The same where some places of sources are used by later people.
    #[cold]
    fn words_of_later(&self, still: &Still<'_>, block: usize) -> [u64; LANES] {
        let agents = &self.program.scenario.agents;
        std::array::from_fn(|k| {
            let (agent, lane) = match still.layout {
                Layout::Trials => (block, k),
                Layout::Agents => (block * LANES + k, 0),
            };
            let entity = agents.get(agent).map_or(0, |known| known.entity + still.queues.later(agent, lane));
            u64::from(word_of(entity))
        })
    }

    /// Driving and noise over the whole step.
    #[inline(always)]
    fn driven<S: Simd>(
        &self,
        part: Part<S>,
        (still, block): (&Still<'_>, usize),
        slowness: Doubles<S>,
        words: Words<S>,
        place: (Doubles<S>, Doubles<S>),
        (vx, vy): (Doubles<S>, Doubles<S>),
    ) -> (Doubles<S>, Doubles<S>) {
        let (decay, speed) = (part.load(&still.bodies.decay[block]), part.load(&still.driving.speed[block]));
        let mut drive = speed;
        if self.program.forces.ahead.is_some() {
            drive = composure::allowed(part, speed, slowness);
        }
        let (mut wish_x, mut wish_y) =
            (drive * part.load(&still.driving.ex[block]), drive * part.load(&still.driving.ey[block]));
        // Who moves by themselves (decay 1) has no place to hold.
        let stands = speed.simd_eq(part.c(0.0)) & decay.simd_lt(part.c(1.0));
        if stands.any_true() {
            let (back_x, back_y) = back(part, still, block, place, (vx, vy));
            (wish_x, wish_y) = (stands.select(back_x, wish_x), stands.select(back_y, wish_y));
        }
        let v = (vx, vy);
        let (mut vx, mut vy) = (wish_x + (vx - wish_x) * decay, wish_y + (vy - wish_y) * decay);
        if self.program.forces.speeds.is_some() {
            (vx, vy) = speed::with_noise(part, still, block, (v, (vx, vy)), self.forgets);
        }
        if !self.program.noise.present {
            return (vx, vy);
        }
        let (nx, ny) = self.draws.normals(part, words);
        let mut kick = part.load(&still.bodies.kick[block]);
        if self.program.forces.manners {
            kick *= composure::liveliness(part, still, block, (speed, drive));
        }
        (vx + kick * nx, vy + kick * ny)
    }

    /// All of it for a block without contact.
    #[inline(always)]
    pub(super) fn whole<S: Simd>(
        &self,
        part: Part<S>,
        still: &Still<'_>,
        block: usize,
        moves: &mut Moves<'_>,
        (moving, words): (Mask, &[u64; LANES]),
    ) {
        let here = part.mask(moving);
        let half = part.c(self.half);
        let (vx, vy) = kicked(part, still, block, moves);
        let (x0, y0) = (part.load(moves.x), part.load(moves.y));
        let (x, y) = (x0 + vx * half, y0 + vy * half);
        let slowness = part.load(moves.slowness);
        let (vx, vy) = self.driven(part, (still, block), slowness, part.words(words), (x, y), (vx, vy));
        let (x, y) = (x + vx * half, y + vy * half);
        travel(part, moves, moving, (x - x0, y - y0));
        part.store_in(here, x, moves.x);
        part.store_in(here, y, moves.y);
        part.store_in(here, vx, moves.vx);
        part.store_in(here, vy, moves.vy);
    }

    /// Half a drift of all in contact, who are marked in `moved`.
    #[inline(always)]
    pub(super) fn contact<S: Simd>(
        &self,
        simd: S,
        state: &mut State,
        contacts: &mut Contacts,
        moved: &mut Vec<Mask>,
    ) {
        moved.clear();
        moved.resize(state.motion.x.len(), Mask::NONE);
        simd.vectorize(
            #[inline(always)]
            || contacts.advance(simd, &self.program.forces, state, moved, self.half),
        );
    }

    /// Half a drift of who is free.
    #[inline(always)]
    pub(super) fn drift<S: Simd>(&self, part: Part<S>, moves: &mut Moves<'_>, free: Mask) {
        let (free, half) = (part.mask(free), part.c(self.half));
        let x = part.load(moves.x) + part.load(moves.vx) * half;
        let y = part.load(moves.y) + part.load(moves.vy) * half;
        part.store_in(free, x, moves.x);
        part.store_in(free, y, moves.y);
    }

    /// The same, then driving and noise of all who move.
    #[inline(always)]
    pub(super) fn drift_and_drive<S: Simd>(
        &self,
        part: Part<S>,
        still: &Still<'_>,
        block: usize,
        moves: &mut Moves<'_>,
        (moving, free, words): (Mask, Mask, &[u64; LANES]),
    ) {
        self.drift(part, moves, free);
        let v = (part.load(moves.vx), part.load(moves.vy));
        let place = (part.load(moves.x), part.load(moves.y));
        let slowness = part.load(moves.slowness);
        let (vx, vy) = self.driven(part, (still, block), slowness, part.words(words), place, v);
        part.store_in(part.mask(moving), vx, moves.vx);
        part.store_in(part.mask(moving), vy, moves.vy);
    }
}

/// Velocities after half a kick.
#[inline(always)]
pub(super) fn kicked<S: Simd>(
    part: Part<S>,
    still: &Still<'_>,
    block: usize,
    moves: &Moves<'_>,
) -> (Doubles<S>, Doubles<S>) {
    let push = part.load(&still.bodies.push[block]);
    (part.load(moves.vx) + part.load(moves.fx) * push, part.load(moves.vy) + part.load(moves.fy) * push)
}

/// Adds to the ways gone.
#[inline(always)]
pub(super) fn travel<S: Simd>(
    part: Part<S>,
    moves: &mut Moves<'_>,
    moving: Mask,
    (dx, dy): (Doubles<S>, Doubles<S>),
) {
    let way = part.load(moves.travelled) + (dx * dx + dy * dy).sqrt();
    part.store_in(part.mask(moving), way, moves.travelled);
}
