//! From a tree to cells: which part is asked about at which moments, and how it is answered.

mod formulas;
mod now;
mod numbers;

use super::cells::{Cell, Cells, Whole};
use super::moment::{FOREVER, LONGEST_HORIZON, Moment, Scale};
use super::number::{Number, Source};
use super::truth::{Machine, Ref, Truth};
use super::{Watched, Way};
use crate::base::decimal::Decimal;
use crate::base::tick::{Clock, Tick};
use crate::logic::formula::{NodeId, Tree, Window};
use crate::logic::invalid::Invalid;
use crate::logic::present::{Code, Parts, Present};
use crate::logic::reach::{Asked, Part, asked, children_first, last_state};
use std::collections::BTreeMap;

/// Most cells.
const MOST_CELLS: usize = 1 << 18;

/// The code of present states, the way to the answer, the scale of time, and the implications.
pub(super) fn plan(
    tree: &Tree,
    root: Part,
    horizon: Tick,
    quantum: Decimal,
) -> Result<(Present, Way, Scale, Vec<Watched>), Invalid> {
    let (mut builder, order, asked) = prepare(tree, root, horizon, quantum, false)?;
    let scale = builder.scale;
    let mut watched = Vec::new();
    for part in order {
        builder.parts.note(part);
        if let Some(slot) = builder.antecedent(part) {
            let (first, last) = asked.of(part).unwrap_or((0, asked.last));
            watched.push(Watched { slot, first: scale.exact(Tick(first)), last: scale.exact(Tick(last)) });
        }
    }
    if let Some(direct) = builder.direct(root) {
        return Ok((builder.parts.present, Way::Direct(direct), scale, watched));
    }
    let root = match root {
        Part::Node(id) => Whole::Truth(builder.truth(id, (0, 0))?),
        Part::Term(id) => Whole::Number(builder.number(id, (0, 0))?),
    };
    let cells = Cells::new(builder.truths, builder.numbers, builder.order, root);
    Ok((builder.parts.present, Way::Cells(Box::new(cells)), scale, watched))
}

/// The code of present states and the truths of a formula, operands first, and which of them it is.
pub(super) fn plan_cells(
    tree: &Tree,
    root: NodeId,
    horizon: Tick,
    quantum: Decimal,
) -> Result<(Present, Vec<Truth>, Ref, Scale), Invalid> {
    let (mut builder, order, _) = prepare(tree, Part::Node(root), horizon, quantum, true)?;
    for part in order {
        builder.parts.note(part);
    }
    let root = builder.truth(root, (0, 0))?;
    Ok((builder.parts.present, builder.truths, root, builder.scale))
}

/// What builds cells, the parts in order, and the last ticks at which they are asked about.
fn prepare(
    tree: &Tree,
    root: Part,
    horizon: Tick,
    quantum: Decimal,
    margins: bool,
) -> Result<(Builder<'_>, Vec<Part>, Asked), Invalid> {
    let order = children_first(tree, root)?;
    if horizon.0 > LONGEST_HORIZON {
        return Err(Invalid::TooLong { horizon: horizon.0, limit: LONGEST_HORIZON });
    }
    if quantum.is_negative() || quantum.numerator() == 0 {
        return Err(Invalid::NoSteps);
    }
    let asked = asked(tree, root, Some(horizon), Clock::Jumps(quantum))?;
    let needed = asked.last;
    if needed > horizon.0 {
        return Err(Invalid::BeyondHorizon { needed, horizon: horizon.0 });
    }
    let scale = Scale::new(horizon, quantum);
    let builder = Builder {
        tree,
        scale,
        parts: Parts::new(tree, margins),
        truths: Vec::new(),
        numbers: Vec::new(),
        order: Vec::new(),
        known_truths: BTreeMap::new(),
        known_numbers: BTreeMap::new(),
        known_comparisons: BTreeMap::new(),
    };
    Ok((builder, order, asked))
}

/// The first and the last moment at which something is asked about.
type Range = (Moment, Moment);

struct Builder<'t> {
    tree: &'t Tree,
    scale: Scale,
    parts: Parts<'t>,
    truths: Vec<Truth>,
    numbers: Vec<Number>,
    order: Vec<Cell>,
    known_truths: BTreeMap<(u32, Range), Ref>,
    known_numbers: BTreeMap<(u32, Range), usize>,
    known_comparisons: BTreeMap<(u8, u32, u64), usize>,
}

impl Builder<'_> {
    /// Where the left side of an implication is in the code of present states. One that is the same everywhere stands there, too.
    fn antecedent(&mut self, part: Part) -> Option<usize> {
        let Part::Node(id) = part else { return None };
        let antecedent = self.tree.antecedent(id)?.0 as usize;
        match self.parts.node_constants[antecedent] {
            Some(true) => Some(self.parts.present.add(Code::All([].into()))),
            Some(false) => Some(self.parts.present.add(Code::Any([].into()))),
            None => self.parts.node_slots[antecedent],
        }
    }

    /// Up to which tick a formula looks that is asked about at the start, through bounds alone.
    fn last_asked(&self, id: NodeId) -> Result<Tick, Invalid> {
        let clock = Clock::Jumps(self.scale.quantum());
        last_state(self.tree, Part::Node(id), None, clock).map(|(last, _)| last)
    }

    /// The last moment of a trial.
    fn last(&self) -> Moment {
        self.scale.end() - 1
    }

    /// A window's ends as shifts.
    fn shifts(&self, window: Window) -> (Moment, Moment) {
        (self.scale.shift(window.from), window.to.map_or(FOREVER, |to| self.scale.shift(to)))
    }

    /// Where a part is asked about through a window.
    fn through(&self, (from, to): (Moment, Moment), (lo, hi): Range) -> Range {
        (lo + from, if to == FOREVER { self.last() } else { hi + to })
    }

    fn add_truth(&mut self, machine: Machine, (lo, hi): Range) -> Result<Ref, Invalid> {
        self.check_size()?;
        self.truths.push(Truth::new(machine, lo, hi + 1));
        let cell = self.truths.len() - 1;
        self.order.push(Cell::Truth(cell));
        Ok(Ref { cell, negated: false })
    }

    fn add_number(&mut self, source: Source, (lo, hi): Range) -> Result<usize, Invalid> {
        self.check_size()?;
        self.numbers.push(Number::new(source, lo, hi + 1));
        let cell = self.numbers.len() - 1;
        self.order.push(Cell::Number(cell));
        Ok(cell)
    }

    fn check_size(&self) -> Result<(), Invalid> {
        if self.order.len() >= MOST_CELLS {
            let needed = self.order.len() as u64 + 1;
            return Err(Invalid::TooLarge { needed, limit: MOST_CELLS as u64 });
        }
        Ok(())
    }
}
