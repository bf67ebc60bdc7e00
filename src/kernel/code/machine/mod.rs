//! The machine that runs linear code: one pass, no recursion, all lanes at once.

mod eight;

use super::crowd::{self, Members, Probe};
use super::lanes::{Body, Vector, View, by_lane, by_lane_of_two, greater, lesser, narrow, widen};
use super::node::{Crowd, Cut, Id, Join, Measure, Node};
use super::proximity::{Around, Asker, Proximity};
use super::schedule::{Instruction, Loop};
use super::{Code, Readings};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::near::Close;
use crate::kernel::state::State;
use crate::model::{Arithmetic, Comparison, Fold, Function, Who};
use fearless_simd::{Simd, prelude::*};

/// A running agent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    agent: u32,
    /// Next place in the list of members.
    next: usize,
    present: Mask,
}

/// What the machine works on.
struct Machine<'a, S: Simd, const ONE: bool> {
    code: &'a Code,
    view: View<'a, S, ONE>,
    numbers: &'a mut [Lanes],
    truths: &'a mut [Mask],
    frames: &'a mut [Frame],
    /// The running agent of which eight are taken at once, and who they are. In one large crowd only; all registers of the
    /// loop hold what each of them has, all others the same in every lane.
    eight: Option<(u32, Body)>,
    /// One for each list, where the lanes are those of one large crowd.
    proximities: &'a mut [Proximity],
    /// Number of the state.
    number: u64,
    /// Who may touch whom in it, where that is known.
    close: Option<Close<'a>>,
    /// In a loop, the register of a smallest measure some of whose values may be larger than they are, and which.
    cut: Option<(Id, Cut)>,
}

