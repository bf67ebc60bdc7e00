//! States of behaviours: what they change, and how they end.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    conducts::{lets, states},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    call,
    laws::{self, distribution},
    modes, name,
};
use crate::compile::people::{refused, routes};
use crate::compile::process::timing;

use crate::model::process::wrong_weights;
use crate::model::{Amount, Bool, Conduct, Law, Mode, Num, Parameter, Transition, Trigger, VariableId};
use crate::syntax::ast::process::{BehaviourDecl, BehaviourItem, Choice, StateDecl};
use crate::syntax::ast::{Field, LetDecl, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a behaviour does.
pub(crate) fn conduct<'a>(
    context: &mut Context<'a>,
    decl: &'a BehaviourDecl,
    locals: &Locals,
    variables: usize,
) -> Lowered<Conduct> {
    let mut out = Conduct::default();
    let mut guards = 0;
    let mut failed = check_lets(context, decl, locals, variables).err();
    let names = states(decl).map(|state| state.name.name.as_str());
    // Of a name that is declared twice the first state.
    let numbers: BTreeMap<&str, u32> = names.zip(0..).collect::<Vec<_>>().into_iter().rev().collect();
    for state in states(decl) {
        match mode(context, &numbers, state, locals, variables, &mut guards) {
            Ok(mode) => out.states.push(mode),
            Err(reported) => failed = Some(reported),
        }
    }
    for item in &decl.items {
        if let BehaviourItem::On(on) = item {
            match choices(context, &on.choices, on.span, locals, |name| name == "follow") {
                Ok(choices) => out.advice = choices,
                Err(reported) => failed = Some(reported),
            }
        }
    }
    failed.map_or(Ok(out), Err)
}

/// The conditions of all transitions, in order of writing.
pub(crate) fn conditions<'a>(
    context: &mut Context<'a>,
    decl: &'a BehaviourDecl,
    locals: &Locals,
) -> Lowered<Vec<Bool>> {
    let written: Vec<_> =
        states(decl).flat_map(|state| &state.transitions).filter_map(|t| t.guard.as_ref()).collect();
    if written.is_empty() {
        return Ok(Vec::new());
    }
    let lowered: Vec<Lowered<Bool>> = written
        .into_iter()
        .map(|guard| {
            let typed = context.lower(guard, locals)?;
            context.as_truth(typed, guard.span)
        })
        .collect();
    lowered.into_iter().collect()
}

/// Checks the names that the behaviour declares.
fn check_lets<'a>(
    context: &mut Context<'a>,
    decl: &'a BehaviourDecl,
    locals: &Locals,
    variables: usize,
) -> Lowered<()> {
    let mut failed = None;
    for found in lets(decl) {
        let (before, failures) = (context.sink.diagnostics.len(), context.names.failures());
        let mut lowered = check_let(context, decl, found, &with_own(context, locals, variables));
        // A condition sees no own parameters: what they hide is sound where it is used by conditions only.
        if lowered.is_err() {
            let said = context.sink.diagnostics.split_off(before);
            let forgotten = context.names.forget_failures(&failures);
            lowered = check_let(context, decl, found, locals);
            if lowered.is_err() {
                let _ = context.names.forget_failures(&failures);
                context.names.recall(forgotten);
                context.sink.diagnostics.truncate(before);
                context.sink.diagnostics.extend(said);
            }
        }
        failed = lowered.err().or(failed);
    }
    failed.map_or(Ok(()), Err)
}

/// One name that the behaviour declares; one that is declared twice is seen by its first declaration.
fn check_let<'a>(
    context: &mut Context<'a>,
    decl: &'a BehaviourDecl,
    found: &'a LetDecl,
    locals: &Locals,
) -> Lowered<()> {
    let first = lets(decl).find(|first| first.name.name == found.name.name);
    let is_first = first.is_some_and(|first| first.name.span == found.name.span);
    if found.arguments.is_empty() && is_first {
        let lowered = name::lower_inside_behaviour(context, &found.name.name, found.name.span, locals);
        return lowered.map_or(Ok(()), |lowered| lowered.map(|_| ()));
    }
    let before = context.sink.diagnostics.len();
    call::look_into(context, found, locals);
    if context.sink.diagnostics.len() > before { Err(Reported) } else { Ok(()) }
}

