//! Levels and stairs: each level is settled in its own coordinates, then all are laid out side by side in one plane.

use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    plans::PlanPart,
    symbols::{Meaning, unknown},
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::files::Files;
use crate::compile::scene::{
    doors::Door,
    import_of,
    imports::levels::{Flight, flights, survey},
    settle_region, settle_scene,
};
use crate::model::storeys::APART;
use crate::model::{Barrier, Island, Obstacle, Portal};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, SceneItem, ShapeExpr, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;

/// Nearer than this to a barrier, the middle of a line of stairs lies in it, m.
const IN_WALL: f64 = 0.05;
/// At least so narrow and so short stairs are, m.
const NARROWEST: f64 = 0.4;
/// A line faces another one if at least this share of the way to it leads straight ahead.
const FACES: f64 = 0.3;
/// The share of a line at either end that another one may touch.
const ENDS: f64 = 0.1;
/// How far behind its line the rails around stairs end, m.
const RAIL: f64 = 1.0;

/// The shares up and down, for a run and a rise, m.
type Table = fn(f64, f64) -> [f64; 2];

/// Speeds on stairs as shares of that on a level, of the way in the plan.
///
/// Weidmann 1993, tables 3 and 5: 1.34 m/s on a level, 0.610 up and 0.694 down. SFPE Handbook, Gwynne and Rosenbaum 2016: along
/// the slope k/1.40 with k = 0.863 sqrt(tread/riser); the cosine of the slope makes it one in the plan.
const TABLES: [(&str, Table); 2] = [
    ("weidmann", |_, _| [0.610 / 1.34, 0.694 / 1.34]),
    ("sfpe", |run, rise| {
        let slope = (run * run + rise * rise).sqrt();
        [51.8 / 60.0 * (run / rise).sqrt() / 1.40 * (run / slope); 2]
    }),
];

/// Settles scenes with levels; their doors.
pub(crate) fn settle<'a>(context: &mut Context<'a>, scenes: &[&'a [SceneItem]], files: &Files) -> Vec<Door> {
    let mut doors: Vec<(usize, Door)> = Vec::new();
    let mut heights = Vec::new();
    let (mut imported, mut middle) = (Vec::new(), None);
    let items = || scenes.iter().flat_map(|items| items.iter());
    let levels = items().filter_map(|item| match item {
        SceneItem::Level { name, fields, items } => Some((name, fields, items)),
        _ => None,
    });
    // Files that become several levels, and those that could not be read.
    let (mut buildings, mut lost) = (Vec::new(), Vec::new());
    for item in items() {
        let SceneItem::Storeys { import, levels, storey } = item else { continue };
        let Some(import) = import_of(import).filter(|_| !levels.is_empty()) else { continue };
        let path = import.path.span;
        match survey(context, import, levels, storey.as_ref(), files) {
            Ok(building) => buildings.push(building),
            Err(Reported) => lost.push(path),
        }
    }
    for (level, (name, fields, items)) in levels.enumerate() {
        if let [SceneItem::Import { path, .. }] = items.as_slice()
            && lost.contains(&path.span)
        {
            heights.push((None, name.span));
            imported.push(0..0);
            continue;
        }
        heights.push(height(context, name, fields));
        context.levels.frame = Some(level);
        let known = &context.levels.all[level];
        let (mut barrier, mut line) = (known.barriers.start, known.lines.start);
        let first = context.scene.barriers.len();
        let settled = settle_scene(context, items, files, (&mut barrier, &mut line, &mut middle));
        doors.extend(settled.into_iter().map(|door| (level, door)));
        imported.push(first..context.scene.barriers.len());
        context.levels.frame = None;
    }
    let is_sound = check_heights(context, &heights);
    let of_files = buildings.iter_mut().filter_map(|building| flights(context, building, &mut middle).ok());
    let of_files: Vec<Flight> = of_files.flatten().collect();
    lay_out(context, &heights, (&imported, &of_files), &mut doors);
    let mut stairs = Vec::new();
    for item in items() {
        match item {
            SceneItem::Level { items, .. } => {
                for item in items {
                    let (said, span) = match item {
                        SceneItem::Level { name, .. } | SceneItem::Stairs { name, .. } => {
                            (format!("`{}` lies within a level", name.name), name.span)
                        }
                        SceneItem::Storeys { .. } => {
                            ("an import by level lies within a level".to_owned(), place_of(item))
                        }
                        _ => continue,
                    };
                    let error =
                        error!(E0412, span, "{said}"; hint: "write it beside the levels, in the scene");
                    context.note(error);
                }
            }
            SceneItem::Stairs { name, ends, fields, .. } => stairs.push((name, ends, fields)),
            SceneItem::Storeys { .. } => {}
            SceneItem::Region { name, shape } if is_of_names(shape) => settle_region(context, name, shape),
            SceneItem::Periodic { axis, .. } => {
                let error = error!(E0412, axis.span, "a scene with levels has no periods");
                context.note(error);
            }
            other => {
                let error = error!(E0412, place_of(other), "this lies on no level";
                    hint: "write it within a level: `level ground {{ … }}`");
                context.note(error);
            }
        }
    }
    for (name, ends, fields) in stairs {
        let _ = flight(context, name, (ends, fields), is_sound);
    }
    for flight in of_files.iter().filter(|_| is_sound) {
        let _ = of_file(context, flight);
    }
    doors.into_iter().map(|(_, door)| door).collect()
}

