//! Walls that nearly meet: gaps are closed and lines that are drawn twice are merged.
//!
//! A wall is a list of pieces. Nothing is moved by more than the tolerance at a time, edges of obstacles stay where they
//! are, and what is done depends on the geometry alone, not on the order of the file.

use crate::base::geometry::{Segment, Vec2, sweep};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Ends nearer than this count as joined, m; so they do for the forces of walls.
const JOINED: f64 = 1e-3;
/// What is left between an end and the piece that it was moved onto, m.
const ROUNDING: f64 = 1e-9;
/// Most pairs of pieces that are looked at.
const MOST_PAIRS: usize = 2_000_000;
/// How often ends are moved onto pieces, which may move themselves.
const ROUNDS: usize = 4;

/// A piece of a wall, and the number of that wall.
type Piece = (usize, Segment);

/// Where walls nearly meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slips {
    /// Loose ends of walls that miss another wall or an obstacle.
    pub ends: usize,
    /// Pieces of walls that lie beside a piece of another wall or an edge of an obstacle.
    pub doubled: usize,
    /// One of these places.
    pub place: Vec2,
    /// The widest gap at such an end, m, and that end.
    pub widest: (f64, Vec2),
}

/// The walls with ends nearer than `tolerance` to each other joined, ends that near to another piece moved onto it, and
/// pieces that near along another piece left out. `edges` are those of obstacles. A wall may be left without a piece.
pub fn snap(walls: &[Vec<Segment>], edges: &[Segment], tolerance: f64) -> Vec<Vec<Segment>> {
    let mut pieces = listed(walls);
    join_ends(&mut pieces, tolerance);
    pieces = merged(&pieces, edges, tolerance);
    join_ends(&mut pieces, tolerance);
    for _ in 0..ROUNDS {
        if !move_ends(&mut pieces, edges, tolerance) {
            break;
        }
    }
    let mut walls = vec![Vec::new(); walls.len()];
    for (wall, piece) in pieces.into_iter().filter(|(_, piece)| piece.a != piece.b) {
        walls[wall].push(piece);
    }
    walls
}

/// Whether more pairs of pieces meet or nearly meet than can be looked at, as where thousands of lines meet in one point.
pub fn is_crowded(walls: &[Vec<Segment>], edges: &[Segment], tolerance: f64) -> bool {
    let (segments, mut count) = (all(&listed(walls), edges), 0);
    let mut is_too_many = |_, _| {
        count += 1;
        count > MOST_PAIRS
    };
    segments.len().pow(2) > 2 * MOST_PAIRS && any_near_pair(&segments, tolerance, &mut is_too_many)
}

/// Where walls nearly meet, if they do anywhere.
pub fn slips(walls: &[Vec<Segment>], edges: &[Segment], tolerance: f64) -> Option<Slips> {
    let pieces = listed(walls);
    let count = pieces.len();
    let mut ends: BTreeMap<[u64; 2], (usize, Vec2)> = BTreeMap::new();
    for p in pieces.iter().flat_map(|(_, piece)| [piece.a, piece.b]) {
        ends.entry(bits(p)).or_insert((0, p)).0 += 1;
    }
    let is_loose = |p: Vec2| ends[&bits(p)].0 == 1;
    let segments = all(&pieces, edges);
    // Of each piece: how near its ends are to something else, and whether it lies beside something else.
    let mut nearest = vec![[f64::INFINITY; 2]; count];
    let mut doubled = vec![false; count];
    for (own, other) in near_pairs(&segments, count, tolerance) {
        let (piece, found) = (segments[own], segments[other]);
        // The pieces of one wall are near each other where it turns; only loose ends of it may miss each other.
        let is_own = pieces.get(other).is_some_and(|(wall, _)| *wall == pieces[own].0);
        for (end, p) in [piece.a, piece.b].into_iter().enumerate() {
            let distance = if is_own {
                let loose = [found.a, found.b].into_iter().filter(|q| is_loose(*q));
                loose.map(|q| (q - p).norm()).fold(f64::INFINITY, f64::min)
            } else {
                found.distance(p)
            };
            nearest[own][end] = nearest[own][end].min(distance);
        }
        let ends = [
            found.distance(piece.a),
            found.distance(piece.b),
            piece.distance(found.a),
            piece.distance(found.b),
        ];
        let is_apart = ends.iter().all(|distance| *distance > JOINED) && !piece.meets(&found);
        // Of two that lie beside each other the shorter one counts, of two alike the first in space.
        let rank = |s: &Segment| (s.length(), s.a.x, s.a.y, s.b.x, s.b.y);
        let is_lesser = other >= count || rank(&piece) < rank(&found);
        doubled[own] |= !is_own && is_apart && is_lesser && along(&piece, &found, tolerance).is_some();
    }
    // The ends of a piece that lies beside another one are near that one, too.
    let loose: Vec<(f64, Vec2)> = (0..count)
        .filter(|k| !doubled[*k])
        .flat_map(|k| [(segments[k].a, nearest[k][0]), (segments[k].b, nearest[k][1])])
        .filter(|(p, distance)| is_loose(*p) && (JOINED..=tolerance).contains(distance))
        .map(|(p, distance)| (distance, p))
        .collect();
    let twice: Vec<Vec2> = (0..count).filter(|k| doubled[*k]).map(|k| middle(&pieces[k].1)).collect();
    let place = loose.first().map(|(_, p)| *p).or(twice.first().copied())?;
    let widest = loose.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, place));
    Some(Slips { ends: loose.len(), doubled: twice.len(), place, widest })
}

