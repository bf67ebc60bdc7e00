//! Random expressions and states.

use super::AGENTS;
use proptest::prelude::*;
use smc::base::lanes::{LANES, Mask};
use smc::kernel::{Layout, State};
use smc::model::function::LegMeasure;
use smc::model::{
    AgentId, Arithmetic, Axis, BarrierId, Bool, Collective, Comparison, Field, Fold, Function, Num, Pair,
    Parameter, Place, RegionId, Separation, Set, Who,
};

pub(crate) fn who(depth: u32) -> BoxedStrategy<Who> {
    let fixed = (0..AGENTS as u32).prop_map(|k| Who::Agent(AgentId(k)));
    if depth == 0 {
        fixed.boxed()
    } else {
        prop_oneof![1 => fixed, 2 => (0..depth).prop_map(Who::Running)].boxed()
    }
}

pub(crate) fn set(depth: u32) -> BoxedStrategy<Set> {
    // Everybody now and then: a whole block of one trial.
    let some = prop_oneof![3 => proptest::bits::u16::between(0, AGENTS), 1 => Just(u16::MAX)];
    let members = some.prop_map(|bits| {
        (0..AGENTS as u32).filter(|k| bits >> k & 1 == 1).map(AgentId).collect::<Vec<_>>().into()
    });
    (members, proptest::option::of(who(depth))).prop_map(|(members, except)| Set { members, except }).boxed()
}

pub(crate) fn place(depth: u32, size: u32) -> BoxedStrategy<Place> {
    let simple =
        prop_oneof![3 => who(depth).prop_map(Place::Agent), 1 => set(depth).prop_map(Place::Centroid)];
    if size == 0 {
        return simple.boxed();
    }
    let point = (number(depth, size - 1), number(depth, size - 1))
        .prop_map(|(x, y)| Place::Point(Box::new(x), Box::new(y)));
    prop_oneof![3 => simple, 1 => point].boxed()
}

pub(crate) fn constant() -> impl Strategy<Value = Num> {
    prop_oneof![
        4 => prop::sample::select(vec![0.0, 0.5, 1.0, 2.0, -1.0, 0.1, 3.7]),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
        2 => -5.0..5.0
    ]
    .prop_map(Num::Constant)
}

pub(crate) fn field() -> impl Strategy<Value = Field> {
    prop::sample::select(vec![
        Field::VelocityX,
        Field::VelocityY,
        Field::Speed,
        Field::Heading,
        Field::Radius,
        Field::Mass,
        Field::DrivingSpeed,
        Field::Travelled,
        Field::Legs,
        Field::DoneAt,
        Field::Leg(LegMeasure::Length, 0),
    ])
}

/// Distance of two agents, perhaps less their radii, in both orders.
pub(crate) fn measure(a: Who, b: Who, kind: u8) -> Num {
    let radius = |who| Box::new(Num::Of(Field::Radius, who));
    let less = |n, who| Num::Combine(Arithmetic::Subtract, Box::new(n), radius(who));
    let distance = Num::Distance(Place::Agent(a), Place::Agent(b));
    match kind {
        0 => distance,
        1 => less(less(distance, a), b),
        _ => less(less(distance, b), a),
    }
}

