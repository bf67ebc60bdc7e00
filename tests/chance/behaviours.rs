//! States of behaviours against their closed forms.

use super::{Batch, HEAD, agent, answered, compiled, near, scenario};
use smc::base::lanes::{LANES, Mask};
use smc::kernel::Layout;
use smc::model::{Move, Parameter};

const PHONE: &str = "behaviour phone {\n\
    state attentive { after exponential(8 s) -> looking }\n\
    state looking { speed = 0.5 * speed;  attention = 0.3;  after uniform(2 s, 5 s) -> attentive }\n}\n";

#[test]
fn the_share_of_time_in_a_state_is_the_ratio_of_the_means() {
    // Alone on a plane, in coarse steps: a state lasts a whole number of them, rounded up.
    let text = format!(
        "horizon = 100000 s\nstep = 0.1 s\nkind adult: sfm preset helbing2000\n{PHONE}\
         agent a: adult with phone {{ at = (0, 0) }}\nagent b: adult with phone {{ at = (50, 0) }}"
    );
    let mut batch = Batch::new(&scenario(&text), Layout::Trials, 0);
    let (burn, steps) = (2_000, 40_000);
    let mut looking = 0.0;
    for k in 0..burn + steps {
        batch.step();
        if k >= burn {
            looking += (0..2 * LANES).map(|at| batch.mode(0, at / LANES, at % LANES)).sum::<f64>();
        }
    }
    let share = looking / (2 * LANES * steps) as f64;
    let attentive = 0.1 / (1.0 - (-0.1_f64 / 8.0).exp());
    let expected = 3.55 / (3.55 + attentive);
    // Renewal theory: variance of the share is that of (1 - p) L - p A over a cycle.
    let per_cycle = (1.0 - expected).powi(2) * 0.75 + expected.powi(2) * 64.0;
    let cycles = (2 * LANES * steps) as f64 * 0.1 / 11.6;
    assert!(near(share, expected, per_cycle.sqrt() / 11.6, cycles), "{share} {expected}");
    assert!((share - expected).abs() < 0.02, "{share}");
}

#[test]
fn what_a_state_sets_never_compounds() {
    let text =
        format!("{HEAD}{PHONE}agents crowd[6]: adult with phone {{ at = uniform in near; route = west }}");
    let scenario = scenario(&text);
    for layout in [Layout::Trials, Layout::Agents] {
        let mut batch = Batch::new(&scenario, layout, 0);
        let lanes = batch.state.width();
        let read = |batch: &Batch, k: usize, lane: usize| {
            let (s, slot) = (&batch.state, batch.state.slot(k, lane));
            [&s.bodies[Parameter::Speed], &s.bodies[Parameter::A], &s.bodies[Parameter::Tau]]
                .map(|field| field[slot.block].0[slot.lane])
        };
        let own: Vec<_> = (0..6 * lanes).map(|at| read(&batch, at % 6, at / 6)).collect();
        let mut turns = 0;
        let mut before = vec![0.0; 6 * lanes];
        for step in 0..2_500 {
            if step == 1_200 {
                // A replica of the trial goes on with other random numbers; its people stay who they are.
                for key in &mut batch.state.keys {
                    key.branch = 7;
                }
            }
            batch.step();
            for at in 0..6 * lanes {
                let mode = batch.mode(0, at % 6, at / 6);
                turns += usize::from(mode != before[at]);
                before[at] = mode;
                let [speed, a, tau] = own[at];
                let expected = if mode == 1.0 { [0.5 * speed, 0.3 * a, tau] } else { [speed, a, tau] };
                let found = read(&batch, at % 6, at / 6);
                assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits), "{layout:?}");
            }
        }
        assert!(turns > 4 * 6 * lanes, "{turns}");
    }
}

