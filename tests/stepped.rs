//! Walkers that step: one test for each row of the table in `docs/semantics.md`, and what is refused.

use smc::base::geometry::Vec2;
use smc::{Model, Options, Report};

/// A hall with a block in the middle.
const HALL: &str = "
horizon = 60 s
step = 1 s / 60
scene {
  wall (-1, -1) -- (11, -1) -- (11, 7) -- (-1, 7) -- (-1, -1)
  region start: circle (0.5, 3) radius 0.4 m
  region desk:  circle (9, 3) radius 0.5 m
  region shelf: circle (9, 6) radius 0.4 m
  obstacle block: rect (4, 2) .. (6, 4)
}
kind operator: stepped { }
";

/// The same without the block.
fn open(rest: &str) -> Model {
    let bare: String =
        HALL.lines().filter(|line| !line.contains("block")).map(|line| format!("{line}\n")).collect();
    model(&format!("{bare}{rest}"))
}

fn model(text: &str) -> Model {
    Model::parse(text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn hall(rest: &str) -> Model {
    model(&format!("{HALL}{rest}"))
}

/// Where an agent is and its velocity, state by state.
fn track(model: &Model, trial: u64, name: &str) -> Vec<(Vec2, Vec2)> {
    let states = model.trial(3, trial).unwrap_or_else(|errors| panic!("{errors}"));
    states
        .filter_map(|state| state.agent(name).map(|a| (a.position, a.velocity)))
        .map(|(p, v)| (Vec2::new(p.x, p.y), Vec2::new(v.x, v.y)))
        .collect()
}

fn ask(model: &Model, query: &str) -> Report {
    model.check(query, &Options::default().seed(3)).unwrap_or_else(|errors| panic!("{query}\n{errors}"))
}

/// The estimate of an expectation or a probability over some trials.
fn value(model: &Model, query: &str) -> f64 {
    ask(model, query).results()[0].estimate.unwrap()
}

fn refused(text: &str, said: &str) {
    match Model::parse(text) {
        Ok(_) => panic!("{text} is accepted"),
        Err(errors) => {
            let found = errors.to_string();
            assert!(found.contains(said), "{text}\n{found}");
            assert_eq!(found.matches("error[").count(), 1, "{text}\n{found}");
        }
    }
}

const ALONE: &str = "agent me: operator { at = uniform in start; route = desk }";

#[test]
fn people_share_a_goal_that_is_too_small_for_all() {
    for goal in ["region spot: rect (7.7, 2.7) .. (8.3, 3.3)", "point spot: (8, 3)"] {
        let bare: String =
            HALL.lines().filter(|line| !line.contains("block")).map(|line| format!("{line}\n")).collect();
        let text = bare.replace("scene {", &format!("scene {{ {goal}"));
        let all = model(&format!(
            "{text}
            agents crowd[4]: operator {{ at = uniform in rect (0, 0) .. (2, 6); route = spot -> shelf }}"
        ));
        let query = "estimate P(F<=60 s (forall one in crowd: done(one))) by fixed(trials = 20)";
        let report = ask(&all, query);
        assert_eq!(report.results()[0].estimate, Some(1.0), "{goal}");
    }
}

#[test]
fn who_ends_a_hair_from_a_barrier_turns_and_goes_on() {
    for room in [1e-4, 5e-4, 2e-3, 5e-3] {
        let place = 4.0 - 0.25 - room;
        let all = model(&format!(
            "{}agent me: operator {{ at = uniform in start; route = beside -> start }}",
            HALL.replace("scene {", &format!("scene {{ point beside: ({place}, 3)"))
        ));
        let query = "estimate P(F<=60 s (done(me))) by fixed(trials = 40)";
        assert_eq!(ask(&all, query).results()[0].estimate, Some(1.0), "{room} m");
    }
}

#[test]
fn walks_on_open_floor_are_straight() {
    // The largest distance of the hip from the line between start and goal, sway included.
    let long = HALL.replace("(9, 3)", "(12, 3)").replace("(11,", "(15,");
    let bare: String =
        long.lines().filter(|line| !line.contains("block")).map(|line| format!("{line}\n")).collect();
    let all = model(&format!(
        "{}agent me: operator {{ at = (0, 3); route = far }}",
        bare.replace("scene {", "scene { point far: (12, 3)")
    ));
    let mut worst: Vec<f64> = (0..60)
        .map(|trial| {
            track(&all, trial, "me").iter().map(|(place, _)| (place.y - 3.0).abs()).fold(0.0, f64::max)
        })
        .collect();
    worst.sort_by(f64::total_cmp);
    assert!(worst[30] < 0.06 && worst[54] < 0.12, "{} {}", worst[30], worst[54]);
}

#[test]
fn the_root_goes_along_its_steps_whatever_pushes() {
    // A dense crowd that would push anybody else.
    let crowd = "kind adult: sfm preset helbing2000 { noise = 0.3 m/s }
        agents crowd[6]: adult { at = uniform in rect (2, 0) .. (8, 6); route = start }";
    let walks = open(&format!("{ALONE}\n{crowd}"));
    for pair in track(&walks, 0, "me").windows(2) {
        // The velocity leads to the next place, so that others feel how the walker moves.
        assert!((pair[1].0 - pair[0].0 - pair[0].1 / 60.0).norm() < 1e-9, "{pair:?}");
    }
    let stands =
        open(&format!("agent me: operator {{ at = (0.5, 3); route = start -> wait 50 s -> desk }}\n{crowd}"));
    let path = track(&stands, 0, "me");
    assert!(path[..60 * 50].iter().all(|(place, velocity)| *place == path[0].0 && velocity.norm() == 0.0));
}

#[test]
fn a_walk_ends_at_a_drawn_point_and_the_leg_with_its_last_step() {
    let model = hall(ALONE);
    let mut ends = Vec::new();
    for trial in 0..12 {
        let path = track(&model, trial, "me");
        let (end, velocity) = *path.last().unwrap();
        assert!((end - Vec2::new(9.0, 3.0)).norm() <= 0.5 - 0.25 + 1e-6, "a body stands inside: {end:?}");
        assert_eq!(velocity.norm(), 0.0);
        ends.push(end);
        // No point of the body meets the block.
        let outside = |p: Vec2| {
            Vec2::new((4.0 - p.x).max(p.x - 6.0), (2.0 - p.y).max(p.y - 4.0)).sup(&Vec2::zeros()).norm()
        };
        let nearest = path.iter().map(|(p, _)| outside(*p)).fold(f64::INFINITY, f64::min);
        assert!(nearest > 0.25 - 1e-3, "trial {trial}: {nearest}");
    }
    assert!(ends.windows(2).all(|w| w[0] != w[1]));
    // The leg ends when the walker stands, not where it comes into the region.
    let stands = value(&model, "estimate P(G (legs(me) == 1 => speed(me) < 0.01 m/s)) by fixed(trials = 20)");
    assert_eq!(stands, 1.0);
}

#[test]
fn numbers_of_legs_are_known_when_the_legs_end() {
    let model = hall("agent me: operator { at = uniform in start; route = desk -> wait 2 s -> shelf }");
    let of = |metric: &str, most: &str| {
        value(&model, &format!("estimate E({metric}) in 0 {most} .. 40 {most} by fixed(trials = 40)"))
    };
    let (first, second) = (of("leg_length(me, 1)", "m"), of("leg_length(me, 2)", "m"));
    assert!(first > 8.4 && first < 10.5 && second > 2.6 && second < 3.8, "{first} {second}");
    // The lengths of both are the way gone; a pause is no leg and not part of a leg's time.
    assert!((of("travelled(me) at end", "m") - first - second).abs() < 0.02);
    let times = of("leg_time(me, 1)", "s") + of("leg_time(me, 2)", "s");
    assert!((of("time_until(done(me))", "s") - times - 2.0).abs() < 0.1);
    let steps =
        value(&model, "estimate E(leg_steps(me, 1) + leg_steps(me, 2)) in 0 .. 60 by fixed(trials = 40)");
    assert_eq!(steps, value(&model, "estimate E(step_count(me) at end) in 0 .. 60 by fixed(trials = 40)"));
    assert!(steps > 17.0 && steps < 28.0, "{steps}");
    // Known when the leg ends: the trial stops there.
    let report = ask(&model, "estimate P(leg_time(me, 1) <= 30 s) by fixed(trials = 20)");
    let result = &report.results()[0];
    assert!(result.consumed.steps < 20 * 60 * 20, "{}", result.consumed.steps);
}

#[test]
fn a_leg_that_does_not_end_is_infinite() {
    let short = HALL.replace("horizon = 60 s", "horizon = 2 s");
    let short = model(&format!("{short}{ALONE}"));
    assert_eq!(value(&short, "estimate P(leg_length(me, 1) <= 1000 m) by fixed(trials = 10)"), 0.0);
    assert_eq!(value(&short, "estimate P(leg_length(me, 1) >= 1000 m) by fixed(trials = 10)"), 1.0);
    assert_eq!(value(&short, "estimate P(F done(me)) by fixed(trials = 10)"), 0.0);
}

#[test]
fn legs_are_those_of_walkers_of_every_kind() {
    let model = hall(
        "kind adult: sfm preset helbing2000 { }
        kind planner: planned { limit speed = 1.4 m/s }
        agent a: adult { at = (0, 1); route = desk -> wait 1 s -> shelf }
        agent b: planner { at = (0, 5); route = desk -> wait 1 s }
        agent c: operator { at = (0, 3); route = shelf then leave }",
    );
    for (query, least, most) in [
        ("leg_length(a, 1)", 7.5, 10.0),
        ("leg_length(a, 2)", 1.5, 4.0),
        ("leg_length(b, 1)", 7.5, 11.0),
        ("leg_length(c, 1)", 8.5, 11.5),
    ] {
        let found = value(&model, &format!("estimate E({query}) in 0 m .. 40 m by fixed(trials = 10)"));
        assert!(found > least && found < most, "{query} {found}");
    }
    assert_eq!(value(&model, "estimate P(F (done(a) & done(b) & done(c))) by fixed(trials = 10)"), 1.0);
    // It stays true, also of who has left.
    assert_eq!(value(&model, "estimate P(F (done(c) & !present(c))) by fixed(trials = 10)"), 1.0);
    let waits = value(
        &model,
        "estimate E(time_until(done(b)) - leg_time(b, 1)) in 0 s .. 60 s by fixed(trials = 10)",
    );
    assert!((waits - 1.0).abs() < 0.05, "{waits}");
    assert_eq!(value(&model, "estimate E(step_count(a) at end) in 0 .. 9 by fixed(trials = 5)"), 0.0);
}

#[test]
fn speed_of_a_behaviour_scales_the_free_speed() {
    let slow = hall(
        "behaviour tired { state slow { speed = 0.5 * speed } }
        agent me: operator with tired { at = uniform in start; route = desk }
        agent other: operator { at = (0, 5.5); route = shelf }",
    );
    let plain = hall(
        "agent me: operator { at = uniform in start; route = desk }
        agent other: operator { at = (0, 5.5); route = shelf }",
    );
    let time =
        |model: &Model| value(model, "estimate E(leg_time(me, 1)) in 0 s .. 60 s by fixed(trials = 40)");
    let ratio = time(&slow) / time(&plain);
    assert!(ratio > 1.5 && ratio < 2.3, "{ratio}");
}

#[test]
fn advice_holds_from_the_end_of_a_step() {
    let model = hall(
        "agent me: operator { at = (0, 1); route = (9, 1) }
        moves me for 3 s { heading 30 deg; stop; heading -20 deg }",
    );
    let query = "rank moves of me by E(y(position(me)) at 3 s) in -1 m .. 7 m within 0.3 m";
    let report = ask(&model, query);
    let rank = report.results()[0].rank.as_ref().unwrap();
    let order: Vec<&str> = rank.options.iter().map(|option| option.label.as_str()).collect();
    assert_eq!(order, ["heading 30 deg", "own way", "stop", "heading -20 deg"]);
    let stands = "estimate P(G<=3 s (speed(me) < 0.01 m/s)) by fixed(trials = 10)";
    assert!(value(&model, stands) < 0.5, "without advice it walks");
}

#[test]
fn people_in_the_way_are_avoided_and_who_stands_is_walked_around() {
    let model = open(
        "kind adult: sfm preset helbing2000 { }
        agent post: adult { at = (4.5, 3); route = (4.5, 3) }
        agent me: operator { at = (0.5, 3); route = (9, 3) }",
    );
    let met = value(&model, "estimate P(F (distance(me, post) < 0.35 m)) by fixed(trials = 40)");
    assert!(met <= 0.05, "{met}");
    let arrives = value(&model, "estimate P(F done(me)) by fixed(trials = 40)");
    assert!(arrives >= 0.95, "{arrives}");
}

#[test]
fn others_change_no_step_of_somebody_out_of_reach() {
    let alone = hall(ALONE);
    let more = hall(&format!(
        "{ALONE}
        kind adult: sfm preset helbing2000 {{ }}
        agent far: adult {{ at = (0, 6.6); route = (0, 6.6) }}
        kind second: stepped {{ }}
        agent late: second {{ at = (10.5, 6.5); route = (10.5, 6) }}"
    ));
    for trial in 0..5 {
        let (a, b) = (track(&alone, trial, "me"), track(&more, trial, "me"));
        // Until somebody is near.
        assert_eq!(a[..60], b[..60], "trial {trial}");
    }
}

#[test]
fn without_a_way_there_is_an_error_before_the_first_trial() {
    let closed = HALL.replace("scene {", "scene {\n  wall (7, -1) -- (7, 7)");
    let error = model(&format!("{closed}{ALONE}"))
        .check("estimate P(F done(me))", &Options::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("E0803"), "{error}");
}

#[test]
fn wrong_kinds_and_legs_are_refused_with_a_place_and_a_hint() {
    let start = "horizon = 9 s\nstep = 0.04 s\nscene { region goal: rect (8, 0) .. (9, 1) }\n";
    let agent = "agent a: k { at = (0, 0); route = goal }";
    for (kind, said) in [
        ("kind k: stepped { tau = 1 s }", "unknown parameter `tau`"),
        ("kind k: stepped { attention = 0.5 }", "unknown parameter `attention`"),
        ("kind k: stepped { height = 4 m }", "exceeds 3 m"),
        ("kind k: stepped { height = -1 m }", "must be positive"),
        (
            "kind k: stepped { gait = walking }",
            "`gait` must be `synthetic`, or `learned` or `as_published` with a file",
        ),
        ("kind k: stepped { search = guided }", "expected `guided(…)`"),
        ("kind k: stepped { search = guided(candidates = 0) }", "a whole number from 1 to 1000"),
        ("kind k: stepped { search = guided(candidate = 5) }", "unknown argument of `guided`"),
        ("kind k: stepped { search = hybrid_a_star(cell = 0 m) }", "`cell` must be"),
        ("kind k: stepped { search = grid_a_star(cell = 1 m) }", "argument"),
        ("kind k: stepped { search = dijkstra() }", "unknown search `dijkstra`"),
        ("kind k: sfm preset helbing2000 { gait = synthetic }", "unknown parameter `gait`"),
    ] {
        refused(&format!("{start}{kind}\n{agent}"), said);
    }
    refused(
        &format!("{start}kind k: stepped {{ }}\ngroup g[2]: k {{ at = (0, 0); route = goal }}"),
        "cannot be a group",
    );
    refused(
        &format!("{start}kind k: stepped {{ }}\ngroup g[2]: k as particle {{ at = (0, 0); route = goal }}"),
        "cannot move `as particle`",
    );
    let fine = model(&format!("{start}kind k: stepped {{ }}\n{agent}"));
    for (query, said) in [
        ("estimate E(leg_length(a, 2)) in 0 m .. 9 m", "the route of `a` has one leg"),
        ("estimate E(leg_length(a, 0)) in 0 m .. 9 m", "(got 0)"),
        ("estimate E(leg_time(a, 1.5)) in 0 s .. 9 s", "(got 1.5)"),
        ("estimate P(exists b in members(a): leg_length(b, 1) < 3 m)", "is about a trace"),
    ] {
        let found = fine.check(query, &Options::default()).unwrap_err().to_string();
        assert!(found.contains(said), "{query}\n{found}");
    }
}
