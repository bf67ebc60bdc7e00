//! How far the sources of people are, as part of the state of a batch of trials.

use crate::base::lanes::{LANES, Lanes, Mask};
use crate::model::{AgentId, Source};

/// How far the sources of a batch are; lanes are trials in both layouts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Queues {
    /// Time of the next arrival of each source, s.
    pub(in crate::kernel) next: Vec<Lanes>,
    /// How many have arrived.
    pub(in crate::kernel) arrived: Vec<[u32; LANES]>,
    /// How many have come in.
    pub entered: Vec<[u32; LANES]>,
    /// How often the next one has tried to come in.
    pub(in crate::kernel) tries: Vec<[u32; LANES]>,
    /// Per agent: how many numbers its person is behind the first one on its place. Empty without sources.
    pub(in crate::kernel) later: Vec<[u32; LANES]>,
    /// Lanes in which a place was given to a second person.
    pub reused: Mask,
    /// Lanes in which more have arrived than there is room for: the trial is unresolved.
    pub full: Mask,
    /// Which source that was.
    pub(in crate::kernel) which: [u32; LANES],
}

impl Queues {
    /// The lanes in which member `number` of a source, counted from 0, has come in.
    pub fn has_entered(&self, source: usize, number: u32) -> Mask {
        let Some(entered) = self.entered.get(source) else { return Mask::NONE };
        let here = entered.iter().enumerate().filter(|(_, entered)| **entered > number);
        here.fold(Mask::NONE, |mask, (lane, _)| mask | Mask::lane(lane))
    }

    /// Why the trial in a lane is unresolved, if a source is the reason.
    pub fn overrun(&self, sources: &[Source], lane: usize) -> Option<String> {
        let source = sources.get(self.which[lane] as usize).filter(|_| self.full.has(lane))?;
        let (count, name) = (source.members.len(), &source.name);
        let words =
            if self.reused.has(lane) { "are present at once from source" } else { "arrived by source" };
        Some(format!("more than {count} agents {words} `{name}`; write a larger `limit`"))
    }

    /// Why a question that follows single people has no answer in the trial of a lane, if that is the reason.
    pub fn lost_sight(&self, sources: &[Source], lane: usize) -> Option<String> {
        let source = sources.get(self.which[lane] as usize).filter(|_| self.reused.has(lane))?;
        let (count, name) = (source.members.len(), &source.name);
        Some(format!(
            "more than {} arrived by source `{name}`, and the formula follows single agents of it; write a larger `limit`",
            if count == 1 { "1 agent".to_owned() } else { format!("{count} agents") }
        ))
    }

    /// The name of the person on a place of a source, if it is not the first one there: `doors[57]`.
    pub fn arrival(&self, sources: &[Source], agent: AgentId, lane: usize) -> Option<String> {
        let later = self.later(agent.0 as usize, lane);
        let source = sources.iter().find(|source| later > 0 && source.members.contains(&agent))?;
        let place = source.members.iter().position(|member| *member == agent)?;
        Some(format!("{}[{}]", source.name, place as u32 + later + 1))
    }

    /// How many numbers the person on an agent's place is behind the first one there; 0 but for places of sources.
    #[inline]
    pub fn later(&self, agent: usize, lane: usize) -> u32 {
        self.later.get(agent).map_or(0, |later| later[lane])
    }
}
