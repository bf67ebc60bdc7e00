//! `smc explain`: what a code means and what to do.

use super::arguments::Explain;
use super::complaint;
use super::terminal::{Colors, print};
use crate::compile::nearest::nearest;
use crate::report::ExitCode as Exit;
use crate::syntax::codes::Code;

/// Runs the command.
pub(super) fn run(arguments: &Explain, colors: Colors) -> Exit {
    let Some(wanted) = &arguments.code else {
        let list: String = Code::ALL.iter().map(|code| format!("{code}  {}\n", code.title())).collect();
        return finish(&list, colors);
    };
    if let Ok(code) = wanted.parse::<Code>() {
        return finish(code.page().trim_start_matches("# "), colors);
    }
    let hint = nearest(&wanted.trim().to_ascii_uppercase(), Code::ALL.iter().map(|code| code.name()));
    let hint = hint.map_or_else(
        || "`smc explain` lists all codes".to_owned(),
        |near| format!("did you mean {near}? `smc explain` lists all codes"),
    );
    complaint::tell(&complaint::argument(format!("unknown code `{wanted}`"), hint), &[], colors);
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
