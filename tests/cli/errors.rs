//! What is printed where something is wrong: the inputs, the model in some trial, or nothing could be sampled.

use super::formats::validated;
use crate::program::{Place, SMALL, Said, timeless};

const WRONG: &str = "property p = F<=1 s contact(user)\ncheck P(q) >= 0.5\ncheck P(p) >= 2\n";

fn wrong(format: &str, words: &[&str]) -> Said {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", WRONG)]);
    place.call(&[&["check", "a.scn", "a.bltl", "-q", "--format", format], words].concat())
}

#[test]
fn errors_of_the_inputs_are_in_the_json() {
    let said = wrong("json", &[]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("error[E0201]"), "people read it all the same: {}", said.err);
    let json = said.json();
    validated(&json);
    assert_eq!(json["results"], serde_json::json!([]));
    assert_eq!(json["error"]["bug"], false);
    assert!(json["error"]["message"].as_str().unwrap().contains("and 1 more error"), "{json:#}");
    let found = json["diagnostics"].as_array().unwrap();
    assert_eq!(found.len(), 2);
    let (name, threshold) = (&found[0], &found[1]);
    assert_eq!((&name["code"], &name["severity"]), (&"E0201".into(), &"error".into()));
    assert_eq!((&name["file"], &name["line"], &name["column"]), (&"a.bltl".into(), &2.into(), &9.into()));
    assert_eq!(name["end"], serde_json::json!({ "line": 2, "column": 10 }));
    assert_eq!((&threshold["code"], &threshold["line"]), (&"E0601".into(), &3.into()));
    assert!(threshold["hint"].as_str().unwrap().contains("2 %"), "{threshold}");
}

#[test]
fn errors_of_the_inputs_are_red_test_cases_and_annotations() {
    let said = wrong("junit", &[]);
    assert_eq!(said.code, Some(2));
    assert!(said.out.starts_with("<?xml") && said.out.contains("errors=\"2\""), "{}", said.out);
    assert!(said.out.contains("type=\"E0601\"") && said.out.contains("a.bltl:2:9"), "{}", said.out);
    let said = wrong("github", &[]);
    assert!(
        said.out.contains("::error file=a.bltl,line=2,col=9,endColumn=10,title=E0201::unknown name `q`"),
        "{}",
        said.out
    );
    assert_eq!(said.out.matches("::error ").count(), 2, "{}", said.out);
}

#[test]
fn errors_without_a_place_and_of_the_call_are_reported_too() {
    let place = Place::new(&[("a.bltl", "check P(1 < 2) >= 0.5\n")]);
    let said = place.call(&["check", "none.scn", "a.bltl", "-q", "--format", "json"]);
    let json = said.json();
    validated(&json);
    assert_eq!(json["diagnostics"][0]["code"], "E0701");
    assert!(json["diagnostics"][0]["line"].is_null());
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", "check P(F<=1 s contact(user)) >= 0.5\n")]);
    let call = |format: &str, words: &[&str]| {
        place.call(&[&["check", "a.scn", "a.bltl", "-q", "--format", format], words].concat())
    };
    let said = call("json", &["--only", "nobody"]);
    validated(&said.json());
    assert_eq!(
        (said.code, &said.json()["error"]["message"]),
        (Some(2), &"error[E0705]: `--only nobody`: no query is about `nobody`".into())
    );
    assert!(said.err.contains("write a number from 0 to 0"), "{}", said.err);
    let said = call("github", &["--set", "densty=0.2"]);
    assert!(said.out.starts_with("::error title=E0210::--set densty: unknown parameter"), "{}", said.out);
    let said = call("json", &["--set", "density=1 /m^2"]);
    assert!(said.json()["error"].is_null() && said.code != Some(2), "{}", said.err);
    let crowded = SMALL.replace("round(density * area(hall))", "900");
    let place = Place::new(&[("a.scn", &crowded), ("a.bltl", "check P(F<=1 s contact(user)) >= 0.5\n")]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]);
    assert_eq!((said.code, &said.json()["diagnostics"][0]["code"]), (Some(2), &"E0801".into()));
}

