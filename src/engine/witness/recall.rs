//! What decided a trial in continuous time: it is run again to see when it was decided, and what changed there, or how long it
//! had been as it was.

use crate::base::random::TrialKey;
use crate::compile::study::Part;
use crate::engine::answer::words;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::checkpoints::Checkpoints;
use crate::engine::witness::grounds::{Asked, copies, each, grounds};
use crate::kernel::process::ViewReadings;
use crate::kernel::{End, Run, State};
use crate::logic::Root;
use crate::logic::{Reading, open_atoms};
use crate::model::{AgentId, Bool, Set};
use crate::trials::budget::Budget;
use std::sync::Arc;

/// Most atoms that are named.
const NAMED: usize = 3;
/// Most conditions that are told apart of those that the atoms are made of.
const MOST_PARTS: usize = 1_000;
/// Jumps between two looks at the clock.
const CLOCK_EVERY: u64 = 1 << 12;
/// Most moments that are kept of a trial.
const MOST_KEPT: usize = 64;

/// When a trial was decided, s, the value of a metric, SI, and what decided it; in words, empty where it was time
/// alone. `unit` is that of a metric. None where the time is over.
pub(super) fn decision(
    prepared: &PreparedWorld,
    column: usize,
    (index, seed): (u64, u64),
    unit: &str,
    budget: &Budget,
) -> Option<(f64, Option<f64>, String)> {
    let (tree, clock) = (&prepared.tree, prepared.program.scenario.clock);
    let used = match prepared.columns[column] {
        Root::Formula(root) => match open_atoms(tree, root, prepared.horizon, clock).ok()? {
            Some(atoms) => atoms.into_iter().map(|atom| atom.0 as usize).collect(),
            None => return Some((0.0, None, "its value does not depend on the trial".to_owned())),
        },
        _ => prepared.atoms_of(column),
    };
    let parts = parts(prepared, &used);
    let view = prepared.view_beside(column, &parts);
    let mut past = Past { at: f64::INFINITY, parts, ..Past::default() };
    // A monitor knows only later that an earlier moment decided: from what is kept, that moment is made again.
    let mut kept: Checkpoints<(State, Past)> = Checkpoints::new(MOST_KEPT);
    let mut monitor = prepared.signal_monitor(column).ok()?;
    let (mut run, _) = Run::of(&prepared.program, TrialKey { seed, index, branch: 0 }.into()).ok()?;
    let mut seen = ViewReadings::default();
    for jumps in 0.. {
        if jumps % CLOCK_EVERY == CLOCK_EVERY - 1 && budget.is_late() {
            return None;
        }
        let state = run.state();
        view.look(state, &mut seen);
        let (atoms, signals) = view.of(state, &mut seen, 0);
        let now = state.clocks.instant(0);
        if monitor.jump(now, atoms, signals).is_some() {
            break;
        }
        past.see(now.seconds, atoms, signals);
        kept.offer(jumps, || (state.clone(), past.clone()));
        match run.next_state() {
            Ok(_) => {}
            Err(End::Horizon) => {
                monitor.finish();
                break;
            }
            Err(_) => break,
        }
    }
    let at = monitor.decided_at();
    let horizon = clock.seconds(prepared.horizon);
    // Monitors round times of jumps by less than this, some units in the last place.
    let slack = 1e-15 * horizon;
    let (_, (state, past)) = kept.last(|_, (_, past)| past.last <= at + slack)?;
    let (mut run, mut past) = (Run::from_state(&prepared.program, state), Past { at: at + slack, ..past });
    while let Ok(state) = run.next_state() {
        view.look(state, &mut seen);
        let (atoms, signals) = view.of(state, &mut seen, 0);
        if !past.see(state.clocks.instant(0).seconds, atoms, signals) {
            break;
        }
    }
    // The time of the row that shows it.
    let at = if (at - past.last).abs() <= slack { past.last } else { at };
    // Only a time that does not come lies beyond the horizon, and that is known only there.
    let is_time = matches!(prepared.columns[column], Root::Metric(term) if prepared.tree.is_time_until(term))
        && horizon - at <= slack;
    // What changed then closed the case; else it was that nothing changed any more.
    let changed =
        |k: &usize| past.atoms.get(*k).is_some_and(|(_, since)| since.is_some_and(|s| at - s <= slack));
    let closing: Vec<usize> = used.iter().copied().filter(changed).collect();
    let what = match (closing.as_slice(), monitor.reading()) {
        ([], Some(Reading::Truth(_))) => past.lasting(prepared, column, &used),
        ([], _) if used.len() != 1 => String::new(),
        ([], _) => past.named(prepared, &used),
        (closing, _) => past.named(prepared, closing),
    };
    match monitor.reading() {
        Some(Reading::Value(value)) if value == f64::INFINITY && is_time => {
            Some((at, Some(value), "not within the horizon".to_owned()))
        }
        Some(Reading::Value(value)) => {
            let value_text = words::brief(value, unit);
            // A condition that comes true gives a time that is finite.
            let text = if what.is_empty() || !value.is_finite() {
                value_text
            } else {
                format!("{value_text}, when {what}")
            };
            Some((at, Some(value), text))
        }
        _ if what.is_empty() => Some((at, None, "the bound ended".to_owned())),
        _ => Some((at, None, what)),
    }
}

