//! Kinds of agents: parameters inherited, preset, overridden.

use crate::compile::context::dependence::Meant;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    kind::{FIELDS, Kind, Planning},
    symbols::{Meaning, unknown},
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::choices;
use crate::compile::lower::laws;
use crate::compile::people::{planners, refused, stepping};
use crate::compile::presets::{PRESETS, Preset, law};
use crate::compile::scene::periodic;
use crate::model::{self, Body, Law, Parameter, Planner, Stepper};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, KindDecl, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic};
use crate::syntax::source::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The field that says how an agent finds its way, and its values; the first one is the default.
const WAYFINDING: &str = "wayfinding";
const WAYS: [&str; 2] = ["shortest", "straight"];

/// The field of the time that somebody stands before they set out.
const PREMOVEMENT: &str = "premovement";
/// The field of the speed on stairs.
const STAIRS: &str = "stairs";

/// The fields of a kind that are no parameters, but for its `premovement`.
fn fields_of(kind: model::Kind) -> &'static [&'static str] {
    match kind {
        model::Kind::Sfm | model::Kind::Cfs => &[WAYFINDING],
        model::Kind::Planned => &FIELDS,
        model::Kind::Stepped => &["gait", "search"],
    }
}

/// Some law of a parameter.
fn any_law(parameter: Parameter) -> Option<Law> {
    let preset = PRESETS.iter().find_map(|preset| law(preset.name, parameter));
    // A value that all parameters of plans may have.
    preset.or_else(|| parameter.allows(2.0).then_some(Law::Constant(2.0)))
}

/// The parameters of a kind by name.
pub(crate) fn kind(context: &mut Context<'_>, name: &Ident) -> Lowered<Kind> {
    if let Some(base) = model::Kind::named(&name.name) {
        return Ok(Kind { base, ..Kind::default() });
    }
    let Some((_, meaning)) = context.look_up(&name.name, 0) else {
        let looked_at = if context.sink.looks_for_names() { usize::MAX } else { 0 };
        let declared = context.names.scopes[0]
            .entries()
            .take(looked_at)
            .filter(|(_, e)| matches!(e.meaning, Meaning::Kind(_)))
            .map(|(n, _)| n);
        let error = unknown(
            "kind",
            &name.name,
            name.span,
            Code::E0208,
            declared.chain(model::Kind::ALL.map(model::Kind::name)),
        );
        return context.report(error);
    };
    let Meaning::Kind(decl) = meaning else {
        if matches!(meaning, Meaning::Doubtful) {
            return Err(Reported);
        }
        return context.report(error!(
            E0206,
            name.span,
            "expected a kind, but `{}` is {}",
            name.name,
            meaning.noun()
        ));
    };
    if context.names.expanding.iter().any(|(_, n)| *n == name.name) {
        if context.names.circles.contains(&name.name) {
            return Err(Reported);
        }
        context.names.circles.extend(context.names.expanding.iter().map(|(_, n)| n.clone()));
        return context.report(
            error!(E0205, name.span, "the kind `{}` depends on itself", name.name).about(About::Circle),
        );
    }
    if let Some(known) = context.kinds.get(&name.name) {
        return known.clone();
    }
    context.expand_further(name.span)?;
    context.names.expanding.push((0, name.name.clone()));
    let kind = own_kind(context, decl);
    context.names.expanding.pop();
    context.kinds.insert(name.name.clone(), kind.clone());
    kind
}

