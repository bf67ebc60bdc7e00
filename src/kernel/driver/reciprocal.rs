//! Reciprocal avoidance: optimal reciprocal collision avoidance (van den Berg, Guy, Lin, Manocha 2011, "ORCA"). The driving velocity
//! of a plan is the preferred one; the nearest velocity to it becomes the driving velocity that leaves no contact with anybody
//! within a time, if the other one does half of what that takes.
//!
//! ```text
//!   relative velocities that meet within T:           the permitted velocities of one of both:
//!   a cone cut off by a circle of radius R / T        a half-plane whose rim is half of u away
//!
//!        \     ooo     /                                        permitted
//!         \  oo   oo  /                                  ------------+---------- rim
//!          \o   +   o/   + at p / T                                  | u / 2
//!           \       /                                                * present velocity
//!            \     /     u: the shortest way out
//! ```
//!
//! Barriers are left to the plan, which keeps clear of them, and to contact.

use super::stage::Drive;
use crate::base::geometry::{Vec2, cross};
use crate::base::lanes::Mask;
use crate::kernel::state::{Slot, State};
use crate::model::Parameter;

/// Contact is avoided for so long, s.
const HORIZON: f64 = 2.0;
/// Whoever is farther away than both can come near in this time does not matter, s.
const SIGHT: f64 = 2.0 * HORIZON;
/// How often the least violation is halved where no velocity keeps all half-planes.
const HALVINGS: u32 = 40;
/// Two who come exactly towards each other would both stop. Each prefers a little to the right, by this share of its speed.
const RIGHT: f64 = 0.03;
/// Shorter vectors have no direction.
const NO_LENGTH: f64 = 1e-12;

/// The velocities `v` with `(v - rim) · normal >= 0`.
#[derive(Clone, Copy, Debug)]
struct HalfPlane {
    rim: Vec2,
    normal: Vec2,
}

impl HalfPlane {
    /// How far inside a velocity is; negative outside.
    fn inside(&self, v: Vec2) -> f64 {
        (v - self.rim).dot(&self.normal)
    }
}

/// A body and how it moves.
#[derive(Clone, Copy, Debug)]
struct Moving {
    at: Vec2,
    velocity: Vec2,
    radius: f64,
}

/// The shortest change of a relative velocity after which two bodies do not meet within the horizon, and its direction. `apart` is the
/// way to the other one, m, and bodies in contact part within `dt`, s.
fn way_out(apart: Vec2, relative: Vec2, reach: f64, dt: f64) -> (Vec2, Vec2) {
    let square = apart.norm_squared();
    let is_contact = square <= reach * reach;
    let time = if is_contact { dt } else { HORIZON };
    let from_middle = relative - apart / time;
    let ahead = from_middle.dot(&apart);
    if is_contact || ahead < 0.0 && ahead * ahead > reach * reach * from_middle.norm_squared() {
        // The circle is nearer than the legs of the cone.
        let length = from_middle.norm();
        let out = if length > NO_LENGTH { from_middle / length } else { Vec2::new(0.0, 1.0) };
        return (out * (reach / time - length), out);
    }
    let leg = (square - reach * reach).sqrt();
    let side = if cross(apart, from_middle) > 0.0 { 1.0 } else { -1.0 };
    // Along the leg of that side, and across it out of the cone.
    let along =
        Vec2::new(apart.x * leg - side * apart.y * reach, side * apart.x * reach + apart.y * leg) / square;
    let out = Vec2::new(-along.y, along.x) * side;
    (along * relative.dot(&along) - relative, out)
}

/// The half-plane of the velocities of one body that does a share of what keeps it from another one.
fn half_plane(own: &Moving, other: &Moving, share: f64, dt: f64) -> HalfPlane {
    let reach = own.radius + other.radius;
    let (change, normal) = way_out(other.at - own.at, own.velocity - other.velocity, reach, dt);
    HalfPlane { rim: own.velocity + change * share, normal }
}

