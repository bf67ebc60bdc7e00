//! Witnesses: the first trial that fails and the first that passes, when that was decided, and by what.

use super::blame;
use super::outcome::Witness;
use super::session::Call;
use super::subject::Subject;
use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::base::tick::{Clock, Tick};
use crate::compile::study::Root;
use crate::kernel::{Readings, Scratch, State, dynamics, start};

/// The witnesses of a column: `first` holds the first failing and the first passing trial.
pub(super) fn find(
    subject: &Subject,
    column: usize,
    advice: Option<(usize, usize)>,
    first: [Option<u64>; 2],
    call: &Call<'_>,
    settings: &[(String, String)],
) -> Vec<Witness> {
    let mut found = Vec::new();
    if matches!(subject.columns[column], Root::Robustness(..)) {
        // No atom decides how far a formula is from changing.
        return found;
    }
    for (passing, trial) in [(false, first[0]), (true, first[1])] {
        if let Some(trial) = trial
            && let Some(witness) = witness(subject, column, advice, trial, passing, call, settings)
        {
            found.push(witness);
        }
    }
    found
}

/// Runs one trial again and says what decided it.
fn witness(
    subject: &Subject,
    column: usize,
    advice: Option<(usize, usize)>,
    trial: u64,
    passing: bool,
    call: &Call<'_>,
    settings: &[(String, String)],
) -> Option<Witness> {
    let program = &subject.program;
    let code = subject.code(&[column]);
    let mut monitor = subject.monitor(column).ok()?;
    let mut state = State::new(program.layout, program.scenario.agents.len());
    let mut scratch = Scratch::new();
    let mut readings = Readings::default();
    let key = TrialKey { seed: call.seed, index: trial, branch: 0 };
    start::load(program, &mut state, 0, key, advice).ok()?;
    let lane = Mask::lane(0);
    dynamics::refresh(program, &mut state, &mut scratch, lane);
    monitor.start(0);
    let mut record = blame::Record::default();
    let mut states: Vec<State> = Vec::new();
    let kept = if program.scenario.agents.len() <= LARGEST_KEPT { KEPT } else { 0 };
    loop {
        code.run(program, &state, &mut readings);
        monitor.observe(lane, &readings.atoms, &readings.signals);
        record.push(&readings);
        if states.len() < kept {
            states.push(state.clone());
        }
        if monitor.decided().has(0) || state.ticks[0] >= subject.horizon.0 || !state.diverged.is_empty() {
            break;
        }
        dynamics::step(program, &mut state, &mut scratch);
    }
    let decided = monitor.decided_at()[0];
    let time = program.scenario.clock.seconds(Tick(decided));
    let what = blame::reasons(subject, column, &record, |tick| {
        // States beyond those kept are made again.
        states.get(tick as usize).cloned().or_else(|| replay(subject, key, advice, tick))
    });
    let mut command = call.simulate.clone();
    for (name, value) in settings {
        command.push_str(&format!(" --set '{name}={value}'"));
    }
    command.push_str(&format!(" --seed {} --trial {trial}", call.seed));
    if let Some((declaration, option)) = advice {
        let label = &program.scenario.moves.get(declaration)?.options.get(option)?.0;
        command.push_str(&format!(" --move '{label}'"));
    }
    let unit = if program.scenario.clock == Clock::Steps { "steps" } else { "s" };
    Some(Witness { passing, trial, time, unit, what, command })
}

/// States kept while a witness is run; those of large crowds are made again instead.
const KEPT: usize = 64;
/// Agents above which no states are kept.
const LARGEST_KEPT: usize = 256;

/// The state of a trial at a tick.
fn replay(subject: &Subject, key: TrialKey, advice: Option<(usize, usize)>, tick: u64) -> Option<State> {
    let program = &subject.program;
    let mut state = State::new(program.layout, program.scenario.agents.len());
    let mut scratch = Scratch::new();
    start::load(program, &mut state, 0, key, advice).ok()?;
    dynamics::refresh(program, &mut state, &mut scratch, Mask::lane(0));
    for _ in 0..tick {
        dynamics::step(program, &mut state, &mut scratch);
    }
    Some(state)
}
