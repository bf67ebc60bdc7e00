//! A model from recorded steps.

use super::basis::{Basis, moments, square_root};
use super::columns::{COLUMNS, Columns, plus, seen_from};
use super::density::Density;
use super::nearest::Pairs;
use super::options::{FitError, Method, Options, Residuals, Warning};
use super::people::People;
use super::transition::{MOST_POINTS, Transition};
use super::{LearnedGait, Side, columns, process};
use crate::gait::steps::measures;
use crate::gait::{Foot, Phase, RecordedStep, SPANS, Shape};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Fewest pairs of a model, and of each foot.
const FEWEST: (usize, usize) = (50, 20);
/// Below this many pairs there is a warning.
const FEW: usize = 200;
/// Fewest first steps of a foot that make a density of their own.
const FEWEST_FIRST: usize = 10;
/// Fewest first steps of both feet.
const FEWEST_FIRST_BOTH: usize = 10;
/// Length of a first step over that of a step between others: 0.37 m of root path to 0.65 m in 304 recorded takes.
const FIRST_LENGTH: f64 = 0.57;
/// Its duration over the usual one, and the share of the mean speed with which it begins: with these it ends at 0.95 of the
/// usual speed.
const FIRST_DURATION: f64 = 1.14;
const FIRST_SPEED: f64 = 0.1;
/// Shorter steps (m) and steps that turn by more (rad) are no steps of a walk.
const SHORTEST: f64 = 0.15;
const WIDEST: f64 = 120.0 * std::f64::consts::PI / 180.0;

/// Places of the steps of all pairs: consecutive steps of a take with different feet, the second one neither the first nor the last of
/// its walk. With `all` phases, each two consecutive steps with different feet.
pub(super) fn pairs(steps: &[RecordedStep], all: bool) -> Vec<(usize, usize)> {
    let places: BTreeMap<(&str, u32), usize> =
        steps.iter().enumerate().map(|(k, s)| ((s.take.as_str(), s.number), k)).collect();
    let follows = |(k, step): (usize, &RecordedStep)| {
        let next = *places.get(&(step.take.as_str(), step.number.checked_add(1)?))?;
        let walks = all || (step.phase != Phase::Last && steps[next].phase == Phase::Inner);
        (walks && steps[next].foot == step.foot.other()).then_some((k, next))
    };
    steps.iter().enumerate().filter_map(follows).collect()
}

/// Steps of a walk, without the others, and a warning if there are any.
pub(super) fn usual(steps: &[RecordedStep]) -> (Vec<RecordedStep>, Option<Warning>) {
    let (mut kept, mut short, mut turning) = (Vec::new(), 0, 0);
    for step in steps {
        let [length, turn, _] = measures(&step.shape);
        match (length < SHORTEST, turn.abs() > WIDEST) {
            (true, _) => short += 1,
            (_, true) => turning += 1,
            _ => kept.push(step.clone()),
        }
    }
    (kept, (short + turning > 0).then_some(Warning::LeftOut { short, turning }))
}

/// A first step made of one between others: shorter, and from rest with constant acceleration.
fn begun(shape: &Shape) -> Shape {
    let curve = shape.curve();
    let place = |k: usize| {
        let time = (k + 1) as f64 / SPANS as f64;
        curve.place(time * (FIRST_SPEED + (1.0 - FIRST_SPEED) * time)) * FIRST_LENGTH
    };
    Shape { landmarks: std::array::from_fn(place), duration: FIRST_DURATION * shape.duration }
}

/// What both feet share when they are fitted.
struct Task<'a> {
    steps: &'a [RecordedStep],
    options: &'a Options,
    /// Rows less the offsets of their subjects.
    rows: Vec<Columns>,
    pairs: Vec<(usize, usize)>,
    bases: [Basis; 2],
}