fn listed(walls: &[Vec<Segment>]) -> Vec<Piece> {
    walls
        .iter()
        .enumerate()
        .flat_map(|(wall, pieces)| pieces.iter().map(move |piece| (wall, *piece)))
        .collect()
}

fn bits(p: Vec2) -> [u64; 2] {
    // Zero has two signs.
    [(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits()]
}

fn middle(piece: &Segment) -> Vec2 {
    0.5 * (piece.a + piece.b)
}

/// The pieces, and then the edges of obstacles.
fn all(pieces: &[Piece], edges: &[Segment]) -> Vec<Segment> {
    pieces.iter().map(|(_, piece)| *piece).chain(edges.iter().copied()).collect()
}

/// Whether something is true of two segments within reach of each other.
fn any_near_pair(segments: &[Segment], reach: f64, is_true: &mut dyn FnMut(usize, usize) -> bool) -> bool {
    let more = Vec2::repeat(0.5 * reach + JOINED);
    let wider = |s: &Segment| Segment::new(s.a.inf(&s.b) - more, s.a.sup(&s.b) + more);
    let boxes: Vec<Segment> = segments.iter().map(wider).collect();
    let has_near_end =
        |a: &Segment, b: &Segment| a.distance(b.a) <= reach + JOINED || a.distance(b.b) <= reach + JOINED;
    let pair = sweep(&boxes, |i, j| {
        let (a, b) = (&segments[i], &segments[j]);
        (has_near_end(a, b) || has_near_end(b, a) || a.meets(b)) && is_true(i, j)
    });
    pair.is_some()
}

/// Each of the first `count` segments, by their numbers, with all others within reach.
fn near_pairs(segments: &[Segment], count: usize, reach: f64) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    any_near_pair(segments, reach, &mut |i, j| {
        pairs.extend([(i, j), (j, i)]);
        false
    });
    pairs.retain(|(own, _)| *own < count);
    pairs.sort_unstable();
    pairs
}

/// Ends that are near each other become one of them: of each spot the first from the left.
fn join_ends(pieces: &mut [Piece], tolerance: f64) {
    let mut ends: Vec<Vec2> = pieces.iter().flat_map(|(_, piece)| [piece.a, piece.b]).collect();
    ends.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    ends.dedup();
    let cell = |p: Vec2| ((p.x / tolerance).floor() as i64, (p.y / tolerance).floor() as i64);
    let mut kept: BTreeMap<(i64, i64), Vec<Vec2>> = BTreeMap::new();
    let mut moves: BTreeMap<[u64; 2], Vec2> = BTreeMap::new();
    for p in ends {
        let (x, y) = cell(p);
        let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y)));
        let near = around.filter_map(|cell| kept.get(&cell)).flatten().map(|q| ((q - p).norm(), *q));
        match near.filter(|(distance, _)| *distance <= tolerance).min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, q)) => _ = moves.insert(bits(p), q),
            None => kept.entry((x, y)).or_default().push(p),
        }
    }
    relocate(pieces, &moves);
}

fn relocate(pieces: &mut [Piece], moves: &BTreeMap<[u64; 2], Vec2>) {
    for p in pieces.iter_mut().flat_map(|(_, piece)| [&mut piece.a, &mut piece.b]) {
        if let Some(to) = moves.get(&bits(*p)) {
            *p = *to;
        }
    }
}

