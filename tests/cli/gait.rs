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
    assert!(svg.starts_with("<svg") && svg.contains("left (") && svg.contains(">x (m)</text>"), "{svg}");
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
        (&["circle.bvh", "--unit", "1m"][..], &["E0721", "circle.bvh:1:1", "help: write `--unit 1cm`"][..]),
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
        said.code == Some(0) && said.err.contains("help: write `--unit 1cm`"),
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

/// Half a minute of straight legs of 90 cm with steps of 60 cm, as BVH in units of so many centimetres.
fn walker(unit: f64, is_z_up: bool, has_six_channels: bool, is_in_radians: bool) -> String {
    let turned = |[x, y, z]: [f64; 3]| if is_z_up { [x, -z, y] } else { [x, y, z] }.map(|cell| cell / unit);
    let written = |place: [f64; 3]| turned(place).map(|cell| format!("{cell:.6}")).join(" ");
    let legs = ["Left", "Right"].map(|side| {
        let x = if side == "Left" { 9.0 } else { -9.0 };
        [("UpLeg", [x, 0.0, 0.0]), ("Foot", [0.0, -90.0, 0.0]), ("ToeBase", [0.0, -4.0, 15.0])]
            .map(|(joint, offset)| (format!("{side}{joint}"), offset))
    });
    let channels = "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    let of_joints = if has_six_channels { channels } else { "3 Zrotation Xrotation Yrotation" };
    let mut text = format!("HIERARCHY\nROOT Hips {{ OFFSET 0 0 0 CHANNELS {channels}\n");
    for leg in &legs {
        for (name, offset) in leg {
            let _ = writeln!(text, "JOINT {name} {{ OFFSET {} CHANNELS {of_joints}", written(*offset));
        }
        text += "End Site { OFFSET 0 0 0 } } } }\n";
    }
    let frames = 300;
    let _ = writeln!(text, "}}\nMOTION\nFrames: {frames}\nFrame Time: 0.02");
    for frame in 0..frames {
        let (step, share) = (frame / 25, f64::from(frame % 25) / 25.0);
        let stance = 30.0 - 60.0 * share;
        let height = (90.0_f64 * 90.0 - stance * stance).sqrt() + 4.0;
        let mut cells = vec![written([0.0, height, 2.4 * f64::from(frame)]), "0 0 0".to_owned()];
        for (k, leg) in legs.iter().enumerate() {
            let ahead = if step % 2 == k as i32 { stance } else { -stance };
            let angle =
                -(ahead / 90.0_f64).asin() * if is_in_radians { 1.0 } else { 180.0 / std::f64::consts::PI };
            for ((_, offset), angle) in leg.iter().zip([angle, -angle, 0.0]) {
                if has_six_channels {
                    cells.push(written(*offset));
                }
                cells.push(format!("0 {angle:.8} 0"));
            }
        }
        text += &(cells.join(" ") + "\n");
    }
    text
}

