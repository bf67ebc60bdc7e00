//! Rooms and doors of floor plans by the names that their files give them: `plan.foyer`, `plan["Room 12"]`.

use crate::compile::context::levels;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    plans::PlanPart,
    symbols::{Meaning, unknown},
    typed::Typed,
};
use crate::compile::lower::storeys;
use crate::model::{Line, LineId, Region, RegionId};
use crate::syntax::ast::{Expr, ExprKind};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// The floor plan that an expression names.
pub(crate) fn named(context: &Context<'_>, base: &Expr, locals: &Locals) -> Option<usize> {
    let on_level = storeys::member(context, base, locals);
    let name = match (&base.kind, &on_level) {
        (_, Some(full)) => full,
        (ExprKind::Name(name), None) => name,
        _ => return None,
    };
    let full = levels::on_level(context, name);
    match context.look_up(full.as_ref().unwrap_or(name), locals.scope) {
        Some((_, Meaning::Plan(plan))) if locals.names.iter().all(|(bound, _)| bound != name) => Some(plan),
        _ => None,
    }
}

/// A part of a floor plan. Only parts that are used become regions and lines of the scene.
pub(crate) fn part(context: &mut Context<'_>, plan: usize, name: &str, span: Span) -> Lowered<Typed> {
    let Some(plan) = context.plans.get(plan) else { return Err(Reported) };
    let Some(parts) = &plan.parts else {
        // The file could not be read, which was told, or is read later.
        if context.sink.failed() {
            return Err(Reported);
        }
        let error = error!(E0205, span, "the floor plan `{}` is imported later", plan.name;
            hint: "import it in the first `scene`");
        return context.report(error);
    };
    let mut found = parts.iter().filter(|(known, _)| known == name).map(|(_, part)| part);
    let Some(part) = found.next() else {
        let known = parts.iter().map(|(known, _)| known.as_str());
        let error = unknown("room or door", name, span, Code::E0201, known);
        return context.report(if parts.is_empty() {
            error.hint("the file names none: give its features the property `name`")
        } else {
            error
        });
    };
    if found.next().is_some() {
        let count = 2 + found.count();
        let error = error!(E0202, span, "the floor plan has {count} parts that are called `{name}`";
            hint: "import fewer features (`where level == \"0\"`), or rename them in the file");
        return context.report(error);
    }
    let is_plain = |c: char| c.is_alphanumeric() || c == '_';
    let is_word = name.chars().all(is_plain) && !name.starts_with(|c: char| c.is_numeric());
    let text = if is_word { format!("{}.{name}", plan.name) } else { format!("{}[\"{name}\"]", plan.name) };
    match part.clone() {
        PlanPart::Room(shape) => {
            let known = context.scene.regions.iter().position(|region| region.name == text);
            let id = known.unwrap_or_else(|| {
                context.shapes.push(Some(Ok(shape.clone())));
                context.scene.regions.push(Region::new(text, shape));
                context.scene.regions.len() - 1
            });
            Ok(Typed::Region(RegionId(id as u32)))
        }
        PlanPart::Door(segment) => {
            let known = context.scene.lines.iter().position(|line| line.name == text);
            let id = known.unwrap_or_else(|| {
                context.scene.lines.push(Line { name: text, segment });
                context.scene.lines.len() - 1
            });
            Ok(Typed::Line(LineId(id as u32)))
        }
    }
}
