//! A folder of parts: the files that shards write, and the plan of the round.

use super::output;
use crate::engine::shards::{Head, Origin, Part, Plan, Unit};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::collections::BTreeSet;
use std::io::Error;
use std::path::{Path, PathBuf};

/// Parts that are named one by one in a warning.
const NAMED: usize = 8;

/// What was read of a folder so far.
pub(super) struct PartsFolder {
    /// Where it is.
    pub(super) path: PathBuf,
    is_kept: bool,
    /// The parts of this call, in the order in which they were found.
    parts: Vec<(PathBuf, Head)>,
    /// All files that were looked at.
    seen: BTreeSet<PathBuf>,
}

/// The name of a part in its folder.
fn name(round: u64, index: usize) -> String {
    format!("{round:04}-{index:06}.part")
}

/// Bytes of a file of the folder.
#[allow(clippy::disallowed_methods, reason = "files are opened by the command line")]
pub(super) fn bytes(file: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(file)
}

/// Reads a plan.
pub(super) fn read_plan(path: &Path) -> Result<Plan, Diagnostic> {
    let wrong = |reason: String| {
        Diagnostic::placeless(Code::E0724, format!("the plan `{}` {reason}", path.display()))
            .hint("write the plan again: `smc merge` does with the folder of its parts")
    };
    let found = bytes(path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    serde_json::from_slice(&found).map_err(|error| wrong(format!("is damaged: {error}")))
}

/// An error if a file belongs to another call.
pub(super) fn same_origin(path: &Path, own: &Origin, found: &Origin) -> Result<(), Diagnostic> {
    own.difference(found).map_or(Ok(()), |difference| {
        let title = format!("`{}` belongs to another call: {difference}", path.display());
        Err(Diagnostic::placeless(Code::E0724, title).hint("use a folder for each call"))
    })
}

fn warning(title: String) -> Diagnostic {
    Diagnostic { severity: Severity::Warning, ..Diagnostic::placeless(Code::W0722, title) }
}

/// Units in words.
pub(super) fn words(units: &[Unit]) -> String {
    let mut words: Vec<String> = units.iter().take(NAMED).map(ToString::to_string).collect();
    if units.len() > NAMED {
        words.push(format!("{} more", units.len() - NAMED));
    }
    words.join("; ")
}

impl PartsFolder {
    /// A folder, which is made where it does not exist, and removed at the end unless it is kept.
    pub(super) fn new(path: PathBuf, is_kept: bool) -> Result<Self, Diagnostic> {
        std::fs::create_dir_all(&path).map_err(|error| super::complaint::unwritten(&path, &error))?;
        Ok(Self { path, is_kept, parts: Vec::new(), seen: BTreeSet::new() })
    }

    /// The file of its plan.
    pub(super) fn plan_file(&self) -> PathBuf {
        self.path.join("plan.json")
    }

    /// Its plan, if there is one.
    pub(super) fn plan(&self, own: &Origin) -> Result<Option<Plan>, Diagnostic> {
        let file = self.plan_file();
        if !file.exists() {
            return Ok(None);
        }
        let plan = read_plan(&file)?;
        same_origin(&file, own, &plan.origin)?;
        Ok(Some(plan))
    }

    /// Writes its plan.
    pub(super) fn write_plan(&self, plan: &Plan) -> Result<(), Diagnostic> {
        let file = self.plan_file();
        let json = serde_json::to_vec(plan).map_err(|error| super::complaint::output(error.to_string()))?;
        output::save(&file, &json)
    }

    /// The files of parts.
    fn files(&self) -> Result<BTreeSet<PathBuf>, Error> {
        let entries = std::fs::read_dir(&self.path)?.collect::<Result<Vec<_>, _>>()?;
        let files = entries.into_iter().map(|entry| entry.path());
        Ok(files.filter(|file| file.extension().is_some_and(|end| end == "part")).collect())
    }

    /// Reads the heads of parts that are new. Warnings about those that cannot be used; an error if one belongs to another
    /// call.
    pub(super) fn scan(&mut self, own: &Origin, plan: Option<&Plan>) -> Result<Vec<Diagnostic>, Diagnostic> {
        let unread = |path: &Path, error: &Error| {
            let title = format!("`{}` cannot be read: {error}", path.display());
            Diagnostic::placeless(Code::E0701, title).hint("write the folder of the parts")
        };
        let files = self.files().map_err(|error| unread(&self.path, &error))?;
        let mut warnings = Vec::new();
        for file in files.difference(&self.seen.clone()) {
            let found = bytes(file).map_err(|error| unread(file, &error))?;
            self.seen.insert(file.clone());
            match Head::read(&found) {
                Ok(head) => {
                    same_origin(file, own, &head.origin)?;
                    self.parts.push((file.clone(), head));
                }
                Err(damaged) => {
                    let of = plan.and_then(|plan| {
                        let named = |k: &usize| file.ends_with(name(plan.round, *k));
                        Some(words(&plan.shards[(0..plan.shards.len()).find(named)?]))
                    });
                    let of = of.map_or(String::new(), |of| format!(" ({of})"));
                    warnings.push(warning(format!("`{}`{of} is not used: {damaged}", file.display())));
                }
            }
        }
        Ok(warnings)
    }

    /// The heads of its parts.
    pub(super) fn heads(&self) -> Vec<&Head> {
        self.parts.iter().map(|(_, head)| head).collect()
    }

    /// An error about two parts that say different things.
    pub(super) fn contradiction(&self, parts: [usize; 2], unit: &Unit) -> Diagnostic {
        let [first, second] = parts.map(|part| self.parts[part].0.display());
        let title = format!("`{first}` and `{second}` have different outcomes of {unit}");
        Diagnostic::placeless(Code::E0724, title).hint("remove both: their trials are then run again")
    }

    /// Reads a part again; none if it has changed since.
    pub(super) fn reread(&self, part: usize) -> Option<Part> {
        let (file, head) = &self.parts[part];
        let part = Part::read(&bytes(file).ok()?).ok()?;
        (part.head == *head).then_some(part)
    }

    /// Seconds that a trial takes, if any is there.
    pub(super) fn pace(&self) -> Option<f64> {
        let seconds: f64 = self.parts.iter().map(|(_, head)| head.seconds).sum();
        let trials: u64 = self.parts.iter().flat_map(|(_, head)| &head.units).map(Unit::weight).sum();
        (trials > 0).then(|| seconds / trials as f64)
    }

    /// The shards of a plan that have no part yet.
    pub(super) fn missing<'p>(&self, plan: &'p Plan) -> Vec<&'p [Unit]> {
        let is_there = |index: &usize| self.path.join(name(plan.round, *index)).exists();
        let missing = (0..plan.shards.len()).filter(|index| !is_there(index));
        missing.map(|index| plan.shards[index].as_slice()).collect()
    }

    /// The number of the next round: one that no file here has.
    pub(super) fn next_round(&self, plan: Option<&Plan>) -> u64 {
        let round = |file: &PathBuf| file.file_stem()?.to_str()?.split('-').next()?.parse::<u64>().ok();
        let parts = self.seen.iter().filter_map(round);
        parts.chain(plan.map(|plan| plan.round)).max().unwrap_or(0) + 1
    }
}

/// Writes a part into a folder.
pub(super) fn write(folder: &Path, (round, index): (u64, usize), part: &Part) -> Result<(), Diagnostic> {
    let bytes = part.bytes().map_err(|error| super::complaint::output(error.to_string()))?;
    output::save(&folder.join(name(round, index)), &bytes)
}

/// A warning about shards that brought nothing back, if any.
pub(super) fn lost(shards: &[&[Unit]]) -> Vec<Diagnostic> {
    let units: Vec<Unit> = shards.concat();
    let title = || format!("parts are missing: {} ({})", shards.len(), words(&units));
    (!shards.is_empty()).then(|| warning(title())).into_iter().collect()
}

impl Drop for PartsFolder {
    fn drop(&mut self) {
        if !self.is_kept {
            let _ = std::fs::remove_dir_all(&self.path);
        }
    }
}
