//! Rankings: which option has the best score, with a joint guarantee. An option is a world and perhaps a move in it.
//!
//! All options share the random numbers of a trial (common random numbers): neither moves nor values of parameters
//! are part of the address of a draw. Given-Wilson et al. 2017, Algorithm 1, is `by okamoto`.

use crate::base::lanes::LANES;
use crate::compile::study::{Beside, MeasureKind, Query, RankOption, Target};
use crate::engine::fault::Fault;
use crate::engine::outcome::{Standing, Stop, next_after};
use crate::engine::sampling::contest::contest;
use crate::engine::sampling::forecast::{self, PilotStatistics};
use crate::engine::sampling::pilot::{Pilot, Piloted};
use crate::engine::sampling::procedure::{self, of_mean, score, sequence, value};
use crate::engine::sampling::resources::Resources;
use crate::engine::sampling::tally::Tally;
use crate::engine::sampling::watch::{Forecast, Likely};
use crate::engine::trials::executor::{Cells, Executor, Job};
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::trials::trial::fault;
use crate::stats::ranking::{Choice, Contest, Ranking, Share};
use crate::stats::{self, Bounded};
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading, Series};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering;

/// Trials an option gets in a round: traces of crowds are slow.
pub(in crate::engine) const WORD: u64 = 32;

/// A ranking that has stopped.
pub(in crate::engine) struct RankOutcome {
    /// What each option consumed; of several models, under each of them.
    pub(in crate::engine) tallies: Vec<Tally>,
    /// Estimate and interval of each option, under each model, jointly valid at all times.
    pub(in crate::engine) values: Vec<(f64, stats::Interval)>,
    /// The choice.
    pub(in crate::engine) choice: Choice,
    /// Whether the ranking is certified.
    pub(in crate::engine) finished: bool,
    /// Why it stopped.
    pub(in crate::engine) stop: Stop,
    /// The largest gap that there can be: 1 for probabilities, the range for metrics.
    pub(in crate::engine) scale: f64,
    /// What was asked besides, option by option: estimate, interval, and whether it is satisfied.
    pub(in crate::engine) also: Vec<Vec<(f64, stats::Interval, Option<bool>)>>,
    /// How far the options were on the way; `None` where nobody asks.
    pub(in crate::engine) evidence: Option<Vec<Standing>>,
}

/// What is ranked.
pub(in crate::engine) struct RankSetup<'s> {
    /// The options, in order of writing.
    pub(in crate::engine) options: &'s [RankOption],
    /// The prepared world of each.
    pub(in crate::engine) worlds: Vec<&'s PreparedWorld>,
    /// Kind of the score.
    pub(in crate::engine) kind: MeasureKind,
    /// Loss that does not matter, error, procedure.
    pub(in crate::engine) rule: (f64, f64, Ranking),
    /// Under how many models each option is asked for its score.
    pub(in crate::engine) models: usize,
    /// What is asked of the options besides.
    pub(in crate::engine) beside: &'s [Beside],
}

impl RankSetup<'_> {
    /// A trial of an option.
    pub(in crate::engine) fn item(&self, arm: usize, index: u64) -> Item {
        Item { advice: self.options[arm].advice, index }
    }
}

/// A ranking on its way.
pub(in crate::engine) struct RankSampling<'s> {
    /// Its place among the queries that are asked.
    pub(in crate::engine) place: usize,
    pub(in crate::engine) query: &'s Query,
    pub(in crate::engine) setup: RankSetup<'s>,
    /// Jobs, each of all options that are read from one column of one world.
    jobs: Vec<Job<'s>>,
    /// The job of each option.
    job_of: Vec<usize>,
    procedure: Box<dyn Contest>,
    range: Option<(f64, f64)>,
    ahead: Option<Pilot>,
    /// What each option consumed.
    pub(in crate::engine) tallies: Vec<Tally>,
    /// The mean of each option, for expectations.
    means: Vec<Bounded>,
    /// How far the options were; `None` where nobody asks.
    evidence: Option<Vec<Standing>>,
    /// Seconds that it has taken so far.
    pub(in crate::engine) spent: f64,
}

/// All columns that are asked of an option.
fn columns(option: &RankOption) -> Vec<usize> {
    let all = std::iter::once(&option.target.column).chain(&option.beside);
    all.copied().collect::<BTreeSet<_>>().into_iter().collect()
}

