//! Links between the texts of a page and what they produced: names of properties lead to their results, lines of queries to
//! theirs and back, and names of agents, regions, lines and points to the player.

use super::highlight::words;
use crate::engine::outcome::AskedQuery;
use crate::model::Scenario;
use crate::syntax::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The player of a page.
const PLAYER: &str = "#player";
/// Words that a name follows whose results a page shows.
const DECLARES: [&str; 2] = ["property", "let"];

/// Where the names and lines of texts lead.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Links {
    names: BTreeMap<String, String>,
    /// By text and line, from 1: the anchor of the line, and the result of the query that begins there.
    lines: BTreeMap<(usize, usize), [String; 2]>,
}

/// The anchor of the section of a number.
pub(super) fn section(number: usize) -> String {
    format!("result-{number}")
}

impl Links {
    /// The links of texts to sections, which have these queries, and to the player, which shows these scenarios.
    pub(super) fn of(texts: &[&Source], asked: &[&AskedQuery], shown: &[Arc<Scenario>]) -> Self {
        let mut links = Self::default();
        for scenario in shown {
            let scene = &scenario.scene;
            // Of many agents the name stands before the number.
            let agents = scenario.agents.iter().map(|agent| agent.name.split('[').next().unwrap_or_default());
            let regions = scene.regions.iter().map(|region| region.name.as_str());
            let lines = scene.lines.iter().map(|line| line.name.as_str());
            let points = scene.points.iter().map(|(name, _)| name.as_str());
            for name in agents.chain(regions).chain(lines).chain(points) {
                links.names.insert(name.to_owned(), PLAYER.to_owned());
            }
        }
        let mut declared = BTreeSet::new();
        for text in texts {
            let mut before = "";
            for word in words(&text.text) {
                if DECLARES.contains(&before) {
                    declared.insert(word);
                }
                before = word;
            }
        }
        for (number, asked) in asked.iter().enumerate().rev() {
            let known = words(&asked.text).filter(|word| declared.contains(word));
            links.names.extend(known.map(|word| (word.to_owned(), format!("#{}", section(number)))));
            if let Some(text) = texts.iter().position(|text| text.name == asked.file) {
                let anchor = format!("line-{text}-{}", asked.line);
                links.lines.insert((text, asked.line), [anchor, section(number)]);
            }
        }
        links
    }

    /// The anchor of the line of a query.
    pub(super) fn line(&self, texts: &[&Source], asked: &AskedQuery) -> Option<&str> {
        let text = texts.iter().position(|text| text.name == asked.file)?;
        self.lines.get(&(text, asked.line)).map(|[anchor, _]| anchor.as_str())
    }

    /// The start of the link of a word, which is the first of its line or not.
    pub(super) fn start(&self, word: &str, (text, line): (usize, usize), is_first: bool) -> Option<String> {
        if is_first && let Some([anchor, section]) = self.lines.get(&(text, line)) {
            return Some(format!("<a id=\"{anchor}\" href=\"#{section}\">"));
        }
        self.names.get(word).map(|place| format!("<a href=\"{place}\">"))
    }
}
