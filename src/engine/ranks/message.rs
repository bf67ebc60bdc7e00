//! What a head and its ranks say to one another, as bytes and back.
//!
//! A message is its length in four bytes, least first, and then so many bytes, of which the first says what it is.
//! Bytes that mean nothing are an error, and take memory in proportion to what has come.

use crate::base::bytes::{Decoder, Encoder, Malformed};
use crate::base::fingerprint::Fingerprint;
use crate::compile::Study;
use crate::engine::cell::{Cell, Item, Reading};
use std::io::{self, Read};

/// What a greeting begins with: who speaks, and which edition of this protocol.
const OPENING: &str = "smc ranks 1";
/// Most trials of a lease.
pub(super) const MOST_ITEMS: usize = 1 << 14;
/// Most threads of a rank.
const MOST_THREADS: u64 = 1024;
/// Longest message, bytes: greetings carry recordings.
const LONGEST: u32 = 1 << 30;
/// Worlds that the fingerprint of a study is made from, at most.
const PRINTED: usize = 32;

/// What a head says.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Order {
    /// The first message.
    Greeting(Greeting),
    /// Trials to run.
    Lease(Lease),
    /// Leases that are not answered yet are of no use any more; they are answered with what there is.
    Stop,
}

/// Who the head is, and what it runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Greeting {
    /// Version of the program.
    pub(super) version: String,
    /// Fingerprint of the study.
    pub(super) print: String,
    /// Number of threads of the rank.
    pub(super) threads: usize,
    /// What the study is compiled from.
    pub(super) inputs: Vec<u8>,
}

/// Trials to run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lease {
    /// Number of the lease.
    pub(super) number: u64,
    /// Number of the world.
    pub(super) world: usize,
    /// Columns of it that are observed.
    pub(super) columns: Vec<usize>,
    /// Seed of all random numbers.
    pub(super) seed: u64,
    /// Seconds to the deadline, if there is one.
    pub(super) seconds: Option<f64>,
    /// The trials.
    pub(super) items: Vec<Item>,
}

/// What a rank says.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Reply {
    /// It has compiled what was handed to it.
    Ready {
        /// Version of its program.
        version: String,
        /// Fingerprint of its study.
        print: String,
    },
    /// It cannot take part.
    Refused(String),
    /// What the trials of a lease yielded.
    Answer(Answer),
    /// The trials of a lease cannot be run at all; the head finds out why when it runs them itself.
    Failed(u64),
}

/// What the trials of a lease yielded.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Answer {
    /// Number of the lease.
    pub(super) number: u64,
    /// How long it took, s.
    pub(super) seconds: f64,
    /// Steps or jumps made.
    pub(super) steps: u64,
    /// Which of its trials were finished.
    pub(super) finished: Vec<bool>,
    /// Cells of those, trial by trial, one a column.
    pub(super) cells: Vec<Cell>,
}

/// The fingerprint of what trials of a study are made of. Of many worlds some stand for all.
pub(super) fn print(study: &Study) -> String {
    struct Ink(Fingerprint);
    impl std::fmt::Write for Ink {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0.add(text.as_bytes());
            Ok(())
        }
    }
    let mut ink = Ink(Fingerprint::default());
    let every = study.worlds.len().div_ceil(PRINTED).max(1);
    for world in study.worlds.iter().step_by(every) {
        let (tree, columns) = (&world.tree, &world.columns);
        // Writing to a fingerprint does not fail.
        let _ = std::fmt::write(
            &mut ink,
            format_args!("{:?}{:?}{:?}{tree:?}{columns:?}", world.scenario, world.atoms, world.signals),
        );
    }
    format!("{} worlds, {}", study.worlds.len(), ink.0)
}

