//! Processes, programs that run elsewhere, and behaviours.

use super::builder::{Builder, Pair, Parts};
use super::columns::Columns;
use super::grammar::Rule;
use super::quantity;
use crate::syntax::ast::{
    BehaviourDecl, BehaviourItem, BinaryOp, Branch, Choice, Command, Domain, Expr, ExprKind, LetDecl, OnDecl,
    ProcessDecl, ProcessItem, ProgramDecl, ShownDecl, StateDecl, Text, Timing, Transition, Update, Value,
    VarDecl,
};
use crate::syntax::source::Span;

impl Builder<'_> {
    pub(super) fn process(&mut self, pair: Pair<'_>) -> Option<ProcessDecl> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let count = self.size(&mut parts);
        let items = self.block(&parts.part(Rule::block)?, Rule::line_of_process, &mut Self::process_item);
        Some(ProcessDecl { name, count, items, span })
    }

    fn process_item(&mut self, pair: Pair<'_>) -> Option<ProcessItem> {
        let pair = pair.into_inner().next()?;
        match pair.as_rule() {
            Rule::var => self.var(pair).map(ProcessItem::Var),
            Rule::let_decl => self.let_decl(pair).map(ProcessItem::Let),
            Rule::label => {
                let mut parts = Parts::of(pair);
                let name = self.ident(&parts.part(Rule::name)?);
                Some(ProcessItem::Label { name, value: self.expr(parts.part(Rule::expr)?) })
            }
            Rule::command => self.command(pair).map(ProcessItem::Command),
            _ => Some(ProcessItem::Choose(self.span(&pair))),
        }
    }

    fn var(&mut self, pair: Pair<'_>) -> Option<VarDecl> {
        let mut parts = Parts::of(pair);
        // A variable is `process.name` outside; that it may equal a unit does no harm.
        let name = self.ident(&parts.part(Rule::name)?);
        let domain = if let Some(range) = parts.part(Rule::var_range) {
            let place = range.as_span();
            let mut ends = Parts::of(range);
            let low = self.expr(ends.part(Rule::arith)?);
            let high = self.expr(ends.part(Rule::arith)?);
            // `0 .. 3 m/s = …`: a name that is set is no unit.
            if let ExprKind::Binary(BinaryOp::Over | BinaryOp::Times, _, below) = &high.kind
                && matches!(&below.kind, ExprKind::Name(name) if quantity::UNITS.contains(&name.as_str()))
                && let Some(error) = self.unit_in_range(&name.name, place.start()..place.end())
            {
                self.say(error);
                return None;
            }
            Some(Domain::Range(low, high))
        } else {
            parts.part(Rule::name).map(|domain| Domain::Named(self.ident(&domain)))
        };
        Some(VarDecl { name, domain, initial: self.expr(parts.part(Rule::tight)?) })
    }

    fn command(&mut self, pair: Pair<'_>) -> Option<Command> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let guard = self.expr(parts.part(Rule::expr)?);
        let timing = match parts.rule()? {
            Rule::rate => Some(Timing::Rate(self.expr(Parts::of(parts.next()?).part(Rule::arith)?))),
            Rule::delay => Some(Timing::Delay(self.delay(parts.next()?)?)),
            _ => None,
        };
        let mut branches = Vec::new();
        for branch in Parts::of(parts.part(Rule::branches)?) {
            let span = self.span(&branch);
            let mut parts = Parts::of(branch);
            let weight = self.weight(&mut parts);
            let mut updates = Parts::of(parts.part(Rule::updates)?);
            let updates = match updates.part(Rule::block) {
                Some(block) => self.block(&block, Rule::line_of_updates, &mut Self::update_list).concat(),
                None => vec![self.update(updates.part(Rule::update)?)?],
            };
            branches.push(Branch { weight, updates, span });
        }
        let weighted: Vec<_> = branches.iter().map(|branch| (branch.weight.is_some(), branch.span)).collect();
        self.need_weights(&weighted);
        Some(Command { guard, timing, branches, span })
    }

    fn update_list(&mut self, pair: Pair<'_>) -> Option<Vec<Update>> {
        Parts::of(pair).map(|update| self.update(update)).collect()
    }

    fn update(&mut self, pair: Pair<'_>) -> Option<Update> {
        let mut parts = Parts::of(pair);
        let target = self.ident(&parts.part(Rule::name)?);
        Some(Update { target, value: self.expr(parts.part(Rule::tight)?) })
    }

    fn weight(&mut self, parts: &mut Parts<'_>) -> Option<Expr> {
        let weight = parts.part(Rule::weight)?;
        Some(self.expr(Parts::of(weight).part(Rule::arith)?))
    }

    fn delay(&mut self, pair: Pair<'_>) -> Option<Box<Value>> {
        self.value(Parts::of(pair).next()?).map(Box::new)
    }

    /// Two or more branches need weights.
    fn need_weights(&mut self, branches: &[(bool, Span)]) {
        if branches.len() < 2 {
            return;
        }
        for (_, span) in branches.iter().filter(|(has_weight, _)| !has_weight) {
            self.say(
                error!(E0116, *span, "a branch has no weight";
                    hint: "write `1/2: …` before each branch; write a Boolean value with `|` in parentheses"),
            );
        }
    }

    pub(super) fn program(&mut self, pair: Pair<'_>) -> Option<ProgramDecl> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let (mut signals, mut people, mut body): (Vec<LetDecl>, _, _) = (Vec::new(), None, Vec::new());
        let mut columns = Columns { program: name.clone(), read: Vec::new() };
        self.block(&parts.part(Rule::block)?, Rule::line_of_program, &mut |builder, part| {
            let part = part.into_inner().next()?;
            let place = builder.span(&part);
            let rule = part.as_rule();
            if rule == Rule::field {
                body.push(builder.field(part)?);
                return Some(());
            }
            let mut parts = Parts::of(part);
            let name = builder.ident(&parts.part(Rule::name)?);
            let count = builder.size(&mut parts);
            let mut value = builder.expr(parts.part(Rule::expr)?);
            if rule == Rule::signal {
                columns.replace(&mut value);
                signals.push(LetDecl { name, arguments: Vec::new(), body: value });
            } else if people.is_none() {
                people = Some(ShownDecl { name, count, columns: value });
            } else {
                builder.say(error!(E0118, place, "a program shows one set of agents";
                    hint: "tell them apart by a column, and read that as a signal"));
            }
            Some(())
        });
        let (variables, columns): (Vec<VarDecl>, Vec<Text>) = columns.read.into_iter().unzip();
        let items = variables.into_iter().map(ProcessItem::Var).collect();
        let process = ProcessDecl { name, count: None, items, span };
        Some(ProgramDecl { process, columns, signals, people, body })
    }

    pub(super) fn behaviour(&mut self, pair: Pair<'_>) -> Option<BehaviourDecl> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let arguments =
            parts.part(Rule::parameters).map(|parameters| self.parameters(parameters)).unwrap_or_default();
        let items = self.block(&parts.part(Rule::block)?, Rule::line_of_behaviour, &mut Self::behaviour_item);
        Some(BehaviourDecl { name, arguments, items, span })
    }

    fn behaviour_item(&mut self, pair: Pair<'_>) -> Option<BehaviourItem> {
        let pair = pair.into_inner().next()?;
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::state => self.state(pair).map(BehaviourItem::State),
            Rule::on => {
                let mut parts = Parts::of(pair);
                let event = self.ident(&parts.part(Rule::name)?);
                let choices =
                    self.only(&parts.part(Rule::block)?, Rule::line_of_answers, &mut Self::answers)?;
                Some(BehaviourItem::On(OnDecl { event, choices, span }))
            }
            _ => self.let_decl(pair).map(BehaviourItem::Let),
        }
    }

    /// `choose { p: follow | 1 - p: ignore }`, or the choices alone.
    fn answers(&mut self, pair: Pair<'_>) -> Option<Vec<Choice>> {
        let mut parts = Parts::of(pair);
        match parts.part(Rule::block) {
            Some(block) => self.only(&block, Rule::line_of_choices, &mut Self::choices),
            None => self.choices(parts.part(Rule::choices)?),
        }
    }

    fn state(&mut self, pair: Pair<'_>) -> Option<StateDecl> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.ident(&parts.part(Rule::name)?);
        let (mut fields, mut transitions) = (Vec::new(), Vec::new());
        self.block(&parts.part(Rule::block)?, Rule::line_of_state, &mut |builder, part| {
            let part = part.into_inner().next()?;
            if part.as_rule() == Rule::transition {
                transitions.push(builder.transition(part)?);
                return Some(());
            }
            if !transitions.is_empty() {
                let title = "fields of a state must come before its transitions";
                builder.say(error!(E0118, builder.span(&part), "{title}";
                    hint: "move it before the transitions"));
            }
            fields.push(builder.field(part)?);
            Some(())
        });
        Some(StateDecl { name, fields, transitions, span })
    }

    fn transition(&mut self, pair: Pair<'_>) -> Option<Transition> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let guard = parts.part(Rule::expr).map(|guard| self.expr(guard));
        let after = match parts.part(Rule::delay) {
            Some(delay) => Some(self.delay(delay)?),
            None => None,
        };
        Some(Transition { guard, after, targets: self.choices(parts.part(Rule::choices)?)?, span })
    }

    fn choices(&mut self, pair: Pair<'_>) -> Option<Vec<Choice>> {
        let mut choices = Vec::new();
        for choice in Parts::of(pair) {
            let mut parts = Parts::of(choice);
            let weight = self.weight(&mut parts);
            choices.push(Choice { weight, target: self.ident(&parts.part(Rule::name)?) });
        }
        let weighted: Vec<_> =
            choices.iter().map(|choice| (choice.weight.is_some(), choice.target.span)).collect();
        self.need_weights(&weighted);
        Some(choices)
    }
}
