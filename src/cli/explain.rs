//! `smc explain`: what a code means and what to do.

use super::arguments::Explain;
use super::complaint;
use super::terminal::{Colors, print};
use crate::compile::nearest::nearest;
use crate::report::ExitCode as Exit;
use crate::syntax::codes;

/// Runs the command.
pub(super) fn run(arguments: &Explain, colors: Colors) -> Exit {
    let Some(code) = &arguments.code else {
        let list: String = codes::pages().map(|page| format!("{}  {}\n", page.code, page.title)).collect();
        return finish(&list, colors);
    };
    let wanted = code.trim().to_ascii_uppercase();
    match codes::page(&wanted) {
        Some(page) => finish(&format!("{}: {}\n\n{}\n", page.code, page.title, page.text.trim_end()), colors),
        None => {
            let hint = nearest(&wanted, codes::pages().map(|page| page.code));
            let hint = hint.map_or_else(
                || "`smc explain` lists all".to_owned(),
                |near| format!("did you mean {near}? `smc explain` lists all"),
            );
            complaint::tell(&complaint::argument(format!("there is no code `{code}`"), hint), &[], colors);
            Exit::Wrong
        }
    }
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
