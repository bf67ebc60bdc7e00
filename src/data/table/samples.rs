//! A small table for the tests of the formats, with names that no format may trip over.

use super::*;

/// A name with everything that ends a cell, a string or a comment somewhere.
pub(super) const HOSTILE: &str = "cm,\"\n</script>";

pub(super) fn table() -> Table {
    let column = |(name, kind): (&str, Kind)| Column::new(name, kind);
    let columns = [
        ("time", Kind::Number("s")),
        ("trial", Kind::Whole),
        ("agent", Kind::Word),
        ("x", Kind::Number("m")),
        ("y", Kind::Number("m")),
        ("vx", Kind::Number("m/s")),
        ("vy", Kind::Number("m/s")),
        ("present", Kind::Truth),
        ("gap", Kind::Number("")),
        ("n", Kind::Whole),
        ("phone", Kind::Word),
    ];
    Table {
        columns: columns.map(column).to_vec(),
        scenario: HOSTILE.to_owned(),
        seed: 7,
        version: "0.1.0".to_owned(),
        interval: 0.1,
        ..Table::default()
    }
}

/// An agent that is there, and then is not.
pub(super) fn rows() -> Vec<Vec<Value<'static>>> {
    let number = Value::Number;
    let head = |time: f64| vec![number(time), Value::Whole(3), Value::Word(HOSTILE.into())];
    let here = [number(1.5), number(-0.25), number(0.3), number(0.4), Value::Truth(true)];
    let word = Value::Word("idle".into());
    let missing = [const { Value::Missing }; 4];
    vec![
        [head(0.0), here.to_vec(), vec![number(f64::INFINITY), Value::Whole(-2), word]].concat(),
        [
            head(0.1),
            missing.to_vec(),
            vec![Value::Truth(false), number(f64::NAN), Value::Whole(7), Value::Missing],
        ]
        .concat(),
    ]
}

/// What a format writes.
pub(super) fn bytes(format: &TraceFormat, table: &Table, rows: Vec<Vec<Value<'_>>>) -> io::Result<Vec<u8>> {
    let mut out = Vec::new();
    let wanted = rows.len() as u64;
    assert_eq!(write(format, &mut out, table, rows)?, wanted);
    Ok(out)
}

pub(super) fn text(format: &TraceFormat, table: &Table, rows: Vec<Vec<Value<'_>>>) -> String {
    String::from_utf8(bytes(format, table, rows).unwrap()).unwrap()
}

#[test]
fn a_row_that_does_not_fit_is_refused() {
    let said = |rows| bytes(&CSV, &table(), rows).unwrap_err().to_string();
    assert_eq!(said(vec![vec![Value::Missing]]), "a row has 1 values where there are 11 columns");
    let mut wrong = rows();
    wrong[1][3] = Value::Whole(1);
    assert_eq!(said(wrong), "a value of column `x` is of another kind");
}

#[test]
fn names_and_endings_are_each_of_one_format() {
    for (k, format) in FORMATS.iter().enumerate() {
        let others = || FORMATS.iter().skip(k + 1);
        assert!(others().all(|other| other.name != format.name && other.ending != format.ending));
    }
}
