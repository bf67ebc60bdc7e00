//! Plane geometry from `GeoJSON` (RFC 7946) and WKT (OGC 06-103r4), as one list of plain features.
//!
//! Coordinates are metres in the plane of the scene, whatever a file says of its reference system; a third
//! coordinate is dropped. Geometries of several parts become several features of one name.

pub mod feature;
pub mod geojson;
pub mod ring;
pub mod snap;
pub mod wkt;

pub use feature::{Feature, Geometry, GeometryError, PropertyValue, Select};
pub use geojson::{read_geojson, select_geojson};
pub use snap::{Slips, slips, snap};
pub use wkt::read_wkt;
