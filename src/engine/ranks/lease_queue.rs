//! The queue of the head, at which leases are handed out and come back.

use super::Traffic;
use super::connection::{Connection, Event, Orders, open};
use super::message::{Answer, Greeting, Lease, MOST_ITEMS, Order, Reply, print};
use super::round::Round;
use crate::base::math;
use crate::compile::Study;
use crate::engine::budget::Budget;
use crate::engine::fault::Fault;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

/// Longest wait for ranks that have not said that they are ready, s.
const WELCOME: f64 = 30.0;
/// How long a lease should take at most, s.
const LONG: f64 = 0.2;
/// How long it should take at least, s.
const BRIEF: f64 = 0.001;
/// Where leases take less than this, a rank has a second one at hand while its answer is under way, s.
const SHORT: f64 = 0.02;
/// How long ranks may take to hand in what they have once time is up, s.
const GRACE: f64 = 0.1;
/// Between two looks at the clock, s.
const LOOK: f64 = 0.02;
/// A lease this old, and older than several like it take, is leased to a second rank that has nothing to do, s.
const OVERDUE: f64 = 2.0;
/// Longest that ranks which all stand still are waited for because they were slow before, s.
const PATIENT: f64 = 120.0;
/// Most cells of a lease, where it has more than the lanes of a rank.
const MOST_CELLS: usize = 1 << 16;

/// How a round ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoundEnd {
    /// All is there that will come.
    Over,
    /// No rank can run what is left.
    Alone,
}

/// A lease that a rank has not answered.
struct Held {
    number: u64,
    places: Range<usize>,
    since: Instant,
    /// How long it should take, s.
    expected: f64,
    /// Nobody waits for it any more.
    void: bool,
}

impl Held {
    /// Whether it is out for so long, and for several times as long as it should take.
    fn late(&self, patience: f64) -> bool {
        self.since.elapsed().as_secs_f64() > math::at_least(patience, 4.0 * self.expected)
    }
}

/// What is known of a rank.
struct Rank {
    /// Where it is told what to do; `None` once it is gone.
    orders: Option<Orders>,
    ready: bool,
    /// In the order in which they are answered.
    held: VecDeque<Held>,
    /// Why it is gone.
    why: String,
}

impl Rank {
    fn works(&self) -> bool {
        self.ready && self.orders.is_some()
    }

    /// Whether it works, and neither hangs nor has kept what it must answer next for longer than that should take, and
    /// than one has patience.
    fn lives(&self, patience: f64) -> bool {
        self.works()
            && !self.hangs()
            && self.held.front().is_none_or(|held| held.void || !held.late(patience))
    }

    /// Whether it was told to leave a lease and has not done so for long.
    fn hangs(&self) -> bool {
        self.held.front().is_some_and(|held| held.void && held.since.elapsed().as_secs_f64() > OVERDUE)
    }
}

/// All ranks.
pub(super) struct LeaseQueue {
    ranks: Vec<Rank>,
    events: Receiver<(usize, Event)>,
    /// Fingerprint of the study.
    print: String,
    /// Threads of each rank.
    each: usize,
    /// Number of the next lease.
    next: u64,
    /// A world, and the seconds of one of its trials in the last lease that came back.
    pace: Option<(usize, f64)>,
    /// How long ranks that all stand still are waited for, s: longer once one that was given up turned out to be slow.
    patience: f64,
    pub(super) traffic: Traffic,
}

impl LeaseQueue {
    /// Greets the ranks.
    pub(super) fn new(
        connections: Vec<Connection>,
        study: &Study,
        inputs: Vec<u8>,
        each: usize,
    ) -> Result<Self, Fault> {
        let (sender, events) = mpsc::channel();
        let (print, each) = (print(study), each.max(1));
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let greeting =
            Order::Greeting(Greeting { version, print: print.clone(), threads: each, inputs }).bytes();
        let greet = |(rank, connection)| {
            let orders =
                open(rank, connection, &sender).map_err(|error| Fault::Threads(error.to_string()))?;
            orders.send(greeting.clone());
            Ok(Rank { orders: Some(orders), ready: false, held: VecDeque::new(), why: String::new() })
        };
        let ranks = connections.into_iter().enumerate().map(greet).collect::<Result<_, Fault>>()?;
        Ok(Self {
            ranks,
            events,
            print,
            each,
            next: 0,
            pace: None,
            patience: OVERDUE,
            traffic: Traffic::default(),
        })
    }

