//! Trials that other processes run: the same report, also where one of them is killed, and no process that is left over.

use crate::program::{Place, SMALL, timeless};
use serde_json::Value;
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PROPERTIES: &str = "\
property near = F<=1 s (min(distance(user, a) for a in crowd) < 3 m)
check P(near) >= 0.3 by sprt(indifference = 0.05)
estimate P(near) within 0.05
estimate P(F<=1 s (clearance(user) < -0.1 m)) by splitting(replicas = 20, runs = 2, plain = 100)
estimate Q(0.1, 0.5, 0.9, min<=1 s (clearance(user))) by dkw(trials = 200)
compare P(near) under density = 0.1 /m^2 with density = 0.4 /m^2 within 0.1
rank moves of user by P(near) within 0.1
";

/// Works for about a second.
const LONG: &str = "estimate P(F<=3 s contact(user)) by clopper_pearson(trials = 60000)\n";

/// Works for hours.
const ENDLESS: &str = "check P(F<=3 s contact(user)) >= 0.17 by sprt(indifference = 0.00001)\n";

fn place(properties: &str) -> Place {
    Place::new(&[("a.scn", SMALL), ("a.bltl", properties)])
}

/// The report without times.
fn report(out: &str) -> Value {
    let mut json: Value = serde_json::from_str(out).unwrap_or_else(|e| panic!("{e}\n{out}"));
    timeless(&mut json);
    json
}

#[test]
fn any_number_of_ranks_reports_the_same() {
    let place = place(PROPERTIES);
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "2000"];
    for more in [&["--set", "density=0.2"][..], &["--set", "density=0.1..0.3 by 0.1", "--only", "0"]] {
        let words = [&words[..], more].concat();
        let alone = place.call(&[&words[..], &["-j", "1"]].concat());
        for ranks in ["1", "2", "4"] {
            let led = place.call(&[&words[..], &["-j", "2", "--ranks", ranks]].concat());
            assert_eq!(led.err, "", "{ranks} ranks");
            assert_eq!(led.code, alone.code, "{ranks} ranks");
            assert!(report(&led.out) == report(&alone.out), "{ranks} ranks\n{}\n{}", led.out, alone.out);
        }
    }
}

#[test]
fn ranks_are_handed_standard_input() {
    let place = place("");
    let words = ["check", "a.scn", "-", "-q", "--format", "json"];
    let alone = place.fed(&words, PROPERTIES);
    let led = place.fed(&[&words[..], &["--ranks", "2"]].concat(), PROPERTIES);
    assert_eq!(report(&led.out), report(&alone.out));
    assert_eq!(led.err, "");
}

#[test]
fn numbers_of_ranks_that_make_no_sense_are_refused() {
    for ranks in ["--ranks=0", "--ranks=257", "--ranks=-1", "--ranks=two"] {
        let said = place("").call(&["check", "a.scn", "a.bltl", ranks]);
        assert_eq!(said.code, Some(2), "{ranks}");
        assert!(said.err.contains("--ranks"), "{}", said.err);
    }
}

#[test]
fn what_is_no_head_is_refused_in_silence() {
    let place = place("");
    let lease = [[3, 0, 0, 0].as_slice(), &[1, 2, 3]].concat();
    let edition = [[13, 0, 0, 0].as_slice(), &[0, 11], b"smc ranks 0"].concat();
    for (bytes, code) in [(&b""[..], 0), (b"\n", 2), (b"what is this?\n", 2), (&lease, 2), (&edition, 2)] {
        let mut child = place
            .command(&["--rank"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(bytes).unwrap();
        let said = child.wait_with_output().unwrap();
        assert_eq!(said.status.code(), Some(code), "{bytes:?}");
        assert_eq!(said.stderr, b"", "{bytes:?}");
    }
}

/// Processes of which this one is the parent and that are not over, in ascending order.
#[cfg(target_os = "linux")]
fn children(parent: u32) -> Vec<u32> {
    let mut found: Vec<u32> = std::fs::read_dir("/proc")
        .unwrap()
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok())
        .filter(|pid| status(*pid).is_some_and(|(state, of)| of == parent && state != "Z"))
        .collect();
    found.sort_unstable();
    found
}

/// State of a process and its parent.
#[cfg(target_os = "linux")]
fn status(pid: u32) -> Option<(String, u32)> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    let mut words = text.rsplit_once(") ")?.1.split(' ');
    Some((words.next()?.to_owned(), words.next()?.parse().ok()?))
}

/// Waits until something is so, at most ten seconds.
fn soon(what: &str, mut is_so: impl FnMut() -> bool) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < Duration::from_secs(10), "never: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn signal(name: &str, whom: &str) {
    assert!(Command::new("kill").args([name, "--", whom]).status().unwrap().success());
}

