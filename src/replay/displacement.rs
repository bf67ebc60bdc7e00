//! How far predicted ways are from the way that was recorded.
//!
//! The average displacement error (ADE) is the mean distance over the times of a way, the final one (FDE) the distance at
//! its end (Pellegrini, Ess, Schindler, Van Gool 2009; Alahi et al. 2016).

use crate::base::geometry::Vec2;

/// Distances of predicted ways from the recorded one, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// Id of the person.
    pub person: u32,
    /// Average distance of the mean way.
    pub average: f64,
    /// Distance of its end.
    pub last: f64,
    /// Least average distance of the first 20 ways.
    pub best_average: f64,
    /// Least distance of the ends of the first 20 ways.
    pub best_last: f64,
    /// Share of the ways on which the person touches somebody who was recorded.
    pub collisions: f64,
}

impl Displacement {
    /// How many ways the best one is taken from.
    pub const BEST_OF: usize = 20;

    /// Of some ways from the recorded one, all of one length; `others` are the centres of all others at each of its times, and
    /// bodies touch where centres are nearer than `reach`, m. `None` without any whole way.
    pub fn of(
        person: u32,
        ways: &[Vec<Vec2>],
        recorded: &[Vec2],
        (others, reach): (&[Vec<Vec2>], f64),
    ) -> Option<Self> {
        let whole: Vec<&[Vec2]> =
            ways.iter().filter(|way| way.len() == recorded.len()).map(Vec::as_slice).collect();
        let count = whole.len() as f64;
        let mean: Vec<Vec2> =
            (0..recorded.len()).map(|k| whole.iter().map(|way| way[k]).sum::<Vec2>() / count).collect();
        if whole.is_empty() || recorded.is_empty() {
            return None;
        }
        let distances = |way: &[Vec2]| {
            let all: Vec<f64> = way.iter().zip(recorded).map(|(a, b)| (a - b).norm()).collect();
            (all.iter().sum::<f64>() / all.len() as f64, all.last().copied().unwrap_or(0.0))
        };
        let best = |of: fn((f64, f64)) -> f64| {
            let all = whole.iter().take(Self::BEST_OF).map(|way| of(distances(way)));
            all.fold(f64::INFINITY, |least, one| if one < least { one } else { least })
        };
        let touches = |way: &&&[Vec2]| {
            let near = |(own, all): (&Vec2, &Vec<Vec2>)| all.iter().any(|other| (other - own).norm() < reach);
            way.iter().zip(others).any(near)
        };
        let (average, last) = distances(&mean);
        Some(Self {
            person,
            average,
            last,
            best_average: best(|(average, _)| average),
            best_last: best(|(_, last)| last),
            collisions: whole.iter().filter(touches).count() as f64 / count,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_of_the_mean_and_of_the_best() {
        let line = |y: f64| (1..=3).map(|k| Vec2::new(f64::from(k), y * f64::from(k))).collect::<Vec<_>>();
        let others = vec![Vec::new(), Vec::new(), vec![Vec2::new(3.0, 3.1)]];
        let ways = [line(1.0), line(-1.0), vec![Vec2::zeros()]];
        let found = Displacement::of(7, &ways, &line(0.5), (&others, 0.2)).unwrap();
        assert_eq!((found.average, found.last), (1.0, 1.5), "the mean way is straight");
        assert_eq!((found.best_average, found.best_last), (1.0, 1.5));
        assert_eq!(found.collisions, 0.5, "a way that ended early does not count");
        assert_eq!(Displacement::of(7, &[], &line(0.5), (&others, 0.2)), None);
    }
}
