//! The state of compilation under one combination of parameter values.

use super::behaviour::With;
use super::dimension::{Dimension, describe, single_number};
use super::failures::Vain;
use super::interned::Interned;
use super::kinds::Kind;
use super::margin::Margins;
use super::number::Number;
use super::places::Written;
use super::process::Declared;
use super::said::without_comments;
use super::sighting::{Grouping, Tracks};
use super::starts::Starts;
use super::study::Origins;
use super::study::Texts;
use super::symbols::{Scope, ScopeId};
use super::told::Told;
use super::typed::Typed;
use super::wording::{Frame, Uses};
use crate::base::decimal::Decimal;
use crate::base::geometry::{Shape, Vec2};
use crate::base::tick::{Clock, Tick};
use crate::logic::Tree;
use crate::model::{AgentId, BehaviourId, Bool, Num, Scene};
use crate::syntax::ast::{BehaviourDecl, Expr};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic, Severity};
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// An error was reported; what depends on it is left out without another word.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported;

/// A result whose error has been reported.
pub(super) type Lowered<T> = Result<T, Reported>;

/// How many expression nodes one combination of parameter values may expand to.
pub(super) const MOST_NODES: u64 = 4_000_000;
/// After so many errors, no similar name is searched for an unknown name.
const MOST_LOOKED_FOR: usize = 100;

/// Names of enclosing expressions: function arguments and quantified agents.
#[derive(Clone, Debug, Default)]
pub(super) struct Locals {
    /// Which table of names is looked up after the locals.
    pub(super) scope: ScopeId,
    /// Bound names, innermost last. `None`: the meaning is unknown, and expressions that need it report no error.
    pub(super) names: Vec<(String, Option<Arc<Typed>>)>,
    /// Where the arguments of a function are written that is called, by their places among the names.
    pub(super) written: Vec<(usize, Span)>,
    /// The bound names in texts.
    pub(super) frame: Option<Arc<Frame>>,
    /// Number of enclosing folds over agents.
    pub(super) running: u32,
    /// The process, and which of its copies, whose names come next.
    pub(super) process: Option<(u32, u32)>,
    /// The process whose variables are being settled.
    pub(super) settling: Option<u32>,
    /// The behaviour whose names come next, and how many of the bound names they see.
    pub(super) behaviour: Option<(u32, usize)>,
}

impl Locals {
    /// No locals in a scope.
    pub(super) fn of(scope: ScopeId) -> Self {
        Self { scope, ..Self::default() }
    }

    /// Binds a name, which hides others that are equal.
    pub(super) fn bind(&mut self, name: &str, value: Typed) {
        self.names.push((name.to_owned(), Some(Arc::new(value))));
    }

    /// Binds a name with an unknown meaning.
    pub(super) fn bind_unknown(&mut self, name: &str) {
        self.names.push((name.to_owned(), None));
    }
}

