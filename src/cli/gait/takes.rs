//! From files of motion capture to takes cut into steps, with every error at its place.

use super::arguments::Reading;
use super::compare::{SHOWN, span};
use crate::cli::{complaint, inputs};
use crate::data::mocap::{Asf, Layout, NO_RATE, Take, TakeRow, Up, read_take_table, read_takes};
use crate::data::tracks::LineError;
use crate::gait::RecordedStep;
use crate::gait::steps::{Cut, Dropped, NoSteps, cut, doubt};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::parse::decode;
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What a file must have.
const HINT: &str = "`smc explain E0720` lists the formats; `--source`, `--unit`, `--up`, `--fps`, `--root`, `--left` and \
                    `--right` say how to read a file";

/// The cure of a file without a frame rate.
const RATE_HINT: &str = "write `--fps 30`, with the number of the recording";

/// What the files of a call have, and what is wrong with them.
#[derive(Default)]
pub(super) struct Takes {
    /// The texts with errors or warnings.
    pub(super) sources: Vec<Source>,
    /// Errors and warnings.
    pub(super) found: Vec<Diagnostic>,
    /// The files that were read.
    pub(super) paths: Vec<PathBuf>,
    /// Each take.
    pub(super) cuts: Vec<Result<Cut, NoSteps>>,
    names: BTreeSet<String>,
}

impl Takes {
    /// Reads all files of a call and cuts them into steps.
    pub(super) fn read(reading: &Reading) -> Self {
        Self::read_all(reading, &reading.data)
    }

    /// The same for some of its files.
    pub(super) fn read_all(reading: &Reading, data: &[String]) -> Self {
        let mut takes = Self::default();
        if data.iter().filter(|name| *name == "-").count() > 1 {
            takes.found.push(complaint::input("standard input can be read only once"));
            return takes;
        }
        for name in data {
            // Whatever comes from standard input is a table.
            let file = if name == "-" { "stdin.csv" } else { name };
            let Some(source) = takes.open(name, None) else { continue };
            let header = source.text.trim_start_matches('\u{feff}').lines().next().unwrap_or_default();
            if Path::new(file).extension().is_some_and(|end| end.eq_ignore_ascii_case("csv"))
                && header.split(',').any(|field| field.trim() == "file")
            {
                takes.table(reading, name, source);
            } else {
                takes.file(reading, file, source, &[]);
            }
        }
        takes.check();
        takes.choose(reading);
        takes
    }

    /// Whether an error was found.
    pub(super) fn are_wrong(&self) -> bool {
        self.found.iter().any(|one| one.severity == Severity::Error)
    }

    /// All steps.
    pub(super) fn steps(&self) -> Vec<RecordedStep> {
        self.cuts.iter().flatten().flat_map(|cut| &cut.steps).cloned().collect()
    }

    /// The text of a file. A file that a table names has its row as place.
    fn open(&mut self, name: &str, row: Option<Span>) -> Option<Source> {
        self.paths.push(PathBuf::from(if name == "-" { inputs::STDIN } else { name }));
        let id = SourceId(self.sources.len() as u16);
        let shown = inputs::shown(name);
        let error = match inputs::read(name) {
            Ok(bytes) => match decode(id, shown, &bytes) {
                Ok(source) => return Some(source),
                Err(error) => {
                    self.sources.push(Source::new(id, shown, String::from_utf8_lossy(&bytes)));
                    error
                }
            },
            Err(reason) => match row {
                Some(row) => error!(E0720, row, "{reason}";
                    hint: "names of files are relative to the folder of the table"),
                None => complaint::input(reason),
            },
        };
        self.found.push(error);
        None
    }

    /// Reports errors of a text.
    fn refuse(&mut self, source: Source, errors: &[LineError]) {
        let one = |error: &LineError| {
            let hint = if error.message.contains(NO_RATE) { RATE_HINT } else { HINT };
            error!(E0720, span(&source, error), "{}", error.message.clone(); hint: "{hint}")
        };
        self.found.extend(errors.iter().take(SHOWN).map(one));
        if let Some(more) = errors.len().checked_sub(SHOWN + 1) {
            let title = format!("`{}` has {} more errors", source.name, more + 1);
            self.found.push(Diagnostic::placeless(Code::E0720, title).hint(HINT));
        }
        self.sources.push(source);
    }

