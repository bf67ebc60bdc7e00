//! The second error: how often what a model said of people was true at a site where they were recorded.
//!
//! Each recorded person plays the user once, at one instant that is drawn at random, and of companions one alone: instants of
//! one person, and members of one group, resemble each other. The first persons calibrate, those who come later test:
//!
//! ```text
//! |-- first persons -----------------|-- later persons ----|   time
//!    laws of heading and speed             are the bounds true?
//!    share of truth in bins of P           do the regions hold nine of ten?
//!    factors of the 90 % regions
//! ```
//!
//! *Probabilities.* In each of four bins of the simulated P the truths of exchangeable persons are trials of one probability: the
//! ends are those of Clopper and Pearson (Biometrika 26, 1934), for each bin by itself (Mondrian conformal prediction: Vovk,
//! Gammerman, Shafer 2005, section 4.5). *Regions.* Of n exchangeable persons and a further one, the score of the latter is among
//! the k least with probability k/(n + 1): the factor of the region is the score in place `ceil(0.9 (n + 1))` (split conformal
//! prediction, the same book, section 4.2). The score is the square of the distance in units of the region. A region never
//! becomes smaller: few persons say little about the last of ten.

mod apply;
mod people;
mod site;

use super::evaluate::{Evaluating, PREDICTED, Predicted, evaluate};
use super::instants::Instant;
use super::kinds::user_kind;
use super::monitor::monitor;
use super::region::HORIZONS;
use super::situation::Replay;
use super::{Beyond, Judged};
use crate::base::tick::Tick;
use crate::compile::Site;
use crate::compile::study::World;
use crate::engine::Threads;
use crate::kernel::driver::MakeDrivers;
use crate::replay::Diagnosed;
use crate::stats::{Counts, clopper_pearson};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
pub use apply::written;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Version of the form of the file.
const SCHEMA: u32 = 1;
/// Fewer persons calibrate nothing.
const FEWEST: usize = 20;
/// Fewer persons test nothing.
const FEWEST_LATER: usize = 10;
/// The ends of the bins of a probability.
const ENDS: [f64; 5] = [0.0, 0.1, 0.5, 0.9, 1.0];
/// Error of both bounds of a bin together.
const ERROR: f64 = 0.05;
/// Later persons whose regions hold less than this have changed.
pub const DRIFTED: f64 = 0.85;

/// The measurement of a site.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Version of the form of the file.
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// Name of the site.
    pub site: String,
    /// When people were recorded there, as the call says it.
    pub date: Option<String>,
    /// Name of the tracks.
    pub recording: String,
    /// Which velocities were used.
    pub velocity: String,
    /// Trials of each person.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Persons who calibrate.
    pub persons: u64,
    /// Persons who test.
    pub later: u64,
    /// Length of a step, s.
    pub step: f64,
    /// Horizon, s; it counts where a formula has an operator without a bound.
    pub horizon: f64,
    /// The kind of the people.
    pub kind: String,
    /// Fingerprint of that kind.
    pub body: String,
    /// Changes of heading over the predicted time, rad, of the first persons.
    pub turns: Vec<f64>,
    /// Mean speeds over that time as a share of the present one.
    pub paces: Vec<f64>,
    /// The properties.
    pub properties: Vec<CalibratedProperty>,
    /// The regions, one for each time.
    pub regions: Vec<CalibratedRegion>,
    /// The bins of the first and of the later persons once more, as `smc plot --figure calibration` reads them.
    pub kinds: Value,
}

/// How often a property was true.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratedProperty {
    /// Its name.
    pub name: String,
    /// Fingerprint of its formula and of what that may use.
    pub formula: String,
    /// Persons of whom the recording does not tell, all together.
    pub unresolved: u64,
    /// The bins, by ascending probability.
    pub bins: Vec<Bin>,
}

