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
use super::near::Close;
use super::noise::{Draws, word_of};
use super::process;
use super::program::Program;
use super::rest::{back, rest};
use super::speed;
use super::start;
use super::state::{Layout, Slot, State};
use super::vector::{Doubles, Part, Words, parts};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math::exp;
use crate::base::random::TrialKey;
use crate::model::TOP_SPEED;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};

/// Room to work, and what can be kept from one step to the next of one batch. It holds no part of the state, and a fresh
/// one after `refresh` changes no bit.
#[derive(Clone, Debug)]
pub struct Scratch {
    level: Level,
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
        speed::set(simd, program, state, scratch, slots);
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
    let Scratch { lanewise, cells, contacts, sums, seen_x, seen_y, seen, .. } = scratch;
    match state.layout {
        Layout::Trials => lanewise.forces(simd, &program.forces, state, sums, contacts),
        Layout::Agents => cells.forces(simd, &program.forces, state, sums, contacts),
    }
    seen_x.clone_from(&state.motion.x);
    seen_y.clone_from(&state.motion.y);
    *seen = Some((state.keys[0], state.ticks[0]));
}

#[inline(always)]
fn keep_forces<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &Scratch, lanes: Mask) {
    for (block, sum) in scratch.sums.iter().enumerate() {
        for part in parts(simd) {
            let here = part.mask(state.present[block] & lanes);
            let mut force = (part.load(&sum.x), part.load(&sum.y));
            let slowness = part.load(&sum.slowness);
            if program.forces.manners {
                force = composure::followed(part, state, block, force, slowness);
            }
            part.store_in(here, force.0, &mut state.motion.fx[block]);
            part.store_in(here, force.1, &mut state.motion.fy[block]);
            part.store_in(here, slowness, &mut state.driving.slowness[block]);
        }
    }
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
    let mover = Mover {
        program,
        draws: Draws::at(state),
        half: 0.5 * program.dt,
        forgets: exp(-program.dt / speed::FORGETS),
    };
    if scratch.contacts.is_empty() {
        for (block, &moving) in scratch.moving.iter().enumerate() {
            if !moving.is_empty() {
                let words = mover.words(state, block);
                for part in parts(simd) {
                    mover.whole(part, state, block, moving, &words);
                }
            }
        }
        return;
    }
    for (block, &moving) in scratch.moving.iter().enumerate() {
        for part in parts(simd) {
            kick(part, state, block, moving);
        }
    }
    mover.contact(simd, state, scratch);
    for (block, &moving) in scratch.moving.iter().enumerate() {
        let words = mover.words(state, block);
        for part in parts(simd) {
            mover.drift_and_drive(part, state, block, (moving, scratch.moved[block]), &words);
        }
    }
    mover.contact(simd, state, scratch);
    for (block, &moving) in scratch.moving.iter().enumerate() {
        let start = (&scratch.seen_x[block], &scratch.seen_y[block]);
        for part in parts(simd) {
            mover.drift_and_measure(part, state, block, (moving, scratch.moved[block]), start);
        }
    }
}

/// The parts of a step, for one part of one block of slots each.
struct Mover<'a> {
    program: &'a Program,
    draws: Draws,
    /// Half a step, s.
    half: f64,
    /// Share of the noise that is left after a step in the collision-free speed model.
    forgets: f64,
}

