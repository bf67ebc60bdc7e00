//! Comparisons: one measure in two worlds, over pairs of trials with the same random numbers.

use crate::compile::methods;
use crate::compile::study::{MeasureKind, Query};
use crate::engine::fault::Fault;
use crate::engine::outcome::{Evidence, Interval, Snapshot, Stop, next_after};
use crate::engine::sampling::estimate::LARGEST_ROUND;
use crate::engine::sampling::forecast::{self, PilotStatistics};
use crate::engine::sampling::pilot::{Pilot, Piloted};
use crate::engine::sampling::procedure::{of_mean, outcome, value};
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::tally::Tally;
use crate::engine::sampling::watch::{Forecast, Likely};
use crate::engine::trials::executor::{Executor, Job};
use crate::engine::trials::prepared::PreparedWorld;
use crate::stats::{self, Bounded, Difference, Mean};
use crate::trials::budget::Budget;
use crate::trials::cell::{Cell, Item, Reading};

/// What is known of the difference.
enum Differences {
    /// Of probabilities.
    Probability(Difference),
    /// Of expectations: the mean of the differences, which lie in twice the range.
    Expectation(Mean),
    /// Of tails, which are no means of differences: the interval of each side has half of the error.
    Apart,
}

/// A comparison that has stopped.
pub(in crate::engine) struct Gap {
    /// What each side consumed.
    pub(in crate::engine) sides: [Tally; 2],
    /// The mean of each side, for expectations.
    pub(in crate::engine) means: Vec<Bounded>,
    /// Why it stopped.
    pub(in crate::engine) stop: Stop,
    /// Interval of first less second.
    pub(in crate::engine) interval: stats::Interval,
    /// The estimate of first less second.
    pub(in crate::engine) estimate: f64,
    /// Pairs in which only the first, only the second held.
    pub(in crate::engine) alone: (u64, u64),
    /// Pairs.
    pub(in crate::engine) pairs: u64,
    /// Pairs with an unresolved trial.
    pub(in crate::engine) unresolved: u64,
    /// How the evidence grew over the pairs, where that was asked for.
    pub(in crate::engine) evidence: Option<Evidence>,
}

/// Two sides of a comparison: prepared world and column of each.
pub(in crate::engine) struct Sides<'s> {
    /// The prepared worlds.
    pub(in crate::engine) worlds: [&'s PreparedWorld; 2],
    /// Their columns.
    pub(in crate::engine) columns: [usize; 2],
}

/// How many pairs the next round has: as in an estimate. With a deadline it takes no more than a tenth of the time that is
/// left, because nothing of a round counts until its second side runs.
fn round(consumed: u64, width: u64, seconds: f64, budget: &Budget) -> u64 {
    let least = 2 * width;
    let size = (consumed / 8).clamp(least, least.max(LARGEST_ROUND));
    let Some(left) = budget.seconds_left().filter(|_| consumed > 0) else { return size };
    let soon = 0.1 * left * consumed as f64 / seconds.max(1e-9);
    size.min(least.max(soon as u64))
}

/// The value of a cell within a range.
fn clipped(cell: &Cell, (low, high): (f64, f64)) -> Option<f64> {
    value(cell).map(|value| value.clamp(low, high))
}

/// A comparison on its way.
pub(in crate::engine) struct CompareSampling<'s> {
    /// Its place among the queries that are asked.
    pub(in crate::engine) place: usize,
    pub(in crate::engine) query: &'s Query,
    pub(in crate::engine) jobs: [Job<'s>; 2],
    procedure: Differences,
    range: Option<(f64, f64)>,
    within: Option<f64>,
    delta: f64,
    ahead: Option<[Pilot; 2]>,
    /// What each side consumed.
    pub(in crate::engine) tallies: [Tally; 2],
    /// The mean of each side, for expectations.
    means: Vec<Bounded>,
    /// What it has read so far, for forecasts.
    statistics: PilotStatistics,
    /// How its evidence grew; `None` where nobody asks.
    evidence: Option<Vec<Snapshot>>,
    /// Seconds that it has taken so far.
    pub(in crate::engine) spent: f64,
}

impl Piloted for CompareSampling<'_> {
    fn pilot(&mut self, executor: &dyn Executor, budget: &Budget) -> Result<Vec<Forecast>, Fault> {
        let size = Pilot::size(executor.width(&self.jobs[0]) as u64)
            .min(self.planned(budget))
            .min(budget.max_trials);
        let one = |job: &Job<'_>| Pilot::run(job, Item::run(0, size), executor, budget);
        let sides = [one(&self.jobs[0])?, one(&self.jobs[1])?];
        let mut statistics = PilotStatistics::default();
        for (a, b) in sides[0].seen().zip(sides[1].seen()) {
            if let (Some(a), Some(b)) = (self.score(&a[0]), self.score(&b[0])) {
                statistics.add(a - b);
            }
        }
        let seconds: f64 =
            (0..2).map(|side| sides[side].seconds_per_trial(self.jobs[side].prepared.most_steps())).sum();
        let pairs = self.likely(&statistics).map(|n| n.min(budget.max_trials));
        self.ahead = sides.iter().all(Pilot::is_complete).then_some(sides);
        self.spent = self.ahead.iter().flatten().map(|ahead| ahead.seconds).sum();
        let trials = pairs.map(|n| 2 * n);
        Ok(vec![Forecast { seconds: pairs.likely as f64 * seconds, ..Forecast::of(self.query, trials, 0.0) }])
    }

    fn is_unread(&self) -> bool {
        self.tallies[0].counts.trials == 0
    }
}

