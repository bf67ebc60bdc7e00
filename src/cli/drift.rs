//! `smc drift`: has a probability changed? A cumulative sum over recorded or streamed outcomes (Page 1954).

use super::arguments::Drift;
use super::terminal::{Colors, print, print_to_reader};
use super::values::TextFormat;
use super::{complaint, inputs};
use crate::base::math;
use crate::data::outcomes::{Column, Outcomes};
use crate::report::ExitCode as Exit;
use crate::stats::Cusum;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use serde_json::json;

/// Outcomes on average to a false alarm, at least, unless the call says otherwise.
const QUIET: f64 = 1000.0;

/// Runs the command.
pub(super) fn run(arguments: &Drift, colors: Colors) -> Exit {
    let done = watch(arguments);
    if let (Err(error), TextFormat::Json) = (&done, arguments.format) {
        let _ = print_error(error);
    }
    complaint::end(done.map(|found| if found { Exit::Violated } else { Exit::Success }), &[], colors)
}

/// Writes an error as an object.
pub(super) fn print_error(error: &Diagnostic) -> Result<(), Diagnostic> {
    let hint = error.hint.iter().map(|hint| format!(": {hint}"));
    let message = std::iter::once(error.title.clone()).chain(hint).collect::<String>();
    let error = json!({ "schema": 1, "error": { "bug": false, "message": message } });
    print(&format!("{error}\n"))
}

/// Whether there was an alarm.
fn watch(arguments: &Drift) -> Result<bool, Diagnostic> {
    let threshold = match (arguments.threshold, arguments.false_alarm) {
        (Some(threshold), _) => threshold,
        (None, quiet) => math::ln(quiet.unwrap_or(QUIET)),
    };
    let mut cusum = Cusum::new(arguments.before, arguments.after, threshold).map_err(|error| {
        complaint::argument(error.to_string(), "write for example `--before 0.9 --after 0.8`")
    })?;
    let column = match &arguments.column {
        None => Column::Line,
        Some(name) => match name.parse::<usize>() {
            Ok(0) => {
                return Err(complaint::argument(
                    "`--column` must be at least 1 (got 0)",
                    "the first column is `--column 1`",
                ));
            }
            Ok(number) => Column::Number(number),
            Err(_) => Column::Head(name.clone()),
        },
    };
    let mut outcomes = Outcomes::new(column);
    let mut alarms: Vec<u64> = Vec::new();
    let mut successes = 0u64;
    let name = inputs::shown(&arguments.file);
    for line in inputs::lines(&arguments.file).map_err(complaint::input)? {
        let line = line.map_err(|error| complaint::input(format!("`{name}` cannot be read: {error}")))?;
        let Ok(line) = std::str::from_utf8(&line) else {
            let reason = format!("{name}: line {}: not UTF-8 text", outcomes.lines() + 1);
            return Err(table(reason));
        };
        let Some(success) = outcomes.read(line).map_err(|error| table(format!("{name}: {error}")))? else {
            continue;
        };
        successes += u64::from(success);
        if cusum.observe(success) {
            alarms.push(cusum.read());
            // At once: whoever listens may want to act. Where nobody does, nothing more is read.
            let (read, line) = (cusum.read(), outcomes.lines());
            let heard = print_to_reader(&match arguments.format {
                TextFormat::Text => format!("alarm after outcome {read} (line {line})\n"),
                TextFormat::Json => format!("{}\n", json!({ "alarm": read, "line": line })),
            })?;
            if arguments.first || !heard {
                break;
            }
        }
    }
    if cusum.read() == 0 {
        return Err(table(format!("{name} contains no outcome")));
    }
    print(&summary(arguments, &cusum, successes, &alarms))?;
    Ok(!alarms.is_empty())
}

/// Outcomes that cannot be read as such.
fn table(reason: String) -> Diagnostic {
    Diagnostic::placeless(Code::E0707, reason)
        .hint("write one outcome per line, 0 or 1, true or false; `--column` selects one of a table")
}

fn summary(arguments: &Drift, cusum: &Cusum, successes: u64, alarms: &[u64]) -> String {
    let (before, after) = (arguments.before, arguments.after);
    let (quiet, delay) = (cusum.mean_to_false_alarm_at_least(), cusum.delay());
    let certifies =
        format!("while P is {before}, at least {quiet:.0} outcomes pass on average before a false alarm");
    match arguments.format {
        TextFormat::Json => {
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
        TextFormat::Text => {
            let read = cusum.read();
            let share = 100.0 * successes as f64 / read as f64;
            let said = match alarms {
                [] => format!("no alarm; the sum is {:.2}", cusum.sum()),
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
