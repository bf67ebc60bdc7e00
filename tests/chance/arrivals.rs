//! Arrivals against Poisson, departures, room, and the cap.

use super::{Batch, HEAD, agent, answered, compiled, near, scenario};
use smc::base::lanes::LANES;
use smc::kernel::Layout;
use smc::model::Parameter;

/// Numbers of those who have come by 10 s.
fn counts(every: &str, layout: Layout, trials: u64) -> Vec<f64> {
    let text = format!(
        "{HEAD}source doors: adult {{ at = uniform in near; every = {every}; route = west; speed = 0.5 m/s }}"
    );
    let scenario = scenario(&text);
    let mut out = Vec::new();
    let width = if layout == Layout::Trials { LANES as u64 } else { 1 };
    for first in (0..trials).step_by(width as usize) {
        let mut batch = Batch::new(&scenario, layout, first);
        for _ in 0..500 {
            batch.step();
        }
        for lane in 0..width as usize {
            let here = (0..scenario.agents.len()).filter(|&k| batch.present(k, lane)).count();
            assert_eq!(here as u32, batch.state.queues.entered[0][lane]);
            out.push(here as f64);
        }
    }
    out
}

#[test]
fn exponential_times_make_poisson_counts() {
    let counts = counts("exponential(2.5 s)", Layout::Trials, 1_200);
    let n = counts.len() as f64;
    let mean = counts.iter().sum::<f64>() / n;
    let variance = counts.iter().map(|c| (c - 4.0).powi(2)).sum::<f64>() / n;
    assert!(near(mean, 4.0, 2.0, n), "{mean}");
    // Fourth central moment of Poisson: 3 m^2 + m.
    assert!(near(variance, 4.0, (52.0_f64 - 16.0).sqrt(), n), "{variance}");
    let none = counts.iter().filter(|&&c| c == 0.0).count() as f64 / n;
    let p = (-4.0_f64).exp();
    assert!(near(none, p, (p * (1.0 - p)).sqrt(), n), "{none}");
}

#[test]
fn constant_times_are_met_exactly_in_both_layouts() {
    for layout in [Layout::Trials, Layout::Agents] {
        assert!(counts("2.5 s", layout, 8).iter().all(|&c| c == 4.0), "the fourth comes at just 10 s");
        assert!(counts("0.7 s", layout, 8).iter().all(|&c| c == 14.0));
    }
    let lanes = counts("exponential(1.5 s)", Layout::Trials, 16);
    assert_eq!(lanes, counts("exponential(1.5 s)", Layout::Agents, 16), "the layout changes no arrival");
}

#[test]
fn nobody_comes_in_on_top_of_somebody_and_those_without_room_wait() {
    for layout in [Layout::Trials, Layout::Agents] {
        let text = "horizon = 60 s\nstep = 0.02 s\nkind adult: sfm preset helbing2000 { noise = 0.05 m/s }\n\
            scene { region door: rect (0, 0) .. (1.2, 1.2)\n region west: rect (-60, 0) .. (-50, 1) }\n\
            agent post: adult { at = (0.4, 0.4); mass = 10000 kg }\n\
            source doors: adult { at = uniform in door; every = 0.1 s; route = west; limit = 600 }";
        let scenario = scenario(text);
        let mut batch = Batch::new(&scenario, layout, 0);
        let mut waited = false;
        let mut before = vec![false; scenario.agents.len()];
        for step in 1..400 {
            let old = batch.state.clone();
            batch.step();
            let entered = batch.state.queues.entered[0][0];
            waited |= f64::from(entered) < (f64::from(step) * 0.2).floor();
            let s = &batch.state;
            let body = |k: usize| {
                let slot = s.slot(k, 0);
                let of = |field: &[smc::base::lanes::Lanes]| field[slot.block].0[slot.lane];
                (of(&s.motion.x), of(&s.motion.y), of(&s.bodies[Parameter::Radius]))
            };
            for k in 0..scenario.agents.len() {
                if batch.present(k, 0) && !before[k] {
                    let (x, y, r) = body(k);
                    for j in (0..scenario.agents.len()).filter(|&j| j != k && batch.present(j, 0)) {
                        let (a, b, q) = body(j);
                        assert!((x - a).hypot(y - b) >= (r + q) * (1.0 - 1e-12), "{layout:?}");
                    }
                }
                before[k] = batch.present(k, 0);
            }
            drop(old);
        }
        assert!(waited && batch.state.queues.entered[0][0] > 10, "{}", batch.state.queues.entered[0][0]);
    }
}