#[test]
fn what_a_trial_shows_has_a_place_and_a_code() {
    let scenario = "horizon = 50 steps\nprocess p {\n  var x = 0\n  var n: 0 .. 9 = 0\n  \
                    when true -> 3/4: x = x + 0.5 | 1/4: n = n + 1\n}\n";
    let place = Place::new(&[
        ("a.scn", scenario),
        ("a.bltl", "check P(F<=#2 p.n > 0) >= 0.2\ncheck P(F p.n > 20) >= 0.5\n"),
    ]);
    let call = |format: &str| place.call(&["check", "a.scn", "a.bltl", "-q", "--format", format]);
    let said = call("json");
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("error[E0903]: trial ") && said.err.contains("a.scn:4:7"), "{}", said.err);
    assert!(said.err.contains("= help: add a guard, or widen the range"), "{}", said.err);
    let json = said.json();
    validated(&json);
    let shown = &json["diagnostics"][0];
    assert_eq!(
        (&shown["code"], &shown["line"], &shown["file"]),
        (&"E0903".into(), &4.into(), &"a.scn".into())
    );
    assert!(shown["label"].as_str().unwrap().contains("p.n = 9"), "{json:#}");
    assert!(call("github").out.contains("::error file=a.scn,line=4,col=7"), "{}", call("github").out);
    assert!(call("junit").out.contains("type=\"E0903\""), "{}", call("junit").out);
}

#[test]
fn a_wrong_call_has_a_code_and_a_hint() {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", "check P(F<=1 s contact(user)) >= 0.5\n")]);
    for (words, code, hint) in [
        (&["check", "a.scn", "a.bltl", "--only", "7"][..], "E0705", "a number from 0 to 0"),
        (&["check", "a.scn", "a.bltl", "--threads", "0"], "E0705", "a number from 1"),
        (
            &["check", "a.scn", "a.bltl", "-q", "--max-trials", "9", "--report", "none/a.html"],
            "E0706",
            "the folder",
        ),
        (&["simulate", "a.scn", "--until", "900"], "E0705", "horizon"),
        (&["simulate", "a.scn", "--trials", "0"], "E0705", "from 1"),
        (&["simulate", "a.scn", "--move", "heading 0.5 rad"], "E0705", "the moves are own way"),
        (&["simulate", "a.scn", "--output", "none/a.csv"], "E0706", "the folder"),
        (&["fmt", "a.txt"], "E0705", "--language"),
        (&["fmt", "none.scn"], "E0701", "relative"),
        (&["fmt", "-", "-"], "E0701", "relative"),
        (&["explain", "E9999"], "E0705", "lists all names"),
        (&["drift", "none.csv", "--before", "0.9", "--after", "0.8"], "E0701", "relative"),
        (&["drift", "a.scn", "--before", "0.9", "--after", "0.8"], "E0707", "0 or 1"),
        (&["drift", "a.scn", "--before", "0.9", "--after", "0.9"], "E0705", "--before"),
    ] {
        let said = place.call(words);
        assert_eq!(said.code, Some(2), "{words:?}\n{}", said.err);
        assert!(said.err.contains(&format!("error[{code}]: ")), "{words:?}\n{}", said.err);
        assert!(said.err.contains(hint), "{words:?}\n{}", said.err);
    }
}

#[test]
fn warnings_stand_beside_the_results() {
    let query = "family confidence 95 %\nestimate P(F<=1 s contact(user)) within 0.3 confidence 90 %\n";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", query)]);
    let call = |format: &str| place.call(&["check", "a.scn", "a.bltl", "-q", "--format", format]);
    let json = call("json").json();
    validated(&json);
    assert_eq!(json["diagnostics"][0]["code"], "W0601");
    assert_eq!(json["diagnostics"][0]["severity"], "warning");
    assert!(json["error"].is_null() && json["results"].as_array().unwrap().len() == 1);
    let out = call("github").out;
    assert!(out.contains("::warning file=a.bltl,line=2,"), "{out}");
}

/// Some trial leaves the range of a variable, which is known only when it comes.
const LEAVES: &str = "horizon = 40 steps
process walk {
  var wear = 0
  var n: 0 .. 28 = 0
  when true -> 1/2: { n = n + 1; wear = wear + 0.5 } | 1/2: { wear = wear + 0.25 }
}
";

#[test]
fn what_was_decided_before_an_error_of_the_model_is_printed() {
    let properties = "check P(F<=4 steps (walk.n >= 1)) >= 0.5 by sprt(indifference = 0.2)\n\
                      estimate P(F<=40 steps (walk.wear > 100)) by okamoto(epsilon = 0.001, delta = 0.05)\n";
    let place = Place::new(&[("a.scn", LEAVES), ("a.bltl", properties)]);
    let call = |format: &str| place.call(&["check", "a.scn", "a.bltl", "-q", "--format", format]);
    let said = call("json");
    let json = said.json();
    validated(&json);
    assert_eq!(said.code, Some(2), "{json:#}");
    assert!(json["error"]["message"].as_str().unwrap().starts_with("trial "), "{json:#}");
    let results = json["results"].as_array().unwrap();
    assert_eq!((results.len(), &results[0]["verdict"]), (1, &"satisfied".into()), "{json:#}");
    let out = call("github").out;
    assert!(out.contains("title=E0903::trial "), "{out}");
    let out = call("junit").out;
    assert!(out.contains("type=\"E0903\""), "{out}");
}

