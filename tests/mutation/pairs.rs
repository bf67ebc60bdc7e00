//! Two slips in one pair of files: neither hides the other.

use super::front::{Pair, errors, pairs};
use super::tokens;
use smc::syntax::diagnostic::Diagnostic;
use smc::syntax::render::render;
use std::ops::Range;

/// A token of one of the two files, and what it is mistaken for.
#[derive(Clone)]
struct Slip {
    file: usize,
    token: Range<usize>,
    wrong: String,
    is_unit: bool,
    /// Of its error, when it is the only slip.
    code: &'static str,
}

/// The texts with some slips, and where these are.
fn with_slips(pair: &Pair, slips: &[&Slip]) -> ([String; 2], Vec<(usize, Range<usize>)>) {
    let mut texts = pair.texts.clone();
    let mut sorted: Vec<(usize, &Slip)> = slips.iter().copied().enumerate().collect();
    sorted.sort_by_key(|(_, slip)| (slip.file, slip.token.start));
    let mut places = vec![(0, 0..0); slips.len()];
    let mut moved = [0_isize; 2];
    for (k, slip) in sorted {
        let start = slip.token.start.checked_add_signed(moved[slip.file]).unwrap();
        texts[slip.file].replace_range(start..start + slip.token.len(), &slip.wrong);
        moved[slip.file] += slip.wrong.len() as isize - slip.token.len() as isize;
        places[k] = (slip.file, start..start + slip.wrong.len());
    }
    (texts, places)
}

/// Whether some error is at a place.
fn told(found: &[Diagnostic], (file, place): &(usize, Range<usize>)) -> bool {
    let at = |span: smc::syntax::source::Span| {
        span.source.0 as usize == *file
            && (span.start as usize) < place.end
            && place.start < span.end as usize
    };
    found.iter().any(|one| one.place.iter().chain(&one.related).any(|label| at(label.span)))
}

/// The slips of a pair of files of which each alone is told once, at its place.
fn slips(pair: &Pair, every: usize) -> Vec<Slip> {
    let mut slips = Vec::new();
    for file in 0..2 {
        let text = &pair.texts[file];
        let tokens = tokens(text);
        for (k, token) in tokens.iter().enumerate().step_by(every) {
            let written = &text[token.clone()];
            let named = written.starts_with(|c: char| c.is_alphabetic() || c == '_');
            let after_number = k > 0 && text[tokens[k - 1].clone()].starts_with(|c: char| c.is_ascii_digit());
            let wrong = match (named, after_number) {
                (true, true) => if written == "kg" { "s" } else { "kg" }.to_owned(),
                (true, false) => format!("qx{k}z"),
                _ => continue,
            };
            let mut slip = Slip { file, token: token.clone(), wrong, is_unit: after_number, code: "" };
            let (texts, places) = with_slips(pair, &[&slip]);
            let (_, found) = errors([&texts[0], &texts[1]], &pair.files);
            let exact = |one: &Diagnostic| {
                one.place.as_ref().is_some_and(|place| {
                    place.span.source.0 as usize == file
                        && place.span.start as usize
                            >= places[0].1.start.saturating_sub(if after_number { 24 } else { 0 })
                        && place.span.end as usize <= places[0].1.end + 24
                })
            };
            if let [one] = found.as_slice()
                && exact(one)
                && told(&found, &places[0])
                && !one.code.is_of("E01")
            {
                slip.code = one.code.name();
                slips.push(slip);
            }
        }
    }
    slips
}

/// Whether what is wrong with the second of two tokens of a line hangs on what the first is meant to be: members of what
/// nobody knows, states of a behaviour that nobody knows, the unit of what is set or called by an unknown name, the parts
/// of one unit, the arguments of an unknown procedure, and what stands right after a slip, with no sign between.
fn hangs_on(text: &str, first: &Slip, second: &Slip) -> bool {
    if first.file != second.file || first.token.end > second.token.start {
        return false;
    }
    let between = &text[first.token.end..second.token.start];
    let member = text[..first.token.start].ends_with('.');
    let unknown = ["E0203", "E0207"].contains(&first.code);
    !between.contains('\n')
        && (["", "."].contains(&between.trim())
            || member && between.trim() == "=="
            || second.is_unit && unknown
            || first.is_unit && between.trim_matches(['/', '^', '2', '(', ' ']).is_empty()
            || first.code == "E0603")
}

#[test]
fn no_slip_hides_another() {
    check(9);
}

#[test]
#[ignore = "takes minutes"]
fn no_slip_of_any_token_hides_another() {
    check(1);
}

/// Slips at every n-th token of each text.
fn check(every: usize) {
    let (mut asked, mut hidden, mut more) = (0_u32, Vec::new(), 0_u32);
    for pair in pairs() {
        let slips = slips(&pair, every);
        for (k, first) in slips.iter().enumerate() {
            for apart in [1, 2, 3, 11, slips.len() / 2] {
                let second = &slips[(k + apart) % slips.len()];
                let text = &pair.texts[first.file];
                let same = second.token == first.token && second.file == first.file;
                if same || hangs_on(text, first, second) || hangs_on(text, second, first) {
                    continue;
                }
                let (texts, places) = with_slips(&pair, &[first, second]);
                let (sources, found) = errors([&texts[0], &texts[1]], &pair.files);
                asked += 1;
                more += u32::from(found.len() > 2);
                if !places.iter().all(|place| told(&found, place)) {
                    let line = |place: &(usize, Range<usize>)| {
                        let text = &texts[place.0];
                        let number = super::line(text, place.1.start);
                        text.lines().nth(number).unwrap().to_owned()
                    };
                    hidden.push(format!(
                        "{}: `{}` and `{}` in\n    {}\n    {}\n{}",
                        pair.name,
                        first.wrong,
                        second.wrong,
                        line(&places[0]),
                        line(&places[1]),
                        render(&found, &sources, false)
                    ));
                }
            }
        }
    }
    // Nor do two slips make a third error, but for a few.
    assert!(more * 50 < asked, "{more} of {asked}");
    assert!(hidden.len() as u32 * 100 < asked, "{} of {asked}\n{}", hidden.len(), hidden.join("\n"));
}
