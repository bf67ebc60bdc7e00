//! Programs in the place of a model: trials are run elsewhere, and their traces are played.
//!
//! The threads that run trials wait for one program each, so the pool of programs is that of the threads, and results stand in
//! the order of trials at any number of them. A seed belongs to each trial; one trial of a hundred runs twice, and has to give
//! the same trace.

mod child;
mod film;

use crate::base::random::{Purpose, Stream, TrialKey};
use crate::compile::Study;
use crate::kernel::driver::Drivers;
use crate::kernel::fault::Fault;
use crate::kernel::tape::{Player, Tape, Unplayed};
use crate::model::{Outside, Scenario};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
pub use child::end_all;
use std::collections::BTreeMap;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One trial of so many runs twice.
const TWICE: u64 = 100;
/// Most trials without a trace that are remembered.
const MOST_FAILED: usize = 10_000;
/// So many equal traces under different seeds tell that the seed is not used, unless what happens is rare.
const MANY_EQUAL: u64 = 20;
/// The move of a trial in which none is followed, as rankings call it.
const OWN: &str = "own way";
/// Bits of a seed: programs take whole numbers of 32 bits, some with a sign.
const SEED_BITS: u32 = 31;

/// Whether the trials that are under way are to be given up.
pub type IsOver = dyn Fn() -> bool + Send + Sync;

/// The programs of a call.
pub struct Programs {
    /// Where they run: paths in their words are seen from there.
    folder: PathBuf,
    is_over: Box<IsOver>,
    known: Mutex<Known>,
}

/// Facts about trials that have run.
#[derive(Default)]
struct Known {
    /// Trials without a trace, by their words: whoever asks again hears the same.
    failed: BTreeMap<Vec<String>, Unplayed>,
    /// The first trace of each call without its seed, whether another one differs from it, and how many there were.
    first: BTreeMap<Vec<String>, (u64, bool, u64)>,
}

impl fmt::Debug for Programs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Programs").field("folder", &self.folder).finish_non_exhaustive()
    }
}

impl Programs {
    /// Programs that run in a folder; those under way are given up when `is_over` says so.
    pub fn new(folder: impl Into<PathBuf>, is_over: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        let folder = match folder.into() {
            empty if empty.as_os_str().is_empty() => PathBuf::from("."),
            folder => folder,
        };
        Self { folder, is_over: Box::new(is_over), known: Mutex::default() }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A warning for each program that gave equal traces under all of many seeds.
    pub fn doubts(&self) -> Vec<String> {
        let known = self.known();
        let equal = known.first.iter().filter(|(_, (_, differs, count))| !differs && *count >= MANY_EQUAL);
        equal
            .map(|(words, (_, _, count))| {
                let call = &words[0];
                format!("all {count} traces of `{call}` are equal; does the program draw its random numbers from its seed?")
            })
            .collect()
    }

    /// Runs a trial once.
    fn once(&self, outside: &Outside, words: &[String], scenario: &Scenario) -> Result<Tape, Unplayed> {
        let said = child::run(words, &self.folder, outside.limit, &*self.is_over)?;
        let fails = |why: String| Unplayed::Failed(format!("the trace cannot be read: {why}").into());
        film::film(outside, scenario, &said.output).map_err(|why| match said.error.as_str() {
            "" => fails(why),
            error => fails(format!("{why}; its standard error ends with: {error}")),
        })
    }
}

impl Player for Programs {
    fn play(&self, scenario: &Scenario, key: TrialKey, option: Option<&str>) -> Result<Arc<Tape>, Unplayed> {
        let outside = scenario.processes.outside.as_deref();
        let Some(outside) = outside else { return Err(Unplayed::Failed("there is no program".into())) };
        let option = option.unwrap_or(OWN);
        let words = outside.call(u64::from(seed(key)), key.index, option);
        if let Some(known) = self.known().failed.get(&words) {
            return Err(known.clone());
        }
        let played = self.once(outside, &words, scenario).and_then(|tape| {
            let is_checked = key.index.is_multiple_of(TWICE) && key.branch == 0;
            let again = if is_checked { Some(self.once(outside, &words, scenario)) } else { None };
            match again {
                Some(Ok(other)) if other != tape => Err(Unplayed::Wrong(Fault::Unrepeated)),
                Some(Err(failed)) => Err(failed),
                _ => Ok(tape),
            }
        });
        let mut known = self.known();
        match &played {
            Ok(tape) => {
                let mut hasher = DefaultHasher::new();
                let bits = |value: &f64| value.to_bits();
                tape.values.iter().map(bits).for_each(|bits| bits.hash(&mut hasher));
                for one in tape.people.iter().flatten() {
                    (one.place, bits(&one.position.x), bits(&one.position.y)).hash(&mut hasher);
                }
                let print = hasher.finish();
                let call = vec![outside.told(), option.to_owned()];
                let (first, differs, count) = known.first.entry(call).or_insert((print, false, 0));
                *differs |= *first != print;
                *count += 1;
            }
            // What was given up may run again.
            Err(_) if (self.is_over)() => {}
            Err(unplayed) if known.failed.len() < MOST_FAILED => {
                known.failed.insert(words, unplayed.clone());
            }
            Err(_) => {}
        }
        played.map(Arc::new)
    }
}

/// The seed of a trial. Of 2^31 trials of a call no two have the same one: each round below can be undone.
fn seed(key: TrialKey) -> u32 {
    let mask = (1u32 << SEED_BITS) - 1;
    let series = TrialKey { index: key.index >> SEED_BITS, ..key };
    let stream = Stream::of(series, 0, Purpose::Run);
    let mut value = key.index as u32 & mask;
    for round in 0..3 {
        value ^= stream.words(round)[0] as u32 & mask;
        value = value.wrapping_mul(0x9E37_79B1) & mask;
        value ^= value >> 15;
    }
    value
}

/// Gives the drivers of a run those who play its trials, if programs may run.
pub fn playing(drivers: Drivers, programs: Option<&Arc<Programs>>) -> Drivers {
    match programs {
        Some(programs) => drivers.played_by(Arc::clone(programs) as Arc<dyn Player>),
        None => drivers,
    }
}

/// Why a study with a program may not run, unless programs are allowed to.
pub fn unallowed(study: &Study) -> Option<Diagnostic> {
    let world = study.worlds.first()?;
    let outside = world.scenario.processes.outside.as_deref()?;
    let said = format!("the program `{}` would run `{}`", outside.name, outside.told());
    let error = match world.origins.program {
        Some(span) => Diagnostic::error(Code::E0729, span, said),
        None => Diagnostic::placeless(Code::E0729, said),
    };
    Some(error.hint("if you trust it, call again with `--allow-run`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_trials_have_one_seed() {
        let of = |seed_of_call: u64, index: u64| seed(TrialKey { seed: seed_of_call, index, branch: 0 });
        let all: BTreeSet<u32> = (0..100_000).map(|index| of(7, index)).collect();
        assert_eq!(all.len(), 100_000);
        assert!(all.iter().all(|seed| *seed < 1 << SEED_BITS));
        // Neighbours share no more bits than chance has it, and another call has other seeds.
        let shared = |a: u32, b: u32| 31 - (a ^ b).count_ones();
        let mean = (0..10_000).map(|k| f64::from(shared(of(7, k), of(7, k + 1)))).sum::<f64>() / 1e4;
        assert!((mean - 15.5).abs() < 0.2, "{mean}");
        assert!((0..1000).all(|k| of(7, k) != of(8, k)));
    }
}
