//! `.gait` files: JSON with `format`, `version`, `hash` (FNV-1a of the compact text of `model`) and `model`. Numbers are written with as
//! many digits as they need, so that a model that was read draws the same bytes as the one that was written.

use super::{LARGEST, LearnedGait};
use crate::base::fingerprint::Fingerprint;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

/// The value of `format`.
pub const FORMAT: &str = "smc gait";
/// The value of `version`.
pub const VERSION: u32 = 1;

/// The hint for a file that gives no model.
pub const FIT_AGAIN: &str = "make the file again: `smc gait fit DATA -o FILE.gait`";

/// Why a file gives no model.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileError {
    /// No JSON, or not that of a model.
    #[error("not a complete `.gait` file: {0}")]
    Malformed(String),
    /// Something else.
    #[error("`format` must be \"{FORMAT}\" (got \"{0}\")")]
    Format(String),
    /// Of another version.
    #[error("version {VERSION} of the format is needed (got {0}); fit the model again")]
    Version(u32),
    /// It was changed.
    #[error(
        "the content does not match its `hash` (wanted {wanted}, got {found}): the file was changed or is damaged"
    )]
    Hash {
        /// In the file.
        wanted: String,
        /// Of the content.
        found: String,
    },
    /// Lists of the model do not fit together, or numbers have no sense.
    #[error("the model contradicts itself: lists do not fit together, or a number is out of its range")]
    Inconsistent,
}

#[derive(Deserialize)]
struct Head {
    format: String,
    version: u32,
    hash: String,
}

#[derive(Deserialize)]
struct Body {
    model: LearnedGait,
}

#[derive(Serialize)]
struct File<'a> {
    format: &'a str,
    version: u32,
    hash: String,
    model: &'a LearnedGait,
}

impl LearnedGait {
    fn hash(&self) -> Result<String, serde_json::Error> {
        Ok(Fingerprint::of(&serde_json::to_vec(self)?).to_string())
    }

    /// The text of a file.
    pub fn to_json(&self) -> Result<String, FileError> {
        let malformed = |e: serde_json::Error| FileError::Malformed(e.to_string());
        let hash = self.hash().map_err(malformed)?;
        let file = File { format: FORMAT, version: VERSION, hash, model: self };
        serde_json::to_string(&file).map(|text| text + "\n").map_err(malformed)
    }

    /// The model of the bytes of a file.
    pub fn read(bytes: &[u8]) -> Result<Self, FileError> {
        Self::from_json(String::from_utf8_lossy(bytes).trim_start_matches('\u{feff}'))
    }

    /// The model of a file's text.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        let malformed = |e: serde_json::Error| FileError::Malformed(e.to_string());
        let head: Head = serde_json::from_str(text).map_err(malformed)?;
        if head.format != FORMAT {
            return Err(FileError::Format(head.format));
        }
        if head.version != VERSION {
            return Err(FileError::Version(head.version));
        }
        let Body { model } = serde_json::from_str(text).map_err(malformed)?;
        let found = model.hash().map_err(malformed)?;
        if found != head.hash {
            return Err(FileError::Hash { wanted: head.hash, found });
        }
        let numbers = serde_json::to_value(&model).map_err(malformed)?;
        if model.fits() && largest(&numbers) <= LARGEST { Ok(model) } else { Err(FileError::Inconsistent) }
    }
}

