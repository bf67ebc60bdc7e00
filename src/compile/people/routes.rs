//! Routes and moves.

use crate::base::geometry::Shape;
use crate::base::tick::Tick;
use crate::compile::context::{
    Context, Locals, Lowered, Reported, people::People, symbols::Meaning, typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    builtin::{CHOICES, QUICKEST},
    laws::waiting,
    shapes,
};
use crate::compile::scene::periodic;
use crate::model::{AgentId, Goal, Leg, Move, Moves, Region, RegionId, Route, Who};
use crate::syntax::ast::{self, Expr, Ident, Item, MoveOption, MovesDecl, PathsDecl, ScenarioFile, Value};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// Most options of a `moves` declaration.
const MOST_OPTIONS: usize = 1000;
/// Most alternatives of a `paths` declaration.
const MOST_PATHS: i64 = 64;

/// A route as written.
pub(crate) fn route(context: &mut Context<'_>, value: &Value, locals: &Locals) -> Lowered<Route> {
    periodic::refuse_if_periodic(context, value.span(), "routes", "write `direction = 0 deg` in the agent")?;
    match value {
        Value::Plain(expr) => {
            let goal = goal(context, expr, locals)?;
            Ok(Route::Legs { legs: vec![Leg::To(goal)], then_leave: false })
        }
        Value::Route(route) => {
            let mut legs = Vec::with_capacity(route.legs.len());
            for leg in &route.legs {
                legs.push(match leg {
                    ast::Leg::Goal(expr) => goal(context, expr, locals).map(Leg::To),
                    ast::Leg::Wait(value) => waiting(context, value, locals, "a waiting time").map(Leg::Wait),
                });
            }
            let legs: Vec<Leg> = legs.into_iter().collect::<Lowered<_>>()?;
            if let Some(span) = route.then_leave
                && !legs.iter().any(|leg| matches!(leg, Leg::To(_)))
            {
                return context.report(error!(E0408, span, "`then leave` needs a goal before it"));
            }
            Ok(Route::Legs { legs, then_leave: route.then_leave.is_some() })
        }
        other => context.report(error!(E0305, other.span(), "expected a route";
                    hint: "write goals joined by arrows: `(9, 3) -> exit`")),
    }
}

pub(crate) fn goal(context: &mut Context<'_>, expr: &Expr, locals: &Locals) -> Lowered<Goal> {
    // People are not known yet where routes are settled, and never are goals.
    if let ast::ExprKind::Name(name) = &expr.kind
        && let Some((_, meaning @ (Meaning::Declared | Meaning::Agent(_) | Meaning::Agents { .. }))) =
            context.look_up(name, locals.scope)
        && locals.names.iter().all(|(bound, _)| bound != name)
    {
        let said = format!("expected a region or a point as a goal, found {}", meaning.noun());
        return context.report(error!(E0305, expr.span, "{said}"));
    }
    if let ast::ExprKind::Call { function, arguments } = &expr.kind
        && CHOICES.contains(&function.name.as_str())
        && context.look_up(&function.name, locals.scope).is_none()
    {
        return choice(context, (function, expr.span), arguments, locals);
    }
    match context.lower(expr, locals)? {
        Typed::Region(id) => Ok(Goal::Region(id)),
        Typed::Point(x, y) => shapes::place(context, expr.span, (x, y)).map(Goal::Point),
        found => context.mismatch(expr.span, "a region or a point as a goal", &found),
    }
}

