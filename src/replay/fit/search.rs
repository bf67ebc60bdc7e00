//! The search for the parameters with the least loss, and what the result is worth.

use super::cases::{Cases, Parts};
use super::parameter::Fitted;
use super::surface::Surface;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::engine::Threads;
use crate::kernel::driver::MakeDrivers;
use crate::stats::bootstrap::{Bootstrap, Estimate, ratio};
use crate::stats::evolution::Evolution;
use std::sync::atomic::{AtomicBool, Ordering};

/// Fewer persons say too little.
pub const FEWEST: usize = 20;
/// The first standard deviation of the search: of a parameter above 0 a factor of 1.6.
const FIRST: f64 = 0.5;
/// The search ends when no direction has a larger standard deviation.
const LAST: f64 = 2e-3;
/// Candidates of a surface for each of its terms.
const FOR_EACH_TERM: usize = 3;

/// Options of a search.
#[derive(Clone, Copy, Debug)]
pub struct Searching {
    /// Most generations.
    pub generations: u64,
    /// Candidates of a generation; `None` for the usual number.
    pub population: Option<usize>,
    /// Share of the persons that are held out of the search.
    pub held_out: f64,
    /// Seed of the candidates, of who is held out, and of the bootstrap.
    pub seed: u64,
    /// Resamples of the bootstrap, and its confidence.
    pub draws: u32,
    /// Probability with which an interval shall contain the true value.
    pub confidence: f64,
}

impl Searching {
    /// The bootstrap over so many persons.
    const fn bootstrap(self, persons: usize) -> Bootstrap {
        let Self { draws, seed, confidence, .. } = self;
        Bootstrap { persons, draws, seed, confidence }
    }
}

/// A generation of the search.
#[derive(Clone, Debug, PartialEq)]
pub struct Generation {
    /// From 1.
    pub number: u64,
    /// The least loss of its candidates.
    pub best: f64,
    /// The mean of their losses.
    pub mean: f64,
    /// The largest standard deviation of a direction of the next generation.
    pub reach: f64,
    /// Values of the best candidate, SI units.
    pub values: Vec<f64>,
}

/// A fitted parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Which.
    pub parameter: Fitted,
    /// Where the search began, SI units.
    pub start: f64,
    /// Its value, SI units.
    pub value: f64,
    /// Its interval, by bootstrap over persons.
    pub interval: Option<[f64; 2]>,
}

/// Losses of persons with the model as it is and with the fitted parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Number of persons.
    pub persons: u64,
    /// Number of losses.
    pub count: u64,
    /// Mean loss of the model as it is.
    pub before: f64,
    /// Mean loss with the fitted parameters.
    pub after: Estimate,
    /// By how much it fell.
    pub gain: Estimate,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The parameters.
    pub parameters: Vec<Candidate>,
    /// Of the persons that the search read.
    pub fitted: Option<Comparison>,
    /// Of the persons that were held out.
    pub held_out: Option<Comparison>,
    /// Generation by generation.
    pub generations: Vec<Generation>,
    /// How many candidates were tried.
    pub candidates: u64,
}

