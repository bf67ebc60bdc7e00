//! The state of a motion at one time.

/// The state of a motion along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Distance from the start of the path, m.
    pub distance: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Acceleration along the path, m/s^2.
    pub acceleration: f64,
}