/// How a condition is told: as it is, or how long it has been so, from a time on if it was ever another.
#[derive(Clone, Copy)]
enum Told {
    Now,
    Lasting(Option<f64>),
}

/// What was known at a moment.
#[derive(Clone, Default)]
struct Past {
    /// The moment, s.
    at: f64,
    /// The last jump up to it, s.
    last: f64,
    /// The truth of each atom before that jump, and since when, if it was ever another; none before the first instant is over.
    before: Vec<(bool, Option<f64>)>,
    /// The same after it.
    atoms: Vec<(bool, Option<f64>)>,
    /// The value of each signal.
    signals: Vec<f64>,
    /// What the atoms are made of. Their truths come after those of the atoms.
    parts: Vec<Bool>,
}

/// What the atoms of a column are made of, each once: conditions that join no others.
fn parts(prepared: &PreparedWorld, used: &[usize]) -> Vec<Bool> {
    let mut open: Vec<&Bool> = used.iter().rev().filter_map(|k| prepared.atoms.get(*k)).collect();
    let mut found: Vec<Bool> = Vec::new();
    while let Some(condition) = open.pop() {
        match condition {
            Bool::Not(inner) => open.push(inner),
            Bool::And(list) | Bool::Or(list) => open.extend(list.iter().rev()),
            Bool::Iff(a, b) => open.extend([&**b, &**a]),
            Bool::Constant(_) => {}
            other if found.contains(other) => {}
            // So many are not told apart.
            _ if found.len() == MOST_PARTS => return Vec::new(),
            other => found.push(other.clone()),
        }
    }
    found
}

impl Asked for Past {
    fn holds(&self, condition: &Bool) -> bool {
        match condition {
            Bool::Constant(value) => *value,
            Bool::Not(inner) => !self.holds(inner),
            Bool::And(list) => list.iter().all(|one| self.holds(one)),
            Bool::Or(list) => list.iter().any(|one| self.holds(one)),
            Bool::Iff(a, b) => self.holds(a) == self.holds(b),
            other => self.part(other).is_some_and(|(holds, _)| holds),
        }
    }

    fn is_late(&self) -> bool {
        false
    }

    /// In continuous time there are no people.
    fn first(&self, _: &Set, _: &Bool, _: bool) -> Option<AgentId> {
        None
    }
}

impl Past {
    /// From `now` on these values hold. False once that is later than the moment.
    fn see(&mut self, now: f64, atoms: &[bool], signals: &[f64]) -> bool {
        if now > self.at {
            return false;
        }
        if now > self.last {
            self.before.clone_from(&self.atoms);
        }
        self.last = now;
        // What lasts no time is as if it had not been: a change back within an instant is none.
        let known = |(k, truth): (usize, &bool)| match self.before.get(k) {
            None => (*truth, None),
            Some(before) if before.0 == *truth => *before,
            Some(_) => (*truth, Some(now)),
        };
        self.atoms = atoms.iter().enumerate().map(known).collect();
        self.signals.clear();
        self.signals.extend_from_slice(signals);
        true
    }

    /// The truth of a condition that joins no others, and since when, if it was ever another.
    fn part(&self, condition: &Bool) -> Option<(bool, Option<f64>)> {
        let at = self.parts.iter().position(|part| part == condition)?;
        let first = self.atoms.len().checked_sub(self.parts.len())?;
        self.atoms.get(first + at).copied()
    }

    /// Since when it is surely as it is: since the last of its parts changed.
    fn since(&self, condition: &Bool) -> Option<f64> {
        match condition {
            Bool::Constant(_) => None,
            Bool::Not(inner) => self.since(inner),
            Bool::And(list) | Bool::Or(list) => {
                list.iter().filter_map(|one| self.since(one)).reduce(f64::max)
            }
            Bool::Iff(a, b) => [self.since(a), self.since(b)].into_iter().flatten().reduce(f64::max),
            other => self.part(other)?.1,
        }
    }

