//! Periodic scenes: forces against a plain sum over nearest images, scenes that are the same wherever they begin, the functions
//! of the language across the seam, and closed forms of a walk around.

use crate::crowd::{Crowd, Numbers, Person, crowd, p, person, wall};
use crate::forces::plain;
use smc::base::geometry::{Shape, Vec2};
use smc::engine::outcome::Verdict;
use smc::kernel::Layout;
use smc::model::{Obstacle, Period, Periods};
use smc::report::Format;
use smc::{Model, Options};

const LAYOUTS: [Layout; 2] = [Layout::Trials, Layout::Agents];

fn along_x(low: f64, length: f64) -> Periods {
    Periods { x: Some(Period { low, length }), y: None }
}

/// People in a box, and the periods of its sides.
fn random(n: usize, size: Vec2, periods: Periods, rng: &mut Numbers) -> Crowd {
    let people = (0..n).map(|k| {
        let angle: f64 = rng.between(-3.2, 3.2);
        Person {
            towards: p(angle.cos(), angle.sin()),
            radius: rng.between(0.2, 0.3),
            a: rng.between(150.0, 250.0),
            b: rng.between(0.05, 0.3),
            lambda: rng.between(0.0, 1.0),
            a2: rng.between(10.0, 50.0),
            b2: rng.between(0.05, 0.3),
            present: k % 7 != 3,
            drive: rng.between(0.5, 2.0),
            ..person(p(rng.between(0.0, size.x), rng.between(0.0, size.y)))
        }
    });
    Crowd { periods, ..crowd(people.collect(), "0.01") }
}

/// The crowd as one of it sees it: of everybody the nearest image.
fn seen_by(scene: &Crowd, i: usize) -> Crowd {
    let mut seen = scene.clone();
    for one in &mut seen.people {
        one.at = scene.people[i].at + scene.periods.way(one.at - scene.people[i].at);
    }
    seen
}

#[test]
fn both_layouts_sum_over_nearest_images() {
    let mut rng = Numbers(7);
    for round in 0..12 {
        let size = p(rng.between(4.0, 13.0), rng.between(4.0, 9.0));
        let period = |length| Some(Period { low: 0.0, length });
        let periods = [
            Periods { x: period(size.x), y: None },
            Periods { x: None, y: period(size.y) },
            Periods { x: period(size.x), y: period(size.y) },
        ][round % 3];
        let scene = random(20 + 12 * round, size, periods, &mut rng);
        for layout in LAYOUTS {
            let run = scene.start(layout);
            for i in 0..scene.people.len() {
                let words = format!("round {round}, {layout:?}, agent {i}");
                plain(&seen_by(&scene, i), i).assert_is(run.force(i), &words);
            }
        }
    }
}

#[test]
fn walls_and_lines_of_sight_reach_across_the_seam() {
    let mut rng = Numbers(8);
    for round in 0..6 {
        let mut scene = random(60, p(8.0, 5.0), along_x(0.0, 8.0), &mut rng);
        scene.obstacles = vec![
            wall(p(0.0, 0.0), p(8.0, 0.0)),
            wall(p(0.05, 1.5), p(0.3, 2.5)),
            Obstacle::Solid(Shape::Circle { centre: p(7.7, 4.0), radius: 0.25 }),
            wall(p(5.0, 1.0), p(6.5, 1.2)),
        ];
        for layout in LAYOUTS {
            let run = scene.start(layout);
            for i in 0..60 {
                let mut seen = seen_by(&scene, i);
                seen.obstacles = vec![wall(p(-8.0, 0.0), p(16.0, 0.0))];
                for way in [0.0, -8.0, 8.0].map(|x| p(x, 0.0)) {
                    seen.obstacles.push(wall(p(0.05, 1.5) + way, p(0.3, 2.5) + way));
                    seen.obstacles
                        .push(Obstacle::Solid(Shape::Circle { centre: p(7.7, 4.0) + way, radius: 0.25 }));
                    seen.obstacles.push(wall(p(5.0, 1.0) + way, p(6.5, 1.2) + way));
                }
                // Near a barrier the normal has the rounding of coordinates of images.
                let words = format!("round {round}, {layout:?}, agent {i}");
                plain(&seen, i).assert_within(run.force(i), 1e-10, &words);
            }
        }
    }
}

