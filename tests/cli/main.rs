//! The program from the outside: exit codes, formats, inputs of every kind, interruption, traces.

#![allow(clippy::disallowed_methods, reason = "tests read and write files and call the program")]

mod budgets;
mod calls;
mod errors;
mod escapes;
mod forecasts;
mod formats;
mod inputs;
mod limits;
mod outputs;
mod program;
mod ranks;
mod reasons;
mod traces;
mod witnesses;
