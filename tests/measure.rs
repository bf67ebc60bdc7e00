//! `smc measure`: numbers of recordings against closed forms, against positions counted by hand, and against `PedPy`.

use crate::measures::python_with_pedpy;
use crate::program::Place;
use serde_json::Value;
use std::fmt::Write as _;
use std::process::Command;

/// Two walk towards each other along y = 0 at 1 m/s, 10 frames a second; a third one stands.
fn three() -> String {
    let mut rows = "time,id,x,y\n".to_owned();
    for k in 0..=80 {
        let t = 0.1 * f64::from(k);
        let _ = write!(rows, "{t:.1},1,{t:.1},0\n{t:.1},2,{:.1},0.6\n{t:.1},3,4,3\n", 8.0 - t);
    }
    rows
}

const HALL: &str = "param width = 4 m in 1 m .. 9 m\nscene { region hall: rect (2, -1) .. (2 m + width, 4 m)\n\
    region attic: rect (50, 50) .. (60, 60)\n line gate: (3, -1) -- (3, 1) }\n";

/// The columns of a table by their names.
fn columns(text: &str) -> Vec<(String, Vec<f64>)> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let mut all: Vec<(String, Vec<f64>)> = names.into_iter().map(|name| (name, Vec::new())).collect();
    for row in reader.records() {
        for (cell, (_, values)) in row.unwrap().iter().zip(&mut all) {
            values.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    all
}

fn column<'c>(all: &'c [(String, Vec<f64>)], name: &str) -> &'c [f64] {
    &all.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("no column {name}")).1
}

