//! The pages about the papers: the commands of their blocks marked `run` do what the pages say.

use crate::cookbook::copied;
use crate::program::Place;
use std::fs::read_to_string;
use std::path::Path;
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The blocks of a page: what stands behind the fence, and the lines.
fn blocks(page: &str) -> Vec<(&str, Vec<&str>)> {
    let mut blocks: Vec<(&str, Vec<&str>)> = Vec::new();
    let mut is_inside = false;
    for line in page.lines() {
        if let Some(info) = line.strip_prefix("```") {
            is_inside = !is_inside;
            if is_inside {
                blocks.push((info, Vec::new()));
            }
        } else if is_inside {
            blocks.last_mut().unwrap().1.push(line);
        }
    }
    blocks
}

/// Whether a line is as quoted; `…` stands for anything.
fn is_quoted(wanted: &str, line: &str) -> bool {
    match wanted.split_once('…') {
        None => line == wanted,
        Some((start, end)) => {
            line.starts_with(start) && line.ends_with(end.split('…').next_back().unwrap_or(end))
        }
    }
}

/// Runs the blocks of a page and compares what is quoted after each.
fn run(page: &str) {
    let place = Place::new(&[]);
    for folder in [
        "models",
        "properties",
        "examples/papers",
        "examples/advise",
        "examples/cookbook",
        "examples/programs",
        "gaits",
        "tools",
    ] {
        copied(&root().join(folder), &place.path(folder));
    }
    let text = read_to_string(root().join("docs").join(page)).unwrap();
    let (mut printed, mut count) = (None, 0);
    let path = format!(
        "{}:{}",
        Path::new(env!("CARGO_BIN_EXE_smc")).parent().unwrap().display(),
        std::env::var("PATH").unwrap_or_default()
    );
    for (info, lines) in blocks(&text) {
        match info {
            "sh run" => {
                let script = format!("set -e\n{}\n", lines.join("\n"));
                let mut command = Command::new("sh");
                command
                    .args(["-c", &script])
                    .current_dir(place.path("."))
                    .env("PATH", &path)
                    .env("NO_COLOR", "1");
                let done = command.output().unwrap();
                let (out, err) =
                    (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
                assert!(done.status.success(), "{page}\n{script}\n{err}");
                for (name, written) in
                    lines.iter().filter_map(|line| Some((*line, line.split(" -o ").nth(1)?)))
                {
                    let written = written.split_whitespace().next().unwrap_or_default();
                    assert!(place.path(written).is_file(), "{page}: {name} writes no {written}");
                }
                printed = Some(out.into_owned());
                count += 1;
            }
            "text" => {
                let Some(out) = printed.take() else { continue };
                let mut rest = out.lines();
                for wanted in lines.iter().filter(|line| **line != "…") {
                    assert!(rest.any(|line| is_quoted(wanted, line)), "{page}: `{wanted}` is not in\n{out}");
                }
            }
            // A file that begins with its name.
            "scn" | "bltl" => {
                let name = lines.first().and_then(|line| line.strip_prefix("// "));
                if let Some(name) = name.filter(|name| name.ends_with(info) && !name.contains(' ')) {
                    place.write(name, (lines.join("\n") + "\n").as_bytes());
                }
            }
            _ => {}
        }
    }
    assert!(count > 0, "{page} has no block that runs");
}

#[test]
fn commands_of_the_page_of_papers_do_what_it_says() {
    run("papers.md");
}

#[test]
fn commands_of_the_pages_behind_it_do_what_they_say() {
    for page in ["gait.md", "planning.md", "perception.md", "replay.md", "advise.md"] {
        run(page);
    }
}

#[test]
fn commands_of_the_first_pages_do_what_they_say() {
    for page in ["tutorial.md", "README.md", "buildings.md", "outcomes.md", "programs.md", "proofs.md"] {
        run(page);
    }
}

#[test]
fn rows_name_tests_and_files_that_exist() {
    let page = read_to_string(root().join("docs/papers.md")).unwrap();
    for name in page.split('`').skip(1).step_by(2) {
        let is_file = ["examples/", "models/", "properties/"].iter().any(|folder| name.starts_with(folder));
        if is_file && !name.contains([' ', '…']) {
            assert!(root().join(name).exists(), "{name}");
        }
    }
}
