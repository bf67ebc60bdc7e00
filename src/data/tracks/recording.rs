//! A recording: who was where, when, and how fast.

use crate::base::geometry::Vec2;
use std::collections::BTreeMap;

/// Which velocities a recording has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Velocity {
    /// As the file has them. Those of ETH/BIWI are central differences, which hold the next position.
    #[default]
    Recorded,
    /// The difference from the last position of the track, which an observer knows at the time.
    Seen,
}

impl Velocity {
    /// Its name in files and options: `recorded`, `seen`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Recorded => "recorded",
            Self::Seen => "seen",
        }
    }

    /// The one of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Recorded, Self::Seen].into_iter().find(|velocity| velocity.name() == name)
    }
}

/// How far, in frames of the film, a time may lie from an annotated frame and still mean that frame.
const SAME_FRAME: f64 = 0.5;

/// A person who comes farther from the first place does not stand, m.
const MOVES: f64 = 0.5;

/// One person in one annotated frame.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Number of the frame in the film.
    pub frame: u32,
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s; `None` where it is unknown.
    pub velocity: Option<Vec2>,
    /// The row of the file in which it is written, from 1; 0 where nobody knows.
    pub row: u32,
}

/// Samples are the same wherever they are written.
impl PartialEq for Sample {
    fn eq(&self, other: &Self) -> bool {
        (self.frame, self.position, self.velocity) == (other.frame, other.position, other.velocity)
    }
}

/// Numbers of a table beside the positions: for each name the rows that have one, ascending, and their values.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Columns(BTreeMap<String, Vec<(u32, f64)>>);

impl Columns {
    /// A number of a row, which comes after those before it.
    pub(super) fn push(&mut self, name: &str, row: usize, value: f64) {
        match self.0.get_mut(name) {
            Some(values) => values.push((row as u32, value)),
            None => _ = self.0.insert(name.to_owned(), vec![(row as u32, value)]),
        }
    }

    /// Adds those of a file whose rows come after the first so many.
    fn append(&mut self, other: Self, rows: u32) {
        for (name, values) in other.0 {
            let values = values.into_iter().map(|(row, value)| (row + rows, value));
            self.0.entry(name).or_default().extend(values);
        }
    }

    fn value(&self, name: &str, row: u32) -> Option<f64> {
        let values = self.0.get(name)?;
        values.binary_search_by_key(&row, |(row, _)| *row).ok().map(|at| values[at].1)
    }
}

/// One person, with samples of ascending frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Person {
    /// Number given by the annotators.
    pub id: u32,
    /// Where it was seen; never empty.
    pub samples: Vec<Sample>,
}

/// One person at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonState {
    /// Number given by the annotators.
    pub id: u32,
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s; zero where it is unknown.
    pub velocity: Vec2,
}

/// How frames of a recording are seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clock {
    /// Time of the first annotated frame, s.
    pub(super) start: f64,
    pub(super) seconds_per_frame: f64,
    /// Usual number of frames between two annotations of one person.
    pub(super) stride: u32,
    /// Most frames between two annotations of one person that are not a hole.
    pub(super) longest_gap: u32,
}

impl Clock {
    /// A film that begins at time 0 with its first annotated frame.
    pub(super) const fn film(stride: u32, seconds_per_frame: f64) -> Self {
        Self { start: 0.0, seconds_per_frame, stride, longest_gap: stride }
    }
}

/// People over time. Time 0 is the first annotated frame, unless the file has times of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    people: Vec<Person>,
    /// Annotated frames, ascending.
    frames: Vec<u32>,
    clock: Clock,
    velocity: Velocity,
    velocities_are_blank: bool,
    /// The last frame of each file of several but the last, and the first of the next.
    joints: Vec<(u32, u32)>,
    columns: Columns,
}

/// Time between the last frame of one file and the first of the next, where several are one recording, s.
const BETWEEN_FILES: f64 = 60.0;

