//! Episodes: trials in which somebody outside drives an agent, step by step, and a query says what each is worth.

use super::diagnostics::Diagnostics;
use super::model::Model;
use super::options::Options;
use super::own::refuse;
use crate::base::geometry::Vec2;
use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::engine::PreparedWorld;
use crate::kernel::{Address, End, Run, State};
use crate::model::AgentId;
use crate::trials::batch::Monitors;
use crate::trials::cell::Reading;
use crate::trials::columns::StepColumns;
use std::sync::Arc;

/// A model on which episodes are played: one agent is driven, and the first query of a text is asked of each episode.
pub struct Stage {
    prepared: PreparedWorld,
    agent: AgentId,
    column: Option<usize>,
}

impl std::fmt::Debug for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stage").field("agent", &self.agent).finish_non_exhaustive()
    }
}

impl Model {
    /// A stage on which an agent of this name is driven. A check or an estimate of a probability is worth 1 where its formula is
    /// true; an estimate of a mean, such as that of a robustness, what its metric comes to.
    ///
    /// # Errors
    /// Errors of the query; where there is no such agent, or it moves by plans or steps; and in continuous time.
    pub fn stage(&self, agent: &str, query: Option<&str>, seed: u64) -> Result<Stage, Diagnostics> {
        let agents = self.drivable(Some(agent))?;
        let [agent] = agents[..] else {
            let hint = format!("name one of them: `{agent}[1]`");
            return refuse(format!("`{agent}` are {} agents, and one is driven", agents.len()), hint);
        };
        let options = Options::default().seed(seed);
        let properties: Vec<(&str, &str)> = query.iter().map(|text| ("episode.bltl", *text)).collect();
        let (prepared, _) = self.ask(&properties, &options, &Arc::new(options.budget()), |asked| {
            let target = asked.study.queries.first().and_then(|query| query.ask.target());
            if query.is_some() && target.is_none() {
                return Ok(None);
            }
            let world = target.map_or(asked.study.base, |target| target.world);
            let column = target.map(|target| target.column);
            Ok(PreparedWorld::of(asked.study, world, seed, asked.call.drivers).map(|one| (one, column)))
        })?;
        match prepared {
            Some((prepared, column)) => Ok(Stage { prepared, agent, column }),
            None => {
                refuse("the query asks nothing of a trial".to_owned(), "write `check P(…) >= 0.9`".to_owned())
            }
        }
    }
}

impl Stage {
    /// The number of the agent that is driven.
    pub fn agent(&self) -> usize {
        self.agent.0 as usize
    }

    /// Length of a step, s.
    pub fn dt(&self) -> f64 {
        self.prepared.program.dt
    }

    /// The trial of an index, in its first state.
    ///
    /// # Errors
    /// Where it cannot start.
    pub fn episode(&self, seed: u64, index: u64) -> Result<Episode, String> {
        let key = TrialKey { seed, index, branch: 0 };
        let program = self.prepared.program.clone();
        let scenario = Arc::clone(&program.scenario);
        let start = Run::owned(program, Address::from(key));
        let (run, loaded) = start.map_err(|fault| crate::engine::no_start(&scenario, fault))?;
        let columns: Vec<usize> = self.column.into_iter().collect();
        let mut monitors = StepColumns::new(&self.prepared, &columns).map_err(|error| error.to_string())?;
        monitors.start(0, !loaded.shrunk.is_empty());
        let mut episode = Episode { run, monitors, agent: self.agent, end: None, reading: None };
        episode.look(self.column.is_some());
        Ok(episode)
    }
}

/// An episode under way.
pub struct Episode {
    run: Run<'static>,
    monitors: StepColumns,
    agent: AgentId,
    end: Option<End>,
    reading: Option<Reading>,
}

impl Episode {
    /// The present state.
    pub fn state(&self) -> &State {
        self.run.state()
    }

    /// Why it ended, if it did.
    pub fn end(&self) -> Option<End> {
        self.end
    }

    /// What the query came to, once that is decided.
    pub fn worth(&self) -> Option<f64> {
        match self.reading? {
            Reading::Truth(truth) => Some(f64::from(u8::from(truth))),
            Reading::Value(value) => Some(value),
            Reading::Unresolved | Reading::Faulty => Some(f64::NAN),
        }
    }

    /// Drives the agent with a velocity, m/s, for one step.
    pub fn step(&mut self, velocity: Vec2) {
        if self.end.is_some() {
            return;
        }
        let asks = self.reading.is_none();
        self.run.drive(self.agent, velocity);
        match self.run.next_state() {
            Ok(_) => self.look(asks),
            Err(end) => self.close(end, asks),
        }
        if let Some(end) = self.run.end(0).filter(|_| self.end.is_none()) {
            self.close(end, self.reading.is_none());
        }
    }

    /// Shows the present state to the monitor.
    fn look(&mut self, asks: bool) {
        let first = if self.run.state().ticks[0] == 0 { Mask::lane(0) } else { Mask::NONE };
        if asks && self.monitors.observe(&self.run, first).has(0) {
            self.read();
        }
    }

    fn close(&mut self, end: End, asks: bool) {
        self.end = Some(end);
        if asks {
            self.read();
        }
    }

    fn read(&mut self) {
        self.monitors.finish(0, 0, &self.run);
        self.reading = self.monitors.take().cells.first().map(|cell| cell.reading);
    }
}
