//! Trajectories as the `SQLite` database of `JuPedSim`, version 2 of its tables, which `JuPedSim` and `PedPy` read
//! (`jupedsim/sqlite_serialization.py`, `pedpy/io/jupedsim_loader.py`): `trajectory_data` with positions and orientations,
//! `metadata`, `geometry` as well-known text, and `frame_data`, which links each frame to its geometry. Beside the keys of
//! `JuPedSim`, `metadata` has `scenario`, `seed`, `trial` and `smc`, the version.
//!
//! The database is made in memory, so that it comes to its file as a whole.

use super::column::Value;
use super::format::{Table, TraceFormat, Writer};
use super::trajectory::Trajectory;
use super::walkable::Walkable;
use crate::base::geometry::Vec2;
use rusqlite::{Connection, MAIN_DB, params};
use std::collections::BTreeSet;
use std::io::{self, Write};

/// `JuPedSim`'s `SQLite`.
pub(super) const SQLITE: TraceFormat = TraceFormat {
    name: "sqlite",
    ending: "sqlite",
    meaning: "trajectories and walkable area as JuPedSim's SQLite, one trial",
    is_of_one_trial: true,
    open: Some(|out, table| Ok(Box::new(Sqlite::new(out, table)?))),
};

/// The key of the one geometry.
const GEOMETRY: i64 = 1;

const TABLES: &str = "
CREATE TABLE trajectory_data (frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL, pos_y REAL NOT NULL,
    ori_x REAL NOT NULL, ori_y REAL NOT NULL);
CREATE TABLE metadata (key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE geometry (hash INTEGER NOT NULL, wkt TEXT NOT NULL);
CREATE UNIQUE INDEX geometry_hash ON geometry (hash);
CREATE TABLE frame_data (frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);
BEGIN;
";

struct Sqlite<'t, W> {
    out: W,
    table: &'t Table,
    trajectory: Trajectory,
    walkable: Walkable<'t>,
    frames: BTreeSet<i64>,
    base: Connection,
}

impl<'t, W: Write> Sqlite<'t, W> {
    fn new(out: W, table: &'t Table) -> io::Result<Self> {
        let trajectory = Trajectory::new(table)?;
        let base = Connection::open_in_memory().map_err(failed)?;
        base.execute_batch(TABLES).map_err(failed)?;
        let walkable = Walkable::new(&table.walls, &table.solids);
        Ok(Self { out, table, trajectory, walkable, frames: BTreeSet::new(), base })
    }

    /// What is known only at the end.
    fn close(&self) -> rusqlite::Result<()> {
        let bounds = self.walkable.bounds();
        let trial = self.trajectory.trial().map_or(String::new(), |trial| trial.to_string());
        let metadata = [
            ("version", "2".to_owned()),
            ("fps", (1.0 / self.table.interval).to_string()),
            ("xmin", bounds.low.x.to_string()),
            ("xmax", bounds.high.x.to_string()),
            ("ymin", bounds.low.y.to_string()),
            ("ymax", bounds.high.y.to_string()),
            ("scenario", self.table.scenario.clone()),
            ("seed", self.table.seed.to_string()),
            ("trial", trial),
            ("smc", self.table.version.clone()),
        ];
        for (key, value) in metadata {
            self.base.execute("INSERT INTO metadata VALUES (?1, ?2)", params![key, value])?;
        }
        self.base.execute("INSERT INTO geometry VALUES (?1, ?2)", params![GEOMETRY, self.walkable.text()])?;
        let mut frame = self.base.prepare("INSERT INTO frame_data VALUES (?1, ?2)")?;
        for number in &self.frames {
            frame.execute(params![number, GEOMETRY])?;
        }
        self.base.execute_batch("CREATE INDEX frame_id_idx ON trajectory_data (frame, id); COMMIT; VACUUM;")
    }
}

fn failed(error: rusqlite::Error) -> io::Error {
    io::Error::other(error)
}

impl<W: Write> Writer for Sqlite<'_, W> {
    fn row(&mut self, row: &[Value<'_>]) -> io::Result<()> {
        let Some(point) = self.trajectory.point(row)? else { return Ok(()) };
        self.frames.insert(point.frame);
        self.walkable.see(point.id, point.position);
        // Who stands looks nowhere.
        let ahead = point.velocity.try_normalize(0.0).unwrap_or_else(Vec2::zeros);
        let mut insert = self
            .base
            .prepare_cached("INSERT INTO trajectory_data VALUES (?1, ?2, ?3, ?4, ?5, ?6)")
            .map_err(failed)?;
        let (at, id) = (point.position, point.id);
        insert.execute(params![point.frame, id, at.x, at.y, ahead.x, ahead.y]).map_err(failed)?;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.close().map_err(failed)?;
        let bytes = self.base.serialize(MAIN_DB).map_err(failed)?;
        self.out.write_all(&bytes)?;
        self.out.flush()
    }
}
