//! The barriers of a scene as the forces see them: which faces may be near, and which of them push.
//!
//! Each straight piece of a wall and each edge of a polygon is a face and pushes from its nearest point
//! (Given-Wilson et al. 2017, equations (5) and (6), with `d_ib` the distance from the centre of the body), a disc as
//! a whole. So in the corner of a room both of its faces push, however the room is drawn. Three rules say what holds
//! where pieces meet.
//!
//! 1. An edge of a polygon is felt on its outer side only. Whoever got into a polygon is pushed to the nearest point of
//!    its rim instead.
//! 2. Where the nearest point of a face is an end that lies on another face, which is nearer, the face fades out behind
//!    that end; where that is the nearest point of both, the one fades out that is farther behind its end. It gives
//!    nothing where both lie in one line and the other one is nearer (or as near and declared before), and where its
//!    nearest point lies in another solid or on the back of one. So a straight wall in pieces is one wall, a corner outside counts once, and an end that another barrier hides
//!    is not felt. The nearest of all is always felt.
//! 3. Faces of one structure (those of one wall, or of walls and obstacles that touch) share where they push in similar
//!    directions (`sharing`). So in a right angle both push in full, a ledge or the two sides of a wall drawn as its
//!    outline push about as one wall, and a round room drawn in short pieces is not twice as hard where two of them are
//!    in front.
//!
//! Barriers that do not touch push each for itself: the sum over walls of the paper.

mod face;
mod joints;
mod screen;
mod sharing;
#[cfg(test)]
mod tests;
mod tiles;

use super::Forces;
use super::pair::AgentsInLanes;
use super::social::{REACH, decay_to};
use crate::base::geometry::Nearby;
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::base::lanes::{Lanes, Mask};
use crate::kernel::barrier::Surface;
use crate::kernel::edges::squared_distance;
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, Truths, larger, smaller};
use crate::model::{Barrier, Obstacle, Parameter};
use face::{
    Form, Nearest, NearestTo, Screen, Side, meets_disc, nearest_of_whole, nearest_of_whole_to, sides_of,
};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
pub(in crate::kernel) use screen::hidden_by_doors;
use sharing::{Push, share};
use std::f64::consts::LOG2_E;
use std::sync::Arc;
pub(in crate::kernel) use tiles::Tiles;

/// Powers of two below this are not felt: of a social force, and of a turn, which is felt as far as it changes a double.
const LEAST: f64 = -REACH * LOG2_E;
const LEAST_TURN: f64 = -52.0;

/// A point this close to a barrier lies on it, m: nobody slips through, whatever is drawn so.
const ON: f64 = 1e-3;

/// Where a face meets another one.
#[derive(Clone, Debug, PartialEq)]
struct Joint {
    /// The other one.
    other: u32,
    /// A rectangle around all points of the face that lie on or in the other one.
    around: Bounds,
    /// Whether both are straight and lie in one line.
    in_line: bool,
}

/// What pushes.
#[derive(Clone, Debug)]
struct Face {
    form: Form,
    /// The barrier that it belongs to.
    barrier: u32,
    bounds: Bounds,
    /// What it hides others behind.
    screen: Option<Screen>,
    /// Where it meets others, in their order.
    joints: Vec<Joint>,
    /// The first of the faces that it hangs together with; `None` if there is no other.
    structure: Option<u32>,
}

/// The faces of the barriers of a scene, in their order; those without a piece have none.
#[derive(Clone, Debug)]
pub(in crate::kernel) struct Surfaces {
    wholes: Vec<Surface>,
    faces: Vec<Face>,
    /// Which faces may be near.
    pub(in crate::kernel) nearby: Nearby,
    /// Tells them from others: what was worked out from them holds for their copies alone.
    mark: Arc<()>,
}

/// Bodies as walls push them.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct AtWalls<S: Simd> {
    /// Places, m.
    place: (Doubles<S>, Doubles<S>),
    /// Radius, m.
    r: Doubles<S>,
    /// Strength A, N, and log2(e)/B, 1/m, of the social force; the same numbers of the collision-free speed model.
    a: Doubles<S>,
    rate: Doubles<S>,
    /// Powers of two below this are not felt.
    least: Doubles<S>,
}

