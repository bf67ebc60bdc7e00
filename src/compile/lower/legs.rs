//! Words for walks: whether a route is done, and the numbers of its legs.

use crate::base::tick::Tick;
use crate::compile::context::{Context, Locals, Lowered, number::Number, typed::Typed};
use crate::logic::{Aggregation, Term, Window};
use crate::model::function::LegMeasure;
use crate::model::{Bool, BuiltIn, Comparison, Field, Num, Who};
use crate::syntax::source::Span;

/// From the first state to the last one.
const WHOLE: Window = Window { from: Tick(0), to: None };

/// Whether somebody has reached the last goal and waits no more.
pub(crate) fn done(who: Who) -> Typed {
    let time = Box::new(Num::Time);
    Typed::truth(Bool::Compare(Comparison::AtMost, Box::new(Num::Of(Field::DoneAt, who)), time))
}

/// An error where numbers of legs are not allowed.
pub(crate) fn check_allowed(
    context: &mut Context<'_>,
    built_in: &BuiltIn,
    span: Span,
    locals: &Locals,
) -> Lowered<()> {
    let name = built_in.name;
    if !context.temporal || locals.running > 0 {
        let said = format!("`{name}` is about a trace, but a value of one state is needed here");
        return context.report(error!(E0504, span, "{said}";
                hint: "write it in a metric or a comparison of a property file, outside of folds over agents"));
    }
    Ok(())
}

/// `leg_length(worker, 2)`: a number of a trial, known when the leg ends.
pub(crate) fn leg(
    context: &mut Context<'_>,
    (built_in, measure, span): (&BuiltIn, LegMeasure, Span),
    (who, agent): (Who, Span),
    (given, number): (Number, Span),
) -> Lowered<Typed> {
    let Who::Agent(id) = who else {
        let error = error!(E0305, agent, "expected an agent that is known before a trial");
        return context.report(error.hint("choose a member such as `crowd[1]`"));
    };
    let most =
        context.roster.legs.get(id.0 as usize).copied().filter(|_| !context.roster.undeclared.contains(&id));
    let most = most.unwrap_or(u32::MAX);
    let leg = given.as_whole().and_then(|n| u32::try_from(n).ok()).filter(|n| (1..=most).contains(n));
    let Some(leg) = leg else {
        let whose = context.roster.agent_names.get(id.0 as usize).cloned().unwrap_or_default();
        let legs = match most {
            0 => format!("`{whose}` has no goals, and so no legs"),
            1 => format!("the route of `{whose}` has one leg"),
            _ => format!("the route of `{whose}` has {most} legs"),
        };
        return context.report(error!(E0405, number, "{legs} (got {})", given.value;
                hint: "legs are numbered from 1; pauses are no legs"));
    };
    let num = Num::Of(Field::Leg(measure, leg - 1), who);
    let signal = context.signal(num, built_in.gives(), span);
    Ok(Typed::Term(context.term(Term::Window(Aggregation::First, WHOLE, signal)), built_in.gives()))
}
