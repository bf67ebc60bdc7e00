//! Property files (`.bltl`).

use super::{Binding, Broken, Expr, Ident, LetDecl, Text};
use crate::syntax::source::Span;

/// A whole property file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PropertyFile {
    /// Declarations and queries in order of writing.
    pub items: Vec<PropertyItem>,
    /// Items that could not be read, and heads of those whose values could not; that was reported.
    pub broken: Vec<Broken>,
    /// Whether something was wrong.
    pub fails: bool,
    /// Whether items may stand in the wrong blocks, since braces do not pair up or the text ends in a comment; that was
    /// reported.
    pub is_torn: bool,
}

impl PropertyFile {
    /// The scenario that it says it is about.
    pub fn scenario(&self) -> Option<&Text> {
        if let Some(PropertyItem::For(path)) = self.items.first() { Some(path) } else { None }
    }
}

/// One declaration or query.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a file has few items")]
pub enum PropertyItem {
    /// `for "corridor.scn"`, the first line: the scenario that the file is about, if the call names none.
    For(Text),
    /// `let gap(a) = …`
    Let(LetDecl),
    /// `const T = 10 s`
    Const {
        /// Its name.
        name: Ident,
        /// Its value.
        value: Expr,
    },
    /// `property safe = G<=10 s …`
    Property {
        /// Its name.
        name: Ident,
        /// The formula.
        formula: Expr,
    },
    /// `family confidence 95 %`: all queries of the file hold jointly.
    Family {
        /// The joint confidence.
        confidence: Expr,
        /// Where.
        span: Span,
    },
    /// A query.
    Query(Query),
}

/// One query.
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// The query.
    pub kind: QueryKind,
    /// How sure, by which procedure.
    pub clauses: Clauses,
    /// Where, from its keyword to its last clause.
    pub span: Span,
}

impl Query {
    /// Whether it gives a parameter a value in all its worlds, whatever a call sets.
    pub fn sets(&self, name: &str) -> bool {
        let among = |bindings: &[Binding]| bindings.iter().any(|binding| binding.name.name == name);
        let by_kind = match &self.kind {
            QueryKind::Compare { first, second, .. } => among(first) && among(second),
            QueryKind::Rank { of, .. } | QueryKind::Pareto { of, .. } => {
                of.values.iter().any(|(own, _)| own.name == name)
            }
            _ => false,
        };
        by_kind
            || among(&self.clauses.under)
            || self.clauses.every.as_ref().is_some_and(|every| every.name.name == name)
    }
}

/// The kinds of queries.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a file has few queries")]
pub enum QueryKind {
    /// `check P(safe) >= 0.9`
    Check {
        /// The measured quantity.
        measure: Measure,
        /// `>=`, `>`, `<=` or `<`.
        relation: super::BinaryOp,
        /// Compared with this.
        threshold: Expr,
    },
    /// `estimate P(a), E(b) in 0 m .. 3 m`
    Estimate(Vec<Measure>),
    /// `estimate P(F<=t p) for t in 0 s .. 30 s by 0.5 s`
    Curve {
        /// The measured quantity.
        measure: Measure,
        /// The name of the bound.
        name: Ident,
        /// Its values.
        values: Values,
    },
    /// `compare P(safe) under density = 0.2 /m^2 with density = 0.8 /m^2`
    Compare {
        /// The measured quantity.
        measure: Measure,
        /// Settings of the first side.
        first: Vec<Binding>,
        /// Settings of the second side.
        second: Vec<Binding>,
    },
    /// `rank moves of user by P(safe)`
    Rank {
        /// The options.
        of: Ranked,
        /// The score.
        measure: Measure,
        /// `subject to P(together) >= 0.9`
        subject: Vec<Constraint>,
    },
    /// `pareto moves of user by P(safe), E(-time) in -60 s .. 0 s`
    Pareto {
        /// The options.
        of: Ranked,
        /// The aims.
        measures: Vec<Measure>,
    },
}

/// What the options of a ranking have to satisfy.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// The measured quantity.
    pub measure: Measure,
    /// `>=`, `>`, `<=` or `<`.
    pub relation: super::BinaryOp,
    /// Compared with this.
    pub threshold: Expr,
}

/// The options of a ranking.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranked {
    /// `moves of user`: the word, of which compilation refuses any but `moves` and `paths`, and whose they are; of one agent or two.
    pub moves: Vec<(Ident, Expr)>,
    /// `lane in 1 m .. 3 m by 0.5 m, speed in 0.8 m/s, 1.2 m/s`: all combinations, with each of the moves.
    pub values: Vec<(Ident, Values)>,
}

/// Values of a parameter.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a call has few")]
pub enum Values {
    /// One by one.
    List(Vec<Expr>),
    /// From, to, by: ends included. With `log`, so many values a decade.
    Range {
        /// First.
        from: Expr,
        /// Last.
        to: Expr,
        /// Apart, or a number of values a decade.
        by: Expr,
        /// Whether each is the same factor larger than the one before.
        log: bool,
    },
}

impl Values {
    /// Where the least and the greatest stand, as far as that is known.
    pub fn ends(&self) -> (Span, Span) {
        match self {
            Self::List(list) => {
                let place = |expr: Option<&Expr>| expr.map_or(Span::default(), |expr| expr.span);
                (place(list.first()), place(list.last()))
            }
            Self::Range { from, to, .. } => (from.span, to.span),
        }
    }

    /// All that is written.
    pub fn parts(&self) -> Vec<&Expr> {
        match self {
            Self::List(list) => list.iter().collect(),
            Self::Range { from, to, by, .. } => vec![from, to, by],
        }
    }

    /// Whether there is one value and no list of them.
    pub fn is_single(&self) -> bool {
        matches!(self, Self::List(list) if list.len() == 1)
    }
}

/// A number of the distribution of traces.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Which.
    pub kind: MeasureKind,
    /// The formula or metric inside the parentheses.
    pub body: Expr,
    /// `in lo .. hi` after an expectation.
    pub range: Option<(Expr, Expr)>,
    /// Where.
    pub span: Span,
}

/// Probability, expectation, quantile, tail; a robustness is a metric inside of them.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasureKind {
    /// `P(φ)`
    Probability,
    /// `E(metric)`
    Expectation,
    /// `Q(level, metric)`
    Quantile(Expr),
    /// `CVaR(level, metric)`: the mean of what lies above the quantile
    Tail(Expr),
}

/// `by sprt(alpha = 0.01, beta = 0.01, indifference = 0.02)`
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: Ident,
    /// Named arguments.
    pub arguments: Vec<Binding>,
    /// Where.
    pub span: Span,
}

/// How sure, by which procedure, under which settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clauses {
    /// `within 0.01`
    pub within: Option<Expr>,
    /// The widths of further aims: `within 0.05, 2 s`
    pub within_others: Vec<Expr>,
    /// `confidence 95 %`
    pub confidence: Option<Expr>,
    /// `by okamoto(…)`
    pub by: Option<Method>,
    /// `under name = value, …` of check, estimate and rank.
    pub under: Vec<Binding>,
    /// `under every name` of check and rank, with values or with those from which the parameter chooses.
    pub every: Option<Every>,
}

/// `under every density in 0.2 /m^2, 0.8 /m^2`
#[derive(Clone, Debug, PartialEq)]
pub struct Every {
    /// The parameter.
    pub name: Ident,
    /// Its values, if they are written.
    pub values: Option<Vec<Expr>>,
    /// Where.
    pub span: Span,
}
