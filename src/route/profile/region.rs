//! The feasible region of a path: all pairs of place and speed that a legal profile can pass.
//!
//! It lies below the fastest profile. Where the start or end speed is not 0 it also has a lower boundary: full braking
//! from the start, and full acceleration up to the end. With s = x / length and ds/dt = v / length it is the region in
//! the (s, ds/dt) plane of Li, Li, Ge 2019.

use super::optimum::Optimum;
use super::ramp::lost;
use super::stretch::{Infeasible, Limits, Span, Stretch, spans};

/// The feasible region of a path.
#[derive(Clone, Debug)]
pub struct Region {
    optimum: Optimum,
    along: f64,
    /// Each span with the least u at its start after full braking from the start of the path, and the least u at its end
    /// from which full acceleration reaches the end speed, m^2/s^2.
    spans: Vec<(Span, f64, f64)>,
}

/// The feasible region of a path that begins with `start_speed` and ends with `end_speed`, m/s.
///
/// # Errors
///
/// Those of `optimal`.
pub fn region(
    stretches: &[Stretch],
    limits: Limits,
    start_speed: f64,
    end_speed: f64,
) -> Result<Region, Infeasible> {
    let spans = spans(stretches, limits)?;
    let (optimum, along) = (Optimum::over(&spans, limits, start_speed, end_speed)?, limits.along);
    let (mut before, mut after) = (start_speed * start_speed, end_speed * end_speed);
    let mut spans: Vec<_> = spans.into_iter().map(|span| (span, 0.0, 0.0)).collect();
    for (span, least, _) in &mut spans {
        *least = before;
        before = lost(before, span.length(), along, span.bend);
    }
    for (span, _, least) in spans.iter_mut().rev() {
        *least = after;
        after = lost(after, span.length(), along, span.bend);
    }
    Ok(Region { optimum, along, spans })
}

impl Region {
    /// The fastest profile, the upper boundary.
    pub fn optimum(&self) -> &Optimum {
        &self.optimum
    }

    /// Largest speed at x from which the end can be met and that the start can reach, m/s.
    pub fn highest(&self, x: f64) -> f64 {
        self.optimum.speed_at(x)
    }

    /// Least speed at x from which the end can be met and that the start can reach, m/s.
    pub fn lowest(&self, x: f64) -> f64 {
        self.span_at(x).map_or(0.0, |(span, before, after)| {
            let x = x.max(span.start).min(span.end);
            let braked = lost(*before, x - span.start, self.along, span.bend);
            let needed = lost(*after, span.end - x, self.along, span.bend);
            braked.max(needed).sqrt()
        })
    }

    /// Largest speed that the limits allow at x whatever the ends are, m/s: the limit curve. It is constant on a stretch; at
    /// a joint it is that of the stretch behind.
    pub fn limit(&self, x: f64) -> f64 {
        self.span_at(x).map_or(0.0, |(span, ..)| span.cap.sqrt())
    }

    /// The span in which x lies.
    fn span_at(&self, x: f64) -> Option<&(Span, f64, f64)> {
        let after = self.spans.partition_point(|(span, ..)| span.end <= x);
        self.spans.get(after).or(self.spans.last())
    }
}
