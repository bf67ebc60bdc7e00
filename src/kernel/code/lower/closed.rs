//! Distances on a closed plane: those of the nearest images, composed of values of an open one. A scene without periods has
//! none of these nodes.

use super::{Id, Lowering, Value, resolved};
use crate::kernel::code::node::{Join, Node, Reading};
use crate::model::{Arithmetic, Fold, Function, Period, Set, Who};
use std::sync::Arc;

impl Lowering<'_> {
    /// Whether images count.
    pub(super) fn is_closed(&self) -> bool {
        !self.scenario.scene.periods.are_none()
    }

    fn combine(&mut self, operator: Arithmetic, a: Id, b: Id) -> Id {
        self.graph.enter(Node::Combine(operator, a, b))
    }

    /// A number less as many periods as the function says of their number in it.
    fn less_laps(&mut self, (v, from): (Id, Id), length: f64, function: Function) -> Id {
        let (length, inverse) = (self.graph.constant(length), self.graph.constant(1.0 / length));
        let laps = self.combine(Arithmetic::Multiply, from, inverse);
        let laps = self.graph.enter(Node::Apply(function, laps));
        let way = self.combine(Arithmetic::Multiply, length, laps);
        self.combine(Arithmetic::Subtract, v, way)
    }

    /// The shortest way along an axis from one coordinate to another.
    fn way(&mut self, to: Id, from: Id, period: Option<Period>) -> Id {
        let way = self.combine(Arithmetic::Subtract, to, from);
        period.map_or(way, |period| self.less_laps((way, way), period.length, Function::Round))
    }

    /// Distance between two points.
    pub(super) fn apart(&mut self, [ax, ay, bx, by]: [Id; 4]) -> Id {
        if !self.is_closed() {
            return self.graph.enter(Node::Between([ax, ay, bx, by]));
        }
        let (periods, zero) = (self.scenario.scene.periods, self.graph.constant(0.0));
        let (x, y) = (self.way(ax, bx, periods.x), self.way(ay, by, periods.y));
        self.graph.enter(Node::Between([x, y, zero, zero]))
    }

    /// What is measured from a point, as the least or the largest of what is measured from its images.
    pub(super) fn over_images(
        &mut self,
        (x, y): (Id, Id),
        operator: Arithmetic,
        node: impl Fn(Id, Id) -> Node,
    ) -> Id {
        let mut all = self.graph.enter(node(x, y));
        for way in &self.scenario.scene.periods.images()[1..] {
            let (dx, dy) = (self.graph.constant(way.x), self.graph.constant(way.y));
            let (x, y) = (self.combine(Arithmetic::Add, x, dx), self.combine(Arithmetic::Add, y, dy));
            let one = self.graph.enter(node(x, y));
            all = self.combine(operator, all, one);
        }
        all
    }

    /// Joins a number over the members of a set.
    fn join(&mut self, fold: Fold, set: &Set, body: impl FnOnce(&mut Self, Who) -> Id) -> Id {
        let running = Who::Running(self.depth);
        let (crowd, var, body) = self.enter_loop(set, |inside| resolved(body(inside, running)));
        self.graph.enter(Node::Loop(Join::Fold(fold), crowd, var, body.id))
    }

    /// The smallest gap to anybody else.
    pub(super) fn nearest_gap(&mut self, who: Who) -> Id {
        let set = Set { members: Arc::clone(&self.everybody), except: Some(who) };
        self.join(Fold::Min, &set, |inside, other| inside.gap(who, other))
    }

    /// A coordinate of the centroid: of each member that image counts which is nearest to the member with the least coordinate.
    pub(super) fn centre(&mut self, reading: Reading, set: &Set, period: Option<Period>) -> Value {
        let Some(period) = period else { return self.mean(reading, set) };
        let least = self.join(Fold::Min, set, |inside, one| inside.of(reading, one));
        let mean = self.join(Fold::Mean, set, |inside, one| {
            let at = inside.of(reading, one);
            inside.way(at, least, Some(period))
        });
        let (middle, low) = (self.combine(Arithmetic::Add, least, mean), self.graph.constant(period.low));
        let from_low = self.combine(Arithmetic::Subtract, middle, low);
        let id = self.less_laps((middle, from_low), period.length, Function::Floor);
        let crowd = self.crowd(set);
        Value { id, open: Some(self.nobody(crowd)) }
    }

    /// Root of the mean squared distance of the members of a set from a point.
    pub(super) fn closed_spread(&mut self, set: &Set, (x, y): (Id, Id)) -> Id {
        let mean = self.join(Fold::Mean, set, |inside, one| {
            let at = (inside.of(Reading::X, one), inside.of(Reading::Y, one));
            let distance = inside.apart([at.0, at.1, x, y]);
            inside.combine(Arithmetic::Multiply, distance, distance)
        });
        self.graph.enter(Node::Apply(Function::Sqrt, mean))
    }
}
