//! Reader of the trajectories of `PedPy` and the pedestrian data archive of Jülich: a comment `# framerate: N`, then
//! rows `id frame x y [z]`, separated by blanks, in metres, in another order if a comment says so. The height z is only checked to be a number.

use super::line::{LineError, number, numbers, quoted};
use super::recording::{Clock, Recording};
use super::rows::{Row, agreed, people, usual_stride};
use crate::base::geometry::{Vec2, coordinate_fault};
use crate::base::math::median;

const NAMES: [&str; 5] = ["id", "frame", "x", "y", "z"];

/// Other names of the columns in headers.
const ALIASES: [&[&str]; 4] = [
    &["id", "person", "personid", "person_id", "pers", "ped", "pedestrian", "agent", "agent_id"],
    &["frame", "fr", "frames", "frame_id", "framenumber", "frame_number"],
    &["x"],
    &["y"],
];

/// A comment with one of these words is about the coordinates.
const PLACES: [&str; 6] = ["x", "y", "coordinates", "positions", "unit", "units"];
/// Units that are not metres, as comments write them.
const UNITS: [&str; 6] = ["cm", "mm", "inch", "inches", "ft", "feet"];

/// Reads a whole file. Empty lines and other comments are passed over. A comment that names the columns gives their order.
/// Time 0 is the first frame; velocities are the seen ones. `fps` is the frame rate where the file has none.
///
/// # Errors
/// No frame rate, a second one that differs, positions in another unit, a header that lacks a column, rows that seem to have
/// another order than `id frame x y` without a header that says so, and every bad line: not four or five columns, a
/// field that is not a finite number, an id or a frame that is not a whole number, a position too far from the origin,
/// and a person who is in one frame twice.
pub fn read_pedpy(text: &str, fps: Option<f64>) -> Result<Recording, Vec<LineError>> {
    let (mut errors, mut rate, mut header) = (Vec::new(), None::<(f64, usize)>, None);
    let mut rows = Vec::with_capacity(text.len() / 32);
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let Some(comment) = line.trim_start().strip_prefix('#') else {
            rows.extend(read_row(k + 1, line, header.unwrap_or([0, 1, 2, 3]), &mut errors));
            continue;
        };
        let word = |known: &&&str| {
            comment.split(|c: char| !c.is_alphanumeric()).any(|word| word.eq_ignore_ascii_case(known))
        };
        let is_of_places = PLACES.iter().any(|known| word(&known));
        if let Some(unit) = UNITS.iter().find(word).filter(|unit| **unit == "cm" || is_of_places) {
            let message = format!("positions must be in metres (the comment says {unit})");
            errors.push(LineError::whole(k + 1, message));
        }
        match columns(comment) {
            Some(Ok(found)) => header = Some(found),
            Some(Err(lacking)) => {
                let message = format!("the header names no column `{lacking}`; write `# id frame x y`");
                errors.push(LineError::whole(k + 1, message));
            }
            None => {}
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
    if header.is_none() && has_frames_first(&rows) {
        let message = "the columns seem to be `frame id x y`, as in the text files of Social GAN, not `id frame x y`: \
                       write the lines `# framerate: N` and `# frame id x y` at the top";
        errors.push(LineError::of_file(message));
    }
    let rate = agreed(rate.map(|(rate, _)| rate), fps, &mut errors);
    if rate.is_none() && errors.is_empty() && !rows.is_empty() {
        errors.push(LineError::of_file("the file has no comment `# framerate: N`"));
    }
    let people = people(rows, errors, |row| format!("in frame {}", row.frame))?;
    let stride = usual_stride(&people).unwrap_or(1);
    Ok(Recording::new(people, Clock::film(stride, 1.0 / rate.unwrap_or(1.0))))
}

/// The places of id, frame, x and y if a comment is the header of a table, or the first one that it does not name. Names may
/// have a unit, as `x/m` and `x[m]`.
fn columns(comment: &str) -> Option<Result<[usize; 4], &'static str>> {
    let words = || {
        comment
            .split(|c: char| c.is_whitespace() || ",;".contains(c))
            .filter(|word| !word.is_empty() && !word.starts_with(['[', '(']))
    };
    let name = |word: &str| word.split(['/', '[', '(']).next().unwrap_or_default().to_ascii_lowercase();
    let places = ALIASES.map(|names| words().position(|word| names.contains(&name(word).as_str())));
    let is_header = (4..=NAMES.len()).contains(&words().count())
        && places[2].is_some()
        && places[3].is_some()
        && places[..2].iter().any(Option::is_some);
    let lacking = places.iter().position(Option::is_none);
    is_header.then(|| lacking.map_or(Ok(places.map(Option::unwrap_or_default)), |k| Err(NAMES[k])))
}

