//! A whole call: worlds made ready, queries put into groups that share trials, forecast, and run.

use super::answer::Answers;
use super::budget::{Budget, DEFAULT_TRIALS};
use super::contrast::{Contrast, Sides};
use super::executor::Executor;
use super::fault::Fault;
use super::flaw::Flaw;
use super::forecast::Glimpse;
use super::outcome::{Failure, QueryResult, Run, Stop};
use super::procedure::Procedure;
use super::race::{Contest, Field};
use super::room::all_placeable;
use super::splitting::Question;
use super::subject::Subject;
use super::survey::{Broken, Inquiry, Survey};
use super::tally::Tally;
use super::watch::{Outlook, Watch};
use crate::compile::study::{Ask, Estimator, Measure, MeasureKind, Query, Study};
use crate::stats::Levels;

/// What the command line adds to a study.
pub struct Call<'c> {
    /// Seed of all random numbers.
    pub seed: u64,
    /// The call up to its options, for replay lines: `smc check a.scn b.bltl --set density=0.8`.
    pub command: String,
    /// The same without sweeps.
    pub point: String,
    /// The call that shows a trial: `smc simulate a.scn --set density=0.8`.
    pub simulate: String,
    /// Indices of the queries to ask; all of them if empty.
    pub only: Vec<usize>,
    /// File and line of a span, for reports.
    pub place: &'c (dyn Fn(crate::syntax::source::Span) -> (String, usize) + Sync),
    /// Name for reports where the scenario has no title.
    pub file: String,
}

impl Call<'_> {
    /// The call that shows a trial under some settings: each takes the place of one of the call, and the last of several
    /// of one name holds.
    pub(super) fn simulate_with(&self, settings: &[(String, String)], trial: u64) -> String {
        let mut command = String::new();
        for (k, piece) in self.simulate.split(" --set ").enumerate() {
            let quoted = piece.strip_prefix('\'');
            let name = quoted.unwrap_or(piece).split('=').next().unwrap_or_default();
            if k > 0 && settings.iter().any(|(own, _)| own == name) {
                // What follows the value stays.
                let end = quoted.map_or_else(
                    || piece.find(' ').unwrap_or(piece.len()),
                    |rest| rest.find('\'').map_or(piece.len(), |at| at + 2),
                );
                command.push_str(&piece[end..]);
                continue;
            }
            if k > 0 {
                command.push_str(" --set ");
            }
            command.push_str(piece);
        }
        for (k, (name, value)) in settings.iter().enumerate() {
            if settings[k + 1..].iter().all(|(later, _)| later != name) {
                command.push_str(&format!(" --set '{name}={value}'"));
            }
        }
        format!("{command} --seed {} --trial {trial}", self.seed)
    }
}

/// Runs a study.
pub fn run(
    study: &Study,
    call: &Call<'_>,
    executor: &dyn Executor,
    budget: &Budget,
    watch: &dyn Watch,
) -> Result<Run, Fault> {
    let asked = asked(study, call);
    let subjects = subjects(study, &asked)?;
    let session = Session { call, budget, subjects: &subjects };
    let mut groups = session.groups(&asked)?;
    if let Some(outlook) = outlook(&mut groups, executor, budget)? {
        watch.forecast(&outlook);
    }
    let mut results: Vec<Option<QueryResult>> = asked.iter().map(|_| None).collect();
    let mut failure = None;
    let mut levels = Levels::default();
    for group in groups {
        let (found, broken) = session.answer(group, (executor, &mut levels), watch)?;
        for (k, result) in found {
            results[k] = Some(result);
        }
        // What was decided before stays decided.
        if let Some(flaw) = broken {
            failure = Some(Failure::Model(flaw));
            break;
        }
    }
    watch.finished();
    let results: Vec<QueryResult> = results.into_iter().flatten().collect();
    Ok(Run {
        scenario: if study.title.is_empty() { call.file.clone() } else { study.title.clone() },
        seed: call.seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        inputs: Vec::new(),
        diagnostics: Vec::new(),
        warnings: Vec::new(),
        interrupted: budget.is_interrupted(),
        failure,
        replay: again(call, budget, &results),
        results,
        elapsed_s: budget.elapsed(),
    })
}

/// The call that gives the same results again. Where the clock ended something, each query has its own.
fn again(call: &Call<'_>, budget: &Budget, results: &[QueryResult]) -> String {
    if results.iter().any(|r| matches!(r.stopped_by, Stop::Deadline | Stop::Interrupt)) {
        let each: Vec<&str> = results.iter().map(|r| r.replay.as_str()).collect();
        return each.join("\n");
    }
    let mut words = call.command.clone();
    for index in &call.only {
        words.push_str(&format!(" --only {index}"));
    }
    if budget.max_trials != DEFAULT_TRIALS {
        words.push_str(&format!(" --max-trials {}", budget.max_trials));
    }
    if let Some(total) = budget.max_total {
        words.push_str(&format!(" --total-trials {total}"));
    }
    format!("{words} --seed {}", call.seed)
}

