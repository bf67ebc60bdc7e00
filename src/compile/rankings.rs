//! Rankings: their options, each of which is a world and perhaps a move in it, their score and their procedure.

use super::asks::unlike;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::families::Allowance;
use super::measures::{Observed, Sketch, What};
use super::number::Number;
use super::queries::Compiler;
use super::settings::Setting;
use super::study::{Ask, MeasureKind, RankOption};
use super::symbols::ScopeId;
use crate::logic::Root;
use crate::logic::Tree;
use crate::model::{AgentId, Bool, Move, Num, Who};
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

impl<'a> Compiler<'a> {
    /// A ranking: its options, by which score; and the world of the first of them.
    pub(super) fn rank(
        &mut self,
        site: usize,
        of: &'a Ranked,
        measure: &ast::Measure,
        clauses: &'a Clauses,
        family: Option<f64>,
        scope: ScopeId,
    ) -> Lowered<(Ask, bool, usize)> {
        let locals = Locals::of(scope);
        let (candidates, measured, sketch) = match of {
            Ranked::Moves { what, agent } => {
                let (measured, sketch) = self.measured(site, measure, scope);
                (self.moves(site, what, agent, &locals), vec![measured], sketch)
            }
            Ranked::Values(list) => {
                let candidates = self.combinations(site, list, clauses, scope);
                let elaborator = &self.sites[site].elaborator;
                let (before, failures) = (elaborator.diagnostics.len(), elaborator.failures());
                let worlds =
                    candidates.as_ref().map_or(vec![site], |all| all.iter().map(|c| c.world).collect());
                let (measured, sketches): (Vec<_>, Vec<_>) =
                    worlds.into_iter().map(|world| self.measured(world, measure, scope)).unzip();
                if candidates.is_err() {
                    // The world of the query stands in for those that could not be set up.
                    let elaborator = &mut self.sites[site].elaborator;
                    elaborator.keep_sure(before);
                    elaborator.forget_but_circles(&failures);
                }
                (candidates, measured, sketches.first().copied().unwrap_or(Sketch::PROBABILITY))
            }
        };
        let elaborator = &mut self.sites[site].elaborator;
        let rankable = if sketch.what == What::Quantile {
            let error = error!(E0607, measure.span, "`rank` accepts only `P(…)` and `E(…)`");
            elaborator.report(error)
        } else {
            Ok(())
        };
        // In which unit a loss would be is not known then.
        let known = if rankable.is_ok() { sketch } else { Sketch { dimension: None, ..sketch } };
        let allowance = Allowance { family, claims: 1 };
        let procedure = elaborator.ranking(clauses, (known, measure.span), allowance, &locals);
        if let (Ok(Make::Ranking(Ranking::Okamoto)), What::Expectation, Some(method)) =
            (procedure.as_ref().map(|chosen| chosen.spec.make), sketch.what, &clauses.by)
        {
            let error = error!(E0607, method.span, "`okamoto` ranks only by `P(…)`";
                hint: "remove `by okamoto`: the default procedure also ranks by `E(…)`, and needs fewer trials");
            return elaborator.report(error);
        }
        rankable?;
        let measured: Vec<_> = measured.into_iter().collect::<Lowered<_>>()?;
        let (candidates, ranking) = (candidates?, procedure?);
        let (first, unbounded) = measured[0].clone();
        // Moves are options of one world.
        let each = || measured.iter().map(|(measure, _)| measure).cycle();
        for (other, candidate) in each().zip(&candidates) {
            if matches!(first.kind, MeasureKind::Expectation { .. }) && other.kind != first.kind {
                let settings = [candidates[0].settings.clone(), candidate.settings.clone()];
                let error =
                    unlike(measure, "all options of a ranking need", [&first.kind, &other.kind], &settings);
                return self.sites[site].elaborator.report(error);
            }
        }
        if let Ranked::Values(list) = of {
            self.check_used(site, list, &candidates, measure, scope)?;
        }
        let world = first.target.world;
        let options = each().zip(candidates).map(|(measure, c)| RankOption {
            label: c.label,
            settings: c.settings,
            target: measure.target,
            advice: c.advice,
            deviation: c.deviation,
        });
        let options = options.collect();
        Ok((Ask::Rank { options, measure: first, ranking }, unbounded, world))
    }

