//! Errors that some trial could run into, found before any does.
//!
//! Where processes depend on nothing but themselves and have few states, all states that a trial can reach
//! are walked through, breadth first, as far as the horizon; processes that read nothing of each other apart, so that
//! what is wrong with one hides nothing of another. Where there are too many states, or agents or delays come in, errors
//! show while running.

use crate::base::tick::Clock;
use crate::compile::context::{Context, clock::Told};
use crate::compile::lower::weight::Weight;
use crate::compile::process::parts::{Part, Scope, Writing};
use crate::model::process::wrong_weights;
use crate::model::{Command, Domain, Process, Processes, Timing, Variable, VariableId};
use crate::syntax::ast::Broken;
use crate::syntax::ast::process as ast;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// Most states that are looked at.
const MOST_STATES: usize = 4096;
/// Most successors that are computed.
const MOST_SUCCESSORS: usize = 1 << 17;
/// Most values of variables that are kept at a time, of known states or of the successors of one.
const MOST_VALUES: usize = 1 << 22;
/// Most parts of expressions that are computed in all states of all processes: a fraction of a second.
const MOST_LOOKS: u64 = 1 << 25;
/// As many parts of expressions a successor counts as, which is looked for among those known, besides its values.
const LOOKS_OF_SUCCESSOR: u64 = 16;
/// Most variables that are shown of a state.
const MOST_SHOWN: usize = 8;

/// Where a command and its updates are written.
pub(crate) struct Lines {
    pub(crate) command: Span,
    /// Of each branch.
    updates: Vec<Vec<Span>>,
    /// Whether its rate or its branches have an error, so its successor states are unknown.
    is_broken: bool,
}

impl Lines {
    pub(crate) fn of(command: &ast::Command) -> Self {
        let updates = |branch: &ast::Branch| {
            branch.updates.iter().map(|update| update.target.span.to(update.value.span)).collect()
        };
        Self {
            command: command.span,
            updates: command.branches.iter().map(updates).collect(),
            is_broken: false,
        }
    }

    pub(crate) fn broken(command: &ast::Command) -> Self {
        Self { is_broken: true, ..Self::of(command) }
    }
}

/// A command of a part: of which member, which one.
type Which = (usize, usize);

/// An error and its place.
struct Wrong {
    code: Code,
    which: Which,
    span: Span,
    what: String,
    hint: Option<&'static str>,
}

/// There are too many states, or they depend on more than variables.
struct Unknown;

/// The errors, each where it was first found.
struct Findings<'p> {
    variables: &'p [Variable],
    /// Code and place of what was found: the copies of a process share them.
    known: BTreeSet<(Code, u32, u32)>,
    list: Vec<Diagnostic>,
}

impl Findings<'_> {
    fn add(&mut self, wrong: Wrong, part: &Part<'_>, state: &[i64]) {
        if self.known.insert((wrong.code, wrong.span.start, wrong.span.end)) {
            self.list.push(wrong.diagnostic(self.variables, part, state));
        }
    }
}

/// Reports what goes wrong in some state that can be reached. On that way a trial ends: what could follow is not
/// looked at.
pub(crate) fn check_reachable(context: &mut Context<'_>, processes: &Processes, writings: &[Writing]) {
    if context.sink.told < Told::Whole || may_race(context) {
        return;
    }
    let mut findings = Findings { variables: &processes.variables, known: BTreeSet::new(), list: Vec::new() };
    let mut looks = MOST_LOOKS;
    // A part reads no variables but its own, which each of its states sets.
    let mut values: Vec<f64> = processes.variables.iter().map(|v| v.initial).collect();
    // Between steps, too, processes may jump, as often as they like.
    for jumps in [false, true] {
        if !jumps && context.time.clock.is_jumps() {
            continue;
        }
        let steps = if jumps { u64::MAX } else { context.time.horizon.0 };
        // Who reads more than variables hides nothing of those that do not.
        for closed in [false, true] {
            let mut walked = true;
            for part in Part::of(processes, writings, Scope { jumps, closed }) {
                let mut walk = Walk { processes, part: &part, jumps, looks: &mut looks };
                walked &= walk.through(steps, &mut values, &mut findings).is_ok();
            }
            if walked {
                break;
            }
        }
    }
    for found in findings.list {
        context.note(found);
    }
}

/// Whether what was not read may have said that processes jump where they seem to step.
fn may_race(context: &Context<'_>) -> bool {
    let is_timed =
        |item: &&Broken| item.words.iter().any(|word| ["at", "after", "process"].contains(&word.as_str()));
    matches!(context.time.clock, Clock::Steps) && context.torn.iter().any(is_timed)
}

/// A walk through the states of a part.
struct Walk<'w, 'p> {
    processes: &'p Processes,
    part: &'w Part<'p>,
    jumps: bool,
    /// How many more parts of expressions are computed.
    looks: &'w mut u64,
}

