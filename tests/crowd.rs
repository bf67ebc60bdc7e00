//! A small crowd for tests of the kernel: people with constant parameters at fixed places.

use smc::base::decimal::Decimal;
use smc::base::geometry::{Segment, Vec2};
use smc::base::lanes::Mask;
use smc::base::random::TrialKey;
use smc::base::tick::{Clock, Tick};
use smc::kernel::{Layout, Program, Scratch, State, refresh};
use smc::model::{
    Agent, Barrier, Body, Group, Kind, Law, Obstacle, Parameter, Particle, Periods, Position, Route,
    Scenario, Scene, Start,
};
use std::sync::Arc;

/// A person of Helbing, Farkas, Vicsek 2000.
#[derive(Clone, Debug)]
pub(crate) struct Person {
    pub at: Vec2,
    pub velocity: Vec2,
    pub towards: Vec2,
    pub drive: f64,
    pub mass: f64,
    pub radius: f64,
    pub tau: f64,
    pub a: f64,
    pub b: f64,
    pub lambda: f64,
    pub a2: f64,
    pub b2: f64,
    pub lambda2: f64,
    pub k1: f64,
    pub k2: f64,
    pub noise: f64,
    pub foresight: f64,
    pub headway: f64,
    pub composure: f64,
    pub oncoming: f64,
    pub keep_right: f64,
    pub berth: f64,
    pub follow: f64,
    pub abreast: f64,
    pub walls: f64,
    pub hold: f64,
    pub present: bool,
    pub particle: Option<Particle>,
}

pub(crate) fn p(x: f64, y: f64) -> Vec2 {
    Vec2::new(x, y)
}

pub(crate) fn person(at: Vec2) -> Person {
    Person {
        at,
        velocity: p(0.0, 0.0),
        towards: p(1.0, 0.0),
        drive: 0.0,
        mass: 80.0,
        radius: 0.25,
        tau: 0.5,
        a: 2000.0,
        b: 0.08,
        lambda: 1.0,
        a2: 0.0,
        b2: 1.0,
        lambda2: 1.0,
        k1: 1.2e5,
        k2: 2.4e5,
        noise: 0.0,
        foresight: 0.0,
        headway: 0.0,
        composure: 0.0,
        oncoming: 0.0,
        keep_right: 0.0,
        berth: 0.0,
        follow: 0.0,
        abreast: 0.0,
        walls: 1.0,
        hold: 0.0,
        present: true,
        particle: None,
    }
}

impl Person {
    /// The value of a parameter of its body.
    fn value(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Mass => self.mass,
            Parameter::Radius => self.radius,
            Parameter::Speed => self.drive,
            Parameter::Tau => self.tau,
            Parameter::A => self.a,
            Parameter::B => self.b,
            Parameter::Lambda => self.lambda,
            Parameter::A2 => self.a2,
            Parameter::B2 => self.b2,
            Parameter::Lambda2 => self.lambda2,
            Parameter::K1 => self.k1,
            Parameter::K2 => self.k2,
            Parameter::Noise => self.noise,
            Parameter::Foresight => self.foresight,
            Parameter::Headway => self.headway,
            Parameter::Composure => self.composure,
            Parameter::Oncoming => self.oncoming,
            Parameter::KeepRight => self.keep_right,
            Parameter::Berth => self.berth,
            Parameter::Follow => self.follow,
            Parameter::Walls => self.walls,
            Parameter::Hold => self.hold,
            Parameter::Attention => 1.0,
            Parameter::Abreast => self.abreast,
            Parameter::Aside => 0.0,
            // Nobody is of the collision-free speed model.
            Parameter::Swerve | Parameter::SwerveRange | Parameter::WallSwerve | Parameter::WallRange => 0.0,
            // Of plans: 2 is a value that each of them may have.
            _ => 2.0,
        }
    }
}

/// Relaxation so slow that there is none.
pub(crate) const NEVER: f64 = 1e300;

/// A crowd and what stands around it.
#[derive(Clone, Debug)]
pub(crate) struct Crowd {
    pub people: Vec<Person>,
    pub obstacles: Vec<Obstacle>,
    pub groups: Vec<(Vec<u32>, f64)>,
    pub periods: Periods,
    pub dt: &'static str,
}

