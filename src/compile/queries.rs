//! The whole of a call: worlds and questions.

use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::families::{self, Allowance};
use super::files::Files;
use super::measures::{Observed, Sketch};
use super::number::Number;
use super::settings::Setting;
use super::starts::Starts;
use super::study::{Ask, Column, Measure, Query, Said, Study, Target, Texts, World};
use super::symbols::ScopeId;
use crate::base::decimal::Decimal;
use crate::model::Scenario;
use crate::stats::spec::Make;
use crate::syntax::ast::{self, Expr, PropertyFile, PropertyItem, QueryKind, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::{Source, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The input of compilation.
pub struct Input<'a> {
    /// All sources, for the texts of queries.
    pub sources: &'a [Source],
    /// The scenario.
    pub scenario: &'a ScenarioFile,
    /// Property files.
    pub properties: &'a [PropertyFile],
    /// Contents of the files that the scenario names.
    pub files: &'a Files,
    /// Values of parameters.
    pub settings: &'a [Setting],
}

/// The result of compilation.
#[derive(Debug)]
pub struct Examined {
    /// All that is asked, if nothing is wrong.
    pub study: Option<Study>,
    /// The errors and warnings.
    pub found: Vec<Diagnostic>,
    /// The starts of agents in the worlds that are certainly used.
    pub starts: Vec<Starts>,
}

/// A world under construction.
pub(super) struct Site<'a> {
    pub(super) settings: BTreeMap<String, Number>,
    pub(super) elaborator: Elaborator<'a>,
    pub(super) scenario: Option<Arc<Scenario>>,
    pub(super) columns: Vec<Column>,
}

/// Names and bits of the values of parameters.
type Key = Vec<(String, u64)>;

pub(super) struct Compiler<'a> {
    pub(super) input: &'a Input<'a>,
    pub(super) sites: Vec<Site<'a>>,
    /// Sites by the names and bits of their settings; numbers of the same bits may differ in what is exact.
    known: BTreeMap<Key, Vec<usize>>,
    pub(super) queries: Vec<Query>,
    next_index: usize,
    /// Queries that ask about one world, and that world.
    pub(super) asked: Vec<(Span, usize)>,
    /// Queries that came to nothing.
    refused: Vec<Span>,
    /// Claims that share the error of a family.
    members: usize,
    /// The world of the values of `--set`, of a sweep the first.
    base: usize,
    /// The worlds of all points of the call.
    pub(super) bases: BTreeSet<usize>,
    /// Times that ticks of continuous time must measure, world by world.
    measured: BTreeMap<Key, Vec<Decimal>>,
}

/// Compiles a scenario and property files. All errors are returned at once; a study only where there is none, and where
/// the parser cut nothing short.
pub fn compile(input: &Input<'_>) -> (Option<Study>, Vec<Diagnostic>) {
    let examined = examine(input);
    (examined.study, examined.found)
}

/// Compiles, and tells who starts where even if there is an error.
pub fn examine(input: &Input<'_>) -> Examined {
    let mut measured: BTreeMap<Key, Vec<Decimal>> = BTreeMap::new();
    loop {
        let mut compiler = Compiler {
            input,
            sites: Vec::new(),
            known: BTreeMap::new(),
            queries: Vec::new(),
            next_index: 0,
            asked: Vec::new(),
            refused: Vec::new(),
            members: 0,
            base: 0,
            bases: BTreeSet::new(),
            measured: measured.clone(),
        };
        compiler.run();
        // Bounds in continuous time that fall between the ticks of a world: once more, with finer ticks in that world.
        let mut more = false;
        for (key, alike) in &compiler.known {
            let known = measured.entry(key.clone()).or_default();
            for time in alike.iter().flat_map(|at| &compiler.sites[*at].elaborator.between) {
                if !known.contains(time) {
                    known.push(*time);
                    more = true;
                }
            }
        }
        if !more {
            let starts = compiler.starts();
            let (study, found) = compiler.finish();
            return Examined { study, found, starts };
        }
    }
}

impl<'a> Compiler<'a> {
    fn run(&mut self) {
        // Sweep points are computed in the plain world, which also checks what no query uses.
        let plain = self.site(BTreeMap::new());
        let mut points = self.points(plain);
        let swept: Vec<&str> =
            self.input.settings.iter().filter(|s| !s.values.is_single()).map(|s| s.name.as_str()).collect();
        if self.input.settings.is_empty() || self.sites[plain].elaborator.failed() {
            points.truncate(1);
        } else {
            // Only the combinations that were asked for are run.
            self.sites[plain].columns.clear();
        }
        self.check_properties(plain);
        self.members = families::members(self.input.properties, points.len());
        for (number, point) in points.iter().enumerate() {
            self.next_index = 0;
            let base = self.site(point.clone());
            self.bases.insert(base);
            let set = self.input.settings.iter().map(|setting| (setting.name.clone(), setting.values.ends()));
            // What is wrong is noted in that world.
            let _ = self.check_ranges(base, set.collect());
            if number == 0 {
                self.base = base;
            }
            for (number, file) in self.input.properties.iter().enumerate() {
                self.file(file, number + 1, base, point, &swept);
            }
        }
    }

