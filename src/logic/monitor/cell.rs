//! A cell: one part of a formula, asked about at one range of positions of a trial, for eight lanes.
//!
//! Cells come in three kinds. *Now* cells hold the truth or number of the present state alone. *Held*
//! cells are asked about at a single position and keep the answer. *Late* cells are asked about at many
//! positions and settle them as the states come in; they keep a track.

use super::track::{Numbers, Track, select};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::tick::{Clock, Tick};
use crate::logic::formula::{Aggregation, Operation, Relation};

/// How a cell is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// The present state's; earlier positions are in the track if a parent keeps them.
    Now,
    /// The answer at the only position.
    Held,
    /// A track.
    Late,
    /// A number that is the same everywhere.
    Fixed,
}

/// A child: the value at a position is the cell's value `ahead` positions later, perhaps negated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ref {
    pub(super) cell: usize,
    pub(super) negated: bool,
    pub(super) ahead: u64,
    pub(super) place: Place,
}

impl std::ops::Not for Ref {
    type Output = Self;
    fn not(self) -> Self {
        Self { negated: !self.negated, ..self }
    }
}

/// Arithmetic inside the monitor.
#[derive(Clone, Copy, Debug)]
pub(super) enum Arithmetic {
    /// Two numbers.
    Of(Operation),
    /// The magnitude of the first.
    Abs,
}

/// The least and the greatest of the numbers that a mean averages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) least: Lanes,
    pub(super) most: Lanes,
}

impl Extent {
    pub(super) const EMPTY: Self =
        Self { least: Lanes::splat(f64::INFINITY), most: Lanes::splat(f64::NEG_INFINITY) };

    /// One number more.
    #[inline(always)]
    pub(super) fn with(self, value: Lanes) -> Self {
        Self {
            least: self.least.zip(value, |x, y| Operation::Min.apply(x, y)),
            most: self.most.zip(value, |x, y| Operation::Max.apply(x, y)),
        }
    }

    /// This in the lanes of the set, the other elsewhere.
    pub(super) fn within(self, lanes: u8, other: Self) -> Self {
        Self { least: select(lanes, self.least, other.least), most: select(lanes, self.most, other.most) }
    }
}

/// The operation of a cell.
#[derive(Clone, Debug)]
pub(super) enum Machine {
    /// A truth value of the present state.
    Atom(usize),
    /// Comparison of two numbers of the present state.
    CompareNow(Relation, usize, usize),
    /// Any of some truths of the present state.
    AnyNow(Box<[Ref]>),
    /// A truth of the state at the only position.
    Capture(Ref),
    /// Any of some answers.
    AnyHeld(Box<[Ref]>),
    /// Comparison of two answers.
    CompareHeld(Relation, Ref, Ref),
    /// Until, from the only position on, over truths of the present state.
    Scan { first: Option<Ref>, second: Ref },
    /// Finally, from the only position on, over a late child: false once all states are.
    Count { child: Ref, states: u64, left: [u64; LANES] },
    /// Finally at many positions over a child that settles in order; perhaps the horizon cuts windows.
    Slide { child: Ref, width: u64, cut: bool },
    /// Any, at many positions; perhaps with children beyond the horizon, which are false.
    AnyLate { children: Box<[Ref]>, cut: bool },
    /// Until without a bound, at many positions.
    Chain { first: Option<Ref>, second: Ref },
    /// Comparison at many positions.
    CompareLate(Relation, Ref, Ref),
    /// Whether a truth ever held at a needed position, and at how many it is settled.
    Watch { child: Ref, settled: [u64; LANES] },
    /// A number of the present state.
    Signal(usize),
    /// A number that is the same everywhere.
    Fixed,
    /// Arithmetic of the present state.
    CombineNow(Arithmetic, usize, usize),
    /// A number of the state at the only position.
    CaptureNumber(Ref),
    /// Arithmetic of two answers.
    CombineHeld(Arithmetic, Ref, Ref),
    /// An aggregate from the only position on over a number of the present state.
    Fold { aggregation: Aggregation, child: usize, states: u64, extent: Box<Extent> },
    /// Time until a truth of the present state, from the only position on.
    Time { child: Ref, from: u64 },
    /// Time until an answer about the state at the horizon, seen from there: none or for ever.
    TimeHeld(Ref),
    /// Arithmetic at many positions.
    CombineLate(Arithmetic, Ref, Ref),
    /// An aggregate at many positions; without a width up to the horizon.
    FoldLate { aggregation: Aggregation, child: Ref, width: Option<u64>, in_order: bool },
    /// Time until a truth, at many positions.
    TimeLate { child: Ref, ticks: Numbers },
    /// The answer at the horizon, at many positions.
    EndLate(usize),
}

/// The input of a step.
pub(super) struct Context<'a> {
    /// The batch's step.
    pub(super) now: u64,
    /// Lanes that are watched in this step.
    pub(super) work: u8,
    /// Lanes whose present state is the one at the horizon.
    pub(super) ending: u8,
    /// The batch's step of each lane's first state.
    pub(super) starts: &'a [u64; LANES],
    pub(super) atoms: &'a [Mask],
    pub(super) signals: &'a [Lanes],
    pub(super) clock: Clock,
}

impl Context<'_> {
    /// Seconds of a number of ticks.
    pub(super) fn seconds(&self, ticks: u64) -> f64 {
        self.clock.seconds(Tick(ticks))
    }
}

