//! Paths in lanes: each with the monitor of its formula and the robustness that is its level.

use super::hopper::Hopper;
use super::path::Path;
use crate::base::lanes::{LANES, Mask};
use crate::engine::budget::{Budget, steps_between_looks};
use crate::engine::executor::Executor;
use crate::engine::fault::Fault;
use crate::engine::flaw::Flaw;
use crate::engine::observer::Observer;
use crate::engine::subject::{Subject, lost};
use crate::kernel::{Code, Readings, Scratch, State, dynamics, start};
use crate::logic::{Needs, Robustness};
use crate::stats::splitting::Flight;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// What a path came to.
#[derive(Clone, Debug, Default)]
pub(super) struct Flown {
    /// Its levels.
    pub(super) flight: Flight,
    /// Steps of the model, those up to where it branched off included.
    pub(super) steps: u64,
    /// When it ended.
    pub(super) ended: u64,
    /// Whether it diverged, or its formula had no truth.
    pub(super) lost: bool,
}

impl Flown {
    /// What it came to, where a lost path is read as reaching the event, or as not.
    pub(super) fn read(self, lost_reaches: bool) -> Flight {
        let mut flight = self.flight;
        if self.lost && lost_reaches {
            flight.rise(self.ended, f64::INFINITY);
        }
        flight
    }
}

/// Paths that came to an end, by their places.
pub(super) type Landed = Vec<(usize, Flown)>;

/// What a lane is busy with.
struct Busy {
    place: usize,
    /// Changes of the key that are done.
    changed: usize,
    flown: Flown,
}

/// A batch of lanes.
struct Bird {
    state: State,
    scratch: Scratch,
    formula: (Code, Observer),
    level: (Code, Robustness),
    readings: [Readings; 2],
    /// When the formula and its level look at what.
    needs: Needs,
    /// Whether the formula follows single people of a source.
    follows: bool,
    busy: [Option<Busy>; LANES],
}

/// A batch, as the clock needs it.
enum Batch {
    Steps(Box<Bird>),
    Jumps(Box<Hopper>),
}

impl Batch {
    fn run<'p>(
        &mut self,
        subject: &Subject,
        paths: &[Path],
        take: &mut dyn FnMut() -> Option<(usize, &'p Path)>,
        budget: &Budget,
    ) -> (Landed, Option<(usize, Fault)>) {
        match self {
            Self::Steps(bird) => bird.run(subject, paths, take, budget),
            Self::Jumps(hopper) => hopper.run(subject, paths, take, budget),
        }
    }
}

/// Batches that are warm, for one formula of a subject.
pub(super) struct Flock<'s> {
    subject: &'s Subject,
    /// Column of the formula, and of the robustness that is its level.
    columns: [usize; 2],
    batches: Mutex<Vec<Batch>>,
}

impl<'s> Flock<'s> {
    pub(super) const fn new(subject: &'s Subject, columns: [usize; 2]) -> Self {
        Self { subject, columns, batches: Mutex::new(Vec::new()) }
    }

    fn batch(&self) -> Result<Batch, Fault> {
        if let Some(warm) = self.batches.lock().ok().and_then(|mut list| list.pop()) {
            return Ok(warm);
        }
        let (subject, [formula, level]) = (self.subject, self.columns);
        let program = &subject.program;
        if program.scenario.clock.is_jumps() {
            return Ok(Batch::Jumps(Box::new(Hopper::new(subject, self.columns)?)));
        }
        Ok(Batch::Steps(Box::new(Bird {
            state: State::new(program.layout, program.scenario.agents.len()),
            scratch: Scratch::new(),
            formula: (subject.code(&[formula]), subject.observer(formula)?),
            level: (subject.code(&[level]), subject.robustness(level)?),
            readings: [Readings::default(), Readings::default()],
            needs: subject.needs(&[formula, level])?,
            follows: subject.follows(formula),
            busy: [const { None }; LANES],
        })))
    }

