//! Conditions as they were written, down to their smallest parts, and where scenarios and behaviours were.

use crate::model::{Bool, Set, Who};
use crate::syntax::source::Span;
use std::ops::Range;
use std::sync::Arc;

/// Where what can go wrong while a trial runs is written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origins {
    /// The commands of each process, copies of an array one by one.
    pub commands: Vec<Vec<Span>>,
    /// The variables of all processes.
    pub variables: Vec<Span>,
    /// The behaviours, in the order of their declaration.
    pub behaviours: Vec<Span>,
    /// The imports that gave barriers: the numbers of these, and the file name.
    pub imports: Vec<(Range<usize>, Span)>,
    /// The program that stands for the model.
    pub program: Option<Span>,
}

/// A condition of one state as it was written. Few are ever shown, so the text is made only on request.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Where it is written.
    pub(crate) place: Span,
    /// What names stand for there.
    pub(crate) frame: Option<Arc<Frame>>,
    /// Its text, if it was generated.
    pub(crate) said: Option<Box<str>>,
    /// What it is made of.
    pub form: Form,
}

/// What a condition of one state is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Nothing that is a condition.
    Plain(Bool),
    /// A name or a call stands for another.
    Named(Arc<Part>),
    /// Not.
    Not(Arc<Part>),
    /// All of them.
    All(Vec<Arc<Part>>),
    /// Any of them.
    Any(Vec<Arc<Part>>),
    /// Both or neither.
    Both(Arc<Part>, Arc<Part>),
    /// It is true of each of a set, who is the running one in it.
    Each(Set, Arc<Part>),
    /// It is true of someone of a set.
    Someone(Set, Arc<Part>),
}

impl Part {
    /// The condition itself.
    pub fn truth(&self) -> Bool {
        let all = |list: &[Arc<Self>]| list.iter().map(|one| one.truth()).collect();
        match &self.form {
            Form::Plain(truth) => truth.clone(),
            Form::Named(inner) => inner.truth(),
            Form::Not(inner) => Bool::Not(Box::new(inner.truth())),
            Form::All(list) => Bool::And(all(list)),
            Form::Any(list) => Bool::Or(all(list)),
            Form::Both(a, b) => Bool::Iff(Box::new(a.truth()), Box::new(b.truth())),
            Form::Each(set, body) => Bool::Forall(set.clone(), Box::new(body.truth())),
            Form::Someone(set, body) => Bool::Exists(set.clone(), Box::new(body.truth())),
        }
    }

    /// Whether it has no parts of which one or the other may decide.
    pub fn is_plain(&self) -> bool {
        match &self.form {
            Form::Plain(_) => true,
            Form::Not(inner) | Form::Each(_, inner) | Form::Someone(_, inner) => inner.is_plain(),
            _ => false,
        }
    }
}

/// What the names that are bound around a place stand for.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Frame {
    /// Around the call that leads here.
    pub(crate) caller: Option<Arc<Frame>>,
    /// Names by their places among those that are bound.
    pub(crate) given: Vec<(u32, Given)>,
    /// The process whose names are seen.
    pub(crate) process: Option<Arc<str>>,
}

/// What a bound name stands for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Given {
    /// What is written there, around the call.
    Written(Span),
    /// A copy of a process.
    Copy(Arc<str>),
    /// An agent.
    Person(Who),
}

impl Frame {
    /// What is seen inside a process.
    pub(crate) fn inside(process: Arc<str>) -> Self {
        Self { process: Some(process), ..Self::default() }
    }

    pub(crate) fn given(&self, at: u32) -> Option<&Given> {
        self.given.iter().rev().find(|(known, _)| *known == at).map(|(_, given)| given)
    }
}
