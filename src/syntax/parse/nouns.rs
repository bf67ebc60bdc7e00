//! What the rules of the grammar are called for people, and which known word is nearest.

use super::grammar::Rule;
use crate::syntax::keywords::{self, Place};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// The word of a keyword rule: `kw_agent` is the rule of `agent`.
pub(super) fn keyword(rule: Rule) -> Option<&'static str> {
    static WORDS: OnceLock<BTreeMap<Rule, String>> = OnceLock::new();
    let words = WORDS.get_or_init(|| {
        let word = |rule: &Rule| Some((*rule, format!("{rule:?}").strip_prefix("kw_")?.to_owned()));
        Rule::all_rules().iter().filter_map(word).collect()
    });
    words.get(&rule).map(String::as_str)
}

/// Whether a word is a keyword of the grammar.
pub(super) fn is_keyword(word: &str) -> bool {
    !matches!(word, "horizon" | "step") && keywords::keyword(word).is_some()
}

/// The word or mark of a rule that is one.
pub(super) fn token(rule: Rule) -> Option<&'static str> {
    keyword(rule).or_else(|| mark(rule))
}

/// The mark of a rule that is one.
fn mark(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::t_lparen => "(",
        Rule::t_rparen => ")",
        Rule::t_lbracket => "[",
        Rule::t_rbracket => "]",
        Rule::t_comma => ",",
        Rule::t_colon => ":",
        Rule::t_dots => "..",
        Rule::t_arrow => "->",
        Rule::t_line => "--",
        Rule::t_assign => "=",
        Rule::measure_p => "P",
        Rule::measure_e => "E",
        Rule::measure_q => "Q",
        Rule::measure_c => "CVaR",
        _ => return None,
    })
}

/// Whether something expected is an operator between two values, or the rest of a value.
pub(super) fn is_operator(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::op_plus
            | Rule::op_times
            | Rule::op_over
            | Rule::op_power
            | Rule::op_equal
            | Rule::op_unequal
            | Rule::op_at_most
            | Rule::op_less
            | Rule::op_at_least
            | Rule::op_more
            | Rule::op_and
            | Rule::op_or
            | Rule::op_implies
            | Rule::op_iff
            | Rule::pair
            | Rule::op_until
            | Rule::op_release
            | Rule::op_weak
    )
}

/// The part whose items a rule takes.
fn place(rule: Rule) -> Option<Place> {
    Some(match rule {
        Rule::item => Place::Scenario,
        Rule::property_item => Place::Properties,
        Rule::scene_item | Rule::level_item => Place::Scene,
        Rule::process_item => Place::Process,
        Rule::program_item => Place::Program,
        Rule::behaviour_item => Place::Behaviour,
        Rule::state_item | Rule::transition => Place::State,
        Rule::move_option => Place::Moves,
        _ => return None,
    })
}

/// The words that a rule of several alternatives may start with.
pub(super) fn words(rule: Rule) -> Vec<&'static str> {
    if let Some(place) = place(rule) {
        return keywords::beginning(place).collect();
    }
    let words: &[_] = match rule {
        Rule::clause => &["within", "confidence", "by", "under"],
        Rule::recorded => &["from"],
        Rule::with => &["with"],
        Rule::preset => &["preset"],
        Rule::particle | Rule::walkable => &["as"],
        Rule::only => &["id", "group"],
        Rule::group_of => &["group"],
        Rule::except => &["except"],
        Rule::then_leave => &["then"],
        Rule::wait => &["wait"],
        Rule::uniform_in => &["uniform"],
        Rule::near => &["near"],
        Rule::rate | Rule::moment => &["at"],
        Rule::delay => &["after"],
        Rule::measure_range => &["in"],
        Rule::shape => &["circle", "rect", "polygon"],
        _ => &[],
    };
    words.to_vec()
}