/// Runs the code; the registers are left with all values.
#[inline(always)]
pub(super) fn execute<S: Simd, const ONE: bool>(
    simd: S,
    code: &Code,
    (state, close): (&State, Option<Close<'_>>),
    readings: &mut Readings,
) {
    let mut machine = Machine::<S, ONE> {
        code,
        view: View::new(simd, state),
        numbers: &mut readings.numbers,
        truths: &mut readings.truths,
        frames: &mut readings.frames,
        eight: None,
        proximities: &mut readings.proximities,
        number: readings.number,
        close,
        cut: None,
    };
    let instructions = code.schedule.instructions.as_slice();
    let mut at = 0;
    while at < instructions.len() {
        match &instructions[at] {
            Instruction::Do(into, node) => {
                machine.step(*into, node);
                at += 1;
            }
            Instruction::Enter(number) => {
                let info = &code.schedule.loops[*number as usize];
                machine.begin(info);
                at = if machine.advance(info) { info.start } else { machine.finish(info) };
            }
            Instruction::Leave(number) => {
                let info = &code.schedule.loops[*number as usize];
                let settled =
                    if ONE && info.lanewise { machine.join_eight(info) } else { machine.join(info) };
                at = if !settled && machine.advance(info) { info.start } else { machine.finish(info) };
            }
        }
    }
}

impl<'a, S: Simd, const ONE: bool> Machine<'a, S, ONE> {
    #[inline(always)]
    fn who(&self, who: Who) -> usize {
        match who {
            Who::Agent(id) => id.0 as usize,
            Who::Running(var) => self.frames.get(var as usize).map_or(0, |frame| frame.agent as usize),
        }
    }

    #[inline(always)]
    fn members(&self, crowd: Crowd) -> Members<'a> {
        let except = crowd.except.map_or(u32::MAX, |who| self.who(who) as u32);
        Members { list: &self.code.lists[crowd.list as usize], except }
    }

    #[inline(always)]
    fn number(&self, id: Id) -> Vector<S> {
        self.view.register(&self.numbers[id as usize])
    }

    #[inline(always)]
    fn truth(&self, id: Id) -> Mask {
        self.truths[id as usize]
    }

    #[inline(always)]
    fn put(&mut self, into: Id, value: Vector<S>) {
        value.store_slice(&mut self.numbers[into as usize].0);
    }

    #[inline(always)]
    fn begin(&mut self, info: &Loop) {
        self.frames[info.var as usize].next = 0;
        self.cut = info.cut;
        let start = match info.join {
            Join::Fold(Fold::Min) => f64::INFINITY,
            Join::Fold(Fold::Max) => f64::NEG_INFINITY,
            Join::Fold(Fold::Sum | Fold::Mean) | Join::Count => 0.0,
            Join::Forall => {
                self.truths[info.into as usize] = Mask::ALL;
                return;
            }
            Join::Exists => {
                self.truths[info.into as usize] = Mask::NONE;
                return;
            }
        };
        self.put(info.into, self.view.splat(start));
        self.put(info.count, self.view.splat(0.0));
    }

    /// Goes to the next member that is present in some lane.
    #[inline(always)]
    fn advance(&mut self, info: &Loop) -> bool {
        if ONE && info.lanewise {
            return self.advance_eight(info);
        }
        let members = self.members(info.crowd);
        let mut next = self.frames[info.var as usize].next;
        let found = loop {
            let Some(&member) = members.list.get(next) else { break None };
            next += 1;
            let present = self.view.present(member as usize);
            if member != members.except && !present.is_empty() {
                break Some(Frame { agent: member, next, present });
            }
        };
        found.inspect(|&frame| self.frames[info.var as usize] = frame).is_some()
    }

    /// Joins the body's value; whether nothing can change the result any more.
    #[inline(always)]
    fn join(&mut self, info: &Loop) -> bool {
        let present = self.frames[info.var as usize].present;
        let into = info.into as usize;
        let fold = match info.join {
            Join::Forall => {
                self.truths[into] &= self.truth(info.body) | !present;
                return self.truths[into].is_empty();
            }
            Join::Exists => {
                self.truths[into] |= self.truth(info.body) & present;
                return self.truths[into] == Mask::ALL;
            }
            Join::Count => {
                self.add_one(info.into, self.truth(info.body) & present);
                return false;
            }
            Join::Fold(fold) => fold,
        };
        let (before, value) = (self.number(info.into), self.number(info.body));
        let after = match fold {
            Fold::Min => lesser(before, value),
            Fold::Max => greater(before, value),
            Fold::Sum | Fold::Mean => before + value,
        };
        self.put(info.into, widen(self.view.simd, present).select(after, before));
        if fold == Fold::Mean {
            self.add_one(info.count, present);
        }
        false
    }

    #[inline(always)]
    fn add_one(&mut self, register: Id, lanes: Mask) {
        let before = self.number(register);
        self.put(register, widen(self.view.simd, lanes).select(before + 1.0, before));
    }

    /// Ends a loop; where to go on.
    #[inline(always)]
    fn finish(&mut self, info: &Loop) -> usize {
        (self.eight, self.cut) = (None, None);
        if info.join == Join::Fold(Fold::Mean) {
            self.put(info.into, self.number(info.into) / self.number(info.count));
        }
        info.exit
    }

    #[inline(always)]
    fn time(&self) -> Vector<S> {
        let (numerator, denominator) = self.code.step;
        let ticks = &self.view.state.ticks;
        let mut now = self.view.splat(ticks[0] as f64);
        if !ONE {
            for k in 0..LANES {
                now[k] = ticks[k] as f64;
            }
        }
        now * numerator / denominator
    }

    /// One instruction.
    #[inline(always)]
    fn step(&mut self, into: Id, node: &Node) {
        let view = self.view;
        let state = view.state;
        let value = match *node {
            Node::Constant(_) | Node::Loop(..) => return,
            Node::Time => self.time(),
            Node::Variable(id) => match state.variables.get(id as usize) {
                Some(lanes) if ONE => view.splat(lanes.0[0]),
                Some(lanes) => view.register(lanes),
                None => view.splat(f64::NAN),
            },
            Node::Of(reading, who) => crowd::reading(&view, reading, self.body(who)),
            Node::Distance(a, b) => {
                let (a, b) = (self.body(a), self.body(b));
                let (ax, bx) = (view.read(&state.motion.x, a), view.read(&state.motion.x, b));
                let (ay, by) = (view.read(&state.motion.y, a), view.read(&state.motion.y, b));
                distance(ax - bx, ay - by)
            }
            Node::Between([ax, ay, bx, by]) => {
                distance(self.number(ax) - self.number(bx), self.number(ay) - self.number(by))
            }
            Node::ToRegion(x, y, region) => {
                self.code.regions[region as usize].distance(self.number(x), self.number(y))
            }
            Node::Depth(x, y, region) => {
                -self.code.regions[region as usize].signed_distance(self.number(x), self.number(y))
            }
            Node::ToBarrier(x, y, barrier) => {
                self.code.barriers.at(barrier).signed_distance(self.number(x), self.number(y))
            }
            Node::ToScene(x, y) => {
                let closed = |door| state.doors.lanes(door, state.layout);
                self.code.barriers.distance_with_doors((self.number(x), self.number(y)), closed)
            }
            Node::OfTwo(pair, a, b) => {
                crowd::of_two((&view, &self.code.periods), pair, self.body(a), self.body(b))
            }
            Node::Mean(reading, crowd) => crowd::mean_reading(&view, self.members(crowd), reading),
            Node::Spread(crowd, x, y) => {
                crowd::spread(&view, self.members(crowd), self.number(x), self.number(y))
            }
            Node::Crossings(line, window) => {
                let mut counts = view.splat(0.0);
                for lane in 0..LANES {
                    let trial = if ONE { 0 } else { lane };
                    let last = window.map(|ticks| (state.ticks[trial], ticks));
                    counts[lane] = state.passages.count(line, trial, last) as f64;
                }
                counts
            }
            Node::Voronoi(region) => {
                let mut densities = view.splat(0.0);
                if let Some(voronoi) = &self.code.voronoi {
                    for lane in state.occupied.iter() {
                        densities[lane] = voronoi.read(region, state, lane);
                    }
                }
                if ONE { view.splat(densities[0]) } else { densities }
            }
            Node::Nearest(who, crowd, measure) if ONE && self.eight.is_some() => {
                if let Some(found) = self.nearest_of_block(into, who, crowd, measure) {
                    self.put(into, found);
                    return;
                }
                let mut found = view.splat(f64::INFINITY);
                self.one_by_one(
                    #[inline(always)]
                    |this, lane| found[lane] = this.nearest(this.who(who), crowd, measure)[lane],
                );
                found
            }
            Node::Nearest(who, crowd, measure) => self.nearest(self.who(who), crowd, measure),
            Node::Apply(function, a) => apply_all(function, self.number(a)),
            Node::Combine(operator, a, b) => combine_all(operator, self.number(a), self.number(b)),
            Node::Select(c, a, b) => widen(view.simd, self.truth(c)).select(self.number(a), self.number(b)),
            _ => {
                self.truths[into as usize] = self.decide(node);
                return;
            }
        };
        self.put(into, value);
    }

    /// What questions about a crowd are about.
    #[inline(always)]
    fn around(&self, crowd: Crowd) -> Around<'a> {
        let Self { number, close, .. } = *self;
        Around { number, state: self.view.state, lists: &self.code.lists, own: crowd.list, close }
    }

    /// Smallest measure between a body and a crowd.
    #[inline(always)]
    fn nearest(&mut self, who: usize, crowd: Crowd, measure: Measure) -> Vector<S> {
        let (members, around) = (self.members(crowd), self.around(crowd));
        if ONE
            && let Some(proximity) = self.proximities.get_mut(crowd.list as usize)
            && proximity.is_asked_much(&around, 1)
            && let Some(found) =
                proximity.nearest(&around, &Asker::new(self.view.state, who, measure), members.except)
        {
            return self.view.splat(found);
        }
        Probe::new(&self.view, who, measure).nearest(&self.view, members)
    }

    /// The lanes in which the comparison of the measure with a bound has the wanted value for all of a crowd.
    #[inline(always)]
    fn all_far(
        &mut self,
        who: usize,
        crowd: Crowd,
        measure: Measure,
        (test, wanted): (Comparison, bool),
        bound: Vector<S>,
    ) -> Mask {
        let (members, around) = (self.members(crowd), self.around(crowd));
        if ONE
            && let Some(proximity) = self.proximities.get_mut(crowd.list as usize)
            && proximity.is_asked_much(&around, 1)
        {
            let asker = Asker::new(self.view.state, who, measure);
            // The lanes are all the same.
            match proximity.all_far(&around, &asker, members.except, bound[0], (test, wanted)) {
                Some(true) => return Mask::ALL,
                Some(false) => return Mask::NONE,
                None => {}
            }
        }
        Probe::new(&self.view, who, measure).all_far(&self.view, members, bound, test, wanted)
    }

    /// One instruction with a truth value.
    #[inline(always)]
    fn decide(&mut self, node: &Node) -> Mask {
        let view = self.view;
        match *node {
            Node::Truth(true) => Mask::ALL,
            Node::Compare(comparison, a, b) => compare_all(comparison, self.number(a), self.number(b)),
            Node::Not(a) => !self.truth(a),
            Node::And(ref all) => all.iter().fold(Mask::ALL, |mask, &id| mask & self.truth(id)),
            Node::Or(ref all) => all.iter().fold(Mask::NONE, |mask, &id| mask | self.truth(id)),
            Node::Inside(who, region) => {
                let who = self.body(who);
                let (x, y) = (view.read(&view.state.motion.x, who), view.read(&view.state.motion.y, who));
                narrow(self.code.regions[region as usize].contains(x, y))
            }
            Node::Present(who) => view.shows(self.body(who)),
            Node::Entered(source, number) => {
                let entered = view.state.queues.has_entered(source as usize, number);
                match ONE {
                    true if entered.has(0) => Mask::ALL,
                    true => Mask::NONE,
                    false => entered,
                }
            }
            Node::Somebody(crowd) => crowd::somebody(&view, self.members(crowd)),
            Node::AllFar { who, crowd, measure, test, wanted, bound, nearest } => {
                if let Some(nearest) = nearest.map(|id| self.number(id))
                    && narrow(nearest.simd_eq(nearest)) == Mask::ALL
                {
                    // What the nearest does, all do: none is no number.
                    let holds = compare_all(test, nearest, self.number(bound));
                    return if wanted { holds } else { !holds };
                }
                let bound = self.number(bound);
                if ONE && self.eight.is_some() {
                    if let Some(far) = self.all_far_of_block(who, crowd, measure, (test, wanted), bound) {
                        return far;
                    }
                    let mut far = Mask::NONE;
                    self.one_by_one(
                        #[inline(always)]
                        |this, lane| {
                            let bound = view.splat(bound[lane]);
                            let all = this.all_far(this.who(who), crowd, measure, (test, wanted), bound);
                            far |= all & Mask::lane(lane);
                        },
                    );
                    return far;
                }
                self.all_far(self.who(who), crowd, measure, (test, wanted), bound)
            }
            _ => Mask::NONE,
        }
    }
}

