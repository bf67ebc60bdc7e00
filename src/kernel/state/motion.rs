//! The places, velocities and forces of all agents: part of the state. Threads may share them, block by block.

use super::{Bodies, Driving, Layout, Queues, Slot, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::{Lanes, Mask};
use fearless_simd::Simd;

/// Positions, velocities and forces of all slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Position, m.
    pub x: Vec<Lanes>,
    /// Position, second coordinate, m.
    pub y: Vec<Lanes>,
    /// Velocity, m/s.
    pub vx: Vec<Lanes>,
    /// Velocity, second component, m/s.
    pub vy: Vec<Lanes>,
    /// Force of everything but contact at the present positions, N; kept from step to step.
    pub fx: Vec<Lanes>,
    /// Force, second component, N.
    pub fy: Vec<Lanes>,
    /// One over the largest driving speed that the headway to those ahead allows, s/m; 0 where nobody is. Kept with the
    /// forces.
    pub slowness: Vec<Lanes>,
    /// Length of the way gone, m.
    pub travelled: Vec<Lanes>,
}

impl Motion {
    /// Puts somebody at a place, m, with a velocity, m/s.
    pub(in crate::kernel) fn put(&mut self, Slot { block, lane }: Slot, at: Vec2, velocity: Vec2) {
        (self.x[block].0[lane], self.y[block].0[lane]) = (at.x, at.y);
        (self.vx[block].0[lane], self.vy[block].0[lane]) = (velocity.x, velocity.y);
    }

    /// So many blocks at rest in the origin.
    pub(super) fn new(blocks: usize) -> Self {
        let zero = || vec![Lanes::ZERO; blocks];
        Self {
            x: zero(),
            y: zero(),
            vx: zero(),
            vy: zero(),
            fx: zero(),
            fy: zero(),
            slowness: zero(),
            travelled: zero(),
        }
    }

    /// At rest in the origin.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        for field in self.fields() {
            field[slot.block].0[slot.lane] = 0.0;
        }
    }

    fn fields(&mut self) -> [&mut [Lanes]; 8] {
        let Self { x, y, vx, vy, fx, fy, slowness, travelled } = self;
        [x, y, vx, vy, fx, fy, slowness, travelled]
    }
}

/// The parts of a state that hold still while its motion changes.
pub(in crate::kernel) struct Still<'a> {
    pub(in crate::kernel) layout: Layout,
    pub(in crate::kernel) present: &'a [Mask],
    pub(in crate::kernel) bodies: &'a Bodies,
    pub(in crate::kernel) driving: &'a Driving,
    pub(in crate::kernel) queues: &'a Queues,
}

impl State {
    /// Works on each block, on so many threads; the lanes that `work` gives, of all blocks.
    #[inline(always)]
    pub(in crate::kernel) fn each<S: Simd>(
        &mut self,
        simd: S,
        threads: usize,
        work: impl Fn(&Still<'_>, usize, Moves<'_>) -> Mask + Sync,
    ) -> Mask {
        let Self { layout, motion, present, bodies, driving, queues, .. } = self;
        let still = Still { layout: *layout, present, bodies, driving, queues };
        let some = |(first, fields): Blocks<'_>| {
            simd.vectorize(
                #[inline(always)]
                || each((first, fields), &still, &work),
            )
        };
        if threads > 1 { shared(threads, (0, motion.fields()), &some) } else { some((0, motion.fields())) }
    }
}

/// Some blocks of each field, and the number of the first.
type Blocks<'a> = (usize, [&'a mut [Lanes]; 8]);

/// The motion of one block.
pub(in crate::kernel) struct Moves<'a> {
    pub(in crate::kernel) x: &'a mut Lanes,
    pub(in crate::kernel) y: &'a mut Lanes,
    pub(in crate::kernel) vx: &'a mut Lanes,
    pub(in crate::kernel) vy: &'a mut Lanes,
    pub(in crate::kernel) fx: &'a mut Lanes,
    pub(in crate::kernel) fy: &'a mut Lanes,
    pub(in crate::kernel) slowness: &'a mut Lanes,
    pub(in crate::kernel) travelled: &'a mut Lanes,
}

/// Works on some blocks.
#[inline(always)]
fn each(
    (first, fields): Blocks<'_>,
    still: &Still<'_>,
    work: &impl Fn(&Still<'_>, usize, Moves<'_>) -> Mask,
) -> Mask {
    // Of one length, so that one comparison shows that all are long enough.
    let count = fields[0].len();
    let [x, y, vx, vy, fx, fy, slowness, travelled] = fields.map(|field| &mut field[..count]);
    let mut found = Mask::NONE;
    for k in 0..count {
        let moves = Moves {
            x: &mut x[k],
            y: &mut y[k],
            vx: &mut vx[k],
            vy: &mut vy[k],
            fx: &mut fx[k],
            fy: &mut fy[k],
            slowness: &mut slowness[k],
            travelled: &mut travelled[k],
        };
        found |= work(still, first + k, moves);
    }
    found
}

/// Shares blocks among threads. Not generic, as the pool would be compiled for each kind of work.
fn shared(threads: usize, (first, fields): Blocks<'_>, work: &(dyn Fn(Blocks<'_>) -> Mask + Sync)) -> Mask {
    if threads == 1 {
        return work((first, fields));
    }
    let (few, middle) = (threads / 2, fields[0].len() * (threads / 2) / threads);
    let mut rest: [&mut [Lanes]; 8] = Default::default();
    let mut rests = rest.iter_mut();
    let start = fields.map(|field| {
        let (start, end) = field.split_at_mut(middle);
        if let Some(rest) = rests.next() {
            *rest = end;
        }
        start
    });
    let (one, other) = rayon::join(
        || shared(few, (first, start), work),
        || shared(threads - few, (first + middle, rest), work),
    );
    one | other
}
