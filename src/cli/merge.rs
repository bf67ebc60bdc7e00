//! Rounds over a folder of parts: the ordinary session reads them, what it lacks is the plan of the next round, and a launcher
//! runs that, until nothing is lacking. Or the session runs what is lacking itself, and records it.

use super::launch::Launcher;
use super::parts::{self, PartsFolder};
use super::progress::Progress;
use super::terminal::print;
use crate::compile::Study;
use crate::engine::outcome::{CallResult, QueryResult, Stop};
use crate::engine::shards::{Attempts, Origin, Part, Plan, Recorder, Stored, Unit};
use crate::engine::{Budget, Call, Threads, run as run_study};
use crate::library;
use crate::report::number::brief;
use crate::syntax::diagnostic::Diagnostic;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A call whose trials run elsewhere.
pub(super) struct Rounds<'a> {
    pub(super) study: &'a Study,
    pub(super) call: Call<'a>,
    pub(super) origin: Origin,
    /// The budget of the whole call.
    pub(super) budget: &'a Budget,
    pub(super) threads: &'a Threads,
    /// Most shards of a round.
    pub(super) shards: usize,
    pub(super) progress: &'a Progress,
    /// Reports warnings.
    pub(super) warn: &'a mut dyn FnMut(&[Diagnostic]),
}

impl Rounds<'_> {
    /// Merges what is there, and writes the plan of what is lacking; with a launcher, until nothing is. No results where a
    /// launcher prints what is to be done instead.
    pub(super) fn run(
        &mut self,
        folder: &mut PartsFolder,
        launcher: Option<&Launcher<'_>>,
    ) -> Result<Option<CallResult>, Vec<Diagnostic>> {
        let mut attempts = Attempts::default();
        // Witnesses of many results are looked for once.
        self.call.explains = launcher.is_none() || self.study.queries.len() <= 64;
        loop {
            let before = folder.plan(&self.origin)?;
            (self.warn)(&folder.scan(&self.origin, before.as_ref())?);
            let (run, wanted) = self.read(folder)?;
            let shards = Plan::deal(&wanted, &attempts, self.shards, folder.pace());
            if launcher.is_some() && (shards.is_empty() || self.budget.must_stop()) {
                if self.call.explains {
                    return Ok(Some(self.finish(run, &attempts)));
                }
                self.call.explains = true;
                continue;
            }
            if shards.is_empty() {
                return Ok(Some(run));
            }
            let lacking = before.as_ref().map_or_else(Vec::new, |plan| folder.missing(plan));
            let (round, max_trials) = (folder.next_round(before.as_ref()), self.budget.max_trials);
            let plan = Plan { origin: self.origin.clone(), round, max_trials, shards };
            folder.write_plan(&plan)?;
            let Some(launcher) = launcher else {
                (self.warn)(&parts::lost(&lacking));
                return Ok(Some(run));
            };
            if let Some(manifest) = launcher.manifest(folder, &plan)? {
                let _ = print(&manifest);
                return Ok(None);
            }
            let known = run.results.iter().find(|result| result.stopped_by.is_early());
            let so_far =
                |one: &QueryResult| Some(format!(" · {} so far: {}", one.asked.text, brief(one.estimate?)));
            let known = known.and_then(so_far).unwrap_or_default();
            let (count, failed) = (plan.shards.len(), attempts.0.len());
            let told = |done: usize| {
                let counts = format!("{done} of {count} shards done, {} running or waiting", count - done);
                self.progress.shards(&format!("round {round}: {counts}, {failed} failed{known}"));
            };
            launcher.launch(folder, &plan, self.budget, &told)?;
            if !self.budget.must_stop() {
                let missing = folder.missing(&plan);
                (self.warn)(&parts::lost(&missing));
                attempts.fail(&missing);
            }
        }
    }

    /// Runs what is not there on the threads of this process, and writes parts of it.
    pub(super) fn record(&mut self, folder: &mut PartsFolder) -> Result<CallResult, Vec<Diagnostic>> {
        let before = folder.plan(&self.origin)?;
        (self.warn)(&folder.scan(&self.origin, before.as_ref())?);
        let (round, made) = (folder.next_round(before.as_ref()), AtomicUsize::new(0));
        let unwritten = Mutex::new(None);
        let keep = |part: &Part| {
            let place = (round, made.fetch_add(1, Ordering::Relaxed));
            let written = parts::write(&folder.path, place, part);
            if let (Err(error), Ok(mut unwritten)) = (written, unwritten.lock()) {
                *unwritten = Some(error);
                self.budget.interrupt();
            }
        };
        let (heads, reread) = (folder.heads(), |part| folder.reread(part));
        let stored = Stored::new(&heads, &reread, self.threads);
        let stored = stored.map_err(|(parts, unit)| vec![folder.contradiction(parts, &unit)])?;
        let recorder = Recorder::new(stored, self.threads, self.origin.clone(), &keep);
        let run = run_study(self.study, &self.call, &recorder, self.budget, self.progress);
        recorder.flush(self.budget.elapsed());
        if let Ok(Some(error)) = unwritten.into_inner() {
            return Err(error.into());
        }
        run.map_err(|fault| library::refusals(&fault))
    }

    /// The results of what is there: why they are not more.
    fn finish(&self, mut run: CallResult, attempts: &Attempts) -> CallResult {
        (run.interrupted, run.elapsed_s) = (self.budget.is_interrupted(), self.budget.elapsed());
        if self.budget.must_stop() {
            let early = run.results.iter_mut().filter(|result| result.stopped_by == Stop::Missing);
            early.for_each(|result| result.stopped_by = self.budget.stopped_by());
        } else if let given_up @ [_, ..] = attempts.given_up().as_slice() {
            run.warnings.push(format!("no shard brought these back: {}", parts::words(given_up)));
        }
        run
    }

    /// Reads all parts; what is lacking.
    fn read(&mut self, folder: &PartsFolder) -> Result<(CallResult, Vec<Unit>), Vec<Diagnostic>> {
        let heads = folder.heads();
        let reread = |part| folder.reread(part);
        let stored = Stored::new(&heads, &reread, self.threads);
        let stored = stored.map_err(|(parts, unit)| vec![folder.contradiction(parts, &unit)])?;
        let mut budget = Budget::new(self.budget.max_trials, None);
        budget.max_total = self.budget.max_total;
        let run = run_study(self.study, &self.call, &stored, &budget, self.progress);
        Ok((run.map_err(|fault| library::refusals(&fault))?, stored.wanted()))
    }
}
