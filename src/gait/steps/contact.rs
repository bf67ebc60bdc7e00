//! Contacts of the feet with the ground.

use super::signal::{percentile, smoothed, speed};
use crate::data::mocap::{FootTrack, Take};
use crate::gait::Foot;

/// A foot at rest is slower than this, m/s; midpoint of ankle and toe.
const REST_SPEED: f64 = 0.6;
/// The shortest contact, s.
const SHORTEST: f64 = 0.12;
/// The shortest swing, s. Shorter gaps between contacts of a foot are no swings, and a contact after a shorter one at the begin of a
/// take may have begun before it.
const SHORTEST_SWING: f64 = 0.1;
/// Standard deviation of the smoothing of the adaptive threshold, s: 180 frames at 120 Hz.
const SIGMA: f64 = 1.5;
/// The share of a signal that is added to its adaptive threshold as a percentile.
const OFFSET: f64 = 0.05;

/// A rule for contact with the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contact {
    /// The rule of Agethen et al.: speed and height of ankle and toe are all below adaptive thresholds, each the smoothed signal
    /// plus its 5th percentile. Heights are those above the lowest one of the take.
    Adaptive,
    /// The foot is slower than 0.6 m/s for at least 0.12 s.
    #[default]
    Rest,
}

impl Contact {
    /// The rules and their names.
    pub const NAMES: [(&str, Self); 2] = [("adaptive", Self::Adaptive), ("rest", Self::Rest)];

    /// By how much a foot exceeds the thresholds in each frame; negative in contact.
    fn excess(self, foot: &FootTrack, fps: f64) -> Vec<f64> {
        if self == Self::Rest {
            let middle = |(a, t): (&[f64; 3], &[f64; 3])| std::array::from_fn(|k| f64::midpoint(a[k], t[k]));
            let middles: Vec<[f64; 3]> = foot.ankle.iter().zip(&foot.toe).map(middle).collect();
            return speed(&middles, fps).iter().map(|speed| speed - REST_SPEED).collect();
        }
        let mut most = vec![f64::NEG_INFINITY; foot.ankle.len()];
        for points in [&foot.ankle, &foot.toe] {
            let lowest = points.iter().map(|p| p[2]).min_by(f64::total_cmp).unwrap_or_default();
            let heights = points.iter().map(|p| p[2] - lowest).collect();
            for signal in [speed(points, fps), heights] {
                let offset = percentile(&signal, OFFSET);
                let top = signal.iter().copied().max_by(f64::total_cmp).unwrap_or_default();
                // Shares of the largest value, so that speeds and heights can be compared.
                let scale = if top > 0.0 { top } else { 1.0 };
                for ((most, value), smooth) in
                    most.iter_mut().zip(&signal).zip(smoothed(&signal, SIGMA * fps))
                {
                    let excess = (value - smooth - offset) / scale;
                    *most = if excess > *most { excess } else { *most };
                }
            }
        }
        most
    }

    /// All contacts of a take, in the order in which they begin.
    pub(super) fn supports(self, take: &Take) -> Vec<Support> {
        let mut supports = Vec::<Support>::new();
        for (foot, track) in [Foot::Left, Foot::Right].into_iter().zip(&take.feet) {
            let excess = self.excess(track, take.fps);
            let first = supports.len();
            let mut k = 0;
            while k < excess.len() {
                if excess[k] >= 0.0 {
                    k += 1;
                    continue;
                }
                let end = excess[k..].iter().position(|e| *e >= 0.0).map_or(excess.len(), |more| k + more);
                // Where the excess is 0 between two frames.
                let crossing =
                    |a: usize, b: usize| (a as f64 + excess[a] / (excess[a] - excess[b])) / take.fps;
                let from = if k > 0 { crossing(k - 1, k) } else { 0.0 };
                let to = if end < excess.len() { crossing(end - 1, end) } else { take.duration() };
                match supports[first..].last_mut() {
                    Some(last) if from - last.to < SHORTEST_SWING => last.to = to,
                    _ => supports.push(Support { foot, from, to, seen: from >= SHORTEST_SWING }),
                }
                k = end;
            }
        }
        supports.retain(|support| support.to - support.from >= SHORTEST);
        supports.sort_by(|a, b| a.from.total_cmp(&b.from));
        supports
    }
}

/// A foot on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Support {
    pub(super) foot: Foot,
    /// Its begin and end, s since the begin of the take.
    pub(super) from: f64,
    pub(super) to: f64,
    /// Whether the foot was seen in swing before it; else it may have begun before the take.
    pub(super) seen: bool,
}
