//! The words of what is written, in which names are what they stand for: arguments of functions, and names of processes.

use crate::compile::context::{
    lowered::Locals,
    parts::{Frame, Given, Part},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::model::Who;
use crate::syntax::ast::Ident;
use crate::syntax::source::{Source, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How deep what stands for arguments is looked into.
const DEEPEST: u32 = 200;
/// How long, in characters, what stands for an argument may be.
const LONGEST: usize = 80;

/// How what is observed was written.
#[derive(Clone, Debug, Default)]
pub struct Texts {
    /// Each atom.
    pub atoms: Vec<String>,
    /// Those of them that are made of others, by their number.
    pub parts: BTreeMap<u32, Arc<Part>>,
    /// Generated atoms: an agent has the left side of an implication.
    pub cases: BTreeSet<u32>,
    /// Generated atoms: an agent of a quantified set is present.
    pub implied: BTreeSet<u32>,
    /// Each signal, and its dimension.
    pub signals: Vec<(String, Dimension)>,
    /// Comparisons of numbers over time, by the index of their node, and the dimension of their sides.
    pub comparisons: BTreeMap<u32, (String, Dimension)>,
    /// The files, for the words of parts.
    pub sources: Arc<[Source]>,
    /// Where in them names are used that stand for something else.
    pub uses: Uses,
}

/// Words of the place that is being lowered.
#[derive(Default)]
pub(crate) struct Words {
    /// Where a use of an argument stands, and where its value is written, in the present call.
    pub(crate) aliases: BTreeMap<Span, Span>,
    /// Where names are used that stand for something else.
    pub(crate) uses: Uses,
    /// The meanings of these names at the present place.
    pub(crate) frame: Option<Arc<Frame>>,
}

/// Where names are used that may stand for something else.
#[derive(Clone, Debug, Default)]
pub struct Uses {
    /// What kind of name it is that is used at a place.
    pub(crate) at: BTreeMap<Span, Use>,
    /// Names of the agents of quantifiers.
    bound: BTreeSet<String>,
}

/// A kind of name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Use {
    /// The one that is bound in this place, counted from the outermost.
    Given(u32),
    /// One of the process around.
    Inside,
}

impl Locals {
    /// Binds the name of an agent; `told` is true if a text may mention it.
    pub(crate) fn bind_person(&mut self, name: &Ident, who: Who, told: bool) {
        self.give(told.then_some(Given::Person(who)));
        self.bind(&name.name, Typed::Agent(who));
    }

    /// Notes what the name that is bound next is called in texts.
    pub(crate) fn give(&mut self, given: Option<Given>) {
        let Some(given) = given else { return };
        let mut frame = self.frame.as_deref().cloned().unwrap_or_default();
        frame.given.reserve_exact(1);
        frame.given.push((self.names.len() as u32, given));
        self.frame = Some(Arc::new(frame));
    }
}

impl Texts {
    /// The words of parts that are told together; `people` tells who somebody is in which of them, if that is known. None
    /// where they would say something else.
    pub fn words(
        &self,
        parts: &[&Part],
        people: &dyn Fn(usize, Who) -> Option<String>,
    ) -> Option<Vec<String>> {
        // Where one name would be that of two, people are called by their own names.
        self.words_once(parts, people, false).or_else(|| self.words_once(parts, people, true))
    }

    fn words_once(
        &self,
        parts: &[&Part],
        people: &dyn Fn(usize, Who) -> Option<String>,
        by_name: bool,
    ) -> Option<Vec<String>> {
        let (mut list, mut whose) = (Vec::new(), BTreeMap::new());
        for (k, part) in parts.iter().enumerate() {
            if let Some(said) = &part.said {
                list.push(said.to_string());
                continue;
            }
            let known = |who: Who| if by_name { people(k, who) } else { None };
            let filled = self.uses.fill(&self.sources, (part.place, part.frame.as_ref()), &known)?;
            for (name, owner) in &filled.names {
                let person = match owner {
                    Owner::Within => continue,
                    Owner::Person(who) => people(k, *who),
                    Owner::Other => None,
                };
                if *whose.entry(name.clone()).or_insert_with(|| person.clone()) != person {
                    return None;
                }
            }
            list.push(bare(&filled.text).to_owned());
        }
        Some(list)
    }
}

impl Uses {
    /// Notes the name of a quantifier, which is bound after so many others.
    pub(crate) fn bind(&mut self, variable: &Ident, before: usize) {
        if !self.bound.contains(&variable.name) {
            self.bound.insert(variable.name.clone());
        }
        self.at.insert(variable.span, Use::Given(before as u32));
    }

    /// The words of a place. Where one name would be that of two, people are called by their own names.
    pub(crate) fn worded(
        &self,
        sources: &[Source],
        (place, frame): (Span, Option<&Arc<Frame>>),
        people: &dyn Fn(Who) -> Option<String>,
    ) -> Option<String> {
        let once = |people| self.fill(sources, (place, frame), people);
        let filled = once(&|_| None).or_else(|| once(people))?;
        Some(bare(&filled.text).to_owned())
    }

    fn fill(
        &self,
        sources: &[Source],
        (place, frame): (Span, Option<&Arc<Frame>>),
        people: &dyn Fn(Who) -> Option<String>,
    ) -> Option<Arc<Filled>> {
        Filling { uses: self, sources, people, known: BTreeMap::new() }.fill(place, frame, 0)
    }
}

/// Whose name a word is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    /// That of a quantifier outside of the text.
    Person(Who),
    /// That of a quantifier within.
    Within,
    /// Anything else.
    Other,
}

