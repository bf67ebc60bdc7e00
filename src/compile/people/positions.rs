//! Where agents start, and with which velocity.

use crate::base::geometry::Vec2;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    people::People,
    symbols::{Entry, Meaning},
    typed::Typed,
};
use crate::compile::dimension::{Dimension, describe};
use crate::compile::lower::{misspelt, shapes};
use crate::compile::nearest::nearest;
use crate::model::{Position, Start, TOP_SPEED, Who};
use crate::syntax::ast::BinaryOp;
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Value};
use crate::syntax::diagnostic::About;

/// The word before a shape in which an agent starts.
const PLACES: &str = "uniform";

/// `at = unifrom in exit`, which reads as a condition, and with a rectangle as a truncated value: says so, and whether
/// it is so.
pub(crate) fn misread_placement(context: &mut Context<'_>, value: &Value) -> bool {
    let (word, shape) = match value {
        Value::Plain(Expr { kind: ExprKind::Binary(BinaryOp::In, word, region), .. }) => (&**word, &**region),
        Value::Truncated { law, low, .. } => (law, low),
        _ => return false,
    };
    let ExprKind::Name(name) = &word.kind else { return false };
    let locals = Locals::default();
    if nearest(name, std::iter::once(PLACES)).is_none() || misspelt::is_known(context, name, &locals) {
        return false;
    }
    context.note(
        error!(E0201, word.span, "unknown name `{name}`"; hint: "did you mean `{PLACES}`?")
            .about(About::Name(name.clone())),
    );
    match (&shape.kind, value) {
        (ExprKind::Call { arguments, .. }, Value::Truncated { high, .. }) => {
            let _ = context.lower_all(arguments.iter().chain([high]), &locals);
        }
        _ => drop(context.lower(shape, &locals)),
    }
    true
}

pub(crate) fn start(
    context: &mut Context<'_>,
    name: &Ident,
    fields: &[&Field],
    people: &People,
    required: bool,
) -> Lowered<Start> {
    let position = match fields.iter().find(|f| f.name.name == "at") {
        Some(field) if misread_placement(context, &field.value) => Err(Reported),
        Some(field) => start_position(context, name, &field.value, people),
        None if required => context.report(
            error!(E0209, name.span, "`{}` has no `at`", name.name;
                    hint: "write `at = ` with a point, `uniform in` a shape, or `near` another agent")
            .about(About::Start),
        ),
        None => Err(Reported),
    };
    let velocity = match fields.iter().find(|f| f.name.name == "velocity").map(|f| &f.value) {
        Some(Value::Plain(expr)) => velocity_of(context, expr),
        Some(other) => {
            let said = "expected a velocity such as `(1, 0) m/s`";
            context.report(error!(E0305, other.span(), "{said}"))
        }
        None => Ok(Vec2::zeros()),
    };
    Ok(Start { position: position?, velocity: velocity?, ..Start::at_rest(Vec2::zeros()) })
}

fn velocity_of(context: &mut Context<'_>, expr: &Expr) -> Lowered<Vec2> {
    let velocity = match context.lower(expr, &Locals::default())? {
        Typed::Point(x, y) if x.dimension == Dimension::SPEED => Vec2::new(x.value, y.value),
        Typed::Point(x, _) => {
            let found = describe(x.dimension);
            let error = error!(E0303, expr.span, "expected a velocity, found {found}";
                        hint: "write the unit after the parentheses: `(1, 0) m/s`");
            return context.report(error);
        }
        found => return context.mismatch(expr.span, "a velocity such as `(1, 0) m/s`", &found),
    };
    if velocity.norm() > TOP_SPEED {
        let speed = (velocity.norm() * 1e3).round() / 1e3;
        let text =
            format!("the initial speed exceeds {TOP_SPEED} m/s, the limit for a person (got {speed} m/s)");
        return context.report(error!(E0405, expr.span, "{text}";
                hint: "every trial would diverge; write a smaller velocity"));
    }
    Ok(velocity)
}

/// Reports an anchor that is declared later or arrives by a source.
fn declared_before(context: &mut Context<'_>, of: &Ident, agent: &Expr) -> Lowered<()> {
    let whose = if let ExprKind::Index(base, _) = &agent.kind { &**base } else { agent };
    let ExprKind::Name(name) = &whose.kind else { return Ok(()) };
    let Some(Entry { span, meaning: Meaning::Declared }) = context.names.scopes[0].get(name) else {
        return Ok(());
    };
    let (title, hint) = if *span == of.span {
        (format!("`{name}` cannot start near itself"), "start near another agent, or at a place")
    } else if span.start > of.span.start {
        let hint = "an agent must be declared after the agent near which it starts";
        ("the agent is declared later".to_owned(), hint)
    } else {
        // All others that stand before are known.
        let said = format!("agents from source `{name}` are not present at the start");
        (said, "start near an agent, or at a place")
    };
    context.report(error!(E0403, agent.span, "{title}"; hint: "{hint}"))
}

/// The start of who is declared by a name.
pub(crate) fn start_position(
    context: &mut Context<'_>,
    of: &Ident,
    value: &Value,
    people: &People,
) -> Lowered<Position> {
    match value {
        Value::UniformIn(shape) => {
            shapes::lower_shape(context, shape, &Locals::default()).map(Position::Within)
        }
        Value::Near { agent, within } => {
            let distance = match context.number_of(within, Dimension::LENGTH, &Locals::default()) {
                Ok(distance) if distance.value <= 0.0 => {
                    let said = "the distance must be positive";
                    context.report(error!(E0405, within.span, "{said}"))
                }
                far => far
                    .and_then(|d| shapes::in_reach(context, within.span, Vec2::new(d.value, 0.0)).map(|_| d)),
            };
            declared_before(context, of, agent)?;
            let typed = context.lower(agent, &Locals::default())?;
            let Who::Agent(id) = context.as_agent(typed, agent.span)? else { return Err(Reported) };
            let distance = distance?;
            // Who could not be declared stands nowhere; that is said already.
            if context.roster.undeclared.contains(&id) || id.0 as usize >= people.agents.len() {
                return Err(Reported);
            }
            Ok(Position::Near { agent: id, within: distance.value })
        }
        Value::Plain(expr) => match context.lower(expr, &Locals::default())? {
            Typed::Point(x, y) => shapes::place(context, expr.span, (x, y)).map(Position::Point),
            // A region as a start means its inside.
            Typed::Region(id) => shapes::region_shape(context, id, expr.span).map(Position::Within),
            found => context.mismatch(expr.span, "a point, a region or `uniform in` a shape", &found),
        },
        other => context.report(error!(E0305, other.span(), "expected a place to start from")),
    }
}
