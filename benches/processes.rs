//! Steps (and jumps) per second of small processes, through compiler, kernel, monitor and procedure, beside a plain
//! hand-written loop of the same chain in the same run. One thread.
//!
//! `cargo bench --bench processes`; `cargo bench --bench processes -- die` for one model. Each figure is the best of
//! several rounds, ours and the plain loop in turns, by the time that the thread was on a processor.

#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a measurement prints, and needs the clock"
)]

use smc::base::random::{Purpose, Stream, TrialKey};
use smc::compile::{Files, Input, Study, compile};
use smc::engine::{Budget, Call, CommandLine, Nobody, Threads, run};
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::source::{Source, SourceId};
use std::hint::black_box;
use std::time::Instant;

/// xorshift64* (Vigna 2016): about the cheapest generator that a plain loop would use.
struct Fast(u64);

impl Fast {
    #[inline(always)]
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }
}

fn study(scenario: &str, properties: &str) -> Study {
    let sources =
        [Source::new(SourceId(0), "model.scn", scenario), Source::new(SourceId(1), "prop.bltl", properties)];
    let (scenario, _) = parse_scenario(&sources[0]);
    let (properties, _) = parse_properties(&sources[1]);
    let input = Input {
        sources: &sources,
        scenario: &scenario,
        properties: &[properties],
        files: &Files::default(),
        settings: &[],
    };
    compile(&input).0.expect("the model is right")
}

/// Rounds of each measurement.
const ROUNDS: usize = 7;

/// Seconds that this thread was on a processor, so that other programs count for little; of the clock where the
/// system does not tell.
fn busy(since: Instant) -> f64 {
    let times = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = times.split(' ').next().and_then(|text| text.parse::<f64>().ok());
    nanoseconds.map_or_else(|| since.elapsed().as_secs_f64(), |n| n * 1e-9)
}

/// Steps per second and estimate of a query.
fn ours(study: &Study) -> (f64, f64) {
    let call = Call {
        branch: 0,
        explains: true,
        shows_evidence: false,
        repeats: false,
        seed: 1,
        line: CommandLine::default(),
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        drivers: &smc::kernel::driver::straight,
    };
    let threads = Threads::new(Some(1)).expect("one thread");
    let clock = Instant::now();
    let begun = busy(clock);
    let done = run(study, &call, &threads, &Budget::new(100_000_000, None), &Nobody).expect("it runs");
    let result = &done.results[0];
    (result.consumed.steps as f64 / (busy(clock) - begun), result.estimate.unwrap_or(f64::NAN))
}

/// The same of a plain loop: steps and whether the formula held.
fn plain(trials: u64, mut trial: impl FnMut(&mut Fast) -> (u64, bool)) -> (f64, f64) {
    let mut random = Fast(0x9e37_79b9_7f4a_7c15);
    let (mut steps, mut held) = (0, 0u64);
    let clock = Instant::now();
    let begun = busy(clock);
    for _ in 0..trials {
        let (more, truth) = trial(&mut random);
        steps += more;
        held += u64::from(truth);
    }
    black_box(held);
    (steps as f64 / (busy(clock) - begun), held as f64 / trials as f64)
}

/// Measures a query and the plain loop in turns, and prints the best of each.
fn compare(name: &str, study: &Study, trials: u64, trial: impl FnMut(&mut Fast) -> (u64, bool) + Copy) {
    if std::env::args().skip(1).any(|arg| !arg.starts_with('-') && !name.starts_with(&arg)) {
        return;
    }
    let (mut ours_best, mut plain_best) = ((0.0, 0.0), (0.0, 0.0));
    for _ in 0..ROUNDS {
        let (one, other) = (ours(study), plain(trials, trial));
        ours_best = if one.0 > ours_best.0 { one } else { ours_best };
        plain_best = if other.0 > plain_best.0 { other } else { plain_best };
    }
    println!(
        "{name:<28} {:>7.1} M steps/s (p = {:.4}), plain loop {:>7.1} M steps/s (p = {:.4}), share {:.2}",
        ours_best.0 / 1e6,
        ours_best.1,
        plain_best.0 / 1e6,
        plain_best.1,
        ours_best.0 / plain_best.0
    );
}

