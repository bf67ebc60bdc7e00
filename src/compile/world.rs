//! A scenario under one combination of parameter values.

use crate::base::decimal::Decimal;
use crate::base::tick::{Clock, Tick};
use crate::compile::behaviour;
use crate::compile::context::symbols::Param;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    clock::{self, Told},
    entry, moments,
    notes::Notes,
    number::Number,
    people::{People, keep_starts},
    processes::Declared,
    symbols::{self, Meaning, Scope},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::files::Files;
use crate::compile::lower::choices;
use crate::compile::lower::{
    builtin::{BUILT_IN, OPERATORS},
    call, defaults,
};
use crate::compile::people::{self, groups, kinds, places, routes, sources, step, stepping, tracks};
use crate::compile::process::{self, program};
use crate::compile::scene::{self, periodic};
use crate::model::{BehaviourId, BuiltIn, Kind, Scenario};
use crate::syntax::ast::{Expr, ExprKind, Ident, Item, LetDecl, PropertyFile, PropertyItem, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic};
use crate::syntax::source::{Source, Span};
use std::collections::BTreeMap;

/// Most ticks of a trial.
const MOST_TICKS: u64 = 1 << 32;

/// Elaborates a scenario with some parameters set, and declares the names of property files.
pub(crate) fn elaborate<'a>(
    sources: &'a [Source],
    scenario: &'a ScenarioFile,
    properties: &'a [PropertyFile],
    files: &Files,
    settings: BTreeMap<String, Number>,
    measured: &[Decimal],
) -> (Context<'a>, Option<Scenario>) {
    let mut context = Context::new(sources, settings);
    context.time.measured = measured.to_vec();
    context.notes = files.noting.then(Notes::new);
    declare(&mut context, scenario);
    declare_properties(&mut context, properties);
    let broken = scenario.broken.iter().chain(properties.iter().flat_map(|file| &file.broken));
    context.torn = broken.collect();
    context.sink.unread = context.torn.iter().map(|item| (item.span.source, item.span.end)).collect();
    defaults::doubt_defaults(&mut context, scenario);
    warn_of_meanings(&mut context);
    let built = build(&mut context, scenario, files).ok();
    (context, built)
}

fn declare<'a>(context: &mut Context<'a>, file: &'a ScenarioFile) {
    for item in &file.items {
        let (name, meaning) = match item {
            Item::Const { name, value } => (name, Meaning::Constant(value)),
            Item::Param { name, value, range, choices } => {
                (name, Meaning::Param(Param { value, range: range.as_ref(), choices }))
            }
            Item::Let(decl) => (&decl.name, Meaning::Let(decl)),
            Item::Kind(decl) => (&decl.name, Meaning::Kind(decl)),
            Item::Agents(decl) => (&decl.name, Meaning::Declared),
            Item::Group(decl) => (&decl.name, Meaning::Declared),
            Item::Scene(items) => {
                scene::declare_scene(context, items);
                continue;
            }
            Item::Title(_) | Item::Setting { .. } | Item::Tracks { .. } | Item::Moves(_) | Item::Paths(_) => {
                continue;
            }
            Item::Process(decl) => {
                context.processes.push(Declared::new(decl));
                (&decl.name, Meaning::Process(context.processes.len() as u32 - 1))
            }
            Item::Behaviour(decl) => {
                let id = BehaviourId(context.conducts.behaviours.len() as u32);
                behaviour::declare_behaviour(context, decl);
                (&decl.name, Meaning::Behaviour(id))
            }
            Item::Source(decl) => (&decl.name, Meaning::Declared),
            Item::Program(decl) => {
                for signal in &decl.signals {
                    entry::enter(context, &signal.name, Meaning::Let(signal));
                }
                if let Some(people) = &decl.people {
                    entry::enter(context, &people.name, Meaning::Declared);
                }
                context.processes.push(Declared { is_played: true, ..Declared::new(&decl.process) });
                (&decl.process.name, Meaning::Process(context.processes.len() as u32 - 1))
            }
        };
        let reserved = match (&meaning, name.name.as_str()) {
            (Meaning::Kind(_), name) => {
                Kind::named(name).map(|kind| format!("`{}` is the name of {}", kind.name(), kind.meaning()))
            }
            (_, "self") => Some("`self` is the agent that has a behaviour".to_owned()),
            _ => None,
        };
        if let Some(text) = reserved {
            context.note(error!(E0202, name.span, "{text}"; hint: "choose another name"));
        }
        entry::enter(context, name, meaning);
    }
}