fn mode<'a>(
    context: &mut Context<'a>,
    numbers: &BTreeMap<&str, u32>,
    state: &'a StateDecl,
    locals: &Locals,
    variables: usize,
    guards: &mut u32,
) -> Lowered<Mode> {
    let mut mode = Mode::default();
    let mut failed = None;
    for field in &state.fields {
        let lowered = match Parameter::changeable_of(&field.name.name) {
            None if field.name.name != "route" => {
                refused::look_at(context, &field.value, &with_own(context, locals, variables));
                Err(Reported)
            }
            None => routes::route(context, &field.value, locals).map(|route| mode.route = Some(route)),
            Some(parameter) => amount(context, parameter, field, locals, variables)
                .map(|amount| mode.changes.push((parameter, amount))),
        };
        failed = lowered.err().or(failed);
    }
    for transition in &state.transitions {
        let trigger = match &transition.after {
            Some(after) => timing::lower_delay(context, after, locals).map(Trigger::After),
            None => {
                *guards += 1;
                Ok(Trigger::When(*guards - 1))
            }
        };
        let number = |name: &str| numbers.get(name).copied().unwrap_or(0);
        let targets = choices(context, &transition.targets, transition.span, locals, number);
        match (trigger, targets) {
            (Ok(trigger), Ok(targets)) => mode.transitions.push(Transition { trigger, targets }),
            (Err(reported), _) | (_, Err(reported)) => failed = Some(reported),
        }
    }
    failed.map_or(Ok(mode), Err)
}

/// The value of a parameter while a state lasts.
fn amount<'a>(
    context: &mut Context<'a>,
    parameter: Parameter,
    field: &'a Field,
    locals: &Locals,
    variables: usize,
) -> Lowered<Amount> {
    let name = parameter.name();
    let dimension = parameter.description().dimension;
    let span = field.value.span();
    let expr = match &field.value {
        Value::Plain(expr) if distribution(expr).is_none() => expr,
        other => {
            let law = laws::law(context, other, dimension, locals)?;
            return match parameter.refuses(&law) {
                Some(reason) => context.report(error!(E0405, span, "{reason}")),
                None => Ok(Amount::Drawn(law)),
            };
        }
    };
    let typed = context.lower(expr, &with_own(context, locals, variables))?;
    let (value, found) = context.as_num(typed, span)?;
    if found != dimension {
        return context.wrong_dimension(span, dimension, found);
    }
    match value {
        Num::Constant(value) if !parameter.allows(value) => context.report(Diagnostic::error(
            Code::E0405,
            span,
            parameter.refuses(&Law::Constant(value)).unwrap_or_else(|| format!("`{name}` cannot be {value}")),
        )),
        value if value.reads(&mut BTreeSet::new()) => Ok(Amount::Computed(value)),
        _ => context
            .report(error!(E0304, span, "a value set by a state cannot depend on the movement of agents";
                    hint: "use constants, the agent's own parameters and processes")),
    }
}

/// Weighted choices; the weights depend on nothing but processes.
fn choices<'a, T>(
    context: &mut Context<'a>,
    choices: &'a [Choice],
    span: Span,
    locals: &Locals,
    what: impl Fn(&str) -> T,
) -> Lowered<Vec<(Num, T)>> {
    let weights: Vec<_> = choices.iter().map(|choice| weight_of(context, choice, locals)).collect();
    let weights = weights.into_iter().collect::<Lowered<Vec<Num>>>()?;
    let targets = choices.iter().map(|choice| what(&choice.target.name));
    let out: Vec<_> = weights.into_iter().zip(targets).collect();
    let known: Option<Vec<f64>> =
        out.iter().map(|(w, _)| if let Num::Constant(w) = w { Some(*w) } else { None }).collect();
    if let Some(wrong) = known.and_then(|known| wrong_weights(&known)) {
        let error = error!(E0902, span, "{wrong}");
        return context.report(match context.conducts.attached_at {
            Some(with) => error.related(with, "with these arguments"),
            None => error,
        });
    }
    Ok(out)
}

/// The agent's own parameters, which the arguments and names of the behaviour hide, and names that see them.
fn with_own(context: &Context<'_>, locals: &Locals, variables: usize) -> Locals {
    let own = Parameter::changeable().map(|own| {
        let value = Num::Variable(VariableId((variables + own as usize) as u32));
        (own.name().to_owned(), Some(Arc::new(Typed::Num(value, own.description().dimension))))
    });
    let own = own.filter(|(name, _)| !modes::is_inside(context, name, locals));
    let names: Vec<_> = own.chain(locals.names.iter().cloned()).collect();
    let behaviour = locals.behaviour.map(|(at, _)| (at, names.len()));
    Locals { names, behaviour, ..locals.clone() }
}

/// The weight of one of several choices.
fn weight_of(context: &mut Context<'_>, choice: &Choice, locals: &Locals) -> Lowered<Num> {
    let Some(weight) = &choice.weight else { return Ok(Num::Constant(1.0)) };
    let typed = context.lower(weight, locals)?;
    let (num, dimension) = context.as_num(typed, weight.span)?;
    if !dimension.is_none() {
        return context.wrong_dimension(weight.span, Dimension::NONE, dimension);
    }
    if !num.reads(&mut BTreeSet::new()) {
        let said = "these probabilities cannot depend on the movement of agents";
        return context.report(error!(E0304, weight.span, "{said}";
                hint: "use `when` conditions, or several states"));
    }
    Ok(num)
}
