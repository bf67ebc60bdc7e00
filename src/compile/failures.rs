//! What was looked at in vain. A name is looked at once, and what is wrong with it is said then; where that is taken back,
//! the look has to be forgotten.

use super::elaborator::{Elaborator, Reported};
use super::symbols::ScopeId;

/// As what a name was looked at in vain.
#[derive(Clone, Copy, Debug)]
pub(super) enum Vain {
    /// Its value is kept as an error.
    Constant,
    /// Nothing comes of it any more.
    Name,
    /// A function that was followed.
    Call,
}

/// How many names were looked at in vain up to some moment.
pub(super) struct Failures {
    journal: usize,
    circles: usize,
}

/// The expressions that failed since then.
pub(super) struct Forgotten {
    journal: Vec<(Vain, (ScopeId, String))>,
    circles: Vec<String>,
}

impl Elaborator<'_> {
    /// Where the present looks in vain end.
    pub(super) fn failures(&self) -> Failures {
        Failures { journal: self.journal.len(), circles: self.circles.len() }
    }

    /// Forgets what was looked at in vain since, where what was said of that is taken back: it would not be said again.
    pub(super) fn forget_failures(&mut self, since: &Failures) -> Forgotten {
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
    pub(super) fn forget_but_circles(&mut self, since: &Failures) {
        let forgotten = self.forget_failures(since);
        self.circles.extend(forgotten.circles);
    }

    /// Remembers what was forgotten, where what was said of that is said after all.
    pub(super) fn recall(&mut self, forgotten: Forgotten) {
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

    /// Nothing comes of a name any more: what is wrong with it was said.
    pub(super) fn give_up(&mut self, scope: ScopeId, name: String) {
        let key = (scope, name);
        // What was not read to its end stays so.
        if self.broken.insert(key.clone()) {
            self.journal.push((Vain::Name, key));
        }
    }
}
