//! One step of all trials of a batch.
//!
//! Processes come first: they read the state before the step, and so does whoever moves.
//!
//! The equation of motion (Given-Wilson et al. 2017, equation (1)) is split symmetrically (Strang 1968):
//!
//! 1. half a kick by the slow force `F(x_n)`, social forces and attraction, kept in `fx`, `fy`;
//! 2. half a drift: free bodies go straight on, bodies in contact by the flow of `contact`;
//! 3. driving and noise over the whole step, an Ornstein-Uhlenbeck process solved exactly:
//!    v <- v0 e + (v - v0 e) c + s sqrt(1 - c^2) xi with c = exp(-dt/tau), s the stationary standard
//!    deviation, xi two standard normal numbers: relaxation and variance are exact for every dt;
//! 4. half a drift as in 2;
//! 5. the driver looks at the new positions (`drive::steer`);
//! 6. the slow force F(x_{n+1}), and half a kick by it.
//!
//! One evaluation of the slow force and one draw of noise a step, second order in dt. Where a lane has no
//! body near another, 1 to 4 run in one pass; where it has, in several with the same operations, so the
//! path taken changes no bit. Slots that are absent or in a lane without a trial keep their bytes.

use super::cells::Cells;
use super::contact::Contacts;
use super::drive;
use super::lanewise::{Lanewise, Sum};
use super::noise::Draws;
use super::process;
use super::program::Program;
use super::state::{Layout, State};
use super::vector::{bits, load, mask, splat, store_in};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8, u64x8};

/// No human reaches this speed: a trial that does has diverged, m/s.
pub const TOP_SPEED: f64 = 15.0;

/// Room to work, and what can be kept from one step to the next. It holds no part of the state: any
/// scratch does for any batch, and changes no bit.
#[derive(Clone, Debug)]
pub struct Scratch {
    level: Level,
    lanewise: Lanewise,
    cells: Cells,
    contacts: Contacts,
    sums: Vec<Sum>,
    /// Positions at which `contacts` was made.
    seen_x: Vec<Lanes>,
    seen_y: Vec<Lanes>,
    /// Slots that take part in the present step.
    moving: Vec<Mask>,
    /// Slots that contact has moved already.
    moved: Vec<Mask>,
    processes: process::Scratch,
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new()
    }
}

impl Scratch {
    /// For the best vectors that this machine has.
    pub fn new() -> Self {
        Self::at_level(Level::new())
    }

    /// For given vectors. Results have the same bits at every level; this serves tests and measurements.
    pub fn at_level(level: Level) -> Self {
        Self {
            level,
            lanewise: Lanewise::default(),
            cells: Cells::default(),
            contacts: Contacts::default(),
            sums: Vec::new(),
            seen_x: Vec::new(),
            seen_y: Vec::new(),
            moving: Vec::new(),
            moved: Vec::new(),
            processes: process::Scratch::default(),
        }
    }
}

/// Makes freshly loaded lanes ready for their first step: what follows from their parameters, and the
/// forces at their present positions. Other lanes keep their bytes.
pub fn refresh(program: &Program, state: &mut State, scratch: &mut Scratch, lanes: Mask) {
    if state.agents == 0 {
        return;
    }
    let dt = program.dt;
    for block in 0..state.x.len() {
        for lane in slots(state.layout, lanes).iter() {
            let decay = math::exp(-dt / state.tau[block].0[lane]);
            state.decay[block].0[lane] = decay;
            state.kick[block].0[lane] = state.noise[block].0[lane] * (1.0 - decay * decay).sqrt();
            state.push[block].0[lane] = 0.5 * dt / state.mass[block].0[lane];
        }
    }
    scratch.lanewise.forget();
    dispatch!(scratch.level, simd => {
        find_forces(simd, program, state, scratch);
        keep_forces(simd, state, scratch, slots(state.layout, lanes));
    });
}

/// One step of all occupied lanes.
pub fn step(program: &Program, state: &mut State, scratch: &mut Scratch) {
    program.processes.step(program.layout, state, &mut scratch.processes);
    if state.agents == 0 {
        for (lane, tick) in state.ticks.iter_mut().enumerate() {
            *tick += u64::from(state.occupied.has(lane));
        }
        return;
    }
    dispatch!(scratch.level, simd => move_on(simd, program, state, scratch));
    for lane in state.occupied.iter() {
        state.ticks[lane] += 1;
    }
    drive::steer(program, state);
    dispatch!(scratch.level, simd => finish(simd, program, state, scratch));
}

/// The slots of a block that belong to some lanes.
fn slots(layout: Layout, lanes: Mask) -> Mask {
    match layout {
        Layout::Trials => lanes,
        Layout::Agents if lanes.has(0) => Mask::ALL,
        Layout::Agents => Mask::NONE,
    }
}

