//! Functions: those declared with `let`, and the built-in ones.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    dependence::Meant,
    names::Vain,
    parts::{Frame, Given},
    symbols::{Meaning, Scope, ScopeId, unknown},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    builtin::{CHOICES, DISTRIBUTIONS},
    counted_arguments, function, legs, margins, modes, name, process_names, select, shapes, storeys, traffic,
};
use crate::logic::Term;
use crate::model::function::{Signature, Special};
use crate::model::{BuiltIn, Num};
use crate::syntax::ast::LetDecl;
use crate::syntax::ast::{Expr, ExprKind, Ident};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Label;
use crate::syntax::parse::foreign_word;
use crate::syntax::source::Span;
use std::sync::Arc;

/// The depth to which calls with unknown arguments are followed.
const FOLLOWED: u32 = 400;
/// Most calls that are shown of an error inside functions that call each other.
const MOST_CALLS: usize = 4;

/// A call.
pub(crate) fn lower_call(
    context: &mut Context<'_>,
    expr: &Expr,
    function: &Ident,
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    // `now()` of a name without arguments is the name.
    if arguments.is_empty() && is_named(context, &function.name, locals) {
        return name::lower_name(context, &function.name, function.span, locals);
    }
    if let Some(decl) = process_names::function_inside(context, &function.name, locals) {
        process_names::note_inside(context, function.span);
        return lower_let(context, (0, decl), expr.span, arguments, locals);
    }
    if let Some((decl, inner, path)) = modes::inside_behaviour(context, &function.name, locals)
        && !decl.arguments.is_empty()
    {
        return lower_function(context, decl, (inner, path), expr.span, arguments, locals);
    }
    let found = context.look_up(&function.name, locals.scope);
    if let Some((_, Meaning::Let(decl))) = &found {
        context.names.uses.insert(function.span, Meant::Written(decl.body.span));
    }
    if matches!(found, Some((_, Meaning::Doubtful))) {
        return context.lower_all(arguments, locals).and(Err(Reported));
    }
    if let Some((scope, Meaning::Let(decl))) = found
        && !decl.arguments.is_empty()
    {
        return lower_let(context, (scope, decl), expr.span, arguments, locals);
    }
    if let Some((_, Meaning::Level(level))) = found {
        return place_on_level(context, level, expr.span, arguments, locals);
    }
    if let Some(built_in) = BuiltIn::find(&function.name) {
        return call_built_in(context, built_in, (expr, function), arguments, locals);
    }
    if DISTRIBUTIONS.contains(&function.name.as_str()) {
        return context.report(error!(E0404, expr.span, "the distribution `{}` cannot be part of an expression", function.name;
                hint: "use it as the value of a field or of `after`; it may have a factor: `poisson(4) * (1 s / 3)`"));
    }
    unknown_function(context, function, expr.span, arguments, locals)
}

/// `first (3, 4)`
fn place_on_level(
    context: &mut Context<'_>,
    level: usize,
    span: Span,
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    let [x, y] = arguments else {
        let name = &context.levels.all[level].name;
        let error =
            error!(E0204, span, "a place on `{name}` has two coordinates"; hint: "write `{name} (3, 4)`");
        return context.report(error);
    };
    let kind = ExprKind::Point { x: Box::new(x.clone()), y: Box::new(y.clone()), unit: None };
    let local = context.lower(&Expr { kind, span }, locals)?;
    let Typed::Point(x, y) = local else {
        return context.mismatch(span, "numbers known beforehand", &local);
    };
    let place = shapes::place(context, span, (x, y))?;
    storeys::place_on(context, level, span, (place, (x, y)))
}

