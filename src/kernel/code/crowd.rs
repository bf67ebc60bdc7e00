//! Tight loops over a crowd: the shapes of expression that nearly every property has.

use super::lanes::{Body, Truth, Vector, View, by_lane, by_lane_of_two, lesser, narrow, widen};
use super::machine::compare_all;
use super::node::{Measure, Reading};
use super::proximity::MARGIN;
use crate::base::lanes::{Lanes, Mask};
use crate::base::math;
use crate::model::{Axis, Comparison, Field, Pair, Parameter, Period, Periods};
use fearless_simd::{Simd, prelude::*};

/// The members of a crowd, less perhaps one.
#[derive(Clone, Copy)]
pub(super) struct Members<'a> {
    pub(super) list: &'a [u32],
    /// Left out; `u32::MAX` for none.
    pub(super) except: u32,
}

impl Members<'_> {
    /// Calls `f` with each member present in some lane, and those lanes.
    #[inline(always)]
    fn each<S: Simd, const ONE: bool>(self, view: &View<'_, S, ONE>, mut f: impl FnMut(usize, Mask)) {
        for &member in self.list {
            let here = view.present(member as usize);
            if member != self.except && !here.is_empty() {
                f(member as usize, here);
            }
        }
    }
}

/// A body and what is measured from it.
#[derive(Clone, Copy)]
pub(super) struct Probe<S: Simd> {
    x: Vector<S>,
    y: Vector<S>,
    radius: Vector<S>,
    measure: Measure,
}

impl<S: Simd> Probe<S> {
    #[inline(always)]
    pub(super) fn new<const ONE: bool>(view: &View<'_, S, ONE>, who: usize, measure: Measure) -> Self {
        let state = view.state;
        let centres = measure == Measure::Centres;
        Self {
            x: view.load(&state.motion.x, who),
            y: view.load(&state.motion.y, who),
            radius: if centres { view.splat(0.0) } else { view.load(&state.bodies[Parameter::Radius], who) },
            measure,
        }
    }

    #[inline(always)]
    fn squared<const ONE: bool>(&self, view: &View<'_, S, ONE>, member: usize) -> Vector<S> {
        let dx = self.x - view.load(&view.state.motion.x, member);
        let dy = self.y - view.load(&view.state.motion.y, member);
        dx * dx + dy * dy
    }

    /// The measure, with the roundings of the expression it stands for.
    #[inline(always)]
    fn value<const ONE: bool>(&self, view: &View<'_, S, ONE>, member: usize) -> Vector<S> {
        let distance = self.squared(view, member).sqrt();
        match self.measure {
            Measure::Centres => distance,
            Measure::GapFixedFirst => {
                distance - self.radius - view.load(&view.state.bodies[Parameter::Radius], member)
            }
            Measure::GapRunningFirst => {
                distance - view.load(&view.state.bodies[Parameter::Radius], member) - self.radius
            }
        }
    }

    /// Smallest measure; infinite over nobody.
    #[inline(always)]
    pub(super) fn nearest<const ONE: bool>(
        &self,
        view: &View<'_, S, ONE>,
        members: Members<'_>,
    ) -> Vector<S> {
        let (mut best, zero) = (view.splat(f64::INFINITY), view.splat(0.0));
        if self.measure == Measure::Centres {
            members.each(
                view,
                #[inline(always)]
                |member, here| {
                    let joined = lesser(best, self.squared(view, member));
                    best =
                        if here == Mask::ALL { joined } else { widen(view.simd, here).select(joined, best) };
                },
            );
            // The square root is monotone and correctly rounded: the root of the least is the least root.
            return best.sqrt();
        }
        members.each(
            view,
            #[inline(always)]
            |member, here| {
                // No square root for a member that is surely farther in every lane. A NaN is never passed over.
                let squared = self.squared(view, member);
                let both = self.radius + view.load(&view.state.bodies[Parameter::Radius], member);
                let reach = (best + both) + (best.abs() + both) * MARGIN + 1e-30;
                let farther = reach.simd_gt(zero) & squared.simd_gt(reach * reach);
                if narrow(farther) == Mask::ALL {
                    return;
                }
                let joined = lesser(best, self.value(view, member));
                best = if here == Mask::ALL { joined } else { widen(view.simd, here).select(joined, best) };
            },
        );
        best
    }

    /// The lanes in which `f` of squared distance and reach holds for some member, where the reach is `base` and, for gaps, the member's radius times `factor`.
    #[inline(always)]
    fn some<const ONE: bool>(
        &self,
        view: &View<'_, S, ONE>,
        members: Members<'_>,
        base: Vector<S>,
        factor: f64,
        f: impl Fn(Vector<S>, Vector<S>) -> Truth<S>,
    ) -> Mask {
        let mut some = view.splat(0.0);
        let one = view.splat(1.0);
        let centres = self.measure == Measure::Centres;
        members.each(
            view,
            #[inline(always)]
            |member, here| {
                let squared = self.squared(view, member);
                let reach = if centres {
                    base
                } else {
                    base + view.load(&view.state.bodies[Parameter::Radius], member) * factor
                };
                let holds = f(squared, reach);
                // Kept as a number: truth values that live across a loop are slow where they are not vectors.
                let holds = if here == Mask::ALL { holds } else { holds & widen(view.simd, here) };
                some = holds.select(one, some);
            },
        );
        narrow(some.simd_eq(one))
    }

