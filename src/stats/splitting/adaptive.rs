//! Adaptive multilevel splitting (Cérou and Guyader 2007), unbiased with the rule for ties of Bréhier, Gazeau,
//! Goudenège, Lelièvre and Rousset (Ann. Appl. Prob. 26, 2016): *all* paths at or below the k-th smallest level
//! are given up.

use super::{Flight, Picks, Scheme, Start, replicas};
use crate::stats::invalid::{Invalid, range};

/// One run.
#[derive(Clone, Debug)]
pub struct Adaptive {
    replicas: usize,
    kill: usize,
    picks: Picks,
    /// Number and flight of each path that goes on.
    live: Vec<(usize, Flight)>,
    launched: usize,
    wanted: Vec<Start>,
    weight: f64,
    levels: Vec<f64>,
}

impl Adaptive {
    /// With so many paths, of which at least `kill` are given up at each level. `seed` and `run` address
    /// the choices of the run.
    pub fn new(count: usize, kill: usize, seed: u64, run: u16) -> Result<Self, Invalid> {
        let replicas = replicas(count)?;
        range("kill", kill as f64, 1.0, count as f64 - 1.0)?;
        Ok(Self {
            replicas,
            kill,
            picks: Picks::new(seed, run),
            live: Vec::with_capacity(count),
            launched: 0,
            wanted: vec![Start::Anew; count],
            weight: 1.0,
            levels: Vec::new(),
        })
    }

    fn split(&mut self) {
        let mut levels: Vec<f64> = self.live.iter().map(|(_, flight)| flight.level()).collect();
        levels.sort_by(f64::total_cmp);
        let level = levels[self.kill - 1];
        if level == f64::INFINITY {
            return;
        }
        self.levels.push(level);
        self.live.retain(|(_, flight)| flight.level() > level);
        let survivors = self.live.len();
        self.weight *= survivors as f64 / self.replicas as f64;
        for _ in survivors..self.replicas {
            if survivors == 0 {
                // Extinct: 0 is a part of the unbiased estimate.
                return;
            }
            let (path, flight) = &self.live[self.picks.pick(survivors)];
            if let Some(time) = flight.first_above(level) {
                self.wanted.push(Start::From { path: *path, time });
            }
        }
    }
}

impl Scheme for Adaptive {
    fn wanted(&self) -> &[Start] {
        &self.wanted
    }

    fn feed(&mut self, flights: Vec<Flight>) {
        for flight in flights {
            self.live.push((self.launched, flight));
            self.launched += 1;
        }
        self.wanted.clear();
        if self.live.len() == self.replicas {
            self.split();
        }
    }

    fn estimate(&self) -> f64 {
        let reached = self.live.iter().filter(|(_, flight)| flight.reached()).count();
        self.weight * (reached as f64 / self.replicas as f64)
    }

    fn levels(&self) -> &[f64] {
        &self.levels
    }
}
