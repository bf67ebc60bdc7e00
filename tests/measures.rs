//! Measures of pedestrian dynamics: closed forms, a plain evaluation of the positions of whole trials in both layouts, and
//! `PedPy` where it is installed.

use crate::program::at_root;
use crate::texts::compiled;
use smc::base::geometry::{Segment, Shape, Vec2};
use smc::base::lanes::Mask;
use smc::base::random::TrialKey;
use smc::engine::outcome::Verdict;
use smc::kernel::{Address, Code, Program, Readings, Run};
use smc::{Model, Options};
use std::fmt::Write as _;
use std::process::{Command, Stdio};
use std::sync::Arc;

/// What is measured in each test of whole trials.
const MEASURES: [&str; 8] = [
    "crossings(door)",
    "crossings(far)",
    "flow(door, 1 s)",
    "mean_speed(hall)",
    "level_of_service(hall)",
    "dwell(crowd[1], hall)",
    "voronoi_density(hall)",
    "density(hall)",
];

/// A state as a recording shows it: who is present, where, with which speed.
type Seen = Vec<Option<(Vec2, f64)>>;

/// A trial of a scenario: what is seen in each of its states, and the values of some numbers, NaN where they have none.
fn watched(scenario: &str, numbers: &[&str], trial: u64) -> (Vec<Seen>, Vec<Vec<f64>>) {
    let queries = numbers.iter().fold(String::new(), |mut text, number| {
        let _ = writeln!(text, "estimate Q(0.5, max<=1 s ({number}))");
        text
    });
    let study = compiled(scenario, &queries).unwrap_or_else(|errors| panic!("{errors}"));
    let world = &study.worlds[0];
    let program = Program::new(Arc::clone(&world.scenario));
    let code = Code::compile(&world.scenario, &[], &world.signals);
    assert_eq!(world.signals.len(), numbers.len());
    // In its own lane, among other trials.
    let mut run = Run::new(&program);
    let lane = if run.width() == 1 { 0 } else { 3 };
    for other in 0..run.width() {
        let index = if other == lane { trial } else { 1000 + other as u64 };
        run.load(other, Address::from(TrialKey { seed: 7, index, branch: 0 })).unwrap();
    }
    run.begin(Mask((1u16 << run.width()).wrapping_sub(1) as u8));
    let (mut seen, mut values, mut readings) = (Vec::new(), Vec::new(), Readings::default());
    loop {
        let state = run.state();
        seen.push(
            (0..state.agents)
                .map(|agent| {
                    let slot = state.slot(agent, lane);
                    let of = |field: &[smc::base::lanes::Lanes]| field[slot.block].0[slot.lane];
                    let velocity = Vec2::new(of(&state.motion.vx), of(&state.motion.vy));
                    let at = Vec2::new(of(&state.motion.x), of(&state.motion.y));
                    state.present[slot.block].has(slot.lane).then(|| (at, velocity.norm()))
                })
                .collect(),
        );
        run.read(&code, run.close(), &mut readings);
        let missing = |k: usize| readings.missing.1.get(k).is_some_and(|lanes| lanes.has(lane));
        let value =
            |(k, lanes): (usize, &smc::base::lanes::Lanes)| if missing(k) { f64::NAN } else { lanes.0[lane] };
        values.push(readings.signals.iter().enumerate().map(value).collect());
        if run.end(lane).is_some() {
            return (seen, values);
        }
        run.advance();
    }
}

/// One number in all states.
fn series(scenario: &str, number: &str) -> Vec<f64> {
    watched(scenario, &[number], 0).1.iter().map(|row| row[0]).collect()
}

/// A walker along the first axis, without noise, in steps of 0.05 s.
fn alone(route: &str, scene: &str) -> String {
    format!(
        "horizon = 20 s\nstep = 0.05 s\nscene {{ {scene} }}\n\
         kind person: sfm preset helbing2000 {{ noise = 0 m/s; speed = 1 m/s }}\n\
         agent user: person {{ at = (0, 0); velocity = (1, 0) m/s; route = {route} }}\n"
    )
}

#[test]
fn a_walker_crosses_a_line_once_however_often_it_comes_by() {
    let there = series(&alone("(5, 0)", "line door: (2, -1) -- (2, 1)"), "crossings(door)");
    assert_eq!((there[0], there[39], there[42], there[400]), (0.0, 0.0, 1.0, 1.0));
    let back =
        series(&alone("(5, 0) -> (-2, 0) -> (5, 0)", "line door: (2, 1) -- (2, -1)"), "crossings(door)");
    assert_eq!(back.iter().copied().fold(0.0, f64::max), 1.0);
    let beside = series(&alone("(5, 0)", "line door: (2, 0.1) -- (2, 1)"), "crossings(door)");
    assert_eq!(beside[400], 0.0);
}

