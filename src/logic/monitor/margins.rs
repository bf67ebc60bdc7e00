//! Margins of the parts of a formula, as the states come in: what a step of the robustness monitor does to one cell.
//!
//! A step looks at the positions that something new touches, and at no other: a state more changes the margins of the
//! last positions alone, as long as it is no further from the bounds than those before it.

use super::cell::{Cell, Context, Machine, Ref};
use super::track::select;
use crate::base::lanes::{LANES, Lanes, Mask};

/// Bounds of a margin in eight lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) lower: Lanes,
    pub(super) upper: Lanes,
}

impl Bounds {
    pub(super) const OPEN: Self =
        Self { lower: Lanes::splat(f64::NEG_INFINITY), upper: Lanes::splat(f64::INFINITY) };
    pub(super) const FALSE: Self =
        Self { lower: Lanes::splat(f64::NEG_INFINITY), upper: Lanes::splat(f64::NEG_INFINITY) };
    pub(super) const TRUE: Self =
        Self { lower: Lanes::splat(f64::INFINITY), upper: Lanes::splat(f64::INFINITY) };

    /// A margin that is known. One that is no number counts as false.
    fn known(margin: Lanes) -> Self {
        let margin = margin.map(|m| if m.is_nan() { f64::NEG_INFINITY } else { m });
        Self { lower: margin, upper: margin }
    }

    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self { lower: self.lower.zip(other.lower, &f), upper: self.upper.zip(other.upper, &f) }
    }

    fn or(self, other: Self) -> Self {
        self.zip(other, |x, y| if y > x { y } else { x })
    }

    fn and(self, other: Self) -> Self {
        self.zip(other, |x, y| if y < x { y } else { x })
    }

    pub(super) fn negated(self, negated: bool) -> Self {
        if negated { Self { lower: self.upper.map(|m| -m), upper: self.lower.map(|m| -m) } } else { self }
    }

    /// This in the lanes of the set, the other elsewhere.
    pub(super) fn within(self, lanes: u8, other: Self) -> Self {
        Self { lower: select(lanes, self.lower, other.lower), upper: select(lanes, self.upper, other.upper) }
    }

    /// Whether two are the same to the last bit in these lanes.
    fn same(&self, other: &Self, lanes: u8) -> bool {
        Mask(lanes).iter().all(|lane| {
            self.lower.0[lane].to_bits() == other.lower.0[lane].to_bits()
                && self.upper.0[lane].to_bits() == other.upper.0[lane].to_bits()
        })
    }
}

/// The bounds of one cell.
#[derive(Clone, Debug)]
pub(super) struct Margin {
    /// Of the present state, or the answer at the only position.
    pub(super) now: Bounds,
    /// Of the last positions.
    ring: Box<[Bounds]>,
    /// The positions of the ring whose bounds this step has changed, the latest first.
    changed: Vec<u64>,
    /// Positions so far back may still change.
    latency: u64,
    /// Positions so far back are still looked at.
    kept: u64,
    /// Of a scan: what the first operand was at all states so far. Of a count: the settled part.
    so_far: Bounds,
    /// Of a count: lanes in which the last position has come.
    complete: u8,
    /// Of a count: the most that any position allows, and the latest of those that do. Wrong in the lanes `stale`.
    most: Lanes,
    peak: [u64; LANES],
    stale: u8,
}

impl Margin {
    /// Nothing known. Positions so far back may change (`latency`) and are looked at (`kept`); there is a ring for `states`
    /// of them.
    pub(super) fn new(latency: u64, kept: u64, states: usize) -> Self {
        Self {
            now: Bounds::OPEN,
            ring: vec![Bounds::OPEN; states].into_boxed_slice(),
            changed: Vec::new(),
            latency,
            kept,
            so_far: Bounds::OPEN,
            complete: 0,
            most: Lanes::ZERO,
            peak: [0; LANES],
            stale: 0,
        }
    }

    /// New trials start in these lanes.
    pub(super) fn start(&mut self, machine: &Machine, lanes: u8) {
        self.now = Bounds::OPEN.within(lanes, self.now);
        let empty = if matches!(machine, Machine::Count { .. }) { Bounds::FALSE } else { Bounds::TRUE };
        self.so_far = empty.within(lanes, self.so_far);
        self.complete &= !lanes;
        self.stale &= !lanes;
    }

