//! Models of the repository and small chains against uniformisation.

use super::chain::Chain;
use super::{answered, compiled, count, fits};

const TRIALS: u64 = 20_000;

fn queue() -> (Chain, Vec<i64>) {
    Chain::explored(0i64, |&n| {
        let mut moves = Vec::new();
        if n < 5 {
            moves.push((1.0, n + 1));
        }
        if n > 0 {
            moves.push((1.2, n - 1));
        }
        moves
    })
}

const QUEUE: &str = include_str!("../../models/queue.scn");

#[test]
fn the_queue_fills_as_often_as_it_must() {
    let (chain, n) = queue();
    let is = |k: i64| {
        let n = n.clone();
        move |s: usize| n[s] == k
    };
    let below = |k: i64| {
        let n = n.clone();
        move |s: usize| n[s] < k
    };
    let full = chain.until(|_| true, is(5), (0.0, 10.0))[0];
    assert!((full - 0.352_450_040_674).abs() < 1e-11, "{full}");
    let cases = [
        ("F<=10 s (queue.n == 5)", full),
        ("F[1 s, 2 s] (queue.n == 2)", chain.until(|_| true, is(2), (1.0, 2.0))[0]),
        ("G[1 s, 2 s] (queue.n < 2)", 1.0 - chain.until(|_| true, |s| n[s] >= 2, (1.0, 2.0))[0]),
        ("(queue.n < 3) U<=4 s (queue.n == 3)", chain.until(below(3), is(3), (0.0, 4.0))[0]),
        ("(queue.n < 3) U[2 s, 4 s] (queue.n == 2)", chain.until(below(3), is(2), (2.0, 4.0))[0]),
        ("(queue.n < 3) W<=4 s (queue.n == 3)", 1.0),
        ("F[10 s, 10 s] (queue.n == 0)", chain.later(&row(&n, |n| n == 0), 10.0).0[0]),
        ("F<=0 s (queue.n == 1)", 0.0),
        // Reals are exact, thirds and roots too.
        ("F<=(1 s / 3) (queue.n == 1)", chain.until(|_| true, is(1), (0.0, 1.0 / 3.0))[0]),
        ("F<=(sqrt(2) * 1 s) (queue.n == 2)", chain.until(|_| true, is(2), (0.0, 2f64.sqrt()))[0]),
    ];
    for (formula, p) in cases {
        let held = count(QUEUE, formula, TRIALS);
        assert!(fits(held, TRIALS, p), "{formula}: {held} of {TRIALS}, not {p}");
    }
}

fn row(n: &[i64], value: impl Fn(i64) -> bool) -> Vec<f64> {
    n.iter().map(|&n| f64::from(value(n))).collect()
}

#[test]
fn nested_operators_after_a_fixed_time_are_products() {
    let (chain, n) = queue();
    let soon = chain.until(|_| true, |s| n[s] == 0, (0.0, 1.5));
    let there: Vec<f64> = (0..n.len()).map(|s| if n[s] >= 2 { soon[s] } else { 0.0 }).collect();
    let kept = chain.until(|_| true, |s| n[s] > 3, (0.0, 2.0));
    let kept: Vec<f64> = kept.iter().map(|p| 1.0 - p).collect();
    let released = chain.until(|s| n[s] != 0, |s| n[s] >= 3, (0.0, 4.0));
    let released: Vec<f64> = released.iter().map(|p| 1.0 - p).collect();
    let cases = [
        ("F[3 s, 3 s] (queue.n >= 2 & F<=1.5 s (queue.n == 0))", chain.later(&there, 3.0).0[0]),
        ("F[1 s, 1 s] G<=2 s (queue.n <= 3)", chain.later(&kept, 1.0).0[0]),
        ("F[1 s, 1 s] F[2 s, 2 s] (queue.n == 1)", chain.later(&row(&n, |n| n == 1), 3.0).0[0]),
        ("G<=2 s F[2 s, 2 s] (queue.n <= 3)", chain.later(&kept, 2.0).0[0]),
        ("F[3 s, 3 s] ((queue.n == 0) R<=4 s (queue.n < 3))", chain.later(&released, 3.0).0[0]),
    ];
    for (formula, p) in cases {
        let held = count(QUEUE, formula, TRIALS);
        assert!(fits(held, TRIALS, p), "{formula}: {held} of {TRIALS}, not {p}");
    }
}

