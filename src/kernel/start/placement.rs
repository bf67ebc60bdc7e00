//! Where everyone starts: points first, then at random without overlaps.

use super::arrival::Arrivals;
use super::crowd::Crowd;
use super::outcome::{Fault, Loaded, Overlapped, Shrunk};
use super::relaxation::{self, Room};
use super::sampler::Sampler;
use crate::base::geometry::Nearby;
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::{AgentId, Barrier, BarrierId, Obstacle, Position, Scenario, Scene};

/// How often a free place is sought by chance.
pub(super) const ATTEMPTS: u32 = 96;

/// A radius shrunk to touch is this much smaller, so that rounding leaves no overlap.
const TOUCH: f64 = 1.0 - 8.0 * f64::EPSILON;

/// Nearer than this two points are one, m: far above rounding, far below what anyone sees.
const ONE_POINT: f64 = 1e-6;

/// The barriers that have pieces: which they are, their bounds, and which may be near.
#[derive(Clone, Debug, Default)]
struct Barriers {
    list: Vec<(u32, Bounds)>,
    nearby: Nearby,
    /// On a closed plane all barriers with their images.
    unrolled: Vec<Barrier>,
}

impl Barriers {
    fn new(scene: &Scene) -> Self {
        let with_pieces = |(k, barrier): (usize, &Barrier)| Some((k as u32, barrier.obstacle.bounds()?));
        let all = scene.unrolled();
        let list: Vec<(u32, Bounds)> = all.iter().enumerate().filter_map(with_pieces).collect();
        let bounds: Vec<Bounds> = list.iter().map(|(_, bounds)| *bounds).collect();
        let unrolled = if scene.periods.are_none() { Vec::new() } else { all.into_owned() };
        Self { list, nearby: Nearby::new(&bounds), unrolled }
    }
}

/// What all trials share: the samplers of the shapes and the bounds of the barriers.
#[derive(Clone, Debug, Default)]
pub struct Starts {
    samplers: Vec<Sampler>,
    /// Which sampler an agent uses.
    sampler_of: Vec<Option<u32>>,
    /// The order of placement.
    order: Vec<u32>,
    barriers: Barriers,
}

impl Starts {
    /// Prepares the placement of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let mut out = Self::default();
        let mut shapes: Vec<&Shape> = Vec::new();
        for agent in &scenario.agents {
            out.sampler_of.push(match &agent.start.position {
                Position::Within(shape) => {
                    // Members of one declaration are neighbours and share a shape: look at the last first.
                    let known = shapes.iter().rposition(|known| *known == shape);
                    let index = known.unwrap_or_else(|| {
                        shapes.push(shape);
                        out.samplers.push(Sampler::new(shape));
                        shapes.len() - 1
                    });
                    Some(index as u32)
                }
                Position::Point(_) | Position::Near { .. } => None,
            });
        }
        let arrivals = Arrivals::new(scenario);
        let fixed = |k: &u32| matches!(scenario.agents[*k as usize].start.position, Position::Point(_));
        // Who comes in later is placed then.
        let all = (0..scenario.agents.len() as u32).filter(|&k| !arrivals.comes(k as usize));
        out.order = all.clone().filter(fixed).chain(all.filter(|k| !fixed(k))).collect();
        out.barriers = Barriers::new(&scenario.scene);
        out
    }
}

impl Starts {
    /// The sampler of the shape in which an agent starts.
    pub(super) fn sampler(&self, agent: usize) -> Option<&Sampler> {
        let index = self.sampler_of.get(agent).copied().flatten()?;
        self.samplers.get(index as usize)
    }
}

/// Walls and obstacles near a body.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    scene: &'a Scene,
    barriers: &'a Barriers,
}

impl<'a> Ground<'a> {
    /// The barriers of a scene.
    pub(super) fn of(scene: &'a Scene, starts: &'a Starts) -> Self {
        Self { scene, barriers: &starts.barriers }
    }

