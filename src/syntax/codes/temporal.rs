//! Pages of E05xx: time, bounds and horizons.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
