//! How numbers become places on the axis of a figure, and the round numbers at its ticks.

use crate::base::math;
use crate::report::number::{exponent, power};

/// Decades over which an axis has ticks at powers of ten alone.
const DECADES: i32 = 2;
/// Probabilities closer together than this are looked at closely.
const APART: f64 = 0.1;

/// How numbers become places on an axis.
#[derive(Clone, Debug)]
pub struct Scale {
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    is_log: bool,
}

impl Scale {
    /// A linear axis around numbers; infinite ones are left out.
    pub fn linear(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = ends(numbers);
        let lone = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
        let pad = if low < high { 0.0 } else { lone };
        let (low, high) = (low - pad, high + pad);
        let step = round_step((high - low) / 6.0);
        let (first, last) = ((low / step).floor(), (high / step).ceil());
        let ticks = (0..=((last - first) as usize).min(20)).map(|k| rounded((first + k as f64) * step));
        Self { low: first * step, high: last * step, ticks: ticks.collect(), is_log: false }
    }

    /// A linear axis that ends exactly at two numbers.
    pub fn between(low: f64, high: f64) -> Self {
        let wide = Self::linear([low, high]);
        let ticks = wide.ticks.into_iter().filter(|tick| (low..=high).contains(tick)).collect();
        Self { low, high: high.max(low + f64::MIN_POSITIVE), ticks, is_log: false }
    }

    /// A linear axis around probabilities and their differences: from 0 to 1 where they lie apart.
    pub fn probabilities(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = ends(numbers);
        let is_whole = high - low >= APART && high <= 1.0 && low >= -1.0;
        let whole = [if low < 0.0 { -1.0 } else { 0.0 }, 1.0];
        Self::linear(if is_whole { whole } else { [low, high] })
    }

    /// An axis on which equal factors are equally long, around positive numbers.
    pub fn log(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = ends(numbers.into_iter().filter(|x| *x > 0.0));
        let (low, high) = if low < high { (low, high) } else { (0.5 * high.max(2.0), 2.0 * high.max(2.0)) };
        let factors: &[f64] = if high / low > power(DECADES) { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let tick = |k: i32| factors.iter().map(move |factor| factor * power(k));
        let all = (exponent(low)..=exponent(high)).flat_map(tick);
        let ticks = all.filter(|tick| (low..=high * 1.000_001).contains(tick));
        Self { low, high, ticks: ticks.collect(), is_log: true }
    }

    /// From 0 to 1.
    pub fn shares() -> Self {
        Self::linear([0.0, 1.0])
    }

    /// Places `0 .. n` without ticks.
    pub fn places(n: usize) -> Self {
        Self { low: -0.5, high: n as f64 - 0.5, ticks: Vec::new(), is_log: false }
    }

    /// Its round numbers, ascending.
    pub fn ticks(&self) -> &[f64] {
        &self.ticks
    }

    /// Where a number is, as a share of the axis; its ends for what lies outside.
    pub fn share(&self, x: f64) -> f64 {
        let of = |x: f64| if self.is_log { math::ln(x.max(f64::MIN_POSITIVE)) } else { x };
        ((of(x) - of(self.low)) / (of(self.high) - of(self.low))).clamp(0.0, 1.0)
    }
}

/// The least and the largest of the finite numbers.
fn ends(numbers: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = numbers.into_iter().filter(|x| x.is_finite());
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// A tick without the rounding of its product.
fn rounded(tick: f64) -> f64 {
    format!("{tick:.9e}").parse().unwrap_or(tick)
}

/// The smallest of 1, 2, 5, 10 times a power of ten that is not below a length.
fn round_step(length: f64) -> f64 {
    let power = power(exponent(length));
    let steps = [1.0, 2.0, 5.0].map(|factor| factor * power);
    steps.into_iter().find(|step| *step >= length).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::number::plain;

    #[test]
    fn ticks_are_round_and_contain_the_numbers() {
        let scale = Scale::linear([0.13, 0.97]);
        assert_eq!((scale.low, scale.high), (0.0, 1.0));
        assert_eq!(
            scale.ticks.iter().map(|tick| plain(*tick)).collect::<Vec<_>>(),
            ["0", "0.2", "0.4", "0.6", "0.8", "1"]
        );
        let lone = Scale::linear([f64::INFINITY, 7.0]);
        assert!(lone.low < 7.0 && lone.high > 7.0);
        assert_eq!((lone.share(-9.0), lone.share(99.0)), (0.0, 1.0));
        let apart = Scale::probabilities([0.63, 0.95]);
        assert_eq!((apart.low, apart.high), (0.0, 1.0));
        let close = Scale::probabilities([0.93, 0.95]);
        assert!(close.low > 0.9 && close.high < 0.96);
        let log = Scale::log([1.0, 1000.0]);
        assert_eq!(log.ticks.iter().map(|tick| plain(*tick)).collect::<Vec<_>>(), ["1", "10", "100", "1000"]);
        assert!((log.share(10.0) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!([0.9, 1.0, 4.9, 5.0, 19.0].map(round_step), [1.0, 1.0, 5.0, 5.0, 20.0]);
    }
}
