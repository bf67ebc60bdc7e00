//! What an adviser says after a batch of observations.

use crate::base::geometry::Vec2;

/// Advice of one cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Advice {
    /// Number of the cycle, from 0.
    pub cycle: u64,
    /// Time of the batch, s.
    pub time: f64,
    /// What it comes to.
    pub status: Status,
    /// Name of the advised move.
    pub chosen: Option<String>,
    /// Where the user is shown to go, a unit vector; `None` for a stop.
    pub direction: Option<Vec2>,
    /// How fast, m/s.
    pub speed: Option<f64>,
    /// Probability that the property holds with the move, with its interval.
    pub probability: Option<[f64; 3]>,
    /// The move is at most so much worse than the best.
    pub gap: Option<f64>,
    /// Whether that is certified as wanted.
    pub certified: bool,
    /// Trials of all options.
    pub trials: u64,
    /// All options, best first.
    pub options: Vec<OptionSeen>,
    /// The user, unless lost.
    pub user: Option<UserSeen>,
    /// Groups of those who are taken into account.
    pub groups: Vec<GroupSeen>,
    /// How many people are taken into account.
    pub people: usize,
    /// Whether the user has moved as advised since the last cycle: within 20° and 0.3 m/s.
    pub followed: Option<bool>,
    /// What was left out or is doubtful.
    pub notes: Vec<String>,
}

/// What a cycle comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// A move is advised.
    Advice,
    /// No trial of any option succeeded: the user should stop.
    Stop,
    /// The user has been unseen for longer than the longest projection.
    #[default]
    Lost,
    /// No sensor has seen anybody for as long.
    Blind,
    /// No trial was finished in time.
    Late,
}

impl Status {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Advice => "advice",
            Self::Stop => "stop",
            Self::Lost => "lost",
            Self::Blind => "blind",
            Self::Late => "late",
        }
    }
}

/// An option of the ranking.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionSeen {
    /// Name of the move.
    pub label: String,
    /// Estimate and ends of its interval.
    pub probability: [f64; 3],
    /// What is known of it.
    pub status: &'static str,
}

/// The user as seen.
#[derive(Clone, Debug, PartialEq)]
pub struct UserSeen {
    /// Who it is.
    pub id: u32,
    /// Number of the trace.
    pub trace: u64,
    /// Number of the group.
    pub group: u64,
    /// How many are in the group, the user included.
    pub members: usize,
    /// Position, m.
    pub position: Vec2,
    /// Where in the group.
    pub place: Place,
    /// Direction to the middle of the group, for who is on its fringe.
    pub rejoin: Option<Vec2>,
}

/// Where in a group somebody is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Farther from its middle than (n - 1)/2 m.
    Fringe,
    /// Nearer.
    Inside,
}

impl Place {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fringe => "fringe",
            Self::Inside => "inside",
        }
    }
}

/// A group.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupSeen {
    /// Its number, which it keeps over time.
    pub id: u64,
    /// Numbers of the traces of its members.
    pub traces: Vec<u64>,
    /// Mean position, m.
    pub position: Vec2,
    /// Mean velocity, m/s.
    pub velocity: Vec2,
}

/// What somebody did during a replay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walked {
    /// Least distance of the middles of this person and anybody else, m.
    pub least_distance: Option<f64>,
    /// Time, s.
    pub time: f64,
    /// Length of the way, m.
    pub length: f64,
}
