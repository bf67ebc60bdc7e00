//! Kinds of agents: parameters inherited, preset, overridden.

use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::laws::value_span;
use super::presets::{PARAMETERS, PRESETS, law};
use super::symbols::{Meaning, unknown};
use crate::model::{Body, Law, TOP_SPEED};
use crate::syntax::ast::{Field, Ident, KindDecl};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeMap;

/// The parameters of a kind as far as they are known.
#[derive(Clone, Debug, Default)]
pub(super) struct Kind {
    /// A law for each of `PARAMETERS`.
    pub(super) laws: [Option<Law>; PARAMETERS.len()],
}

/// Index of a parameter.
pub(super) fn parameter(name: &str) -> Option<usize> {
    PARAMETERS.iter().position(|(n, ..)| *n == name)
}

/// Some law of a parameter.
fn any_law(parameter: &str) -> Option<Law> {
    PRESETS.iter().find_map(|preset| law(preset.name, parameter))
}

impl Kind {
    /// The law of a parameter.
    pub(super) fn law(&self, name: &str) -> Option<&Law> {
        parameter(name).and_then(|at| self.laws[at].as_ref())
    }

    /// Sets the law of a parameter.
    pub(super) fn set(&mut self, name: &str, law: Law) {
        if let Some(at) = parameter(name) {
            self.laws[at] = Some(law);
        }
    }
}