    /// Waits until each rank is ready or gone.
    #[allow(clippy::disallowed_methods, reason = "the head does not wait for ever")]
    pub(super) fn welcome(&mut self, budget: &Budget) -> Result<(), Fault> {
        let started = Instant::now();
        while self.ranks.iter().any(|rank| rank.orders.is_some() && !rank.ready) {
            if budget.must_stop() || started.elapsed().as_secs_f64() > WELCOME {
                break;
            }
            let Some((rank, event)) = self.wait(budget) else { continue };
            if let Event::Said(reply @ (Reply::Ready { .. } | Reply::Refused(_))) = &event
                && let Err(reason) = self.fits(reply)
            {
                return Err(Fault::Rank { rank: rank + 1, reason });
            }
            self.hear(rank, event, None);
        }
        Ok(())
    }

    /// The next thing that happens, if it happens soon.
    fn wait(&self, budget: &Budget) -> Option<(usize, Event)> {
        let left = budget.seconds_left().filter(|left| *left > 0.0).unwrap_or(LOOK).min(LOOK);
        self.events.recv_timeout(Duration::from_secs_f64(left)).ok()
    }

    /// Whether a rank that says so runs what this process runs.
    fn fits(&self, reply: &Reply) -> Result<(), String> {
        let own = env!("CARGO_PKG_VERSION");
        match reply {
            Reply::Refused(reason) => Err(reason.clone()),
            Reply::Ready { version, .. } if version != own => {
                Err(format!("its version is smc {version}, that of the main process is smc {own}"))
            }
            Reply::Ready { print, .. } if *print != self.print => {
                Err(format!("its model differs: {print} instead of {}", self.print))
            }
            _ => Ok(()),
        }
    }

    /// Threads of the ranks that work.
    pub(super) fn width(&self) -> usize {
        self.each * self.ranks.iter().filter(|rank| rank.works()).count()
    }

    /// Has a round run. Where time is up, what has come back by then is there.
    #[allow(clippy::disallowed_methods, reason = "the engine keeps deadlines; trials never see the clock")]
    pub(super) fn run(&mut self, round: &mut Round<'_, '_>, budget: &Budget) -> RoundEnd {
        let mut halted: Option<Instant> = None;
        let mut able = true;
        while let Ok((rank, event)) = self.events.try_recv() {
            able &= self.hear(rank, event, None);
        }
        let end = loop {
            if round.open == 0 {
                break RoundEnd::Over;
            }
            if !able || !self.ranks.iter().any(|rank| rank.lives(self.patience)) {
                break RoundEnd::Alone;
            }
            if budget.must_stop() {
                if halted.is_none() && budget.is_interrupted() {
                    self.tell_all(&Order::Stop);
                }
                let since = halted.get_or_insert_with(Instant::now);
                let waited_for = self.ranks.iter().flat_map(|rank| &rank.held).any(|held| !held.void);
                if !waited_for || since.elapsed().as_secs_f64() > GRACE {
                    break RoundEnd::Over;
                }
            } else {
                self.hand_out(round, budget);
            }
            if let Some((rank, event)) = self.wait(budget) {
                able &= self.hear(rank, event, Some((round, halted.is_some() || budget.must_stop())));
            }
        };
        self.recall();
        end
    }

    /// Nobody waits any more for what is out.
    fn recall(&mut self) {
        for rank in &mut self.ranks {
            let mut out = false;
            for held in &mut rank.held {
                out |= !held.void;
                held.void = true;
            }
            if let (true, Some(orders)) = (out, &rank.orders) {
                orders.give(&Order::Stop);
            }
        }
    }

