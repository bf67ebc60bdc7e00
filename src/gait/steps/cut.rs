//! Cutting a take into steps, from contact to contact.
//!
//! A walk that begins or ends in standing has a first or last step: from the moment at which the root begins to move, and to the
//! moment at which it stands.

use super::contact::{Contact, Support};
use super::signal::{percentile, speed};
use crate::base::geometry::{Vec2, cross};
use crate::data::mocap::Take;
use crate::gait::{Curve, Foot, Phase, RecordedStep, SPANS, Shape};
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

/// Somebody stands whose root is slower than this, m/s, with both feet on the ground, for at least `STANDING_TIME`, s.
const STANDING_SPEED: f64 = 0.2;
const STANDING_TIME: f64 = 0.2;
/// The longest duration of a step, s.
const LONGEST_TIME: f64 = 2.0;
/// The shortest and the longest root path of a step, m.
const LENGTHS: (f64, f64) = (0.05, 2.0);
/// Why a step was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dropped {
    /// The contact with which it begins may lie before the begin of the take.
    Begun,
    /// The contact before it is of the same foot.
    SameFoot,
    /// It begins and ends in standing.
    Alone,
    /// It lasts longer than 2 s.
    Slow,
    /// Its root path is shorter than 0.05 m.
    Short,
    /// Its root path is longer than 2 m.
    Long,
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Begun => "began before the take",
            Self::SameFoot => "follow a contact of the same foot",
            Self::Alone => "begin and end in standing",
            Self::Slow => "last longer than 2 s",
            Self::Short => "are shorter than 0.05 m",
            Self::Long => "are longer than 2 m",
        })
    }
}

/// What a take gives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cut {
    /// Its steps, in the order of time.
    pub steps: Vec<RecordedStep>,
    /// How many were dropped, by reason.
    pub dropped: BTreeMap<Dropped, usize>,
}

/// A take without steps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("take `{take}` has no steps{}", reasons(.dropped))]
pub struct NoSteps {
    /// The take.
    pub take: String,
    /// How many were dropped, by reason.
    pub dropped: BTreeMap<Dropped, usize>,
}

fn reasons(dropped: &BTreeMap<Dropped, usize>) -> String {
    let all: Vec<String> = dropped.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    if all.is_empty() { String::new() } else { format!(" ({})", all.join(", ")) }
}

/// Cuts a take into steps.
///
/// # Errors
/// A take without steps.
pub fn cut(take: &Take, contact: Contact) -> Result<Cut, NoSteps> {
    let supports = contact.supports(take);
    let stands = stands(take, &supports);
    let mut cut = Cut::default();
    let mut number = 0;
    for (k, pair) in supports.windows(2).enumerate().filter(|(_, pair)| pair[1].seen) {
        let (before, end) = (&pair[0], &pair[1]);
        let next = supports.get(k + 2).map_or(f64::INFINITY, |next| next.from);
        let start = stands.iter().rev().map(|stand| stand.1).find(|at| (before.from..end.from).contains(at));
        let stop = stands.iter().map(|stand| stand.0).find(|at| (end.from..next).contains(at));
        let phase = match (start, stop) {
            (Some(_), _) => Phase::First,
            (None, Some(_)) => Phase::Last,
            (None, None) => Phase::Inner,
        };
        let span = (start.unwrap_or(before.from), stop.unwrap_or(end.from));
        let shape = shape(take, span).aligned();
        let length = shape.curve().length();
        let reason = match phase {
            Phase::First if stop.is_some() => Some(Dropped::Alone),
            Phase::Inner | Phase::Last if !before.seen => Some(Dropped::Begun),
            Phase::Inner | Phase::Last if before.foot == end.foot => Some(Dropped::SameFoot),
            _ if shape.duration > LONGEST_TIME => Some(Dropped::Slow),
            _ if length < LENGTHS.0 => Some(Dropped::Short),
            _ if length > LENGTHS.1 => Some(Dropped::Long),
            _ => None,
        };
        // A number that is left out says that the step before it is not the one that led to it.
        number += u32::from(phase == Phase::First && number > 0);
        if let Some(reason) = reason {
            *cut.dropped.entry(reason).or_default() += 1;
        } else {
            let width = width(take, span, end);
            let (take, subject) = (take.name.clone(), take.subject.clone());
            cut.steps.push(RecordedStep { take, subject, number, foot: end.foot, phase, span, width, shape });
        }
        number += 1;
    }
    if cut.steps.is_empty() {
        return Err(NoSteps { take: take.name.clone(), dropped: cut.dropped });
    }
    Ok(cut)
}

/// The distance between the ankles at the contact across the direction of the root path; negative where the feet cross.
fn width(take: &Take, span: (f64, f64), contact: &Support) -> f64 {
    let (k, _) = frame(take, contact.from);
    let ankle = |foot: Foot| {
        let place = take.feet[foot as usize].ankle[k];
        Vec2::new(place[0], place[1])
    };
    let way = root(take, span.1) - root(take, span.0);
    let across = cross(way, ankle(Foot::Left) - ankle(Foot::Right));
    if way.norm() > 0.0 { across / way.norm() } else { 0.0 }
}

