//! Plane geometry from `GeoJSON` (RFC 7946), OSM XML, WKT (OGC 06-103r4) and DXF, and what a floor plan makes of it.
//!
//! All formats take the same steps: a reader gives features and drops those that are not selected (`read`); their
//! coordinates become metres of the scene (`placement`); their roles make barriers and doors of them (`plan`);
//! walls that nearly meet are joined (`snap`); doors open the walls beside them (`door`). A third coordinate
//! is dropped. Geometries of several parts become several features of one name.

pub mod door;
mod drawing;
pub mod dxf;
pub mod feature;
pub mod geojson;
pub mod indoor;
pub mod osm;
pub mod placement;
pub mod plan;
pub mod snap;
pub mod wkt;

pub use door::{Door, Opened, open_at, open_doors};
pub use drawing::{Drawing, Format, read};
pub use dxf::read_dxf;
pub use feature::{Feature, FilePlace, Geometry, GeometryError, PropertyValue, Select};
pub use geojson::{read_geojson, select_geojson};
pub use osm::read_osm;
pub use placement::{Fault, Placement};
pub use plan::{Form, Plan, plan};
pub use snap::{Slips, is_crowded, slips, snap};
pub use wkt::read_wkt;
