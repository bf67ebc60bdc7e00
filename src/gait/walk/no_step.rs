//! Why there is no next step.

/// Why a walk has no next step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoStep {
    /// A body at the goal point would touch a barrier.
    #[error("the goal point is too close to a barrier for the body")]
    GoalBlocked,
    /// The goal cannot be reached on the cells of the grid.
    #[error("no way leads to the goal from ({x:.2}, {y:.2}) m")]
    NoWay {
        /// Coordinate of the place, m.
        x: f64,
        /// Coordinate of the place, m.
        y: f64,
    },
    /// Every possible step meets another body.
    #[error("other agents are in the way of every step")]
    Crowded,
    /// The search reached its limit.
    #[error("the search found no steps to the goal within {expansions} expansions")]
    Limit {
        /// Steps that were expanded.
        expansions: u32,
    },
    /// The search ran out of steps.
    #[error("the search found no steps to the goal: all successors of {expansions} steps meet a barrier")]
    Exhausted {
        /// Steps that were expanded.
        expansions: u32,
    },
    /// The whole walk has too many steps.
    #[error("the walk did not reach the goal within {steps} steps")]
    TooLong {
        /// The limit.
        steps: u32,
    },
}