/// When somebody stands, s.
fn stands(take: &Take, supports: &[Support]) -> Vec<(f64, f64)> {
    let points: Vec<[f64; 3]> = take.root.iter().map(|p| [p.x, p.y, 0.0]).collect();
    let speeds = speed(&points, take.fps);
    let still = |k: &usize| {
        let time = *k as f64 / take.fps;
        let rests = |foot| supports.iter().any(|s| s.foot == foot && s.from <= time && time <= s.to);
        speeds[*k] < STANDING_SPEED && rests(Foot::Left) && rests(Foot::Right)
    };
    let frames: Vec<usize> = (0..speeds.len()).filter(still).collect();
    frames
        .chunk_by(|a, b| a + 1 == *b)
        .map(|part| (part[0] as f64 / take.fps, part[part.len() - 1] as f64 / take.fps))
        .filter(|(from, to)| to - from >= STANDING_TIME)
        .collect()
}

// The landmarks of a stretch of the root path.

/// Landmarks between the two ends.
const INNER: usize = SPANS - 1;

/// The frame before a time, and the share of the way to the next one.
fn frame(take: &Take, time: f64) -> (usize, f64) {
    let last = take.root.len().saturating_sub(2);
    let at = if time > 0.0 { time * take.fps } else { 0.0 };
    let k = (at as usize).min(last);
    (k, (at - k as f64).min(1.0))
}

/// The root at a time.
fn root(take: &Take, time: f64) -> Vec2 {
    let (k, share) = frame(take, time);
    take.root[k] + (take.root[k + 1] - take.root[k]) * share
}

/// The curve that begins and ends where the root does, and is nearest to it in all frames between (least squares).
fn shape(take: &Take, (from, to): (f64, f64)) -> Shape {
    let duration = to - from;
    let begin = root(take, from);
    let at = |k: usize| root(take, from + duration * (k + 1) as f64 / SPANS as f64) - begin;
    let mut shape = Shape { landmarks: std::array::from_fn(at), duration };
    // The curve is linear in its landmarks: the errors of the samples are fitted with what each inner landmark adds.
    let sampled = shape.curve();
    let parts: [Curve; INNER] = std::array::from_fn(|k| {
        let mut part = Shape { duration, ..Shape::default() };
        part.landmarks[k].x = 1.0;
        part.curve()
    });
    let mut normal = SMatrix::<f64, INNER, INNER>::zeros();
    let mut sides = SMatrix::<f64, INNER, 2>::zeros();
    for k in frame(take, from).0 + 1..=frame(take, to).0 {
        let share = (k as f64 / take.fps - from) / duration;
        let error = take.root[k] - begin - sampled.place(share);
        let row = SVector::<f64, INNER>::from_fn(|part, _| parts[part].place(share).x);
        normal += row * row.transpose();
        sides += row * error.transpose();
    }
    // With too few frames there is no unique curve; the samples then are one.
    if let Some(better) = normal.cholesky().map(|normal| normal.solve(&sides)) {
        for (k, landmark) in shape.landmarks.iter_mut().take(INNER).enumerate() {
            *landmark += Vec2::new(better[(k, 0)], better[(k, 1)]);
        }
    }
    shape
}

// Whether a take can be one of a person who walks: the height of the hip, the feet and the steps.

/// The height of the hip over the lower foot, m.
const HIPS: Range<f64> = 0.6..1.3;
/// The distance between ankle and toe, m.
const FEET: Range<f64> = 0.05..0.45;
/// The length of the steps, m.
const STEPS: Range<f64> = 0.25..1.4;

/// The median of a take that no person who walks has, and those of people.
pub fn doubt(take: &Take, cut: &Result<Cut, NoSteps>) -> Option<String> {
    let [left, right] = &take.feet;
    let hip = |k: usize| {
        let places = [left.ankle[k], left.toe[k], right.ankle[k], right.toe[k]];
        take.hip[k] - places.iter().map(|place| place[2]).fold(f64::INFINITY, f64::min)
    };
    let feet = take.feet.iter().flat_map(|foot| foot.ankle.iter().zip(&foot.toe));
    let feet = feet.map(|(a, t)| (0..3).map(|k| (a[k] - t[k]) * (a[k] - t[k])).sum::<f64>().sqrt());
    let steps = cut.iter().flat_map(|cut| &cut.steps).map(|step| step.shape.curve().length());
    let strange = |what: &str, all: &[f64], range: Range<f64>, usual: &str| {
        let median = percentile(all, 0.5);
        let is_strange = !all.is_empty() && !range.contains(&median);
        is_strange.then(|| format!("its {what} {median:.3} m {usual} m are usual)"))
    };
    let (hips, feet): (Vec<f64>, Vec<f64>) = ((0..take.hip.len()).map(hip).collect(), feet.collect());
    strange("hip is", &hips, HIPS, "high (0.7 to 1.2")
        .or_else(|| strange("feet are", &feet, FEET, "long from ankle to toe (0.05 to 0.45"))
        .or_else(|| strange("steps are", &steps.collect::<Vec<_>>(), STEPS, "long (0.3 to 1"))
}
