//! Results of comparisons.

use super::{Answers, First, MAX_TRIALS, Sampling, Turn, between, says_something, unit};
use super::{method, tables, words};
use crate::compile::study::Ask;
use crate::engine::fault::Fault;
use crate::engine::outcome::{Kind, QueryResult};
use crate::engine::sampling::compare::{CompareSampling, Gap};
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::tally::Tally;
use crate::trials::cell::Item;
impl<'q> Sampling<'q> for CompareSampling<'q> {
    fn run(&mut self, answers: &Answers<'_>, resources: Resources<'_>) -> Result<Turn<'q>, Fault> {
        let Some(gap) = self.sample(resources)? else { return Ok(Turn::Paused) };
        Ok(Turn::Over(vec![(self.place, answers.compare(self, gap)?)], None))
    }
}

impl Answers<'_> {
    /// The result of a comparison that has stopped.
    fn compare(&self, compare: &CompareSampling<'_>, gap: Gap) -> Result<QueryResult, Fault> {
        let query = compare.query;
        let Ask::Compare { first, second, settings, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let [first_job, second_job] = &compare.jobs;
        let worlds = [first_job.prepared, second_job.prepared];
        let prepared = worlds[0];
        let mut result = self.blank(query, Kind::Compare);
        let unit = unit(first);
        result.method = method::of(&query.ask, None);
        if gap.pairs > 0 {
            let known = |side: &Tally| side.counts.trials > side.counts.unresolved;
            result.estimate = gap.sides.iter().all(known).then_some(gap.estimate);
            result.low = gap.interval.low;
            result.high = gap.interval.high;
            result.interval = words::interval(gap.interval.coverage, gap.interval.error);
        }
        result.stopped_by = gap.stop;
        result.replay = self.replay(query, MAX_TRIALS, gap.pairs);
        let joined = Tally::total(&gap.sides);
        Self::tell(&mut result, prepared, &joined, first.target.column);
        self.note_odd(&mut result, &[(worlds[0], &gap.sides[0]), (worlds[1], &gap.sides[1])]);
        let lost = (0..2).find_map(|side| {
            let index = gap.sides[side].first[2]?;
            let settings = result.asked.settings.iter().chain(&settings[side]).cloned().collect();
            let (prepared, column) = (worlds[side], [first, second][side].target.column);
            Some(First { prepared, column, item: Item { advice: None, index }, settings })
        });
        self.lament(&mut result, joined.counts.unresolved, lost.as_ref());
        let labels = [words::settings(&settings[0]), words::settings(&settings[1])];
        let name = words::measured(query, first, joined.clipped);
        if says_something(&query.ask, f64::NEG_INFINITY, (result.low, result.high)) {
            result.certifies = format!(
                "{name} under {} less that under {} in {}, error at most {}",
                labels[0],
                labels[1],
                words::ends(result.low, result.high, &unit),
                words::error(*delta)
            );
            result.certificate = Some(between(&result, *delta));
        }
        result.unit = unit;
        result.compare = Some(tables::sides(&gap, &labels, *delta));
        result.evidence = gap.evidence;
        result.elapsed_s = compare.spent;
        Ok(result)
    }
}
