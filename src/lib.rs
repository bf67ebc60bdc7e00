//! Statistical model checking of people in motion: scenarios, bounded temporal logic, and verdicts with
//! stated guarantees.
//!
//! `ARCHITECTURE.md` describes the floors of modules, and `tests/floors.rs` checks them.
//!
//! ```
//! use smc::engine::outcome::{Certified, Verdict};
//! use smc::stats::Claim;
//! use smc::{Model, Options};
//!
//! let model = Model::parse("
//!     horizon = 5 s
//!     step = 0.02 s
//!     kind adult: sfm preset smc1 { noise = 0.1 m/s }
//!     agent user: adult { at = (0, 0); route = (20, 0) }
//! ")?;
//! let queries = "check P(F<=5 s (travelled(user) > 4 m)) >= 0.9";
//! let report = model.check(queries, &Options::default().seed(1).max_trials(10_000))?;
//! let result = &report.results()[0];
//! assert_eq!(result.verdict, Some(Verdict::Satisfied));
//! let certificate = result.certificate.as_ref().unwrap();
//! assert_eq!(certificate.claim, Certified::Decided(Claim::AtLeast(0.9)));
//! assert!(certificate.error <= 0.01);
//!
//! // The first trial that the check has read, state by state.
//! let last = model.trial(1, 0)?.last().unwrap();
//! assert!(last.agent("user").unwrap().position.x > 4.0);
//! # Ok::<(), smc::Diagnostics>(())
//! ```
//!
//! [`Draft`] sets parameters and gives files. `examples/` has programs that sweep a parameter, write trajectories, and
//! drive agents by rules of their own. The modules below are for those who need more; their items may change.

// First, since its macro `error!` is used above.
#[macro_use]
pub mod syntax;

pub mod advise;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compile;
pub mod engine;
pub mod library;
pub mod perception;
pub mod replay;
pub mod report;

pub use smc_core::{base, data, gait, kernel, logic, model, route, stats, trials};

pub use library::{AgentState, Diagnostics, Draft, Model, Options, Report, Snapshot, Trial};
