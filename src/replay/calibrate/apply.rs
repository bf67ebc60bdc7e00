//! A calibration beside the verdicts of a call: whether it is about the same formulas, kind and step, and what it says.

use super::{Bin, Calibration};
use crate::base::fingerprint::Fingerprint;
use crate::base::tick::Tick;
use crate::compile::Study;
use crate::compile::study::{Query, World};
use crate::engine::outcome::{ModelError, QueryResult};
use crate::model::Body;
use crate::syntax::ast::{Expr, PropertyFile, PropertyItem};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;

/// The fingerprint of a kind.
pub(super) fn print(body: &Body) -> String {
    Fingerprint::of(format!("{body:?}").as_bytes()).to_string()
}

/// Each property of some files with a fingerprint: of its formula, and of all constants and functions that it may use.
pub fn written(files: &[PropertyFile], sources: &[Source]) -> Vec<(String, String)> {
    let text = |expr: &Expr| {
        let source = sources.iter().find(|source| source.id == expr.span.source);
        let text = source
            .and_then(|source| source.text.get(expr.span.start as usize..expr.span.end as usize))
            .unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let items = || files.iter().flat_map(|file| &file.items);
    let mut used = Fingerprint::default();
    for item in items() {
        let (name, value) = match item {
            PropertyItem::Let(decl) => {
                let arguments: Vec<&str> = decl.arguments.iter().map(|one| one.name.as_str()).collect();
                (format!("{}({})", decl.name.name, arguments.join(",")), &decl.body)
            }
            PropertyItem::Const { name, value } => (name.name.clone(), value),
            _ => continue,
        };
        used.add(format!("{name} = {}\n", text(value)).as_bytes());
    }
    let print = |formula: &Expr| {
        let mut print = used;
        print.add(text(formula).as_bytes());
        print.to_string()
    };
    items()
        .filter_map(|item| match item {
            PropertyItem::Property { name, formula } => Some((name.name.clone(), print(formula))),
            _ => None,
        })
        .collect()
}

impl Calibration {
    /// Reads a file of `smc calibrate`.
    ///
    /// # Errors
    /// It is none.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, Diagnostic> {
        let read: Result<Self, _> = serde_json::from_slice(bytes);
        let fault = match read {
            Ok(found) if found.schema == super::SCHEMA && found.site().is_some() => return Ok(found),
            Ok(found) => format!("it has schema {}, and {} persons", found.schema, found.persons),
            Err(error) => error.to_string(),
        };
        let error = Diagnostic::placeless(Code::E0726, format!("`{name}` is no calibration: {fault}"));
        Err(error.hint("make it with `smc calibrate MODEL PROPERTIES --tracks NAME -o site.calibration`"))
    }

    /// The file.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Requires that it is about what a call asks.
    ///
    /// # Errors
    /// It is of another version, step, kind, or of other formulas.
    pub fn fits(&self, study: &Study, formulas: &[(String, String)]) -> Result<(), Diagnostic> {
        let wrong = |said: String| {
            let error =
                Diagnostic::placeless(Code::E0727, format!("the calibration of `{}` is {said}", self.site));
            Err(error.hint("make it anew with this version, model and property file"))
        };
        let minor = |version: &str| version.split('.').take(2).collect::<Vec<_>>().join(".");
        if minor(&self.version) != minor(env!("CARGO_PKG_VERSION")) {
            return wrong(format!("one of version {}", self.version));
        }
        let of_step = |step: f64| (step - self.step).abs() < 1e-9;
        if !study.worlds.iter().any(|world| of_step(world.scenario.clock.seconds(Tick(1)))) {
            return wrong(format!("one with steps of {} s", self.step));
        }
        if !study.worlds.iter().flat_map(|world| world.kinds.values()).any(|body| print(body) == self.body) {
            return wrong(format!("one of people of another kind than `{}` as it was", self.kind));
        }
        let ranges_further = |query: &Query| {
            let is_asked =
                query.name.as_ref().is_some_and(|name| self.properties.iter().any(|one| one.name == *name));
            let horizon = |world: &World| world.scenario.clock.seconds(world.scenario.horizon);
            let worlds = query.ask.worlds().into_iter().filter_map(|at| study.worlds.get(at));
            is_asked
                && query.horizon.is_some()
                && worlds.map(horizon).any(|own| (own - self.horizon).abs() > 1e-9)
        };
        if study.queries.iter().any(ranges_further) {
            return wrong(format!("one with a horizon of {} s", self.horizon));
        }
        let other = study.tracks.iter().find(|(_, velocity)| *velocity != self.velocity);
        if let Some((tracks, _)) = other {
            let (site, velocity) = (&self.site, &self.velocity);
            let said = format!(
                "the calibration of `{site}` is one with {velocity} velocities, those of `{tracks}` are others"
            );
            let error = Diagnostic::placeless(Code::E0727, said);
            return Err(error.hint(format!(
                "write `{{ velocity = {velocity} }}` behind the tracks, or add `--velocity {velocity}`"
            )));
        }
        let known = |name: &str| formulas.iter().find(|(own, _)| own == name).map(|(_, print)| print);
        let changed =
            self.properties.iter().find(|one| known(&one.name).is_some_and(|print| *print != one.formula));
        match changed {
            Some(one) => wrong(format!("one of another formula `{}`", one.name)),
            None if !formulas.is_empty() && self.properties.iter().all(|one| known(&one.name).is_none()) => {
                wrong("of none of these properties".to_owned())
            }
            None => Ok(()),
        }
    }

    /// What it says of a result, if that is about a probability of a calibrated property.
    pub fn about(&self, result: &QueryResult) -> Option<ModelError> {
        let name = result.asked.name.as_ref().filter(|_| result.of.is_none() && result.compare.is_none())?;
        let property = self.properties.iter().find(|one| one.name == *name)?;
        let p = result.estimate.filter(|p| result.unit.is_empty() && (0.0..=1.0).contains(p))?;
        let Bin { from, to, persons, held, low, high, .. } =
            *property.bins.iter().find(|bin| p >= bin.from && (p < bin.to || bin.to >= 1.0))?;
        let (site, date) = (self.site.clone(), self.date.clone());
        Some(ModelError { site, date, from, to, asked: self.persons, persons, held, low, high })
    }
}
