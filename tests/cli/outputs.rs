//! Files that the program writes: as a whole or not at all, and never over an input. Files that it reads: not too large.

use crate::program::{Place, SMALL, Said};
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::process::{Command, Stdio};

const RAGGED: &str = "horizon   = 3 s\nstep=0.1 s\n";
const ASK: &str = "check P(F<=1 s contact(user)) >= 0.5\n";

fn small() -> Place {
    Place::new(&[
        ("a.scn", SMALL),
        ("a.bltl", ASK),
        ("r.scn", RAGGED),
        ("old.csv", "old\n"),
        ("old.html", "old\n"),
    ])
}

fn text(place: &Place, name: &str) -> String {
    std::fs::read_to_string(place.path(name)).unwrap()
}

/// Names of the files in a place.
fn files(place: &Place) -> Vec<String> {
    let entries = std::fs::read_dir(place.path("")).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A call that may write no byte to a file, as on a full disk.
fn on_a_full_disk(place: &Place, words: &str) -> Said {
    let script = format!("trap '' XFSZ; ulimit -f 0; exec {} {words}", env!("CARGO_BIN_EXE_smc"));
    let output = Command::new("sh").args(["-c", &script]).current_dir(place.path("")).output().unwrap();
    Said::of(&output)
}

#[test]
fn a_write_that_fails_leaves_what_was_there() {
    let place = small();
    let before = files(&place);
    for (words, file) in [
        ("fmt r.scn", "r.scn"),
        ("simulate a.scn -o old.csv", "old.csv"),
        ("check a.scn a.bltl -q --max-trials 5 --report old.html", "old.html"),
    ] {
        let kept = text(&place, file);
        let said = on_a_full_disk(&place, words);
        assert_eq!(said.code, Some(2), "{words}: {}", said.err);
        assert!(
            said.err.contains(&format!("error[E0706]: `{file}` cannot be written")),
            "{words}: {}",
            said.err
        );
        assert_eq!(text(&place, file), kept, "{words}");
        assert_eq!(files(&place), before, "{words}: nothing is left beside");
    }
}

#[test]
fn permissions_and_links_stay() {
    let place = small();
    symlink("r.scn", place.path("link.scn")).unwrap();
    symlink("new.csv", place.path("to-new.csv")).unwrap();
    std::fs::set_permissions(place.path("r.scn"), std::fs::Permissions::from_mode(0o640)).unwrap();
    assert_eq!(place.call(&["fmt", "link.scn"]).code, Some(0));
    assert_eq!(place.call(&["simulate", "a.scn", "-o", "to-new.csv"]).code, Some(0));
    assert_eq!(text(&place, "r.scn"), "horizon = 3 s\nstep    = 0.1 s\n");
    assert_eq!(std::fs::metadata(place.path("r.scn")).unwrap().permissions().mode() & 0o777, 0o640);
    for link in ["link.scn", "to-new.csv"] {
        assert!(std::fs::symlink_metadata(place.path(link)).unwrap().is_symlink(), "{link}");
    }
    assert!(text(&place, "new.csv").starts_with("time,"), "a link to no file leads to a new one");
    // What is no regular file is written as it is.
    let said = place.call(&["simulate", "a.scn", "-o", "/dev/stdout"]);
    assert!(said.code == Some(0) && said.out.starts_with("time,"), "{}", said.err);
}

#[test]
fn no_output_overwrites_an_input() {
    let place = Place::new(&[("a.bltl", ASK), ("w.wkt", "LINESTRING (-1 2, 6 2)\n")]);
    place.write("a.scn", format!("scene {{ import \"w.wkt\" }}\n{SMALL}").as_bytes());
    symlink("a.scn", place.path("link.csv")).unwrap();
    std::fs::hard_link(place.path("a.scn"), place.path("hard.csv")).unwrap();
    let kept = ["a.scn", "a.bltl", "w.wkt"].map(|name| text(&place, name));
    let refused = |said: Said, words: &[&str]| {
        assert_eq!(said.code, Some(2), "{words:?}: {}", said.err);
        assert_eq!(said.err.matches("error").count(), 1, "{words:?}: {}", said.err);
        assert!(said.err.starts_with("error[E0920]: the output `"), "{words:?}: {}", said.err);
        assert_eq!(["a.scn", "a.bltl", "w.wkt"].map(|name| text(&place, name)), kept, "{words:?}");
    };
    for output in ["a.scn", "./a.scn", "link.csv", "hard.csv", "w.wkt"] {
        let words = ["simulate", "a.scn", "-o", output];
        refused(place.call(&words), &words);
    }
    for output in ["a.scn", "a.bltl", "link.csv", "w.wkt"] {
        let words = ["check", "a.scn", "a.bltl", "-q", "--max-trials", "5", "--report", output];
        refused(place.call(&words), &words);
    }
    if cfg!(target_os = "linux") {
        let words = ["simulate", "-", "-o", "a.scn", "--data", "."];
        let input = std::fs::File::open(place.path("a.scn")).unwrap();
        refused(Said::of(&place.command(&words).stdin(input).output().unwrap()), &words);
    }
    // An input that is wrong is an input.
    place.write("a.bltl", b"check P(nobody) >= 0.5\n");
    let said = place.call(&["check", "a.scn", "a.bltl", "--report", "a.bltl"]);
    assert!(said.code == Some(2) && said.err.contains("E0920"), "{}", said.err);
    assert_eq!(text(&place, "a.bltl"), "check P(nobody) >= 0.5\n");
}

#[test]
fn inputs_without_end_are_refused() {
    let place = small();
    let large = std::fs::File::create(place.path("large.wkt")).unwrap();
    large.set_len((256 << 20) + 1).unwrap();
    place.write("i.scn", format!("scene {{ import \"large.wkt\" }}\n{SMALL}").as_bytes());
    symlink("/dev/zero", place.path("z.scn")).unwrap();
    for (words, error) in [
        (&["check", "/dev/zero", "a.bltl"][..], "`/dev/zero` is larger than 256 MB"),
        (&["show", "a.scn", "large.wkt"], "`large.wkt` is larger than 256 MB"),
        (&["show", "i.scn"], "`large.wkt` is larger than 256 MB"),
        (&["fmt", "z.scn"], "`z.scn` is larger than 256 MB"),
        (&["drift", "/dev/zero", "--before", "0.9", "--after", "0.8"], "a line is longer than 1 MB"),
    ] {
        let said = place.call(words);
        assert!(said.code == Some(2) && said.err.contains(error), "{words:?}: {}", said.err);
    }
}

#[test]
fn the_environment_sets_no_number_of_threads() {
    let place =
        Place::new(&[("a.scn", SMALL), ("a.bltl", "estimate P(F<=3 s contact(user)) within 0.00001\n")]);
    let mut command = place.command(&["check", "a.scn", "a.bltl", "-q", "--max-trials", "900000000"]);
    command.env("RAYON_NUM_THREADS", "2000").stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    let mut most = 0;
    for _ in 0..30 {
        std::thread::sleep(std::time::Duration::from_millis(50));
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let threads = status.lines().find_map(|line| line.strip_prefix("Threads:"));
        most = most.max(threads.and_then(|number| number.trim().parse().ok()).unwrap_or(0));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    assert!(most <= cores + 8, "{most} threads on {cores} cores");
}

#[test]
fn an_interrupted_table_is_complete_up_to_there() {
    let place = small();
    let words = ["simulate", "a.scn", "--trials", "100000000", "-o", "old.csv"];
    let mut child = place.command(&words).stderr(Stdio::null()).spawn().unwrap();
    let is_begun = || files(&place).iter().any(|name| name.starts_with(".smc"));
    while child.try_wait().unwrap().is_none() && !is_begun() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert_eq!(text(&place, "old.csv"), "old\n", "not yet");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let table = text(&place, "old.csv");
    assert!(table.starts_with("time,") && table.ends_with('\n'), "{}", table.len());
    assert!(files(&place).iter().all(|name| !name.starts_with(".smc")), "{:?}", files(&place));
}