/// The largest of all numbers, without their signs.
fn largest(value: &Value) -> f64 {
    match value {
        Value::Number(number) => number.as_f64().map_or(f64::INFINITY, f64::abs),
        Value::Array(list) => list.iter().map(largest).fold(0.0, f64::max),
        Value::Object(members) => members.values().map(largest).fold(0.0, f64::max),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Residuals, made};
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::gait::{Draws, Foot, Gait, Stance};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn bits(model: LearnedGait) -> Vec<u64> {
        let stream = Stream::of(TrialKey::default(), 4, Purpose::Test);
        let person = Arc::new(model).person(&[0.4; LearnedGait::NORMALS]);
        let (mut stance, mut foot) = (Stance::default(), Foot::Right);
        let mut bits = Vec::new();
        for k in 0..40 {
            stance = person.step(&stance, foot, 1.1, Draws::of(stream, k, k % 3));
            foot = foot.other();
            let shape = stance.last.unwrap().1;
            bits.extend(shape.landmarks.iter().flat_map(|p| [p.x.to_bits(), p.y.to_bits()]));
            bits.push(shape.duration.to_bits());
        }
        bits
    }

    #[test]
    fn a_model_that_was_read_draws_the_same_bytes() {
        for residuals in [Residuals::Nearest, Residuals::Gaussian] {
            let options = super::super::Options { residuals, ..Default::default() };
            let (model, _) = super::super::fit(&made::steps(12, 12), &options).unwrap();
            let text = model.to_json().unwrap();
            let read = LearnedGait::from_json(&text).unwrap();
            assert_eq!(read.to_json().unwrap(), text);
            assert_eq!(bits(read), bits(model));
        }
    }

    #[test]
    fn other_formats_and_versions_are_named() {
        let text = made::small().to_json().unwrap();
        let other = text.replacen("\"version\":1", "\"version\":2", 1);
        assert_eq!(LearnedGait::from_json(&other).unwrap_err(), FileError::Version(2));
        let other = text.replacen(FORMAT, "gpx", 1);
        assert_eq!(LearnedGait::from_json(&other).unwrap_err(), FileError::Format("gpx".into()));
        let changed = text.replacen("0.5", "0.25", 1);
        assert!(matches!(LearnedGait::from_json(&changed), Err(FileError::Hash { .. })));
    }

    /// The places of all values of a text below its model.
    fn paths(value: &Value, at: &str, all: &mut Vec<String>) {
        all.push(at.to_owned());
        match value {
            Value::Array(list) => {
                list.iter().enumerate().for_each(|(k, v)| paths(v, &format!("{at}/{k}"), all));
            }
            Value::Object(map) => map.iter().for_each(|(k, v)| paths(v, &format!("{at}/{k}"), all)),
            _ => (),
        }
    }

    proptest! {
        #[test]
        fn damaged_files_are_errors(cut in 0.0f64..1.0, flip in 0.0f64..1.0, to in 32u8..127) {
            let text = made::small().to_json().unwrap();
            prop_assert!(LearnedGait::from_json(&text[..(cut * (text.len() - 2) as f64) as usize]).is_err());
            let mut bytes = text.clone().into_bytes();
            let at = (flip * bytes.len() as f64) as usize;
            bytes[at] = to;
            if let Ok(read) = LearnedGait::from_json(std::str::from_utf8(&bytes).unwrap()) {
                prop_assert_eq!(bits(read), bits(made::small()));
            }
        }

        #[test]
        fn what_has_a_right_hash_can_be_drawn_from_or_is_an_error(at in 0.0f64..1.0, new in prop::sample::select(
            vec!["null", "0", "-1", "1e-300", "1e300", "1e12", "[]", "[1.0]", "{}", "\"x\""],
        )) {
            let mut file: Value = serde_json::from_str(&made::small().to_json().unwrap()).unwrap();
            let mut all = Vec::new();
            paths(&file["model"], "/model", &mut all);
            let path = &all[(at * all.len() as f64) as usize];
            *file.pointer_mut(path).unwrap() = serde_json::from_str(new).unwrap();
            file["hash"] = Fingerprint::of(file["model"].to_string().as_bytes()).to_string().into();
            if let Ok(read) = LearnedGait::from_json(&file.to_string()) {
                let scores = super::super::score(&read, &made::steps(2, 4));
                prop_assert!(scores.nlpd.is_finite() && scores.crps.is_finite(), "{path} {new} {scores:?}");
                prop_assert_eq!(bits(read).len(), 440);
            }
        }
    }
}
