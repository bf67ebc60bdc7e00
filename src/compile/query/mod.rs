//! The whole of a call: worlds and questions.

pub(crate) mod aims;
pub(crate) mod arguments;
pub(crate) mod bindings;
pub(crate) mod bounds;
pub(crate) mod checks;
pub(crate) mod clauses;
pub(crate) mod compiler;
pub(crate) mod curves;
pub(crate) mod every;
pub(crate) mod families;
pub(crate) mod findings;
pub(crate) mod measures;
pub mod methods;
pub(crate) mod rankings;
pub(crate) mod settings;
pub(crate) mod starts;
pub(crate) mod sweeps;
pub(crate) mod titles;
pub(crate) mod watched;

use crate::base::decimal::Decimal;
use crate::compile::context::{
    Context, Locals, Lowered, Reported, notes::Notes, number::Number, roster::Starts, symbols::ScopeId,
    wording::Texts,
};
use crate::compile::lower::{call, name, traffic};
use crate::compile::people::kinds;
use crate::compile::query::aims::Others;
use crate::compile::query::families::Allowance;
use crate::compile::study::{Ask, Query, Said, Study, World};
use crate::compile::written;
use crate::stats::spec::Make;
use crate::syntax::ast::{self, Expr, PropertyFile, PropertyItem, QueryKind};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::{Source, Span};
pub use compiler::Input;
use compiler::{Compiler, Key, Site};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The result of compilation.
#[derive(Debug)]
pub struct Examined {
    /// All that is asked, if nothing is wrong.
    pub study: Option<Study>,
    /// The errors and warnings.
    pub found: Vec<Diagnostic>,
    /// The starts of agents in the worlds that are certainly used.
    pub starts: Vec<Starts>,
    /// The meanings of names in the world of the call, where the files say that they are noted.
    pub notes: Notes,
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
            for time in alike.iter().flat_map(|at| &compiler.sites[*at].context.time.between) {
                if !known.contains(time) {
                    known.push(*time);
                    more = true;
                }
            }
        }
        if !more {
            let starts = starts::starts(&compiler);
            // The worlds of queries know of names that the world of the call has not looked at.
            let noted = compiler.sites.iter_mut().rev().filter_map(|site| site.context.notes.take());
            let notes = noted.flatten().collect();
            let (study, found) = compiler.conclude();
            return Examined { study, found, starts, notes };
        }
    }
}

impl<'a> Compiler<'a> {
    fn run(&mut self) {
        // Sweep points are computed in the plain world, which also checks what no query uses.
        let plain = self.site(BTreeMap::new());
        let mut points = sweeps::points(self, plain);
        let swept: Vec<&str> =
            self.input.settings.iter().filter(|s| !s.values.is_single()).map(|s| s.name.as_str()).collect();
        if self.input.settings.is_empty() || self.sites[plain].context.sink.failed() {
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
            let _ = bindings::check_ranges(self, base, set.collect());
            if number == 0 {
                self.base = base;
            }
            for (number, file) in self.input.properties.iter().enumerate() {
                self.file(file, number + 1, base, point, &swept);
            }
        }
    }

    /// Properties are checked whether a query uses them or not.
    fn check_properties(&mut self, site: usize) {
        let context = &mut self.sites[site].context;
        for (number, file) in self.input.properties.iter().enumerate() {
            for item in &file.items {
                match item {
                    // A name that is taken stands for something else; that is said already.
                    PropertyItem::Property { name, formula }
                        if context.names.is_doubtful(number + 1, &name.name)
                            || context.names.scopes[number + 1]
                                .get(&name.name)
                                .is_none_or(|declared| declared.span != name.span) =>
                    {
                        let _ = measures::formula_column(context, formula, number + 1);
                    }
                    PropertyItem::Property { name, formula } => {
                        let body = Expr { kind: ast::ExprKind::Name(name.name.clone()), span: formula.span };
                        if measures::formula_column(context, &body, number + 1).is_err() {
                            // What is wrong with it was said: what it is a part of says no more.
                            context.names.broken.insert((number + 1, name.name.clone()));
                        }
                    }
                    PropertyItem::Const { value, .. } => {
                        let lowered = name::timeless(context, value, &Locals::of(number + 1));
                        let _ = context.unchanging(lowered, value);
                    }
                    PropertyItem::Let(decl) => {
                        context.temporal = true;
                        call::look_into(context, decl, &Locals::of(number + 1));
                        context.temporal = false;
                    }
                    PropertyItem::For(_) | PropertyItem::Family { .. } | PropertyItem::Query(_) => {}
                }
            }
        }
        // What was observed for checking only is not observed in trials.
        context.observed.tree = crate::logic::Tree::default();
        context.observed.atoms.clear();
        context.observed.atoms_before = 0;
        context.observed.texts = Texts::default();
        context.observed.signals.clear();
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
                    self.sites[base].context.note(error);
                }
                family = methods::confidence(&mut self.sites[base].context, confidence, &locals).ok();
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
                    self.sites[base].context.note(warning);
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

