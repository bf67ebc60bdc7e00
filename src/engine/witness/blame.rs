//! What decided a trial: the atom, comparison or number, and the agents in it.

use crate::base::tick::Tick;
use crate::compile::study;
use crate::engine::answer::words;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::culprits::{NAMED, Search};
use crate::engine::witness::decider::{self, Decider};
use crate::engine::witness::grounds::{copies, each, grounds};
use crate::kernel::{Readings, State};
use crate::logic::{
    AtomId, Node, NodeId, Part, Reason, Recording, SignalId, Source, Term, TermId, critical, explain, leaves,
    sides, sources,
};
use crate::model::{Bool, Who};
use crate::trials::budget::Budget;

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

    /// Explains the trial by what was recorded of it; `None` where there was too much to record.
    pub(super) fn explain<T>(
        &self,
        prepared: &PreparedWorld,
        budget: &Budget,
        state_at: &dyn Fn(Tick) -> Option<State>,
        look: impl FnOnce(&Explained<'_>) -> T,
    ) -> Option<T> {
        let (atoms, signals) = self.width;
        let place = |width: usize, at: u64, one: u32| at as usize * width + one as usize;
        let atoms =
            |atom: AtomId, at: u64| self.atoms.get(place(atoms, at, atom.0)).is_some_and(|holds| *holds);
        let signals = |signal: SignalId, at: u64| {
            self.signals.get(place(signals, at, signal.0)).copied().unwrap_or(f64::NAN)
        };
        let recording = Recording {
            atoms: &atoms,
            signals: &signals,
            seen: self.states as u64,
            horizon: prepared.horizon,
            clock: prepared.program.scenario.clock,
            stop: &|| budget.is_late(),
        };
        (!self.full).then(|| look(&Explained { prepared, recording: &recording, state_at }))
    }
}

/// What decided.
#[derive(Clone, Debug, Default)]
pub(super) struct Said {
    /// In words.
    pub(super) words: String,
    /// The agent and number that did.
    pub(super) decider: Option<Decider>,
    /// All agents that are named, the first few of those who did.
    pub(super) agents: Vec<String>,
}

impl Said {
    /// Other words about the same agents.
    fn saying(self, words: String) -> Self {
        Self { words, ..self }
    }

    /// Whether there are words.
    fn is_told(&self) -> bool {
        !self.words.is_empty()
    }

    /// These words, followed by others with their agents.
    fn with(self, more: Self) -> Self {
        Self { words: self.words + &more.words, ..more }
    }

    /// Several, told one after the other.
    fn joined(mut list: Vec<Self>, between: &str) -> Self {
        list.dedup_by(|next, last| next.words == last.words);
        let words = list.iter().map(|one| one.words.as_str()).collect::<Vec<_>>().join(between);
        let agents = each(list.iter().flat_map(|one| one.agents.clone()).collect());
        Self { words, decider: list.into_iter().find_map(|one| one.decider), agents }
    }
}

impl From<String> for Said {
    fn from(words: String) -> Self {
        Self { words, ..Self::default() }
    }
}

/// A trial that is explained: what is recorded of it, and its states.
pub(super) struct Explained<'t> {
    prepared: &'t PreparedWorld,
    recording: &'t Recording<'t>,
    state_at: &'t dyn Fn(Tick) -> Option<State>,
}

