//! Rankings with constraints, fronts of several aims, means of the largest values and curves, seen from outside: on coins and
//! dice of known laws, each at several numbers of threads.

use crate::cli::formats::validated;
use crate::program::{Place, timeless};
use serde_json::Value;

/// `c.x` is 1 with probability `p`, `d.x` with probability `q`, and `r.x` is a number of 1 to 4.
const COINS: &str = "scenario \"coins\"\nhorizon = 8 steps\nparam p = 0.3 in 0 .. 1\nparam q = 0.5 in 0 .. 1\n\
    process c {\n  var x: 0 .. 2 = 0\n  when x == 0 -> p: x = 1 | 1 - p: x = 2\n}\n\
    process d {\n  var x: 0 .. 2 = 0\n  when x == 0 -> q: x = 1 | 1 - q: x = 2\n}\n\
    process r {\n  var x: 0 .. 4 = 0\n  when x == 0 -> 0.4: x = 1 | 0.3: x = 2 | 0.2: x = 3 | 0.1: x = 4\n}\n\
    process w {\n  var n: 0 .. 9 = 0\n  when n == 0 -> 0.25: n = 1 | 0.75: n = 0\n}\n";

fn results(properties: &str, words: &[&str]) -> Vec<Value> {
    let place = Place::new(&[("a.scn", COINS), ("a.bltl", properties)]);
    let mut found: Vec<Value> = Vec::new();
    for threads in ["1", "2", "7"] {
        let call = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--threads", threads];
        let said = place.call(&[&call, words].concat());
        assert!(matches!(said.code, Some(0 | 1 | 4)), "{}{}", said.out, said.err);
        let mut json = said.json();
        validated(&json);
        timeless(&mut json);
        found.push(json["results"].clone());
    }
    assert!(found[0] == found[1] && found[0] == found[2], "threads change a result");
    found[0].as_array().unwrap().clone()
}

fn labels<'r>(result: &'r Value, status: &str) -> Vec<&'r str> {
    let options = result["options"].as_array().unwrap().iter();
    options.filter(|one| one["status"] == status).map(|one| one["option"].as_str().unwrap()).collect()
}

fn holds(result: &Value, truth: f64) -> bool {
    (result["low"].as_f64().unwrap()..=result["high"].as_f64().unwrap()).contains(&truth)
}

/// The largest tenth of `r.x` is 4, the largest fifth is 4 and 3 in equal parts; of -r.x the largest fifth is -1.
#[test]
fn tails_are_those_of_the_law() {
    let found = results(
        "estimate CVaR(0.9, r.x at end) in 0 .. 5\nestimate CVaR(0.8, r.x at end) in 0 .. 5 within 0.3\n\
         estimate CVaR(0.8, -r.x at end) in -5 .. 0 by fixed(trials = 3000)\n\
         estimate CVaR(0.5, 0.8, r.x at end) in 0 .. 5\n\
         check CVaR(0.8, r.x at end) in 0 .. 5 >= 3\ncheck CVaR(0.8, r.x at end) in 0 .. 5 <= 3\n\
         compare CVaR(0.5, c.x at end) in 0 .. 3 under p = 0.9 with p = 0.1\n",
        &[],
    );
    for (result, truth) in found.iter().zip([4.0, 3.5, -1.0, 2.8, 3.5, 3.5, 3.5, -0.8]) {
        assert!(holds(result, truth), "{truth}: {result}");
    }
    assert_eq!(found[1]["stopped_by"], "width");
    assert!(found[1]["high"].as_f64().unwrap() - found[1]["low"].as_f64().unwrap() <= 0.6);
    let verdicts: Vec<&Value> = found.iter().map(|one| &one["verdict"]).collect();
    assert_eq!(verdicts[5..7], ["satisfied", "violated"]);
    assert_eq!(found[3]["query"], "estimate CVaR(0.5, r.x at end)");
    assert_eq!(found[4]["query"], "estimate CVaR(0.8, r.x at end)");
}

/// A metric that leaves its range is clipped and counted.
#[test]
fn a_range_that_clips_is_counted() {
    let found = results("estimate CVaR(0.9, r.x at end) in 0 .. 2\n", &[]);
    assert!(found[0]["clipped"].as_u64().unwrap() > 200, "{}", found[0]);
    assert!(found[0]["certifies"].as_str().unwrap().contains("clipped to 0 .. 2"), "{}", found[0]);
}

