//! Steps (and jumps) per second of small processes, through compiler, kernel, monitor and procedure, beside a plain
//! hand-written loop of the same chain in the same run. One thread.
//!
//! `cargo bench --bench processes`

#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a measurement prints, and needs the clock"
)]

use smc::compile::{Files, Input, Study, compile};
use smc::engine::{Budget, Call, Nobody, Threads, run};
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

/// Steps per second, estimate and seconds of a query.
fn ours(scenario: &str, properties: &str) -> (f64, f64, f64) {
    let begun = Instant::now();
    let study = study(scenario, properties);
    let call = Call {
        seed: 1,
        command: String::new(),
        simulate: String::new(),
        only: Vec::new(),
        place: &|_| (String::new(), 0),
        file: String::new(),
    };
    let threads = Threads::new(Some(1)).expect("one thread");
    let done = run(&study, &call, &threads, &Budget::new(100_000_000, None), &Nobody).expect("it runs");
    let result = &done.results[0];
    let seconds = begun.elapsed().as_secs_f64();
    (result.steps as f64 / result.elapsed_s, result.estimate.unwrap_or(f64::NAN), seconds)
}

/// The same of a plain loop: steps and whether the formula held.
fn plain(trials: u64, mut trial: impl FnMut(&mut Fast) -> (u64, bool)) -> (f64, f64) {
    let mut random = Fast(0x9e37_79b9_7f4a_7c15);
    let (mut steps, mut held) = (0, 0u64);
    let begun = Instant::now();
    for _ in 0..trials {
        let (more, truth) = trial(&mut random);
        steps += more;
        held += u64::from(truth);
    }
    black_box(held);
    (steps as f64 / begun.elapsed().as_secs_f64(), held as f64 / trials as f64)
}

fn line(name: &str, ours: (f64, f64, f64), plain: (f64, f64)) {
    println!(
        "{name:<28} {:>7.1} M steps/s (p = {:.4}), plain loop {:>7.1} M steps/s (p = {:.4}), share {:.2}",
        ours.0 / 1e6,
        ours.1,
        plain.0 / 1e6,
        plain.1,
        ours.0 / plain.0
    );
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

/// Itai and Rodeh with three nodes and ids 1 to 4: a round is drawing, and after a tie one step more.
fn leader(random: &mut Fast) -> (u64, bool) {
    for round in 1..=4u64 {
        let word = random.next();
        let ids = [word >> 62, word >> 60 & 3, word >> 58 & 3];
        let largest = ids[0].max(ids[1]).max(ids[2]);
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
    let run = ours(&read("die"), &query("F<=#5 (die.s == 7 & die.d == 6)", 2_000_000));
    line("die", run, plain(4_000_000, die));
    let run = ours(&read("leader"), &query("F<=#8 elected", 500_000));
    line("leader election", run, plain(4_000_000, leader));
    let run = ours(&read("tandem"), &query("F<=10 s counter.full", 100_000));
    line("tandem queue", run, plain(200_000, tandem));
    let (_, _, seconds) =
        ours(&read("die"), "estimate P(F<=#5 (die.s == 7 & die.d == 6)) within 0.01 confidence 95 %");
    println!("{:<28} {:>7.1} ms from text to result", "die, 0.01, 95 %", seconds * 1e3);
}
