//! The fields of planned kinds that are no parameters of a body: `roadmap`, `profile`, `avoid`, and both sides of
//! `limit acceleration`.

use super::call_arguments::{Argument, call, word};
use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::kinds::Kind;
use super::laws::value_span;
use super::planning::{FORCE, is_of_force};
use super::presets;
use super::symbols::unknown;
use crate::model::planner::{RoadmapRule, SpeedRule};
use crate::model::{self, Parameter};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Value};
use crate::syntax::codes::Code;

/// Most samples of a roadmap.
const MOST_SAMPLES: f64 = 100_000.0;
/// Most vertices to which one is joined.
const MOST_NEIGHBOURS: f64 = 64.0;

const SAMPLES: Argument = Argument::count("samples", 2.0, MOST_SAMPLES);
const CLEARANCE: Argument = Argument::length("clearance", false);
const PRM: [Argument; 4] = [
    SAMPLES,
    Argument::length("separation", false),
    Argument::count("neighbours", 1.0, MOST_NEIGHBOURS),
    CLEARANCE,
];
const RRT: [Argument; 4] = [
    SAMPLES,
    Argument::length("step", true),
    Argument { name: "bias", dimension: Dimension::NONE, range: (0.0, 1.0), positive: false, whole: false },
    CLEARANCE,
];

impl Elaborator<'_> {
    /// Takes one of the fields into a kind.
    pub(super) fn planning(&mut self, field: &Field, kind: &mut Kind, locals: &Locals) -> Lowered<()> {
        match (field.name.name.as_str(), &field.value) {
            ("limit acceleration", Value::Sided { along, across }) => {
                let along = self.parameter_law(Parameter::LimitAlong, along, locals);
                let across = self.parameter_law(Parameter::LimitAcross, across, locals);
                kind.set(Parameter::LimitAlong, along?);
                kind.set(Parameter::LimitAcross, across?);
                Ok(())
            }
            ("limit acceleration", value) => {
                let law = self.parameter_law(Parameter::LimitAlong, value, locals)?;
                kind.set(Parameter::LimitAlong, law.clone());
                kind.set(Parameter::LimitAcross, law);
                Ok(())
            }
            ("roadmap", value) => self.roadmap(value, locals).map(|(roadmap, clearance)| {
                (kind.planning.roadmap, kind.planning.clearance) = (roadmap, clearance);
            }),
            ("profile", value) => {
                let named = |name: &str| SpeedRule::ALL.into_iter().find(|rule| rule.name() == name);
                if let Some(rule) = word(value).and_then(named) {
                    kind.planning.profile = rule;
                    return Ok(());
                }
                let said = "`profile` must be `varied`, `optimal` or `uniform`";
                self.report(error!(E0305, value_span(value), "{said}"))
            }
            (_, value) => self.avoid(value, kind),
        }
    }

    /// The force by which a planned kind avoids others.
    fn avoid(&mut self, value: &Value, kind: &mut Kind) -> Lowered<()> {
        let force = match value {
            Value::Force { kind: base, preset } => {
                self.force(base, preset)?;
                let name = preset.name.clone();
                Parameter::ALL.map(|parameter| presets::law(&name, parameter))
            }
            Value::Plain(Expr { kind: ExprKind::Name(name), span }) => {
                let force = self.kind(&Ident { name: name.clone(), span: *span })?;
                if force.base != model::Kind::Sfm || name == model::Kind::Sfm.name() {
                    let said = format!("`{name}` is no force: write `sfm preset {FORCE}` or a kind of `sfm`");
                    return self.report(error!(E0305, *span, "{said}"));
                }
                Parameter::ALL.map(|parameter| force.law(parameter))
            }
            other => {
                let error = error!(E0305, value_span(other), "expected a force");
                return self
                    .report(error.hint(format!("write `avoid = sfm preset {FORCE}` or a kind of `sfm`")));
            }
        };
        for (parameter, law) in Parameter::ALL.into_iter().zip(force) {
            if let Some(law) = law.filter(|_| is_of_force(parameter)) {
                kind.set(parameter, law);
            }
        }
        Ok(())
    }

    /// Checks the words of `sfm preset helbing2000`.
    pub(super) fn force(&mut self, base: &Ident, preset: &Ident) -> Lowered<()> {
        let mut found = Ok(());
        if base.name != model::Kind::Sfm.name() {
            let said = format!("expected `sfm`, found `{}`", base.name);
            let hint = format!("write `sfm preset {FORCE}`, or a kind of `sfm`");
            found = self.report(error!(E0305, base.span, "{said}"; hint: "{hint}"));
        }
        if presets::PRESETS.iter().all(|known| known.name != preset.name) {
            let known = presets::PRESETS.iter().map(|preset| preset.name);
            found = self.report(unknown("preset", &preset.name, preset.span, Code::E0208, known));
        }
        found
    }

    /// `prm(…)` or `rrt(…)`, and the clearance.
    pub(super) fn roadmap(&mut self, value: &Value, locals: &Locals) -> Lowered<(RoadmapRule, f64)> {
        let Some((name, arguments)) = call(value) else {
            let error = error!(E0305, value_span(value), "expected `prm(…)` or `rrt(…)`");
            return self
                .report(error.hint("write for example `roadmap = prm(samples = 500, sampling = bridge)`"));
        };
        match name.name.as_str() {
            "prm" => {
                let sampling = self.word_of(arguments, "sampling", &["bridge", "uniform"]);
                let values = self.numbers_among(name, arguments, &PRM, &["sampling"], locals)?;
                let [samples, separation, neighbours, clearance] = values;
                let rule = RoadmapRule::Prm {
                    samples: samples.unwrap_or(500.0) as u32,
                    bridge: sampling? != Some("uniform"),
                    separation: separation.unwrap_or(0.5),
                    neighbours: neighbours.unwrap_or(6.0) as u32,
                };
                Ok((rule, clearance.unwrap_or(0.2)))
            }
            "rrt" => {
                let root = match arguments.iter().find(|argument| argument.name.name == "root") {
                    Some(argument) => self.goal(&argument.value, locals),
                    None => self.report(error!(E0209, name.span, "`rrt` has no root";
                            hint: "write `rrt(root = …)` with a region or a point")),
                };
                let values = self.numbers_among(name, arguments, &RRT, &["root"], locals)?;
                let [samples, step, bias, clearance] = values;
                let rule = RoadmapRule::Rrt {
                    root: root?,
                    samples: samples.unwrap_or(500.0) as u32,
                    step: step.unwrap_or(0.5),
                    bias: bias.unwrap_or(0.05),
                };
                Ok((rule, clearance.unwrap_or(0.2)))
            }
            _ => {
                // Its arguments are looked at as those of any roadmap.
                for argument in arguments {
                    let known = PRM.iter().chain(&RRT).map(|known| known.name).chain(["sampling", "root"]);
                    if known.clone().all(|name| name != argument.name.name) {
                        let what = "argument of a roadmap";
                        let error =
                            unknown(what, &argument.name.name, argument.name.span, Code::E0207, known);
                        self.note(error);
                    } else if argument.name.name == "sampling" {
                        let _ = self.word_of(arguments, "sampling", &["bridge", "uniform"]);
                    }
                }
                self.report(unknown(
                    "roadmap",
                    &name.name,
                    name.span,
                    Code::E0208,
                    ["prm", "rrt"].into_iter(),
                ))
            }
        }
    }
}
