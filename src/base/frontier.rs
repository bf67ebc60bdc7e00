//! The places that a search has reached and not left yet, the cheapest first: the queue of Dijkstra (1959) and of A* (Hart,
//! Nilsson, Raphael 1968). Of equal costs the lesser place comes first, so the order of feeding leaves no trace.
//!
//! ```
//! use smc_core::base::frontier::Frontier;
//!
//! let mut reached: Frontier<u32> = [(2.5, 7), (1.0, 9), (1.0, 3)].into_iter().collect();
//! reached.push(0.5, 4);
//! let order: Vec<u32> = std::iter::from_fn(|| reached.pop()).map(|(_, place)| place).collect();
//! assert_eq!(order, [4, 3, 9, 7]);
//! ```

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Places with what it costs to reach them.
#[derive(Clone, Debug)]
pub struct Frontier<T>(BinaryHeap<Reverse<(u64, T)>>);

impl<T: Ord> Frontier<T> {
    /// Without any.
    pub const fn new() -> Self {
        Self(BinaryHeap::new())
    }

    /// A place was reached. Costs are not negative: then their bits have their order.
    pub fn push(&mut self, cost: f64, place: T) {
        self.0.push(Reverse((cost.to_bits(), place)));
    }

    /// Leaves the cheapest place.
    pub fn pop(&mut self) -> Option<(f64, T)> {
        self.0.pop().map(|Reverse((bits, place))| (f64::from_bits(bits), place))
    }
}

impl<T: Ord> Default for Frontier<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Ord> FromIterator<(f64, T)> for Frontier<T> {
    fn from_iter<I: IntoIterator<Item = (f64, T)>>(all: I) -> Self {
        // At once, which is linear.
        Self(all.into_iter().map(|(cost, place)| Reverse((cost.to_bits(), place))).collect())
    }
}