impl<'s> CompareSampling<'s> {
    /// A comparison of one kind of measure on two sides.
    pub(in crate::engine) fn new(
        (place, query): (usize, &'s Query),
        sides: &Sides<'s>,
        kind: &MeasureKind,
        (within, delta): (Option<f64>, f64),
        (seed, shows_evidence): (u64, bool),
    ) -> Result<Self, Fault> {
        let range = kind.range();
        let means = match range {
            Some(range) => [(); 2]
                .map(|()| match (within, kind.share()) {
                    (_, Some(share)) => Bounded::running(range, Some(share), 0.5 * delta),
                    (Some(_), None) => Bounded::running(range, None, delta),
                    (None, None) => Bounded::fixed(range, None, methods::PLANNED_TRIALS, delta),
                })
                .into_iter()
                .collect::<Result<_, _>>()?,
            None => Vec::new(),
        };
        let procedure = match range {
            None => Differences::Probability(Difference::new(delta, within)?),
            Some(_) if kind.share().is_some() => Differences::Apart,
            Some((low, high)) => {
                let width = high - low;
                Differences::Expectation(match within {
                    Some(within) => Mean::within(-width, width, within, delta)?,
                    None => Mean::fixed(-width, width, methods::PLANNED_TRIALS, delta)?,
                })
            }
        };
        let jobs = [0, 1].map(|side| Job::new(sides.worlds[side], vec![sides.columns[side]], seed));
        let (tallies, statistics, ahead, spent) = Default::default();
        let evidence = shows_evidence.then(Vec::new);
        Ok(Self {
            place,
            query,
            jobs,
            procedure,
            range,
            within,
            delta,
            ahead,
            tallies,
            means,
            statistics,
            evidence,
            spent,
        })
    }

    fn planned(&self, budget: &Budget) -> u64 {
        if self.within.is_none() { methods::PLANNED_TRIALS } else { budget.max_trials }
    }

    /// Pairs that it is likely to take; `statistics` is that of their differences.
    fn likely(&self, statistics: &PilotStatistics) -> Likely {
        let width = self.range.map_or(1.0, |(low, high)| high - low);
        match self.within {
            Some(within) => forecast::compare(statistics, width, within, self.delta),
            None => Likely::exactly(methods::PLANNED_TRIALS),
        }
    }

    /// What a cell counts for: 0 or 1, or the clipped value.
    fn score(&self, cell: &Cell) -> Option<f64> {
        match self.range {
            Some(range) => clipped(cell, range),
            None => match outcome(cell) {
                stats::Outcome::Unresolved => None,
                held => Some(f64::from(u8::from(held == stats::Outcome::True))),
            },
        }
    }

    /// Runs until the interval is narrow enough, or the pairs are spent; `None` if its share of the time is over before,
    /// and the time of the call is not.
    pub(in crate::engine) fn sample(&mut self, resources: Resources<'_>) -> Result<Option<Gap>, Fault> {
        let Resources { executor, budget, share, watch, .. } = resources;
        let planned = self.planned(budget);
        let most = planned.min(budget.max_trials);
        let (started, spent) = (budget.elapsed(), self.spent);
        let stop = 'sampling: loop {
            self.spent = spent + budget.elapsed() - started;
            let next = self.tallies[0].counts.trials;
            if next >= most {
                break if self.within.is_none() && most == planned { Stop::Plan } else { Stop::Cap };
            }
            if share.must_stop() {
                if !budget.must_stop() {
                    return Ok(None);
                }
                break budget.stopped_by();
            }
            let (items, first, second) = match self.ahead.take() {
                Some([first, second]) => (first.items, first.cells, second.cells),
                None => {
                    let width = executor.width(&self.jobs[0]) as u64;
                    let size = round(next, width, self.spent, share).min(most - next);
                    let items = Item::run(next, size);
                    let first = executor.run(&self.jobs[0], &items, share)?;
                    let second = executor.run(&self.jobs[1], &items, share)?;
                    (items, first, second)
                }
            };
            for (item, pair) in items.iter().zip(first.rows().zip(second.rows())) {
                let (Some(a), Some(b)) = pair else {
                    if executor.is_stored() {
                        let likely = self.likely(&self.statistics);
                        let ahead = forecast::ahead(item.index, Some(likely)).min(most);
                        for job in &self.jobs {
                            executor.request(job, None, item.index..ahead);
                        }
                        share.lack();
                    }
                    continue 'sampling;
                };
                let (a, b): (&Cell, &Cell) = (&a[0], &b[0]);
                for (job, cell) in self.jobs.iter().zip([a, b]) {
                    if cell.reading == Reading::Faulty {
                        return Err(crate::engine::trials::trial::fault(job.prepared, *item, job.series));
                    }
                }
                if let (Some(a), Some(b)) = (self.score(a), self.score(b)) {
                    self.statistics.add(a - b);
                }
                for (side, cell) in [a, b].into_iter().enumerate() {
                    self.tallies[side].add(item.index, cell, self.range);
                    if let Some(mean) = self.means.get_mut(side) {
                        mean.observe(value(cell));
                    }
                }
                let finished = match (&mut self.procedure, self.range) {
                    (Differences::Apart, _) => self.is_narrow(),
                    (Differences::Probability(difference), _) => difference.observe(outcome(a), outcome(b)),
                    (Differences::Expectation(mean), range) => {
                        let range = range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                        match (clipped(a, range), clipped(b, range)) {
                            (Some(a), Some(b)) => mean.observe(Some(a - b)),
                            // What is known of one side narrows the pair.
                            (a, b) => {
                                let ends = |side: Option<f64>| side.map_or(range, |value| (value, value));
                                let (a, b) = (ends(a), ends(b));
                                mean.observe_between((a.0 - b.1, a.1 - b.0))
                            }
                        }
                    }
                };
                self.note(next_after);
                if finished && self.within.is_some() {
                    break 'sampling Stop::Width;
                }
            }
            watch.consumed(&self.query.text, next + items.len() as u64, Some(most));
        };
        self.spent = spent + budget.elapsed() - started;
        Ok(Some(self.finish(stop)))
    }

