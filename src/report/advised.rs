//! A replay with advice as a page: the advice of each cycle, and a player with the people of the recording.

use crate::advise::{Advice, Walked};
use crate::base::geometry::Vec2;
use crate::base::math::median;
use crate::data::tracks::Batch;
use crate::engine::outcome::{CallResult, Interval};
use crate::engine::traces::{Traces, Walk, recorded};
use crate::model::Scene;
use crate::perception::{ConstantVelocity, Inferring, infer};
use crate::report::html::{Page, Table};
use crate::report::infer::traces;
use crate::report::number::{count, counted, interval, plain, thousandths};
use crate::stats::bootstrap::{Bootstrap, DRAWS};
use crate::syntax::source::Source;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Whoever is unseen for longer is another walk, s.
const LONGEST: f64 = 2.0;

/// What a replay gave.
#[derive(Clone, Debug, Default)]
pub struct Advised {
    /// Title of the model, or its file.
    pub title: String,
    /// Its walls and regions.
    pub scene: Scene,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Id of the user.
    pub user: u32,
    /// The batches that were answered, as recorded.
    pub batches: Vec<Batch>,
    /// The advice of each cycle.
    pub cycles: Vec<Advice>,
    /// Where the user walked as advised, at which times; empty where the user walked as recorded.
    pub followed: Vec<(f64, Vec2)>,
    /// What the user did as advised and as recorded, where the user followed.
    pub end: Option<[Walked; 2]>,
}

/// A user of a recording who walked as advised.
#[derive(Clone, Copy, Debug)]
pub struct User {
    /// Who.
    pub id: u32,
    /// What this person did as advised.
    pub advised: Walked,
    /// What this person did as recorded.
    pub recorded: Walked,
    /// Cycles, those with a move, those of which it is known whether the user moved as advised, and those in which that was so.
    pub cycles: [u64; 4],
}

/// A number of a walk.
type Measure = (&'static str, fn(&Walked) -> Option<f64>);

/// What the advice is worth: medians over users with intervals by bootstrap over them.
pub fn table_of_users(users: &[User], seed: u64) -> String {
    let bootstrap = Bootstrap { persons: users.len(), draws: DRAWS, seed, confidence: 0.95 };
    let mut out = format!("{} of the recording\n\n", counted(users.len() as u64, "user"));
    let _ = writeln!(
        out,
        "{:<28}{:>10}{:>10}{:>14}  95 % interval",
        "median", "recorded", "advised", "difference"
    );
    let least = |walked: &Walked| walked.least_distance;
    let measures: [Measure; 3] = [
        ("least distance (m)", least),
        ("way (m)", |walked| Some(walked.length)),
        ("time (s)", |walked| Some(walked.time)),
    ];
    for (name, of) in measures {
        let pairs: Vec<Option<[f64; 2]>> =
            users.iter().map(|user| Some([of(&user.recorded)?, of(&user.advised)?])).collect();
        let middle = |counts: &[u32], of: &dyn Fn([f64; 2]) -> f64| {
            let all = pairs.iter().zip(counts).filter_map(|(pair, count)| Some((of((*pair)?), *count)));
            median(all.flat_map(|(value, count)| std::iter::repeat_n(value, count as usize)))
        };
        let once = vec![1; users.len()];
        let shown = |value: Option<f64>| {
            value.map_or_else(|| "-".to_owned(), |value| format!("{:.2}", hundredths(value)))
        };
        let difference = bootstrap.estimate(|counts| middle(counts, &|[before, after]| after - before));
        let interval = difference.and_then(|one| one.interval);
        let _ = writeln!(
            out,
            "{name:<28}{:>10}{:>10}{:>14}  {}",
            shown(middle(&once, &|[before, _]| before)),
            shown(middle(&once, &|[_, after]| after)),
            shown(difference.map(|one| one.value)),
            interval.map_or_else(|| "-".to_owned(), |[low, high]| format!("{low:.2} to {high:.2}"))
        );
    }
    let nearer = users.iter().filter(|user| least(&user.advised) < least(&user.recorded)).count();
    let longer: Vec<f64> = users.iter().map(|user| user.advised.length / user.recorded.length).collect();
    let [cycles, advised, known, followed] =
        [0, 1, 2, 3].map(|k| users.iter().map(|user| user.cycles[k]).sum::<u64>());
    let _ = writeln!(
        out,
        "\n{nearer} of {} came nearer to somebody; the way is {:.1} % longer in the median; a move was advised in {:.1} % of {} cycles,\nand the user moved so in {:.1} %. Who walked with the user as recorded does not count in the least distance.",
        users.len(),
        100.0 * (median(longer).unwrap_or(1.0) - 1.0),
        100.0 * advised as f64 / cycles.max(1) as f64,
        count(cycles),
        100.0 * followed as f64 / known.max(1) as f64
    );
    out
}

/// Rounded to hundredths, without a negative zero.
fn hundredths(value: f64) -> f64 {
    (100.0 * value).round() / 100.0 + 0.0
}

/// The page.
pub fn to_page(advised: Advised, sources: &[Source]) -> Page<'_> {
    let walks = walks(&advised);
    let Advised { title, scene, seed, cycles, followed, end, .. } = advised;
    let trace = recorded(&title, scene, &walks);
    let mut tables = vec![cycles_table(&cycles)];
    tables.extend(end.map(|[advised, recorded]| ends_table(&advised, &recorded)));
    Page {
        run: CallResult::of(title, seed),
        sources,
        tables,
        traces: Traces { list: trace.into_iter().collect(), left_out: 0 },
        without_crowd: !followed.is_empty(),
    }
}

