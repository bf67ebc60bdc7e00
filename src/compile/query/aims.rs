//! What rankings ask besides one score: constraints (`subject to`) and further aims (`pareto`).

use crate::compile::context::{Context, Locals, Lowered, Reported, symbols::ScopeId};
use crate::compile::query::{
    checks::{self, Claim, unlike},
    clauses,
    compiler::Compiler,
    measures::{self, Sketch, What},
};
use crate::compile::query::{methods, titles};
use crate::compile::study::{Beside, MeasureKind, Role};
use crate::syntax::ast::{self, BinaryOp, Clauses, Constraint, Expr, QueryKind};

/// What a ranking asks besides its score.
pub(crate) enum Others<'a> {
    /// What each option has to satisfy.
    Subject(&'a [Constraint]),
    /// In what else more is better.
    Aims(&'a [ast::Measure]),
}

/// What is asked besides, with its column in each world.
type Asked = Vec<(Beside, Vec<usize>)>;

/// That a query has no more than one width, unless it has several aims.
pub(crate) fn one_width(context: &mut Context<'_>, query: &ast::Query) -> Lowered<()> {
    match query.clauses.within_others.first() {
        Some(other) if !matches!(query.kind, QueryKind::Pareto { .. }) => context
            .report(error!(E0612, other.span, "only `pareto` has several widths, one for each aim";
                hint: "write one width: `within …`")),
        _ => Ok(()),
    }
}

/// What a ranking asks of its options besides its score, in each of their worlds.
pub(crate) fn beside(
    compiler: &mut Compiler<'_>,
    worlds: (usize, &[usize]),
    (first, others): (&ast::Measure, &Others<'_>),
    clauses: &Clauses,
    scope: ScopeId,
) -> Lowered<Asked> {
    let context = &mut compiler.sites[worlds.0].context;
    let is_plain = matches!(others, Others::Subject([]));
    if let (Some(method), false) = (&clauses.by, is_plain) {
        return context.report(
            error!(E0612, method.span, "a ranking with constraints or several aims has its own procedure";
            hint: "leave `by {}` out", method.name.name),
        );
    }
    match others {
        Others::Subject(subject) => {
            subject.iter().map(|one| constraint(compiler, worlds, one, scope)).collect()
        }
        Others::Aims([]) => context.report(error!(E0612, first.span, "`pareto` needs two aims at least";
                hint: "write another aim behind a comma, or `rank … by` for one")),
        Others::Aims(aims) => {
            let widths: Vec<&Expr> = clauses.within.iter().chain(&clauses.within_others).collect();
            if let Some(more) = widths.get(aims.len() + 1) {
                return context.report(
                    error!(E0612, more.span, "there are more widths than aims"; hint: "remove this one"),
                );
            }
            let each = aims.iter().enumerate();
            each.map(|(at, aim)| {
                let width = widths.get(at + 1).copied();
                self::aim(compiler, worlds, (aim, width), scope)
            })
            .collect()
        }
    }
}

/// A measure in each world, all of one kind.
fn alike(
    compiler: &mut Compiler<'_>,
    (site, worlds): (usize, &[usize]),
    measure: &ast::Measure,
    scope: ScopeId,
) -> Lowered<(MeasureKind, Vec<usize>, Sketch)> {
    let (mut columns, mut kinds, mut sketch) = (Vec::new(), Vec::new(), Sketch::PROBABILITY);
    for world in worlds {
        let (measured, known) = compiler.measured(*world, measure, scope);
        let (measured, _) = measured?;
        columns.push(measured.target.column);
        kinds.push(measured.kind);
        sketch = known;
    }
    same(compiler, (site, worlds), measure, &kinds)?;
    let Some(kind) = kinds.into_iter().next() else { return Err(Reported) };
    Ok((kind, columns, sketch))
}

/// That the kinds of a measure do not differ between worlds.
fn same(
    compiler: &mut Compiler<'_>,
    (site, worlds): (usize, &[usize]),
    measure: &ast::Measure,
    kinds: &[MeasureKind],
) -> Lowered<()> {
    let Some(at) = kinds.iter().position(|kind| *kind != kinds[0]) else { return Ok(()) };
    let settings = |world: usize| {
        let own = &compiler.sites[world].settings;
        compiler.described(world, own, &own.keys().map(String::as_str).collect::<Vec<_>>())
    };
    let settings = [settings(worlds[0]), settings(worlds[at])];
    let error = unlike(measure, "all options of a ranking need", [&kinds[0], &kinds[at]], &settings);
    compiler.sites[site].context.report(error)
}

/// A further aim, with its width.
fn aim(
    compiler: &mut Compiler<'_>,
    worlds: (usize, &[usize]),
    (measure, width): (&ast::Measure, Option<&Expr>),
    scope: ScopeId,
) -> Lowered<(Beside, Vec<usize>)> {
    let (kind, columns, sketch) = alike(compiler, worlds, measure, scope)?;
    let context = &mut compiler.sites[worlds.0].context;
    if sketch.what == What::Quantile {
        let error = error!(E0607, measure.span, "a ranking accepts only `P(…)`, `E(…)` and `CVaR(…)`");
        return context.report(error);
    }
    let locals = Locals::of(scope);
    let stated =
        width.map(|expr| methods::positive(context, expr, sketch, &locals).map(|width| (width, expr.span)));
    let epsilon = clauses::loss(context, stated.transpose()?, sketch, measure.span)?;
    let said = titles::said(context, measure, None).measure;
    Ok((Beside { said, kind, role: Role::Aim { epsilon } }, columns))
}

/// A constraint: decided as a check is.
fn constraint(
    compiler: &mut Compiler<'_>,
    (site, worlds): (usize, &[usize]),
    Constraint { measure, relation, threshold }: &Constraint,
    scope: ScopeId,
) -> Lowered<(Beside, Vec<usize>)> {
    let locals = Locals::of(scope);
    let (mut columns, mut kinds, mut claims) = (Vec::new(), Vec::new(), Vec::new());
    for world in worlds {
        let context = &mut compiler.sites[*world].context;
        let (observed, sketch) = measures::measure(context, measure, scope);
        let bound = checks::bound_of(context, *relation, threshold, sketch, &locals);
        let Claim { column, kind, at_least, threshold: limit, .. } =
            checks::claim(context, observed?, *relation, (bound?, threshold.span))?;
        columns.push(compiler.column(*world, column));
        kinds.push(kind);
        claims.push((at_least, limit));
    }
    same(compiler, (site, worlds), measure, &kinds)?;
    let context = &mut compiler.sites[site].context;
    let (Some(kind), Some(&(at_least, limit))) = (kinds.into_iter().next(), claims.first()) else {
        return Err(Reported);
    };
    if claims.iter().any(|claim| *claim != (at_least, limit)) {
        return context
            .report(error!(E0612, threshold.span, "the bound of a constraint is the same for all options";
            hint: "write a bound that depends on none of the ranked parameters"));
    }
    let said = titles::said(context, measure, None).measure;
    let text = format!("{} {}", sign(*relation), context.text(threshold.span));
    Ok((Beside { said, kind, role: Role::Constraint { at_least, threshold: limit, text } }, columns))
}

/// A relation as it is written.
pub(crate) const fn sign(relation: BinaryOp) -> &'static str {
    match relation {
        BinaryOp::Less => "<",
        BinaryOp::AtMost => "<=",
        BinaryOp::Greater => ">",
        _ => ">=",
    }
}