/// `nearest(west, east)`, `quickest(west, east)`: a region that nobody declares, made of the exits.
fn choice(
    context: &mut Context<'_>,
    (function, span): (&Ident, Span),
    exits: &[Expr],
    locals: &Locals,
) -> Lowered<Goal> {
    let name = &function.name;
    let lowered = context.lower_all(exits, locals)?;
    if exits.len() < 2 {
        let hint = match exits {
            [one] => format!("write the region alone: `route = {}`", context.text(one.span)),
            _ => format!("name the exits: `route = {name}(west, east)`"),
        };
        return context.report(error!(E0204, span, "`{name}` needs two exits or more"; hint: "{hint}"));
    }
    let mut ids = Vec::new();
    let mut shapes = Vec::new();
    for (exit, typed) in exits.iter().zip(lowered) {
        let Typed::Region(id) = typed else {
            return context.mismatch(exit.span, "a region as an exit", &typed);
        };
        shapes.push((exit.span, shapes::region_shape(context, id, exit.span)));
        ids.push(id);
    }
    let names: Vec<&str> = ids.iter().map(|id| context.scene.regions[id.0 as usize].name.as_str()).collect();
    let text = format!("{name}({})", names.join(", "));
    if let Some(known) = context.scene.regions.iter().position(|region| region.name == text) {
        return Ok(Goal::Region(RegionId(known as u32)));
    }
    let shape = shapes::joined(context, shapes)?;
    let exits = if name == QUICKEST { ids } else { Vec::new() };
    context.shapes.push(Some(Ok(shape.clone())));
    context.scene.regions.push(Region { exits, ..Region::new(text, shape) });
    Ok(Goal::Region(RegionId(context.scene.regions.len() as u32 - 1)))
}

/// The moves of a scenario; each agent has one list of them.
pub(crate) fn all_moves<'a>(
    context: &mut Context<'a>,
    file: &'a ScenarioFile,
    people: &People,
) -> Vec<Moves> {
    let mut moves: Vec<Moves> = Vec::new();
    let mut declared: Vec<Span> = Vec::new();
    for item in &file.items {
        let (one, name) = match item {
            Item::Moves(decl) => (lower_moves(context, decl, people), &decl.agent),
            Item::Paths(decl) => (lower_paths(context, decl, people), &decl.agent),
            _ => continue,
        };
        let Ok(one) = one else {
            context.roster.advised = None;
            continue;
        };
        let (key, what) = one.key();
        if let Some(advised) = &mut context.roster.advised {
            advised.insert(key);
        }
        if let Some(first) = moves.iter().position(|known| known.key().0 == key) {
            let said = format!("the {what} of `{}` are declared twice", name.name);
            let error = error!(E0406, name.span, "{said}")
                .related(declared[first], "first declared here")
                .hint("write all options in one list");
            context.note(error);
        }
        moves.push(one);
        declared.push(name.span);
    }
    moves
}

/// `moves user for 2 s { … }`
fn lower_moves<'a>(context: &mut Context<'a>, decl: &'a MovesDecl, people: &People) -> Lowered<Moves> {
    let agents = advised_agents(context, (&decl.agent, decl.member.as_ref()), "moves", people);
    let duration = context.time(&decl.duration, &Locals::default());
    let mut options: Vec<(String, Move)> = Vec::new();
    let mut routes: Vec<Route> = Vec::new();
    let mut failed = false;
    for option in &decl.options {
        failed |= lower_option(context, option, &mut options, &mut routes).is_err();
    }
    let agents = agents?;
    let [agent, others @ ..] = agents.as_slice() else { return Err(Reported) };
    let Some(duration) = duration? else {
        return context.report(error!(E0406, decl.duration.span, "the duration of a move must be finite"));
    };
    if duration == Tick(0) {
        let error = error!(E0406, decl.duration.span, "the duration of a move must be positive");
        return context.report(error);
    }
    if failed {
        return Err(Reported);
    }
    if options.is_empty() {
        return context.report(error!(E0406, decl.span, "the moves have no option";
                    hint: "write for example `heading from -60 deg to 60 deg by 15 deg` and `stop`"));
    }
    // The agent's own way is always an option.
    options.insert(0, ("own way".to_owned(), Move::Own));
    Ok(Moves { agent: *agent, others: others.to_vec(), duration, options, routes, paths: None })
}

