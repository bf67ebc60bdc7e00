//! Sizes of types: how many fields one has, and in how many files its methods stand.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Most fields of a type.
const MOST_FIELDS: usize = 25;
/// Most files in which methods of a type stand.
const MOST_FILES: usize = 6;
/// Types whose methods may stand in as many files as they do, by their room and name. A number only ever falls.
const KNOWN: [(&str, &str, usize); 2] = [("logic", "Builder", 7), ("syntax", "Builder", 16)];

fn files(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// The name behind some words at the start of a line, without its parameters.
fn named<'l>(line: &'l str, word: &str) -> Option<&'l str> {
    let line = line.strip_prefix("pub(crate) ").or_else(|| line.strip_prefix("pub ")).unwrap_or(line);
    let rest = line.strip_prefix(word)?;
    // Of `impl<'a> Name<'a>` the name stands behind the parameters.
    let rest = if rest.starts_with('<') { rest.split_once("> ")?.1 } else { rest.strip_prefix(' ')? };
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    Some(&rest[..end])
}

#[test]
fn no_type_is_large() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut all = Vec::new();
    files(&source, &mut all);
    let mut homes: BTreeMap<(String, String), BTreeSet<PathBuf>> = BTreeMap::new();
    let mut types = 0;
    for path in all {
        let inside = path.strip_prefix(&source).unwrap();
        let room = inside.iter().next().unwrap().to_str().unwrap().to_owned();
        let text = std::fs::read_to_string(&path).unwrap();
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if let Some(name) = named(line, "struct").filter(|_| line.ends_with('{')) {
                let body: Vec<&str> = lines.by_ref().take_while(|line| *line != "}").collect();
                let is_field = |line: &&&str| {
                    let own = line
                        .strip_prefix("    ")
                        .is_some_and(|rest| !rest.starts_with([' ', '/', '#', ')', '}']));
                    own && line.contains(": ")
                };
                let count = body.iter().filter(is_field).count();
                assert!(count <= MOST_FIELDS, "{}: `{name}` has {count} fields", inside.display());
                types += 1;
            } else if let Some(name) = named(line, "impl").filter(|_| !line.contains(" for ")) {
                homes.entry((room.clone(), name.to_owned())).or_default().insert(path.clone());
            }
        }
    }
    assert!(types > 500, "the types are found: {types}");
    for ((room, name), files) in homes {
        let known = KNOWN.iter().find(|(in_room, of, _)| *in_room == room && *of == name);
        let most = known.map_or(MOST_FILES, |(.., most)| *most);
        assert!(files.len() <= most, "methods of `{name}` in `{room}` stand in {} files", files.len());
    }
}
