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
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Sfm, Self::Planned, Self::Stepped];

    /// Its name in a scenario, from which declared kinds start.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sfm => "sfm",
            Self::Planned => "planned",
            Self::Stepped => "stepped",
        }
    }

    /// What it is, for messages.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Sfm => "the social force model",
            Self::Planned => "walkers that plan",
            Self::Stepped => "walkers that step",
        }
    }

    /// Those that forces move.
    pub const FORCED: [Self; 2] = [Self::Sfm, Self::Planned];

    /// The kind of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}
