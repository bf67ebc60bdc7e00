//! One agent of one trial on its way: begin, next leg, advice, pauses. The plain counterpart of the vector
//! code in `lanes`, which hands over to it whenever something happens.

use super::stage::{Drive, Stage, Target};
use crate::base::geometry::{Vec2, rotated};
use crate::base::lanes::Mask;
use crate::base::random::{Purpose, Stream, TrialKey, name_hash};
use crate::base::tick::{Tick, steps_over};
use crate::kernel::code::ground::Ground;
use crate::kernel::code::lanes::Vector;
use crate::kernel::plan::{Occasion, Plan};
use crate::kernel::state::route::Halt;
use crate::kernel::state::{Slot, State, Way};
use crate::model::{Law, Move, Parameter, Route, Start};
use fearless_simd::{Level, dispatch, prelude::*};

/// How far from a point the line across it may be passed so that it counts as reached, m.
pub(super) const PASSING: f64 = 2.0;

/// Squared length below which a vector has no direction.
pub(super) const NO_LENGTH: f64 = 1e-24;

/// What angles of advice are measured from where nobody knows a direction.
const EAST: Vec2 = Vec2::new(1.0, 0.0);

/// The numbers of the draws of what somebody wants, from the names of the fields.
const TURN: u32 = name_hash("heading") as u32;
const GOAL: u32 = name_hash("route") as u32;

/// What one round of a detour adds to the number of a draw.
const ROUND: u32 = 0x9E37_79B9;

/// The unit vector along `v`, if it has a direction.
pub(super) fn unit(v: Vec2) -> Option<Vec2> {
    let square = v.x * v.x + v.y * v.y;
    (square > NO_LENGTH && square.is_finite()).then(|| v * (1.0 / square.sqrt()))
}

/// The way to where a body heads for: the nearest point of the target at least its radius inside, if there is room.
pub(super) fn way_to(target: &Target, at: Vec2, radius: f64) -> Option<Vec2> {
    match target {
        Target::Rectangle(bounds) => {
            // In the same order as the vector code, so that both have the same bits.
            let way = |v: f64, low: f64, high: f64| {
                let half = 0.5 * (high - low);
                let inset = if radius > half { half } else { radius };
                let (inner, outer) = (low - v + inset, high - v - inset);
                let way = if outer < 0.0 { outer } else { 0.0 };
                if inner > 0.0 { inner } else { way }
            };
            let (low, high) = (bounds.low, bounds.high);
            Some(Vec2::new(way(at.x, low.x, high.x), way(at.y, low.y, high.y)))
        }
        // The nearest point of a smaller disc lies on the line to the centre.
        Target::Disc { centre, .. } => Some(centre - at),
        Target::Point(point) => Some(point - at),
        // Inside there is nowhere to go; outside straight on, over the rim.
        Target::Form(ground) => {
            let (inside, way) = form(ground, at);
            (!inside).then_some(way)
        }
        Target::Pause(_) | Target::Onward | Target::Rest => None,
    }
}

/// Whether a point is in a form, and the way to the nearest point of its rim: the vector code, for one.
fn form(ground: &Ground, at: Vec2) -> (bool, Vec2) {
    dispatch!(Level::baseline(), simd => {
        let (x, y) = (Vector::splat(simd, at.x), Vector::splat(simd, at.y));
        let (dx, dy) = ground.way_to_rim(x, y);
        (ground.contains(x, y).test(0), Vec2::new(dx[0], dy[0]))
    })
}

/// Whether a waypoint or goal is reached.
fn reached(stage: &Stage, at: Vec2, radius: f64, origin: Vec2) -> bool {
    match &stage.target {
        Target::Rectangle(b) => at.x >= b.low.x && at.x <= b.high.x && at.y >= b.low.y && at.y <= b.high.y,
        Target::Disc { centre, radius } => {
            let (dx, dy) = (at.x - centre.x, at.y - centre.y);
            dx * dx + dy * dy <= radius * radius
        }
        Target::Point(point) => {
            let (dx, dy) = (at.x - point.x, at.y - point.y);
            let square = dx * dx + dy * dy;
            // Who stays at a point is there only while near it; who goes on may also pass by.
            let passes = !stage.last || stage.leaves;
            let along = dx * (point.x - origin.x) + dy * (point.y - origin.y);
            square <= 4.0 * radius * radius || (passes && along >= 0.0 && square <= PASSING * PASSING)
        }
        Target::Form(ground) => form(ground, at).0,
        Target::Pause(_) | Target::Onward | Target::Rest => false,
    }
}