fn unknown_function(
    context: &mut Context<'_>,
    function: &Ident,
    span: Span,
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    let name = function.name.as_str();
    context.names.unknowns += 1;
    if context.sink.is_said(Code::E0203, function.span) {
        return Err(Reported);
    }
    // A unit that is misspelt reads as a call, and what follows it is what it is.
    if context.sink.is_said(Code::E0113, function.span) {
        return context.lower_all(arguments, locals).and(Err(Reported));
    }
    if let Some((_, meaning)) = context.look_up(name, locals.scope) {
        let hidden = context.names.scopes[0].get(name).is_some_and(|e| takes_arguments(&e.meaning));
        // That a name of the scenario was taken was said where that was done; and what is wrong with it
        // may be just that it lacks its arguments.
        if !hidden && name::lower_name(context, name, function.span, locals).is_ok() {
            let text = format!("`{name}` is {} and has no arguments", meaning.noun());
            context.note(error!(E0204, span, "{text}"));
        }
        return context.lower_all(arguments, locals).and(Err(Reported));
    }
    if CHOICES.contains(&name) {
        let error = error!(E0203, function.span, "`{name}` is a goal, and has no value";
            hint: "write it in a route, `route = {name}(west, east)`; in formulas use a region of several parts");
        context.note(error);
        return context.lower_all(arguments, locals).and(Err(Reported));
    }
    let mut known: Vec<&str> = BuiltIn::names().chain(DISTRIBUTIONS).chain(CHOICES).collect();
    let declared: Vec<String> = [locals.scope, 0]
        .iter()
        .filter(|_| context.sink.looks_for_names())
        .filter_map(|s| context.names.scopes.get(*s))
        .flat_map(Scope::entries)
        .filter(|(_, e)| takes_arguments(&e.meaning))
        .map(|(n, _)| n.to_owned())
        .collect();
    known.extend(declared.iter().map(String::as_str));
    let error = unknown("function", name, function.span, Code::E0203, known.into_iter());
    let within = arguments.iter().map(|argument| context.text(argument.span)).collect::<Vec<_>>();
    context.note(match foreign_word(name, &within.join(", ")) {
        Some(hint) => error.hint(hint),
        None => error,
    });
    // Whatever it is, its arguments are what they are.
    let _ = context.lower_all(arguments, locals);
    Err(Reported)
}

/// A built-in function, by what the table says that it takes.
fn call_built_in(
    context: &mut Context<'_>,
    built_in: &'static BuiltIn,
    (expr, function): (&Expr, &Ident),
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    let span = expr.span;
    match built_in.signature {
        Signature::Special(Special::Extremum(operator)) => {
            select::enough(context, (span, function), arguments.len())?;
            let places = arguments.iter().map(|argument| argument.span);
            let values = context.lower_all(arguments, locals)?.into_iter().zip(places).collect();
            return select::extremum(context, operator, values);
        }
        Signature::Special(Special::Contact) => {
            margins::note_margin(context, Dimension::LENGTH, span);
            if !matches!(arguments.len(), 1 | 2) {
                return context.arity(function, span, "1 or 2 arguments", (arguments, locals));
            }
            let places = arguments.iter().map(|argument| argument.span);
            let agents = context.lower_all(arguments, locals)?.into_iter().zip(places).collect();
            return function::contact(context, agents);
        }
        Signature::Special(Special::TimeUntil) => {
            return time_until(context, expr, function, arguments, locals);
        }
        Signature::Special(Special::Leg(measure)) if let [agent, number] = arguments => {
            legs::check_allowed(context, built_in, span, locals)?;
            let sides = (context.lower(agent, locals), context.number_of(number, Dimension::NONE, locals));
            let who = context.as_agent(sides.0?, agent.span)?;
            return legs::leg(context, (built_in, measure, span), (who, agent.span), (sides.1?, number.span));
        }
        Signature::Special(Special::Column) if let [agent, column] = arguments => {
            let typed = context.lower(agent, locals)?;
            return function::column(context, (typed, agent.span), column);
        }
        Signature::Special(Special::Flow) if let [line, window] = arguments => {
            let sides = (context.lower(line, locals), context.time(window, locals));
            return traffic::flow(context, built_in, (sides.0?, line.span), (sides.1?, window.span));
        }
        Signature::Special(Special::Robustness) => {
            return context.report(
                error!(E0504, span, "`robustness` is allowed only directly inside `E(…)`, `Q(…)` and `P(…)`";
                    hint: "write `E(robustness(safe)) in -1 m .. 1 m` or `P(robustness(safe) >= 0.2 m)`"),
            );
        }
        _ if !built_in.takes(arguments.len()) => {
            let wanted = counted_arguments(built_in.arguments.0);
            return context.arity(function, span, &wanted, (arguments, locals));
        }
        _ => {}
    }
    match arguments {
        [argument] => {
            let typed = context.lower(argument, locals)?;
            match built_in.signature {
                Signature::Number(apply, takes) => {
                    function::of_number(context, (built_in, apply, takes), (typed, argument.span))
                }
                signature => {
                    let needs_area = matches!(signature, Signature::Special(special) if special.needs_area());
                    let area =
                        if needs_area { Some(shapes::area(context, &typed, argument.span)?) } else { None };
                    function::of_one(context, built_in, function, (typed, argument.span), area, locals)
                }
            }
        }
        [left, right] => {
            let sides = (context.lower(left, locals), context.lower(right, locals));
            let (a, b) = (sides.0?, sides.1?);
            let sides = [(a, left.span), (b, right.span)];
            match built_in.signature {
                Signature::Numbers(operator) => function::of_two(context, built_in, operator, sides, span),
                Signature::Agents(pair) => {
                    let [a, b] = sides.map(|(typed, span)| context.as_agent(typed, span));
                    Ok(Typed::Num(Num::OfTwo(pair, a?, b?), built_in.gives()))
                }
                Signature::Special(Special::Dwell) => traffic::dwell(context, built_in, sides),
                _ => function::distance(context, sides, span),
            }
        }
        [condition, yes, no] => {
            let truth = context.lower(condition, locals);
            let truth = truth.and_then(|typed| context.as_truth(typed, condition.span));
            let sides = (context.lower(yes, locals), context.lower(no, locals));
            select::choice(context, truth?, (sides.0?, yes.span), (sides.1?, no.span))
        }
        _ => context.arity(function, span, "3 arguments", (arguments, locals)),
    }
}

