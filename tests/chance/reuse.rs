//! Places of sources that are used again: few places last for long, everybody is a person of their own, and what follows
//! single people says that it knows no more.

use super::{Batch, HEAD, answered, compiled, scenario};
use smc::kernel::Layout;
use smc::model::Parameter;

/// Somebody comes each `every` at 6 m, with own parameters, waits a drawn time on the way, and leaves at 2 m.
fn doors(every: &str, limit: &str) -> String {
    format!(
        "{HEAD}behaviour phone {{ state a {{ after exponential(1 s) -> b }}; state b {{ speed = 0.6 * speed; after 1 s -> a }} }}\n\
         source doors: adult with phone {{ at = uniform in rect (5, 0) .. (6, 30); every = {every}\n\
         route = (4, 10) -> wait uniform(0 s, 1 s) -> west then leave; {limit} }}"
    )
}

/// The same, but leaving soon: the goal is near.
fn passing(every: &str, limit: &str) -> String {
    doors(every, limit).replace("(4, 10) -> wait uniform(0 s, 1 s) -> west", "wait uniform(0 s, 1 s) -> near")
}

#[test]
fn a_source_goes_on_for_an_hour_with_few_places() {
    let text = passing("exponential(4 s)", "limit = 12").replace("horizon = 60 s", "horizon = 1 h");
    let study = compiled(
        &text,
        "estimate P(G (count(a in doors) <= 12)), P(F[59 min, 60 min] (count(a in doors) >= 1)), \
         P(F<=1 h (doors[3] in near)), P(F<=2 s (count(a in doors: F<=1 s (a in near)) >= 1)), \
         P(F<=59 min (count(a in doors: F<=1 s (a in west)) >= 1)) by fixed(trials = 3)",
    );
    let run = answered(&study, 0, 1, 1_000);
    let counts: Vec<_> = run.results.iter().map(|result| result.consumed.counts).collect();
    // Nine hundred come; never more than twelve at once.
    assert_eq!((counts[0].successes, counts[0].unresolved), (3, 0), "{:?}", run.results[0]);
    assert_eq!((counts[1].successes, counts[1].unresolved), (3, 0));
    // What is decided before a place is used again counts.
    assert_eq!((counts[2].successes, counts[2].unresolved), (3, 0), "{:?}", run.results[2]);
    assert_eq!(counts[3].unresolved, 0);
    // What would follow people for an hour does not know.
    assert_eq!(counts[4].unresolved, 3, "{:?}", run.results[4]);
    let warning = &run.results[4].warnings[0];
    assert!(
        warning.contains(
            "more than 12 agents arrived by source `doors`, and the formula follows single agents of it"
        ),
        "{warning}"
    );
}

#[test]
fn with_too_few_places_for_those_at_once_a_trial_is_unresolved() {
    let text = doors("2 s", "limit = 5");
    let study = compiled(&text, "estimate P(F (count(a in doors) > 90)) by fixed(trials = 3)");
    let run = answered(&study, 0, 1, 1_000);
    assert_eq!(run.results[0].consumed.counts.unresolved, 3);
    let warning = &run.results[0].warnings[0];
    assert!(warning.contains("more than 5 agents") && warning.contains("`doors`"), "{warning}");
}

