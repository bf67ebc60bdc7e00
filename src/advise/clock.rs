//! Clocks of sensors: which batches are at times of the stream, and when the stream goes on at the time of a clock that was
//! set anew. No clock is read, so the same lines give the same answers.

use std::collections::BTreeMap;

/// A step in time up to this is never a jump of the only sensor, s; a batch that is so late is only late.
const PAUSE: f64 = 2.0;
/// A step up to this is never a jump of a sensor among others, s.
const SHORT_PAUSE: f64 = 0.5;
/// A step of more than so many usual ones is a jump.
const MOST_STEPS: f64 = 2.5;
/// Sensors do not wait longer between two batches, s; a clock with longer steps counts in other units.
const SLOWEST: f64 = 10.0;
/// A clock is followed after so many batches, and [`PAUSE`], in which no batch came at the time of the stream.
const STAYS: u32 = 5;
/// A sensor that was in none of so many batches is away.
const RECENT: u64 = 100;
/// Sensors that are away are forgotten where there are more than so many.
const MOST_SENSORS: usize = 256;

/// The time of a batch beside the time of the stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Timing {
    /// They belong together.
    InStep,
    /// The clock has jumped by so many seconds. Whether it did so now, and whether it may count milliseconds.
    Jumped { by: f64, is_new: bool, is_scaled: bool },
    /// The clock had jumped, and from now on the stream is at its time.
    Followed,
}

/// The state of the clock of a sensor.
#[derive(Clone, Debug, Default)]
struct Clock {
    /// Time of the last batch, s, and how many batches of all sensors had come.
    last: f64,
    heard: u64,
    /// Time between its batches, s.
    step: Option<f64>,
    /// Batches since the clock jumped; [`STAYS`] from the beginning where it was never in step.
    off: u32,
    /// Batches since the jump, and the time of the first, s; begun anew whenever a batch is in step.
    stayed: u32,
    since: f64,
}

/// The clocks of all sensors.
#[derive(Clone, Debug, Default)]
pub(super) struct Clocks {
    sensors: BTreeMap<String, Clock>,
    batches: u64,
    /// Time between the last two batches of the stream, s.
    step: Option<f64>,
}

impl Clocks {
    /// Reads the time of a batch of a sensor; the stream is at `now`.
    pub(super) fn read(&mut self, sensor: &str, time: f64, now: Option<f64>) -> Timing {
        self.batches += 1;
        let batches = self.batches;
        let is_recent = |other: &Clock| batches - other.heard <= RECENT;
        if self.sensors.len() > MOST_SENSORS {
            self.sensors.retain(|_, other| is_recent(other));
        }
        // Those that may be silenced.
        let counts = |other: &Clock| is_recent(other) && other.off < STAYS;
        let others = self.sensors.iter().filter(|(name, other)| *name != sensor && counts(other));
        let others: Vec<f64> = others.map(|(_, other)| other.last).collect();
        let is_known = self.sensors.contains_key(sensor);
        let clock = self.sensors.entry(sensor.to_owned()).or_default();
        let own = time - std::mem::replace(&mut clock.last, time);
        let step = Some(own).filter(|own| is_known && *own > 0.0);
        clock.heard = batches;
        let usual = clock.step.filter(|step| *step <= SLOWEST).or(self.step);
        let pause = if others.is_empty() || usual.is_none() { PAUSE } else { SHORT_PAUSE };
        let most = usual.map_or(pause, |usual| (MOST_STEPS * usual).max(pause));
        let ahead = now.map_or(0.0, |now| time - now);
        if (-PAUSE..=most).contains(&ahead) {
            self.step = Some(ahead).filter(|ahead| *ahead > 0.0).or(self.step);
            clock.step = step.filter(|_| clock.off == 0).or(clock.step);
            clock.off = 0;
            // A clock in other units does not keep the stream from one that is right.
            if step.is_none_or(|step| step <= SLOWEST) {
                self.sensors.values_mut().for_each(|other| other.stayed = 0);
            }
            return Timing::InStep;
        }
        let was_off = clock.off > 0;
        clock.off = if is_known { clock.off.saturating_add(1) } else { STAYS };
        if clock.stayed == 0 || step.is_none_or(|step| step > SLOWEST) {
            (clock.stayed, clock.since) = (0, time);
        }
        clock.stayed += 1;
        let stays = clock.stayed >= STAYS && time - clock.since >= PAUSE;
        let agrees = others.iter().all(|other| (other - time).abs() <= most);
        let is_confirmed = !others.is_empty() || (was_off && step.is_some());
        if stays || (agrees && is_confirmed) {
            (clock.off, clock.stayed, clock.step, self.step) = (0, 0, step, step);
            return Timing::Followed;
        }
        let in_ms = ahead / 1e3 <= PAUSE || now.is_some_and(|now| (time / 1e3 - now).abs() <= PAUSE);
        let is_scaled = clock.step.is_none() && ahead > SLOWEST && in_ms;
        Timing::Jumped { by: ahead, is_new: !was_off, is_scaled }
    }
}
