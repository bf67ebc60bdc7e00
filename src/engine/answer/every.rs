//! One result of those that were found under every value of a parameter.
//!
//! A check is satisfied where it is under each value, and violated where it is certainly violated under one. Its error is
//! shared: with k values each test has a k-th of it, so that all statements hold jointly.

use crate::compile::study::{self, Ask, Query, RankOption};
use crate::engine::answer::words;
use crate::engine::outcome::{Counts, Every, Interval, QueryResult, Ranking, UnderOne, Verdict};
use crate::engine::sampling::rank::RankOutcome;

/// The results of queries; those of one query under every value become one.
pub(in crate::engine) fn joined(asked: &[&Query], results: Vec<Option<QueryResult>>) -> Vec<QueryResult> {
    let mut out = Vec::new();
    let mut parts: Vec<(&Query, QueryResult)> = Vec::new();
    for (query, result) in asked.iter().zip(results) {
        let is_part = query.every.is_some() && matches!(query.ask, Ask::Check { .. });
        let starts = query.every.as_ref().is_some_and(|every| every.place == 0);
        if !is_part || starts {
            out.extend(check(&std::mem::take(&mut parts)));
        }
        match result {
            Some(result) if is_part => parts.push((query, result)),
            Some(result) => out.push(result),
            None => {}
        }
    }
    out.extend(check(&parts));
    out
}

/// One check of those under every value; `None` unless all were answered.
fn check(parts: &[(&Query, QueryResult)]) -> Option<QueryResult> {
    let (first, _) = parts.first()?;
    let (every, Ask::Check { at_least, .. }) = (first.every.as_ref()?, &first.ask) else { return None };
    if parts.len() < every.values.len() {
        return None;
    }
    let verdict = |at: usize| parts[at].1.verdict.unwrap_or(Verdict::Undecided);
    let all = |wanted| (0..parts.len()).all(|at| verdict(at) == wanted);
    let violated = (0..parts.len()).find(|at| verdict(*at) == Verdict::Violated);
    let whole = match violated {
        Some(_) => Verdict::Violated,
        None if all(Verdict::Satisfied) => Verdict::Satisfied,
        None => Verdict::Undecided,
    };
    let figure = |at: usize| {
        let estimate = parts[at].1.estimate.unwrap_or(f64::NAN);
        if *at_least { estimate } else { -estimate }
    };
    let rank = |at: usize| match verdict(at) {
        Verdict::Violated => 0,
        Verdict::Undecided => 1,
        Verdict::Satisfied => 2,
    };
    let least =
        (0..parts.len()).min_by(|a, b| rank(*a).cmp(&rank(*b)).then(figure(*a).total_cmp(&figure(*b))))?;
    let under = |at: usize| {
        let result = &parts[at].1;
        let (low, high) = (result.low, result.high);
        UnderOne {
            setting: (every.name.clone(), every.values[at].clone()),
            verdict: result.verdict,
            figure: Interval { estimate: result.estimate.unwrap_or(f64::NAN), low, high },
            counts: result.consumed.counts,
            best: None,
        }
    };
    let mut result = parts[least].1.clone();
    let error: f64 =
        parts.iter().filter_map(|(_, part)| part.certificate.as_ref()).map(|one| one.error).sum();
    result.every =
        Some(Every { name: every.name.clone(), least, parts: (0..parts.len()).map(under).collect() });
    result.verdict = Some(whole);
    result.asked.settings.retain(|(name, _)| *name != every.name);
    if let (Verdict::Satisfied, Some(certificate)) = (whole, &mut result.certificate) {
        let claim = result.certifies.split(", error at most").next().unwrap_or_default().to_owned();
        result.certifies =
            format!("{claim}, under every `{}`, error at most {}", every.name, words::error(error));
        certificate.error = error;
    } else if !result.certifies.is_empty() {
        let value = &every.values[least];
        result.certifies = format!("{}, under {} = {value}", result.certifies, every.name);
    }
    result.elapsed_s = parts.iter().map(|(_, part)| part.elapsed_s).fold(0.0, f64::max);
    Some(result)
}

/// What the choice of a ranking is worth under each value, and which option did best there.
pub(in crate::engine) fn of_ranking(
    every: &study::Every,
    ranked: &RankOutcome,
    options: &[RankOption],
    listed: &Ranking,
) -> Option<Every> {
    let models = every.values.len();
    listed.choice.as_ref()?;
    let chosen = listed.options.first()?;
    let under = |model: usize| {
        let columns = || (model..options.len()).step_by(models);
        let known = |column: &usize| ranked.tallies[*column].counts.trials > 0;
        let value = |column: &usize| ranked.values[*column].0;
        // By its lower end: of two that did well the one that is known better, so that luck in a few trials is not the best.
        let low = |column: &usize| ranked.values[*column].1.low;
        let is_chosen = |column: &usize| Some(&options[*column].label) == listed.choice.as_ref();
        let best = columns().filter(known).max_by(|a, b| {
            let by_known = low(a).total_cmp(&low(b)).then(value(a).total_cmp(&value(b)));
            by_known.then(is_chosen(a).cmp(&is_chosen(b))).then(b.cmp(a))
        });
        UnderOne {
            setting: (every.name.clone(), every.values[model].clone()),
            verdict: None,
            figure: chosen.under[model].value,
            counts: columns()
                .map(|column| ranked.tallies[column].counts)
                .fold(Counts::default(), Counts::and),
            best: best.map(|column| (options[column].label.clone(), value(&column))),
        }
    };
    let estimate = |model: &usize| chosen.under[*model].value.estimate;
    let least = (0..models).min_by(|a, b| estimate(a).total_cmp(&estimate(b)))?;
    Some(Every { name: every.name.clone(), least, parts: (0..models).map(under).collect() })
}
