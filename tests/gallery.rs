//! `docs/gallery.md`: every model that ships is in it, its picture is the one that the program draws, and the answers of the quick
//! models are those of the program.

use crate::cookbook::copied;
use crate::program::Place;
use std::fs::{read_dir, read_to_string};
use std::path::Path;

/// Models that take longer on the page are not asked again, s; `tests/verdicts.rs` has their answers.
const QUICK: f64 = 0.6;

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_gallery_shows_every_model_as_the_program_does() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = read_to_string(root.join("docs/gallery.md")).unwrap();
    let place = Place::new(&[]);
    for folder in ["models", "properties", "gaits"] {
        copied(&root.join(folder), &place.path(folder));
    }
    let mut asked = 0;
    for entry in read_dir(root.join("models")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let properties = format!("properties/{name}.bltl");
        if path.extension().is_none_or(|end| end != "scn") || !root.join(&properties).exists() {
            continue;
        }
        let model = format!("models/{name}.scn");
        // A model whose recording was not there has no answer on the page.
        let command = format!("smc check {model} {properties} --brief");
        let Some((_, rest)) = page.split_once(&command) else {
            let text = read_to_string(&path).unwrap();
            assert!(text.contains("\ntracks "), "{name} is not in the gallery: run `sh docs/gallery.sh`");
            continue;
        };
        if let Ok(kept) = read_to_string(root.join(format!("docs/gallery/{name}.svg"))) {
            let drawn = place.call(&["show", &model, "--format", "svg", "--width", "170mm"]);
            if drawn.code == Some(0) {
                assert!(drawn.out == kept, "{name}.svg is not up to date: run `sh docs/gallery.sh`");
            }
        }
        let (quoted, rest) = rest.split_once("```text\n").unwrap().1.split_once("\n…\n").unwrap();
        let seconds = rest.split_once(" queries, ").unwrap().1.split_once(" s.").unwrap().0;
        let has_tracks = read_to_string(&path).unwrap().contains("\ntracks ");
        if seconds.parse::<f64>().unwrap() <= QUICK && !has_tracks {
            let said = place.call(&["check", &model, &properties, "--brief", "-q"]);
            let first = one_line(said.out.lines().next().unwrap_or_default());
            assert_eq!(first, quoted, "{name}: run `sh docs/gallery.sh`");
            asked += 1;
        }
    }
    assert!(asked > 5, "{asked}");
}

/// The anchors of the headings of a page.
fn anchors(page: &str) -> Vec<String> {
    let mut is_inside = false;
    let mut found = Vec::new();
    for line in page.lines() {
        is_inside ^= line.starts_with("```");
        if let Some(title) = line.strip_prefix('#').filter(|_| !is_inside) {
            let words = title.trim_start_matches('#').trim().to_lowercase();
            let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
            found.push(kept.collect::<String>().replace(' ', "-"));
        }
    }
    found
}

#[test]
fn links_of_the_pages_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = pages.filter(|path| path.extension().is_some_and(|end| end == "md"));
    let mut count = 0;
    for path in pages.chain([root.join("README.md"), root.join("CONTRIBUTING.md")]) {
        let text = read_to_string(&path).unwrap();
        // Brackets between fences are code.
        let prose: String = text.split("```").step_by(2).collect();
        for link in prose.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(link, _)| link) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let to = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            if file.contains("://") {
                continue;
            }
            assert!(to.exists(), "{}: {link} leads nowhere", path.display());
            let is_there =
                anchor.is_empty() || anchors(&read_to_string(&to).unwrap()).iter().any(|one| one == anchor);
            assert!(is_there, "{}: {link} has no such heading", path.display());
            count += 1;
        }
    }
    assert!(count > 200, "{count} links");
}