/// The next message of a connection; `None` where the connection was closed between two of them.
pub(super) fn receive(from: &mut dyn Read) -> io::Result<Option<Vec<u8>>> {
    let mut length = [0; 4];
    let mut known = 0;
    while known < 4 {
        match from.read(&mut length[known..]) {
            Ok(0) if known == 0 => return Ok(None),
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(more) => known += more,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    let length = u32::from_le_bytes(length);
    if length > LONGEST {
        return Err(io::Error::new(io::ErrorKind::InvalidData, Malformed("a message is too long")));
    }
    // Room is made as bytes come.
    let mut bytes = Vec::new();
    from.take(u64::from(length)).read_to_end(&mut bytes)?;
    if bytes.len() < length as usize { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(Some(bytes)) }
}

/// A message with its length.
fn framed(message: Encoder) -> Vec<u8> {
    let bytes = message.finish();
    let mut framed = (bytes.len() as u32).to_le_bytes().to_vec();
    framed.extend_from_slice(&bytes);
    framed
}

impl Order {
    /// The message with its length.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut to = Encoder::default();
        match self {
            Self::Greeting(greeting) => {
                to.byte(0);
                to.text(OPENING);
                to.text(&greeting.version);
                to.text(&greeting.print);
                to.whole(greeting.threads as u64);
                to.bytes(&greeting.inputs);
            }
            Self::Lease(lease) => {
                to.byte(1);
                lease.write(&mut to);
            }
            Self::Stop => to.byte(2),
        }
        framed(to)
    }

    /// Reads a message.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut from = Decoder::new(bytes);
        let order = match from.byte()? {
            0 => {
                if from.text()? != OPENING {
                    return Err(Malformed("the main process uses another version of this protocol"));
                }
                let (version, print) = (from.text()?.to_owned(), from.text()?.to_owned());
                let threads = from.whole()?.clamp(1, MOST_THREADS) as usize;
                Self::Greeting(Greeting { version, print, threads, inputs: from.bytes()?.to_vec() })
            }
            1 => Self::Lease(Lease::read(&mut from)?),
            2 => Self::Stop,
            _ => return Err(Malformed("an order has an unknown kind")),
        };
        from.end()?;
        Ok(order)
    }
}

impl Lease {
    fn write(&self, to: &mut Encoder) {
        to.whole(self.number);
        to.whole(self.world as u64);
        to.whole(self.columns.len() as u64);
        self.columns.iter().for_each(|column| to.whole(*column as u64));
        to.whole(self.seed);
        to.number(self.seconds.unwrap_or(f64::INFINITY));
        // Trials mostly come in rows.
        let follows = |a: &Item, b: &Item| a.advice == b.advice && a.index.checked_add(1) == Some(b.index);
        let rows: Vec<&[Item]> = self.items.chunk_by(follows).collect();
        to.whole(rows.len() as u64);
        for row in rows {
            match row[0].advice {
                None => to.byte(0),
                Some((moves, option)) => {
                    to.byte(1);
                    to.whole(moves as u64);
                    to.whole(option as u64);
                }
            }
            to.whole(row[0].index);
            to.whole(row.len() as u64);
        }
    }

    fn read(from: &mut Decoder<'_>) -> Result<Self, Malformed> {
        let (number, world) = (from.whole()?, from.size()?);
        let columns = (0..from.count()?).map(|_| from.size()).collect::<Result<_, _>>()?;
        let seed = from.whole()?;
        let seconds = match from.number()? {
            f64::INFINITY => None,
            seconds if (0.0..1e10).contains(&seconds) => Some(seconds),
            _ => return Err(Malformed("a deadline is not a time")),
        };
        let mut items = Vec::new();
        for _ in 0..from.count()? {
            let advice = match from.byte()? {
                0 => None,
                1 => Some((from.size()?, from.size()?)),
                _ => return Err(Malformed("an advice has an unknown kind")),
            };
            let (first, count) = (from.whole()?, from.size()?);
            let last = first.checked_add(count as u64).ok_or(Malformed("trials beyond the last one"))?;
            if count > MOST_ITEMS - items.len() {
                return Err(Malformed("a lease has too many trials"));
            }
            items.extend((first..last).map(|index| Item { advice, index }));
        }
        Ok(Self { number, world, columns, seed, seconds, items })
    }
}

impl Reply {
    /// The message with its length.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut to = Encoder::default();
        match self {
            Self::Ready { version, print } => {
                to.byte(0);
                to.text(version);
                to.text(print);
            }
            Self::Refused(reason) => {
                to.byte(1);
                to.text(reason);
            }
            Self::Answer(answer) => {
                to.byte(2);
                answer.write(&mut to);
            }
            Self::Failed(number) => {
                to.byte(3);
                to.whole(*number);
            }
        }
        framed(to)
    }

    /// Reads a message.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Malformed> {
        let mut from = Decoder::new(bytes);
        let reply = match from.byte()? {
            0 => Self::Ready { version: from.text()?.to_owned(), print: from.text()?.to_owned() },
            1 => Self::Refused(from.text()?.to_owned()),
            2 => Self::Answer(Answer::read(&mut from)?),
            3 => Self::Failed(from.whole()?),
            _ => return Err(Malformed("a reply has an unknown kind")),
        };
        from.end()?;
        Ok(reply)
    }
}

