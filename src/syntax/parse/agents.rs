//! Kinds, agents, groups, sources, and the values of their fields.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use crate::syntax::ast::{
    AgentsDecl, Expr, Field, GroupDecl, Ident, KindDecl, Leg, Recorded, Route, SourceDecl, Value, Whom,
};

impl Builder<'_> {
    pub(super) fn kind(&mut self, pair: Pair<'_>) -> Option<KindDecl> {
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let base = parts.part(Rule::name).map(|base| self.ident(&base));
        let preset = match parts.part(Rule::preset) {
            Some(preset) => Some(self.ident(&Parts::of(preset).part(Rule::name)?)),
            None => None,
        };
        Some(KindDecl { name, base, preset, is_replaced: false, body: self.body(parts) })
    }

    pub(super) fn agents(&mut self, pair: Pair<'_>) -> Option<AgentsDecl> {
        let plural = pair.clone().into_inner().next()?.as_rule() == Rule::kw_agents;
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let count = self.size(&mut parts);
        let kind = self.ident(&parts.part(Rule::name)?);
        let (with, recorded) = self.attachments(&mut parts)?;
        Some(AgentsDecl { plural, name, count, kind, with, recorded, body: self.body(parts) })
    }

    pub(super) fn group(&mut self, pair: Pair<'_>) -> Option<GroupDecl> {
        let plural = pair.clone().into_inner().next()?.as_rule() == Rule::kw_groups;
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let count = self.size(&mut parts);
        let kind = self.ident(&parts.part(Rule::name)?);
        let particle = parts.part(Rule::particle).map(|particle| self.span(&particle));
        let (with, recorded) = self.attachments(&mut parts)?;
        Some(GroupDecl { plural, name, count, kind, particle, with, recorded, body: self.body(parts) })
    }

    /// `from …` and `with …`, in either order.
    fn attachments(&mut self, parts: &mut Parts<'_>) -> Option<(Vec<Expr>, Option<Recorded>)> {
        let (mut with, mut recorded) = (Vec::new(), None);
        loop {
            if let Some(clause) = parts.part(Rule::with) {
                with = self.with(clause)?;
            } else if let Some(clause) = parts.part(Rule::recorded) {
                recorded = Some(self.recorded(clause)?);
            } else {
                return Some((with, recorded));
            }
        }
    }

    pub(super) fn source_decl(&mut self, pair: Pair<'_>) -> Option<SourceDecl> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let kind = self.ident(&parts.part(Rule::name)?);
        let with = match parts.part(Rule::with) {
            Some(clause) => self.with(clause)?,
            None => Vec::new(),
        };
        Some(SourceDecl { name, kind, with, body: self.body(parts), span })
    }

    /// `[k]` behind a name.
    pub(super) fn member(&mut self, parts: &mut Parts<'_>) -> Option<Expr> {
        let member = parts.part(Rule::index)?;
        Some(self.expr(Parts::of(member).part(Rule::expr)?))
    }

    /// `[n]`
    pub(super) fn size(&mut self, parts: &mut Parts<'_>) -> Option<Expr> {
        let size = parts.part(Rule::size)?;
        Some(self.expr(Parts::of(size).part(Rule::expr)?))
    }

    fn with(&mut self, pair: Pair<'_>) -> Option<Vec<Expr>> {
        Parts::of(pair).map(|attached| self.attached(attached)).collect()
    }

    fn recorded(&mut self, pair: Pair<'_>) -> Option<Recorded> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let tracks = self.ident(&parts.part(Rule::name)?);
        let at = self.expr(parts.part(Rule::arith)?);
        let mut ids = |pair: Option<Pair<'_>>| match pair {
            Some(pair) => Parts::of(pair).map(|whom| self.whom(whom)).collect::<Option<Vec<_>>>(),
            None => Some(Vec::new()),
        };
        let only = ids(parts.part(Rule::only))?;
        let except = ids(parts.part(Rule::except))?;
        Some(Recorded { tracks, at, only, except, span })
    }

    fn whom(&mut self, pair: Pair<'_>) -> Option<Whom> {
        let is_group = pair.as_rule() == Rule::group_of;
        let id = if is_group { Parts::of(pair).part(Rule::arith)? } else { pair };
        Some(Whom { id: self.expr(id), is_group })
    }

    pub(super) fn body(&mut self, mut parts: Parts<'_>) -> Vec<Field> {
        let Some(block) = parts.part(Rule::block) else { return Vec::new() };
        self.block(&block, Rule::line_of_fields, &mut Self::field)
    }

    pub(super) fn field(&mut self, pair: Pair<'_>) -> Option<Field> {
        let mut parts = Parts::of(pair);
        let name = match parts.part(Rule::limited) {
            Some(limited) => {
                let span = self.span(&limited);
                let of = self.ident(&Parts::of(limited).part(Rule::ident)?);
                Ident { name: format!("limit {}", of.name), span }
            }
            None => self.ident(&parts.part(Rule::ident)?),
        };
        let value = match parts.rule()? {
            Rule::sided => self.sided(parts.part(Rule::sided)?),
            Rule::arguments => self.value(parts.part(Rule::arguments)?),
            _ => self.value(parts.part(Rule::value)?.into_inner().next()?),
        };
        Some(Field { name, value: value? })
    }

    /// `0.8 m/s^2 along, 1.6 m/s^2 across`
    fn sided(&mut self, pair: Pair<'_>) -> Option<Value> {
        let mut parts = Parts::of(pair);
        let along = self.side(parts.part(Rule::side)?)?;
        let across = self.side(parts.part(Rule::side)?)?;
        Some(Value::Sided { along: Box::new(along), across: Box::new(across) })
    }

    /// One of the two: a value, or a distribution that is truncated.
    fn side(&mut self, pair: Pair<'_>) -> Option<Value> {
        let mut parts = Parts::of(pair);
        let law = self.expr(parts.part(Rule::side_arith)?);
        let Some(low) = parts.part(Rule::side_arith) else { return Some(Value::Plain(law)) };
        let low = self.expr(low);
        Some(Value::Truncated { law, low, high: self.expr(parts.part(Rule::side_arith)?) })
    }

    /// The value of a field, a wait or a delay.
    pub(super) fn value(&mut self, pair: Pair<'_>) -> Option<Value> {
        match pair.as_rule() {
            Rule::uniform_in => Some(Value::UniformIn(self.shape(Parts::of(pair).part(Rule::shape)?)?)),
            Rule::near => {
                let mut parts = Parts::of(pair);
                let agent = self.expr(parts.part(Rule::operand_of)?);
                Some(Value::Near { agent, within: self.expr(parts.part(Rule::arith)?) })
            }
            Rule::route => self.route(pair).map(Value::Route),
            Rule::truncated => {
                let (law, low, high) = self.truncated(pair)?;
                Some(Value::Truncated { law, low, high })
            }
            Rule::arguments => {
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::name)?);
                let arguments = parts.map(|binding| self.binding(binding)).collect::<Option<_>>()?;
                Some(Value::Arguments { name, arguments })
            }
            Rule::learned => {
                let span = self.span(&pair);
                let as_published = pair.as_str().starts_with("as_published");
                let file = self.quoted(&Parts::of(pair).part(Rule::text)?);
                Some(Value::Learned { file, as_published, span })
            }
            Rule::force => {
                let mut parts = Parts::of(pair);
                let kind = self.ident(&parts.part(Rule::name)?);
                let preset = self.ident(&Parts::of(parts.part(Rule::preset)?).part(Rule::name)?);
                Some(Value::Force { kind, preset })
            }
            _ => Some(Value::Plain(self.expr(pair))),
        }
    }

    /// `law in low .. high`
    pub(super) fn truncated(&mut self, pair: Pair<'_>) -> Option<(Expr, Expr, Expr)> {
        let mut parts = Parts::of(pair);
        let law = self.expr(parts.part(Rule::arith)?);
        let low = self.expr(parts.part(Rule::arith)?);
        Some((law, low, self.expr(parts.part(Rule::arith)?)))
    }

    fn route(&mut self, pair: Pair<'_>) -> Option<Route> {
        let mut route = Route { legs: Vec::new(), then_leave: None };
        for part in Parts::of(pair) {
            if part.as_rule() == Rule::then_leave {
                route.then_leave = Some(self.span(&part));
                continue;
            }
            route.legs.push(self.leg(part.into_inner().next()?)?);
        }
        Some(route)
    }

    /// `exit`, `wait 5 s`
    pub(super) fn leg(&mut self, leg: Pair<'_>) -> Option<Leg> {
        Some(if leg.as_rule() == Rule::wait {
            Leg::Wait(Box::new(self.value(Parts::of(leg).next()?)?))
        } else {
            Leg::Goal(self.expr(leg))
        })
    }
}
