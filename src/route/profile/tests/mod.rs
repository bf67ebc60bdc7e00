//! Profiles against reference values, a dense integration, and the limits themselves.

#![allow(clippy::excessive_precision, reason = "reference values of 40-digit arithmetic")]

mod algorithm;
mod fastest;
mod shape;
mod variety;
