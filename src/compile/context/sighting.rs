//! Who is seen at an instant: what compilation gets of recordings and of streams.

use crate::base::geometry::Vec2;
use crate::data::tracks::{PersonState, Recording};
use crate::model::{AgentId, Law};
use crate::syntax::source::Span;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Speed below which a recorded person stands, m/s.
pub(crate) const STANDS: f64 = 0.05;

/// Somebody at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Who it is.
    pub id: u32,
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s.
    pub velocity: Vec2,
    /// The velocity that this person wants to have, m/s: the mean over the memory of the track.
    pub driving: Vec2,
    /// The mean of that over all companions who walk, m/s: their common intention.
    pub shared: Vec2,
    /// How many others are around, 1/m^2; 0 where that was not looked at.
    pub density: f64,
}

impl Sighting {
    /// Somebody alone who goes on, at a position, m, with a velocity, m/s.
    pub fn new(id: u32, position: Vec2, velocity: Vec2) -> Self {
        Self { id, position, velocity, driving: velocity, shared: velocity, density: 0.0 }
    }

    /// The same with another velocity that is wanted, m/s.
    fn who_wants(self, driving: Vec2) -> Self {
        Self { driving, shared: driving, ..self }
    }
}

/// Companions want what they want on the mean, all who walk; groups are of ascending ids.
pub(crate) fn agree(people: &mut [Sighting], groups: &[Vec<u32>]) {
    for group in groups {
        let walks =
            |one: &Sighting| group.binary_search(&one.id).is_ok() && one.driving.magnitude() >= STANDS;
        let own: Vec<Vec2> = people.iter().filter(|one| walks(one)).map(|one| one.driving).collect();
        let mean = own.iter().sum::<Vec2>() / own.len() as f64;
        if mean.magnitude() >= STANDS {
            people.iter_mut().filter(|one| walks(one)).for_each(|one| one.shared = mean);
        }
    }
}

/// So many of the nearest others tell the density around somebody.
const NEAREST: usize = 5;

/// Looks at how many others are around each: so many as there are nearest ones in the circle that holds them.
fn look_around(people: &mut [Sighting]) {
    let places: Vec<Vec2> = people.iter().map(|one| one.position).collect();
    for one in people.iter_mut().filter(|_| places.len() > NEAREST) {
        let mut squares: Vec<f64> =
            places.iter().map(|place| (place - one.position).norm_squared()).collect();
        // The nearest of all is this person.
        let (_, square, _) = squares.select_nth_unstable_by(NEAREST, f64::total_cmp);
        one.density = NEAREST as f64 / (std::f64::consts::PI * *square);
    }
}

/// Who is seen at an instant, instead of what tracks of a scenario say of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Everybody, by ascending id.
    pub people: Vec<Sighting>,
    /// Groups, each of ascending ids; whoever is in none walks alone.
    pub groups: Vec<Vec<u32>>,
    /// Times, s, and positions, m, of each up to now; mean velocities are taken over them.
    pub past: BTreeMap<u32, Vec<(f64, Vec2)>>,
}

impl Seen {
    /// The mean velocity of somebody over the last `memory` seconds, or for as long as there is a past.
    fn driving(&self, now: &Sighting, memory: f64) -> Vec2 {
        let past = self.past.get(&now.id).map_or(&[][..], Vec::as_slice);
        let Some((last, _)) = past.last().filter(|_| memory > 0.0) else { return now.velocity };
        let first = past.iter().find(|(time, _)| *time >= last - memory).filter(|(time, _)| time < last);
        first.map_or(now.velocity, |(time, position)| (now.position - position) / (last - time))
    }
}

/// How the heading and the speed of people of a site change.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    /// Angle from the present heading, rad.
    pub turn: Law,
    /// Speed as a share of the present one.
    pub pace: Law,
}

/// Finds the groups of people who are seen at an instant; each of ascending ids, in the order of the first.
pub type Grouping = fn(&[Sighting]) -> Vec<Vec<u32>>;

/// The recordings of a scenario, and who of them is in use.
#[derive(Default)]
pub(crate) struct Recordings {
    /// Those read so far; `None` for one that could not be read.
    pub(crate) known: Vec<Option<Tracks>>,
    /// The destinations beside each, m, or why there are none.
    pub(crate) destinations: Vec<Result<Vec<Vec2>, String>>,
    /// Their names, and which velocities they have.
    pub(crate) velocities: Vec<(String, &'static str)>,
    /// Finds groups of people who are seen.
    pub(crate) grouping: Option<Grouping>,
    /// The laws of the site, where they are known.
    pub(crate) site: Option<Site>,
    /// The other columns of the recording that is shown; `None` where trials are simulated.
    pub(crate) columns: Option<Vec<String>>,
    /// Agents who are named and not seen, with their stable numbers: they never come.
    pub(crate) unseen: Vec<(AgentId, u32)>,
    /// The recorded persons in use, with the places of their declarations.
    pub(crate) recorded: BTreeMap<(usize, u32), Span>,
    /// Files of learned gaits that could be read.
    pub(crate) gaits: BTreeMap<String, Arc<str>>,
}

/// Declared tracks.
pub(crate) enum Tracks {
    /// Recorded; mean velocities are taken over the last `memory` seconds.
    Recorded { recording: Recording, memory: f64 },
    /// What is seen now, whatever time is asked for.
    Live { seen: Seen, memory: f64 },
}

impl Tracks {
    /// Everybody at a time, by ascending id.
    pub(crate) fn at(&self, time: f64) -> Vec<Sighting> {
        let mut people: Vec<Sighting> = match self {
            Self::Live { seen, memory } => {
                let sighting = |one: &Sighting| one.who_wants(seen.driving(one, *memory));
                seen.people.iter().map(sighting).collect()
            }
            Self::Recorded { recording, memory } => {
                let sighting = |o: PersonState| {
                    let driving = mean_velocity(recording, &o, time, *memory);
                    Sighting::new(o.id, o.position, o.velocity).who_wants(driving)
                };
                recording.at(time).into_iter().map(sighting).collect()
            }
        };
        look_around(&mut people);
        people
    }
}

/// The mean velocity of somebody over the last `memory` seconds, or for as long as the track lasts; without a past, the present one.
fn mean_velocity(recording: &Recording, now: &PersonState, time: f64, memory: f64) -> Vec2 {
    let Some((from, _)) = recording.presence(now.id).filter(|_| memory > 0.0) else { return now.velocity };
    let since = if from > time - memory { from } else { time - memory };
    let then = recording.at(since).into_iter().find(|o| o.id == now.id);
    match then {
        Some(then) if time > since => (now.position - then.position) / (time - since),
        _ => now.velocity,
    }
}
