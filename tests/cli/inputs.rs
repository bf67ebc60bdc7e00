//! Files of every kind: missing, empty, binary, deep, from standard input; formatting.

use crate::program::{Place, SMALL, recordings};

#[test]
fn bad_files_are_refused_with_a_reason() {
    let place =
        Place::new(&[("a.scn", SMALL), ("empty.scn", ""), ("empty.bltl", "\n"), ("a.bltl", "let a = 1\n")]);
    place.write("binary.scn", &(0..=255).collect::<Vec<u8>>());
    let wide: Vec<u8> = SMALL.encode_utf16().flat_map(u16::to_le_bytes).collect();
    place.write("wide.scn", &[&[0xff, 0xfe][..], &wide].concat());
    place.write(
        "deep.bltl",
        format!("property p = {}true{}\n", "(".repeat(100_000), ")".repeat(100_000)).as_bytes(),
    );
    place.write("deeper.bltl", format!("property p = {}true\n", "!".repeat(100_000)).as_bytes());
    std::fs::create_dir(place.path("directory")).unwrap();
    for (scenario, properties, code, reason) in [
        ("none.scn", "a.bltl", "E0701", "the file `none.scn` does not exist"),
        ("a.scn", "none.bltl", "E0701", "the file `none.bltl` does not exist"),
        ("directory", "a.bltl", "E0701", "`directory` is a directory"),
        ("empty.scn", "a.bltl", "E0108", "empty"),
        ("a.scn", "empty.bltl", "E0108", "empty"),
        ("binary.scn", "a.bltl", "E0107", "UTF-8"),
        ("wide.scn", "a.bltl", "E0107", "UTF-16"),
        ("a.scn", "deep.bltl", "E0106", "256"),
        ("a.scn", "deeper.bltl", "E0106", "256"),
        ("-", "-", "E0701", "once"),
    ] {
        let said = place.call(&["check", scenario, properties]);
        assert_eq!(said.code, Some(2), "{scenario} {properties}\n{}", said.err);
        assert!(
            said.err.contains(code) && said.err.contains(reason),
            "{scenario} {properties}\n{}",
            said.err
        );
        assert!(said.err.matches("error[").count() == 1 && said.err.len() < 2000, "{}", said.err);
        assert_eq!(said.out, "");
    }
}

#[test]
fn standard_input_is_a_file_too() {
    let query = "estimate P(F<=1 s contact(user)) by fixed(trials = 10)\n";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", query)]);
    let mut whole = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    for (words, input) in [(["-", "a.bltl"], SMALL), (["a.scn", "-"], query)] {
        let said = place.fed(&[&["check"][..], &words, &["-q", "--format", "json"]].concat(), input);
        assert_eq!(said.code, Some(0), "{}", said.err);
        for field in ["estimate", "successes", "steps"] {
            assert_eq!(said.json()["results"][0][field], whole["results"][0][field].take());
            whole["results"][0][field] = said.json()["results"][0][field].clone();
        }
    }
    let said = place.fed(&["check", "a.scn", "-"], "check P(usr) >= 0.5\n");
    assert!(said.code == Some(2) && said.err.contains("<stdin>:1:9"), "{}", said.err);
}

#[test]
fn formatting_keeps_comments_and_settles() {
    let ragged = "scenario   \"R\" // why\nhorizon=4 s\nstep = 0.02 s\n/* wide */ kind adult:sfm preset helbing2000{noise=0.05 m/s}\n";
    let place = Place::new(&[("r.scn", ragged), ("bad.bltl", "property = \n"), ("notes.txt", "x")]);
    let said = place.call(&["fmt", "--check", "r.scn"]);
    assert!(said.code == Some(1) && said.err.contains("r.scn is not formatted"), "{}", said.err);
    assert_eq!(std::fs::read_to_string(place.path("r.scn")).unwrap(), ragged, "--check changes nothing");
    assert_eq!(place.call(&["fmt", "r.scn"]).code, Some(0));
    let once = std::fs::read_to_string(place.path("r.scn")).unwrap();
    assert!(once != ragged && once.contains("// why") && once.contains("/* wide */"), "{once}");
    assert_eq!(place.call(&["fmt", "--check", "r.scn"]).code, Some(0), "formatted text stays as it is");
    assert_eq!(place.fed(&["fmt", "-"], ragged).out, once);
    assert_eq!(place.call(&["fmt", "bad.bltl"]).code, Some(2));
    assert_eq!(
        std::fs::read_to_string(place.path("bad.bltl")).unwrap(),
        "property = \n",
        "errors change nothing"
    );
    assert_eq!(place.call(&["fmt", "notes.txt"]).code, Some(2));
    assert_eq!(place.call(&["fmt", "none.scn"]).code, Some(2));
}

