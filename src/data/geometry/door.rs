//! Doors: openings of the walls beside them.

use super::feature::FilePlace;
use crate::base::geometry::{Segment, Vec2, cross};

/// A door opens the walls within this distance: both faces of a wall, m.
const REACH: f64 = 0.5;
/// Largest sine of the angle between a door and a wall that it opens: 10 degrees.
const SLANT: f64 = 0.17;
/// Pieces of walls that lie within this distance of one line are one wall, m.
const ONE_LINE: f64 = 0.01;
/// Most walls that are looked at where they meet at a door.
const MOST_WALLS: usize = 16;
/// What is shorter is no piece of a wall, m.
const SHORTEST: f64 = 1e-3;

/// A door.
#[derive(Clone, Debug, PartialEq)]
pub struct Door {
    /// Where it is in its file.
    pub place: FilePlace,
    /// Its name there; may be empty.
    pub name: String,
    /// Its middle, m.
    pub at: Vec2,
    /// Its direction, of length 1, if it is drawn as a line.
    pub along: Option<Vec2>,
    /// Its width, m.
    pub width: f64,
    /// Whether it has a property `level`.
    pub has_level: bool,
}

/// What a door has opened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opened {
    /// Its width: the opening.
    Whole(Segment),
    /// Less than its width: as much as its wall has, m.
    Part(f64),
    /// Nothing: no wall is near enough.
    Nothing,
}

/// A part of a straight line: from `low` to `high` along a direction of length 1, m.
struct Opening {
    at: Vec2,
    along: Vec2,
    low: f64,
    high: f64,
}

impl Opening {
    /// The stretch of a piece of a wall along the line, from its end `a`; none where it runs in another direction or
    /// farther away.
    fn stretch(&self, piece: &Segment, reach: f64) -> Option<(f64, f64)> {
        let (a, b) = (piece.a - self.at, piece.b - self.at);
        let is_parallel = cross(self.along, b - a).abs() <= SLANT * piece.length();
        let is_near = [a, b].iter().all(|end| cross(self.along, *end).abs() <= reach);
        (is_parallel && is_near).then(|| (a.dot(&self.along), b.dot(&self.along)))
    }

    /// Where a piece that runs in another direction meets the line.
    fn meeting(&self, piece: &Segment) -> Option<f64> {
        let (a, b) = (piece.a - self.at, piece.b - self.at);
        let (left, right) = (cross(self.along, a), cross(self.along, b));
        let is_across = (left - right).abs() > SLANT * piece.length();
        let meets = left * right < 0.0 || left.abs() <= ONE_LINE || right.abs() <= ONE_LINE;
        let share = (left / (left - right)).clamp(0.0, 1.0);
        (is_across && meets).then(|| (a + (b - a) * share).dot(&self.along))
    }

    /// Goes as far as the wall does without a gap and without another wall that meets it, to one side of a wall that
    /// meets it here; whether the wall ends here.
    fn run<'p>(&mut self, pieces: impl Iterator<Item = &'p Segment> + Clone) -> bool {
        let sorted = |(a, b): (f64, f64)| if a < b { (a, b) } else { (b, a) };
        let mut stretches: Vec<_> =
            pieces.clone().filter_map(|piece| self.stretch(piece, ONE_LINE)).map(sorted).collect();
        stretches.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut runs: Vec<(f64, f64)> = Vec::new();
        for (low, high) in stretches {
            match runs.last_mut() {
                Some((_, end)) if low <= *end + ONE_LINE => *end = if high > *end { high } else { *end },
                _ => runs.push((low, high)),
            }
        }
        let distance = |(low, high): &(f64, f64)| if *low > 0.0 { *low } else { (-high).max(0.0) };
        let nearest = runs.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let (mut low, mut high) = nearest.unwrap_or((0.0, 0.0));
        let ends_here = low >= -ONE_LINE || high <= ONE_LINE;
        let mut is_met = false;
        for t in pieces.filter_map(|piece| self.meeting(piece)) {
            if t < -ONE_LINE && t > low {
                low = t;
            } else if t > ONE_LINE && t < high {
                high = t;
            } else {
                is_met |= t.abs() <= ONE_LINE;
            }
        }
        if is_met && !ends_here {
            (low, high) = if high < -low { (low, 0.0) } else { (0.0, high) };
        }
        (self.low, self.high) = (low, high);
        ends_here
    }
}

