//! Expressions: the flat sequences of the grammar become trees by operator precedence.
//!
//! Dijkstra's shunting yard: one stack of operands, one of operators, no recursion but for brackets. So
//! a chain of any length cannot exhaust the stack here; and because dropping or walking the tree later
//! does recurse, its height is limited too.

use super::builder::{Builder, Pair, Parts};
use super::grammar::Rule;
use super::nesting::NESTING;
use crate::syntax::ast::{
    Aggregate, BinaryOp, Bound, Expr, ExprKind, Ident, Quantifier, Temporal, TemporalPair, UnaryOp,
};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// How high a tree may be, chains of operators included.
const HEIGHT: u16 = 2 * NESTING;

/// A part of an expression.
struct Built {
    expr: Expr,
    /// Nodes on the longest way down.
    height: u16,
    /// Prefixes on the longest way down; brackets are counted before parsing.
    nesting: u16,
    /// Not in parentheses.
    bare: bool,
    /// A temporal operator over an operand without parentheses.
    open: bool,
}

impl Built {
    fn leaf(kind: ExprKind, span: Span) -> Self {
        Self { expr: Expr { kind, span }, height: 1, nesting: 0, bare: true, open: false }
    }
}

/// A prefix that waits for its operand.
enum Prefix {
    Unary(UnaryOp),
    Temporal(Temporal, Option<Bound>),
    Window(Aggregate, Bound),
    Binder(Quantifier, Ident, Expr),
}

/// An operator that waits for its right side.
enum Infix {
    Plain(BinaryOp),
    Temporal(TemporalPair, Option<Bound>),
}

/// How deep the bound or set of an operator is.
#[derive(Clone, Copy, Default)]
struct Extra {
    height: u16,
    nesting: u16,
}

impl Extra {
    fn of<'b>(parts: impl Iterator<Item = &'b Built>) -> Self {
        parts.fold(Self::default(), |extra, part| Self {
            height: extra.height.max(part.height),
            nesting: extra.nesting.max(part.nesting),
        })
    }
}

enum Operator {
    Prefix { what: Prefix, span: Span, extra: Extra },
    Infix { what: Infix, level: u8, extra: Extra },
}

impl Operator {
    /// Tighter operators have higher levels.
    fn level(&self) -> u8 {
        match self {
            Self::Prefix { what, .. } => match what {
                Prefix::Binder(..) => 0,
                Prefix::Temporal(..) | Prefix::Unary(UnaryOp::Not) => 6,
                Prefix::Unary(UnaryOp::Minus) | Prefix::Window(..) => 10,
            },
            Self::Infix { level, .. } => *level,
        }
    }
}

const COMPARISON: u8 = 7;

fn associates_right(level: u8) -> bool {
    matches!(level, 1 | 2 | 5 | 11)
}

fn plain_infix(rule: Rule) -> Option<(BinaryOp, u8)> {
    Some(match rule {
        Rule::op_iff => (BinaryOp::Iff, 1),
        Rule::op_implies => (BinaryOp::Implies, 2),
        Rule::op_or => (BinaryOp::Or, 3),
        Rule::op_and => (BinaryOp::And, 4),
        Rule::op_equal => (BinaryOp::Equal, COMPARISON),
        Rule::op_unequal => (BinaryOp::Unequal, COMPARISON),
        Rule::op_at_most => (BinaryOp::AtMost, COMPARISON),
        Rule::op_less => (BinaryOp::Less, COMPARISON),
        Rule::op_at_least => (BinaryOp::AtLeast, COMPARISON),
        Rule::op_more => (BinaryOp::Greater, COMPARISON),
        Rule::kw_in => (BinaryOp::In, COMPARISON),
        Rule::op_plus => (BinaryOp::Plus, 8),
        Rule::op_minus => (BinaryOp::Minus, 8),
        Rule::op_times => (BinaryOp::Times, 9),
        Rule::op_over => (BinaryOp::Over, 9),
        Rule::op_power => (BinaryOp::Power, 11),
        _ => return None,
    })
}

