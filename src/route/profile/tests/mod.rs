//! Profiles against reference values, a dense integration, and the limits themselves.

mod algorithm;
mod fastest;
mod shape;
mod variety;
