//! Social forces between the agents of one large crowd.
//!
//! For each strip first the work is listed, without a distance: for each agent the vectors of others behind it
//! in the strip and of those in reach in the next strip. Then the list is worked off, in one loop; no branch hangs on a
//! distance, but for terms that cost more than one (`PairTerm::farthest`). A vector that catches nobody in reach adds zero.

use super::Around;
use super::share::Share;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::force::Forces;
use crate::kernel::force::pair::{Pair, PairTerm, Sum, is_idle};
use crate::kernel::force::walls::Surfaces;
use crate::kernel::near::low_bits;
use crate::kernel::plane::Plane;
use crate::kernel::vector::{first_part, larger, parts, width};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A vector of others that one agent looks at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    /// Place of the agent in its strip.
    one: u32,
    /// Place of the first of the others in the share.
    others: u32,
    /// Logical lane of the first.
    lane: u32,
}

/// Those of a vector who may touch an agent within a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Touch {
    one: u32,
    others: u32,
    lanes: Mask,
}

impl Share {
    /// All forces between agents.
    #[inline(always)]
    pub(super) fn pairs<S: Simd, T: PairTerm, P: Plane>(
        &mut self,
        simd: S,
        around: &Around<'_>,
        of: (T, P),
        (forces, surfaces): (&Forces, &Surfaces),
    ) {
        self.close.clear();
        if let Some(below) = self.strips.start.checked_sub(1) {
            // What those below do to the lowest strip of this share comes first, as if one share held all.
            self.list(simd, around, below, true);
            let from = around.index.strip(below).start - self.first;
            self.work_off(simd, of, (forces, surfaces), (around, from));
        }
        for strip in self.strips.clone() {
            self.list(simd, around, strip, false);
            let from = around.index.strip(strip).start - self.first;
            let found = self.work_off(simd, of, (forces, surfaces), (around, from));
            let agent = &around.index.agent[self.first..];
            for touch in &self.touches[..found] {
                for lane in touch.lanes.iter() {
                    let (a, b) = (agent[touch.one as usize], agent[touch.others as usize + lane]);
                    self.close.push((a.min(b), a.max(b)));
                }
            }
            for (k, sum) in self.own.iter().enumerate() {
                self.fx[from + k] += total(&sum.x);
                self.fy[from + k] += total(&sum.y);
                if T::KEEPS_HEADWAY {
                    let slowness = &mut self.slowness[from + k];
                    *slowness = sum.slowness.0.iter().fold(*slowness, |a, &b| if b > a { b } else { a });
                }
            }
        }
    }

    /// Lists the work of a strip; at its edge alone what its agents have to do with the strip above.
    #[inline(always)]
    fn list<S: Simd>(&mut self, simd: S, around: &Around<'_>, strip: usize, at_edge: bool) {
        let Around { index, images, reach: all, .. } = *around;
        let first = self.first as u32;
        let grid = index.grid;
        let row = grid.row();
        let here = index.strip(strip);
        let own = &index.start[strip * row..(strip + 1) * row];
        let above = index.start.get((strip + 1) * row..(strip + 2) * row);
        self.own.clear();
        self.own.resize(here.len(), Sum::default());
        self.tasks.clear();
        let is_closed = !images.places(index).is_empty();
        let tasks = &mut self.tasks;
        let mut push = |one: usize, from: u32, to: u32| {
            let (one, mut others, to, mut lane) = (one as u32, from - first, to - first, 0);
            // One at least: whether it is empty is harder to foresee than it is to add zero.
            loop {
                tasks.push(Task { one, others, lane });
                others += width::<S>() as u32;
                lane = (lane + width::<S>() as u32) % LANES as u32;
                if others >= to {
                    break;
                }
            }
        };
        for k in here.clone().step_by(LANES) {
            let (mut end, mut left, mut right) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
            for part in parts(simd) {
                let eight = k..k + LANES;
                let (x, y) = (part.slice(&index.x[eight.clone()]), part.slice(&index.y[eight.clone()]));
                let reach = all.of_radius(part, part.slice(&index.r[eight]));
                part.store(grid.column(part, x + reach), &mut end);
                let reach = all.above(part, &grid, strip, y, reach);
                part.store(grid.column(part, x - reach), &mut left);
                part.store(grid.column(part, x + reach), &mut right);
            }
            for lane in 0..LANES.min(here.end - k) {
                let i = k + lane;
                if !at_edge {
                    push(i - here.start, i as u32 + 1, own[low_bits(end.0[lane]) as usize + 1]);
                }
                if let Some(above) = above {
                    let from = above[low_bits(left.0[lane]) as usize];
                    push(i - here.start, from, above[low_bits(right.0[lane]) as usize + 1]);
                }
                if is_closed {
                    let (x, reach) = (index.x[i], all.most);
                    let columns = (grid.column_of(x - reach), grid.column_of(x + reach));
                    for (from, to) in images.near(row, strip, columns) {
                        push(i - here.start, from, to);
                    }
                }
            }
        }
        if self.touches.len() <= self.tasks.len() {
            self.touches.resize(self.tasks.len() + 1, Touch::default());
        }
    }

