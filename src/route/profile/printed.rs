//! Algorithm 1 of Li, Li, Ge 2019 as printed, for comparison only. Use `varied` to draw profiles.
//!
//! Most runs do not return: the acceleration at a resting end has the wrong sign, or too few pieces are left for the
//! counter of the loop. Of the profiles that it returns, most break a limit: the acceleration of a piece is drawn for the
//! speed at its start alone, and the last two pieces are joined by a straight line in the (s, ds/dt) plane, whose
//! acceleration is not constant. "Decrease" is read as "halve".

use super::region::{Region, region};
use super::stretch::{Infeasible, Limits, Span, Stretch, spans};
use crate::base::math::ln_1p;

/// A number that is still too large after so many halvings counts as one that never fits.
const HALVINGS: u32 = 36;
/// A limit is broken if it is exceeded by more than this share.
const ROUNDING: f64 = 1e-9;
/// The largest share of the path that the first and the last piece take.
const LARGEST_END: f64 = 0.25;

/// Why the algorithm never returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeverReturns {
    /// The first piece leaves the region however short it is.
    Start,
    /// The last piece leaves the region however short it is.
    End,
    /// There are at most four pieces, so that the counter never meets its end.
    Pieces,
    /// A piece in between leaves the region however short it is.
    Stuck,
}

/// What a run of the algorithm gives.
#[derive(Clone, Debug)]
pub enum Printed {
    /// No profile.
    NeverReturns(NeverReturns),
    /// A profile, legal or not.
    Profile(Box<PrintedProfile>),
}

/// A profile of the algorithm.
#[derive(Clone, Debug)]
pub struct PrintedProfile {
    spans: Vec<Span>,
    limits: Limits,
    region: Region,
    /// The pieces of constant acceleration in their order: all but the last come before the join.
    pieces: Vec<Straight>,
    /// The join of the last two: v is straight in x.
    join: Straight,
}

/// A part of a profile from one place to another, m, with u = v^2 at both, m^2/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Straight {
    from: (f64, f64),
    to: (f64, f64),
}

/// Which limits a profile breaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Violations {
    /// A piece of constant acceleration exceeds the largest acceleration.
    pub piece_acceleration: bool,
    /// The join exceeds the largest acceleration.
    pub join_acceleration: bool,
    /// The join leaves the feasible region.
    pub join_region: bool,
}

impl NeverReturns {
    /// As a phrase.
    pub const fn phrase(self) -> &'static str {
        match self {
            Self::Start => "the first piece leaves the region however short it is",
            Self::End => "the last piece leaves the region however short it is",
            Self::Pieces => "four pieces or fewer, so that the counter never meets its end",
            Self::Stuck => "a piece in between leaves the region however short it is",
        }
    }
}

impl Violations {
    /// What is broken.
    pub fn names(self) -> Vec<&'static str> {
        let all = [
            (self.piece_acceleration, "a piece breaks the limit of acceleration"),
            (self.join_acceleration, "the join breaks the limit of acceleration"),
            (self.join_region, "the join leaves the region"),
        ];
        all.into_iter().filter_map(|(is, name)| is.then_some(name)).collect()
    }

    /// Whether any limit is broken.
    pub fn any(self) -> bool {
        self.piece_acceleration || self.join_acceleration || self.join_region
    }
}