pub(crate) fn number(depth: u32, size: u32) -> BoxedStrategy<Num> {
    let leaf = prop_oneof![
        2 => constant(),
        1 => Just(Num::Time),
        2 => (field(), who(depth)).prop_map(|(f, w)| Num::Of(f, w)),
        1 => who(depth).prop_map(|w| Num::Of(Field::Separation(Separation::Clearance), w)),
        1 => (who(depth), who(depth)).prop_map(|(a, b)| Num::OfTwo(Pair::TimeToCollision, a, b)),
        1 => set(depth).prop_map(|s| Num::OfSet(Collective::Spread, s)),
        1 => set(depth).prop_map(|s| Num::OfSet(Collective::MeanVelocity(Axis::Y), s)),
        2 => (who(depth), who(depth), 0..3u8).prop_map(|(a, b, k)| measure(a, b, k)),
    ];
    if size == 0 {
        return leaf.boxed();
    }
    let functions = prop::sample::select(vec![
        Function::Negate,
        Function::Abs,
        Function::Sqrt,
        Function::Exp,
        Function::Ln,
        Function::Sin,
        Function::Cos,
        Function::Floor,
        Function::Ceil,
        Function::Round,
        Function::ServiceLevel,
    ]);
    let operators = prop::sample::select(vec![
        Arithmetic::Add,
        Arithmetic::Subtract,
        Arithmetic::Multiply,
        Arithmetic::Divide,
        Arithmetic::Power,
        Arithmetic::Min,
        Arithmetic::Max,
        Arithmetic::Atan2,
        Arithmetic::Modulo,
        Arithmetic::Agree,
    ]);
    let folds = prop::sample::select(vec![Fold::Min, Fold::Max, Fold::Sum, Fold::Mean]);
    let smaller = size - 1;
    prop_oneof![
        2 => leaf,
        1 => (any::<bool>(), place(depth, smaller)).prop_map(|(x, place)| {
            Num::Coordinate(if x { Axis::X } else { Axis::Y }, place)
        }),
        2 => (place(depth, smaller), place(depth, smaller)).prop_map(|(a, b)| Num::Distance(a, b)),
        1 => (0..3u32, place(depth, smaller)).prop_map(|(r, a)| Num::Distance(a, Place::Region(RegionId(r)))),
        1 => (0..3u32, place(depth, smaller)).prop_map(|(r, a)| Num::Depth(a, RegionId(r))),
        1 => (0..4u32, place(depth, smaller)).prop_map(|(b, a)| Num::Distance(Place::Barrier(BarrierId(b)), a)),
        2 => (functions, number(depth, smaller)).prop_map(|(f, a)| Num::Apply(f, Box::new(a))),
        2 => (operators, number(depth, smaller), number(depth, smaller))
            .prop_map(|(o, a, b)| Num::Combine(o, Box::new(a), Box::new(b))),
        3 => (folds, set(depth), number(depth + 1, smaller)).prop_map(|(f, s, b)| Num::Fold(f, s, Box::new(b))),
        2 => (who(depth), set(depth), 0..3u8).prop_map(move |(w, s, k)| {
            Num::Fold(Fold::Min, s, Box::new(measure(w, Who::Running(depth), k)))
        }),
        2 => (set(depth), truth(depth + 1, smaller)).prop_map(|(s, b)| Num::Count(s, Box::new(b))),
        1 => (truth(depth, smaller), number(depth, smaller), number(depth, smaller))
            .prop_map(|(c, a, b)| Num::If(Box::new(c), Box::new(a), Box::new(b))),
    ]
    .boxed()
}

pub(crate) fn comparison() -> impl Strategy<Value = Comparison> {
    prop::sample::select(vec![
        Comparison::Less,
        Comparison::AtMost,
        Comparison::Greater,
        Comparison::AtLeast,
        Comparison::Equal,
        Comparison::Unequal,
    ])
}

