//! Names and what they stand for. Order of declaration does not matter; each name has one meaning.

use crate::compile::nearest::nearest;
use crate::model::{AgentId, BarrierId, BehaviourId, LineId, RegionId};
use crate::syntax::ast::{Expr, Ident, KindDecl, LetDecl, ShapeExpr};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic};
use crate::syntax::source::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Which table of names: the scenario's is 0, property file k has k + 1.
pub(crate) type ScopeId = usize;

/// A parameter of the call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Param<'a> {
    /// Its default.
    pub(crate) value: &'a Expr,
    /// Its legal range.
    pub(crate) range: Option<&'a (Expr, Expr)>,
    /// The names from which it chooses, if it is no number: its value is the place of one of them.
    pub(crate) choices: &'a [Ident],
}

/// The meaning of a name.
#[derive(Clone, Debug)]
pub(crate) enum Meaning<'a> {
    /// A constant, evaluated when it is first used.
    Constant(&'a Expr),
    /// A parameter of the call.
    Param(Param<'a>),
    /// A named expression or function.
    Let(&'a LetDecl),
    /// A property.
    Property(&'a Expr),
    /// A region of the scene.
    Region(RegionId, &'a ShapeExpr),
    /// A wall or obstacle.
    Barrier(BarrierId),
    /// A measurement line.
    Line(LineId),
    /// A named point.
    Point(&'a Expr),
    /// A floor plan.
    Plan(usize),
    /// A level.
    Level(usize),
    /// A flight of stairs, by its region.
    Stairs(RegionId),
    /// A kind.
    Kind(&'a KindDecl),
    /// A recording.
    Tracks(usize),
    /// A process, or an array of them.
    Process(u32),
    /// A behaviour.
    Behaviour(BehaviourId),
    /// Ambiguous: declared as two different things, which was reported.
    Doubtful,
    /// Agents that are declared but not elaborated yet.
    Declared,
    /// One agent.
    Agent(AgentId),
    /// Several agents; `particle` where one body stands for all.
    Agents {
        /// Ascending.
        members: Arc<[AgentId]>,
        /// Whether one body stands for all.
        particle: bool,
    },
}

impl Meaning<'_> {
    /// Whether two meanings go where the same things go: then it matters little which of the two a name has.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let group = |meaning: &Self| match meaning {
            Self::Region(..) | Self::Stairs(_) => Some(0),
            Self::Barrier(_) => Some(1),
            Self::Kind(_) => Some(2),
            Self::Tracks(_) => Some(3),
            Self::Process(_) => Some(4),
            Self::Behaviour(_) => Some(5),
            Self::Line(_) => Some(6),
            // Numbers have units, functions arguments, of several people one is chosen.
            _ => None,
        };
        group(self).is_some_and(|own| group(other) == Some(own))
    }

    /// Where what it stands for is written, if that is an expression or a shape.
    pub(crate) fn body(&self) -> Option<Span> {
        match self {
            Self::Constant(value)
            | Self::Param(Param { value, .. })
            | Self::Property(value)
            | Self::Point(value) => Some(value.span),
            Self::Let(decl) => Some(decl.body.span),
            Self::Region(_, shape) => Some(shape.span()),
            _ => None,
        }
    }

    /// Its name in messages.
    pub(crate) fn noun(&self) -> &'static str {
        match self {
            Self::Constant(_) => "a constant",
            Self::Param(_) => "a parameter",
            Self::Let(decl) if decl.arguments.is_empty() => "a named expression",
            Self::Let(_) => "a function",
            Self::Property(_) => "a property",
            Self::Region(..) => "a region",
            Self::Barrier(_) => "a wall or obstacle",
            Self::Line(_) => "a line",
            Self::Point(_) => "a point",
            Self::Plan(_) => "a floor plan",
            Self::Level(_) => "a level",
            Self::Stairs(_) => "a flight of stairs",
            Self::Kind(_) => "a kind",
            Self::Tracks(_) => "a recording",
            Self::Process(_) => "a process",
            Self::Behaviour(_) => "a behaviour",
            Self::Declared | Self::Agent(_) => "an agent",
            Self::Agents { .. } => "a set of agents",
            Self::Doubtful => "declared twice",
        }
    }
}

/// A name's meaning and the place of its declaration.
#[derive(Clone, Debug)]
pub(crate) struct Entry<'a> {
    /// Where it was declared.
    pub(crate) span: Span,
    /// Its meaning.
    pub(crate) meaning: Meaning<'a>,
}

/// One table of names.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scope<'a> {
    entries: BTreeMap<String, Entry<'a>>,
}

impl<'a> Scope<'a> {
    /// Declares a name; a second declaration is an error that shows both places.
    pub(crate) fn declare(&mut self, name: &str, span: Span, meaning: Meaning<'a>) -> Result<(), Diagnostic> {
        if let Some(first) = self.entries.get(name) {
            return Err(error!(E0202, span, "`{name}` is declared twice")
                .related(first.span, "first declared here")
                .hint("rename one of them"));
        }
        self.entries.insert(name.to_owned(), Entry { span, meaning });
        Ok(())
    }

    /// Replaces the meaning of a name where it was declared; who took a name that was taken changes nothing.
    pub(crate) fn define(&mut self, name: &Ident, meaning: Meaning<'a>) {
        if let Some(entry) = self.entries.get_mut(&name.name)
            && entry.span == name.span
        {
            entry.meaning = meaning;
        }
    }

    /// The entry of a name.
    pub(crate) fn get(&self, name: &str) -> Option<&Entry<'a>> {
        self.entries.get(name)
    }

    /// All names, sorted.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    /// All entries, sorted by name.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (&str, &Entry<'a>)> {
        self.entries.iter().map(|(name, entry)| (name.as_str(), entry))
    }
}

/// Words of other programs for fields, and the field.
const SPOKEN: [(&[&str], &str); 7] = [
    (&["goal", "goals", "target", "destination", "waypoint", "waypoints", "path"], "route"),
    (&["start", "origin", "position", "pos", "from", "place"], "at"),
    (&["max_speed", "max_velocity", "desired_speed", "preferred_speed", "v0", "vmax"], "speed"),
    (&["weight"], "mass"),
    (&["size", "diameter", "width"], "radius"),
    (&["duration", "time", "end", "length", "t_max", "tmax"], "horizon"),
    (&["dt", "timestep", "time_step", "tick"], "step"),
];

/// The known name that an unknown one stands for: in other programs, or as the nearest one.
pub(crate) fn meant<'n>(name: &str, known: &[&'n str]) -> Option<&'n str> {
    let spoken = |ours: &&str| SPOKEN.iter().any(|(theirs, word)| word == ours && theirs.contains(&name));
    known.iter().copied().find(spoken).or_else(|| nearest(name, known.iter().copied()))
}

/// An unknown name, with the nearest known one as a hint.
pub(crate) fn unknown<'n>(
    what: &str,
    name: &str,
    span: Span,
    code: Code,
    known: impl Iterator<Item = &'n str>,
) -> Diagnostic {
    let error = Diagnostic::error(code, span, format!("unknown {what} `{name}`"));
    let known: Vec<&str> = known.collect();
    let error = error.about(About::Name(name.to_owned())).knowing(known.iter().copied());
    match meant(name, &known) {
        Some(near) => error.hint(format!("did you mean `{near}`?")),
        None => error,
    }
}
