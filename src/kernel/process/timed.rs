//! Processes with rates and delays: when they jump, and where to.
//!
//! A process uses up its n-th unit exponential number at the rate of its race, and jumps when it is used up: the
//! random time change of Kurtz, as in the modified next reaction method (Anderson, J. Chem. Phys. 127, 214107,
//! 2007). So a process draws one block of random numbers for each of its own jumps, addressed by its entity and the
//! number of that jump, and a time that is due stays, to the last bit, as long as the rate does. What other processes
//! do, or whether there are any, moves none of its draws. A delay is drawn when its command becomes enabled, kept
//! while it stays so, and forgotten when it does not. What is due at one time happens in order of processes, then
//! of commands.

use super::super::code::{Code, Readings};
use super::super::state::{Layout, State};
use super::Form;
use super::commands::Event;
use super::delay::{after, delay};
use super::draws::exponentials;
use super::table::Table;
use crate::base::decimal::Decimal;
use crate::base::instant::Instant;
use crate::base::lanes::{LANES, Mask};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::tick::Clock;
use crate::kernel::fault::Fault;
use crate::model::law::Ready;
use crate::model::{Domain, Process, Scenario, Timing};
use fearless_simd::Level;
use std::collections::BTreeSet;

/// More jumps than these at one time are an error of the model.
const MOST_AT_ONCE: u32 = 100_000;

/// What a delay can be: doubles, ascending, and what they stand for.
#[derive(Clone, Debug)]
struct Exact(Vec<(f64, Instant)>);

impl Exact {
    fn new(values: &[(f64, Decimal)]) -> Self {
        let mut values: Vec<_> =
            values.iter().map(|(value, exact)| (*value, Instant::from(*exact))).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self(values)
    }

    /// What was drawn, as it was meant.
    #[inline]
    fn of(&self, drawn: f64) -> Instant {
        let place = self.0.partition_point(|(value, _)| *value < drawn);
        match self.0.get(place) {
            Some((value, exact)) if *value == drawn => *exact,
            _ => Instant::decimal(drawn),
        }
    }
}

/// One process.
#[derive(Clone, Debug)]
struct Racer {
    /// Its number in the scenario.
    process: u32,
    entity: u32,
    /// The part of the counter that names it.
    word: u64,
    /// Its first clock: that of the race. The others are those of `delayed`.
    first: usize,
    /// Commands with delays.
    delayed: Vec<(usize, Ready, Exact)>,
    form: Form,
    /// Those that may have to look again when it has jumped, itself among them.
    followers: Vec<usize>,
}

/// All processes with rates and delays.
#[derive(Clone, Debug)]
pub(super) struct Timed {
    racers: Vec<Racer>,
    /// The process and the place in it of each clock.
    owners: Vec<(usize, usize)>,
    /// Guards, rates, probabilities and updates of those that are no tables.
    code: Option<Code>,
    /// The variables that they set.
    pub(super) written: Vec<u32>,
    clock: Clock,
    /// Whether sums of times are exact.
    is_exact: bool,
    level: Level,
}

/// Whether a process has rates or delays.
pub(super) fn is_timed(process: &Process) -> bool {
    process.commands.iter().any(|command| command.timing != Timing::Step)
}

