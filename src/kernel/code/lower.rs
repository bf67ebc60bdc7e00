//! From expressions to the graph of values.
//!
//! A value may be unresolved: the mean or centroid of nobody. Whether it is becomes a truth value of its
//! own, in the strong three-valued logic of Kleene: `false & unresolved` is false, and an `if` asks only
//! the branch it takes. So a guard as in `count(..) > 0 & mean(..) > 1` does what it says.

mod closed;
mod functions;
mod storeys;

use super::lists::Lists;
use super::node::{Crowd, Graph, Id, Join, Measure, Node, Reading};
use super::span;
use crate::model::{
    AgentId, Arithmetic, Axis, Bool, Comparison, Field, Fold, Num, Place, Scenario, Set, Who,
};
use std::sync::Arc;

/// A value and, if it can be unresolved, the node that tells where it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    pub(super) id: Id,
    pub(super) open: Option<Id>,
}

/// Puts expressions into a graph.
pub(super) struct Lowering<'a> {
    scenario: &'a Scenario,
    pub(super) graph: Graph,
    /// The lists of members that crowds refer to.
    pub(super) lists: Lists,
    /// All agents.
    everybody: Arc<[AgentId]>,
    /// How many loops are around the present place.
    depth: u32,
}

const fn resolved(id: Id) -> Value {
    Value { id, open: None }
}

impl<'a> Lowering<'a> {
    pub(super) fn new(scenario: &'a Scenario) -> Self {
        let everybody = (0..scenario.agents.len() as u32).map(AgentId).collect();
        Self { scenario, graph: Graph::default(), lists: Lists::default(), everybody, depth: 0 }
    }

    /// A second lowering of the same expressions, which knows from the start what was found in the first: so
    /// that a comparison over a crowd can use the smallest measure that comes after it.
    pub(super) fn again(first: Self) -> Self {
        let mut second = Self { lists: first.lists, ..Self::new(first.scenario) };
        for node in first.graph.nodes.into_iter().filter(|node| matches!(node, Node::Nearest(..))) {
            second.graph.enter(node);
        }
        second
    }

    fn crowd(&mut self, set: &Set) -> Crowd {
        self.lists.crowd(set)
    }

    /// Everybody else.
    fn others(&mut self, who: Who) -> Crowd {
        let everybody = Arc::clone(&self.everybody);
        self.crowd(&Set { members: everybody, except: Some(who) })
    }

    /// Some of the conditions holds, or none is there.
    fn either(&mut self, conditions: impl IntoIterator<Item = Option<Id>>) -> Option<Id> {
        let mut all: Vec<Id> = conditions.into_iter().flatten().collect();
        all.sort_unstable();
        all.dedup();
        match *all.as_slice() {
            [] => None,
            [one] => Some(one),
            _ => Some(self.graph.enter(Node::Or(all))),
        }
    }

    fn both(&mut self, a: Id, b: Id) -> Id {
        self.graph.enter(Node::And(vec![a, b]))
    }

    fn not(&mut self, a: Id) -> Id {
        self.graph.enter(Node::Not(a))
    }

    /// Whether an agent of a source has come in; none for others.
    fn entered(&mut self, who: Who) -> Option<Id> {
        let Who::Agent(id) = who else { return None };
        let (source, number) = self.arrival(id)?;
        Some(self.graph.enter(Node::Entered(source, number)))
    }

    /// The source that an agent comes from, and its number among the arrivals.
    fn arrival(&self, id: AgentId) -> Option<(u32, u32)> {
        self.scenario.sources.iter().enumerate().find_map(|(source, door)| {
            let number = door.members.binary_search(&id).ok()?;
            Some((source as u32, number as u32))
        })
    }

    /// A number of an agent, which is none before the agent has come in.
    fn if_entered(&mut self, who: Who, value: Id) -> Id {
        let Some(entered) = self.entered(who) else { return value };
        let nothing = self.graph.constant(f64::NAN);
        self.graph.enter(Node::Select(entered, value, nothing))
    }

    /// A number kept for an agent.
    fn of(&mut self, reading: Reading, who: Who) -> Id {
        let value = self.graph.enter(Node::Of(reading, who));
        self.if_entered(who, value)
    }

