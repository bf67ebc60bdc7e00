//! The present states of behaviours, as part of the state of a batch of trials.

use super::route::Halt;
use crate::base::lanes::{LANES, Lanes};
use crate::base::random::TrialKey;

/// In the place of the first stage of a detour: the agent is on its own route.
pub(in crate::kernel) const OWN_ROUTE: u32 = u32::MAX;

/// The present states of the behaviours of a batch, by declared behaviour and block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActiveModes {
    /// Number of the present state; -1 in someone who has no such behaviour.
    pub modes: Vec<Vec<Lanes>>,
    /// Tick at which the present state ends by itself; infinite if it does not.
    pub(in crate::kernel) due: Vec<Vec<Lanes>>,
    /// The transition that is taken then.
    pub(in crate::kernel) exit: Vec<Vec<[u32; LANES]>>,
    /// How many states have been entered.
    pub(in crate::kernel) entered: Vec<Vec<[u32; LANES]>>,
    /// What the present state set on entering it, SI units: so many values for each block as a state of the behaviour
    /// sets at most, in order of writing.
    pub(in crate::kernel) set: Vec<Vec<Lanes>>,
    /// Under which key the parameters of an agent were drawn, by block.
    pub(in crate::kernel) own_keys: Vec<[TrialKey; LANES]>,
    /// First stage of a route that a state demands, and where the own route was left.
    pub(in crate::kernel) detours: Vec<[(u32, Halt); LANES]>,
}
