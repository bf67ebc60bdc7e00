//! The groups of people who are seen at an instant, as compilation asks for them.

use crate::base::geometry::Vec2;
use crate::base::random::TrialKey;
use crate::compile::Sighting;
use crate::perception::{Clustering, clusters};

/// Key of the draws: groups depend on nothing but who is seen, so a check and an adviser find the same ones.
const KEY: TrialKey = TrialKey { seed: 0, index: 0, branch: 0 };

/// The groups of people who are seen at an instant by Algorithm 3; each of ascending ids, in the order of the first.
pub fn groups(people: &[Sighting]) -> Vec<Vec<u32>> {
    groups_until(people, &|| false)
}

/// The groups as far as time allows; whoever is left over is alone.
pub(super) fn groups_until(people: &[Sighting], is_over: &dyn Fn() -> bool) -> Vec<Vec<u32>> {
    let points: Vec<(Vec2, Option<Vec2>)> =
        people.iter().map(|one| (one.position, Some(one.velocity))).collect();
    let found = clusters(&points, &Clustering::default(), KEY, 0, is_over);
    found.into_iter().map(|group| group.into_iter().map(|k| people[k].id).collect()).collect()
}
