//! Exits, doors, rooms of floor plans and premovement: one test for each row of the table on buildings in
//! `docs/semantics.md`.

use crate::program::Place;
use smc::base::geometry::{Segment, Vec2};
use smc::engine::outcome::QueryResult;
use smc::model::{Obstacle, Scene};
use smc::{Draft, Model, Options};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

const KIND: &str = "kind person: sfm preset smc2 { noise = 0 m/s }";

fn model(text: &str) -> Model {
    Model::parse(text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn one(model: &Model, query: &str) -> QueryResult {
    let options = Options::default().max_trials(40);
    model.check(query, &options).unwrap_or_else(|errors| panic!("{errors}")).results()[0].clone()
}

/// Where everyone is at the end of a trial, by name.
fn ends(model: &Model, trial: u64) -> Vec<(String, Vec2)> {
    let agents = &model.scenario().agents;
    let last = model.trial(0, trial).unwrap().last().unwrap();
    let place = |name: &str| last.agent(name).map(|a| Vec2::new(a.position.x, a.position.y));
    agents.iter().filter_map(|agent| Some((agent.name.clone(), place(&agent.name)?))).collect()
}

/// A hall of 20 m by 10 m with openings of 2 m in the west and the east.
fn hall(rest: &str) -> String {
    format!(
        "horizon = 60 s\nstep = 0.04 s
        scene {{
          wall (0, 4) -- (0, 0) -- (20, 0) -- (20, 4)
          wall (0, 6) -- (0, 10) -- (20, 10) -- (20, 6)
          region west: rect (-3, 4) .. (-1, 6)
          region east: rect (21, 4) .. (23, 6)
          region out: west, east
        }}
        {KIND}\n{rest}"
    )
}

// ---- exits

/// Lengths of the shortest ways to a place of a region on a grid of steps to 16 neighbours, at most 3 % too long.
fn lengths(scene: &Scene, region: &str, reach: f64) -> impl Fn(Vec2) -> f64 {
    const SIDE: f64 = 0.1;
    const LOW: Vec2 = Vec2::new(-6.0, -6.0);
    const SIZE: [i64; 2] = [720, 420];
    let walls: Vec<Segment> = scene
        .barriers
        .iter()
        .flat_map(|barrier| match &barrier.obstacle {
            Obstacle::Wall(pieces) => pieces.clone(),
            Obstacle::Solid(_) => Vec::new(),
        })
        .collect();
    let index = |[x, y]: [i64; 2]| (y * SIZE[0] + x) as usize;
    let place = |[x, y]: [i64; 2]| LOW + Vec2::new(x as f64 + 0.5, y as f64 + 0.5) * SIDE;
    let mut free = vec![true; (SIZE[0] * SIZE[1]) as usize];
    for wall in &walls {
        let cell = |p: Vec2| ((p - LOW) / SIDE).map(|v| v.floor() as i64);
        let (low, high) = (cell(wall.a.inf(&wall.b)), cell(wall.a.sup(&wall.b)));
        for y in (low.y - 5).max(0)..(high.y + 6).min(SIZE[1]) {
            for x in (low.x - 5).max(0)..(high.x + 6).min(SIZE[0]) {
                free[index([x, y])] &= wall.distance(place([x, y])) > reach;
            }
        }
    }
    let shape = &scene.regions.iter().find(|one| one.name == region).unwrap().shape;
    let mut best = vec![f64::INFINITY; free.len()];
    let mut queue = BinaryHeap::new();
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            if shape.contains(place([x, y])) {
                best[index([x, y])] = 0.0;
                queue.push((Reverse(0), [x, y]));
            }
        }
    }
    let reach = |d: i64| d != 0;
    let mut steps = vec![[1, 0], [-1, 0], [0, 1], [0, -1]];
    steps
        .extend((-2..=2).flat_map(|x| (-2..=2).map(move |y| [x, y])).filter(|[x, y]| reach(*x) && reach(*y)));
    while let Some((Reverse(length), at)) = queue.pop() {
        let length = length as f64 * 1e-6;
        if length > best[index(at)] + 1e-6 {
            continue;
        }
        for step in &steps {
            let to = [at[0] + step[0], at[1] + step[1]];
            if !(0..SIZE[0]).contains(&to[0]) || !(0..SIZE[1]).contains(&to[1]) || !free[index(to)] {
                continue;
            }
            let more = length + (step[0] as f64).hypot(step[1] as f64) * SIDE;
            if more < best[index(to)] {
                best[index(to)] = more;
                queue.push((Reverse((more * 1e6) as i64), to));
            }
        }
    }
    move |p: Vec2| {
        let cell = ((p - LOW) / SIDE).map(|v| v.floor() as i64);
        best[index([cell.x, cell.y])]
    }
}