#[test]
fn the_numbers_of_a_person_do_not_depend_on_the_place() {
    // The n-th arrival enters with the same parameters at the same place and time, wherever it is kept.
    for layout in [Layout::Trials, Layout::Agents] {
        let seen = |limit: &str, first: u64| {
            let scenario = scenario(&passing("exponential(4 s)", limit));
            let mut batch = Batch::new(&scenario, layout, first);
            let mut before = vec![false; scenario.agents.len()];
            let mut all: Vec<(u32, u32, [u64; 6])> = Vec::new();
            let mut reused = false;
            for step in 0..3_000u32 {
                batch.step();
                let s = &batch.state;
                for k in 0..scenario.agents.len() {
                    let here = batch.present(k, 0);
                    let later = s.queues.later(k, 0);
                    reused |= later > 0;
                    if here && (!before[k] || all.iter().all(|(n, ..)| *n != k as u32 + later)) {
                        let slot = s.slot(k, 0);
                        let of = |field: &[smc::base::lanes::Lanes]| field[slot.block].0[slot.lane].to_bits();
                        let fields = [
                            &s.bodies[Parameter::Mass],
                            &s.bodies[Parameter::Radius],
                            &s.motion.x,
                            &s.motion.y,
                            &s.motion.vx,
                            &s.motion.vy,
                        ];
                        all.push((k as u32 + later, step, fields.map(|field| of(field))));
                    }
                    before[k] = here;
                }
            }
            (all, reused)
        };
        // A trial in which six places are enough, and are taken again.
        let reuses = |first: &u64| seen("limit = 6", *first).1;
        let first = (0..20).find(reuses).expect("some trial takes its places again");
        let (wide, never) = seen("limit = 40", first);
        let (narrow, _) = seen("limit = 6", first);
        assert!(!never, "{layout:?}");
        assert!(wide.len() >= 10, "{}", wide.len());
        // The order of arrival is that of the numbers. People who meet push each other in another order of sums, but who
        // enters does so as drawn.
        assert_eq!(wide, narrow, "{layout:?}");
        assert!(wide.windows(2).all(|pair| pair[0].0 + 1 == pair[1].0));
    }
}

#[test]
fn noise_that_a_behaviour_sets_takes_nobody_through_a_wall() {
    let scenario = scenario(
        "horizon = 20 s\nstep = 0.1 s\n\
         kind k: sfm preset helbing2000 { A = 0 N; radius = 0.3 m; k1 = 4e5 kg/s^2; mass = 60 kg; tau = 0.1 s }\n\
         scene { region box: rect (1, 1) .. (9, 9)\n\
         wall around: (0, 0) -- (10, 0) -- (10, 10) -- (0, 10) -- (0, 0) }\n\
         behaviour wild { state calm { after 0.1 s -> mad }; state mad { noise = 2.6 m/s; after 1000 s -> calm } }\n\
         agents a[8]: k with wild { at = uniform in box }",
    );
    for first in (0..160).step_by(8) {
        let mut batch = Batch::new(&scenario, Layout::Trials, first);
        for _ in 0..200 {
            batch.step();
        }
        let s = &batch.state;
        for k in 0..scenario.agents.len() {
            for lane in 0..8 {
                let slot = s.slot(k, lane);
                let (x, y) = (s.motion.x[slot.block].0[slot.lane], s.motion.y[slot.block].0[slot.lane]);
                let inside = (0.0..=10.0).contains(&x) && (0.0..=10.0).contains(&y);
                assert!(inside || s.diverged.has(lane), "trial {}: ({x}, {y})", first + lane as u64);
            }
        }
    }
}

#[test]
fn who_comes_to_a_place_that_is_left_in_the_same_step_has_not_made_it() {
    // Each waits a second at a wall, which pushes them, and leaves; with one place the next comes to it just then.
    let entries = |limit: u32| {
        let scenario = scenario(&format!(
            "horizon = 20 s\nstep = 0.02 s\nkind adult: sfm preset helbing2000 {{ radius = 0.25 m }}\n\
             scene {{ wall south: (0, 0) -- (10, 0)\n region here: rect (4, 0) .. (6, 5) }}\n\
             source doors: adult {{ at = (5, 0.4); every = 1 s; limit = {limit}; route = wait 1 s -> here }}"
        ));
        let mut batch = Batch::new(&scenario, Layout::Trials, 0);
        let mut entries = Vec::new();
        let mut known = None;
        for _ in 0..1_000 {
            batch.step();
            let s = &batch.state;
            for k in 0..scenario.agents.len() {
                let number = k as u32 + s.queues.later(k, 0);
                if batch.present(k, 0) && known.is_none_or(|known| number > known) {
                    let slot = s.slot(k, 0);
                    entries.push((
                        number,
                        s.motion.vx[slot.block].0[slot.lane],
                        s.motion.vy[slot.block].0[slot.lane],
                    ));
                    known = Some(number);
                }
            }
        }
        entries
    };
    let one = entries(1);
    assert!(one.len() >= 8, "{one:?}");
    assert!(one.iter().all(|(_, vx, vy)| *vx == 0.0 && *vy == 0.0), "{one:?}");
    assert_eq!(one, entries(3));
}