    fn at(&self, at: u64) -> Bounds {
        self.ring[at as usize & (self.ring.len() - 1)]
    }

    fn store(&mut self, at: u64, bounds: Bounds) {
        let k = at as usize & (self.ring.len() - 1);
        self.ring[k] = bounds;
    }
}

/// A child at a position of its parent.
fn bounds(margins: &[Margin], child: Ref, at: u64, now: u64) -> Bounds {
    let at = at + child.ahead;
    if at > now { Bounds::OPEN } else { margins[child.cell].at(at).negated(child.negated) }
}

fn present(margins: &[Margin], child: Ref) -> Bounds {
    margins[child.cell].now.negated(child.negated)
}

/// The positions of a parent, the latest first, that something new of its children touches. The present one always
/// counts.
fn touched(below: &[Margin], children: &[Ref], floor: u64, now: u64, into: &mut Vec<u64>) {
    into.clear();
    into.push(now);
    for child in children {
        let changed = &below[child.cell].changed;
        into.extend(changed.iter().map(|at| at.saturating_sub(child.ahead)).filter(|at| *at >= floor));
    }
    into.sort_unstable_by(|a, b| b.cmp(a));
    into.dedup();
}

/// One step of cell `k`; `atoms` are margins, `scratch` is for use in between.
pub(super) fn step(
    cells: &mut [Cell],
    margins: &mut [Margin],
    k: usize,
    atoms: &[Lanes],
    cx: &Context,
    scratch: &mut Vec<u64>,
) {
    let (before, rest) = cells.split_at_mut(k);
    let (below, own) = margins.split_at_mut(k);
    let (cell, own) = (&mut rest[0], &mut own[0]);
    own.changed.clear();
    match &cell.machine {
        Machine::Atom(atom) => {
            own.now = Bounds::known(atoms.get(*atom).copied().unwrap_or(Lanes::splat(f64::NAN)));
        }
        Machine::CompareNow(relation, x, y) => {
            own.now = Bounds::known(before[*x].value.zip(before[*y].value, |x, y| relation.margin(x, y)));
        }
        Machine::AnyNow(children) | Machine::AnyHeld(children) => {
            own.now = children.iter().fold(Bounds::FALSE, |all, child| all.or(present(below, *child)));
        }
        Machine::Capture(child) => {
            own.now = present(below, *child).within(cell.need & cx.work, own.now);
        }
        Machine::Scan { first, second } => {
            let open = cell.need & cx.work;
            // The lower bound of what was reached is what counts once the window is over.
            let reached = Bounds { upper: own.now.lower, ..own.now };
            let reached = reached.or(present(below, *second).and(own.so_far));
            let goes_on = first.map_or(own.so_far, |first| own.so_far.and(present(below, first)));
            let upper = reached.or(goes_on).upper;
            let upper = select(cell.last, reached.upper, upper);
            own.now = Bounds { lower: reached.lower, upper }.within(open, own.now);
            own.so_far = goes_on.within(open, own.so_far);
        }
        Machine::Count { child, .. } => {
            let (lanes, last) = (cx.work & cell.live, cell.last);
            count(before, below, *child, (lanes, last), own, cx.now);
        }
        Machine::AnyLate { children, cut } => any(below, children, *cut, own, cx, scratch),
        Machine::Chain { first, second } => chain(below, *first, *second, own, cx, scratch),
        Machine::Watch { .. } => {}
        // Numbers of the present state are those of the Boolean monitor.
        _ => cell.step(before, cx),
    }
    late(cell, own, cx);
}

