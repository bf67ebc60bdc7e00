//! Pages of E04xx: scenes, agents and recordings.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
