//! The plain evaluator: what each expression means, written down once more, without lanes.

use super::p;
use smc::base::decimal::Decimal;
use smc::base::geometry::{Shape, Vec2};
use smc::base::lanes::Lanes;
use smc::base::math;
use smc::base::tick::{Clock, Tick};
use smc::kernel::State;
use smc::model::{
    Arithmetic, Axis, Bool, Collective, Comparison, Field, Fold, Function, Num, Pair, Parameter, Place,
    RegionId, Scene, Separation, Set, Who,
};

/// What an expression means, word by word. `None`: unresolved.
pub(crate) struct Plain<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) state: &'a State,
    pub(crate) trial: usize,
    pub(crate) running: Vec<usize>,
}

#[derive(Clone, Copy)]
pub(crate) struct Bit(pub(crate) bool);

impl Plain<'_> {
    fn of(&self, field: &[Lanes], agent: usize) -> f64 {
        let slot = self.state.slot(agent, self.trial);
        field[slot.block].0[slot.lane]
    }

    fn here(&self, agent: usize) -> bool {
        let slot = self.state.slot(agent, self.trial);
        self.state.present[slot.block].has(slot.lane)
    }

    fn at(&self, agent: usize) -> Vec2 {
        p(self.of(&self.state.motion.x, agent), self.of(&self.state.motion.y, agent))
    }

    fn who(&self, who: Who) -> usize {
        match who {
            Who::Agent(id) => id.0 as usize,
            Who::Running(var) => self.running[var as usize],
        }
    }

    fn members(&self, set: &Set) -> Vec<usize> {
        let except = set.except.map(|who| self.who(who));
        let all = set.members.iter().map(|id| id.0 as usize);
        all.filter(|&agent| self.here(agent) && Some(agent) != except).collect()
    }

    fn field(&self, field: Field, agent: usize) -> f64 {
        let s = self.state;
        let (vx, vy) = (self.of(&s.motion.vx, agent), self.of(&s.motion.vy, agent));
        match field {
            Field::VelocityX => vx,
            Field::VelocityY => vy,
            Field::Speed => (vx * vx + vy * vy).sqrt(),
            Field::Heading if vx == 0.0 && vy == 0.0 => {
                math::atan2(self.of(&s.driving.ey, agent), self.of(&s.driving.ex, agent))
            }
            Field::Heading => math::atan2(vy, vx),
            Field::Radius => self.of(&s.bodies[Parameter::Radius], agent),
            Field::Mass => self.of(&s.bodies[Parameter::Mass], agent),
            Field::DrivingSpeed => self.of(&s.bodies[Parameter::Speed], agent),
            Field::Travelled => self.of(&s.motion.travelled, agent),
            Field::Legs => self.of(&s.progress.legs, agent),
            Field::StepCount => self.of(&s.progress.steps, agent),
            Field::DoneAt => self.of(&s.progress.done_at, agent),
            Field::Leg(measure, leg) => {
                s.progress.record(leg, measure as usize).map_or(f64::INFINITY, |of| self.of(of, agent))
            }
            Field::Separation(separation) => {
                assert_eq!(separation, Separation::Clearance);
                self.clearance(agent)
            }
            Field::Dwell(region) => {
                let steps = s.passages.stays(region).map_or(0.0, |steps| self.of(steps, agent));
                steps * 0.02
            }
            Field::Mode(_) => -1.0,
            Field::Storey if s.whereabouts.island.is_empty() => 0.0,
            Field::Storey => self.of(&s.whereabouts.island, agent),
            Field::Column(column) => s.columns.get(column as usize).map_or(f64::NAN, |of| self.of(of, agent)),
        }
    }

    fn centroid(&self, set: &Set) -> Option<Vec2> {
        self.mean(set, |agent| self.at(agent))
    }

    fn mean(&self, set: &Set, f: impl Fn(usize) -> Vec2) -> Option<Vec2> {
        let members = self.members(set);
        let sum = members.iter().fold(p(0.0, 0.0), |sum, &agent| sum + f(agent));
        (!members.is_empty()).then(|| sum / members.len() as f64)
    }

    fn point(&mut self, place: &Place) -> Option<Vec2> {
        match place {
            Place::Agent(who) => Some(self.at(self.who(*who))),
            Place::Point(x, y) => Some(p(self.number(x)?, self.number(y)?)),
            Place::Centroid(set) => self.centroid(set),
            _ => unreachable!(),
        }
    }

    fn gap(&self, a: usize, b: usize) -> f64 {
        let d = self.at(a) - self.at(b);
        (d.x * d.x + d.y * d.y).sqrt()
            - self.of(&self.state.bodies[Parameter::Radius], a)
            - self.of(&self.state.bodies[Parameter::Radius], b)
    }

    fn clearance(&self, who: usize) -> f64 {
        if !self.here(who) {
            return f64::INFINITY;
        }
        let others = (0..self.state.agents).filter(|&a| a != who && self.here(a)).map(|a| self.gap(who, a));
        let radius = self.of(&self.state.bodies[Parameter::Radius], who);
        let walls = self.walls(self.at(who)).map(|d| d - radius);
        others.chain(walls).fold(f64::INFINITY, least)
    }

    /// A position that is no finite number is at no distance from anything.
    fn barrier(&self, barrier: usize, at: Vec2) -> f64 {
        if !(at.x + at.y).is_finite() {
            return f64::NAN;
        }
        if beyond_squares(at) {
            return f64::INFINITY;
        }
        self.scene.barriers[barrier].obstacle.distance(at)
    }

    fn walls(&self, at: Vec2) -> impl Iterator<Item = f64> + '_ {
        (0..self.scene.barriers.len()).map(move |b| self.barrier(b, at))
    }

    fn region(&self, region: RegionId, at: Vec2) -> (bool, f64) {
        if !(at.x + at.y).is_finite() {
            return (false, f64::NAN);
        }
        if beyond_squares(at) {
            return (false, f64::INFINITY);
        }
        match (region.0, &self.scene.regions[region.0 as usize].shape) {
            (0, _) => {
                // Region 0 is the rectangle (1, 0.5) .. (4, 3).
                let inside = at.x >= 1.0 && at.x <= 4.0 && at.y >= 0.5 && at.y <= 3.0;
                let beyond = |v: f64, low: f64, high: f64| {
                    if v < low {
                        low - v
                    } else if v > high {
                        v - high
                    } else {
                        0.0
                    }
                };
                let (dx, dy) = (beyond(at.x, 1.0, 4.0), beyond(at.y, 0.5, 3.0));
                (inside, (dx * dx + dy * dy).sqrt())
            }
            (_, shape) => (shape.contains(at), shape.distance(at)),
        }
    }

    pub(crate) fn number(&mut self, n: &Num) -> Option<f64> {
        Some(match n {
            Num::Constant(value) => *value,
            Num::Time => {
                Clock::Stepped(Decimal::parse("0.02").unwrap()).seconds(Tick(self.state.ticks[self.trial]))
            }
            Num::Variable(id) => self.state.variables[id.0 as usize].0[self.trial],
            Num::Of(field, who) => self.field(*field, self.who(*who)),
            Num::Coordinate(axis, Place::Point(x, y)) => self.number(if *axis == Axis::X { x } else { y })?,
            Num::Coordinate(axis, place) => {
                let at = self.point(place)?;
                if *axis == Axis::X { at.x } else { at.y }
            }
            Num::OfSet(Collective::MeanVelocity(axis), set) => {
                let s = self.state;
                let v = self.mean(set, |a| p(self.of(&s.motion.vx, a), self.of(&s.motion.vy, a)))?;
                if *axis == Axis::X { v.x } else { v.y }
            }
            Num::Distance(a, b) => match (a, b) {
                (Place::Region(r), o) | (o, Place::Region(r)) => {
                    let at = self.point(o)?;
                    self.region(*r, at).1
                }
                (Place::Barrier(b), o) | (o, Place::Barrier(b)) => {
                    let at = self.point(o)?;
                    self.barrier(b.0 as usize, at)
                }
                (a, b) => {
                    let (a, b) = (self.point(a), self.point(b));
                    let d = a? - b?;
                    (d.x * d.x + d.y * d.y).sqrt()
                }
            },
            Num::Depth(place, region) => {
                let at = self.point(place)?;
                let (inside, distance) = self.region(*region, at);
                match &self.scene.regions[region.0 as usize].shape {
                    _ if !inside => -distance,
                    Shape::Circle { centre, radius } => radius - (at - centre).norm(),
                    Shape::Polygon(_) if region.0 == 0 => {
                        let across = least(at.x - 1.0, 4.0 - at.x);
                        least(across, least(at.y - 0.5, 3.0 - at.y))
                    }
                    Shape::Polygon(polygon) => (at - polygon.nearest_on_outline(at)).norm(),
                    Shape::Parts(_) => unreachable!("the regions have one part"),
                }
            }
            Num::OfTwo(pair, a, b) => {
                assert_eq!(*pair, Pair::TimeToCollision);
                self.collision(self.who(*a), self.who(*b))
            }
            Num::Crossings(..) | Num::Voronoi(_) => unreachable!("{n:?} is tested with whole trials"),
            Num::OfSet(collective, set) => {
                assert_eq!(*collective, Collective::Spread);
                let c = self.centroid(set)?;
                let mut sum = 0.0;
                let members = self.members(set);
                for &a in &members {
                    let d = c - self.at(a);
                    sum += d.x * d.x + d.y * d.y;
                }
                (sum / members.len() as f64).sqrt()
            }
            Num::Apply(f, a) => {
                let a = self.number(a)?;
                match f {
                    Function::Negate => -a,
                    Function::Abs => a.abs(),
                    Function::Sqrt => a.sqrt(),
                    Function::Exp => math::exp(a),
                    Function::Ln => math::ln(a),
                    Function::Sin => math::sin_cos(a).0,
                    Function::Cos => math::sin_cos(a).1,
                    Function::Floor => a.floor(),
                    Function::Ceil => a.ceil(),
                    Function::Round => a.round(),
                    Function::ServiceLevel => {
                        let least = [0.46, 0.93, 1.39, 2.32, 3.24];
                        1.0 + least.iter().filter(|&&least| a < least).count() as f64
                    }
                }
            }
            Num::Combine(op, a, b) => {
                let (a, b) = (self.number(a), self.number(b));
                let (a, b) = (a?, b?);
                match op {
                    Arithmetic::Add => a + b,
                    Arithmetic::Subtract => a - b,
                    Arithmetic::Multiply => a * b,
                    Arithmetic::Divide => a / b,
                    Arithmetic::Power => math::pow(a, b),
                    Arithmetic::Min => least(a, b),
                    Arithmetic::Max => -least(-a, -b),
                    Arithmetic::Atan2 => math::atan2(a, b),
                    Arithmetic::Agree => -least(-least(a, b), -least(-a, -b)),
                    Arithmetic::Modulo => {
                        let r = a % b;
                        if r != 0.0 && (r < 0.0) != (b < 0.0) { r + b } else { r }
                    }
                }
            }
            Num::Fold(fold, set, body) => {
                let mut values = Vec::new();
                for value in self.each(set, |me| me.number(body)) {
                    values.push(value?);
                }
                let sum = values.iter().fold(0.0, |a, b| a + b);
                match fold {
                    Fold::Min => values.iter().fold(f64::INFINITY, |a, &b| least(a, b)),
                    Fold::Max => values.iter().fold(f64::NEG_INFINITY, |a, &b| -least(-a, -b)),
                    Fold::Sum => sum,
                    Fold::Mean if values.is_empty() => return None,
                    Fold::Mean => sum / values.len() as f64,
                }
            }
            Num::Count(set, body) => {
                let mut count = 0.0;
                for value in self.each(set, |me| me.truth(body)) {
                    count += f64::from(u8::from(value?.0));
                }
                count
            }
            Num::If(c, a, b) => {
                if self.truth(c)?.0 {
                    self.number(a)?
                } else {
                    self.number(b)?
                }
            }
        })
    }

    fn collision(&self, a: usize, b: usize) -> f64 {
        if !(self.here(a) && self.here(b)) {
            return f64::INFINITY;
        }
        if self.gap(a, b) <= 0.0 {
            return 0.0;
        }
        let s = self.state;
        let (d, reach) = (
            self.at(a) - self.at(b),
            self.of(&s.bodies[Parameter::Radius], a) + self.of(&s.bodies[Parameter::Radius], b),
        );
        let v = p(
            self.of(&s.motion.vx, a) - self.of(&s.motion.vx, b),
            self.of(&s.motion.vy, a) - self.of(&s.motion.vy, b),
        );
        let (vv, dv, beyond) =
            (v.x * v.x + v.y * v.y, d.x * v.x + d.y * v.y, d.x * d.x + d.y * d.y - reach * reach);
        let root = dv * dv - vv * beyond;
        if dv >= 0.0 || root < 0.0 {
            return f64::INFINITY;
        }
        let time = beyond / (root.sqrt() - dv);
        if time < 0.0 { 0.0 } else { time }
    }

    fn each<T>(&mut self, set: &Set, f: impl Fn(&mut Self) -> T) -> Vec<T> {
        let members = self.members(set);
        members
            .into_iter()
            .map(|agent| {
                self.running.push(agent);
                let value = f(self);
                self.running.pop();
                value
            })
            .collect()
    }

    /// Strong Kleene: a resolved operand with the value `deciding` settles it.
    fn join(values: impl IntoIterator<Item = Option<Bit>>, deciding: bool) -> Option<Bit> {
        let values: Vec<_> = values.into_iter().collect();
        if values.iter().flatten().any(|bit| bit.0 == deciding) {
            return Some(Bit(deciding));
        }
        values.iter().all(Option::is_some).then_some(Bit(!deciding))
    }

    pub(crate) fn truth(&mut self, t: &Bool) -> Option<Bit> {
        Some(Bit(match t {
            Bool::Constant(value) => *value,
            Bool::Compare(c, a, b) => {
                let (a, b) = (self.number(a), self.number(b));
                let (a, b) = (a?, b?);
                if a.is_nan() || b.is_nan() {
                    return Some(Bit(false));
                }
                match c {
                    Comparison::Less => a < b,
                    Comparison::AtMost => a <= b,
                    Comparison::Greater => a > b,
                    Comparison::AtLeast => a >= b,
                    Comparison::Equal => a == b,
                    Comparison::Unequal => a != b,
                }
            }
            Bool::Not(a) => !self.truth(a)?.0,
            Bool::And(all) => {
                return Self::join(all.iter().map(|a| self.truth(a)).collect::<Vec<_>>(), false);
            }
            Bool::Or(all) => return Self::join(all.iter().map(|a| self.truth(a)).collect::<Vec<_>>(), true),
            Bool::Iff(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                a?.0 == b?.0
            }
            Bool::Present(who) => self.here(self.who(*who)),
            Bool::In(who, region) => self.region(*region, self.at(self.who(*who))).0,
            Bool::Contact(who) => {
                let who = self.who(*who);
                // Not by the clearance: that is a NaN as soon as one gap is.
                let others = (0..self.state.agents)
                    .filter(|&a| a != who && self.here(a))
                    .any(|a| self.gap(who, a) <= 0.0);
                let radius = self.of(&self.state.bodies[Parameter::Radius], who);
                let walls = self.walls(self.at(who)).any(|d| d - radius <= 0.0);
                self.here(who) && (others || walls)
            }
            Bool::Touching(a, b) => {
                let (a, b) = (self.who(*a), self.who(*b));
                self.here(a) && self.here(b) && self.gap(a, b) <= 0.0
            }
            Bool::Forall(set, body) => return Self::join(self.each(set, |me| me.truth(body)), false),
            Bool::Exists(set, body) => return Self::join(self.each(set, |me| me.truth(body)), true),
        }))
    }
}

/// Whether the square of a coordinate is too large for a double; the nearest point of an outline is lost.
pub(crate) fn beyond_squares(at: Vec2) -> bool {
    !at.norm_squared().is_finite()
}

pub(crate) fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if b < a {
        b
    } else {
        a
    }
}