    fn query(
        &mut self,
        query: &'a ast::Query,
        scope: ScopeId,
        base: usize,
        point: &BTreeMap<String, Number>,
        settings: &[(String, String)],
        family: Option<f64>,
    ) -> Lowered<()> {
        match every::worlds(self, query, scope, base, point) {
            Ok(worlds) => {
                for (world, _) in &worlds {
                    starts::note_asked(self, query, *world);
                }
                every::ask(self, query, scope, worlds, settings, family)
            }
            Err(Reported) => {
                // The world of the call stands in, so that this hides nothing else that is surely wrong.
                let said =
                    |site: &Site<'_>| (site.context.sink.diagnostics.len(), site.context.names.failures());
                let before: Vec<_> = self.sites.iter().map(said).collect();
                let asked_before = self.queries.len();
                let asked = self.ask(query, scope, (base, Vec::new()), settings, (family, 1));
                // Sides of a comparison are set up from it; another query that asks for them sets up its own.
                let mut sides = self.sites.split_off(before.len());
                self.known.values_mut().for_each(|alike| alike.retain(|at| *at < before.len()));
                self.queries.truncate(asked_before);
                for (site, (said, failures)) in self.sites.iter_mut().zip(before) {
                    site.context.keep_sure(said);
                    site.context.names.forget_but_circles(&failures);
                }
                for side in &mut sides {
                    side.context.keep_sure(0);
                    for sure in side.context.sink.diagnostics.drain(..) {
                        self.sites[base].context.note(sure);
                    }
                }
                asked.and(Err(Reported))
            }
        }
    }

    /// A query in a world, with what it sets itself.
    pub(crate) fn ask(
        &mut self,
        query: &'a ast::Query,
        scope: ScopeId,
        (site, own): (usize, Vec<(String, String)>),
        settings: &[(String, String)],
        (family, claims): (Option<f64>, usize),
    ) -> Lowered<()> {
        let clauses = &query.clauses;
        aims::one_width(&mut self.sites[site].context, query)?;
        let text = self.sites[site].context.text(query.span);
        // What a query sets itself takes the place of what a sweep sets.
        let swept = settings.iter().filter(|(name, _)| !query.sets(name));
        let settings: Vec<_> = swept.cloned().chain(own.iter().cloned()).collect();
        let (measure, claim, (ask, unbounded, site)) = match &query.kind {
            QueryKind::Estimate(measures) => {
                return self.ask_estimates(query, measures, scope, (site, &settings), family);
            }
            QueryKind::Check { measure, relation, threshold } => {
                let share = (family, claims);
                let asked = checks::check(self, site, measure, *relation, threshold, clauses, share, scope);
                let (ask, unbounded) = asked?;
                (measure, Some((*relation, threshold)), (ask, unbounded, site))
            }
            QueryKind::Compare { measure, first, second } => {
                let sides = [first.as_slice(), second];
                (measure, None, checks::compare(self, site, measure, sides, clauses, family, scope)?)
            }
            QueryKind::Curve { measure, name, values } => {
                let (ask, unbounded) =
                    curves::curve(self, site, (measure, name, values), clauses, family, scope)?;
                (measure, None, (ask, unbounded, site))
            }
            QueryKind::Rank { of, measure, subject } => {
                let others = Others::Subject(subject);
                (measure, None, rankings::rank(self, site, of, (measure, others), clauses, family, scope)?)
            }
            QueryKind::Pareto { of, measures } => {
                let Some((measure, others)) = measures.split_first() else { return Err(Reported) };
                let others = Others::Aims(others);
                (measure, None, rankings::rank(self, site, of, (measure, others), clauses, family, scope)?)
            }
        };
        let said = titles::said(&self.sites[site].context, measure, claim);
        let name = property_name(measure);
        self.keep_query(query.span, (text, said), settings, name, ask, unbounded, site);
        Ok(())
    }

