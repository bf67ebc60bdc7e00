//! Clusters in events: workers that take shards from a queue, of which some are lost, slow or run twice. The outcomes are real
//! and the times are not, so that a thousand workers fit into a test.

use crate::texts::compiled;
use smc::compile::Study;
use smc::engine::outcome::{CallResult, QueryResult, Stop};
use smc::engine::shards::{Attempts, Head, Origin, Part, Plan, Stored, Unit, run as run_shard};
use smc::engine::{Budget, Call, CommandLine, Nobody, Threads, run};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

const COIN: &str = "scenario \"Coin\"\nhorizon = 4 steps\nparam p = 0.5 in 0 .. 1\n\
    process c { var x: 0 .. 1 = 0\n when x == 0 -> p: x = 1 | 1 - p: { } }\n";

/// Seconds that the start of a shard takes: the queue, the program, its inputs.
const START: f64 = 0.3;
/// Seconds of the merge of a round, and of its submission.
const MERGE: f64 = 1.0;

fn study(queries: &str) -> Study {
    compiled(COIN, queries).unwrap()
}

fn call() -> Call<'static> {
    Call {
        branch: 0,
        explains: false,
        shows_evidence: false,
        repeats: false,
        seed: 5,
        line: CommandLine { scenario: "a.scn".to_owned(), ..CommandLine::default() },
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        drivers: &smc::kernel::driver::straight,
    }
}

fn timeless(run: CallResult) -> Vec<QueryResult> {
    run.results.into_iter().map(|result| QueryResult { elapsed_s: 0.0, ..result }).collect()
}

/// Uniform numbers of the events (Marsaglia 2003, xorshift).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What a cluster took, s of time or of workers.
#[derive(Debug, Default)]
struct Bill {
    rounds: usize,
    shards: usize,
    /// From the call to the verdict.
    time: f64,
    /// Of workers: in trials, in starts of shards, and in shards that brought nothing new.
    trials: f64,
    starts: f64,
    lost: f64,
    /// Trials that came, each once.
    simulated: u64,
}

/// How often shards are lost, slow (three times as long) and run twice.
struct Mishaps {
    lost: f64,
    slow: f64,
    doubled: f64,
}

/// Runs a study on so many workers, each trial for `pace` seconds.
fn cluster(study: &Study, workers: usize, pace: f64, mishaps: &Mishaps) -> (Vec<QueryResult>, Bill) {
    let threads = Threads::new(Some(2)).unwrap();
    let origin = Origin::of(study, 5);
    let mut chance = Chance(0x9e37_79b9_7f4a_7c15 ^ workers as u64);
    let (mut parts, mut bill, mut attempts) = (Vec::<Part>::new(), Bill::default(), Attempts::default());
    loop {
        let heads: Vec<&Head> = parts.iter().map(|part| &part.head).collect();
        let reread = |at: usize| Part::read(&parts[at].bytes().unwrap()).ok();
        let stored = Stored::new(&heads, &reread, &threads).unwrap();
        let found = run(study, &call(), &stored, &Budget::new(10_000_000, None), &Nobody).unwrap();
        let shards = Plan::deal(&stored.wanted(), &attempts, 4 * workers, (bill.rounds > 0).then_some(pace));
        if shards.is_empty() {
            return (timeless(found), bill);
        }
        let plan =
            Plan { origin: origin.clone(), round: bill.rounds as u64 + 1, max_trials: 10_000_000, shards };
        bill.rounds += 1;
        bill.shards += plan.shards.len();
        // Times at which workers are free, in microseconds.
        let mut free: BinaryHeap<Reverse<u64>> = (0..workers).map(|_| Reverse(0)).collect();
        let mut end = 0.0f64;
        for (index, units) in plan.shards.iter().enumerate() {
            let work = units.iter().map(Unit::weight).sum::<u64>() as f64 * pace;
            let times = if chance.next() < mishaps.doubled { 2 } else { 1 };
            let is_lost = chance.next() < mishaps.lost;
            for time in 0..times {
                let slow = if chance.next() < mishaps.slow { 3.0 } else { 1.0 };
                let share = if is_lost { chance.next() } else { 1.0 };
                let Reverse(from) = free.pop().unwrap();
                let until = from as f64 * 1e-6 + START + slow * share * work;
                free.push(Reverse((until * 1e6) as u64));
                end = end.max(until);
                bill.starts += START;
                if is_lost || time > 0 {
                    bill.lost += slow * share * work;
                } else {
                    bill.trials += slow * work;
                }
                if is_lost {
                    continue;
                }
                let part =
                    run_shard(study, (&plan, index), call().drivers, &threads, &Budget::new(u64::MAX, None));
                parts.push(part.unwrap().unwrap());
                bill.simulated += if time == 0 { units.iter().map(Unit::weight).sum::<u64>() } else { 0 };
            }
            if is_lost {
                attempts.fail(&[units]);
            }
        }
        bill.time += end + MERGE;
        assert!(bill.rounds < 200);
    }
}

