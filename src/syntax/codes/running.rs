//! Pages of E08xx: what happens while trials run.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