/// A dense stream between walls around an obstacle, with groups, that begins at a place of the ring.
fn ring(from: f64, stiff: bool) -> Crowd {
    const LENGTH: f64 = 9.0;
    let mut rng = Numbers(9);
    let periods = along_x(0.0, LENGTH);
    let at = |x: f64, y: f64| periods.wrap(p(x + from, y));
    let people = (0..60).map(|k| {
        let (column, row) = (f64::from(k / 5), f64::from(k % 5));
        let place =
            at(0.1 + 0.73 * column + rng.between(-0.05, 0.05), 0.35 + 0.56 * row + rng.between(-0.05, 0.05));
        let drive = rng.between(0.8, 1.6);
        let (k1, k2) = if stiff { (1.2e5, 2.4e5) } else { (0.0, 0.0) };
        let standing = k % 11 == 4;
        Person {
            drive: if standing { 0.0 } else { drive },
            velocity: p(drive, 0.0),
            radius: 0.28,
            hold: 0.3,
            k1,
            k2,
            ..person(place)
        }
    });
    let mut scene = Crowd { periods, ..crowd(people.collect(), "0.01") };
    let disc = Shape::Circle { centre: at(4.0, 1.6), radius: 0.02 };
    scene.obstacles =
        vec![wall(p(0.0, 0.0), p(LENGTH, 0.0)), wall(p(0.0, 3.0), p(LENGTH, 3.0)), Obstacle::Solid(disc)];
    scene.groups = vec![(vec![57, 58, 0, 1, 2], 60.0), (vec![20, 26], 80.0)];
    scene
}

#[test]
fn a_scene_is_the_same_wherever_its_period_begins() {
    for layout in LAYOUTS {
        for stiff in [false, true] {
            let mut one = ring(0.0, stiff).start(layout);
            let mut other = ring(3.0, stiff).start(layout);
            let periods = along_x(0.0, 9.0);
            for round in 0..30 {
                for k in 0..60 {
                    let apart = periods.way(other.at(k) - one.at(k) - p(3.0, 0.0));
                    assert!(apart.norm() < 1e-9, "{layout:?} {stiff} {round}, agent {k}: {apart}");
                    assert!((0.0..9.0).contains(&one.at(k).x) && (0.0..9.0).contains(&other.at(k).x));
                }
                one.steps(5);
                other.steps(5);
            }
            let way =
                |run: &crate::crowd::Run| run.state.motion.travelled.iter().map(|t| t.0[0]).sum::<f64>();
            assert!((way(&one) - way(&other)).abs() < 1e-6);
        }
    }
}

#[test]
fn both_layouts_walk_the_same_ways_around() {
    let (mut lanes, mut cells) = (ring(0.0, true).start(LAYOUTS[0]), ring(0.0, true).start(LAYOUTS[1]));
    lanes.steps(150);
    cells.steps(150);
    for k in 0..60 {
        let apart = along_x(0.0, 9.0).way(lanes.at(k) - cells.at(k));
        assert!(apart.norm() < 1e-7, "agent {k}: {apart}");
    }
}

#[test]
fn a_list_of_neighbours_outlives_a_walk_across_the_seam() {
    // The list is kept from step to step; beside one that is made anew in each.
    let mut kept = ring(0.0, true).start(Layout::Trials);
    for _ in 0..60 {
        let mut fresh = smc::kernel::Scratch::default();
        let mut state = kept.state.clone();
        kept.steps(2);
        for _ in 0..2 {
            smc::kernel::step(&kept.program, &mut state, &mut fresh);
        }
        assert_eq!(crate::crowd::bits_of(&state, 0), crate::crowd::bits_of(&kept.state, 0));
    }
}

