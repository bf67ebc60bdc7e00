//! The readers of recordings and geometry, on the real files and on noise.
//!
//! The recordings may not be shipped. They are looked for in the folder that `SMC_DATA` names, else beside
//! the checkout; where they are absent the tests say so and pass.

use proptest::prelude::*;
use smc::base::geometry::Vec2;
use smc::data::geometry::{
    Geometry, Placement, PropertyValue, open_doors, plan, read_dxf, read_geojson, read_wkt,
};
use smc::data::table::{Column, FORMATS, Kind, Table, TraceFormat, Value, write};
use smc::data::tracks::{Format, Reading, Recording, Velocity, read_batch, read_eth_biwi, read_groups};
use std::io::Write as _;
use std::path::PathBuf;

/// The text of a file of the ETH/BIWI set.
fn text(path: &str) -> Option<String> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data/eth-biwi");
    let folders = std::env::var_os("SMC_DATA").map(PathBuf::from).into_iter().chain([beside]);
    for folder in folders {
        for folder in [folder.clone(), folder.join("eth-biwi")] {
            if let Ok(text) = std::fs::read_to_string(folder.join(path)) {
                return Some(text);
            }
        }
    }
    // Written past the harness, which would hide what a passing test prints.
    let said = format!("SKIPPED: {path} is not here; set SMC_DATA to the folder of the recordings\n");
    let _ = std::io::stderr().write_all(said.as_bytes());
    None
}

fn recording(path: &str) -> Option<Recording> {
    text(path).map(|text| read_eth_biwi(&text).expect("the recording is well formed"))
}

fn rows(recording: &Recording) -> usize {
    recording.people().iter().map(|person| person.samples.len()).sum()
}

#[test]
fn the_hotel_is_as_described() {
    let Some(hotel) = recording("seq_hotel/obsmat.txt") else { return };
    assert_eq!((rows(&hotel), hotel.people().len()), (6544, 390));
    assert!((hotel.frames_per_second() - 25.0).abs() < 1e-9);
    assert_eq!((hotel.frames().first(), hotel.frames().last()), (Some(&1), Some(&18061)));
    assert!((hotel.duration() - 722.4).abs() < 1e-9);
    let present = hotel.at(646.8);
    assert_eq!(present.len(), 18);
    assert!([367, 368].iter().all(|id| present.iter().any(|o| o.id == *id)));
    let stretches = hotel.stretches();
    assert_eq!(stretches.len(), 27);
    assert!((stretches[0].1 - 14.0).abs() < 1e-9 && (stretches[1].0 - 16.4).abs() < 1e-9);
    let still = hotel.people().iter().filter(|person| {
        let start = person.samples[0].position;
        person.samples.iter().all(|sample| (sample.position - start).norm() <= 0.3)
    });
    assert_eq!(still.count(), 67, "people who never leave their start by more than 0.3 m");
}

#[test]
fn the_eth_sequence_is_as_described() {
    let Some(eth) = recording("seq_eth/obsmat.txt") else { return };
    assert_eq!((rows(&eth), eth.people().len()), (8908, 360));
    assert!((eth.frames_per_second() - 15.0).abs() < 1e-9);
    assert!((eth.duration() - f64::from(12381 - 780) / 15.0).abs() < 1e-9);
    assert_eq!(eth.stretches().len(), 16);
}

#[test]
fn velocities_are_central_differences() {
    let Some(hotel) = recording("seq_hotel/obsmat.txt") else { return };
    let mut worst: f64 = 0.0;
    for person in hotel.people() {
        for three in person.samples.windows(3) {
            let v: Vec2 = (three[2].position - three[0].position) / (2.0 * hotel.step());
            worst = worst.max((v - three[1].velocity.unwrap()).norm());
        }
    }
    assert!(worst < 1e-5, "positions and velocities disagree by {worst} m/s: wrong columns or rate");
}

#[test]
fn groups_are_sets_and_merged() {
    let (Some(hotel), Some(eth)) = (text("seq_hotel/groups.txt"), text("seq_eth/groups.txt")) else { return };
    let hotel = read_groups(&hotel).unwrap();
    assert_eq!(hotel.len(), 41);
    assert_eq!(hotel.iter().filter(|group| group.len() == 2).count(), 38);
    assert!(hotel.contains(&vec![367, 368]));
    let eth = read_groups(&eth).unwrap();
    assert!(eth.contains(&vec![237, 238, 239, 240, 241, 242]));
    assert!(eth.contains(&vec![319, 320, 321, 322, 323, 324]));
    let mut all: Vec<u32> = eth.concat();
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), count, "nobody is in two groups");
}

