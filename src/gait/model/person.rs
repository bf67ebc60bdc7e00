//! A person with a learned gait: draws its steps.

use super::basis::combined;
use super::columns::{COLUMNS, Columns, DURATION, LENGTH, plus, seen_from};
use super::density::normals;
use super::nearest::Found;
use super::{LearnedGait, Residuals, Side, columns};
use crate::base::geometry::Vec2;
use crate::base::math;
use crate::gait::{Draws, Foot, Gait, Shape, Stance};
use std::sync::Arc;

/// Length of a step on speed: v^0.6 in free walking; the duration takes the rest. (Grieve and Gear 1966 give a power law; the
/// exponent is that of the takes of the CMU database.)
const LENGTH_POWER: f64 = 0.6;
/// Sway on speed: v^-0.8, the slope of 4.5 - 1.55 v cm (recorded steps) at 1.3 m/s in logarithms.
const SWAY_POWER: f64 = -0.8;

/// Where a stance says that its last step began from standing (1) or not (0).
const BEGAN: usize = 0;
/// Where a stance has the logarithm of the share of the speed that its last step was made with.
const SHARE: usize = 1;

/// A person: a gait and the offset of this person.
#[derive(Clone, Debug)]
pub struct Person {
    gait: Arc<LearnedGait>,
    /// Left, right.
    offsets: [Columns; 2],
}

impl LearnedGait {
    /// Standard normal numbers that make a person.
    pub const NORMALS: usize = COLUMNS;

    /// A new person, whose offset is drawn by standard normal numbers.
    pub fn person(self: &Arc<Self>, normals: &[f64; Self::NORMALS]) -> Person {
        self.with_offset(&self.people.drawn(normals))
    }

    /// A person like a recorded subject; `None` for one that the model does not know.
    pub fn recorded(self: &Arc<Self>, subject: &str) -> Option<Person> {
        Some(self.with_offset(&self.people.recorded(subject)?))
    }

    /// The person with an offset seen from the foot.
    pub(super) fn with_offset(self: &Arc<Self>, offset: &Columns) -> Person {
        let offsets = [Foot::Left, Foot::Right].map(|foot| seen_from(foot, offset));
        Person { gait: Arc::clone(self), offsets }
    }
}

impl Person {
    fn offset(&self, foot: Foot) -> &Columns {
        &self.offsets[usize::from(foot == Foot::Right)]
    }

    /// What a transition takes: the scores of a step with a foot and whether it began from standing.
    pub(super) fn inputs(&self, foot: Foot, shape: &Shape, began: bool) -> [f64; COLUMNS + 1] {
        let basis = &self.gait.side(foot).basis;
        let scores = basis.scores(&basis.scaled(&plus(&columns::of(shape), -1.0, self.offset(foot))));
        let mut inputs = [0.0; COLUMNS + 1];
        inputs[..COLUMNS].copy_from_slice(&scores);
        inputs[basis.components()] = f64::from(began && !self.gait.as_published);
        inputs
    }

    /// A step with a foot at another speed: longer and quicker by powers of the speed. The sway is what the mean step goes
    /// aside (turns to both sides cancel there), and has a power of its own.
    fn at_speed(&self, foot: Foot, shape: Shape, log_share: f64, back: bool) -> Shape {
        let power = |exponent: f64| math::exp(exponent * log_share);
        let (length, sway) = (power(LENGTH_POWER), power(SWAY_POWER));
        let (center, offset) = (&self.gait.side(foot).basis.center, self.offset(foot));
        let mut landmarks = shape.landmarks;
        for (k, p) in landmarks.iter_mut().enumerate() {
            let aside = Vec2::new(0.0, (sway - length) * (center[2 * k + 1] + offset[2 * k + 1]));
            *p = if back { (*p - aside) / length } else { *p * length + aside };
        }
        let duration = power(LENGTH_POWER - 1.0);
        Shape {
            landmarks,
            duration: if back { shape.duration / duration } else { shape.duration * duration },
        }
    }

    /// The step with a foot of a row in scaled columns.
    fn shape(&self, foot: Foot, scaled: &Columns) -> Shape {
        columns::shape(&plus(&self.gait.side(foot).basis.row(scaled), 1.0, self.offset(foot)))
    }