/// A test, an estimate and a ranking, each with the number of rounds that it takes roughly.
const QUERIES: [(&str, &str, f64); 3] = [
    ("test", "check P(F<=2 steps (c.x == 1)) >= 0.747 by sprt(indifference = 0.0015)", 30.0),
    ("estimate", "estimate P(F<=2 steps (c.x == 1)) within 0.0015", 1.0),
    ("ranking", "rank p in 0.49 .. 0.508 by 0.003 by P(F<=2 steps (c.x == 1)) within 0.002", 30.0),
];

/// Prints the table of `docs/scale.md`.
#[test]
fn a_cluster_of_any_size_comes_to_the_verdict_of_one_thread() {
    let mishaps = Mishaps { lost: 0.01, slow: 0.01, doubled: 0.01 };
    println!(
        "| query | trials | workers | rounds | shards | time (s) | ideal (s) | in vain | starts | lost |"
    );
    for (name, query, rounds) in QUERIES {
        let study = study(query);
        let alone =
            run(&study, &call(), &Threads::new(Some(1)).unwrap(), &Budget::new(10_000_000, None), &Nobody);
        let alone = timeless(alone.unwrap());
        let consumed = alone[0].consumed.counts.trials;
        // Four shards of about 30 s for each of a thousand workers in each round.
        let pace = 4.0 * 30.0 * 1000.0 * rounds / consumed as f64;
        for workers in [1, 10, 100, 1000] {
            let (found, bill) = cluster(&study, workers, pace, &mishaps);
            assert!(found == alone, "{name} on {workers} workers");
            let ideal = consumed as f64 * pace / workers as f64;
            let vain = bill.simulated as f64 / consumed as f64 - 1.0;
            println!(
                "| {name} | {consumed} | {workers} | {} | {} | {:.0} | {ideal:.0} | {:.1} % | {:.1} % | {:.1} % |",
                bill.rounds,
                bill.shards,
                bill.time,
                100.0 * vain,
                100.0 * bill.starts / bill.trials,
                100.0 * bill.lost / bill.trials
            );
            assert!(vain < 0.25, "{name} on {workers} workers: {vain}");
            assert!(bill.starts < 0.02 * bill.trials, "{name} on {workers} workers: {bill:?}");
        }
    }
}

#[test]
fn where_nothing_is_lost_the_time_of_a_planned_estimate_is_the_ideal_one() {
    let study = study("estimate P(F<=2 steps (c.x == 1)) by clopper_pearson(trials = 320000)");
    let (_, bill) = cluster(&study, 1000, 0.4, &Mishaps { lost: 0.0, slow: 0.0, doubled: 0.0 });
    // Four thousand shards of 32 s, in one round.
    assert_eq!((bill.rounds, bill.shards, bill.simulated), (1, 4000, 320_000));
    assert!(bill.time < 1.02 * 4.0 * 32.0 + MERGE, "{bill:?}");
}

#[test]
fn a_shard_that_never_comes_back_ends_its_query_alone() {
    let queries = "estimate P(F<=2 steps (c.x == 1)) by clopper_pearson(trials = 1000)\n\
        estimate P(F<=2 steps (c.x == 1)) by clopper_pearson(trials = 1000) under p = 0.25\n";
    let study = study(queries);
    let threads = Threads::new(Some(1)).unwrap();
    let (mut parts, mut attempts, mut rounds) = (Vec::<Part>::new(), Attempts::default(), 0);
    let found = loop {
        let heads: Vec<&Head> = parts.iter().map(|part| &part.head).collect();
        let reread = |at: usize| Part::read(&parts[at].bytes().unwrap()).ok();
        let stored = Stored::new(&heads, &reread, &threads).unwrap();
        let found = run(&study, &call(), &stored, &Budget::new(10_000, None), &Nobody).unwrap();
        let shards = Plan::deal(&stored.wanted(), &attempts, 8, None);
        if shards.is_empty() {
            break found;
        }
        rounds += 1;
        let plan = Plan { origin: Origin::of(&study, 5), round: rounds, max_trials: 10_000, shards };
        for (index, units) in plan.shards.iter().enumerate() {
            let crashes = units.iter().any(|unit| {
                matches!(unit, Unit::Trials(trials) if trials.world == 0 && (trials.from..trials.to).contains(&500))
            });
            if crashes {
                attempts.fail(&[units]);
            } else {
                let budget = Budget::new(u64::MAX, None);
                let part = run_shard(&study, (&plan, index), call().drivers, &threads, &budget);
                parts.push(part.unwrap().unwrap());
            }
        }
    };
    assert_eq!(rounds, 3);
    let given_up = attempts.given_up();
    assert!(
        given_up
            .iter()
            .any(|unit| matches!(unit, Unit::Trials(trials) if (trials.from..trials.to).contains(&500)))
    );
    let stops: Vec<(Stop, u64)> =
        found.results.iter().map(|one| (one.stopped_by, one.consumed.counts.trials)).collect();
    assert_eq!((stops[0].0, stops[1]), (Stop::Missing, (Stop::Plan, 1000)));
    assert!((300..=500).contains(&stops[0].1), "{stops:?}");
}
