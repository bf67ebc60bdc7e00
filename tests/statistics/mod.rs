//! Calibration of the statistical procedures against exact targets: the tests T1 to T26 of the reference
//! measurements, with the negative controls that must fail.
//!
//! Each check takes its number of replications. A part with few of them runs always; the full numbers are
//! behind `--ignored` (`cargo test --release --test suite statistics:: -- --ignored`).

mod arrival;
mod bayes;
mod drift;
mod estimators;
mod exhaustive;
mod metrics;
mod ranking;
mod splitting;
mod tally;
mod tests_of_p;
