//! Lives of groups: from when to when, how each began and ended, and who belonged to it.
//!
//! Changes of a single instant are ignored: a trace that is in another group once, and back at its next point, never
//! left.

use std::collections::BTreeMap;

/// How a group began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Birth {
    /// Its first members were in no group before.
    Appear,
    /// Its first members left this group, or most of them did.
    Split(u64),
}

/// How a group ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Death {
    /// Its last members were in no group later.
    Leave,
    /// Its last members, or most of them, went over to this group.
    Merge(u64),
}

/// A trace in a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membership {
    /// Number of the trace.
    pub trace: u64,
    /// First time, s.
    pub from: f64,
    /// Last time, s.
    pub to: f64,
}

/// A group over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its number.
    pub number: u64,
    /// First time, s.
    pub from: f64,
    /// Last time, s.
    pub to: f64,
    /// How it began.
    pub born: Birth,
    /// How it ended.
    pub ended: Death,
    /// Its members, by time and trace; one who returns is there twice.
    pub members: Vec<Membership>,
}

/// The groups of a trace: time, s, and number of the group at each of its points.
pub type Series = Vec<(f64, u64)>;

/// Takes out changes of a single instant.
pub fn smooth(series: &mut BTreeMap<u64, Series>) {
    for points in series.values_mut() {
        for k in 1..points.len().saturating_sub(1) {
            if points[k - 1].1 == points[k + 1].1 {
                points[k].1 = points[k - 1].1;
            }
        }
    }
}

/// The lives of all groups in the series of each trace, by ascending number.
pub fn lives(series: &BTreeMap<u64, Series>) -> Vec<Group> {
    /// A membership with the groups before and after it.
    struct Stay {
        membership: Membership,
        before: Option<u64>,
        after: Option<u64>,
    }
    let mut stays = BTreeMap::<u64, Vec<Stay>>::new();
    for (&trace, points) in series {
        let runs: Vec<&[(f64, u64)]> = points.chunk_by(|a, b| a.1 == b.1).collect();
        for (k, run) in runs.iter().enumerate() {
            let membership = Membership { trace, from: run[0].0, to: run[run.len() - 1].0 };
            let before = k.checked_sub(1).map(|k| runs[k][0].1);
            let after = runs.get(k + 1).map(|next| next[0].1);
            stays.entry(run[0].1).or_default().push(Stay { membership, before, after });
        }
    }
    let group = |(number, mut stays): (u64, Vec<Stay>)| {
        let from = stays.iter().map(|stay| stay.membership.from).fold(f64::INFINITY, f64::min);
        let to = stays.iter().map(|stay| stay.membership.to).fold(f64::NEG_INFINITY, f64::max);
        let first = stays.iter().filter(|stay| stay.membership.from == from).filter_map(|stay| stay.before);
        let last = stays.iter().filter(|stay| stay.membership.to == to).filter_map(|stay| stay.after);
        let born = most(first).map_or(Birth::Appear, Birth::Split);
        let ended = most(last).map_or(Death::Leave, Death::Merge);
        stays.sort_by(|a, b| a.membership.from.total_cmp(&b.membership.from));
        let members = stays.iter().map(|stay| stay.membership).collect();
        Group { number, from, to, born, ended, members }
    };
    stays.into_iter().map(group).collect()
}

/// The most frequent number, the lowest of equally frequent ones.
fn most(numbers: impl Iterator<Item = u64>) -> Option<u64> {
    let mut counts = BTreeMap::<u64, usize>::new();
    numbers.for_each(|number| *counts.entry(number).or_default() += 1);
    counts
        .into_iter()
        .max_by_key(|&(number, count)| (count, std::cmp::Reverse(number)))
        .map(|(number, _)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(groups: &[(u64, &[u64])]) -> BTreeMap<u64, Series> {
        let points = |groups: &[u64]| groups.iter().enumerate().map(|(k, g)| (k as f64, *g)).collect();
        groups.iter().map(|(trace, groups)| (*trace, points(groups))).collect()
    }

    #[test]
    fn lives_say_how_they_began_and_ended() {
        let groups = lives(&series(&[(1, &[1, 1, 1, 1]), (2, &[2, 1, 1, 3])]));
        assert_eq!(
            groups.iter().map(|g| (g.number, g.from, g.to, g.born, g.ended)).collect::<Vec<_>>(),
            [
                (1, 0.0, 3.0, Birth::Appear, Death::Leave),
                (2, 0.0, 0.0, Birth::Appear, Death::Merge(1)),
                (3, 3.0, 3.0, Birth::Split(1), Death::Leave),
            ]
        );
        assert_eq!(groups[0].members[1], Membership { trace: 2, from: 1.0, to: 2.0 });
    }

    #[test]
    fn a_change_of_one_instant_is_ignored() {
        let mut all = series(&[(1, &[1, 1, 1, 1]), (2, &[1, 2, 1, 1]), (3, &[3, 3, 4, 4])]);
        smooth(&mut all);
        let groups = lives(&all);
        assert_eq!(groups.iter().map(|g| g.number).collect::<Vec<_>>(), [1, 3, 4]);
        assert_eq!(groups[0].members.len(), 2);
    }
}
