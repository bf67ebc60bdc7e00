//! Floor 8: reports of a run, one file per format.
//!
//! A report is a function of a [`CallResult`]; no clock and no environment. What a verdict must say follows
//! `docs/results.md`: the certified statement, the estimate with its interval and the kind of that
//! interval, all counts, why sampling stopped, and the command that gives the result again.

pub mod advice;
pub mod advised;
pub mod behaviours;
pub mod brief;
pub mod calibration;
pub mod certificate;
pub mod csv;
mod escape;
pub mod evaluate;
mod exit;
pub mod figure;
pub mod fit;
pub mod forecast;
pub mod gait;
pub mod github;
pub mod html;
pub mod infer;
pub mod json;
pub mod junit;
pub mod measure;
pub mod model;
pub mod monitor;
pub mod number;
pub mod palette;
pub mod paths;
mod phrase;
mod scenery;
mod setting;
pub mod svg;
pub mod text;
pub mod walked;
pub mod walks;

pub use exit::{ExitCode, exit_code};
pub use palette::Palette;

use crate::base::visible::{self, visible};
use crate::engine::outcome::CallResult;

/// Formats of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// For people who check the numbers: text with the procedure of each query and all its numbers.
    Verbose,
    /// For people in a hurry: one line a query.
    Brief,
    /// A table, one row a result, an option or a side.
    Csv,
    /// One JSON object, `docs/schema/verdict.schema.json`.
    Json,
    /// `JUnit` XML for continuous integration.
    Junit,
    /// Workflow commands of GitHub.
    Github,
}

impl Format {
    /// Whether programs read it, who want an answer in every case.
    pub const fn is_for_programs(self) -> bool {
        !matches!(self, Self::Text | Self::Verbose | Self::Brief)
    }
}

/// The report of a run, ending with a line end. Only text for people uses the palette.
pub fn render(run: &CallResult, format: Format, palette: Palette) -> String {
    match format {
        Format::Text | Format::Verbose => {
            let text = |palette| text::render(run, palette, format == Format::Verbose);
            painted(&text(Palette::PLAIN), &text(palette))
        }
        Format::Brief => painted(&brief::render(run, Palette::PLAIN), &brief::render(run, palette)),
        Format::Csv => visible(&csv::render(run)).into_owned(),
        Format::Json => json::render(run),
        Format::Junit => visible(&junit::render(run)).into_owned(),
        Format::Github => visible(&github::render(run)).into_owned(),
    }
}

/// A painted text as it is shown. Codes that stand in the plain text too are text; of equal ones in a row the first are those
/// of the palette.
fn painted(plain: &str, painted: &str) -> String {
    let repeats = |text: &str, code: &str| (text.len() - text.trim_start_matches(code).len()) / code.len();
    let (mut plain, mut painted, mut text) = (plain, painted, String::new());
    while let Some(c) = painted.chars().next() {
        let code = Palette::code(painted).filter(|code| repeats(painted, code) > repeats(plain, code));
        if let Some(code) = code {
            text.push_str(code);
            painted = &painted[code.len()..];
        } else {
            visible::push(&mut text, c);
            painted = &painted[c.len_utf8()..];
            plain = plain.get(c.len_utf8()..).unwrap_or_default();
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_codes_of_the_palette_reach_a_terminal() {
        let run =
            CallResult { scenario: "\u{1b}[1ma\u{1b}[0m\u{1b}]0;b\u{7}".to_owned(), ..CallResult::default() };
        let title = "\\u{1b}[1ma\\u{1b}[0m\\u{1b}]0;b\\u{7}";
        assert!(render(&run, Format::Text, Palette::PLAIN).starts_with(&format!("{title}\n")));
        let colored = render(&run, Format::Text, Palette::ANSI);
        assert!(colored.starts_with("\u{1b}[1m") && colored.contains(title), "{colored:?}");
        assert_eq!(
            colored.matches('\u{1b}').count(),
            2 * colored.matches("\u{1b}[0m").count(),
            "{colored:?}"
        );
    }
}