/// What a study is likely to take, from the first trials of each of its queries.
pub fn forecast(
    study: &Study,
    call: &Call<'_>,
    executor: &dyn Executor,
    budget: &Budget,
) -> Result<Outlook, Fault> {
    let asked = asked(study, call);
    let subjects = subjects(study, &asked)?;
    let session = Session { call, budget, subjects: &subjects };
    let mut groups = session.groups(&asked)?;
    Ok(outlook(&mut groups, executor, budget)?.unwrap_or_default())
}

fn asked<'s>(study: &'s Study, call: &Call<'_>) -> Vec<&'s Query> {
    study.queries.iter().filter(|q| call.only.is_empty() || call.only.contains(&q.index)).collect()
}

/// The worlds that are asked about, made ready.
fn subjects(study: &Study, asked: &[&Query]) -> Result<Vec<Option<Subject>>, Fault> {
    all_placeable(study, asked)?;
    let mut subjects: Vec<Option<Subject>> = study.worlds.iter().map(|_| None).collect();
    for query in asked {
        for world in worlds(&query.ask) {
            if subjects[world].is_none() {
                subjects[world] = Subject::of(study, world);
            }
        }
    }
    Ok(subjects)
}

/// Rehearses each group. With a deadline there is nothing to forecast, and no time to spend on it.
fn outlook(
    groups: &mut [Group<'_>],
    executor: &dyn Executor,
    budget: &Budget,
) -> Result<Option<Outlook>, Fault> {
    if budget.has_deadline() {
        return Ok(None);
    }
    let mut outlook = Outlook::default();
    for group in groups {
        if budget.is_interrupted() {
            return Ok(None);
        }
        let forecasts = match &mut group.sampling {
            Sampling::Survey(survey) => survey.rehearse(executor, budget)?,
            Sampling::Contrast(contrast) => vec![contrast.rehearse(executor, budget)?],
            Sampling::Race(contest) => vec![contest.rehearse(executor, budget)?],
            Sampling::Split(question) => vec![question.rehearse(executor, budget)?],
        };
        // Checks and estimates of one scenario share their trials.
        outlook.seconds += forecasts.iter().map(|f| f.seconds).fold(0.0, f64::max);
        outlook.queries.extend(forecasts);
    }
    Ok(Some(outlook))
}

/// Queries that are answered together, by their places among those asked.
struct Group<'q> {
    places: Vec<usize>,
    sampling: Sampling<'q>,
}

/// How they are answered.
#[allow(clippy::large_enum_variant, reason = "there are as many as queries")]
enum Sampling<'q> {
    Survey(Survey<'q>),
    Contrast(Contrast<'q>),
    Race(Contest<'q>),
    Split(Question<'q>),
}

pub(super) fn worlds(ask: &Ask) -> Vec<usize> {
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } | Ask::Rank { measure, .. } => {
            vec![measure.target.world]
        }
        Ask::Compare { first, second, .. } => vec![first.target.world, second.target.world],
    }
}

fn surveyed(ask: &Ask) -> Option<usize> {
    match ask {
        Ask::Estimate { estimator: Estimator::Splitting(_), .. } => None,
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => Some(measure.target.world),
        Ask::Compare { .. } | Ask::Rank { .. } => None,
    }
}

/// Gives what a procedure refuses the place of its query.
fn refused(query: &Query) -> impl Fn(Fault) -> Fault {
    let place = query.span;
    move |fault| match fault {
        Fault::Statistics(reason) => Fault::Procedure { place, reason },
        other => other,
    }
}

/// The range of an expectation.
fn range(measure: &Measure) -> Option<(f64, f64)> {
    match measure.kind {
        MeasureKind::Expectation { range, .. } => Some(range),
        _ => None,
    }
}

/// Results by the places of their queries, and what was wrong with the model.
type Answered = (Vec<(usize, QueryResult)>, Option<Box<Flaw>>);

/// What is wrong with the model, if the fault is one of it.
fn flaw(fault: Fault) -> Result<Box<Flaw>, Fault> {
    match fault {
        Fault::Model(flaw) => Ok(flaw),
        fault => Err(fault),
    }
}

struct Session<'a> {
    call: &'a Call<'a>,
    budget: &'a Budget,
    subjects: &'a [Option<Subject>],
}

