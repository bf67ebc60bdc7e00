//! Scenes and shapes.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use crate::base::decimal::Decimal;
use crate::syntax::ast::{
    BinaryOp, Expr, ExprKind, Field, Ident, Quantity, SceneItem, ShapeExpr, Text, Value,
};

impl Builder<'_> {
    pub(super) fn scene(&mut self, pair: Pair<'_>) -> Vec<SceneItem> {
        let mut items = Vec::new();
        if let Some(block) = Parts::of(pair).part(Rule::block) {
            self.block(&block, Rule::line_of_scene, &mut |builder, part| {
                let item = builder.scene_item(part)?;
                let levels = levels_of(&item);
                items.push(item);
                items.extend(levels);
                Some(())
            });
        }
        items
    }

    fn scene_item(&mut self, pair: Pair<'_>) -> Option<SceneItem> {
        let pair = pair.into_inner().next()?;
        let span = self.span(&pair);
        let rule = pair.as_rule();
        let mut parts = Parts::of(pair);
        if rule == Rule::import {
            let path = self.quoted(&parts.part(Rule::text)?);
            let walkable = parts.part(Rule::walkable).is_some();
            let filter = parts.part(Rule::expr).map(|filter| self.expr(filter));
            let called = parts.part(Rule::called).and_then(|called| Parts::of(called).part(Rule::name));
            let called = called.map(|name| self.ident(&name));
            let is_by_level = parts.part(Rule::by_level).is_some();
            let fields = self.body(parts);
            let (levels, storey, fields) =
                if is_by_level { by_level(fields) } else { (Vec::new(), None, fields) };
            let import = SceneItem::Import { path, walkable, filter, called, fields, span };
            if !is_by_level {
                return Some(import);
            }
            return Some(SceneItem::Storeys { import: Box::new(import), levels, storey });
        }
        if rule == Rule::periodic {
            let axis = self.ident(&parts.part(Rule::name)?);
            let low = self.expr(parts.part(Rule::arith)?);
            return Some(SceneItem::Periodic {
                axis,
                ends: [low, self.expr(parts.part(Rule::arith)?)],
                span,
            });
        }
        let name = parts.part(Rule::name).map(|name| self.ident(&name));
        match rule {
            Rule::level => {
                let (name, before) = (name?, self.broken.len());
                let (items, fields) = self.level(parts);
                for lost in &mut self.broken[before..] {
                    let full = |own: &String| format!("{}.{own}", name.name);
                    lost.name = lost.name.as_ref().map(full);
                    lost.words.extend(lost.words.iter().map(full).collect::<Vec<_>>());
                }
                Some(SceneItem::Level { items: within(&name, items), name, fields })
            }
            Rule::stairs => {
                let a = self.expr(parts.part(Rule::place)?);
                let ends = [a, self.expr(parts.part(Rule::place)?)];
                Some(SceneItem::Stairs { name: name?, ends, fields: self.body(parts), span })
            }
            Rule::wall => {
                let points = parts.map(|point| self.expr(point)).collect();
                Some(SceneItem::Wall { name, points, span })
            }
            Rule::obstacle => {
                Some(SceneItem::Obstacle { name, shape: self.shape(parts.part(Rule::shape)?)? })
            }
            Rule::region => {
                let mut shapes: Vec<_> = parts.map(|shape| self.shape(shape)).collect::<Option<_>>()?;
                let shape = if shapes.len() == 1 { shapes.swap_remove(0) } else { ShapeExpr::Parts(shapes) };
                Some(SceneItem::Region { name: name?, shape })
            }
            Rule::line => {
                let a = self.expr(parts.part(Rule::place)?);
                Some(SceneItem::Line { name: name?, ends: [a, self.expr(parts.part(Rule::place)?)], span })
            }
            Rule::door => {
                let a = self.expr(parts.part(Rule::place)?);
                let ends = [a, self.expr(parts.part(Rule::place)?)];
                Some(SceneItem::Door { name: name?, ends, fields: self.body(parts), span })
            }
            _ => Some(SceneItem::Point { name: name?, at: self.expr(parts.part(Rule::place)?) }),
        }
    }

    /// The items and the fields of a level.
    fn level(&mut self, mut parts: Parts<'_>) -> (Vec<SceneItem>, Vec<Field>) {
        let (mut items, mut fields) = (Vec::new(), Vec::new());
        if let Some(block) = parts.part(Rule::block) {
            self.block(&block, Rule::line_of_level, &mut |builder, part| {
                let part = part.into_inner().next()?;
                match part.as_rule() {
                    Rule::field => fields.push(builder.field(part)?),
                    _ => items.push(builder.scene_item(part)?),
                }
                Some(())
            });
        }
        (items, fields)
    }

    pub(super) fn shape(&mut self, pair: Pair<'_>) -> Option<ShapeExpr> {
        let pair = pair.into_inner().next()?;
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::name => Some(ShapeExpr::Named(self.ident(&pair))),
            Rule::of_plan => Some(ShapeExpr::Of(self.expr(pair))),
            Rule::circle => {
                let mut parts = Parts::of(pair);
                let centre = self.expr(parts.part(Rule::place)?);
                Some(ShapeExpr::Circle { centre, radius: self.expr(parts.part(Rule::arith)?), span })
            }
            Rule::rect => {
                let mut parts = Parts::of(pair);
                let a = self.expr(parts.part(Rule::place)?);
                Some(ShapeExpr::Rectangle { a, b: self.expr(parts.part(Rule::place)?), span })
            }
            _ => {
                let mut outlines = Parts::of(pair).map(|outline| self.outline(outline));
                let outline = outlines.next()??;
                Some(ShapeExpr::Polygon { outline, holes: outlines.collect::<Option<_>>()?, span })
            }
        }
    }

    fn outline(&mut self, pair: Pair<'_>) -> Option<Vec<Expr>> {
        pair.into_inner().map(|corner| self.corner(corner)).collect()
    }
}

