//! Text that controls a terminal or hides is shown as escapes, whatever it stands in. Errors of the command line come in
//! the format that it asks for.

use super::formats::validated;
use crate::program::{Place, SMALL, Said};

/// A title and the like: a colour, the title of a window, marks of direction, characters without width.
const ODD: &str = "\u{1b}[31mred\u{1b}]0;x\u{7}\u{202e}gnp\u{200b}\u{2066}y\u{9b}31m";

/// Nothing in what was said is obeyed by a terminal or hidden.
fn assert_plain(said: &Said, what: &str) {
    for (name, text) in [("out", &said.out), ("err", &said.err)] {
        let odd = text.chars().find(|c| {
            c.is_control() && !"\n\t".contains(*c)
                || matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
        });
        assert_eq!(odd, None, "{what}, {name}: {text:?}");
    }
}

#[test]
fn nothing_that_is_quoted_reaches_the_terminal() {
    let titled = format!("scenario \"{ODD}\"\n{}", SMALL.replace("scenario \"Small\"", ""));
    let geometry = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon\u001b[31mRED","coordinates":[]}}]}"#;
    let importing = format!("scene {{ import \"g.geojson\" }}\n{SMALL}");
    let query = "check P(F<=1 s contact(user)) >= 0.5\n";
    let file = format!("{ODD}.bltl").replace('/', "");
    let place = Place::new(&[
        ("g.geojson", geometry),
        ("i.scn", &importing),
        ("t.scn", &titled),
        ("a.bltl", query),
        (&file, query),
    ]);
    for format in ["text", "junit", "github"] {
        let call = |scenario: &str, properties: &str, more: &[&str]| {
            place.call(
                &[&["check", scenario, properties, "-q", "--max-trials", "5", "--format", format], more]
                    .concat(),
            )
        };
        for said in [call("t.scn", "a.bltl", &[]), call("t.scn", &file, &[])] {
            assert_eq!(said.code, Some(3), "{}", said.err);
            assert_plain(&said, format);
        }
        for (scenario, properties, more) in [
            ("i.scn", "a.bltl", &[][..]),
            ("t.scn", "a.bltl", &["--set", &format!("density={ODD}")]),
            ("t.scn", "a.bltl", &["--set", &format!("{ODD}=1")]),
            ("t.scn", "a.bltl", &["--only", ODD]),
            ("t.scn", "a.bltl", &[&format!("--{ODD}")]),
            (&format!("{ODD}.scn"), "a.bltl", &[]),
        ] {
            let said = call(scenario, properties, more);
            assert_eq!(said.code, Some(2), "{scenario} {more:?}: {}", said.err);
            assert_plain(&said, format);
        }
    }
    let shown = place.call(&["show", "t.scn", &file]);
    assert_eq!(shown.code, Some(0), "{}", shown.err);
    assert_plain(&shown, "show");
    assert!(shown.out.contains("\\u{1b}[31mred"), "{}", shown.out);
    let said = place.call(&["fmt", "--check", &file]);
    assert_plain(&said, "fmt");
    // JSON keeps what was written.
    let said = place.call(&["check", "t.scn", "a.bltl", "-q", "--max-trials", "5", "--format", "json"]);
    assert_eq!(said.json()["scenario"], ODD);
    assert!(!said.out.contains('\u{1b}'));
}

#[test]
fn errors_of_the_command_line_come_in_the_chosen_format() {
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", "check P(F<=1 s contact(user)) >= 0.5\n")]);
    let call = |words: &[&str]| place.call(&[&["check", "a.scn", "a.bltl"], words].concat());
    for format in [&["--format", "json"][..], &["--format=json"]] {
        let said = call(&[format, &["--max-trials", "many"]].concat());
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(said.err.contains("many"), "people read it all the same: {}", said.err);
        let json = said.json();
        validated(&json);
        assert!(
            json["error"]["message"].as_str().unwrap().contains("`--max-trials <N>` cannot be `many`"),
            "{json}"
        );
        assert_eq!(json["diagnostics"][0]["code"], "E0705");
    }
    let said = call(&["--nonsense", "--format", "github"]);
    assert!(said.out.contains("::error title=E0705::unexpected argument '--nonsense' found"), "{}", said.out);
    let said = call(&["--nonsense", "--format", "junit"]);
    assert!(said.out.starts_with("<?xml") && said.out.contains("E0705"), "{}", said.out);
    assert_eq!(call(&["--nonsense"]).out, "");
    let said = place.call(&["drift", "-", "--before", "2", "--after", "0.8", "--format", "json"]);
    assert_eq!(said.code, Some(2));
    assert!(
        said.json()["error"]["message"].as_str().unwrap().contains("a probability must be between 0 and 1")
    );
}

#[test]
fn imports_and_tracks_may_begin_with_the_mark_of_utf_8() {
    let tracks = "\u{feff}0 1 1.0 0 1.0 1.0 0 0\n10 1 1.4 0 1.0 1.0 0 0\n";
    let place = Place::new(&[
        ("w.wkt", "\u{feff}LINESTRING (-1 2, 6 2)\n"),
        ("g.geojson", "\u{feff}{\"type\":\"LineString\",\"coordinates\":[[-1,3],[6,3]]}"),
        ("t.txt", tracks),
    ]);
    let text = format!(
        "scene {{ import \"w.wkt\"; import \"g.geojson\" }}\ntracks t = eth_biwi \"t.txt\"\n{SMALL}agent seen: adult from t at 0 s id 1\n"
    );
    place.write("a.scn", text.as_bytes());
    let said = place.call(&["show", "a.scn"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
}
