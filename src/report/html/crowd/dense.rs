//! Places at which people stood close: squares of 1 m in which the density was above 4 persons per m², which the guidelines of
//! the IMO (MSC.1/Circ.1533) call congestion, and for how long.

use super::moments::Moment;
use crate::base::geometry::Vec2;
use crate::model::Scene;
use crate::report::html::table::Table;
use crate::report::number::brief;
use std::collections::BTreeMap;

/// Density above which people stand close, 1/m².
pub(super) const CLOSE: f64 = 4.0;
/// Rows of the table.
const MOST_PLACES: usize = 10;

/// A row for each square, the longest first: its middle, m; for how long, s in a trace; the greatest density, 1/m². The density is
/// the mean of 1 / area of the cells of those in the square, if there are two or more.
pub(super) fn table(scene: &Scene, moments: &[Moment], traces: usize) -> Table {
    // The level of a square, and its corner there.
    let square = |at: Vec2| {
        let (level, own) = scene.storeys.local(at).map_or(("", at), |(island, own)| (&island.name, own));
        (level, own.x.floor() as i64, own.y.floor() as i64)
    };
    let mut squares: BTreeMap<(&str, i64, i64), (f64, f64)> = BTreeMap::new();
    for moment in moments {
        let mut here: BTreeMap<(&str, i64, i64), (f64, f64)> = BTreeMap::new();
        for (at, area) in moment.people.iter().filter(|(_, area)| *area > 0.0) {
            let (sum, people) = here.entry(square(*at)).or_default();
            (*sum, *people) = (*sum + 1.0 / area, *people + 1.0);
        }
        for (square, (sum, people)) in here {
            let density = sum / people;
            if people >= 2.0 && density > CLOSE {
                let (seconds, most) = squares.entry(square).or_default();
                (*seconds, *most) = (*seconds + moment.seconds, most.max(density));
            }
        }
    }
    let mut all: Vec<_> = squares.into_iter().collect();
    all.sort_by(|a, b| b.1.0.total_cmp(&a.1.0));
    let row = |((level, x, y), (seconds, most)): &((&str, i64, i64), (f64, f64))| {
        let place = format!("{level} ({}, {})", *x as f64 + 0.5, *y as f64 + 0.5).trim_start().to_owned();
        vec![place, brief(seconds / traces as f64), brief(*most)]
    };
    Table {
        title: "Densities above 4 per square metre".into(),
        columns: vec!["above 4 per m² around (m)", "for (s in a trace)", "at most (1/m²)"],
        rows: all.iter().take(MOST_PLACES).map(row).collect(),
        ..Table::default()
    }
}
