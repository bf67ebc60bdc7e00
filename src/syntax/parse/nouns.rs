//! What the rules of the grammar are called for people, and which known word is nearest.

use super::grammar::Rule;

/// The word of a keyword rule.
pub(super) fn keyword(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::kw_across => "across",
        Rule::kw_after => "after",
        Rule::kw_agent => "agent",
        Rule::kw_agents => "agents",
        Rule::kw_along => "along",
        Rule::kw_alternatives => "alternatives",
        Rule::kw_as => "as",
        Rule::kw_at => "at",
        Rule::kw_behaviour => "behaviour",
        Rule::kw_by => "by",
        Rule::kw_check => "check",
        Rule::kw_choose => "choose",
        Rule::kw_circle => "circle",
        Rule::kw_compare => "compare",
        Rule::kw_confidence => "confidence",
        Rule::kw_const => "const",
        Rule::kw_count => "count",
        Rule::kw_end => "end",
        Rule::kw_estimate => "estimate",
        Rule::kw_except => "except",
        Rule::kw_exists => "exists",
        Rule::kw_family => "family",
        Rule::kw_for => "for",
        Rule::kw_forall => "forall",
        Rule::kw_from => "from",
        Rule::kw_group => "group",
        Rule::kw_groups => "groups",
        Rule::kw_heading => "heading",
        Rule::kw_hole => "hole",
        Rule::kw_id => "id",
        Rule::kw_import => "import",
        Rule::kw_in => "in",
        Rule::kw_kind => "kind",
        Rule::kw_label => "label",
        Rule::kw_leave => "leave",
        Rule::kw_let => "let",
        Rule::kw_limit => "limit",
        Rule::kw_line => "line",
        Rule::kw_log => "log",
        Rule::kw_moves => "moves",
        Rule::kw_near => "near",
        Rule::kw_obstacle => "obstacle",
        Rule::kw_of => "of",
        Rule::kw_on => "on",
        Rule::kw_param => "param",
        Rule::kw_particle => "particle",
        Rule::kw_paths => "paths",
        Rule::kw_periodic => "periodic",
        Rule::kw_point => "point",
        Rule::kw_polygon => "polygon",
        Rule::kw_preset => "preset",
        Rule::kw_process => "process",
        Rule::kw_property => "property",
        Rule::kw_radius => "radius",
        Rule::kw_rank => "rank",
        Rule::kw_rect => "rect",
        Rule::kw_region => "region",
        Rule::kw_roadmap => "roadmap",
        Rule::kw_search => "search",
        Rule::kw_learned => "learned",
        Rule::kw_route => "route",
        Rule::kw_scenario => "scenario",
        Rule::kw_scene => "scene",
        Rule::kw_source => "source",
        Rule::kw_state => "state",
        Rule::kw_stream => "stream",
        Rule::kw_stop => "stop",
        Rule::kw_then => "then",
        Rule::kw_to => "to",
        Rule::kw_tracks => "tracks",
        Rule::kw_under => "under",
        Rule::kw_uniform => "uniform",
        Rule::kw_var => "var",
        Rule::kw_wait => "wait",
        Rule::kw_walkable => "walkable",
        Rule::kw_wall => "wall",
        Rule::kw_when => "when",
        Rule::kw_where => "where",
        Rule::kw_with => "with",
        Rule::kw_within => "within",
        _ => return None,
    })
}

/// Words that are operators in property files, and no names.
pub(super) const OPERATORS: [&str; 8] = ["forall", "exists", "F", "G", "X", "U", "W", "R"];

/// Whether a word is a keyword of either language.
pub(super) fn is_keyword(word: &str) -> bool {
    Rule::all_rules().iter().any(|&rule| keyword(rule) == Some(word))
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
        Rule::t_lbrace => "{",
        Rule::t_rbrace => "}",
        Rule::t_comma => ",",
        Rule::t_colon => ":",
        Rule::t_dots => "..",
        Rule::t_arrow => "->",
        Rule::t_line => "--",
        Rule::t_assign => "=",
        Rule::measure_p => "P",
        Rule::measure_e => "E",
        Rule::measure_q => "Q",
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

/// The words that a rule of several alternatives may start with.
pub(super) fn words(rule: Rule) -> &'static [&'static str] {
    match rule {
        Rule::item | Rule::item_end => &[
            "scenario",
            "horizon",
            "step",
            "const",
            "param",
            "let",
            "tracks",
            "scene",
            "kind",
            "agent",
            "agents",
            "group",
            "groups",
            "moves",
            "paths",
            "process",
            "behaviour",
            "source",
        ],
        Rule::property_item | Rule::property_item_end => {
            &["property", "let", "const", "family", "check", "estimate", "compare", "rank"]
        }
        Rule::scene_item | Rule::scene_item_end => {
            &["wall", "obstacle", "region", "point", "line", "import", "periodic"]
        }
        Rule::process_item | Rule::process_item_end => &["var", "let", "label", "when", "choose"],
        Rule::behaviour_item | Rule::behaviour_item_end => &["state", "on", "let"],
        Rule::state_item | Rule::state_item_end | Rule::transition => &["after", "when"],
        Rule::move_option | Rule::move_end => &["heading", "route", "stop"],
        Rule::clause => &["within", "confidence", "by", "under"],
        Rule::body | Rule::recorded => &["from"],
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
    }
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
        | Rule::route
        | Rule::move_route => (0, "a number, a name or `(`".to_owned()),
        Rule::place | Rule::outline | Rule::paren => (0, "a point".to_owned()),
        Rule::set => (0, "a set".to_owned()),
        Rule::bound => (2, "a bound".to_owned()),
        Rule::bound_value => (0, "a time, a name or `(`".to_owned()),
        Rule::shape => (0, "a shape or a region".to_owned()),
        Rule::measure => (0, "`P(`, `E(` or `Q(`".to_owned()),
        Rule::relation => (0, "`>=`, `>`, `<=` or `<`".to_owned()),
        Rule::unit | Rule::unit_factor | Rule::point_unit => (2, "a unit".to_owned()),
        Rule::item | Rule::property_item => (6, "a declaration".to_owned()),
        Rule::item_end | Rule::property_item_end => (6, "the next declaration".to_owned()),
        Rule::scene_item
        | Rule::process_item
        | Rule::behaviour_item
        | Rule::state_item
        | Rule::move_option => {
            let words = words(rule).iter().map(|word| format!("`{word}`")).collect::<Vec<_>>();
            (6, list(&words))
        }
        Rule::field | Rule::limited => (6, "`name = value`".to_owned()),
        Rule::alternatives => (6, "`roadmap alternatives`".to_owned()),
        Rule::scene_item_end
        | Rule::process_item_end
        | Rule::behaviour_item_end
        | Rule::state_item_end
        | Rule::field_end
        | Rule::move_end => (6, "the next line of the block".to_owned()),
        Rule::clause => (7, "`within`, `confidence`, `by` or `under`".to_owned()),
        Rule::fields | Rule::no_body => (4, "`{`".to_owned()),
        Rule::update | Rule::updates | Rule::branch | Rule::branches => (0, "an update".to_owned()),
        Rule::choice | Rule::choices => (0, "a name".to_owned()),
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
