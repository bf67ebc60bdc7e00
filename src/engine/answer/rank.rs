//! Results of rankings.

use super::{Answers, First, Running, Sampling, Turn, unit, was_cut};
use super::{every, method, tables, words};
use crate::compile::study::{Ask, MeasureKind, RankOption};
use crate::engine::fault::Fault;
use crate::engine::outcome::{Certificate, Certified, Evidence, Kind, QueryResult};
use crate::engine::sampling::rank::{RankOutcome, RankSampling};
use crate::engine::sampling::tally::Tally;
use crate::engine::sampling::watch::Forecast;
use crate::engine::trials::executor::Executor;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness;
use crate::model::Move;
use crate::stats::Coverage;
use crate::trials::budget::Budget;
impl<'q> Sampling<'q> for RankSampling<'q> {
    fn pilot(&mut self, executor: &dyn Executor, budget: &Budget) -> Result<Vec<Forecast>, Fault> {
        Ok(vec![self.run_pilot(executor, budget)?])
    }

    fn is_unread(&self) -> bool {
        self.tallies.iter().all(|tally| tally.counts.trials == 0)
    }

    fn run(&mut self, answers: &Answers<'_>, running: Running<'_>) -> Result<Turn<'q>, Fault> {
        let Running { executor, share, watch, .. } = running;
        let Some(ranked) = self.sample(executor, (answers.budget, share), watch)? else {
            return Ok(Turn::Paused);
        };
        Ok(Turn::Over(vec![(self.place, answers.rank(self, ranked)?)], None))
    }
}

/// The doing of an agent that is advised to stop.
fn means(prepared: &PreparedWorld, advice: Option<(usize, usize)>) -> Option<String> {
    let scenario = &prepared.program.scenario;
    let moves = scenario.moves.get(advice?.0)?;
    let is_stop = moves.options.get(advice?.1).is_some_and(|(_, option)| *option == Move::Stop);
    let seconds = scenario.clock.seconds(moves.duration);
    is_stop.then(|| format!("waits {seconds} s, then takes its own way"))
}

impl Answers<'_> {
    /// The result of a ranking that has stopped.
    fn rank(&self, rank: &RankSampling<'_>, ranked: RankOutcome) -> Result<QueryResult, Fault> {
        let query = rank.query();
        let Ask::Rank { options, measure, ranking, models } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let delta = ranking.value("delta");
        let setup = rank.setup();
        let mut result = self.blank(query, Kind::Rank);
        result.method = method::of(&query.ask, None);
        result.unit = unit(measure);
        result.stopped_by = ranked.stop;
        let joined = Tally::total(&ranked.tallies);
        result.replay = self.replay(query, "--total-trials", joined.counts.trials);
        Self::tell(&mut result, setup.worlds[0], &joined, measure.target.column);
        let tallies: Vec<_> = setup.worlds.iter().copied().zip(&ranked.tallies).collect();
        self.note_odd(&mut result, &tallies);
        // Of several values of a parameter the last one holds: that of the option.
        let settings = |arm: usize| [result.asked.settings.as_slice(), &options[arm].settings].concat();
        let lost = ranked.tallies.iter().enumerate().find_map(|(arm, tally)| {
            let item = setup.item(arm, tally.first[2]?);
            let column = options[arm].target.column;
            Some(First { prepared: setup.worlds[arm], column, item, settings: settings(arm) })
        });
        let models = *models;
        // Of several models that under which the choice did worst.
        let columns = ranked.choice.arm * models..(ranked.choice.arm + 1) * models;
        let value = |arm: &usize| ranked.values[*arm].0;
        let arm = columns.min_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default();
        let (own, prepared, column) = (settings(arm), setup.worlds[arm], options[arm].target.column);
        self.lament(&mut result, joined.counts.unresolved, lost.as_ref());
        let mut listed = tables::ranked(&ranked, options, models, query.every.as_ref());
        listed.means = listed.choice.is_some().then(|| means(prepared, options[arm].advice)).flatten();
        let score = words::measured(query, measure, joined.clipped);
        if let Some(choice) = &listed.choice {
            if listed.gap < ranked.scale {
                result.certifies = format!(
                    "{score} of `{choice}` is within {} of the best, error at most {}",
                    words::quantity(words::at_most(listed.gap), &result.unit),
                    words::error(delta)
                );
                let claim = Certified::Best { choice: choice.clone(), gap: listed.gap };
                result.certificate = Some(Certificate { claim, error: delta });
            }
            let chosen = &listed.options[0].value;
            result.estimate = Some(chosen.estimate);
            result.low = chosen.low;
            result.high = chosen.high;
            result.interval =
                format!("{}, all options jointly", words::interval(Coverage::TimeUniform, delta));
            let tally = &ranked.tallies[arm];
            let picks = match measure.kind {
                MeasureKind::Probability => witness::sides(tally),
                _ if was_cut(prepared, column, tally) => Vec::new(),
                _ => witness::extremes(tally),
            };
            let of = (column, options[arm].advice);
            result.witnesses = self.witnesses(&result, prepared, of, &picks, &own);
        }
        if let Some(every) = &query.every {
            result.every = every::of_ranking(every, &ranked, options, &listed);
        }
        result.rank = Some(listed);
        result.evidence = ranked.evidence.map(|snapshots| {
            let label = |option: &RankOption| match &query.every {
                Some(every) => {
                    let own = option.settings.iter().find(|(name, _)| *name == every.name);
                    format!("{}, {}", option.label, own.map_or("", |(_, value)| value))
                }
                None => option.label.clone(),
            };
            let labels = options.iter().map(label).collect();
            Evidence::Options { labels, snapshots }
        });
        result.elapsed_s = rank.spent;
        Ok(result)
    }
}
