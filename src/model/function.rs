//! The built-in functions of the language, in one table: names, arguments, and the dimensions of what they give. What they
//! give is computed by the kernel (`kernel/code`), and described in `docs/properties.md`.

use super::expression::{Arithmetic, Axis, Function};
use super::index::BehaviourId;
use super::scene::RegionId;
use crate::base::dimension::Dimension;

/// A number of one agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Field {
    /// Velocity, first component, m/s.
    VelocityX,
    /// Velocity, second component, m/s.
    VelocityY,
    /// Magnitude of the velocity, m/s.
    Speed,
    /// Direction of the velocity, rad in (-pi, pi]; of the driving direction where it stands.
    Heading,
    /// Radius, m.
    Radius,
    /// Mass, kg.
    Mass,
    /// Driving speed, as drawn or as a behaviour has changed it, m/s.
    DrivingSpeed,
    /// Length of the way gone since the start, m.
    Travelled,
    /// Finished legs of the route; pauses are none.
    Legs,
    /// Whole steps made, of somebody who steps.
    StepCount,
    /// When the last goal is reached and pauses are over, s; infinite until that is known.
    DoneAt,
    /// Time in a region so far, s.
    Dwell(RegionId),
    /// A number of a leg, from 0; infinite until it ends.
    Leg(LegMeasure, u32),
    /// How far others are.
    Separation(Separation),
    /// Number of the level or stairs on which it is, among the islands of the scene.
    Storey,
    /// Number of the state of a behaviour, from 0; -1 in someone who has no such behaviour.
    Mode(BehaviourId),
    /// A column of the recording that is shown, by its number; unresolved in who has none, as in every simulated trial.
    Column(u32),
}

/// What is measured from the beginning of a leg to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LegMeasure {
    /// Length of the way gone, m.
    Length,
    /// Time, s.
    Time,
    /// Steps.
    Steps,
}

/// How far others are from an agent; infinite where nobody and nothing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Separation {
    /// Smallest gap between its body and any other body, wall or obstacle, m; negative in overlap.
    Clearance,
}

/// A number of two agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pair {
    /// Seconds until two bodies touch if both keep their velocity: 0 in contact, infinite if never.
    TimeToCollision,
}

/// A number of a set of agents; unresolved for nobody.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Collective {
    /// A component of the mean velocity, m/s.
    MeanVelocity(Axis),
    /// Root of the mean squared distance of the members from their centroid, m.
    Spread,
}

/// What a function takes, and what it becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signature {
    /// A number of one agent.
    Agent(Field),
    /// A number of two agents.
    Agents(Pair),
    /// A number of a set.
    Set(Collective),
    /// A function of a number, which has this dimension if there is one.
    Number(Function, Option<Dimension>),
    /// A function of two numbers of one dimension.
    Numbers(Arithmetic),
    /// What only the compiler can make, in the order of the names.
    Special(Special),
}

/// Functions that are no numbers of agents, sets or numbers alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is the function of its name")]
pub enum Special {
    Area,
    Centroid,
    Column,
    /// `x` and `y` of a vector.
    Component(Axis),
    Contact,
    Count,
    Crossings,
    Density,
    Distance,
    Done,
    Dwell,
    Flow,
    Leg(LegMeasure),
    /// `min` and `max` of several numbers.
    Extremum(Arithmetic),
    If,
    LevelOfService,
    MeanSpeed,
    /// `sum` and `mean`, which join values over a set or over time only.
    Join,
    Members,
    Norm,
    Others,
    Position,
    Present,
    Robustness,
    TimeUntil,
    Velocity,
    VoronoiDensity,
}

impl Special {
    /// Whether the area of its region is a part of what it gives.
    pub const fn needs_area(self) -> bool {
        matches!(
            self,
            Self::Area | Self::Density | Self::LevelOfService | Self::MeanSpeed | Self::VoronoiDensity
        )
    }
}

