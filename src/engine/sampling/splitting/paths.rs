//! The monitors of paths of splitting: each path has that of its formula, and the robustness that is its level.

use crate::base::instant::Instant;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::engine::fault::Fault;
use crate::engine::trials::prepared::PreparedWorld;
use crate::engine::trials::trial::flaw;
use crate::kernel::process::{View, ViewReadings};
use crate::kernel::{End, Run};
use crate::logic::{self, Invalid, SignalMonitor, SignalRobustness};
use crate::stats::splitting::Flight;
use crate::trials::batch::Monitors;
use crate::trials::cell::Reading;
use crate::trials::group::ColumnGroup;
use crate::trials::observer::Observer;

/// The result of a path.
#[derive(Clone, Debug, Default)]
pub(super) struct PathResult {
    /// Its levels.
    pub(super) flight: Flight,
    /// Steps of the model, those up to where it branched off included.
    pub(super) steps: u64,
    /// When it ended.
    pub(super) ended: u64,
    /// Whether it diverged, or its formula had no truth.
    pub(super) lost: bool,
}

impl PathResult {
    /// Its levels, where a lost path is read as reaching the event, or as not.
    pub(super) fn read(self, lost_reaches: bool) -> Flight {
        let mut flight = self.flight;
        if self.lost && lost_reaches {
            flight.rise(self.ended, f64::INFINITY);
        }
        flight
    }
}

/// Paths that came to an end, by their places; or the model is wrong in them.
pub(super) type Ended = Vec<(usize, Result<PathResult, Fault>)>;

/// The paths of all lanes.
type PathLanes = [PathResult; LANES];

/// What watches the paths of all lanes.
trait PathWatch {
    /// A path begins in a lane.
    fn start(&mut self, lane: usize);

    /// Looks at the present states, as a monitor does.
    fn observe(&mut self, paths: &mut PathLanes, run: &Run<'_>, fresh: Mask) -> Mask;

    /// Judges the states before, as a monitor does.
    fn follow(&mut self, _: &mut PathLanes, _: &Run<'_>, _moved: Mask) -> Mask {
        Mask::NONE
    }
}

/// The paths of all lanes, and those that ended.
pub(super) struct Paths<'s> {
    prepared: &'s PreparedWorld,
    watch: Box<dyn PathWatch + Send + 's>,
    lanes: PathLanes,
    /// Paths that came to an end.
    pub(super) ended: Ended,
}

impl<'s> Paths<'s> {
    /// For a column that is a formula, and one that is the robustness that is its level.
    pub(super) fn new(prepared: &'s PreparedWorld, columns: [usize; 2]) -> Result<Self, Invalid> {
        let watch: Box<dyn PathWatch + Send + 's> = if prepared.program.scenario.clock.is_jumps() {
            Box::new(EventPaths::new(prepared, columns)?)
        } else {
            Box::new(StepPaths { group: ColumnGroup::of(prepared, &columns)? })
        };
        Ok(Self { prepared, watch, lanes: Default::default(), ended: Vec::new() })
    }
}

impl Monitors for Paths<'_> {
    fn start(&mut self, lane: usize, _: bool) {
        self.lanes[lane] = PathResult::default();
        self.watch.start(lane);
    }

    fn observe(&mut self, run: &Run<'_>, fresh: Mask) -> Mask {
        self.watch.observe(&mut self.lanes, run, fresh)
    }

    fn follow(&mut self, run: &Run<'_>, moved: Mask) -> Mask {
        self.watch.follow(&mut self.lanes, run, moved)
    }

    fn finish(&mut self, place: usize, lane: usize, run: &Run<'_>) {
        let result = match run.end(lane) {
            Some(End::Faulty(fault)) => {
                Err(flaw(self.prepared, fault, (run.state(), lane), "in a path of splitting".to_owned()))
            }
            _ => Ok(std::mem::take(&mut self.lanes[lane])),
        };
        self.ended.push((place, result));
    }

    fn refuse(&mut self, place: usize) {
        self.ended.push((place, Ok(PathResult { lost: true, ..PathResult::default() })));
    }
}

/// Only the verdict is the event itself.
fn finite(level: f64) -> f64 {
    if level < f64::MAX { level } else { f64::MAX }
}

/// From step to step.
struct StepPaths {
    /// The formula and its level.
    group: ColumnGroup,
}

impl PathWatch for StepPaths {
    fn start(&mut self, lane: usize) {
        self.group.start(lane);
    }