#[test]
fn obstacles_keep_their_properties() {
    let Some(hotel) = text("hotel-obstacles.geojson") else { return };
    let hotel = read_geojson(&hotel).unwrap();
    assert_eq!(hotel.len(), 8);
    let real: Vec<&str> = hotel
        .iter()
        .filter(|f| f.property("source") == Some(&PropertyValue::Text("map.png".into())))
        .map(|f| f.name.as_str())
        .collect();
    assert_eq!(real, ["tree-right", "bench", "lamp-post", "tree-left"]);
    let bench = hotel.iter().find(|f| f.name == "bench").unwrap();
    assert!(matches!(&bench.shape, Geometry::Polygon(p) if (p.area() - 1.932).abs() < 1e-3));
    assert!(matches!(&hotel[6].shape, Geometry::Line(points) if points.len() == 2));
    let Some(eth) = text("eth-obstacles.geojson") else { return };
    assert_eq!(read_geojson(&eth).unwrap().len(), 8);
}

/// Lines that look like those of a table, with all kinds of fields.
fn table() -> impl Strategy<Value = String> {
    let field = prop_oneof![
        4 => (-5_i32..30).prop_map(|n| n.to_string()),
        2 => any::<f64>().prop_map(|x| x.to_string()),
        1 => Just("1e9".to_owned()),
        1 => "\\PC{0,4}",
    ];
    let line = prop::collection::vec(field, 0..10).prop_map(|fields| fields.join(" "));
    prop::collection::vec(line, 0..20).prop_map(|lines| lines.join("\n"))
}

/// Names as agents of other programs may have them, with all that ends a cell or a line.
fn name() -> impl Strategy<Value = String> {
    let special = prop::sample::select(vec![
        "cm",
        "x,y",
        "\"",
        "a\"b",
        "{\"seen\":",
        "track",
        "#",
        "n\nm",
        "PAR1",
        "nan",
        "é",
        ",",
    ]);
    prop_oneof![special.prop_map(str::to_owned), "[a-zé]{1,3}\\[[1-9]\\]"]
}

