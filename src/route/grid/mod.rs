//! Square cells over a scene: how far barriers are from each cell, lengths of the ways from everywhere to a goal, and plain A*
//! on the cells (Hart, Nilsson, Raphael 1968).

mod astar;
mod clearance;
mod field;

pub use astar::shortest_cells;
pub use clearance::ClearanceGrid;
pub use field::{GoalField, Way};
