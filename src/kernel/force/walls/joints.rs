//! Where faces meet, and which hang together: worked out once for a scene.

use super::face::Form;
use super::{Face, Joint, ON, Surface};
use crate::base::geometry::Nearby;
use crate::base::geometry::{Bounds, Segment, Vec2, cross};

/// What two rectangles share, a little larger; `None` where they are apart.
fn overlap(a: &Bounds, b: &Bounds) -> Option<Bounds> {
    let more = Vec2::repeat(2.0 * ON);
    let shared = Bounds { low: a.low.sup(&b.low) - more, high: a.high.inf(&b.high) + more };
    (shared.low.x <= shared.high.x && shared.low.y <= shared.high.y).then_some(shared)
}

fn hull(a: Option<Bounds>, b: Bounds) -> Bounds {
    a.map_or(b, |a| Bounds { low: a.low.inf(&b.low), high: a.high.sup(&b.high) })
}

fn around(s: &Segment) -> Bounds {
    Bounds { low: s.a.inf(&s.b), high: s.a.sup(&s.b) }
}

/// Pieces in one line are this near to it at most, m. Where one hides the other, the distance jumps by no more.
const IN_LINE: f64 = 1e-6;

/// Whether two pieces that meet lie in one line.
fn in_line(one: &Segment, other: &Segment) -> bool {
    let near = |line: &Segment, p: Vec2| {
        let along = line.b - line.a;
        cross(along, p - line.a).abs() <= IN_LINE * along.norm()
    };
    near(one, other.a)
        && near(one, other.b)
        && near(other, one.a)
        && near(other, one.b)
        && apart(one, other) <= IN_LINE
}

/// Where a face meets others, in their order, and those of them that it hangs together with.
pub(super) fn of_face(
    faces: &[Face],
    wholes: &[Surface],
    index: usize,
    nearby: &Nearby,
) -> (Vec<Joint>, Vec<u32>) {
    let (mut joints, mut meets) = (Vec::new(), Vec::new());
    let own = &faces[index];
    let mut room = Vec::new();
    let reach = overlap(&own.bounds, &own.bounds).unwrap_or(own.bounds);
    // Of the barrier of the last one: a rectangle around what is near its edges.
    let (mut barrier, mut rim) = (own.barrier, None);
    for &k in nearby.find(&reach, &mut room) {
        let other = &faces[k as usize];
        if barrier != other.barrier {
            (barrier, rim) = (other.barrier, None);
        }
        if k as usize == index {
            continue;
        }
        let is_own = own.barrier == other.barrier;
        let mut is_in_line = false;
        let around = match (&own.form, &other.form) {
            (Form::Side(one), Form::Side(two)) => {
                let (one, two) = (one.piece(), two.piece());
                let shared = close(&one, &two);
                rim = shared.map(|shared| hull(rim, shared)).or(rim);
                if shared.is_some() && apart(&one, &two) <= ON {
                    meets.push(k);
                    is_in_line = in_line(&one, &two);
                }
                shared
            }
            // Who got into a polygon is not pushed by what its own rim hides.
            (Form::Side(_), Form::Inside) | (Form::Inside, Form::Side(_)) if is_own => None,
            (Form::Side(side), Form::Inside) => {
                let (piece, whole) = (side.piece(), &wholes[other.barrier as usize]);
                let is_in = whole.surrounds(piece.a) || whole.surrounds(piece.b);
                let all = is_in.then(|| overlap(&own.bounds, &other.bounds)).flatten();
                all.map(|all| hull(rim, all)).or(rim)
            }
            (Form::Side(side), Form::Disc) => {
                let (piece, disc) = (side.piece(), &wholes[other.barrier as usize]);
                if disc.nearest_to(piece.nearest(disc.centre())).1 <= ON {
                    meets.push(k);
                }
                overlap(&own.bounds, &other.bounds)
            }
            (Form::Disc, Form::Disc) => {
                let (one, two) = (&wholes[own.barrier as usize], &wholes[other.barrier as usize]);
                if one.nearest_to(two.centre()).1 + two.nearest_to(one.centre()).1
                    <= (one.centre() - two.centre()).norm() + ON
                {
                    meets.push(k);
                }
                overlap(&own.bounds, &other.bounds)
            }
            (Form::Disc | Form::Inside, _) => overlap(&own.bounds, &other.bounds),
        };
        joints.extend(around.map(|around| Joint { other: k, around, in_line: is_in_line }));
    }
    (joints, meets)
}

/// The root of the tree that one stands in; the way to it gets shorter.
fn find(root: &mut [u32], mut k: u32) -> u32 {
    while root[k as usize] != k {
        root[k as usize] = root[root[k as usize] as usize];
        k = root[k as usize];
    }
    k
}

/// Which faces hang together by such meetings: of each the first of all that do (union-find).
pub(super) fn structures(meets: &[Vec<u32>]) -> Vec<u32> {
    let mut root: Vec<u32> = (0..meets.len() as u32).collect();
    for (k, others) in meets.iter().enumerate() {
        for &other in others {
            let (a, b) = (find(&mut root, k as u32), find(&mut root, other));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    (0..meets.len() as u32).map(|k| find(&mut root, k)).collect()
}

/// Distance between two pieces.
fn apart(one: &Segment, other: &Segment) -> f64 {
    if one.meets(other) {
        return 0.0;
    }
    let ends = [one.distance(other.a), one.distance(other.b), other.distance(one.a), other.distance(one.b)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// A rectangle around all points of a piece that are as near to another one as `ON`.
fn close(piece: &Segment, other: &Segment) -> Option<Bounds> {
    let shared = overlap(&around(piece), &around(other))?;
    // The share of the piece on which the line through the other one is near; of parallels all or nothing.
    let (along, across) = (piece.b - piece.a, other.b - other.a);
    let length = across.norm();
    if length == 0.0 || along.norm() == 0.0 {
        return Some(shared);
    }
    let reach = 2.0 * ON * length + 1e-9 * (length + along.norm()) * (piece.a.norm() + other.a.norm() + 1.0);
    let (from, slope) = (cross(across, piece.a - other.a), cross(across, along));
    let (mut first, mut last) = (0.0, 1.0);
    if slope.abs() > 1e-12 * length * along.norm() {
        let ends = [(-reach - from) / slope, (reach - from) / slope];
        let (low, high) = if ends[0] < ends[1] { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
        first = if low > first { low } else { first };
        last = if high < last { high } else { last };
    } else if from.abs() > reach {
        return None;
    }
    let near = Segment::new(piece.a + along * first, piece.a + along * last);
    if first <= last { overlap(&around(&near), &shared) } else { None }
}