/// The state of compilation.
#[allow(clippy::struct_excessive_bools, reason = "each answers a question of its own")]
pub(super) struct Elaborator<'a> {
    /// Sources, for texts.
    pub(super) sources: &'a [Source],
    /// Tables of names.
    pub(super) scopes: Vec<Scope<'a>>,
    /// Values of parameters that are set.
    pub(super) settings: BTreeMap<String, Number>,
    /// Values of constants and parameters so far.
    pub(super) constants: BTreeMap<(ScopeId, String), Lowered<Typed>>,
    /// Names whose expansion is under way.
    pub(super) expanding: Vec<(ScopeId, String)>,
    /// Recordings read so far.
    pub(super) recordings: Vec<Option<Tracks>>,
    /// The destinations beside each, m, or why there are none.
    pub(super) destinations: Vec<Result<Vec<Vec2>, String>>,
    /// Their names, and which velocities they have.
    pub(super) velocities: Vec<(String, &'static str)>,
    /// Finds groups of people who are seen.
    pub(super) grouping: Option<Grouping>,
    /// Agents who are named and not seen, with their stable numbers: they never come.
    pub(super) unseen: Vec<(AgentId, u32)>,
    /// The recorded persons in use, with the places of their declarations.
    pub(super) recorded: BTreeMap<(usize, u32), Span>,
    /// Shapes of regions known so far.
    pub(super) shapes: Vec<Option<Lowered<Shape>>>,
    /// Kinds known so far.
    pub(super) kinds: BTreeMap<String, Lowered<Kind>>,
    /// The scene.
    pub(super) scene: Scene,
    /// Processes so far.
    pub(super) processes: Vec<Declared<'a>>,
    /// Behaviours so far.
    pub(super) behaviours: Vec<&'a BehaviourDecl>,
    /// The behaviours of agents, by declaration.
    pub(super) withs: Vec<With<'a>>,
    /// The behaviours of single agents.
    pub(super) having: BTreeSet<(AgentId, BehaviourId)>,
    /// Agents with an unknown behaviour.
    pub(super) strayed: BTreeSet<AgentId>,
    /// Arguments of unknown behaviours.
    pub(super) stray: Vec<&'a [Expr]>,
    /// Names of the agents so far.
    pub(super) agent_names: Vec<String>,
    /// How many legs their routes have; of routes among moves, the most.
    pub(super) legs: Vec<u32>,
    /// Where the starts of people are written.
    pub(super) places: Written,
    /// The starts of agents, in a scenario with other errors.
    pub(super) starts: Option<Starts>,
    /// Files of learned gaits that could be read.
    pub(super) gaits: BTreeMap<String, Arc<str>>,
    /// Stand-ins for people whose declaration is wrong.
    pub(super) undeclared: BTreeSet<AgentId>,
    /// Whether a part of the scenario was left out, which is never done without an error.
    pub(super) given_up: bool,
    /// An earlier error makes the checks of start positions unreliable; skip them.
    pub(super) any_start: bool,
    /// Where the behaviour that is looked at gets its arguments, if it takes any.
    pub(super) attached_at: Option<Span>,
    /// Where processes and behaviours are written.
    pub(super) origins: Origins,
    /// Whether agents can arrive during a trial.
    pub(super) coming: bool,
    /// The agents with moves, and with paths (true); `None` if some of these have errors.
    pub(super) advised: Option<BTreeSet<(AgentId, bool)>>,
    /// Agents who come or leave during a trial.
    pub(super) passing: BTreeSet<AgentId>,
    /// The clock.
    pub(super) clock: Clock,
    /// Last tick.
    pub(super) horizon: Tick,
    /// Where horizon and step are written.
    pub(super) clock_at: Vec<Span>,
    /// Times that ticks of continuous time measure, as far as they can.
    pub(super) measured: Vec<Decimal>,
    /// Times that ticks of continuous time would have to measure too.
    pub(super) between: Vec<Decimal>,
    /// Whether formulas over time are allowed at present.
    pub(super) temporal: bool,
    /// What is observed.
    pub(super) tree: Tree,
    /// Truth values observed.
    pub(super) atoms: Vec<Bool>,
    /// How many of them stood before the present measure.
    pub(super) atoms_before: usize,
    /// Whether the present measure has more of them than there may be: what it stands for is not known.
    pub(super) overflown: bool,
    /// Numbers observed.
    pub(super) signals: Vec<Num>,
    /// Where nodes, terms, atoms and signals are.
    pub(super) known: [Interned; 4],
    /// How atoms, signals and comparisons were written.
    pub(super) texts: Texts,
    /// Where a use of an argument stands, and where what it stands for is written, in the present call.
    pub(super) aliases: BTreeMap<Span, Span>,
    /// Where names are used that stand for something else.
    pub(super) uses: Uses,
    /// What they stand for at the present place.
    pub(super) frame: Option<Arc<Frame>>,
    /// Where the name of a bare number stands, and where that is declared.
    pub(super) bare: BTreeMap<Span, Span>,
    /// How often an unknown name was come upon.
    pub(super) unknowns: u64,
    /// Whether the body of a function is looked at, whatever it is called with.
    pub(super) looking: bool,
    /// Functions that were followed from there.
    pub(super) followed: BTreeSet<(ScopeId, String)>,
    /// Names in circles that were reported.
    pub(super) circles: Vec<String>,
    /// Whether a parameter has a value outside of its range here.
    pub(super) is_astray: bool,
    /// The errors found.
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Codes and places of all that was ever noted: only what stands here can be among the diagnostics.
    noted: BTreeSet<(Code, Option<Span>)>,
    /// Knowledge about margins, while the formula of a robustness is lowered.
    pub(super) margins: Option<Margins>,
    /// Present depth of lowering.
    pub(super) depth: u32,
    /// Where the outermost expression that is being lowered stands.
    pub(super) outermost: Span,
    /// Names that were expanded in vain: what is wrong with them was said.
    pub(super) broken: BTreeSet<(ScopeId, String)>,
    /// Names with an ambiguous or unknown meaning.
    pub(super) doubtful: BTreeSet<(ScopeId, String)>,
    /// The expressions that failed, in order.
    pub(super) journal: Vec<(Vain, (ScopeId, String))>,
    /// Parts of the files that could not be read.
    pub(super) torn: Vec<Span>,
    /// The places of values that could not be read: nothing more is said of them.
    pub(super) unread: BTreeSet<(SourceId, u32)>,
    /// How much of the clock is known: errors about times that need more are not reported.
    pub(super) told: Told,
    /// Nodes lowered so far.
    pub(super) nodes: u64,
}

