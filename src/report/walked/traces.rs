//! Traces of walks as `smc compare-walks` reads them, at any rate: between two states the line between them.

use super::Walked;
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
    for (leg, walk) in walked.legs.iter().flat_map(|leg| leg.walks.iter().map(move |walk| (leg, walk))) {
        let name =
            |number: u64| if is_alone { number.to_string() } else { format!("{} {number}", leg.agent) };
        let names = [name(walk.trial), name(leg.number as u64)];
        let (places, dt) = (&walk.places, walked.dt);
        let end = dt * places.len().saturating_sub(1) as f64;
        if end == 0.0 {
            left_out += 1;
            continue;
        }
        let times = (0_u64..).map(|k| k as f64 / rate).take_while(|t| *t < end - NEAR).chain([end]);
        for t in times {
            let before = ((t / dt) as usize).min(places.len() - 2);
            let (a, b) = (places[before], places[before + 1]);
            let at = a.position + (b.position - a.position) * (t / dt - before as f64);
            let (foot, step) = match a.step {
                Some((Foot::Left, step)) => ("left", step.to_string()),
                Some((Foot::Right, step)) => ("right", step.to_string()),
                None => ("", String::new()),
            };
            let numbers = [t, at.x, at.y].map(|number| format!("{number:.5}"));
            let cells = names.iter().chain(&numbers).map(String::as_str);
            table.write_record(cells.chain([format!("{:.2}", a.heading).as_str(), foot, &step]))?;
        }
    }
    table.flush()?;
    Ok(left_out)
}
