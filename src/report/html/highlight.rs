//! The texts of scenarios and properties with their words marked and linked.

use super::links::Links;
use crate::report::escape::escape;
use crate::syntax::keywords::is_marked;
use std::fmt::Write as _;

/// A text as HTML, with the links of the text of that number; longer ones than `most` bytes are cut at the end of a line.
pub(super) fn highlighted(text: &str, most: usize, (links, number): (&Links, usize)) -> String {
    let shown = match text.get(..most) {
        Some(start) => &text[..start.rfind('\n').map_or(0, |at| at + 1)],
        None if text.len() > most => text.lines().next().unwrap_or_default(),
        None => text,
    };
    let mut html = String::with_capacity(2 * shown.len());
    let (mut line, mut is_first) = (1, true);
    for (word, class) in tokens(shown) {
        let is_word = is_word(&(word, class));
        let link = if is_word { links.start(word, (number, line), is_first) } else { None };
        let end = if link.is_some() { "</a>" } else { "" };
        let link = link.unwrap_or_default();
        let escaped = escape(word);
        let _ = match class {
            Some(class) => write!(html, "{link}<span class=\"{class}\">{escaped}</span>{end}"),
            None => write!(html, "{link}{escaped}{end}"),
        };
        is_first &= !is_word;
        if word.contains('\n') {
            line += word.matches('\n').count();
            is_first = true;
        }
    }
    if shown.len() < text.len() {
        let _ = write!(html, "… ({} more bytes)", text.len() - shown.len());
    }
    html
}

/// The tokens of a text with their classes.
fn tokens(text: &str) -> impl Iterator<Item = (&str, Option<&'static str>)> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let (length, class) = token(rest, rest.chars().next()?);
        let (word, after) = rest.split_at(length);
        rest = after;
        Some((word, class))
    })
}

/// The names and keywords of a text.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    tokens(text).filter(is_word).map(|(word, _)| word)
}

/// Whether a token is a name or a keyword.
fn is_word((word, class): &(&str, Option<&str>)) -> bool {
    class.is_none_or(|class| class == "keyword") && word.starts_with(begins_word)
}

fn begins_word(first: char) -> bool {
    first.is_alphabetic() || first == '_'
}

/// Length of the first token, and its class.
fn token(text: &str, first: char) -> (usize, Option<&'static str>) {
    let until =
        |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |at| from + at + end.len());
    let while_ = |is_part: &dyn Fn(char) -> bool| text.find(|c| !is_part(c)).unwrap_or(text.len());
    if text.starts_with("//") {
        return (text.find('\n').unwrap_or(text.len()), Some("comment"));
    }
    if text.starts_with("/*") {
        return (until("*/", 2), Some("comment"));
    }
    if first == '"' {
        return (until("\"", 1), Some("string"));
    }
    if first.is_ascii_digit() {
        return (while_(&|c| c.is_ascii_alphanumeric() || c == '_'), Some("number"));
    }
    if begins_word(first) {
        let length = while_(&|c| c.is_alphanumeric() || c == '_');
        return (length, is_marked(&text[..length]).then_some("keyword"));
    }
    (first.len_utf8(), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_marked_and_nothing_gets_out() {
        let plain = (&Links::default(), 0);
        let html = highlighted("let a = \"</pre>\" // <b>\nat=1.5", 1000, plain);
        assert_eq!(
            html,
            "<span class=\"keyword\">let</span> a = <span class=\"string\">&quot;&lt;/pre&gt;&quot;</span> \
             <span class=\"comment\">// &lt;b&gt;</span>\n<span class=\"keyword\">at</span>=<span class=\"number\">1</span>.\
             <span class=\"number\">5</span>"
        );
        assert_eq!(highlighted("é\n\"ü", 1000, plain), "é\n<span class=\"string\">&quot;ü</span>");
        assert_eq!(highlighted("a\nbb\n", 4, plain), "a\n… (3 more bytes)");
    }
}