/// The parameters of a kind as it is declared.
pub(crate) fn own_kind(context: &mut Context<'_>, decl: &KindDecl) -> Lowered<Kind> {
    // What the call chooses may lack a field, which is left out then.
    let checked = if decl.is_replaced { &[] } else { decl.body.as_slice() };
    let preset = decl.preset.as_ref().map(|written| preset(context, written, checked));
    let mut kind = match (&decl.base, &preset) {
        (Some(base), _) => kind(context, base),
        (None, Some(Ok(preset))) => Ok(Kind { base: preset.model, ..Kind::default() }),
        (None, _) => Err(Reported),
    };
    let mut is_wrong = false;
    match (preset, &mut kind) {
        (Some(Ok(preset)), Ok(kind)) => {
            context.roster.presets.insert(preset.name);
            let is_forced = |model| model::Kind::FORCED.contains(&model);
            if preset.model == kind.base || is_forced(preset.model) && is_forced(kind.base) {
                for parameter in Parameter::of_kind(kind.base) {
                    if let Some(law) = law(preset.name, parameter) {
                        kind.laws[parameter as usize] = Some(law);
                    }
                }
            } else {
                let (written, name) = (decl.preset.as_ref().unwrap_or(&decl.name), &decl.name.name);
                let (own, of) = (preset.model.name(), kind.base.name());
                context.note(
                    error!(E0208, written.span, "`{}` is a preset of `{own}`, not of `{of}`", preset.name;
                    hint: "leave the model out: `kind {name}: preset {}`", written.name),
                );
                is_wrong = true;
            }
        }
        (Some(Err(Reported)), _) => is_wrong = true,
        _ => {}
    }
    if is_wrong {
        kind = Err(Reported);
    }
    let base = kind.as_ref().map(|kind| kind.base).unwrap_or_default();
    let rest = parameters(context, &decl.body, kind.as_mut().ok(), &Locals::default());
    for field in rest {
        if decl.is_replaced && Parameter::named(&field.name.name).is_some() {
            let name = &field.name.name;
            let said = format!("`{name}` is left out: `{}` has no such parameter", base.name());
            context.note(Diagnostic::warning(Code::W0804, field.name.span, said));
            continue;
        }
        let known = Parameter::of_kind(base).map(Parameter::name).chain(fields_of(base).iter().copied());
        let known = known.chain([PREMOVEMENT, STAIRS]);
        let error = unknown("parameter", &field.name.name, field.name.span, Code::E0207, known);
        context.note(error);
        // The words of a field that other kinds have are no names.
        let name = field.name.name.as_str();
        if model::Kind::ALL.iter().all(|kind| !fields_of(*kind).contains(&name)) {
            refused::look_at(context, &field.value, &Locals::default());
        }
        kind = Err(Reported);
    }
    kind
}

/// Takes the parameters among some fields into a kind; returns the other fields.
pub(crate) fn parameters<'f>(
    context: &mut Context<'_>,
    fields: impl IntoIterator<Item = &'f Field>,
    mut kind: Option<&mut Kind>,
    locals: &Locals,
) -> Vec<&'f Field> {
    let mut rest = Vec::new();
    let mut set: BTreeMap<&str, &Field> = BTreeMap::new();
    for field in fields {
        let first = *set.entry(&field.name.name).or_insert(field);
        if !std::ptr::eq(first, field) {
            let error = error!(E0202, field.name.span, "`{}` is set twice", field.name.name)
                .related(first.name.span, "first set here");
            context.note(error);
            continue;
        }
        let base = kind.as_ref().map(|kind| kind.base).unwrap_or_default();
        if fields_of(base).contains(&field.name.name.as_str()) {
            let taken = match (&mut kind, base) {
                (Some(kind), model::Kind::Planned) => planners::planning(context, field, kind, locals),
                (Some(kind), model::Kind::Stepped) => stepping::stepping(context, field, kind, locals),
                (kind, _) => goes_straight(context, &field.value).map(|straight| {
                    if let Some(kind) = kind {
                        kind.straight = straight;
                    }
                }),
            };
            context.given_up |= taken.is_err();
            continue;
        }
        if field.name.name == PREMOVEMENT {
            let law = laws::waiting(context, &field.value, locals, "a premovement");
            context.given_up |= law.is_err();
            if let (Some(kind), Ok(law)) = (&mut kind, law) {
                kind.premovement = Some(law);
            }
            continue;
        }
        if field.name.name == STAIRS {
            let share = on_stairs(context, &field.value, locals);
            context.given_up |= share.is_err();
            if let (Some(kind), Ok(share)) = (&mut kind, share) {
                kind.stairs = share;
            }
            continue;
        }
        let known = match &kind {
            Some(kind) => kind.parameter(&field.name.name),
            None => Parameter::named(&field.name.name),
        };
        let Some(parameter) = known else {
            rest.push(field);
            continue;
        };
        let law = laws::parameter_law(context, parameter, &field.value, locals);
        context.given_up |= law.is_err();
        context.roster.any_start |= law.is_err() && parameter == Parameter::Radius;
        // What was set wrongly is set: any value will do until it is set right.
        let Some(law) = law.ok().or_else(|| any_law(parameter)) else { continue };
        if let Some(kind) = &mut kind {
            kind.laws[parameter as usize] = Some(law);
        }
    }
    rest
}