/// One run of the algorithm with so many `pieces` (m0), or with a number of them that is drawn from 2 to 10 as printed. `draw(k)`
/// gives independent uniform numbers in (0, 1).
///
/// # Errors
///
/// Those of `optimal`.
pub fn printed(
    stretches: &[Stretch],
    limits: Limits,
    start_speed: f64,
    end_speed: f64,
    pieces: Option<usize>,
    mut draw: impl FnMut(u32) -> f64,
) -> Result<Printed, Infeasible> {
    let region = region(stretches, limits, start_speed, end_speed)?;
    let spans = spans(stretches, limits)?;
    let length = region.optimum().length();
    let mut number = 0;
    let mut uniform = || {
        number += 1;
        draw(number - 1)
    };
    // Lines 1 to 10: the first piece.
    let start = (0.0, start_speed * start_speed);
    let span = spans.iter().find(|span| span.end > 0.0);
    let acceleration = (2.0 * uniform() - 1.0) * span.map_or(0.0, |span| effort(span, start.1, limits.along));
    let first = shrunk(&region, start, acceleration, uniform() * LARGEST_END * length);
    let Some(first) = first else { return Ok(Printed::NeverReturns(NeverReturns::Start)) };
    // Lines 11 to 17: the last one, backwards.
    let end = (length, end_speed * end_speed);
    let span = spans.iter().rev().find(|span| span.start < length);
    let acceleration = (2.0 * uniform() - 1.0) * span.map_or(0.0, |span| effort(span, end.1, limits.along));
    let last = shrunk(&region, end, acceleration, -uniform() * LARGEST_END * length);
    let Some(last) = last else { return Ok(Printed::NeverReturns(NeverReturns::End)) };
    // Lines 18 to 28: pieces in between. The counter begins at 1 and is compared with m0 - 3 after it is raised. The loop
    // as printed ends before P_{m0-3}, from which line 29 joins; here that piece is made too.
    let drawn = 2 + (uniform() * 9.0) as usize;
    let count = pieces.unwrap_or(drawn);
    if count <= 4 {
        return Ok(Printed::NeverReturns(NeverReturns::Pieces));
    }
    let step = (last.to.0 - first.to.0) / (count - 2) as f64;
    let mut pieces = vec![first];
    let mut at = first.to;
    for _ in 1..count - 2 {
        let span = spans.iter().find(|span| span.end > at.0);
        let acceleration =
            (2.0 * uniform() - 1.0) * span.map_or(0.0, |span| effort(span, at.1, limits.along));
        let Some(piece) = shrunk(&region, at, acceleration, step) else {
            return Ok(Printed::NeverReturns(NeverReturns::Stuck));
        };
        pieces.push(piece);
        at = piece.to;
    }
    // Line 29: the join.
    pieces.push(Straight { from: last.to, to: last.from });
    let join = Straight { from: at, to: last.to };
    Ok(Printed::Profile(Box::new(PrintedProfile { spans, limits, region, pieces, join })))
}

/// The largest acceleration along a span at u, m/s^2.
fn effort(span: &Span, u: f64, along: f64) -> f64 {
    let share = (u / span.bend).min(1.0);
    along * ((1.0 - share) * (1.0 + share)).sqrt()
}

/// A piece of constant acceleration, halved until it stays in the region.
fn shrunk(region: &Region, from: (f64, f64), acceleration: f64, mut step: f64) -> Option<Straight> {
    for _ in 0..=HALVINGS {
        let to = (from.0 + step, from.1 + 2.0 * acceleration * step);
        let u = |x: f64| from.1 + 2.0 * acceleration * (x - from.0);
        if stays(region, from.0.min(to.0), from.0.max(to.0), u) {
            return Some(Straight { from, to });
        }
        step *= 0.5;
    }
    None
}

/// Whether u stays in the region. Both ends and all places where the upper boundary bends are enough, because u is convex
/// and the boundary is concave in between.
fn stays(region: &Region, from: f64, to: f64, u: impl Fn(f64) -> f64) -> bool {
    let inner = region.optimum().turns().filter(|x| *x > from && *x < to);
    inner.chain([from, to]).all(|x| {
        let (u, low, high) = (u(x), region.lowest(x), region.highest(x));
        let slack = ROUNDING * high * high;
        u >= low * low - slack && u <= high * high + slack
    })
}

