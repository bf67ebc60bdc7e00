//! One step of all trials of a batch.
//!
//! Processes and behaviours come first: they read the state before the step, and so does whoever moves. What a
//! behaviour changes holds from the state after the step on.
//!
//! The equation of motion (Given-Wilson et al. 2017, equation (1)) is split symmetrically (Strang 1968):
//!
//! 1. half a kick by the slow force `F(x_n)`, social forces and attraction, kept in `fx`, `fy`;
//! 2. half a drift: free bodies go straight on, bodies in contact by the flow of `contact`;
//! 3. driving and noise over the whole step, an Ornstein-Uhlenbeck process solved exactly:
//!    `v <- v0 e + (v - v0 e) c + s sqrt(1 - c^2) xi` with c = exp(-dt/tau), s the stationary standard
//!    deviation, xi two standard normal numbers: relaxation and variance are exact for every dt;
//! 4. half a drift as in 2;
//! 5. the driver looks at the new positions (`driver::steer`). Where that turns the direction of someone's leg, the
//!    velocity is changed by half of `v0 (1 - c)` times the turn: the step was driven along the mean of both directions
//!    (unless they are more than a right angle apart: then it led past the aim);
//! 6. the slow force `F(x_{n+1})`, and half a kick by it.
//!
//! One evaluation of the slow force and one draw of noise a step, second order in dt. Where a lane has no
//! body near another, 1 to 4 run in one pass; where it has, in several with the same operations, so the
//! path taken changes no bit. Slots that are absent or in a lane without a trial keep their bytes.
//!
//! An agent of the collision-free speed model has neither driving nor force: after 6 it gets the velocity that it has up to
//! the next state (`speed`), so that 2 and 4 are its step of Euler.
//!
//! In 3 v0 is at most what the headway to those ahead allows (`force::ahead`), as it was at the beginning of the step. An
//! agent that stands, and so has no v0, is driven back to where it came to rest (`rest`). Of a push some leave out a part (`composure`).

use super::behaviour;
use super::cells::Cells;
use super::code::Readings;
use super::composure;
use super::contact::Contacts;
use super::driver;
use super::force::pair::Sum;
use super::lanewise::Lanewise;
use super::mover::{Mover, kicked, travel};
use super::near::Close;
use super::process;
use super::program::{LARGE, Program};
use super::rest::rest;
use super::speed;
use super::start;
use super::state::{Layout, Moves, Slot, State, Still};
use super::vector::{Part, Truths, parts};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;
use crate::model::TOP_SPEED;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};

/// Room to work, and what can be kept from one step to the next of one batch. It holds no part of the state, and a fresh
/// one after `refresh` changes no bit.
#[derive(Clone, Debug)]
pub struct Scratch {
    level: Level,
    /// How many threads may share one large crowd.
    threads: usize,
    pub(super) lanewise: Lanewise,
    pub(super) cells: Cells,
    pub(super) contacts: Contacts,
    sums: Vec<Sum>,
    /// As `sums`, of the room ahead in the collision-free speed model.
    pub(super) rooms: Vec<Sum>,
    /// Positions at which `contacts` was made.
    seen_x: Vec<Lanes>,
    seen_y: Vec<Lanes>,
    /// Trial and tick of the first lane then.
    seen: Option<(TrialKey, u64)>,
    /// Slots that take part in the present step.
    moving: Vec<Mask>,
    /// Slots that contact has moved already.
    moved: Vec<Mask>,
    processes: process::Scratch,
    behaviours: behaviour::Scratch,
    doors: Readings,
}

impl Default for Scratch {
    /// For the best vectors that this machine has.
    fn default() -> Self {
        Self::at_level(Level::new())
    }
}