    /// Works the list off. Gives how many touches were found.
    #[inline(always)]
    fn work_off<S: Simd, T: PairTerm, P: Plane>(
        &mut self,
        simd: S,
        (term, plane): (T, P),
        (forces, surfaces): (&Forces, &Surfaces),
        (&Around { index, walls, reach, .. }, from): (&Around<'_>, usize),
    ) -> usize {
        let part = first_part(simd);
        let (first, length) = (self.first, self.fx.len());
        let mine = first..first + length;
        // Of one length, so that one comparison shows that all are long enough.
        let (xs, ys, rs) = (&index.x[mine.clone()], &index.y[mine.clone()], &index.r[mine]);
        let (fx, fy) = (&mut self.fx[..length], &mut self.fy[..length]);
        let slownesses = self.slowness.as_mut_slice();
        let columns = T::load(
            #[inline(always)]
            |k| &self.columns[k][..length],
        );
        let (minus_margin, reach) = (part.c(-forces.margin), part.c(reach.most));
        let has_screens = walls.has_screens();
        let mut found = 0;
        for task in &self.tasks {
            let (i, j) = (from + task.one as usize, task.others as usize);
            let dx = part.c(xs[i]) - part.slice(&xs[j..j + LANES]);
            let dy = part.c(ys[i]) - part.slice(&ys[j..j + LANES]);
            let touch = part.c(rs[i]) + part.slice(&rs[j..j + LANES]);
            if is_idle(part, term, (dx, dy), touch, forces.margin) {
                continue;
            }
            let mut pair = Pair::new(part, (dx, dy), touch);
            if P::IS_CLOSED {
                // Two may be near each other on two ways: the shortest counts.
                let half = plane.half();
                let detour = dx.abs().simd_gt(part.c(half.0)) | dy.abs().simd_gt(part.c(half.1));
                pair.gap = detour.select(part.c(f64::NEG_INFINITY), pair.gap);
            }
            if T::FINDS_TOUCH {
                let lanes = part.bits(pair.gap.simd_gt(minus_margin));
                self.touches[found] = Touch { one: i as u32, others: j as u32, lanes };
                found += usize::from(!lanes.is_empty());
            }
            if has_screens {
                let screens = walls.screens(first + i);
                if !screens.is_empty() && pair.distance.simd_lt(reach).any_true() {
                    let there = (part.slice(&xs[j..j + LANES]), part.slice(&ys[j..j + LANES]));
                    let hidden = surfaces.hide(screens, part, (part.c(xs[i]), part.c(ys[i])), there);
                    pair.gap = hidden.select(part.c(f64::NEG_INFINITY), pair.gap);
                }
            }
            let one = T::map(
                &columns,
                #[inline(always)]
                |column| part.c(column[i]),
            );
            let others = T::map(
                &columns,
                #[inline(always)]
                |column| part.slice(&column[j..j + LANES]),
            );
            let push = term.push(part, &pair, &one, &others);
            part.take(push.other.0, &mut fx[j..j + LANES]);
            part.take(push.other.1, &mut fy[j..j + LANES]);
            let (sum, lane) = (&mut self.own[task.one as usize], task.lane as usize);
            let (sum_x, sum_y) = (&mut sum.x.0[lane..], &mut sum.y.0[lane..]);
            part.put(part.slice(sum_x) + push.one.0, sum_x);
            part.put(part.slice(sum_y) + push.one.1, sum_y);
            if T::KEEPS_HEADWAY {
                let most = &mut slownesses[j..j + LANES];
                part.put(larger::<S>(push.slowness_of_other, part.slice(most)), most);
                let most = &mut sum.slowness.0[lane..];
                part.put(larger::<S>(push.slowness_of_one, part.slice(most)), most);
            }
        }
        found
    }
}

/// Sum of eight lanes, always in the same order.
#[inline(always)]
fn total(lanes: &Lanes) -> f64 {
    let l = &lanes.0;
    ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]))
}
