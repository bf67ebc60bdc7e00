//! Which procedure of `stats` compares the options of a ranking.

use crate::compile::study::{Beside, Role};
use crate::engine::fault::Fault;
use crate::engine::sampling::least::Least;
use crate::engine::sampling::procedure::goal;
use crate::engine::sampling::rank::{RankSetup, WORD};
use crate::stats::ranking::{
    Booleans, Bound, Constrained, Contest, Each, Front, Goal, Race, Ranking, Scores,
};

/// The procedure that compares the options.
pub(super) fn contest(setup: &RankSetup<'_>) -> Result<Box<dyn Contest>, Fault> {
    let (epsilon, delta, ranking) = setup.rule;
    let arms = setup.options.len();
    let deviations: Vec<f64> = setup.options.iter().map(|option| option.deviation).collect();
    let first = goal(&setup.kind).ok_or(Fault::Unsuitable)?;
    if !setup.beside.is_empty() {
        return beside(setup, (first, epsilon, delta), deviations);
    }
    // What is no mean of differences is known by intervals.
    if setup.models > 1 || matches!(first, Goal::Tail(..)) {
        return Ok(Box::new(Least::new((arms, setup.models), (epsilon, delta), first, deviations)?));
    }
    Ok(match (first, ranking) {
        (Goal::Probability, Ranking::Okamoto) => {
            Box::new(Each::new(arms, epsilon, delta, 8 * WORD)?.preferring(deviations))
        }
        (Goal::Probability, Ranking::Betting(allocation)) => {
            Box::new(Race::<Booleans>::new(arms, epsilon, delta, WORD, allocation)?.preferring(deviations))
        }
        (Goal::Mean(range), Ranking::Betting(allocation)) => {
            let scaled = epsilon / (range.1 - range.0);
            let race = Race::<Scores>::new(arms, scaled, delta, WORD, allocation)?;
            Box::new(race.over(range).preferring(deviations))
        }
        _ => return Err(Fault::Unsuitable),
    })
}

/// A ranking with constraints or further aims.
fn beside(
    setup: &RankSetup<'_>,
    (first, epsilon, delta): (Goal, f64, f64),
    deviations: Vec<f64>,
) -> Result<Box<dyn Contest>, Fault> {
    let (mut bounds, mut aims) = (Vec::new(), vec![(first, epsilon)]);
    for Beside { kind, role, .. } in setup.beside {
        let goal = goal(kind).ok_or(Fault::Unsuitable)?;
        match role {
            Role::Constraint { at_least, threshold, .. } => {
                bounds.push(Bound { goal, at_least: *at_least, threshold: *threshold });
            }
            Role::Aim { epsilon } => aims.push((goal, *epsilon)),
        }
    }
    Ok(if bounds.is_empty() {
        Box::new(Front::new(deviations.len(), &aims, delta, WORD)?)
    } else {
        Box::new(Constrained::new(first, bounds, (epsilon, delta), WORD, deviations)?)
    })
}