/// Searches for some parameters; `log` is called after each generation. The search ends early once `stop` is set.
///
/// # Errors
/// The number of a parameter that changes no loss.
pub fn search(
    cases: &Cases,
    fitted: &[Fitted],
    options: Searching,
    (threads, drivers): (&Threads, &MakeDrivers),
    (log, stop): (&mut dyn FnMut(&Generation), &AtomicBool),
) -> Result<Found, usize> {
    let is_held_out = |id: &u32| {
        let key = TrialKey { seed: options.seed, index: u64::from(*id), branch: 1 };
        Stream::of(key, 0, Purpose::Search).uniform(0) < options.held_out
    };
    let held: Vec<bool> = cases.persons.iter().map(is_held_out).collect();
    let starts = cases.starts(fitted);
    let values = |place: &[f64]| -> Vec<f64> {
        fitted.iter().zip(&starts).zip(place).map(|((one, start), at)| one.value(*start, *at)).collect()
    };
    let losses = |values: &[f64]| {
        let pairs: Vec<(Fitted, f64)> = fitted.iter().copied().zip(values.iter().copied()).collect();
        cases.losses(&pairs, threads, drivers)
    };
    let at = |place: &[f64]| losses(&values(place));
    let loss = |parts: &Parts| mean(&own(parts, &held, false)).unwrap_or(f64::INFINITY);

    let centre = vec![0.0; fitted.len()];
    let first = at(&centre);
    for k in 0..fitted.len() {
        let beside = |step: f64| {
            let mut place = centre.clone();
            place[k] = step;
            at(&place)
        };
        if beside(1.0) == first && beside(-1.0) == first {
            return Err(k);
        }
    }
    let mut evolution = Evolution::new(centre.clone(), FIRST, options.population, options.seed);
    let mut tried: Vec<(Vec<f64>, Parts)> = vec![(centre, first)];
    let mut generations = Vec::new();
    while (generations.len() as u64) < options.generations && evolution.reach() > LAST {
        let places = evolution.draw();
        let goes_on = || !stop.load(Ordering::Relaxed);
        let parts: Vec<Parts> = places.iter().map_while(|place| goes_on().then(|| at(place))).collect();
        if parts.len() < places.len() {
            tried.extend(places.into_iter().zip(parts));
            break;
        }
        let all: Vec<f64> = parts.iter().map(loss).collect();
        evolution.learn(&places, &all);
        let best = (0..all.len()).min_by(|a, b| all[*a].total_cmp(&all[*b])).unwrap_or(0);
        let generation = Generation {
            number: generations.len() as u64 + 1,
            best: all[best],
            mean: all.iter().sum::<f64>() / all.len() as f64,
            reach: evolution.reach(),
            values: values(&places[best]),
        };
        log(&generation);
        generations.push(generation);
        tried.extend(places.into_iter().zip(parts));
    }
    let last = evolution.mean().to_vec();
    let parts = at(&last);
    tried.push((last, parts));
    tried.sort_by(|(_, a), (_, b)| loss(a).total_cmp(&loss(b)));
    let (place, after) = tried[0].clone();

    let own_persons = held.iter().filter(|held| !**held).count();
    let intervals = intervals(&place, &tried, &held, &options.bootstrap(own_persons));
    let value = |k: usize, at: f64| fitted[k].value(starts[k], at);
    let candidate = |k: usize| Candidate {
        parameter: fitted[k],
        start: starts[k],
        value: value(k, place[k]),
        interval: intervals[k].map(|ends| ends.map(|end| value(k, end))),
    };
    let before = cases.losses(&[], threads, drivers);
    let compared = |of: bool| {
        let (before, after) = (own(&before, &held, of), own(&after, &held, of));
        compare(&before, &after, &options.bootstrap(before.len()))
    };
    Ok(Found {
        parameters: (0..fitted.len()).map(candidate).collect(),
        fitted: compared(false),
        held_out: compared(true),
        candidates: tried.len() as u64,
        generations,
    })
}

impl Comparison {
    /// Of all persons of other cases, with the parameters that a search found.
    pub fn of(
        cases: &Cases,
        found: &Found,
        options: Searching,
        (threads, drivers): (&Threads, &MakeDrivers),
    ) -> Option<Self> {
        let values: Vec<(Fitted, f64)> =
            found.parameters.iter().map(|one| (one.parameter, one.value)).collect();
        let of = |values: &[(Fitted, f64)]| cases.losses(values, threads, drivers);
        compare(&of(&[]), &of(&values), &options.bootstrap(cases.persons.len()))
    }
}

/// The parts of those who are held out, or of the others.
fn own(parts: &Parts, held: &[bool], of: bool) -> Parts {
    parts.iter().zip(held).filter(|(_, held)| **held == of).map(|(part, _)| *part).collect()
}

fn mean(parts: &Parts) -> Option<f64> {
    ratio(parts)(&vec![1; parts.len()])
}

fn compare(before: &Parts, after: &Parts, bootstrap: &Bootstrap) -> Option<Comparison> {
    let (of_before, of_after) = (ratio(before), ratio(after));
    Some(Comparison {
        persons: after.iter().filter(|part| part[1] > 0.0).count() as u64,
        count: after.iter().map(|part| part[1]).sum::<f64>() as u64,
        before: mean(before)?,
        after: bootstrap.estimate(&of_after)?,
        gain: bootstrap.estimate(|counts| Some(of_before(counts)? - of_after(counts)?))?,
    })
}

/// The interval of each coordinate of the best place. The resampled minima of the surface are shifted by the difference of its
/// own minimum and the one that was found.
fn intervals(
    best: &[f64],
    tried: &[(Vec<f64>, Parts)],
    held: &[bool],
    bootstrap: &Bootstrap,
) -> Vec<Option<[f64; 2]>> {
    let nothing = vec![None; best.len()];
    let wanted = FOR_EACH_TERM * Surface::terms(best.len());
    let near: Vec<(&Vec<f64>, Parts)> =
        tried.iter().take(wanted).map(|(place, parts)| (place, own(parts, held, false))).collect();
    let places: Vec<Vec<f64>> = near.iter().map(|(place, _)| (*place).clone()).collect();
    let Some(surface) = Surface::over(&places).filter(|_| near.len() == wanted) else { return nothing };
    let minimum = |counts: &[u32]| {
        let losses: Option<Vec<f64>> = near.iter().map(|(_, parts)| ratio(parts)(counts)).collect();
        surface.minimum(&losses?)
    };
    let of = |k: usize| {
        let found = bootstrap.estimate(|counts| Some(minimum(counts)?[k]))?;
        let shift = best[k] - found.value;
        found.interval.map(|ends| ends.map(|end| end + shift))
    };
    (0..best.len()).map(of).collect()
}
