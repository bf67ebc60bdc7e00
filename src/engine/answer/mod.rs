//! Answers: what a procedure has found, put into words and numbers.

mod compare;
mod estimate;
pub(in crate::engine) mod every;
pub(in crate::engine) mod method;
mod rank;
mod splitting;
mod tables;
pub(in crate::engine) mod words;

use crate::base::random::TrialKey;
use crate::compile::study::{Ask, Measure, MeasureKind, Query};
use crate::engine::call::Call;
use crate::engine::fault::Fault;
use crate::engine::outcome::{AskedQuery, Certificate, Certified, Counts, Kind, QueryResult, Shows, Witness};
use crate::engine::sampling::pilot::Piloted;
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::tally::Tally;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::witness::{self, Inspected, cause};
use crate::logic::{Root, Sought};
use crate::trials::budget::{Budget, DEFAULT_TRIALS};
use crate::trials::cell::Item;

/// The option that ends queries after so many trials.
const MAX_TRIALS: &str = "--max-trials";

fn unit(measure: &Measure) -> String {
    unit_of(&measure.kind)
}

fn unit_of(kind: &MeasureKind) -> String {
    match kind {
        MeasureKind::Probability | MeasureKind::Curve { .. } => String::new(),
        MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. } => {
            dimension.to_string()
        }
    }
}

/// The interval of a result as what it certifies.
fn between(result: &QueryResult, error: f64) -> Certificate {
    Certificate { claim: Certified::Between { low: result.low, high: result.high }, error }
}

/// Results by the places of their queries.
pub(in crate::engine) type Answered = Vec<(usize, QueryResult)>;

/// What came of a turn.
pub(in crate::engine) enum Turn<'q> {
    /// The results, and what was wrong with the model, if a trial showed that it is.
    Over(Answered, Option<Fault>),
    /// It goes on when the others had their turn.
    Paused,
    /// Some of the queries hold the others up: they go on by themselves, after these.
    Apart(Box<dyn Sampling<'q> + 'q>),
}

/// Queries that are answered together, on their way.
pub(in crate::engine) trait Sampling<'q>: Piloted {
    /// Runs for a share of the time.
    fn run(&mut self, answers: &Answers<'_>, resources: Resources<'_>) -> Result<Turn<'q>, Fault>;

    /// The results of those that have stopped; the others are left out.
    fn decided(&mut self, _: &Answers<'_>) -> Result<Answered, Fault> {
        Ok(Vec::new())
    }
}

/// The first of the unresolved trials of a result.
pub(in crate::engine) struct First<'s> {
    /// Where it was run.
    pub(in crate::engine) prepared: &'s PreparedWorld,
    /// What was asked of it.
    pub(in crate::engine) column: usize,
    /// The trial.
    pub(in crate::engine) item: Item,
    /// Values of swept and `under` parameters.
    pub(in crate::engine) settings: Vec<(String, String)>,
}

/// Puts what was found into results.
pub(in crate::engine) struct Answers<'a> {
    /// What the command line said.
    pub(in crate::engine) call: &'a Call<'a>,
    /// The budget, for its clock.
    pub(in crate::engine) budget: &'a Budget,
}

