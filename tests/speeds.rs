//! The collision-free speed model: against its formulas written plainly, against `JuPedSim`, and what it promises.

use smc::base::geometry::Vec2;
use smc::{Draft, Model};
use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// A step, s.
const STEP: f64 = 0.01;
const STEPS: usize = 200;

/// Somebody: where they start, where they go, and how fast they want to, m/s.
#[derive(Clone, Copy, Debug)]
struct Person {
    at: Vec2,
    to: Vec2,
    speed: f64,
}

/// People on a floor with walls.
struct Scene {
    name: &'static str,
    outline: Vec<Vec2>,
    holes: Vec<Vec<Vec2>>,
    /// Whether the outline is a wall; else it is far away.
    is_walled: bool,
    people: Vec<Person>,
}

fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

fn rectangle(x: f64, y: f64) -> Vec<Vec2> {
    vec![p(-x, -y), p(x, -y), p(x, y), p(-x, y)]
}

/// `count` places in a rectangle, no two nearer than 0.45 m: those of a lattice that a seed moves.
fn places(count: usize, (low, high): (Vec2, Vec2), seed: u64) -> Vec<Vec2> {
    let mut state = seed;
    let mut share = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut found: Vec<Vec2> = Vec::new();
    while found.len() < count {
        let at = p(low.x + (high.x - low.x) * share(), low.y + (high.y - low.y) * share());
        if found.iter().all(|other| (other - at).norm() > 0.45) {
            found.push(at);
        }
    }
    found
}

fn scenes() -> Vec<Scene> {
    let far = || rectangle(100.0, 100.0);
    let person = |at: Vec2, to: Vec2, speed: f64| Person { at, to, speed };
    let file = (0..8).map(|k| person(p(0.8 * f64::from(k), 0.0), p(80.0, 0.0), 1.2 - 0.05 * f64::from(k)));
    let crossing = places(12, (p(-3.0, -3.0), p(3.0, 3.0)), 1);
    let corridor = places(16, (p(0.5, -1.1), p(9.5, 1.1)), 2);
    let room = places(12, (p(-2.5, -2.5), p(2.5, 2.5)), 3);
    let above = places(12, (p(-5.0, 0.75), p(5.0, 2.1)), 4);
    let below = places(12, (p(-5.0, -2.1), p(5.0, -0.75)), 5);
    let sides = above.into_iter().chain(below).enumerate();
    vec![
        Scene {
            name: "a single file",
            outline: far(),
            holes: Vec::new(),
            is_walled: false,
            people: file.collect(),
        },
        Scene {
            name: "a crossing",
            outline: far(),
            holes: Vec::new(),
            is_walled: false,
            people: crossing
                .into_iter()
                .map(|at| person(at, p(-20.0 * at.x, 1.0 - 20.0 * at.y), 1.3))
                .collect(),
        },
        Scene {
            name: "a corridor",
            outline: rectangle(60.0, 1.5),
            holes: Vec::new(),
            is_walled: true,
            people: corridor
                .into_iter()
                .enumerate()
                .map(|(k, at)| {
                    let to = if k % 2 == 0 { p(55.0, 0.0) } else { p(-55.0, 0.0) };
                    person(at, to, 1.0 + 0.05 * k as f64)
                })
                .collect(),
        },
        Scene {
            name: "a room",
            outline: rectangle(3.0, 3.0),
            holes: Vec::new(),
            is_walled: true,
            people: room
                .into_iter()
                .map(|at| person(at, p(0.3 * at.x, if at.y < 0.0 { 2.5 } else { -2.5 }), 1.2))
                .collect(),
        },
        Scene {
            name: "two sides of a block",
            outline: rectangle(40.0, 2.5),
            holes: vec![rectangle(30.0, 0.5)],
            is_walled: true,
            people: sides
                .map(|(k, at)| person(at, p(if k % 3 == 0 { -38.0 } else { 38.0 }, at.y), 1.34))
                .collect(),
        },
    ]
}

