//! The state of compilation under one combination of parameter values.

pub(crate) mod clock;
pub(crate) mod conducts;
pub(crate) mod dependence;
pub(crate) mod entry;
pub(crate) mod extent;
pub(crate) mod interned;
pub(crate) mod kind;
pub(crate) mod levels;
pub(crate) mod lowered;
pub(crate) mod moments;
pub(crate) mod names;
pub(crate) mod notes;
pub(crate) mod number;
pub(crate) mod observed;
pub(crate) mod parts;
pub(crate) mod people;
pub(crate) mod phrase;
pub(crate) mod plans;
pub(crate) mod processes;
pub(crate) mod roster;
pub(crate) mod sighting;
pub(crate) mod sink;
pub(crate) mod symbols;
pub(crate) mod typed;
pub(crate) mod wording;

pub(crate) use lowered::{Locals, Lowered, MOST_NODES, Reported};

use crate::base::geometry::Shape;
use crate::compile::context::symbols::Meaning;
use crate::compile::context::{
    clock::Time,
    conducts::Conducts,
    extent::Extent,
    kind::Kind,
    levels::Levels,
    names::Names,
    notes::Notes,
    number::Number,
    observed::{Margins, Observed},
    parts::Origins,
    plans::FloorPlan,
    processes::Declared,
    roster::Roster,
    sighting::Recordings,
    sink::Sink,
    symbols::Scope,
    typed::Typed,
    wording::{Words, without_comments},
};
use crate::compile::dimension::{Dimension, describe, single_number};
use crate::model::Scene;
use crate::syntax::ast::Broken;
use crate::syntax::diagnostic::{About, Diagnostic, Severity};
use crate::syntax::source::{Source, Span};
use std::collections::BTreeMap;

/// The state of compilation of one world: each part is described where it is defined.
pub(crate) struct Context<'a> {
    /// Sources, for texts.
    pub(crate) sources: &'a [Source],
    /// Names, and what they stand for.
    pub(crate) names: Names<'a>,
    /// The errors and warnings.
    pub(crate) sink: Sink,
    /// Recordings.
    pub(crate) tracks: Recordings,
    /// Shapes of regions known so far.
    pub(crate) shapes: Vec<Option<Lowered<Shape>>>,
    /// Kinds known so far.
    pub(crate) kinds: BTreeMap<String, Lowered<Kind>>,
    /// The scene.
    pub(crate) scene: Scene,
    /// The floor plans that have a name.
    pub(crate) plans: Vec<FloorPlan>,
    /// The levels of the scene.
    pub(crate) levels: Levels,
    /// Processes so far.
    pub(crate) processes: Vec<Declared<'a>>,
    /// Behaviours, and who has them.
    pub(crate) conducts: Conducts<'a>,
    /// The agents.
    pub(crate) roster: Roster,
    /// Whether a part of the scenario was left out, which is never done without an error.
    pub(crate) given_up: bool,
    /// Where processes and behaviours are written.
    pub(crate) origins: Origins,
    /// Clock and horizon.
    pub(crate) time: Time,
    /// Whether formulas over time are allowed at present.
    pub(crate) temporal: bool,
    /// The formulas, and what they observe.
    pub(crate) observed: Observed,
    /// The words of what is written.
    pub(crate) words: Words,
    /// Size and depth of expressions.
    pub(crate) extent: Extent,
    /// Knowledge about margins, while the formula of a robustness is lowered.
    pub(crate) margins: Option<Margins>,
    /// Parts of the files that could not be read.
    pub(crate) torn: Vec<&'a Broken>,
    /// The meaning of each name in words, where somebody wants to know.
    pub(crate) notes: Option<Notes>,
}