    /// The lanes in which the comparison with the bound has the wanted value for all members.
    ///
    /// Square roots are taken only where the comparison of squares is too close to be sure, so the
    /// outcome is that of the plain comparison, to the last bit.
    #[inline(always)]
    pub(super) fn all_far<const ONE: bool>(
        &self,
        view: &View<'_, S, ONE>,
        members: Members<'_>,
        bound: Vector<S>,
        test: Comparison,
        wanted: bool,
    ) -> Mask {
        let slack = (self.radius.abs() + bound.abs()) * MARGIN + 1e-30;
        let (middle, zero) = (self.radius + bound, view.splat(0.0));
        // A reach below 0 has no square to compare with; taken as 0 it is only less sure.
        let outer = middle + slack;
        let outer = outer.simd_lt(zero).select(zero, outer);
        // A NaN is not surely far, and not surely near.
        let unsure = self.some(
            view,
            members,
            outer,
            1.0 + MARGIN,
            #[inline(always)]
            |squared, reach| !squared.simd_gt(reach * reach),
        );
        if unsure.is_empty() {
            return Mask::ALL;
        }
        let near = self.some(
            view,
            members,
            middle - slack,
            1.0 - MARGIN,
            #[inline(always)]
            |squared, reach| reach.simd_gt(zero) & squared.simd_lt(reach * reach),
        );
        if (unsure & !near).is_empty() {
            return !unsure;
        }
        let mut bad = Mask::NONE;
        members.each(
            view,
            #[inline(always)]
            |member, here| {
                let holds = compare_all(test, self.value(view, member), bound);
                bad |= here & if wanted { !holds } else { holds };
            },
        );
        !bad
    }
}

/// A number of whoever is read.
#[inline(always)]
pub(super) fn reading<S: Simd, const ONE: bool>(
    view: &View<'_, S, ONE>,
    reading: Reading,
    body: Body,
) -> Vector<S> {
    let state = view.state;
    match reading {
        Reading::X => view.read(&state.motion.x, body),
        Reading::Y => view.read(&state.motion.y, body),
        Reading::Field(Field::Storey) => storey(view, &state.whereabouts.island, body),
        Reading::Origin(Axis::X) => storey(view, &state.whereabouts.origin_x, body),
        Reading::Origin(Axis::Y) => storey(view, &state.whereabouts.origin_y, body),
        Reading::Field(Field::VelocityX) => view.read(&state.motion.vx, body),
        Reading::Field(Field::VelocityY) => view.read(&state.motion.vy, body),
        Reading::Field(Field::Speed) => {
            let (x, y) = (view.read(&state.motion.vx, body), view.read(&state.motion.vy, body));
            (x * x + y * y).sqrt()
        }
        Reading::Field(Field::Heading) => {
            let (x, y, zero) =
                (view.read(&state.motion.vx, body), view.read(&state.motion.vy, body), view.splat(0.0));
            let stands = x.simd_eq(zero) & y.simd_eq(zero);
            let (x, y) = (
                stands.select(view.read(&state.driving.ex, body), x),
                stands.select(view.read(&state.driving.ey, body), y),
            );
            by_lane_of_two(y, x, math::atan2)
        }
        Reading::Field(Field::Radius) => view.read(&state.bodies[Parameter::Radius], body),
        Reading::Field(Field::Mass) => view.read(&state.bodies[Parameter::Mass], body),
        Reading::Field(Field::DrivingSpeed) => view.read(&state.bodies[Parameter::Speed], body),
        Reading::Field(Field::Travelled) => view.read(&state.motion.travelled, body),
        Reading::Field(Field::Legs) => view.read(&state.progress.legs, body),
        Reading::Field(Field::StepCount) => view.read(&state.progress.steps, body),
        Reading::Field(Field::DoneAt) => view.read(&state.progress.done_at, body),
        Reading::Field(Field::Leg(measure, leg)) => match state.progress.record(leg, measure as usize) {
            Some(record) => view.read(record, body),
            None => view.splat(f64::INFINITY),
        },
        // In steps; `lower` makes a time of them.
        Reading::Field(Field::Dwell(region)) => match state.passages.stays(region) {
            Some(steps) => view.read(steps, body),
            None => view.splat(0.0),
        },
        // It is composed of others (`lower`).
        Reading::Field(Field::Separation(_)) => view.splat(f64::NAN),
        Reading::Field(Field::Mode(behaviour)) => match state.behaviours.modes.get(behaviour.0 as usize) {
            Some(modes) => view.read(modes, body),
            None => view.splat(-1.0),
        },
        Reading::Field(Field::Column(column)) => match state.columns.get(column as usize) {
            Some(numbers) => view.read(numbers, body),
            None => view.splat(f64::NAN),
        },
    }
}

