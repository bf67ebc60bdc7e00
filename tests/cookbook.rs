//! The page `docs/cookbook.md`: its commands run, print what the page says, and write the pictures and tables it names.

use crate::program::{Place, Said};
use std::fs::{copy, create_dir_all, read, read_dir, read_to_string};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Pictures are read in a browser beside the text: above this they load slowly.
const LARGEST_PICTURE: usize = 60_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page() -> String {
    read_to_string(root().join("docs/cookbook.md")).unwrap()
}

/// A part of a section between two fences, with what stands behind the first one.
struct Block<'p> {
    info: &'p str,
    lines: Vec<&'p str>,
}

/// A task: its blocks, and the lines outside of them.
struct Section<'p> {
    title: &'p str,
    blocks: Vec<Block<'p>>,
    prose: Vec<&'p str>,
}

fn sections(page: &str) -> Vec<Section<'_>> {
    let mut sections = vec![Section { title: "", blocks: Vec::new(), prose: Vec::new() }];
    let mut is_inside = false;
    for line in page.lines() {
        if let Some(title) = line.strip_prefix("## ").filter(|_| !is_inside) {
            sections.push(Section { title, blocks: Vec::new(), prose: Vec::new() });
        }
        let section = sections.last_mut().unwrap();
        if let Some(info) = line.strip_prefix("```") {
            is_inside = !is_inside;
            if is_inside {
                section.blocks.push(Block { info, lines: Vec::new() });
            }
        } else if is_inside {
            section.blocks.last_mut().unwrap().lines.push(line);
        } else {
            section.prose.push(line);
        }
    }
    assert!(!is_inside, "a fence is not closed");
    sections
}

/// Requires that the lines occur in this order. `…` stands for lines, or for a part of a line, that are left out.
fn occur(quoted: &[&str], text: &str, whence: &str) {
    let mut lines = text.lines();
    for wanted in quoted.iter().filter(|wanted| **wanted != "…") {
        assert!(lines.any(|line| matches(wanted, line)), "{whence}: `{wanted}` is not in\n{text}");
    }
}

fn matches(wanted: &str, line: &str) -> bool {
    let (start, rest) = wanted.split_once('…').map_or((wanted, None), |(start, rest)| (start, Some(rest)));
    let Some(rest) = rest else { return line == wanted };
    let Some(mut line) = line.strip_prefix(start) else { return false };
    let mut parts = rest.split('…').peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return line.ends_with(part);
        }
        let Some((_, after)) = line.split_once(part) else { return false };
        line = after;
    }
    true
}

/// Whether the text has this number, alone.
fn has_number(text: &str, number: &str) -> bool {
    text.match_indices(number).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let mut after = text[at + number.len()..].chars();
        let first = after.next();
        let goes_on = if first == Some('.') { after.next() } else { first };
        !before.is_some_and(|c| c.is_ascii_digit() || c == '.')
            && !goes_on.is_some_and(|c| c.is_ascii_digit())
    })
}

/// A command of the page: its words, the file that its output goes to, and the exit code it should have.
struct Line {
    words: Vec<String>,
    to: Option<String>,
    code: i32,
}

fn line(text: &str) -> Line {
    let (text, code) = text.split_once(" # exit code ").unwrap_or((text, "0"));
    let (text, to) = text.split_once(" > ").map_or((text, None), |(text, to)| (text, Some(to.to_owned())));
    // Quotes stand around whole words.
    let parts = text.split('\'').enumerate();
    let words = parts.flat_map(|(k, part)| match k % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    });
    Line { words: words.collect(), to, code: code.parse().unwrap() }
}

/// Copies the files of a folder.
pub(crate) fn copied(from: &Path, to: &Path) {
    create_dir_all(to).unwrap();
    for entry in read_dir(from).unwrap().map(Result::unwrap).filter(|entry| entry.path().is_file()) {
        copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

/// The files of `out/` that the page names.
fn named(section: &Section<'_>) -> Vec<String> {
    let mut names = Vec::new();
    for line in section.blocks.iter().flat_map(|block| &block.lines).chain(&section.prose) {
        for (at, _) in line.match_indices("out/") {
            let is_name = |c: char| c.is_ascii_alphanumeric() || "/.-".contains(c);
            names.push(line[at..].chars().take_while(|c| is_name(*c)).collect::<String>());
        }
    }
    names.retain(|name| name != "out/");
    names
}

/// The pictures that a section shows.
fn pictures<'p>(section: &Section<'p>) -> Vec<&'p str> {
    let shown = section.prose.iter().filter_map(|line| line.strip_prefix("!["));
    shown.map(|line| line.split_once("](cookbook/").unwrap().1.trim_end_matches(')')).collect()
}