const CORRIDOR: &str = "horizon = 40 s\nstep = 0.02 s\n\
    scene { periodic x in 2 m .. 12 m; wall (2, 0) -- (12, 0); wall (2, 3) -- (12, 3)
      obstacle pillar: circle (11.5, 0.4) radius 0.2 m; region seam: rect (2, 0) .. (3, 3)
      region last: rect (11, 0) .. (12, 3); line gate: (2, 0) -- (2, 3); line middle: (7, 0) -- (7, 3) }\n\
    kind adult: sfm preset helbing2000 { radius = 0.2 m; speed = 1.3 m/s }\n";

fn model(agents: &str) -> Model {
    Model::parse(&format!("{CORRIDOR}{agents}")).unwrap_or_else(|found| panic!("{found}"))
}

#[test]
fn somebody_alone_walks_around_with_the_desired_speed() {
    let model = model("agent me: adult { at = (5, 1.5); velocity = (1.3, 0) m/s; direction = 0 deg }\n");
    for state in model.trial(1, 0).unwrap() {
        let (me, way) = (state.agent("me").unwrap(), 1.3 * state.time);
        let wanted = along_x(2.0, 10.0).wrap(p(5.0 + way, 1.5));
        let apart = along_x(2.0, 10.0).way(me.position - wanted);
        // The pillar pushes a little from aside.
        assert!(apart.norm() < 0.05 && (2.0..12.0).contains(&me.position.x), "{apart}");
    }
    let open = "horizon = 40 s\nstep = 0.02 s\nscene { periodic y in -3 m .. 4 m }\n\
        kind adult: sfm preset helbing2000 { speed = 1.3 m/s }\n\
        agent me: adult { at = (5, 3.9); velocity = (0, -1.3) m/s; direction = -90 deg }\n";
    for state in Model::parse(open).unwrap().trial(1, 0).unwrap() {
        let wanted = along_x(-3.0, 7.0).wrap(p(3.9 - 1.3 * state.time, 0.0)).x;
        let at = state.agent("me").unwrap().position;
        assert!((at.y - wanted).abs() < 1e-9 || (at.y - wanted).abs() > 7.0 - 1e-9, "{at}");
        assert!((at.x - 5.0).abs() < 1e-9);
    }
}

/// Asserts formulas about the first state, or others, of a model.
fn assert_hold(model: &Model, formulas: &[&str]) {
    let queries: String = formulas.iter().map(|formula| format!("check P({formula}) >= 0.5\n")).collect();
    let report = model.check(&queries, &Options::default().max_trials(40)).unwrap_or_else(|e| panic!("{e}"));
    for (result, formula) in report.results().iter().zip(formulas) {
        assert_eq!(result.verdict, Some(Verdict::Satisfied), "{formula}");
    }
}