/// What an addressed number costs, one after the other: words of Philox a second.
fn addressed() {
    let stream = Stream::of(TrialKey { seed: 1, index: 1, branch: 0 }, 1, Purpose::Process);
    let mut best = 0.0f64;
    for _ in 0..ROUNDS {
        let clock = Instant::now();
        let begun = busy(clock);
        let sum: f64 = (0..4_000_000).map(|draw| stream.uniform(black_box(draw))).sum();
        black_box(sum);
        best = best.max(4e6 / (busy(clock) - begun));
    }
    println!("{:<28} {:>7.1} M/s, one after the other", "addressed numbers", best / 1e6);
}

fn die(random: &mut Fast) -> (u64, bool) {
    let (mut s, mut d) = (0u8, 0u8);
    for step in 0..=5u64 {
        if s == 7 && d == 6 {
            return (step, true);
        }
        if step == 5 {
            break;
        }
        let heads = random.next() >> 63 == 1;
        (s, d) = match (s, heads) {
            (0, true) => (1, d),
            (0, false) => (2, d),
            (1, true) => (3, d),
            (1, false) => (4, d),
            (2, true) => (5, d),
            (2, false) => (6, d),
            (3, true) => (1, d),
            (3, false) => (7, 1),
            (4, true) => (7, 2),
            (4, false) => (7, 3),
            (5, true) => (7, 4),
            (5, false) => (7, 5),
            (6, true) => (2, d),
            (6, false) => (7, 6),
            _ => (s, d),
        };
    }
    (5, false)
}

/// Itai and Rodeh with some nodes and ids 1 to 4: a round is drawing, and after a tie one step more.
fn leader<const NODES: usize>(random: &mut Fast) -> (u64, bool) {
    for round in 1..=4u64 {
        let word = random.next();
        let ids: [u64; NODES] = std::array::from_fn(|k| word >> (62 - 2 * k) & 3);
        let largest = ids.iter().copied().fold(0, u64::max);
        if ids.iter().filter(|id| **id == largest).count() == 1 {
            return (2 * round - 1, true);
        }
    }
    (8, false)
}

/// The tandem queue with room for five at each counter, from jump to jump.
fn tandem(random: &mut Fast) -> (u64, bool) {
    let (mut first, mut second_phase, mut second) = (0u8, false, 0u8);
    let mut time = 0.0;
    let mut jumps = 0;
    loop {
        if first == 5 && second_phase && second == 5 {
            return (jumps, true);
        }
        let arrive = if first < 5 { 20.0 } else { 0.0 };
        let again = if first > 0 && !second_phase { 0.2 } else { 0.0 };
        let serve = match (first > 0 && second < 5, second_phase) {
            (false, _) => 0.0,
            (true, false) => 1.8,
            (true, true) => 2.0,
        };
        let leave = if second > 0 { 4.0 } else { 0.0 };
        let total = arrive + again + serve + leave;
        let unit = |word: u64| ((word >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0);
        time -= unit(random.next()).ln() / total;
        if time > 10.0 {
            return (jumps, false);
        }
        jumps += 1;
        let pick = unit(random.next()) * total;
        if pick < arrive {
            first += 1;
        } else if pick < arrive + again {
            second_phase = true;
        } else if pick < arrive + again + serve {
            (first, second_phase, second) = (first - 1, false, second + 1);
        } else {
            second -= 1;
        }
    }
}

fn main() {
    let repository = env!("CARGO_MANIFEST_DIR");
    let read = |name: &str| {
        std::fs::read_to_string(format!("{repository}/models/{name}.scn")).expect("the model is there")
    };
    let query = |formula: &str, trials: u64| format!("estimate P({formula}) by fixed(trials = {trials})");
    let die_in = |query: &str| study(&read("die"), query);
    compare("die", &die_in(&query("F<=#5 (die.s == 7 & die.d == 6)", 2_000_000)), 4_000_000, die);
    compare(
        "leader election",
        &study(&read("leader"), &query("F<=#8 elected", 1_000_000)),
        4_000_000,
        leader::<3>,
    );
    // 625 states: too many for one table of all processes.
    let four = read("leader").replace("node[3]", "node[4]");
    compare("leader of four", &study(&four, &query("F<=#8 elected", 1_000_000)), 4_000_000, leader::<4>);
    compare("tandem queue", &study(&read("tandem"), &query("F<=10 s counter.full", 50_000)), 50_000, tandem);
    addressed();
    let seconds = (0..ROUNDS)
        .map(|_| {
            let begun = Instant::now();
            ours(&die_in("estimate P(F<=#5 (die.s == 7 & die.d == 6)) within 0.01 confidence 95 %"));
            begun.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min);
    println!("{:<28} {:>7.1} ms from text to result", "die, 0.01, 95 %", seconds * 1e3);
}