/// What a format writes of two trials of agents, one after the other.
fn written(format: &TraceFormat, agents: &[(String, f64, f64)], trials: &[i64]) -> Vec<u8> {
    let number = |name: &str| Column::new(name, Kind::Number(""));
    let [time, x, y, vx, vy] = ["time", "x", "y", "vx", "vy"].map(number);
    let (trial, agent) = (Column::new("trial", Kind::Whole), Column::new("agent", Kind::Word));
    let present = Column::new("present", Kind::Truth);
    let columns = vec![time, trial, agent, x, y, vx, vy, present];
    let table = Table { columns, interval: 0.5, scenario: "in cm".to_owned(), ..Table::default() };
    let mut rows = Vec::new();
    for trial in trials {
        for step in 0..3 {
            for (name, x, y) in agents {
                let (x, y) = (x / f64::from(step + 1), y * (1.0 - *trial as f64 / 7.0));
                let head =
                    [Value::Number(f64::from(step) * 0.5), Value::Whole(*trial), Value::Word(name.into())];
                let here = [x, y, y, x].map(Value::Number).to_vec();
                rows.push([head.to_vec(), here, vec![Value::Truth(true)]].concat());
            }
            let head =
                [Value::Number(f64::from(step) * 0.5), Value::Whole(*trial), Value::Word("gone".into())];
            rows.push([head.to_vec(), vec![Value::Missing; 4], vec![Value::Truth(false)]].concat());
        }
    }
    let mut out = Vec::new();
    write(format, &mut out, &table, rows).unwrap();
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn traces_are_read_again_with_all_their_bits(
        agents in prop::collection::btree_map(name(), (-1e6..1e6_f64, -1e3..1e3_f64), 1..6), order in any::<bool>()
    ) {
        let mut agents: Vec<(String, f64, f64)> = agents.into_iter().map(|(name, (x, y))| (name, x, y)).collect();
        if order {
            agents.reverse();
        }
        for format in FORMATS.iter().filter(|format| format.open.is_some()) {
            let Some(reader) = Format::from_name(format.name) else { continue };
            let trials: &[i64] = if format.is_of_one_trial { &[2] } else { &[0, 2] };
            let bytes = written(format, &agents, trials);
            prop_assert_eq!(Format::of(&bytes).map(|found| found.name), Some(format.name));
            let trial = (!format.is_of_one_trial).then_some(2);
            let recording = reader.read(&bytes, &Reading { trial, ..Reading::default() }).unwrap();
            prop_assert_eq!(recording.ids().collect::<Vec<_>>(), (1..=agents.len() as u32).collect::<Vec<_>>());
            for (person, (_, x, y)) in recording.people().iter().zip(&agents) {
                prop_assert_eq!(person.samples.len(), 3, "{}", format.name);
                for (step, sample) in (0_u32..).zip(&person.samples) {
                    let position = [x / f64::from(step + 1), y * (1.0 - 2.0 / 7.0)];
                    let found = [sample.position.x, sample.position.y];
                    prop_assert_eq!(found.map(f64::to_bits), position.map(f64::to_bits), "{}", format.name);
                    if !format.is_of_one_trial {
                        prop_assert_eq!(sample.velocity, Some(Vec2::new(position[1], position[0])));
                    }
                }
            }
        }
    }

    #[test]
    fn damaged_traces_are_survived(
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        end in any::<prop::sample::Index>(), cut in any::<bool>()
    ) {
        let agents = [("a".to_owned(), 1.0, 2.0), ("b".to_owned(), 3.0, 4.0)];
        for format in FORMATS.iter().filter(|format| format.open.is_some()) {
            let Some(reader) = Format::from_name(format.name) else { continue };
            let mut bytes = written(format, &agents, &[2]);
            for (place, byte) in &places {
                let at = place.index(bytes.len());
                bytes[at] = *byte;
            }
            if cut {
                bytes.truncate(end.index(bytes.len()));
            }
            if let Err(errors) = reader.read(&bytes, &Reading::default()) {
                prop_assert!(!errors.is_empty());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn readers_survive_any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let text = String::from_utf8_lossy(&bytes);
        let _ = (read_eth_biwi(&text), read_groups(&text), read_geojson(&text), read_wkt(&text));
        let _ = (read_dxf(&text, None, &mut |_, _| true), read_batch(&text));
        for format in Format::all() {
            let _ = format.read_batches(text.as_bytes(), &Reading::default(), Velocity::Seen);
        }
    }

    #[test]
    fn a_table_is_read_or_every_bad_line_is_named(text in table(), time in any::<f64>()) {
        let lines = text.lines().count().max(1);
        match read_eth_biwi(&text) {
            Ok(recording) => {
                let filled = text.lines().filter(|line| !line.trim().is_empty()).count();
                prop_assert_eq!(rows(&recording), filled);
                prop_assert!(recording.at(time).len() <= recording.people().len());
                prop_assert!(recording.nearest_time(time).is_some());
            }
            Err(errors) => {
                prop_assert!(!errors.is_empty());
                // What is wrong with the whole is told alone.
                let of_file = matches!(errors.as_slice(), [one] if one.line == 0);
                prop_assert!(of_file || errors.iter().all(|e| (1..=lines).contains(&e.line)));
            }
        }
        if let Err(errors) = read_groups(&text) {
            prop_assert!(errors.iter().all(|e| (1..=lines).contains(&e.line)));
        }
    }

    #[test]
    fn shuffled_tracks_are_survived(
        parts in prop::collection::vec(
            prop::sample::select(vec!["time,id,x,y\n", "frame,id,x,y,vx,vy\n", "# framerate: 8\n", "{\"track\":", "}\n",
                "{\"f\":1,\"p\":2,\"x\":3,\"y\":4}", "{\"scene\":{\"fps\":2}", "{\"t\":1,\"seen\":[", "{\"x\":1,\"y\":2,\"id\":1}",
                "]}\n", ",", "1", "0.5", "-2", " ", "\n", "1e300", "nan", "é"]), 0..30),
        table in table(),
        rate in prop::option::of(any::<f64>()),
    ) {
        for text in [parts.concat(), format!("time,id,x,y\n{}", table.replace(' ', ",")), format!("# framerate: 2\n{table}")] {
            let lines = text.lines().count();
            for format in Format::all() {
                if let Err(errors) = format.read(&text, &Reading { frames_per_second: rate, ..Reading::default() }) {
                    prop_assert!(!errors.is_empty());
                    prop_assert!(errors.iter().all(|e| e.line <= lines));
                }
            }
        }
    }

    #[test]
    fn shuffled_well_known_text_is_survived(
        parts in prop::collection::vec(
            prop::sample::select(vec!["POINT", "POLYGON", "MULTIPOINT", "GEOMETRYCOLLECTION", "EMPTY", "Z", "(",
                "(", ")", ")", ",", "0 0", "1 0", "0 1", "-2.5e3 7", "nan 1", ";", "\n"]), 0..40)
    ) {
        let text = parts.join(" ");
        if let Err(errors) = read_wkt(&text) {
            prop_assert!(!errors.is_empty());
            prop_assert!(errors.iter().all(|e| e.place.line.is_some_and(|line| line <= text.lines().count())));
        }
    }

    #[test]
    fn shuffled_drawings_are_survived(
        parts in prop::collection::vec(
            prop::sample::select(vec!["0 LINE", "0 LWPOLYLINE", "0 POLYLINE", "0 VERTEX", "0 SEQEND", "0 ARC",
                "0 CIRCLE", "0 INSERT", "0 ENDSEC", "0 SECTION", "2 ENTITIES", "8 A", "10 0", "20 0", "11 3e11",
                "21 -5", "40 2", "40 1e300", "42 1", "42 -1e-9", "50 90", "51 1e9", "70 1", "230 -1", "67 1", "x"]),
            0..40),
        unit in prop::option::of(1e-3..10.0),
    ) {
        let text = format!("0 SECTION 2 ENTITIES {}", parts.join(" ")).replace(' ', "\n");
        match read_dxf(&text, unit, &mut |_, _| true) {
            Ok(drawing) => planned(drawing.features),
            Err(errors) => {
                prop_assert!(!errors.is_empty());
                prop_assert!(errors.iter().all(|e| e.place.line.is_some_and(|line| line <= text.lines().count())));
            }
        }
    }

    #[test]
    fn shuffled_rooms_and_doors_are_survived(
        parts in prop::collection::vec(
            (prop::sample::select(vec!["room", "corridor", "area", "wall", "door", "level"]),
             prop::collection::vec((0_i8..6, 0_i8..6), 1..6)), 0..12)
    ) {
        let feature = |(kind, corners): &(&str, Vec<(i8, i8)>)| {
            let points: Vec<String> = corners.iter().map(|(x, y)| format!("[{x},{y}]")).collect();
            let (form, at) = match (*kind, points.len()) {
                (_, 1) => ("Point", points[0].clone()),
                ("door", _) | (_, 2) => ("LineString", format!("[{}]", points.join(","))),
                _ => ("Polygon", format!("[[{},{}]]", points.join(","), points[0])),
            };
            format!("{{\"type\":\"Feature\",\"properties\":{{\"indoor\":\"{kind}\",\"width\":2}},\
                     \"geometry\":{{\"type\":\"{form}\",\"coordinates\":{at}}}}}")
        };
        for part in &parts {
            // Each alone, so that one bad outline does not hide the others.
            if let Ok(features) = read_geojson(&feature(part)) {
                planned(features);
            }
        }
        let good: Vec<_> =
            parts.iter().filter_map(|part| read_geojson(&feature(part)).ok()).flatten().collect();
        planned(good);
    }
}

/// Walls and doors of features: nothing that is no number, and no wall becomes longer by a door.
fn planned(mut features: Vec<smc::data::geometry::Feature>) {
    let placement = Placement::Plane { unit: 1.0, origin: Vec2::zeros(), is_stated: true };
    let _ = placement.place(&mut features);
    let Ok(plan) = plan(&features, (1.0, 1e-3), false) else { return };
    let mut walls: Vec<Vec<smc::base::geometry::Segment>> = plan
        .barriers
        .into_iter()
        .filter_map(|(_, form)| match form {
            smc::data::geometry::Form::Wall(pieces) => Some(pieces),
            smc::data::geometry::Form::Solid(_) => None,
        })
        .collect();
    let length = |walls: &[Vec<smc::base::geometry::Segment>]| {
        walls.iter().flatten().map(smc::base::geometry::Segment::length).sum::<f64>()
    };
    let before = length(&walls);
    let opened = open_doors(&mut walls.iter_mut().collect::<Vec<_>>(), &plan.doors);
    let after = length(&walls);
    assert_eq!(opened.len(), plan.doors.len());
    assert!(after.is_finite() && after <= before * (1.0 + 1e-9), "{before} {after}");
}