/// A number of the level or stairs of somebody; 0 before anybody was there.
#[cold]
#[inline(never)]
fn storey<S: Simd, const ONE: bool>(view: &View<'_, S, ONE>, field: &[Lanes], body: Body) -> Vector<S> {
    if field.is_empty() { view.splat(0.0) } else { view.read(field, body) }
}

/// Mean of a value over the members; NaN over nobody.
#[inline(always)]
fn mean<S: Simd, const ONE: bool>(
    view: &View<'_, S, ONE>,
    members: Members<'_>,
    value: impl Fn(usize) -> Vector<S>,
) -> Vector<S> {
    let (mut sum, mut count) = (view.splat(0.0), view.splat(0.0));
    members.each(
        view,
        #[inline(always)]
        |member, here| {
            let here = widen(view.simd, here);
            sum = here.select(sum + value(member), sum);
            count = here.select(count + 1.0, count);
        },
    );
    sum / count
}

/// Mean of a reading; NaN over nobody.
#[inline(always)]
pub(super) fn mean_reading<S: Simd, const ONE: bool>(
    view: &View<'_, S, ONE>,
    members: Members<'_>,
    what: Reading,
) -> Vector<S> {
    mean(
        view,
        members,
        #[inline(always)]
        |member| reading(view, what, Body::One(member)),
    )
}

/// Root of the mean squared distance from a point; NaN over nobody.
#[inline(always)]
pub(super) fn spread<S: Simd, const ONE: bool>(
    view: &View<'_, S, ONE>,
    members: Members<'_>,
    x: Vector<S>,
    y: Vector<S>,
) -> Vector<S> {
    let from = Probe { x, y, radius: view.splat(0.0), measure: Measure::Centres };
    mean(
        view,
        members,
        #[inline(always)]
        |member| from.squared(view, member),
    )
    .sqrt()
}

/// The lanes in which some member is present.
#[inline(always)]
pub(super) fn somebody<S: Simd, const ONE: bool>(view: &View<'_, S, ONE>, members: Members<'_>) -> Mask {
    let mut some = Mask::NONE;
    members.each(
        view,
        #[inline(always)]
        |_, here| some |= here,
    );
    some
}

/// A field of one agent less that of another.
#[inline(always)]
fn apart<S: Simd, const ONE: bool>(view: &View<'_, S, ONE>, field: &[Lanes], a: Body, b: Body) -> Vector<S> {
    view.read(field, a) - view.read(field, b)
}

/// A number of two agents.
#[inline(always)]
pub(super) fn of_two<S: Simd, const ONE: bool>(
    (view, periods): (&View<'_, S, ONE>, &Periods),
    pair: Pair,
    a: Body,
    b: Body,
) -> Vector<S> {
    match pair {
        Pair::TimeToCollision => time_to_collision((view, periods), a, b),
    }
}

/// Seconds until two bodies touch if both keep their velocity. Touching discs: 0. Else the first root of
/// |p + v t| = R with p and v of one relative to the other, in the form without cancellation.
#[inline(always)]
fn time_to_collision<S: Simd, const ONE: bool>(
    (view, periods): (&View<'_, S, ONE>, &Periods),
    a: Body,
    b: Body,
) -> Vector<S> {
    let state = view.state;
    let (zero, never) = (view.splat(0.0), view.splat(f64::INFINITY));
    let (px, py, vx, vy) = (
        apart(view, &state.motion.x, a, b),
        apart(view, &state.motion.y, a, b),
        apart(view, &state.motion.vx, a, b),
        apart(view, &state.motion.vy, a, b),
    );
    let near = |d: Vector<S>, period: Option<Period>| match period {
        None => d,
        Some(period) => by_lane(d, |d| period.way(d)),
    };
    let (px, py) = (near(px, periods.x), near(py, periods.y));
    let (ra, rb) =
        (view.read(&state.bodies[Parameter::Radius], a), view.read(&state.bodies[Parameter::Radius], b));
    let (squared, reach) = (px * px + py * py, ra + rb);
    let (speed, along, beyond) = (vx * vx + vy * vy, px * vx + py * vy, squared - reach * reach);
    let root = along * along - speed * beyond;
    let time = beyond / (root.sqrt() - along);
    let time = time.simd_lt(zero).select(zero, time);
    // A NaN is neither approaching nor receding: it stays NaN.
    let time = (along.simd_ge(zero) | root.simd_lt(zero)).select(never, time);
    let time = (squared.sqrt() - ra - rb).simd_le(zero).select(zero, time);
    widen(view.simd, view.shows(a) & view.shows(b)).select(time, never)
}
