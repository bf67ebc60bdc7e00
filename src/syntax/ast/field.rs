//! Fields of declarations in scenario files, and their values.

use super::{Binding, Expr, Ident, Text};
use crate::syntax::source::Span;

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

impl Leg {
    fn span(&self) -> Span {
        match self {
            Self::Goal(goal) => goal.span,
            Self::Wait(value) => value.span(),
        }
    }
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
