//! Some of the moments of a trial, evenly spaced, from which the others are made again: a trial that is explained need not be
//! run again from its start.

/// Moments, by number.
pub(super) struct Checkpoints<T> {
    list: Vec<(u64, T)>,
    /// Numbers of the moments that are kept are multiples of this.
    stride: u64,
    most: usize,
}

impl<T: Clone> Checkpoints<T> {
    /// Nothing yet; at most so many will be kept, but two at least.
    pub(super) fn new(most: usize) -> Self {
        Self { list: Vec::new(), stride: 1, most: most.max(2) }
    }

    /// The next moment, with its number, which is the one after the last: it is kept if its turn has come.
    pub(super) fn offer(&mut self, number: u64, moment: impl FnOnce() -> T) {
        if !number.is_multiple_of(self.stride) {
            return;
        }
        if self.list.len() == self.most {
            self.stride *= 2;
            self.list.retain(|(number, _)| number.is_multiple_of(self.stride));
        }
        if number.is_multiple_of(self.stride) {
            self.list.push((number, moment()));
        }
    }

    /// The last moment kept of those that come `before`, which are the first ones.
    pub(super) fn last(&self, before: impl Fn(u64, &T) -> bool) -> Option<(u64, T)> {
        let count = self.list.partition_point(|(number, moment)| before(*number, moment));
        self.list[..count].last().cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_evenly_spaced_and_near() {
        let mut kept = Checkpoints::new(8);
        for k in 0..1000 {
            kept.offer(k, || k);
            for at in [0, k / 3, k] {
                let (number, moment) = kept.last(|number, _| number <= at).unwrap();
                assert!(
                    number == moment && number <= at && at - number <= (k + 1).div_ceil(4),
                    "{at} of {k}: {number}"
                );
            }
        }
    }
}
