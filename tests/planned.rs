//! Walkers that plan: one test for each row of the table in `docs/semantics.md`, and what is refused.

use smc::base::geometry::{Shape, Vec2};
use smc::base::random::{Purpose, Stream, TrialKey};
use smc::kernel::{Program, Run};
use smc::model::{AgentId, Barrier, Goal, Obstacle, Parameter, Region, Route, Scenario, Scene, SpeedRule};
use smc::route::path::{round, shortcut};
use smc::route::planner::{Outline, Speeds, Wish};
use smc::route::roadmap::{FreeSpace, Prm, Roadmap, Sampler, SamplingRule, shortest};
use smc::route::{Atlas, Ways};
use smc::{Model, Options};
use std::sync::Arc;

/// A field with a block in the middle; the goal lies behind it.
const FIELD: &str = "
horizon = 60 s
step = 0.04 s
scene {
  region start: rect (0, 0) .. (2, 10)
  region half:  rect (20, 14) .. (23, 17)
  region goal:  rect (38, 0) .. (40, 10)
  obstacle block: rect (15, 1) .. (25, 9)
}
";

/// Little to wait for, and far from the block.
const KIND: &str = "kind planner: planned {
  limit speed = uniform(1.2 m/s, 1.8 m/s)
  roadmap = prm(samples = 200, sampling = uniform, separation = 1 m, clearance = 3 m)
}
";

