//! Exit codes of the program.

use crate::engine::outcome::{CallResult, Failure, Verdict};

/// The exit code of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitCode {
    /// Every `check` is satisfied, everything was computed.
    Success = 0,
    /// A query other than a `check` was not begun or is incomplete, for lack of time or trials.
    Incomplete = 4,
    /// A `check` is undecided within the budget, and none is violated.
    Undecided = 3,
    /// A `check` is violated.
    Violated = 1,
    /// Interrupted; what is known so far was printed.
    Interrupted = 130,
    /// The call, an input or the model is wrong.
    Wrong = 2,
    /// A bug in `smc`.
    Bug = 70,
}

impl ExitCode {
    /// The number.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The one of two that counts: 70 > 2 > 130 > 1 > 3 > 4 > 0.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        use ExitCode::{Bug, Incomplete, Interrupted, Success, Undecided, Violated, Wrong};
        let order = [Bug, Wrong, Interrupted, Violated, Undecided, Incomplete];
        order.into_iter().find(|one| [self, other].contains(one)).unwrap_or(Success)
    }
}

/// The exit code of a run. Only a `check` can make it 1 or 3, and only another query 4.
pub fn exit_code(run: &CallResult) -> ExitCode {
    let start = match &run.failure {
        Some(Failure::Bug(_)) => ExitCode::Bug,
        Some(Failure::Input(_) | Failure::Model(_)) => ExitCode::Wrong,
        Some(Failure::Late(_)) => ExitCode::Undecided,
        None if run.interrupted => ExitCode::Interrupted,
        None => ExitCode::Success,
    };
    run.results.iter().fold(start, |code, result| {
        code.worse(match result.verdict {
            Some(Verdict::Violated) => ExitCode::Violated,
            Some(Verdict::Undecided) => ExitCode::Undecided,
            None if result.shortfall().is_some() => ExitCode::Incomplete,
            Some(Verdict::Satisfied) | None => ExitCode::Success,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::outcome::{AskedQuery, Kind, QueryResult, Stop};

    fn run(verdicts: &[Option<Verdict>], interrupted: bool, failure: Option<Failure>) -> u8 {
        let results = verdicts
            .iter()
            .map(|&verdict| QueryResult {
                verdict,
                ..QueryResult::new(AskedQuery::new(0, Kind::Check, "check"))
            })
            .collect();
        exit_code(&CallResult { results, interrupted, failure, ..CallResult::default() }).code()
    }

    #[test]
    fn the_order_is_70_2_130_1_3_4_0() {
        use Verdict::{Satisfied, Undecided, Violated};
        let all = [Some(Satisfied), Some(Undecided), Some(Violated), None];
        assert_eq!(run(&all, true, Some(Failure::Bug(String::new()))), 70);
        assert_eq!(run(&all, true, Some(Failure::Input(String::new()))), 2);
        assert_eq!(run(&all, true, None), 130);
        assert_eq!(run(&all, false, None), 1);
        assert_eq!(run(&all[..2], false, None), 3);
        assert_eq!(run(&all[..1], false, None), 0);
        assert_eq!(run(&[None], false, None), 0);
        let short = |verdict| QueryResult {
            verdict,
            stopped_by: Stop::Cap,
            ..QueryResult::new(AskedQuery::new(0, Kind::Check, ""))
        };
        let of = |list: &[Option<Verdict>]| {
            exit_code(&CallResult {
                results: list.iter().map(|v| short(*v)).collect(),
                ..CallResult::default()
            })
            .code()
        };
        assert_eq!([of(&[None]), of(&[Some(Satisfied), None]), of(&[Some(Undecided), None])], [4, 4, 3]);
    }
}