    fn distance(&mut self, a: Who, b: Who) -> Id {
        // The distance is the same bits both ways: let both ways be one node.
        let swapped = matches!((a, b), (Who::Agent(p), Who::Agent(q)) if p > q);
        let (one, other) = if swapped { (b, a) } else { (a, b) };
        let distance = if self.is_closed() {
            let mut read = |reading, who| self.graph.enter(Node::Of(reading, who));
            let ends = [read(Reading::X, one), read(Reading::Y, one)];
            let ends = [ends[0], ends[1], read(Reading::X, other), read(Reading::Y, other)];
            self.apart(ends)
        } else {
            self.graph.enter(Node::Distance(one, other))
        };
        let distance = self.if_together(a, b, distance);
        let distance = self.if_entered(a, distance);
        self.if_entered(b, distance)
    }

    fn radius(&mut self, who: Who) -> Id {
        self.of(Reading::Field(Field::Radius), who)
    }

    fn gap(&mut self, a: Who, b: Who) -> Id {
        let (distance, ra, rb) = (self.distance(a, b), self.radius(a), self.radius(b));
        let first = self.graph.enter(Node::Combine(Arithmetic::Subtract, distance, ra));
        self.graph.enter(Node::Combine(Arithmetic::Subtract, first, rb))
    }

    /// A number.
    pub(super) fn number(&mut self, number: &Num) -> Value {
        match number {
            Num::Constant(value) => resolved(self.graph.constant(*value)),
            Num::Time => resolved(self.graph.enter(Node::Time)),
            Num::Variable(id) => resolved(self.graph.enter(Node::Variable(id.0))),
            Num::Of(Field::Separation(separation), who) => resolved(self.separation(*separation, *who)),
            Num::Of(field @ Field::Dwell(_), who) => resolved(self.dwell(*field, *who)),
            Num::Of(field @ Field::Column(_), who) => {
                let id = self.of(Reading::Field(*field), *who);
                // Only what is no number differs from itself.
                let known = self.graph.enter(Node::Compare(Comparison::Equal, id, id));
                Value { id, open: Some(self.not(known)) }
            }
            Num::Of(field, who) => resolved(self.of(Reading::Field(*field), *who)),
            Num::Coordinate(axis, place) => {
                let (x, y) = self.point(place);
                let value = match axis {
                    Axis::X => x,
                    Axis::Y => y,
                };
                self.on_storey(*axis, place, value)
            }
            Num::Distance(a, b) => self.between(a, b),
            Num::Depth(place, region) => {
                let (x, y) = self.point(place);
                let id = self.over_images((x.id, y.id), Arithmetic::Max, |x, y| Node::Depth(x, y, region.0));
                Value { id, open: self.either([x.open, y.open]) }
            }
            Num::OfTwo(pair, a, b) => {
                let value = self.graph.enter(Node::OfTwo(*pair, *a, *b));
                resolved(self.if_together(*a, *b, value))
            }
            Num::Crossings(line, window) => self.crossings(*line, *window),
            Num::Voronoi(region) => resolved(self.graph.enter(Node::Voronoi(region.0))),
            Num::OfSet(collective, set) => self.of_set(*collective, set),
            Num::Apply(function, a) => {
                let a = self.number(a);
                Value { id: self.graph.enter(Node::Apply(*function, a.id)), open: a.open }
            }
            Num::Combine(..) => self.arithmetic(number),
            Num::Fold(fold, set, body) => self.fold(*fold, set, body),
            Num::Count(set, body) => {
                let (crowd, var, body) = self.enter_loop(set, |inside| inside.truth(body));
                let id = self.graph.enter(Node::Loop(Join::Count, crowd, var, body.id));
                Value { id, open: self.some_open(crowd, var, body) }
            }
            Num::If(condition, a, b) => {
                let (c, a, b) = (self.truth(condition), self.number(a), self.number(b));
                let id = self.graph.enter(Node::Select(c.id, a.id, b.id));
                let on_a = a.open.map(|open| self.both(c.id, open));
                let on_b = b.open.map(|open| {
                    let not = self.not(c.id);
                    self.both(not, open)
                });
                Value { id, open: self.either([c.open, on_a, on_b]) }
            }
        }
    }

