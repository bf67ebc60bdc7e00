//! Ways around barriers: one test for each row of the table on ways in `docs/semantics.md`.

use smc::engine::outcome::QueryResult;
use smc::route::drivers;
use smc::{Draft, Model, Options};

/// A room of 10 m by 10 m whose right side has a door of 1.2 m in its middle.
const ROOM: &str = "
scene {
  wall (10, 4.4) -- (10, 0) -- (0, 0) -- (0, 10) -- (10, 10) -- (10, 5.6)
  region outside: rect (12, 0) .. (16, 2)
}
kind person: sfm preset helbing2000";

fn model(rest: &str) -> Model {
    let text = format!("horizon = 80 s\nstep = 0.04 s\n{ROOM} {rest}");
    Model::parse(&text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn one(model: &Model, query: &str) -> QueryResult {
    let options = Options::default().max_trials(64);
    model.check(query, &options).unwrap_or_else(|errors| panic!("{errors}")).results()[0].clone()
}

/// Where someone is over a trial, m.
fn track(model: &Model, name: &str) -> Vec<(f64, f64)> {
    let states = model.trial(0, 0).unwrap();
    states.filter_map(|state| state.agent(name).map(|a| (a.position.x, a.position.y))).collect()
}

#[test]
fn who_starts_in_a_room_finds_the_door() {
    let model = model("{ }\nagent me: person { at = (2, 9); route = outside }");
    let track = track(&model, "me");
    let at = *track.last().unwrap();
    // The nearest place of the region in sight of the door, a radius inside.
    assert!(at.0 > 12.0 && at.1 < 2.0, "{at:?}");
    let length: f64 = track.windows(2).map(|w| (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1)).sum();
    // From (2, 9) to the door and to (12.3, 1.7): 8.9 m and 4 m.
    assert!((12.5..14.5).contains(&length), "{length}");
}

#[test]
fn a_kind_that_goes_straight_pushes_at_the_wall() {
    let model = model("{ wayfinding = straight }\nagent me: person { at = (2, 9); route = outside }");
    let at = *track(&model, "me").last().unwrap();
    assert!(at.0 < 10.0, "{at:?}");
    assert!(drivers(model.scenario(), 0).is_empty());
}

#[test]
fn a_leg_counts_only_with_the_next_goal_in_sight() {
    // The point lies in the doorway: reached from beside it, the way on would lead into the wall.
    let left = |wayfinding: &str| {
        let text = format!(
            "horizon = 120 s\nstep = 0.02 s
            scene {{
              wall (0, 0) -- (10, 0); wall (0, 10) -- (10, 10); wall (0, 0) -- (0, 10)
              wall (10, 0) -- (10, 4.4); wall (10, 5.6) -- (10, 10)
              region behind: rect (10.5, 3) .. (12, 7)
            }}
            kind person: sfm preset helbing2000 {{ noise = 0.05 m/s; {wayfinding} }}
            agents crowd[100]: person {{ at = uniform in rect (0.3, 0.3) .. (9.7, 9.7); route = (10, 5) -> behind then leave }}"
        );
        let model = Model::parse(&text).unwrap_or_else(|errors| panic!("{errors}"));
        one(&model, "estimate P(F<=120 s (count(a in crowd) == 0)) by fixed(trials = 20)")
            .consumed
            .counts
            .successes
    };
    assert_eq!(left(""), 20);
    assert!(left("wayfinding = straight") < 18, "the old rule leaves some of them in the room");
}

#[test]
fn who_is_pushed_out_of_sight_is_given_another_way() {
    // A behaviour diverts me to a place behind the wall, and back.
    let model = model(
        "{ }
        behaviour errand { state go { after 4 s -> fetch }; state fetch { route = (13, 9); after 14 s -> back }; state back { } }
        agent me: person with errand { at = (2, 5); route = (4, 1) }",
    );
    let track = track(&model, "me");
    let farthest = track.iter().map(|at| at.0).fold(0.0, f64::max);
    let end = *track.last().unwrap();
    assert!(farthest > 12.5, "{farthest}");
    assert!((end.0 - 4.0).hypot(end.1 - 1.0) < 0.6, "{end:?}");
}

#[test]
fn a_crowd_uses_the_width_of_a_corridor_at_its_corner() {
    let model = Model::parse(
        "horizon = 80 s\nstep = 0.02 s
        scene {
          wall (-16, 0) -- (10, 0) -- (10, 15)
          wall (-16, 5) -- (5, 5) -- (5, 15)
          region goal: rect (5, 13) .. (10, 15)
        }
        kind person: sfm preset smc1 { noise = 0.05 m/s }
        agents crowd[150]: person { at = uniform in rect (-15, 0.3) .. (0, 4.7); route = goal then leave }",
    )
    .unwrap_or_else(|errors| panic!("{errors}"));
    // A single file around the inner corner needs 60 s or more.
    let out = one(&model, "estimate P(F<=54 s (count(a in crowd) == 0)) by fixed(trials = 8)");
    assert_eq!(out.consumed.counts.successes, 8);
}

/// With `aside` a way keeps off corners, but not where it would not get through or have to go far around.
#[test]
fn a_way_keeps_aside_of_corners_where_there_is_room() {
    let walk = |aside: &str, walls: &str, goal: &str| {
        let text = format!(
            "horizon = 30 s\nstep = 0.02 s\nscene {{ {walls} }}\n\
             kind person: sfm preset smc2 {{ radius = 0.15 m; speed = 1.3 m/s; aside = {aside} }}\n\
             agent me: person {{ at = (1, 1); route = {goal} }}\n"
        );
        track(&Model::parse(&text).unwrap_or_else(|errors| panic!("{errors}")), "me")
    };
    let nearest = |track: &[(f64, f64)], x: f64, y: f64| {
        track.iter().map(|at| (at.0 - x).hypot(at.1 - y)).fold(f64::INFINITY, f64::min)
    };
    let bend = "wall (0, 0) -- (12, 0) -- (12, 12); wall (0, 0) -- (0, 2) -- (10, 2) -- (10, 12)";
    let [close, wide] = ["0 m", "0.25 m"].map(|aside| nearest(&walk(aside, bend, "(11, 10)"), 10.0, 2.0));
    assert!(close < 0.32 && (0.36..0.5).contains(&wide), "{close} and {wide}");
    // A door of 0.6 m: with 0.4 m to each side nobody would fit.
    let door = "wall (5, -9) -- (5, 3); wall (5, 3.6) -- (5, 9)";
    let end = *walk("0.25 m", door, "(9, 1)").last().unwrap();
    assert!((end.0 - 9.0).hypot(end.1 - 1.0) < 0.5, "{end:?}");
}

#[test]
fn both_layouts_find_the_same_way_and_lanes_do_not_meet() {
    let text = |others: u32| {
        format!(
            "{{ }}\nagent me: person {{ at = (2, 9); route = outside }}
            agents far[{others}]: person {{ at = uniform in rect (200, 200) .. (260, 260) }}"
        )
    };
    let (lanes, cells) = (track(&model(&text(10)), "me"), track(&model(&text(400)), "me"));
    assert_eq!(lanes.len(), cells.len());
    for (a, b) in lanes.iter().zip(&cells) {
        assert!((a.0 - b.0).hypot(a.1 - b.1) < 1e-9, "{a:?} {b:?}");
    }
}

#[test]
fn nothing_is_looked_for_where_nothing_can_stand_in_the_way() {
    let open = "horizon = 5 s\nstep = 0.04 s
        scene { wall (0, 0) -- (20, 0); wall (0, 4) -- (20, 4); region end: rect (18, 0.5) .. (20, 3.5) }
        kind person: sfm preset helbing2000
        agents crowd[4]: person { at = uniform in rect (0, 0.5) .. (6, 3.5); route = end }";
    assert!(drivers(Model::parse(open).unwrap().scenario(), 0).is_empty());
    let pillar = open.replace("region end", "obstacle circle (10, 2) radius 0.5 m; region end");
    assert!(!drivers(Model::parse(&pillar).unwrap().scenario(), 0).is_empty());
}

#[test]
fn goals_that_nobody_can_reach_are_refused_before_the_first_trial() {
    let refused = |rest: &str| {
        let error = model(rest)
            .check("estimate P(F<=1 s (x(position(me)) > 100 m))", &Options::default())
            .unwrap_err();
        error.to_string()
    };
    let found = [
        refused("{ radius = 0.7 m }\nagent me: person { at = (2, 9); route = outside }"),
        refused(
            "{ }\nagent me: person { at = (2, 9); route = (5, 5) -> outside -> (4, 4) }\nscene { obstacle rect (3, 3) .. (6, 6) }",
        ),
        refused(
            "{ }\nagents crowd[3]: person { at = uniform in rect (1, 1) .. (9, 9); route = (20, 5) }\nagent me: person { at = (1, 1) }\nscene { wall locked: (10, 4.4) -- (10, 5.6) }",
        ),
    ];
    insta::assert_snapshot!(found.join("\n"));
    // Straight on through whatever is in the way is legal.
    let straight =
        model("{ wayfinding = straight; radius = 0.7 m }\nagent me: person { at = (2, 9); route = outside }");
    assert!(
        straight
            .check("estimate P(F<=1 s (x(position(me)) > 100 m))", &Options::default().max_trials(8))
            .is_ok()
    );
}

#[test]
fn starts_and_goals_that_only_luck_serves_are_named() {
    let warned = |rest: &str| {
        let report = model(rest)
            .check("estimate P(F<=1 s (x(position(me)) > 100 m))", &Options::default().max_trials(8))
            .unwrap();
        report.warnings().to_string()
    };
    let found = [
        warned(
            "{ }\nagent me: person { at = uniform in rect (6, 1) .. (14, 9); route = (5, 5) }\nscene { wall (10, 4.4) -- (10, 5.6) }",
        ),
        warned("{ radius = uniform(0.2 m, 0.8 m) }\nagent me: person { at = (2, 9); route = outside }"),
        warned("{ }\nagent me: person { at = (2, 9); route = (9.9, 2) -> outside }"),
    ];
    insta::assert_snapshot!(found.join("\n"));
}

#[test]
fn trials_without_a_way_are_counted_and_the_first_is_named() {
    let text = format!(
        "horizon = 4 s\nstep = 0.04 s\n{ROOM} {{ }}
        scene {{ wall (10, 4.4) -- (10, 5.6) }}
        agent me: person {{ at = uniform in rect (6, 1) .. (14, 9); route = (5, 5) }}"
    );
    let model = Draft::new("locked.scn", text.clone()).parse().unwrap();
    let result = one(&model, "estimate P(F<=4 s (distance(me, (5, 5)) < 0.6 m)) by fixed(trials = 64)");
    assert!((16..48).contains(&result.consumed.no_way), "{}", result.consumed.no_way);
    assert_eq!(result.consumed.counts.trials, 64);
    let place = crate::program::Place::new(&[
        ("locked.scn", text.as_str()),
        ("near.bltl", "estimate P(F<=4 s (distance(me, (5, 5)) < 0.6 m)) by fixed(trials = 64)"),
    ]);
    let said = place.call(&["check", "locked.scn", "near.bltl", "--format", "json"]).json();
    assert_eq!(said["results"][0]["no_way"], result.consumed.no_way);
    assert!(
        result.warnings.iter().any(|w| w.starts_with("somebody had no way to a goal in ")),
        "{:?}",
        result.warnings
    );
}

#[test]
fn a_way_around_the_outside_of_the_walls_is_named() {
    let corridor = "wall (0, 0) -- (12, 0)\nwall (0, 3) -- (12, 3)\nregion door: rect (11, 0.5) .. (12, 2.5)";
    let warnings = |more: &str, agent: &str| {
        let text = format!(
            "horizon = 4 s\nstep = 0.04 s\nscene {{ {corridor}\n{more} }}\nkind person: sfm preset smc1\n{agent}"
        );
        let options = Options::default().max_trials(8);
        let report = Model::parse(&text).unwrap().check("estimate P(F<=1 s (me in door))", &options).unwrap();
        report.warnings().to_string()
    };
    let me = "agent me: person { at = (3, 1.5); route = door }";
    let said = warnings("wall (10.5, 0) -- (10.5, 3)", me);
    let wanted = "the shortest way of `me` from its start to `door` leads around the outside of the walls: 17.02 m instead of 8 m";
    assert!(said.contains("W0803") && said.contains(wanted) && said.contains("model.scn:8:25"), "{said}");
    assert!(said.contains("close the open ends with walls"), "{said}");
    // From an area, at a corner of an obstacle, from goal to goal.
    let area = "agent me: person { at = uniform in rect (1, 1) .. (8, 2); route = door }";
    assert!(warnings("obstacle rect (10, 0) .. (10.5, 3)", area).contains("W0803"));
    let detour = "agent me: person { at = (9, 1.5); route = (9.5, 1.5) -> door }";
    assert!(warnings("wall (10.5, 0) -- (10.5, 3)", detour).contains("from (9.5, 1.5) m to `door`"));
    // A door in the wall; a way outside that is not much longer; a wall in the open; a goal outside.
    for (more, agent) in [
        ("wall (10.5, 0) -- (10.5, 1)\nwall (10.5, 2) -- (10.5, 3)", me),
        ("wall (2, 0) -- (2, 3)", "agent me: person { at = (0.5, 1.5); route = door }"),
        ("", "agent me: person { at = (6, -0.5); route = door }"),
        ("wall (10.5, 0) -- (10.5, 3)", "agent me: person { at = (9, 1.5); route = (14, 1.5) }"),
    ] {
        assert_eq!(warnings(more, agent), "", "{more} {agent}");
    }
}