/// Whether a region is made of others.
fn is_of_names(shape: &ShapeExpr) -> bool {
    match shape {
        ShapeExpr::Named(_) | ShapeExpr::Of(_) => true,
        ShapeExpr::Parts(parts) => parts.iter().all(is_of_names),
        _ => false,
    }
}

pub(crate) fn place_of(item: &SceneItem) -> Span {
    match item {
        SceneItem::Wall { span, .. }
        | SceneItem::Line { span, .. }
        | SceneItem::Door { span, .. }
        | SceneItem::Import { span, .. }
        | SceneItem::Stairs { span, .. }
        | SceneItem::Periodic { span, .. } => *span,
        SceneItem::Obstacle { shape, .. } | SceneItem::Region { shape, .. } => shape.span(),
        SceneItem::Point { at, .. } => at.span,
        SceneItem::Level { name, .. } => name.span,
        SceneItem::Storeys { import, .. } => place_of(import),
    }
}

/// The height of a level, m: 0 where none is written; none where it cannot be read.
fn height(context: &mut Context<'_>, name: &Ident, fields: &[Field]) -> (Option<f64>, Span) {
    let mut height = (Some(0.0), name.span);
    for field in fields {
        match (field.name.name.as_str(), &field.value) {
            ("height", Value::Plain(expr)) => {
                let number = context.number_of(expr, Dimension::LENGTH, &Locals::default());
                height = (number.ok().map(|number| number.value), expr.span);
            }
            (known, _) => {
                let error = unknown("field", known, field.name.span, Code::E0207, ["height"].into_iter());
                context.note(error);
                height = (None, name.span);
            }
        }
    }
    height
}

/// Whether all heights are known, and no two are the same.
fn check_heights(context: &mut Context<'_>, heights: &[(Option<f64>, Span)]) -> bool {
    for (k, (height, span)) in heights.iter().enumerate() {
        if let Some(first) = heights[..k].iter().position(|(other, _)| other == height && height.is_some()) {
            let [a, b] = [first, k].map(|k| context.levels.all[k].name.clone());
            let error = error!(E0412, *span, "`{a}` and `{b}` have the same height";
                hint: "write the height in which the floor of each level lies: `height = 4 m`");
            context.note(error.related(heights[first].1, "the other level").about(About::Storey));
            return false;
        }
    }
    heights.iter().all(|(height, _)| height.is_some())
}