    /// The world of a combination of parameter values.
    pub(super) fn site(&mut self, settings: BTreeMap<String, Number>) -> usize {
        // Both zeros are one.
        let key: Key =
            settings.iter().map(|(name, number)| (name.clone(), (number.value + 0.0).to_bits())).collect();
        let measured = self.measured.get(&key).map_or(&[][..], Vec::as_slice);
        let alike = self.known.entry(key).or_default();
        if let Some(at) = alike.iter().find(|at| self.sites[**at].settings == settings) {
            return *at;
        }
        alike.push(self.sites.len());
        let (elaborator, scenario) = Elaborator::elaborate(
            self.input.sources,
            self.input.scenario,
            self.input.properties,
            self.input.files,
            settings.clone(),
            measured,
        );
        let scenario = scenario.map(Arc::new);
        self.sites.push(Site { settings, elaborator, scenario, columns: Vec::new() });
        self.sites.len() - 1
    }

    /// Properties are checked whether a query uses them or not.
    fn check_properties(&mut self, site: usize) {
        let elaborator = &mut self.sites[site].elaborator;
        for (number, file) in self.input.properties.iter().enumerate() {
            for item in &file.items {
                match item {
                    // A name that is taken stands for something else; that is said already.
                    PropertyItem::Property { name, formula }
                        if elaborator.is_doubtful(number + 1, &name.name)
                            || elaborator.scopes[number + 1]
                                .get(&name.name)
                                .is_none_or(|declared| declared.span != name.span) =>
                    {
                        let _ = elaborator.formula_column(formula, number + 1);
                    }
                    PropertyItem::Property { name, formula } => {
                        let body = Expr { kind: ast::ExprKind::Name(name.name.clone()), span: formula.span };
                        if elaborator.formula_column(&body, number + 1).is_err() {
                            // What is wrong with it was said: what it is a part of says no more.
                            elaborator.broken.insert((number + 1, name.name.clone()));
                        }
                    }
                    PropertyItem::Const { value, .. } => {
                        let lowered = elaborator.timeless(value, &Locals::of(number + 1));
                        let _ = elaborator.unchanging(lowered, value);
                    }
                    PropertyItem::Let(decl) => {
                        elaborator.temporal = true;
                        elaborator.look_into(decl, &Locals::of(number + 1));
                        elaborator.temporal = false;
                    }
                    PropertyItem::Family { .. } | PropertyItem::Query(_) => {}
                }
            }
        }
        // What was observed for checking only is not observed in trials.
        elaborator.tree = crate::logic::Tree::default();
        elaborator.atoms.clear();
        elaborator.atoms_before = 0;
        elaborator.texts = Texts::default();
        elaborator.signals.clear();
    }

    fn file(
        &mut self,
        file: &'a PropertyFile,
        scope: ScopeId,
        base: usize,
        point: &BTreeMap<String, Number>,
        swept: &[&str],
    ) {
        let locals = Locals::of(scope);
        let mut family: Option<f64> = None;
        let mut stated: Option<Span> = None;
        for item in &file.items {
            if let PropertyItem::Family { confidence, .. } = item {
                if let Some(first) = stated.replace(confidence.span) {
                    let error = error!(E0202, confidence.span, "a file can have only one family")
                        .related(first, "first stated here");
                    self.sites[base].elaborator.note(error);
                }
                family = self.sites[base].elaborator.confidence(confidence, &locals).ok();
            }
        }
        // The claims of a family share its error.
        let family = family.map(|delta| delta / self.members.max(1) as f64);
        for item in &file.items {
            if let PropertyItem::Query(query) = item {
                let settings = self.described(base, point, swept);
                if let (Some(_), Some(span)) = (family, families::own_errors(&query.clauses)) {
                    let warning = Diagnostic::warning(Code::W0601, span, "the query leaves its family")
                        .hint("it states its own error; remove that to hold jointly with the other queries");
                    self.sites[base].elaborator.note(warning);
                }
                let before = self.queries.len();
                if self.query(query, scope, base, point, &settings, family).is_err() {
                    self.refused.push(query.span);
                }
                for query in &mut self.queries[before..] {
                    query.point = if family.is_none() { settings.clone() } else { Vec::new() };
                }
            }
        }
    }

