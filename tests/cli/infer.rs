//! `smc infer` from the outside: formats, ids that are withheld, and tables that are wrong.

use crate::program::{Place, at_root, recordings};
use serde_json::Value;

const SQUARE: &str = include_str!("../../models/square.csv");

#[test]
fn the_square_has_the_groups_of_figure_2() {
    let said = at_root(&["infer", "models/square.csv", "--anonymous"]);
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
    let json = at_root(&["infer", "models/square.jsonl"]).json();
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
    let said = place.call(&["infer", "a.csv", "--format", "svg", "-o", "a.svg"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""));
    let svg = std::fs::read_to_string(place.path("a.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.matches("<polyline").count() == 7);
    let part = place.call(&["infer", "a.csv", "--from", "4s", "--to", "8s"]).json();
    assert_eq!(part["intervals"].as_array().unwrap().len(), 1);
    assert_eq!(part["traces"][0]["points"].as_array().unwrap().len(), 11);
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
        (&["a.csv", "--threshold", "0"], &["must be positive"]),
        (&["a.csv", "--annotated", "groups.txt"], &["names nobody who is in the recording"]),
        (&["a.csv", "-o", "a.csv"], &["error[E0920]", "overwrite"]),
    ] {
        let said = place.call(&[&["infer"], words].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}\n{}", said.err);
        for part in parts {
            assert!(said.err.contains(part), "{part} of {words:?}\n{}", said.err);
        }
    }
}

#[test]
fn every_track_of_the_hotel_is_one_trace() {
    let Some(data) = recordings() else { return };
    let file = data.join("seq_hotel/obsmat.txt");
    let said = at_root(&["infer", file.to_str().unwrap(), "--anonymous"]);
    let tracks = &said.json()["score"]["tracks"];
    assert_eq!((&tracks["unsplit"], &tracks["switches"]), (&390.into(), &0.into()));
}
