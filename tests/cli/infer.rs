//! `smc infer` from the outside: formats, ids that are withheld, and tables that are wrong.

use crate::program::{Place, at_root, recordings};
use serde_json::Value;

/// A scene with a wall, a kind that forces move, one that lacks parameters, and one that steps.
const SCENE: &str = "horizon = 1 s\nstep = 0.02 s\nscene { wall (1.2, -5) -- (1.2, 5) }\n\
                     kind slim: sfm preset helbing2000 { radius = 0.2 m }\nkind bare: sfm { radius = 0.2 m }\n\
                     kind stepper: stepped { radius = 0.25 m }\n";
const SQUARE: &str = include_str!("../../models/square.csv");

#[test]
fn the_square_has_the_groups_of_figure_2() {
    let said = at_root(&["infer", "models/square.csv", "--anonymous", "--format", "json"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let json = said.json();
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/infer.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&json), "{json:#}");
    let tracks = &json["score"]["tracks"];
    assert_eq!((&tracks["unsplit"], &tracks["switches"]), (&7.into(), &0.into()), "also over the gap");
    let lives = |key: &str, word: &str| {
        json["groups"].as_array().unwrap().iter().filter(|group| group[key] == word).count()
    };
    assert_eq!((lives("born", "appear"), lives("born", "split"), lives("ended", "merge")), (5, 1, 2));
    insta::assert_snapshot!("infer_square", said.out);
}

#[test]
fn two_sensors_see_the_same_people() {
    let json = at_root(&["infer", "models/square.jsonl", "--format", "json"]).json();
    assert_eq!(json["traces"].as_array().unwrap().len(), 7);
    assert_eq!(json["groups"].as_array().unwrap().len(), 6);
}

#[test]
fn all_formats_and_standard_input() {
    let place = Place::new(&[("a.csv", SQUARE)]);
    let csv = place.call(&["infer", "a.csv", "--format", "csv"]).out;
    assert!(csv.starts_with("time,trace,group,x,y,vx,vy,id\n"), "{}", &csv[..40]);
    assert_eq!(csv.lines().count(), SQUARE.lines().count());
    let fed = place.fed(&["infer", "-", "--format", "csv"], SQUARE);
    assert_eq!((fed.code, fed.out), (Some(0), csv));
    let text = place.call(&["infer", "a.csv"]).out;
    for part in ["Traces and groups\n", "  traces ", "  groups of several members ", "  IDF1 "] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let said = place.call(&["infer", "a.csv", "--format", "svg", "-o", "a.svg", "--width", "85mm"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""));
    let svg = std::fs::read_to_string(place.path("a.svg")).unwrap();
    assert!(svg.contains(" width=\"85mm\"") && svg.matches("<polyline").count() == 7);
    let part = place.call(&["infer", "a.csv", "--from", "4s", "--to", "8s", "--format", "json"]).json();
    assert_eq!(part["intervals"].as_array().unwrap().len(), 1);
    assert_eq!(part["traces"][0]["points"].as_array().unwrap().len(), 11);
}

#[test]
fn the_social_force_takes_a_kind_and_a_scene() {
    let schema: Value = serde_json::from_str(include_str!("../../docs/schema/infer.schema.json")).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let (square, force) = (["infer", "models/square.csv", "--format", "json"], ["--motion", "social-force"]);
    for (words, kind, scene) in [
        (&[] as &[&str], "smc1", Value::Null),
        (&["--kind", "helbing2000"], "helbing2000", Value::Null),
        (&["--scene", "models/square.scn"], "smc1", "models/square.scn".into()),
        (&["--scene", "models/square.scn", "--kind", "adult"], "adult", "models/square.scn".into()),
        (&["--scene", "models/square.scn", "--data", "models"], "smc1", "models/square.scn".into()),
    ] {
        let said = at_root(&[&square[..], &force, words].concat());
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{words:?}");
        let json = said.json();
        assert!(schema.is_valid(&json), "{json:#}");
        let parameters = &json["parameters"];
        assert_eq!(parameters["motion"], "social-force");
        assert_eq!((&parameters["kind"], &parameters["scene"]), (&kind.into(), &scene), "{words:?}");
    }
    for motion in ["constant", "standing"] {
        let parameters = at_root(&[&square[..], &["--motion", motion]].concat()).json()["parameters"].clone();
        assert_eq!((&parameters["motion"], &parameters["kind"]), (&motion.into(), &Value::Null));
    }
}

