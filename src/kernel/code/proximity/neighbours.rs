//! Members who were close a while ago: a list of neighbours with a skin (Verlet, Physical Review 159, 1967).
//!
//! The gap of a pair shrinks by no more than the two have moved relative to each other, and that is at most the diagonal of
//! the rectangle around everybody's ways since then; a crowd that walks one way is no nearer to each other for it. So the
//! list serves for many states, until the ways are as long as the skin.

use super::asker::{Asker, MARGIN, has, square, squared};
use super::question::{All, Question};
use super::touching::read_off;
use super::{Around, Proximity};
use crate::base::lanes::{Lanes, Mask};
use crate::kernel::code::node::{Cut, Measure};
use crate::kernel::near::Close;
use crate::kernel::state::State;
use crate::model::Parameter;

/// How much farther than what is asked for a list goes, m.
const SKIN: f64 = 0.4;

/// With less of a skin a list is soon made anew, m.
const LEAST_SKIN: f64 = 0.1;

/// A list holds pairs up to so many average distances between neighbours: beyond, it takes as long as it saves.
const MOST_SPACINGS: f64 = 3.0;

/// Pairs who were close a while ago.
#[derive(Clone, Debug)]
pub(super) struct Neighbours {
    pairs: Vec<(u32, u32)>,
    /// Any other two members were farther apart than this then, m; less than nothing where nothing is listed.
    gap: f64,
    /// Largest radius, m.
    widest: f64,
    /// Who was there then, and where.
    present: Vec<Mask>,
    x: Vec<Lanes>,
    y: Vec<Lanes>,
    radius: Vec<Lanes>,
    /// Number of the state for which `edge` was found.
    state: u64,
    /// As in `Close`.
    edge: f64,
}

impl Default for Neighbours {
    fn default() -> Self {
        Self {
            pairs: Vec::new(),
            gap: f64::NEG_INFINITY,
            widest: 0.0,
            present: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            radius: Vec::new(),
            state: 0,
            edge: f64::NEG_INFINITY,
        }
    }
}

impl Neighbours {
    /// The pairs, and how far apart any other two are now at least.
    fn close(&mut self, around: &Around<'_>) -> Close<'_> {
        if self.state != around.number {
            self.state = around.number;
            let way = self.way(around.state).unwrap_or(f64::INFINITY);
            let edge = self.gap - way - MARGIN * (self.gap.abs() + 2.0 * self.widest + way);
            self.edge = if edge.is_nan() { f64::NEG_INFINITY } else { edge };
        }
        Close { pairs: &self.pairs, edge: self.edge, index: None }
    }

    /// How far two can have moved relative to each other since then, m. `None` where others are there, or others than
    /// they were, or places are no numbers.
    fn way(&self, state: &State) -> Option<f64> {
        if self.present != state.present {
            return None;
        }
        if !self.present.iter().enumerate().all(|(block, &here)| {
            let same =
                state.bodies[Parameter::Radius][block].compare(self.radius[block], |now, then| now == then);
            (same | !here) == Mask::ALL
        }) {
            return None;
        }
        let (wide, high) = (self.spread(&state.motion.x, &self.x)?, self.spread(&state.motion.y, &self.y)?);
        Some((wide * wide + high * high).sqrt())
    }

    /// The largest less the smallest way of those who are there, along an axis.
    fn spread(&self, now: &[Lanes], then: &[Lanes]) -> Option<f64> {
        let (mut low, mut high) = (Lanes::splat(f64::INFINITY), Lanes::splat(f64::NEG_INFINITY));
        let mut sum = Lanes::ZERO;
        for ((now, then), &here) in now.iter().zip(then).zip(&self.present) {
            let mut way = now.zip(*then, |now, then| now - then);
            if here != Mask::ALL {
                // Who is not there goes the way of somebody who is.
                let Some(one) = here.iter().next() else { continue };
                (!here).iter().for_each(|lane| way.0[lane] = way.0[one]);
            }
            low = low.zip(way, |low, way| if way < low { way } else { low });
            high = high.zip(way, |high, way| if way > high { way } else { high });
            sum = sum.zip(way, |sum, way| sum + way * 0.0);
        }
        // Zero times what is none or infinite is no number.
        if sum.0.into_iter().any(f64::is_nan) {
            return None;
        }
        let least = low.0.into_iter().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let most = high.0.into_iter().fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a });
        // Each way is rounded as it is long.
        let rounding = (least.abs() + most.abs()) * f64::EPSILON;
        Some(if most >= least { most - least + rounding } else { 0.0 })
    }
}

