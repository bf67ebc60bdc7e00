//! Lane vectors: eight trials side by side, one per lane.
//!
//! Second rule of the kernel: one lane is one trial. The number of *logical* lanes is always eight,
//! whatever the width of the machine's vectors, so that no result depends on that width.

/// Number of logical lanes of a batch.
pub const LANES: usize = 8;

/// One number of each of eight trials.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    /// Zero in every lane.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// The same number in every lane.
    pub const fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    /// Lane by lane, `f` of the lane's number.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut out = self;
        for lane in &mut out.0 {
            *lane = f(*lane);
        }
        out
    }

    /// Lane by lane, `f` of the two numbers.
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self;
        for (lane, b) in out.0.iter_mut().zip(other.0) {
            *lane = f(*lane, b);
        }
        out
    }

    /// Whether all numbers of two lists have the same bits.
    pub fn are_same(one: &[Self], other: &[Self]) -> bool {
        let bits = |lanes: &Self| lanes.0.map(f64::to_bits);
        one.len() == other.len() && one.iter().zip(other).all(|(a, b)| bits(a) == bits(b))
    }

    /// The lanes in which `f` holds of the two numbers.
    #[inline(always)]
    pub fn compare(self, other: Self, f: impl Fn(f64, f64) -> bool) -> Mask {
        let mut bits = 0u8;
        for k in 0..LANES {
            bits |= u8::from(f(self.0[k], other.0[k])) << k;
        }
        Mask(bits)
    }
}

impl Default for Lanes {
    fn default() -> Self {
        Self::ZERO
    }
}

/// A set of lanes, bit `k` for lane `k`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mask(pub u8);

impl Mask {
    /// No lane.
    pub const NONE: Self = Self(0);
    /// Every lane.
    pub const ALL: Self = Self(0xff);

    /// The set of one lane.
    pub const fn lane(k: usize) -> Self {
        Self(1 << k)
    }

    /// Whether lane `k` is in the set.
    pub const fn has(self, k: usize) -> bool {
        self.0 >> k & 1 == 1
    }

    /// Whether no lane is in the set.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The lanes in the set, ascending.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let lane = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            (lane < LANES).then_some(lane)
        })
    }
}

impl std::ops::BitAnd for Mask {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl std::ops::BitOr for Mask {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl std::ops::BitXor for Mask {
    type Output = Self;
    fn bitxor(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }
}

impl std::ops::Not for Mask {
    type Output = Self;
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl std::ops::BitOrAssign for Mask {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

impl std::ops::BitAndAssign for Mask {
    fn bitand_assign(&mut self, other: Self) {
        self.0 &= other.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mask_lists_its_lanes() {
        let mask = Mask::lane(0) | Mask::lane(7);
        assert_eq!(mask.iter().collect::<Vec<_>>(), [0, 7]);
        assert_eq!(!mask, Mask(0b0111_1110));
        assert!((mask & !mask).is_empty());
    }

    #[test]
    fn lanes_compare_one_by_one() {
        let mut a = Lanes::splat(1.0);
        a.0[3] = 5.0;
        assert_eq!(a.compare(Lanes::splat(2.0), |x, y| x > y), Mask::lane(3));
    }
}
