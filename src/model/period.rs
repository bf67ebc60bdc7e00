//! A plane that closes on itself along an axis, as in simulations with periodic boundaries: what leaves at one end comes in at
//! the other. Of two places the nearest images count (the minimum image convention).

use crate::base::geometry::Vec2;

/// Where an axis begins, and after which length it begins again, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// The least coordinate.
    pub low: f64,
    /// How far the largest one is from it; that one is the least again.
    pub length: f64,
}

/// The periods of a scene; it is open along an axis without one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Periods {
    /// Along the first axis.
    pub x: Option<Period>,
    /// Along the second axis.
    pub y: Option<Period>,
}

impl Period {
    /// The largest coordinate, m.
    pub fn high(&self) -> f64 {
        self.low + self.length
    }

    /// The image of a coordinate from the least on, up to and without the largest.
    pub fn wrap(&self, v: f64) -> f64 {
        let v = v - self.length * ((v - self.low) * (1.0 / self.length)).floor();
        // Rounding may lead to the end or a hair below the beginning.
        if v < self.low || v >= self.high() { self.low } else { v }
    }

    /// The way to the nearest image, for the way to any.
    pub fn way(&self, d: f64) -> f64 {
        d - self.length * (d * (1.0 / self.length)).round()
    }
}

impl Periods {
    /// Whether no axis has a period.
    pub const fn are_none(&self) -> bool {
        self.x.is_none() && self.y.is_none()
    }

    /// The image of a place that lies in the scene.
    pub fn wrap(&self, p: Vec2) -> Vec2 {
        let wrap = |period: Option<Period>, v: f64| period.map_or(v, |period| period.wrap(v));
        Vec2::new(wrap(self.x, p.x), wrap(self.y, p.y))
    }

    /// The way to the nearest image, for the way to any.
    pub fn way(&self, d: Vec2) -> Vec2 {
        let way = |period: Option<Period>, d: f64| period.map_or(d, |period| period.way(d));
        Vec2::new(way(self.x, d.x), way(self.y, d.y))
    }

    /// Whether a place lies in the scene, or beyond its ends by no more than `beyond`, m.
    pub fn hold(&self, p: Vec2, beyond: f64) -> bool {
        let holds = |period: Option<Period>, v: f64| {
            period.is_none_or(|period| period.low - beyond <= v && v <= period.high() + beyond)
        };
        holds(self.x, p.x) && holds(self.y, p.y)
    }

    /// How far images are from a place: itself first, then those one period away along each axis.
    pub fn images(&self) -> Vec<Vec2> {
        let along = |period: Option<Period>| match period {
            Some(Period { length, .. }) => vec![0.0, -length, length],
            None => vec![0.0],
        };
        let (x, y) = (along(self.x), along(self.y));
        y.iter().flat_map(|&y| x.iter().map(move |&x| Vec2::new(x, y))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_lie_in_the_period_and_ways_are_the_shortest() {
        let periods = Periods { x: Some(Period { low: -3.0, length: 7.3 }), y: None };
        for k in -400..400 {
            let p = Vec2::new(f64::from(k) * 0.137, 1.0);
            let image = periods.wrap(p);
            assert!((-3.0..4.3).contains(&image.x) && image.y == 1.0, "{image}");
            let laps = (p.x - image.x) / 7.3;
            assert!((laps - laps.round()).abs() < 1e-12);
            let nearest = (-20..20).map(|k| (p.x + f64::from(k) * 7.3).abs()).fold(f64::INFINITY, f64::min);
            assert!((periods.way(p).x.abs() - nearest).abs() < 1e-12);
        }
        assert_eq!(periods.wrap(Vec2::new(-3.0 - 1e-18, 0.0)).x, -3.0);
        assert_eq!(periods.wrap(Vec2::new(4.3, 0.0)).x, -3.0);
        assert_eq!(periods.images().len(), 3);
    }
}
