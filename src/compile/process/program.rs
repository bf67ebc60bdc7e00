//! Programs that stand in the place of a model. The columns that signals read are variables of a process; the people whom it
//! shows are places of a source at which nobody arrives by itself.

use crate::base::geometry::Vec2;
use crate::compile::behaviour::attachment;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    people::{People, entities},
    symbols::{Meaning, unknown},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::choices;
use crate::compile::people;
use crate::compile::presets;
use crate::model::{
    Body, Bool, CallPart, Kind, Law, Outside, Parameter, Route, ShownPeople, Source, Start, TraceForm,
};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Item, ProgramDecl, ScenarioFile, Text, Value};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use std::sync::Arc;

/// Places for people unless their number is written.
const PLACES: usize = 100;
/// Radius of people unless it is written, m; and how long a trial may run, s.
const RADIUS: f64 = 0.2;
const LIMIT: f64 = 60.0;
/// No amount is larger, SI units.
const MOST: f64 = 1e6;
/// The preset that gives people the parameters that nothing reads.
const PRESET: &str = "cfs2";

/// The fields of a program.
const FIELDS: [&str; 6] = ["run", "trace", "time", "ends", "limit", "radius"];

fn field<'a>(decl: &'a ProgramDecl, name: &str) -> Option<&'a Field> {
    decl.body.iter().find(|field| field.name.name == name)
}

/// The people whom a program shows.
pub(crate) fn shown<'a>(
    context: &mut Context<'a>,
    decl: &'a ProgramDecl,
    people: &mut People,
) -> Option<Source> {
    let shown = decl.people.as_ref()?;
    let name = &shown.name;
    let count = shown.count.as_ref().map_or(Ok(PLACES), |count| people::counted(context, count));
    let radius = amount(context, decl, "radius", (Dimension::LENGTH, RADIUS));
    let (Ok(count), Ok(radius)) = (count, radius) else {
        let nobody = attachment::with(context, name, &[]);
        people::define_empty(context, name, true, nobody);
        return None;
    };
    let law = |parameter| presets::law(PRESET, parameter).unwrap_or(Law::Constant(1.0));
    let body = Body::new(Kind::Cfs, |parameter| match parameter {
        Parameter::Radius => Law::Constant(radius),
        other => law(other),
    });
    let body = Arc::new(body);
    let first = entities(context, people, &name.name, count as u32, name.span).ok()?;
    let entity = entities(context, people, &format!("{}.every", name.name), 1, name.span).ok()?;
    context.roster.coming = true;
    let route = Route::Legs { legs: Vec::new(), then_leave: true };
    let start = Start::at_rest(Vec2::zeros());
    let members = people::members(context, name, count, true, first, people, |_| {
        (body.clone(), start.clone(), route.clone())
    });
    people.coming.extend(&members);
    let all = Meaning::Agents { members: members.clone().into(), particle: false };
    context.names.scopes[0].define(name, all);
    Some(Source {
        name: name.name.clone(),
        entity,
        every: Law::Constant(f64::INFINITY),
        members,
        most: count as u32,
    })
}

fn refuse<T>(context: &mut Context<'_>, span: Span, wanted: &str) -> Lowered<T> {
    let found = context.text(span);
    context.report(error!(E0305, span, "expected {wanted}, found `{found}`"))
}