/// `w.n` becomes 1 in each step with probability 1/4.
#[test]
fn a_curve_is_a_distribution_function() {
    let found = results(
        "estimate P(F<=t (w.n == 1)) for t in 0 steps .. 8 steps by 1 step\n\
         estimate P(G<=t (w.n == 0)) for t in 0 steps .. 8 steps by 2 steps within 0.05\n",
        &[],
    );
    for (result, falls) in found.iter().zip([false, true]) {
        let points = result["distribution"]["curve"]["points"].as_array().unwrap();
        for point in points {
            let steps = point["at"].as_i64().unwrap() as i32;
            let waits = 0.75_f64.powi(steps);
            assert!(holds(point, if falls { waits } else { 1.0 - waits }), "{point}");
        }
        let last = points.last().unwrap();
        assert_eq!(last["estimate"], result["estimate"]);
    }
    assert_eq!(found[0]["trials"], 1000);
    assert_eq!(
        (found[1]["trials"].as_u64(), found[1]["of"].as_str()),
        (Some(738), Some("P(G<=8 steps (w.n == 0))"))
    );
}

/// Of 300 seeds at most 5 %, and chance, have a curve of which the band misses a point of the exact one.
#[test]
fn the_band_of_a_curve_covers_all_of_it() {
    let text = "estimate P(F<=t (w.n == 1)) for t in 0 steps .. 8 steps by 1 step by dkw(trials = 200)\n";
    let place = Place::new(&[("a.scn", COINS), ("a.bltl", text)]);
    let misses = (0..300).filter(|seed| {
        let call = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--seed", &seed.to_string()];
        let json: Value = place.call(&call).json();
        let points = json["results"][0]["distribution"]["curve"]["points"].as_array().unwrap();
        points.len() != 9 || (0..9).zip(points).any(|(t, point)| !holds(point, 1.0 - 0.75_f64.powi(t)))
    });
    let count = misses.count();
    assert!(count <= 15 + 11, "{count} of 300");
}

/// The larger half of `c.x` is 2 in most trials unless p is large: with p of 0.9 its mean is 1.2, with 0.5 and less it is 2.
#[test]
fn rankings_by_the_tail_err_no_more_often_than_they_say() {
    let text = "rank p in 0.9, 0.5, 0.3 by CVaR(0.5, c.x at end) in 0 .. 3 within 0.6 confidence 90 %\n";
    let place = Place::new(&[("a.scn", COINS), ("a.bltl", text)]);
    let wrong = (0..300).filter(|seed| {
        let call = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--seed", &seed.to_string()];
        let json: Value = place.call(&call).json();
        // The two others tie.
        !["p = 0.5", "p = 0.3"].contains(&json["results"][0]["choice"].as_str().unwrap())
    });
    let count = wrong.count();
    assert!(count <= 30 + 15, "{count} of 300");
}

/// With p the score rises and with q the constraint: of p in 0.2, 0.6, 0.9 only those with q of 0.9 satisfy it.
#[test]
fn the_best_of_those_that_satisfy_the_constraint_is_chosen() {
    let query =
        |rest: &str| format!("rank p in 0.2, 0.6, 0.9, q in 0.5, 0.9 by P(F<=1 steps (c.x == 1)) {rest}\n");
    let text = [
        query("subject to P(F<=1 steps (d.x == 1)) >= 0.8 within 0.1"),
        query("subject to P(F<=1 steps (d.x == 1)) >= 0.8, P(F<=1 steps (c.x == 1)) <= 0.7 within 0.1"),
        query("subject to E(d.x at end) in 0 .. 3 >= 2.5 within 0.1"),
        query("subject to Q(0.8, d.x at end) <= 1 within 0.1"),
    ]
    .concat();
    let found = results(&text, &[]);
    assert_eq!(found[0]["choice"], "p = 0.9, q = 0.9");
    assert_eq!(labels(&found[0], "excluded").len(), 3, "{}", found[0]);
    assert!(
        found[0]["certifies"].as_str().unwrap().contains("of those with P(F<=1 steps (d.x == 1)) >= 0.8")
    );
    assert_eq!(found[1]["choice"], "p = 0.6, q = 0.9");
    // Nothing is above 2.
    assert_eq!((&found[2]["choice"], &found[2]["none"]), (&Value::Null, &Value::Bool(true)));
    assert!(found[2]["certifies"].as_str().unwrap().starts_with("no option satisfies E(d.x at end) >= 2.5"));
    assert_eq!(found[3]["choice"], "p = 0.9, q = 0.9");
    let also = &found[0]["options"][0]["also"][0];
    assert_eq!(
        (also["holds"].as_bool(), also["what"].as_str()),
        (Some(true), Some("P(F<=1 steps (d.x == 1)) >= 0.8"))
    );
}

