//! Watches who crosses lines and who is in regions, from one state to the next.
//!
//! A line is crossed as in `PedPy` (`compute_n_t`): the way of a step meets it and does not end on it; a step that begins on
//! the line and leaves it crosses it. What is nearer to a line than 10 µm is on it, here at both ends of a step.

use super::code::ground::Ground;
use super::code::lanes::{Vector, narrow};
use super::state::{Passages, Slot, State};
use crate::base::geometry::{Segment, Vec2, cross};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::model::{LineId, Periods, RegionId, Scene};
use fearless_simd::{Level, Simd, dispatch, prelude::*};

/// What is nearer to a line than this is on it, m.
const ON_LINE: f64 = 1e-5;

/// The lines and regions of a scene that formulas ask about.
#[derive(Clone, Debug, Default)]
pub struct Passing {
    lines: Vec<(LineId, Segment)>,
    periods: Periods,
    /// How far images are.
    ways: Vec<Vec2>,
    regions: Vec<(RegionId, Ground)>,
}

impl Passing {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        let lines = scene.counted.iter().map(|id| (*id, scene.lines[id.0 as usize].segment));
        let regions = scene.timed.iter().map(|id| (*id, Ground::region(&scene.regions[id.0 as usize].shape)));
        let (periods, ways) = (scene.periods, scene.periods.images());
        Self { lines: lines.collect(), periods, ways, regions: regions.collect() }
    }

    /// Whether no formula asks about any.
    pub const fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.regions.is_empty()
    }

    /// After a step of the slots `moved`, which began it at `x` and `y`.
    pub(super) fn step(&self, level: Level, state: &mut State, (x, y): (&[Lanes], &[Lanes]), moved: &[Mask]) {
        for (line, segment) in &self.lines {
            cross_line(state, (*line, segment), (&self.periods, &self.ways), (x, y), moved);
        }
        if !self.regions.is_empty() {
            dispatch!(level, simd => self.stay(simd, &mut state.passages, (x, y), moved));
        }
    }

    #[inline(always)]
    fn stay<S: Simd>(&self, simd: S, passages: &mut Passages, (x, y): (&[Lanes], &[Lanes]), moved: &[Mask]) {
        for (region, ground) in &self.regions {
            for block in 0..moved.len() {
                let at = |field: &[Lanes]| Vector::from_slice(simd, &field[block].0[..LANES]);
                let inside = narrow(ground.contains(at(x), at(y)));
                passages.stay(*region, block, moved[block] & inside);
            }
        }
    }
}

/// Notes who crosses a line in a step.
fn cross_line(
    state: &mut State,
    (line, segment): (LineId, &Segment),
    (periods, ways): (&Periods, &[Vec2]),
    (x, y): (&[Lanes], &[Lanes]),
    moved: &[Mask],
) {
    let along = segment.b - segment.a;
    let margin = 2.0 * ON_LINE * along.norm();
    for (block, &moved) in moved.iter().enumerate() {
        for lane in (moved & state.passages.not_across(line, block)).iter() {
            let from = Vec2::new(x[block].0[lane], y[block].0[lane]);
            let motion = &state.motion;
            let to = Vec2::new(motion.x[block].0[lane], motion.y[block].0[lane]);
            let is_crossed = if ways.len() > 1 {
                // The end of a step may be an image of where it led.
                let end = from + periods.way(to - from);
                ways.iter().any(|way| is_crossed(segment, from + way, end + way))
            } else {
                // Most stay on one side.
                let (side, end) = (cross(along, from - segment.a), cross(along, to - segment.a));
                let is_aside = side.min(end) > margin || side.max(end) < -margin;
                !is_aside && is_crossed(segment, from, to)
            };
            if is_crossed {
                let trial = state.layout.trial_of(lane);
                let now = (trial, state.ticks[trial]);
                state.passages.cross(line, Slot { block, lane }, now);
            }
        }
    }
}

/// Whether a step crosses a line.
pub fn is_crossed(line: &Segment, from: Vec2, to: Vec2) -> bool {
    let meets = line.distance(from) < ON_LINE || line.meets(&Segment::new(from, to));
    meets && line.distance(to) >= ON_LINE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_crosses_a_line_that_it_meets_and_leaves() {
        let line = Segment::new(Vec2::new(1.0, 0.0), Vec2::new(1.0, 2.0));
        let is_crossed = |from: (f64, f64), to: (f64, f64)| {
            is_crossed(&line, Vec2::new(from.0, from.1), Vec2::new(to.0, to.1))
        };
        assert!(is_crossed((0.9, 1.0), (1.1, 1.0)));
        assert!(is_crossed((1.1, 1.0), (0.9, 1.0)));
        assert!(!is_crossed((0.8, 1.0), (0.9, 1.0)));
        assert!(!is_crossed((0.9, 2.1), (1.1, 2.1)));
        // One that ends on it does not cross it; one that begins there does, back to where it came from, too.
        assert!(!is_crossed((0.9, 1.0), (1.0, 1.0)));
        assert!(is_crossed((1.0, 1.0), (1.1, 1.0)));
        assert!(is_crossed((1.0, 1.0), (0.9, 1.0)));
        // Through an end, and along the line.
        assert!(is_crossed((0.9, 1.9), (1.1, 2.1)));
        assert!(!is_crossed((1.0, 2.2), (1.0, 2.1)));
        assert!(is_crossed((1.0, -0.1), (1.0, 2.1)));
    }

    #[test]
    fn a_step_that_ends_a_hair_behind_a_line_crosses_it_with_the_next() {
        let line = Segment::new(Vec2::new(1.0, 0.0), Vec2::new(1.0, 2.0));
        let at = |x: f64| Vec2::new(x, 1.0);
        assert!(!is_crossed(&line, at(0.99), at(1.000_005)));
        assert!(is_crossed(&line, at(1.000_005), at(1.01)));
    }
}