#[test]
fn a_flow_is_what_crossed_in_the_last_window_from_the_first_full_one_on() {
    let flow = series(&alone("(5, 0)", "line door: (2, -1) -- (2, 1)"), "flow(door, 4 s)");
    assert!(flow[..80].iter().all(|value| value.is_nan()));
    // Across after about 2 s, and so in the windows that end from 4 s to 6 s.
    assert_eq!((flow[80], flow[118], flow[122], flow[400]), (0.25, 0.25, 0.0, 0.0));
}

#[test]
fn times_in_a_region_add_up() {
    let text = alone("(5, 0) -> (-9, 0)", "region hall: rect (1, -1) .. (2, 1)");
    let dwell = series(&text, "dwell(user, hall)");
    assert_eq!((dwell[0], dwell[19]), (0.0, 0.0));
    assert!((dwell[100] - 1.0).abs() <= 0.05 + 1e-12, "{}", dwell[100]);
    assert!((dwell[400] - 2.0).abs() <= 0.15, "back through it: {}", dwell[400]);
    // Whole steps, exactly.
    assert!(dwell.iter().all(|time| (time / 0.05).round() * 1.0 / 20.0 == *time));
}

#[test]
fn a_line_counts_more_people_than_a_source_has_places() {
    let text = "horizon = 40 s\nstep = 0.05 s\nscene { line door: (2, -1) -- (2, 1); region out: rect (4, -1) .. (5, 1) }\n\
        kind person: sfm preset helbing2000 { noise = 0 m/s; speed = 1.5 m/s }\n\
        source gate: person { at = (0, 0); every = 2 s; limit = 4; route = out then leave }\n";
    let crossed = series(text, "crossings(door)");
    let last = crossed[crossed.len() - 1];
    assert!((17.0..=20.0).contains(&last), "{last}");
}

#[test]
fn nobody_in_a_region_is_no_reason_for_nan() {
    let text = alone("(5, 0)", "region hall: rect (50, 50) .. (51, 51)");
    let numbers = ["density(hall)", "voronoi_density(hall)", "mean_speed(hall)", "level_of_service(hall)"];
    let (_, values) = watched(&text, &numbers, 0);
    assert!(values.iter().all(|row| *row == [0.0, 0.0, 0.0, 1.0]));
}

#[test]
fn levels_of_service_follow_the_area_per_person() {
    // Five people at rest in regions of so many square metres.
    let areas = [(16.3, 1.0), (16.1, 2.0), (11.5, 3.0), (6.9, 4.0), (4.6, 5.0), (2.2, 6.0)];
    for (area, level) in areas {
        let text = format!(
            "horizon = 2 s\nstep = 0.05 s\nscene {{ region hall: rect (-0.1, -0.1) .. (3.9, {}) }}\n\
             kind person: sfm preset helbing2000 {{ noise = 0 m/s }}\n\
             agents crowd[5]: person {{ at = uniform in rect (0, 0) .. (3.8, 0.05); radius = 0.1 m }}\n",
            area / 4.0 - 0.1
        );
        assert_eq!(series(&text, "level_of_service(hall)")[0], level, "{area} m²");
    }
}

/// A crowd that goes to and fro between two sides of a hall.
fn crowd(people: usize) -> String {
    let half = people / 2;
    format!(
        "horizon = 8 s\nstep = 0.05 s\nscene {{ wall (-9, -6) -- (9, -6); wall (-9, 6) -- (9, 6) -- (9, -6)\n\
         line door: (0, -3) -- (1, 3); line far: (4, 6) -- (4, -6); region hall: rect (-2, -3) .. (3, 2.5)\n\
         region left: rect (-8, -5) .. (-5, 5); region right: rect (5, -5) .. (8, 5) }}\n\
         kind person: sfm preset helbing2000 {{ noise = 0.2 m/s; radius = 0.15 m }}\n\
         agents crowd[{half}]: person {{ at = uniform in rect (-8, -5.5) .. (8, 5.5); route = left -> right }}\n\
         agents others[{half}]: person {{ at = uniform in rect (-8, -5.5) .. (8, 5.5); route = right -> left then leave }}\n"
    )
}