/// A constraint at its threshold is never decided: sampling ends at the budget, and nothing is certified.
#[test]
fn an_undecided_constraint_ends_at_the_budget() {
    let text = "rank p in 0.2, 0.9 by P(F<=1 steps (c.x == 1)) subject to P(F<=1 steps (d.x == 1)) >= 0.5 within 0.1\n";
    let found = results(text, &["--max-trials", "500"]);
    assert_eq!((found[0]["certifies"].as_str(), found[0]["stopped_by"].as_str()), (Some(""), Some("cap")));
}

/// Of p in 0.1, 0.5, 0.9 each is best in one of two opposite aims; one more option is worse in both.
#[test]
fn a_front_has_those_that_none_dominates() {
    let text = "pareto p in 0.1, 0.5, 0.9, q in 0.3, 0.9 by P(F<=1 steps (c.x == 1)), E(c.x at end) in 0 .. 3, \
                P(F<=1 steps (d.x == 1)) within 0.1, 0.2, 0.1\n\
                pareto q in 0.2, 0.5, 0.9 by P(F<=1 steps (d.x == 1)), CVaR(0.5, -d.x at end) in -3 .. 0 within 0.1, 0.3\n";
    let found = results(text, &[]);
    assert_eq!(found[0]["kind"], "pareto");
    let mut front: Vec<&str> = labels(&found[0], "front");
    front.sort_unstable();
    assert_eq!(front, ["p = 0.1, q = 0.9", "p = 0.5, q = 0.9", "p = 0.9, q = 0.9"], "{}", found[0]);
    assert_eq!(labels(&found[0], "beaten").len(), 3);
    assert_eq!(found[0]["front"].as_array().unwrap().len(), 3);
    assert_eq!(labels(&found[1], "front"), ["q = 0.9"]);
    assert!(
        found[1]["certifies"].as_str().unwrap().contains("each other option exceeds one of these in no aim")
    );
}

/// A ranking by the tail: of coins with p the smaller half is 1 more often where p is large.
#[test]
fn a_ranking_by_the_tail_has_a_certificate() {
    let found = results("rank p in 0.1, 0.9 by CVaR(0.5, -c.x at end) in -3 .. 0 within 0.5\n", &[]);
    assert_eq!(found[0]["choice"], "p = 0.9");
    assert_eq!(found[0]["method"]["name"], "tail_betting");
    assert!(found[0]["gap"].as_f64().unwrap() <= 0.5);
}

/// Text, table and page name what was asked besides; the figures of a front and of a curve are drawn.
#[test]
fn other_formats_show_it_too() {
    let text = "rank p in 0.2, 0.9, q in 0.5, 0.9 by P(F<=1 steps (c.x == 1)) subject to P(F<=1 steps (d.x == 1)) >= 0.8 within 0.1\n\
                pareto p in 0.1, 0.9 by P(F<=1 steps (c.x == 1)) within 0.1, E(c.x at end) in 0 .. 3 within 0.2\n\
                estimate P(F<=t (w.n == 1)) for t in 0 steps .. 8 steps by 1 step\n";
    let place = Place::new(&[("a.scn", COINS), ("a.bltl", text)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "--report", "a.html", "--format", "json=a.json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let page = std::fs::read_to_string(place.path("a.html")).unwrap();
    for words in ["None dominates", "satisfied", "probability, with its band"] {
        assert!(page.contains(words), "{words}");
    }
    let table = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "csv"]).out;
    assert_eq!(table.lines().filter(|line| line.contains(",point,")).count(), 9, "{table}");
    assert_eq!(table.lines().filter(|line| line.contains(",beside,")).count(), 6, "{table}");
    assert!(table.lines().next().unwrap().contains("t (steps)"), "{table}");
    for (figure, only) in [("ranking", "1"), ("distribution", "2")] {
        let drawn = place.call(&["plot", "--figure", figure, "a.json", "--only", only, "-o", "f.svg"]);
        assert_eq!(drawn.code, Some(0), "{}", drawn.err);
        let svg = std::fs::read_to_string(place.path("f.svg")).unwrap();
        assert!(!svg.contains("NaN") && svg.contains("<svg"), "{svg}");
    }
    let brief = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "brief"]).out;
    assert!(brief.contains("p = 0.1; p = 0.9") || brief.contains("p = 0.9; p = 0.1"), "{brief}");
}
