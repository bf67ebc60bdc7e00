//! Circles of imports inside the modules: files that need each other are read together, so such a group stays small.
//!
//! A file is a node. An arrow leads to the file in which a path (`crate::…`, `super::…`, a child module) ends, through
//! `pub use` where one stands between; the re-exports of a module's root are no arrows themselves, nor are tests. Another
//! leads from the call of a method to the file of the room that alone has a function of that name: a type whose methods
//! stand in many files needs no import to tie these together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Most files of a circle.
const MOST: usize = 3;

/// Rooms with circles that may stay as large as they are. A number only ever falls.
const KNOWN: [(&str, usize); 3] = [("compile", 4), ("cli", 5), ("kernel", 4)];

type Module = Vec<String>;

/// The files of the crate by their module paths, without their tests and comments.
fn files(directory: &Path, module: &Module, found: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let child = [module.clone(), vec![name.clone()]].concat();
        if name == "tests" {
        } else if path.is_dir() {
            files(&path, &child, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let module = if name == "mod" { module.clone() } else { child };
            found.insert(module, bare(&std::fs::read_to_string(&path).unwrap()));
        }
    }
}

fn bare(text: &str) -> String {
    let mut code = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.trim() == "#[cfg(test)]" {
            let item = lines.next().unwrap_or_default();
            let end = format!("{}}}", &item[..item.len() - item.trim_start().len()]);
            if !item.ends_with(';') {
                lines.by_ref().find(|line| *line == end);
            }
            continue;
        }
        let begins = |at: &usize| line[..*at].chars().next_back().is_none_or(char::is_whitespace);
        let mut line = line.find("//").filter(begins).map_or(line, |at| &line[..at]);
        // The path in `pub(in …)` is no use of anything.
        while let Some((before, rest)) = line.split_once("pub(in ") {
            code += before;
            code += "pub";
            line = rest.split_once(')').map_or("", |(_, rest)| rest);
        }
        code += line;
        code.push('\n');
    }
    code
}

/// The paths of a `use` tree, without braces.
fn expanded(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let (head, body) = (&tree[..open], &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())]);
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for c in body.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            parts.push(String::new());
        } else if let Some(part) = parts.last_mut() {
            part.push(c);
        }
    }
    parts
        .iter()
        .filter(|p| !p.trim().is_empty())
        .flat_map(|p| expanded(p))
        .map(|p| format!("{head}{p}"))
        .collect()
}

/// The statements `use …;` of a text: whether each is public, and its tree; and the text without them.
fn uses(text: &str) -> (Vec<(bool, String)>, String) {
    let (mut found, mut rest) = (Vec::new(), String::new());
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let trimmed = line.trim_start();
        let public = trimmed.starts_with("pub");
        let tree =
            if public { trimmed.split_once("use ").map(|(_, t)| t) } else { trimmed.strip_prefix("use ") };
        let Some(tree) = tree.filter(|_| !public || trimmed.split(' ').nth(1) == Some("use")) else {
            rest += line;
            rest.push('\n');
            continue;
        };
        let mut tree = tree.to_owned();
        while !tree.contains(';') {
            let Some(more) = lines.next() else { break };
            tree += more.trim();
        }
        found.push((public, tree.split(';').next().unwrap_or_default().to_owned()));
    }
    (found, rest)
}

/// All paths of a text: words joined by `::`.
fn paths(text: &str) -> BTreeSet<&str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'))
        .map(|word| word.trim_matches(':'))
        .filter(|word| word.contains("::"))
        .collect()
}

struct Crate {
    files: BTreeMap<Module, String>,
    /// What `pub use` gives another name.
    passed_on: BTreeMap<Module, Module>,
}

impl Crate {
    /// A path as seen from a module, from the root of the crate.
    fn rooted(&self, module: &Module, path: &str) -> Option<Module> {
        // A `self` at the end stays: it says that a module is meant, not what has its name.
        let mut segments: Vec<&str> = path.strip_prefix("self::").unwrap_or(path).split("::").collect();
        let mut base = module.clone();
        if segments.first() == Some(&"crate") {
            return Some(segments[1..].iter().map(|s| (*s).to_owned()).collect());
        }
        let climbs = segments.iter().take_while(|s| **s == "super").count();
        if climbs > 0 {
            base.truncate(base.len().saturating_sub(climbs));
            segments.drain(..climbs);
        } else {
            let child = [base.clone(), vec![(*segments.first()?).to_owned()]].concat();
            self.files.contains_key(&child).then_some(())?;
        }
        base.extend(segments.iter().map(|s| (*s).to_owned()));
        Some(base)
    }

    /// The file in which a rooted path ends.
    fn end(&self, path: &Module, most: usize) -> Option<Module> {
        for length in (1..=path.len()).rev() {
            let head = path[..length].to_vec();
            if length < path.len() && self.files.contains_key(&head) {
                return Some(head);
            }
            if let Some(other) = self.passed_on.get(&head).filter(|other| **other != head && most > 0) {
                return self.end(&[other.clone(), path[length..].to_vec()].concat(), most - 1);
            }
            if self.files.contains_key(&head) {
                return Some(head);
            }
        }
        None
    }

