//! When commands fire: rates and delays.

use crate::compile::dimension::Dimension;
use crate::compile::elaborator::{Elaborator, Locals, Lowered};
use crate::compile::laws;
use crate::model::{Law, Num, Timing};
use crate::syntax::ast::process as ast;
use crate::syntax::ast::{Expr, Value};

/// 1/s
const PER_SECOND: Dimension = Dimension([0, 0, -1, 0, 0]);

impl Elaborator<'_> {
    pub(super) fn timing(&mut self, command: &ast::Command, locals: &Locals) -> Lowered<Timing> {
        match &command.timing {
            None if self.clock.is_jumps() => {
                self.report(error!(E0905, command.span, "this command has no rate, but other commands of this scenario have one";
                    hint: "add `at` with a rate or `after` with a distribution, or set a `step` in the scenario"))
            }
            None => Ok(Timing::Step),
            Some(ast::Timing::Rate(rate)) => self.rate(rate, locals).map(Timing::Rate),
            Some(ast::Timing::Delay(delay)) => {
                let law = self.delay(delay, locals)?;
                let exact = self.exact_values(delay, &law, locals);
                Ok(Timing::Delay(law, exact))
            }
        }
    }

    fn rate(&mut self, rate: &Expr, locals: &Locals) -> Lowered<Num> {
        let typed = self.lower(rate, locals)?;
        let (num, dimension) = self.as_num(typed, rate.span)?;
        if dimension != PER_SECOND {
            return self.wrong_dimension(rate.span, PER_SECOND, dimension);
        }
        match num {
            Num::Constant(value) if !(value >= 0.0 && value.is_finite()) => {
                self.report(error!(E0904, rate.span, "a rate cannot be {value} /s"))
            }
            num => Ok(num),
        }
    }

    /// The law of a delay: a time that is never negative.
    pub(in crate::compile) fn delay(&mut self, delay: &Value, locals: &Locals) -> Lowered<Law> {
        let law = self.law(delay, Dimension::TIME, locals)?;
        let (least, _) = law.bounds();
        if least < 0.0 {
            let span = laws::value_span(delay);
            if law.constant().is_some() {
                return self.report(error!(E0906, span, "a delay cannot be negative"));
            }
            let error = error!(E0906, span, "the delay can be negative");
            let error = laws::truncate(error, &law, &self.text(span));
            return self.report(error);
        }
        Ok(law)
    }
}
