//! Starts that no trial can make, whatever is drawn: in an obstacle, on a wall, at one point with somebody else,
//! or where the smallest bodies that can be drawn find no room.
//!
//! What overlaps only in part is no error: radii shrink until the bodies touch, and the report names them. A given
//! point is refused where a barrier would leave less than half of the radius.

use crate::base::geometry::{Bounds, Shape, Vec2, rotated};
use crate::compile::context::{Context, people::People, roster, symbols::Meaning};
use crate::compile::scene::imports;
use crate::model::{Agent, AgentId, Barrier, Obstacle, Parameter, Position};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// Nearer than this two points are one, m: far above rounding, far below what anyone sees.
const ONE_POINT: f64 = 1e-6;

/// Share of its radius that a body keeps at least beside a barrier where its start is given.
const LEAST_LEFT: f64 = 0.5;

/// Most barriers that are left one after the other on the way to a free place.
const MOST_MOVES: u32 = 64;

/// Discs that are thrown and pushed jam at about this share of an area.
const JAMMED: f64 = 0.84;

/// Square cells of the grid on which a free place is sought, about.
const CELLS: f64 = 10_000.0;

/// A barrier and the rectangle around it.
pub(crate) type Solid<'b> = (&'b Barrier, Bounds);

/// The barriers of a scene with their rectangles.
pub(crate) fn solids(barriers: &[Barrier]) -> Vec<Solid<'_>> {
    barriers.iter().filter_map(|barrier| Some((barrier, barrier.obstacle.bounds()?))).collect()
}

/// The barrier nearest to a point among those that may be nearer than `reach`, and its distance.
fn nearest<'b>(barriers: &[Solid<'b>], p: Vec2, reach: f64) -> Option<(&'b Barrier, f64)> {
    let mut best: Option<(&Barrier, f64)> = None;
    for (barrier, bounds) in barriers {
        let outside = p.x < bounds.low.x - reach
            || p.x > bounds.high.x + reach
            || p.y < bounds.low.y - reach
            || p.y > bounds.high.y + reach;
        if outside {
            continue;
        }
        let distance = barrier.obstacle.distance(p);
        if distance <= reach && best.is_none_or(|(_, least)| distance < least) {
            best = Some((barrier, distance));
        }
    }
    best
}

/// A barrier that leaves a disc at a point less of its radius than a given start may lose, and its distance.
pub(crate) fn in_the_way<'b>(barriers: &[Solid<'b>], p: Vec2, radius: f64) -> Option<(&'b Barrier, f64)> {
    let reach = LEAST_LEFT * radius;
    nearest(barriers, p, if reach > ONE_POINT { reach } else { ONE_POINT })
}

