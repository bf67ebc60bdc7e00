//! How likely the recorded motion is among trials: speeds, accelerations, distances, times to collision, contacts.
//!
//! As in the Waymo challenge for simulated agents (Montali et al. 2023, arXiv 2305.12032, section 4): of each person and each step of the
//! recording, the numbers of 32 trials make a histogram with a tenth of a count added to each bin, and the score is the logarithm of
//! the share of the bin in which the recorded number lies. All persons of a time are simulated together; only those who
//! are recorded throughout count, in the recording and in trials alike.

use super::Diagnosed;
use super::evaluate::PREDICTED;
use super::formulas::targets;
use super::measure::encounters::meeting;
use super::monitor::Judged;
use super::situation::Replay;
use crate::base::geometry::Vec2;
use crate::base::math;
use crate::base::tick::Tick;
use crate::engine::trials::sample::{Followed, sample};
use crate::engine::{PreparedWorld, Threads};
use crate::kernel::driver::MakeDrivers;
use crate::trials::cell::Series;

/// What is scored.
pub const FEATURES: [&str; 5] = ["speed", "acceleration", "nearest", "time to collision", "contact"];
/// Trials of each time.
pub const ROLLOUTS: u64 = 32;
/// Bins of each number, and the end of the last one: m/s, m/s^2, m, s, and whether.
const BINS: [(usize, f64); 5] = [(20, 3.0), (20, 5.0), (20, 5.0), (20, 10.0), (2, 2.0)];
/// Added to the count of each bin.
const ADDED: f64 = 0.1;

/// A person, the sums of the logarithms of all steps, and the number of steps.
pub type PersonRealism = (u32, [f64; FEATURES.len()], u64);

