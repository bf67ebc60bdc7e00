//! Sources: who comes in, how often, and how many places are kept for them.
//!
//! Without a `limit` so many places are kept that a trial needs more with a probability below 1e-9: the smallest n
//! with e^(th) E[e^(-tX)]^n below it for some t, h the horizon and X the time between arrivals (the bound of
//! Chernoff 1952 on the sum of n of them).

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::laws::{truncate, value_span};
use super::people::People;
use super::symbols::Meaning;
use crate::base::math;
use crate::model::{Law, Route, Source};
use crate::syntax::ast::process::SourceDecl;
use crate::syntax::ast::{Field, Value};
use crate::syntax::diagnostic::Diagnostic;
use std::sync::Arc;

/// Most places that are kept without a `limit`.
const MOST_PLACES: usize = 20_000;
/// Logarithm of one over the probability that places do not suffice.
const RARE: f64 = 20.723_265_836_946_41;

impl<'a> Elaborator<'a> {
    /// `source doors: adult with phone { … }`
    pub(super) fn source(&mut self, decl: &'a SourceDecl, people: &mut People) -> Option<Source> {
        let mut kind = self.kind(&decl.kind);
        let with = self.with(&decl.name, &decl.with);
        let rest = self.parameters(&decl.body, kind.as_mut().ok(), &Locals::default());
        let start = self.start(&decl.name, &rest, people, true);
        let route = self.way_out(decl, &rest);
        let every = self.interval(decl, &rest);
        let limit = self.limit(&rest);
        self.only(&rest, &["at", "every", "route", "limit", "velocity"]);
        let body = kind.and_then(|kind| self.body(&kind, &decl.kind));
        let places = match (&every, &limit) {
            (Ok(every), Ok(limit)) => self.places(decl, &rest, every, *limit),
            (Err(reported), _) | (_, Err(reported)) => Err(*reported),
        };
        let (Ok(body), Ok(start), Ok(route), Ok(every), Ok(places)) = (body, start, route, every, places)
        else {
            self.define_empty(&decl.name, true, with);
            return None;
        };
        let body = Arc::new(body);
        // The range of numbers does not depend on how many places are kept: another horizon, the same people.
        let range = places.next_power_of_two().max(1024) as u32;
        let first = people.entities(&decl.name.name, range);
        self.coming = true;
        let members = self.members(&decl.name, places, true, first, people, |_| {
            (body.clone(), start.clone(), route.clone())
        });
        people.written(&members, &rest, decl.name.span);
        people.coming.extend(&members);
        for member in &members {
            self.may_be_absent(*member);
        }
        self.attach(with, &members);
        let entity = people.entities(&format!("{}.every", decl.name.name), 1);
        self.scopes[0]
            .define(&decl.name, Meaning::Agents { members: members.clone().into(), particle: false });
        Some(Source { name: decl.name.name.clone(), entity, every, members })
    }

