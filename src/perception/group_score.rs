//! How well inferred groups agree with annotated ones.

use std::collections::{BTreeMap, BTreeSet};

/// A person moves who is faster than this, m/s.
const MOVING: f64 = 0.5;

/// Agreement of inferred groups with annotated ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct GroupScore {
    /// Annotated groups whose members were all in view at some instant.
    pub annotated: usize,
    /// Those that were one group, or a part of it, in most such instants.
    pub together: usize,
    /// Those that were so in all such instants.
    pub always: usize,
    /// Share of such instants of all annotated groups.
    pub share: f64,
    /// Share of pairs of moving people in one inferred group that are annotated as a group.
    pub precision: f64,
    /// Share of annotated pairs of moving people that are in one inferred group.
    pub recall: f64,
}

/// A person at an instant: id, number of the group, speed in m/s.
pub type Seen = (u32, u64, f64);

/// The agreement over instants with annotated groups of ids.
pub fn score_groups(instants: &[Vec<Seen>], annotated: &[Vec<u32>]) -> GroupScore {
    let mut score = GroupScore::default();
    let mut pairs = BTreeSet::new();
    for group in annotated {
        for (k, a) in group.iter().enumerate() {
            group[k + 1..].iter().for_each(|b| {
                pairs.insert((*a.min(b), *a.max(b)));
            });
        }
    }
    let mut counts = vec![(0_usize, 0_usize); annotated.len()];
    let (mut inferred, mut listed, mut both) = (0_usize, 0_usize, 0_usize);
    for seen in instants {
        let group_of: BTreeMap<u32, u64> = seen.iter().map(|(id, group, _)| (*id, *group)).collect();
        for (members, (instants, together)) in annotated.iter().zip(&mut counts) {
            let found: Option<Vec<u64>> = members.iter().map(|id| group_of.get(id).copied()).collect();
            let Some(found) = found else { continue };
            *instants += 1;
            *together += usize::from(found.windows(2).all(|pair| pair[0] == pair[1]));
        }
        let moving: Vec<&Seen> = seen.iter().filter(|one| one.2 > MOVING).collect();
        for (k, a) in moving.iter().enumerate() {
            for b in &moving[k + 1..] {
                let is_inferred = a.1 == b.1;
                let is_listed = pairs.contains(&(a.0.min(b.0), a.0.max(b.0)));
                inferred += usize::from(is_inferred);
                listed += usize::from(is_listed);
                both += usize::from(is_inferred && is_listed);
            }
        }
    }
    let share = |part: usize, all: usize| if all == 0 { 1.0 } else { part as f64 / all as f64 };
    for &(instants, together) in counts.iter().filter(|count| count.0 > 0) {
        score.annotated += 1;
        score.together += usize::from(2 * together > instants);
        score.always += usize::from(together == instants);
    }
    score.share = share(counts.iter().map(|count| count.1).sum(), counts.iter().map(|count| count.0).sum());
    score.precision = share(both, inferred);
    score.recall = share(both, listed);
    score
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_count_while_they_move() {
        let instants = [
            vec![(1, 1, 1.0), (2, 1, 1.0), (3, 1, 1.0), (4, 2, 0.1)],
            vec![(1, 1, 1.0), (2, 2, 1.0), (3, 3, 1.0)],
            vec![(1, 1, 1.0), (2, 1, 0.0)],
        ];
        let score = score_groups(&instants, &[vec![1, 2], vec![3, 4], vec![8, 9]]);
        assert_eq!((score.annotated, score.together, score.always), (2, 1, 0));
        assert!((score.share - 0.5).abs() < 1e-12);
        assert!((score.precision - 1.0 / 3.0).abs() < 1e-12);
        assert!((score.recall - 0.5).abs() < 1e-12);
    }
}
