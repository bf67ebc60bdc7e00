//! Doors that open and close during a trial.
//!
//! Conditions look at the state before a step, as processes do (`watch`); what follows from them, and from times, holds from the
//! state after the step on (`turn`). A body in the doorway keeps a door open. When a door has changed, everybody who is on a way
//! looks for it anew.

use super::code::{Code, Readings};
use super::driver::{self, Drive};
use super::state::State;
use crate::base::geometry::{Segment, Vec2};
use crate::base::lanes::{Lanes, Mask};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::tick::steps_over;
use crate::kernel::layout::Layout;
use crate::model::door::Shut;
use crate::model::{Bool, Law, Obstacle, Parameter, Scenario};

/// A door that may change.
#[derive(Clone, Debug)]
struct Leaf {
    pieces: Vec<Segment>,
    entity: u32,
    /// The atom of its condition.
    atom: Option<usize>,
    /// When it opens and when it closes, s.
    times: [Option<Law>; 2],
}

/// The doors of a scenario that may change, made ready to run.
#[derive(Clone, Debug, Default)]
pub struct Doors {
    leaves: Vec<Leaf>,
    /// The conditions.
    code: Option<Code>,
    dt: f64,
}

impl Doors {
    /// Those of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let mut atoms: Vec<Bool> = Vec::new();
        let leaves = scenario.scene.doors.iter().zip(&scenario.doors).map(|(barrier, door)| {
            let pieces = match &scenario.scene.barriers[barrier.0 as usize].obstacle {
                Obstacle::Wall(pieces) => pieces.clone(),
                Obstacle::Solid(_) => Vec::new(),
            };
            let (atom, times) = match &door.shut {
                Shut::While(condition) => {
                    atoms.push(condition.clone());
                    (Some(atoms.len() - 1), [None, None])
                }
                Shut::Times { opens, closes } => (None, [opens.clone(), closes.clone()]),
            };
            Leaf { pieces, entity: door.entity, atom, times }
        });
        let leaves = leaves.collect();
        let code = (!atoms.is_empty()).then(|| Code::compile(scenario, &atoms, &[]));
        Self { leaves, code, dt: scenario.clock.step_seconds() }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Puts the doors into the state in which a trial begins. Its variables must be in the state.
    pub(super) fn load(&self, state: &mut State, lane: usize, key: TrialKey) {
        if self.is_empty() {
            return;
        }
        state.doors.times.resize(self.leaves.len(), [Lanes::ZERO; 2]);
        for (leaf, times) in self.leaves.iter().zip(&mut state.doors.times) {
            let stream = Stream::of(key, leaf.entity, Purpose::Door);
            for (draw, (law, time)) in (0..).zip(leaf.times.iter().zip(times)) {
                time.0[lane] = law.as_ref().map_or(f64::INFINITY, |law| {
                    let ticks = steps_over(law.draw(stream.uniform(draw)), self.dt);
                    if ticks > 0.0 { ticks } else { 0.0 }
                });
            }
        }
        let mut readings = Readings::default();
        if let Some(code) = &self.code {
            code.read(state.layout, state, &mut readings);
        }
        let shut = (0..self.leaves.len()).filter(|&door| self.shuts(door, state, lane, 0.0, &readings));
        state.doors.sets[lane] = shut.fold(0, |set, door| set | 1 << door);
    }

    /// Whether a door is to be closed at a tick.
    fn shuts(&self, door: usize, state: &State, lane: usize, tick: f64, readings: &Readings) -> bool {
        if let Some(atom) = self.leaves[door].atom {
            return readings.atoms[atom].has(lane);
        }
        let [opens, closes] = state.doors.times[door].map(|times| times.0[lane]);
        match (tick >= opens, tick >= closes) {
            (false, false) => opens < closes,
            (true, true) => closes > opens,
            (_, closed) => closed,
        }
    }

    /// Looks at the state before a step.
    pub(super) fn watch(&self, layout: Layout, state: &State, readings: &mut Readings) {
        if let Some(code) = &self.code {
            code.read(layout, state, readings);
        }
    }

    /// Opens and closes doors in the state after a step, whose positions and ticks are in the state.
    pub(super) fn turn(&self, drive: &Drive, state: &mut State, readings: &Readings) {
        for lane in if self.is_empty() { Mask::NONE } else { state.occupied & !state.faulty }.iter() {
            let (tick, before) = (state.ticks[lane] as f64, state.doors.sets[lane]);
            let mut set = before;
            for (door, leaf) in self.leaves.iter().enumerate() {
                let (is_shut, bit) = (self.shuts(door, state, lane, tick, readings), 1 << door);
                if !is_shut {
                    set &= !bit;
                } else if set & bit == 0 && !leaf.is_occupied(state, lane) {
                    set |= bit;
                }
            }
            if set != before {
                state.doors.sets[lane] = set;
                driver::look_for_ways(drive, state, lane);
            }
        }
    }
}

impl Leaf {
    /// Whether the body of anybody in a trial is in the doorway.
    fn is_occupied(&self, state: &State, lane: usize) -> bool {
        (0..state.agents).any(|agent| {
            let slot = state.slot(agent, lane);
            let of = |field: &[Lanes]| field[slot.block].0[slot.lane];
            let at = Vec2::new(of(&state.motion.x), of(&state.motion.y));
            let radius = of(&state.bodies[Parameter::Radius]);
            state.present[slot.block].has(slot.lane)
                && self.pieces.iter().any(|piece| piece.distance(at) < radius)
        })
    }
}
