//! Voronoi density (Steffen and Seyfried 2010), as in `PedPy`: everyone has the part of the plane that is nearer to them than to
//! anybody else, at most up to 1 m away (a polygon of 12 sides), cut where a barrier separates it from them. A person adds
//! the share of this cell that lies in the region; the sum is divided by the area of the region.

use crate::base::geometry::convex::{Convex, UNNAMED};
use crate::base::geometry::{Segment, Shape, Vec2, clearing};
use crate::kernel::state::{Slot, State};
use crate::model::{Piece, Scene, Sight};

/// How far a cell extends, m.
const REACH: f64 = 1.0;
/// Sides of a cell that nothing cuts; the same for a round obstacle.
const SIDES: u32 = 12;
const ROUND_SIDES: u32 = 32;

/// The cells of people in a scene: what is the same in every state.
#[derive(Debug)]
pub struct Voronoi {
    free: Convex,
    round: Convex,
    sight: Sight,
    regions: Vec<Shape>,
    /// How far images are.
    ways: Vec<Vec2>,
}

/// Somebody near the region.
#[derive(Clone, Copy)]
struct Near {
    at: Vec2,
    /// Whether their cell may reach the region.
    reaches: bool,
}

impl Voronoi {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            free: Convex::regular(SIDES, REACH),
            round: Convex::regular(ROUND_SIDES, 1.0),
            sight: Sight::new(scene),
            regions: scene.regions.iter().map(|region| region.shape.clone()).collect(),
            ways: scene.periods.images(),
        }
    }

    /// The density of a region, 1/m², in the trial of a lane.
    pub(super) fn read(&self, region: u32, state: &State, lane: usize) -> f64 {
        let here = (0..state.agents).filter_map(|agent| {
            let Slot { block, lane } = state.slot(agent, lane);
            let at = || Vec2::new(state.motion.x[block].0[lane], state.motion.y[block].0[lane]);
            state.present[block].has(lane).then(at)
        });
        let images = here.flat_map(|at| self.ways.iter().map(move |way| at + way));
        self.density(&self.regions[region as usize], images)
    }

    /// The density of a region, 1/m², of people at some places.
    fn density(&self, region: &Shape, people: impl Iterator<Item = Vec2>) -> f64 {
        let bounds = region.bounds();
        let distance = |p: Vec2| {
            let beyond = (bounds.low - p).sup(&(p - bounds.high));
            beyond.x.max(beyond.y)
        };
        // A cell that reaches the region is cut by people up to twice its reach away.
        let near = |at: Vec2| Near { at, reaches: distance(at) < REACH };
        let mut all: Vec<Near> = people.filter(|p| distance(*p) < 3.0 * REACH).map(near).collect();
        all.sort_by(|a, b| a.at.x.total_cmp(&b.at.x));
        let mut sum = 0.0;
        self.each(&all, |_, one, cell| sum += self.share(cell, region, one.at));
        sum / region.area()
    }

    /// The areas of the cells of some people, m², in their order.
    pub fn areas(&self, people: &[Vec2]) -> Vec<f64> {
        let all = self.ways.iter().flat_map(|way| people.iter().map(move |at| at + way));
        let all: Vec<Vec2> = all.collect();
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| all[a].x.total_cmp(&all[b].x));
        // The people themselves come before their images.
        let near = |k: &usize| Near { at: all[*k], reaches: *k < people.len() };
        let all: Vec<Near> = order.iter().map(near).collect();
        let mut areas = vec![0.0; people.len()];
        self.each(&all, |k, one, cell| {
            let barriers = self.barriers(one.at);
            areas[order[k]] = if barriers.is_empty() {
                cell.area()
            } else {
                clearing(cell, &barriers).iter().map(Convex::area).sum()
            };
        });
        areas
    }

    /// Hands out the cells of those who reach the region, among people by ascending x.
    fn each(&self, all: &[Near], mut take: impl FnMut(usize, &Near, &Convex)) {
        let (mut cell, mut others) = (Convex::default(), Vec::new());
        for (k, one) in all.iter().enumerate().filter(|(_, one)| one.reaches) {
            let (before, after) = (all[..k].iter().rev(), all[k + 1..].iter());
            let is_close = |other: &&Near| (other.at.x - one.at.x).abs() < 2.0 * REACH;
            let ways = before.take_while(is_close).chain(after.take_while(is_close));
            others.clear();
            others.extend(ways.map(|other| other.at - one.at).map(|way| (way.norm_squared(), way)));
            self.cell(&mut cell, &mut others);
            take(k, one, &cell);
        }
    }

    /// The cell of somebody at the origin, among others with their squared distances.
    fn cell(&self, cell: &mut Convex, others: &mut Vec<(f64, Vec2)>) {
        // Two at the same place share one cell.
        others.retain(|(square, _)| *square > 0.0 && *square < 4.0 * REACH * REACH);
        others.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        cell.copy(&self.free);
        let mut farthest = REACH * REACH;
        for (square, way) in others.iter() {
            if *square >= 4.0 * farthest {
                break;
            }
            if cell.cut(*way, 0.5 * square, UNNAMED) {
                farthest = cell.corners().map(|p| p.norm_squared()).fold(0.0, f64::max);
            }
        }
    }

    /// The share of a cell around `at` that lies in a region.
    fn share(&self, cell: &Convex, region: &Shape, at: Vec2) -> f64 {
        let barriers = self.barriers(at);
        if barriers.is_empty() {
            return cell.shared_area(region, at) / cell.area();
        }
        let parts = clearing(cell, &barriers);
        let area: f64 = parts.iter().map(Convex::area).sum();
        if area > 0.0 {
            parts.iter().map(|part| part.shared_area(region, at)).sum::<f64>() / area
        } else {
            0.0
        }
    }

    /// The barriers near a place, seen from there.
    fn barriers(&self, at: Vec2) -> Vec<Segment> {
        let mut out = Vec::new();
        for piece in self.sight.near(at, REACH) {
            match piece {
                Piece::Edge(edge) => out.push(Segment::new(edge.a - at, edge.b - at)),
                Piece::Disc { centre, radius } => out.extend(self.round.edges().map(|(side, _)| {
                    Segment::new(centre - at + side.a * radius, centre - at + side.b * radius)
                })),
            }
        }
        out.retain(|wall| wall.a != wall.b && wall.distance(Vec2::zeros()) < REACH);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Barrier, Obstacle};
    use proptest::prelude::*;

    fn density(scene: &Scene, region: &Shape, people: &[(f64, f64)]) -> f64 {
        Voronoi::new(scene).density(region, people.iter().map(|&(x, y)| Vec2::new(x, y)))
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn a_lattice_has_one_person_in_the_area_of_a_square() {
        for side in [0.35, 0.5, 0.8] {
            let row = |j: i32| (-20..20).map(move |i| (f64::from(i) * side, f64::from(j) * side));
            let people: Vec<_> = (-20..20).flat_map(row).collect();
            for region in [
                Shape::rectangle(Vec2::new(-1.0, -0.7), Vec2::new(1.3, 2.1)),
                Shape::Circle { centre: Vec2::new(0.1, 0.3), radius: 1.5 },
            ] {
                let found = density(&Scene::default(), &region, &people);
                assert!((found - 1.0 / (side * side)).abs() < 1e-9, "{found}");
            }
        }
    }

    #[test]
    fn somebody_alone_has_a_polygon_of_twelve_sides() {
        let region = Shape::rectangle(Vec2::new(0.0, -5.0), Vec2::new(4.0, 5.0));
        // All of it, half of it, none of it; and two at one place.
        assert!(near(density(&Scene::default(), &region, &[(2.0, 0.0)]), 1.0 / 40.0));
        assert!(near(density(&Scene::default(), &region, &[(0.0, 0.0)]), 0.5 / 40.0));
        assert!(near(density(&Scene::default(), &region, &[(-1.0, 0.0)]), 0.0));
        assert!(near(density(&Scene::default(), &region, &[(2.0, 0.0), (2.0, 0.0)]), 2.0 / 40.0));
        assert!(near(density(&Scene::default(), &region, &[]), 0.0));
    }

    proptest! {
        /// In a room that everybody's polygon fills, all cells together are the room.
        #[test]
        fn cells_fill_a_room(places in prop::collection::vec((0.01..0.79, 0.01..0.49), 1..12)) {
            let corners = [(0.0, 0.0), (0.8, 0.0), (0.8, 0.5), (0.0, 0.5)].map(|(x, y)| Vec2::new(x, y));
            let walls = (0..4).map(|k| Segment::new(corners[k], corners[(k + 1) % 4])).collect();
            let barriers = vec![Barrier { name: String::new(), obstacle: Obstacle::Wall(walls) }];
            let voronoi = Voronoi::new(&Scene { barriers, ..Scene::default() });
            let places: Vec<Vec2> = places.into_iter().map(|(x, y)| Vec2::new(x, y)).collect();
            let area: f64 = voronoi.areas(&places).iter().sum();
            prop_assert!((area - 0.4).abs() < 1e-9, "{area}");
        }
    }

    #[test]
    fn a_wall_cuts_cells() {
        // Half of each cell lies in the region. With a wall at the edge of the region all of one does, and none of the other.
        let wall = Segment::new(Vec2::new(0.0, -9.0), Vec2::new(0.0, 9.0));
        let barriers = vec![Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![wall]) }];
        let walled = Scene { barriers, ..Scene::default() };
        let region = Shape::rectangle(Vec2::new(0.0, -5.0), Vec2::new(2.0, 5.0));
        let one = density(&Scene::default(), &region, &[(0.5, 0.0)]);
        assert!(one > 0.01 && one < 0.05 - 0.001);
        assert!(near(density(&walled, &region, &[(0.5, 0.0)]), 0.05));
        assert!(near(density(&walled, &region, &[(-0.5, 0.0)]), 0.0));
    }
}
