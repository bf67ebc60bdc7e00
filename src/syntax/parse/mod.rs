//! From texts to syntax trees.
//!
//! Parsing never fails: what is broken is reported, each thing once and at its exact byte, and skipped; the
//! rest is returned.

mod agents;
mod anchor;
mod bounds;
mod braces;
mod builder;
mod code;
pub(super) mod comments;
mod expression;
mod fault;
mod foreign;
pub(super) mod grammar;
mod lexeme;
mod nesting;
mod nouns;
mod process;
mod property;
mod quantity;
mod recovery;
mod retry;
mod scenario;
mod scene;
mod slips;
mod units;

pub(crate) use foreign::word as foreign_word;
pub(crate) use lexeme::{continues_name, starts_name};
pub use nouns::edits;
pub(crate) use quantity::{time_meant, unit_meant};

pub(super) use builder::Pair;

use super::ast::{Expr, PropertyFile, ScenarioFile};

use super::diagnostic::{Diagnostic, Severity};
use super::source::{Source, SourceId, Span};
use builder::Builder;
use grammar::{Grammar, Rule};
use nesting::Scan;
use pest::Parser;
use std::cell::OnceCell;

/// Reads bytes as a source text: UTF-8, not empty, below 4 GiB.
#[allow(clippy::result_large_err, reason = "called once a file")]
pub fn decode(id: SourceId, name: &str, bytes: &[u8]) -> Result<Source, Diagnostic> {
    if u32::try_from(bytes.len()).is_err() {
        return Err(Diagnostic::placeless(code::ENCODING, format!("{name} is larger than 4 GiB")));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) if text.trim_matches(|c: char| c.is_whitespace() || c == '\u{FEFF}').is_empty() => {
            Err(Diagnostic::placeless(code::EMPTY, format!("{name} is empty")))
        }
        Ok(text) => Ok(Source::new(id, name, text)),
        Err(error) => {
            let at = error.valid_up_to();
            let valid = std::str::from_utf8(&bytes[..at]).unwrap_or("");
            let line = valid.matches('\n').count() + 1;
            let column = valid.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            let title = format!("{name}:{line}:{column} is not UTF-8: byte 0x{:02X}", bytes[at]);
            let hint = if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
                "the file looks like UTF-16; save it as UTF-8"
            } else {
                "save the file as UTF-8"
            };
            Err(Diagnostic::error(code::ENCODING, Span::new(id, at, at + 1), title).hint(hint))
        }
    }
}

/// Parses a scenario (`.scn`). What could not be read is missing from the tree and reported.
#[allow(clippy::redundant_closure_for_method_calls, reason = "the method has one lifetime, the closure any")]
pub fn parse_scenario(source: &Source) -> (ScenarioFile, Vec<Diagnostic>) {
    let (file, diagnostics) =
        mended(source, Rule::scenario_file, &|builder, file| builder.scenario_file(file));
    (file.unwrap_or_default(), diagnostics)
}

/// Parses a property file (`.bltl`). What could not be read is missing from the tree and reported.
#[allow(clippy::redundant_closure_for_method_calls, reason = "the method has one lifetime, the closure any")]
pub fn parse_properties(source: &Source) -> (PropertyFile, Vec<Diagnostic>) {
    parse_properties_of(source, false)
}

/// The same, where it is known whether the scenario counts steps: hints write times as it does.
pub fn parse_properties_of(source: &Source, counts_steps: bool) -> (PropertyFile, Vec<Diagnostic>) {
    let (file, diagnostics) = parse(source, &source.text, Rule::property_file, |builder, file| {
        builder.unit = if counts_steps { "" } else { " s" };
        builder.property_file(file)
    });
    (file.unwrap_or_default(), diagnostics)
}

/// Parses a file; one whose braces do not pair up as if they did, if that leaves fewer errors.
fn mended<T>(
    source: &Source,
    rule: Rule,
    build: &dyn Fn(&mut Builder<'_>, builder::Pair<'_>) -> T,
) -> (Option<T>, Vec<Diagnostic>) {
    let plain = parse(source, &source.text, rule, build);
    let count = |said: &[Diagnostic]| said.iter().filter(|one| one.severity == Severity::Error).count();
    if count(&plain.1) == 0 {
        return plain;
    }
    let joined = |said: Vec<Diagnostic>, slips: Vec<Diagnostic>| {
        let mut said = braces::together(source, said, slips);
        order(source, &mut said, &[]);
        said
    };
    let weigh = |text: &str, slips: Vec<Diagnostic>| {
        let said = parse(source, text, rule, build).1;
        let hidden = count(&said).min(braces::ONE - 1);
        count(&joined(said, slips)) * braces::ONE + hidden
    };
    let Some(mended) = braces::mend(source, &weigh) else { return plain };
    let (built, said) = parse(source, &mended.text, rule, build);
    let said = joined(said, mended.errors);
    if count(&said) <= count(&plain.1) { (built, said) } else { plain }
}