impl<S: Simd> AtWalls<S> {
    /// Of agents at a place with a radius.
    #[inline(always)]
    pub(in crate::kernel) fn new(
        part: Part<S>,
        place: (Doubles<S>, Doubles<S>),
        r: Doubles<S>,
        forces: &Forces,
        state: &State,
        agents: impl AgentsInLanes<S>,
    ) -> Self {
        let rate = match forces.shared {
            Some((b, _)) => part.c(LOG2_E / b),
            None => part.c(LOG2_E) / agents.field(&state.bodies[Parameter::B]),
        };
        let a = agents.field(&state.bodies[Parameter::A]) * agents.field(&state.bodies[Parameter::Walls]);
        let least = part.c(LEAST);
        if forces.speeds.is_none() {
            return Self { place, r, a, rate, least };
        }
        let range = agents.field(&state.bodies[Parameter::WallRange]);
        let turns = range.simd_gt(part.c(0.0));
        Self {
            place,
            r,
            a: turns.select(agents.field(&state.bodies[Parameter::WallSwerve]), a),
            rate: turns.select(part.c(LOG2_E) / range, rate),
            least: turns.select(part.c(LEAST_TURN), least),
        }
    }
}

/// Room to work.
#[derive(Clone, Debug, Default)]
pub(in crate::kernel) struct Room {
    pushes: Vec<Push>,
}

impl Surfaces {
    /// Of a scene. A barrier that `is_open` has its faces, but these are far away.
    pub(in crate::kernel) fn new(barriers: &[Barrier], is_open: impl Fn(usize) -> bool) -> Self {
        let number = |(k, barrier)| Some(((k, barrier), Surface::new(barrier)?));
        let (barriers, wholes): (Vec<(usize, &Barrier)>, Vec<Surface>) =
            barriers.iter().enumerate().filter_map(number).unzip();
        let mut faces = Vec::new();
        for (k, &(number, barrier)) in barriers.iter().enumerate() {
            let is_open = is_open(number);
            let felt = |(form, bounds)| (if is_open { Form::FAR } else { form }, bounds);
            faces.extend(forms(barrier, &wholes[k]).into_iter().map(felt).map(|(form, bounds)| Face {
                screen: Screen::new(&form, &wholes[k]),
                form,
                barrier: k as u32,
                bounds,
                joints: Vec::new(),
                structure: None,
            }));
        }
        let nearby = Nearby::new(&faces.iter().map(|face| face.bounds).collect::<Vec<_>>());
        let mut meets = Vec::new();
        for k in 0..faces.len() {
            let (joints, mut others) = joints::of_face(&faces, &wholes, k, &nearby);
            faces[k].joints = joints;
            // What belongs to one barrier hangs together.
            others.extend((k > 0 && faces[k - 1].barrier == faces[k].barrier).then(|| k as u32 - 1));
            meets.push(others);
        }
        let structures = joints::structures(&meets);
        let mut sizes = vec![0; faces.len()];
        for &first in &structures {
            sizes[first as usize] += 1;
        }
        for (face, first) in faces.iter_mut().zip(structures) {
            face.structure = (sizes[first as usize] > 1).then_some(first);
        }
        Self { wholes, faces, nearby, mark: Arc::default() }
    }

    /// Whether there is none.
    pub(in crate::kernel) const fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// How many faces there are.
    pub(in crate::kernel) const fn len(&self) -> usize {
        self.faces.len()
    }

    /// Squared distance from eight places to the rectangle around a face.
    #[inline(always)]
    pub(in crate::kernel) fn squared_distance_to_bounds<S: Simd>(
        &self,
        face: u32,
        part: Part<S>,
        x: Doubles<S>,
        y: Doubles<S>,
    ) -> Doubles<S> {
        squared_distance(part, &self.faces[face as usize].bounds, x, y)
    }