#[inline(always)]
fn distance<S: Simd>(dx: Vector<S>, dy: Vector<S>) -> Vector<S> {
    (dx * dx + dy * dy).sqrt()
}

/// A function of all lanes. What is exact on every machine is vector code.
#[inline(always)]
fn apply_all<S: Simd>(function: Function, a: Vector<S>) -> Vector<S> {
    match function {
        Function::Negate => -a,
        Function::Abs => a.abs(),
        Function::Sqrt => a.sqrt(),
        Function::Exp => by_lane(
            a,
            #[inline(always)]
            |x| Function::Exp.of(x),
        ),
        Function::Ln => by_lane(
            a,
            #[inline(always)]
            |x| Function::Ln.of(x),
        ),
        _ => by_lane(
            a,
            #[inline(always)]
            |x| function.of(x),
        ),
    }
}

/// Arithmetic of all lanes.
#[inline(always)]
fn combine_all<S: Simd>(operator: Arithmetic, a: Vector<S>, b: Vector<S>) -> Vector<S> {
    match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide => a / b,
        Arithmetic::Min => lesser(a, b),
        Arithmetic::Max => greater(a, b),
        _ => by_lane_of_two(
            a,
            b,
            #[inline(always)]
            |a, b| operator.of(a, b),
        ),
    }
}

