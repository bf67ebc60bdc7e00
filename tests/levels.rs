//! Imports by level: one file becomes several levels, which its stairs join.

use smc::base::geometry::Vec2;
use smc::data::geometry::{Placement, open_doors, plan, read_osm};
use smc::{Draft, Model, Options};
use std::fmt::Write;

const MALL: &str = include_str!("../examples/mall/mall.osm");
const SCENARIO: &str = include_str!("../examples/mall/mall.scn");
const BY_LEVEL: &str =
    r#"import "mall.osm" as plan by level { ground = "0"; first = "1"; second = "2"; storey = 4 m }"#;

fn parsed(text: &str, files: &[(&str, &str)]) -> Result<Model, String> {
    let draft = files
        .iter()
        .fold(Draft::new("a.scn", text), |draft, (name, text)| draft.file(*name, text.as_bytes().to_vec()));
    draft.parse().map_err(|errors| errors.to_string())
}

/// A scene with people.
fn scenario(scene: &str, people: &str) -> String {
    format!("horizon = 90 s\nstep = 0.05 s\nscene {{ {scene} }}\nkind person: sfm preset smc2\n{people}")
}

/// A model of a scene with people; the file is the mall.
fn mall(scene: &str, people: &str) -> Result<Model, String> {
    parsed(&scenario(scene, people), &[("mall.osm", MALL)])
}

/// Where everybody is at some states of a trial.
fn walks(model: &Model, names: &[String]) -> Vec<Option<Vec2>> {
    let states = model.trial(0, 0).unwrap().step_by(20);
    let at = |state: &smc::Snapshot, name: &String| {
        state.agent(name).map(|agent| Vec2::new(agent.position.x, agent.position.y))
    };
    states.flat_map(|state| names.iter().map(|name| at(&state, name)).collect::<Vec<_>>()).collect()
}

fn members(count: usize) -> Vec<String> {
    ["low", "high"].iter().flat_map(|set| (1..=count).map(move |k| format!("{set}[{k}]"))).collect()
}

/// The levels of the mall, each with an import of its own.
fn by_hand(lines: [&str; 3]) -> String {
    let mut text = String::new();
    for (k, name) in ["ground", "first", "second"].iter().enumerate() {
        let _ = writeln!(
            text,
            "level {name} {{ height = {} m; import \"mall.osm\" where level == \"{k}\" as plan {{ projection = local }}\n{} }}",
            4 * k,
            lines[k]
        );
    }
    text
}

#[test]
fn an_import_by_level_is_the_levels_written_by_hand() {
    let people = "agents low[5]: person { at = uniform in ground.plan.Books; route = ground.plan.Square }
        agents high[5]: person { at = uniform in second.plan.Pizza; route = second.plan.Coffee }";
    let flat = MALL.replace("v='steps'", "v='footway'");
    let [one, other] = [BY_LEVEL, &by_hand([""; 3])]
        .map(|scene| parsed(&scenario(scene, people), &[("mall.osm", &flat)]).unwrap());
    assert!(walks(&one, &members(5)) == walks(&other, &members(5)));
}

