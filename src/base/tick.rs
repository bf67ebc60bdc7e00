//! Time: whole ticks of a rational step, on one of three clocks.

use super::decimal::Decimal;

/// A number of steps since the start of a trial, or a length in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Tick(pub u64);

/// How time goes on in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Steps without a length: one tick is one step of every process.
    Steps,
    /// Steps of a fixed length in seconds, exact.
    Stepped(Decimal),
    /// Continuous time: the state is constant between the jumps of processes with rates. Bounds and the
    /// horizon are counted in ticks of so many seconds, exact; jumps may come at any time.
    Jumps(Decimal),
}

impl Clock {
    /// Length of a step in seconds; 1 where steps have no length, 0 in continuous time.
    pub fn step_seconds(self) -> f64 {
        match self {
            Self::Steps => 1.0,
            Self::Stepped(step) => step.to_f64(),
            Self::Jumps(_) => 0.0,
        }
    }

    /// Numerator and denominator of the length of a step in seconds; 1 where steps have none.
    pub fn step_ratio(self) -> (f64, f64) {
        match self {
            Self::Stepped(step) => (step.numerator() as f64, step.denominator() as f64),
            Self::Steps | Self::Jumps(_) => (1.0, 1.0),
        }
    }

    /// Whether it is continuous time.
    pub const fn is_jumps(self) -> bool {
        matches!(self, Self::Jumps(_))
    }

    /// The tick at `time` seconds, or the two nearest ticks if none is exactly there.
    pub fn tick_at(self, time: Decimal) -> Result<Tick, (Tick, Tick)> {
        let ticks = match self {
            Self::Stepped(tick) | Self::Jumps(tick) => time.div(tick),
            Self::Steps => Some(time),
        };
        let Some(ticks) = ticks else { return Err((Tick(0), Tick(u64::MAX))) };
        if ticks.is_negative() {
            return Err((Tick(0), Tick(0)));
        }
        match ticks.as_whole() {
            Some(whole) => u64::try_from(whole).map(Tick).map_err(|_| (Tick(0), Tick(u64::MAX))),
            None => {
                let below = u64::try_from(ticks.floor()).unwrap_or(u64::MAX).min(u64::MAX - 1);
                Err((Tick(below), Tick(below + 1)))
            }
        }
    }

    /// Seconds since the start of the trial at `tick` (steps where steps have no length).
    pub fn seconds(self, tick: Tick) -> f64 {
        match self {
            // Multiply before dividing: 3 steps of 1/3 s are exactly 1 s.
            Self::Stepped(length) | Self::Jumps(length) => {
                tick.0 as f64 * length.numerator() as f64 / length.denominator() as f64
            }
            Self::Steps => tick.0 as f64,
        }
    }
}

/// The number of steps of `dt` seconds after which a time (s) is over: whole numbers are met in spite of rounding.
/// Infinite or NaN as the time is.
pub fn steps_over(time: f64, dt: f64) -> f64 {
    let exact = time / dt;
    let nearest = exact.round();
    if (exact - nearest).abs() <= 1e-9 * nearest.abs() { nearest } else { exact.ceil() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_of_steps_are_met() {
        assert_eq!([steps_over(2.0, 0.02), steps_over(0.7, 0.1), steps_over(1.1, 0.1)], [100.0, 7.0, 11.0]);
        assert_eq!([steps_over(0.0, 0.1), steps_over(0.01, 0.1), steps_over(0.1001, 0.1)], [0.0, 1.0, 2.0]);
        assert_eq!(steps_over(f64::INFINITY, 0.1), f64::INFINITY);
    }

    #[test]
    fn a_bound_is_a_whole_number_of_ticks_or_names_its_neighbours() {
        let clock = Clock::Stepped(Decimal::parse("0.02").unwrap());
        assert_eq!(clock.tick_at(Decimal::parse("10").unwrap()), Ok(Tick(500)));
        assert_eq!(clock.tick_at(Decimal::parse("0.05").unwrap()), Err((Tick(2), Tick(3))));
        let sixtieth = Clock::Stepped(Decimal::ratio(1, 60).unwrap());
        assert_eq!(sixtieth.tick_at(Decimal::whole(100)), Ok(Tick(6000)));
        assert_eq!(sixtieth.seconds(Tick(60)), 1.0);
    }
}
