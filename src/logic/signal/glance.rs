//! Short questions over few states: what each state is, known beforehand, and the verdict by the monitor's own rule.

use super::direct::{Direct, Question, Stay};
use super::{SignalMonitor, Way};
use crate::base::instant::Instant;
use crate::logic::flat::Sort;
use crate::logic::present::Present;

/// A monitor that is one until over present states, by state and not by trial.
#[derive(Clone, Debug)]
pub struct Glance {
    present: Present,
    direct: Direct,
    horizon: Instant,
}

impl SignalMonitor {
    /// The monitor as a glance, if it is one until (or F, G, W) over present states and watches no implication.
    pub fn glance(&self) -> Option<Glance> {
        match &self.way {
            Way::Direct(direct)
                if self.watched.is_empty() && matches!(direct.question, Question::Until { .. }) =>
            {
                Some(Glance { present: self.present.clone(), direct: direct.clone(), horizon: self.horizon })
            }
            _ => None,
        }
    }
}

impl Glance {
    /// What a state with these atoms and signals is for it.
    pub fn sort(&mut self, atoms: &[bool], signals: &[f64]) -> Sort {
        self.present.read(atoms, signals);
        match self.direct.question {
            Question::Until { first, second, .. } => Sort {
                hold: first.is_none_or(|probe| probe.is(&self.present)),
                goal: second.is(&self.present),
            },
            Question::Fold { .. } | Question::Time { .. } => Sort { hold: false, goal: false },
        }
    }

    /// A state that neither reaches the goal nor fails what must be so decides nothing before this time, s.
    pub fn quiet_until(&self) -> f64 {
        let (to, horizon) = (self.direct.to.seconds, self.horizon.seconds);
        if to < horizon { to } else { horizon }
    }

    /// The verdict, if it falls in a state that lasts from `since` to before `end`, s (infinite where it lasts
    /// beyond the horizon), and did not fall before.
    #[inline]
    pub fn verdict(&self, sort: Sort, since: f64, end: f64) -> Option<bool> {
        let end = if end > self.horizon.seconds { f64::INFINITY } else { end };
        match self.direct.question {
            Question::Until { weak, negated, .. } => {
                let stay = Stay { start: since.into(), end: Instant::from(end) };
                let (truth, _) = stay.until(sort, (self.direct.from, self.direct.to), weak)?;
                Some(truth != negated)
            }
            Question::Fold { .. } | Question::Time { .. } => None,
        }
    }
}
