//! Rankings: which option of some moves has the best score, with a joint guarantee.
//!
//! All options share the random numbers of a trial (common random numbers): the option is not part of the
//! address of a draw. Given-Wilson et al. 2017, Algorithm 1, is `by okamoto`.

use super::budget::Budget;
use super::cell::{Item, Reading};
use super::executor::{Executor, Job};
use super::fault::Fault;
use super::outcome::Stop;
use super::procedure::{outcome, value};
use super::subject::Subject;
use super::tally::Tally;
use super::watch::Watch;
use crate::compile::study::{MeasureKind, Ranking};
use crate::stats::ranking::{Allocation, Booleans, Choice, Each, Race, Scores, Share};
use crate::stats::{self, Mean, Outcome};

/// Trials an option gets in a round: traces of crowds are slow.
const WORD: u64 = 32;

/// The procedure of a ranking.
#[allow(clippy::large_enum_variant, reason = "there is one at a time")]
enum Procedure {
    Booleans(Race<Booleans>),
    Scores { race: Race<Scores>, range: (f64, f64) },
    Each(Each),
}

/// A ranking that has stopped.
pub(super) struct Podium {
    /// What each option consumed.
    pub(super) tallies: Vec<Tally>,
    /// Estimate and interval of each option, jointly valid at all times.
    pub(super) values: Vec<(f64, stats::Interval)>,
    /// The choice.
    pub(super) choice: Choice,
    /// Options not dropped.
    pub(super) live: Vec<usize>,
    /// Whether the ranking is certified.
    pub(super) finished: bool,
    /// Why it stopped.
    pub(super) stop: Stop,
    /// The largest gap that there can be: 1 for probabilities, the range for metrics.
    pub(super) scale: f64,
}

/// What is ranked.
pub(super) struct Field<'s> {
    /// The subject.
    pub(super) subject: &'s Subject,
    /// Index of the moves declaration.
    pub(super) moves: usize,
    /// Departure of each option from the direct way.
    pub(super) deviations: Vec<f64>,
    /// Column of the score.
    pub(super) column: usize,
    /// Kind of the score.
    pub(super) kind: MeasureKind,
    /// Loss that does not matter, error, procedure.
    pub(super) rule: (f64, f64, Ranking),
}

impl Procedure {
    fn new(field: &Field<'_>) -> Result<Self, Fault> {
        let (epsilon, delta, ranking) = field.rule;
        let arms = field.deviations.len();
        let allocation = if ranking == Ranking::OneChallenger {
            Allocation::OneChallenger
        } else {
            Allocation::AllFailing
        };
        match (&field.kind, ranking) {
            (MeasureKind::Probability, Ranking::Okamoto) => {
                Ok(Self::Each(Each::new(arms, epsilon, delta, 8 * WORD)?))
            }
            (MeasureKind::Probability, _) => {
                Ok(Self::Booleans(Race::new(arms, epsilon, delta, WORD, allocation)?))
            }
            (MeasureKind::Expectation { .. }, Ranking::Okamoto) | (MeasureKind::Quantile { .. }, _) => {
                Err(Fault::Unsuitable)
            }
            (MeasureKind::Expectation { range, .. }, _) => {
                let scaled = epsilon / (range.1 - range.0);
                Ok(Self::Scores { race: Race::new(arms, scaled, delta, WORD, allocation)?, range: *range })
            }
        }
    }

    fn next_round(&self) -> Vec<Share> {
        match self {
            Self::Booleans(race) => race.next_round().to_vec(),
            Self::Scores { race, .. } => race.next_round().to_vec(),
            Self::Each(each) => each.next_round().to_vec(),
        }
    }

    fn finished(&self) -> bool {
        match self {
            Self::Booleans(race) => race.finished(),
            Self::Scores { race, .. } => race.finished(),
            Self::Each(each) => each.finished(),
        }
    }

    fn choice(&mut self, deviations: &[f64]) -> Choice {
        match self {
            Self::Booleans(race) => race.choice(Some(deviations)),
            Self::Scores { race, .. } => race.choice(Some(deviations)),
            Self::Each(each) => each.choice(Some(deviations)),
        }
    }

    fn live(&self, arms: usize) -> Vec<usize> {
        match self {
            Self::Booleans(race) => race.live().to_vec(),
            Self::Scores { race, .. } => race.live().to_vec(),
            Self::Each(_) => (0..arms).collect(),
        }
    }