fn declare_properties<'a>(context: &mut Context<'a>, files: &'a [PropertyFile]) {
    for file in files {
        let mut scope = Scope::default();
        for item in &file.items {
            let (name, meaning) = match item {
                PropertyItem::Let(decl) => (&decl.name, Meaning::Let(decl)),
                PropertyItem::Const { name, value } => (name, Meaning::Constant(value)),
                PropertyItem::Property { name, formula } => (name, Meaning::Property(formula)),
                PropertyItem::For(_) | PropertyItem::Family { .. } | PropertyItem::Query(_) => continue,
            };
            if let Some(first) = context.names.scopes[0].get(&name.name) {
                let error = error!(E0202, name.span, "`{}` is already a name of the scenario", name.name)
                    .related(first.span, "declared here");
                context.note(error);
                // Its meaning in this file is uncertain, so its uses cause no further errors.
                context.names.broken.insert((context.names.scopes.len(), name.name.clone()));
                entry::doubt(context, context.names.scopes.len(), &name.name);
                let _ = scope.declare(&name.name, name.span, meaning);
            } else if let Err(error) = scope.declare(&name.name, name.span, meaning) {
                context.note(error);
                entry::doubt(context, context.names.scopes.len(), &name.name);
            }
        }
        context.names.scopes.push(scope);
    }
}

/// Warns of names that mean something else, too.
fn warn_of_meanings(context: &mut Context<'_>) {
    let mut found = Vec::new();
    for (number, scope) in context.names.scopes.iter().enumerate() {
        for (name, entry) in scope.entries() {
            let calls = matches!(&entry.meaning, Meaning::Let(decl) if !decl.arguments.is_empty());
            let hint = if BUILT_IN.contains(&name) || calls && BuiltIn::find(name).is_some() {
                "it hides the built-in meaning; choose another name"
            } else if number == 0 && OPERATORS.contains(&name) {
                "it is an operator in property files, so formulas there cannot use it; choose another name"
            } else {
                continue;
            };
            let text = format!("the name `{name}` has another meaning");
            found.push(Diagnostic::warning(Code::W0201, entry.span, text).hint(hint));
        }
    }
    for warning in found {
        context.note(warning);
    }
}

