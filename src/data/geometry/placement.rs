//! Where a drawing lies in the scene: its unit, its projection and its origin, and whether they can be right.

use super::feature::{Feature, Geometry};
use crate::base::geometry::{Bounds, Vec2};
use crate::base::math::sin_cos;

/// Equatorial radius of the WGS 84 ellipsoid, m, and the square of its eccentricity.
const EQUATOR: f64 = 6_378_137.0;
const ECCENTRICITY: f64 = 6.694_379_990_14e-3;
/// A degree, rad.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// A drawing that is larger is no building, m.
const LARGEST: f64 = 2e4;
/// Several features, or one, of a drawing in a unit of its own that are smaller are no building, m.
const SMALLEST: [f64; 2] = [1.0, 0.2];
/// A drawing whose coordinates reach less far is in degrees.
const DEGREES: f64 = 0.05;
/// A wider door is no door, m.
const WIDEST_DOOR: f64 = 50.0;
/// Farther from the origin, coordinates are those of a map, m.
const FARTHEST: f64 = 1e5;
/// A drawing that is wider is not in degrees.
const WIDEST_DEGREES: f64 = 1.0;
/// Origins are suggested in whole multiples of this, m.
const ROUND: f64 = 10.0;
/// Units that drawings are made in, with metres per unit.
const UNITS: [(&str, f64); 3] = [("1 mm", 1e-3), ("1 cm", 1e-2), ("1 m", 1.0)];

/// How the coordinates of a drawing become metres of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// The drawing is plane.
    Plane {
        /// Metres per unit.
        unit: f64,
        /// Its point that becomes the origin of the scene, m.
        origin: Vec2,
        /// Whether the unit comes from the file or the scenario; else the drawing may be in degrees.
        is_stated: bool,
    },
    /// Coordinates are longitude and latitude; metres to the east and the north of a point, degrees.
    Local(Vec2),
}

/// Why a drawing cannot lie where its coordinates say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The coordinates look like degrees.
    Degrees,
    /// A coordinate is no longitude or latitude.
    NoDegrees(Vec2),
    /// The latitude comes first.
    Swapped,
    /// The drawing is too large or too small for a building.
    Extent {
        /// The longer side of the rectangle around it, m.
        size: f64,
        /// The unit in which it would be plausible.
        fits: Option<&'static str>,
    },
    /// The narrowest door is too wide.
    Door {
        /// Its width, m.
        width: f64,
        /// The unit in which it would be plausible.
        fits: Option<&'static str>,
    },
    /// Coordinates are those of a map; the origin that brings them near.
    Far(Vec2),
}

/// The rectangle around features.
fn bounds(features: &[Feature]) -> Option<Bounds> {
    Bounds::around(features.iter().flat_map(|feature| feature.shape.corners()))
}

/// The middle of the rectangle around features.
pub fn middle(features: &[Feature]) -> Option<Vec2> {
    bounds(features).map(|around| 0.5 * (around.low + around.high))
}

/// The unit in which a length of a drawing lies in a range, m.
fn fitting(raw: f64, low: f64, high: f64) -> Option<&'static str> {
    UNITS.iter().find(|(_, unit)| (low..=high).contains(&(raw * unit))).map(|(name, _)| *name)
}

impl Placement {
    /// Metres per unit of lengths that are not coordinates.
    pub fn unit(&self) -> f64 {
        match self {
            Self::Plane { unit, .. } => *unit,
            Self::Local(_) => 1.0,
        }
    }

