//! Instants of a recording from which trials begin, and the loss of parameters there.

use super::parameter::Fitted;
use crate::base::geometry::Vec2;
use crate::base::tick::Tick;
use crate::compile::study::Study;
use crate::engine::trials::sample::{Followed, Sample, sample};
use crate::engine::{PreparedWorld, Threads};
use crate::kernel::driver::MakeDrivers;
use crate::model::AgentId;
use crate::replay::Diagnosed;
use crate::replay::course::Beyond;
use crate::replay::evaluate::PREDICTED;
use crate::replay::formulas::targets;
use crate::replay::instants::Instant;
use crate::replay::monitor::happened;
use crate::replay::region::{Fit, HORIZONS};
use crate::replay::situation::Replay;
use crate::trials::cell::Series;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Loss of a position that no trial reaches because all of them fail: that of a density of 1e-9 /m^2.
const MISSED: f64 = 20.7;

/// How trials are counted.
#[derive(Clone, Copy, Debug)]
pub struct Counting {
    /// Trials of each instant.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether the loss is the Brier score of the properties; else it is that of positions.
    pub by_properties: bool,
}

/// Sum of losses and their number, person by person.
pub type Parts = Vec<[f64; 2]>;

/// The instants of a model with a recording, compiled.
pub struct Cases {
    instants: Vec<Case>,
    /// Ids of the persons that count, ascending; [`Parts`] have this order.
    pub persons: Vec<u32>,
    counting: Counting,
}

/// One instant.
struct Case {
    study: Study,
    world: usize,
    columns: Vec<usize>,
    /// Whether each property held.
    truths: Vec<Option<bool>>,
    /// Who is followed, and the numbers of their persons; with properties the user alone counts.
    agents: Vec<AgentId>,
    persons: Vec<usize>,
    ticks: Vec<u64>,
    /// Where each of them was at each tick.
    recorded: Vec<Vec<Option<Vec2>>>,
    series: Series,
}

impl Cases {
    /// Those of some instants of persons. By positions, all persons of a time are followed in the same trials.
    ///
    /// # Errors
    /// What is wrong with the model.
    pub fn new(
        replay: &Replay,
        instants: &[Instant],
        counting: Counting,
        threads: &Threads,
    ) -> Diagnosed<Self> {
        let persons: BTreeSet<u32> = instants.iter().map(|one| one.person).collect();
        let persons: Vec<u32> = persons.into_iter().collect();
        let together = |a: &Instant, b: &Instant| !counting.by_properties && a.time == b.time;
        let groups: Vec<(u64, &[Instant])> = (0..).zip(instants.chunk_by(together)).collect();
        let number: BTreeMap<u32, usize> = persons.iter().copied().zip(0..).collect();
        let one = |(at, group): &(u64, &[Instant])| case(replay, group, (*at, &number), counting);
        let cases = threads.map(&groups, one).into_iter().collect::<Result<Vec<_>, _>>()?;
        Ok(Self { instants: cases.into_iter().flatten().collect(), persons, counting })
    }

    /// Where searches for some parameters begin, SI units.
    pub(super) fn starts(&self, fitted: &[Fitted]) -> Vec<f64> {
        let agents =
            self.instants.first().map_or(&[][..], |one| &one.study.worlds[one.world].scenario.agents);
        fitted.iter().map(|one| one.start(agents)).collect()
    }

    /// The loss with some parameters, SI units; without any that of the model as it is.
    pub fn losses(&self, values: &[(Fitted, f64)], threads: &Threads, drivers: &MakeDrivers) -> Parts {
        let found = threads.map(&self.instants, |case| case.losses(values, self.counting, drivers));
        let mut parts = vec![[0.0, 0.0]; self.persons.len()];
        for (person, loss) in found.into_iter().flatten() {
            parts[person][0] += loss;
            parts[person][1] += 1.0;
        }
        parts
    }
}

