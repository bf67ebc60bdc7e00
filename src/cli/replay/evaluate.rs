//! `smc evaluate`: predictions against what happened.

use super::arguments::{EvaluateCommand, EvaluateFormat};
use super::{Call, Exit};
use crate::cli::terminal::Colors;
use crate::cli::{complaint, output};
use crate::data::tracks::Velocity;
use crate::gait;
use crate::model::Scenario;
use crate::replay::{
    CONSTANT, Evaluating, FEATURES, Fit, HORIZONS, Instant, LANGEVIN, PREDICTED, PersonRealism, Predicted,
    eligible, evaluate, monitor, realism, user_kind,
};
use crate::report::evaluate::{
    Coverage, Displacement, Evaluated, EvaluatedKind, EvaluatedProperty, to_json, to_svg, to_text, write_csv,
};
use crate::route::Ways;
use crate::stats::bootstrap::{Bootstrap, DRAWS, Estimate, ratio};
use crate::stats::brier::{Prediction, Predictions};
use crate::stats::quality::Quality;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeMap;

/// Runs the command.
pub(in crate::cli) fn run(arguments: &EvaluateCommand, colors: Colors) -> Exit {
    let work = |call: &Call| text(arguments, call);
    super::run(&arguments.replayed, (Velocity::Seen, arguments.user), colors, work)
}

fn text(arguments: &EvaluateCommand, call: &Call) -> Result<String, Vec<Diagnostic>> {
    let Call { replay, threads, every, .. } = call;
    let instants = eligible(replay, call.instants.clone(), arguments.speed, PREDICTED);
    if instants.is_empty() {
        let said = format!("nobody moves and is seen for the next {PREDICTED} s at any instant");
        return Err(complaint::argument(said, "choose other times, or a smaller `--speed`").into());
    }
    let mut kinds = arguments.kinds.clone();
    if kinds.is_empty() {
        kinds.extend(user_kind(replay));
        kinds.push(CONSTANT.to_owned());
        kinds.extend(arguments.realism.then(|| LANGEVIN.to_owned()));
    }
    kinds.dedup();
    let options = Evaluating { trials: arguments.trials, seed: arguments.replayed.span.seed };
    let ways = Ways::default();
    let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
    let judged = monitor(replay, &instants, arguments.beyond, threads)?;
    let (mut found, mut realisms) = (Vec::new(), Vec::new());
    for kind in &kinds {
        found.push(evaluate(replay, kind, &judged, &options, (threads, &drivers))?);
        realisms.push(if arguments.realism {
            realism(replay, kind, &judged, options.seed, (threads, &drivers))?
        } else {
            Vec::new()
        });
    }
    let persons = Persons::of(&instants);
    let bootstrap = Bootstrap {
        persons: persons.numbers.len(),
        draws: DRAWS,
        seed: options.seed,
        confidence: arguments.replayed.span.confidence,
    };
    let constant = kinds.iter().position(|kind| kind == CONSTANT).map(|k| &found[k]);
    let names = &replay.formulas.names;
    let of_kind = |((kind, own), real): ((&String, &Predicted), &Vec<PersonRealism>)| EvaluatedKind {
        name: kind.clone(),
        properties: (0..names.len())
            .map(|k| EvaluatedProperty {
                name: names[k].clone(),
                unresolved: own.unresolved[k],
                quality: persons.quality(k, own, constant.filter(|_| kind != CONSTANT), &bootstrap),
            })
            .collect(),
        displacement: Some(persons.displacement(own, &bootstrap)),
        coverage: persons.coverage(own, &bootstrap),
        realism: persons.realism(real, &bootstrap),
    };
    let evaluated = Evaluated {
        model: arguments.replayed.model.scenario.clone(),
        properties: arguments.replayed.properties.clone(),
        recording: replay.tracks.clone(),
        velocity: replay.recording.velocity(),
        trials: options.trials,
        seed: options.seed,
        every: *every,
        moving: arguments.speed,
        horizon: PREDICTED,
        confidence: bootstrap.confidence,
        instants: instants.len() as u64,
        persons: bootstrap.persons as u64,
        kinds: kinds.iter().zip(&found).zip(&realisms).map(of_kind).collect(),
    };
    match arguments.format {
        EvaluateFormat::Text => Ok(to_text(&evaluated)),
        EvaluateFormat::Json => Ok(to_json(&evaluated)),
        EvaluateFormat::Svg => {
            let picture = to_svg(&evaluated).map_err(|flaw| complaint::argument(flaw.message, flaw.hint))?;
            Ok(arguments.print.svg(&picture))
        }
        EvaluateFormat::Csv => Ok(output::table(|out| write_csv(out, &evaluated))?),
    }
}