/// What a round runs: the items, and for each share of it their places; and whether the budget cut any share.
struct Round {
    shares: Vec<Share>,
    items: Vec<Item>,
    /// Of each item its option, and how many trials of it precede in the round.
    of: Vec<(usize, u64)>,
    places: Vec<Vec<usize>>,
    cut: bool,
}

impl Piloted for RankSampling<'_> {
    fn pilot(&mut self, executor: &dyn Executor, budget: &Budget) -> Result<Vec<Forecast>, Fault> {
        let round = self.round(budget.max_trials);
        let steps = || self.jobs.iter().map(|job| job.steps.load(Ordering::Relaxed)).sum();
        let pilot = Pilot::of(round.items, &steps, budget, |items, ahead| {
            self.run_round(&round.of, items, executor, ahead)
        })?;
        let arms = self.setup.options.len();
        let range = self.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let mut statistics = vec![PilotStatistics::default(); arms];
        let mut readings: Vec<Vec<Option<f64>>> = vec![Vec::new(); arms];
        for (share, places) in round.shares.iter().zip(&round.places) {
            for row in places.iter().map(|&place| pilot.cells.row(place)) {
                let mut one = PilotStatistics::default();
                let place = self.places(share.arm)[0];
                if let Some(cell) = row.map(|row| &row[place]) {
                    statistics[share.arm].read(cell, range);
                    one.read(cell, range);
                }
                readings[share.arm].push(one.only());
            }
        }
        let leader =
            (0..arms).max_by(|a, b| statistics[*a].mean().total_cmp(&statistics[*b].mean())).unwrap_or(0);
        let differences: Vec<PilotStatistics> = (0..arms)
            .map(|arm| {
                let mut statistics = PilotStatistics::default();
                let pairs = readings[leader].iter().zip(&readings[arm]);
                pairs.filter_map(|(a, b)| a.zip(*b)).for_each(|(a, b)| statistics.add(a - b));
                statistics
            })
            .collect();
        let most = (arms as u64).saturating_mul(budget.max_trials);
        let trials = forecast::rank(&statistics, &differences, self.scale(), self.setup.rule);
        let trials = trials.map(|n| n.max(pilot.items.len() as u64).min(most));
        let most_steps = self.setup.worlds.iter().map(|prepared| prepared.most_steps()).max().flatten();
        let seconds = pilot.seconds_per_trial(most_steps);
        self.ahead = pilot.is_complete().then_some(pilot);
        self.spent = self.ahead.as_ref().map_or(0.0, |ahead| ahead.seconds);
        Ok(vec![Forecast::of(self.query, trials, seconds)])
    }

    fn is_unread(&self) -> bool {
        self.tallies.iter().all(|tally| tally.counts.trials == 0)
    }
}