pub(crate) fn crowd(people: Vec<Person>, dt: &'static str) -> Crowd {
    Crowd { people, obstacles: Vec::new(), groups: Vec::new(), periods: Periods::default(), dt }
}

pub(crate) fn wall(a: Vec2, b: Vec2) -> Obstacle {
    Obstacle::Wall(vec![Segment::new(a, b)])
}

impl Crowd {
    pub(crate) fn program(&self) -> Program {
        let agent = |(k, person): (usize, &Person)| Agent {
            name: format!("person[{}]", k + 1),
            entity: 100 + k as u32,
            body: Arc::new(Body::new(Kind::Sfm, |parameter| Law::Constant(person.value(parameter)))),
            start: Start {
                position: Position::Point(person.at),
                velocity: person.velocity,
                ..Start::at_rest(Vec2::zeros())
            },
            route: Route::Onward,
            group: None,
            particle: person.particle,
        };
        let barrier = |obstacle: &Obstacle| Barrier { name: String::new(), obstacle: obstacle.clone() };
        let group = |(members, attraction): &(Vec<u32>, f64)| Group {
            name: String::new(),
            members: members.iter().map(|&k| smc::model::AgentId(k)).collect(),
            attraction: *attraction,
        };
        Program::new(Arc::new(Scenario {
            title: String::new(),
            clock: Clock::Stepped(Decimal::parse(self.dt).unwrap()),
            horizon: Tick(1_000_000),
            scene: Scene {
                barriers: self.obstacles.iter().map(barrier).collect(),
                periods: self.periods,
                ..Scene::default()
            },
            agents: self.people.iter().enumerate().map(agent).collect(),
            groups: self.groups.iter().map(group).collect(),
            moves: Vec::new(),
            processes: smc::model::Processes::default(),
            behaviours: smc::model::Behaviours::default(),
            sources: Vec::new(),
            doors: Vec::new(),
        }))
    }

    /// Loads trial `index` into a lane.
    pub(crate) fn load(&self, state: &mut State, lane: usize, index: u64) {
        state.occupied |= Mask::lane(lane);
        state.diverged &= !Mask::lane(lane);
        state.keys[lane] = TrialKey { seed: 42, index, branch: 0 };
        state.ticks[lane] = 0;
        for (k, person) in self.people.iter().enumerate() {
            let slot = state.slot(k, lane);
            let (b, l) = (slot.block, slot.lane);
            if person.present {
                state.present[b] |= Mask::lane(l);
            } else {
                state.present[b] &= !Mask::lane(l);
            }
            state.motion.x[b].0[l] = person.at.x;
            state.motion.y[b].0[l] = person.at.y;
            state.motion.vx[b].0[l] = person.velocity.x;
            state.motion.vy[b].0[l] = person.velocity.y;
            state.driving.ex[b].0[l] = person.towards.x;
            state.driving.ey[b].0[l] = person.towards.y;
            state.driving.speed[b].0[l] = person.drive;
            state.motion.travelled[b].0[l] = 0.0;
            for parameter in Parameter::ALL {
                state.bodies[parameter][b].0[l] = person.value(parameter);
            }
            state.motion.fx[b].0[l] = 0.0;
            state.motion.fy[b].0[l] = 0.0;
        }
    }

    /// One trial, ready to run.
    pub(crate) fn start(&self, layout: Layout) -> Run {
        let program = self.program();
        let mut state = State::new(layout, self.people.len());
        let mut scratch = Scratch::default();
        self.load(&mut state, 0, 0);
        refresh(&program, &mut state, &mut scratch, Mask::lane(0));
        Run { program, state, scratch }
    }
}

/// A batch that runs; lane 0 is looked at.
pub(crate) struct Run {
    pub program: Program,
    pub state: State,
    pub scratch: Scratch,
}

impl Run {
    pub(crate) fn steps(&mut self, count: usize) {
        for _ in 0..count {
            smc::kernel::step(&self.program, &mut self.state, &mut self.scratch);
        }
    }