/// Moves the levels side by side: the lowest one stays where it is.
fn lay_out(
    context: &mut Context<'_>,
    heights: &[(Option<f64>, Span)],
    (imported, flights): (&[std::ops::Range<usize>], &[Flight]),
    doors: &mut [(usize, Door)],
) {
    let mut order: Vec<usize> = (0..heights.len()).collect();
    let height_of = |level: usize| heights[level].0.unwrap_or_default();
    order.sort_by(|a, b| height_of(*a).total_cmp(&height_of(*b)));
    let mut edge: Option<f64> = None;
    for level in order {
        let known = context.levels.all[level].clone();
        let own = format!("{}.", known.name);
        let barriers = || known.barriers.clone().chain(imported[level].clone());
        let is_own = |name: &str| name.starts_with(&own);
        let scene = &context.scene;
        let of_barriers = barriers().filter_map(|k| scene.barriers[k].obstacle.bounds());
        let regions = scene.regions.iter().zip(&context.shapes).filter(|(region, _)| is_own(&region.name));
        let of_regions = regions.filter_map(|(_, shape)| Some(shape.clone()?.ok()?.bounds()));
        let of_plans = context.plans.iter().filter(|plan| is_own(&plan.name)).flat_map(|plan| &plan.parts);
        let of_plans = of_plans.flatten().filter_map(|(_, part)| match part {
            PlanPart::Room(shape) => Some(shape.bounds()),
            PlanPart::Door(_) => None,
        });
        let points = scene.points.iter().filter(|(name, _)| is_own(name)).map(|(_, p)| *p);
        let lines = scene.lines[known.lines.clone()].iter().flat_map(|line| [line.segment.a, line.segment.b]);
        let of_flights = flights.iter().flat_map(|flight| flight.levels.iter().zip(&flight.lines));
        let of_flights = of_flights.filter(|(of, _)| **of == level).flat_map(|(_, line)| [line.a, line.b]);
        let corners = of_barriers.chain(of_regions).chain(of_plans).flat_map(|b| [b.low, b.high]);
        let bounds = Bounds::around(corners.chain(points).chain(lines).chain(of_flights)).unwrap_or_default();
        // Whole metres keep the digits of coordinates.
        let way = Vec2::new(edge.map_or(0.0, |edge| (edge + APART - bounds.low.x).ceil()), 0.0);
        edge = Some(bounds.high.x + way.x);
        let bounds = Bounds { low: bounds.low + way, high: bounds.high + way };
        let height = Some(height_of(level));
        context.scene.storeys.islands.push(Island { name: known.name, origin: way, bounds, height });
        let moved = |segment: Segment| Segment::new(segment.a + way, segment.b + way);
        for k in known.barriers.clone().chain(imported[level].clone()) {
            let barrier = &mut context.scene.barriers[k];
            *barrier = barrier.moved(way);
        }
        for (region, shape) in context.scene.regions.iter_mut().zip(&mut context.shapes) {
            if region.name.starts_with(&own) {
                region.shape = region.shape.moved(way);
                if let Some(Ok(shape)) = shape {
                    *shape = shape.moved(way);
                }
            }
        }
        for plan in context.plans.iter_mut().filter(|plan| plan.name.starts_with(&own)) {
            for (_, part) in plan.parts.iter_mut().flatten() {
                match part {
                    PlanPart::Room(shape) => *shape = shape.moved(way),
                    PlanPart::Door(segment) => *segment = moved(*segment),
                }
            }
        }
        for (_, point) in context.scene.points.iter_mut().filter(|(name, _)| name.starts_with(&own)) {
            *point += way;
        }
        for line in &mut context.scene.lines[known.lines.clone()] {
            line.segment = moved(line.segment);
        }
        for (_, door) in doors.iter_mut().filter(|(of, _)| *of == level) {
            door.segment = moved(door.segment);
        }
    }
}

/// The fields of stairs.
struct Fields {
    width: Option<f64>,
    run: Option<f64>,
    speeds: [Option<f64>; 2],
    table: usize,
}

