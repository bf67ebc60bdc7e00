//! Recordings as start states.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::files::Files;
use super::files::missing;
use super::places;
use super::symbols::{Meaning, unknown};
use crate::data::tracks::{LineError, PersonState, Recording, read_eth_biwi};
use crate::model::Law;
use crate::syntax::ast::{Expr, Ident, Recorded, Text};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeSet;
use std::collections::btree_map::Entry;

/// How many bad lines of a file are shown.
const SHOWN_LINES: usize = 10;

impl<'a> Elaborator<'a> {
    /// `tracks hotel = eth_biwi "seq_hotel/obsmat.txt"`
    pub(super) fn tracks(&mut self, name: &'a Ident, format: &'a Ident, path: &'a Text, files: &Files) {
        let index = self.recordings.len();
        let recording = self.recording(format, path, files).ok();
        self.recordings.push(recording);
        self.enter(name, Meaning::Tracks(index));
    }

    fn recording(&mut self, format: &Ident, path: &Text, files: &Files) -> Lowered<Recording> {
        if format.name != "eth_biwi" {
            let error = unknown("format", &format.name, format.span, Code::E0702, ["eth_biwi"].into_iter())
                .hint("the only format is eth_biwi");
            return self.report(error);
        }
        let bytes = match files.get(&path.value) {
            Ok(bytes) => bytes,
            Err(reason) => return self.report(missing(path.span, &reason)),
        };
        let Ok(text) = std::str::from_utf8(bytes) else {
            return self.report(Diagnostic::error(Code::E0702, path.span, "the file is not UTF-8 text"));
        };
        match read_eth_biwi(text) {
            Ok(recording) => Ok(recording),
            Err(errors) => {
                let shown: Vec<String> = errors.iter().take(SHOWN_LINES).map(ToString::to_string).collect();
                let more = errors.len().saturating_sub(SHOWN_LINES);
                let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
                let error = Diagnostic::error(
                    Code::E0702,
                    path.span,
                    match errors.as_slice() {
                        [LineError { line: 0, .. }] => {
                            "the file is not a recording in this format".to_owned()
                        }
                        [_] => "1 line of this file cannot be read".to_owned(),
                        many => match many.iter().map(|one| one.line).collect::<BTreeSet<_>>().len() {
                            1 => "1 line of this file cannot be read".to_owned(),
                            lines => format!("{lines} lines of this file cannot be read"),
                        },
                    },
                )
                .label(format!("{}{rest}", shown.join("; ")));
                self.report(error)
            }
        }
    }

