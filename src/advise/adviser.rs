//! The adviser: Algorithms 1 and 4 of Given-Wilson et al. 2017, one cycle for each batch of observations.

use super::advice::{Advice, GroupSeen, OptionSeen, Place, Status, UserSeen};
use super::grouping::groups_until;
use super::place::{fit, unit};
use super::role::Role;
use super::sight::{Followed, around, followed, seen};
use crate::base::geometry::Vec2;
use crate::base::random::TrialKey;
use crate::compile::study::{Ask, Query, Study};
use crate::compile::{Files, Input, examine};
use crate::data::tracks::Batch;
use crate::engine::outcome::{QueryResult, Ranking, Stop};
use crate::engine::{Budget, Call, CommandLine, Executor, Nobody, run};
use crate::gait;
use crate::kernel::{Address, Program, Run, State};
use crate::model::{Move, Scenario};
use crate::perception::{ConstantVelocity, Lineage, Tracker, Tracking, TrackingError};
use crate::route::Ways;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::Span;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Points that a trace keeps: a minute at 2.5 Hz.
const KEPT: usize = 150;
/// Most observations of a cycle, those beyond the range left out.
const MOST_SEEN: usize = 2000;
/// The advice was followed if the user moved within this angle (its cosine, 20°) and this speed, m/s.
const FOLLOWS: (f64, f64) = (0.939_692_620_785_908_4, 0.3);

/// Options of an adviser.
#[derive(Clone, Debug, Default)]
pub struct Advising {
    /// Seed of all random numbers; all cycles use it, each with its number as branch.
    pub seed: u64,
    /// The id of the user; that of the scenario unless it is set.
    pub user: Option<u32>,
    /// Whoever is farther from the user is left out, m.
    pub range: Option<f64>,
    /// The query that is asked, by its property or its number; the first ranking of moves unless it is set.
    pub only: Option<String>,
}

/// What was advised in the last cycle.
#[derive(Clone, Copy, Debug)]
struct Last {
    time: f64,
    position: Vec2,
    velocity: Vec2,
}

/// Advises one user, batch by batch.
pub struct Adviser<'a> {
    input: Input<'a>,
    files: Files,
    role: Role,
    options: Advising,
    tracker: Tracker,
    lineage: Lineage,
    ways: Arc<Ways>,
    cycle: u64,
    last: Option<Last>,
    /// When somebody was last seen, s.
    sighted: Option<f64>,
    /// The scenario of the last cycle that compiled.
    scenario: Option<Arc<Scenario>>,
    /// Where the user would walk under the last advice.
    step: Option<Step>,
}

/// The first trial under some advice, in which the user walks as advised.
struct Step {
    scenario: Arc<Scenario>,
    advice: Option<(usize, usize)>,
    key: TrialKey,
    agent: usize,
    position: Vec2,
}

/// What a cycle knows of the people, before moves are ranked.
struct Scene {
    user: Followed,
    users: Vec<u64>,
    middle: Vec2,
    study: Study,
}

impl<'a> Adviser<'a> {
    /// An adviser in the role that the scenario of an input gives; the moves of that role are ranked.
    pub fn new(input: Input<'a>, role: Role, options: Advising) -> Self {
        let tracking = Tracking { kept: Some(KEPT), ..Tracking::default() };
        Self {
            files: input.files.clone(),
            input,
            role,
            tracker: Tracker::new(tracking),
            lineage: Lineage::new(tracking.longest),
            ways: Arc::default(),
            cycle: 0,
            last: None,
            sighted: None,
            scenario: None,
            step: None,
            options,
        }
    }

    /// The id of the user.
    pub fn user(&self) -> u32 {
        self.options.user.unwrap_or(self.role.person)
    }

    /// The scenario with the people of the last cycle that compiled.
    pub fn scenario(&self) -> Option<&Scenario> {
        self.scenario.as_deref()
    }