#[test]
fn attention_scales_the_social_force() {
    let force = |attention: &str| {
        let text = format!(
            "{HEAD}agent a: adult {{ at = (0, 0); radius = 0.3 m; attention = {attention} }}\n\
             agent b: adult {{ at = (0.8, 0.1); radius = 0.3 m }}"
        );
        let batch = Batch::new(&scenario(&text), Layout::Trials, 0);
        [batch.state.motion.fx[0].0[0], batch.state.motion.fx[1].0[0]]
    };
    let (full, less, none) = (force("1"), force("0.25"), force("0"));
    assert!(full[0] < -50.0 && full[1] > 50.0, "{full:?}");
    assert!((less[0] / full[0] - 0.25).abs() < 1e-12);
    assert_eq!(none[0], 0.0);
    assert_eq!(
        [less[1].to_bits(), none[1].to_bits()],
        [full[1].to_bits(); 2],
        "the other one feels it in full"
    );
    // A state does the same.
    let text = format!(
        "{HEAD}behaviour blind {{ state always {{ attention = 0 }} }}\n\
         agent a: adult with blind {{ at = (0, 0); radius = 0.3 m }}\n\
         agent b: adult {{ at = (0.8, 0.1); radius = 0.3 m }}"
    );
    let batch = Batch::new(&scenario(&text), Layout::Trials, 0);
    assert_eq!(batch.state.motion.fx[0].0[0], 0.0);
    assert_eq!(batch.state.motion.fx[1].0[0].to_bits(), full[1].to_bits());
}

/// A user among others, with moves.
fn advised(with: &str) -> String {
    format!(
        "{HEAD}behaviour heedful(p) {{ on advice {{ choose {{ p: follow | 1 - p: ignore }} }} }}\n\
         agent user: adult{with} {{ at = (2, 1.5); route = west }}\n\
         agents crowd[4]: adult {{ at = uniform in near; route = west }}\n\
         moves user for 2 s {{ heading 40 deg; heading 0 deg; stop }}"
    )
}

#[test]
fn who_heeds_nothing_goes_straight_and_who_heeds_all_makes_the_move() {
    let trace = |with: &str, advice: Option<(usize, usize)>| {
        let scenario = scenario(&advised(with));
        let mut batch =
            Batch::of(&scenario, Layout::Trials, (0..8).map(|lane| (lane, 30 + lane as u64)), advice);
        let mut bits = Vec::new();
        for _ in 0..150 {
            batch.step();
            bits.push((0..5 * LANES).map(|at| batch.bits(at % 5, at / 5)).collect::<Vec<_>>());
        }
        bits
    };
    // The own way is as without advice, and so is the heading 0 deg.
    for option in 0..4 {
        let plain = trace("", Some((0, option)));
        assert_eq!(trace(" with heedful(1)", Some((0, option))), plain);
        assert_eq!(trace(" with heedful(0)", Some((0, option))), trace("", None));
        assert!(option == 0 || option == 2 || plain != trace("", None));
    }
    assert_eq!(scenario(&advised("")).moves[0].options[3].1, Move::Stop);
}

#[test]
fn advice_is_heeded_as_often_as_it_says_and_alike_for_all_moves() {
    let scenario = scenario(&advised(" with heedful(0.3)"));
    let follows = |option: usize| {
        let mut stops = Vec::new();
        for first in (0..1_600).step_by(LANES) {
            let trials = (0..LANES).map(|lane| (lane, first + lane as u64));
            let mut batch = Batch::of(&scenario, Layout::Trials, trials, Some((0, option)));
            batch.step();
            stops.extend(
                batch.state.driving.ey[0]
                    .0
                    .map(|ey| ey.abs() > 0.3)
                    .iter()
                    .zip(batch.state.driving.speed[0].0)
                    .map(|(turned, drive)| if option == 3 { drive == 0.0 } else { *turned }),
            );
        }
        stops
    };
    let (headed, stopped) = (follows(1), follows(3));
    let share = headed.iter().filter(|&&followed| followed).count() as f64 / 1_600.0;
    assert!(near(share, 0.3, 0.21_f64.sqrt(), 1_600.0), "{share}");
    assert_eq!(headed, stopped, "the same trials follow, whatever the move");
}

