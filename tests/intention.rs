//! What recorded people want: laws of heading and speed around the recorded ones, destinations, and what is refused.

use smc::base::geometry::Vec2;
use smc::{Draft, Model};

/// One walks east at 1 m/s, one north at 0.5 m/s, one stands.
const TABLE: &str = "time,id,x,y\n0,1,0,0\n0,2,50,0\n0,3,90,0\n1,1,1,0\n1,2,50,0.5\n1,3,90,0\n";
const PLACES: &str = "101 0\n1 100\n-99 0\n";

/// Without forces and noise everybody soon has the velocity that they want.
fn parse(people: &str, places: Option<&str>) -> Result<Model, smc::Diagnostics> {
    let text = format!(
        "horizon = 4 s\nstep = 0.1 s\ntracks here = csv \"a/here.csv\" {{ velocity = seen }}\n\
         kind adult: sfm preset helbing2000 {{ A = 0 N; k1 = 0 kg/s^2; k2 = 0 kg/(m s); noise = 0 m/s; tau = 0.1 s }}\n{people}\n"
    );
    let draft = Draft::new("here.scn", text).file("a/here.csv", TABLE);
    match places {
        Some(places) => draft.file("a/destinations.txt", places).parse(),
        None => draft.parse(),
    }
}

/// Velocities of the agents at the end of trials.
fn ends(people: &str, places: Option<&str>, trials: u64) -> Vec<Vec<Vec2>> {
    let model = parse(people, places).unwrap_or_else(|errors| panic!("{errors}"));
    let end = |index| {
        let last = model.trial(1, index).unwrap().last().unwrap();
        last.agents.iter().map(|agent| agent.velocity).collect()
    };
    (0..trials).map(end).collect()
}

