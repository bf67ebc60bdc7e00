//! Rankings: their options, each of which is a world and perhaps a move in it, their score and their procedure.

use crate::compile::context::{
    Context, Locals, Lowered, Reported, number::Number, symbols::ScopeId, typed::Typed,
};
use crate::compile::query::{
    aims::{self, Others},
    bindings,
    checks::unlike,
    clauses,
    compiler::Compiler,
    families::Allowance,
    measures::{self, Observed, Sketch, What},
    settings::{self, Setting},
};
use crate::compile::study::{Ask, MeasureKind, Query, RankOption};
use crate::logic::Root;
use crate::logic::Tree;
use crate::model::{AgentId, Bool, Move, Num, Set, Who};
use crate::stats::ranking::Ranking;
use crate::stats::spec::Make;
use crate::syntax::ast::{self, Clauses, Expr, Ident, Ranked, Values};
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// Most options of a ranking of values.
const MOST_OPTIONS: usize = 1000;

/// An option before its score is lowered.
struct Candidate {
    world: usize,
    label: String,
    settings: Vec<(String, String)>,
    advice: Option<(usize, usize)>,
    deviation: f64,
}

/// A ranking: its options, by which score; and the world of the first of them.
pub(crate) fn rank<'a>(
    compiler: &mut Compiler<'a>,
    site: usize,
    of: &'a Ranked,
    (measure, others): (&ast::Measure, Others<'_>),
    clauses: &'a Clauses,
    family: Option<f64>,
    scope: ScopeId,
) -> Lowered<(Ask, bool, usize)> {
    let locals = Locals::of(scope);
    let (candidates, measured, sketch) = match of.values.as_slice() {
        [] => {
            let (measured, sketch) = compiler.measured(site, measure, scope);
            (together(compiler, (site, site), &of.moves, &locals), vec![measured], sketch)
        }
        list => {
            let candidates = combinations(compiler, site, list, clauses, scope);
            let candidates = match of.moves.as_slice() {
                [] => candidates,
                moved => candidates.and_then(|all| with_moves(compiler, site, moved, all, &locals)),
            };
            let context = &compiler.sites[site].context;
            let (before, failures) = (context.sink.diagnostics.len(), context.names.failures());
            let worlds = candidates.as_ref().map_or(vec![site], |all| worlds(all));
            let (measured, sketches): (Vec<_>, Vec<_>) =
                worlds.into_iter().map(|world| compiler.measured(world, measure, scope)).unzip();
            if candidates.is_err() {
                // The world of the query stands in for those that could not be set up.
                let context = &mut compiler.sites[site].context;
                context.keep_sure(before);
                context.names.forget_but_circles(&failures);
            }
            (candidates, measured, sketches.first().copied().unwrap_or(Sketch::PROBABILITY))
        }
    };
    let context = &mut compiler.sites[site].context;
    let rankable = if sketch.what == What::Quantile {
        let error = error!(E0607, measure.span, "a ranking accepts only `P(…)`, `E(…)` and `CVaR(…)`");
        context.report(error)
    } else {
        Ok(())
    };
    // In which unit a loss would be is not known then.
    let known = if rankable.is_ok() { sketch } else { Sketch { dimension: None, ..sketch } };
    let allowance = Allowance { family, claims: 1 };
    let procedure = clauses::ranking(context, clauses, (known, measure.span), allowance, &locals);
    if let (Ok(Make::Ranking(Ranking::Okamoto)), true, Some(method)) =
        (procedure.as_ref().map(|chosen| chosen.spec.make), sketch.what.has_range(), &clauses.by)
    {
        let error = error!(E0607, method.span, "`okamoto` ranks only by `P(…)`";
                hint: "remove `by okamoto`: the default procedure also ranks by `E(…)`, and needs fewer trials");
        return context.report(error);
    }
    rankable?;
    let measured: Vec<_> = measured.into_iter().collect::<Lowered<_>>()?;
    let (candidates, ranking) = (candidates?, procedure?);
    let (first, unbounded) = measured[0].clone();
    // Options of one world share its measure.
    let worlds = worlds(&candidates);
    let at = |one: &Candidate| worlds.iter().position(|world| *world == one.world).unwrap_or_default();
    let each: Vec<_> = candidates.iter().map(|one| &measured[at(one)].0).collect();
    for (other, candidate) in each.iter().zip(&candidates) {
        if matches!(first.kind, MeasureKind::Expectation { .. }) && other.kind != first.kind {
            let settings = [candidates[0].settings.clone(), candidate.settings.clone()];
            let error =
                unlike(measure, "all options of a ranking need", [&first.kind, &other.kind], &settings);
            return compiler.sites[site].context.report(error);
        }
    }
    let asked = aims::beside(compiler, (site, &worlds), (measure, &others), clauses, scope)?;
    // A parameter may matter to a constraint alone.
    if asked.is_empty() {
        check_used(compiler, site, &of.values, &candidates, measure, scope)?;
    }
    let world = first.target.world;
    let columns = |world: usize| asked.iter().map(|(_, columns)| columns[world]).collect();
    let places: Vec<usize> = candidates.iter().map(at).collect();
    let options = each.into_iter().zip(candidates).zip(places).map(|((measure, c), place)| RankOption {
        label: c.label,
        settings: c.settings,
        target: measure.target,
        beside: columns(place),
        advice: c.advice,
        deviation: c.deviation,
    });
    let options = options.collect();
    let beside = asked.iter().map(|(one, _)| one.clone()).collect();
    Ok((Ask::Rank { options, measure: first, ranking, models: 1, beside }, unbounded, world))
}

