//! Random delays by address: how long something that has just become possible waits.
//!
//! The n-th delay of an entity in a trial takes two uniform numbers, whatever its law: the first becomes the
//! delay by the inverse distribution function, the second is left for what happens at its end.

use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::tick::{Clock, Tick};
use crate::model::law::Ready;

/// A delay in seconds, and a number in (0, 1) that decides what happens after it.
pub(in crate::kernel) fn delay(trial: TrialKey, entity: u32, number: u32, law: &Ready) -> (f64, f64) {
    let [first, second] = Stream::of(trial, entity, Purpose::Delay).uniform_pair(number);
    (law.draw(first), second)
}

/// A time after a delay. Times that people write are short decimals, and sums of them are, too: three times 0.1 s is 0.3 s,
/// and what is due then happens in the state of then. Sums of doubles miss that by a unit in the last place; one that is as
/// near to a whole number of nanoseconds as that is taken for it. Only `+ - * /`, so the same everywhere.
/// So is one that is near a step, where states are looked at and bounds end: 1 s / 3 is no decimal, and its sums go astray
/// a little more each time. (In continuous time delays begin at any time, and
/// add up as `Instant`s.) Never by more than a hundred-millionth of the delay: what is due at once is due
/// now, and a short delay after a long time is not lost.
pub(in crate::kernel) fn after(now: f64, wait: f64, clock: Clock) -> f64 {
    /// A few units in the last place.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    /// What the sum of thousands of delays may be off.
    const ASTRAY: f64 = 1e-12;
    /// What a delay may be off, besides.
    const OF_DELAY: f64 = 1e-8;
    let due = now + wait;
    let is_near = |time: f64, share: f64| {
        let off = (time - due).abs();
        off <= due * share && off <= wait * OF_DELAY
    };
    if let Clock::Stepped(length) = clock {
        let ticks = (due * length.denominator() as f64 / length.numerator() as f64 + 0.5).floor();
        // Ticks that are nearer to each other than that tell nothing.
        if ticks < 1e11 {
            let tick = clock.seconds(Tick(ticks as u64));
            if is_near(tick, ASTRAY) {
                return tick;
            }
        }
    }
    let nearest = (due * 1e9 + 0.5).floor() / 1e9;
    if is_near(nearest, ROUNDING) { nearest } else { due }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::decimal::Decimal;
    use crate::model::{Family, Law};

    #[test]
    fn sums_of_decimals_are_decimals() {
        for (text, count) in
            [("0.1", 5000), ("0.3", 5000), ("0.7", 900), ("1.1", 4000), ("0.001", 90_000), ("17.3", 5)]
        {
            let wait: f64 = text.parse().unwrap();
            let thousandths = (wait * 1000.0).round() as u64;
            let mut now = 0.0;
            for k in 1..=count {
                now = after(now, wait, Clock::Steps);
                assert_eq!(now, (k * thousandths) as f64 / 1000.0, "{k} times {text}");
            }
        }
        // What is no decimal stays what it is.
        let after_steps = |now: f64, wait: f64| after(now, wait, Clock::Steps);
        assert_eq!(after_steps(0.1, std::f64::consts::PI), 0.1 + std::f64::consts::PI);
        assert_eq!(after_steps(1.0, f64::INFINITY), f64::INFINITY);
        assert_eq!(after_steps(1e300, 1.0), 1e300);
        // Sums of what is no decimal meet the ticks all the same.
        for parts in [3_i128, 7, 49, 60] {
            let length = Decimal::ratio(1, parts).unwrap();
            let clock = Clock::Stepped(length);
            let mut now = 0.0;
            for k in 1..=20_000 {
                now = after(now, length.to_f64(), clock);
                assert_eq!(now, clock.seconds(Tick(k)), "{k} times 1/{parts}");
            }
            // Where only the end is a step, too.
            let whole = Clock::Stepped(Decimal::ONE);
            let mut now = 0.0;
            for k in 1..=1_000 * parts {
                now = after(now, length.to_f64(), whole);
                assert!(k % parts != 0 || now == (k / parts) as f64, "{k} times 1/{parts}");
            }
        }
    }

    #[test]
    fn time_goes_on_by_every_delay() {
        let clocks =
            [Clock::Steps, Clock::Stepped(Decimal::ONE), Clock::Stepped(Decimal::ratio(1, 50).unwrap())];
        let mut now = 0.37;
        while now < 1e12 {
            for clock in clocks {
                assert_eq!(after(now, 0.0, clock), now);
                for wait in [1e-7, 4e-7, 0.003, 0.1, 1.0 / 3.0, 1.0, 700.0] {
                    let due = after(now, wait, clock);
                    assert!(
                        (due - now - wait).abs() <= 1.1e-8 * wait + 2.0 * f64::EPSILON * due,
                        "{now} {wait}"
                    );
                    assert!(due > now || now + wait == now, "{now} {wait}");
                }
                // Exactly on a second, and next to it.
                let second = now.floor() + 1.0;
                for start in [second, second.next_up(), second.next_down()] {
                    assert_eq!(after(start, 0.0, clock), start);
                    assert!(after(start, 4e-7, clock) > start || start + 4e-7 == start);
                }
            }
            now *= 1.37;
        }
    }

    #[test]
    fn delays_have_their_law_and_the_rest_is_uniform() {
        let law = Law::Random {
            family: Family::Uniform { low: 2.0, high: 5.0 },
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        let law = law.ready();
        let trial = TrialKey { seed: 4, index: 9, branch: 0 };
        let drawn: Vec<(f64, f64)> = (0..4000).map(|n| delay(trial, 77, n, &law)).collect();
        assert!(drawn.iter().all(|(delay, _)| (2.0..5.0).contains(delay)));
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| drawn.iter().map(f).sum::<f64>() / 4000.0;
        assert!((mean(&|d| d.0) - 3.5).abs() < 0.05);
        assert!((mean(&|d| d.1) - 0.5).abs() < 0.02);
        // The two are independent.
        assert!((mean(&|d| (d.0 - 3.5) * (d.1 - 0.5))).abs() < 0.02);
        assert_ne!(delay(trial, 78, 0, &law), drawn[0]);
    }
}
