//! The parameters of an agent that moves by the social force model.

/// A parameter of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// Mass, kg.
    Mass,
    /// Radius of the disc, m.
    Radius,
    /// Driving speed, m/s.
    Speed,
    /// Relaxation time, s.
    Tau,
    /// Social force at touch, N.
    A,
    /// Its range, m.
    B,
    /// Weight of what is behind.
    Lambda,
    /// Second exponential term: force at touch, N.
    A2,
    /// Second exponential term: range, m.
    B2,
    /// Second exponential term: weight of what is behind.
    Lambda2,
    /// Body compression, kg/s^2.
    K1,
    /// Sliding friction, kg/(m s).
    K2,
    /// Standard deviation of each velocity component, m/s.
    Noise,
    /// Share of the social force that is felt, 0 to 1.
    Attention,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Mass,
        Self::Radius,
        Self::Speed,
        Self::Tau,
        Self::A,
        Self::B,
        Self::Lambda,
        Self::A2,
        Self::B2,
        Self::Lambda2,
        Self::K1,
        Self::K2,
        Self::Noise,
        Self::Attention,
    ];

    /// Its name in a scenario.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mass => "mass",
            Self::Radius => "radius",
            Self::Speed => "speed",
            Self::Tau => "tau",
            Self::A => "A",
            Self::B => "B",
            Self::Lambda => "lambda",
            Self::A2 => "A2",
            Self::B2 => "B2",
            Self::Lambda2 => "lambda2",
            Self::K1 => "k1",
            Self::K2 => "k2",
            Self::Noise => "noise",
            Self::Attention => "attention",
        }
    }

    /// The parameters that a state of a behaviour may change.
    pub fn changeable() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|parameter| parameter.may_change())
    }

    /// The parameter of this name that a state of a behaviour may change.
    pub fn changeable_of(name: &str) -> Option<Self> {
        Self::changeable().find(|parameter| parameter.name() == name)
    }

    /// Whether a state of a behaviour may change it.
    pub const fn may_change(self) -> bool {
        !matches!(self, Self::Mass | Self::Radius | Self::K1 | Self::K2)
    }

    /// Whether someone can move with this value, SI units.
    pub fn allows(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Mass | Self::Tau | Self::B | Self::B2 => value > 0.0,
                Self::Lambda | Self::Lambda2 | Self::Attention => (0.0..=1.0).contains(&value),
                Self::Radius | Self::Speed | Self::A | Self::A2 | Self::K1 | Self::K2 | Self::Noise => {
                    value >= 0.0
                }
            }
    }
}
