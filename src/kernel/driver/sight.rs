//! Whether a straight line between two places is free of barriers.

use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::kernel::nearby::Nearby;
use crate::model::{Obstacle, Scene};

/// What hides.
#[derive(Clone, Copy, Debug)]
enum Screen {
    Edge(Segment),
    Disc { centre: Vec2, radius: f64 },
}

/// Walls and rims of obstacles of a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    screens: Vec<Screen>,
    nearby: Nearby,
}

impl Sight {
    /// Of a scene.
    pub(super) fn new(scene: &Scene) -> Self {
        let mut screens = Vec::new();
        for barrier in &scene.barriers {
            match &barrier.obstacle {
                Obstacle::Wall(segments) => screens.extend(segments.iter().copied().map(Screen::Edge)),
                Obstacle::Solid(Shape::Polygon(polygon)) => {
                    screens.extend(polygon.segments().map(Screen::Edge));
                }
                Obstacle::Solid(Shape::Circle { centre, radius }) => {
                    screens.push(Screen::Disc { centre: *centre, radius: *radius });
                }
            }
        }
        let bounds: Vec<Bounds> = screens.iter().map(Screen::bounds).collect();
        Self { screens, nearby: Nearby::new(&bounds) }
    }

    /// Whether no barrier touches the line from one place to another.
    pub(super) fn is_free(&self, from: Vec2, to: Vec2) -> bool {
        let line = Segment::new(from, to);
        let mut room = Vec::new();
        let near = self.nearby.find(&around(from, to), &mut room);
        !near.iter().any(|&k| match self.screens[k as usize] {
            Screen::Edge(edge) => line.meets(&edge),
            Screen::Disc { centre, radius } => line.distance(centre) <= radius,
        })
    }
}

fn around(a: Vec2, b: Vec2) -> Bounds {
    Bounds { low: a.inf(&b), high: a.sup(&b) }
}

impl Screen {
    fn bounds(&self) -> Bounds {
        match self {
            Self::Edge(edge) => around(edge.a, edge.b),
            Self::Disc { centre, radius } => {
                let reach = Vec2::repeat(*radius);
                Bounds { low: centre - reach, high: centre + reach }
            }
        }
    }
}
