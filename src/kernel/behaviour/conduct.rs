//! What a behaviour does, made ready: laws to draw from, stages of routes.

use crate::kernel::driver::Drive;
use crate::model::law::Ready;
use crate::model::process::are_weights;
use crate::model::{self, Num, Parameter};

/// What a behaviour does.
#[derive(Clone, Debug)]
pub(super) struct Conduct {
    pub(super) modes: Vec<Mode>,
    /// Most timed transitions of a state: so many draws belong to each entry.
    pub(super) delays: u32,
    pub(super) advice: Vec<(Num, bool)>,
}

/// A state.
#[derive(Clone, Debug)]
pub(super) struct Mode {
    pub(super) changes: Vec<(Parameter, Amount)>,
    /// First stage of its route.
    pub(super) route: Option<u32>,
    pub(super) exits: Vec<Exit>,
}

/// The value of a changed parameter.
#[derive(Clone, Debug)]
pub(super) enum Amount {
    Computed(Num),
    Drawn(Ready),
}

/// A transition.
#[derive(Clone, Debug)]
pub(super) struct Exit {
    pub(super) trigger: Trigger,
    pub(super) targets: Vec<(Num, u32)>,
}

/// When a transition fires.
#[derive(Clone, Debug)]
pub(super) enum Trigger {
    After {
        law: Ready,
        /// Which of the timed transitions of its state it is.
        number: u32,
    },
    When(u32),
}

impl Conduct {
    /// Makes what a declared behaviour does ready; its routes are added to those of `drive`.
    pub(super) fn new(declared: &model::Behaviour, conduct: &model::Conduct, drive: &mut Drive) -> Self {
        let mut delays = 0;
        let modes = conduct
            .states
            .iter()
            .zip(&declared.states)
            .map(|(mode, name)| {
                let mut number = 0;
                let exits = mode
                    .transitions
                    .iter()
                    .map(|transition| {
                        let trigger = match &transition.trigger {
                            model::Trigger::When(guard) => Trigger::When(*guard),
                            model::Trigger::After(law) => {
                                number += 1;
                                Trigger::After { law: law.ready(), number: number - 1 }
                            }
                        };
                        Exit { trigger, targets: transition.targets.clone() }
                    })
                    .collect();
                delays = delays.max(number);
                let changes = mode.changes.iter().map(|(parameter, amount)| {
                    let amount = match amount {
                        model::Amount::Computed(num) => Amount::Computed(num.clone()),
                        model::Amount::Drawn(law) => Amount::Drawn(law.ready()),
                    };
                    (*parameter, amount)
                });
                Mode {
                    changes: changes.collect(),
                    route: mode
                        .route
                        .as_ref()
                        .map(|route| drive.detour(route, &format!("{}.{name}", declared.name))),
                    exits,
                }
            })
            .collect();
        Self { modes, delays, advice: conduct.advice.clone() }
    }
}

impl Mode {
    /// Whether an agent is different in it.
    pub(super) fn changes_something(&self) -> bool {
        !self.changes.is_empty() || self.route.is_some()
    }
}

/// One of several by their weights, over the values of variables; `None` where these are no probabilities. A number
/// is drawn only where there is a choice.
pub(super) fn pick<T: Copy>(
    choices: &[(Num, T)],
    variables: &[f64],
    uniform: impl FnOnce() -> f64,
) -> Option<T> {
    if let [(Num::Constant(_), only)] = choices {
        return Some(*only);
    }
    let weights: Option<Vec<f64>> = choices.iter().map(|(weight, _)| weight.evaluate(variables)).collect();
    let weights = weights.filter(|weights| are_weights(weights.iter().copied()))?;
    let uniform = uniform();
    let mut end = 0.0;
    let mut last = None;
    for (&weight, (_, choice)) in weights.iter().zip(choices) {
        end += weight;
        if weight > 0.0 {
            // Rounding leaves no gap after the last one that can be.
            last = Some(*choice);
            if uniform < end {
                break;
            }
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_follows_its_weights() {
        let c = Num::Constant;
        let choices = [(c(0.0), 'a'), (c(0.25), 'b'), (c(0.75), 'c'), (c(0.0), 'd')];
        let at = |u: f64| pick(&choices, &[], || u);
        assert_eq!(
            [at(0.1), at(0.2499), at(0.25), at(0.999_999)],
            [Some('b'), Some('b'), Some('c'), Some('c')]
        );
        assert_eq!(pick(&[(c(0.5), 'a'), (c(0.6), 'b')], &[], || 0.5), None);
        assert_eq!(pick(&[(c(1.0), 'a')], &[], || unreachable!("no choice, no draw")), Some('a'));
    }
}
