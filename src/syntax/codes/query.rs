//! Pages of E06xx: queries and procedures.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[];