    /// The steps that follow one with the foot `last`.
    fn ahead(&self, last: Foot, shape: &Shape, began: bool) -> Ahead<'_> {
        let side = self.gait.side(last);
        let mut inputs = self.inputs(last, shape, began);
        let mut mean = [0.0; COLUMNS];
        let gaussian = self.gait.residuals == Residuals::Gaussian;
        let factor = side.transition.predict(&inputs, &mut mean, gaussian);
        let spread = match self.gait.residuals {
            Residuals::Nearest => {
                let count = side.basis.components() + 1;
                for (q, input) in inputs[..count].iter_mut().enumerate() {
                    *input /= side.transition.unit(q);
                }
                Spread::Nearest(side.pairs.nearest(&inputs, count))
            }
            Residuals::Gaussian => Spread::Gaussian { deviation: (factor / side.usual).sqrt() },
        };
        Ahead { side, mean: self.gait.side(last.other()).basis.spanned(&mean), spread }
    }

    /// A step that follows one with the foot `last`.
    pub(super) fn next(&self, last: Foot, shape: &Shape, began: bool, draws: Draws) -> Shape {
        self.shape(last.other(), &self.ahead(last, shape, began).draw(draws))
    }

    /// The mean of the next scores less those of a step that followed, in standard deviations, and the logarithms of these.
    pub(super) fn errors(&self, last: Foot, shape: &Shape, began: bool, next: &Shape) -> Vec<(f64, f64)> {
        let side = self.gait.side(last);
        let mut mean = [0.0; COLUMNS];
        let factor = side.transition.predict(&self.inputs(last, shape, began), &mut mean, true);
        let found = self.inputs(last.other(), next, false);
        let variances = side.transition.variances().iter().map(|v| v * factor);
        variances.enumerate().map(|(k, v)| ((found[k] - mean[k]) / v.sqrt(), 0.5 * math::ln(v))).collect()
    }
}

/// The law of the steps that follow one step.
struct Ahead<'p> {
    side: &'p Side,
    /// Their mean, in scaled columns of the other foot.
    mean: Columns,
    spread: Spread,
}

/// Around their mean.
#[expect(
    clippy::large_enum_variant,
    reason = "one at a time, on the stack: a box would be allocated for each step"
)]
enum Spread {
    Nearest(Found),
    Gaussian { deviation: f64 },
}

impl Ahead<'_> {
    /// One of them in scaled columns.
    fn draw(&self, draws: Draws) -> Columns {
        let residual = match &self.spread {
            Spread::Nearest(found) => self.side.pairs.residual(found, draws.uniform_pair(0)[0]),
            Spread::Gaussian { deviation } => {
                combined(&self.side.gaussian, &normals(draws, 0)).map(|x| deviation * x)
            }
        };
        plus(&self.mean, 1.0, &residual)
    }
}

impl Gait for Person {
    fn step(&self, before: &Stance, foot: Foot, share: f64, draws: Draws) -> Stance {
        self.steps(before, foot, share, &mut std::iter::once(draws)).pop().unwrap_or_default()
    }

    fn steps(
        &self,
        before: &Stance,
        foot: Foot,
        share: f64,
        draws: &mut dyn Iterator<Item = Draws>,
    ) -> Vec<Stance> {
        // A step is drawn as at the person's own speed and then brought to that of the share.
        let log_share = math::ln(math::at_most(math::at_least(share, 0.1), 3.0));
        let ahead = before.last.as_ref().map(|(last, shape)| {
            let own = self.at_speed(*last, *shape, before.drift[SHARE], true);
            // Of two steps with the same foot the first one counts as its mirror image.
            let row = seen_from(*last, &seen_from(foot.other(), &columns::of(&own)));
            self.ahead(foot.other(), &columns::shape(&row), before.drift[BEGAN] > 0.5)
        });
        let mut drift = [0.0; 8];
        (drift[BEGAN], drift[SHARE]) = (f64::from(ahead.is_none()), log_share);
        let scaled = |draws| match &ahead {
            None => self.gait.side(foot).first.draw(draws),
            Some(ahead) => ahead.draw(draws),
        };
        draws
            .map(|draws| {
                let shape = self.at_speed(foot, self.shape(foot, &scaled(draws)), log_share, false);
                Stance { last: Some((foot, shape)), drift }
            })
            .collect()
    }

    fn length(&self) -> f64 {
        let mean = |k: usize| self.gait.sides[k].basis.center[LENGTH] + self.offsets[k][LENGTH];
        0.5 * (mean(0) + mean(1))
    }

