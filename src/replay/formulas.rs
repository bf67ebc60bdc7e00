//! The formulas that are asked of a recording: all properties of the property files.

use crate::compile::study::{Ask, MeasureKind, Study, Target};
use crate::syntax::ast::{self, Clauses, PropertyFile, PropertyItem, Query, QueryKind};
use crate::syntax::parse::parse_properties;
use crate::syntax::source::{Source, SourceId};

/// Property files whose queries are replaced by one for each property.
#[derive(Clone, Debug, Default)]
pub struct Formulas {
    /// Names of the properties, in order of writing.
    pub names: Vec<String>,
    /// Whether some query estimates a number.
    pub(super) has_numbers: bool,
    /// The files.
    pub(super) files: Vec<PropertyFile>,
    /// The text of the new queries.
    pub(super) source: Source,
}

impl Formulas {
    /// One query for each property of some files. The text of the queries is a source of its own.
    pub(super) fn of(files: &[PropertyFile], id: SourceId) -> Self {
        let mut files = files.to_vec();
        let (mut names, mut numbers) = (Vec::new(), Vec::new());
        for file in &mut files {
            numbers.push(file.items.iter().filter_map(numbers_of).collect::<Vec<_>>());
            file.items.retain(|item| !matches!(item, PropertyItem::Query(_) | PropertyItem::Family { .. }));
            names.extend(file.items.iter().filter_map(|item| match item {
                PropertyItem::Property { name, .. } => Some(name.name.clone()),
                _ => None,
            }));
        }
        let queries: String = names.iter().map(|name| format!("estimate P({name})\n")).collect();
        let source = Source::new(id, "the properties", queries);
        let (asked, _) = parse_properties(&source);
        match files.last_mut() {
            Some(last) => last.items.extend(asked.items),
            None => files.push(asked),
        }
        let has_numbers = numbers.iter().any(|all| !all.is_empty());
        // In their own files, whose names they may use.
        for (file, all) in files.iter_mut().zip(numbers) {
            file.items.extend(all.into_iter().map(PropertyItem::Query));
        }
        Self { names, has_numbers, files, source }
    }
}

/// The numbers that a query estimates, without what it says of trials.
fn numbers_of(item: &PropertyItem) -> Option<Query> {
    let PropertyItem::Query(Query { kind: QueryKind::Estimate(measures), span, .. }) = item else {
        return None;
    };
    let is_number = |measure: &&ast::Measure| !matches!(measure.kind, ast::MeasureKind::Probability);
    let numbers: Vec<_> = measures.iter().filter(is_number).cloned().collect();
    let query = Query { kind: QueryKind::Estimate(numbers), clauses: Clauses::default(), span: *span };
    matches!(&query.kind, QueryKind::Estimate(numbers) if !numbers.is_empty()).then_some(query)
}

/// The column of each property.
pub(super) fn targets(study: &Study) -> Vec<Target> {
    let target = |ask: &Ask| match ask {
        Ask::Estimate { measure, .. } if measure.kind == MeasureKind::Probability => Some(measure.target),
        _ => None,
    };
    study.queries.iter().filter_map(|query| target(&query.ask)).collect()
}

/// A number that is asked of each instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// As it is asked.
    pub name: String,
    /// What is sought of all instants.
    pub sought: Sought,
    /// The range of a mean or a tail.
    pub range: Option<(f64, f64)>,
    /// Its unit.
    pub unit: String,
}

/// What is sought of a number over all instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// Its mean.
    Mean,
    /// A quantile.
    Quantile(f64),
    /// The mean of what lies above a quantile.
    Tail(f64),
}

/// The numbers that are asked, with the column of each.
pub(super) fn numbers(study: &Study) -> Vec<(Asked, Target)> {
    let of = |query: &crate::compile::study::Query| {
        let Ask::Estimate { measure, .. } = &query.ask else { return None };
        let (sought, dimension) = match &measure.kind {
            MeasureKind::Expectation { dimension, level, .. } => {
                (level.map_or(Sought::Mean, Sought::Tail), dimension)
            }
            MeasureKind::Quantile { level, dimension } => (Sought::Quantile(*level), dimension),
            MeasureKind::Probability | MeasureKind::Curve { .. } => return None,
        };
        let name = query.said.measure.clone();
        Some((
            Asked { name, sought, range: measure.kind.range(), unit: dimension.to_string() },
            measure.target,
        ))
    };
    study.queries.iter().filter_map(of).collect()
}
