//! Kinds of agents: parameters inherited, preset, overridden.

use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::laws::value_span;
use super::planning::{self, Planning};
use super::presets::{PRESETS, law};
use super::symbols::{Meaning, unknown};
use crate::model::stepper::{stature, stepped_default};
use crate::model::{self, Body, GaitRule, Law, Parameter, Planner, SearchRule, Stepper};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, KindDecl, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The parameters of a kind as far as they are known.
#[derive(Clone, Debug, Default)]
pub(super) struct Kind {
    /// The kind of the language from which it starts.
    pub(super) base: model::Kind,
    /// Whether it goes straight for its goals whatever is in the way.
    straight: bool,
    /// How its walkers plan, if they do.
    pub(super) planning: Planning,
    /// Where the steps of its walkers come from, and how they are chosen, if they step.
    pub(super) gait: GaitRule,
    pub(super) search: SearchRule,
    /// A law for each parameter.
    laws: [Option<Law>; Parameter::COUNT],
}

/// The field that says how an agent finds its way, and its values; the first one is the default.
const WAYFINDING: &str = "wayfinding";
const WAYS: [&str; 2] = ["shortest", "straight"];

/// The fields of a kind that are no parameters.
fn fields_of(kind: model::Kind) -> &'static [&'static str] {
    match kind {
        model::Kind::Sfm => &[WAYFINDING],
        model::Kind::Planned => &planning::FIELDS,
        model::Kind::Stepped => &["gait", "search"],
    }
}

/// Some law of a parameter.
fn any_law(parameter: Parameter) -> Option<Law> {
    let preset = PRESETS.iter().find_map(|preset| law(preset.name, parameter));
    // A value that all parameters of plans may have.
    preset.or_else(|| parameter.allows(2.0).then_some(Law::Constant(2.0)))
}

impl Kind {
    /// The parameter of this name, if the kind has it.
    fn parameter(&self, name: &str) -> Option<Parameter> {
        Parameter::of_kind(self.base).find(|parameter| parameter.name() == name)
    }

    /// The law of a parameter: as set, or its default.
    pub(super) fn law(&self, parameter: Parameter) -> Option<Law> {
        let default = || parameter.description().default.map(Law::Constant);
        let of_kind = || match self.base {
            model::Kind::Sfm => None,
            model::Kind::Planned => {
                planning::default_law(parameter, self.laws[Parameter::LimitSpeed as usize].as_ref())
            }
            model::Kind::Stepped => stepped_default(parameter),
        };
        self.laws[parameter as usize].clone().or_else(of_kind).or_else(default)
    }

    /// Sets the law of a parameter.
    pub(super) fn set(&mut self, parameter: Parameter, law: Law) {
        self.laws[parameter as usize] = Some(law);
    }
}