#[test]
fn without_a_trial_nothing_is_claimed_and_the_replay_line_says_so() {
    let properties = "\
check P(F<=3 s contact(user)) >= 0.3
estimate P(F<=3 s contact(user)) within 0.01
estimate E(max<=2 s (speed(user))) in 0 m/s .. 3 m/s
estimate Q(0.5, time_until(contact(user)))
compare P(F<=3 s contact(user)) under density = 0.2 /m^2 with density = 0.8 /m^2
rank moves of user by P(F<=3 s contact(user)) within 0.02
";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", properties)]);
    let call = |words: &[&str]| place.call(&[&["check", "a.scn", "a.bltl", "-q"], words].concat());
    let said = call(&["--format", "json", "--max-trials", "0"]);
    assert_eq!(said.code, Some(3));
    let json = said.json();
    validated(&json);
    let results = json["results"].as_array().unwrap();
    assert_eq!(results.len(), 6);
    for result in results {
        assert_eq!((&result["trials"], &result["certifies"]), (&0.into(), &"".into()), "{result:#}");
        assert!(result["estimate"].is_null(), "{result:#}");
    }
    let ends = |at: usize| (results[at]["low"].as_f64(), results[at]["high"].as_f64());
    assert_eq!((ends(0), ends(1)), ((Some(0.0), Some(1.0)), (Some(0.0), Some(1.0))));
    assert_eq!((ends(2), ends(3)), ((Some(0.0), Some(3.0)), (None, None)));
    assert_eq!((ends(4), ends(5)), ((Some(-1.0), Some(1.0)), (Some(0.0), Some(1.0))));
    assert!(results[5]["choice"].is_null() && results[5]["gap"].is_null());
    let text = call(&["--max-trials", "0"]).out;
    assert!(text.contains("no choice: nothing was sampled"), "{text}");
    assert!(!text.contains("certified") && !text.contains('∞') && !text.contains('?'), "{text}");
    assert_eq!(text.matches("nothing was sampled").count(), 6, "{text}");
    // A deadline that leaves no time is replayed by a call that takes no trial either.
    let json = call(&["--format", "json", "--timeout", "1ms"]).json();
    let last = &json["results"][5];
    assert_eq!(last["trials"], 0, "{last:#}");
    let replay = last["replay"].as_str().unwrap();
    assert!(replay.ends_with("--total-trials 0"), "{replay}");
    let words: Vec<&str> = replay.split(' ').skip(1).chain(["--format", "json"]).collect();
    let mut again = place.call(&words).json()["results"][0].clone();
    let mut last = last.clone();
    for result in [&mut again, &mut last] {
        timeless(result);
        result["stopped_by"] = "".into();
    }
    assert_eq!(again, last);
}

#[test]
fn a_ranking_with_few_trials_takes_those_there_are() {
    let place = Place::new(&[
        ("a.scn", SMALL),
        ("a.bltl", "rank moves of user by P(F<=3 s !contact(user)) within 0.02\n"),
    ]);
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "5"];
    let result = place.call(&words).json()["results"][0].clone();
    assert_eq!(result["trials"], 25, "five of each of five options");
    assert!(result["choice"].is_string(), "{result:#}");
}

/// Two push each other beyond every human speed at once.
const DIVERGES: &str = "horizon = 4 s
step = 0.02 s
kind adult: sfm preset helbing2000 { noise = 0.05 m/s; A = 1e9 N }
agent wild: adult { at = (2, 2); route = (60, 2) }
agent other: adult { at = (3, 2) }
moves wild for 1 s { heading from -30 deg to 30 deg by 30 deg }
";

