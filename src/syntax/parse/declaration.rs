//! Parts that both languages have: functions, settings of parameters, and the moment of a value.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use crate::syntax::ast::{Binding, Expr, ExprKind, Ident, LetDecl, Moment};

impl Builder<'_> {
    /// `let f(a) = …`
    pub(super) fn let_decl(&mut self, pair: Pair<'_>) -> Option<LetDecl> {
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let arguments =
            parts.part(Rule::parameters).map(|parameters| self.parameters(parameters)).unwrap_or_default();
        Some(LetDecl { name, arguments, body: self.expr(parts.part(Rule::expr)?) })
    }

    pub(super) fn parameters(&mut self, pair: Pair<'_>) -> Vec<Ident> {
        Parts::of(pair).map(|parameter| self.ident(&parameter)).collect()
    }

    pub(super) fn binding(&mut self, pair: Pair<'_>) -> Option<Binding> {
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::ident)?);
        Some(Binding { name, value: self.expr(parts.part(Rule::tight)?) })
    }

    /// `… at end`, `… at 5 s`
    pub(super) fn read_at(&mut self, read: Expr, moment: Pair<'_>) -> Expr {
        let span = read.span.to(self.span(&moment));
        let moment = match moment.into_inner().find(|part| part.as_rule() == Rule::arith) {
            Some(time) => Moment::Time(Box::new(self.expr(time))),
            None => Moment::End,
        };
        Expr { kind: ExprKind::At(Box::new(read), moment), span }
    }
}
