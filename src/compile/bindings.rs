//! The worlds that queries set up with `under`: their values, and these in words.

use super::elaborator::{Locals, Lowered, Reported};
use super::number::Number;
use super::queries::{Compiler, Site};
use super::symbols::{Meaning, ScopeId};
use crate::syntax::ast::Binding;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

impl<'a> Compiler<'a> {
    /// Values of the swept parameters in words.
    pub(super) fn described(
        &self,
        site: usize,
        point: &BTreeMap<String, Number>,
        names: &[&str],
    ) -> Vec<(String, String)> {
        let elaborator = &self.sites[site].elaborator;
        names
            .iter()
            .filter_map(|name| {
                let number = point.get(*name)?;
                let shown = match elaborator.scopes[0].get(name).map(|e| e.meaning.clone()) {
                    Some(Meaning::Param { value, .. }) => elaborator.shown(value, *number),
                    _ => number.value.to_string(),
                };
                Some(((*name).to_owned(), shown))
            })
            .collect()
    }

    /// The world in which some parameters take other values, and these in words.
    pub(super) fn under(
        &mut self,
        bindings: &'a [Binding],
        scope: ScopeId,
        base: usize,
        point: &BTreeMap<String, Number>,
    ) -> Lowered<(usize, Vec<(String, String)>)> {
        let mut settings = point.clone();
        let mut failed = false;
        for binding in bindings {
            let elaborator = &mut self.sites[base].elaborator;
            if let Some(first) = bindings.iter().find(|b| b.name.name == binding.name.name)
                && first.name.span != binding.name.span
            {
                let text = format!("`{}` is set twice", binding.name.name);
                let error = error!(E0210, binding.name.span, "{text}");
                elaborator.note(error.related(first.name.span, "first set here"));
                failed = true;
                continue;
            }
            if elaborator.param(&binding.name.name, binding.name.span).is_err() {
                let _ = elaborator.number(&binding.value, &Locals::of(scope));
                failed = true;
                continue;
            }
            match elaborator.setting(&binding.name.name, &binding.value, &Locals::of(scope)) {
                Ok(number) => {
                    settings.insert(binding.name.name.clone(), number);
                }
                Err(_) => failed = true,
            }
        }
        if failed {
            return Err(Reported);
        }
        let names: Vec<&str> = bindings.iter().map(|b| b.name.name.as_str()).collect();
        let described = self.described(base, &settings, &names);
        let site = self.site(settings);
        // What was set elsewhere, too, has to lie in a range that is set here.
        let own = |name: &str| bindings.iter().find(|binding| binding.name.name == name).or(bindings.last());
        let settings = self.sites[site].settings.keys();
        let place = |name: &String| own(name).map(|binding| (binding.value.span, binding.value.span));
        let set: Vec<_> = settings.filter_map(|name| Some((name.clone(), place(name)?))).collect();
        self.check_ranges(site, set)?;
        Ok((site, described))
    }

    /// Whether the set values are in ranges that depend on other parameters. In a world where they are not, only that
    /// and the errors of all worlds are reported.
    pub(super) fn check_ranges(&mut self, site: usize, set: Vec<(String, (Span, Span))>) -> Lowered<()> {
        let Site { settings, elaborator, .. } = &mut self.sites[site];
        // Errors of these values are reported at each place where they are set.
        let was_astray = std::mem::replace(&mut elaborator.is_astray, false);
        let before = elaborator.diagnostics.len();
        let mut result = Ok(());
        for (name, at) in set {
            let Some(number) = settings.get(&name) else { continue };
            result = result.and(elaborator.in_range((&name, *number), at));
        }
        // Of a range that is wrong itself that is said where it is declared.
        let is_outside = elaborator.diagnostics.len() > before;
        if is_outside && !was_astray {
            let said = elaborator.diagnostics.split_off(before);
            elaborator.keep_sure(0);
            elaborator.diagnostics.extend(said);
        }
        elaborator.is_astray = was_astray || is_outside;
        result
    }
}
