//! Identity of groups over time: which cluster of an instant continues which group.
//!
//! A cluster keeps the number of the group with which it shares most members, if that group shares most with this
//! cluster too; ties go to the larger, then to the lower number. Other clusters are new groups. A group that was joined
//! to another for a single instant gets its number back, as does one whose members were unseen for a while.

use std::collections::{BTreeMap, BTreeSet};

/// A group and its members, by the numbers of their traces, ascending.
type Members = (u64, Vec<u64>);

/// A group that is in no cluster now.
#[derive(Clone, Debug)]
struct Ended {
    group: Members,
    /// Time of the last cluster, s.
    last: f64,
    /// Whether no member was seen when it ended.
    is_unseen: bool,
}

/// Numbers of groups from instant to instant.
#[derive(Clone, Debug)]
pub struct Lineage {
    next: u64,
    current: Vec<Members>,
    ended: Vec<Ended>,
    /// Time of the last instant, s.
    time: f64,
    longest: f64,
}

impl Lineage {
    /// Nobody is known. Groups whose members are unseen for up to `longest`, s, keep their number.
    pub const fn new(longest: f64) -> Self {
        Self { next: 1, current: Vec::new(), ended: Vec::new(), time: 0.0, longest }
    }

    /// The number of the group of each cluster, which lists the numbers of traces; from 1, never used again.
    pub fn step(&mut self, time: f64, clusters: &[Vec<u64>]) -> Vec<u64> {
        let mut numbers = vec![0; clusters.len()];
        let all: Vec<usize> = (0..clusters.len()).collect();
        for (cluster, number) in mutual(clusters, &all, &self.current) {
            numbers[cluster] = number;
        }
        self.ended.retain(|ended| !ended.is_unseen || (time - ended.last).abs() <= self.longest);
        let open: Vec<usize> = all.into_iter().filter(|k| numbers[*k] == 0).collect();
        let revived: Vec<Members> = self.ended.iter().map(|ended| ended.group.clone()).collect();
        for (cluster, number) in mutual(clusters, &open, &revived) {
            numbers[cluster] = number;
        }
        for number in numbers.iter_mut().filter(|number| **number == 0) {
            *number = self.next;
            self.next += 1;
        }
        let before = std::mem::take(&mut self.current);
        let last = self.time;
        let seen: BTreeSet<u64> = clusters.iter().flatten().copied().collect();
        self.ended.retain(|ended| ended.is_unseen && !numbers.contains(&ended.group.0));
        for group in before.into_iter().filter(|group| !numbers.contains(&group.0)) {
            let is_unseen = group.1.iter().all(|member| !seen.contains(member));
            self.ended.push(Ended { group, last, is_unseen });
        }
        self.current = numbers.iter().copied().zip(clusters.iter().cloned()).collect();
        self.time = time;
        numbers
    }
}

/// Pairs of a cluster and the number of a group that share most members with each other.
fn mutual(clusters: &[Vec<u64>], open: &[usize], groups: &[Members]) -> Vec<(usize, u64)> {
    let mut group_of = BTreeMap::<u64, Vec<usize>>::new();
    for (g, (_, members)) in groups.iter().enumerate() {
        for member in members {
            group_of.entry(*member).or_default().push(g);
        }
    }
    let mut shared = BTreeMap::<(usize, usize), usize>::new();
    for &c in open {
        for g in clusters[c].iter().filter_map(|member| group_of.get(member)).flatten() {
            *shared.entry((c, *g)).or_default() += 1;
        }
    }
    // The best so far of each side: number of shared members, size; the lower number stays on a tie.
    let mut best_group = BTreeMap::<usize, (usize, usize, std::cmp::Reverse<u64>, usize)>::new();
    let mut best_cluster = BTreeMap::<usize, (usize, usize, std::cmp::Reverse<usize>)>::new();
    for (&(c, g), &count) in &shared {
        let group = (count, groups[g].1.len(), std::cmp::Reverse(groups[g].0), g);
        best_group.entry(c).and_modify(|best| *best = group.max(*best)).or_insert(group);
        let cluster = (count, clusters[c].len(), std::cmp::Reverse(c));
        best_cluster.entry(g).and_modify(|best| *best = cluster.max(*best)).or_insert(cluster);
    }
    best_group
        .into_iter()
        .filter(|(c, (.., g))| best_cluster.get(g).is_some_and(|best| best.2.0 == *c))
        .map(|(c, (_, _, number, _))| (c, number.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_keeps_its_number_with_most_of_its_members() {
        let mut lineage = Lineage::new(2.0);
        assert_eq!(lineage.step(0.0, &[vec![1, 2, 3], vec![4]]), [1, 2]);
        assert_eq!(lineage.step(0.4, &[vec![1], vec![2, 3], vec![4]]), [3, 1, 2], "split");
        assert_eq!(lineage.step(0.8, &[vec![1, 4], vec![2, 3]]), [2, 1], "the lower of equal ones is kept");
        assert_eq!(lineage.step(1.2, &[vec![1, 2, 3, 4]]), [1], "of equal shares");
        assert_eq!(lineage.step(1.6, &[vec![1, 4], vec![2, 3]]), [1, 4], "a tie goes to the first cluster");
    }

    #[test]
    fn numbers_come_back_after_an_instant() {
        let mut lineage = Lineage::new(2.0);
        assert_eq!(lineage.step(0.0, &[vec![1], vec![2]]), [1, 2]);
        assert_eq!(lineage.step(0.4, &[vec![1, 2]]), [1]);
        assert_eq!(lineage.step(0.8, &[vec![1], vec![2]]), [1, 2]);
        assert_eq!(lineage.step(1.2, &[vec![1, 2]]), [1]);
        assert_eq!(lineage.step(1.6, &[vec![1, 2]]), [1]);
        assert_eq!(lineage.step(2.0, &[vec![1], vec![2]]), [1, 3], "two instants are a merger");
        assert_eq!(lineage.step(2.4, &[vec![1]]), [1]);
        assert_eq!(lineage.step(3.6, &[vec![1], vec![2]]), [1, 3], "unseen for a while");
        assert_eq!(lineage.step(4.0, &[vec![1]]), [1]);
        assert_eq!(lineage.step(8.0, &[vec![1], vec![2]]), [1, 4]);
    }
}
