//! Pages of E07xx: files and their contents.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
