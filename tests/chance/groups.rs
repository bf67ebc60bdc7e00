//! Groups as one body: they pass through each other.

use super::{Batch, agent, scenario};
use smc::compile::presets::PRESETS;
use smc::kernel::Layout;
use smc::model::Kind;

/// When each group has walked 20 m, s: one of `n` from the west and, if there is one, one from the east, `offset` metres
/// beside it.
fn times(preset: &str, n: usize, offset: Option<f64>, layout: Layout) -> Vec<f64> {
    let other = offset.map(|offset| {
        format!("group east[{n}]: adult as particle {{ at = (20, {offset}); route = (-80, {offset}) }}\n")
    });
    let text = format!(
        "horizon = 60 s\nstep = 0.02 s\nkind adult: sfm preset {preset} {{ radius = 0.3 m; speed = 1.34 m/s }}\n\
         group west[{n}]: adult as particle {{ at = (0, 0); route = (100, 0) }}\n{}",
        other.unwrap_or_default()
    );
    let scene = scenario(&text);
    let mut batch = Batch::new(&scene, layout, 0);
    let walkers: Vec<(usize, f64)> = [("west", 0.0), ("east", 20.0)]
        .into_iter()
        .take(scene.agents.len())
        .map(|(name, from)| (agent(&scene, name), from))
        .collect();
    let mut times = vec![f64::INFINITY; walkers.len()];
    for step in 1..3_000 {
        batch.step();
        for ((k, from), time) in walkers.iter().zip(&mut times) {
            let slot = batch.state.slot(*k, 0);
            if (batch.state.motion.x[slot.block].0[slot.lane] - from).abs() >= 20.0 {
                *time = time.min(0.02 * f64::from(step));
            }
        }
    }
    times
}

#[test]
fn two_groups_pass_through_each_other_with_every_preset() {
    // The collision-free speed model moves no group as one body.
    for preset in PRESETS.iter().filter(|preset| preset.model == Kind::Sfm) {
        for n in 2..=6 {
            let alone = times(preset.name, n, None, Layout::Trials)[0];
            for (k, offset) in [0.0, 0.02, 0.25, 0.5, 0.75, 1.0].into_iter().enumerate() {
                let layout = [Layout::Trials, Layout::Agents][(k + n) % 2];
                for time in times(preset.name, n, Some(offset), layout) {
                    let lost = time - alone;
                    assert!(lost < 0.5, "{} of {n}, {offset} m, {layout:?}: {lost} s", preset.name);
                }
            }
        }
    }
}
