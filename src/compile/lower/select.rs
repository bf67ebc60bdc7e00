//! One of several values: the smallest, the largest, and `if`.

use super::super::dimension::Dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::typed::Typed;
use crate::logic::{Operation, Term};
use crate::model::{Arithmetic, Bool, Num};
use crate::syntax::ast::{Expr, Ident};

impl Elaborator<'_> {
    pub(super) fn extremum(
        &mut self,
        expr: &Expr,
        (function, operator): (&Ident, Arithmetic),
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        if arguments.len() < 2 {
            return self.report(error!(E0204, expr.span, "`{}` needs at least two values", function.name;
                hint: "for a set write `{0}(… for a in crowd)`, for a time window `{0}<=10 s (…)`", function.name));
        }
        let smallest = operator == Arithmetic::Min;
        let places = arguments.iter().map(|argument| argument.span);
        let values: Vec<_> = self.lower_all(arguments, locals)?.into_iter().zip(places).collect();
        let over_time = values.iter().any(|(typed, _)| matches!(typed, Typed::Term(..)));
        let mut joined: Option<(Typed, Dimension)> = None;
        for (typed, span) in values {
            let next = if over_time {
                let (term, dimension) = self.as_term(typed, span)?;
                (Typed::Term(term, dimension), dimension)
            } else if let Typed::Number(number) = typed {
                (Typed::Number(number), number.dimension)
            } else {
                let (num, dimension) = self.as_num(typed, span)?;
                (Typed::Num(num, dimension), dimension)
            };
            let Some((so_far, dimension)) = joined else {
                joined = Some(next);
                continue;
            };
            if dimension != next.1 {
                return self.wrong_dimension(span, dimension, next.1);
            }
            let both = match (so_far, next.0) {
                (Typed::Term(a, _), Typed::Term(b, _)) => {
                    let operation = if smallest { Operation::Min } else { Operation::Max };
                    Typed::Term(self.term(Term::Combine(operation, a, b)), dimension)
                }
                (Typed::Number(a), Typed::Number(b)) => {
                    Typed::Number(if (a.value <= b.value) == smallest { a } else { b })
                }
                (a, b) => {
                    let (a, b) = (self.as_num(a, span)?.0, self.as_num(b, span)?.0);
                    Typed::Num(Num::Combine(operator, Box::new(a), Box::new(b)), dimension)
                }
            };
            joined = Some((both, dimension));
        }
        joined.map(|(typed, _)| typed).ok_or(Reported)
    }

    pub(super) fn choice(
        &mut self,
        expr: &Expr,
        function: &Ident,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        let [condition, yes, no] = arguments else {
            return self.arity(function, expr.span, "3 arguments", (arguments, locals));
        };
        let truth = self.lower(condition, locals);
        let truth = truth.and_then(|typed| self.as_truth(typed, condition.span));
        let sides = (self.lower(yes, locals), self.lower(no, locals));
        let (truth, sides) = (truth?, (sides.0?, sides.1?));
        if let (Bool::Constant(holds), Typed::Number(a), Typed::Number(b)) = (&truth, &sides.0, &sides.1)
            && a.dimension == b.dimension
        {
            return Ok(Typed::Number(if *holds { *a } else { *b }));
        }
        let sides = (self.as_num(sides.0, yes.span), self.as_num(sides.1, no.span));
        let ((a, da), (b, db)) = (sides.0?, sides.1?);
        if da != db {
            return self.wrong_dimension(no.span, da, db);
        }
        Ok(Typed::Num(Num::If(Box::new(truth), Box::new(a), Box::new(b)), da))
    }
}
