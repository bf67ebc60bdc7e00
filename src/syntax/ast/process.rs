//! Processes, behaviours and sources: chance that is not a parameter.

use super::{Expr, Field, Ident, LetDecl, Text, Value};
use crate::syntax::source::Span;

/// `process queue { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct ProcessDecl {
    /// Its name.
    pub name: Ident,
    /// `[n]`: so many copies, counted from 1.
    pub count: Option<Expr>,
    /// Variables, names and commands in order of writing.
    pub items: Vec<ProcessItem>,
    /// The whole declaration.
    pub span: Span,
}

/// One line of a process.
#[derive(Clone, Debug, PartialEq)]
pub enum ProcessItem {
    /// `var n: 0 .. 5 = 0`
    Var(VarDecl),
    /// `let busy = n > 0`
    Let(LetDecl),
    /// `label full = n == 5`
    Label {
        /// Its name.
        name: Ident,
        /// A Boolean value.
        value: Expr,
    },
    /// `when n < 5 at lambda -> n = n + 1`
    Command(Command),
    /// `choose`: where several commands are enabled, each is as likely as the others.
    Choose(Span),
}

/// `var s: 0 .. 7 = 0`
#[derive(Clone, Debug, PartialEq)]
pub struct VarDecl {
    /// Its name.
    pub name: Ident,
    /// Its domain. `None`: a number or a truth value, like its initial value.
    pub domain: Option<Domain>,
    /// Its value at the start.
    pub initial: Expr,
}

/// The domain of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Domain {
    /// `0 .. 7`: whole numbers, ends included.
    Range(Expr, Expr),
    /// `bool`, `real`, `int`, or a name that compilation will refuse.
    Named(Ident),
}

/// `when guard at rate -> weight: updates | weight: updates`
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// When it may fire.
    pub guard: Expr,
    /// How long it waits. `None`: it fires at the next step.
    pub timing: Option<Timing>,
    /// The branches; several need weights.
    pub branches: Vec<Branch>,
    /// The whole command.
    pub span: Span,
}

/// How long a command or transition waits.
#[derive(Clone, Debug, PartialEq)]
pub enum Timing {
    /// `at 2 /s`: an exponential time with this rate.
    Rate(Expr),
    /// `after uniform(1 s, 2 s)`: a plain or truncated value.
    Delay(Box<Value>),
}

/// `1/2: { s = 7; d = 1 }`
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its weight, if written.
    pub weight: Option<Expr>,
    /// The updates, applied together; empty for `{ }`.
    pub updates: Vec<Update>,
    /// Where.
    pub span: Span,
}

/// `s = 1`
#[derive(Clone, Debug, PartialEq)]
pub struct Update {
    /// The variable.
    pub target: Ident,
    /// Its new value, over the old state.
    pub value: Expr,
}

/// `program sim { … }`: a program that runs elsewhere and writes its trace.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramDecl {
    /// The variables of its trace, as those of a process of its name: one for each column that a signal reads.
    pub process: ProcessDecl,
    /// The columns of these variables.
    pub columns: Vec<Text>,
    /// `signal speed = column("v") * 1 m/s`
    pub signals: Vec<LetDecl>,
    /// The people whom it shows.
    pub people: Option<ShownDecl>,
    /// How it is run and read.
    pub body: Vec<Field>,
}

/// `agents people[40] = columns("id", "x", "y")`
#[derive(Clone, Debug, PartialEq)]
pub struct ShownDecl {
    /// Name of the set.
    pub name: Ident,
    /// `[n]`: at most so many in a trial.
    pub count: Option<Expr>,
    /// Their columns.
    pub columns: Expr,
}

/// `behaviour heedful(p) { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct BehaviourDecl {
    /// Its name.
    pub name: Ident,
    /// Names of its arguments.
    pub arguments: Vec<Ident>,
    /// States, events and names in order of writing; the first state is the one at the start.
    pub items: Vec<BehaviourItem>,
    /// The whole declaration.
    pub span: Span,
}

/// One line of a behaviour.
#[derive(Clone, Debug, PartialEq)]
pub enum BehaviourItem {
    /// `state looking { … }`
    State(StateDecl),
    /// `on advice { choose { p: follow | 1 - p: ignore } }`
    On(OnDecl),
    /// `let slow = 0.5`
    Let(LetDecl),
}

/// `state looking { speed = 0.5 * speed; after uniform(2 s, 5 s) -> attentive }`
#[derive(Clone, Debug, PartialEq)]
pub struct StateDecl {
    /// Its name.
    pub name: Ident,
    /// The fields that it sets while it lasts.
    pub fields: Vec<Field>,
    /// How it ends.
    pub transitions: Vec<Transition>,
    /// The whole declaration.
    pub span: Span,
}

/// `after uniform(2 s, 5 s) -> attentive` or `when contact(self) -> alarmed`
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// `when …`
    pub guard: Option<Expr>,
    /// `after …`
    pub after: Option<Box<Value>>,
    /// The target states; several need weights.
    pub targets: Vec<Choice>,
    /// The whole transition.
    pub span: Span,
}

/// `on advice { choose { p: follow | 1 - p: ignore } }`
#[derive(Clone, Debug, PartialEq)]
pub struct OnDecl {
    /// The event.
    pub event: Ident,
    /// The answers; several need weights.
    pub choices: Vec<Choice>,
    /// The whole declaration.
    pub span: Span,
}

/// `p: follow`
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Its weight, if written.
    pub weight: Option<Expr>,
    /// A state or reaction.
    pub target: Ident,
}

/// `source doors: adult with phone { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct SourceDecl {
    /// Its name, also of the set of those who came.
    pub name: Ident,
    /// Their kind.
    pub kind: Ident,
    /// Behaviours attached by `with`: calls or names.
    pub with: Vec<Expr>,
    /// `at`, `every`, `limit`, `route`, and kinds' fields.
    pub body: Vec<Field>,
    /// The whole declaration.
    pub span: Span,
}

impl BehaviourDecl {
    /// Where its conditions, delays, weights, fields and names are written, each as a whole.
    pub fn values(&self) -> Vec<Span> {
        let weights = |choices: &[Choice]| -> Vec<Span> {
            choices.iter().filter_map(|choice| choice.weight.as_ref()).map(|weight| weight.span).collect()
        };
        let mut found = Vec::new();
        for item in &self.items {
            match item {
                BehaviourItem::State(state) => {
                    found.extend(state.fields.iter().map(|field| field.value.span()));
                    for transition in &state.transitions {
                        found.extend(transition.guard.as_ref().map(|guard| guard.span));
                        found.extend(transition.after.as_ref().map(|after| after.span()));
                        found.extend(weights(&transition.targets));
                    }
                }
                BehaviourItem::On(on) => found.extend(weights(&on.choices)),
                BehaviourItem::Let(decl) => found.push(decl.body.span),
            }
        }
        found
    }
}
