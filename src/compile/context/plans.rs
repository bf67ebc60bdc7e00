//! Floor plans that have a name: the rooms and doors of their files.

use crate::base::geometry::{Segment, Shape};

/// A part of a floor plan.
#[derive(Clone, Debug)]
pub(crate) enum PlanPart {
    /// A room, or anything else that has an area.
    Room(Shape),
    /// A door: the opening that it has made.
    Door(Segment),
}

/// Parts with their names, in the order of the file.
pub(crate) type NamedParts = Vec<(String, PlanPart)>;

/// A floor plan: `import "mall.geojson" as plan`.
#[derive(Clone, Debug)]
pub(crate) struct FloorPlan {
    /// Its name.
    pub(crate) name: String,
    /// Its parts; none if the file could not be read.
    pub(crate) parts: Option<NamedParts>,
}
