//! Completions and man pages.

use super::arguments::{Completions, Explain, Man, definition};
use super::complaint;
use super::terminal::print;
use crate::compile::nearest::nearest;
use crate::model::BuiltIn;
use crate::stats::PROCEDURES;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords;

/// Completions of a shell, to standard output.
pub(super) fn completions(arguments: &Completions) -> Result<(), Diagnostic> {
    let mut bytes = Vec::new();
    clap_complete::generate(arguments.shell, &mut definition(), "smc", &mut bytes);
    print(&String::from_utf8_lossy(&bytes))
}

/// Man pages, into a directory.
pub(super) fn pages(arguments: &Man) -> Result<(), Diagnostic> {
    let directory = &arguments.directory;
    let written =
        std::fs::create_dir_all(directory).and_then(|()| clap_mangen::generate_to(definition(), directory));
    written.map_err(|error| {
        complaint::output(format!("man pages cannot be written to `{}`: {error}", directory.display()))
    })
}

// `smc explain`: what a code means and what to do, what a procedure takes and guarantees, what a function gives.

/// The page of functions and formulas.
const MANUAL: &str = include_str!("../../docs/properties.md");

/// Runs the command.
pub(super) fn explain(arguments: &Explain) -> Result<(), Diagnostic> {
    let Some(wanted) = &arguments.name else {
        let codes = Code::ALL.iter().map(|code| format!("{code}  {}\n", code.title()));
        let procedures = PROCEDURES.iter().map(|one| format!("{} by {}\n", one.serves, one.signature()));
        let functions = BuiltIn::names().map(|name| format!("{name}(…)\n"));
        return print(&codes.chain(procedures).chain(functions).collect::<String>());
    };
    if let Ok(code) = wanted.parse::<Code>() {
        return print(code.page().trim_start_matches("# "));
    }
    let procedures = PROCEDURES.iter().filter(|one| one.name == wanted.trim()).map(|one| one.page());
    let pages: Vec<String> = procedures.chain(BuiltIn::find(wanted.trim()).and_then(function)).collect();
    if !pages.is_empty() {
        return print(&pages.join("\n"));
    }
    let hint = nearest(&wanted.trim().to_ascii_uppercase(), Code::ALL.iter().map(|code| code.name()))
        .or_else(|| nearest(wanted.trim(), PROCEDURES.iter().map(|one| one.name).chain(BuiltIn::names())));
    let hint = hint.map_or_else(
        || "`smc explain` lists all names".to_owned(),
        |near| format!("did you mean {near}? `smc explain` lists all names"),
    );
    let said = format!("unknown code, procedure or function `{wanted}`");
    Err(complaint::argument(said, hint))
}

/// What the manual says of a function: its row in the table of functions, or the paragraph in which it stands.
pub(super) fn function(built_in: &BuiltIn) -> Option<String> {
    let manual = MANUAL;
    let (call, name) = (format!("`{}(", built_in.name), format!("`{}`", built_in.name));
    // A table has a column of units, or none.
    let row = |is_call: bool| {
        manual.lines().filter(|line| line.starts_with("| `")).find_map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let (calls, unit, value) = match cells[..] {
                [calls, value] => (calls, "", value),
                [calls, unit, value] => (calls, unit, value),
                _ => return None,
            };
            let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
            let place = if is_call { calls } else { value };
            place.contains(&call).then(|| format!("{}{unit}\n\n{value}\n", calls.replace('`', "")))
        })
    };
    let paragraph = || {
        let is_text = |text: &&str| !text.starts_with(['|', '#']) && !text.starts_with("```");
        let texts = manual.split("\n\n").filter(is_text);
        let found = texts.into_iter().find(|text| text.contains(&call) || text.contains(&name))?;
        Some(format!("{}\n\n{found}\n", built_in.name))
    };
    row(true).or_else(|| row(false)).or_else(paragraph)
}

/// Pages with tables of keywords.
const PAGES: [&str; 4] = [
    include_str!("../../docs/scenario.md"),
    include_str!("../../docs/queries.md"),
    include_str!("../../docs/processes.md"),
    include_str!("../../docs/buildings.md"),
];

/// The manual about a word: the first row of a table that begins with it, or the paragraph below its heading.
pub(super) fn keyword(word: &str) -> Option<String> {
    let begins = |text: &str| text.strip_prefix(word).is_some_and(|rest| rest.starts_with([' ', '`', '(']));
    let mut rows = PAGES.iter().flat_map(|page| page.lines()).filter_map(|line| line.strip_prefix("| `"));
    if let Some((code, said)) = rows.find(|row| begins(row)).and_then(|row| row.split_once('`')) {
        return Some(format!("`{code}`{}", said.trim_end_matches(" |").replacen(" | ", ": ", 1)));
    }
    let mut paragraphs = PAGES.iter().flat_map(|page| page.split("\n\n"));
    let about = |text: &str| text.trim_start_matches('#').trim().trim_matches('`').eq_ignore_ascii_case(word);
    let is_heading = |text: &&str| text.starts_with('#') && about(text);
    if !keywords::is_marked(word) {
        return None;
    }
    let below = paragraphs.clone().skip_while(|text| !is_heading(text)).nth(1);
    let first = || {
        paragraphs.find(|text| {
            !text.starts_with(['|', '#', '`'])
                && text.split('`').skip(1).step_by(2).any(|code| begins(&format!("{code} ")))
        })
    };
    below.or_else(first).map(str::to_owned)
}
