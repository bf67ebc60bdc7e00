//! Groups of people who move alike (Given-Wilson, Legay, Sedwards, Zendra 2017, Algorithm 3): the least number of
//! clusters by k-means whose members are all near their centroid.
//!
//! The space is (x/2, y/2, vx · 1 s, vy · 1 s). For each k, the best of ten starts counts: first centroids by k-means++
//! (Arthur and Vassilvitskii 2007), then Lloyd's iterations. Points that lie pairwise farther than twice the threshold
//! apart need clusters of their own, so k begins at their number. People whom no chain of such near points connects are
//! looked at apart.

use super::near;
use crate::base::geometry::Vec2;
use crate::base::random::{Purpose, Stream, TrialKey};

/// Starts for each number of clusters.
const STARTS: u32 = 10;
/// Points of a block of partial sums.
const BLOCK: usize = 16;
/// Most people who are looked at together.
const MOST_TOGETHER: usize = 128;
/// Most iterations of a start. Lloyd's method ends by itself, usually after a few.
const ITERATIONS: usize = 100;

/// Options of the clustering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clustering {
    /// Largest distance of a member from the centroid of its cluster, m.
    pub threshold: f64,
    /// Divides positions.
    pub position_discount: f64,
    /// Divides velocities.
    pub velocity_discount: f64,
}

impl Default for Clustering {
    fn default() -> Self {
        Self { threshold: 0.5, position_discount: 2.0, velocity_discount: 1.0 }
    }
}

/// The numbers of an instant for the address of its draws: its time in milliseconds.
pub fn instant_of(time: f64) -> u32 {
    // The entity of a stream has 24 bits; the draws repeat after 4.6 hours.
    ((time * 1000.0).round() as i64 & 0x00ff_ffff) as u32
}

/// The clusters of people at positions, m, with velocities, m/s; one without a velocity stands. Each cluster has its
/// members ascending, and clusters are in the order of their first members. People of whom time leaves none to look at
/// are alone.
pub fn clusters(
    people: &[(Vec2, Option<Vec2>)],
    options: &Clustering,
    key: TrialKey,
    instant: u32,
    is_over: &dyn Fn() -> bool,
) -> Vec<Vec<usize>> {
    let points = Points::of(people, options);
    let stream = Stream::of(key, instant, Purpose::Group);
    let mut found = Vec::new();
    for piece in points.pieces(options.threshold) {
        if is_over() {
            found.extend(piece.into_iter().map(|i| vec![i]));
            continue;
        }
        let first_draw = |start: u32| start.wrapping_mul(people.len() as u32).wrapping_add(piece[0] as u32);
        let clusters = few_clusters(&points.of_some(&piece), options.threshold, stream, first_draw);
        found.extend(clusters.into_iter().map(|cluster| cluster.into_iter().map(|i| piece[i]).collect()));
    }
    found.sort_by_key(|cluster: &Vec<usize>| cluster[0]);
    found
}

/// The least number of clusters of some points; the number of a start gives its first draw.
fn few_clusters(
    points: &Points,
    threshold: f64,
    stream: Stream,
    first_draw: impl Fn(u32) -> u32,
) -> Vec<Vec<usize>> {
    let n = points.1.len();
    let limit = threshold * threshold;
    let mut starts: Vec<Work> = (0..STARTS).map(|_| Work::new(n)).collect();
    let (mut work, mut best) = (Work::new(n), Work::new(n));
    for k in points.least_clusters(threshold)..n {
        let mut least = f64::INFINITY;
        for (start, seeded) in (0..STARTS).zip(&mut starts) {
            // The first centroids of a start are those that it had for fewer clusters, and one more.
            seeded.seed(points, k, stream, first_draw(start));
            work.clone_from(seeded);
            work.settle(points);
            let sum: f64 = work.nearest.iter().sum();
            if sum < least {
                least = sum;
                std::mem::swap(&mut best, &mut work);
            }
        }
        if best.nearest.iter().all(|d| *d <= limit) {
            return lists(&best.labels);
        }
    }
    (0..n).map(|i| vec![i]).collect()
}

fn lists(labels: &[usize]) -> Vec<Vec<usize>> {
    let mut clusters: Vec<(usize, Vec<usize>)> = Vec::new();
    for (i, label) in labels.iter().enumerate() {
        match clusters.iter_mut().find(|(other, _)| other == label) {
            Some((_, members)) => members.push(i),
            None => clusters.push((*label, vec![i])),
        }
    }
    clusters.into_iter().map(|(_, members)| members).collect()
}

/// Points of the space of groups: coordinate by coordinate, and point by point.
struct Points([Vec<f64>; 4], Vec<[f64; 4]>);

