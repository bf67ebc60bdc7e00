//! Levels and stairs: the rules of the chapter on buildings, each by a trial, and ways against an independent shortest path.

use smc::base::geometry::Vec2;
use smc::engine::outcome::QueryResult;
use smc::model::{Goal, Portal};
use smc::route::Atlas;
use smc::{Model, Options};
use std::fmt::Write;

/// Two levels and stairs between them; `more` stands behind.
fn house(stairs: &str, more: &str) -> String {
    format!(
        "horizon = 40 s\nstep = 0.05 s
        scene {{
          level ground {{
            wall (10, 0) -- (10, 4); wall (10, 6) -- (10, 10)
            line foot: (10, 4) -- (10, 6)
            region exit: rect (0, 4) .. (1, 6)
            point here: (3, 4)
          }}
          level first {{
            height = 3 m
            wall (16, 0) -- (16, 4); wall (16, 6) -- (16, 10)
            line head: (16, 4) -- (16, 6)
            region hall: rect (17, 0) .. (26, 10)
          }}
          stairs s: ground.foot -- first.head {{ {stairs} }}
        }}
        kind person: sfm preset smc2 {{ speed = 1.34 m/s; radius = 0.2 m; aside = 0 m }}\n{more}"
    )
}

fn model(text: &str) -> Model {
    Model::parse(text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn check(model: &Model, query: &str) -> QueryResult {
    let options = Options::default().max_trials(3);
    model.check(query, &options).unwrap_or_else(|errors| panic!("{errors}")).results()[0].clone()
}

/// The mean of a number that is the same in all trials.
fn value(model: &Model, metric: &str) -> f64 {
    let result = check(model, &format!("estimate E({metric}) in 0 .. 1000 by fixed(trials = 1)"));
    result.estimate.unwrap_or(f64::NAN)
}

/// Where somebody is at each state of a trial.
fn walk(model: &Model, trial: u64, name: &str) -> Vec<(f64, Vec2)> {
    let states = model.trial(0, trial).unwrap();
    states.filter_map(|s| s.agent(name).map(|a| (s.time, Vec2::new(a.position.x, a.position.y)))).collect()
}

#[test]
fn on_stairs_one_walks_as_fast_as_the_table_says() {
    let up = "agent me: person { at = (2, 5); route = first (20, 5) }";
    let down = "agent me: person { at = first (24, 5); route = ground.exit }";
    // 6 m long in the plan, 3 m high: Weidmann, SFPE, and written shares.
    let sfpe = 51.8 / 60.0 * 2.0_f64.sqrt() / 1.40 * 2.0 / 5.0_f64.sqrt();
    for (stairs, who, share) in [
        ("run = 6 m", up, 0.610 / 1.34),
        ("run = 6 m", down, 0.694 / 1.34),
        ("run = 6 m; speeds = sfpe", up, sfpe),
        ("run = 6 m; speeds = sfpe", down, sfpe),
        ("run = 6 m; up = 0.5; down = 0.75", down, 0.75),
    ] {
        let walk = walk(&model(&house(stairs, who)), 0, "me");
        // Strips lie in a row above the levels.
        let on_stairs: Vec<f64> = walk.iter().filter(|(_, at)| at.y > 20.0).map(|(time, _)| *time).collect();
        let time = on_stairs.last().unwrap() - on_stairs[0];
        let wanted = 6.0 / (1.34 * share);
        assert!((time - wanted).abs() < 0.5, "{stairs}: {time} s, wanted {wanted} s");
    }
    let slow =
        house("run = 6 m; up = 0.5; down = 0.5", down).replace("aside = 0 m", "aside = 0 m; stairs = 0.5");
    let on_stairs = walk(&model(&slow), 0, "me").iter().filter(|(_, at)| at.y > 20.0).count();
    assert!((on_stairs as f64 * 0.05 - 6.0 / (1.34 * 0.25)).abs() < 1.0, "{on_stairs}");
}

#[test]
fn planned_walkers_go_over_stairs_without_slowing_down_at_their_lines() {
    let me =
        "kind planner: planned { limit speed = 1.2 m/s; limit acceleration = 1 m/s^2; profile = optimal }
        agent me: planner { at = first (24, 8); route = first (20, 5) -> ground.here -> ground.exit }";
    let house = house("run = 6 m; down = 0.5", me);
    let walk = walk(&model(&house), 0, "me");
    let is_on_stairs = |at: &Vec2| at.y > 20.0;
    let on_stairs: Vec<f64> = walk.iter().filter(|(_, at)| is_on_stairs(at)).map(|(time, _)| *time).collect();
    let time = on_stairs.last().unwrap() - on_stairs[0];
    assert!((time - 6.0 / 0.6).abs() < 0.3, "{time}");
    let first = walk.iter().position(|(_, at)| is_on_stairs(at)).unwrap();
    let before = (walk[first - 1].1 - walk[first - 11].1).norm() / 0.5;
    assert!((before - 1.2).abs() < 0.02, "{before}");
    // 5 m to the point, 4 m to the line, 6 m on stairs at half the speed, 9 m to the exit; 1.2 s to get going and to stop.
    let query = format!(
        "estimate P(F<={} s (me in ground.exit)) by fixed(trials = 1)",
        (5.0 + 4.0 + 12.0 + 9.0) / 1.2 + 1.5
    );
    assert_eq!(check(&model(&house), &query).estimate, Some(1.0));
}

#[test]
fn a_scene_of_one_level_has_the_bytes_of_one_without() {
    let scene = "wall (0, 0) -- (9, 0) -- (9, 6); obstacle pillar: circle (4, 3) radius 0.5 m
        region exit: rect (7, 1) .. (8, 5); region start: rect (1, 1) .. (3, 5)";
    let people = |of: &str| {
        format!(
            "kind person: sfm preset smc2\nagents crowd[9]: person {{ at = uniform in {of}start; route = {of}exit }}"
        )
    };
    let flat = format!("horizon = 8 s\nstep = 0.05 s\nscene {{ {scene} }}\n{}", people(""));
    let level = format!("horizon = 8 s\nstep = 0.05 s\nscene {{ level g {{ {scene} }} }}\n{}", people("g."));
    let [flat, level] = [flat, level].map(|text| model(&text));
    for trial in 0..4 {
        assert_eq!(walk(&flat, trial, "crowd[4]"), walk(&level, trial, "crowd[4]"));
    }
}

#[test]
fn people_on_other_levels_are_neither_felt_nor_near() {
    let one = "agent me: person { at = (5, 5); route = (9, 5) }";
    let both = format!("{one}\nagents others[12]: person {{ at = uniform in first.hall }}");
    let [alone, above] = [one, &both].map(|people| model(&house("run = 6 m", people)));
    assert_eq!(walk(&alone, 0, "me"), walk(&above, 0, "me"));
    assert_eq!(value(&above, "if(distance(me, others[1]) < 1000 m, 1, 2) at 0 s"), 2.0);
    assert_eq!(value(&above, "if(distance(others[2], others[1]) < 1000 m, 1, 2) at 0 s"), 1.0);
    assert_eq!(value(&above, "count(a in others: a in first) at 0 s"), 12.0);
    assert_eq!(value(&above, "count(a in everyone: a in ground) at 0 s"), 1.0);
    assert_eq!(value(&above, "count(a in others: clearance(a) < 9 m) at 0 s"), 12.0);
    // Coordinates are those of the level.
    assert_eq!(value(&above, "count(a in others: x(a) >= 17 m & x(a) <= 26 m) at 0 s"), 12.0);
    assert_eq!(value(&above, "distance(me, ground.here) / 1 m at 0 s"), 5.0_f64.sqrt());
}

#[test]
fn nobody_is_put_upon_anybody_at_the_ends_of_stairs() {
    let people = "agents down[14]: person { at = uniform in first.hall; route = ground.exit then leave }
        agents up[6]: person { at = uniform in rect (2, 2) .. (8, 8); route = first.hall }";
    let house = model(&house("run = 6 m; width = 1.6 m", people).replace("horizon = 40 s", "horizon = 90 s"));
    let result = check(&house, "check P(F<=90 s (count(down) == 0 & forall a in up: a in first)) >= 0.1");
    assert!(result.consumed.counts.successes > 0, "{result:?}");
    let nearest = "min(clearance(a) for a in everyone)";
    let deepest =
        check(&house, &format!("estimate E(min<=90 s ({nearest})) in -1 m .. 1 m by fixed(trials = 3)"));
    assert!(deepest.estimate.unwrap() > -0.2, "{:?}", deepest.estimate);
}

/// The errors of a text: code and words.
fn said(text: &str) -> String {
    match Model::parse(text) {
        Ok(_) => String::new(),
        Err(errors) => errors.to_string(),
    }
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let fine = house("run = 6 m", "");
    assert_eq!(said(&fine), "");
    for (from, to, wanted) in [
        ("height = 3 m", "height = 0 m", "have the same height"),
        ("ground.foot -- first.head", "first.head -- ground.foot", "lead downward"),
        ("wall (10, 0) -- (10, 4); wall (10, 6) -- (10, 10)", "wall (10, 0) -- (10, 10)", "lies in a wall"),
        ("ground.foot -- first.head", "ground.foot -- first.hall", "a line of a level"),
        ("ground.foot", "ground.exit", "a line of a level"),
        ("run = 6 m", "run = 0 m", "must be positive"),
        ("run = 6 m", "run = 6 m; width = 3 m", "their lines 2.00 m"),
        ("run = 6 m", "speeds = mine", "names a table"),
        ("stairs s:", "stairs t: ground.foot -- first.head\n stairs s:", "two stairs begin at one line"),
        ("level ground {", "region out: rect (0, 0) .. (1, 1)\n level ground {", "this lies on no level"),
        ("kind person", "let d = distance(ground.here, first (20, 5))\nkind person", "lie on two levels"),
        ("kind person", "agent me: person { at = ground.hall }\nkind person", "unknown name"),
        ("kind person", "agent me: person { at = first (90, 0) }\nkind person", "lies outside of the level"),
        (
            "kind person: sfm preset smc2 {",
            "agent me: person { at = (3, 3); route = ground.exit }
             kind person: planned { limit speed = 1.5 m/s; roadmap = rrt(root = ground.exit);",
            "walkers with a tree as their roadmap cannot be in a scene with levels",
        ),
        (
            "kind person",
            "kind planner: planned { limit speed = 1.5 m/s }
             agent me: planner { at = (3, 3); route = ground.exit }
             paths me { roadmap alternatives 2 }
             kind person",
            "need a scene without levels",
        ),
    ] {
        assert!(fine.contains(from), "{from}");
        let errors = said(&fine.replacen(from, to, 1));
        assert!(errors.contains(wanted), "{to}: {errors}");
    }
}

#[test]
fn who_cannot_leave_for_want_of_stairs_is_told_before_the_first_trial() {
    let text = house("run = 6 m", "agent me: person { at = first (20, 5); route = ground.exit }");
    let cut = text.replace("stairs s: ground.foot -- first.head { run = 6 m }", "");
    let errors = model(&cut).check("estimate P(F (me in ground.exit))", &Options::default()).unwrap_err();
    assert!(errors.to_string().contains("no way leads `me`"), "{errors}");
}

/// Numbers from 0 to 1, by the generator of Lehmer (1951) with the factor of Park and Miller (1988).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }
}

/// All shortest ways of 500 buildings of stairs and their rails against Floyd and Warshall over the middles of all lines. The ways on
/// one level between them are those of a plane, which `tests/ways.rs` holds against an independent shortest path.
#[test]
fn ways_over_stairs_are_those_of_an_independent_shortest_path() {
    let mut draws = Draws(7);
    let mut cases = 0;
    while cases < 500 {
        let levels = 2 + draws.below(4);
        let mut text = String::from("horizon = 1 s\nstep = 0.05 s\nscene {\n");
        let mut flights = Vec::new();
        for _ in 0..=draws.below(6) {
            let low = draws.below(levels - 1);
            let high = low + 1 + draws.below(levels - low - 1);
            let place = |draws: &mut Draws| (60.0 * draws.next(), 2.0 + 40.0 * draws.next());
            let (foot, head) = (place(&mut draws), place(&mut draws));
            let (run, up, down) =
                (1.0 + 9.0 * draws.next(), 0.2 + 0.7 * draws.next(), 0.2 + 0.7 * draws.next());
            flights.push((low, high, foot, head, run, up, down));
        }
        let goal = (draws.below(levels), (60.0 * draws.next(), 40.0 * draws.next()));
        let start = (draws.below(levels), (60.0 * draws.next(), 40.0 * draws.next()));
        for level in 0..levels {
            let _ =
                writeln!(text, "level l{level} {{ height = {level} m; region all: rect (-2, -2) .. (62, 62)");
            for (k, (low, high, foot, head, ..)) in flights.iter().enumerate() {
                for (of, (x, y), name) in [(low, foot, "foot"), (high, head, "head")] {
                    if *of == level {
                        let (a, b) = (y - 1.0, y + 1.0);
                        let _ = writeln!(text, "line {name}{k}: ({x:.6}, {a:.6}) -- ({x:.6}, {b:.6})");
                    }
                }
            }
            text.push_str("}\n");
        }
        for (k, (low, high, _, _, run, up, down)) in flights.iter().enumerate() {
            let _ = writeln!(
                text,
                "stairs s{k}: l{low}.foot{k} -- l{high}.head{k} {{ run = {run:.6} m; up = {up:.6}; down = {down:.6} }}"
            );
        }
        text.push_str("}\n");
        let Ok(model) = Model::parse(&text) else {
            // Two lines may meet.
            continue;
        };
        let scene = &model.scenario().scene;
        let round = |v: f64| (v * 1e6).round() / 1e6;
        let on = |(level, (x, y)): (usize, (f64, f64))| {
            let name = format!("l{level}");
            let island = scene.storeys.islands.iter().find(|island| island.name == name).unwrap();
            island.origin + Vec2::new(x, y)
        };
        let level_of = |p: Vec2| scene.storeys.island_at(p);
        let lines = scene.storeys.portals.iter().step_by(2);
        let rails: Vec<&Portal> = lines.filter(|one| (one.islands[0] as usize) < levels).collect();
        let middles = rails.iter().map(|one| 0.5 * (one.line.a + one.line.b));
        let places: Vec<Vec2> = [on(start), on(goal)].into_iter().chain(middles).collect();
        let is_near = |(k, a): (usize, &Vec2)| places[k + 1..].iter().any(|b| (a - b).norm() < 4.0);
        if places.iter().enumerate().any(is_near) {
            // Nobody stands between rails, and no rails are in others.
            continue;
        }
        cases += 1;
        let found = Atlas::new(scene.clone()).way(on(start), &Goal::Point(on(goal)), 0.2);
        let planes: Vec<Atlas> = (0..levels).map(|level| Atlas::new(scene.island(level))).collect();
        let count = places.len();
        let mut far = vec![vec![f64::INFINITY; count]; count];
        for a in 0..count {
            for b in 0..count {
                if level_of(places[a]) == level_of(places[b]) {
                    let plane = &planes[level_of(places[a])];
                    let way = plane.way(places[a], &Goal::Point(places[b]), 0.2);
                    far[a][b] = way.map_or(f64::INFINITY, |way| way.length);
                }
            }
        }
        for (k, (.., run, up, down)) in flights.iter().enumerate() {
            let (foot, head) = (2 + 2 * k, 3 + 2 * k);
            far[foot][head] = far[foot][head].min(round(*run) / round(*up));
            far[head][foot] = far[head][foot].min(round(*run) / round(*down));
        }
        for via in 0..count {
            for a in 0..count {
                for b in 0..count {
                    far[a][b] = far[a][b].min(far[a][via] + far[via][b]);
                }
            }
        }
        match found {
            Some(way) => {
                assert!((way.length - far[0][1]).abs() < 1e-9, "{}, not {}: {text}", way.length, far[0][1]);
            }
            None => assert_eq!(far[0][1], f64::INFINITY, "{text}"),
        }
    }
}
