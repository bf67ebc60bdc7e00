//! What stands still in a scene, as JSON in whole millimetres. A piece of a wall is `[x, y, x, y]`; a list of points has x
//! and y in turn.

use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::base::tick::Clock;
use crate::model::{Goal, Group, Island, Leg, Move, Moves, Region, Route, Scenario, Scene};
use serde_json::{Value, json};

/// The middles of the goals of a route.
fn goals(scene: &Scene, route: &Route) -> Vec<Vec2> {
    let Route::Legs { legs, .. } = route else { return Vec::new() };
    let goal = |leg: &Leg| match leg {
        Leg::To(Goal::Point(point)) => Some(*point),
        Leg::To(Goal::Region(id)) => Some(scene.regions[id.0 as usize].shape.inner_point()),
        _ => None,
    };
    legs.iter().filter_map(goal).collect()
}

/// The moves of an agent that a ranking compares: how long a heading holds, s, the goals of each route, and each heading.
/// A heading is left of the direction to a goal by an angle, rad.
fn options(scenario: &Scenario, moves: &Moves) -> Value {
    let route = |(label, option): &(String, Move)| match option {
        Move::Route(number) => {
            let goals = goals(&scenario.scene, moves.routes.get(*number)?);
            Some(json!({ "label": label, "points": goals.into_iter().flat_map(place).collect::<Vec<_>>() }))
        }
        _ => None,
    };
    let own = scenario.agents.get(moves.agent.0 as usize);
    let toward = own.and_then(|agent| goals(&scenario.scene, &agent.route).first().copied());
    let heading = |(label, option): &(String, Move)| match option {
        Move::Heading(turn) => Some(json!({ "label": label, "toward": place(toward?), "turn": turn })),
        _ => None,
    };
    json!({
        "agent": moves.agent.0,
        "seconds": scenario.clock.seconds(moves.duration),
        "routes": moves.options.iter().filter_map(route).collect::<Vec<_>>(),
        "headings": moves.options.iter().filter_map(heading).collect::<Vec<_>>(),
    })
}

fn millimetres(length: f64) -> i64 {
    (length * 1000.0).round() as i64
}

fn place(at: Vec2) -> [i64; 2] {
    [millimetres(at.x), millimetres(at.y)]
}

/// A circle `[x, y, radius]`, or rings of points, the first around the others, which are holes.
fn outline(shape: &Shape) -> Value {
    match shape {
        Shape::Circle { centre, radius } => {
            let [x, y] = place(*centre);
            json!({ "circle": [x, y, millimetres(*radius)] })
        }
        Shape::Polygon(polygon) => {
            let rings = std::iter::once(&polygon.outline).chain(&polygon.holes);
            let ring = |ring: &Vec<Vec2>| ring.iter().flat_map(|at| place(*at)).collect();
            json!({ "rings": rings.map(ring).collect::<Vec<Vec<i64>>>() })
        }
        Shape::Parts(_) => json!({ "rings": [] }),
    }
}

/// A scene, the groups of its agents, their moves and their number.
pub(super) fn scene(scenario: &Scenario) -> Value {
    let scene = &scenario.scene;
    let wall = |wall: &Segment| [place(wall.a), place(wall.b)].concat();
    let region = |one: &Region| {
        let part = |part: &Shape| json!({ "name": one.label(), "shape": outline(part) });
        one.shape.parts().iter().map(part).collect::<Vec<_>>()
    };
    let point = |(name, at): &(String, Vec2)| json!({ "name": name, "at": place(*at) });
    let group = |one: &Group| {
        let members: Vec<u32> = one.members.iter().map(|id| id.0).collect();
        json!({ "name": one.name, "members": members })
    };
    let island = |one: &Island| {
        let Bounds { low, high } = one.bounds;
        let corners = [place(low), place(high)].concat();
        json!({ "name": one.name, "box": corners })
    };
    json!({
        "islands": scene.storeys.islands.iter().map(island).collect::<Vec<_>>(),
        "unit": if scenario.clock == Clock::Steps { "steps" } else { "s" },
        "walls": scene.with_closed(0).walls().map(wall).collect::<Vec<_>>(),
        "solids": scene.solids().map(outline).collect::<Vec<_>>(),
        "regions": scene.shown_regions().flat_map(region).collect::<Vec<_>>(),
        "points": scene.points.iter().map(point).collect::<Vec<_>>(),
        "groups": scenario.groups.iter().map(group).collect::<Vec<_>>(),
        "options": scenario.moves.iter().map(|moves| options(scenario, moves)).collect::<Vec<_>>(),
        "agents": scenario.agents.len(),
    })
}
