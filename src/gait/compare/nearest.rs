//! Distances to the nearest of many points: a k-d tree (Bentley 1975) in an array, which no crowding of points makes slow.

use crate::base::geometry::Vec2;

/// Up to so many points are looked at one by one.
const LEAF: usize = 8;

/// Points in the order of their tree: the middle of a range divides it along the axis in which it is wider.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    points: Vec<Vec2>,
    /// The axis along which a point divides its range.
    axes: Vec<u8>,
}

impl Tree {
    /// Of points with finite coordinates, some of which may be equal.
    pub(super) fn new(mut points: Vec<Vec2>) -> Self {
        // Walks that are copies of each other would otherwise fill leaves with one point.
        points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        points.dedup();
        let mut axes = vec![0; points.len()];
        divide(&mut points, &mut axes);
        Self { points, axes }
    }

    /// Distance from a place to the nearest point, m; infinite if there is none.
    pub(super) fn distance(&self, from: Vec2) -> f64 {
        let mut nearest = f64::INFINITY;
        search(&self.points, &self.axes, from, &mut nearest);
        nearest.sqrt()
    }
}

fn divide(points: &mut [Vec2], axes: &mut [u8]) {
    if points.len() <= LEAF {
        return;
    }
    let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), p| (low.inf(p), high.sup(p)));
    let axis = usize::from(high.y - low.y > high.x - low.x);
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a[axis].total_cmp(&b[axis]));
    axes[middle] = axis as u8;
    let ((left, right), (left_axes, right_axes)) = (points.split_at_mut(middle), axes.split_at_mut(middle));
    divide(left, left_axes);
    divide(&mut right[1..], &mut right_axes[1..]);
}

/// Lowers the square of a distance to that of the nearest point, if one is nearer.
fn search(points: &[Vec2], axes: &[u8], from: Vec2, nearest: &mut f64) {
    if points.len() <= LEAF {
        for p in points {
            *nearest = nearest.min((p - from).norm_squared());
        }
        return;
    }
    let middle = points.len() / 2;
    let axis = usize::from(axes[middle]);
    let beyond = from[axis] - points[middle][axis];
    let left = (&points[..middle], &axes[..middle]);
    let right = (&points[middle + 1..], &axes[middle + 1..]);
    let (near, far) = if beyond < 0.0 { (left, right) } else { (right, left) };
    *nearest = nearest.min((points[middle] - from).norm_squared());
    search(near.0, near.1, from, nearest);
    if beyond * beyond < *nearest {
        search(far.0, far.1, from, nearest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    #[test]
    fn distances_are_those_of_a_look_at_every_point() {
        let stream = |entity| Stream::of(TrialKey { seed: 1, index: 0, branch: 0 }, entity, Purpose::Test);
        let scattered = |entity: u32, count: u32| -> Vec<Vec2> {
            (0..count).map(|k| stream(entity).uniform_pair(k)).map(|[x, y]| Vec2::new(3.0 * x, y)).collect()
        };
        let line = |count: u32| (0..count).map(|k| Vec2::new(f64::from(k % 50) * 0.1, 0.25)).collect();
        let mut outlier = scattered(2, 400);
        outlier.push(Vec2::new(-1e6, 1e6));
        for points in [scattered(3, 5), scattered(4, 1000), line(3000), vec![Vec2::zeros(); 100], outlier] {
            let tree = Tree::new(points.clone());
            for from in scattered(9, 200) {
                let least = points.iter().map(|p| (p - from).norm()).fold(f64::INFINITY, f64::min);
                assert_eq!(tree.distance(from), least);
            }
        }
        assert_eq!(Tree::new(Vec::new()).distance(Vec2::zeros()), f64::INFINITY);
    }
}