    /// Who comes in leaves at the last goal.
    fn way_out(&mut self, decl: &'a SourceDecl, fields: &[&'a Field]) -> Lowered<Route> {
        let Some(field) = fields.iter().find(|field| field.name.name == "route") else {
            let error = Diagnostic::error(
                "E0209",
                decl.name.span,
                format!("where do those of `{}` go?", decl.name.name),
            )
            .hint("set `route`: people of a source leave at its last goal");
            return self.report(error);
        };
        match self.route(&field.value, &Locals::default())? {
            Route::Legs { legs, .. } => Ok(Route::Legs { legs, then_leave: true }),
            Route::Onward => Ok(Route::Onward),
        }
    }

    /// The time between arrivals.
    fn interval(&mut self, decl: &'a SourceDecl, fields: &[&'a Field]) -> Lowered<Law> {
        let Some(field) = fields.iter().find(|field| field.name.name == "every") else {
            let error = Diagnostic::error(
                "E0209",
                decl.name.span,
                format!("how often does somebody come by `{}`?", decl.name.name),
            )
            .hint("set `every`, the time between two arrivals: `every = exponential(4 s)`");
            return self.report(error);
        };
        let law = self.law(&field.value, Dimension::TIME, &Locals::default())?;
        let span = value_span(&field.value);
        if law.bounds().0 < 0.0 {
            let error = Diagnostic::error("E0405", span, "a time between arrivals cannot be negative");
            return self.report(truncate(error, &law));
        }
        if law.mean() > 0.0 {
            Ok(law)
        } else {
            self.report(Diagnostic::error("E0405", span, "infinitely many would come at once"))
        }
    }

    fn limit(&mut self, fields: &[&'a Field]) -> Lowered<Option<usize>> {
        let Some(field) = fields.iter().find(|field| field.name.name == "limit") else { return Ok(None) };
        match &field.value {
            Value::Plain(expr) => self.count(expr).map(Some),
            other => self.report(Diagnostic::error(
                "E0305",
                value_span(other),
                "expected how many may come at most",
            )),
        }
    }

    /// How many places are kept.
    fn places(
        &mut self,
        decl: &'a SourceDecl,
        fields: &[&'a Field],
        every: &Law,
        limit: Option<usize>,
    ) -> Lowered<usize> {
        let horizon = self.clock.seconds(self.horizon);
        let expected = horizon / every.mean();
        let span =
            fields.iter().find(|field| field.name.name == "limit").map(|field| value_span(&field.value));
        match (limit, span) {
            (Some(limit), Some(span)) if (limit as f64) < expected => {
                let error = Diagnostic::error(
                    "E0913",
                    span,
                    format!("about {expected:.0} people are expected up to the horizon, more than this"),
                )
                .hint("a trial in which more come than `limit` is unresolved");
                self.report(error)
            }
            (Some(limit), _) => Ok(limit),
            (None, _) => match enough(every, horizon) {
                Some(places) if places <= MOST_PLACES => Ok(places),
                _ => {
                    let error = Diagnostic::error(
                        "E0913",
                        decl.name.span,
                        format!("about {expected:.0} people would come by `{}`", decl.name.name),
                    )
                    .hint("say how many may come at most with `limit`, or shorten the horizon");
                    self.report(error)
                }
            },
        }
    }
}

/// So many arrivals within a time that more are rarer than one in a thousand million.
fn enough(every: &Law, horizon: f64) -> Option<usize> {
    const POINTS: u32 = 512;
    let law = every.ready();
    let times: Vec<f64> = (0..POINTS).map(|k| law.draw((f64::from(k) + 0.5) / f64::from(POINTS))).collect();
    let mut best = f64::INFINITY;
    for k in 0..=120 {
        // From a hundredth to ten thousand of one over the mean.
        let t = math::exp((f64::from(k) / 20.0 - 2.0) * std::f64::consts::LN_10) / every.mean();
        let transform = times.iter().map(|time| math::exp(-t * time)).sum::<f64>() / f64::from(POINTS);
        let count = (RARE + t * horizon) / -math::ln(transform);
        if count > 0.0 && count < best {
            best = count;
        }
    }
    best.is_finite().then(|| best.ceil() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Family;

    fn law(family: Family) -> Law {
        Law::Random { family, low: f64::NEG_INFINITY, high: f64::INFINITY }
    }

    #[test]
    fn places_suffice_but_are_not_many() {
        // More than n of a Poisson number with mean 7.5: 2e-9 for 28, 1.4e-10 for 30.
        let poisson = enough(&law(Family::Exponential { mean: 4.0 }), 30.0).unwrap();
        assert!((28..=32).contains(&poisson), "{poisson}");
        // With constant times nothing is left to chance.
        assert_eq!(enough(&Law::Constant(4.0), 30.0), Some(8));
        assert_eq!(enough(&law(Family::Choice(vec![(0.0, 1.0)])), 30.0), None);
    }
}
