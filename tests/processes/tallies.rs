//! Counts of formulas over time, against the formulas one by one.

use super::{compiled, fits, shown};

const COINS: &str = "horizon = 6 steps\n\
    process coin[5] { var heads = false\n when true -> 1/3: heads = true | 2/3: heads = false }";

type Comparison = fn(f64, f64) -> bool;

fn verdicts(queries: &[String]) -> Vec<Vec<bool>> {
    let properties: String = queries.iter().map(|q| format!("check P({q}) >= 0.5\n")).collect();
    let study = compiled(COINS, &properties).unwrap();
    // Queries about the same formula share a column, in the order of their first mention.
    let columns: Vec<usize> = study
        .queries
        .iter()
        .map(|query| match &query.ask {
            smc::compile::study::Ask::Check { measure, .. } => measure.target.column,
            _ => panic!("checks only"),
        })
        .collect();
    let trials = shown(&study.worlds[0], 5, 800);
    trials.iter().map(|trial| columns.iter().map(|&c| trial.verdicts[c]).collect()).collect()
}

#[test]
fn a_count_over_time_is_that_of_its_formulas() {
    let one = |body: &str| (1..=5).map(|k| format!("G<=#1 F<=#2 (coin[{k}].{body})")).collect::<Vec<_>>();
    let mut queries = one("heads");
    let count = "count(c in coin: G<=#1 F<=#2 (c.heads))";
    let relations: [(&str, Comparison); 6] = [
        (">=", |n, x| n >= x),
        (">", |n, x| n > x),
        ("<=", |n, x| n <= x),
        ("<", |n, x| n < x),
        ("==", |n, x| n == x),
        ("!=", |n, x| n != x),
    ];
    let bounds = [-1.0, 0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0];
    let mut expected = Vec::new();
    for (sign, holds) in relations {
        for bound in bounds {
            queries.push(format!("{count} {sign} {bound}"));
            expected.push((holds, bound, false));
            queries.push(format!("{bound} {sign} {count}"));
            expected.push((holds, bound, true));
        }
    }
    for row in verdicts(&queries) {
        let n = f64::from(u8::try_from(row[..5].iter().filter(|held| **held).count()).unwrap());
        for ((holds, bound, swapped), (query, verdict)) in
            expected.iter().zip(queries[5..].iter().zip(&row[5..]))
        {
            let wanted = if *swapped { holds(*bound, n) } else { holds(n, *bound) };
            assert_eq!(*verdict, wanted, "{query} where {n} hold");
        }
    }
}

#[test]
fn a_count_over_time_has_its_probability() {
    let (p, rows) =
        (1.0 - (2.0_f64 / 3.0).powi(3), verdicts(&["count(c in coin: F<=#3 (c.heads)) >= 4".to_owned()]));
    let exact = 5.0 * p.powi(4) * (1.0 - p) + p.powi(5);
    assert!(fits(rows.iter().filter(|row| row[0]).count(), rows.len(), exact));
}

#[test]
fn a_count_over_time_is_no_number() {
    let refused = compiled(COINS, "check P(count(c in coin: F<=#3 (c.heads)) + 1 >= 4) >= 0.5").unwrap_err();
    assert!(refused.contains("E0504") && refused.contains("only be compared with a number"), "{refused}");
}

#[test]
fn a_count_of_implications_of_one_state_is_a_number_of_it() {
    let sensors = "horizon = 20 steps\n\
        process sensor[3] { var a: bool = false; var b: bool = true; when !a -> 1/2: a = true | 1/2: b = false }";
    let count = "count(s in sensor: s.a => s.b)";
    let queries = [
        (format!("G<=1 ({count} + 1 == 4)"), 10),
        (format!("F<=20 ({count} + 1 > 4)"), 0),
        (format!("G<=20 ({count} == count(s in sensor: !s.a | s.b))"), 10),
        (format!("{count} >= 3"), 10),
    ];
    let text: String =
        queries.iter().map(|(query, _)| format!("estimate P({query}) by fixed(trials = 10)\n")).collect();
    let study = compiled(sensors, &text).unwrap_or_else(|errors| panic!("{errors}"));
    let run = super::answered(&study, 3, 1);
    for (result, (query, successes)) in run.results.iter().zip(queries) {
        assert_eq!(result.consumed.counts.successes, successes, "{query}");
    }
}
