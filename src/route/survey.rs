//! What is wrong or doubtful with the ways of a scenario, before the first trial: goals that nobody can reach from any place
//! of a start, and those that only some can.

use super::atlas::Atlas;
use super::way::ShortestWay;
use super::wayfinder::is_drawn;
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::model::{Agent, AgentId, Goal, Obstacle, Parameter, Position, Route, Scenario, Scene, Sight};

/// A start or goal is looked at in so many rows of so many places; and in more where none of these has a way.
const ROWS: u32 = 8;
const MORE_ROWS: u32 = 40;

/// The share of drawn radii that is looked at.
const WIDEST: f64 = 0.999;

/// How bad something about ways is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoubtKind {
    /// No trial can have a way.
    Never,
    /// A trial may have none.
    Sometimes,
    /// The way leads around the outside of the walls.
    Around,
}

/// Something about the ways of some agents.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// The first of them.
    pub agent: AgentId,
    /// How bad it is.
    pub kind: DoubtKind,
    /// In words.
    pub said: String,
    /// The barrier that is in between, by its number, if one is.
    pub between: Option<usize>,
    /// What would mend it.
    pub hint: String,
}

const MEND: &str = "move the goal or the start, open the barrier, or write `wayfinding = straight` in the kind to go straight whatever is in the way";
const CLOSE: &str =
    "open the wall that is in between, or close the open ends with walls; see `smc explain W0803`";
const EXPLAINED: &str = "agents without a way stand still; see `smc explain W0802`";

/// Places of a shape: rows of a grid, and a point inside.
pub(super) fn places(shape: &Shape, rows: u32) -> Vec<Vec2> {
    let bounds = shape.bounds();
    let size = bounds.high - bounds.low;
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(rows);
    let grid = (0..rows).flat_map(|row| (0..rows).map(move |column| (share(column), share(row))));
    let at = |(x, y): (f64, f64)| bounds.low + Vec2::new(size.x * x, size.y * y);
    let inside = grid.map(at).filter(|p| shape.contains(*p));
    std::iter::once(shape.inner_point()).chain(inside).collect()
}

/// Where a leg may begin or end.
#[derive(Clone, Copy)]
pub(super) enum Place<'s> {
    Point(Vec2),
    Shape(&'s Shape),
}

impl Place<'_> {
    /// Its places outside of obstacles.
    pub(super) fn places(&self, scene: &Scene, rows: u32) -> Vec<Vec2> {
        let all = match self {
            Self::Point(point) => vec![*point],
            Self::Shape(shape) => shape.parts().iter().flat_map(|part| places(part, rows)).collect(),
        };
        let free = all.iter().copied().filter(|p| inside(scene, *p).is_none()).collect::<Vec<_>>();
        if free.is_empty() { all } else { free }
    }
}

/// The solid obstacle in which a place lies.
fn inside(scene: &Scene, p: Vec2) -> Option<String> {
    let mut barriers = scene.barriers.iter();
    let found =
        barriers.find(|b| matches!(b.obstacle, Obstacle::Solid(_)) && b.obstacle.distance(p) < 0.0)?;
    Some(found.phrase())
}

fn number(v: f64) -> f64 {
    (v * 100.0).round() / 100.0
}

/// What a goal is called.
fn goal_name(scene: &Scene, goal: &Goal) -> String {
    match goal {
        Goal::Region(id) => format!("`{}`", scene.regions[id.0 as usize].name),
        Goal::Point(p) => scene.storeys.place(*p),
    }
}

/// A way from one goal to the next.
pub(super) struct Stretch<'s> {
    /// Where it begins, and what that is called; `None` where another agent decides it.
    pub(super) origin: Option<(Place<'s>, String)>,
    /// Where it ends, and what that is called.
    pub(super) goal: &'s Goal,
    pub(super) end: Place<'s>,
    pub(super) name: String,
}