    fn feed(&mut self, arm: usize, cells: &[super::cell::Cell]) -> Result<(), Fault> {
        match self {
            Self::Booleans(race) => race.feed(arm, &cells.iter().map(outcome).collect::<Vec<Outcome>>())?,
            Self::Each(each) => each.feed(arm, &cells.iter().map(outcome).collect::<Vec<Outcome>>())?,
            Self::Scores { race, range } => {
                let scores: Vec<Option<f64>> =
                    cells.iter().map(|c| value(c).map(|v| (v - range.0) / (range.1 - range.0))).collect();
                race.feed(arm, &scores)?;
            }
        }
        Ok(())
    }
}

/// Runs a ranking.
pub(super) fn run(
    field: &Field<'_>,
    text: &str,
    seed: u64,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<Podium, Fault> {
    let arms = field.deviations.len();
    let mut procedure = Procedure::new(field)?;
    let range = match &field.kind {
        MeasureKind::Expectation { range, .. } => Some(*range),
        _ => None,
    };
    // Each option's interval is one of as many that hold jointly.
    let delta = field.rule.1 / arms as f64;
    let mut means: Vec<Mean> = match range {
        Some((low, high)) => (0..arms)
            .map(|_| Mean::fixed(low, high, super::budget::DEFAULT_TRIALS, delta))
            .collect::<Result<_, _>>()?,
        None => Vec::new(),
    };
    let job = Job::new(field.subject, vec![field.column], seed);
    let mut tallies = vec![Tally::default(); arms];
    let stop = 'sampling: loop {
        let shares = procedure.next_round();
        if shares.is_empty() || procedure.finished() {
            break if matches!(procedure, Procedure::Each(_)) { Stop::Plan } else { Stop::Width };
        }
        let halt = || if budget.is_interrupted() { Stop::Interrupt } else { Stop::Deadline };
        if budget.must_stop() {
            break halt();
        }
        if shares.iter().any(|share| share.to > budget.max_trials) {
            break Stop::Cap;
        }
        // All options advance side by side, so that a deadline finds every one of them as far as the others.
        let most = shares.iter().map(|share| share.to - share.from).max().unwrap_or(0);
        let mut items: Vec<Item> = Vec::new();
        let mut places: Vec<Vec<usize>> = vec![Vec::new(); shares.len()];
        for step in 0..most {
            for (share, places) in shares.iter().zip(&mut places) {
                if share.from + step < share.to {
                    places.push(items.len());
                    items.push(Item { advice: Some((field.moves, share.arm)), index: share.from + step });
                }
            }
        }
        let consumed: u64 = tallies.iter().map(|t| t.counts.trials).sum();
        let left = budget.max_total.map_or(u64::MAX, |total| total.saturating_sub(consumed));
        if left == 0 {
            break Stop::Cap;
        }
        let wanted = items.len();
        items.truncate(left as usize);
        let rows = executor.run(&job, &items, budget)?;
        // What follows an unfinished trial is not looked at, so that the number of trials says which they are.
        let prefix = (0..items.len()).take_while(|place| rows.row(*place).is_some()).count();
        let mut complete = true;
        for (share, places) in shares.iter().zip(&places) {
            let mut cells = Vec::with_capacity(places.len());
            let mut broken = false;
            for &place in places {
                match rows.row(place).filter(|_| place < prefix) {
                    Some(row) if !broken => {
                        if row[0].reading == Reading::Faulty {
                            return Err(super::trial::fault(field.subject, items[place], seed));
                        }
                        tallies[share.arm].add(items[place].index, &row[0], range);
                        if let Some(mean) = means.get_mut(share.arm) {
                            mean.observe(value(&row[0]));
                        }
                        cells.push(row[0]);
                    }
                    _ => broken = true,
                }
            }
            complete &= !broken;
            procedure.feed(share.arm, &cells)?;
        }
        if !complete {
            let capped = prefix == items.len() && items.len() < wanted;
            break 'sampling if capped { Stop::Cap } else { halt() };
        }
        watch.consumed(text, tallies.iter().map(|t| t.counts.trials).sum(), None);
    };
    let choice = procedure.choice(&field.deviations);
    let values = (0..arms)
        .map(|arm| match means.get(arm) {
            Some(mean) => {
                let (low, high) = mean.estimate();
                (0.5 * (low + high), mean.interval())
            }
            None => {
                let counts = tallies[arm].counts;
                let reading = |successes: u64| {
                    let read = stats::Counts { successes, failures: counts.trials - successes };
                    stats::sequence::interval(read, delta)
                };
                let hull = reading(counts.successes).hull(reading(counts.successes + counts.unresolved));
                (super::procedure::share(counts), hull)
            }
        })
        .collect();
    Ok(Podium {
        tallies,
        values,
        live: procedure.live(arms),
        finished: procedure.finished(),
        choice,
        stop,
        scale: range.map_or(1.0, |(low, high)| high - low),
    })
}
