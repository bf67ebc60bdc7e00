//! `--move`: the option of moves that is followed in a trial.

use crate::cli::complaint;
use crate::compile::nearest::nearest;
use crate::model::Scenario;
use crate::syntax::diagnostic::Diagnostic;

/// The option of a name, with whose it is where several people have one of that name: `stop`, `user: stop`.
///
/// # Errors
/// Where there is no such option, or several have the name.
pub(super) fn option(scenario: &Scenario, name: &str) -> Result<(usize, usize), Diagnostic> {
    let wanted = name.trim();
    let all = || {
        let declarations = scenario.moves.iter().enumerate();
        declarations
            .flat_map(|(declaration, moves)| (0..moves.options.len()).map(move |at| (declaration, at)))
    };
    // A path is known by its number, too: its length depends on the roadmap.
    let is_meant = |name: &str| {
        name == wanted
            || name.strip_prefix(wanted).is_some_and(|rest| wanted.contains("path") && rest.starts_with(" ("))
    };
    if let Some(found) = all().find(|of| scenario.move_name(*of).is_some_and(|name| is_meant(&name))) {
        return Ok(found);
    }
    let label = |(declaration, at): (usize, usize)| scenario.moves[declaration].options[at].0.as_str();
    let same: Vec<String> = all()
        .filter(|of| is_meant(label(*of)))
        .filter_map(|of| Some(format!("`{}`", scenario.move_name(of)?)))
        .collect();
    if !same.is_empty() {
        return Err(complaint::argument(
            format!("several agents have a move `{wanted}`"),
            format!("write one of {}", same.join(", ")),
        ));
    }
    let labels: Vec<String> = all().filter_map(|of| scenario.move_name(of)).collect();
    let hint = match nearest(wanted, labels.iter().map(String::as_str)) {
        _ if labels.is_empty() => "the scenario declares no moves".to_owned(),
        // Of numbers that differ, none is meant more than another.
        Some(near) if !wanted.contains(|c: char| c.is_ascii_digit()) => format!("did you mean `{near}`?"),
        _ => format!("the moves are {}", labels.join(", ")),
    };
    Err(complaint::argument(format!("unknown move `{wanted}`"), hint))
}
