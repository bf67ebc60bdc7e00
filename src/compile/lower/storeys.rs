//! Names and places of levels in expressions: `ground.exit`, `first (3, 4)`, `a in first`.

use crate::base::geometry::Vec2;
use crate::compile::context::{Context, Locals, Lowered, levels, number::Number, typed::Typed};
use crate::model::storeys::APART;
use crate::model::{self, Bool, Comparison, Num, Storeys, Who};
use crate::syntax::ast::{Expr, ExprKind};
use crate::syntax::source::Span;

/// A place on a level, from its coordinates there.
pub(crate) fn place_on(
    context: &mut Context<'_>,
    level: usize,
    span: Span,
    (place, (x, y)): (Vec2, (Number, Number)),
) -> Lowered<Typed> {
    let name = context.levels.all[level].name.clone();
    if context.levels.frame == Some(level) {
        return Ok(Typed::Point(x, y));
    }
    let island = context.scene.storeys.islands.iter().find(|island| island.name == name);
    let Some(island) = island else {
        return context.report(error!(E0205, span, "a place on another level is not known here"));
    };
    if island.origin == Vec2::zeros() {
        return Ok(Typed::Point(x, y));
    }
    let place = place + island.origin;
    if island.bounds.distance(place) > 0.45 * APART {
        return context.report(error!(E0412, span, "this place lies outside of the level `{name}`";
            hint: "a level reaches 9 m beyond its walls, regions and points: declare a region around the place"));
    }
    Ok(Typed::point(place))
}

/// The full name of a member of a level: `ground.exit`.
pub(crate) fn member(context: &Context<'_>, expr: &Expr, locals: &Locals) -> Option<String> {
    let ExprKind::Member(base, member) = &expr.kind else { return None };
    let ExprKind::Name(level) = &base.kind else { return None };
    let is_bound = locals.names.iter().any(|(bound, _)| bound == level);
    levels::level(context, level).filter(|_| !is_bound)?;
    Some(format!("{level}.{}", member.name))
}

/// The number, among the islands, of the level that an expression names.
pub(crate) fn level_of(context: &Context<'_>, expr: &Expr, locals: &Locals) -> Option<usize> {
    let ExprKind::Name(name) = &expr.kind else { return None };
    let is_bound = locals.names.iter().any(|(bound, _)| bound == name);
    levels::level(context, name).filter(|_| !is_bound)?;
    context.scene.storeys.islands.iter().position(|island| island.name == *name)
}

/// Whether somebody is on a level.
pub(crate) fn is_on(who: Who, level: usize) -> Bool {
    let number = Num::Of(model::Field::Storey, who);
    Bool::Compare(Comparison::Equal, Box::new(number), Box::new(Num::Constant(level as f64)))
}

/// The coordinates of a place known beforehand on its own level: as written where that lies in the origin.
pub(crate) fn own_coordinates(storeys: &Storeys, (x, y): (Number, Number)) -> (Number, Number) {
    let local = storeys.local(Vec2::new(x.value, y.value));
    match local.filter(|(island, _)| island.origin != Vec2::zeros()) {
        Some((_, own)) => (Number::rounded(own.x, x.dimension), Number::rounded(own.y, y.dimension)),
        None => (x, y),
    }
}
