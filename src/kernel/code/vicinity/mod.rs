//! Who is near in one large crowd: the members of a list, sorted by squares of the plane.
//!
//! Asked of each member of a crowd, the clearance and the contact with all others cost the square of their number. Here
//! the members who are present are sorted once a state, when the first questions show that it pays, and a
//! question looks only at the squares around a place, wider and wider until nobody outside can change the answer.
//! The least of several gaps is one of them, and whether some gap is below a bound does not depend on the
//! order either: both have the bits of a look at all, whose roundings are kept. Where most of the members ask the
//! same in each state, `sweep` answers all of them at once. What can be read off the pairs that the forces found near enough
//! to touch (`touching`) needs no search at all, and what can be read off those who were close a while ago (`neighbours`)
//! needs one only now and then.
//!
//! Where a position or a radius is no number, or beyond reason, nothing is sorted: a look at all knows what that means.

mod answers;
mod neighbours;
mod sweep;
mod touching;

use super::crowd::MARGIN;
use super::node::Measure;
use crate::base::geometry::{Bounds, Vec2};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::close::Close;
use crate::kernel::nearby::amply_around;
use crate::kernel::state::State;
use crate::model::{Comparison, Parameter};
use answers::Answers;
use neighbours::Neighbours;
use std::ops::Range;

pub(super) use answers::Question;

/// In a list of so many, a look at all is as fast.
const FEW: usize = 32;

/// So many questions of a state are answered sooner than the members are sorted.
const FEW_QUESTIONS: u32 = 4;

/// Coordinates and radii up to here have squares far from overflow, m.
const FARTHEST: f64 = 1e100;

/// Members whose places say where most of a crowd is.
const SAMPLE: usize = 64;

/// A body that asks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asker {
    /// Its number.
    pub(super) agent: usize,
    at: Vec2,
    radius: f64,
    measure: Measure,
}

impl Asker {
    /// An agent of the only trial of a state.
    #[inline(always)]
    pub(super) fn new(state: &State, agent: usize, measure: Measure) -> Self {
        let radius =
            if measure == Measure::Centres { 0.0 } else { of(&state.bodies[Parameter::Radius], agent) };
        Self { agent, at: Vec2::new(of(&state.motion.x, agent), of(&state.motion.y, agent)), radius, measure }
    }

    /// Whether the squares can answer.
    #[inline(always)]
    fn is_reasonable(&self) -> bool {
        self.at.x.abs() <= FARTHEST && self.at.y.abs() <= FARTHEST && self.radius.abs() <= FARTHEST
    }
}

/// A state, and the members who are asked about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    /// Number of the state.
    pub(super) number: u64,
    pub(super) state: &'a State,
    /// All lists of agents, and which of them holds the members.
    pub(super) lists: &'a [Vec<u32>],
    pub(super) own: u32,
    /// Who may touch whom in this state, where that is known.
    pub(super) close: Option<Close<'a>>,
}

impl<'a> Around<'a> {
    /// The members.
    #[inline(always)]
    fn list(&self) -> &'a [u32] {
        &self.lists[self.own as usize]
    }
}

/// How the plane is cut. Who is outside of it counts to the squares at the rim, which have no end.
#[derive(Clone, Copy, Debug, Default)]
struct Squares {
    low: Vec2,
    per_side: f64,
    columns: usize,
    rows: usize,
}

