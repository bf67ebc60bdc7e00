//! Scenario files (`.scn`).

use super::{BehaviourDecl, Binding, Broken, Expr, Ident, ProcessDecl, ProgramDecl, SourceDecl, Text};
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

impl SceneItem {
    /// The item itself, or those of a level.
    pub fn on_all_levels(&self) -> impl Iterator<Item = &Self> {
        let within = if let Self::Level { items, .. } = self { items.as_slice() } else { &[] };
        std::iter::once(self).chain(within)
    }
}

/// One declaration of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneItem {
    /// `wall south: (0, 0) -- (20, 0) -- …`
    Wall {
        /// Its name, if any.
        name: Option<Ident>,
        /// Points joined by straight segments, at least two.
        points: Vec<Expr>,
        /// Where.
        span: Span,
    },
    /// `obstacle pillar: circle (10, 2) radius 0.3 m`
    Obstacle {
        /// Its name, if any.
        name: Option<Ident>,
        /// Its shape.
        shape: ShapeExpr,
    },
    /// `region exit: rect (18.5, 0) .. (20, 4)`, `region out: west, east`
    Region {
        /// Its name.
        name: Ident,
        /// Its shape.
        shape: ShapeExpr,
    },
    /// `point door: (3, 4)`
    Point {
        /// Its name.
        name: Ident,
        /// Its shape.
        at: Expr,
    },
    /// `line door: (3, 0) -- (3, 2)`
    Line {
        /// Its name.
        name: Ident,
        /// Its ends.
        ends: [Expr; 2],
        /// Where.
        span: Span,
    },
    /// `door main: (3, 0) -- (3, 2) { closed = shut == 1 }`
    Door {
        /// Its name.
        name: Ident,
        /// Its ends.
        ends: [Expr; 2],
        /// When it is closed.
        fields: Vec<Field>,
        /// Where.
        span: Span,
    },
    /// `level first { height = 4 m; … }`: its items have names such as `first.exit`.
    Level {
        /// Its name.
        name: Ident,
        /// Its height.
        fields: Vec<Field>,
        /// Its walls, regions and so on.
        items: Vec<SceneItem>,
    },
    /// `stairs s: ground.foot -- first.head { width = 1.4 m; run = 6 m }`
    Stairs {
        /// Its name.
        name: Ident,
        /// Its lower and its upper line.
        ends: [Expr; 2],
        /// Width, run and speeds.
        fields: Vec<Field>,
        /// Where.
        span: Span,
    },
    /// `periodic x in 0 m .. 20 m`
    Periodic {
        /// `x` or `y`, or a name that compilation will refuse.
        axis: Ident,
        /// Its ends.
        ends: [Expr; 2],
        /// Where.
        span: Span,
    },
    /// `import "file.geojson" where source == "map.png"`
    Import {
        /// File.
        path: Text,
        /// Whether its polygons are where agents move: `as walkable`.
        walkable: bool,
        /// Which features: comparisons of their properties with texts and numbers, joined by `&`, `|`, `!`.
        filter: Option<Expr>,
        /// Its name, by which its rooms and doors are named: `as plan`.
        called: Option<Ident>,
        /// How it is read: `{ snap = 5 cm }`.
        fields: Vec<Field>,
        /// Where.
        span: Span,
    },
}

/// A shape as written.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeExpr {
    /// The name of a region.
    Named(Ident),
    /// `plan.foyer`, `plan["Room 12"]`: a room of a floor plan.
    Of(Expr),
    /// `circle (10, 2) radius 0.3 m`
    Circle {
        /// Centre.
        centre: Expr,
        /// Radius.
        radius: Expr,
        /// Where.
        span: Span,
    },
    /// `rect (0, 0) .. (1, 4)`
    Rectangle {
        /// One corner.
        a: Expr,
        /// The opposite corner.
        b: Expr,
        /// Where.
        span: Span,
    },
    /// `polygon (4, 4) (14, 4) (4, 14) hole (5, 5) (6, 5) (5, 6)`
    Polygon {
        /// Corners of the outline.
        outline: Vec<Expr>,
        /// Corners of each hole.
        holes: Vec<Vec<Expr>>,
        /// Where.
        span: Span,
    },
    /// `west, circle (10, 2) radius 0.3 m`: the parts of a region.
    Parts(Vec<Self>),
}

