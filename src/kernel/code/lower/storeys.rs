//! Levels: nobody has a finite distance from what is on another level, and coordinates are those of the own level. A scene
//! without levels has none of these nodes.

use super::{Id, Lowering, Value};
use crate::base::geometry::{Shape, Vec2};
use crate::kernel::code::node::{Node, Reading};
use crate::model::storeys::APART;
use crate::model::{Arithmetic, Axis, Comparison, Field, Num, Obstacle, Place, Who};

impl Lowering<'_> {
    /// Whether there are no levels.
    pub(super) fn is_flat(&self) -> bool {
        self.scenario.scene.storeys.are_none()
    }

    /// Whether a bound is so small that only what is on the same level can be below it.
    pub(super) fn is_within_storey(&self, bound: Id) -> bool {
        self.is_flat()
            || matches!(self.graph.nodes[bound as usize], Node::Constant(bits) if f64::from_bits(bits) < 0.5 * APART)
    }

    /// A number of two agents on one level or flight of stairs; infinite elsewhere.
    pub(super) fn if_together(&mut self, a: Who, b: Who, value: Id) -> Id {
        if self.is_flat() {
            return value;
        }
        let [a, b] = [a, b].map(|who| self.graph.enter(Node::Of(Reading::Field(Field::Storey), who)));
        let same = self.graph.enter(Node::Compare(Comparison::Equal, a, b));
        let infinite = self.graph.constant(f64::INFINITY);
        self.graph.enter(Node::Select(same, value, infinite))
    }

    /// The distance of an agent from a thing that stands still; infinite on other levels.
    pub(super) fn if_on_island_of(&mut self, agent: &Place, thing: &Place, value: Id) -> Id {
        let scene = &self.scenario.scene;
        let Place::Agent(who) = agent else { return value };
        if self.is_flat() {
            return value;
        }
        let places = match thing {
            Place::Region(id) => {
                scene.regions[id.0 as usize].shape.parts().iter().map(Shape::inner_point).collect()
            }
            Place::Barrier(id) => match &scene.barriers[id.0 as usize].obstacle {
                Obstacle::Wall(pieces) => pieces.iter().map(|piece| piece.a).collect(),
                Obstacle::Solid(shape) => vec![shape.inner_point()],
            },
            Place::Point(x, y) => match (&**x, &**y) {
                (Num::Constant(x), Num::Constant(y)) => vec![Vec2::new(*x, *y)],
                _ => return value,
            },
            Place::Agent(_) | Place::Centroid(_) => return value,
        };
        let mut islands: Vec<usize> = places.into_iter().map(|p| scene.storeys.island_at(p)).collect();
        islands.sort_unstable();
        islands.dedup();
        let here = self.graph.enter(Node::Of(Reading::Field(Field::Storey), *who));
        let is_there = islands.into_iter().map(|island| {
            let island = self.graph.constant(island as f64);
            self.graph.enter(Node::Compare(Comparison::Equal, here, island))
        });
        let is_there: Vec<Id> = is_there.collect();
        let is_there = self.graph.enter(Node::Or(is_there));
        let infinite = self.graph.constant(f64::INFINITY);
        self.graph.enter(Node::Select(is_there, value, infinite))
    }

    /// A coordinate of somebody on the own level.
    pub(super) fn on_storey(&mut self, axis: Axis, place: &Place, value: Value) -> Value {
        let (Place::Agent(who), false) = (place, self.is_flat()) else { return value };
        let origin = self.of(Reading::Origin(axis), *who);
        Value { id: self.graph.enter(Node::Combine(Arithmetic::Subtract, value.id, origin)), ..value }
    }
}