/// The people of the recording by their ids, and the traces of observations without one, as `smc infer` finds them.
fn walks(advised: &Advised) -> Vec<Walk> {
    let mut people: BTreeMap<u32, Vec<(f64, Vec2)>> = BTreeMap::new();
    let mut unnamed = advised.batches.clone();
    for batch in &mut unnamed {
        batch.seen.retain(|one| one.id.is_none());
    }
    let inferred = infer(&unnamed, &Inferring::default(), &mut ConstantVelocity);
    let inferred = inferred.map(|found| traces(&found)).unwrap_or_default();
    for batch in &advised.batches {
        for one in &batch.seen {
            let Some(id) = one.id else { continue };
            let points = people.entry(id).or_default();
            // Several sensors may see somebody at one time.
            if points.last().is_none_or(|(time, _)| *time < batch.time) {
                points.push((batch.time, one.position));
            }
        }
    }
    let is_followed = !advised.followed.is_empty();
    let name = |id: u32| match id == advised.user {
        true if is_followed => "user as recorded".to_owned(),
        true => "user".to_owned(),
        false => format!("person[{id}]"),
    };
    let stretches = people.iter().flat_map(|(id, points)| {
        let parts = points.chunk_by(|a, b| b.0 - a.0 <= LONGEST);
        parts.map(|points| Walk { name: name(*id), points: points.to_vec(), groups: Vec::new() })
    });
    let followed = Walk { name: "user".to_owned(), points: advised.followed.clone(), groups: Vec::new() };
    stretches.chain(inferred).chain(is_followed.then_some(followed)).collect()
}

/// Time to a thousandth, without a rounding error at its end.
fn seconds(time: f64) -> String {
    plain(thousandths(time))
}

fn cycles_table(cycles: &[Advice]) -> Table {
    let row = |advice: &Advice| {
        let [probability, range] = advice.probability.map_or([String::new(), String::new()], |all| {
            let printed = interval(&Interval { estimate: all[0], low: all[1], high: all[2] }, None);
            [printed.estimate, printed.interval]
        });
        let gap = advice.gap.filter(|gap| gap.is_finite()).map_or(String::new(), |gap| {
            let certified = if advice.certified { "certified" } else { "not certified" };
            format!("{}, {certified}", plain((gap * 1e4).round() / 1e4))
        });
        vec![
            seconds(advice.time),
            advice.status.name().to_owned(),
            advice.chosen.clone().unwrap_or_default(),
            probability,
            range,
            gap,
            advice.notes.join("; "),
        ]
    };
    Table {
        title: "Advice".to_owned(),
        note: "One row a cycle. The move is at most the gap worse than the best one.".to_owned(),
        columns: vec!["time (s)", "status", "move", "probability", "interval", "gap", "notes"],
        rows: cycles.iter().map(row).collect(),
    }
}

fn ends_table(advised: &Walked, recorded: &Walked) -> Table {
    let row = |name: &str, walked: &Walked| {
        let least = walked.least_distance.map_or(String::new(), seconds);
        vec![name.to_owned(), least, seconds(walked.time), seconds(walked.length)]
    };
    Table {
        title: "The user".to_owned(),
        note: String::new(),
        columns: vec!["walked", "least distance (m)", "time (s)", "length (m)"],
        rows: vec![row("as advised", advised), row("as recorded", recorded)],
    }
}