/// The options of the moves of one agent, or all combinations of those of several, in a world. Errors are those of `site`.
fn together(
    compiler: &mut Compiler<'_>,
    (site, world): (usize, usize),
    moved: &[(Ident, Expr)],
    locals: &Locals,
) -> Lowered<Vec<Candidate>> {
    let each: Vec<_> =
        moved.iter().map(|(what, agent)| moves(compiler, world, what, agent, locals)).collect();
    let each: Vec<Vec<Candidate>> = each.into_iter().collect::<Lowered<_>>()?;
    let [(what, _), ..] = moved else { return Err(Reported) };
    if each.len() == 1 {
        return Ok(each.into_iter().flatten().collect());
    }
    let declaration = |all: &[Candidate]| all.first().and_then(|one| one.advice).map(|(at, _)| at);
    for (k, (_, agent)) in moved.iter().enumerate() {
        if each[..k].iter().any(|known| declaration(known) == declaration(&each[k])) {
            let error = error!(E0606, agent.span, "the moves of one agent are listed twice");
            return compiler.sites[site].context.report(error.hint("name another agent"));
        }
    }
    let count = each.iter().map(Vec::len).fold(1, usize::saturating_mul);
    if count > MOST_OPTIONS {
        let said = format!("a ranking has at most {MOST_OPTIONS} options (got {count})");
        return compiler.sites[site].context.report(error!(E0606, what.span, "{said}"));
    }
    // Those of the first agent slowest.
    let mut rows: Vec<Vec<(usize, usize)>> = vec![Vec::new()];
    for all in &each {
        let own: Vec<(usize, usize)> = all.iter().filter_map(|one| one.advice).collect();
        rows = rows.iter().flat_map(|row| own.iter().map(|one| [row.as_slice(), &[*one]].concat())).collect();
    }
    let Some(scenario) = &compiler.sites[world].scenario else { return Err(Reported) };
    let candidate = |(k, row): (usize, &Vec<(usize, usize)>)| {
        let advice = scenario.together(row)?;
        let label = scenario.move_name(advice)?;
        Some(Candidate { world, label, settings: Vec::new(), advice: Some(advice), deviation: k as f64 })
    };
    let all: Option<Vec<Candidate>> = rows.iter().enumerate().map(candidate).collect();
    let Some(all) = all else {
        let error = error!(
            E0606,
            moved[moved.len() - 1].0.span,
            "a ranking combines the moves of at most four agents"
        );
        return compiler.sites[site].context.report(error);
    };
    Ok(all)
}

