//! The forces on bodies: one file for each term, and the list of terms.
//!
//! `social` (with its second term) and each further term between two bodies is a `pair::PairTerm`, which both layouts sum
//! (`lanewise`, `cells`); `walls` is the social force of barriers, `cohesion` the attraction of groups, `contact` the fast
//! force that sub-steps advance.
//!
//! A new term between two bodies is a file here and a line in `with_pair_terms`.

mod ahead;
pub(super) mod contact;
pub(super) mod pair;
mod social;
mod speed;
pub(super) mod walls;

use super::pace::fastest;
use super::plane::Closed;
use super::state::{Slot, State};
use crate::base::geometry::{Vec2, cross};
use crate::base::lanes::{Lanes, Mask};
use crate::base::math::{at_least, atan2};
use crate::model::{Agent, Barrier, Body, ByDoors, Group, Kind, Law, Parameter, Periods, Scenario};
pub(super) use ahead::Ahead;
pub(super) use pair::Both;
use pair::Sum;
use social::Particles;
pub(super) use social::{Bounded, Social};
pub(super) use speed::{Room, Swerve};
use walls::Surfaces;

/// The largest approach that contact candidates foresee at least, m/s.
const APPROACH: f64 = 5.0;

/// What the forces need to know of a scenario, the same in every trial.
#[derive(Clone, Debug)]
pub struct Forces {
    /// Walls and obstacles, all doors closed.
    pub(super) surfaces: Surfaces,
    /// The same with fewer doors closed, from these barriers and doors; none where no door may change.
    by_doors: ByDoors<Surfaces>,
    barriers: Vec<Barrier>,
    doors: Vec<usize>,
    groups: Vec<Cohesion>,
    /// Along which axes the plane closes on itself, and the same for vectors.
    pub(super) periods: Periods,
    pub(super) closed: Option<Closed>,
    pub(super) particles: Particles,
    /// B (and B of the second term), if it is the same constant in all bodies and no two are of several
    /// persons: then one exponential serves both bodies of a pair.
    pub(super) shared: Option<(f64, f64)>,
    /// Whether any body has the second term.
    pub(super) second: bool,
    /// Whether any body looks ahead, and whether all have the same foresight.
    pub(super) ahead: Option<SameForesight>,
    /// Whether anybody follows a rule of `ahead::Manners`.
    pub(super) manners: bool,
    /// Whether any agent is of the collision-free speed model, and whether all are.
    pub(super) speeds: Option<AllOfThem>,
    /// `particles.repulsion`, or as long a list of NaN.
    pub(super) repulsion: Vec<f64>,
    /// Bodies (and walls) nearer than this to touching may touch within a step, m.
    pub(super) margin: f64,
}

/// Whether the foresight of all bodies is the same constant.
type SameForesight = bool;

/// Whether all agents are of the collision-free speed model.
type AllOfThem = bool;

