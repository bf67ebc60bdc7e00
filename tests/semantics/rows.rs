//! One test for each row of the table in `docs/semantics.md`.
