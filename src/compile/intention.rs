//! What people who were recorded want: laws of heading and speed around the recorded ones, and destinations.
//!
//! A recording tells where people are and how fast, but not where they want to go. Of some destinations each is the goal with a
//! weight of exp(kappa cos angle), where the angle is that between the way to it and the recorded heading: the density of the von
//! Mises law.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::laws::{distribution, value_span};
use super::number::Number;
use super::people::STANDS;
use super::sighting::Sighting;
use super::symbols::{Meaning, unknown};
use super::typed::Typed;
use crate::base::geometry::Vec2;
use crate::base::math;
use crate::model::{Body, Goal, Law, Leg, Parameter, Route, Start};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Field, Ident, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// What stands for the recorded heading or speed.
const RECORDED: &str = "recorded";
/// The function of destinations.
const DESTINATIONS: &str = "destinations";
/// How strongly the heading tells the destination, unless stated.
const KAPPA: f64 = 5.0;
/// Largest `kappa`: then directions one degree apart differ by a factor of 4.
const MOST_KAPPA: f64 = 1e4;
/// A destination as near as this has no direction, m.
const HERE: f64 = 1e-6;

/// What the fields of a declaration say of the intentions of its people.
#[derive(Clone, Default)]
pub(super) struct Intended<'a> {
    turn: Option<Law>,
    speed: Option<&'a Value>,
    goals: Option<Goals>,
}

impl Intended<'_> {
    /// Whether they say something of the speed.
    pub(super) const fn is_of_speed(&self) -> bool {
        self.speed.is_some()
    }
}

/// Destinations of a recording.
#[derive(Clone)]
struct Goals {
    places: Vec<Vec2>,
    kappa: f64,
    span: Span,
}

/// Fields about intentions, and the others.
pub(super) fn split(fields: &[Field]) -> (Vec<&Field>, Vec<&Field>) {
    fields.iter().partition(|field| match field.name.name.as_str() {
        "heading" => true,
        "speed" => match &field.value {
            Value::Plain(law) | Value::Truncated { law, .. } => speaks_of_recorded(law),
            _ => false,
        },
        "route" => destinations(field).is_some(),
        _ => false,
    })
}

/// The recording and the arguments of `route = destinations(hotel)`.
pub(super) fn destinations(field: &Field) -> Option<(&Ident, &[Expr])> {
    match &field.value {
        Value::Plain(Expr { kind: ExprKind::Call { function, arguments }, .. })
            if field.name.name == "route" && function.name == DESTINATIONS =>
        {
            Some((function, arguments))
        }
        _ => None,
    }
}

/// The path of the destinations beside a recording.
pub(super) fn beside(path: &str) -> String {
    let folder = path.rfind(['/', '\\']).map_or("", |end| &path[..=end]);
    format!("{folder}destinations.txt")
}

fn is_recorded(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Name(name) if name == RECORDED)
}

fn speaks_of_recorded(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Binary(_, left, right) => speaks_of_recorded(left) || speaks_of_recorded(right),
        ExprKind::Unary(_, inner) => speaks_of_recorded(inner),
        ExprKind::Call { arguments, .. } => arguments.iter().any(speaks_of_recorded),
        _ => is_recorded(expr),
    }
}

/// The places of a file: two numbers a line, m.
pub(super) fn places(text: &str) -> Result<Vec<Vec2>, String> {
    let rows = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    rows.map(|(line, number)| {
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        match numbers.as_slice() {
            [x, y] if x.is_finite() && y.is_finite() => Ok(Vec2::new(*x, *y)),
            _ => Err(format!("line {number} of the destinations must be two numbers, x and y in m")),
        }
    })
    .collect()
}

/// The probabilities of destinations from a place; `None` where none of them has a direction.
fn weights(places: &[Vec2], from: Vec2, ahead: Vec2, kappa: f64) -> Option<Vec<f64>> {
    let cosine = |place: &Vec2| {
        let way = place - from;
        (way.norm() > HERE).then(|| way.dot(&ahead) / (way.norm() * ahead.norm()))
    };
    let cosines: Vec<Option<f64>> = places.iter().map(cosine).collect();
    let most = cosines.iter().flatten().copied().reduce(math::at_least)?;
    let weights: Vec<f64> = cosines
        .iter()
        .map(|cosine| cosine.map_or(0.0, |cosine| math::exp(kappa * (cosine - most))))
        .collect();
    let total: f64 = weights.iter().sum();
    Some(weights.iter().map(|weight| weight / total).collect())
}