    /// A measure lowered in a world, and whether it ranges up to the horizon; and what is known of it in any case.
    pub(super) fn measured(
        &mut self,
        site: usize,
        measure: &ast::Measure,
        scope: ScopeId,
    ) -> (Lowered<(Measure, bool)>, Sketch) {
        let (observed, sketch) = self.sites[site].elaborator.measure(measure, scope);
        let measured = observed.map(|Observed { column, kind, unbounded }| {
            let column = self.column(site, column);
            (Measure { target: Target { world: site, column }, kind }, unbounded)
        });
        (measured, sketch)
    }

    /// The number of a column, shared with an equal one.
    pub(super) fn column(&mut self, site: usize, column: Column) -> usize {
        let columns = &mut self.sites[site].columns;
        columns.iter().position(|c| c.root == column.root).unwrap_or_else(|| {
            columns.push(column);
            columns.len() - 1
        })
    }

    fn query(
        &mut self,
        query: &'a ast::Query,
        scope: ScopeId,
        base: usize,
        point: &BTreeMap<String, Number>,
        settings: &[(String, String)],
        family: Option<f64>,
    ) -> Lowered<()> {
        match self.under(&query.clauses.under, scope, base, point) {
            Ok(world) => {
                self.note_asked(query, world.0);
                self.ask(query, scope, world, settings, family)
            }
            Err(Reported) => {
                // The world of the call stands in, so that this hides nothing else that is surely wrong.
                let said = |site: &Site<'_>| (site.elaborator.diagnostics.len(), site.elaborator.failures());
                let before: Vec<_> = self.sites.iter().map(said).collect();
                let asked_before = self.queries.len();
                let asked = self.ask(query, scope, (base, Vec::new()), settings, family);
                // Sides of a comparison are set up from it; another query that asks for them sets up its own.
                let mut sides = self.sites.split_off(before.len());
                self.known.values_mut().for_each(|alike| alike.retain(|at| *at < before.len()));
                self.queries.truncate(asked_before);
                for (site, (said, failures)) in self.sites.iter_mut().zip(before) {
                    site.elaborator.keep_sure(said);
                    site.elaborator.forget_but_circles(&failures);
                }
                for side in &mut sides {
                    side.elaborator.keep_sure(0);
                    for sure in side.elaborator.diagnostics.drain(..) {
                        self.sites[base].elaborator.note(sure);
                    }
                }
                asked.and(Err(Reported))
            }
        }
    }

    /// A query in a world, with what it sets itself.
    fn ask(
        &mut self,
        query: &'a ast::Query,
        scope: ScopeId,
        (site, own): (usize, Vec<(String, String)>),
        settings: &[(String, String)],
        family: Option<f64>,
    ) -> Lowered<()> {
        let clauses = &query.clauses;
        let locals = Locals::of(scope);
        let text = self.sites[site].elaborator.text(query.span);
        // What a query sets itself takes the place of what a sweep sets.
        let swept = settings.iter().filter(|(name, _)| !query.sets(name));
        let settings: Vec<_> = swept.cloned().chain(own.iter().cloned()).collect();
        match &query.kind {
            QueryKind::Check { measure, relation, threshold } => {
                let ask = self.check(site, measure, *relation, threshold, clauses, family, scope);
                let (ask, unbounded) = ask?;
                let said = self.sites[site].elaborator.said(measure, Some((*relation, threshold)));
                self.push(query.span, (text, said), settings, property_name(measure), ask, unbounded, site);
            }
            QueryKind::Estimate(measures) => {
                let allowance = Allowance { family, claims: families::claims(measures, clauses) };
                let mut failed = false;
                for measure in measures {
                    // What is wrong with the procedure is said beside what is wrong with the measure.
                    let (measured, sketch) = self.measured(site, measure, scope);
                    let elaborator = &mut self.sites[site].elaborator;
                    let estimator = elaborator.estimator(clauses, sketch, allowance, &locals);
                    let (Ok((measured, unbounded)), Ok(estimator)) = (measured, estimator) else {
                        failed = true;
                        continue;
                    };
                    let mut level = None;
                    if matches!(estimator.spec.make, Make::Splitting { .. }) {
                        // How far a path has come is the robustness of its formula.
                        let Ok(found) = elaborator.level(measure, scope) else {
                            failed = true;
                            continue;
                        };
                        level = Some(self.column(site, found));
                    }
                    let elaborator = &self.sites[site].elaborator;
                    let single = match &measure.kind {
                        _ if measures.len() == 1 => text.clone(),
                        ast::MeasureKind::Quantile(level) => format!(
                            "estimate Q({}, {})",
                            elaborator.text(level.span),
                            elaborator.text(measure.body.span)
                        ),
                        _ => format!("estimate {}", elaborator.text(measure.span)),
                    };
                    let ask = Ask::Estimate { measure: measured, estimator, level };
                    let said = elaborator.said(measure, None);
                    self.push(
                        query.span,
                        (single, said),
                        settings.clone(),
                        property_name(measure),
                        ask,
                        unbounded,
                        site,
                    );
                }
                if failed {
                    return Err(Reported);
                }
            }
            QueryKind::Compare { measure, first, second } => {
                let sides = [first.as_slice(), second];
                let (ask, unbounded, one) = self.compare(site, measure, sides, clauses, family, scope)?;
                let said = self.sites[one].elaborator.said(measure, None);
                self.push(query.span, (text, said), settings, property_name(measure), ask, unbounded, one);
            }
            QueryKind::Rank { of, measure } => {
                let (ask, unbounded, one) = self.rank(site, of, measure, clauses, family, scope)?;
                let said = self.sites[one].elaborator.said(measure, None);
                self.push(query.span, (text, said), settings, property_name(measure), ask, unbounded, one);
            }
        }
        Ok(())
    }