fn fields(context: &mut Context<'_>, written: &[Field]) -> Lowered<Fields> {
    let mut out = Fields { width: None, run: None, speeds: [None; 2], table: 0 };
    let read: Vec<Lowered<()>> = written.iter().map(|field| set(context, field, &mut out)).collect();
    read.into_iter().collect::<Lowered<()>>().map(|()| out)
}

/// Sets one of the fields of stairs.
fn set(context: &mut Context<'_>, field: &Field, out: &mut Fields) -> Lowered<()> {
    let name = field.name.name.as_str();
    let Value::Plain(expr) = &field.value else {
        return context.report(error!(E0305, field.value.span(), "expected a number"));
    };
    let mut number = |dimension| {
        let number = context.number_of(expr, dimension, &Locals::default())?;
        if number.value > 0.0 && number.value.is_finite() {
            return Ok(Some(number.value));
        }
        context.report(error!(E0412, expr.span, "`{name}` must be positive"))
    };
    match name {
        "width" => out.width = number(Dimension::LENGTH)?,
        "run" => out.run = number(Dimension::LENGTH)?,
        "up" => out.speeds[0] = number(Dimension::NONE)?,
        "down" => out.speeds[1] = number(Dimension::NONE)?,
        "speeds" => {
            let named = if let ExprKind::Name(name) = &expr.kind { name.as_str() } else { "" };
            let Some(table) = TABLES.iter().position(|(table, _)| *table == named) else {
                return context.report(error!(E0412, expr.span, "`speeds` names a table";
                    hint: "write `speeds = weidmann`, `speeds = sfpe`, or shares of the speed on a level: `up = 0.5; down = 0.6`"));
            };
            out.table = table;
        }
        _ => {
            let known = ["width", "run", "up", "down", "speeds"].into_iter();
            return context.report(unknown("field", name, field.name.span, Code::E0207, known));
        }
    }
    Ok(())
}

/// A line of stairs on its level: its island, and the line.
fn line_of(context: &mut Context<'_>, name: &Ident, end: &Expr) -> Lowered<(u32, Segment)> {
    let typed = context.lower(end, &Locals::default())?;
    let Typed::Line(id) = typed else { return context.mismatch(end.span, "a line of a level", &typed) };
    let segment = context.scene.lines[id.0 as usize].segment;
    if segment.length() == 0.0 {
        // Its places could not be read.
        return Err(Reported);
    }
    check_line(context, (name, end.span), &segment)?;
    let middle = 0.5 * (segment.a + segment.b);
    Ok((context.scene.storeys.island_at(middle) as u32, segment))
}

/// Whether stairs may begin at a line: it is open, and belongs to no other stairs.
fn check_line(context: &mut Context<'_>, (name, span): (&Ident, Span), segment: &Segment) -> Lowered<()> {
    let middle = 0.5 * (segment.a + segment.b);
    if let Some(barrier) = context.scene.barriers.iter().find(|one| one.obstacle.distance(middle) < IN_WALL) {
        let said = format!("the line of the stairs `{}` lies in {}", name.name, barrier.phrase());
        return context.report(error!(E0412, span, "{said}"; hint: "leave the wall open there"));
    }
    // Flights side by side share an end of their lines.
    let inner = |line: &Segment| {
        let off = (line.b - line.a) * ENDS;
        Segment::new(line.a + off, line.b - off)
    };
    let meets = |portal: &&Portal| inner(&portal.line).distance_to(&inner(segment)) < IN_WALL;
    let taken = context.scene.storeys.portals.iter().find(meets);
    if let Some(portal) = taken {
        let strip = portal.islands.iter().find_map(|k| {
            let island = &context.scene.storeys.islands[*k as usize];
            island.height.is_none().then(|| island.name.clone())
        });
        let said =
            format!("two stairs begin at one line, `{}` and `{}`", strip.unwrap_or_default(), name.name);
        return context.report(error!(E0412, span, "{said}"; hint: "give each flight a line of its own"));
    }
    Ok(())
}

