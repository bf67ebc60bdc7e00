//! A way through the plane over time: cubic pieces, so that position, velocity and acceleration are known at every time.

use crate::base::geometry::Vec2;

/// A point of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time since the plan began, s.
    pub time: f64,
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s.
    pub velocity: Vec2,
}

/// A cubic polynomial of the time since its piece began, in both coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kernel) struct Piece {
    /// When it begins and ends, s since the plan began.
    pub(in crate::kernel) span: (f64, f64),
    pub(in crate::kernel) x: [f64; 4],
    pub(in crate::kernel) y: [f64; 4],
}

/// Position over time, from time 0 of a plan to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    pieces: Vec<Piece>,
}

impl Trajectory {
    /// Through samples whose times rise from 0: between two of them the cubic polynomial with their positions and
    /// velocities (Hermite interpolation). `None` with fewer than two samples, other times, or numbers that are not finite.
    pub fn through(samples: &[Sample]) -> Option<Self> {
        let finite = |s: &Sample| {
            [s.time, s.position.x, s.position.y, s.velocity.x, s.velocity.y].iter().all(|v| v.is_finite())
        };
        let rises = samples.windows(2).all(|pair| pair[0].time < pair[1].time);
        if samples.len() < 2 || samples[0].time != 0.0 || !rises || !samples.iter().all(finite) {
            return None;
        }
        let piece = |pair: &[Sample]| {
            let (a, b) = (&pair[0], &pair[1]);
            let t = b.time - a.time;
            let cubic = |p: f64, v: f64, q: f64, w: f64| {
                let rise = (q - p) / t;
                [p, v, (3.0 * rise - 2.0 * v - w) / t, (v + w - 2.0 * rise) / (t * t)]
            };
            Piece {
                span: (a.time, b.time),
                x: cubic(a.position.x, a.velocity.x, b.position.x, b.velocity.x),
                y: cubic(a.position.y, a.velocity.y, b.position.y, b.velocity.y),
            }
        };
        Some(Self { pieces: samples.windows(2).map(piece).collect() })
    }

    /// Its duration, s.
    pub fn duration(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.span.1)
    }

    /// Position, velocity and acceleration at a time, s; before the beginning and after the end it rests there.
    pub fn at(&self, time: f64) -> [Vec2; 3] {
        let piece = self.piece(time);
        let t = time - piece.span.0;
        let order = |[a, b, c, d]: [f64; 4]| {
            [a + t * (b + t * (c + t * d)), b + t * (2.0 * c + t * (3.0 * d)), 2.0 * c + 6.0 * d * t]
        };
        let (x, y) = (order(piece.x), order(piece.y));
        [Vec2::new(x[0], y[0]), Vec2::new(x[1], y[1]), Vec2::new(x[2], y[2])]
    }

    /// The piece of a time: after the end, and before the beginning, one that rests.
    pub(in crate::kernel) fn piece(&self, time: f64) -> Piece {
        let at = self.pieces.partition_point(|piece| piece.span.1 < time);
        match (self.pieces.get(at), self.pieces.last()) {
            (Some(piece), _) => *piece,
            (None, Some(last)) => {
                let t = last.span.1 - last.span.0;
                let end = |[a, b, c, d]: [f64; 4]| [a + t * (b + t * (c + t * d)), 0.0, 0.0, 0.0];
                Piece { span: (last.span.1, f64::INFINITY), x: end(last.x), y: end(last.y) }
            }
            (None, None) => Piece { span: (0.0, f64::INFINITY), x: [0.0; 4], y: [0.0; 4] },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(time: f64, x: f64, v: f64) -> Sample {
        Sample { time, position: Vec2::new(x, 1.0), velocity: Vec2::new(v, 0.0) }
    }

    #[test]
    fn a_cubic_motion_is_met_exactly_and_rests_after_its_end() {
        // x = t^3 - t^2 + 2 t
        let x = |t: f64| sample(t, t * t * t - t * t + 2.0 * t, 3.0 * t * t - 2.0 * t + 2.0);
        let found = Trajectory::through(&[x(0.0), x(0.7), x(2.0)]).unwrap();
        for t in [0.0, 0.3, 0.7, 1.1, 2.0] {
            let [p, v, a] = found.at(t);
            assert!((p - x(t).position).norm() < 1e-12 && (v - x(t).velocity).norm() < 1e-12, "{t}");
            assert!((a.x - (6.0 * t - 2.0)).abs() < 1e-11, "{t}");
        }
        assert_eq!(found.at(9.0)[1..], [Vec2::zeros(), Vec2::zeros()]);
        assert!((found.at(9.0)[0] - x(2.0).position).norm() < 1e-12);
        assert_eq!(found.duration(), 2.0);
    }

    #[test]
    fn times_rise_from_0() {
        let refused: [&[Sample]; 4] = [
            &[],
            &[sample(0.0, 0.0, 0.0)],
            &[sample(0.5, 0.0, 0.0), sample(1.0, 0.0, 0.0)],
            &[sample(0.0, 0.0, 0.0), sample(0.0, 1.0, 0.0)],
        ];
        assert!(refused.iter().all(|samples| Trajectory::through(samples).is_none()));
    }
}