/// The options of moves.
fn moves(
    compiler: &mut Compiler<'_>,
    site: usize,
    what: &Ident,
    agent: &Expr,
    locals: &Locals,
) -> Lowered<Vec<Candidate>> {
    let context = &mut compiler.sites[site].context;
    let paths = what.name == "paths";
    let wanted = if paths || what.name == "moves" {
        Ok(())
    } else {
        let error = error!(E0606, what.span, "`{}` cannot be ranked", what.name;
                    hint: "write `rank moves of …` or `rank paths of …`");
        context.report(error)
    };
    let typed = context.lower(agent, locals)?;
    let all = match typed {
        Typed::Agents { set, particle: false } if !paths && is_advised(context, &set) => set.members,
        typed => match context.as_agent(typed, agent.span)? {
            Who::Agent(id) => [id].into(),
            Who::Running(_) => return Err(Reported),
        },
    };
    // A group is known by its first member.
    let id = all[0];
    wanted?;
    let advised = &compiler.sites[site].context.roster.advised;
    // If some moves have errors, their agents are unknown.
    if advised.as_ref().is_some_and(|advised| !advised.contains(&(id, paths))) {
        return without_moves(&mut compiler.sites[site].context, (id, paths), agent.span);
    }
    let Some(scenario) = &compiler.sites[site].scenario else { return Err(Reported) };
    let Some(number) = scenario.moves.iter().position(|m| m.key().0 == (id, paths)) else {
        return Err(Reported);
    };
    let moves = &scenario.moves[number];
    if !moves.agents().eq(all.iter().copied()) {
        return without_moves(&mut compiler.sites[site].context, (id, paths), agent.span);
    }
    let all = moves.options.iter().zip(moves.deviations()).enumerate();
    let candidate = |(k, ((label, _), deviation)): (usize, (&(String, Move), f64))| Candidate {
        world: site,
        label: label.clone(),
        settings: Vec::new(),
        advice: Some((number, k)),
        deviation,
    };
    Ok(all.map(candidate).collect())
}

/// Whether moves are declared for all of a set, by its first member.
fn is_advised(context: &Context<'_>, set: &Set) -> bool {
    let first = set.members.first().map(|first| (*first, false));
    set.except.is_none()
        && set.members.len() > 1
        && first.is_some_and(|first| {
            context.roster.advised.as_ref().is_none_or(|advised| advised.contains(&first))
        })
}

/// The worlds of some options, each once, in their order.
fn worlds(candidates: &[Candidate]) -> Vec<usize> {
    let mut worlds: Vec<usize> = Vec::new();
    for one in candidates {
        if worlds.last() != Some(&one.world) {
            worlds.push(one.world);
        }
    }
    worlds
}

/// Each combination of values with each of the moves of its world.
fn with_moves(
    compiler: &mut Compiler<'_>,
    site: usize,
    moved: &[(Ident, Expr)],
    combinations: Vec<Candidate>,
    locals: &Locals,
) -> Lowered<Vec<Candidate>> {
    // Errors are those of the world of the query.
    together(compiler, (site, site), moved, locals)?;
    let mut all = Vec::new();
    for combination in combinations {
        let moves = together(compiler, (site, combination.world), moved, locals)?;
        let valued = |own: Candidate| Candidate {
            label: format!("{}, {}", own.label, combination.label),
            settings: combination.settings.clone(),
            ..own
        };
        all.extend(moves.into_iter().map(valued));
    }
    if all.len() > MOST_OPTIONS {
        let said = format!("a ranking has at most {MOST_OPTIONS} options (got {})", all.len());
        return compiler.sites[site].context.report(error!(E0606, moved[0].0.span, "{said}"));
    }
    for (k, one) in all.iter_mut().enumerate() {
        one.deviation = k as f64;
    }
    Ok(all)
}