    /// Arithmetic: a long sum leans to the left, so the left side is walked without recursion.
    fn arithmetic(&mut self, number: &Num) -> Value {
        let mut spine = Vec::new();
        let mut left = number;
        while let Num::Combine(operator, a, b) = left {
            spine.push((*operator, b));
            left = a;
        }
        let mut value = self.number(left);
        for (operator, b) in spine.into_iter().rev() {
            let b = self.number(b);
            let id = self.graph.enter(Node::Combine(operator, value.id, b.id));
            value = Value { id, open: self.either([value.open, b.open]) };
        }
        value
    }

    /// Lowers the body of a loop over `set`.
    fn enter_loop(&mut self, set: &Set, body: impl FnOnce(&mut Self) -> Value) -> (Crowd, u32, Value) {
        let crowd = self.crowd(set);
        let var = self.depth;
        self.depth += 1;
        let value = body(self);
        self.depth -= 1;
        (crowd, var, value)
    }

    /// Where the body is unresolved for some member.
    fn some_open(&mut self, crowd: Crowd, var: u32, body: Value) -> Option<Id> {
        body.open.map(|open| self.graph.enter(Node::Loop(Join::Exists, crowd, var, open)))
    }

    fn mean(&mut self, reading: Reading, set: &Set) -> Value {
        let crowd = self.crowd(set);
        let id = self.graph.enter(Node::Mean(reading, crowd));
        Value { id, open: Some(self.nobody(crowd)) }
    }

    fn nobody(&mut self, crowd: Crowd) -> Id {
        let somebody = self.graph.enter(Node::Somebody(crowd));
        self.not(somebody)
    }

    fn fold(&mut self, fold: Fold, set: &Set, body: &Num) -> Value {
        if let (Fold::Min, Some((who, measure)), true) = (fold, self.measure(body), self.is_flat()) {
            let crowd = self.crowd(set);
            return resolved(self.graph.enter(Node::Nearest(who, crowd, measure)));
        }
        let (crowd, var, body) = self.enter_loop(set, |inside| inside.number(body));
        let id = self.graph.enter(Node::Loop(Join::Fold(fold), crowd, var, body.id));
        let nobody = (fold == Fold::Mean).then(|| self.nobody(crowd));
        let inner = self.some_open(crowd, var, body);
        Value { id, open: self.either([nobody, inner]) }
    }

