//! What decided a trial in continuous time: it is run again, and the atoms that changed at the decision are named.

use super::subject::Subject;
use super::words;
use crate::base::random::TrialKey;
use crate::kernel::process::Sight;
use crate::kernel::{Scratch, State, dynamics, start};
use crate::logic::Reading;

/// Most atoms that are named.
const NAMED: usize = 3;

/// When a trial was decided, s, the value of a metric, SI, and what decided it; in words, empty where it was time
/// alone. `unit` is that of a metric.
pub(super) fn decision(
    subject: &Subject,
    column: usize,
    trial: u64,
    seed: u64,
    unit: &str,
) -> Option<(f64, Option<f64>, String)> {
    let program = &subject.program;
    let view = subject.view(&[column]);
    let mut monitor = subject.signal_monitor(column).ok()?;
    let (mut state, mut scratch) = (State::new(program.layout, 0), Scratch::new());
    let mut sight = Sight::default();
    start::load(program, &mut state, 0, TrialKey { seed, index: trial, branch: 0 }, None).ok()?;
    // Every state in which an atom changed, and the time from which on it held.
    let mut states: Vec<(f64, Vec<bool>)> = Vec::new();
    loop {
        view.look(&state, &mut sight);
        let (atoms, signals) = view.of(&state, &mut sight, 0);
        let now = state.clocks.now[0];
        if states.last().is_none_or(|last| last.1 != atoms) {
            states.push((now, atoms.to_vec()));
        }
        if monitor.jump(now, atoms, signals).is_some() || !state.faulty.is_empty() {
            break;
        }
        if dynamics::jump(program, &mut state, &mut scratch).is_empty() {
            monitor.finish();
            break;
        }
    }
    let at = monitor.decided_at();
    let horizon = program.scenario.clock.seconds(subject.horizon);
    // Monitors round times of jumps by less than this.
    let slack = 1e-12 * horizon;
    let present = states.partition_point(|(time, _)| *time <= at + slack).checked_sub(1)?;
    let (since, now) = &states[present];
    let before = present.checked_sub(1).map(|k| &states[k].1);
    let used = subject.atoms_of(column);
    let changed = |k: &usize| before.is_some_and(|before| before[*k] != now[*k]) && at - since <= slack;
    let mut named: Vec<usize> = used.iter().copied().filter(changed).collect();
    if named.is_empty() && used.len() == 1 {
        named = used;
    }
    let word = |k: &usize| {
        let text = subject.texts.atoms.get(*k).map_or("", String::as_str);
        format!("`{text}` {}", words::truth(now[*k]))
    };
    let what = named.iter().take(NAMED).map(word).collect::<Vec<_>>().join(", ");
    match monitor.reading() {
        Some(Reading::Value(value)) if value == f64::INFINITY => {
            Some((at, Some(value), "not within the horizon".to_owned()))
        }
        Some(Reading::Value(value)) => {
            let value_text = words::brief(value, unit);
            let text = if what.is_empty() { value_text } else { format!("{value_text}, when {what}") };
            Some((at, Some(value), text))
        }
        _ if what.is_empty() => Some((at, None, "its time was over".to_owned())),
        _ => Some((at, None, what)),
    }
}