    /// The people of a recording at a time.
    pub(super) fn observations(&mut self, recorded: &Recorded, plural: bool) -> Lowered<Vec<PersonState>> {
        let time = self.number_of(&recorded.at, Dimension::TIME, &Locals::default());
        let only: Vec<_> = recorded.only.iter().map(|e| self.identity(e)).collect();
        let except: Vec<_> = recorded.except.iter().map(|e| self.identity(e)).collect();
        let name = &recorded.tracks;
        let index = match self.find(&name.name, 0) {
            Some((_, Meaning::Tracks(index))) => index,
            Some((_, Meaning::Doubtful)) => return Err(Reported),
            Some((_, meaning)) => {
                let error = Diagnostic::error(
                    Code::E0206,
                    name.span,
                    format!("expected a recording, but `{}` is {}", name.name, meaning.noun()),
                );
                return self.report(error);
            }
            None => {
                let recordings: Vec<String> = self.scopes[0]
                    .entries()
                    .filter(|(_, e)| matches!(e.meaning, Meaning::Tracks(_)))
                    .map(|(n, _)| n.to_owned())
                    .collect();
                let error = unknown(
                    "recording",
                    &name.name,
                    name.span,
                    Code::E0201,
                    recordings.iter().map(String::as_str),
                );
                return self.report(error);
            }
        };
        let (time, only, except) = (
            time?,
            only.into_iter().collect::<Lowered<Vec<_>>>()?,
            except.into_iter().collect::<Lowered<Vec<_>>>()?,
        );
        let Some(Some(recording)) = self.recordings.get(index) else {
            return Err(super::elaborator::Reported);
        };
        let found = recording.at(time.value);
        if found.is_empty() {
            let near = recording.nearest_time(time.value);
            let error =
                Diagnostic::error(Code::E0703, recorded.at.span, "no person was recorded at this time").hint(
                    near.map_or("the recording is empty".to_owned(), |t| {
                        format!("the nearest time with persons is {t} s")
                    }),
                );
            return self.report(error);
        }
        let mut failed = false;
        for (expr, id) in recorded.only.iter().zip(&only).chain(recorded.except.iter().zip(&except)) {
            if !found.iter().any(|o| o.id == *id) {
                let present: Vec<String> = found.iter().map(|o| o.id.to_string()).collect();
                let error = Diagnostic::error(
                    Code::E0703,
                    expr.span,
                    format!("person {id} was not recorded at this time"),
                )
                .hint(format!("the recorded persons are {}", present.join(", ")));
                self.note(error);
                failed = true;
            }
        }
        if failed {
            return Err(super::elaborator::Reported);
        }
        let asked = recorded.only.iter().zip(&only).chain(recorded.except.iter().zip(&except));
        let mut named: Vec<u32> = Vec::new();
        for (expr, id) in asked {
            if named.contains(id) {
                let text = format!("person {id} is listed twice");
                return self.report(Diagnostic::error(Code::E0703, expr.span, text));
            }
            named.push(*id);
        }
        let chosen: Vec<PersonState> = found
            .into_iter()
            .filter(|o| (only.is_empty() || only.contains(&o.id)) && !except.contains(&o.id))
            .collect();
        if !plural && chosen.len() != 1 {
            let error = Diagnostic::error(
                Code::E0703,
                recorded.span,
                format!("{} persons were recorded at this time, but one is needed", chosen.len()),
            )
            .hint("choose one with `id`, or declare `agents`");
            return self.report(error);
        }
        for person in &chosen {
            match self.recorded.entry((index, person.id)) {
                Entry::Vacant(free) => {
                    free.insert(recorded.span);
                }
                Entry::Occupied(first) => {
                    let text = format!("person {} of `{}` is already used", person.id, name.name);
                    let error = Diagnostic::error(Code::E0703, recorded.span, text)
                        .related(*first.get(), "first used here")
                        .hint(format!("exclude it: `except {}`", person.id));
                    return self.report(error);
                }
            }
        }
        Ok(chosen)
    }

    /// Puts those who were recorded in a barrier, or so near one that they could not start there, beside it.
    pub(super) fn onto_rims(
        &mut self,
        recorded: &Recorded,
        mut found: Vec<PersonState>,
        radius: &Law,
    ) -> Vec<PersonState> {
        let barriers = places::solids(&self.scene.barriers);
        let (least, most) = radius.bounds();
        let room = if most.is_finite() { most } else { least };
        let mut moved = Vec::new();
        for person in &mut found {
            let Some((barrier, distance)) = places::in_the_way(&barriers, person.position, least) else {
                continue;
            };
            // Where there is no room beside it, the start is refused.
            let Some(p) = places::beside(&barriers, person.position, room) else { continue };
            let place = match distance {
                ..0.0 => format!("inside {}", barrier.phrase()),
                _ => format!("{distance:.3} m from {}", barrier.phrase()),
            };
            let by = (p - person.position).norm();
            let (id, x, y) = (person.id, p.x, p.y);
            moved.push(format!(
                "person {id} was recorded {place} and starts {by:.3} m away at ({x:.3}, {y:.3})"
            ));
            person.position = p;
        }
        if !moved.is_empty() {
            let title = match moved.len() {
                1 => "1 person was recorded inside or close to a barrier and starts beside it".to_owned(),
                many => {
                    format!("{many} persons were recorded inside or close to barriers and start beside them")
                }
            };
            let more = moved.len().saturating_sub(SHOWN_LINES);
            moved.truncate(SHOWN_LINES);
            let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
            let warning = Diagnostic::warning(Code::W0701, recorded.span, title);
            self.note(warning.label(moved.join("; ") + &rest));
        }
        found
    }

    fn identity(&mut self, expr: &Expr) -> Lowered<u32> {
        let number = self.number_of(expr, Dimension::NONE, &Locals::default())?;
        match number.as_whole().and_then(|n| u32::try_from(n).ok()) {
            Some(id) => Ok(id),
            None => self.report(Diagnostic::error(
                Code::E0703,
                expr.span,
                "the id of a person must be a whole number",
            )),
        }
    }
}
