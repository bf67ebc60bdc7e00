//! Verdicts and choices under every value of a parameter: the rule of the whole, its error, and the choice that is safest.

use crate::cli::formats::validated;
use crate::program::{Place, timeless};
use crate::texts::{answered, compiled};
use serde_json::Value;
use smc::engine::outcome::QueryResult;

/// `c.x` ends as 1 with probability `p`; `d.x` with probability `a * b + (1 - a) * (1 - b)`.
const COINS: &str = "scenario \"coins\"\nhorizon = 1 steps\nparam p = 0.5 in 0 .. 1\n\
    param a = 0.5 in 0 .. 1\nparam b = 0.5 in 0 .. 1\n\
    process c {\n  var x: 0 .. 2 = 0\n  when x == 0 -> p: x = 1 | 1 - p: x = 2\n}\n\
    process d {\n  var x: 0 .. 2 = 0\n  when x == 0 -> a * b + (1 - a) * (1 - b): x = 1 | a + b - 2 * a * b: x = 2\n}\n";

fn results(properties: &str, words: &[&str]) -> Vec<Value> {
    let place = Place::new(&[("a.scn", COINS), ("a.bltl", properties)]);
    let said = place.call(&[&["check", "a.scn", "a.bltl", "-q", "--format", "json"], words].concat());
    assert!(matches!(said.code, Some(0 | 1 | 3 | 4)), "{}{}", said.out, said.err);
    let mut json = said.json();
    validated(&json);
    timeless(&mut json);
    json["results"].as_array().unwrap().clone()
}

/// Satisfied where each value satisfies, violated where one violates; the least favourable value stands for all.
#[test]
fn a_check_holds_where_it_holds_under_every_value() {
    let cases = [
        (">= 0.1", "satisfied", "0.2", 0.2),
        (">= 0.5", "violated", "0.2", 0.2),
        ("<= 0.95", "satisfied", "0.9", 0.9),
        ("<= 0.5", "violated", "0.9", 0.9),
        (">= 0.95", "violated", "0.2", 0.2),
    ];
    for (claim, verdict, least, truth) in cases {
        let text = format!("check P(F (c.x == 1)) {claim} under every p in 0.6, 0.2, 0.9\n");
        let found = &results(&text, &[])[0];
        assert_eq!(
            (&found["verdict"], &found["every"]["least"]),
            (&verdict.into(), &least.into()),
            "{found:#}"
        );
        let (low, high) = (found["low"].as_f64().unwrap(), found["high"].as_f64().unwrap());
        assert!(low <= truth && truth <= high, "{found:#}");
        assert!(
            found["certifies"].as_str().unwrap().ends_with(match verdict {
                "satisfied" => ", under every `p`, error at most 0.01",
                _ => "under p = 0.2",
            }) || least == "0.9",
            "{found:#}"
        );
        assert_eq!(found["settings"].as_object().unwrap().len(), 0);
    }
    // A quantile is decided as a probability, which is small where the quantile is large.
    let text = "check Q(0.1, c.x at end) >= 1.5 under every p in 0.05, 0.01\n";
    let found = &results(text, &[])[0];
    assert_eq!(
        (&found["verdict"], &found["every"]["least"]),
        (&"satisfied".into(), &"0.05".into()),
        "{found:#}"
    );
    let text = "check P(F (c.x == 1)) >= 0.5 under every p in 0.9, 0.5\n";
    let found = &results(text, &["--max-trials", "200"])[0];
    assert_eq!((&found["verdict"], &found["every"]["least"]), (&"undecided".into(), &"0.5".into()));
}