impl Timed {
    /// Those of a scenario, if there are any. Tables have at most `rows` rows.
    pub(super) fn of(scenario: &Scenario, domains: &[Domain], rows: u64, level: Level) -> Option<Self> {
        let list = &scenario.processes.list;
        let timed: Vec<usize> = (0..list.len()).filter(|&k| is_timed(&list[k])).collect();
        if timed.is_empty() {
            return None;
        }
        let (mut atoms, mut signals) = (Vec::new(), Vec::new());
        let (mut racers, mut owners) = (Vec::new(), Vec::new());
        let mut coded = false;
        // What each reads (everything, if it reads more than variables) and writes.
        let (mut read, mut written) = (Vec::new(), Vec::new());
        for (place, &number) in timed.iter().enumerate() {
            let process = &list[number];
            let mut delayed = Vec::new();
            for (k, command) in process.commands.iter().enumerate() {
                if let Timing::Delay(law, exact) = &command.timing {
                    delayed.push((k, law.ready(), Exact::new(exact)));
                }
            }
            let mut events = vec![Event::Race];
            events.extend(delayed.iter().map(|(k, ..)| Event::Delay(*k)));
            let form = Form::of(scenario, number, domains, &events, rows, (&mut atoms, &mut signals));
            coded |= matches!(form, Form::Code(_));
            let mut variables = BTreeSet::new();
            let closed = process.reads(&mut variables);
            read.push(closed.then_some(variables));
            let updates = process.commands.iter().flat_map(|command| &command.branches);
            let own: BTreeSet<u32> = updates.flat_map(|b| b.updates.iter().map(|(id, _)| id.0)).collect();
            written.push(own);
            let first = owners.len();
            owners.extend((0..=delayed.len()).map(|slot| (place, slot)));
            let stream = Stream::of(TrialKey::default(), process.entity, Purpose::Process);
            let word = u64::from(stream.counter(0)[1]);
            let (process, entity) = (number as u32, process.entity);
            racers.push(Racer { process, entity, word, first, delayed, form, followers: Vec::new() });
        }
        for (k, racer) in racers.iter_mut().enumerate() {
            let follows = |j: usize| {
                j == k || read[j].as_ref().is_none_or(|read| read.iter().any(|id| written[k].contains(&id.0)))
            };
            racer.followers = (0..timed.len()).filter(|&j| follows(j)).collect();
        }
        let delayed = racers.iter().any(|racer| !racer.delayed.is_empty());
        let is_exact = delayed && scenario.clock.is_jumps();
        Some(Self {
            clock: scenario.clock,
            is_exact,
            racers,
            owners,
            code: coded.then(|| Code::compile(scenario, &atoms, &signals)),
            written: written.into_iter().flatten().collect(),
            level,
        })
    }

    /// The same processes for the plainest vectors of the machine.
    pub(super) fn at_baseline(self) -> Self {
        Self { level: Level::baseline(), code: self.code.map(Code::at_baseline), ..self }
    }

    /// The one process that there is, where it is a table and has no delays, and the word that names it.
    pub(super) fn alone(&self) -> Option<(u64, &Table)> {
        match self.racers.as_slice() {
            [Racer { word, form: Form::Table(table), .. }] if !table.has_delays() => Some((*word, table)),
            _ => None,
        }
    }

    /// Begins a trial.
    pub(super) fn load(&self, state: &mut State, lane: usize) {
        state.clocks.load(self.owners.len(), self.racers.len(), self.is_exact, lane);
    }

    /// Looks at the state as it is at `state.clocks.now`: sets the clocks of trials that have just begun, and
    /// those of others where something outside of these processes may have changed.
    pub(super) fn look(&self, layout: Layout, state: &mut State, readings: &mut Readings, lanes: Mask) {
        let fresh = state.clocks.fresh & lanes;
        state.clocks.fresh &= !lanes;
        if !fresh.is_empty() {
            for (k, racer) in self.racers.iter().enumerate() {
                self.draw(state, fresh, &[racer.word; LANES], &[k; LANES]);
            }
        }
        self.read(layout, state, readings);
        for lane in lanes.iter() {
            let again = fresh.has(lane);
            for k in 0..self.racers.len() {
                let fired = again.then(|| self.racers[k].first);
                if !self.review(k, fired, lane, state, readings) {
                    break;
                }
            }
        }
    }