#[test]
fn functions_of_the_language_take_nearest_images() {
    let model = model(
        "agent a: adult { at = (11.7, 1.5); velocity = (1, 0) m/s }\n\
         agent b: adult { at = (2.1, 1.5) }\n\
         agent c: adult { at = (4.5, 2.5) }\n\
         agents d[2]: adult { at = uniform in circle (7, 1.5) radius 0.5 m }\n",
    );
    let near = |number: &str, value: &str, unit: &str| {
        format!("F<=0 s (max({number} - {value} {unit}, {value} {unit} - {number}) < 1e-9 {unit})")
    };
    let formulas = [
        near("distance(a, b)", "0.4", "m"),
        near("distance(b, a)", "0.4", "m"),
        near("distance(a, (2.5, 1.5))", "0.8", "m"),
        near("distance(a, seam)", "0.3", "m"),
        near("distance(b, last)", "0.1", "m"),
        near("distance(b, pillar)", "1.052996408614167", "m"),
        near("clearance(a)", "0", "m"),
        near("min(distance(x, b) for x in others(b))", "0.4", "m"),
        near("time_to_collision(a, b)", "0", "s"),
        "F<=0.1 s (contact(a) & contact(b) & !contact(c))".to_owned(),
        "F<=0 s (forall x in others(a): distance(a, x) < 5.1 m)".to_owned(),
        "F<=0 s (exists x in others(a): distance(a, x) < 0.41 m)".to_owned(),
        "F<=0 s (norm(centroid(d) - (7, 1.5)) < 0.6 m)".to_owned(),
        "F<=0 s (a in last & b in seam & !(a in seam))".to_owned(),
        // Two cells that meet at the seam, of which one lies in each region.
        "F<=0 s (voronoi_density(seam) > 0.2 /m^2 & voronoi_density(last) > 0.2 /m^2)".to_owned(),
        "robustness(a in last) >= 0.29 m".to_owned(),
        "robustness(b in last) >= -0.11 m".to_owned(),
    ];
    let formulas: Vec<&str> = formulas.iter().map(String::as_str).collect();
    assert_hold(&model, &formulas);
}

#[test]
fn a_line_at_the_seam_is_crossed_once_and_ways_are_not_wrapped() {
    let model = model("agent me: adult { at = (11, 1.5); velocity = (1.3, 0) m/s; direction = 0 deg }\n");
    assert_hold(
        &model,
        &[
            "G<=0.7 s (crossings(gate) == 0)",
            "F<=0.9 s (crossings(gate) == 1)",
            "G<=4 s (crossings(middle) == 0)",
            "F<=5 s (crossings(middle) == 1)",
            "F<=40 s (travelled(me) > 51.5 m)",
            "G<=40 s (travelled(me) < 52.5 m & !done(me) & x(position(me)) < 12 m & x(position(me)) >= 2 m)",
            "F<=40 s (dwell(me, seam) > 3 s)",
        ],
    );
}

#[test]
fn a_group_that_spans_the_seam_has_its_centroid_there() {
    let model = Model::parse(&format!(
        "{CORRIDOR}group g[3]: adult {{ at = uniform in circle (2.6, 1.5) radius 0.5 m; direction = 180 deg; attraction = 100 N }}\n"
    ))
    .unwrap();
    assert_hold(
        &model,
        &[
            "G<=6 s (spread(g) < 1.5 m)",
            "G<=6 s (forall a in g: distance(a, centroid(g)) < 2.5 m)",
            "G<=6 s (x(centroid(g)) >= 2 m & x(centroid(g)) < 12 m)",
        ],
    );
}

#[test]
fn threads_change_no_byte_of_a_periodic_scene() {
    for n in [40, 280] {
        let model = model(&format!(
            "kind noisy: adult {{ noise = 0.1 m/s }}\n\
             agents p[{n}]: noisy {{ at = uniform in rect (2, 0) .. (12, 3); direction = normal(0 deg, 9 deg); radius = 0.1 m }}\n"
        ));
        let report = |threads| {
            let options = Options::default().seed(3).threads(threads).max_trials(24);
            let queries = "estimate E(mean<=0.4 s (mean_speed(seam))) in 0 m/s .. 2 m/s by fixed(trials = 24)\n\
                estimate P(F<=0.4 s (exists a in p: clearance(a) < -0.01 m)) by clopper_pearson(trials = 24)\n";
            let mut json: serde_json::Value =
                serde_json::from_str(&model.check(queries, &options).unwrap().render(Format::Json)).unwrap();
            let object = json.as_object_mut().unwrap();
            object.remove("elapsed_s");
            for result in object["results"].as_array_mut().unwrap() {
                result.as_object_mut().unwrap().remove("elapsed_s");
            }
            json
        };
        let one = report(1);
        assert_eq!(one, report(2));
        assert_eq!(one, report(8));
    }
}
