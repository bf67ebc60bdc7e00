//! The intentions of people who were recorded, from their fields and where they were seen.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    number::Number,
    sighting::{STANDS, Sighting, Site},
    symbols::{Meaning, unknown},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::laws::{self, distribution};
use crate::compile::people::intended::{
    Goals, Intended, RECORDED, WANTED, destinations, is_of_site, is_recorded, is_speed, wanted, weights,
};
use crate::model::{Body, Goal, Law, Leg, Parameter, Route, Start};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Field, Value};
use crate::syntax::codes::Code;

/// How strongly the heading tells the destination, unless stated.
const KAPPA: f64 = 5.0;
/// Largest `kappa`: then directions one degree apart differ by a factor of 4.
const MOST_KAPPA: f64 = 1e4;

/// What fields say of the intentions of people who were recorded.
pub(crate) fn intended<'f>(context: &mut Context<'_>, fields: &[&'f Field]) -> Lowered<Intended<'f>> {
    let mut all = Intended::default();
    let mut failed = None;
    for (k, field) in fields.iter().enumerate() {
        let name = field.name.name.as_str();
        if let Some(first) = fields[..k].iter().find(|before| before.name.name == name) {
            let error = error!(E0202, field.name.span, "`{name}` is set twice");
            return context.report(error.related(first.name.span, "first set here"));
        }
        match name {
            "heading" => match turn(context, &field.value) {
                Ok(law) => all.turn = Some(law),
                Err(reported) => failed = Some(reported),
            },
            "speed" => all.speed = Some(&field.value),
            _ => match goals_of(context, field) {
                Ok(goals) => all.goals = Some(goals),
                Err(reported) => failed = Some(reported),
            },
        }
    }
    if let Some(reported) = failed {
        return Err(reported);
    }
    if let (Some(_), Some(goals)) = (&all.turn, &all.goals) {
        return context
            .report(error!(E0405, goals.span, "a destination and a law of `heading` exclude each other";
                hint: "remove one of them: who goes to a destination heads for it"));
    }
    Ok(all)
}

/// The parts of a law of speed that nobody gets, since something else is wrong, to report their errors as well.
pub(crate) fn look_at(context: &mut Context<'_>, fields: &[&Field]) {
    for field in fields.iter().filter(|field| field.name.name == "speed") {
        let _ = recorded_speed(context, &field.value, (1.0, 1.0));
    }
}

/// The law of the angle between the heading and the recorded one.
fn turn(context: &mut Context<'_>, value: &Value) -> Lowered<Law> {
    let hint = "write for example `heading = recorded + normal(0 deg, 12 deg)`";
    let law = match value {
        Value::Plain(expr) if is_recorded(expr) => return Ok(Law::Constant(0.0)),
        Value::Plain(expr) if is_of_site(expr) => return Ok(site(context, expr)?.turn),
        Value::Plain(Expr { kind: ExprKind::Binary(BinaryOp::Plus, left, right), .. }) => {
            match (is_recorded(left), is_recorded(right)) {
                (true, false) => Some(right),
                (false, true) => Some(left),
                _ => None,
            }
        }
        _ => None,
    };
    match law {
        Some(law) => laws::law(context, &Value::Plain((**law).clone()), Dimension::ANGLE, &Locals::default()),
        None => {
            let said =
                "`heading` must be `recorded`, or `recorded` plus an angle or a distribution of angles";
            context.report(error!(E0305, value.span(), "{said}"; hint: "{hint}"))
        }
    }
}

/// The laws of the site.
fn site(context: &mut Context<'_>, expr: &Expr) -> Lowered<Site> {
    match context.tracks.site.clone() {
        Some(site) => Ok(site),
        None => context.report(error!(E0728, expr.span, "no calibration tells the laws of the site";
                hint: "make one with `smc calibrate`, and add `--calibration site.calibration`")),
    }
}

fn goals_of(context: &mut Context<'_>, field: &Field) -> Lowered<Goals> {
    let Some((function, arguments)) = destinations(field) else {
        return Err(Reported);
    };
    let span = field.value.span();
    let usage = "the tracks, and perhaps kappa: `destinations(hotel)`, `destinations(hotel, 5)`";
    let (tracks, kappa) = match arguments {
        [tracks] => (tracks, None),
        [tracks, kappa] => (tracks, Some(kappa)),
        _ => {
            return context.report(error!(E0204, function.span, "`destinations` needs {usage}"));
        }
    };
    let index = match &tracks.kind {
        ExprKind::Name(name) => match context.look_up(name, 0) {
            Some((_, Meaning::Tracks(index))) => index,
            Some((_, Meaning::Doubtful)) => return Err(Reported),
            _ => {
                return context.report(unknown("recording", name, tracks.span, Code::E0201, [].into_iter()));
            }
        },
        _ => {
            return context.report(error!(E0206, tracks.span, "expected the name of tracks"));
        }
    };
    let kappa = match kappa {
        None => KAPPA,
        Some(expr) => {
            let number = context.number_of(expr, Dimension::NONE, &Locals::default())?;
            if !(0.0..=MOST_KAPPA).contains(&number.value) {
                let said = format!("`kappa` must be from 0 to {MOST_KAPPA} (got {})", number.value);
                return context.report(error!(E0405, expr.span, "{said}"));
            }
            number.value
        }
    };
    match context.tracks.destinations.get(index) {
        Some(Ok(places)) if !places.is_empty() => Ok(Goals { places: places.clone(), kappa, span }),
        Some(Ok(_)) => context.report(error!(E0702, span, "the file has no destinations";
                    hint: "write x and y of one destination a line, in m")),
        Some(Err(reason)) => {
            let error = error!(E0701, span, "{}", reason.clone());
            context
                .report(error.hint("put a file `destinations.txt` with x and y a line beside the recording"))
        }
        None => Err(Reported),
    }
}

/// Gives somebody of a kind who was seen the intention that the fields say. A person who stands has none.
pub(crate) fn intend(
    context: &mut Context<'_>,
    intended: &Intended<'_>,
    (seen, kind): (&Sighting, &Body),
    (body, start, route): (&mut Body, &mut Start, &mut Route),
) -> Lowered<()> {
    let speed = seen.driving.norm();
    if speed < STANDS {
        return Ok(());
    }
    if let Some(turn) = &intended.turn {
        start.turn = turn.clone();
    }
    if let Some(value) = intended.speed {
        let alone = wanted(speed, seen.density, kind[Parameter::Speed].draw(0.5));
        body[Parameter::Speed] = recorded_speed(context, value, (speed, alone))?;
        start.own_speed = true;
    }
    if let Some(goals) = &intended.goals {
        let Some(weights) = weights(&goals.places, seen.position, seen.driving, goals.kappa) else {
            let said = format!("all destinations of person {} have weight 0", seen.id);
            return context.report(error!(E0405, goals.span, "{said}";
                    hint: "this person is at all of them: add others to the file"));
        };
        let legs = goals.places.iter().map(|place| Leg::To(Goal::Point(*place))).collect();
        *route = Route::OneOf { legs, weights };
    }
    Ok(())
}

/// The law of a speed, m/s, around that which was recorded, or that which it tells to be wanted.
fn recorded_speed(context: &mut Context<'_>, value: &Value, (speed, alone): (f64, f64)) -> Lowered<Law> {
    let (Value::Plain(expr) | Value::Truncated { law: expr, .. }) = value else {
        return laws::parameter_law(context, Parameter::Speed, value, &Locals::default());
    };
    if is_of_site(expr) && matches!(value, Value::Plain(_)) {
        let pace = site(context, expr)?.pace;
        return Ok(pace.scaled(speed).unwrap_or(Law::Constant(speed)));
    }
    let is_law = is_speed(expr)
        || matches!(&expr.kind, ExprKind::Binary(BinaryOp::Times, left, right)
                if is_speed(left) != is_speed(right));
    if !is_law && distribution(expr).is_none() {
        let said = "`speed` must be `recorded` or `wanted`, or one of them times a number or a distribution of numbers";
        let hint = "write for example `speed = recorded * normal(1, 0.15) in 0 m/s .. 3 m/s`";
        return context.report(error!(E0305, value.span(), "{said}"; hint: "{hint}"));
    }
    let mut locals = Locals::default();
    for (name, speed) in [(RECORDED, speed), (WANTED, alone)] {
        locals.bind(name, Typed::Number(Number::rounded(speed, Dimension::SPEED)));
    }
    laws::parameter_law(context, Parameter::Speed, value, &locals)
}