impl Scene {
    /// The walls, piece by piece.
    fn walls(&self) -> Vec<[Vec2; 2]> {
        let outline = if self.is_walled { Some(&self.outline) } else { None };
        let rings = outline.into_iter().chain(&self.holes);
        rings.flat_map(|ring| (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]])).collect()
    }

    fn text(&self) -> String {
        let mut text = format!("horizon = {} s\nstep = {STEP} s\nscene {{\n", STEP * STEPS as f64);
        for [a, b] in self.walls() {
            let _ = writeln!(text, "wall ({}, {}) -- ({}, {})", a.x, a.y, b.x, b.y);
        }
        text += "}\nkind one: preset cfs2 { wayfinding = straight }\n";
        for (k, Person { at, to, speed }) in self.people.iter().enumerate() {
            let (x, y) = (at.x, at.y);
            let _ = writeln!(
                text,
                "agent a{k}: one {{ at = ({x}, {y}); speed = {speed} m/s; route = ({}, {}) }}",
                to.x, to.y
            );
        }
        text
    }

    /// The places of all people, state by state from the first one on.
    fn simulated(&self) -> Vec<Vec<Vec2>> {
        let model = Model::parse(&self.text()).unwrap();
        let states = model.trial(0, 0).unwrap();
        states.map(|state| state.agents.iter().map(|agent| agent.position).collect()).collect()
    }
}