    /// Runs all paths; `None` where somebody or the clock said stop first. Which thread and which lane runs a path leaves
    /// no trace.
    pub(super) fn fly(
        &self,
        paths: &[Path],
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<Option<Vec<Flown>>, Fault> {
        let next = AtomicUsize::new(0);
        let broken = AtomicBool::new(false);
        let done: Mutex<Landed> = Mutex::new(Vec::with_capacity(paths.len()));
        let failed: Mutex<Option<(usize, Fault)>> = Mutex::new(None);
        // Places are handed out in order, and each batch ends those before the one that failed: of several faults the first
        // is told, whichever thread met it.
        let fail = |place: usize, fault: Fault| {
            broken.store(true, Ordering::Relaxed);
            if let Ok(mut first) = failed.lock()
                && first.as_ref().is_none_or(|(at, _)| place < *at)
            {
                *first = Some((place, fault));
            }
        };
        executor.everywhere(&|| {
            let mut take = || {
                if broken.load(Ordering::Relaxed) || budget.must_stop() {
                    return None;
                }
                let place = next.fetch_add(1, Ordering::Relaxed);
                paths.get(place).map(|path| (place, path))
            };
            match self.batch() {
                Ok(mut batch) => {
                    let (flown, fault) = batch.run(self.subject, paths, &mut take, budget);
                    if let Ok(mut list) = done.lock() {
                        list.extend(flown);
                    }
                    if let Some((place, fault)) = fault {
                        fail(place, fault);
                    }
                    if let Ok(mut list) = self.batches.lock() {
                        list.push(batch);
                    }
                }
                Err(fault) => fail(0, fault),
            }
        });
        if let Ok(Some((_, fault))) = failed.into_inner() {
            return Err(fault);
        }
        let mut list = done.into_inner().unwrap_or_default();
        if list.len() < paths.len() {
            return Ok(None);
        }
        list.sort_unstable_by_key(|(place, _)| *place);
        Ok(Some(list.into_iter().map(|(_, flown)| flown).collect()))
    }
}

/// Keeps the fault of the first of the paths that are found to be faulty. Which lanes are left: theirs, and those of later
/// paths; the earlier ones go on, in case they are faulty too.
pub(super) fn first_fault(
    subject: &Subject,
    state: &State,
    faulty: Mask,
    place: &dyn Fn(usize) -> usize,
    failed: &mut Option<(usize, Fault)>,
) -> Mask {
    for lane in faulty.iter() {
        if failed.as_ref().is_some_and(|(first, _)| *first < place(lane)) {
            continue;
        }
        let moment = "in a path of splitting".to_owned();
        let value = |k: usize| state.variables[k].0[lane];
        let fault = state.faults[lane].map_or(Fault::Unsuitable, |fault| {
            let flaw = Flaw::of(fault, &subject.program.scenario, &subject.origins, moment, value);
            Fault::Model(Box::new(flaw))
        });
        *failed = Some((place(lane), fault));
    }
    let first = failed.as_ref().map_or(usize::MAX, |(first, _)| *first);
    state
        .occupied
        .iter()
        .filter(|lane| place(*lane) >= first)
        .map(Mask::lane)
        .fold(faulty, |all, lane| all | lane)
}

impl Bird {
    fn run<'p>(
        &mut self,
        subject: &Subject,
        paths: &[Path],
        take: &mut dyn FnMut() -> Option<(usize, &'p Path)>,
        budget: &Budget,
    ) -> (Landed, Option<(usize, Fault)>) {
        let program = &subject.program;
        let (mut done, mut failed) = (Vec::new(), None);
        let (mut exhausted, mut rounds) = (false, 0u32);
        let clock_every = steps_between_looks(program.scenario.agents.len());
        loop {
            let mut loaded = Mask::NONE;
            for lane in 0..self.state.width() {
                while self.busy[lane].is_none() && !exhausted {
                    let Some((place, path)) = take() else {
                        exhausted = true;
                        break;
                    };
                    if start::load(program, &mut self.state, lane, path.first, None).is_err() {
                        done.push((place, Flown { lost: true, ..Flown::default() }));
                        continue;
                    }
                    self.busy[lane] = Some(Busy { place, changed: 0, flown: Flown::default() });
                    loaded |= Mask::lane(lane);
                    self.formula.1.start(lane);
                    self.level.1.start(lane);
                }
            }
            if !loaded.is_empty() {
                dynamics::refresh(program, &mut self.state, &mut self.scratch, loaded);
            }
            if self.state.occupied.is_empty() {
                return (done, failed);
            }
            let faulty = self.state.faulty & self.state.occupied;
            if !faulty.is_empty() {
                let place = |lane: usize| self.busy[lane].as_ref().map_or(0, |busy| busy.place);
                let after = first_fault(subject, &self.state, faulty, &place, &mut failed);
                exhausted = true;
                for lane in after.iter() {
                    self.busy[lane] = None;
                }
                self.state.occupied &= !after;
                continue;
            }
            self.observe(subject, &mut done);
            rounds += 1;
            if budget.is_interrupted() || (rounds.is_multiple_of(clock_every) && budget.is_over()) {
                self.rest();
                return (done, failed);
            }
            for lane in self.state.occupied.iter() {
                let Some(busy) = &mut self.busy[lane] else { continue };
                let changes = &paths[busy.place].changes;
                while let Some((_, key)) =
                    changes.get(busy.changed).filter(|(from, _)| *from <= self.state.ticks[lane])
                {
                    self.state.keys[lane] = *key;
                    busy.changed += 1;
                }
            }
            if !self.state.occupied.is_empty() {
                dynamics::step(program, &mut self.state, &mut self.scratch);
            }
        }
    }

