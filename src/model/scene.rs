//! The scene: what stands still.

use super::agent::Goal;
use super::period::Periods;
use super::storeys::Storeys;
use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Index of a region of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegionId(pub u32);

/// Index of a barrier of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BarrierId(pub u32);

/// Index of a measurement line of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineId(pub u32);

/// The fixed parts of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Along which axes the plane closes on itself.
    pub periods: Periods,
    /// Walls and obstacles.
    pub barriers: Vec<Barrier>,
    /// Regions, which do not block agents.
    pub regions: Vec<Region>,
    /// Named points, m.
    pub points: Vec<(String, Vec2)>,
    /// Measurement lines, which do not block agents.
    pub lines: Vec<Line>,
    /// The lines whose crossings a formula counts: a trial remembers only these.
    pub counted: BTreeSet<LineId>,
    /// The regions in which a formula measures how long somebody has been.
    pub timed: BTreeSet<RegionId>,
    /// The walls that doors are while they are closed, of those that open or close during a trial.
    pub doors: Vec<BarrierId>,
    /// Levels and stairs.
    pub storeys: Storeys,
}

impl Scene {
    /// The regions that a plan shows: those that the scene declares, but for those made of others, which are shown themselves.
    pub fn shown_regions(&self) -> impl Iterator<Item = &Region> {
        let is_made_of_others = |region: &Region| match &region.shape {
            Shape::Parts(parts) => {
                parts.first().is_some_and(|part| self.regions.iter().any(|r| r.shape == *part))
            }
            Shape::Circle { .. } | Shape::Polygon(_) => false,
        };
        self.regions.iter().filter(move |region| region.is_declared() && !is_made_of_others(region))
    }

    /// Whether whoever goes to a goal chooses the quickest of several exits.
    pub fn chooses(&self, goal: &Goal) -> bool {
        match goal {
            Goal::Region(id) => {
                self.regions.get(id.0 as usize).is_some_and(|region| !region.exits.is_empty())
            }
            Goal::Point(_) => false,
        }
    }

    /// The pieces of all walls.
    pub fn walls(&self) -> impl Iterator<Item = &Segment> + Clone {
        self.barriers.iter().flat_map(|barrier| match &barrier.obstacle {
            Obstacle::Wall(pieces) => pieces.as_slice(),
            Obstacle::Solid(_) => &[],
        })
    }

    /// The shapes of all obstacles that are solid.
    pub fn solids(&self) -> impl Iterator<Item = &Shape> + Clone {
        self.barriers.iter().filter_map(|barrier| match &barrier.obstacle {
            Obstacle::Wall(_) => None,
            Obstacle::Solid(shape) => Some(shape),
        })
    }

    /// The same scene where only these doors are closed of those that may change: bit k is the k-th. An open one is a barrier
    /// without pieces.
    pub fn with_closed(&self, closed: u32) -> Cow<'_, Self> {
        let mut out = Cow::Borrowed(self);
        for (_, door) in self.doors.iter().enumerate().filter(|(k, _)| closed >> k & 1 == 0) {
            out.to_mut().barriers[door.0 as usize].obstacle = Obstacle::Wall(Vec::new());
        }
        out
    }

    /// What lies on one island alone; barriers and regions have the numbers of the whole.
    pub fn island(&self, island: usize) -> Self {
        let is_here = |p: Vec2| self.storeys.island_at(p) == island;
        let barrier = |barrier: &Barrier| {
            let obstacle = match &barrier.obstacle {
                Obstacle::Wall(pieces) => {
                    Obstacle::Wall(pieces.iter().filter(|piece| is_here(piece.a)).copied().collect())
                }
                Obstacle::Solid(shape) if is_here(shape.inner_point()) => Obstacle::Solid(shape.clone()),
                Obstacle::Solid(_) => Obstacle::Wall(Vec::new()),
            };
            Barrier { name: barrier.name.clone(), obstacle }
        };
        let region = |region: &Region| {
            let parts = region.shape.parts().iter().filter(|part| is_here(part.inner_point()));
            Region { shape: Shape::Parts(parts.cloned().collect()), ..region.clone() }
        };
        Self {
            barriers: self.barriers.iter().map(barrier).collect(),
            regions: self.regions.iter().map(region).collect(),
            points: self.points.iter().filter(|(_, p)| is_here(*p)).cloned().collect(),
            lines: self.lines.iter().filter(|line| is_here(line.segment.a)).cloned().collect(),
            storeys: Storeys::default(),
            ..self.clone()
        }
    }

    /// The barriers, and behind them their images one period away, all in the same order: what is seen and felt from a place
    /// of the scene.
    pub fn unrolled(&self) -> Cow<'_, [Barrier]> {
        if self.periods.are_none() {
            return Cow::Borrowed(&self.barriers);
        }
        let images = self.periods.images();
        images.iter().flat_map(|way| self.barriers.iter().map(|barrier| barrier.moved(*way))).collect()
    }
}