/// Opens walls at doors; what each door has opened. All doors are seen before any wall is opened, so two at one place
/// do what one does.
///
/// A door opens the pieces of walls within 0.5 m that run in the direction of the nearest one. Where it would pass
/// the end of its wall, or another wall that meets it, it is moved along it. Where walls meet, its wall is one that ends
/// there, then the longest one.
pub fn open_doors(walls: &mut [&mut Vec<Segment>], doors: &[Door]) -> Vec<Opened> {
    let (mut openings, mut found) = (Vec::new(), Vec::new());
    for door in doors {
        let pieces = walls.iter().flat_map(|wall| wall.iter());
        let Some(mut opening) = line(door, &pieces) else {
            found.push(Opened::Nothing);
            continue;
        };
        let (low, high) = (opening.low, opening.high);
        let half = 0.5 * door.width;
        let is_short = high - low < door.width - ONE_LINE;
        (opening.low, opening.high) = if high - low <= door.width {
            (low, high)
        } else if low > -half {
            (low, low + door.width)
        } else if high < half {
            (high - door.width, high)
        } else {
            (-half, half)
        };
        let end = |t: f64| opening.at + opening.along * t;
        let whole = Segment::new(end(opening.low), end(opening.high));
        found.push(if is_short { Opened::Part(high - low) } else { Opened::Whole(whole) });
        openings.push(opening);
    }
    for wall in walls {
        **wall = wall.drain(..).flat_map(|piece| cut(piece, &openings, REACH)).collect();
    }
    found
}

/// Opens the pieces of walls that lie on a door just there, or finds them all open; how much of its width it has opened, m.
pub fn open_at(walls: &mut [&mut Vec<Segment>], door: &Segment) -> f64 {
    let width = door.length();
    let opening = Opening { at: door.a, along: (door.b - door.a) / width, low: 0.0, high: width };
    let mut opened = 0.0;
    for piece in walls.iter().flat_map(|wall| wall.iter()) {
        if let Some((a, b)) = opening.stretch(piece, ONE_LINE) {
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            let shared = high.min(width) - low.max(0.0);
            opened += if shared > 0.0 { shared } else { 0.0 };
        }
    }
    for wall in walls {
        **wall =
            wall.drain(..).flat_map(|piece| cut(piece, std::slice::from_ref(&opening), ONE_LINE)).collect();
    }
    opened
}

/// The line of the wall that is nearest to a door, through its point nearest to the door, as far as it goes on without a
/// gap and without another wall that meets it.
fn line<'p, P: Iterator<Item = &'p Segment> + Clone>(door: &Door, pieces: &P) -> Option<Opening> {
    let is_parallel = |piece: &&Segment| {
        door.along.is_none_or(|along| cross(along, piece.b - piece.a).abs() <= SLANT * piece.length())
    };
    let mut near: Vec<(f64, &Segment)> = pieces
        .clone()
        .filter(|piece| piece.length() > SHORTEST)
        .filter(is_parallel)
        .map(|piece| (piece.distance(door.at), piece))
        .filter(|(distance, _)| *distance <= REACH)
        .collect();
    let least = near.iter().map(|(distance, _)| *distance).fold(REACH, f64::min);
    near.retain(|(distance, _)| *distance < least + ONE_LINE);
    near.sort_by(|a, b| a.1.length().total_cmp(&b.1.length()));
    let longest = &near[near.len().saturating_sub(MOST_WALLS)..];
    let openings = longest.iter().map(|(_, piece)| {
        let along = (piece.b - piece.a) / piece.length();
        let at = piece.a + along * (door.at - piece.a).dot(&along);
        let mut opening = Opening { at, along, low: 0.0, high: 0.0 };
        (opening.run(pieces.clone()), opening)
    });
    openings.max_by_key(|(ends_here, _)| *ends_here).map(|(_, opening)| opening)
}

/// What openings leave of a piece as near as a reach, m.
fn cut(piece: Segment, openings: &[Opening], reach: f64) -> Vec<Segment> {
    let mut left = vec![piece];
    for opening in openings {
        let around = Vec2::repeat(opening.high.abs().max(opening.low.abs()) + reach);
        let (low, high) = (piece.a.inf(&piece.b) - opening.at, piece.a.sup(&piece.b) - opening.at);
        if low.x > around.x || low.y > around.y || high.x < -around.x || high.y < -around.y {
            continue;
        }
        left = left
            .into_iter()
            .flat_map(|part| match opening.stretch(&part, reach) {
                Some((a, b)) if a != b => {
                    let at = |t: f64| part.a + (part.b - part.a) * ((t - a) / (b - a)).clamp(0.0, 1.0);
                    let (first, last) =
                        if a < b { (opening.low, opening.high) } else { (opening.high, opening.low) };
                    vec![Segment::new(part.a, at(first)), Segment::new(at(last), part.b)]
                }
                _ => vec![part],
            })
            .filter(|part| part.length() > SHORTEST)
            .collect();
    }
    left
}
