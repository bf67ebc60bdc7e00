//! How a condition of one state was written, down to its smallest parts: witnesses say which of them decided.

use super::elaborator::Elaborator;
use super::observed::bare;
use super::said::without_comments;
use super::study::{Form, Part};
use crate::model::{Bool, Set};
use crate::syntax::source::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Through how many functions an argument is followed to where it is written.
const MOST_ALIASES: u32 = 32;
/// How many arguments of one condition are followed.
const MOST_MEANT: usize = 64;
/// How many smallest parts are told apart, and how deep they are looked for.
const MOST_PARTS: u32 = 128;
const DEEPEST: u32 = 64;
/// How long, in characters, what stands for an argument may be.
const LONGEST: usize = 80;

/// What a name stands for where it is used.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stands {
    /// What is written there.
    For(Span),
    /// These words.
    As(String),
}

/// A condition as it was written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Phrase {
    place: Span,
    /// Where arguments of functions and names of processes are used in it, and what they stand for.
    meant: Vec<(Span, Stands)>,
    shape: Shape,
    /// Its words, where nobody wrote it.
    said: Option<String>,
    /// Smallest parts, and how deep they lie.
    size: (u32, u32),
}

/// What a condition is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// It has no parts that are conditions.
    Plain(Bool),
    /// Too many parts to tell them apart.
    Vast,
    /// A name or a call that stands for another.
    Named(Arc<Phrase>),
    /// Not.
    Not(Arc<Phrase>),
    /// All of them.
    All(Vec<Arc<Phrase>>),
    /// Any of them.
    Any(Vec<Arc<Phrase>>),
    /// Both or neither.
    Both(Arc<Phrase>, Arc<Phrase>),
    /// Each of a set.
    Each(Set, Arc<Phrase>),
    /// Someone of a set.
    Someone(Set, Arc<Phrase>),
}

impl Shape {
    fn parts(&self) -> Vec<&Arc<Phrase>> {
        match self {
            Self::Plain(_) | Self::Vast => Vec::new(),
            Self::Named(one) | Self::Not(one) | Self::Each(_, one) | Self::Someone(_, one) => vec![one],
            Self::All(list) | Self::Any(list) => list.iter().collect(),
            Self::Both(a, b) => vec![a, b],
        }
    }
}

impl Phrase {
    /// Whether it has no parts that are conditions.
    pub(super) const fn is_plain(&self) -> bool {
        matches!(self.shape, Shape::Plain(_))
    }
}

impl Elaborator<'_> {
    /// A condition that is written at a place; none where nobody asks why a condition is as it is.
    pub(super) fn phrase(&self, place: Span, shape: Shape) -> Option<Arc<Phrase>> {
        if !self.temporal {
            return None;
        }
        let (mut leaves, mut depth, mut is_vast) = (0u32, 0, matches!(shape, Shape::Vast));
        for part in shape.parts() {
            leaves = leaves.saturating_add(part.size.0);
            depth = depth.max(part.size.1 + 1);
            is_vast |= matches!(part.shape, Shape::Vast);
        }
        let size = (leaves.max(1), depth);
        let shape = if is_vast || leaves > MOST_PARTS || depth > DEEPEST { Shape::Vast } else { shape };
        let meant = if matches!(shape, Shape::Vast) { Vec::new() } else { self.meant(place) };
        Some(Arc::new(Phrase { place, meant, shape, said: None, size }))
    }

    /// The same of a condition that nobody wrote.
    pub(super) fn unwritten(&self, place: Span, shape: Shape, text: String) -> Option<Arc<Phrase>> {
        let phrase = Arc::unwrap_or_clone(self.phrase(place, shape)?);
        Some(Arc::new(Phrase { said: Some(text), ..phrase }))
    }

    /// The names used at a place, and in what they stand for, that stand for something else in the present calls.
    pub(super) fn meant(&self, place: Span) -> Vec<(Span, Stands)> {
        let mut found: Vec<(Span, Stands)> = Vec::new();
        let mut places = vec![place];
        while let Some(place) = places.pop() {
            let from = Span { end: 0, ..place }..;
            let is_within = |used: &Span| used.source == place.source && used.start < place.end;
            let aliases = self.aliases.range(from.clone()).take_while(|(used, _)| is_within(used));
            let aliases = aliases.map(|(used, meant)| (*used, Stands::For(*meant)));
            let owned = self.owned.range(from).take_while(|(used, _)| is_within(used));
            // Together with its quantifier a name stands for all that it goes through.
            let is_apart = |bound: &Option<Span>| {
                bound.is_none_or(|b| b.source != place.source || b.start < place.start || place.end < b.end)
            };
            let owned = owned.filter(|(_, (_, bound))| is_apart(bound));
            let owned = owned.map(|(used, (text, _))| (*used, Stands::As(text.clone())));
            for (used, stands) in aliases.chain(owned).filter(|(used, _)| used.end <= place.end) {
                if found.len() == MOST_MEANT || found.iter().any(|(known, _)| *known == used) {
                    continue;
                }
                if let Stands::For(meant) = stands {
                    places.push(meant);
                }
                found.push((used, stands));
            }
        }
        found
    }

    /// The text of a place, in which names are what they stand for.
    pub(super) fn worded(&self, place: Span, meant: &[(Span, Stands)]) -> String {
        let mut filling = Filling { elaborator: self, meant, known: BTreeMap::new(), notes: Vec::new() };
        let text = filling.fill(place, 0);
        let text = bare(&text).to_owned();
        if filling.notes.is_empty() { text } else { format!("{text}, where {}", filling.notes.join(", ")) }
    }

    /// A phrase as witnesses read it, if it has parts.
    pub(super) fn part(&self, phrase: &Phrase) -> Option<Part> {
        let one = |phrase: &Arc<Phrase>| Some(Box::new(self.part(phrase)?));
        let all = |list: &[Arc<Phrase>]| list.iter().map(|one| self.part(one)).collect::<Option<Vec<_>>>();
        let form = match &phrase.shape {
            Shape::Plain(truth) => Form::Plain(truth.clone()),
            Shape::Vast => return None,
            Shape::Named(inner) => Form::Named(one(inner)?),
            Shape::Not(inner) => Form::Not(one(inner)?),
            Shape::All(list) => Form::All(all(list)?),
            Shape::Any(list) => Form::Any(all(list)?),
            Shape::Both(a, b) => Form::Both(one(a)?, one(b)?),
            Shape::Each(set, body) => Form::Each(set.clone(), one(body)?),
            Shape::Someone(set, body) => Form::Someone(set.clone(), one(body)?),
        };
        let said = phrase.said.clone();
        Some(Part { text: said.unwrap_or_else(|| self.worded(phrase.place, &phrase.meant)), form })
    }
}

