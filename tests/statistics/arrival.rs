//! T18 and the estimation part of T19: trials that take time, consumed by index and, as a negative control,
//! as they come; with simulated workers, and with threads and the clock.

use super::tally::{Tally, uniform};
use smc::stats::{Counts, Decision, Sequential, Sprt, sequence};
use std::collections::BinaryHeap;

/// Trials on some workers; failures take 20 times as long.
struct Workers {
    seed: u64,
    run: u32,
    p: f64,
    next: u64,
    /// Ends of running trials, the earliest on top, in billionths.
    running: BinaryHeap<std::cmp::Reverse<(u64, u64)>>,
}

impl Workers {
    fn new(seed: u64, run: u32, p: f64, workers: u64) -> Self {
        let mut all = Self { seed, run, p, next: 0, running: BinaryHeap::new() };
        for _ in 0..workers {
            all.start(0);
        }
        all
    }

    fn outcome(&self, index: u64) -> bool {
        uniform(self.seed, self.run, 0, index) < self.p
    }

    fn start(&mut self, now: u64) {
        let slow = if self.outcome(self.next) { 1.0 } else { 20.0 };
        let time = slow * (0.5 + uniform(self.seed, self.run, 1, self.next));
        self.running.push(std::cmp::Reverse((now + (time * 1e9) as u64, self.next)));
        self.next += 1;
    }

    /// The next trial to end, its time and index; its worker starts another.
    fn finish(&mut self) -> (u64, u64) {
        let std::cmp::Reverse((time, index)) = self.running.pop().expect("workers never rest");
        self.start(time);
        (time, index)
    }
}

fn sprt() -> Sequential<Sprt> {
    Sprt::new(0.9, 0.01, 0.01, 0.01).unwrap()
}

fn in_order(runs: u32) {
    let tally = Tally::over(runs, |k| {
        let mut workers = Workers::new(50, k, 0.89, 64);
        let (mut test, mut done, mut prefix) = (sprt(), Vec::new(), 0);
        while test.decision().is_none() {
            let (_, index) = workers.finish();
            done.resize(workers.next as usize, false);
            done[index as usize] = true;
            while done[prefix] && test.decision().is_none() {
                test.observe(workers.outcome(prefix as u64));
                prefix += 1;
            }
        }
        // It is the verdict of one worker, at the same trial.
        let mut alone = sprt();
        let mut index = 0;
        while alone.observe(workers.outcome(index)).is_none() {
            index += 1;
        }
        assert_eq!((alone.decision(), alone.counts()), (test.decision(), test.counts()));
        (test.decision() == Some(Decision::Above), 0.0)
    });
    tally.guarantees(0.01);
}

fn first_come(runs: u32) {
    let tally = Tally::over(runs, |k| {
        let mut workers = Workers::new(51, k, 0.89, 64);
        let mut test = sprt();
        while test.decision().is_none() {
            let (_, index) = workers.finish();
            test.observe(workers.outcome(index));
        }
        (test.decision() == Some(Decision::Above), 0.0)
    });
    assert!(tally.share() > 0.9, "{}", tally.share());
}

/// Eight workers, a deadline at time 50: the interval over the complete prefix.
fn deadline(runs: u32) {
    let tally = Tally::over(runs, |k| {
        let mut workers = Workers::new(52, k, 0.9, 8);
        let mut done = Vec::new();
        loop {
            let (time, index) = workers.finish();
            if time > 50_000_000_000 {
                break;
            }
            done.resize(workers.next as usize, false);
            done[index as usize] = true;
        }
        let mut counts = Counts::default();
        for (index, _) in done.iter().enumerate().take_while(|(_, done)| **done) {
            counts.add(workers.outcome(index as u64));
        }
        (!sequence::interval(counts, 0.05).holds(0.9), 0.0)
    });
    tally.guarantees(0.05);
}

/// Eight threads and a deadline after so much work of all: a failure takes twenty times the work of a success.
fn deadline_of_threads(runs: u32) {
    use std::sync::atomic::{AtomicU64, Ordering};
    let tally = Tally::over(runs, |k| {
        let (next, spent) = (AtomicU64::new(0), AtomicU64::new(0));
        let mut done: Vec<u64> = std::thread::scope(|scope| {
            let work = || {
                let mut done = Vec::new();
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    for _ in 0..if uniform(53, k, 0, index) < 0.9 { 20 } else { 400 } {
                        if spent.fetch_add(1, Ordering::Relaxed) > 6_000 {
                            return done;
                        }
                        std::thread::yield_now();
                    }
                    done.push(index);
                }
            };
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(work)).collect();
            threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
        });
        done.sort_unstable();
        let mut counts = Counts::default();
        for (_, index) in (0..).zip(&done).take_while(|(place, index)| place == *index) {
            counts.add(uniform(53, k, 0, *index) < 0.9);
        }
        (!sequence::interval(counts, 0.05).holds(0.9), counts.trials() as f64)
    });
    tally.guarantees(0.05);
    assert!(tally.mean() > 5.0, "{tally:?}");
}

#[test]
fn t18_by_index_there_is_no_bias_and_as_they_come_there_is() {
    in_order(200);
    first_come(100);
}

#[test]
fn t19_deadline() {
    deadline(500);
    deadline_of_threads(150);
}

#[test]
#[ignore = "full number of replications"]
fn full_arrival() {
    in_order(4_000);
    first_come(1_000);
    deadline(4_000);
    deadline_of_threads(1_000);
}
