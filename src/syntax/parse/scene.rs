//! Scenes and shapes.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use crate::syntax::ast::{Expr, Field, Ident, SceneItem, ShapeExpr};

impl Builder<'_> {
    pub(super) fn scene(&mut self, pair: Pair<'_>) -> Vec<SceneItem> {
        match Parts::of(pair).part(Rule::block) {
            Some(block) => self.block(&block, Rule::line_of_scene, &mut Self::scene_item),
            None => Vec::new(),
        }
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
            return Some(SceneItem::Import {
                path,
                walkable,
                filter,
                called,
                fields: self.body(parts),
                span,
            });
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
            SceneItem::Level { .. } | SceneItem::Stairs { .. } | SceneItem::Periodic { .. } => None,
        };
        if let Some(name) = name {
            name.name = format!("{}.{}", level.name, name.name);
        }
    }
    items
}
