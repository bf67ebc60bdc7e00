//! When commands fire: rates and delays.

use crate::compile::context::{Context, Locals, Lowered};
use crate::compile::dimension::Dimension;
use crate::compile::lower::laws;
use crate::model::{Law, Num, Timing};
use crate::syntax::ast::process as ast;
use crate::syntax::ast::{Expr, Value};

/// 1/s
const PER_SECOND: Dimension = Dimension([0, 0, -1, 0, 0]);

pub(crate) fn timing(context: &mut Context<'_>, command: &ast::Command, locals: &Locals) -> Lowered<Timing> {
    match &command.timing {
            None if context.time.clock.is_jumps() => {
                context.report(error!(E0905, command.span, "this command has no rate, but other commands of this scenario have one";
                    hint: "add `at` with a rate or `after` with a distribution, or set a `step` in the scenario"))
            }
            None => Ok(Timing::Step),
            Some(ast::Timing::Rate(rate)) => lower_rate(context, rate, locals).map(Timing::Rate),
            Some(ast::Timing::Delay(delay)) => {
                let law = lower_delay(context, delay, locals)?;
                let exact = laws::exact_values(context, delay, &law, locals);
                Ok(Timing::Delay(law, exact))
            }
        }
}

fn lower_rate(context: &mut Context<'_>, rate: &Expr, locals: &Locals) -> Lowered<Num> {
    let typed = context.lower(rate, locals)?;
    let (num, dimension) = context.as_num(typed, rate.span)?;
    if dimension != PER_SECOND {
        return context.wrong_dimension(rate.span, PER_SECOND, dimension);
    }
    match num {
        Num::Constant(value) if !(value >= 0.0 && value.is_finite()) => {
            context.report(error!(E0904, rate.span, "a rate cannot be {value} /s"))
        }
        num => Ok(num),
    }
}

/// The law of a delay: a time that is never negative.
pub(crate) fn lower_delay(context: &mut Context<'_>, delay: &Value, locals: &Locals) -> Lowered<Law> {
    let law = laws::law(context, delay, Dimension::TIME, locals)?;
    let (least, _) = law.bounds();
    if least < 0.0 {
        let span = delay.span();
        if law.constant().is_some() {
            return context.report(error!(E0906, span, "a delay cannot be negative"));
        }
        let error = error!(E0906, span, "the delay can be negative");
        let error = laws::advise_bounds(error, &law, &context.text(span));
        return context.report(error);
    }
    Ok(law)
}
