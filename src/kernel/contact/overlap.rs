//! Pairs of bodies, or bodies at walls, in blocks of eight: how they overlap, and the impulses they exchange.
//!
//! Roots and exponentials are taken eight at a time. Impulses are exchanged one by one, since each changes
//! the next.

use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes};
use crate::kernel::force::contact::{compression, friction};
use crate::kernel::force::walls::{self, Surfaces};
use crate::kernel::vector::{first_part, parts};
use crate::model::Periods;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// How a body moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) v: Vec2,
    /// One over the mass, 1/kg.
    pub(super) inverse: f64,
}

/// Two bodies that may touch, or one and a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) a: u32,
    /// The other body; at a wall, the face.
    pub(super) b: u32,
    /// Bodies that hang together by pairs that may touch.
    pub(super) cluster: u32,
    /// Distance at which they touch, m.
    pub(super) distance: f64,
    pub(super) k1: f64,
    pub(super) k2: f64,
    /// Sum of the inverse masses, 1/kg.
    pub(super) inverse: f64,
}

/// Eight of them.
#[derive(Clone, Copy, Debug)]
struct Eight {
    a: [u32; LANES],
    b: [u32; LANES],
    distance: Lanes,
    k1: Lanes,
    k2: Lanes,
    inverse: Lanes,
    /// Unit vector towards the first body; of two bodies, until `measure`, the way from the second.
    nx: Lanes,
    ny: Lanes,
    /// How deep they overlap, m.
    gap: Lanes,
    /// Share of the slip that half a sub-step takes away.
    share: Lanes,
    /// Impulse of compression over a sub-step, kg m/s.
    push: Lanes,
}

/// Padding: two that never touch.
const NOBODY: Eight = Eight {
    a: [0; LANES],
    b: [0; LANES],
    distance: Lanes::splat(f64::NEG_INFINITY),
    k1: Lanes::ZERO,
    k2: Lanes::ZERO,
    inverse: Lanes::splat(1.0),
    nx: Lanes::ZERO,
    ny: Lanes::ZERO,
    gap: Lanes::splat(f64::NEG_INFINITY),
    share: Lanes::ZERO,
    push: Lanes::ZERO,
};

/// Pairs in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Touches {
    blocks: Vec<Eight>,
    count: usize,
    /// Those that overlap at present, in order; as many as `found` says.
    overlaps: Vec<u32>,
    found: usize,
    /// Room to work.
    room: walls::Room,
}

impl Touches {
    /// Makes room for `count`, all of them nobody.
    pub(super) fn reset(&mut self, count: usize) {
        self.blocks.clear();
        self.blocks.resize(count.div_ceil(LANES), NOBODY);
        self.count = count;
        self.overlaps.resize(self.blocks.len() * LANES + 1, 0);
        self.found = 0;
    }

    /// Sets the pair at place `k`.
    #[inline(always)]
    pub(super) fn set(&mut self, k: usize, touch: &Touch) {
        let (eight, lane) = (&mut self.blocks[k / LANES], k % LANES);
        eight.a[lane] = touch.a;
        eight.b[lane] = touch.b;
        eight.distance.0[lane] = touch.distance;
        eight.k1.0[lane] = touch.k1;
        eight.k2.0[lane] = touch.k2;
        eight.inverse.0[lane] = touch.inverse;
    }

    /// Finds the pairs of bodies that overlap, and what they do in a sub-step of `t` seconds.
    #[inline(always)]
    pub(super) fn find<S: Simd>(&mut self, simd: S, periods: &Periods, x: &[Vec2], t: f64) {
        self.part(x);
        if !periods.are_none() {
            self.shorten(periods);
        }
        for eight in &mut self.blocks {
            for part in parts(simd) {
                let (dx, dy) = (part.load(&eight.nx), part.load(&eight.ny));
                let distance = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
                part.store(dx / distance, &mut eight.nx);
                part.store(dy / distance, &mut eight.ny);
                part.store(part.load(&eight.distance) - distance, &mut eight.gap);
            }
        }
        self.prepare(simd, t);
    }

    /// The same ways to the nearest images.
    #[cold]
    fn shorten(&mut self, periods: &Periods) {
        for eight in &mut self.blocks {
            for lane in 0..LANES {
                let way = periods.way(Vec2::new(eight.nx.0[lane], eight.ny.0[lane]));
                (eight.nx.0[lane], eight.ny.0[lane]) = (way.x, way.y);
            }
        }
    }

    /// The ways between the bodies of pairs.
    fn part(&mut self, x: &[Vec2]) {
        for eight in &mut self.blocks {
            for lane in 0..LANES {
                let d = x[eight.a[lane] as usize] - x[eight.b[lane] as usize];
                eight.nx.0[lane] = d.x;
                eight.ny.0[lane] = d.y;
            }
        }
    }