/// The case of some instants of one time; the first person is the user. `None` where people cannot start there.
fn case(
    replay: &Replay,
    group: &[Instant],
    (at, number): (u64, &BTreeMap<u32, usize>),
    counting: Counting,
) -> Diagnosed<Option<Case>> {
    let Some(user) = group.first().copied() else { return Ok(None) };
    let Some(study) = replay.study_if_placed(user)? else { return Ok(None) };
    let targets = targets(&study);
    let index = targets.first().map_or(study.base, |target| target.world);
    let Some(world) = study.worlds.get(index) else { return Ok(None) };
    let (clock, last) = (world.scenario.clock, world.scenario.horizon);
    let last = PREDICTED.min(clock.seconds(Tick(last.0)));
    let dt = clock.seconds(Tick(1));
    let by_properties = counting.by_properties;
    let is_followed = |time: &f64| !by_properties && *time <= last + 1e-9;
    let times: Vec<f64> = HORIZONS.into_iter().filter(is_followed).collect();
    let (mut agents, mut persons, mut recorded) = (Vec::new(), Vec::new(), Vec::new());
    let (mut columns, mut truths) = (Vec::new(), Vec::new());
    if by_properties {
        columns.extend(targets.iter().map(|target| target.column));
        truths = happened(replay, user, (world, &columns), Beyond::Onward);
        persons.extend(number.get(&user.person));
    } else {
        for (agent, id) in replay.persons(user.person, &world.scenario.agents) {
            let is_counted = group.iter().any(|one| one.person == id);
            let Some(person) = number.get(&id).filter(|_| is_counted) else { continue };
            agents.push(agent);
            persons.push(*person);
            recorded.push(times.iter().map(|time| replay.place_at(id, user.time + time)).collect());
        }
    }
    let series = Series { seed: counting.seed, branch: (at & 0xffff) as u16 };
    let ticks = times.iter().map(|time| (time / dt).round() as u64).collect();
    Ok(Some(Case { world: index, columns, truths, agents, persons, ticks, recorded, series, study }))
}

impl Case {
    /// The losses of persons.
    fn losses(
        &self,
        values: &[(Fitted, f64)],
        counting: Counting,
        drivers: &MakeDrivers,
    ) -> Vec<(usize, f64)> {
        let mut study = self.study.clone();
        let scenario = Arc::make_mut(&mut study.worlds[self.world].scenario);
        for (one, value) in values {
            one.set(scenario, *value);
        }
        let Some(prepared) = PreparedWorld::of(&study, self.world, counting.seed, drivers) else {
            return Vec::new();
        };
        let followed = Followed { agents: &self.agents, ticks: &self.ticks };
        let found =
            sample(&prepared, &self.columns, self.series, counting.trials, followed).unwrap_or_default();
        if counting.by_properties { self.of_properties(&found) } else { self.of_positions(&found) }
    }

    fn of_positions(&self, found: &Sample) -> Vec<(usize, f64)> {
        let mut losses = Vec::new();
        for (k, (person, recorded)) in self.persons.iter().zip(&self.recorded).enumerate() {
            for (tick, position) in recorded.iter().enumerate() {
                let Some(position) = position else { continue };
                let place = tick * self.agents.len() + k;
                let predicted: Vec<Vec2> =
                    found.paths.iter().filter_map(|way| way.get(place).copied()).collect();
                let density = Fit::of(&predicted, *position).map(|fit| fit.predictive);
                losses.push((*person, density.filter(|one| one.is_finite()).map_or(MISSED, |one| -one)));
            }
        }
        losses
    }

    /// Squared differences of probabilities and outcomes.
    fn of_properties(&self, found: &Sample) -> Vec<(usize, f64)> {
        let Some(person) = self.persons.first() else { return Vec::new() };
        let one = |(column, truth): (usize, &Option<bool>)| {
            let held = f64::from(u8::from((*truth)?));
            // Without a trial that says anything both outcomes are as likely.
            let share = found.share(column).unwrap_or(0.5);
            Some((*person, (share - held) * (share - held)))
        };
        self.truths.iter().enumerate().filter_map(one).collect()
    }
}
