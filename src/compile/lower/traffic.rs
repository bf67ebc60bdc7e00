//! Measures of pedestrian dynamics: counts at lines; densities, speeds and times in regions.

use crate::base::tick::Tick;
use crate::compile::context::{Context, Locals, Lowered, number::Number, typed::Typed};
use crate::model::function::Special;
use crate::model::{
    Arithmetic, Bool, BuiltIn, Field, Fold, Function, LineId, Num, RegionId, Scenario, Set, Who,
};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::sync::Arc;

/// A scenario with all that formulas count: those of properties are lowered after it was built.
pub(crate) fn counting(context: &Context<'_>, mut scenario: Arc<Scenario>) -> Arc<Scenario> {
    if scenario.scene != context.scene {
        Arc::make_mut(&mut scenario).scene = context.scene.clone();
    }
    scenario
}

/// A line, whose crossings a trial has to remember from here on.
pub(crate) fn counted_line(context: &mut Context<'_>, typed: Typed, span: Span) -> Lowered<LineId> {
    match typed {
        Typed::Line(line) => {
            context.scene.counted.insert(line);
            Ok(line)
        }
        found => context.mismatch(span, "a line", &found),
    }
}

fn as_region(context: &mut Context<'_>, typed: Typed, span: Span) -> Lowered<RegionId> {
    match typed {
        Typed::Region(region) => Ok(region),
        found => context.mismatch(span, "a region", &found),
    }
}

/// `flow(door, 10 s)`: who crossed in the last 10 s, over 10 s.
pub(crate) fn flow(
    context: &mut Context<'_>,
    built_in: &BuiltIn,
    (typed, at): (Typed, Span),
    (ticks, window): (Option<Tick>, Span),
) -> Lowered<Typed> {
    let name = context.text(at);
    let line = counted_line(context, typed, at)?;
    let fault = match ticks {
        None => Some((Code::E0503, "the time window of a flow must be finite".to_owned())),
        Some(ticks) if ticks.0 == 0 => {
            Some((Code::E0405, "the time window of a flow must be positive".to_owned()))
        }
        Some(ticks) if ticks > context.time.horizon => {
            let [asked, most] = [ticks, context.time.horizon].map(|ticks| context.time.clock.seconds(ticks));
            let said = format!("a time window of {asked} s is longer than the horizon of {most} s");
            Some((Code::E0502, said))
        }
        Some(_) => None,
    };
    if let Some((code, said)) = fault {
        let error = Diagnostic::error(code, window, said);
        return context.report(error.hint(format!("write for example `flow({name}, 10 s)`")));
    }
    let ticks = ticks.unwrap_or_default();
    let crossings = Num::Crossings(line, Some(ticks.0));
    Ok(Typed::Num(over(crossings, Num::Constant(context.time.clock.seconds(ticks))), built_in.gives()))
}

/// `dwell(user, hall)`: how long an agent has been in a region.
pub(crate) fn dwell(
    context: &mut Context<'_>,
    built_in: &BuiltIn,
    sides: [(Typed, Span); 2],
) -> Lowered<Typed> {
    let [(agent, left), (region, right)] = sides;
    let sides = (context.as_agent(agent, left), as_region(context, region, right));
    let (who, region) = (sides.0?, sides.1?);
    context.scene.timed.insert(region);
    Ok(Typed::Num(Num::Of(Field::Dwell(region), who), built_in.gives()))
}

/// A number of those in a region. Over nobody all of them have a value: a density is 0, the level of service 1 (A), and
/// the mean speed 0, as in `PedPy`.
pub(crate) fn of_region(
    context: &mut Context<'_>,
    special: Special,
    (typed, span): (Typed, Span),
    area: Number,
    locals: &Locals,
) -> Lowered<Num> {
    let region = as_region(context, typed, span)?;
    let area = Num::Constant(area.value);
    let everyone = Set { members: context.roster.everyone(), except: None };
    let running = Who::Running(locals.running);
    let inside = Box::new(Bool::In(running, region));
    let people = Num::Count(everyone.clone(), inside.clone());
    Ok(match special {
        Special::VoronoiDensity => Num::Voronoi(region),
        Special::LevelOfService => Num::Apply(Function::ServiceLevel, Box::new(over(area, people))),
        Special::MeanSpeed => {
            let speed = Box::new(Num::Of(Field::Speed, running));
            let speed = Num::If(inside, speed, Box::new(Num::Constant(0.0)));
            let least = Box::new(Num::Constant(1.0));
            let people = Num::Combine(Arithmetic::Max, Box::new(people), least);
            over(Num::Fold(Fold::Sum, everyone, Box::new(speed)), people)
        }
        _ => over(people, area),
    })
}

fn over(a: Num, b: Num) -> Num {
    Num::Combine(Arithmetic::Divide, Box::new(a), Box::new(b))
}