impl Elaborator<'_> {
    /// What fields say of the intentions of people who were recorded.
    pub(super) fn intended<'f>(&mut self, fields: &[&'f Field]) -> Lowered<Intended<'f>> {
        let mut all = Intended::default();
        for (k, field) in fields.iter().enumerate() {
            let name = field.name.name.as_str();
            if let Some(first) = fields[..k].iter().find(|before| before.name.name == name) {
                let error = Diagnostic::error(Code::E0202, field.name.span, format!("`{name}` is set twice"));
                return self.report(error.related(first.name.span, "first set here"));
            }
            match name {
                "heading" => all.turn = Some(self.turn(&field.value)?),
                "speed" => all.speed = Some(&field.value),
                _ => all.goals = Some(self.destinations(field)?),
            }
        }
        if let (Some(_), Some(goals)) = (&all.turn, &all.goals) {
            let error = Diagnostic::error(
                Code::E0405,
                goals.span,
                "a destination and a law of `heading` exclude each other",
            );
            return self.report(error.hint("remove one of them: who goes to a destination heads for it"));
        }
        Ok(all)
    }

    /// The law of the angle between the heading and the recorded one.
    fn turn(&mut self, value: &Value) -> Lowered<Law> {
        let hint = "write for example `heading = recorded + normal(0 deg, 12 deg)`";
        let law = match value {
            Value::Plain(expr) if is_recorded(expr) => return Ok(Law::Constant(0.0)),
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
            Some(law) => self.law(&Value::Plain((**law).clone()), Dimension::ANGLE, &Locals::default()),
            None => {
                let said =
                    "`heading` must be `recorded`, or `recorded` plus an angle or a distribution of angles";
                self.report(Diagnostic::error(Code::E0305, value_span(value), said).hint(hint))
            }
        }
    }

    fn destinations(&mut self, field: &Field) -> Lowered<Goals> {
        let Some((function, arguments)) = destinations(field) else {
            return Err(super::elaborator::Reported);
        };
        let span = value_span(&field.value);
        let usage = "the tracks, and perhaps kappa: `destinations(hotel)`, `destinations(hotel, 5)`";
        let (tracks, kappa) = match arguments {
            [tracks] => (tracks, None),
            [tracks, kappa] => (tracks, Some(kappa)),
            _ => {
                return self.report(Diagnostic::error(
                    Code::E0204,
                    function.span,
                    format!("`destinations` needs {usage}"),
                ));
            }
        };
        let index = match &tracks.kind {
            ExprKind::Name(name) => match self.find(name, 0) {
                Some((_, Meaning::Tracks(index))) => index,
                Some((_, Meaning::Doubtful)) => return Err(super::elaborator::Reported),
                _ => {
                    return self.report(unknown("recording", name, tracks.span, Code::E0201, [].into_iter()));
                }
            },
            _ => {
                let error = Diagnostic::error(Code::E0206, tracks.span, "expected the name of tracks");
                return self.report(error);
            }
        };
        let kappa = match kappa {
            None => KAPPA,
            Some(expr) => {
                let number = self.number_of(expr, Dimension::NONE, &Locals::default())?;
                if !(0.0..=MOST_KAPPA).contains(&number.value) {
                    let said = format!("`kappa` must be from 0 to {MOST_KAPPA} (got {})", number.value);
                    return self.report(Diagnostic::error(Code::E0405, expr.span, said));
                }
                number.value
            }
        };
        match self.destinations.get(index) {
            Some(Ok(places)) if !places.is_empty() => Ok(Goals { places: places.clone(), kappa, span }),
            Some(Ok(_)) => {
                let error = Diagnostic::error(Code::E0702, span, "the file has no destinations");
                self.report(error.hint("write x and y of one destination a line, in m"))
            }
            Some(Err(reason)) => {
                let error = Diagnostic::error(Code::E0701, span, reason.clone());
                self.report(
                    error.hint("put a file `destinations.txt` with x and y a line beside the recording"),
                )
            }
            None => Err(super::elaborator::Reported),
        }
    }

    /// Gives somebody who was seen the intention that the fields say. Who stands has none.
    pub(super) fn intend(
        &mut self,
        intended: &Intended<'_>,
        seen: &Sighting,
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
            body[Parameter::Speed] = self.recorded_speed(value, speed)?;
            start.own_speed = true;
        }
        if let Some(goals) = &intended.goals {
            let Some(weights) = weights(&goals.places, seen.position, seen.driving, goals.kappa) else {
                let said = format!("all destinations of person {} have weight 0", seen.id);
                let error = Diagnostic::error(Code::E0405, goals.span, said);
                return self.report(error.hint("this person is at all of them: add others to the file"));
            };
            let legs = goals.places.iter().map(|place| Leg::To(Goal::Point(*place))).collect();
            *route = Route::OneOf { legs, weights };
        }
        Ok(())
    }

    /// The law of a speed, m/s, around that which was recorded.
    fn recorded_speed(&mut self, value: &Value, speed: f64) -> Lowered<Law> {
        let expr = match value {
            Value::Plain(expr) | Value::Truncated { law: expr, .. } => expr,
            _ => return self.parameter_law(Parameter::Speed, value, &Locals::default()),
        };
        let is_law = is_recorded(expr)
            || matches!(&expr.kind, ExprKind::Binary(BinaryOp::Times, left, right)
                if is_recorded(left) != is_recorded(right));
        if !is_law && distribution(expr).is_none() {
            let said =
                "`speed` must be `recorded`, or `recorded` times a number or a distribution of numbers";
            let hint = "write for example `speed = recorded * normal(1, 0.15) in 0 m/s .. 3 m/s`";
            return self.report(Diagnostic::error(Code::E0305, value_span(value), said).hint(hint));
        }
        let mut locals = Locals::default();
        locals.bind(RECORDED, Typed::Number(Number::rounded(speed, Dimension::SPEED)));
        self.parameter_law(Parameter::Speed, value, &locals)
    }
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;

    #[test]
    fn weights_follow_the_angle_to_the_heading() {
        let at = |degrees: f64, far: f64| {
            let angle = degrees.to_radians();
            Vec2::new(1.0, 2.0) + far * Vec2::new(angle.cos(), angle.sin())
        };
        let angles = [0.0, 40.0, -90.0, 180.0];
        let places: Vec<Vec2> = angles.iter().zip([3.0, 1e5, 7.0, 0.5]).map(|(a, far)| at(*a, far)).collect();
        let found = weights(&places, Vec2::new(1.0, 2.0), Vec2::new(0.7, 0.0), 3.0).unwrap();
        let total: f64 = angles.iter().map(|a| (3.0 * a.to_radians().cos()).exp()).sum();
        for (weight, angle) in found.iter().zip(angles) {
            let wanted = (3.0 * angle.to_radians().cos()).exp() / total;
            assert!((weight - wanted).abs() < 1e-9, "{angle}: {weight}, wanted {wanted}");
        }
        let ahead = Vec2::new(0.7, 0.0);
        assert_eq!(weights(&places, Vec2::new(1.0, 2.0), ahead, 0.0), Some(vec![0.25; 4]));
        assert_eq!(weights(&[Vec2::new(1.0, 2.0)], Vec2::new(1.0, 2.0), ahead, 3.0), None);
        let sharp = weights(&places, Vec2::new(1.0, 2.0), -ahead, 1e4).unwrap();
        assert_eq!(sharp[3], 1.0, "nothing overflows or vanishes as a whole");
    }

    #[test]
    fn destinations_are_read_beside_the_recording() {
        assert_eq!(beside("seq_hotel/obsmat.txt"), "seq_hotel/destinations.txt");
        assert_eq!(beside("obsmat.txt"), "destinations.txt");
        assert_eq!(places(" 1.0e0  -2\n\n3 4\n"), Ok(vec![Vec2::new(1.0, -2.0), Vec2::new(3.0, 4.0)]));
        assert!(places("1 2\n3\n").unwrap_err().contains("line 2"));
    }
}
