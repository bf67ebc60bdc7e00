//! The executor that answers from parts. What is not there is requested, and becomes the plan of the next round.

use super::part::{Body, Head, Part};
use super::unit::{Trials, Unit};
use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::engine::trials::executor::{Cells, Executor, Job, Threads};
use crate::logic::Invalid;
use crate::trials::budget::Budget;
use crate::trials::cell::{Cell, Item};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Parts that are kept at a time, packed as they are: they are read again where they are needed again.
const KEPT: usize = 16;
/// Trials that are asked for at a time, in units of lanes.
const WIDTH: usize = 1 << 11;

/// A unit of trials in a part.
struct Piece {
    trials: Trials,
    part: usize,
    /// Its place in the part.
    unit: usize,
}

impl Piece {
    /// Whether it has the columns of a job.
    fn has(&self, job: &Job<'_>) -> bool {
        job.columns.iter().all(|one| self.trials.columns.contains(one))
    }
}

/// World, and option if one is followed.
type Key = (usize, Option<(usize, usize)>);

/// Outcomes of parts.
pub struct Stored<'r> {
    threads: &'r Threads,
    reread: &'r (dyn Fn(usize) -> Option<Part> + Sync),
    /// The units of trials of each world and option, by their first trials.
    pieces: BTreeMap<Key, Vec<Piece>>,
    runs: Vec<(SplitRun, usize, usize)>,
    /// Parts that were read last, by their places.
    recent: Mutex<BTreeMap<usize, Option<Arc<Part>>>>,
    wanted: Mutex<Vec<Unit>>,
}

impl<'r> Stored<'r> {
    /// Nothing.
    pub fn nothing(threads: &'r Threads) -> Self {
        Self {
            threads,
            reread: &|_| None,
            pieces: BTreeMap::new(),
            runs: Vec::new(),
            recent: Mutex::default(),
            wanted: Mutex::default(),
        }
    }

    /// The outcomes of some parts, of which `heads` are known.
    ///
    /// # Errors
    /// If two parts, here with their places, say different things of a unit.
    pub fn new(
        heads: &[&Head],
        reread: &'r (dyn Fn(usize) -> Option<Part> + Sync),
        threads: &'r Threads,
    ) -> Result<Self, ([usize; 2], Unit)> {
        let mut stored = Self { reread, ..Self::nothing(threads) };
        let mut known = BTreeMap::new();
        for (part, head) in heads.iter().enumerate() {
            for (at, unit) in head.units.iter().enumerate() {
                // Of a unit that came twice one is read.
                if let Some(&(other, place)) = known.get(&format!("{unit:?}")) {
                    let body = |part, at: usize| stored.part(part).map(|part| part.bodies[at].clone());
                    if body(part, at) != body(other, place) {
                        return Err(([other, part], unit.clone()));
                    }
                    continue;
                }
                known.insert(format!("{unit:?}"), (part, at));
                match unit {
                    Unit::Trials(trials) => {
                        let piece = Piece { trials: trials.clone(), part, unit: at };
                        stored.pieces.entry((trials.world, trials.advice)).or_default().push(piece);
                    }
                    Unit::Run(run) => stored.runs.push((run.clone(), part, at)),
                }
            }
        }
        for pieces in stored.pieces.values_mut() {
            pieces.sort_by_key(|piece| (piece.trials.from, piece.part));
        }
        Ok(stored)
    }

    /// What was requested, and is not there.
    pub fn wanted(&self) -> Vec<Unit> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// A part, which is kept for a while.
    fn part(&self, place: usize) -> Option<Arc<Part>> {
        let mut recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        if recent.len() >= KEPT && !recent.contains_key(&place) {
            recent.clear();
        }
        recent.entry(place).or_insert_with(|| (self.reread)(place).map(Arc::new)).clone()
    }

    /// The piece that has a trial and all of some columns.
    fn piece(&self, job: &Job<'_>, item: Item) -> Option<&Piece> {
        let pieces = self.pieces.get(&(job.prepared.number?, item.advice))?;
        let before = pieces.partition_point(|piece| piece.trials.from <= item.index);
        pieces[..before].iter().rev().find(|piece| item.index < piece.trials.to && piece.has(job))
    }
}

impl Executor for Stored<'_> {
    fn run(&self, job: &Job<'_>, items: &[Item], _: &Budget) -> Result<Cells, Invalid> {
        let mut cells = job.cells(items.len(), false);
        let mut row: Vec<Cell> = Vec::with_capacity(job.columns.len());
        let mut open: Option<(&Piece, Vec<usize>, Arc<Part>)> = None;
        // Outcomes are read in the order of their trials: what follows one that is not there is of no use yet.
        for (place, item) in items.iter().enumerate() {
            let has = |piece: &Piece| {
                item.advice == piece.trials.advice
                    && (piece.trials.from..piece.trials.to).contains(&item.index)
            };
            if !open.as_ref().is_some_and(|(piece, ..)| has(piece)) {
                open = self.piece(job, *item).and_then(|piece| {
                    let at = |one: &usize| piece.trials.columns.iter().position(|known| known == one);
                    Some((piece, job.columns.iter().filter_map(at).collect(), self.part(piece.part)?))
                });
            }
            let Some((piece, columns, part)) = &open else { break };
            let Body::Trials(table) = &part.bodies[piece.unit] else { break };
            let trial = (item.index - piece.trials.from) as usize;
            row.clear();
            row.extend(columns.iter().map(|column| table.cell(trial, *column)));
            cells.put(place, &row);
        }
        Ok(cells)
    }

    fn width(&self, _: &Job<'_>) -> usize {
        WIDTH
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.threads.everywhere(work);
    }

    fn is_stored(&self) -> bool {
        true
    }

    fn request(&self, job: &Job<'_>, advice: Option<(usize, usize)>, trials: Range<u64>) -> bool {
        let Some(world) = job.prepared.number else { return false };
        let mut wanted = self.wanted.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut from, mut lacking) = (trials.start, None);
        let mut request = |from: u64, to: u64| {
            let unit = Unit::Trials(Trials { world, columns: job.columns.clone(), advice, from, to });
            lacking = lacking.or(Some(from));
            if !wanted.contains(&unit) {
                wanted.push(unit);
            }
        };
        let pieces = self.pieces.get(&(world, advice)).into_iter().flatten();
        for piece in pieces.filter(|piece| piece.has(job) && self.part(piece.part).is_some()) {
            if from < piece.trials.from.min(trials.end) {
                request(from, piece.trials.from.min(trials.end));
            }
            from = from.max(piece.trials.to);
        }
        if from < trials.end {
            request(from, trials.end);
        }
        lacking == Some(trials.start)
    }

    fn record(&self, run: &SplitRun) -> Option<Option<RunRecord>> {
        let mut known = self.runs.iter().filter(|(known, ..)| known == run);
        let record = known.find_map(|(_, part, unit)| match &self.part(*part)?.bodies[*unit] {
            Body::Run(record) => Some(record.clone()),
            Body::Trials(_) => None,
        });
        if record.is_none() {
            let mut wanted = self.wanted.lock().unwrap_or_else(PoisonError::into_inner);
            wanted.push(Unit::Run(run.clone()));
        }
        record
    }
}