#[test]
fn a_wall_keeps_people_on_their_side() {
    // One walks towards the wall and is hidden; another is seen behind it, where the first would be without the wall.
    let table = "time,id,x,y\n0,1,0,0\n0.4,1,0.5,0\n1.6,2,2,0\n";
    let place = Place::new(&[("a.csv", table), ("scene.scn", SCENE)]);
    let traces = |words: &[&str]| {
        let said = place.call(&[&["infer", "a.csv", "--anonymous", "--format", "json"], words].concat());
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{words:?}");
        said.json()["traces"].as_array().unwrap().len()
    };
    assert_eq!(traces(&[]), 1);
    assert_eq!(traces(&["--motion", "social-force"]), 1);
    assert_eq!(traces(&["--motion", "social-force", "--scene", "scene.scn"]), 2);
    assert_eq!(traces(&["--motion", "social-force", "--scene", "scene.scn", "--kind", "slim"]), 2);
    let fed =
        place.fed(&["infer", "a.csv", "--motion", "social-force", "--scene", "-", "--format", "json"], SCENE);
    assert_eq!((fed.code, fed.json()["parameters"]["scene"].as_str()), (Some(0), Some("<stdin>")));
}

#[test]
fn numbers_have_three_decimals() {
    let is_short = |text: &str| text.split_once('.').is_none_or(|(_, decimals)| decimals.len() <= 3);
    let csv = at_root(&["infer", "models/square.csv", "--format", "csv"]).out;
    assert!(csv.lines().skip(1).flat_map(|line| line.split(',')).all(is_short), "{csv}");
    let json = at_root(&["infer", "models/square.csv", "--format", "json"]).json();
    let mut all = vec![&json["intervals"], &json["traces"], &json["groups"]];
    let mut count = 0;
    while let Some(value) = all.pop() {
        match value {
            Value::Array(values) => all.extend(values),
            Value::Object(fields) => all.extend(fields.values()),
            Value::Number(number) => {
                count += 1;
                assert!(is_short(&number.to_string()), "{number}");
            }
            _ => {}
        }
    }
    assert!(count > 1000, "{count}");
}

#[test]
fn bad_options_of_motion_are_refused() {
    let place = Place::new(&[
        ("a.csv", SQUARE),
        ("scene.scn", SCENE),
        ("broken.scn", "horizon = 1 s\nstep = 0.02 s\nscene { wall (1.2 s, -5) -- (1.2, 5) }\n"),
    ]);
    let force = ["--motion", "social-force"];
    for (words, parts) in [
        (&["--kind", "slim"][..], &["error[E0705]", "`--kind` needs", "--motion social-force"][..]),
        (&["--motion", "standing", "--scene", "scene.scn"], &["error[E0705]", "`--scene` needs"]),
        (&["--data", "."], &["--scene <MODEL>"]),
    ] {
        refused(&place, &[&["a.csv"], words].concat(), parts);
    }
    for (words, parts) in [
        (
            &["--kind", "helbing2001"][..],
            &["error[E0705]", "unknown preset `helbing2001`", "did you mean `helbing2000`?"][..],
        ),
        (&["--scene", "scene.scn", "--kind", "slin"], &["error[E0705]", "`slin`", "did you mean `slim`?"]),
        (
            &["--scene", "scene.scn", "--kind", "bare"],
            &["neither a preset nor a kind of the scene with all parameters", "slim"],
        ),
        (
            &["--scene", "scene.scn", "--kind", "stepper"],
            &["no force moves agents of the kind `stepper`", "slim, helbing2000, smc1"],
        ),
        (&["--scene", "broken.scn"], &["error[E0303]", "broken.scn:3:15"]),
        (&["--scene", "missing.scn"], &["error[E0701]", "does not exist"]),
        (
            &["--scene", "scene.scn", "--data", "missing"],
            &["error[E0701]", "`--data missing` does not exist"],
        ),
        (&["--scene", "scene.scn", "-o", "scene.scn"], &["error[E0920]", "overwrite"]),
    ] {
        refused(&place, &[&["a.csv"], &force[..], words].concat(), parts);
    }
    let twice = place.fed(&["infer", "-", "--motion", "social-force", "--scene", "-"], SQUARE);
    assert_eq!((twice.code, twice.out.as_str()), (Some(2), ""));
    assert!(twice.err.contains("standard input can be read only once"), "{}", twice.err);
}

/// A call that ends with 2, says nothing on standard output and all the parts on standard error.
fn refused(place: &Place, words: &[&str], parts: &[&str]) {
    let said = place.call(&[&["infer"], words].concat());
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}\n{}", said.err);
    for part in parts {
        assert!(said.err.contains(part), "{part} of {words:?}\n{}", said.err);
    }
}