#[test]
fn a_crowd_of_nobody_is_legal() {
    let properties = "\
property all = G<=1 s (forall a in crowd: contact(a))
property some = F<=1 s (exists a in crowd: contact(a))
property lonely = G<=1 s (min(distance(user, a) for a in crowd) > 1000 m)
check P(all) >= 0.9
check P(some) <= 0.1
check P(lonely) >= 0.9
estimate P(F<=1 s (mean(speed(a) for a in crowd) > 0 m/s)) by fixed(trials = 7)
";
    let place = Place::new(&[("a.scn", SMALL), ("a.bltl", properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--set", "density=0"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let json = said.json();
    for result in &json["results"].as_array().unwrap()[..3] {
        assert_eq!(result["verdict"], "satisfied", "{result}");
    }
    // The mean of nobody has no value.
    assert_eq!(json["results"][3]["unresolved"], 7);
}

#[test]
fn long_chains_of_names_are_one_error_and_long_lists_are_none() {
    let list = |each: &dyn Fn(usize) -> String| (0..5000).map(each).collect::<String>();
    let chain = list(&|k| format!("let a{} = a{k} + 1\n", k + 1)) + "let a0 = 1\n";
    let back = list(&|k| format!("let a{k} = a{} + 1\n", k + 1)) + "let a5000 = 1\n";
    let constants = back.replace("let", "const");
    let kinds = list(&|k| format!("kind a{k}: a{} {{ }}\n", k + 1)) + "kind a5000: adult { }\n";
    let independent = list(&|k| format!("let a{k} = {k} + 1\n"));
    let place = Place::new(&[]);
    for (text, errors) in [(chain, 1), (back, 1), (constants, 1), (kinds, 1), (independent, 0)] {
        place.write("a.scn", format!("{text}{SMALL}").as_bytes());
        let said = place.call(&["show", "a.scn"]);
        assert_eq!(said.err.matches("error").count(), errors, "{}", said.err);
        assert_eq!(said.err.matches("error[E0211]").count(), errors, "{}", said.err);
    }
}

#[test]
fn filters_of_imports_come_before_what_is_wrong_with_shapes() {
    let shapes = r#"{"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"kind": "broken"},
         "geometry": {"type": "Polygon", "coordinates": [[[0,90],[2,92],[2,90],[0,92],[0,90]]]}},
        {"type": "Feature", "properties": {"kind": "pierced"},
         "geometry": {"type": "Polygon", "coordinates": [[[0,90],[2,90],[2,92],[0,92]], [[3,90],[4,90],[4,91]]]}},
        {"type": "Feature", "properties": {"kind": "wall"},
         "geometry": {"type": "LineString", "coordinates": [[0,90],[2,90]]}}]}"#;
    let place = Place::new(&[("a.json", shapes)]);
    let import = |filter: &str| {
        place.write("a.scn", format!("scene {{ import \"a.json\" {filter} }}\n{SMALL}").as_bytes());
        place.call(&["show", "a.scn"])
    };
    let said = import("where kind == \"wall\"");
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let said = import("where kind != \"broken\"");
    assert!(said.code == Some(2) && said.err.contains("hole 1 is outside the outline"), "{}", said.err);
    let said = import("");
    assert!(said.err.contains("E0704") && said.err.contains("meets itself"), "{}", said.err);
}

