//! People: bodies, starts, routes, groups.

use super::kind::Kind;
use super::law::Law;
use super::parameter::Parameter;
use super::planner::Planner;
use super::scene::RegionId;
use super::stepper::Stepper;
use crate::base::geometry::{Shape, Vec2};
use std::ops::{Index, IndexMut};
use std::sync::Arc;

/// Index of an agent of the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AgentId(pub u32);

/// One person, or one body that stands for a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Agent {
    /// `user`, `oncoming[3]`
    pub name: String,
    /// Stable number of 24 bits from the path of its declaration; addresses its random numbers.
    pub entity: u32,
    /// How it moves: its kind and the laws of its parameters.
    pub body: Arc<Body>,
    /// Where and how it starts.
    pub start: Start,
    /// Where it goes.
    pub route: Route,
    /// Its group, if its members are drawn together.
    pub group: Option<u32>,
    /// Set where this body stands for several persons.
    pub particle: Option<Particle>,
}

/// The kind of an agent and the laws of its parameters, in SI units. Those that the kind does not have are constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its kind.
    pub kind: Kind,
    /// Whether it finds its way around barriers; else it goes straight for its goals.
    pub finds_ways: bool,
    /// How it plans, if it does.
    pub planner: Option<Arc<Planner>>,
    /// How it steps, if it does.
    pub stepper: Option<Arc<Stepper>>,
    /// How long it stands before it sets out on its route, s.
    pub premovement: Option<Law>,
    /// Its speed on stairs, as a share of that of their table.
    pub stairs: f64,
    laws: [Law; Parameter::COUNT],
}

impl Body {
    /// Of a kind, with these laws; it finds its way.
    pub fn new(kind: Kind, law: impl FnMut(Parameter) -> Law) -> Self {
        let laws = Parameter::ALL.map(law);
        Self { kind, finds_ways: true, planner: None, stepper: None, premovement: None, stairs: 1.0, laws }
    }

    /// The number of the draw of a parameter: its own, but for a preferred speed that is a share of the largest one.
    pub fn draw_of(&self, parameter: Parameter) -> u32 {
        let follows = self.planner.as_ref().is_some_and(|planner| planner.speed_follows);
        let one = if follows && parameter == Parameter::Speed { Parameter::LimitSpeed } else { parameter };
        one.draw()
    }
}

impl Index<Parameter> for Body {
    type Output = Law;

    fn index(&self, parameter: Parameter) -> &Law {
        &self.laws[parameter as usize]
    }
}

impl IndexMut<Parameter> for Body {
    fn index_mut(&mut self, parameter: Parameter) -> &mut Law {
        &mut self.laws[parameter as usize]
    }
}

/// A body that stands for a group (Given-Wilson et al. 2017, section 4.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Number of persons; the mass is the sum of so many draws, A is multiplied by it, noise divided by
    /// its square root.
    pub persons: u32,
    /// Factor of the bounded social force between two particles of more than one person: the largest share of
    /// what drives a body that the other takes away.
    pub repulsion: f64,
    /// Friction constant where two such particles overlap, kg/(m s).
    pub friction: f64,
    /// Factor of the radius as drawn: the root of `persons` (equal area) unless the group sets its own.
    pub radius_factor: f64,
    /// Root mean square distance from their middle, m, of persons who were seen; else 0. The radius is at least this and one
    /// person's.
    pub spread: f64,
    /// How far, m, persons who were seen were from the nearest barrier, or infinity. What is more than one person is no wider,
    /// because a party that passes a post on both sides is no disc on top of it.
    pub room: f64,
    /// Factor of the relaxation time as drawn: the root of `persons` unless the group sets its own.
    pub tau_factor: f64,
}

impl Particle {
    /// The radius of the body, m, of persons with a radius as drawn.
    pub fn radius(&self, drawn: f64) -> f64 {
        let (equal, wide) = (drawn * self.radius_factor, drawn + self.spread);
        let whole = if equal > wide { equal } else { wide };
        let most = if self.room > drawn { self.room } else { drawn };
        if whole > most { most } else { whole }
    }
}

/// Where and how an agent starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Where.
    pub position: Position,
    /// Velocity, m/s.
    pub velocity: Vec2,
    /// The velocity that it wants, m/s, where it goes on as it started; `None` for that with which it starts.
    pub driving: Option<Vec2>,
    /// By how much the direction that it wants is turned from that of `driving`, rad; for who goes on as it started.
    pub turn: Law,
    /// Whether who goes on wants the speed of its parameter `speed`, instead of that with which it started.
    pub own_speed: bool,
    /// The entity whose draws of heading and speed are its own too; `None` for its own entity.
    pub wants_as: Option<u32>,
    /// Ids of the people who were seen there; none where the start is declared.
    pub seen: Vec<u32>,
}

impl Start {
    /// At a point, standing.
    pub const fn at_rest(point: Vec2) -> Self {
        Self {
            position: Position::Point(point),
            velocity: Vec2::new(0.0, 0.0),
            driving: None,
            turn: Law::Constant(0.0),
            own_speed: false,
            wants_as: None,
            seen: Vec::new(),
        }
    }

    /// The velocity that whoever goes on wants, m/s.
    pub fn driving(&self) -> Vec2 {
        self.driving.unwrap_or(self.velocity)
    }
}

/// A rule of placement.
#[derive(Clone, Debug, PartialEq)]
pub enum Position {
    /// At a point.
    Point(Vec2),
    /// Anywhere in a shape, without overlaps.
    Within(Shape),
    /// Anywhere within a distance of an agent that is placed before.
    Near {
        /// That agent.
        agent: AgentId,
        /// Largest distance of the centres, m.
        within: f64,
    },
}

/// Where an agent goes.
#[derive(Clone, Debug, PartialEq)]
pub enum Route {
    /// Through goals in order; without any it stands.
    Legs {
        /// The legs.
        legs: Vec<Leg>,
        /// Whether it departs on reaching the last goal.
        then_leave: bool,
    },
    /// On as it started: its driving velocity (`Start::driving`) stays the same for ever.
    Onward,
    /// To one of some goals, where it stands.
    OneOf {
        /// The goals.
        legs: Vec<Leg>,
        /// The probability of each.
        weights: Vec<f64>,
    },
}

impl Route {
    /// Its legs in order, or those of which it has one.
    pub fn legs(&self) -> &[Leg] {
        match self {
            Self::Legs { legs, .. } | Self::OneOf { legs, .. } => legs,
            Self::Onward => &[],
        }
    }

    /// The goals of its legs.
    pub fn goals(&self) -> impl Iterator<Item = &Goal> {
        self.legs().iter().filter_map(|leg| if let Leg::To(goal) = leg { Some(goal) } else { None })
    }
}

/// One leg of a route.
#[derive(Clone, Debug, PartialEq)]
pub enum Leg {
    /// Walk there.
    To(Goal),
    /// Stand for a time, s.
    Wait(Law),
}

/// Somewhere to go.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// A region of the scene: reached when the centre of the body is inside.
    Region(RegionId),
    /// A point.
    Point(Vec2),
}

/// Members drawn together (Moussaïd, Perozo, Garnier, Helbing, Theraulaz 2010).
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Its members.
    pub members: Vec<AgentId>,
    /// Force towards the centroid when farther than (n - 1)/2 m from it, N.
    pub attraction: f64,
}
