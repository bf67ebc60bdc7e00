//! What agents are like once states of behaviours are entered: values kept, turns at one time, waits gone on with.

use super::{Batch, scenario};
use smc::base::lanes::LANES;
use smc::kernel::Layout;
use smc::model::Parameter;

#[test]
fn what_a_state_sets_is_computed_on_entering_it_and_kept() {
    // In state k the process is at k; sixteenths are numbers without rounding.
    let text = "horizon = 10 s\nstep = 0.1 s\n\
        kind adult: sfm preset helbing2000 { speed = 1 m/s; tau = 0.5 s }\n\
        process level { var n: 0 .. 100 = 0\n when n < 100 -> n = n + 1 }\n\
        behaviour rising { state start { after 1 s -> set }\n\
        state set { speed = level.n * 0.0625 m/s; after 3 s -> set } }\n\
        behaviour other { state calm { after 2 s -> odd }; state odd { tau = 0.25 s; after 1 s -> slow }\n\
        state slow { speed = 0.5 * speed; after 0.5 s -> over }; state over { } }\n\
        behaviour restless { state always { noise = uniform(0.01 m/s, 0.02 m/s) } }\n\
        agent a: adult with rising, other, restless { at = (0, 0) }";
    let scenario = scenario(text);
    for layout in [Layout::Trials, Layout::Agents] {
        let mut batch = Batch::new(&scenario, layout, 0);
        let noise = batch.state.bodies[Parameter::Noise][0];
        for tick in 1..=90 {
            if tick == 15 {
                // A replica goes on with other random numbers; what was drawn stays.
                for key in &mut batch.state.keys {
                    key.branch = 7;
                }
            }
            batch.step();
            let speed = match tick {
                ..10 => 1.0,
                30..35 => 0.5,
                10..30 | 35..40 => 10.0 / 16.0,
                40..70 => 40.0 / 16.0,
                _ => 70.0 / 16.0,
            };
            let tau = if (20..30).contains(&tick) { 0.25 } else { 0.5 };
            for lane in 0..batch.state.width() {
                let found = [
                    &batch.state.bodies[Parameter::Speed],
                    &batch.state.bodies[Parameter::Tau],
                    &batch.state.bodies[Parameter::Noise],
                ]
                .map(|f| f[0].0[lane]);
                assert_eq!(found, [speed, tau, noise.0[lane]], "{layout:?}, state {tick}, lane {lane}");
            }
        }
    }
}

#[test]
fn of_behaviours_that_turn_in_one_step_nothing_in_between_shows() {
    // Between the two detours nobody is on the way home, where they would leave at once.
    let text = |behaviours: &str, with: [&str; 2]| {
        format!(
            "horizon = 8 s\nstep = 0.1 s\n\
             scene {{ region home: rect (0, 0) .. (2, 4)\n region a: rect (10, 0) .. (12, 4)\n\
             region b: rect (-12, 0) .. (-10, 4) }}\n{behaviours}\n\
             kind walker: sfm preset helbing2000 {{ speed = 0.5 m/s; noise = 0 m/s }}\n\
             agent user: walker with {} {{ at = (1, 2); route = home then leave }}\n\
             agent other: walker with {} {{ at = (1, 3); route = home then leave }}",
            with[0], with[1]
        )
    };
    let two = text(
        "behaviour first { state start { route = a; after 1 s -> done }; state done { } }\n\
         behaviour second { state calm { after 1 s -> odd }; state odd { route = b } }",
        ["first, second", "second, first"],
    );
    let one = text(
        "behaviour only { state start { route = a; after 1 s -> odd }; state odd { route = b } }",
        ["only", "only"],
    );
    let (two, one) = (scenario(&two), scenario(&one));
    for layout in [Layout::Trials, Layout::Agents] {
        let (mut two, mut one) = (Batch::new(&two, layout, 0), Batch::new(&one, layout, 0));
        for tick in 1..=80 {
            two.step();
            one.step();
            for at in 0..2 * two.state.width() {
                let (agent, lane) = (at % 2, at / 2);
                assert!(two.present(agent, lane), "{layout:?}, state {tick}");
                assert_eq!(two.bits(agent, lane), one.bits(agent, lane), "{layout:?}, state {tick}");
            }
        }
        let x = |agent| {
            let slot = two.state.slot(agent, 0);
            two.state.motion.x[slot.block].0[slot.lane]
        };
        assert!((0..2).all(|agent| x(agent) < 0.0), "towards b");
    }
}

#[test]
fn a_wait_that_is_interrupted_goes_on_with_what_is_left_of_it() {
    // The number of the first state in which they set off, by lane. Detours go to where they stand.
    let leaves = |behaviour: &str, wait: &str, layout: Layout| {
        let text = format!(
            "horizon = 20 s\nstep = 0.1 s\n\
             scene {{ region goal: rect (100, 0) .. (110, 10)\n region kiosk: rect (0, 0) .. (2, 4)\n\
             region nook: rect (0, 1) .. (2, 3) }}\n\
             behaviour errand {{ {behaviour} }}\n\
             kind walker: sfm preset helbing2000 {{ speed = 1 m/s; noise = 0 m/s }}\n\
             agent user: walker with errand {{ at = (1, 2); route = wait {wait} -> goal }}"
        );
        let mut batch = Batch::new(&scenario(&text), layout, 0);
        let mut found = vec![None; batch.state.width()];
        for tick in 1..=120 {
            batch.step();
            for (lane, found) in found.iter_mut().enumerate() {
                if found.is_none() && batch.state.driving.speed[0].0[lane] > 0.0 {
                    *found = Some(tick);
                }
            }
        }
        found.into_iter().map(|tick| tick.expect("sets off")).collect::<Vec<i32>>()
    };
    let none = "state only { }";
    let once =
        "state start { after 4 s -> away }; state away { route = kiosk; after 1 s -> back }; state back { }";
    // From one detour to the next without going back, and a third one later.
    let thrice = "state start { after 1 s -> away }; state away { route = kiosk; after 1 s -> farther }\n\
        state farther { route = nook; after 0.5 s -> back }; state back { after 0.4 s -> again }\n\
        state again { route = kiosk; after 0.3 s -> over }; state over { }";
    for layout in [Layout::Trials, Layout::Agents] {
        let all = |tick: i32| vec![tick; if layout == Layout::Trials { LANES } else { 1 }];
        assert_eq!(leaves(none, "5 s", layout), all(50));
        assert_eq!(leaves(once, "5 s", layout), all(60), "4 s before the detour of 1 s, 1 s after it");
        assert_eq!(leaves(once, "4 s", layout), all(50), "over as the detour begins");
        let plain = leaves(none, "uniform(3 s, 6 s)", layout);
        assert!(layout == Layout::Agents || plain.iter().any(|tick| *tick != plain[0]), "{plain:?}");
        let later: Vec<i32> = plain.iter().map(|tick| tick + 18).collect();
        assert_eq!(leaves(thrice, "uniform(3 s, 6 s)", layout), later);
    }
}
