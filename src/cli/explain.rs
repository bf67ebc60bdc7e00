//! `smc explain`: what a code means and what to do, and what a procedure takes and guarantees.

use super::arguments::Explain;
use super::complaint;
use super::terminal::{Colors, print};
use crate::compile::nearest::nearest;
use crate::report::ExitCode as Exit;
use crate::stats::PROCEDURES;
use crate::syntax::codes::Code;

/// Runs the command.
pub(super) fn run(arguments: &Explain, colors: Colors) -> Exit {
    let Some(wanted) = &arguments.name else {
        let codes = Code::ALL.iter().map(|code| format!("{code}  {}\n", code.title()));
        let procedures = PROCEDURES.iter().map(|one| format!("{} by {}\n", one.serves, one.signature()));
        return finish(&codes.chain(procedures).collect::<String>(), colors);
    };
    if let Ok(code) = wanted.parse::<Code>() {
        return finish(code.page().trim_start_matches("# "), colors);
    }
    let pages: Vec<String> =
        PROCEDURES.iter().filter(|one| one.name == wanted.trim()).map(|one| one.page()).collect();
    if !pages.is_empty() {
        return finish(&pages.join("\n"), colors);
    }
    let hint = nearest(&wanted.trim().to_ascii_uppercase(), Code::ALL.iter().map(|code| code.name()))
        .or_else(|| nearest(wanted.trim(), PROCEDURES.iter().map(|one| one.name)));
    let hint = hint.map_or_else(
        || "`smc explain` lists all".to_owned(),
        |near| format!("did you mean {near}? `smc explain` lists all"),
    );
    let said = format!("there is no code or procedure `{wanted}`");
    complaint::tell(&complaint::argument(said, hint), &[], colors);
    Exit::Wrong
}

fn finish(text: &str, colors: Colors) -> Exit {
    match print(text) {
        Ok(()) => Exit::Success,
        Err(reason) => {
            complaint::tell(&complaint::output(reason), &[], colors);
            Exit::Wrong
        }
    }
}