/// The program of a scenario, if one stands for its model; its people have their places.
pub(crate) fn program<'a>(
    context: &mut Context<'a>,
    file: &'a ScenarioFile,
    sources: &[Source],
) -> Option<Arc<Outside>> {
    let programs = file.items.iter().filter_map(|item| match item {
        Item::Program(decl) => Some(decl),
        _ => None,
    });
    let programs: Vec<&ProgramDecl> = programs.collect();
    let (decl, others) = programs.split_first()?;
    for other in others {
        let name = &other.process.name;
        let error = error!(E0411, name.span, "a scenario can have only one program")
            .related(decl.process.name.span, "the first one");
        context.note(error.hint("write a scenario for each, and `compare` results by their intervals"));
    }
    alone(context, file, decl);
    for (k, field) in decl.body.iter().enumerate() {
        if let Some(first) = decl.body[..k].iter().find(|first| first.name.name == field.name.name) {
            let error = error!(E0202, field.name.span, "`{}` is set twice", field.name.name);
            context.note(error.related(first.name.span, "first set here").hint("remove one of them"));
        }
    }
    people::only(context, &decl.body.iter().collect::<Vec<_>>(), &FIELDS);
    let words = words(context, decl);
    let format = word(context, decl, "trace", &TraceForm::ALL.map(|(name, _)| name));
    let ends = word(context, decl, "ends", &["held"]);
    let time = match field(decl, "time").map(|field| &field.value) {
        Some(Value::Plain(Expr { kind: ExprKind::Text(text), .. })) => Ok(text.clone()),
        Some(other) => refuse(context, other.span(), "the column of the time in quotes"),
        None => Ok("t".to_owned()),
    };
    let limit = amount(context, decl, "limit", (Dimension::TIME, LIMIT));
    let people = decl.people.as_ref().map(|shown| columns(context, &shown.columns)).transpose();
    context.origins.program = Some(decl.process.name.span);
    let members = sources.first().map(|source| source.members.clone()).unwrap_or_default();
    Some(Arc::new(Outside {
        name: decl.process.name.name.clone(),
        words: words.ok()?,
        format: TraceForm::ALL[format.ok()?.unwrap_or(0)].1,
        time: time.ok()?,
        columns: decl.columns.iter().map(|Text { value, .. }| value.clone()).collect(),
        people: people.ok()?.map(|columns| ShownPeople { columns, members }),
        is_held: ends.ok()?.is_some(),
        limit: limit.ok()?,
    }))
}

/// A program moves everybody itself.
fn alone(context: &mut Context<'_>, file: &ScenarioFile, program: &ProgramDecl) {
    for item in &file.items {
        let name = match item {
            Item::Agents(decl) => &decl.name,
            Item::Group(decl) => &decl.name,
            Item::Source(decl) => &decl.name,
            Item::Process(decl) => &decl.name,
            Item::Behaviour(decl) => &decl.name,
            Item::Paths(decl) => &decl.agent,
            Item::Tracks { name, .. } => name,
            _ => continue,
        };
        let own = &program.process.name;
        let error = error!(E0411, name.span, "`{}` has no part in the program `{}`", name.name, own.name)
            .related(own.span, "which stands for the whole model");
        context.note(error.hint("remove it, or let the program write it as columns of its trace"));
    }
}

/// The amount that a field sets, or its default.
fn amount<'a>(
    context: &mut Context<'a>,
    decl: &'a ProgramDecl,
    name: &str,
    (dimension, default): (Dimension, f64),
) -> Lowered<f64> {
    match field(decl, name).map(|field| &field.value) {
        Some(Value::Plain(expr)) => {
            let value = context.number_of(expr, dimension, &Locals::of(0))?.value;
            let fits = value > 0.0 && value <= MOST;
            if fits { Ok(value) } else { refuse(context, expr.span, "a value above 0 and at most 1e6") }
        }
        Some(other) => refuse(context, other.span(), "a number with its unit"),
        None => Ok(default),
    }
}

/// Which of some words a field names.
fn word(context: &mut Context<'_>, decl: &ProgramDecl, name: &str, known: &[&str]) -> Lowered<Option<usize>> {
    let Some(field) = field(decl, name) else { return Ok(None) };
    if let Value::Plain(Expr { kind: ExprKind::Name(word), .. }) = &field.value
        && let Some(at) = known.iter().position(|known| known == word)
    {
        return Ok(Some(at));
    }
    let known: Vec<String> = known.iter().map(|word| format!("`{word}`")).collect();
    refuse(context, field.value.span(), &known.join(" or "))
}

/// `columns("id", "x", "y")`, perhaps with those of the velocity.
fn columns(context: &mut Context<'_>, written: &Expr) -> Lowered<Vec<String>> {
    if let ExprKind::Call { function, arguments } = &written.kind
        && function.name == "columns"
        && matches!(arguments.len(), 3 | 5)
    {
        let text = |argument: &Expr| match &argument.kind {
            ExprKind::Text(text) => Some(text.clone()),
            _ => None,
        };
        if let Some(texts) = arguments.iter().map(text).collect() {
            return Ok(texts);
        }
    }
    refuse(context, written.span, "`columns(\"id\", \"x\", \"y\")`, perhaps with columns of the velocity")
}

