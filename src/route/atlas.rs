//! What ways depend on: the networks of a scene for all radii of bodies, and the fields of all goals. Each is made when it is
//! first needed, once a run, and depends on nothing but the scene.

use super::field::Field;
use super::goal::Entry;
use super::network::Network;
use super::way::ShortestWay;
use crate::base::geometry::Vec2;
use crate::model::{ByDoors, Goal, Scene, Sight};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

/// Radii that agents draw are rounded up to multiples of this length, m, so that agents share networks.
const CLASS: f64 = 0.05;

/// A map whose values are made once.
#[derive(Debug)]
pub(super) struct Store<K, V>(Mutex<BTreeMap<K, Arc<OnceLock<V>>>>);

impl<K, V> Default for Store<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Ord, V> Store<K, V> {
    /// The place of a value; who asks for it first makes it while others wait.
    pub(super) fn place(&self, key: K) -> Arc<OnceLock<V>> {
        // A thread that panicked left a whole map behind.
        let mut map = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        map.entry(key).or_default().clone()
    }
}

/// The goal of a field, so that it can be looked up: a region, or the bits of a point.
pub(super) type GoalKey = (Option<u32>, [u64; 2]);

pub(super) fn key(goal: &Goal) -> GoalKey {
    match goal {
        Goal::Region(id) => (Some(id.0), [0; 2]),
        Goal::Point(point) => (None, [point.x.to_bits(), point.y.to_bits()]),
    }
}

/// From which portals ways lead to one, and how long they are as lengths on a level, m.
pub(super) type Arcs = Vec<(usize, f64)>;

/// The network of one radius with its fields.
#[derive(Debug)]
struct Sheet {
    network: Network,
    fields: Store<GoalKey, Option<Field>>,
}

/// The ways of a scene for each set of closed doors.
#[derive(Debug)]
pub(super) struct Atlases {
    scene: Scene,
    by_doors: ByDoors<Atlas>,
}

impl Atlases {
    /// Of a scene.
    pub(super) fn new(scene: Scene) -> Self {
        Self { by_doors: ByDoors::new(scene.doors.len()), scene }
    }

    /// The scene.
    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The ways where these doors are closed of those that may change: bit k is the k-th.
    pub(super) fn of(&self, closed: u32) -> &Atlas {
        self.by_doors.of(closed, || Atlas::new(self.scene.with_closed(closed).into_owned()))
    }
}

/// All ways of a scene.
#[derive(Debug)]
pub struct Atlas {
    scene: Scene,
    sight: Arc<Sight>,
    sheets: Store<u64, Sheet>,
    /// The ways of each island of a scene with levels.
    pub(super) islands: Vec<Self>,
    /// The ways on one island between portals, by radius and share of the speed on stairs.
    pub(super) arcs: Store<(u64, u64), Vec<Arcs>>,
    /// The time from behind each portal to a goal.
    pub(super) behind: Store<(GoalKey, u64, u64), Vec<f64>>,
}

impl Atlas {
    /// Of a scene.
    pub fn new(scene: Scene) -> Self {
        let islands = (0..scene.storeys.islands.len()).map(|island| Self::new(scene.island(island)));
        let islands = islands.collect();
        let sight = Arc::new(Sight::new(&scene));
        let (sheets, arcs, behind) = (Store::default(), Store::default(), Store::default());
        Self { scene, sight, sheets, islands, arcs, behind }
    }

    /// The radius for which ways of a body are looked up, m: its own, or where it is drawn, the next multiple of 5 cm.
    pub fn class(radius: f64, is_drawn: bool) -> f64 {
        if is_drawn { (radius / CLASS - 1e-9).ceil() * CLASS } else { radius }
    }

    /// The shortest way of a body of a radius, m, from a place to a goal; `None` if there is none. On stairs its speed is that of
    /// their tables.
    pub fn way(&self, from: Vec2, goal: &Goal, radius: f64) -> Option<ShortestWay> {
        self.way_of((radius, 1.0), from, goal)
    }

    /// The same for a body with another share of the speeds on stairs.
    pub(super) fn way_of(
        &self,
        (radius, climbs): (f64, f64),
        from: Vec2,
        goal: &Goal,
    ) -> Option<ShortestWay> {
        if !self.islands.is_empty() {
            return self.way_over_stairs(from, goal, radius, climbs);
        }
        let sheet = self.sheets.place(radius.to_bits());
        let sheet = sheet.get_or_init(|| {
            let network = Network::new(self.sight.clone(), radius);
            Sheet { network, fields: Store::default() }
        });
        let field = sheet.fields.place(key(goal));
        let field = field.get_or_init(|| {
            Entry::new(&self.scene, goal, radius).map(|entry| Field::new(&sheet.network, entry))
        });
        sheet.network.way(field.as_ref()?, from)
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The barriers between which ways lead.
    pub fn sight(&self) -> &Sight {
        &self.sight
    }
}