/// One part of a formula at one range of positions.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) machine: Machine,
    /// Lanes in which some needed position may still be open or is yet to come inside the range.
    pub(super) live: u8,
    /// Lanes whose present position is needed.
    pub(super) need: u8,
    /// Lanes whose present position is the last needed one.
    pub(super) last: u8,
    /// Now cells: true lanes. Others: the lanes in which the answer at the only position is true (of a
    /// number: known).
    pub(super) t: u8,
    /// The lanes in which it is false.
    pub(super) f: u8,
    /// The number, where there is one.
    pub(super) value: Lanes,
    /// Whether a late cell is needed at one position only, and keeps its answer in `t`, `f`, `value`.
    pub(super) single: bool,
    pub(super) track: Track,
    pub(super) numbers: Numbers,
}

/// True and false lanes of a child at the present state, or of its answer.
#[inline(always)]
pub(super) fn truth(before: &[Cell], child: Ref) -> (u8, u8) {
    let cell = &before[child.cell];
    if child.negated { (cell.f, cell.t) } else { (cell.t, cell.f) }
}

/// True and false lanes of a child at a position of its parent; neither if that is still to come.
#[inline(always)]
pub(super) fn planes(before: &[Cell], child: Ref, at: u64, now: u64) -> (u8, u8) {
    let at = at.wrapping_add(child.ahead);
    if at > now {
        return (0, 0);
    }
    let (t, f) = before[child.cell].track.planes(at);
    if child.negated { (f, t) } else { (t, f) }
}

/// The positions of the parent at which a child settled in this step, in ascending order if it settles
/// in order.
#[inline(always)]
pub(super) fn events(before: &[Cell], child: Ref, now: u64) -> impl Iterator<Item = (u64, u8, u8)> {
    let cell = &before[child.cell];
    let (present, changes) = if child.place == Place::Now {
        (Some((now, cell.t, cell.f)), &[][..])
    } else {
        (None, cell.track.changes.as_slice())
    };
    let late =
        changes.iter().map(move |change| (now.wrapping_sub(u64::from(change.back)), change.t, change.f));
    present.into_iter().chain(late).map(move |(at, t, f)| {
        let (t, f) = if child.negated { (f, t) } else { (t, f) };
        (at.wrapping_sub(child.ahead), t, f)
    })
}

/// What an aggregate starts from. Adding to minus zero changes nothing, not even the sign of a zero.
pub(super) fn identity(aggregation: Aggregation) -> f64 {
    match aggregation {
        Aggregation::Min | Aggregation::First => f64::INFINITY,
        Aggregation::Max => f64::NEG_INFINITY,
        Aggregation::Sum | Aggregation::Mean => -0.0,
    }
}

impl Cell {
    pub(super) fn new(machine: Machine) -> Self {
        Self {
            machine,
            live: 0,
            need: 0,
            last: 0,
            t: 0,
            f: 0,
            value: Lanes::ZERO,
            single: false,
            track: Track::default(),
            numbers: Numbers::default(),
        }
    }

    /// New trials start in these lanes.
    pub(super) fn start(&mut self, lanes: u8) {
        self.live &= !lanes;
        self.need &= !lanes;
        self.last &= !lanes;
        self.t &= !lanes;
        self.f &= !lanes;
        self.track.void(lanes);
        match &mut self.machine {
            Machine::Count { states, left, .. } => {
                for lane in Mask(lanes).iter() {
                    left[lane] = *states;
                }
            }
            Machine::Watch { settled, .. } => {
                for lane in Mask(lanes).iter() {
                    settled[lane] = 0;
                }
            }
            Machine::Fold { aggregation, extent, .. } => {
                **extent = Extent::EMPTY.within(lanes, **extent);
                let identity = identity(*aggregation);
                self.value = select(lanes, Lanes::splat(identity), self.value);
            }
            _ => {}
        }
    }

    #[inline(always)]
    pub(super) fn present(&mut self, t: u8, now: u64) {
        self.t = t;
        self.f = !t;
        if self.track.is_kept() {
            self.track.store(now, t);
        }
    }

    #[inline(always)]
    pub(super) fn present_number(&mut self, value: Lanes, now: u64) {
        self.value = value;
        if self.track.is_kept() {
            self.track.store(now, 0xff);
            self.numbers.store(now, 0xff, value);
        }
    }

    /// Keeps the answer of a late cell that is needed at one position.
    pub(super) fn keep_answer(&mut self, now: u64) {
        for change in &self.track.changes {
            self.t |= change.t;
            self.f |= change.f;
            if self.numbers.is_kept() {
                let value = self.numbers.at(now.wrapping_sub(u64::from(change.back)));
                self.value = select(change.t, value, self.value);
            }
        }
    }

    /// Bytes, on the heap too.
    pub(super) fn bytes(&self) -> usize {
        let own = match &self.machine {
            Machine::AnyNow(all) | Machine::AnyHeld(all) | Machine::AnyLate { children: all, .. } => {
                size_of_val(&**all)
            }
            Machine::TimeLate { ticks, .. } => ticks.bytes(),
            Machine::Fold { extent, .. } => size_of_val(&**extent),
            _ => 0,
        };
        size_of::<Self>() + own + self.track.bytes() + self.numbers.bytes()
    }
}
