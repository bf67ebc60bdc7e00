//! `smc gait` from the outside: steps, learned gaits, scores, and data that is wrong.

use crate::program::{Place, at_root};
use std::fmt::Write as _;

const CASES: [(&str, &str); 4] = [
    ("circle.bvh", include_str!("../cases/mocap/circle.bvh")),
    ("walker.asf", include_str!("../cases/mocap/walker.asf")),
    ("walker_01.amc", include_str!("../cases/mocap/walker_01.amc")),
    ("clips.csv", include_str!("../cases/mocap/clips.csv")),
];

/// Walks as positions of joints at 60 frames per second, one clip each, with steps whose lengths and durations vary.
fn walks(clips: u32, steps: u32) -> String {
    const JOINTS: [&str; 5] = ["hip", "lankle", "ltoe", "rankle", "rtoe"];
    let mut table = "clip,frame".to_owned();
    for joint in JOINTS {
        let _ = write!(table, ",{joint}_x,{joint}_y,{joint}_z");
    }
    table.push('\n');
    for clip in 0..clips {
        let vary = |k: u32, by: u32| f64::from((clip * 31 + k * 17 + k * k * 5) % by) / f64::from(by) - 0.5;
        let mut contacts = vec![(0.0, 0.0)];
        for k in 0..=steps {
            let (x, t): (f64, f64) = contacts[k as usize];
            contacts.push((x + 0.65 + 0.12 * vary(k, 29), t + 0.52 + 0.06 * vary(k, 23)));
        }
        let end = contacts[steps as usize].1;
        for frame in 0..(end * 60.0) as u32 {
            let t = f64::from(frame) / 60.0;
            let k = contacts.iter().position(|(_, from)| *from > t).unwrap() - 1;
            let ((here, from), (next, to)) = (contacts[k], contacts[k + 1]);
            let share = (t - from) / (to - from);
            let before = if k > 0 { contacts[k - 1].0 } else { here - 0.6 };
            // The foot of step k stands; the other one swings in the middle of the step.
            let swing = ((share - 0.15) / 0.7).clamp(0.0, 1.0);
            let swung = before + (next - before) * swing * swing * (3.0 - 2.0 * swing);
            let left = k % 2 == 0;
            let (left_x, right_x) = if left { (here, swung) } else { (swung, here) };
            let side = if left { 1.0 } else { -1.0 };
            let sway = side * (0.02 + 0.01 * vary(k as u32, 11)) * (std::f64::consts::PI * share).sin();
            let hip = 0.5 * (before + here) + 0.5 * (next - before) * share;
            let _ = write!(table, "w{clip:02},{frame},{hip:.5},0.9,{sway:.5}");
            for (x, z) in [(left_x, -0.1), (right_x, 0.1)] {
                let _ = write!(table, ",{x:.5},0.08,{z},{:.5},0.03,{z}", x + 0.13);
            }
            table.push('\n');
        }
    }
    table
}

/// A table of takes with two subjects.
fn table(clips: u32) -> String {
    let row = |k: u32| format!("walks.csv,w{k:02},s{},60\n", k % 2);
    format!("file,clip,subject,fps\n{}", (0..clips).map(row).collect::<String>())
}

