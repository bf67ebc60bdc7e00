//! Continuous time as whole numbers: every instant, and the open span right after it, has an index.
//!
//! A tick is divided into 2^k units, so many that the horizon is 2^58 to 2^59 units; times of jumps are
//! rounded down to units once, when they come in, and bounds are whole ticks. From there on everything is exact. Of two
//! jumps that are a whole number of ticks apart the moments are, too, where it is known what rounding took off their times.
//! Moment 2u is the instant u, moment 2u + 1 the open span between u and u + 1. Nothing changes inside
//! such a span, so a function of time is a function of moments, and its ends are open or closed as the
//! moments are odd or even. A shift in time by d units is a shift by 2d moments.

use crate::base::decimal::Decimal;
use crate::base::instant::Instant;
use crate::base::tick::Tick;

/// An instant (even) or the open span right after it (odd).
pub(super) type Moment = i64;

/// A shift that leaves every horizon behind.
pub(super) const FOREVER: Moment = 1 << 62;

/// Longest horizon in ticks.
pub(super) const LONGEST_HORIZON: u64 = 1 << 40;

/// The instant in which, or right after which, a moment lies.
pub(super) fn instant(moment: Moment) -> Moment {
    moment & !1
}

/// How seconds and ticks become moments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    bits: u32,
    horizon: u64,
    seconds_per_tick: (f64, f64),
    units_per_second: f64,
    ticks_per_unit: f64,
    /// Units in a second.
    units: Instant,
    /// A tick, s.
    quantum: Decimal,
}

impl Scale {
    /// `quantum` is the length of a tick in seconds, `horizon` at most [`LONGEST_HORIZON`] ticks.
    pub(super) fn new(horizon: Tick, quantum: Decimal) -> Self {
        let bits = 59 - (64 - horizon.0.leading_zeros()).max(1);
        let seconds_per_tick = (quantum.numerator() as f64, quantum.denominator() as f64);
        let units_per_second = seconds_per_tick.1 / seconds_per_tick.0 * (1u64 << bits) as f64;
        let ticks_per_unit = 1.0 / (1u64 << bits) as f64;
        let ticks = Decimal::ONE
            .div(quantum)
            .map_or(Instant::exactly(units_per_second * ticks_per_unit), Instant::from);
        // By a power of two nothing is rounded.
        let power = (1u64 << bits) as f64;
        let units = Instant { seconds: ticks.seconds * power, rest: ticks.rest * power };
        Self { bits, horizon: horizon.0, seconds_per_tick, units_per_second, ticks_per_unit, units, quantum }
    }

    /// The length of a tick, s.
    pub(super) fn quantum(self) -> Decimal {
        self.quantum
    }

    /// The moment right after the instant of the horizon.
    pub(super) fn end(self) -> Moment {
        self.shift(Tick(self.horizon)) + 1
    }

    /// Seconds of so many ticks.
    pub(super) fn time(self, ticks: Tick) -> f64 {
        ticks.0 as f64 * self.seconds_per_tick.0 / self.seconds_per_tick.1
    }

    /// Seconds of so many ticks, exactly.
    pub(super) fn exact(self, ticks: Tick) -> Instant {
        let exact = Decimal::ratio(i128::from(ticks.0), 1).and_then(|ticks| ticks.mul(self.quantum));
        exact.map_or(Instant::from(self.time(ticks)), Instant::from)
    }

    /// Seconds up to the horizon.
    pub(super) fn horizon(self) -> Instant {
        self.exact(Tick(self.horizon))
    }

    /// The number of moments in so many ticks; more than the horizon holds are one tick more than it.
    pub(super) fn shift(self, ticks: Tick) -> Moment {
        (ticks.0.min(self.horizon + 1) as i64) << (self.bits + 1)
    }

