//! `smc calibrate` from the outside: a site whose people turn, its file beside verdicts, and calls that do not fit.

use crate::program::Place;
use serde_json::Value;

/// People far from each other, one every 3 s. Each walks east at 1 m/s, and after 1.6 s turns by an angle of its own, to either
/// side by up to 60 degrees.
fn street(count: u32) -> String {
    let mut rows = String::from("time,id,x,y\n");
    for id in 0..count {
        // The golden section spreads the turns evenly in whatever order.
        let turn = 120.0 * ((f64::from(id) * 0.618_033_988_75).fract() - 0.5);
        let (sin, cos) = turn.to_radians().sin_cos();
        for k in 0..=16 {
            let time = 0.4 * f64::from(k);
            let (ahead, after) = (time.min(1.6), (time - 1.6).max(0.0));
            let (x, y) = (50.0 * f64::from(id) + ahead + after * cos, after * sin);
            rows += &format!("{:.1},{},{x},{y}\n", 3.2 * f64::from(id) + time, id + 1);
        }
    }
    rows
}

const MODEL: &str = "horizon = 4.8 s\nstep = 0.1 s\ntracks here = csv \"t.csv\" { velocity = seen }\n\
    kind adult: sfm preset helbing2000 { A = 0 N; tau = 0.1 s; noise = 0.02 m/s }\n\
    agent user: adult from here at 6.8 s id 3 { heading = site; speed = site }\n\
    agents others: adult from here at 6.8 s except 3 { heading = site; speed = site }\n";
const ASKED: &str = "const far = 1 m\nproperty north = F<=4.8 s (y(user) > far)\nproperty onward = F<=4.8 s (travelled(user) > 3 m)\n\
    check P(north) >= 0.9\nestimate P(onward) within 0.1\nestimate E(min<=4 s y(user)) in -5 m .. 5 m within 1 m\n";

fn place() -> Place {
    Place::new(&[("a.scn", MODEL), ("a.bltl", ASKED), ("t.csv", &street(45))])
}

const CALL: [&str; 8] = ["calibrate", "a.scn", "a.bltl", "--tracks", "here", "-o", "a.calibration", "--date"];

#[test]
fn a_calibration_counts_what_was_true_with_the_same_bytes_at_any_number_of_threads() {
    let place = place();
    let call =
        |threads: &str| place.call(&[&CALL[..], &["2026-05-04", "--site", "street", "-j", threads]].concat());
    let said = call("1");
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{}", said.out);
    let file = std::fs::read_to_string(place.path("a.calibration")).unwrap();
    assert_eq!(call("2").out, said.out);
    assert_eq!(std::fs::read_to_string(place.path("a.calibration")).unwrap(), file);
    let found: Value = serde_json::from_str(&file).unwrap();
    let schema: Value =
        serde_json::from_str(include_str!("../../docs/schema/calibration.schema.json")).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let faults: Vec<String> = validator.iter_errors(&found).map(|error| error.to_string()).collect();
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!((found["persons"].as_u64(), found["later"].as_u64()), (Some(30), Some(15)));
    // A third of them turns to the left by enough to come 1 m north, whatever instant was drawn.
    let bin = &found["properties"][0]["bins"][1];
    assert_eq!(bin["persons"], 30, "all have the laws of the site, so nearly the same probability: {bin}");
    let share = bin["held"].as_f64().unwrap() / 30.0;
    assert!((share - bin["mean"].as_f64().unwrap()).abs() < 0.12 && (0.2..0.45).contains(&share), "{bin}");
    let turns: Vec<f64> =
        found["turns"].as_array().unwrap().iter().map(|turn| turn.as_f64().unwrap()).collect();
    assert!(turns[0] < -0.5 && turns[29] > 0.5 && turns.iter().all(|turn| turn.abs() < 1.05), "{turns:?}");
    for region in found["regions"].as_array().unwrap() {
        assert!(region["after"].as_f64().unwrap() > 0.7, "{region}");
    }
    assert!(said.out.contains("30 persons calibrate, 15 later ones test"), "{}", said.out);
    let page = place.call(&[&CALL[..], &["2026-05-04", "--report", "a.html"]].concat());
    let html = std::fs::read_to_string(place.path("a.html")).unwrap();
    assert!(html.contains("90 % regions") && html.contains("factor of the radius"), "{}", page.err);
    let plot = place.call(&["plot", "a.calibration", "--figure", "calibration", "--only", "north"]);
    assert!(plot.code == Some(0) && plot.out.contains("later persons"), "{}", plot.err);
}