/// The ways of an agent, from goal to goal.
pub(super) fn stretches<'s>(scene: &'s Scene, agent: &'s Agent) -> Vec<Stretch<'s>> {
    let mut origin = match &agent.start.position {
        Position::Point(point) => Some((Place::Point(*point), "its start".to_owned())),
        Position::Within(shape) => Some((Place::Shape(shape), "its start".to_owned())),
        Position::Near { .. } => None,
    };
    let drawn = matches!(agent.route, Route::OneOf { .. });
    agent
        .route
        .goals()
        .map(|goal| {
            let name = goal_name(scene, goal);
            let end = match goal {
                Goal::Point(point) => Place::Point(*point),
                Goal::Region(region) => Place::Shape(&scene.regions[region.0 as usize].shape),
            };
            // Who has one of some goals goes to each from the start.
            let from = if drawn { origin.clone() } else { origin.replace((end, name.clone())) };
            Stretch { origin: from, goal, end, name }
        })
        .collect()
}

/// What is doubtful about the ways of some agents of a scenario. `planned` looks at the ways of those who plan, where ways lead
/// through the scene.
pub(super) fn doubts(
    atlas: &Atlas,
    scenario: &Scenario,
    agents: &[AgentId],
    planned: impl Fn(AgentId, &str) -> Option<Doubt>,
) -> Vec<Doubt> {
    let agent = |id: AgentId| &scenario.agents[id.0 as usize];
    let alike = |a: &Agent, b: &Agent| {
        a.start.position == b.start.position
            && a.route == b.route
            && a.body == b.body
            && a.particle == b.particle
    };
    let mut out = Vec::new();
    let mut rest = agents;
    while let Some((&first, others)) = rest.split_first() {
        let count = others.iter().take_while(|id| alike(agent(first), agent(**id))).count();
        rest = &others[count..];
        let who = match count {
            0 => format!("`{}`", agent(first).name),
            _ => format!("`{}` and {count} more", agent(first).name),
        };
        let known = out.len();
        of_agent(atlas, scenario, (first, &who), &mut out);
        if !out[known..].iter().any(|doubt| doubt.kind == DoubtKind::Never) {
            out.extend(planned(first, &who));
        }
    }
    out
}

fn of_agent(atlas: &Atlas, scenario: &Scenario, (id, who): (AgentId, &str), out: &mut Vec<Doubt>) {
    let scene = &scenario.scene;
    let agent = &scenario.agents[id.0 as usize];
    let law = &agent.body[Parameter::Radius];
    let body = |of: f64| agent.particle.map_or(of, |particle| particle.radius(of));
    let radius = |of: f64| Atlas::class(body(of).max(0.01), is_drawn(agent));
    let (least, most) = (radius(law.bounds().0), radius(law.draw(WIDEST)));
    for Stretch { origin, goal, name, .. } in stretches(scene, agent) {
        if let Some((from, from_name)) = &origin {
            let with_way = |rows: u32, radius: f64| {
                let places = from.places(scene, rows);
                let count = places.iter().filter(|p| atlas.way(**p, goal, radius).is_some()).count();
                (count, places.len())
            };
            let known = out.len();
            let mut doubt = |said| {
                let hint = EXPLAINED.to_owned();
                out.push(Doubt { agent: id, kind: DoubtKind::Sometimes, said, between: None, hint });
            };
            let places = from.places(scene, ROWS);
            let ways: Vec<_> = places.iter().map(|p| atlas.way(*p, goal, least)).collect();
            let (some, all) = (ways.iter().flatten().count(), ways.len());
            if some == 0 && (all == 1 || with_way(MORE_ROWS, least).0 == 0) {
                let inside = into(scene, goal);
                let between = if inside.is_none() { enclosing(scene, from, least, goal) } else { None };
                let named = between.map(|k| &scene.barriers[k]).filter(|barrier| !barrier.name.is_empty());
                let why = match (inside, named) {
                    (Some(obstacle), _) => format!(": it lies inside {obstacle}"),
                    (None, Some(barrier)) => format!("; {} is in between", barrier.phrase()),
                    (None, None) => String::new(),
                };
                let said = format!("no way leads {who} from {from_name} to {name}{why}");
                out.push(Doubt { agent: id, kind: DoubtKind::Never, said, between, hint: MEND.to_owned() });
                return;
            }
            if some < all {
                doubt(format!(
                    "no way leads {who} to {name} from {} of {all} places of {from_name}",
                    all - some
                ));
            } else if most > least && with_way(ROWS, most).0 < all {
                let wide = number(most);
                doubt(format!("a way of {who} to {name} is too narrow for bodies with a radius of {wide} m"));
            }
            if let Goal::Point(p) = goal
                && let Some(distance) = nearest(scene, *p).filter(|distance| *distance < least)
            {
                let (near, radius) = (number(distance), number(least));
                doubt(format!(
                    "{name}, a goal of {who}, is {near} m from a barrier, nearer than a radius of {radius} m"
                ));
            }
            let long = |(p, way): (&Vec2, &Option<ShortestWay>)| {
                let (way, straight) = (way.as_ref()?, distance(scene, *p, goal));
                let is_long = way.length >= 2.0 * straight && leaves_walls(scene, *p, way);
                is_long.then(|| (number(way.length), number(straight)))
            };
            if out.len() == known
                && let Some((length, straight)) = places.iter().zip(&ways).find_map(long)
            {
                let said = format!(
                    "the shortest way of {who} from {from_name} to {name} leads around the outside of the walls: {length} m instead of {straight} m"
                );
                let hint = CLOSE.to_owned();
                out.push(Doubt { agent: id, kind: DoubtKind::Around, said, between: None, hint });
            }
        }
    }
}

