//! A check or an estimate on its way: what it has read of its trials, in the order of their indices.

use crate::compile::study::{Ask, Query};
use crate::engine::outcome::{Evidence, Snapshot, Stop, next_after};
use crate::engine::sampling::forecast::PilotStatistics;
use crate::engine::sampling::procedure::Procedure;
use crate::engine::sampling::tally::Tally;
use crate::trials::cell::{Cell, Item, Reading};

/// One query on its way.
pub(in crate::engine) struct EstimateEntry<'q> {
    /// Its place among the queries that are asked.
    pub(in crate::engine) place: usize,
    /// The query.
    pub(in crate::engine) query: &'q Query,
    /// Column of the prepared world.
    pub(in crate::engine) column: usize,
    /// Range of an expectation.
    pub(in crate::engine) range: Option<(f64, f64)>,
    /// Its procedure.
    pub(in crate::engine) procedure: Procedure,
    /// What it has consumed.
    pub(in crate::engine) tally: Tally,
    /// What it has read so far, for forecasts.
    pub(in crate::engine) statistics: PilotStatistics,
    /// Whether it has to know more of its procedure before it can read more.
    pub(in crate::engine) waits: bool,
    /// Whether it came to a trial in which the model is wrong: it reads no more and has no result.
    pub(in crate::engine) lost: bool,
    /// Why it stopped.
    pub(in crate::engine) stop: Option<Stop>,
    /// How its evidence grew; `None` where nobody asks.
    pub(in crate::engine) evidence: Option<Vec<Snapshot>>,
    /// Seconds from the start of the estimate to its stop.
    pub(in crate::engine) seconds: f64,
}

impl EstimateEntry<'_> {
    /// Whether it reads on.
    pub(in crate::engine) const fn is_open(&self) -> bool {
        self.stop.is_none() && !self.waits && !self.lost
    }

    /// Whether it had stopped before a trial. Whoever stops later in the same round is one who would have seen it in a
    /// smaller round, so that only this leaves no trace of the size of rounds.
    pub(in crate::engine) fn stopped_before(&self, index: u64) -> bool {
        self.stop.is_some() && self.tally.counts.trials <= index
    }

    /// Reads the trials of a round up to where it stops; the place of the trial in which the model is wrong, if it
    /// comes to it.
    pub(in crate::engine) fn read<'c>(
        &mut self,
        items: &[Item],
        cells: impl Iterator<Item = &'c Cell> + Clone,
        most: u64,
    ) -> Result<Option<Stop>, usize> {
        if self.evidence.is_none() {
            return self.read_part(items, cells, most);
        }
        let mut done = 0_usize;
        loop {
            let trials = self.tally.counts.trials;
            let left = usize::try_from(next_after(trials) - trials).unwrap_or(usize::MAX);
            let part = &items[done..items.len().min(done.saturating_add(left))];
            let stop = self.read_part(part, cells.clone().skip(done), most).map_err(|at| done + at)?;
            done += part.len();
            if part.len() == left || stop.is_some() {
                self.note();
            }
            if stop.is_some() || self.waits || done == items.len() {
                return Ok(stop);
            }
        }
    }

    /// Notes what is known by now.
    fn note(&mut self) {
        let counts = self.tally.counts;
        let beside = if let Ask::Check { beside, .. } = self.query.ask { beside } else { 0.0 };
        let found = self.procedure.interval(counts, beside);
        if let (Some(list), Some((value, ..))) = (&mut self.evidence, found)
            && list.last().is_none_or(|last| last.trials < counts.trials)
        {
            list.push(Snapshot { trials: counts.trials, value, weights: self.procedure.weights() });
        }
    }

    /// How its evidence grew, with what is known at its end.
    pub(in crate::engine) fn evidence(&mut self) -> Option<Evidence> {
        self.note();
        self.evidence.take().map(Evidence::Values)
    }

    /// The same of a part of them, in one go.
    fn read_part<'c>(
        &mut self,
        items: &[Item],
        cells: impl Iterator<Item = &'c Cell> + Clone,
        most: u64,
    ) -> Result<Option<Stop>, usize> {
        let (mut consumed, mut finished) = (0, false);
        // At least one is read, whatever the limit.
        let room = most.saturating_sub(self.tally.counts.trials).max(1);
        for cell in cells.clone().take(items.len()) {
            if cell.reading == Reading::Faulty {
                return Err(consumed);
            }
            consumed += 1;
            finished = self.procedure.observe(cell);
            if finished || consumed as u64 == room {
                break;
            }
        }
        self.count(items[..consumed].iter().map(|item| item.index).zip(cells));
        let capped = self.tally.counts.trials >= most;
        let waits = self.procedure.waits_for().is_some();
        // At the limit nothing more would be read with a level: it matters only if it has stopped here.
        self.waits = waits && (!capped || self.procedure.may_have_stopped());
        Ok(if finished && !waits {
            Some(self.reason())
        } else {
            (capped && !self.waits).then_some(Stop::Cap)
        })
    }

    /// Counts trials with their indices.
    fn count<'c>(&mut self, trials: impl Iterator<Item = (u64, &'c Cell)> + Clone) {
        if let Some(held) = self.tally.add_truths(&trials) {
            self.statistics.count(trials.count() as u64, held);
            return;
        }
        for (index, cell) in trials {
            self.tally.add(index, cell, self.range);
            if let (Ask::Check { threshold, at_least, or_equal, .. }, Reading::Value(value)) =
                (&self.query.ask, cell.reading)
            {
                let beyond = if *at_least { value > *threshold } else { value < *threshold };
                self.tally.side(index, beyond || (*or_equal && value == *threshold));
            }
            self.statistics.read(cell, self.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY)));
        }
    }

    /// Why a finished procedure stopped.
    pub(in crate::engine) fn reason(&self) -> Stop {
        match &self.procedure {
            procedure if procedure.is_capped() => Stop::Cap,
            procedure if procedure.split() => Stop::Unresolved,
            // A plan whose answer is forced stops before its end.
            procedure if procedure.is_planned() => {
                let all = procedure.limit().is_none_or(|size| self.tally.counts.trials >= size);
                if all { Stop::Plan } else { Stop::Boundary }
            }
            procedure if self.tally.counts.unresolved > 0 && procedure.is_wide(&self.query.ask) => {
                Stop::Unresolved
            }
            Procedure::Test(_) | Procedure::Mean { threshold: Some(_), .. } => Stop::Boundary,
            _ => Stop::Width,
        }
    }
}