impl Walk<'_, '_> {
    /// Walks through the states that can be reached in so many steps, breadth first; `Err` where not all are known.
    fn through(
        &mut self,
        steps: u64,
        values: &mut [f64],
        findings: &mut Findings<'_>,
    ) -> Result<(), Unknown> {
        let own = &self.part.variables;
        let initial: Vec<i64> = own.iter().map(|v| self.processes.variables[*v].initial as i64).collect();
        let processes = self.part.members.iter().map(|(process, _)| Weight::of_process(process).nodes());
        let of_state = processes.fold(own.len() as u64 + 1, u64::saturating_add);
        let mut known = BTreeSet::from([initial.clone()]);
        let mut front = vec![initial];
        let mut made = 0;
        for _ in 0..steps {
            let mut next_front = Vec::new();
            for state in std::mem::take(&mut front) {
                self.count(of_state)?;
                for (variable, value) in own.iter().zip(&state) {
                    values[*variable] = *value as f64;
                }
                let mut wrong = Vec::new();
                let successors = if self.jumps {
                    self.jumped(values, &state, &mut wrong)
                } else {
                    self.successors(values, &state, &mut wrong)
                };
                for wrong in wrong {
                    findings.add(wrong, self.part, &state);
                }
                let successors = successors?;
                made += successors.len();
                self.count(successors.len() as u64 * (own.len() as u64 + LOOKS_OF_SUCCESSOR))?;
                for next in successors {
                    if !known.contains(&next) {
                        known.insert(next.clone());
                        next_front.push(next);
                    }
                }
                let kept = |states: usize| states.saturating_mul(own.len());
                let many = known.len() > MOST_STATES || made > MOST_SUCCESSORS;
                if many || kept(known.len()) > MOST_VALUES {
                    return Err(Unknown);
                }
            }
            if next_front.is_empty() {
                return Ok(());
            }
            front = next_front;
        }
        Ok(())
    }

    /// Counts parts of expressions, or what takes as long as these.
    fn count(&mut self, looks: u64) -> Result<(), Unknown> {
        *self.looks = self.looks.checked_sub(looks).ok_or(Unknown)?;
        Ok(())
    }

    /// Where a variable of the part is in its states.
    fn place(&self, variable: usize) -> usize {
        self.part.variables.partition_point(|own| *own < variable)
    }

    /// The states that can follow: none by ways on which a trial ends.
    fn successors(
        &self,
        values: &[f64],
        state: &[i64],
        wrong: &mut Vec<Wrong>,
    ) -> Result<Vec<Vec<i64>>, Unknown> {
        let mut ways = Vec::new();
        for (member, (process, writing)) in self.part.members.iter().enumerate() {
            let known = (self.processes.variables.as_slice(), values);
            ways.push(changes((member, process, &writing.lines), known, wrong)?);
        }
        // Whatever the others do, the trial ends.
        if ways.iter().any(Vec::is_empty) {
            return Ok(Vec::new());
        }
        let mut joint: Vec<Vec<i64>> = vec![state.to_vec()];
        for changes in ways {
            if let [only] = changes.as_slice() {
                for after in &mut joint {
                    for &(variable, value) in only {
                        after[self.place(variable)] = value;
                    }
                }
                continue;
            }
            let ways = joint.len().saturating_mul(changes.len());
            if ways > MOST_SUCCESSORS || ways.saturating_mul(state.len()) > MOST_VALUES {
                return Err(Unknown);
            }
            joint = joint
                .iter()
                .flat_map(|before| changes.iter().map(|change| self.after(before, change)))
                .collect();
        }
        Ok(joint)
    }

    /// The states that can follow where processes jump one at a time.
    fn jumped(
        &self,
        values: &[f64],
        state: &[i64],
        wrong: &mut Vec<Wrong>,
    ) -> Result<Vec<Vec<i64>>, Unknown> {
        let (mut changes, mut ends) = (Vec::new(), false);
        for (member, (process, writing)) in self.part.members.iter().enumerate() {
            for (k, (command, lines)) in process.commands.iter().zip(&writing.lines).enumerate() {
                let Timing::Rate(rate) = &command.timing else { continue };
                if !command.guard.evaluate(values).ok_or(Unknown)? {
                    continue;
                }
                let rate = rate.evaluate(values).ok_or(Unknown)?;
                if !(rate >= 0.0 && rate.is_finite()) {
                    wrong.push(Wrong {
                        code: Code::E0904,
                        which: (member, k),
                        span: lines.command,
                        what: format!("the rate of this command is {rate} /s"),
                        hint: Some("a rate must be finite and not negative; 0 disables the command"),
                    });
                    ends = true;
                } else if rate > 0.0 {
                    let known = (self.processes.variables.as_slice(), values);
                    branches(((member, k), command, lines), known, (&mut changes, wrong))?;
                }
            }
        }
        if ends {
            return Ok(Vec::new());
        }
        if changes.len().saturating_mul(state.len()) > MOST_VALUES {
            return Err(Unknown);
        }
        Ok(changes.iter().map(|change| self.after(state, change)).collect())
    }