    /// Whether a body about to be looped over is a distance or gap to the running agent.
    fn measure(&self, body: &Num) -> Option<(Who, Measure)> {
        if self.is_closed() {
            return None;
        }
        let running = Who::Running(self.depth);
        let other = |a: Who, b: Who| match (a == running, b == running) {
            (true, false) => Some(b),
            (false, true) => Some(a),
            _ => None,
        };
        // Who may not have come yet has no distance to anybody: that takes the longer way.
        let other = |a: Who, b: Who| {
            other(a, b).filter(|who| !matches!(who, Who::Agent(id) if self.arrival(*id).is_some()))
        };
        match body {
            Num::Distance(Place::Agent(a), Place::Agent(b)) => Some((other(*a, *b)?, Measure::Centres)),
            Num::Combine(Arithmetic::Subtract, left, second) => {
                let Num::Of(Field::Radius, second) = **second else { return None };
                let Num::Combine(Arithmetic::Subtract, distance, first) = &**left else { return None };
                let Num::Of(Field::Radius, first) = **first else { return None };
                let Num::Distance(Place::Agent(a), Place::Agent(b)) = **distance else { return None };
                let who = other(a, b)?;
                match (first == who && second == running, first == running && second == who) {
                    (true, _) => Some((who, Measure::GapFixedFirst)),
                    (_, true) => Some((who, Measure::GapRunningFirst)),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// The coordinates of a place that is a point; NaN for a region or barrier.
    fn point(&mut self, place: &Place) -> (Value, Value) {
        match place {
            Place::Agent(who) => (resolved(self.of(Reading::X, *who)), resolved(self.of(Reading::Y, *who))),
            Place::Point(x, y) => (self.number(x), self.number(y)),
            Place::Centroid(set) => {
                let periods = self.scenario.scene.periods;
                (self.centre(Reading::X, set, periods.x), self.centre(Reading::Y, set, periods.y))
            }
            Place::Region(_) | Place::Barrier(_) => {
                let nowhere = resolved(self.graph.constant(f64::NAN));
                (nowhere, nowhere)
            }
        }
    }

    fn between(&mut self, a: &Place, b: &Place) -> Value {
        let extended = |place: &Place| matches!(place, Place::Region(_) | Place::Barrier(_));
        match (a, b) {
            (Place::Agent(a), Place::Agent(b)) => resolved(self.distance(*a, *b)),
            (a, b) if extended(a) && extended(b) => {
                resolved(self.graph.constant(span::between(&self.scenario.scene, a, b)))
            }
            (thing @ (Place::Region(_) | Place::Barrier(_)), point)
            | (point, thing @ (Place::Region(_) | Place::Barrier(_))) => {
                let (x, y) = self.point(point);
                let far = self.over_images((x.id, y.id), Arithmetic::Min, |x, y| match thing {
                    Place::Region(region) => Node::ToRegion(x, y, region.0),
                    Place::Barrier(barrier) => Node::ToBarrier(x, y, barrier.0),
                    // Not reached: `thing` is one of the two.
                    _ => Node::Constant(f64::NAN.to_bits()),
                });
                let id = self.if_on_island_of(point, thing, far);
                Value { id, open: self.either([x.open, y.open]) }
            }
            (a, b) => {
                let ((ax, ay), (bx, by)) = (self.point(a), self.point(b));
                let far = self.apart([ax.id, ay.id, bx.id, by.id]);
                let id = match (a, b) {
                    (Place::Agent(_), point) => self.if_on_island_of(a, point, far),
                    (point, agent) => self.if_on_island_of(agent, point, far),
                };
                Value { id, open: self.either([ax.open, ay.open, bx.open, by.open]) }
            }
        }
    }

    /// A truth value.
    pub(super) fn truth(&mut self, truth: &Bool) -> Value {
        match truth {
            Bool::Constant(value) => resolved(self.graph.enter(Node::Truth(*value))),
            Bool::Compare(comparison, a, b) => self.comparison(*comparison, a, b),
            Bool::Not(a) => {
                let a = self.truth(a);
                Value { id: self.not(a.id), open: a.open }
            }
            Bool::And(all) => self.junction(all, true),
            Bool::Or(all) => self.junction(all, false),
            Bool::Iff(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                let (not_a, not_b) = (self.not(a.id), self.not(b.id));
                let (both, neither) = (self.both(a.id, b.id), self.both(not_a, not_b));
                let id = self.graph.enter(Node::Or(vec![both, neither]));
                Value { id, open: self.either([a.open, b.open]) }
            }
            Bool::Present(who) => resolved(self.graph.enter(Node::Present(*who))),
            Bool::In(who, region) => {
                let inside = self.graph.enter(Node::Inside(*who, region.0));
                match self.entered(*who) {
                    Some(entered) => resolved(self.both(entered, inside)),
                    None => resolved(inside),
                }
            }
            Bool::Contact(who) => resolved(self.contact(*who)),
            Bool::Touching(a, b) => {
                let (gap, zero) = (self.gap(*a, *b), self.graph.constant(0.0));
                let touch = self.graph.enter(Node::Compare(Comparison::AtMost, gap, zero));
                let here = [self.graph.enter(Node::Present(*a)), self.graph.enter(Node::Present(*b))];
                resolved(self.graph.enter(Node::And(vec![here[0], here[1], touch])))
            }
            Bool::Forall(set, body) => self.quantifier(set, body, true),
            Bool::Exists(set, body) => self.quantifier(set, body, false),
        }
    }

    /// All (`and`) or any of the conditions.
    fn junction(&mut self, all: &[Bool], and: bool) -> Value {
        let values: Vec<Value> = all.iter().map(|one| self.truth(one)).collect();
        let ids: Vec<Id> = values.iter().map(|v| v.id).collect();
        let id = self.graph.enter(if and { Node::And(ids) } else { Node::Or(ids) });
        let Some(open) = self.either(values.iter().map(|v| v.open)) else { return resolved(id) };
        // Settled by one that is resolved and decides.
        let deciding: Vec<Option<Id>> = values.iter().map(|v| Some(self.deciding(*v, and))).collect();
        let undecided = match self.either(deciding) {
            Some(settled) => {
                let not = self.not(settled);
                self.both(open, not)
            }
            None => open,
        };
        Value { id, open: Some(undecided) }
    }

    /// Where a value is resolved and settles a conjunction (`and`) or disjunction by itself.
    fn deciding(&mut self, value: Value, and: bool) -> Id {
        let decides = if and { self.not(value.id) } else { value.id };
        match value.open {
            Some(open) => {
                let closed = self.not(open);
                self.both(closed, decides)
            }
            None => decides,
        }
    }

    fn quantifier(&mut self, set: &Set, body: &Bool, all: bool) -> Value {
        if let Bool::Compare(comparison, a, b) = body
            && let Some(fast) = self.all_far(set, *comparison, a, b, all)
        {
            return resolved(fast);
        }
        let (crowd, var, body) = self.enter_loop(set, |inside| inside.truth(body));
        let join = if all { Join::Forall } else { Join::Exists };
        let id = self.graph.enter(Node::Loop(join, crowd, var, body.id));
        let Some(open) = self.some_open(crowd, var, body) else { return resolved(id) };
        let deciding = self.deciding(body, all);
        let settled = self.graph.enter(Node::Loop(Join::Exists, crowd, var, deciding));
        let not = self.not(settled);
        Value { id, open: Some(self.both(open, not)) }
    }

    /// `forall a: distance > bound` or `exists a: distance < bound` and their like.
    fn all_far(&mut self, set: &Set, test: Comparison, a: &Num, b: &Num, all: bool) -> Option<Id> {
        use Comparison::{AtLeast, AtMost, Greater, Less};
        let (who, measure, test, bound) = match (self.measure(a), self.measure(b)) {
            (Some((who, measure)), None) => (who, measure, test, b),
            (None, Some((who, measure))) => {
                let mirrored = match test {
                    Less => Greater,
                    AtMost => AtLeast,
                    Greater => Less,
                    AtLeast => AtMost,
                    Comparison::Equal | Comparison::Unequal => return None,
                };
                (who, measure, mirrored, a)
            }
            _ => return None,
        };
        match (all, test) {
            (true, Greater | AtLeast) | (false, Less | AtMost) => {}
            _ => return None,
        }
        let (crowd, var, bound) = self.enter_loop(set, |inside| inside.number(bound));
        if bound.open.is_some() || self.graph.depends_on(bound.id, var) || !self.is_within_storey(bound.id) {
            return None;
        }
        let far = self.far(who, crowd, measure, (test, all), bound.id);
        Some(if all { far } else { self.not(far) })
    }

    fn far(
        &mut self,
        who: Who,
        crowd: Crowd,
        measure: Measure,
        (test, wanted): (Comparison, bool),
        bound: Id,
    ) -> Id {
        // Over nobody the nearest is infinitely far away, and farther than a finite bound.
        let finite = matches!(self.graph.nodes[bound as usize],
            Node::Constant(bits) if f64::from_bits(bits).is_finite());
        let nearest = self.graph.find(&Node::Nearest(who, crowd, measure)).filter(|_| finite);
        self.graph.enter(Node::AllFar { who, crowd, measure, test, wanted, bound, nearest })
    }

    fn comparison(&mut self, comparison: Comparison, a: &Num, b: &Num) -> Value {
        // The least distance is above a bound where all are: no square roots are needed. An infinite
        // bound is left out: nobody is infinitely far away.
        if let (Num::Fold(Fold::Min, set, body), Num::Constant(bound)) = (a, b)
            && bound.is_finite()
            && matches!(comparison, Comparison::Greater | Comparison::AtLeast)
            && let Some(fast) = self.all_far(set, comparison, body, b, true)
        {
            return resolved(fast);
        }
        let (a, b) = (self.number(a), self.number(b));
        let id = self.graph.enter(Node::Compare(comparison, a.id, b.id));
        Value { id, open: self.either([a.open, b.open]) }
    }

    fn contact(&mut self, who: Who) -> Id {
        let zero = self.graph.constant(0.0);
        let mut touch = if self.is_closed() {
            let gap = self.nearest_gap(who);
            self.graph.enter(Node::Compare(Comparison::AtMost, gap, zero))
        } else {
            let crowd = self.others(who);
            let free = self.far(who, crowd, Measure::GapFixedFirst, (Comparison::AtMost, false), zero);
            self.not(free)
        };
        if let Some(walls) = self.gap_to_scene(who) {
            let at_wall = self.graph.enter(Node::Compare(Comparison::AtMost, walls, zero));
            touch = self.graph.enter(Node::Or(vec![touch, at_wall]));
        }
        let present = self.graph.enter(Node::Present(who));
        self.both(present, touch)
    }
}
