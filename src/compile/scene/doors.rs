//! Doors of a scene: openings in the walls that they lie on, and walls while they are closed.

use crate::base::geometry::Segment;
use crate::base::random::name_hash;
use crate::compile::context::{Context, Locals, Lowered, Reported, symbols::unknown, typed::Typed};
use crate::compile::lower::laws::waiting;
use crate::compile::scene::imports::walls;
use crate::data::geometry;
use crate::model::{self, Agent, Barrier, BarrierId, Bool, Law, Obstacle, Shut, door::MOST_DOORS};
use crate::syntax::ast::{Field, Ident, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;

/// A door between two walls reaches as near as this to them, m.
const NEAR: f64 = 0.05;
/// Rounding of lengths, m.
const HAIR: f64 = 0.01;

/// A door as written.
pub(crate) struct Door {
    pub(crate) name: Ident,
    pub(crate) segment: Segment,
    pub(crate) state: State,
}

/// When a door is closed.
pub(crate) enum State {
    /// For the whole of each trial, or never.
    Fixed(bool),
    Changes(Shut),
}

/// What the fields of a door say. Conditions of parameters and constants are known before a trial.
pub(crate) fn state(context: &mut Context<'_>, fields: &[Field]) -> Lowered<State> {
    let mut out = Ok(State::Fixed(false));
    for (k, field) in fields.iter().enumerate() {
        let name = field.name.name.as_str();
        let first =
            fields[..k].iter().find(|before| before.name.name == name || before.name.name == "closed");
        if let Some(first) = first.or(fields[..k].iter().find(|_| name == "closed")) {
            let error = if first.name.name == name {
                error!(E0202, field.name.span, "`{name}` is set twice")
            } else {
                error!(E0202, field.name.span, "`{}` and `{name}` both say when the door is closed", first.name.name;
                    hint: "write a condition (`closed`), or times (`opens`, `closes`)")
            };
            out = context.report(error.related(first.name.span, "first set here"));
            continue;
        }
        let found = match name {
            "closed" => condition(context, &field.value),
            "opens" | "closes" => {
                waiting(context, &field.value, &Locals::default(), "a time of a door").map(|time| {
                    let times = if name == "opens" { (Some(time), None) } else { (None, Some(time)) };
                    State::Changes(Shut::Times { opens: times.0, closes: times.1 })
                })
            }
            _ => {
                let known = ["closed", "opens", "closes"].into_iter();
                context.report(unknown("field", name, field.name.span, Code::E0207, known))
            }
        };
        out = match (out, found) {
            (
                Ok(State::Changes(Shut::Times { opens, closes })),
                Ok(State::Changes(Shut::Times { opens: later, closes: other })),
            ) => Ok(State::Changes(Shut::Times { opens: opens.or(later), closes: closes.or(other) })),
            (Ok(_), found) => found,
            (Err(Reported), _) => Err(Reported),
        };
    }
    match out? {
        State::Changes(shut) => Ok(within(context, shut)),
        fixed @ State::Fixed(_) => Ok(fixed),
    }
}

fn condition(context: &mut Context<'_>, value: &Value) -> Lowered<State> {
    let Value::Plain(expr) = value else {
        return context.report(error!(E0305, value.span(), "`closed` must be a condition";
            hint: "write for example `closed = shut == 1`, where `shut` is a parameter"));
    };
    match context.lower(expr, &Locals::default())? {
        Typed::Truth(Bool::Constant(closed), _) => Ok(State::Fixed(closed)),
        Typed::Truth(condition, _) => Ok(State::Changes(Shut::While(condition))),
        found => context.mismatch(expr.span, "a condition", &found),
    }
}

/// What a door is that changes at times which no trial reaches.
fn within(context: &Context<'_>, shut: Shut) -> State {
    let horizon = context.time.clock.seconds(context.time.horizon);
    let never = |time: &Option<Law>| time.as_ref().is_none_or(|law| law.bounds().0 > horizon);
    match shut {
        Shut::Times { opens: opens @ Some(_), closes: None } if horizon > 0.0 && never(&opens) => {
            State::Fixed(true)
        }
        Shut::Times { opens: None, closes } if horizon > 0.0 && never(&closes) => State::Fixed(false),
        shut => State::Changes(shut),
    }
}

/// Opens the walls on which doors lie, and puts a wall into each door that is closed.
pub(crate) fn set(context: &mut Context<'_>, doors: &[Door]) -> Vec<model::Door> {
    let mut changing = Vec::new();
    for Door { name, segment, state } in doors {
        let touches =
            |end| context.scene.barriers.iter().any(|barrier| barrier.obstacle.distance(end) <= NEAR);
        let is_between = touches(segment.a) && touches(segment.b);
        let opened = geometry::open_at(&mut walls(&mut context.scene.barriers), segment);
        let width = segment.length();
        let text = &name.name;
        // A wall whose places could not be read may be that of the door.
        let is_unread = |one: &Barrier| matches!(&one.obstacle, Obstacle::Wall(pieces) if pieces.is_empty());
        if opened <= HAIR && !is_between && !context.scene.barriers.iter().any(is_unread) {
            let error = error!(E0401, name.span, "the door `{text}` lies on no wall";
                hint: "both of its ends must lie on one straight wall, or reach the walls beside it");
            context.note(error.about(About::Door));
        } else if opened > HAIR && opened < width - HAIR {
            let error = error!(E0401, name.span, "the door `{text}` is {width:.2} m wide, and its wall has {opened:.2} m there";
                hint: "move its ends onto the wall");
            context.note(error);
        }
        if matches!(state, State::Fixed(false)) {
            continue;
        }
        let barrier = BarrierId(context.scene.barriers.len() as u32);
        let obstacle = Obstacle::Wall(vec![*segment]);
        context.scene.barriers.push(Barrier { name: text.clone(), obstacle });
        if let State::Changes(shut) = state {
            let entity = name_hash(text) as u32;
            if context.scene.doors.len() == MOST_DOORS {
                let error = error!(E0401, name.span, "more than {MOST_DOORS} doors open or close during a trial";
                    hint: "close some for whole trials: `closed = shut == 1`, where `shut` is a parameter");
                context.note(error);
            }
            context.scene.doors.push(barrier);
            changing.push(model::Door { entity, shut: shut.clone() });
        }
    }
    changing
}

/// Walkers that plan or step know the plan of the floor as it is at the start of a run.
pub(crate) fn check(context: &mut Context<'_>, doors: &[Door], agents: &[Agent]) {
    let is_led = |agent: &&Agent| agent.body.planner.is_some() || agent.body.stepper.is_some();
    let changing = doors.iter().find(|door| matches!(door.state, State::Changes(_)));
    if let (Some(door), Some(agent)) = (changing, agents.iter().find(is_led)) {
        let (door, agent) = (&door.name, &agent.name);
        let error = error!(E0408, door.span, "the door `{}` changes during a trial, and `{agent}` plans or steps", door.name;
            hint: "make `{agent}` an agent of `sfm` or `cfs`, or close the door for whole trials: `closed = shut == 1`");
        context.note(error);
    }
}
