//! Processes: variables, names and commands.
//!
//! Variables are settled first, so that everything can read them; commands last, because they read
//! everything.

pub(crate) mod commands;
pub(crate) mod parts;
pub(crate) mod program;
pub(crate) mod reachable;
pub(crate) mod timing;

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    number::Number,
    people::{People, entities},
    processes::Inside,
    symbols::unknown,
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::call;
use crate::compile::process::{parts::Writing, reachable::Lines};
use crate::syntax::ast::Broken;

use crate::model::{Bool, Command, Domain, Num, Process, Processes, Timing, Variable};
use crate::syntax::ast::process::{self as ast, Domain as Written, ProcessItem};
use crate::syntax::ast::{Expr, Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// Most copies of a process.
const MOST_COPIES: i64 = 1000;

/// The ends of ranges are below this, so that all sums and differences of them are exact.
const LARGEST: i64 = 1 << 52;

/// Whether some command of the file has a rate or a delay.
pub(crate) fn has_timing(file: &ScenarioFile) -> bool {
    file.items.iter().any(|item| match item {
        Item::Process(decl) => decl
            .items
            .iter()
            .any(|item| matches!(item, ProcessItem::Command(command) if command.timing.is_some())),
        _ => false,
    })
}

/// Settles the variables of all processes.
pub(crate) fn settle_variables(context: &mut Context<'_>) -> Vec<Variable> {
    let mut variables = Vec::new();
    for at in 0..context.processes.len() {
        settle(context, at, &mut variables);
    }
    variables
}

fn settle(context: &mut Context<'_>, at: usize, variables: &mut Vec<Variable>) {
    let decl = context.processes[at].decl;
    let locals = Locals { settling: Some(at as u32), ..Locals::of(0) };
    if let Some(count) = &decl.count {
        let number = context.number_of(count, Dimension::NONE, &locals);
        let whole = number.map(Number::as_whole);
        context.processes[at].uncounted = !matches!(whole, Ok(Some(1..=MOST_COPIES)));
        context.processes[at].copies = Some(match whole {
            Ok(Some(n @ 1..=MOST_COPIES)) => n as u32,
            Err(Reported) => 1,
            Ok(_) => {
                context.note(error!(
                    E0402,
                    count.span, "the number of copies must be a whole number from 1 to {MOST_COPIES}"
                ));
                1
            }
        });
    }
    let mut spans: BTreeMap<&str, Span> = BTreeMap::new();
    let mut initials = Vec::new();
    for item in &decl.items {
        let declared = Inside::of(item, Inside::Variable(initials.len()));
        let Some((name, inside)) = declared else { continue };
        if let Some(first) = spans.insert(&name.name, name.span) {
            let error = error!(E0202, name.span, "`{}` is declared twice", name.name)
                .related(first, "first declared here")
                .hint("rename one of them");
            context.note(error);
            context.processes[at].is_unknown = true;
            if let ProcessItem::Var(var) = item {
                let _ = variable(context, var, &locals);
            }
            continue;
        }
        if let ProcessItem::Var(var) = item {
            let Ok((dimension, domain, initial)) = variable(context, var, &locals) else {
                context.processes[at].names.insert(&name.name, Inside::Lost);
                context.processes[at].is_unknown = true;
                continue;
            };
            // Whatever is wrong with the start, what the commands do with the variable can be checked.
            context.processes[at].is_unknown |= initial.is_err();
            context.processes[at].variables.push((dimension, domain));
            let start = initial.unwrap_or_else(|_| domain.values().map_or(0.0, |(least, _)| least));
            initials.push((var.name.name.as_str(), domain, start));
        }
        context.processes[at].names.insert(&name.name, inside);
    }
    context.processes[at].first = variables.len() as u32;
    for copy in 0..context.processes[at].copies.unwrap_or(1) {
        let owner = context.processes[at].copy_name(copy);
        for (name, domain, initial) in &initials {
            context.origins.variables.push(spans.get(name).copied().unwrap_or(decl.name.span));
            variables.push(Variable { name: format!("{owner}.{name}"), domain: *domain, initial: *initial });
        }
    }
}

/// Dimension and domain of a variable, and its value at the start.
fn variable(
    context: &mut Context<'_>,
    var: &ast::VarDecl,
    locals: &Locals,
) -> Lowered<(Dimension, Domain, Lowered<f64>)> {
    let initial = context.lower(&var.initial, locals);
    let span = var.initial.span;
    let number = |this: &mut Context<'_>, typed: Typed| match typed {
        Typed::Number(number) if number.value.is_finite() => Ok(number),
        Typed::Num(..) => {
            this.report(error!(E0304, span, "the initial value must be known before a trial starts"))
        }
        found => this.mismatch(span, "a number", &found),
    };
    let truth = |this: &mut Context<'_>, typed: Typed| match typed {
        Typed::Truth(Bool::Constant(value), _) => Ok(f64::from(value)),
        Typed::Truth(..) => {
            this.report(error!(E0304, span, "the initial value must be known before a trial starts"))
        }
        found => this.mismatch(span, "`true` or `false`", &found),
    };
    match &var.domain {
        Some(Written::Range(low, high)) => {
            let low_end = whole(context, low, locals);
            let high_end = whole(context, high, locals);
            let (low_end, high_end) = (low_end?, high_end?);
            if low_end > high_end {
                return context.report(error!(E0405, low.span.to(high.span), "the range is empty"));
            }
            let domain = Domain::Whole { low: low_end, high: high_end };
            let initial = initial
                .and_then(|initial| number(context, initial))
                .and_then(|number| initial_value(context, var, number, domain));
            Ok((Dimension::NONE, domain, initial))
        }
        Some(Written::Named(name)) => match name.name.as_str() {
            "bool" => {
                let initial = initial.and_then(|initial| truth(context, initial));
                Ok((Dimension::NONE, Domain::Truth, initial))
            }
            "real" => {
                let initial = initial?;
                let number = number(context, initial)?;
                Ok((number.dimension, Domain::Real, Ok(number.value)))
            }
            "int" => {
                let error = error!(E0405, name.span, "an integer variable needs a range";
                            hint: "write `var {}: 0 .. 10 = …`", var.name.name);
                context.report(error)
            }
            _ => {
                let known = ["bool", "real"].into_iter();
                let error = unknown("type of variable", &name.name, name.span, Code::E0207, known);
                context.report(error.hint("the types are `lo .. hi`, `bool` and `real`"))
            }
        },
        None => match initial? {
            typed @ Typed::Truth(..) => Ok((Dimension::NONE, Domain::Truth, Ok(truth(context, typed)?))),
            typed => {
                let number = number(context, typed)?;
                Ok((number.dimension, Domain::Real, Ok(number.value)))
            }
        },
    }
}

