//! T16: every procedure comes to the same verdict, counts and numbers whatever the threads, the width of rounds, the
//! order in which trials end, and trials that are run a second time.

use crate::texts::compiled;
use smc::base::random::TrialKey;
use smc::compile::Study;
use smc::compile::study::Query;
use smc::engine::outcome::{CallResult, Failure, QueryResult};
use smc::engine::trials::executor::{Cells, Job};
use smc::engine::{Budget, Call, CommandLine, Executor, Nobody, Threads, run};
use smc::kernel::{Program, Run};
use smc::logic::Invalid;
use smc::trials::cell::Item;
use smc::{Model, Options};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

const SMALL: &str = include_str!("small.scn");

/// Every procedure there is.
const QUERIES: &str = "\
property near = F<=1 s (min(distance(user, a) for a in crowd) < 3 m)
check P(near) >= 0.3 by sprt(indifference = 0.05)
check P(near) >= 0.3 by sprt2(indifference = 0.05)
check P(near) >= 0.3 by plan(indifference = 0.1)
check P(near) >= 0.9
check P(near) >= 0.9 by three_way(indifference = 0.05)
check E(max<=1 s (speed(user))) in 0 m/s .. 3 m/s >= 1 m/s
check Q(0.5, min<=1 s (clearance(user))) >= 0.2 m
estimate P(near) within 0.05
estimate P(near) by okamoto(epsilon = 0.1, delta = 0.1)
estimate P(near) by massart(epsilon = 0.06, delta = 0.1)
estimate P(near) by spending(epsilon = 0.06, delta = 0.1)
estimate P(near) by gbas(epsilon = 0.3, delta = 0.1)
estimate P(near) by clopper_pearson(trials = 300)
estimate P(F<=1 s (clearance(user) < -0.1 m)) by splitting(replicas = 20, runs = 2, plain = 100)
estimate E(max<=1 s (speed(user))) in 0 m/s .. 3 m/s within 0.05 m/s
estimate E(robustness(near)) in -4 m .. 3 m within 0.3 m
estimate Q(0.5, time_until(clearance(user) < 1 m)), Q(0.9, travelled(user) at 1 s) by fixed(trials = 200)
estimate Q(0.1, 0.5, 0.9, min<=1 s (clearance(user))) by dkw(trials = 200)
compare P(near) under density = 0.1 /m^2 with density = 0.4 /m^2 within 0.1
compare E(max<=1 s (speed(user))) in 0 m/s .. 3 m/s under density = 0.1 /m^2 with density = 0.4 /m^2
rank moves of user by P(near) within 0.1
rank moves of user by P(near) within 0.1 by one_challenger()
rank moves of user by P(near) by okamoto(epsilon = 0.3, delta = 0.2)
rank moves of user by E(min<=1 s (clearance(user))) in -1 m .. 6 m within 0.3 m
rank density in 0.1 /m^2, 0.2 /m^2, 0.4 /m^2 by P(near) within 0.1
check P(near) >= 0.3 under every density in 0.1 /m^2, 0.4 /m^2
rank moves of user by P(near) within 0.1 under every density in 0.1 /m^2, 0.4 /m^2
";

/// Hands a round out in pieces of random size and order, sleeps between them, and runs some of them twice.
struct Restless {
    threads: Threads,
    width: usize,
    state: AtomicU64,
}

impl Restless {
    fn below(&self, bound: u64) -> u64 {
        let old = self.state.fetch_add(0x9e37_79b9_7f4a_7c15, Ordering::Relaxed);
        let mixed = (old ^ (old >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed ^ (mixed >> 29)) % bound
    }
}

impl Executor for Restless {
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        let mut pieces = Vec::new();
        let mut from = 0;
        while from < items.len() {
            let to = items.len().min(from + 1 + self.below(60) as usize);
            pieces.push((from, to));
            if self.below(5) == 0 {
                // As after a worker that died: leased once more.
                pieces.push((from, to));
            }
            from = to;
        }
        for k in (1..pieces.len()).rev() {
            pieces.swap(k, self.below(k as u64 + 1) as usize);
        }
        let mut cells = Cells::new(items.len(), job.columns.len());
        for (from, to) in pieces {
            std::thread::sleep(Duration::from_micros(self.below(200)));
            let part = self.threads.run(job, &items[from..to], budget)?;
            for (k, row) in part.rows().enumerate() {
                if let Some(row) = row {
                    cells.put(from + k, row);
                }
            }
        }
        Ok(cells)
    }

    fn width(&self, _: &Job<'_>) -> usize {
        self.width
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.threads.everywhere(&|| {
            std::thread::sleep(Duration::from_micros(self.below(200)));
            work();
        });
    }
}

fn call() -> Call<'static> {
    Call {
        branch: 0,
        explains: true,
        shows_evidence: false,
        repeats: false,
        seed: 11,
        line: CommandLine {
            scenario: "a.scn".to_owned(),
            properties: vec!["a.bltl".to_owned()],
            ..CommandLine::default()
        },
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        drivers: &smc::kernel::driver::straight,
    }
}

