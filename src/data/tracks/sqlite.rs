//! Reader of the `SQLite` databases of `JuPedSim`, whose `trajectory_data` has `frame`, `id`, `pos_x` and `pos_y`, m, and whose
//! `metadata` has the frames per second (`fps`). `smc simulate --format sqlite` writes them.

use super::line::LineError;
use super::recording::Recording;

/// Reads a whole database.
///
/// # Errors
/// The crate was built without the feature `sqlite`.
#[cfg(not(feature = "sqlite"))]
pub fn read_sqlite(_: &[u8]) -> Result<Recording, Vec<LineError>> {
    let message = "this program was built without the feature `sqlite`: build it with `--features sqlite`";
    Err(vec![LineError::of_file(message)])
}

#[cfg(feature = "sqlite")]
pub use with_feature::read_sqlite;

#[cfg(feature = "sqlite")]
mod with_feature {
    use super::{LineError, Recording};
    use crate::base::geometry::{Vec2, coordinate_fault};
    use crate::data::tracks::recording::Clock;
    use crate::data::tracks::rows::{Row, people, usual_stride};
    use rusqlite::{Connection, MAIN_DB};

    /// Reads a whole database.
    ///
    /// # Errors
    /// What is no database of `JuPedSim`, and every bad row.
    pub fn read_sqlite(bytes: &[u8]) -> Result<Recording, Vec<LineError>> {
        let damaged = |error: rusqlite::Error| {
            vec![LineError::of_file(format!("the file is no database of JuPedSim: {error}"))]
        };
        let mut base = Connection::open_in_memory().map_err(damaged)?;
        base.deserialize_read_exact(MAIN_DB, bytes, bytes.len(), true).map_err(damaged)?;
        let rate: String = base
            .query_row("SELECT value FROM metadata WHERE key = 'fps'", [], |row| row.get(0))
            .map_err(damaged)?;
        let rate = rate.parse::<f64>().ok().filter(|rate| rate.is_finite() && *rate > 0.0);
        let Some(rate) = rate else {
            return Err(vec![LineError::of_file(
                "the frames per second of the database are no positive number",
            )]);
        };
        let mut all = base
            .prepare("SELECT frame, id, pos_x, pos_y FROM trajectory_data ORDER BY frame, id")
            .map_err(damaged)?;
        let (mut rows, mut errors) = (Vec::new(), Vec::new());
        let found = all
            .query_map([], |row| {
                let whole = |at: usize| row.get::<_, i64>(at);
                Ok((whole(0)?, whole(1)?, Vec2::new(row.get(2)?, row.get(3)?)))
            })
            .map_err(damaged)?;
        for (number, row) in found.enumerate() {
            let (frame, id, position) = row.map_err(damaged)?;
            let line = number + 1;
            let (Ok(frame), Ok(id)) = (u32::try_from(frame), u32::try_from(id)) else {
                errors.push(LineError::whole(line, "the frame or the id is out of range"));
                continue;
            };
            match coordinate_fault(position) {
                Some(fault) => errors.push(LineError::whole(line, fault)),
                None => rows.push(Row { line, frame, id, position, velocity: None }),
            }
        }
        let people = people(rows, errors, |row| format!("in frame {}", row.frame))?;
        let stride = usual_stride(&people).unwrap_or(1);
        Ok(Recording::new(people, Clock::film(stride, 1.0 / rate)))
    }
}
