//! The table of parameters: all that is said of a parameter of an agent stands in one row.
//!
//! Parsing of fields, presets, errors of range, changes by behaviours, drawing, `smc show` and the table of the manual read
//! the rows below. A parameter that a new force term needs is a row here and a use in that term.

use super::kind::Kind;
use super::law::Law;
use crate::base::dimension::Dimension;
use crate::base::random::name_hash;

/// No human reaches this speed: a trial in which somebody does has diverged, m/s.
pub const TOP_SPEED: f64 = 15.0;

/// Nobody is as tall, m.
const TALLEST: f64 = 3.0;

/// What a parameter of a body may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// From 0 to 1.
    Share,
    /// A whole number from 2 to 64.
    Pieces,
}

/// What a parameter is for the term of the force that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The force at touching distance: attention multiplies it in the agent that feels it.
    Strength,
    /// How far the force reaches.
    Reach,
    /// A number of the body.
    Plain,
}

/// When `smc show` prints a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// In each body.
    Always,
    /// In bodies that have another value than the default.
    UnlessDefault,
    /// In bodies in which this strength is not 0.
    With(Parameter),
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// The parameter.
    pub parameter: Parameter,
    /// Its name in a scenario; addresses its draws.
    pub name: &'static str,
    /// What it means, for the manual.
    pub meaning: &'static str,
    /// Its dimension; values are in SI units.
    pub dimension: Dimension,
    /// What it may be.
    pub range: Range,
    /// The value beyond which every trial would diverge.
    pub limit: f64,
    /// Its value unless set; `None` if a kind must set it.
    pub default: Option<f64>,
    /// Whether a preset that does not set it gives it its default: a preset describes the whole force, so nothing is left of
    /// a kind from which one with a preset starts.
    pub preset: bool,
    /// Whether a state of a behaviour may change it.
    pub changeable: bool,
    /// What it is for its term of the force.
    pub role: Role,
    /// When it is printed.
    pub shown: Shown,
    /// The kinds of agents that have it.
    pub kinds: &'static [Kind],
}

impl Description {
    /// What most parameters have in common.
    const USUAL: Self = Self {
        parameter: Parameter::Mass,
        name: "",
        meaning: "",
        dimension: Dimension::NONE,
        range: Range::NotNegative,
        limit: f64::INFINITY,
        default: None,
        preset: false,
        changeable: true,
        role: Role::Plain,
        shown: Shown::Always,
        kinds: &Kind::FORCED,
    };
    /// Of contact: the same in all states of a behaviour.
    const FIXED: Self = Self { changeable: false, ..Self::USUAL };
    /// Of the body.
    const BODY: Self = Self { range: Range::Positive, kinds: &Kind::ALL, ..Self::FIXED };
    /// Of the social force.
    const FORCE: Self = Self { preset: true, ..Self::USUAL };
    /// Of the collision-free speed model.
    const SPEEDS: Self = Self { preset: true, kinds: &[Kind::Cfs], ..Self::USUAL };
    /// Of a plan.
    const PLAN: Self = Self { kinds: &[Kind::Planned], range: Range::Positive, ..Self::FIXED };
}

macro_rules! parameters {
    ($($parameter:ident $name:literal $meaning:literal = $usual:ident { $($field:ident: $value:expr),* })*) => {
        /// A parameter of an agent.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Parameter {
            $(#[doc = $meaning] $parameter,)*
        }

        /// The table.
        pub const PARAMETERS: [Description; Parameter::COUNT] = [$(Description {
            parameter: Parameter::$parameter,
            name: $name,
            meaning: $meaning,
            $($field: $value,)*
            ..Description::$usual
        }),*];

        /// Fewest pieces of a plan; less is a number of pieces for each metre.
pub const FEWEST_PIECES: f64 = 2.0;

impl Parameter {
            /// How many there are.
            pub const COUNT: usize = [$($name),*].len();

            /// All of them, in the order of the table.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$parameter),*];

            /// The draws that belong to their names.
            const DRAWS: [u32; Self::COUNT] = [$(name_hash($name) as u32),*];
        }
    };
}