/// Whether those who have one number in the column of ids are much farther from each other than those who have one in the
/// column of frames: then people stand in the second column.
fn has_frames_first(rows: &[Row]) -> bool {
    let apart = |key: fn(&Row) -> (u32, u32)| {
        let mut sorted: Vec<&Row> = rows.iter().collect();
        sorted.sort_unstable_by_key(|row| key(row));
        let pairs = sorted.windows(2).filter(|pair| key(pair[0]).0 == key(pair[1]).0);
        median(pairs.map(|pair| (pair[1].position - pair[0].position).norm()))
    };
    let (ids, frames) = (apart(|row| (row.id, row.frame)), apart(|row| (row.frame, row.id)));
    ids.zip(frames).is_some_and(|(ids, frames)| ids > 2.0 * frames)
}

/// The row of a line with id, frame, x and y at these places.
fn read_row(line: usize, text: &str, places: [usize; 4], errors: &mut Vec<LineError>) -> Option<Row> {
    let count = text.split_whitespace().count();
    if !(4..=5).contains(&count) {
        let message = format!("{count} columns where 4 or 5 are expected: id frame x y [z]");
        errors.push(LineError::whole(line, message));
        return None;
    }
    let before = errors.len();
    let mut names = [NAMES[4]; NAMES.len()];
    for (name, place) in NAMES.iter().zip(places) {
        names[place] = name;
    }
    let values = numbers(line, text, names, errors);
    let [id, frame, x, y] = places.map(|place| values[place]);
    let position = Vec2::new(x, y);
    if let Some(fault) = coordinate_fault(position) {
        errors.push(LineError::whole(line, fault));
    }
    let row = Row { line, frame: frame as u32, id: id as u32, position, velocity: None };
    (errors.len() == before).then_some(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_comment_has_the_rate() {
        let text = "# description: a corridor\n# framerate: 16 fps\n#ID\tFR\tX\tY\tZ\n1\t0\t8.25\t3.5\t1.7\n1 1 8.5 3.5\n";
        let recording = read_pedpy(text, None).unwrap();
        assert!((recording.frames_per_second() - 16.0).abs() < 1e-12);
        assert_eq!(recording.people()[0].samples[1].velocity, Some(Vec2::new(4.0, 0.0)));
    }

    #[test]
    fn all_faults_come_at_once_and_in_order() {
        let said: Vec<String> = read_pedpy(
            "# framerate: 0\n# framerate: 25\n# framerate: 10\n# x/cm\n1 2 3\n1.5 0 x 0\n1 1 0 0\n1 1 0 0\n",
            None,
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
            read_pedpy("1 1 0 0", None).unwrap_err()[0].to_string(),
            "the file has no comment `# framerate: N`"
        );
    }

    fn rows(order: [usize; 4], header: &str) -> String {
        let mut text = header.to_owned();
        for frame in 0..12 {
            for (id, y) in [(1, 0.0), (2, 1.5), (3, 3.0)] {
                let cells = [f64::from(id), f64::from(frame), 0.5 * f64::from(frame) + y, y];
                text += &order.map(|k| cells[k].to_string()).join(" ");
                text += "\n";
            }
        }
        text
    }

    #[test]
    fn a_header_gives_the_order_by_its_names() {
        let wanted = read_pedpy(&rows([0, 1, 2, 3], ""), Some(2.0)).unwrap();
        assert_eq!(wanted.ids().collect::<Vec<_>>(), [1, 2, 3]);
        for (order, header) in [
            ([1, 0, 2, 3], "# frame id x/m y/m\n"),
            ([1, 0, 2, 3], "#Frame\tPersID\tX[m]\tY[m]\n".replace("PersID", "PersonID").as_str()),
            ([2, 3, 1, 0], "# x [m] y [m] fr ped\n"),
            ([0, 1, 2, 3], "# the frame of each person has x and y\n"),
        ] {
            assert_eq!(read_pedpy(&rows(order, header), Some(2.0)).unwrap(), wanted, "{header}");
        }
        for (header, said) in [
            ("# id time x y\n", "line 1: the header names no column `frame`; write `# id frame x y`"),
            ("# frame x/mm y/mm z/mm\n", "line 1: positions must be in metres (the comment says mm)"),
            ("# x, y: inch\n", "line 1: positions must be in metres (the comment says inch)"),
        ] {
            let found = read_pedpy(&rows([0, 1, 2, 3], header), Some(2.0)).unwrap_err();
            assert_eq!(found[0].to_string(), said);
        }
        assert!(read_pedpy(&rows([0, 1, 2, 3], "# seen with a lens of 8 mm\n"), Some(2.0)).is_ok());
    }

    #[test]
    fn frames_before_ids_without_a_header_are_refused() {
        let found = read_pedpy(&rows([1, 0, 2, 3], ""), Some(2.0)).unwrap_err();
        assert!(found[0].message.starts_with("the columns seem to be `frame id x y`"), "{found:?}");
    }

    #[test]
    fn a_stated_rate_is_taken_unless_the_file_has_another() {
        let text = rows([0, 1, 2, 3], "# framerate: 2.5\n");
        assert!(read_pedpy(&text, Some(2.5)).is_ok());
        let found = read_pedpy(&text, Some(25.0)).unwrap_err();
        assert_eq!(found[0].to_string(), "the file has 2.5 frames per second, but 25 are stated");
        assert_eq!(read_pedpy(&rows([0, 1, 2, 3], ""), Some(4.0)).unwrap().frames_per_second(), 4.0);
    }
}
