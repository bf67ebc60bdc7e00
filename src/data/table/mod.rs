//! Traces as tables: CSV, JSON lines, and one JSON object.
//!
//! All formats have the columns `time, trial, agent, x, y, vx, vy, speed, present` in SI units, then one
//! column per named signal. Who is absent has no position and no velocity. Numbers have the fewest digits
//! that give the same double back. Rows are written as they come; nothing is kept. Where there are no people, a row
//! is a state: `time, trial`, then one column per variable.

pub mod csv;
pub mod json;
pub mod row;
pub mod states;

pub use csv::write_csv;
pub use json::{write_json, write_json_lines};
pub use row::Row;
pub use states::{Held, StateRow, write_states_csv, write_states_json, write_states_json_lines};
