//! From a tree to cells: each part at each range of positions at which it is asked about.
//!
//! The range of the root is its first state alone; windows widen it for what is below them. A formula at
//! a single position is held, a formula at several is a track, and what depends on the present state
//! alone is computed once for all. Operators are brought down to any, finally and until from the present
//! state on; every rewriting keeps the state at which the verdict falls.

mod formulas;
mod numbers;

use super::calendar::Turn;
use super::cell::{Cell, Machine, Place, Ref};
use super::track::{Numbers, Track};
use crate::base::lanes::Lanes;
use crate::base::tick::{Clock, Tick};
use crate::logic::formula::{NodeId, Tree};
use crate::logic::invalid::Invalid;
use crate::logic::reach::{Part, children_first, last_state};
use std::collections::BTreeMap;

/// Most positions that all tracks may hold together.
const MOST_STATES: u64 = 1 << 21;
/// Longest horizon: sums of positions and bounds stay far from the largest number.
const LONGEST_HORIZON: u64 = 1 << 40;
/// Most cells.
const MOST_CELLS: usize = 1 << 18;

/// The root of a monitor.
#[derive(Clone, Copy, Debug)]
pub(super) enum Answer {
    /// A formula that does not depend on any state.
    Truth(bool),
    /// A metric that does not.
    Value(f64),
    /// A held formula.
    Formula(Ref),
    /// A held number.
    Metric(Ref),
}

/// An implication, and who knows whether its antecedent was true.
#[derive(Clone, Debug)]
pub(super) struct Watched {
    pub(super) implication: NodeId,
    /// The antecedent does not depend on any state and is true.
    pub(super) always: bool,
    pub(super) watches: Vec<Watch>,
}

/// Who knows whether an antecedent was true at some positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    pub(super) cell: usize,
    /// The first position that is asked about.
    pub(super) first: u64,
    /// The last one.
    pub(super) last: u64,
}

/// The cells of a monitor, children first.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) cells: Vec<Cell>,
    pub(super) turns: Vec<(u64, Turn, usize)>,
    pub(super) answer: Answer,
    pub(super) watches: Vec<Watched>,
    /// Of each cell: a position is settled at most so many states later, and is looked at so long.
    pub(super) spans: Vec<(u64, u64)>,
}

/// First and last position at which something is asked about.
type Span = (u64, u64);

/// A part made: the same everywhere, or a cell.
#[derive(Clone, Copy, Debug)]
enum Made<T> {
    Constant(T),
    Of(Ref),
}

impl<T> Made<T> {
    /// The value `by` positions later.
    fn later(self, by: u64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value),
            Self::Of(child) => Self::Of(later(child, by)),
        }
    }
}

impl std::ops::Not for Made<bool> {
    type Output = Self;
    fn not(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(!value),
            Self::Of(child) => Self::Of(!child),
        }
    }
}

impl Made<bool> {
    fn not_if(self, negated: bool) -> Self {
        if negated { !self } else { self }
    }
}

fn later(child: Ref, by: u64) -> Ref {
    match child.place {
        Place::Now | Place::Late => Ref { ahead: child.ahead + by, ..child },
        Place::Held | Place::Fixed => child,
    }
}

/// Properties of a cell while the plan is made. Positions are those of a trial.
struct Facts {
    place: Place,
    /// First and last needed position.
    range: Option<Span>,
    /// A position is settled at most so many states later.
    latency: u64,
    /// Positions settle in ascending order.
    in_order: bool,
    /// How many positions back parents look.
    kept: Option<u64>,
    /// It is a number.
    numeric: bool,
}

/// Two cells of the present state with the same key are one.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum NowKey {
    Atom(u32),
    Signal(u32),
    Number(u64),
    Any(Vec<(usize, bool)>),
    Compare(u8, usize, usize),
    Combine(u8, usize, usize),
}

