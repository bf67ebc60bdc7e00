//! What results claim: nothing that the trials do not bear out, and under the right name.

use crate::program::{Place, timeless};
use serde_json::Value;

/// Is over after a time between 5 s and 15 s, all alike.
const UNIFORM: &str = "horizon = 20 s
process p {
  var over = false
  var again = false
  when !over after uniform(5 s, 15 s) -> over = true
}
";

/// One trial in ten drives somebody to a speed that no human reaches.
const DIVERGING: &str = "horizon = 4 s
step = 0.02 s
kind adult: sfm preset helbing2000 { noise = 0.05 m/s }
agent wild: adult {
  at = (2, 2)
  speed = choice(1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1 m/s, 1e9 m/s)
  route = (60, 2)
}
";

const GAMBLER: &str = "horizon = 400 steps
process gambler {
  var wealth: 0 .. 14 = 2
  when wealth > 0 & wealth < 14 -> 0.3: wealth = wealth + 1 | 0.7: wealth = wealth - 1
}
";

fn run(model: &str, properties: &str, words: &[&str]) -> Vec<Value> {
    let place = Place::new(&[("a.scn", model), ("a.bltl", properties)]);
    let call = [&["check", "a.scn", "a.bltl", "-q", "--format", "json"], words].concat();
    let said = place.call(&call);
    assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{}", said.err);
    let json = said.json();
    // The replay line gives each result again, to the last digit.
    let results = json["results"].as_array().unwrap().clone();
    for result in &results {
        let line = result["replay"].as_str().unwrap();
        let words: Vec<&str> = line.split(' ').skip(1).chain(["-q", "--format", "json"]).collect();
        let mut again = place.call(&words).json()["results"][0].clone();
        let mut first = result.clone();
        for one in [&mut first, &mut again] {
            timeless(one);
            // A deadline is replayed as a largest number of trials.
            one["stopped_by"] = Value::Null;
        }
        assert_eq!(again, first, "{line}");
    }
    results
}

fn number(value: &Value, field: &str) -> f64 {
    value[field].as_f64().unwrap_or_else(|| panic!("{field} of {value:#}"))
}

#[test]
fn the_check_of_an_expectation_takes_no_more_trials_than_its_sequence_needs() {
    let properties = "check E(time_until(p.over)) in 0 s .. 20 s >= 9 s\n";
    let result = &run(UNIFORM, properties, &[])[0];
    // 1060 by Hoeffding's inequality at a fixed size; 275 for a sequence of values spread evenly.
    assert_eq!((&result["verdict"], &result["trials"]), (&"satisfied".into(), &276.into()), "{result:#}");
    let early = &run(UNIFORM, properties, &["--max-trials", "200"])[0];
    assert!(number(early, "high") - number(early, "low") < 3.0, "{early:#}");
    assert!(early["interval"].as_str().unwrap().starts_with("time-uniform"), "{early:#}");
}

/// Of the two claims of a check one is the opposite of the other: where P equals the threshold only one is false.
#[test]
fn a_check_certifies_the_side_that_it_asks_about() {
    let near = "P(F<=10 s p.over)";
    let asked =
        [(">=", 0.3), (">=", 0.7), (">", 0.3), (">", 0.7), ("<", 0.3), ("<", 0.7), ("<=", 0.3), ("<=", 0.7)];
    let text: String =
        asked.iter().map(|(relation, theta)| format!("check {near} {relation} {theta}\n")).collect();
    let found = run(UNIFORM, &text, &[]);
    for ((relation, theta), result) in asked.into_iter().zip(&found) {
        let holds = (theta < 0.5) == relation.starts_with('>');
        let certified = match (holds, relation) {
            (true, relation) => relation,
            (false, ">=") => "<",
            (false, ">") => "<=",
            (false, "<") => ">=",
            (false, _) => ">",
        };
        assert_eq!(result["verdict"], if holds { "satisfied" } else { "violated" });
        let certified = format!("{near} {certified} {theta}, error at most 0.01");
        assert_eq!(result["certifies"], certified, "{relation}");
    }
}

