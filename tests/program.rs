//! The program as a shell would call it, in a directory of its own.

use serde_json::Value;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A scenario of a few people that is over in no time.
pub(crate) const SMALL: &str = include_str!("small.scn");

/// What one call gave.
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Said {
    pub(crate) fn of(output: &Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}\n{}\n{}", self.out, self.err))
    }
}

/// A directory with files in it, in which the program is called.
pub(crate) struct Place(tempfile::TempDir);

impl Place {
    pub(crate) fn new(files: &[(&str, &str)]) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        for (name, text) in files {
            place.write(name, text.as_bytes());
        }
        place
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_smc"));
        command.args(words).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    pub(crate) fn call(&self, words: &[&str]) -> Said {
        Said::of(&self.command(words).output().unwrap())
    }

    pub(crate) fn fed(&self, words: &[&str], input: &str) -> Said {
        let mut child = self
            .command(words)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        // Beside the reading: a program that answers while it reads waits until somebody takes its answers.
        let input = input.as_bytes().to_vec();
        let writer = std::thread::spawn(move || stdin.write_all(&input));
        let said = Said::of(&child.wait_with_output().unwrap());
        // A program that refuses its call does not read what it is fed.
        let written = writer.join().unwrap();
        assert!(written.is_ok() || written.is_err_and(|error| error.kind() == ErrorKind::BrokenPipe));
        said
    }
}

/// A call at the root of the repository.
pub(crate) fn at_root(words: &[&str]) -> Said {
    Said::of(
        &Command::new(env!("CARGO_BIN_EXE_smc"))
            .args(words)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .stdin(Stdio::null())
            .output()
            .unwrap(),
    )
}

/// Where the recordings are, if they are on this machine.
pub(crate) fn recordings() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/eth-biwi");
    let found = std::env::var_os("SMC_DATA").map_or(beside, PathBuf::from);
    let there = found.join("seq_hotel/obsmat.txt").is_file();
    if !there {
        let mut err = std::io::stderr();
        let _ = writeln!(err, "SKIPPED: no recordings at {} (set SMC_DATA)", found.display());
    }
    there.then_some(found)
}

#[allow(dead_code, reason = "some tests compare whole reports, others do not")]
/// Takes out what differs from run to run.
pub(crate) fn timeless(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| name != "elapsed_s");
            fields.values_mut().for_each(timeless);
        }
        Value::Array(values) => values.iter_mut().for_each(timeless),
        _ => {}
    }
}

/// The value of a setting in JSON as it is written: `90 deg`.
pub(crate) fn written(setting: &serde_json::Value) -> String {
    match setting["unit"].as_str().unwrap() {
        "" => setting["value"].to_string(),
        unit => format!("{} {unit}", setting["value"]),
    }
}
