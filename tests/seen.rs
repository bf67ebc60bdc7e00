//! People who start as they were seen: whom `group of` names, bodies of groups, velocities, and what is refused.

use smc::base::geometry::Vec2;
use smc::model::{Parameter, Position, Scenario};
use smc::{Draft, Model};
use std::sync::Arc;

/// Two who walk east side by side, one who walks west, one who stands; every 0.5 s, with velocities that tell the next place.
const TABLE: &str = "time,id,x,y,vx,vy\n\
    0,1,0,0,1.2,0\n0,2,0,0.6,1.2,0\n0,3,9,0,-1,0\n0,4,5,5,0,0\n\
    0.5,1,0.5,0,1.2,0\n0.5,2,0.5,0.6,1.2,0\n0.5,3,8.5,0,-1,0\n0.5,4,5,5,0,0\n\
    1,1,1.2,0,1.4,0\n1,2,1.2,0.6,1.4,0\n1,3,8,0,-1,0\n1,4,5,5,0,0\n";

fn text(tracks: &str, people: &str) -> String {
    format!(
        "horizon = 2 s\nstep = 0.1 s\ntracks here = csv \"here.csv\" {tracks}\n\
         kind adult: sfm preset helbing2000 {{ radius = 0.25 m; noise = 0 m/s }}\n{people}\n"
    )
}

fn parse(tracks: &str, people: &str) -> Result<Model, smc::Diagnostics> {
    Draft::new("seen.scn", text(tracks, people)).file("here.csv", TABLE).parse()
}

fn scenario(tracks: &str, people: &str) -> Arc<Scenario> {
    parse(tracks, people).unwrap_or_else(|errors| panic!("{errors}")).scenario().clone()
}

fn refused(tracks: &str, people: &str) -> String {
    parse(tracks, people).expect_err(people).to_string()
}

fn place(scenario: &Scenario, agent: usize) -> Vec2 {
    match scenario.agents[agent].start.position {
        Position::Point(point) => point,
        ref other => panic!("{other:?}"),
    }
}

fn names(scenario: &Scenario) -> Vec<&str> {
    scenario.agents.iter().map(|agent| agent.name.as_str()).collect()
}

#[test]
fn group_of_names_all_who_walk_together() {
    let found = scenario(
        "",
        "agent user: adult from here at 1 s id 1\n\
         agents company: adult from here at 1 s group of 1 except 1\n\
         agents strangers: adult from here at 1 s except group of 2",
    );
    assert_eq!(names(&found), ["user", "company[1]", "strangers[1]", "strangers[2]"]);
    assert_eq!(place(&found, 1), Vec2::new(1.2, 0.6));
    assert_eq!(place(&found, 2), Vec2::new(8.0, 0.0));
    // Who walks alone has no company: a set of nobody is legal.
    let alone = scenario("", "agents company: adult from here at 1 s group of 3 except 3");
    assert!(alone.agents.is_empty());
}

