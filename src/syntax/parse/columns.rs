//! The columns that signals of a program read.
//!
//! ```text
//! program sim {
//!   signal speed = column("v") * 1 m/s      process sim { var v: real = 0 }
//! }                                         let speed = sim.v * 1 m/s
//! ```
//!
//! They become variables of a process whose values come from the trace.

use crate::base::decimal::Decimal;
use crate::syntax::ast::{Domain, Expr, ExprKind, Ident, Quantity, Text, VarDecl};
use crate::syntax::source::Span;

/// The function that stands for a column of a trace.
const COLUMN: &str = "column";

/// The columns that signals read, each with its variable.
pub(super) struct Columns {
    pub(super) program: Ident,
    pub(super) read: Vec<(VarDecl, Text)>,
}

impl Columns {
    /// Puts variables in the place of columns.
    pub(super) fn replace(&mut self, expr: &mut Expr) {
        let span = expr.span;
        match &mut expr.kind {
            ExprKind::Call { function, arguments } => match arguments.as_slice() {
                [Expr { kind: ExprKind::Text(column), .. }] if function.name == COLUMN => {
                    let column = column.clone();
                    let variable = self.variable(column, span);
                    let program =
                        Expr { kind: ExprKind::Name(self.program.name.clone()), span: self.program.span };
                    expr.kind = ExprKind::Member(Box::new(program), variable);
                }
                _ => arguments.iter_mut().for_each(|argument| self.replace(argument)),
            },
            ExprKind::Unary(_, inner) => self.replace(inner),
            ExprKind::Binary(_, left, right) => {
                self.replace(left);
                self.replace(right);
            }
            _ => {}
        }
    }

    /// The variable of a column; a new one where it is read for the first time.
    fn variable(&mut self, column: String, span: Span) -> Ident {
        if let Some((variable, _)) = self.read.iter().find(|(_, known)| known.value == column) {
            return Ident { name: variable.name.name.clone(), span };
        }
        let mut name: String = column.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
        if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            name.insert(0, '_');
        }
        while self.read.iter().any(|(variable, _)| variable.name.name == name) {
            name.push('_');
        }
        let name = Ident { name, span };
        let zero = Quantity { value: Decimal::whole(0), unit: None };
        let real = Ident { name: "real".to_owned(), span };
        let variable = VarDecl {
            name: name.clone(),
            domain: Some(Domain::Named(real)),
            initial: Expr { kind: ExprKind::Quantity(zero), span },
        };
        self.read.push((variable, Text { value: column, span }));
        name
    }
}
