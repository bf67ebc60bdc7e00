//! The fields of planned kinds that are no parameters of a body: `roadmap`, `profile`, `rounding`, `avoid`, and both sides of
//! `limit acceleration`.

use crate::compile::context::{
    Context, Locals, Lowered,
    kind::{FORCE, Kind, is_of_force},
    symbols::unknown,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    call_arguments::{self, Argument, call, word},
    laws,
};
use crate::compile::people::{kinds, routes};
use crate::compile::presets;
use crate::model::planner::{RoadmapRule, RoundingRule, SpeedRule};
use crate::model::{self, Law, Parameter};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Value};
use crate::syntax::codes::Code;

/// The word for reciprocal avoidance, and the relaxation time with it, s: its velocities are followed at once.
const RECIPROCAL: &str = "orca";
const PROMPT: f64 = 0.2;
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

/// Takes one of the fields into a kind.
pub(crate) fn planning(
    context: &mut Context<'_>,
    field: &Field,
    kind: &mut Kind,
    locals: &Locals,
) -> Lowered<()> {
    match (field.name.name.as_str(), &field.value) {
        ("limit acceleration", Value::Sided { along, across }) => {
            let along = laws::parameter_law(context, Parameter::LimitAlong, along, locals);
            let across = laws::parameter_law(context, Parameter::LimitAcross, across, locals);
            kind.set(Parameter::LimitAlong, along?);
            kind.set(Parameter::LimitAcross, across?);
            Ok(())
        }
        ("limit acceleration", value) => {
            let law = laws::parameter_law(context, Parameter::LimitAlong, value, locals)?;
            kind.set(Parameter::LimitAlong, law.clone());
            kind.set(Parameter::LimitAcross, law);
            Ok(())
        }
        ("roadmap", value) => roadmap(context, value, locals).map(|(roadmap, clearance)| {
            (kind.planning.roadmap, kind.planning.clearance) = (roadmap, clearance);
        }),
        ("profile", value) => {
            let named = |name: &str| SpeedRule::ALL.into_iter().find(|rule| rule.name() == name);
            if let Some(rule) = word(value).and_then(named) {
                kind.planning.profile = rule;
                return Ok(());
            }
            let said = "`profile` must be `varied`, `optimal` or `uniform`";
            context.report(error!(E0305, value.span(), "{said}"))
        }
        ("rounding", value) => {
            let named = |name: &str| RoundingRule::ALL.into_iter().find(|rule| rule.name() == name);
            if let Some(rule) = word(value).and_then(named) {
                kind.planning.rounding = rule;
                return Ok(());
            }
            context.report(error!(E0305, value.span(), "`rounding` must be `shared` or `half_edges`"))
        }
        (_, value) => avoid(context, value, kind),
    }
}

/// The force by which a planned kind avoids others.
fn avoid(context: &mut Context<'_>, value: &Value, kind: &mut Kind) -> Lowered<()> {
    kind.planning.reciprocal = word(value) == Some(RECIPROCAL);
    let force = match value {
        _ if kind.planning.reciprocal => Parameter::ALL.map(|parameter| match parameter {
            Parameter::A => Some(Law::Constant(0.0)),
            Parameter::Tau => Some(Law::Constant(PROMPT)),
            other => presets::law(FORCE, other),
        }),
        Value::Force { kind: base, preset } => {
            force(context, base, preset)?;
            let name = preset.name.clone();
            Parameter::ALL.map(|parameter| presets::law(&name, parameter))
        }
        Value::Plain(Expr { kind: ExprKind::Name(name), span }) => {
            let force = kinds::kind(context, &Ident { name: name.clone(), span: *span })?;
            if force.base != model::Kind::Sfm || name == model::Kind::Sfm.name() {
                let said = format!("`{name}` is no force: write `sfm preset {FORCE}` or a kind of `sfm`");
                return context.report(error!(E0305, *span, "{said}"));
            }
            Parameter::ALL.map(|parameter| force.law(parameter))
        }
        other => {
            let error = error!(E0305, other.span(), "expected a force");
            return context.report(
                error.hint(format!("write `avoid = sfm preset {FORCE}`, a kind of `sfm`, or `orca`")),
            );
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
pub(crate) fn force(context: &mut Context<'_>, base: &Ident, preset: &Ident) -> Lowered<()> {
    let mut found = Ok(());
    if base.name != model::Kind::Sfm.name() {
        let said = format!("expected `sfm`, found `{}`", base.name);
        let hint = format!("write `sfm preset {FORCE}`, or a kind of `sfm`");
        found = context.report(error!(E0305, base.span, "{said}"; hint: "{hint}"));
    }
    if presets::PRESETS.iter().all(|known| known.name != preset.name) {
        let known = presets::PRESETS.iter().map(|preset| preset.name);
        found = context.report(unknown("preset", &preset.name, preset.span, Code::E0208, known));
    }
    found
}

/// `prm(…)` or `rrt(…)`, and the clearance.
pub(crate) fn roadmap(
    context: &mut Context<'_>,
    value: &Value,
    locals: &Locals,
) -> Lowered<(RoadmapRule, f64)> {
    let Some((name, arguments)) = call(value) else {
        let error = error!(E0305, value.span(), "expected `prm(…)` or `rrt(…)`");
        return context
            .report(error.hint("write for example `roadmap = prm(samples = 500, sampling = bridge)`"));
    };
    match name.name.as_str() {
        "prm" => {
            let sampling = call_arguments::word_of(context, arguments, "sampling", &["bridge", "uniform"]);
            let values =
                call_arguments::numbers_among(context, name, arguments, &PRM, &["sampling"], locals)?;
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
                Some(argument) => routes::goal(context, &argument.value, locals),
                None => context.report(error!(E0209, name.span, "`rrt` has no root";
                            hint: "write `rrt(root = …)` with a region or a point")),
            };
            let values = call_arguments::numbers_among(context, name, arguments, &RRT, &["root"], locals)?;
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
                    let error = unknown(what, &argument.name.name, argument.name.span, Code::E0207, known);
                    context.note(error);
                } else if argument.name.name == "sampling" {
                    let _ = call_arguments::word_of(context, arguments, "sampling", &["bridge", "uniform"]);
                }
            }
            context.report(unknown("roadmap", &name.name, name.span, Code::E0208, ["prm", "rrt"].into_iter()))
        }
    }
}