impl<'a> Session<'a> {
    fn subject(&self, world: usize) -> Result<&'a Subject, Fault> {
        self.subjects.get(world).and_then(Option::as_ref).ok_or(Fault::Unsuitable)
    }

    /// The queries in groups, in the order in which the first of each was written.
    fn groups<'q>(&self, asked: &[&'q Query]) -> Result<Vec<Group<'q>>, Fault>
    where
        'a: 'q,
    {
        let mut groups = Vec::new();
        let mut taken = vec![false; asked.len()];
        for (at, &query) in asked.iter().enumerate() {
            if taken[at] {
                continue;
            }
            let (places, sampling) = match &query.ask {
                Ask::Estimate { measure, estimator: Estimator::Splitting(rule) } => {
                    let subject = self.subject(measure.target.world)?;
                    let question =
                        Question::new(query, subject, measure.target.column, *rule, self.call.seed);
                    (vec![at], Sampling::Split(question))
                }
                Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => {
                    // All checks and estimates of a world read the same trials.
                    let world = measure.target.world;
                    let together: Vec<usize> =
                        (at..asked.len()).filter(|&k| surveyed(&asked[k].ask) == Some(world)).collect();
                    for &k in &together {
                        taken[k] = true;
                    }
                    let inquiries = together
                        .iter()
                        .map(|&k| self.inquiry(asked[k]).map_err(refused(asked[k])))
                        .collect::<Result<_, _>>()?;
                    (together, Sampling::Survey(Survey::new(self.subject(world)?, inquiries, self.call.seed)))
                }
                Ask::Compare { .. } => {
                    (vec![at], Sampling::Contrast(self.contrast(query).map_err(refused(query))?))
                }
                Ask::Rank { .. } => (vec![at], Sampling::Race(self.contest(query).map_err(refused(query))?)),
            };
            groups.push(Group { places, sampling });
        }
        Ok(groups)
    }

    fn inquiry<'q>(&self, query: &'q Query) -> Result<Inquiry<'q>, Fault> {
        let (Ask::Check { measure, .. } | Ask::Estimate { measure, .. }) = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        Ok(Inquiry {
            query,
            column: measure.target.column,
            range: range(measure),
            procedure: Procedure::new(&query.ask, self.call.seed)?,
            tally: Tally::default(),
            glimpse: Glimpse::default(),
            waits: false,
            lost: false,
            stop: None,
            seconds: 0.0,
        })
    }

    fn contrast<'q>(&self, query: &'q Query) -> Result<Contrast<'q>, Fault>
    where
        'a: 'q,
    {
        let Ask::Compare { first, second, within, delta, .. } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let sides = Sides {
            subjects: [self.subject(first.target.world)?, self.subject(second.target.world)?],
            columns: [first.target.column, second.target.column],
        };
        Contrast::new(query, &sides, &first.kind, (*within, *delta), self.call.seed)
    }

    fn contest<'q>(&self, query: &'q Query) -> Result<Contest<'q>, Fault>
    where
        'a: 'q,
    {
        let Ask::Rank { moves, measure, epsilon, delta, ranking } = &query.ask else {
            return Err(Fault::Unsuitable);
        };
        let subject = self.subject(measure.target.world)?;
        let declared = &subject.program.scenario.moves[*moves];
        let field = Field {
            subject,
            moves: *moves,
            deviations: declared.options.iter().map(|(_, m)| m.deviation()).collect(),
            column: measure.target.column,
            kind: measure.kind.clone(),
            rule: (*epsilon, *delta, *ranking),
        };
        Contest::new(query, field, self.call.seed)
    }

    /// The results of a group, by the places of its queries; and what was wrong with the model, if a trial
    /// showed that it is.
    fn answer(
        &self,
        group: Group<'_>,
        (executor, levels): (&dyn Executor, &mut Levels),
        watch: &dyn Watch,
    ) -> Result<Answered, Fault> {
        let Group { mut places, sampling } = group;
        let answers = Answers { call: self.call, budget: self.budget };
        let mut broken = None;
        let results = match sampling {
            Sampling::Survey(mut survey) => {
                if let Some(Broken { index, fault }) = survey.run((executor, levels), self.budget, watch)? {
                    broken = Some(flaw(fault)?);
                    // Those that had stopped before that trial do not know of it.
                    let mut decided = survey.inquiries.iter().map(|inquiry| inquiry.stopped_before(index));
                    places.retain(|_| decided.next().unwrap_or(false));
                    survey.inquiries.retain(|inquiry| inquiry.stopped_before(index));
                }
                answers.survey(survey)
            }
            Sampling::Contrast(contrast) => answers.contrast(contrast, executor, watch).map(|one| vec![one]),
            Sampling::Race(contest) => answers.race(contest, executor, watch).map(|one| vec![one]),
            Sampling::Split(question) => answers.split(&question, executor, watch).map(|one| vec![one]),
        };
        match results {
            Ok(results) => Ok((places.into_iter().zip(results).collect(), broken)),
            Err(fault) => Ok((Vec::new(), Some(flaw(fault)?))),
        }
    }
}