/// One slot of a state.
pub(super) struct Person<'a> {
    drive: &'a Drive,
    state: &'a mut State,
    agent: usize,
    block: usize,
    lane: usize,
    way: Way,
}

impl<'a> Person<'a> {
    pub(super) fn new(drive: &'a Drive, state: &'a mut State, slot: Slot) -> Self {
        let agent = state.layout.agent_of(slot);
        let Slot { block, lane } = slot;
        let way = state.route.way(block, lane);
        Self { drive, state, agent, block, lane, way }
    }

    pub(super) fn at(&self) -> Vec2 {
        Vec2::new(self.state.motion.x[self.block].0[self.lane], self.state.motion.y[self.block].0[self.lane])
    }

    pub(super) fn radius(&self) -> f64 {
        self.state.bodies[Parameter::Radius][self.block].0[self.lane]
    }

    fn speed(&self) -> f64 {
        self.state.bodies[Parameter::Speed][self.block].0[self.lane]
    }

    fn direction(&self) -> Vec2 {
        Vec2::new(
            self.state.driving.ex[self.block].0[self.lane],
            self.state.driving.ey[self.block].0[self.lane],
        )
    }

    fn key(&self) -> TrialKey {
        self.state.keys[self.state.layout.trial_of(self.lane)]
    }

    fn tick(&self) -> u64 {
        self.state.ticks[self.state.layout.trial_of(self.lane)]
    }

    fn set(&mut self, direction: Option<Vec2>, speed: f64) {
        if let Some(e) = direction {
            self.state.driving.ex[self.block].0[self.lane] = e.x;
            self.state.driving.ey[self.block].0[self.lane] = e.y;
        }
        self.state.driving.speed[self.block].0[self.lane] = speed;
    }

    fn keep(self) {
        self.state.route.set_way(self.block, self.lane, self.way);
    }

    /// Enters a stage: a pause is drawn, a leg remembers where it began.
    fn enter(&mut self, stage: u32) {
        self.way.stage = stage;
        self.way.origin = self.at();
        let stage = &self.drive.stages[stage as usize];
        if let Target::Pause(law) = &stage.target {
            self.way.until = self.tick().saturating_add(self.pause(law, stage.leg));
        }
    }

    /// Goes on to the stage that holds now; whether the agent leaves.
    fn proceed(&mut self) -> bool {
        loop {
            let stage = &self.drive.stages[self.way.stage as usize];
            let is_pause = matches!(stage.target, Target::Pause(_));
            let done = if is_pause {
                self.tick() >= self.way.until
            } else {
                let steps = self.state.plans.stepping(self.block).has(self.lane);
                !steps && (self.is_there() || reached(stage, self.at(), self.radius(), self.way.origin))
            };
            if !done {
                return false;
            }
            if stage.last {
                self.finish(stage);
                return stage.leaves;
            }
            if stage.open && !self.sees_next() {
                return false;
            }
            if !is_pause {
                self.arrive();
            }
            if self.is_there() {
                self.state.plans.end(Slot { block: self.block, lane: self.lane });
            }
            self.enter(self.way.stage + 1);
            self.set_out();
            self.ask(Occasion::Leg);
        }
    }

    /// Whether its driver says that it is at the goal.
    fn is_there(&self) -> bool {
        let slot = Slot { block: self.block, lane: self.lane };
        self.state.plans.plan(slot) == Some(&Plan::There)
    }

    /// Way gone, m.
    fn travelled(&self) -> f64 {
        self.state.motion.travelled[self.block].0[self.lane]
    }

    /// Begins a leg.
    fn set_out(&mut self) {
        let (travelled, tick) = (self.travelled(), self.tick());
        self.state.progress.set_out(Slot { block: self.block, lane: self.lane }, travelled, tick);
    }

    /// Ends a leg of its own route.
    fn arrive(&mut self) {
        if self.way.round == 0 {
            let (travelled, tick) = (self.travelled(), self.tick());
            let (slot, clock) = (Slot { block: self.block, lane: self.lane }, self.drive.scenario.clock);
            self.state.progress.arrive(slot, travelled, tick, clock);
        }
    }

