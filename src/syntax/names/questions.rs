//! The names that the items of a property file declare and use.

use super::Walk;
use crate::syntax::ast::{Clauses, Measure, MeasureKind, PropertyItem, QueryKind, Ranked};

impl Walk {
    pub(super) fn property_item(&mut self, item: &PropertyItem) {
        match item {
            PropertyItem::Let(decl) => self.named_expression("let", decl),
            PropertyItem::Const { name, value } => {
                self.declare("const", name, value.span, Some(value));
                self.expr(value);
            }
            PropertyItem::Property { name, formula } => {
                self.declare("property", name, formula.span, Some(formula));
                self.expr(formula);
            }
            PropertyItem::For(_) => {}
            PropertyItem::Family { confidence, .. } => self.exprs([confidence]),
            PropertyItem::Query(query) => {
                self.question(&query.kind);
                self.clauses(&query.clauses);
            }
        }
    }

    pub(super) fn question(&mut self, kind: &QueryKind) {
        match kind {
            QueryKind::Check { measure, threshold, .. } => {
                self.measure(measure);
                self.expr(threshold);
            }
            QueryKind::Estimate(measures) => measures.iter().for_each(|one| self.measure(one)),
            QueryKind::Curve { measure, name, values } => {
                self.values(values);
                self.binding(std::slice::from_ref(name), |walk| walk.measure(measure));
            }
            QueryKind::Compare { measure, first, second } => {
                self.measure(measure);
                self.bindings(first);
                self.bindings(second);
            }
            QueryKind::Rank { of, measure, subject } => {
                self.ranked(of);
                self.measure(measure);
                for constraint in subject {
                    self.measure(&constraint.measure);
                    self.expr(&constraint.threshold);
                }
            }
            QueryKind::Pareto { of, measures } => {
                self.ranked(of);
                for one in measures {
                    self.measure(one);
                }
            }
        }
    }

    pub(super) fn ranked(&mut self, of: &Ranked) {
        self.exprs(of.moves.iter().map(|(_, whose)| whose));
        for (name, values) in &of.values {
            self.used(name);
            self.values(values);
        }
    }

    pub(super) fn measure(&mut self, measure: &Measure) {
        match &measure.kind {
            MeasureKind::Quantile(level) | MeasureKind::Tail(level) => self.exprs([level]),
            MeasureKind::Probability | MeasureKind::Expectation => {}
        }
        self.expr(&measure.body);
        self.exprs(measure.range.iter().flat_map(|(low, high)| [low, high]));
    }

    pub(super) fn clauses(&mut self, clauses: &Clauses) {
        self.exprs(clauses.within.iter().chain(&clauses.within_others).chain(&clauses.confidence));
        if let Some(method) = &clauses.by {
            self.exprs(method.arguments.iter().map(|argument| &argument.value));
        }
        self.bindings(&clauses.under);
        if let Some(every) = &clauses.every {
            self.used(&every.name);
            self.exprs(every.values.iter().flatten());
        }
    }
}
