//! The recordings: steps to fit, steps that are held out, and held-out takes that a walk can be compared with.

use super::super::mocap::{folder, takes, text};
use super::end_of;
use smc::base::geometry::{Segment, Vec2};
use smc::data::mocap::{Take, read_take_table};
use smc::gait::model::{LearnedGait, Options, fit};
use smc::gait::steps::{Contact, cut};
use smc::gait::walk::{PlacedStep, Walker};
use smc::gait::{RecordedStep, Stance};
use smc::model::{Barrier, Obstacle};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// CMU subjects that no model sees.
pub(super) const HELD_OUT: [&str; 8] = ["06", "12", "26", "29", "32", "38", "45", "46"];

/// Walks that are drawn for a take.
pub(super) const WALKS: u64 = 20;

/// A held-out take that goes on after its first two steps.
pub(super) struct Captured {
    pub(super) take: Take,
    pub(super) is_turn: bool,
    /// Steps that follow each other.
    pub(super) steps: Vec<RecordedStep>,
}

/// Steps of the recordings.
pub(super) struct Steps {
    pub(super) train: Vec<RecordedStep>,
    pub(super) held_out: Vec<RecordedStep>,
    pub(super) captured: Vec<Captured>,
}

impl Steps {
    /// `None` where the recordings are absent, which [`folder`] says.
    pub(super) fn read() -> Option<Self> {
        let folder = folder()?;
        let mut table = read_take_table(&text(&folder, "takes.csv")).expect("the table is well formed");
        for row in table.iter_mut().filter(|row| row.file.ends_with(".csv")) {
            let style = row.file.rsplit(['/', '.']).nth(1).unwrap_or_default();
            row.subject = style.to_owned();
        }
        let mut styles = BTreeMap::<&str, BTreeSet<&str>>::new();
        for row in table.iter().filter(|row| !row.clip.is_empty()) {
            styles.entry(&row.subject).or_default().insert(&row.name);
        }
        let fifth: BTreeSet<&str> =
            styles.values().flat_map(|names| names.iter().skip(FIRST).step_by(5).copied()).collect();
        let mut steps = Self { train: Vec::new(), held_out: Vec::new(), captured: Vec::new() };
        for take in takes(&folder, &table) {
            let Ok(cut) = cut(&take, Contact::Rest) else { continue };
            if !HELD_OUT.contains(&take.subject.as_str()) && !fifth.contains(take.name.as_str()) {
                steps.train.extend(cut.steps);
                continue;
            }
            steps.held_out.extend(cut.steps.iter().cloned());
            let follows = |a: &RecordedStep, b: &RecordedStep| a.number + 1 == b.number && a.foot != b.foot;
            let longest = cut.steps.chunk_by(follows).max_by_key(|part| part.len()).unwrap_or_default();
            if longest.len() >= 4 {
                let is_turn = take.name.contains("turn") || matches!(take.subject.as_str(), "45" | "46");
                steps.captured.push(Captured { take, is_turn, steps: longest.to_vec() });
            }
        }
        Some(steps)
    }

    pub(super) fn model(&self, options: &Options) -> Arc<LearnedGait> {
        Arc::new(fit(&self.train, options).expect("the steps have a model").0)
    }
}

/// The first of the clips that are held out.
const FIRST: usize = 4;

impl Captured {
    pub(super) fn is_known(&self) -> bool {
        !HELD_OUT.contains(&self.take.subject.as_str())
    }

    pub(super) fn root(&self, time: f64) -> Vec2 {
        let at = time * self.take.fps;
        let k = (at as usize).min(self.take.root.len() - 2);
        self.take.root[k] + (self.take.root[k + 1] - self.take.root[k]) * (at - k as f64).min(1.0)
    }

    /// Direction of +x of the frame of a step on the floor.
    pub(super) fn heading(&self, step: &RecordedStep) -> Vec2 {
        let (way, end) = (self.root(step.span.1) - self.root(step.span.0), end_of(&step.shape));
        Vec2::new(end.x * way.x + end.y * way.y, end.x * way.y - end.y * way.x).normalize()
    }

    /// Somebody who has made the first two steps.
    pub(super) fn walker(&self) -> Walker {
        let step = &self.steps[1];
        let (tangent, heading) = (step.shape.curve().tangent(1.0), self.heading(step));
        let heading = Vec2::new(
            tangent.x * heading.x - tangent.y * heading.y,
            tangent.x * heading.y + tangent.y * heading.x,
        );
        let mut walker = Walker::standing(self.root(step.span.1), Some(heading));
        walker.stance = Stance { last: Some((step.foot, step.shape)), drift: [0.0; 8] };
        walker.foot = step.foot.other();
        walker.number = 2;
        walker
    }

    pub(super) fn goal(&self) -> Vec2 {
        self.root(self.steps[self.steps.len() - 1].span.1)
    }

    /// A wall on the inside of a turn, up to 0.3 m from the path, so that the way is that of the take.
    pub(super) fn inside(&self) -> Barrier {
        let (from, to) = (self.walker().at, self.goal());
        let along = (to - from).normalize();
        let off = |p: &Vec2| along.x * (p.y - from.y) - along.y * (p.x - from.x);
        let begin = (self.steps[2].span.0 * self.take.fps) as usize;
        let path = &self.take.root[begin..];
        let apex =
            path.iter().max_by(|a, b| off(a).abs().total_cmp(&off(b).abs())).expect("there are places");
        let out = Vec2::new(-along.y, along.x) * off(apex).signum();
        let wall = Segment::new(apex - out * 0.3, apex - out * (off(apex).abs() + 1.5));
        Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![wall]) }
    }

    /// The direction of the last half second.
    pub(super) fn ending(&self) -> Vec2 {
        let end = self.steps[self.steps.len() - 1].span.1;
        (self.root(end) - self.root(end - 0.5)).normalize()
    }

    /// Length, time and steps of a walk up to the line across the end of the take.
    pub(super) fn passed(&self, steps: &[PlacedStep]) -> [f64; 3] {
        let (goal, ending) = (self.goal(), self.ending());
        let [mut length, mut time, mut count] = [0.0; 3];
        for step in steps {
            for k in 0..50 {
                let (from, to) = (step.place(f64::from(k) / 50.0), step.place(f64::from(k + 1) / 50.0));
                if (to - goal).dot(&ending) >= 0.0 && (to - goal).norm() < 1.5 {
                    return [length, time, count];
                }
                length += (to - from).norm();
                time += step.duration() / 50.0;
                count += 1.0 / 50.0;
            }
        }
        [length, time, count]
    }

    /// The steps after the first two.
    pub(super) fn rest(&self) -> &[RecordedStep] {
        &self.steps[2..]
    }
}