#[test]
fn steps_are_reported_written_and_drawn() {
    let place = Place::new(&CASES);
    let files = ["circle.bvh", "walker_01.amc", "clips.csv"];
    let said = place.call(&[&["gait", "steps"][..], &files].concat());
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    for part in ["take ", "circle ", "walker_01", "stand", "1 began before the take", "\nall "] {
        assert!(said.out.contains(part), "{part}\n{}", said.out);
    }
    let said = place.call(&[&["gait", "steps", "--format", "csv"][..], &files].concat());
    let head = "take,subject,step,foot,phase,from,to,length,turn,duration,width\n";
    assert!(said.out.starts_with(head), "{}", said.out);
    // A take without a subject has that of its file, without the number at its end.
    assert!(said.out.contains("\nwalker_01,walker,") && said.out.contains("\nstand,clips,0,left,first,"));
    let said = place.call(&["gait", "steps", "circle.bvh", "--format", "svg", "-o", "steps.svg"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""));
    let svg = std::fs::read_to_string(place.path("steps.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("left (") && svg.contains(" m</text>"), "{svg}");
    // Other rules and other readings.
    for words in [&["--contact", "adaptive"][..], &["--unit", "1cm"], &["--source", "cmu-bvh", "--skip", "0"]]
    {
        let said = place.call(&[&["gait", "steps", "circle.bvh"], words].concat());
        assert_eq!(said.code, Some(0), "{words:?}\n{}", said.err);
    }
    let said = place.fed(
        &["gait", "steps", "-"],
        &format!("file,clip,subject,fps\n{}/circle.bvh,,me,\n", place.path("").display()),
    );
    assert!(said.code == Some(0) && said.out.contains("circle "), "{}", said.err);
}

#[test]
fn a_gait_is_learned_shown_drawn_from_and_scored() {
    let place = Place::new(&[("walks.csv", &walks(24, 14)), ("takes.csv", &table(24))]);
    let said = place.call(&[
        "gait",
        "fit",
        "takes.csv",
        "-o",
        "a.gait",
        "--source-note",
        "made",
        "--license",
        "none",
    ]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("warning[W0721]: first steps of the left foot that were recorded: 0"),
        "{}",
        said.err
    );
    assert!(said.out.contains("made") && said.out.contains("2 subjects"), "{}", said.out);
    let shown = place.call(&["gait", "show", "a.gait"]);
    assert_eq!((shown.code, &shown.out), (Some(0), &said.out));
    let json = place.call(&["gait", "show", "a.gait", "--format", "json"]).json();
    assert_eq!((json["source"].as_str(), json["feet"].as_array().map(Vec::len)), (Some("made"), Some(2)));
    let words = ["gait", "sample", "a.gait", "-n", "100", "--seed", "3"];
    let drawn = place.call(&words).out;
    assert!(drawn.starts_with("subject,step,foot,phase,length,turn,duration\n0,0,left,first,"), "{drawn}");
    assert_eq!((drawn.lines().count(), &place.call(&words).out), (101, &drawn));
    let mean = |phase: &str| {
        let of = drawn.lines().filter(|line| line.contains(phase));
        let lengths: Vec<f64> = of.map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
        lengths.iter().sum::<f64>() / lengths.len() as f64
    };
    assert!((mean(",inner,") - 0.65).abs() < 0.03, "{drawn}");
    assert!((mean(",first,") / mean(",inner,") - 0.57).abs() < 0.1, "{drawn}");
    for words in
        [&["a.gait", "takes.csv", "--subjects", "s1"][..], &["takes.csv", "--folds", "2", "--linear"]]
    {
        let said = place.call(&[&["gait", "score"], words].concat());
        assert_eq!(said.code, Some(0), "{words:?}\n{}", said.err);
        assert!(said.out.contains("NLPD") && said.out.contains("90 % intervals"), "{}", said.out);
    }
    let json = place.call(&["gait", "score", "a.gait", "takes.csv", "--format", "json"]).json();
    assert!(json["all"]["nlpd"].is_number() && json["parts"][0]["part"] == "held out");
    // Fewer pairs: a warning, then an error.
    let said = place.call(&["gait", "fit", "takes.csv", "--subjects", "s0", "-o", "b.gait"]);
    assert!(said.code == Some(0) && said.err.contains("below 200"), "{}", said.err);
    assert!(said.err.contains("one subject"), "{}", said.err);
    let damaged = std::fs::read_to_string(place.path("a.gait")).unwrap();
    place.write("short.gait", &damaged.as_bytes()[..500]);
    place.write("new.gait", damaged.replacen("\"version\":1", "\"version\":9", 1).as_bytes());
    for (file, part) in [
        ("short.gait", "EOF"),
        ("new.gait", "version 1 of the format is needed (got 9)"),
        ("walks.csv", "not a complete"),
    ] {
        let said = place.call(&["gait", "show", file]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
        assert!(said.err.contains("error[E0723]: ") && said.err.contains(part), "{}", said.err);
    }
}

#[test]
fn data_that_is_wrong_has_a_code_and_a_place() {
    let circle = CASES[0].1;
    let place = Place::new(&CASES);
    place.write("cut.bvh", &circle.as_bytes()[..3000]);
    let at = circle.lines().nth(44).unwrap();
    let first = at.split_whitespace().next().unwrap();
    place.write("nan.bvh", circle.replacen(at, &at.replacen(first, "NaN", 1), 1).as_bytes());
    place.write("headless.bvh", circle.replace("lFoot", "a").replace("rFoot", "b").as_bytes());
    place.write("takes.csv", b"file,clip,subject,fps\nnone.bvh,,,\n");
    place.write("alone_01.amc", CASES[2].1.as_bytes());
    let rows: Vec<&str> = CASES[3].1.lines().collect();
    let still = |name: &str, dt: f64| {
        (0..60)
            .map(|k| rows[1].replacen("stand,0.0000", &format!("{name},{:.4}", dt * f64::from(k)), 1) + "\n")
            .collect::<String>()
    };
    place.write("still.csv", format!("{}\n{}", rows[0], still("still", 0.02)).as_bytes());
    place.write("rates.csv", format!("{}\n{}{}", rows[0], still("a", 0.02), still("b", 0.05)).as_bytes());
    for (words, parts) in [
        (
            &["circle.bvh", "--unit", "1m"][..],
            &["E0721", "circle.bvh:1:1", "multiply the unit by 0.0100"][..],
        ),
        (&["still.csv"], &["E0721", "still.csv:1:1", "take `still` has no steps"]),
        (&["headless.bvh"], &["E0720", "headless.bvh:1:1", "no layout fits the skeleton"]),
        (&["circle.bvh", "--left", "x,y", "--right", "z,w"], &["E0720", "has no feet"]),
        (&["rates.csv"], &["E0720", "rates.csv:1:1", "table of takes"]),
        (&["cut.bvh"], &["E0720", "cut.bvh:"]),
        (&["nan.bvh"], &["E0720", "nan.bvh:45:1", "`NaN` is not a finite number"]),
        (&["takes.csv"], &["E0720", "takes.csv:2:1", "none.bvh"]),
        (&["alone_01.amc"], &["E0720", "alone_01.amc:1:1", "alone.asf"]),
        (&["circle.bvh", "circle.bvh"], &["E0720", "given twice"]),
        (&["none.bvh"], &["E0701", "none.bvh"]),
        (&["circle.bvh", "--subjects", "circles"], &["E0705", "did you mean `circle`?"]),
        (&["circle.bvh", "-o", "circle.bvh"], &["E0920", "overwrite"]),
        (&["circle.bvh", "--unit", "3 parsec"], &["3 parsec", "positive length"]),
    ] {
        let said = place.call(&[&["gait", "steps"], words].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}\n{}", said.err);
        for part in parts {
            assert!(said.err.contains(part), "{part} of {words:?}\n{}", said.err);
        }
    }
    // Beside takes that have steps, one without them is passed over with a warning.
    let said = place.call(&["gait", "steps", "circle.bvh", "still.csv"]);
    assert!(said.code == Some(0) && said.err.contains("warning[W0720]"), "{}", said.err);
    // Steps in feet read as metres: the longest ones are dropped.
    let said = place.call(&["gait", "steps", "circle.bvh", "--unit", "2.5cm"]);
    assert!(
        said.code == Some(0) && said.err.contains("multiply the unit by 0.3937"),
        "{}{}",
        said.out,
        said.err
    );
    let said = place.call(&["gait", "fit", "circle.bvh", "-o", "a.gait"]);
    assert!(said.code == Some(2) && said.err.contains("error[E0722]: at least 50 pairs"), "{}", said.err);
    assert!(!place.path("a.gait").exists());
    let said = place.call(&["gait", "score", "circle.bvh"]);
    assert!(said.code == Some(2) && said.err.contains("two subjects"), "{}", said.err);
}

#[test]
fn the_gait_that_ships_draws_the_same_bytes_everywhere() {
    let said = at_root(&["gait", "sample", "gaits/cmu.gait", "-n", "60", "--seed", "1"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases/mocap/cmu-sample.csv");
    assert_eq!(said.out, std::fs::read_to_string(sample).unwrap());
    let said = at_root(&["gait", "show", "gaits/cmu.gait"]);
    assert!(said.out.contains("mocap.cs.cmu.edu") && said.out.contains("NSF EIA-0196217"), "{}", said.out);
    assert!(!said.out.to_lowercase().contains("bandai"));
    assert!(at_root(&["completions", "bash"]).out.contains("gait"));
}
