//! What can be fitted: parameters of a kind, and the spread of headings and speeds around the recorded ones.
//!
//! A search moves on a scale without bounds: the logarithm of the ratio to the start, or, of a share, the logit.

use crate::base::dimension::Dimension;
use crate::base::math;
use crate::model::parameter::Range;
use crate::model::{Agent, Family, Kind, Law, Parameter, Scenario};
use std::f64::consts::PI;
use std::sync::Arc;

/// A search goes no farther from its start: a factor of 400.
const FARTHEST: f64 = 6.0;
/// Where the search for a parameter that is 0 begins, SI units: on a scale of ratios 0 is infinitely far.
const FROM_ZERO: f64 = 0.1;
/// Shares begin this far within their ends.
const WITHIN: f64 = 0.02;
/// Slower people have no heading, m/s; as for the laws of intention (`compile/intention.rs`).
const STANDS: f64 = 0.05;
/// Where the spreads begin unless the model has them: 12 degrees, and 0.15 of the speed.
const SPREADS: [f64; 2] = [12.0 * PI / 180.0, 0.15];
/// The largest speed that a spread gives, m/s.
const FASTEST: f64 = 3.0;

/// A parameter that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fitted {
    /// Of the kind; whatever its law was, the fitted one is constant.
    Parameter(Parameter),
    /// The standard deviation S of `heading = recorded + normal(0 deg, S)`.
    Heading,
    /// The standard deviation S of `speed = recorded * normal(1, S) in 0 m/s .. 3 m/s`.
    Speed,
}

impl Fitted {
    /// All that can be fitted of a kind.
    pub fn of_kind(kind: Kind) -> impl Iterator<Item = Self> {
        let is_plain = |one: &Parameter| {
            one.description().range != Range::Pieces && !matches!(one, Parameter::Speed | Parameter::Mass)
        };
        [Self::Heading, Self::Speed]
            .into_iter()
            .chain(Parameter::of_kind(kind).filter(is_plain).map(Self::Parameter))
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Parameter(one) => one.name(),
            Self::Heading => "heading",
            Self::Speed => "speed",
        }
    }

    /// Its unit as written in a scenario, and the value of the unit in SI.
    pub fn unit(self) -> (String, f64) {
        match self {
            Self::Parameter(one) if one.description().dimension != Dimension::NONE => (one.unit(), 1.0),
            Self::Heading => ("deg".to_owned(), PI / 180.0),
            _ => (String::new(), 1.0),
        }
    }

    const fn is_share(self) -> bool {
        matches!(self, Self::Parameter(one) if matches!(one.description().range, Range::Share))
    }

    /// Where a search begins, SI units: the mean of what the first agent has.
    pub(super) fn start(self, agents: &[Agent]) -> f64 {
        let sd = |law: &Law| match law {
            Law::Random { family: Family::Normal { sd, .. }, .. } => Some(*sd),
            _ => None,
        };
        let of_spread = |value: Option<f64>, usual: f64| value.filter(|sd| *sd > 0.0).unwrap_or(usual);
        let Some(first) = agents.iter().find(|agent| is_moving(agent)).or(agents.first()) else {
            return FROM_ZERO;
        };
        match self {
            Self::Heading => of_spread(sd(&first.start.turn), SPREADS[0]),
            Self::Speed => {
                let speed = first.start.driving().norm();
                let own = sd(&first.body[Parameter::Speed]).filter(|_| first.start.own_speed);
                of_spread(own.map(|sd| sd / speed), SPREADS[1])
            }
            Self::Parameter(one) if self.is_share() => {
                math::at_most(math::at_least(first.body[one].mean(), WITHIN), 1.0 - WITHIN)
            }
            Self::Parameter(one) => of_spread(Some(first.body[one].mean()), FROM_ZERO),
        }
    }

    /// The value at a place of the search, SI units.
    pub fn value(self, start: f64, place: f64) -> f64 {
        let place = math::at_most(math::at_least(place, -FARTHEST), FARTHEST);
        match self {
            _ if self.is_share() => {
                let odds = start / (1.0 - start) * math::exp(place);
                odds / (1.0 + odds)
            }
            Self::Parameter(one) => math::at_most(start * math::exp(place), one.description().limit),
            _ => start * math::exp(place),
        }
    }

    /// Gives everybody who was recorded a value.
    pub(super) fn set(self, scenario: &mut Scenario, value: f64) {
        for agent in scenario.agents.iter_mut().filter(|agent| !agent.start.seen.is_empty()) {
            match self {
                Self::Parameter(one) => Arc::make_mut(&mut agent.body)[one] = Law::Constant(value),
                Self::Heading if is_moving(agent) => {
                    agent.start.turn = normal(0.0, value, (f64::NEG_INFINITY, f64::INFINITY));
                }
                Self::Speed if is_moving(agent) => {
                    let speed = agent.start.driving().norm();
                    let law = normal(speed, value * speed, (0.0, FASTEST));
                    Arc::make_mut(&mut agent.body)[Parameter::Speed] = law;
                    agent.start.own_speed = true;
                }
                _ => {}
            }
        }
    }

    /// The field that has a value, SI units, in the kind or in the people that start from a recording.
    pub fn field(self, value: f64, number: impl Fn(f64) -> String) -> String {
        let (unit, size) = self.unit();
        let value = number(value / size);
        match self {
            Self::Heading => format!("heading = recorded + normal(0 deg, {value} deg)"),
            Self::Speed => format!("speed = recorded * normal(1, {value}) in 0 m/s .. {FASTEST} m/s"),
            Self::Parameter(one) if unit.is_empty() => format!("{} = {value}", one.name()),
            Self::Parameter(one) => format!("{} = {value} {unit}", one.name()),
        }
    }
}

fn is_moving(agent: &Agent) -> bool {
    !agent.start.seen.is_empty() && agent.start.driving().norm() >= STANDS
}

fn normal(mean: f64, sd: f64, (low, high): (f64, f64)) -> Law {
    Law::Random { family: Family::Normal { mean, sd }, low, high }
}
