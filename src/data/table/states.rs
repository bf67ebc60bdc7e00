//! States without people as tables: `time, trial`, then one column per variable, in the formats of traces.
//!
//! Truth values are `true` and `false`; numbers have the fewest digits that give the same double back.

use std::io::{self, Write};

/// The value of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    /// A number.
    Number(f64),
    /// A truth value.
    Truth(bool),
}

impl Held {
    fn text(self) -> String {
        match self {
            Self::Number(value) => value.to_string(),
            Self::Truth(value) => value.to_string(),
        }
    }
}

/// One state of one trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StateRow {
    /// Seconds since the start (steps where steps have no length).
    pub time: f64,
    /// Index of the trial.
    pub trial: u64,
    /// One value per variable.
    pub values: Vec<Held>,
}

impl StateRow {
    fn cells(&self) -> impl Iterator<Item = String> {
        let head = [self.time.to_string(), self.trial.to_string()];
        head.into_iter().chain(self.values.iter().map(|value| value.text()))
    }
}

fn columns<'n>(names: &[&'n str]) -> Vec<&'n str> {
    ["time", "trial"].into_iter().chain(names.iter().copied()).collect()
}

/// Writes a header and all rows as CSV; returns their number.
///
/// # Errors
/// Errors of the writer.
pub fn write_states_csv(
    out: impl Write,
    names: &[&str],
    rows: impl IntoIterator<Item = StateRow>,
) -> io::Result<u64> {
    let mut table = csv::Writer::from_writer(out);
    let failed = |error: csv::Error| match error.into_kind() {
        // The kind of the error distinguishes a closed pipe from other failures.
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    };
    table.write_record(columns(names)).map_err(failed)?;
    let mut count = 0;
    for row in rows {
        table.write_record(row.cells()).map_err(failed)?;
        count += 1;
    }
    table.flush()?;
    Ok(count)
}

/// Writes one JSON object per row and line; returns the number of rows.
///
/// # Errors
/// Errors of the writer.
pub fn write_states_json_lines(
    mut out: impl Write,
    names: &[&str],
    rows: impl IntoIterator<Item = StateRow>,
) -> io::Result<u64> {
    let keys = columns(names).into_iter().map(serde_json::to_string).collect::<Result<Vec<_>, _>>()?;
    let mut count = 0;
    for row in rows {
        let cells: Vec<String> =
            keys.iter().zip(row.cells()).map(|(key, cell)| format!("{key}:{cell}")).collect();
        writeln!(out, "{{{}}}", cells.join(","))?;
        count += 1;
    }
    out.flush()?;
    Ok(count)
}

/// Writes one JSON object, `{"schema": 1, "columns": [...], "rows": [[...], ...]}`, one row a line; returns the
/// number of rows.
///
/// # Errors
/// Errors of the writer.
pub fn write_states_json(
    mut out: impl Write,
    names: &[&str],
    rows: impl IntoIterator<Item = StateRow>,
) -> io::Result<u64> {
    write!(out, "{{\"schema\":1,\"columns\":{},\"rows\":[", serde_json::to_string(&columns(names))?)?;
    let mut count = 0;
    for row in rows {
        let cells: Vec<String> = row.cells().collect();
        write!(out, "{}[{}]", if count == 0 { "\n" } else { ",\n" }, cells.join(","))?;
        count += 1;
    }
    out.write_all(b"\n]}\n")?;
    out.flush()?;
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> [StateRow; 2] {
        let row = |time, n, up| StateRow { time, trial: 3, values: vec![Held::Number(n), Held::Truth(up)] };
        [row(0.0, 2.0, true), row(1.25, -0.5, false)]
    }

    #[test]
    fn all_formats_have_time_trial_and_variables() {
        let names = ["queue.n", "sensor[1].works"];
        let text = |write: &dyn Fn(&mut Vec<u8>) -> io::Result<u64>| {
            let mut out = Vec::new();
            assert_eq!(write(&mut out).unwrap(), 2);
            String::from_utf8(out).unwrap()
        };
        assert_eq!(
            text(&|out| write_states_csv(out, &names, rows())),
            "time,trial,queue.n,sensor[1].works\n0,3,2,true\n1.25,3,-0.5,false\n"
        );
        assert_eq!(
            text(&|out| write_states_json_lines(out, &names, rows())),
            "{\"time\":0,\"trial\":3,\"queue.n\":2,\"sensor[1].works\":true}\n\
             {\"time\":1.25,\"trial\":3,\"queue.n\":-0.5,\"sensor[1].works\":false}\n"
        );
        assert_eq!(
            text(&|out| write_states_json(out, &names, rows())),
            "{\"schema\":1,\"columns\":[\"time\",\"trial\",\"queue.n\",\"sensor[1].works\"],\"rows\":[\n\
             [0,3,2,true],\n[1.25,3,-0.5,false]\n]}\n"
        );
    }
}
