//! Which trials stand behind the results of a run: those of the witnesses, and of each option of a ranking, side of a
//! comparison and point of a sweep the first few.

use crate::compile::study::{Ask, Query, Study, Target};
use crate::engine::answer::words;
use crate::engine::outcome::{CallResult, QueryResult, Witness};

/// How many trials of an option, a side or a point are shown.
pub const FIRST: u64 = 8;

/// A trial that stands behind results.
#[derive(Clone, Debug)]
pub(super) struct Pick {
    pub(super) world: usize,
    pub(super) advice: Option<(usize, usize)>,
    pub(super) trial: u64,
    /// What it is shown for.
    pub(super) reasons: Vec<Reason>,
}

/// Why a trial is shown.
#[derive(Clone, Debug)]
pub(super) struct Reason {
    /// Place of the result in the run.
    pub(super) result: usize,
    /// The column of its world.
    pub(super) column: usize,
    /// The option or side; empty where there is one.
    pub(super) label: String,
    /// Values of parameters that hold for it.
    pub(super) settings: Vec<(String, String)>,
    /// The witness, if it is known already.
    pub(super) witness: Option<Witness>,
}

/// Where trials of a result were run.
struct Arm {
    target: Target,
    advice: Option<(usize, usize)>,
    label: String,
    settings: Vec<(String, String)>,
    trials: u64,
}

/// The trials of a run that are shown, the most important first: all witnesses, then the first trial of each option, the
/// second of each, and so on.
pub(super) fn picks(study: &Study, run: &CallResult) -> Vec<Pick> {
    let mut ordered: Vec<(u64, Pick)> = Vec::new();
    for (place, result) in run.results.iter().enumerate() {
        let same = |query: &&Query| query.index == result.asked.index;
        let Some(query) =
            study.queries.iter().filter(same).find(|query| query.settings == result.asked.settings)
        else {
            continue;
        };
        let arms = arms(query, result);
        let pick = |arm: &Arm, trial: u64, witness: Option<Witness>| {
            let Arm { target, advice, label, settings, .. } = arm;
            let (label, settings) = (label.clone(), settings.clone());
            let reason = Reason { result: place, column: target.column, label, settings, witness };
            Pick { world: target.world, advice: *advice, trial, reasons: vec![reason] }
        };
        let chosen = result.rank.as_ref().and_then(|ranking| ranking.choice.as_ref());
        let seen = arms.iter().find(|arm| chosen.is_none_or(|choice| arm.label == *choice));
        for witness in &result.witnesses {
            ordered.extend(seen.map(|arm| (0, pick(arm, witness.trial, Some(witness.clone())))));
        }
        let is_swept = study.queries.iter().filter(same).count() > 1;
        let first = match (arms.len() > 1 || is_swept, result.witnesses.is_empty()) {
            (true, _) => FIRST,
            (false, true) => 1,
            (false, false) => 0,
        };
        for arm in &arms {
            ordered.extend((0..first.min(arm.trials)).map(|trial| (1 + trial, pick(arm, trial, None))));
        }
    }
    ordered.sort_by_key(|(order, _)| *order);
    let mut picks: Vec<Pick> = Vec::new();
    for (_, pick) in ordered {
        let same =
            |one: &&mut Pick| (one.world, one.advice, one.trial) == (pick.world, pick.advice, pick.trial);
        let Some(known) = picks.iter_mut().find(same) else {
            picks.push(pick);
            continue;
        };
        for reason in pick.reasons {
            let is_known = |one: &Reason| one.result == reason.result && one.label == reason.label;
            if !known.reasons.iter().any(is_known) {
                known.reasons.push(reason);
            }
        }
    }
    picks
}

fn arms(query: &Query, result: &QueryResult) -> Vec<Arm> {
    let trials = result.consumed.counts.trials;
    match &query.ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => vec![Arm {
            target: measure.target,
            advice: None,
            label: String::new(),
            settings: query.settings.clone(),
            trials,
        }],
        Ask::Compare { first, second, settings, .. } => {
            let side = |target: Target, own: &[(String, String)]| Arm {
                target,
                advice: None,
                label: words::settings(own),
                settings: [&query.settings, own].concat(),
                trials,
            };
            vec![side(first.target, &settings[0]), side(second.target, &settings[1])]
        }
        Ask::Rank { options, models, .. } => {
            let listed = result.rank.iter().flat_map(|ranking| &ranking.options);
            let trials = |label: &str, model: usize| {
                let listed = listed.clone().find(|option| option.label == label);
                listed.map_or(0, |option| {
                    option.under.get(model).map_or(option.counts, |side| side.counts).trials
                })
            };
            let arm = |(column, option): (usize, &crate::compile::study::RankOption)| Arm {
                target: option.target,
                advice: option.advice,
                label: option.label.clone(),
                settings: [query.settings.as_slice(), &option.settings].concat(),
                trials: trials(&option.label, column % models),
            };
            options.iter().enumerate().map(arm).collect()
        }
    }
}