/// `paths people[1] { roadmap alternatives 4 }`: which paths there are is known when the roadmap is drawn.
fn lower_paths<'a>(context: &mut Context<'a>, decl: &'a PathsDecl, people: &People) -> Lowered<Moves> {
    let agents = advised_agents(context, (&decl.agent, decl.member.as_ref()), "paths", people);
    let number = context.number_of(&decl.alternatives, Dimension::NONE, &Locals::default())?;
    let Some(most) = number.as_whole().filter(|n| (1..=MOST_PATHS).contains(n)) else {
        let said = format!(
            "the number of alternatives must be a whole number from 1 to {MOST_PATHS} (got {})",
            number.value
        );
        return context.report(error!(E0406, decl.alternatives.span, "{said}"));
    };
    let [agent] = agents?[..] else { return Err(Reported) };
    if !context.scene.storeys.are_none() {
        let said = "the paths between which one chooses need a scene without levels";
        return context
            .report(error!(E0412, decl.agent.span, "{said}"; hint: "rank moves with routes instead"));
    }
    if people.agents[agent.0 as usize].body.planner.is_none() {
        let said = format!("`{}` does not plan, and has no paths", people.agents[agent.0 as usize].name);
        let error = error!(E0406, decl.agent.span, "{said}");
        return context.report(
            error.hint("declare its kind as `planned`: `kind planner: planned { limit speed = 1.5 m/s }`"),
        );
    }
    let first = people.agents[agent.0 as usize].route.goals().next();
    if let Some(Goal::Region(id)) = first
        && let Shape::Parts(_) = context.scene.regions[id.0 as usize].shape
    {
        let said = format!("`{}` chooses between exits, and paths lead to one goal", decl.agent.name);
        return context.report(error!(E0408, decl.agent.span, "{said}"; hint: "name one region as the goal"));
    }
    let options = (0..most as u32).map(|k| (format!("path {}", k + 1), Move::Path(k))).collect();
    Ok(Moves {
        agent,
        others: Vec::new(),
        duration: Tick(0),
        options,
        routes: Vec::new(),
        paths: Some(Vec::new()),
    })
}

/// The one agent that moves or paths belong to; or, of moves, all members of a group that is simulated one by one.
fn advised_agents(
    context: &mut Context<'_>,
    (name, member): (&Ident, Option<&Expr>),
    what: &str,
    people: &People,
) -> Lowered<Vec<AgentId>> {
    let plain = Expr { kind: ast::ExprKind::Name(name.name.clone()), span: name.span };
    let expr = match member {
        Some(member) => Expr {
            span: name.span.to(member.span),
            kind: ast::ExprKind::Index(Box::new(plain), Box::new(member.clone())),
        },
        None => plain,
    };
    let lowered = context.lower(&expr, &Locals::default());
    if lowered.is_err()
        && let Some(error) = context.sink.diagnostics.last_mut()
        && error.code == Code::E0201
        && error.hint.is_none()
    {
        let names = context.roster.agent_names.iter().map(|name| name.split('[').next().unwrap_or(name));
        let mut names: Vec<&str> = names.collect();
        names.dedup();
        error.hint =
            Some(format!("the scenario declares {}", names.join(", "))).filter(|_| !names.is_empty());
    }
    let typed = lowered?;
    let group_of = |agent: AgentId| people.agents.get(agent.0 as usize).and_then(|agent| agent.group);
    if let Typed::Agents { set, particle: false } = &typed
        && what == "moves"
        && let Some(group) = set.members.first().and_then(|agent| group_of(*agent))
        && set.members.iter().all(|agent| group_of(*agent) == Some(group))
    {
        return Ok(set.members.to_vec());
    }
    let is_one = matches!(&typed, Typed::Agents { set, particle: true } if set.members.len() == 1);
    if matches!(typed, Typed::Agents { .. }) && !is_one {
        let said = format!("{what} must belong to one agent");
        return context.report(error!(E0406, expr.span, "{said}";
                hint: "write one member or a group, such as `{}[1]`, or declare a single agent: `agent user: …`", name.name));
    }
    match context.as_agent(typed, expr.span)? {
        Who::Agent(agent) if people.agents.get(agent.0 as usize).is_some() => Ok(vec![agent]),
        _ => Err(Reported),
    }
}

/// The agents that leave after a move, by the names that are written.
pub(crate) fn leave_by_moves(context: &mut Context<'_>, file: &ScenarioFile) {
    let leaves = |option: &MoveOption| matches!(option, MoveOption::Route { route: Value::Route(route), .. } if route.then_leave.is_some());
    for item in &file.items {
        if let Item::Moves(decl) = item
            && decl.options.iter().any(leaves)
        {
            // Of a member whose number is computed, any may be meant.
            let of = |name: &String| {
                name.strip_prefix(decl.agent.name.as_str())
                    .is_some_and(|rest| rest.is_empty() || decl.member.is_some() && rest.starts_with('['))
            };
            for agent in 0..context.roster.agent_names.len() {
                if of(&context.roster.agent_names[agent]) {
                    context.roster.passing.insert(AgentId(agent as u32));
                }
            }
        }
    }
}

