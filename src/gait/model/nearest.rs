//! The pairs of steps a transition was fitted to, and those nearest to an input: a k-d tree without pointers (Bentley 1975), its
//! middle element at the middle of the list, without allocation.

use super::columns::Columns;
use super::transition::Inputs;
use serde::{Deserialize, Serialize};

/// How many of the nearest pairs give their residual.
pub(super) const NEAREST: usize = 32;

/// Residuals of pairs with their places.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pairs {
    /// Inputs over the units of the distance, in the order of the tree; numbers of one pair are neighbours.
    pub(super) places: Vec<f64>,
    /// What the second step has beyond the mean that was predicted from the other pairs, in scaled columns.
    pub(super) residuals: Vec<Columns>,
}

/// The nearest pairs found so far, nearest first.
#[derive(Clone, Debug)]
pub(super) struct Found {
    squares: [f64; NEAREST],
    pairs: [usize; NEAREST],
    count: usize,
}

impl Found {
    fn add(&mut self, square: f64, pair: usize) {
        let mut at = self.count.min(NEAREST - 1);
        if self.count == NEAREST && square >= self.squares[at] {
            return;
        }
        while at > 0 && self.squares[at - 1] > square {
            self.squares[at] = self.squares[at - 1];
            self.pairs[at] = self.pairs[at - 1];
            at -= 1;
        }
        self.squares[at] = square;
        self.pairs[at] = pair;
        self.count = (self.count + 1).min(NEAREST);
    }

    fn reach(&self) -> f64 {
        if self.count < NEAREST { f64::INFINITY } else { self.squares[NEAREST - 1] }
    }
}

/// The last input is no axis: the mark of a first step is 0 nearly always.
fn axis_at(depth: usize, inputs: usize) -> usize {
    depth % (inputs - 1).max(1)
}

fn arrange(order: &mut [usize], depth: usize, coordinate: &impl Fn(usize, usize) -> f64, inputs: usize) {
    if order.len() < 2 {
        return;
    }
    let (middle, axis) = (order.len() / 2, axis_at(depth, inputs));
    order.select_nth_unstable_by(middle, |a, b| {
        coordinate(*a, axis).total_cmp(&coordinate(*b, axis)).then(a.cmp(b))
    });
    let (below, above) = order.split_at_mut(middle);
    arrange(below, depth + 1, coordinate, inputs);
    arrange(&mut above[1..], depth + 1, coordinate, inputs);
}

impl Pairs {
    /// In the order of a tree. `places` has `inputs` numbers for each residual.
    pub(super) fn new(places: &[f64], residuals: &[Columns], inputs: usize) -> Self {
        let mut order: Vec<usize> = (0..residuals.len()).collect();
        arrange(&mut order, 0, &|pair, axis| places[pair * inputs + axis], inputs);
        Self {
            places: order.iter().flat_map(|p| &places[p * inputs..(p + 1) * inputs]).copied().collect(),
            residuals: order.iter().map(|p| residuals[*p]).collect(),
        }
    }

    fn search(&self, place: &[f64], low: usize, high: usize, depth: usize, found: &mut Found) {
        if low >= high {
            return;
        }
        let (middle, inputs) = (low + (high - low) / 2, place.len());
        let axis = axis_at(depth, inputs);
        let pair = &self.places[middle * inputs..(middle + 1) * inputs];
        let mut square = 0.0;
        for (x, y) in pair.iter().zip(place) {
            square += (x - y) * (x - y);
        }
        found.add(square, middle);
        let side = place[axis] - pair[axis];
        let (near, far) = ((low, middle), (middle + 1, high));
        let (near, far) = if side < 0.0 { (near, far) } else { (far, near) };
        self.search(place, near.0, near.1, depth + 1, found);
        if side * side < found.reach() {
            self.search(place, far.0, far.1, depth + 1, found);
        }
    }

    /// The pairs nearest to a place.
    pub(super) fn nearest(&self, place: &Inputs, inputs: usize) -> Found {
        let mut found = Found { squares: [0.0; NEAREST], pairs: [0; NEAREST], count: 0 };
        self.search(&place[..inputs], 0, self.residuals.len(), 0, &mut found);
        found
    }

    /// The residual of one of the nearest pairs, chosen by a number in (0, 1).
    pub(super) fn residual(&self, found: &Found, choice: f64) -> Columns {
        let chosen = (choice * found.count as f64) as usize;
        self.residuals[found.pairs[chosen.min(found.count.saturating_sub(1))]]
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    #[test]
    fn they_are_the_nearest_of_all() {
        let stream = Stream::of(TrialKey::default(), 1, Purpose::Test);
        let (count, inputs) = (700, 4);
        let places: Vec<f64> = (0..count * inputs / 2).flat_map(|k| stream.normal_pair(k as u32)).collect();
        let residuals: Vec<Columns> = (0..count).map(|k| [k as f64; 11]).collect();
        let pairs = Pairs::new(&places, &residuals, inputs);
        for trial in 0..50 {
            let [a, b] = stream.normal_pair(10_000 + trial);
            let mut place = [0.0; 12];
            place[..4].copy_from_slice(&[a, b, a * b, 0.3]);
            let mut all: Vec<(f64, usize)> = (0..count)
                .map(|k| ((0..inputs).map(|q| (places[k * inputs + q] - place[q]).powi(2)).sum(), k))
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            for rank in 0..NEAREST {
                let found = pairs.nearest(&place, inputs);
                let got = pairs.residual(&found, (rank as f64 + 0.5) / NEAREST as f64);
                assert_eq!(got[0], all[rank].1 as f64, "{trial} {rank}");
            }
        }
    }
}
