//! The built-in functions that are composed of several values: how far others are, numbers of a set. Those that are read
//! off the state in one go are in `code/crowd.rs`.

use super::{Id, Lowering, Value};
use crate::base::tick::Tick;
use crate::kernel::code::node::{Measure, Node, Reading};
use crate::model::{Arithmetic, Axis, Collective, Comparison, Field, LineId, Place, Separation, Set, Who};

impl Lowering<'_> {
    /// A number of a set.
    pub(super) fn of_set(&mut self, collective: Collective, set: &Set) -> Value {
        match collective {
            Collective::MeanVelocity(Axis::X) => self.mean(Reading::Field(Field::VelocityX), set),
            Collective::MeanVelocity(Axis::Y) => self.mean(Reading::Field(Field::VelocityY), set),
            Collective::Spread => {
                let (x, y) = self.point(&Place::Centroid(set.clone()));
                let id = if self.is_closed() {
                    self.closed_spread(set, (x.id, y.id))
                } else {
                    let crowd = self.crowd(set);
                    self.graph.enter(Node::Spread(crowd, x.id, y.id))
                };
                Value { id, open: x.open }
            }
        }
    }

    /// How long an agent has been in a region: a number of steps, as long as time is.
    pub(super) fn dwell(&mut self, field: Field, who: Who) -> Id {
        let steps = self.of(Reading::Field(field), who);
        let (numerator, denominator) = self.scenario.clock.step_ratio();
        let (numerator, denominator) = (self.graph.constant(numerator), self.graph.constant(denominator));
        let time = self.graph.enter(Node::Combine(Arithmetic::Multiply, steps, numerator));
        self.graph.enter(Node::Combine(Arithmetic::Divide, time, denominator))
    }

    /// How many agents have crossed a line. Those of a time window have no number before its end.
    pub(super) fn crossings(&mut self, line: LineId, window: Option<u64>) -> Value {
        let id = self.graph.enter(Node::Crossings(line.0, window));
        let open = window.map(|ticks| {
            let end = self.graph.constant(self.scenario.clock.seconds(Tick(ticks)));
            let now = self.graph.enter(Node::Time);
            self.graph.enter(Node::Compare(Comparison::Less, now, end))
        });
        Value { id, open }
    }

    /// How far others are from an agent.
    pub(super) fn separation(&mut self, separation: Separation, who: Who) -> Id {
        match separation {
            Separation::Clearance => self.clearance(who),
        }
    }

    /// A body that has left has no gap: infinite.
    fn clearance(&mut self, who: Who) -> Id {
        let mut gap = if self.is_closed() || !self.is_flat() {
            self.nearest_gap(who)
        } else {
            let crowd = self.others(who);
            self.graph.enter(Node::Nearest(who, crowd, Measure::GapFixedFirst))
        };
        if let Some(walls) = self.gap_to_scene(who) {
            gap = self.graph.enter(Node::Combine(Arithmetic::Min, gap, walls));
        }
        let present = self.graph.enter(Node::Present(who));
        let infinite = self.graph.constant(f64::INFINITY);
        self.graph.enter(Node::Select(present, gap, infinite))
    }

    /// Gap between a body and the nearest barrier, if there is any.
    pub(super) fn gap_to_scene(&mut self, who: Who) -> Option<Id> {
        if self.scenario.scene.barriers.is_empty() {
            return None;
        }
        let x = self.of(Reading::X, who);
        let y = self.of(Reading::Y, who);
        let (distance, radius) = (self.graph.enter(Node::ToScene(x, y)), self.radius(who));
        Some(self.graph.enter(Node::Combine(Arithmetic::Subtract, distance, radius)))
    }
}
