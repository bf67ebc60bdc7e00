//! Columns of a world over states that are given from outside, as a recording gives them, instead of simulated.

use crate::base::geometry::Vec2;
use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::compile::study::World;
use crate::engine::fault::Fault;
use crate::engine::trials::prepared::PreparedWorld;
use crate::kernel::Run;
use crate::model::{AgentId, Body, Kind, Law, Parameter};
use crate::trials::batch::Monitors;
use crate::trials::cell::Reading;
use crate::trials::columns::StepColumns;
use std::collections::BTreeSet;
use std::sync::Arc;

/// What each column comes to where everybody is at `seen` (position, m, and velocity, m/s) at each tick; who is not seen is
/// absent. From then on a column that names somebody absent is unresolved; sets consist of those who are there.
///
/// # Errors
/// For columns that no monitor can watch, and in continuous time.
pub fn judge(
    prepared: &PreparedWorld,
    columns: &[usize],
    seen: impl Fn(u64, AgentId) -> Option<(Vec2, Vec2)>,
    (told, value): (usize, impl Fn(u64, usize, AgentId) -> f64),
) -> Result<Vec<Reading>, Fault> {
    let one = |&column: &usize| {
        let mut named = BTreeSet::new();
        let (atoms, signals) = prepared.observed(&[column]);
        let mut tell = |agent: AgentId| _ = named.insert(agent);
        for atom in &atoms {
            atom.mentions(&mut tell);
        }
        for signal in &signals {
            signal.mentions(&mut tell);
        }
        let mut monitors = StepColumns::new(prepared, &[column]).map_err(|_| Fault::Unsuitable)?;
        let mut run = Run::given(&prepared.program, TrialKey::default()).map_err(|_| Fault::Unsuitable)?;
        monitors.start(0, false);
        for tick in 0..=prepared.horizon.0 {
            if named.iter().any(|agent| seen(tick, *agent).is_none()) {
                break;
            }
            run.show(tick, |agent| seen(tick, agent));
            run.tell(told, |column, agent| value(tick, column, agent));
            if monitors.observe(&run, Mask::lane(0)).has(0) {
                break;
            }
        }
        monitors.finish(0, 0, &run);
        Ok(monitors.take().cells.first().map_or(Reading::Unresolved, |cell| cell.reading))
    };
    columns.iter().map(one).collect()
}

/// The same world with everybody of the mean of each law; a recording moves them, so nobody plans or steps.
#[must_use]
pub fn averaged(world: &World) -> World {
    let mut scenario = (*world.scenario).clone();
    for agent in &mut scenario.agents {
        let mut body: Body = (*agent.body).clone();
        (body.kind, body.planner, body.stepper) = (Kind::Sfm, None, None);
        for parameter in Parameter::ALL {
            body[parameter] = Law::Constant(body[parameter].mean());
        }
        agent.body = Arc::new(body);
    }
    World { scenario: Arc::new(scenario), ..world.clone() }
}
