//! The formulas that are asked of a recording: all properties of the property files.

use crate::compile::study::{Ask, Study, Target};
use crate::syntax::ast::{PropertyFile, PropertyItem};
use crate::syntax::parse::parse_properties;
use crate::syntax::source::{Source, SourceId};

/// Property files whose queries are replaced by one for each property.
#[derive(Clone, Debug, Default)]
pub struct Formulas {
    /// Names of the properties, in order of writing.
    pub names: Vec<String>,
    /// The files.
    pub(super) files: Vec<PropertyFile>,
    /// The text of the new queries.
    pub(super) source: Source,
}

impl Formulas {
    /// One query for each property of some files. The text of the queries is a source of its own.
    pub(super) fn of(files: &[PropertyFile], id: SourceId) -> Self {
        let mut files = files.to_vec();
        let mut names = Vec::new();
        for file in &mut files {
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
        Self { names, files, source }
    }
}

/// The column of each property.
pub(super) fn targets(study: &Study) -> Vec<Target> {
    let target = |ask: &Ask| match ask {
        Ask::Estimate { measure, .. } => Some(measure.target),
        _ => None,
    };
    study.queries.iter().filter_map(|query| target(&query.ask)).collect()
}