#[test]
fn the_nearest_exit_is_that_of_the_shortest_way() {
    assert!(nearest_in_the_office(KIND, 3) > 70);
}

/// Walkers that plan keep farther from walls, and roadmaps have detours; the way of a foot ends beside those who are there.
#[test]
fn walkers_that_plan_or_step_go_to_the_nearest_exit() {
    let planner = "kind person: planned {
        limit speed = 1.5 m/s; radius = 0.18 m; roadmap = prm(samples = 6000, separation = 0.4 m, clearance = 0.05 m) }";
    assert!(nearest_in_the_office(planner, 1) > 20);
    assert!(nearest_in_the_office("kind person: stepped { radius = 0.18 m }", 1) > 20);
}

/// Of how many people who start in the 30 rooms of the office, with a third exit through room 105, an independent search knows the
/// nearest exit, to which all of them go.
fn nearest_in_the_office(kind: &str, trials: u64) -> usize {
    let rooms = (101..=130).map(|k| {
        format!("agent a{k}: person {{ at = plan[\"room {k}\"]; route = nearest(west, east, south) }}\n")
    });
    let text = format!(
        "horizon = 90 s\nstep = 0.04 s
        scene {{
          import \"building.geojson\" where level == \"0\" as plan
          door third: (33, 0) -- (34.2, 0)
          region west: rect (-4, 13) .. (-1, 17)
          region east: rect (61, 13) .. (64, 17)
          region south: rect (32, -5) .. (35, -1)
        }}
        {kind}\n{}",
        rooms.collect::<String>()
    );
    let plan = std::fs::read("models/building.geojson").unwrap();
    let draft = Draft::new("office.scn", text).file("building.geojson", plan);
    let model = draft.parse().unwrap_or_else(|errors| panic!("{errors}"));
    let scene = &model.scenario().scene;
    let exits = ["west", "east", "south"];
    let tables = exits.map(|exit| lengths(scene, exit, 0.18));
    let shape = |exit: &str| &scene.regions.iter().find(|one| one.name == exit).unwrap().shape;
    let mut told = 0;
    for trial in 0..trials {
        let first = model.trial(0, trial).unwrap().next().unwrap();
        for (name, end) in ends(&model, trial) {
            let start = first.agent(&name).unwrap().position;
            let ways = tables.each_ref().map(|table| table(Vec2::new(start.x, start.y)));
            let mut order = [0, 1, 2];
            order.sort_by(|a, b| ways[*a].total_cmp(&ways[*b]));
            // A grid cannot tell ways that are as long but for a few per cent.
            if ways[order[1]] > 1.06 * ways[order[0]] {
                let nearest = exits[order[0]];
                // Those who come last stand before those who are there.
                assert!(shape(nearest).distance(end) < 1.0, "{name} goes to {end}, not {nearest}: {ways:?}");
                told += 1;
            }
        }
    }
    told
}

#[test]
fn of_exits_that_are_equally_near_the_first_one_counts() {
    let at = |route: &str, walls: bool| {
        let text = hall(&format!("agent me: person {{ at = (10, 5); route = {route} }}"));
        let open = text.lines().filter(|line| walls || !line.contains("wall")).collect::<Vec<_>>();
        ends(&model(&open.join("\n")), 0)[0].1.x
    };
    for walls in [true, false] {
        assert!(at("nearest(west, east)", walls) < 0.0);
        assert!(at("nearest(east, west)", walls) > 20.0);
        assert!(at("out", walls) < 0.0);
        assert!(at("quickest(east, west)", walls) > 20.0);
    }
}

#[test]
fn the_quickest_exit_is_taken_by_those_who_would_wait() {
    // Eighty people stand near an exit of 1 m; another one is 18 m farther.
    let leave = |route: &str| {
        let text = format!(
            "horizon = 120 s\nstep = 0.04 s
            scene {{
              wall (20, 4.5) -- (20, 0) -- (0, 0) -- (0, 4.5)
              wall (20, 5.5) -- (20, 10) -- (0, 10) -- (0, 5.5)
              region near: rect (21, 4.5) .. (22, 5.5)
              region far: rect (-2, 4.5) .. (-1, 5.5)
              line back: (0, 4.5) -- (0, 5.5)
            }}
            {KIND}
            agents crowd[80]: person {{ at = uniform in rect (11, 1) .. (19, 9); route = {route}(near, far) then leave }}"
        );
        let model = model(&text);
        let mean = |query: &str| one(&model, query).estimate.unwrap();
        let fixed = "by fixed(trials = 6)";
        let far = mean(&format!("estimate E(crossings(back) at end) in 0 .. 80 {fixed}"));
        let last = "time_until(count(a in crowd: present(a)) == 0)";
        (far, mean(&format!("estimate E({last}) in 0 s .. 120 s {fixed}")))
    };
    let (nearest, quickest) = (leave("nearest"), leave("quickest"));
    assert_eq!(nearest.0, 0.0);
    // By the rule, those who see more than 1.3 persons for each second of their longer way take it: about 17 at first.
    assert!((8.0..40.0).contains(&quickest.0), "{quickest:?}");
    assert!(quickest.1 < 0.85 * nearest.1, "{quickest:?}, {nearest:?}");
}

