//! Steps as a table (CSV) and in a report.

use super::cut::{Cut, Dropped, NoSteps};
use crate::base::math::atan2;
use crate::gait::{Phase, RecordedStep, Shape};
use std::collections::BTreeMap;
use std::io::{self, Write};

const COLUMNS: [&str; 11] =
    ["take", "subject", "step", "foot", "phase", "from", "to", "length", "turn", "duration", "width"];

/// The columns of a step that no take has.
const DRAWN: [usize; 7] = [1, 2, 3, 4, 7, 8, 9];

/// Length (m), turn of the root path (rad, left positive) and duration (s) of a step, which begins along +x.
pub(in crate::gait) fn measures(shape: &Shape) -> [f64; 3] {
    let curve = shape.curve();
    let end = curve.tangent(1.0);
    [curve.length(), atan2(end.y, end.x), shape.duration]
}

fn cells(step: &RecordedStep) -> [String; COLUMNS.len()] {
    let [length, turn, duration] = measures(&step.shape);
    let phase = match step.phase {
        Phase::First => "first",
        Phase::Inner => "inner",
        Phase::Last => "last",
    };
    [
        step.take.clone(),
        step.subject.clone(),
        step.number.to_string(),
        step.foot.to_string(),
        phase.to_owned(),
        format!("{:.4}", step.span.0),
        format!("{:.4}", step.span.1),
        format!("{length:.4}"),
        format!("{:.2}", turn.to_degrees()),
        format!("{duration:.4}"),
        format!("{:.4}", step.width),
    ]
}

/// Writes a header and one row per step: times in s, lengths in m, the turn of the root path in degrees (left positive).
///
/// # Errors
/// Errors of the writer.
pub fn write_steps<'a>(out: impl Write, steps: impl IntoIterator<Item = &'a RecordedStep>) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(COLUMNS)?;
    for step in steps {
        table.write_record(cells(step))?;
    }
    table.flush()
}

/// The same for steps that were drawn, without the columns of takes.
///
/// # Errors
/// Errors of the writer.
pub fn write_drawn_steps(out: impl Write, steps: impl IntoIterator<Item = RecordedStep>) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(DRAWN.map(|k| COLUMNS[k]))?;
    for step in steps {
        let cells = cells(&step);
        table.write_record(DRAWN.map(|k| &cells[k]))?;
    }
    table.flush()
}

/// A line per take and one for all: the number of steps, their mean length, the cadence, and what was dropped.
pub fn report<'a>(cuts: impl IntoIterator<Item = &'a Result<Cut, NoSteps>>) -> String {
    let mut all = Cut::default();
    let mut lines = Vec::new();
    for cut in cuts {
        match cut {
            Ok(cut) => {
                let name = cut.steps.first().map_or("", |step| &step.take);
                lines.push(line(name, cut));
                all.steps.extend(cut.steps.iter().cloned());
                add(&mut all.dropped, &cut.dropped);
            }
            Err(none) => {
                lines.push([
                    none.take.clone(),
                    "0".to_owned(),
                    String::new(),
                    String::new(),
                    none.to_string(),
                ]);
                add(&mut all.dropped, &none.dropped);
            }
        }
    }
    lines.insert(0, ["take", "steps", "length", "cadence", "dropped"].map(str::to_owned));
    lines.push(line("all", &all));
    let width = |k: usize| lines.iter().map(|line| line[k].chars().count()).max().unwrap_or_default();
    let [a, b, c, d] = [0, 1, 2, 3].map(width);
    let row = |[take, steps, length, cadence, dropped]: &[String; 5]| {
        let row = format!("{take:<a$}  {steps:>b$}  {length:>c$}  {cadence:>d$}  {dropped}");
        format!("{}\n", row.trim_end())
    };
    lines.iter().map(row).collect()
}

fn add(sum: &mut BTreeMap<Dropped, usize>, dropped: &BTreeMap<Dropped, usize>) {
    for (reason, count) in dropped {
        *sum.entry(*reason).or_default() += count;
    }
}

fn line(name: &str, cut: &Cut) -> [String; 5] {
    let count = cut.steps.len();
    let mean = |of: fn(&RecordedStep) -> f64| cut.steps.iter().map(of).sum::<f64>() / count as f64;
    let show = |text: String| if count > 0 { text } else { String::new() };
    let dropped: Vec<String> =
        cut.dropped.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    [
        name.to_owned(),
        count.to_string(),
        show(format!("{:.3} m", mean(|step| step.shape.curve().length()))),
        show(format!("{:.1}/min", 60.0 / mean(|step| step.shape.duration))),
        dropped.join(", "),
    ]
}
