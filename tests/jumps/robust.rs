//! Robustness in property files of continuous time: its sign is the verdict, its law is that of extremes, it is
//! checked, estimated, compared and known early.

use super::chain::Chain;
use super::{answered, compiled};
use smc::engine::outcome::Verdict;

const QUEUE: &str = include_str!("../../models/queue.scn");

#[test]
fn the_sign_is_the_verdict_trial_by_trial() {
    for formula in [
        "F<=10 s (queue.n > 3.5)",
        "G[2 s, 6 s] (queue.n < 2.5)",
        "(queue.n < 3.5) U[1 s, 8 s] (queue.n < 0.5)",
        "(queue.n > 3.5) R<=4 s (queue.n < 1.5)",
        "!(queue.n > 2.5) W<=3 s (queue.n > 1.5 & F<=2 s (queue.n < 0.5))",
        "G<=5 s (queue.n > 2.5 => F<=2 s (queue.n < 1.5))",
        "F G<=1 s (queue.n > 2.5) & G<=3 s F<=3 s (queue.n > 0.5)",
        "time_until(queue.n > 1.5) <= 2 s",
        "min[1 s, 4 s] (queue.n) > 0.5 | max<=9 s (queue.n) < 1.5",
    ]
    .map(|formula| formula.replace("F G<=1 s", "F<=9 s G<=1 s"))
    {
        let query = format!(
            "estimate P({formula}), P(robustness({formula}) > 0), P(robustness({formula}) >= 0), P(0 > robustness({formula})) by fixed(trials = 400)\n"
        );
        let run = answered(&compiled(QUEUE, &query).unwrap_or_else(|error| panic!("{error}")), 4, 1);
        let passed: Vec<u64> = run.results.iter().map(|result| result.consumed.counts.successes).collect();
        // No margin is zero: n is whole and no bound is.
        assert_eq!((passed[1], passed[2], passed[3]), (passed[0], passed[0], 400 - passed[0]), "{formula}");
        assert!(passed[0] > 0 && passed[0] < 400, "{formula}: {passed:?}");
        // The sign is known exactly when the verdict falls.
        assert_eq!(run.results[1].consumed.steps, run.results[0].consumed.steps, "{formula}");
    }
}

#[test]
fn its_law_is_that_of_the_extreme() {
    // The robustness of F<=10 s (n >= 5) is max n - 5.
    let chain = Chain::explored(0i64, |&n| {
        let mut moves = Vec::new();
        if n < 5 {
            moves.push((1.0, n + 1));
        }
        if n > 0 {
            moves.push((1.2, n - 1));
        }
        moves
    });
    let (chain, n) = chain;
    let reached = |k: i64| chain.until(|_| true, |s| n[s] >= k, (0.0, 10.0))[0];
    let mean = (1..=5).map(reached).sum::<f64>() - 5.0;
    let queries = "\
estimate E(robustness(F<=10 s (queue.n >= 5))) in -5 .. 5 by fixed(trials = 20000)
estimate E(max<=10 s (queue.n)) in 0 .. 10 by fixed(trials = 20000)
estimate P(robustness(F<=10 s (queue.n >= 5)) >= -2) by fixed(trials = 20000)
estimate Q(0.5, robustness(F<=10 s (queue.n >= 5))) by fixed(trials = 2000)
check P(robustness(F<=10 s (queue.n >= 5)) >= -2) >= 0.5
check Q(0.5, robustness(F<=10 s (queue.n >= 5))) >= -3
compare E(robustness(F<=10 s (queue.n >= 5))) in -5 .. 5 under far = 0 with far = 2
";
    let model = QUEUE.replace("process queue", "param far = 0\nprocess queue");
    let run = answered(&compiled(&model, queries).unwrap_or_else(|error| panic!("{error}")), 3, 2);
    let of = |k: usize| &run.results[k];
    assert!(of(0).low <= mean && mean <= of(0).high, "{mean} {:?}", (of(0).low, of(0).high));
    // The same trials, so that the means differ by the bound to the last digits.
    let (robust, most) = (of(0).estimate.unwrap(), of(1).estimate.unwrap());
    assert!((robust - (most - 5.0)).abs() < 1e-9, "{robust} {most}");
    let three = reached(3);
    assert!(of(2).low <= three && three <= of(2).high, "{three}");
    // Enough is known once three are there; the value needs the whole ten seconds, or five.
    assert!(of(2).consumed.steps < of(0).consumed.steps, "{} {}", of(2).consumed.steps, of(0).consumed.steps);
    assert!((-5.0..=0.0).contains(&of(3).estimate.unwrap()));
    assert_eq!((of(4).verdict, of(5).verdict), (Some(Verdict::Satisfied), Some(Verdict::Satisfied)));
    assert_eq!(of(6).estimate, Some(0.0), "the same worlds");
}

#[test]
fn what_has_no_margin_is_refused() {
    for (question, code) in [
        ("estimate E(robustness(F<=2 s (queue.n == 5))) in -5 .. 5", "E0610"),
        ("estimate E(robustness(mean<=2 s (queue.n) > 2)) in -5 .. 5", "E0610"),
        ("estimate E(robustness(F<=11 s (queue.n > 2))) in -5 .. 5", "E0502"),
        ("estimate E(robustness(X (queue.n > 2))) in -5 .. 5", "E0507"),
    ] {
        let found = compiled(QUEUE, question).unwrap_err();
        assert!(found.contains(code), "{question}\n{found}");
    }
    // A third of a second is no multiple of the first tick.
    let third = "estimate E(robustness(F<=(1 s / 3) (queue.n > 2))) in -5 .. 5";
    assert!(compiled(QUEUE, third).is_ok());
}