#[test]
fn time_averages_ends_and_quantiles() {
    let (chain, n) = queue();
    let numbers: Vec<f64> = n.iter().map(|&n| n as f64).collect();
    let average = chain.later(&numbers, 10.0).1[0] / 10.0;
    let late = (chain.later(&numbers, 5.0).1[0] - chain.later(&numbers, 2.0).1[0]) / 3.0;
    let end = chain.later(&numbers, 10.0).0[0];
    let queries = "\
estimate E(mean<=10 s (queue.n)) in 0 .. 5 by fixed(trials = 20000)
estimate E(mean[2 s, 5 s] (queue.n)) in 0 .. 5 by fixed(trials = 20000)
estimate E(queue.n at end) in 0 .. 5 by fixed(trials = 20000)
estimate E(queue.n at 2.5 s) in 0 .. 5 by fixed(trials = 20000)
estimate Q(0.5, time_until(queue.n == 1))
estimate Q(0.9, time_until(queue.n == 5))
check P(mean<=10 s (queue.n) <= 2) >= 0.5
check E(max<=10 s (queue.n)) in 0 .. 5 >= 2
";
    let run = answered(&compiled(QUEUE, queries).unwrap(), 2, 2);
    let half = chain.later(&numbers, 2.5).0[0];
    for (result, exact) in run.results.iter().zip([average, late, end, half, std::f64::consts::LN_2]) {
        assert!(result.low <= exact && exact <= result.high, "{}: {exact}", result.asked.text);
        assert!(result.high - result.low < 0.25, "{}", result.asked.text);
    }
    assert_eq!((run.results[5].high, run.results[5].censored), (f64::INFINITY, Some(10.0)));
    for result in &run.results[6..] {
        assert_eq!(result.verdict, Some(smc::engine::outcome::Verdict::Satisfied), "{}", result.asked.text);
    }
}

#[test]
fn the_models_have_the_values_of_their_comments() {
    for (scenario, properties) in [
        (include_str!("../../models/queue.scn"), include_str!("../../properties/queue.bltl")),
        (include_str!("../../models/tandem.scn"), include_str!("../../properties/tandem.bltl")),
        (include_str!("../../models/epidemic.scn"), include_str!("../../properties/epidemic.bltl")),
        (include_str!("../../models/sensors.scn"), include_str!("../../properties/sensors.bltl")),
    ] {
        let study = compiled(scenario, properties).unwrap();
        let run = answered(&study, 0, 2);
        assert_eq!(run.failure, None);
        let lines: Vec<&str> =
            properties.lines().filter(|l| ["est", "che", "com"].iter().any(|k| l.starts_with(k))).collect();
        assert_eq!(lines.len(), run.results.len());
        for (line, result) in lines.iter().zip(&run.results) {
            assert_ne!(result.verdict, Some(smc::engine::outcome::Verdict::Violated), "{line}");
            let numbers = line.split("//").nth(1).unwrap_or("").split_whitespace();
            let numbers: Vec<f64> = numbers.filter_map(|word| word.parse().ok()).collect();
            let exact = match numbers.as_slice() {
                [] => continue,
                [one] => *one,
                all => all[0] - all[1],
            };
            assert!(result.low <= exact && exact <= result.high, "{line} {} {}", result.low, result.high);
        }
    }
}

#[test]
fn the_tandem_queue_is_the_published_chain() {
    let (chain, states) = Chain::explored((0, 1, 0), |&(first, phase, second)| {
        let mut moves = Vec::new();
        if first < 5 {
            moves.push((20.0, (first + 1, phase, second)));
        }
        if first > 0 && phase == 1 {
            moves.push((0.2, (first, 2, second)));
        }
        if first > 0 && second < 5 {
            moves.push((if phase == 1 { 1.8 } else { 2.0 }, (first - 1, 1, second + 1)));
        }
        if second > 0 {
            moves.push((4.0, (first, phase, second - 1)));
        }
        moves
    });
    let jam = chain.until(|_| true, |s| states[s] == (5, 2, 5), (0.0, 10.0))[0];
    // PRISM and Ymer give 0.0154464.
    assert!((jam - 0.015_446_4).abs() < 5e-8, "{jam}");
}

