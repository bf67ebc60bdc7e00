//! How often a model was right about recorded people, as text: the bins, the regions, and whether later persons agree.

use super::number::plain;
use super::palette::Palette;
use super::text::columns::{Cell, lines};
use crate::engine::outcome::ModelError;
use crate::replay::calibrate::{Bin, Calibration, DRIFTED};
use crate::stats::{Counts, clopper_pearson};
use std::fmt::Write as _;

/// The sentence beside a verdict.
pub(super) fn sentence(error: &ModelError) -> String {
    let ModelError { site, date, from, to, asked, persons, held, low, high } = error;
    let when = date.as_ref().map_or(String::new(), |date| format!(" on {date}"));
    let people = format!("of {asked} persons recorded at {site}{when}");
    if *persons == 0 {
        return format!("{people} none had P {}, so nothing is known", span(*from, *to));
    }
    let (low, high) = ((100.0 * low).floor(), (100.0 * high).ceil());
    let bound = match (from, to) {
        (_, to) if *to >= 1.0 => format!("at least {low} %"),
        (from, _) if *from <= 0.0 => format!("at most {high} %"),
        _ => format!("{low} to {high} %"),
    };
    format!(
        "{people} {persons} had P {}; it was true of {held}, so of {bound} of such verdicts (95 %)",
        span(*from, *to)
    )
}

/// `>= 0.9`, `in 0.5 .. 0.9`, `< 0.1`
fn span(from: f64, to: f64) -> String {
    match (from <= 0.0, to >= 1.0) {
        (false, true) => format!(">= {}", plain(from)),
        (true, false) => format!("< {}", plain(to)),
        _ => format!("in {} .. {}", plain(from), plain(to)),
    }
}

/// A calibration.
pub fn text(found: &Calibration) -> String {
    let mut out = String::new();
    let when = found.date.as_ref().map_or(String::new(), |date| format!(", recorded on {date}"));
    let _ = writeln!(out, "{} ({} velocities){when}, people as `{}`", found.site, found.velocity, found.kind);
    let _ = writeln!(
        out,
        "{} persons calibrate, {} later ones test: one instant of each, of companions one alone; {} trials each, seed {}\n",
        found.persons, found.later, found.trials, found.seed
    );
    for property in &found.properties {
        let _ = writeln!(out, "{}", property.name);
        let head: Vec<Cell> = ["  the model says", "persons", "true", "bounds, 95 %", "later", "true"]
            .map(Cell::left)
            .into_iter()
            .collect();
        let row = |bin: &Bin| {
            let share = |held: u64, all: u64| {
                if all == 0 { "-".to_owned() } else { format!("{:.2}", held as f64 / all as f64) }
            };
            vec![
                Cell::left(format!("  P {}", span(bin.from, bin.to))),
                Cell::right(bin.persons.to_string()),
                Cell::right(share(bin.held, bin.persons)),
                Cell::left(format!("[{:.2}, {:.2}]", down(bin.low), up(bin.high))),
                Cell::right(bin.later.to_string()),
                Cell::right(share(bin.later_held, bin.later)),
            ]
        };
        let rows: Vec<Vec<Cell>> = std::iter::once(head).chain(property.bins.iter().map(row)).collect();
        for line in lines(&rows, Palette::PLAIN) {
            let _ = writeln!(out, "{}", line.trim_end());
        }
        out.push('\n');
    }
    let _ = writeln!(out, "recorded positions in the 90 % region of the predicted ones");
    let head: Vec<Cell> = ["  after s", "first", "later", "factor of the radius", "later, with it"]
        .map(Cell::left)
        .into_iter()
        .collect();
    let rows = found.regions.iter().map(|region| {
        vec![
            Cell::right(format!("  {}", plain(region.seconds))),
            Cell::right(format!("{:.2}", region.first)),
            Cell::right(format!("{:.2}", region.before)),
            Cell::right(format!("{:.2}", region.factor)),
            Cell::right(format!("{:.2}", region.after)),
        ]
    });
    for line in lines(&std::iter::once(head).chain(rows).collect::<Vec<_>>(), Palette::PLAIN) {
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out.push('\n');
    for drift in drifts(found) {
        let _ = writeln!(out, "drift: {drift}");
    }
    let _ = writeln!(
        out,
        "It is assumed that people of this site stay as they were, and walk as they would without a device."
    );
    out
}

/// In what later persons differ from the first ones.
fn drifts(found: &Calibration) -> Vec<String> {
    let mut all = Vec::new();
    for region in found.regions.iter().filter(|region| region.after < DRIFTED) {
        let (after, seconds) = (region.after, plain(region.seconds));
        all.push(format!(
            "after {seconds} s the region holds {after:.2} of the later persons, with its factor"
        ));
    }
    for property in &found.properties {
        for bin in property.bins.iter().filter(|bin| bin.later > 0 && bin.persons > 0) {
            let counts = Counts { successes: bin.later_held, failures: bin.later - bin.later_held };
            let later = clopper_pearson::interval(counts, 0.05);
            if later.high < bin.low || later.low > bin.high {
                let (name, span) = (&property.name, span(bin.from, bin.to));
                let Bin { later, later_held, low, high, .. } = bin;
                all.push(format!(
                    "where P({name}) is {span}, it is true of {later_held} of {later} later persons, not of {:.2} to {:.2}",
                    down(*low),
                    up(*high)
                ));
            }
        }
    }
    if all.is_empty() {
        all.push("none is seen between the first and the later persons".to_owned());
    }
    all
}

fn down(x: f64) -> f64 {
    (100.0 * x).floor() / 100.0
}

fn up(x: f64) -> f64 {
    (100.0 * x).ceil() / 100.0
}