    /// What decides an atom, in words, and whose it is; `lasting` says since when, and nothing where that is no reason
    /// for what began at `since`.
    fn because(
        &self,
        prepared: &PreparedWorld,
        atom: usize,
        (truth, lasting): (bool, Told),
    ) -> Option<(Vec<String>, String)> {
        if self.parts.is_empty() {
            return None;
        }
        let scenario = &prepared.program.scenario;
        let text = prepared.texts.atoms.get(atom)?;
        let mut owners: Vec<String> = Vec::new();
        let mut said: Vec<String> = Vec::new();
        match prepared.texts.parts.get(&(atom as u32)) {
            None => owners = copies(scenario, (prepared.atoms.get(atom)?, truth), false, self),
            Some(part) => {
                let found = grounds(part, truth, self)?;
                let parts: Vec<&Part> = found.iter().map(|ground| ground.part).collect();
                let texts = prepared.texts.words(&parts, &|_, _| None)?;
                for (ground, words) in found.iter().zip(texts) {
                    let condition = ground.condition();
                    let is_part = !std::ptr::eq(ground.part, Arc::as_ptr(part));
                    owners.extend(copies(scenario, (&condition, ground.truth), is_part, self));
                    let is_whole = words == *text;
                    match lasting {
                        _ if is_whole => {}
                        Told::Now => said.push(words::condition((&words, ground.truth))),
                        Told::Lasting(since) => {
                            let own = self.since(&condition);
                            // What came later is no reason, nor what changed for what never did.
                            let is_later = |own: f64| since.is_none_or(|since| own > since);
                            // Of several parts nobody knows which of them it was.
                            if own.is_some_and(|own| is_later(own) || !is_single(&condition)) {
                                return None;
                            }
                            said.push(lasted(&words, ground.truth, own));
                        }
                    }
                }
            }
        }
        let owners = each(owners);
        let names = if owners.is_empty() { String::new() } else { format!(": {}", owners.join(", ")) };
        Some((said, names))
    }

    /// Atoms and their truth.
    fn named(&self, prepared: &PreparedWorld, atoms: &[usize]) -> String {
        let word = |k: &usize| {
            let text = prepared.texts.atoms.get(*k).map_or("", String::as_str);
            let holds = self.atoms.get(*k).is_some_and(|(holds, _)| *holds);
            let (said, names) = self.because(prepared, *k, (holds, Told::Now)).unwrap_or_default();
            words::because((text, holds), &said) + &names
        };
        atoms.iter().take(NAMED).map(word).collect::<Vec<_>>().join(", ")
    }

    /// How long the atoms have been as they are, those that changed last first; where there are none, the signals.
    fn lasting(&self, prepared: &PreparedWorld, column: usize, atoms: &[usize]) -> String {
        let mut known: Vec<(usize, bool, Option<f64>)> = atoms
            .iter()
            .filter_map(|&k| self.atoms.get(k).map(|&(holds, since)| (k, holds, since)))
            .collect();
        let time = |since: Option<f64>| since.unwrap_or(-1.0);
        known.sort_by(|a, b| time(b.2).total_cmp(&time(a.2)));
        let mut said: Vec<String> = known
            .iter()
            .map(|(k, holds, since)| {
                let text = prepared.texts.atoms.get(*k).map_or("", String::as_str);
                let (because, _) =
                    self.because(prepared, *k, (*holds, Told::Lasting(*since))).unwrap_or_default();
                let said = lasted(text, *holds, *since);
                if because.is_empty() { said } else { format!("{said} because {}", because.join(" and ")) }
            })
            .collect();
        if said.is_empty() {
            let value = |k: usize| {
                let (text, dimension) = prepared.texts.signals.get(k)?;
                Some(format!("`{text}` is {}", words::brief(*self.signals.get(k)?, &dimension.to_string())))
            };
            said = prepared.signals_of(column).into_iter().filter_map(value).collect();
        }
        said.truncate(NAMED);
        said.join(", ")
    }
}

/// Whether a condition joins no others.
fn is_single(condition: &Bool) -> bool {
    match condition {
        Bool::Not(inner) => is_single(inner),
        Bool::And(_) | Bool::Or(_) | Bool::Iff(..) => false,
        _ => true,
    }
}

/// How long a condition has been as it is.
fn lasted(text: &str, holds: bool, since: Option<f64>) -> String {
    match (since, holds) {
        (Some(since), _) => {
            format!("{} since {} s", words::condition((text, holds)), words::brief(since, ""))
        }
        (None, true) => format!("`{text}` was true throughout"),
        (None, false) => format!("`{text}` was never true"),
    }
}
