//! Syntax trees of both languages. Every node knows its place; nothing is resolved yet.

pub mod expression;
pub mod property;
pub mod scenario;

pub use expression::{
    Aggregate, BinaryOp, Bound, Expr, ExprKind, Ident, Moment, Quantifier, Quantity, Text, UnaryOp, UnitExpr,
    UnitFactor,
};
pub use property::{
    Binding, Clauses, Measure, MeasureKind, Method, PropertyFile, PropertyItem, Query, QueryKind,
};
pub use scenario::{
    AgentsDecl, Field, GroupDecl, Item, KindDecl, Leg, LetDecl, MoveOption, MovesDecl, Recorded, Route,
    ScenarioFile, SceneItem, ShapeExpr, Value,
};