/// Runs a block with the terms between two bodies that a scenario has, as `$term`, and its plane, as `$plane`. It is compiled
/// once for each combination that is common, so that a term that such a scenario lacks costs nothing.
macro_rules! with_pair_terms {
    ($forces:ident, $term:ident, $plane:pat, $body:expr) => {
        if let Some(all) = $forces.speeds {
            if all {
                let $term = $crate::kernel::force::Swerve;
                with_pair_terms!(@on $forces, $plane, $body)
            } else {
                let first = $crate::kernel::force::Social::<false, false>::with_own_ranges();
                let second = $crate::kernel::force::Social::<true, false>::with_own_ranges();
                let term = $crate::kernel::force::Both(first, second);
                let repulsion = $forces.repulsion.as_slice();
                let term = $crate::kernel::force::Bounded { term, repulsion };
                let term = $crate::kernel::force::Both(term, $crate::kernel::force::Swerve);
                let $term = $crate::kernel::force::Ahead::<_, false, true>(term);
                with_pair_terms!(@on $forces, $plane, $body)
            }
        } else if let (Some(true), Some((b, _)), false) = ($forces.ahead, $forces.shared, $forces.second) {
            let $term = $crate::kernel::force::Social::<false, true>::with_range(b);
            if $forces.manners {
                let $term = $crate::kernel::force::Ahead::<_, true, true>($term);
                with_pair_terms!(@on $forces, $plane, $body)
            } else {
                let $term = $crate::kernel::force::Ahead::<_, true, false>($term);
                with_pair_terms!(@on $forces, $plane, $body)
            }
        } else if $forces.ahead.is_some() || $forces.closed.is_some() {
            // One term for all other scenes in which somebody looks ahead, or the plane is closed.
            let first = $crate::kernel::force::Social::<false, false>::with_own_ranges();
            let second = $crate::kernel::force::Social::<true, false>::with_own_ranges();
            let term = $crate::kernel::force::Both(first, second);
            let repulsion = $forces.repulsion.as_slice();
            let term = $crate::kernel::force::Bounded { term, repulsion };
            let $term = $crate::kernel::force::Ahead::<_, false, true>(term);
            with_pair_terms!(@on $forces, $plane, $body)
        } else if let Some((b, b2)) = $forces.shared {
            let $plane = $crate::kernel::plane::Open;
            let $term = $crate::kernel::force::Social::<false, true>::with_range(b);
            let second = $crate::kernel::force::Social::<true, true>::with_range(b2);
            with_pair_terms!(@if $forces.second, $term = $crate::kernel::force::Both($term, second), $body)
        } else {
            let $plane = $crate::kernel::plane::Open;
            let $term = $crate::kernel::force::Social::<false, false>::with_own_ranges();
            let second = $crate::kernel::force::Social::<true, false>::with_own_ranges();
            // A scene with particles or with the second term has both.
            let both = $forces.second || !$forces.particles.repulsion.is_empty();
            let repulsion = $forces.repulsion.as_slice();
            let more = $crate::kernel::force::Bounded { term: $crate::kernel::force::Both($term, second), repulsion };
            with_pair_terms!(@if both, $term = more, $body)
        }
    };
    (@on $forces:ident, $plane:pat, $body:expr) => {
        if let Some($plane) = $forces.closed {
            $body
        } else {
            let $plane = $crate::kernel::plane::Open;
            $body
        }
    };
    (@if $present:expr, $term:ident = $more:expr, $body:expr) => {
        if $present {
            let $term = $more;
            $body
        } else {
            $body
        }
    };
}
pub(super) use with_pair_terms;

fn shared_constant(scenario: &Scenario, of: impl Fn(&Body) -> &Law) -> Option<f64> {
    let first = of(&scenario.agents.first()?.body).constant()?;
    scenario.agents.iter().all(|agent| of(&agent.body).constant() == Some(first)).then_some(first)
}

impl Forces {
    /// Prepares the forces of a scenario with steps of `dt` seconds.
    pub fn new(scenario: &Scenario, dt: f64) -> Self {
        let changed = |parameter| scenario.behaviours.change(parameter);
        let particles = Particles::new(scenario);
        let has_second = |body: &Body| body[Parameter::A2].constant() != Some(0.0);
        let second = changed(Parameter::A2) || scenario.agents.iter().any(|agent| has_second(&agent.body));
        let same = !changed(Parameter::B) && !changed(Parameter::B2);
        let first_range = shared_constant(scenario, |body| &body[Parameter::B]).filter(|_| same);
        let second_range =
            if second { shared_constant(scenario, |body| &body[Parameter::B2]) } else { Some(1.0) };
        let constant = |agent: &Agent, parameter: Parameter| {
            let has = parameter.description().kinds.contains(&agent.body.kind);
            if has { agent.body[parameter].constant() } else { Some(0.0) }
        };
        let looks = |parameter| {
            changed(parameter) || scenario.agents.iter().any(|agent| constant(agent, parameter) != Some(0.0))
        };
        let foresight = |agent| constant(agent, Parameter::Foresight);
        let same = !changed(Parameter::Foresight)
            && scenario
                .agents
                .first()
                .and_then(foresight)
                .is_some_and(|first| scenario.agents.iter().all(|agent| foresight(agent) == Some(first)));
        let manners = Parameter::MANNERS.into_iter().any(looks);
        let ahead = (looks(Parameter::Foresight) || looks(Parameter::Headway) || manners).then_some(same);
        let mut repulsion = particles.repulsion.clone();
        repulsion.resize(scenario.agents.len(), f64::NAN);
        let of_speeds = |agent: &Agent| agent.body.kind == Kind::Cfs;
        let all = scenario.agents.iter().all(of_speeds);
        let speeds = scenario.agents.iter().any(of_speeds).then_some(all);
        let is_shared = particles.repulsion.is_empty() && speeds.is_none();
        let shared = first_range.zip(second_range).filter(|_| is_shared);
        let doors: Vec<usize> = scenario.scene.doors.iter().map(|door| door.0 as usize).collect();
        let barriers = scenario.scene.unrolled();
        Self {
            surfaces: Surfaces::new(&barriers, |_| false),
            by_doors: ByDoors::new(doors.len()),
            barriers: if doors.is_empty() { Vec::new() } else { barriers.into_owned() },
            doors,
            periods: scenario.scene.periods,
            closed: Closed::with(&scenario.scene.periods),
            groups: Cohesion::all(scenario),
            particles,
            shared,
            second,
            ahead,
            manners,
            speeds,
            repulsion,
            margin: at_least(APPROACH, 2.0 * fastest(scenario)) * dt,
        }
    }

