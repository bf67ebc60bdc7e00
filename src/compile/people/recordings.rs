//! Recordings as start states: who is chosen among those who are seen at a time.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    sighting::{Sighting, Tracks, agree},
    symbols::{Meaning, unknown},
};
use crate::compile::dimension::Dimension;
use crate::compile::people::{places, tracks::SHOWN_LINES};
use crate::model::Law;
use crate::syntax::ast::{Expr, Ident, Recorded, Whom};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeSet;
use std::collections::btree_map::Entry;

/// Who starts as was seen.
pub(crate) struct Chosen {
    /// Everybody, by ascending id; nobody where all who are named are out of sight.
    pub(crate) people: Vec<Sighting>,
    /// The groups in which they are, each by ascending id; who is in none is alone in one.
    pub(crate) parties: Vec<Vec<Sighting>>,
}

/// The tracks of a name.
fn named_tracks(context: &mut Context<'_>, name: &Ident) -> Lowered<usize> {
    match context.look_up(&name.name, 0) {
        Some((_, Meaning::Tracks(index))) => Ok(index),
        Some((_, Meaning::Doubtful)) => Err(Reported),
        Some((_, meaning)) => {
            let said = format!("expected a recording, but `{}` is {}", name.name, meaning.noun());
            context.report(error!(E0206, name.span, "{said}"))
        }
        None => {
            let recordings: Vec<String> = context.names.scopes[0]
                .entries()
                .filter(|(_, e)| matches!(e.meaning, Meaning::Tracks(_)))
                .map(|(n, _)| n.to_owned())
                .collect();
            let known = recordings.iter().map(String::as_str);
            context.report(unknown("recording", &name.name, name.span, Code::E0201, known))
        }
    }
}

/// The people of a recording at a time who are chosen; with `single`, one at most.
pub(crate) fn sighted(context: &mut Context<'_>, recorded: &Recorded, single: bool) -> Lowered<Chosen> {
    let time = context.number_of(&recorded.at, Dimension::TIME, &Locals::default());
    let whom = recorded.only.iter().chain(&recorded.except);
    let ids: Vec<Lowered<u32>> = whom.map(|whom| identity(context, &whom.id)).collect();
    let index = named_tracks(context, &recorded.tracks);
    let (time, ids, index) = (time?, ids.into_iter().collect::<Lowered<Vec<_>>>()?, index?);
    let Some(Some(tracks)) = context.tracks.known.get(index) else { return Err(Reported) };
    let mut found = tracks.at(time.value);
    let is_live = matches!(tracks, Tracks::Live { .. });
    let groups = match tracks {
        Tracks::Live { seen, .. } => seen.groups.clone(),
        Tracks::Recorded { .. } => context.tracks.grouping.map(|group| group(&found)).unwrap_or_default(),
    };
    agree(&mut found, &groups);
    if let (true, Tracks::Recorded { recording, .. }) = (found.is_empty(), tracks) {
        let near = recording.nearest_time(time.value);
        let hint = near.map_or("the recording is empty".to_owned(), |t| {
            format!("the nearest time with persons is {t} s")
        });
        let error = error!(E0703, recorded.at.span, "no person was recorded at this time");
        return context.report(error.hint(hint));
    }
    let named = recorded.only.iter().chain(&recorded.except).zip(&ids);
    let named: Vec<(&Whom, u32)> = named.map(|(whom, id)| (whom, *id)).collect();
    if !is_live {
        check_presence(context, &named, &found)?;
    }
    let mut sets = named.iter().map(|(whom, id)| {
        let group = groups.iter().find(|group| whom.is_group && group.contains(id));
        group.cloned().unwrap_or_else(|| vec![*id])
    });
    let only: BTreeSet<u32> = sets.by_ref().take(recorded.only.len()).flatten().collect();
    let except: BTreeSet<u32> = sets.flatten().collect();
    let is_chosen = |id: u32| (recorded.only.is_empty() || only.contains(&id)) && !except.contains(&id);
    let people: Vec<Sighting> = found.into_iter().filter(|one| is_chosen(one.id)).collect();
    if single && people.len() != 1 && !(is_live && people.is_empty()) {
        let said = format!("{} persons were recorded at this time, but one is needed", people.len());
        return context.report(error!(E0703, recorded.span, "{said}";
                hint: "choose one with `id`, or declare `agents`"));
    }
    for person in &people {
        match context.tracks.recorded.entry((index, person.id)) {
            Entry::Vacant(free) => {
                free.insert(recorded.span);
            }
            Entry::Occupied(first) => {
                let text = format!("person {} of `{}` is already used", person.id, recorded.tracks.name);
                let error = error!(E0703, recorded.span, "{text}")
                    .related(*first.get(), "first used here")
                    .hint(format!("exclude it: `except {}`", person.id));
                return context.report(error);
            }
        }
    }
    let parties = parties(&people, &groups);
    Ok(Chosen { people, parties })
}