fn build<'a>(context: &mut Context<'a>, file: &'a ScenarioFile, files: &Files) -> Lowered<Scenario> {
    let mut told = if clock::is_stepped(file) { Told::Stepped } else { Told::Nothing };
    let clock = settle_clock(context, file, &mut told);
    context.sink.told = if told == Told::Nothing && clock.is_ok() { Told::Whole } else { told };
    let variables = process::settle_variables(context);
    periodic::settle_periods(context, file);
    for item in &file.items {
        if let Item::Tracks { name, file, body } = item {
            let hint = "declare the agents one by one";
            if periodic::refuse_if_periodic(context, name.span, "recordings", hint).is_err() {
                entry::enter(context, name, Meaning::Doubtful);
                continue;
            }
            tracks::tracks(context, name, file.as_ref(), body, files);
        }
    }
    context.tracks.grouping = files.grouping;
    context.tracks.site.clone_from(&files.site);
    context.tracks.columns.clone_from(&files.columns);
    stepping::settle_gaits(context, file, files);
    let scenes = file.items.iter().filter_map(|item| match item {
        Item::Scene(items) => Some(items.as_slice()),
        _ => None,
    });
    let doors = scene::settle(context, &scenes.collect::<Vec<_>>(), files);
    let changing = scene::doors::set(context, &doors);
    let mut people = People::default();
    for item in &file.items {
        match item {
            Item::Agents(decl) => people::agents(context, decl, &mut people),
            Item::Group(decl) => groups::group(context, decl, &mut people),
            _ => {}
        }
    }
    routes::leave_by_moves(context, file);
    let mut sources = people::never_arriving(context, &people);
    for item in &file.items {
        match item {
            Item::Source(decl) => sources.extend(sources::source(context, decl, &mut people)),
            Item::Program(decl) => sources.extend(program::shown(context, decl, &mut people)),
            _ => {}
        }
    }
    scene::doors::check(context, &doors, &people.agents);
    let count = variables.len();
    let mut processes = process::settle_commands(context, variables, &mut people);
    processes.outside = program::program(context, file, &sources);
    let behaviours = behaviour::settle_behaviours(context, &mut people, count);
    let moves = routes::all_moves(context, file, &people);
    check_unused(context, file);
    let choices = file.items.iter().filter_map(|item| match item {
        Item::Param { name, choices, .. } if !choices.is_empty() => Some((name, name.span)),
        _ => None,
    });
    let used = std::mem::take(&mut context.names.chosen_by);
    choices::check_used(context, &choices.collect::<Vec<_>>(), &used);
    check_titles(context, file);
    places::check_places(context, &mut people);
    if clock.is_err() || context.sink.failed() {
        keep_starts(context, people, sources);
        return Err(Reported);
    }
    step::check_step(context, file, &people.agents);
    let title = file
        .items
        .iter()
        .find_map(|item| if let Item::Title(text) = item { Some(text.value.clone()) } else { None });
    context.roster.places = people.places;
    Ok(Scenario {
        title: title.unwrap_or_default(),
        clock: context.time.clock,
        horizon: context.time.horizon,
        scene: context.scene.clone(),
        agents: people.agents,
        groups: people.groups,
        moves,
        processes,
        behaviours,
        sources,
        doors: changing,
    })
}

/// A scenario has one title.
fn check_titles(context: &mut Context<'_>, file: &ScenarioFile) {
    let titles = file.items.iter().filter_map(|item| match item {
        Item::Title(text) => Some(text.span),
        _ => None,
    });
    let titles: Vec<Span> = titles.collect();
    if let [first, others @ ..] = titles.as_slice() {
        for other in others {
            let error = error!(E0202, *other, "a scenario can have only one title");
            context.note(error.related(*first, "first title").hint("remove one of them"));
        }
    }
}

/// Checks unused declarations as well.
fn check_unused<'a>(context: &mut Context<'a>, file: &'a ScenarioFile) {
    let locals = Locals::of(0);
    for item in &file.items {
        match item {
            Item::Const { name, value } => {
                let lowered = lower_declared(context, name, value);
                let _ = context.unchanging(lowered, value);
            }
            Item::Param { name, value, choices, .. } if !choices.is_empty() => {
                choices::check(context, name, value, choices);
            }
            Item::Param { name, value, range, .. } => {
                let declared = lower_declared(context, name, value);
                if let Some(range) = range {
                    check_range(context, name, (declared, value), range);
                }
            }
            Item::Kind(decl)
                if context.names.scopes[0].get(&decl.name.name).is_some_and(|e| e.span == decl.name.span) =>
            {
                let _ = kinds::kind(context, &decl.name);
            }
            Item::Kind(decl) => {
                let _ = kinds::own_kind(context, decl);
            }
            Item::Let(decl) => check_let(context, decl, &locals),
            Item::Program(decl) => decl.signals.iter().for_each(|one| check_let(context, one, &locals)),
            _ => {}
        }
    }
}

fn check_let<'a>(context: &mut Context<'a>, decl: &'a LetDecl, locals: &Locals) {
    context.temporal = true;
    if decl.arguments.is_empty() {
        let _ = lower_declared(context, &decl.name, &decl.body);
    } else {
        call::look_into(context, decl, locals);
    }
    context.temporal = false;
}