#[inline(always)]
fn find_forces<S: Simd>(simd: S, program: &Program, state: &State, scratch: &mut Scratch) {
    let Scratch { lanewise, cells, contacts, sums, seen_x, seen_y, .. } = scratch;
    match state.layout {
        Layout::Trials => lanewise.forces(simd, program, state, sums, contacts),
        Layout::Agents => cells.forces(simd, program, state, sums, contacts),
    }
    seen_x.clone_from(&state.x);
    seen_y.clone_from(&state.y);
}

#[inline(always)]
fn keep_forces<S: Simd>(simd: S, state: &mut State, scratch: &Scratch, lanes: Mask) {
    for (block, sum) in scratch.sums.iter().enumerate() {
        let here = mask(simd, state.present[block] & lanes);
        store_in(simd, here, load(simd, &sum.x), &mut state.fx[block]);
        store_in(simd, here, load(simd, &sum.y), &mut state.fy[block]);
    }
}

fn same_bits(a: &[Lanes], b: &[Lanes]) -> bool {
    let bits = |lanes: &Lanes| lanes.0.map(f64::to_bits);
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| bits(a) == bits(b))
}

/// Kick, drift, driving and noise, drift.
#[inline(always)]
fn move_on<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &mut Scratch) {
    if !(same_bits(&scratch.seen_x, &state.x) && same_bits(&scratch.seen_y, &state.y)) {
        // This scratch last saw another batch.
        find_forces(simd, program, state, scratch);
    }
    let occupied = slots(state.layout, state.occupied);
    scratch.moving.clear();
    scratch.moving.extend(state.present.iter().map(|&here| here & occupied));
    let mover = Mover { simd, program, draws: Draws::at(state), half: splat(simd, 0.5 * program.dt) };
    if scratch.contacts.is_empty() {
        for (block, &moving) in scratch.moving.iter().enumerate() {
            if !moving.is_empty() {
                mover.whole(state, block, moving);
            }
        }
        return;
    }
    for (block, &moving) in scratch.moving.iter().enumerate() {
        mover.kick(state, block, moving);
    }
    mover.contact(state, scratch);
    for (block, &moving) in scratch.moving.iter().enumerate() {
        mover.drift_and_drive(state, block, moving, scratch.moved[block]);
    }
    mover.contact(state, scratch);
    for (block, &moving) in scratch.moving.iter().enumerate() {
        let start = (scratch.seen_x[block], scratch.seen_y[block]);
        mover.drift_and_measure(state, block, moving, scratch.moved[block], start);
    }
}

/// The parts of a step, for one block of slots each.
struct Mover<'a, S: Simd> {
    simd: S,
    program: &'a Program,
    draws: Draws,
    half: f64x8<S>,
}