impl Points {
    fn of(people: &[(Vec2, Option<Vec2>)], options: &Clustering) -> Self {
        let place = |f: fn(Vec2) -> f64| people.iter().map(|p| f(p.0) / options.position_discount).collect();
        let speed = |f: fn(Vec2) -> f64| {
            people.iter().map(|p| p.1.map_or(0.0, f) / options.velocity_discount).collect()
        };
        let axes: [Vec<f64>; 4] = [place(|p| p.x), place(|p| p.y), speed(|v| v.x), speed(|v| v.y)];
        let points = (0..people.len()).map(|i| std::array::from_fn(|c| axes[c][i])).collect();
        Self(axes, points)
    }

    fn of_some(&self, members: &[usize]) -> Self {
        let axes = std::array::from_fn(|c| members.iter().map(|i| self.0[c][*i]).collect());
        Self(axes, members.iter().map(|i| self.1[*i]).collect())
    }

    /// Sets of points such that no cluster has members in two of them, each ascending. Those with too many points are cut
    /// in two, so the time grows with the number of people and not with its cube.
    fn pieces(&self, threshold: f64) -> Vec<Vec<usize>> {
        // Both are near the centroid. A little more, because of rounding.
        let reach = 2.0 * threshold * (1.0 + 1e-9);
        let places: Vec<Vec2> = self.1.iter().map(|point| Vec2::new(point[0], point[1])).collect();
        let near = near::pairs(&places, &places, reach).into_iter();
        let linked = near.filter(|(i, j)| self.squared(*i, &self.1[*j]) <= reach * reach);
        let mut open = near::connected(places.len(), linked);
        let mut pieces = Vec::new();
        while let Some(mut piece) = open.pop() {
            if piece.len() <= MOST_TOGETHER {
                piece.sort_unstable();
                pieces.push(piece);
                continue;
            }
            // Cut across the longer side.
            let [(width, along_x), (height, along_y)] = [0, 1].map(|c| {
                let axis = &self.0[c];
                let mut order = piece.clone();
                order.sort_by(|i, j| axis[*i].total_cmp(&axis[*j]));
                (axis[order[order.len() - 1]] - axis[order[0]], order)
            });
            let mut half = if width > height { along_x } else { along_y };
            open.push(half.split_off(half.len() / 2));
            open.push(half);
        }
        pieces
    }

    fn at(&self, i: usize) -> [f64; 4] {
        self.1[i]
    }

    /// Squared distance of a point from a place.
    #[inline(always)]
    fn squared(&self, i: usize, place: &[f64; 4]) -> f64 {
        let p = &self.1[i];
        let d = [p[0] - place[0], p[1] - place[1], p[2] - place[2], p[3] - place[3]];
        (d[0] * d[0] + d[1] * d[1]) + (d[2] * d[2] + d[3] * d[3])
    }

    /// Lowers each squared distance to that from a place where it is nearer, and then sets the label.
    fn approach(&self, place: &[f64; 4], label: usize, nearest: &mut [f64], labels: &mut [usize]) {
        let [x, y, u, v] = &self.0;
        let coordinates = x.iter().zip(y).zip(u.iter().zip(v));
        for (((x, y), (u, v)), (nearest, own)) in coordinates.zip(nearest.iter_mut().zip(labels)) {
            let d = [x - place[0], y - place[1], u - place[2], v - place[3]];
            let found = (d[0] * d[0] + d[1] * d[1]) + (d[2] * d[2] + d[3] * d[3]);
            let is_nearer = found < *nearest;
            *nearest = if is_nearer { found } else { *nearest };
            *own = if is_nearer { label } else { *own };
        }
    }

    /// The size of a set of points farther than twice the threshold apart, at least 1: in the order of how few are near.
    fn least_clusters(&self, threshold: f64) -> usize {
        let n = self.0[0].len();
        // A little more than twice, so that rounding never makes the set too large.
        let limit = 4.0 * threshold * threshold * (1.0 + 1e-9);
        let near: Vec<Vec<usize>> = (0..n)
            .map(|i| {
                let place = self.at(i);
                (0..n).filter(|j| self.squared(*j, &place) <= limit).collect()
            })
            .collect();
        let mut degree: Vec<usize> = near.iter().map(Vec::len).collect();
        let mut is_open = vec![true; n];
        let mut count = 0;
        while let Some(i) = (0..n).filter(|i| is_open[*i]).min_by_key(|i| degree[*i]) {
            count += 1;
            for &j in &near[i] {
                if std::mem::replace(&mut is_open[j], false) {
                    near[j].iter().for_each(|other| degree[*other] -= 1);
                }
            }
        }
        count.max(1)
    }
}

