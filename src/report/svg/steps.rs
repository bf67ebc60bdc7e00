//! The root paths of steps in their own frames (Agethen et al. 2018, Figure 3): each begins at the origin along +x.

use super::picture::Picture;
use super::{Drawing, Ink};
use crate::base::geometry::{Bounds, Vec2};
use crate::gait::{Foot, RecordedStep};

/// Pieces of a drawn path.
const PIECES: u32 = 12;

/// The picture, with the mean path of each foot.
pub fn draw(steps: &[RecordedStep]) -> Picture {
    let path = |step: &RecordedStep| -> Vec<Vec2> {
        let curve = step.shape.curve();
        (0..=PIECES).map(|k| curve.place(f64::from(k) / f64::from(PIECES))).collect()
    };
    let paths: Vec<(Foot, Vec<Vec2>)> = steps.iter().map(|step| (step.foot, path(step))).collect();
    let all = paths.iter().flat_map(|(_, path)| path.iter().copied()).chain([Vec2::zeros()]);
    let mut drawing = Drawing::new(Bounds::around(all).unwrap_or_default());
    for (foot, path) in &paths {
        drawing.line(path, if *foot == Foot::Left { Ink::LEFT_STEP } else { Ink::RIGHT_STEP });
    }
    for (foot, name) in [(Foot::Left, "left"), (Foot::Right, "right")] {
        let own: Vec<&Vec<Vec2>> = paths.iter().filter(|(of, _)| *of == foot).map(|(_, path)| path).collect();
        let mean = |k: usize| own.iter().map(|path| path[k]).sum::<Vec2>() / own.len() as f64;
        if !own.is_empty() {
            let path: Vec<Vec2> = (0..=PIECES as usize).map(mean).collect();
            drawing.line(&path, Ink::WAY);
            drawing.text(path[PIECES as usize], &format!("{name} ({})", own.len()));
        }
    }
    drawing.name(Ink::LEFT_STEP, "left foot");
    drawing.name(Ink::RIGHT_STEP, "right foot");
    drawing.name(Ink::WAY, "means");
    Picture::plan("root paths of steps", drawing)
}
