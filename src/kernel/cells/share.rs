//! Some strips of one large crowd, of which one thread finds the forces.
//!
//! An agent is pushed by those of the strip below, then by those of its own, each in their order. So a share begins with the
//! pushes from the strip below its first one, which the share below makes as well, and leaves out those on the strip above
//! its last one. All sums are those of one share alone, to the last bit.
//!
//! ```text
//!   strip 5          the second share: pushes of strip 3 on strip 4, then strips 4 and 5
//!   strip 4
//!   -------
//!   strip 3          the first share: strips 0 to 3; its pushes on strip 4 are not read
//!   ...
//! ```

use super::pairs::{Task, Touch};
use super::reach::Sorted;
use crate::base::lanes::LANES;
use crate::kernel::force::pair::{PairTerm, Sum};
use crate::kernel::near::Index;
use crate::kernel::state::State;
use crate::kernel::vector::parts;
use fearless_simd::Simd;
use std::ops::Range;

/// Room for the forces in some strips.
#[derive(Clone, Debug, Default)]
pub(super) struct Share {
    pub(super) strips: Range<usize>,
    /// The place among the sorted agents from which on the columns and forces count.
    pub(super) first: usize,
    /// What the terms between two bodies keep of each agent: a column for each number.
    pub(super) columns: Vec<Vec<f64>>,
    /// The forces.
    pub(super) fx: Vec<f64>,
    pub(super) fy: Vec<f64>,
    /// The slowness that those ahead impose; empty where nobody keeps a headway.
    pub(super) slowness: Vec<f64>,
    /// Of one strip: the vectors of neighbours, and the sums of its agents over eight lanes.
    pub(super) tasks: Vec<Task>,
    pub(super) touches: Vec<Touch>,
    pub(super) own: Vec<Sum>,
    /// Who may touch within a step, the smaller number first.
    pub(super) close: Vec<(u32, u32)>,
}

impl Share {
    /// Cuts the strips of a crowd into so many shares, or fewer, with about as many pairs each.
    pub(super) fn cut(shares: &mut Vec<Self>, index: &Index, count: usize) {
        let strips = index.grid.strips;
        shares.resize_with(count.clamp(1, strips), Self::default);
        let work = |strip: usize| {
            let here = index.strip(strip).len();
            let above = if strip + 1 < strips { index.strip(strip + 1).len() } else { 0 };
            here * (here + above)
        };
        let (mut rest, mut strip) = ((0..strips).map(work).sum::<usize>(), 0);
        let count = shares.len();
        for (k, share) in shares.iter_mut().enumerate() {
            let (from, wanted) = (strip, rest / (count - k));
            let mut done = 0;
            while strip < strips - (count - 1 - k) && (strip == from || done < wanted || k + 1 == count) {
                done += work(strip);
                strip += 1;
            }
            rest -= done;
            share.strips = from..strip;
            // From the strip below its first one to the strip above its last one, in whole blocks.
            share.first = index.strip(from.saturating_sub(1)).start / LANES * LANES;
            let end = if strip + 1 < strips { index.strip(strip + 1).start } else { index.agent.len() };
            share.fx.resize(end.next_multiple_of(LANES) - share.first, 0.0);
        }
    }

    /// Takes over what a term keeps of each agent, and makes room for the forces.
    #[inline(always)]
    pub(super) fn keep<S: Simd, T: PairTerm>(&mut self, simd: S, term: T, index: &Index, state: &State) {
        let total = self.fx.len();
        for field in [&mut self.fx, &mut self.fy] {
            field.clear();
            field.resize(total, 0.0);
        }
        self.slowness.clear();
        self.slowness.resize(if T::KEEPS_HEADWAY { total } else { 0 }, 0.0);
        self.columns.resize_with(T::COUNT, Vec::new);
        for column in &mut self.columns {
            column.resize(total, 0.0);
        }
        let Self { first, columns, .. } = self;
        for (k, agents) in index.agent[*first..*first + total].chunks_exact(LANES).enumerate() {
            for part in parts(simd) {
                term.keep(
                    part,
                    state,
                    Sorted { part, agents },
                    #[inline(always)]
                    |column, numbers| part.put(numbers, &mut columns[column][k * LANES..]),
                );
            }
        }
    }
}