impl Scratch {
    /// For given vectors. Results have the same bits at every level; this serves tests and measurements.
    pub fn at_level(level: Level) -> Self {
        Self {
            level,
            threads: 1,
            lanewise: Lanewise::default(),
            cells: Cells::default(),
            contacts: Contacts::default(),
            sums: Vec::new(),
            rooms: Vec::new(),
            seen_x: Vec::new(),
            seen_y: Vec::new(),
            seen: None,
            moving: Vec::new(),
            moved: Vec::new(),
            processes: process::Scratch::default(),
            behaviours: behaviour::Scratch::default(),
            doors: Readings::default(),
        }
    }

    /// So many threads of the pool of the calling one share a crowd that is large enough. Results have the same bits.
    pub fn share(&mut self, threads: usize) {
        self.threads = threads;
    }

    /// How many of them share a state.
    fn threads_of(&self, state: &State) -> usize {
        if state.layout == Layout::Agents && state.agents > LARGE { self.threads } else { 1 }
    }

    /// Who may touch whom in a state of one large crowd, if that is the one that `refresh` or `step` left, and all places
    /// are numbers.
    pub fn close(&self, state: &State) -> Option<Close<'_>> {
        let same = state.layout == Layout::Agents
            && self.seen == Some((state.keys[0], state.ticks[0]))
            && Lanes::are_same(&self.seen_x, &state.motion.x)
            && Lanes::are_same(&self.seen_y, &state.motion.y);
        if same { self.cells.close(self.contacts.pairs()) } else { None }
    }
}

/// Makes freshly loaded lanes ready for their first step: what follows from their parameters, and the
/// forces at their present positions. Other lanes keep their bytes.
pub fn refresh(program: &Program, state: &mut State, scratch: &mut Scratch, lanes: Mask) {
    program.processes.begin(program.layout, state, &mut scratch.processes, lanes);
    if state.agents == 0 {
        return;
    }
    let dt = program.dt;
    for block in 0..state.motion.x.len() {
        for lane in state.layout.slots_of(lanes).iter() {
            state.prepare(Slot { block, lane }, dt);
            state.forget_noise(Slot { block, lane });
        }
    }
    scratch.lanewise.forget();
    dispatch!(scratch.level, simd => {
        find_forces(simd, program, state, scratch);
        let slots = state.layout.slots_of(lanes);
        keep_forces(simd, program, state, scratch, slots);
        set_speeds(simd, program, state, scratch, slots);
    });
}

/// One step of all occupied lanes.
pub fn step(program: &Program, state: &mut State, scratch: &mut Scratch) {
    program.behaviours.watch(program.layout, state, &mut scratch.behaviours);
    program.doors.watch(program.layout, state, &mut scratch.doors);
    program.processes.step(program.layout, state, &mut scratch.processes);
    if state.agents == 0 {
        state.go_on();
        return;
    }
    dispatch!(scratch.level, simd => move_on(simd, program, state, scratch));
    if !program.forces.periods.are_none() {
        state.wrap(&program.forces.periods, &scratch.moving);
    }
    state.go_on();
    driver::arrive(state, &scratch.moving);
    if program.behaviours.turn((&program.drive, &program.parameters), state, &scratch.behaviours) {
        scratch.lanewise.forget();
    }
    program.doors.turn(&program.drive, state, &scratch.doors);
    driver::steer_at(scratch.level, &program.drive, state);
    if !program.passing.is_empty() {
        let from = (scratch.seen_x.as_slice(), scratch.seen_y.as_slice());
        program.passing.step(scratch.level, state, from, &scratch.moving);
    }
    if !program.stairwells.is_empty() {
        let Scratch { seen_x, seen_y, moving, .. } = scratch;
        program.stairwells.carry(program, state, (seen_x, seen_y), moving);
    }
    // Who comes to a place that is left in this step has not made it.
    for (moving, &here) in scratch.moving.iter_mut().zip(&state.present) {
        *moving &= here;
    }
    // Who comes in has other radii and ranges than who had the place before.
    if start::step(program, state) {
        scratch.lanewise.forget();
    }
    dispatch!(scratch.level, simd => finish(simd, program, state, scratch));
}