impl<'a> Elaborator<'a> {
    /// Nothing known yet.
    pub(super) fn new(sources: &'a [Source], settings: BTreeMap<String, Number>) -> Self {
        Self {
            sources,
            scopes: vec![Scope::default()],
            settings,
            constants: BTreeMap::new(),
            expanding: Vec::new(),
            recordings: Vec::new(),
            destinations: Vec::new(),
            velocities: Vec::new(),
            grouping: None,
            unseen: Vec::new(),
            gaits: BTreeMap::new(),
            recorded: BTreeMap::new(),
            shapes: Vec::new(),
            kinds: BTreeMap::new(),
            scene: Scene::default(),
            processes: Vec::new(),
            behaviours: Vec::new(),
            withs: Vec::new(),
            having: BTreeSet::new(),
            strayed: BTreeSet::new(),
            stray: Vec::new(),
            agent_names: Vec::new(),
            legs: Vec::new(),
            places: Vec::new(),
            starts: None,
            undeclared: BTreeSet::new(),
            given_up: false,
            any_start: false,
            attached_at: None,
            origins: Origins::default(),
            coming: false,
            advised: Some(BTreeSet::new()),
            passing: BTreeSet::new(),
            clock: Clock::Steps,
            horizon: Tick(0),
            clock_at: Vec::new(),
            measured: Vec::new(),
            between: Vec::new(),
            temporal: false,
            tree: Tree::default(),
            atoms: Vec::new(),
            atoms_before: 0,
            overflown: false,
            signals: Vec::new(),
            known: Default::default(),
            texts: Texts::default(),
            aliases: BTreeMap::new(),
            uses: Uses::default(),
            frame: None,
            bare: BTreeMap::new(),
            unknowns: 0,
            looking: false,
            followed: BTreeSet::new(),
            circles: Vec::new(),
            is_astray: false,
            diagnostics: Vec::new(),
            noted: BTreeSet::new(),
            margins: None,
            depth: 0,
            outermost: Span::default(),
            broken: BTreeSet::new(),
            doubtful: BTreeSet::new(),
            journal: Vec::new(),
            torn: Vec::new(),
            unread: BTreeSet::new(),
            told: Told::Whole,
            nodes: 0,
        }
    }

    /// Reports an error.
    pub(super) fn report<T>(&mut self, diagnostic: Diagnostic) -> Lowered<T> {
        self.note(diagnostic);
        Err(Reported)
    }