#[test]
fn people_are_named_by_the_number_of_their_arrival() {
    let text =
        passing("5 s", "limit = 3").replace("behaviour phone", "behaviour unused").replace(" with phone", "");
    let study = compiled(
        &text,
        "estimate P(F[50 s, 52 s] (count(a in doors: speed(a) > 0.2 m/s) >= 1)), P(F[51 s, 52 s] (exists a in doors: speed(a) > 0.2 m/s)) by fixed(trials = 2)",
    );
    let run = answered(&study, 0, 1, 1_000);
    let witness = &run.results[1].witnesses[0];
    assert!(witness.what.contains("doors[10]"), "{}", witness.what);
}

#[test]
fn where_behaviours_speak_of_single_ones_places_are_used_once() {
    let text =
        passing("5 s", "limit = 12").replace("after 1 s -> a", "when distance(self, doors[2]) > 1 m -> a");
    let one = scenario(&text);
    let mut batch = Batch::new(&one, Layout::Trials, 0);
    for _ in 0..2_900 {
        batch.step();
    }
    assert!(batch.state.queues.reused.is_empty() && batch.state.queues.full.is_empty());
    let text = text.replace("limit = 12", "limit = 4");
    let study = compiled(&text, "estimate P(F (count(a in doors) > 4)) by fixed(trials = 2)");
    let run = answered(&study, 0, 1, 1_000);
    assert_eq!(run.results[0].consumed.counts.unresolved, 2);
    assert!(run.results[0].warnings[0].contains("more than 4 agents arrived by source `doors`"));
}

#[test]
fn newcomers_on_a_used_place_are_felt_in_every_lane_as_alone() {
    // The goal lies beside the entry, so that who comes next stands where the one before left, with another B.
    let text = "horizon = 12 s\nstep = 0.02 s\n\
        scene { region door: rect (0,-1) .. (0.4,1); region kiosk: rect (1.2,-1) .. (1.5,1) }\n\
        kind k: sfm preset helbing2000 { noise = 0 m/s; radius = 0.2 m; lambda = 0.5 }\n\
        kind v: k { B = choice(0.02 m, 0.3 m); speed = uniform(0.9 m/s, 1.5 m/s) }\n\
        source doors: v { at = (0.35, 0); every = uniform(4.2 s, 4.5 s); limit = 1; route = kiosk -> door then leave }\n\
        agent stander: k { B = 0.02 m; at = (2.6, 0.3) }\n";
    let scenario = scenario(text);
    let people = scenario.agents.len();
    let mut together = Batch::new(&scenario, Layout::Trials, 0);
    let mut alone: Vec<Batch> =
        (0..8).map(|trial| Batch::of(&scenario, Layout::Trials, std::iter::once((0, trial)), None)).collect();
    for step in 0..600 {
        together.step();
        for (lane, one) in alone.iter_mut().enumerate() {
            one.step();
            for agent in 0..people {
                assert_eq!(together.present(agent, lane), one.present(agent, 0), "step {step}, trial {lane}");
                if one.present(agent, 0) {
                    assert_eq!(together.bits(agent, lane), one.bits(agent, 0), "step {step}, trial {lane}");
                }
            }
        }
    }
    assert!(!together.state.queues.reused.is_empty(), "a place was used again");
}

#[test]
fn a_comparison_of_what_is_nowhere_resolved_has_no_numbers() {
    let text = doors("gap", "limit = 2").replace("horizon = 60 s", "horizon = 60 s\nparam gap = 2 s");
    for measure in ["P(F (count(a in doors) > 90))", "E(count(a in doors) at end) in 0 .. 90"] {
        let query = format!("compare {measure} under gap = 2 s with gap = 1 s");
        let study = compiled(&text, &query);
        let run = answered(&study, 0, 1, 200);
        let result = &run.results[0];
        assert_eq!(result.consumed.counts.unresolved, result.consumed.counts.trials, "{measure}");
        assert_eq!(result.estimate, None, "{measure}");
        let sides = result.compare.as_ref().unwrap();
        for side in [&sides.first, &sides.second, &sides.difference] {
            assert!(side.value.estimate.is_nan(), "{measure}: {side:?}");
        }
    }
}
