//! Clock and horizon of a world. Where a scenario has errors, an error about a time is reported only if it is certain.

use crate::base::decimal::Decimal;
use crate::base::tick::{Clock, Tick};
use crate::compile::dimension::Dimension;
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// Clock and horizon.
pub(crate) struct Time {
    /// The clock.
    pub(crate) clock: Clock,
    /// Last tick.
    pub(crate) horizon: Tick,
    /// Where horizon and step are written.
    pub(crate) clock_at: Vec<Span>,
    /// Times that ticks of continuous time measure, as far as they can.
    pub(crate) measured: Vec<Decimal>,
    /// Times that ticks of continuous time would have to measure too.
    pub(crate) between: Vec<Decimal>,
}

impl Default for Time {
    fn default() -> Self {
        Self {
            clock: Clock::Steps,
            horizon: Tick(0),
            clock_at: Vec::new(),
            measured: Vec::new(),
            between: Vec::new(),
        }
    }
}

impl Time {
    /// A number of ticks in words.
    pub(crate) fn duration(&self, ticks: u64) -> String {
        match self.clock {
            Clock::Stepped(_) | Clock::Jumps(_) => {
                let seconds = self.clock.seconds(Tick(ticks));
                format!("{} s", (seconds * 1e9).round() / 1e9)
            }
            Clock::Steps if ticks == 1 => "1 step".to_owned(),
            Clock::Steps => format!("{ticks} steps"),
        }
    }

    /// The horizon in words.
    pub(crate) fn whole(&self) -> String {
        self.duration(self.horizon.0)
    }

    /// Dimension of the clock: seconds, or steps where steps have no length.
    pub(crate) fn dimension(&self) -> Dimension {
        if matches!(self.clock, Clock::Steps) { Dimension::STEPS } else { Dimension::TIME }
    }
}

/// How much of a clock is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Told {
    /// Nothing, not even whether there are steps.
    Nothing,
    /// That there are steps of a fixed length in seconds.
    Stepped,
    /// The length of a step.
    Step,
    /// All of it, the horizon too.
    #[default]
    Whole,
}

impl Told {
    /// The knowledge that an error with this code needs.
    pub(crate) fn needed(code: Code) -> Self {
        match code {
            Code::E0502 => Self::Whole,
            Code::E0501 => Self::Step,
            Code::E0503 | Code::E0507 | Code::E0508 => Self::Stepped,
            _ => Self::Nothing,
        }
    }
}

/// Whether a scenario has bodies, which move by steps.
pub(crate) fn has_bodies(file: &ScenarioFile) -> bool {
    file.items.iter().any(|item| match item {
        Item::Agents(_) | Item::Group(_) | Item::Source(_) | Item::Moves(_) | Item::Scene(_) => true,
        Item::Program(decl) => decl.people.is_some(),
        _ => false,
    })
}

/// Whether a scenario has steps of a fixed length in seconds, whatever its processes are.
pub(crate) fn is_stepped(file: &ScenarioFile) -> bool {
    let sets = |item: &Item| matches!(item, Item::Setting { name, .. } if name.name == "step");
    has_bodies(file) || file.items.iter().any(sets)
}