/// A part is the check alone with its share of the error, and the random numbers of all others.
#[test]
fn a_part_is_the_check_with_its_share_of_the_error() {
    let test = "check P(F (c.x == 1)) >= 0.5 by sprt(indifference = 0.05, alpha =";
    let text = format!(
        "check P(F (c.x == 1)) >= 0.5 confidence 99 % by sprt(indifference = 0.05) under every p in 0.6, 0.7\n\
         {test} 0.005, beta = 0.005) under p = 0.6\n{test} 0.005, beta = 0.005) under p = 0.7\n"
    );
    let found = results(&text, &[]);
    for (part, alone) in found[0]["every"]["values"].as_array().unwrap().iter().zip(&found[1..]) {
        for key in ["trials", "successes", "verdict"] {
            assert_eq!(part[key], alone[key], "{key}: {found:#?}");
        }
    }
}

/// In a family of two queries each has half of the error, and each part of the first one half of that.
#[test]
fn parts_share_what_the_family_leaves_them() {
    let text = "family confidence 96 %\ncheck P(F (c.x == 1)) >= 0.5 by sprt(indifference = 0.05) under every p in 0.6, 0.7\n\
        check P(F (c.x == 1)) >= 0.3\n";
    let found = &results(text, &[])[0];
    assert_eq!(found["method"]["alpha"].as_f64(), Some(0.01), "{found:#}");
    assert!(found["certifies"].as_str().unwrap().ends_with("error at most 0.02"), "{found:#}");
}

/// Each point of a sweep has its own whole.
#[test]
fn points_of_a_sweep_have_their_own_whole() {
    let text = "check P(F (d.x == 1)) >= 0.3 under every a in 0.1, 0.9\ncheck P(F (c.x == 1)) >= 0.2\n";
    let found = results(text, &["--set", "b=0.5,0.9"]);
    let told: Vec<_> =
        found.iter().map(|one| (&one["index"], &one["verdict"], &one["settings"]["b"])).collect();
    let settings = |value: f64| serde_json::json!(value);
    assert_eq!(told.iter().filter(|(index, ..)| **index == told[0].0.clone()).count(), 2, "{told:?}");
    let wholes: Vec<_> = found.iter().filter(|one| one["every"].is_object()).collect();
    assert_eq!(wholes.len(), 2);
    assert_eq!((&wholes[0]["verdict"], &wholes[1]["verdict"]), (&"satisfied".into(), &"violated".into()));
    assert_eq!(
        wholes[1]["settings"]["b"].as_f64().or(wholes[1]["settings"]["b"]["value"].as_f64()),
        settings(0.9).as_f64()
    );
}

/// With `b` known the best is to agree with it; under both values of `b` it is to keep to the middle.
const RANK: &str =
    "rank a in 0.1, 0.5, 0.9 by P(F (d.x == 1)) within 0.2 confidence 80 % under every b in 0.1, 0.9\n";

#[test]
fn the_choice_is_that_of_the_greatest_least_score() {
    let alone = results("rank a in 0.1, 0.5, 0.9 by P(F (d.x == 1)) within 0.1 under b = 0.9\n", &[]);
    assert_eq!(alone[0]["choice"], "a = 0.9");
    let found = &results(RANK, &[])[0];
    assert_eq!(found["choice"], "a = 0.5", "{found:#}");
    assert_eq!(found["method"]["name"], "least_score");
    let best: Vec<_> =
        found["every"]["values"].as_array().unwrap().iter().map(|one| &one["best"]["option"]).collect();
    assert_eq!(best, ["a = 0.1", "a = 0.9"]);
    for option in found["options"].as_array().unwrap() {
        let under = option["under"].as_array().unwrap();
        let least = under.iter().map(|one| one["estimate"].as_f64().unwrap()).fold(1.0, f64::min);
        assert_eq!(option["estimate"].as_f64().unwrap().to_bits(), least.to_bits());
        let trials = |one: &Value| one["trials"].as_u64().unwrap();
        assert_eq!(trials(option), under.iter().map(trials).sum::<u64>());
    }
}

