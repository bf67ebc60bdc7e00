//! Ranks as child processes: the same program, spoken to over its standard input and output.

use super::file_cache::unpack;
use crate::engine::ranks::{Connection, serve};
use crate::engine::{Executor, Ranks, Threads};
use crate::report::ExitCode as Exit;
use crate::syntax::diagnostic::Severity;
use std::process::{Child, Command, Stdio};

/// What makes this program a rank, where it is the only word. It is no part of the command connection that people type.
pub(super) const WORD: &str = "--rank";

/// Who runs the trials of a call.
pub(super) enum ProcessPool {
    /// This process alone.
    Alone(Threads),
    /// Others, which end with it. Their connections are closed first.
    Led {
        /// Those others.
        ranks: Box<Ranks>,
        /// Their processes.
        _children: Children,
    },
}

impl ProcessPool {
    /// Who runs the trials.
    pub(super) fn executor(&self) -> &dyn Executor {
        match self {
            Self::Alone(threads) => threads,
            Self::Led { ranks, .. } => ranks.as_ref(),
        }
    }

    /// Their warnings.
    pub(super) fn warnings(&self) -> Vec<String> {
        match self {
            Self::Alone(_) => Vec::new(),
            Self::Led { ranks, .. } => ranks.warnings(),
        }
    }
}

/// Child processes, which are ended and waited for where this is dropped.
pub(super) struct Children(Vec<Child>);

impl Drop for Children {
    fn drop(&mut self) {
        for child in &mut self.0 {
            // Nobody waits for what they may still be at.
            let _ = child.kill();
        }
        for child in &mut self.0 {
            let _ = child.wait();
        }
    }
}

/// Starts so many ranks.
pub(super) fn start(count: usize) -> Result<(Children, Vec<Connection>), String> {
    let program = std::env::current_exe().map_err(|error| format!("ranks cannot be started: {error}"))?;
    let mut children = Children(Vec::with_capacity(count));
    let mut connections = Vec::with_capacity(count);
    for _ in 0..count {
        let mut command = Command::new(&program);
        // The main process reports the errors of a rank.
        command.arg(WORD).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().map_err(|error| format!("ranks cannot be started: {error}"))?;
        if let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) {
            connections.push(Connection { from: Box::new(from), to: Box::new(to) });
        }
        children.0.push(child);
    }
    Ok((children, connections))
}

/// Is a rank until its standard input ends.
pub(super) fn run() -> Exit {
    let prepare = |bytes: &[u8]| {
        let inputs = unpack(bytes).map_err(|error| error.to_string())?;
        let mut errors = inputs.diagnostics.iter().filter(|found| found.severity == Severity::Error);
        inputs.study.ok_or_else(|| {
            errors.next().map_or_else(|| "the inputs have errors".to_owned(), |error| error.title.clone())
        })
    };
    match serve(Box::new(std::io::stdin()), &mut std::io::stdout().lock(), &prepare) {
        Ok(()) => Exit::Success,
        Err(_) => Exit::Wrong,
    }
}
