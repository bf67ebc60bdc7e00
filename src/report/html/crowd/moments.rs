//! A trace second by second: who was where, on how much room, and how fast the people were on average.
//!
//! The room of somebody is the Voronoi cell of the language's `voronoi_density`: at most 1 m around, cut at barriers. The
//! speed is that of the straight way of the next second, of those who are present at both of its ends.

use crate::base::geometry::Vec2;
use crate::engine::traces::{Motion, Track};
use crate::kernel::Voronoi;

/// The cells of so many people are made for a page.
const MOST_CELLS: usize = 100_000;
/// Time between two moments, s.
const SECOND: f64 = 1.0;

/// Some instant of a trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moment {
    /// Places, m, and areas of cells, m².
    pub(super) people: Vec<(Vec2, f64)>,
    /// The time to the next moment, s.
    pub(super) seconds: f64,
    /// Mean speed, m/s; none where nobody is there a second later.
    pub(super) speed: Option<f64>,
}

/// A place of a track at a frame, m.
pub(super) fn place(track: &Track, frame: usize) -> Option<Vec2> {
    let [x, y] = track.points.get(frame.checked_sub(track.first)?)?;
    Some(Vec2::new(f64::from(*x), f64::from(*y)) / 1000.0)
}

/// Frames of a second.
fn frames(motion: &Motion) -> usize {
    (SECOND / motion.spacing).round().max(1.0) as usize
}

/// The moments of some motions in the scene of some cells. Where there are too many people, moments lie farther apart.
pub(super) fn moments<'m>(
    voronoi: &Voronoi,
    motions: impl Iterator<Item = &'m Motion> + Clone,
) -> Vec<Moment> {
    let cells = motions.clone().map(|motion| motion.numbers() / 2 / frames(motion)).sum::<usize>();
    let every = cells.div_ceil(MOST_CELLS).max(1);
    let all = motions.flat_map(|motion| {
        let second = frames(motion);
        let seconds = (second * every) as f64 * motion.spacing;
        let moment = move |frame| Moment { seconds, ..moment(voronoi, motion, frame, second) };
        (0..motion.frames).step_by(second * every).map(moment)
    });
    all.filter(|moment| !moment.people.is_empty()).collect()
}

fn moment(voronoi: &Voronoi, motion: &Motion, frame: usize, second: usize) -> Moment {
    let places: Vec<Vec2> = motion.tracks.iter().filter_map(|track| place(track, frame)).collect();
    let ways = motion.tracks.iter().filter_map(|track| {
        let (from, to) = (place(track, frame)?, place(track, frame + second)?);
        Some((to - from).norm() / (second as f64 * motion.spacing))
    });
    let (sum, count) = ways.fold((0.0, 0_u32), |(sum, count), speed| (sum + speed, count + 1));
    let areas = voronoi.areas(&places);
    Moment {
        people: places.into_iter().zip(areas).collect(),
        seconds: 0.0,
        speed: (count > 0).then(|| sum / f64::from(count)),
    }
}
