//! Reader of the trajectories of `PedPy` and the pedestrian data archive of Jülich: a comment `# framerate: N`, then
//! rows `id frame x y [z]`, separated by blanks, in metres. The height z is only checked to be a number.

use super::line::{LineError, number, numbers, quoted};
use super::recording::{Clock, Recording};
use super::rows::{Row, people, usual_stride};
use crate::base::geometry::{Vec2, coordinate_fault};

const NAMES: [&str; 5] = ["id", "frame", "x", "y", "z"];

/// Reads a whole file. Empty lines and other comments are passed over. Time 0 is the first frame; velocities are the
/// seen ones.
///
/// # Errors
/// No frame rate, a second one that differs, positions in centimetres, and every bad line: not four or five columns, a
/// field that is not a finite number, an id or a frame that is not a whole number, a position too far from the origin,
/// and a person who is in one frame twice.
pub fn read_pedpy(text: &str) -> Result<Recording, Vec<LineError>> {
    let mut errors = Vec::new();
    let mut rows = Vec::with_capacity(text.len() / 32);
    let mut rate: Option<(f64, usize)> = None;
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let Some(comment) = line.trim_start_matches('\u{feff}').trim_start().strip_prefix('#') else {
            rows.extend(read_row(k + 1, line, &mut errors));
            continue;
        };
        if comment.split(|c: char| !c.is_alphanumeric()).any(|word| word == "cm") {
            errors.push(LineError::whole(k + 1, "positions must be in metres (the comment says cm)"));
        }
        let Some(field) = comment.trim_start().strip_prefix("framerate:").map(str::trim) else { continue };
        // The rate may be followed by its unit.
        let field = field.split_whitespace().next().unwrap_or_default();
        match (number(field), rate) {
            (Ok(found), None) if found > 0.0 => rate = Some((found, k + 1)),
            (Ok(found), Some((first, at))) if found > 0.0 => {
                if found != first {
                    let message =
                        format!("framerate is {found}, but {first} in line {at}: the rates are mixed");
                    errors.push(LineError::whole(k + 1, message));
                }
            }
            _ => {
                let message = format!("framerate must be a positive number (got {})", quoted(field));
                errors.push(LineError::whole(k + 1, message));
            }
        }
    }
    if rate.is_none() && errors.is_empty() && !rows.is_empty() {
        errors.push(LineError::of_file("the file has no comment `# framerate: N`"));
    }
    let people = people(rows, errors, |row| format!("in frame {}", row.frame))?;
    let stride = usual_stride(&people).unwrap_or(1);
    Ok(Recording::new(people, Clock::film(stride, 1.0 / rate.map_or(1.0, |(rate, _)| rate))))
}

fn read_row(line: usize, text: &str, errors: &mut Vec<LineError>) -> Option<Row> {
    let count = text.split_whitespace().count();
    if !(4..=5).contains(&count) {
        let message = format!("{count} columns where 4 or 5 are expected: id frame x y [z]");
        errors.push(LineError::whole(line, message));
        return None;
    }
    let before = errors.len();
    let values = numbers(line, text, NAMES, errors);
    let position = Vec2::new(values[2], values[3]);
    if let Some(fault) = coordinate_fault(position) {
        errors.push(LineError::whole(line, fault));
    }
    let row = Row { line, frame: values[1] as u32, id: values[0] as u32, position, velocity: None };
    (errors.len() == before).then_some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_comment_has_the_rate() {
        let text = "# description: a corridor\n# framerate: 16 fps\n#ID\tFR\tX\tY\tZ\n1\t0\t8.25\t3.5\t1.7\n1 1 8.5 3.5\n";
        let recording = read_pedpy(text).unwrap();
        assert!((recording.frames_per_second() - 16.0).abs() < 1e-12);
        assert_eq!(recording.people()[0].samples[1].velocity, Some(Vec2::new(4.0, 0.0)));
    }

    #[test]
    fn all_faults_come_at_once_and_in_order() {
        let said: Vec<String> = read_pedpy(
            "# framerate: 0\n# framerate: 25\n# framerate: 10\n# x/cm\n1 2 3\n1.5 0 x 0\n1 1 0 0\n1 1 0 0\n",
        )
        .unwrap_err()
        .iter()
        .map(ToString::to_string)
        .collect();
        assert_eq!(
            said,
            [
                "line 1: framerate must be a positive number (got `0`)",
                "line 3: framerate is 10, but 25 in line 2: the rates are mixed",
                "line 4: positions must be in metres (the comment says cm)",
                "line 5: 3 columns where 4 or 5 are expected: id frame x y [z]",
                "line 6, column 1: id `1.5` is not a whole number",
                "line 6, column 7: x `x` is not a number",
                "line 8: person 1 is in frame 1 twice, first in line 7",
            ]
        );
        assert_eq!(
            read_pedpy("1 1 0 0").unwrap_err()[0].to_string(),
            "the file has no comment `# framerate: N`"
        );
    }
}
