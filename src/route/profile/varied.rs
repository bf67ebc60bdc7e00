//! Varied profiles: random speeds at random knots, always legal.
//!
//! Li, Li, Ge 2019 draw pieces of constant acceleration one after the other. Here the same profiles are points of a convex
//! set: on a piece u is straight between two knots, and every limit is convex in the values of u at the knots (`limit`).
//! A backward pass finds the interval of u at each knot from which the end can be met. A forward pass draws each u from
//! the part of its interval that is legal after the one before. Exactly one draw a knot is needed, none is rejected.

use super::law::Law;
use super::limit::{Piece, Pieces};
use super::motion::Motion;
use super::optimum::Optimum;
use super::stretch::{Infeasible, Limits, Span, Stretch, spans};
use crate::base::math::ln;

/// Least share of the mean length that a piece has.
const LEAST_PIECE: f64 = 0.25;
/// Fewest pieces between two stops: with one, the speed would be 0 throughout.
const FEWEST: usize = 2;
/// How often knots are refined before end speeds count as too close to the limits: once by the joints, then by halving.
const REFINEMENTS: u32 = 7;
/// An end that is outside of its interval by less than this share of it is inside but for rounding.
const ROUNDING: f64 = 1e-12;
/// Between rests all u are smaller by this factor, which keeps them legal: rounding on arcs of millimetres.
const INSIDE: f64 = 1.0 - 1e-8;
/// Knots closer than this share of the path coincide.
const SAME_PLACE: f64 = 1e-12;

/// How profiles vary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variety {
    /// How many pieces a profile has. Each part between stops has at least 2; the others are shared out by length.
    pub pieces: usize,
    /// Least share of u that is drawn, in (0, 1], as a share of a typical profile on the same knots; 0.1 is a good choice.
    /// From rest to rest no profile takes longer than 1 / sqrt(floor) times the duration of the typical one.
    pub floor: f64,
    /// The law of the speeds at knots.
    pub law: Law,
}

/// A varied profile: the acceleration is constant between knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// x and u of the knots.
    knots: Vec<(f64, f64)>,
    /// When each knot is passed, s.
    times: Vec<f64>,
}

/// A knot of a part: its place, m, and the number of its draw.
#[derive(Clone, Copy, Debug)]
struct Knot {
    x: f64,
    number: u32,
}

/// A random profile of a path that begins with `start_speed` and ends with `end_speed`, m/s.
///
/// `draw(k)` gives two independent uniform numbers in (0, 1) that belong to knot k (`Stream::uniform_pair`): the first
/// one decides how long the piece is that ends at the knot, the second one the speed there. Knots are numbered from 1
/// along the path. Where the end speeds are too close to the limits for the drawn knots, more knots are added: the joints
/// of the path, then the middles of pieces. Their numbers begin above those of the drawn ones.
///
/// # Errors
///
/// Those of `optimal`; an invalid floor or law; end speeds so close to the limits that no refinement helps.
pub fn varied(
    stretches: &[Stretch],
    limits: Limits,
    start_speed: f64,
    end_speed: f64,
    variety: &Variety,
    mut draw: impl FnMut(u32) -> [f64; 2],
) -> Result<Varied, Infeasible> {
    let &Variety { pieces, floor, law } = variety;
    if !(floor > 0.0 && floor <= 1.0) {
        return Err(Infeasible::Floor { floor });
    }
    law.check()?;
    let spans = spans(stretches, limits)?;
    // Its errors name the largest end speeds.
    let optimum = Optimum::over(&spans, limits, start_speed, end_speed)?;
    let parts: Vec<&[Span]> = spans.split(Span::is_stop).filter(|part| length(part) > 0.0).collect();
    let counts = shares(&parts, pieces);
    let mut extra = counts.iter().sum::<usize>() as u32;
    let mut number = 0;
    let mut knots = vec![(0.0, start_speed * start_speed)];
    for (k, (part, count)) in parts.iter().zip(counts).enumerate() {
        let is_first = k == 0 && !spans.first().is_some_and(Span::is_stop);
        let is_last = k + 1 == parts.len() && !spans.last().is_some_and(Span::is_stop);
        let ends =
            [(is_first, start_speed), (is_last, end_speed)].map(|(is, v)| if is { v * v } else { 0.0 });
        let ramps = [(1, ends[0]), (count as u32, ends[1])]
            .map(|(k, u)| law.ramp(u, limits.along, draw(number + k)[0]));
        let mut places = drawn_knots(part, count, number, ramps, &mut draw);
        if places.windows(2).any(|w| w[1].x - w[0].x <= SAME_PLACE * optimum.length()) {
            return Err(Infeasible::Tight);
        }
        number += count as u32;
        let values = Values::find(&mut places, part, limits.along, ends, floor, &mut extra)?;
        knots.extend(values.draw(&places, law, &mut draw));
    }
    Ok(Varied::over(knots))
}