/// Continuous time: every occupied lane goes to its next jump, if that comes up to and with a time of each lane, s, and the
/// horizon. Returns the lanes that did; the times are in `state.clocks`. In others nothing more happens.
pub fn jump_until(program: &Program, state: &mut State, scratch: &mut Scratch, until: &[f64; LANES]) -> Mask {
    let last = program.processes.last();
    let until = until.map(|time| if time < last { time } else { last });
    program.processes.jump(program.layout, state, &mut scratch.processes, &until)
}

/// Continuous time: the trial of a lane, in which all has happened that comes up to and with a time, s, goes on from
/// there under another key. Exponential waits begin anew, delays keep what is left of them.
pub fn renew(
    program: &Program,
    state: &mut State,
    scratch: &mut Scratch,
    lane: usize,
    from: (f64, TrialKey),
) {
    program.processes.renew(program.layout, state, &mut scratch.processes, lane, from);
}

#[inline(always)]
fn find_forces<S: Simd>(simd: S, program: &Program, state: &State, scratch: &mut Scratch) {
    let threads = scratch.threads_of(state);
    let Scratch { lanewise, cells, contacts, sums, seen_x, seen_y, seen, .. } = scratch;
    match state.layout {
        Layout::Trials => lanewise.forces(simd, &program.forces, state, sums, contacts),
        Layout::Agents => cells.forces(simd, (&program.forces, threads), state, sums, contacts),
    }
    seen_x.clone_from(&state.motion.x);
    seen_y.clone_from(&state.motion.y);
    *seen = Some((state.keys[0], state.ticks[0]));
}

#[inline(always)]
fn keep_forces<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &Scratch, lanes: Mask) {
    state.each(
        simd,
        1,
        #[inline(always)]
        |still, block, mut moves| {
            for part in parts(simd) {
                let here = part.mask(still.present[block] & lanes);
                keep(part, program, still, block, &mut moves, (here, &scratch.sums[block]));
            }
            Mask::NONE
        },
    );
}

/// Keeps the forces that were found on some slots of a block.
#[inline(always)]
fn keep<S: Simd>(
    part: Part<S>,
    program: &Program,
    still: &Still<'_>,
    block: usize,
    moves: &mut Moves<'_>,
    (here, sum): (Truths<S>, &Sum),
) {
    let mut force = (part.load(&sum.x), part.load(&sum.y));
    let slowness = part.load(&sum.slowness);
    if program.forces.manners {
        force = composure::followed(part, still, block, force, slowness);
    }
    part.store_in(here, force.0, moves.fx);
    part.store_in(here, force.1, moves.fy);
    part.store_in(here, slowness, moves.slowness);
}