    /// The takes of a table, file by file.
    fn table(&mut self, reading: &Reading, name: &str, source: Source) {
        let rows = match read_take_table(&source.text) {
            Ok(rows) => rows,
            Err(errors) => return self.refuse(source, &errors),
        };
        let mut files: Vec<(String, Vec<TakeRow>)> = Vec::new();
        let mut places = BTreeMap::new();
        for row in rows {
            let at = *places.entry(row.file.clone()).or_insert(files.len());
            match files.get_mut(at) {
                Some((_, rows)) => rows.push(row),
                None => files.push((row.file.clone(), vec![row])),
            }
        }
        let row = |row: &TakeRow| span(&source, &LineError::whole(row.line, ""));
        let spans: Vec<Span> = files.iter().map(|(_, rows)| row(&rows[0])).collect();
        self.sources.push(source);
        let folder =
            if name == "-" { Path::new("") } else { Path::new(name).parent().unwrap_or(Path::new("")) };
        for ((file, rows), span) in files.into_iter().zip(spans) {
            let path = folder.join(file).display().to_string();
            if let Some(source) = self.open(&path, Some(span)) {
                self.file(reading, &path, source, &rows);
            }
        }
    }

    fn file(&mut self, reading: &Reading, file: &str, source: Source, rows: &[TakeRow]) {
        let skeleton = if Path::new(file).extension().is_some_and(|kind| kind.eq_ignore_ascii_case("amc")) {
            let Some(skeleton) = self.skeleton(file, &source) else { return };
            Some(skeleton)
        } else {
            None
        };
        let layout = reading.layout(file, &source.text, skeleton.as_ref());
        let text = source.text.clone();
        let read = |layout: Option<&Layout>| read_takes(file, &text, skeleton.as_ref(), layout, rows);
        match read(layout.as_ref().filter(|(_, is_own)| !is_own).map(|(layout, _)| layout)) {
            Ok(takes) => {
                let is_right = |layout: &Layout, k: usize| {
                    let takes = read(Some(layout)).unwrap_or_default();
                    let cut = takes.get(k).map(|take| (take, cut(take, reading.contact)));
                    cut.is_some_and(|(take, cut)| cut.is_ok() && doubt(take, &cut).is_none())
                };
                let cure =
                    |k| layout.as_ref().and_then(|(layout, _)| cure(layout, &|layout| is_right(layout, k)));
                self.cut(reading, file, source, takes, &cure);
            }
            Err(errors) => self.refuse(source, &errors),
        }
    }

    /// The skeleton beside a motion: with the name of the motion, or with this name up to its last `_`.
    fn skeleton(&mut self, file: &str, motion: &Source) -> Option<Asf> {
        let stem = Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let subject = stem.rsplit_once('_').map_or(stem.as_str(), |(subject, _)| subject).to_owned();
        let paths = [stem, subject].map(|name| Path::new(file).with_file_name(name + ".asf"));
        let Some(path) = paths.iter().find(|path| path.is_file()) else {
            let [a, b] = paths.each_ref().map(|path| path.display().to_string());
            let lacks = if a == b {
                format!("`{a}` does not exist")
            } else {
                format!("neither `{a}` nor `{b}` exists")
            };
            let message = format!("the skeleton of this motion is missing: {lacks}");
            self.refuse(motion.clone(), &[LineError::of_file(message)]);
            return None;
        };
        let source = self.open(&path.display().to_string(), None)?;
        match Asf::read(&source.text) {
            Ok(skeleton) => Some(skeleton),
            Err(error) => {
                self.refuse(source, &[error]);
                None
            }
        }
    }

    /// Cuts takes into steps. A take without a subject gets that of its file: its name without a number at its end.
    /// `cure` finds the options with which a take is one of a person.
    fn cut(
        &mut self,
        reading: &Reading,
        file: &str,
        source: Source,
        takes: Vec<Take>,
        cure: &dyn Fn(usize) -> Option<String>,
    ) {
        let stem = Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
        let numbered = |(name, number): &(&str, &str)| {
            !name.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
        };
        let subject = stem.rsplit_once('_').filter(numbered).map_or(&*stem, |(subject, _)| subject);
        let (mut told, mut cured) = (false, None);
        for (k, mut take) in takes.into_iter().enumerate() {
            if take.subject.is_empty() {
                subject.clone_into(&mut take.subject);
            }
            // Steps of two takes with one name would count as those of one.
            let whole = format!("{file}:{}", take.name);
            if !self.names.insert(whole.clone()) {
                let place = span(&source, &LineError::of_file(""));
                let title = format!("take `{}` is given twice", take.name);
                self.found.push(error!(E0720, place, "{title}"; hint: "give each take once"));
                told = true;
                continue;
            }
            if !self.names.insert(take.name.clone()) {
                take.name = whole;
            }
            let cut = cut(&take, reading.contact);
            let place = span(&source, &LineError::of_file(""));
            let said = doubt(&take, &cut);
            if said.is_some() || cut.is_err() {
                // The takes of a file are alike, and reading it often takes time.
                let cured = cured.get_or_insert_with(|| cure(k));
                self.found.push(strange(&cut, &take.name, said, cured.as_deref(), place));
                told = true;
            } else if let Some(long) = cut.as_ref().ok().and_then(|cut| cut.dropped.get(&Dropped::Long)) {
                let title =
                    format!("{long} steps of take `{}` are dropped: they are longer than 2 m", take.name);
                let warning = Diagnostic::warning(Code::W0720, place, title);
                self.found.push(warning.hint("check the unit: `--unit 1cm`"));
                told = true;
            }
            self.cuts.push(cut);
        }
        if told {
            self.sources.push(source);
        }
    }

