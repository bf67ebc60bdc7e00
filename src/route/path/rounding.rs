//! Polylines with rounded corners.
//!
//! A fillet takes at most half of a leg that leads to another corner, so corners are independent of each other. It
//! may take all of the first and of the last leg, and of a leg that touches a circle.

use super::around::{self, Leg, Stop};
use super::clearance::largest_radius;
use super::fillet::Corner;
use super::path::Path;
use super::piece::Piece;
use super::taut;
use crate::base::geometry::{Segment, Vec2};
use crate::model::Sight;
use crate::model::planner::RoundingRule;
use crate::model::sight::ROUNDING;

/// With a smaller radius, m, an agent stops and turns.
pub(super) const LEAST_RADIUS: f64 = 0.05;

/// The path along a polyline, m, whose corners are rounded.
///
/// Each radius is the largest one of at most `corner`, m, for which the arc keeps `reach`, m, from all barriers and
/// fits on its legs. Where no radius of 0.05 m is free, the path turns around the corner of the barrier that is in the
/// way, if that is free; else it stops and turns at the vertex. Vertices on a straight line and repeated points are
/// left out. If the polyline keeps `reach` from the barriers, so does the path, up to 1e-9 m. Without points it is
/// empty and lies at the origin.
pub fn round(points: &[Vec2], corner: f64, reach: f64, sight: &Sight) -> Path {
    round_by(points, (corner, RoundingRule::Shared), reach, sight)
}

/// The same where a rule says how much of its legs an arc may take.
pub fn round_by(points: &[Vec2], (corner, rule): (f64, RoundingRule), reach: f64, sight: &Sight) -> Path {
    let rounding = Rounding { corner, rule, reach, sight };
    let mut stops = tidy(points);
    let mut fillets = rounding.fillets(&stops);
    if fillets.iter().any(|fillet| fillet.is_blocked) {
        let circle = |fillet: &Fillet| {
            let corner = Some(&fillet.corner).filter(|_| fillet.is_blocked)?;
            around::circle(corner, LEAST_RADIUS, reach, sight)
        };
        let inner = fillets.iter().map(circle);
        let circles = std::iter::once(None).chain(inner).chain([None]).collect();
        stops = taut::replace(&stops, circles, reach, sight);
        fillets = rounding.fillets(&stops);
    }
    path(&stops, &fillets)
}

/// The stops at the vertices of a polyline that are neither repeated nor on a straight line.
fn tidy(points: &[Vec2]) -> Vec<Stop> {
    let mut stops: Vec<Stop> = Vec::with_capacity(points.len());
    for &at in points {
        while let [.., a, b] = stops.as_slice()
            && Segment::new(a.at, at).distance(b.at) <= ROUNDING
        {
            stops.pop();
        }
        if stops.last().is_none_or(|last| (at - last.at).norm() > ROUNDING) {
            stops.push(Stop { at, around: 0.0 });
        }
    }
    stops
}

/// How an inner stop is passed.
struct Fillet {
    corner: Corner,
    /// Its radius, m; 0 where the path stops and turns, and around a circle.
    radius: f64,
    /// Whether a barrier leaves no radius.
    is_blocked: bool,
}

struct Rounding<'a> {
    corner: f64,
    rule: RoundingRule,
    reach: f64,
    sight: &'a Sight,
}

impl Rounding<'_> {
    /// The fillets of the inner stops.
    fn fillets(&self, stops: &[Stop]) -> Vec<Fillet> {
        // A leg is shared by the fillets at both of its ends.
        let last = stops.len().saturating_sub(1);
        let has_fillet = |k: usize| k > 0 && k < last && stops.get(k).is_some_and(|stop| stop.around == 0.0);
        let is_half = |k: usize| self.rule == RoundingRule::HalfEdges || has_fillet(k) && has_fillet(k + 1);
        let share = |k: usize| if is_half(k) { 0.5 } else { 1.0 };
        let legs = stops.windows(2).filter_map(|pair| Leg::between(*pair.first()?, *pair.get(1)?));
        let legs: Vec<Leg> = legs.collect();
        let inner = legs.iter().zip(legs.iter().skip(1)).zip(stops.iter().skip(1)).enumerate();
        let fillet = |(k, ((before, after), stop)): (usize, ((&Leg, &Leg), &Stop))| {
            let corner = Corner::new(stop.at, before.along, after.along);
            let fits = (before.length * share(k)).min(after.length * share(k + 1)) / corner.tangent();
            let limit = fits.min(self.corner);
            if stop.around != 0.0 || limit.is_nan() || limit <= 0.0 {
                return Fillet { corner, radius: 0.0, is_blocked: false };
            }
            let radius = largest_radius(&corner, limit, self.reach, self.sight);
            let is_blocked = radius < limit.min(LEAST_RADIUS);
            Fillet { corner, radius: if radius < LEAST_RADIUS { 0.0 } else { radius }, is_blocked }
        };
        inner.map(fillet).collect()
    }
}

/// The path along stops with the fillets of the inner ones.
fn path(stops: &[Stop], fillets: &[Fillet]) -> Path {
    let mut path = Path::empty(stops.first().map_or_else(Vec2::zeros, |stop| stop.at));
    for (stop, Fillet { corner, radius, .. }) in stops.iter().skip(1).zip(fillets) {
        if stop.around != 0.0 {
            let arc = around::arc(*stop, corner.before, corner.after);
            path.push_line(arc.at(0.0).position);
            path.push(arc);
        } else if *radius > 0.0 {
            let arc = corner.arc(*radius);
            path.push_line(arc.at(0.0).position);
            path.push(arc);
        } else {
            path.push_line(corner.at);
            path.push(Piece::Turn { at: corner.at, from: corner.before, to: corner.after });
        }
    }
    if let Some(end) = stops.last().filter(|_| stops.len() > 1) {
        path.push_line(end.at);
    }
    path
}