#[test]
fn an_undecided_check_of_a_family_errs_no_more_than_its_share() {
    let one = "check P(F<=10 s p.over) >= 0.5\n";
    let family = format!("family confidence 95 %\n{one}{one}{one}{one}{one}");
    for result in run(UNIFORM, &family, &["--max-trials", "30"]) {
        assert_eq!(result["verdict"], "undecided");
        assert!(result["certifies"].as_str().unwrap().ends_with(", error at most 0.01"), "{result:#}");
        assert_eq!(result["interval"], "time-uniform, 99 %");
    }
    let sure =
        &run(UNIFORM, "check P(F<=10 s p.over) >= 0.5 confidence 99.9 %\n", &["--max-trials", "30"])[0];
    assert!(sure["certifies"].as_str().unwrap().ends_with("error at most 0.001"), "{sure:#}");
    let alone = &run(UNIFORM, one, &["--max-trials", "30"])[0];
    assert_eq!(alone["interval"], "time-uniform, 95 %");
}

#[test]
fn lost_paths_of_splitting_are_in_neither_reading() {
    let properties =
        "estimate P(F<=4 s (travelled(wild) >= 6 m)) by splitting(replicas = 50, runs = 4, plain = 500)\n";
    let result = &run(DIVERGING, properties, &[])[0];
    let unresolved = number(result, "unresolved") / 500.0;
    assert!((0.05..0.15).contains(&unresolved), "{unresolved}");
    assert_eq!(result["splitting"]["agrees"], true, "{result:#}");
    assert!(number(result, "low") <= 0.0 && number(result, "high") >= 0.1, "{result:#}");
    assert!(number(result, "estimate") > 0.03, "the middle of both readings: {result:#}");
    let warnings = result["warnings"].to_string();
    assert!(
        warnings.contains("paths of splitting are unresolved; the interval covers both cases"),
        "{warnings}"
    );
}

#[test]
fn splitting_is_kept_above_the_bound_beside_it_and_never_contradicts_it() {
    let properties =
        "estimate P(F (gambler.wealth >= 6)) by splitting(replicas = 20, runs = 4, plain = 300)\n";
    let place = Place::new(&[("a.scn", GAMBLER), ("a.bltl", properties)]);
    let mut between = 0;
    for seed in 0..60 {
        let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--seed", &seed.to_string()];
        let result = &place.call(&words).json()["results"][0];
        let splitting = &result["splitting"];
        let (bound, high) = (number(splitting, "plain_bound"), number(splitting, "plain_high"));
        let estimate = number(splitting, "estimate");
        let certified = result["certifies"].as_str().unwrap();
        let end = |sign: &str| -> Option<f64> {
            certified.split_once(&format!(") {sign} "))?.1.split(',').next()?.parse().ok()
        };
        let (least, most) = (end(">=").unwrap_or(0.0), end("<=").unwrap_or(1.0));
        assert!(least <= most, "{certified}");
        // Above the bound of one side, at 95 %, and within the interval of both, at 99 %.
        between += usize::from(estimate > bound && estimate <= high);
        if estimate >= number(splitting, "plain_low") && estimate <= high {
            assert_eq!((number(result, "estimate"), &splitting["agrees"]), (estimate, &true.into()));
            assert!(least <= estimate && estimate <= most, "{result:#}");
        } else {
            assert_eq!((&result["estimate"], &splitting["agrees"]), (&Value::Null, &false.into()));
            assert_eq!(result["method"]["name"], "clopper_pearson");
        }
    }
    assert!(between > 0, "no seed shows it");
}

#[test]
fn plain_trials_that_the_clock_ended_have_a_bound_that_holds_at_all_times() {
    let properties =
        "estimate P(F (gambler.wealth >= 14)) by splitting(replicas = 100, runs = 10, plain = 500)\n";
    let result = &run(GAMBLER, properties, &["--max-trials", "300"])[0];
    assert_eq!(result["interval"], "time-uniform, 99 %, of the plain trials");
    // 3/n at a number fixed beforehand.
    assert!(number(&result["splitting"], "plain_bound") > 0.015, "{result:#}");
}

