//! Sources: who comes in, how often, and how many places are kept for them.
//!
//! Without a `limit` so many places are kept that a trial has more arrivals with a probability below 1e-9: the smallest n
//! with e^(th) E[e^(-tX)]^n below it for some t, h the horizon and X the time between arrivals (the bound of
//! Chernoff 1952 on the sum of n of them). The expectation is known, or bounded from above by that of times that are
//! a little shorter.

use crate::base::math;
use crate::compile::behaviour::attachment;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    clock::Told,
    people::{People, entities},
    symbols::Meaning,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::laws::{self, advise_bounds};
use crate::compile::people::{self, kinds, positions, routes};
use crate::compile::scene::periodic;
use crate::model::{Family, Law, Route, Source};
use crate::syntax::ast::process::SourceDecl;
use crate::syntax::ast::{Field, Value};
use std::sync::Arc;

/// Most places that are kept without a `limit`.
const MOST_PLACES: usize = 20_000;
/// Most people that may come in a trial.
const MOST_PEOPLE: usize = 1 << 20;
/// Logarithm of one over the probability that places do not suffice.
const RARE: f64 = 20.723_265_836_946_41;

/// `source doors: adult with phone { … }`
pub(crate) fn source<'a>(
    context: &mut Context<'a>,
    decl: &'a SourceDecl,
    people: &mut People,
) -> Option<Source> {
    let mut kind = kinds::kind(context, &decl.kind);
    let mut with = attachment::with(context, &decl.name, &decl.with);
    let rest = kinds::parameters(context, &decl.body, kind.as_mut().ok(), &Locals::default());
    let start = positions::start(context, &decl.name, &rest, people, true);
    let hint = "declare agents: they are there from the beginning";
    let route = periodic::refuse_if_periodic(context, decl.name.span, "sources", hint);
    let route = route.and_then(|()| way_out(context, decl, &rest));
    let every = interval(context, decl, &rest);
    let limit = limit(context, &rest);
    people::only(context, &rest, &["at", "every", "route", "limit", "velocity"]);
    let body = kind.and_then(|kind| kinds::body(context, &kind, &decl.kind));
    let places = match (&every, &limit) {
        // Without a clock the number of arrivals is unknown.
        (Ok(_), Ok(_)) if context.sink.told < Told::Whole => Err(Reported),
        (Ok(every), Ok(limit)) => places(context, decl, &rest, every, *limit),
        (Err(reported), _) | (_, Err(reported)) => Err(*reported),
    };
    let (Ok(body), Ok(start), Ok(route), Ok(every), Ok((places, range))) =
        (body, start, route, every, places)
    else {
        people::define_empty(context, &decl.name, true, with);
        return None;
    };
    let body = Arc::new(body);
    let numbers = (
        entities(context, people, &decl.name.name, range, decl.name.span),
        entities(context, people, &format!("{}.every", decl.name.name), 1, decl.name.span),
    );
    let (Ok(first), Ok(entity)) = numbers else {
        people::define_empty(context, &decl.name, true, with);
        return None;
    };
    context.roster.coming = true;
    let members = people::members(context, &decl.name, places, true, first, people, |_| {
        (body.clone(), start.clone(), route.clone())
    });
    people.written(&members, &rest, decl.name.span);
    people.coming.extend(&members);
    for member in &members {
        context.roster.passing.insert(*member);
    }
    with.most = range;
    attachment::attach(context, with, &members);
    context.names.scopes[0]
        .define(&decl.name, Meaning::Agents { members: members.clone().into(), particle: false });
    Some(Source { name: decl.name.name.clone(), entity, every, members, most: range })
}

/// Agents of a source leave at the last goal.
fn way_out<'a>(context: &mut Context<'a>, decl: &'a SourceDecl, fields: &[&'a Field]) -> Lowered<Route> {
    let Some(field) = fields.iter().find(|field| field.name.name == "route") else {
        return context.report(error!(E0209, decl.name.span, "source `{}` has no `route`", decl.name.name;
                hint: "write `route = …`; agents of a source leave at its last goal"));
    };
    match routes::route(context, &field.value, &Locals::default())? {
        Route::Legs { legs, .. } => Ok(Route::Legs { legs, then_leave: true }),
        other => Ok(other),
    }
}