    fn pair(&self, x: &[smc::base::lanes::Lanes], y: &[smc::base::lanes::Lanes], agent: usize) -> Vec2 {
        let slot = self.state.slot(agent, 0);
        p(x[slot.block].0[slot.lane], y[slot.block].0[slot.lane])
    }

    pub(crate) fn at(&self, agent: usize) -> Vec2 {
        self.pair(&self.state.motion.x, &self.state.motion.y, agent)
    }

    pub(crate) fn velocity(&self, agent: usize) -> Vec2 {
        self.pair(&self.state.motion.vx, &self.state.motion.vy, agent)
    }

    pub(crate) fn force(&self, agent: usize) -> Vec2 {
        self.pair(&self.state.motion.fx, &self.state.motion.fy, agent)
    }

    pub(crate) fn fastest(&self) -> f64 {
        (0..self.state.agents).map(|k| self.velocity(k).norm()).fold(0.0, f64::max)
    }
}

/// All bits of one lane.
pub(crate) fn bits_of(state: &State, lane: usize) -> Vec<u64> {
    let fields = [
        &state.motion.x,
        &state.motion.y,
        &state.motion.vx,
        &state.motion.vy,
        &state.driving.ex,
        &state.driving.ey,
        &state.driving.speed,
        &state.motion.slowness,
        &state.driving.rest_x,
        &state.driving.rest_y,
        &state.motion.travelled,
        &state.motion.fx,
        &state.motion.fy,
        &state.bodies.decay,
        &state.bodies.kick,
        &state.bodies.push,
        &state.bodies[Parameter::Speed],
        &state.bodies[Parameter::Radius],
        &state.bodies[Parameter::Mass],
        &state.bodies[Parameter::Tau],
        &state.bodies[Parameter::A],
        &state.bodies[Parameter::B],
        &state.bodies[Parameter::Lambda],
        &state.bodies[Parameter::A2],
        &state.bodies[Parameter::B2],
        &state.bodies[Parameter::Lambda2],
        &state.bodies[Parameter::K1],
        &state.bodies[Parameter::K2],
        &state.bodies[Parameter::Noise],
    ];
    let mut bits = vec![state.ticks[lane], u64::from(state.diverged.has(lane))];
    for agent in 0..state.agents {
        let slot = state.slot(agent, lane);
        bits.push(u64::from(state.present[slot.block].has(slot.lane)));
    }
    for field in fields {
        for agent in 0..state.agents {
            let slot = state.slot(agent, lane);
            bits.push(field[slot.block].0[slot.lane].to_bits());
        }
    }
    bits
}

/// Numbers in (0, 1) for scenes, splitmix64.
pub(crate) struct Numbers(pub u64);

impl Numbers {
    pub(crate) fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.word() >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// Two streams on a jittered lattice in a box with walls.
pub(crate) fn streams(n: usize, wide: f64, high: f64, jitter: f64, dt: &'static str) -> Crowd {
    let mut rng = Numbers(n as u64);
    let columns = (n as f64 * wide / high).sqrt().round().max(1.0);
    let rows = (n as f64 / columns).ceil();
    let people = (0..n).map(|k| {
        let (i, j) = ((k as f64) % columns, ((k as f64) / columns).floor());
        let at = p(
            0.3 + (wide - 0.6) * (i + 0.5 + jitter * rng.between(-0.5, 0.5)) / columns,
            0.3 + (high - 0.6) * (j + 0.5 + jitter * rng.between(-0.5, 0.5)) / rows,
        );
        let ahead = if rng.word() & 1 == 1 { 1.0 } else { -1.0 };
        let drive = rng.between(1.1, 1.6);
        Person { drive, towards: p(ahead, 0.0), velocity: p(ahead * drive, 0.0), ..person(at) }
    });
    let mut crowd = crowd(people.collect(), dt);
    let corners = [p(0.0, 0.0), p(wide, 0.0), p(wide, high), p(0.0, high)];
    crowd.obstacles = (0..4).map(|k| wall(corners[k], corners[(k + 1) % 4])).collect();
    crowd
}
