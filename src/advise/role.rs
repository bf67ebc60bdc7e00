//! Who is advised: the agent, or the body of a group, to whom the moves of a scenario belong.

use crate::syntax::ast::{Expr, ExprKind, Item, MovesDecl, Recorded, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;

/// Who is advised, as the scenario writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Role {
    /// Name of the tracks in which this person is seen.
    pub tracks: String,
    /// Id of the person in the scenario.
    pub person: u32,
    /// Whether the moves belong to the body of this person's group.
    pub is_group: bool,
}

/// Who is advised by the first moves of a scenario.
///
/// # Errors
/// Where there are no moves, or they belong to somebody who is in no tracks, or is one of several.
pub fn role(file: &ScenarioFile) -> Result<Role, Diagnostic> {
    let moves = file.items.iter().find_map(|item| match item {
        Item::Moves(moves) => Some(moves),
        _ => None,
    });
    let Some(moves) = moves else {
        let error = Diagnostic::placeless(Code::E0406, "the scenario has no moves to advise");
        return Err(
            error.hint("write `moves user for 1.6 s { heading from -60 deg to 60 deg by 15 deg; stop }`")
        );
    };
    let declared = file.items.iter().find_map(|item| match item {
        Item::Agents(decl) if decl.name.name == moves.agent.name => Some(&decl.recorded),
        Item::Group(decl) if decl.name.name == moves.agent.name => Some(&decl.recorded),
        _ => None,
    });
    match declared {
        Some(Some(recorded)) => of(moves, recorded),
        _ => {
            let said = format!("`{}` is in no tracks and cannot be advised", moves.agent.name);
            let hint = "declare the agent from tracks: `agent user: adult from here at 0 s id 1`";
            Err(error!(E0406, moves.agent.span, "{said}"; hint: "{hint}"))
        }
    }
}

fn of(moves: &MovesDecl, recorded: &Recorded) -> Result<Role, Diagnostic> {
    let tracks = recorded.tracks.name.clone();
    match recorded.only.as_slice() {
        [one] if moves.member.is_none() => match id(&one.id) {
            Some(person) => Ok(Role { tracks, person, is_group: one.is_group }),
            None => {
                let said = "the id of the person who is advised must be written as a number";
                Err(error!(E0406, one.id.span, "{said}"; hint: "write for example `id 367`"))
            }
        },
        _ => {
            let said = format!("`{}` does not name one person", moves.agent.name);
            let hint = "write `id 367` or `group of 367` behind the time";
            Err(error!(E0406, recorded.span, "{said}"; hint: "{hint}"))
        }
    }
}

/// The id of a person, written as a number.
pub fn id(expr: &Expr) -> Option<u32> {
    match &expr.kind {
        ExprKind::Quantity(quantity) if quantity.unit.is_none() => {
            let value = quantity.value.to_f64();
            (value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value)).then_some(value as u32)
        }
        _ => None,
    }
}