#[test]
fn races_go_across_processes_and_copies() {
    // Five of rate 1 against one of rate 5 that waits for three of them.
    let scenario = "horizon = 10 s\nprocess s[5] { var up = true\n when up at 1 /s -> up = false }\n\
        let down = count(x in s: !x.up)\n\
        process guard { var late = false\n when down >= 3 at 5 /s -> late = true }";
    let (chain, states) = Chain::explored((0i64, false), |&(down, late)| {
        let mut moves = Vec::new();
        if down < 5 {
            moves.push(((5 - down) as f64, (down + 1, late)));
        }
        if down >= 3 && !late {
            moves.push((5.0, (down, true)));
        }
        moves
    });
    let late = |from: i64| {
        let states = states.clone();
        move |s: usize| states[s].1 && states[s].0 <= from
    };
    for (formula, p) in [
        ("F<=10 s (guard.late & down == 3)", chain.until(|_| true, late(3), (0.0, 10.0))[0]),
        ("F<=1 s guard.late", chain.until(|_| true, late(5), (0.0, 1.0))[0]),
        // All are alike: the first to go is each with the same chance.
        ("(s[1].up & s[3].up & s[4].up & s[5].up) U<=10 s !s[2].up", 0.2 * (1.0 - (-50f64).exp())),
    ] {
        let held = count(scenario, formula, TRIALS);
        assert!(fits(held, TRIALS, p), "{formula}: {held} of {TRIALS}, not {p}");
    }
}

#[test]
fn probabilities_after_a_rate_split_it() {
    let scenario = "horizon = 10 s\nprocess p { var s: 0 .. 3 = 0\n\
        when s == 0 at 2 /s -> 1/4: s = 1 | 3/4: s = 2\n when s == 0 at 1 /s -> s = 3 }";
    for (formula, p) in [
        ("F<=10 s (p.s == 1)", 2.0 / 3.0 / 4.0),
        ("F<=10 s (p.s == 2)", 0.5),
        ("F<=10 s (p.s == 3)", 1.0 / 3.0),
        ("F<=0.2 s (p.s > 0)", 1.0 - (-0.6f64).exp()),
    ] {
        let held = count(scenario, formula, TRIALS);
        assert!(
            fits(held, TRIALS, p * if formula.contains("10") { 1.0 - (-30f64).exp() } else { 1.0 }),
            "{formula}: {held}"
        );
    }
}

#[test]
fn delays_race_with_rates_and_begin_anew_where_a_command_is_disabled() {
    // The delay is kept while its command stays enabled: other commands of the process fire in between.
    let kept = "horizon = 10 s\nprocess p { var n: 0 .. 90 = 0\n var done = false\n\
        when !done & n < 90 at 3 /s -> n = n + 1\n when !done after 2 s -> done = true }";
    assert_eq!(count(kept, "!p.done U[2 s, 2 s] p.done", 2000), 2000);
    let mean = 6.0f64;
    let none = fits(count(kept, "F[2 s, 2 s] (p.n == 0)", TRIALS), TRIALS, (-mean).exp());
    assert!(none, "the counts before the delay are Poisson");
    // It is forgotten where the command is disabled: the guard fails with rate 1, and holds again at once.
    let forgotten = "horizon = 4 s\nprocess g { var open = true\n when open at 1 /s -> open = false\n\
        when !open after 0.5 s -> open = true }\n\
        process p { var done = false\n when !done & g.open after 2 s -> done = true }";
    // Done at 2 s without an interruption; else at the earliest 2.5 s after the first interruption.
    let held = count(forgotten, "F<=2.4 s p.done", TRIALS);
    assert!(fits(held, TRIALS, (-2.0f64).exp()), "{held}");
    // Interrupted k times, with gaps that sum to at most 1.9 s - 0.5 s k (Erlang), and then never for 2 s.
    let erlang = |k: i32, x: f64| {
        let term = |j: i32| x.powi(j) / (1..=j).map(f64::from).product::<f64>();
        1.0 - (-x).exp() * (0..k).map(term).sum::<f64>()
    };
    let exact = (-2.0f64).exp() * (1.0 + erlang(1, 1.4) + erlang(2, 0.9) + erlang(3, 0.4));
    let held = count(forgotten, "F<=3.9 s p.done", TRIALS);
    assert!(fits(held, TRIALS, exact), "{held}");
    // A uniform delay against a rate: P(U < E) with U in 1 s .. 3 s and E of rate 1/2.
    let race = "horizon = 10 s\nprocess p { var s: 0 .. 2 = 0\n when s == 0 after uniform(1 s, 3 s) -> s = 1\n\
        when s == 0 at 0.5 /s -> s = 2 }";
    let exact = ((-0.5f64).exp() - (-1.5f64).exp()) / (0.5 * 2.0);
    assert!(fits(count(race, "F<=10 s (p.s == 1)", TRIALS), TRIALS, exact));
    // An exponential delay is a rate.
    let alike = "horizon = 10 s\nprocess p { var s: 0 .. 2 = 0\n when s == 0 after exponential(2 s) -> s = 1\n\
        when s == 0 at 0.5 /s -> s = 2 }";
    assert!(fits(count(alike, "F<=10 s (p.s == 1)", TRIALS), TRIALS, 0.5 * (1.0 - (-10f64).exp())));
}

