//! All tests of the crate from outside, in one program: building it once is most of what a small change costs.
#![allow(clippy::case_sensitive_file_extension_comparisons, reason = "names are given in lower case")]
#![allow(
    clippy::disallowed_methods,
    reason = "tests read files, call programs and use the platform's functions"
)]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a test says what was poor or skipped")]

mod ahead;
mod aims;
mod buildings;
mod certificates;
mod chance;
mod circles;
mod claims;
mod cli;
mod codes;
mod compile;
mod cookbook;
mod crowd;
mod determinism;
mod diagnostics;
mod doors;
mod drift;
mod drive;
mod drivers;
mod dynamics;
mod editor;
mod every;
mod expressions;
mod floors;
mod forces;
mod formatter;
mod gait_measured;
mod gallery;
mod intention;
mod jumps;
mod lanes;
mod language;
mod levels;
mod library;
mod machines;
mod measure;
mod measures;
mod mistakes;
mod mocap;
mod mutants;
mod mutation;
mod nesting;
mod objects;
mod outcomes;
mod pages;
mod papers;
mod perception;
mod periodic;
mod planned;
mod plans;
mod processes;
mod program;
mod programs;
mod queries;
mod rankings;
mod refusals;
mod replay;
mod reports;
mod robustness;
mod runs;
mod seen;
mod semantics;
mod shapes;
mod shards;
mod signal_semantics;
mod speeds;
mod splitting;
mod start;
mod statistics;
mod stepped;
mod storeys;
mod tables;
mod texts;
mod tracks;
mod verdicts;
mod walls;
mod ways;
