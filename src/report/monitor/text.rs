//! Monitored properties for people.

use super::{Beyond, Monitored};
use crate::report::number::{count, counted, estimated, plain};
use crate::report::text::columns::table;
use std::fmt::Write as _;

/// A table with a row for each property, and why instants are unresolved.
pub fn to_text(report: &Monitored) -> String {
    let mut out = String::new();
    let Monitored { model, recording, every, confidence, .. } = report;
    let user = report
        .user
        .map_or_else(|| "each person is the user in turn".to_owned(), |id| format!("user: person {id}"));
    let beyond = match report.beyond {
        Beyond::Unresolved => "nothing is assumed",
        Beyond::Onward => "people go straight on",
    };
    let _ = writeln!(
        out,
        "{recording} ({} velocities), {model}, {}",
        report.velocity.name(),
        report.properties.join(", ")
    );
    let _ = writeln!(out, "{user}, every {} s; after the end of a track: {beyond}\n", plain(*every));
    let rows = report.results.iter().map(|one| {
        let [satisfied, violated, unresolved, persons] =
            [one.satisfied, one.violated, one.unresolved, one.persons].map(count);
        let share = one.share.as_ref().map_or_else(|| "-".to_owned(), |share| estimated(share, ""));
        [one.name.clone(), satisfied, violated, unresolved, persons, share]
    });
    let heads = ["property", "satisfied", "violated", "unresolved", "persons", "share satisfied"];
    table(&mut out, "", heads, rows.collect());
    let _ = writeln!(
        out,
        "\nshare satisfied: of the resolved instants, with a {} % interval (bootstrap over persons)",
        plain(100.0 * confidence)
    );
    for one in &report.results {
        for (reason, number) in one.reasons.iter().filter(|(reason, _)| !reason.is_empty()) {
            let _ = writeln!(out, "{}: {} unresolved: {reason}", one.name, counted(*number, "instant"));
        }
    }
    out
}