#[test]
fn the_hint_about_a_take_of_no_person_gives_the_right_steps() {
    let place = Place::new(&[("walk.bvh", &walker(1.0, false, false, false))]);
    let steps =
        |options: &[&str]| place.call(&[&["gait", "steps", "walk.bvh", "--format", "csv"], options].concat());
    let right = steps(&[]);
    assert!(
        right.code == Some(0) && right.err.is_empty() && right.out.contains(",0.6"),
        "{}{}",
        right.out,
        right.err
    );
    let lengths = |table: &str| -> Vec<f64> {
        table.lines().skip(1).map(|line| line.split(',').nth(7).unwrap().parse().unwrap()).collect()
    };
    for (text, wanted) in [
        (walker(0.1, false, false, false), "--unit 1mm"),
        (walker(2.54, false, false, false), "--unit 1in"),
        (walker(5.64, false, false, false), "--unit 0.0564m"),
        (walker(30.48, false, false, false), "--unit 1ft"),
        (walker(100.0, false, false, false), "--unit 1m"),
        (walker(1.0, true, false, false), "--up z"),
        (walker(1.0, false, true, false), "--replace-offsets"),
        (walker(1.0, false, false, true), "--radians"),
        (walker(2.54, true, false, false), "--up z --unit 1in"),
        (walker(0.1, false, true, false), "--unit 1mm --replace-offsets"),
    ] {
        place.write("walk.bvh", text.as_bytes());
        let said = steps(&[]);
        assert!(
            said.err.contains("W0720") || said.err.contains("E0721"),
            "{wanted}\n{}{}",
            said.out,
            said.err
        );
        let hint = said.err.split("help: write `").nth(1).and_then(|rest| rest.split('`').next());
        assert_eq!(hint, Some(wanted), "{}", said.err);
        let followed = steps(&wanted.split(' ').collect::<Vec<_>>());
        assert_eq!((followed.code, followed.err.as_str()), (Some(0), ""), "{wanted}");
        let pairs = lengths(&followed.out).into_iter().zip(lengths(&right.out));
        assert_eq!(pairs.clone().count(), lengths(&right.out).len());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 2e-3), "{wanted}\n{}", followed.out);
    }
}

#[test]
fn a_skeleton_states_its_unit_and_is_checked_first() {
    let asf = CASES[1].1;
    let place = Place::new(&CASES);
    let mean =
        |said: &str| said.lines().last().unwrap().split_whitespace().nth(2).unwrap().parse::<f64>().unwrap();
    let usual = place.call(&["gait", "steps", "walker_01.amc", "--fps", "30"]);
    assert_eq!((usual.code, usual.err.as_str()), (Some(0), ""), "{}", usual.err);
    let write = |length: &str, axis: &str| {
        let text = asf.replacen("length 0.45", &format!("length {length}"), 1);
        place.write("walker.asf", text.replacen("axis XYZ", &format!("axis {axis}"), 1).as_bytes());
        place.call(&["gait", "steps", "walker_01.amc", "--fps", "30"])
    };
    let same = write("0.45", "XYZ");
    assert_eq!((same.out, same.err), (usual.out.clone(), String::new()));
    let other = write("0.9", "ZYX");
    assert!((mean(&other.out) / mean(&usual.out) - 0.5).abs() < 0.01, "{}{}", other.out, other.err);
    assert!(other.err.contains("help: write `--unit 0.0564m`"), "{}", other.err);
    for (length, axis, said) in [
        ("0", "XYZ", "the unit of length must be positive"),
        ("0.45", "XXQ", "`axis` needs an order of the three axes"),
        ("0.45", "XYX", "`axis` needs an order of the three axes"),
    ] {
        let found = write(length, axis);
        assert!(found.code == Some(2) && found.err.contains(said), "{}", found.err);
    }
    let many: String =
        (0..50_000).fold(":bonedata\n".to_owned(), |text, k| text + &format!("begin\nname b{k}\nend\n"));
    place.write("walker.asf", many.as_bytes());
    let found = place.call(&["gait", "steps", "walker_01.amc", "--fps", "30"]);
    assert!(found.code == Some(2) && found.err.contains("at most 1000 bones"), "{}", found.err);
    place.write("alone.amc", b"1\nroot 0 0 0 0 0 0\n");
    let found = place.call(&["gait", "steps", "alone.amc"]);
    assert_eq!(found.err.matches("alone.asf").count(), 1, "{}", found.err);
}

#[test]
fn one_missing_rate_is_one_error() {
    let place = Place::new(&[("walks.csv", &walks(60, 8))]);
    let found = place.call(&["gait", "steps", "walks.csv"]);
    assert_eq!((found.code, found.err.matches("E0720").count()), (Some(2), 1), "{}", found.err);
    assert!(
        found.err.contains("the file has no frame rate") && found.err.contains("help: write `--fps 30`"),
        "{}",
        found.err
    );
    assert!(found.err.contains("  | ^^^^\n"), "{}", found.err);
    assert_eq!(place.call(&["gait", "steps", "walks.csv", "--fps", "60"]).code, Some(0));
}