    /// Notes an error or warning, each place once.
    pub(super) fn note(&mut self, diagnostic: Diagnostic) {
        if self.told < Told::needed(diagnostic.code) {
            return;
        }
        let place = diagnostic.place.as_ref().map(|place| (place.span.source, place.span.start));
        if place.is_some_and(|place| self.unread.contains(&place)) {
            return;
        }
        if self.is_astray && diagnostic.severity == Severity::Error && !self.is_sure(&diagnostic) {
            return;
        }
        let place = diagnostic.place.as_ref().map(|place| place.span);
        if self.noted.insert((diagnostic.code, place)) || !self.diagnostics.contains(&diagnostic) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Whether an error of some code was found at a place: said once, it need not be looked for again.
    pub(super) fn is_said(&self, code: Code, place: Span) -> bool {
        let at = |one: &Diagnostic| one.place.as_ref().is_some_and(|label| label.span == place);
        self.noted.contains(&(code, Some(place)))
            && self.diagnostics.iter().any(|one| one.code == code && at(one))
    }

    /// Whether an error was found.
    pub(super) fn failed(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }

    /// Whether a known name is looked for that an unknown one may mean: after many errors that only takes time.
    pub(super) fn looks_for_names(&self) -> bool {
        let mut errors = self.diagnostics.iter().filter(|one| one.severity == Severity::Error);
        errors.nth(MOST_LOOKED_FOR - 1).is_none()
    }

    /// The text of a span in one line, without comments.
    pub(super) fn text(&self, span: Span) -> String {
        let text = self.sources.iter().find(|s| s.id == span.source).map_or("", |s| s.slice(span));
        without_comments(text).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Expected one thing, found another.
    pub(super) fn mismatch<T>(&mut self, span: Span, expected: &str, found: &Typed) -> Lowered<T> {
        let error = error!(E0305, span, "expected {expected}, found {}", found.noun());
        self.report(error)
    }

    /// Two dimensions that ought to be one.
    pub(super) fn wrong_dimension<T>(
        &mut self,
        span: Span,
        expected: Dimension,
        found: Dimension,
    ) -> Lowered<T> {
        let error = self.other_dimension(span, expected, found);
        self.report(error)
    }

    pub(super) fn other_dimension(&self, span: Span, expected: Dimension, found: Dimension) -> Diagnostic {
        let mut error = error!(E0303, span, "expected {}, found {}", describe(expected), describe(found));
        let text = self.text(span);
        if found.is_none() && !expected.is_none() {
            // A unit belongs to a number or a point.
            let is_number = text.ends_with(|c: char| c.is_ascii_digit() || c == '.' || c == ')')
                && text.starts_with(|c: char| !c.is_alphabetic() && c != '_');
            // Angles of agents are usually written in degrees.
            let unit = if expected == Dimension::ANGLE { "deg".to_owned() } else { expected.to_string() };
            error = error.hint(if is_number {
                format!("write the unit: `{text} {unit}`")
            } else {
                format!("write the unit after the number, or multiply: `{text} * 1 {unit}`")
            });
        }
        if let Some(number) = single_number(&text).filter(|_| !found.is_none() && !expected.is_none()) {
            error = error.hint(format!("write `{number} {expected}`"));
        }
        let is_bare = found.is_none() && !expected.is_none();
        if is_bare {
            error.comes_of = self.bare_within(span);
        }
        let in_steps = [expected, found].contains(&Dimension::STEPS);
        error.about(About::Unit { wanted: describe(expected), is_bare, in_steps })
    }

    /// Where the bare number is declared that is named within a place, if there is just one.
    fn bare_within(&self, place: Span) -> Option<Span> {
        let from = self.bare.range(Span { end: 0, ..place }..);
        let mut within = from.take_while(|(name, _)| name.source == place.source && name.start < place.end);
        let (_, first) = within.next()?;
        within.all(|(_, other)| other == first).then_some(*first)
    }

    /// A number known at compile time, of a given dimension.
    pub(super) fn number_of(
        &mut self,
        expr: &Expr,
        dimension: Dimension,
        locals: &Locals,
    ) -> Lowered<Number> {
        let number = self.number(expr, locals)?;
        if number.dimension != dimension {
            return self.wrong_dimension(expr.span, dimension, number.dimension);
        }
        if !number.value.is_finite() {
            return self.report(error!(E0405, expr.span, "the value is not a finite number"));
        }
        Ok(number)
    }

    /// A number known at compile time.
    pub(super) fn number(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Number> {
        match self.lower(expr, locals)? {
            Typed::Number(number) => Ok(number),
            found @ (Typed::Num(..) | Typed::Term(..)) => {
                let when = match &found {
                    Typed::Num(num, _) if num.is_fixed() => "is computed in each trial",
                    Typed::Num(num, _) if num.is_drawn() => "is drawn in each trial",
                    _ => "changes during a trial",
                };
                let said = "the value must be known before a trial starts";
                let error = error!(E0304, expr.span, "{said}");
                self.report(error.label(format!("{} that {when}", found.noun())))
            }
            found => self.mismatch(expr.span, "a number", &found),
        }
    }

    /// All agents of the scenario.
    pub(super) fn everyone(&self) -> std::sync::Arc<[AgentId]> {
        (0..self.agent_names.len() as u32).map(AgentId).collect()
    }
}
