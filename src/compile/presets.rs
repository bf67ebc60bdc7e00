//! Named parameter sets of models of people, with their sources.

use crate::model::{Family, Kind, Law, Parameter};

/// A named parameter set.
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// The model whose numbers they are.
    pub model: Kind,
    /// Where it comes from, and how it was read.
    pub source: &'static str,
}

/// All presets.
pub static PRESETS: [Preset; 4] = [
    Preset {
        name: "helbing2000",
        model: Kind::Sfm,
        source: "Helbing, Farkas, Vicsek, Nature 407, 487 (2000): isotropic, A = 2000 N, B = 0.08 m, \
                 k1 = 1.2e5 kg/s^2, k2 = 2.4e5 kg/(m s), tau = 0.5 s, 80 kg, diameters 0.5 to 0.7 m; driving speeds \
                 N(1.34, 0.26) m/s of Helbing and Molnár 1995",
    },
    Preset {
        name: "smc1",
        model: Kind::Sfm,
        source: "this project's own, fitted in this order to Weidmann's fundamental diagram of one stream, to flows at doors \
                 of 0.8 to 2.4 m, to the clearance of head-on pairs in the recording eth, and to counterflow: \
                 isotropic, A = 140 N, B = 0.35 m, foresight 1.5 s, headway 0.65 s, tau = 0.25 s, radii 0.18 to 0.22 m; \
                 mass, driving speeds and contact of helbing2000",
    },
    Preset {
        name: "smc2",
        model: Kind::Sfm,
        source: "this project's own, fitted to exits of 0.7 to 1.2 m, to streams and to counterflow as they were measured in the \
                 HERMES experiments, and to head-on pairs: isotropic, A = 190 N, B = 0.24 m, foresight 1.7 s, headway 0.98 s \
                 with a berth of 0.05 m and follow 0.42, tau = 0.28 s, radii 0.142 to 0.182 m, oncoming 0.33, keep_right \
                 0.06 m, composure 1, walls 1.5, abreast 0.7 m, aside 0.2 m; mass, driving speeds and contact of helbing2000",
    },
    Preset {
        name: "cfs2",
        model: Kind::Cfs,
        source: "the defaults of the collision-free speed model, version 2, in JuPedSim 1.4.2 (after Tordeux, Chraibi, \
                 Seyfried 2016): time gap 1 s, radius 0.2 m, neighbours 8 and 0.1 m, walls 5 and 0.02 m; mass and driving \
                 speeds of helbing2000",
    },
];

/// The law that a preset gives a parameter; `None` for an unknown preset or a parameter that it leaves open.
pub fn law(preset: &str, parameter: Parameter) -> Option<Law> {
    use Parameter::{
        A, Abreast, Aside, B, Berth, Composure, Follow, Foresight, Headway, K1, K2, KeepRight, Mass,
        Oncoming, Radius, Speed, Tau, Walls,
    };
    let (radii, special): ((f64, f64), &[(Parameter, f64)]) = match preset {
        "smc1" => ((0.18, 0.22), &[(A, 140.0), (B, 0.35), (Foresight, 1.5), (Headway, 0.65), (Tau, 0.25)]),
        "smc2" => (
            (0.142, 0.182),
            &[
                (A, 190.0),
                (B, 0.24),
                (Foresight, 1.7),
                (Headway, 0.98),
                (Berth, 0.05),
                (Follow, 0.42),
                (Tau, 0.28),
                (Oncoming, 0.33),
                (KeepRight, 0.06),
                (Composure, 1.0),
                (Walls, 1.5),
                (Abreast, 0.7),
                (Aside, 0.2),
            ],
        ),
        "cfs2" => ((0.2, 0.2), &[(Radius, 0.2)]),
        "helbing2000" => ((0.25, 0.35), &[(A, 2000.0), (B, 0.08), (Tau, 0.5)]),
        _ => return None,
    };
    if let Some((_, value)) = special.iter().find(|(one, _)| *one == parameter) {
        return Some(Law::Constant(*value));
    }
    match parameter {
        Mass => Some(Law::Constant(80.0)),
        Radius => Some(Law::Random {
            family: Family::Uniform { low: radii.0, high: radii.1 },
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

    #[test]
    fn every_preset_gives_every_parameter_that_has_no_default() {
        for preset in &PRESETS {
            for parameter in Parameter::of_kind(preset.model) {
                let given =
                    parameter.description().default.is_some() || law(preset.name, parameter).is_some();
                assert!(given, "{} {}", preset.name, parameter.name());
            }
        }
        assert!(law("unknown", Parameter::Mass).is_none());
    }
}
