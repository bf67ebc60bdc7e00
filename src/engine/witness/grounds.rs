//! Why a condition of one state is as it is: the smallest parts of it, as they were written, that decide.

use crate::compile::study::{Form, Part};
use crate::model::{AgentId, Bool, Scenario, Set, VariableId};
use std::collections::BTreeSet;

/// How many parts are told; where more decide, it is all of them.
const MOST: usize = 2;

/// A part that decides.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ground<'p> {
    pub(super) part: &'p Part,
    /// Its truth in the state.
    pub(super) truth: bool,
    /// Those of whom it is said, from the outermost quantifier on.
    pub(super) given: Vec<AgentId>,
}

impl Ground<'_> {
    /// The condition itself.
    pub(super) fn condition(&self) -> Bool {
        of_these(self.part.truth(), &self.given)
    }
}

/// What is said of running agents, said of these.
fn of_these(truth: Bool, given: &[AgentId]) -> Bool {
    given.iter().fold(truth, |truth, id| truth.of_member(*id))
}

/// What can be asked of a state.
pub(super) trait Asked {
    /// Whether a condition holds.
    fn holds(&self, condition: &Bool) -> bool;

    /// Whether the time is over.
    fn is_late(&self) -> bool;

    /// The first member of a set of whom a condition, in which it is the running agent, has a truth value.
    fn first(&self, set: &Set, body: &Bool, truth: bool) -> Option<AgentId>;
}

/// The parts that make a condition true or false. None where it is the other in this state, and where the time is over.
pub(super) fn grounds<'p>(part: &'p Part, truth: bool, asked: &impl Asked) -> Option<Vec<Ground<'p>>> {
    Search { asked }.of(part, truth, &[])
}

struct Search<'a, A> {
    asked: &'a A,
}

impl<A: Asked> Search<'_, A> {
    fn holds(&self, part: &Part, given: &[AgentId]) -> bool {
        self.asked.holds(&of_these(part.truth(), given))
    }

    fn of<'p>(&self, part: &'p Part, truth: bool, given: &[AgentId]) -> Option<Vec<Ground<'p>>> {
        if self.asked.is_late() {
            return None;
        }
        let whole = || vec![Ground { part, truth, given: given.to_vec() }];
        // What is not so is told as what it is: nobody may have written the `!`, as in `p => q`.
        if part.is_plain() && !matches!(part.form, Form::Not(_)) {
            return (self.holds(part, given) == truth).then(whole);
        }
        match &part.form {
            Form::Plain(_) => Some(whole()),
            Form::Named(inner) => self.of(inner, truth, given),
            Form::Not(inner) => self.of(inner, !truth, given),
            // A false conjunct, or a true disjunct, is enough; otherwise all of them decide.
            Form::All(list) | Form::Any(list) if matches!(part.form, Form::Any(_)) == truth => {
                let one = list.iter().find(|one| self.holds(one, given) == truth)?;
                self.of(one, truth, given)
            }
            Form::All(list) | Form::Any(list) => {
                let each = list.iter().map(|one| self.of(one, truth, given));
                Some(few(each.collect::<Option<Vec<_>>>()?.concat(), whole))
            }
            Form::Both(a, b) => {
                let (first, second) = (self.holds(a, given), self.holds(b, given));
                if (first == second) != truth {
                    return None;
                }
                let sides = [self.of(a, first, given)?, self.of(b, second, given)?];
                Some(few(sides.concat(), whole))
            }
            Form::Each(set, body) | Form::Someone(set, body)
                if matches!(part.form, Form::Someone(..)) == truth =>
            {
                // The set and what is said of its members stand under the same quantifiers.
                let Bool::Exists(set, condition) =
                    of_these(Bool::Exists(set.clone(), Box::new(body.truth())), given)
                else {
                    return None;
                };
                let id = self.asked.first(&set, &condition, truth)?;
                self.of(body, truth, &[given, &[id]].concat())
            }
            Form::Each(..) | Form::Someone(..) => (self.holds(part, given) == truth).then(whole),
        }
    }
}

/// Those that were found, each once; the whole where they are many.
fn few<'p>(found: Vec<Ground<'p>>, whole: impl Fn() -> Vec<Ground<'p>>) -> Vec<Ground<'p>> {
    let mut kept: Vec<Ground<'p>> = Vec::new();
    for one in found {
        let same = |known: &Ground<'_>| known.truth == one.truth && known.condition() == one.condition();
        if !kept.iter().any(same) {
            kept.push(one);
        }
    }
    if kept.len() > MOST { whole() } else { kept }
}

/// The copies of processes that make a condition true or false: they may be spoken of by a name that they share, as `a` in
/// `forall a in sensor`. Of what `narrowed` says is a part of another, those are told on whom it depends as a whole.
pub(super) fn copies(
    scenario: &Scenario,
    (condition, truth): (&Bool, bool),
    narrowed: bool,
    asked: &impl Asked,
) -> Vec<String> {
    let (mut part, mut truth, mut narrowed) = (condition, truth, narrowed);
    loop {
        part = match part {
            Bool::Not(inner) => {
                truth = !truth;
                inner
            }
            // A false conjunct, or a true disjunct, is enough; otherwise all of them decide.
            Bool::And(list) | Bool::Or(list) if matches!(part, Bool::Or(_)) == truth => {
                let Some(one) = list.iter().find(|one| asked.holds(one) == truth) else { return Vec::new() };
                narrowed = true;
                one
            }
            Bool::And(_) | Bool::Or(_) if narrowed => break,
            Bool::Compare(..) | Bool::Iff(..) => break,
            _ => return Vec::new(),
        };
    }
    let mut read = BTreeSet::new();
    part.reads(&mut read);
    let variables = &scenario.processes.variables;
    let owner = |id: &VariableId| Some(variables.get(id.0 as usize)?.name.rsplit_once('.')?.0.to_owned());
    let mut found: Vec<String> = read.iter().filter_map(owner).collect();
    found.retain(|copy| copy.ends_with(']'));
    let found = each(found);
    // What depends on many of them is about none of them.
    if found.len() > 2 { Vec::new() } else { found }
}

/// Each of some names once, in the order of their mention.
pub(super) fn each<T: PartialEq>(all: Vec<T>) -> Vec<T> {
    let mut kept = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}
