//! Results of rankings.

use super::{Answers, First, Sampling, Turn, unit, unit_of, was_cut};
use super::{every, method, tables, words};
use crate::compile::study::{Ask, Beside, Measure, MeasureKind, Query, RankOption, Role};
use crate::engine::fault::Fault;
use crate::engine::outcome::{Certificate, Certified, Evidence, Kind, QueryResult, Ranking, Status};
use crate::engine::sampling::rank::{RankOutcome, RankSampling};
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::tally::Tally;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::{self, Inspected};
use crate::model::Move;
use crate::stats::Coverage;
impl<'q> Sampling<'q> for RankSampling<'q> {
    fn run(&mut self, answers: &Answers<'_>, resources: Resources<'_>) -> Result<Turn<'q>, Fault> {
        let Some(ranked) = self.sample(resources)? else { return Ok(Turn::Paused) };
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

/// `P(b) >= 0.9, E(c) <= 3 s`
fn constraints(beside: &[Beside]) -> String {
    let said = |one: &Beside| match &one.role {
        Role::Constraint { text, .. } => Some(format!("{} {text}", one.said)),
        Role::Aim { .. } => None,
    };
    beside.iter().filter_map(said).collect::<Vec<_>>().join(" and ")
}

/// The options of a front.
fn labels(listed: &Ranking) -> impl Iterator<Item = &str> {
    let front = listed.options.iter().filter(|option| option.status == Status::Front);
    front.map(|option| option.label.as_str())
}

/// What a finished front certifies.
fn front(
    query: &Query,
    (measure, epsilon): (&Measure, f64),
    beside: &[Beside],
    listed: &Ranking,
    delta: f64,
) -> String {
    let mut aims = vec![format!("{} by {}", query.said.measure, words::quantity(epsilon, &unit(measure)))];
    aims.extend(beside.iter().filter_map(|one| match one.role {
        Role::Aim { epsilon } => {
            Some(format!("{} by {}", one.said, words::quantity(epsilon, &unit_of(&one.kind))))
        }
        Role::Constraint { .. } => None,
    }));
    let names: Vec<String> = labels(listed).map(|label| format!("`{label}`")).collect();
    let (names, aims, error) = (names.join(", "), aims.join(" or "), words::error(delta));
    let others = "each other option exceeds one of these in no aim by as much";
    format!(
        "none exceeds {names} in {aims} unless it is worse in another aim; {others}, error at most {error}"
    )
}

impl Answers<'_> {
    /// The result of a ranking that has stopped.
    fn rank(&self, rank: &RankSampling<'_>, ranked: RankOutcome) -> Result<QueryResult, Fault> {
        let (query, setup) = (rank.query, &rank.setup);
        let Ask::Rank { options, measure, ranking, models, beside } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let delta = ranking.value("delta");
        let is_front = beside.iter().any(|one| matches!(one.role, Role::Aim { .. }));
        let mut result = self.blank(query, if is_front { Kind::Pareto } else { Kind::Rank });
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
        let mut listed = tables::ranked(&ranked, options, (models, query.every.as_ref()), beside);
        listed.aim.clone_from(&query.said.measure);
        listed.means = listed.choice.is_some().then(|| means(prepared, options[arm].advice)).flatten();
        let score = words::measured(query, measure, joined.clipped);
        if let Some(choice) = &listed.choice {
            if listed.gap < ranked.scale {
                let among = constraints(beside);
                let among = if among.is_empty() { among } else { format!(" of those with {among}") };
                result.certifies = format!(
                    "{score} of `{choice}` is within {} of the best{among}, error at most {}",
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
            let (advice, settings, unit) = (options[arm].advice, &own[..], &result.unit[..]);
            let of = Inspected { prepared, column, advice, settings, unit };
            result.witnesses = self.witnesses(of, &picks);
        }
        if listed.is_empty {
            let said = constraints(beside);
            result.certifies = format!("no option satisfies {said}, error at most {}", words::error(delta));
            result.certificate = Some(Certificate { claim: Certified::Nothing, error: delta });
        } else if is_front && ranked.finished {
            result.certifies = front(query, (measure, ranking.value("epsilon")), beside, &listed, delta);
            let options = labels(&listed).map(str::to_owned).collect();
            result.certificate = Some(Certificate { claim: Certified::Front { options }, error: delta });
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
