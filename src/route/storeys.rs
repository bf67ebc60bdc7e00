//! Ways over levels and stairs: the networks of the islands, joined by portals (`model::storeys`), by time.
//!
//! A way over stairs leads through the middles of their lines; its time is that of who goes at the speed of a level times the
//! share on stairs. So it is a shortest path in a graph of portals (Dijkstra 1959), whose arcs are ways on one island:
//!
//! ```text
//!   from --way--> portal ==> landing --way--> portal ==> landing --way--> goal
//! ```
//!
//! Lengths are those of a level that take as long. Whoever comes to a line crosses it where that is nearest.

use super::atlas::{Arcs, Atlas};
use super::way::ShortestWay;
use crate::base::frontier::Frontier;
use crate::base::geometry::{Segment, Vec2};
use crate::model::{Goal, Portal, Storeys};

/// So far behind the line of stairs a way leads, m.
const BEYOND: f64 = 0.5;

fn middle(line: &Segment) -> Vec2 {
    0.5 * (line.a + line.b)
}

/// How much longer than on a level a metre takes on an island on which one goes at this share of the speed.
fn slowness(share: f64, climbs: f64) -> f64 {
    if share < 1.0 { 1.0 / (share * climbs) } else { 1.0 / share }
}

impl Atlas {
    /// The shortest way of a body of a radius, m, over stairs, on which its speed is a share of that of their tables.
    pub(super) fn way_over_stairs(
        &self,
        from: Vec2,
        goal: &Goal,
        radius: f64,
        climbs: f64,
    ) -> Option<ShortestWay> {
        let storeys = &self.scene().storeys;
        let here = storeys.island_at(from);
        let island = &self.islands[here];
        let mut best = self.way_on(here, from, goal, radius).map(|way| (way.length, way, None));
        let known = self.behind.place((super::atlas::key(goal), radius.to_bits(), climbs.to_bits()));
        let behind = known.get_or_init(|| self.times(goal, radius, climbs));
        // No way is shorter than the straight line, and the shortest of those comes first.
        let mut out: Vec<(f64, usize)> = storeys
            .out_of(here)
            .map(|number| {
                let portal = &storeys.portals[number];
                let slowness = slowness(portal.approach, climbs);
                ((middle(&portal.line) - from).norm() * slowness + behind[number], number)
            })
            .filter(|(least, _)| least.is_finite())
            .collect();
        out.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for (least, number) in out {
            if best.as_ref().is_some_and(|best| best.0 < least) {
                break;
            }
            let portal = &storeys.portals[number];
            let slowness = slowness(portal.approach, climbs);
            let Some(way) = island.way(from, &Goal::Point(middle(&portal.line)), radius) else { continue };
            let time = way.length * slowness + behind[number];
            if best.as_ref().is_none_or(|best| time < best.0) {
                best = Some((time, way, Some(number)));
            }
        }
        let (length, way, portal) = best?;
        let Some(number) = portal else { return Some(way) };
        let portal = &storeys.portals[number];
        let end = self.islands[here].crossing(from, &way, portal, radius);
        Some(ShortestWay {
            length,
            end,
            over: Some((number, end + portal.across * BEYOND)),
            is_straight: false,
            ..way
        })
    }

    /// The shortest way on one island to a goal that lies there.
    fn way_on(&self, island: usize, from: Vec2, goal: &Goal, radius: f64) -> Option<ShortestWay> {
        let is_there = match goal {
            Goal::Point(point) => self.scene().storeys.island_at(*point) == island,
            // An island has its own parts of regions alone.
            Goal::Region(_) => true,
        };
        if is_there { self.islands[island].way(from, goal, radius) } else { None }
    }

    /// Where on the line of a portal a way leads across it.
    fn crossing(&self, from: Vec2, way: &ShortestWay, portal: &Portal, radius: f64) -> Vec2 {
        let corners = way.points();
        let last = corners.len().checked_sub(2).map_or(from, |before| corners[before]);
        let (half, centre) = (0.5 * (portal.line.b - portal.line.a), middle(&portal.line));
        let share = (1.0 - radius / half.norm()).max(0.0);
        let nearest = Segment::new(centre - half * share, centre + half * share).nearest(last);
        if self.sight().is_clear(last, nearest, radius) { nearest } else { centre }
    }

    /// From behind each portal to a goal, as lengths on a level; infinite where no way leads.
    fn times(&self, goal: &Goal, radius: f64, climbs: f64) -> Vec<f64> {
        let storeys = &self.scene().storeys;
        let arcs = self.arcs.place((radius.to_bits(), climbs.to_bits()));
        let arcs = arcs.get_or_init(|| self.arcs_between(radius, climbs));
        let mut frontier = Frontier::default();
        let mut times = vec![f64::INFINITY; storeys.portals.len()];
        for (number, portal) in storeys.portals.iter().enumerate() {
            let island = portal.islands[1] as usize;
            if let Some(way) = self.way_on(island, middle(&portal.landing), goal, radius) {
                times[number] = way.length * slowness(portal.speed, climbs);
                frontier.push(times[number], number as u32);
            }
        }
        while let Some((time, number)) = frontier.pop() {
            if time > times[number as usize] {
                continue;
            }
            for (before, length) in &arcs[number as usize] {
                let total = time + length;
                if total < times[*before] {
                    times[*before] = total;
                    frontier.push(total, *before as u32);
                }
            }
        }
        times
    }

    /// For each portal those from which a way on one island leads to it, with its length.
    fn arcs_between(&self, radius: f64, climbs: f64) -> Vec<Arcs> {
        let storeys = &self.scene().storeys;
        let arcs = |(to, portal): (usize, &Portal)| {
            let goal = Goal::Point(middle(&portal.line));
            let island = portal.islands[0] as usize;
            let into =
                storeys.portals.iter().enumerate().filter(|(from, other)| {
                    other.islands[1] as usize == island && *from != Storeys::reverse(to)
                });
            let way = |other: &Portal| self.islands[island].way(middle(&other.landing), &goal, radius);
            into.filter_map(|(from, other)| {
                Some((from, way(other)?.length * slowness(portal.approach, climbs)))
            })
            .collect()
        };
        storeys.portals.iter().enumerate().map(arcs).collect()
    }
}