/// The range of a parameter, and whether its default lies in it.
fn check_range(
    context: &mut Context<'_>,
    name: &Ident,
    (declared, value): (Lowered<Typed>, &Expr),
    range: &(Expr, Expr),
) {
    let (locals, (low, high)) = (Locals::of(0), range);
    if defaults::fault_of_default(context, name, value, range).is_some() {
        return;
    }
    // What it is set to is judged where that is done.
    let default = declared.and_then(|_| context.number(value, &locals));
    let Ok(number) = default else {
        let _ = (context.number(low, &locals), context.number(high, &locals));
        return;
    };
    let place = low.span.to(high.span);
    let ends = (
        context.number_of(low, number.dimension, &locals),
        context.number_of(high, number.dimension, &locals),
    );
    // A default that something else takes the place of need not lie in its range where one of them follows from what
    // is set.
    let is_replaced = context.names.settings.contains_key(&name.name)
        && (context.names.hangs_on_parameters(place) || context.names.hangs_on_parameters(value.span));
    let (Ok(low), Ok(high)) = ends else { return };
    if low.value > high.value {
        context.roster.any_start = true;
        context.note(error!(E0405, place, "the range is empty"));
    } else if !is_replaced && (number.value < low.value || number.value > high.value) {
        let text = format!("the default of `{}` is outside its range", name.name);
        context.roster.any_start = true;
        context.note(error!(E0405, value.span, "{text}").hanging_on(place));
    }
}

fn lower_declared(context: &mut Context<'_>, name: &Ident, value: &Expr) -> Lowered<Typed> {
    let is_taken = context.names.scopes[0].get(&name.name).is_some_and(|entry| entry.span != name.span);
    if is_taken || context.names.is_doubtful(0, &name.name) {
        // It stands for something else, or who knows.
        return context.lower(value, &Locals::of(0));
    }
    let expr = Expr { kind: ExprKind::Name(name.name.clone()), span: value.span };
    context.lower(&expr, &Locals::of(0))
}

