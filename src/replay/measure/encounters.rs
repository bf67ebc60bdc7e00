//! Numbers of encounters, as `CommonRoad` `CriMe` collects them (Lin and Althoff, IEEE IV 2023), for bodies that are discs of one
//! radius: time to collision, brake threat number, and post-encroachment time.

use crate::base::geometry::Vec2;
use crate::data::tracks::Recording;
use std::collections::BTreeMap;

/// The numbers of a frame, with their units.
pub const NUMBERS: [(&str, &str); 3] = [("nearest", "m"), ("time_to_collision", "s"), ("brake_threat", "")];

/// People farther apart than this do not meet, m.
const FAR: f64 = 10.0;
/// Two who would touch later than this walk side by side, and rounding alone lets them meet, s.
const LATEST: f64 = 3600.0;
/// Post-encroachment times above this are none, s.
const LONGEST: f64 = 5.0;
/// Places are looked at this often, s.
const SPACING: f64 = 0.1;

/// The numbers of one frame; infinite, or 0 for the threat, where nobody meets anybody.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounters {
    /// The least distance of two centres, m.
    pub nearest: f64,
    /// The least time until two bodies touch if both keep their velocity, s: 0 in contact.
    pub collision: f64,
    /// The largest of: the deceleration that two who approach each other need to stop before they touch, v² / (2 gap) along the line
    /// between them, over the one that a person can reach.
    pub threat: f64,
}

/// The numbers of people at some places with some velocities.
pub fn meetings(seen: &[(Vec2, Vec2)], radius: f64, brake: f64) -> Encounters {
    let mut found = Encounters { nearest: f64::INFINITY, collision: f64::INFINITY, threat: f64::NAN };
    let mut order: Vec<&(Vec2, Vec2)> = seen.iter().collect();
    order.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    for (k, (at, velocity)) in order.iter().enumerate() {
        for (other, other_velocity) in order[k + 1..].iter().take_while(|(other, _)| other.x - at.x < FAR) {
            let (way, drift) = (other - at, other_velocity - velocity);
            let distance = way.norm();
            if distance >= FAR {
                continue;
            }
            found.nearest = found.nearest.min(distance);
            found.collision = found.collision.min(time_to_collision(way, drift, 2.0 * radius));
            found.threat = found.threat.max(threat(way, drift, 2.0 * radius, brake));
        }
    }
    found
}

/// The first time at which a point that drifts comes within a reach of the origin; infinite if it does not within an hour.
fn time_to_collision(way: Vec2, drift: Vec2, reach: f64) -> f64 {
    let time = meeting(way, drift, reach);
    if time > LATEST { f64::INFINITY } else { time }
}

/// The time until two bodies that keep their velocities touch, s.
pub(in crate::replay) fn meeting(apart: Vec2, relative: Vec2, reach: f64) -> f64 {
    let (a, b) = (relative.norm_squared(), apart.dot(&relative));
    let c = apart.norm_squared() - reach * reach;
    let root = b * b - a * c;
    if c <= 0.0 {
        0.0
    } else if b >= 0.0 || root < 0.0 {
        f64::INFINITY
    } else {
        c / (root.sqrt() - b)
    }
}

/// Not a number for two who do not approach each other.
fn threat(way: Vec2, drift: Vec2, reach: f64, brake: f64) -> f64 {
    let distance = way.norm();
    let closing = -way.dot(&drift) / distance;
    let gap = distance - reach;
    match (closing > 0.0, gap > 0.0) {
        (true, true) => closing * closing / (2.0 * gap * brake),
        (true, false) => f64::INFINITY,
        _ => f64::NAN,
    }
}

/// One who covers a place soon after another one has left it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passing {
    /// Who was there before.
    pub first: u32,
    /// Who came after.
    pub second: u32,
    /// The post-encroachment time, s: from when the body of the first leaves the place until that of the second covers it.
    pub time: f64,
    /// When the second covers it, s.
    pub at: f64,
}

/// When who was where.
type Visit = (f64, u32, Vec2);

