//! Places at which an item surely begins, whatever stands before them on their line.
//!
//! What follows a part that could not be read is read again from the next such place: as from the next line, had the
//! text been written so. Elsewhere on the line it may belong to what could not be read, and nothing more is said of it.

use super::grammar::Rule;
use super::{lexeme, nouns};

/// How surely an item begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// Where no bracket is open and the item before it may have ended: `name =`, `when`.
    Unless,
    /// In any case: a keyword that is followed by a name, and that by the mark which goes with the keyword.
    Surely,
}

/// Keywords, and what follows the name behind them.
const NAMED: [(&str, &[&str]); 25] = [
    ("agent", &[":", "["]),
    ("agents", &[":", "["]),
    ("behaviour", &["{", "("]),
    ("const", &["="]),
    ("group", &["[", ":"]),
    ("groups", &[":"]),
    ("kind", &[":"]),
    ("label", &["="]),
    ("let", &["=", "("]),
    ("line", &[":"]),
    ("moves", &["for", "["]),
    ("obstacle", &[":"]),
    ("on", &["{"]),
    ("param", &["="]),
    ("paths", &["{", "["]),
    ("point", &[":"]),
    ("process", &["{", "["]),
    ("property", &["="]),
    ("rank", &["of", "in"]),
    ("region", &[":"]),
    ("source", &[":"]),
    ("state", &["{"]),
    ("tracks", &["="]),
    ("var", &["=", ":"]),
    ("wall", &[":"]),
];
/// Keywords of queries, which are followed by a measure.
const ASKING: [&str; 3] = ["check", "estimate", "compare"];
/// Words that end what they stand in, though they are keywords.
const LAST: [&str; 7] = ["choose", "end", "leave", "particle", "stop", "walkable", "across"];

/// How surely an item of a block begins at a byte, if at all. The part of the block is known by its rule.
pub(super) fn at(part: Rule, text: &str, at: usize) -> Option<Anchor> {
    let mut rest = &text[at..];
    let mut next = || {
        rest = &rest[lexeme::all_trivia(rest)..];
        let token = lexeme::first(rest);
        rest = &rest[token.len()..];
        token
    };
    let (word, name, mark) = (next(), next(), next());
    let own: &[&str] = match part {
        Rule::item | Rule::bad_item => &[
            "agent",
            "agents",
            "behaviour",
            "const",
            "group",
            "groups",
            "kind",
            "let",
            "moves",
            "param",
            "paths",
            "process",
            "source",
            "tracks",
        ],
        Rule::property_item | Rule::bad_property_item => &["const", "let", "property", "rank"],
        Rule::scene_item | Rule::bad_scene_item => &["line", "obstacle", "point", "region", "wall"],
        Rule::process_item | Rule::bad_process_item => &["label", "let", "var"],
        Rule::behaviour_item | Rule::bad_behaviour_item => &["let", "on", "state"],
        _ => &[],
    };
    let marks = NAMED.iter().find(|(keyword, _)| *keyword == word && own.contains(keyword));
    if marks.is_some_and(|(_, marks)| name.starts_with(lexeme::starts_name) && marks.contains(&mark)) {
        return Some(Anchor::Surely);
    }
    let begins = match part {
        Rule::item | Rule::bad_item => match word {
            "scene" if name == "{" => return Some(Anchor::Surely),
            "scenario" => name.starts_with('"'),
            "horizon" | "step" => name == "=",
            _ => false,
        },
        Rule::property_item | Rule::bad_property_item => {
            if ASKING.contains(&word) && matches!(name, "P" | "E" | "Q") && mark == "(" {
                return Some(Anchor::Surely);
            }
            word == "family" && name == "confidence"
        }
        Rule::scene_item | Rule::bad_scene_item => match word {
            "wall" => name == "(",
            "obstacle" => matches!(name, "circle" | "rect" | "polygon") && mark == "(",
            "import" => name.starts_with('"'),
            "periodic" => name.starts_with(lexeme::starts_name) && mark == "in",
            _ => false,
        },
        Rule::field | Rule::bad_field => sets(word, name) || word == "limit" && sets(name, mark),
        Rule::state_item | Rule::bad_state_item => sets(word, name) || matches!(word, "after" | "when"),
        Rule::move_option | Rule::bad_move => {
            matches!(word, "heading" | "stop") || word == "route" && sets(name, mark)
        }
        Rule::process_item | Rule::bad_process_item => matches!(word, "when" | "choose"),
        _ => false,
    };
    begins.then_some(Anchor::Unless)
}

/// `name =`
fn sets(name: &str, mark: &str) -> bool {
    name.starts_with(lexeme::starts_name) && mark == "="
}

/// What has been passed on the way from a part that could not be read to a later place.
#[derive(Clone, Debug)]
pub(super) struct Way {
    at: usize,
    /// Where the last token on the way starts.
    last: usize,
    /// The byte at which the part was found to be wrong: what stands there may be the slip.
    blamed: usize,
    /// Brackets that are open.
    open: Vec<char>,
    /// Whether an item may end with the last token.
    ends: bool,
    /// Whether a quoted text on the way does not end.
    torn: bool,
}