/// A call that works for some seconds, once its ranks are there.
#[cfg(target_os = "linux")]
fn at_work(place: &Place, words: &[&str], ranks: usize) -> (std::process::Child, Vec<u32>) {
    use std::os::unix::process::CommandExt as _;
    let count = ranks.to_string();
    let words =
        [&["check", "a.scn", "a.bltl", "-q", "--format", "json", "-j", "2", "--ranks", &count], words]
            .concat();
    let mut command = place.command(&words);
    command.process_group(0).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    soon("all ranks are there", || children(child.id()).len() == ranks);
    std::thread::sleep(Duration::from_millis(100));
    let there = children(child.id());
    assert_eq!(there.len(), ranks, "the call works for long enough");
    (child, there)
}

#[cfg(target_os = "linux")]
#[test]
fn a_rank_that_is_killed_changes_no_result() {
    let place = place(LONG);
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json"];
    let alone = report(&place.call(&words).out);
    for (ranks, killed) in [(2, 1), (2, 2), (1, 1)] {
        let (child, there) = at_work(&place, &[], ranks);
        // Those that stand still keep their leases, so that the call is not over before they are gone.
        there[..killed].iter().for_each(|pid| signal("-STOP", &pid.to_string()));
        std::thread::sleep(Duration::from_millis(100));
        there[..killed].iter().for_each(|pid| signal("-KILL", &pid.to_string()));
        let output = child.wait_with_output().unwrap();
        let mut led = report(&String::from_utf8_lossy(&output.stdout));
        let warnings = std::mem::replace(&mut led["warnings"], alone["warnings"].clone());
        assert_eq!(led, alone, "{killed} of {ranks}");
        let warnings: Vec<&str> = warnings.as_array().unwrap().iter().filter_map(Value::as_str).collect();
        assert_eq!(warnings.len(), killed, "{warnings:?}");
        let others = if killed < ranks { "others ran" } else { "this process ran" };
        assert!(warnings.iter().all(|one| one.contains(others)), "{warnings:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    }
}

/// Nobody is gone, and nobody works.
#[cfg(target_os = "linux")]
#[test]
fn ranks_that_all_fall_silent_change_no_result() {
    let place = place(LONG);
    let alone = report(&place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).out);
    for ranks in [1, 3] {
        let (child, there) = at_work(&place, &["--timeout", "60s"], ranks);
        for pid in &there {
            signal("-STOP", &pid.to_string());
        }
        let output = child.wait_with_output().unwrap();
        let mut led = report(&String::from_utf8_lossy(&output.stdout));
        let warnings = std::mem::replace(&mut led["warnings"], alone["warnings"].clone());
        assert_eq!(led, alone, "{ranks} ranks");
        let warnings: Vec<&str> = warnings.as_array().unwrap().iter().filter_map(Value::as_str).collect();
        assert_eq!(warnings.len(), ranks, "{warnings:?}");
        let told = |one: &&str| one.contains("stopped answering; this process ran its trials");
        assert!(warnings.iter().all(told), "{warnings:?}");
        soon("all ranks are over", || there.iter().all(|pid| status(*pid).is_none()));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn no_rank_outlives_its_head() {
    let place = place(ENDLESS);
    let (mut child, there) = at_work(&place, &["--max-trials", "900000000"], 2);
    let over = || there.iter().all(|pid| status(*pid).is_none_or(|(state, _)| state == "Z"));
    child.kill().unwrap();
    child.wait().unwrap();
    soon("all ranks are over", over);
    // One that is stopped and reads nothing is no exception where its head ends by itself.
    let (child, there) = at_work(&place, &["--timeout", "800ms", "--max-trials", "900000000"], 2);
    signal("-STOP", &there[0].to_string());
    let output = child.wait_with_output().unwrap();
    assert_eq!(report(&String::from_utf8_lossy(&output.stdout))["results"][0]["stopped_by"], "deadline");
    soon("all ranks are over", || there.iter().all(|pid| status(*pid).is_none()));
}

#[cfg(target_os = "linux")]
#[test]
fn an_interruption_ends_all_in_silence() {
    let place = place(ENDLESS);
    for group in [false, true] {
        let (child, there) = at_work(&place, &["--max-trials", "900000000"], 2);
        let whom = if group { format!("-{}", child.id()) } else { child.id().to_string() };
        signal("-INT", &whom);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130));
        let json = report(&String::from_utf8_lossy(&output.stdout));
        assert_eq!(json["results"][0]["stopped_by"], "interrupt");
        assert_eq!(
            (json["warnings"].as_array().map(Vec::len), json["results"][0]["trials"].as_u64() > Some(0)),
            (Some(0), true)
        );
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "group: {group}");
        assert!(there.iter().all(|pid| status(*pid).is_none()));
    }
}
