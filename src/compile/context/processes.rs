//! Processes as they are declared: variables and names, as far as they are settled.

use crate::compile::dimension::Dimension;
use crate::model::{Domain, VariableId};
use crate::syntax::ast::process::{ProcessDecl, ProcessItem};
use crate::syntax::ast::{Expr, Ident, LetDecl};
use std::collections::BTreeMap;
use std::ops::Range;

/// A name inside a process.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Inside<'a> {
    /// Its n-th variable.
    Variable(usize),
    /// A variable that is not settled yet.
    Early,
    /// A named expression or function.
    Let(&'a LetDecl),
    /// A named condition.
    Label(&'a Expr),
    /// A variable whose declaration is wrong, which was reported.
    Lost,
}

impl<'a> Inside<'a> {
    /// The name that an item declares, if it does; what its variable is is given.
    pub(crate) fn of(item: &'a ProcessItem, variable: Self) -> Option<(&'a Ident, Self)> {
        match item {
            ProcessItem::Var(var) => Some((&var.name, variable)),
            ProcessItem::Let(decl) => Some((&decl.name, Self::Let(decl))),
            ProcessItem::Label { name, value } => Some((name, Self::Label(value))),
            ProcessItem::Command(_) | ProcessItem::Choose(_) => None,
        }
    }
}

/// A process under elaboration.
pub(crate) struct Declared<'a> {
    pub(crate) decl: &'a ProcessDecl,
    /// Whether a program elsewhere tells its variables.
    pub(crate) is_played: bool,
    /// Number of copies, of an array.
    pub(crate) copies: Option<u32>,
    /// Whether that number is not known yet, or has an error.
    pub(crate) uncounted: bool,
    /// Whether its variables have errors, so their values are unknown.
    pub(crate) is_unknown: bool,
    /// First variable of the first copy.
    pub(crate) first: u32,
    /// Dimension and domain of each variable of a copy.
    pub(crate) variables: Vec<(Dimension, Domain)>,
    pub(crate) names: BTreeMap<&'a str, Inside<'a>>,
}

impl<'a> Declared<'a> {
    pub(crate) fn new(decl: &'a ProcessDecl) -> Self {
        let mut names = BTreeMap::new();
        for (name, inside) in decl.items.iter().filter_map(|item| Inside::of(item, Inside::Early)) {
            names.entry(name.name.as_str()).or_insert(inside);
        }
        Self {
            decl,
            is_played: false,
            copies: None,
            uncounted: decl.count.is_some(),
            is_unknown: false,
            first: 0,
            variables: Vec::new(),
            names,
        }
    }

    /// Whether it is an array, of however many copies.
    pub(crate) fn is_array(&self) -> bool {
        self.decl.count.is_some()
    }

    /// The name of a copy, or of the process if there is only one.
    pub(crate) fn copy_name(&self, copy: u32) -> String {
        match self.copies {
            Some(_) => format!("{}[{}]", self.decl.name.name, copy + 1),
            None => self.decl.name.name.clone(),
        }
    }

    /// The values that a variable can have, if it is one of this process.
    pub(crate) fn domain(&self, variable: VariableId) -> Option<Domain> {
        let at = variable.0.checked_sub(self.first)? as usize;
        let count = self.variables.len();
        let is_own = at < count * self.copies.unwrap_or(1) as usize;
        is_own.then(|| self.variables[at % count].1)
    }

    /// The variables of a copy.
    pub(crate) fn of_copy(&self, copy: u32) -> Range<usize> {
        let (first, count) = (self.first as usize, self.variables.len());
        let start = first + copy as usize * count;
        start..start + count
    }

    pub(crate) fn variable(&self, copy: u32, place: usize) -> VariableId {
        VariableId(self.first + copy * self.variables.len() as u32 + place as u32)
    }

    /// The name of a variable, if it is one of real numbers of this process.
    pub(crate) fn real(&self, id: VariableId) -> Option<&'a str> {
        // What a program has written as a whole number is one.
        if self.is_played {
            return None;
        }
        let at = id.0.checked_sub(self.first)? as usize;
        if at >= self.variables.len() * self.copies.unwrap_or(1) as usize {
            return None;
        }
        let place = at % self.variables.len();
        let is_it = |inside: &Inside| matches!(inside, Inside::Variable(k) if *k == place);
        let (name, _) = self.names.iter().find(|(_, inside)| is_it(inside))?;
        (self.variables[place].1 == Domain::Real).then_some(*name)
    }
}