#[test]
fn rates_that_depend_on_the_state_and_on_other_processes() {
    // A counter that speeds up with another one: pure birth of both.
    let scenario = "horizon = 5 s\nprocess a { var n: 0 .. 4 = 0\n when n < 4 at 1 /s -> n = n + 1 }\n\
        process b { var n: 0 .. 3 = 0\n when n < 3 at 0.5 /s * a.n -> n = n + 1 }";
    let (chain, states) = Chain::explored((0i64, 0i64), |&(a, b)| {
        let mut moves = Vec::new();
        if a < 4 {
            moves.push((1.0, (a + 1, b)));
        }
        if b < 3 && a > 0 {
            moves.push((0.5 * a as f64, (a, b + 1)));
        }
        moves
    });
    for (formula, k) in [("F<=3 s (b.n == 1)", 1), ("F<=3 s (b.n == 3)", 3)] {
        let p = chain.until(|_| true, |s| states[s].1 >= k, (0.0, 3.0))[0];
        let held = count(scenario, formula, TRIALS);
        assert!(fits(held, TRIALS, p), "{formula}: {held} of {TRIALS}, not {p}");
    }
}

#[test]
fn with_a_step_jumps_are_seen_at_the_steps() {
    let scenario = QUEUE.replace("horizon = 10 s", "horizon = 10 s\nstep = 0.5 s");
    let (chain, n) = queue();
    // At each step the state is that of the chain then.
    for (formula, p) in [
        ("X (queue.n == 1)", chain.later(&row(&n, |n| n == 1), 0.5).0[0]),
        ("F[3 s, 3 s] (queue.n == 0)", chain.later(&row(&n, |n| n == 0), 3.0).0[0]),
        // What is over between two steps is not seen.
        ("F<=0.5 s (queue.n == 1)", chain.later(&row(&n, |n| n == 1), 0.5).0[0]),
    ] {
        let held = count(&scenario, formula, TRIALS);
        assert!(fits(held, TRIALS, p), "{formula}: {held} of {TRIALS}, not {p}");
    }
    // Processes of steps and of times read one another; what is read of steps is that of the last one.
    let both = "horizon = 4 s\nstep = 1 s\nprocess beat { var k: 0 .. 9 = 0\n var seen: 0 .. 9 = 0\n\
        when true -> { k = k + 1; seen = t.n } }\n\
        process t { var n: 0 .. 9 = 0\n when n < beat.k after 0.25 s -> n = n + 1 }";
    for formula in [
        "X (beat.k == 1 & t.n == 0)",
        // From 1 s on k is 1: n follows at 1.25 s, and is seen at 2 s.
        "X<=#2 (beat.k == 2 & t.n == 1 & beat.seen == 0)",
        "X<=#3 (beat.k == 3 & t.n == 2 & beat.seen == 1)",
    ] {
        assert_eq!(count(both, formula, 20), 20, "{formula}");
    }
}