/// A point near another one at which a disc touches no barrier: out of each barrier that is in the way the shortest way.
pub(crate) fn beside(barriers: &[Solid<'_>], from: Vec2, radius: f64) -> Option<Vec2> {
    let mut p = from;
    for _ in 0..MOST_MOVES {
        let Some((barrier, distance)) = nearest(barriers, p, radius) else { return Some(p) };
        let surface = barrier.obstacle.nearest_on_surface(p);
        let mut out = if distance < 0.0 { surface - p } else { p - surface };
        if out.norm() <= ONE_POINT {
            // On the rim: the direction in which it is left behind soonest.
            let turned = |k: i32| rotated(Vec2::new(1.0, 0.0), f64::from(k) * std::f64::consts::TAU / 16.0);
            let left = |way: &Vec2| barrier.obstacle.distance(surface + way * radius);
            out = (0..16).map(turned).max_by(|a, b| left(a).total_cmp(&left(b)))?;
        }
        p = surface + out * ((radius + ONE_POINT) / out.norm());
    }
    None
}

/// Places around a point at which a disc touches one at the point, or nearly, and no barrier is in the way.
fn around<'b>(barriers: &'b [Solid<'_>], p: Vec2, radius: f64) -> impl Iterator<Item = Vec2> + 'b {
    let turned = move |k: i32| {
        let apart = 2.0 * radius / f64::from(1 + k / 16);
        rotated(Vec2::new(apart, 0.0), f64::from(k) * std::f64::consts::TAU / 16.0)
    };
    let is_clear = move |way: &Vec2| {
        [0.5, 0.75, 1.0].into_iter().all(|share| in_the_way(barriers, p + way * share, radius).is_none())
    };
    (0..64).map(turned).filter(is_clear).map(move |way| p + way)
}

/// A point up to [`ONE_POINT`].
fn point_key(p: Vec2) -> (i64, i64) {
    ((p.x / ONE_POINT).round() as i64, (p.y / ONE_POINT).round() as i64)
}

/// The smallest radius that a trial can give an agent, m.
fn least_radius(agent: &Agent) -> f64 {
    let drawn = agent.body[Parameter::Radius].bounds().0;
    agent.particle.map_or(drawn, |particle| particle.radius(drawn))
}

/// Whether some point of a shape may be as far as `radius` from all barriers. Only a sure no is a no.
fn has_room(shape: &Shape, radius: f64, barriers: &[Solid<'_>]) -> bool {
    let bounds = shape.bounds();
    let size = bounds.high - bounds.low;
    let side = (size.x * size.y / CELLS).sqrt();
    let counts = size / side;
    // Shapes so long and thin that cells are no squares are left to chance.
    if !(side > 0.0 && counts.x < CELLS && counts.y < CELLS) {
        return true;
    }
    let (columns, rows) = (counts.x.ceil() as u32, counts.y.ceil() as u32);
    let half = 0.5 * side * std::f64::consts::SQRT_2;
    for row in 0..rows {
        for column in 0..columns {
            let p = bounds.low + Vec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) * side;
            if shape.distance(p) > half {
                continue;
            }
            let clear = nearest(barriers, p, radius).is_none_or(|(_, distance)| distance + half >= radius);
            if clear {
                return true;
            }
        }
    }
    false
}

/// Moves apart the people who were seen at one place, or were moved to it.
fn part(context: &mut Context<'_>, people: &mut People, barriers: &[Solid<'_>]) {
    let is_seen = |agent: &Agent| !agent.start.seen.is_empty();
    let (seen, given): (Vec<usize>, Vec<usize>) =
        (0..people.agents.len()).partition(|k| is_seen(&people.agents[*k]));
    let mut taken: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    for k in given.into_iter().filter(|k| !people.coming.contains(&AgentId(*k as u32))).chain(seen) {
        let Position::Point(p) = people.agents[k].start.position else { continue };
        let Some(first) = taken.get(&point_key(p)).copied().filter(|_| is_seen(&people.agents[k])) else {
            taken.insert(point_key(p), k);
            continue;
        };
        let radius = least_radius(&people.agents[k]);
        // Without a place the start is refused.
        let free = |q: &Vec2| !taken.contains_key(&point_key(*q));
        let Some(q) = around(barriers, p, radius).find(free) else { continue };
        taken.insert(point_key(q), k);
        people.agents[k].start.position = Position::Point(q);
        let Some(span) = roster::written(&people.places, AgentId(k as u32)) else { continue };
        let (name, other) = (&people.agents[k].name, &people.agents[first].name);
        let by = (q - p).norm();
        let said = format!("`{name}` was at the place of `{other}` and starts {by:.3} m beside it");
        let title = "persons were seen at one place, or moved to it, and start side by side";
        context.note(Diagnostic::warning(Code::W0701, span, title).related(span, said));
    }
}

/// Refuses the starts that no trial can make.
pub(crate) fn check_places(context: &mut Context<'_>, people: &mut People) {
    let scene = context.scene.clone();
    let unrolled = scene.unrolled();
    let barriers = solids(&unrolled);
    part(context, people, &barriers);
    let people = &*people;
    let mut points: BTreeMap<(i64, i64), AgentId> = BTreeMap::new();
    let mut near: BTreeMap<AgentId, Vec<(AgentId, f64)>> = BTreeMap::new();
    // The last declaration about which something was said.
    let mut said = None;
    for (k, agent) in people.agents.iter().enumerate() {
        let id = AgentId(k as u32);
        let Some(span) = roster::written(&people.places, id) else { continue };
        if said == Some(span) {
            continue;
        }
        let comes = people.coming.contains(&id);
        let wrong = match &agent.start.position {
            Position::Point(p) => {
                let first = if comes { id } else { *points.entry(point_key(*p)).or_insert(id) };
                beside_barriers(context, agent, *p, comes, &barriers, span).or_else(|| {
                    let other = &people.agents[first.0 as usize];
                    (first != id && other.name != agent.name)
                        .then(|| together(other, agent, roster::written(&people.places, first), span))
                })
            }
            // All of a declaration start alike.
            Position::Within(_) | Position::Near { .. } if id != first_of(&people.places, id) => None,
            Position::Within(shape) => without_room(agent, shape, &barriers, span).map(|error| {
                match imports::walkable_hint(context, shape.inner_point()) {
                    Some(hint) => error.hint(hint),
                    None => error,
                }
            }),
            Position::Near { agent: anchor, within } => {
                let other = &people.agents[anchor.0 as usize];
                too_near(agent, other, *within, span).or_else(|| match other.start.position {
                    Position::Point(centre) => {
                        let disc = Shape::Circle { centre, radius: *within };
                        without_room(agent, &disc, &barriers, span)
                    }
                    _ => None,
                })
            }
        };
        if let Position::Near { agent: anchor, within } = agent.start.position
            && !comes
        {
            near.entry(anchor).or_default().push((id, within));
        }
        if let Some(error) = wrong {
            context.note(error);
            said = Some(span);
        }
    }
    for (anchor, members) in near {
        crowded_around(context, people, anchor, &members);
    }
}

/// In an obstacle, on a wall, so near one that little is left of the body, or, where nothing may be touched, beside one.
fn beside_barriers(
    context: &Context<'_>,
    agent: &Agent,
    p: Vec2,
    comes: bool,
    barriers: &[Solid<'_>],
    span: Span,
) -> Option<Diagnostic> {
    let (name, radius) = (&agent.name, least_radius(agent));
    let found = if comes { nearest(barriers, p, radius) } else { in_the_way(barriers, p, radius) };
    let (barrier, distance) = found?;
    let (place, what) = match barrier.obstacle {
        Obstacle::Wall(_) => ("on", "wall"),
        Obstacle::Solid(_) if distance < 0.0 => ("inside", "obstacle"),
        Obstacle::Solid(_) => ("on the rim of", "obstacle"),
    };
    let called = barrier.phrase();
    let error = if distance <= ONE_POINT {
        let hint =
            imports::walkable_hint(context, p).unwrap_or_else(|| "move the start or the barrier".into());
        error!(E0409, span, "`{name}` starts {place} {called}"; hint: "{hint}")
    } else if comes && distance < radius {
        let text = format!(
            "agents of `{name}` have no room to arrive here: {called} is {distance:.3} m away, and their radius is at least {radius:.3} m"
        );
        error!(E0801, span, "{text}";
                hint: "agents of a source arrive where they touch nothing; move the place or the barrier")
    } else if !comes && distance < LEAST_LEFT * radius {
        let text = format!(
            "`{name}` starts {distance:.3} m from {called}, which leaves less than half of its radius ({radius:.3} m)"
        );
        let hint =
            format!("move the start at least {radius:.3} m away from the {what}, or set a smaller radius");
        error!(E0409, span, "{text}"; hint: "{hint}")
    } else {
        return None;
    };
    let declared = context.names.scopes[0].get(&barrier.name);
    Some(match declared {
        Some(entry) if matches!(entry.meaning, Meaning::Barrier(_)) => {
            error.related(entry.span, "declared here")
        }
        _ => error,
    })
}

/// More agents around an anchor than fit.
fn crowded_around(context: &mut Context<'_>, people: &People, anchor: AgentId, members: &[(AgentId, f64)]) {
    let centre = &people.agents[anchor.0 as usize];
    let mut distances: Vec<f64> = members.iter().map(|(_, within)| *within).collect();
    distances.sort_by(f64::total_cmp);
    distances.dedup();
    for within in distances {
        let mut squares = least_radius(centre) * least_radius(centre);
        let (mut widest, mut count, mut last) = (0.0, 0usize, None);
        for (id, _) in members.iter().filter(|(_, reach)| *reach <= within) {
            let radius = least_radius(&people.agents[id.0 as usize]);
            squares += radius * radius;
            widest = if radius > widest { radius } else { widest };
            count += 1;
            last = Some(*id);
        }
        let room = JAMMED * (within + widest) * (within + widest);
        let Some(span) = last.and_then(|id| roster::written(&people.places, id)) else { continue };
        // One alone was looked at already.
        if squares > room && count > 1 {
            let text = format!(
                "{count} agents cannot start within {within} m of `{}`: they need at least {:.1} m^2, and {:.1} m^2 are available",
                centre.name,
                std::f64::consts::PI * squares,
                std::f64::consts::PI * room
            );
            context.note(error!(E0801, span, "{text}";
                        hint: "use fewer agents, a larger distance, or smaller radii"));
            return;
        }
    }
}

/// Two at one point.
fn together(first: &Agent, second: &Agent, other: Option<Span>, span: Span) -> Diagnostic {
    let text = format!("`{}` and `{}` start at the same point", first.name, second.name);
    let error = error!(E0409, span, "{text}");
    match other {
        Some(other) if other != span => error
            .related(other, "first used here")
            .hint("radii of overlapping bodies are reduced until they touch, which is impossible at one point; move one of them"),
        _ => error.hint("give each agent its own place, or draw the places: `at = uniform in …`"),
    }
}

/// A shape that barriers fill.
fn without_room(agent: &Agent, shape: &Shape, barriers: &[Solid<'_>], span: Span) -> Option<Diagnostic> {
    let radius = least_radius(agent);
    if barriers.is_empty() || has_room(shape, radius, barriers) {
        return None;
    }
    let text = format!(
        "`{}` has no free place here: walls and obstacles leave no room for a radius of {radius:.3} m or more",
        agent.name
    );
    Some(error!(E0801, span, "{text}"; hint: "use a larger shape or smaller radii"))
}

/// Two bodies that are larger than the distance at which they are to be.
fn too_near(agent: &Agent, anchor: &Agent, within: f64, span: Span) -> Option<Diagnostic> {
    let sum = least_radius(agent) + least_radius(anchor);
    if sum <= within {
        return None;
    }
    let text = format!(
        "`{}` cannot start within {within} m of `{}`: their bodies touch at {sum:.3} m or more",
        agent.name, anchor.name
    );
    Some(error!(E0801, span, "{text}"; hint: "the distance is between the centers; write a larger one"))
}

/// The first of the people of a declaration.
fn first_of(places: &[(AgentId, Span)], agent: AgentId) -> AgentId {
    let after = places.partition_point(|(first, _)| *first <= agent);
    after.checked_sub(1).and_then(|at| places.get(at)).map_or(agent, |(first, _)| *first)
}