/// Puts what arguments stand for into a text.
struct Filling<'f, 'a> {
    elaborator: &'f Elaborator<'a>,
    meant: &'f [(Span, Stands)],
    /// Texts so far.
    known: BTreeMap<Span, String>,
    /// `v = x + 1 m`: what is said of an argument that stays.
    notes: Vec<String>,
}

impl Filling<'_, '_> {
    fn fill(&mut self, place: Span, depth: u32) -> String {
        if let Some(known) = self.known.get(&place) {
            return known.clone();
        }
        // An argument may be one of the function around, and so on.
        if depth < MOST_ALIASES
            && let Some((_, stands)) = self.meant.iter().find(|(used, _)| *used == place)
        {
            return match stands {
                Stands::For(next) => self.fill(*next, depth + 1),
                Stands::As(text) => text.clone(),
            };
        }
        let inside =
            |used: &Span| used.source == place.source && place.start <= used.start && used.end <= place.end;
        let mut uses: Vec<Span> = self.meant.iter().map(|(used, _)| *used).filter(inside).collect();
        uses.sort_unstable();
        let plain = self.elaborator.text(place);
        if uses.is_empty() || depth > MOST_ALIASES {
            return plain;
        }
        let between = |start: u32, end: u32| self.elaborator.raw(Span { start, end, ..place });
        let mut pieces = vec![between(place.start, uses[0].start)];
        for (k, used) in uses.iter().enumerate() {
            let next = uses.get(k + 1).map_or(place.end, |next| next.start);
            pieces.push(between(used.end, next));
        }
        let mut text = pieces[0].clone();
        for (k, used) in uses.iter().enumerate() {
            let mut stands = self.fill(*used, depth + 1);
            let name = self.elaborator.text(*used);
            // The agent of a quantifier here is another than one of the same name there.
            let is_caught = words(&stands).any(|word| {
                self.elaborator.variables.contains(word)
                    && pieces.iter().any(|piece| words(piece).any(|w| w == word))
            });
            if stands.chars().count() > LONGEST || is_caught {
                let cut = stands.char_indices().nth(LONGEST).map(|(at, _)| at);
                let shown = cut.map_or_else(|| stands.clone(), |at| format!("{}…", &stands[..at]));
                let note = format!("{name} = {shown}");
                if !self.notes.contains(&note) {
                    self.notes.push(note);
                }
                stands = name;
            } else if needs_brackets(&stands, &text, &pieces[k + 1]) {
                stands = format!("({})", bare(&stands));
            }
            text.push_str(&stands);
            text.push_str(&pieces[k + 1]);
        }
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        self.known.insert(place, text.clone());
        text
    }
}

impl Elaborator<'_> {
    /// The text of a place without comments, blanks as they are.
    fn raw(&self, place: Span) -> String {
        let text = self.sources.iter().find(|s| s.id == place.source).map_or("", |s| s.slice(place));
        without_comments(text)
    }
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c| !is_of_word(c)).filter(|word| !word.is_empty())
}

/// Whether what stands for an argument needs parentheses between two texts.
fn needs_brackets(text: &str, before: &str, after: &str) -> bool {
    let mut depth = 0i32;
    let mut outside = String::new();
    for c in text.chars() {
        depth += i32::from(matches!(c, '(' | '[')) - i32::from(matches!(c, ')' | ']'));
        outside.push(if depth > 0 || matches!(c, ')' | ']') { '_' } else { c });
    }
    let is_condition = outside.contains(['<', '>', '=', '&', '|', '!', ':'])
        || words(&outside).any(|word| ["in", "for"].contains(&word));
    if !is_condition && outside.chars().all(|c| is_of_word(c) || c == '.') {
        return false;
    }
    let (before, after) = (before.trim_end(), after.trim_start());
    let (mut opens, mut closes) = (vec!['(', ',', '[', ':'], vec![')', ',', ']']);
    if !is_condition {
        opens.extend(['<', '>', '=', '&', '|']);
        closes.extend(['<', '>', '=', '&', '|', '!']);
    }
    let stands_alone = (before.is_empty() || before.ends_with(&opens[..]))
        && (after.is_empty() || after.starts_with(&closes[..]));
    !stands_alone
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_put_in_parentheses_where_they_would_read_otherwise() {
        assert!(!needs_brackets("crowd[1 + 2]", "2 * ", " + 1"));
        assert!(!needs_brackets("2 m", "x < ", ""));
        assert!(needs_brackets("x + 1", "2 * ", ""));
        assert!(needs_brackets("2 m", "", "^2"));
        assert!(needs_brackets("a | b", "", " & c"));
        assert!(!needs_brackets("a | b", "f(", ")"));
        assert!(needs_brackets("a < b", "!", ""));
    }
}