/// Set in the first byte of a cell where radii were shrunk.
const SHRUNK: u8 = 8;
/// Set in the first byte of a cell where implications were triggered.
const TRIGGERED: u8 = 16;
/// Set in the first byte of a cell where somebody had no way.
const NO_WAY: u8 = 32;

impl Answer {
    fn write(&self, to: &mut Encoder) {
        to.whole(self.number);
        to.number(self.seconds);
        to.whole(self.steps);
        to.whole(self.finished.len() as u64);
        self.finished.iter().for_each(|finished| to.byte(u8::from(*finished)));
        to.whole(self.cells.len() as u64);
        for cell in &self.cells {
            let reading = match cell.reading {
                Reading::Truth(held) => u8::from(held),
                Reading::Value(_) => 2,
                Reading::Unresolved => 3,
                Reading::Faulty => 4,
            };
            let shrunk = if cell.shrunk { SHRUNK } else { 0 };
            let no_way = if cell.no_way { NO_WAY } else { 0 };
            to.byte(reading | shrunk | no_way | if cell.triggered == 0 { 0 } else { TRIGGERED });
            to.whole(cell.steps);
            if cell.triggered != 0 {
                to.whole(cell.triggered);
            }
            if let Reading::Value(value) = cell.reading {
                to.number(value);
            }
        }
    }

