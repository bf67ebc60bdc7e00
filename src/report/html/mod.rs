//! A report as one HTML page, with nothing beside it: verdicts first, then a player of traces, then the texts.

mod chart;
mod crowd;
mod highlight;
mod links;
mod player;
mod premises;
mod section;
mod table;

use super::number::{counted, duration};
use super::{phrase, text};
use crate::engine::outcome::{AskedQuery, CallResult, QueryResult, Witness};
use crate::engine::traces::Traces;
use crate::syntax::source::Source;
use askama::Template;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use crowd::Crowd;
use links::Links;
use player::Player;
use section::Section;
use sha2::{Digest as _, Sha256};
use std::sync::Arc;
pub use table::Table;

const STYLE: &str = include_str!("../../../templates/page.css");
/// The script in its parts: each uses those before it.
const SCRIPT: &str = concat!(
    "'use strict';\n(() => {\n",
    include_str!("../../../templates/page.js"),
    include_str!("../../../templates/trace.js"),
    include_str!("../../../templates/drawing.js"),
    include_str!("../../../templates/player.js"),
    "})();\n"
);
/// So many numbers of positions fit into a page.
pub const MOST_NUMBERS: usize = 500_000;
/// Most rows of a table that are shown.
const MOST_ROWS: usize = 2000;
/// Most bytes of a text that are shown.
const MOST_TEXT: usize = 200_000;

/// What a page shows.
#[derive(Debug, Default)]
pub struct Page<'a> {
    /// The results; none of trials that were simulated alone.
    pub run: CallResult,
    /// The texts of the call.
    pub sources: &'a [Source],
    /// Tables beside the results.
    pub tables: Vec<Table>,
    /// Traces for the player.
    pub traces: Traces,
    /// Whether somebody is in the traces twice, which no figure of a crowd is to count.
    pub without_crowd: bool,
}

#[derive(Template)]
#[template(path = "report.html")]
struct Html<'r> {
    run: &'r CallResult,
    title: &'r str,
    policy: String,
    about: String,
    sections: Vec<Section<'r>>,
    tables: Vec<Table>,
    player: Option<Player>,
    crowds: Vec<Crowd>,
    crowds_note: String,
    texts: Vec<(String, String)>,
}

/// A page.
pub fn page(page: Page<'_>) -> String {
    let Page { run, sources, mut tables, traces, without_crowd } = page;
    let premises = traces.list.first().and_then(|trace| premises::table(&trace.scenario, &run));
    tables.splice(0..0, premises);
    for table in &mut tables {
        let more = table.rows.len().saturating_sub(MOST_ROWS) as u64;
        if more > 0 {
            table.note += &format!(" Left out: {}.", counted(more, "row"));
            table.rows.truncate(MOST_ROWS);
        }
        // A column without a word takes room only.
        for k in (0..table.columns.len()).rev() {
            if !table.rows.is_empty() && table.rows.iter().all(|row| row.get(k).is_none_or(String::is_empty))
            {
                table.columns.remove(k);
                table.rows.iter_mut().for_each(|row| drop((k < row.len()).then(|| row.remove(k))));
            }
        }
    }
    let is_shown = |source: &&Source| !source.text.is_empty() && !source.name.starts_with("--");
    let sources: Vec<&Source> = sources.iter().filter(is_shown).collect();
    let numbered: Vec<(usize, &QueryResult)> = {
        let mut all: Vec<_> = run.results.iter().enumerate().collect();
        all.sort_by_key(|(_, result)| result.asked.index);
        all
    };
    let groups: Vec<&[(usize, &QueryResult)]> =
        numbered.chunk_by(|(_, a), (_, b)| text::same_sweep(a, b)).collect();
    let asked: Vec<&AskedQuery> = groups.iter().map(|group| &group[0].1.asked).collect();
    let (crowds, crowds_note) = crowd::crowds(&run, if without_crowd { &[] } else { &traces.list });
    let scenarios: Vec<_> = traces.list.iter().map(|trace| Arc::clone(&trace.scenario)).collect();
    let player = Player::of(&run, traces);
    let linked = if player.is_some() { scenarios.as_slice() } else { &[] };
    let links = Links::of(&sources, &asked, linked);
    let played = |place: usize, witness: &Witness| player.as_ref()?.number(place, witness);
    let texts = sources.iter().enumerate().map(|(number, source)| {
        let text = highlight::highlighted(&source.text, MOST_TEXT, (&links, number));
        (source.name.clone(), text)
    });
    let texts: Vec<(String, String)> = texts.collect();
    // The line may be one that is cut off.
    let is_there = |line: &&str| texts.iter().any(|(_, text)| text.contains(&format!("id=\"{line}\"")));
    let sections = groups.iter().enumerate().map(|(number, group)| Section {
        id: links::section(number),
        line: links.line(&sources, asked[number]).filter(is_there).map(str::to_owned),
        ..section::section(group, &played)
    });
    let mut about = format!("seed {}, smc {}", run.seed, run.version);
    if !run.results.is_empty() || run.trials > 0 {
        about += &format!(", {} in {}", counted(run.trials, "trial"), duration(run.elapsed_s));
    }
    let html = Html {
        run: &run,
        title: if run.scenario.is_empty() { "smc" } else { &run.scenario },
        policy: policy(SCRIPT, STYLE),
        about,
        sections: sections.collect(),
        tables,
        texts,
        player,
        crowds,
        crowds_note,
    };
    // A template writes to a string, which does not fail.
    html.render().unwrap_or_else(|error| error.to_string())
}

// The policy of a page: it may run its own script and its own style, by their hashes, and nothing from outside.

/// The content security policy of a page with one script and one style.
fn policy(script: &str, style: &str) -> String {
    let hash = |text: &str| STANDARD.encode(Sha256::digest(text));
    format!(
        "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
        hash(script),
        hash(style)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_out_of_its_element() {
        let run = CallResult { scenario: "</title><img a='x' b=\"y\">".into(), ..CallResult::default() };
        let page = page(Page { run, ..Page::default() });
        assert!(!page.contains("<img") && page.contains("&#60;img"), "{page}");
    }

    #[test]
    fn the_hash_of_nothing_is_the_known_one() {
        let nothing = "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=";
        assert_eq!(policy("", "").matches(nothing).count(), 2);
    }
}