#[test]
fn flights_of_a_file_are_stairs_written_by_hand() {
    let people = "agents low[1]: person { at = uniform in ground.plan.Bakery; route = second.plan.Cinema }
        agents high[1]: person { at = uniform in second.plan.Pizza; route = ground.plan.Shoes }";
    let one = mall(BY_LEVEL, people).unwrap();
    let storeys = &one.scenario().scene.storeys;
    assert_eq!(storeys.portals.len(), 16, "four flights");
    let (mut lines, mut stairs) = ([String::new(), String::new(), String::new()], String::new());
    for (k, flight) in storeys.portals.chunks(4).enumerate() {
        let ends = [(flight[0].islands[0], flight[0].line), (flight[2].islands[0], flight[2].line)];
        for ((level, line), end) in ends.iter().zip(["foot", "head"]) {
            let origin = storeys.islands[*level as usize].origin;
            let (a, b) = (line.a - origin, line.b - origin);
            let text = &mut lines[*level as usize];
            let _ = writeln!(text, "line {end}{k}: ({}, {}) -- ({}, {})", a.x, a.y, b.x, b.y);
            // Railings behind the line.
            let away = if end == "foot" { flight[0].across } else { flight[2].across };
            let corners = [a, a + away, b + away, b].map(|p| format!("({}, {})", p.x, p.y));
            let _ = writeln!(text, "wall {}", corners.join(" -- "));
        }
        let [low, high] = ends.map(|(level, _)| &storeys.islands[level as usize].name);
        // Written lines face each other, or the first end is on the left of who goes up.
        let _ =
            writeln!(stairs, "stairs s{k}: {low}.foot{k} -- {high}.head{k} {{ run = {} m }}", run(&one, k));
    }
    assert!((run(&one, 0) - 9.4).abs() < 1e-3, "{}", run(&one, 0));
    let scene = by_hand([&lines[0], &lines[1], &lines[2]]) + &stairs;
    let other = mall(&scene, people).unwrap();
    let [own, written] = [&one, &other].map(|model| &model.scenario().scene.storeys.portals);
    for (a, b) in own.iter().zip(written) {
        let ends =
            [(a.line.a, b.line.a), (a.line.b, b.line.b), (a.landing.a, b.landing.a), (a.across, b.across)];
        assert!(ends.iter().all(|(a, b)| (a - b).norm() < 1e-9), "{a:?} {b:?}");
        assert!(a.islands == b.islands && (a.speed - b.speed).abs() < 1e-9);
    }
    // The walls stand in another order, and so forces are summed.
    let [one, other] = [one, other].map(|model| walks(&model, &members(1)));
    for (a, b) in one.iter().zip(&other) {
        match (a, b) {
            (Some(a), Some(b)) => assert!((a - b).norm() < 0.01, "{a} {b}"),
            (a, b) => assert_eq!(a, b),
        }
    }
}

/// The run of a flight, m.
fn run(model: &Model, flight: usize) -> f64 {
    let bounds = model.scenario().scene.storeys.islands[3 + flight].bounds;
    bounds.high.x - bounds.low.x
}

#[test]
fn all_leave_the_mall() {
    let model = parsed(SCENARIO, &[("mall.osm", MALL)]).unwrap_or_else(|errors| panic!("{errors}"));
    let options = Options::default().max_trials(2);
    let query = "estimate P(F (count(everyone) == 0)) by fixed(trials = 2)";
    let report = model.check(query, &options).unwrap();
    assert_eq!(report.results()[0].estimate, Some(1.0));
    // Stairs are regions.
    let query = "estimate P(F (count(a in everyone: a in stairs1 | a in stairs4) >= 1)) by fixed(trials = 2)";
    assert_eq!(model.check(query, &options).unwrap().results()[0].estimate, Some(1.0));
    let queries = include_str!("../examples/mall/mall.bltl");
    assert!(model.check(queries, &options).is_ok());
}