    /// The options of moves.
    fn moves(&mut self, site: usize, what: &Ident, agent: &Expr, locals: &Locals) -> Lowered<Vec<Candidate>> {
        let elaborator = &mut self.sites[site].elaborator;
        let paths = what.name == "paths";
        let wanted = if paths || what.name == "moves" {
            Ok(())
        } else {
            let error = error!(E0606, what.span, "`{}` cannot be ranked", what.name;
                    hint: "write `rank moves of …` or `rank paths of …`");
            elaborator.report(error)
        };
        let typed = elaborator.lower(agent, locals)?;
        let Who::Agent(id) = elaborator.as_agent(typed, agent.span)? else { return Err(Reported) };
        wanted?;
        let advised = &self.sites[site].elaborator.advised;
        // If some moves have errors, their agents are unknown.
        if advised.as_ref().is_some_and(|advised| !advised.contains(&(id, paths))) {
            return self.sites[site].elaborator.without_moves((id, paths), agent.span);
        }
        let Some(scenario) = &self.sites[site].scenario else { return Err(Reported) };
        let Some(number) = scenario.moves.iter().position(|m| m.key().0 == (id, paths)) else {
            return Err(Reported);
        };
        let moves = &scenario.moves[number];
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

    /// All combinations of the values of some parameters, those of the first slowest.
    fn combinations(
        &mut self,
        site: usize,
        list: &'a [(Ident, Values)],
        clauses: &'a Clauses,
        scope: ScopeId,
    ) -> Lowered<Vec<Candidate>> {
        let mut points: Vec<BTreeMap<String, Number>> = vec![self.sites[site].settings.clone()];
        let mut failed = false;
        for (k, (name, values)) in list.iter().enumerate() {
            let is_set = set_elsewhere(self.input.settings, name, &list[..k], clauses);
            let elaborator = &mut self.sites[site].elaborator;
            if let Some((said, place, label)) = is_set {
                let error = error!(E0210, name.span, "{said}");
                elaborator.note(error.related(place, label).hint("remove one of them"));
                failed = true;
                continue;
            }
            let locals = Locals::of(scope);
            let Ok(numbers) = elaborator.values((&name.name, name.span), values, MOST_OPTIONS, &locals)
            else {
                failed = true;
                continue;
            };
            let count = points.len().saturating_mul(numbers.len());
            if count > MOST_OPTIONS {
                let said = format!("a ranking has at most {MOST_OPTIONS} options (got {count})");
                return elaborator.report(error!(E0606, name.span, "{said}"));
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
            let settings = self.described(site, &point, &names);
            // What was set elsewhere, too, has to lie in a range that is set here.
            let ends = |name: &String| Some((name.clone(), own(name)?.1.ends()));
            let set: Vec<_> = point.keys().filter_map(ends).collect();
            let world = self.site(point);
            failed |= self.check_ranges(world, set).is_err();
            let texts: Vec<String> =
                settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            let label = texts.join(", ");
            candidates.push(Candidate { world, label, settings, advice: None, deviation: k as f64 });
        }
        if failed { Err(Reported) } else { Ok(candidates) }
    }

    /// Whether each ranked parameter makes a difference.
    fn check_used(
        &mut self,
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
                differs = differs || self.is_other(first, one.world, measure, scope)?;
                if differs {
                    break;
                }
            }
            if !differs {
                let said = format!("the values of `{}` make no difference", name.name);
                let error = error!(E0606, name.span, "{said}").about(About::Idle);
                return self.sites[site].elaborator.report(
                    error.hint(
                        "rank a parameter on which the scenario or the measure depends for these values",
                    ),
                );
            }
        }
        Ok(())
    }

    /// Whether a measure may have other values in another world.
    fn is_other(
        &mut self,
        one: usize,
        other: usize,
        measure: &ast::Measure,
        scope: ScopeId,
    ) -> Lowered<bool> {
        if self.sites[one].scenario != self.sites[other].scenario {
            return Ok(true);
        }
        let mut alone = |site: usize| self.sites[site].elaborator.alone(measure, scope);
        Ok(alone(one)? != alone(other)?)
    }
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

impl Elaborator<'_> {
    /// What a measure is in this world, whatever else is observed there.
    fn alone(&mut self, measure: &ast::Measure, scope: ScopeId) -> Lowered<Alone> {
        let tree = std::mem::take(&mut self.tree);
        let (atoms, signals) = (std::mem::take(&mut self.atoms), std::mem::take(&mut self.signals));
        let (texts, before) = (std::mem::take(&mut self.texts), std::mem::take(&mut self.atoms_before));
        let (observed, _) = self.measure(measure, scope);
        let tree = std::mem::replace(&mut self.tree, tree);
        let (atoms, signals) =
            (std::mem::replace(&mut self.atoms, atoms), std::mem::replace(&mut self.signals, signals));
        (self.texts, self.atoms_before) = (texts, before);
        observed.map(|Observed { column, kind, .. }| (tree, atoms, signals, column.root, kind))
    }

    /// Reports that an agent has no moves.
    fn without_moves<T>(&mut self, (id, paths): (AgentId, bool), at: Span) -> Lowered<T> {
        // One that could not be declared was reported.
        let Some(name) = self.agent_names.get(id.0 as usize).filter(|_| !self.undeclared.contains(&id))
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
        self.report(error!(E0606, at, "{said}"; hint: "{hint}").about(about))
    }
}
