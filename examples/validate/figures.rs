//! The pictures of the page: speed over density, and flow over the width of a door, beside Weidmann and experiments.

use smc::compile::presets::PRESETS;
use smc::engine::outcome::QueryResult;
use smc::report::svg::frame::Frame;
use smc::report::svg::picture::{Paper, Picture};
use smc::report::svg::scale::Scale;
use std::fs;
use std::path::Path;

/// Tests with a picture, and the folder of pictures.
const DIAGRAM: &str = "diagram";
const DOOR: &str = "door";
const PICTURES: &str = "docs/pictures";
/// Specific flows at doors in experiments (Seyfried and others 2009), 1/(m s).
const MEASURED: [f64; 2] = [1.2, 1.9];

/// A number that a preset reached: its place, and estimate with interval.
#[derive(Clone, Debug)]
struct Point {
    preset: usize,
    x: f64,
    /// Low, estimate, high.
    y: [f64; 3],
}

/// What the pictures show.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figures {
    diagram: Vec<Point>,
    door: Vec<Point>,
}

/// The walking speed of Weidmann (1993) at a density, m/s.
fn weidmann(density: f64) -> f64 {
    1.34 * (1.0 - (-1.913 * (1.0 / density - 1.0 / 5.4)).exp())
}

/// Estimate and interval of the estimates among results.
fn estimates(results: &[QueryResult]) -> Vec<[f64; 3]> {
    let of = |result: &QueryResult| {
        Some([result.low, result.estimate?, result.high])
            .filter(|_| result.asked.text.starts_with("estimate"))
    };
    results.iter().filter_map(of).collect()
}

impl Figures {
    /// Keeps what the results of a preset say, at a value of the parameter of a test.
    pub(crate) fn note(
        &mut self,
        (test, preset): (&str, &str),
        value: Option<&str>,
        results: &[QueryResult],
    ) {
        let Some(preset) = PRESETS.iter().position(|one| one.name == preset) else { return };
        let width = value.and_then(|value| value.split(' ').next()?.parse().ok());
        match (test, &estimates(results)[..], width) {
            (DIAGRAM, [[_, x, _], y], _) => self.diagram.push(Point { preset, x: *x, y: *y }),
            (DOOR, [y], Some(x)) => self.door.push(Point { preset, x, y: *y }),
            _ => {}
        }
    }

    /// The picture below a test as Markdown; its file is written.
    pub(crate) fn below(&self, test: &str) -> std::io::Result<String> {
        let (says, svg) = match test {
            DIAGRAM => ("Speed over density", self.speeds()),
            DOOR => ("Flow over width", self.flows()),
            _ => return Ok(String::new()),
        };
        fs::write(Path::new(PICTURES).join(format!("{test}.svg")), svg)?;
        Ok(format!("\n![{says}](pictures/{test}.svg)\n"))
    }

    fn speeds(&self) -> String {
        let axes = ["density (1/m²)", "mean speed (m/s), with its interval"];
        let (x, y) = (Scale::linear([0.0, 6.0]), Scale::linear([-0.2, 1.6]));
        let mut frame = Frame::new(axes, x, y);
        let densities = || (1..=54).map(|k| f64::from(k) / 10.0);
        let band: Vec<_> = densities().map(|x| (x, 0.85 * weidmann(x), 1.15 * weidmann(x))).collect();
        frame.band(&band, 3);
        frame.line(densities().map(|x| (x, weidmann(x))), 3);
        frame.name("Weidmann 1993, ± 15 %", 3);
        draw(&mut frame, &self.diagram);
        Picture::charts("One stream: speed over density", vec![frame]).svg(Paper::default())
    }

    fn flows(&self) -> String {
        let axes = ["width (m)", "flow over width (1/(m s)), with its interval"];
        let (x, y) = (Scale::linear([0.5, 2.5]), Scale::linear([0.0, 2.5]));
        let mut frame = Frame::new(axes, x, y);
        let [low, high] = MEASURED;
        frame.band(&[(0.5, low, high), (2.5, low, high)], 3);
        frame.level(high, "experiments");
        draw(&mut frame, &self.door);
        Picture::charts("A door: flow over width", vec![frame]).svg(Paper::default())
    }
}

/// A line for each preset.
fn draw(frame: &mut Frame, points: &[Point]) {
    for (preset, of) in PRESETS.iter().enumerate() {
        let mut own: Vec<&Point> = points.iter().filter(|point| point.preset == preset).collect();
        own.sort_by(|a, b| a.x.total_cmp(&b.x));
        for point in &own {
            frame.upright(point.x, point.y, preset);
        }
        frame.line(own.iter().map(|point| (point.x, point.y[1])), preset);
        frame.name(of.name, preset);
    }
}
