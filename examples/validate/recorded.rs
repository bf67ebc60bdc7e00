//! Every preset beside people who were recorded: distances of paths, coverage, and probabilities of coming near.

use smc::compile::presets::PRESETS;
use smc::data::tracks::Velocity;
use smc::engine::Threads;
use smc::gait;
use smc::library::{Folder, Names, parse};
use smc::model::Scenario;
use smc::replay::{
    Beyond, CONSTANT, Displacement, Evaluating, FEATURES, LANGEVIN, PREDICTED, PersonRealism, Predicted,
    Replay, Whose, eligible, evaluate, monitor, realism,
};
use smc::route::Ways;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const MODEL: &str = "models/hotel-laws.scn";
const PROPERTIES: &str = "properties/hotel-laws.bltl";
/// Time between instants, s: the step of the recordings.
const EVERY: f64 = 0.4;
/// Slower people do not count, m/s.
const MOVING: f64 = 0.5;

/// The model of a recording, and the files around it.
struct Disk<'p> {
    data: &'p Path,
    scenario: String,
}

impl Folder for Disk<'_> {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        match name {
            MODEL => Ok(self.scenario.clone().into_bytes()),
            _ => fs::read(name).map_err(|error| error.to_string()),
        }
    }

    fn file(&mut self, path: &str) -> Result<Vec<u8>, String> {
        fs::read(self.data.join(path)).map_err(|error| error.to_string())
    }
}

/// The section, or that it is left out.
pub(crate) fn section(data: Option<&Path>, trials: u64) -> Result<String, Box<dyn std::error::Error>> {
    let mut out = "\n## People who were recorded\n\n".to_owned();
    let Some(data) = data.filter(|data| data.join("seq_hotel/obsmat.txt").exists()) else {
        out.push_str(
            "Left out: the recordings of ETH/BIWI are not part of the repository. Name their folder as an argument.\n",
        );
        return Ok(out);
    };
    out.push_str(
        "Predictions of all who are faster than 0.5 m/s and recorded for the next 4.8 s (Pellegrini et al. 2009; \
         `smc evaluate models/hotel-laws.scn`). The laws of heading and speed are those of \
         [replay.md](replay.md), chosen with `smc1` on hotel. ADE and FDE are the mean and the final distance, in m, \
         of the mean path after 4.8 s, and of the best of 20 paths. The shares are those of recorded positions in the 90 % \
         region after 1, 2 and 4.8 s. Skills are those of the Brier scores of \"somebody nearer than 0.5 m\" and \
         \"0.8 m\" against the base rate. Realism is the mean log likelihood of the recorded speed, acceleration, distance \
         to the nearest, time to collision and contact among 32 trials.\n\n\
         | recording, velocities | kind | ADE, FDE | best of 20 | in the region | skill 0.5 m | skill 0.8 m | realism |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let template = fs::read_to_string(MODEL)?;
    let laws = [
        (Velocity::Seen, ["spread=14deg", "pace=0.15", "jitter=0.1m/s"]),
        (Velocity::Recorded, ["spread=10deg", "pace=0.12", "jitter=0.05m/s"]),
    ];
    for (name, user) in [("hotel", "367"), ("eth", "1")] {
        for (velocity, settings) in laws {
            let scenario = template.replace("hotel", name).replace("367", user);
            let mut disk = Disk { data, scenario };
            let found = of_recording((name, velocity, &settings.map(str::to_owned)), &mut disk, trials)?;
            out.push_str(&found);
        }
    }
    Ok(out)
}

fn of_recording(
    (name, velocity, settings): (&str, Velocity, &[String]),
    disk: &mut Disk<'_>,
    trials: u64,
) -> Result<String, Box<dyn std::error::Error>> {
    let properties = [PROPERTIES.to_owned()];
    let parsed = parse(
        Names {
            scenario: MODEL,
            properties: &properties,
            settings,
            setting: "--set",
            velocity: None,
            models: &[],
            calibration: None,
        },
        disk,
    );
    let refused = |errors: Vec<smc::syntax::diagnostic::Diagnostic>| {
        errors.first().map_or_else(String::new, |first| first.title.clone())
    };
    let replay = Replay::new(&parsed.input(), name, velocity, Whose::Everybody).map_err(refused)?;
    let all = replay.instants(EVERY, (f64::NEG_INFINITY, f64::INFINITY));
    let instants = eligible(&replay, all, MOVING, PREDICTED);
    let threads = Threads::new(None)?;
    let ways = Ways::default();
    let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
    let judged = monitor(&replay, &instants, Beyond::Onward, &threads).map_err(refused)?;
    let options = Evaluating { trials, seed: 0 };
    let mut out = String::new();
    for kind in PRESETS.iter().map(|preset| preset.name).chain([CONSTANT, LANGEVIN]) {
        eprintln!("{name} {} {kind}", velocity.name());
        let found = evaluate(&replay, kind, &judged, &options, (&threads, &drivers)).map_err(refused)?;
        let real = realism(&replay, kind, &judged, options.seed, (&threads, &drivers)).map_err(refused)?;
        writeln!(
            out,
            "| {name}, {} | {kind} | {} | {} |",
            velocity.name(),
            cells(&found),
            likelihoods(&real)
        )?;
    }
    Ok(out)
}

fn cells(found: &Predicted) -> String {
    let mean = |of: fn(&Displacement) -> f64| {
        found.displacements.iter().map(of).sum::<f64>() / found.displacements.len() as f64
    };
    let inside = |k: usize| {
        let known: Vec<bool> = found.fits.iter().filter_map(|(_, fits)| Some(fits[k]?.inside)).collect();
        let share = known.iter().filter(|inside| **inside).count() as f64 / known.len() as f64;
        if known.is_empty() { "-".to_owned() } else { format!("{share:.2}") }
    };
    let skill = |name: usize| {
        let all = &found.predictions[name];
        let truth = |happened: bool| f64::from(u8::from(happened));
        let count = all.len() as f64;
        let rate = all.iter().map(|one| truth(one.happened)).sum::<f64>() / count;
        let square = |x: f64| x * x;
        let score = all.iter().map(|one| square(one.probability - truth(one.happened))).sum::<f64>() / count;
        format!("{:.2}", 1.0 - score / (rate * (1.0 - rate)))
    };
    format!(
        "{:.3}, {:.3} | {:.3}, {:.3} | {} | {} | {}",
        mean(|one| one.average),
        mean(|one| one.last),
        mean(|one| one.best_average),
        mean(|one| one.best_last),
        [0, 1, 2].map(inside).join(", "),
        skill(0),
        skill(1)
    )
}

/// The mean logarithm of each number of the recorded motion.
fn likelihoods(found: &[PersonRealism]) -> String {
    let steps: u64 = found.iter().map(|(_, _, steps)| steps).sum();
    let mean = |k: usize| found.iter().map(|(_, sums, _)| sums[k]).sum::<f64>() / steps as f64;
    (0..FEATURES.len()).map(|k| format!("{:.2}", mean(k))).collect::<Vec<_>>().join(", ")
}
