//! One lane is one trial, with the same bits at every vector width: what one lane does moves no byte of
//! another.

use crate::crowd::{Crowd, Person, bits_of, p, streams};
use fearless_simd::Level;
use smc::base::lanes::Mask;
use smc::kernel::{Layout, Program, Scratch, State, refresh, step};

/// Two streams with noise and own parameters; the narrower, the more contact.
fn scene(n: usize, wide: f64, high: f64) -> Crowd {
    let mut scene = streams(n, wide, high, 0.3, "0.01");
    for (k, one) in scene.people.iter_mut().enumerate() {
        *one = Person {
            noise: 0.1,
            lambda: 0.3,
            mass: 60.0 + (k % 17) as f64,
            radius: 0.2 + 0.004 * (k % 13) as f64,
            tau: 0.4 + 0.01 * (k % 11) as f64,
            ..one.clone()
        };
    }
    scene
}

fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::baseline(), best];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
        levels.extend(best.as_avx512().map(Level::Avx512));
    }
    levels
}

#[test]
fn all_levels_have_the_same_bits() {
    for layout in [Layout::Trials, Layout::Agents] {
        for own_b in [false, true] {
            let mut scene = scene(45, 5.0, 3.0);
            if own_b {
                for (k, one) in scene.people.iter_mut().enumerate() {
                    one.b = 0.07 + 0.001 * (k % 9) as f64;
                    one.a2 = 20.0;
                    one.b2 = 0.5;
                }
            }
            let program = scene.program();
            let run = |level: Level| {
                let mut state = State::new(layout, 45);
                for lane in 0..state.width() {
                    scene.load(&mut state, lane, lane as u64);
                }
                let mut scratch = Scratch::at_level(level);
                refresh(&program, &mut state, &mut scratch, Mask::ALL);
                for _ in 0..80 {
                    step(&program, &mut state, &mut scratch);
                }
                (0..state.width()).map(|lane| bits_of(&state, lane)).collect::<Vec<_>>()
            };
            let first = run(Level::baseline());
            for level in levels() {
                assert!(run(level) == first, "{layout:?} {level:?}");
            }
        }
    }
}

/// Bits of trial `index` after `steps` steps, alone in `lane`.
fn alone(scene: &Crowd, program: &Program, index: u64, lane: usize, steps: usize) -> Vec<u64> {
    let mut state = State::new(Layout::Trials, scene.people.len());
    let mut scratch = Scratch::default();
    scene.load(&mut state, lane, index);
    refresh(program, &mut state, &mut scratch, Mask::lane(lane));
    for _ in 0..steps {
        step(program, &mut state, &mut scratch);
    }
    bits_of(&state, lane)
}

#[test]
fn a_trial_is_the_same_in_every_lane() {
    let scene = scene(20, 4.0, 3.0);
    let program = scene.program();
    let first = alone(&scene, &program, 5, 0, 60);
    assert_eq!(alone(&scene, &program, 5, 3, 60), first);
    assert_eq!(alone(&scene, &program, 5, 7, 60), first);
    assert_ne!(alone(&scene, &program, 6, 0, 60), first);
}

