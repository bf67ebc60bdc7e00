//! Doors of a scene: openings in the walls that they lie on, and walls while they are closed.

use crate::base::geometry::Segment;
use crate::compile::context::{Context, Locals, Lowered, symbols::unknown, typed::Typed};
use crate::compile::scene::imports::walls;
use crate::data::geometry;
use crate::model::{Barrier, Bool, Obstacle};
use crate::syntax::ast::{Field, Ident, Value};
use crate::syntax::codes::Code;

/// A door between two walls reaches as near as this to them, m.
const NEAR: f64 = 0.05;
/// Rounding of lengths, m.
const HAIR: f64 = 0.01;

/// A door as written.
pub(crate) struct Door {
    pub(crate) name: Ident,
    pub(crate) segment: Segment,
    pub(crate) closed: bool,
}

/// Whether a door is closed in this world. Conditions of parameters and constants are known before a trial.
pub(crate) fn is_closed(context: &mut Context<'_>, fields: &[Field]) -> Lowered<bool> {
    let mut closed = Ok(false);
    for (k, field) in fields.iter().enumerate() {
        let name = field.name.name.as_str();
        if let Some(first) = fields[..k].iter().find(|before| before.name.name == name) {
            let error = error!(E0202, field.name.span, "`{name}` is set twice");
            closed = context.report(error.related(first.name.span, "first set here"));
        } else if name != "closed" {
            closed =
                context.report(unknown("field", name, field.name.span, Code::E0207, ["closed"].into_iter()));
        } else {
            closed = truth(context, &field.value);
        }
    }
    closed
}

fn truth(context: &mut Context<'_>, value: &Value) -> Lowered<bool> {
    let Value::Plain(expr) = value else {
        return context.report(error!(E0305, value.span(), "`closed` must be a condition";
            hint: "write for example `closed = shut == 1`, where `shut` is a parameter"));
    };
    match context.lower(expr, &Locals::default())? {
        Typed::Truth(Bool::Constant(closed), _) => Ok(closed),
        Typed::Truth(..) => context
            .report(error!(E0405, expr.span, "a door must be known to be open or closed before a trial";
            hint: "write a condition of parameters: `closed = shut == 1`")),
        found => context.mismatch(expr.span, "a condition", &found),
    }
}

/// Opens the walls on which doors lie, and puts a wall into each door that is closed.
pub(crate) fn set(context: &mut Context<'_>, doors: &[Door]) {
    for Door { name, segment, closed } in doors {
        let touches =
            |end| context.scene.barriers.iter().any(|barrier| barrier.obstacle.distance(end) <= NEAR);
        let is_between = touches(segment.a) && touches(segment.b);
        let opened = geometry::open_at(&mut walls(&mut context.scene.barriers), segment);
        let width = segment.length();
        let text = &name.name;
        if opened <= HAIR && !is_between {
            let error = error!(E0401, name.span, "the door `{text}` lies on no wall";
                hint: "both of its ends must lie on one straight wall, or reach the walls beside it");
            context.note(error);
        } else if opened > HAIR && opened < width - HAIR {
            let error = error!(E0401, name.span, "the door `{text}` is {width:.2} m wide, and its wall has {opened:.2} m there";
                hint: "move its ends onto the wall");
            context.note(error);
        }
        if *closed {
            let obstacle = Obstacle::Wall(vec![*segment]);
            context.scene.barriers.push(Barrier { name: text.clone(), obstacle });
        }
    }
}