/// All combinations of the values of some parameters, those of the first slowest.
fn combinations<'a>(
    compiler: &mut Compiler<'a>,
    site: usize,
    list: &'a [(Ident, Values)],
    clauses: &'a Clauses,
    scope: ScopeId,
) -> Lowered<Vec<Candidate>> {
    let mut points: Vec<BTreeMap<String, Number>> = vec![compiler.sites[site].settings.clone()];
    let mut failed = false;
    for (k, (name, values)) in list.iter().enumerate() {
        let is_set = set_elsewhere(compiler.input.settings, name, &list[..k], clauses);
        let context = &mut compiler.sites[site].context;
        if let Some((said, place, label)) = is_set {
            let error = error!(E0210, name.span, "{said}");
            context.note(error.related(place, label).hint("remove one of them"));
            failed = true;
            continue;
        }
        let locals = Locals::of(scope);
        let Ok(numbers) = settings::values(context, (&name.name, name.span), values, MOST_OPTIONS, &locals)
        else {
            failed = true;
            continue;
        };
        let count = points.len().saturating_mul(numbers.len());
        if count > MOST_OPTIONS {
            let said = format!("a ranking has at most {MOST_OPTIONS} options (got {count})");
            return context.report(error!(E0606, name.span, "{said}"));
        }
        let with = |point: &BTreeMap<String, Number>, number: &Number| {
            let mut point = point.clone();
            point.insert(name.name.clone(), *number);
            point
        };
        points = points.iter().flat_map(|point| numbers.iter().map(|n| with(point, n))).collect();
    }
    if failed {
        return Err(Reported);
    }
    let names: Vec<&str> = list.iter().map(|(name, _)| name.name.as_str()).collect();
    let own = |name: &str| list.iter().find(|(own, _)| own.name == name).or(list.last());
    let mut candidates = Vec::with_capacity(points.len());
    for (k, point) in points.into_iter().enumerate() {
        let settings = compiler.described(site, &point, &names);
        // What was set elsewhere, too, has to lie in a range that is set here.
        let ends = |name: &String| Some((name.clone(), own(name)?.1.ends()));
        let set: Vec<_> = point.keys().filter_map(ends).collect();
        let world = compiler.site(point);
        failed |= bindings::check_ranges(compiler, world, set).is_err();
        let texts: Vec<String> = settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let label = texts.join(", ");
        candidates.push(Candidate { world, label, settings, advice: None, deviation: k as f64 });
    }
    if failed { Err(Reported) } else { Ok(candidates) }
}

/// Whether each ranked parameter makes a difference.
fn check_used(
    compiler: &mut Compiler<'_>,
    site: usize,
    list: &[(Ident, Values)],
    candidates: &[Candidate],
    measure: &ast::Measure,
    scope: ScopeId,
) -> Lowered<()> {
    for (k, (name, _)) in list.iter().enumerate() {
        let others = |one: &Candidate| -> Vec<(String, String)> {
            let of_others = one.settings.iter().enumerate().filter(|(at, _)| *at != k);
            of_others.map(|(_, setting)| setting.clone()).collect()
        };
        // Those that differ in this parameter alone, and the first of them.
        let mut firsts: BTreeMap<Vec<(String, String)>, usize> = BTreeMap::new();
        let mut differs = candidates.iter().all(|one| one.settings[k] == candidates[0].settings[k]);
        for one in candidates {
            let first = *firsts.entry(others(one)).or_insert(one.world);
            differs = differs || is_other(compiler, first, one.world, measure, scope)?;
            if differs {
                break;
            }
        }
        if !differs {
            let said = format!("the values of `{}` make no difference", name.name);
            let error = error!(E0606, name.span, "{said}").about(About::Idle);
            return compiler.sites[site].context.report(
                error.hint("rank a parameter on which the scenario or the measure depends for these values"),
            );
        }
    }
    Ok(())
}

/// Whether a measure may have other values in another world.
fn is_other(
    compiler: &mut Compiler<'_>,
    one: usize,
    other: usize,
    measure: &ast::Measure,
    scope: ScopeId,
) -> Lowered<bool> {
    if compiler.sites[one].scenario != compiler.sites[other].scenario {
        return Ok(true);
    }
    let mut alone = |site: usize| alone(&mut compiler.sites[site].context, measure, scope);
    Ok(alone(one)? != alone(other)?)
}

