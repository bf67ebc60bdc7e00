//! Two sets of walks compared, as text, JSON and the distances of points: `smc gait compare`.

use super::number::{brief, count, counted};
use super::svg::picture::Picture;
use super::svg::{Drawing, plan};
use super::walked::corridor;
use crate::base::geometry::{Bounds, Vec2};
use crate::data::walks::Walk;
use crate::gait::compare::{
    CONFIDENCE, Comparison, Comparisons, MOST_WALKS, Measure, POINTS, RESAMPLES, Rivals, SHUFFLES, rivals,
};
use crate::model::Scenario;
use crate::stats::twosample::{EnergyTest, SignedRank, SpreadRatio, Summary};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// Level of the tests that sentences speak of.
const LEVEL: f64 = 0.05;

/// A set of walks and the name of its file.
#[derive(Clone, Copy, Debug)]
pub struct WalkSet<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Its walks.
    pub walks: &'a [Walk],
}

impl WalkSet<'_> {
    fn points(&self) -> u64 {
        self.walks.iter().map(|walk| walk.points.len() as u64).sum()
    }
}

/// The letter of a set: A is the base.
fn letter(k: usize) -> char {
    char::from(b'A' + k as u8)
}

/// For people: what follows first, then the numbers. Lengths in metres, times in seconds. The base is the first set.
pub fn to_text(found: &[Comparisons], sets: &[WalkSet<'_>]) -> String {
    let rivals = rivals_of(found, sets);
    let mut out = conclusion(found, &rivals);
    out.push('\n');
    for (k, set) in sets.iter().enumerate() {
        let (walks, points) = (counted(set.walks.len() as u64, "walk"), counted(set.points(), "point"));
        let _ = writeln!(out, "{}  {}  ({walks}, {points})", letter(k), set.file);
    }
    for (k, one) in found.iter().enumerate() {
        let name = letter(k + 1);
        table(&mut out, name, &one.whole);
        for leg in &one.legs {
            table(&mut out, name, leg);
        }
        for (leg, [a, b]) in &one.left_out {
            let walks = counted(*a as u64, "walk");
            let _ = writeln!(out, "\nLeg {leg} is not compared: A has {walks}, {name} has {b}.");
        }
    }
    if !rivals.is_empty() {
        heads(&mut out, "distance from A (Wilcoxon)", &["median", "p, points", "p, walks"]);
        for one in &rivals {
            let [first, second] = one.candidates.map(|k| letter(k + 1));
            let cells = [one.points.median, one.points.p, one.walks.p].map(brief);
            row(&mut out, &format!("{second} less {first}"), &cells);
        }
    }
    out
}

fn rivals_of(found: &[Comparisons], sets: &[WalkSet<'_>]) -> Vec<Rivals> {
    let wholes: Vec<&Comparison> = found.iter().map(|one| &one.whole).collect();
    sets.first().map(|base| rivals(base.walks, &wholes)).unwrap_or_default()
}

/// What follows, one sentence for each candidate, and one for all.
fn conclusion(found: &[Comparisons], rivals: &[Rivals]) -> String {
    let mut out = String::new();
    for (k, one) in found.iter().enumerate() {
        let (whole, name) = (&one.whole, letter(k + 1));
        let alike =
            if whole.path.p > LEVEL { "no difference of the paths is seen" } else { "the paths differ" };
        let spread = match whole.length.spread {
            Some(s) => format!(
                ", and lengths vary {:.2} times as much as those of A ({:.2} to {:.2})",
                s.ratio, s.low, s.high
            ),
            None => String::new(),
        };
        let _ = writeln!(
            out,
            "{name}: half of the points of A lie within {} m of it (between halves of A: {} m); {alike} (energy test, p = {}){spread}.",
            brief(whole.clouds[0].median),
            brief(whole.halves.median),
            brief(whole.path.p)
        );
    }
    let near = |k: usize| found[k].whole.clouds[0].median;
    let best = (0..found.len()).min_by(|a, b| near(*a).total_cmp(&near(*b)));
    if let (Some(best), true) = (best, found.len() > 1) {
        let largest = rivals.iter().filter(|one| one.candidates.contains(&best)).map(|one| one.walks.p);
        let p = largest.fold(0.0, f64::max);
        let _ = writeln!(
            out,
            "{} is the nearest to A; against the others the signed rank test over the walks of A gives p = {} at most.",
            letter(best + 1),
            brief(p)
        );
    }
    out
}

fn row(out: &mut String, name: &str, cells: &[String]) {
    let cells: String = cells.iter().map(|cell| format!(" {cell:>9}")).collect();
    let _ = writeln!(out, "  {name:<24}{cells}");
}

fn heads(out: &mut String, title: &str, heads: &[&str]) {
    out.push('\n');
    row(out, title, &heads.iter().map(|head| (*head).to_owned()).collect::<Vec<_>>());
}

fn table(out: &mut String, b: char, found: &Comparison) {
    let sizes = found.length.sets.map(|set| count(set.count as u64));
    let name = found.leg.as_ref().map_or_else(|| "All walks".to_owned(), |leg| format!("Leg {leg}"));
    let _ = writeln!(out, "\n{name}: {} of A, {} of {b}", sizes[0], sizes[1]);
    heads(out, "nearest point (m)", &["mean", "median", "IQR", "95 %", "max"]);
    let clouds = [
        (format!("from {b} to A"), &found.clouds[1]),
        (format!("from A to {b}"), &found.clouds[0]),
        ("between halves of A".to_owned(), &found.halves),
    ];
    for (name, s) in clouds {
        row(out, &name, &[s.mean, s.median, s.iqr(), s.p95, s.max].map(brief));
    }
    heads(out, &format!("from A to {b}: normal law?"), &["KS D", "p"]);
    row(out, "", &[found.normality.d, found.normality.p].map(brief));
    let names = [format!("{b} median"), format!("{b} IQR")];
    heads(out, "each walk", &["A median", "A IQR", &names[0], &names[1], "KS D", "p"]);
    let measures = [("length (m)", &found.length), ("duration (s)", &found.duration)];
    for (name, Measure { sets: [a, b], test, .. }) in measures {
        row(out, name, &[a.median, a.iqr(), b.median, b.iqr(), test.d, test.p].map(brief));
    }
    heads(out, &format!("IQR of {b} / IQR of A"), &["ratio", "95 % interval"]);
    for (name, measure) in measures {
        let cells =
            |s: SpreadRatio| vec![format!("{:.2}", s.ratio), format!("{:.2} to {:.2}", s.low, s.high)];
        row(out, name, &measure.spread.map_or_else(|| vec!["undefined".to_owned()], cells));
    }
    heads(out, "energy distance (m)", &["distance", "p"]);
    for (name, test) in [("path", found.path), ("path and duration", found.pace)] {
        row(out, name, &[brief(test.distance), brief(test.p)]);
    }
    if measures.iter().any(|(_, measure)| measure.paired.is_some()) {
        heads(out, &format!("pairs, {b} - A"), &["pairs", "median", "W", "p"]);
    }
    for (name, measure) in measures {
        if let Some(test) = measure.paired {
            row(out, name, &[count(test.pairs as u64), brief(test.median), brief(test.w), brief(test.p)]);
        }
    }
}

/// One object; `docs/schema/walks.schema.json` describes it.
pub fn to_json(found: &[Comparisons], sets: &[WalkSet<'_>], seed: u64) -> String {
    let set =
        |set: &WalkSet<'_>| json!({ "file": set.file, "walks": set.walks.len(), "points": set.points() });
    let legs = |one: &Comparisons| one.legs.iter().map(comparison).collect::<Vec<_>>();
    let left_out = |one: &Comparisons| {
        let leg = |(leg, [a, b]): &(String, [usize; 2])| json!({ "leg": leg, "walks": { "a": a, "b": b } });
        one.left_out.iter().map(leg).collect::<Vec<_>>()
    };
    let other = |(one, b): (&Comparisons, &WalkSet<'_>)| json!({ "b": set(b), "all": comparison(&one.whole), "legs": legs(one), "legs_left_out": left_out(one) });
    let rival = |one: &Rivals| {
        let test = |test: SignedRank| json!({ "median_difference_m": test.median, "w": test.w, "p": test.p });
        json!({ "candidates": one.candidates, "points": test(one.points), "walks": test(one.walks) })
    };
    let first = &found[0];
    let mut all = json!({
        "schema": 1,
        "a": set(&sets[0]),
        "b": set(&sets[1]),
        "method": {
            "seed": seed,
            "permutations": SHUFFLES,
            "resamples": RESAMPLES,
            "confidence": CONFIDENCE,
            "path_points": POINTS,
            "energy_walks_at_most": MOST_WALKS,
        },
        "all": comparison(&first.whole),
        "legs": legs(first),
        "legs_left_out": left_out(first),
    });
    if found.len() > 1 {
        all["others"] = found.iter().zip(&sets[1..]).skip(1).map(other).collect();
        all["rivals"] = rivals_of(found, sets).iter().map(rival).collect();
    }
    format!("{all:#}\n")
}

/// All sets beside each other, with the barriers of a scenario (Agethen et al. 2018, Figure 8).
pub fn draw(scenario: Option<&Scenario>, sets: &[WalkSet<'_>]) -> Picture {
    let walks = |set: &WalkSet<'_>| set.walks.iter().map(|walk| walk.points.clone()).collect::<Vec<_>>();
    let all: Vec<Vec2> = sets.iter().flat_map(walks).flatten().collect();
    let panel = |(k, set): (usize, &WalkSet<'_>)| {
        let own = walks(set);
        let mut drawing = match scenario {
            Some(scenario) => plan::drawn(scenario, all.iter().copied()),
            None => Drawing::new(Bounds::around(all.iter().copied()).unwrap_or_default()),
        };
        corridor(&mut drawing, &own);
        let file = Path::new(set.file).file_stem().map_or(set.file.into(), |stem| stem.to_string_lossy());
        let role = if k == 0 { ", the base" } else { "" };
        (format!("{file}: {}{role}", counted(own.len() as u64, "walk")), drawing)
    };
    Picture::plans("Corridors of walks", sets.iter().enumerate().map(panel).collect())
}

fn summary(s: &Summary) -> Value {
    json!({
        "count": s.count,
        "mean": s.mean,
        "median": s.median,
        "quartiles": [s.low_quartile, s.high_quartile],
        "iqr": s.iqr(),
        "p95": s.p95,
        "max": s.max,
    })
}

fn comparison(found: &Comparison) -> Value {
    let energy = |test: EnergyTest| json!({ "distance_m": test.distance, "p": test.p });
    let measure = |measure: &Measure| {
        json!({
            "a": summary(&measure.sets[0]),
            "b": summary(&measure.sets[1]),
            "kolmogorov_smirnov": { "d": measure.test.d, "p": measure.test.p },
            // An infinite end has no number in JSON: it is null.
            "iqr_ratio": measure.spread.map(|s| json!({ "ratio": s.ratio, "low": s.low, "high": s.high })),
            "signed_rank": measure.paired.map(|test| json!({
                "pairs": test.pairs,
                "equal": test.equal,
                "median_difference": test.median,
                "w": test.w,
                "p": test.p,
            })),
        })
    };
    json!({
        "leg": found.leg,
        "normality": { "d": found.normality.d, "p": found.normality.p },
        "cloud_m": {
            "b_to_a": summary(&found.clouds[1]),
            "a_to_b": summary(&found.clouds[0]),
            "halves_of_a": summary(&found.halves),
        },
        "length_m": measure(&found.length),
        "duration_s": measure(&found.duration),
        "energy": { "path": energy(found.path), "path_and_duration": energy(found.pace) },
    })
}

/// One row for each point: its distance to the nearest point of the other set.
///
/// # Errors
/// Errors of the writer.
pub fn write_points(
    out: impl std::io::Write,
    found: &Comparison,
    sets: [WalkSet<'_>; 2],
) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let has_legs = sets.iter().any(|set| set.walks.iter().any(|walk| walk.leg.is_some()));
    let leg = |leg| has_legs.then_some(leg);
    table.write_record(["set", "walk"].into_iter().chain(leg("leg")).chain(["t", "x", "y", "distance"]))?;
    for ((name, set), distances) in ["A", "B"].into_iter().zip(sets).zip(&found.distances) {
        let mut distances = distances.iter();
        for walk in set.walks {
            for ((t, place), distance) in walk.times.iter().zip(&walk.points).zip(&mut distances) {
                let numbers = [*t, place.x, place.y, *distance].map(|number| number.to_string());
                let names =
                    [name, &walk.name].into_iter().chain(leg(walk.leg.as_deref().unwrap_or_default()));
                table.write_record(names.chain(numbers.iter().map(String::as_str)))?;
            }
        }
    }
    table.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::walks::read_walks;
    use crate::gait::compare::compare;

    const A: &str =
        "walk,leg,t,x,y\n1,in,0,0,0\n1,in,1,1,0\n2,in,0,0,1\n2,in,2,2,1\n3,out,0,0,0\n3,out,1,0,1\n";
    const B: &str = "walk,leg,t,x,y\n1,in,0,0,0.5\n1,in,1,1,0.5\n2,in,0,0,1.5\n2,in,3,3,1.5\n";

    fn shown(of: impl Fn(&[Comparisons], &[WalkSet<'_>]) -> String) -> String {
        let [a, b] = [A, B].map(|text| read_walks(text).unwrap());
        let found = compare(&a, &b, true, 0);
        of(&[found], &[WalkSet { file: "a.csv", walks: &a }, WalkSet { file: "b.csv", walks: &b }])
    }

    #[test]
    fn text_has_a_table_for_all_walks_and_each_leg() {
        let text = shown(to_text);
        for line in [
            "A  a.csv  (3 walks, 6 points)\nB  b.csv  (2 walks, 4 points)\n\nAll walks: 3 of A, 2 of B\n",
            "\nLeg in: 2 of A, 2 of B\n",
            "\n  nearest point (m)             mean    median       IQR      95 %       max\n",
            // Half a metre from each point but the last, which is 1 m farther along.
            "\n  from B to A                 0.6545       0.5    0.1545     1.025     1.118\n",
            "\n  length (m)                    2.00 ",
            "\nLeg out is not compared: A has 1 walk, B has 0.\n",
        ] {
            assert!(text.contains(line), "{line}\nin\n{text}");
        }
    }

    #[test]
    fn points_have_their_distances() {
        let table = shown(|found, sets| {
            let mut out = Vec::new();
            write_points(&mut out, &found[0].whole, [sets[0], sets[1]]).unwrap();
            String::from_utf8(out).unwrap()
        });
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[..2], ["set,walk,leg,t,x,y,distance", "A,1,in,0,0,0,0.5"]);
        assert_eq!((lines.len(), lines[6], lines[7]), (11, "A,3,out,1,0,1,0.5", "B,1,in,0,0,0.5,0.5"));
    }

    #[test]
    fn json_has_null_where_there_is_no_number() {
        let text = shown(|found, sets| to_json(found, sets, 7));
        let json: Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&json["method"]["seed"], &json["all"]["leg"]), (&7.into(), &Value::Null));
        assert_eq!(json["legs"][0]["leg"], "in");
        assert_eq!(json["legs"][0]["length_m"]["iqr_ratio"]["high"], Value::Null);
        assert_eq!(json["legs"][0]["length_m"]["signed_rank"]["pairs"], 2);
        assert_eq!(json["legs_left_out"][0]["walks"]["a"], 1);
    }
}
