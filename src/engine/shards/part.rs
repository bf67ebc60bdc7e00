//! A part: what a shard yielded, as the bytes of a file. A line that names the format, the head and the bodies as Postcard
//! writes them, and a CRC-32 of all of that.

use super::Origin;
use super::table::Table;
use super::unit::Unit;
use crate::engine::sampling::splitting::RunRecord;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The first line of a part: what it is, and the version of its format.
const FORMAT: &[u8] = b"smc part 1\n";
/// Bytes of the checksum.
const CHECK: usize = 4;

/// What a part is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// What its outcomes are of.
    pub origin: Origin,
    /// Seconds that its shard took.
    pub seconds: f64,
    /// The units, in the order of their bodies.
    pub units: Vec<Unit>,
}

/// What a unit yielded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// Outcomes of trials.
    Trials(Table),
    /// A run of splitting; none where the model is wrong in it, or the budget ends it.
    Run(Option<RunRecord>),
}

/// A part.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its subject.
    pub head: Head,
    /// What its units yielded.
    pub bodies: Vec<Body>,
}

/// Why bytes are no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Damaged(&'static str);

const FOREIGN: Damaged = Damaged("it is not a part, or is one of another format");
const CHANGED: Damaged = Damaged("it is cut short or changed: its checksum does not match");
pub(super) const UNFIT: Damaged = Damaged("its contents do not fit together");

impl Part {
    /// The bytes of its file.
    ///
    /// # Errors
    /// If memory does not suffice.
    pub fn bytes(&self) -> Result<Vec<u8>, postcard::Error> {
        let mut bytes = FORMAT.to_vec();
        bytes = postcard::to_extend(&self.head, bytes)?;
        bytes = postcard::to_extend(&self.bodies, bytes)?;
        let check = crc32fast::hash(&bytes);
        bytes.extend_from_slice(&check.to_le_bytes());
        Ok(bytes)
    }

    /// Reads a part.
    pub fn read(bytes: &[u8]) -> Result<Self, Damaged> {
        let (head, rest) = split(bytes)?;
        let mut bodies: Vec<Body> = postcard::from_bytes(rest).map_err(|_| UNFIT)?;
        if bodies.len() != head.units.len() {
            return Err(UNFIT);
        }
        for (unit, body) in head.units.iter().zip(&mut bodies) {
            match (unit, body) {
                (Unit::Trials(trials), Body::Trials(table)) => {
                    let count = trials.to.checked_sub(trials.from).ok_or(UNFIT)?;
                    table.settle(count, trials.columns.len())?;
                }
                (Unit::Run(_), Body::Run(_)) => {}
                _ => return Err(UNFIT),
            }
        }
        Ok(Self { head, bodies })
    }
}

impl Head {
    /// Reads the head of a part, whose checksum must match.
    pub fn read(bytes: &[u8]) -> Result<Self, Damaged> {
        split(bytes).map(|(head, _)| head)
    }
}

/// Head and bytes of the bodies.
fn split(bytes: &[u8]) -> Result<(Head, &[u8]), Damaged> {
    let known = FORMAT.len().min(bytes.len());
    if bytes[..known] != FORMAT[..known] {
        return Err(FOREIGN);
    }
    let (bytes, check) = bytes.split_last_chunk::<CHECK>().ok_or(CHANGED)?;
    if bytes.len() < FORMAT.len() || crc32fast::hash(bytes).to_le_bytes() != *check {
        return Err(CHANGED);
    }
    postcard::take_from_bytes(&bytes[FORMAT.len()..]).map_err(|_| UNFIT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::shards::Trials;
    use crate::trials::cell::{Cell, Reading};
    use proptest::prelude::*;

    fn part() -> Part {
        let cells: Vec<Cell> =
            (0..100).map(|k| Cell { reading: Reading::Truth(k % 3 == 0), steps: k, ..Cell::BLANK }).collect();
        let mut table = Table::new(1);
        table.push(&cells);
        let trials = Trials { world: 0, columns: vec![2], advice: None, from: 50, to: 150 };
        let record = RunRecord { paths: 1, steps: 2, lost: 0, estimate: 0.5, levels: vec![f64::INFINITY] };
        let origin = Origin { version: "1".to_owned(), print: "p".to_owned(), seed: 3 };
        let run = crate::engine::sampling::splitting::SplitRun {
            world: 1,
            columns: [0, 1],
            rule: crate::stats::splitting::Rule {
                adaptive: true,
                replicas: 2,
                runs: 3,
                kill: 1,
                plain: 5,
                delta: 0.1,
            },
            branch: 1,
            lost_reaches: false,
            levels: vec![0.1],
        };
        let head = Head { origin, seconds: 1.5, units: vec![Unit::Trials(trials), Unit::Run(run)] };
        Part { head, bodies: vec![Body::Trials(table), Body::Run(Some(record))] }
    }

    #[test]
    fn a_part_comes_back() {
        let bytes = part().bytes().unwrap();
        let read = Part::read(&bytes).unwrap();
        assert_eq!(read.head, part().head);
        let Body::Trials(table) = &read.bodies[0] else { panic!() };
        assert_eq!((table.cell(9, 0).reading, table.cell(9, 0).steps), (Reading::Truth(true), 9));
        assert_eq!(read.bodies[1], part().bodies[1]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        #[test]
        fn any_change_is_noticed_and_any_contents_are_read_or_refused(at: prop::sample::Index, to: u8, cut: prop::sample::Index) {
            let good = part().bytes().unwrap();
            let mut bytes = good.clone();
            bytes[at.index(good.len())] = to;
            prop_assert!(bytes == good || Part::read(&bytes).is_err());
            prop_assert!(Part::read(&good[..cut.index(good.len())]).is_err());
            // With a checksum that matches.
            let end = bytes.len() - CHECK;
            let check = crc32fast::hash(&bytes[..end]).to_le_bytes();
            bytes[end..].copy_from_slice(&check);
            let _ = Part::read(&bytes);
        }
    }
}