/// A text, and whose names are in it.
#[derive(Debug, Default)]
struct Filled {
    text: String,
    names: Vec<(String, Owner)>,
}

/// Puts what names stand for into a text.
struct Filling<'f> {
    uses: &'f Uses,
    sources: &'f [Source],
    people: &'f dyn Fn(Who) -> Option<String>,
    /// Texts so far, by their places and where their frames are kept.
    known: BTreeMap<(Span, usize), Arc<Filled>>,
}

impl Filling<'_> {
    /// The text of a place. None where it would say something else.
    fn fill(&mut self, place: Span, frame: Option<&Arc<Frame>>, depth: u32) -> Option<Arc<Filled>> {
        let key = (place, frame.map_or(0, |frame| Arc::as_ptr(frame) as usize));
        if let Some(known) = self.known.get(&key) {
            return Some(known.clone());
        }
        if depth > DEEPEST {
            return None;
        }
        let starts = Span { end: 0, ..place }..;
        let within = |used: &Span| used.source == place.source && used.start < place.end;
        let uses = self.uses.at.range(starts).take_while(|(used, _)| within(used));
        let uses: Vec<(Span, Use)> = uses.map(|(used, kind)| (*used, *kind)).collect();
        let mut uses: &[_] = &uses;
        let (mut text, mut names) = (String::new(), Vec::new());
        let mut from = place.start;
        let mut is_changed = false;
        while let Some(((used, kind), rest)) = uses.split_first() {
            uses = rest;
            if used.start < from || used.end > place.end {
                continue;
            }
            self.between(Span { start: from, end: used.start, ..place }, (&mut text, &mut names));
            from = used.end;
            let next = rest.first().map_or(place.end, |(next, _)| next.start.min(place.end));
            let after = self.raw(Span { start: from, end: next.max(from), ..place });
            match self.stands(*used, *kind, frame, depth)? {
                Standing::Itself(owner) => {
                    let name = self.raw(*used);
                    text.push_str(&name);
                    names.push((name, owner));
                }
                Standing::As(words, owner) => {
                    text.push_str(&words);
                    // Who is called like a name within would be taken for that.
                    is_changed |= owner.is_some();
                    names.extend(owner.map(|owner| (words, owner)));
                }
                Standing::For(filled) => {
                    is_changed = true;
                    let words = short(&filled.text);
                    if needs_brackets(&words, &text, &after) {
                        text.push_str(&format!("({})", bare(&words)));
                    } else {
                        text.push_str(&words);
                    }
                    names.extend(filled.names.iter().cloned());
                }
            }
        }
        self.between(Span { start: from, ..place }, (&mut text, &mut names));
        names.retain(|(name, _)| self.uses.bound.contains(name));
        let is_of_two = |(k, (name, owner)): (usize, &(String, Owner))| {
            names[..k].iter().any(|(other, of)| other == name && of != owner)
        };
        if is_changed && names.iter().enumerate().any(is_of_two) {
            return None;
        }
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let mut each: Vec<(String, Owner)> = Vec::new();
        for name in names {
            if !each.contains(&name) {
                each.push(name);
            }
        }
        let filled = Arc::new(Filled { text, names: each });
        self.known.insert(key, filled.clone());
        Some(filled)
    }

    /// What a name stands for. None where that cannot be said.
    fn stands(
        &mut self,
        mut used: Span,
        mut kind: Use,
        mut frame: Option<&Arc<Frame>>,
        depth: u32,
    ) -> Option<Standing> {
        let mut is_argument = false;
        // What is given to a function may be given to the one that calls it, and so on.
        loop {
            let given = match kind {
                Use::Inside => match frame.and_then(|frame| frame.process.as_ref()) {
                    Some(process) => {
                        return Some(Standing::As(format!("{process}.{}", self.raw(used)), None));
                    }
                    None => None,
                },
                Use::Given(at) => frame.and_then(|frame| frame.given(at)),
            };
            match given {
                Some(Given::Written(written)) => {
                    (used, is_argument) = (*written, true);
                    frame = frame.and_then(|frame| frame.caller.as_ref());
                    match self.uses.at.get(&used) {
                        Some(next) => kind = *next,
                        None => return Some(Standing::For(self.fill(used, frame, depth + 1)?)),
                    }
                }
                Some(Given::Copy(label)) => return Some(Standing::As(label.to_string(), None)),
                Some(Given::Person(who)) => {
                    let owner = Owner::Person(*who);
                    return Some(match (self.people)(*who) {
                        Some(name) => Standing::As(name, Some(owner)),
                        None => Standing::of(self.raw(used), owner, is_argument),
                    });
                }
                None => {
                    let owner = if matches!(kind, Use::Given(_)) { Owner::Within } else { Owner::Other };
                    return Some(Standing::of(self.raw(used), owner, is_argument));
                }
            }
        }
    }

    /// Adds what stands between two names.
    fn between(&self, place: Span, (text, names): (&mut String, &mut Vec<(String, Owner)>)) {
        let raw = self.raw(place);
        for (at, word) in words_at(&raw) {
            // Units follow numbers, members points.
            let before = raw[..at].trim_end();
            let is_name = !before.ends_with(|c: char| c.is_ascii_digit() || c == '.' || c == '/');
            if is_name && self.uses.bound.contains(word) {
                names.push((word.to_owned(), Owner::Other));
            }
        }
        text.push_str(&raw);
    }

    /// The text of a place without comments, blanks as they are.
    fn raw(&self, place: Span) -> String {
        if place.start >= place.end {
            return String::new();
        }
        let source = self.sources.iter().find(|source| source.id == place.source);
        without_comments(source.map_or("", |source| source.slice(place)))
    }
}