/// The members of a list who are present in a state of one large crowd.
#[derive(Clone, Debug, Default)]
pub(super) struct Vicinity {
    /// The state that was last asked about, by its number.
    state: u64,
    /// Questions about it, and about the one before.
    asked: (u32, u32),
    /// Whether the members are sorted, if that was tried.
    sorted: Option<bool>,
    squares: Squares,
    /// Side of a square, m.
    side: f64,
    /// Largest radius, m.
    widest: f64,
    /// Where each square starts; one more at the end.
    first: Vec<u32>,
    /// Place of each who is present among squares.
    square: Vec<u32>,
    /// Who is present, in the order of the list.
    here: Vec<u32>,
    /// By squares: number, position and radius.
    agent: Vec<u32>,
    x: Vec<f64>,
    y: Vec<f64>,
    radius: Vec<f64>,
    /// For each agent of the scene how far one had to look for the nearest in the last state, m; 0 where nobody asked.
    far: Vec<f64>,
    /// What everybody asks.
    answers: Vec<Answers>,
    /// Members who were close a while ago, by gaps and by centres.
    neighbours: [Neighbours; 2],
    /// The least gap, and distance of centres, that was last seen, m.
    least: [f64; 2],
    /// Lists of agents as sets of each block, as far as they were needed.
    sets: Vec<(u32, Vec<Mask>)>,
}

#[inline(always)]
fn of(field: &[Lanes], agent: usize) -> f64 {
    field[agent / LANES].0[agent % LANES]
}

impl Vicinity {
    /// Takes note of some more questions about a state. Whether they are so many that a look at all each is too much.
    #[inline(always)]
    pub(super) fn is_asked_much(&mut self, around: &Around<'_>, questions: u32) -> bool {
        if around.list().len() <= FEW {
            return false;
        }
        if self.state != around.number {
            self.state = around.number;
            self.asked = (0, self.asked.0);
            self.sorted = None;
            self.answers.iter_mut().for_each(Answers::forget);
        }
        self.asked.0 = self.asked.0.saturating_add(questions);
        self.asked.0 > FEW_QUESTIONS || self.asked.1 > FEW_QUESTIONS
    }

    /// Whether the members are sorted; sorts them where that is new.
    #[inline(always)]
    fn is_sorted(&mut self, around: &Around<'_>) -> bool {
        if let Some(sorted) = self.sorted {
            return sorted;
        }
        let sorted = self.sort(around.state, around.list());
        self.sorted = Some(sorted);
        sorted
    }

    /// Sorts who is present; false where somebody's numbers are beyond reason.
    fn sort(&mut self, state: &State, list: &[u32]) -> bool {
        let infinite = Vec2::repeat(f64::INFINITY);
        let mut around = Bounds { low: infinite, high: -infinite };
        let (mut widest, mut reasonable) = (f64::NEG_INFINITY, true);
        self.here.clear();
        for &member in list {
            let agent = member as usize;
            if !state.present[agent / LANES].has(agent % LANES) {
                continue;
            }
            let (x, y, radius) = (
                of(&state.motion.x, agent),
                of(&state.motion.y, agent),
                of(&state.bodies[Parameter::Radius], agent),
            );
            // False of what is no number, too.
            reasonable &= x.abs() <= FARTHEST && y.abs() <= FARTHEST && radius.abs() <= FARTHEST;
            widest = if radius > widest { radius } else { widest };
            around.low.x = if x < around.low.x { x } else { around.low.x };
            around.low.y = if y < around.low.y { y } else { around.low.y };
            around.high.x = if x > around.high.x { x } else { around.high.x };
            around.high.y = if y > around.high.y { y } else { around.high.y };
            self.here.push(member);
        }
        if !reasonable || self.here.is_empty() {
            return false;
        }
        self.widest = widest;
        self.cut(state, &around);
        self.place(state);
        self.far.resize(state.agents, 0.0);
        true
    }

