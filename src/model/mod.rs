//! Floor 1: what a scenario is once the language is gone. SI units, doubles, indices; no names to resolve.

pub mod agent;
pub mod behaviour;
mod digest;
mod evaluation;
pub mod expression;
pub mod function;
mod index;
pub mod kind;
mod lacking;
pub mod law;
pub mod mention;
pub mod moves;
pub mod parameter;
pub mod planner;
pub mod process;
pub mod scenario;
pub mod scene;
pub mod sight;
pub mod source;
pub mod stepper;

pub use agent::{Agent, AgentId, Body, Goal, Group, Leg, Particle, Position, Route, Start};
pub use behaviour::{Amount, Attached, Behaviour, Behaviours, Conduct, Mode, Transition, Trigger};
pub use expression::{Arithmetic, Axis, Bool, Comparison, Fold, Function, Num, Place, Set, Who};
pub use function::{BuiltIn, Collective, Field, Pair, Separation};
pub use index::{BehaviourId, VariableId};
pub use kind::Kind;
pub use law::{Family, Law};
pub use moves::{Move, Moves};
pub use parameter::{PARAMETERS, Parameter, TOP_SPEED};
pub use planner::{Planner, RoadmapRule, SpeedRule};
pub use process::{Branch, Command, Domain, Process, Processes, Timing, Variable};
pub use scenario::Scenario;
pub use scene::{Barrier, BarrierId, Line, LineId, Obstacle, Region, RegionId, Scene};
pub use sight::{Piece, Sight};
pub use source::Source;
pub use stepper::{GaitRule, SearchRule, Stepper};