struct Builder<'t> {
    tree: &'t Tree,
    clock: Clock,
    horizon: u64,
    /// The state at which everything is decided, if that does not depend on the horizon.
    end: Option<u64>,
    cells: Vec<Cell>,
    facts: Vec<Facts>,
    present: BTreeMap<NowKey, usize>,
    formulas: BTreeMap<(u32, Span), Made<bool>>,
    numbers: BTreeMap<(u32, Span), Made<f64>>,
    /// The value of each term that is the same everywhere.
    constants: Vec<Option<f64>>,
    watches: BTreeMap<u32, Watched>,
    /// Whether margins are asked for: then windows are doubled where others slide, and a comparison of constants has a margin.
    margins: bool,
}

impl Plan {
    pub(super) fn new(
        tree: &Tree,
        root: Part,
        horizon: Tick,
        clock: Clock,
        margins: bool,
    ) -> Result<Self, Invalid> {
        if clock.is_jumps() {
            return Err(Invalid::NoSteps);
        }
        if horizon.0 > LONGEST_HORIZON {
            return Err(Invalid::TooLong { horizon: horizon.0, limit: LONGEST_HORIZON });
        }
        let order = children_first(tree, root)?;
        let (needed, endless) = last_state(tree, root, Some(horizon), clock)?;
        if needed > horizon {
            return Err(Invalid::BeyondHorizon { needed: needed.0, horizon: horizon.0 });
        }
        let mut builder = Builder {
            tree,
            clock,
            horizon: horizon.0,
            end: if endless { None } else { Some(needed.0) },
            cells: Vec::new(),
            facts: Vec::new(),
            present: BTreeMap::new(),
            formulas: BTreeMap::new(),
            numbers: BTreeMap::new(),
            constants: vec![None; tree.terms.len()],
            watches: BTreeMap::new(),
            margins,
        };
        for part in order {
            builder.note(part);
        }
        let answer = match root {
            Part::Node(id) => match builder.formula(id, (0, 0))? {
                Made::Constant(value) => Answer::Truth(value),
                Made::Of(child) => Answer::Formula(builder.held(child, 0)),
            },
            Part::Term(id) => match builder.number(id, (0, 0))? {
                Made::Constant(value) => Answer::Value(value),
                Made::Of(child) => Answer::Metric(builder.held(child, 0)),
            },
        };
        builder.finish(answer)
    }
}

