//! The formatter of both languages.
//!
//! It keeps the tokens and sets the blanks between them, so that every comment, number and parenthesis stays as
//! it was written and the tree cannot change. Members of a block stand one on a line, indented by two; a
//! block that was written on one line stays there while it fits. `=` signs and comments of adjacent lines are
//! aligned. Of several empty lines one stays; line breaks inside an expression stay.

mod lines;
mod token;
mod writer;

use super::diagnostic::{Diagnostic, Severity};
use super::parse::grammar::Rule;
use super::parse::layout::{Layout, Token, tokens};
use super::parse::{parse_properties, parse_scenario};
use super::source::{Source, Span};

/// Formats a scenario; its errors if it has any.
pub fn format_scenario(source: &Source) -> Result<String, Vec<Diagnostic>> {
    format(source, Rule::line_of_scenario, parse_scenario(source).1)
}

/// Formats a property file; its errors if it has any.
pub fn format_properties(source: &Source) -> Result<String, Vec<Diagnostic>> {
    format(source, Rule::line_of_properties, parse_properties(source).1)
}

/// The lines between two bytes as the formatter has them, and their place, which begins with a line that stays one. None where
/// the text has errors, or nothing is to be changed.
pub fn format_lines(source: &Source, formatted: &str, from: u32, to: u32) -> Option<(Span, String)> {
    let text = &source.text;
    // The formatter keeps the tokens: a range of lines becomes the lines of the same tokens.
    let (before, after) = (tokens(text), tokens(formatted));
    let starts =
        |text: &str, at: usize| text[..at].rsplit('\n').next().is_some_and(|line| line.trim().is_empty());
    let line = source.line_start(from) as usize;
    let mut first = before.partition_point(|token| token.at < line).min(before.len().checked_sub(1)?);
    while first > 0 && !(starts(text, before[first].at) && starts(formatted, after.get(first)?.at)) {
        first -= 1;
    }
    let last = before.partition_point(|token| token.at < to as usize).checked_sub(1)?;
    let lines = |text: &str, tokens: &[Token<'_>]| {
        let (first, last) = (tokens.get(first)?, tokens.get(last)?);
        Some(text[..first.at].rfind('\n').map_or(0, |at| at + 1)..last.end())
    };
    let (old, new) = (lines(text, &before)?, lines(formatted, &after)?);
    let (is_range, place) = (first <= last, Span::new(source.id, old.start, old.end));
    (is_range && text[old] != formatted[new.clone()]).then(|| (place, formatted[new].to_owned()))
}

fn format(source: &Source, rule: Rule, diagnostics: Vec<Diagnostic>) -> Result<String, Vec<Diagnostic>> {
    let errors: Vec<_> =
        diagnostics.into_iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    let layout = Layout::of(&source.text, tokens(&source.text), rule == Rule::line_of_properties);
    let members = token::members(&layout, &layout.items, rule);
    // A comment of several lines keeps its line ends, and they are all of one kind.
    Ok(lines::join(writer::write(&source.text, &members)).replace("\r\n", "\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::source::SourceId;

    fn scenario(text: &str) -> String {
        format_scenario(&Source::new(SourceId(0), "a.scn", text)).unwrap()
    }

    fn properties(text: &str) -> String {
        format_properties(&Source::new(SourceId(0), "a.bltl", text)).unwrap()
    }

    #[test]
    fn blanks_are_set_by_what_stands_beside_them() {
        let text = properties(
            "property  p=G<=10 s(forall a in others( user ):gap(a)>0.1m&!q&-x^2<- -3)U [ 1s,2 s ]r",
        );
        assert_eq!(
            text,
            "property p = G<=10 s (forall a in others(user): gap(a) > 0.1 m & !q & -x^2 < - -3) U[1 s, 2 s] r\n"
        );
        assert_eq!(properties("let a=2 m ^2*1 / 2"), "let a = 2 m ^ 2 * 1/2\n");
        assert_eq!(
            properties("rank a in 1 m..3 m by 1 m ,b in 1,2 ,c in 1 .. 9 by log 3 by P(x)within 0.1"),
            "rank a in 1 m .. 3 m by 1 m, b in 1, 2, c in 1 .. 9 by log 3 by P(x) within 0.1\n"
        );
        assert_eq!(properties("let a=3 kg /( m  s )/ 2 s"), "let a = 3 kg/(m s) / 2 s\n");
    }

    #[test]
    fn blocks_written_on_one_line_stay_there() {
        assert_eq!(scenario("kind a:b{x=1;y=2}"), "kind a: b { x = 1; y = 2 }\n");
        assert_eq!(scenario("kind a:b{x=1\nyy=2}"), "kind a: b {\n  x  = 1\n  yy = 2\n}\n");
        assert_eq!(scenario("scene{}"), "scene {}\n");
        assert_eq!(
            scenario("moves a for 2 s{route b=(1,2)->c then leave\nroute long=c\nstop}"),
            "moves a for 2 s {\n  route b    = (1, 2) -> c then leave\n  route long = c\n  stop\n}\n"
        );
        let import = "scene {\n  import \"a.json\" where level == 2 { snap = 5 cm }\n  region a: rect (0, 0) .. (1, 1)\n}\n";
        assert_eq!(scenario(import), import);
        assert_eq!(
            scenario("scene{line  a:(0,1)--(2,b) // n\n}"),
            "scene {\n  line a: (0, 1) -- (2, b)  // n\n}\n"
        );
        assert_eq!(
            scenario("scene{import \"a.wkt\"as  walkable{snap=5cm}}"),
            "scene { import \"a.wkt\" as walkable { snap = 5 cm } }\n"
        );
    }

    #[test]
    fn comments_in_one_column_stay_in_one_column() {
        let text = "\
process  p {       // open
  var a: 0..1 = 0  // a
  var bbbbbbb: 0..1 = 0
  when a == 0 -> a = 1
  var c: 0..1 = 0  // c
}                  // close

const d = 1        // apart
";
        let expected = "\
process p {          // open
  var a: 0 .. 1 = 0  // a
  var bbbbbbb: 0 .. 1 = 0
  when a == 0 -> a = 1
  var c: 0 .. 1 = 0  // c
}                    // close

const d = 1  // apart
";
        assert_eq!(scenario(text), expected);
        assert_eq!(scenario(expected), expected);
    }

    #[test]
    fn line_ends_are_of_one_kind() {
        let text = "scenario \"A\" // one\n/* two\n   three */\nhorizon = 3 s\n\n// four\nstep = 1 s /* five\n  six */\n";
        let formatted = scenario(text);
        assert_eq!(scenario(&text.replace('\n', "\r\n")), formatted);
        assert!(!formatted.contains('\r'), "{formatted:?}");
    }

    #[test]
    fn comments_stay() {
        let text = "// top\n\n\n\nconst a=1 // one\nconst bb=2// two\n/* own */\nkind k:b{  // open\n  x=1 // last\n  // alone\n}\n// end";
        assert_eq!(
            scenario(text),
            "// top\n\nconst a  = 1  // one\nconst bb = 2  // two\n/* own */\nkind k: b {  // open\n  x = 1  // last\n  // alone\n}\n// end\n"
        );
        assert_eq!(
            properties("let a = 1 + // why\n2 /* two */ + 3"),
            "let a = 1 +  // why\n    2 /* two */ + 3\n"
        );
    }
}
