//! What decided a trial: the atom, comparison or number, and the agents in it.

use super::budget::Budget;
use super::instance::{instantiate_bool, instantiate_num};
use super::subject::Subject;
use super::words;
use crate::base::tick::{Clock, Tick};
use crate::kernel::{Code, Readings, State};
use crate::logic::{
    AtomId, Node, NodeId, Reason, Recording, SignalId, Source, Term, TermId, critical, explain, sides,
    sources,
};
use crate::model::{AgentId, Bool, Num, Scenario, Set, VariableId, Who};
use std::collections::BTreeSet;

/// Most truth values and numbers that are kept of a trial.
const MOST_KEPT: usize = 1 << 27;

/// Truth values and numbers of the states of one trial, state by state.
#[derive(Default)]
pub(super) struct Record {
    atoms: Vec<bool>,
    signals: Vec<f64>,
    /// Atoms and signals of a state.
    width: (usize, usize),
    states: usize,
    full: bool,
}

impl Record {
    /// Keeps what was read of lane 0, as long as there is room.
    pub(super) fn push(&mut self, readings: &Readings) {
        self.full |= self.atoms.len() + 8 * self.signals.len() > MOST_KEPT;
        if self.full {
            return;
        }
        self.width = (readings.atoms.len(), readings.signals.len());
        self.atoms.extend(readings.atoms.iter().map(|mask| mask.has(0)));
        self.signals.extend(readings.signals.iter().map(|lanes| lanes.0[0]));
        self.states += 1;
    }

    /// Whether the trial is longer than what is kept: then nothing tells what decided it.
    pub(super) const fn is_full(&self) -> bool {
        self.full
    }
}

/// How many agents are named at most.
const NAMED: usize = 3;
/// How many are asked about at once.
const AT_ONCE: usize = 4096;

