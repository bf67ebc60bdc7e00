//! A program that runs one trial: its output, within limits of time and size, and nothing of it left behind.
//!
//! Each program leads a group of processes of its own, so that what it has started ends with it.

use super::IsOver;
use crate::kernel::fault::Fault;
use crate::kernel::tape::Unplayed;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Most bytes of a trace.
const MOST_BYTES: u64 = 256 << 20;
/// Bytes of standard error that are kept, and how many of the last letters are told.
const MOST_SAID: usize = 4 << 10;
const TOLD: usize = 200;
/// Between two looks at the clock.
const LOOK: Duration = Duration::from_millis(20);
/// Between two looks at a program that has closed its output: the first, and how much longer it becomes.
const SOON: Duration = Duration::from_micros(50);

/// The groups of the programs that run.
static RUNNING: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Ends all programs that run: the process is about to end.
pub fn end_all() {
    for id in RUNNING.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        end_group(id);
    }
}

#[cfg(unix)]
fn end_group(id: u32) {
    use nix::sys::signal::{Signal, killpg};
    // Of a group that has ended nothing is left to end.
    let _ = killpg(nix::unistd::Pid::from_raw(id as i32), Signal::SIGKILL);
}

#[cfg(not(unix))]
fn end_group(_: u32) {}

/// What a program has written.
pub(super) struct Said {
    pub(super) output: Vec<u8>,
    /// The end of its standard error, on one line.
    pub(super) error: String,
}

/// A program that runs. It ends with this value.
struct Running {
    child: Child,
    /// Whether its end was seen.
    is_over: bool,
}

impl Drop for Running {
    fn drop(&mut self) {
        let id = self.child.id();
        end_group(id);
        if !self.is_over {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
        RUNNING.lock().unwrap_or_else(PoisonError::into_inner).retain(|known| *known != id);
    }
}

/// Runs a program until it ends.
///
/// # Errors
/// When it cannot be started, ends with an error, takes longer than `limit` seconds, writes too much, or is given up.
#[allow(
    clippy::disallowed_methods,
    reason = "a trial of a program has a limit of time, which no result that counts depends on"
)]
pub(super) fn run(words: &[String], folder: &Path, limit: f64, is_over: &IsOver) -> Result<Said, Unplayed> {
    let started = Instant::now();
    let mut running = start(words, folder)?;
    let output = output_of(running.child.stdout.take());
    let error = end_of(running.child.stderr.take());
    let failed = |why: String| Err(Unplayed::Failed(why.into()));
    let mut pause = SOON;
    let mut written = None;
    let status = loop {
        if started.elapsed().as_secs_f64() > limit {
            return failed(format!("the program took longer than {limit} s{}", told(&error)));
        }
        if is_over() {
            return failed("the program was stopped".to_owned());
        }
        if written.is_none() {
            match output.recv_timeout(LOOK) {
                Ok(bytes) if bytes.len() as u64 > MOST_BYTES => {
                    return failed(format!("the program wrote more than {} MB", MOST_BYTES >> 20));
                }
                Ok(bytes) => written = Some(bytes),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => written = Some(Vec::new()),
            }
        } else {
            std::thread::sleep(pause);
            pause = LOOK.min(pause * 2);
        }
        let status = running.child.try_wait();
        match (status, &written) {
            (Ok(Some(status)), Some(_)) => break status,
            // Whatever it has started may hold its output open.
            (Ok(Some(_)), None) => end_group(running.child.id()),
            (Ok(None), _) => {}
            (Err(error), _) => return failed(format!("the program is lost: {error}")),
        }
    };
    running.is_over = true;
    if !status.success() {
        return failed(format!("{}{}", ended(status), told(&error)));
    }
    Ok(Said { output: written.unwrap_or_default(), error: last_words(&error) })
}

fn start(words: &[String], folder: &Path) -> Result<Running, Unplayed> {
    let Some((program, arguments)) = words.split_first() else {
        return Err(Unplayed::Failed("there is no program to run".into()));
    };
    let mut command = Command::new(program);
    command.args(arguments).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    // Who ends all programs finds this one, or it is not started yet.
    let mut known = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    let child = command.spawn().map_err(|error| Unplayed::Wrong(Fault::Unstarted { why: error.kind() }))?;
    known.push(child.id());
    Ok(Running { child, is_over: false })
}

/// Reads a stream on a thread of its own: all of it, or as much as is too much.
fn output_of(stream: Option<impl Read + Send + 'static>) -> Receiver<Vec<u8>> {
    on_a_thread(stream, |stream| {
        let mut bytes = Vec::new();
        let _ = stream.take(MOST_BYTES + 1).read_to_end(&mut bytes);
        bytes
    })
}

/// Reads a stream to its end, and keeps what comes last.
fn end_of(stream: Option<impl Read + Send + 'static>) -> Receiver<Vec<u8>> {
    on_a_thread(stream, |mut stream| {
        let (mut bytes, mut chunk) = (Vec::new(), [0; 4096]);
        while let Ok(count @ 1..) = stream.read(&mut chunk) {
            bytes.extend_from_slice(&chunk[..count]);
            let more = bytes.len().saturating_sub(MOST_SAID);
            bytes.drain(..more);
        }
        bytes
    })
}

fn on_a_thread<S: Read + Send + 'static>(
    stream: Option<S>,
    read: impl FnOnce(S) -> Vec<u8> + Send + 'static,
) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    if let Some(stream) = stream {
        let read = move || {
            let _ = sender.send(read(stream));
        };
        // Without a thread the stream counts as empty.
        let _ = std::thread::Builder::new().spawn(read);
    }
    receiver
}

/// How a program ended.
fn ended(status: ExitStatus) -> String {
    match status.code() {
        Some(code) => format!("the program ended with exit code {code}"),
        None => format!("the program ended by a signal ({status})"),
    }
}

/// The end of standard error, as part of a sentence.
fn told(error: &Receiver<Vec<u8>>) -> String {
    match last_words(error) {
        words if words.is_empty() => String::new(),
        words => format!("; its standard error ends with: {words}"),
    }
}

fn last_words(error: &Receiver<Vec<u8>>) -> String {
    let bytes = error.recv_timeout(LOOK).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let line = text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default().trim();
    let from = line.char_indices().rev().nth(TOLD).map_or(0, |(at, _)| at);
    line[from..].chars().filter(|c| !c.is_control()).collect()
}
