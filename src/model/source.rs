//! Sources: people who come in while a trial runs.

use super::agent::AgentId;
use super::law::Law;

/// Where people come in.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Its name.
    pub name: String,
    /// Stable number of 24 bits; addresses the times between arrivals.
    pub entity: u32,
    /// Times between arrivals, s; the first one comes after the first of them.
    pub every: Law,
    /// Those who may come: the n-th is the n-th arrival. With one more the trial is unresolved.
    pub members: Vec<AgentId>,
}