/// Persons of whom the model said nearly the same probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// Least probability.
    pub from: f64,
    /// Largest probability; below it unless it is 1.
    pub to: f64,
    /// First persons in the bin.
    pub persons: u64,
    /// The number of them of whom the property was true.
    pub held: u64,
    /// Mean of their simulated probabilities.
    pub mean: f64,
    /// Lower bound of the probability that it is true, 97.5 %.
    pub low: f64,
    /// Upper bound of it, 97.5 %.
    pub high: f64,
    /// Later persons in the bin.
    pub later: u64,
    /// The number of them of whom the property was true.
    pub later_held: u64,
    /// Mean of their simulated probabilities.
    pub later_mean: f64,
}

/// How much larger the 90 % region of a predicted position must be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratedRegion {
    /// After so many seconds.
    pub seconds: f64,
    /// Factor of its radius, 1 or larger.
    pub factor: f64,
    /// Share of the first persons that it held as simulated.
    pub first: f64,
    /// Share of the later persons that it holds as simulated.
    pub before: f64,
    /// Share of the later persons that it holds with the factor.
    pub after: f64,
}

/// The options of a calibration.
#[derive(Clone, Debug, Default)]
pub struct Calibrating {
    /// Name of the site.
    pub site: String,
    /// When people were recorded.
    pub date: Option<String>,
    /// How many persons calibrate at most.
    pub persons: usize,
    /// Persons who are slower do not count, m/s.
    pub speed: f64,
    /// Trials of each person.
    pub trials: u64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Fingerprint of each property.
    pub formulas: Vec<(String, String)>,
}

impl Calibrating {
    /// The persons of a recording, each at one instant, and how many of them calibrate.
    ///
    /// # Errors
    /// There are too few.
    pub fn people(&self, replay: &Replay) -> Result<(Vec<Instant>, usize), Diagnostic> {
        let people = people::drawn(replay, self.speed, self.seed);
        // The larger part calibrates, unless the call says how many do.
        let first = self.persons.min(people.len() - people.len() / 3);
        let wrong = |said: String, hint: &str| {
            let error = Diagnostic::placeless(Code::E0705, said);
            Err(error.hint(hint.to_owned()))
        };
        if first < FEWEST {
            let said = format!(
                "{} persons of different groups move and are recorded for {PREDICTED} s: {first} would calibrate",
                people.len()
            );
            return wrong(said, "20 are the fewest, of 30 who were recorded; 60 to 120 are better");
        }
        if people.len() - first < FEWEST_LATER {
            let said = format!("only {} persons are left for the test", people.len() - first);
            return wrong(said, "take fewer with `--persons`, or a longer recording");
        }
        Ok((people, first))
    }

    /// The laws of the site, from the persons who calibrate.
    ///
    /// # Errors
    /// There are too few persons.
    pub fn site_of(&self, replay: &Replay) -> Result<Option<Site>, Diagnostic> {
        let (people, first) = self.people(replay)?;
        let (turns, paces) = site::changes(replay, &people[..first]);
        Ok(site::laws(&turns, &paces))
    }

    /// Measures how often the model is right about recorded people.
    ///
    /// # Errors
    /// What is wrong with the model or the recording.
    pub fn measure(
        &self,
        replay: &Replay,
        (threads, drivers): (&Threads, &MakeDrivers),
    ) -> Diagnosed<Calibration> {
        let (people, first) = self.people(replay).map_err(|error| vec![error])?;
        let kind = user_kind(replay).unwrap_or_default();
        let judged: Vec<Judged> = monitor(replay, &people, Beyond::Onward, threads)?;
        let options = Evaluating { trials: self.trials, seed: self.seed };
        let found = evaluate(replay, &kind, &judged, &options, (threads, drivers))?;
        let ((step, horizon), body) = kind_of(replay, &people, &kind)?;
        let is_first = |id: u32| people[..first].iter().any(|one| one.person == id);
        let (turns, paces) = site::changes(replay, &people[..first]);
        let properties: Vec<CalibratedProperty> = (replay.formulas.names.iter().enumerate())
            .map(|(k, name)| CalibratedProperty {
                name: name.clone(),
                formula: self.print_of(name),
                unresolved: found.unresolved[k],
                bins: bins(&found, k, is_first),
            })
            .collect();
        let regions = (0..HORIZONS.len()).filter_map(|k| region(&found, k, is_first)).collect();
        let kinds = json!([
            plotted("first persons", &properties, false),
            plotted("later persons", &properties, true)
        ]);
        Ok(Calibration {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            site: self.site.clone(),
            date: self.date.clone(),
            recording: replay.tracks.clone(),
            velocity: replay.recording.velocity().name().to_owned(),
            trials: self.trials,
            seed: self.seed,
            persons: first as u64,
            later: (people.len() - first) as u64,
            step,
            horizon,
            kind,
            body,
            turns,
            paces,
            properties,
            regions,
            kinds,
        })
    }

