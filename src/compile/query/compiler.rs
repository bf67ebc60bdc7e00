//! The worlds of a call, and what is observed in each.

use crate::base::decimal::Decimal;
use crate::compile::context::{
    Context, Lowered,
    number::Number,
    symbols::{Meaning, ScopeId},
};
use crate::compile::files::Files;
use crate::compile::query::{
    measures::{self, Observed, Sketch},
    settings::{self, Setting},
};
use crate::compile::study::{Column, Measure, Query, Target};
use crate::compile::world;
use crate::model::Scenario;
use crate::syntax::ast::{self, PropertyFile, ScenarioFile};
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

/// A world under construction.
pub(crate) struct Site<'a> {
    pub(crate) settings: BTreeMap<String, Number>,
    pub(crate) context: Context<'a>,
    pub(crate) scenario: Option<Arc<Scenario>>,
    pub(crate) columns: Vec<Column>,
}

/// Names and bits of the values of parameters.
pub(crate) type Key = Vec<(String, u64)>;

pub(crate) struct Compiler<'a> {
    pub(crate) input: &'a Input<'a>,
    pub(crate) sites: Vec<Site<'a>>,
    /// Sites by the names and bits of their settings; numbers of the same bits may differ in what is exact.
    pub(crate) known: BTreeMap<Key, Vec<usize>>,
    pub(crate) queries: Vec<Query>,
    pub(crate) next_index: usize,
    /// Queries that ask about one world, and that world.
    pub(crate) asked: Vec<(Span, usize)>,
    /// Queries that came to nothing.
    pub(crate) refused: Vec<Span>,
    /// Claims that share the error of a family.
    pub(crate) members: usize,
    /// The world of the values of `--set`, of a sweep the first.
    pub(crate) base: usize,
    /// The worlds of all points of the call.
    pub(crate) bases: BTreeSet<usize>,
    /// Times that ticks of continuous time must measure, world by world.
    pub(crate) measured: BTreeMap<Key, Vec<Decimal>>,
}

impl Compiler<'_> {
    /// Values of the swept parameters in words.
    pub(crate) fn described(
        &self,
        site: usize,
        point: &BTreeMap<String, Number>,
        names: &[&str],
    ) -> Vec<(String, String)> {
        let context = &self.sites[site].context;
        names
            .iter()
            .filter_map(|name| {
                let number = point.get(*name)?;
                let shown = match context.names.scopes[0].get(name).map(|e| e.meaning.clone()) {
                    Some(Meaning::Param(param)) => settings::shown(context, param, *number),
                    _ => number.value.to_string(),
                };
                Some(((*name).to_owned(), shown))
            })
            .collect()
    }

    /// The world of a combination of parameter values.
    pub(crate) fn site(&mut self, settings: BTreeMap<String, Number>) -> usize {
        // Both zeros are one.
        let key: Key =
            settings.iter().map(|(name, number)| (name.clone(), (number.value + 0.0).to_bits())).collect();
        let measured = self.measured.get(&key).map_or(&[][..], Vec::as_slice);
        let alike = self.known.entry(key).or_default();
        if let Some(at) = alike.iter().find(|at| self.sites[**at].settings == settings) {
            return *at;
        }
        alike.push(self.sites.len());
        let (context, scenario) = world::elaborate(
            self.input.sources,
            self.input.scenario,
            self.input.properties,
            self.input.files,
            settings.clone(),
            measured,
        );
        let scenario = scenario.map(Arc::new);
        self.sites.push(Site { settings, context, scenario, columns: Vec::new() });
        self.sites.len() - 1
    }

    /// A measure lowered in a world, and whether it ranges up to the horizon; and what is known of it in any case.
    pub(crate) fn measured(
        &mut self,
        site: usize,
        measure: &ast::Measure,
        scope: ScopeId,
    ) -> (Lowered<(Measure, bool)>, Sketch) {
        let (observed, sketch) = measures::measure(&mut self.sites[site].context, measure, scope);
        let measured = observed.map(|Observed { column, kind, unbounded }| {
            let column = self.column(site, column);
            (Measure { target: Target { world: site, column }, kind }, unbounded)
        });
        (measured, sketch)
    }

    /// The number of a column, shared with an equal one.
    pub(crate) fn column(&mut self, site: usize, column: Column) -> usize {
        let columns = &mut self.sites[site].columns;
        columns.iter().position(|c| c.root == column.root).unwrap_or_else(|| {
            columns.push(column);
            columns.len() - 1
        })
    }
}