impl Explained<'_> {
    /// What decided the truth of a formula; no words where nothing in particular did.
    pub(super) fn truth(&self, root: NodeId) -> Said {
        let Self { prepared, recording, .. } = *self;
        let Ok(explanation) = explain(&prepared.tree, root, recording) else { return Said::default() };
        // Of those who are not there nothing is to be said, unless there is nobody else.
        let absent = |reason: &&Reason| {
            let Node::Atom(atom) = prepared.tree.nodes[reason.leaf.0 as usize] else { return false };
            !reason.value && matches!(prepared.atoms[atom.0 as usize], Bool::Present(_))
        };
        // The last reason in time is the one that closed the case.
        let said: Vec<&Reason> = explanation.reasons.iter().filter(|reason| !absent(reason)).collect();
        let last = said.iter().copied().max_by_key(|reason| (reason.to, reason.from));
        // Another of the same time closed it with it; of more than two the last stands for all. That someone has the left
        // side of an implication goes without saying where the whole is told.
        let goes_without = |reason: &Reason| {
            let Node::Atom(atom) = prepared.tree.nodes[reason.leaf.0 as usize] else { return false };
            reason.value && prepared.texts.cases.contains(&atom.0)
        };
        let of_then = |last: &Reason| {
            let then = said.iter().copied().filter(|one| (one.to, one.from) == (last.to, last.from));
            then.filter(|one| *one == last || !goes_without(one)).collect::<Vec<&Reason>>()
        };
        match last {
            None if explanation.reasons.len() > 1 => {
                "no agent of the quantified set was present".to_owned().into()
            }
            None if explanation.reasons.len() == 1 => self.closing(&explanation.reasons[0]),
            Some(reason) => {
                let then = of_then(reason);
                let told = if then.len() <= 2 { then } else { vec![reason] };
                Said::joined(told.into_iter().map(|one| self.closing(one)).collect(), "; ")
            }
            None if explanation.verdict.is_some() => {
                "its value does not depend on the trial".to_owned().into()
            }
            None => Said::default(),
        }
    }

    /// Where the value of a metric comes from, in words, and since when it was so.
    pub(super) fn number(&self, root: TermId, value: f64, unit: &str) -> (Option<Tick>, Said) {
        let tree = &self.prepared.tree;
        let (_, found) = sources(tree, root, Tick(0), self.recording);
        let never = value == f64::INFINITY && matches!(tree.terms[root.0 as usize], Term::TimeUntil(_));
        let text = if never { "not within the horizon".to_owned() } else { words::brief(value, unit) };
        let is_beyond =
            |source: &Source| matches!(source, Source::Signal { value, .. } if !value.is_finite());
        match found.as_slice() {
            // A condition that comes true gives a time that is finite.
            several
                if !value.is_finite()
                    && !never
                    && !matches!(several, [Source::Signal { .. }])
                    && !several.iter().any(is_beyond) =>
            {
                (None, text.into())
            }
            [Source::Formula(reason)] => {
                let closing = self.closing(reason);
                let words = format!("{text}, when {}", closing.words);
                (Some(reason.to), closing.saying(words))
            }
            [Source::Signal { at, .. }] => {
                let from = self.origin(&found[0], false);
                let words = format!("{text}, {}", from.words);
                (Some(*at), from.saying(words))
            }
            [] => (None, text.into()),
            several => (None, self.listed(&text, several).unwrap_or_else(|| format!("{text}: ").into())),
        }
    }

    /// Which condition has the margin that the robustness of a formula is, and when.
    pub(super) fn margin(&self, root: NodeId, value: Option<f64>, unit: &str) -> (Option<Tick>, Said) {
        let prepared = self.prepared;
        let Some(found) = critical(&prepared.tree, root, self.recording) else {
            return (None, value.map_or(String::new(), |value| words::brief(value, unit)).into());
        };
        // All conditions have the unit of the margin, which a probability of it has not.
        let condition = prepared.texts.comparisons.get(&found.leaf.0);
        let own = condition.map_or(String::new(), |(_, dimension)| dimension.to_string());
        let unit = if unit.is_empty() { own.as_str() } else { unit };
        let mut said = Said::from(format!("margin {}", words::brief(value.unwrap_or(found.margin), unit)));
        if let Some((text, _)) = condition.filter(|(text, _)| !text.is_empty()) {
            said.words = format!("{}, of `{text}`", said.words);
        }
        if let (Some(state), Node::Compare(_, x, y)) =
            ((self.state_at)(found.at), &prepared.tree.nodes[found.leaf.0 as usize])
        {
            let mut search = self.search(&state);
            for side in [x, y] {
                if let Term::Signal(signal) = &prepared.tree.terms[side.0 as usize] {
                    search.extremum(&prepared.signals[signal.0 as usize]);
                }
            }
            if search.is_empty() {
                self.name_spoken_of(&mut search, found.leaf);
            }
            said = said.with(names(&search));
        }
        (Some(found.at), said)
    }

    fn search<'s>(&'s self, state: &'s State) -> Search<'s> {
        Search::of(self.prepared, state, self.recording.stop)
    }

    /// A state that gave a number its value; `full` says the value and the moment too.
    fn origin(&self, source: &Source, full: bool) -> Said {
        let Source::Signal { signal, at, value } = source else { return Said::default() };
        let Some((text, dimension)) = self.prepared.texts.signals.get(signal.0 as usize) else {
            return Said::default();
        };
        let said = if full {
            format!("`{text}` is {} at {}", words::brief(*value, &dimension.to_string()), self.moment(*at))
        } else {
            format!("`{text}`")
        };
        let Some(state) = (self.state_at)(*at) else { return said.into() };
        let mut search = self.search(&state);
        let signal = &self.prepared.signals[signal.0 as usize];
        search.extremum(signal);
        if search.is_empty() {
            search.name_all_in(signal);
        }
        search.name_members(text, |tell| signal.mentions(tell));
        Said::from(said).with(names(&search))
    }

    /// The first few of several sources of a number behind some words, each with its moment; `None` where nothing is known of
    /// any.
    fn listed(&self, head: &str, sources: &[Source]) -> Option<Said> {
        let told = sources.iter().map(|source| match source {
            Source::Formula(reason) => {
                let closing = self.closing(reason);
                let words = format!("{} at {}", closing.words, self.moment(reason.to));
                closing.saying(words)
            }
            signal @ Source::Signal { .. } => self.origin(signal, true),
        });
        let list: Vec<Said> = told.filter(Said::is_told).take(NAMED).collect();
        let words = |said: &Said| format!("{head}: {}", said.words);
        let said = (!list.is_empty()).then(|| Said::joined(list, " and "))?;
        Some(Said { words: words(&said), decider: None, ..said })
    }

    fn moment(&self, at: Tick) -> String {
        words::moment(self.prepared.program.scenario.clock, at)
    }

    /// A reason in words.
    fn closing(&self, reason: &Reason) -> Said {
        let prepared = self.prepared;
        let scenario = &prepared.program.scenario;
        let word = words::truth(reason.value);
        match &prepared.tree.nodes[reason.leaf.0 as usize] {
            Node::Atom(atom) if let Bool::Present(Who::Agent(id)) = &prepared.atoms[atom.0 as usize] => {
                let name = scenario.agents.get(id.0 as usize).map_or("", |agent| &agent.name);
                format!("{name} is {}present", if reason.value { "" } else { "not " }).into()
            }
            Node::Atom(atom) => {
                let Some(text) = prepared.texts.atoms.get(atom.0 as usize) else { return Said::default() };
                let condition = &prepared.atoms[atom.0 as usize];
                let head = format!("`{text}` {word}");
                let Some(state) = (self.state_at)(reason.to) else { return head.into() };
                if let Some(part) = prepared.texts.parts.get(&atom.0)
                    && let Some(because) = self.because((part, text), reason.value, &state)
                {
                    return because;
                }
                let mut search = self.search(&state);
                search.walk(condition, reason.value);
                search.name_members(text, |tell| condition.mentions(tell));
                let named = decided(&search);
                if named.is_told() {
                    return Said::from(head).with(named);
                }
                let copies = copies(scenario, (condition, reason.value), false, &self.search(&state));
                let colon = if copies.is_empty() { "" } else { ": " };
                format!("{head}{colon}{}", copies.join(", ")).into()
            }
            Node::Compare(..) => {
                let Some((text, _)) = prepared.texts.comparisons.get(&reason.leaf.0) else {
                    return Said::default();
                };
                let found = sides(&prepared.tree, reason.leaf, reason.to, self.recording);
                let head = format!("`{text}` {word}");
                if let Some(said) = self.listed(&head, &found) {
                    return said;
                }
                let Some(state) = (self.state_at)(reason.to) else { return head.into() };
                let mut search = self.search(&state);
                self.name_spoken_of(&mut search, reason.leaf);
                Said::from(head).with(decided(&search))
            }
            _ => Said::default(),
        }
    }

    /// A condition that is made of others in words, with those of them that decide in a state and the agents in these.
    fn because(&self, (part, whole): (&study::Part, &str), truth: bool, state: &State) -> Option<Said> {
        let found = grounds(part, truth, &self.search(state))?;
        let mut search = self.search(state);
        let (mut said, mut owners): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
        let people = |at: usize, who: Who| {
            let id = match who {
                Who::Agent(id) => Some(id),
                Who::Running(of) => found[at].given.get(of as usize).copied(),
            };
            id.and_then(|id| self.search(state).name_of(id))
        };
        let parts: Vec<&study::Part> = found.iter().map(|ground| ground.part).collect();
        let texts = self.prepared.texts.words(&parts, &people)?;
        for (ground, text) in found.iter().zip(&texts) {
            let condition = ground.condition();
            ground.given.iter().for_each(|id| search.name(*id));
            search.walk(&condition, ground.truth);
            search.name_members(text, |tell| condition.mentions(tell));
            let (scenario, is_part) = (&self.prepared.program.scenario, !std::ptr::eq(ground.part, part));
            owners.extend(copies(scenario, (&condition, ground.truth), is_part, &self.search(state)));
            said.push(words::condition((text, ground.truth)));
        }
        let owners = each(owners);
        let mut named = decided(&search);
        if !named.is_told() && !owners.is_empty() {
            named.words = format!(": {}", owners.join(", "));
        }
        Some(Said::from(words::because((whole, truth), &said)).with(named))
    }

    /// Names the agents who are there of whom a comparison of numbers over time speaks one by one.
    fn name_spoken_of(&self, search: &mut Search<'_>, leaf: NodeId) {
        let tree = &self.prepared.tree;
        let Node::Compare(_, x, y) = tree.nodes[leaf.0 as usize] else { return };
        for side in [x, y] {
            let (_, signals) = leaves(tree, &[Part::Term(side)]).unwrap_or_default();
            for signal in signals {
                search.name_all_in(&self.prepared.signals[signal.0 as usize]);
            }
        }
    }
}