/// The model of some steps.
pub fn fit(steps: &[RecordedStep], options: &Options) -> Result<(LearnedGait, Vec<Warning>), FitError> {
    if !(options.variance > 0.0 && options.variance <= 1.0) {
        return Err(FitError::Variance(options.variance));
    }
    if !(1..=MOST_POINTS).contains(&options.inducing) {
        return Err(FitError::Inducing(options.inducing));
    }
    let infinite = |s: &&RecordedStep| columns::of(&s.shape).iter().any(|x| !x.is_finite());
    if let Some(step) = steps.iter().find(infinite) {
        return Err(FitError::NotFinite { take: step.take.clone(), number: step.number });
    }
    let (usual, left_out) = usual(steps);
    let own: Vec<Columns> = usual.iter().map(|s| columns::of(&s.shape)).collect();
    let steps = &usual[..];
    let pairs = pairs(steps, options.as_published);
    if pairs.len() < FEWEST.0 {
        return Err(FitError::TooFewPairs { pairs: pairs.len(), wanted: FEWEST.0 });
    }
    let mut warnings: Vec<Warning> = left_out.into_iter().collect();
    if pairs.len() < FEW {
        warnings.push(Warning::FewPairs(pairs.len()));
    }
    // Steps between others, by which steps are centered.
    let walks = |foot: Foot| {
        let of = move |k: &usize| {
            steps[*k].foot == foot && (options.as_published || steps[*k].phase == Phase::Inner)
        };
        (0..steps.len()).filter(of)
    };
    let centers =
        [Foot::Left, Foot::Right].map(|foot| moments(&walks(foot).map(|k| own[k]).collect::<Vec<_>>()).0);
    let center = |foot: Foot| &centers[usize::from(foot == Foot::Right)];
    let seen = |k: usize| seen_from(steps[k].foot, &plus(&own[k], -1.0, center(steps[k].foot)));
    let named: Vec<(&str, Columns)> =
        walks(Foot::Left).chain(walks(Foot::Right)).map(|k| (steps[k].subject.as_str(), seen(k))).collect();
    let people = People::fit(&named, !options.as_published);
    if people.subjects.len() == 1 {
        warnings.push(Warning::OneSubject);
    }
    let offset =
        |step: &RecordedStep| seen_from(step.foot, &people.recorded(&step.subject).unwrap_or(people.typical));
    let rows: Vec<Columns> = steps.iter().zip(&own).map(|(s, row)| plus(row, -1.0, &offset(s))).collect();
    let basis = |foot: Foot| {
        let rows: Vec<Columns> = walks(foot).map(|k| rows[k]).collect();
        let mean = moments(&rows).0;
        Basis::fit(&rows, mean, options.variance, !options.as_published).ok_or(FitError::NoVariation(foot))
    };
    let bases = [basis(Foot::Left)?, basis(Foot::Right)?];
    let task = Task { steps, options, rows, pairs, bases };
    let (left, right) = rayon::join(|| task.side(Foot::Left), || task.side(Foot::Right));
    let ((left, of_left), (right, of_right)) = (left?, right?);
    warnings.extend(of_left.into_iter().chain(of_right));
    let model = LearnedGait {
        source: options.source.clone(),
        license: options.license.clone(),
        as_published: options.as_published,
        residuals: if options.as_published { Residuals::Gaussian } else { options.residuals },
        people,
        sides: [left, right],
    };
    Ok((model, warnings))
}

