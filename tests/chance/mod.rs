//! Behaviours and sources: against what can be worked out by hand, and what they must not change.

mod arrivals;
mod behaviours;
mod draws;
mod groups;
mod presence;
mod reuse;
mod turns;

pub(crate) use crate::texts::answered;
use smc::base::lanes::{LANES, Mask};
use smc::base::random::TrialKey;
use smc::compile::Study;
use smc::kernel::{Layout, Program, Scratch, State, dynamics, start};
use smc::model::Parameter;
use smc::model::Scenario;
use std::sync::Arc;

/// Compiles two texts that are right.
pub(crate) fn compiled(scenario: &str, properties: &str) -> Study {
    crate::texts::compiled(scenario, properties).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The scenario of a text.
pub(crate) fn scenario(text: &str) -> Arc<Scenario> {
    compiled(text, "").worlds[0].scenario.clone()
}

/// A batch of trials under way.
pub(crate) struct Batch {
    pub(crate) program: Program,
    pub(crate) state: State,
    pub(crate) scratch: Scratch,
}

impl Batch {
    /// Trials `first`, `first + 1`, … in all lanes.
    pub(crate) fn new(scenario: &Arc<Scenario>, layout: Layout, first: u64) -> Self {
        let width = if layout == Layout::Trials { LANES } else { 1 };
        Self::of(scenario, layout, (0..width).map(|lane| (lane, first + lane as u64)), None)
    }

    /// Given trials in given lanes.
    pub(crate) fn of(
        scenario: &Arc<Scenario>,
        layout: Layout,
        trials: impl Iterator<Item = (usize, u64)>,
        advice: Option<(usize, usize)>,
    ) -> Self {
        let mut program = Program::new(scenario.clone());
        program.layout = layout;
        let state = State::new(layout, scenario.agents.len());
        let mut batch = Self { program, state, scratch: Scratch::default() };
        let mut lanes = Mask::NONE;
        for (lane, index) in trials {
            let key = TrialKey { seed: 9, index, branch: 0 };
            start::load(&batch.program, &mut batch.state, lane, key, advice).unwrap();
            lanes |= Mask::lane(lane);
        }
        dynamics::refresh(&batch.program, &mut batch.state, &mut batch.scratch, lanes);
        batch
    }

    pub(crate) fn step(&mut self) {
        dynamics::step(&self.program, &mut self.state, &mut self.scratch);
        assert!(self.state.faulty.is_empty() && self.state.diverged.is_empty());
    }

    /// Bits of what one sees of an agent.
    pub(crate) fn bits(&self, agent: usize, lane: usize) -> Vec<u64> {
        let s = &self.state;
        let slot = s.slot(agent, lane);
        let fields = [
            &s.motion.x,
            &s.motion.y,
            &s.motion.vx,
            &s.motion.vy,
            &s.driving.ex,
            &s.driving.ey,
            &s.driving.speed,
            &s.bodies[Parameter::Speed],
            &s.bodies[Parameter::Radius],
            &s.motion.travelled,
        ];
        fields.iter().map(|field| field[slot.block].0[slot.lane].to_bits()).collect()
    }

    /// State of a behaviour.
    pub(crate) fn mode(&self, behaviour: usize, agent: usize, lane: usize) -> f64 {
        let slot = self.state.slot(agent, lane);
        self.state.behaviours.modes[behaviour][slot.block].0[slot.lane]
    }

    pub(crate) fn present(&self, agent: usize, lane: usize) -> bool {
        let slot = self.state.slot(agent, lane);
        self.state.present[slot.block].has(slot.lane)
    }
}

/// Place of an agent of a name.
pub(crate) fn agent(scenario: &Scenario, name: &str) -> usize {
    scenario.agents.iter().position(|agent| agent.name == name).unwrap()
}

/// Whether a mean fits: five and a half standard deviations.
pub(crate) fn near(found: f64, expected: f64, sd: f64, n: f64) -> bool {
    (found - expected).abs() <= 5.5 * sd / n.sqrt()
}

/// People who keep out of each other's way.
pub(crate) const HEAD: &str = "horizon = 60 s\nstep = 0.02 s\n\
    kind adult: sfm preset helbing2000 { noise = 0.05 m/s }\n\
    scene { region west: rect (-300, -5) .. (-290, 40)\n region near: rect (0, -5) .. (2, 40) }\n";
