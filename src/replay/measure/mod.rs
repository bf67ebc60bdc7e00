//! Numbers of a recording, frame by frame: those of the language over the regions and lines of a scenario, and of encounters.
//!
//! A scenario of its own holds the scene and a slot for each person. In each frame people are shown where they were, and the
//! numbers are read from this state by the code that reads them in trials. So `density(hall)` of a recording is what
//! it would be of a trial with these positions.

pub mod encounters;
mod watched;

use crate::base::geometry::Vec2;
use crate::compile::Files;
use crate::compile::Setting;
use crate::data::tracks::Recording;
use crate::model::Scene;
use crate::replay::Diagnosed;
use crate::syntax::ast::ScenarioFile;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;
use encounters::{Encounters, Passing, meetings};
use watched::{Prepared, Watched};

/// What is measured, and how.
#[derive(Clone, Debug)]
pub struct Measuring {
    /// Numbers of the language, as written; without any, those of all regions and lines.
    pub numbers: Vec<String>,
    /// The window of flows, s.
    pub window: f64,
    /// The radius of bodies, m.
    pub radius: f64,
    /// The deceleration that a person can reach, m/s².
    pub brake: f64,
    /// The first and the last time, s.
    pub between: (Option<f64>, Option<f64>),
}

/// The scenario of a measurement: its texts and trees, and the contents of its files.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    /// Its texts.
    pub sources: Vec<Source>,
    /// The scenario.
    pub scenario: ScenarioFile,
    /// The files that it imports.
    pub files: Files,
    /// Values of its parameters.
    pub settings: Vec<Setting>,
}

/// A number that was measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Number {
    /// As written.
    pub name: String,
    /// Its unit; empty if it has none.
    pub unit: String,
}

/// What was measured.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// The numbers, the same in each frame.
    pub numbers: Vec<Number>,
    /// The times of frames, s, and the numbers in each; NaN where there is none.
    pub rows: Vec<(f64, Vec<f64>)>,
    /// Who passed a place soon after whom.
    pub passings: Vec<Passing>,
    /// The number of persons.
    pub persons: usize,
    /// Regions of the scene in which nobody was ever seen.
    pub empty: Vec<String>,
    /// The scene.
    pub scene: Scene,
}

/// Numbers of each frame that no scene is needed for.
const OF_FRAMES: [(&str, &str); 2] = [("people", ""), ("mean_speed", "m/s")];

/// Measures a recording on some ground, whose texts grow by those of the call.
///
/// # Errors
/// What is wrong with the scene or with a number; a recording without frames between the times.
pub fn measure(recording: &Recording, ground: &mut Ground, options: &Measuring) -> Diagnosed<Measured> {
    let frames = frames(recording, options.between);
    let Some(first) = frames.first().copied() else {
        let said = "the recording has no frame between these times";
        let hint = format!("it lasts until {} s", recording.duration());
        return Err(vec![Diagnostic::placeless(crate::syntax::codes::Code::E0705, said).hint(hint)]);
    };
    let prepared = Prepared::new(recording, ground, options, ticks(recording))?;
    let mut watched = Watched::new(recording, &prepared)?;
    let mut measured = Measured {
        numbers: prepared.numbers.clone(),
        persons: recording.people().len(),
        scene: prepared.scene().clone(),
        passings: passings(recording, options),
        ..Measured::default()
    };
    let plain = OF_FRAMES.iter().chain(&encounters::NUMBERS);
    measured
        .numbers
        .splice(0..0, plain.map(|(name, unit)| Number { name: (*name).into(), unit: (*unit).into() }));
    let mut visited = vec![false; measured.scene.regions.len()];
    for time in &frames {
        let tick = ((time - first) / recording.step()).round() as u64;
        let seen = watched.show(recording, tick, *time);
        for (region, visited) in measured.scene.regions.iter().zip(&mut visited) {
            *visited = *visited || seen.iter().any(|(at, _)| region.shape.contains(*at));
        }
        let mut row = of_frame(seen).to_vec();
        row.extend(numbers_of(meetings(seen, options.radius, options.brake)));
        row.extend(watched.read());
        measured.rows.push((time - first, row));
    }
    let regions = measured.scene.regions.iter().zip(visited);
    measured.empty = regions.filter(|(_, visited)| !visited).map(|(region, _)| region.name.clone()).collect();
    Ok(measured)
}

/// The number of frames from the first to the last, those between files included.
fn ticks(recording: &Recording) -> usize {
    let first = recording.frames().first().map_or(0.0, |frame| recording.time_of(*frame));
    ((recording.duration() - first) / recording.step()).ceil() as usize + 1
}

/// The times of all frames between two times, at equal distances, s.
fn frames(recording: &Recording, (from, to): (Option<f64>, Option<f64>)) -> Vec<f64> {
    let all = recording.frames();
    let (Some(first), Some(last)) = (all.first(), all.last()) else { return Vec::new() };
    let (start, end, step) = (recording.time_of(*first), recording.time_of(*last), recording.step());
    let count = ((end - start) / step + 1e-6).floor() as u64;
    let times = (0..=count).map(|k| start + k as f64 * step);
    let is_wanted = |time: &f64| {
        from.is_none_or(|from| *time >= from - 1e-9)
            && to.is_none_or(|to| *time <= to + 1e-9)
            && !recording.is_between(*time)
    };
    times.filter(is_wanted).collect()
}

/// Those whose second person comes between the times.
fn passings(recording: &Recording, options: &Measuring) -> Vec<Passing> {
    let (from, to) = options.between;
    let mut all = encounters::passings(recording, options.radius);
    all.retain(|one| from.is_none_or(|from| one.at >= from) && to.is_none_or(|to| one.at <= to));
    all
}

fn of_frame(seen: &[(Vec2, Vec2)]) -> [f64; 2] {
    let count = seen.len() as f64;
    let speed: f64 = seen.iter().map(|(_, velocity)| velocity.norm()).sum();
    [count, if seen.is_empty() { f64::NAN } else { speed / count }]
}

/// A frame in which nobody meets anybody has no such number.
fn numbers_of(Encounters { nearest, collision, threat }: Encounters) -> [f64; 3] {
    [nearest, collision, threat].map(|x| if x.is_finite() { x } else { f64::NAN })
}
