//! `smc monitor` and `smc evaluate` from the outside: formats, threads, and calls that do not fit the recording.

use crate::program::{Place, Said, at_root};
use serde_json::Value;

fn square(command: &str, words: &[&str]) -> Said {
    let call = [command, "models/square.scn", "properties/square.bltl", "--tracks", "here"];
    at_root(&[&call[..], words].concat())
}

fn is_valid(json: &Value, schema: &str) {
    let schema: Value = serde_json::from_str(schema).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    let found = jsonschema::validator_for(&schema).unwrap();
    assert!(found.is_valid(json), "{json:#}");
}

#[test]
fn a_monitor_has_the_same_bytes_with_any_number_of_threads() {
    let said = square("monitor", &["--user", "all", "-j", "1"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    for threads in ["2", "8"] {
        assert_eq!(square("monitor", &["--user", "all", "-j", threads]).out, said.out, "{threads} threads");
    }
    insta::assert_snapshot!("monitor_square", said.out);
    let json = square("monitor", &["--format", "json"]).json();
    is_valid(&json, include_str!("../../docs/schema/monitor.schema.json"));
    let table = square("monitor", &["--format", "csv", "--from", "3s", "--to", "4s"]).out;
    assert!(table.starts_with("time,person,"), "{table}");
    assert!(table.lines().skip(1).all(|row| row.split(',').nth(1) == Some("2")), "{table}");
}

#[test]
fn an_evaluation_has_the_same_bytes_with_any_number_of_threads() {
    let asked = ["--kinds", "adult,smc1,constant", "--trials", "10", "--speed", "0.2"];
    let said = square("evaluate", &[&asked[..], &["-j", "1"]].concat());
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    for threads in ["2", "8"] {
        assert_eq!(
            square("evaluate", &[&asked[..], &["-j", threads]].concat()).out,
            said.out,
            "{threads} threads"
        );
    }
    insta::assert_snapshot!("evaluate_square", said.out);
    let json = square("evaluate", &[&asked[..], &["--format", "json"]].concat()).json();
    is_valid(&json, include_str!("../../docs/schema/evaluate.schema.json"));
    assert!(square("evaluate", &[&asked[..], &["--format", "svg"]].concat()).out.starts_with("<svg"));
    let table = square("evaluate", &[&asked[..], &["--format", "csv"]].concat()).out;
    assert!(table.starts_with("kind,property,bin,"), "{table}");
}

/// What a call that is wrong says.
fn refused(scenario: &str, properties: &str, words: &[&str]) -> String {
    let tracks = "time,id,x,y\n0,1,0,0\n0,2,5,1\n1,1,1,0\n1,2,4,1\n2,1,2,0\n2,2,3,1\n";
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", properties), ("t.csv", tracks)]);
    let said = place.call(&[&["monitor", "a.scn", "a.bltl"], words].concat());
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{}", said.err);
    said.err
}

const PAIR: &str = "horizon = 2 s\nstep = 0.1 s\ntracks here = csv \"t.csv\"\nkind adult: sfm preset helbing2000 { }\n\
    agent user: adult from here at 0 s id 1\nagents others: adult from here at 0 s except 1\n";
const SAFE: &str = "property safe = G<=1 s (forall a in others: distance(user, a) > 0.5 m)\n";

#[test]
fn what_does_not_fit_is_refused() {
    let here = ["--tracks", "here"];
    let named =
        format!("{PAIR}agent friend: adult from here at 0 s id 2\n").replace("except 1", "except 1, 2");
    let robot = format!("{PAIR}agent robot: adult {{ at = (0, 9); route = (9, 9) }}\n");
    let nobody = PAIR
        .replace("agent user", "agents user")
        .replace(" id 1", " group of 1")
        .replace("user,", "user[1],");
    let all = [
        refused(PAIR, SAFE, &["--tracks", "there"]),
        refused(PAIR, SAFE, &[&here[..], &["--user", "9"]].concat()),
        refused(PAIR, SAFE, &[&here[..], &["--from", "7s"]].concat()),
        refused(PAIR, "estimate P(G<=1 s (x(user) > 0 m))\n", &here),
        refused(&named, SAFE, &[&here[..], &["--user", "all"]].concat()),
        refused(&robot, SAFE, &here),
        refused(&nobody, "property p = G<=1 s (exists a in user: x(a) > 0 m)\n", &here),
        refused(PAIR, "property p = G<=1 s (x(nobody) > 0 m)\n", &here),
        refused(PAIR, SAFE, &[&here[..], &["-o", "a.scn"]].concat()),
    ];
    insta::assert_snapshot!("replay_refused", all.join("\n"));
}

#[test]
fn unknown_kinds_are_refused() {
    let said = square("evaluate", &["--kinds", "adult,walker"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("there is no kind `walker`"), "{}", said.err);
    let still = square("evaluate", &["--speed", "30"]);
    assert_eq!(still.code, Some(2));
    assert!(still.err.contains("nobody moves"), "{}", still.err);
}