/// Where else a ranked parameter is set; a sweep has other queries to serve.
fn set_elsewhere(
    settings: &[Setting],
    name: &Ident,
    before: &[(Ident, Values)],
    clauses: &Clauses,
) -> Option<(String, Span, &'static str)> {
    let name = &name.name;
    if let Some((first, _)) = before.iter().find(|(own, _)| own.name == *name) {
        return Some((format!("`{name}` is listed twice"), first.span, "first listed here"));
    }
    if let Some(common) = clauses.under.iter().find(|common| common.name.name == *name) {
        return Some((format!("`{name}` is set twice"), common.name.span, "set here for all options"));
    }
    let set = settings.iter().find(|set| set.name == *name && set.values.is_single())?;
    Some((format!("`{name}` is ranked, but the call sets it"), set.span, "set here"))
}

/// All that a measure is made of.
type Alone = (Tree, Vec<Bool>, Vec<Num>, Root, MeasureKind);

/// What a measure is in this world, whatever else is observed there.
fn alone(context: &mut Context<'_>, measure: &ast::Measure, scope: ScopeId) -> Lowered<Alone> {
    let tree = std::mem::take(&mut context.observed.tree);
    let (atoms, signals) =
        (std::mem::take(&mut context.observed.atoms), std::mem::take(&mut context.observed.signals));
    let (texts, before) =
        (std::mem::take(&mut context.observed.texts), std::mem::take(&mut context.observed.atoms_before));
    let (observed, _) = measures::measure(context, measure, scope);
    let tree = std::mem::replace(&mut context.observed.tree, tree);
    let (atoms, signals) = (
        std::mem::replace(&mut context.observed.atoms, atoms),
        std::mem::replace(&mut context.observed.signals, signals),
    );
    (context.observed.texts, context.observed.atoms_before) = (texts, before);
    observed.map(|Observed { column, kind, .. }| (tree, atoms, signals, column.root, kind))
}

/// Reports that an agent has no moves.
fn without_moves<T>(context: &mut Context<'_>, (id, paths): (AgentId, bool), at: Span) -> Lowered<T> {
    // One that could not be declared was reported.
    let Some(name) =
        context.roster.agent_names.get(id.0 as usize).filter(|_| !context.roster.undeclared.contains(&id))
    else {
        return Err(Reported);
    };
    let name = name.clone();
    let hint = if paths {
        format!("write `paths {name} {{ roadmap alternatives 4 }}`")
    } else {
        format!(
            "write for example `moves {name} for 2 s {{ heading from -60 deg to 60 deg by 15 deg; stop }}`"
        )
    };
    let what = if paths { "paths" } else { "moves" };
    let said = format!("the scenario declares no {what} for `{name}`");
    let about = if paths { About::Other } else { About::Moves };
    context.report(error!(E0606, at, "{said}"; hint: "{hint}").about(about))
}

/// One ranking of those under every value of a parameter: each option stands under all values, one after the other.
pub(crate) fn joined(all: Vec<Query>) -> Option<Query> {
    let models = all.len();
    let mut queries = all.into_iter();
    let mut first = queries.next()?;
    let lists: Vec<Vec<RankOption>> = std::iter::once(&first)
        .chain(queries.as_slice())
        .filter_map(|query| {
            let Ask::Rank { options, .. } = &query.ask else { return None };
            let own = |mut option: RankOption| {
                option.settings = [query.settings.as_slice(), &option.settings].concat();
                option
            };
            Some(options.iter().cloned().map(own).collect())
        })
        .collect();
    let count = lists.iter().map(Vec::len).min().unwrap_or(0);
    let each = (0..count).flat_map(|at| lists.iter().map(move |list| list[at].clone()));
    let joined: Vec<RankOption> = each.collect();
    if let Some(every) = &first.every {
        first.settings.retain(|(name, _)| *name != every.name);
    }
    if let Ask::Rank { options, models: known, .. } = &mut first.ask {
        (*options, *known) = (joined, models);
    }
    Some(first)
}
