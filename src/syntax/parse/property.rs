//! Property files: properties and queries.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use crate::syntax::ast::property::Every;
use crate::syntax::ast::{
    BinaryOp, Binding, Clauses, Constraint, Ident, Measure, MeasureKind, Method, PropertyFile, PropertyItem,
    Query, QueryKind, Ranked, Values,
};
use crate::syntax::source::Span;

impl Builder<'_> {
    pub(super) fn property_file(&mut self) -> PropertyFile {
        let layout = self.layout;
        let items = self.items(&layout.items, Rule::line_of_properties, &mut Self::property_item);
        PropertyFile { items, broken: std::mem::take(&mut self.broken), ..PropertyFile::default() }
    }

    fn property_item(&mut self, pair: Pair<'_>) -> Option<PropertyItem> {
        let pair = pair.into_inner().next()?;
        let span = self.span(&pair);
        let rule = pair.as_rule();
        if rule == Rule::let_decl {
            return self.let_decl(pair).map(PropertyItem::Let);
        }
        let mut parts = Parts::of(pair);
        match rule {
            Rule::const_decl => {
                let name = self.ident(&parts.part(Rule::name)?);
                Some(PropertyItem::Const { name, value: self.expr(parts.part(Rule::expr)?) })
            }
            Rule::property => {
                let name = self.ident(&parts.part(Rule::name)?);
                Some(PropertyItem::Property { name, formula: self.expr(parts.part(Rule::expr)?) })
            }
            Rule::written_for => Some(PropertyItem::For(self.quoted(&parts.part(Rule::text)?))),
            Rule::family => {
                Some(PropertyItem::Family { confidence: self.expr(parts.part(Rule::arith)?), span })
            }
            _ => self.query(rule, parts, span).map(PropertyItem::Query),
        }
    }

    fn query(&mut self, rule: Rule, mut parts: Parts<'_>, span: Span) -> Option<Query> {
        // Widths that follow aims.
        let mut within = Vec::new();
        let kind = match rule {
            Rule::check => QueryKind::Check {
                measure: self.measure(parts.part(Rule::measure)?)?,
                relation: relation(&parts.part(Rule::relation)?)?,
                threshold: self.expr(parts.part(Rule::arith)?),
            },
            Rule::estimate => {
                let mut measures = Vec::new();
                while let Some(measure) = parts.part(Rule::measure) {
                    measures.extend(self.measures(measure)?);
                }
                QueryKind::Estimate(measures)
            }
            Rule::curve => {
                let measure = self.measure(parts.part(Rule::measure)?)?;
                let name = self.ident(&parts.part(Rule::ident)?);
                QueryKind::Curve { measure, values: self.values(&name, parts.next()?)?, name }
            }
            Rule::pareto => {
                let of = self.options(&mut parts)?;
                let mut measures = Vec::new();
                while let Some(measure) = parts.part(Rule::measure) {
                    measures.push(self.measure(measure)?);
                    if let Some(own) = parts.part(Rule::aim_within) {
                        within.push(self.expr(Parts::of(own).part(Rule::arith)?));
                    }
                }
                QueryKind::Pareto { of, measures }
            }
            Rule::compare => QueryKind::Compare {
                measure: self.measure(parts.part(Rule::measure)?)?,
                first: self.bindings(parts.part(Rule::bindings)?)?,
                second: self.bindings(parts.part(Rule::bindings)?)?,
            },
            _ => QueryKind::Rank {
                of: self.options(&mut parts)?,
                measure: self.measure(parts.part(Rule::measure)?)?,
                subject: match parts.part(Rule::subject) {
                    Some(subject) => {
                        Parts::of(subject).map(|one| self.constraint(one)).collect::<Option<_>>()?
                    }
                    None => Vec::new(),
                },
            },
        };
        let mut clauses = self.clauses(parts)?;
        if !within.is_empty() {
            within.extend(clauses.within.take());
            within.append(&mut clauses.within_others);
            let mut all = within.into_iter();
            (clauses.within, clauses.within_others) = (all.next(), all.collect());
        }
        Some(Query { kind, clauses, span })
    }

    fn constraint(&mut self, pair: Pair<'_>) -> Option<Constraint> {
        let mut parts = Parts::of(pair);
        Some(Constraint {
            measure: self.measure(parts.part(Rule::measure)?)?,
            relation: relation(&parts.part(Rule::relation)?)?,
            threshold: self.expr(parts.part(Rule::arith)?),
        })
    }

    /// What a ranking chooses from.
    fn options(&mut self, parts: &mut Parts<'_>) -> Option<Ranked> {
        let (mut moves, mut list) = (Vec::new(), Vec::new());
        while let Some(factor) = parts.part(Rule::factor) {
            let mut factor = Parts::of(factor);
            if let Some(moved) = factor.part(Rule::moves_of) {
                let mut parts = Parts::of(moved);
                let what = self.ident(&parts.part(Rule::name)?);
                moves.push((what, self.expr(parts.part(Rule::set)?)));
                continue;
            }
            let mut parts = Parts::of(factor.part(Rule::ranked)?);
            let name = self.ident(&parts.part(Rule::ident)?);
            let values = self.values(&name, parts.next()?)?;
            list.push((name, values));
        }
        Some(Ranked { moves, values: list })
    }

    fn values(&mut self, name: &Ident, pair: Pair<'_>) -> Option<Values> {
        let span = self.span(&pair);
        let text = self.source.slice(span).trim_end().to_owned();
        let log = pair.clone().into_inner().any(|part| part.as_rule() == Rule::kw_log);
        let rule = pair.as_rule();
        let mut list = Vec::new();
        for part in Parts::of(pair) {
            list.push(self.expr(part));
        }
        if rule == Rule::value_list {
            return Some(Values::List(list));
        }
        let mut ends = list.into_iter();
        let (Some(from), Some(to)) = (ends.next(), ends.next()) else {
            self.say(error!(E0101, name.span, "no value of `{}` is listed", name.name;
                hint: "write values or a range: `1, 2, 4` or `1 .. 3 by 0.5`"));
            return None;
        };
        let Some(by) = ends.next() else {
            let place = from.span.to(to.span);
            self.say(error!(E0101, place, "the range has no step";
                hint: "write it before the measure: `{text} by … by P(…)`"));
            return None;
        };
        Some(Values::Range { from, to, by, log })
    }

    /// The only measure of a query that takes one.
    fn measure(&mut self, pair: Pair<'_>) -> Option<Measure> {
        let mut measures = self.measures(pair)?;
        if let Some(second) = measures.get(1)
            && let MeasureKind::Quantile(level) | MeasureKind::Tail(level) = &second.kind
        {
            self.say(error!(E0124, level.span, "only one level is allowed here";
                    hint: "several levels can only be estimated: `estimate Q(0.5, 0.9, …)`"));
            return None;
        }
        measures.pop()
    }

    /// A measure; several levels of a quantile are as many measures.
    fn measures(&mut self, pair: Pair<'_>) -> Option<Vec<Measure>> {
        let span = self.span(&pair);
        let pair = pair.into_inner().next()?;
        let rule = pair.as_rule();
        // `P`, `E`, `Q` and `CVaR` are marks of a kind, but stand first.
        let mut parts = Parts::of(pair);
        parts.next()?;
        let kinds = match rule {
            Rule::probability => vec![MeasureKind::Probability],
            Rule::expectation => vec![MeasureKind::Expectation],
            _ => {
                let mut levels = Vec::new();
                while let Some(level) = parts.part(Rule::arith) {
                    let level = self.expr(level);
                    let is_tail = rule == Rule::tail;
                    levels.push(if is_tail {
                        MeasureKind::Tail(level)
                    } else {
                        MeasureKind::Quantile(level)
                    });
                }
                levels
            }
        };
        let mut body = self.expr(parts.part(Rule::expr)?);
        if let Some(moment) = parts.part(Rule::moment).or_else(|| parts.part(Rule::read_at)) {
            body = self.read_at(body, moment);
        }
        let range = match parts.part(Rule::measure_range) {
            Some(range) => {
                let mut ends = Parts::of(range);
                let low = self.expr(ends.part(Rule::arith)?);
                Some((low, self.expr(ends.part(Rule::arith)?)))
            }
            None => None,
        };
        let each = kinds.into_iter();
        Some(each.map(|kind| Measure { kind, body: body.clone(), range: range.clone(), span }).collect())
    }

    fn bindings(&mut self, pair: Pair<'_>) -> Option<Vec<Binding>> {
        Parts::of(pair).map(|binding| self.binding(binding)).collect()
    }

    fn clauses(&mut self, parts: Parts<'_>) -> Option<Clauses> {
        let mut clauses = Clauses::default();
        for clause in parts {
            let clause = clause.into_inner().next()?;
            let span = self.span(&clause);
            let rule = clause.as_rule();
            let mut parts = Parts::of(clause);
            let twice = match rule {
                Rule::within => {
                    let twice = clauses.within.replace(self.expr(parts.part(Rule::arith)?)).is_some();
                    clauses.within_others.extend(parts.map(|other| self.expr(other)));
                    twice
                }
                Rule::confidence => clauses.confidence.replace(self.expr(parts.part(Rule::arith)?)).is_some(),
                Rule::method => {
                    let name = self.ident(&parts.part(Rule::name)?);
                    let arguments = parts.map(|binding| self.binding(binding)).collect::<Option<_>>()?;
                    clauses.by.replace(Method { name, arguments, span }).is_some()
                }
                Rule::every => {
                    let name = self.ident(&parts.part(Rule::ident)?);
                    let list = parts.part(Rule::value_list);
                    let values = list.map(|list| Parts::of(list).map(|value| self.expr(value)).collect());
                    clauses.every.replace(Every { name, values, span }).is_some()
                }
                _ => {
                    let bindings = self.bindings(parts.part(Rule::bindings)?)?;
                    !std::mem::replace(&mut clauses.under, bindings).is_empty()
                }
            };
            if twice {
                let word = self.source.slice(span).split_whitespace().next().unwrap_or("").to_owned();
                self.say(error!(E0111, span, "`{word}` is repeated"; hint: "remove one of them"));
            }
        }
        Some(clauses)
    }
}

fn relation(pair: &Pair<'_>) -> Option<BinaryOp> {
    Some(match pair.clone().into_inner().next()?.as_rule() {
        Rule::op_at_least => BinaryOp::AtLeast,
        Rule::op_more => BinaryOp::Greater,
        Rule::op_at_most => BinaryOp::AtMost,
        _ => BinaryOp::Less,
    })
}
