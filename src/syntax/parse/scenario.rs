//! Scenario files and what both languages declare alike.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use crate::syntax::ast::{
    Expr, ExprKind, Item, MoveOption, MovesDecl, PathsDecl, Route, ScenarioFile, Value,
};

impl Builder<'_> {
    pub(super) fn scenario_file(&mut self) -> ScenarioFile {
        let layout = self.layout;
        let items = self.items(&layout.items, Rule::line_of_scenario, &mut Self::item);
        ScenarioFile { items, broken: std::mem::take(&mut self.broken), ..ScenarioFile::default() }
    }

    fn item(&mut self, pair: Pair<'_>) -> Option<Item> {
        let pair = pair.into_inner().next()?;
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::title => Some(Item::Title(self.quoted(&Parts::of(pair).part(Rule::text)?))),
            Rule::setting => {
                if let Some(slip) = self.slip_of_name() {
                    self.say(slip);
                    return None;
                }
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::ident)?);
                Some(Item::Setting { name, value: self.expr(parts.part(Rule::expr)?) })
            }
            Rule::const_decl => {
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::name)?);
                Some(Item::Const { name, value: self.expr(parts.part(Rule::expr)?) })
            }
            Rule::param => {
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::name)?);
                if let Some(value) = parts.part(Rule::expr) {
                    return Some(Item::Param {
                        name,
                        value: self.expr(value),
                        range: None,
                        choices: Vec::new(),
                    });
                }
                if let Some(choice) = parts.part(Rule::one_of) {
                    let mut parts = Parts::of(choice);
                    let default = self.ident(&parts.part(Rule::name)?);
                    let mut choices = Vec::new();
                    while let Some(choice) = parts.part(Rule::name) {
                        choices.push(self.ident(&choice));
                    }
                    let value = Expr { kind: ExprKind::Name(default.name), span: default.span };
                    return Some(Item::Param { name, value, range: None, choices });
                }
                let (value, low, high) = self.truncated(parts.part(Rule::truncated)?)?;
                Some(Item::Param { name, value, range: Some((low, high)), choices: Vec::new() })
            }
            Rule::let_decl => self.let_decl(pair).map(Item::Let),
            Rule::tracks => {
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::name)?);
                let file = match parts.part(Rule::name) {
                    Some(format) => Some((self.ident(&format), self.quoted(&parts.part(Rule::text)?))),
                    None => None,
                };
                Some(Item::Tracks { name, file, body: self.body(parts) })
            }
            Rule::scene => Some(Item::Scene(self.scene(pair))),
            Rule::kind => self.kind(pair).map(Item::Kind),
            Rule::agents => self.agents(pair).map(Item::Agents),
            Rule::group => self.group(pair).map(Item::Group),
            Rule::moves => self.moves(pair).map(|moves| Item::Moves(MovesDecl { span, ..moves })),
            Rule::paths => {
                let mut parts = Parts::of(pair);
                let agent = self.ident(&parts.part(Rule::name)?);
                let member = self.member(&mut parts);
                let block = parts.part(Rule::block)?;
                let alternatives = self.only(&block, Rule::line_of_paths, &mut |builder, item| {
                    Some(builder.expr(Parts::of(item).part(Rule::arith)?))
                })?;
                Some(Item::Paths(PathsDecl { agent, member, alternatives, span }))
            }
            Rule::process => self.process(pair).map(Item::Process),
            Rule::program => self.program(pair).map(Item::Program),
            Rule::behaviour => self.behaviour(pair).map(Item::Behaviour),
            Rule::source => self.source_decl(pair).map(Item::Source),
            _ => None,
        }
    }

    fn moves(&mut self, pair: Pair<'_>) -> Option<MovesDecl> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let agent = self.ident(&parts.part(Rule::name)?);
        let member = self.member(&mut parts);
        let duration = self.expr(parts.part(Rule::arith)?);
        let options = self.block(&parts.part(Rule::block)?, Rule::line_of_moves, &mut Self::move_option);
        Some(MovesDecl { agent, member, duration, options, span })
    }

    fn move_option(&mut self, pair: Pair<'_>) -> Option<MoveOption> {
        let pair = pair.into_inner().next()?;
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::headings => {
                let mut parts = Parts::of(pair);
                let from = self.expr(parts.part(Rule::arith)?);
                let to = self.expr(parts.part(Rule::arith)?);
                let by = self.expr(parts.part(Rule::arith)?);
                Some(MoveOption::Headings { from, to, by, span })
            }
            Rule::named_route => {
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::name)?);
                let route = parts.next()?;
                let route = match route.as_rule() {
                    Rule::wait => Value::Route(Route { legs: vec![self.leg(route)?], then_leave: None }),
                    _ => self.value(route)?,
                };
                Some(MoveOption::Route { name, route, span })
            }
            Rule::heading => Some(MoveOption::Heading(self.expr(Parts::of(pair).part(Rule::arith)?))),
            _ => Some(MoveOption::Stop(span)),
        }
    }
}
