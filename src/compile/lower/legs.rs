//! Words for walks: whether a route is done, and the numbers of its legs.

use super::super::dimension::Dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered};
use super::super::typed::Typed;
use crate::base::tick::Tick;
use crate::logic::{Aggregation, Term, Window};
use crate::model::function::LegMeasure;
use crate::model::{Bool, BuiltIn, Comparison, Field, Num, Who};
use crate::syntax::ast::Expr;

/// From the first state to the last one.
const WHOLE: Window = Window { from: Tick(0), to: None };

/// Whether somebody has reached the last goal and waits no more.
pub(super) fn done(who: Who) -> Typed {
    let time = Box::new(Num::Time);
    Typed::truth(Bool::Compare(Comparison::AtMost, Box::new(Num::Of(Field::DoneAt, who)), time))
}

impl Elaborator<'_> {
    /// `leg_length(worker, 2)`: a number of a trial, known when the leg ends.
    pub(super) fn leg(
        &mut self,
        built_in: &BuiltIn,
        measure: LegMeasure,
        (expr, arguments): (&Expr, [&Expr; 2]),
        locals: &Locals,
    ) -> Lowered<Typed> {
        let name = built_in.name;
        if !self.temporal || locals.running > 0 {
            let said = format!("`{name}` is about a trace, but a value of one state is needed here");
            return self.report(error!(E0504, expr.span, "{said}";
                hint: "write it in a metric or a comparison of a property file, outside of folds over agents"));
        }
        let [agent, number] = arguments;
        let sides = (self.lower(agent, locals), self.number_of(number, Dimension::NONE, locals));
        let (who, given) = (self.as_agent(sides.0?, agent.span)?, sides.1?);
        let Who::Agent(id) = who else {
            let error = error!(E0305, agent.span, "expected an agent that is known before a trial");
            return self.report(error.hint("choose a member such as `crowd[1]`"));
        };
        let most = self.legs.get(id.0 as usize).copied().filter(|_| !self.undeclared.contains(&id));
        let most = most.unwrap_or(u32::MAX);
        let leg = given.as_whole().and_then(|n| u32::try_from(n).ok()).filter(|n| (1..=most).contains(n));
        let Some(leg) = leg else {
            let whose = self.agent_names.get(id.0 as usize).cloned().unwrap_or_default();
            let legs = match most {
                0 => format!("`{whose}` has no goals, and so no legs"),
                1 => format!("the route of `{whose}` has one leg"),
                _ => format!("the route of `{whose}` has {most} legs"),
            };
            return self.report(error!(E0405, number.span, "{legs} (got {})", given.value;
                hint: "legs are numbered from 1; pauses are no legs"));
        };
        let num = Num::Of(Field::Leg(measure, leg - 1), who);
        let signal = self.signal(num, built_in.gives(), expr.span);
        Ok(Typed::Term(self.term(Term::Window(Aggregation::First, WHOLE, signal)), built_in.gives()))
    }
}