    /// The next thing happens in those of `lanes` in which it is due up to and with `until`; these lanes.
    pub(super) fn ring(
        &self,
        layout: Layout,
        state: &mut State,
        readings: &mut Readings,
        lanes: Mask,
        until: &[f64; LANES],
    ) -> Mask {
        let (which, when) = state.clocks.first();
        let (mut rang, mut racing, mut coded) = (Mask::NONE, Mask::NONE, false);
        let (mut racers, mut words) = ([0; LANES], [0; LANES]);
        for lane in lanes.iter() {
            if when[lane] <= until[lane] && when[lane] < f64::INFINITY {
                rang |= Mask::lane(lane);
                let (racer, slot) = self.owners[which[lane]];
                racers[lane] = racer;
                words[lane] = self.racers[racer].word;
                racing |= if slot == 0 { Mask::lane(lane) } else { Mask::NONE };
                coded |= matches!(self.racers[racer].form, Form::Code(_));
            }
        }
        if rang.is_empty() {
            return rang;
        }
        if coded {
            self.read(layout, state, readings);
        }
        for lane in rang.iter() {
            if let Err(fault) = self.fire(which[lane], lane, state, readings) {
                stop(state, lane, fault);
            }
        }
        self.draw(state, racing, &words, &racers);
        let go_on = rang & !state.faulty;
        if self.code.is_some() {
            let more = |lane: usize| &self.racers[racers[lane]].followers;
            let is_code = |k: &usize| matches!(self.racers[*k].form, Form::Code(_));
            if go_on.iter().any(|lane| more(lane).iter().any(is_code)) {
                self.read(layout, state, readings);
            }
        }
        for lane in go_on.iter() {
            for &k in &self.racers[racers[lane]].followers {
                if !self.review(k, Some(which[lane]), lane, state, readings) {
                    break;
                }
            }
        }
        rang
    }

    /// What waits for an exponential time waits anew from `at` on, with the numbers of the key that the lane has now: for
    /// exponential times that is the same law. What waits for a delay keeps what is left of it; only what happens at
    /// its end is drawn again.
    pub(super) fn renew(&self, state: &mut State, lane: usize, at: f64) {
        for (k, racer) in self.racers.iter().enumerate() {
            self.draw(state, Mask::lane(lane), &[racer.word; LANES], &[k; LANES]);
            let key = state.keys[lane];
            let clocks = &mut state.clocks;
            let race = racer.first;
            let (rate, fuel) = (clocks.rate[race].0[lane], clocks.fuel[race].0[lane]);
            clocks.set(race, lane, if rate > 0.0 { at + fuel / rate } else { f64::INFINITY });
            for (j, (_, law, _)) in racer.delayed.iter().enumerate() {
                let clock = race + 1 + j;
                if clocks.due[clock].0[lane] < f64::INFINITY {
                    let number = &mut clocks.delays[k][lane];
                    (_, clocks.pick[clock].0[lane]) = delay(key, racer.entity, *number, law);
                    *number += 1;
                }
            }
        }
    }

    /// The process that has jumped most often in a lane, in a jam in its last step, and its present rate, 1/s.
    pub(super) fn busiest(&self, state: &State, lane: usize) -> Option<(u32, f64)> {
        let clocks = &state.clocks;
        let most = if clocks.jammed.has(lane) {
            clocks.jammer[lane]
        } else {
            (0..self.racers.len()).max_by_key(|&k| (clocks.fired[k][lane], std::cmp::Reverse(k)))?
        };
        let racer = self.racers.get(most)?;
        Some((racer.process, clocks.rate[racer.first].0[lane]))
    }

    fn read(&self, layout: Layout, state: &State, readings: &mut Readings) {
        if let Some(code) = &self.code {
            code.read(layout, state, readings);
        }
    }

    /// Draws the next exponential number of a process of each of some lanes, and the number that decides what
    /// will happen.
    #[inline]
    fn draw(&self, state: &mut State, lanes: Mask, words: &[u64; LANES], racers: &[usize; LANES]) {
        if lanes.is_empty() {
            return;
        }
        let mut numbers = [0; LANES];
        for lane in lanes.iter() {
            let races = &mut state.clocks.races[racers[lane]][lane];
            numbers[lane] = u64::from(*races);
            *races += 1;
        }
        let [fuel, pick] = exponentials(self.level, state, &numbers, words);
        for lane in lanes.iter() {
            let clock = self.racers[racers[lane]].first;
            state.clocks.fuel[clock].0[lane] = fuel[lane];
            state.clocks.pick[clock].0[lane] = pick[lane];
        }
    }