impl PrintedProfile {
    /// Which limits the profile breaks.
    pub fn violations(&self) -> Violations {
        let (join, Limits { along, .. }) = (self.join, self.limits);
        let exceeds = |u: f64, acceleration: f64, span: &Span| {
            let (share, across) = (acceleration / along, u / span.bend);
            share * share + across * across > 1.0 + ROUNDING
        };
        let piece_acceleration = self.pieces.iter().any(|piece| {
            let acceleration = 0.5 * (piece.to.1 - piece.from.1) / (piece.to.0 - piece.from.0);
            self.ends(piece).any(|(span, x)| {
                exceeds(piece.from.1 + 2.0 * acceleration * (x - piece.from.0), acceleration, span)
            })
        });
        // v = p + q x has the acceleration q v.
        let slope = (join.to.1.sqrt() - join.from.1.sqrt()) / (join.to.0 - join.from.0);
        let speed = |x: f64| join.from.1.sqrt() + slope * (x - join.from.0);
        let join_acceleration =
            self.ends(&join).any(|(span, x)| exceeds(speed(x) * speed(x), slope * speed(x), span));
        let join_region = !stays(&self.region, join.from.0, join.to.0, |x| speed(x) * speed(x));
        Violations { piece_acceleration, join_acceleration, join_region }
    }

    /// Time, s, place, m, speed, m/s, and acceleration along the path, m/s^2, at so many places of each piece, and at the end.
    pub fn points(&self, per_piece: u32) -> Vec<[f64; 4]> {
        let (last, before) = (self.pieces.len() - 1, self.pieces.iter());
        let parts = before
            .take(last)
            .map(|piece| (piece, false))
            .chain([(&self.join, true), (&self.pieces[last], false)]);
        let (mut rows, mut begin) = (Vec::new(), 0.0);
        let mut end = [0.0; 4];
        for (part, is_join) in parts {
            let ((from, low), (to, high)) = (part.from, part.to);
            let (v, length) = (low.sqrt(), to - from);
            let row = |k: u32| {
                let x = length * f64::from(k) / f64::from(per_piece);
                if is_join {
                    let slope = (high.sqrt() - v) / length;
                    let speed = v + slope * x;
                    let ratio = slope * x / v;
                    let time = if ratio.abs() < 1e-12 { x / v } else { x / v * ln_1p(ratio) / ratio };
                    [begin + time, from + x, speed, slope * speed]
                } else {
                    let acceleration = 0.5 * (high - low) / length;
                    let speed = (low + 2.0 * acceleration * x).max(0.0).sqrt();
                    let mean = 0.5 * (v + speed);
                    [begin + if mean > 0.0 { x / mean } else { 0.0 }, from + x, speed, acceleration]
                }
            };
            rows.extend((0..per_piece).map(row));
            end = row(per_piece);
            begin = end[0];
        }
        rows.push(end);
        rows
    }

    /// How long the motion takes, s; infinite if the join reaches speed 0.
    pub fn duration(&self) -> f64 {
        let pieces = self.pieces.iter().map(|piece| {
            let (from, to) = (piece.from, piece.to);
            2.0 * (to.0 - from.0) / (from.1.sqrt() + to.1.sqrt())
        });
        let (from, to) = (self.join.from.1.sqrt(), self.join.to.1.sqrt());
        let length = self.join.to.0 - self.join.from.0;
        // The integral of dx / v for v straight in x.
        let ratio = (to - from) / from;
        let join = if ratio == 0.0 { length / from } else { length / from * ln_1p(ratio) / ratio };
        pieces.sum::<f64>() + join
    }

    /// The ends of the overlaps of a part with each span.
    fn ends<'a>(&'a self, part: &'a Straight) -> impl Iterator<Item = (&'a Span, f64)> {
        self.spans.iter().flat_map(|span| {
            let (from, to) = (span.start.max(part.from.0), span.end.min(part.to.0));
            let overlaps = from < to;
            [from, to].into_iter().filter(move |_| overlaps).map(move |x| (span, x))
        })
    }
}