/// The direction in which one goes up at a line, a unit vector. `way` leads from the foot to the head.
fn upward(line: &Segment, way: Vec2) -> Vec2 {
    let along = (line.b - line.a).normalize();
    // The first end lies on the left of who goes up, unless the other line lies behind them.
    let onward = Vec2::new(-along.y, along.x);
    if way.dot(&onward) < -FACES * way.norm() { -onward } else { onward }
}

/// The rails around stairs on a level, so that its ways do not lead through: from the ends of a line, across it, and behind.
fn rail(line: &Segment, across: Vec2) -> [Segment; 3] {
    let behind = |p: Vec2| p + across * RAIL;
    let (a, b) = (behind(line.a), behind(line.b));
    [Segment::new(line.a, a), Segment::new(a, b), Segment::new(b, line.b)]
}

/// `stairs s: ground.foot -- first.head { … }`; without sound heights its parts are looked at alone.
fn flight(
    context: &mut Context<'_>,
    name: &Ident,
    (ends, written): (&[Expr; 2], &[Field]),
    is_sound: bool,
) -> Lowered<()> {
    let read = fields(context, written);
    let (foot, head) = (line_of(context, name, &ends[0]), line_of(context, name, &ends[1]));
    let (fields, (low, foot), (high, head)) = (read?, foot?, head?);
    if !is_sound {
        return Err(Reported);
    }
    let storeys = &context.scene.storeys;
    let [lower, upper] = [low, high].map(|k| storeys.islands[k as usize].clone());
    match (lower.height, upper.height) {
        (Some(a), Some(b)) if b > a => {}
        (Some(a), Some(b)) => {
            let said = if a == b { "lead from a level to the same one" } else { "lead downward" };
            let span = ends[0].span.to(ends[1].span);
            return context.report(error!(E0412, span, "the stairs `{}` {said}", name.name;
                hint: "write the line of the lower level first: `stairs s: ground.foot -- first.head`"));
        }
        _ => return Err(Reported),
    }
    let middle = |line: &Segment| 0.5 * (line.a + line.b);
    let way = (middle(&head) - upper.origin) - (middle(&foot) - lower.origin);
    let run = fields.run.or(Some(way.norm()).filter(|run| *run >= NARROWEST));
    let upward = [upward(&foot, way), upward(&head, way)];
    raise(context, name, ([low, high], [foot, head], upward), run, &fields)
}

/// A flight of a file, which says where both of its lines lie.
fn of_file(context: &mut Context<'_>, flight: &Flight) -> Lowered<()> {
    let at = |level: usize| {
        let name = &context.levels.all[level].name;
        let island = context.scene.storeys.islands.iter().position(|island| island.name == *name);
        island.map(|k| (k as u32, context.scene.storeys.islands[k].origin)).ok_or(Reported)
    };
    let [(low, below), (high, above)] = [at(flight.levels[0])?, at(flight.levels[1])?];
    let moved = |line: Segment, way: Vec2| Segment::new(line.a + way, line.b + way);
    let lines = [moved(flight.lines[0], below), moved(flight.lines[1], above)];
    for line in &lines {
        check_line(context, (&flight.name, flight.name.span), line)?;
    }
    let fields = Fields { width: None, run: None, speeds: [None; 2], table: 0 };
    let run = Some(flight.run).filter(|run| *run >= NARROWEST);
    raise(context, &flight.name, ([low, high], lines, flight.upward), run, &fields)?;
    for (pieces, way) in flight.wings().into_iter().zip([below, above]) {
        let obstacle = Obstacle::Wall(pieces.into_iter().map(|piece| moved(piece, way)).collect());
        context.scene.barriers.push(Barrier { name: flight.name.name.clone(), obstacle });
    }
    Ok(())
}