#[test]
fn numbers_of_three_people_have_closed_forms() {
    let place = Place::new(&[("a.csv", &three()), ("hall.scn", HALL)]);
    let said = place.call(&["measure", "a.csv", "hall.scn", "--format", "csv", "--window", "2s"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let all = columns(&said.out);
    let of = |name: &str| column(&all, name);
    assert!(of("people").iter().all(|n| *n == 3.0));
    for (k, time) in of("time").iter().enumerate() {
        assert!((time - 0.1 * k as f64).abs() < 1e-9);
        let inside = |x: f64| u32::from((2.0 - 1e-9..=6.0 + 1e-9).contains(&x));
        let count = f64::from(inside(*time) + inside(8.0 - time) + 1);
        assert!((of("density(hall)")[k] - count / 20.0).abs() < 1e-9, "{time}");
        // Both cross the gate at 3 m, after 3 s and after 5 s.
        let crossed = f64::from(u8::from(*time > 3.05)) + f64::from(u8::from(*time > 5.05));
        assert_eq!(of("crossings(gate)")[k], crossed, "{time}");
    }
    let flow = of("flow(gate, 2 s)");
    assert!(flow[0].is_nan() && flow[45] == 0.5 && flow[80] == 0.0, "{flow:?}");
    // They pass each other 0.6 m apart: nearest at 4 s, and bodies of 0.2 m never touch.
    let nearest = of("nearest").iter().copied().fold(f64::INFINITY, f64::min);
    assert!((nearest - 0.6).abs() < 1e-9);
    assert!(of("time_to_collision").iter().all(|x| x.is_nan()));
    // With 0.4 m they would: at 2 s they are 4 m apart along their way, and 0.8 m is the reach.
    let wide = place.call(&["measure", "a.csv", "--radius", "0.4", "--format", "csv"]);
    let ttc = column(&columns(&wide.out), "time_to_collision")[20];
    assert!((ttc - (4.0 - (0.64_f64 - 0.36).sqrt()) / 2.0).abs() < 1e-9, "{ttc}");
    assert!(place.call(&["measure", "a.csv", "hall.scn"]).out.contains("nobody was ever in `attic`"));
}

fn follows_the_schema(json: &Value) {
    let schema: Value = serde_json::from_str(include_str!("../docs/schema/measure.schema.json")).unwrap();
    let wrong: Vec<String> = jsonschema::validator_for(&schema)
        .unwrap()
        .iter_errors(json)
        .map(|error| error.to_string())
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn any_number_of_a_state_can_be_measured_and_parameters_are_set() {
    let place = Place::new(&[("a.csv", &three()), ("hall.scn", HALL)]);
    let number = "count(a in everyone: speed(a) > 0.5 m/s)";
    let call =
        ["measure", "a.csv", "hall.scn", "--set", "width=6", "--number", number, "--number", "area(hall)"];
    let said = place.call(&[&call[..], &["--format", "json", "--from", "1s", "--to", "2s"]].concat());
    let json: Value = said.json();
    assert_eq!((json["frames"].as_u64(), json["persons"].as_u64()), (Some(11), Some(3)));
    follows_the_schema(&json);
    let of = |name: &str| {
        let all = json["numbers"].as_array().unwrap();
        all.iter().find(|one| one["name"] == name).unwrap()["mean"].as_f64().unwrap()
    };
    assert_eq!((of(number), of("area(hall)")), (2.0, 30.0));
}

#[test]
fn a_page_and_a_table_in_columns_are_written() {
    let place = Place::new(&[("a.csv", &three()), ("hall.scn", HALL)]);
    let said = place.call(&["measure", "a.csv", "hall.scn", "--report", "a.html"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let page = std::fs::read_to_string(place.path("a.html")).unwrap();
    assert!(page.contains("N(t)") && page.contains("Post-encroachment times") && page.contains("attic"));
    let lines = place.call(&["measure", "a.csv", "--format", "jsonl", "-o", "a.jsonl"]);
    assert_eq!(lines.code, Some(0), "{}", lines.err);
    assert_eq!(std::fs::read_to_string(place.path("a.jsonl")).unwrap().lines().count(), 81);
}

#[test]
fn what_cannot_be_measured_is_refused_with_a_hint() {
    let place = Place::new(&[("a.csv", &three()), ("hall.scn", HALL), ("empty.csv", "time,id,x,y\n")]);
    let wrong = |words: &[&str], said: &str| {
        let found = place.call(&[&["measure"], words].concat());
        assert_eq!(found.code, Some(2), "{words:?}");
        assert!(found.err.contains(said) && found.err.contains("help:"), "{words:?}: {}", found.err);
    };
    wrong(&["a.csv", "--from", "90s"], "no frame between these times");
    wrong(&["a.csv", "hall.scn", "--number", "densty(hall)"], "did you mean `density`?");
    wrong(&["a.csv", "hall.scn", "--number", "max<=9 s (density(hall))"], "not a number of one state");
    wrong(&["a.csv", "--format", "parquet"], "needs a file");
    wrong(&["a.csv", "--input", "nothing"], "the formats are");
    let empty = place.call(&["measure", "empty.csv"]);
    assert!(empty.code == Some(2) && empty.err.contains("E0702"), "{}", empty.err);
}

/// A trial of a room with a door is written for `PedPy`, measured, and measured by `PedPy`.
#[test]
fn recordings_are_measured_as_pedpy_does() {
    let Some(python) = python_with_pedpy() else {
        println!("skipped: PedPy is not installed; set SMC_PEDPY_PYTHON to a Python that has it");
        return;
    };
    let room = "horizon = 12 s\nstep = 0.05 s\nscene { wall (6, 0) -- (6, 2.5); wall (6, 6) -- (6, 3.5)\n\
        wall (0, 0) -- (12, 0) -- (12, 6) -- (0, 6) -- (0, 0)\n\
        line door: (6, 2.5) -- (6, 3.5); line far: (9, 0) -- (9, 6); region hall: rect (4, 1.5) .. (7, 4.5)\n\
        region goal: rect (10, 1) .. (11.5, 5) }\n\
        kind person: sfm preset helbing2000 { noise = 0.1 m/s; radius = 0.15 m }\n\
        agents crowd[40]: person { at = uniform in rect (1, 0.3) .. (5.6, 5.7); route = goal }\n";
    let place = Place::new(&[("room.scn", room)]);
    assert_eq!(place.call(&["simulate", "room.scn", "-o", "trial.txt"]).code, Some(0));
    let numbers = [
        "crossings(door)",
        "crossings(far)",
        "flow(door, 1 s)",
        "mean_speed(hall)",
        "level_of_service(hall)",
        "0",
        "voronoi_density(hall)",
        "density(hall)",
    ];
    let mut call = vec!["measure", "trial.txt", "room.scn", "--format", "csv"];
    for number in numbers {
        call.extend(["--number", number]);
    }
    let said = place.call(&call);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let all = columns(&said.out);
    let text = std::fs::read_to_string(place.path("trial.txt")).unwrap();
    let mut last: std::collections::BTreeMap<u32, (f64, f64)> = std::collections::BTreeMap::new();
    let mut table = String::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let cells: Vec<f64> = line.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
        let (id, frame, x, y) = (cells[0] as u32, cells[1] as usize, cells[2], cells[3]);
        let speed = last.insert(id, (x, y)).map_or(0.0, |(a, b)| ((x - a).hypot(y - b)) / 0.05);
        let values: Vec<String> =
            numbers.iter().map(|number| column(&all, number)[frame].to_string()).collect();
        let _ = writeln!(table, "{frame} {id} {x} {y} {speed} {}", values.join(" "));
    }
    place.write("table.txt", table.as_bytes());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/measures.py");
    let area = "0 0 6 0 6 2.5 6.00000000001 2.5 6.00000000001 0 12 0 12 6 6.00000000001 6 6.00000000001 3.5 6 3.5 6 6 0 6";
    let file = place.path("table.txt");
    let said = Command::new(&python).args([script, file.to_str().unwrap(), "room", area]).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&said.stdout), String::from_utf8_lossy(&said.stderr));
    assert!(said.status.success(), "{out}\n{err}");
    print!("measured: {out}");
}

/// The same rows without a header, in centimetres, with blanks or commas: named columns read them, in a scenario as well.
#[test]
fn a_table_without_a_header_is_read_by_its_columns() {
    let mut blanks = "# made by a tracker\n".to_owned();
    let mut commas = String::new();
    for k in 0..=80 {
        let x = 10.0 * f64::from(k);
        let _ = write!(blanks, "1 {k} {x} 0 170\n3 {k} 400 300 170\n");
        let _ = writeln!(commas, "1,{k},{},0", 0.01 * x);
    }
    let scenario = "horizon = 2 s\nstep = 0.02 s\ntracks t = csv \"a.txt\" { columns = \"id,frame,x/cm,y/cm,z\"; fps = 10 }\n\
        kind adult: preset smc2 { }\nagents all: adult from t at 1 s\n";
    let place = Place::new(&[("a.txt", &blanks), ("b.txt", &commas), ("a.scn", scenario)]);
    let rows = |file: &str, names: &str| {
        let call = ["measure", file, "--columns", names, "--fps", "10", "--format", "csv"];
        let said = place.call(&call);
        assert_eq!(said.code, Some(0), "{}", said.err);
        columns(&said.out)
    };
    let all = rows("a.txt", "id,frame,x/cm,y/cm,z");
    assert!(column(&all, "people").iter().all(|n| *n == 2.0));
    assert!((column(&all, "nearest")[40] - 3.0).abs() < 1e-9);
    assert!((column(&rows("b.txt", "id,frame,x,y"), "mean_speed")[9] - 1.0).abs() < 1e-9);
    assert!(place.call(&["show", "a.scn"]).out.contains("Agents: 2"));
    for (names, said) in [
        ("frame,x,y", "no column `id`"),
        ("id,frame,x/ft,y", "is not m, cm or mm"),
        ("id,frame,x/cm,y/mm", "must have one unit"),
    ] {
        let found = place.call(&["measure", "a.txt", "--columns", names, "--fps", "10"]);
        assert!(found.code == Some(2) && found.err.contains(said), "{names}: {}", found.err);
    }
    let other = place.call(&["measure", "a.txt", "--columns", "id,frame,x,y", "--input", "pedpy"]);
    assert!(other.code == Some(2) && other.err.contains("read it as `csv`"), "{}", other.err);
}

/// Several files are one recording: a minute apart, and ids go on.
#[test]
fn several_files_are_one_recording() {
    let scenario = "horizon = 2 s\nstep = 0.02 s\ntracks t = csv \"run-*.csv\"\nkind adult: preset smc2 { }\n\
        agents all: adult from t at 71 s\n";
    let place = Place::new(&[
        ("run-1.csv", &three()),
        ("run-2.csv", &three()),
        ("other.csv", "time,id,x,y\n0,1,0,0\n0.5,1,1,0\n"),
        ("a.scn", scenario),
    ]);
    let said = place.call(&["measure", "run-*.csv", "--format", "json"]);
    let json: Value = said.json();
    assert_eq!((json["persons"].as_u64(), json["frames"].as_u64()), (Some(6), Some(162)), "{}", said.err);
    follows_the_schema(&json);
    // The second begins at 68 s, and at 71 s all of its three persons are there.
    assert!(place.call(&["show", "a.scn"]).out.contains("Agents: 3"));
    let unquoted = place.call(&["measure", "run-1.csv", "run-2.csv"]);
    assert!(unquoted.code == Some(2) && unquoted.err.contains("one in quotes"), "{}", unquoted.err);
    let mixed = place.call(&["measure", "*.csv"]);
    assert!(mixed.code == Some(2) && mixed.err.contains("frames per second"), "{}", mixed.err);
    let none = place.call(&["measure", "no-*.csv"]);
    assert!(none.code == Some(2) && none.err.contains("no file matches"), "{}", none.err);
    place.write("a.scn", scenario.replace("run-*", "no-*").as_bytes());
    let missing = place.call(&["show", "a.scn"]);
    assert!(missing.code == Some(2) && missing.err.contains("no file matches `no-*.csv`"), "{}", missing.err);
}

/// `estimate` queries of numbers are asked of each instant: means, quantiles and tails over all of them.
#[test]
fn the_numbers_of_queries_are_monitored() {
    let scenario = "horizon = 2 s\nstep = 0.1 s\ntracks t = csv \"a.csv\"\nkind adult: preset smc2 { }\n\
        agent user: adult from t at 1 s id 1\nagents others: adult from t at 1 s except 1\n";
    let queries = "property slow = G<=1 s (speed(user) < 2 m/s)\nestimate E(max<=1 s (speed(user))) in 0 m/s .. 3 m/s\n\
        estimate Q(0.5, travelled(user) at 1 s), CVaR(0.5, max<=1 s (speed(user))) in 0 m/s .. 0.5 m/s\ncheck P(slow) >= 0.9\n";
    let place = Place::new(&[("a.csv", &three()), ("a.scn", scenario), ("a.bltl", queries)]);
    let call = ["monitor", "a.scn", "a.bltl", "--tracks", "t", "--user", "all", "--every", "500ms"];
    let said = place.call(&[&call[..], &["--format", "json"]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    let json: Value = said.json();
    let schema: Value = serde_json::from_str(include_str!("../docs/schema/monitor.schema.json")).unwrap();
    assert!(jsonschema::validator_for(&schema).unwrap().is_valid(&json), "{json:#}");
    let numbers = json["numbers"].as_array().unwrap();
    let of = |k: usize| numbers[k]["value"]["estimate"].as_f64().unwrap();
    // Two of three walk at 1 m/s, for the same number of instants as the third stands.
    assert!(
        (of(0) - 2.0 / 3.0).abs() < 0.05 && (of(1) - 1.0).abs() < 1e-6 && (of(2) - 0.5).abs() < 1e-9,
        "{json:#}"
    );
    assert!(numbers[2]["clipped"].as_u64().unwrap() > 10);
    assert_eq!((json["resampled"].as_str(), json["results"].as_array().unwrap().len()), (Some("persons"), 1));
    let text = place.call(&call).out;
    assert!(
        text.contains("bootstrap over persons") && text.contains("CVaR(0.5, max<=1 s (speed(user)))"),
        "{text}"
    );
    let alone = place.call(&["monitor", "a.scn", "a.bltl", "--tracks", "t"]).out;
    assert!(alone.contains("bootstrap over blocks of 30 s"), "{alone}");
}

/// A database of `JuPedSim` is read as it is written.
#[test]
fn a_database_of_jupedsim_is_read_as_it_is_written() {
    let scenario = "horizon = 2 s\nstep = 0.05 s\nscene { region east: rect (10, 0) .. (12, 4) }\nkind adult: preset smc2 { }\n\
        agents crowd[4]: adult { at = uniform in rect (1, 1) .. (4, 3); route = east }\n";
    let place = Place::new(&[("a.scn", scenario)]);
    if !cfg!(feature = "sqlite") {
        println!("skipped: built without the feature `sqlite`");
        place.write("a.sqlite", b"SQLite format 3\0");
        let found = place.call(&["measure", "a.sqlite"]);
        assert!(found.code == Some(2) && found.err.contains("--features sqlite"), "{}", found.err);
        return;
    }
    assert_eq!(place.call(&["simulate", "a.scn", "-o", "a.sqlite"]).code, Some(0));
    assert_eq!(place.call(&["simulate", "a.scn", "-o", "a.txt"]).code, Some(0));
    let [one, other] = ["a.sqlite", "a.txt"].map(|file| {
        let said = place.call(&["measure", file, "--format", "csv"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out
    });
    assert_eq!(one, other);
    let mut bytes = std::fs::read(place.path("a.sqlite")).unwrap();
    for at in (0..bytes.len()).step_by(997) {
        bytes[at] ^= 0x55;
        place.write("b.sqlite", &bytes);
        assert!(matches!(place.call(&["measure", "b.sqlite"]).code, Some(0 | 2)), "{at}");
    }
}

/// Columns beside the positions are numbers of formulas, in every format and in several files as one.
#[test]
fn other_columns_of_a_recording_are_numbers_of_formulas() {
    let number = |k: u32, id: u32| 70.0 + 10.0 * f64::from(id) + 0.5 * f64::from(k);
    let (mut table, mut lines) = ("time,id,x,y,Pulse,side\n".to_owned(), String::new());
    for (k, id) in (0..60).flat_map(|k| [(k, 1), (k, 2)]) {
        let (time, x) = (0.1 * f64::from(k), 0.1 * f64::from(k));
        // The second one loses the sensor.
        let pulse = if id == 2 && k > 40 { String::new() } else { number(k, id).to_string() };
        let _ = writeln!(table, "{time:.1},{id},{x:.1},{id},{pulse},left");
        let member = if pulse.is_empty() { String::new() } else { format!(",\"Pulse\":{pulse}") };
        let _ = writeln!(
            lines,
            "{{\"time\":{time:.1},\"agent\":\"{id}\",\"x\":{x:.1},\"y\":{id}{member},\"note\":\"a\"}}"
        );
    }
    let scenario = "horizon = 2 s\nstep = 0.1 s\ntracks t = csv \"a.csv\"\nkind adult: preset smc2 { }\n\
        agent user: adult from t at 0 s id 1\nagent other: adult from t at 0 s id 2\n";
    let queries = "property calm = G<=2 s (column(user, Pulse) < 100)\nproperty side = G<=2 s (column(other, Pulse) < 101)\n\
        estimate Q(0.5, column(user, Pulse) at end)\n";
    let place =
        Place::new(&[("a.csv", &table), ("a.jsonl", &lines), ("a.scn", scenario), ("a.bltl", queries)]);
    let said = place.call(&["monitor", "a.scn", "a.bltl", "--tracks", "t", "--format", "json"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let json: Value = said.json();
    let counts = |k: usize| {
        ["satisfied", "violated", "unresolved"].map(|name| json["results"][k][name].as_u64().unwrap())
    };
    // 100 is reached at 4 s and 101 at 2.2 s; the other has no number after 4 s.
    assert_eq!((counts(0), counts(1)), ([20, 40, 0], [2, 39, 19]));
    // The 20th of 40 windows that fit ends at 3.9 s.
    assert_eq!(json["numbers"][0]["value"]["estimate"].as_f64(), Some(number(39, 1)));
    let mean = ["--number", "mean(column(a, Pulse) for a in everyone)", "--format", "csv"];
    let rows = |file: &str| -> Vec<String> {
        let said = place.call(&[&["measure", file][..], &mean].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().to_owned()).collect()
    };
    let values = rows("a.csv");
    for (k, value) in (0..).zip(&values) {
        let wanted = if k > 40 { String::new() } else { (number(k, 1) + 5.0).to_string() };
        assert_eq!(value, &wanted, "{k}");
    }
    assert_eq!(rows("a.jsonl"), values);
    place.write("b.csv", table.as_bytes());
    assert_eq!(rows("*.csv"), [&values[..], &values[..]].concat());
    let wrong = [
        (
            &["measure", "a.csv", "--number", "max(column(a, Puls) for a in everyone)"][..],
            "did you mean `Pulse`?",
        ),
        (
            &["measure", "a.csv", "--number", "max(column(a, 3) for a in everyone)"],
            "expected the name of a column",
        ),
        (
            &["measure", "a.csv", "--number", "max(column(a, side) for a in everyone)"],
            "the recording has Pulse",
        ),
        (&["check", "a.scn", "a.bltl"], "in a simulated trial"),
    ];
    for (call, wanted) in wrong {
        let said = place.call(call);
        assert!(said.code == Some(2) && said.err.contains(wanted), "{call:?}: {}", said.err);
    }
}
