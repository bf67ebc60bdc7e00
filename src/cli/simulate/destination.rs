//! Where the tables of a call go, and in which format.

use crate::cli::{complaint, output};
use crate::data::table::{CSV, FORMATS, TraceFormat};
use crate::model::Scenario;
use crate::syntax::diagnostic::Diagnostic;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What stands in the name of a file for the number of the trial.
const TRIAL: &str = "{trial}";

/// Numbers of trials, ascending.
#[derive(Clone, Debug)]
pub(super) enum Chosen {
    /// One after the other.
    All(Range<u64>),
    /// Those that were kept.
    Kept(Vec<u64>),
}

impl Chosen {
    fn count(&self) -> u64 {
        match self {
            Self::All(range) => range.end - range.start,
            Self::Kept(list) => list.len() as u64,
        }
    }

    /// The numbers.
    pub(super) fn trials(self) -> Box<dyn Iterator<Item = u64> + Send> {
        match self {
            Self::All(range) => Box::new(range),
            Self::Kept(list) => Box::new(list.into_iter()),
        }
    }
}

/// The name of a file, none for standard output, and the trials in it.
type Part = (Option<PathBuf>, Chosen);

/// Where tables go.
#[derive(Clone, Debug)]
pub(super) struct Destination {
    pub(super) format: &'static TraceFormat,
    /// `None` for standard output.
    file: Option<PathBuf>,
    /// The files that the call reads.
    inputs: Vec<PathBuf>,
}

impl Destination {
    /// As the options say, or else as the name of the file ends.
    ///
    /// # Errors
    /// An ending that no format has, a file that is also the page of the call, or one that the call reads.
    pub(super) fn new(
        format: Option<&'static TraceFormat>,
        file: Option<&Path>,
        page: Option<&Path>,
        inputs: &[PathBuf],
    ) -> Result<Self, Diagnostic> {
        output::guard_all(&[file, page], inputs)?;
        let format = match (format, file.and_then(Path::extension)) {
            (Some(format), _) => format,
            (None, None) => &CSV,
            (None, Some(ending)) => of_ending(&ending.to_string_lossy())?,
        };
        Ok(Self { format, file: file.map(Path::to_owned), inputs: inputs.to_vec() })
    }

    /// The files that are written, one after the other.
    ///
    /// # Errors
    /// Where the format holds one trial of agents, and there are several in a file, or the scenario has no agents. A file
    /// that the call reads is an error when its turn comes.
    pub(super) fn files(
        &self,
        scenario: &Scenario,
        chosen: Chosen,
    ) -> Result<Box<dyn Iterator<Item = Result<Part, Diagnostic>> + '_>, Diagnostic> {
        let TraceFormat { name, is_of_one_trial, .. } = *self.format;
        if is_of_one_trial && scenario.agents.is_empty() {
            let title = format!("`{name}` holds positions of agents, and the scenario has no agents");
            return Err(complaint::argument(title, "write `--format csv`"));
        }
        let pattern = self.file.as_ref().and_then(|file| file.to_str()).filter(|file| file.contains(TRIAL));
        if let Some(pattern) = pattern {
            let named = |trial: u64| {
                let file = PathBuf::from(pattern.replace(TRIAL, &trial.to_string()));
                output::guard(Some(&file), &self.inputs)?;
                Ok((Some(file), Chosen::Kept(vec![trial])))
            };
            return Ok(Box::new(chosen.trials().map(named)));
        }
        if is_of_one_trial && chosen.count() != 1 {
            let title = format!("`{name}` holds one trial in a file (got {})", chosen.count());
            let ending = self.format.ending;
            let hint = format!(
                "write `-o 'trace-{TRIAL}.{ending}'` for a file of each trial, or choose one with `--trial`"
            );
            return Err(complaint::argument(title, hint));
        }
        Ok(Box::new(std::iter::once(Ok((self.file.clone(), chosen)))))
    }
}

/// What to do where a format is not in this build.
pub(in crate::cli) fn left_out(format: &TraceFormat) -> String {
    let name = format.name;
    format!("this program was built without the feature `{name}`: build it with `--features {name}`")
}

fn of_ending(ending: &str) -> Result<&'static TraceFormat, Diagnostic> {
    let Some(format) = FORMATS.iter().find(|format| format.ending == ending) else {
        let endings: Vec<String> = FORMATS.iter().map(|format| format!(".{}", format.ending)).collect();
        let title = format!("no format of traces has files that end with `.{ending}`");
        let hint = format!("write `--format`, or a name that ends with one of {}", endings.join(", "));
        return Err(complaint::argument(title, hint));
    };
    if format.open.is_none() {
        let title = format!("the format of files that end with `.{ending}` is not in this build");
        return Err(complaint::argument(title, left_out(format)));
    }
    Ok(format)
}
