//! Traces made small enough for a page.

use crate::engine::traces::{Trace, Track};
use std::collections::BTreeSet;

/// Most bytes of the data of a page.
pub(super) const MOST_BYTES: usize = 2_000_000;
/// Frames lie at most so far apart while there are other means, s.
const COARSE: f64 = 0.75;
/// So many agents are shown while there are other means.
const FEW: usize = 400;

/// What was left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Thinned {
    /// Of so many agents those are shown whose number is a multiple of this, besides those who decided; 0 where all are.
    pub(super) every: usize,
    /// Traces.
    pub(super) traces: usize,
}

/// Makes traces smaller until `size` of them is small enough: frames first, then agents, then whole traces from the last on.
pub(super) fn thin(traces: &mut Vec<Trace>, most: usize, size: impl Fn(&[Trace]) -> usize) -> Thinned {
    let mut thinned = Thinned::default();
    while size(traces) > most && !traces.is_empty() {
        let finest = traces.iter().map(|trace| trace.motion.spacing).fold(f64::INFINITY, f64::min);
        let crowd = traces.iter().map(|trace| trace.motion.tracks.len()).max().unwrap_or(0);
        if finest < COARSE {
            for trace in traces.iter_mut().filter(|trace| trace.motion.spacing <= finest) {
                trace.motion.halve();
            }
        } else if crowd > FEW {
            thinned.every = 2 * thinned.every.max(1);
            for trace in traces.iter_mut() {
                keep(trace, thinned.every);
            }
        } else if traces.len() > 1 {
            traces.pop();
            thinned.traces += 1;
        } else if traces[0].motion.frames > 2 {
            traces[0].motion.halve();
        } else {
            // What remains is the texts of atoms: nothing more can be dropped but the whole.
            thinned.traces += traces.len();
            traces.clear();
        }
    }
    thinned
}

/// Of the agents of a trace keeps some, and all who decided or whose name is not one of many.
fn keep(trace: &mut Trace, every: usize) {
    let decided: BTreeSet<String> = {
        let witnesses = trace.shows.iter().filter_map(|shown| shown.witness.as_ref());
        witnesses.flat_map(|witness| witness.agents.iter().cloned()).collect()
    };
    let is_kept = |track: &Track| {
        track.agent.is_multiple_of(every) || !track.name.ends_with(']') || decided.contains(&track.name)
    };
    trace.motion.keep(is_kept);
}
