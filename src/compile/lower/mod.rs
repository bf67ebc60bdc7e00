//! Lowering of expressions: names, units and types are settled, sugar is gone.

pub(crate) mod arithmetic;
pub(crate) mod builtin;
pub(crate) mod call;
pub(crate) mod call_arguments;
pub(crate) mod choices;
pub(crate) mod convert;
pub(crate) mod defaults;
pub(crate) mod depth;
pub(crate) mod expanding;
pub(crate) mod form;
pub(crate) mod function;
pub(crate) mod laws;
pub(crate) mod legs;
pub(crate) mod logic;
pub mod margin;
pub(crate) mod margins;
pub(crate) mod mention;
pub(crate) mod misspelt;
pub(crate) mod modes;
pub(crate) mod name;
pub(crate) mod observing;
pub(crate) mod plans;
pub(crate) mod process_names;
pub(crate) mod quantifier;
pub(crate) mod robustness;
pub(crate) mod select;
pub(crate) mod shapes;
pub(crate) mod storeys;
pub(crate) mod tally;
pub(crate) mod temporal;
pub(crate) mod times;
pub(crate) mod traffic;
pub(crate) mod weight;

use crate::base::tick::Tick;
use crate::compile::context::{
    Context, Locals, Lowered, Reported, notes,
    number::Number,
    parts::{Form, Part},
    phrase,
    typed::Typed,
};
use crate::compile::dimension::{self, Dimension};
use crate::logic::Window;
use crate::syntax::ast::BinaryOp;
use crate::syntax::ast::Bound;

use crate::logic::NodeId;
use crate::model::Bool;
use crate::syntax::ast::{Expr, ExprKind, Ident, UnaryOp};
use crate::syntax::source::Span;
use std::sync::Arc;