impl<S: Simd> Mover<'_, S> {
    #[inline(always)]
    fn kicked(&self, state: &State, block: usize) -> (f64x8<S>, f64x8<S>) {
        let l = |lanes: &Lanes| load(self.simd, lanes);
        let push = l(&state.push[block]);
        (l(&state.vx[block]) + l(&state.fx[block]) * push, l(&state.vy[block]) + l(&state.fy[block]) * push)
    }

    /// Driving and noise over the whole step.
    #[inline(always)]
    fn driven(&self, state: &State, block: usize, (vx, vy): (f64x8<S>, f64x8<S>)) -> (f64x8<S>, f64x8<S>) {
        let l = |lanes: &Lanes| load(self.simd, lanes);
        let (decay, drive) = (l(&state.decay[block]), l(&state.drive[block]));
        let (wish_x, wish_y) = (drive * l(&state.ex[block]), drive * l(&state.ey[block]));
        let (vx, vy) = (wish_x + (vx - wish_x) * decay, wish_y + (vy - wish_y) * decay);
        if !self.program.forces.noisy {
            return (vx, vy);
        }
        let word = |agent: usize| u64::from(self.program.forces.noise_words.get(agent).copied().unwrap_or(0));
        let words = match state.layout {
            Layout::Trials => u64x8::splat(self.simd, word(block)),
            Layout::Agents => u64x8::from_fn(self.simd, |lane| word(block * LANES + lane)),
        };
        let (nx, ny) = self.draws.normals(self.simd, words);
        let kick = l(&state.kick[block]);
        (vx + kick * nx, vy + kick * ny)
    }

    #[inline(always)]
    fn travel(&self, state: &mut State, block: usize, moving: Mask, dx: f64x8<S>, dy: f64x8<S>) {
        let way = load(self.simd, &state.travelled[block]) + (dx * dx + dy * dy).sqrt();
        store_in(self.simd, mask(self.simd, moving), way, &mut state.travelled[block]);
    }

    /// All of it for a block without contact.
    #[inline(always)]
    fn whole(&self, state: &mut State, block: usize, moving: Mask) {
        let simd = self.simd;
        let here = mask(simd, moving);
        let (vx, vy) = self.kicked(state, block);
        let (x0, y0) = (load(simd, &state.x[block]), load(simd, &state.y[block]));
        let (x, y) = (x0 + vx * self.half, y0 + vy * self.half);
        let (vx, vy) = self.driven(state, block, (vx, vy));
        let (x, y) = (x + vx * self.half, y + vy * self.half);
        self.travel(state, block, moving, x - x0, y - y0);
        store_in(simd, here, x, &mut state.x[block]);
        store_in(simd, here, y, &mut state.y[block]);
        store_in(simd, here, vx, &mut state.vx[block]);
        store_in(simd, here, vy, &mut state.vy[block]);
    }

    #[inline(always)]
    fn kick(&self, state: &mut State, block: usize, moving: Mask) {
        let here = mask(self.simd, moving);
        let (vx, vy) = self.kicked(state, block);
        store_in(self.simd, here, vx, &mut state.vx[block]);
        store_in(self.simd, here, vy, &mut state.vy[block]);
    }

    fn contact(&self, state: &mut State, scratch: &mut Scratch) {
        scratch.moved.clear();
        scratch.moved.resize(state.x.len(), Mask::NONE);
        scratch.contacts.advance(self.program, state, &mut scratch.moved, 0.5 * self.program.dt);
    }

    #[inline(always)]
    fn drift_and_drive(&self, state: &mut State, block: usize, moving: Mask, moved: Mask) {
        let simd = self.simd;
        let free = mask(simd, moving & !moved);
        let here = mask(simd, moving);
        let (vx, vy) = (load(simd, &state.vx[block]), load(simd, &state.vy[block]));
        let (x, y) = (load(simd, &state.x[block]), load(simd, &state.y[block]));
        store_in(simd, free, x + vx * self.half, &mut state.x[block]);
        store_in(simd, free, y + vy * self.half, &mut state.y[block]);
        let (vx, vy) = self.driven(state, block, (vx, vy));
        store_in(simd, here, vx, &mut state.vx[block]);
        store_in(simd, here, vy, &mut state.vy[block]);
    }

    #[inline(always)]
    fn drift_and_measure(
        &self,
        state: &mut State,
        block: usize,
        moving: Mask,
        moved: Mask,
        (x0, y0): (Lanes, Lanes),
    ) {
        let simd = self.simd;
        let free = mask(simd, moving & !moved);
        let (vx, vy) = (load(simd, &state.vx[block]), load(simd, &state.vy[block]));
        let (x, y) = (load(simd, &state.x[block]), load(simd, &state.y[block]));
        store_in(simd, free, x + vx * self.half, &mut state.x[block]);
        store_in(simd, free, y + vy * self.half, &mut state.y[block]);
        let (x, y) = (load(simd, &state.x[block]), load(simd, &state.y[block]));
        self.travel(state, block, moving, x - load(simd, &x0), y - load(simd, &y0));
    }
}

/// The slow force at the new positions, half a kick by it, and a look at what came out.
#[inline(always)]
fn finish<S: Simd>(simd: S, program: &Program, state: &mut State, scratch: &mut Scratch) {
    find_forces(simd, program, state, scratch);
    let occupied = slots(state.layout, state.occupied);
    keep_forces(simd, state, scratch, occupied);
    let top = splat(simd, TOP_SPEED * TOP_SPEED);
    let mut diverged = Mask::NONE;
    for block in 0..state.x.len() {
        // Someone who has just entered has not made this step.
        let moving = state.present[block] & scratch.moving[block];
        let here = mask(simd, moving);
        let push = load(simd, &state.push[block]);
        let vx = load(simd, &state.vx[block]) + load(simd, &state.fx[block]) * push;
        let vy = load(simd, &state.vy[block]) + load(simd, &state.fy[block]) * push;
        store_in(simd, here, vx, &mut state.vx[block]);
        store_in(simd, here, vy, &mut state.vy[block]);
        // The difference of a position to itself is no number where the position is none.
        let (x, y) = (load(simd, &state.x[block]), load(simd, &state.y[block]));
        let sound = (vx * vx + vy * vy + ((x - x) + (y - y))).simd_le(top);
        diverged |= !bits(sound) & moving;
    }
    state.diverged |= match state.layout {
        Layout::Trials => diverged,
        Layout::Agents if diverged.is_empty() => Mask::NONE,
        Layout::Agents => Mask::lane(0),
    };
}
