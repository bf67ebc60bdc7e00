//! From the corners of a path to a trajectory: rounding, a speed profile, and the samples that the kernel follows.

use crate::base::geometry::Vec2;
use crate::kernel::driver::{Sample, Trajectory};
use crate::model::parameter::FEWEST_PIECES;
use crate::model::planner::RoundingRule;
use crate::model::{Parameter, Sight, SpeedRule};
use crate::route::path::{Path, round_by, shortcut};
use crate::route::profile::{
    Infeasible, Law, Limits, Motion, Optimum, Stretch, Varied, Variety, optimal, varied,
};

/// Least share of the largest u that a varied profile draws.
const FLOOR: f64 = 0.1;
/// Longest time between two samples of a trajectory, s.
const STEP: f64 = 0.25;
/// Samples are at least so far apart, s.
const APART: f64 = 1e-6;
/// An end speed that is too large is taken down to the largest one, a little less for rounding.
const LESS: f64 = 1.0 - 1e-9;
/// How often the radius of corners is halved until a path passes near enough by its goals.
const HALVINGS: u32 = 5;
/// Times at which a course is checked.
const CHECKED: u32 = 2000;

/// What a walker can do and wants, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// Limits of speed and acceleration.
    pub limits: Limits,
    /// Preferred speed, m/s.
    pub preferred: f64,
    /// Standard deviation of speeds around it, as a share.
    pub spread: f64,
    /// Number of pieces; below 2, for each metre.
    pub pieces: f64,
    /// Largest turning radius, m.
    pub corner: f64,
    /// Radius of the body, m.
    pub radius: f64,
    /// How speeds come about.
    pub rule: SpeedRule,
    /// How much of an edge an arc may take.
    pub rounding: RoundingRule,
}

/// A path with the speeds along it.
#[derive(Clone, Debug)]
pub struct Course {
    /// The path.
    pub path: Path,
    /// The fastest profile.
    pub optimum: Optimum,
    /// The varied one, if it is that which is walked.
    pub varied: Option<Varied>,
}

/// How many pieces a path of a length, m, has, with so many for each metre.
pub fn pieces_of(per_metre: f64, length: f64) -> usize {
    (per_metre * length).round().clamp(2.0, 64.0) as usize
}

/// A path as a profile sees it.
pub fn stretches(path: &Path) -> Vec<Stretch> {
    path.pieces().iter().map(|piece| Stretch { length: piece.length(), radius: piece.radius() }).collect()
}

/// The fastest profile of a path; a start speed that is too large is taken down.
fn fastest(stretches: &[Stretch], limits: Limits, start: f64) -> Result<(Optimum, f64), Infeasible> {
    match optimal(stretches, limits, start, 0.0) {
        Ok(optimum) => Ok((optimum, start)),
        Err(Infeasible::Start { largest, .. }) => {
            let start = largest * LESS;
            optimal(stretches, limits, start, 0.0).map(|optimum| (optimum, start))
        }
        Err(other) => Err(other),
    }
}

impl Speeds {
    /// Of somebody with these parameters, whose own preferred speed is `own`, m/s.
    pub fn new(of: impl Fn(Parameter) -> f64, own: f64, rule: SpeedRule) -> Self {
        let limit = of(Parameter::LimitSpeed);
        Self {
            limits: Limits {
                speed: limit,
                along: of(Parameter::LimitAlong),
                across: of(Parameter::LimitAcross),
            },
            preferred: own.min(limit),
            spread: of(Parameter::Spread),
            pieces: of(Parameter::Pieces),
            corner: of(Parameter::Corner),
            radius: of(Parameter::Radius),
            rule,
            rounding: RoundingRule::default(),
        }
    }

    /// The number of pieces of a path of a length, m.
    fn pieces(&self, length: f64) -> usize {
        let is_whole = self.pieces >= FEWEST_PIECES;
        if is_whole { self.pieces as usize } else { pieces_of(self.pieces, length) }
    }

    /// The corners of a path without those that only make it longer: shortcuts are free lines. The shortened path is taken if
    /// it is also faster, and passes obstacles on the same sides if `is_same` says that this matters.
    pub fn straightened(
        &self,
        corners: Vec<Vec2>,
        sight: &Sight,
        is_free: impl Fn(Vec2, Vec2) -> bool,
        is_same: impl Fn(&[Vec2]) -> bool,
    ) -> Vec<Vec2> {
        let length = |points: &[Vec2]| -> f64 {
            if is_same(points) {
                points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
            } else {
                f64::INFINITY
            }
        };
        let short = shortcut(&corners, is_free, length);
        if short.len() == corners.len() {
            return corners;
        }
        let time = |points: &[Vec2]| {
            let path = round_by(points, (self.corner, self.rounding), self.radius, sight);
            fastest(&stretches(&path), self.limits, 0.0)
                .map_or(f64::INFINITY, |(optimum, _)| optimum.duration())
        };
        if time(&short) <= time(&corners) { short } else { corners }
    }