    fn print_of(&self, name: &str) -> String {
        let known = self.formulas.iter().find(|(known, _)| known == name);
        known.map_or(String::new(), |(_, print)| print.clone())
    }
}

/// The step and the horizon of the scenario, s, and the fingerprint of a kind, where the model can be compiled first.
fn kind_of(replay: &Replay, people: &[Instant], kind: &str) -> Diagnosed<((f64, f64), String)> {
    let study = people.iter().find_map(|instant| replay.study_at(*instant).ok());
    let world = study.as_ref().and_then(|study| study.worlds.get(study.base));
    let of_world = |world: &World| {
        let seconds = |ticks| world.scenario.clock.seconds(ticks);
        let times = (seconds(Tick(1)), seconds(world.scenario.horizon));
        Some((times, apply::print(world.kinds.get(kind)?)))
    };
    world.and_then(of_world).ok_or_else(|| {
        let error = Diagnostic::placeless(Code::E0705, "the model has no kind of recorded people");
        vec![error.hint("declare one: `kind adult: sfm preset smc2 { noise = 0.1 m/s }`")]
    })
}

/// The bins of a property.
fn bins(found: &Predicted, property: usize, is_first: impl Fn(u32) -> bool) -> Vec<Bin> {
    let bin = |ends: &[f64]| {
        let (from, to) = (ends[0], ends[1]);
        let inside = |p: f64| p >= from && (p < to || to >= 1.0);
        let of = |first: bool| {
            let chosen =
                found.predictions[property].iter().filter(|one| is_first(one.instant.person) == first);
            let all: Vec<_> = chosen.filter(|one| inside(one.probability)).collect();
            let held = all.iter().filter(|one| one.happened).count() as u64;
            let mean = all.iter().map(|one| one.probability).sum::<f64>() / all.len().max(1) as f64;
            (all.len() as u64, held, mean)
        };
        let ((persons, held, mean), (later, later_held, later_mean)) = (of(true), of(false));
        let counts = Counts { successes: held, failures: persons - held };
        let bounds = clopper_pearson::interval(counts, ERROR);
        let (low, high) = (bounds.low.max(0.0), bounds.high.min(1.0));
        Bin { from, to, persons, held, mean, low, high, later, later_held, later_mean }
    };
    ENDS.windows(2).map(bin).collect()
}

/// The region after one of the times.
fn region(found: &Predicted, time: usize, is_first: impl Fn(u32) -> bool) -> Option<CalibratedRegion> {
    let of = |first: bool| {
        let chosen = found.fits.iter().filter(|(person, _)| is_first(*person) == first);
        let mut scores: Vec<f64> = chosen.filter_map(|(_, fits)| Some(fits[time]?.score)).collect();
        scores.sort_by(f64::total_cmp);
        scores
    };
    let (first, later) = (of(true), of(false));
    let place = (super::region::REGION * (first.len() as f64 + 1.0)).ceil() as usize;
    let largest = *first.get(place.checked_sub(1)?)?;
    let share = |scores: &[f64], most: f64| {
        scores.iter().filter(|score| **score <= most).count() as f64 / scores.len().max(1) as f64
    };
    Some(CalibratedRegion {
        seconds: HORIZONS[time],
        factor: largest.sqrt().max(1.0),
        first: share(&first, 1.0),
        before: share(&later, 1.0),
        after: share(&later, largest.max(1.0)),
    })
}

