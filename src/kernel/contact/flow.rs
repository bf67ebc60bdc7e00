//! The flow of contact alone, in sub-steps of position Verlet.
//!
//! Half a drift, friction, compression, friction, half a drift. Friction is solved exactly pair by pair:
//! over a time t the relative tangential speed of a pair decays by `exp(-k2 g (1/m_i + 1/m_j) t)`, at a
//! wall by exp(-k2 g t/m). It can therefore never reverse a slip, and never adds energy. Pairs are visited
//! in order and then in reverse order, which keeps it symmetric.
//!
//! The overlaps of a sub-step are found in one pass over the pairs, without a branch that hangs on a
//! distance; roots and exponentials follow eight at a time. Impulses are exchanged one by one, since each
//! changes the next: in the turns of `throng`, so that those at work at a time rarely meet.

use super::throng::{Motion, Pair, Throng};
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes};
use crate::base::math;
use crate::kernel::program::Program;
use crate::kernel::vector::{exp, parts};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Frequency of the stiffest contact times the sub-step: 0.5 % of its period at most.
const PHASE: f64 = 0.35;
/// Contacts of one body in a dense packing stiffen each other by about this factor.
const PACKING: f64 = 4.0;
/// More would help nobody: such constants diverge.
const MOST_SUBSTEPS: f64 = 1000.0;

/// Eight overlaps.
#[derive(Clone, Copy, Debug, Default)]
struct Eight {
    a: [u32; LANES],
    /// The other body; means nothing at a wall.
    b: [u32; LANES],
    /// Unit vector towards the first body; of two bodies, until `measure`, the way from the second.
    nx: Lanes,
    ny: Lanes,
    /// How deep they overlap, m; of two bodies, until `measure`, the distance at which they touch.
    gap: Lanes,
    k1: Lanes,
    k2: Lanes,
    /// Sum of the inverse masses, 1/kg.
    inverse: Lanes,
    /// Share of the slip that half a sub-step takes away.
    share: Lanes,
    /// Impulse of compression over a sub-step, kg m/s.
    push: Lanes,
}

/// Overlaps during a sub-step.
#[derive(Clone, Debug, Default)]
struct Overlaps {
    list: Vec<Eight>,
    count: usize,
}

/// Room for the flow of contact.
#[derive(Clone, Debug, Default)]
pub(super) struct Flow {
    pairs: Overlaps,
    walls: Overlaps,
}

