//! What fields say of the intentions of people who were recorded: laws around the recorded heading and speed, and destinations.
//!
//! Of some destinations each is the goal with a weight of exp(kappa cos angle), where the angle is that between the way to it and
//! the recorded heading: the density of the von Mises law.

use crate::base::geometry::Vec2;
use crate::base::math;
use crate::model::Law;
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Value};
use crate::syntax::source::Span;

/// What stands for the recorded heading or speed.
pub(crate) const RECORDED: &str = "recorded";
/// The name of the speed that somebody recorded would have alone.
pub(crate) const WANTED: &str = "wanted";
/// The name of the law of a calibration.
pub(crate) const SITE: &str = "site";
/// The function of destinations.
const DESTINATIONS: &str = "destinations";
/// A destination as near as this has no direction, m.
const HERE: f64 = 1e-6;

/// What the fields of a declaration say of the intentions of its people.
#[derive(Clone, Default)]
pub(crate) struct Intended<'a> {
    /// The angle from the recorded heading, rad.
    pub(crate) turn: Option<Law>,
    /// The speed as written.
    pub(crate) speed: Option<&'a Value>,
    /// The goals of which each has one.
    pub(crate) goals: Option<Goals>,
}

impl Intended<'_> {
    /// Whether they say something of the speed.
    pub(crate) const fn is_of_speed(&self) -> bool {
        self.speed.is_some()
    }

    /// Whether they say something of the heading or the speed.
    pub(crate) const fn is_drawn(&self) -> bool {
        self.turn.is_some() || self.speed.is_some()
    }
}

/// Destinations of a recording.
#[derive(Clone)]
pub(crate) struct Goals {
    /// Where they are, m.
    pub(crate) places: Vec<Vec2>,
    /// How strongly the heading tells which is the goal.
    pub(crate) kappa: f64,
    /// Where they are named.
    pub(crate) span: Span,
}

/// Fields about intentions, and the others.
pub(crate) fn parted(fields: &[Field]) -> (Vec<&Field>, Vec<&Field>) {
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
pub(crate) fn destinations(field: &Field) -> Option<(&Ident, &[Expr])> {
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
pub(crate) fn beside(path: &str) -> String {
    let folder = path.rfind(['/', '\\']).map_or("", |end| &path[..=end]);
    format!("{folder}destinations.txt")
}

/// Whether an expression is just what was recorded.
pub(crate) fn is_recorded(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Name(name) if name == RECORDED)
}

/// Whether an expression is just the law of the site.
pub(crate) fn is_of_site(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Name(name) if name == SITE)
}

/// Whether an expression is just the recorded speed, or what that tells of the wanted one.
pub(crate) fn is_speed(expr: &Expr) -> bool {
    is_recorded(expr) || matches!(&expr.kind, ExprKind::Name(name) if name == WANTED)
}

/// The speed that somebody would have alone, who was seen to walk at a speed, m/s, where so many others are around, 1/m^2: of
/// what others of the kind would lose there by Weidmann's diagram (1993), as much is added as the density leaves open. It is at
/// least the present speed; in the open it is just that, in a jam it is the kind's.
pub(crate) fn wanted(speed: f64, density: f64, of_kind: f64) -> f64 {
    let left = 1.0 - math::exp(-1.913 * (1.0 / density - 1.0 / 5.4));
    let left = math::at_least(0.0, math::at_most(left, 1.0));
    speed + (1.0 - left) * math::at_least(of_kind - speed, 0.0)
}

fn speaks_of_recorded(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Binary(_, left, right) => speaks_of_recorded(left) || speaks_of_recorded(right),
        ExprKind::Unary(_, inner) => speaks_of_recorded(inner),
        ExprKind::Call { arguments, .. } => arguments.iter().any(speaks_of_recorded),
        _ => is_speed(expr) || is_of_site(expr),
    }
}

/// The places of a file: two numbers a line, m.
pub(crate) fn places(text: &str) -> Result<Vec<Vec2>, String> {
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
pub(crate) fn weights(places: &[Vec2], from: Vec2, ahead: Vec2, kappa: f64) -> Option<Vec<f64>> {
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