/// The words of `run`, split at blanks, with parameters in the place of their names.
fn words(context: &mut Context<'_>, decl: &ProgramDecl) -> Lowered<Vec<Vec<CallPart>>> {
    let name = &decl.process.name;
    let Some(run) = field(decl, "run") else {
        return context.report(error!(E0209, name.span, "program `{}` has no `run`", name.name;
            hint: "write the call: `run = \"python3 model.py --seed {{seed}}\"`"));
    };
    let Value::Plain(Expr { kind: ExprKind::Text(text), span }) = &run.value else {
        return refuse(context, run.value.span(), "a call in quotes");
    };
    let words: Lowered<Vec<Vec<CallPart>>> =
        text.split_whitespace().map(|word| pieces(context, word, *span)).collect();
    let words = words?;
    match words.first().map(Vec::as_slice) {
        None => return refuse(context, *span, "a call in quotes"),
        Some([CallPart::Text(_)]) => {}
        Some(_) => return refuse(context, *span, "the name of a program as the first word"),
    }
    let is_told = words.iter().flatten().any(|piece| matches!(piece, CallPart::Seed | CallPart::Trial));
    if is_told {
        Ok(words)
    } else {
        context.report(error!(E0411, *span, "the program is not told its seed, so all trials would be equal";
            hint: "add `{{seed}}`: another number in each trial, from which the program should draw all random numbers"))
    }
}

/// The pieces of a word.
fn pieces(context: &mut Context<'_>, word: &str, span: Span) -> Lowered<Vec<CallPart>> {
    let (mut pieces, mut rest) = (Vec::new(), word);
    while let Some((before, named)) = rest.split_once('{') {
        let Some((name, after)) = named.split_once('}') else {
            return context.report(error!(E0411, span, "`{word}` opens a brace and does not close it";
                hint: "write `{{name}}` with the name of a parameter, `seed`, `trial` or `move`"));
        };
        pieces.push(CallPart::Text(before.to_owned()));
        pieces.push(match name {
            "seed" => CallPart::Seed,
            "trial" => CallPart::Trial,
            "move" => CallPart::Move,
            _ => CallPart::Text(value(context, name, span)?),
        });
        rest = after;
    }
    pieces.push(CallPart::Text(rest.to_owned()));
    let mut joined: Vec<CallPart> = Vec::new();
    for piece in pieces {
        match (joined.last_mut(), piece) {
            (Some(CallPart::Text(known)), CallPart::Text(more)) => known.push_str(&more),
            (_, CallPart::Text(text)) if text.is_empty() => {}
            (_, piece) => joined.push(piece),
        }
    }
    Ok(joined)
}

/// The value of a parameter or constant, SI units.
fn value(context: &mut Context<'_>, name: &str, span: Span) -> Lowered<String> {
    let ident = Ident { name: name.to_owned(), span };
    let Some((_, meaning)) = context.look_up(name, 0) else {
        let known: Vec<String> = context.names.scopes[0]
            .entries()
            .filter(|(_, entry)| matches!(entry.meaning, Meaning::Param(_) | Meaning::Constant(_)))
            .map(|(name, _)| name.to_owned())
            .chain(["seed", "trial", "move"].map(str::to_owned))
            .collect();
        return context.report(unknown(
            "parameter",
            name,
            span,
            Code::E0201,
            known.iter().map(String::as_str),
        ));
    };
    if matches!(meaning, Meaning::Doubtful) {
        return Err(Reported);
    }
    if let Some((chosen, _)) = choices::chosen(context, &ident).filter(|(_, choices)| !choices.is_empty()) {
        let chosen = chosen.name.clone();
        context.names.chosen_by.push(ident.name);
        return Ok(chosen);
    }
    let expr = Expr { kind: ExprKind::Name(ident.name), span };
    match context.lower(&expr, &Locals::of(0))? {
        Typed::Truth(Bool::Constant(value), _) => Ok(value.to_string()),
        typed => Ok(context.as_known(typed, span)?.value.to_string()),
    }
}
