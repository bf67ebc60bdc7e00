//! Streams of random numbers are separate: what is added changes nobody else's draws.

use super::{Batch, HEAD, agent, scenario};
use smc::base::lanes::LANES;
use smc::kernel::Layout;
use smc::model::Parameter;

const CROWD: &str = "agents crowd[4]: adult { at = uniform in near; route = west }\n";

/// Bits of the crowd at every state, in all lanes.
fn trace(text: &str, layout: Layout) -> Vec<Vec<Vec<u64>>> {
    let scenario = scenario(&format!("{HEAD}{text}"));
    let first = agent(&scenario, "crowd[1]");
    let mut batch = Batch::new(&scenario, layout, 40);
    let lanes = if layout == Layout::Trials { LANES } else { 1 };
    let mut out = Vec::new();
    for _ in 0..120 {
        batch.step();
        out.push((0..4 * lanes).map(|at| batch.bits(first + at % 4, at / 4)).collect());
    }
    out
}

#[test]
fn a_source_that_never_fires_changes_no_byte() {
    let source = "source late: adult { at = (1, 3); every = 50 s; route = west }\n";
    for layout in [Layout::Trials, Layout::Agents] {
        assert_eq!(trace(CROWD, layout), trace(&format!("{CROWD}{source}"), layout), "{layout:?}");
        assert_eq!(trace(CROWD, layout), trace(&format!("{source}{CROWD}"), layout), "{layout:?}");
    }
}

#[test]
fn a_behaviour_that_changes_nothing_changes_no_byte() {
    let idle = "behaviour idle { state a { after exponential(1 s) -> 0.5: a | 0.5: b }\n\
                state b { speed = speed; noise = 1 * noise; after 0.5 s -> a } }\n";
    let with = CROWD.replace(": adult {", ": adult with idle {");
    for layout in [Layout::Trials, Layout::Agents] {
        let plain = trace(CROWD, layout);
        assert_eq!(plain, trace(&format!("{idle}{with}"), layout), "{layout:?}");
        assert_eq!(
            plain,
            trace(
                &format!("process p {{ var n: 0 .. 1 = 0\n when true -> 0.5: n = 1 | 0.5: n = 0 }}\n{CROWD}"),
                layout
            )
        );
    }
}

#[test]
fn another_behaviour_leaves_the_first_as_it_is() {
    let phone = "behaviour phone { state a { after exponential(1 s) -> b }\n\
                 state b { speed = 0.5 * speed; after uniform(1 s, 2 s) -> a } }\n\
                 behaviour other { state c { after exponential(0.7 s) -> 0.5: c | 0.5: d }; state d { } }\n";
    let one = format!("{phone}{}", CROWD.replace(": adult {", ": adult with phone {"));
    let two = format!("{phone}{}", CROWD.replace(": adult {", ": adult with other, phone {"));
    assert_eq!(trace(&one, Layout::Trials), trace(&two, Layout::Trials));
    assert_ne!(trace(&one, Layout::Trials), trace(CROWD, Layout::Trials));
}

#[test]
fn the_pauses_of_a_detour_do_not_depend_on_the_routes_of_others() {
    let stray = "behaviour stray { state a { after 0.2 s -> b }\n\
                 state b { route = wait uniform(0.2 s, 2 s) -> (3, 30) } }\n";
    let with = format!("{stray}{}", CROWD.replace(": adult {", ": adult with stray {"));
    let other = "agent other: adult { at = (-200, 0); route = (-250, 0) -> wait 1 s -> west }\n";
    let plain = trace(&with, Layout::Trials);
    assert!(plain == trace(&format!("{with}{other}"), Layout::Trials));
    assert!(plain == trace(&format!("{other}{with}"), Layout::Trials));
    assert!(plain != trace(&with.replace("uniform(0.2 s, 2 s)", "uniform(0.2 s, 1 s)"), Layout::Trials));
}

#[test]
fn who_comes_is_the_same_whoever_else_is_there_and_however_long_it_lasts() {
    let arrivals = |text: &str| {
        let scenario = scenario(text);
        let first = agent(&scenario, "doors[1]");
        let mut batch = Batch::new(&scenario, Layout::Trials, 0);
        let mut seen = vec![None; 8];
        for step in 0..900 {
            batch.step();
            for (k, seen) in seen.iter_mut().enumerate() {
                if seen.is_none() && batch.present(first + k, 2) {
                    let speed = batch.state.bodies[Parameter::Speed][first + k].0[2];
                    *seen = Some((
                        step,
                        speed.to_bits(),
                        batch.state.bodies[Parameter::Noise][first + k].0[2].to_bits(),
                    ));
                }
            }
        }
        seen
    };
    let source = "source doors: adult { at = uniform in near; every = exponential(2 s); route = west }\n";
    let short = arrivals(&format!("{HEAD}{source}"));
    assert!(short.iter().flatten().count() > 3);
    assert_eq!(
        short,
        arrivals(
            &format!("{HEAD}agents far[3]: adult {{ at = (100, 100) }}\n{source}")
                .replace("at = (100, 100)", "at = uniform in rect (100, 100) .. (120, 120)")
        )
    );
    let long = format!("{HEAD}{source}").replace("horizon = 60 s", "horizon = 90 s");
    assert_eq!(short, arrivals(&long));
}
