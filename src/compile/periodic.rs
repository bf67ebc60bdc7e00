//! Periodic scenes: the range along an axis after which the plane begins again, what must lie in it, and what cannot be there.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use crate::base::geometry::Vec2;
use crate::model::{Barrier, Obstacle, Period, Route, Start};
use crate::syntax::ast::{Expr, Field, Ident, Item, ScenarioFile, SceneItem};
use crate::syntax::source::Span;

/// The shortest period, m: in a shorter one images of one person would be within reach of each other (cells of Voronoi
/// densities, bodies of large groups).
const SHORTEST: f64 = 3.0;

/// Coordinates are smaller than this, m.
const FARTHEST: f64 = 1e7;

/// What lies outside of the range must not: a hair is rounding, m.
const HAIR: f64 = 1e-9;

impl<'a> Elaborator<'a> {
    /// Settles the periods of a scene, before anything that must lie within them.
    pub(super) fn settle_periods(&mut self, file: &'a ScenarioFile) {
        let items = file.items.iter().filter_map(|item| match item {
            Item::Scene(items) => Some(items),
            _ => None,
        });
        for item in items.flatten() {
            if let SceneItem::Periodic { axis, ends, span } = item
                && self.period(axis, ends, *span).is_err()
            {
                // Whatever it should be, all lies in it.
                let all = Period { low: -FARTHEST, length: 2.0 * FARTHEST };
                self.scene.periods.x = self.scene.periods.x.or(Some(all));
            }
        }
    }

    fn period(&mut self, axis: &Ident, ends: &[Expr; 2], span: Span) -> Lowered<()> {
        let example = "write for example `periodic x in 0 m .. 20 m`";
        let coordinate = |this: &mut Self, end: &Expr| {
            let number = this.number_of(end, Dimension::LENGTH, &Locals::default())?;
            this.in_reach(end.span, Vec2::new(number.value, 0.0)).map(|place| place.x)
        };
        let (low, high) = (coordinate(self, &ends[0]), coordinate(self, &ends[1]));
        if !["x", "y"].contains(&axis.name.as_str()) {
            let text = format!("a scene is periodic along `x` or `y` (got `{}`)", axis.name);
            return self.report(error!(E0410, axis.span, "{text}"; hint: "{example}"));
        }
        let (low, high) = (low?, high?);
        let period = Period { low, length: high - low };
        let wrong = if period.length <= 0.0 {
            Some(format!("the range of a period must ascend (got {} .. {})", metres(low), metres(high)))
        } else if period.length < SHORTEST {
            Some(format!("a period must be at least {SHORTEST} m long (got {})", metres(period.length)))
        } else {
            None
        };
        if let Some(text) = wrong {
            let range = ends[0].span.to(ends[1].span);
            return self.report(error!(E0410, range, "{text}"; hint: "{example}"));
        }
        let periods = &mut self.scene.periods;
        let known = if axis.name == "x" { &mut periods.x } else { &mut periods.y };
        if known.is_some() {
            let text = format!("the period along `{}` is declared twice", axis.name);
            return self.report(error!(E0410, span, "{text}"; hint: "remove one of them"));
        }
        *known = Some(period);
        Ok(())
    }

    /// A place that the scene holds.
    pub(super) fn in_scene(&mut self, span: Span, p: Vec2) -> Lowered<Vec2> {
        let p = self.in_reach(span, p)?;
        if self.scene.periods.hold(p, HAIR) {
            return Ok(p);
        }
        let periods = self.scene.periods;
        let beyond = |axis: &str, period: Option<Period>, v: f64| {
            let period = period.filter(|period| v < period.low || v > period.high())?;
            let (low, high) = (metres(period.low), metres(period.high()));
            Some(format!("{axis} = {} lies outside of the period {low} .. {high}", metres(v)))
        };
        let text = beyond("x", periods.x, p.x).or_else(|| beyond("y", periods.y, p.y));
        self.report(error!(E0410, span, "{}", text.unwrap_or_default();
            hint: "end at the ends of the period: what is there continues at the other end"))
    }

    /// Refuses barriers of imports outside of the scene.
    pub(super) fn check_imported(&mut self, items: &[SceneItem], first: usize) {
        let import = items.iter().find_map(|item| match item {
            SceneItem::Import { span, .. } => Some(*span),
            _ => None,
        });
        let (Some(span), false) = (import, self.scene.periods.are_none()) else { return };
        let corners: Vec<Vec2> = self.scene.barriers[first..].iter().flat_map(corners).collect();
        for corner in corners {
            if self.in_scene(span, corner).is_err() {
                return;
            }
        }
    }

    /// Refuses what a periodic scene cannot have.
    pub(super) fn refuse_if_periodic(&mut self, span: Span, what: &str, hint: &str) -> Lowered<()> {
        if self.scene.periods.are_none() {
            return Ok(());
        }
        let text = format!("{what} are not available in a periodic scene");
        self.report(error!(E0410, span, "{text}"; hint: "{hint}"))
    }

    /// Where somebody goes: its `route`, or in a periodic scene its `direction`, which is part of its start.
    pub(super) fn headed(&mut self, fields: &[&Field], start: Lowered<Start>) -> Lowered<(Start, Route)> {
        let field = |name: &str| fields.iter().find(|field| field.name.name == name);
        let Some(direction) = field("direction") else {
            let route = self.route_of(fields);
            return Ok((start?, route?));
        };
        let law = self.law(&direction.value, Dimension::ANGLE, &Locals::default());
        // A part that could not be read may have been the period.
        let is_torn = self.torn.iter().any(|part| part.source == direction.name.span.source);
        let (wrong, hint) = if self.scene.periods.are_none() {
            (
                Some("`direction` needs a periodic scene"),
                "write a `route`, or `periodic x in 0 m .. 20 m` in the scene",
            )
        } else {
            (field("route").map(|_| "an agent has a `direction` or a `route`, not both"), "remove `route`")
        };
        if let Some(text) = wrong.filter(|_| !is_torn) {
            return self.report(error!(E0410, direction.name.span, "{text}"; hint: "{hint}"));
        }
        let start = Start { driving: Some(Vec2::new(1.0, 0.0)), turn: law?, own_speed: true, ..start? };
        Ok((start, Route::Onward))
    }
}

/// A length without noise of rounding.
fn metres(length: f64) -> String {
    format!("{} m", (length * 1e6).round() / 1e6)
}

/// Corners of a rectangle around a barrier.
fn corners(barrier: &Barrier) -> Vec<Vec2> {
    match &barrier.obstacle {
        Obstacle::Wall(segments) => segments.iter().flat_map(|segment| [segment.a, segment.b]).collect(),
        Obstacle::Solid(shape) => vec![shape.bounds().low, shape.bounds().high],
    }
}