/// The part of a piece, as shares of its length, that lies within the tolerance along another one and is longer than that.
fn along(piece: &Segment, other: &Segment, tolerance: f64) -> Option<(f64, f64)> {
    let (way, length) = (piece.b - piece.a, piece.length());
    let share = |p: Vec2| {
        let share = (p - piece.a).dot(&way) / (length * length);
        share.clamp(0.0, 1.0)
    };
    let (mut low, mut high) = (share(other.a).min(share(other.b)), share(other.a).max(share(other.b)));
    if other.distance(piece.a) <= tolerance {
        low = 0.0;
    }
    if other.distance(piece.b) <= tolerance {
        high = 1.0;
    }
    // Between two points that are near to a segment all are.
    let is_near = |share: f64| other.distance(piece.a + way * share) <= tolerance;
    let is_long = (high - low) * length > tolerance;
    (is_long && is_near(low) && is_near(high)).then_some((low, high))
}

/// The pieces less what lies along a longer one; what is left of them ends on that one.
fn merged(pieces: &[Piece], edges: &[Segment], tolerance: f64) -> Vec<Piece> {
    let segments = all(pieces, edges);
    let rank = |k: usize| {
        let Segment { a, b } = segments[k];
        [-segments[k].length(), a.x, a.y, b.x, b.y]
    };
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|i, j| rank(*i).partial_cmp(&rank(*j)).unwrap_or(Ordering::Equal).then(i.cmp(j)));
    let pairs = near_pairs(&segments, pieces.len(), tolerance);
    // What is left of each; of an edge, all.
    let mut left: Vec<Vec<Segment>> = vec![Vec::new(); pieces.len()];
    left.extend(edges.iter().map(|edge| vec![*edge]));
    for own in order {
        let piece = segments[own];
        let from = pairs.partition_point(|pair| pair.0 < own);
        let near = pairs[from..].iter().take_while(|pair| pair.0 == own).flat_map(|pair| &left[pair.1]);
        let mut taken: Vec<(f64, f64, Segment)> =
            near.filter_map(|other| along(&piece, other, tolerance).map(|(l, h)| (l, h, *other))).collect();
        taken.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let at = |share: f64| piece.a + (piece.b - piece.a) * share;
        let (mut share, mut start) = (0.0, piece.a);
        let mut parts = Vec::new();
        for (low, high, other) in taken {
            if low > share {
                parts.push(Segment::new(start, other.nearest(at(low))));
            }
            if high > share {
                (share, start) = (high, other.nearest(at(high)));
            }
        }
        if share < 1.0 {
            parts.push(Segment::new(start, piece.b));
        }
        left[own] = parts;
    }
    let walls = pieces.iter().map(|(wall, _)| *wall);
    walls.zip(left).flat_map(|(wall, parts)| parts.into_iter().map(move |part| (wall, part))).collect()
}

