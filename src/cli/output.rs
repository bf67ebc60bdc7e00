//! Files that are written: as a whole or not at all, and never over a file that the call reads.

use super::complaint;
use super::inputs::STDIN;
use super::terminal::print;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Most symbolic links that are followed one after the other, as in Linux.
const MOST_LINKS: usize = 40;
/// Most names that are tried for the file beside: those of calls that were killed may be left.
const MOST_NAMES: usize = 1000;

/// Writes a text to a file, or to standard output.
pub(super) fn put(file: Option<&Path>, text: &str) -> Result<(), Diagnostic> {
    let Some(path) = file else { return print(text) };
    save(path, text.as_bytes())
}

/// A table as a text.
pub(super) fn table(fill: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<String, Diagnostic> {
    let mut bytes = Vec::new();
    fill(&mut bytes).map_err(|error| complaint::output(error.to_string()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Writes a file of these bytes.
pub(super) fn save(path: &Path, bytes: &[u8]) -> Result<(), Diagnostic> {
    write(path, |out| out.write_all(bytes)).map_err(|error| complaint::unwritten(path, &error))
}

/// Writes a file. A regular file is written beside its place, with the permissions of the file that it replaces, and
/// then renamed: a write that fails leaves what was there. Devices and pipes are written as they are.
pub(super) fn write<T>(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<T>) -> io::Result<T> {
    match std::fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::Error::from(ErrorKind::IsADirectory)),
        Ok(found) if found.is_file() => replace(&std::fs::canonicalize(path)?, Some(&found), fill),
        Ok(_) => into(&OpenOptions::new().write(true).open(path)?, fill),
        Err(_) => replace(&end_of_links(path), None, fill),
    }
}

fn into<T>(file: &File, fill: impl FnOnce(&mut dyn Write) -> io::Result<T>) -> io::Result<T> {
    let mut out = BufWriter::new(file);
    let result = fill(&mut out)?;
    out.flush()?;
    Ok(result)
}

fn replace<T>(
    place: &Path,
    old: Option<&Metadata>,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> io::Result<T> {
    let (beside, file) = Beside::create(place)?;
    let result = into(&file, fill)?;
    if let Some(old) = old {
        file.set_permissions(old.permissions())?;
    }
    // Some file systems report a full disk only here.
    file.sync_all()?;
    std::fs::rename(&beside.0, place)?;
    Ok(result)
}

/// Names of the files beside, for a call that its time ends.
static BEGUN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A new file in the directory of another one. It is deleted unless it was renamed.
struct Beside(PathBuf);

impl Beside {
    fn create(place: &Path) -> io::Result<(Self, File)> {
        let mut number = 0;
        loop {
            let name = format!(".smc-{}-{number}.tmp", std::process::id());
            let path = place.with_file_name(name);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    BEGUN.lock().unwrap_or_else(PoisonError::into_inner).push(path.clone());
                    return Ok((Self(path), file));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists && number < MOST_NAMES => number += 1,
                Err(error) => return Err(error),
            }
        }
    }
}

/// Deletes the files that this process has begun to write.
pub(super) fn leave_nothing() {
    let begun = BEGUN.lock().unwrap_or_else(PoisonError::into_inner);
    begun.iter().for_each(|path| _ = std::fs::remove_file(path));
}

impl Drop for Beside {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The name that symbolic links lead to; there need not be a file of that name.
fn end_of_links(path: &Path) -> PathBuf {
    let mut end = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let Ok(next) = std::fs::read_link(&end) else { break };
        end = end.parent().unwrap_or(Path::new("")).join(next);
    }
    end
}

/// An error where a file that is to be written is one that the call reads.
pub(super) fn guard(output: Option<&Path>, inputs: &[PathBuf]) -> Result<(), Diagnostic> {
    let Some(output) = output else { return Ok(()) };
    let Some(input) = inputs.iter().find(|input| is_same(output, input)) else { return Ok(()) };
    let input = match input.to_str() {
        Some(STDIN) => "standard input".to_owned(),
        _ => format!("the input `{}`", input.display()),
    };
    let title = format!("the output `{}` would overwrite {input}", output.display());
    Err(Diagnostic::placeless(Code::E0920, title).hint("write to another file"))
}

/// The same for several files, which are to be different ones.
pub(super) fn guard_all(outputs: &[Option<&Path>], inputs: &[PathBuf]) -> Result<(), Diagnostic> {
    let outputs: Vec<&Path> = outputs.iter().copied().flatten().collect();
    for (at, file) in outputs.iter().enumerate() {
        if outputs[..at].iter().any(|other| other == file || is_same(other, file)) {
            let title = format!("two results are to be written to `{}`", file.display());
            return Err(complaint::argument(title, "write each of them to a file of its own"));
        }
        guard(Some(file), inputs)?;
    }
    Ok(())
}

/// Whether two names stand for one file.
fn is_same(one: &Path, other: &Path) -> bool {
    let (Ok(of_one), Ok(of_other)) = (std::fs::metadata(one), std::fs::metadata(other)) else { return false };
    of_one.is_file() && of_other.is_file() && is_same_file((one, &of_one), (other, &of_other))
}

#[cfg(unix)]
fn is_same_file((_, one): (&Path, &Metadata), (_, other): (&Path, &Metadata)) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_same_file((one, _): (&Path, &Metadata), (other, _): (&Path, &Metadata)) -> bool {
    matches!((std::fs::canonicalize(one), std::fs::canonicalize(other)), (Ok(one), Ok(other)) if one == other)
}