impl Elaborator<'_> {
    /// The parameters of a kind by name.
    pub(super) fn kind(&mut self, name: &Ident) -> Lowered<Kind> {
        if name.name == "sfm" {
            return Ok(Kind::default());
        }
        let Some((_, meaning)) = self.find(&name.name, 0) else {
            let looked_at = if self.looks_for_names() { usize::MAX } else { 0 };
            let declared = self.scopes[0]
                .entries()
                .take(looked_at)
                .filter(|(_, e)| matches!(e.meaning, Meaning::Kind(_)))
                .map(|(n, _)| n);
            let error = unknown("kind", &name.name, name.span, Code::E0208, declared.chain(["sfm"]));
            return self.report(error);
        };
        let Meaning::Kind(decl) = meaning else {
            if matches!(meaning, Meaning::Doubtful) {
                return Err(Reported);
            }
            let error = Diagnostic::error(
                Code::E0206,
                name.span,
                format!("expected a kind, but `{}` is {}", name.name, meaning.noun()),
            );
            return self.report(error);
        };
        if self.expanding.iter().any(|(_, n)| *n == name.name) {
            if self.circles.contains(&name.name) {
                return Err(Reported);
            }
            self.circles.extend(self.expanding.iter().map(|(_, n)| n.clone()));
            return self.report(Diagnostic::error(
                Code::E0205,
                name.span,
                format!("the kind `{}` depends on itself", name.name),
            ));
        }
        if let Some(known) = self.kinds.get(&name.name) {
            return known.clone();
        }
        self.expand_further(name.span)?;
        self.expanding.push((0, name.name.clone()));
        let kind = self.own_kind(decl);
        self.expanding.pop();
        self.kinds.insert(name.name.clone(), kind.clone());
        kind
    }

    /// The parameters of a kind as it is declared.
    pub(super) fn own_kind(&mut self, decl: &KindDecl) -> Lowered<Kind> {
        let mut kind = self.kind(&decl.base);
        if let Some(preset) = &decl.preset {
            if PRESETS.iter().any(|p| p.name == preset.name) {
                if let Ok(kind) = &mut kind {
                    for (parameter, ..) in PARAMETERS {
                        if let Some(law) = law(&preset.name, parameter) {
                            kind.set(parameter, law);
                        }
                    }
                }
            } else {
                let error =
                    unknown("preset", &preset.name, preset.span, Code::E0208, PRESETS.iter().map(|p| p.name));
                let known = format!("the presets are {}", PRESETS.map(|p| p.name).join(", "));
                let error = match error.hint.clone() {
                    Some(near) => error.hint(format!("{near} {known}")),
                    None => error.hint(known),
                };
                self.note(error);
                kind = Err(Reported);
            }
        }
        let rest = self.parameters(&decl.body, kind.as_mut().ok(), &Locals::default());
        for field in rest {
            let known = PARAMETERS.iter().map(|(n, ..)| *n);
            let error = unknown("parameter", &field.name.name, field.name.span, Code::E0207, known);
            self.note(error);
            self.look_at(&field.value, &Locals::default());
            kind = Err(Reported);
        }
        kind
    }

    /// Takes the parameters among some fields into a kind; returns the other fields.
    pub(super) fn parameters<'f>(
        &mut self,
        fields: &'f [Field],
        mut kind: Option<&mut Kind>,
        locals: &Locals,
    ) -> Vec<&'f Field> {
        let mut rest = Vec::new();
        let mut set: BTreeMap<&str, &Field> = BTreeMap::new();
        for field in fields {
            let first = *set.entry(&field.name.name).or_insert(field);
            if !std::ptr::eq(first, field) {
                let error = Diagnostic::error(
                    Code::E0202,
                    field.name.span,
                    format!("`{}` is set twice", field.name.name),
                )
                .related(first.name.span, "first set here");
                self.note(error);
                continue;
            }
            let Some(index) = parameter(&field.name.name) else {
                rest.push(field);
                continue;
            };
            let (name, dimension, _) = PARAMETERS[index];
            let law = match self.law(&field.value, dimension, locals) {
                Ok(law) => match out_of_range(name, &law) {
                    None => Ok(law),
                    Some(reason) => {
                        self.report(Diagnostic::error(Code::E0405, value_span(&field.value), reason))
                    }
                },
                Err(reported) => Err(reported),
            };
            self.given_up |= law.is_err();
            self.any_start |= law.is_err() && name == "radius";
            // What was set wrongly is set: any value will do until it is set right.
            let Some(law) = law.ok().or_else(|| any_law(name)) else { continue };
            if let Some(kind) = &mut kind {
                kind.laws[index] = Some(law);
            }
        }
        rest
    }

    /// The body of a kind: every parameter must be known now.
    pub(super) fn body(&mut self, kind: &Kind, name: &Ident) -> Lowered<Body> {
        let missing: Vec<&str> = PARAMETERS
            .iter()
            .enumerate()
            .filter(|(at, (_, _, default))| kind.laws[*at].is_none() && default.is_none())
            .map(|(_, (name, ..))| *name)
            .collect();
        if !missing.is_empty() {
            let title = format!("`{}` has no {}", name.name, missing.join(", "));
            // Said once, however many are of that kind.
            if self.diagnostics.iter().any(|d| d.code == Code::E0209 && d.title == title) {
                return Err(Reported);
            }
            let error = Diagnostic::error(Code::E0209, name.span, title)
                .hint("set the values, or start from a preset: `kind adult: sfm preset helbing2000 { … }`");
            return self.report(error);
        }
        let law = |name: &str| {
            kind.law(name)
                .cloned()
                .or_else(|| parameter(name).and_then(|at| PARAMETERS[at].2).map(Law::Constant))
        };
        let all = || -> Option<Body> {
            Some(Body {
                mass: law("mass")?,
                radius: law("radius")?,
                speed: law("speed")?,
                tau: law("tau")?,
                a: law("A")?,
                b: law("B")?,
                lambda: law("lambda")?,
                a2: law("A2")?,
                b2: law("B2")?,
                lambda2: law("lambda2")?,
                k1: law("k1")?,
                k2: law("k2")?,
                noise: law("noise")?,
                attention: law("attention")?,
            })
        };
        all().ok_or(Reported)
    }
}

/// Why a law cannot be that of a parameter: the support must be physically possible.
pub(super) fn out_of_range(name: &str, law: &Law) -> Option<String> {
    let (low, high) = law.bounds();
    let positive = matches!(name, "mass" | "radius" | "tau" | "B" | "B2");
    let share = matches!(name, "lambda" | "lambda2" | "attention");
    let constant = law.constant().is_some();
    let truncate = if constant { "" } else { "; truncate the distribution: `… in lo .. hi`" };
    if positive && (low < 0.0 || (constant && low == 0.0)) {
        return Some(format!("`{name}` must be positive{truncate}"));
    }
    if !positive && low < 0.0 {
        return Some(format!("`{name}` cannot be negative{truncate}"));
    }
    if matches!(name, "speed" | "noise") && low > TOP_SPEED {
        return Some(format!(
            "`{name}` exceeds {TOP_SPEED} m/s, the limit for a person; every trial would diverge"
        ));
    }
    if share && high > 1.0 {
        return Some(format!("`{name}` must be between 0 and 1{truncate}"));
    }
    None
}