    /// Cuts the plane where most are, into about as many squares as there are members: somebody far away must
    /// not make the squares of all others large.
    fn cut(&mut self, state: &State, around: &Bounds) {
        let count = self.here.len();
        let most = |field: &[Lanes], low: f64, high: f64| {
            let every = count.div_ceil(SAMPLE);
            let mut sample: Vec<f64> =
                self.here.iter().step_by(every).map(|&agent| of(field, agent as usize)).collect();
            sample.sort_unstable_by(f64::total_cmp);
            let rim = sample.len() / 16;
            let (first, last) = (sample[rim], sample[sample.len() - 1 - rim]);
            let more = 0.2 * (last - first);
            let (first, last) = (first - more, last + more);
            (if first > low { first } else { low }, if last < high { last } else { high })
        };
        let (left, right) = most(&state.motion.x, around.low.x, around.high.x);
        let (low, high) = most(&state.motion.y, around.low.y, around.high.y);
        let (width, height) = (right - left, high - low);
        let number = count as f64;
        let (even, least) = ((width * height / number).sqrt(), (width + height) / (2.0 * number));
        let side = if even > least { even } else { least };
        self.side = if side > 1e-9 { side } else { 1.0 };
        self.squares = Squares {
            low: Vec2::new(left, low),
            per_side: 1.0 / self.side,
            columns: (width / self.side) as usize + 1,
            rows: (height / self.side) as usize + 1,
        };
    }

    /// Puts everybody into the order of the squares.
    fn place(&mut self, state: &State) {
        let (squares, count) = (self.squares, self.here.len());
        self.first.clear();
        self.first.resize(squares.rows * squares.columns + 1, 0);
        self.square.clear();
        for &member in &self.here {
            let agent = member as usize;
            let square = squares.row(of(&state.motion.y, agent)) * squares.columns
                + squares.column(of(&state.motion.x, agent));
            self.square.push(square as u32);
            self.first[square] += 1;
        }
        let mut total = 0;
        for first in &mut self.first {
            total += *first;
            *first = total;
        }
        self.agent.resize(count, 0);
        for field in [&mut self.x, &mut self.y, &mut self.radius] {
            field.resize(count, 0.0);
        }
        // From the end of each square to its start, which is then known.
        for (&member, &square) in self.here.iter().zip(&self.square).rev() {
            let (agent, next) = (member as usize, &mut self.first[square as usize]);
            *next -= 1;
            let at = *next as usize;
            self.agent[at] = member;
            self.x[at] = of(&state.motion.x, agent);
            self.y[at] = of(&state.motion.y, agent);
            self.radius[at] = of(&state.bodies[Parameter::Radius], agent);
        }
    }

    /// How far apart the centres of an asker and a member can be if the measure is at most `bound`: never
    /// too little.
    #[inline(always)]
    fn reach(&self, measure: Measure, radius: f64, bound: f64) -> f64 {
        if measure == Measure::Centres {
            return bound + bound.abs() * MARGIN + 1e-30;
        }
        let slack = (bound.abs() + radius.abs() + self.widest.abs()) * MARGIN + 1e-30;
        bound + radius + self.widest + slack
    }

    /// The rows and columns of all who are not farther than `reach` from a place.
    #[inline(always)]
    fn around(&self, at: Vec2, reach: f64) -> (Range<usize>, Range<usize>) {
        let (squares, around) = (&self.squares, amply_around(at, reach));
        let rows = squares.row(around.low.y)..squares.row(around.high.y) + 1;
        (rows, squares.column(around.low.x)..squares.column(around.high.x) + 1)
    }

    /// Where the members in some columns of a row are.
    #[inline(always)]
    fn stretch(&self, row: usize, columns: &Range<usize>) -> Range<usize> {
        let first = row * self.squares.columns;
        self.first[first + columns.start] as usize..self.first[first + columns.end] as usize
    }

    /// Squared distance of a member from a place.
    #[inline(always)]
    fn squared(&self, at: Vec2, k: usize) -> f64 {
        let (dx, dy) = (at.x - self.x[k], at.y - self.y[k]);
        dx * dx + dy * dy
    }

    /// Smallest measure from somebody to the members; infinite over nobody. `None` where only a look at all can tell.
    pub(super) fn nearest(&mut self, around: &Around<'_>, asker: &Asker, except: u32) -> Option<f64> {
        if except as usize == asker.agent
            && let Some(found) = self.known_nearest(around, asker.measure, asker.agent)
        {
            return Some(found);
        }
        (asker.is_reasonable() && self.is_sorted(around)).then(|| self.search(asker, except))
    }

