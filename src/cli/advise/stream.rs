//! Batches from standard input, as JSON lines.

use super::Caller;
use crate::advise::Cycles;
use crate::cli::complaint;
use crate::cli::terminal::warn;
use crate::data::tracks::read_batch;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::io::BufRead;

/// Reads standard input to its end. Bad lines are skipped, unless the call is strict.
pub(super) fn run(caller: &mut Caller<'_>) -> Result<(), Vec<Diagnostic>> {
    let mut input = std::io::stdin().lock();
    let (mut cycles, mut notes, mut number, mut line) = (Cycles::default(), Vec::new(), 0_u64, Vec::new());
    loop {
        line.clear();
        let length = input
            .read_until(b'\n', &mut line)
            .map_err(|error| complaint::input(format!("standard input {error}")))?;
        if length == 0 {
            break;
        }
        number += 1;
        let text = String::from_utf8_lossy(&line);
        if text.trim().is_empty() {
            continue;
        }
        let mut batch = match read_batch(text.trim_end()) {
            Ok(batch) => batch,
            Err(error) => {
                let place = error.column.map_or(String::new(), |column| format!(", column {column}"));
                let said = format!("line {number}{place}: {}", error.message);
                if caller.arguments.strict {
                    let hint = "remove `--strict` to skip such lines";
                    return Err(Diagnostic::placeless(Code::E0702, said).hint(hint).into());
                }
                warn(&format!("warning: {said}; the line is skipped\n"));
                continue;
            }
        };
        if caller.sees() {
            batch.seen.iter_mut().for_each(|one| one.velocity = None);
        }
        let (complete, note) = cycles.push(batch);
        notes.extend(note);
        for cycle in complete {
            if !caller.answer(&cycle, &mut notes)? {
                return Ok(());
            }
        }
    }
    if let Some(cycle) = cycles.finish() {
        caller.answer(&cycle, &mut notes)?;
    }
    Ok(())
}