fn time_until(
    context: &mut Context<'_>,
    expr: &Expr,
    function: &Ident,
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    let [formula] = arguments else {
        let given = (arguments, locals);
        return margins::inside_a_formula(context, |this| {
            this.arity(function, expr.span, "1 argument", given)
        });
    };
    if !context.temporal || locals.running > 0 {
        return context.report(error!(E0504, expr.span, "`time_until` is about a trace, but a value of one state is needed here";
                hint: "write it in a metric or a comparison of a property file, outside of folds over agents"));
    }
    let typed = margins::inside_a_formula(context, |this| this.lower(formula, locals));
    let node = context.as_formula(typed?, formula.span)?;
    let dimension = context.time.dimension();
    Ok(Typed::Term(context.term(Term::TimeUntil(node)), dimension))
}

/// Whether a name stands for an expression without arguments.
fn is_named(context: &Context<'_>, name: &str, locals: &Locals) -> bool {
    if modes::is_inside(context, name, locals) {
        return modes::is_without_arguments(context, name, locals);
    }
    let found = context.look_up(name, locals.scope);
    matches!(found, Some((_, Meaning::Let(decl))) if decl.arguments.is_empty())
}

/// Whether a name stands for a function.
fn takes_arguments(meaning: &Meaning<'_>) -> bool {
    matches!(meaning, Meaning::Let(decl) if !decl.arguments.is_empty())
}

/// A call of a function declared with `let`.
pub(crate) fn lower_let(
    context: &mut Context<'_>,
    (scope, decl): (ScopeId, &LetDecl),
    span: Span,
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    let mut inner = Locals { running: locals.running, ..Locals::of(scope) };
    if process_names::function_inside(context, &decl.name.name, locals).is_some() {
        inner.process = locals.process;
    }
    let name = &decl.name.name;
    let path = inner
        .process
        .and_then(|(at, _)| process_names::inside_path(context, at, name))
        .unwrap_or_else(|| name.clone());
    lower_function(context, decl, (inner, path), span, arguments, locals)
}

