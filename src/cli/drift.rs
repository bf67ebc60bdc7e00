//! `smc drift`: has a probability changed? A cumulative sum over recorded or streamed outcomes (Page 1954).

use super::arguments::{Drift, DriftFormat};
use super::terminal::{print, say};
use crate::base::math;
use crate::data::outcomes::{Column, Outcomes};
use crate::report::ExitCode as Exit;
use crate::stats::Cusum;
use serde_json::json;
use std::fs::File;
use std::io::{BufRead, BufReader};

/// Outcomes on average to a false alarm, at least, unless the call says otherwise.
const QUIET: f64 = 1000.0;

/// Runs the command.
pub(super) fn run(arguments: &Drift) -> Exit {
    match watch(arguments) {
        Ok(true) => Exit::Violated,
        Ok(false) => Exit::Success,
        Err(reason) => {
            say(&format!("error: {reason}\n"));
            if arguments.format == DriftFormat::Json {
                let error = json!({ "schema": 1, "error": { "bug": false, "message": reason } });
                let _ = print(&format!("{error}\n"));
            }
            Exit::Wrong
        }
    }
}

/// Whether there was an alarm.
fn watch(arguments: &Drift) -> Result<bool, String> {
    let threshold = match (arguments.threshold, arguments.false_alarm) {
        (Some(threshold), _) => threshold,
        (None, quiet) => math::ln(quiet.unwrap_or(QUIET)),
    };
    let mut cusum = Cusum::new(arguments.before, arguments.after, threshold).map_err(|e| e.to_string())?;
    let column = match &arguments.column {
        None => Column::Line,
        Some(name) => match name.parse::<usize>() {
            Ok(0) => return Err("columns count from 1".to_owned()),
            Ok(number) => Column::Number(number),
            Err(_) => Column::Head(name.clone()),
        },
    };
    let mut outcomes = Outcomes::new(column);
    let mut alarms: Vec<u64> = Vec::new();
    let mut successes = 0u64;
    let name = super::inputs::shown(&arguments.file);
    for line in lines(&arguments.file)? {
        let line = line.map_err(|error| format!("`{name}` cannot be read: {error}"))?;
        let Ok(line) = std::str::from_utf8(&line) else {
            return Err(format!("{name}: line {}: this is not text in UTF-8", outcomes.lines() + 1));
        };
        let Some(success) = outcomes.read(line).map_err(|e| format!("{name}: {e}"))? else {
            continue;
        };
        successes += u64::from(success);
        if cusum.observe(success) {
            alarms.push(cusum.read());
            // At once: whoever listens may want to act.
            print(&match arguments.format {
                DriftFormat::Text => {
                    format!("alarm after outcome {} (line {})\n", cusum.read(), outcomes.lines())
                }
                DriftFormat::Json => {
                    format!("{}\n", json!({ "alarm": cusum.read(), "line": outcomes.lines() }))
                }
            })?;
            if arguments.first {
                break;
            }
        }
    }
    if cusum.read() == 0 {
        return Err(format!("{name}: there is no outcome in it"));
    }
    print(&summary(arguments, &cusum, successes, &alarms))?;
    Ok(!alarms.is_empty())
}

#[allow(clippy::disallowed_methods, reason = "the command line opens files")]
fn lines(name: &str) -> Result<Box<dyn Iterator<Item = std::io::Result<Vec<u8>>>>, String> {
    if name == "-" {
        return Ok(Box::new(std::io::stdin().lock().split(b'\n')));
    }
    let file = File::open(name).map_err(|error| format!("`{name}` cannot be opened: {error}"))?;
    Ok(Box::new(BufReader::new(file).split(b'\n')))
}

fn summary(arguments: &Drift, cusum: &Cusum, successes: u64, alarms: &[u64]) -> String {
    let (before, after) = (arguments.before, arguments.after);
    let (quiet, delay) = (cusum.mean_to_false_alarm_at_least(), cusum.delay());
    let certifies =
        format!("while P is {before}, at least {quiet:.0} outcomes pass on average before a false alarm");
    match arguments.format {
        DriftFormat::Json => {
            let object = json!({
                "schema": 1,
                "method": { "name": "cusum", "before": before, "after": after, "threshold": cusum.threshold() },
                "certifies": certifies,
                "mean_to_false_alarm_at_least": quiet,
                "delay_about": delay,
                "outcomes": cusum.read(),
                "successes": successes,
                "alarms": alarms,
                "sum": cusum.sum(),
                "stopped_by": if arguments.first && !alarms.is_empty() { "boundary" } else { "plan" },
            });
            format!("{object}\n")
        }
        DriftFormat::Text => {
            let read = cusum.read();
            let share = 100.0 * successes as f64 / read as f64;
            let said = match alarms {
                [] => format!("no alarm; the sum stands at {:.2}", cusum.sum()),
                [one] => format!("1 alarm, after outcome {one}"),
                [first, .., last] => {
                    format!("{} alarms, after outcomes {first} to {last}", alarms.len())
                }
            };
            format!(
                "{said}\n{read} outcomes, {successes} successes ({share:.1} %)\ncertified: {certifies}\nonce P is {after}, an alarm takes about {delay:.0} outcomes\nmethod: cusum(before = {before}, after = {after}, threshold = {:.6})\n",
                cusum.threshold()
            )
        }
    }
}
