//! Fixed effort at fixed levels (Garvels 2000): as many paths at each level, each from a state in which a path
//! of the level before entered it, chosen at random. The product of the shares that get on is unbiased.

use super::{Flight, Picks, Scheme, Start, replicas};
use crate::stats::invalid::Invalid;

/// One run.
#[derive(Clone, Debug)]
pub struct Effort {
    replicas: usize,
    picks: Picks,
    levels: Vec<f64>,
    at: usize,
    launched: usize,
    wanted: Vec<Start>,
    product: f64,
}

impl Effort {
    /// With so many paths at each of the levels, which ascend and were chosen before: from a pilot run.
    pub fn new(count: usize, levels: Vec<f64>, seed: u64, run: u16) -> Result<Self, Invalid> {
        let replicas = replicas(count)?;
        if let Some(pair) =
            levels.windows(2).find(|pair| pair[0].partial_cmp(&pair[1]).is_none_or(std::cmp::Ordering::is_ge))
        {
            return Err(Invalid::Order {
                low_name: "level",
                low: pair[0],
                high_name: "next level",
                high: pair[1],
            });
        }
        Ok(Self {
            replicas,
            picks: Picks::new(seed, run),
            levels,
            at: 0,
            launched: 0,
            wanted: vec![Start::Anew; count],
            product: 1.0,
        })
    }
}

impl Scheme for Effort {
    fn wanted(&self) -> &[Start] {
        &self.wanted
    }

    fn feed(&mut self, flights: Vec<Flight>) {
        let first = self.launched;
        self.launched += flights.len();
        self.wanted.clear();
        let Some(&level) = self.levels.get(self.at) else {
            let reached = flights.iter().filter(|flight| flight.reached()).count();
            self.product *= reached as f64 / self.replicas as f64;
            return;
        };
        self.at += 1;
        let entered: Vec<(usize, u64)> = flights
            .iter()
            .enumerate()
            .filter_map(|(k, flight)| Some((first + k, flight.first_above(level)?)))
            .collect();
        self.product *= entered.len() as f64 / self.replicas as f64;
        if entered.is_empty() {
            return;
        }
        for _ in 0..self.replicas {
            let (path, time) = entered[self.picks.pick(entered.len())];
            self.wanted.push(Start::From { path, time });
        }
    }

    fn estimate(&self) -> f64 {
        self.product
    }

    fn levels(&self) -> &[f64] {
        &self.levels
    }
}