#[test]
fn conditions_read_agents_processes_and_behaviours() {
    let text = format!(
        "{HEAD}process bell {{ var n: 0 .. 500 = 0\n when n < 500 -> n = n + 1 }}\n\
         process count {{ var runs: 0 .. 5000 = 0\n when lead.pace == fast -> runs = runs + 1 }}\n\
         behaviour pace {{\n state slow {{ speed = 0.4 m/s; when bell.n == 100 -> fast }}\n\
         state fast {{ speed = 1.2 m/s; when travelled(self) > 5 m -> done }}\n state done {{ speed = 0 m/s }} }}\n\
         behaviour shy {{ state calm {{ when distance(self, lead) > 4 m -> alone }}; state alone {{ }} }}\n\
         agent lead: adult with pace {{ at = (0, 0); route = west; noise = 0 m/s }}\n\
         agent other: adult with shy {{ at = (1, 20); noise = 0 m/s }}"
    );
    let scenario = scenario(&text);
    let mut batch = Batch::new(&scenario, Layout::Trials, 0);
    let mut modes = Vec::new();
    for _ in 0..600 {
        let before = batch.state.clone();
        batch.step();
        let mode = batch.mode(0, 0, 3);
        modes.push(mode);
        let (n, way) = (before.variables[0].0[3], before.motion.travelled[0].0[3]);
        if n == 100.0 {
            assert_eq!(mode, 1.0, "what holds before a step shows after it");
        }
        assert!(way <= 5.0 || mode == 2.0, "at {way} m");
        assert_eq!(batch.mode(1, 1, 3), 1.0, "already too far away at the start");
    }
    assert_eq!(modes.iter().position(|&mode| mode == 1.0), Some(100));
    assert_eq!(modes.last(), Some(&2.0));
    let fast = modes.iter().filter(|&&mode| mode == 1.0).count();
    assert_eq!(batch.state.variables[1].0[3], fast as f64, "a process reads the state of a behaviour");
}

#[test]
fn branches_of_transitions_have_their_probabilities() {
    let text = format!(
        "{HEAD}process world {{ var p = 0.2 }}\nbehaviour b {{\n\
         state start {{ after 0.02 s -> world.p: left | 0.5: right | 0.5 - world.p: far }}\n\
         state left {{ }}; state right {{ }}; state far {{ speed = 0.1 m/s + 0.5 * speed }} }}\n\
         agents crowd[40]: adult with b {{ at = uniform in near }}"
    );
    let scenario = scenario(&text);
    let mut counts = [0.0; 4];
    let n = 40.0 * 8.0 * 10.0;
    for first in 0..10 {
        let mut batch = Batch::new(&scenario, Layout::Trials, 8 * first);
        batch.step();
        for at in 0..40 * LANES {
            counts[batch.mode(0, at % 40, at / 40) as usize] += 1.0;
        }
    }
    assert_eq!(counts[0], 0.0);
    for (found, p) in counts[1..].iter().zip([0.2, 0.5, 0.3_f64]) {
        assert!(near(found / n, p, (p * (1.0 - p)).sqrt(), n), "{counts:?}");
    }
}

#[test]
fn of_times_that_end_within_one_step_the_shortest_wins() {
    let first = |a: &str, b: &str| {
        let text = format!(
            "horizon = 2 s\nstep = 0.1 s\nkind adult: sfm preset helbing2000 {{ }}\n\
             behaviour race {{ state a {{ after {a} -> b; after {b} -> c }}; state b {{ }}; state c {{ }} }}\n\
             agent me: adult with race {{ at = (0, 0) }}\n"
        );
        let study = compiled(&text, "estimate P(F me.race == b) by fixed(trials = 4000)\n");
        answered(&study, 3, 1, 10_000).results[0].estimate.unwrap()
    };
    let n = 4000.0;
    assert!(near(first("exponential(0.1 s)", "exponential(0.1 s)"), 0.5, 0.5, n));
    // P(X < Y) of uniform laws on 1 .. 9 and 1 .. 3 is 1/8.
    assert!(near(first("uniform(0.01 s, 0.09 s)", "uniform(0.01 s, 0.03 s)"), 0.125, 0.331, n));
}

#[test]
fn a_state_can_send_elsewhere_and_back() {
    let text = format!(
        "{HEAD}behaviour errand {{ state going {{ after 4 s -> away }}\n\
         state away {{ route = (-3, 30) -> wait 1 s -> (-6, 30); after 60 s -> going }} }}\n\
         agent a: adult with errand {{ at = (0, 0); route = (-20, 0) -> west; noise = 0 m/s; speed = 1 m/s }}"
    )
    .replace("after 60 s", "when position(self).y > 5 m");
    let scenario = scenario(&text);
    let mut batch = Batch::new(&scenario, Layout::Trials, 0);
    let mut seen = Vec::new();
    for _ in 0..1_500 {
        batch.step();
        let (s, mode) = (&batch.state, batch.mode(0, 0, 0));
        seen.push((mode, s.driving.ex[0].0[0], s.driving.ey[0].0[0], s.motion.x[0].0[0], s.motion.y[0].0[0]));
    }
    assert!(seen[..199].iter().all(|s| s.0 == 0.0 && s.1 < -0.99), "west first");
    assert!(seen.iter().any(|s| s.0 == 1.0 && s.2 > 0.9), "then north");
    let end = seen.windows(2).position(|pair| pair[0].0 == 1.0 && pair[1].0 == 0.0).unwrap();
    assert!(seen[end].4 > 5.0 && seen[end].4 < 5.2);
    let (_, ex, ey, ..) = seen[end + 100];
    assert!(ex < -0.9 && ey < -0.2, "back to the leg of before: {ex} {ey}");
}

