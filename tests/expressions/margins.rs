//! Margins of conditions: their sign is the truth, lane by lane.

use super::cases::{Hidden, state, truth};
use super::{AGENTS, scenario, scene};
use proptest::prelude::*;
use smc::base::lanes::Lanes;
use smc::compile::margin::margin;
use smc::kernel::{Code, Layout, Program, Readings, State};
use smc::model::Bool;
use std::sync::Arc;

/// A state of a trial that goes on: every coordinate is a number.
fn mended(mut state: State) -> State {
    for block in state.motion.x.iter_mut().chain(&mut state.motion.y) {
        *block = Lanes(block.0.map(|x| if x.is_nan() { 2.25 } else { x }));
    }
    state
}

fn check(layout: Layout, state: &State, atom: &Bool) -> Result<(), TestCaseError> {
    let scenario = scenario(AGENTS, scene());
    let mut program = Program::new(Arc::clone(&scenario));
    program.layout = layout;
    let code = Code::compile(&scenario, std::slice::from_ref(atom), &[margin(atom)]);
    let mut readings = Readings::default();
    code.run(&program, state, &mut readings);
    for trial in (state.occupied & !readings.unresolved).iter() {
        let (held, margin) = (readings.atoms[0].has(trial), readings.signals[0].0[trial]);
        prop_assert!(!margin.is_nan(), "lane {}", trial);
        prop_assert!(margin <= 0.0 || held, "lane {}: {} but false", trial, margin);
        prop_assert!(margin >= 0.0 || !held, "lane {}: {} but true", trial, margin);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_sign_of_a_margin_is_the_truth_in_eight_trials(
        Hidden(state) in state(Layout::Trials), atom in truth(0, 3),
    ) {
        check(Layout::Trials, &mended(state), &atom)?;
    }

    #[test]
    fn the_sign_of_a_margin_is_the_truth_in_one_trial(
        Hidden(state) in state(Layout::Agents), atom in truth(0, 3),
    ) {
        check(Layout::Agents, &mended(state), &atom)?;
    }
}
