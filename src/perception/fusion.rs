//! Observations of one time from several sensors as one list of people.
//!
//! Observations of different sensors that are near in `D_trace` are one person, assigned one to one, at their mean. An
//! id is trusted: equal ids are one person, different ids are not. Two observations of one sensor are one person only
//! where both are at one place.

use super::assignment::assign_some;
use super::near;
use super::trace::distance;
use crate::base::geometry::Vec2;
use crate::data::tracks::{Batch, Observation};
use std::collections::BTreeMap;

/// What is farther apart than any two people.
const NEVER: f64 = 1e9;

/// Two middles that are nearer are those of one person, m.
const ONE_PLACE: f64 = 0.01;

/// One person, seen by one sensor or several.
#[derive(Clone, Debug)]
pub(super) struct Fused {
    /// The mean of all observations.
    pub(super) mean: Observation,
    /// Sums of positions and of known velocities, with their numbers.
    positions: (Vec2, f64),
    velocities: (Vec2, f64),
}

impl Fused {
    fn new(one: &Observation) -> Self {
        let velocities = one.velocity.map_or((Vec2::zeros(), 0.0), |v| (v, 1.0));
        Self { mean: *one, positions: (one.position, 1.0), velocities }
    }

    fn add(&mut self, one: &Observation) {
        self.positions = (self.positions.0 + one.position, self.positions.1 + 1.0);
        if let Some(v) = one.velocity {
            self.velocities = (self.velocities.0 + v, self.velocities.1 + 1.0);
        }
        self.mean.position = self.positions.0 / self.positions.1;
        self.mean.velocity = (self.velocities.1 > 0.0).then(|| self.velocities.0 / self.velocities.1);
        self.mean.id = self.mean.id.or(one.id);
    }
}

/// All people of some batches, and for each batch and observation its person. `within` is the largest distance of two
/// observations of one person, m.
pub(super) fn fuse(batches: &[Batch], within: f64, discount: f64) -> (Vec<Fused>, Vec<Vec<usize>>) {
    let mut people: Vec<Fused> = Vec::new();
    let mut places = Vec::with_capacity(batches.len());
    for batch in batches {
        let known: Vec<Vec2> = people.iter().map(|one| one.mean.position).collect();
        let seen: Vec<Vec2> = batch.seen.iter().map(|one| one.position).collect();
        let cost = |i: usize, j: usize| {
            let (one, other) = (&batch.seen[i], &people[j].mean);
            match (one.id, other.id) {
                (Some(a), Some(b)) => (a == b).then_some(-NEVER),
                _ => {
                    let apart =
                        distance((one.position, one.velocity), (other.position, other.velocity), discount);
                    // Farther than `within`, a pair is as good as none.
                    (apart <= within).then_some(apart - 2.0 * within)
                }
            }
        };
        let of_id: BTreeMap<u32, usize> =
            people.iter().enumerate().filter_map(|(j, one)| Some((one.mean.id?, j))).collect();
        let same = batch.seen.iter().enumerate().filter_map(|(i, one)| Some((i, *of_id.get(&one.id?)?)));
        let near = near::pairs(&seen, &known, within).into_iter();
        let possible: Vec<_> = near.chain(same).filter_map(|(i, j)| Some((i, j, cost(i, j)?))).collect();
        let assigned = assign_some(seen.len(), known.len(), &possible, 0.0);
        let mut twins: Vec<Vec<usize>> = vec![Vec::new(); seen.len()];
        let at_one_place = |(i, j): &(usize, usize)| j < i && (seen[*i] - seen[*j]).norm() <= ONE_PLACE;
        for (i, j) in near::pairs(&seen, &seen, ONE_PLACE).into_iter().filter(at_one_place) {
            twins[i].push(j);
        }
        let mut place: Vec<usize> = Vec::with_capacity(batch.seen.len());
        for (i, (one, assigned)) in batch.seen.iter().zip(assigned).enumerate() {
            // A sensor that reports somebody twice: ids that differ are two people.
            let is_one = |k: &usize| one.id.is_none() || people[*k].mean.id.is_none();
            let twin = twins[i].iter().map(|j| place[*j]).find(is_one);
            let to = assigned.or(twin).unwrap_or(people.len());
            match people.get_mut(to) {
                Some(person) => person.add(one),
                None => people.push(Fused::new(one)),
            }
            place.push(to);
        }
        places.push(place);
    }
    (people, places)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(sensor: &str, seen: &[(f64, Option<u32>)]) -> Batch {
        let one =
            |&(x, id): &(f64, Option<u32>)| Observation { position: Vec2::new(x, 0.0), velocity: None, id };
        Batch { sensor: Some(sensor.to_owned()), seen: seen.iter().map(one).collect(), ..Batch::default() }
    }

    #[test]
    fn near_observations_of_two_sensors_are_one_person_at_the_mean() {
        let (people, places) = fuse(
            &[
                batch("a", &[(0.0, None), (1.0, None)]),
                batch("b", &[(1.2, Some(7)), (5.0, None), (0.9, None)]),
            ],
            0.3,
            2.0,
        );
        assert_eq!(places, [vec![0, 1], vec![2, 3, 1]]);
        assert_eq!(people.len(), 4);
        assert!((people[1].mean.position.x - 0.95).abs() < 1e-12);
    }

    #[test]
    fn ids_are_trusted() {
        let (people, places) = fuse(
            &[batch("a", &[(0.0, Some(1)), (0.1, Some(2))]), batch("b", &[(9.0, Some(1)), (0.1, Some(3))])],
            0.3,
            2.0,
        );
        assert_eq!(places, [vec![0, 1], vec![0, 2]]);
        assert!((people[0].mean.position.x - 4.5).abs() < 1e-12);
        assert_eq!(people.iter().map(|one| one.mean.id).collect::<Vec<_>>(), [Some(1), Some(2), Some(3)]);
        let same_sensor = fuse(&[batch("a", &[(0.0, None), (0.1, None)])], 0.3, 2.0);
        assert_eq!(same_sensor.0.len(), 2);
    }

    #[test]
    fn a_person_whom_a_sensor_reports_twice_is_one() {
        let fused = |seen: &[(f64, Option<u32>)]| fuse(&[batch("a", seen)], 0.3, 2.0);
        assert_eq!(fused(&[(3.0, None), (0.0, None), (3.0, None), (3.001, None)]).1, [[0, 1, 0, 0]]);
        let (people, places) = fused(&[(0.0, None), (0.0, Some(2)), (0.0, Some(7)), (0.0, None)]);
        assert_eq!((places, people[0].mean.id), (vec![vec![0, 0, 1, 0]], Some(2)));
    }
}