#[test]
fn the_first_choice_of_an_exit_follows_the_published_rule() {
    // At 1 m/s: 10 s and nine who are nearer to the exit at 1.3 /s, or 15 s without anybody.
    let taken = |ahead: usize| {
        let text = format!(
            "horizon = 0.08 s\nstep = 0.04 s
            scene {{ region near: rect (10, -0.5) .. (11, 0.5); region far: rect (-16, -0.5) .. (-15, 0.5) }}
            kind person: sfm preset smc2 {{ noise = 0 m/s; speed = 1 m/s; radius = 0.15 m }}
            agents others[{ahead}]: person {{ at = uniform in rect (5, -2) .. (9, 2); route = quickest(near, far) }}
            agent me: person {{ at = (0, 0); route = quickest(near, far) }}"
        );
        let model = model(&text);
        let mut states = model.trial(0, 0).unwrap();
        let x = states.next().unwrap().agent("me").unwrap().position.x;
        states.last().unwrap().agent("me").unwrap().position.x - x
    };
    // The ways end a radius inside, at 10.15 m and at 15.15 m: 5 s more, in which 6.5 persons pass.
    assert!(taken(6) > 0.0);
    assert!(taken(7) < 0.0);
}

#[test]
fn choices_of_exits_are_the_same_at_any_number_of_threads() {
    let text = hall(
        "agents all[30]: person { at = uniform in rect (9, 1) .. (19, 9); route = quickest(west, east) then leave }",
    );
    let json = |threads: usize| {
        let options = Options::default().max_trials(24).threads(threads);
        let query = "estimate E(count(a in all: x(a) < 8 m) at 6 s) in 0 .. 30\nestimate P(F<=9 s (exists a in all: a in west))";
        let report = model(&text).check(query, &options).unwrap_or_else(|errors| panic!("{errors}"));
        report.results().iter().map(|one| (one.estimate, one.consumed.counts.successes)).collect::<Vec<_>>()
    };
    assert_eq!(json(1), json(3));
}

#[test]
fn a_region_has_parts() {
    let text =
        hall("agents all[40]: person { at = uniform in out }\nparam n = area(out) / 1 m^2 in 0 .. 100");
    let model = model(&text);
    let states = model.trial(0, 0).unwrap().next().unwrap();
    let at = |k: usize| states.agent(&format!("all[{k}]")).unwrap().position;
    let west = (1..=40).filter(|k| at(*k).x < 0.0).count();
    assert!((10..=30).contains(&west), "{west} of 40 start in a half of the area");
    let is_in = |x: f64, y: f64| {
        (4.0..=6.0).contains(&y) && ((-3.0..=-1.0).contains(&x) || (21.0..=23.0).contains(&x))
    };
    assert!((1..=40).all(|k| is_in(at(k).x, at(k).y)));
    let holds =
        |condition: &str| one(&model, &format!("check P({condition}) >= 0.5")).consumed.counts.successes;
    assert!(holds("n == 8 & count(a in all: a in out) == 40 & density(out) == 5 /m^2") > 0);
    assert!(holds("distance((24, 5), out) == 1 m & distance((3, 5), out) == 4 m") > 0);
}

// ---- premovement

#[test]
fn nobody_sets_out_before_their_premovement_is_over() {
    let text = hall(
        "kind slow: person { premovement = 3 s }
        agent quick: person { at = (5, 5); route = out }
        agent late: slow { at = (5, 2); route = out }
        agent later: slow { at = (5, 8); premovement = 6 s; route = out }
        agent last: slow { at = (15, 8); route = wait 4 s -> out }",
    );
    let model = model(&text);
    let mut started = [("quick", None), ("late", None), ("later", None), ("last", None)];
    let first: Vec<_> =
        model.trial(0, 0).unwrap().next().unwrap().agents.iter().map(|a| a.position).collect();
    for state in model.trial(0, 0).unwrap() {
        for (k, (name, since)) in started.iter_mut().enumerate() {
            let at = state.agent(name).unwrap().position;
            if since.is_none() && (at.x - first[k].x).hypot(at.y - first[k].y) > 0.01 {
                *since = Some(state.time);
            }
        }
    }
    let since = started.map(|(_, since)| since.unwrap());
    for (found, wanted) in since.iter().zip([0.0, 3.0, 6.0, 7.0]) {
        assert!((wanted..wanted + 0.6).contains(found), "{since:?}");
    }
}

