//! Predictions of a model against what happened: probabilities of properties, and ways.
//!
//! At each instant at which somebody moves and whose next seconds are recorded, trials of the model begin with those who are
//! there. The share of them in which a property holds is compared with whether it held in the recording.

use super::Diagnosed;
use super::displacement::Displacement;
use super::formulas::targets;
use super::instants::Instant;
use super::kinds::CONSTANT;
use super::monitor::Judged;
use super::region::{Fit, HORIZONS};
use super::situation::Replay;
use crate::base::geometry::Vec2;
use crate::base::tick::Tick;
use crate::engine::trials::sample::{Followed, sample};
use crate::engine::{PreparedWorld, Threads};
use crate::kernel::driver::MakeDrivers;
use crate::model::AgentId;
use crate::trials::cell::Series;
use std::collections::BTreeSet;

/// Displacements are those of so many seconds, or of the horizon if that is shorter.
pub const PREDICTED: f64 = 4.8;

/// Options of an evaluation.
#[derive(Clone, Debug)]
pub struct Evaluating {
    /// Trials of each instant.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// A probability and what happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// When, and for whom.
    pub instant: Instant,
    /// Share of the trials in which the property held.
    pub probability: f64,
    /// Whether it held in the recording.
    pub happened: bool,
}

/// Predictions of one kind.
#[derive(Clone, Debug, Default)]
pub struct Predicted {
    /// For each property its predictions; an instant at which the recording does not tell is none.
    pub predictions: Vec<Vec<Prediction>>,
    /// For each property the instants at which the recording or no trial tells.
    pub unresolved: Vec<u64>,
    /// Displacements.
    pub displacements: Vec<Displacement>,
    /// Recorded positions among predicted ones, after each of [`HORIZONS`] that is within the horizon.
    pub fits: Vec<PositionFits>,
}

/// Whose positions, and how they fit.
pub type PositionFits = (u32, [Option<Fit>; HORIZONS.len()]);

/// What one instant yields: for each property a probability and what happened.
type Row = (Vec<Option<(f64, bool)>>, Option<(Displacement, [Option<Fit>; HORIZONS.len()])>);

/// The instants at which the user moves, was there one step of the recording before, and is there for `seconds` from then on.
pub fn eligible(replay: &Replay, instants: Vec<Instant>, speed: f64, seconds: f64) -> Vec<Instant> {
    let step = replay.recording.step();
    let is_there = |instant: &Instant, time: f64| replay.recording.person_at(instant.person, time).is_some();
    let moves = |instant: &Instant| {
        let now = replay.recorded.person_at(instant.person, instant.time);
        now.is_some_and(|now| now.velocity.norm() > speed)
    };
    let lasts = |instant: &Instant| {
        let steps = (seconds / step + 1e-9) as u64;
        let times = (1..=steps).map(|k| k as f64 * step).chain([seconds]);
        times.into_iter().all(|time| is_there(instant, instant.time + time))
    };
    let mut kept = instants;
    kept.retain(|instant| moves(instant) && is_there(instant, instant.time - step) && lasts(instant));
    kept
}