/// The time between arrivals.
fn interval<'a>(context: &mut Context<'a>, decl: &'a SourceDecl, fields: &[&'a Field]) -> Lowered<Law> {
    let Some(field) = fields.iter().find(|field| field.name.name == "every") else {
        return context.report(error!(E0209, decl.name.span, "source `{}` has no `every`", decl.name.name;
                hint: "write the time between two arrivals: `every = exponential(4 s)`"));
    };
    let law = laws::law(context, &field.value, Dimension::TIME, &Locals::default())?;
    let span = field.value.span();
    if law.bounds().0 < 0.0 {
        let error = error!(E0405, span, "the time between arrivals cannot be negative");
        let text = context.text(span);
        return context.report(advise_bounds(error, &law, &text));
    }
    if law.mean() > 0.0 {
        Ok(law)
    } else {
        context.report(error!(
            E0405,
            span, "the time between arrivals is 0: infinitely many agents would arrive at once"
        ))
    }
}

fn limit<'a>(context: &mut Context<'a>, fields: &[&'a Field]) -> Lowered<Option<usize>> {
    let Some(field) = fields.iter().find(|field| field.name.name == "limit") else { return Ok(None) };
    match &field.value {
        Value::Plain(expr) => people::counted(context, expr).map(Some),
        other => context.report(error!(E0305, other.span(), "expected the largest number of agents")),
    }
}

/// How many places are kept, and how many numbers of people. These do not depend on how many places there are: another
/// horizon, the same people.
fn places<'a>(
    context: &mut Context<'a>,
    decl: &'a SourceDecl,
    fields: &[&'a Field],
    every: &Law,
    limit: Option<usize>,
) -> Lowered<(usize, u32)> {
    let horizon = context.time.clock.seconds(context.time.horizon);
    let expected = horizon / every.mean();
    let span = fields.iter().find(|field| field.name.name == "limit").map(|field| field.value.span());
    let enough = enough(every, horizon);
    let range = |people: usize| people.next_power_of_two().max(1024) as u32;
    match (limit, enough) {
        // Places are used again: numbers are kept for all who may come.
        (Some(limit), Some(people)) if (limit as f64) < expected && people <= MOST_PEOPLE => {
            Ok((limit, range(people)))
        }
        // More may come than are expected.
        (Some(limit), enough) if (limit as f64) >= expected => {
            let people = enough.filter(|people| *people <= MOST_PEOPLE);
            Ok((limit, range(people.unwrap_or(limit).max(limit))))
        }
        (None, Some(places)) if places <= MOST_PLACES => Ok((places, range(places))),
        (limit, _) => {
            let text = format!("about {expected:.0} agents would arrive by source `{}`", decl.name.name);
            let error = error!(E0913, span.unwrap_or(decl.name.span), "{text}");
            context.report(error.hint(if limit.is_none() {
                "write `limit`, the largest number of agents present at once, or shorten the horizon"
            } else {
                "shorten the horizon, or reduce the arrivals"
            }))
        }
    }
}

/// So many arrivals within a time that more are rarer than one in a thousand million.
fn enough(every: &Law, horizon: f64) -> Option<usize> {
    let times = Times::of(every);
    let mut best = f64::INFINITY;
    for k in 0..=120 {
        // From a hundredth to ten thousand of one over the mean.
        let t = math::exp((f64::from(k) / 20.0 - 2.0) * std::f64::consts::LN_10) / every.mean();
        let count = (RARE + t * horizon) / -math::ln(times.transform(t));
        if count > 0.0 && count < best {
            best = count;
        }
    }
    best.is_finite().then(|| best.ceil() as usize)
}

/// Times between arrivals, or times that are a little shorter.
enum Times {
    /// Exponential ones of a mean.
    Exponential(f64),
    /// Some times with their probabilities, which sum to 1.
    Listed(Vec<(f64, f64)>),
}

