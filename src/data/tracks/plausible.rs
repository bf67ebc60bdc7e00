//! Whether a recording can be one of people who walk: their speed, the distances between them, and their velocities against
//! their positions. Medians are judged, not single rows, and only of people who go somewhere.

use super::recording::{Person, Recording, Velocity};
use crate::base::geometry::Vec2;
use crate::base::math::{self, median};
use std::ops::Range;

/// An implausible number of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// The number, and those of people.
    pub said: String,
    /// The likely cure.
    pub cure: String,
}

/// Speeds of people who go somewhere, and the usual one, m/s.
const SPEEDS: Range<f64> = 0.1..3.0;
const USUAL_SPEED: f64 = 1.2;
/// Distances to the nearest other person, m.
const DISTANCES: Range<f64> = 0.15..20.0;
/// The units that a file may have instead of metres, and the factor to metres; a penalty, so that inches must fit better than centimetres.
const UNITS: [(&str, f64, f64); 5] = [
    ("millimetres", 1e-3, 0.0),
    ("centimetres", 1e-2, 0.0),
    ("inches", 0.0254, 0.7),
    ("feet", 0.3048, 0.7),
    ("degrees", 111_195.0, 0.0),
];
const MILLISECONDS: &str = "the times look like milliseconds: convert them to seconds";
/// Recordings of people have a shorter step, s.
const LONGEST_STEP: f64 = 10.0;
/// Fewer rows of people who go somewhere show nothing.
const ENOUGH: usize = 10;
/// At most so many frames are searched for distances.
const FRAMES: usize = 50;

/// A person who goes somewhere.
struct Going {
    rows: usize,
    seconds: f64,
    way: Vec2,
    /// The way that the velocities tell, where they are recorded.
    told: Vec2,
}

/// The likely cause of a speed, with the distance to the nearest other person.
fn cure_of_speed(speed: f64, apart: Option<f64>) -> String {
    let fits = |speed: f64, factor: f64| {
        SPEEDS.contains(&speed) && apart.is_none_or(|apart| DISTANCES.contains(&(apart * factor)))
    };
    if fits(speed * 1e3, 1.0) {
        return MILLISECONDS.to_owned();
    }
    let off = |factor: f64| math::ln(speed * factor / USUAL_SPEED).abs();
    let units = UNITS.into_iter().filter(|(_, factor, _)| fits(speed * factor, *factor));
    match units.min_by(|(_, a, more), (_, b, most)| (off(*a) + more).total_cmp(&(off(*b) + most))) {
        Some((name, ..)) => format!("the coordinates look like {name}: convert them to metres"),
        None => {
            let longer = speed / USUAL_SPEED;
            format!(
                "check the unit of x and y (m), and the times: {longer:.3} times as long they would be usual"
            )
        }
    }
}

impl Recording {
    /// The implausible number.
    pub fn doubt(&self) -> Option<Doubt> {
        let doubt = |said: String, cure: String| Some(Doubt { said, cure });
        if self.velocities_are_blank() {
            return doubt(
                "all velocities of the file are 0, but people move; those of the positions are taken"
                    .to_owned(),
                "leave the columns of velocities out, or write `velocity = seen`".to_owned(),
            );
        }
        let going = self.going();
        if going.iter().map(|one| one.rows).sum::<usize>() < ENOUGH {
            return None;
        }
        let speed = median(going.iter().map(|one| one.way.norm() / one.seconds))?;
        let (step, apart) = (self.step(), self.apart());
        if !SPEEDS.contains(&speed) {
            let shown = if speed < 0.01 { format!("{speed:.1e}") } else { format!("{speed:.2}") };
            let said = format!("people move at {shown} m/s in the median, but usual are 0.1 to 3 m/s");
            return doubt(said, cure_of_speed(speed, apart));
        }
        if step >= LONGEST_STEP {
            let said =
                format!("people are recorded every {step:.0} s, but usual is less than {LONGEST_STEP} s");
            return doubt(said, MILLISECONDS.to_owned());
        }
        if let Some(apart) = apart.filter(|apart| *apart < DISTANCES.start) {
            let said = format!("the nearest other person is {apart:.3} m away in the median");
            return doubt(said, "check which columns are x and y, and their unit".to_owned());
        }
        let wrong = going.iter().map(|one| (one.told - one.way).norm() / one.way.norm());
        if self.velocity() == Velocity::Recorded && median(wrong)? > 0.5 {
            let way = |of: fn(&Going) -> Vec2| median(going.iter().map(|one| of(one).norm()));
            let (told, way) = (way(|one| one.told)?, way(|one| one.way)?);
            let said = format!(
                "the velocities of the file would carry people {told:.2} m in the median, but they go {way:.2} m"
            );
            return doubt(said, "write `velocity = seen`, or repair the velocities".to_owned());
        }
        None
    }

    /// Everybody who goes straight and not much less far than those who go farthest.
    fn going(&self) -> Vec<Going> {
        let mut going: Vec<Going> = self.people().iter().filter_map(|person| self.gone(person)).collect();
        going.sort_unstable_by(|a, b| a.way.norm().total_cmp(&b.way.norm()));
        let far = going.get(going.len() * 9 / 10).map_or(0.0, |one| one.way.norm());
        going.retain(|one| one.way.norm() >= 0.25 * far);
        going
    }