    /// The course along some corners, from a velocity; `goals` are points that it must pass within the radius of the body.
    pub fn course(
        &self,
        corners: &[Vec2],
        goals: &[Vec2],
        sight: &Sight,
        velocity: Vec2,
        draw: impl FnMut(u32) -> [f64; 2],
    ) -> Result<Course, Infeasible> {
        let mut corner = self.corner;
        let mut path = round_by(corners, (corner, self.rounding), self.radius, sight);
        for _ in 0..HALVINGS {
            if goals.iter().all(|goal| path.nearest(*goal).1 <= self.radius) {
                break;
            }
            corner *= 0.5;
            path = round_by(corners, (corner, self.rounding), self.radius, sight);
        }
        let stretches = stretches(&path);
        let ahead = velocity.dot(&path.at(0.0).direction).max(0.0).min(self.limits.speed);
        let (optimum, start) = fastest(&stretches, self.limits, ahead)?;
        let law = match self.rule {
            SpeedRule::Optimal => None,
            SpeedRule::Uniform => Some(Law::Uniform),
            SpeedRule::Varied => Some(Law::Preferred { speed: self.preferred, spread: self.spread }),
        };
        let varied = law.and_then(|law| {
            let variety = Variety { pieces: self.pieces(path.length()), floor: FLOOR, law };
            // Where the start speed leaves no choice the fastest profile is the only one.
            varied(&stretches, self.limits, start, 0.0, &variety, draw).ok()
        });
        Ok(Course { path, optimum, varied })
    }
}

impl Course {
    /// Its path as a profile sees it.
    pub fn stretches(&self) -> Vec<Stretch> {
        stretches(&self.path)
    }

    /// Whether it keeps limits, looked at on a dense grid: of speed, and of acceleration along and across its path.
    pub fn is_legal(&self, limits: Limits) -> bool {
        let slack = 1.0 + 1e-9;
        let stretches = self.stretches();
        let mut start = 0.0;
        let mut ends: Vec<(f64, f64)> = Vec::with_capacity(stretches.len());
        for stretch in stretches {
            start += stretch.length;
            ends.push((start, stretch.radius));
        }
        (0..=CHECKED).all(|k| {
            let motion = self.motion(self.duration() * f64::from(k) / f64::from(CHECKED));
            // At a joint the wider one of both stretches counts: there the other one begins or ends.
            let near = |end: f64| (motion.distance - end).abs() < 1e-9;
            let at =
                ends.partition_point(|(end, _)| *end <= motion.distance).min(ends.len().saturating_sub(1));
            let radius = ends.get(at).map_or(f64::INFINITY, |(_, radius)| *radius);
            let is_joint = ends.iter().any(|(end, _)| near(*end));
            let (along, across) =
                (motion.acceleration / limits.along, motion.speed * motion.speed / (radius * limits.across));
            motion.speed <= limits.speed * slack && (is_joint || along * along + across * across <= slack)
        })
    }

    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.varied.as_ref().map_or_else(|| self.optimum.duration(), Varied::duration)
    }

    /// Distance, speed and acceleration along the path at a time, s.
    pub fn motion(&self, time: f64) -> Motion {
        self.varied.as_ref().map_or_else(|| self.optimum.motion(time), |varied| varied.motion(time))
    }

    /// When a distance along the path is reached, s.
    fn time_at(&self, distance: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.duration());
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            if self.motion(middle).distance < distance { low = middle } else { high = middle }
        }
        high
    }

    /// Position, velocity and time at so many places that cubic pieces between them are within a millimetre of the course.
    pub fn samples(&self) -> Vec<Sample> {
        let duration = self.duration();
        let knots = self.varied.iter().flat_map(|varied| varied.knots().iter().map(|(x, _)| *x));
        let mut places: Vec<f64> = self.path.joints().iter().copied().chain(knots).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| *a - *b < 1e-9);
        let mut times = vec![0.0];
        for time in places.into_iter().map(|place| self.time_at(place)).chain([duration]) {
            let before = times.last().copied().unwrap_or(0.0);
            if time - before <= APART {
                continue;
            }
            let count = ((time - before) / STEP).ceil();
            times.extend((1..=count as u32).map(|k| before + (time - before) * f64::from(k) / count));
        }
        let sample = |time: f64| {
            let motion = self.motion(time);
            let place = self.path.at(motion.distance);
            Sample { time, position: place.position, velocity: place.direction * motion.speed }
        };
        times.into_iter().map(sample).collect()
    }

    /// The trajectory; `None` of a course that goes nowhere.
    pub fn trajectory(&self) -> Option<Trajectory> {
        Trajectory::through(&self.samples())
    }
}
