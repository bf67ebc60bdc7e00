//! Distance between two things that both stand still and have an extent.

use crate::base::geometry::{Segment, Shape};
use crate::model::{Obstacle, Place, Scene};

/// A thing as what it is made of.
struct Extent {
    /// Corners and edges; of a disc: its centre.
    edges: Vec<Segment>,
    /// What is added all around: the radius of a disc.
    radius: f64,
    /// Its inside.
    solid: Option<Shape>,
}

/// The parts of a region or a barrier.
fn extents(scene: &Scene, place: &Place) -> Option<Vec<Extent>> {
    let of_shape = |shape: &Shape| match shape {
        Shape::Circle { centre, radius } => Extent {
            edges: vec![Segment::new(*centre, *centre)],
            radius: *radius,
            solid: Some(shape.clone()),
        },
        Shape::Polygon(polygon) => {
            Extent { edges: polygon.segments().collect(), radius: 0.0, solid: Some(shape.clone()) }
        }
        Shape::Parts(_) => Extent { edges: Vec::new(), radius: 0.0, solid: None },
    };
    let of_parts = |shape: &Shape| shape.parts().iter().map(of_shape).collect();
    match place {
        Place::Region(id) => scene.regions.get(id.0 as usize).map(|region| of_parts(&region.shape)),
        Place::Barrier(id) => scene.barriers.get(id.0 as usize).map(|barrier| match &barrier.obstacle {
            Obstacle::Wall(segments) => {
                vec![Extent { edges: segments.clone(), radius: 0.0, solid: None }]
            }
            Obstacle::Solid(shape) => of_parts(shape),
        }),
        Place::Agent(_) | Place::Point(..) | Place::Centroid(_) => None,
    }
}

fn apart(a: &Segment, b: &Segment) -> f64 {
    if a.meets(b) {
        return 0.0;
    }
    let ends = [b.distance(a.a), b.distance(a.b), a.distance(b.a), a.distance(b.b)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// Distance between two regions or barriers of a scene: 0 where they meet, NaN where one is neither.
pub(super) fn between(scene: &Scene, a: &Place, b: &Place) -> f64 {
    let (Some(a), Some(b)) = (extents(scene, a), extents(scene, b)) else { return f64::NAN };
    let pairs = a.iter().flat_map(|one| b.iter().map(move |other| between_parts(one, other)));
    pairs.fold(f64::INFINITY, f64::min)
}

fn between_parts(a: &Extent, b: &Extent) -> f64 {
    let within = |shape: &Option<Shape>, edges: &[Segment]| {
        shape.as_ref().is_some_and(|shape| edges.iter().any(|s| shape.contains(s.a)))
    };
    if within(&a.solid, &b.edges) || within(&b.solid, &a.edges) {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for p in &a.edges {
        for q in &b.edges {
            least = least.min(apart(p, q));
        }
    }
    (least - a.radius - b.radius).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::geometry::Vec2;
    use crate::model::{Barrier, BarrierId, Region, RegionId};

    #[test]
    fn things_apart_touching_and_inside_one_another() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let region = |shape| Region::new("", shape);
        let barrier = |obstacle| Barrier { name: String::new(), obstacle };
        let scene = Scene {
            regions: vec![
                region(Shape::rectangle(p(0., 0.), p(2., 2.))),
                region(Shape::Circle { centre: p(5., 1.), radius: 1.0 }),
                region(Shape::rectangle(p(0.5, 0.5), p(1., 1.))),
            ],
            barriers: vec![barrier(Obstacle::Wall(vec![Segment::new(p(-1., 4.), p(9., 4.))]))],
            ..Scene::default()
        };
        let (r, b) = (|k| Place::Region(RegionId(k)), Place::Barrier(BarrierId(0)));
        assert_eq!(between(&scene, &r(0), &r(1)), 2.0);
        assert_eq!(between(&scene, &r(0), &r(2)), 0.0);
        assert_eq!(between(&scene, &r(0), &b), 2.0);
        assert_eq!(between(&scene, &b, &r(1)), 2.0);
    }
}