    fn tell_all(&self, order: &Order) {
        self.ranks.iter().filter_map(|rank| rank.orders.as_ref()).for_each(|orders| orders.give(order));
    }

    /// Gives each rank that has too little to do a lease, while there is something to lease.
    fn hand_out(&mut self, round: &mut Round<'_, '_>, budget: &Budget) {
        for depth in 1..=2 {
            for rank in 0..self.ranks.len() {
                if !self.ranks[rank].works() || self.ranks[rank].held.len() >= depth {
                    continue;
                }
                let size = self.size(round);
                if depth == 2 && self.seconds(round, size).is_none_or(|seconds| seconds > SHORT) {
                    return;
                }
                let leased = round.take(size).or_else(|| {
                    let overdue = (depth == 1).then(|| self.overdue(round)).flatten();
                    overdue.map(|places| (places, true))
                });
                let Some((places, again)) = leased else { return };
                self.lease(rank, round, places, again, budget);
            }
        }
    }

    /// How many trials the next lease has: at first much, towards the end of a round little, so that all ranks end
    /// together; but enough for all lanes and worth a message, and little enough that a lease that is lost costs little.
    fn size(&self, round: &Round<'_, '_>) -> usize {
        let ranks = self.ranks.iter().filter(|rank| rank.works()).count().max(1);
        let (lanes, left) = (self.each * round.job.lanes(), round.untouched());
        let share = round.items.len().div_ceil(ranks).next_multiple_of(lanes);
        let least = share.min(2 * lanes);
        // So many are run in some seconds; few where nothing is known.
        let run_in = |seconds: f64| match self.pace {
            Some((world, pace)) if world == round.world => (seconds / pace) as usize,
            _ => least,
        };
        let most = run_in(LONG).min(MOST_CELLS / round.job.columns.len().max(1)).max(least).min(MOST_ITEMS);
        let pieces = if ranks == 1 { 1 } else { 2 * ranks };
        let fair = left.div_ceil(pieces).max(run_in(BRIEF).min(left.div_ceil(ranks)));
        fair.next_multiple_of(round.job.lanes()).clamp(least.min(most), most)
    }

    /// How long so many trials should take.
    fn seconds(&self, round: &Round<'_, '_>, size: usize) -> Option<f64> {
        self.pace.filter(|(world, _)| *world == round.world).map(|(_, seconds)| seconds * size as f64)
    }

    /// A lease that whoever has it has had for long.
    fn overdue(&self, round: &Round<'_, '_>) -> Option<Range<usize>> {
        let out: Vec<&Held> =
            self.ranks.iter().flat_map(|rank| &rank.held).filter(|held| !held.void).collect();
        let late = |held: &&&Held| {
            out.iter().filter(|other| other.places == held.places).all(|other| other.late(OVERDUE))
        };
        out.iter().filter(late).map(|held| held.places.clone()).find(|places| round.is_open(places))
    }

