//! Routes as tables of stages: what every trial needs to know of them, worked out once.

use super::drivers::Drivers;
use super::person::way_to;
use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::base::random::name_hash;
use crate::kernel::code::ground::{Ground, upright};
use crate::kernel::tape::Player;
use crate::model::{AgentId, ByDoors, Goal, Law, Leg, Move, Route, Scenario, Sight};
use std::sync::Arc;

/// A body that fits wherever a line does, m.
const NARROW: f64 = 1e-3;

/// How far somebody may be beside a line before it is tested again, m.
const ASIDE: f64 = 0.5;

/// Where a stage leads.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// An upright rectangle.
    Rectangle(Bounds),
    /// A disc.
    Disc {
        /// Its centre.
        centre: Vec2,
        /// Its radius, m.
        radius: f64,
    },
    /// A point.
    Point(Vec2),
    /// Any other form.
    Form(Ground),
    /// Nowhere: stand for a time, s.
    Pause(Law),
    /// On as one started.
    Onward,
    /// Nowhere: stand.
    Rest,
}

impl Target {
    /// The middle of a goal; none of what is no goal.
    pub(super) fn middle(&self) -> Option<Vec2> {
        match self {
            Self::Rectangle(bounds) => Some(0.5 * (bounds.low + bounds.high)),
            Self::Disc { centre, .. } => Some(*centre),
            Self::Point(point) => Some(*point),
            Self::Form(ground) => ground.middle(),
            Self::Pause(_) | Self::Onward | Self::Rest => None,
        }
    }
}

/// One leg of a route.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub(super) target: Target,
    /// Its route, and which leg of that it is.
    pub(super) route: u32,
    pub(super) at: usize,
    /// Number of the leg in its route; addresses the draw of a pause.
    pub(super) leg: u32,
    /// Whether nothing comes after it.
    pub(super) last: bool,
    /// Whether an agent departs at its end.
    pub(super) leaves: bool,
    /// Whether the goal that follows is in sight from the middle of this one: then it must be in sight for who goes on.
    pub(super) open: bool,
    /// Pauses after the last goal of somebody who stays there.
    pub(super) rests: Vec<Law>,
}

/// All routes of a scenario, and the drivers of a run.
#[derive(Clone, Debug)]
pub struct Drive {
    pub(super) scenario: Arc<Scenario>,
    /// Length of a step, s.
    pub(in crate::kernel) dt: f64,
    pub(super) drivers: Drivers,
    /// What hides points of ways, for each set of closed doors; of no barrier without drivers.
    sights: ByDoors<Sight>,
    /// The routes that stages belong to.
    pub(super) routes: Vec<Route>,
    pub(super) stages: Vec<Stage>,
    /// First stage of each agent.
    pub(super) first: Vec<u32>,
    /// First stages of the routes that are moves of an agent.
    named: Vec<(AgentId, Vec<u32>)>,
    /// Most goals of a route.
    pub(super) most_legs: usize,
}

fn target(scenario: &Scenario, leg: &Leg) -> Target {
    match leg {
        Leg::Wait(law) => Target::Pause(law.clone()),
        Leg::To(Goal::Point(point)) => Target::Point(*point),
        Leg::To(Goal::Region(id)) => match scenario.scene.regions.get(id.0 as usize).map(|r| &r.shape) {
            Some(Shape::Circle { centre, radius }) => Target::Disc { centre: *centre, radius: *radius },
            Some(shape @ Shape::Polygon(polygon)) => match upright(polygon) {
                Some(bounds) => Target::Rectangle(bounds),
                None => Target::Form(Ground::region(shape)),
            },
            Some(shape @ Shape::Parts(_)) => Target::Form(Ground::region(shape)),
            None => Target::Rest,
        },
    }
}

/// The stages of a route, the `number`-th of all; its legs count from `from`.
fn stages(scenario: &Scenario, route: &Route, from: u32, number: u32) -> Vec<Stage> {
    let stage = |target, (route, at), leg, (last, leaves)| Stage {
        target,
        route,
        at,
        leg,
        last,
        leaves,
        open: false,
        rests: Vec::new(),
    };
    let (legs, leaves) = match route {
        Route::Onward => {
            return vec![stage(Target::Onward, (number, 0), 0, (true, false))];
        }
        Route::Legs { legs, then_leave } => (legs.as_slice(), *then_leave),
        Route::OneOf { legs, .. } => {
            let one = |(k, leg)| stage(target(scenario, leg), (number, k), 0, (true, false));
            return legs.iter().enumerate().map(one).collect();
        }
    };
    // Whoever stays stands at the last goal anyway: a pause after it changes nothing.
    let pauses = legs.iter().rev().take_while(|leg| matches!(leg, Leg::Wait(_))).count();
    let used = if leaves || pauses == legs.len() { legs } else { &legs[..legs.len() - pauses] };
    let mut stages: Vec<Stage> = used
        .iter()
        .enumerate()
        .map(|(k, leg)| {
            let last = k + 1 == used.len();
            stage(target(scenario, leg), (number, k), from.wrapping_add(k as u32), (last, last && leaves))
        })
        .collect();
    if let Some(last) = stages.last_mut() {
        let rests = legs[used.len()..]
            .iter()
            .filter_map(|leg| if let Leg::Wait(law) = leg { Some(law) } else { None });
        last.rests = rests.cloned().collect();
    }
    if stages.is_empty() {
        stages.push(stage(Target::Rest, (number, 0), 0, (true, false)));
    }
    stages
}