/// Over many seeds the joint intervals miss at most as often as they may, and so does the choice.
#[test]
fn the_error_is_shared_by_all_columns() {
    let truth = |a: f64, b: f64| a * b + (1.0 - a) * (1.0 - b);
    let text =
        RANK.replace("0.1, 0.5, 0.9 by", "0.2, 0.4, 0.6 by").replace("0.2 confidence", "0.1 confidence");
    let study = compiled(COINS, &text).unwrap();
    let (mut missed, mut wrong, seeds) = (0, 0, 200);
    for seed in 0..seeds {
        let call = answered(&study, seed, 1, 1_000_000);
        let ranking = call.results[0].rank.as_ref().unwrap();
        let option = |label: &str| label.strip_prefix("a = ").unwrap().parse::<f64>().unwrap();
        let least = |a: f64| truth(a, 0.1).min(truth(a, 0.9));
        let outside = |a: f64, at: usize, low: f64, high: f64| {
            let value = truth(a, [0.1, 0.9][at]);
            value < low || value > high
        };
        missed += u32::from(ranking.options.iter().any(|one| {
            let sides = one.under.iter().enumerate();
            sides.clone().any(|(at, side)| outside(option(&one.label), at, side.value.low, side.value.high))
        }));
        let worth = least(option(ranking.choice.as_ref().unwrap()));
        wrong += u32::from(least(0.4).max(least(0.6)) - worth > ranking.gap + 1e-12);
        assert!(ranking.gap <= 0.1);
    }
    // 20 %, and three deviations of 200 seeds.
    let most = 0.2 * f64::from(seeds as u32) + 3.0 * (0.16 * f64::from(seeds as u32)).sqrt();
    assert!(f64::from(missed) <= most && f64::from(wrong) <= most, "{missed} missed, {wrong} wrong");
    assert!(wrong <= missed, "a wrong choice has a wrong interval");
}

/// Where the parameter changes nothing, both worlds have the same trials, and the choice is that of one.
#[test]
fn values_that_change_nothing_change_no_choice() {
    let text = "rank a in 0.1, 0.5, 0.9 by P(F (d.x == 1)) within 0.1 under every p in 0.2, 0.3\n";
    let study = compiled(&COINS.replace("param b = 0.5", "param b = 0.9"), text).unwrap();
    let call = answered(&study, 0, 1, 1_000_000);
    let result: &QueryResult = &call.results[0];
    assert_eq!(result.rank.as_ref().unwrap().choice.as_deref(), Some("a = 0.9"));
    for option in &result.rank.as_ref().unwrap().options {
        let [one, other] = option.under.as_slice() else { panic!("two values") };
        assert_eq!((one.value, one.counts), (other.value, other.counts), "{}", option.label);
    }
}

/// People under three models: their names stand in the report, and choices work as values of a sweep.
#[test]
fn people_are_asked_under_every_model() {
    let scene = "horizon = 4 s\nstep = 0.02 s\nparam people = smc1 in smc1, cfs2, helbing2000\n\
        scene { wall (0, 0) -- (20, 0); wall (0, 3) -- (20, 3); region exit: rect (18, 0) .. (20, 3) }\n\
        kind adult: preset people\nagent user: adult { at = (1, 1.5); route = exit }\n\
        agent other: adult { at = (6, 1.5); route = (1, 1.5) }\n\
        moves user for 1 s { heading 20 deg; heading -20 deg; stop }\n";
    let text = "check P(F<=4 s (travelled(user) > 1 m)) >= 0.5 under every people\n\
        rank moves of user by P(F<=4 s (travelled(user) > 1 m)) within 0.2 under every people\n";
    let place = Place::new(&[("a.scn", scene), ("a.bltl", text)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    for name in ["smc1", "cfs2", "helbing2000"] {
        assert_eq!(said.out.matches(&format!("people = {name} ")).count(), 2, "{}", said.out);
    }
    let swept = place.call(&["check", "a.scn", "a.bltl", "-q", "--set", "people=smc1,cfs2", "--only", "1"]);
    assert_eq!(swept.code, Some(0), "{}{}", swept.out, swept.err);
    assert_eq!(swept.out.matches("people = helbing2000 ").count(), 1, "it is asked once: {}", swept.out);
    let table = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "csv"]);
    assert_eq!(table.out.lines().filter(|line| line.contains(",under,")).count(), 6, "{}", table.out);
}

