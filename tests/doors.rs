//! Doors that open and close during a trial: one test for each of their rows in the table on buildings in
//! `docs/semantics.md`.

use smc::base::geometry::Vec2;
use smc::engine::outcome::QueryResult;
use smc::{Model, Options};

/// Two rooms with a wall in between and a door in it; `more` people of another kind stand far away.
fn rooms(door: &str, rest: &str) -> Model {
    let text = format!(
        "horizon = 30 s\nstep = 0.04 s
        scene {{
          wall (0, 0) -- (10, 0) -- (10, 6) -- (0, 6) -- (0, 0)
          wall (5, 0) -- (5, 6)
          door main: (5, 2) -- (5, 4) {{ {door} }}
          region right: rect (6, 1) .. (9, 5)
        }}
        kind person: sfm preset smc2
        kind blind: person {{ wayfinding = straight }}\n{rest}"
    );
    Model::parse(&text).unwrap_or_else(|errors| panic!("{errors}"))
}

const ONE: &str = "agent me: person { at = (2, 3); route = right }";

fn check(model: &Model, query: &str, threads: usize) -> QueryResult {
    let options = Options::default().threads(threads);
    model.check(query, &options).unwrap_or_else(|errors| panic!("{errors}")).results()[0].clone()
}

/// Where somebody is at each state of a trial.
fn walk(model: &Model, trial: u64, name: &str) -> Vec<(f64, Vec2)> {
    let states = model.trial(0, trial).unwrap();
    states.filter_map(|s| s.agent(name).map(|a| (s.time, Vec2::new(a.position.x, a.position.y)))).collect()
}

/// When somebody is first beyond the door, s.
fn passes(walk: &[(f64, Vec2)]) -> Option<f64> {
    walk.iter().find(|(_, at)| at.x > 5.0).map(|(time, _)| *time)
}

#[test]
fn until_it_opens_a_door_is_a_wall_and_then_none() {
    // Somebody who goes straight, whatever is in the way, moves as in the scene that never changes.
    let blind = ONE.replace("person", "blind");
    let walks = |door: &str| walk(&rooms(door, &blind), 0, "me");
    let (opens, closes) = (walks("opens = 8 s"), walks("closes = 1 s"));
    let same = |one: &[(f64, Vec2)], other: &[(f64, Vec2)], until: f64| {
        let shared = one.iter().zip(other).take_while(|(a, b)| a == b).count();
        assert!((until - 0.1..until + 0.5).contains(&one[shared].0), "{}", one[shared].0);
    };
    same(&opens, &walks("closed = true"), 8.0);
    assert!((8.0..10.0).contains(&passes(&opens).unwrap()));
    // The wall of the door is felt from its closing on.
    same(&closes, &walks("closed = false"), 1.0);
    assert_eq!(passes(&closes), None);
    assert_eq!(passes(&walks("closes = 12 s")), passes(&walks("closed = false")));
}

#[test]
fn whoever_has_no_way_waits_before_a_closed_door() {
    let found = walk(&rooms("opens = 10 s", ONE), 0, "me");
    let at = |time: f64| found.iter().find(|(t, _)| *t >= time).unwrap().1;
    assert!((at(9.9) - Vec2::new(5.0, 3.0)).norm() < 1.2, "{}", at(9.9));
    assert!((10.0..11.5).contains(&passes(&found).unwrap()));
}

#[test]
fn ways_are_found_anew_when_a_door_changes() {
    let text = |door: &str| {
        format!(
            "horizon = 40 s\nstep = 0.04 s
            scene {{
              wall (0, 0) -- (20, 0) -- (20, 6) -- (0, 6) -- (0, 0)
              wall (0, 3) -- (20, 3)
              door near: (5, 3) -- (6.5, 3) {{ {door} }}
              door far: (17, 3) -- (18.5, 3)
              region goal: rect (1, 4) .. (4, 5.5)
            }}
            kind person: sfm preset smc2
            agent me: person {{ at = (10, 1.5); route = goal }}"
        )
    };
    let turn = |door: &str| {
        let found = walk(&Model::parse(&text(door)).unwrap(), 0, "me");
        let least = found.iter().take_while(|(_, at)| at.y < 3.0).map(|(_, at)| at.x).fold(20.0, f64::min);
        let crosses = found.iter().find(|(_, at)| at.y > 3.0).unwrap().1.x;
        (least, crosses)
    };
    assert!(turn("").1 < 7.0);
    // It closes on the way to it, and another way is taken at once.
    let (least, crosses) = turn("closes = 1.5 s");
    assert!((7.0..9.9).contains(&least) && crosses > 16.9, "{least} {crosses}");
    let (_, crosses) = turn("opens = 2 s");
    assert!(crosses < 7.0, "{crosses}");
}