#[test]
fn measures_of_whole_trials_are_those_of_their_positions() {
    let hall = Shape::rectangle(Vec2::new(-2.0, -3.0), Vec2::new(3.0, 2.5));
    let lines = [((0.0, -3.0), (1.0, 3.0)), ((4.0, 6.0), (4.0, -6.0))]
        .map(|((ax, ay), (bx, by))| Segment::new(Vec2::new(ax, ay), Vec2::new(bx, by)));
    // Eight trials side by side, and one large crowd.
    for people in [60, 300] {
        let (seen, values) = watched(&crowd(people), &MEASURES, 2);
        assert_eq!(seen.len(), 161);
        let mut first = [vec![None; people], vec![None; people]];
        let mut dwell = 0;
        for (state, (now, values)) in seen.iter().zip(&values).enumerate() {
            if state > 0 {
                let before = &seen[state - 1];
                for (line, first) in lines.iter().zip(&mut first) {
                    for agent in 0..people {
                        if let (Some((from, _)), Some((to, _))) = (before[agent], now[agent])
                            && line.meets(&Segment::new(from, to))
                        {
                            first[agent].get_or_insert(state);
                        }
                    }
                }
                dwell += usize::from(before[0].is_some_and(|(at, _)| hall.contains(at)));
            }
            let crossed =
                |k: usize, since: usize| first[k].iter().flatten().filter(|at| **at > since).count() as f64;
            let inside: Vec<f64> =
                now.iter().flatten().filter(|(at, _)| hall.contains(*at)).map(|(_, speed)| *speed).collect();
            let count = inside.len() as f64;
            assert_eq!(values[0], crossed(0, 0), "{people}, state {state}");
            assert_eq!(values[1], crossed(1, 0));
            if state < 20 {
                assert!(values[2].is_nan());
            } else {
                assert_eq!(values[2], crossed(0, state - 20));
            }
            let mean = if inside.is_empty() { 0.0 } else { inside.iter().sum::<f64>() / count };
            assert!((values[3] - mean).abs() < 1e-12);
            assert!((values[5] - dwell as f64 * 0.05).abs() < 1e-12);
            assert_eq!(values[7], count / hall.area());
        }
        assert!(first[0].iter().flatten().count() > 10, "some cross");
    }
}

#[test]
fn a_trial_that_is_shown_state_by_state_counts_as_it_did() {
    let text = crowd(40);
    let (seen, values) = watched(&text, &["crossings(door)", "dwell(crowd[1], hall)"], 0);
    let queries =
        "estimate Q(0.5, max<=1 s (crossings(door)))\nestimate Q(0.5, max<=1 s (dwell(crowd[1], hall)))\n";
    let study = compiled(&text, queries).unwrap();
    let world = &study.worlds[0];
    let program = Program::new(Arc::clone(&world.scenario));
    let code = Code::compile(&world.scenario, &[], &world.signals);
    let mut run = Run::given(&program, TrialKey { seed: 0, index: 0, branch: 0 }).unwrap();
    let mut readings = Readings::default();
    for (tick, (now, values)) in seen.iter().zip(&values).enumerate() {
        // Somebody who leaves is not seen in the state in which they do.
        run.show(tick as u64, |id| now[id.0 as usize].map(|(at, _)| (at, Vec2::zeros())));
        run.read(&code, None, &mut readings);
        let read: Vec<f64> = readings.signals.iter().map(|lanes| lanes.0[0]).collect();
        assert_eq!(read, *values, "state {tick}");
    }
}