    /// Continues the traces with a cycle for which no advice is wanted.
    ///
    /// # Errors
    /// Batches that are late or of different times.
    pub fn watch(&mut self, batches: &[Batch]) -> Result<(), TrackingError> {
        self.tracker.step(batches, &mut ConstantVelocity)?;
        drop(self.tracker.take_ended());
        let time = batches.first().map_or(0.0, |batch| batch.time);
        if batches.iter().any(|batch| !batch.seen.is_empty()) {
            self.sighted = Some(time);
        }
        let all = followed(self.tracker.active(), batches, time, None);
        self.grouped(time, &all, &|| false);
        Ok(())
    }

    /// Where the user is so many seconds after the last advice, and how fast, who follows it in the social force model.
    pub fn walked(&self, seconds: f64) -> Option<(Vec2, Vec2)> {
        let Step { scenario, advice, key, agent, position } = self.step.as_ref()?;
        let drivers = gait::drivers(&self.ways, scenario, self.options.seed);
        let program = Program::driven(Arc::clone(scenario), drivers);
        let (mut run, _) = Run::of(&program, Address { key: *key, advice: *advice, changes: &[] }).ok()?;
        let at = |state: &State| {
            let slot = state.slot(*agent, 0);
            (state.position(slot), state.velocity(slot))
        };
        let (start, _) = at(run.state());
        let steps = (seconds / scenario.clock.step_seconds()).round();
        for _ in 0..steps as u64 {
            run.next_state().ok()?;
        }
        let (end, velocity) = at(run.state());
        Some((position + (end - start), velocity))
    }

    /// The clusters of some people, and their numbers.
    fn grouped(&mut self, time: f64, all: &[Followed], is_over: &dyn Fn() -> bool) -> Vec<(u64, Vec<usize>)> {
        // As a check has them, which finds the same groups.
        let mut sightings: Vec<_> = all.iter().map(|one| one.sighting).collect();
        sightings.sort_by_key(|one| one.id);
        let groups = groups_until(&sightings, is_over);
        let places: BTreeMap<u32, usize> =
            all.iter().enumerate().map(|(k, one)| (one.sighting.id, k)).collect();
        let member = |id: &u32| places.get(id).copied();
        let places: Vec<Vec<usize>> =
            groups.iter().map(|group| group.iter().filter_map(member).collect()).collect();
        let traces: Vec<Vec<u64>> = places
            .iter()
            .map(|group| {
                let mut traces: Vec<u64> = group.iter().map(|k| all[*k].trace).collect();
                traces.sort_unstable();
                traces
            })
            .collect();
        self.lineage.step(time, &traces).into_iter().zip(places).collect()
    }

