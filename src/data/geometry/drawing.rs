//! A drawing: the features of a file in any format.

use super::{Feature, GeometryError, Select, read_dxf, read_osm, read_wkt, select_geojson};
use std::collections::{BTreeMap, BTreeSet};

/// The format of a file, known by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `.dxf`
    Dxf,
    /// `.osm`
    Osm,
    /// `.wkt`
    Wkt,
    /// Anything else.
    GeoJson,
}

impl Format {
    /// The format of a file of this name.
    pub fn of(path: &str) -> Self {
        let end = path.rsplit_once('.').map_or("", |(_, end)| end);
        let is = |format: &str| end.eq_ignore_ascii_case(format);
        if is("dxf") {
            Self::Dxf
        } else if is("osm") {
            Self::Osm
        } else if is("wkt") {
            Self::Wkt
        } else {
            Self::GeoJson
        }
    }
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Its selected features, in its own coordinates.
    pub features: Vec<Feature>,
    /// Metres per unit of its coordinates, if the file says so.
    pub unit: Option<f64>,
    /// Its layers, where the format has layers.
    pub layers: BTreeSet<String>,
    /// How many selected entities of which type could not be used.
    pub skipped: BTreeMap<String, usize>,
}

/// Reads a text in a format. `unit` is the number of metres per unit of the coordinates if the scenario sets it.
///
/// # Errors
/// What the reader of the format finds wrong.
pub fn read(
    format: Format,
    text: &str,
    unit: Option<f64>,
    select: &mut Select<'_>,
) -> Result<Drawing, Vec<GeometryError>> {
    let of = |features| Drawing { features, ..Drawing::default() };
    match format {
        Format::Dxf => read_dxf(text, unit, select),
        // Well-known text has no properties, so a filter takes all of it or nothing.
        Format::Wkt if !select("", &[]) => Ok(Drawing::default()),
        Format::Wkt => read_wkt(text).map(of),
        Format::Osm => read_osm(text, select).map(of),
        Format::GeoJson => select_geojson(text, select).map(of),
    }
}