impl<'a> Context<'a> {
    /// Nothing known yet.
    pub(crate) fn new(sources: &'a [Source], settings: BTreeMap<String, Number>) -> Self {
        Self {
            sources,
            names: Names { scopes: vec![Scope::default()], settings, ..Names::default() },
            sink: Sink::default(),
            tracks: Recordings::default(),
            shapes: Vec::new(),
            kinds: BTreeMap::new(),
            scene: Scene::default(),
            plans: Vec::new(),
            levels: Levels::default(),
            processes: Vec::new(),
            conducts: Conducts::default(),
            roster: Roster::default(),
            given_up: false,
            origins: Origins::default(),
            time: Time::default(),
            temporal: false,
            observed: Observed::default(),
            words: Words::default(),
            extent: Extent::default(),
            margins: None,
            torn: Vec::new(),
            notes: None,
        }
    }

    /// Reports an error.
    pub(crate) fn report<T>(&mut self, diagnostic: Diagnostic) -> Lowered<T> {
        self.note(diagnostic);
        Err(Reported)
    }

    /// Notes an error or warning, each place once.
    pub(crate) fn note(&mut self, diagnostic: Diagnostic) {
        let is_error = diagnostic.severity == Severity::Error;
        if !(self.sink.is_astray && is_error) || self.names.is_sure(&diagnostic) {
            self.sink.note(diagnostic);
        }
    }

    /// Keeps only the errors, from a given one on, that are found whatever the values of parameters are: in a world that
    /// replaces one that could not be set up.
    pub(crate) fn keep_sure(&mut self, from: usize) {
        let found = self.sink.diagnostics.split_off(from.min(self.sink.diagnostics.len()));
        self.sink.diagnostics.extend(found.into_iter().filter(|one| self.names.is_sure(one)));
    }

    /// The text of a span in one line, without comments.
    pub(crate) fn text(&self, span: Span) -> String {
        let text = self.sources.iter().find(|s| s.id == span.source).map_or("", |s| s.slice(span));
        without_comments(text).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Expected one thing, found another.
    pub(crate) fn mismatch<T>(&mut self, span: Span, expected: &str, found: &Typed) -> Lowered<T> {
        let error = error!(E0305, span, "expected {expected}, found {}", found.noun());
        let error = match self.other_kind(span, expected, found) {
            Some(hint) => error.hint(hint),
            None => error,
        };
        self.report(error)
    }

    /// The text to write where one kind of value was expected and another one found.
    fn other_kind(&self, span: Span, expected: &str, found: &Typed) -> Option<String> {
        let text = Some(self.text(span)).filter(|text| text.len() <= 60 && !text.is_empty())?;
        match (expected, found) {
            ("a number", Typed::Truth(..)) => {
                Some(format!("write `if({text}, 1, 0)`; its probability is `P({text})`"))
            }
            ("a condition", Typed::Number(_) | Typed::Num(..) | Typed::Term(..)) => {
                Some(format!("compare it with a value: `{text} > …`"))
            }
            ("a line", _) => {
                let lines = || self.names.scopes.first().into_iter().flat_map(Scope::entries);
                let lines = lines().filter(|(_, entry)| matches!(entry.meaning, Meaning::Line(_)));
                let lines: Vec<String> = lines.map(|(name, _)| name.to_owned()).collect();
                Some(match lines.as_slice() {
                    [] => "declare one in the scene: `line gate: (6, 0) -- (6, 3)`".to_owned(),
                    known => format!("the scene declares the lines {}", known.join(", ")),
                })
            }
            _ => None,
        }
    }

    /// Two dimensions that ought to be one.
    pub(crate) fn wrong_dimension<T>(
        &mut self,
        span: Span,
        expected: Dimension,
        found: Dimension,
    ) -> Lowered<T> {
        let error = self.other_dimension(span, expected, found);
        self.report(error)
    }

    pub(crate) fn other_dimension(&self, span: Span, expected: Dimension, found: Dimension) -> Diagnostic {
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
        if expected.is_none() && !found.is_none() && text.len() <= 60 {
            error = error.hint(match single_number(&text) {
                Some(number) => format!("write `{number}`"),
                None => format!("divide it by a unit: `({text}) / 1 {found}`"),
            });
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
        let from = self.names.bare.range(Span { end: 0, ..place }..);
        let mut within = from.take_while(|(name, _)| name.source == place.source && name.start < place.end);
        let (_, first) = within.next()?;
        within.all(|(_, other)| other == first).then_some(*first)
    }
}