    /// The barriers whose bounds are within `reach` of a point.
    pub(super) fn near(self, p: Vec2, reach: f64) -> impl Iterator<Item = &'a Obstacle> {
        self.barriers_near(p, reach).map(move |barrier| self.obstacle(barrier))
    }

    fn obstacle(self, barrier: u32) -> &'a Obstacle {
        let unrolled = &self.barriers.unrolled;
        let all = if unrolled.is_empty() { &self.scene.barriers } else { unrolled };
        &all[barrier as usize].obstacle
    }

    /// The same by their numbers; those of images come after all others.
    fn barriers_near(self, p: Vec2, reach: f64) -> impl Iterator<Item = u32> {
        let close = move |b: &Bounds| {
            p.x > b.low.x - reach && p.x < b.high.x + reach && p.y > b.low.y - reach && p.y < b.high.y + reach
        };
        let candidates = self.barriers.nearby.within(p, reach);
        (0..candidates.len())
            .map(move |k| &self.barriers.list[candidates[k] as usize])
            .filter(move |(_, bounds)| close(bounds))
            .map(|(barrier, _)| *barrier)
    }

    /// The barrier nearest to a point among those within reach, and its distance.
    fn nearest(self, p: Vec2, reach: f64) -> Option<(BarrierId, f64)> {
        self.barriers_near(p, reach)
            .map(|k| (BarrierId(k % self.scene.barriers.len() as u32), self.obstacle(k).distance(p)))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// Smallest gap between a disc and the barriers within its reach; infinite without any.
    fn gap(self, p: Vec2, radius: f64) -> f64 {
        self.near(p, radius).map(|o| o.distance(p) - radius).fold(f64::INFINITY, f64::min)
    }
}

/// Everyone placed.
pub(super) struct Placed {
    pub(super) positions: Vec<Vec2>,
    /// Radii, shrunk where bodies overlapped.
    pub(super) radii: Vec<f64>,
    pub(super) counts: Loaded,
}

/// Places all agents of a trial.
pub(super) fn place(
    scenario: &Scenario,
    starts: &Starts,
    key: TrialKey,
    radii: Vec<f64>,
) -> Result<Placed, Fault> {
    let ground = Ground::of(&scenario.scene, starts);
    let mut crowd = Crowd::new(radii, scenario.scene.periods);
    let mut rooms = vec![Room::Fixed; scenario.agents.len()];
    let mut counts = Loaded::default();
    let mut done = vec![false; scenario.agents.len()];
    for &k in &starts.order {
        let k = k as usize;
        let agent = &scenario.agents[k];
        let id = AgentId(k as u32);
        let around;
        let sampler = match &agent.start.position {
            Position::Point(p) => {
                if !(p.x.is_finite() && p.y.is_finite()) {
                    return Err(Fault::Nowhere { agent: id });
                }
                crowd.put(k, *p);
                done[k] = true;
                continue;
            }
            Position::Within(shape) => {
                rooms[k] = Room::Within(shape);
                starts.sampler(k)
            }
            Position::Near { agent: anchor, within } => {
                let anchor = anchor.0 as usize;
                if !done.get(anchor).copied().unwrap_or(false) {
                    return Err(Fault::Order { agent: id });
                }
                rooms[k] = Room::Near { anchor, within: *within };
                around = Sampler::Disc { centre: crowd.positions[anchor], radius: *within };
                Some(&around)
            }
        };
        let sampler = sampler.ok_or(Fault::Nowhere { agent: id })?;
        let stream = Stream::of(key, agent.entity, Purpose::Placement);
        let mut best: Option<(f64, Vec2)> = None;
        for attempt in 0..ATTEMPTS {
            let Some(p) = sampler.point(stream.uniform_pair(attempt)) else { break };
            let radius = crowd.radii[k];
            let gap = crowd.gap(k, p).min(ground.gap(p, radius));
            if best.is_none_or(|(so_far, _)| gap > so_far) {
                best = Some((gap, p));
            }
            if gap >= 0.0 {
                break;
            }
        }
        let Some((gap, p)) = best else { return Err(Fault::Nowhere { agent: id }) };
        counts.pushed += u32::from(gap < 0.0);
        crowd.put(k, p);
        done[k] = true;
    }
    if counts.pushed > 0 {
        relaxation::relax(&mut crowd, &rooms, ground);
        let is_left = |body: &usize| rooms[*body].is_left(&crowd, crowd.positions[*body]);
        if let Some(body) = (0..rooms.len()).find(is_left) {
            return Err(Fault::Far { agent: AgentId(body as u32) });
        }
    }
    shrink(&mut crowd, ground, &done, &mut counts)?;
    Ok(Placed { positions: crowd.positions, radii: crowd.radii, counts })
}