/// The parts of a text that are separated by commas outside brackets.
pub fn split_values(text: &str) -> Vec<&str> {
    let mut depth = 0i32;
    let outside = |c: char| {
        depth += i32::from(matches!(c, '(' | '[')) - i32::from(matches!(c, ')' | ']'));
        c == ',' && depth == 0
    };
    text.split(outside).collect()
}

/// Parses one value, such as the right side of `--set name=value`.
pub fn parse_value(source: &Source) -> Result<Expr, Vec<Diagnostic>> {
    let (value, diagnostics) = parse(source, &source.text, Rule::value_file, |builder, file| {
        file.into_inner().next().and_then(|value| builder.expr(value))
    });
    let fails = diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
    match value.flatten() {
        Some(value) if !fails => Ok(value),
        _ => Err(diagnostics),
    }
}

/// Runs the grammar once more, for the formatter.
pub(super) fn with_pairs<T>(
    source: &Source,
    rule: Rule,
    take: impl FnOnce(Pair<'_>) -> T,
) -> Result<T, Vec<Diagnostic>> {
    match parse(source, &source.text, rule, |_, file| take(file)) {
        (Some(taken), _) => Ok(taken),
        (None, diagnostics) => Err(diagnostics),
    }
}

/// Parses a text, which is that of the source or one as long.
fn parse<T>(
    source: &Source,
    text: &str,
    rule: Rule,
    build: impl FnOnce(&mut Builder<'_>, builder::Pair<'_>) -> T,
) -> (Option<T>, Vec<Diagnostic>) {
    let mut builder = Builder {
        source,
        text,
        root: rule,
        unit: " s",
        diagnostics: Vec::new(),
        cut: Vec::new(),
        lost: Vec::new(),
        anchors: Vec::new(),
        doubts: Vec::new(),
        resumed: Vec::new(),
        even: OnceCell::new(),
        braces: OnceCell::new(),
        arrows: OnceCell::new(),
        names: OnceCell::new(),
    };
    match nesting::scan(source, text) {
        Scan::Fine => {}
        Scan::TooDeep(diagnostic) => return (None, vec![diagnostic]),
        Scan::Until(at, diagnostic) => {
            builder.text = &text[..at];
            builder.say(diagnostic);
        }
    }
    let whole = text.len();
    let text = builder.text;
    let built = match Grammar::parse(rule, text) {
        Ok(mut pairs) => pairs.next().map(|file| {
            builder.report_unequal(&file);
            build(&mut builder, file)
        }),
        Err(error) => {
            builder.refused(error);
            None
        }
    };
    let mut diagnostics = builder.diagnostics;
    // An error at the end of a text that was cut there is a consequence of the cut.
    if text.len() < whole {
        let last = text.trim_end().len() as u32;
        diagnostics.retain(|diagnostic| {
            diagnostic.code == code::COMMENT
                || diagnostic.place.as_ref().is_none_or(|place| place.span.start < last)
        });
    }
    order(source, &mut diagnostics, &builder.resumed);
    (built, diagnostics)
}

/// Sorts by place, one a place, and leaves out what follows from the one before, unless reading was resumed between them.
fn order(source: &Source, diagnostics: &mut Vec<Diagnostic>, resumed: &[u32]) {
    diagnostics.sort_by_key(|diagnostic| diagnostic.place.as_ref().map(|place| place.span));
    diagnostics.dedup_by_key(|diagnostic| {
        diagnostic.place.as_ref().map(|place| (place.span.start, diagnostic.severity))
    });
    // A bracket without a partner on the line of an error has lost it there.
    let mut last: Option<u32> = None;
    diagnostics.retain(|diagnostic| {
        let Some(place) = diagnostic.place.as_ref().filter(|_| diagnostic.severity == Severity::Error) else {
            return true;
        };
        let start = place.span.start;
        let Some(before) = last.replace(start) else { return true };
        let between = resumed.partition_point(|at| *at <= before);
        diagnostic.code != code::STRAY
            || source.line(before) != source.line(start)
            || resumed.get(between).is_some_and(|at| *at <= start)
    });
}