    fn push(
        &mut self,
        span: Span,
        (text, said): (String, Said),
        settings: Vec<(String, String)>,
        name: Option<String>,
        ask: Ask,
        unbounded: bool,
        site: usize,
    ) {
        let elaborator = &self.sites[site].elaborator;
        let horizon = unbounded.then(|| elaborator.duration(elaborator.horizon.0));
        let index = self.next_index;
        self.next_index += 1;
        // What a query sets itself may leave nothing of a sweep: then it is asked once.
        if self.queries.iter().any(|known| known.index == index && known.ask == ask) {
            return;
        }
        self.queries.push(Query {
            index,
            name,
            text,
            said,
            span,
            settings,
            point: Vec::new(),
            ask,
            horizon,
            given: None,
        });
    }

    fn finish(self) -> (Option<Study>, Vec<Diagnostic>) {
        let mut diagnostics = self.findings();
        // No query is dropped without a diagnostic; the parser reported the parts that it skipped.
        let is_torn = self.input.scenario.fails || self.input.properties.iter().any(|file| file.fails);
        if let Some(query) = self.refused.first().filter(|_| !is_torn)
            && !diagnostics.iter().any(|d| d.severity == Severity::Error)
        {
            let text = "internal error: this query was rejected without a diagnostic";
            diagnostics.push(error!(E0305, *query, "{text}"));
        }
        // What was cut short is refused by the parser; what was left out without an error, by whoever reads this.
        let fails = |all: &[Diagnostic]| all.iter().any(|one| one.severity == Severity::Error);
        let is_lost =
            |one: &Elaborator<'_>| (one.given_up || !one.undeclared.is_empty()) && !fails(&one.diagnostics);
        let is_cut = self.sites.iter().any(|site| is_lost(&site.elaborator));
        if is_cut || diagnostics.iter().any(|d| d.severity == Severity::Error) {
            return (None, diagnostics);
        }
        let named = |at: usize| {
            let names: Vec<&str> = self.sites[at].settings.keys().map(String::as_str).collect();
            self.described(at, &self.sites[at].settings, &names)
        };
        let described: Vec<_> = (0..self.sites.len()).map(named).collect();
        let mut worlds = Vec::with_capacity(self.sites.len());
        let (mut title, mut tracks) = (String::new(), Vec::new());
        let sources: Arc<[Source]> = self.input.sources.into();
        for (site, settings) in self.sites.into_iter().zip(described) {
            let Some(scenario) = site.scenario else { return (None, diagnostics) };
            title.clone_from(&scenario.title);
            let mut elaborator = site.elaborator;
            tracks = std::mem::take(&mut elaborator.velocities);
            let written = elaborator.written(self.input.scenario);
            let kinds = elaborator.bodies();
            worlds.push(World {
                settings,
                scenario: elaborator.counting(scenario),
                kinds,
                atoms: elaborator.atoms,
                written,
                texts: Texts { sources: sources.clone(), uses: elaborator.uses, ..elaborator.texts },
                signals: elaborator.signals,
                tree: elaborator.tree,
                columns: site.columns,
                places: elaborator.places,
                origins: elaborator.origins,
            });
        }
        (Some(Study { title, tracks, worlds, base: self.base, queries: self.queries }), diagnostics)
    }
}

/// The name of the property that is asked about, if it is one name.
fn property_name(measure: &ast::Measure) -> Option<String> {
    match &measure.body.kind {
        ast::ExprKind::Name(name) => Some(name.clone()),
        _ => None,
    }
}
