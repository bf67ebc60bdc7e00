//! Source texts and places in them.

/// Which of the sources of a call a place lies in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(pub u16);

/// A range of bytes of one source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The source.
    pub source: SourceId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The bytes `start .. end` of `source`.
    pub const fn new(source: SourceId, start: usize, end: usize) -> Self {
        Self { source, start: start as u32, end: end as u32 }
    }

    /// The smallest span that holds both (of the same source).
    pub fn to(self, other: Self) -> Self {
        Self { source: self.source, start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// Whether it holds another one.
    pub fn holds(self, other: Self) -> bool {
        self.source == other.source && self.start <= other.start && other.end <= self.end
    }
}

/// One source text and its name as the user wrote it.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Its number within the call.
    pub id: SourceId,
    /// File name as given, or `<stdin>`.
    pub name: String,
    /// The whole text.
    pub text: String,
    line_starts: Vec<u32>,
    /// Characters before each block of bytes.
    characters: Vec<u32>,
}

/// Bytes of a block.
const BLOCK: usize = 1 << 10;

/// How many characters start in some bytes.
fn starts(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|byte| !matches!(byte, 0x80..=0xBF)).count() as u32
}

impl Source {
    /// Wraps a text.
    pub fn new(id: SourceId, name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let line_starts =
            std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at as u32 + 1)).collect();
        let blocks = text.as_bytes().chunks(BLOCK).scan(0, |before, block| {
            let here = *before;
            *before += starts(block);
            Some(here)
        });
        let characters = blocks.collect();
        Self { id, name: name.into(), text, line_starts, characters }
    }

    /// How many characters start before a byte.
    fn characters_before(&self, byte: usize) -> usize {
        let byte = byte.min(self.text.len());
        // The end of the text may be the end of a block.
        let block = (byte / BLOCK).min(self.characters.len().saturating_sub(1));
        let before = self.characters.get(block).copied().unwrap_or(0);
        (before + starts(&self.text.as_bytes()[block * BLOCK..byte])) as usize
    }

    /// The line of a byte, from 1.
    pub fn line(&self, byte: u32) -> usize {
        self.line_starts.partition_point(|&start| start <= byte).max(1)
    }

    /// The first byte of the line of a byte.
    pub fn line_start(&self, byte: u32) -> u32 {
        self.line_starts[self.line(byte) - 1]
    }

    /// The first byte of a line, which counts from 1; the end of the text for a line behind the last one.
    pub fn start_of_line(&self, line: usize) -> u32 {
        self.line_starts.get(line.max(1) - 1).copied().unwrap_or(self.text.len() as u32)
    }

    /// The end of the line of a byte, before its line break.
    pub fn line_end(&self, byte: u32) -> u32 {
        self.line_starts.get(self.line(byte)).map_or(self.text.len() as u32, |next| next - 1)
    }

    /// Line and column of a byte, both from 1; the column counts characters.
    pub fn line_column(&self, byte: u32) -> (usize, usize) {
        let start = self.line_start(byte) as usize;
        let column = self.characters_before(byte as usize) - self.characters_before(start);
        (self.line(byte), column + 1)
    }

    /// The text of a span in one line.
    pub fn in_one_line(&self, span: Span) -> String {
        self.slice(span).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The text of a span.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.start as usize..span.end as usize).unwrap_or("")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_however_long_the_line() {
        for (part, times) in [("aé→𝄞 ", 1_000), ("a", 2 * BLOCK), ("é\n", 3), ("", 1), ("ab\n→", 700)]
        {
            let source = Source::new(SourceId(0), "a.scn", part.repeat(times));
            let (mut line, mut column) = (1, 1);
            let ends = source.text.char_indices().map(|(at, c)| (at, Some(c)));
            for (at, c) in ends.chain([(source.text.len(), None)]) {
                let byte = at as u32;
                assert_eq!(source.line_column(byte), (line, column), "{at} of {part:?}");
                let rest = &source.text[at..];
                assert_eq!(source.line_end(byte) as usize, at + rest.find('\n').unwrap_or(rest.len()));
                let before = source.text[..at].rfind('\n').map_or(0, |newline| newline + 1);
                assert_eq!(source.line_start(byte) as usize, before);
                (line, column) = if c == Some('\n') { (line + 1, 1) } else { (line, column + 1) };
            }
            assert_eq!(source.line_column(u32::MAX), source.line_column(source.text.len() as u32));
        }
    }
}