impl Record {
    /// Calls `look` with the record in the form that `logic` reads.
    fn read<T>(&self, subject: &Subject, budget: &Budget, look: impl FnOnce(&Recording<'_>) -> T) -> T {
        let (atoms, signals) = self.width;
        let place = |width: usize, at: u64, one: u32| at as usize * width + one as usize;
        let atoms =
            |atom: AtomId, at: u64| self.atoms.get(place(atoms, at, atom.0)).is_some_and(|holds| *holds);
        let signals = |signal: SignalId, at: u64| {
            self.signals.get(place(signals, at, signal.0)).copied().unwrap_or(f64::NAN)
        };
        look(&Recording {
            atoms: &atoms,
            signals: &signals,
            seen: self.states as u64,
            horizon: subject.horizon,
            clock: subject.program.scenario.clock,
            stop: &|| budget.is_late(),
        })
    }
}

/// What decided the truth of a formula in a trial, in words; empty where nothing in particular did.
pub(super) fn truth(
    subject: &Subject,
    root: NodeId,
    (record, budget): (&Record, &Budget),
    state_at: impl Fn(Tick) -> Option<State>,
) -> String {
    record.read(subject, budget, |recording| {
        let Ok(explanation) = explain(&subject.tree, root, recording) else { return String::new() };
        // Of those who are not there nothing is to be said, unless there is nobody else.
        let absent = |reason: &&Reason| {
            let Node::Atom(atom) = subject.tree.nodes[reason.leaf.0 as usize] else { return false };
            !reason.value && matches!(subject.atoms()[atom.0 as usize], Bool::Present(_))
        };
        // The last reason in time is the one that closed the case.
        let said = explanation.reasons.iter().filter(|reason| !absent(reason));
        let last = said.max_by_key(|reason| (reason.to, reason.from));
        match last {
            None if explanation.reasons.len() > 1 => "none of those it asks about is there".to_owned(),
            None if explanation.reasons.len() == 1 => {
                closing(subject, &explanation.reasons[0], recording, &state_at)
            }
            Some(reason) => closing(subject, reason, recording, &state_at),
            None if explanation.verdict.is_some() => "it does not depend on what happens".to_owned(),
            None => String::new(),
        }
    })
}

/// Where the value of a metric in a trial comes from, in words, and since when it was so.
pub(super) fn number(
    subject: &Subject,
    root: TermId,
    (value, unit): (f64, &str),
    (record, budget): (&Record, &Budget),
    state_at: impl Fn(Tick) -> Option<State>,
) -> (Option<Tick>, String) {
    record.read(subject, budget, |recording| {
        let (_, found) = sources(&subject.tree, root, Tick(0), recording);
        let never =
            value == f64::INFINITY && matches!(subject.tree.terms[root.0 as usize], Term::TimeUntil(_));
        let text = if never { "not within the horizon".to_owned() } else { words::brief(value, unit) };
        match found.as_slice() {
            [Source::Formula(reason)] => {
                let closing = closing(subject, reason, recording, &state_at);
                (Some(reason.to), format!("{text}, when {closing}"))
            }
            [Source::Signal { at, .. }] => {
                let from = origin(subject, &found[0], false, &state_at);
                (Some(*at), format!("{text}, {from}"))
            }
            [] => (None, text),
            several => {
                let list: Vec<String> =
                    several.iter().take(NAMED).map(|s| origin(subject, s, true, &state_at)).collect();
                (None, format!("{text}: {}", list.join(" and ")))
            }
        }
    })
}

/// Which condition has the margin that the robustness of a formula is in a trial, and when.
pub(super) fn margin(
    subject: &Subject,
    root: NodeId,
    (value, unit): (Option<f64>, &str),
    (record, budget): (&Record, &Budget),
    state_at: impl Fn(Tick) -> Option<State>,
) -> (Option<Tick>, String) {
    record.read(subject, budget, |recording| {
        let Some(found) = critical(&subject.tree, root, recording) else {
            return (None, value.map_or(String::new(), |value| words::brief(value, unit)));
        };
        let shown = words::brief(value.unwrap_or(found.margin), unit);
        let mut said = format!("margin {shown}");
        if let Some((text, _)) =
            subject.texts.comparisons.get(&found.leaf.0).filter(|(text, _)| !text.is_empty())
        {
            said = format!("{said}, of `{text}`");
        }
        if let (Some(state), Node::Compare(_, x, y)) =
            (state_at(found.at), &subject.tree.nodes[found.leaf.0 as usize])
        {
            let mut search = Search { subject, state: &state, found: Vec::new() };
            for side in [x, y] {
                if let Term::Signal(signal) = &subject.tree.terms[side.0 as usize] {
                    search.extremum(&subject.signals()[signal.0 as usize]);
                }
            }
            search.found.truncate(NAMED);
            let found = search.found;
            said.push_str(&names(subject, &found, Some(&state)));
        }
        (Some(found.at), said)
    })
}

/// A state that gave a number its value; `full` says the value and the moment too.
fn origin(
    subject: &Subject,
    source: &Source,
    full: bool,
    state_at: &impl Fn(Tick) -> Option<State>,
) -> String {
    let Source::Signal { signal, at, value } = source else { return String::new() };
    let Some((text, dimension)) = subject.texts.signals.get(signal.0 as usize) else { return String::new() };
    let mut said = if full {
        format!("`{text}` is {} at {}", words::brief(*value, &dimension.to_string()), moment(subject, *at))
    } else {
        format!("`{text}`")
    };
    if let Some(state) = state_at(*at) {
        let mut search = Search { subject, state: &state, found: Vec::new() };
        let signal = &subject.signals()[signal.0 as usize];
        search.extremum(signal);
        search.name_members(text, |tell| signal.mentions(tell));
        let found = search.found;
        said.push_str(&names(subject, &found, Some(&state)));
    }
    said
}

fn moment(subject: &Subject, at: Tick) -> String {
    match subject.program.scenario.clock {
        Clock::Steps => format!("step {}", at.0),
        clock => format!("{} s", words::number(clock.seconds(at))),
    }
}

/// `: crowd[3], user`, or nothing; people of sources by the number of their arrival, as in the state.
fn names(subject: &Subject, who: &[AgentId], state: Option<&State>) -> String {
    let scenario: &Scenario = &subject.program.scenario;
    let name = |id: &AgentId| {
        let agent = scenario.agents.get(id.0 as usize)?;
        let arrival = state.and_then(|state| state.queues.arrival(&scenario.sources, *id, 0));
        Some(arrival.unwrap_or_else(|| agent.name.clone()))
    };
    let names: Vec<String> = who.iter().filter_map(name).collect();
    if names.is_empty() { String::new() } else { format!(": {}", names.join(", ")) }
}

/// A reason in words.
fn closing(
    subject: &Subject,
    reason: &Reason,
    recording: &Recording<'_>,
    state_at: &impl Fn(Tick) -> Option<State>,
) -> String {
    let word = words::truth(reason.value);
    match &subject.tree.nodes[reason.leaf.0 as usize] {
        Node::Atom(atom) if let Bool::Present(Who::Agent(id)) = &subject.atoms()[atom.0 as usize] => {
            let name = subject.program.scenario.agents.get(id.0 as usize).map_or("", |agent| &agent.name);
            format!("{name} is {}there", if reason.value { "" } else { "not " })
        }
        Node::Atom(atom) => {
            let Some(text) = subject.texts.atoms.get(atom.0 as usize) else { return String::new() };
            let blamed =
                |state: &State| blamed(subject, &subject.atoms()[atom.0 as usize], text, reason.value, state);
            let state = state_at(reason.to);
            let who = state.as_ref().map_or_else(Vec::new, blamed);
            let named = names(subject, &who, state.as_ref());
            if !named.is_empty() {
                return format!("`{text}` {word}{named}");
            }
            let of =
                |state: &State| copies(subject, &subject.atoms()[atom.0 as usize], text, reason.value, state);
            let copies = state.as_ref().map_or_else(Vec::new, of);
            let colon = if copies.is_empty() { "" } else { ": " };
            format!("`{text}` {word}{colon}{}", copies.join(", "))
        }
        Node::Compare(..) => {
            let Some((text, _)) = subject.texts.comparisons.get(&reason.leaf.0) else { return String::new() };
            let found = sides(&subject.tree, reason.leaf, reason.to, recording);
            let signals = found.iter().filter(|source| matches!(source, Source::Signal { .. }));
            let list: Vec<String> =
                signals.take(NAMED).map(|source| origin(subject, source, true, state_at)).collect();
            let because = if list.is_empty() { String::new() } else { format!(": {}", list.join(" and ")) };
            format!("`{text}` {word}{because}")
        }
        _ => String::new(),
    }
}

/// The agents that make an atom true or false in a state.
fn blamed(subject: &Subject, atom: &Bool, text: &str, truth: bool, state: &State) -> Vec<AgentId> {
    let mut search = Search { subject, state, found: Vec::new() };
    search.walk(atom, truth);
    search.name_members(text, |tell| atom.mentions(tell));
    search.found.truncate(NAMED);
    search.found
}

/// The copies of processes that make an atom true or false in a state, where they are spoken of by a name that they
/// share, as `a` in `forall a in sensor`.
fn copies(subject: &Subject, atom: &Bool, text: &str, truth: bool, state: &State) -> Vec<String> {
    let search = Search { subject, state, found: Vec::new() };
    let (mut part, mut truth, mut narrowed) = (atom, truth, false);
    loop {
        part = match part {
            Bool::Not(inner) => {
                truth = !truth;
                inner
            }
            // A false conjunct, or a true disjunct, is enough; otherwise all of them decide.
            Bool::And(list) | Bool::Or(list) if matches!(part, Bool::Or(_)) == truth => {
                let Some(one) = list.iter().find(|one| search.holds(one) == truth) else { return Vec::new() };
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
    let variables = &subject.program.scenario.processes.variables;
    let owner = |id: &VariableId| Some(variables.get(id.0 as usize)?.name.rsplit_once('.')?.0.to_owned());
    let mut found: Vec<String> = read.iter().filter_map(owner).collect();
    found.retain(|copy| copy.ends_with(']') && !text.contains(copy.as_str()));
    found.dedup();
    // What depends on many of them is about none of them.
    if found.len() > 2 { Vec::new() } else { found }
}

struct Search<'s> {
    subject: &'s Subject,
    state: &'s State,
    found: Vec<AgentId>,
}

impl Search<'_> {
    fn holds(&self, atom: &Bool) -> bool {
        self.which(std::slice::from_ref(atom)).first().is_some_and(|holds| *holds)
    }

    /// Which of some conditions hold: asked at once, so that who is near whom is sought once.
    fn which(&self, atoms: &[Bool]) -> Vec<bool> {
        let scenario: &Scenario = &self.subject.program.scenario;
        let code = Code::compile(scenario, atoms, &[]);
        let mut readings = Readings::default();
        code.run(&self.subject.program, self.state, &mut readings);
        readings.atoms.iter().map(|mask| mask.has(0)).collect()
    }

    /// The members of a list of whom a condition has a truth value, the first few, with what it is of each.
    fn those(&self, members: &[AgentId], truth: bool, of: impl Fn(AgentId) -> Bool) -> Vec<(AgentId, Bool)> {
        let mut found = Vec::new();
        for some in members.chunks(AT_ONCE) {
            let conditions: Vec<Bool> = some.iter().map(|id| of(*id)).collect();
            let which = self.which(&conditions);
            let all = some.iter().zip(conditions).zip(which);
            found.extend(all.filter(|(_, holds)| *holds == truth).map(|((id, one), _)| (*id, one)));
            if found.len() >= NAMED {
                break;
            }
        }
        found
    }

    fn name(&mut self, id: AgentId) {
        if !self.found.contains(&id) {
            self.found.push(id);
        }
    }

    /// Names the members of sets that are spoken of by a name that they share, as `a` in `forall a in crowd`: those
    /// whose own names do not stand in the text.
    fn name_members(&mut self, text: &str, mentions: impl FnOnce(&mut dyn FnMut(AgentId))) {
        let subject = self.subject;
        let agents = &subject.program.scenario.agents;
        mentions(&mut |id| {
            let hidden = |name: &str| name.ends_with(']') && !text.contains(name);
            if self.found.len() < NAMED && agents.get(id.0 as usize).is_some_and(|a| hidden(&a.name)) {
                self.name(id);
            }
        });
    }

    /// Those of a set who are there: nobody else counts.
    fn members(&self, set: &Set) -> Vec<AgentId> {
        let out = match set.except {
            Some(Who::Agent(id)) => Some(id),
            _ => None,
        };
        let there = |id: AgentId| {
            let slot = self.state.slot(id.0 as usize, 0);
            self.state.present[slot.block].has(slot.lane)
        };
        set.members.iter().copied().filter(|id| Some(*id) != out && there(*id)).collect()
    }

    fn walk(&mut self, atom: &Bool, truth: bool) {
        match atom {
            Bool::Constant(_) => {}
            Bool::Not(inner) => self.walk(inner, !truth),
            Bool::And(list) | Bool::Or(list) => {
                for part in list {
                    if self.holds(part) == truth {
                        self.walk(part, truth);
                        // A false conjunct, or a true disjunct, is enough.
                        if matches!(atom, Bool::And(_)) != truth {
                            break;
                        }
                    }
                }
            }
            Bool::Iff(a, b) => {
                let first = self.holds(a);
                self.walk(a, first);
                self.walk(b, first == truth);
            }
            Bool::Forall(set, body) | Bool::Exists(set, body) => {
                if matches!(atom, Bool::Forall(..)) == truth {
                    return;
                }
                let members = self.members(set);
                for (id, one) in self.those(&members, truth, |id| instantiate_bool(body, 0, id)) {
                    self.name(id);
                    self.walk(&one, truth);
                    if self.found.len() >= NAMED {
                        return;
                    }
                }
            }
            Bool::Compare(_, a, b) => {
                self.extremum(a);
                self.extremum(b);
            }
            Bool::In(Who::Agent(id), _) | Bool::Present(Who::Agent(id)) => self.name(*id),
            Bool::Contact(Who::Agent(id)) => {
                let id = *id;
                self.name(id);
                if truth {
                    let all = (0..self.subject.program.scenario.agents.len() as u32).map(AgentId);
                    let others: Vec<AgentId> = all.filter(|other| *other != id).collect();
                    let touches = |other| Bool::Touching(Who::Agent(id), Who::Agent(other));
                    for (other, _) in self.those(&others, true, touches) {
                        self.name(other);
                    }
                }
            }
            Bool::Touching(Who::Agent(a), Who::Agent(b)) => {
                self.name(*a);
                self.name(*b);
            }
            Bool::In(..) | Bool::Present(_) | Bool::Contact(_) | Bool::Touching(..) => {}
        }
    }

    /// The member with the smallest or largest value of a fold names itself.
    fn extremum(&mut self, num: &Num) {
        match num {
            Num::Combine(_, a, b) => {
                self.extremum(a);
                self.extremum(b);
            }
            // The margin of who may not be there yet stands in a condition.
            Num::Apply(_, a) | Num::If(_, a, _) => self.extremum(a),
            // Those who were counted.
            Num::Count(set, body) if !matches!(**body, Bool::Constant(_)) => {
                let members = self.members(set);
                for (id, _) in self.those(&members, true, |id| instantiate_bool(body, 0, id)) {
                    if self.found.len() < NAMED {
                        self.name(id);
                    }
                }
            }
            _ => {}
        }
        let Num::Fold(fold, set, body) = num else { return };
        let smallest = match fold {
            crate::model::Fold::Min => true,
            crate::model::Fold::Max => false,
            crate::model::Fold::Sum | crate::model::Fold::Mean => return,
        };
        let members = self.members(set);
        let values: Vec<Num> = members.iter().map(|id| instantiate_num(body, 0, *id)).collect();
        let code = Code::compile(&self.subject.program.scenario, &[], &values);
        let mut readings = Readings::default();
        code.run(&self.subject.program, self.state, &mut readings);
        let value = |k: &usize| readings.signals[*k].0[0];
        let best = (0..members.len()).min_by(|a, b| {
            // What is not a number comes last, whatever sign the platform gives it.
            let (one, other) = if smallest { (value(a), value(b)) } else { (value(b), value(a)) };
            value(a).is_nan().cmp(&value(b).is_nan()).then(one.total_cmp(&other))
        });
        if let Some(best) = best {
            self.name(members[best]);
        }
    }
}