/// The dimension of what a function gives, as far as its arguments tell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// This one.
    Always(Dimension),
    /// That of time.
    Clock,
    /// That which all arguments from this one on have.
    Same(usize),
    /// The square root of that of the argument.
    Root,
    /// No number, or one of which nothing is said beforehand.
    Open,
}

/// A built-in function.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// Its name.
    pub name: &'static str,
    /// The least and the largest number of its arguments.
    pub arguments: (usize, usize),
    /// What it takes and becomes.
    pub signature: Signature,
    /// The dimension of what it gives.
    pub dimension: Rule,
}

const NONE: Rule = Rule::Always(Dimension::NONE);
const LENGTH: Rule = Rule::Always(Dimension::LENGTH);
const SPEED: Rule = Rule::Always(Dimension::SPEED);
const TIME: Rule = Rule::Always(Dimension::TIME);
const ANGLE: Rule = Rule::Always(Dimension::ANGLE);

const fn agent(name: &'static str, field: Field, dimension: Rule) -> BuiltIn {
    BuiltIn { name, arguments: (1, 1), signature: Signature::Agent(field), dimension }
}

const fn agents(name: &'static str, pair: Pair, dimension: Rule) -> BuiltIn {
    BuiltIn { name, arguments: (2, 2), signature: Signature::Agents(pair), dimension }
}

const fn set(name: &'static str, collective: Collective, dimension: Rule) -> BuiltIn {
    BuiltIn { name, arguments: (1, 1), signature: Signature::Set(collective), dimension }
}

const fn number(
    name: &'static str,
    function: Function,
    takes: Option<Dimension>,
    dimension: Rule,
) -> BuiltIn {
    BuiltIn { name, arguments: (1, 1), signature: Signature::Number(function, takes), dimension }
}

const fn numbers(name: &'static str, operator: Arithmetic, dimension: Rule) -> BuiltIn {
    BuiltIn { name, arguments: (2, 2), signature: Signature::Numbers(operator), dimension }
}

const fn special(
    name: &'static str,
    arguments: (usize, usize),
    special: Special,
    dimension: Rule,
) -> BuiltIn {
    BuiltIn { name, arguments, signature: Signature::Special(special), dimension }
}

