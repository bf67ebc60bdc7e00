//! `smc path` from the outside: paths of a scenario, shapes, way points, and calls that are wrong.

use crate::program::{Place, at_root};

const PAPER: &str = "L10 A45/7 L10 A60/3 L2";

fn of_shape(words: &[&str]) -> String {
    let said = Place::new(&[]).call(&[&["path"], words].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    said.out
}

#[test]
fn fastest_times_of_shapes_have_all_their_digits() {
    // 40-digit arithmetic; the first two in closed form.
    let cases = [
        (PAPER, "10 m/s", "2 m/s^2", 9.879_877_429_245_003),
        (PAPER, "1.5 m/s", "0.8 m/s^2", 22.301_253_198_247_956),
        ("A90/5", "10", "2", 4.145_837_013_806_854),
        ("L0.5 A90/0.5 L0.5", "5.4 km/h", "0.8", 3.533_668_049_347_74),
    ];
    for (shape, speed, acceleration, seconds) in cases {
        let out = of_shape(&["--shape", shape, "--speed", speed, "--acceleration", acceleration]);
        let first = out.lines().next().unwrap();
        let found: f64 = first.strip_prefix("optimal_s ").unwrap().parse().unwrap();
        assert!((found / seconds - 1.0).abs() < 1e-12, "{shape}: {found}");
        assert_eq!(first.split('.').next_back().unwrap().len(), 17, "{first}");
    }
}

#[test]
fn drawn_profiles_keep_limits_and_printed_ones_hardly_ever() {
    let with = |by: &str, count: &str| {
        let words =
            ["--shape", PAPER, "--speed", "10", "--acceleration", "2", "--profiles", count, "--by", by];
        of_shape(&words)
    };
    assert!(with("varied", "200").contains("200 of 200 profiles returned, 200 of them keep every limit"));
    assert!(with("uniform", "200").contains("200 of 200 profiles returned, 200 of them keep every limit"));
    let printed = with("printed", "10000");
    let line = printed.lines().find(|line| line.contains("returned")).unwrap();
    let numbers: Vec<f64> =
        line.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect();
    let [returned, all, legal] = numbers[..] else { panic!("{line}") };
    assert!(printed.contains("\n  profile 1 ") && printed.contains("and 9990 more"), "{printed}");
    // 83 % never return, 66 % of the others break a limit, each to two points.
    assert!((100.0 * (1.0 - returned / all) - 83.0).abs() < 2.0, "{line}");
    assert!((100.0 * (1.0 - legal / returned) - 66.0).abs() < 2.0, "{line}");
    // Of every run its fate; with four pieces or fewer none returns.
    let written = |words: &[&str]| {
        let by =
            ["--shape", PAPER, "--speed", "10", "--acceleration", "2", "--profiles", "40", "--by", "printed"];
        of_shape(&[&by, words].concat())
    };
    let json: serde_json::Value = serde_json::from_str(&written(&["--format", "json"])).unwrap();
    let runs = json["paths"].as_array().unwrap();
    assert_eq!(runs.len(), 40);
    for run in runs {
        let points = run["points"].as_array().map_or(0, Vec::len);
        assert_eq!(run["returned"] == true, points > 3 && run["why"].is_null(), "{run}");
    }
    let csv = written(&["--format", "csv"]);
    assert!(csv.starts_with("path,returned,breaks,t,s,v,a\nprofile 1,"), "{}", &csv[..80]);
    assert_eq!(csv.matches(",false,").count(), runs.iter().filter(|run| run["returned"] == false).count());
    assert!(written(&["--pieces", "4"]).contains("\n0 of 40 profiles returned"));
    assert!(written(&["--format", "svg", "--figure", "phase"]).contains("breaks the limit"));
    let slow =
        ["--shape", PAPER, "--speed", "10", "--acceleration", "2", "--profiles", "2", "--duration", "40s"];
    assert!(of_shape(&slow).contains("durations 40.000000, 40.000000 s"));
}

#[test]
fn paths_of_a_scenario_come_as_text_tables_and_pictures() {
    let said = |words: &[&str]| {
        let said = at_root(&[&["path", "models/plaza.scn"], words].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out
    };
    let text = said(&[]);
    assert_eq!(text.lines().count(), 17, "15 walkers, one of them with 3 paths\n{text}");
    let csv = said(&["--agent", "people[2]", "--format", "csv", "--dt", "0.5s"]);
    let mut rows = csv.lines();
    assert_eq!(rows.next(), Some("agent,path,t,s,x,y,vx,vy,ax,ay,segment"));
    let last: Vec<f64> = rows.next_back().unwrap().split(',').skip(2).map(|v| v.parse().unwrap()).collect();
    assert!(last[2] > 18.0 && last[3] < 2.0 && last[4].abs() < 1e-6, "at rest in the goal: {last:?}");
    let json: serde_json::Value =
        serde_json::from_str(&said(&["--agent", "people[1]", "--format", "json"])).unwrap();
    let paths = json["paths"].as_array().unwrap();
    assert_eq!(paths.len(), 3);
    assert!(json["roadmap"]["vertices"].as_array().unwrap().len() > 100);
    let classes: std::collections::BTreeSet<String> =
        paths.iter().map(|path| path["class"].to_string()).collect();
    assert_eq!(classes.len(), 3, "{classes:?}");
    for path in paths {
        let knots = path["knots"]["x"].as_array().unwrap();
        assert!((3..=11).contains(&knots.len()) && path["duration_s"].as_f64() >= path["optimal_s"].as_f64());
    }
    let map = said(&["--agent", "people[2]", "--format", "svg", "--at", "5s,10s"]);
    assert!(map.contains(">at 5 s</text>") && map.contains(">at 10 s</text>"));
    for figure in ["map", "phase", "speed"] {
        let svg = said(&["--agent", "people[1]", "--format", "svg", "--figure", figure]);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{figure}");
    }
}

#[test]
fn way_points_are_rounded() {
    let place = Place::new(&[("corners.csv", "x,y\n0,0\n10,0\n10,10\n"), ("wrong.csv", "x,y\n0,0\n1,a\n")]);
    let said = place.call(&["path", "--waypoints", "corners.csv", "--corner", "2m", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{}", said.err));
    let length = json["paths"][0]["length"].as_f64().unwrap();
    assert!((length - (16.0 + std::f64::consts::PI)).abs() < 1e-9, "{length}");
    // As in the paper an arc takes at most half of each edge: 5 m here, where 7 m were free.
    let longest = |words: &[&str]| {
        let words =
            [&["path", "--waypoints", "corners.csv", "--corner", "7m", "--format", "json"], words].concat();
        let json = place.call(&words).json();
        json["paths"][0]["segments"][1]["radius"].as_f64().unwrap()
    };
    assert!((longest(&[]) - 7.0).abs() < 1e-9 && (longest(&["--half-edges"]) - 5.0).abs() < 1e-9);
    let said = place.call(&["path", "--waypoints", "wrong.csv"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("line 3"), "{}", said.err);
}

#[test]
fn way_points_that_are_no_path_are_refused() {
    for (points, wanted) in [
        ("1,2\n", "needs two different points"),
        ("", "needs two different points"),
        ("1,2\n1,2\n1,2\n", "needs two different points"),
        ("0,0\n2e6,0\n", "line 3: a coordinate must lie between -1e6 m and 1e6 m (got 2e6 m)"),
    ] {
        let place = Place::new(&[("points.csv", &format!("x,y\n{points}"))]);
        let said = place.call(&["path", "--waypoints", "points.csv"]);
        assert!(said.code == Some(2) && said.err.contains(wanted), "{points}: {}", said.err);
    }
}

#[test]
fn numbers_and_tables_without_bounds_are_refused() {
    for (words, wanted) in [
        (&["--shape", "L5", "--pieces", "1"][..], "write a whole number from 2 to 64"),
        (&["--shape", "L5", "--pieces", "0"], "write a whole number from 2 to 64"),
        (&["--shape", "L5", "--pieces", "65"], "write a whole number from 2 to 64"),
        (&["--shape", "L5", "--profiles", "1000000000"], "write a whole number from 0 to 10000"),
        (&["--shape", "L1e6", "--format", "csv", "--dt", "1ms"], "rows, more than 1000000"),
    ] {
        let said = Place::new(&[]).call(&[&["path"], words].concat());
        assert!(said.code == Some(2) && said.err.contains(wanted), "{words:?}: {}", said.err);
    }
}

#[test]
fn wrong_calls_are_refused_with_a_hint() {
    let shaped: [(&[&str], &str); 6] = [
        (&[], "takes a scenario, `--shape` or `--waypoints`"),
        (&["--shape", "L10 A45"], "column 5"),
        (&["--shape", "L10", "--speed", "fast"], "must be a number of at least 0 in m/s"),
        (&["--shape", "L10", "--speed", "0"], "must be positive"),
        (&["--shape", "L1", "--speed", "9", "--start-speed", "5 m/s"], "from 0 to 1.26491"),
        (&["--shape", "L10", "--format", "svg", "--width", "2mm"], "from 40mm to 1000mm"),
    ];
    for (words, said) in shaped {
        let found = Place::new(&[]).call(&[&["path"], words].concat());
        assert_eq!(found.code, Some(2), "{words:?}");
        assert!(found.err.contains(said), "{words:?}\n{}", found.err);
    }
    let of_model = |words: &[&str]| at_root(&[&["path"], words].concat());
    let nobody = of_model(&["models/corridor.scn"]);
    assert!(nobody.code == Some(2) && nobody.err.contains("nobody plans"), "{}", nobody.err);
    let other = of_model(&["models/plaza.scn", "--agent", "people[99]"]);
    assert!(other.code == Some(2) && other.err.contains("people[9"), "{}", other.err);
}
