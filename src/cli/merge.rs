//! Rounds over a folder of parts: the ordinary session reads them, what it lacks is the plan of the next round, and a launcher
//! runs that, until nothing is lacking.

use super::launch::Launcher;
use super::parts::{self, PartsFolder};
use super::progress::Progress;
use super::terminal::print;
use crate::compile::Study;
use crate::engine::outcome::{CallResult, Stop};
use crate::engine::shards::{Attempts, Origin, Plan, Stored, Unit};
use crate::engine::{Budget, Call, Fault, Threads, Watch, run as run_study};
use crate::syntax::diagnostic::Diagnostic;

/// Why there are no results.
pub(super) enum Ended {
    /// Nothing could be run.
    Fault(Fault),
    /// Files, or the launcher, are wrong.
    Refused(Diagnostic),
    /// What is to be run next was printed instead.
    Printed,
}

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
    /// Reports a warning.
    pub(super) warn: &'a mut dyn FnMut(Diagnostic),
}

/// Hears only that sampling begins: one run is read several times.
struct Hushed<'p>(&'p Progress);

impl Watch for Hushed<'_> {
    fn samples(&self) {
        self.0.samples();
    }
}

impl Rounds<'_> {
    /// Merges what is there, and writes the plan of what is lacking; with a launcher, until nothing is.
    pub(super) fn run(
        &mut self,
        folder: &mut PartsFolder,
        launcher: Option<&Launcher<'_>>,
    ) -> Result<CallResult, Ended> {
        let mut attempts = Attempts::default();
        loop {
            let before = folder.plan(&self.origin).map_err(Ended::Refused)?;
            let warnings = folder.scan(&self.origin, before.as_ref()).map_err(Ended::Refused)?;
            warnings.into_iter().for_each(&mut *self.warn);
            self.call.explains = launcher.is_none();
            let (run, wanted) = self.read(folder, Stop::Missing, true)?;
            let shards = Plan::deal(&wanted, &attempts, self.shards, folder.pace());
            let Some(launcher) = launcher else {
                let missing = before.as_ref().filter(|_| !wanted.is_empty()).map(|plan| folder.missing(plan));
                missing.and_then(|missing| parts::lost(&missing)).into_iter().for_each(&mut *self.warn);
                self.plan(folder, before.as_ref(), shards)?;
                return Ok(run);
            };
            if shards.is_empty() || self.budget.must_stop() {
                return self.finish(folder, &attempts);
            }
            let plan = self.plan(folder, before.as_ref(), shards)?.ok_or(Ended::Fault(Fault::Unsuitable))?;
            if let Some(manifest) = launcher.manifest(folder, &plan).map_err(Ended::Refused)? {
                let _ = print(&manifest);
                return Err(Ended::Printed);
            }
            let known = run.results.iter().find(|result| result.stopped_by.is_early());
            let known = known.and_then(|result| Some((result.asked.text.as_str(), result.estimate?)));
            let told = |done: usize, over: bool| {
                let open = plan.shards.len() - done;
                let (running, failed) = if over { (0, open) } else { (open, 0) };
                self.progress.shards(
                    (plan.round, done, plan.shards.len()),
                    (running, failed + attempts.count()),
                    known,
                );
            };
            launcher.launch(folder, &plan, self.budget, &told).map_err(Ended::Refused)?;
            if !self.budget.must_stop() {
                let missing = folder.missing(&plan);
                parts::lost(&missing).into_iter().for_each(&mut *self.warn);
                missing.into_iter().for_each(|units| attempts.fail(units));
            }
        }
    }

    /// The results of what is there, with witnesses.
    fn finish(&mut self, folder: &PartsFolder, attempts: &Attempts) -> Result<CallResult, Ended> {
        let absent = match (self.budget.is_interrupted(), self.budget.is_over()) {
            (true, _) => Stop::Interrupt,
            (false, true) => Stop::Deadline,
            (false, false) => Stop::Missing,
        };
        self.call.explains = true;
        let (mut run, _) = self.read(folder, absent, false)?;
        run.interrupted = self.budget.is_interrupted();
        run.elapsed_s = self.budget.elapsed();
        let given_up: Vec<Unit> = attempts.given_up().cloned().collect();
        if !given_up.is_empty() {
            run.warnings.push(format!("no shard brought these back: {}", parts::words(&given_up)));
        }
        Ok(run)
    }

    /// Reads all parts; what it lacks.
    fn read(
        &mut self,
        folder: &PartsFolder,
        absent: Stop,
        warns: bool,
    ) -> Result<(CallResult, Vec<Unit>), Ended> {
        let heads = folder.heads();
        let reread = |part| folder.reread(part);
        let (stored, contradictions) = Stored::new(&heads, &reread, self.threads);
        for one in contradictions.iter().filter(|_| warns) {
            let [first, second] = one.parts.map(|part| folder.file(part));
            (self.warn)(parts::contradiction(first, second, &one.unit));
        }
        let mut budget = Budget::new(self.budget.max_trials, None);
        (budget.max_total, budget.absent) = (self.budget.max_total, absent);
        let run = run_study(self.study, &self.call, &stored, &budget, &Hushed(self.progress));
        Ok((run.map_err(Ended::Fault)?, stored.wanted()))
    }

    fn plan(
        &self,
        folder: &PartsFolder,
        before: Option<&Plan>,
        shards: Vec<Vec<Unit>>,
    ) -> Result<Option<Plan>, Ended> {
        if shards.is_empty() {
            return Ok(None);
        }
        let (round, max_trials) = (folder.next_round(before), self.budget.max_trials);
        let plan = Plan { origin: self.origin.clone(), round, max_trials, shards };
        folder.write_plan(&plan).map_err(Ended::Refused)?;
        Ok(Some(plan))
    }
}