    /// Ends its own route, once. Pauses that come after the last goal of somebody who stays are over later.
    fn finish(&mut self, stage: &Stage) {
        let Slot { block, lane } = Slot { block: self.block, lane: self.lane };
        if self.way.round != 0 || self.state.progress.done_at[block].0[lane] < f64::INFINITY {
            return;
        }
        if !matches!(stage.target, Target::Pause(_)) {
            self.arrive();
        }
        let rests = (1..).zip(&stage.rests).map(|(k, law)| self.pause(law, stage.leg.wrapping_add(k)));
        let ticks = rests.fold(self.tick(), u64::saturating_add);
        // As `time` is, with which it is compared.
        self.state.progress.done_at[block].0[lane] = self.drive.scenario.clock.seconds(Tick(ticks));
    }

    /// A pause of a leg, in ticks.
    fn pause(&self, law: &Law, leg: u32) -> u64 {
        let later = self.state.queues.later(self.agent, self.state.layout.trial_of(self.lane));
        let entity = self.drive.scenario.agents[self.agent].entity + later;
        let stream = Stream::of(self.key(), entity, Purpose::Pause);
        let uniform = stream.uniform(leg.wrapping_add(self.way.round.wrapping_mul(ROUND)));
        // A negative time or NaN is no pause; one that never ends is cut at the end of all ticks.
        steps_over(law.draw(uniform), self.drive.dt) as u64
    }

    /// Whether the goal of the next stage is in sight; always for who goes straight whatever is in the way, or along a
    /// trajectory.
    fn sees_next(&self) -> bool {
        let slot = Slot { block: self.block, lane: self.lane };
        let (at, radius) = (self.at(), self.radius());
        let closed = self.state.closed_doors(self.lane);
        let next = &self.drive.stages[self.way.stage as usize + 1].target;
        self.drive.drivers.of(self.agent).is_none()
            || self.state.plans.has_trajectory(slot)
            || way_to(next, at, radius).is_none_or(|way| self.drive.sees(closed, (at, at + way), radius))
    }