/// The share of the speed that the table of stairs has.
fn on_stairs(context: &mut Context<'_>, value: &Value, locals: &Locals) -> Lowered<f64> {
    let Value::Plain(expr) = value else {
        return context.report(error!(E0305, value.span(), "expected a number"));
    };
    let share = context.number_of(expr, Dimension::NONE, locals)?.value;
    if share > 0.0 && share.is_finite() {
        return Ok(share);
    }
    let said = "the share of the speed on stairs must be positive";
    context.report(error!(E0305, expr.span, "{said}"; hint: "write for example `stairs = 0.8`"))
}

/// The body of a kind: every parameter must be known now.
pub(crate) fn body(context: &mut Context<'_>, kind: &Kind, name: &Ident) -> Lowered<Body> {
    if matches!(kind.base, model::Kind::Planned | model::Kind::Stepped) {
        periodic::refuse_if_periodic(
            context,
            name.span,
            "walkers that plan or step",
            "use a kind that starts from `sfm` or `cfs`",
        )?;
        let refused = match kind.planning.roadmap {
            _ if kind.base == model::Kind::Stepped => Some("walkers that step"),
            model::RoadmapRule::Rrt { .. } => Some("walkers with a tree as their roadmap"),
            model::RoadmapRule::Prm { .. } => None,
        };
        if let Some(who) = refused.filter(|_| !context.scene.storeys.are_none()) {
            return context.report(error!(E0412, name.span, "{who} cannot be in a scene with levels";
                hint: "use a kind that starts from `sfm` or `cfs`, or one that plans with `roadmap = prm(…)`"));
        }
    }
    let missing = Parameter::of_kind(kind.base).filter(|parameter| kind.law(*parameter).is_none());
    // A preferred speed follows from the largest one.
    let follows = |parameter: &Parameter| kind.base == model::Kind::Planned && *parameter == Parameter::Speed;
    let missing: Vec<&str> = missing.filter(|parameter| !follows(parameter)).map(Parameter::name).collect();
    if !missing.is_empty() {
        let title = format!("`{}` has no {}", name.name, missing.join(", "));
        // Said once, however many are of that kind.
        if context.sink.diagnostics.iter().any(|d| d.code == Code::E0209 && d.title == title) {
            return Err(Reported);
        }
        let hint = if kind.base == model::Kind::Planned {
            "write for example `limit speed = 1.5 m/s` in the kind"
        } else {
            "set the values, or start from a preset: `kind adult: sfm preset smc1 { … }`"
        };
        return context.report(error!(E0209, name.span, "{title}"; hint: "{hint}"));
    }
    let mut body = Body::new(kind.base, |parameter| {
        // A parameter that the kind does not have: 0 where it may be.
        let neutral = [0.0, 1.0, 2.0].into_iter().find(|value| parameter.allows(*value));
        kind.law(parameter).unwrap_or(Law::Constant(neutral.unwrap_or_default()))
    });
    let is_planned = kind.base == model::Kind::Planned;
    body.finds_ways = !kind.straight && matches!(kind.base, model::Kind::Sfm | model::Kind::Cfs);
    body.premovement.clone_from(&kind.premovement);
    body.stairs = kind.stairs;
    body.stepper = (kind.base == model::Kind::Stepped).then(|| {
        let sets_speed = kind.laws[Parameter::Speed as usize].is_some();
        Arc::new(Stepper { gait: kind.gait.clone(), search: kind.search, sets_speed })
    });
    let Planning { roadmap, clearance, profile, rounding, reciprocal } = kind.planning.clone();
    body.planner = is_planned.then(|| {
        let speed_follows = kind.laws[Parameter::Speed as usize].is_none();
        let kind = name.name.clone();
        Arc::new(Planner { kind, roadmap, clearance, profile, rounding, reciprocal, speed_follows })
    });
    Ok(body)
}