/// The value at the start of a variable with a range.
fn initial_value(
    context: &mut Context<'_>,
    var: &ast::VarDecl,
    number: Number,
    domain: Domain,
) -> Lowered<f64> {
    let span = var.initial.span;
    if !number.dimension.is_none() {
        return context.wrong_dimension(span, Dimension::NONE, number.dimension);
    }
    match domain {
        Domain::Whole { low, high } if !domain.contains(number.value) => context
            .report(error!(E0903, span, "`{}` must be a whole number from {low} to {high}", var.name.name)),
        _ => Ok(domain.kept(number.value)),
    }
}

fn whole(context: &mut Context<'_>, expr: &Expr, locals: &Locals) -> Lowered<i64> {
    let number = context.number_of(expr, Dimension::NONE, locals)?;
    match number.as_whole() {
        Some(whole) if whole.abs() < LARGEST => Ok(whole),
        _ if number.value.fract() == 0.0 => {
            let said = format!("`{}` is too large for an end of a range", context.text(expr.span));
            let error = error!(E0405, expr.span, "{said}")
                .label(format!("the limit is ±{}", LARGEST - 1))
                .hint("for a number of any size write `real` instead of a range");
            context.report(error)
        }
        _ => context.report(error!(E0405, expr.span, "the ends of a range must be whole numbers")),
    }
}

/// Lowers the commands of all processes.
pub(crate) fn settle_commands(
    context: &mut Context<'_>,
    variables: Vec<Variable>,
    people: &mut People,
) -> Processes {
    let mut out = Processes { variables, list: Vec::new(), outside: None };
    let mut writings = Vec::new();
    for at in 0..context.processes.len() {
        let decl = context.processes[at].decl;
        let copies = context.processes[at].copies.unwrap_or(1);
        let Ok(first) = entities(context, people, &decl.name.name, copies, decl.name.span) else {
            break;
        };
        check_names(context, at);
        let choose = decl.items.iter().any(|item| matches!(item, ProcessItem::Choose(_)));
        let process = &context.processes[at];
        let mut is_sound = !process.uncounted && !process.is_unknown && !is_torn_within(context, decl.span);
        for copy in 0..copies {
            let locals = Locals { process: Some((at as u32, copy)), ..Locals::of(0) };
            let mut commands = Vec::new();
            let mut lines = Vec::new();
            let mut broken = Vec::new();
            for item in &decl.items {
                let ProcessItem::Command(command) = item else { continue };
                match commands::command(context, at, copy, command, &locals) {
                    Ok(lowered) => {
                        commands.push(lowered);
                        lines.push(Lines::of(command));
                    }
                    Err(guard) => broken.push((guard, command)),
                }
            }
            is_sound &= commands::one_kind(context, decl, &commands);
            let is_whole = is_sound && broken.is_empty();
            for (guard, command) in broken {
                // Who knows when one is enabled knows when what follows is not known.
                let Ok(guard) = guard else {
                    is_sound = false;
                    continue;
                };
                let timing = if context.time.clock.is_jumps() {
                    Timing::Rate(Num::Constant(0.0))
                } else {
                    Timing::Step
                };
                commands.push(Command { guard, timing, branches: Vec::new() });
                lines.push(Lines::broken(command));
            }
            let name = context.processes[at].copy_name(copy);
            out.list.push(Process { name, entity: first + copy, commands, choose });
            let variables = context.processes[at].of_copy(copy);
            writings.push(Writing { lines, variables, is_sound });
            if !is_whole {
                // What is wrong with one copy is wrong with the others.
                break;
            }
        }
    }
    reachable::check_reachable(context, &out, &writings);
    let of_commands =
        |writing: Writing| writing.lines.into_iter().map(|line| line.command).collect::<Vec<_>>();
    context.origins.commands = writings.into_iter().map(of_commands).collect();
    out
}

/// Whether part of a declaration was not read.
fn is_torn_within(context: &Context<'_>, declaration: Span) -> bool {
    let meets = |item: &&Broken| {
        let torn = item.span;
        torn.source == declaration.source && torn.start < declaration.end && declaration.start < torn.end
    };
    context.torn.iter().any(meets)
}

/// Checks unused names too.
fn check_names(context: &mut Context<'_>, at: usize) {
    let locals = Locals { process: Some((at as u32, 0)), ..Locals::of(0) };
    for item in &context.processes[at].decl.items {
        match item {
            ProcessItem::Let(decl) => call::look_into(context, decl, &locals),
            ProcessItem::Label { value, .. } => {
                if let Ok(typed) = context.lower(value, &locals) {
                    let _ = context.as_truth(typed, value.span);
                }
            }
            ProcessItem::Var(_) | ProcessItem::Command(_) | ProcessItem::Choose(_) => {}
        }
    }
}