    /// The same, of this one only.
    fn search(&mut self, asker: &Asker, except: u32) -> f64 {
        let Asker { at, radius, measure, .. } = *asker;
        let mut best = f64::INFINITY;
        // Nobody goes far in a step.
        let mut reach = self.far[asker.agent] + 0.125 * self.side;
        let needed = loop {
            let (rows, columns) = self.around(at, reach);
            let mut farther = square(self.reach(measure, radius, best));
            for row in rows.clone() {
                for k in self.stretch(row, &columns) {
                    let squared = self.squared(at, k);
                    if squared > farther || self.agent[k] == except {
                        continue;
                    }
                    let found = value(measure, squared.sqrt(), radius, self.radius[k]);
                    if found < best {
                        best = found;
                        farther = square(self.reach(measure, radius, best));
                    }
                }
            }
            // Who is outside of the squares looked at is farther than the reach.
            let needed = self.reach(measure, radius, best);
            let all = rows.len() == self.squares.rows && columns.len() == self.squares.columns;
            if needed <= reach || all {
                break needed;
            }
            reach = if needed < f64::INFINITY { needed } else { 2.0 * reach };
        };
        // With nobody else there, all squares are looked at next time, too.
        self.far[asker.agent] = if 0.0 < needed && needed < FARTHEST { needed } else { 0.0 };
        best
    }

    /// Whether the comparison with a bound has the wanted value for all members, where it has for all who are far
    /// away. `None` where only a look at all can tell.
    pub(super) fn all_far(
        &mut self,
        around: &Around<'_>,
        asker: &Asker,
        except: u32,
        bound: f64,
        (test, wanted): (Comparison, bool),
    ) -> Option<bool> {
        let Asker { agent, at, radius, measure } = *asker;
        if !(asker.is_reasonable() && bound.abs() <= FARTHEST) {
            return None;
        }
        let question = Question::AllFar { measure, test, wanted, bound: bound.to_bits() };
        if except as usize == agent
            && let Some(far) = self.known_far(around, question, agent)
        {
            return Some(far);
        }
        if !self.is_sorted(around) {
            return None;
        }
        let reach = self.reach(measure, radius, bound);
        if reach < 0.0 {
            return Some(true);
        }
        let (farther, (rows, columns)) = (square(reach), self.around(at, reach));
        for row in rows {
            for k in self.stretch(row, &columns) {
                let squared = self.squared(at, k);
                if squared > farther || self.agent[k] == except {
                    continue;
                }
                let found = value(measure, squared.sqrt(), radius, self.radius[k]);
                if test.of(found, bound) != wanted {
                    return Some(false);
                }
            }
        }
        Some(true)
    }
}

impl Squares {
    /// Never falls as the abscissa rises. The cast saturates.
    #[inline(always)]
    fn column(&self, x: f64) -> usize {
        (((x - self.low.x) * self.per_side) as u32 as usize).min(self.columns - 1)
    }

    #[inline(always)]
    fn row(&self, y: f64) -> usize {
        (((y - self.low.y) * self.per_side) as u32 as usize).min(self.rows - 1)
    }
}

/// The square of a reach; nobody is nearer than one below 0.
#[inline(always)]
fn square(reach: f64) -> f64 {
    if reach > 0.0 { reach * reach } else { 0.0 }
}

/// The measure at a distance between a fixed body and a running one of these radii, with the roundings of the expression
/// that it stands for.
#[inline(always)]
fn value(measure: Measure, distance: f64, fixed: f64, running: f64) -> f64 {
    match measure {
        Measure::Centres => distance,
        Measure::GapFixedFirst => distance - fixed - running,
        Measure::GapRunningFirst => distance - running - fixed,
    }
}
