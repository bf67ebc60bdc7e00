//! One ray per obstacle, all in one direction. The order in which a path crosses them tells on which side it passes each
//! obstacle (Bhattacharya, Likhachev, Kumar, "Topological constraints in search-based robot path planning", 2012).

use super::word::Word;
use crate::base::geometry::{Bounds, Nearby, Segment, Shape, Vec2, cross};
use crate::model::Piece;
use crate::model::sight::ROUNDING;

/// The rays of a scene, sorted from the right to the left of their direction.
///
/// Barriers that share a point are one obstacle, as are all in one solid. Each ray starts at the point of its obstacle that
/// lies farthest in the direction, so it is outside of every ring of that obstacle: a path inside of a ring never crosses it,
/// and what encloses a scene needs no rule of its own.
#[derive(Clone, Debug)]
pub struct Rays {
    direction: Vec2,
    /// How far each is to the left of the direction, m, and where it starts.
    starts: Vec<(f64, Vec2)>,
}

impl Rays {
    /// The direction of rays: one rad, parallel to few walls that people build.
    pub const DIRECTION: Vec2 = Vec2::new(0.540_302_305_868_139_8, 0.841_470_984_807_896_5);

    /// The rays of the obstacles that pieces of surface and solids make up, in the direction of a unit vector.
    pub fn new(pieces: &[Piece], solids: &[Shape], direction: Vec2) -> Self {
        let along = |p: &Vec2| p.dot(&direction);
        let mut starts: Vec<Option<Vec2>> = vec![None; pieces.len()];
        for (piece, obstacle) in pieces.iter().zip(obstacles(pieces, solids)) {
            let ends = match piece {
                Piece::Edge(edge) => [edge.a, edge.b],
                Piece::Disc { centre, radius } => [centre + direction * *radius; 2],
            };
            for end in ends {
                let start = &mut starts[obstacle];
                *start = start.filter(|known| along(known) >= along(&end)).or(Some(end));
            }
        }
        let level = |p: Vec2| cross(direction, p);
        let mut starts: Vec<(f64, Vec2)> = starts.into_iter().flatten().map(|p| (level(p), p)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0).then(along(&a.1).total_cmp(&along(&b.1))));
        Self { direction, starts }
    }

    /// How many there are: one per obstacle.
    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// The rays that a segment crosses, in order, as letters of a [`Word`].
    ///
    /// A place on the line of a ray counts as on its right, so a path crosses the line of a ray once where it passes through
    /// it at a vertex. A segment and the same one backwards cross the same rays.
    pub fn crossings(&self, from: Vec2, to: Vec2) -> impl Iterator<Item = i32> + '_ {
        let rank = |p: Vec2| {
            let level = cross(self.direction, p);
            self.starts.partition_point(|(of_ray, _)| *of_ray < level)
        };
        let (first, last) = (rank(from), rank(to));
        let rises = first <= last;
        let (low, high) = if rises { (from, to) } else { (to, from) };
        let count = first.abs_diff(last);
        (0..count).filter_map(move |k| {
            let ray = if rises { first + k } else { first - 1 - k };
            let start = self.starts.get(ray)?.1;
            // The segment passes in front of the start if this lies to the left of its rising direction.
            let letter = if rises { ray as i32 + 1 } else { -(ray as i32 + 1) };
            (cross(high - low, start - low) > 0.0).then_some(letter)
        })
    }

    /// The class of a path.
    pub fn word(&self, path: &[Vec2]) -> Word {
        let mut word = Word::default();
        for (a, b) in path.iter().zip(path.iter().skip(1)) {
            self.crossings(*a, *b).for_each(|letter| word.push(letter));
        }
        word
    }
}

/// The number of the obstacle to which each piece belongs, below the count of pieces.
fn obstacles(pieces: &[Piece], solids: &[Shape]) -> Vec<usize> {
    // A piece as a segment, and what is nearer to that than a distance touches the piece.
    let core = |piece: &Piece| match piece {
        Piece::Edge(edge) => (*edge, ROUNDING),
        Piece::Disc { centre, radius } => (Segment::new(*centre, *centre), radius + ROUNDING),
    };
    let bounds = |piece: &Piece| {
        let (line, reach) = core(piece);
        let reach = Vec2::repeat(reach);
        Bounds { low: line.a.inf(&line.b) - reach, high: line.a.sup(&line.b) + reach }
    };
    let boxes: Vec<Bounds> = pieces.iter().map(bounds).collect();
    let nearby = Nearby::new(&boxes);
    let mut of_piece: Vec<usize> = (0..pieces.len()).collect();
    let mut room = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        let (line, reach) = core(piece);
        for &other in nearby.find(&boxes[k], &mut room) {
            let other = other as usize;
            if other < k && pieces[other].distance_to(&line) <= reach {
                unite(&mut of_piece, k, other);
            }
        }
    }
    for solid in solids {
        let mut first = None;
        for &k in nearby.find(&solid.bounds(), &mut room) {
            let k = k as usize;
            if solid.contains(core(&pieces[k]).0.a) {
                unite(&mut of_piece, *first.get_or_insert(k), k);
            }
        }
    }
    (0..pieces.len()).map(|k| root(&mut of_piece, k)).collect()
}

/// The piece that stands for the set of a piece; halves the way to it.
fn root(parents: &mut [usize], mut k: usize) -> usize {
    while parents[k] != k {
        parents[k] = parents[parents[k]];
        k = parents[k];
    }
    k
}

/// Unites the sets of two pieces; false if they were one.
pub(super) fn unite(parents: &mut [usize], a: usize, b: usize) -> bool {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b)] = a.min(b);
    a != b
}