    /// Takes without steps are errors if no take has any.
    fn check(&mut self) {
        if self.cuts.iter().any(Result::is_ok) {
            return;
        }
        for found in self.found.iter_mut().filter(|found| found.code == Code::W0720) {
            (found.code, found.severity) = (Code::E0721, Severity::Error);
        }
    }

    /// Keeps the subjects that are asked for.
    fn choose(&mut self, reading: &Reading) {
        let known: BTreeSet<String> = self.steps().into_iter().map(|step| step.subject).collect();
        for name in reading.subjects.iter().chain(&reading.except) {
            if !known.contains(name) && !self.are_wrong() {
                let all: Vec<&str> = known.iter().map(String::as_str).collect();
                let hint = complaint::meant(name, &all, "the subjects are");
                self.found.push(complaint::argument(format!("no take has the subject `{name}`"), hint));
            }
        }
        let asked = |step: &RecordedStep| {
            (reading.subjects.is_empty() || reading.subjects.contains(&step.subject))
                && !reading.except.contains(&step.subject)
        };
        for cut in self.cuts.iter_mut().flatten() {
            cut.steps.retain(asked);
        }
        if !reading.subjects.is_empty() || !reading.except.is_empty() {
            self.cuts.retain(|cut| cut.as_ref().is_ok_and(|cut| !cut.steps.is_empty()));
        }
    }
}

/// A take without steps, or one that no person makes. It is an error if it has none because the file is read wrongly.
fn strange(
    cut: &Result<Cut, NoSteps>,
    name: &str,
    said: Option<String>,
    cure: Option<&str>,
    place: Span,
) -> Diagnostic {
    let is_misread = said.is_some() || cure.is_some();
    let said = said.map_or_else(String::new, |said| format!(": {said}"));
    let found = match cut {
        Err(none) if is_misread => error!(E0721, place, "{none}{said}"),
        Err(none) => Diagnostic::warning(Code::W0720, place, none.to_string()),
        Ok(_) => Diagnostic::warning(Code::W0720, place, format!("take `{name}` is not plausible{said}")),
    };
    found.hint(match cure {
        Some(cure) => format!("write `{cure}`"),
        None if is_misread => {
            "check the unit (`--unit 1cm`), the axis that points up (`--up z`) and the joints".to_owned()
        }
        None => "remove the take, or check the names of the joints and `--contact`".to_owned(),
    })
}

/// An option that changes how a file is read.
type Change = (&'static str, fn(&mut Layout));

/// The axes come first: a wrong one and a wrong unit can make the same height of the hip.
const CHANGES: [Change; 10] = [
    ("--up z", |layout| layout.up = Up::Z),
    ("--up y", |layout| layout.up = Up::Y),
    ("--unit 1mm", |layout| layout.unit = 0.001),
    ("--unit 1cm", |layout| layout.unit = 0.01),
    ("--unit 1in", |layout| layout.unit = 0.0254),
    ("--unit 0.0564m", |layout| layout.unit = 0.0564),
    ("--unit 1ft", |layout| layout.unit = 0.3048),
    ("--unit 1m", |layout| layout.unit = 1.0),
    ("--replace-offsets", |layout| layout.replace_offsets = true),
    ("--radians", |layout| layout.radians = true),
];

/// The fewest options, at most two, with which a file is read rightly.
fn cure(layout: &Layout, is_right: &dyn Fn(&Layout) -> bool) -> Option<String> {
    let single = CHANGES.iter().map(|one| vec![one]);
    let pairs = CHANGES.iter().enumerate().flat_map(|(k, one)| {
        let others = CHANGES[k + 1..].iter().filter(|other| other.0[..4] != one.0[..4]);
        others.map(move |other| vec![one, other])
    });
    let mut tries = single.chain(pairs).filter(|changes| {
        let mut changed = layout.clone();
        for (_, change) in changes {
            change(&mut changed);
        }
        changed != *layout && is_right(&changed)
    });
    Some(tries.next()?.iter().map(|(option, _)| *option).collect::<Vec<_>>().join(" "))
}
