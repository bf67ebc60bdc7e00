//! Colours of a text report: the eight ANSI colours and two weights, or none.

use crate::engine::outcome::Status;

/// Paints words, or leaves them plain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Palette {
    colours: bool,
}

/// The kind of a word, which determines its color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// All is well.
    Good,
    /// It is not.
    Bad,
    /// Look here.
    Caution,
    /// Neither good nor bad.
    Neutral,
    /// Stands out.
    Strong,
    /// Stands back.
    Faint,
}

impl Paint {
    /// Its class in a page.
    pub(super) const fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Bad => "bad",
            Self::Caution => "caution",
            Self::Neutral | Self::Strong => "plain",
            Self::Faint => "faint",
        }
    }
}

/// How an option of a ranking looks.
impl From<Status> for Paint {
    fn from(status: Status) -> Self {
        match status {
            Status::Chosen | Status::Front => Self::Good,
            Status::Tied => Self::Neutral,
            Status::Beaten | Status::Excluded => Self::Faint,
            Status::Open => Self::Caution,
        }
    }
}

impl Palette {
    /// Leaves everything plain.
    pub const PLAIN: Self = Self { colours: false };
    /// Paints with ANSI codes.
    pub const ANSI: Self = Self { colours: true };

    /// The code of a colour or weight that a text begins with.
    pub fn code(text: &str) -> Option<&str> {
        let inside = text.strip_prefix("\u{1b}[")?;
        let end = inside.find(|c: char| c != ';' && !c.is_ascii_digit())?;
        inside[end..].starts_with('m').then(|| &text[..end + 3])
    }

    /// A text as it shall look.
    pub fn paint(self, paint: Paint, text: &str) -> String {
        if !self.colours || text.is_empty() {
            return text.to_owned();
        }
        let code = match paint {
            Paint::Good => "1;32",
            Paint::Bad => "1;31",
            Paint::Caution => "1;33",
            Paint::Neutral => "1;36",
            Paint::Strong => "1",
            Paint::Faint => "2",
        };
        format!("\u{1b}[{code}m{text}\u{1b}[0m")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_is_plain_and_paint_is_taken_back() {
        assert_eq!(Palette::PLAIN.paint(Paint::Bad, "no"), "no");
        assert_eq!(Palette::ANSI.paint(Paint::Bad, "no"), "\u{1b}[1;31mno\u{1b}[0m");
        assert_eq!(Palette::ANSI.paint(Paint::Bad, ""), "");
    }
}