/// The length of a part, m.
fn length(part: &[Span]) -> f64 {
    part.iter().map(Span::length).sum()
}

/// How many pieces each part has: two, and the rest one by one where pieces are longest.
fn shares(parts: &[&[Span]], pieces: usize) -> Vec<usize> {
    let mut counts: Vec<(f64, usize)> = parts.iter().map(|part| (length(part), FEWEST)).collect();
    for _ in FEWEST * parts.len()..pieces {
        let mean = |(length, count): &(f64, usize)| length / *count as f64;
        if let Some(longest) = counts.iter_mut().max_by(|a, b| mean(a).total_cmp(&mean(b))) {
            longest.1 += 1;
        }
    }
    counts.into_iter().map(|(_, count)| count).collect()
}

/// Knots with random distances: a fixed share of each, and the rest by Dirichlet's law with all parameters 1.
///
/// Somebody who prefers a speed takes it up and gives it up within a few steps. The first and the last of at least three
/// pieces are then as long as these `ramps`, at most a quarter of the part each.
fn drawn_knots(
    part: &[Span],
    count: usize,
    before: u32,
    ramps: [Option<f64>; 2],
    draw: &mut impl FnMut(u32) -> [f64; 2],
) -> Vec<Knot> {
    let (start, end) = part.first().zip(part.last()).map_or((0.0, 0.0), |(a, b)| (a.start, b.end));
    let length = end - start;
    let least = length * LEAST_PIECE / count as f64;
    let within = |ramp: f64| ramp.max(least).min(0.25 * length);
    let [first, last] = ramps.map(|ramp| ramp.filter(|_| count > FEWEST).map(within));
    let (from, to) = (first.map_or(start, |ramp| start + ramp), last.map_or(end, |ramp| end - ramp));
    let (skipped, inner) =
        (usize::from(first.is_some()), count - usize::from(first.is_some()) - usize::from(last.is_some()));
    let mut sum = 0.0;
    let shares: Vec<f64> = (0..inner as u32)
        .map(|k| {
            sum -= ln(draw(before + skipped as u32 + k + 1)[0]);
            sum
        })
        .collect();
    let (fixed, random) = ((to - from) * LEAST_PIECE / inner as f64, (to - from) * (1.0 - LEAST_PIECE) / sum);
    let inner = (1..).zip(shares).map(|(k, share)| from + fixed * f64::from(k) + random * share);
    let places = std::iter::once(start).chain(first.map(|_| from)).chain(inner).chain(last.map(|_| end));
    let mut knots: Vec<Knot> = (before..).zip(places).map(|(number, x)| Knot { x, number }).collect();
    // The sums end there but for rounding.
    if let Some(knot) = knots.get_mut(count - usize::from(last.is_some())) {
        knot.x = to;
    }
    knots
}

/// Adds the joints of a part to its knots in the first round, the middles of all pieces in later ones.
fn refine(knots: &mut Vec<Knot>, part: &[Span], round: u32, extra: &mut u32) {
    let end = knots.last().map_or(0.0, |knot| knot.x);
    let more: Vec<f64> = if round == 0 {
        let is_new = |x: &f64| knots.iter().all(|knot| (knot.x - x).abs() > SAME_PLACE * end);
        part.iter().map(|span| span.start).filter(is_new).collect()
    } else {
        knots.windows(2).map(|w| 0.5 * (w[0].x + w[1].x)).collect()
    };
    knots.extend(more.into_iter().map(|x| {
        *extra += 1;
        Knot { x, number: *extra }
    }));
    knots.sort_by(|a, b| a.x.total_cmp(&b.x));
}

/// The values of u that a part allows.
struct Values {
    pieces: Pieces,
    /// u at the start of the part.
    start: f64,
    /// For each piece the u at its end from which the end of the part can be met above the floor.
    targets: Vec<(f64, f64)>,
}

impl Values {
    /// Finds them; refines the knots until the ends can be joined.
    fn find(
        knots: &mut Vec<Knot>,
        part: &[Span],
        along: f64,
        [start, end]: [f64; 2],
        floor: f64,
        extra: &mut u32,
    ) -> Result<Self, Infeasible> {
        for round in 0..=REFINEMENTS {
            let pieces = Pieces::new(knots.iter().map(|knot| knot.x), part, along);
            if let Some(targets) = targets(&pieces, start, end) {
                let mut values = Self { pieces, start, targets };
                values.raise(floor);
                return Ok(values);
            }
            refine(knots, part, round, extra);
        }
        Err(Infeasible::Tight)
    }

