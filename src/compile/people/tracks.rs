//! Tracks: recordings, and streams of what is observed while it happens. How fast somebody was is told by the last two places of
//! a track (`seen`) or by the recording (`recorded`): columns of velocities are often central differences, which know the next
//! place (`crate::data::tracks`).

use crate::base::random::MOST_TRIALS;
use crate::compile::context::{
    Context, Locals, Lowered, Reported, entry,
    sighting::Tracks,
    symbols::{Meaning, unknown},
};
use crate::compile::dimension::Dimension;
use crate::compile::files::{Files, Unread, missing};
use crate::compile::lower::call_arguments;
use crate::compile::people::intended::{beside, places};
use crate::data::tracks::{Format, LineError, Reading, Recording, Velocity};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Quantity, Text, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// How many bad lines of a file are shown.
pub(crate) const SHOWN_LINES: usize = 10;
/// The fields of tracks.
const FIELDS: [&str; 5] = ["velocity", "memory", "trial", "fps", "columns"];

/// What the fields say.
#[derive(Clone, Debug, Default)]
struct TrackFields {
    velocity: Option<Velocity>,
    /// Seconds.
    memory: f64,
    /// The part that the file does not state.
    reading: Reading,
}

/// `tracks hotel = eth_biwi "seq_hotel/obsmat.txt" { velocity = seen }`, `tracks here = stream`
pub(crate) fn tracks<'a>(
    context: &mut Context<'a>,
    name: &'a Ident,
    file: Option<&'a (Ident, Text)>,
    body: &'a [Field],
    files: &Files,
) {
    let index = context.tracks.known.len();
    let fields = track_fields(context, body);
    let tracks = match (files.seen(&name.name), file) {
        (Some(seen), _) => {
            fields.map(|TrackFields { memory, .. }| Tracks::Live { seen: seen.clone(), memory })
        }
        (None, Some((format, path))) => fields.and_then(|TrackFields { velocity, memory, reading }| {
            let recording = recording(context, format, path, &reading, files)?;
            let velocity = files.velocity.or(velocity).unwrap_or(Velocity::Recorded);
            let recording = recording.with(velocity);
            if let Some(doubt) = recording.doubt() {
                context.note(Diagnostic::warning(Code::W0705, path.span, doubt.said).hint(doubt.cure));
            }
            context.tracks.velocities.push((name.name.clone(), recording.velocity().name()));
            Ok(Tracks::Recorded { recording, memory })
        }),
        (None, None) => {
            let said = format!("`{}` is a stream, which only `smc advise` can read", name.name);
            let error = error!(E0702, name.span, "{said}");
            context.report(
                error.hint("use `smc advise`, or name a file: `tracks hotel = eth_biwi \"obsmat.txt\"`"),
            )
        }
    };
    context.tracks.known.push(tracks.ok());
    context.tracks.destinations.push(match file {
        Some((_, path)) => files.get(&beside(&path.value)).and_then(|bytes| {
            places(std::str::from_utf8(bytes).map_err(|_| "the destinations are not UTF-8 text".to_owned())?)
        }),
        None => Err(format!("`{}` is a stream, which has no destinations", name.name)),
    });
    entry::enter(context, name, Meaning::Tracks(index));
}

/// `velocity`, `memory` and `trial`.
fn track_fields<'a>(context: &mut Context<'a>, body: &'a [Field]) -> Lowered<TrackFields> {
    let (mut read, mut failed) = (TrackFields::default(), false);
    for (k, field) in body.iter().enumerate() {
        let (name, at) = (field.name.name.as_str(), field.value.span());
        if body[..k].iter().any(|before| before.name.name == name) {
            let said = format!("`{name}` is set twice");
            context.note(error!(E0202, field.name.span, "{said}"));
            failed = true;
            continue;
        }
        match name {
            "velocity" => {
                read.velocity = call_arguments::word(&field.value).and_then(Velocity::from_name);
                if read.velocity.is_none() {
                    let error = error!(E0305, at, "`velocity` must be `seen` or `recorded`");
                    context.note(error);
                    failed = true;
                }
            }
            "memory" => match memory(context, &field.value, at) {
                Ok(seconds) => read.memory = seconds,
                Err(Reported) => failed = true,
            },
            "trial" | "fps" | "columns" => {
                if let Err(error) = read_into(&mut read.reading, field) {
                    context.note(error);
                    failed = true;
                }
            }
            _ => {
                context.note(unknown("field", name, field.name.span, Code::E0207, FIELDS.into_iter()));
                failed = true;
            }
        }
    }
    if failed { Err(Reported) } else { Ok(read) }
}

