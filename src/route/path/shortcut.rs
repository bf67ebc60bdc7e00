//! Polylines without needless vertices.

use crate::base::geometry::Vec2;

/// Most passes over a polyline.
const MOST_PASSES: usize = 8;

/// Drops inner vertices of a polyline, m, where the line past them is free and the cost of the polyline falls.
///
/// A pass looks at the vertices in order; it drops the first one that helps and goes on with the next. Passes end
/// when one drops nothing, after eight at the latest. A cost of NaN counts as no improvement.
pub fn shortcut(
    points: &[Vec2],
    is_free: impl Fn(Vec2, Vec2) -> bool,
    mut cost: impl FnMut(&[Vec2]) -> f64,
) -> Vec<Vec2> {
    let mut kept = points.to_vec();
    let mut least = cost(&kept);
    for _ in 0..MOST_PASSES {
        let before = kept.len();
        let mut k = 1;
        while let Some(&[a, dropped, b]) = kept.get(k - 1..=k + 1) {
            if is_free(a, b) {
                kept.remove(k);
                let now = cost(&kept);
                if now < least {
                    least = now;
                    continue;
                }
                kept.insert(k, dropped);
            }
            k += 1;
        }
        if kept.len() == before {
            break;
        }
    }
    kept
}
