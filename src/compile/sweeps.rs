//! The points of a call: every combination of the values that `--set` names.

use super::elaborator::{Locals, Lowered};
use super::number::Number;
use super::queries::Compiler;
use super::settings::{MOST_POINTS, Setting};
use std::collections::BTreeMap;

impl Compiler<'_> {
    /// All combinations, values of the first setting slowest. Values are computed in the plain world.
    pub(super) fn points(&mut self, plain: usize) -> Vec<BTreeMap<String, Number>> {
        let mut points: Vec<BTreeMap<String, Number>> = vec![BTreeMap::new()];
        let mut seen: Vec<&Setting> = Vec::new();
        for setting in self.input.settings {
            if seen.iter().any(|s| s.name == setting.name) {
                let error = error!(E0210, setting.span, "`{}` is set twice", setting.name);
                self.sites[plain].elaborator.note(error);
                let _ = self.set_values(plain, setting);
                continue;
            }
            seen.push(setting);
            let Ok(values) = self.set_values(plain, setting) else { continue };
            let combinations = points.len().saturating_mul(values.len());
            if combinations > MOST_POINTS {
                let error = error!(
                    E0405,
                    setting.span,
                    "a call can have at most {MOST_POINTS} combinations of values (got {combinations})"
                );
                self.sites[plain].elaborator.note(error.hint("sweep fewer parameters, or use larger steps"));
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

    fn set_values(&mut self, plain: usize, setting: &Setting) -> Lowered<Vec<Number>> {
        let name = (setting.name.as_str(), setting.span);
        self.sites[plain].elaborator.values(name, &setting.values, MOST_POINTS, &Locals::of(0))
    }
}