    #[allow(
        clippy::disallowed_methods,
        reason = "how long a lease takes decides who runs trials, not what they yield"
    )]
    fn lease(
        &mut self,
        rank: usize,
        round: &Round<'_, '_>,
        places: Range<usize>,
        again: bool,
        budget: &Budget,
    ) {
        let expected = self.seconds(round, places.len()).unwrap_or(0.0);
        let (number, rank) = (self.next, &mut self.ranks[rank]);
        let Some(orders) = &rank.orders else { return };
        orders.give(&Order::Lease(Lease {
            number,
            world: round.world,
            columns: round.job.columns.clone(),
            seed: round.job.series.seed,
            seconds: budget.seconds_left(),
            items: round.items[places.clone()].to_vec(),
        }));
        rank.held.push_back(Held { number, places, since: Instant::now(), expected, void: false });
        self.next += 1;
        self.traffic.leases += 1;
        self.traffic.again += u64::from(again);
    }

    /// Something happened on a connection, in a round or between two, whose time may be up. False where the trials of the round
    /// cannot be run by ranks.
    fn hear(&mut self, rank: usize, event: Event, round: Option<(&mut Round<'_, '_>, bool)>) -> bool {
        if self.ranks[rank].orders.is_none() {
            return true;
        }
        match event {
            Event::Gone(why) => self.dismiss(rank, why, round.map(|(round, _)| round)),
            Event::Said(Reply::Answer(answer)) => self.take(rank, &answer, round),
            Event::Said(Reply::Failed(number)) => match self.answered(rank, number) {
                Some(held) => return held.void,
                None => self.dismiss(rank, nonsense(), round.map(|(round, _)| round)),
            },
            Event::Said(reply @ (Reply::Ready { .. } | Reply::Refused(_))) => match self.fits(&reply) {
                Ok(()) if !self.ranks[rank].ready => self.ranks[rank].ready = true,
                Ok(()) => self.dismiss(rank, nonsense(), round.map(|(round, _)| round)),
                Err(why) => self.dismiss(rank, why, round.map(|(round, _)| round)),
            },
        }
        true
    }

    /// The lease of this number, if it is the one that the rank has to answer next.
    fn answered(&mut self, rank: usize, number: u64) -> Option<Held> {
        let held = self.ranks[rank].held.pop_front_if(|held| held.number == number)?;
        if held.void {
            // It was slow, not silent.
            let took = held.since.elapsed().as_secs_f64();
            self.patience = math::at_least(self.patience, math::at_most(4.0 * took, PATIENT));
        }
        Some(held)
    }

    /// A lease was answered.
    fn take(&mut self, rank: usize, answer: &Answer, round: Option<(&mut Round<'_, '_>, bool)>) {
        let Some(held) = self.answered(rank, answer.number) else {
            return self.dismiss(rank, nonsense(), round.map(|(round, _)| round));
        };
        let Some((round, halted)) = round.filter(|_| !held.void) else { return };
        let fits = round.receive(&held.places, &answer.finished, &answer.cells);
        if fits {
            round.add_steps(answer.steps);
        }
        if fits && answer.finished.iter().all(|finished| *finished) {
            let seconds = answer.seconds / held.places.len().max(1) as f64;
            if seconds.is_finite() && seconds >= 0.0 {
                self.pace = Some((round.world, seconds));
            }
            return;
        }
        round.lose(held.places);
        // Only where time is up may something be left undone.
        if !fits || !halted {
            self.dismiss(rank, nonsense(), Some(round));
        }
    }

    /// A rank is gone, or is told to go: what it held is lost.
    fn dismiss(&mut self, rank: usize, why: String, round: Option<&mut Round<'_, '_>>) {
        let rank = &mut self.ranks[rank];
        rank.orders = None;
        rank.why = why;
        let lost = rank.held.drain(..).filter(|held| !held.void).map(|held| held.places);
        if let Some(round) = round {
            lost.for_each(|places| round.lose(places));
        }
    }

    /// What went wrong, in words.
    pub(super) fn warnings(&self) -> Vec<String> {
        let all = self.ranks.len();
        let left = self.ranks.iter().any(|rank| rank.works() && !rank.hangs());
        let others = if left { "others" } else { "this process" };
        let mut warnings = Vec::new();
        for (k, rank) in self.ranks.iter().enumerate() {
            if rank.orders.is_none() {
                warnings.push(format!(
                    "rank {} of {all} was lost ({}); {others} ran its trials",
                    k + 1,
                    rank.why
                ));
            } else if rank.hangs() {
                warnings.push(format!("rank {} of {all} stopped answering; {others} ran its trials", k + 1));
            } else if !rank.ready {
                warnings.push(format!("rank {} of {all} never answered; it ran no trial", k + 1));
            }
        }
        warnings
    }
}

fn nonsense() -> String {
    "its reply does not match the request".to_owned()
}
