//! Places of the protocol, which are lines and columns of UTF-16 from 0, and places of the sources, which are bytes; files and
//! their addresses.

use crate::syntax::source::{Source, Span};
use lsp_types::{Position, Range};
use std::path::{Component, Path, PathBuf};

/// The position of a byte.
pub(super) fn position(source: &Source, byte: u32) -> Position {
    let start = source.line_start(byte);
    let before = source.slice(Span { source: source.id, start, end: byte.min(source.line_end(byte)) });
    Position::new(source.line(byte) as u32 - 1, before.encode_utf16().count() as u32)
}

/// The range of a span.
pub(super) fn range(source: &Source, span: Span) -> Range {
    Range::new(position(source, span.start), position(source, span.end))
}

/// The byte of a position; one behind the end of its line or of the text is moved there.
pub(super) fn byte(source: &Source, position: Position) -> u32 {
    let mut units = 0;
    let start = source.start_of_line(position.line as usize + 1);
    let line = source.slice(Span { source: source.id, start, end: source.line_end(start) });
    let is_before = |(_, c): &(usize, char)| {
        units += c.len_utf16() as u32;
        units <= position.character
    };
    start
        + line
            .char_indices()
            .take_while(is_before)
            .map(|(at, c)| (at + c.len_utf8()) as u32)
            .last()
            .unwrap_or(0)
}

/// Whether an address is that of a property file.
pub(super) fn asks(uri: &str) -> bool {
    Path::new(uri).extension().is_some_and(|ending| ending == "bltl")
}

/// The path of an address, if it is a file.
pub(super) fn path(uri: &str) -> Option<PathBuf> {
    let escaped = uri.strip_prefix("file://")?.as_bytes();
    let (mut bytes, mut at) = (Vec::with_capacity(escaped.len()), 0);
    while let Some(byte) = escaped.get(at) {
        let code = escaped.get(at + 1..at + 3).filter(|_| *byte == b'%');
        let code = code.and_then(|code| u8::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*byte));
        at += if code.is_some() { 3 } else { 1 };
    }
    let path = String::from_utf8(bytes).ok()?;
    // `/C:/plans`: a drive.
    let is_drive = path.as_bytes().get(2) == Some(&b':');
    Some(PathBuf::from(if is_drive { path.trim_start_matches('/') } else { &path }))
}

/// The address of a file.
pub(super) fn uri(path: &Path) -> String {
    let path = path.to_string_lossy().replace('\\', "/");
    let mut uri = if path.starts_with('/') { "file://".to_owned() } else { "file:///".to_owned() };
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' | b'~' => {
                uri.push(char::from(byte));
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

/// A path without `.` and `..`, as far as that can be told from its words.
pub(super) fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if plain.file_name().is_some() => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::source::SourceId;

    #[test]
    fn columns_count_units_of_utf16() {
        let source = Source::new(SourceId(0), "a.scn", "aé𝄞b\r\n\r\nlast");
        for (byte_at, line, character) in
            [(0, 0, 0), (1, 0, 1), (3, 0, 2), (7, 0, 4), (8, 0, 5), (12, 2, 0), (16, 2, 4)]
        {
            assert_eq!(position(&source, byte_at), Position::new(line, character));
            assert_eq!(byte(&source, Position::new(line, character)), byte_at);
        }
        assert_eq!(byte(&source, Position::new(0, 3)), 3, "the middle of a character");
        assert_eq!(byte(&source, Position::new(2, 99)), 16);
        assert_eq!(byte(&source, Position::new(99, 0)), 16);
        assert_eq!(byte(&Source::new(SourceId(0), "a.scn", ""), Position::new(1, 1)), 0);
    }

    #[test]
    fn addresses_lead_to_files_and_back() {
        for name in ["/home/a b/ü%.scn", "/x/y-z_1~.bltl"] {
            assert_eq!(path(&uri(Path::new(name))).as_deref(), Some(Path::new(name)));
        }
        assert_eq!(path("file:///a%2"), Some(PathBuf::from("/a%2")));
        assert_eq!(path("untitled:Untitled-1"), None);
        assert_eq!(plain(Path::new("/a/./b/../c.scn")), Path::new("/a/c.scn"));
    }
}
