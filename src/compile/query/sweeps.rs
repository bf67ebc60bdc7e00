//! The points of a call: every combination of the values that `--set` names.

use crate::compile::context::{Locals, Lowered, number::Number};
use crate::compile::query::{
    compiler::Compiler,
    settings::{self, MOST_POINTS, Setting},
};
use std::collections::BTreeMap;

/// All combinations, values of the first setting slowest. Values are computed in the plain world.
pub(crate) fn points(compiler: &mut Compiler<'_>, plain: usize) -> Vec<BTreeMap<String, Number>> {
    let mut points: Vec<BTreeMap<String, Number>> = vec![BTreeMap::new()];
    let mut seen: Vec<&Setting> = Vec::new();
    for setting in compiler.input.settings {
        if seen.iter().any(|s| s.name == setting.name) {
            let error = error!(E0210, setting.span, "`{}` is set twice", setting.name);
            compiler.sites[plain].context.note(error);
            let _ = set_values(compiler, plain, setting);
            continue;
        }
        seen.push(setting);
        let Ok(values) = set_values(compiler, plain, setting) else { continue };
        let combinations = points.len().saturating_mul(values.len());
        if combinations > MOST_POINTS {
            let error = error!(
                E0405,
                setting.span,
                "a call can have at most {MOST_POINTS} combinations of values (got {combinations})"
            );
            compiler.sites[plain].context.note(error.hint("sweep fewer parameters, or use larger steps"));
            continue;
        }
        points = points
            .iter()
            .flat_map(|point| {
                values.iter().map(|value| {
                    let mut next = point.clone();
                    next.insert(setting.name.clone(), *value);
                    next
                })
            })
            .collect();
    }
    points
}

fn set_values(compiler: &mut Compiler<'_>, plain: usize, setting: &Setting) -> Lowered<Vec<Number>> {
    let name = (setting.name.as_str(), setting.span);
    settings::values(&mut compiler.sites[plain].context, name, &setting.values, MOST_POINTS, &Locals::of(0))
}
