//! The instants of a replay: at which times who is the user.

use crate::data::tracks::Recording;

/// A time at which somebody is the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// s
    pub time: f64,
    /// Id of the user.
    pub person: u32,
}

/// All instants between two times, s, by time and then by id: every so many seconds from the beginning of the recording, in
/// each unbroken stretch of it at its frames, for one person or for everybody.
pub(super) fn instants(
    recording: &Recording,
    every: f64,
    person: Option<u32>,
    (from, to): (f64, f64),
) -> Vec<Instant> {
    let (stretches, step) = (recording.stretches(), recording.step());
    let first = stretches.first().map_or(0.0, |(start, _)| *start);
    let times = stretches.into_iter().flat_map(|(start, end)| {
        let next = first + ((start - first) / every - 1e-6).ceil() * every;
        let start = start + ((next - start) / step + 1e-6).floor() * step;
        let count = ((end - start) / every + 1e-6).floor();
        (0..=count as i64).map(move |k| start + k as f64 * every)
    });
    let is_near = |time: &f64| *time >= from - 1e-6 && *time <= to + 1e-6;
    let present = |time: f64| {
        let all = recording.at(time).into_iter().map(|one| one.id);
        all.filter(|id| person.is_none_or(|person| person == *id)).collect::<Vec<_>>()
    };
    times
        .filter(is_near)
        .flat_map(|time| present(time).into_iter().map(move |person| Instant { time, person }))
        .collect()
}
