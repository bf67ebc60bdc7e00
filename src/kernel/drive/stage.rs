//! Routes as tables of stages: what every trial needs to know of them, worked out once.

use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::base::random::name_hash;
use crate::kernel::code::ground::{Ground, upright};
use crate::model::{Goal, Law, Leg, Route, Scenario};

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

/// One leg of a route.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub(super) target: Target,
    /// Number of the leg in its route; addresses the draw of a pause.
    pub(super) leg: u32,
    /// Whether nothing comes after it.
    pub(super) last: bool,
    /// Whether an agent departs at its end.
    pub(super) leaves: bool,
}

/// All routes of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Drive {
    pub(super) stages: Vec<Stage>,
    /// First stage of each agent.
    pub(super) first: Vec<u32>,
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
            None => Target::Rest,
        },
    }
}

/// The stages of a route; its legs count from `from`.
fn stages(scenario: &Scenario, route: &Route, from: u32) -> Vec<Stage> {
    let (legs, leaves) = match route {
        Route::Onward => {
            return vec![Stage { target: Target::Onward, leg: 0, last: true, leaves: false }];
        }
        Route::Legs { legs, then_leave } => (legs.as_slice(), *then_leave),
    };
    // Whoever stays stands at the last goal anyway: a pause after it changes nothing.
    let pauses = legs.iter().rev().take_while(|leg| matches!(leg, Leg::Wait(_))).count();
    let used = if leaves || pauses == legs.len() { legs } else { &legs[..legs.len() - pauses] };
    let mut stages: Vec<Stage> = used
        .iter()
        .enumerate()
        .map(|(k, leg)| {
            let last = k + 1 == used.len();
            Stage {
                target: target(scenario, leg),
                leg: from.wrapping_add(k as u32),
                last,
                leaves: last && leaves,
            }
        })
        .collect();
    if stages.is_empty() {
        stages.push(Stage { target: Target::Rest, leg: 0, last: true, leaves: false });
    }
    stages
}

impl Drive {
    /// Works out the routes. Neighbours in the list of agents with the same route share its stages, so
    /// that a crowd is steered as one.
    pub fn new(scenario: &Scenario) -> Self {
        let mut out = Self::default();
        for (k, agent) in scenario.agents.iter().enumerate() {
            let same = k.checked_sub(1).filter(|&before| scenario.agents[before].route == agent.route);
            let first = if let Some(before) = same {
                out.first[before]
            } else {
                let first = out.stages.len() as u32;
                out.stages.extend(stages(scenario, &agent.route, 0));
                first
            };
            out.first.push(first);
        }
        out
    }

    /// Adds a route that a state of a behaviour demands; its first stage. Its legs have numbers of their own: they
    /// follow from the name of the state, so that nothing declared elsewhere moves them.
    pub(in crate::kernel) fn detour(&mut self, scenario: &Scenario, route: &Route, name: &str) -> u32 {
        let first = self.stages.len() as u32;
        self.stages.extend(stages(scenario, route, name_hash(name) as u32));
        first
    }
}