/// Shrinks the radii of bodies that overlap a neighbour or a barrier until they touch. Nothing helps two at one
/// point, or somebody whose middle is in an obstacle or on a wall.
fn shrink(crowd: &mut Crowd, ground: Ground<'_>, placed: &[bool], counts: &mut Loaded) -> Result<(), Fault> {
    let mut near: Vec<u32> = Vec::new();
    for body in (0..crowd.positions.len()).filter(|&body| placed[body]) {
        let p = crowd.positions[body];
        near.clear();
        crowd.around(body, p, |other| near.push(other as u32));
        near.sort_unstable();
        for other in near.iter().map(|&other| other as usize).filter(|&other| other > body) {
            let (distance, sum) = (crowd.way_from(other, p).norm(), crowd.radii[body] + crowd.radii[other]);
            if distance <= ONE_POINT {
                return Err(Fault::Together { agents: (AgentId(body as u32), AgentId(other as u32)) });
            }
            if distance < sum {
                for (one, met) in [(body, other), (other, body)] {
                    let at = Overlapped::Agent(AgentId(met as u32));
                    let to = crowd.radii[one] * (distance / sum * TOUCH);
                    counts.shrunk.push(made_smaller(crowd, one, at, to));
                }
            }
        }
        let radius = crowd.radii[body];
        let Some((barrier, room)) = ground.nearest(p, radius) else { continue };
        if room <= ONE_POINT {
            return Err(Fault::Inside { agent: AgentId(body as u32) });
        }
        if room < radius {
            counts.shrunk.push(made_smaller(crowd, body, Overlapped::Barrier(barrier), room * TOUCH));
        }
    }
    Ok(())
}

/// Gives a body a smaller radius.
fn made_smaller(crowd: &mut Crowd, body: usize, at: Overlapped, to: f64) -> Shrunk {
    let from = std::mem::replace(&mut crowd.radii[body], to);
    Shrunk { agent: AgentId(body as u32), at, from, to }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::geometry::Segment;

    #[test]
    fn among_many_barriers_those_near_are_found_in_order_as_in_a_look_at_each() {
        let wall = |k: u32| {
            let at = Vec2::new(f64::from(k * 7919 % 997) * 0.11, f64::from(k * 104_729 % 1009) * 0.07);
            // Some have no pieces, one crosses the scene.
            let to = if k == 7 { Vec2::new(90.0, 50.0) } else { Vec2::new(f64::from(k % 5), 0.3) };
            let pieces = if k % 11 == 3 { Vec::new() } else { vec![Segment::new(at, at + to)] };
            Barrier { name: String::new(), obstacle: Obstacle::Wall(pieces) }
        };
        for count in [3, 40, 2_000] {
            let scene =
                Scene { barriers: (0..count).map(wall).collect(), regions: Vec::new(), ..Scene::default() };
            let barriers = Barriers::new(&scene);
            let ground = Ground { scene: &scene, barriers: &barriers };
            let (mut looked_at, mut near_some) = (0, 0);
            for k in 0..600 {
                let p = Vec2::new(f64::from(k % 30) * 4.1 - 5.0, f64::from(k / 30) * 4.3 - 4.0);
                let reach = f64::from(k % 7) * 0.2;
                let found: Vec<&Obstacle> = ground.near(p, reach).collect();
                let each = scene.barriers.iter().map(|barrier| &barrier.obstacle);
                let wanted: Vec<&Obstacle> = each
                    .filter(|obstacle| {
                        obstacle.bounds().is_some_and(|b| {
                            p.x > b.low.x - reach
                                && p.x < b.high.x + reach
                                && p.y > b.low.y - reach
                                && p.y < b.high.y + reach
                        })
                    })
                    .collect();
                assert!(found.iter().zip(&wanted).all(|(a, b)| std::ptr::eq(*a, *b)), "{p} {reach}");
                assert_eq!(found.len(), wanted.len());
                near_some += usize::from(!found.is_empty());
                looked_at += barriers.nearby.within(p, reach).len();
            }
            assert!(count < 40 || near_some > 100);
            assert!(count < 2_000 || looked_at < 600 * count as usize / 20, "{looked_at}");
        }
    }
}
