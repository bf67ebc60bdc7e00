//! The parts of values that are refused: what is wrong with them is said as well.

use crate::compile::context::{Context, Locals, symbols::Meaning};
use crate::compile::lower::{laws::distribution, shapes};
use crate::compile::people::{planners, routes};
use crate::syntax::ast::{Expr, ExprKind, Value};

/// The parts of an invalid value, to report their errors as well.
pub(crate) fn look_at(context: &mut Context<'_>, value: &Value, locals: &Locals) {
    match value {
        Value::Plain(expr) => look_at_drawn(context, expr, locals),
        Value::Truncated { law, low, high } => {
            look_at_drawn(context, law, locals);
            let _ = (context.lower(low, locals), context.lower(high, locals));
        }
        Value::UniformIn(shape) => {
            let _ = shapes::lower_shape(context, shape, locals);
        }
        Value::Near { agent, within } => {
            let _ = (context.lower(agent, locals), context.lower(within, locals));
        }
        Value::Route(_) => {
            let _ = routes::route(context, value, locals);
        }
        Value::Sided { along, across } => {
            look_at(context, along, locals);
            look_at(context, across, locals);
        }
        Value::Arguments { .. } => {
            let _ = planners::roadmap(context, value, locals);
        }
        Value::Learned { .. } => {}
        Value::Force { kind, preset } => {
            let _ = planners::force(context, kind, preset);
        }
    }
}

/// A value, or the arguments of a distribution.
fn look_at_drawn(context: &mut Context<'_>, expr: &Expr, locals: &Locals) {
    match distribution(expr) {
        Some(drawn) => {
            let _ = context.lower_all(drawn.arguments, locals);
            for factor in drawn.factors {
                let _ = context.lower(factor, locals);
            }
        }
        None => {
            // `behaviour = phone`: what has no value may be just what was meant.
            let named = |name: &String| context.look_up(name, locals.scope).map(|(_, meaning)| meaning);
            let noun = if let ExprKind::Name(name) = &expr.kind { named(name) } else { None };
            if !matches!(noun, Some(Meaning::Kind(_) | Meaning::Tracks(_) | Meaning::Behaviour(_))) {
                let _ = context.lower(expr, locals);
            }
        }
    }
}
