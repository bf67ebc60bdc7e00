//! Inferred points as CSV, one row a point; what is unknown is empty.

use crate::perception::Inference;
use crate::report::number::thousandths;
use std::fmt::Write as _;

/// `time,trace,group,x,y,vx,vy,id`, by time and trace, in SI units, with three decimals.
pub fn to_csv(inference: &Inference) -> String {
    let mut text = "time,trace,group,x,y,vx,vy,id\n".to_owned();
    for one in &inference.points {
        let (time, p) = (thousandths(one.point.time), one.point.position.map(thousandths));
        let velocity = one.point.velocity.map(|v| v.map(thousandths));
        let velocity = velocity.map_or_else(|| ",".to_owned(), |v| format!("{},{}", v.x, v.y));
        let id = one.person.map_or_else(String::new, |id| id.to_string());
        let _ = writeln!(text, "{time},{},{},{},{},{velocity},{id}", one.trace, one.group, p.x, p.y);
    }
    text
}