/// The name of a rule in messages; `rank` orders the nouns of one message, lower first.
pub(super) fn noun(rule: Rule) -> Option<(u8, String)> {
    if let Some(mark) = mark(rule) {
        return Some((4, format!("`{mark}`")));
    }
    if let Some(word) = keyword(rule) {
        return Some((if rule == Rule::kw_in { 9 } else { 5 }, format!("`{word}`")));
    }
    if is_operator(rule) {
        return Some((3, "an operator".to_owned()));
    }
    Some(match rule {
        Rule::number | Rule::quantity => (0, "a number".to_owned()),
        Rule::name | Rule::ident | Rule::attached | Rule::binding | Rule::bindings => {
            (1, "a name".to_owned())
        }
        Rule::text => (1, "a quoted text".to_owned()),
        Rule::expr
        | Rule::tight
        | Rule::arith
        | Rule::primary
        | Rule::op_not
        | Rule::temporal
        | Rule::window
        | Rule::binder
        | Rule::value
        | Rule::sided
        | Rule::side
        | Rule::side_arith
        | Rule::arguments
        | Rule::force
        | Rule::learned
        | Rule::leg
        | Rule::route => (0, "a number, a name or `(`".to_owned()),
        Rule::place | Rule::outline | Rule::paren => (0, "a point".to_owned()),
        Rule::set => (0, "a set".to_owned()),
        Rule::bound => (2, "a bound".to_owned()),
        Rule::bound_value => (0, "a time, a name or `(`".to_owned()),
        Rule::shape => (0, "a shape or a region".to_owned()),
        Rule::measure => (0, "`P(`, `E(` or `Q(`".to_owned()),
        Rule::relation => (0, "`>=`, `>`, `<=` or `<`".to_owned()),
        Rule::unit | Rule::unit_factor | Rule::point_unit => (2, "a unit".to_owned()),
        Rule::item | Rule::property_item => (6, "a declaration".to_owned()),
        Rule::EOI => (6, "the end of the line".to_owned()),
        Rule::scene_item
        | Rule::process_item
        | Rule::behaviour_item
        | Rule::state_item
        | Rule::move_option => {
            let words = words(rule).iter().map(|word| format!("`{word}`")).collect::<Vec<_>>();
            (6, list(&words))
        }
        Rule::field | Rule::limited => (6, "`name = value`".to_owned()),
        Rule::alternatives | Rule::line_of_paths => (6, "`roadmap alternatives`".to_owned()),
        Rule::clause => (7, "`within`, `confidence`, `by` or `under`".to_owned()),
        Rule::block => (4, "`{`".to_owned()),
        Rule::update | Rule::update_list | Rule::updates | Rule::branch | Rule::branches => {
            (0, "an update".to_owned())
        }
        Rule::choice | Rule::choices | Rule::line_of_answers | Rule::line_of_choices => {
            (0, "a name".to_owned())
        }
        Rule::recorded
        | Rule::with
        | Rule::preset
        | Rule::only
        | Rule::group_of
        | Rule::except
        | Rule::then_leave
        | Rule::rate
        | Rule::delay
        | Rule::moment
        | Rule::measure_range
        | Rule::particle
        | Rule::walkable => (8, format!("`{}`", words(rule).first()?)),
        _ => return None,
    })
}

/// Whether a word starts declarations of either language.
pub(super) fn starts_declaration(word: &str) -> bool {
    [Rule::item, Rule::property_item].iter().any(|&rule| words(rule).contains(&word))
}

/// The text found, for a message.
pub(super) fn quote(found: &str) -> String {
    let short: String = found.chars().take(40).flat_map(char::escape_debug).collect();
    // A quoted text keeps its quotes as they are.
    format!("`{}`", short.replace("\\\"", "\"").replace("\\'", "'"))
}

/// `a`, `a or b`, `a, b or c`.
pub(super) fn list(nouns: &[String]) -> String {
    match nouns {
        [] => String::new(),
        [only] => only.clone(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}

/// The known word that is nearest to what was written, if near enough.
pub(super) fn nearest<'w>(word: &str, known: impl Iterator<Item = &'w str>) -> Option<&'w str> {
    let length = word.chars().count();
    if !(2..=40).contains(&length) {
        return None;
    }
    let allowed = (length / 3).clamp(1, 3);
    known
        .map(|candidate| (edits(word, candidate), candidate))
        .filter(|&(distance, candidate)| {
            distance <= allowed && candidate.chars().count() > distance && candidate != word
        })
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// Insertions, deletions, replacements and swaps of neighbours between two words (Damerau 1964, the
/// restricted distance).
pub fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let width = b.len() + 1;
    let mut before = vec![0; width];
    let mut above: Vec<usize> = (0..width).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; width];
        for j in 1..=b.len() {
            let other = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (above[j] + 1).min(row[j - 1] + 1).min(above[j - 1] + other);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = above;
        above = row;
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("propery", "property"), 1);
        assert_eq!(edits("proeprty", "property"), 1);
        assert_eq!(edits("", "ab"), 2);
    }

    #[test]
    fn only_near_words_are_suggested() {
        assert_eq!(nearest("estimte", ["check", "estimate"].into_iter()), Some("estimate"));
        assert_eq!(nearest("banana", ["check", "estimate"].into_iter()), None);
        assert_eq!(nearest("x", ["P"].into_iter()), None);
    }
}
