//! The commands of processes: guards, times, branches and their updates.

use crate::compile::context::{
    Context, Locals, Lowered, Reported, processes::Inside, symbols::unknown, typed::as_number,
};
use crate::compile::dimension::Dimension;
use crate::compile::process::timing;
use crate::model::process::wrong_weights;
use crate::model::{Bool, Branch, Command, Domain, Num, Timing, VariableId};
use crate::syntax::ast::Expr;
use crate::syntax::ast::process::{self as ast, ProcessDecl, ProcessItem};
use crate::syntax::codes::Code;

/// Commands of one process are all timed or all not; whether they are.
pub(crate) fn one_kind(context: &mut Context<'_>, decl: &ProcessDecl, commands: &[Command]) -> bool {
    let timed = |command: &Command| command.timing != Timing::Step;
    if commands.iter().any(timed) && !commands.iter().all(timed) {
        context.note(error!(E0905, decl.name.span, "some commands of `{}` have a rate or delay and others have none", decl.name.name;
                hint: "write two processes, one with times and one without; each can read the other"));
        false
    } else if commands.iter().any(timed)
        && let Some(span) = decl.items.iter().find_map(|item| match item {
            ProcessItem::Choose(span) => Some(*span),
            _ => None,
        })
    {
        context.note(error!(E0905, span, "commands with times cannot have `choose`";
                hint: "remove `choose`: the earliest command is executed"));
        false
    } else {
        true
    }
}

/// A command; where something else than its guard is wrong, its guard.
pub(crate) fn command(
    context: &mut Context<'_>,
    at: usize,
    copy: u32,
    command: &ast::Command,
    locals: &Locals,
) -> Result<Command, Lowered<Bool>> {
    let guard = context.lower(&command.guard, locals);
    let guard = guard.and_then(|typed| context.as_truth(typed, command.guard.span));
    let timing = timing::timing(context, command, locals);
    let branches: Vec<Lowered<Branch>> =
        command.branches.iter().map(|branch| lower_branch(context, at, copy, branch, locals)).collect();
    let branches = branches.into_iter().collect::<Lowered<Vec<_>>>();
    let (Ok(timing), Ok(branches)) = (timing, branches) else { return Err(guard) };
    let known: Option<Vec<f64>> = branches
        .iter()
        .map(|b| if let Num::Constant(weight) = b.weight { Some(weight) } else { None })
        .collect();
    // Of several branches each has a weight; one that lacks it was reported.
    let weighed = command.branches.len() == 1 || command.branches.iter().all(|b| b.weight.is_some());
    if let Some(wrong) = known.filter(|_| weighed).and_then(|known| wrong_weights(&known)) {
        context.note(error!(E0902, command.span, "{wrong}"));
        return Err(guard);
    }
    guard.map(|guard| Command { guard, timing, branches }).map_err(Err)
}

fn lower_branch(
    context: &mut Context<'_>,
    at: usize,
    copy: u32,
    branch: &ast::Branch,
    locals: &Locals,
) -> Lowered<Branch> {
    let weight =
        branch.weight.as_ref().map_or(Ok(Num::Constant(1.0)), |weight| lower_weight(context, weight, locals));
    let mut updates: Vec<(VariableId, Num)> = Vec::new();
    let mut failed = false;
    for (k, update) in branch.updates.iter().enumerate() {
        let value = lower_update(context, at, copy, update, locals);
        if branch.updates[..k].iter().any(|other| other.target.name == update.target.name) {
            context.note(error!(
                E0202,
                update.target.span, "`{}` is set twice in one branch", update.target.name
            ));
            failed = true;
        }
        match value {
            Ok(value) => updates.push(value),
            Err(Reported) => failed = true,
        }
    }
    let weight = weight?;
    if failed { Err(Reported) } else { Ok(Branch { weight, updates }) }
}

/// The weight of one of several branches.
fn lower_weight(context: &mut Context<'_>, weight: &Expr, locals: &Locals) -> Lowered<Num> {
    let typed = context.lower(weight, locals)?;
    let (num, dimension) = context.as_num(typed, weight.span)?;
    if !dimension.is_none() {
        return context.wrong_dimension(weight.span, Dimension::NONE, dimension);
    }
    Ok(num)
}

fn lower_update(
    context: &mut Context<'_>,
    at: usize,
    copy: u32,
    update: &ast::Update,
    locals: &Locals,
) -> Lowered<(VariableId, Num)> {
    let value = context.lower(&update.value, locals);
    let process = &context.processes[at];
    let Some(Inside::Variable(place)) = process.names.get(update.target.name.as_str()).copied() else {
        if let Some(Inside::Lost) = process.names.get(update.target.name.as_str()) {
            return Err(Reported);
        }
        let known = process.names.iter().filter(|(_, i)| matches!(i, Inside::Variable(_)));
        let known: Vec<&str> = known.map(|(n, _)| *n).collect();
        let error =
            unknown("variable", &update.target.name, update.target.span, Code::E0201, known.into_iter());
        let error = match &error.hint {
            Some(_) => error,
            None => error.hint("a process can set only its own variables"),
        };
        return context.report(error);
    };
    let (dimension, domain) = process.variables[place];
    let id = process.variable(copy, place);
    let typed = value?;
    let span = update.value.span;
    if domain == Domain::Truth {
        let truth = context.as_truth(typed, span)?;
        return Ok((id, as_number(truth)));
    }
    let (num, found) = context.as_num(typed, span)?;
    if found != dimension {
        return context.wrong_dimension(span, dimension, found);
    }
    if let Num::Constant(value) = num
        && !domain.contains(value)
    {
        return context.report(error!(E0903, span, "`{}` cannot become {value}", update.target.name));
    }
    Ok((id, num))
}