fn lower_option(
    context: &mut Context<'_>,
    option: &MoveOption,
    options: &mut Vec<(String, Move)>,
    routes: &mut Vec<Route>,
) -> Lowered<()> {
    match option {
        MoveOption::Route { name, route: written, span } => {
            let label = format!("route {}", name.name);
            let route = route(context, written, &Locals::default())?;
            let goes = matches!(&route, Route::Legs { legs, .. } if legs.iter().any(|leg| matches!(leg, Leg::To(_))));
            if !goes {
                let error = error!(E0406, written.span(), "`{label}` has no goal";
                            hint: "write for example `{label} = (9, 3) -> exit`");
                return context.report(error);
            }
            if options.iter().any(|(known, _)| *known == label) {
                return context.report(error!(E0406, *span, "`{label}` is listed twice";
                        hint: "give one of them another name"));
            }
            options.push((label, Move::Route(routes.len())));
            routes.push(route);
            Ok(())
        }
        MoveOption::Stop(span) => {
            if options.iter().any(|(_, m)| *m == Move::Stop) {
                return context.report(error!(E0406, *span, "`stop` is listed twice"));
            }
            options.push(("stop".to_owned(), Move::Stop));
            Ok(())
        }
        MoveOption::Heading(angle) => {
            let number = context.number_of(angle, Dimension::ANGLE, &Locals::default())?;
            heading(context, number.value, angle.span, options)
        }
        MoveOption::Headings { from, to, by, span } => {
            let ends = (
                context.number_of(from, Dimension::ANGLE, &Locals::default()),
                context.number_of(to, Dimension::ANGLE, &Locals::default()),
                context.number_of(by, Dimension::ANGLE, &Locals::default()),
            );
            let (from, to, by) = (ends.0?.value, ends.1?.value, ends.2?.value);
            if by <= 0.0 || to < from {
                return context.report(error!(
                    E0406,
                    *span, "headings must go up from the first to the last by a positive angle"
                ));
            }
            // As a float: a count of headings can be larger than any whole number of the machine.
            let steps = ((to - from) / by + 1e-9).floor();
            if steps >= MOST_OPTIONS.saturating_sub(options.len()) as f64 {
                return context
                    .report(error!(E0406, *span, "the moves have more than {MOST_OPTIONS} options"));
            }
            for k in 0..=steps as usize {
                let angle = from + by * k as f64;
                // What is zero but for rounding is the direct way.
                let angle = if angle.abs() < 1e-12 { 0.0 } else { angle };
                heading(context, angle, *span, options)?;
            }
            Ok(())
        }
    }
}

/// One heading more; full turns do not make it another.
fn heading(
    context: &mut Context<'_>,
    angle: f64,
    span: Span,
    options: &mut Vec<(String, Move)>,
) -> Lowered<()> {
    let label = heading_label(angle);
    let same = |other: &Move| match other {
        Move::Heading(known) => {
            let turns = (angle - known) / std::f64::consts::TAU;
            (turns - turns.round()).abs() < 1e-9
        }
        Move::Stop | Move::Own | Move::Route(_) | Move::Path(_) => false,
    };
    if let Some((known, _)) = options.iter().find(|(_, option)| same(option)) {
        let text = if *known == label {
            format!("`{label}` is listed twice")
        } else {
            format!("`{label}` is listed twice, first as `{known}`")
        };
        return context.report(error!(E0406, span, "{text}"));
    }
    options.push((label, Move::Heading(angle)));
    Ok(())
}

fn heading_label(angle: f64) -> String {
    let degrees = angle.to_degrees();
    let rounded = (degrees * 1e6).round() / 1e6;
    let rounded = if rounded == 0.0 { 0.0 } else { rounded };
    format!("heading {rounded} deg")
}