/// Everybody who is named must be there, and be named once.
fn check_presence(context: &mut Context<'_>, named: &[(&Whom, u32)], found: &[Sighting]) -> Lowered<()> {
    let mut failed = false;
    for (whom, id) in named {
        if !found.iter().any(|one| one.id == *id) {
            let present: Vec<String> = found.iter().map(|one| one.id.to_string()).collect();
            let said = format!("person {id} was not recorded at this time");
            context.note(error!(E0703, whom.id.span, "{said}";
                    hint: "the recorded persons are {}", present.join(", ")));
            failed = true;
        }
    }
    if failed {
        return Err(Reported);
    }
    for (k, (whom, id)) in named.iter().enumerate() {
        if named[..k].iter().any(|(before, other)| other == id && before.is_group == whom.is_group) {
            let text = format!("person {id} is listed twice");
            return context.report(error!(E0703, whom.id.span, "{text}"));
        }
    }
    Ok(())
}

/// Puts those who were recorded in a barrier, or so near one that they could not start there, beside it.
pub(crate) fn onto_rims(
    context: &mut Context<'_>,
    recorded: &Recorded,
    mut found: Vec<Sighting>,
    radius: &Law,
) -> Vec<Sighting> {
    let barriers = places::solids(&context.scene.barriers);
    let (least, most) = radius.bounds();
    let room = if most.is_finite() { most } else { least };
    let mut moved = Vec::new();
    for person in &mut found {
        let Some((barrier, distance)) = places::in_the_way(&barriers, person.position, least) else {
            continue;
        };
        // Where there is no room beside it, the start is refused.
        let Some(p) = places::beside(&barriers, person.position, room) else { continue };
        let place = match distance {
            ..0.0 => format!("inside {}", barrier.phrase()),
            _ => format!("{distance:.3} m from {}", barrier.phrase()),
        };
        let by = (p - person.position).norm();
        let (id, x, y) = (person.id, p.x, p.y);
        moved.push(format!("person {id} was recorded {place} and starts {by:.3} m away at ({x:.3}, {y:.3})"));
        person.position = p;
    }
    if !moved.is_empty() {
        let title = match moved.len() {
            1 => "1 person was recorded inside or close to a barrier and starts beside it".to_owned(),
            many => {
                format!("{many} persons were recorded inside or close to barriers and start beside them")
            }
        };
        let more = moved.len().saturating_sub(SHOWN_LINES);
        moved.truncate(SHOWN_LINES);
        let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
        let warning = Diagnostic::warning(Code::W0701, recorded.span, title);
        context.note(warning.label(moved.join("; ") + &rest));
    }
    found
}

fn identity(context: &mut Context<'_>, expr: &Expr) -> Lowered<u32> {
    let number = context.number_of(expr, Dimension::NONE, &Locals::default())?;
    match number.as_whole().and_then(|n| u32::try_from(n).ok()) {
        Some(id) => Ok(id),
        None => context.report(error!(E0703, expr.span, "the id of a person must be a whole number")),
    }
}

/// Chosen people by groups, in the order of the first of each.
fn parties(people: &[Sighting], groups: &[Vec<u32>]) -> Vec<Vec<Sighting>> {
    let group = |id: u32| groups.iter().position(|group| group.contains(&id));
    let mut parties: Vec<(Option<usize>, Vec<Sighting>)> = Vec::new();
    for person in people {
        let own = group(person.id);
        match parties.iter_mut().find(|(other, _)| own.is_some() && *other == own) {
            Some((_, party)) => party.push(*person),
            None => parties.push((own, vec![*person])),
        }
    }
    parties.into_iter().map(|(_, party)| party).collect()
}
