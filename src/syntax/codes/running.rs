//! Pages of E08xx: what happens while trials run.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[Page {
    code: "E0801",
    title: "people cannot be placed",
    text: "\
People who start in the same shape need more room than its free area gives; obstacles count, and bodies that are thrown and\n\
then pushed apart jam at about 84 % of an area. This is said before the first trial.\n\
\n\
Wrong:\n\
\x20   region hall: rect (0, 0) .. (10, 4)\n\
\x20   agents crowd[400]: adult { at = uniform in hall }\n\
Right:\n\
\x20   agents crowd[40]: adult { at = uniform in hall }",
}];
