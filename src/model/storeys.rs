//! Levels of a building, and the stairs between them.
//!
//! Each level and each flight of stairs is an *island* of one plane, so far from the others that nothing is felt or seen
//! across. Whoever crosses the line of a *portal* goes on at the landing on the other island.
//!
//! ```text
//!      +----------------+            what is drawn as ground and first floor, one above the other,
//!      | stairs  run -> |            lies side by side; the flight is a strip of its own
//!      +-a------------b-+
//!   +----------+   +----------+
//!   | ground  a|   |b  first  |      a: the foot, two portals (up, and back down); b: the head
//!   +----------+   +----------+
//! ```

use crate::base::geometry::{Bounds, Segment, Vec2};

/// Islands are so far apart, m: beyond the reach of all forces.
pub const APART: f64 = 20.0;

/// The levels and stairs of a scene; none where the plane has no levels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Storeys {
    /// The levels by height, then the stairs in order of writing.
    pub islands: Vec<Island>,
    /// Four for each flight of stairs: up from its foot, up to its head, down from its head, down to its foot.
    pub portals: Vec<Portal>,
}

/// A level or a flight of stairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Island {
    /// Its name.
    pub name: String,
    /// Where the origin of its own coordinates lies in the plane, m. Those of stairs are the way from the foot, and that from
    /// the right side when one goes up.
    pub origin: Vec2,
    /// The rectangle in the plane around all that is there.
    pub bounds: Bounds,
    /// How high a level lies, m; none of stairs.
    pub height: Option<f64>,
}

/// One way across a line at which an island ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Portal {
    /// The island that is left, and the one that is entered.
    pub islands: [u32; 2],
    /// The line that is crossed.
    pub line: Segment,
    /// In which direction, a unit vector.
    pub across: Vec2,
    /// The line from which one goes on; its ends are those of the other line.
    pub landing: Segment,
    /// In which direction, a unit vector.
    pub onward: Vec2,
    /// The speed on the island that is entered, as a share of that on a level.
    pub speed: f64,
    /// The speed on the way to it, as a share of that on a level.
    pub approach: f64,
}

impl Portal {
    /// A direction on the island that is left, on the one that is entered.
    pub fn turned(&self, v: Vec2) -> Vec2 {
        let left = |u: Vec2| Vec2::new(-u.y, u.x);
        self.onward * v.dot(&self.across) + left(self.onward) * v.dot(&left(self.across))
    }
}

impl Storeys {
    /// Whether the plane has no levels.
    pub const fn are_none(&self) -> bool {
        self.islands.is_empty()
    }

    /// The island on which, or nearest to which, a place lies.
    pub fn island_at(&self, p: Vec2) -> usize {
        if let Some(here) = self.islands.iter().position(|island| island.bounds.contains(p)) {
            return here;
        }
        let far = self.islands.iter().map(|island| island.bounds.distance(p)).enumerate();
        far.reduce(|a, b| if b.1 < a.1 { b } else { a }).map_or(0, |(k, _)| k)
    }

    /// Whether two places lie on different islands.
    pub fn separate(&self, a: Vec2, b: Vec2) -> bool {
        // Different islands are farther apart.
        if self.are_none() || (a - b).norm() <= 0.5 * APART {
            return false;
        }
        let here = self.island_at(a);
        !self.islands[here].bounds.contains(b) && self.island_at(b) != here
    }

    /// The island on which a place lies, and its coordinates there; none without levels.
    pub fn local(&self, p: Vec2) -> Option<(&Island, Vec2)> {
        let island = self.islands.get(self.island_at(p))?;
        Some((island, p - island.origin))
    }

    /// A place as a text: `first (3, 4) m`.
    pub fn place(&self, p: Vec2) -> String {
        let number = |v: f64| (v * 100.0).round() / 100.0 + 0.0;
        let text = |p: Vec2| format!("({}, {}) m", number(p.x), number(p.y));
        self.local(p).map_or_else(|| text(p), |(island, p)| format!("{} {}", island.name, text(p)))
    }

    /// The portals by which an island is left, by number.
    pub fn out_of(&self, island: usize) -> impl Iterator<Item = usize> + '_ {
        let is_there = move |portal: &Portal| portal.islands[0] as usize == island;
        self.portals.iter().enumerate().filter(move |(_, portal)| is_there(portal)).map(|(k, _)| k)
    }

    /// The portal that leads back across the same line.
    pub const fn reverse(portal: usize) -> usize {
        // Up from the foot and down to it, up to the head and down from it.
        portal ^ 3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_portal_turns_directions_and_has_one_that_leads_back() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let line = Segment::new(p(0.0, 0.0), p(1.0, 0.0));
        let portal = Portal {
            islands: [0, 1],
            line,
            across: p(0.0, 1.0),
            landing: line,
            onward: p(1.0, 0.0),
            speed: 0.5,
            approach: 1.0,
        };
        assert_eq!(portal.turned(p(0.0, 2.0)), p(2.0, 0.0));
        // To the right of who goes north is east, and of who goes east is south.
        assert_eq!(portal.turned(p(1.0, 0.0)), p(0.0, -1.0));
        assert_eq!([0, 1, 2, 3, 4].map(Storeys::reverse), [3, 2, 1, 0, 7]);
    }
}
