//! The codes of what the parser reports, by name.

use crate::syntax::codes::Code;

/// Something else should stand here.
pub(super) const UNEXPECTED: Code = Code::E0101;
/// A bracket or block is not closed.
pub(super) const UNCLOSED: Code = Code::E0102;
/// A bracket closes nothing.
pub(super) const STRAY: Code = Code::E0103;
/// A comment never ends.
pub(super) const COMMENT: Code = Code::E0104;
/// A quoted text does not end on its line.
pub(super) const TEXT: Code = Code::E0105;
/// Nesting is too deep.
pub(super) const TOO_DEEP: Code = Code::E0106;
/// The file cannot be read as text.
pub(super) const ENCODING: Code = Code::E0107;
/// The file is empty.
pub(super) const EMPTY: Code = Code::E0108;
/// Comparisons do not chain.
pub(super) const CHAIN: Code = Code::E0109;
/// A number does not fit.
pub(super) const NUMBER: Code = Code::E0110;
/// A clause stands twice.
pub(super) const TWICE: Code = Code::E0111;
/// `=` and `==` are different.
pub(super) const EQUALS: Code = Code::E0112;
/// Unknown unit.
pub(super) const UNIT: Code = Code::E0113;
/// An operator of another language.
pub(super) const OPERATOR: Code = Code::E0114;
/// A bound took the name for its unit.
pub(super) const BOUND_TOOK_NAME: Code = Code::E0115;
/// A branch has no weight.
pub(super) const WEIGHT: Code = Code::E0116;
/// Unknown escape.
pub(super) const ESCAPE: Code = Code::E0117;
/// A field in the wrong place.
pub(super) const FIELD_PLACE: Code = Code::E0118;
/// A bound is written with `<=`.
pub(super) const BOUND: Code = Code::E0119;
/// An expression joins too many parts.
pub(super) const TOO_LONG: Code = Code::E0120;
/// A character that is not used.
pub(super) const CHARACTER: Code = Code::E0121;
/// This function does not fold over a set.
pub(super) const NO_FOLD: Code = Code::E0122;
/// Several levels of a quantile where one fits.
pub(super) const SEVERAL_LEVELS: Code = Code::E0124;
/// The syntax of another language.
pub(super) const FOREIGN: Code = Code::E0130;
/// A temporal operator binds tighter than `=>`.
pub(super) const OPEN_IMPLICATION: Code = Code::W0101;
/// A power of a whole quantity.
pub(super) const POWER_OF_QUANTITY: Code = Code::W0102;
/// A name equals a unit.
pub(super) const NAME_IS_UNIT: Code = Code::W0103;
