//! Pairs of points that are near each other, found along one axis, and the sets that they connect.

use crate::base::geometry::Vec2;

/// Indices of points of two lists that differ by at most `reach` in x and in y, by ascending index of the first list.
pub(super) fn pairs(first: &[Vec2], second: &[Vec2], reach: f64) -> Vec<(usize, usize)> {
    let mut order: Vec<usize> = (0..second.len()).collect();
    order.sort_by(|a, b| second[*a].x.total_cmp(&second[*b].x));
    let mut found = Vec::new();
    for (i, place) in first.iter().enumerate() {
        let from = order.partition_point(|j| second[*j].x < place.x - reach);
        let near = order[from..].iter().take_while(|j| second[**j].x <= place.x + reach);
        found.extend(near.filter(|j| (second[**j].y - place.y).abs() <= reach).map(|j| (i, *j)));
    }
    found
}

/// The sets of the numbers below `count` that links connect, each ascending, in the order of their first members.
pub(super) fn connected(count: usize, links: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut parents: Vec<usize> = (0..count).collect();
    let root = |parents: &mut Vec<usize>, mut i: usize| {
        while parents[i] != i {
            parents[i] = parents[parents[i]];
            i = parents[i];
        }
        i
    };
    for (i, j) in links {
        let (a, b) = (root(&mut parents, i), root(&mut parents, j));
        // The root is the first member.
        parents[a.max(b)] = a.min(b);
    }
    let mut sets = vec![Vec::new(); count];
    for i in 0..count {
        sets[root(&mut parents, i)].push(i);
    }
    sets.retain(|set: &Vec<usize>| !set.is_empty());
    sets
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cost of a crowd is that of its neighbourhoods: it grows with their number.
    #[test]
    fn a_larger_crowd_has_more_sets_and_not_larger_ones() {
        let work = |rows: u32| {
            let crowd: Vec<Vec2> = (0..100 * rows)
                .map(|i| Vec2::new(2.0 * f64::from(i % 100), 2.0 * f64::from(i / 100)))
                .collect();
            let later: Vec<Vec2> = crowd.iter().map(|p| p + Vec2::new(0.5, 0.1)).collect();
            let near = pairs(&crowd, &later, 0.9);
            let links = near.iter().map(|(i, j)| (*i, crowd.len() + *j));
            let sets = connected(2 * crowd.len(), links);
            (near.len(), sets.iter().map(|set| set.len().pow(3)).sum::<usize>())
        };
        assert_eq!([work(2), work(20)], [(200, 8 * 200), (2000, 8 * 2000)]);
    }

    #[test]
    fn sets_are_those_that_links_connect() {
        let links = [(4, 1), (3, 2), (2, 4)];
        assert_eq!(connected(6, links.into_iter()), [vec![0], vec![1, 2, 3, 4], vec![5]]);
        let p = |x: f64, y: f64| Vec2::new(x, y);
        assert_eq!(
            pairs(&[p(0.0, 0.0), p(1.0, 0.0)], &[p(1.5, 0.0), p(0.5, 2.0), p(0.5, 0.0)], 0.5),
            [(0, 2), (1, 2), (1, 0)]
        );
    }
}
