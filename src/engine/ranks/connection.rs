//! A connection to a rank: two threads of the head, of which one writes to it and the other reads from it, so that the head
//! itself never waits for a rank that does not answer.

use super::message::{Order, Reply, receive};
use std::io::{Read, Write};
use std::sync::mpsc::{self, Receiver, Sender};

/// What a head says to a rank, and what it hears from it.
pub struct Connection {
    /// What the rank says.
    pub from: Box<dyn Read + Send>,
    /// What it is told.
    pub to: Box<dyn Write + Send>,
}

/// What happened on a connection.
pub(super) enum Event {
    /// The rank said something.
    Said(Reply),
    /// It says no more: why.
    Gone(String),
}

/// The end of a connection at which orders are given. Where it is dropped the connection is closed, and the rank ends.
pub(super) struct Orders(Sender<Vec<u8>>);

impl Orders {
    /// Gives an order. Whether it arrives is seen by what comes back.
    pub(super) fn give(&self, order: &Order) {
        self.send(order.bytes());
    }

    /// Gives an order that is bytes already.
    pub(super) fn send(&self, order: Vec<u8>) {
        let _ = self.0.send(order);
    }
}

/// Starts to write and to read; `events` hears all with the number of the rank.
pub(super) fn open(
    rank: usize,
    connection: Connection,
    events: &Sender<(usize, Event)>,
) -> std::io::Result<Orders> {
    let (orders, given) = mpsc::channel();
    let Connection { from, to } = connection;
    let (said, broken) = (events.clone(), events.clone());
    std::thread::Builder::new()
        .spawn(move || write(to, &given, |why| broken.send((rank, Event::Gone(why))).is_ok()))?;
    std::thread::Builder::new().spawn(move || read(from, |event| said.send((rank, event)).is_ok()))?;
    Ok(Orders(orders))
}

fn write(mut to: Box<dyn Write + Send>, given: &Receiver<Vec<u8>>, gone: impl Fn(String) -> bool) {
    for bytes in given {
        if let Err(error) = to.write_all(&bytes).and_then(|()| to.flush()) {
            gone(error.to_string());
            return;
        }
    }
}

fn read(mut from: Box<dyn Read + Send>, tell: impl Fn(Event) -> bool) {
    loop {
        let event = match receive(&mut *from) {
            Ok(Some(bytes)) => match Reply::read(&bytes) {
                Ok(reply) => Event::Said(reply),
                Err(reason) => Event::Gone(format!("its message is invalid: {reason}")),
            },
            Ok(None) => Event::Gone("it ended".to_owned()),
            Err(error) => Event::Gone(error.to_string()),
        };
        let last = matches!(event, Event::Gone(_));
        if !tell(event) || last {
            return;
        }
    }
}