impl Flow {
    /// Moves the bodies of the hot clusters of a throng over `h` seconds. (Other bodies of it drift idly.)
    #[inline(always)]
    pub(super) fn run<S: Simd>(&mut self, simd: S, program: &Program, throng: &mut Throng, h: f64) {
        let wanted = (h * (PACKING * throng.stiffest()).sqrt() / PHASE).ceil();
        let count = math::at_most(math::at_least(wanted, 1.0), MOST_SUBSTEPS) as u32;
        let t = h / f64::from(count);
        self.pairs.reserve(throng.hot_pairs.len());
        self.walls.reserve(throng.hot_walls.len());
        drift(throng, 0.5 * t);
        for k in 0..count {
            self.pairs.find(throng);
            self.pairs.measure(simd);
            self.pairs.prepare(simd, t);
            self.walls.find_at_walls(program, throng);
            self.walls.prepare(simd, t);
            let motions = &mut throng.motions[..];
            self.pairs.each(#[inline(always)] |eight, lane| eight.rub(lane, motions));
            self.walls.each(#[inline(always)] |eight, lane| eight.rub_at_wall(lane, motions));
            self.pairs.each(#[inline(always)] |eight, lane| eight.press(lane, motions));
            self.walls.each(#[inline(always)] |eight, lane| eight.press_at_wall(lane, motions));
            self.walls.each_backwards(#[inline(always)] |eight, lane| eight.rub_at_wall(lane, motions));
            self.pairs.each_backwards(#[inline(always)] |eight, lane| eight.rub(lane, motions));
            drift(throng, if k + 1 < count { t } else { 0.5 * t });
        }
    }
}

#[inline(always)]
fn drift(throng: &mut Throng, t: f64) {
    for (x, motion) in throng.x.iter_mut().zip(&throng.motions) {
        *x += motion.v * t;
    }
}

impl Overlaps {
    /// Makes room for so many, and one that is no overlap after each.
    fn reserve(&mut self, count: usize) {
        let blocks = count / LANES + 1;
        if self.list.len() < blocks {
            self.list.resize(blocks, Eight::default());
        }
    }

    /// The pairs that overlap.
    #[inline(always)]
    fn find(&mut self, throng: &Throng) {
        let mut count = 0;
        let x = &throng.x[..];
        for pair in &throng.hot_pairs {
            let &Pair { a, b, touch, k1, k2, inverse, .. } = pair;
            let d = x[a as usize] - x[b as usize];
            let (eight, lane) = (&mut self.list[count / LANES], count % LANES);
            eight.a[lane] = a;
            eight.b[lane] = b;
            eight.nx.0[lane] = d.x;
            eight.ny.0[lane] = d.y;
            eight.gap.0[lane] = touch;
            eight.k1.0[lane] = k1;
            eight.k2.0[lane] = k2;
            eight.inverse.0[lane] = inverse;
            count += usize::from(d.dot(&d) < touch * touch);
        }
        self.count = count;
    }

    /// The bodies that overlap a surface.
    #[inline(always)]
    fn find_at_walls(&mut self, program: &Program, throng: &Throng) {
        self.count = 0;
        for wall in &throng.hot_walls {
            let surface = &program.forces.surfaces[wall.surface as usize];
            let (normal, distance) = surface.nearest_to(throng.x[wall.body as usize]);
            let gap = wall.radius - distance;
            if gap > 0.0 {
                let (eight, lane) = (&mut self.list[self.count / LANES], self.count % LANES);
                eight.a[lane] = wall.body;
                eight.nx.0[lane] = normal.x;
                eight.ny.0[lane] = normal.y;
                eight.gap.0[lane] = gap;
                eight.k1.0[lane] = wall.k1;
                eight.k2.0[lane] = wall.k2;
                eight.inverse.0[lane] = throng.motions[wall.body as usize].inverse;
                self.count += 1;
            }
        }
    }

    /// The blocks in use; some lanes of the last may mean nothing.
    #[inline(always)]
    fn blocks(&mut self) -> &mut [Eight] {
        &mut self.list[..self.count.div_ceil(LANES)]
    }

    /// Makes normals and gaps of ways and touching distances.
    #[inline(always)]
    fn measure<S: Simd>(&mut self, simd: S) {
        for eight in self.blocks() {
            for part in parts(simd) {
                let (dx, dy) = (part.load(&eight.nx), part.load(&eight.ny));
                let distance = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
                part.store(dx / distance, &mut eight.nx);
                part.store(dy / distance, &mut eight.ny);
                part.store(part.load(&eight.gap) - distance, &mut eight.gap);
            }
        }
    }

    /// What friction and compression do in a sub-step of `t` seconds.
    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, t: f64) {
        for eight in self.blocks() {
            for part in parts(simd) {
                let (gap, inverse) = (part.load(&eight.gap), part.load(&eight.inverse));
                let exponent = -part.load(&eight.k2) * gap * inverse * part.c(0.5 * t);
                part.store(part.c(1.0) - exp(part, exponent), &mut eight.share);
                part.store(part.load(&eight.k1) * gap * part.c(t), &mut eight.push);
            }
        }
    }

    /// Calls `f` with each overlap, as a block and a lane, in order.
    #[inline(always)]
    fn each(&self, mut f: impl FnMut(&Eight, usize)) {
        let (whole, rest) = (self.count / LANES, self.count % LANES);
        for eight in &self.list[..whole] {
            for lane in 0..LANES {
                f(eight, lane);
            }
        }
        for lane in 0..rest {
            f(&self.list[whole], lane);
        }
    }

    /// The same in reverse order.
    #[inline(always)]
    fn each_backwards(&self, mut f: impl FnMut(&Eight, usize)) {
        let (whole, rest) = (self.count / LANES, self.count % LANES);
        for lane in (0..rest).rev() {
            f(&self.list[whole], lane);
        }
        for eight in self.list[..whole].iter().rev() {
            for lane in (0..LANES).rev() {
                f(eight, lane);
            }
        }
    }
}

impl Eight {
    #[inline(always)]
    fn normal(&self, lane: usize) -> Vec2 {
        Vec2::new(self.nx.0[lane], self.ny.0[lane])
    }

    #[inline(always)]
    fn tangent(&self, lane: usize) -> Vec2 {
        Vec2::new(-self.ny.0[lane], self.nx.0[lane])
    }

    /// Impulse of friction over half a sub-step, if bodies slide with this relative velocity.
    #[inline(always)]
    fn friction(&self, lane: usize, v: Vec2) -> Vec2 {
        let tangent = self.tangent(lane);
        let slip = v.dot(&tangent);
        tangent * (-slip * self.share.0[lane] / self.inverse.0[lane])
    }

    /// Impulse of compression over a sub-step.
    #[inline(always)]
    fn compression(&self, lane: usize) -> Vec2 {
        self.normal(lane) * self.push.0[lane]
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
