//! Steps drawn from a model: walks of new persons, each from standing.

use super::LearnedGait;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::gait::{Draws, Foot, Gait, Phase, RecordedStep, Stance};
use std::sync::Arc;

/// Steps of each person.
const EACH: u32 = 20;

impl LearnedGait {
    /// So many steps, in walks of twenty; the subject is the number of the person. They have neither take nor width.
    pub fn sample(self: &Arc<Self>, count: usize, seed: u64) -> impl Iterator<Item = RecordedStep> {
        let gait = Arc::clone(self);
        (0..).flat_map(move |index: u64| walk(&gait, TrialKey { seed, index, branch: 0 })).take(count)
    }
}

fn walk(gait: &Arc<LearnedGait>, key: TrialKey) -> Vec<RecordedStep> {
    let own = Stream::of(key, 0, Purpose::Run);
    let mut normals = [0.0; LearnedGait::NORMALS];
    for (k, pair) in (0..).zip(normals.chunks_mut(2)) {
        pair.copy_from_slice(&own.normal_pair(k)[..pair.len()]);
    }
    let person = gait.person(&normals);
    let stream = Stream::of(key, 0, Purpose::Step);
    let mut foot = if key.index.is_multiple_of(2) { Foot::Left } else { Foot::Right };
    let mut stance = Stance::default();
    let step = |number: u32| {
        stance = person.step(&stance, foot, 1.0, Draws::of(stream, number, 0));
        let (made, shape) = stance.last?;
        foot = foot.other();
        let phase = if number == 0 { Phase::First } else { Phase::Inner };
        let (take, subject) = (String::new(), key.index.to_string());
        let span = (0.0, shape.duration);
        Some(RecordedStep { take, subject, number, foot: made, phase, span, width: 0.0, shape })
    };
    (0..EACH).map_while(step).collect()
}
