//! The trace of a program as a tape. Rows stand at the times of the states, and every state has one.

use crate::base::geometry::Vec2;
use crate::data::rows::{self, Heads, Row};
use crate::kernel::tape::{Seen, Tape};
use crate::model::{Outside, Scenario, TraceForm};
use std::collections::BTreeMap;

/// How far a time may be from that of its state, in steps.
const CLOSE: f64 = 1e-6;

/// Reads the trace of a trial.
///
/// # Errors
/// In words: rows that cannot be read, times that are not those of the states, more people than places.
pub(super) fn film(outside: &Outside, scenario: &Scenario, output: &[u8]) -> Result<Tape, String> {
    let heads = Heads {
        time: &outside.time,
        numbers: &outside.columns,
        people: outside.people.as_ref().map_or(&[], |people| &people.columns),
    };
    let mut film = Film {
        outside,
        step: scenario.clock.step_seconds(),
        horizon: scenario.horizon.0,
        tape: Tape { width: outside.columns.len(), ..Tape::default() },
        ids: BTreeMap::new(),
    };
    let read = match outside.format {
        TraceForm::Csv => rows::csv,
        TraceForm::Jsonl => rows::jsonl,
    };
    read(output, heads, &mut |row| film.add(row))?;
    film.end()
}

/// A tape, and what is needed to go on with it.
struct Film<'o> {
    outside: &'o Outside,
    /// Length of a step, s, or 1 where steps have no length.
    step: f64,
    horizon: u64,
    tape: Tape,
    /// The places of those who were seen.
    ids: BTreeMap<String, u32>,
}

impl Film<'_> {
    /// Adds a row; whether more are wanted.
    fn add(&mut self, row: Row) -> Result<bool, String> {
        let Row { line, time, numbers, person } = row;
        let states = self.tape.people.len();
        let tick = (time / self.step).round();
        let is_state = (time / self.step - tick).abs() <= CLOSE;
        if is_state && tick > self.horizon as f64 {
            return Ok(false);
        }
        if is_state && tick == states as f64 {
            self.tape.people.push(Vec::new());
            self.tape.values.extend(numbers);
        } else if is_state && states > 0 && tick == (states - 1) as f64 {
            let known = &self.tape.values[(states - 1) * self.tape.width..];
            if let Some(at) = (0..self.tape.width).find(|k| known[*k] != numbers[*k]) {
                let column = &self.outside.columns[at];
                return Err(format!(
                    "line {line}: `{column}` is {} here and {} in another row of this time; a signal has one value at a time",
                    numbers[at], known[at]
                ));
            }
            if person.is_none() || self.outside.people.is_none() {
                return Err(format!("line {line} is a second row at {time}"));
            }
        } else {
            let wanted = states as f64 * self.step;
            return Err(format!("line {line} has the time {time}, and the next state is at {wanted}"));
        }
        let (Some((id, place)), Some(people)) = (person, &self.outside.people) else { return Ok(true) };
        let number = self.ids.len() as u32;
        let own = *self.ids.entry(id.clone()).or_insert(number);
        if own as usize >= people.members.len() {
            return Err(format!(
                "line {line}: `{id}` is one more than the {} people for whom there is room; write a larger number with `agents`",
                people.members.len()
            ));
        }
        let state = self.tape.people.len() - 1;
        if self.tape.people[state].iter().any(|one| one.place == own) {
            return Err(format!("line {line}: `{id}` is there twice at {time}"));
        }
        let velocity = Vec2::new(place.get(2).copied().unwrap_or(0.0), place.get(3).copied().unwrap_or(0.0));
        let position = Vec2::new(place[0], place[1]);
        self.tape.people[state].push(Seen { place: own, position, velocity });
        Ok(true)
    }

    /// The whole tape.
    fn end(mut self) -> Result<Tape, String> {
        let states = self.tape.people.len();
        if states == 0 {
            return Err("it has no rows".to_owned());
        }
        if (states as u64) <= self.horizon && !self.outside.is_held {
            let (last, end) = ((states - 1) as f64 * self.step, self.horizon as f64 * self.step);
            return Err(format!(
                "it ends at {last}, before the horizon at {end}; if nothing changes then, write `ends = held`"
            ));
        }
        if self.outside.people.as_ref().is_some_and(|people| people.columns.len() == 3) {
            self.add_velocities();
        }
        Ok(self.tape)
    }

    /// Velocities from the places of two states: of this one and the one before, or the next one for who has just come.
    fn add_velocities(&mut self) {
        let people = &self.tape.people;
        let at = |state: usize, place: u32| {
            let seen = people.get(state)?.iter().find(|one| one.place == place);
            seen.map(|one| one.position)
        };
        let of = |state: usize, one: &Seen| {
            let before = state.checked_sub(1).and_then(|before| at(before, one.place));
            let way = match before {
                Some(before) => one.position - before,
                None => at(state + 1, one.place).map_or(Vec2::zeros(), |next| next - one.position),
            };
            Seen { velocity: way / self.step, ..*one }
        };
        let all = people.iter().enumerate();
        let all = all.map(|(state, seen)| seen.iter().map(|one| of(state, one)).collect()).collect();
        self.tape.people = all;
    }
}