/// The permitted velocity nearest to a preferred one, at most so fast; `None` if there is none. Half-planes are added one by one: where
/// the best velocity so far breaks one, the best one lies on its rim (Seidel 1991).
fn nearest(planes: &[HalfPlane], preferred: Vec2, most: f64) -> Option<Vec2> {
    let speed = preferred.norm();
    let mut best = if speed > most { preferred * (most / speed) } else { preferred };
    for (k, plane) in planes.iter().enumerate() {
        if plane.inside(best) >= 0.0 {
            continue;
        }
        let along = Vec2::new(plane.normal.y, -plane.normal.x);
        let middle = plane.rim.dot(&along);
        let room = most * most - plane.rim.norm_squared() + middle * middle;
        if room < 0.0 {
            return None;
        }
        let (mut low, mut high) = (-middle - room.sqrt(), -middle + room.sqrt());
        for before in &planes[..k] {
            let (slope, inside) = (along.dot(&before.normal), before.inside(plane.rim));
            if slope.abs() <= NO_LENGTH {
                if inside < 0.0 {
                    return None;
                }
            } else if slope > 0.0 {
                low = low.max(-inside / slope);
            } else {
                high = high.min(-inside / slope);
            }
        }
        if low > high {
            return None;
        }
        best = plane.rim + along * (preferred - plane.rim).dot(&along).clamp(low, high);
    }
    Some(best)
}

/// The permitted velocity nearest to a preferred one; if there is none, that which breaks the half-planes least.
fn permitted(planes: &[HalfPlane], preferred: Vec2, most: f64) -> Vec2 {
    if let Some(found) = nearest(planes, preferred, most) {
        return found;
    }
    let (mut low, mut high) =
        (0.0, planes.iter().map(|plane| -plane.inside(Vec2::zeros())).fold(0.0, f64::max));
    let mut best = Vec2::zeros();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let wider = |plane: &HalfPlane| HalfPlane { rim: plane.rim - plane.normal * middle, ..*plane };
        match nearest(&planes.iter().map(wider).collect::<Vec<_>>(), preferred, most) {
            Some(found) => (high, best) = (middle, found),
            None => low = middle,
        }
    }
    best
}