impl Recording {
    /// A recording of people with ascending ids. Where a sample lacks a velocity, all become the seen ones; so they do where
    /// columns are filled with 0 although somebody moves.
    pub(super) fn new(people: Vec<Person>, clock: Clock) -> Self {
        let mut frames: Vec<u32> = people.iter().flat_map(|p| p.samples.iter().map(|s| s.frame)).collect();
        frames.sort_unstable();
        frames.dedup();
        let samples = || people.iter().flat_map(|person| &person.samples);
        let all = samples().all(|sample| sample.velocity.is_some());
        let moves = |person: &Person| {
            let far = |sample: &Sample| (sample.position - person.samples[0].position).norm() > MOVES;
            person.samples.iter().any(far)
        };
        let velocities_are_blank =
            samples().all(|sample| sample.velocity == Some(Vec2::zeros())) && people.iter().any(moves);
        let velocity = Velocity::Recorded;
        let (joints, columns) = (Vec::new(), Columns::default());
        let recording =
            Self { people, frames, clock, velocity, velocities_are_blank: false, joints, columns };
        let recording = if all && !velocities_are_blank { recording } else { recording.with(Velocity::Seen) };
        Self { velocities_are_blank, ..recording }
    }

    /// The same with the other columns of its table.
    pub(super) fn beside(self, columns: Columns) -> Self {
        Self { columns, ..self }
    }