#[test]
fn times_are_drawn_in_each_trial_and_results_are_the_same_at_any_number_of_threads() {
    // Eight trials share a batch, and their doors open at different times.
    let model = rooms("opens = uniform(1 s, 20 s)", ONE);
    let query = "estimate P(F<=12 s (crossings(main) == 1)) by fixed(trials = 24)";
    let found = check(&model, query, 1);
    for threads in [2, 8] {
        assert_eq!(check(&model, query, threads).consumed.counts, found.consumed.counts);
    }
    let times: Vec<f64> = (0..24).map(|trial| passes(&walk(&model, trial, "me")).unwrap()).collect();
    let early = times.iter().filter(|time| **time <= 12.0).count() as u64;
    assert_eq!(found.consumed.counts.successes, early);
    assert!((6..20).contains(&early), "{times:?}");
    // Closed from a time on that comes before the one at which it opens.
    let twice = rooms("closes = uniform(0 s, 1 s); opens = 9 s", ONE);
    assert!((9.0..11.0).contains(&passes(&walk(&twice, 0, "me")).unwrap()));
}

#[test]
fn one_large_crowd_has_the_doors_of_a_small_one() {
    let crowd =
        format!("{ONE}\nagents others[260]: person {{ at = uniform in rect (60, -40) .. (120, 40) }}");
    for door in ["opens = 6 s", "closes = 3 s", "closed = time < 7 s"] {
        let (few, many) = (walk(&rooms(door, ONE), 0, "me"), walk(&rooms(door, &crowd), 0, "me"));
        assert_eq!(few.len(), many.len());
        for ((_, one), (time, other)) in few.iter().zip(&many) {
            assert!((one - other).norm() < 1e-9, "{door} at {time} s: {one} {other}");
        }
    }
}

#[test]
fn a_process_closes_a_door() {
    let model = rooms(
        "closed = alarm.on",
        &format!("{ONE}\nprocess alarm {{ var on = true; when on at 0.2 /s -> on = false }}"),
    );
    let query = "estimate P(F<=30 s (crossings(main) == 1 & alarm.on)) by fixed(trials = 20)";
    assert_eq!(check(&model, query, 1).consumed.counts.successes, 0);
    let query = "estimate P(F<=20 s (crossings(main) == 1)) by fixed(trials = 20)";
    assert!(check(&model, query, 1).consumed.counts.successes > 12);
}

#[test]
fn a_body_in_the_doorway_keeps_it_open() {
    let model = rooms(
        "closes = 5 s",
        "scene { point sill: (5.2, 3) }
        agent first: person { at = (2, 3); route = sill -> wait 8 s -> right }
        agent last: person { at = (1, 1); premovement = 15 s; route = right }",
    );
    let first = walk(&model, 0, "first");
    let stands = |time: f64| (5.0..10.0).contains(&time);
    assert!(first.iter().filter(|(time, _)| stands(*time)).all(|(_, at)| (at.x - 5.0).abs() < 0.15));
    assert!(first.last().unwrap().1.x > 6.0);
    assert_eq!(passes(&walk(&model, 0, "last")), None);
}

#[test]
fn what_formulas_measure_knows_the_closed_doors() {
    let model = rooms("opens = 10 s", "agent me: person { at = (4, 3) }");
    for query in ["P(G<=8 s (clearance(me) < 1 m))", "P(G<=20 s (time < 11 s | clearance(me) > 1 m))"] {
        let found = check(&model, &format!("estimate {query} by fixed(trials = 2)"), 1);
        assert_eq!(found.consumed.counts.successes, 2, "{query}");
    }
}

#[test]
fn a_door_that_no_trial_sees_open_is_closed() {
    let query = "estimate P(F<=30 s (crossings(main) == 1)) by fixed(trials = 2)";
    let shut = rooms("opens = 31 s", ONE);
    let errors = shut.check(query, &Options::default()).unwrap_err().to_string();
    assert!(errors.contains("E0803"), "{errors}");
    assert_eq!(check(&rooms("closes = 31 s", ONE), query, 1).consumed.counts.successes, 2);
}
