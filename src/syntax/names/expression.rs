//! The names in expressions, values of fields and shapes.

use super::Walk;
use crate::syntax::ast::{
    Binding, Bound, Expr, ExprKind, Field, Ident, Leg, LetDecl, Moment, ShapeExpr, Value, Values,
};

impl Walk {
    pub(super) fn exprs<'e>(&mut self, exprs: impl IntoIterator<Item = &'e Expr>) {
        for expr in exprs {
            self.expr(expr);
        }
    }

    /// An expression; the declaration that it names, if it is a name.
    pub(super) fn expr(&mut self, expr: &Expr) -> Option<usize> {
        match &expr.kind {
            ExprKind::Quantity(_)
            | ExprKind::Infinity
            | ExprKind::Broken
            | ExprKind::Bool(_)
            | ExprKind::Text(_) => {}
            ExprKind::Name(name) => return self.note(expr.span, self.look_up(name)),
            ExprKind::Member(base, member) => {
                let of = self.expr(base);
                return self.member(of, member);
            }
            ExprKind::Index(base, index) => {
                self.expr(index);
                return self.expr(base);
            }
            ExprKind::Call { function, arguments } => {
                self.used(function);
                self.exprs(arguments);
            }
            ExprKind::Point { x, y, .. } => self.exprs([&**x, y]),
            ExprKind::Unary(_, operand) => self.exprs([&**operand]),
            ExprKind::Binary(_, left, right) => {
                let of = self.expr(left);
                let behaviour = of.filter(|at| self.names.declared[*at].noun == "behaviour");
                match (&right.kind, behaviour) {
                    // `user.phone == looking`: a state of the behaviour.
                    (ExprKind::Name(state), Some(_)) => {
                        self.member(behaviour, &Ident { name: state.clone(), span: right.span });
                    }
                    _ => self.exprs([&**right]),
                }
            }
            ExprKind::Quantified { variable, set, body, .. } => {
                self.expr(set);
                self.binding(std::slice::from_ref(variable), |walk| walk.exprs([&**body]));
            }
            ExprKind::Temporal(_, bound, body) => {
                self.time_bound(bound.as_ref());
                self.expr(body);
            }
            ExprKind::TemporalPair(_, bound, left, right) => {
                self.time_bound(bound.as_ref());
                self.exprs([&**left, right]);
            }
            ExprKind::Window(_, bound, body) => {
                self.time_bound(Some(bound));
                self.expr(body);
            }
            ExprKind::At(inner, moment) => {
                self.expr(inner);
                if let Moment::Time(time) = moment {
                    self.expr(time);
                }
            }
        }
        None
    }

    pub(super) fn time_bound(&mut self, bound: Option<&Bound>) {
        match bound {
            Some(Bound::AtMost(end)) => self.exprs([&**end]),
            Some(Bound::Interval(from, to)) => self.exprs([&**from, to]),
            None => {}
        }
    }

    pub(super) fn bindings(&mut self, bindings: &[Binding]) {
        for binding in bindings {
            self.used(&binding.name);
            self.expr(&binding.value);
        }
    }

    pub(super) fn values(&mut self, values: &Values) {
        self.exprs(values.parts());
    }

    pub(super) fn fields(&mut self, fields: &[Field]) {
        for field in fields {
            self.value(&field.value);
        }
    }

    pub(super) fn value(&mut self, value: &Value) {
        match value {
            Value::Plain(expr) => self.exprs([expr]),
            Value::Truncated { law, low, high } => self.exprs([law, low, high]),
            Value::UniformIn(shape) => self.shape(shape),
            Value::Near { agent, within } => self.exprs([agent, within]),
            Value::Route(route) => {
                for leg in &route.legs {
                    match leg {
                        Leg::Goal(goal) => self.exprs([goal]),
                        Leg::Wait(value) => self.value(value),
                    }
                }
            }
            Value::Sided { along, across } => [along, across].into_iter().for_each(|side| self.value(side)),
            Value::Arguments { arguments, .. } => {
                self.exprs(arguments.iter().map(|argument| &argument.value));
            }
            Value::Learned { .. } | Value::Force { .. } => {}
        }
    }

    pub(super) fn shape(&mut self, shape: &ShapeExpr) {
        match shape {
            ShapeExpr::Named(name) => {
                self.used(name);
            }
            ShapeExpr::Of(room) => self.exprs([room]),
            ShapeExpr::Circle { centre, radius, .. } => self.exprs([centre, radius]),
            ShapeExpr::Rectangle { a, b, .. } => self.exprs([a, b]),
            ShapeExpr::Polygon { outline, holes, .. } => {
                self.exprs(outline.iter().chain(holes.iter().flatten()));
            }
            ShapeExpr::Parts(parts) => parts.iter().for_each(|part| self.shape(part)),
        }
    }

    pub(super) fn named_expression(&mut self, noun: &'static str, decl: &LetDecl) {
        let at = self.declare(noun, &decl.name, decl.body.span, Some(&decl.body));
        if let Some(declared) = self.names.declared.get_mut(at) {
            declared.arguments = decl.arguments.iter().map(|argument| argument.name.clone()).collect();
        }
        self.binding(&decl.arguments, |walk| walk.exprs([&decl.body]));
    }
}
