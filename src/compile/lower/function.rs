//! Built-in functions of values that are lowered.

use crate::base::geometry::Vec2;
use crate::compile::context::{
    Context, Locals, Lowered, Reported, number::Number, symbols::unknown, typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    convert::coordinates,
    legs, traffic,
    weight::{self, Weight},
};
use crate::logic::Term;
use crate::model::function::{Rule, Signature, Special};
use crate::model::{Arithmetic, Axis, Bool, BuiltIn, Collective, Field, Function, Num, Place, Set};
use crate::syntax::ast::{Expr, ExprKind, Ident};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// `column(a, pulse)`: the number that a recording has of somebody beside the position.
pub(crate) fn column(
    context: &mut Context<'_>,
    (typed, span): (Typed, Span),
    column: &Expr,
) -> Lowered<Typed> {
    let who = context.as_agent(typed, span)?;
    let ExprKind::Name(name) = &column.kind else {
        let error = error!(E0305, column.span, "expected the name of a column of the recording");
        return context.report(error.hint("write it as the table does: `column(user, pulse)`"));
    };
    let Some(known) = &context.tracks.columns else {
        let said = "nobody knows the columns of a recording in a simulated trial";
        let hint = "`smc monitor` and `smc measure --number` read them";
        return context.report(error!(E0715, column.span, "{said}"; hint: "{hint}"));
    };
    let Some(number) = known.iter().position(|one| one == name) else {
        let error = unknown("column", name, column.span, Code::E0715, known.iter().map(String::as_str));
        let hint = if known.is_empty() {
            "the recording has no column of numbers beside the positions".to_owned()
        } else {
            format!("the recording has {}", known.join(", "))
        };
        return context.report(if error.hint.is_some() { error } else { error.hint(hint) });
    };
    Ok(Typed::Num(Num::Of(Field::Column(number as u32), who), Dimension::NONE))
}