/// The scores of persons with a kind.
///
/// # Errors
/// What is wrong with the model.
pub fn realism(
    replay: &Replay,
    kind: &str,
    instants: &[Judged],
    seed: u64,
    (threads, drivers): (&Threads, &MakeDrivers),
) -> Diagnosed<Vec<PersonRealism>> {
    let own = replay.with_kind(kind)?;
    let groups = instants.chunk_by(|a, b| a.instant.time == b.instant.time);
    let times: Vec<(u64, &[Judged])> = (0..).zip(groups).collect();
    let one = |(number, group): &(u64, &[Judged])| {
        let series = Series { seed, branch: (number & 0xffff) as u16 };
        at_one_time(&own, group, series, drivers)
    };
    Ok(threads.map(&times, one).into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

fn at_one_time(
    replay: &Replay,
    group: &[Judged],
    series: Series,
    drivers: &MakeDrivers,
) -> Diagnosed<Vec<PersonRealism>> {
    let Some(Judged { instant: user, reach: Some(reach), .. }) = group.first() else { return Ok(Vec::new()) };
    let Some(study) = replay.study_if_placed(*user)? else { return Ok(Vec::new()) };
    let index = targets(&study).first().map_or(study.base, |target| target.world);
    let Some(prepared) = PreparedWorld::of(&study, index, series.seed, drivers) else {
        return Ok(Vec::new());
    };
    let scenario = &study.worlds[index].scenario;
    let (step, dt) = (replay.recording.step(), scenario.clock.seconds(Tick(1)));
    let last = PREDICTED.min(scenario.clock.seconds(scenario.horizon));
    let times: Vec<f64> = (0..=(last / step + 1e-9) as u64).map(|k| k as f64 * step).collect();
    let ticks: Vec<u64> = times.iter().map(|time| (time / dt).round() as u64).collect();
    let (mut agents, mut persons, mut ways) = (Vec::new(), Vec::new(), Vec::new());
    for (agent, id) in replay.persons(user.person, &scenario.agents) {
        let way: Option<Vec<Vec2>> = times.iter().map(|time| replay.place_at(id, user.time + time)).collect();
        if let Some(way) = way {
            agents.push(agent);
            persons.push(id);
            ways.push(way);
        }
    }
    let followed = Followed { agents: &agents, ticks: &ticks };
    let found = sample(&prepared, &[], series, ROLLOUTS, followed).unwrap_or_default();
    let count = agents.len();
    let trials: Vec<Vec<[f64; 5]>> = found
        .paths
        .iter()
        .filter(|path| path.len() == count * ticks.len())
        .map(|path| features(count, ticks.len(), (step, *reach), |tick, k| path[tick * count + k]))
        .collect();
    let recorded = features(count, ticks.len(), (step, *reach), |tick, k| ways[k][tick]);
    let mut all = Vec::new();
    for k in (0..count).filter(|k| group.iter().any(|one| one.instant.person == persons[*k])) {
        let places = (0..recorded.len() / count.max(1)).map(|row| row * count + k);
        let (mut sums, mut steps) = ([0.0; 5], 0);
        for place in places {
            for (feature, sum) in sums.iter_mut().enumerate() {
                *sum +=
                    score(feature, recorded[place][feature], trials.iter().map(|one| one[place][feature]));
            }
            steps += 1;
        }
        all.push((persons[k], sums, steps));
    }
    Ok(all)
}

/// The logarithm of the smoothed share of the bin of a number among those of trials.
fn score(feature: usize, recorded: f64, trials: impl Iterator<Item = f64>) -> f64 {
    let (bins, end) = BINS[feature];
    let bin = |x: f64| ((x / end * bins as f64) as usize).min(bins - 1);
    let own = bin(recorded);
    let (same, all) =
        trials.fold((0.0, 0.0), |(same, all), x| (same + f64::from(u8::from(bin(x) == own)), all + 1.0));
    math::ln((same + ADDED) / (all + ADDED * bins as f64))
}

/// The numbers of each step from the second on, of all persons at the first of them, then at the next.
fn features(
    count: usize,
    ticks: usize,
    (step, reach): (f64, f64),
    at: impl Fn(usize, usize) -> Vec2,
) -> Vec<[f64; 5]> {
    let velocity = |tick: usize, k: usize| (at(tick, k) - at(tick - 1, k)) / step;
    let mut all = Vec::new();
    for tick in 2..ticks {
        for k in 0..count {
            let own = velocity(tick, k);
            let (mut nearest, mut collision) = (f64::INFINITY, f64::INFINITY);
            for other in (0..count).filter(|other| *other != k) {
                let apart = at(tick, other) - at(tick, k);
                nearest = math::at_most(nearest, apart.norm());
                collision = math::at_most(collision, meeting(apart, velocity(tick, other) - own, reach));
            }
            let change = (own - velocity(tick - 1, k)).norm() / step;
            all.push([own.norm(), change, nearest, collision, f64::from(u8::from(nearest < reach))]);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_meet_when_their_discs_touch() {
        let head_on = meeting(Vec2::new(5.0, 0.0), Vec2::new(-2.0, 0.0), 0.4);
        assert!((head_on - 2.3).abs() < 1e-12, "{head_on}");
        assert_eq!(meeting(Vec2::new(5.0, 0.5), Vec2::new(-2.0, 0.0), 0.4), f64::INFINITY);
        assert_eq!(meeting(Vec2::new(5.0, 0.0), Vec2::new(2.0, 0.0), 0.4), f64::INFINITY);
        assert_eq!(meeting(Vec2::new(0.3, 0.0), Vec2::new(2.0, 0.0), 0.4), 0.0);
    }

    #[test]
    fn scores_are_logarithms_of_smoothed_shares() {
        let found = score(0, 1.0, [1.01, 1.02, 0.2, 9.0].into_iter());
        assert!((found - math::ln(2.1 / 6.0)).abs() < 1e-12);
        let walk = |tick: usize, k: usize| Vec2::new([0.0, 0.4, 1.2][tick], 2.0 * k as f64);
        let all = features(2, 3, (0.4, 0.4), walk);
        assert_eq!(all.len(), 2);
        assert!((all[0][0] - 2.0).abs() < 1e-12 && (all[0][1] - 2.5).abs() < 1e-12, "{all:?}");
        assert_eq!((all[0][2], all[0][3], all[0][4]), (2.0, f64::INFINITY, 0.0));
    }
}
