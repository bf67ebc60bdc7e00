//! What must stay quick before the simulation, against a limit for each: reading a recording, deep nesting, many
//! errors, many processes.
//!
//! `cargo bench --bench front`. Best of three; the exit code is 1 where a limit is passed. Growth is the time of four
//! times as much over the time of as much: 4 where work is in proportion, 16 where it goes with the square.

#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a bench reads files and the clock, and prints"
)]

use smc::compile::{Files, Input, compile, own_errors};
use smc::data::tracks::read_eth_biwi;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut is_kept = true;
    let mut limit = |name: &str, value: f64, most: f64, unit: &str| {
        println!("{name:<44} {value:>9.2} {unit:<3} (limit {most})");
        is_kept &= value <= most;
    };
    match recording() {
        Some(text) => limit("hotel recording", best(|| drop(read_eth_biwi(&text))) * 1e3, 10.0, "ms"),
        None => println!("hotel recording: skipped, the recordings are not here"),
    }
    for (before, after) in
        [("(", ")"), ("!", ""), ("F[0 s, 2 s] (", ")"), ("f(", ")"), ("count(a in c: ", ")")]
    {
        let source = |end: &str| {
            Source::new(
                SourceId(0),
                "deep",
                format!("property p = {}q{}\n", before.repeat(200), end.repeat(200)),
            )
        };
        let (right, wrong) = (source(after), source("$"));
        limit(
            &format!("200 levels of `{before}`"),
            best(|| drop(parse_properties(&right))) * 1e3,
            200.0,
            "ms",
        );
        limit("  with a slip inside", best(|| drop(parse_properties(&wrong))) * 1e3, 400.0, "ms");
    }
    let processes = |count: usize| {
        let one = |k| format!("process p{k}[1000] {{ var n: 0 .. 1 = 0; when n == 0 -> n = 1 }}\n");
        format!("horizon = 10 steps\n{}", (0..count).map(one).collect::<String>())
    };
    limit("growth with processes", growth(|n| errors(&processes(n)), 10), 9.0, "");
    let clock = "horizon = 10 s\nprocess p { var n: 0 .. 5 = 0 when n < 5 at 1 /s -> n = n + 1 }\n";
    for (name, part) in [
        ("brackets that close nothing", "const a = 1 )\n"),
        ("blocks that close nothing", "}\nconst a = 1\n"),
        ("obstacles without a shape", "scene { obstacle a: circel (1, 2) radius 1 m }\n"),
        ("names that are declared twice", "const a = 1\n"),
    ] {
        let text = |n: usize| format!("{clock}{}", part.repeat(n));
        limit(&format!("growth with {name}"), growth(|n| errors(&text(n)), 2_000), 9.0, "");
    }
    if is_kept { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The least of three times, in s.
fn best(mut work: impl FnMut()) -> f64 {
    let times = (0..3).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

fn growth(work: impl Fn(usize), count: usize) -> f64 {
    best(|| work(4 * count)) / best(|| work(count))
}

/// The recording of the hotel, where the data are.
fn recording() -> Option<String> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data").to_owned();
    let folder = std::env::var("SMC_DATA").unwrap_or(beside);
    std::fs::read_to_string(format!("{folder}/eth-biwi/seq_hotel/obsmat.txt")).ok()
}

/// Compiles a scenario and renders what is wrong with it.
fn errors(scenario: &str) {
    let sources =
        [Source::new(SourceId(0), "a.scn", scenario), Source::new(SourceId(1), "a.bltl", "let fine = 1\n")];
    let (tree, mut found) = parse_scenario(&sources[0]);
    let properties = [parse_properties(&sources[1]).0];
    let files = Files::default();
    let input =
        Input { sources: &sources, scenario: &tree, properties: &properties, files: &files, settings: &[] };
    let own = own_errors(compile(&input).1, &found, &input);
    found.extend(own);
    render(&found, &sources, false);
}