    /// The nearest points of a face to eight places.
    #[inline(always)]
    pub(in crate::kernel) fn nearest<S: Simd>(
        &self,
        face: u32,
        part: Part<S>,
        (x, y): (Doubles<S>, Doubles<S>),
    ) -> Nearest<S> {
        let Face { form, barrier, .. } = &self.faces[face as usize];
        match form {
            Form::Side(side) => side.nearest(part, x, y),
            Form::Disc | Form::Inside => nearest_of_whole(&self.wholes[*barrier as usize], part, x, y),
        }
    }

    /// The nearest point of a face to one place.
    pub(in crate::kernel) fn nearest_to(&self, face: u32, p: Vec2) -> NearestTo {
        let Face { form, barrier, .. } = &self.faces[face as usize];
        match form {
            Form::Side(side) => side.nearest_to(p),
            Form::Disc | Form::Inside => nearest_of_whole_to(&self.wholes[*barrier as usize], p),
        }
    }

    /// Where a centre that went straight from one place to another stops: `ON` before the face that it met, or where it began
    /// if that is nearer; with the unit vector away from the face. `None` where it did not meet it from outside.
    pub(in crate::kernel) fn stop(&self, face: u32, from: Vec2, to: Vec2) -> Option<(Vec2, Vec2)> {
        let Face { form, barrier, .. } = &self.faces[face as usize];
        let (share, height, normal) = match form {
            Form::Side(side) => side.meets(from, to)?,
            Form::Disc => meets_disc(&self.wholes[*barrier as usize], from, to)?,
            // Its edges stop those who are outside.
            Form::Inside => return None,
        };
        let left = 1.0 - ON / height;
        Some((from + (to - from) * if left > 0.0 { share * left } else { 0.0 }, normal))
    }

    /// The social force of faces on eight bodies, N. Those that touch or may do so within a step are told to `may_touch`,
    /// if they are nearer than `margin`.
    #[inline(always)]
    pub(in crate::kernel) fn push<S: Simd>(
        &self,
        part: Part<S>,
        near: &[u32],
        bodies: &AtWalls<S>,
        margin: f64,
        room: &mut Room,
        mut may_touch: impl FnMut(u32, Truths<S>),
    ) -> (Doubles<S>, Doubles<S>) {
        let (mut fx, mut fy) = (part.c(0.0), part.c(0.0));
        room.pushes.clear();
        for &k in near {
            let nearest = self.nearest(k, part, bodies.place);
            let touching = (bodies.r - nearest.near).simd_gt(part.c(-margin));
            if touching.any_true() {
                may_touch(k, touching);
            }
            let mut power = (bodies.r - nearest.distance) * bodies.rate;
            if !power.simd_gt(bodies.least).any_true() {
                continue;
            }
            let Face { joints, structure, barrier, form, .. } = &self.faces[k as usize];
            if matches!(form, Form::Inside) {
                let inside = nearest.distance.simd_lt(part.c(f64::INFINITY));
                for push in room.pushes.iter_mut().filter(|push| push.barrier == *barrier) {
                    part.store_in(inside, part.c(0.0), &mut push.alone);
                    push.shared = push.alone;
                }
            }
            let mut alone = bodies.a * decay_to(part, power, bodies.least);
            if !joints.is_empty() {
                let left = self.left(k, part, bodies.place, &nearest);
                power = left.simd_gt(part.c(0.0)).select(power, part.c(f64::NEG_INFINITY));
                alone *= left;
            }
            let Some(structure) = *structure else {
                fx += alone * nearest.nx;
                fy += alone * nearest.ny;
                continue;
            };
            if power.simd_gt(bodies.least).any_true() {
                let mut push = Push { structure, barrier: *barrier, ..Push::default() };
                part.store(nearest.nx, &mut push.nx);
                part.store(nearest.ny, &mut push.ny);
                part.store(alone, &mut push.alone);
                push.shared = push.alone;
                room.pushes.push(push);
            }
        }
        if room.pushes.len() > 1 {
            share(part, &mut room.pushes);
        }
        for push in &room.pushes {
            let f = part.load(&push.shared);
            fx += f * part.load(&push.nx);
            fy += f * part.load(&push.ny);
        }
        (fx, fy)
    }