#[test]
fn what_the_draw_makes_impossible_is_unresolved() {
    let scenario = "horizon = 0.1 s; step = 0.02 s\n\
        scene { obstacle rect (1, -1) .. (6, 1.1); region strip: rect (0, 0) .. (6, 0.1) }\n\
        kind adult: sfm preset helbing2000 { noise = 0.05 m/s; radius = uniform(0.15 m, 0.45 m) }\n\
        agents crowd[3]: adult { at = uniform in strip }\n";
    let query = "estimate P(F<=0.1 s contact(crowd[1])) by fixed(trials = 60)\n";
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", query)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains(": cannot start: crowd["), "{}", said.out);
    assert!(
        said.out.contains("has no place outside obstacles and walls; use a larger start area"),
        "{}",
        said.out
    );
    assert!(!said.out.contains("smaller step"), "{}", said.out);
    let said = place.call(&["simulate", "a.scn", "--trials", "60"]);
    assert!(said.err.contains("cannot start: crowd["), "{}", said.err);
}

#[test]
fn nobody_comes_twice_from_a_recording() {
    let tracks =
        "0 1 1.0 0 2.0 1.0 0 0\n0 2 3.0 0 2.0 1.0 0 0\n10 1 1.4 0 2.0 1.0 0 0\n10 2 3.4 0 2.0 1.0 0 0\n";
    let place = Place::new(&[("t.txt", tracks)]);
    let show = |people: &str| {
        let scenario = format!(
            "horizon = 1 s; step = 0.02 s\ntracks t = eth_biwi \"t.txt\"\n\
             kind adult: sfm preset helbing2000 {{ noise = 0.05 m/s }}\n{people}\n"
        );
        place.write("a.scn", scenario.as_bytes());
        place.call(&["show", "a.scn"])
    };
    let user = "agent user: adult from t at 0 s id 1\n";
    assert_eq!(show(&format!("{user}agents rest: adult from t at 0 s except 1")).code, Some(0));
    for (people, said) in [
        (format!("{user}agents rest: adult from t at 0.2 s"), "person 1 of `t` is already used"),
        (format!("{user}agent other: adult from t at 0.2 s id 1"), "person 1 of `t` is already used"),
        ("agents rest: adult from t at 0 s except 1, 1".to_owned(), "person 1 is listed twice"),
    ] {
        let found = show(&people);
        assert_eq!(found.code, Some(2), "{people}");
        assert!(found.err.starts_with("error[E0703]") && found.err.contains(said), "{}", found.err);
        assert_eq!(found.err.matches("error").count(), 1, "{}", found.err);
    }
}

#[test]
fn those_recorded_in_an_obstacle_start_beside_it() {
    let tracks =
        "1 1 2.25 0 0.5 0 0 0.5\n1 2 5 0 0.5 0 0 0.5\n11 1 2.25 0 0.7 0 0 0.5\n11 2 5 0 0.7 0 0 0.5\n";
    let scenario = "\
horizon = 1 s; step = 0.02 s
tracks t = eth_biwi \"t.txt\"
scene { obstacle box: rect (2, 0) .. (4, 1); wall (5.05, 0) -- (5.05, 1) }
kind adult: sfm preset helbing2000 { radius = uniform(0.25 m, 0.3 m) }
agents all: adult from t at 0 s
";
    let property = "check P(F<=1 s contact(all[1])) <= 0.9\n";
    let place = Place::new(&[("t.txt", tracks), ("a.scn", scenario), ("a.bltl", property)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("warning[W0701]: 2 persons were recorded inside or close to barriers"),
        "{}",
        said.err
    );
    let moved = "person 1 was recorded inside the obstacle `box` and starts 0.550 m away at (1.700, 0.500)";
    assert!(said.err.contains(moved), "{}", said.err);
    let moved = "person 2 was recorded 0.050 m from a wall and starts 0.250 m away at (4.750, 0.500)";
    assert!(said.err.contains(moved), "{}", said.err);
    assert!(!said.out.contains("made smaller"), "{}", said.out);
}

#[test]
fn a_recorded_instant_is_usable_although_somebody_was_recorded_in_an_obstacle() {
    let Some(data) = recordings() else { return };
    let scenario = "\
horizon = 0.4 s; step = 0.02 s
tracks hotel = eth_biwi \"seq_hotel/obsmat.txt\"
scene { import \"hotel-obstacles.geojson\" where source == \"map.png\" }
kind adult: sfm preset helbing2000 { noise = 0.08 m/s }
agents all: adult from hotel at 533.59 s
";
    let property = "estimate P(F<=0.4 s contact(all[1])) within 0.1\n";
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", property)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--data", data.to_str().unwrap()]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("W0701") && said.err.contains(" was recorded inside the obstacle"),
        "{}",
        said.err
    );
    assert!(!said.out.contains("unresolved"), "{}", said.out);
}

#[test]
fn bodies_that_are_made_smaller_are_named_with_what_they_overlap() {
    let scenario = "\
horizon = 1 s; step = 0.02 s
scene { wall south: (0, 0) -- (9, 0); wall (0, 3) -- (9, 3) }
kind adult: sfm preset helbing2000 { radius = 0.3 m }
agent near: adult { at = (1, 0.2) }
agents two[2]: adult { at = near near within 1 m; radius = 0.1 m }
agent left: adult { at = (5, 1.5) }
agent right: adult { at = (5.45, 1.5) }
";
    let property = "check P(F<=1 s contact(near)) <= 0.9\n";
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", property)]);
    let checked = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let (result, trials) = (&checked["results"][0], &checked["results"][0]["trials"]);
    assert_eq!(&result["shrunk"], trials);
    let bodies = "in trial 0: `near` at the wall `south` from a radius of 0.3 m to 0.2 m, `left` at `right` from a radius \
                  of 0.3 m to 0.225 m, `right` at `left` from a radius of 0.3 m to 0.225 m";
    let wanted =
        format!("radii of bodies that overlapped at the start were reduced in {trials} trials; {bodies}");
    assert_eq!(result["warnings"][0], wanted);
    let traced = place.call(&["simulate", "a.scn", "--trials", "2"]);
    assert_eq!(traced.code, Some(0), "{}", traced.err);
    let wanted = format!("radii of bodies that overlapped at the start were reduced in 2 trials; {bodies}");
    assert!(traced.err.contains(&wanted), "{}", traced.err);
}

#[test]
fn walls_of_imports_that_nearly_meet_are_told_and_joined() {
    let walls = "LINESTRING (0 0, 9 0)\nLINESTRING (9.004 0.003, 9 5)\nLINESTRING (1 0.02, 8 0.02)\nLINESTRING (4 5, 4 0.01)\n";
    let scenario = |how: &str| {
        format!(
            "horizon = 1 s; step = 0.02 s\nscene {{\n  wall own: (0, 9) -- (9, 9)\n  import \"w.wkt\"{how}\n  wall other: (0, 10) -- (9, 10)\n}}\n\
             kind adult: sfm preset helbing2000\nagent me: adult {{ at = (2, 2) }}\n"
        )
    };
    let place = Place::new(&[
        ("w.wkt", walls),
        ("plain.scn", &scenario("")),
        ("a.scn", &scenario(" { snap = 5 cm }")),
    ]);
    let plain = place.call(&["show", "plain.scn"]);
    assert_eq!(plain.code, Some(0), "{}", plain.err);
    let told = "warning[W0702]: the file has 3 ends of walls that miss another wall by less than 5 cm and 1 wall drawn twice";
    assert!(plain.err.contains(told), "{}", plain.err);
    assert!(plain.err.contains("write `import \"w.wkt\" { snap = 5 cm }`"), "{}", plain.err);
    let snapped = place.call(&["show", "a.scn"]);
    assert_eq!((snapped.code, snapped.err.as_str()), (Some(0), ""));
    let shown: Vec<&str> = snapped.out.lines().filter(|line| line.starts_with("  wall")).collect();
    let wanted = [
        "  wall own: 1 segment, 9 m",
        "  wall other: 1 segment, 9 m",
        "  wall: 1 segment, 9 m",
        "  wall: 1 segment, 5 m",
        "  wall: 1 segment, 5 m",
    ];
    assert_eq!(shown, wanted);
    for (how, said) in [
        ("{ snap = 0 m }", "error[E0405]: `snap` must be positive and at most 1 m (got 0 m)"),
        ("{ snap = 2 }", "error[E0303]"),
        ("{ snip = 5 cm }", "error[E0207]: unknown field `snip`"),
        ("{ snap = 5 cm; snap = 6 cm }", "error[E0202]: `snap` is set twice"),
    ] {
        place.write("a.scn", scenario(how).as_bytes());
        let found = place.call(&["show", "a.scn"]);
        assert_eq!((found.code, found.err.matches("error").count()), (Some(2), 1), "{}", found.err);
        assert!(found.err.starts_with(said), "{}", found.err);
    }
}

#[test]
fn what_comes_from_standard_input_is_formatted_as_what_it_is() {
    let place = Place::new(&[]);
    let said = place.fed(&["fmt", "-"], "estimate   P(true) within 0.1");
    assert_eq!((said.code, said.out.as_str()), (Some(0), "estimate P(true) within 0.1\n"), "{}", said.err);
    let said = place.fed(&["fmt", "-"], "horizon   = 3 s");
    assert_eq!((said.code, said.out.as_str()), (Some(0), "horizon = 3 s\n"), "{}", said.err);
    let said = place.fed(&["fmt", "-", "--language", "scn"], "estimate   P(true) within 0.1");
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
}

#[test]
fn imports_that_yield_nothing_are_told() {
    let point = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"kind":"wall"},"geometry":{"type":"Point","coordinates":[1,2]}}]}"#;
    let line = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"kind":"wall"},"geometry":{"type":"LineString","coordinates":[[1,2],[3,4]]}}]}"#;
    let place = Place::new(&[("e.wkt", " \n"), ("p.geojson", point), ("l.geojson", line)]);
    for (import, code, said) in [
        (r#""e.wkt""#, Some(2), "error[E0704]: the file is empty"),
        (r#""p.geojson""#, Some(0), "points are ignored"),
        (r#""l.geojson" where kind == "door""#, Some(0), "their properties are `kind`"),
        // What no feature has would differ from everything.
        (r#""l.geojson" where knd == "wall""#, Some(2), "did you mean `kind`?"),
        (r#""l.geojson" where kind == wall"#, Some(2), "error[E0201]: unknown property `wall`"),
        (r#""l.geojson" where "kind" == "wall""#, Some(2), "error[E0305]: a filter can compare properties"),
        (r#""l.geojson" where kind == "wall""#, Some(0), ""),
    ] {
        place.write("a.scn", format!("{SMALL}\nscene {{ import {import} }}\n").as_bytes());
        let found = place.call(&["show", "a.scn"]);
        assert_eq!(found.code, code, "{import}: {}", found.err);
        assert!(
            found.err.contains(said) && said.is_empty() == found.err.is_empty(),
            "{import}: {}",
            found.err
        );
    }
}

#[test]
fn a_scenario_of_comments_is_an_empty_one() {
    for text in ["// only a comment\n", "/* nothing */", ";\n"] {
        let place = Place::new(&[("a.scn", text), ("a.bltl", "check P(1 < 2) >= 0.5\n")]);
        for call in [&["check", "a.scn", "a.bltl"][..], &["show", "a.scn"], &["simulate", "a.scn"]] {
            let said = place.call(call);
            assert_eq!(said.code, Some(2), "{}", said.err);
            assert_eq!(said.err, "error[E0108]: a.scn has no declarations\n\n", "{text}");
        }
    }
}

#[test]
fn a_property_file_on_standard_input_is_blamed_as_one() {
    let said = Place::new(&[]).fed(&["fmt", "-"], "property a = X true\ncheck P(a) > 0.5 wthin\n");
    assert!(said.err.contains(":2:18"), "{}", said.err);
}

#[test]
fn files_in_the_wrong_order_are_named_as_such() {
    let place =
        Place::new(&[("a.scn", SMALL), ("a.bltl", "property p = contact(user)\ncheck P(p) >= 0.5\n")]);
    let said = place.call(&["check", "a.bltl", "a.scn"]);
    assert_eq!((said.code, said.err.matches("error[").count()), (Some(2), 2), "{}", said.err);
    for hint in ["this is a property file; write the scenario first", "this is a scenario; write it first"] {
        assert!(said.err.contains(hint), "{}", said.err);
    }
    // What is wrong in either language is no matter of order.
    place.write("b.scn", SMALL.replace("horizon = 4 s", "horizon 4 s").as_bytes());
    let said = place.call(&["check", "b.scn", "a.bltl"]);
    assert!(said.code == Some(2) && !said.err.contains("comes first"), "{}", said.err);
}

#[test]
fn multiples_of_distributions_are_shown_as_they_were_written() {
    let kinds = "kind slow: adult { speed = bernoulli(10 %) * 1 m/s }\n\
                 kind quick: adult { speed = 2 * lognormal(1, 0.1) * 1 m/s }\n\
                 agent a: slow { at = (1, 0.5) }\nagent b: quick { at = (1, 2.5) }\n";
    let place = Place::new(&[("a.scn", &format!("{SMALL}{kinds}"))]);
    let said = place.call(&["show", "a.scn"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    for law in ["speed bernoulli(0.1) * 1 m/s,", "speed lognormal(2 m/s, 0.2 m/s),"] {
        assert!(said.out.contains(law), "{}", said.out);
    }
    // Several factors are one, of the wrong unit too.
    place.write("b.scn", format!("{SMALL}{}", kinds.replace("* 1 m/s }\n", "* 1 m }\n")).as_bytes());
    let said = place.call(&["show", "b.scn"]);
    assert_eq!((said.code, said.err.matches("error[E0303]").count()), (Some(2), 2), "{}", said.err);
}

#[cfg(unix)]
#[test]
fn the_folder_behind_a_link_is_named() {
    let scenario = "horizon = 2 s\nstep = 0.05 s\nscene { import \"room.wkt\" as walkable }\n";
    let place = Place::new(&[("a.bltl", "let a = 1\n")]);
    std::fs::create_dir(place.path("plans")).unwrap();
    place.write("plans/room.scn", scenario.as_bytes());
    place.write("plans/room.wkt", b"POLYGON ((0 0, 9 0, 9 5, 0 5, 0 0))");
    std::os::unix::fs::symlink("plans/room.scn", place.path("link.scn")).unwrap();
    let said = place.call(&["check", "link.scn", "a.bltl"]);
    assert!(said.code == Some(2) && said.err.contains("add `--data plans`"), "{}", said.err);
    assert_eq!(place.call(&["show", "link.scn", "--data", "plans"]).code, Some(0));
}
