//! Reader of the ETH/BIWI walking pedestrians (`obsmat.txt`).
//!
//! Pellegrini, Ess, Schindler, Van Gool, "You'll Never Walk Alone", ICCV 2009. Blank-separated columns
//! `frame id x z y vx vz vy`, in metres and metres per second; all numbers are written as floats. Position
//! is (x, y), velocity is (vx, vy); the height z is always 0 and is only checked to be a number.
//!
//! The file does not say how fast it was filmed. All sequences of the set are annotated every 0.4 s, so
//! the distance in frames between two observations of one person gives the rate: 10 frames mean 25 frames
//! per second (hotel), 6 mean 15 (eth). Time 0 is the first annotated frame of the file.

use super::line::{LineError, numbers};
use super::recording::{Clock, Person, Recording};
use super::rows::{Row, people, usual_stride};
use crate::base::geometry::{Vec2, coordinate_fault};

/// Seconds between two annotations, in every sequence of the set.
const SECONDS_PER_ANNOTATION: f64 = 0.4;
/// Frames between two annotations if no person was annotated twice, as at 25 frames per second.
const DEFAULT_STRIDE: u32 = 10;

/// So many metres tell how places and velocities belong together, and so far apart they do not. In the published tables the
/// velocities are differences of places, so that the two agree to a millionth.
const ENOUGH: f64 = 5.0;
const DOUBTFUL: f64 = 1.15;

const NAMES: [&str; 8] = ["frame", "id", "x", "z", "y", "vx", "vz", "vy"];

/// Reads a whole `obsmat.txt`. Empty lines are passed over.
///
/// # Errors
/// Every bad line: not eight columns, a field that is not a finite number, a position too far from the origin, a frame or id that is no whole
/// number from 0 to 4294967295, and a person who is in one frame twice; in the order of the lines. A text
/// without any row is one error, and so is one whose velocities tell of another interval.
pub fn read_eth_biwi(text: &str) -> Result<Recording, Vec<LineError>> {
    read_table(text, None)
}

/// The same, with the frames per second of the film where they are known.
pub(super) fn read_table(text: &str, fps: Option<f64>) -> Result<Recording, Vec<LineError>> {
    let mut heights = Vec::new();
    let mut rows = Vec::with_capacity(text.len() / 128);
    let mut errors = Vec::new();
    for (k, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        if let Some((row, height)) = read_row(k + 1, line, &mut errors) {
            rows.push(row);
            heights.push(height);
        }
    }
    let is_flat = rows.windows(2).all(|pair| pair[0].position.y == pair[1].position.y);
    if is_flat && heights.windows(2).any(|pair| pair[0] != pair[1]) {
        let message = "column 5 (y) has one value in all rows, and column 4 (the height z) has many: \
                       the columns seem to be exchanged; write `frame id x z y vx vz vy`";
        errors.push(LineError::of_file(message));
    }
    let people = people(rows, errors, |row| format!("in frame {}", row.frame))?;
    let stride = usual_stride(&people).unwrap_or(DEFAULT_STRIDE);
    let usual = fps.map_or(SECONDS_PER_ANNOTATION, |fps| f64::from(stride) / fps);
    if let Some(seconds) = other_interval(&people, stride, usual) {
        let whose = if fps.is_some() { "the stated frames per second give" } else { "the format has" };
        let message = format!(
            "the velocities in the file imply annotations {seconds:.2} s apart, but {whose} {usual} s"
        );
        return Err(vec![LineError::of_file(message)]);
    }
    Ok(Recording::new(people, Clock::film(stride, usual / f64::from(stride))))
}

/// A row and its height.
fn read_row(at: usize, line: &str, errors: &mut Vec<LineError>) -> Option<(Row, f64)> {
    let count = line.split_whitespace().count();
    if count != NAMES.len() {
        let message = format!(
            "{count} column{} where {} are expected: {}",
            if count == 1 { "" } else { "s" },
            NAMES.len(),
            NAMES.join(" ")
        );
        errors.push(LineError::whole(at, message));
        return None;
    }
    let before = errors.len();
    let values = numbers(at, line, NAMES, errors);
    let position = Vec2::new(values[2], values[4]);
    if let Some(fault) = coordinate_fault(position) {
        errors.push(LineError::whole(at, fault));
    }
    let velocity = Some(Vec2::new(values[5], values[7]));
    let row = Row { line: at, frame: values[0] as u32, id: values[1] as u32, position, velocity };
    (errors.len() == before).then_some((row, values[3]))
}

