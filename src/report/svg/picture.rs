//! Pictures: one or several plans or charts as one SVG, for a screen, or as wide as a column of a page.

use super::Drawing;
use super::frame::{Frame, LETTER, LINE, WIDTH, cut, write_text};
use crate::report::escape::escape;
use std::fmt::Write as _;

/// Pixels per millimetre of paper, so that letters of 11 pixels have a height of 8 points.
const PER_MM: f64 = 96.0 / 25.4;
/// The name of the language, which a picture alone needs.
const LANGUAGE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";

/// How wide a picture is, mm; as on a screen without.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Paper {
    /// Between 40 and 1000 mm.
    pub width: Option<f64>,
}

/// A picture.
#[derive(Clone, Debug)]
pub struct Picture {
    title: String,
    panels: Panels,
}

#[derive(Clone, Debug)]
enum Panels {
    /// Side by side, two in a row, with their names.
    Plans(Vec<(String, Drawing)>),
    /// Below each other.
    Charts(Vec<Frame>),
}

impl Picture {
    /// Charts below each other.
    pub fn charts(title: &str, charts: Vec<Frame>) -> Self {
        Self { title: title.to_owned(), panels: Panels::Charts(charts) }
    }

    /// One plan.
    pub fn plan(title: &str, plan: Drawing) -> Self {
        Self::plans(title, vec![(String::new(), plan)])
    }

    /// Named plans, two in a row.
    pub fn plans(title: &str, plans: Vec<(String, Drawing)>) -> Self {
        Self { title: title.to_owned(), panels: Panels::Plans(plans) }
    }

    /// A file of its own.
    pub fn svg(&self, paper: Paper) -> String {
        self.drawn(LANGUAGE, paper)
    }

    /// For a place within a page.
    pub fn part_of_page(&self) -> String {
        self.drawn("", Paper::default())
    }

    fn drawn(&self, language: &str, paper: Paper) -> String {
        let wanted = paper.width.map(|mm| mm * PER_MM);
        let (body, width, height) = match &self.panels {
            Panels::Charts(charts) => {
                let width = wanted.unwrap_or(WIDTH);
                let letters = (width / LETTER) as usize - 4;
                let mut body = format!(
                    "<text x=\"12\" y=\"20\" font-size=\"12\">{}</text>\n",
                    escape(&cut(&self.title, letters))
                );
                let mut y = 2.0 * LINE;
                for chart in charts {
                    let (drawn, high) = chart.drawn(width);
                    let _ = writeln!(body, "<g transform=\"translate(0 {y:.1})\">\n{drawn}</g>");
                    y += high + 8.0;
                }
                (body, width, y)
            }
            Panels::Plans(plans) => plates(plans, wanted),
        };
        let size = match paper.width {
            Some(mm) => format!("{mm}mm"),
            None => format!("{width:.0}"),
        };
        format!(
            "<svg{language} viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{size}\" role=\"img\" font-family=\"sans-serif\" font-size=\"11\">\n<title>{}</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n",
            escape(&self.title)
        )
    }
}

/// Plans two in a row, with letters and names above them where there are several.
fn plates(plans: &[(String, Drawing)], wanted: Option<f64>) -> (String, f64, f64) {
    let columns = if plans.len() > 1 { 2.0 } else { 1.0 };
    let (mut body, mut width, mut y) = (String::new(), 0.0_f64, 0.0);
    for (row, pair) in plans.chunks(columns as usize).enumerate() {
        let (mut x, mut highest) = (0.0, 0.0_f64);
        let head = if plans.len() > 1 { LINE } else { 0.0 };
        for (k, (name, plan)) in pair.iter().enumerate() {
            let (drawn, [wide, high]) = plan.drawn(wanted.map(|width| width / columns), columns);
            if head > 0.0 {
                let letter = char::from(b'a' + (2 * row + k) as u8);
                write_text(&mut body, (x + 12.0, y + LINE), "", &format!("({letter}) {name}"));
            }
            let _ = writeln!(body, "<g transform=\"translate({x:.1} {:.1})\">\n{drawn}</g>", y + head);
            (x, highest) = (x + wide, highest.max(high));
        }
        (width, y) = (width.max(x), y + head + highest);
    }
    (body, wanted.unwrap_or(width), y)
}