/// Centroids, and for each point the nearest.
#[derive(Clone)]
struct Work {
    centroids: Vec<[f64; 4]>,
    labels: Vec<usize>,
    /// Squared distance of each point from its centroid.
    nearest: Vec<f64>,
    sums: Vec<([f64; 4], f64)>,
    /// Sums of `nearest` over blocks of points.
    blocks: Vec<f64>,
}

impl Work {
    fn new(n: usize) -> Self {
        Self {
            centroids: Vec::new(),
            labels: vec![0; n],
            nearest: vec![f64::INFINITY; n],
            sums: Vec::new(),
            blocks: Vec::new(),
        }
    }

    /// k-means++: each next centroid is a point, drawn in proportion to its squared distance from the nearest one. There
    /// are fewer where all points are centroids. Continues what is there.
    fn seed(&mut self, points: &Points, k: usize, stream: Stream, first_draw: u32) {
        let n = self.labels.len();
        for number in self.centroids.len()..k {
            let uniform = stream.uniform(first_draw.wrapping_add(number as u32));
            let total: f64 = self.blocks.iter().sum();
            let chosen = match number {
                0 => ((uniform * n as f64) as usize).min(n - 1),
                _ if total <= 0.0 => break,
                _ => self.drawn(uniform * total),
            };
            let place = points.at(chosen);
            self.centroids.push(place);
            points.approach(&place, number, &mut self.nearest, &mut self.labels);
            // Sums of blocks are independent, so the processor adds several at a time.
            self.blocks.clear();
            self.blocks.extend(self.nearest.chunks(BLOCK).map(|block| block.iter().sum::<f64>()));
        }
    }

    /// The point at which the sum of squared distances passes `left`; never one that is a centroid.
    fn drawn(&self, mut left: f64) -> usize {
        let mut chosen = 0;
        for (b, sum) in self.blocks.iter().enumerate().filter(|(_, sum)| **sum > 0.0) {
            let is_last = left <= *sum;
            if is_last || self.blocks[b + 1..].iter().all(|sum| *sum <= 0.0) {
                let block = self.nearest.iter().enumerate().skip(b * BLOCK).take(BLOCK);
                for (i, weight) in block.filter(|(_, weight)| **weight > 0.0) {
                    chosen = i;
                    left -= weight;
                    if left <= 0.0 {
                        break;
                    }
                }
                return chosen;
            }
            left -= sum;
        }
        chosen
    }

