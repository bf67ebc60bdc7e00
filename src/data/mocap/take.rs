//! A take: one recording of one person who walks.

use super::layout::{Layout, Up};
use crate::base::geometry::{Vec2, coordinate_fault};
use crate::data::tracks::LineError;

/// A foot over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FootTrack {
    /// The ankle in each frame: x and y on the floor plane and the height, m.
    pub ankle: Vec<[f64; 3]>,
    /// The toe, or the ball of the foot, in each frame, m.
    pub toe: Vec<[f64; 3]>,
}

/// One recording. All tracks have one entry per frame, and there are at least two frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// Its name.
    pub name: String,
    /// The person who was recorded; empty if unknown.
    pub subject: String,
    /// Frames per second.
    pub fps: f64,
    /// The root (the center of the hip) on the floor plane in each frame, m. A left turn seen from above is positive.
    pub root: Vec<Vec2>,
    /// The height of the root in each frame, m.
    pub hip: Vec<f64>,
    /// The left and the right foot.
    pub feet: [FootTrack; 2],
}

impl Take {
    /// The time from the first frame to the last one, s.
    pub fn duration(&self) -> f64 {
        self.root.len().saturating_sub(1) as f64 / self.fps
    }
}

/// The error of a file without a frame rate.
pub const NO_RATE: &str = "the file has no frame rate";

/// The root, left ankle, left toe, right ankle and right toe in one frame, in the axes and units of a file.
pub(super) type Places = [[f64; 3]; 5];

/// What a file says about one take.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    /// Frames per second, if the file has them.
    pub(super) fps: Option<f64>,
    /// The line of each frame, and its places.
    pub(super) places: Vec<(usize, Places)>,
}

impl Frames {
    /// The take in metres. `stated` is a frame rate that holds for this take, and overrides that of the layout.
    pub(super) fn take(
        &self,
        name: &str,
        subject: &str,
        stated: Option<f64>,
        layout: &Layout,
    ) -> Result<Take, LineError> {
        let fps = self.rate(stated.or(layout.fps))?;
        let mut take = Take {
            name: name.to_owned(),
            subject: subject.to_owned(),
            fps,
            root: Vec::new(),
            hip: Vec::new(),
            feet: Default::default(),
        };
        for (line, places) in self.places.iter().skip(layout.skip) {
            let places = places.map(|p| {
                let [x, y, z] = p.map(|coordinate| coordinate * layout.unit);
                // With y up, (x, -z) has the usual sense of angles seen from above.
                if layout.up == Up::Y { [x, -z, y] } else { [x, y, z] }
            });
            let far = places.iter().find_map(|p| {
                coordinate_fault(Vec2::new(p[0], p[1])).or_else(|| coordinate_fault(Vec2::new(p[2], 0.0)))
            });
            if let Some(fault) = far {
                return Err(LineError::whole(*line, fault));
            }
            let [root, rest @ ..] = places;
            take.root.push(Vec2::new(root[0], root[1]));
            take.hip.push(root[2]);
            for (foot, track) in take.feet.iter_mut().enumerate() {
                track.ankle.push(rest[2 * foot]);
                track.toe.push(rest[2 * foot + 1]);
            }
        }
        if take.root.len() < 2 {
            let (count, skip) = (self.places.len(), layout.skip);
            let message =
                format!("a take needs at least 2 frames (got {count}, of which {skip} are skipped)");
            return Err(LineError::of_file(message));
        }
        Ok(take)
    }

    fn rate(&self, stated: Option<f64>) -> Result<f64, LineError> {
        let message = match (stated, self.fps) {
            (Some(stated), Some(own)) if (stated / own - 1.0).abs() > 0.01 => {
                format!("the file has {own:.2} frames per second, but {stated} are stated")
            }
            (Some(fps), _) | (None, Some(fps)) if (1.0..=10_000.0).contains(&fps) => return Ok(fps),
            (Some(fps), _) | (None, Some(fps)) => {
                format!("the frame rate must lie between 1 and 10000 per second (got {fps})")
            }
            (None, None) => NO_RATE.to_owned(),
        };
        Err(LineError::of_file(message))
    }
}