/// The bins as a kind of evaluated predictions.
fn plotted(name: &str, properties: &[CalibratedProperty], later: bool) -> Value {
    let numbers = |bin: &Bin| {
        if later { (bin.later, bin.later_held, bin.later_mean) } else { (bin.persons, bin.held, bin.mean) }
    };
    let of = |property: &CalibratedProperty| {
        let known = property.bins.iter().map(numbers).filter(|(count, ..)| *count > 0);
        let bins: Vec<Value> = known
            .map(|(count, held, mean)| json!({ "count": count, "mean": mean, "share": held as f64 / count as f64 }))
            .collect();
        let mut histogram = [0; 10];
        for bin in &property.bins {
            histogram[((10.0 * bin.from) as usize).min(9)] += numbers(bin).0;
        }
        json!({ "name": property.name, "bins": bins, "histogram": histogram })
    };
    json!({ "name": name, "properties": properties.iter().map(of).collect::<Vec<_>>() })
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::super::evaluate::Prediction;
    use super::super::region::Fit;
    use super::*;

    fn predicted(of: impl Fn(u32) -> (f64, bool)) -> Predicted {
        let one = |person: u32| {
            let (probability, happened) = of(person);
            Prediction { instant: Instant { time: 0.0, person }, probability, happened }
        };
        Predicted { predictions: vec![(0..100).map(one).collect()], ..Predicted::default() }
    }

    /// The 19th score of 20 persons is that below which a further one lies with probability 19/21 at least.
    #[test]
    fn the_factor_is_the_score_in_the_conformal_place() {
        let fit = |score: f64| Fit { inside: score <= 1.0, score, log_density: 0.0, predictive: 0.0 };
        let of = |person: u32| {
            let score = if person < 20 { f64::from(person + 1) / 10.0 } else { f64::from(person) / 20.0 };
            (person, [None, Some(fit(score)), None])
        };
        let found = Predicted { fits: (0..60).rev().map(of).collect(), ..Predicted::default() };
        let region = region(&found, 1, |person| person < 20).unwrap();
        assert_eq!((region.seconds, region.factor), (HORIZONS[1], 1.9f64.sqrt()));
        // 10 of the first have at most 1; of the later ones 20 alone has 1, and 19 have at most 1.9.
        assert_eq!((region.first, region.before, region.after), (0.5, 0.025, 0.475));
        assert_eq!(super::region(&found, 0, |person| person < 20), None);
        assert_eq!(super::region(&found, 1, |person| person < 8), None, "too few for nine of ten");
    }

    /// 80 first persons: of 60 with P = 0.95 48 are true, of 20 with P = 0.05 none; 1 belongs to the last bin.
    #[test]
    fn bins_count_the_first_and_the_later_persons() {
        let found = predicted(|k| match k % 4 {
            0 => (0.05, false),
            1 => (1.0, k % 20 != 1),
            _ => (0.95, k % 20 != 2),
        });
        let bins = bins(&found, 0, |person| person < 80);
        let last = bins[3];
        assert_eq!((last.persons, last.held, last.later, last.later_held), (60, 52, 15, 13));
        assert_eq!((bins[0].persons, bins[0].held, bins[1].persons, bins[2].persons), (20, 0, 0, 0));
        assert_eq!((bins[1].low, bins[1].high), (0.0, 1.0), "who has no person says nothing");
        // P(X >= 52) at the lower end and P(X <= 52) at the upper one, of 60 trials, are 2.5 %.
        let tail = |p: f64, from: u64, to: u64| {
            let choose = |k: u64| (0..k).map(|i| (60 - i) as f64 / (k - i) as f64).product::<f64>();
            (from..=to).map(|k| choose(k) * p.powi(k as i32) * (1.0 - p).powi(60 - k as i32)).sum::<f64>()
        };
        assert!(
            (tail(last.low, 52, 60) - 0.025).abs() < 1e-9 && (tail(last.high, 0, 52) - 0.025).abs() < 1e-9
        );
        assert!(bins[0].low == 0.0 && ((1.0 - bins[0].high).powi(20) - 0.025).abs() < 1e-9);
    }
}