// ---- doors

/// Two rooms with a wall in between, and a door in it.
fn rooms(door: &str, rest: &str) -> String {
    format!(
        "horizon = 30 s\nstep = 0.04 s
        param shut = 0 in 0 .. 1
        scene {{
          wall (0, 0) -- (10, 0) -- (10, 6) -- (0, 6) -- (0, 0)
          wall (5, 0) -- (5, 6)
          {door}
          region right: rect (6, 1) .. (9, 5)
        }}
        {KIND}\nagent me: person {{ at = (2, 3); route = right }}\n{rest}"
    )
}

#[test]
fn a_door_opens_its_wall_and_is_one_while_it_is_closed() {
    let model = model(&rooms("door main: (5, 2) -- (5, 4) { closed = shut == 1 }", ""));
    let pieces = |model: &Model| -> Vec<Segment> { model.scenario().scene.walls().copied().collect() };
    let open = pieces(&model);
    assert_eq!(open.len(), 6);
    assert!(open.iter().all(|piece| piece.distance(Vec2::new(5.0, 3.0)) > 0.99));
    let counted = "estimate P(F<=30 s (crossings(main) == 1)) by fixed(trials = 2)";
    assert_eq!(one(&model, counted).consumed.counts.successes, 2);
    let shut = model.with("shut", "1").unwrap();
    assert_eq!(pieces(&shut).len(), 7);
    assert!(pieces(&shut).contains(&Segment::new(Vec2::new(5.0, 2.0), Vec2::new(5.0, 4.0))));
    // Nobody has a way then, which is told before the first trial.
    let errors = shut.check(counted, &Options::default()).unwrap_err().to_string();
    assert!(errors.contains("E0803"), "{errors}");
}

#[test]
fn a_door_may_fill_a_gap_between_walls() {
    let text = rooms("door main: (5, 2) -- (5, 4) { closed = shut == 1 }", "");
    let gap = text.replace("wall (5, 0) -- (5, 6)", "wall (5, 0) -- (5, 2); wall (5, 4) -- (5, 6)");
    for value in ["0", "1"] {
        let walls = |text: &str| {
            let model = model(text).with("shut", value).unwrap();
            let mut walls: Vec<[i64; 4]> = model
                .scenario()
                .scene
                .walls()
                .map(|w| [w.a.x, w.a.y, w.b.x, w.b.y].map(|v| (v * 1e3) as i64))
                .collect();
            walls.sort_unstable();
            walls
        };
        assert_eq!(walls(&gap), walls(&text));
    }
}

#[test]
fn moves_of_doors_are_ranked_by_their_parameters() {
    // The far door is 40 m away by the corridor around; closing the near one costs time.
    let text = "horizon = 60 s\nstep = 0.04 s
        param shut = 0 in 0 .. 2
        scene {
          wall (0, 0) -- (20, 0) -- (20, 6) -- (0, 6) -- (0, 0)
          wall (0, 3) -- (20, 3)
          door near: (2, 3) -- (3.5, 3) { closed = shut == 1 }
          door far: (17, 3) -- (18.5, 3) { closed = shut == 2 }
          region goal: rect (1, 4) .. (4, 5.5)
        }
        kind person: sfm preset smc2
        agents all[3]: person { at = uniform in rect (1, 1) .. (5, 2); route = goal }";
    let rank = "rank shut in 1, 2 by P(F<=20 s (forall a in all: a in goal)) within 0.2";
    let result = one(&model(text), rank);
    assert_eq!(result.rank.unwrap().choice.as_deref(), Some("shut = 2"));
}

// ---- rooms by name

fn with_plan(features: &[(&str, &str, &str)], rest: &str) -> Result<Model, String> {
    let feature = |(properties, kind, at): &(&str, &str, &str)| {
        format!(
            r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"{kind}","coordinates":{at}}}}}"#
        )
    };
    let features: Vec<String> = features.iter().map(feature).collect();
    let plan = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","));
    let text = format!("horizon = 20 s\nstep = 0.04 s\n{KIND}\n{rest}");
    Draft::new("a.scn", text).file("plan.geojson", plan).parse().map_err(|errors| errors.to_string())
}