    /// Where its stage leads.
    pub(super) fn target(&self) -> &'a Target {
        &self.drive.stages[self.way.stage as usize].target
    }

    /// Number of the next point of its way.
    pub(super) fn point(&self) -> usize {
        self.state.plans.held(Slot { block: self.block, lane: self.lane }).point
    }

    /// Whether the agent is inside the last goal.
    pub(super) fn has_arrived(&self) -> bool {
        let stage = &self.drive.stages[self.way.stage as usize];
        stage.last && (self.is_there() || reached(stage, self.at(), self.radius(), self.way.origin))
    }

    /// Sets the driving direction and speed that the route wants now.
    fn head(&mut self) {
        let stage = &self.drive.stages[self.way.stage as usize];
        if matches!(stage.target, Target::Onward) {
            let (direction, moves) = self.way.onward;
            let speed = if moves { self.speed() } else { 0.0 };
            self.set(moves.then_some(direction), speed);
            return;
        }
        // Who is at the goal and does not see the next one goes on to its middle, from where it is in sight.
        let middle = stage
            .target
            .middle()
            .filter(|_| stage.open && reached(stage, self.at(), self.radius(), self.way.origin));
        let way = middle.map(|middle| middle - self.at());
        match way.or_else(|| way_to(&stage.target, self.at(), self.radius())) {
            Some(way) if !self.has_arrived() => {
                let speed = self.speed();
                self.set(unit(way), speed);
            }
            _ => self.set(None, 0.0),
        }
    }

    /// The driver, if there is one, is to be asked.
    fn ask(&mut self, occasion: Occasion) {
        if self.drive.drivers.of(self.agent).is_some() {
            self.state.plans.ask(Slot { block: self.block, lane: self.lane }, occasion);
        }
    }

    /// Sets driving direction and speed, under advice or not; on a plan these are set elsewhere.
    fn follow(&mut self) {
        if self.way.advised_until > 0 && self.tick() >= self.way.advised_until {
            self.way.advised_until = 0;
            self.ask(Occasion::Diverted);
        }
        let led = self.state.plans.led(self.block).has(self.lane);
        if self.way.advised_until > 0 {
            let direction = unit(self.way.advice);
            let speed = if direction.is_some() { self.speed() } else { 0.0 };
            self.set(direction, speed);
        } else if !led {
            self.head();
        }
    }

    /// A number that somebody wants, drawn once for each agent and trial.
    fn drawn(&self, law: &Law, draw: u32) -> f64 {
        law.constant().unwrap_or_else(|| law.draw(self.uniform(draw)))
    }

    /// A uniform number of the agent in this trial, or of its group.
    fn uniform(&self, draw: u32) -> f64 {
        let later = self.state.queues.later(self.agent, self.state.layout.trial_of(self.lane));
        let agent = &self.drive.scenario.agents[self.agent];
        let entity = agent.start.wants_as.unwrap_or(agent.entity + later);
        Stream::of(self.key(), entity, Purpose::Parameter).uniform(draw)
    }

    /// Which of the goals it has one of.
    fn goal(&self) -> u32 {
        let Route::OneOf { weights, .. } = &self.drive.scenario.agents[self.agent].route else { return 0 };
        let uniform = self.uniform(GOAL);
        let mut below = 0.0;
        let chosen = weights.iter().position(|weight| {
            below += weight;
            uniform < below
        });
        // Rounding may leave the sum below 1.
        let last = || weights.iter().rposition(|weight| *weight > 0.0);
        chosen.or_else(last).unwrap_or(0) as u32
    }

    /// Puts an agent at the beginning of its way. Its position, parameters and key must be in the state.
    pub(super) fn begin(mut self, start: &Start, advice: Option<(Move, u64)>) {
        let moving = unit(start.driving()).map(|ahead| match self.drawn(&start.turn, TURN) {
            0.0 => ahead,
            turn => rotated(ahead, turn),
        });
        let speed = start.driving().norm();
        self.way = Way::default();
        let own = self.drive.first[self.agent] + self.goal();
        let first = match advice {
            Some((Move::Route(number), _)) => self.drive.named(self.agent, number).unwrap_or(own),
            _ => own,
        };
        self.enter(first);
        self.set_out();
        // The first goal, past the pauses before it.
        let stages = &self.drive.stages[first as usize..];
        let towards = stages
            .iter()
            .take(stages.iter().position(|stage| stage.last).map_or(0, |last| last + 1))
            .find_map(|stage| way_to(&stage.target, self.at(), self.radius()))
            .and_then(unit);
        let onward = matches!(self.drive.stages[own as usize].target, Target::Onward);
        if onward && moving.is_some() && !start.own_speed {
            // Who goes on as recorded has the recorded speed as driving speed.
            self.state.bodies[Parameter::Speed][self.block].0[self.lane] = speed;
        }
        // Who wants to go nowhere, and never did, looks nowhere, though they may be pushed or come to rest: the social force is
        // felt alike all around.
        let direction = towards.or(moving.filter(|_| onward)).unwrap_or_else(Vec2::zeros);
        self.way.onward = (direction, moving.is_some());
        self.set(Some(direction), 0.0);
        // Who starts at a goal goes on to the next; nobody leaves before the first step.
        self.proceed();
        if let Some((advice @ (Move::Heading(_) | Move::Stop), ticks)) = advice
            && ticks > 0
        {
            self.head();
            let ahead = unit(self.direction()).or(moving).unwrap_or(EAST);
            self.way.advice =
                if let Move::Heading(angle) = advice { rotated(ahead, angle) } else { Vec2::zeros() };
            self.way.advised_until = self.tick().saturating_add(ticks);
        }
        self.follow();
        self.keep();
    }

    /// Goes on along another route. A pause that had begun there lasts only what was left of it. Who just `comes` does not
    /// leave in the same state.
    pub(super) fn divert(mut self, from: Halt, round: u32, comes: bool) {
        self.way.round = round;
        self.enter(from.stage);
        self.ask(Occasion::Diverted);
        if let Some(left) = from.left {
            self.way.until = self.tick().saturating_add(left);
        }
        if comes {
            self.proceed();
            self.follow();
            self.keep();
        } else {
            self.step();
        }
    }

    /// Takes over a speed or a plan that has changed.
    pub(super) fn renew(mut self) {
        self.follow();
        self.keep();
    }

    /// Does whatever is due at the present position and tick.
    pub(super) fn step(mut self) {
        if self.proceed() {
            self.set(None, 0.0);
            self.state.present[self.block] &= !Mask::lane(self.lane);
            self.state.plans.clear(Slot { block: self.block, lane: self.lane });
        } else {
            if self.state.plans.on_way(self.block).has(self.lane) && self.has_arrived() {
                self.state.plans.end(Slot { block: self.block, lane: self.lane });
            }
            self.follow();
        }
        self.keep();
    }
}