    /// Lloyd's iterations until no label changes. An empty cluster keeps its centroid.
    fn settle(&mut self, points: &Points) {
        let n = self.labels.len();
        let mut moved: Vec<usize> = Vec::with_capacity(self.centroids.len());
        let mut has_moved = vec![false; self.centroids.len()];
        for _ in 0..ITERATIONS {
            self.sums.clear();
            self.sums.resize(self.centroids.len(), ([0.0; 4], 0.0));
            for i in 0..n {
                let (sum, count) = &mut self.sums[self.labels[i]];
                let point = points.at(i);
                (0..4).for_each(|c| sum[c] += point[c]);
                *count += 1.0;
            }
            moved.clear();
            for (k, (sum, count)) in self.sums.iter().enumerate() {
                let mean = if *count > 0.0 { sum.map(|s| s / count) } else { self.centroids[k] };
                has_moved[k] = mean != self.centroids[k];
                if has_moved[k] {
                    self.centroids[k] = mean;
                    moved.push(k);
                }
            }
            let mut is_settled = true;
            for i in 0..n {
                let own = self.labels[i];
                let before = self.nearest[i];
                let mut best = (points.squared(i, &self.centroids[own]), own);
                // Centroids that stay are no nearer than before, so they matter only if the own one has gone away.
                let all = has_moved[own] && best.0 > before;
                let mut compare = |k: usize| {
                    let found = points.squared(i, &self.centroids[k]);
                    if found < best.0 || (found == best.0 && k < best.1) {
                        best = (found, k);
                    }
                };
                if all {
                    (0..self.centroids.len()).for_each(&mut compare);
                } else {
                    moved.iter().copied().for_each(&mut compare);
                }
                is_settled &= best.1 == own;
                self.nearest[i] = best.0;
                self.labels[i] = best.1;
            }
            if is_settled {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn person(x: f64, y: f64, vx: f64, vy: f64) -> (Vec2, Option<Vec2>) {
        (Vec2::new(x, y), Some(Vec2::new(vx, vy)))
    }

    fn found(people: &[(Vec2, Option<Vec2>)]) -> Vec<Vec<usize>> {
        clusters(people, &Clustering::default(), TrialKey::default(), 0, &|| false)
    }

    #[test]
    fn people_who_move_alike_are_a_group() {
        let people = [
            person(0.0, 0.0, 1.0, 0.0),
            person(0.2, 0.1, -1.0, 0.0),
            person(0.0, 0.8, 1.1, 0.0),
            (Vec2::new(0.3, 0.3), None),
        ];
        assert_eq!(found(&people), [vec![0, 2], vec![1], vec![3]]);
        assert!(found(&[]).is_empty());
        assert_eq!(found(&people[..1]), [[0]]);
        assert_eq!(found(&[person(1.0, 1.0, 0.0, 0.0); 5]), [[0, 1, 2, 3, 4]]);
    }

    /// The least number of clusters over all partitions of few points.
    fn least(people: &[(Vec2, Option<Vec2>)], threshold: f64) -> usize {
        fn cohesive(points: &Points, members: &[usize], threshold: f64) -> bool {
            let mut mean = [0.0; 4];
            for i in members {
                (0..4).for_each(|c| mean[c] += points.at(*i)[c] / members.len() as f64);
            }
            members.iter().all(|i| points.squared(*i, &mean) <= threshold * threshold)
        }
        fn place(points: &Points, i: usize, parts: &mut Vec<Vec<usize>>, threshold: f64, best: &mut usize) {
            if i == points.0[0].len() {
                if parts.iter().all(|part| cohesive(points, part, threshold)) {
                    *best = (*best).min(parts.len());
                }
                return;
            }
            for k in 0..=parts.len() {
                if k == parts.len() {
                    parts.push(vec![i]);
                } else {
                    parts[k].push(i);
                }
                place(points, i + 1, parts, threshold, best);
                parts[k].pop();
                if parts[k].is_empty() {
                    parts.remove(k);
                }
            }
        }
        let points = Points::of(people, &Clustering { threshold, ..Clustering::default() });
        let mut best = people.len();
        place(&points, 0, &mut Vec::new(), threshold, &mut best);
        assert!(points.least_clusters(threshold) <= best, "k would begin too high");
        best
    }

    #[test]
    fn clusters_are_cohesive_and_nearly_as_few_as_possible() {
        let stream = Stream::of(TrialKey::default(), 0, Purpose::Test);
        let (mut few, mut made) = (0, 0);
        for case in 0..60 {
            let people: Vec<_> = (0..7)
                .map(|i| {
                    let [x, y] = stream.uniform_pair(case * 20 + 2 * i);
                    let [u, v] = stream.uniform_pair(case * 20 + 2 * i + 1);
                    person(4.0 * x, 4.0 * y, u, v)
                })
                .collect();
            let groups = found(&people);
            let mut all: Vec<usize> = groups.concat();
            all.sort_unstable();
            assert_eq!(all, (0..7).collect::<Vec<_>>());
            for group in &groups {
                let mean = |f: &dyn Fn(usize) -> Vec2| {
                    group.iter().map(|i| f(*i)).sum::<Vec2>() / group.len() as f64
                };
                let (p, v) = (mean(&|i| people[i].0), mean(&|i| people[i].1.unwrap()));
                for &i in group {
                    let d =
                        (people[i].0 - p).norm_squared() / 4.0 + (people[i].1.unwrap() - v).norm_squared();
                    assert!(d.sqrt() <= 0.5 + 1e-12);
                }
            }
            few += least(&people, 0.5);
            made += groups.len();
        }
        assert!(made as f64 <= 1.1 * few as f64, "{made} clusters where {few} serve");
    }

    /// The cost of a crowd is that of its pieces, whose size is bounded.
    #[test]
    fn a_larger_crowd_has_more_pieces_and_not_larger_ones() {
        for (apart, most) in [(0.4, MOST_TOGETHER), (4.1, 1)] {
            let crowd: Vec<_> = (0..2500_u32)
                .map(|i| person(apart * f64::from(i % 50), apart * f64::from(i / 50), 1.0, 0.0))
                .collect();
            let points = Points::of(&crowd, &Clustering::default());
            let pieces = points.pieces(0.5);
            assert_eq!(pieces.iter().map(Vec::len).sum::<usize>(), 2500);
            let largest = pieces.iter().map(Vec::len).max().unwrap();
            assert!(largest <= most, "{largest}");
        }
        let late = clusters(
            &[person(0.0, 0.0, 1.0, 0.0); 5],
            &Clustering::default(),
            TrialKey::default(),
            0,
            &|| true,
        );
        assert_eq!(late.len(), 5);
        let twice = found(&vec![person(0.0, 0.0, 1.0, 0.0); 600]);
        assert_eq!(twice.iter().map(Vec::len).sum::<usize>(), 600);
    }
}
