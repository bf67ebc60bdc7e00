//! Pages of E03xx: units and dimensions.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
