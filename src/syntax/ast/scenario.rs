//! Scenario files (`.scn`).

use super::{
    BehaviourDecl, Broken, Expr, Field, Ident, ProcessDecl, ProgramDecl, SceneItem, SourceDecl, Text, Value,
};
use crate::syntax::source::Span;

/// A whole scenario file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScenarioFile {
    /// Declarations in order of writing.
    pub items: Vec<Item>,
    /// Items that could not be read, and heads of those whose values could not; that was reported.
    pub broken: Vec<Broken>,
    /// Whether something was wrong.
    pub fails: bool,
    /// Whether items may stand in the wrong blocks, since braces do not pair up or the text ends in a comment; that was
    /// reported.
    pub is_torn: bool,
}

/// One declaration.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// `scenario "Title"`
    Title(Text),
    /// `horizon = 30 s`, `step = 0.02 s`
    Setting {
        /// `horizon` or `step`, or a name that compilation will refuse.
        name: Ident,
        /// Its value.
        value: Expr,
    },
    /// `const WIDTH = 4 m`
    Const {
        /// Its name.
        name: Ident,
        /// Its value.
        value: Expr,
    },
    /// `param density = 0.4 /m^2 in 0 /m^2 .. 2 /m^2`
    Param {
        /// Its name.
        name: Ident,
        /// Default.
        value: Expr,
        /// Legal range, ends included.
        range: Option<(Expr, Expr)>,
        /// The names from which it chooses; empty if it is a number. Its default is one of them.
        choices: Vec<Ident>,
    },
    /// `let gap(a) = …`
    Let(LetDecl),
    /// `tracks hotel = eth_biwi "seq_hotel/obsmat.txt"`
    Tracks {
        /// Name of the recording.
        name: Ident,
        /// Format and file; `None` for what is observed while it happens: `stream`.
        file: Option<(Ident, Text)>,
        /// Its fields.
        body: Vec<Field>,
    },
    /// `scene { … }`
    Scene(Vec<SceneItem>),
    /// `kind adult: sfm { … }`
    Kind(KindDecl),
    /// `agent user: adult { … }`, `agents crowd[12]: adult { … }`
    Agents(AgentsDecl),
    /// `group friends[2]: companion { … }`
    Group(GroupDecl),
    /// `moves user for 2 s { … }`
    Moves(MovesDecl),
    /// `paths user { roadmap alternatives 4 }`
    Paths(PathsDecl),
    /// `process queue { … }`
    Process(ProcessDecl),
    /// `program sim { … }`
    Program(ProgramDecl),
    /// `behaviour phone { … }`
    Behaviour(BehaviourDecl),
    /// `source doors: adult { … }`
    Source(SourceDecl),
}

/// `let gap(a) = distance(user, a) - radius(a)`; without arguments a named expression.
#[derive(Clone, Debug, PartialEq)]
pub struct LetDecl {
    /// Its name.
    pub name: Ident,
    /// Names of its arguments.
    pub arguments: Vec<Ident>,
    /// Its value.
    pub body: Expr,
}

/// `kind adult: sfm preset helbing2000 { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct KindDecl {
    /// Its name.
    pub name: Ident,
    /// `sfm`, or the kind it starts from; `None` if its preset tells.
    pub base: Option<Ident>,
    /// `preset name`: of a preset, or of a parameter that chooses one.
    pub preset: Option<Ident>,
    /// Whether the call chooses the preset: a field that it lacks is left out then, with a warning.
    pub is_replaced: bool,
    /// Its fields.
    pub body: Vec<Field>,
}

/// Somebody who was recorded, or everybody in somebody's group.
#[derive(Clone, Debug, PartialEq)]
pub struct Whom {
    /// The id of a person.
    pub id: Expr,
    /// Whether it stands for the whole group of this person.
    pub is_group: bool,
}

/// `from hotel at 646.8 s id 367`, `from hotel at 646.8 s except 367, 368`, `from hotel at 646.8 s`
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Name of the recording.
    pub tracks: Ident,
    /// When.
    pub at: Expr,
    /// `id 367`, `id 3, 4` or `group of 367`: only these.
    pub only: Vec<Whom>,
    /// `except 367, group of 368`: all present but these.
    pub except: Vec<Whom>,
    /// Where.
    pub span: Span,
}

/// `agent user: adult { … }` or `agents crowd[12]: adult { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct AgentsDecl {
    /// Whether the keyword was `agents`.
    pub plural: bool,
    /// Name of the agent or set.
    pub name: Ident,
    /// `[n]`
    pub count: Option<Expr>,
    /// Its kind.
    pub kind: Ident,
    /// Behaviours attached by `with`: calls or names.
    pub with: Vec<Expr>,
    /// Start state from a recording.
    pub recorded: Option<Recorded>,
    /// Its fields, including those of kinds.
    pub body: Vec<Field>,
}

/// `group friends[2]: companion as particle { … }`, or one for each inferred group:
/// `groups crowd: adult as particle from hotel at 646.8 s`
#[derive(Clone, Debug, PartialEq)]
pub struct GroupDecl {
    /// Whether the keyword was `groups`.
    pub plural: bool,
    /// Its name.
    pub name: Ident,
    /// Number of members, unless a recording tells it.
    pub count: Option<Expr>,
    /// Kind of its members.
    pub kind: Ident,
    /// The place of `as particle`, if present.
    pub particle: Option<Span>,
    /// Behaviours attached by `with`.
    pub with: Vec<Expr>,
    /// Start state from a recording.
    pub recorded: Option<Recorded>,
    /// Its fields.
    pub body: Vec<Field>,
}

/// `moves user for 2 s { heading from -60 deg to 60 deg by 15 deg; stop }`
#[derive(Clone, Debug, PartialEq)]
pub struct MovesDecl {
    /// The agent with the moves, or its declaration.
    pub agent: Ident,
    /// Which member of the declaration.
    pub member: Option<Expr>,
    /// For how long.
    pub duration: Expr,
    /// The options.
    pub options: Vec<MoveOption>,
    /// Where.
    pub span: Span,
}

/// `paths people[1] { roadmap alternatives 4 }`
#[derive(Clone, Debug, PartialEq)]
pub struct PathsDecl {
    /// The agent with the paths, or its declaration.
    pub agent: Ident,
    /// Which member of the declaration.
    pub member: Option<Expr>,
    /// At most so many.
    pub alternatives: Expr,
    /// Where.
    pub span: Span,
}

/// Options of a move.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a scenario has few moves")]
pub enum MoveOption {
    /// `heading from a to b by c`
    Headings {
        /// First.
        from: Expr,
        /// Last.
        to: Expr,
        /// Apart.
        by: Expr,
        /// Where.
        span: Span,
    },
    /// `heading 15 deg`
    Heading(Expr),
    /// `route left = (4, 1) -> exit`
    Route {
        /// Its name.
        name: Ident,
        /// The route.
        route: Value,
        /// Where.
        span: Span,
    },
    /// `stop`
    Stop(Span),
}