const PLAN: [(&str, &str, &str); 4] = [
    (r#""name":"Foyer","indoor":"room""#, "Polygon", "[[[0,0],[10,0],[10,6],[0,6],[0,0]]]"),
    (r#""name":"Room 12","ref":"R12","indoor":"room""#, "Polygon", "[[[10,0],[16,0],[16,6],[10,6],[10,0]]]"),
    (r#""name":"D1","indoor":"door","width":1.2"#, "Point", "[10,3]"),
    (r#""name":"D1b","indoor":"door""#, "LineString", "[[0,2],[0,3]]"),
];

#[test]
fn rooms_and_doors_have_the_names_of_the_file() {
    let scene = "scene { import \"plan.geojson\" as plan; region both: plan.Foyer, plan.R12 }";
    let people = "agents all[round(area(plan.Foyer) / 10 m^2)]: person { at = uniform in plan.Foyer; route = plan[\"Room 12\"] }";
    let model = with_plan(&PLAN, &format!("{scene}\n{people}")).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(model.scenario().agents.len(), 6);
    let holds = |condition: &str| {
        one(&model, &format!("estimate P({condition}) by fixed(trials = 2)")).consumed.counts.successes
    };
    assert_eq!(holds("F<=20 s (forall a in all: a in plan[\"Room 12\"])"), 2);
    assert_eq!(holds("F<=20 s (crossings(plan.D1) == 6 & crossings(plan.D1b) == 0)"), 2);
    assert_eq!(holds("G (forall a in all: a in both)"), 2);
    let line = model.scenario().scene.lines.iter().find(|line| line.name == "plan.D1");
    assert!(line.is_none(), "only the lines that are used are lines");
}

#[test]
fn names_that_a_plan_lacks_or_has_twice_are_told_where_they_are_used() {
    let scene = "scene { import \"plan.geojson\" as plan }\n";
    let told = |at: &str, plan: &[(&str, &str, &str)]| {
        let text = format!("{scene}agent me: person {{ at = {at} }}");
        with_plan(plan, &text).err().unwrap_or_default()
    };
    let all = told("plan.Foier", &PLAN);
    assert!(all.contains("unknown room or door `Foier`") && all.contains("did you mean `Foyer`?"), "{all}");
    let twice: Vec<_> = PLAN.into_iter().chain([PLAN[0]]).collect();
    assert!(told("(5, 5)", &twice).is_empty());
    assert!(told("plan.Foyer", &twice).contains("2 parts that are called `Foyer`"));
    assert!(told("plan", &PLAN).contains("`plan` is a floor plan"));
    let nameless = [(r#""indoor":"room""#, "Polygon", PLAN[0].2)];
    assert!(told("plan.Foyer", &nameless).contains("the file names none"));
}

// ---- the page

#[test]
fn a_page_of_an_evacuation_has_its_premises() {
    let text = hall(
        "kind slow: person { premovement = lognormal(2 s, 1 s) }
        agents staff[60]: slow { at = uniform in rect (17, 3) .. (19.8, 7); route = nearest(west, east) then leave }
        agent guard: person { at = (2, 2) }",
    );
    let text = text.replace("region out", "door east_door: (20, 4) -- (20, 6)\n region out");
    let page = |text: &str, query: &str| {
        let place = Place::new(&[("a.scn", text), ("a.bltl", query)]);
        let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--report", "a.html"]);
        std::fs::read_to_string(place.path("a.html")).unwrap_or_else(|_| panic!("{}", said.err))
    };
    let query = "estimate Q(0.95, time_until(count(a in staff: present(a)) == 0)) by fixed(trials = 72)";
    let page_of_exits = page(&text, query);
    let has = |part: &str| assert!(page_of_exits.contains(part), "{part} is not on the page");
    has("<h2>Premises</h2>");
    has("<td>building</td><td>56 m of walls, 0 obstacles</td>");
    has("<td>door or line east_door</td><td>2 m wide</td>");
    has("<td>occupants</td><td>61 persons</td>");
    has("<td>staff: 60 persons</td><td>premovement lognormal(2 s, 1 s), speed normal(");
    has("goes nearest(west, east), then leaves</td>");
    has("72 trials, as planned");
    has("above 4 per m² around (m)");
    has("@page { size: A4");
    // Nobody leaves a scene without an exit.
    let still = hall("agents all[3]: person { at = uniform in rect (1, 1) .. (9, 9); route = out }");
    let query = "estimate P(F<=9 s (exists a in all: a in out)) by fixed(trials = 4)";
    assert!(!page(&still, query).contains("<h2>Premises</h2>"));
}
