//! Reliability diagrams: the share that happened over the predicted probability, one panel a property, and below it
//! how many predictions were made (Murphy and Winkler 1977).

use super::Evaluated;
use crate::report::escape::escape;
use crate::report::number::count;
use crate::report::svg::frame::LINES;
use crate::stats::BrierScore;
use std::fmt::Write as _;

/// Side of a diagram, pixels.
const SIDE: f64 = 300.0;
/// Height of a histogram, and its distance from the diagram.
const HISTOGRAM: f64 = 60.0;
const GAP: f64 = 12.0;
/// Room around a panel: left, above, right, below.
const ROOM: [f64; 4] = [80.0, 30.0, 20.0, 44.0];
/// Height of a line of the legend.
const LINE: f64 = 18.0;
/// Most panels in a row.
const ACROSS: usize = 3;
/// Most letters of a name.
const LETTERS: usize = 48;

/// The diagrams as SVG.
pub fn to_svg(report: &Evaluated) -> String {
    let names = report.names();
    let head = 8.0 + LINE * report.kinds.len() as f64;
    let panel = [ROOM[0] + SIDE + ROOM[2], ROOM[1] + SIDE + GAP + HISTOGRAM + ROOM[3]];
    let across = names.len().clamp(1, ACROSS);
    let size = [panel[0] * across as f64, head + panel[1] * names.len().div_ceil(across) as f64];
    let mut body = String::new();
    for (k, kind) in report.kinds.iter().enumerate() {
        let y = 8.0 + LINE * (k as f64 + 0.5);
        line(&mut body, k, &[(ROOM[0], y), (ROOM[0] + 20.0, y), (ROOM[0] + 40.0, y)]);
        marker(&mut body, k, (ROOM[0] + 20.0, y));
        text(&mut body, (ROOM[0] + 50.0, y + 4.0), "start", &shortened(&kind.name));
    }
    for (k, name) in names.into_iter().enumerate() {
        let origin =
            (panel[0] * (k % across) as f64 + ROOM[0], head + panel[1] * (k / across) as f64 + ROOM[1]);
        let scores: Vec<Option<&BrierScore>> = report
            .kinds
            .iter()
            .map(|kind| kind.properties.iter().find(|property| property.name == name))
            .map(|property| property.and_then(|property| property.quality.as_ref()).map(|found| &found.score))
            .collect();
        text(&mut body, (origin.0 + 0.5 * SIDE, origin.1 - 10.0), "middle", &shortened(name));
        diagram(&mut body, origin, &scores);
        histogram(&mut body, (origin.0, origin.1 + SIDE + GAP), &scores);
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" font-family=\"sans-serif\" font-size=\"11\">\n<title>Reliability of {} on {} ({} velocities)</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n",
        size[0],
        size[1],
        escape(&report.model),
        escape(&report.recording),
        report.velocity.name()
    )
}

fn shortened(name: &str) -> String {
    match name.char_indices().nth(LETTERS) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.to_owned(),
    }
}

fn text(body: &mut String, (x, y): (f64, f64), anchor: &str, text: &str) {
    let _ =
        writeln!(body, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escape(text));
}

/// A text that reads upwards.
fn upward(body: &mut String, (x, y): (f64, f64), text: &str) {
    let _ = writeln!(
        body,
        "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\">{text}</text>"
    );
}

/// The line of kind number `k`.
fn line(body: &mut String, k: usize, points: &[(f64, f64)]) {
    let (colour, shape) = LINES[k % LINES.len()];
    let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let points = points.join(" ");
    let _ = writeln!(body, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" {shape}/>");
}

/// A circle, square, triangle, diamond or cross. Kinds of one colour have different ones.
fn marker(body: &mut String, k: usize, (x, y): (f64, f64)) {
    let (colour, _) = LINES[k % LINES.len()];
    let shape = match (k + k / LINES.len()) % 5 {
        0 => "m-4,0a4,4 0 1 0 8,0a4,4 0 1 0 -8,0z",
        1 => "m-3.5,-3.5h7v7h-7z",
        2 => "m0,-4.5l4.5,8h-9z",
        3 => "m0,-5l4,5l-4,5l-4,-5z",
        _ => "m-4,-4l8,8m0,-8l-8,8",
    };
    let _ = writeln!(
        body,
        "<path d=\"M{x:.1},{y:.1}{shape}\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>"
    );
}

/// Axes, the diagonal, and a point for each bin.
fn diagram(body: &mut String, (left, top): (f64, f64), scores: &[Option<&BrierScore>]) {
    let at = |x: f64, y: f64| (left + SIDE * x, top + SIDE * (1.0 - y));
    let bottom = top + SIDE;
    let _ = writeln!(
        body,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#808080\"/><path d=\"M{left:.1},{bottom:.1}L{:.1},{top:.1}\" stroke=\"#b0b0b0\"/>",
        left + SIDE
    );
    for tenths in (0..=10_u32).step_by(2) {
        let share = f64::from(tenths) / 10.0;
        let (_, y) = at(0.0, share);
        let _ = writeln!(body, "<path d=\"M{left:.1},{y:.1}h-4\" stroke=\"#808080\"/>");
        text(body, (left - 7.0, y + 4.0), "end", &format!("{share:.1}"));
    }
    upward(body, (left - 60.0, top + 0.5 * SIDE), "share that happened");
    for (k, score) in scores.iter().enumerate() {
        let Some(score) = score else { continue };
        let points: Vec<_> = score.bins.iter().map(|bin| at(bin.mean, bin.share)).collect();
        line(body, k, &points);
        for point in points {
            marker(body, k, point);
        }
    }
}

/// Number of predictions in each tenth, a bar for each kind, and the axis of both diagrams.
fn histogram(body: &mut String, (left, top): (f64, f64), scores: &[Option<&BrierScore>]) {
    let bottom = top + HISTOGRAM;
    let most = scores.iter().flatten().flat_map(|score| score.histogram).max().unwrap_or(0);
    let cell = SIDE / 10.0;
    let width = 0.8 * cell / scores.len().max(1) as f64;
    for (k, score) in scores.iter().enumerate() {
        let (colour, _) = LINES[k % LINES.len()];
        for (tenth, number) in score.iter().flat_map(|score| score.histogram).enumerate() {
            if number > 0 {
                let height = HISTOGRAM * number as f64 / most as f64;
                let x = left + cell * (tenth as f64 + 0.1) + width * k as f64;
                let _ = writeln!(
                    body,
                    "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\"/>",
                    bottom - height
                );
            }
        }
    }
    let _ = writeln!(
        body,
        "<path d=\"M{left:.1},{top:.1}V{bottom:.1}h{SIDE}\" fill=\"none\" stroke=\"#808080\"/>"
    );
    for tenths in (0..=10_u32).step_by(2) {
        let share = f64::from(tenths) / 10.0;
        let x = left + SIDE * share;
        let _ = writeln!(body, "<path d=\"M{x:.1},{bottom:.1}v4\" stroke=\"#808080\"/>");
        text(body, (x, bottom + 16.0), "middle", &format!("{share:.1}"));
    }
    text(body, (left - 7.0, top + 8.0), "end", &count(most));
    text(body, (left - 7.0, bottom), "end", "0");
    text(body, (left + 0.5 * SIDE, bottom + 34.0), "middle", "predicted probability");
    upward(body, (left - 60.0, top + 0.5 * HISTOGRAM), "predictions");
}
