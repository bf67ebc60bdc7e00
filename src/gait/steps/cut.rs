//! Cutting a take into steps, from contact to contact.
//!
//! A walk that begins or ends in standing has a first or last step: from the moment at which the root begins to move, and to the
//! moment at which it stands.

use super::contact::{Contact, Support};
use super::landmarks::{frame, root, shape};
use super::signal::speed;
use crate::base::geometry::{Vec2, cross};
use crate::data::mocap::Take;
use crate::gait::{Foot, Phase, RecordedStep};
use std::collections::BTreeMap;
use std::fmt;

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