impl Context<'_> {
    /// What an expression means.
    pub(crate) fn lower(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Typed> {
        self.descend(expr.span)?;
        let around = std::mem::replace(&mut self.words.frame, locals.frame.clone());
        let lowered = match self.lower_kind(expr, locals) {
            Ok(Typed::Truth(truth, phrase)) if self.temporal => {
                Ok(self.phrased(expr, (truth, phrase), locals))
            }
            other => other,
        };
        self.words.frame = around;
        self.extent.depth -= 1;
        if let (Some(notes), Ok(typed)) = (&mut self.notes, &lowered) {
            let is_named =
                matches!(expr.kind, ExprKind::Name(_) | ExprKind::Member(..) | ExprKind::Call { .. });
            // A declaration is lowered by its name at the place of its value.
            if is_named {
                notes.insert(expr.span, notes::described(typed));
            }
        }
        lowered
    }

    /// A condition that knows how it is written here.
    fn phrased(&mut self, expr: &Expr, (truth, phrase): (Bool, Option<Arc<Part>>), locals: &Locals) -> Typed {
        let phrase = match (matches!(truth, Bool::Constant(_)), phrase, &expr.kind) {
            (true, ..) => None,
            (false, None, _) => phrase::phrase(self, expr.span, Form::Plain(truth.clone())),
            // An argument is what it stands for.
            (false, Some(inner), ExprKind::Name(name))
                if locals.names.iter().any(|(bound, _)| bound == name) =>
            {
                Some(inner)
            }
            (false, Some(inner), ExprKind::Name(_) | ExprKind::Call { .. } | ExprKind::Member(..)) => {
                phrase::phrase(self, expr.span, Form::Named(inner))
            }
            (false, phrase, _) => phrase,
        };
        Typed::Truth(truth, phrase)
    }

    /// A number known at compile time, of a given dimension.
    pub(crate) fn number_of(
        &mut self,
        expr: &Expr,
        dimension: Dimension,
        locals: &Locals,
    ) -> Lowered<Number> {
        let typed = self.lower(expr, locals)?;
        self.as_known_of(typed, expr.span, dimension)
    }

    /// A number known at compile time.
    pub(crate) fn number(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Number> {
        let typed = self.lower(expr, locals)?;
        self.as_known(typed, expr.span)
    }

    /// What some expressions mean. What is wrong with each is said.
    pub(crate) fn lower_all<'e>(
        &mut self,
        exprs: impl IntoIterator<Item = &'e Expr>,
        locals: &Locals,
    ) -> Lowered<Vec<Typed>> {
        let lowered: Vec<_> = exprs.into_iter().map(|expr| self.lower(expr, locals)).collect();
        lowered.into_iter().collect()
    }

    fn lower_kind(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Typed> {
        if let Some(name) = storeys::member(self, expr, locals) {
            return name::lower_name(self, &name, expr.span, locals);
        }
        match &expr.kind {
            ExprKind::Quantity(quantity) => {
                let unit = match &quantity.unit {
                    Some(unit) => match dimension::resolve(unit) {
                        Ok(unit) => unit,
                        Err(error) => return self.report(error),
                    },
                    None => return Ok(Typed::Number(Number::exact(quantity.value, Dimension::NONE))),
                };
                Ok(Typed::Number(Number::literal(quantity.value, &unit)))
            }
            ExprKind::Infinity => Ok(Typed::Infinity),
            ExprKind::Broken => Err(Reported),
            ExprKind::Bool(value) => Ok(Typed::truth(Bool::Constant(*value))),
            ExprKind::Text(text) => Ok(Typed::Text(text.clone())),
            ExprKind::Name(name) => name::lower_name(self, name, expr.span, locals),
            ExprKind::Member(base, field)
                if matches!(field.name.as_str(), "x" | "y") && !matches!(base.kind, ExprKind::Name(_)) =>
            {
                let typed = self.lower(base, locals)?;
                // A variable of a process may be called so, and so may a behaviour.
                let is_behaviour =
                    || self.conducts.behaviours.iter().any(|decl| decl.name.name == field.name);
                if matches!(typed, Typed::Process { .. } | Typed::Processes(_))
                    || matches!(typed, Typed::Agent(_)) && is_behaviour()
                {
                    return name::lower_member(self, base, field, locals);
                }
                if let Typed::Point(x, y) = typed {
                    let (x, y) = storeys::own_coordinates(&self.scene.storeys, (x, y));
                    return Ok(Typed::Number(if field.name == "x" { x } else { y }));
                }
                let (x, y, dimension) = self.as_vector(typed, base.span)?;
                Ok(Typed::Num(if field.name == "x" { x } else { y }, dimension))
            }
            ExprKind::Member(base, member) => match plans::named(self, base, locals) {
                Some(plan) => plans::part(self, plan, &member.name, member.span),
                None => name::lower_member(self, base, member, locals),
            },
            ExprKind::Index(base, index) => match (plans::named(self, base, locals), &index.kind) {
                (Some(plan), ExprKind::Text(name)) => plans::part(self, plan, name, index.span),
                _ => name::lower_index(self, base, index, locals),
            },
            ExprKind::Call { function, arguments } => {
                call::lower_call(self, expr, function, arguments, locals)
            }
            ExprKind::Point { x, y, unit } => self.lower_point(x, y, unit.as_ref(), locals),
            ExprKind::Unary(UnaryOp::Minus, operand) => {
                let typed = self.lower(operand, locals)?;
                arithmetic::minus(self, typed, operand.span)
            }
            ExprKind::Unary(UnaryOp::Not, operand) => {
                let typed = self.lower(operand, locals)?;
                logic::not(self, expr.span, typed, operand.span)
            }
            ExprKind::Binary(op, left, right) => self.lower_binary(expr, *op, left, right, locals),
            ExprKind::Quantified { quantifier, variable, set, body } => {
                quantifier::lower_quantified(self, expr.span, *quantifier, variable, set, body, locals)
            }
            ExprKind::Temporal(op, bound, body) => {
                temporal::check_allowed(self, expr.span, locals)?;
                let window = self.window(bound.as_ref(), body, locals);
                let operand = self.operand(body, locals);
                temporal::operator(self, (expr.span, *op), (bound.as_ref(), window?), operand?)
            }
            ExprKind::TemporalPair(op, bound, left, right) => {
                temporal::check_allowed(self, expr.span, locals)?;
                let window = self.window(bound.as_ref(), right, locals);
                let sides = (self.operand(left, locals), self.operand(right, locals));
                Ok(temporal::pair(self, *op, window?, (sides.0?, sides.1?)))
            }
            ExprKind::Window(aggregate, bound, body) => {
                temporal::check_allowed(self, expr.span, locals)?;
                temporal::check_aggregate(self, expr.span, *aggregate)?;
                let window = self.window(Some(bound), body, locals);
                let typed = self.lower(body, locals)?;
                temporal::aggregated(self, *aggregate, window, (typed, body.span))
            }
            ExprKind::At(inner, moment) => {
                let is_number = matches!(
                    &inner.kind,
                    ExprKind::Call { .. } | ExprKind::Member(..) | ExprKind::Name(_) | ExprKind::Quantity(_)
                );
                let read = Some(self.text(inner.span)).filter(|_| !is_number);
                misspelt::misplaced_moment(self, (expr.span, inner.span), read.as_deref(), moment)
            }
        }
    }

    fn lower_point(
        &mut self,
        x: &Expr,
        y: &Expr,
        unit: Option<&crate::syntax::ast::UnitExpr>,
        locals: &Locals,
    ) -> Lowered<Typed> {
        let coordinates = (self.lower(x, locals), self.lower(y, locals));
        let (first, second) = (coordinates.0?, coordinates.1?);
        let scale = match unit.map(dimension::resolve) {
            Some(Ok(unit)) => Some(unit),
            Some(Err(error)) => return self.report(error),
            None => None,
        };
        let metre = dimension::unit("m");
        let fixed = |this: &mut Self, typed: &Typed, span: Span| -> Lowered<Option<Number>> {
            let Typed::Number(number) = typed else { return Ok(None) };
            match (scale, number.dimension.is_none()) {
                // `(1, 2) m/s`: the unit belongs to both coordinates.
                (Some(unit), true) => {
                    Ok(number.times(Number::literal(crate::base::decimal::Decimal::ONE, &unit)))
                }
                (Some(_), false) => this
                    .report(error!(E0303, span, "both the coordinate and the point have a unit";
                        hint: "write the unit once, after the parenthesis or in each coordinate")),
                // A point without a unit is in metres.
                (None, true) => Ok(metre
                    .map(|m| Number::literal(crate::base::decimal::Decimal::ONE, &m))
                    .and_then(|m| number.times(m))),
                (None, false) => Ok(Some(*number)),
            }
        };
        let a = fixed(self, &first, x.span)?;
        let b = fixed(self, &second, y.span)?;
        if let (Some(a), Some(b)) = (a, b) {
            if a.dimension != b.dimension {
                return self.unlike_coordinates((x.span, a.dimension), (y.span, b.dimension));
            }
            return Ok(Typed::Point(a, b));
        }
        let (a, da) = self.as_num(first, x.span)?;
        let (b, db) = self.as_num(second, y.span)?;
        if da != db {
            return self.unlike_coordinates((x.span, da), (y.span, db));
        }
        Ok(Typed::Vector(a, b, da))
    }

    /// Of two coordinates of which one is a length or a speed, as those of points and velocities are, the other is wrong.
    fn unlike_coordinates<T>(&mut self, x: (Span, Dimension), y: (Span, Dimension)) -> Lowered<T> {
        let is_usual = |dimension| dimension == Dimension::LENGTH || dimension == Dimension::SPEED;
        let (right, wrong) = if is_usual(y.1) && !is_usual(x.1) { (y, x) } else { (x, y) };
        self.wrong_dimension(wrong.0, right.1, wrong.1)
    }

    /// A time as ticks; `None` for infinity.
    pub(crate) fn time(&mut self, expr: &Expr, locals: &Locals) -> Lowered<Option<Tick>> {
        let typed = self.lower(expr, locals)?;
        times::as_time(self, typed, expr.span)
    }

    /// The window of a bound, behind which `body` stands.
    fn window(&mut self, bound: Option<&Bound>, body: &Expr, locals: &Locals) -> Lowered<Window> {
        match bound {
            None => Ok(temporal::ALWAYS),
            Some(Bound::AtMost(end)) if misspelt::misread_bound(self, end, body, locals) => Err(Reported),
            Some(Bound::AtMost(end)) => Ok(Window { from: Tick(0), to: self.time(end, locals)? }),
            Some(Bound::Interval(start, end)) => {
                let ends = (self.time(start, locals), self.time(end, locals));
                temporal::interval(self, ends, (start.span, end.span))
            }
        }
    }

    fn operand(&mut self, body: &Expr, locals: &Locals) -> Lowered<NodeId> {
        let typed = self.lower(body, locals)?;
        self.as_formula(typed, body.span)
    }

    fn lower_binary(
        &mut self,
        expr: &Expr,
        op: BinaryOp,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        match op {
            BinaryOp::Power => {
                let sides = (self.lower(right, locals), self.lower(left, locals));
                let (exponent, base) = (sides.0?, sides.1?);
                arithmetic::raised(self, expr.span, (base, left), (exponent, right))
            }
            BinaryOp::Plus | BinaryOp::Minus | BinaryOp::Times | BinaryOp::Over => {
                let is_over_product =
                    op == BinaryOp::Over && matches!(right.kind, ExprKind::Binary(BinaryOp::Times, ..));
                if is_over_product && misspelt::misread_factors(self, left, right, locals) {
                    return Err(Reported);
                }
                let sides = (self.lower(left, locals), self.lower(right, locals));
                arithmetic::combined(self, (expr.span, op), (left, sides.0), (right, sides.1), locals)
            }
            BinaryOp::In => {
                if let Some(level) = storeys::level_of(self, right, locals) {
                    let typed = self.lower(left, locals)?;
                    let who = self.as_agent(typed, left.span)?;
                    return Ok(Typed::truth(storeys::is_on(who, level)));
                }
                margins::note_margin(self, Dimension::LENGTH, left.span.to(right.span));
                let sides = (self.lower(left, locals), self.lower(right, locals));
                logic::membership(self, (sides.0?, left.span), (sides.1?, right.span))
            }
            BinaryOp::And | BinaryOp::Or | BinaryOp::Implies | BinaryOp::Iff => {
                let sides = (self.lower(left, locals), self.lower(right, locals));
                logic::connect(self, (op, expr.span), (sides.0?, left.span), (sides.1?, right.span), locals)
            }
            _ => self.lower_comparison(op, left, right, locals),
        }
    }

    fn lower_comparison(
        &mut self,
        op: BinaryOp,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        if let Some(behaviour) = modes::compared(self, op, left) {
            let mode = self.lower(left, locals);
            if let Some(compared) = modes::is_in_state(self, op, behaviour, &mode, right) {
                return compared;
            }
        }
        if let Some(misread) = misspelt::misread_comparison(self, left, right, locals) {
            return misread;
        }
        let sides = inside_a_number(self, |this| {
            let a = this.lower(left, locals);
            // `a.phone == looking` without such a behaviour: the state is unknown with it.
            let state = matches!(op, BinaryOp::Equal | BinaryOp::Unequal)
                && matches!((&left.kind, &right.kind), (ExprKind::Member(..), ExprKind::Name(_)));
            if a.is_err() && state { (a, Err(Reported)) } else { (a, this.lower(right, locals)) }
        });
        logic::compared(self, op, (left, sides.0), (right, sides.1), locals)
    }

    /// Reports a wrong number of arguments. They are looked at all the same.
    pub(crate) fn arity<T>(
        &mut self,
        function: &Ident,
        span: Span,
        wanted: &str,
        (arguments, locals): (&[Expr], &Locals),
    ) -> Lowered<T> {
        let found = arguments.len();
        self.note(error!(
            E0204,
            span,
            "`{}` needs {wanted}, but {found} {} given",
            function.name,
            if found == 1 { "is" } else { "are" };
            hint: "`smc explain {}` shows how it is called", function.name
        ));
        let _ = self.lower_all(arguments, locals);
        Err(Reported)
    }
}

/// Lowers numbers: conditions inside them (of a count, of an `if`) are no conditions of the formula.
fn inside_a_number<'a, T>(context: &mut Context<'a>, lower: impl FnOnce(&mut Context<'a>) -> T) -> T {
    if let Some(margins) = &mut context.margins {
        margins.inside += 1;
    }
    let lowered = lower(context);
    if let Some(margins) = &mut context.margins {
        margins.inside -= 1;
    }
    lowered
}

/// Some number of arguments, as one says it.
pub(crate) fn counted_arguments(count: usize) -> String {
    format!("{count} argument{}", if count == 1 { "" } else { "s" })
}
