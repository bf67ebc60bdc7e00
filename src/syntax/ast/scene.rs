//! Scenes of scenario files: what stands still.

use super::{Expr, Field, Ident, ShapeExpr, Text};
use crate::syntax::source::Span;

/// One declaration of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneItem {
    /// `wall south: (0, 0) -- (20, 0) -- …`
    Wall {
        /// Its name, if any.
        name: Option<Ident>,
        /// Points joined by straight segments, at least two.
        points: Vec<Expr>,
        /// Where.
        span: Span,
    },
    /// `obstacle pillar: circle (10, 2) radius 0.3 m`
    Obstacle {
        /// Its name, if any.
        name: Option<Ident>,
        /// Its shape.
        shape: ShapeExpr,
    },
    /// `region exit: rect (18.5, 0) .. (20, 4)`, `region out: west, east`
    Region {
        /// Its name.
        name: Ident,
        /// Its shape.
        shape: ShapeExpr,
    },
    /// `point door: (3, 4)`
    Point {
        /// Its name.
        name: Ident,
        /// Its shape.
        at: Expr,
    },
    /// `line door: (3, 0) -- (3, 2)`
    Line {
        /// Its name.
        name: Ident,
        /// Its ends.
        ends: [Expr; 2],
        /// Where.
        span: Span,
    },
    /// `door main: (3, 0) -- (3, 2) { closed = shut == 1 }`
    Door {
        /// Its name.
        name: Ident,
        /// Its ends.
        ends: [Expr; 2],
        /// When it is closed.
        fields: Vec<Field>,
        /// Where.
        span: Span,
    },
    /// `level first { height = 4 m; … }`: its items have names such as `first.exit`.
    Level {
        /// Its name.
        name: Ident,
        /// Its height.
        fields: Vec<Field>,
        /// Its walls, regions and so on.
        items: Vec<SceneItem>,
    },
    /// `stairs s: ground.foot -- first.head { width = 1.4 m; run = 6 m }`
    Stairs {
        /// Its name.
        name: Ident,
        /// Its lower and its upper line.
        ends: [Expr; 2],
        /// Width, run and speeds.
        fields: Vec<Field>,
        /// Where.
        span: Span,
    },
    /// `periodic x in 0 m .. 20 m`
    Periodic {
        /// `x` or `y`, or a name that compilation will refuse.
        axis: Ident,
        /// Its ends.
        ends: [Expr; 2],
        /// Where.
        span: Span,
    },
    /// `import "file.geojson" where source == "map.png"`
    Import {
        /// File.
        path: Text,
        /// Whether its polygons are where agents move: `as walkable`.
        walkable: bool,
        /// Which features: comparisons of their properties with texts and numbers, joined by `&`, `|`, `!`.
        filter: Option<Expr>,
        /// Its name, by which its rooms and doors are named: `as plan`.
        called: Option<Ident>,
        /// How it is read: `{ snap = 5 cm }`.
        fields: Vec<Field>,
        /// Where.
        span: Span,
    },
    /// `import "mall.osm" by level { ground = "0"; first = "1"; storey = 4 m }`: its levels follow as items of their own.
    Storeys {
        /// The import of each level, without its filter by level.
        import: Box<SceneItem>,
        /// The levels from the lowest one on, each with its name in the file.
        levels: Vec<(Ident, Text)>,
        /// How far floors lie apart.
        storey: Option<Expr>,
    },
}

impl SceneItem {
    /// The item itself, or those of a level.
    pub fn on_all_levels(&self) -> impl Iterator<Item = &Self> {
        let within = if let Self::Level { items, .. } = self { items.as_slice() } else { &[] };
        std::iter::once(self).chain(within)
    }
}
