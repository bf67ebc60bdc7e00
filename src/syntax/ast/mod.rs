//! Syntax trees of both languages. Every node knows its place; nothing is resolved yet.

pub mod expression;
pub mod field;
pub mod process;
pub mod property;
pub mod scenario;
pub mod scene;

use crate::syntax::keywords::Place;
use crate::syntax::source::Span;

/// An item that could not be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Where.
    pub span: Span,
    /// The part of the file that it stands in.
    pub place: Place,
    /// The name behind its first word, where one stands there.
    pub name: Option<String>,
    /// Its words, among them the names that it may declare.
    pub words: Vec<String>,
}

pub use expression::{
    Aggregate, BinaryOp, Binding, Bound, Expr, ExprKind, Ident, Moment, Quantifier, Quantity, Temporal,
    TemporalPair, Text, UnaryOp, UnitExpr, UnitFactor,
};
pub use field::{Field, Leg, Route, ShapeExpr, Value};
pub use process::{
    BehaviourDecl, BehaviourItem, Branch, Choice, Command, Domain, OnDecl, ProcessDecl, ProcessItem,
    ProgramDecl, ShownDecl, SourceDecl, StateDecl, Timing, Transition, Update, VarDecl,
};
pub use property::{
    Clauses, Constraint, Measure, MeasureKind, Method, PropertyFile, PropertyItem, Query, QueryKind, Ranked,
    Values,
};
pub use scenario::{
    AgentsDecl, GroupDecl, Item, KindDecl, LetDecl, MoveOption, MovesDecl, PathsDecl, Recorded, ScenarioFile,
    Whom,
};
pub use scene::SceneItem;