/// Whether two pieces of lines cross.
fn cross([a, b]: [Vec2; 2], [c, d]: [Vec2; 2]) -> bool {
    let side = |p: Vec2, q: Vec2, r: Vec2| ((q - p).perp(&(r - p))).signum();
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// The velocities of the model, equation by equation: `a = 8`, `D = 0.1 m`, walls 5 and 0.02 m, `T = 1 s`, radii of 0.2 m.
fn velocities(people: &[Person], at: &[Vec2], walls: &[[Vec2; 2]]) -> Vec<Vec2> {
    let one = |i: usize| {
        let sees = |j: &usize| {
            *j != i
                && (at[*j] - at[i]).norm() <= 3.0
                && !walls.iter().any(|wall| cross([at[i], at[*j]], *wall))
        };
        let seen: Vec<usize> = (0..at.len()).filter(sees).collect();
        let mut way = (people[i].to - at[i]).normalize();
        for j in &seen {
            let between = at[i] - at[*j];
            way += between.normalize() * 8.0 * ((0.4 - between.norm()) / 0.1).exp();
        }
        for [a, b] in walls {
            let along = (b - a).normalize();
            let foot = a + along * (at[i] - a).dot(&along).clamp(0.0, (b - a).norm());
            let between = at[i] - foot;
            way += between.normalize() * 5.0 * ((0.2 - between.norm()) / 0.02).exp();
        }
        let way = way.normalize();
        let ahead = seen
            .iter()
            .map(|j| at[*j] - at[i])
            .filter(|between| between.dot(&way) >= 0.0 && between.perp(&way).abs() <= 0.4);
        let room = ahead.map(|between| between.norm() - 0.4).fold(f64::INFINITY, f64::min);
        way * room.max(0.0).min(people[i].speed)
    };
    (0..at.len()).map(one).collect()
}

#[test]
fn people_move_by_the_equations_of_the_model() {
    for scene in scenes() {
        let (walls, found) = (scene.walls(), scene.simulated());
        let mut at: Vec<Vec2> = scene.people.iter().map(|person| person.at).collect();
        assert_eq!(found.len(), STEPS + 1);
        for (step, now) in found.iter().enumerate() {
            for (k, (one, wanted)) in now.iter().zip(&at).enumerate() {
                let off = (one - wanted).norm();
                assert!(off < 1e-9, "{}: a{k} is {off} m off in state {step}", scene.name);
            }
            let go = velocities(&scene.people, &at, &walls);
            at = at.iter().zip(go).map(|(at, v)| at + v * STEP).collect();
        }
    }
}

/// The Python that has `JuPedSim`, if any: `SMC_JUPEDSIM_PYTHON`, or `python3`.
fn python_with_jupedsim() -> Option<String> {
    let python = std::env::var("SMC_JUPEDSIM_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut asked = Command::new(&python);
    asked.args(["-c", "import jupedsim"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    asked.status().is_ok_and(|status| status.success()).then_some(python)
}

#[test]
fn people_move_as_in_jupedsim() {
    let Some(python) = python_with_jupedsim() else {
        println!("skipped: JuPedSim is not installed; set SMC_JUPEDSIM_PYTHON to a Python that has it");
        return;
    };
    for scene in scenes() {
        let ring = |ring: &Vec<Vec2>| ring.iter().map(|at| [at.x, at.y]).collect::<Vec<_>>();
        let people: Vec<_> =
            scene.people.iter().map(|one| [one.at.x, one.at.y, one.to.x, one.to.y, one.speed]).collect();
        let asked = serde_json::json!({
            "outline": ring(&scene.outline),
            "holes": scene.holes.iter().map(ring).collect::<Vec<_>>(),
            "agents": people,
            "steps": STEPS,
            "dt": STEP,
        });
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/speeds.py");
        let mut child =
            Command::new(&python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(asked.to_string().as_bytes()).unwrap();
        let said = child.wait_with_output().unwrap();
        let wanted: Vec<Vec<[f64; 2]>> = serde_json::from_slice(&said.stdout).unwrap();
        let found = scene.simulated();
        for (step, (now, wanted)) in found.iter().skip(1).zip(&wanted).enumerate() {
            for (k, (one, [x, y])) in now.iter().zip(wanted).enumerate() {
                let off = (one - p(*x, *y)).norm();
                assert!(off < 1e-9, "{}: a{k} is {off} m off after {} steps", scene.name, step + 1);
            }
        }
    }
}

/// A crowd in a room with a door, in which most people cannot go as they want to.
const CROWD: &str = "horizon = 8 s\nstep = 0.02 s\n\
    scene { wall (0, 0) -- (10, 0) -- (10, 2.4); wall (10, 3.6) -- (10, 6) -- (0, 6) -- (0, 0) }\n\
    kind slow: preset cfs2 { speed = uniform(0.5 m/s, 1.5 m/s) }\n\
    agents people[60]: slow { at = uniform in rect (1, 0.5) .. (9, 5.5); route = (14, 3) }\n";

#[test]
fn nobody_is_faster_than_they_want_to_be_or_goes_backwards() {
    let model = Model::parse(CROWD).unwrap();
    let properties = "check P(G<=8 s (forall a in people: speed(a) <= 1.5 m/s)) >= 0.9\n";
    let report = model.check(properties, &smc::Options::default().max_trials(40)).unwrap();
    assert_eq!(report.results()[0].estimate, Some(1.0));
    for index in 0..4 {
        let mut last: Option<Vec<Vec2>> = None;
        for state in model.trial(7, index).unwrap() {
            let now: Vec<Vec2> = state.agents.iter().map(|agent| agent.position).collect();
            // The velocity of a state is that of the step which follows it: never against the way that is gone.
            for (agent, before) in state.agents.iter().zip(last.iter().flatten()) {
                let gone = (agent.position - before) / 0.02;
                assert!(gone.norm() <= 1.5 + 1e-9, "{} m/s", gone.norm());
            }
            last = Some(now);
        }
    }
}

#[test]
fn trials_of_the_model_have_the_same_bits_alone_and_beside_others() {
    // With 60 people a trial fills the lanes, with 8 it is one of eight: forces move some of them.
    for count in [8, 60] {
        let text = CROWD.replace("people[60]", &format!("people[{count}]")).replace(
            "agents people",
            "kind pushed: preset smc1\nagent other: pushed { at = (0.5, 0.5); route = (14, 3) }\nagents people",
        );
        let properties =
            "estimate E(mean(speed(a) for a in everyone) at end) in 0 m/s .. 2 m/s within 0.3 m/s";
        let model = Model::parse(&text).unwrap();
        let results = |threads: usize| {
            let options = smc::Options::default().seed(3).threads(threads).max_trials(40);
            let report = model.check(properties, &options).unwrap();
            report.results()[0].estimate.unwrap().to_bits()
        };
        assert_eq!(results(1), results(3));
    }
}

#[test]
fn noise_has_the_deviation_that_is_asked_for() {
    // Far apart and at rest: all that moves people is the noise.
    let text = "horizon = 4 s\nstep = 0.02 s\nkind one: preset cfs2 { noise = 0.2 m/s; speed = 1 m/s }\n\
        agents people[60]: one { at = uniform in rect (0, 0) .. (2000, 2000); route = (9000, 1000) }\n";
    let model = Draft::new("noise.scn", text).parse().unwrap();
    let mut sum = (0.0, 0.0);
    for index in 0..20 {
        let end = model.trial(1, index).unwrap().last().unwrap();
        for agent in &end.agents {
            let along = (p(9000.0, 1000.0) - agent.position).normalize();
            let across = agent.velocity.perp(&along);
            sum = (sum.0 + across * across, sum.1 + 1.0);
        }
    }
    let deviation = f64::sqrt(sum.0 / sum.1);
    // 1200 draws: the standard error is 0.004.
    assert!((deviation - 0.2).abs() < 0.016, "{deviation}");
}