#[test]
fn where_no_trial_is_resolved_the_cause_is_named() {
    let properties = "\
property onward = F<=4 s (travelled(wild) > 2 m)
check P(onward) >= 0.9
estimate P(onward) within 0.05
rank moves of wild by P(onward) within 0.1
";
    let place = Place::new(&[("a.scn", DIVERGES), ("a.bltl", properties)]);
    let words = ["check", "a.scn", "a.bltl", "-q", "--max-trials", "200"];
    let json = place.call(&[&words[..], &["--format", "json"]].concat()).json();
    validated(&json);
    for result in json["results"].as_array().unwrap() {
        assert_eq!(result["certifies"], "", "{result:#}");
        assert!(result["estimate"].is_null());
        let warning = result["warnings"][0].as_str().unwrap();
        for part in [
            "all ",
            "trial 0: diverged at 0.02 s: wild exceeded 15 m/s, the limit for a person (",
            "try a smaller step",
        ] {
            assert!(warning.contains(part), "{part}: {warning}");
        }
    }
    assert_eq!(json["results"][0]["stopped_by"], "unresolved");
    assert_eq!(json["results"][1]["stopped_by"], "unresolved");
    assert!(json["results"][2]["choice"].is_null());
    let text = place.call(&words).out;
    assert!(!text.contains("narrow enough") && !text.contains("boundary"), "{text}");
    // The command of the warning shows the trial.
    let warning = json["results"][2]["warnings"][0].as_str().unwrap();
    assert!(warning.ends_with("--move 'own way'"), "{warning}");
}