/// A comparison of all lanes; false where a side is not a number.
#[inline(always)]
pub(super) fn compare_all<S: Simd>(comparison: Comparison, a: Vector<S>, b: Vector<S>) -> Mask {
    narrow(match comparison {
        Comparison::Less => a.simd_lt(b),
        Comparison::AtMost => a.simd_le(b),
        Comparison::Greater => a.simd_gt(b),
        Comparison::AtLeast => a.simd_ge(b),
        Comparison::Equal => a.simd_eq(b),
        // Not `simd_ne`, which holds of a NaN.
        Comparison::Unequal => a.simd_lt(b) | a.simd_gt(b),
    })
}

/// Copies the values asked for out of the registers.
pub(super) fn collect(code: &Code, state: &State, readings: &mut Readings) {
    readings.atoms.clear();
    readings.atoms.extend(code.atoms.iter().map(|&id| readings.truths[id as usize]));
    readings.signals.clear();
    readings.signals.extend(code.signals.iter().map(|&id| readings.numbers[id as usize]));
    let open = code.unresolved.map_or(Mask::NONE, |id| readings.truths[id as usize]);
    readings.unresolved = open & state.occupied;
    let (atoms, signals) = &mut readings.missing;
    for (missing, ids) in [(atoms, &code.open.0), (signals, &code.open.1)] {
        missing.clear();
        if !readings.unresolved.is_empty() {
            missing.extend(ids.iter().map(|id| id.map_or(Mask::NONE, |id| readings.truths[id as usize])));
        }
    }
}
