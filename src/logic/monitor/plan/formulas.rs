//! Cells of formulas.

use super::{Builder, Made, NowKey, Span, Watch, later};
use crate::base::tick::Tick;
use crate::logic::formula::{Node, NodeId, Window};
use crate::logic::invalid::Invalid;
use crate::logic::monitor::cell::{Machine, Place, Ref};
use std::collections::BTreeMap;

/// An operand of an until: any of some formulas, each perhaps negated, and all that perhaps negated.
#[derive(Clone, Copy)]
struct Side<'a> {
    any: &'a [(NodeId, bool)],
    negated: bool,
}

/// A window below some positions.
pub(super) struct Stretch {
    /// The states it covers.
    pub(super) span: Span,
    /// States after its first one; `None` up to the horizon.
    pub(super) width: Option<u64>,
}

impl Builder<'_> {
    /// The states of a window below `lo ..= hi`.
    pub(super) fn stretch(&self, window: Window, (lo, hi): Span) -> Stretch {
        let (lo, end) = (lo + window.from.0, self.horizon);
        match window.to {
            Some(to) => Stretch { span: (lo, hi + to.0), width: Some(to.0 - window.from.0) },
            None => Stretch { span: (lo, end), width: (lo >= end).then_some(0) },
        }
    }

    /// The formula `id`, asked about at the positions `lo ..= hi`.
    pub(super) fn formula(&mut self, id: NodeId, (lo, hi): Span) -> Result<Made<bool>, Invalid> {
        if let Some(&made) = self.formulas.get(&(id.0, (lo, hi))) {
            return Ok(made);
        }
        self.check_size()?;
        let tree = self.tree;
        let made = match &tree.nodes[id.0 as usize] {
            Node::Constant(value) => Made::Constant(*value),
            Node::Atom(atom) => {
                Made::Of(self.present(NowKey::Atom(atom.0), Machine::Atom(atom.0 as usize), false))
            }
            Node::Compare(relation, x, y) => self.compare(*relation, *x, *y, (lo, hi))?,
            Node::Not(x) => !self.formula(*x, (lo, hi))?,
            // All hold where not any fails, and so on.
            node @ (Node::Or(all) | Node::And(all)) => {
                let turned = matches!(node, Node::And(_));
                let mut parts = Vec::with_capacity(all.len());
                for part in all {
                    parts.push(self.formula(*part, (lo, hi))?.not_if(turned));
                }
                if tree.antecedent(id).is_some() {
                    self.watch(id, !parts[0], (lo, hi));
                }
                self.any(parts, (lo, hi)).not_if(turned)
            }
            node @ (Node::Finally(w, x) | Node::Globally(w, x)) => {
                let turned = matches!(node, Node::Globally(..));
                let below = self.stretch(*w, (lo, hi));
                let child = self.formula(*x, below.span)?.not_if(turned);
                self.some_state(child, w.from, below.width, (lo, hi)).not_if(turned)
            }
            node @ (Node::Until(w, p, q) | Node::Release(w, p, q)) => {
                let turned = matches!(node, Node::Release(..));
                let (p, q) = ([(*p, turned)], [(*q, turned)]);
                let (first, second) = (Side { any: &p, negated: false }, Side { any: &q, negated: false });
                let (from, width) = (w.from.0, self.stretch(*w, (lo, hi)).width);
                let then = self.until_here(width, first, second, (lo + from, hi + from))?;
                self.guarded(from, first, then, (lo, hi))?.not_if(turned)
            }
            // p W q is not (!q U (!p & !q)): it fails at the first state without p before any with q.
            Node::WeakUntil(w, p, q) => {
                let (not_q, both) = ([(*q, true)], [(*p, false), (*q, false)]);
                let (first, second) =
                    (Side { any: &not_q, negated: false }, Side { any: &both, negated: true });
                let below = self.stretch(*w, (lo, hi));
                let from = w.from.0;
                let weak = !self.until_here(below.width, first, second, (lo + from, hi + from))?;
                let p = [(*p, false)];
                self.guarded(from, Side { any: &p, negated: false }, weak, (lo, hi))?
            }
        };
        self.formulas.insert((id.0, (lo, hi)), made);
        Ok(made)
    }

    /// Notes whether the antecedent of an implication is ever true.
    fn watch(&mut self, id: NodeId, antecedent: Made<bool>, (lo, hi): Span) {
        let watch = match antecedent {
            Made::Constant(value) => {
                if let Some(watched) = self.watches.get_mut(&id.0) {
                    watched.always |= value;
                }
                return;
            }
            Made::Of(child) => {
                self.touch(child, (lo, hi));
                let range =
                    if child.place == Place::Now { (lo + child.ahead, hi + child.ahead) } else { (lo, hi) };
                let machine = Machine::Watch { child, settled: [0; crate::base::lanes::LANES] };
                let cell = self.answer(machine, range, self.horizon, false).cell;
                Watch { cell, first: lo, last: hi }
            }
        };
        if let Some(watched) = self.watches.get_mut(&id.0) {
            watched.watches.push(watch);
        }
    }

    /// The answer at position `at` to what is asked about there alone.
    pub(super) fn held(&mut self, child: Ref, at: u64) -> Ref {
        if child.place != Place::Now {
            return child;
        }
        self.touch(child, (at, at));
        let (at, numeric) = (at + child.ahead, self.facts[child.cell].numeric);
        let machine = if numeric { Machine::CaptureNumber(child) } else { Machine::Capture(child) };
        self.answer(machine, (at, at), 0, numeric)
    }

    /// Any of these at the positions `lo ..= hi`.
    fn any(&mut self, parts: Vec<Made<bool>>, (lo, hi): Span) -> Made<bool> {
        // Those of one state are one.
        let mut present: BTreeMap<u64, Vec<(usize, bool)>> = BTreeMap::new();
        let mut children: Vec<Ref> = Vec::new();
        for part in parts {
            match part {
                Made::Constant(true) => return Made::Constant(true),
                Made::Constant(false) => {}
                Made::Of(child) if child.place == Place::Now => {
                    present.entry(child.ahead).or_default().push((child.cell, child.negated));
                }
                Made::Of(child) => children.push(child),
            }
        }
        for (ahead, mut parts) in present {
            parts.sort_unstable();
            parts.dedup();
            let refs: Box<[Ref]> = parts
                .iter()
                .map(|&(cell, negated)| Ref { cell, negated, ahead: 0, place: Place::Now })
                .collect();
            let child = match *refs {
                [child] => child,
                _ => self.present(NowKey::Any(parts), Machine::AnyNow(refs), false),
            };
            children.push(later(child, ahead));
        }
        match children.as_slice() {
            [] => Made::Constant(false),
            [child] => Made::Of(*child),
            _ if lo == hi => {
                let held = children.into_iter().map(|child| self.held(child, lo)).collect();
                Made::Of(self.answer(Machine::AnyHeld(held), (lo, lo), self.horizon, false))
            }
            _ => Made::Of(self.any_late(&children, (lo, hi), false)),
        }
    }

    fn any_late(&mut self, children: &[Ref], (lo, hi): Span, cut: bool) -> Ref {
        let ahead = children.iter().map(|child| child.ahead).min().unwrap_or(0);
        let (lo, hi) = (lo + ahead, hi + ahead);
        let children: Box<[Ref]> =
            children.iter().map(|child| Ref { ahead: child.ahead - ahead, ..*child }).collect();
        let latency = children.iter().map(|child| self.delay(*child)).max().unwrap_or(0);
        for &child in &children {
            self.touch(child, (lo, hi));
            self.keep(child, latency);
        }
        later(self.late(Machine::AnyLate { children, cut }, (lo, hi), latency, false, false), ahead)
    }

    /// The child holds at some state of the window that begins `from` after each of `lo ..= hi`; a window
    /// that reaches beyond the horizon ends there.
    pub(super) fn some_state(
        &mut self,
        child: Made<bool>,
        from: Tick,
        width: Option<u64>,
        (lo, hi): Span,
    ) -> Made<bool> {
        let (child, width) = match (child, width) {
            (Made::Constant(value), _) => return Made::Constant(value),
            (child, Some(0)) => return child.later(from.0),
            (Made::Of(child), width) => (child, width),
        };
        // Windows begin at the child's own positions.
        let ahead = from.0 + child.ahead;
        let (lo, hi) = (lo + ahead, hi + ahead);
        let child = Ref { ahead: 0, ..child };
        let reach = width.map_or(self.horizon, |width| (hi + width).min(self.horizon));
        let cut = width.is_some_and(|width| hi + width > self.horizon);
        self.touch(child, (lo, reach));
        let delay = self.delay(child);
        if lo == hi {
            let cell = if child.place == Place::Now {
                self.answer(Machine::Scan { first: None, second: child }, (lo, reach), 0, false)
            } else {
                let states = reach - lo + 1;
                let machine = Machine::Count { child, states, left: [states; crate::base::lanes::LANES] };
                self.answer(machine, (lo, reach), delay, false)
            };
            return Made::Of(cell);
        }
        let cell = match width {
            None => {
                let latency = self.horizon - lo;
                self.keep(child, latency);
                self.late(Machine::Chain { first: None, second: child }, (lo, hi), latency, true, false)
            }
            Some(width) if !self.margins && self.facts[child.cell].in_order => {
                let latency = width.saturating_add(delay);
                self.late(Machine::Slide { child, width, cut }, (lo, hi), latency, true, false)
            }
            // It settles out of order.
            Some(width) => {
                self.doubled(child, width, (lo, hi), |all, halves, range| all.any_late(&halves, range, cut))
            }
        };
        Made::Of(later(cell, ahead))
    }

    /// Something over windows of 2, 4, 8, … states, each of two of the last size, so that a change costs the logarithm of
    /// the width.
    pub(super) fn doubled(
        &mut self,
        child: Ref,
        width: u64,
        (lo, hi): Span,
        mut join: impl FnMut(&mut Self, [Ref; 2], Span) -> Ref,
    ) -> Ref {
        let states = width + 1;
        let (mut size, mut half) = (1, child);
        while size * 2 <= states {
            half = join(self, [half, later(half, size)], (lo, hi + states - 2 * size));
            size *= 2;
        }
        if size == states { half } else { join(self, [half, later(half, states - size)], (lo, hi)) }
    }

    fn side(&mut self, side: Side, at: Span) -> Result<Made<bool>, Invalid> {
        let parts = side.any.iter().map(|&(part, negated)| Ok(self.formula(part, at)?.not_if(negated)));
        let parts = parts.collect::<Result<Vec<_>, Invalid>>()?;
        Ok(self.any(parts, at).not_if(side.negated))
    }

    fn both(&mut self, x: Made<bool>, y: Made<bool>, (lo, hi): Span) -> Made<bool> {
        !self.any(vec![!x, !y], (lo, hi))
    }

    /// `then`, and the guard at every state of the first `states`.
    fn guarded(
        &mut self,
        states: u64,
        guard: Side,
        then: Made<bool>,
        (lo, hi): Span,
    ) -> Result<Made<bool>, Invalid> {
        let then = then.later(states);
        if states == 0 {
            return Ok(then);
        }
        let guard = self.side(guard, (lo, hi + states - 1))?;
        let guard = !self.some_state(!guard, Tick(0), Some(states - 1), (lo, hi));
        Ok(self.both(guard, then, (lo, hi)))
    }

    /// Until over windows that begin at the present state.
    fn until_here(
        &mut self,
        width: Option<u64>,
        first: Side,
        second: Side,
        (lo, hi): Span,
    ) -> Result<Made<bool>, Invalid> {
        if width == Some(0) {
            return self.side(second, (lo, hi));
        }
        let end = self.horizon;
        let (reach, before) = width.map_or((end, hi.max(end - 1)), |w| (hi + w, hi + w - 1));
        if lo == before {
            // One state before the last: second, or first and then second.
            let next = self.side(second, (lo + 1, lo + 1))?.later(1);
            let first = self.side(first, (lo, lo))?;
            let then = self.both(first, next, (lo, lo));
            let second = self.side(second, (lo, lo))?;
            return Ok(self.any(vec![second, then], (lo, lo)));
        }
        let made_second = self.side(second, (lo, reach))?;
        let made_first = self.side(first, (lo, before))?;
        let (p, q) = match (made_first, made_second) {
            (_, Made::Constant(value)) => return Ok(Made::Constant(value)),
            (Made::Constant(true), _) => return Ok(self.some_state(made_second, Tick(0), width, (lo, hi))),
            (Made::Constant(false), _) => return self.side(second, (lo, hi)),
            (Made::Of(p), Made::Of(q)) => (p, q),
        };
        let ahead = p.ahead.min(q.ahead);
        let of_now = p.place == Place::Now && q.place == Place::Now && p.ahead == q.ahead;
        if lo == hi && of_now {
            self.touch(p, (lo, reach));
            self.touch(q, (lo, reach));
            let machine = Machine::Scan { first: Some(p), second: q };
            return Ok(Made::Of(self.answer(machine, (lo + ahead, reach + ahead), 0, false)));
        }
        let delay = self.delay(p).max(self.delay(q)) - ahead;
        let latency = width.map_or(end - lo, |width| width.saturating_add(delay));
        let chain = self.chain(p, q, ahead, (lo, hi), latency, of_now);
        if width.is_none() {
            return Ok(Made::Of(chain));
        }
        let in_time = self.some_state(made_second, Tick(0), width, (lo, hi));
        Ok(self.both(in_time, Made::Of(chain), (lo, hi)))
    }

    fn chain(
        &mut self,
        p: Ref,
        q: Ref,
        ahead: u64,
        (lo, hi): (u64, u64),
        latency: u64,
        in_order: bool,
    ) -> Ref {
        for child in [p, q] {
            self.touch(child, (lo, hi + latency));
            self.keep(child, latency);
        }
        let first = Some(Ref { ahead: p.ahead - ahead, ..p });
        let second = Ref { ahead: q.ahead - ahead, ..q };
        let range = (lo + ahead, hi + ahead);
        later(self.late(Machine::Chain { first, second }, range, latency, in_order, false), ahead)
    }
}