impl Task<'_> {
    fn basis(&self, foot: Foot) -> &Basis {
        &self.bases[usize::from(foot == Foot::Right)]
    }

    fn scaled(&self, k: usize) -> Columns {
        self.basis(self.steps[k].foot).scaled(&self.rows[k])
    }

    /// The first steps of a foot; where there are few, those of the other foot as their mirror images; where there are still few, steps
    /// between others made into first ones.
    fn first(&self, foot: Foot, warnings: &mut Vec<Warning>) -> Density {
        let basis = self.basis(foot);
        let chosen = |which: &dyn Fn(&RecordedStep) -> bool| -> Vec<Columns> {
            let kept = self.steps.iter().zip(&self.rows).filter(|(s, _)| which(s));
            kept.map(|(s, row)| basis.scaled(&seen_from(foot, &seen_from(s.foot, row)))).collect()
        };
        if self.options.as_published {
            return Density::fit(chosen(&|s| s.foot == foot), basis);
        }
        let mut steps = chosen(&|s| s.foot == foot && s.phase == Phase::First);
        let own = steps.len();
        if own < FEWEST_FIRST {
            steps = chosen(&|s| s.phase == Phase::First);
            let few = steps.len() < FEWEST_FIRST_BOTH;
            let instead = if few {
                "steps between others, shortened to 0.57 and begun from rest,"
            } else {
                "those of the other foot as well, mirrored,"
            };
            if few {
                let inner = self.steps.iter().zip(&self.rows);
                let inner = inner.filter(|(s, _)| s.foot == foot && s.phase == Phase::Inner);
                let made = |row: &Columns| basis.scaled(&columns::of(&begun(&columns::shape(row))));
                steps = inner.map(|(_, row)| made(row)).collect();
            }
            warnings.push(Warning::FewFirstSteps { foot, steps: own, instead });
        }
        Density::fit(steps, basis)
    }

    fn side(&self, foot: Foot) -> Result<(Side, Vec<Warning>), FitError> {
        let (options, basis, next) = (self.options, self.basis(foot), self.basis(foot.other()));
        let mut warnings = Vec::new();
        let pairs: Vec<(usize, usize)> =
            self.pairs.iter().filter(|(k, _)| self.steps[*k].foot == foot).copied().collect();
        if pairs.len() < FEWEST.1 {
            return Err(FitError::OneSided { foot, pairs: pairs.len(), wanted: FEWEST.1 });
        }
        let (count, outputs) = (basis.components() + 1, next.components());
        let from: Vec<_> = pairs.iter().map(|(k, _)| basis.scores(&self.scaled(*k))).collect();
        let to: Vec<_> = pairs.iter().map(|(_, k)| next.scores(&self.scaled(*k))).collect();
        let began =
            |i: usize| f64::from(!options.as_published && self.steps[pairs[i].0].phase == Phase::First);
        let x =
            DMatrix::from_fn(pairs.len(), count, |i, q| if q + 1 < count { from[i][q] } else { began(i) });
        let y = DMatrix::from_fn(pairs.len(), outputs, |i, k| to[i][k]);
        let singular = || FitError::Singular(foot);
        let exact = options.method == Method::Exact && pairs.len() <= MOST_POINTS;
        if options.method == Method::Exact && !exact {
            warnings.push(Warning::TooManyForExact(pairs.len()));
        }
        let (transition, residuals, usual) = if options.method == Method::Linear {
            let fitted = process::linear(&x, &y).ok_or_else(singular)?;
            (Transition::Linear(fitted.transition), fitted.residuals, fitted.variance)
        } else {
            let hyper = process::search(&x, &y, options.as_published).ok_or_else(singular)?;
            let fitted = if exact {
                process::exact(&x, &y, hyper)
            } else {
                process::sparse(&x, &y, hyper, options.inducing)
            };
            let mut fitted = fitted.ok_or_else(singular)?;
            if options.as_published {
                fitted.transition.signals.fill(1.0);
            }
            (Transition::Process(fitted.transition), fitted.residuals, fitted.variance)
        };
        // What the components leave out of a step goes with its residual.
        let residual = |i: usize| {
            let (step, mut error) = (self.scaled(pairs[i].1), [0.0; COLUMNS]);
            error.iter_mut().zip(residuals.row(i).iter()).for_each(|(e, r)| *e = *r);
            plus(&plus(&step, -1.0, &next.spanned(&to[i])), 1.0, &next.spanned(&error))
        };
        let residuals: Vec<Columns> = (0..pairs.len()).map(residual).collect();
        let (gaussian, usual) = if options.as_published {
            // Independent outputs of variance one.
            let axis = |k: usize| next.spanned(&std::array::from_fn(|q| f64::from(q == k)));
            ((0..outputs).map(axis).collect(), 1.0)
        } else {
            (square_root(&moments(&residuals).1), usual)
        };
        let places: Vec<f64> = (0..pairs.len())
            .flat_map(|i| (0..count).map(move |q| (i, q)))
            .map(|(i, q)| x[(i, q)] / transition.unit(q))
            .collect();
        let side = Side {
            basis: basis.clone(),
            first: self.first(foot, &mut warnings),
            pairs: Pairs::new(&places, &residuals, count),
            transition,
            gaussian,
            usual,
        };
        Ok((side, warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::super::made;
    use super::*;

    #[test]
    fn bad_data_and_options_are_named() {
        let error = |steps: &[RecordedStep], options: Options| fit(steps, &options).unwrap_err();
        let mut steps = made::steps(10, 12);
        assert!(matches!(error(&steps[..40], Options::default()), FitError::TooFewPairs { .. }));
        assert_eq!(error(&steps, Options { variance: 0.0, ..Options::default() }), FitError::Variance(0.0));
        assert_eq!(error(&steps, Options { inducing: 2001, ..Options::default() }), FitError::Inducing(2001));
        let (_, warnings) = fit(&steps, &Options::default()).unwrap();
        assert!(warnings.contains(&Warning::FewPairs(110)), "{warnings:?}");
        steps[3].shape.duration = f64::NAN;
        assert_eq!(error(&steps, Options::default()), FitError::NotFinite { take: "t000".into(), number: 3 });
        let same: Vec<RecordedStep> =
            made::steps(10, 12).iter().map(|s| RecordedStep { shape: steps[0].shape, ..s.clone() }).collect();
        assert!(matches!(error(&same, Options::default()), FitError::NoVariation(_)));
    }

    #[test]
    fn pairs_are_consecutive_steps_of_other_feet_in_a_take() {
        let mut steps = made::steps(2, 6);
        assert_eq!(pairs(&steps, false).len(), 10);
        steps[2].number = 40;
        steps[10].foot = steps[10].foot.other();
        let places = pairs(&steps, false);
        assert_eq!(places, [(0, 1), (3, 4), (4, 5), (6, 7), (7, 8), (8, 9)]);
        steps[5].phase = Phase::Last;
        assert_eq!(pairs(&steps, false).len(), 5);
        assert_eq!(pairs(&steps, true).len(), 6);
    }

    #[test]
    fn without_noise_the_length_scale_falls_below_all_distances() {
        let (model, _) =
            fit(&made::steps(20, 12), &Options { as_published: true, ..Options::default() }).unwrap();
        let shown = model.show();
        assert!(shown.feet.iter().all(|f| f.length_scales[0] < 0.06), "{shown:?}");
        let (model, _) = fit(&made::steps(20, 12), &Options::default()).unwrap();
        assert!(model.show().feet.iter().all(|f| f.length_scales[0] > 0.3 && f.noise > 0.01));
    }
}