/// The persons of all instants, numbered from 0 by ascending id.
struct Persons {
    numbers: BTreeMap<u32, u32>,
}

impl Persons {
    fn of(instants: &[Instant]) -> Self {
        let mut numbers: BTreeMap<u32, u32> = instants.iter().map(|one| (one.person, 0)).collect();
        (0..).zip(numbers.values_mut()).for_each(|(k, number)| *number = k);
        Self { numbers }
    }

    fn number(&self, id: u32) -> u32 {
        self.numbers.get(&id).copied().unwrap_or(0)
    }

    /// The quality of a property, beside another predictor at the instants at which both say something.
    fn quality(
        &self,
        property: usize,
        own: &Predicted,
        other: Option<&Predicted>,
        bootstrap: &Bootstrap,
    ) -> Option<Quality> {
        type One = crate::replay::Prediction;
        let key = |one: &One| (one.instant.person, one.instant.time.to_bits());
        let predictions = |all: &mut dyn Iterator<Item = &One>| {
            let one = |one: &One| Prediction {
                person: self.number(one.instant.person),
                probability: one.probability,
                happened: one.happened,
            };
            Predictions::new(all.map(one).collect())
        };
        let shared = |a: &Predicted, b: &Predicted| {
            let known: std::collections::BTreeSet<_> = b.predictions[property].iter().map(key).collect();
            predictions(&mut a.predictions[property].iter().filter(|one| known.contains(&key(one))))
        };
        let all = predictions(&mut own.predictions[property].iter());
        let pair = other.map(|other| [shared(own, other), shared(other, own)]);
        Quality::of(&all, pair.as_ref().map(|[own, other]| [own, other]), bootstrap)
    }

    /// The sum over all persons of something, over the sum of its weights.
    fn ratio(&self, parts: impl Iterator<Item = (u32, f64, f64)>, bootstrap: &Bootstrap) -> Option<Estimate> {
        let mut sums = vec![[0.0, 0.0]; self.numbers.len()];
        for (person, one, weight) in parts {
            let sum = &mut sums[self.number(person) as usize];
            *sum = [sum[0] + one, sum[1] + weight];
        }
        bootstrap.estimate(ratio(&sums))
    }

    fn displacement(&self, found: &Predicted, bootstrap: &Bootstrap) -> Displacement {
        type One = crate::replay::Displacement;
        let mean = |of: fn(&One) -> f64| {
            self.ratio(found.displacements.iter().map(|one| (one.person, of(one), 1.0)), bootstrap)
        };
        Displacement {
            mean_ade: mean(|one| one.average),
            mean_fde: mean(|one| one.last),
            best_of: One::BEST_OF as u64,
            best_ade: mean(|one| one.best_average),
            best_fde: mean(|one| one.best_last),
            collisions: mean(|one| one.collisions),
        }
    }

    /// The mean logarithm of each number; nothing where it was not asked for.
    fn realism(
        &self,
        found: &[PersonRealism],
        bootstrap: &Bootstrap,
    ) -> Vec<(&'static str, Option<Estimate>)> {
        let of = |(k, name): (usize, &&'static str)| {
            let parts = found.iter().map(|(person, sums, steps)| (*person, sums[k], *steps as f64));
            (*name, self.ratio(parts, bootstrap))
        };
        if found.is_empty() { Vec::new() } else { FEATURES.iter().enumerate().map(of).collect() }
    }

    fn coverage(&self, found: &Predicted, bootstrap: &Bootstrap) -> Vec<Coverage> {
        let after = |(k, seconds): (usize, &f64)| {
            let mean = |of: fn(&Fit) -> f64| {
                let known = found.fits.iter().filter_map(|(person, fits)| Some((*person, fits[k].as_ref()?)));
                self.ratio(known.map(|(person, fit)| (person, of(fit), 1.0)), bootstrap)
            };
            let (share, log_density) = (mean(|fit| f64::from(fit.inside)), mean(|fit| fit.log_density));
            Coverage { seconds: *seconds, share, log_density }
        };
        HORIZONS.iter().enumerate().map(after).collect()
    }
}
