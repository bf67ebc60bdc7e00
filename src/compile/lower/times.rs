//! Times as ticks of the clock.

use crate::base::decimal::Decimal;
use crate::base::tick::{Clock, Tick};
use crate::compile::context::{Context, Lowered, moments, number::Number, typed::Typed};
use crate::compile::dimension::Dimension;
use crate::syntax::source::Span;

/// A time as ticks; `None` for infinity.
pub(crate) fn as_time(context: &mut Context<'_>, typed: Typed, span: Span) -> Lowered<Option<Tick>> {
    let number = match typed {
        Typed::Infinity => return Ok(None),
        Typed::Number(number) => number,
        found => return context.mismatch(span, "a time known before a trial starts", &found),
    };
    ticks(context, number, span).map(Some)
}

/// A time known now, as ticks.
pub(crate) fn ticks(context: &mut Context<'_>, number: Number, span: Span) -> Lowered<Tick> {
    if number.value < 0.0 {
        return context.report(error!(E0503, span, "a time bound cannot be negative"));
    }
    let steps = number.dimension == Dimension::STEPS
        || (number.dimension.is_none() && context.time.clock == Clock::Steps);
    if steps {
        return match number.as_whole().and_then(|n| u64::try_from(n).ok()) {
            Some(n) if !context.time.clock.is_jumps() => Ok(Tick(n)),
            Some(_) => context.report(
                error!(E0503, span, "bounds in steps are not available in continuous time")
                    .formal()
                    .hint("write a time such as `5 s`"),
            ),
            None => {
                let below = number.value.floor();
                context.report(error!(E0501, span, "the number of steps must be whole";
                    hint: "the nearest bounds are #{below} and #{}", below + 1.0))
            }
        };
    }
    if number.dimension.is_none() {
        // A number as it is written is shown with its unit; steps are whole.
        let text = context.text(span);
        let is_number =
            text.starts_with(|c: char| c.is_ascii_digit() || c == '.') && Decimal::parse(&text).is_some();
        let is_whole = text.bytes().all(|byte| byte.is_ascii_digit());
        let hint = match (is_number, context.time.clock.is_jumps()) {
            (true, true) => format!("write a time: `{text} s`"),
            (false, true) => "write a time such as `10 s`".to_owned(),
            (true, false) if is_whole => {
                let steps = if text == "1" { "step" } else { "steps" };
                format!("write `{text} s`, or `#{text}` (`{text} {steps}`) for a number of steps")
            }
            (true, false) => format!("write `{text} s`"),
            (false, false) => {
                "write a time such as `10 s`, or a number of steps such as `#10` (`10 steps`)".to_owned()
            }
        };
        let error = error!(E0503, span, "the bound needs a unit").formal();
        return context.report(error.hint(hint));
    }
    if number.dimension != Dimension::TIME {
        return context.wrong_dimension(span, Dimension::TIME, number.dimension);
    }
    let step = match context.time.clock {
        Clock::Stepped(step) => step,
        Clock::Jumps(tick) => return moment(context, number, tick, span),
        Clock::Steps => {
            let error = error!(E0503, span, "the steps of this scenario have no length")
                .formal()
                .hint("write the bound in steps: `#10` or `10 steps`");
            return context.report(error);
        }
    };
    let exact = number.exact.or_else(|| nearest_tick(number.value, step));
    let found = match exact {
        Some(time) => Some(context.time.clock.tick_at(time)),
        // `pi * 1 s`
        None => {
            let below = (number.value / step.to_f64()).floor();
            (below < 9e15).then(|| Err((Tick(below as u64), Tick(below as u64 + 1))))
        }
    };
    match found {
        Some(Ok(tick)) => Ok(tick),
        Some(Err((below, above))) if above.0 < u64::MAX => {
            // Of a step such as `1 s / 60` no number of seconds is a multiple.
            let seconds = |tick: Tick| {
                let time = Decimal::whole(tick.0 as i64).mul(step).map_or(f64::NAN, Decimal::to_f64);
                let same = Decimal::parse(&time.to_string()).map(|time| context.time.clock.tick_at(time));
                if same == Some(Ok(tick)) { format!("{time} s") } else { format!("#{}", tick.0) }
            };
            context.report(
                error!(E0501, span, "`{}` is not a multiple of the step of {step} s", context.text(span);
                hint: "the nearest bounds are {} and {}", seconds(below), seconds(above)),
            )
        }
        _ => context.report(error!(E0501, span, "the time is out of range")),
    }
}

/// A time in continuous time, as ticks. One between two ticks is noted: all will be compiled again.
fn moment(context: &mut Context<'_>, number: Number, tick: Decimal, span: Span) -> Lowered<Tick> {
    let Some(time) = number.exact.or_else(|| moments::nearest(number.value, tick)) else {
        return context.report(error!(E0501, span, "the time is out of range"));
    };
    match context.time.clock.tick_at(time) {
        Ok(found) => Ok(found),
        Err((below, above)) if above.0 < u64::MAX => {
            let horizon = Decimal::whole(context.time.horizon.0 as i64).mul(tick);
            if horizon.and_then(|horizon| moments::finer(tick, horizon, time)).is_none() {
                return context.report(error!(E0501, span, "the time is too short for the horizon";
                    hint: "the horizon can be at most about 10^12 times the shortest time"));
            }
            context.time.between.push(time);
            Ok(below)
        }
        Err(_) => context.report(error!(E0501, span, "the time is out of range")),
    }
}
/// The multiple of the step that a rounded time means, if it is one to within rounding.
fn nearest_tick(value: f64, step: Decimal) -> Option<Decimal> {
    let ticks = value / step.to_f64();
    let near = ticks.round();
    ((ticks - near).abs() <= 1e-9 * near.max(1.0) && near < 9e15)
        .then(|| Decimal::whole(near as i64).mul(step))
        .flatten()
}