/// Functions of one agent, set, region or point.
pub(crate) fn of_one(
    context: &mut Context<'_>,
    built_in: &BuiltIn,
    function: &Ident,
    (typed, span): (Typed, Span),
    area: Option<Number>,
    locals: &Locals,
) -> Lowered<Typed> {
    let special = match (built_in.signature, typed) {
        // Of a set, those of its mean velocity.
        (Signature::Agent(Field::Speed), Typed::Agents { set, particle: false }) => {
            let (x, y) = mean_velocity(&set);
            return Ok(Typed::Num(norm(x, y), built_in.gives()));
        }
        (Signature::Agent(Field::Heading), Typed::Agents { set, particle: false }) => {
            let (x, y) = mean_velocity(&set);
            let angle = Num::Combine(Arithmetic::Atan2, Box::new(y), Box::new(x));
            return Ok(Typed::Num(angle, built_in.gives()));
        }
        (Signature::Agent(field), typed) => {
            return Ok(Typed::Num(Num::Of(field, context.as_agent(typed, span)?), built_in.gives()));
        }
        (Signature::Set(collective), typed) => {
            if collective == Collective::Spread {
                of_one_level(context, span)?;
            }
            return Ok(Typed::Num(Num::OfSet(collective, context.as_set(typed, span)?), built_in.gives()));
        }
        (Signature::Special(special), typed) => (special, typed),
        // The others take numbers, or two agents.
        _ => return Err(Reported),
    };
    Ok(match special {
        (Special::Done, typed) => legs::done(context.as_agent(typed, span)?),
        (Special::Present, typed) => Typed::truth(Bool::Present(context.as_agent(typed, span)?)),
        (Special::Position, Typed::Agents { set, particle: false }) => {
            of_one_level(context, span)?;
            centroid(set)
        }
        (Special::Position, typed) => {
            let (x, y, dimension) = context.as_vector(typed, span)?;
            Typed::Vector(x, y, dimension)
        }
        (Special::Velocity, Typed::Agents { set, particle: false }) => {
            let (x, y) = mean_velocity(&set);
            Typed::Vector(x, y, Dimension::SPEED)
        }
        (Special::Velocity, typed) => {
            let who = context.as_agent(typed, span)?;
            Typed::Vector(Num::Of(Field::VelocityX, who), Num::Of(Field::VelocityY, who), Dimension::SPEED)
        }
        (Special::Component(axis), Typed::Point(x, y)) => Typed::Number(if axis == Axis::X { x } else { y }),
        (Special::Component(axis), typed) => {
            let (x, y, dimension) = context.as_vector(typed, span)?;
            Typed::Num(if axis == Axis::X { x } else { y }, dimension)
        }
        (Special::Norm, Typed::Point(x, y)) => {
            let length = (x.value * x.value + y.value * y.value).sqrt();
            return computed(context, length, x.dimension, built_in.name, span);
        }
        (Special::Norm, typed) => {
            let (x, y, dimension) = context.as_vector(typed, span)?;
            // Each is squared, and so written twice.
            weight::count_copy(context, Weight::of_num(&x), span)?;
            weight::count_copy(context, Weight::of_num(&y), span)?;
            Typed::Num(norm(x, y), dimension)
        }
        (Special::Centroid, typed) => {
            of_one_level(context, span)?;
            centroid(context.as_set(typed, span)?)
        }
        (Special::Members, typed) => Typed::Agents { set: context.as_set(typed, span)?, particle: false },
        (Special::Count, typed) => {
            let set = context.as_set(typed, span)?;
            Typed::Num(Num::Count(set, Box::new(Bool::Constant(true))), built_in.gives())
        }
        (Special::Others, typed) => {
            let who = context.as_agent(typed, span)?;
            let set = Set { members: context.roster.everyone(), except: Some(who) };
            Typed::Agents { set, particle: false }
        }
        (Special::Area, _) => Typed::Number(area.ok_or(Reported)?),
        (Special::Crossings, typed) => {
            let line = traffic::counted_line(context, typed, span)?;
            Typed::Num(Num::Crossings(line, None), built_in.gives())
        }
        (
            special @ (Special::Density
            | Special::LevelOfService
            | Special::MeanSpeed
            | Special::VoronoiDensity),
            typed,
        ) => Typed::Num(
            traffic::of_region(context, special, (typed, span), area.ok_or(Reported)?, locals)?,
            built_in.gives(),
        ),
        _ => {
            let name = built_in.name;
            return context.report(error!(E0305, function.span, "`{name}` needs a set or a time window";
                    hint: "write `{name}(… for a in crowd)` or `{name}<=10 s (…)`"));
        }
    })
}

/// Functions of one number.
pub(crate) fn of_number(
    context: &mut Context<'_>,
    (built_in, apply, takes): (&BuiltIn, Function, Option<Dimension>),
    (typed, span): (Typed, Span),
) -> Lowered<Typed> {
    if let (Typed::Term(term, dimension), Function::Abs) = (&typed, apply) {
        let term = context.term(Term::Abs(*term));
        return Ok(Typed::Term(term, *dimension));
    }
    let known = if let Typed::Number(number) = &typed { Some(*number) } else { None };
    let (num, given) = context.as_num(typed, span)?;
    if let Some(expected) = takes.filter(|expected| *expected != given) {
        return context.wrong_dimension(span, expected, given);
    }
    let dimension = match built_in.dimension {
        Rule::Always(dimension) => dimension,
        Rule::Root => match given.root() {
            Some(root) => root,
            None => {
                return context.report(error!(E0303, span, "the square root of `{given}` has no unit"));
            }
        },
        _ => given,
    };
    match known {
        Some(number) => computed(context, apply.of(number.value), dimension, built_in.name, span),
        None => Ok(Typed::Num(Num::Apply(apply, Box::new(num)), dimension)),
    }
}

/// What a function gives for what is known now: exact where it is whole.
fn computed(
    context: &mut Context<'_>,
    value: f64,
    dimension: Dimension,
    function: &str,
    span: Span,
) -> Lowered<Typed> {
    if !value.is_finite() {
        let text = format!("`{function}` of this value is not finite");
        return context.report(error!(E0405, span, "{text}"));
    }
    let whole = value.fract() == 0.0 && value.abs() < 9e15;
    let exact = whole.then(|| crate::base::decimal::Decimal::whole(value as i64));
    Ok(Typed::Number(Number { value, exact, dimension }))
}