    /// Gives features their places in the scene.
    ///
    /// # Errors
    /// Coordinates that cannot be meant so.
    pub fn place(&self, features: &mut [Feature]) -> Result<(), Fault> {
        let Some(before) = bounds(features) else { return Ok(()) };
        let reach = |bounds: &Bounds| {
            let size = bounds.high - bounds.low;
            if size.x > size.y { size.x } else { size.y }
        };
        match *self {
            Self::Plane { unit, origin, is_stated } => {
                let has_lines = features.iter().any(|feature| !matches!(feature.shape, Geometry::Point(_)));
                if !is_stated && has_lines && reach(&before) < DEGREES {
                    return Err(Fault::Degrees);
                }
                for feature in features.iter_mut() {
                    feature.shape.map(|p| p * unit - origin, unit);
                }
            }
            Self::Local(middle) => {
                let is_degrees = |p: Vec2| p.x.abs() <= 180.0 && p.y.abs() < 90.0;
                let scale = metres_per_degree(middle.y);
                let centre = 0.5 * (before.low + before.high);
                let far = |p: Vec2| (p - middle).component_mul(&scale).norm();
                let is_swapped = if is_degrees(centre) {
                    far(centre.yx()) < FARTHEST && far(centre) > FARTHEST
                } else {
                    is_degrees(centre.yx()) && reach(&before) < WIDEST_DEGREES
                };
                if is_swapped {
                    return Err(Fault::Swapped);
                }
                if let Some(wrong) = [before.low, before.high, middle].into_iter().find(|p| !is_degrees(*p)) {
                    return Err(Fault::NoDegrees(wrong));
                }
                for feature in features.iter_mut() {
                    feature.shape.map(|p| (p - middle).component_mul(&scale), 1.0);
                }
            }
        }
        let Some(after) = bounds(features) else { return Ok(()) };
        let size = reach(&after);
        let smallest = SMALLEST[usize::from(features.len() == 1)];
        let is_small = matches!(self, Self::Plane { is_stated: true, .. }) && 0.0 < size && size < smallest;
        if size > LARGEST || is_small {
            let fits = fitting(size / self.unit(), 2.0, 2e3);
            return Err(Fault::Extent { size, fits });
        }
        if [after.low, after.high].iter().any(|p| p.x.abs() > FARTHEST || p.y.abs() > FARTHEST) {
            return Err(Fault::Far(match *self {
                Self::Plane { origin, .. } => (after.low + origin).map(|x| (x / ROUND).floor() * ROUND),
                Self::Local(_) => 0.5 * (before.low + before.high),
            }));
        }
        Ok(())
    }

    /// Whether the narrowest of some doors can be one. Widths in metres.
    ///
    /// # Errors
    /// Its width and the unit that would fit.
    pub fn check_doors(&self, widths: impl Iterator<Item = f64>) -> Result<(), Fault> {
        match widths.reduce(|a, b| if a < b { a } else { b }) {
            Some(width) if width > WIDEST_DOOR => {
                let fits = fitting(width / self.unit(), 0.5, 5.0);
                Err(Fault::Door { width, fits })
            }
            _ => Ok(()),
        }
    }
}

/// Metres per degree of longitude and of latitude at a latitude, on the ellipsoid.
fn metres_per_degree(latitude: f64) -> Vec2 {
    let (sin, cos) = sin_cos(latitude * DEGREE);
    let bend = 1.0 - ECCENTRICITY * sin * sin;
    let across = EQUATOR / bend.sqrt();
    let along = across * (1.0 - ECCENTRICITY) / bend;
    Vec2::new(across * cos, along) * DEGREE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_has_the_length_of_the_tables() {
        // Lengths of a degree on WGS 84, m.
        for (latitude, east, north) in
            [(0.0, 111_319.5, 110_574.3), (45.0, 78_846.8, 111_131.8), (60.0, 55_800.0, 111_412.2)]
        {
            let found = metres_per_degree(latitude);
            assert!((found - Vec2::new(east, north)).norm() < 1.0, "{latitude}: {found}");
        }
    }

    #[test]
    fn a_unit_that_fits_is_named() {
        assert_eq!(fitting(60_000.0, 2.0, 2e3), Some("1 mm"));
        assert_eq!(fitting(60.0, 2.0, 2e3), Some("1 m"));
        assert_eq!(fitting(90.0, 0.5, 5.0), Some("1 cm"));
        assert_eq!(fitting(1e12, 2.0, 2e3), None);
    }
}