/// A scene in which people walk as `smc1`, with a field that the collision-free speed model lacks.
const WALK: &str = "horizon = 4 s\nstep = 0.02 s\n\
    scene { wall (0, 0) -- (20, 0); wall (0, 3) -- (20, 3); region exit: rect (18, 0) .. (20, 3) }\n\
    kind adult: sfm preset smc1 { headway = 0.7 s; radius = 0.2 m }\n\
    agent user: adult { at = (1, 1.5); route = exit }\n\
    moves user for 1 s { heading 20 deg; heading -20 deg; stop }\n";

/// `--models` asks the same files under each model: checks and rankings as a whole, estimates one by one.
#[test]
fn the_call_asks_under_models() {
    let text = "property far = F<=4 s (travelled(user) > 1 m)\n\
        check P(far) >= 0.5\nestimate P(far) within 0.2\n\
        rank moves of user by P(far) within 0.2\n\
        rank moves of user by P(far) within 0.2 by one_challenger()\n";
    let place = Place::new(&[("a.scn", WALK), ("a.bltl", text)]);
    let call = |words: &[&str]| place.call(&[&["check", "a.scn", "a.bltl"], words].concat());
    let said = call(&["--models", "smc1,cfs2,helbing2000"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    assert!(said.out.contains("people as cfs2, helbing2000, smc1\n"), "{}", said.out);
    assert!(said.out.contains("satisfied under 3 of 3"), "{}", said.out);
    assert!(said.out.contains("the choice survives: it is best under each value"), "{}", said.out);
    assert!(
        said.err.contains("W0804") && said.err.matches("`headway` is left out").count() == 1,
        "{}",
        said.err
    );
    let json = call(&["--models", "smc1,cfs2", "-q", "--format", "json"]).json();
    let settings: Vec<_> = json["results"].as_array().unwrap().iter().map(|one| &one["settings"]).collect();
    // The check and the ranking once, the estimate and the ranking with its own procedure twice.
    assert_eq!(settings.len(), 6);
    assert_eq!(settings.iter().filter(|set| set["model"].is_null()).count(), 2, "{settings:?}");
    let replay = json["results"][0]["witnesses"][0]["command"].as_str().unwrap().to_owned();
    let line = replay.replace('\'', "");
    let words: Vec<&str> = line.split(' ').skip(1).collect();
    assert_eq!(place.call(&words).code, Some(0), "{replay}");
    let alone = call(&["-q", "--only", "0"]);
    assert!(alone.out.contains("people as smc1\n"), "{}", alone.out);
}

#[test]
fn models_that_are_none_are_refused() {
    let cases = [
        ("smc1", "`--models` needs two presets at least"),
        ("smc1,smc1", "`smc1` is listed twice"),
        ("smc1,cfs3", "there is no preset `cfs3`"),
    ];
    let place =
        Place::new(&[("a.scn", WALK), ("c.scn", COINS), ("a.bltl", "check P(F contact(user)) >= 0.5\n")]);
    for (models, said) in cases {
        let found = place.call(&["check", "a.scn", "a.bltl", "--models", models]);
        assert!(
            found.code == Some(2) && found.err.contains(said) && found.err.contains("E0705"),
            "{}",
            found.err
        );
    }
    let found = place.call(&["check", "c.scn", "a.bltl", "--models", "smc1,cfs2"]);
    assert!(
        found.code == Some(2) && found.err.contains("no kind starts from a preset of people"),
        "{}",
        found.err
    );
}
