//! Pages of E02xx: names, kinds and calls.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