/// The largest margin at all needed positions of a child. The least that it can be only grows, so what has changed is
/// enough; the most that it can be is looked for again where the position that allowed most has changed.
fn count(before: &[Cell], below: &[Margin], child: Ref, (lanes, last): (u8, u8), own: &mut Margin, now: u64) {
    let (span, track) = (&below[child.cell], &before[child.cell].track);
    own.stale |= last & !own.complete;
    own.complete |= last;
    let mut all = own.now;
    for &at in &span.changed {
        all = all.or(span.at(at).negated(child.negated)).within(track.needed(at), all);
        for lane in Mask(own.complete & !own.stale).iter() {
            own.stale |= u8::from(own.peak[lane] == at) << lane;
        }
    }
    let oldest = now - span.kept;
    own.so_far =
        own.so_far.or(span.at(oldest).negated(child.negated)).within(track.needed(oldest), own.so_far);
    let stale = own.stale & lanes;
    if stale != 0 {
        let mut most = own.so_far.upper;
        let mut peak = [0; LANES];
        for at in oldest..=now {
            let upper = span.at(at).negated(child.negated).upper;
            for lane in Mask(stale & track.needed(at)).iter() {
                if upper.0[lane] >= most.0[lane] {
                    (most.0[lane], peak[lane]) = (upper.0[lane], at);
                }
            }
        }
        own.most = select(stale, most, own.most);
        for lane in Mask(stale).iter() {
            own.peak[lane] = peak[lane];
        }
        own.stale &= !stale;
    }
    let upper = select(own.complete, own.most, Bounds::OPEN.upper);
    own.now = Bounds { lower: all.lower, upper }.within(lanes, own.now);
}

/// Any of some children at the positions that something new touches.
fn any(
    below: &[Margin],
    children: &[Ref],
    cut: bool,
    own: &mut Margin,
    cx: &Context,
    scratch: &mut Vec<u64>,
) {
    let (now, floor) = (cx.now, cx.now - own.latency);
    touched(below, children, floor, now, scratch);
    if cut && cx.ending != 0 {
        // What lies beyond the horizon is false from now on.
        let ahead = children.iter().map(|child| child.ahead).max().unwrap_or(0);
        scratch.extend(floor.max((now + 1).saturating_sub(ahead))..=now);
        scratch.sort_unstable_by(|a, b| b.cmp(a));
        scratch.dedup();
    }
    for &at in &*scratch {
        let mut all = Bounds::FALSE;
        for child in children {
            let mut one = bounds(below, *child, at, now);
            if cut && at + child.ahead > now {
                one = Bounds::FALSE.within(cx.ending, one);
            }
            all = all.or(one);
        }
        if at == now || !all.same(&own.at(at), cx.work) {
            own.store(at, all);
            own.changed.push(at);
        }
    }
}

/// Until without a bound, from the present position back: a position changes with its children and with the one after
/// it, so where neither has changed the next that a child touches is looked at.
fn chain(
    below: &[Margin],
    first: Option<Ref>,
    second: Ref,
    own: &mut Margin,
    cx: &Context,
    scratch: &mut Vec<u64>,
) {
    let (now, floor) = (cx.now, cx.now - own.latency);
    match first {
        Some(first) => touched(below, &[first, second], floor, now, scratch),
        None => touched(below, &[second], floor, now, scratch),
    }
    let mut waiting = scratch.iter().copied().peekable();
    let mut next = Bounds::FALSE.within(cx.ending, Bounds::OPEN);
    let mut at = now;
    loop {
        while waiting.next_if(|&position| position >= at).is_some() {}
        let goes_on = first.map_or(next, |first| next.and(bounds(below, first, at, now)));
        let made = bounds(below, second, at, now).or(goes_on);
        let changed = at == now || !made.same(&own.at(at), cx.work);
        if changed {
            own.store(at, made);
            own.changed.push(at);
        }
        let before = match (changed, waiting.peek()) {
            (true, _) if at > floor => at - 1,
            (false, Some(&position)) => position,
            _ => return,
        };
        (at, next) = (before, own.at(before + 1));
    }
}

/// What is the same for all cells with a track.
fn late(cell: &mut Cell, own: &mut Margin, cx: &Context) {
    if !cell.track.is_kept() {
        return;
    }
    cell.track.begin(cx.now, 0, cell.need);
    if !matches!(cell.machine, Machine::AnyLate { .. } | Machine::Chain { .. }) {
        let present = own.now;
        own.store(cx.now, present);
        own.changed.push(cx.now);
    } else if cell.single {
        for &at in &own.changed {
            own.now =
                own.ring[at as usize & (own.ring.len() - 1)].within(cell.track.needed(at) & cx.work, own.now);
        }
    }
}