#[test]
fn a_verdict_says_how_often_such_verdicts_were_true() {
    let place = place();
    assert_eq!(place.call(&[&CALL[..], &["2026-05-04"]].concat()).code, Some(0));
    let check = ["check", "a.scn", "a.bltl", "-q", "--calibration", "a.calibration"];
    let text = place.call(&check);
    let lines: Vec<&str> = text.out.lines().filter(|line| line.contains("model: ")).collect();
    assert_eq!(lines.len(), 2, "not of a mean: {}", text.out);
    assert!(
        lines[0]
            .contains("of 30 persons recorded at here on 2026-05-04 30 had P in 0.1 .. 0.5; it was true of")
    );
    assert!(
        lines[1].contains(" had P >= 0.9; it was true of ") && lines[1].contains("so of at least "),
        "{}",
        lines[1]
    );
    let json = place.call(&[&check[..], &["--format", "json"]].concat()).json();
    let of = |k: usize, key: &str| json["results"][k]["model"][key].clone();
    assert_eq!((of(0, "site"), of(0, "asked"), of(0, "from")), ("here".into(), 30.into(), 0.1.into()));
    assert!(json["results"][2].get("model").is_none());
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/verdict.schema.json")).unwrap();
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&json), "{json:#}");
    let brief = place.call(&[&check[..], &["--brief"]].concat());
    assert!(brief.out.contains("recorded at here"), "{}", brief.out);
    let report = place.call(&[&check[..], &["--report", "a.html"]].concat());
    let page = std::fs::read_to_string(place.path("a.html")).unwrap();
    assert!(page.contains("Model: of 30 persons"), "{}", report.err);
}

#[test]
fn what_does_not_fit_is_refused() {
    let place = place();
    assert_eq!(place.call(&[&CALL[..], &["2026-05-04"]].concat()).code, Some(0));
    let refused = |words: &[&str], code: &str, part: &str| {
        let said = place.call(words);
        let all = format!("{}{}", said.out, said.err);
        assert!(said.code == Some(2) && all.contains(code) && all.contains(part), "{words:?}: {all}");
    };
    let check = |scenario: &str, properties: &str, code: &str, part: &str| {
        place.write("b.scn", scenario.as_bytes());
        place.write("b.bltl", properties.as_bytes());
        refused(&["check", "b.scn", "b.bltl", "-q", "--calibration", "a.calibration"], code, part);
    };
    check(&MODEL.replace("step = 0.1", "step = 0.2"), ASKED, "E0727", "steps of 0.1 s");
    check(&MODEL.replace("noise = 0.02", "noise = 0.03"), ASKED, "E0727", "another kind");
    check(MODEL, &ASKED.replace("> 3 m", "> 4 m"), "E0727", "another formula `onward`");
    check(MODEL, &ASKED.replace("far = 1 m", "far = 2 m"), "E0727", "another formula `north`");
    check(
        MODEL,
        "property south = F<=4.8 s (y(user) < -1 m)\nestimate P(south) within 0.2\n",
        "E0727",
        "none of these",
    );
    // A formula without a bound is another one with another horizon; one with a bound is not.
    place.write("c.bltl", b"property ever = F (y(user) > 1 m)\nestimate P(ever) within 0.2\n");
    let ever = ["calibrate", "a.scn", "c.bltl", "--tracks", "here", "-o", "c.calibration"];
    assert_eq!(place.call(&ever).code, Some(0));
    place.write("c.scn", MODEL.replace("horizon = 4.8", "horizon = 6").as_bytes());
    refused(
        &["check", "c.scn", "c.bltl", "-q", "--calibration", "c.calibration"],
        "E0727",
        "horizon of 4.8 s",
    );
    let same = place.call(&["check", "c.scn", "a.bltl", "-q", "--calibration", "a.calibration"]);
    assert!(same.out.contains("model: "), "{}", same.err);
    let cut = MODEL.replace("speed = site", "speed = site in 0 m/s .. 2 m/s");
    check(&cut, ASKED, "E0305", "recorded");
    refused(&["calibrate", "a.scn", "a.bltl", "--tracks", "here", "--trials", "0"], "E0705", "trials");
    refused(&["check", "a.scn", "a.bltl", "-q"], "E0728", "--calibration");
    refused(&["check", "a.scn", "a.bltl", "-q", "--calibration", "a.scn"], "E0726", "no calibration");
    let one = place.call(&["check", "a.scn", "a.bltl", "-q", "--calibration", "a.scn"]);
    assert!(!one.err.contains("E0728"), "one fault, one error: {}", one.err);
    refused(&["check", "a.scn", "a.bltl", "-q", "--calibration", "none"], "E0701", "does not exist");
    let onto = place.call(&["calibrate", "a.scn", "a.bltl", "--tracks", "here", "-o", "a.bltl"]);
    assert!(onto.code == Some(2) && onto.err.contains("a.bltl"), "{}", onto.err);
    assert_eq!(
        std::fs::read_to_string(place.path("a.bltl")).unwrap(),
        ASKED,
        "an input is never overwritten"
    );
    let few = Place::new(&[("a.scn", MODEL), ("a.bltl", ASKED), ("t.csv", &street(24))]);
    let said = few.call(&[&CALL[..], &["2026-05-04"]].concat());
    assert!(said.code == Some(2) && said.err.contains("24 persons"), "{}", said.err);
    let said = place.call(&[&CALL[..], &["2026-05-04", "--persons", "12"]].concat());
    assert!(said.code == Some(2) && said.err.contains("E0705"), "{}", said.err);
    assert!(!place.path("b.calibration").exists());
}