#[test]
fn several_behaviours_of_one_agent_and_the_order_of_with() {
    let text = |with: &str| {
        format!(
            "{HEAD}behaviour tired {{ state always {{ speed = 0.5 * speed; tau = 0.7 s }} }}\n\
             behaviour brisk {{ state always {{ speed = uniform(1.6 m/s, 1.8 m/s) }} }}\n\
             agent a: adult with {with} {{ at = (0, 0); route = west; speed = 1 m/s }}"
        )
    };
    let read = |with: &str| {
        let batch = Batch::new(&scenario(&text(with)), Layout::Trials, 0);
        (batch.state.bodies[Parameter::Speed][0].0, batch.state.bodies[Parameter::Tau][0].0[0])
    };
    let (speeds, tau) = read("tired, brisk");
    assert!(speeds.iter().all(|speed| (1.6..=1.8).contains(speed)) && speeds[0] != speeds[1]);
    assert_eq!(tau, 0.7);
    assert_eq!(read("brisk, tired"), ([0.5; LANES], 0.7), "the last one that sets a parameter wins");
}

#[test]
fn what_nobody_can_move_with_is_an_error_of_the_model() {
    let text = format!(
        "{HEAD}process clock {{ var n: 0 .. 100 = 0\n when n < 100 -> n = n + 1 }}\n\
         behaviour slower {{ state calm {{ after 1 s -> odd }}; state odd {{ tau = (49 - clock.n) * tau }} }}\n\
         agent a: adult with slower {{ at = (0, 0) }}"
    );
    let study = compiled(&text, "estimate P(F<=2 s (travelled(a) > 100 m)) within 0.1");
    let run = answered(&study, 0, 1, 1_000);
    let reason = format!("{:?}", run.failure.unwrap());
    assert!(reason.contains("`slower` of a sets `tau` to -0.5"), "{reason}");
}

#[test]
fn a_trial_is_the_same_in_every_lane_and_beside_any_other() {
    let text = format!(
        "{HEAD}{PHONE}agents crowd[5]: adult with phone {{ at = uniform in near; route = west }}\n\
         source doors: adult with phone {{ at = uniform in near; every = exponential(2 s); route = west }}"
    );
    let scenario = scenario(&text);
    let agents = scenario.agents.len();
    let end = |trials: &[(usize, u64)], lane: usize| {
        let mut batch = Batch::of(&scenario, Layout::Trials, trials.iter().copied(), None);
        for _ in 0..500 {
            batch.step();
        }
        let modes: Vec<f64> = (0..agents).map(|k| batch.mode(0, k, lane)).collect();
        let here: Vec<bool> = (0..agents).map(|k| batch.present(k, lane)).collect();
        ((0..agents).map(|k| batch.bits(k, lane)).collect::<Vec<_>>(), modes, here)
    };
    let alone = end(&[(0, 5)], 0);
    assert!(alone.2.iter().filter(|here| **here).count() > 5, "some have come");
    assert_eq!(end(&[(6, 5)], 6), alone);
    assert_eq!(end(&[(0, 1), (1, 5), (2, 7), (7, 9)], 1), alone);
    let mut batch = Batch::new(&scenario, Layout::Trials, 100);
    for _ in 0..200 {
        batch.step();
    }
    // A lane takes the next trial while the others go on.
    let key = smc::base::random::TrialKey { seed: 9, index: 5, branch: 0 };
    smc::kernel::start::load(&batch.program, &mut batch.state, 3, key, None).unwrap();
    smc::kernel::dynamics::refresh(&batch.program, &mut batch.state, &mut batch.scratch, Mask::lane(3));
    for _ in 0..500 {
        batch.step();
    }
    assert_eq!((0..agents).map(|k| batch.bits(k, 3)).collect::<Vec<_>>(), alone.0);
}