/// Mean and standard deviation.
fn moments(all: &[f64]) -> (f64, f64) {
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    (mean, (all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt())
}

#[test]
fn heading_and_speed_have_their_laws_around_the_recorded_ones() {
    let found = ends(
        "agents all: adult from here at 1 s {\n heading = recorded + normal(0 deg, 12 deg)\n\
         speed = recorded * normal(1, 0.15) in 0 m/s .. 3 m/s\n}",
        None,
        400,
    );
    for (agent, ahead, speed) in [(0, 0.0, 1.0), (1, std::f64::consts::FRAC_PI_2, 0.5)] {
        let turns: Vec<f64> =
            found.iter().map(|all| (all[agent].y.atan2(all[agent].x) - ahead).to_degrees()).collect();
        let (mean, sd) = moments(&turns);
        // The standard errors are 0.6 and 0.42 degrees.
        assert!(mean.abs() < 2.4 && (sd - 12.0).abs() < 1.7, "{mean} and {sd} of {agent}");
        let speeds: Vec<f64> = found.iter().map(|all| all[agent].norm() / speed).collect();
        let (mean, sd) = moments(&speeds);
        // The standard errors are 0.0075 and 0.0053.
        assert!((mean - 1.0).abs() < 0.03 && (sd - 0.15).abs() < 0.022, "{mean} and {sd} of {agent}");
    }
    assert!(found.iter().all(|all| all[2] == Vec2::new(0.0, 0.0)), "who stands has no intention");
}

/// In the open the wanted speed is the recorded one; between others a share of what is missing to the speed of the kind is
/// added, which Weidmann's diagram takes at the density around; in a jam it is the speed of the kind.
#[test]
fn wanted_is_what_the_recorded_speed_and_the_density_around_tell() {
    let speed = |spacing: f64| {
        let row = |time: f64, id: u32| format!("{time},{id},{},{}\n", 0.3 * time, spacing * f64::from(id));
        let rows = (0..2).flat_map(|time| (0..11).map(move |id| row(f64::from(time), id)));
        let table = format!("time,id,x,y\n{}", rows.collect::<String>());
        let text = "horizon = 1 s\nstep = 0.1 s\ntracks here = csv \"a/here.csv\" { velocity = seen }\n\
                    kind adult: sfm preset helbing2000 { speed = 1.4 m/s; A = 0 N; radius = 0.01 m; tau = 0.01 s }\n\
                    agents all: adult from here at 1 s { speed = wanted }\n";
        let model = Draft::new("here.scn", text).file("a/here.csv", table).parse();
        let model = model.unwrap_or_else(|errors| panic!("{errors}"));
        model.trial(1, 0).unwrap().last().unwrap().agents[5].velocity.x
    };
    // The fifth nearest of the one in the middle is three places off.
    let density = |spacing: f64| 5.0 / (std::f64::consts::PI * 9.0 * spacing * spacing);
    let left = |density: f64| 1.0 - (-1.913 * (1.0 / density - 1.0 / 5.4)).exp();
    let wanted = |spacing: f64| 0.3 + (1.0 - left(density(spacing))) * 1.1;
    assert!((speed(30.0) - 0.3).abs() < 1e-6, "{}", speed(30.0));
    assert!((speed(0.4) - wanted(0.4)).abs() < 1e-6, "{} is not {}", speed(0.4), wanted(0.4));
    assert!((0.5..1.3).contains(&wanted(0.4)));
    assert!((speed(0.1) - 1.4).abs() < 1e-6, "{}", speed(0.1));
}

#[test]
fn companions_share_a_heading_and_a_speed() {
    let laws =
        "heading = recorded + normal(0 deg, 12 deg); speed = recorded * normal(1, 0.15) in 0 m/s .. 3 m/s";
    let alone = format!("agents all: adult from here at 1 s id 1, 2 {{ {laws} }}");
    let together = format!("group all: adult from here at 1 s id 1, 2 {{ {laws} }}");
    let found = ends(&together, None, 50);
    assert!(found.iter().all(|all| (all[0] - all[1]).norm() < 1e-9), "one velocity a trial");
    // Their mean is that of 1 m/s east and 0.5 m/s north.
    let mean = found.iter().map(|all| all[0]).sum::<Vec2>() / 50.0;
    assert!((mean - Vec2::new(0.5, 0.25)).norm() < 0.08, "{mean}");
    assert!(found.iter().any(|all| (all[0] - found[0][0]).norm() > 0.05), "another in each trial");
    assert!(ends(&alone, None, 50).iter().all(|all| (all[0] - all[1]).norm() > 0.1));
}

/// After a second nobody is where people without laws are.
#[test]
fn people_without_laws_are_warned_of_where_a_formula_looks_ahead() {
    let warns = |fields: &str, seconds: &str| {
        let people = format!("agents all: adult from here at 1 s {{ {fields} }}");
        let query = format!("estimate P(F<={seconds} (travelled(all[1]) > 1 m)) by fixed(trials = 1)");
        let report = parse(&people, None).unwrap().check(&query, &smc::Options::default()).unwrap();
        report.warnings().iter().any(|one| one.code == smc::syntax::codes::Code::W0706)
    };
    let laws = "heading = recorded + normal(0 deg, 12 deg); speed = wanted * uniform(0.8, 1.2)";
    assert!(warns("", "2 s") && !warns("", "1 s"));
    assert!(!warns(laws, "2 s"));
    assert!(!warns("heading = recorded + normal(0 deg, 12 deg)", "2 s"));
}

#[test]
fn a_field_more_changes_no_draw_of_the_others() {
    let heading = "heading = recorded + normal(0 deg, 12 deg)";
    let speed = "speed = recorded * uniform(0.8, 1.2)";
    let user = |fields: &str| format!("agent user: adult from here at 1 s id 1 {{ {fields} }}\n");
    let other = format!("agent other: adult from here at 1 s id 2 {{ {heading}; {speed} }}");
    let none = ends(&(user("") + &other), None, 8);
    let one = ends(&(user(heading) + &other), None, 8);
    let both = ends(&(user(&format!("{speed}; {heading}")) + &other), None, 8);
    for k in 0..8 {
        assert!((none[k][0] - Vec2::new(1.0, 0.0)).norm() < 1e-12, "unset, everything is as recorded");
        assert_eq!(none[k][1], one[k][1]);
        assert_eq!(none[k][1], both[k][1]);
        let angle = |v: Vec2| v.y.atan2(v.x);
        assert!((angle(one[k][0]) - angle(both[k][0])).abs() < 1e-9, "the speed does not change the heading");
        assert!((one[k][0].norm() - 1.0).abs() < 1e-9, "the heading does not change the speed");
        assert_ne!(one[k][0], none[k][0]);
    }
}

#[test]
fn destinations_are_drawn_with_their_weights() {
    let people = "agents all: adult from here at 1 s { route = destinations(here, 1) }";
    let found = ends(people, Some(PLACES), 600);
    // East, north and west of the first, who walks east.
    let weights = [1f64.exp(), 1.0, (-1f64).exp()];
    let total: f64 = weights.iter().sum();
    let ways = [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0), Vec2::new(-1.0, 0.0)];
    for (weight, way) in weights.iter().zip(ways) {
        let there = |all: &&Vec<Vec2>| all[0].dot(&way) > 0.9 * all[0].norm();
        let (share, wanted) = (found.iter().filter(there).count() as f64 / 600.0, weight / total);
        assert!(
            (share - wanted).abs() < 4.0 * (wanted * (1.0 - wanted) / 600.0).sqrt(),
            "{share} of {wanted}"
        );
    }
    let two = found.iter().filter(|all| all[0].x > 0.5 && all[1].x > 0.1).count();
    assert!(two > 0 && two < 600, "each has a goal of its own");
}

#[test]
fn fields_that_say_nothing_of_intentions_are_refused() {
    let refused = |fields: &str, places: Option<&str>| {
        let people = format!("agents all: adult from here at 1 s {{ {fields} }}");
        parse(&people, places).expect_err(fields).to_string()
    };
    let all = [
        refused("heading = recorded + normal(0 m, 1 m)", None),
        refused("heading = 30 deg", None),
        refused("heading = recorded + normal(0 deg, 3 deg) in -9 deg .. 9 deg", None),
        refused("speed = recorded + 1 m/s", None),
        refused("speed = recorded * normal(1, 0.15)", None),
        refused("route = destinations(there)", Some(PLACES)),
        refused("route = destinations(here, -1)", Some(PLACES)),
        refused("route = destinations(here)", Some("\n")),
        refused("route = destinations(here)", Some("1 2\n3\n")),
        refused("route = destinations(here)", Some("1 0\n")),
        refused("route = destinations(here); heading = recorded + normal(0 deg, 3 deg)", Some(PLACES)),
    ];
    insta::assert_snapshot!(all.join("\n"));
    let fixed = "agent user: adult { at = (0, 0); speed = recorded * 2 }";
    assert!(parse(fixed, None).expect_err("no recording").to_string().contains("`recorded`"));
}