/// Settles the clock, and notes how much of it is certain.
fn settle_clock<'a>(context: &mut Context<'a>, file: &'a ScenarioFile, told: &mut Told) -> Lowered<()> {
    let mut found: [Option<(&Expr, Span)>; 2] = [None, None];
    // What a slip of the pen was probably meant to set.
    let mut meant = [false; 2];
    let mut sure = [true; 2];
    let mut failed = false;
    for item in &file.items {
        let Item::Setting { name, value } = item else { continue };
        let slot = match name.name.as_str() {
            "horizon" => 0,
            "step" => 1,
            _ => {
                let error = symbols::unknown(
                    "setting",
                    &name.name,
                    name.span,
                    Code::E0207,
                    ["horizon", "step"].into_iter(),
                );
                let near = symbols::meant(&name.name, &["horizon", "step"]);
                meant = [meant[0] || near == Some("horizon"), meant[1] || near == Some("step")];
                let general =
                    "the settings of a scenario are `horizon` and `step`; a constant begins with `const`";
                let hint = match &error.hint {
                    Some(near) => format!("{near} {general}"),
                    None => general.to_owned(),
                };
                context.note(error.hint(hint));
                failed = true;
                continue;
            }
        };
        if let Some((_, first)) = found[slot] {
            let error =
                error!(E0202, name.span, "`{}` is set twice", name.name).related(first, "first set here");
            context.note(error);
            failed = true;
        }
        sure[slot] &= found[slot].is_none();
        found[slot] = Some((value, name.span));
        context.time.clock_at.push(value.span);
    }
    if file.items.is_empty() {
        return Err(Reported);
    }
    let [horizon, step] = found;
    let title = file.items.iter().find_map(|item| match item {
        Item::Title(text) => Some(text.span),
        _ => None,
    });
    let start = context.sources.first().map(|source| Span::new(source.id, 0, 0));
    let place = title.or(start).unwrap_or_default();
    let mut missing = Vec::new();
    // Processes alone need no step: they have their own, or rates.
    let free = step.is_none() && !context.processes.is_empty() && !clock::has_bodies(file);
    if !free {
        // Should the step or the horizon be wrong: bounds in seconds still make sense.
        context.time.clock = Clock::Stepped(Decimal::ONE);
    }
    if step.is_none() && !free && !meant[1] {
        missing.push(("step", "0.02 s"));
    }
    if horizon.is_none() && !meant[0] {
        missing.push(("horizon", "30 s"));
    }
    if !missing.is_empty() {
        let names: Vec<&str> = missing.iter().map(|(name, _)| *name).collect();
        let lines: Vec<String> = missing.iter().map(|(name, value)| format!("`{name} = {value}`")).collect();
        context.note(
            error!(E0505, place, "the scenario has no {}", names.join(" and no ");
                hint: "write {}", lines.join(" and "))
            .about(About::Clock),
        );
        failed = true;
    }
    if free {
        context.time.clock = Clock::Steps;
        let Some((horizon, _)) = horizon else { return Err(Reported) };
        if process::has_timing(file) {
            return settle_continuous(context, horizon, failed);
        }
        return settle_horizon(context, horizon, failed);
    }
    let Some((step, _)) = step else {
        // What is wrong with the one that is there is said too.
        let _ = horizon.map(|(horizon, _)| context.number_of(horizon, Dimension::TIME, &Locals::of(0)));
        return Err(Reported);
    };
    let length = context.number_of(step, Dimension::TIME, &Locals::of(0));
    let sure_step = sure[1] && !meant[1];
    if (length.is_err() || !sure_step)
        && let Some((horizon, _)) = horizon
        && !context.text(horizon.span).contains("step")
    {
        // What is wrong with the horizon is said too.
        let _ = context.number_of(horizon, Dimension::TIME, &Locals::of(0));
    }
    let Some(exact) = length?.exact.filter(|e| !e.is_zero() && !e.is_negative()) else {
        return context.report(error!(E0505, step.span, "the step must be a positive time"));
    };
    context.time.clock = Clock::Stepped(exact);
    if !sure_step {
        return Err(Reported);
    }
    *told = Told::Step;
    let Some((horizon, _)) = horizon else { return Err(Reported) };
    let settled = settle_horizon(context, horizon, failed);
    // It was found, though something else is wrong.
    if sure[0] && !meant[0] && context.time.horizon > Tick(0) {
        *told = Told::Whole;
    }
    settled
}

/// Continuous time up to a horizon.
fn settle_continuous(context: &mut Context<'_>, horizon: &Expr, failed: bool) -> Lowered<()> {
    let end = context.number_of(horizon, Dimension::TIME, &Locals::of(0))?;
    if end.value <= 0.0 {
        return context.report(error!(E0505, horizon.span, "the horizon must be positive"));
    }
    let tick = moments::tick(end.exact, end.value, &context.time.measured);
    let Some((tick, last)) = tick.and_then(|(tick, end)| Some((tick, end.div(tick)?.as_whole()?))) else {
        return context.report(error!(E0501, horizon.span, "the time is out of range"));
    };
    context.time.clock = Clock::Jumps(tick);
    context.time.horizon = Tick(last as u64);
    if failed { Err(Reported) } else { Ok(()) }
}

fn settle_horizon(context: &mut Context<'_>, horizon: &Expr, failed: bool) -> Lowered<()> {
    let end = context.time(horizon, &Locals::of(0))?;
    match end {
        Some(Tick(0)) => context.report(error!(E0505, horizon.span, "the horizon must be positive")),
        Some(tick) if tick.0 <= MOST_TICKS => {
            context.time.horizon = tick;
            if failed { Err(Reported) } else { Ok(()) }
        }
        _ => context.report(error!(E0505, horizon.span, "a trial can have at most {MOST_TICKS} steps")),
    }
}