/// The predictions of a kind at some instants. The outcomes and the radius at which ways collide are those of the model as
/// it is written, so that they are the same for all kinds.
///
/// # Errors
/// What is wrong with the model.
pub fn evaluate(
    replay: &Replay,
    kind: &str,
    instants: &[Judged],
    options: &Evaluating,
    (threads, drivers): (&Threads, &MakeDrivers),
) -> Diagnosed<Predicted> {
    let own = replay.with_kind(kind)?;
    // Without any random number one trial says all.
    let trials = if kind == CONSTANT { 1 } else { options.trials };
    let numbered: Vec<(u64, &Judged)> = (0..).zip(instants).collect();
    let one = |(number, judged): &(u64, &Judged)| -> Diagnosed<Row> {
        let study = own.study_if_placed(judged.instant)?.filter(|_| judged.reach.is_some());
        let Some(study) = study else { return Ok((vec![None; own.formulas.names.len()], None)) };
        let targets = targets(&study);
        let columns: Vec<usize> = targets.iter().map(|target| target.column).collect();
        let Some(target) = targets.first() else { return Ok((Vec::new(), None)) };
        let Some(prepared) = PreparedWorld::of(&study, target.world, options.seed, drivers) else {
            return Ok((Vec::new(), None));
        };
        let series = Series { seed: options.seed, branch: (number & 0xffff) as u16 };
        Ok(predict(&own, judged, &prepared, &columns, (series, trials)))
    };
    let rows: Vec<Row> = threads.map(&numbered, one).into_iter().collect::<Result<_, _>>()?;
    let count = own.formulas.names.len();
    let mut all = Predicted {
        predictions: vec![Vec::new(); count],
        unresolved: vec![0; count],
        displacements: rows.iter().filter_map(|(_, ways)| Some(ways.as_ref()?.0)).collect(),
        fits: rows
            .iter()
            .filter_map(|(_, ways)| ways.as_ref())
            .map(|(one, fits)| (one.person, *fits))
            .collect(),
    };
    for (judged, (row, _)) in instants.iter().zip(&rows) {
        for (k, cell) in row.iter().enumerate() {
            match cell {
                Some((probability, happened)) => all.predictions[k].push(Prediction {
                    instant: judged.instant,
                    probability: *probability,
                    happened: *happened,
                }),
                None => all.unresolved[k] += 1,
            }
        }
    }
    Ok(all)
}

/// Trials from one instant on, beside what happened.
fn predict(
    replay: &Replay,
    Judged { instant, truths, reach, .. }: &Judged,
    prepared: &PreparedWorld,
    columns: &[usize],
    (series, trials): (Series, u64),
) -> Row {
    let scenario = &prepared.program.scenario;
    let own = replay.place_of_user(&scenario.agents);
    let (every, dt) = (replay.recording.step(), prepared.program.dt);
    let last = PREDICTED.min(scenario.clock.seconds(Tick(prepared.horizon.0)));
    let times: Vec<f64> = (1..=(last / every + 1e-9).floor() as u64).map(|k| k as f64 * every).collect();
    let tick = |time: &f64| (time / dt).round() as u64;
    let horizons = HORIZONS.iter().filter(|time| **time <= last + 1e-9);
    let ticks: BTreeSet<u64> = times.iter().chain(horizons).map(tick).collect();
    let ticks: Vec<u64> = ticks.into_iter().collect();
    let followed = Followed { agents: &[AgentId(own as u32)], ticks: &ticks };
    let Ok(found) = sample(prepared, columns, series, trials, followed) else {
        return (vec![None; columns.len()], None);
    };
    let cells = (0..columns.len()).map(|k| found.share(k).zip(truths.get(k).copied().flatten())).collect();
    let place = |time: &f64| ticks.binary_search(&tick(time)).ok();
    let at_times = |way: &Vec<Vec2>| times.iter().filter_map(|time| way.get(place(time)?).copied()).collect();
    let ways: Vec<Vec<Vec2>> = found.paths.iter().map(at_times).collect();
    let fit = |time: f64| {
        let predicted: Vec<Vec2> =
            found.paths.iter().filter_map(|way| way.get(place(&time)?).copied()).collect();
        Fit::of(&predicted, replay.place_at(instant.person, instant.time + time)?)
    };
    (
        cells,
        displacement(replay, *instant, &times, &ways, reach.unwrap_or_default())
            .map(|one| (one, HORIZONS.map(fit))),
    )
}

/// Distances of ways from the recorded one.
fn displacement(
    replay: &Replay,
    instant: Instant,
    times: &[f64],
    ways: &[Vec<Vec2>],
    reach: f64,
) -> Option<Displacement> {
    let at = |time: &f64| replay.place_at(instant.person, instant.time + time);
    let whole: Option<Vec<Vec2>> = times.iter().map(at).collect();
    let others: Vec<Vec<Vec2>> = times
        .iter()
        .map(|time| {
            let now = replay.recording.at(instant.time + time);
            now.iter().filter(|one| one.id != instant.person).map(|one| one.position).collect()
        })
        .collect();
    Displacement::of(instant.person, ways, &whole?, (&others, reach))
}
