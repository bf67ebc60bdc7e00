//! How the options of a ranking are compared: the procedures of `stats`, fed with the cells of trials.

use crate::compile::study::{Beside, MeasureKind, Role};
use crate::engine::fault::Fault;
use crate::engine::sampling::least::Least;
use crate::engine::sampling::procedure::{goal, outcome, score, value};
use crate::engine::sampling::rank::{RankSetup, WORD};
use crate::stats::ranking::{
    Booleans, Bound, Choice, Constrained, Each, Front, Goal, Race, Ranking, Scores, Share,
};
use crate::stats::{Outcome, Running};
use crate::trials::cell::Cell;

/// How the options are compared.
#[allow(clippy::large_enum_variant, reason = "there is one at a time")]
pub(in crate::engine) enum Contest {
    Booleans(Race<Booleans>),
    Scores { race: Race<Scores>, range: (f64, f64) },
    Each(Each),
    Least(Least),
    Constrained(Constrained),
    Front(Front),
}

impl Contest {
    pub(in crate::engine) fn new(setup: &RankSetup<'_>) -> Result<Self, Fault> {
        let (epsilon, delta, ranking) = setup.rule;
        let arms = setup.options.len();
        let deviations: Vec<f64> = setup.options.iter().map(|option| option.deviation).collect();
        let first = goal(&setup.kind).ok_or(Fault::Unsuitable)?;
        if !setup.beside.is_empty() {
            return Self::beside(setup, (first, epsilon, delta), deviations);
        }
        // What is no mean of differences is known by intervals.
        if setup.models > 1 || matches!(first, Goal::Tail(..)) {
            return Ok(Self::Least(Least::new((arms, setup.models), (epsilon, delta), first, deviations)?));
        }
        Ok(match (first, ranking) {
            (Goal::Probability, Ranking::Okamoto) => {
                Self::Each(Each::new(arms, epsilon, delta, 8 * WORD)?.preferring(deviations))
            }
            (Goal::Probability, Ranking::Betting(allocation)) => {
                Self::Booleans(Race::new(arms, epsilon, delta, WORD, allocation)?.preferring(deviations))
            }
            (Goal::Mean(range), Ranking::Betting(allocation)) => {
                let scaled = epsilon / (range.1 - range.0);
                let race = Race::new(arms, scaled, delta, WORD, allocation)?.preferring(deviations);
                Self::Scores { race, range }
            }
            _ => return Err(Fault::Unsuitable),
        })
    }

    /// A ranking with constraints or further aims.
    fn beside(
        setup: &RankSetup<'_>,
        (first, epsilon, delta): (Goal, f64, f64),
        deviations: Vec<f64>,
    ) -> Result<Self, Fault> {
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
            Self::Front(Front::new(deviations.len(), &aims, delta, WORD)?)
        } else {
            Self::Constrained(Constrained::new(first, bounds, (epsilon, delta), WORD, deviations)?)
        })
    }

    pub(in crate::engine) fn next_round(&self) -> Vec<Share> {
        match self {
            Self::Booleans(race) => race.next_round().to_vec(),
            Self::Scores { race, .. } => race.next_round().to_vec(),
            Self::Each(each) => each.next_round().to_vec(),
            Self::Least(least) => least.next_round().to_vec(),
            Self::Constrained(constrained) => constrained.next_round().to_vec(),
            Self::Front(front) => front.next_round().to_vec(),
        }
    }

    pub(in crate::engine) fn finished(&self) -> bool {
        match self {
            Self::Booleans(race) => race.finished(),
            Self::Scores { race, .. } => race.finished(),
            Self::Each(each) => each.finished(),
            Self::Least(least) => least.finished(),
            Self::Constrained(constrained) => constrained.finished(),
            Self::Front(front) => front.finished(),
        }
    }

    pub(in crate::engine) fn choice(&mut self) -> Choice {
        match self {
            Self::Booleans(race) => race.choice(),
            Self::Scores { race, .. } => race.choice(),
            Self::Each(each) => each.choice(),
            Self::Least(least) => least.choice(),
            Self::Constrained(constrained) => constrained.choice(),
            Self::Front(front) => front.choice(),
        }
    }

    /// What is known of an option besides its score, and whether it satisfies the constraint, where it is one.
    pub(in crate::engine) fn side(&self, at: usize, arm: usize) -> Option<(&Running, Option<bool>)> {
        match self {
            Self::Constrained(constrained) => Some(constrained.side(at, arm)),
            Self::Front(front) => Some((front.side(at, arm), None)),
            _ => None,
        }
    }

    /// Takes the next cells of an option: those of its score, then those of each thing that is asked besides.
    pub(in crate::engine) fn feed(&mut self, arm: usize, columns: &[Vec<Cell>]) -> Result<(), Fault> {
        let [first, ..] = columns else { return Err(Fault::Unsuitable) };
        let outcomes = || first.iter().map(outcome).collect::<Vec<Outcome>>();
        let scores =
            || columns.iter().map(|cells| cells.iter().map(score).collect()).collect::<Vec<Vec<_>>>();
        match self {
            Self::Booleans(race) => race.feed(arm, &outcomes())?,
            Self::Each(each) => each.feed(arm, &outcomes())?,
            Self::Least(least) => least.feed(arm, first),
            Self::Scores { race, range } => {
                let scaled = |cell: &Cell| value(cell).map(|v| (v - range.0) / (range.1 - range.0));
                race.feed(arm, &first.iter().map(scaled).collect::<Vec<_>>())?;
            }
            Self::Constrained(constrained) => constrained.feed(arm, &scores())?,
            Self::Front(front) => front.feed(arm, &scores())?,
        }
        Ok(())
    }
}

/// Whether a kind of measure is compared by intervals alone.
pub(in crate::engine) fn is_by_intervals(kind: &MeasureKind) -> bool {
    kind.share().is_some()
}