/// Kick, drift, driving and noise, drift.
#[inline(always)]
fn move_on<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &mut Scratch) {
    if !(Lanes::are_same(&scratch.seen_x, &state.motion.x)
        && Lanes::are_same(&scratch.seen_y, &state.motion.y))
    {
        // This scratch last saw another batch.
        find_forces(simd, program, state, scratch);
    }
    let occupied = state.layout.slots_of(state.occupied);
    scratch.moving.clear();
    scratch.moving.extend(state.present.iter().map(|&here| here & occupied));
    for (block, &moving) in scratch.moving.iter().enumerate() {
        for part in parts(simd) {
            rest(part, state, block, moving);
        }
    }
    let threads = scratch.threads_of(state);
    let mover = Mover::at(program, state);
    let Scratch { contacts, moving, moved, seen_x, seen_y, .. } = scratch;
    let moving = moving.as_slice();
    if contacts.is_empty() {
        state.each(
            simd,
            threads,
            #[inline(always)]
            |still, block, mut moves| {
                if !moving[block].is_empty() {
                    let words = mover.words(still, block);
                    for part in parts(simd) {
                        mover.whole(part, still, block, &mut moves, (moving[block], &words));
                    }
                }
                Mask::NONE
            },
        );
        return;
    }
    state.each(
        simd,
        threads,
        #[inline(always)]
        |still, block, moves| {
            for part in parts(simd) {
                let here = part.mask(moving[block]);
                let (vx, vy) = kicked(part, still, block, &moves);
                part.store_in(here, vx, moves.vx);
                part.store_in(here, vy, moves.vy);
            }
            Mask::NONE
        },
    );
    mover.contact(simd, state, contacts, moved);
    state.each(
        simd,
        threads,
        #[inline(always)]
        |still, block, mut moves| {
            let words = mover.words(still, block);
            let free = moving[block] & !moved[block];
            for part in parts(simd) {
                mover.drift_and_drive(part, still, block, &mut moves, (moving[block], free, &words));
            }
            Mask::NONE
        },
    );
    mover.contact(simd, state, contacts, moved);
    state.each(
        simd,
        threads,
        #[inline(always)]
        |_, block, mut moves| {
            let free = moving[block] & !moved[block];
            for part in parts(simd) {
                mover.drift(part, &mut moves, free);
                let dx = part.load(moves.x) - part.load(&seen_x[block]);
                let dy = part.load(moves.y) - part.load(&seen_y[block]);
                travel(part, &mut moves, moving[block], (dx, dy));
            }
            Mask::NONE
        },
    );
}

/// Gives the agents in some lanes the velocities that follow from the places and directions of a state, whose sums of turns
/// were kept as its forces.
#[inline(always)]
fn set_speeds<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &mut Scratch, lanes: Mask) {
    if program.forces.speeds.is_none() {
        return;
    }
    for block in 0..state.motion.x.len() {
        for part in parts(simd) {
            speed::turn(part, state, block, lanes);
        }
    }
    let Scratch { lanewise, cells, rooms, contacts, .. } = scratch;
    match state.layout {
        Layout::Trials => lanewise.rooms(simd, &program.forces, state, rooms, contacts),
        Layout::Agents => cells.rooms(simd, &program.forces, state, rooms),
    }
    for block in 0..state.motion.x.len() {
        for part in parts(simd) {
            speed::go(part, state, block, lanes, &rooms[block]);
        }
    }
}

/// The slow force at the new positions, half a kick by it, and a look at the outcome.
#[inline(always)]
fn finish<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &mut Scratch) {
    find_forces(simd, program, state, scratch);
    let occupied = state.layout.slots_of(state.occupied);
    let is_social = program.forces.speeds.is_none();
    if !is_social {
        keep_forces(simd, program, state, scratch, occupied);
        set_speeds(simd, program, state, scratch, occupied);
    }
    let threads = scratch.threads_of(state);
    let diverged = state.each(
        simd,
        threads,
        #[inline(always)]
        |still, block, mut moves| {
            // Someone who has just entered has not made this step.
            let moving = still.present[block] & scratch.moving[block];
            let mut diverged = Mask::NONE;
            for part in parts(simd) {
                if is_social {
                    let here = part.mask(still.present[block] & occupied);
                    keep(part, program, still, block, &mut moves, (here, &scratch.sums[block]));
                }
                let here = part.mask(moving);
                let (vx, vy) = kicked(part, still, block, &moves);
                part.store_in(here, vx, moves.vx);
                part.store_in(here, vy, moves.vy);
                // Zero times a position is no number where the position is none or infinite.
                let (x, y) = (part.load(moves.x), part.load(moves.y));
                let square = vx * vx + vy * vy + (x + y) * part.c(0.0);
                let sound = square.simd_le(part.c(TOP_SPEED * TOP_SPEED));
                diverged |= part.bits(here & !sound);
            }
            diverged
        },
    );
    state.diverged |= match state.layout {
        Layout::Trials => diverged,
        Layout::Agents if diverged.is_empty() => Mask::NONE,
        Layout::Agents => Mask::lane(0),
    };
}