/// Functions of two numbers of one unit.
pub(crate) fn of_two(
    context: &mut Context<'_>,
    built_in: &BuiltIn,
    operator: Arithmetic,
    [(a, left), (b, right)]: [(Typed, Span); 2],
    span: Span,
) -> Lowered<Typed> {
    let known = matches!((&a, &b), (Typed::Number(_), Typed::Number(_)));
    let sides = (context.as_num(a, left), context.as_num(b, right));
    let ((a, da), (b, db)) = (sides.0?, sides.1?);
    if da != db {
        return context.wrong_dimension(right, da, db);
    }
    let dimension = if let Rule::Always(dimension) = built_in.dimension { dimension } else { da };
    if let (true, Num::Constant(a), Num::Constant(b)) = (known, &a, &b) {
        if operator == Arithmetic::Modulo && *b == 0.0 {
            return context.report(error!(E0405, right, "division by zero"));
        }
        return computed(context, operator.of(*a, *b), dimension, built_in.name, span);
    }
    Ok(Typed::Num(Num::Combine(operator, Box::new(a), Box::new(b)), dimension))
}

/// The distance of two places.
pub(crate) fn distance(
    context: &mut Context<'_>,
    [(a, left), (b, right)]: [(Typed, Span); 2],
    span: Span,
) -> Lowered<Typed> {
    if let (Typed::Point(ax, ay), Typed::Point(bx, by)) = (&a, &b)
        && ax.dimension == Dimension::LENGTH
        && bx.dimension == Dimension::LENGTH
    {
        let places = [(ax, ay), (bx, by)].map(|(x, y)| Vec2::new(x.value, y.value));
        let storeys = &context.scene.storeys;
        if storeys.separate(places[0], places[1]) {
            let [a, b] = places.map(|p| storeys.place(p));
            return context
                .report(error!(E0412, span, "{a} and {b} lie on two levels, and have no distance";
                hint: "compare places of one level"));
        }
        let (dx, dy) = (ax.value - bx.value, ay.value - by.value);
        let length = (dx * dx + dy * dy).sqrt();
        return computed(context, length, Dimension::LENGTH, "distance", span);
    }
    let places = (context.as_place(a, left), context.as_place(b, right));
    let (a, b) = (places.0?, places.1?);
    let extended = |p: &Place| matches!(p, Place::Region(_) | Place::Barrier(_));
    if extended(&a) && extended(&b) {
        let said = "one side of a distance must be an agent or a point";
        return context.report(error!(E0305, span, "{said}"));
    }
    Ok(Typed::Num(Num::Distance(a, b), Dimension::LENGTH))
}

/// Whether an agent touches anything, or two touch each other.
pub(crate) fn contact(context: &mut Context<'_>, agents: Vec<(Typed, Span)>) -> Lowered<Typed> {
    let agents: Vec<_> = agents.into_iter().map(|(typed, span)| context.as_agent(typed, span)).collect();
    let agents = agents.into_iter().collect::<Lowered<Vec<_>>>()?;
    Ok(Typed::truth(match agents[..] {
        [one, other] => Bool::Touching(one, other),
        _ => Bool::Contact(agents[0]),
    }))
}

fn mean_velocity(set: &Set) -> (Num, Num) {
    let along = |axis| Num::OfSet(Collective::MeanVelocity(axis), set.clone());
    (along(Axis::X), along(Axis::Y))
}

/// People on several levels have no middle.
fn of_one_level(context: &mut Context<'_>, span: Span) -> Lowered<()> {
    if context.scene.storeys.are_none() {
        return Ok(());
    }
    context.report(error!(E0412, span, "people on several levels have no middle";
        hint: "count them by region: `count(a in people: a in first.hall)`"))
}

fn centroid(set: Set) -> Typed {
    let (x, y) = coordinates(Place::Centroid(set));
    Typed::Vector(x, y, Dimension::LENGTH)
}

/// Length of a vector.
fn norm(x: Num, y: Num) -> Num {
    let square = |n: Num| Num::Combine(Arithmetic::Multiply, Box::new(n.clone()), Box::new(n));
    let sum = Num::Combine(Arithmetic::Add, Box::new(square(x)), Box::new(square(y)));
    Num::Apply(Function::Sqrt, Box::new(sum))
}
