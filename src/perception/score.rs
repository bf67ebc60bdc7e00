//! How well inferred traces agree with annotated tracks.

use super::assignment::Costs;
use std::collections::BTreeMap;

/// Agreement of traces with tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct TrackScore {
    /// Annotated tracks.
    pub tracks: usize,
    /// Tracks with all observations in one trace.
    pub unsplit: usize,
    /// Successive observations of a track in different traces.
    pub switches: usize,
    /// 2 IDTP / (2 IDTP + IDFP + IDFN) (Ristani et al. 2016), from tracks and traces paired one to one for the most
    /// common observations.
    pub idf1: f64,
    /// Traces with observations of several tracks.
    pub joins: usize,
    /// Joins of tracks that overlap in time. Annotators renumber people, so other joins may be right.
    pub wrong_joins: usize,
}

/// The traces of an annotated track: time, s, and number of the trace at each observation, in the order of time.
pub type TrackTraces = Vec<(f64, u64)>;

/// The agreement of traces with tracks, by the ids of people.
pub fn score_tracks(tracks: &BTreeMap<u32, TrackTraces>) -> TrackScore {
    let mut common = BTreeMap::<(u64, u32), usize>::new();
    let (mut unsplit, mut switches, mut all) = (0, 0, 0);
    for (id, seen) in tracks {
        let changes = seen.windows(2).filter(|pair| pair[0].1 != pair[1].1).count();
        switches += changes;
        unsplit += usize::from(changes == 0);
        all += seen.len();
        for (_, trace) in seen {
            *common.entry((*trace, *id)).or_default() += 1;
        }
    }
    let pairs: Vec<(u64, u32, usize)> = common.iter().map(|((trace, id), n)| (*trace, *id, *n)).collect();
    let (mut joins, mut wrong_joins) = (0, 0);
    for joined in pairs.chunk_by(|a, b| a.0 == b.0).filter(|joined| joined.len() > 1) {
        joins += 1;
        let span = |id: u32| {
            let seen = tracks.get(&id)?;
            Some((seen.first()?.0, seen.last()?.0))
        };
        let mut spans: Vec<(f64, f64)> = joined.iter().filter_map(|(_, id, _)| span(*id)).collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        wrong_joins += usize::from(spans.windows(2).any(|pair| pair[1].0 <= pair[0].1));
    }
    let shared = paired(&pairs) as f64;
    // Each observation is one of a track and one of a trace, so false positives and negatives are equally many.
    let idf1 = if all == 0 { 1.0 } else { shared / all as f64 };
    TrackScore { tracks: tracks.len(), unsplit, switches, idf1, joins, wrong_joins }
}

/// The most common observations of traces and tracks paired one to one; `pairs` are ascending. Traces that share no
/// track are independent, so each connected part is assigned by itself.
fn paired(pairs: &[(u64, u32, usize)]) -> usize {
    let mut part_of_track = BTreeMap::<u32, usize>::new();
    let mut parts: Vec<Vec<&(u64, u32, usize)>> = Vec::new();
    for trace in pairs.chunk_by(|a, b| a.0 == b.0) {
        let mut part: Vec<&(u64, u32, usize)> = trace.iter().collect();
        let mut touched: Vec<usize> =
            trace.iter().filter_map(|pair| part_of_track.get(&pair.1).copied()).collect();
        touched.sort_unstable();
        touched.dedup();
        for k in touched {
            part.append(&mut parts[k]);
        }
        for pair in &part {
            part_of_track.insert(pair.1, parts.len());
        }
        parts.push(part);
    }
    parts.iter().map(|part| paired_in_part(part)).sum()
}

fn paired_in_part(part: &[&(u64, u32, usize)]) -> usize {
    let mut traces: Vec<u64> = part.iter().map(|pair| pair.0).collect();
    let mut ids: Vec<u32> = part.iter().map(|pair| pair.1).collect();
    traces.sort_unstable();
    traces.dedup();
    ids.sort_unstable();
    ids.dedup();
    let mut counts = vec![vec![0; ids.len()]; traces.len()];
    for (trace, id, count) in part {
        if let (Ok(i), Ok(j)) = (traces.binary_search(trace), ids.binary_search(id)) {
            counts[i][j] = *count;
        }
    }
    let assigned = Costs::of(traces.len(), ids.len(), |i, j| -(counts[i][j] as f64)).assign();
    assigned.into_iter().enumerate().filter_map(|(i, j)| Some(counts[i][j?])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tracks(all: &[(u32, f64, &[u64])]) -> BTreeMap<u32, TrackTraces> {
        let seen = |from: f64, traces: &[u64]| {
            traces.iter().enumerate().map(|(k, t)| (from + k as f64, *t)).collect()
        };
        all.iter().map(|(id, from, traces)| (*id, seen(*from, traces))).collect()
    }

    #[test]
    fn traces_that_are_tracks_score_one() {
        let score = score_tracks(&tracks(&[(1, 0.0, &[1, 1]), (2, 0.0, &[2, 2, 2])]));
        assert_eq!(score, TrackScore { tracks: 2, unsplit: 2, idf1: 1.0, ..TrackScore::default() });
        assert_eq!(score_tracks(&BTreeMap::new()).idf1, 1.0);
    }

    #[test]
    fn splits_and_joins_count() {
        // Person 1 is in traces 1, 2 and 1; trace 2 is person 2's too, at the same time; person 3 comes later in trace 1.
        let score = score_tracks(&tracks(&[(1, 0.0, &[1, 2, 1]), (2, 0.0, &[2, 2, 2]), (3, 9.0, &[1, 1])]));
        assert_eq!((score.unsplit, score.switches, score.joins, score.wrong_joins), (2, 2, 2, 1));
        assert!((score.idf1 - 5.0 / 8.0).abs() < 1e-12, "{}", score.idf1);
    }
}