    /// Advice after the batches of one time. With a deadline it is what is known by then.
    ///
    /// # Errors
    /// What is wrong with the model where these people are; an error that the model alone has comes in the first cycle.
    pub fn advise(
        &mut self,
        batches: &[Batch],
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<Advice, Vec<Diagnostic>> {
        let time = batches.first().map_or(0.0, |batch| batch.time);
        let mut advice = Advice { cycle: self.cycle, time, ..Advice::default() };
        self.cycle += 1;
        // The clock of the stream was set back.
        if self.tracker.last().is_some_and(|last| time < last) {
            self.tracker.restart();
            (self.last, self.sighted) = (None, None);
        }
        if batches.iter().any(|batch| !batch.seen.is_empty()) {
            self.sighted = Some(time);
        }
        let person = self.user();
        let near = self.options.range.and_then(|range| around(batches, self.tracker.active(), person, range));
        let near = near.as_deref().unwrap_or(batches);
        let count: usize = near.iter().map(|batch| batch.seen.len()).sum();
        if count > MOST_SEEN {
            advice.status = Status::Late;
            advice
                .notes
                .push(format!("{count} observations at a time, more than {MOST_SEEN}: set a `--range`"));
            return Ok(advice);
        }
        let numbers = match self.tracker.step(near, &mut ConstantVelocity) {
            Ok(numbers) => numbers,
            Err(error) => {
                advice.notes.push(error.to_string());
                return Ok(advice);
            }
        };
        let distinct = |batch: &Vec<u64>| batch.iter().collect::<BTreeSet<_>>().len();
        let twice: usize = numbers.iter().map(|batch| batch.len() - distinct(batch)).sum();
        if twice > 0 {
            advice
                .notes
                .push(format!("{twice} observations at the place of another one are taken as one person"));
        }
        drop(self.tracker.take_ended());
        let longest = Tracking::default().longest;
        let trace = self.tracker.active().iter().find(|trace| trace.person == Some(person));
        let trace = trace.filter(|trace| time - trace.end().time <= longest).map(|trace| trace.number);
        let all = followed(self.tracker.active(), batches, time, trace);
        let groups = self.grouped(time, &all, &|| budget.is_over());
        advice.people = all.len();
        advice.groups = groups.iter().map(|group| group_seen(group, &all)).collect();
        let user = trace.and_then(|number| all.iter().position(|one| one.trace == number));
        let Some(user) = user else {
            let is_blind = self.sighted.is_none_or(|sighted| time - sighted > longest);
            advice.status = if is_blind { Status::Blind } else { Status::Lost };
            self.last = None;
            return Ok(advice);
        };
        advice.followed = self.last.and_then(|last| has_followed(last, time, all[user].sighting.position));
        if budget.is_over() {
            advice.status = Status::Late;
            advice.notes.push("no time was left for trials".to_owned());
            self.last = None;
            return Ok(advice);
        }
        match self.scene(&mut advice, &all, &groups, user)? {
            Some(scene) => self.rank(&mut advice, &scene, executor, budget)?,
            None => advice.status = Status::Late,
        }
        self.last = match advice.status {
            Status::Advice | Status::Stop => Some(Last {
                time,
                position: all[user].sighting.position,
                velocity: advice.direction.map_or_else(Vec2::zeros, |d| d * advice.speed.unwrap_or(0.0)),
            }),
            _ => None,
        };
        Ok(advice)
    }

    /// Compiles the scenario with those who are seen; `None`, with a note, where somebody stands so that no trial can begin.
    fn scene(
        &mut self,
        advice: &mut Advice,
        all: &[Followed],
        groups: &[(u64, Vec<usize>)],
        user: usize,
    ) -> Result<Option<Scene>, Vec<Diagnostic>> {
        let own = groups.iter().find(|(_, members)| members.contains(&user));
        let (number, members) = own.map_or((0, vec![user]), |(number, members)| (*number, members.clone()));
        let ids: Vec<Vec<u32>> =
            groups.iter().map(|(_, members)| members.iter().map(|k| all[*k].sighting.id).collect()).collect();
        let seen = seen(all, (&all[user], self.role.person), self.options.range, &ids);
        advice.people = seen.people.len();
        self.files.see(self.role.tracks.clone(), seen);
        let input = Input { files: &self.files, ..self.input };
        let examined = examine(&input);
        let (errors, warnings): (Vec<Diagnostic>, Vec<Diagnostic>) =
            examined.found.into_iter().partition(|one| one.severity == Severity::Error);
        let moved = warnings.into_iter().filter(|one| one.code == Code::W0701);
        advice.notes.extend(moved.map(|one| one.title));
        let study = match examined.study {
            Some(study) if errors.is_empty() => study,
            _ if !errors.is_empty() && errors.iter().all(is_of_a_place) => {
                advice.notes.push(format!("no trial can begin: {}", errors[0].title));
                return Ok(None);
            }
            _ => return Err(errors),
        };
        self.scenario = study.worlds.get(study.base).map(|world| Arc::clone(&world.scenario));
        let taken: Vec<usize> = if self.role.is_group { members.clone() } else { vec![user] };
        let middle =
            taken.iter().map(|k| all[*k].sighting.position).sum::<Vec2>() / taken.len().max(1) as f64;
        let sighting = &all[user].sighting;
        advice.user = Some(UserSeen {
            id: self.user(),
            trace: all[user].trace,
            group: number,
            members: members.len(),
            position: sighting.position,
            place: Place::Inside,
            rejoin: None,
        });
        if all[user].past.len() < 2 && sighting.velocity == Vec2::zeros() {
            advice.notes.push("the user was seen once and is taken to stand".to_owned());
        }
        if all[user].last < advice.time {
            advice.notes.push(format!("the user was last seen at {} s", all[user].last));
        }
        let users = taken.iter().map(|k| all[*k].trace).collect();
        Ok(Some(Scene { user: all[user].clone(), users, middle, study }))
    }

    /// Ranks the moves.
    fn rank(
        &mut self,
        advice: &mut Advice,
        scene: &Scene,
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<(), Vec<Diagnostic>> {
        let query = self.query(&scene.study).map_err(|error| vec![error])?;
        let ways = Arc::clone(&self.ways);
        let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
        let call = Call {
            seed: self.options.seed,
            branch: (advice.cycle & 0xffff) as u16,
            explains: false,
            shows_evidence: false,
            repeats: false,
            line: CommandLine::default(),
            only: vec![query.index],
            place: &|_: Span| (String::new(), 0),
            drivers: &drivers,
        };
        let found = run(&scene.study, &call, executor, budget, &Nobody);
        let results = match found {
            Ok(call) => call.results,
            Err(fault) => {
                advice.notes.push(format!("the moves cannot be ranked: {fault}"));
                Vec::new()
            }
        };
        let Some((result, ranking)) = results.iter().find_map(|one| Some((one, one.rank.as_ref()?))) else {
            advice.status = Status::Late;
            return Ok(());
        };
        tell(advice, result, ranking);
        let chosen = advice.chosen.clone().filter(|_| advice.status == Status::Advice);
        let options = if let Ask::Rank { options, .. } = &query.ask { options.as_slice() } else { &[] };
        let option = chosen.and_then(|label| options.iter().find(|option| option.label == label));
        let (direction, speed, seconds) = option.map_or((None, 0.0, 0.0), |option| {
            shown(&scene.study, option.target.world, option.advice, &call)
        });
        self.step = option.and_then(|option| {
            let scenario = Arc::clone(&scene.study.worlds.get(option.target.world)?.scenario);
            let agent = scenario.moves.get(option.advice?.0)?.agent.0 as usize;
            let key = TrialKey { seed: call.seed, index: 0, branch: call.branch };
            let position = scene.user.sighting.position;
            Some(Step { scenario, advice: option.advice, key, agent, position })
        });
        let velocity = direction.map_or_else(Vec2::zeros, |direction| direction * speed);
        let place = scene.user.sighting.position;
        let fitted = fit(place, (scene.middle, scene.users.len()), velocity, seconds);
        advice.direction = fitted.direction;
        let is_known = matches!(advice.status, Status::Advice | Status::Stop);
        advice.speed = is_known.then(|| velocity.norm());
        if let Some(user) = &mut advice.user {
            (user.place, user.rejoin) = (fitted.place, fitted.rejoin);
        }
        Ok(())
    }

    /// The ranking that is asked.
    fn query<'s>(&self, study: &'s Study) -> Result<&'s Query, Diagnostic> {
        let is_ranking = |query: &&Query| match &query.ask {
            // One of values as well has several worlds, which are not advice.
            Ask::Rank { options, models, .. } => {
                let mut worlds: Vec<usize> = options.iter().map(|option| option.target.world).collect();
                worlds.sort_unstable();
                worlds.dedup();
                options.iter().all(|option| option.advice.is_some()) && worlds.len() <= *models
            }
            _ => false,
        };
        let mut rankings = study.queries.iter().filter(is_ranking);
        let found = match &self.options.only {
            Some(wanted) => rankings
                .find(|query| query.name.as_ref() == Some(wanted) || wanted.parse() == Ok(query.index)),
            None => rankings.next(),
        };
        found.ok_or_else(|| {
            if let Some(wanted) = &self.options.only {
                let said = format!("`--only {wanted}`: no ranking of moves is about `{wanted}`");
                return Diagnostic::placeless(Code::E0705, said)
                    .hint("write the name of its property, or its number");
            }
            let error = Diagnostic::placeless(Code::E0406, "the property files rank no moves");
            error.hint("write `rank moves of user by P(safe) within 0.05 confidence 95 %`")
        })
    }
}