fn model(text: &str) -> Model {
    Model::parse(text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn field(rest: &str) -> Model {
    model(&format!("{FIELD}{KIND}{rest}"))
}

/// Where an agent is and its velocity, state by state.
fn track(model: &Model, trial: u64, name: &str) -> Vec<(Vec2, Vec2)> {
    let states = model.trial(3, trial).unwrap_or_else(|errors| panic!("{errors}"));
    states
        .filter_map(|state| state.agent(name).map(|a| (a.position, a.velocity)))
        .map(|(p, v)| (Vec2::new(p.x, p.y), Vec2::new(v.x, v.y)))
        .collect()
}

/// The first plan of an agent in a trial, its speeds, and where it starts.
fn first_plan(
    scenario: &Arc<Scenario>,
    trial: u64,
    agent: u32,
    path: Option<u32>,
) -> Option<(Outline, Speeds)> {
    let ways = Ways::default();
    let key = TrialKey { seed: 3, index: trial, branch: 0 };
    let program = Program::driven(scenario.clone(), ways.drivers(scenario, 3));
    let (run, _) = Run::of(&program, key.into()).unwrap_or_else(|_| panic!("no start"));
    let state = run.state();
    let slot = state.slot(agent as usize, 0);
    let of = |parameter: Parameter| state.bodies[parameter][slot.block].0[slot.lane];
    let at = Vec2::new(state.motion.x[slot.block].0[slot.lane], state.motion.y[slot.block].0[slot.lane]);
    let Route::Legs { legs, .. } = &scenario.agents[agent as usize].route else { return None };
    let speeds = Speeds::new(of, of(Parameter::Speed), SpeedRule::Varied);
    let wish = Wish {
        scenario,
        agent: AgentId(agent),
        address: (key, scenario.agents[agent as usize].entity, 0),
        motion: (at, Vec2::zeros()),
        legs,
        speeds,
        path,
    };
    Some((ways.walkers(scenario, 3).outline(&wish)?, speeds))
}

#[test]
fn who_is_alone_walks_the_plan_within_its_limits() {
    let model = field("agent me: planner { at = uniform in start; route = goal }");
    for trial in 0..8 {
        let (outline, speeds) = first_plan(model.scenario(), trial, 0, None).unwrap();
        let course = outline.course.unwrap();
        let track = track(&model, trial, "me");
        let mut farthest: f64 = 0.0;
        for (k, (position, _)) in track.iter().enumerate() {
            let motion = course.motion(k as f64 * 0.04);
            farthest = farthest.max((position - course.path.at(motion.distance).position).norm());
        }
        assert!(farthest < 0.02, "trial {trial}: {farthest} m");
        let limits = speeds.limits;
        for pair in track.windows(2) {
            let (v, w) = (pair[0].1, pair[1].1);
            assert!(w.norm() <= 1.02 * limits.speed, "{}", w.norm());
            let (a, middle) = ((w - v) / 0.04, 0.5 * (v + w));
            if middle.norm() > 0.05 {
                let along = a.dot(&middle) / middle.norm();
                let across = (a.norm_squared() - along * along).max(0.0).sqrt();
                let used = (along / limits.along).powi(2) + (across / limits.across).powi(2);
                assert!(used <= 1.02 * 1.02, "{used}");
            }
        }
        let last = track.last().unwrap();
        assert!(last.1.norm() < 0.01 && last.0.x > 38.0, "{last:?}");
    }
}

#[test]
fn a_goal_is_a_free_point_drawn_in_its_region() {
    let model = field("agent me: planner { at = (1, 5); route = goal }");
    let ends: Vec<Vec2> = (0..20)
        .map(|trial| {
            let (outline, speeds) = first_plan(model.scenario(), trial, 0, None).unwrap();
            let end = *outline.corners.last().unwrap();
            let r = speeds.radius;
            assert!(end.x >= 38.0 + r && end.x <= 40.0 - r && end.y >= r && end.y <= 10.0 - r, "{end:?}");
            end
        })
        .collect();
    let mean = ends.iter().sum::<Vec2>() / 20.0;
    // Uniform: the mean of 20 is within 4 standard errors of the middle.
    assert!((mean.y - 5.0).abs() < 4.0 * 2.74 / 20.0_f64.sqrt(), "{mean:?}");
}

#[test]
fn one_plan_leads_through_goals_and_rests_at_a_pause() {
    let through = field("agent me: planner { at = (1, 5); route = half -> goal }");
    let (outline, _) = first_plan(through.scenario(), 0, 0, None).unwrap();
    let course = outline.course.unwrap();
    // It passes the first goal without a stop, and the second one begins when the first has been reached.
    assert!((10..90).all(|k| course.motion(course.duration() * f64::from(k) / 100.0).speed > 0.2));
    let walked = track(&through, 0, "me");
    assert!(walked.iter().any(|(p, _)| p.x > 20.0 && p.x < 23.0 && p.y > 14.0 && p.y < 17.0));
    assert!(walked.last().unwrap().0.x > 38.0);
    let pausing = field("agent me: planner { at = (1, 5); route = half -> wait 6 s -> goal }");
    let walked = track(&pausing, 0, "me");
    let rests = walked.iter().filter(|(p, v)| v.norm() < 0.01 && p.x > 20.0 && p.x < 23.0).count();
    // At rest for most of the 6 s: the time counts from where the region is entered.
    assert!(rests > 50, "{rests} states");
    assert!(walked.last().unwrap().0.x > 38.0, "{:?}", walked.last());
}

#[test]
fn a_preferred_speed_follows_the_largest_one() {
    let model = field("agents me[20]: planner { at = uniform in start; route = goal }");
    let program = Program::driven(model.scenario().clone(), Ways::default().drivers(model.scenario(), 1));
    let key = TrialKey { seed: 1, index: 0, branch: 0 };
    let (run, _) = Run::of(&program, key.into()).unwrap_or_else(|_| panic!("no start"));
    for agent in 0..20 {
        let slot = run.state().slot(agent, 0);
        let of = |parameter: Parameter| run.state().bodies[parameter][slot.block].0[slot.lane];
        let (speed, limit) = (of(Parameter::Speed), of(Parameter::LimitSpeed));
        assert!((speed - 0.85 * limit).abs() < 1e-12, "{speed} {limit}");
    }
}

#[test]
fn a_behaviour_changes_the_pace_of_the_plan() {
    let slow = "behaviour tired { state fresh { after 4 s -> tired }; state tired { speed = 0.5 * speed } }";
    let calm = "profile = optimal; speed = 1.2 m/s";
    let kind = KIND.replace("roadmap", &format!("{calm}; roadmap"));
    let arrival = |behaviour: &str, with: &str| {
        let rest = format!("{behaviour}\nagent me: planner {with} {{ at = (1, 5); route = goal }}");
        let track = track(&model(&format!("{FIELD}{kind}{rest}")), 0, "me");
        track.iter().position(|(p, _)| p.x > 30.0).unwrap() as f64 * 0.04
    };
    let (usual, tired) = (arrival("", ""), arrival(slow, "with tired"));
    // All but the first 4 s take twice as long.
    assert!((tired - (2.0 * usual - 4.0)).abs() < 0.5, "{usual} {tired}");
}

#[test]
fn who_is_pushed_off_the_plan_makes_another_one() {
    // A heading for 5 s leads away from the plan.
    let model = field(
        "agent me: planner { at = (1, 5); route = goal }
         moves me for 5 s { heading 90 deg; heading 0 deg }",
    );
    let report = model
        .check("rank moves of me by P(F<=60 s (me in goal)) within 0.2", &Options::default().max_trials(200))
        .unwrap_or_else(|errors| panic!("{errors}"));
    let rank = report.results()[0].rank.as_ref().unwrap();
    assert!(rank.options.iter().all(|option| option.value.estimate > 0.9), "{rank:?}");
}

#[test]
fn others_change_neither_the_roadmap_nor_the_draws_of_anybody() {
    let alone = field("agent me: planner { at = (1, 1); route = goal }");
    let far = "kind other: planned { limit speed = 1 m/s }
        agents others[3]: other { at = near me within 9 m; route = half }";
    let among = field(&format!(
        "agent me: planner {{ at = (1, 1); route = goal }}\n{far}\npaths me {{ roadmap alternatives 3 }}"
    ));
    let plan = |model: &Model| first_plan(model.scenario(), 5, 0, None).unwrap().0;
    let (a, b) = (plan(&alone), plan(&among));
    assert_eq!(a.terrain.roadmap.vertices(), b.terrain.roadmap.vertices());
    assert_eq!(a.corners, b.corners);
    assert_eq!(a.course.unwrap().samples(), b.course.unwrap().samples());
}

/// Three ways lead past two blocks in a row.
const BLOCKS: &str = "
horizon = 90 s
step = 0.04 s
scene {
  region start: rect (0, 8) .. (2, 12)
  region goal:  rect (28, 8) .. (30, 12)
  obstacle lower: rect (10, 2) .. (20, 9)
  obstacle upper: rect (10, 11) .. (20, 18)
  wall (-1, -1) -- (31, -1) -- (31, 21) -- (-1, 21) -- (-1, -1)
}
kind planner: planned { limit speed = 1.5 m/s; roadmap = prm(samples = 300) }
agents people[2]: planner { at = uniform in start; route = goal }
paths people[1] { roadmap alternatives 9 }
";

#[test]
fn paths_of_different_classes_are_ranked_and_the_shortest_wins_a_tie() {
    let model = model(BLOCKS);
    let scenario = model.scenario();
    let found = Ways::default().paths(scenario, 3, AgentId(0), 9);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found.windows(2).all(|pair| pair[0].length <= pair[1].length));
    // Each path keeps its class from wherever the walker starts: where it passes x = 15.
    let row = |path: u32, trial: u64| {
        let course = first_plan(scenario, trial, 0, Some(path)).unwrap().0.course.unwrap();
        let length = course.path.length();
        let all = (0..400).map(|k| course.path.at(length * f64::from(k) / 400.0).position);
        all.min_by(|a, b| (a.x - 15.0).abs().total_cmp(&(b.x - 15.0).abs())).unwrap().y
    };
    let side = |y: f64| {
        if y < 2.0 {
            0
        } else if y > 18.0 {
            2
        } else {
            1
        }
    };
    for path in 0..3 {
        let sides: Vec<i32> = (0..5).map(|trial| side(row(path, trial))).collect();
        assert!(sides.iter().all(|one| *one == sides[0]), "path {path}: {sides:?}");
    }
    let query = "rank paths of people[1] by P(F<=90 s (people[1] in goal)) within 0.1";
    let report =
        model.check(query, &Options::default().seed(3).max_trials(2_000)).unwrap_or_else(|e| panic!("{e}"));
    let result = &report.results()[0];
    let rank = result.rank.as_ref().unwrap();
    assert_eq!(rank.options.len(), 3);
    assert!(rank.choice.as_ref().unwrap().starts_with("path 1 ("), "{rank:?}");
    assert_eq!(result.asked.given.as_deref(), Some("the roadmap of planner, seed 3"));
}

#[test]
fn who_is_too_wide_has_no_way_and_a_closed_goal_is_an_error() {
    // Bodies wider than 99.9 % of the law have no roadmap: here, than 0.69 m.
    let wide = BLOCKS.replace("{ limit speed", "{ radius = exponential(0.1 m); limit speed");
    let model_of_wide = model(&wide);
    let scenario = model_of_wide.scenario();
    let Route::Legs { legs, .. } = &scenario.agents[0].route else { panic!("legs") };
    let fits = |radius: f64| {
        let of = |parameter: Parameter| if parameter == Parameter::Radius { radius } else { 2.0 };
        let wish = Wish {
            scenario,
            agent: AgentId(0),
            address: (TrialKey::default(), 1, 0),
            motion: (Vec2::new(1.0, 10.0), Vec2::zeros()),
            legs,
            speeds: Speeds::new(of, 1.0, SpeedRule::Varied),
            path: None,
        };
        Ways::default().walkers(scenario, 3).outline(&wish).is_some()
    };
    assert!(fits(0.3) && !fits(0.8));
    let closed = BLOCKS.replace("wall (-1", "wall (25, -1) -- (25, 21)\n  wall (-1");
    let error = model(&closed)
        .check("check P(F<=9 s (people[1] in goal)) >= 0.5", &Options::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("E0803") && error.contains("no way leads"), "{error}");
}

#[test]
fn a_roadmap_without_vertices_is_a_warning() {
    let text = format!("{FIELD}{KIND}agent me: planner {{ at = (1, 5); route = goal }}");
    let sparse = text.replace("separation = 1 m", "separation = 500 m");
    let options = Options::default().max_trials(10);
    let report = model(&sparse).check("estimate P(F<=60 s (me in goal))", &options);
    let said = report.unwrap_or_else(|errors| panic!("{errors}")).warnings().to_string();
    assert!(
        said.contains("W0802") && said.contains("the roadmap of `planner` has only one vertex"),
        "{said}"
    );
}

/// A block that reaches the rim of the box around barriers, regions and points.
const AT_THE_RIM: &str = "horizon = 60 s
step = 0.04 s
scene {
  obstacle block: rect (8, -2) .. (12, 4)
  region start: rect (0, 0) .. (2, 2)
  region goal: rect (18, 0) .. (20, 2)
}
kind walker: planned { limit speed = 1.5 m/s }
agent ann: walker { at = uniform in start; route = goal }
";

#[test]
fn a_roadmap_that_leads_nowhere_is_an_error_with_its_box_and_a_point_widens_it() {
    let query = "estimate P(F<=60 s (ann in goal))";
    let options = Options::default().max_trials(20);
    let error = model(AT_THE_RIM).check(query, &options).unwrap_err().to_string();
    assert!(error.contains("E0803"), "{error}");
    assert!(
        error.contains("no path on the roadmap of `walker`, seed 0, leads `ann` from its start to `goal`"),
        "{error}"
    );
    assert!(
        error.contains("the box (0, -2) .. (20, 4) m around all barriers, regions and points"),
        "{error}"
    );
    let wider = AT_THE_RIM.replace("scene {", "scene {\n  point beyond: (10, 9)");
    let report = model(&wider).check(query, &options).unwrap_or_else(|errors| panic!("{errors}"));
    assert!(!report.warnings().to_string().contains("roadmap"), "{}", report.warnings());
    assert_eq!(report.results()[0].consumed.counts.successes, 20);
}

#[test]
fn a_ranking_of_paths_needs_a_goal() {
    let aimless = AT_THE_RIM.replace("; route = goal }", " }\npaths ann { roadmap alternatives 2 }");
    let error = model(&aimless)
        .check("rank paths of ann by P(F<=9 s (ann in goal)) within 0.1", &Options::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("E0803") && error.contains("`ann` has no goal to which paths could lead"),
        "{error}"
    );
}

/// Ten blocks in a field of 30 m by 30 m.
fn blocks(number: u32) -> Scene {
    let stream = Stream::of(TrialKey { seed: 5, ..TrialKey::default() }, number, Purpose::Test);
    let block = |k: u32| {
        let ([x, y], [w, h]) = (stream.uniform_pair(2 * k), stream.uniform_pair(2 * k + 1));
        let low = Vec2::new(4.0 + 18.0 * x, 2.0 + 22.0 * y);
        let size = Vec2::new(0.5 + 3.5 * w, 0.5 + 3.5 * h);
        Barrier { name: String::new(), obstacle: Obstacle::Solid(Shape::rectangle(low, low + size)) }
    };
    let all = Region::new("all", Shape::rectangle(Vec2::zeros(), Vec2::new(30.0, 30.0)));
    Scene { barriers: (0..10).map(block).collect(), regions: vec![all], ..Scene::default() }
}

#[test]
fn shortened_paths_are_hardly_longer_than_the_shortest_ways() {
    let mut longer = Vec::new();
    for number in 0..100 {
        let scene = blocks(number);
        let free = FreeSpace::new(&scene, 0.25);
        let prm = Prm { samples: 500, sampling: SamplingRule::Bridge, separation: 0.5, neighbours: 6 };
        let stream = Stream::of(TrialKey { seed: 6, ..TrialKey::default() }, number, Purpose::Test);
        let roadmap = Roadmap::draw(&free, &Sampler::Prm(prm), stream);
        let (from, to) = (Vec2::new(1.0, 15.0), Vec2::new(29.0, 15.0));
        let exact = Atlas::new(scene.clone()).way(from, &Goal::Point(to), 0.25).unwrap().length;
        let path = shortest(&roadmap, &free, from, to).unwrap();
        let length = |points: &[Vec2]| -> f64 { points.windows(2).map(|w| (w[1] - w[0]).norm()).sum() };
        let short = shortcut(&path, |a, b| free.is_clear(a, b), length);
        // No point of the rounded path is nearer to a barrier than the radius.
        for piece in round(&short, 1.5, 0.25, free.sight()).pieces() {
            let distances = free.sight().pieces().iter().map(|barrier| piece.distance_to(barrier));
            assert!(distances.fold(f64::INFINITY, f64::min) >= 0.25 - 1e-8, "scene {number}");
        }
        longer.push(length(&short) / exact);
    }
    longer.sort_by(f64::total_cmp);
    assert!(longer[0] >= 1.0 - 1e-9 && longer[50] < 1.03, "{} {}", longer[0], longer[50]);
}

#[test]
fn wrong_kinds_and_paths_are_refused_with_a_place_and_a_hint() {
    let start = "horizon = 9 s\nstep = 0.04 s\nscene { region goal: rect (8, 0) .. (9, 1) }\n";
    let cases = [
        ("kind k: planned { }; agent a: k { at = (0, 0) }", "`k` has no limit speed"),
        (
            "kind k: planned { limit speed = 0 m/s }; agent a: k { at = (0, 0) }",
            "`limit speed` must be positive",
        ),
        ("kind k: planned { limit speed = 1 m/s; limit acceleration = -1 m/s^2 }", "must be positive"),
        ("kind k: planned { limit speed = 1 m/s; pieces = 1 }", "a whole number from 2 to 64"),
        ("kind k: planned { limit speed = 1 m/s; pieces = uniform(2, 5) }", "a whole number from 2 to 64"),
        ("kind k: planned { limit speed = 1 m/s; pieces = 0.4 }", "less than 2 for each metre"),
        ("kind k: planned { limit speed = 1 m/s; pieces = 3 /m }", "less than 2 for each metre"),
        ("kind k: planned { limit speed = 1 m/s; pieces = uniform(-1 /m, 1 /m) }", "`pieces` must be"),
        ("kind k: planned { limit speed = 1 m/s; pieces = 0.4 /s }", "expected"),
        ("kind k: planned { limit speed = 1 m/s; rounding = half }", "`shared` or `half_edges`"),
        ("kind k: planned { limit speed = 1 m/s; avoid = rvo }", "`rvo`"),
        ("kind k: planned { limit speed = 1 m/s; roadmap = prm(sample = 5) }", "unknown argument of `prm`"),
        ("kind k: planned { limit speed = 1 m/s; roadmap = prm(samples = 1) }", "from 2 to 100000"),
        ("kind k: planned { limit speed = 1 m/s; roadmap = rrt(samples = 9) }", "`rrt` has no root"),
        ("kind k: planned { limit speed = 1 m/s; roadmap = grid(samples = 9) }", "unknown roadmap `grid`"),
        ("kind k: planned { limit speed = 1 m/s; profile = fast }", "`varied`, `optimal` or `uniform`"),
        ("kind k: planned { limit speed = 1 m/s; wayfinding = straight }", "unknown parameter `wayfinding`"),
        ("kind k: sfm preset helbing2000 { profile = optimal }", "unknown parameter `profile`"),
        ("kind k: planned { limit speed = 1 m/s; avoid = sfm preset helbing }", "unknown preset `helbing`"),
        (
            "kind k: planned { limit speed = 1 m/s }; group g[2]: k as particle { at = (0, 0) }",
            "cannot move `as particle`",
        ),
        (
            "kind k: sfm preset helbing2000; agent a: k { at = (0, 0) }; paths a { roadmap alternatives 3 }",
            "does not plan",
        ),
        (
            "kind k: planned { limit speed = 1 m/s }; agents a[2]: k { at = uniform in goal }; paths a { roadmap alternatives 3 }",
            "paths must belong to one agent",
        ),
        (
            "kind k: planned { limit speed = 1 m/s }; agent a: k { at = (0, 0) }; paths a { roadmap alternatives 0 }",
            "a whole number from 1 to 64",
        ),
    ];
    for (text, said) in cases {
        let text = format!("{start}{text}");
        let text = if text.contains("agent") || text.contains("group") {
            text
        } else {
            format!("{text}\nagent a: k {{ at = (0, 0) }}")
        };
        match Model::parse(&text) {
            Ok(_) => panic!("{text} is accepted"),
            Err(errors) => {
                let found = errors.to_string();
                assert!(found.contains(said), "{text}\n{found}");
                assert_eq!(found.matches("error[").count(), 1, "{text}\n{found}");
            }
        }
    }
}

#[test]
fn a_goal_may_be_a_point() {
    let model = field("agent me: planner { at = (1, 5); route = (30, 12) }");
    let last = track(&model, 0, "me").last().unwrap().0;
    assert!((last - Vec2::new(30.0, 12.0)).norm() < 0.15, "{last:?}");
    let Route::Legs { legs, .. } = &model.scenario().agents[0].route else { panic!("legs") };
    assert!(matches!(&legs[0], smc::model::Leg::To(Goal::Point(_))));
}

#[test]
fn reciprocal_avoidance_keeps_four_who_cross_apart() {
    let crossing = |avoid: &str| {
        model(&format!(
            "horizon = 20 s
            step = 0.04 s
            scene {{
              region around: rect (-1, -6) .. (11, 6)
              point east: (10, 0)
              point west: (0, 0)
              point north: (5, 5)
              point south: (5, -5)
            }}
            kind k: planned {{ radius = 0.25 m; limit speed = 1.5 m/s; profile = optimal; avoid = {avoid} }}
            agent a: k {{ at = (0, 0); route = east }}
            agent b: k {{ at = (10, 0); route = west }}
            agent c: k {{ at = (5, -5); route = north }}
            agent d: k {{ at = (5, 5); route = south }}"
        ))
    };
    let names = ["a", "b", "c", "d"];
    let found = crossing("orca");
    let tracks = names.map(|name| track(&found, 0, name));
    let mut least = f64::INFINITY;
    for k in 0..tracks[0].len() {
        for (i, one) in tracks.iter().enumerate() {
            for other in &tracks[i + 1..] {
                least = least.min((one[k].0 - other[k].0).norm());
            }
        }
    }
    assert!(least > 0.49, "{least}");
    let ends = [Vec2::new(10.0, 0.0), Vec2::new(0.0, 0.0), Vec2::new(5.0, 5.0), Vec2::new(5.0, -5.0)];
    for (walk, end) in tracks.iter().zip(ends) {
        assert!((walk.last().unwrap().0 - end).norm() < 0.6, "{:?}", walk.last());
        // Out of the way by half a metre or so, not by metres.
        let way: f64 = walk.windows(2).map(|pair| (pair[1].0 - pair[0].0).norm()).sum();
        assert!(way < 11.5, "{way} m");
    }
}

#[test]
fn longer_plans_have_more_pieces_unless_their_number_is_set() {
    let knots = |pieces: &str, metres: u32| {
        let text = format!(
            "horizon = 60 s
            step = 0.04 s
            scene {{ region around: rect (-1, -3) .. (61, 3); point goal: ({metres}, 0) }}
            kind k: planned {{ limit speed = 1.5 m/s; {pieces} }}
            agent a: k {{ at = (0, 0); route = goal }}"
        );
        let place = crate::program::Place::new(&[("m.scn", &text)]);
        let json = place.call(&["path", "m.scn", "--format", "json"]).json();
        json["paths"][0]["knots"]["x"].as_array().unwrap().len() - 1
    };
    assert_eq!([10, 30, 60].map(|metres| knots("", metres)), [4, 13, 25]);
    assert_eq!([10, 30].map(|metres| knots("pieces = 0.2 /m", metres)), [2, 6]);
    assert_eq!([10, 30].map(|metres| knots("pieces = 6", metres)), [6, 6]);
    assert!((2..=9).contains(&knots("pieces = uniform(0.1 /m, 0.3 /m)", 30)));
}