    /// Walls and obstacles where these doors are closed. A face has the same number whatever is closed.
    #[inline(always)]
    pub(super) fn surfaces(&self, closed: u32) -> &Surfaces {
        if self.doors.is_empty() { &self.surfaces } else { self.surfaces_of(closed) }
    }

    /// Walls and obstacles for each set of closed doors of a batch, with its lanes; empty where no door may change.
    pub(super) fn by_doors(&self, state: &State) -> Vec<(&Surfaces, Mask)> {
        if self.doors.is_empty() {
            return Vec::new();
        }
        let (sets, count) = state.doors.each(state.layout);
        sets[..count].iter().map(|&(set, lanes)| (self.surfaces_of(set), lanes)).collect()
    }

    #[cold]
    fn surfaces_of(&self, closed: u32) -> &Surfaces {
        self.by_doors.of(closed, || {
            // Images stand behind the barriers, in the same order.
            let count = self.barriers.len() / self.periods.images().len().max(1);
            let is_open = |k: usize| {
                self.doors.iter().position(|&door| door == k % count).is_some_and(|k| closed >> k & 1 == 0)
            };
            Surfaces::new(&self.barriers, is_open)
        })
    }

    /// Adds the attraction within groups.
    pub(super) fn add_cohesion(&self, state: &State, sums: &mut [Sum]) {
        for group in &self.groups {
            group.add(&self.periods, state, sums);
        }
    }
}

// Attraction within groups (Moussaid, Perozo, Garnier, Helbing, Theraulaz 2010): a constant force towards the centroid of
// the n members present, on those farther than (n - 1)/2 m from it. Without lanes: groups are few, and this is the same
// for both layouts.
//
// A member with `abreast` d follows all of that paper: it comes as near as (n - 1) d/2 (there the attraction fades out), and
// who has to turn the head by an angle beyond the right one to see the centroid walks slower by that angle:
//
//     F = -4/s m angle v        a                    the one ahead waits until both are side by side,
//                                 \  angle            and of three the middle one stays a little behind: a V
//                                  c---- a right angle

/// The force that drives 80 kg at 1 m/s with a relaxation time of 0.5 s, N.
const DRIVING: f64 = 160.0;

/// How strongly members slow down to see the centroid (`beta_1` of the paper), 1/s.
const GAZE: f64 = 4.0;

/// Over this length the attraction of members who walk side by side fades out, m.
const FADE: f64 = 0.1;