/// A line at which agents are counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its name.
    pub name: String,
    /// Its ends.
    pub segment: Segment,
}

/// A wall or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Barrier {
    /// Its name, or what an import calls it; may be empty.
    pub name: String,
    /// Its kind.
    pub obstacle: Obstacle,
}

/// The form of a barrier.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// Segments, passable on neither side, without an inside.
    Wall(Vec<Segment>),
    /// A solid disc or polygon, of one part; in the holes of a polygon one can stand.
    Solid(Shape),
}

/// A named part of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name; `nearest(west, east)` of one that only a route names.
    pub name: String,
    /// Its extent.
    pub shape: Shape,
    /// The regions among which whoever goes there chooses the quickest; none where the nearest place of the shape is the goal.
    pub exits: Vec<RegionId>,
}

impl Region {
    /// Of a name, with an extent.
    pub fn new(name: impl Into<String>, shape: Shape) -> Self {
        Self { name: name.into(), shape, exits: Vec::new() }
    }

    /// Its name on a plan: of a room of a floor plan that in the file.
    pub fn label(&self) -> &str {
        let end = self.name.rsplit_once('.').map_or(self.name.as_str(), |(_, end)| end);
        self.name.split_once("[\"").map_or(end, |(_, quoted)| quoted.trim_end_matches("\"]"))
    }

    /// Whether the scene declares it.
    pub fn is_declared(&self) -> bool {
        !self.name.ends_with(')')
    }
}

impl Barrier {
    /// The same somewhere else.
    pub fn moved(&self, way: Vec2) -> Self {
        let obstacle = match &self.obstacle {
            Obstacle::Wall(segments) => {
                Obstacle::Wall(segments.iter().map(|s| Segment::new(s.a + way, s.b + way)).collect())
            }
            Obstacle::Solid(shape) => Obstacle::Solid(shape.moved(way)),
        };
        Self { name: self.name.clone(), obstacle }
    }

    /// Its name in texts: the wall `south`, an obstacle.
    pub fn phrase(&self) -> String {
        let (what, article) = match self.obstacle {
            Obstacle::Wall(_) => ("wall", "a"),
            Obstacle::Solid(_) => ("obstacle", "an"),
        };
        if self.name.is_empty() { format!("{article} {what}") } else { format!("the {what} `{}`", self.name) }
    }
}

impl Obstacle {
    /// The rectangle around it; none without a piece.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Wall(segments) => Bounds::around(segments.iter().flat_map(|s| [s.a, s.b])),
            Self::Solid(shape) => Some(shape.bounds()),
        }
    }

    /// The point of the barrier's surface nearest to `p`.
    pub fn nearest_on_surface(&self, p: Vec2) -> Vec2 {
        match self {
            Self::Wall(segments) => {
                let mut best = (f64::INFINITY, p);
                for segment in segments {
                    let q = segment.nearest(p);
                    let distance = (p - q).norm();
                    if distance < best.0 {
                        best = (distance, q);
                    }
                }
                best.1
            }
            Self::Solid(Shape::Circle { centre, radius }) => {
                let from = p - centre;
                let distance = from.norm();
                if distance > 0.0 {
                    centre + from * (radius / distance)
                } else {
                    centre + Vec2::new(*radius, 0.0)
                }
            }
            Self::Solid(Shape::Polygon(polygon)) => polygon.nearest_on_outline(p),
            Self::Solid(shape @ Shape::Parts(_)) => shape.nearest(p),
        }
    }

    /// Distance from `p` to the barrier's surface; negative inside a solid.
    pub fn distance(&self, p: Vec2) -> f64 {
        match self {
            Self::Wall(segments) => segments.iter().map(|s| s.distance(p)).fold(f64::INFINITY, f64::min),
            Self::Solid(shape) => -shape.depth(p),
        }
    }
}