impl<'s> RankSampling<'s> {
    /// A ranking of the options of a setup.
    pub(in crate::engine) fn new(
        (place, query): (usize, &'s Query),
        setup: RankSetup<'s>,
        series: Series,
        shows_evidence: bool,
    ) -> Result<Self, Fault> {
        let procedure = contest(&setup)?;
        let range = setup.kind.range();
        let arms = setup.options.len();
        let mut targets: Vec<Target> = Vec::new();
        let (mut jobs, mut job_of) = (Vec::new(), Vec::with_capacity(arms));
        for (option, prepared) in setup.options.iter().zip(&setup.worlds) {
            // Options of one world are asked the same.
            let known = targets.iter().position(|target| *target == option.target);
            job_of.push(known.unwrap_or(targets.len()));
            if known.is_none() {
                targets.push(option.target);
                jobs.push(Job::new(prepared, columns(option), series));
            }
        }
        let means = match range {
            Some((low, high)) => (0..arms)
                .map(|_| Bounded::running((low, high), setup.kind.share(), setup.rule.1 / arms as f64))
                .collect::<Result<_, _>>()?,
            None => Vec::new(),
        };
        let tallies = vec![Tally::default(); arms];
        let evidence = shows_evidence.then(Vec::new);
        Ok(Self {
            place,
            query,
            setup,
            jobs,
            job_of,
            procedure,
            range,
            ahead: None,
            tallies,
            means,
            evidence,
            spent: 0.0,
        })
    }

    /// The places of what is asked of an option among the columns of its job.
    fn places(&self, arm: usize) -> Vec<usize> {
        let (option, job) = (&self.setup.options[arm], &self.jobs[self.job_of[arm]]);
        let place = |column: &usize| job.columns.iter().position(|one| one == column).unwrap_or_default();
        std::iter::once(&option.target.column).chain(&option.beside).map(place).collect()
    }

    fn scale(&self) -> f64 {
        self.range.map_or(1.0, |(low, high)| high - low)
    }

    /// The next round. All options advance side by side, so that a deadline finds every one of them as far as
    /// the others. No option gets more than `budget` trials in all.
    fn round(&self, budget: u64) -> Round {
        let shares = self.procedure.next_round().to_vec();
        let cut = shares.iter().any(|share| share.to > budget);
        let most = shares.iter().map(|share| share.to - share.from).max().unwrap_or(0);
        let (mut items, mut of): (Vec<Item>, Vec<(usize, u64)>) = Default::default();
        let mut places: Vec<Vec<usize>> = vec![Vec::new(); shares.len()];
        for step in 0..most {
            for (share, places) in shares.iter().zip(&mut places) {
                if share.from + step < share.to.min(budget) {
                    places.push(items.len());
                    items.push(self.setup.item(share.arm, share.from + step));
                    of.push((share.arm, step));
                }
            }
        }
        Round { shares, items, of, places, cut }
    }

    /// Runs the first items of a round. With a deadline all jobs advance side by side, too.
    fn run_round(
        &self,
        of: &[(usize, u64)],
        items: &[Item],
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<Cells, Fault> {
        if let [job] = self.jobs.as_slice() {
            return Ok(executor.run(job, items, budget)?);
        }
        let slice = if budget.has_deadline() { LANES as u64 } else { WORD };
        let mut parts: BTreeMap<(u64, usize), Vec<usize>> = BTreeMap::new();
        for (place, (arm, step)) in of.iter().take(items.len()).enumerate() {
            parts.entry((step / slice, self.job_of[*arm])).or_default().push(place);
        }
        let of_part = |((_, job), places): (&(u64, usize), &Vec<usize>)| {
            (&self.jobs[*job], places.iter().map(|place| items[*place]).collect())
        };
        let jobs: Vec<(&Job<'s>, Vec<Item>)> = parts.iter().map(of_part).collect();
        let mut all = Cells::new(items.len(), self.jobs[0].columns.len());
        for (((job, _), places), cells) in
            jobs.iter().zip(parts.values()).zip(executor.run_all(&jobs, budget)?)
        {
            for (place, row) in places.iter().zip(cells.rows()) {
                row.inspect(|row| all.put(*place, row));
            }
            job.reuse(cells);
        }
        Ok(all)
    }

    /// Requests the trials of a round, and those that most likely follow: of all options that are still open.
    fn request(&self, round: &Round, executor: &dyn Executor, (left, most): (u64, u64)) {
        let arms = self.setup.options.len();
        let known = match self.setup.rule {
            (epsilon, delta, Ranking::Okamoto) => {
                Some(Likely::exactly(stats::ranking::size(arms, epsilon / self.scale(), delta)))
            }
            _ => None,
        };
        for share in &round.shares {
            let ahead = forecast::ahead(share.from, known).max(share.to).min(most);
            let ahead = ahead.min(share.from.saturating_add(left));
            let advice = self.setup.options[share.arm].advice;
            executor.request(&self.jobs[self.job_of[share.arm]], advice, share.from..ahead);
        }
    }

    /// Runs until the ranking is certified, or the budget is spent; `None` if its share of the time is over before, and
    /// the time of the call is not.
    pub(in crate::engine) fn sample(
        &mut self,
        resources: Resources<'_>,
    ) -> Result<Option<RankOutcome>, Fault> {
        let Resources { executor, budget, share, watch, .. } = resources;
        let arms = self.setup.options.len();
        // Each option's interval is one of as many that hold jointly.
        let delta = self.setup.rule.1 / arms as f64;
        let (started, spent) = (budget.elapsed(), self.spent);
        let stop = loop {
            self.spent = spent + budget.elapsed() - started;
            let round = self.round(budget.max_trials);
            if round.shares.is_empty() || self.procedure.finished() {
                break if self.procedure.is_planned() { Stop::Plan } else { Stop::Width };
            }
            if share.must_stop() {
                if !budget.must_stop() {
                    return Ok(None);
                }
                break budget.stopped_by();
            }
            let consumed: u64 = self.tallies.iter().map(|t| t.counts.trials).sum();
            let noted = self.evidence.as_ref().and_then(|list| list.last()).map_or(0, |last| last.trials);
            if consumed >= next_after(noted) {
                self.note(|arm| round.shares.iter().any(|share| share.arm == arm));
            }
            let left = budget.max_total.map_or(u64::MAX, |total| total.saturating_sub(consumed));
            if left == 0 || round.items.is_empty() {
                break Stop::Cap;
            }
            let wanted = round.items.len().min(usize::try_from(left).unwrap_or(usize::MAX));
            let rows = match self.ahead.take() {
                Some(ahead) => ahead.cells,
                None => self.run_round(&round.of, &round.items[..wanted], executor, share)?,
            };
            // What follows an unfinished trial is not looked at, so that their number says which they are.
            let prefix = (0..wanted).take_while(|place| rows.row(*place).is_some()).count();
            if prefix < wanted && executor.is_stored() {
                self.request(&round, executor, (left, budget.max_trials));
                share.lack();
            }
            if prefix < wanted && !budget.must_stop() {
                // What a round had finished counts only where the call ends: else their number would not say which they are.
                return Ok(None);
            }
            if !self.read(&round, &rows, prefix)? {
                break if prefix == wanted { Stop::Cap } else { budget.stopped_by() };
            }
            if round.cut {
                break Stop::Cap;
            }
            watch.consumed(&self.query.text, self.tallies.iter().map(|t| t.counts.trials).sum(), None);
        };
        self.spent = spent + budget.elapsed() - started;
        let choice = self.procedure.choice();
        let models = self.setup.models;
        let is_open = |option| {
            option == choice.arm || choice.open.contains(&option) || choice.certified.contains(&option)
        };
        self.note(|arm| is_open(arm / models));
        let evidence = self.evidence.take();
        let (tallies, means) = (std::mem::take(&mut self.tallies), std::mem::take(&mut self.means));
        let values = (0..arms)
            .map(|arm| match means.get(arm) {
                Some(mean) => of_mean(mean),
                None => (procedure::share(tallies[arm].counts), sequence(tallies[arm].counts, delta)),
            })
            .collect();
        let finished = self.procedure.finished();
        let sides = self.setup.beside.len();
        let also =
            (0..arms).map(|arm| (0..sides).filter_map(|at| self.procedure.side(at, arm)).collect()).collect();
        let scale = self.scale();
        Ok(Some(RankOutcome { tallies, values, choice, finished, stop, scale, also, evidence }))
    }

    /// Notes how far the options are, and who is still in the race; of one number of trials once.
    fn note(&mut self, is_open: impl Fn(usize) -> bool) {
        if let Some(list) = &mut self.evidence {
            let standing = |(arm, tally): (usize, &Tally)| (tally.counts.trials, is_open(arm));
            let options: Vec<(u64, bool)> = self.tallies.iter().enumerate().map(standing).collect();
            let trials = options.iter().map(|(trials, _)| trials).sum();
            list.retain(|last| last.trials < trials);
            list.push(Standing { trials, options });
        }
    }

    /// Shows the first trials of a round to the procedure, option by option; false where these are not all.
    fn read(&mut self, round: &Round, rows: &Cells, prefix: usize) -> Result<bool, Fault> {
        let mut complete = true;
        for (share, places) in round.shares.iter().zip(&round.places) {
            let columns = self.places(share.arm);
            let mut scores = vec![Vec::with_capacity(places.len()); columns.len()];
            let mut broken = false;
            for &place in places {
                match rows.row(place).filter(|_| place < prefix) {
                    Some(row) if !broken => {
                        let item = round.items[place];
                        if row.iter().any(|cell| cell.reading == Reading::Faulty) {
                            return Err(fault(self.setup.worlds[share.arm], item, self.jobs[0].series));
                        }
                        let first = &row[columns[0]];
                        self.tallies[share.arm].add(item.index, first, self.range);
                        if let Some(mean) = self.means.get_mut(share.arm) {
                            mean.observe(value(first));
                        }
                        for (scores, place) in scores.iter_mut().zip(&columns) {
                            scores.push(score(&row[*place]));
                        }
                    }
                    _ => broken = true,
                }
            }
            complete &= !broken;
            self.procedure.feed(share.arm, &scores)?;
        }
        Ok(complete)
    }
}
