//! The same bytes on every machine: all models under emulated processors with shorter vectors.
//!
//! Needs `qemu-x86_64` and takes minutes, so it runs only when asked for:
//! `cargo test --release --test suite machines:: -- --ignored --nocapture`.
//!
//! `SMC_ELSEWHERE` may name a call of the program as it was built for another machine, such as
//! `qemu-aarch64 -L /usr/aarch64-linux-gnu target/aarch64-unknown-linux-gnu/release/smc`; it is held against this one.

use crate::program::{recordings, timeless};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

/// Processors: none beyond SSE2 and SSE3, up to SSE4.2, up to AVX2.
const PROCESSORS: [&str; 3] = ["qemu64", "Nehalem", "Haswell"];
/// Trials of a query: enough to fill lanes twice and take up trials in lanes that end early.
const TRIALS: &str = "40";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Models with properties of the same name.
fn models() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(root().join("models"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "scn"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .filter(|name| root().join(format!("properties/{name}.bltl")).exists())
        .collect();
    names.sort();
    names
}

/// The results of a call without durations.
fn results(mut command: Command, name: &str, data: Option<&Path>) -> Value {
    let (model, properties) = (format!("models/{name}.scn"), format!("properties/{name}.bltl"));
    command.args(["check", &model, &properties, "--format", "json", "-q", "-j", "1", "--max-trials", TRIALS]);
    if let Some(data) = data {
        command.arg("--data").arg(data);
    }
    let output = command.current_dir(root()).stdin(Stdio::null()).output().unwrap();
    let mut json: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{name}: {e}: {}", String::from_utf8_lossy(&output.stderr)));
    timeless(&mut json);
    assert!(!json["results"].as_array().unwrap().is_empty(), "{name}");
    json["results"].take()
}

/// Holds the results of all models here against those of other calls of the program, each with its name.
fn compare(elsewhere: &[(String, Vec<String>)]) {
    let data = recordings();
    for name in models() {
        if name.starts_with("hotel") && data.is_none() {
            eprintln!("skipped: {name} needs recordings");
            continue;
        }
        let here = results(Command::new(env!("CARGO_BIN_EXE_smc")), &name, data.as_deref());
        for (machine, call) in elsewhere {
            let mut command = Command::new(&call[0]);
            command.args(&call[1..]);
            let there = results(command, &name, data.as_deref());
            assert_eq!(here.to_string(), there.to_string(), "{name} on {machine}");
            eprintln!("{name}: the same on {machine}");
        }
    }
}

#[test]
#[ignore = "needs an emulator, and minutes"]
fn every_model_yields_the_same_bytes_on_every_processor() {
    if Command::new("qemu-x86_64").arg("--version").stdout(Stdio::null()).status().is_err() {
        eprintln!("skipped: there is no qemu-x86_64");
        return;
    }
    let call = |processor: &str| {
        ["qemu-x86_64", "-cpu", processor, env!("CARGO_BIN_EXE_smc")].map(str::to_owned).to_vec()
    };
    compare(&PROCESSORS.map(|processor| (processor.to_owned(), call(processor))));
}

#[test]
#[ignore = "needs a build for another machine, and minutes"]
fn every_model_yields_the_same_bytes_in_a_build_for_another_machine() {
    let call = std::env::var("SMC_ELSEWHERE").unwrap_or_default();
    let call: Vec<String> = call.split_whitespace().map(str::to_owned).collect();
    if call.is_empty() {
        eprintln!("skipped: SMC_ELSEWHERE names no call");
        return;
    }
    compare(&[(call.join(" "), call)]);
}
