//! Periodic scenes: the range along an axis after which the plane begins again, what must lie in it, and what cannot be there.

use crate::base::geometry::Vec2;
use crate::compile::context::{Context, Locals, Lowered};
use crate::compile::dimension::Dimension;
use crate::compile::lower::shapes;
use crate::model::{Barrier, Obstacle, Period};
use crate::syntax::ast::{Expr, Ident, Item, ScenarioFile, SceneItem};
use crate::syntax::source::Span;

/// The shortest period, m: in a shorter one images of one person would be within reach of each other (cells of Voronoi
/// densities, bodies of large groups).
const SHORTEST: f64 = 3.0;

/// Coordinates are smaller than this, m.
const FARTHEST: f64 = 1e7;

/// Settles the periods of a scene, before anything that must lie within them.
pub(crate) fn settle_periods<'a>(context: &mut Context<'a>, file: &'a ScenarioFile) {
    let items = file.items.iter().filter_map(|item| match item {
        Item::Scene(items) => Some(items),
        _ => None,
    });
    for item in items.flatten() {
        if let SceneItem::Periodic { axis, ends, span } = item
            && period(context, axis, ends, *span).is_err()
        {
            // Whatever it should be, all lies in it.
            let all = Period { low: -FARTHEST, length: 2.0 * FARTHEST };
            context.scene.periods.x = context.scene.periods.x.or(Some(all));
        }
    }
}

fn period(context: &mut Context<'_>, axis: &Ident, ends: &[Expr; 2], span: Span) -> Lowered<()> {
    let example = "write for example `periodic x in 0 m .. 20 m`";
    let coordinate = |this: &mut Context<'_>, end: &Expr| {
        let number = this.number_of(end, Dimension::LENGTH, &Locals::default())?;
        shapes::in_reach(this, end.span, Vec2::new(number.value, 0.0)).map(|place| place.x)
    };
    let (low, high) = (coordinate(context, &ends[0]), coordinate(context, &ends[1]));
    if !["x", "y"].contains(&axis.name.as_str()) {
        let text = format!("a scene is periodic along `x` or `y` (got `{}`)", axis.name);
        return context.report(error!(E0410, axis.span, "{text}"; hint: "{example}"));
    }
    let (low, high) = (low?, high?);
    let period = Period { low, length: high - low };
    let wrong = if period.length <= 0.0 {
        Some(format!(
            "the range of a period must ascend (got {} .. {})",
            shapes::metres(low),
            shapes::metres(high)
        ))
    } else if period.length < SHORTEST {
        Some(format!("a period must be at least {SHORTEST} m long (got {})", shapes::metres(period.length)))
    } else {
        None
    };
    if let Some(text) = wrong {
        let range = ends[0].span.to(ends[1].span);
        return context.report(error!(E0410, range, "{text}"; hint: "{example}"));
    }
    let periods = &mut context.scene.periods;
    let known = if axis.name == "x" { &mut periods.x } else { &mut periods.y };
    if known.is_some() {
        let text = format!("the period along `{}` is declared twice", axis.name);
        return context.report(error!(E0410, span, "{text}"; hint: "remove one of them"));
    }
    *known = Some(period);
    Ok(())
}

/// Refuses barriers of imports outside of the scene.
pub(crate) fn check_imported(context: &mut Context<'_>, items: &[SceneItem], first: usize) {
    let import = items.iter().find_map(|item| match item {
        SceneItem::Import { span, .. } => Some(*span),
        _ => None,
    });
    let (Some(span), false) = (import, context.scene.periods.are_none()) else { return };
    let corners: Vec<Vec2> = context.scene.barriers[first..].iter().flat_map(corners).collect();
    for corner in corners {
        if shapes::in_scene(context, span, corner).is_err() {
            return;
        }
    }
}

/// Refuses what a periodic scene cannot have.
pub(crate) fn refuse_if_periodic(
    context: &mut Context<'_>,
    span: Span,
    what: &str,
    hint: &str,
) -> Lowered<()> {
    if context.scene.periods.are_none() {
        return Ok(());
    }
    let text = format!("{what} are not available in a periodic scene");
    context.report(error!(E0410, span, "{text}"; hint: "{hint}"))
}

/// Corners of a rectangle around a barrier.
fn corners(barrier: &Barrier) -> Vec<Vec2> {
    match &barrier.obstacle {
        Obstacle::Wall(segments) => segments.iter().flat_map(|segment| [segment.a, segment.b]).collect(),
        Obstacle::Solid(shape) => vec![shape.bounds().low, shape.bounds().high],
    }
}