fn memory<'a>(context: &mut Context<'a>, value: &'a Value, at: Span) -> Lowered<f64> {
    let Value::Plain(expr) = value else {
        return context.report(error!(E0305, at, "expected a time such as `1 s`"));
    };
    let number = context.number_of(expr, Dimension::TIME, &Locals::default())?;
    if number.value < 0.0 {
        return context.report(error!(E0405, at, "`memory` cannot be negative"));
    }
    Ok(number.value)
}

fn recording(
    context: &mut Context<'_>,
    format: &Ident,
    path: &Text,
    reading: &Reading,
    files: &Files,
) -> Lowered<Recording> {
    let Some(reader) = Format::from_name(&format.name) else {
        let names: Vec<&str> = Format::all().iter().map(|format| format.name).collect();
        let hint = format!("the formats are {}", names.join(", "));
        let error = unknown("format", &format.name, format.span, Code::E0702, names.into_iter());
        return context.report(if error.hint.is_some() { error } else { error.hint(hint) });
    };
    files.recording(&path.value, reader, reading).or_else(|unread| {
        context.report(match unread {
            Unread::Missing(reason) => missing(path.span, &reason),
            Unread::Lines(errors) => unreadable(path.span, &errors),
        })
    })
}

/// The statements of tracks with these fields about their file.
///
/// # Errors
/// A number that cannot be one of a trial, or a rate.
pub fn reading_of(body: &[Field]) -> Result<Reading, Diagnostic> {
    let mut reading = Reading::default();
    body.iter().try_for_each(|field| read_into(&mut reading, field))?;
    Ok(reading)
}

/// Takes the fields `trial`, `fps` and `columns`.
fn read_into(reading: &mut Reading, field: &Field) -> Result<(), Diagnostic> {
    let number = match &field.value {
        Value::Plain(Expr { kind: ExprKind::Quantity(Quantity { value, unit: None }), .. }) => value.to_f64(),
        _ => f64::NAN,
    };
    let wrong = |said: &str| error!(E0305, field.value.span(), "{said}");
    if field.name.name == "columns" {
        let Value::Plain(Expr { kind: ExprKind::Text(columns), .. }) = &field.value else {
            return Err(wrong("`columns` must be a text").hint("write `columns = \"id,frame,x/cm,y/cm\"`"));
        };
        reading.columns = Some(columns.clone());
        return Ok(());
    }
    match field.name.name.as_str() {
        "trial" if number >= 0.0 && number.fract() == 0.0 && number < MOST_TRIALS as f64 => {
            reading.trial = Some(number as u64);
        }
        "trial" => return Err(wrong("`trial` must be a whole number from 0").hint("write `trial = 3`")),
        "fps" if number > 0.0 && number <= 1e6 => reading.frames_per_second = Some(number),
        "fps" => return Err(wrong("`fps` must be above 0 and at most 1e6").hint("write `fps = 25`")),
        _ => {}
    }
    Ok(())
}

/// A file whose lines cannot be read.
fn unreadable(span: Span, errors: &[LineError]) -> Diagnostic {
    let shown: Vec<String> = errors.iter().take(SHOWN_LINES).map(ToString::to_string).collect();
    let more = errors.len().saturating_sub(SHOWN_LINES);
    let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
    let title = match errors {
        [LineError { line: 0, .. }] => "the file is not a recording in this format".to_owned(),
        [_] => "1 line of this file cannot be read".to_owned(),
        many => match many.iter().map(|one| one.line).collect::<BTreeSet<_>>().len() {
            1 => "1 line of this file cannot be read".to_owned(),
            lines => format!("{lines} lines of this file cannot be read"),
        },
    };
    error!(E0702, span, "{title}").label(format!("{}{rest}", shown.join("; ")))
}