parameters! {
    Mass "mass" "mass" = BODY { dimension: Dimension::MASS }
    Radius "radius" "radius of the disc that represents the body" = BODY { dimension: Dimension::LENGTH }
    Speed "speed" "driving speed: the speed of undisturbed walking" =
        USUAL { dimension: Dimension::SPEED, limit: TOP_SPEED, kinds: &Kind::ALL }
    Tau "tau" "relaxation time: how fast the velocity returns to the driving velocity" =
        USUAL { dimension: Dimension::TIME, range: Range::Positive }
    A "A" "social force: strength when two bodies touch" =
        USUAL { dimension: Dimension::FORCE, role: Role::Strength }
    B "B" "social force: range" =
        USUAL { dimension: Dimension::LENGTH, range: Range::Positive, role: Role::Reach }
    Lambda "lambda" "weight of agents behind; with 1 all directions count alike" =
        FORCE { range: Range::Share, default: Some(1.0) }
    A2 "A2" "a second social term, such as a weak one with a long range: strength; absent unless set" =
        FORCE { dimension: Dimension::FORCE, default: Some(0.0), role: Role::Strength, shown: Shown::With(Parameter::A2) }
    B2 "B2" "second social term: range" = FORCE {
        dimension: Dimension::LENGTH,
        range: Range::Positive,
        default: Some(1.0),
        role: Role::Reach,
        shown: Shown::With(Parameter::A2)
    }
    Lambda2 "lambda2" "second social term: weight of agents behind" =
        FORCE { range: Range::Share, default: Some(1.0), shown: Shown::With(Parameter::A2) }
    Foresight "foresight" "how far ahead the social force of others is felt where they will be nearest; at most" =
        FORCE { dimension: Dimension::TIME, default: Some(0.0), shown: Shown::UnlessDefault }
    Headway "headway" "time that separates an agent at its driving speed from the one ahead who walks the same way" =
        FORCE { dimension: Dimension::TIME, default: Some(0.0), shown: Shown::UnlessDefault }
    Composure "composure" "share of a push beyond its driving speed that an agent does not follow; as far it stands without noise where it is held up" =
        FORCE { range: Range::Share, default: Some(0.0), shown: Shown::UnlessDefault }
    Oncoming "oncoming" "how much more those who come towards an agent are felt than those who walk along; at 1 twice, and not at all" =
        FORCE { range: Range::Share, default: Some(0.0), shown: Shown::UnlessDefault }
    KeepRight "keep_right" "how far an agent keeps to the right of those who come towards it" =
        FORCE { dimension: Dimension::LENGTH, default: Some(0.0), shown: Shown::UnlessDefault }
    Berth "berth" "gap that an agent with a headway keeps to the one ahead even where both stand" =
        FORCE { dimension: Dimension::LENGTH, default: Some(0.0), shown: Shown::UnlessDefault }
    Follow "follow" "share of the speed of the one ahead that an agent with a headway may have beside what the gap allows" =
        FORCE { range: Range::Share, default: Some(0.0), shown: Shown::UnlessDefault }
    Abreast "abreast" "distance at which members of a group with attraction walk side by side; at 0 they follow each other a metre apart" =
        FORCE { dimension: Dimension::LENGTH, default: Some(0.0), changeable: false, shown: Shown::UnlessDefault }
    Aside "aside" "how much farther than its radius the way of an agent keeps from corners where there is room" =
        FORCE { dimension: Dimension::LENGTH, default: Some(0.0), changeable: false, shown: Shown::UnlessDefault }
    Walls "walls" "how strongly barriers are felt, as a share of the social force" =
        FORCE { default: Some(1.0), shown: Shown::UnlessDefault }
    Hold "hold" "largest speed at which an agent that stands returns to its place" =
        USUAL { dimension: Dimension::SPEED, limit: TOP_SPEED, default: Some(0.3), shown: Shown::UnlessDefault }
    K1 "k1" "body compression, in contact only" = FIXED { dimension: Dimension::STIFFNESS }
    K2 "k2" "sliding friction, in contact only" = FIXED { dimension: Dimension::FRICTION }
    Noise "noise" "standard deviation that each velocity component reaches in equilibrium, whatever the step" =
        USUAL { dimension: Dimension::SPEED, limit: TOP_SPEED, default: Some(0.0), kinds: &Kind::NOISY }
    Attention "attention" "share of the social force, of agents and of walls, that the agent feels. Contact forces are not reduced" =
        USUAL { range: Range::Share, default: Some(1.0), shown: Shown::UnlessDefault }
    LimitSpeed "limit speed" "largest speed of a plan" = PLAN { dimension: Dimension::SPEED, limit: TOP_SPEED }
    LimitAlong "limit acceleration along" "largest acceleration of a plan along the way" =
        PLAN { dimension: Dimension::ACCELERATION, default: Some(0.8) }
    LimitAcross "limit acceleration across" "largest acceleration of a plan across the way" =
        PLAN { dimension: Dimension::ACCELERATION, default: Some(1.6) }
    Spread "spread" "standard deviation of the speeds of a plan around the preferred one, as a share of it" =
        PLAN { range: Range::NotNegative, default: Some(0.15) }
    Corner "corner" "largest turning radius of a plan at a corner" =
        PLAN { range: Range::NotNegative, dimension: Dimension::LENGTH, default: Some(1.5) }
    Pieces "pieces" "in how many pieces the acceleration of a plan is constant (m0); below 2, how many for each metre" = PLAN { range: Range::Pieces }
    Replan "replan" "distance from the plan at which a new one is made" =
        PLAN { dimension: Dimension::LENGTH, default: Some(1.0) }
    Height "height" "stature of a walker that steps" =
        BODY { dimension: Dimension::LENGTH, limit: TALLEST, kinds: &[Kind::Stepped] }
    TimeGap "time_gap" "collision-free speed model: time in which an agent at its speed reaches the one ahead, at least" =
        SPEEDS { dimension: Dimension::TIME, range: Range::Positive, default: Some(1.0) }
    Swerve "swerve" "collision-free speed model: how strongly another one turns the direction where both touch" =
        SPEEDS { default: Some(8.0) }
    SwerveRange "swerve_range" "collision-free speed model: range of that" =
        SPEEDS { dimension: Dimension::LENGTH, range: Range::Positive, default: Some(0.1), role: Role::Reach }
    WallSwerve "wall_swerve" "collision-free speed model: how strongly a wall that is touched turns the direction" =
        SPEEDS { default: Some(5.0) }
    WallRange "wall_range" "collision-free speed model: range of that" =
        SPEEDS { dimension: Dimension::LENGTH, range: Range::Positive, default: Some(0.02), role: Role::Reach }
}