/// Seconds between two annotations, if places and velocities together tell clearly that these are others.
fn other_interval(people: &[Person], stride: u32, usual: f64) -> Option<f64> {
    let (mut gone, mut told) = (0.0, 0.0);
    // From end to end: who waits is annotated here and there, and goes nowhere.
    for person in people {
        let (mut way, mut sum) = (Vec2::zeros(), Vec2::zeros());
        for pair in person.samples.windows(2) {
            let annotations = f64::from(pair[1].frame - pair[0].frame) / f64::from(stride);
            way += pair[1].position - pair[0].position;
            let velocities = pair.iter().filter_map(|sample| sample.velocity).sum::<Vec2>();
            sum += velocities * (0.5 * annotations * usual);
        }
        gone += way.norm();
        told += sum.norm();
    }
    let most = if gone > told { gone } else { told };
    let clear =
        most > ENOUGH && gone > 0.0 && told > 0.0 && !(1.0 / DOUBTFUL..DOUBTFUL).contains(&(gone / told));
    clear.then(|| usual * gone / told)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_three_and_five_are_the_position() {
        let recording = read_eth_biwi("1 7 1.5 0 -2 0.1 0 0.2\n\n11 7 1.6 0 -1 0.1 0 0.2\n").unwrap();
        let seen = recording.at(0.0);
        assert_eq!(seen.len(), 1);
        assert_eq!(
            (seen[0].id, seen[0].position, seen[0].velocity),
            (7, Vec2::new(1.5, -2.0), Vec2::new(0.1, 0.2))
        );
        assert_eq!(recording.frames_per_second(), 25.0);
        assert_eq!(recording.duration(), 0.4);
    }

    #[test]
    fn all_faults_come_at_once_and_in_order() {
        let text = "1 1 0 0 0 0 0 0\n1 2 0 0\n-5 x 0 0 inf 0 0 0\n1 1 9 0 9 0 0 0\n1.5 3 0 0 0 0 0 0\n\
                    1 5000000000 0 0 0 0 0 NaN\n";
        let said: Vec<String> = read_eth_biwi(text).unwrap_err().iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "line 2: 4 columns where 8 are expected: frame id x z y vx vz vy",
                "line 3, column 1: frame `-5` is negative",
                "line 3, column 4: id `x` is not a number",
                "line 3, column 10: y `inf` is not a finite number",
                "line 4: person 1 is in frame 1 twice, first in line 1",
                "line 5, column 1: frame `1.5` is not a whole number",
                "line 6, column 3: id `5000000000` is too large",
                "line 6, column 24: vy `NaN` is not a finite number",
            ]
        );
        let far = read_eth_biwi("1 1 0 0 2e6 0 0 0\n").unwrap_err();
        assert_eq!(far[0].to_string(), "line 1: a coordinate must lie between -1e6 m and 1e6 m (got 2e6 m)");
        assert_eq!(read_eth_biwi(" \n").unwrap_err()[0].to_string(), "the file contains no observation");
    }

    #[test]
    fn other_intervals_are_told_by_the_velocities() {
        let table = |frames: u32| -> String {
            (0..80)
                .map(|k| format!("{} 1 {} 0 0 1 0 0\n", k * frames, f64::from(k * frames) / 25.0))
                .collect()
        };
        // At 25 frames per second, every tenth is what the format means, every twentieth is not.
        let known =
            (0..80).map(|k| format!("{} 1 {} 0 0 1 0 0\n", k * 10, f64::from(k) * 0.4)).collect::<String>();
        assert!(read_eth_biwi(&known).is_ok());
        let said = read_eth_biwi(&table(20)).unwrap_err();
        assert!(said[0].to_string().starts_with("the velocities"), "{said:?}");
        assert!(said[0].message.contains("annotations 0.80 s apart"), "{said:?}");
        // Nearer ones, and few rows.
        let short = |frames: u32, rows: u32| -> String {
            let at = |k: u32| f64::from(k * frames) / 25.0;
            (0..rows).map(|k| format!("{} 1 {} 0 0 1 0 0\n", k * 10, at(k))).collect()
        };
        for (frames, rows, clear) in
            [(8, 20, true), (12, 20, true), (1, 20, true), (9, 20, false), (20, 5, false)]
        {
            assert_eq!(read_eth_biwi(&short(frames, rows)).is_err(), clear, "{frames} {rows}");
        }
        // People who wait, annotated to within some centimetres.
        let jitter = |k: u32| f64::from(k * 7919 % 101) / 1_000.0;
        let waiting: String = (0..4_000)
            .map(|k| {
                let speed = (jitter(k + 1) - jitter(k.max(1) - 1)) / 0.8;
                format!("{} 1 {} 0 0 {speed} 0 0\n", k * 10, jitter(k))
            })
            .collect();
        assert!(read_eth_biwi(&waiting).is_ok());
    }

    #[test]
    fn six_frames_apart_mean_fifteen_per_second() {
        let recording = read_eth_biwi("780 1 0 0 0 0 0 0\n786 1 1 0 0 0 0 0\n798 2 1 0 0 0 0 0").unwrap();
        assert!((recording.frames_per_second() - 15.0).abs() < 1e-12);
        assert!((recording.time_of(798) - 1.2).abs() < 1e-12);
    }

    #[test]
    fn exchanged_columns_and_other_rates_are_refused() {
        let rows = |row: fn(f64, f64) -> String| -> String {
            (0..20).map(|k| format!("{} 1 {}\n", k * 10, row(f64::from(k) * 0.4, f64::from(k)))).collect()
        };
        let exchanged = read_eth_biwi(&rows(|x, y| format!("{x} {y} 0 1 0 0"))).unwrap_err();
        assert!(exchanged[0].message.contains("the columns seem to be exchanged"), "{exchanged:?}");
        assert!(read_eth_biwi(&rows(|x, _| format!("{x} 0 0 1 0 0"))).is_ok(), "somebody may walk along x");
        let right = rows(|x, _| format!("{x} 0 1 1 0 0"));
        assert_eq!(read_table(&right, Some(25.0)).unwrap(), read_eth_biwi(&right).unwrap());
        let found = read_table(&right, Some(2.5)).unwrap_err();
        assert!(
            found[0].message.ends_with("0.40 s apart, but the stated frames per second give 4 s"),
            "{found:?}"
        );
        // Velocities of 0 are none.
        let blank = read_eth_biwi(&rows(|x, _| format!("{x} 0 1 0 0 0"))).unwrap();
        assert_eq!(blank.velocity(), super::super::recording::Velocity::Seen);
        assert!((blank.at(4.0)[0].velocity.x - 1.0).abs() < 1e-9);
    }
}
