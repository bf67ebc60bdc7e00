//! Names are looked up, and expanded to what they stand for.

use crate::compile::context::{
    Context, Lowered, Reported,
    names::Vain,
    symbols::{Meaning, ScopeId},
    typed::Typed,
};
use crate::compile::lower::weight::{self, Weight};
use crate::syntax::ast::Expr;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;

impl<'a> Context<'a> {
    /// Finds a name: in the file's own table, then in the scenario's.
    pub(crate) fn look_up(&self, name: &str, scope: ScopeId) -> Option<(ScopeId, Meaning<'a>)> {
        let own = self
            .names
            .scopes
            .get(scope)
            .and_then(|table| table.get(name))
            .map(|e| (scope, e.meaning.clone()));
        let found = own.or_else(|| self.names.scopes[0].get(name).map(|e| (0, e.meaning.clone())));
        found.map(|(scope, meaning)| {
            (scope, if self.names.is_doubtful(scope, name) { Meaning::Doubtful } else { meaning })
        })
    }

    /// The value of a constant, computed once.
    pub(crate) fn constant(
        &mut self,
        scope: ScopeId,
        name: &str,
        span: Span,
        compute: impl FnOnce(&mut Self) -> Lowered<Typed>,
    ) -> Lowered<Typed> {
        let key = (scope, name.to_owned());
        // A condition has a margin at each place where it is asked for.
        let asks = self.margins.is_some();
        let has_margin = |known: &Lowered<Typed>| asks && matches!(known, Ok(Typed::Truth(..)));
        if let Some(known) = self.names.constants.get(&key).filter(|known| !has_margin(known)) {
            let weight = known.as_ref().map(Weight::of).map_err(|reported| *reported)?;
            weight::count_copy(self, weight, span)?;
            return self.names.constants.get(&key).cloned().unwrap_or(Err(Reported));
        }
        let value = self.expand(scope, name, span, compute);
        if value.is_err() {
            self.names.journal.push((Vain::Constant, key.clone()));
        }
        // Who is among people is not settled before all are.
        if !matches!(value, Ok(Typed::Agents { .. })) && !has_margin(&value) {
            self.names.constants.insert(key, value.clone());
        }
        value
    }

    /// The value of a constant, if it is the same in all states of all trials.
    pub(crate) fn unchanging(&mut self, lowered: Lowered<Typed>, value: &Expr) -> Lowered<Typed> {
        let found = lowered?;
        let (is_fixed, is_drawn) = match &found {
            Typed::Num(num, _) => (num.is_fixed(), num.is_drawn()),
            Typed::Vector(x, y, _) => (x.is_fixed() && y.is_fixed(), x.is_drawn() && y.is_drawn()),
            Typed::Truth(truth, _) => (truth.is_fixed(), truth.is_drawn()),
            Typed::Term(..) | Typed::Formula(_) | Typed::Tally(_) => (false, false),
            _ => (true, true),
        };
        if is_fixed {
            return Ok(found);
        }
        let label = match found {
            _ if is_drawn => format!("{} that is drawn in each trial", found.noun()),
            Typed::Truth(..) => "a condition that changes during a trial".to_owned(),
            _ => format!("{} that changes during a trial", found.noun()),
        };
        let error = error!(E0304, value.span, "the value must be known before a trial starts");
        self.report(error.label(label).hint(if is_drawn {
            "name a value that is drawn in each trial with `let`"
        } else {
            "name a value that changes during a trial with `let`"
        }))
    }

    /// Computes what a name stands for; an error where that needs the name itself.
    pub(crate) fn expand(
        &mut self,
        scope: ScopeId,
        name: &str,
        span: Span,
        compute: impl FnOnce(&mut Self) -> Lowered<Typed>,
    ) -> Lowered<Typed> {
        if self.names.broken.contains(&(scope, name.to_owned())) {
            self.names.unknowns += 1;
            return Err(Reported);
        }
        if self.names.expanding.iter().any(|(s, n)| *s == scope && n == name) {
            if self.names.circles.iter().any(|n| n == name) {
                return Err(Reported);
            }
            let way: Vec<&str> = self
                .names
                .expanding
                .iter()
                .map(|(_, n)| n.as_str())
                .skip_while(|n| *n != name)
                .chain([name])
                .collect();
            self.names.circles.extend(way.iter().map(|n| (*n).to_owned()));
            let error = error!(E0205, span, "`{name}` depends on itself").label(way.join(" → "));
            let error = error.about(About::Circle);
            return self.report(error);
        }
        self.names.expanding.push((scope, name.to_owned()));
        let value = compute(self);
        self.names.expanding.pop();
        value
    }

    /// As `expand`, for what means the same at each use: what failed once is not looked at again.
    pub(crate) fn expand_once(
        &mut self,
        scope: ScopeId,
        name: &str,
        span: Span,
        compute: impl FnOnce(&mut Self) -> Lowered<Typed>,
    ) -> Lowered<Typed> {
        let value = self.expand(scope, name, span, compute);
        if value.is_err() {
            self.names.give_up(scope, name.to_owned());
        }
        value
    }
}