    /// Share of its force that a face gives at eight places, from its nearest points, where it is seen: less than 1 where
    /// its nearest point lies on another one (rule 2).
    #[inline(always)]
    fn left<S: Simd>(
        &self,
        index: u32,
        part: Part<S>,
        place: (Doubles<S>, Doubles<S>),
        nearest: &Nearest<S>,
    ) -> Doubles<S> {
        let foot = (place.0 - nearest.nx * nearest.near, place.1 - nearest.ny * nearest.near);
        let (on, zero) = (part.c(ON), part.c(0.0));
        let mut left = nearest.fades.select(nearest.fading, part.c(1.0));
        let unseen = nearest.distance.simd_eq(part.c(f64::INFINITY));
        // The barrier of the last other face, and where the foot lies on one of its faces that is seen.
        let (mut barrier, mut on_face) = (u32::MAX, part.mask(Mask::NONE));
        let Face { form, joints, .. } = &self.faces[index as usize];
        for Joint { other, around, in_line } in joints {
            let here = is_in(part, around, foot);
            if !here.any_true() {
                continue;
            }
            let other_face = &self.faces[*other as usize];
            if barrier != other_face.barrier {
                (barrier, on_face) = (other_face.barrier, part.mask(Mask::NONE));
            }
            let theirs = self.nearest(*other, part, place);
            if matches!(other_face.form, Form::Inside) {
                let open = on_face & theirs.near.simd_ge(zero);
                let nearer = here & !open & theirs.near.simd_lt(nearest.distance);
                if nearer.any_true() {
                    let hidden = nearer & self.nearest(*other, part, foot).near.simd_le(on);
                    left = hidden.select(zero, left);
                }
                continue;
            }
            let seen = here & theirs.distance.simd_lt(part.c(f64::INFINITY));
            if seen.any_true() {
                let here = seen & self.nearest(*other, part, foot).near.simd_le(on);
                on_face |= here;
                let one = part.c(1.0);
                let is_nearer = if *other < index {
                    theirs.distance.simd_le(nearest.distance)
                } else {
                    theirs.distance.simd_lt(nearest.distance)
                };
                let mut rest = is_nearer.select(zero, one);
                if fades_by(form, &other_face.form, *in_line) {
                    let dx = foot.0 - place.0 + theirs.nx * theirs.near;
                    let dy = foot.1 - place.1 + theirs.ny * theirs.near;
                    let is_same = (dx * dx + dy * dy).simd_le(on * on);
                    let by_end = one - larger::<S>(theirs.fading - nearest.fading, zero);
                    rest = is_same.select(by_end, is_nearer.select(nearest.fading, one));
                }
                left = here.select(smaller::<S>(rest, left), left);
            }
            if (left.simd_le(zero) | unseen).all_true() {
                break;
            }
        }
        left
    }