    fn read(from: &mut Decoder<'_>) -> Result<Self, Malformed> {
        let (number, seconds, steps) = (from.whole()?, from.number()?, from.whole()?);
        let finished = (0..from.count()?)
            .map(|_| match from.byte()? {
                0 => Ok(false),
                1 => Ok(true),
                _ => Err(Malformed("the state of a trial is invalid")),
            })
            .collect::<Result<_, _>>()?;
        let count = from.count()?;
        let mut cells = Vec::with_capacity(count);
        for _ in 0..count {
            let first = from.byte()?;
            if first >= 2 * NO_WAY {
                return Err(Malformed("a cell has an unknown kind"));
            }
            let steps = from.whole()?;
            let triggered = if first & TRIGGERED == 0 { 0 } else { from.whole()? };
            let reading = match first % SHRUNK {
                0 => Reading::Truth(false),
                1 => Reading::Truth(true),
                2 => Reading::Value(from.number()?),
                3 => Reading::Unresolved,
                4 => Reading::Faulty,
                _ => return Err(Malformed("a cell has an unknown kind")),
            };
            let (shrunk, no_way) = (first & SHRUNK != 0, first & NO_WAY != 0);
            cells.push(Cell { reading, steps, triggered, shrunk, no_way });
        }
        Ok(Self { number, seconds, steps, finished, cells })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::option;
    use proptest::prelude::*;

    fn orders() -> impl Strategy<Value = Order> {
        let rows = vec((option::of((0usize..9, 0usize..9)), 0u64..u64::MAX - 99, 1u64..9), 0..9);
        let lease =
            (any::<u64>(), 0usize..99, vec(0usize..99, 0..5), any::<u64>(), option::of(0.0..1e9), rows);
        let lease = lease.prop_map(|(number, world, columns, seed, seconds, rows)| {
            let row = |(advice, from, count)| (from..from + count).map(move |index| Item { advice, index });
            let items = rows.into_iter().flat_map(row).collect();
            Order::Lease(Lease { number, world, columns, seed, seconds, items })
        });
        let greeting = (any::<String>(), any::<String>(), 1usize..1024, any::<Vec<u8>>()).prop_map(
            |(version, print, threads, inputs)| Order::Greeting(Greeting { version, print, threads, inputs }),
        );
        prop_oneof![lease, greeting, Just(Order::Stop)]
    }

    fn replies() -> impl Strategy<Value = Reply> {
        let reading = prop_oneof![
            any::<bool>().prop_map(Reading::Truth),
            any::<f64>().prop_filter("comparable", |v| !v.is_nan()).prop_map(Reading::Value),
            Just(Reading::Unresolved),
            Just(Reading::Faulty),
        ];
        let cell = (reading, any::<u64>(), prop_oneof![Just(0), any::<u64>()], any::<[bool; 2]>()).prop_map(
            |(reading, steps, triggered, [shrunk, no_way])| Cell {
                reading,
                steps,
                triggered,
                shrunk,
                no_way,
            },
        );
        let answer = (any::<u64>(), 0.0..1e9, any::<u64>(), any::<Vec<bool>>(), vec(cell, 0..40)).prop_map(
            |(number, seconds, steps, finished, cells)| {
                Reply::Answer(Answer { number, seconds, steps, finished, cells })
            },
        );
        let ready =
            (any::<String>(), any::<String>()).prop_map(|(version, print)| Reply::Ready { version, print });
        prop_oneof![
            answer,
            ready,
            any::<String>().prop_map(Reply::Refused),
            any::<u64>().prop_map(Reply::Failed),
        ]
    }

    proptest! {
        #[test]
        fn what_was_said_is_understood(order in orders(), reply in replies()) {
            let mut connection: &[u8] = &[order.bytes(), reply.bytes()].concat();
            let first = receive(&mut connection).unwrap().unwrap();
            prop_assert_eq!(Order::read(&first), Ok(order));
            let second = receive(&mut connection).unwrap().unwrap();
            prop_assert_eq!(Reply::read(&second), Ok(reply));
            prop_assert_eq!(receive(&mut connection).unwrap(), None);
        }

        #[test]
        fn cut_short_it_is_refused(order in orders(), reply in replies(), cut: prop::sample::Index) {
            for (whose, bytes) in [order.bytes(), reply.bytes()].into_iter().enumerate() {
                let cut = cut.index(bytes.len());
                let mut connection = &bytes[..cut];
                prop_assert!(matches!(receive(&mut connection), Err(_) | Ok(None)));
                if cut > 4 {
                    let part = &bytes[4..cut];
                    let refused = if whose == 0 { Order::read(part).is_err() } else { Reply::read(part).is_err() };
                    prop_assert!(refused);
                }
            }
        }

        #[test]
        fn any_bytes_are_understood_or_refused(kind in 0u8..4, bytes: Vec<u8>) {
            let bytes = [vec![kind], bytes].concat();
            let _ = (Order::read(&bytes), Reply::read(&bytes));
        }

        #[test]
        fn a_byte_that_changed_does_no_harm(order in orders(), reply in replies(), at: prop::sample::Index, by: u8) {
            for mut bytes in [order.bytes(), reply.bytes()] {
                let at = at.index(bytes.len());
                bytes[at] = bytes[at].wrapping_add(by);
                if let Ok(Some(message)) = receive(&mut bytes.as_slice()) {
                    if let Ok(Order::Lease(lease)) = Order::read(&message) {
                        prop_assert!(lease.items.len() <= MOST_ITEMS && lease.columns.len() <= message.len());
                    }
                    if let Ok(Reply::Answer(answer)) = Reply::read(&message) {
                        prop_assert!(answer.cells.capacity() <= message.len());
                    }
                }
            }
        }
    }

    #[test]
    fn few_bytes_cannot_ask_for_much_memory() {
        // A message of four gigabytes, one of a gigabyte that does not come, a lease of 2^60 trials.
        assert!(receive(&mut [0xff; 9].as_slice()).is_err());
        assert!(receive(&mut [0, 0, 0, 0x40, 1, 2, 3].as_slice()).is_err());
        let mut lease = Encoder::default();
        lease.byte(1);
        for _ in 0..4 {
            lease.whole(0);
        }
        lease.number(f64::INFINITY);
        lease.whole(1);
        lease.byte(0);
        lease.whole(0);
        lease.whole(1 << 60);
        assert_eq!(Order::read(&lease.finish()), Err(Malformed("a lease has too many trials")));
        let mut answer = Encoder::default();
        answer.byte(2);
        answer.whole(0);
        answer.number(0.0);
        answer.whole(0);
        answer.whole(1 << 40);
        assert_eq!(Reply::read(&answer.finish()), Err(Malformed("a list is cut short")));
    }
}