impl Answers<'_> {
    /// What is known of a query before its first trial.
    fn blank(&self, query: &Query, kind: Kind) -> QueryResult {
        let (file, line) = (self.call.place)(query.span);
        let (low, high) = legal(&query.ask);
        let asked = AskedQuery {
            name: query.name.clone(),
            file,
            line,
            settings: query.settings.clone(),
            horizon: query.horizon.clone(),
            given: query.given.clone(),
            ..AskedQuery::new(query.index, kind, query.text.clone())
        };
        QueryResult { low, high, ..QueryResult::new(asked) }
    }

    /// The call that stops at the same trial; `limit` is the option that counts them.
    fn replay(&self, query: &Query, limit: &str, trials: u64) -> String {
        let line = &self.call.line;
        let mut words = if query.point.is_empty() { line.check() } else { line.check_at(&query.point) };
        // In a ranking of which a round was cut, how many trials there are in all does not tell which.
        if limit != MAX_TRIALS && self.budget.max_trials != DEFAULT_TRIALS {
            words.push_str(&format!(" {MAX_TRIALS} {}", self.budget.max_trials));
        }
        format!("{words} --only {} --seed {} {limit} {trials}", query.index, self.call.seed)
    }

    /// The witnesses of a column of a world, in which perhaps somebody was advised.
    fn witnesses(&self, of: Inspected<'_>, picks: &[(Shows, u64)]) -> Vec<Witness> {
        let picks = if self.call.explains { picks } else { &[] };
        let calls = (self.call, self.budget);
        picks.iter().filter_map(|pick| witness::witness(of, *pick, calls)).collect()
    }

    /// Counts, and what they warn of.
    fn tell(result: &mut QueryResult, prepared: &PreparedWorld, tally: &Tally, column: usize) {
        result.consumed = tally.consumed();
        let Ok(implications) = prepared.implications(column) else { return };
        // Of a trial that is not resolved nobody knows what the rest of it would have been.
        let resolved = tally.counts.trials - tally.counts.unresolved;
        let trials = match (resolved, tally.counts.unresolved) {
            (0, _) => return,
            (_, 0) => format!("{resolved} trials"),
            _ => format!("{resolved} resolved trials"),
        };
        // The 64th stands for all beyond: of those none was triggered, or perhaps all were.
        let idle = |implied: bool| {
            let some = implications.iter().enumerate().filter(|(_, one)| **one == implied);
            let all: Vec<usize> = some.map(|(k, _)| k.min(63)).collect();
            (all.iter().filter(|k| tally.triggered >> **k & 1 == 0).count(), all.len())
        };
        match idle(false) {
            (0, _) => {}
            (1, 1) => result.warnings.push(format!(
                "the implication was never triggered: its left side was true in none of {trials}"
            )),
            (idle, all) => result.warnings.push(format!(
                "{idle} of {all} implications were never triggered: their left sides were true in none of {trials}"
            )),
        }
        if let (idle, all @ 1..) = idle(true)
            && idle == all
        {
            result.warnings.push(format!(
                "no agent was present in any state that the formula reads, in all of {trials}"
            ));
        }
    }

    /// Says which bodies were made smaller in the first trial in which any was, and who had no way in the first in which
    /// anybody had none.
    fn note_odd(&self, result: &mut QueryResult, tallies: &[(&PreparedWorld, &Tally)]) {
        let first = |of: &dyn Fn(&Tally) -> Option<u64>| {
            let mut found = tallies.iter().filter_map(|(prepared, tally)| Some((*prepared, of(tally)?)));
            found
                .next()
                .map(|(prepared, index)| (prepared, TrialKey { seed: self.call.seed, index, branch: 0 }))
        };
        if let Some((prepared, key)) = first(&|tally| tally.shrunk.first) {
            result.warnings.push(cause::smaller(&prepared.program, key, result.consumed.shrunk));
        }
        if let Some((prepared, key)) = first(&|tally| tally.no_way.first) {
            result.warnings.push(cause::stranded(&prepared.program, key, result.consumed.no_way));
        }
    }

    /// The same of a result of one world, in which nobody was advised.
    fn lament_one(&self, result: &mut QueryResult, prepared: &PreparedWorld, tally: &Tally, column: usize) {
        let settings = result.asked.settings.clone();
        let item = |index| Item { advice: None, index };
        let first = tally.first[2].map(|index| First { prepared, column, item: item(index), settings });
        self.lament(result, tally.counts.unresolved, first.as_ref());
    }

    /// Says how many trials are unresolved, why the first of them is, and how to look at it.
    fn lament(&self, result: &mut QueryResult, unresolved: u64, first: Option<&First<'_>>) {
        let counts = Counts { unresolved, ..result.consumed.counts };
        if unresolved == 0 {
            return;
        }
        let how_many = match (counts.trials, unresolved) {
            (1, _) => "the only trial is unresolved".to_owned(),
            (all, some) if all == some => {
                format!("all {all} trials are unresolved, so there is no result")
            }
            (all, 1) => format!("1 of {all} trials is unresolved"),
            (all, some) => format!("{some} of {all} trials are unresolved"),
        };
        let shown = first.map_or(String::new(), |first| {
            let why =
                cause::unresolved(first.prepared, first.column, first.item, (self.call.seed, self.budget));
            let command = witness::command(self.call, first.prepared, &first.settings, first.item);
            let why = if why.is_empty() { why } else { format!("{why}; ") };
            format!("; trial {}: {why}see {command}", first.item.index)
        });
        result.warnings.push(format!("{how_many}{shown}"));
    }
}

/// Whether trials ended where a robustness left its range: of those no more is known than that.
fn was_cut(prepared: &PreparedWorld, column: usize, tally: &Tally) -> bool {
    tally.clipped > 0 && matches!(prepared.columns[column], Root::Robustness(_, Sought::Clipped(..)))
}

/// What a number can be: between 0 and 1, or in the declared range.
fn legal(ask: &Ask) -> (f64, f64) {
    let of = |measure: &Measure| match measure.kind {
        MeasureKind::Probability | MeasureKind::Curve { .. } => (0.0, 1.0),
        MeasureKind::Expectation { range, .. } => range,
        MeasureKind::Quantile { .. } => (f64::NEG_INFINITY, f64::INFINITY),
    };
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } | Ask::Rank { measure, .. } => of(measure),
        Ask::Compare { first, .. } => {
            let (low, high) = of(first);
            (low - high, high - low)
        }
    }
}

/// Whether an interval excludes anything that can be; nothing is below `least`.
fn says_something(ask: &Ask, least: f64, (low, high): (f64, f64)) -> bool {
    let (lowest, most) = legal(ask);
    low > lowest.max(least) || high < most
}