    /// Finds the bodies that overlap a face, and what it does in a sub-step of `t` seconds.
    #[inline(always)]
    pub(super) fn find_at_walls<S: Simd>(&mut self, simd: S, surfaces: &Surfaces, x: &[Vec2], t: f64) {
        // The faces of one body stand one after the other.
        let body = |blocks: &[Eight], k: usize| blocks[k / LANES].a[k % LANES];
        let mut first = 0;
        while first < self.count {
            let a = body(&self.blocks, first);
            let same = (first..self.count).take_while(|&k| body(&self.blocks, k) == a).count();
            let blocks = &self.blocks;
            let faces = (first..first + same).map(|k| blocks[k / LANES].b[k % LANES]);
            let radius = blocks[first / LANES].distance.0[first % LANES];
            let pushes = surfaces.touch(first_part(simd), faces, x[a as usize], radius, &mut self.room);
            for (k, push) in (first..).zip(pushes) {
                let (eight, lane) = (&mut self.blocks[k / LANES], k % LANES);
                eight.nx.0[lane] = push.nx.0[0];
                eight.ny.0[lane] = push.ny.0[0];
                eight.gap.0[lane] = push.shared.0[0];
            }
            first += same;
        }
        self.prepare(simd, t);
    }

    /// Lists what overlaps, and works out what friction and compression do in a sub-step of `t` seconds.
    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, t: f64) {
        self.found = 0;
        for (k, eight) in self.blocks.iter_mut().enumerate() {
            let mut any = false;
            for part in parts(simd) {
                let (gap, inverse) = (part.load(&eight.gap), part.load(&eight.inverse));
                if gap.simd_gt(part.c(0.0)).any_true() {
                    any = true;
                    let share = friction(part, part.load(&eight.k2), gap, inverse, 0.5 * t);
                    part.store(share, &mut eight.share);
                    part.store(compression(part, part.load(&eight.k1), gap, t), &mut eight.push);
                }
            }
            if any {
                // Without a branch that hangs on a gap: nobody can foresee those.
                for lane in 0..LANES {
                    self.overlaps[self.found] = (k * LANES + lane) as u32;
                    self.found += usize::from(eight.gap.0[lane] > 0.0);
                }
            }
        }
    }

    #[inline(always)]
    fn overlaps(&self) -> impl DoubleEndedIterator<Item = (&Eight, usize)> {
        let one = |&k: &u32| (&self.blocks[k as usize / LANES], k as usize % LANES);
        self.overlaps[..self.found].iter().map(one)
    }
}

/// Friction over half a sub-step, compression over a sub-step, friction over half a sub-step in reverse order.
// Outside of the code for wide vectors: with those in flight, some processors do single numbers slowly.
#[inline(never)]
pub(super) fn exchange(pairs: &Touches, walls: &Touches, motions: &mut [Motion]) {
    for (eight, lane) in pairs.overlaps() {
        eight.rub(lane, motions);
    }
    for (eight, lane) in walls.overlaps() {
        eight.rub_at_wall(lane, motions);
    }
    for (eight, lane) in pairs.overlaps() {
        eight.press(lane, motions);
    }
    for (eight, lane) in walls.overlaps() {
        eight.press_at_wall(lane, motions);
    }
    for (eight, lane) in walls.overlaps().rev() {
        eight.rub_at_wall(lane, motions);
    }
    for (eight, lane) in pairs.overlaps().rev() {
        eight.rub(lane, motions);
    }
}

impl Eight {
    /// Impulse of friction over half a sub-step, if bodies slide with this relative velocity.
    #[inline(always)]
    fn friction(&self, lane: usize, v: Vec2) -> Vec2 {
        let tangent = Vec2::new(-self.ny.0[lane], self.nx.0[lane]);
        let slip = v.dot(&tangent);
        tangent * (-slip * self.share.0[lane] / self.inverse.0[lane])
    }

    /// Impulse of compression over a sub-step.
    #[inline(always)]
    fn compression(&self, lane: usize) -> Vec2 {
        Vec2::new(self.nx.0[lane], self.ny.0[lane]) * self.push.0[lane]
    }

    #[inline(always)]
    fn rub(&self, lane: usize, motions: &mut [Motion]) {
        let (a, b) = (motions[self.a[lane] as usize], motions[self.b[lane] as usize]);
        let impulse = self.friction(lane, a.v - b.v);
        motions[self.a[lane] as usize].v = a.v + impulse * a.inverse;
        motions[self.b[lane] as usize].v = b.v - impulse * b.inverse;
    }

    #[inline(always)]
    fn rub_at_wall(&self, lane: usize, motions: &mut [Motion]) {
        let a = &mut motions[self.a[lane] as usize];
        a.v += self.friction(lane, a.v) * a.inverse;
    }

    #[inline(always)]
    fn press(&self, lane: usize, motions: &mut [Motion]) {
        let impulse = self.compression(lane);
        let a = &mut motions[self.a[lane] as usize];
        a.v += impulse * a.inverse;
        let b = &mut motions[self.b[lane] as usize];
        b.v -= impulse * b.inverse;
    }

    #[inline(always)]
    fn press_at_wall(&self, lane: usize, motions: &mut [Motion]) {
        let a = &mut motions[self.a[lane] as usize];
        a.v += self.compression(lane) * a.inverse;
    }
}