    fn arrows(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        let arrows = self.files.iter().map(|(module, text)| {
            let (uses, rest) = uses(text);
            let mut named: Vec<String> = paths(&rest).into_iter().map(str::to_owned).collect();
            named.extend(uses.iter().filter(|(public, _)| !public).flat_map(|(_, tree)| expanded(tree)));
            let ends = named.iter().filter_map(|path| self.end(&self.rooted(module, path)?, 8));
            (module, ends.filter(|end| end != module).collect())
        });
        arrows.collect()
    }
}

/// The functions that a text defines.
fn defined(text: &str) -> BTreeSet<&str> {
    let name = |rest: &'_ str| rest.find(|c: char| !c.is_alphanumeric() && c != '_');
    text.split("fn ")
        .skip(1)
        .filter_map(|rest| Some(&rest[..name(rest)?]))
        .filter(|name| !name.is_empty())
        .collect()
}

/// The methods that a text calls.
fn called(text: &str) -> BTreeSet<&str> {
    let before =
        |head: &'_ str| head.rfind(|c: char| !c.is_alphanumeric() && c != '_').map_or(0, |at| at + 1);
    let calls = text.match_indices('(').filter_map(|(at, _)| {
        let start = before(&text[..at]);
        let is_method = text[..start].ends_with('.') || text[..start].ends_with("Self::");
        is_method.then(|| &text[start..at])
    });
    calls.collect()
}

impl Crate {
    /// Arrows from the calls of methods to the files of the same room that define them.
    fn calls(&self) -> Vec<(&Module, Module)> {
        let mut homes: BTreeMap<&str, Vec<&Module>> = BTreeMap::new();
        for (module, text) in &self.files {
            for name in defined(text) {
                homes.entry(name).or_default().push(module);
            }
        }
        let arrows = self.files.iter().flat_map(|(module, text)| {
            let homes = &homes;
            called(text).into_iter().filter_map(move |name| match homes.get(name).map(Vec::as_slice) {
                Some([home]) if home.first() == module.first() && *home != module => {
                    Some((module, (*home).clone()))
                }
                _ => None,
            })
        });
        arrows.collect()
    }
}

/// Files that each can reach from every other one, largest group first.
fn circles(arrows: &BTreeMap<&Module, BTreeSet<Module>>) -> Vec<BTreeSet<Module>> {
    let reach = |from: &Module| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(one) = open.pop() {
            for next in &arrows[&one] {
                if seen.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> = arrows.keys().map(|one| (*one, reach(one))).collect();
    let mut found: BTreeSet<BTreeSet<Module>> = BTreeSet::new();
    for (one, ends) in &reached {
        let group: BTreeSet<Module> =
            ends.iter().filter(|end| reached[end].contains(*one)).cloned().collect();
        if group.len() > 1 {
            found.insert(group);
        }
    }
    let mut found: Vec<_> = found.into_iter().collect();
    found.sort_by_key(|group| std::cmp::Reverse(group.len()));
    found
}

fn of(files: BTreeMap<Module, String>) -> Crate {
    let mut all = Crate { files, passed_on: BTreeMap::new() };
    let mut passed_on = BTreeMap::new();
    for (module, text) in &all.files {
        for path in uses(text).0.iter().filter(|(public, _)| *public).flat_map(|(_, tree)| expanded(tree)) {
            if let Some(end) = all.rooted(module, &path)
                && let Some(name) = end.last()
            {
                passed_on.insert([module.clone(), vec![name.clone()]].concat(), end);
            }
        }
    }
    all.passed_on = passed_on;
    all
}

#[test]
fn no_circle_of_imports_and_calls_is_large() {
    let mut found = BTreeMap::new();
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &Vec::new(), &mut found);
    found.remove(&vec!["lib".to_owned()]);
    let all = of(found);
    let mut arrows = all.arrows();
    assert!(arrows.values().map(BTreeSet::len).sum::<usize>() > 1_000, "the arrows are found");
    let calls = all.calls();
    assert!(calls.len() > 300, "the calls are found: {}", calls.len());
    for (from, to) in calls {
        arrows.entry(from).or_default().insert(to);
    }
    for circle in circles(&arrows) {
        let names: Vec<String> = circle.iter().map(|module| module.join("/")).collect();
        let known = KNOWN.iter().find(|(module, _)| circle.iter().all(|file| file[0] == *module));
        let most = known.map_or(MOST, |(_, most)| *most);
        assert!(names.len() <= most, "{} files need each other: {}", names.len(), names.join(" "));
    }
}

#[test]
fn a_circle_is_seen_through_re_exports_and_children() {
    let file =
        |name: &str, text: &str| (name.split('/').map(str::to_owned).collect::<Module>(), text.to_owned());
    let all = of(BTreeMap::from([
        file("a", "mod b;\npub use b::{Bee, c::Sea};\nmod d;"),
        file("a/b", "use super::d;\npub mod c;"),
        file("a/b/c", "use crate::e::Eve;"),
        file("a/d", "fn f() -> super::Sea {}"),
        file("e", "use crate::a::{self, Bee};"),
    ]));
    let arrows = all.arrows();
    let found = circles(&arrows);
    let names = |group: &BTreeSet<Module>| group.iter().map(|m| m.join("/")).collect::<Vec<_>>();
    assert_eq!(found.iter().map(names).collect::<Vec<_>>(), [["a/b", "a/b/c", "a/d", "e"]]);
}