    fn duration(&self) -> f64 {
        let mean = |k: usize| self.gait.sides[k].basis.center[DURATION] + self.offsets[k][DURATION];
        0.5 * (mean(0) + mean(1))
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::super::made;
    use super::*;
    use crate::base::fingerprint::Fingerprint;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::gait::Phase;

    fn stream(index: u64) -> Stream {
        Stream::of(TrialKey { seed: 3, index, branch: 0 }, 0, Purpose::Test)
    }

    /// Lengths and durations of a walk of some steps at a share of the speed.
    fn walk(person: &Person, steps: u32, share: f64) -> Vec<(Foot, Shape)> {
        let (mut stance, mut foot) = (Stance::default(), Foot::Left);
        let one = |k: u32| {
            stance = person.step(&stance, foot, share, Draws::of(stream(0), k, 0));
            foot = foot.other();
            stance.last.unwrap()
        };
        (0..steps).map(one).collect()
    }

    #[test]
    fn drawn_steps_have_these_bits() {
        // Every machine draws these bytes; a change of them is a change of what a seed gives.
        let model = Arc::new(made::small());
        let mut print = Fingerprint::default();
        for (normals, share) in [([0.0; COLUMNS], 1.0), ([0.7; COLUMNS], 0.8)] {
            for (_, shape) in walk(&model.person(&normals), 50, share) {
                for x in columns::of(&shape) {
                    print.add(&x.to_bits().to_le_bytes());
                }
            }
        }
        assert_eq!(print.to_string(), "fnv1a64:4c5964624321e3ee");
    }

    #[test]
    fn long_walks_keep_the_steps_of_the_data() {
        let steps = made::steps(40, 30);
        let (model, _) = super::super::fit(&steps, &super::super::Options::default()).unwrap();
        let model = Arc::new(model);
        let of = |steps: &[(Foot, Shape)], foot: Foot, q: usize| -> (f64, f64) {
            let values: Vec<f64> = steps
                .iter()
                .filter(|s| s.0 == foot)
                .map(|s| if q == 3 { s.1.landmarks[2].y } else { super::super::score::quantities(&s.1)[q] })
                .collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (mean, (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / values.len() as f64).sqrt())
        };
        let subject = "s0";
        let data: Vec<(Foot, Shape)> = steps
            .iter()
            .filter(|s| s.subject == subject && s.phase == Phase::Inner)
            .map(|s| (s.foot, s.shape))
            .collect();
        let drawn = walk(&model.recorded(subject).unwrap(), 4000, 1.0);
        assert!(drawn.windows(2).all(|w| w[1].0 == w[0].0.other()));
        // Sway is half-way at the third landmark.
        for (q, tolerance) in [(0, 0.012), (1, 0.03), (2, 0.012), (3, 0.004)] {
            for foot in [Foot::Left, Foot::Right] {
                let ((a, spread), (b, drawn_spread)) = (of(&data, foot, q), of(&drawn[3000..], foot, q));
                assert!((a - b).abs() < tolerance, "{q} {foot:?} {a} {b}");
                assert!(
                    (0.75..1.3).contains(&(drawn_spread / spread)),
                    "{q} {foot:?} {spread} {drawn_spread}"
                );
            }
        }
        // First steps are short ones.
        let person = model.recorded(subject).unwrap();
        let first =
            person.step(&Stance::default(), Foot::Right, 1.0, Draws::of(stream(9), 0, 0)).last.unwrap();
        assert!(first.1.landmarks[4].x < 0.55);
    }

    #[test]
    fn speed_shares_scale_steps_and_sway_and_nothing_else() {
        let person = Arc::new(made::small()).person(&[0.3; COLUMNS]);
        let (own, slow) = (walk(&person, 30, 1.0), walk(&person, 30, 0.5));
        for (a, b) in own.iter().zip(&slow) {
            assert!((b.1.duration / a.1.duration - 0.5f64.powf(-0.4)).abs() < 1e-9);
            assert!((b.1.landmarks[4].x - a.1.landmarks[4].x * 0.5f64.powf(0.6)).abs() < 1e-9);
            let basis = &person.gait.side(a.0).basis;
            for (k, (p, q)) in a.1.landmarks.iter().zip(&b.1.landmarks).enumerate() {
                let mean = basis.center[2 * k + 1] + person.offset(a.0)[2 * k + 1];
                let expected = (p.y - mean) * 0.5f64.powf(0.6) + mean * 0.5f64.powf(-0.8);
                assert!((q.y - expected).abs() < 1e-9);
            }
        }
        assert!(person.length() > 0.4 && person.duration() > 0.3);
    }
}
