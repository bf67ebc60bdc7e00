//! The dimension of an expression in which something is wrong, as far as its form tells it: what it is compared with is
//! judged by that. `distance(usr, door) < 2 kg` has two errors.

use crate::compile::context::symbols::Param;
use crate::compile::context::{Context, Locals, symbols::Meaning, typed::Typed};
use crate::compile::dimension::{self, Dimension};
use crate::compile::lower::modes;
use crate::model::function::Rule;
use crate::model::{BuiltIn, Num};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Quantifier, UnaryOp};

/// How deep is looked, and at how many parts: names that name others several times could go on and on.
const DEEPEST: u32 = 32;
const MOST_PARTS: u32 = 300;

/// The dimension of what an expression is meant to be, if no more than its form is needed to tell.
pub(crate) fn gist(context: &Context<'_>, expr: &Expr, locals: &Locals) -> Option<Dimension> {
    Gist { context, depth: 0, left: MOST_PARTS }.of(expr, locals)
}

struct Gist<'e, 'a> {
    context: &'e Context<'a>,
    depth: u32,
    /// How many more parts are looked at.
    left: u32,
}

impl Gist<'_, '_> {
    fn of(&mut self, expr: &Expr, locals: &Locals) -> Option<Dimension> {
        if self.depth > DEEPEST {
            return None;
        }
        self.left = self.left.checked_sub(1)?;
        self.depth += 1;
        let found = self.of_kind(&expr.kind, locals);
        self.depth -= 1;
        found
    }

    fn of_kind(&mut self, kind: &ExprKind, locals: &Locals) -> Option<Dimension> {
        match kind {
            ExprKind::Quantity(quantity) => match &quantity.unit {
                Some(unit) => Some(dimension::resolve(unit).ok()?.dimension),
                None => Some(Dimension::NONE),
            },
            ExprKind::Name(name) => self.of_name(name, locals),
            ExprKind::Call { function, arguments } => self.of_call(&function.name, arguments, locals),
            ExprKind::Unary(UnaryOp::Minus, operand) => self.of(operand, locals),
            ExprKind::Binary(BinaryOp::Plus | BinaryOp::Minus, left, right) => {
                self.joined([&**left, right], locals)
            }
            ExprKind::Binary(BinaryOp::Times, left, right) => {
                self.of(left, locals)?.times(self.of(right, locals)?)
            }
            ExprKind::Binary(BinaryOp::Over, left, right) => {
                self.of(left, locals)?.over(self.of(right, locals)?)
            }
            ExprKind::Quantified { quantifier: Quantifier::Count, .. } => Some(Dimension::NONE),
            ExprKind::Quantified { quantifier: Quantifier::Fold(_), variable, body, .. } => {
                let mut inner = locals.clone();
                inner.bind_unknown(&variable.name);
                self.of(body, &inner)
            }
            ExprKind::Window(_, _, body) | ExprKind::At(body, _) => self.of(body, locals),
            _ => None,
        }
    }

    /// What all of some expressions are meant to be. Where two are known and differ, just that is what is wrong.
    fn joined<'x>(
        &mut self,
        exprs: impl IntoIterator<Item = &'x Expr>,
        locals: &Locals,
    ) -> Option<Dimension> {
        let mut known = exprs.into_iter().filter_map(|expr| self.of(expr, locals));
        let first = known.next()?;
        known.all(|other| other == first).then_some(first)
    }

    fn of_name(&mut self, name: &str, locals: &Locals) -> Option<Dimension> {
        if let Some((_, typed)) = locals.names.iter().rev().find(|(bound, _)| bound == name) {
            return match typed.as_deref()? {
                Typed::Number(number) => Some(number.dimension),
                Typed::Num(_, dimension) | Typed::Term(_, dimension) => Some(*dimension),
                _ => None,
            };
        }
        if modes::is_inside(self.context, name, locals) {
            return None;
        }
        match self.context.look_up(name, locals.scope) {
            Some((scope, Meaning::Constant(value) | Meaning::Param(Param { value, .. }))) => {
                self.of(value, &Locals::of(scope))
            }
            Some((scope, Meaning::Let(decl))) if decl.arguments.is_empty() => {
                self.of(&decl.body, &Locals::of(scope))
            }
            None if name == "time" && !self.context.time.clock.is_jumps() => {
                Some(self.context.time.dimension())
            }
            _ => None,
        }
    }

    fn of_call(&mut self, name: &str, arguments: &[Expr], locals: &Locals) -> Option<Dimension> {
        if modes::is_inside(self.context, name, locals) {
            return None;
        }
        if let Some((scope, Meaning::Let(decl))) = self.context.look_up(name, locals.scope)
            && !decl.arguments.is_empty()
        {
            if decl.arguments.len() != arguments.len() {
                return None;
            }
            let mut inner = Locals::of(scope);
            for (name, argument) in decl.arguments.iter().zip(arguments) {
                match self.of(argument, locals) {
                    Some(dimension) => inner.bind(&name.name, Typed::Num(Num::Constant(0.0), dimension)),
                    None => inner.bind_unknown(&name.name),
                }
            }
            return self.of(&decl.body, &inner);
        }
        let built_in = BuiltIn::find(name).filter(|function| function.takes(arguments.len()))?;
        match built_in.dimension {
            Rule::Always(dimension) => Some(dimension),
            Rule::Clock => Some(self.context.time.dimension()),
            Rule::Same(from) => self.joined(&arguments[from..], locals),
            Rule::Root => self.joined(arguments, locals)?.root(),
            Rule::Open => None,
        }
    }
}