impl Times {
    fn of(law: &Law) -> Self {
        const POINTS: u32 = 1024;
        // What rounding can do to a time that is drawn.
        const ROUNDING: f64 = 1e-9;
        match law {
            Law::Random { family: Family::Exponential { mean }, low, high }
                if *low <= 0.0 && *high == f64::INFINITY =>
            {
                return Self::Exponential(*mean);
            }
            // These are not drawn in the order of their size.
            Law::Random { family: Family::Choice(options) | Family::Multiple { options, .. }, low, high } => {
                let kept = options.iter().filter(|(value, _)| low <= value && value <= high);
                let mass: f64 = kept.clone().map(|(_, weight)| weight).sum();
                return Self::Listed(kept.map(|(value, weight)| (*value, weight / mass)).collect());
            }
            _ => {}
        }
        // What is drawn rises with the uniform number: on each part of its range the least is that at its start.
        let ready = law.ready();
        let part = 1.0 / f64::from(POINTS);
        let least = |k: u32| if k == 0 { law.bounds().0 } else { ready.draw(f64::from(k) * part) };
        Self::Listed((0..POINTS).map(|k| (least(k) * (1.0 - ROUNDING), part)).collect())
    }

    /// At least E[e^(-tX)].
    fn transform(&self, t: f64) -> f64 {
        match self {
            Self::Exponential(mean) => 1.0 / (1.0 + t * mean),
            Self::Listed(times) => times.iter().map(|(time, weight)| weight * math::exp(-t * time)).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::special::ln_gamma;

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

    #[test]
    fn no_transform_is_too_small() {
        let uniform =
            |low: f64, high: f64, t: f64| (math::exp(-t * low) - math::exp(-t * high)) / (t * (high - low));
        for t in [0.01, 0.3, 1.0, 4.0, 30.0, 1000.0] {
            let cut = Law::Random { family: Family::Exponential { mean: 1.0 }, low: 0.0, high: 20.0 };
            let rest = math::exp(-20.0);
            let whole = (1.0 - rest * math::exp(-20.0 * t)) / ((1.0 + t) * (1.0 - rest));
            for (law, exact) in [
                (law(Family::Exponential { mean: 2.0 }), 1.0 / (1.0 + 2.0 * t)),
                (cut, whole),
                (law(Family::Uniform { low: 0.0, high: 2.0 }), uniform(0.0, 2.0, t)),
                (law(Family::Uniform { low: 1.0, high: 2.0 }), uniform(1.0, 2.0, t)),
                (
                    law(Family::Choice(vec![(2.0, 0.25), (1.0, 0.75)])),
                    0.25 * math::exp(-2.0 * t) + 0.75 * math::exp(-t),
                ),
                (Law::Constant(3.0), math::exp(-3.0 * t)),
            ] {
                let bound = Times::of(&law).transform(t);
                assert!(bound >= exact * (1.0 - 1e-12), "{law:?} {t}: {bound} {exact}");
                assert!(bound <= exact + 1.001 / 1024.0, "{law:?} {t}: {bound} {exact}");
            }
        }
    }

    #[test]
    fn the_bound_holds_for_poisson_arrivals() {
        // More than n arrivals with probability above 1e-9: some trial has too few places.
        for mean in [1e-3, 0.02, 0.5, 3.0, 40.0, 1000.0] {
            let places = enough(&law(Family::Exponential { mean: 1.0 }), mean).unwrap();
            let cut = Law::Random { family: Family::Exponential { mean: 1.0 }, low: 0.0, high: 60.0 };
            assert!(enough(&cut, mean).unwrap() >= places, "{mean}");
            let exactly = |n: usize| math::exp(n as f64 * math::ln(mean) - mean - ln_gamma(n as f64 + 1.0));
            let more: f64 = (places + 1..places + 200).map(exactly).sum();
            assert!(more < 1e-9, "{mean}: {places} places, {more}");
        }
        // Twice as many places as arrivals would be too careful.
        assert!(enough(&law(Family::Uniform { low: 0.0, high: 2.0 }), 1000.0).unwrap() < 1150);
        for (gap, horizon, most) in [(1.0, 100.0, 100), (4.0, 28.0, 7), (0.5, 0.4, 0)] {
            let places = enough(&Law::Constant(gap), horizon).unwrap();
            assert!(places >= most && places <= most + 1, "{gap} {horizon}: {places}");
        }
    }
}
