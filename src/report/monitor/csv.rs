//! Monitored properties as CSV, one row an instant of a person.

use super::Monitored;
use crate::report::number::thousandths;
use std::io;

/// `time,person` and a column for each property: `true`, `false` or `unresolved`. Times are to 1 ms.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(out: impl io::Write, report: &Monitored) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let names = report.results.iter().map(|one| one.name.as_str());
    table.write_record(["time", "person"].into_iter().chain(names))?;
    for one in &report.instants {
        let cells = [thousandths(one.time).to_string(), one.person.to_string()];
        let verdicts = one.verdicts.iter().map(|verdict| verdict.name());
        table.write_record(cells.iter().map(String::as_str).chain(verdicts))?;
    }
    table.flush()
}