/// The bodies of the declared kinds that have all parameters, by name. To be called when all errors were taken: it notes
/// what the other kinds lack, which is no error of a kind that no agent has.
pub(crate) fn bodies(context: &mut Context<'_>) -> BTreeMap<String, Body> {
    let known = std::mem::take(&mut context.kinds).into_iter();
    let complete = known.filter_map(|(name, kind)| {
        let ident = Ident { name, span: Span::default() };
        let body = body(context, &kind.ok()?, &ident).ok()?;
        Some((ident.name, body))
    });
    complete.collect()
}

/// The value of the field that says how an agent finds its way.
fn goes_straight(context: &mut Context<'_>, value: &Value) -> Lowered<bool> {
    let name = match value {
        Value::Plain(Expr { kind: ExprKind::Name(name), .. }) => Some(name.as_str()),
        _ => None,
    };
    let known = name.and_then(|name| WAYS.iter().position(|way| *way == name));
    if known.is_none() {
        let said = "`wayfinding` must be `shortest` or `straight`";
        return context.report(error!(E0305, value.span(), "{said}";
                hint: "write `wayfinding = straight` for agents that go straight for their goals whatever is in the way"));
    }
    Ok(known == Some(1))
}

/// The preset of a name, which may be that of a parameter that chooses one: then each of its list must have the fields of the
/// kind.
fn preset(context: &mut Context<'_>, written: &Ident, body: &[Field]) -> Lowered<&'static Preset> {
    let Some((chosen, choices)) = choices::chosen(context, written) else {
        return known(context, written);
    };
    context.names.uses.insert(written.span, Meant::Parameter);
    context.names.chosen_by.push(written.name.clone());
    let mut all = Vec::new();
    for choice in choices {
        all.push(known(context, choice));
    }
    for preset in all.iter().flatten() {
        let lacks = |field: &&Field| {
            let name = field.name.name.as_str();
            let is_of = |model| {
                fields_of(model).contains(&name) || Parameter::of_kind(model).any(|own| own.name() == name)
            };
            !is_of(preset.model) && model::Kind::ALL.into_iter().any(is_of)
        };
        if let Some(field) = body.iter().find(lacks) {
            let (name, model) = (&field.name.name, preset.model.name());
            let error =
                error!(E0207, field.name.span, "`{}`, a preset of `{model}`, has no `{name}`", preset.name);
            return context.report(
                error.formal().hint(format!(
                    "remove `{name}`, or `{}` from the list of `{}`",
                    preset.name, written.name
                )),
            );
        }
    }
    let at = choices.iter().position(|choice| std::ptr::eq(choice, chosen)).unwrap_or(0);
    all.swap_remove(at)
}

/// The preset of this name.
fn known(context: &mut Context<'_>, written: &Ident) -> Lowered<&'static Preset> {
    if let Some(preset) = PRESETS.iter().find(|preset| preset.name == written.name) {
        return Ok(preset);
    }
    let names = || PRESETS.iter().map(|preset| preset.name);
    let error = unknown("preset", &written.name, written.span, Code::E0208, names());
    let known = format!("the presets are {}", names().collect::<Vec<_>>().join(", "));
    let error = match error.hint.clone() {
        Some(near) => error.hint(format!("{near} {known}")),
        None => error.hint(known),
    };
    context.report(error)
}
