//! Columns of tables and what is in them.

use std::borrow::Cow;

/// What the values of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers in a unit, as `m/s`; the unit is empty where they have none.
    Number(&'static str),
    /// Whole numbers.
    Whole,
    /// Words.
    Word,
    /// Truth values.
    Truth,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name, which no other column has.
    pub name: String,
    /// What its values are.
    pub kind: Kind,
}

impl Column {
    /// A column of a name.
    pub fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind }
    }

    /// The unit of its numbers; empty where they have none.
    pub const fn unit(&self) -> &'static str {
        match self.kind {
            Kind::Number(unit) => unit,
            Kind::Whole | Kind::Word | Kind::Truth => "",
        }
    }
}

/// A value in a row. It is of the kind of its column or missing.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'a> {
    /// A number, perhaps infinite; NaN is missing.
    Number(f64),
    /// A whole number.
    Whole(i64),
    /// A word.
    Word(Cow<'a, str>),
    /// A truth value.
    Truth(bool),
    /// Nothing, as the position of an agent that is absent.
    Missing,
}

impl Value<'_> {
    /// Whether it can stand in a column of this kind.
    pub(super) fn fits(&self, kind: Kind) -> bool {
        match self {
            Self::Number(_) => matches!(kind, Kind::Number(_)),
            Self::Whole(_) => kind == Kind::Whole,
            Self::Word(_) => kind == Kind::Word,
            Self::Truth(_) => kind == Kind::Truth,
            Self::Missing => true,
        }
    }
}