/// Whether an error is about where somebody stands: another instant may have none.
fn is_of_a_place(error: &Diagnostic) -> bool {
    matches!(error.code, Code::E0409 | Code::E0801 | Code::E0802 | Code::E0803)
}

/// What a ranking says.
fn tell(advice: &mut Advice, result: &QueryResult, ranking: &Ranking) {
    let numbers = |value: &crate::engine::outcome::Interval| [value.estimate, value.low, value.high];
    advice.trials = ranking.options.iter().map(|option| option.counts.trials).sum();
    advice.options = ranking
        .options
        .iter()
        .map(|option| OptionSeen {
            label: option.label.clone(),
            probability: numbers(&option.value),
            status: option.status.name(),
        })
        .collect();
    advice.gap = ranking.gap.is_finite().then_some(ranking.gap);
    advice.certified = matches!(result.stopped_by, Stop::Width | Stop::Plan);
    let Some(best) = ranking.options.first().filter(|_| advice.trials > 0 && ranking.choice.is_some()) else {
        advice.status = Status::Late;
        return;
    };
    advice.probability = Some(numbers(&best.value));
    let has_success = ranking
        .options
        .iter()
        .any(|option| option.counts.successes > 0 || option.counts.successes + option.counts.failures == 0);
    advice.status = if has_success { Status::Advice } else { Status::Stop };
    advice.chosen = if has_success { ranking.choice.clone() } else { Some("stop".to_owned()) };
}

