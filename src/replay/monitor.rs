//! The formulas of a model on the recording itself: what people did.
//!
//! From each instant on, everybody of the model is where the recording has them, resampled at the step of the scenario. The
//! radii are the means of the kind. A body of several people is at their mean.

use super::Diagnosed;
use super::course::{Beyond, course};
use super::formulas::{self, Asked, targets};
use super::instants::Instant;
use super::situation::Replay;
use crate::base::geometry::Vec2;
use crate::compile::study::World;
use crate::engine::trials::given::{averaged, judge};
use crate::engine::{PreparedWorld, Threads};
use crate::model::{AgentId, Parameter};
use crate::trials::cell::Reading;

/// What one instant came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// When, and who was the user.
    pub instant: Instant,
    /// Whether each property holds; `None` where that is unresolved.
    pub truths: Vec<Option<bool>>,
    /// The value of each number that is asked; `None` where that is unresolved.
    pub values: Vec<Option<f64>>,
    /// Twice the mean radius of the user, m; `None` where the people of the model cannot start.
    pub(super) reach: Option<f64>,
}

/// What each instant came to, in their order.
///
/// # Errors
/// What is wrong with the model.
pub fn monitor(
    replay: &Replay,
    instants: &[Instant],
    beyond: Beyond,
    threads: &Threads,
) -> Diagnosed<Vec<Judged>> {
    let one = |instant: &Instant| {
        let judged = |truths, values, reach| Ok(Judged { instant: *instant, truths, values, reach });
        let Some(study) = replay.study_if_placed(*instant)? else {
            return judged(vec![None; replay.formulas.names.len()], Vec::new(), None);
        };
        let mut targets = targets(&study);
        let count = targets.len();
        targets.extend(formulas::numbers(&study).iter().map(|(_, target)| *target));
        let columns: Vec<usize> = targets.iter().map(|target| target.column).collect();
        let Some(world) = targets.first().and_then(|target| study.worlds.get(target.world)) else {
            return judged(Vec::new(), Vec::new(), None);
        };
        let agents = &world.scenario.agents;
        let user = agents.get(replay.place_of_user(agents));
        let radius = user.map_or(0.0, |agent| agent.body[Parameter::Radius].mean());
        let readings = readings(replay, *instant, (world, &columns), beyond);
        let truths = readings.iter().take(count).map(Reading::truth).collect();
        let values = readings.iter().skip(count).map(Reading::value).collect();
        judged(truths, values, Some(2.0 * radius))
    };
    threads.map(instants, one).into_iter().collect()
}

/// The numbers that are asked, from the first instant at which the model can be made.
pub fn numbers(replay: &Replay, instants: &[Instant]) -> Vec<Asked> {
    let of = |instant: &Instant| Some(formulas::numbers(&replay.study_at(*instant).ok()?));
    let found = instants.iter().find_map(of).unwrap_or_default();
    found.into_iter().map(|(asked, _)| asked).collect()
}

/// Whether each of some columns of a world held from an instant on; the user's own track is never continued.
pub(super) fn happened(
    replay: &Replay,
    instant: Instant,
    of: (&World, &[usize]),
    beyond: Beyond,
) -> Vec<Option<bool>> {
    readings(replay, instant, of, beyond).iter().map(Reading::truth).collect()
}

/// What each of some columns of a world came to.
fn readings(
    replay: &Replay,
    instant: Instant,
    (world, columns): (&World, &[usize]),
    beyond: Beyond,
) -> Vec<Reading> {
    let mean = averaged(world);
    let prepared = PreparedWorld::new(&mean);
    let dt = prepared.program.dt;
    let one = |id: u32, time: f64| {
        let id = replay.written(instant.person, id);
        let own = if id == instant.person { Beyond::Unresolved } else { beyond };
        course(&replay.recording, id, time, own)
    };
    let seen = |tick: u64, agent: AgentId| {
        let ids = &mean.scenario.agents[agent.0 as usize].start.seen;
        let time = instant.time + tick as f64 * dt;
        let all: Vec<(Vec2, Vec2)> = ids.iter().map(|id| one(*id, time)).collect::<Option<_>>()?;
        let count = all.len() as f64;
        let sum = all.iter().fold((Vec2::zeros(), Vec2::zeros()), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        (!all.is_empty()).then(|| (sum.0 / count, sum.1 / count))
    };
    let names: Vec<&str> = replay.recording.columns().collect();
    let told = |tick: u64, column: usize, agent: AgentId| {
        let ids = &mean.scenario.agents[agent.0 as usize].start.seen;
        let time = instant.time + tick as f64 * dt;
        let one =
            |id: &u32| replay.recording.column(names[column], replay.written(instant.person, *id), time);
        ids.iter().map(|id| one(id).unwrap_or(f64::NAN)).sum::<f64>() / ids.len() as f64
    };
    judge(&prepared, columns, seen, (names.len(), told))
        .unwrap_or_else(|_| vec![Reading::Unresolved; columns.len()])
}