/// What is put where a name is used.
enum Standing {
    /// The name.
    Itself(Owner),
    /// These words, for a person or a copy.
    As(String, Option<Owner>),
    /// A text.
    For(Arc<Filled>),
}

impl Standing {
    /// A name that stands for nothing else, by itself or as an argument.
    fn of(name: String, owner: Owner, is_argument: bool) -> Self {
        if !is_argument {
            return Self::Itself(owner);
        }
        Self::For(Arc::new(Filled { names: vec![(name.clone(), owner)], text: name }))
    }
}

/// A text that is not too long to stand for an argument.
fn short(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    // It is cut between words, and outside of brackets, or inside the first.
    let (mut depth, mut cut, mut opened) = (0i32, None, None);
    for (at, c) in text.char_indices().take(LONGEST) {
        match c {
            '(' | '[' => {
                if depth == 0 && opened.is_none() {
                    opened = Some((at, c));
                }
                depth += 1;
            }
            ')' | ']' => depth -= 1,
            ' ' if depth == 0 => cut = Some(at),
            _ => {}
        }
    }
    match (cut, opened) {
        (Some(cut), _) => format!("{} …", &text[..cut]),
        (None, Some((open, '('))) => format!("{}(…)", &text[..open]),
        (None, Some((open, _))) => format!("{}[…]", &text[..open]),
        (None, None) => "…".to_owned(),
    }
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c| !is_of_word(c)).filter(|word| !word.is_empty())
}

/// Words, and where they begin.
fn words_at(text: &str) -> impl Iterator<Item = (usize, &str)> {
    words(text).map(|word| (word.as_ptr() as usize - text.as_ptr() as usize, word))
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

/// A text without its comments, which end what follows them once lines are joined.
pub(crate) fn without_comments(text: &str) -> String {
    let mut left = String::with_capacity(text.len());
    let mut rest = text;
    let mut quoted = false;
    while let Some(c) = rest.chars().next() {
        let skipped = match rest {
            _ if quoted => 0,
            line if line.starts_with("//") => line.find('\n').unwrap_or(line.len()),
            block if block.starts_with("/*") => block[2..].find("*/").map_or(block.len(), |end| end + 4),
            _ => 0,
        };
        if skipped > 0 {
            left.push(' ');
            rest = &rest[skipped..];
            continue;
        }
        // A quote in a text is written `\"`.
        quoted ^= c == '"' && !left.ends_with('\\');
        left.push(c);
        rest = &rest[c.len_utf8()..];
    }
    left
}

/// A text without parentheses around the whole of it.
pub(crate) fn bare(text: &str) -> &str {
    let Some(inner) = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')) else { return text };
    let mut depth = 0i32;
    for c in inner.chars() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if depth < 0 {
            // The first parenthesis closes before the end: `(a) & (b)`.
            return text;
        }
    }
    bare(inner.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_long_is_cut_between_words_outside_of_brackets() {
        assert_eq!(short("a + b"), "a + b");
        let long = "x".repeat(LONGEST);
        assert_eq!(short(&format!("a + {long}")), "a + …");
        assert_eq!(short(&format!("f(a, b) + g(1 m, {long})")), "f(a, b) + …");
        assert_eq!(short(&format!("f(a b, {long})")), "f(…)");
    }

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

    #[test]
    fn only_parentheses_around_the_whole_go() {
        assert_eq!(bare("((a > 1 m))"), "a > 1 m");
        assert_eq!(bare("(a) & (b)"), "(a) & (b)");
        assert_eq!(bare("f(a)"), "f(a)");
    }

    #[test]
    fn comments_go_and_texts_stay() {
        assert_eq!(without_comments("a // b\nc /* d */ e"), "a  \nc   e");
        assert_eq!(without_comments("\"http://a\" // b"), "\"http://a\"  ");
        assert_eq!(without_comments("a /* b"), "a  ");
        assert_eq!(without_comments("a /*/ b */ c"), "a   c");
    }
}