/// `: crowd[3], user`, or nothing; people of sources by the number of their arrival, as in the state.
fn names(search: &Search<'_>) -> Said {
    let agents: Vec<String> = search.named().iter().filter_map(|id| search.name_of(*id)).collect();
    let words = if agents.is_empty() { String::new() } else { format!(": {}", agents.join(", ")) };
    Said { words, decider: None, agents }
}

/// Who was found, in words: the first with its place and the number that was compared.
fn decided(search: &Search<'_>) -> Said {
    let said = names(search);
    let Some(decider) = decider::decider(search) else { return said };
    // A gap has two ends; who is in a set that is compared as a whole did not decide alone.
    let mut compared = Vec::new();
    if let Some((a, b)) = search.compared() {
        for side in [a, b] {
            side.mentions(&mut |id| compared.push(id));
        }
    }
    let mut compared = each(compared);
    compared.truncate(if compared.len() > NAMED { 0 } else { NAMED });
    let words = decider::written(&decider, &said.agents);
    let own = [Some(decider.agent.clone()), decider.other.clone()].into_iter().flatten();
    let ends = compared.into_iter().filter_map(|id| search.name_of(id));
    let agents = each(own.chain(said.agents).chain(ends).collect());
    Said { words, decider: Some(decider), agents }
}