impl Proximity {
    /// Answers everybody by who was close a while ago, listed anew where that is not enough; false where no list is.
    pub(super) fn listed(&mut self, around: &Around<'_>, question: Question, all: &mut All) -> bool {
        let kind = usize::from(question.measure() == Measure::Centres);
        let places = self.sets(around, question);
        let members = &self.sets[places.0].1;
        let known: Vec<Mask> =
            around.state.present.iter().zip(members).map(|(&here, &member)| here & member).collect();
        for again in [false, true] {
            if again && !self.list(around, question, kind) {
                return false;
            }
            let mut neighbours = std::mem::take(&mut self.neighbours[kind]);
            let asked = self.asked(places, &known);
            let found = read_off(around.state, neighbours.close(around), question, asked, all);
            self.neighbours[kind] = neighbours;
            if let Some(found) = found {
                if matches!(question, Question::Nearest { cut: Cut::Least(_), .. }) {
                    self.least[kind] = found;
                }
                return true;
            }
        }
        false
    }

    /// Lists who is close, farther than a question asks for.
    fn list(&mut self, around: &Around<'_>, question: Question, kind: usize) -> bool {
        if !self.is_sorted(around) {
            return false;
        }
        let places = self.sets(around, question);
        let index = self.index(around);
        let widest = if kind == 1 { 0.0 } else { index.widest };
        let asked = match question {
            Question::AllFar { bound, .. } | Question::Nearest { cut: Cut::Above(bound), .. } => {
                f64::from_bits(bound)
            }
            Question::Nearest { cut: Cut::Least(_), .. } => self.least[kind],
            Question::Nearest { cut: Cut::Nowhere, .. } => return false,
        };
        let most = index.grid.spacing * MOST_SPACINGS - 2.0 * widest * (1.0 + MARGIN);
        let gap = if asked + SKIN < most { asked + SKIN } else { most };
        let pays = gap >= asked + LEAST_SKIN && gap.is_finite();
        if !pays {
            return false;
        }
        let mut pairs = std::mem::take(&mut self.neighbours[kind].pairs);
        pairs.clear();
        let (members, index) = (&self.sets[places.0].1, self.index(around));
        for &agent in around.list().iter().filter(|agent| has(&around.state.present, **agent)) {
            let one = Asker::new(around.state, agent as usize, question.measure());
            for k in index.places(&index.area(one.at, one.reach(index, gap))).flatten() {
                let other = index.agent[k];
                if other <= agent || !has(members, other) {
                    continue;
                }
                let both = if kind == 1 { 0.0 } else { one.radius + index.r[k] };
                if squared(index, one.at, k) <= square((both + gap) + (both + gap.abs()) * MARGIN + 1e-30) {
                    pairs.push((agent, other));
                }
            }
        }
        let neighbours = &mut self.neighbours[kind];
        neighbours.pairs = pairs;
        let state = around.state;
        neighbours.present.clone_from(&state.present);
        for (to, from) in [
            (&mut neighbours.x, &state.motion.x),
            (&mut neighbours.y, &state.motion.y),
            (&mut neighbours.radius, &state.bodies[Parameter::Radius]),
        ] {
            to.clone_from(from);
        }
        (neighbours.gap, neighbours.widest, neighbours.state) = (gap, widest, 0);
        true
    }
}