    fn gone(&self, person: &Person) -> Option<Going> {
        let [first, .., last] = person.samples.as_slice() else { return None };
        let (mut length, mut told) = (0.0, Vec2::zeros());
        for pair in person.samples.windows(2) {
            length += (pair[1].position - pair[0].position).norm();
            let seconds = self.time_of(pair[1].frame) - self.time_of(pair[0].frame);
            told += pair.iter().filter_map(|sample| sample.velocity).sum::<Vec2>() * (0.5 * seconds);
        }
        let way = last.position - first.position;
        let seconds = self.time_of(last.frame) - self.time_of(first.frame);
        let is_straight = length > 0.0 && way.norm() >= 0.5 * length;
        is_straight.then_some(Going { rows: person.samples.len(), seconds, way, told })
    }

    /// The median distance to the nearest other person, m.
    fn apart(&self) -> Option<f64> {
        let mut distances = Vec::new();
        for frame in self.frames().iter().step_by(self.frames().len().div_ceil(FRAMES).max(1)) {
            let seen = self.at(self.time_of(*frame));
            for (k, one) in seen.iter().enumerate() {
                let others = seen.iter().enumerate().filter(|(other, _)| *other != k);
                let nearest = others.map(|(_, other)| (other.position - one.position).norm());
                distances.extend(nearest.min_by(f64::total_cmp));
            }
        }
        median(distances)
    }
}

#[cfg(test)]
mod tests {
    use super::super::format::{Format, Reading};
    use super::*;

    /// Eight people who walk in two directions, with x and y in a unit of `length` metres and times in one of `time` s. Their
    /// velocities are those of the positions in m/s, times `told`.
    fn crowd(length: f64, time: f64, told: Option<f64>) -> Option<Doubt> {
        let mut text = format!("time,id,x,y{}\n", if told.is_some() { ",vx,vy" } else { "" });
        for k in 0..30 {
            for id in 0..8 {
                let speed = if id % 2 == 0 { 1.1 } else { -1.4 } + 0.02 * f64::from(id);
                let t = 0.4 * f64::from(k);
                let (x, y) = (f64::from(id) * 1.5 + speed * t, 1.2 * f64::from(id));
                let velocity = told.map_or(String::new(), |told| format!(",{},0", speed * told));
                text += &format!("{},{id},{},{}{velocity}\n", t / time, x / length, y / length);
            }
        }
        Format::from_name("csv").unwrap().doubt(text, &Reading::default(), Velocity::Recorded)
    }

    #[test]
    fn the_number_and_the_likely_cure_are_named() {
        assert_eq!(crowd(1.0, 1.0, None), None);
        assert_eq!(crowd(1.0, 1.0, Some(1.0)), None);
        for (length, time, number, cure) in [
            (0.01, 1.0, "126.00 m/s", "centimetres"),
            (0.001, 1.0, "1260.00 m/s", "millimetres"),
            (0.0254, 1.0, "49.61 m/s", "inches"),
            (0.3048, 1.0, "4.13 m/s", "feet"),
            (111_195.0, 1.0, "1.1e-5 m/s", "degrees"),
            (1.0, 0.001, "1.3e-3 m/s", "milliseconds"),
            (0.001, 0.001, "every 400 s", "milliseconds"),
            (1.0, 10.0, "12.60 m/s", "10.500 times as long"),
            (1000.0, 100.0, "0.004 m", "x and y"),
        ] {
            let found = crowd(length, time, None).unwrap();
            assert!(found.said.contains(number), "{number} {found:?}");
            assert!(found.cure.contains(cure), "{cure} {found:?}");
        }
    }

    #[test]
    fn velocities_must_carry_people_where_they_go() {
        for told in [-1.0, 0.01, 100.0] {
            let found = crowd(1.0, 1.0, Some(told)).unwrap();
            assert!(found.said.contains("the velocities of the file would carry people"), "{found:?}");
            assert!(found.cure.contains("velocity = seen"), "{found:?}");
        }
        let blank = crowd(1.0, 1.0, Some(0.0)).unwrap();
        assert!(blank.said.starts_with("all velocities of the file are 0"), "{blank:?}");
    }

    #[test]
    fn people_who_stand_or_are_few_show_nothing() {
        let doubt = |text: &str| {
            let reading = Reading { frames_per_second: Some(25.0), ..Reading::default() };
            Format::from_name("csv").unwrap().doubt(text, &reading, Velocity::Recorded)
        };
        let standing: String = (0..400)
            .map(|k| format!("{k},1,{},{}\n", f64::from(k * 37 % 11) / 100.0, f64::from(k * 53 % 7) / 100.0))
            .collect();
        assert_eq!(doubt(&format!("frame,id,x,y\n{standing}")), None);
        assert_eq!(doubt("frame,id,x,y\n0,1,0,0\n1,1,500,0\n"), None);
        // One of twenty stands for a while, and one is lost for a row.
        let mut text = "frame,id,x,y\n".to_owned();
        for k in 0..60 {
            for id in 0..20 {
                let x = if id == 0 { 0.0 } else { 0.05 * f64::from(k) };
                let x = if (id, k) == (3, 30) { 900.0 } else { x };
                text += &format!("{k},{id},{x},{id}\n");
            }
        }
        assert_eq!(doubt(&text), None);
    }
}