fn results(study: &Study, executor: &dyn Executor) -> Vec<QueryResult> {
    whole(study, 11, executor).results
}

fn whole(study: &Study, seed: u64, executor: &dyn Executor) -> CallResult {
    let call = Call { seed, ..call() };
    let mut run = run(study, &call, executor, &Budget::new(2_000, None), &Nobody).unwrap();
    for result in &mut run.results {
        result.elapsed_s = 0.0;
    }
    run
}

#[test]
fn t16_neither_threads_nor_rounds_nor_sleep_leave_a_trace() {
    let study = compiled(SMALL, QUERIES).unwrap();
    let plain = results(&study, &Threads::new(Some(1)).unwrap());
    let is_whole = |query: &&Query| query.every.as_ref().is_none_or(|every| every.place == 0);
    assert_eq!(plain.len(), study.queries.iter().filter(is_whole).count());
    for (threads, width, state) in [(1, 1, 1), (2, 1000, 2), (3, 7, 3), (8, 64, 4)] {
        let restless =
            Restless { threads: Threads::new(Some(threads)).unwrap(), width, state: AtomicU64::new(state) };
        let found = results(&study, &restless);
        assert_eq!(found.len(), plain.len());
        for (found, plain) in found.iter().zip(&plain) {
            assert_eq!(found, plain, "{threads} threads, rounds of {width}: {}", plain.asked.text);
        }
    }
}

/// Eight copies that go on by chance; a ninth process is wrong as soon as they have come far: at seed 1 for the first
/// time in trial 29.
const WRONG: &str = "scenario \"Wrong\"
horizon = 20 steps
process p[8] { var s: 0 .. 30 = 0
 when s < 30 -> 1/2: s = s + 1 | 1/2: s = s }
process q { var r: 0 .. 12 = 0
 when p[1].s + p[2].s + p[3].s + p[4].s + p[5].s + p[6].s + p[7].s + p[8].s > 85 -> r = r + 13 }
";

