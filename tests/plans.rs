//! Floor plans: what drawings in `GeoJSON`, WKT and DXF become, and what is said of bad ones.

use crate::program::Place;
use smc::Draft;
use smc::base::geometry::{Segment, Vec2};
use smc::model::{Obstacle, Scene};
use std::collections::BTreeSet;
use std::fmt::Write as _;

const FRAME: &str = "horizon = 1 s; step = 0.02 s
kind adult: sfm preset helbing2000
agent me: adult { at = (2, 1.5) }
";

/// A drawing whose pairs are written as words; without a unit if there is none.
fn dxf(unit: &str, entities: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!("9 $INSUNITS 70 {unit} ") };
    let text = format!("0 SECTION 2 HEADER {unit}0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF");
    text.split_whitespace().collect::<Vec<_>>().join("\n") + "\n"
}

/// A collection of features: properties, a type of geometry, coordinates.
fn geojson(features: &[(&str, &str, &str)]) -> String {
    let feature = |(properties, kind, at): &(&str, &str, &str)| {
        format!(
            r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"{kind}","coordinates":{at}}}}}"#
        )
    };
    let features: Vec<String> = features.iter().map(feature).collect();
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(",\n"))
}

/// Rooms, doors and so on of IMDF, which names their types beside the properties.
fn imdf(features: &[(&str, &str, &str)]) -> String {
    let text = geojson(features);
    let marked = text.replace(r#""properties":{"feature_type":"#, r#""feature_type":"#);
    marked.replace(r#"},"geometry""#, r#","properties":{},"geometry""#)
}

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> String {
    format!("[[[{x0},{y0}],[{x1},{y0}],[{x1},{y1}],[{x0},{y1}],[{x0},{y0}]]]")
}

/// The scene of some imports.
fn scene(imports: &str, files: &[(&str, &str)]) -> Scene {
    let mut draft = Draft::new("a.scn", format!("{FRAME}scene {{ {imports} }}\n"));
    for (name, text) in files {
        draft = draft.file(*name, *text);
    }
    draft.parse().unwrap_or_else(|errors| panic!("{errors}")).scenario().scene.clone()
}

fn pieces(scene: &Scene) -> impl Iterator<Item = &Segment> {
    scene.barriers.iter().flat_map(|barrier| match &barrier.obstacle {
        Obstacle::Wall(pieces) => pieces.as_slice(),
        Obstacle::Solid(_) => &[],
    })
}

/// The pieces of walls in centimetres, each from its lower end to its upper one, sorted.
fn centimetres(scene: &Scene) -> Vec<[i64; 4]> {
    let end = |p: Vec2| [p.x, p.y].map(|v| (100.0 * v).round() as i64);
    let piece = |s: &Segment| {
        let (a, b) = (end(s.a), end(s.b));
        let (a, b) = if a < b { (a, b) } else { (b, a) };
        [a[0], a[1], b[0], b[1]]
    };
    let mut found: Vec<_> = pieces(scene).map(piece).collect();
    found.sort_unstable();
    found
}

/// All points of a grid that a disc of this radius reaches from a point, as multiples of 0.1 m.
fn reached(scene: &Scene, from: Vec2, radius: f64, low: Vec2, high: Vec2) -> BTreeSet<(i32, i32)> {
    let cell = |p: Vec2| ((10.0 * p.x).round() as i32, (10.0 * p.y).round() as i32);
    let at = |(x, y): (i32, i32)| Vec2::new(f64::from(x), f64::from(y)) * 0.1;
    let mut taken = BTreeSet::new();
    for piece in pieces(scene) {
        let (from, to) = (piece.a.inf(&piece.b), piece.a.sup(&piece.b));
        let (from, to) = (cell(from - Vec2::repeat(radius)), cell(to + Vec2::repeat(radius)));
        let around = (from.0..=to.0).flat_map(|x| (from.1..=to.1).map(move |y| (x, y)));
        taken.extend(around.filter(|cell| piece.distance(at(*cell)) <= radius));
    }
    let (low, high) = (cell(low), cell(high));
    let (mut found, mut open) = (BTreeSet::new(), vec![cell(from)]);
    while let Some((x, y)) = open.pop() {
        let is_near = (low.0..=high.0).contains(&x) && (low.1..=high.1).contains(&y);
        if is_near && !taken.contains(&(x, y)) && found.insert((x, y)) {
            open.extend([(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]);
        }
    }
    found
}

#[test]
fn nobody_is_enclosed_in_the_building() {
    let text = include_str!("../models/building.geojson");
    let frame = FRAME.replace("(2, 1.5)", "(-1, -1)");
    let model = format!("{frame}scene {{ import \"building.geojson\" where level == \"0\" }}");
    let model = Draft::new("a.scn", model).file("building.geojson", text).parse().unwrap();
    assert!(model.warnings().is_empty());
    let scene = &model.scenario().scene;
    let (low, high) = (Vec2::new(-3.0, -3.0), Vec2::new(63.0, 33.0));
    // From outside, a disc as wide as a person reaches the middle of every room through the doors.
    let found = reached(scene, Vec2::new(-2.0, -2.0), 0.35, low, high);
    let features = smc::data::geometry::read_geojson(text).unwrap();
    let (mut rooms, mut doors) = (0, 0);
    for feature in &features {
        let corners = feature.shape.corners();
        if feature.text("indoor") == Some("room") {
            rooms += 1;
            let middle = 0.5 * (corners[0] + corners[2]);
            let cell = ((10.0 * middle.x).round() as i32, (10.0 * middle.y).round() as i32);
            assert!(found.contains(&cell), "{} is enclosed", feature.name);
        }
        doors += usize::from(feature.property("door").is_some());
    }
    assert_eq!((rooms, doors), (30, 32));
    // A wider disc does not pass the doors: the walls have no other gaps.
    let found = reached(scene, Vec2::new(-2.0, -2.0), 0.62, low, high);
    assert!(!found.contains(&(20, 60 + 90)) && !found.contains(&(40, 30)));
}

#[test]
fn an_outline_of_two_rooms_is_one_wall_and_a_door_opens_both() {
    let plan = geojson(&[
        (r#""indoor":"room""#, "Polygon", &rectangle(0., 0., 4., 3.)),
        (r#""indoor":"room""#, "Polygon", &rectangle(4., 0., 8., 3.)),
        (r#""door":"yes""#, "Point", "[4,1.5]"),
    ]);
    let found = centimetres(&scene("import \"a.geojson\"", &[("a.geojson", &plan)]));
    let outline =
        [[0, 0, 0, 300], [0, 0, 400, 0], [0, 300, 400, 300], [400, 0, 800, 0], [400, 300, 800, 300]];
    let mut wanted: Vec<[i64; 4]> = outline.to_vec();
    wanted.extend([[400, 0, 400, 105], [400, 195, 400, 300], [800, 0, 800, 300]]);
    wanted.sort_unstable();
    assert_eq!(found, wanted);
}

#[test]
fn a_door_opens_both_faces_of_a_wall_and_stays_beside_a_corner() {
    let rooms = |door: (&'static str, &'static str, &'static str)| {
        let plan = geojson(&[
            (r#""indoor":"room""#, "Polygon", &rectangle(0., 0., 4., 3.)),
            (r#""indoor":"room""#, "Polygon", &rectangle(4., 0., 8., 3.)),
            (r#""indoor":"corridor""#, "Polygon", &rectangle(0., 3.2, 8., 5.)),
            door,
        ]);
        let found = centimetres(&scene("import \"a.geojson\"", &[("a.geojson", &plan)]));
        let level = |y: i64| found.iter().filter(|s| s[1] == y && s[3] == y).map(|s| [s[0], s[2]]).collect();
        let levels: [Vec<[i64; 2]>; 2] = [level(300), level(320)];
        levels
    };
    let lower = |parts: &[[i64; 2]]| [parts, &[[400, 800]]].concat();
    let middle = rooms((r#""door":"yes""#, "Point", "[2,3]"));
    assert_eq!(middle, [lower(&[[0, 155], [245, 400]]), vec![[0, 155], [245, 800]]]);
    // It keeps clear of the wall between the rooms.
    let corner = rooms((r#""door":"yes","width":"1.2 m""#, "Point", "[3.8,3]"));
    assert_eq!(corner, [lower(&[[0, 280]]), vec![[0, 280], [400, 800]]]);
    // A line has its own width, and may lie between the faces.
    let line = rooms((r#""indoor":"door","width":9"#, "LineString", "[[1,3.1],[3,3.1]]"));
    assert_eq!(line, [lower(&[[0, 100], [300, 400]]), vec![[0, 100], [300, 800]]]);
    // Two doors at one place are one.
    let plan = geojson(&[
        (r#""indoor":"wall""#, "LineString", "[[0,0],[8,0]]"),
        (r#""door":"yes""#, "Point", "[4,0]"),
        (r#""entrance":"yes""#, "Point", "[4,0.1]"),
    ]);
    let found = centimetres(&scene("import \"a.geojson\"", &[("a.geojson", &plan)]));
    assert_eq!(found, [[0, 0, 355, 0], [445, 0, 800, 0]]);
}

#[test]
fn halls_are_open_to_each_other_and_walls_of_polygons_are_solid() {
    let plan = geojson(&[
        (r#""indoor":"corridor""#, "Polygon", &rectangle(0., 0., 8., 2.)),
        (r#""indoor":"area""#, "Polygon", &rectangle(3., 2., 5., 9.)),
        (r#""indoor":"room""#, "Polygon", &rectangle(5., 2., 8., 9.)),
        (r#""indoor":"wall""#, "Polygon", &rectangle(6., 0.5, 6.5, 1.)),
    ]);
    let scene = scene("import \"a.geojson\"", &[("a.geojson", &plan)]);
    let solid = scene.barriers.iter().filter(|b| matches!(b.obstacle, Obstacle::Solid(_))).count();
    assert_eq!(solid, 1);
    let found = centimetres(&scene);
    assert!(found.iter().all(|s| !(s[1] == 200 && s[3] == 200 && s[0] < 500 && s[2] > 300)), "{found:?}");
    assert!(found.contains(&[0, 200, 300, 200]) && found.contains(&[500, 200, 800, 200]));
}

#[test]
fn doors_of_one_file_open_the_outlines_of_another() {
    // Two units of IMDF in degrees at 48 degrees north: 0.0001 degrees are 11.1 m to the north and 7.5 m to the east.
    let units = imdf(&[
        (r#""feature_type":"unit""#, "Polygon", &rectangle(11.5, 48.0, 11.5001, 48.0001)),
        (r#""feature_type":"unit""#, "Polygon", &rectangle(11.5001, 48.0, 11.5002, 48.0001)),
        (r#""feature_type":"fixture""#, "Polygon", &rectangle(11.50012, 48.00002, 11.50014, 48.00004)),
        (r#""feature_type":"venue""#, "Polygon", &rectangle(11.4, 47.9, 11.6, 48.1)),
    ]);
    assert!(units.contains(r#""feature_type":"unit","properties":{}"#));
    let doors =
        imdf(&[(r#""feature_type":"opening""#, "LineString", "[[11.5001,48.00004],[11.5001,48.00006]]")]);
    let files = [("unit.geojson", units.as_str()), ("opening.geojson", doors.as_str())];
    let imports = "import \"unit.geojson\" where feature_type != \"venue\" { projection = local }; import \"opening.geojson\" { projection = local }";
    let scene = scene(imports, &files);
    assert_eq!(scene.barriers.len(), 3);
    let found = centimetres(&scene);
    let middle: Vec<_> = found.iter().filter(|s| s[0] == 0 && s[2] == 0).collect();
    assert_eq!(middle.len(), 2, "{found:?}");
    let (length, gap) = (middle[1][3] - middle[0][1], middle[1][1] - middle[0][3]);
    assert!((1110..=1114).contains(&length) && (221..=224).contains(&gap), "{middle:?}");
    let widest = found.iter().map(|s| s[2]).max().unwrap();
    assert!((744..=748).contains(&widest), "{widest}");
}

#[test]
fn a_walkable_polygon_has_walls_around_and_polygons_that_overlap_are_one() {
    let one = "POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0), (4 4, 5 4, 5 5, 4 5, 4 4))";
    let found = scene("import \"a.wkt\" as walkable", &[("a.wkt", one)]);
    assert_eq!(pieces(&found).map(Segment::length).sum::<f64>(), 40.0);
    let many = "GEOMETRYCOLLECTION(POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0)), POLYGON((10 2, 14 2, 14 4, 10 4, 10 2)), \
                POLYGON((-2 3, 3 3, 3 5, -2 5, -2 3)), POLYGON((6 6, 7 6, 7 7, 6 6)))";
    let found = scene("import \"a.wkt\" as walkable", &[("a.wkt", many)]);
    // The rim of the union: what lies inside another polygon, or between two, is no wall.
    assert_eq!(pieces(&found).map(Segment::length).sum::<f64>(), 36.0 - 2.0 - 2.0 + 10.0 + 6.0);
    let far = reached(&found, Vec2::new(13.0, 3.0), 0.3, Vec2::new(-9.0, -9.0), Vec2::new(19.0, 19.0));
    assert!(far.contains(&(-15, 40)) && !far.contains(&(-50, 40)));
}

#[test]
fn a_drawing_of_lines_is_joined_and_has_its_unit_and_origin() {
    let entities = "0 LINE 8 A-WALL 10 691600000 20 0 11 691605000 21 0 \
                    0 LINE 8 A-WALL 10 691605000 20 30 11 691605000 21 4000 \
                    0 CIRCLE 8 A-COLS 10 691603000 20 2500 40 200";
    let drawing = dxf("4", entities);
    let import = "import \"a.dxf\" { snap = 5 cm; origin = (691600, 0) }";
    let scene = scene(import, &[("a.dxf", &drawing)]);
    assert_eq!(centimetres(&scene), [[0, 0, 500, 0], [500, 0, 500, 400]]);
    let Obstacle::Solid(column) = &scene.barriers[2].obstacle else { panic!("{scene:?}") };
    assert!((column.area() - 0.04 * std::f64::consts::PI).abs() < 1e-9);
    assert_eq!((scene.barriers[2].name.as_str(), scene.barriers.len()), ("A-COLS", 3));
    // A name of a layer in Latin-1.
    let mut bytes = drawing.replace("A-COLS", "STUETZEN").into_bytes();
    let at = bytes.windows(3).position(|word| word == b"STU").unwrap();
    bytes[at + 2] = 0xDC;
    let place = Place::new(&[]);
    place.write("a.dxf", &bytes);
    let text =
        format!("{FRAME}scene {{ import \"a.dxf\" where layer == \"STÜETZEN\" {{ origin = (691600, 0) }} }}");
    place.write("a.scn", text.as_bytes());
    let shown = place.call(&["show", "a.scn"]);
    assert!(
        shown.out.contains("obstacle STÜETZEN: circle (3, 2.5) radius 0.2 m"),
        "{}{}",
        shown.out,
        shown.err
    );
}

#[test]
fn a_room_is_on_each_of_its_levels() {
    let room = |tags: &str| {
        let corridor = rectangle(0., 0., 10., 5.);
        let plan = geojson(&[
            (r#""indoor":"corridor","level":"0""#, "Polygon", &corridor),
            (tags, "Polygon", &rectangle(4., 1., 6., 4.)),
        ]);
        move |filter: &str| {
            let import = format!("import \"a.geojson\" where {filter}");
            scene(&import, &[("a.geojson", &plan)]).barriers.len() - usize::from(filter.contains("\"0\""))
        }
    };
    for (tags, levels) in [
        (r#""indoor":"room","level":"0;1""#, vec!["0", "1"]),
        (r#""indoor":"room","level":"-1;2-4""#, vec!["-1", "2", "3", "4"]),
        (r#""indoor":"room","level":"-2--1""#, vec!["-2", "-1"]),
        (r#""indoor":"room","level":"-1-1""#, vec!["-1", "0", "1"]),
        (r#""indoor":"room","level":"1","repeat_on":"3-4""#, vec!["1", "3", "4"]),
        (r#""indoor":"room","level":"0.5""#, vec!["0.5"]),
    ] {
        let count = room(tags);
        for level in ["-2", "-1", "0", "0.5", "1", "2", "3", "4"] {
            let found = count(&format!("level == \"{level}\""));
            assert_eq!(found, usize::from(levels.contains(&level)), "{tags} {level}");
            assert_eq!(
                count(&format!("level == \"0\" | level != \"{level}\"")),
                usize::from(!levels.contains(&level) || levels.contains(&"0")),
                "{tags} {level}"
            );
        }
    }
    // In a file with numbers and texts, each matches either.
    let mixed = geojson(&[
        (r#""indoor":"corridor","level":0"#, "Polygon", &rectangle(0., 0., 10., 5.)),
        (r#""indoor":"room","level":"0;1""#, "Polygon", &rectangle(4., 1., 6., 4.)),
    ]);
    for filter in ["level == 0", "level == \"0\""] {
        let import = format!("import \"a.geojson\" where {filter}");
        assert_eq!(scene(&import, &[("a.geojson", &mixed)]).barriers.len(), 2, "{filter}");
    }
}

/// Gaps in the pieces on one line: along `x = at`, or along `y = at`, cm.
fn gaps(found: &[[i64; 4]], axis: usize, at: i64, (from, to): (i64, i64)) -> Vec<(i64, i64)> {
    let mut on: Vec<(i64, i64)> = found
        .iter()
        .filter(|s| s[axis] == at && s[axis + 2] == at)
        .map(|s| (s[1 - axis], s[3 - axis]))
        .collect();
    on.sort_unstable();
    let (mut gaps, mut end) = (Vec::new(), from);
    for (low, high) in on.into_iter().chain([(to, to)]) {
        if low > end {
            gaps.push((end, low));
        }
        end = end.max(high);
    }
    gaps
}

#[test]
fn a_door_where_walls_meet_opens_one_of_them_beside_the_corner() {
    let two = |door: &str, tags: &'static str| {
        let plan = geojson(&[
            (r#""indoor":"room","level":"0""#, "Polygon", &rectangle(0., 0., 5., 4.)),
            (r#""indoor":"room","level":"0""#, "Polygon", &rectangle(5., 0., 10., 4.)),
            (tags, "Point", door),
        ]);
        let found = centimetres(&scene("import \"a.geojson\" where level == \"0\"", &[("a.geojson", &plan)]));
        [gaps(&found, 0, 500, (0, 400)), gaps(&found, 1, 0, (0, 1000)), gaps(&found, 0, 0, (0, 400))]
    };
    let door = r#""door":"yes","level":"0""#;
    // The wall between the rooms ends at the outer one.
    for at in ["[5,0]", "[5,0.005]", "[4.997,0]"] {
        assert_eq!(two(at, door), [vec![(0, 90)], vec![], vec![]], "{at}");
    }
    assert_eq!(two("[5,4]", door), [vec![(310, 400)], vec![], vec![]]);
    // At the outer corner both walls end: the longer one is opened.
    assert_eq!(two("[0,0]", door), [vec![], vec![(0, 90)], vec![]]);
    assert_eq!(two("[5.3,0]", door), [vec![], vec![(500, 590)], vec![]]);
    // A door without a level belongs to the wall that it lies on.
    let without = r#""door":"yes""#;
    assert_eq!(two("[5,2]", without), [vec![(155, 245)], vec![], vec![]]);
    assert_eq!(two("[5,2]", r#""door":"yes","level":null"#), [vec![(155, 245)], vec![], vec![]]);
    assert_eq!(two("[5,2]", r#""door":"yes","level":"1""#), [vec![], vec![], vec![]]);
    assert_eq!(two("[50,2]", without), [vec![], vec![], vec![]]);
    // Where two walls cross, neither ends: the longest one is opened on the side with more room.
    let cross = geojson(&[
        (r#""indoor":"wall""#, "LineString", "[[0,0],[9,0]]"),
        (r#""indoor":"wall""#, "LineString", "[[4,-3],[4,3]]"),
        (door, "Point", "[4,0]"),
    ]);
    let found = centimetres(&scene("import \"a.geojson\"", &[("a.geojson", &cross)]));
    assert_eq!((gaps(&found, 1, 0, (0, 900)), gaps(&found, 0, 400, (-300, 300))), (vec![(400, 490)], vec![]));
}

#[test]
fn walkable_areas_within_the_snap_are_one() {
    for (gap, snap, is_open) in
        [(0.005, "5 cm", true), (0.04, "5 cm", true), (0.06, "5 cm", false), (0.06, "10 cm", true)]
    {
        let right = 5.0 + gap;
        let areas = format!(
            "MULTIPOLYGON(((0 0, 5 0, 5 8, 0 8, 0 0)), (({right} 2, 9 2, 9 6, {right} 6, {right} 2)))"
        );
        let found = scene(&format!("import \"a.wkt\" as walkable {{ snap = {snap} }}"), &[("a.wkt", &areas)]);
        let far = reached(&found, Vec2::new(1.0, 1.0), 0.3, Vec2::new(-1.0, -1.0), Vec2::new(10.0, 9.0));
        assert_eq!(far.contains(&(80, 40)), is_open, "{gap} {snap}");
        assert!(!far.contains(&(80, 10)), "{gap} {snap}");
    }
}

#[test]
fn what_a_drawing_hides_is_no_wall_and_is_counted() {
    let layer = |name: &str, flags: &str, color: &str| format!("0 LAYER 2 {name} 70 {flags} 62 {color}");
    let tables =
        [layer("W", "0", "7"), layer("OFF", "0", "-7"), layer("ICE", "1", "7"), layer("LOCK", "4", "7")];
    let line = |layer: &str, more: &str| format!("0 LINE 8 {layer} {more} 10 0 20 0 11 5 21 0");
    let lines = [
        line("W", ""),
        line("OFF", ""),
        line("ICE", ""),
        line("LOCK", ""),
        line("W", "60 1"),
        line("W", "60 0"),
    ];
    let text = dxf("6", &lines.join(" "));
    let tables = format!("0 SECTION 2 TABLES 0 TABLE 2 LAYER {} 0 ENDTAB 0 ENDSEC", tables.join(" "));
    let head = tables.split(' ').collect::<Vec<_>>().join("\n") + "\n";
    let place = Place::new(&[("plan.dxf", &(head + &text))]);
    let call = |import: &str| {
        place.write("a.scn", format!("{FRAME}scene {{ {import} {{ snap = 1 mm }} }}\n").as_bytes());
        place.call(&["show", "a.scn"])
    };
    let said = call("import \"plan.dxf\"");
    let wanted = "1 LINE hidden on `ICE`, 1 LINE hidden on `OFF`, 1 LINE hidden on `W`";
    assert!(said.err.contains("W0704") && said.err.contains(wanted), "{}", said.err);
    let said = call("import \"plan.dxf\" where layer == \"LOCK\"");
    assert!(said.err.is_empty() && said.out.contains("wall LOCK"), "{}", said.err);
    let said = call("import \"plan.dxf\" where layer == \"OFF\"");
    assert!(said.err.contains("1 LINE hidden on `OFF`") && !said.out.contains("wall"), "{}", said.err);
}

#[test]
fn thousands_of_lines_from_one_point_are_refused_before_the_work() {
    let end = |k: u32| {
        let (sin, cos) = smc::base::math::sin_cos_turn(f64::from(k) / 2100.0);
        (9.0 * cos, 20.0 + 9.0 * sin)
    };
    let lines: String =
        (0..2100).map(|k| format!("LINESTRING (0 20, {} {})\n", end(k).0, end(k).1)).collect();
    let walls: String =
        (0..2100).map(|k| format!("wall (0, 20) -- ({}, {})\n", end(k).0, end(k).1)).collect();
    let place = Place::new(&[("star.wkt", &lines)]);
    for scene in ["import \"star.wkt\"", "import \"star.wkt\" { snap = 1 m }", &walls] {
        place.write("a.scn", format!("{FRAME}scene {{ {scene} }}\n").as_bytes());
        let said = place.call(&["show", "a.scn"]);
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert_eq!(said.err.matches("error[E0923]: too many walls meet").count(), 1, "{}", said.err);
    }
}

/// What is said of each import, with its place and its hint.
#[test]
fn what_is_wrong_with_a_drawing_is_said() {
    let lines = "0 LINE 8 A-WALL 10 0 20 0 11 5000 21 0 0 LINE 8 A-WALL 10 5000 20 30 11 5000 21 4000 \
                 0 INSERT 8 A-DOOR 2 DOOR 10 0 20 0";
    let room = rectangle(0., 0., 8., 6.);
    let with = |feature: (&str, &str, &str)| geojson(&[(r#""indoor":"room""#, "Polygon", &room), feature]);
    let files = [
        ("room.wkt", "POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0))".to_owned()),
        ("map.wkt", "LINESTRING (691600 5334762, 691660.25 5334762, 691660 5334790)".to_owned()),
        ("degrees.wkt", "LINESTRING (11.5675 48.1490, 11.5680 48.1492)".to_owned()),
        ("plan.dxf", dxf("4", lines)),
        ("unitless.dxf", dxf("0", lines)),
        ("tiny.dxf", dxf("4", "0 LINE 8 A 10 0 20 0 11 60 21 0 0 LINE 8 A 10 0 20 0 11 0 21 30")),
        ("broken.dxf", dxf("4", "0 LINE 8 A 10 0 20 0 0 CIRCLE 8 A 10 0 20 zero 40 1")),
        ("arc.dxf", dxf("6", "0 ARC 8 A 10 0 20 0 40 5 50 0 51 1e300")),
        ("gap.wkt", "LINESTRING (0 0, 4 0) LINESTRING (4.8 0, 9 0)".to_owned()),
        ("swapped.wkt", "LINESTRING (48.1490 11.5675, 48.1492 11.5680)".to_owned()),
        ("east.wkt", "LINESTRING (35.6800 139.7600, 35.6804 139.7600)".to_owned()),
        ("plan.dwg", "AC1032\0".to_owned()),
        ("plan.ifc", "ISO-10303-21;".to_owned()),
        ("number.geojson", geojson(&[(r#""indoor":"room","level":0"#, "Polygon", &room)])),
        ("text.geojson", geojson(&[(r#""indoor":"room","level":"0;1""#, "Polygon", &room)])),
        ("binary.dxf", "AutoCAD Binary DXF\r\n\u{1a}\0".to_owned()),
        ("bow.geojson", with((r#""indoor":"room""#, "Polygon", "[[[0,0],[2,2],[2,0],[0,2],[0,0]]]"))),
        ("far.geojson", with((r#""door":"yes","name":"side door""#, "Point", "[20,3]"))),
        ("wide.geojson", with((r#""door":"yes","width":6.5"#, "Point", "[0,3]"))),
        ("width.geojson", with((r#""door":"yes","width":"wide""#, "Point", "[0,3]"))),
        ("area.geojson", with((r#""indoor":"door""#, "Polygon", &rectangle(1., 0., 2., 1.)))),
        (
            "mm.geojson",
            geojson(&[
                (r#""indoor":"room""#, "Polygon", &rectangle(0., 0., 8000., 6000.)),
                (r#""door":"yes","width":1200"#, "Point", "[4000,0]"),
            ]),
        ),
    ];
    let place = Place::new(&[]);
    for (name, text) in &files {
        place.write(name, text.as_bytes());
    }
    let mut shown = String::new();
    for import in [
        r#"import "room.wkt""#,
        r#"import "room.wkt" as walkable { unit = 5 km }"#,
        r#"import "room.wkt" as walkable { unit = 1 mm }"#,
        r#"import "room.wkt" as walkable { unit = 5 s }"#,
        r#"import "room.wkt" as walkable { unit = 0 m }"#,
        r#"import "room.wkt" as walkable { origin = 5 m }"#,
        r#"import "room.wkt" as walkable { origin = (5, 2) s }"#,
        r#"import "room.wkt" as walkable { orign = (5, 2) }"#,
        r#"import "room.wkt" as walkable { projection = mercator }"#,
        r#"import "room.wkt" as walkable { projection = local; unit = 1 m }"#,
        r#"import "room.wkt" as walkable { projection = local }"#,
        r#"import "room.wkt" as walkabel"#,
        r#"import "map.wkt" { snap = 5 cm }"#,
        r#"import "map.wkt" { projection = local }"#,
        r#"import "degrees.wkt""#,
        r#"import "nowhere.dxf""#,
        r#"import "plan.dxf""#,
        r#"import "plan.dxf" where layer == "A-WAL""#,
        r#"import "plan.dxf" where layer == "A-WALL" { projection = local }"#,
        r#"import "unitless.dxf" where layer == "A-WALL" { snap = 1 cm }"#,
        r#"import "tiny.dxf""#,
        r#"import "broken.dxf""#,
        r#"import "binary.dxf""#,
        r#"import "bow.geojson""#,
        r#"import "far.geojson""#,
        r#"import "wide.geojson""#,
        r#"import "width.geojson""#,
        r#"import "area.geojson""#,
        r#"import "mm.geojson""#,
        r#"import "arc.dxf""#,
        r#"import "gap.wkt" { snap = 1 m }"#,
        r#"import "gap.wkt" { snap = 40 cm }"#,
        r#"import "swapped.wkt" { projection = local; origin = (11.5678, 48.1491) }"#,
        r#"import "swapped.wkt" { projection = local; origin = (11.6, 48.2) }"#,
        r#"import "east.wkt" { projection = local }"#,
        r#"import "plan.dwg""#,
        r#"import "plan.ifc""#,
        r#"import "number.geojson" where level == "0""#,
        r#"import "number.geojson" where level == "-1" | indoor == "door""#,
        r#"import "text.geojson" where level == 0"#,
        r#"import "text.geojson" where level == "2""#,
    ] {
        place.write("a.scn", format!("{FRAME}scene {{ {import} }}\n").as_bytes());
        let said = place.call(&["show", "a.scn"]);
        assert_eq!(said.code == Some(2), said.err.contains("error["), "{import}: {}", said.err);
        let _ = write!(shown, "==== {import}\n{}\n", said.err.trim_end());
    }
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("plans", shown);
    });
}

#[test]
fn a_filter_and_a_unit_that_fit_say_nothing() {
    let plan = dxf("0", "0 LINE 8 A-WALL 10 0 20 0 11 5000 21 0 0 TEXT 8 A-TEXT 10 0 20 0 1 hall");
    let place = Place::new(&[("plan.dxf", &plan)]);
    let text = format!(
        "{FRAME}scene {{ import \"plan.dxf\" where layer == \"A-WALL\" {{ unit = 1 mm; snap = 5 cm }} }}\n"
    );
    place.write("a.scn", text.as_bytes());
    let said = place.call(&["show", "a.scn"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    assert!(said.out.contains("wall A-WALL: 1 segment, 5 m"), "{}", said.out);
}

#[test]
fn a_drawing_that_encloses_a_start_is_named() {
    let cell = dxf("6", "0 LWPOLYLINE 8 A 70 1 10 0 20 0 10 4 20 0 10 4 20 3 10 0 20 3");
    let text = "horizon = 9 s; step = 0.02 s
kind adult: sfm preset helbing2000
agent me: adult { at = (2, 1.5); route = (9, 1.5) }
scene { import \"cell.dxf\" }
";
    let model = Draft::new("a.scn", text).file("cell.dxf", cell).parse().unwrap_or_else(|e| panic!("{e}"));
    let errors = model.check("check P(F<=5 s (speed(me) > 1 m/s)) >= 0.9", &smc::Options::default());
    let said = errors.unwrap_err().to_string();
    assert!(said.contains("E0803") && said.contains("an outline of this file is in between"), "{said}");
}
