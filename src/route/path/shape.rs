//! Paths as text: `L10 A45/7 L10 A60/3 L2` is a line of 10 m, an arc of 45 degrees to the left with a radius of 7 m,
//! and so on.

use super::path::Path;
use super::piece::{Piece, left, unit};
use crate::base::geometry::{FARTHEST, Vec2};
use crate::route::profile::Stretch;
use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

/// Most degrees of an arc.
const MOST_DEGREES: f64 = 36_000.0;

/// A part of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// A line of a length, m.
    Line(f64),
    /// An arc.
    Arc {
        /// How far it turns, degrees; positive to the left.
        degrees: f64,
        /// Its radius, m.
        radius: f64,
    },
}

/// The shape of a path, wherever it lies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathShape {
    /// Its parts, in order.
    pub parts: Vec<Part>,
}

/// An error in the text of a shape.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {column}: {message}")]
pub struct ShapeError {
    /// The character at which the wrong word begins, from 1.
    pub column: usize,
    /// What is wrong and what to write.
    pub message: String,
}

impl PathShape {
    /// Its parts as a profile sees them, with exact lengths.
    pub fn stretches(&self) -> Vec<Stretch> {
        let stretch = |part: &Part| match *part {
            Part::Line(length) => Stretch { length, radius: f64::INFINITY },
            Part::Arc { degrees, radius } => {
                Stretch { length: (degrees * (PI / 180.0)).abs() * radius, radius }
            }
        };
        self.parts.iter().map(stretch).collect()
    }

    /// The path from the origin along +x.
    pub fn path(&self) -> Path {
        let mut path = Path::empty(Vec2::zeros());
        let mut heading = 0.0;
        for part in &self.parts {
            let (from, direction) = (path.end().position, unit(heading * RADIANS));
            match *part {
                Part::Line(length) => path.push(Piece::Line { from, to: from + direction * length }),
                Part::Arc { degrees, radius } => {
                    let side = degrees.signum();
                    let centre = from + left(direction) * (side * radius);
                    let (from, turn) = ((heading - side * 90.0) * RADIANS, degrees * RADIANS);
                    path.push(Piece::Arc { centre, radius, from, turn });
                    heading += degrees;
                }
            }
        }
        path
    }
}

/// Radians of a degree.
const RADIANS: f64 = PI / 180.0;

impl fmt::Display for PathShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, part) in self.parts.iter().enumerate() {
            let space = if k > 0 { " " } else { "" };
            match part {
                Part::Line(length) => write!(f, "{space}L{length}")?,
                Part::Arc { degrees, radius } => write!(f, "{space}A{degrees}/{radius}")?,
            }
        }
        Ok(())
    }
}

impl FromStr for PathShape {
    type Err = ShapeError;

    fn from_str(text: &str) -> Result<Self, ShapeError> {
        let mut parts = Vec::new();
        let mut rest = text.char_indices().zip(1..).peekable();
        while let Some(((begin, c), column)) = rest.next() {
            if c.is_whitespace() {
                continue;
            }
            let mut end = begin + c.len_utf8();
            while let Some(((at, c), _)) = rest.next_if(|((_, c), _)| !c.is_whitespace()) {
                end = at + c.len_utf8();
            }
            let word = text.get(begin..end).unwrap_or_default();
            parts.push(part(word).map_err(|message| ShapeError { column, message })?);
        }
        if parts.is_empty() {
            let message = "the shape has no parts; write lines and arcs, as in `L10 A45/7`".to_owned();
            return Err(ShapeError { column: 1, message });
        }
        Ok(Self { parts })
    }
}

/// The part that a word means, or what is wrong with it.
fn part(word: &str) -> Result<Part, String> {
    if let Some(length) = word.strip_prefix('L') {
        let is_valid = |v: f64| v > 0.0 && v <= FARTHEST;
        let wanted = format!("`{word}` needs a length above 0 m and up to 1e6 m, as in `L10`");
        return number(length).filter(|v| is_valid(*v)).map(Part::Line).ok_or(wanted);
    }
    let Some(arc) = word.strip_prefix('A') else {
        return Err(format!(
            "`{word}` is no part of a path; write a line, as in `L10`, or an arc, as in `A45/7`"
        ));
    };
    let Some((degrees, radius)) = arc.split_once('/') else {
        let example = number(arc).map_or_else(|| "A45/7".to_owned(), |degrees| format!("A{degrees}/7"));
        return Err(format!("`{word}` needs a radius, as in `{example}`"));
    };
    let degrees = number(degrees).filter(|v| *v != 0.0 && v.abs() <= MOST_DEGREES).ok_or_else(|| {
        format!("`{word}` needs an angle in degrees up to 36000, positive to the left and negative to the right, as in `A45/7`")
    })?;
    let radius = number(radius)
        .filter(|v| *v > 0.0 && *v <= FARTHEST)
        .ok_or_else(|| format!("`{word}` needs a radius above 0 m and up to 1e6 m, as in `A45/7`"))?;
    Ok(Part::Arc { degrees, radius })
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|v: &f64| v.is_finite())
}