#[test]
fn dense_early_ending_late_starting_and_diverging_neighbours_move_no_byte() {
    let quiet = scene(20, 9.0, 5.0);
    let mut dense = quiet.clone();
    for (k, one) in dense.people.iter_mut().enumerate() {
        one.at = p(0.3 + 0.4 * (k % 5) as f64, 0.3 + 0.4 * (k / 5) as f64);
    }
    let mut lost = quiet.clone();
    lost.people[4].velocity = p(f64::INFINITY, 1.0);
    lost.people[9].at = p(f64::NAN, 1.0);
    let program = quiet.program();
    let mut state = State::new(Layout::Trials, 20);
    let mut scratch = Scratch::default();
    quiet.load(&mut state, 3, 33);
    quiet.load(&mut state, 6, 66);
    dense.load(&mut state, 1, 11);
    lost.load(&mut state, 5, 55);
    refresh(&program, &mut state, &mut scratch, Mask::ALL);
    for k in 0..90 {
        if k == 20 {
            // The dense trial is decided.
            state.occupied &= !Mask::lane(1);
        }
        if k == 30 {
            let others: Vec<_> = [1, 3, 5, 6].map(|lane| bits_of(&state, lane)).into();
            quiet.load(&mut state, 0, 33);
            dense.load(&mut state, 2, 22);
            refresh(&program, &mut state, &mut scratch, Mask(0b101));
            assert_eq!(others, [1, 3, 5, 6].map(|lane| bits_of(&state, lane)));
        }
        let ended = bits_of(&state, 1);
        step(&program, &mut state, &mut scratch);
        assert!(k < 20 || bits_of(&state, 1) == ended, "a lane without a trial keeps its bytes");
    }
    assert_eq!(state.diverged, Mask::lane(5));
    assert_eq!(bits_of(&state, 3), alone(&quiet, &program, 33, 0, 90));
    assert_eq!(bits_of(&state, 6), alone(&quiet, &program, 66, 2, 90));
    assert_eq!(bits_of(&state, 0), alone(&quiet, &program, 33, 1, 60));
    assert_eq!(bits_of(&state, 2), alone(&dense, &program, 22, 0, 60));
    assert_eq!(bits_of(&state, 1), alone(&dense, &program, 11, 0, 20));
}

#[test]
fn a_scratch_holds_no_part_of_the_state() {
    for layout in [Layout::Trials, Layout::Agents] {
        let scene = scene(25, 3.0, 3.0);
        let program = scene.program();
        let start = |index: u64| {
            let mut state = State::new(layout, 25);
            scene.load(&mut state, 0, index);
            refresh(&program, &mut state, &mut Scratch::default(), Mask::lane(0));
            state
        };
        let (mut a, mut b) = (start(1), start(2));
        let (mut own_a, mut own_b) = (a.clone(), b.clone());
        let (mut shared, mut scratch_a, mut scratch_b) =
            (Scratch::default(), Scratch::default(), Scratch::default());
        for _ in 0..40 {
            step(&program, &mut a, &mut shared);
            step(&program, &mut b, &mut shared);
            step(&program, &mut own_a, &mut scratch_a);
            step(&program, &mut own_b, &mut scratch_b);
        }
        assert_eq!(bits_of(&a, 0), bits_of(&own_a, 0));
        assert_eq!(bits_of(&b, 0), bits_of(&own_b, 0));
    }
}

#[test]
fn the_absent_neither_move_nor_matter() {
    for layout in [Layout::Trials, Layout::Agents] {
        let mut with = scene(24, 4.0, 3.0);
        for k in [3, 8, 20] {
            with.people[k].present = false;
        }
        let mut elsewhere = with.clone();
        elsewhere.people[3].at = with.people[4].at;
        let (mut one, mut other) = (with.start(layout), elsewhere.start(layout));
        one.steps(50);
        other.steps(50);
        for k in 0..24 {
            if k != 3 {
                assert_eq!(one.at(k), other.at(k));
            }
        }
        assert_eq!(one.at(8), with.people[8].at);
        assert_eq!(one.velocity(8), with.people[8].velocity);
    }
}

#[test]
fn a_place_far_from_the_others_in_a_lane_counts_once_it_is_taken() {
    // Somebody enters next to others long after the neighbour list was made.
    let mut scene = scene(6, 3.0, 2.0);
    scene.people[2].present = false;
    let mut run = scene.start(Layout::Trials);
    run.steps(5);
    run.state.present[2] |= Mask::lane(0);
    let (x, y) = (run.state.motion.x[3].0[0] + 0.5, run.state.motion.y[3].0[0]);
    run.state.motion.x[2].0[0] = x;
    run.state.motion.y[2].0[0] = y;
    refresh(&run.program, &mut run.state, &mut run.scratch, Mask::lane(0));
    assert!(run.force(2).norm() > 100.0);
    run.steps(5);
    assert!(run.at(2) != p(x, y));
}