    /// What is under way is dropped.
    fn rest(&mut self) {
        self.busy = [const { None }; LANES];
        self.state.occupied = Mask::NONE;
    }

    /// Reads the present states; paths whose formula is decided end.
    fn observe(&mut self, subject: &Subject, done: &mut Landed) {
        let [of_formula, of_level] = &mut self.readings;
        self.formula.0.run(&subject.program, &self.state, of_formula);
        self.level.0.run(&subject.program, &self.state, of_level);
        let occupied = self.state.occupied;
        // Without a value where one is needed, nothing more can be said.
        let mut ended = self.state.diverged | self.state.queues.full;
        if self.follows {
            ended |= self.state.queues.reused;
        }
        let ticks = &self.state.ticks;
        let missed = lost(&self.needs, of_formula, ticks) | lost(&self.needs, of_level, ticks);
        let lost = (ended | missed) & occupied;
        let watched = occupied & !lost;
        self.formula.1.observe(watched, of_formula);
        self.level.1.observe(watched, &[], &of_level.signals);
        let decided = self.formula.1.decided() & watched;
        let levels = self.level.1.lower();
        for lane in occupied.iter() {
            let Some(busy) = &mut self.busy[lane] else { continue };
            let time = self.state.ticks[lane];
            if lost.has(lane) {
                busy.flown.lost = true;
            } else {
                let level = levels.0[lane];
                // Only the verdict is the event itself.
                busy.flown.flight.rise(time, if level < f64::MAX { level } else { f64::MAX });
                if !decided.has(lane) {
                    continue;
                }
                if matches!(self.formula.1.reading(lane), crate::engine::cell::Reading::Truth(true)) {
                    busy.flown.flight.rise(time, f64::INFINITY);
                }
            }
            (busy.flown.steps, busy.flown.ended) = (time, time);
            if let Some(busy) = self.busy[lane].take() {
                done.push((busy.place, busy.flown));
            }
            self.state.occupied &= !Mask::lane(lane);
        }
    }
}