/// The force on a member that looks back, N: against its velocity, with the angle by which the way to the centroid lies behind.
fn glance(state: &State, slot: Slot, way: Vec2) -> Vec2 {
    let of = |field: &[Lanes]| field[slot.block].0[slot.lane];
    let ahead = Vec2::new(of(&state.driving.ex), of(&state.driving.ey));
    let behind = -way.dot(&ahead);
    if behind <= 0.0 || of(&state.driving.speed) == 0.0 {
        return Vec2::zeros();
    }
    let angle = atan2(behind, cross(ahead, way).abs());
    let mass = of(&state.bodies[Parameter::Mass]);
    Vec2::new(of(&state.motion.vx), of(&state.motion.vy)) * (-GAZE * angle * mass)
}

/// Members that attract each other.
#[derive(Clone, Debug)]
struct Cohesion {
    members: Vec<u32>,
    /// N.
    attraction: f64,
}

impl Cohesion {
    /// The groups of a scenario with an attraction.
    fn all(scenario: &Scenario) -> Vec<Self> {
        let groups = scenario.groups.iter();
        // The attraction of a group turns an agent of the collision-free speed model: this many newton as much as its goal.
        let scale = |group: &Group| {
            let first = &scenario.agents[group.members[0].0 as usize];
            if first.body.kind == Kind::Cfs { 1.0 / DRIVING } else { 1.0 }
        };
        groups
            .filter(|group| group.attraction != 0.0 && group.members.len() > 1)
            .map(|group| Self {
                members: group.members.iter().map(|member| member.0).collect(),
                attraction: group.attraction * scale(group),
            })
            .collect()
    }

    /// Adds the attraction of a group.
    fn add(&self, periods: &Periods, state: &State, sums: &mut [Sum]) {
        for lane in state.occupied.iter() {
            // On each level its own members.
            let mut islands: Vec<f64> = Vec::new();
            if !state.whereabouts.island.is_empty() {
                let of = |member: &u32| state.slot(*member as usize, lane).of(&state.whereabouts.island);
                islands.extend(self.members.iter().map(of));
                islands.sort_by(f64::total_cmp);
                islands.dedup();
            }
            if islands.len() < 2 {
                self.pull(periods, state, lane, None, sums);
            }
            for island in islands.iter().filter(|_| islands.len() > 1) {
                self.pull(periods, state, lane, Some(*island), sums);
            }
        }
    }

    /// Adds the attraction of those members in the trial of a lane who are on an island, or of all.
    fn pull(&self, periods: &Periods, state: &State, lane: usize, island: Option<f64>, sums: &mut [Sum]) {
        // On a closed plane of each the image that is nearest to the first.
        let mut first = None;
        let mut place = |member: u32| {
            let slot = state.slot(member as usize, lane);
            let here = state.present[slot.block].has(slot.lane)
                && island.is_none_or(|island| slot.of(&state.whereabouts.island) == island);
            here.then(|| {
                let (x, y) = (&state.motion.x[slot.block], &state.motion.y[slot.block]);
                let at = Vec2::new(x.0[slot.lane], y.0[slot.lane]);
                let first = *first.get_or_insert(at);
                (slot, if periods.are_none() { at } else { first + periods.way(at - first) })
            })
        };
        let (mut n, mut sum) = (0.0, Vec2::zeros());
        for (_, at) in self.members.iter().filter_map(|&member| place(member)) {
            n += 1.0;
            sum += at;
        }
        for (slot, at) in self.members.iter().filter_map(|&member| place(member)) {
            let way = sum / n - at;
            let distance = way.dot(&way).sqrt();
            let abreast = state.bodies[Parameter::Abreast][slot.block].0[slot.lane];
            let (unit, fade) = if abreast > 0.0 { (abreast, FADE) } else { (1.0, 0.0) };
            let beyond = distance - 0.5 * (n - 1.0) * unit;
            let mut pull = Vec2::zeros();
            if distance > 0.0 && beyond > 0.0 {
                let share = if beyond < fade { beyond / fade } else { 1.0 };
                pull = way * (share * self.attraction / distance);
            }
            if abreast > 0.0 {
                pull += glance(state, slot, way);
            }
            sums[slot.block].x.0[slot.lane] += pull.x;
            sums[slot.block].y.0[slot.lane] += pull.y;
        }
    }
}