impl Way {
    pub(super) fn from(at: usize, blamed: usize) -> Self {
        Self { at, last: at, blamed, open: Vec::new(), ends: false, torn: false }
    }

    /// Goes on to a later byte.
    fn reach(&mut self, text: &str, until: usize) {
        while self.at < until {
            let rest = &text[self.at..];
            if let Some(length) = lexeme::trivia(rest) {
                self.at += length;
                continue;
            }
            let token = lexeme::first(rest);
            self.pass(token);
            self.last = self.at;
            self.at += token.len().max(1);
        }
    }

    fn pass(&mut self, token: &str) {
        match token.chars().next() {
            Some(open @ ('(' | '[' | '{')) => self.open.push(open),
            Some(')' | ']' | '}') => drop(self.open.pop()),
            _ => {}
        }
        self.torn |= lexeme::is_open_text(token);
        self.ends = match token {
            ")" | "]" | "}" | "%" | "∞" | ";" => true,
            _ if token.starts_with(lexeme::starts_name) => LAST.contains(&token) || !nouns::is_keyword(token),
            _ => token.starts_with(|c: char| c == '"' || c.is_ascii_digit()),
        };
    }

    /// Whether all brackets on the way are closed.
    pub(super) fn is_even(&self) -> bool {
        self.open.is_empty() && !self.torn
    }

    /// Whether a bracket is open at a later byte.
    pub(super) fn is_open_at(&mut self, text: &str, at: usize) -> bool {
        self.reach(text, at);
        !self.open.is_empty()
    }

    /// Whether an item that seems to begin at a byte surely does.
    pub(super) fn allows(&mut self, text: &str, at: usize, anchor: Anchor) -> bool {
        self.reach(text, at);
        match anchor {
            Anchor::Surely => !self.torn,
            Anchor::Unless => {
                self.is_even() && self.ends && self.blamed != at && !self.is_second_word(text, at)
            }
        }
    }

    /// Whether a name that is set follows right after a word that is the slip: of two words before a sign of equality nobody
    /// knows which is meant.
    fn is_second_word(&self, text: &str, at: usize) -> bool {
        let rest = &text[at..];
        let name = lexeme::first(rest);
        let behind = &rest[name.len()..];
        let mark = lexeme::first(&behind[lexeme::all_trivia(behind)..]);
        self.last == self.blamed
            && self.last < at
            && text[self.last..].starts_with(lexeme::starts_name)
            && sets(name, mark)
            && !nouns::is_keyword(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_begin_an_item_only_with_what_goes_with_them() {
        for (part, text, anchor) in [
            (Rule::bad_item, "agent user: adult", Some(Anchor::Surely)),
            (Rule::bad_item, "agent /* so */ user\n[3]: adult", Some(Anchor::Surely)),
            (Rule::bad_item, "agent user adult", None),
            (Rule::bad_item, "region hall: rect", None),
            (Rule::bad_item, "horizon = 3 s", Some(Anchor::Unless)),
            (Rule::scene_item, "region hall: rect", Some(Anchor::Surely)),
            (Rule::scene_item, "wall (0, 0)", Some(Anchor::Unless)),
            (Rule::bad_field, "mass = 80 kg", Some(Anchor::Unless)),
            (Rule::bad_field, "mass == 80 kg", None),
            (Rule::state_item, "after 2 s", Some(Anchor::Unless)),
            (Rule::bad_field, "after 2 s", None),
            (Rule::property_item, "check P(a)", Some(Anchor::Surely)),
            (Rule::property_item, "check P a", None),
            (Rule::process_item, "label", None),
        ] {
            assert_eq!(at(part, text, 0), anchor, "{part:?} {text}");
        }
    }

    #[test]
    fn an_item_begins_where_the_one_before_has_ended() {
        let sure = |text: &str, anchor| {
            let start = text.find("mass").unwrap();
            Way::from(0, text.find('!').unwrap_or(text.len())).allows(text, start, anchor)
        };
        for (text, unless, surely) in [
            ("(1 0) mass = 1", true, true),
            ("1, 0) mass = 1", true, true),
            ("(1, 0 mass = 1", false, true),
            ("1 + /* or so */ mass = 1", false, true),
            ("1 /* ( */ mass = 1", true, true),
            ("uniform in mass = 1", false, true),
            ("stop mass = 1", true, true),
            ("\"a mass = 1", false, false),
        ] {
            assert_eq!((sure(text, Anchor::Unless), sure(text, Anchor::Surely)), (unless, surely), "{text}");
        }
        let behind = |text: &str| Way::from(0, 6).allows(text, text.find("mass").unwrap(), Anchor::Unless);
        assert!(!behind("(1 0) speed mass = 1"), "of two words before one sign nobody knows which is meant");
        assert!(behind("(1 0) speed 2 mass = 1"));
        assert!(!Way::from(0, 2).allows("a mass = 1", 2, Anchor::Unless), "what is blamed may be the slip");
    }
}
