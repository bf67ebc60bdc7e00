//! The registry of diagnostic codes: a page for each, for `smc explain`.
//!
//! `E01xx` syntax, `E02xx` names, `E03xx` units, `E04xx` scenes, `E05xx` time, `E06xx` queries, `E07xx` input,
//! `E08xx` while running, `E09xx` processes; `W01xx` lints of the surface. A code never changes its meaning.

mod input;
mod names;
mod process;
mod query;
mod running;
mod scene;
pub(super) mod syntax;
mod temporal;
mod units;

/// What there is to say about one code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page {
    /// Such as `E0101`.
    pub code: &'static str,
    /// One line.
    pub title: &'static str,
    /// A few sentences with a wrong and a right example.
    pub text: &'static str,
}

const ALL: [&[Page]; 9] = [
    syntax::PAGES,
    names::PAGES,
    units::PAGES,
    scene::PAGES,
    temporal::PAGES,
    query::PAGES,
    input::PAGES,
    process::PAGES,
    running::PAGES,
];

/// All pages, in the order of their codes within each range.
pub fn pages() -> impl Iterator<Item = &'static Page> {
    ALL.iter().flat_map(|pages| pages.iter())
}

/// The page of a code; upper and lower case are the same.
pub fn page(code: &str) -> Option<&'static Page> {
    pages().find(|page| page.code.eq_ignore_ascii_case(code.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique_and_pages_are_not_empty() {
        let mut codes: Vec<_> = pages().map(|page| page.code).collect();
        let count = codes.len();
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), count);
        assert!(pages().all(|page| !page.title.is_empty() && page.text.len() > 80));
        assert!(pages().all(|page| page.code.len() == 5));
    }

    #[test]
    fn a_page_is_found_by_its_code() {
        assert_eq!(page("e0101").map(|page| page.code), Some("E0101"));
        assert_eq!(page("E9999"), None);
    }
}