    /// The measures of an estimate, each a query of its own.
    fn ask_estimates(
        &mut self,
        query: &'a ast::Query,
        measures: &'a [ast::Measure],
        scope: ScopeId,
        (site, settings): (usize, &[(String, String)]),
        family: Option<f64>,
    ) -> Lowered<()> {
        let (clauses, locals) = (&query.clauses, Locals::of(scope));
        let text = self.sites[site].context.text(query.span);
        let allowance = Allowance { family, claims: families::claims(measures, clauses) };
        let mut failed = false;
        for measure in measures {
            // What is wrong with the procedure is said beside what is wrong with the measure.
            let (measured, sketch) = self.measured(site, measure, scope);
            let context = &mut self.sites[site].context;
            let estimator = methods::estimator(context, clauses, sketch, allowance, &locals);
            let (Ok((measured, unbounded)), Ok(estimator)) = (measured, estimator) else {
                failed = true;
                continue;
            };
            let mut level = None;
            if matches!(estimator.spec.make, Make::Splitting { .. }) {
                // How far a path has come is the robustness of its formula.
                let Ok(found) = measures::level(context, measure, scope) else {
                    failed = true;
                    continue;
                };
                level = Some(self.column(site, found));
            }
            let context = &self.sites[site].context;
            let single = match &measure.kind {
                _ if measures.len() == 1 => text.clone(),
                ast::MeasureKind::Quantile(level) => {
                    format!("estimate Q({}, {})", context.text(level.span), context.text(measure.body.span))
                }
                ast::MeasureKind::Tail(_) => {
                    format!("estimate {}", titles::said(context, measure, None).measure)
                }
                _ => format!("estimate {}", context.text(measure.span)),
            };
            let ask = Ask::Estimate { measure: measured, estimator, level };
            let said = titles::said(context, measure, None);
            self.keep_query(
                query.span,
                (single, said),
                settings.to_vec(),
                property_name(measure),
                ask,
                unbounded,
                site,
            );
        }
        if failed { Err(Reported) } else { Ok(()) }
    }

    fn keep_query(
        &mut self,
        span: Span,
        (text, said): (String, Said),
        settings: Vec<(String, String)>,
        name: Option<String>,
        ask: Ask,
        unbounded: bool,
        site: usize,
    ) {
        let context = &self.sites[site].context;
        let horizon = unbounded.then(|| context.time.whole());
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
            every: None,
            horizon,
            given: None,
        });
    }

    fn conclude(self) -> (Option<Study>, Vec<Diagnostic>) {
        let mut diagnostics = findings::findings(&self);
        // No query is dropped without a diagnostic; the parser reported the parts that it skipped.
        let is_torn = self.input.scenario.fails || self.input.properties.iter().any(|file| file.fails);
        if let Some(query) = self.refused.first().filter(|_| !is_torn)
            && !diagnostics.iter().any(|d| d.severity == Severity::Error)
        {
            let text = "internal error: this query was rejected without a diagnostic";
            diagnostics.push(error!(E0305, *query, "{text}"));
        }
        // What was cut short is refused by the parser; what was left out without an error, by whoever reads this.
        let is_lost =
            |one: &Context<'_>| (one.given_up || !one.roster.undeclared.is_empty()) && !one.sink.failed();
        let is_cut = self.sites.iter().any(|site| is_lost(&site.context));
        if is_cut || diagnostics.iter().any(|d| d.severity == Severity::Error) {
            return (None, diagnostics);
        }
        let named = |at: usize| {
            let names: Vec<&str> = self.sites[at].settings.keys().map(String::as_str).collect();
            self.described(at, &self.sites[at].settings, &names)
        };
        let described: Vec<_> = (0..self.sites.len()).map(named).collect();
        let mut worlds = Vec::with_capacity(self.sites.len());
        let (mut title, mut tracks, mut people) = (String::new(), Vec::new(), BTreeSet::new());
        let sources: Arc<[Source]> = self.input.sources.into();
        for (site, settings) in self.sites.into_iter().zip(described) {
            let Some(scenario) = site.scenario else { return (None, diagnostics) };
            title.clone_from(&scenario.title);
            let mut context = site.context;
            tracks = std::mem::take(&mut context.tracks.velocities);
            people.append(&mut context.roster.presets);
            let written = written::written(&context, self.input.scenario);
            let kinds = kinds::bodies(&mut context);
            worlds.push(World {
                settings,
                scenario: traffic::counting(&context, scenario),
                kinds,
                atoms: context.observed.atoms,
                written,
                texts: Texts { sources: sources.clone(), uses: context.words.uses, ..context.observed.texts },
                signals: context.observed.signals,
                tree: context.observed.tree,
                columns: site.columns,
                places: context.roster.places,
                origins: context.origins,
            });
        }
        (Some(Study { title, tracks, people, worlds, base: self.base, queries: self.queries }), diagnostics)
    }
}

/// The name of the property that is asked about, if it is one name.
fn property_name(measure: &ast::Measure) -> Option<String> {
    match &measure.body.kind {
        ast::ExprKind::Name(name) => Some(name.clone()),
        _ => None,
    }
}