    fn observe(&mut self, paths: &mut PathLanes, run: &Run<'_>, _: Mask) -> Mask {
        let state = run.state();
        let occupied = run.occupied();
        let gone = if self.group.follows[0] { state.queues.reused } else { Mask::NONE };
        let lost = (self.group.read(run) | run.ended() | gone) & occupied;
        let watched = occupied & !lost;
        for observer in &mut self.group.observers {
            observer.observe(watched, &self.group.readings);
        }
        let [formula, level] = self.group.observers.as_slice() else { return occupied };
        let decided = formula.decided() & watched;
        let levels = match level {
            Observer::Robustness(robustness, _) => robustness.lower(),
            Observer::Formula(_) | Observer::Metric(_) => Lanes::ZERO,
        };
        for lane in occupied.iter() {
            let path = &mut paths[lane];
            let time = state.ticks[lane];
            path.lost = lost.has(lane);
            if !path.lost {
                path.flight.rise(time, finite(levels.0[lane]));
            }
            if decided.has(lane) && formula.reading(lane) == Reading::Truth(true) {
                path.flight.rise(time, f64::INFINITY);
            }
            (path.steps, path.ended) = (time, time);
        }
        decided | lost
    }
}

/// From jump to jump.
///
/// A path may be continued from any stopping time. The level that a state forces as it begins counts from the jump to
/// that state; one that is forced while the state lasts (a window ends) counts from the next jump, which is known
/// by then. Times are the bits of seconds, which order as the seconds do.
struct EventPaths {
    view: View,
    seen: ViewReadings,
    formulas: Vec<SignalMonitor>,
    levels: Vec<SignalRobustness>,
    /// When the state of each lane began that will be judged next, s.
    since: [f64; LANES],
    most_jumps: u64,
}

impl EventPaths {
    fn new(prepared: &PreparedWorld, columns: [usize; 2]) -> Result<Self, Invalid> {
        let [formula, level] = columns;
        Ok(Self {
            view: prepared.view(&columns),
            seen: ViewReadings::default(),
            formulas: vec![prepared.signal_monitor(formula)?; LANES],
            levels: vec![prepared.signal_robustness(level)?.closely(); LANES],
            since: [0.0; LANES],
            most_jumps: prepared.most_jumps,
        })
    }

    /// The present state of a lane begins at a time, or its trial has reached the horizon: judges the state before.
    /// Whether the path is over.
    fn judge(&mut self, path: &mut PathResult, run: &Run<'_>, lane: usize, now: Option<Instant>) -> bool {
        let (formula, level) = (&mut self.formulas[lane], &mut self.levels[lane]);
        let (reading, bounds) = if let Some(now) = now {
            let (atoms, signals) = self.view.of(run.state(), &mut self.seen, lane);
            (formula.jump(now, atoms, signals), level.jump(now, atoms, signals))
        } else {
            (Some(formula.finish()), level.finish())
        };
        let jumps = run.state().clocks.jumps[lane];
        let (since, next) = (self.since[lane], now.map_or(f64::INFINITY, |now| now.seconds));
        let flight = &mut path.flight;
        flight.rise(since.to_bits(), finite(level.at_start()));
        if let Some(logic::Reading::Truth(true)) = reading
            && formula.decided_at() <= since
        {
            flight.rise(since.to_bits(), f64::INFINITY);
        }
        flight.rise(next.to_bits(), finite(bounds.lower));
        if let Some(logic::Reading::Truth(true)) = reading {
            flight.rise(next.to_bits(), f64::INFINITY);
        }
        path.lost = match reading {
            Some(logic::Reading::Truth(_)) => false,
            Some(_) => true,
            None => level.is_overfull() || jumps >= self.most_jumps,
        };
        (path.steps, path.ended, self.since[lane]) = (jumps, next.to_bits(), next);
        reading.is_some() || path.lost
    }
}

impl PathWatch for EventPaths {
    fn start(&mut self, lane: usize) {
        self.since[lane] = 0.0;
    }

    fn observe(&mut self, _: &mut PathLanes, run: &Run<'_>, fresh: Mask) -> Mask {
        if !fresh.is_empty() {
            self.view.look(run.state(), &mut self.seen);
        }
        for lane in fresh.iter() {
            let (atoms, signals) = self.view.of(run.state(), &mut self.seen, lane);
            self.formulas[lane].start();
            self.formulas[lane].jump(0.0, atoms, signals);
            self.levels[lane].start();
            self.levels[lane].jump(0.0, atoms, signals);
        }
        Mask::NONE
    }

    fn follow(&mut self, paths: &mut PathLanes, run: &Run<'_>, moved: Mask) -> Mask {
        self.view.look(run.state(), &mut self.seen);
        let mut over = run.ended();
        for lane in (run.occupied() & !over).iter() {
            let now = moved.has(lane).then(|| run.state().clocks.instant(lane));
            over |= if self.judge(&mut paths[lane], run, lane, now) { Mask::lane(lane) } else { Mask::NONE };
        }
        over
    }
}