/// Direction and speed, m/s, that a move gives at the start, and for how many seconds it holds.
fn shown(
    study: &Study,
    world: usize,
    advice: Option<(usize, usize)>,
    call: &Call<'_>,
) -> (Option<Vec2>, f64, f64) {
    let Some(world) = study.worlds.get(world) else { return (None, 0.0, 0.0) };
    let Some(moves) = advice.and_then(|(moves, _)| world.scenario.moves.get(moves)) else {
        return (None, 0.0, 0.0);
    };
    let seconds = world.scenario.clock.seconds(moves.duration);
    let option = advice.and_then(|(_, option)| moves.options.get(option));
    if option.is_some_and(|(_, option)| *option == Move::Stop) {
        return (None, 0.0, seconds);
    }
    let drivers = (call.drivers)(&world.scenario, call.seed);
    let program = Program::driven(Arc::clone(&world.scenario), drivers);
    let key = TrialKey { seed: call.seed, index: 0, branch: call.branch };
    let Ok((run, _)) = Run::of(&program, Address { key, advice, changes: &[] }) else {
        return (None, 0.0, seconds);
    };
    let state = run.state();
    let slot = state.slot(moves.agent.0 as usize, 0);
    let direction = slot.vector(&state.driving.ex, &state.driving.ey);
    (unit(direction), slot.of(&state.driving.speed), seconds)
}

/// Whether somebody moved as advised.
fn has_followed(last: Last, time: f64, position: Vec2) -> Option<bool> {
    let seconds = time - last.time;
    if seconds <= 0.0 {
        return None;
    }
    let moved = (position - last.position) / seconds;
    let (cosine, slack) = FOLLOWS;
    let is_fast = (moved.norm() - last.velocity.norm()).abs() <= slack;
    let is_along = match (unit(moved), unit(last.velocity)) {
        (Some(moved), Some(advised)) => moved.dot(&advised) >= cosine,
        (_, None) => true,
        (None, Some(_)) => false,
    };
    Some(is_fast && is_along)
}

fn group_seen((id, members): &(u64, Vec<usize>), all: &[Followed]) -> GroupSeen {
    let count = members.len().max(1) as f64;
    let mean = |of: fn(&Followed) -> Vec2| members.iter().map(|k| of(&all[*k])).sum::<Vec2>() / count;
    GroupSeen {
        id: *id,
        traces: members.iter().map(|k| all[*k].trace).collect(),
        position: mean(|one| one.sighting.position),
        velocity: mean(|one| one.sighting.velocity),
    }
}