impl Parameter {
    /// Those of how people treat each other beyond the social force; without any of them a scene costs less.
    pub const MANNERS: [Self; 5] =
        [Self::Composure, Self::Oncoming, Self::KeepRight, Self::Berth, Self::Follow];

    /// Its row.
    pub const fn description(self) -> &'static Description {
        const TABLE: &[Description; Parameter::COUNT] = &PARAMETERS;
        &TABLE[self as usize]
    }

    /// Its name in a scenario.
    pub const fn name(self) -> &'static str {
        self.description().name
    }

    /// Its unit; empty for a pure number.
    pub fn unit(self) -> String {
        self.description().dimension.to_string()
    }

    /// The number of the draw that belongs to its name.
    pub const fn draw(self) -> u32 {
        Self::DRAWS[self as usize]
    }

    /// The parameters of a kind.
    pub fn of_kind(kind: Kind) -> impl Iterator<Item = Self> + Clone {
        Self::ALL.into_iter().filter(move |parameter| parameter.description().kinds.contains(&kind))
    }

    /// The parameter of this name, of any kind.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// The parameters that a state of a behaviour may change.
    pub fn changeable() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|parameter| parameter.description().changeable)
    }

    /// The parameter of this name, if a state of a behaviour may change it.
    pub fn changeable_of(name: &str) -> Option<Self> {
        Self::changeable().find(|parameter| parameter.name() == name)
    }

    /// Whether an agent can move with this value, SI units.
    pub fn allows(self, value: f64) -> bool {
        value.is_finite()
            && match self.description().range {
                Range::Positive => value > 0.0,
                Range::NotNegative => value >= 0.0,
                Range::Share => (0.0..=1.0).contains(&value),
                Range::Pieces if value < FEWEST_PIECES => value > 0.0,
                Range::Pieces => value <= 64.0 && value.fract() == 0.0,
            }
    }

    /// Why a law cannot be its: all values that the law can draw must be possible.
    pub fn refuses(self, law: &Law) -> Option<String> {
        let Description { name, range, limit, .. } = self.description();
        let (low, high) = law.bounds();
        let constant = law.constant().is_some();
        let truncate = if constant { "" } else { "; truncate the distribution: `… in lo .. hi`" };
        match range {
            Range::Positive if low < 0.0 || (constant && low == 0.0) => {
                Some(format!("`{name}` must be positive{truncate}"))
            }
            Range::NotNegative | Range::Share if low < 0.0 => {
                Some(format!("`{name}` cannot be negative{truncate}"))
            }
            Range::Pieces if low < FEWEST_PIECES && (low < 0.0 || high >= FEWEST_PIECES) => {
                Some(format!("`{name}` must be more than 0 and less than 2 for each metre{truncate}"))
            }
            Range::Pieces if low >= FEWEST_PIECES && (high > 64.0 || !law.is_whole()) => {
                Some(format!("`{name}` must be a whole number from 2 to 64"))
            }
            Range::Share if high > 1.0 => Some(format!("`{name}` must be between 0 and 1{truncate}")),
            _ if low > *limit => {
                let unit = self.unit();
                Some(format!(
                    "`{name}` exceeds {limit} {unit}, the limit for a person; every trial would diverge"
                ))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_parameters() {
        for (at, row) in PARAMETERS.iter().enumerate() {
            assert_eq!(row.parameter as usize, at);
            assert_eq!(Parameter::named(row.name), Some(row.parameter));
            assert!(row.default.is_none_or(|value| row.parameter.allows(value)), "{}", row.name);
        }
    }
}
