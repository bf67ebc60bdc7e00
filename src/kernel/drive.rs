//! Who wants to go where: nobody changes their mind.

use super::program::Program;
use super::state::State;

/// Updates driving directions, driving speeds and presence to the present positions and ticks.
pub fn steer(_program: &Program, _state: &mut State) {}