/// The items of a level under their full names.
fn within(level: &Ident, mut items: Vec<SceneItem>) -> Vec<SceneItem> {
    for item in &mut items {
        let name = match item {
            SceneItem::Wall { name, .. } | SceneItem::Obstacle { name, .. } => name.as_mut(),
            SceneItem::Import { called, .. } => called.as_mut(),
            SceneItem::Region { name, .. }
            | SceneItem::Point { name, .. }
            | SceneItem::Line { name, .. }
            | SceneItem::Door { name, .. } => Some(name),
            SceneItem::Level { .. }
            | SceneItem::Stairs { .. }
            | SceneItem::Periodic { .. }
            | SceneItem::Storeys { .. } => None,
        };
        if let Some(name) = name {
            name.name = format!("{}.{}", level.name, name.name);
        }
    }
    items
}

/// The levels among the fields of an import by level, the height of a storey, and the fields of each import.
fn by_level(written: Vec<Field>) -> (Vec<(Ident, Text)>, Option<Expr>, Vec<Field>) {
    let (mut levels, mut storey, mut fields) = (Vec::new(), None, Vec::new());
    for field in written {
        match (field.name.name.as_str(), &field.value) {
            ("storey", Value::Plain(expr)) if storey.is_none() => storey = Some(expr.clone()),
            ("snap" | "unit" | "origin" | "projection", _) => fields.push(field),
            (_, Value::Plain(Expr { kind: ExprKind::Text(text), span })) => {
                levels.push((field.name, Text { value: text.clone(), span: *span }));
            }
            _ => fields.push(field),
        }
    }
    (levels, storey, fields)
}

/// The levels that an import by level stands for: `level first { height = 1 * storey; import … where level == "1" }`.
fn levels_of(item: &SceneItem) -> Vec<SceneItem> {
    let SceneItem::Storeys { import, levels, storey } = item else { return Vec::new() };
    let level = |(k, (name, text)): (usize, &(Ident, Text))| {
        let at = |kind| Expr { kind, span: text.span };
        let both = |op, a, b| at(ExprKind::Binary(op, Box::new(a), Box::new(b)));
        let of = at(ExprKind::Name("level".into()));
        let mut own = both(BinaryOp::Equal, of, at(ExprKind::Text(text.value.clone())));
        let mut import = (**import).clone();
        if let SceneItem::Import { filter, .. } = &mut import {
            if let Some(written) = filter.take() {
                own = both(BinaryOp::And, written, own);
            }
            *filter = Some(own);
        }
        let height = storey.as_ref().map(|storey| {
            let number = Quantity { value: Decimal::whole(k as i64), unit: None };
            let number = Expr { kind: ExprKind::Quantity(number), span: storey.span };
            let product = ExprKind::Binary(BinaryOp::Times, Box::new(number), Box::new(storey.clone()));
            let value = Value::Plain(Expr { kind: product, span: storey.span });
            Field { name: Ident { name: "height".into(), span: storey.span }, value }
        });
        let items = within(name, vec![import]);
        SceneItem::Level { name: name.clone(), fields: height.into_iter().collect(), items }
    };
    levels.iter().enumerate().map(level).collect()
}