/// `name = value`
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The setting.
    pub name: Ident,
    /// To what.
    pub value: Value,
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// An expression, a distribution (a call) among them.
    Plain(Expr),
    /// `normal(75 kg, 10 kg) in 45 kg .. 120 kg`
    Truncated {
        /// The distribution.
        law: Expr,
        /// Lower end.
        low: Expr,
        /// Upper end.
        high: Expr,
    },
    /// `uniform in hall`
    UniformIn(ShapeExpr),
    /// `near user within 2 m`
    Near {
        /// The agent.
        agent: Expr,
        /// Largest distance of the centres.
        within: Expr,
    },
    /// `(9, 3) -> exit`, `exit then leave`, with at least two legs or a `then`; a single goal is `Plain`.
    Route(Route),
    /// `0.8 m/s^2 along, 1.6 m/s^2 across`
    Sided {
        /// Along the way.
        along: Box<Value>,
        /// Across it.
        across: Box<Value>,
    },
    /// `prm(samples = 500, sampling = bridge)`
    Arguments {
        /// What they are arguments of.
        name: Ident,
        /// The arguments.
        arguments: Vec<Binding>,
    },
    /// `learned "operators.gait"`, `as_published "operators.gait"`
    Learned {
        /// The file.
        file: Text,
        /// Whether steps are chosen as published, too.
        as_published: bool,
        /// Where all of it stands.
        span: Span,
    },
    /// `sfm preset helbing2000`
    Force {
        /// The kind.
        kind: Ident,
        /// Its preset.
        preset: Ident,
    },
}

/// A route as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Legs in order.
    pub legs: Vec<Leg>,
    /// `then leave`: depart on reaching the last goal.
    pub then_leave: Option<Span>,
}

/// One leg of a route.
#[derive(Clone, Debug, PartialEq)]
pub enum Leg {
    /// A region, point or coordinates.
    Goal(Expr),
    /// `wait lognormal(6 s, 1 s)`: a plain or truncated value.
    Wait(Box<Value>),
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

impl Value {
    /// Where it is written.
    pub fn span(&self) -> Span {
        match self {
            Self::Plain(expr) => expr.span,
            Self::Truncated { law, high, .. } => law.span.to(high.span),
            Self::UniformIn(shape) => shape.span(),
            Self::Near { agent, within } => agent.span.to(within.span),
            Self::Route(route) => route.legs.iter().map(Leg::span).reduce(Span::to).unwrap_or_default(),
            Self::Sided { along, across } => along.span().to(across.span()),
            Self::Arguments { name, arguments } => {
                arguments.iter().fold(name.span, |span, argument| span.to(argument.value.span))
            }
            Self::Learned { span, .. } => *span,
            Self::Force { kind, preset } => kind.span.to(preset.span),
        }
    }
}

impl Leg {
    fn span(&self) -> Span {
        match self {
            Self::Goal(goal) => goal.span,
            Self::Wait(value) => value.span(),
        }
    }
}

impl ShapeExpr {
    /// Where it is written.
    pub fn span(&self) -> Span {
        match self {
            Self::Named(name) => name.span,
            Self::Of(room) => room.span,
            Self::Circle { span, .. } | Self::Rectangle { span, .. } | Self::Polygon { span, .. } => *span,
            Self::Parts(parts) => {
                let spans = parts.iter().map(Self::span);
                spans.reduce(Span::to).unwrap_or_default()
            }
        }
    }
}
