//! Paths in continuous time: from jump to jump, each with the monitor of its formula and the robustness that is its level.
//!
//! A path may be continued from any stopping time. The level that a state forces as it begins counts from the jump to
//! that state; one that is forced while the state lasts (a window ends) counts from the next jump, which is known
//! by then. Times are the bits of seconds, which order as the seconds do.

use super::flock::{Flown, Landed, first_fault};
use super::path::Path;
use crate::base::instant::Instant;
use crate::base::lanes::{LANES, Mask};
use crate::engine::budget::Budget;
use crate::engine::fault::Fault;
use crate::engine::subject::Subject;
use crate::kernel::process::{Sight, View};
use crate::kernel::{Scratch, State, dynamics, start};
use crate::logic::{Invalid, Reading, SignalMonitor, SignalRobustness};

/// Rounds between two looks at the clock.
const CLOCK_EVERY: u32 = 256;

/// What a lane is busy with.
struct Busy {
    place: usize,
    /// Changes of the key that are done.
    changed: usize,
    /// When the state began that will be judged next, s.
    since: f64,
    flown: Flown,
}

/// A batch of lanes.
pub(super) struct Hopper {
    state: State,
    scratch: Scratch,
    view: View,
    sight: Sight,
    formulas: Vec<SignalMonitor>,
    levels: Vec<SignalRobustness>,
    busy: [Option<Busy>; LANES],
    most: u64,
}

impl Hopper {
    /// For a column that is a formula, and one that is the robustness that is its level.
    pub(super) fn new(subject: &Subject, columns: [usize; 2]) -> Result<Self, Invalid> {
        let [formula, level] = columns;
        Ok(Self {
            state: State::new(subject.program.layout, 0),
            scratch: Scratch::new(),
            view: subject.view(&columns),
            sight: Sight::default(),
            formulas: vec![subject.signal_monitor(formula)?; LANES],
            levels: vec![subject.signal_robustness(level)?.closely(); LANES],
            busy: [const { None }; LANES],
            most: subject.most_jumps,
        })
    }

    /// Runs paths until there are no more, or somebody or the clock says stop.
    pub(super) fn run<'p>(
        &mut self,
        subject: &Subject,
        paths: &[Path],
        take: &mut dyn FnMut() -> Option<(usize, &'p Path)>,
        budget: &Budget,
    ) -> (Landed, Option<(usize, Fault)>) {
        let program = &subject.program;
        let horizon = program.scenario.clock.seconds(subject.horizon);
        let (mut done, mut failed) = (Vec::new(), None);
        let (mut exhausted, mut rounds) = (false, 0u32);
        loop {
            self.load(subject, take, &mut exhausted, &mut done);
            if self.state.occupied.is_empty() {
                return (done, failed);
            }
            // Up to where the key changes.
            let mut until = [horizon; LANES];
            for lane in self.state.occupied.iter() {
                if let Some((from, _)) = self.change(paths, lane) {
                    until[lane] = from;
                }
            }
            let jumped = dynamics::jump_until(program, &mut self.state, &mut self.scratch, &until);
            let faulty = self.state.faulty & self.state.occupied;
            if !faulty.is_empty() {
                let place = |lane: usize| self.busy[lane].as_ref().map_or(0, |busy| busy.place);
                let after = first_fault(subject, &self.state, faulty, &place, &mut failed);
                exhausted = true;
                for lane in after.iter() {
                    self.busy[lane] = None;
                }
                self.state.occupied &= !after;
            }
            self.view.look(&self.state, &mut self.sight);
            for lane in self.state.occupied.iter() {
                if jumped.has(lane) {
                    self.observe(lane, Some(self.state.clocks.instant(lane)), &mut done);
                } else if let Some(change) = self.change(paths, lane).filter(|(from, _)| *from < horizon) {
                    dynamics::renew(program, &mut self.state, &mut self.scratch, lane, change);
                    if let Some(busy) = &mut self.busy[lane] {
                        busy.changed += 1;
                    }
                } else {
                    self.observe(lane, None, &mut done);
                }
            }
            rounds += 1;
            if budget.is_interrupted() || (rounds.is_multiple_of(CLOCK_EVERY) && budget.is_over()) {
                self.rest();
                return (done, failed);
            }
        }
    }

