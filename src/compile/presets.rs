//! Named parameter sets of the social force model, with their sources.

use crate::model::{Family, Law, Parameter};

/// A named parameter set.
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Where it comes from, and how it was read.
    pub source: &'static str,
}

/// All presets.
pub const PRESETS: [Preset; 3] = [
    Preset {
        name: "helbing2000",
        source: "Helbing, Farkas, Vicsek, Nature 407, 487 (2000): isotropic, A = 2000 N, B = 0.08 m, \
                 k1 = 1.2e5 kg/s^2, k2 = 2.4e5 kg/(m s), tau = 0.5 s, 80 kg, diameters 0.5 to 0.7 m; driving speeds \
                 N(1.34, 0.26) m/s of Helbing and Molnár 1995",
    },
    Preset {
        name: "johansson2007",
        source: "Johansson, Helbing, Shukla, Adv. Complex Syst. 10, 271 (2007), circular specification: \
                 A = 0.42 m/s^2 (33.6 N at 80 kg), B = 1.65 m, lambda = 0.12; bodies and contact of helbing2000",
    },
    Preset {
        name: "vissim2008",
        source: "Kretz, Hengst, Vortisch, arXiv 0805.1788 (2008): A = 0.5 m/s^2 (40 N), B = 2.8 m, lambda = 0.1 and an \
                 isotropic second term of 25 m/s^2 (2000 N), B2 = 0.2 m, tau = 0.4 s; without its velocity term and \
                 its limit of neighbours; bodies and contact of helbing2000",
    },
];

/// The law that a preset gives a parameter; `None` for an unknown preset or a parameter that it leaves open.
pub fn law(preset: &str, parameter: Parameter) -> Option<Law> {
    use Parameter::{A, A2, B, B2, K1, K2, Lambda, Mass, Radius, Speed, Tau};
    let special: &[(Parameter, f64)] = match preset {
        "helbing2000" => &[(A, 2000.0), (B, 0.08), (Tau, 0.5)],
        "johansson2007" => &[(A, 33.6), (B, 1.65), (Lambda, 0.12), (Tau, 0.5)],
        "vissim2008" => &[(A, 40.0), (B, 2.8), (Lambda, 0.1), (A2, 2000.0), (B2, 0.2), (Tau, 0.4)],
        _ => return None,
    };
    if let Some((_, value)) = special.iter().find(|(one, _)| *one == parameter) {
        return Some(Law::Constant(*value));
    }
    match parameter {
        Mass => Some(Law::Constant(80.0)),
        Radius => Some(Law::Random {
            family: Family::Uniform { low: 0.25, high: 0.35 },
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        }),
        Speed => Some(Law::Random { family: Family::Normal { mean: 1.34, sd: 0.26 }, low: 0.4, high: 2.2 }),
        K1 => Some(Law::Constant(1.2e5)),
        K2 => Some(Law::Constant(2.4e5)),
        other => other.description().default.filter(|_| other.description().preset).map(Law::Constant),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kind;

    #[test]
    fn every_preset_gives_every_parameter_that_has_no_default() {
        for preset in &PRESETS {
            for parameter in Parameter::of_kind(Kind::Sfm) {
                let given =
                    parameter.description().default.is_some() || law(preset.name, parameter).is_some();
                assert!(given, "{} {}", preset.name, parameter.name());
            }
        }
        assert!(law("unknown", Parameter::Mass).is_none());
    }
}