#[test]
fn bad_input_is_refused() {
    let place = Place::new(&[
        ("a.csv", SQUARE),
        ("bad.csv", "time,id,x,y\n0,1,0,0\n0.4,1,z,0\n0.4,2,0\n"),
        ("twice.csv", "time,id,x,y\n0,1,0,0\n0,1,1,0\n"),
        ("back.jsonl", "{\"t\":1,\"seen\":[{\"x\":0,\"y\":0}]}\n{\"t\":0,\"seen\":[]}\n"),
        ("none.csv", "time,id,x,y\n"),
        ("text.txt", "hello\n"),
        ("groups.txt", "77 78\n"),
    ]);
    for (words, parts) in [
        (&["bad.csv"][..], &["line 3, column 7: x `z` is not a number", "line 4: column `y` is missing"][..]),
        (&["twice.csv"], &["line 3: person 1 is at time 0 twice"]),
        (&["back.jsonl"], &["line 2: time runs backwards"]),
        (&["none.csv"], &["no observation"]),
        (&["text.txt"], &["in no known format", "--input"]),
        (&["missing.csv"], &["error[E0701]", "does not exist"]),
        (&["a.csv", "--from", "30s"], &["between `--from` and `--to`", "from 0 s to 20 s"]),
        (&["a.csv", "--threshold", "0"], &["write a positive number"]),
        (
            &["a.csv", "--fps", "0"],
            &["error[E0705]", "`--fps <RATE>` cannot be `0`", "above 0 and at most 1e6"],
        ),
        (&["a.csv", "--annotated", "groups.txt"], &["names nobody who is in the recording"]),
        (&["a.csv", "-o", "a.csv"], &["error[E0920]", "overwrite"]),
    ] {
        refused(&place, words, parts);
    }
}

#[test]
fn every_track_of_the_hotel_is_one_trace() {
    let Some(data) = recordings() else { return };
    let file = data.join("seq_hotel/obsmat.txt");
    let said = at_root(&["infer", file.to_str().unwrap(), "--anonymous", "--format", "json"]);
    let tracks = &said.json()["score"]["tracks"];
    assert_eq!((&tracks["unsplit"], &tracks["switches"]), (&390.into(), &0.into()));
}

#[test]
fn a_recording_that_is_not_of_people_is_doubted_once() {
    let table = |unit: f64, velocity: &str| {
        (0..20).fold(
            format!("time,id,x,y{}\n", if velocity.is_empty() { "" } else { ",vx,vy" }),
            |text, k| {
                let x = 0.48 * f64::from(k) * unit;
                text + &format!(
                    "{},1,{x},0{velocity}\n{},2,{},{}{velocity}\n",
                    0.4 * f64::from(k),
                    0.4 * f64::from(k),
                    2.0 * unit - x,
                    unit
                )
            },
        )
    };
    let place = Place::new(&[
        ("m.csv", &table(1.0, "")),
        ("cm.csv", &table(100.0, "")),
        ("blank.csv", &table(1.0, ",0,0")),
        ("frames.csv", "frame,id,x,y\n0,1,0,0\n1,1,1,0\n"),
        (
            "m.scn",
            "scenario \"m\"\nhorizon = 1 s\nstep = 0.1 s\ntracks a = csv \"cm.csv\"\ntracks b = csv \"frames.csv\" { fps = 2 }\n",
        ),
        (
            "bad.scn",
            "scenario \"m\"\nhorizon = 1 s\nstep = 0.1 s\ntracks b = csv \"frames.csv\" { fps = 0 }\n",
        ),
    ]);
    assert_eq!(place.call(&["infer", "m.csv"]).err, "");
    let said = place.call(&["infer", "cm.csv"]);
    assert_eq!((said.code, said.err.matches("W0705").count()), (Some(0), 1), "{}", said.err);
    assert!(said.err.contains("120.00 m/s") && said.err.contains("look like centimetres"), "{}", said.err);
    let said = place.call(&["infer", "blank.csv"]);
    assert!(said.err.contains("warning[W0705]") && said.err.contains("all velocities"), "{}", said.err);
    assert_eq!(place.call(&["infer", "blank.csv", "--velocity", "seen"]).err, "");
    let said = place.call(&["infer", "m.csv", "--fps", "2"]);
    assert!(said.code == Some(2) && said.err.contains("the table has times"), "{}", said.err);
    let said = place.call(&["show", "m.scn"]);
    assert_eq!((said.code, said.err.matches("W0705").count()), (Some(0), 1), "{}", said.err);
    assert!(said.err.contains("m.scn:4:"), "{}", said.err);
    let said = place.call(&["show", "bad.scn"]);
    assert!(said.code == Some(2) && said.err.contains("help: write `fps = 25`"), "{}", said.err);
}
