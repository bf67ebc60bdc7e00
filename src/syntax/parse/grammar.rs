//! The grammars under `grammar/`, compiled by pest: one parser, one lexis, two languages.

#![allow(missing_docs, reason = "the rules are described in the grammar files")]

/// The parser that pest derives.
#[derive(pest_derive::Parser)]
#[grammar = "../grammar/common.pest"]
#[grammar = "../grammar/scenario.pest"]
#[grammar = "../grammar/property.pest"]
pub(in crate::syntax) struct Grammar;
