//! The free space and the roadmap of a kind of walkers, made once a run.

use crate::base::geometry::{Shape, Vec2};
use crate::base::random::{Purpose, Stream, TrialKey, name_hash};
use crate::model::{Agent, Goal, Law, Parameter, Planner, RoadmapRule, Scene};
use crate::route::roadmap::{FreeSpace, Prm, Roadmap, Rrt, Sampler, SamplingRule};
use std::sync::{Arc, Mutex, PoisonError};

/// The share of drawn radii for which a roadmap is made where the law has no upper end.
const WIDEST: f64 = 0.999;

/// Terrains that are kept: worlds of a sweep mostly share some.
const KEPT: usize = 64;

/// Where the walkers of a kind can be, and their roadmap.
#[derive(Debug)]
pub struct Terrain {
    scene: Scene,
    planner: Arc<Planner>,
    seed: u64,
    target: Option<Vec2>,
    /// Largest radius of a body that finds ways, m.
    pub radius: f64,
    /// Where such a body can be, at a distance of the clearance.
    pub free: FreeSpace,
    /// The roadmap.
    pub roadmap: Roadmap,
}

/// The largest radius that a law draws, or nearly, m.
pub fn widest(law: &Law) -> f64 {
    let most = law.bounds().1;
    if most.is_finite() { most } else { law.draw(WIDEST) }
}

/// The exits of a goal: the parts of its region; none of a point.
pub fn exits<'s>(scene: &'s Scene, goal: &Goal) -> &'s [Shape] {
    let Goal::Region(id) = goal else { return &[] };
    scene.regions.get(id.0 as usize).map_or(&[], |region| region.shape.parts())
}

/// The middle of a goal.
pub fn middle(scene: &Scene, goal: &Goal) -> Vec2 {
    match goal {
        Goal::Point(point) => *point,
        Goal::Region(id) => {
            scene.regions.get(id.0 as usize).map_or_else(Vec2::zeros, |region| region.shape.inner_point())
        }
    }
}

impl Terrain {
    /// Draws the roadmap of a kind. Nothing but scene, kind, radius, seed and the target of a tree has part in it.
    fn new(scene: &Scene, planner: &Arc<Planner>, radius: f64, seed: u64, target: Option<Vec2>) -> Self {
        let free = FreeSpace::new(scene, radius + planner.clearance);
        let sampler = match &planner.roadmap {
            RoadmapRule::Prm { samples, bridge, separation, neighbours } => Sampler::Prm(Prm {
                samples: *samples as usize,
                sampling: if *bridge { SamplingRule::Bridge } else { SamplingRule::Uniform },
                separation: *separation,
                neighbours: *neighbours as usize,
            }),
            RoadmapRule::Rrt { root, samples, step, bias } => Sampler::Rrt(Rrt {
                root: middle(scene, root),
                samples: *samples as usize,
                step: *step,
                bias: *bias,
                target,
            }),
        };
        let key = TrialKey { seed, index: 0, branch: 0 };
        let stream = Stream::of(key, name_hash(&planner.kind) as u32, Purpose::Run);
        let roadmap = Roadmap::draw(&free, &sampler, stream);
        Self { scene: scene.clone(), planner: Arc::clone(planner), seed, target, radius, free, roadmap }
    }

    /// The kind of the walkers.
    pub fn planner(&self) -> &Planner {
        &self.planner
    }
}

/// The terrains of a call, each made once.
#[derive(Debug, Default)]
pub struct Terrains {
    known: Mutex<Vec<Arc<Terrain>>>,
}

impl Terrains {
    /// That of an agent on its way to a goal; `None` for agents that do not plan. Trees grow towards the goal, other roadmaps are
    /// the same for all.
    pub fn of(&self, scene: &Scene, agent: &Agent, goal: &Goal, seed: u64) -> Option<Arc<Terrain>> {
        let planner = agent.body.planner.as_ref()?;
        let radius = widest(&agent.body[Parameter::Radius]);
        let target = matches!(planner.roadmap, RoadmapRule::Rrt { .. }).then(|| middle(scene, goal));
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |one: &&Arc<Terrain>| {
            one.seed == seed
                && one.radius.to_bits() == radius.to_bits()
                && one.target == target
                && (Arc::ptr_eq(&one.planner, planner) || one.planner == *planner)
                && one.scene == *scene
        };
        if let Some(terrain) = known.iter().find(is_same) {
            return Some(Arc::clone(terrain));
        }
        let terrain = Arc::new(Terrain::new(scene, planner, radius, seed, target));
        if known.len() >= KEPT {
            known.remove(0);
        }
        known.push(Arc::clone(&terrain));
        Some(terrain)
    }
}