/// The Python that has `PedPy`, if any: `SMC_PEDPY_PYTHON`, or `python3`.
pub(crate) fn python_with_pedpy() -> Option<String> {
    let python = std::env::var("SMC_PEDPY_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut asked = Command::new(&python);
    asked.args(["-c", "import pedpy"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    asked.status().is_ok_and(|status| status.success()).then_some(python)
}

#[test]
fn measures_are_those_of_pedpy() {
    let Some(python) = python_with_pedpy() else {
        println!("skipped: PedPy is not installed; set SMC_PEDPY_PYTHON to a Python that has it");
        return;
    };
    let place = tempfile::tempdir().unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/measures.py");
    let ways = [
        (crowd(80), "hall", "-9 -6 9 -6 9 6 -9 6"),
        (crowd(300), "hall", "-9 -6 9 -6 9 6 -9 6"),
        // A room with a door between walls without thickness; for PedPy they are 1e-11 m thick.
        (
            room(),
            "room",
            "0 0 6 0 6 2.5 6.00000000001 2.5 6.00000000001 0 12 0 12 6 6.00000000001 6 6.00000000001 3.5 6 3.5 6 6 0 6",
        ),
    ];
    for (text, name, area) in ways {
        let (seen, values) = watched(&text, &MEASURES, 1);
        let mut table = String::new();
        for (frame, (now, values)) in seen.iter().zip(&values).enumerate() {
            let values: Vec<String> = values.iter().map(f64::to_string).collect();
            for (id, (at, speed)) in now.iter().enumerate().filter_map(|(id, shown)| Some((id, (*shown)?))) {
                let _ = writeln!(table, "{frame} {id} {} {} {speed} {}", at.x, at.y, values.join(" "));
            }
        }
        let file = place.path().join("trial.txt");
        std::fs::write(&file, table).unwrap();
        let said = Command::new(&python).args([script, file.to_str().unwrap(), name, area]).output().unwrap();
        assert!(
            said.status.success(),
            "{}\n{}",
            String::from_utf8_lossy(&said.stdout),
            String::from_utf8_lossy(&said.stderr)
        );
        print!("{name}: {}", String::from_utf8_lossy(&said.stdout));
    }
}

/// Two rooms with a door between them.
fn room() -> String {
    "horizon = 12 s\nstep = 0.05 s\nscene { wall (6, 0) -- (6, 2.5); wall (6, 6) -- (6, 3.5)\n\
     wall (0, 0) -- (12, 0) -- (12, 6) -- (0, 6) -- (0, 0)\n\
     line door: (6, 2.5) -- (6, 3.5); line far: (9, 0) -- (9, 6); region hall: rect (4, 1.5) .. (7, 4.5)\n\
     region goal: rect (10, 1) .. (11.5, 5) }\n\
     kind person: sfm preset helbing2000 { noise = 0.1 m/s; radius = 0.15 m }\n\
     agents crowd[40]: person { at = uniform in rect (1, 0.3) .. (5.6, 5.7); route = goal }\n"
        .to_owned()
}

#[test]
fn a_flow_without_a_full_window_says_so() {
    let place = crate::program::Place::new(&[
        ("a.scn", &alone("(5, 0)", "line door: (2, -1) -- (2, 1)")),
        (
            "a.bltl",
            "check P(G<=10 s (flow(door, 4 s) <= 1 /s)) >= 0.5\ncheck P(G[4 s, 10 s] (flow(door, 4 s) <= 1 /s)) >= 0.5\n",
        ),
    ]);
    let json =
        place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "20"]).json();
    assert_eq!(json["results"][1]["unresolved"], 0);
    assert_eq!(json["results"][0]["unresolved"], json["results"][0]["trials"]);
    let said = json["results"][0].to_string();
    assert!(
        said.contains("a flow in `flow(door, 4 s) <= 1 /s` has no complete time window at 0 s"),
        "{said}"
    );
}

#[test]
fn the_model_of_a_door_shows_its_line() {
    let said = at_root(&["show", "models/door.scn"]);
    assert!(said.out.contains("line door: (8, 3.4) -- (8, 4.6) m"), "{}{}", said.out, said.err);
}

#[test]
fn the_time_of_a_leg_is_the_time_until_it_ends() {
    for step in ["0.02", "0.025", "0.04", "0.05", "0.1", "1 / 30"] {
        for way in [0.83, 1.13, 2.07, 3.59, 4.41] {
            let text = format!(
                "horizon = 10 s\nstep = {step} s\nkind k: sfm preset helbing2000 {{ radius = 0.2 m; speed = 1 m/s }}\n\
                 agent p: k {{ at = (0, 0); route = ({way}, 0) }}\n\
                 agent q: k {{ at = (0, 50); route = wait 0.6 s -> ({way}, 50) }}"
            );
            let queries = "check P(leg_time(p, 1) <= time_until(legs(p) >= 1)) >= 0.9\n\
                           check P(leg_time(p, 1) >= time_until(legs(p) >= 1)) >= 0.9\n\
                           check P(time_until(done(p)) <= leg_time(p, 1)) >= 0.9\n\
                           check P(time_until(done(q)) <= time_until(legs(q) >= 1)) >= 0.9\n";
            let model = Model::parse(&text.replace("1 / 30 s", "1 s / 30")).unwrap();
            let report = model.check(queries, &Options::default()).unwrap();
            for result in report.results() {
                assert_eq!(
                    result.verdict,
                    Some(Verdict::Satisfied),
                    "{} of {way} m, step {step}",
                    result.asked.text
                );
            }
        }
    }
}
