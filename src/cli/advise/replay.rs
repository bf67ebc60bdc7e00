//! Batches from a recording that the model names.

use super::{AdviseCommand, Caller};
use crate::advise::{Status, Walked};
use crate::base::geometry::Vec2;
use crate::cli::complaint;
use crate::cli::terminal::print_to_reader;
use crate::data::tracks::Batch;
use crate::library::Parsed;
use crate::replay::source;
use crate::report::advice;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::{BTreeMap, BTreeSet};

/// Who walks with somebody is nearer than this, m.
const NEAR: f64 = 1.5;

/// The batches of the tracks of a name in a model.
pub(super) fn batches(
    parsed: &Parsed,
    name: &str,
    arguments: &AdviseCommand,
) -> Result<Vec<Batch>, Diagnostic> {
    let file = source(&parsed.scenario, &parsed.files, name)?;
    let batches = file.batches(arguments.velocity())?;
    let first = batches.first().map_or(0.0, |batch| batch.time);
    let last = batches.last().map_or(0.0, |batch| batch.time);
    let is_reversed = arguments.from.zip(arguments.to).is_some_and(|(from, to)| from > to);
    if is_reversed
        || arguments.from.is_some_and(|from| from > last)
        || arguments.to.is_some_and(|to| to < first)
    {
        let said = format!("the recording `{name}` has nothing between these times");
        return Err(complaint::argument(said, format!("it lasts from {first} s to {last} s")));
    }
    Ok(batches)
}

/// What somebody has done by the end.
#[derive(Clone, Debug, Default)]
struct Way {
    points: Vec<(f64, Vec2)>,
    /// Least distance to anybody else, m.
    least: Option<f64>,
}

impl Way {
    /// The user, and the company who does not count, at a place.
    fn at(&mut self, cycle: &[Batch], (user, company): (u32, &BTreeSet<u32>), position: Vec2) {
        self.points.push((cycle[0].time, position));
        let others = cycle.iter().flat_map(|batch| &batch.seen);
        let others = others.filter(|one| one.id.is_none_or(|id| id != user && !company.contains(&id)));
        let distances = others.map(|one| (one.position - position).norm());
        self.least = distances.chain(self.least).reduce(|a, b| if b < a { b } else { a });
    }

    fn walked(&self) -> Walked {
        let length = self.points.windows(2).map(|pair| (pair[1].1 - pair[0].1).norm()).sum();
        let time =
            self.points.last().map_or(0.0, |last| last.0) - self.points.first().map_or(0.0, |first| first.0);
        Walked { least_distance: self.least, time, length }
    }
}

/// What a replay with a user who follows the advice gave.
pub(super) struct Followed {
    /// What the user did as advised, and as recorded.
    pub(super) walked: [Walked; 2],
    /// Cycles, those with a move, those of which it is known whether the user moved as advised, and those in which that was so.
    pub(super) cycles: [u64; 4],
}

/// Where a person was in batches.
pub(super) fn places(batches: &[Batch], user: u32) -> Vec<(f64, Vec2)> {
    let mut found: Vec<(f64, Vec2)> = Vec::new();
    for batch in batches {
        for one in batch.seen.iter().filter(|one| one.id == Some(user)) {
            // Several sensors may see somebody at one time.
            if found.last().is_none_or(|(time, _)| *time < batch.time) {
                found.push((batch.time, one.position));
            }
        }
    }
    found
}

/// Who walked with a person, as recorded: nearer than 1.5 m in most of the instants.
fn company(batches: &[Batch], own: &[(f64, Vec2)]) -> BTreeSet<u32> {
    let mut near: BTreeMap<u32, usize> = BTreeMap::new();
    let mut instants = own.iter().peekable();
    for batch in batches {
        while instants.next_if(|(time, _)| *time < batch.time).is_some() {}
        let Some((_, place)) = instants.peek().filter(|(time, _)| *time == batch.time) else { continue };
        for id in
            batch.seen.iter().filter(|one| (one.position - place).norm() < NEAR).filter_map(|one| one.id)
        {
            *near.entry(id).or_default() += 1;
        }
    }
    near.into_iter().filter(|(_, count)| 2 * count > own.len()).map(|(id, _)| id).collect()
}

/// Replays batches; those before the first time only continue traces. With `is_told`, a line for each cycle is written.
pub(super) fn run(
    caller: &mut Caller<'_>,
    batches: &[Batch],
    (from, to): (f64, f64),
    is_told: bool,
) -> Result<Followed, Vec<Diagnostic>> {
    let arguments = caller.arguments;
    let user = caller.adviser.user();
    let own = places(batches, user);
    if own.is_empty() {
        let said = format!("person {user} is not in the recording");
        return Err(complaint::argument(said, "choose another `--user`").into());
    }
    let company = company(batches, &own);
    let mut notes = Vec::new();
    let (mut advised, mut recorded) = (Way::default(), Way::default());
    let mut counted = [0; 4];
    let mut before: Option<f64> = None;
    let cycles = batches.chunk_by(|a, b| a.time == b.time);
    for cycle in cycles.take_while(|cycle| cycle[0].time <= to + 1e-6) {
        let batch = &cycle[0];
        let mut shown = cycle.to_vec();
        if arguments.anonymous {
            let all = shown.iter_mut().flat_map(|batch| &mut batch.seen);
            all.filter(|one| one.id != Some(user)).for_each(|one| one.id = None);
        }
        if batch.time < from - 1e-6 {
            let _ = caller.adviser.watch(&shown);
            continue;
        }
        let now = own.iter().position(|(time, _)| *time == batch.time);
        if let (true, Some(now)) = (arguments.follow, now) {
            let walked = before.and_then(|before| caller.adviser.walked(batch.time - before));
            let here = own[now].1;
            let pace = recorded.points.last().map(|(time, last)| (here - last).norm() / (batch.time - time));
            let place = walked.map_or(here, |(place, _)| place);
            // Whoever is jostled does not walk faster from then on: the pace is the recorded one. Who has just come knows the
            // own velocity.
            let next = own.get(now + 1).map(|(time, next)| (next - here) / (time - batch.time));
            let velocity = walked.zip(pace).map(|((_, velocity), pace)| {
                let speed = velocity.norm();
                if speed > 0.0 { velocity * (pace / speed) } else { velocity }
            });
            let velocity = velocity.or(next.filter(|_| before.is_none()));
            let all = shown.iter_mut().flat_map(|batch| &mut batch.seen);
            for one in all.filter(|one| one.id == Some(user)) {
                one.position = place;
                one.velocity = velocity.or(one.velocity);
            }
            advised.at(cycle, (user, &company), place);
            recorded.at(cycle, (user, &company), here);
        }
        if arguments.report.is_some() {
            caller.shown.batches.extend_from_slice(cycle);
        }
        before = Some(batch.time);
        let (found, used) = caller.ask(&shown, &mut notes)?;
        let is_move = found.status == Status::Advice;
        let is = [true, is_move, found.followed.is_some(), found.followed == Some(true)];
        counted.iter_mut().zip(is).for_each(|(count, is)| *count += u64::from(is));
        if is_told && !caller.tell(found, used)? {
            break;
        }
    }
    let walked = [advised.walked(), recorded.walked()];
    if arguments.follow && is_told {
        let line = advice::end(&walked[0], &walked[1]);
        caller.shown.end = Some(walked);
        caller.shown.followed = advised.points;
        print_to_reader(&line)?;
    }
    Ok(Followed { walked, cycles: counted })
}