/// Moves ends onto pieces that they miss; whether any was moved.
fn move_ends(pieces: &mut [Piece], edges: &[Segment], tolerance: f64) -> bool {
    let segments = all(pieces, edges);
    let mut nearest: BTreeMap<[u64; 2], (f64, Vec2)> = BTreeMap::new();
    for (own, other) in near_pairs(&segments, pieces.len(), tolerance) {
        let other = segments[other];
        for p in [segments[own].a, segments[own].b].into_iter().filter(|p| *p != other.a && *p != other.b) {
            let to = other.nearest(p);
            let distance = (to - p).norm();
            if distance <= nearest.get(&bits(p)).map_or(tolerance, |(least, _)| *least) {
                nearest.insert(bits(p), (distance, to));
            }
        }
    }
    let missed = nearest.into_iter().filter(|(_, (distance, _))| *distance > ROUNDING);
    let moves: BTreeMap<[u64; 2], Vec2> = missed.map(|(p, (_, to))| (p, to)).collect();
    relocate(pieces, &moves);
    !moves.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SNAP: f64 = 0.05;

    fn wall(points: &[(f64, f64)]) -> Vec<Segment> {
        let at = |(x, y): (f64, f64)| Vec2::new(x, y);
        points.windows(2).map(|pair| Segment::new(at(pair[0]), at(pair[1]))).collect()
    }

    /// The walls as ends of their pieces, in millimetres.
    fn snapped(walls: &[Vec<Segment>], edges: &[Segment]) -> Vec<Vec<[i32; 4]>> {
        let all = snap(walls, edges, SNAP);
        let round = |v: f64| (v * 1e3).round() as i32;
        let piece = |s: &Segment| [s.a.x, s.a.y, s.b.x, s.b.y].map(round);
        all.iter().map(|wall| wall.iter().map(piece).collect()).collect()
    }

    #[test]
    fn gaps_are_closed_and_what_meets_stays() {
        let room = [
            wall(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]),
            // 5 mm from the corner.
            wall(&[(4.003, 3.004), (0.0, 3.0)]),
            // 1 cm from the inside of the first wall, and joined to the second.
            wall(&[(2.0, 0.01), (2.0, 1.0)]),
            wall(&[(2.0, 1.0), (1.0, 1.0)]),
        ];
        let found = snapped(&room, &[]);
        assert_eq!(found[0], [[0, 0, 4000, 0], [4000, 0, 4000, 3000]]);
        assert_eq!(found[1], [[4000, 3000, 0, 3000]]);
        assert_eq!(found[2], [[2000, 0, 2000, 1000]]);
        assert_eq!(found[3], [[2000, 1000, 1000, 1000]]);
        let before = slips(&room, &[], SNAP).unwrap();
        assert_eq!((before.ends, before.doubled), (3, 0));
        assert_eq!(slips(&snap(&room, &[], SNAP), &[], SNAP), None);
    }

    #[test]
    fn a_line_along_another_one_is_merged_and_the_rest_of_it_stays() {
        let twice = [
            wall(&[(0.0, 0.0), (9.0, 0.0)]),
            wall(&[(1.0, 0.02), (5.0, 0.03)]),
            // Half of it goes on beyond the first wall.
            wall(&[(7.0, 0.04), (11.0, 0.04)]),
            // As near, but across.
            wall(&[(3.0, -1.0), (3.0, 1.0)]),
            wall(&[(9.0, 0.0), (0.0, 0.0)]),
        ];
        let found = snapped(&twice, &[]);
        assert_eq!(found[0].len() + found[4].len(), 1, "{found:?}");
        assert_eq!(found[1], [[0; 4]; 0]);
        assert_eq!(found[2], [[9000, 0, 11000, 40]]);
        assert_eq!(found[3], [[3000, -1000, 3000, 1000]]);
        let found = slips(&twice, &[], SNAP).unwrap();
        assert_eq!((found.ends, found.doubled), (0, 2));
        assert_eq!(slips(&snap(&twice, &[], SNAP), &[], SNAP), None);
    }

    #[test]
    fn walls_are_moved_to_edges_of_obstacles_and_edges_stay() {
        let edge = wall(&[(0.0, 0.0), (0.0, 2.0)]);
        let walls = [wall(&[(0.03, 1.0), (2.0, 1.0)]), wall(&[(-0.02, 0.2), (-0.02, 1.8)])];
        assert_eq!(snapped(&walls, &edge), [vec![[0, 1000, 2000, 1000]], vec![]]);
        let found = slips(&walls, &edge, SNAP).unwrap();
        assert_eq!((found.ends, found.doubled, found.place), (1, 1, Vec2::new(0.03, 1.0)));
    }

    #[test]
    fn the_order_of_the_file_and_directions_do_not_matter() {
        let walls = [
            wall(&[(0.0, 0.0), (4.0, 0.0)]),
            wall(&[(4.01, 0.01), (4.0, 3.0)]),
            wall(&[(3.99, 3.02), (0.0, 3.0)]),
            wall(&[(0.5, 3.01), (3.5, 3.02)]),
            wall(&[(2.0, 0.02), (2.01, 2.98)]),
        ];
        let ends = |walls: &[Vec<Segment>]| {
            let all = snap(walls, &[], SNAP);
            let mut all: Vec<_> = all
                .iter()
                .flatten()
                .map(|s| if bits(s.a) < bits(s.b) { [bits(s.a), bits(s.b)] } else { [bits(s.b), bits(s.a)] })
                .collect();
            all.sort_unstable();
            all
        };
        let mut turned: Vec<Vec<Segment>> = walls.to_vec();
        turned.reverse();
        turned[1] = turned[1].iter().map(|s| Segment::new(s.b, s.a)).collect();
        assert_eq!(ends(&walls), ends(&turned));
        assert_eq!(ends(&walls).len(), 4);
    }

    #[test]
    fn a_round_wall_of_short_pieces_has_no_gaps_and_stays_closed() {
        let turn = |k: u32| {
            let (sin, cos) = crate::base::math::sin_cos_turn(f64::from(k % 60) / 60.0);
            (0.3 * cos, 0.3 * sin)
        };
        let post: Vec<(f64, f64)> = (0..=60).map(turn).collect();
        assert_eq!(slips(&[wall(&post)], &[], SNAP), None, "its pieces are 3 cm long");
        let snapped = snap(&[wall(&post)], &[], SNAP).remove(0);
        assert!(snapped.len() > 20);
        assert!((0..snapped.len()).all(|k| snapped[k].b == snapped[(k + 1) % snapped.len()].a));
    }
}