/// Whether a way between two places among the barriers leaves the rectangle around all barriers.
fn leaves_walls(scene: &Scene, from: Vec2, way: &ShortestWay) -> bool {
    let bounds = scene.barriers.iter().filter_map(|barrier| barrier.obstacle.bounds());
    let around = Bounds::around(bounds.flat_map(|bounds| [bounds.low, bounds.high]));
    let is_in =
        |around: &Bounds, p: Vec2| around.low.inf(&p) == around.low && around.high.sup(&p) == around.high;
    scene.periods.are_none()
        && around.is_some_and(|around| {
            is_in(&around, from)
                && is_in(&around, way.end)
                && way.points().iter().any(|p| !is_in(&around, *p))
        })
}

/// Distance from a place to a goal, m.
fn distance(scene: &Scene, p: Vec2, goal: &Goal) -> f64 {
    match goal {
        Goal::Point(point) => (p - point).norm(),
        Goal::Region(id) => scene.regions[id.0 as usize].shape.distance(p),
    }
}

/// Distance from a place to the nearest barrier, m.
fn nearest(scene: &Scene, p: Vec2) -> Option<f64> {
    scene.barriers.iter().map(|barrier| barrier.obstacle.distance(p)).reduce(f64::min)
}

/// The obstacle in which all of a goal lies.
fn into(scene: &Scene, goal: &Goal) -> Option<String> {
    let places = match goal {
        Goal::Point(point) => vec![*point],
        Goal::Region(id) => places(&scene.regions[id.0 as usize].shape, ROWS),
    };
    let found: Vec<Option<String>> = places.iter().map(|p| inside(scene, *p)).collect();
    if found.iter().all(Option::is_some) { found.into_iter().next().flatten() } else { None }
}

/// A barrier that the straight way from a start to a goal meets; one with a name before others.
fn enclosing(scene: &Scene, from: &Place<'_>, radius: f64, goal: &Goal) -> Option<usize> {
    let start = *from.places(scene, 1).first()?;
    let end = match goal {
        Goal::Point(point) => *point,
        Goal::Region(id) => scene.regions.get(id.0 as usize)?.shape.inner_point(),
    };
    let meets = |k: &usize| {
        let alone = Scene { barriers: vec![scene.barriers[*k].clone()], ..Scene::default() };
        !Sight::new(&alone).is_clear(start, end, radius)
    };
    let met: Vec<usize> = (0..scene.barriers.len()).filter(meets).collect();
    let named = met.iter().find(|k| !scene.barriers[**k].name.is_empty());
    named.or(met.first()).copied()
}