/// Builds a flight between two lines of two islands; `upward` are the directions in which one goes up there.
fn raise(
    context: &mut Context<'_>,
    name: &Ident,
    ([low, high], [foot, head], [into, out]): ([u32; 2], [Segment; 2], [Vec2; 2]),
    run: Option<f64>,
    fields: &Fields,
) -> Lowered<()> {
    let Some(run) = run else {
        let error = error!(E0412, name.span, "the stairs `{}` have no length", name.name;
            hint: "write how far they lead in the plan: `run = 6 m`");
        return context.report(error.about(About::Storey));
    };
    let most = foot.length().min(head.length());
    let width = fields.width.unwrap_or(most);
    if width > most + 1e-9 || width < NARROWEST {
        let said = format!("the stairs `{}` are {width:.2} m wide, their lines {most:.2} m", name.name);
        return context.report(error!(E0412, name.span, "{said}";
            hint: "stairs are at least {NARROWEST} m wide, and no wider than their lines"));
    }
    let storeys = &context.scene.storeys;
    let [below, above] = [low, high].map(|k| storeys.islands[k as usize].height.unwrap_or_default());
    let table = TABLES[fields.table].1(run, above - below);
    let [up, down] = [0, 1].map(|k| fields.speeds[k].unwrap_or(table[k]));
    // Strips lie in a row above the levels.
    let islands = &context.scene.storeys.islands;
    let levels = islands.iter().filter(|island| island.height.is_some()).map(|island| &island.bounds);
    let top = levels.map(|b| b.high.y).fold(f64::NEG_INFINITY, f64::max);
    let flights = islands.iter().filter(|island| island.height.is_none());
    let left = islands.iter().map(|island| island.bounds.low.x).fold(f64::INFINITY, f64::min);
    let edge = flights.map(|island| island.bounds.high.x + APART).fold(left, f64::max);
    let origin = Vec2::new(edge.ceil(), (top + APART).ceil());
    let corner = |x: f64, y: f64| origin + Vec2::new(x, y);
    let strip = Shape::rectangle(corner(0.0, 0.0), corner(run, width));
    let sides = [0.0, width].map(|y| Segment::new(corner(0.0, y), corner(run, y)));
    let across = |x: f64| Segment::new(corner(x, width), corner(x, 0.0));
    let middle = |line: &Segment| 0.5 * (line.a + line.b);
    // A line from left to right, as wide as the stairs.
    let opening = |line: &Segment, upward: Vec2| {
        let left = Vec2::new(-upward.y, upward.x) * (0.5 * width);
        Segment::new(middle(line) + left, middle(line) - left)
    };
    let (below, above) = (opening(&foot, into), opening(&head, out));
    let flight = islands.len() as u32;
    let ahead = Vec2::new(1.0, 0.0);
    let portal = |islands, (line, across), (landing, onward), speed, approach| Portal {
        islands,
        line,
        across,
        landing,
        onward,
        speed,
        approach,
    };
    let portals = [
        portal([low, flight], (below, into), (across(0.0), ahead), up, 1.0),
        portal([flight, high], (across(run), ahead), (above, out), 1.0, up),
        portal([high, flight], (above, -out), (across(run), -ahead), down, 1.0),
        portal([flight, low], (across(0.0), -ahead), (below, -into), 1.0, down),
    ];
    let scene = &mut context.scene;
    scene.storeys.islands.push(Island {
        name: name.name.clone(),
        origin,
        bounds: strip.bounds(),
        height: None,
    });
    scene.storeys.portals.extend(portals);
    let rails = [(&below, into), (&above, -out)].map(|(line, across)| rail(line, across));
    let pieces = sides.into_iter().chain(rails.into_iter().flatten()).collect();
    scene.barriers.push(Barrier { name: name.name.clone(), obstacle: Obstacle::Wall(pieces) });
    if let Some(Meaning::Stairs(id)) =
        context.names.scopes[0].get(&name.name).map(|entry| entry.meaning.clone())
    {
        context.scene.regions[id.0 as usize].shape = strip.clone();
        context.shapes[id.0 as usize] = Some(Ok(strip));
    }
    Ok(())
}
