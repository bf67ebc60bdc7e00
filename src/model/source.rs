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
    /// Places for those who come, in the order of arrival; when all are taken, the first of those who have left is given
    /// to the next one. Where nobody has left, one more makes the trial unresolved.
    pub members: Vec<AgentId>,
    /// So many may come in a trial: stable numbers of people are kept for them. One more makes it unresolved.
    pub most: u32,
}