impl Mover<'_> {
    /// Counter words of the agents of a block.
    #[inline(always)]
    fn words(&self, state: &State, block: usize) -> [u64; LANES] {
        let words = &self.program.noise.words;
        if !state.queues.reused.is_empty() {
            return self.words_of_later(state, block);
        }
        match state.layout {
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
    fn words_of_later(&self, state: &State, block: usize) -> [u64; LANES] {
        let agents = &self.program.scenario.agents;
        std::array::from_fn(|k| {
            let (agent, lane) = match state.layout {
                Layout::Trials => (block, k),
                Layout::Agents => (block * LANES + k, 0),
            };
            let entity = agents.get(agent).map_or(0, |known| known.entity + state.queues.later(agent, lane));
            u64::from(word_of(entity))
        })
    }

    /// Driving and noise over the whole step.
    #[inline(always)]
    fn driven<S: Simd>(
        &self,
        part: Part<S>,
        state: &State,
        block: usize,
        words: Words<S>,
        place: (Doubles<S>, Doubles<S>),
        (vx, vy): (Doubles<S>, Doubles<S>),
    ) -> (Doubles<S>, Doubles<S>) {
        let (decay, speed) = (part.load(&state.bodies.decay[block]), part.load(&state.driving.speed[block]));
        let mut drive = speed;
        if self.program.forces.ahead.is_some() {
            drive = composure::allowed(part, speed, part.load(&state.driving.slowness[block]));
        }
        let (mut wish_x, mut wish_y) =
            (drive * part.load(&state.driving.ex[block]), drive * part.load(&state.driving.ey[block]));
        // Who moves by themselves (decay 1) has no place to hold.
        let stands = speed.simd_eq(part.c(0.0)) & decay.simd_lt(part.c(1.0));
        if stands.any_true() {
            let (back_x, back_y) = back(part, state, block, place, (vx, vy));
            (wish_x, wish_y) = (stands.select(back_x, wish_x), stands.select(back_y, wish_y));
        }
        let v = (vx, vy);
        let (mut vx, mut vy) = (wish_x + (vx - wish_x) * decay, wish_y + (vy - wish_y) * decay);
        if self.program.forces.speeds.is_some() {
            (vx, vy) = speed::with_noise(part, state, block, (v, (vx, vy)), self.forgets);
        }
        if !self.program.noise.present {
            return (vx, vy);
        }
        let (nx, ny) = self.draws.normals(part, words);
        let mut kick = part.load(&state.bodies.kick[block]);
        if self.program.forces.manners {
            kick *= composure::liveliness(part, state, block, (speed, drive));
        }
        (vx + kick * nx, vy + kick * ny)
    }

    /// All of it for a block without contact.
    #[inline(always)]
    fn whole<S: Simd>(
        &self,
        part: Part<S>,
        state: &mut State,
        block: usize,
        moving: Mask,
        words: &[u64; LANES],
    ) {
        let here = part.mask(moving);
        let half = part.c(self.half);
        let (vx, vy) = kicked(part, state, block);
        let (x0, y0) = (part.load(&state.motion.x[block]), part.load(&state.motion.y[block]));
        let (x, y) = (x0 + vx * half, y0 + vy * half);
        let (vx, vy) = self.driven(part, state, block, part.words(words), (x, y), (vx, vy));
        let (x, y) = (x + vx * half, y + vy * half);
        travel(part, state, block, moving, (x - x0, y - y0));
        part.store_in(here, x, &mut state.motion.x[block]);
        part.store_in(here, y, &mut state.motion.y[block]);
        part.store_in(here, vx, &mut state.motion.vx[block]);
        part.store_in(here, vy, &mut state.motion.vy[block]);
    }

    #[inline(always)]
    fn contact<S: Simd>(&self, simd: S, state: &mut State, scratch: &mut Scratch) {
        let Scratch { contacts, moved, .. } = scratch;
        moved.clear();
        moved.resize(state.motion.x.len(), Mask::NONE);
        simd.vectorize(
            #[inline(always)]
            || contacts.advance(simd, &self.program.forces, state, moved, self.half),
        );
    }

    #[inline(always)]
    fn drift<S: Simd>(&self, part: Part<S>, state: &mut State, block: usize, free: Mask) {
        let (free, half) = (part.mask(free), part.c(self.half));
        let x = part.load(&state.motion.x[block]) + part.load(&state.motion.vx[block]) * half;
        let y = part.load(&state.motion.y[block]) + part.load(&state.motion.vy[block]) * half;
        part.store_in(free, x, &mut state.motion.x[block]);
        part.store_in(free, y, &mut state.motion.y[block]);
    }

    #[inline(always)]
    fn drift_and_drive<S: Simd>(
        &self,
        part: Part<S>,
        state: &mut State,
        block: usize,
        (moving, moved): (Mask, Mask),
        words: &[u64; LANES],
    ) {
        self.drift(part, state, block, moving & !moved);
        let v = (part.load(&state.motion.vx[block]), part.load(&state.motion.vy[block]));
        let place = (part.load(&state.motion.x[block]), part.load(&state.motion.y[block]));
        let (vx, vy) = self.driven(part, state, block, part.words(words), place, v);
        part.store_in(part.mask(moving), vx, &mut state.motion.vx[block]);
        part.store_in(part.mask(moving), vy, &mut state.motion.vy[block]);
    }

    #[inline(always)]
    fn drift_and_measure<S: Simd>(
        &self,
        part: Part<S>,
        state: &mut State,
        block: usize,
        (moving, moved): (Mask, Mask),
        (x0, y0): (&Lanes, &Lanes),
    ) {
        self.drift(part, state, block, moving & !moved);
        let dx = part.load(&state.motion.x[block]) - part.load(x0);
        let dy = part.load(&state.motion.y[block]) - part.load(y0);
        travel(part, state, block, moving, (dx, dy));
    }
}

/// Velocities after half a kick.
#[inline(always)]
fn kicked<S: Simd>(part: Part<S>, state: &State, block: usize) -> (Doubles<S>, Doubles<S>) {
    let push = part.load(&state.bodies.push[block]);
    (
        part.load(&state.motion.vx[block]) + part.load(&state.motion.fx[block]) * push,
        part.load(&state.motion.vy[block]) + part.load(&state.motion.fy[block]) * push,
    )
}

/// Half a kick.
#[inline(always)]
fn kick<S: Simd>(part: Part<S>, state: &mut State, block: usize, moving: Mask) {
    let (vx, vy) = kicked(part, state, block);
    part.store_in(part.mask(moving), vx, &mut state.motion.vx[block]);
    part.store_in(part.mask(moving), vy, &mut state.motion.vy[block]);
}

/// Adds to the ways gone.
#[inline(always)]
fn travel<S: Simd>(
    part: Part<S>,
    state: &mut State,
    block: usize,
    moving: Mask,
    (dx, dy): (Doubles<S>, Doubles<S>),
) {
    let way = part.load(&state.motion.travelled[block]) + (dx * dx + dy * dy).sqrt();
    part.store_in(part.mask(moving), way, &mut state.motion.travelled[block]);
}

/// The slow force at the new positions, half a kick by it, and a look at what came out.
#[inline(always)]
fn finish<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &mut Scratch) {
    find_forces(simd, program, state, scratch);
    let occupied = state.layout.slots_of(state.occupied);
    keep_forces(simd, program, state, scratch, occupied);
    speed::set(simd, program, state, scratch, occupied);
    let mut diverged = Mask::NONE;
    for block in 0..state.motion.x.len() {
        // Someone who has just entered has not made this step.
        let moving = state.present[block] & scratch.moving[block];
        for part in parts(simd) {
            let here = part.mask(moving);
            let (vx, vy) = kicked(part, state, block);
            part.store_in(here, vx, &mut state.motion.vx[block]);
            part.store_in(here, vy, &mut state.motion.vy[block]);
            // Zero times a position is no number where the position is none or infinite.
            let (x, y) = (part.load(&state.motion.x[block]), part.load(&state.motion.y[block]));
            let square = vx * vx + vy * vy + (x + y) * part.c(0.0);
            let sound = square.simd_le(part.c(TOP_SPEED * TOP_SPEED));
            diverged |= part.bits(here & !sound);
        }
    }
    state.diverged |= match state.layout {
        Layout::Trials => diverged,
        Layout::Agents if diverged.is_empty() => Mask::NONE,
        Layout::Agents => Mask::lane(0),
    };
}
