//! The program from the outside: exit codes, formats, inputs of every kind, interruption, traces.

mod advise;
mod budgets;
mod calibrate;
mod calls;
mod errors;
mod escapes;
mod fit;
mod forecasts;
pub(crate) mod formats;
mod gait;
mod infer;
mod inputs;
mod limits;
mod outputs;
mod paths;
mod plot;
mod reasons;
mod replay;
mod shards;
mod traces;
mod walk;
mod walks;
mod witnesses;
mod words;