impl Elaborator<'_> {
    /// The parameters of a kind by name.
    pub(super) fn kind(&mut self, name: &Ident) -> Lowered<Kind> {
        if let Some(base) = model::Kind::named(&name.name) {
            return Ok(Kind { base, ..Kind::default() });
        }
        let Some((_, meaning)) = self.find(&name.name, 0) else {
            let looked_at = if self.looks_for_names() { usize::MAX } else { 0 };
            let declared = self.scopes[0]
                .entries()
                .take(looked_at)
                .filter(|(_, e)| matches!(e.meaning, Meaning::Kind(_)))
                .map(|(n, _)| n);
            let error = unknown(
                "kind",
                &name.name,
                name.span,
                Code::E0208,
                declared.chain(model::Kind::ALL.map(model::Kind::name)),
            );
            return self.report(error);
        };
        let Meaning::Kind(decl) = meaning else {
            if matches!(meaning, Meaning::Doubtful) {
                return Err(Reported);
            }
            return self.report(error!(
                E0206,
                name.span,
                "expected a kind, but `{}` is {}",
                name.name,
                meaning.noun()
            ));
        };
        if self.expanding.iter().any(|(_, n)| *n == name.name) {
            if self.circles.contains(&name.name) {
                return Err(Reported);
            }
            self.circles.extend(self.expanding.iter().map(|(_, n)| n.clone()));
            return self.report(
                error!(E0205, name.span, "the kind `{}` depends on itself", name.name).about(About::Circle),
            );
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
                    for parameter in Parameter::of_kind(kind.base) {
                        if let Some(law) = law(&preset.name, parameter) {
                            kind.laws[parameter as usize] = Some(law);
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
        let base = kind.as_ref().map(|kind| kind.base).unwrap_or_default();
        let rest = self.parameters(&decl.body, kind.as_mut().ok(), &Locals::default());
        for field in rest {
            let known = Parameter::of_kind(base).map(Parameter::name).chain(fields_of(base).iter().copied());
            let error = unknown("parameter", &field.name.name, field.name.span, Code::E0207, known);
            self.note(error);
            // The words of a field that other kinds have are no names.
            let name = field.name.name.as_str();
            if model::Kind::ALL.iter().all(|kind| !fields_of(*kind).contains(&name)) {
                self.look_at(&field.value, &Locals::default());
            }
            kind = Err(Reported);
        }
        kind
    }

    /// Takes the parameters among some fields into a kind; returns the other fields.
    pub(super) fn parameters<'f>(
        &mut self,
        fields: impl IntoIterator<Item = &'f Field>,
        mut kind: Option<&mut Kind>,
        locals: &Locals,
    ) -> Vec<&'f Field> {
        let mut rest = Vec::new();
        let mut set: BTreeMap<&str, &Field> = BTreeMap::new();
        for field in fields {
            let first = *set.entry(&field.name.name).or_insert(field);
            if !std::ptr::eq(first, field) {
                let error = error!(E0202, field.name.span, "`{}` is set twice", field.name.name)
                    .related(first.name.span, "first set here");
                self.note(error);
                continue;
            }
            let base = kind.as_ref().map(|kind| kind.base).unwrap_or_default();
            if fields_of(base).contains(&field.name.name.as_str()) {
                let taken = match (&mut kind, base) {
                    (Some(kind), model::Kind::Planned) => self.planning(field, kind, locals),
                    (Some(kind), model::Kind::Stepped) => self.stepping(field, kind, locals),
                    (kind, _) => self.goes_straight(&field.value).map(|straight| {
                        if let Some(kind) = kind {
                            kind.straight = straight;
                        }
                    }),
                };
                self.given_up |= taken.is_err();
                continue;
            }
            let known = match &kind {
                Some(kind) => kind.parameter(&field.name.name),
                None => Parameter::named(&field.name.name),
            };
            let Some(parameter) = known else {
                rest.push(field);
                continue;
            };
            let law = self.parameter_law(parameter, &field.value, locals);
            self.given_up |= law.is_err();
            self.any_start |= law.is_err() && parameter == Parameter::Radius;
            // What was set wrongly is set: any value will do until it is set right.
            let Some(law) = law.ok().or_else(|| any_law(parameter)) else { continue };
            if let Some(kind) = &mut kind {
                kind.laws[parameter as usize] = Some(law);
            }
        }
        rest
    }

    /// The law of a parameter, all of whose values are possible.
    pub(super) fn parameter_law(
        &mut self,
        parameter: Parameter,
        value: &Value,
        locals: &Locals,
    ) -> Lowered<Law> {
        let mut law = self.law(value, parameter.description().dimension, locals)?;
        if parameter == Parameter::Height {
            law = stature(law);
        }
        match parameter.refuses(&law) {
            None => Ok(law),
            Some(reason) => self.report(error!(E0405, value_span(value), "{reason}")),
        }
    }

    /// The body of a kind: every parameter must be known now.
    pub(super) fn body(&mut self, kind: &Kind, name: &Ident) -> Lowered<Body> {
        if kind.base != model::Kind::Sfm {
            self.refuse_if_periodic(
                name.span,
                "walkers that plan or step",
                "use a kind that starts from `sfm`",
            )?;
        }
        let missing = Parameter::of_kind(kind.base).filter(|parameter| kind.law(*parameter).is_none());
        // A preferred speed follows from the largest one.
        let follows =
            |parameter: &Parameter| kind.base == model::Kind::Planned && *parameter == Parameter::Speed;
        let missing: Vec<&str> =
            missing.filter(|parameter| !follows(parameter)).map(Parameter::name).collect();
        if !missing.is_empty() {
            let title = format!("`{}` has no {}", name.name, missing.join(", "));
            // Said once, however many are of that kind.
            if self.diagnostics.iter().any(|d| d.code == Code::E0209 && d.title == title) {
                return Err(Reported);
            }
            let hint = if kind.base == model::Kind::Planned {
                "write for example `limit speed = 1.5 m/s` in the kind"
            } else {
                "set the values, or start from a preset: `kind adult: sfm preset smc1 { … }`"
            };
            return self.report(error!(E0209, name.span, "{title}"; hint: "{hint}"));
        }
        let mut body = Body::new(kind.base, |parameter| {
            // A parameter that the kind does not have: 0 where it may be.
            let neutral = [0.0, 1.0, 2.0].into_iter().find(|value| parameter.allows(*value));
            kind.law(parameter).unwrap_or(Law::Constant(neutral.unwrap_or_default()))
        });
        let is_planned = kind.base == model::Kind::Planned;
        body.finds_ways = !kind.straight && kind.base == model::Kind::Sfm;
        body.stepper = (kind.base == model::Kind::Stepped).then(|| {
            let sets_speed = kind.laws[Parameter::Speed as usize].is_some();
            Arc::new(Stepper { gait: kind.gait.clone(), search: kind.search, sets_speed })
        });
        let Planning { roadmap, clearance, profile } = kind.planning.clone();
        body.planner = is_planned.then(|| {
            let speed_follows = kind.laws[Parameter::Speed as usize].is_none();
            Arc::new(Planner { kind: name.name.clone(), roadmap, clearance, profile, speed_follows })
        });
        Ok(body)
    }

    /// The bodies of the declared kinds that have all parameters, by name. To be called when all errors were taken: it notes
    /// what the other kinds lack, which is no error of a kind that no agent has.
    pub(super) fn bodies(&mut self) -> BTreeMap<String, Body> {
        let known = std::mem::take(&mut self.kinds).into_iter();
        let complete = known.filter_map(|(name, kind)| {
            let ident = Ident { name, span: Span::default() };
            let body = self.body(&kind.ok()?, &ident).ok()?;
            Some((ident.name, body))
        });
        complete.collect()
    }

    /// The value of the field that says how an agent finds its way.
    fn goes_straight(&mut self, value: &Value) -> Lowered<bool> {
        let name = match value {
            Value::Plain(Expr { kind: ExprKind::Name(name), .. }) => Some(name.as_str()),
            _ => None,
        };
        let known = name.and_then(|name| WAYS.iter().position(|way| *way == name));
        if known.is_none() {
            let said = "`wayfinding` must be `shortest` or `straight`";
            return self.report(error!(E0305, value_span(value), "{said}";
                hint: "write `wayfinding = straight` for agents that go straight for their goals whatever is in the way"));
        }
        Ok(known == Some(1))
    }
}