fn aggregate(name: &str) -> Option<Aggregate> {
    Some(match name {
        "min" => Aggregate::Min,
        "max" => Aggregate::Max,
        "sum" => Aggregate::Sum,
        "mean" => Aggregate::Mean,
        _ => return None,
    })
}

/// The two stacks of one sequence.
#[derive(Default)]
struct Yard {
    operands: Vec<Built>,
    operators: Vec<Operator>,
}

impl Builder<'_> {
    /// An expression of any of the rules that hold a sequence.
    pub(super) fn expr(&mut self, pair: Pair<'_>) -> Expr {
        let span = self.span(&pair);
        self.sequence(pair).map_or(Expr { kind: ExprKind::Broken, span }, |built| built.expr)
    }

    fn sequence(&mut self, pair: Pair<'_>) -> Option<Built> {
        let mut yard = Yard::default();
        let mut wants_operand = true;
        for part in pair.into_inner() {
            let rule = part.as_rule();
            if rule == Rule::member || rule == Rule::index {
                let target = yard.operands.pop()?;
                let built = self.postfix(target, part)?;
                yard.operands.push(built);
            } else if rule == Rule::primary {
                let built = self.primary(part.into_inner().next()?)?;
                yard.operands.push(built);
                wants_operand = false;
            } else if wants_operand {
                let operator = self.prefix(part)?;
                yard.operators.push(operator);
            } else {
                let operator = self.infix(part.clone())?;
                self.make_room(&mut yard, &operator, &part)?;
                yard.operators.push(operator);
                wants_operand = true;
            }
        }
        while let Some(operator) = yard.operators.pop() {
            self.apply(&mut yard.operands, operator)?;
        }
        yard.operands.pop()
    }

    /// Applies the operators that bind tighter than the one that comes.
    fn make_room(&mut self, yard: &mut Yard, next: &Operator, place: &Pair<'_>) -> Option<()> {
        let level = next.level();
        while let Some(top) = yard.operators.last() {
            let first = top.level();
            if first < level || first == level && associates_right(level) {
                break;
            }
            if first == COMPARISON && level == COMPARISON {
                let span = self.span(place);
                self.say(error!(E0109, span, "comparisons cannot be chained";
                        hint: "join two comparisons with `&`: `a < b & b < c`"));
                return None;
            }
            let operator = yard.operators.pop()?;
            self.apply(&mut yard.operands, operator)?;
        }
        Some(())
    }

    fn prefix(&mut self, pair: Pair<'_>) -> Option<Operator> {
        let span = self.span(&pair);
        let mut extra = Extra::default();
        let what = match pair.as_rule() {
            Rule::op_not => Prefix::Unary(UnaryOp::Not),
            Rule::op_minus => Prefix::Unary(UnaryOp::Minus),
            Rule::temporal => {
                let mut parts = pair.into_inner();
                let operator = match parts.next()?.as_rule() {
                    Rule::op_finally => Temporal::Finally,
                    Rule::op_globally => Temporal::Globally,
                    _ => Temporal::Next,
                };
                let bound = self.bound(parts.next(), &mut extra)?;
                Prefix::Temporal(operator, bound)
            }
            Rule::window => {
                let mut parts = pair.into_inner();
                let fold = aggregate(parts.next()?.as_str())?;
                let bound = self.bound(parts.next(), &mut extra)??;
                Prefix::Window(fold, bound)
            }
            _ => {
                let forall = pair.clone().into_inner().next()?.as_rule() == Rule::kw_forall;
                let mut parts = Parts::of(pair);
                let variable = self.ident(&parts.part(Rule::name)?);
                let set = self.sequence(parts.part(Rule::set)?)?;
                extra = Extra::of(std::iter::once(&set));
                let quantifier = if forall { Quantifier::Forall } else { Quantifier::Exists };
                Prefix::Binder(quantifier, variable, set.expr)
            }
        };
        Some(Operator::Prefix { what, span, extra })
    }

    fn infix(&mut self, pair: Pair<'_>) -> Option<Operator> {
        if let Some((operator, level)) = plain_infix(pair.as_rule()) {
            return Some(Operator::Infix { what: Infix::Plain(operator), level, extra: Extra::default() });
        }
        let mut parts = pair.into_inner();
        let operator = match parts.next()?.as_rule() {
            Rule::op_until => TemporalPair::Until,
            Rule::op_release => TemporalPair::Release,
            _ => TemporalPair::WeakUntil,
        };
        let mut extra = Extra::default();
        let bound = self.bound(parts.next(), &mut extra)?;
        Some(Operator::Infix { what: Infix::Temporal(operator, bound), level: 5, extra })
    }

    /// A bound; the outer `None` is a failure, the inner one is no bound.
    #[allow(clippy::option_option, reason = "a failure is not the absence of a bound")]
    fn bound(&mut self, pair: Option<Pair<'_>>, extra: &mut Extra) -> Option<Option<Bound>> {
        let Some(pair) = pair else { return Some(None) };
        let mut ends = Vec::new();
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::expr => ends.push(self.sequence(part)?),
                Rule::bound_value => ends.push(self.primary(part.into_inner().next()?)?),
                _ => {}
            }
        }
        *extra = Extra::of(ends.iter());
        let mut ends = ends.into_iter().map(|end| Box::new(end.expr));
        let first = ends.next()?;
        Some(Some(match ends.next() {
            Some(second) => Bound::Interval(first, second),
            None => Bound::AtMost(first),
        }))
    }

    fn apply(&mut self, operands: &mut Vec<Built>, operator: Operator) -> Option<()> {
        let right = operands.pop()?;
        let built = match operator {
            Operator::Prefix { what, span, extra } => {
                let open = matches!(what, Prefix::Temporal(..)) && right.bare;
                let (height, nesting) =
                    (right.height.max(extra.height) + 1, right.nesting.max(extra.nesting) + 1);
                let span = span.to(right.expr.span);
                let body = Box::new(right.expr);
                let kind = match what {
                    Prefix::Unary(operator) => ExprKind::Unary(operator, body),
                    Prefix::Temporal(operator, bound) => ExprKind::Temporal(operator, bound, body),
                    Prefix::Window(fold, bound) => ExprKind::Window(fold, bound, body),
                    Prefix::Binder(quantifier, variable, set) => {
                        ExprKind::Quantified { quantifier, variable, set: Box::new(set), body }
                    }
                };
                Built { expr: Expr { kind, span }, height, nesting, bare: true, open }
            }
            Operator::Infix { what, extra, .. } => {
                let left = operands.pop()?;
                self.lint(&what, &left, &right);
                let span = left.expr.span.to(right.expr.span);
                let height = left.height.max(right.height).max(extra.height) + 1;
                let nesting = left.nesting.max(right.nesting).max(extra.nesting);
                let (left, right) = (Box::new(left.expr), Box::new(right.expr));
                let kind = match what {
                    Infix::Plain(operator) => ExprKind::Binary(operator, left, right),
                    Infix::Temporal(operator, bound) => ExprKind::TemporalPair(operator, bound, left, right),
                };
                Built { expr: Expr { kind, span }, height, nesting, bare: true, open: false }
            }
        };
        operands.push(self.limited(built)?);
        Some(())
    }

    /// Refuses what is too deep.
    fn limited(&mut self, built: Built) -> Option<Built> {
        if built.nesting > NESTING {
            let span = Span { end: built.expr.span.start + 1, ..built.expr.span };
            self.say(super::nesting::too_deep(span));
            return None;
        }
        if built.height > HEIGHT {
            // Operators in a row stand upon one another, the last one on the highest of the parts.
            let title =
                format!("the expression has more than {HEIGHT} levels; each operator in a chain is a level");
            self.say(error!(E0120, built.expr.span, "{title}";
                    hint: "name parts of it with `let`, or write a fold such as `forall a in S: …`"));
            return None;
        }
        Some(built)
    }

    fn lint(&mut self, what: &Infix, left: &Built, right: &Built) {
        match (what, &left.expr.kind) {
            (Infix::Plain(BinaryOp::Implies), ExprKind::Temporal(..)) if left.bare && left.open => {
                let whole = self.source.slice(left.expr.span);
                let warning = Diagnostic::warning(
                    Code::W0101,
                    left.expr.span.to(right.expr.span),
                    "the temporal operator binds tighter than `=>`",
                )
                .hint(format!(
                    "this means `({whole}) => …`; write parentheses around the operand of the operator"
                ));
                self.say(warning);
            }
            (Infix::Plain(BinaryOp::Power), ExprKind::Quantity(quantity))
                if left.bare
                    && quantity.unit.as_ref().is_some_and(|unit| unit.factors[0].name.name != "%") =>
            {
                let warning = Diagnostic::warning(
                    Code::W0102,
                    left.expr.span.to(right.expr.span),
                    "the power applies to the number and its unit",
                )
                .hint(
                    "for a power of the unit write no blanks: `2 m^2`; for a power of the quantity write parentheses: `(2 m) ^ 2`",
                );
                self.say(warning);
            }
            _ => {}
        }
    }

    fn postfix(&mut self, target: Built, pair: Pair<'_>) -> Option<Built> {
        let span = target.expr.span.to(self.span(&pair));
        let is_member = pair.as_rule() == Rule::member;
        let written = self.source.slice(target.expr.span);
        if is_member && written.bytes().all(|byte| byte.is_ascii_digit()) {
            // `5. m/s`
            let place =
                Span { end: span.end.min(target.expr.span.end + 1), start: target.expr.span.end, ..span };
            self.say(error!(E0101, place, "a number cannot end in a point";
                hint: "write `{written}`, or `{written}.0`"));
            return None;
        }
        let part = Parts::of(pair).next()?;
        let (kind, height, nesting) = if is_member {
            let member = self.ident(&part);
            (ExprKind::Member(Box::new(target.expr), member), target.height + 1, target.nesting)
        } else {
            let inner = self.sequence(part)?;
            (
                ExprKind::Index(Box::new(target.expr), Box::new(inner.expr)),
                target.height.max(inner.height) + 1,
                target.nesting.max(inner.nesting),
            )
        };
        self.limited(Built { expr: Expr { kind, span }, height, nesting, bare: true, open: false })
    }

    fn primary(&mut self, pair: Pair<'_>) -> Option<Built> {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::quantity => ExprKind::Quantity(self.quantity(pair)?),
            Rule::steps => ExprKind::Quantity(self.steps(&pair)?),
            Rule::infinity => ExprKind::Infinity,
            Rule::broken => ExprKind::Broken,
            Rule::text => ExprKind::Text(self.quoted(&pair).value),
            Rule::boolean => ExprKind::Bool(pair.as_str() == "true"),
            Rule::name => ExprKind::Name(pair.as_str().to_owned()),
            Rule::paren => return self.paren(pair, span),
            Rule::count => return self.count(pair, span),
            _ => return self.call(pair, span),
        };
        Some(Built::leaf(kind, span))
    }

    fn paren(&mut self, pair: Pair<'_>, span: Span) -> Option<Built> {
        let mut parts = Parts::of(pair);
        let mut first = self.sequence(parts.part(Rule::expr)?)?;
        if let Some(moment) = parts.part(Rule::read_at) {
            first.expr = self.read_at(first.expr, moment);
            first.height += 1;
        }
        if let Some(second) = parts.part(Rule::expr) {
            let second = self.sequence(second)?;
            let unit = match parts.next() {
                Some(unit) => Some(self.unit(unit)?),
                None => None,
            };
            let height = first.height.max(second.height) + 1;
            let nesting = first.nesting.max(second.nesting);
            let kind = ExprKind::Point { x: Box::new(first.expr), y: Box::new(second.expr), unit };
            return self.limited(Built {
                expr: Expr { kind, span },
                height,
                nesting,
                bare: false,
                open: false,
            });
        }
        first.expr.span = span;
        first.bare = false;
        self.limited(first)
    }

    fn count(&mut self, pair: Pair<'_>, span: Span) -> Option<Built> {
        let mut parts = Parts::of(pair);
        let variable = self.ident(&parts.part(Rule::name)?);
        let set = self.sequence(parts.part(Rule::set)?)?;
        let body = match parts.part(Rule::expr) {
            Some(body) => self.sequence(body)?,
            None => Built::leaf(ExprKind::Bool(true), set.expr.span),
        };
        self.fold(Quantifier::Count, variable, set, body, span)
    }

    fn fold(
        &mut self,
        quantifier: Quantifier,
        variable: Ident,
        set: Built,
        body: Built,
        span: Span,
    ) -> Option<Built> {
        let height = set.height.max(body.height) + 1;
        let nesting = set.nesting.max(body.nesting);
        let kind =
            ExprKind::Quantified { quantifier, variable, set: Box::new(set.expr), body: Box::new(body.expr) };
        self.limited(Built { expr: Expr { kind, span }, height, nesting, bare: false, open: false })
    }

    fn call(&mut self, pair: Pair<'_>, span: Span) -> Option<Built> {
        let mut parts = Parts::of(pair);
        let function = self.ident(&parts.part(Rule::name)?);
        let mut arguments = Vec::new();
        while let Some(argument) = parts.part(Rule::expr) {
            arguments.push(self.sequence(argument)?);
        }
        if let Some(over) = parts.part(Rule::fold_over) {
            let mut over = Parts::of(over);
            let variable = self.ident(&over.part(Rule::name)?);
            let set = self.sequence(over.part(Rule::set)?)?;
            let Some(fold) = aggregate(&function.name) else {
                let title = format!("`{}` cannot fold over a set", function.name);
                let quantifier = match function.name.as_str() {
                    "all" => Some("forall"),
                    "any" => Some("exists"),
                    _ => None,
                };
                let error = error!(E0122, function.span, "{title}");
                let body = arguments.pop()?.expr.span;
                self.say(match quantifier {
                    Some(quantifier) => {
                        let (set, body) = (self.source.slice(set.expr.span), self.source.slice(body));
                        error.hint(format!("write `{quantifier} {} in {set}: {body}`", variable.name))
                    }
                    None => error.hint("only `min`, `max`, `sum` and `mean` accept `… for a in S`"),
                });
                return None;
            };
            return self.fold(Quantifier::Fold(fold), variable, set, arguments.pop()?, span);
        }
        let height = arguments.iter().map(|argument| argument.height).max().unwrap_or(0) + 1;
        let nesting = arguments.iter().map(|argument| argument.nesting).max().unwrap_or(0);
        let arguments = arguments.into_iter().map(|argument| argument.expr).collect();
        let kind = ExprKind::Call { function, arguments };
        self.limited(Built { expr: Expr { kind, span }, height, nesting, bare: false, open: false })
    }

    /// `with` takes calls and names.
    pub(super) fn attached(&mut self, pair: Pair<'_>) -> Option<Expr> {
        self.primary(pair.into_inner().next()?).map(|built| built.expr)
    }

    /// A corner of a polygon.
    pub(super) fn corner(&mut self, pair: Pair<'_>) -> Option<Expr> {
        self.primary(pair).map(|built| built.expr)
    }
}
