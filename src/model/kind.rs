//! Kinds of agents: how an agent moves. Which parameters a kind has stands in the table of parameters.

/// A kind of agents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// A body of the social force model that a route drives.
    #[default]
    Sfm,
    /// The same, driven along a path and at speeds that it has planned (Li, Li, Ge 2019).
    Planned,
    /// Somebody who goes step by step by themselves: no force moves them (Agethen et al. 2018).
    Stepped,
    /// Somebody whose velocity follows from where others are: the collision-free speed model (Tordeux, Chraibi, Seyfried
    /// 2016), in the second version of `JuPedSim`.
    Cfs,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Sfm, Self::Planned, Self::Stepped, Self::Cfs];

    /// Its name in a scenario, from which declared kinds start.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sfm => "sfm",
            Self::Planned => "planned",
            Self::Stepped => "stepped",
            Self::Cfs => "cfs",
        }
    }

    /// What it is, for messages.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Sfm => "the social force model",
            Self::Planned => "walkers that plan",
            Self::Stepped => "walkers that step",
            Self::Cfs => "the collision-free speed model",
        }
    }

    /// Those that forces move.
    pub const FORCED: [Self; 2] = [Self::Sfm, Self::Planned];

    /// Those whose velocities have noise.
    pub const NOISY: [Self; 3] = [Self::Sfm, Self::Planned, Self::Cfs];

    /// The kind of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}
