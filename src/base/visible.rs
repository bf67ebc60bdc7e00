//! Safe display of arbitrary text: control characters and invisible characters become escapes.

use std::borrow::Cow;

/// Most digits of a number in a message: more than any double needs that is near 1.
const DIGITS: usize = 24;

/// Whether a character is obeyed by a terminal or not seen: controls but the line end and the tab, marks of direction,
/// characters without width, line separators, tags (Unicode categories Cc, Cf, Zl and Zp).
const fn is_hidden(c: char) -> bool {
    match c {
        '\n' | '\t' => false,
        '\0'..='\u{1F}' | '\u{7F}'..='\u{9F}' => true,
        '\u{AD}' | '\u{600}'..='\u{605}' | '\u{61C}' | '\u{6DD}' | '\u{70F}' => true,
        '\u{890}' | '\u{891}' | '\u{8E2}' | '\u{180E}' => true,
        '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}' => true,
        '\u{FEFF}' | '\u{FFF9}'..='\u{FFFB}' | '\u{110BD}' | '\u{110CD}' => true,
        '\u{13430}'..='\u{1343F}' | '\u{1BCA0}'..='\u{1BCA3}' | '\u{1D173}'..='\u{1D17A}' => true,
        '\u{E0000}'..='\u{E0FFF}' => true,
        _ => false,
    }
}

/// Adds a character as it is shown.
pub fn push(text: &mut String, c: char) {
    if is_hidden(c) { text.extend(c.escape_unicode()) } else { text.push(c) }
}

/// A text as it is shown.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    text.chars().for_each(|c| push(&mut shown, c));
    Cow::Owned(shown)
}

/// A text whose characters that nobody sees stand as visible ones of as many bytes, so that places in it stay. Controls of
/// one byte stay.
pub fn same_length(text: &str) -> Cow<'_, str> {
    let is_replaced = |c: char| is_hidden(c) && c.len_utf8() > 1;
    if !text.contains(is_replaced) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| match c.len_utf8() {
        _ if !is_replaced(c) => c,
        2 => '\u{B7}',
        3 => char::REPLACEMENT_CHARACTER,
        _ => '\u{1F6AB}',
    };
    Cow::Owned(text.chars().map(shown).collect())
}

/// A text in which numbers of more than `DIGITS` digits are written with an exponent: `1e300`.
pub fn shortened(text: String) -> String {
    if text.len() <= DIGITS {
        return text;
    }
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let mut shown = String::with_capacity(text.len());
    for part in text.split_inclusive(|c| !is_digit(c)) {
        let number = part.trim_end_matches(|c: char| !c.is_ascii_digit());
        let is_alone = !shown.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        match number.parse::<f64>() {
            Ok(value) if number.len() > DIGITS && value.is_finite() && is_alone => {
                shown.push_str(&format!("{value:e}"));
                shown.push_str(&part[number.len()..]);
            }
            _ => shown.push_str(part),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_many_digits_are_written_with_an_exponent() {
        for (value, shown) in
            [(1e300, "1e300"), (5e-324, "5e-324"), (-1e30, "-1e30"), (1e15, "1000000000000000")]
        {
            assert_eq!(
                shortened(format!("got {value} s, é {value}.")),
                format!("got {shown} s, é {shown}."),
                "{value}"
            );
        }
        let name = format!("`a{}` has 0.30000000000000004 m", "1".repeat(40));
        assert_eq!(shortened(name.clone()), name);
    }

    #[test]
    fn what_a_terminal_obeys_and_what_nobody_sees_is_escaped() {
        assert_eq!(visible("\u{1b}[31mred\r\n\ta"), "\\u{1b}[31mred\\u{d}\n\ta");
        assert_eq!(
            visible("a\u{202E}b\u{2066}c\u{200B}\u{9b}d\u{E0041}"),
            "a\\u{202e}b\\u{2066}c\\u{200b}\\u{9b}d\\u{e0041}"
        );
        let odd = "a\u{85}b\u{202E}c\u{E0041}\u{1b}";
        assert_eq!(same_length(odd), "a\u{B7}b\u{FFFD}c\u{1F6AB}\u{1b}");
        assert_eq!(same_length(odd).len(), odd.len());
        for plain in ["", "Zürich → Ωm² 日本 🚶 /m^2", "a\tb\n"] {
            assert!(matches!(visible(plain), Cow::Borrowed(same) if same == plain));
        }
    }
}