    /// The estimate of first less second, and its interval.
    fn found(&self) -> (f64, stats::Interval) {
        let (estimate, interval) = match &self.procedure {
            Differences::Probability(difference) => {
                let (low, high) = difference.pairs();
                ((low.mean(), high.mean()), difference.interval())
            }
            Differences::Expectation(mean) => (mean.estimate(), mean.interval()),
            Differences::Apart => return self.apart(),
        };
        (0.5 * (estimate.0 + estimate.1), interval)
    }

    /// First less second, each known by itself.
    fn apart(&self) -> (f64, stats::Interval) {
        let [first, second] = [0, 1].map(|side| of_mean(&self.means[side]));
        let interval = stats::Interval {
            low: first.1.low - second.1.high,
            high: first.1.high - second.1.low,
            error: self.delta,
            coverage: first.1.coverage,
        };
        (first.0 - second.0, interval)
    }

    /// Whether that is as narrow as was asked for; looked at where a side is.
    fn is_narrow(&mut self) -> bool {
        let Some(within) = self.within else { return false };
        let looked = self.means.iter_mut().map(|mean| mean.look().is_some()).fold(false, |a, b| a | b);
        looked && self.apart().1.half_width() <= within
    }

    /// Notes what is known by now; `due` is the number of pairs for which it is time, from that noted last.
    fn note(&mut self, due: impl Fn(u64) -> u64) {
        let trials = self.tallies[0].counts.trials;
        let noted = |list: &Vec<Snapshot>| list.last().map_or(0, |last| last.trials);
        if self.evidence.as_ref().is_some_and(|list| trials >= due(noted(list))) {
            let (estimate, interval) = self.found();
            let value = Interval { estimate, low: interval.low, high: interval.high };
            self.evidence.get_or_insert_default().push(Snapshot { trials, value, weights: None });
        }
    }

    fn finish(&mut self, stop: Stop) -> Gap {
        self.note(|noted| noted + 1);
        let (estimate, interval) = self.found();
        let (tallies, means) = (std::mem::take(&mut self.tallies), std::mem::take(&mut self.means));
        let (alone, unresolved) = match &self.procedure {
            Differences::Probability(difference) => {
                let (low, high) = difference.pairs();
                ((high.first.min(low.first), low.second.min(high.second)), difference.unresolved())
            }
            Differences::Expectation(mean) => ((0, 0), mean.read().1),
            Differences::Apart => ((0, 0), means.iter().map(|mean| mean.read().1).sum()),
        };
        let pairs = tallies[0].counts.trials;
        let wide = |within: f64| interval.half_width() > within * (1.0 + 1e-9);
        let stop = match stop {
            Stop::Width if unresolved > 0 && self.within.is_some_and(wide) => Stop::Unresolved,
            stop => stop,
        };
        let evidence = self.evidence.take().map(Evidence::Values);
        Gap { sides: tallies, means, stop, interval, estimate, alone, pairs, unresolved, evidence }
    }
}
