//! A batch: lanes that run one trial after the other.
//!
//! A lane whose trial is decided takes the next one while the others go on. Plain trials and paths of splitting, from step
//! to step and from jump to jump, differ only in the monitors that watch them.

use super::budget::{Budget, steps_between_looks};
use crate::base::lanes::{LANES, Mask};
use crate::kernel::{Address, Program, Run};

/// Jumps of a batch between two looks at the clock.
const JUMPS_BETWEEN_LOOKS: u32 = 256;

/// The monitors of all lanes: they watch the trials and keep the result of each.
pub trait Monitors {
    /// A trial begins in a lane; `shrunk` says whether radii were shrunk at its start.
    fn start(&mut self, lane: usize, shrunk: bool);

    /// Looks at the present states, of which those of `fresh` lanes are the first of their trials. The lanes whose trials
    /// are over.
    fn observe(&mut self, run: &Run<'_>, fresh: Mask) -> Mask;

    /// In continuous time, where a state is judged when the next one comes: new states begin in the lanes `moved`, and the
    /// other trials have reached the horizon. The lanes whose trials are over.
    fn follow(&mut self, _run: &Run<'_>, _moved: Mask) -> Mask {
        Mask::NONE
    }

    /// The trial of a lane is over; `place` is its place in the request.
    fn finish(&mut self, place: usize, lane: usize, run: &Run<'_>);

    /// The trial of a lane is cut by the budget: what it had is lost, unless it is kept here.
    fn cut(&mut self, _place: usize, _lane: usize) {}

    /// The trial at a place cannot start.
    fn refuse(&mut self, place: usize);
}

/// Lanes and their monitors.
pub struct Batch<'s, M> {
    run: Run<'s>,
    /// What watches the trials.
    pub monitors: M,
    /// The place in the request of the trial of each lane.
    places: [Option<usize>; LANES],
    /// Rounds between two looks at the clock.
    between_looks: u32,
    /// Steps or jumps made, of all lanes.
    pub steps: u64,
}

impl<'s, M: Monitors> Batch<'s, M> {
    /// An empty batch of trials of a program.
    pub fn new(program: &'s Program, monitors: M) -> Self {
        let between_looks = if program.scenario.clock.is_jumps() {
            JUMPS_BETWEEN_LOOKS
        } else {
            steps_between_looks(program.scenario.agents.len())
        };
        Self { run: Run::new(program), monitors, places: [None; LANES], between_looks, steps: 0 }
    }

    /// So many threads of the pool of the calling one share a large crowd.
    pub fn share(&mut self, threads: usize) {
        self.run.share(threads);
    }

    /// Runs trials until `next` gives no more, or the budget says stop; then unfinished trials are cut.
    pub fn run<'c>(&mut self, next: &mut dyn FnMut() -> Option<(usize, Address<'c>)>, budget: &Budget) {
        let (mut exhausted, mut rounds) = (false, 0u32);
        loop {
            let mut fresh = Mask::NONE;
            for lane in 0..self.run.width() {
                while self.places[lane].is_none() && !exhausted {
                    let Some((place, address)) = next() else {
                        exhausted = true;
                        break;
                    };
                    match self.run.load(lane, address) {
                        Ok(loaded) => {
                            self.monitors.start(lane, !loaded.shrunk.is_empty());
                            self.places[lane] = Some(place);
                            fresh |= Mask::lane(lane);
                        }
                        // A program elsewhere was stopped because the time is over: nothing is known of its trial.
                        Err(_) if budget.must_stop() => exhausted = true,
                        Err(_) => self.monitors.refuse(place),
                    }
                }
            }
            self.run.begin(fresh);
            if self.run.occupied().is_empty() {
                return;
            }
            let over = self.monitors.observe(&self.run, fresh);
            self.finish(over);
            rounds = rounds.wrapping_add(1);
            if budget.is_interrupted() || (rounds.is_multiple_of(self.between_looks) && budget.is_over()) {
                for (lane, place) in self.places.iter_mut().enumerate() {
                    if let Some(place) = place.take() {
                        self.monitors.cut(place, lane);
                    }
                }
                self.run.clear(Mask::ALL);
                return;
            }
            if !self.run.occupied().is_empty() {
                let moved = self.run.advance();
                self.steps += u64::from(moved.0.count_ones());
                let over = self.monitors.follow(&self.run, moved);
                self.finish(over);
            }
        }
    }

    fn finish(&mut self, over: Mask) {
        for lane in over.iter() {
            if let Some(place) = self.places[lane].take() {
                self.monitors.finish(place, lane, &self.run);
            }
        }
        self.run.clear(over);
    }
}