/// All built-in functions.
pub const FUNCTIONS: &[BuiltIn] = &[
    number("abs", Function::Abs, None, Rule::Same(0)),
    special("area", (1, 1), Special::Area, Rule::Always(Dimension::AREA)),
    numbers("atan2", Arithmetic::Atan2, ANGLE),
    number("ceil", Function::Ceil, Some(Dimension::NONE), NONE),
    special("centroid", (1, 1), Special::Centroid, Rule::Open),
    agent("clearance", Field::Separation(Separation::Clearance), LENGTH),
    special("column", (2, 2), Special::Column, NONE),
    special("contact", (1, 2), Special::Contact, Rule::Open),
    number("cos", Function::Cos, Some(Dimension::ANGLE), NONE),
    special("count", (1, 1), Special::Count, NONE),
    special("crossings", (1, 1), Special::Crossings, NONE),
    special("density", (1, 1), Special::Density, Rule::Always(Dimension::DENSITY)),
    special("distance", (2, 2), Special::Distance, LENGTH),
    special("done", (1, 1), Special::Done, Rule::Open),
    agent("driving_speed", Field::DrivingSpeed, SPEED),
    special("dwell", (2, 2), Special::Dwell, TIME),
    number("exp", Function::Exp, Some(Dimension::NONE), NONE),
    number("floor", Function::Floor, Some(Dimension::NONE), NONE),
    special("flow", (2, 2), Special::Flow, Rule::Always(Dimension::RATE)),
    agent("heading", Field::Heading, ANGLE),
    special("if", (3, 3), Special::If, Rule::Same(1)),
    special("leg_length", (2, 2), Special::Leg(LegMeasure::Length), LENGTH),
    special("leg_steps", (2, 2), Special::Leg(LegMeasure::Steps), NONE),
    special("leg_time", (2, 2), Special::Leg(LegMeasure::Time), TIME),
    agent("legs", Field::Legs, NONE),
    special("level_of_service", (1, 1), Special::LevelOfService, NONE),
    number("ln", Function::Ln, Some(Dimension::NONE), NONE),
    agent("mass", Field::Mass, Rule::Always(Dimension::MASS)),
    special("max", (2, usize::MAX), Special::Extremum(Arithmetic::Max), Rule::Same(0)),
    special("min", (2, usize::MAX), Special::Extremum(Arithmetic::Min), Rule::Same(0)),
    special("mean_speed", (1, 1), Special::MeanSpeed, SPEED),
    special("members", (1, 1), Special::Members, Rule::Open),
    numbers("modulo", Arithmetic::Modulo, Rule::Same(0)),
    special("norm", (1, 1), Special::Norm, Rule::Open),
    special("others", (1, 1), Special::Others, Rule::Open),
    special("position", (1, 1), Special::Position, Rule::Open),
    special("present", (1, 1), Special::Present, Rule::Open),
    agent("radius", Field::Radius, LENGTH),
    special("robustness", (1, 1), Special::Robustness, Rule::Open),
    number("round", Function::Round, Some(Dimension::NONE), NONE),
    number("sin", Function::Sin, Some(Dimension::ANGLE), NONE),
    agent("speed", Field::Speed, SPEED),
    set("spread", Collective::Spread, LENGTH),
    number("sqrt", Function::Sqrt, None, Rule::Root),
    agent("step_count", Field::StepCount, NONE),
    special("sum", (1, 1), Special::Join, Rule::Open),
    special("mean", (1, 1), Special::Join, Rule::Open),
    agents("time_to_collision", Pair::TimeToCollision, TIME),
    special("time_until", (1, 1), Special::TimeUntil, Rule::Clock),
    agent("travelled", Field::Travelled, LENGTH),
    special("velocity", (1, 1), Special::Velocity, Rule::Open),
    special("voronoi_density", (1, 1), Special::VoronoiDensity, Rule::Always(Dimension::DENSITY)),
    special("x", (1, 1), Special::Component(Axis::X), Rule::Open),
    special("y", (1, 1), Special::Component(Axis::Y), Rule::Open),
];

impl BuiltIn {
    /// The function of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        FUNCTIONS.iter().find(|function| function.name == name)
    }

    /// All names.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FUNCTIONS.iter().map(|function| function.name)
    }

    /// The dimension of what it gives, where the table says it; else none.
    pub const fn gives(&self) -> Dimension {
        if let Rule::Always(dimension) = self.dimension { dimension } else { Dimension::NONE }
    }

    /// Whether it takes so many arguments.
    pub const fn takes(&self, arguments: usize) -> bool {
        self.arguments.0 <= arguments && arguments <= self.arguments.1
    }
}

/// The dimension of what a function with this signature gives.
fn dimension(signature: Signature) -> Option<Dimension> {
    FUNCTIONS.iter().find(|function| function.signature == signature).map(BuiltIn::gives)
}

impl Field {
    /// Its dimension, if it has one.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Self::VelocityX | Self::VelocityY => Some(Dimension::SPEED),
            Self::DoneAt | Self::Dwell(_) => Some(Dimension::TIME),
            Self::Leg(measure, _) => dimension(Signature::Special(Special::Leg(measure))),
            Self::Column(_) | Self::Storey => Some(Dimension::NONE),
            field => dimension(Signature::Agent(field)),
        }
    }

    /// Whether it can be infinite in a trial that goes on.
    pub const fn may_be_infinite(self) -> bool {
        matches!(self, Self::Separation(_) | Self::DoneAt | Self::Leg(..))
    }
}

impl Pair {
    /// Its dimension.
    pub fn dimension(self) -> Option<Dimension> {
        dimension(Signature::Agents(self))
    }
}

impl Collective {
    /// Its dimension.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Self::MeanVelocity(_) => Some(Dimension::SPEED),
            collective @ Self::Spread => dimension(Signature::Set(collective)),
        }
    }
}