    /// Raises the lower ends of the targets to a legal profile, (1 - floor) · slow + floor · typical. The set of legal
    /// profiles is convex, so a profile above it exists from every target.
    ///
    /// `typical` is the mean of the profile that takes the largest u at one knot after the other and the one that takes the
    /// middle. The first one alone can be nearly 0 behind a sharp arc: before it, it takes the u from which only the steepest
    /// fall leads on.
    fn raise(&mut self, floor: f64) {
        let floors: Vec<f64> = {
            let (mut slow, mut middle, mut fast) = (self.start, self.start, self.start);
            let step = |(piece, &target): (&Piece, _)| {
                slow = self.pieces.onward(piece, slow, target).0;
                fast = self.pieces.onward(piece, fast, target).1;
                let (low, high) = self.pieces.onward(piece, middle, target);
                middle = 0.5 * (low + high);
                slow + floor * (0.5 * (middle + fast) - slow)
            };
            self.pieces.iter().zip(&self.targets).map(step).collect()
        };
        let mut next: Option<(&Piece, (f64, f64))> = None;
        for ((piece, target), low) in self.pieces.iter().zip(&mut self.targets).zip(floors).rev() {
            let low = low.max(target.0).min(target.1);
            let high = next
                .map_or(target.1, |(piece, onward)| self.pieces.last_source(piece, onward, low, target.1));
            *target = (low, high);
            next = Some((piece, *target));
        }
    }

    /// Draws u at every knot but the first one.
    fn draw(&self, knots: &[Knot], law: Law, draw: &mut impl FnMut(u32) -> [f64; 2]) -> Vec<(f64, f64)> {
        let mut u = self.start;
        let rests = u == 0.0 && self.targets.last() == Some(&(0.0, 0.0));
        let factor = if rests { INSIDE } else { 1.0 };
        let steps = self.pieces.iter().zip(&self.targets).zip(knots.iter().skip(1));
        steps
            .map(|((piece, &target), knot)| {
                let interval = self.pieces.onward(piece, u, target);
                let [_, uniform] = draw(knot.number);
                u = law.draw(interval, uniform);
                (knot.x, factor * u)
            })
            .collect()
    }
}

/// For each piece the interval of u at its end from which the end of the part can be met; `None` if the start is in none.
fn targets(pieces: &Pieces, start: f64, end: f64) -> Option<Vec<(f64, f64)>> {
    let mut target = (end, end);
    let mut targets = Vec::with_capacity(pieces.iter().len());
    for piece in pieces.iter().rev() {
        targets.push(target);
        target = pieces.sources(piece, target)?;
    }
    targets.reverse();
    let slack = ROUNDING * target.1;
    (start >= target.0 - slack && start <= target.1 + slack).then_some(targets)
}

impl Varied {
    fn over(knots: Vec<(f64, f64)>) -> Self {
        let mut time = 0.0;
        let mut times = vec![0.0];
        times.extend(knots.windows(2).map(|w| {
            time += 2.0 * (w[1].0 - w[0].0) / (w[0].1.sqrt() + w[1].1.sqrt());
            time
        }));
        Self { knots, times }
    }

    /// How long the motion takes, s.
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Distance from the start, m, and u = v^2, m^2/s^2, at every knot. Between knots u is straight in the distance.
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.knots
    }

    /// The motion at time t, s. A time outside of the motion is taken for its nearest end.
    pub fn motion(&self, t: f64) -> Motion {
        let t = t.max(0.0).min(self.duration());
        let after = self.times.partition_point(|time| *time <= t).min(self.times.len() - 1).max(1);
        let (before, behind) = (self.knots.get(after - 1), self.knots.get(after));
        let Some(((&(x, u), &(to, u_to)), &time)) = before.zip(behind).zip(self.times.get(after - 1)) else {
            let speed = self.knots.first().map_or(0.0, |(_, u)| u.sqrt());
            return Motion { speed, ..Motion::default() };
        };
        let acceleration = 0.5 * (u_to - u) / (to - x);
        let (speed, after) = (u.sqrt(), t - time);
        Motion {
            distance: (x + after * (speed + 0.5 * acceleration * after)).min(to),
            speed: (speed + acceleration * after).max(0.0),
            acceleration,
        }
    }

    /// The same profile with all speeds smaller by one factor, such that it takes `duration`, s: it stays legal. `None` if
    /// `duration` is shorter than that of the profile. End speeds shrink too.
    pub fn scaled_to(&self, duration: f64) -> Option<Self> {
        let factor = self.duration() / duration;
        if !(factor <= 1.0 && factor > 0.0) {
            return None;
        }
        let mut times: Vec<f64> = self.times.iter().map(|time| time / factor).collect();
        if let Some(last) = times.last_mut() {
            *last = duration;
        }
        let knots = self.knots.iter().map(|(x, u)| (*x, u * factor * factor)).collect();
        Some(Self { knots, times })
    }
}