#[test]
fn a_party_is_one_body_at_the_mean_of_its_members() {
    let found = scenario(
        "{ velocity = recorded }",
        "group party: adult as particle from here at 1 s group of 1\n\
         groups crowd: adult as particle from here at 1 s except group of 1",
    );
    assert_eq!(names(&found), ["party", "crowd[1]", "crowd[2]"]);
    let party = &found.agents[0];
    assert!((place(&found, 0) - Vec2::new(1.2, 0.3)).norm() < 1e-12);
    assert!((party.start.velocity - Vec2::new(1.4, 0.0)).norm() < 1e-12);
    assert_eq!(party.body[Parameter::Speed].constant(), Some(1.4));
    let particle = party.particle.unwrap();
    // Both stand 0.3 m from their middle: 0.3 + 0.25 m is more than 0.25 m times the root of 2.
    assert_eq!(particle.persons, 2);
    assert!((particle.radius(0.25) - 0.55).abs() < 1e-12);
    assert!((particle.radius(1.0) - 2.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(found.agents[1].particle.unwrap().persons, 1);
    // A radius of its own is the radius of the body.
    let own = scenario("", "group party: adult as particle from here at 1 s group of 1 { radius = 0.4 m }");
    assert_eq!(own.agents[0].particle.unwrap().radius(0.4), 0.4);
}

/// Person 2 walks at 1.0 m/s here, the companion at 1.4 m/s.
#[test]
fn laws_are_those_around_the_mean_of_companions() {
    let table = TABLE.replace("1,2,1.2,0.6,1.4,0", "1,2,1.2,0.6,1.0,0");
    let wanted = |people: &str| {
        let text = text("{ velocity = recorded }", people);
        let model = Draft::new("seen.scn", text).file("here.csv", table.as_str()).parse();
        let found = model.unwrap_or_else(|errors| panic!("{errors}")).scenario().clone();
        let driving = |agent: &smc::model::Agent| (agent.start.driving().x * 1e9).round() / 1e9;
        found.agents.iter().map(driving).collect::<Vec<_>>()
    };
    let law = "{ heading = recorded + normal(0 deg, 5 deg) }";
    // Whoever is declared alone wants the mean of both, who walks alone and who stands what was seen.
    let user = "agent user: adult from here at 1 s id 1";
    assert_eq!(
        wanted(&format!("{user} {law}\nagents others: adult from here at 1 s except 1 {law}")),
        [1.2, 1.2, -1.0, 0.0]
    );
    assert_eq!(
        wanted(&format!("{user} {law}\ngroups others: adult from here at 1 s except 1 {law}")),
        [1.2, 1.2, -1.0, 0.0]
    );
    // Without a law everybody goes on.
    assert_eq!(
        wanted(&format!("{user}\nagents others: adult from here at 1 s except 1")),
        [1.4, 1.0, -1.0, 0.0]
    );
}

/// The middle of a party that passes a post on both sides is near it or in it.
#[test]
fn a_party_beside_a_barrier_is_no_wider_than_its_distance() {
    let party = "group party: adult as particle from here at 1 s group of 1";
    let beside = |distance: f64| {
        format!("scene {{ obstacle post: circle ({}, 0.3) radius 0.05 m }}\n{party}", 1.25 + distance)
    };
    for (distance, radius) in [(0.2, 0.25), (0.35, 0.35), (0.7, 0.55)] {
        let found = scenario("", &beside(distance));
        assert!((found.agents[0].particle.unwrap().radius(0.25) - radius).abs() < 1e-12, "{distance}");
    }
    // Whose middle lies in the barrier, or nearly, starts beside it.
    let found = scenario("", &beside(0.05));
    let start = found.agents[0].start.position.clone();
    let Position::Point(at) = start else { panic!("{start:?}") };
    let room = (at - Vec2::new(1.3, 0.3)).norm() - 0.05;
    assert!((0.25..0.2501).contains(&room), "{room}");
}

#[test]
fn without_one_body_members_of_each_group_attract_each_other() {
    let found = scenario("", "groups crowd: adult from here at 1 s { attraction = 30 N }");
    assert_eq!(names(&found), ["crowd[1]", "crowd[2]", "crowd[3]", "crowd[4]"]);
    let groups: Vec<(&str, usize)> =
        found.groups.iter().map(|group| (group.name.as_str(), group.members.len())).collect();
    assert_eq!(groups, [("crowd[1]", 2), ("crowd[2]", 1), ("crowd[3]", 1)]);
    let both = scenario("", "group friends: adult from here at 1 s id 1, 3 { attraction = 30 N }");
    assert_eq!((both.groups.len(), both.groups[0].members.len()), (1, 2));
}

#[test]
fn velocities_are_recorded_or_seen_and_remembered() {
    let speed = |tracks: &str| {
        let found = scenario(tracks, "agent user: adult from here at 1 s id 1");
        let start = &found.agents[0].start;
        (start.velocity.x, start.driving().x)
    };
    let near = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() < 1e-12 && (b - d).abs() < 1e-12;
    assert!(near(speed(""), (1.4, 1.4)));
    assert!(near(speed("{ velocity = recorded }"), (1.4, 1.4)));
    // From 0.5 m to 1.2 m in 0.5 s.
    assert!(near(speed("{ velocity = seen }"), (1.4, 1.4)), "{:?}", speed("{ velocity = seen }"));
    // The mean of the last second.
    assert!(near(speed("{ velocity = seen; memory = 1 s }"), (1.4, 1.2)));
    // The track is not older than a second.
    assert!(near(speed("{ memory = 9 s }"), (1.4, 1.2)));
    let first = scenario("{ velocity = seen }", "agent user: adult from here at 0 s id 1");
    assert_eq!(first.agents[0].start.velocity, Vec2::zeros(), "nobody knows yet how fast it is");
}

#[test]
fn whoever_goes_on_keeps_the_remembered_velocity() {
    let model = parse("{ memory = 1 s }", "agent user: adult from here at 1 s id 1")
        .unwrap_or_else(|e| panic!("{e}"));
    let last = model.trial(0, 0).unwrap().last().unwrap();
    let user = last.agent("user").unwrap();
    assert!((user.velocity.x - 1.2).abs() < 0.01, "{}", user.velocity);
}

#[test]
fn moves_may_belong_to_one_body() {
    let moves = "moves party for 1 s { heading -30 deg; heading 30 deg; stop }";
    let party = format!("group party: adult as particle from here at 1 s group of 1\n{moves}");
    assert_eq!(scenario("", &party).moves[0].options.len(), 4);
    let many = format!("groups party: adult as particle from here at 1 s\n{moves}");
    assert!(refused("", &many).contains("moves must belong to one agent"));
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let user = "agent user: adult from here at 1 s id 1";
    for (tracks, people, said) in [
        ("{ velocity = fast }", user, "`velocity` must be `seen` or `recorded`"),
        ("{ memory = -1 s }", user, "`memory` cannot be negative"),
        ("{ memory = 1 m }", user, "error"),
        ("{ memry = 1 s }", user, "did you mean `memory`"),
        ("{ memory = 1 s; memory = 2 s }", user, "`memory` is set twice"),
        (
            "",
            "group party[2]: adult as particle from here at 1 s id 1, 2",
            "determines the number of members",
        ),
        ("", "group party: adult as particle", "the number of members of `party` is missing"),
        ("", "group party: adult as particle from here at 1 s group of 9", "person 9 was not recorded"),
        ("", "agents a: adult from here at 1 s id 1, 1", "person 1 is listed twice"),
        (
            "",
            "agents a: adult from here at 1 s group of 1\nagents b: adult from here at 1 s id 2",
            "person 2 of `here` is already used",
        ),
        ("", "group party: adult from here at 1 s id 1, 2 { at = (0, 0) }", "unknown field `at`"),
    ] {
        let found = refused(tracks, people);
        assert!(found.contains(said), "{people}\n{found}");
    }
    let stream = "horizon = 2 s\nstep = 0.1 s\ntracks here = stream\nkind adult: sfm preset helbing2000 {}\n\
                  agent user: adult from here at 0 s id 1";
    let found = Model::parse(stream).expect_err("a stream").to_string();
    assert!(found.contains("only `smc advise` can read"), "{found}");
    let format = "horizon = 2 s\nstep = 0.1 s\ntracks here = trajnett \"here.csv\"\nkind adult: sfm preset helbing2000 {}\n\
                  agent user: adult from here at 0 s id 1";
    let found =
        Draft::new("a.scn", format).file("here.csv", TABLE).parse().expect_err("a format").to_string();
    assert!(found.contains("did you mean `trajnet`"), "{found}");
}

/// The nearest rim is in one direction, so both are moved to the same point.
#[test]
fn people_who_are_moved_to_one_point_start_side_by_side() {
    let start = |scene: &str, table: &str| {
        let source = format!("scene {{ {scene} }}\n{}", text("", "agents all: adult from here at 0 s"));
        let model = Draft::new("seen.scn", source).file("here.csv", table).parse();
        let model = model.unwrap_or_else(|errors| panic!("{scene}\n{errors}"));
        let said = model.warnings().to_string();
        let places: Vec<Vec2> =
            (0..model.scenario().agents.len()).map(|k| place(model.scenario(), k)).collect();
        assert!(model.trial(0, 0).is_ok(), "{scene}");
        (places, said)
    };
    let table = |places: &[(f64, f64)]| {
        let rows = places.iter().enumerate().map(|(k, (x, y))| format!("0,{},{x},{y}\n", k + 1));
        format!("time,id,x,y\n{}", rows.collect::<String>())
    };
    let pair = table(&[(2.0, 0.3), (2.0, 0.2)]);
    for scene in [
        "obstacle bench: rect (0, 0) .. (4, 3)",
        "obstacle post: circle (2, 1) radius 1 m",
        "obstacle bench: rect (0, 0) .. (4, 3)\nwall (1.6, -2) -- (1.6, 0)\nwall (2.4, -2) -- (2.4, 0)",
    ] {
        let (places, said) = start(scene, &pair);
        let apart = (places[0] - places[1]).norm();
        assert!((0.1..0.6).contains(&apart) && places.iter().all(|p| p.y < 0.0), "{scene} {places:?}");
        assert!(said.contains("`all[2]` was at the place of `all[1]`"), "{said}");
    }
    // Recorded at one point, without any barrier; and no wall is between them.
    let (places, _) = start("wall (2.1, -9) -- (2.1, 9)", &table(&[(1.9, 0.0), (1.9, 0.0), (1.9, 0.0)]));
    assert!(places.iter().all(|p| p.x < 2.1), "{places:?}");
    assert!((places[1] - places[2]).norm() > 0.1, "{places:?}");
}
