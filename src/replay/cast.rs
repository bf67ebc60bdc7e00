//! Who is who: the user of a model, and whether everybody else is declared by a part that somebody else can play.

use super::Diagnosed;
use crate::advise::{Role, role};
use crate::syntax::ast::{Ident, Item, Recorded, ScenarioFile, Whom};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// The parts of a model that is compared with a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cast {
    /// The id of the user as the model writes it.
    pub person: u32,
    /// The first place where somebody else is declared by an id; then nobody but that user can be the user.
    named: Option<Span>,
}

impl Cast {
    /// The parts of a scenario all of whose people are in the tracks of a name. The user is the one with the moves, or the
    /// first `agent` with an id.
    ///
    /// # Errors
    /// Where something of the model is in no recording, or nobody is the user.
    pub fn of(file: &ScenarioFile, tracks: &str) -> Diagnosed<Self> {
        let mut wrong = Vec::new();
        let mut people: Vec<(&Ident, &Recorded)> = Vec::new();
        for item in &file.items {
            let (name, recorded) = match item {
                Item::Agents(decl) => (&decl.name, decl.recorded.as_ref()),
                Item::Group(decl) => (&decl.name, decl.recorded.as_ref()),
                Item::Process(decl) => (&decl.name, None),
                Item::Behaviour(decl) => (&decl.name, None),
                Item::Source(decl) => (&decl.name, None),
                Item::Program(decl) => (&decl.process.name, None),
                _ => continue,
            };
            match recorded.filter(|recorded| recorded.tracks.name == tracks) {
                Some(recorded) => people.push((name, recorded)),
                None => {
                    let said = format!("`{}` is not in the recording `{tracks}`", name.name);
                    let hint = "what was never recorded cannot be compared with a recording: remove it";
                    wrong.push(error!(E0709, name.span, "{said}"; hint: "{hint}"));
                }
            }
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let person = user(file, &people).map_err(|error| vec![error])?.person;
        let by_id = |whom: &&Whom| !whom.is_group && crate::advise::id(&whom.id) != Some(person);
        let all = people.iter().flat_map(|(_, recorded)| recorded.only.iter().chain(&recorded.except));
        Ok(Self { person, named: all.into_iter().find(by_id).map(|whom| whom.id.span) })
    }

    /// Whether anybody can be the user.
    ///
    /// # Errors
    /// Where others are declared by their ids.
    pub fn is_open(&self) -> Result<(), Diagnostic> {
        self.named.map_or(Ok(()), |span| {
            let said = "with another user, nobody knows who plays the part of this person";
            let hint = "declare others by their part: `group of`, `except group of`";
            Err(error!(E0709, span, "{said}"; hint: "{hint}"))
        })
    }
}

/// The user: who has the moves, or the first who is declared by one id.
fn user(file: &ScenarioFile, people: &[(&Ident, &Recorded)]) -> Result<Role, Diagnostic> {
    if file.items.iter().any(|item| matches!(item, Item::Moves(_))) {
        return role(file);
    }
    let single = |(_, recorded): &(&Ident, &Recorded)| match recorded.only.as_slice() {
        [one] if !one.is_group => crate::advise::id(&one.id),
        _ => None,
    };
    let tracks = people.first().map_or(String::new(), |(_, recorded)| recorded.tracks.name.clone());
    match people.iter().find_map(single) {
        Some(person) => Ok(Role { tracks, person, is_group: false }),
        None => {
            let error = Diagnostic::placeless(Code::E0709, "nobody in the model is the user");
            Err(error.hint("declare one: `agent user: adult from hotel at 646.8 s id 367`"))
        }
    }
}
