//! The legal speeds of one piece of a varied profile, on which u is straight: intervals in closed form.
//!
//! Let a = u at the start of the piece and y = (du/dx) / (2 · along), the share of the acceleration that is spent along the
//! path. All limits are convex in (a, y), and for a given a each is an interval of y. The set of a for which some y leads
//! into a given interval is an interval too: where the concave width of the intersection is not negative.

use super::stretch::Span;

/// Iterations of a search before its best point so far is taken. Newton's method needs three to six.
const MOST_STEPS: u32 = 80;
/// After a step that is smaller than this share of the range, Newton's method is exact to rounding.
const FINE: f64 = 1e-12;

/// A width of y above this is negative by rounding alone.
const NO_ROOM: f64 = -1e-13;

/// A limit on u at one place of a piece.
#[derive(Clone, Copy, Debug)]
enum Limit {
    /// u <= top at the place that full effort changes by `reach` (2 · along · distance from the start of the piece), m^2/s^2.
    Top { top: f64, per_reach: f64 },
    /// y^2 + (u / bend)^2 <= 1 there, with turn = reach / bend.
    Bend { per_bend: f64, turn: f64, per_norm: f64 },
}

/// A bound on y, with its derivative by a.
#[derive(Clone, Copy, Debug)]
struct Edge {
    at: f64,
    slope: f64,
}

impl Edge {
    fn lower(self, other: Self) -> Self {
        if other.at < self.at { other } else { self }
    }

    fn upper(self, other: Self) -> Self {
        if other.at > self.at { other } else { self }
    }
}

/// A piece between two knots with the limits on it.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    limits: std::ops::Range<usize>,
    /// 2 · along · length: how far full effort changes u, m^2/s^2.
    reach: f64,
    /// No larger u at the start is legal, m^2/s^2.
    most: f64,
}

/// The pieces between knots.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    limits: Vec<Limit>,
    pieces: Vec<Piece>,
}

impl Pieces {
    /// The pieces between knots at rising places, m, over spans that cover them.
    pub(super) fn new(knots: impl Iterator<Item = f64> + Clone, spans: &[Span], along: f64) -> Self {
        let mut all = Self::default();
        let mut spans = spans;
        for (from, to) in knots.clone().zip(knots.skip(1)) {
            while let [first, rest @ ..] = spans
                && first.end <= from
            {
                spans = rest;
            }
            let begin = all.limits.len();
            let mut most = f64::INFINITY;
            for span in spans.iter().take_while(|span| span.start < to) {
                for place in [span.start.max(from), span.end.min(to)] {
                    let reach = 2.0 * along * (place - from);
                    if place <= from {
                        most = most.min(span.cap);
                    } else if span.cap < span.bend {
                        all.limits.push(Limit::Top { top: span.cap, per_reach: 1.0 / reach });
                    }
                    if span.bend < f64::INFINITY {
                        let turn = reach / span.bend;
                        let norm = 1.0 + turn * turn;
                        most = most.min(span.bend * norm.sqrt());
                        let per_bend = 1.0 / span.bend;
                        all.limits.push(Limit::Bend { per_bend, turn, per_norm: 1.0 / norm });
                    }
                }
            }
            let limits = begin..all.limits.len();
            all.pieces.push(Piece { limits, reach: 2.0 * along * (to - from), most });
        }
        all
    }

    /// The pieces in their order along the path.
    pub(super) fn iter(&self) -> std::slice::Iter<'_, Piece> {
        self.pieces.iter()
    }

    /// The legal y from u = a.
    fn effort(&self, piece: &Piece, a: f64) -> (Edge, Edge) {
        let (mut low, mut high) = (Edge { at: -1.0, slope: 0.0 }, Edge { at: 1.0, slope: 0.0 });
        for limit in self.limits.get(piece.limits.clone()).unwrap_or_default() {
            match *limit {
                Limit::Top { top, per_reach } => {
                    high = high.lower(Edge { at: (top - a) * per_reach, slope: -per_reach });
                }
                Limit::Bend { per_bend, turn, per_norm } => {
                    let share = a * per_bend;
                    let root = (1.0 + turn * turn - share * share).max(0.0).sqrt();
                    let (middle, steep) = (share * turn, share / root);
                    let scale = per_bend * per_norm;
                    high =
                        high.lower(Edge { at: (root - middle) * per_norm, slope: -(steep + turn) * scale });
                    low = low.upper(Edge { at: (-root - middle) * per_norm, slope: (steep - turn) * scale });
                }
            }
        }
        (low, high)
    }

    /// How much room the interval of y from u = a has that leads into [low, high], and its derivative by a.
    fn room(&self, piece: &Piece, (low, high): (f64, f64), a: f64) -> Edge {
        let (least, most) = self.effort(piece, a);
        let per_reach = 1.0 / piece.reach;
        let least = least.upper(Edge { at: (low - a) * per_reach, slope: -per_reach });
        let most = most.lower(Edge { at: (high - a) * per_reach, slope: -per_reach });
        Edge { at: most.at - least.at, slope: most.slope - least.slope }
    }

    /// The legal u at the end of a piece from u = a at its start, within `target`. Where rounding leaves nothing, the point of
    /// `target` next to the legal ones.
    pub(super) fn onward(&self, piece: &Piece, a: f64, target: (f64, f64)) -> (f64, f64) {
        let (low, high) = self.effort(piece, a);
        let place = |y: f64| (a + piece.reach * y).max(target.0).min(target.1);
        let (low, high) = (place(low.at), place(high.at));
        (low.min(high), high)
    }

    /// The interval of u at the start of a piece from which some legal y leads into `target`.
    pub(super) fn sources(&self, piece: &Piece, target: (f64, f64)) -> Option<(f64, f64)> {
        // The width is concave: from the left, Newton's method rises to the first root without passing it.
        let mut low = 0.0;
        let mut steps = 0;
        loop {
            let room = self.room(piece, target, low);
            if room.at >= NO_ROOM {
                break;
            }
            let step = -room.at / room.slope;
            // At a peak below 0 the slope has the wrong sign, or steps lead out of the range.
            if room.slope <= 0.0 || low + step > piece.most || steps == MOST_STEPS {
                return None;
            }
            low += step;
            if step <= FINE * piece.most {
                break;
            }
            steps += 1;
        }
        Some((low, self.last_source(piece, target, low, piece.most)))
    }

    /// The largest u in [low, high] from which some legal y leads into `target`; `low` is one.
    pub(super) fn last_source(&self, piece: &Piece, target: (f64, f64), mut low: f64, mut high: f64) -> f64 {
        let mut room = self.room(piece, target, high);
        if room.at >= 0.0 {
            return high;
        }
        let mut below = self.room(piece, target, low).at.max(0.0);
        for _ in 0..MOST_STEPS {
            // From the right, Newton's method falls to the last root without passing it.
            let step = room.at / room.slope;
            let newton = room.slope.is_finite() && step > 0.0 && high - step > low;
            let next = if newton {
                high - step
            } else {
                // At the end of its range an ellipse is vertical: the width is like a square root there. Where it is flat
                // at 0, as before a given end, halve.
                let share = room.at / (room.at - below);
                high - (high - low) * (share * share).clamp(FINE, 0.5)
            };
            if high - next <= FINE * piece.most {
                return next.max(low);
            }
            let found = self.room(piece, target, next);
            if found.at < NO_ROOM {
                (high, room) = (next, found);
            } else if newton {
                return next;
            } else {
                (low, below) = (next, found.at.max(0.0));
            }
        }
        low
    }
}