/// For each ordered pair the least post-encroachment time of at most 5 s, by ascending time. Two who touch have none.
///
/// Bodies cover a common place if their centres are at most two radii apart. Centres are looked at each tenth of a second, so a
/// time is right to about that.
pub fn passings(recording: &Recording, radius: f64) -> Vec<Passing> {
    let reach = 2.0 * radius;
    // Squares of the plane, each with the times and places of those who were there.
    let mut squares: BTreeMap<(i64, i64), Vec<Visit>> = BTreeMap::new();
    let square = |at: Vec2| ((at.x / reach).floor() as i64, (at.y / reach).floor() as i64);
    let step = recording.step();
    let parts = (step / SPACING).ceil().max(1.0) as u32;
    for person in recording.people() {
        for pair in person.samples.windows(2) {
            let (from, to) = (recording.time_of(pair[0].frame), recording.time_of(pair[1].frame));
            if to - from > 1.5 * step {
                continue;
            }
            for k in 0..parts {
                let share = f64::from(k) / f64::from(parts);
                let at = pair[0].position + (pair[1].position - pair[0].position) * share;
                squares.entry(square(at)).or_default().push((from + (to - from) * share, person.id, at));
            }
        }
    }
    for all in squares.values_mut() {
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let mut least: BTreeMap<(u32, u32), Passing> = BTreeMap::new();
    for ((column, row), all) in &squares {
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let Some(others) = squares.get(&(column + dx, row + dy)) else { continue };
            let mut from = 0;
            for (at, second, place) in all {
                from += others[from..].partition_point(|(time, ..)| *time < at - LONGEST);
                for (before, first, other) in others[from..].iter().take_while(|(time, ..)| time < at) {
                    if first == second || (other - place).norm() > reach {
                        continue;
                    }
                    let time = at - before;
                    let known = least.entry((*first, *second)).or_insert(Passing {
                        first: *first,
                        second: *second,
                        time: f64::INFINITY,
                        at: *at,
                    });
                    if time < known.time {
                        (known.time, known.at) = (time, *at);
                    }
                }
            }
        }
    }
    let mut found: Vec<Passing> = least.into_values().filter(|one| one.time > SPACING).collect();
    found.sort_by(|a, b| a.time.total_cmp(&b.time).then((a.first, a.second).cmp(&(b.first, b.second))));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, vx: f64, vy: f64) -> (Vec2, Vec2) {
        (Vec2::new(x, y), Vec2::new(vx, vy))
    }

    #[test]
    fn numbers_of_a_frame_have_closed_forms() {
        // Head on at 1 m/s each, 5 m apart, radii of 0.25 m: 4.5 m at 2 m/s; 2² / (2 · 4.5 · 2) of 2 m/s².
        let found = meetings(&[at(0.0, 0.0, 1.0, 0.0), at(5.0, 0.0, -1.0, 0.0)], 0.25, 2.0);
        assert_eq!((found.nearest, found.collision), (5.0, 2.25));
        assert!((found.threat - 4.0 / 18.0).abs() < 1e-12);
        // Side by side they never touch, and need no brake.
        let found = meetings(&[at(0.0, 0.0, 1.0, 0.0), at(0.0, 1.0, 1.0, 0.0)], 0.25, 2.0);
        assert!(found.nearest == 1.0 && found.collision.is_infinite() && found.threat.is_nan());
        assert!(meetings(&[at(0.0, 0.0, 1.0, 0.0)], 0.25, 2.0).nearest.is_infinite());
        assert_eq!(meetings(&[at(0.0, 0.0, 1.0, 0.0), at(0.4, 0.0, 0.0, 0.0)], 0.25, 2.0).collision, 0.0);
    }

    #[test]
    fn a_place_is_covered_after_it_was_left() {
        // One walks east along y = 0, the other north along x = 0 and is at the crossing 2 s later.
        let rows: String = (0..80)
            .map(|k| {
                let t = 0.1 * f64::from(k);
                format!("{t},1,{},0\n{t},2,0,{}\n", t - 3.0, t - 5.0)
            })
            .collect();
        let text = format!("time,id,x,y\n{rows}");
        let recording = crate::data::tracks::read_csv(&text, None, None).unwrap();
        let found = passings(&recording, 0.25);
        let one = found.iter().find(|one| (one.first, one.second) == (1, 2)).unwrap();
        // Centres 0.5 m apart: the first has left 0.25 m behind it on either way at the best, 2 - 0.25 √2 · 2 s in all.
        assert!((one.time - (2.0 - 0.5 * std::f64::consts::SQRT_2)).abs() < 0.15, "{one:?}");
        assert!(found.iter().all(|one| one.first == 1), "{found:?}");
    }
}