    /// When the key of a lane changes next, s, and to which.
    fn change(&self, paths: &[Path], lane: usize) -> Option<(f64, crate::base::random::TrialKey)> {
        let busy = self.busy[lane].as_ref()?;
        let (from, key) = paths[busy.place].changes.get(busy.changed)?;
        Some((f64::from_bits(*from), *key))
    }

    /// Begins paths in free lanes.
    fn load<'p>(
        &mut self,
        subject: &Subject,
        take: &mut dyn FnMut() -> Option<(usize, &'p Path)>,
        exhausted: &mut bool,
        done: &mut Landed,
    ) {
        let mut loaded = Mask::NONE;
        for lane in 0..LANES {
            while self.busy[lane].is_none() && !*exhausted {
                let Some((place, path)) = take() else {
                    *exhausted = true;
                    break;
                };
                if start::load(&subject.program, &mut self.state, lane, path.first, None).is_err() {
                    done.push((place, Flown { lost: true, ..Flown::default() }));
                    continue;
                }
                self.busy[lane] = Some(Busy { place, changed: 0, since: 0.0, flown: Flown::default() });
                loaded |= Mask::lane(lane);
            }
        }
        if loaded.is_empty() {
            return;
        }
        self.view.look(&self.state, &mut self.sight);
        for lane in loaded.iter() {
            let (atoms, signals) = self.view.of(&self.state, &mut self.sight, lane);
            self.formulas[lane].start();
            self.formulas[lane].jump(0.0, atoms, signals);
            self.levels[lane].start();
            self.levels[lane].jump(0.0, atoms, signals);
        }
    }

    /// What is under way is dropped.
    fn rest(&mut self) {
        self.busy = [const { None }; LANES];
        self.state.occupied = Mask::NONE;
    }

    /// The present state of a lane begins at a time, or its trial has come to the horizon: judges the state before. A path
    /// whose formula is decided ends.
    fn observe(&mut self, lane: usize, now: Option<Instant>, done: &mut Landed) {
        let Some(busy) = &mut self.busy[lane] else { return };
        let (formula, level) = (&mut self.formulas[lane], &mut self.levels[lane]);
        let (reading, bounds) = if let Some(now) = now {
            let (atoms, signals) = self.view.of(&self.state, &mut self.sight, lane);
            (formula.jump(now, atoms, signals), level.jump(now, atoms, signals))
        } else {
            (Some(formula.finish()), level.finish())
        };
        let jumps = self.state.clocks.jumps[lane];
        let (since, next) = (busy.since, now.map_or(f64::INFINITY, |now| now.seconds));
        // Only the verdict is the event itself.
        let finite = |level: f64| if level < f64::MAX { level } else { f64::MAX };
        let flight = &mut busy.flown.flight;
        flight.rise(since.to_bits(), finite(level.at_start()));
        if let Some(Reading::Truth(true)) = reading
            && formula.decided_at() <= since
        {
            flight.rise(since.to_bits(), f64::INFINITY);
        }
        flight.rise(next.to_bits(), finite(bounds.lower));
        if let Some(Reading::Truth(true)) = reading {
            flight.rise(next.to_bits(), f64::INFINITY);
        }
        let lost = match reading {
            Some(Reading::Truth(_)) => false,
            Some(_) => true,
            None => level.is_overfull() || jumps >= self.most,
        };
        if let (None, false, Some(now)) = (reading, lost, now) {
            busy.since = now.seconds;
            return;
        }
        busy.flown.lost = lost;
        (busy.flown.steps, busy.flown.ended) = (jumps, next.to_bits());
        if let Some(busy) = self.busy[lane].take() {
            done.push((busy.place, busy.flown));
        }
        self.state.occupied &= !Mask::lane(lane);
    }
}
