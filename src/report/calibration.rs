//! How often a model was right about recorded people, as text: the bins, the regions, and whether later persons agree.

use super::number::plain;
use super::phrase::span;
use super::text::columns::table;
use crate::engine::outcome::CallResult;
use crate::replay::calibrate::{Bin, CalibratedProperty, CalibratedRegion, Calibration, DRIFTED};
use crate::report::html::{Page, Table};
use crate::stats::{Counts, clopper_pearson};
use std::fmt::Write as _;

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
        let unresolved = match property.unresolved {
            0 => String::new(),
            many => format!(" ({many} unresolved: the recording does not tell)"),
        };
        let _ = writeln!(out, "{}{unresolved}", property.name);
        table(&mut out, "  ", &BINS, property.bins.iter().map(bin));
        out.push('\n');
    }
    let _ = writeln!(out, "{REGIONS}");
    table(&mut out, "  ", &TIMES, found.regions.iter().map(region));
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

/// What the tables of regions are about.
const REGIONS: &str = "recorded positions in the 90 % region of the predicted ones";
/// Heads of the tables.
const BINS: [&str; 6] = ["the model says", "persons", "true", "bounds, 95 %", "later", "true"];
const TIMES: [&str; 5] = ["after s", "first", "later", "factor of the radius", "later, with it"];

fn bin(bin: &Bin) -> Vec<String> {
    let share = |held: u64, all: u64| {
        if all == 0 { "-".to_owned() } else { format!("{:.2}", held as f64 / all as f64) }
    };
    vec![
        format!("P {}", span(bin.from, bin.to)),
        bin.persons.to_string(),
        share(bin.held, bin.persons),
        format!("[{:.2}, {:.2}]", down(bin.low), up(bin.high)),
        bin.later.to_string(),
        share(bin.later_held, bin.later),
    ]
}

fn region(region: &CalibratedRegion) -> Vec<String> {
    let shares = [region.first, region.before, region.factor, region.after];
    std::iter::once(plain(region.seconds)).chain(shares.map(|share| format!("{share:.2}"))).collect()
}

/// A calibration as a page: a table for each property, one for the regions, and the drift.
pub fn page(found: &Calibration) -> Page<'static> {
    let of = |property: &CalibratedProperty| Table {
        title: property.name.clone(),
        note: "The share of persons of whom it was true, by the probability that the model said of them."
            .to_owned(),
        columns: BINS.to_vec(),
        rows: property.bins.iter().map(bin).collect(),
    };
    let regions = Table {
        title: "90 % regions".to_owned(),
        note: format!("Shares of {REGIONS}. Drift: {}.", drifts(found).join("; ")),
        columns: TIMES.to_vec(),
        rows: found.regions.iter().map(region).collect(),
    };
    let when = found.date.as_ref().map_or(String::new(), |date| format!(" on {date}"));
    let title = format!(
        "{} persons recorded at {}{when} calibrate {}, {} later ones test",
        found.persons, found.site, found.kind, found.later
    );
    Page {
        run: CallResult::of(title, found.seed),
        tables: found.properties.iter().map(of).chain([regions]).collect(),
        ..Page::default()
    }
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