    /// The instant of a time, at most the end. Of one of which nobody knows what rounding took off, the double nearest to a
    /// tick is that tick.
    pub(super) fn at(self, time: Instant) -> Moment {
        let seconds = time.seconds;
        if !time.rest.is_nan() {
            // Near enough to be counted; what is beyond the horizon shows then.
            let is_near = seconds * self.units_per_second <= self.end() as f64;
            return if is_near { (2 * time.floor_by(self.units).max(0)).min(self.end()) } else { self.end() };
        }
        if let Some(moment) = self.on_tick(seconds) {
            return moment;
        }
        let units = seconds * self.units_per_second;
        if units <= (self.end() / 2) as f64 { 2 * (units as i64).max(0) } else { self.end() }
    }

    /// The moment of a number of seconds that is the double nearest to a tick up to the horizon.
    fn on_tick(self, seconds: f64) -> Option<Moment> {
        let ticks = (seconds * self.units_per_second * self.ticks_per_unit + 0.5).floor();
        let meets = (0.0..=self.horizon as f64).contains(&ticks)
            && ticks * self.seconds_per_tick.0 / self.seconds_per_tick.1 == seconds;
        meets.then(|| self.shift(Tick(ticks as u64)))
    }

    /// A finite number of seconds as a shift, to the nearest unit or to a tick, kept within some horizons.
    pub(super) fn span(self, seconds: f64) -> Moment {
        if let Some(moment) = self.on_tick(seconds) {
            return moment;
        }
        if let Some(moment) = self.on_tick(-seconds) {
            return -moment;
        }
        let (units, most) = (seconds * self.units_per_second, self.end() as f64);
        2 * ((units.max(-most).min(most) + 0.5).floor() as i64)
    }

    /// Seconds of a number of moments between instants.
    pub(super) fn seconds(self, moments: Moment) -> f64 {
        (moments / 2) as f64 / self.units_per_second
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_seconds_is_the_same_moment_as_the_instant() {
        for (quantum, horizon) in [("0.000000001", 7_000_000_000), ("0.1", 70), ("0.3", 30)] {
            let scale = Scale::new(Tick(horizon), Decimal::parse(quantum).unwrap());
            for ticks in (0..horizon).step_by((horizon / 70).max(1) as usize) {
                let seconds = scale.time(Tick(ticks));
                assert_eq!(scale.span(seconds), scale.at(seconds.into()), "{seconds}");
                assert_eq!(scale.span(-seconds), -scale.at(seconds.into()), "{seconds}");
            }
        }
    }

    #[test]
    fn ticks_and_seconds_meet_and_come_back() {
        for (quantum, horizon) in [
            ("1", 10),
            ("0.1", 100),
            ("0.25", 1),
            ("60", 1 << 40),
            ("1", 0),
            ("0.000000001", 1_070_000_000),
            ("0.000000001", 8_300_000_000),
            ("0.000000001", 2_140_000_000),
        ] {
            let scale = Scale::new(Tick(horizon), Decimal::parse(quantum).unwrap());
            for ticks in [0, horizon / 3, horizon] {
                let seconds = scale.time(Tick(ticks));
                assert_eq!(
                    scale.at(seconds.into()),
                    scale.shift(Tick(ticks)).min(scale.end()),
                    "{quantum} {ticks}"
                );
                assert_eq!(scale.seconds(scale.shift(Tick(ticks))), seconds);
                assert_eq!(scale.span(seconds), scale.shift(Tick(ticks)));
            }
            // The horizon itself is within it, also where it is known exactly.
            let last = scale.time(Tick(horizon));
            for exact in [Instant::decimal(last), Instant::exactly(0.0).after(Instant::decimal(last))] {
                assert_eq!(scale.at(exact), scale.end() - 1, "{quantum} {horizon}");
            }
            assert_eq!(scale.at(Instant::exactly(last * 1.000_001 + 1.0)), scale.end());
            assert_eq!(scale.at(f64::INFINITY.into()), scale.end());
            assert!(scale.end() > 0 && scale.end() < FOREVER / 2);
        }
    }
}