impl Builder<'_> {
    /// Constants and implications, before anything is made.
    fn note(&mut self, part: Part) {
        match part {
            Part::Term(id) => {
                self.constants[id.0 as usize] = self.tree.constant(id, |x| self.constants[x.0 as usize]);
            }
            Part::Node(id) => {
                if self.tree.antecedent(id).is_some() {
                    let watched = Watched { implication: id, always: false, watches: Vec::new() };
                    self.watches.insert(id.0, watched);
                }
            }
        }
    }

    fn add(&mut self, machine: Machine, facts: Facts) -> usize {
        self.cells.push(Cell::new(machine));
        self.facts.push(facts);
        self.cells.len() - 1
    }

    /// A cell of the present state.
    fn present(&mut self, key: NowKey, machine: Machine, numeric: bool) -> Ref {
        let cell = if let Some(&cell) = self.present.get(&key) {
            cell
        } else {
            let place = if matches!(machine, Machine::Fixed) { Place::Fixed } else { Place::Now };
            let facts = Facts { place, range: None, latency: 0, in_order: true, kept: None, numeric };
            let cell = self.add(machine, facts);
            self.present.insert(key, cell);
            cell
        };
        Ref { cell, negated: false, ahead: 0, place: self.facts[cell].place }
    }

    /// A cell with the answer at one position; `range` is where it looks at its children.
    fn answer(&mut self, machine: Machine, range: Span, latency: u64, numeric: bool) -> Ref {
        let place = Place::Held;
        let facts = Facts { place, range: Some(range), latency, in_order: true, kept: None, numeric };
        let cell = self.add(machine, facts);
        Ref { cell, negated: false, ahead: 0, place }
    }

    /// A cell with a track. If one position alone is asked about, it keeps the answer there.
    fn late(&mut self, machine: Machine, range: Span, latency: u64, in_order: bool, numeric: bool) -> Ref {
        let latency = latency.min(self.horizon - range.0);
        let single = range.0 == range.1;
        let place = if single { Place::Held } else { Place::Late };
        let facts = Facts { place, range: Some(range), latency, in_order, kept: Some(latency), numeric };
        let cell = self.add(machine, facts);
        self.cells[cell].single = single;
        Ref { cell, negated: false, ahead: 0, place }
    }

    /// A parent looks at a child in this range of its own positions.
    fn touch(&mut self, child: Ref, (lo, hi): Span) {
        if child.place == Place::Now {
            let (lo, hi) = (lo + child.ahead, (hi + child.ahead).min(self.horizon));
            let range = &mut self.facts[child.cell].range;
            *range = Some(range.map_or((lo, hi), |(a, b)| (a.min(lo), b.max(hi))));
        }
    }

    /// A parent with this latency looks back at a child.
    fn keep(&mut self, child: Ref, latency: u64) {
        if matches!(child.place, Place::Now | Place::Late) {
            let kept = &mut self.facts[child.cell].kept;
            *kept = Some(kept.map_or(latency, |k| k.max(latency)));
        }
    }

    /// How many states after a position of its parent a child is settled.
    fn delay(&self, child: Ref) -> u64 {
        match child.place {
            Place::Fixed => 0,
            _ => self.facts[child.cell].latency.saturating_add(child.ahead),
        }
    }

    fn check_size(&self) -> Result<(), Invalid> {
        let made = self.cells.len().max(self.formulas.len()).max(self.numbers.len());
        if made > MOST_CELLS {
            return Err(Invalid::TooLarge { needed: made as u64, limit: MOST_CELLS as u64 });
        }
        Ok(())
    }

    fn finish(mut self, answer: Answer) -> Result<Plan, Invalid> {
        // What is asked of a now cell is asked of its operands.
        for cell in (0..self.cells.len()).rev() {
            let (Place::Now, Some(range)) = (self.facts[cell].place, self.facts[cell].range) else {
                continue;
            };
            let children: Vec<usize> = match &self.cells[cell].machine {
                Machine::CompareNow(_, x, y) | Machine::CombineNow(_, x, y) => vec![*x, *y],
                Machine::AnyNow(all) => all.iter().map(|child| child.cell).collect(),
                _ => Vec::new(),
            };
            for child in children {
                let place = self.facts[child].place;
                self.touch(Ref { cell: child, negated: false, ahead: 0, place }, range);
            }
        }
        let states = |kept: u64| kept.saturating_add(1);
        let needed = self.facts.iter().filter_map(|facts| facts.kept).fold(0u64, |sum, kept| {
            sum.saturating_add(states(kept).checked_next_power_of_two().unwrap_or(u64::MAX))
        });
        if needed > MOST_STATES {
            return Err(Invalid::TooLarge { needed, limit: MOST_STATES });
        }
        let mut turns = Vec::new();
        if self.end.is_none() {
            turns.push((self.horizon, Turn::Horizon, usize::MAX));
        }
        for (k, (cell, facts)) in self.cells.iter_mut().zip(&self.facts).enumerate() {
            if let Some(kept) = facts.kept {
                cell.track = Track::new(states(kept) as usize, facts.place != Place::Now);
                if facts.numeric {
                    cell.numbers = Numbers::new(states(kept) as usize);
                    if let Machine::TimeLate { ticks, .. } = &mut cell.machine {
                        *ticks = Numbers::new(states(kept) as usize);
                    }
                }
            }
            if let Some((lo, hi)) = facts.range {
                let end = hi.saturating_add(facts.latency).saturating_add(1);
                turns.extend([(lo, Turn::Begin, k), (hi, Turn::Last, k), (end, Turn::End, k)]);
                turns.push((hi + 1, Turn::Past, k));
            }
        }
        turns.retain(|turn| turn.0 <= self.end.unwrap_or(self.horizon));
        for cell in &mut self.cells {
            cell.start(0xff);
        }
        let spans = self.facts.iter().map(|facts| (facts.latency, facts.kept.unwrap_or(0))).collect();
        let watches = self.watches.into_values().collect();
        Ok(Plan { cells: self.cells, turns, answer, watches, spans })
    }

    /// A number that is the same everywhere.
    fn fixed(&mut self, value: f64) -> Ref {
        let fixed = self.present(NowKey::Number(value.to_bits()), Machine::Fixed, true);
        self.cells[fixed.cell].value = Lanes::splat(value);
        fixed
    }
}