#[test]
fn what_an_import_by_level_lacks_is_said() {
    assert!(mall(BY_LEVEL, "").is_ok());
    for (from, to, wanted) in [
        (r#"second = "2""#, r#"second = "5""#, "has no level `5`"),
        (r#"second = "2""#, r#"second = "5""#, r#"are "0", "1", "2""#),
        ("storey = 4 m", "", "E0412"),
        ("storey = 4 m", "", "`storey = 4 m`"),
        ("storey = 4 m", "storey = 0 m", "must be positive"),
        ("storey = 4 m", "storey = 4 s", "E030"),
        (r#"first = "1""#, r#"first = "0""#, "are one level of the file"),
        (r#"first = "1""#, r#"ground = "1""#, "is declared twice"),
        (r#"first = "1""#, "first = 1", "`first` is neither a level nor a field of imports"),
        (r#"ground = "0"; first = "1"; second = "2"; "#, "", "names no levels"),
        (BY_LEVEL, &format!("level deep {{ {BY_LEVEL} }}"), "an import by level lies within a level"),
        ("mall.osm", "mall.wkt", "has no level `0`"),
        ("by level", "by floor", "E01"),
    ] {
        assert!(BY_LEVEL.contains(from), "{from}");
        let scene = BY_LEVEL.replacen(from, to, 1);
        let text = format!("horizon = 9 s\nstep = 0.05 s\nscene {{ {scene} }}\n");
        let files = [("mall.osm", MALL), ("mall.wkt", "POLYGON((0 0, 9 0, 9 9, 0 0))")];
        let errors = parsed(&text, &files).expect_err(to);
        assert!(errors.contains(wanted), "{to}: {errors}");
        assert!(errors.matches("error[").count() == 1 || wanted.contains("declared"), "{to}: {errors}");
    }
}

#[test]
fn stairs_of_a_file_that_fit_nowhere_are_refused_or_left_out() {
    let steps = "<tag k='level' v='0;1' />\n    <tag k='width'";
    for (from, to, wanted) in [
        (
            steps,
            "<tag k='level' v='0-2' />\n    <tag k='width'",
            "the steps join `ground`, `first`, `second`",
        ),
        (steps, "<tag k='level' v='0;2' />\n    <tag k='width'", "the steps join `ground`, `second`"),
        ("v='1.6'", "v='wide'", "the `width` of steps must be a positive length"),
        ("v='1.6'", "v='0.2'", "are 0.20 m wide"),
    ] {
        assert!(MALL.contains(from), "{from}");
        let file = MALL.replacen(from, to, 1);
        let text = format!("horizon = 9 s\nstep = 0.05 s\nscene {{ {BY_LEVEL} }}\n");
        let errors = parsed(&text, &[("mall.osm", &file)]).expect_err(to);
        assert!(errors.contains(wanted) && errors.contains("E0412"), "{to}: {errors}");
    }
    // Steps to a level that is not imported.
    let two = BY_LEVEL.replace(r#"; second = "2""#, "");
    assert_eq!(mall(&two, "").unwrap().scenario().scene.storeys.portals.len(), 8);
    // Levels that follow each other in the import need not do so in the file.
    let far = MALL.replace("v='0;1'", "v='0;2'").replace("v='1;2'", "v='1'");
    let text =
        format!("horizon = 9 s\nstep = 0.05 s\nscene {{ {} }}\n", BY_LEVEL.replace(r#"first = "1"; "#, ""));
    let model = parsed(&text, &[("mall.osm", &far)]).unwrap();
    assert_eq!(model.scenario().scene.storeys.portals.len(), 8);
    // Downward: foot and head change places.
    let down = MALL.replace("k='incline' v='up'", "k='incline' v='down'");
    let text = format!("horizon = 9 s\nstep = 0.05 s\nscene {{ {BY_LEVEL} }}\n");
    let [up, down] = [MALL, &down].map(|file| parsed(&text, &[("mall.osm", file)]).unwrap());
    let first = |model: &Model| model.scenario().scene.storeys.portals[0].clone();
    assert!((first(&down).line.a.x - first(&up).line.a.x - 2.4).abs() < 0.1);
    assert!((first(&down).across + first(&up).across).norm() > 1.9 || first(&down).across.y < 0.0);
    // A name that the file gives.
    let named = MALL.replacen(
        "<tag k='highway' v='steps' />",
        "<tag k='highway' v='steps' /><tag k='ref' v='A' />",
        1,
    );
    let people = "agent me: person { at = first (0, 0) }\nlet up = me in A | me in stairs2";
    let text = format!(
        "horizon = 9 s\nstep = 0.05 s\nscene {{ {BY_LEVEL} }}\nkind person: sfm preset smc2\n{people}"
    );
    let model = parsed(&text, &[("mall.osm", &named)]).unwrap();
    assert!(model.scenario().scene.regions.iter().any(|region| region.name == "A"));
}

/// A feature of OSM, its corners in metres.
fn element(id: i32, corners: &[(f64, f64)], is_closed: bool, tags: &[(&str, &str)]) -> String {
    let mut text = String::new();
    for (k, (x, y)) in corners.iter().enumerate() {
        let node = id * 100 - k as i32;
        let _ = writeln!(text, "<node id='{node}' lat='{}' lon='{}'/>", y / 110_574.275_8, x / 111_319.490_8);
    }
    let _ = writeln!(text, "<way id='{id}'>");
    for k in (0..corners.len()).chain(is_closed.then_some(0)) {
        let _ = writeln!(text, "<nd ref='{}'/>", id * 100 - k as i32);
    }
    for (key, value) in tags {
        let _ = writeln!(text, "<tag k='{key}' v='{value}'/>");
    }
    text + "</way>\n"
}

#[test]
fn levels_may_be_ranges_and_repeated() {
    let square = |x: f64| [(x, 0.0), (x + 8.0, 0.0), (x + 8.0, 8.0), (x, 8.0)];
    let room = |id, x, tags: [(&str, &str); 2]| {
        element(id, &square(x), true, &[("indoor", "room"), tags[0], tags[1]])
    };
    let text = format!(
        "<osm version='0.6'>{}{}{}</osm>",
        room(-1, 0.0, [("name", "Shaft"), ("level", "0-2")]),
        room(-2, 10.0, [("name", "Ends"), ("level", "0;2")]),
        element(
            -3,
            &square(20.0),
            true,
            &[("indoor", "room"), ("name", "Same"), ("level", "0"), ("repeat_on", "1")]
        ),
    );
    let scene = |names: &str| {
        format!(
            "horizon = 1 s\nstep = 0.05 s\nscene {{ import \"a.osm\" as plan by level {{ a = \"0\"; b = \"1\"; c = \"2\"; storey = 3 m }}\n{names} }}"
        )
    };
    let found = |name: &str| parsed(&scene(&format!("region r: {name}")), &[("a.osm", &text)]).is_ok();
    let all: Vec<bool> = ["Shaft", "Ends", "Same"]
        .iter()
        .flat_map(|room| ["a", "b", "c"].map(|level| found(&format!("{level}.plan.{room}"))))
        .collect();
    assert_eq!(all, [true, true, true, true, false, true, true, true, false]);
    // A filter of one's own comes on top.
    let few = scene("").replace("as plan by", "where name == \"Shaft\" as plan by");
    assert!(parsed(&few.replace("scene {", "scene { region r: b.plan.Shaft\n"), &[("a.osm", &text)]).is_ok());
    assert!(parsed(&few.replace("scene {", "scene { region r: a.plan.Ends\n"), &[("a.osm", &text)]).is_err());
}

/// Three levels of IMDF with a hall each, and a stairwell beside it.
fn imdf(doors: [&[(f64, f64)]; 3]) -> String {
    let mut features = Vec::new();
    let at = |x: f64, y: f64| format!("[{},{}]", x / 111_319.490_8, y / 110_574.275_8);
    let mut add = |kind: &str, id: &str, more: &str, geometry: &str| {
        features.push(format!(
            r#"{{"type":"Feature","id":"{id}","feature_type":"{kind}","properties":{{{more}}},"geometry":{geometry}}}"#
        ));
    };
    let square = |x: f64, y: f64, w: f64, h: f64| {
        let corners = [at(x, y), at(x + w, y), at(x + w, y + h), at(x, y + h), at(x, y)].join(",");
        format!(r#"{{"type":"Polygon","coordinates":[[{corners}]]}}"#)
    };
    for (k, doors) in doors.iter().enumerate() {
        let id = format!("\"level_id\":\"l{k}\"");
        let names = format!(r#""ordinal":{k},"short_name":{{"en":"F{k}"}}"#);
        add("level", &format!("l{k}"), &names, &square(0.0, 0.0, 20.0, 10.0));
        let hall = format!(r#"{id},"category":"walkway","name":"Hall{k}""#);
        add("unit", &format!("h{k}"), &hall, &square(0.0, 0.0, 14.0, 10.0));
        add("unit", &format!("s{k}"), &format!(r#"{id},"category":"stairs""#), &square(14.0, 2.0, 6.0, 6.0));
        for (n, (low, high)) in doors.iter().enumerate() {
            let line =
                format!(r#"{{"type":"LineString","coordinates":[{},{}]}}"#, at(14.0, *low), at(14.0, *high));
            add("opening", &format!("o{k}{n}"), &id, &line);
        }
    }
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

#[test]
fn stairwells_of_imdf_become_flights() {
    let scenario = |people: &str| {
        format!(
            "horizon = 120 s\nstep = 0.05 s\nscene {{ import \"a.geojson\" as plan by level {{ ground = \"0\"; first = \"F1\"; second = \"2\"; storey = 3 m; projection = local }} }}
            kind person: sfm preset smc2\n{people}"
        )
    };
    let door: &[(f64, f64)] = &[(4.0, 6.0)];
    let people =
        "agents down[6]: person { at = uniform in second.plan.Hall2; route = ground.plan.Hall0 then leave }
        agents up[3]: person { at = uniform in ground.plan.Hall0; route = first.plan.Hall1 then leave }";
    let model = parsed(&scenario(people), &[("a.geojson", &imdf([door; 3]))]).unwrap();
    assert_eq!(model.scenario().scene.storeys.portals.len(), 8);
    let query = "estimate P(F (count(everyone) == 0)) by fixed(trials = 12)";
    let report = model.check(query, &Options::default().max_trials(12)).unwrap();
    assert_eq!(report.results()[0].estimate, Some(1.0));
    for (doors, wanted) in [
        ([door, &[], door], "the stairs have 0 openings on the level `first`"),
        ([&[(2.5, 4.0), (5.0, 7.0)], door, door], "the stairs have 2 openings on the level `ground`"),
    ] {
        let errors = parsed(&scenario(""), &[("a.geojson", &imdf(doors))]).unwrap_err();
        assert!(errors.contains(wanted) && errors.contains("E0412"), "{errors}");
    }
}

/// All that is done to the text of a file.
fn use_up(text: &str) {
    let Ok(mut features) = read_osm(text, &mut |_, _| true) else { return };
    let _ = Placement::Local(Vec2::zeros()).place(&mut features);
    let Ok(plan) = plan(&features, (1.0, 1e-3), false) else { return };
    let mut walls: Vec<_> = plan
        .barriers
        .into_iter()
        .filter_map(|(_, form)| match form {
            smc::data::geometry::Form::Wall(pieces) => Some(pieces),
            smc::data::geometry::Form::Solid(_) => None,
        })
        .collect();
    let _ = open_doors(&mut walls.iter_mut().collect::<Vec<_>>(), &plan.doors);
}

#[test]
fn broken_files_of_osm_are_errors_and_never_panics() {
    let text = format!("horizon = 1 s\nstep = 0.05 s\nscene {{ {BY_LEVEL} }}\n");
    for k in 0..200 {
        let cut = &MALL[..k * MALL.len() / 200];
        assert!(parsed(&text, &[("mall.osm", cut)]).is_err());
    }
    // The generator of Lehmer (1951) with the factor of Park and Miller (1988).
    let mut draw = 11_u64;
    for case in 0..400 {
        let mut bytes = MALL.as_bytes().to_vec();
        for _ in 0..=case % 8 {
            draw = draw * 48_271 % 2_147_483_647;
            let at = draw as usize % bytes.len();
            draw = draw * 48_271 % 2_147_483_647;
            bytes[at] = if case % 2 == 0 { b"0123456789.-<>'/ "[draw as usize % 17] } else { draw as u8 };
        }
        use_up(&String::from_utf8_lossy(&bytes));
        if case % 20 == 0 {
            let _ = Draft::new("a.scn", &*text).file("mall.osm", bytes).parse();
        }
    }
    for deep in ["<osm>", "<node id='1'>", "<!DOCTYPE a [<!ENTITY b 'c'>]><osm>&b;</osm>"] {
        assert!(read_osm(&("<osm>".to_owned() + &deep.repeat(100_000)), &mut |_, _| true).is_err());
    }
    let nested = format!("<osm>{}{}</osm>", "<a>".repeat(100_000), "</a>".repeat(100_000));
    use_up(&nested);
}
