//! Statistical model checking of people in motion: scenarios, bounded temporal logic, and verdicts with
//! the guarantee they can honestly give.
//!
//! The floors, low to high, are described in `ARCHITECTURE.md` and held by `tests/floors.rs`.
//!
//! ```
//! use smc::compile::{Files, Input, compile};
//! use smc::engine::outcome::Verdict;
//! use smc::engine::{Budget, Call, Nobody, Threads, run};
//! use smc::syntax::parse::{parse_properties, parse_scenario};
//! use smc::syntax::source::{Source, SourceId};
//!
//! let scenario = Source::new(SourceId(0), "walk.scn", "
//!     horizon = 5 s
//!     step = 0.02 s
//!     kind adult: sfm preset helbing2000 { noise = 0.1 m/s }
//!     agent user: adult { at = (0, 0)  route = (20, 0) }
//! ");
//! let property = Source::new(SourceId(1), "walk.bltl", "check P(F<=5 s (travelled(user) > 4 m)) >= 0.9");
//! let (model, found) = parse_scenario(&scenario);
//! let (questions, more) = parse_properties(&property);
//! assert!(found.is_empty() && more.is_empty());
//!
//! let input = Input {
//!     sources: &[scenario.clone(), property.clone()],
//!     scenario: &model,
//!     properties: &[questions],
//!     files: &Files::default(),
//!     settings: &[],
//! };
//! let (study, diagnostics) = compile(&input);
//! assert!(diagnostics.is_empty());
//!
//! let call = Call {
//!     seed: 0,
//!     command: "smc check walk.scn walk.bltl".into(),
//!     point: String::new(),
//!     simulate: "smc simulate walk.scn".into(),
//!     only: vec![],
//!     place: &|span| (property.name.clone(), property.line_column(span.start).0),
//!     drivers: &smc::kernel::driver::straight,
//!     file: "walk.scn".into(),
//! };
//! let threads = Threads::new(Some(1)).unwrap();
//! let outcome = run(&study.unwrap(), &call, &threads, &Budget::new(10_000, None), &Nobody).unwrap();
//! assert_eq!(outcome.results[0].verdict, Some(Verdict::Satisfied));
//! ```

pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compile;
pub mod data;
pub mod engine;
pub mod kernel;
pub mod logic;
pub mod model;
pub mod report;
pub mod stats;
pub mod syntax;
