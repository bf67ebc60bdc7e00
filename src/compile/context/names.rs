//! The names of a world: what each stands for, and which were looked at in vain. A name is looked at once, and what is wrong
//! with it is said then; where that is taken back, the look has to be forgotten.

use crate::compile::context::{
    dependence::Meant,
    lowered::{Lowered, Reported},
    number::Number,
    symbols::{Scope, ScopeId},
    typed::Typed,
};
use crate::syntax::source::Span;
use std::collections::{BTreeMap, BTreeSet};

/// Names, and what is known of them.
#[derive(Default)]
pub(crate) struct Names<'a> {
    /// Tables of names.
    pub(crate) scopes: Vec<Scope<'a>>,
    /// Values of parameters that are set.
    pub(crate) settings: BTreeMap<String, Number>,
    /// Values of constants and parameters so far.
    pub(crate) constants: BTreeMap<(ScopeId, String), Lowered<Typed>>,
    /// Names whose expansion is under way.
    pub(crate) expanding: Vec<(ScopeId, String)>,
    /// How often an unknown name was come upon.
    pub(crate) unknowns: u64,
    /// Whether the body of a function is looked at, whatever it is called with.
    pub(crate) looking: bool,
    /// Functions that were followed from there.
    pub(crate) followed: BTreeSet<(ScopeId, String)>,
    /// Names in circles that were reported.
    pub(crate) circles: Vec<String>,
    /// Names that were expanded in vain: what is wrong with them was said.
    pub(crate) broken: BTreeSet<(ScopeId, String)>,
    /// Names with an ambiguous or unknown meaning.
    pub(crate) doubtful: BTreeSet<(ScopeId, String)>,
    /// The expressions that failed, in order.
    pub(crate) journal: Vec<(Vain, (ScopeId, String))>,
    /// Where names are used, and what they stand for there.
    pub(crate) uses: BTreeMap<Span, Meant>,
    /// The parameters that choose a preset.
    pub(crate) chosen_by: Vec<String>,
    /// Where the name of a bare number stands, and where that is declared.
    pub(crate) bare: BTreeMap<Span, Span>,
}

/// As what a name was looked at in vain.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Vain {
    /// Its value is kept as an error.
    Constant,
    /// Nothing comes of it any more.
    Name,
    /// A function that was followed.
    Call,
}

/// How many names were looked at in vain up to some moment.
pub(crate) struct Failures {
    journal: usize,
    circles: usize,
}

/// The expressions that failed since then.
pub(crate) struct Forgotten {
    journal: Vec<(Vain, (ScopeId, String))>,
    circles: Vec<String>,
}

impl Names<'_> {
    /// Where the present looks in vain end.
    pub(crate) fn failures(&self) -> Failures {
        Failures { journal: self.journal.len(), circles: self.circles.len() }
    }

    /// Forgets what was looked at in vain since, where what was said of that is taken back: it would not be said again.
    pub(crate) fn forget_failures(&mut self, since: &Failures) -> Forgotten {
        let journal = self.journal.split_off(since.journal);
        for (vain, key) in &journal {
            match vain {
                Vain::Constant => drop(self.constants.remove(key)),
                Vain::Name => drop(self.broken.remove(key)),
                Vain::Call => drop(self.followed.remove(key)),
            }
        }
        Forgotten { journal, circles: self.circles.split_off(since.circles) }
    }

    /// The same, but for circles: these are so whatever is set, and what was said of them is kept.
    pub(crate) fn forget_but_circles(&mut self, since: &Failures) {
        let forgotten = self.forget_failures(since);
        self.circles.extend(forgotten.circles);
    }

    /// Remembers what was forgotten, where what was said of that is said after all.
    pub(crate) fn recall(&mut self, forgotten: Forgotten) {
        for (vain, key) in &forgotten.journal {
            match vain {
                Vain::Constant => drop(self.constants.insert(key.clone(), Err(Reported))),
                Vain::Name => drop(self.broken.insert(key.clone())),
                Vain::Call => drop(self.followed.insert(key.clone())),
            }
        }
        self.journal.extend(forgotten.journal);
        self.circles.extend(forgotten.circles);
    }

    /// Whether the meaning of a name is uncertain.
    pub(crate) fn is_doubtful(&self, scope: ScopeId, name: &str) -> bool {
        !self.doubtful.is_empty() && self.doubtful.contains(&(scope, name.to_owned()))
    }

    /// Nothing comes of a name any more: what is wrong with it was said.
    pub(crate) fn give_up(&mut self, scope: ScopeId, name: String) {
        let key = (scope, name);
        // What was not read to its end stays so.
        if self.broken.insert(key.clone()) {
            self.journal.push((Vain::Name, key));
        }
    }
}
