//! Compiled expressions against a plain evaluator that walks the tree, lane by lane: the same bits.

use proptest::prelude::*;
use smc::base::decimal::Decimal;
use smc::base::geometry::{Polygon, Segment, Shape, Vec2};
use smc::base::lanes::{LANES, Lanes, Mask};
use smc::base::math;
use smc::base::tick::{Clock, Tick};
use smc::kernel::{Code, Layout, Program, Readings, State};
use smc::model::{
    Agent, AgentId, Arithmetic, Axis, Barrier, BarrierId, Body, Bool, Comparison, Field, Fold, Function, Law,
    Num, Obstacle, Place, Position, Region, RegionId, Route, Scenario, Scene, Set, Start, Who,
};
use std::sync::Arc;

const AGENTS: usize = 6;

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn scene() -> Scene {
    let mut ring = Polygon::rectangle(p(2.0, 1.0), p(5.0, 4.0));
    ring.holes.push(Polygon::new(vec![p(3.0, 2.0), p(4.0, 2.0), p(3.5, 3.0)]).outline);
    let region = |shape| Region { name: String::new(), shape };
    let barrier = |obstacle| Barrier { name: String::new(), obstacle };
    Scene {
        regions: vec![
            region(Shape::rectangle(p(1.0, 0.5), p(4.0, 3.0))),
            region(Shape::Circle { centre: p(3.0, 3.0), radius: 1.5 }),
            region(Shape::Polygon(ring.clone())),
        ],
        barriers: vec![
            barrier(Obstacle::Wall(vec![
                Segment::new(p(0.0, 0.0), p(6.0, 0.0)),
                Segment::new(p(6.0, 0.0), p(6.0, 5.0)),
                Segment::new(p(1.0, 1.0), p(1.0, 1.0)),
            ])),
            barrier(Obstacle::Solid(Shape::Circle { centre: p(2.0, 4.0), radius: 0.5 })),
            barrier(Obstacle::Solid(Shape::Polygon(ring))),
            barrier(Obstacle::Solid(Shape::rectangle(p(0.0, 2.0), p(1.0, 3.0)))),
        ],
    }
}

fn scenario(agents: usize, scene: Scene) -> Arc<Scenario> {
    let law = || Law::Constant(1.0);
    let body = Arc::new(Body {
        mass: law(),
        radius: law(),
        speed: law(),
        tau: law(),
        a: law(),
        b: law(),
        lambda: law(),
        a2: law(),
        b2: law(),
        lambda2: law(),
        k1: law(),
        k2: law(),
        noise: law(),
    });
    let agent = |k: usize| Agent {
        name: format!("a{k}"),
        entity: k as u32,
        body: Arc::clone(&body),
        start: Start { position: Position::Point(p(0.0, 0.0)), velocity: p(0.0, 0.0) },
        route: Route::Onward,
        group: None,
        particle: None,
    };
    Arc::new(Scenario {
        title: String::new(),
        clock: Clock::Stepped(Decimal::parse("0.02").unwrap()),
        horizon: Tick(1000),
        scene,
        agents: (0..agents).map(agent).collect(),
        groups: Vec::new(),
        moves: Vec::new(),
    })
}

/// What an expression means, word by word. `None`: unresolved.
struct Plain<'a> {
    scene: &'a Scene,
    state: &'a State,
    trial: usize,
    running: Vec<usize>,
}