pub(crate) fn truth(depth: u32, size: u32) -> BoxedStrategy<Bool> {
    let leaf = prop_oneof![
        1 => any::<bool>().prop_map(Bool::Constant),
        2 => (who(depth), 0..3u32).prop_map(|(w, r)| Bool::In(w, RegionId(r))),
        1 => who(depth).prop_map(Bool::Contact),
        1 => (who(depth), who(depth)).prop_map(|(a, b)| Bool::Touching(a, b)),
    ];
    if size == 0 {
        return leaf.boxed();
    }
    let smaller = size - 1;
    let all = move || proptest::collection::vec(truth(depth, smaller), 0..3);
    // The shape with an instruction of its own.
    let far = (who(depth), set(depth), comparison(), prop_oneof![constant(), number(depth, 0)], 0..3u8);
    let far =
        (far, any::<bool>(), any::<bool>()).prop_map(move |((w, set, c, bound, kind), all, mirrored)| {
            let (a, b) = (Box::new(measure(w, Who::Running(depth), kind)), Box::new(bound));
            let body = Box::new(if mirrored { Bool::Compare(c, b, a) } else { Bool::Compare(c, a, b) });
            if all { Bool::Forall(set, body) } else { Bool::Exists(set, body) }
        });
    let least =
        (who(depth), set(depth), comparison(), constant(), 0..3u8).prop_map(move |(w, set, c, b, kind)| {
            let fold = Num::Fold(Fold::Min, set, Box::new(measure(w, Who::Running(depth), kind)));
            Bool::Compare(c, Box::new(fold), Box::new(b))
        });
    prop_oneof![
        1 => leaf,
        3 => (comparison(), number(depth, smaller), number(depth, smaller))
            .prop_map(|(c, a, b)| Bool::Compare(c, Box::new(a), Box::new(b))),
        1 => truth(depth, smaller).prop_map(|a| Bool::Not(Box::new(a))),
        1 => all().prop_map(Bool::And),
        1 => all().prop_map(Bool::Or),
        1 => (truth(depth, smaller), truth(depth, smaller))
            .prop_map(|(a, b)| Bool::Iff(Box::new(a), Box::new(b))),
        2 => (set(depth), truth(depth + 1, smaller)).prop_map(|(s, b)| Bool::Forall(s, Box::new(b))),
        2 => (set(depth), truth(depth + 1, smaller)).prop_map(|(s, b)| Bool::Exists(s, Box::new(b))),
        3 => far,
        1 => least,
    ]
    .boxed()
}

/// A state whose numbers are not printed when a case fails.
#[derive(Clone)]
pub(crate) struct Hidden(pub(crate) State);

impl std::fmt::Debug for Hidden {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "x {:?} y {:?} present {:?}", self.0.motion.x, self.0.motion.y, self.0.present)
    }
}

pub(crate) fn state(layout: Layout) -> BoxedStrategy<Hidden> {
    // Coordinates on a coarse grid now and then, so that bodies touch exactly and stand on rims.
    let coordinate =
        prop_oneof![3 => 0.0..6.0, 3 => (0..13i32).prop_map(|k| f64::from(k) * 0.5), 1 => Just(f64::NAN)];
    let speed = prop_oneof![1 => Just(0.0), 3 => -2.0..2.0];
    let radius = prop_oneof![1 => Just(0.25), 3 => 0.1..0.6, 1 => Just(0.5)];
    let slot = (coordinate.clone(), coordinate, speed.clone(), speed, radius, 0.0..1.0);
    let slots = proptest::collection::vec(slot, AGENTS * LANES);
    let masks = proptest::collection::vec(prop_oneof![2 => Just(255u8), 1 => any::<u8>()], AGENTS);
    (slots, masks, prop_oneof![2 => Just(255u8), 1 => any::<u8>()], any::<[u16; LANES]>())
        .prop_map(move |(slots, masks, occupied, ticks)| {
            let mut state = State::new(layout, AGENTS);
            let (blocks, width) = (state.motion.x.len(), slots.len());
            for block in 0..blocks {
                for lane in 0..LANES {
                    let (x, y, vx, vy, radius, z) = slots[(block * LANES + lane) % width];
                    state.motion.x[block].0[lane] = x;
                    state.motion.y[block].0[lane] = y;
                    state.motion.vx[block].0[lane] = vx;
                    state.motion.vy[block].0[lane] = vy;
                    state.bodies[Parameter::Radius][block].0[lane] = radius;
                    state.driving.ex[block].0[lane] = 1.0 - z;
                    state.driving.ey[block].0[lane] = z;
                    state.bodies[Parameter::Mass][block].0[lane] = 80.0 * z;
                    state.bodies[Parameter::Speed][block].0[lane] = 1.0 + z;
                    state.motion.travelled[block].0[lane] = 10.0 * z;
                }
                state.present[block] = Mask(masks[block]);
            }
            state.ticks = ticks.map(u64::from);
            state.occupied = match layout {
                Layout::Trials => Mask(occupied),
                Layout::Agents => Mask(1),
            };
            Hidden(state)
        })
        .boxed()
}