    /// The names of the columns beside the positions that have numbers.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.columns.0.keys().map(String::as_str)
    }

    /// The number of a column for a person at a time, s: that of the last row until then.
    pub fn column(&self, name: &str, id: u32, time: f64) -> Option<f64> {
        let (person, frame) = (self.person(id)?, self.frame_at(time)?);
        let after = person.samples.partition_point(|sample| f64::from(sample.frame) <= frame);
        self.columns.value(name, person.samples[after.checked_sub(1)?].row)
    }

    /// Several recordings as one: each begins a minute after the last frame of the one before. Ids that an earlier one has, too,
    /// go on from the largest id so far.
    ///
    /// # Errors
    /// None at all, or another number of frames per second: a sentence.
    pub fn joined(parts: Vec<Self>) -> Result<Self, String> {
        let mut parts = parts.into_iter();
        let Some(mut whole) = parts.next() else { return Err("no file matches".to_owned()) };
        for part in parts {
            let rates = [&whole, &part].map(Self::frames_per_second);
            if (rates[0] - rates[1]).abs() > 1e-9 * rates[0] || whole.clock.stride != part.clock.stride {
                return Err(format!("the files have {} and {} frames per second", rates[0], rates[1]));
            }
            let (Some(last), Some(first)) = (whole.frames.last().copied(), part.frames.first().copied())
            else {
                continue;
            };
            let gap = (BETWEEN_FILES / whole.clock.seconds_per_frame).ceil() as u32;
            // As many whole steps, so that all frames lie on one lattice.
            let steps = gap.max(whole.clock.longest_gap + 1).div_ceil(whole.clock.stride);
            let begin = last + steps * whole.clock.stride;
            let rows = whole.people.iter().flat_map(|person| &person.samples).map(|sample| sample.row).max();
            let rows = rows.unwrap_or(0);
            let is_known = part.people.iter().any(|person| whole.person(person.id).is_some());
            let more = if is_known { whole.people.last().map_or(0, |person| person.id + 1) } else { 0 };
            whole.people.extend(part.people.into_iter().map(|mut person| {
                person.id += more;
                for sample in &mut person.samples {
                    (sample.frame, sample.row) = (sample.frame - first + begin, sample.row + rows);
                }
                person
            }));
            whole.people.sort_by_key(|person| person.id);
            whole.columns.append(part.columns, rows);
            whole.frames.extend(part.frames.iter().map(|frame| frame - first + begin));
            whole.joints.push((last, begin));
            whole.velocities_are_blank &= part.velocities_are_blank;
            if part.velocity == Velocity::Seen {
                whole = whole.with(Velocity::Seen);
            }
        }
        Ok(whole)
    }

    /// Whether a time lies between two files of one recording.
    pub fn is_between(&self, time: f64) -> bool {
        self.joints
            .iter()
            .any(|(last, next)| time > self.time_of(*last) + 1e-6 && time < self.time_of(*next) - 1e-6)
    }

    /// Whether the file has only velocities of 0 although somebody moves.
    pub(super) const fn velocities_are_blank(&self) -> bool {
        self.velocities_are_blank
    }

    /// The recording with these velocities. A file without velocities has only the seen ones, which then stay.
    #[must_use]
    pub fn with(mut self, velocity: Velocity) -> Self {
        self.velocities_are_blank &= velocity == Velocity::Recorded;
        if velocity == Velocity::Seen && self.velocity != velocity {
            for person in &mut self.people {
                let mut last: Option<Sample> = None;
                for sample in &mut person.samples {
                    let before = last.replace(*sample);
                    sample.velocity = before.map(|before| {
                        let seconds = f64::from(sample.frame - before.frame) * self.clock.seconds_per_frame;
                        (sample.position - before.position) / seconds
                    });
                }
            }
            self.velocity = velocity;
        }
        self
    }

    /// Which velocities it has.
    pub const fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// Everybody, by ascending id.
    pub fn people(&self) -> &[Person] {
        &self.people
    }

    /// The person of that id.
    pub fn person(&self, id: u32) -> Option<&Person> {
        self.people.binary_search_by_key(&id, |person| person.id).ok().map(|k| &self.people[k])
    }

    /// All ids, ascending.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.people.iter().map(|person| person.id)
    }

    /// Annotated frames with at least one person, ascending.
    pub fn frames(&self) -> &[u32] {
        &self.frames
    }

    /// Frames of the film per second.
    pub fn frames_per_second(&self) -> f64 {
        1.0 / self.clock.seconds_per_frame
    }

    /// Seconds between two annotations of one person.
    pub fn step(&self) -> f64 {
        f64::from(self.clock.stride) * self.clock.seconds_per_frame
    }

    /// Time of a frame, s.
    pub fn time_of(&self, frame: u32) -> f64 {
        let first = self.frames.first().copied().unwrap_or(0);
        self.clock.start + (f64::from(frame) - f64::from(first)) * self.clock.seconds_per_frame
    }

    /// Time of the last annotated frame, s.
    pub fn duration(&self) -> f64 {
        self.frames.last().map_or(0.0, |&frame| self.time_of(frame))
    }

    /// From when to when a person is in the recording, s.
    pub fn presence(&self, id: u32) -> Option<(f64, f64)> {
        let samples = &self.person(id)?.samples;
        Some((self.time_of(samples.first()?.frame), self.time_of(samples.last()?.frame)))
    }

    /// Everybody present at a time in seconds, by ascending id: as annotated on a frame that is no more than half a
    /// frame of the film away, else in
    /// proportion between the two frames of the same person around it. Nobody is present before the first
    /// or after the last frame of a track, nor in a hole of it longer than the usual step.
    pub fn at(&self, time: f64) -> Vec<PersonState> {
        let Some(frame) = self.frame_at(time) else { return Vec::new() };
        self.people.iter().filter_map(|person| self.seen(person, frame)).collect()
    }

    /// One person at a time in seconds, as [`Recording::at`] has everybody.
    pub fn person_at(&self, id: u32, time: f64) -> Option<PersonState> {
        self.seen(self.person(id)?, self.frame_at(time)?)
    }

    /// The frame of a time, s: an annotated one where one is near, else a share of the way between two.
    fn frame_at(&self, time: f64) -> Option<f64> {
        let frame =
            f64::from(*self.frames.first()?) + (time - self.clock.start) / self.clock.seconds_per_frame;
        if !frame.is_finite() {
            return None;
        }
        let after = self.frames.partition_point(|&annotated| f64::from(annotated) < frame - SAME_FRAME);
        let around = self.frames[after..].iter().map(|&annotated| f64::from(annotated)).take(2);
        let nearest = around.min_by(|a, b| (a - frame).abs().total_cmp(&(b - frame).abs()));
        Some(nearest.filter(|annotated| (annotated - frame).abs() <= SAME_FRAME).unwrap_or(frame))
    }

    fn seen(&self, person: &Person, frame: f64) -> Option<PersonState> {
        // Few of hundreds are there at a time.
        let ends = [person.samples.first()?, person.samples.last()?].map(|sample| f64::from(sample.frame));
        if frame < ends[0] || frame > ends[1] {
            return None;
        }
        let after = person.samples.partition_point(|sample| f64::from(sample.frame) < frame);
        let next = person.samples.get(after)?;
        let state = |position, velocity: Option<Vec2>| PersonState {
            id: person.id,
            position,
            velocity: velocity.unwrap_or_default(),
        };
        if f64::from(next.frame) == frame {
            return Some(state(next.position, next.velocity));
        }
        let last = &person.samples[after.checked_sub(1)?];
        let gap = next.frame - last.frame;
        if gap > self.clock.longest_gap {
            return None;
        }
        let share = (frame - f64::from(last.frame)) / f64::from(gap);
        let velocity = match (last.velocity, next.velocity) {
            (Some(last), Some(next)) => Some(last + (next - last) * share),
            (known, None) | (None, known) => known,
        };
        Some(state(last.position + (next.position - last.position) * share, velocity))
    }

    /// The annotated time nearest to a time, s; for messages about a time at which no person is present.
    pub fn nearest_time(&self, time: f64) -> Option<f64> {
        let after = self.frames.partition_point(|&frame| self.time_of(frame) < time);
        let around = self
            .frames
            .get(after.saturating_sub(1)..=after)
            .or_else(|| self.frames.last_chunk::<1>().map(|c| &c[..]))?;
        around
            .iter()
            .map(|&frame| self.time_of(frame))
            .min_by(|a, b| (a - time).abs().total_cmp(&(b - time).abs()))
    }

    /// The stretches of time without a break, s: a break is two successive annotated frames farther apart
    /// than the usual step.
    pub fn stretches(&self) -> Vec<(f64, f64)> {
        self.frames
            .chunk_by(|a, b| b - a <= self.clock.longest_gap)
            .map(|part| (self.time_of(part[0]), self.time_of(part[part.len() - 1])))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording {
        let sample = |frame, x| Sample {
            frame,
            position: Vec2::new(x, 0.0),
            velocity: Some(Vec2::new(2.0 * x, 1.0)),
            row: 0,
        };
        let people = vec![
            Person { id: 1, samples: vec![sample(10, 0.0), sample(20, 1.0), sample(50, 4.0)] },
            Person { id: 4, samples: vec![sample(20, 8.0)] },
        ];
        Recording::new(people, Clock::film(10, 0.04))
    }

    fn ids(seen: &[PersonState]) -> Vec<u32> {
        seen.iter().map(|o| o.id).collect()
    }

    #[test]
    fn between_two_frames_a_person_is_in_proportion() {
        let seen = recording().at(0.1);
        assert_eq!(
            seen,
            [PersonState { id: 1, position: Vec2::new(0.25, 0.0), velocity: Vec2::new(0.5, 1.0) }]
        );
    }

    #[test]
    fn a_time_within_half_a_frame_of_an_annotated_one_means_that_frame() {
        let r = recording();
        // Frame 20 is at 0.4 s, and a frame of the film lasts 0.04 s.
        assert_eq!(r.at(0.419), r.at(0.4));
        assert_eq!(r.at(0.381), r.at(0.4));
        assert_ne!(r.at(0.379), r.at(0.4));
        assert_eq!(ids(&r.at(1.619)), [1]);
        assert_eq!(ids(&r.at(1.621)), [0; 0]);
    }

    #[test]
    fn nobody_is_present_in_a_hole_or_outside_the_track() {
        let r = recording();
        assert_eq!(ids(&r.at(0.4)), [1, 4]);
        assert_eq!(ids(&r.at(0.8)), [0; 0], "frame 30 lies in a hole of person 1");
        assert_eq!(ids(&r.at(1.6)), [1]);
        assert_eq!(ids(&r.at(1.7)), [0; 0]);
        assert_eq!(ids(&r.at(-0.1)), [0; 0]);
        assert_eq!(ids(&r.at(f64::NAN)), [0; 0]);
        assert_eq!(ids(&r.at(f64::INFINITY)), [0; 0]);
    }

    #[test]
    fn the_nearest_annotated_time_is_found() {
        let r = recording();
        assert_eq!(r.nearest_time(0.3), Some(0.4));
        assert_eq!(r.nearest_time(0.9), Some(0.4));
        assert_eq!(r.nearest_time(-7.0), Some(0.0));
        assert_eq!(r.nearest_time(99.0), Some(1.6));
    }

    #[test]
    fn seen_velocities_look_back() {
        let seen = recording().with(Velocity::Seen);
        let velocities: Vec<_> = seen.people()[0].samples.iter().map(|s| s.velocity.map(|v| v.x)).collect();
        assert_eq!(velocities, [None, Some(2.5), Some(2.5)]);
        assert_eq!(seen.velocity(), Velocity::Seen);
        assert_eq!(seen.clone().with(Velocity::Recorded), seen, "recorded velocities are gone");
    }

    #[test]
    fn a_break_parts_the_stretches() {
        assert_eq!(recording().stretches(), [(0.0, 0.4), (1.6, 1.6)]);
        assert_eq!(recording().presence(4), Some((0.4, 0.4)));
        assert_eq!(recording().presence(2), None);
    }
}