impl Drive {
    /// Who plays trials of a program elsewhere, if anybody may.
    pub(in crate::kernel) fn player(&self) -> Option<&dyn Player> {
        self.drivers.player()
    }

    /// Works out the routes. Neighbours in the list of agents with the same route share its stages, so
    /// that a crowd is steered as one.
    pub fn new(scenario: &Arc<Scenario>, drivers: Drivers) -> Self {
        let mut out = Self {
            scenario: Arc::clone(scenario),
            dt: scenario.clock.step_seconds(),
            drivers,
            sights: ByDoors::new(scenario.scene.doors.len()),
            routes: Vec::new(),
            stages: Vec::new(),
            first: Vec::new(),
            named: Vec::new(),
            most_legs: 0,
        };
        let moves = scenario.moves.iter().flat_map(|moves| &moves.routes);
        let routes = scenario.agents.iter().map(|agent| &agent.route).chain(moves);
        out.most_legs = routes.map(|route| route.goals().count()).max().unwrap_or(0);
        for (k, agent) in scenario.agents.iter().enumerate() {
            let same = k.checked_sub(1).filter(|&before| scenario.agents[before].route == agent.route);
            let first = if let Some(before) = same { out.first[before] } else { out.add(&agent.route, 0) };
            out.first.push(first);
        }
        for moves in &scenario.moves {
            let is_route = |option: &&(String, Move)| matches!(option.1, Move::Route(_));
            let names = moves.options.iter().filter(is_route).map(|(label, _)| label);
            let stages: Vec<u32> =
                names.zip(&moves.routes).map(|(name, route)| out.detour(route, name)).collect();
            out.named.extend(moves.agents().map(|agent| (agent, stages.clone())));
        }
        out
    }

    /// Whether an agent has a driver.
    pub(in crate::kernel) fn has_driver(&self, agent: usize) -> bool {
        self.drivers.of(agent).is_some()
    }

    /// First stage of a route that is a move of an agent.
    pub(super) fn named(&self, agent: usize, number: usize) -> Option<u32> {
        let mut own = self.named.iter().filter(|(whose, _)| whose.0 as usize == agent);
        own.find_map(|(_, stages)| stages.get(number).copied())
    }

    /// What hides points where these doors are closed.
    fn sight(&self, closed: u32) -> &Sight {
        self.sights.of(closed, || {
            let scene = &self.scenario.scene;
            if self.drivers.is_empty() { Sight::default() } else { Sight::new(&scene.with_closed(closed)) }
        })
    }

    /// Whether a place is in sight of somebody of a radius, m: half of the body passes. Whoever turns around a corner in a crowd
    /// is never quite on the line that touches it.
    pub(super) fn sees(&self, closed: u32, (from, to): (Vec2, Vec2), radius: f64) -> bool {
        self.blocker(closed, (from, to), radius, None).is_none()
    }

    /// How near a barrier is to a line, m, as far as somebody may be off it in a look or two.
    pub(super) fn clearance(&self, closed: u32, line: &Segment, radius: f64) -> f64 {
        if self.scenario.scene.storeys.separate(line.a, line.b) {
            return 0.0;
        }
        self.sight(closed).clearance((line.a, line.b), 0.5 * radius + ASIDE)
    }

    /// The piece of a barrier that hides a place from somebody, by its number; one that is likely is looked at first.
    pub(super) fn blocker(
        &self,
        closed: u32,
        line: (Vec2, Vec2),
        radius: f64,
        likely: Option<u32>,
    ) -> Option<u32> {
        // What is on another level is out of sight, though no barrier is in between.
        if self.scenario.scene.storeys.separate(line.0, line.1) {
            return Some(u32::MAX);
        }
        self.sight(closed).blocker(line, 0.5 * radius, likely)
    }

    /// Adds a route that a state of a behaviour or a move demands; its first stage. Its legs have numbers of their own:
    /// they follow from its name, so that nothing declared elsewhere moves them.
    pub(in crate::kernel) fn detour(&mut self, route: &Route, name: &str) -> u32 {
        self.add(route, name_hash(name) as u32)
    }

    fn add(&mut self, route: &Route, from: u32) -> u32 {
        let first = self.stages.len() as u32;
        let number = self.routes.len() as u32;
        self.stages.extend(stages(&self.scenario, route, from, number));
        for k in first as usize + 1..self.stages.len() {
            let before = &self.stages[k - 1];
            let middle = before.target.middle().filter(|_| !before.last);
            let ahead =
                middle.and_then(|middle| Some((middle, way_to(&self.stages[k].target, middle, 0.0)?)));
            self.stages[k - 1].open =
                ahead.is_some_and(|(middle, way)| self.sight(0).is_clear(middle, middle + way, NARROW));
        }
        self.routes.push(route.clone());
        first
    }
}