/// The first query reads on until the model is wrong; the others are decided before that in each trial, and stop after
/// 47, 42, 10, 1 and 2 of them.
const UNHARMED: &str = "\
estimate P(F<=#20 (q.r == 11)) by clopper_pearson(trials = 3000)
check P(F<=#2 (p[1].s == 1)) >= 0.5
check P(F<=#3 (p[1].s == 1)) >= 0.55
check P(F<=#1 (p[1].s == 1)) >= 0.01
estimate P(F<=#1 (p[1].s == 1)) by clopper_pearson(trials = 1)
estimate P(F<=#1 (p[1].s == 1)) by clopper_pearson(trials = 2)
";

#[test]
fn which_results_an_error_of_the_model_leaves_does_not_depend_on_rounds() {
    let study = compiled(WRONG, UNHARMED).unwrap();
    for (threads, width, state) in [(1, 1, 5), (2, 1000, 6), (3, 7, 7), (8, 64, 8)] {
        let restless =
            Restless { threads: Threads::new(Some(threads)).unwrap(), width, state: AtomicU64::new(state) };
        for executor in [&restless as &dyn Executor, &restless.threads] {
            let found = whole(&study, 1, executor);
            let Some(Failure::Model(flaw)) = &found.failure else { panic!("{:?}", found.failure) };
            assert!(flaw.moment.starts_with("trial 29 at "), "{}", flaw.moment);
            // Those that stopped later, in the same round or not, would have come to that trial.
            let left: Vec<u64> = found.results.iter().map(|result| result.consumed.counts.trials).collect();
            assert_eq!(left, [10, 1, 2], "{threads} threads, rounds of {width}");
        }
    }
}

#[test]
fn a_proof_lets_nobody_else_read_trials_twice() {
    let model = WRONG.replace("> 85", "> 92");
    let checks: String = (300..600).map(|k| format!("check P(F<=#20 (p[1].s >= 11)) >= 0.{k}\n")).collect();
    // The estimate waits for the proof of its level when the others have come to the trial in which the model is wrong.
    let with = compiled(&model, &format!("estimate P(F<=#2 (p[1].s == 1)) within 0.03\n{checks}")).unwrap();
    let without = compiled(&model, &checks).unwrap();
    for seed in [2, 3, 7] {
        let threads = Threads::new(Some(1)).unwrap();
        let (with, without) = (whole(&with, seed, &threads), whole(&without, seed, &threads));
        assert!(with.failure.is_some() && without.failure.is_some(), "seed {seed}");
        let checks = with.results.iter().filter(|result| result.verdict.is_some());
        let said =
            |result: &QueryResult| (result.asked.text.clone(), result.verdict, result.consumed.counts.trials);
        let (with, without): (Vec<_>, Vec<_>) =
            (checks.map(said).collect(), without.results.iter().map(said).collect());
        assert!(with.len() > 200, "seed {seed}: {}", with.len());
        assert_eq!(with, without, "seed {seed}");
    }
}

/// A walk that is wrong shortly before its rare end, so that only paths of splitting come there, many at once; the chains
/// beside it tell them apart.
const FAULTY_PATHS: &str = "scenario \"Faulty paths\"
horizon = 40 steps
process w { var x: 0 .. 12 = 2
 when x > 0 & x < 12 -> 1/4: x = x + 1 | 3/4: x = x - 1 }
process d[8] { var k: 0 .. 60 = 0
 when k < 60 -> 1/2: k = k + 1 | 1/2: k = k }
process q { var r: 0 .. 3 = 0
 when w.x == 10 & d[1].k + d[2].k + d[3].k + d[4].k + d[5].k + d[6].k + d[7].k + d[8].k > 9 -> r = r + 4 }
";

#[test]
fn of_several_faulty_paths_the_same_one_is_told() {
    let query = "estimate P(F (w.x > 11)) by splitting(replicas = 40, runs = 2, plain = 100)\n";
    let study = compiled(FAULTY_PATHS, query).unwrap();
    for seed in 0..4 {
        let found = |threads| whole(&study, seed, &Threads::new(Some(threads)).unwrap()).failure;
        let alone = found(1);
        let Some(Failure::Model(flaw)) = &alone else { panic!("{alone:?}") };
        assert_eq!(flaw.moment, "in a path of splitting");
        for threads in [2, 3, 5, 8] {
            assert_eq!(found(threads), alone, "{threads} threads, seed {seed}");
        }
    }
}

#[test]
fn every_result_says_what_it_certifies_and_how_to_get_it_again() {
    let study = compiled(SMALL, QUERIES).unwrap();
    for result in results(&study, &Threads::new(Some(2)).unwrap()) {
        let query = &result.asked.text;
        assert!(result.certifies.contains("error at most"), "{query}: {}", result.certifies);
        assert!(!result.interval.is_empty() && !result.method.name.is_empty(), "{query}");
        assert!(result.consumed.counts.trials > 0 && result.estimate.is_some(), "{query}");
        let trials = result.replay.rsplit(' ').next().unwrap().parse::<u64>().unwrap();
        let paths = result.rare.map_or(0, |rare| rare.paths);
        // A comparison counts the trials of both sides, its budget pairs.
        let sides = if result.compare.is_some() { 2 } else { 1 };
        assert_eq!(sides * trials, result.consumed.counts.trials + paths, "{query}: {}", result.replay);
        assert!(result.low <= result.estimate.unwrap() && result.estimate.unwrap() <= result.high, "{query}");
    }
}

/// A hall of 2 400 people with walls in it, who walk both ways.
fn large(kind: &str) -> Model {
    let text = format!(
        "horizon = 2 s\nstep = 0.05 s
        scene {{
          wall (-1, -1) -- (61, -1)
          wall (20, 5) -- (20, 25)
          obstacle rect (38, 8) .. (41, 20)
          region east: rect (70, 10) .. (72, 12)
          region west: rect (-12, 10) .. (-10, 12)
        }}
        {kind}
        agents right[1200]: person {{ at = uniform in rect (0, 0) .. (29, 28); route = east }}
        agents left[1200]: person {{ at = uniform in rect (30, 0) .. (60, 28); route = west }}"
    );
    Model::parse(&text).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn threads_that_share_a_crowd_change_no_bit_of_it() {
    for preset in ["smc1", "smc2", "helbing2000"] {
        states_are_the_same(&large(&format!("kind person: sfm preset {preset}")));
    }
    states_are_the_same(&large("kind person: cfs preset cfs2"));
}

fn states_are_the_same(model: &Model) {
    let program = Program::new(Arc::clone(model.scenario()));
    assert!(program.is_large());
    let last = |threads: usize| {
        let go = || {
            let mut run = Run::of(&program, TrialKey::default().into()).unwrap().0;
            run.share(threads);
            while run.next_state().is_ok() {}
            run.state().clone()
        };
        Threads::new(Some(threads)).unwrap().helped(go).unwrap()
    };
    let alone = last(1);
    assert_eq!(alone.ticks[0], 40);
    for threads in [2, 3, 7] {
        assert!(last(threads) == alone, "{threads} threads change a state");
    }
}

#[test]
fn a_trial_of_a_large_crowd_has_the_same_value_at_any_number_of_threads() {
    let model = large("kind person: sfm preset smc2");
    let values = |threads| {
        let query = "estimate E(max(speed(a) for a in right) at 2 s) in 0 m/s .. 9 m/s by fixed(trials = 3)";
        let report = model.check(query, &Options::default().threads(threads)).unwrap();
        report.results()[0].estimate.map(f64::to_bits)
    };
    let alone = values(1);
    assert!(alone.is_some());
    // With four threads one helps; with seven three trials have two each.
    assert_eq!([2, 4, 7].map(values), [alone; 3]);
}
