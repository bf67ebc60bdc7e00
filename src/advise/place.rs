//! Advice for the group fitted to a member of it (Given-Wilson et al. 2017, section 4.3: whoever is on the fringe is guided to
//! rejoin). The paper gives no formula. Here a group of n, of which each has half a metre on a side, has the
//! half-width (n - 1)/2 m; whoever is inside keeps the place, and whoever is outside is shown to its rim.

use super::advice::Place;
use crate::base::geometry::{Vec2, cross};

/// cos 45° and sin 45°: the shown direction is at most so far off the group's.
const MOST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A member's part of the advice for a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fitted {
    /// Where to go, a unit vector; `None` where the group stands.
    pub(super) direction: Option<Vec2>,
    pub(super) place: Place,
    /// Direction to the middle of the group, from its fringe.
    pub(super) rejoin: Option<Vec2>,
}

/// Fits the advised velocity of a group of `count` around `middle` to a member; the advice holds for `seconds`.
pub(super) fn fit(member: Vec2, (middle, count): (Vec2, usize), velocity: Vec2, seconds: f64) -> Fitted {
    let half = 0.5 * (count.max(1) - 1) as f64;
    let aside = member - middle;
    let distance = aside.norm();
    let is_outside = distance > half;
    let share = if is_outside { half / distance } else { 1.0 };
    let place = middle + velocity * seconds + aside * share;
    Fitted {
        direction: unit(velocity).map(|ahead| within(ahead, unit(place - member).unwrap_or(ahead))),
        place: if is_outside { Place::Fringe } else { Place::Inside },
        rejoin: if is_outside { unit(-aside) } else { None },
    }
}

/// A direction, turned towards another until it is at most 45° off.
fn within(ahead: Vec2, wanted: Vec2) -> Vec2 {
    if ahead.dot(&wanted) >= MOST {
        return wanted;
    }
    let side = if cross(ahead, wanted) >= 0.0 { 1.0 } else { -1.0 };
    (ahead + Vec2::new(-ahead.y, ahead.x) * side) * MOST
}

pub(super) fn unit(v: Vec2) -> Option<Vec2> {
    let length = v.norm();
    (length > 1e-9).then(|| v / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_keeps_its_place_and_the_fringe_is_led_back() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let inside = fit(p(0.5, 0.0), (p(0.0, 0.0), 3), p(0.0, 1.0), 2.0);
        assert_eq!((inside.place, inside.rejoin), (Place::Inside, None));
        assert!((inside.direction.unwrap() - p(0.0, 1.0)).norm() < 1e-12);
        // A group of three is 1 m wide to a side: from 3 m aside and on to 2 m ahead is 45°.
        let fringe = fit(p(3.0, 0.0), (p(0.0, 0.0), 3), p(0.0, 1.0), 2.0);
        assert_eq!((fringe.place, fringe.rejoin), (Place::Fringe, Some(p(-1.0, 0.0))));
        assert!((fringe.direction.unwrap() - p(-MOST, MOST)).norm() < 1e-12);
        // Never more, however far.
        let far = fit(p(-9.0, -1.0), (p(0.0, 0.0), 3), p(0.0, 1.0), 0.4).direction.unwrap();
        assert!((far - p(MOST, MOST)).norm() < 1e-12, "{far}");
        assert_eq!(fit(p(1.0, 0.0), (p(0.0, 0.0), 2), p(0.0, 0.0), 1.0).direction, None);
        // Alone: there is no place but the own one.
        let alone = fit(p(1.0, 0.0), (p(1.0, 0.0), 1), p(0.6, 0.8), 1.0);
        assert!((alone.direction.unwrap() - p(0.6, 0.8)).norm() < 1e-12 && alone.place == Place::Inside);
    }
}
