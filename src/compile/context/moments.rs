//! Continuous time: the length of a tick, of which the horizon and all bounds are whole multiples.
//!
//! It begins as a power of ten with ten digits for the horizon, which holds nearly every bound that people write.
//! A bound in between, such as `1 s / 3`, is noted, and everything is compiled again with a finer tick.

use crate::base::decimal::Decimal;

/// Most ticks of a horizon: what monitors of signals can take.
pub(crate) const MOST_TICKS: u64 = 1 << 40;

/// The longest time of which both are whole multiples; `None` where it does not fit.
fn common(a: Decimal, b: Decimal) -> Option<Decimal> {
    let mut x = a.numerator().checked_mul(b.denominator())?;
    let mut y = b.numerator().checked_mul(a.denominator())?;
    while y != 0 {
        (x, y) = (y, x % y);
    }
    Decimal::ratio(x, a.denominator().checked_mul(b.denominator())?)
}

/// A power of ten of which a time of `seconds` is 10^9 to 10^10.
fn grid(seconds: f64) -> Option<Decimal> {
    let (mut tick, mut count) = (Decimal::ONE, seconds);
    while count < 1e9 {
        tick = tick.div(Decimal::whole(10))?;
        count *= 10.0;
    }
    while count >= 1e10 {
        tick = tick.mul(Decimal::whole(10))?;
        count /= 10.0;
    }
    Some(tick)
}

/// The nearest multiple of a tick.
pub(crate) fn nearest(seconds: f64, tick: Decimal) -> Option<Decimal> {
    let count = (seconds / tick.to_f64()).round();
    if count.abs() < 9e15 { Decimal::whole(count as i64).mul(tick) } else { None }
}

/// The tick of which a horizon and a further time are whole multiples, if the horizon is not too many of it.
pub(crate) fn finer(tick: Decimal, horizon: Decimal, time: Decimal) -> Option<Decimal> {
    let tick = common(tick, time)?;
    let ticks = horizon.div(tick)?.as_whole()?;
    (ticks <= i128::from(MOST_TICKS)).then_some(tick)
}

/// The tick for a horizon (its exact value, if it has one, and its nearest double) and some more times, as far
/// as they fit, and the exact horizon.
pub(crate) fn tick(exact: Option<Decimal>, seconds: f64, more: &[Decimal]) -> Option<(Decimal, Decimal)> {
    let start = grid(seconds)?;
    let horizon = exact.or_else(|| nearest(seconds, start))?;
    let mut tick = finer(start, horizon, horizon)?;
    for time in more {
        tick = finer(tick, horizon, *time).unwrap_or(tick);
    }
    Some((tick, horizon))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(text: &str) -> Decimal {
        Decimal::parse(text).unwrap()
    }

    #[test]
    fn decimals_need_no_second_round_and_thirds_do() {
        let ten = exact("10");
        let (first, _) = tick(Some(ten), 10.0, &[]).unwrap();
        for fits in ["0.1", "3.25", "0.00000001", "10"] {
            assert!(exact(fits).div(first).unwrap().as_whole().is_some(), "{fits}");
        }
        let third = Decimal::ratio(1, 3).unwrap();
        assert!(third.div(first).unwrap().as_whole().is_none());
        let (second, horizon) = tick(Some(ten), 10.0, &[third]).unwrap();
        for fits in [third, ten, exact("0.1")] {
            assert!(fits.div(second).unwrap().as_whole().is_some());
        }
        assert_eq!(horizon, ten);
        assert_eq!(finer(first, ten, exact("0.00000000001234567")), None);
    }

    #[test]
    fn horizons_of_any_size_have_a_tick() {
        for seconds in [1e-9, 0.37, 3600.0, 1e15] {
            let (tick, horizon) = tick(None, seconds, &[]).unwrap();
            let ticks = horizon.div(tick).unwrap().as_whole().unwrap();
            assert!((1_000_000_000..=10_000_000_000).contains(&ticks), "{seconds} {ticks}");
            assert!((horizon.to_f64() / seconds - 1.0).abs() < 1e-9);
        }
    }
}
