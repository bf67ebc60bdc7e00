//! The flow of contact alone, in sub-steps of position Verlet.
//!
//! Half a drift, friction, compression, friction, half a drift. Friction is solved exactly pair by pair (`force::contact`).
//! It can therefore never reverse a slip, and never adds energy. Pairs are visited in order and then in reverse order,
//! which keeps it symmetric.

use super::clusters::Clusters;
use super::overlap::exchange;
use crate::base::math;
use crate::kernel::force::Forces;
use fearless_simd::Simd;

/// Frequency of the stiffest contact times the sub-step: an eighteenth of its period at most (2 pi / 0.35).
const PHASE: f64 = 0.35;
/// Contacts of one body in a dense packing stiffen each other by about this factor.
const PACKING: f64 = 4.0;
/// More would help nobody: such constants diverge.
const MOST_SUBSTEPS: f64 = 1000.0;

/// Moves the bodies of the hot clusters over `h` seconds. (Others may drift along, idly.)
#[inline(always)]
pub(super) fn flow<S: Simd>(simd: S, forces: &Forces, clusters: &mut Clusters, h: f64) {
    let wanted = (h * (PACKING * clusters.stiffest()).sqrt() / PHASE).ceil();
    let count = math::at_most(math::at_least(wanted, 1.0), MOST_SUBSTEPS) as u32;
    let t = h / f64::from(count);
    let Clusters { hot_pairs: pairs, hot_walls: walls, x, motions, .. } = clusters;
    let mut drift = 0.5 * t;
    for k in 0..=count {
        for (x, motion) in x.iter_mut().zip(motions.iter()) {
            *x += motion.v * drift;
        }
        if k < count {
            pairs.find(simd, &forces.periods, x, t);
            walls.find_at_walls(simd, forces, x, t);
            exchange(pairs, walls, motions);
            drift = if k + 1 < count { t } else { 0.5 * t };
        }
    }
}