/// Changes the driving velocities of the slots of a block that follow a trajectory and avoid others so.
pub(super) fn avoid(drive: &Drive, state: &mut State, block: usize, slots: Mask) {
    let avoids = |agent: usize| {
        drive.scenario.agents[agent].body.planner.as_ref().is_some_and(|planner| planner.reciprocal)
    };
    for lane in (slots & state.plans.courses[block].driven & !state.route.advised[block]).iter() {
        let slot = Slot { block, lane };
        let (agent, trial) = (state.layout.agent_of(slot), state.layout.trial_of(lane));
        if !avoids(agent) {
            continue;
        }
        let moving = |slot: Slot| Moving {
            at: state.position(slot),
            velocity: state.velocity(slot),
            radius: slot.of(&state.bodies[Parameter::Radius]),
        };
        let own = moving(slot);
        let most = slot.of(&state.bodies[Parameter::LimitSpeed]);
        let mut others: Vec<(f64, HalfPlane)> = Vec::new();
        for other in (0..state.agents).filter(|other| *other != agent) {
            let place = state.slot(other, trial);
            if !state.is_present(place) {
                continue;
            }
            let one = moving(place);
            let gap = (one.at - own.at).norm() - own.radius - one.radius;
            if gap < SIGHT * (most + one.velocity.norm()) {
                let share = if avoids(other) { 0.5 } else { 1.0 };
                others.push((gap, half_plane(&own, &one, share, drive.dt)));
            }
        }
        // The nearest first.
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        let planes: Vec<HalfPlane> = others.into_iter().map(|(_, plane)| plane).collect();
        if planes.is_empty() {
            continue;
        }
        let preferred = slot.vector(&state.driving.ex, &state.driving.ey) * slot.of(&state.driving.speed);
        let preferred = preferred + Vec2::new(preferred.y, -preferred.x) * RIGHT;
        let found = permitted(&planes, preferred, most);
        let speed = found.norm();
        if speed > NO_LENGTH {
            state.driving.ex[block].0[lane] = found.x / speed;
            state.driving.ey[block].0[lane] = found.y / speed;
        }
        state.driving.speed[block].0[lane] = speed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    fn draws(index: u64) -> impl FnMut() -> f64 {
        let stream = Stream::of(TrialKey { seed: 3, index, branch: 0 }, 0, Purpose::Test);
        let mut k = 0;
        move || {
            k += 1;
            2.0 * stream.uniform(k) - 1.0
        }
    }

    /// How near two bodies come within the horizon.
    fn nearness(apart: Vec2, relative: Vec2) -> f64 {
        let time = (apart.dot(&relative) / relative.norm_squared().max(1e-30)).clamp(0.0, HORIZON);
        (apart - relative * time).norm()
    }

    #[test]
    fn the_way_out_ends_in_contact_and_none_is_shorter() {
        for index in 0..400 {
            let mut draw = draws(index);
            let (apart, relative) =
                (Vec2::new(4.0 * draw(), 4.0 * draw()), Vec2::new(2.0 * draw(), 2.0 * draw()));
            let reach = 0.3 + 0.2 * draw().abs();
            if apart.norm() < reach + 1e-3 {
                continue;
            }
            let (change, normal) = way_out(apart, relative, reach, 0.02);
            assert!((nearness(apart, relative + change) - reach).abs() < 1e-9, "{index}");
            // Out of the cone where they would meet, into it where they would not.
            let meets = nearness(apart, relative) < reach;
            assert!((change.dot(&normal) > 0.0) == meets || change.norm() < 1e-9, "{index}");
            for k in 0..360 {
                let turn = f64::from(k).to_radians();
                let (sin, cos) = crate::base::math::sin_cos(turn);
                let shorter = Vec2::new(cos, sin) * (change.norm() * 0.999);
                let is_in = nearness(apart, relative + shorter) < reach;
                assert_eq!(is_in, meets, "{index}, {k}");
            }
        }
    }

    #[test]
    fn the_permitted_velocity_is_that_of_a_search_over_all() {
        const MOST: f64 = 1.5;
        let (mut solved, mut broken) = (0, 0);
        for index in 0..200 {
            let mut draw = draws(1000 + index);
            let count = 1 + (4.0 * draw().abs()) as usize + (index % 4) as usize;
            let plane = |x: f64, y: f64, out: f64| {
                let normal = Vec2::new(x, y) / Vec2::new(x, y).norm();
                HalfPlane { rim: normal * out, normal }
            };
            let planes: Vec<HalfPlane> = (0..count).map(|_| plane(draw(), draw(), 0.9 * draw())).collect();
            let preferred = Vec2::new(1.5 * draw(), 1.5 * draw());
            let found = permitted(&planes, preferred, MOST);
            let worst = |v: Vec2| planes.iter().map(|plane| -plane.inside(v)).fold(0.0, f64::max);
            let all = (-300..=300)
                .flat_map(|x| (-300..=300).map(move |y| Vec2::new(f64::from(x), f64::from(y)) * 0.005));
            let all: Vec<Vec2> = all.filter(|v| v.norm() <= MOST).collect();
            let least = all.iter().map(|v| worst(*v)).fold(f64::INFINITY, f64::min);
            assert!(found.norm() <= MOST + 1e-9);
            if least == 0.0 {
                solved += 1;
                let free = all.iter().filter(|v| worst(**v) == 0.0).map(|v| (v - preferred).norm());
                let nearest = free.fold(f64::INFINITY, f64::min);
                assert!(worst(found) < 1e-9, "{index}: {}", worst(found));
                assert!((found - preferred).norm() <= nearest + 1e-9, "{index}");
                assert!((found - preferred).norm() >= nearest - 0.02, "{index}");
            } else if least > 0.02 {
                broken += 1;
                assert!((worst(found) - least).abs() < 0.01, "{index}: {} and {least}", worst(found));
            }
        }
        assert!(solved > 50 && broken > 10, "{solved} {broken}");
    }
}
