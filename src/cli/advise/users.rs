//! Every person of a recording as the user in turn, who walks as advised: what the advice is worth.

use super::replay::{Followed, places, run};
use super::{AdviseCommand, Caller};
use crate::advise::{Adviser, role};
use crate::base::visible::visible;
use crate::cli::complaint;
use crate::cli::terminal::print;
use crate::data::tracks::Batch;
use crate::engine::Threads;
use crate::library::Parsed;
use crate::report::advised::{Advised, User, table_of_users};
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeSet;

/// Whoever is seen for less, s, or walks less, m, is no user.
const SHORTEST: f64 = 4.0;
const NEAREST: f64 = 3.0;
/// So long before a user comes, others are watched, s.
const BEFORE: f64 = 4.0;

/// Asks for each person who walks, and writes the table.
pub(super) fn everybody(
    arguments: &AdviseCommand,
    parsed: &Parsed,
    threads: &Threads,
    batches: &[Batch],
) -> Result<(), Vec<Diagnostic>> {
    let (from, to) = arguments.span();
    let ids: BTreeSet<u32> = batches.iter().flat_map(|batch| &batch.seen).filter_map(|one| one.id).collect();
    let mut users = Vec::new();
    for id in ids {
        let own = places(batches, id);
        let (Some(first), Some(last)) = (own.first(), own.last()) else { continue };
        let is_within = first.0 >= from && last.0 <= to;
        if !is_within || last.0 - first.0 < SHORTEST || (last.1 - first.1).norm() < NEAREST {
            continue;
        }
        let begin = batches.partition_point(|batch| batch.time < first.0 - BEFORE);
        let end = batches.partition_point(|batch| batch.time <= last.0);
        let adviser = Adviser::new(parsed.input(), role(&parsed.scenario)?, arguments.options(Some(id)));
        let (late, shown) = (Default::default(), Advised::default());
        let mut caller = Caller { arguments, adviser, threads, late, shown };
        let Followed { walked: [advised, recorded], cycles } =
            run(&mut caller, &batches[begin..end], (first.0, last.0), false)?;
        users.push(User { id, advised, recorded, cycles });
    }
    if users.is_empty() {
        let said = "nobody is seen for 4 s and walks 3 m between these times";
        return Err(complaint::argument(said, "choose other times, or another recording").into());
    }
    Ok(print(&visible(&table_of_users(&users, arguments.seed)))?)
}
