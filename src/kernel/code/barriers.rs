//! All barriers of a scene: the distance from the nearest.
//!
//! Among many barriers the grid of `nearby` says which to look at: first those close by, then, if none was found,
//! farther and farther, until nothing that was left out can be nearer. Since the least of several distances is
//! one of them, whatever the order, it has the same bits as in a look at all.

use super::ground::Ground;
use super::lanes::{Vector, widen};
use crate::base::geometry::{Bounds, Vec2};
use crate::base::geometry::{Nearby, amply_around};
use crate::base::lanes::{LANES, Mask};
use crate::model::{Barrier, Scene};
use fearless_simd::{Simd, prelude::*};

/// The barriers of a scene.
#[derive(Clone, Debug)]
pub(super) struct Barriers {
    list: Vec<Ground>,
    /// Which of those with pieces may be near.
    nearby: Nearby,
    /// Which those are.
    with_pieces: Vec<u32>,
    /// The doors that may change; all others are above.
    doors: Vec<Ground>,
}

impl Barriers {
    pub(super) fn new(scene: &Scene) -> Self {
        let ground = |barrier: &Barrier| Ground::barrier(&barrier.obstacle);
        let list: Vec<Ground> = scene.with_closed(0).unrolled().iter().map(ground).collect();
        let doors = scene.doors.iter().map(|door| ground(&scene.barriers[door.0 as usize])).collect();
        let some = list.iter().enumerate().filter_map(|(k, ground)| Some((k as u32, *ground.bounds()?)));
        let (with_pieces, bounds): (Vec<u32>, Vec<Bounds>) = some.unzip();
        Self { nearby: Nearby::new(&bounds), list, with_pieces, doors }
    }

    /// One barrier; images come after all others.
    pub(super) fn at(&self, barrier: u32) -> &Ground {
        &self.list[barrier as usize]
    }

    /// Distance of points from the nearest barrier: negative inside one, infinite without any.
    #[inline(always)]
    pub(super) fn distance<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        let infinite = Vector::splat(x.simd, f64::INFINITY);
        let side = self.nearby.side().filter(|_| (x.abs() + y.abs()).simd_lt(infinite).all_true());
        let found = match side {
            Some(side) => self.search(side, x, y),
            // A position that is no number is at no distance from anything: no square helps.
            None => self.look_at_each(x, y),
        };
        // Which of two zeros comes first may differ; this makes them the same.
        found + 0.0
    }

    /// The same, with the doors that are closed; `closed` gives the lanes of each in which it is.
    #[inline(always)]
    pub(super) fn distance_with_doors<S: Simd>(
        &self,
        (x, y): (Vector<S>, Vector<S>),
        closed: impl Fn(usize) -> Mask,
    ) -> Vector<S> {
        let mut found = self.distance(x, y);
        for (k, door) in self.doors.iter().enumerate() {
            found = widen(x.simd, closed(k)).select(door.nearer(found, x, y), found);
        }
        found
    }

    #[inline(always)]
    fn look_at_each<S: Simd>(&self, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        let mut best = Vector::splat(x.simd, f64::INFINITY);
        for barrier in &self.list {
            best = barrier.nearer(best, x, y);
        }
        best
    }

    /// The same by squares with sides of `side`, for finite positions.
    #[inline(always)]
    fn search<S: Simd>(&self, side: f64, x: Vector<S>, y: Vector<S>) -> Vector<S> {
        let mut best = Vector::splat(x.simd, f64::INFINITY);
        let mut room = Vec::new();
        for lane in 0..LANES {
            if lane > 0 && x[lane] == x[lane - 1] && y[lane] == y[lane - 1] {
                continue;
            }
            let p = Vec2::new(x[lane], y[lane]);
            let mut reach = side;
            loop {
                // What other lanes have found may be near here too.
                let found = best[lane];
                reach = if found < f64::INFINITY { if found > 0.0 { found } else { 0.0 } } else { reach };
                let around = amply_around(p, reach);
                for &k in self.nearby.find(&around, &mut room) {
                    best = self.list[self.with_pieces[k as usize] as usize].nearer(best, x, y);
                }
                // What is outside of the square is farther than its reach.
                if best[lane] <= reach || self.nearby.is_within(&around) {
                    break;
                }
                reach *= 2.0;
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::geometry::{Polygon, Segment, Shape};
    use crate::base::lanes::Lanes;
    use crate::model::{Barrier, Obstacle};
    use fearless_simd::{Level, dispatch};

    #[inline(always)]
    fn eight<S: Simd>(simd: S, barriers: &Barriers, x: &Lanes, y: &Lanes, plain: bool) -> [u64; LANES] {
        let (x, y) = (Vector::from_slice(simd, &x.0), Vector::from_slice(simd, &y.0));
        let found = if plain { barriers.look_at_each(x, y) + 0.0 } else { barriers.distance(x, y) };
        std::array::from_fn(|lane| found[lane].to_bits())
    }

    fn scene(count: u32) -> Scene {
        let obstacle = |k: u32| {
            let at = Vec2::new(f64::from(k * 7919 % 997) * 0.3 - 20.0, f64::from(k * 104_729 % 1009) * 0.2);
            let size = 0.2 + f64::from(k % 13) * 0.3;
            match k % 4 {
                0 => Obstacle::Wall(vec![Segment::new(at, at + Vec2::new(size, -size))]),
                1 => Obstacle::Solid(Shape::Circle { centre: at, radius: 0.5 * size }),
                2 => Obstacle::Solid(Shape::Polygon(Polygon::rectangle(at, at + Vec2::new(size, 2.0)))),
                _ => Obstacle::Wall(Vec::new()),
            }
        };
        let barrier = |k| Barrier { name: String::new(), obstacle: obstacle(k) };
        Scene { barriers: (0..count).map(barrier).collect(), regions: Vec::new(), ..Scene::default() }
    }

    #[test]
    fn the_nearest_by_squares_has_the_bits_of_a_look_at_each() {
        for count in [0, 5, 40, 1_500] {
            let barriers = Barriers::new(&scene(count));
            assert_eq!(barriers.nearby.side().is_some(), count > 30);
            for k in 0..400 {
                // Near each other, far apart, far outside, in the same place, and nowhere.
                let wide = [0.3, 60.0, 4_000.0, 0.0][k % 4];
                let (mut x, mut y) = (Lanes::ZERO, Lanes::ZERO);
                for lane in 0..LANES {
                    x.0[lane] = k as f64 * 0.61 + wide * f64::from((lane as u32 * 5 + 3) % 8) * 0.25;
                    y.0[lane] = k as f64 * 0.37 - wide * f64::from((lane as u32 * 3 + 1) % 8) * 0.25;
                }
                if k % 50 == 7 {
                    x.0[k % 8] = [f64::NAN, f64::INFINITY][k / 50 % 2];
                }
                let found = dispatch!(Level::new(), simd => eight(simd, &barriers, &x, &y, false));
                let wanted = dispatch!(Level::new(), simd => eight(simd, &barriers, &x, &y, true));
                assert_eq!(found, wanted, "{count} barriers, {x:?} {y:?}");
            }
        }
    }
}