#[derive(Clone, Copy)]
struct Bit(bool);

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
        p(self.of(&self.state.x, agent), self.of(&self.state.y, agent))
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
        let (vx, vy) = (self.of(&s.vx, agent), self.of(&s.vy, agent));
        match field {
            Field::VelocityX => vx,
            Field::VelocityY => vy,
            Field::Speed => (vx * vx + vy * vy).sqrt(),
            Field::Heading if vx == 0.0 && vy == 0.0 => {
                math::atan2(self.of(&s.ey, agent), self.of(&s.ex, agent))
            }
            Field::Heading => math::atan2(vy, vx),
            Field::Radius => self.of(&s.radius, agent),
            Field::Mass => self.of(&s.mass, agent),
            Field::DrivingSpeed => self.of(&s.speed, agent),
            Field::Travelled => self.of(&s.travelled, agent),
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
        (d.x * d.x + d.y * d.y).sqrt() - self.of(&self.state.radius, a) - self.of(&self.state.radius, b)
    }

    fn clearance(&self, who: usize) -> f64 {
        if !self.here(who) {
            return f64::INFINITY;
        }
        let others = (0..AGENTS).filter(|&a| a != who && self.here(a)).map(|a| self.gap(who, a));
        let radius = self.of(&self.state.radius, who);
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

    fn number(&mut self, n: &Num) -> Option<f64> {
        Some(match n {
            Num::Constant(value) => *value,
            Num::Time => {
                Clock::Stepped(Decimal::parse("0.02").unwrap()).seconds(Tick(self.state.ticks[self.trial]))
            }
            Num::Of(field, who) => self.field(*field, self.who(*who)),
            Num::Coordinate(axis, Place::Point(x, y)) => self.number(if *axis == Axis::X { x } else { y })?,
            Num::Coordinate(axis, place) => {
                let at = self.point(place)?;
                if *axis == Axis::X { at.x } else { at.y }
            }
            Num::MeanVelocity(axis, set) => {
                let s = self.state;
                let v = self.mean(set, |a| p(self.of(&s.vx, a), self.of(&s.vy, a)))?;
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
            Num::Clearance(who) => self.clearance(self.who(*who)),
            Num::TimeToCollision(a, b) => self.collision(self.who(*a), self.who(*b)),
            Num::Spread(set) => {
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
        let (d, reach) = (self.at(a) - self.at(b), self.of(&s.radius, a) + self.of(&s.radius, b));
        let v = p(self.of(&s.vx, a) - self.of(&s.vx, b), self.of(&s.vy, a) - self.of(&s.vy, b));
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

    fn truth(&mut self, t: &Bool) -> Option<Bit> {
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
            Bool::In(who, region) => self.region(*region, self.at(self.who(*who))).0,
            Bool::Contact(who) => {
                let who = self.who(*who);
                // Not by the clearance: that is a NaN as soon as one gap is.
                let others =
                    (0..AGENTS).filter(|&a| a != who && self.here(a)).any(|a| self.gap(who, a) <= 0.0);
                let radius = self.of(&self.state.radius, who);
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
fn beyond_squares(at: Vec2) -> bool {
    !at.norm_squared().is_finite()
}

fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if b < a {
        b
    } else {
        a
    }
}

fn who(depth: u32) -> BoxedStrategy<Who> {
    let fixed = (0..AGENTS as u32).prop_map(|k| Who::Agent(AgentId(k)));
    if depth == 0 {
        fixed.boxed()
    } else {
        prop_oneof![1 => fixed, 2 => (0..depth).prop_map(Who::Running)].boxed()
    }
}

fn set(depth: u32) -> BoxedStrategy<Set> {
    let members = proptest::bits::u8::between(0, AGENTS).prop_map(|bits| {
        (0..AGENTS as u32).filter(|k| bits >> k & 1 == 1).map(AgentId).collect::<Vec<_>>().into()
    });
    (members, proptest::option::of(who(depth))).prop_map(|(members, except)| Set { members, except }).boxed()
}

fn place(depth: u32, size: u32) -> BoxedStrategy<Place> {
    let simple =
        prop_oneof![3 => who(depth).prop_map(Place::Agent), 1 => set(depth).prop_map(Place::Centroid)];
    if size == 0 {
        return simple.boxed();
    }
    let point = (number(depth, size - 1), number(depth, size - 1))
        .prop_map(|(x, y)| Place::Point(Box::new(x), Box::new(y)));
    prop_oneof![3 => simple, 1 => point].boxed()
}

fn constant() -> impl Strategy<Value = Num> {
    prop_oneof![
        4 => prop::sample::select(vec![0.0, 0.5, 1.0, 2.0, -1.0, 0.1, 3.7]),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
        2 => -5.0..5.0
    ]
    .prop_map(Num::Constant)
}

fn field() -> impl Strategy<Value = Field> {
    prop::sample::select(vec![
        Field::VelocityX,
        Field::VelocityY,
        Field::Speed,
        Field::Heading,
        Field::Radius,
        Field::Mass,
        Field::DrivingSpeed,
        Field::Travelled,
    ])
}

/// Distance of two agents, perhaps less their radii, in both orders.
fn measure(a: Who, b: Who, kind: u8) -> Num {
    let radius = |who| Box::new(Num::Of(Field::Radius, who));
    let less = |n, who| Num::Combine(Arithmetic::Subtract, Box::new(n), radius(who));
    let distance = Num::Distance(Place::Agent(a), Place::Agent(b));
    match kind {
        0 => distance,
        1 => less(less(distance, a), b),
        _ => less(less(distance, b), a),
    }
}

fn number(depth: u32, size: u32) -> BoxedStrategy<Num> {
    let leaf = prop_oneof![
        2 => constant(),
        1 => Just(Num::Time),
        2 => (field(), who(depth)).prop_map(|(f, w)| Num::Of(f, w)),
        1 => who(depth).prop_map(Num::Clearance),
        1 => (who(depth), who(depth)).prop_map(|(a, b)| Num::TimeToCollision(a, b)),
        1 => set(depth).prop_map(Num::Spread),
        1 => set(depth).prop_map(|s| Num::MeanVelocity(Axis::Y, s)),
        2 => (who(depth), who(depth), 0..3u8).prop_map(|(a, b, k)| measure(a, b, k)),
    ];
    if size == 0 {
        return leaf.boxed();
    }
    let functions = prop::sample::select(vec![
        Function::Negate,
        Function::Abs,
        Function::Sqrt,
        Function::Exp,
        Function::Ln,
        Function::Sin,
        Function::Cos,
        Function::Floor,
        Function::Ceil,
        Function::Round,
    ]);
    let operators = prop::sample::select(vec![
        Arithmetic::Add,
        Arithmetic::Subtract,
        Arithmetic::Multiply,
        Arithmetic::Divide,
        Arithmetic::Power,
        Arithmetic::Min,
        Arithmetic::Max,
        Arithmetic::Atan2,
        Arithmetic::Modulo,
    ]);
    let folds = prop::sample::select(vec![Fold::Min, Fold::Max, Fold::Sum, Fold::Mean]);
    let smaller = size - 1;
    prop_oneof![
        2 => leaf,
        1 => (any::<bool>(), place(depth, smaller)).prop_map(|(x, place)| {
            Num::Coordinate(if x { Axis::X } else { Axis::Y }, place)
        }),
        2 => (place(depth, smaller), place(depth, smaller)).prop_map(|(a, b)| Num::Distance(a, b)),
        1 => (0..3u32, place(depth, smaller)).prop_map(|(r, a)| Num::Distance(a, Place::Region(RegionId(r)))),
        1 => (0..4u32, place(depth, smaller)).prop_map(|(b, a)| Num::Distance(Place::Barrier(BarrierId(b)), a)),
        2 => (functions, number(depth, smaller)).prop_map(|(f, a)| Num::Apply(f, Box::new(a))),
        2 => (operators, number(depth, smaller), number(depth, smaller))
            .prop_map(|(o, a, b)| Num::Combine(o, Box::new(a), Box::new(b))),
        3 => (folds, set(depth), number(depth + 1, smaller)).prop_map(|(f, s, b)| Num::Fold(f, s, Box::new(b))),
        2 => (who(depth), set(depth), 0..3u8).prop_map(move |(w, s, k)| {
            Num::Fold(Fold::Min, s, Box::new(measure(w, Who::Running(depth), k)))
        }),
        2 => (set(depth), truth(depth + 1, smaller)).prop_map(|(s, b)| Num::Count(s, Box::new(b))),
        1 => (truth(depth, smaller), number(depth, smaller), number(depth, smaller))
            .prop_map(|(c, a, b)| Num::If(Box::new(c), Box::new(a), Box::new(b))),
    ]
    .boxed()
}

fn comparison() -> impl Strategy<Value = Comparison> {
    prop::sample::select(vec![
        Comparison::Less,
        Comparison::AtMost,
        Comparison::Greater,
        Comparison::AtLeast,
        Comparison::Equal,
        Comparison::Unequal,
    ])
}

fn truth(depth: u32, size: u32) -> BoxedStrategy<Bool> {
    let leaf = prop_oneof![
        1 => any::<bool>().prop_map(Bool::Constant),
        2 => (who(depth), 0..3u32).prop_map(|(w, r)| Bool::In(w, RegionId(r))),
        1 => who(depth).prop_map(Bool::Contact),
        1 => (who(depth), who(depth)).prop_map(|(a, b)| Bool::Touching(a, b)),
    ];
    if size == 0 {
        return leaf.boxed();
    }
    let smaller = size - 1;
    let all = move || proptest::collection::vec(truth(depth, smaller), 0..3);
    // The shape with an instruction of its own.
    let far = (who(depth), set(depth), comparison(), prop_oneof![constant(), number(depth, 0)], 0..3u8);
    let far =
        (far, any::<bool>(), any::<bool>()).prop_map(move |((w, set, c, bound, kind), all, mirrored)| {
            let (a, b) = (Box::new(measure(w, Who::Running(depth), kind)), Box::new(bound));
            let body = Box::new(if mirrored { Bool::Compare(c, b, a) } else { Bool::Compare(c, a, b) });
            if all { Bool::Forall(set, body) } else { Bool::Exists(set, body) }
        });
    let least =
        (who(depth), set(depth), comparison(), constant(), 0..3u8).prop_map(move |(w, set, c, b, kind)| {
            let fold = Num::Fold(Fold::Min, set, Box::new(measure(w, Who::Running(depth), kind)));
            Bool::Compare(c, Box::new(fold), Box::new(b))
        });
    prop_oneof![
        1 => leaf,
        3 => (comparison(), number(depth, smaller), number(depth, smaller))
            .prop_map(|(c, a, b)| Bool::Compare(c, Box::new(a), Box::new(b))),
        1 => truth(depth, smaller).prop_map(|a| Bool::Not(Box::new(a))),
        1 => all().prop_map(Bool::And),
        1 => all().prop_map(Bool::Or),
        2 => (set(depth), truth(depth + 1, smaller)).prop_map(|(s, b)| Bool::Forall(s, Box::new(b))),
        2 => (set(depth), truth(depth + 1, smaller)).prop_map(|(s, b)| Bool::Exists(s, Box::new(b))),
        3 => far,
        1 => least,
    ]
    .boxed()
}

fn state(layout: Layout) -> BoxedStrategy<Hidden> {
    // Coordinates on a coarse grid now and then, so that bodies touch exactly and stand on rims.
    let coordinate =
        prop_oneof![3 => 0.0..6.0, 3 => (0..13i32).prop_map(|k| f64::from(k) * 0.5), 1 => Just(f64::NAN)];
    let speed = prop_oneof![1 => Just(0.0), 3 => -2.0..2.0];
    let radius = prop_oneof![1 => Just(0.25), 3 => 0.1..0.6, 1 => Just(0.5)];
    let slot = (coordinate.clone(), coordinate, speed.clone(), speed, radius, 0.0..1.0);
    let slots = proptest::collection::vec(slot, AGENTS * LANES);
    let masks = proptest::collection::vec(prop_oneof![2 => Just(255u8), 1 => any::<u8>()], AGENTS);
    (slots, masks, prop_oneof![2 => Just(255u8), 1 => any::<u8>()], any::<[u16; LANES]>())
        .prop_map(move |(slots, masks, occupied, ticks)| {
            let mut state = State::new(layout, AGENTS);
            let (blocks, width) = (state.x.len(), slots.len());
            for block in 0..blocks {
                for lane in 0..LANES {
                    let (x, y, vx, vy, radius, z) = slots[(block * LANES + lane) % width];
                    state.x[block].0[lane] = x;
                    state.y[block].0[lane] = y;
                    state.vx[block].0[lane] = vx;
                    state.vy[block].0[lane] = vy;
                    state.radius[block].0[lane] = radius;
                    state.ex[block].0[lane] = 1.0 - z;
                    state.ey[block].0[lane] = z;
                    state.mass[block].0[lane] = 80.0 * z;
                    state.speed[block].0[lane] = 1.0 + z;
                    state.travelled[block].0[lane] = 10.0 * z;
                }
                state.present[block] = Mask(masks[block]);
            }
            state.ticks = ticks.map(u64::from);
            state.occupied = match layout {
                Layout::Trials => Mask(occupied),
                Layout::Agents => Mask(1),
            };
            Hidden(state)
        })
        .boxed()
}

fn same(a: f64, b: f64) -> bool {
    // The bits of a NaN mean nothing; everything else must agree to the last, signs of zero apart
    // where `min` and `max` meet both zeros.
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (a == 0.0 && b == 0.0)
}

/// A state whose numbers are not printed when a case fails.
#[derive(Clone)]
struct Hidden(State);

impl std::fmt::Debug for Hidden {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "x {:?} y {:?} present {:?}", self.0.x, self.0.y, self.0.present)
    }
}

fn check(
    layout: Layout,
    Hidden(state): &Hidden,
    atoms: &[Bool],
    signals: &[Num],
) -> Result<(), TestCaseError> {
    let scenario = scenario(AGENTS, scene());
    let mut program = Program::new(Arc::clone(&scenario));
    program.layout = layout;
    let code = Code::compile(&scenario, atoms, signals);
    let (mut readings, mut baseline) = (Readings::default(), Readings::default());
    code.run(&program, state, &mut readings);
    code.clone().at_baseline().run(&program, state, &mut baseline);
    for trial in state.occupied.iter() {
        let mut plain = Plain { scene: &scenario.scene, state, trial, running: Vec::new() };
        let mut open = false;
        for (k, atom) in atoms.iter().enumerate() {
            match plain.truth(atom) {
                Some(bit) => {
                    prop_assert_eq!(readings.atoms[k].has(trial), bit.0, "atom {} lane {}", k, trial);
                    prop_assert_eq!(baseline.atoms[k].has(trial), bit.0);
                }
                None => open = true,
            }
        }
        for (k, signal) in signals.iter().enumerate() {
            match plain.number(signal) {
                Some(value) => {
                    let (fast, slow) = (readings.signals[k].0[trial], baseline.signals[k].0[trial]);
                    prop_assert!(same(value, fast), "signal {} lane {}: {} {}", k, trial, value, fast);
                    prop_assert!(same(value, slow));
                }
                None => open = true,
            }
        }
        prop_assert_eq!(readings.unresolved.has(trial), open, "lane {}", trial);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn eight_trials_agree_with_the_tree(
        state in state(Layout::Trials),
        atoms in proptest::collection::vec(truth(0, 3), 1..3),
        signals in proptest::collection::vec(number(0, 3), 0..3),
    ) {
        check(Layout::Trials, &state, &atoms, &signals)?;
    }

    #[test]
    fn one_trial_agrees_with_the_tree(
        state in state(Layout::Agents),
        atoms in proptest::collection::vec(truth(0, 3), 1..3),
        signals in proptest::collection::vec(number(0, 3), 0..3),
    ) {
        check(Layout::Agents, &state, &atoms, &signals)?;
    }
}

/// A bound within an ulp of the gap must be decided as the subtraction decides it.
#[test]
fn bounds_at_the_last_bit_are_decided_exactly() {
    let mut state = State::new(Layout::Trials, AGENTS);
    state.occupied = Mask::ALL;
    state.present.fill(Mask::ALL);
    for agent in 0..AGENTS {
        for lane in 0..LANES {
            state.x[agent].0[lane] = agent as f64 * 1.37 + lane as f64 * 0.011;
            state.y[agent].0[lane] = 0.31 * (agent * lane) as f64;
            state.radius[agent].0[lane] = 0.2 + 0.013 * lane as f64;
        }
    }
    let user = Who::Agent(AgentId(0));
    let everybody = Set { members: (0..AGENTS as u32).map(AgentId).collect(), except: Some(user) };
    for kind in 0..3 {
        let least = Num::Fold(Fold::Min, everybody.clone(), Box::new(measure(user, Who::Running(0), kind)));
        let scenario = scenario(AGENTS, scene());
        let program = Program::new(Arc::clone(&scenario));
        let mut readings = Readings::default();
        Code::compile(&scenario, &[], &[least]).run(&program, &state, &mut readings);
        let value = readings.signals[0].0[3];
        for bound in [value.next_down(), value, value.next_up()] {
            let atoms: Vec<Bool> = [Comparison::Greater, Comparison::AtLeast]
                .into_iter()
                .map(|c| {
                    let (a, b) = (measure(user, Who::Running(0), kind), Num::Constant(bound));
                    Bool::Forall(everybody.clone(), Box::new(Bool::Compare(c, Box::new(a), Box::new(b))))
                })
                .collect();
            Code::compile(&scenario, &atoms, &[]).run(&program, &state, &mut readings);
            assert_eq!(readings.atoms[0].has(3), value > bound);
            assert_eq!(readings.atoms[1].has(3), value >= bound);
        }
    }
}

#[test]
fn a_sum_of_ten_thousand_terms_compiles() {
    let scenario = scenario(1, Scene::default());
    let sum = (0..10_000).fold(Num::Time, |sum, _| {
        Num::Combine(Arithmetic::Add, Box::new(sum), Box::new(Num::Of(Field::Mass, Who::Agent(AgentId(0)))))
    });
    let mut state = State::new(Layout::Trials, 1);
    state.occupied = Mask::ALL;
    let mut readings = Readings::default();
    Code::compile(&scenario, &[], &[sum]).run(&Program::new(Arc::clone(&scenario)), &state, &mut readings);
    assert_eq!(readings.signals[0], Lanes::splat(10_000.0));
}
