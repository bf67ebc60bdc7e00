//! Expressions: one grammar of values, formulas and metrics for both languages.

use crate::base::decimal::Decimal;
use crate::syntax::source::Span;

/// A name and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ident {
    /// As written.
    pub name: String,
    /// Where.
    pub span: Span,
}

/// A quoted text and its place (quotes included).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// Without the quotes, escapes resolved.
    pub value: String,
    /// Where.
    pub span: Span,
}

/// One factor of a unit: `m^2` is (`m`, 2); `/s` is (`s`, -1).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitFactor {
    /// Name of the unit.
    pub name: Ident,
    /// Its power; negative after a slash.
    pub power: i32,
}

/// A unit as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitExpr {
    /// Its factors in order of writing.
    pub factors: Vec<UnitFactor>,
    /// Where, for messages in the unit as written.
    pub span: Span,
}

/// A number literal with its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Exact value of the digits.
    pub value: Decimal,
    /// Unit, if any (`%` and `steps` are units).
    pub unit: Option<UnitExpr>,
}

/// Prefix operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// Arithmetic minus.
    Minus,
    /// Logical not.
    Not,
}

/// Infix operators without bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `<=>`
    Iff,
    /// `=>`
    Implies,
    /// `|`
    Or,
    /// `&`
    And,
    /// `==`
    Equal,
    /// `!=`
    Unequal,
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
    /// `in`
    In,
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `*`
    Times,
    /// `/`
    Over,
    /// `^`
    Power,
}

/// Temporal operators of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Temporal {
    /// `F`
    Finally,
    /// `G`
    Globally,
    /// `X`
    Next,
}

/// Temporal operators of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemporalPair {
    /// `U`
    Until,
    /// `R`
    Release,
    /// `W`
    WeakUntil,
}

/// Aggregates of a number, over agents or over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aggregate {
    /// Smallest.
    Min,
    /// Largest.
    Max,
    /// Sum.
    Sum,
    /// Mean.
    Mean,
}

/// A construct that binds a name over a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantifier {
    /// `forall a in S: body`
    Forall,
    /// `exists a in S: body`
    Exists,
    /// `count(a in S: body)`
    Count,
    /// `min(body for a in S)` and its like
    Fold(Aggregate),
}

/// Bound of a temporal operator.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// `<= e`, where `e` is a literal (`10 s`, `40 steps`, `#40`, `∞`), a name or in parentheses. `#40`
    /// is the quantity 40 with unit `steps`.
    AtMost(Box<Expr>),
    /// `[a, b]`
    Interval(Box<Expr>, Box<Expr>),
}

/// When a metric is read.
#[derive(Clone, Debug, PartialEq)]
pub enum Moment {
    /// `at end`: the state at the horizon.
    End,
    /// `at 5 s`
    Time(Box<Expr>),
}

/// An expression and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Its kind.
    pub kind: ExprKind,
    /// Where.
    pub span: Span,
}

/// The kind of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `0.2 m/s`
    Quantity(Quantity),
    /// `∞`
    Infinity,
    /// A value that could not be read; that was reported.
    Broken,
    /// `true`, `false`
    Bool(bool),
    /// `"text"` (filters of imports)
    Text(String),
    /// A name: of a constant, agent, group, region, variable, function argument.
    Name(String),
    /// `queue.n`
    Member(Box<Expr>, Ident),
    /// `people[1]`
    Index(Box<Expr>, Box<Expr>),
    /// `distance(user, a)`; also `min(a, b)` of plain values, and distributions: `normal(1 m, 0.1 m)`
    Call {
        /// Function name; functions live in a space of names of their own.
        function: Ident,
        /// Arguments. Named ones (`prm(samples = 500)`) are not part of this tree.
        arguments: Vec<Expr>,
    },
    /// `(1, 2) m`
    Point {
        /// First coordinate.
        x: Box<Expr>,
        /// Second coordinate.
        y: Box<Expr>,
        /// Unit after the parenthesis.
        unit: Option<UnitExpr>,
    },
    /// `-x`, `!p`
    Unary(UnaryOp, Box<Expr>),
    /// `a + b`, `p & q`, `a in exit`
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `forall a in others(user): …`, `count(a in crowd: …)`, `min(… for a in …)`
    Quantified {
        /// Which.
        quantifier: Quantifier,
        /// The bound name.
        variable: Ident,
        /// The set it ranges over.
        set: Box<Expr>,
        /// The condition for each member. For `count(a in S)` without a condition: `true`.
        body: Box<Expr>,
    },
    /// `F<=10 s p`
    Temporal(Temporal, Option<Bound>, Box<Expr>),
    /// `p U<=10 s q`
    TemporalPair(TemporalPair, Option<Bound>, Box<Expr>, Box<Expr>),
    /// `min<=10 s (e)`, over the states of a window
    Window(Aggregate, Bound, Box<Expr>),
    /// `e at end`: only directly inside `E(…)` and `Q(…)`
    At(Box<Expr>, Moment),
}

/// `name = value` of a `under` clause.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// Parameter.
    pub name: Ident,
    /// Its value.
    pub value: Expr,
}
