//! `.gait` files: JSON with `format`, `version`, `hash` (FNV-1a of the compact text of `model`) and `model`. Numbers are written with as
//! many digits as they need, so that a model that was read draws the same bytes as the one that was written.

use super::LearnedGait;
use crate::base::fingerprint::Fingerprint;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The value of `format`.
pub const FORMAT: &str = "smc gait";
/// The value of `version`.
pub const VERSION: u32 = 1;

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
    /// Lists of the model do not fit together.
    #[error("the model contradicts itself: its lists do not fit together")]
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
        if model.fits() { Ok(model) } else { Err(FileError::Inconsistent) }
    }
}