#[test]
fn clipped_metrics_are_certified_as_such() {
    let properties = "\
estimate E(time_until(p.again)) in 0 s .. 20 s
check E(time_until(p.again)) in 0 s .. 20 s >= 15 s
estimate E(time_until(p.over)) in 0 s .. 20 s
";
    let results = run(UNIFORM, properties, &[]);
    for (result, count) in results.iter().zip([true, true, false]) {
        let said = result["certifies"].as_str().unwrap();
        assert_eq!(said.contains("E(time_until(p.again), clipped to 0 s .. 20 s) "), count, "{said}");
        assert_eq!(number(result, "clipped") > 0.0, count);
    }
}

#[test]
fn a_quantile_that_was_cut_short_holds_at_all_times() {
    let properties =
        "estimate Q(0.5, time_until(p.over))\nestimate Q(0.5, time_until(p.over)) by dkw(trials = 1000)\n";
    let whole = run(UNIFORM, properties, &[]);
    let short = run(UNIFORM, properties, &["--max-trials", "999"]);
    for (whole, short) in whole.iter().zip(&short) {
        assert_eq!(whole["interval"], "fixed size, 95 %");
        assert_eq!(short["interval"], "time-uniform, 95 %");
        let width = |one: &Value| number(one, "high") - number(one, "low");
        assert!(width(short) > 1.2 * width(whole), "{short:#}");
        assert!(short["certifies"].as_str().unwrap().ends_with("error at most 0.05"));
        assert_eq!(short["warnings"], serde_json::json!([]), "nothing contradicts it");
    }
}

#[test]
fn the_band_holds_both_readings_of_unresolved_trials() {
    let metric = "max<=2 s (speed(wild))";
    let properties = format!("estimate Q(0.5, {metric})\nestimate E({metric}) in 0 m/s .. 3 m/s\n");
    for result in run(DIVERGING, &properties, &[]) {
        let lost = number(&result, "unresolved") / number(&result, "trials");
        assert!(lost > 0.05, "{lost}");
        let band = number(&result["distribution"], "band");
        assert!((band - (0.042_946_94 + lost)).abs() < 1e-6, "{band} {lost}");
    }
}

/// The second step of `r` does not come in some trials, the first one of `q` always does.
const RACE: &str = "horizon = 10 s
process q { var n: 0 .. 2 = 0
  when n < 2 after uniform(0.5 s, 2 s) -> n = n + 1 }
process r { var n: 0 .. 2 = 0
  when n < 2 after uniform(0.5 s, 6 s) -> n = n + 1 }
";

#[test]
fn a_difference_of_times_is_infinite_in_either_direction() {
    let (a, b) = ("time_until(q.n == 1)", "time_until(r.n == 2)");
    let ask = |level: f64, a: &str, b: &str| format!("estimate Q({level}, {a} - {b})\n");
    let properties = [ask(0.5, a, b), ask(0.5, b, a), ask(0.01, a, b), ask(0.99, b, a)].concat();
    let results = run(RACE, &properties, &["--max-trials", "200"]);
    let ends = |k: usize| {
        let histogram = &results[k]["distribution"]["histogram"];
        (number(histogram, "below"), number(histogram, "beyond"))
    };
    let (below, beyond) = ends(0);
    assert!(below > 0.0 && beyond == 0.0, "{:#}", results[0]);
    assert_eq!(ends(1), (beyond, below));
    // Only what is late lies beyond the horizon.
    assert_eq!(results[2]["estimate"], Value::Null);
    assert_eq!((&results[2]["censored"], &results[3]["censored"]), (&false.into(), &true.into()));
}