    /// The state after a change.
    fn after(&self, before: &[i64], change: &Change) -> Vec<i64> {
        let mut after = before.to_vec();
        for &(variable, value) in change {
            after[self.place(variable)] = value;
        }
        after
    }
}

impl Wrong {
    fn diagnostic(self, variables: &[Variable], part: &Part<'_>, state: &[i64]) -> Diagnostic {
        let error = Diagnostic::error(self.code, self.span, self.what)
            .label(format!("where {}", shown(variables, (part, self.which), state)));
        match self.hint {
            Some(hint) => error.hint(hint),
            None => error,
        }
    }
}

/// A state of a part, as one of its commands sees it: the variables of its process, those that it reads, and others.
fn shown(variables: &[Variable], (part, (member, command)): (&Part<'_>, Which), state: &[i64]) -> String {
    let (process, writing) = part.members[member];
    let mut read = BTreeSet::new();
    process.commands[command].reads(&mut read);
    let rank = |variable: usize| match () {
        () if writing.variables.contains(&variable) => 0,
        () if read.contains(&VariableId(variable as u32)) => 1,
        () => 2,
    };
    let mut seen: Vec<(usize, i64)> = part.variables.iter().copied().zip(state.iter().copied()).collect();
    seen.sort_by_key(|(variable, _)| rank(*variable));
    let word = |(variable, value): &(usize, i64)| {
        let variable = &variables[*variable];
        match variable.domain {
            Domain::Truth => format!("{} = {}", variable.name, *value != 0),
            _ => format!("{} = {value}", variable.name),
        }
    };
    let mut words: Vec<String> = seen.iter().take(MOST_SHOWN).map(word).collect();
    if seen.len() > MOST_SHOWN {
        words.push("…".to_owned());
    }
    words.join(", ")
}

/// Changed variables of one way that a process can take.
type Change = Vec<(usize, i64)>;

/// What one process can do at a step, as far as it is known; nothing where a trial ends by an error whatever is drawn.
fn changes(
    (member, process, lines): (usize, &Process, &[Lines]),
    known: (&[Variable], &[f64]),
    wrong: &mut Vec<Wrong>,
) -> Result<Vec<Change>, Unknown> {
    let mut enabled = Vec::new();
    for (k, (command, lines)) in process.commands.iter().zip(lines).enumerate() {
        if command.guard.evaluate(known.1).ok_or(Unknown)? {
            enabled.push(((member, k), command, lines));
        }
    }
    if let [_, (which, _, second), ..] = enabled.as_slice()
        && !process.choose
    {
        wrong.push(Wrong {
            code: Code::E0901,
            which: *which,
            span: second.command,
            what: format!("two commands of `{}` are enabled at once", process.name),
            hint: Some("make the guards exclude each other, or write `choose` to draw one of them, all equally likely"),
        });
    }
    if enabled.is_empty() {
        return Ok(vec![Vec::new()]);
    }
    let mut all = Vec::new();
    let is_clear = process.choose || enabled.len() == 1;
    for command in enabled {
        branches(command, known, (&mut all, wrong))?;
    }
    if !is_clear {
        all.clear();
    }
    Ok(all)
}

fn branches(
    (which, command, lines): (Which, &Command, &Lines),
    (variables, values): (&[Variable], &[f64]),
    (all, wrong): (&mut Vec<Change>, &mut Vec<Wrong>),
) -> Result<(), Unknown> {
    if lines.is_broken {
        return Ok(());
    }
    let weights: Option<Vec<f64>> = command.branches.iter().map(|b| b.weight.evaluate(values)).collect();
    let weights = weights.ok_or(Unknown)?;
    if let Some(what) = wrong_weights(&weights) {
        wrong.push(Wrong { code: Code::E0902, which, span: lines.command, what, hint: None });
        return Ok(());
    }
    for ((branch, updates), weight) in command.branches.iter().zip(&lines.updates).zip(weights) {
        if weight == 0.0 {
            continue;
        }
        let mut change = Vec::with_capacity(branch.updates.len());
        let before = wrong.len();
        for ((id, value), span) in branch.updates.iter().zip(updates) {
            let value = value.evaluate(values).ok_or(Unknown)?;
            let variable = &variables[id.0 as usize];
            if !variable.domain.contains(value) {
                wrong.push(Wrong {
                    code: Code::E0903,
                    which,
                    span: *span,
                    what: format!("`{}` would become {value}, outside its range", variable.name),
                    hint: Some("add a guard, or widen the range"),
                });
            }
            change.push((id.0 as usize, value as i64));
        }
        if wrong.len() == before {
            all.push(change);
        }
    }
    Ok(())
}