#[test]
fn threads_and_batches_change_no_byte() {
    let text = format!(
        "{HEAD}{PHONE}agent user: adult {{ at = (1, 1); route = west }}\n\
         source doors: adult with phone {{ at = uniform in near; every = exponential(2 s); route = west }}"
    );
    let study =
        compiled(&text, "estimate P(F<=8 s (min(distance(user, a) for a in doors) < 1 m)) within 0.05");
    let runs = [1, 2, 8].map(|threads| {
        let mut results = answered(&study, 3, threads, 2_000).results;
        for result in &mut results {
            result.elapsed_s = 0.0;
        }
        results
    });
    assert_eq!(runs[0], runs[1]);
    assert_eq!(runs[0], runs[2]);
    let user = agent(&study.worlds[0].scenario, "user");
    assert_eq!(user, 0);
}

#[test]
fn names_and_functions_of_a_behaviour_see_one_another_and_the_own_parameters() {
    let body = |lets: &str, slow: &str, near: &str| {
        format!(
            "{HEAD}behaviour wary(gap) {{ {lets}; state walking {{ when {near} -> waiting }}\n\
             state waiting {{ speed = {slow}; when !({near}) -> walking }} }}\n\
             agent post: adult {{ at = (3, 2) }}\n\
             agents crowd[4]: adult with wary(1.5 m) {{ at = uniform in rect (0, 0) .. (2, 4); route = west }}"
        )
    };
    let plain = body(
        "",
        "0.25 * speed",
        "(exists a in others(self): distance(self, a) < 1.5 m & (distance(self, post) < 3 m | distance(self, a) < 1 m))",
    );
    // Used before they are declared; `a` inside is the argument, outside the running one.
    let named = body(
        "let slow = part * speed; let part = 1 / 4\n\
         let close = exists a in others(self): near(a) & (of_post(2 * gap) | distance(self, a) < 1 m)\n\
         let near(a) = distance(self, a) < gap; let of_post(d) = distance(self, post) < d",
        "slow",
        "close",
    );
    let (mut a, mut b) =
        (Batch::new(&scenario(&plain), Layout::Trials, 0), Batch::new(&scenario(&named), Layout::Trials, 0));
    let mut waiting = 0;
    for _ in 0..500 {
        a.step();
        b.step();
        waiting += (0..4 * LANES).filter(|&at| a.mode(0, 1 + at % 4, at / 4) == 1.0).count();
        assert_eq!(a.state.motion.x, b.state.motion.x);
    }
    assert!((800..15_200).contains(&waiting), "{waiting}");
}

#[test]
fn a_condition_may_ask_for_the_state_of_another_behaviour() {
    let text = |whose: &str| {
        format!(
            "{HEAD}behaviour mood {{ state calm {{ after 2 s -> angry }}; state angry {{ }} }}\n\
             behaviour phone {{ state away {{ when {whose}.mood == angry -> looking }}; state looking {{ }} }}\n\
             agent me: adult with mood, phone {{ at = (0, 0) }}\n\
             agent other: adult with mood {{ at = (50, 0) }}\n\
             agent third: adult {{ at = (100, 0) }}"
        )
    };
    for whose in ["self", "me", "other"] {
        let query = "estimate P(F<=1.96 s (me.phone == looking)), P(F<=2.1 s (me.phone == looking)) by fixed(trials = 8)";
        let run = answered(&compiled(&text(whose), query), 0, 1, 100);
        let successes: Vec<u64> = run.results.iter().map(|result| result.consumed.counts.successes).collect();
        assert_eq!(successes, [0, 8], "{whose}");
    }
    // Of a behaviour that nobody has it is not known who could ask for what.
    let nobody = format!(
        "{HEAD}behaviour mood {{ state calm {{ after 2 s -> angry }}; state angry {{ }} }}\n\
         behaviour phone {{ state away {{ when self.mood == angry -> looking }}; state looking {{ }} }}\n\
         agent me: adult {{ at = (0, 0) }}"
    );
    compiled(&nobody, "");
    let errors = crate::texts::compiled(&text("third"), "").unwrap_err();
    assert!(errors.contains("E0201") && errors.contains("`third` has no behaviour `mood`"), "{errors}");
}
