//! Traces of walks as `smc compare-walks` reads them, at any rate: between two states the line between them.

use super::{Place, Walked};
use crate::data::table::{CSV, Column, Kind, Table, Value, write};
use crate::gait::Foot;
use std::io::{self, Write};

/// Rows nearer to the end of a walk than this give way to the end, s.
const NEAR: f64 = 1e-5;

/// The columns: time from the beginning of the leg, direction from +x to the left.
const COLUMNS: [(&str, Kind); 8] = [
    ("walk", Kind::Word),
    ("leg", Kind::Word),
    ("t", Kind::Number("s")),
    ("x", Kind::Number("m")),
    ("y", Kind::Number("m")),
    ("heading", Kind::Number("deg")),
    ("foot", Kind::Word),
    ("step", Kind::Whole),
];

/// `walk,leg,t,x,y,heading,foot,step` at so many rows a second and at the end of each leg, times and places to 1e-5.
/// Walks that take no time are left out; their number is returned.
///
/// # Errors
/// Errors of the writer.
pub fn write_traces(out: &mut dyn Write, walked: &Walked, rate: f64) -> io::Result<u64> {
    let columns = COLUMNS.map(|(name, kind)| Column::new(name, kind)).to_vec();
    let is_alone = walked.agents().count() == 1;
    let walks = || walked.legs.iter().flat_map(|leg| leg.walks.iter().map(move |walk| (leg, walk)));
    let lasts = |places: &[Place]| walked.dt * places.len().saturating_sub(1) as f64;
    let rows = walks().filter(|(_, walk)| lasts(&walk.places) > 0.0).flat_map(|(leg, walk)| {
        let name =
            |number: u64| if is_alone { number.to_string() } else { format!("{} {number}", leg.agent) };
        let names = [name(walk.trial), name(leg.number as u64)];
        let end = lasts(&walk.places);
        let times = (0_u64..).map(move |k| k as f64 / rate).take_while(move |t| *t < end - NEAR).chain([end]);
        times.map(move |t| {
            let names = names.clone().map(|name| Value::Word(name.into()));
            names.into_iter().chain(row(&walk.places, t, walked.dt)).collect()
        })
    });
    write(&CSV, out, &Table { columns, ..Table::default() }, rows)?;
    Ok(walks().filter(|(_, walk)| lasts(&walk.places) <= 0.0).count() as u64)
}

/// What is after the names: time, place, direction and step.
fn row(places: &[Place], t: f64, dt: f64) -> [Value<'static>; 6] {
    let before = ((t / dt) as usize).min(places.len() - 2);
    let (a, b) = (places[before], places[before + 1]);
    let at = a.position + (b.position - a.position) * (t / dt - before as f64);
    // The quotient of whole numbers is the double nearest to the decimal.
    let rounded = |number: f64, steps: f64| Value::Number((number * steps).round() / steps);
    let (foot, step) = match a.step {
        Some((foot, step)) => {
            let foot = if foot == Foot::Left { "left" } else { "right" };
            (Value::Word(foot.into()), Value::Whole(i64::from(step)))
        }
        None => (Value::Missing, Value::Missing),
    };
    [rounded(t, 1e5), rounded(at.x, 1e5), rounded(at.y, 1e5), rounded(a.heading, 1e2), foot, step]
}