#[test]
fn checks_of_quantiles_say_what_their_figures_are_of() {
    let properties = "check Q(0.5, time_until(p.over)) >= 7 s\n";
    let result = &run(UNIFORM, properties, &[])[0];
    assert_eq!(
        (&result["verdict"], &result["of"]),
        (&"satisfied".into(), &"P(time_until(p.over) < 7 s)".into())
    );
    assert_eq!(
        result["certifies"],
        "Q(0.5, time_until(p.over)) >= 7 s, tested as P(time_until(p.over) < 7 s) <= 0.5, error at most 0.01"
    );
    let place = Place::new(&[("a.scn", UNIFORM), ("a.bltl", properties)]);
    let text = place.call(&["check", "a.scn", "a.bltl", "-q"]).out;
    assert!(text.contains("P(time_until(p.over) < 7 s): 0."), "{text}");
    assert!(text.contains("(10 with it, 46 without)") && text.contains("without it in trial 0 at"), "{text}");
    // A trial below the threshold speaks against the claim.
    assert_eq!(
        (&result["witnesses"][0]["shows"], &result["witnesses"][0]["passing"]),
        (&"fails".into(), &true.into())
    );
}

#[test]
fn a_report_names_its_generator_and_its_inputs() {
    let properties = "estimate P(F<=10 s p.over) within 0.1\n";
    let place = Place::new(&[("a.scn", UNIFORM), ("a.bltl", properties)]);
    let call = || place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let first = call();
    assert_eq!(first["generator"], serde_json::json!({ "name": "philox4x32-10", "layout": 1 }));
    assert_eq!(first["inputs"][0]["file"], "a.scn");
    assert!(first["inputs"][1]["hash"].as_str().unwrap().starts_with("sha256:"));
    place.write("a.bltl", format!("// The same.\n{properties}").as_bytes());
    let second = call();
    assert_eq!(first["inputs"][0], second["inputs"][0]);
    assert_ne!(first["inputs"][1], second["inputs"][1]);
}

#[test]
fn methods_have_all_their_numbers() {
    let properties = "\
check E(time_until(p.over)) in 0 s .. 20 s >= 9 s
estimate E(time_until(p.over)) in 0 s .. 20 s within 0.5 s
estimate Q(0.5, time_until(p.over))
estimate P(F<=10 s p.over) within 0.0035
";
    let results = run(UNIFORM, properties, &["--max-trials", "400"]);
    let has = |at: usize, names: &[&str]| {
        let found: Vec<&String> = results[at]["method"].as_object().unwrap().keys().collect();
        for name in names {
            assert!(found.iter().any(|key| key == name), "{name}: {found:?}");
        }
    };
    has(0, &["delta", "theta", "low", "high"]);
    has(1, &["epsilon", "delta", "cap", "low", "high"]);
    has(2, &["trials", "delta", "level"]);
    has(3, &["epsilon", "delta", "trials"]);
    assert_eq!(
        (&results[3]["method"]["name"], number(&results[3]["method"], "trials")),
        (&"okamoto".into(), 150_567.0)
    );
    // As it is told, it could be written.
    let fewest = "estimate P(F (gambler.wealth >= 6)) by splitting(replicas = 50, runs = 3)\n";
    assert_eq!(number(&run(GAMBLER, fewest, &[])[0]["method"], "plain"), 100.0);
}

#[test]
fn forecasts_are_the_same_on_any_number_of_threads() {
    let properties = "check P(F<=10 s p.over) >= 0.3\nestimate P(F<=10 s p.over) within 0.02\n";
    let place = Place::new(&[("a.scn", UNIFORM), ("a.bltl", properties)]);
    let trials = |threads: &str| {
        let said = place.call(&["check", "a.scn", "a.bltl", "--forecast", "--format", "json", "-j", threads]);
        let json = said.json();
        json["forecast"].as_array().unwrap().iter().map(|one| one["trials"].clone()).collect::<Vec<_>>()
    };
    let two = trials("2");
    assert_eq!(trials("1"), two);
    assert_eq!(trials("7"), two);
}
