//! Batches from a recording that the model names.

use super::{AdviseCommand, Caller};
use crate::advise::Walked;
use crate::base::geometry::Vec2;
use crate::cli::complaint;
use crate::cli::terminal::print_to_reader;
use crate::data::tracks::Batch;
use crate::library::Parsed;
use crate::replay::source;
use crate::report::advice;
use crate::syntax::diagnostic::Diagnostic;

/// The batches of the tracks of a name in a model.
pub(super) fn batches(
    parsed: &Parsed,
    name: &str,
    arguments: &AdviseCommand,
) -> Result<Vec<Batch>, Diagnostic> {
    let file = source(&parsed.scenario, &parsed.files, name)?;
    let found = file.format.read_batches(file.bytes, &file.reading, arguments.velocity());
    let batches = found.map_err(|errors| {
        let first = errors.first().map_or(String::new(), ToString::to_string);
        error!(E0702, file.place, "the recording cannot be read").label(first)
    })?;
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
    fn at(&mut self, cycle: &[Batch], user: u32, position: Vec2) {
        self.points.push((cycle[0].time, position));
        let others = cycle.iter().flat_map(|batch| &batch.seen).filter(|one| one.id != Some(user));
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

/// Replays batches; those before the first time only continue traces.
pub(super) fn run(caller: &mut Caller<'_>, batches: &[Batch]) -> Result<(), Vec<Diagnostic>> {
    let arguments = caller.arguments;
    let user = caller.adviser.user();
    if !batches.iter().flat_map(|batch| &batch.seen).any(|one| one.id == Some(user)) {
        let said = format!("person {user} is not in the recording");
        return Err(complaint::argument(said, "choose another `--user`").into());
    }
    let from = arguments.from.unwrap_or(f64::NEG_INFINITY) - 1e-6;
    let to = arguments.to.unwrap_or(f64::INFINITY) + 1e-6;
    let mut notes = Vec::new();
    let (mut advised, mut recorded) = (Way::default(), Way::default());
    let mut before: Option<f64> = None;
    let cycles = batches.chunk_by(|a, b| a.time == b.time);
    for cycle in cycles.take_while(|cycle| cycle[0].time <= to) {
        let batch = &cycle[0];
        let mut shown = cycle.to_vec();
        if arguments.anonymous {
            let all = shown.iter_mut().flat_map(|batch| &mut batch.seen);
            all.filter(|one| one.id != Some(user)).for_each(|one| one.id = None);
        }
        if batch.time < from {
            let _ = caller.adviser.watch(&shown);
            continue;
        }
        let own = cycle
            .iter()
            .flat_map(|batch| &batch.seen)
            .find(|one| one.id == Some(user))
            .map(|one| one.position);
        if let (true, Some(own)) = (arguments.follow, own) {
            let walked = before.and_then(|before| caller.adviser.walked(batch.time - before));
            let pace = recorded.points.last().map(|(time, last)| (own - last).norm() / (batch.time - time));
            let place = walked.map_or(own, |(place, _)| place);
            // Whoever is jostled does not walk faster from then on: the pace is the recorded one.
            let velocity = walked.zip(pace).map(|((_, velocity), pace)| {
                let speed = velocity.norm();
                if speed > 0.0 { velocity * (pace / speed) } else { velocity }
            });
            let all = shown.iter_mut().flat_map(|batch| &mut batch.seen);
            for one in all.filter(|one| one.id == Some(user)) {
                one.position = place;
                one.velocity = velocity.or(one.velocity);
            }
            advised.at(cycle, user, place);
            recorded.at(cycle, user, own);
        }
        if arguments.report.is_some() {
            caller.shown.batches.extend_from_slice(cycle);
        }
        before = Some(batch.time);
        if !caller.answer(&shown, &mut notes)? {
            return Ok(());
        }
    }
    if arguments.follow {
        let [as_advised, as_recorded] = [advised.walked(), recorded.walked()];
        let line = advice::end(&as_advised, &as_recorded);
        caller.shown.end = Some([as_advised, as_recorded]);
        caller.shown.followed = advised.points;
        print_to_reader(&line)?;
    }
    Ok(())
}
