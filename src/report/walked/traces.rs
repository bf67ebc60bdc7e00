//! Traces of walks as `smc compare-walks` reads them, at any rate: between two states the line between them.

use super::{LegWalk, Walked, WalkedLeg};
use crate::gait::Foot;
use std::io::{self, Write};

/// Rows nearer to the end of a walk than this give way to the end, s.
const NEAR: f64 = 1e-5;

/// `walk,leg,t,x,y,heading,foot,step`: time from the beginning of the leg, s, at so many rows a second and at its end.
/// Walks that take no time are left out; their number is returned.
///
/// # Errors
/// Errors of the writer.
pub fn write_traces(out: impl Write, walked: &Walked, rate: f64) -> io::Result<u64> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["walk", "leg", "t", "x", "y", "heading", "foot", "step"])?;
    let is_alone = walked.agents().count() == 1;
    let mut left_out = 0;
    for leg in &walked.legs {
        let name =
            |number: u64| if is_alone { number.to_string() } else { format!("{} {number}", leg.agent) };
        for walk in &leg.walks {
            let names = [name(walk.trial), name(leg.number as u64)];
            if walk.places.len() < 2 {
                left_out += 1;
            } else {
                rows(&mut table, leg, walk, &names, (walked.dt, rate))?;
            }
        }
    }
    table.flush()?;
    Ok(left_out)
}

fn rows(
    table: &mut csv::Writer<impl Write>,
    leg: &WalkedLeg,
    walk: &LegWalk,
    names: &[String; 2],
    (dt, rate): (f64, f64),
) -> io::Result<()> {
    let places = &walk.places;
    let end = dt * (places.len() - 1) as f64;
    let times = (0_u64..).map(|k| k as f64 / rate).take_while(|t| *t < end - NEAR).chain([end]);
    for t in times {
        let before = ((t / dt) as usize).min(places.len() - 2);
        let (a, b) = (places[before], places[before + 1]);
        let at = a.position + (b.position - a.position) * (t / dt - before as f64);
        let (foot, step) = match a.step.filter(|_| leg.steps) {
            Some((Foot::Left, step)) => ("left", step.to_string()),
            Some((Foot::Right, step)) => ("right", step.to_string()),
            None => ("", String::new()),
        };
        let numbers = [t, at.x, at.y].map(|number| format!("{number:.5}"));
        let heading = format!("{:.2}", a.heading);
        let cells = names.iter().chain(&numbers).map(String::as_str);
        table.write_record(cells.chain([heading.as_str(), foot, step.as_str()]))?;
    }
    Ok(())
}
