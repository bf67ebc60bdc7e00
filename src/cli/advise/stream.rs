//! Batches from standard input, as JSON lines.

use super::Caller;
use crate::advise::Cycles;
use crate::cli::complaint;
use crate::cli::terminal::warn;
use crate::data::tracks::read_batch;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::io::{BufRead, Read};

/// Most bytes of a line.
const LONGEST: u64 = 16 << 20;
/// After so many bytes without the end of a line the input is no stream of lines.
const ENDLESS: u64 = 16 * LONGEST;
/// Most notes of a cycle about batches.
const MOST_NOTES: usize = 8;

/// Reads standard input to its end. Bad lines are skipped, unless the call is strict.
pub(super) fn run(caller: &mut Caller<'_>) -> Result<(), Vec<Diagnostic>> {
    let mut input = std::io::stdin().lock();
    let (mut cycles, mut notes, mut number, mut line) = (Cycles::default(), Vec::new(), 0_u64, Vec::new());
    let mut untold = 0_u64;
    while let Some(is_whole) = next(&mut input, &mut line)? {
        number += 1;
        let text = String::from_utf8_lossy(&line);
        if is_whole && text.trim().is_empty() {
            continue;
        }
        let read = if is_whole {
            read_batch(text.trim_end()).map_err(|error| {
                let place = error.column.map_or(String::new(), |column| format!(", column {column}"));
                format!("line {number}{place}: {}", error.message)
            })
        } else {
            Err(format!("line {number}: longer than {} MB", LONGEST >> 20))
        };
        let mut batch = match read {
            Ok(batch) => batch,
            Err(said) if caller.arguments.strict => {
                let hint = "remove `--strict` to skip such lines";
                return Err(Diagnostic::placeless(Code::E0702, said).hint(hint).into());
            }
            Err(said) => {
                warn(&format!("warning: {said}; the line is skipped\n"));
                continue;
            }
        };
        if caller.sees() {
            batch.seen.iter_mut().for_each(|one| one.velocity = None);
        }
        let pushed = cycles.push(batch);
        for cycle in pushed.complete {
            if !caller.answer(&cycle, &mut notes)? {
                return Ok(());
            }
            untold = 0;
        }
        let Some(note) = pushed.note else { continue };
        if pushed.is_urgent {
            warn(&format!("warning: line {number}: {note}\n"));
        }
        if notes.len() < MOST_NOTES {
            notes.push(note);
        } else {
            untold += 1;
            notes.truncate(MOST_NOTES);
            notes.push(format!("and {untold} more batches are left out"));
        }
    }
    if let Some(cycle) = cycles.finish() {
        caller.answer(&cycle, &mut notes)?;
    }
    Ok(())
}

/// The next line, and whether it is there as a whole; `None` at the end. The rest of a line that is too long is passed over.
fn next(input: &mut impl BufRead, line: &mut Vec<u8>) -> Result<Option<bool>, Diagnostic> {
    let mut passed = 0;
    loop {
        line.clear();
        let read = input.by_ref().take(LONGEST).read_until(b'\n', line);
        let length = read.map_err(|error| complaint::input(format!("standard input {error}")))? as u64;
        if length < LONGEST || line.ends_with(b"\n") {
            return Ok((passed + length > 0).then_some(passed == 0));
        }
        passed += length;
        if passed >= ENDLESS {
            let said = format!("standard input has no end of a line in {} MB", ENDLESS >> 20);
            return Err(Diagnostic::placeless(Code::E0702, said).hint("write one JSON object a line"));
        }
    }
}
