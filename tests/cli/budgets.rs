//! Time and trials are shared by the queries of a call; what they do not suffice for says so.

use crate::program::{Place, SMALL, timeless};

/// A queue that is not full for long: no trial about all of its time comes to an end.
const QUEUE: &str = "horizon = 1e9 s
const lambda = 1 /s
const mu = 1.2 /s
process queue {
  var n: 0 .. 5 = 0
  when n < 5 at lambda -> n = n + 1
  when n > 0 at mu -> n = n - 1
}
";
/// The same beside a clock that nobody reads, which the runner of one small process does not take.
const TICKING: &str = "process clock {
  var odd = false
  when true after uniform(1 s, 2 s) -> odd = !odd
}
";
const ENDLESS: &str = "estimate P(G (queue.n < 6))\n";
const SHORT: &str = "estimate P(F<=10 s (queue.n == 5)) within 0.05\n";

#[test]
fn a_long_query_does_not_starve_a_short_one() {
    let ticking = format!("{QUEUE}{TICKING}");
    for (model, properties) in [
        (QUEUE, format!("{SHORT}{ENDLESS}")),
        (QUEUE, format!("{ENDLESS}{SHORT}")),
        (&ticking, format!("{SHORT}{ENDLESS}")),
    ] {
        let place = Place::new(&[("a.scn", model), ("a.bltl", &properties)]);
        let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json"];
        let said = place.call(&[&words[..], &["--timeout", "2s"]].concat());
        assert_eq!(said.code, Some(4), "{}", said.err);
        let json = said.json();
        let results = json["results"].as_array().unwrap();
        let (short, endless) = if properties.starts_with(SHORT) {
            (&results[0], &results[1])
        } else {
            (&results[1], &results[0])
        };
        assert_eq!((&short["stopped_by"], short.get("shortfall")), (&"width".into(), None), "{short:#}");
        let found = (&endless["trials"], &endless["stopped_by"], &endless["shortfall"]);
        assert_eq!(found, (&0.into(), &"deadline".into(), &"not begun".into()), "{endless:#}");
        // Without a deadline it is the same.
        let index = short["index"].to_string();
        let mut alone = place.call(&[&words[..], &["--only", &index]].concat()).json()["results"][0].clone();
        let mut short = short.clone();
        timeless(&mut alone);
        timeless(&mut short);
        assert_eq!(alone, short);
    }
}

/// Two worlds, whose queries do not share trials.
#[test]
fn a_long_query_leaves_time_to_the_other_worlds() {
    let model = format!("param rate = 1 /s\n{QUEUE}").replace("at lambda", "at rate");
    let properties = "estimate P(G (queue.n < 6))\n\
        compare P(F<=10 s (queue.n == 5)) under rate = 1 /s with rate = 2 /s within 0.05\n";
    let place = Place::new(&[("a.scn", &model), ("a.bltl", properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--timeout", "2s"]);
    assert_eq!(said.code, Some(4), "{}", said.err);
    let results = &said.json()["results"];
    assert_eq!(
        (&results[0]["trials"], &results[1]["stopped_by"]),
        (&0.into(), &"width".into()),
        "{results:#}"
    );
}

#[test]
fn what_falls_short_says_so() {
    let place = Place::new(&[("a.scn", SMALL)]);
    let call = |properties: &str, words: &[&str]| {
        place.write("a.bltl", properties.as_bytes());
        place.call(&[&["check", "a.scn", "a.bltl", "-q"], words].concat())
    };
    let check = "check P(F<=3 s (speed(user) > 0.1 m/s)) >= 0.1\n";
    let estimate = "estimate P(F<=3 s (speed(user) > 1.2 m/s)) within 0.05\n";
    let whole = call(estimate, &[]);
    assert!(whole.code == Some(0) && !whole.out.contains("incomplete"), "{}", whole.out);
    assert!(whole.out.contains("1 estimated; "), "{}", whole.out);
    for (words, word, said) in [
        (["--max-trials", "9"], "incomplete", "incomplete: too few trials for the requested result"),
        (["--max-trials", "0"], "not begun", "not begun: the budget has no trial"),
    ] {
        let found = call(estimate, &words);
        assert_eq!(found.code, Some(4));
        assert!(found.out.contains(said) && found.out.contains(&format!("1 {word}; ")), "{}", found.out);
        let json = call(estimate, &[&words[..], &["--format", "json"]].concat()).json();
        assert_eq!(json["results"][0]["shortfall"], word);
    }
    // An open check is undecided, and a violated one counts for more.
    assert_eq!(call(&format!("{check}{estimate}"), &["--max-trials", "9"]).code, Some(3));
    let violated = "check P(F<=3 s (speed(user) > 0.1 m/s)) <= 0.1\n";
    assert_eq!(call(&format!("{violated}{estimate}"), &["--max-trials", "60"]).code, Some(1));
}

#[test]
fn shared_trials_are_counted_once() {
    let place = Place::new(&[("a.scn", SMALL)]);
    let properties = "estimate P(F<=3 s (speed(user) > 1.2 m/s)) by fixed(trials = 50)\n\
        estimate P(F<=3 s (speed(user) > 1.1 m/s)) by fixed(trials = 80)\n\
        estimate E(max<=1 s (speed(user))) in 0 m/s .. 5 m/s by fixed(trials = 70)\n";
    place.write("a.bltl", properties.as_bytes());
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
    assert!(said.out.contains("3 estimated; 80 trials in "), "{}", said.out);
}

#[test]
fn whole_numbers_are_whole() {
    let model =
        "horizon = 5 steps\nprocess c { var x: 0 .. 9 = 0\n  when true -> 0.5: x = x + 1 | 0.5: { } }\n";
    let properties = "estimate Q(0.5, c.x at end) by fixed(trials = 100)\n";
    let place = Place::new(&[("a.scn", model), ("a.bltl", properties)]);
    let result = &place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json()["results"][0];
    for value in [
        &result["method"]["trials"],
        &result["estimate"],
        &result["low"],
        &result["distribution"]["histogram"]["low"],
        &result["distribution"]["empirical"][0]["value"],
        &result["witnesses"][0]["value"],
    ] {
        assert!(value.is_i64(), "{value} in {result:#}");
    }
    assert_eq!(result["method"]["level"], 0.5);
}