    /// A clock rings.
    #[inline]
    fn fire(&self, clock: usize, lane: usize, state: &mut State, readings: &Readings) -> Result<(), Fault> {
        let (place, slot) = self.owners[clock];
        let racer = &self.racers[place];
        let clocks = &mut state.clocks;
        let before = clocks.instant(lane);
        clocks.reach(clock, lane);
        let crowd = if before.is_before(clocks.instant(lane)) { 0 } else { clocks.crowd[lane] + 1 };
        clocks.crowd[lane] = crowd;
        if crowd > MOST_AT_ONCE {
            return Err(Fault::Stuck { process: racer.process });
        }
        let u = clocks.pick[clock].0[lane];
        match &racer.form {
            Form::Table(table) => {
                let row = clocks.rows[place][lane] as usize;
                table.fire(row, slot, u, lane, &mut state.variables)?;
            }
            Form::Code(commands) => {
                let event = slot.checked_sub(1).map_or(Event::Race, |k| Event::Delay(racer.delayed[k].0));
                if let Some(way) = commands.way(event, readings, lane, u) {
                    commands.fire(way?, readings, lane, &mut state.variables)?;
                }
            }
        }
        state.clocks.jumps[lane] += 1;
        let fired = &mut state.clocks.fired[place][lane];
        *fired = fired.wrapping_add(1);
        Ok(())
    }

    /// A process looks at the state in which its trial is now; `fired` has just rung. False if the trial ends
    /// by an error.
    #[inline]
    fn review(
        &self,
        k: usize,
        fired: Option<usize>,
        lane: usize,
        state: &mut State,
        readings: &Readings,
    ) -> bool {
        let racer = &self.racers[k];
        let total = match &racer.form {
            Form::Table(table) => {
                let row = table.keys.row(&state.variables, lane);
                state.clocks.rows[k][lane] = row as u32;
                table.total(row)
            }
            Form::Code(commands) => commands.total(readings, lane).map(|total| (total, 1.0 / total)),
        };
        let (total, mean) = match total {
            Ok(found) => found,
            Err(fault) => {
                stop(state, lane, fault);
                return false;
            }
        };
        let clocks = &mut state.clocks;
        let now = clocks.now[lane];
        let race = racer.first;
        let rate = clocks.rate[race].0[lane];
        let rang = fired == Some(race);
        if rang || total != rate {
            if !rang && rate > 0.0 {
                let left = (clocks.due[race].0[lane] - now) * rate;
                clocks.fuel[race].0[lane] = if left > 0.0 { left } else { 0.0 };
            }
            clocks.rate[race].0[lane] = total;
            let fuel = clocks.fuel[race].0[lane];
            clocks.set(race, lane, if total > 0.0 { now + fuel * mean } else { f64::INFINITY });
        }
        for (j, (command, law, exact)) in racer.delayed.iter().enumerate() {
            let enabled = match &racer.form {
                Form::Table(table) => table.runs(clocks.rows[k][lane] as usize, j + 1),
                Form::Code(commands) => commands.enabled(*command, readings, lane),
            };
            let clock = race + 1 + j;
            let due = clocks.due[clock].0[lane];
            if !enabled {
                clocks.due[clock].0[lane] = f64::INFINITY;
            } else if due == f64::INFINITY || fired == Some(clock) {
                let number = &mut clocks.delays[k][lane];
                let (wait, pick) = delay(state.keys[lane], racer.entity, *number, law);
                *number += 1;
                if self.is_exact {
                    clocks.set_after(clock, lane, exact.of(wait));
                } else {
                    clocks.due[clock].0[lane] = after(now, wait, self.clock);
                }
                clocks.pick[clock].0[lane] = pick;
            }
        }
        true
    }
}

/// The trial of a lane ends by an error of the model.
#[cold]
fn stop(state: &mut State, lane: usize, fault: Fault) {
    state.faulty |= Mask::lane(lane);
    state.faults[lane] = Some(fault);
}