#[test]
fn the_hint_fits_the_cause() {
    let door = "horizon = 20 s
step = 0.05 s
scene { region hall: rect (0, 0) .. (5, 5) }
kind adult: sfm preset helbing2000
agent me: adult { at = (9, 2); route = (20, 2) }
source door: adult { at = uniform in hall; every = exponential(10 s); route = (20, 2); limit = 3 }
";
    let properties = "check P(F<=20 s (travelled(me) > 20 m)) >= 0.5\n\
                      check P(F<=5 s (mean(speed(a) for a in door) > 2 m/s)) >= 0.5\n";
    let place = Place::new(&[("a.scn", door), ("a.bltl", properties)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let warning = |at: usize| json["results"][at]["warnings"][0].as_str().unwrap().to_owned();
    assert!(
        warning(0).contains("more than 3 agents arrived by source `door`; write a larger `limit`"),
        "{}",
        warning(0)
    );
    assert!(
        warning(1).contains("is over an empty set at 0 s") && !warning(1).contains("step"),
        "{}",
        warning(1)
    );
}

#[test]
fn a_step_that_is_too_long_for_the_forces_is_warned_of_once() {
    let model = |step: &str, kinds: &str| {
        format!(
            "horizon = 1 s\nstep = {step}\nparam n = 7\nscene {{ region hall: rect (0, 0) .. (9, 9) }}\n{kinds}\n\
             agents crowd[n]: adult {{ at = uniform in hall }}\nagent me: adult {{ at = (20, 2) }}\n"
        )
    };
    let preset = |name: &str| format!("kind adult: sfm preset {name}");
    let helbing = preset("helbing2000");
    let heavy = "kind adult: sfm preset helbing2000 { mass = uniform(50 kg, 90 kg); A = 4000 N }";
    let fast = "kind adult: sfm preset helbing2000 { speed = 5 m/s }";
    let steep = "kind adult: sfm preset helbing2000 { speed = 3 m/s; A = 500 N; B = 0.02 m }";
    let cases: [(&str, &str, &[&str]); 12] = [
        ("0.1 s", &helbing, &["`adult` (at most 0.0461 s)", "`step = 0.025 s`", "n = 6"]),
        ("1 s / 10", &helbing, &["`step = 0.025 s`"]),
        ("1 s / 20", &helbing, &["`step = 0.025 s`"]),
        ("1 s / 15", &helbing, &["`step = 1 s / 30`"]),
        ("0.1 s", &preset("smc1"), &["(at most 0.05 s)", "`step = 0.05 s`", "fifth of `tau`"]),
        ("0.05 s", &preset("smc1"), &[]),
        ("0.04 s", fast, &["(at most 0.0349 s)", "`step = 0.02 s`", "overlap by 0.10 m", "n = 3"]),
        ("0.025 s", fast, &[]),
        ("0.025 s", steep, &["(at most 0.0156 s)", "`step = 0.0125 s`"]),
        ("0.05 s", heavy, &["(at most 0.0258 s)", "`step = 0.025 s`"]),
        ("0.025 s", heavy, &[]),
        ("0.04 s", &helbing, &[]),
    ];
    for (step, kinds, wanted) in cases {
        let text = model(step, kinds);
        let place =
            Place::new(&[("a.scn", &text), ("a.bltl", "estimate P(F<=0 s contact(me)) within 0.3\n")]);
        for words in [&["check", "a.scn", "a.bltl", "-q"][..], &["simulate", "a.scn"]] {
            let said = place.call(words);
            assert_eq!(said.code, Some(0), "{}", said.err);
            assert_eq!(
                said.err.matches("W0801").count(),
                usize::from(!wanted.is_empty()),
                "{step}: {}",
                said.err
            );
            for part in wanted {
                assert!(said.err.contains(part), "{part}: {}", said.err);
            }
        }
    }
    // Two bodies that meet nothing else.
    let text = model("0.05 s", &helbing).replace("n = 7", "n = 1");
    let place = Place::new(&[("a.scn", &text), ("a.bltl", "estimate P(F<=0 s contact(me)) within 0.3\n")]);
    assert!(!place.call(&["check", "a.scn", "a.bltl", "-q"]).err.contains("W0801"));
}

#[test]
fn levels_are_never_rounded_up() {
    let mut properties = "family confidence 95 %\n".to_owned();
    for _ in 0..3 {
        properties += "estimate P(F<=1 s contact(user)) within 0.3\n";
    }
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", &properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
    assert!(said.out.contains("98.33 %") && said.out.contains("error at most 0.0167\n"), "{}", said.out);
    assert!(!said.out.contains("333"), "{}", said.out);
}

#[test]
fn a_stream_of_outcomes_that_is_none_is_an_object_too() {
    let place = Place::new(&[("a.csv", "maybe\n")]);
    let words = ["drift", "a.csv", "--before", "0.9", "--after", "0.8", "--format", "json"];
    let said = place.call(&words);
    assert_eq!(said.code, Some(2));
    assert!(said.json()["error"]["message"].as_str().unwrap().contains("a.csv"), "{}", said.out);
}

#[test]
fn a_formula_without_a_temporal_operator_is_read_in_the_first_state() {
    let scenario = "horizon = 9 steps\nparam mode = 1 in 0 .. 5\nprocess w { var x: 0 .. 9 = 0; when x < 9 -> x = x + 1 }\n";
    let warned = |property: &str| {
        let place = Place::new(&[("a.scn", scenario), ("a.bltl", property)]);
        let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--max-trials", "4"]);
        let warnings = said.err.matches("warning[").count();
        assert_eq!(
            said.err.matches("warning[W0502]: the value of the first state is used").count(),
            warnings,
            "{}",
            said.err
        );
        (warnings, said.err)
    };
    let (count, text) = warned("property low = w.x < 3\ncheck P(low) >= 0.5\ncheck P(G<=9 low) >= 0.5\n");
    assert_eq!(count, 1, "{text}");
    assert!(text.contains("a.bltl:2:9") && text.contains("write `G<=9 steps low` for all states"), "{text}");
    for formula in ["w.x < 3 & w.x >= mode", "robustness(w.x < 3) > 0"] {
        assert_eq!(warned(&format!("estimate P({formula})\n")).0, 1, "{formula}");
    }
    for formula in [
        "F<=0 (w.x < 3)",
        "time_until(w.x == 3) <= 4 steps",
        "max<=3 (w.x) > 2",
        "X (w.x == 1)",
        "w.x == 0 => F (w.x == 3)",
        "robustness(G<=3 (w.x < 3.5)) > 0",
    ] {
        assert_eq!(warned(&format!("estimate P({formula})\n")).0, 0, "{formula}");
    }
}

#[test]
fn real_variables_are_not_to_be_compared_for_equality_and_ranges_have_a_limit() {
    let place = |model: &str, property: &str| {
        let place = Place::new(&[("a.scn", model), ("a.bltl", property)]);
        place.call(&["check", "a.scn", "a.bltl", "-q", "--max-trials", "4"]).err
    };
    let model = "horizon = 9 steps\nprocess tank { var level = 0; var n: 0 .. 9 = 0\n  when level != 1 & n < 9 -> { level = level + 0.1; n = n + 1 } }\n";
    let said = place(
        model,
        "check P(F (2 * tank.level == 0.6)) >= 0.5\ncheck P(F (tank.n == 3 & tank.level > 0.5 & round(tank.level) == 1)) >= 0.5\n",
    );
    assert_eq!(said.matches("warning[W0503]: `level` is a rounded real number").count(), 2, "{said}");
    assert!(said.contains("a.scn:3:8") && said.contains("a.bltl:1:12"), "{said}");
    let said = place(&model.replace("0 .. 9", "0 .. 1e18"), "check P(F (tank.n == 3)) >= 0.5\n");
    assert!(said.contains("error[E0405]: `1e18` is too large for an end of a range"), "{said}");
    assert!(said.contains("the limit is ±4503599627370495"), "{said}");
    let said = place(&model.replace("0 .. 9", "0 .. 9.5"), "check P(F (tank.n == 3)) >= 0.5\n");
    assert!(said.contains("the ends of a range must be whole numbers"), "{said}");
}
