//! The fields of planned kinds that are no parameters of a body: `roadmap`, `profile`, `avoid`, and both sides of
//! `limit acceleration`.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::kinds::Kind;
use super::laws::value_span;
use super::planning::{FORCE, is_of_force};
use super::presets;
use super::symbols::unknown;
use crate::model::planner::{RoadmapRule, SpeedRule};
use crate::model::{self, Parameter};
use crate::syntax::ast::{Binding, Expr, ExprKind, Field, Ident, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Most samples of a roadmap.
const MOST_SAMPLES: f64 = 100_000.0;
/// Most vertices to which one is joined.
const MOST_NEIGHBOURS: f64 = 64.0;

/// One argument of a way to draw roadmaps.
struct Argument {
    name: &'static str,
    dimension: Dimension,
    /// Least and largest value; open below where it must be positive.
    range: (f64, f64),
    positive: bool,
    whole: bool,
}

impl Argument {
    const fn length(name: &'static str, positive: bool) -> Self {
        Self { name, dimension: Dimension::LENGTH, range: (0.0, 1e4), positive, whole: false }
    }

    const fn count(name: &'static str, least: f64, most: f64) -> Self {
        Self { name, dimension: Dimension::NONE, range: (least, most), positive: false, whole: true }
    }
}

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
                self.report(Diagnostic::error(Code::E0305, value_span(value), said))
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
                    return self.report(Diagnostic::error(Code::E0305, *span, said));
                }
                Parameter::ALL.map(|parameter| force.law(parameter))
            }
            other => {
                let error = Diagnostic::error(Code::E0305, value_span(other), "expected a force");
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
            found = self.report(Diagnostic::error(Code::E0305, base.span, said).hint(hint));
        }
        if presets::PRESETS.iter().all(|known| known.name != preset.name) {
            let known = presets::PRESETS.iter().map(|preset| preset.name);
            found = self.report(unknown("preset", &preset.name, preset.span, Code::E0208, known));
        }
        found
    }

    /// `prm(…)` or `rrt(…)`, and the clearance.
    pub(super) fn roadmap(&mut self, value: &Value, locals: &Locals) -> Lowered<(RoadmapRule, f64)> {
        let (name, arguments): (&Ident, &[Binding]) = match value {
            Value::Arguments { name, arguments } => (name, arguments),
            Value::Plain(Expr { kind: ExprKind::Call { function, arguments }, .. })
                if arguments.is_empty() =>
            {
                (function, &[])
            }
            other => {
                let error =
                    Diagnostic::error(Code::E0305, value_span(other), "expected `prm(…)` or `rrt(…)`");
                return self.report(
                    error.hint("write for example `roadmap = prm(samples = 500, sampling = bridge)`"),
                );
            }
        };
        match name.name.as_str() {
            "prm" => {
                let sampling = self.word_of(arguments, "sampling", &["bridge", "uniform"]);
                let values = self.roadmap_numbers(name, arguments, &PRM, &["sampling"], locals)?;
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
                    None => {
                        let error = Diagnostic::error(Code::E0209, name.span, "`rrt` has no root");
                        self.report(error.hint("write `rrt(root = …)` with a region or a point"))
                    }
                };
                let values = self.roadmap_numbers(name, arguments, &RRT, &["root"], locals)?;
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

    /// An argument that is one of some words.
    fn word_of(
        &mut self,
        all: &[Binding],
        name: &str,
        words: &[&'static str],
    ) -> Lowered<Option<&'static str>> {
        let Some(argument) = all.iter().find(|argument| argument.name.name == name) else { return Ok(None) };
        let found = match &argument.value.kind {
            ExprKind::Name(word) => words.iter().copied().find(|known| known == word),
            _ => None,
        };
        if found.is_some() {
            return Ok(found);
        }
        let said = format!("`{name}` must be `{}`", words.join("` or `"));
        self.report(Diagnostic::error(Code::E0305, argument.value.span, said))
    }

    /// The numbers among the arguments of a roadmap.
    fn roadmap_numbers<const N: usize>(
        &mut self,
        of: &Ident,
        all: &[Binding],
        known: &[Argument; N],
        others: &[&str],
        locals: &Locals,
    ) -> Lowered<[Option<f64>; N]> {
        let mut values = [None; N];
        let mut failed = false;
        for (k, argument) in all.iter().enumerate() {
            let name = &argument.name;
            if all[..k].iter().any(|before| before.name.name == name.name) {
                let said = format!("`{}` is given twice", name.name);
                self.note(Diagnostic::error(Code::E0202, name.span, said));
                failed = true;
            } else if let Some(at) = known.iter().position(|known| known.name == name.name) {
                match self.roadmap_number(&known[at], &argument.value, locals) {
                    Ok(value) => values[at] = Some(value),
                    Err(Reported) => failed = true,
                }
            } else if !others.contains(&name.name.as_str()) {
                let names = known.iter().map(|known| known.name).chain(others.iter().copied());
                let what = format!("argument of `{}`", of.name);
                self.note(unknown(&what, &name.name, name.span, Code::E0207, names));
                failed = true;
            }
        }
        if failed { Err(Reported) } else { Ok(values) }
    }

    fn roadmap_number(&mut self, argument: &Argument, value: &Expr, locals: &Locals) -> Lowered<f64> {
        let number = self.number_of(value, argument.dimension, locals)?;
        let (low, high) = argument.range;
        let fits = (low..=high).contains(&number.value)
            && !(argument.positive && number.value == 0.0)
            && !(argument.whole && number.as_whole().is_none());
        if fits {
            return Ok(number.value);
        }
        let unit = argument.dimension.to_string();
        let (unit, what) = (if unit.is_empty() { unit } else { format!(" {unit}") }, argument.name);
        let said = match (argument.whole, argument.positive) {
            (true, _) => format!("`{what}` must be a whole number from {low} to {high}"),
            (false, true) => format!("`{what}` must be positive and at most {high}{unit}"),
            (false, false) => format!("`{what}` must be from {low} to {high}{unit}"),
        };
        self.report(Diagnostic::error(
            Code::E0405,
            value.span,
            format!("{said} (got {}{unit})", number.value),
        ))
    }

    /// Refuses a walker who plans where one body stands for several persons.
    pub(super) fn refuse_planned_particle(&mut self, kind: &Kind, at: Span) -> Lowered<()> {
        if kind.base != model::Kind::Planned {
            return Ok(());
        }
        let error = Diagnostic::error(Code::E0406, at, "walkers that plan cannot move `as particle`");
        self.report(error.hint("remove `as particle` to simulate the members"))
    }
}

/// A value that is one word.
fn word(value: &Value) -> Option<&str> {
    match value {
        Value::Plain(Expr { kind: ExprKind::Name(name), .. }) => Some(name),
        _ => None,
    }
}