/// Runs the commands of a block; what they print.
fn printed(place: &Place, block: &Block<'_>) -> String {
    let mut out = String::new();
    for text in &block.lines {
        let Line { words, to, code } = line(text);
        if *text == "mkdir -p out" {
            continue;
        }
        assert_eq!(words[0], "smc", "{text}");
        let words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
        let said = Said::of(&place.command(&words).stdout(Stdio::piped()).output().unwrap());
        assert_eq!(said.code, Some(code), "{text}\n{}{}", said.out, said.err);
        match to {
            Some(name) => place.write(&name, said.out.as_bytes()),
            None => out += &said.out,
        }
    }
    out
}

#[test]
fn commands_of_the_cookbook_do_what_it_says() {
    let place = Place::new(&[]);
    for folder in ["models", "properties", "examples/cookbook"] {
        copied(&root().join(folder), &place.path(folder));
    }
    create_dir_all(place.path("out")).unwrap();
    let page = page();
    let sections = sections(&page);
    assert_eq!(sections.len(), 17, "sixteen tasks");
    for section in &sections {
        let (title, mut last, mut all) = (section.title, String::new(), String::new());
        for block in &section.blocks {
            match block.info.split_once(' ').unwrap_or((block.info, "")) {
                ("sh", "") => {
                    last = printed(&place, block);
                    all += &last;
                }
                ("text", "") => occur(&block.lines, &last, title),
                ("text", file) => occur(&block.lines, &read_to_string(place.path(file)).unwrap(), title),
                (_, file) => assert!(!file.is_empty(), "{title}: a block without a language or a file"),
            }
        }
        for name in named(section) {
            let path = place.path(&name);
            assert!(path.is_file(), "{title}: `{name}` is not written");
            if is_table(&path) {
                all += &read_to_string(path).unwrap();
            }
        }
        for span in section.prose.iter().flat_map(|line| line.split('`').skip(1).step_by(2)) {
            let is_number = span.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit());
            assert!(!is_number || has_number(&all, span), "{title}: {span} comes from no command");
        }
        for name in pictures(section) {
            let written = format!("out/{name}");
            let picture = read(place.path(&written)).unwrap_or_else(|error| panic!("{written}: {error}"));
            assert!(picture.len() < LARGEST_PICTURE, "{name} has {} bytes", picture.len());
            let kept = read(root().join("docs/cookbook").join(name)).unwrap_or_default();
            assert!(picture == kept, "{name} is not up to date: run `sh docs/cookbook.sh`");
            assert!(String::from_utf8(picture).unwrap().contains("<text"), "{name} has no text");
        }
    }
}

fn is_table(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "csv" || extension == "jsonl")
}

#[test]
fn what_the_cookbook_quotes_is_in_the_files() {
    let page = page();
    let sections = sections(&page);
    for section in &sections[1..] {
        let quoted =
            section.blocks.iter().filter(|block| block.info != "sh" && !block.info.starts_with("text"));
        let mut files: Vec<PathBuf> = Vec::new();
        for block in quoted {
            let (_, file) = block.info.split_once(' ').unwrap();
            files.push(root().join(file));
            occur(&block.lines, &read_to_string(files.last().unwrap()).unwrap(), file);
        }
        assert!(!files.is_empty(), "{}: no property is quoted", section.title);
        assert!(!pictures(section).is_empty(), "{}: no picture", section.title);
        assert!(named(section).iter().any(|name| is_table(Path::new(name))), "{}: no table", section.title);
        let anchor = section.title.to_lowercase().replace(' ', "-");
        assert!(page.contains(&format!("[{}](#{anchor})", section.title)), "{} is not listed", section.title);
    }
}