    /// How one body overlaps some faces, by the rules above: what they give is a depth, in lane 0. In their order.
    #[inline(always)]
    pub(in crate::kernel) fn touch<'a, S: Simd>(
        &self,
        part: Part<S>,
        faces: impl Iterator<Item = u32>,
        p: Vec2,
        radius: f64,
        room: &'a mut Room,
    ) -> &'a [Push] {
        if self.overlap(faces, p, radius, room) > 1 {
            share(part, &mut room.pushes);
        }
        &room.pushes
    }

    /// The same of each face alone. Gives how many the body overlaps.
    fn overlap(&self, faces: impl Iterator<Item = u32>, p: Vec2, radius: f64, room: &mut Room) -> usize {
        room.pushes.clear();
        for index in faces {
            let nearest = self.nearest_to(index, p);
            let depth = radius - nearest.distance;
            let alone =
                Lanes::splat(if depth > 0.0 { depth * self.left_at(index, p, &nearest) } else { 0.0 });
            let Face { barrier, structure, ref form, .. } = self.faces[index as usize];
            if matches!(form, Form::Inside) && nearest.distance < f64::INFINITY {
                for push in room.pushes.iter_mut().filter(|push| push.barrier == barrier) {
                    (push.alone, push.shared) = (Lanes::ZERO, Lanes::ZERO);
                }
            }
            room.pushes.push(Push {
                structure: structure.unwrap_or(index),
                barrier,
                nx: Lanes::splat(nearest.normal.x),
                ny: Lanes::splat(nearest.normal.y),
                alone,
                shared: alone,
                ..Push::default()
            });
        }
        room.pushes.iter().filter(|push| push.alone.0[0] > 0.0).count()
    }

    /// The same as `left` at one place.
    fn left_at(&self, index: u32, p: Vec2, nearest: &NearestTo) -> f64 {
        let NearestTo { normal, near, distance, fading, fades } = *nearest;
        let foot = p - normal * near;
        let mut left = if fades { fading } else { 1.0 };
        let (mut barrier, mut on_face) = (u32::MAX, false);
        let Face { form, joints, .. } = &self.faces[index as usize];
        for Joint { other, around, in_line } in joints {
            if !contains(around, foot) {
                continue;
            }
            let other_face = &self.faces[*other as usize];
            if barrier != other_face.barrier {
                (barrier, on_face) = (other_face.barrier, false);
            }
            let is_on = self.nearest_to(*other, foot).near <= ON;
            if !is_on {
                continue;
            }
            let theirs = self.nearest_to(*other, p);
            if matches!(other_face.form, Form::Inside) {
                let is_open = on_face && theirs.near >= 0.0;
                if !is_open && theirs.near < distance {
                    left = 0.0;
                }
            } else if theirs.distance < f64::INFINITY {
                on_face = true;
                let is_nearer = theirs.distance < distance || *other < index && theirs.distance == distance;
                let way = foot - p + theirs.normal * theirs.near;
                let rest = if !fades_by(form, &other_face.form, *in_line) {
                    if is_nearer { 0.0 } else { 1.0 }
                } else if way.dot(&way) <= ON * ON {
                    let less = theirs.fading - fading;
                    1.0 - if less > 0.0 { less } else { 0.0 }
                } else if is_nearer {
                    fading
                } else {
                    1.0
                };
                left = if rest < left { rest } else { left };
            }
        }
        left
    }
}

/// Whether a face fades out behind its end where that lies on another one, which is nearer, or where both end there and it is
/// farther behind; else it gives nothing there if the other one is nearer.
const fn fades_by(own: &Form, other: &Form, in_line: bool) -> bool {
    matches!((own, other), (Form::Side(_), Form::Side(_))) && !in_line
}

/// The faces of a barrier, and a rectangle around each.
fn forms(barrier: &Barrier, surface: &Surface) -> Vec<(Form, Bounds)> {
    let sides: Vec<Side> = match &barrier.obstacle {
        Obstacle::Wall(_) => surface.edges().map(Side::of_wall).collect(),
        Obstacle::Solid(Shape::Polygon(polygon)) => sides_of(polygon),
        Obstacle::Solid(Shape::Circle { .. } | Shape::Parts(_)) => Vec::new(),
    };
    let sides = sides.into_iter().map(|side| (Form::Side(side), side.bounds()));
    match &barrier.obstacle {
        Obstacle::Wall(_) | Obstacle::Solid(Shape::Parts(_)) => sides.collect(),
        Obstacle::Solid(Shape::Circle { .. }) => vec![(Form::Disc, surface.bounds)],
        Obstacle::Solid(Shape::Polygon(_)) => sides.chain([(Form::Inside, surface.bounds)]).collect(),
    }
}

fn is_in<S: Simd>(part: Part<S>, around: &Bounds, (x, y): (Doubles<S>, Doubles<S>)) -> Truths<S> {
    x.simd_ge(part.c(around.low.x))
        & x.simd_le(part.c(around.high.x))
        & y.simd_ge(part.c(around.low.y))
        & y.simd_le(part.c(around.high.y))
}

fn contains(around: &Bounds, p: Vec2) -> bool {
    around.low.x <= p.x && p.x <= around.high.x && around.low.y <= p.y && p.y <= around.high.y
}