/// A call of a function that sees some names and is known by its path.
pub(crate) fn lower_function(
    context: &mut Context<'_>,
    decl: &LetDecl,
    (mut inner, path): (Locals, String),
    span: Span,
    arguments: &[Expr],
    locals: &Locals,
) -> Lowered<Typed> {
    if arguments.len() != decl.arguments.len() {
        let wanted = counted_arguments(decl.arguments.len());
        return context.arity(&decl.name, span, &wanted, (arguments, locals));
    }
    let Ok(values) = context.lower_all(arguments, locals) else {
        follow(context, decl, (inner, path), span);
        return Err(Reported);
    };
    for ((name, value), argument) in decl.arguments.iter().zip(values).zip(arguments) {
        inner.written.push((inner.names.len(), argument.span));
        inner.bind(&name.name, value);
    }
    if context.temporal {
        let process = inner.process.and_then(|process| process_names::copy_label(context, process));
        let written = |(at, span): &(usize, Span)| (*at as u32, Given::Written(*span));
        let given = inner.written.iter().map(written).collect();
        inner.frame = Some(Arc::new(Frame { caller: locals.frame.clone(), given, process }));
    }
    let (before, unknowns) = (context.sink.diagnostics.len(), context.names.unknowns);
    let value = context.expand(inner.scope, &path, span, |this| this.lower(&decl.body, &inner));
    if value.is_err() {
        // With an unknown name in it nothing comes of any other call.
        if context.names.unknowns > unknowns {
            context.names.give_up(inner.scope, path);
        }
        if !inner.names.is_empty() {
            called(context, before, decl, span, &inner);
        }
    }
    value
}

/// Reports the errors of a function that no argument can correct, even if it is never called.
pub(crate) fn look_into(context: &mut Context<'_>, decl: &LetDecl, locals: &Locals) {
    let mut inner = locals.clone();
    for argument in &decl.arguments {
        inner.bind_unknown(&argument.name);
    }
    check_arguments(context, &decl.arguments);
    let around = std::mem::replace(&mut context.names.looking, true);
    let _ = context.lower(&decl.body, &inner);
    context.names.looking = around;
}

/// Follows a call with unknown arguments, each function once, because it may be recursive.
fn follow(context: &mut Context<'_>, decl: &LetDecl, (mut inner, path): (Locals, String), span: Span) {
    // Functions through hundreds of others are too deep only if somebody calls them.
    if !context.names.looking || context.extent.depth > FOLLOWED {
        return;
    }
    let key = (inner.scope, path.clone());
    let _ = context.expand(inner.scope, &path, span, |this| {
        if !this.names.followed.insert(key.clone()) {
            return Err(Reported);
        }
        this.names.journal.push((Vain::Call, key));
        for argument in &decl.arguments {
            inner.bind_unknown(&argument.name);
        }
        this.lower(&decl.body, &inner)
    });
}

/// That no two arguments of a function or behaviour have one name.
pub(crate) fn check_arguments(context: &mut Context<'_>, arguments: &[Ident]) {
    for (k, argument) in arguments.iter().enumerate() {
        if let Some(first) = arguments[..k].iter().find(|first| first.name == argument.name) {
            let text = format!("the argument `{}` is declared twice", argument.name);
            let error = error!(E0202, argument.span, "{text}");
            context.note(error.related(first.span, "first declared here").hint("rename one of them"));
        }
    }
}

/// Adds to the errors inside a function, which were found since `before`, where and with what it was called.
fn called(context: &mut Context<'_>, before: usize, decl: &LetDecl, span: Span, inner: &Locals) {
    let with: Vec<String> = inner
        .names
        .iter()
        .filter(|(name, _)| decl.arguments.iter().any(|argument| argument.name == *name))
        .filter_map(|(name, value)| Some(format!("`{name}` is {}", value.as_ref()?.noun())))
        .collect();
    let body = decl.body.span;
    let inside =
        |place: Span| place.source == body.source && place.start >= body.start && place.end <= body.end;
    for diagnostic in &mut context.sink.diagnostics[before..] {
        // Names that are unknown, or lead in circles, are so with any arguments.
        if diagnostic.code.is_of("E02") {
            continue;
        }
        let from = diagnostic.related.last().or(diagnostic.place.as_ref());
        if from.is_some_and(|label| inside(label.span)) && diagnostic.related.len() < MOST_CALLS {
            diagnostic.related.push(Label { span, text: format!("in this call, {}", with.join(", ")) });
        }
    }
}