#[test]
fn they_leave_at_their_last_goal() {
    let text = format!(
        "{HEAD}source doors: adult {{ at = (6, 0); every = 3 s; route = (4, 0) -> near; noise = 0 m/s; speed = 1.5 m/s }}"
    );
    let scenario = scenario(&text);
    let first = agent(&scenario, "doors[1]");
    for layout in [Layout::Trials, Layout::Agents] {
        let mut batch = Batch::new(&scenario, layout, 0);
        let mut there = Vec::new();
        for _ in 0..1_000 {
            batch.step();
            there.push([0, 1, 2].map(|k| batch.present(first + k, 0)));
        }
        let come: Vec<_> = (0..3).map(|k| there.iter().position(|t| t[k]).unwrap() + 1).collect();
        assert_eq!(come, [150, 300, 450]);
        for k in 0..3 {
            let gone = there.iter().rposition(|t| t[k]).unwrap() + 2;
            // Four metres at 1.5 m/s, after starting from rest.
            assert!((130..260).contains(&(gone - come[k])), "{gone}");
        }
    }
}

#[test]
fn a_trial_in_which_too_many_come_is_unresolved_and_says_why() {
    let text = format!(
        "{HEAD}agent a: adult {{ at = (10, 10) }}\n\
         source doors: adult {{ at = uniform in near; every = exponential(2 s); route = west; limit = 32 }}"
    );
    let study = compiled(&text, "estimate P(F<=60 s (travelled(a) > 1000 m)) by fixed(trials = 200)");
    let run = answered(&study, 0, 1, 1_000);
    let result = &run.results[0];
    // P(more than 32 of a Poisson number with mean 30) is 0.3.
    let share = result.consumed.counts.unresolved as f64 / 200.0;
    assert!(near(share, 0.3155, 0.4647, 200.0), "{share}");
    assert_eq!(result.consumed.counts.unresolved + result.consumed.counts.failures, 200);
    let warning = &result.warnings[0];
    assert!(
        warning.contains("more than 32 agents arrived by source `doors`; write a larger `limit`"),
        "{warning}"
    );
    assert!(result.high > share && result.low <= 0.0);
}

#[test]
fn large_crowds_take_people_in() {
    let text = "horizon = 10 s\nstep = 0.02 s\nkind adult: sfm preset helbing2000 { noise = 0.05 m/s }\n\
        scene { region hall: rect (0, 0) .. (40, 40)\n region west: rect (-50, 0) .. (-1, 40) }\n\
        behaviour phone { state a { after exponential(1 s) -> b }; state b { speed = 0.5 * speed; after 1 s -> a } }\n\
        agents crowd[300]: adult with phone { at = uniform in hall; route = west }\n\
        source doors: adult with phone { at = uniform in hall; every = exponential(0.2 s); route = west }";
    let scenario = scenario(text);
    let mut batch = Batch::new(&scenario, Layout::Agents, 0);
    for _ in 0..250 {
        batch.step();
    }
    let entered = batch.state.queues.entered[0][0];
    assert!((5..=50).contains(&entered), "{entered}");
    let busy = (0..300).filter(|&k| batch.mode(0, k, 0) == 1.0).count();
    assert!((100..200).contains(&busy), "half of them, about: {busy}");
    assert_eq!(smc::kernel::Program::new(scenario.clone()).layout, Layout::Agents);
}

#[test]
fn who_comes_at_once_is_there_in_the_first_state() {
    let text = format!(
        "{HEAD}source doors: adult {{ at = uniform in near; every = bernoulli(50 %) * 1 s; route = west; limit = 90 }}"
    );
    let study = compiled(&text, "estimate P(F<=0 s (count(a in doors) >= 1)) by fixed(trials = 400)");
    let counts = answered(&study, 0, 1, 1_000).results[0].consumed.counts;
    assert!(near(counts.successes as f64 / 400.0, 0.5, 0.5, 400.0), "{counts:?}");
}
