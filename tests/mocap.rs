//! Steps of real recordings against the yardstick of their table.
//!
//! The recordings may not be shipped. They are looked for in the folder that `SMC_DATA` names, else beside
//! the checkout; where they are absent the test says so and passes.

use smc::data::mocap::{Asf, Take, TakeRow, read_take_table, read_takes};
use smc::gait::RecordedStep;
use smc::gait::model::{Method, Options, fit, score};
use smc::gait::steps::{Contact, Dropped, cut, report};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of the recordings.
pub(super) fn folder() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folders = std::env::var_os("SMC_DATA").map(PathBuf::from).into_iter().chain([beside]);
    let found = folders
        .flat_map(|folder| [folder.join("mocap"), folder.join("../mocap")])
        .find(|folder| folder.join("takes.csv").exists());
    if found.is_none() {
        // Written past the harness, which would hide what a passing test prints.
        let said = "SKIPPED: mocap/takes.csv is not here; set SMC_DATA to the folder of the recordings\n";
        let _ = std::io::stderr().write_all(said.as_bytes());
    }
    found
}

pub(super) fn text(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The takes of the rows, in their order.
pub(super) fn takes(folder: &Path, rows: &[TakeRow]) -> Vec<Take> {
    let mut files: Vec<&str> = rows.iter().map(|row| row.file.as_str()).collect();
    files.sort_unstable();
    files.dedup();
    let mut takes = Vec::new();
    for file in files {
        let rows: Vec<TakeRow> = rows.iter().filter(|row| row.file == file).cloned().collect();
        let skeleton = file.rsplit_once('.').filter(|(_, kind)| *kind == "amc").map(|_| {
            let (subject, _) = file.rsplit_once('_').expect("takes have a number");
            Asf::read(&text(folder, &format!("{subject}.asf"))).expect("the skeleton is well formed")
        });
        let read = read_takes(file, &text(folder, file), skeleton.as_ref(), None, &rows);
        takes.extend(read.unwrap_or_else(|errors| panic!("{file}: {}", errors[0])));
    }
    let at = |take: &Take| rows.iter().position(|row| row.name == take.name);
    takes.sort_by_key(at);
    takes
}

fn mean(steps: &[RecordedStep]) -> f64 {
    steps.iter().map(|step| step.shape.curve().length()).sum::<f64>() / steps.len() as f64
}

#[test]
fn real_walks_are_cut_as_their_table_says() {
    let Some(folder) = folder() else { return };
    let table = text(&folder, "takes.csv");
    let rows = read_take_table(&table).expect("the table is well formed");
    let takes = takes(&folder, &rows);
    assert_eq!((rows.len(), takes.len()), (318, 318));
    let mut table = csv::Reader::from_reader(table.as_bytes());
    let columns = ["frames", "steps", "mean_step_length_m"];
    let columns =
        columns.map(|name| table.headers().unwrap().iter().position(|field| field == name).unwrap());
    let wanted: Vec<[f64; 3]> =
        table.records().map(|row| columns.map(|k| row.as_ref().unwrap()[k].parse().unwrap())).collect();
    for contact in [Contact::Rest, Contact::Adaptive] {
        let cuts: Vec<_> = takes.iter().map(|take| cut(take, contact)).collect();
        let (mut near, mut all, mut steps) = (0, 0, Vec::new());
        for ((take, cut), [frames, count, _]) in takes.iter().zip(&cuts).zip(&wanted) {
            assert_eq!(take.root.len() as f64, *frames, "{}", take.name);
            let cut = cut.as_ref().unwrap_or_else(|none| panic!("{none}"));
            // The yardstick counts a step whose begin may lie before the take; its path is not whole and it is dropped here.
            let seen = cut.steps.len() + cut.dropped.get(&Dropped::Begun).copied().unwrap_or_default();
            near += usize::from((seen as f64 - count).abs() <= 2.0);
            all += seen;
            steps.extend(cut.steps.iter().cloned());
        }
        let expected: f64 = wanted.iter().map(|[_, count, _]| count).sum();
        let length = wanted.iter().map(|[_, count, length]| count * length).sum::<f64>() / expected;
        let said = report(&cuts);
        let said = format!(
            "{contact:?}: {near} of 318 takes within two steps, {all} of {expected} steps, {:.3} of {length:.3} m\n{}",
            mean(&steps),
            said.lines().last().unwrap_or_default()
        );
        println!("{said}");
        assert!(near as f64 >= 0.95 * 318.0, "{said}");
        assert!((all as f64 / expected - 1.0).abs() < 0.03, "{said}");
        assert!((mean(&steps) - length).abs() < 0.02, "{said}");
        if contact == Contact::Rest {
            for name in ["07_01", "08_01"] {
                let of = |file: String| {
                    let at = takes.iter().position(|take| take.name == file).expect("the take is there");
                    cuts[at].as_ref().map(|cut| (cut.steps.len(), mean(&cut.steps))).expect("it has steps")
                };
                let (amc, bvh) =
                    (of(format!("cmu-asfamc/{}/{name}.amc", &name[..2])), of(format!("cmu-bvh/{name}.bvh")));
                assert_eq!(amc.0, bvh.0, "{name}");
                assert!((amc.1 / bvh.1 - 1.0).abs() < 0.03, "{name}: {amc:?} {bvh:?}");
            }
        }
    }
}

#[test]
fn clips_in_two_formats_are_the_same_takes() {
    let Some(folder) = folder() else { return };
    let clips = read_takes(
        "normal.csv",
        &text(&folder, "bandai-namco-2/normal.csv"),
        None,
        Some(&smc::data::mocap::Layout {
            fps: Some(30.0),
            ..smc::data::mocap::Layout::named("csv").expect("the preset exists")
        }),
        &[],
    )
    .expect("the table is well formed");
    for name in ["walk_normal_001", "walk-turn-left_normal_002", "walk-turn-right_normal_003"] {
        let file = format!("{name}.bvh");
        let bvh = read_takes(&file, &text(&folder, &format!("bandai-namco-2/bvh/{file}")), None, None, &[]);
        let bvh = bvh.unwrap_or_else(|errors| panic!("{file}: {}", errors[0])).remove(0);
        let clip = clips.iter().find(|clip| clip.name == name).expect("the clip is there");
        assert_eq!(bvh.root.len(), clip.root.len());
        // The table has millimetres.
        assert!(bvh.root.iter().zip(&clip.root).all(|(a, b)| (a - b).norm() < 1e-3), "{name}");
        for (a, b) in bvh.feet.iter().zip(&clip.feet) {
            let same = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-3);
            assert!(a.ankle.iter().zip(&b.ankle).all(same) && a.toe.iter().zip(&b.toe).all(same), "{name}");
        }
    }
}

/// Subjects of CMU that are held out.
const HELD_OUT: [&str; 8] = ["06", "12", "26", "29", "32", "38", "45", "46"];

/// Fitting takes long: `cargo test --release --test suite mocap:: -- --ignored`
#[test]
#[ignore = "takes a minute, and needs the recordings"]
fn held_out_steps_are_predicted() {
    let Some(folder) = folder() else { return };
    let rows = read_take_table(&text(&folder, "takes.csv")).expect("the table is well formed");
    let takes = takes(&folder, &rows);
    let mut styles = std::collections::BTreeMap::<&str, Vec<&str>>::new();
    for row in rows.iter().filter(|row| row.subject.is_empty()) {
        styles.entry(&row.file).or_default().push(&row.name);
    }
    for names in styles.values_mut() {
        names.sort_unstable();
    }
    let is_held = |row: &TakeRow| match styles.get(row.file.as_str()) {
        Some(names) => names.iter().position(|name| **name == *row.name).is_some_and(|k| k % 5 == 4),
        None => HELD_OUT.contains(&row.subject.as_str()),
    };
    let (mut learned, mut held_out) = (Vec::new(), Vec::new());
    for (row, take) in rows.iter().zip(&takes) {
        let mut steps = cut(take, Contact::Rest).map_or_else(|_| Vec::new(), |cut| cut.steps);
        for step in steps.iter_mut().filter(|step| step.subject.is_empty()) {
            step.subject.clone_from(&row.file);
        }
        if is_held(row) { held_out.extend(steps) } else { learned.extend(steps) }
    }
    let scores = |method: Method| {
        let options = Options { method, ..Options::default() };
        score(&fit(&learned, &options).expect("there are enough pairs").0, &held_out)
    };
    let (sparse, exact) = (scores(Method::Sparse), scores(Method::Exact));
    println!("sparse {sparse:?}\nexact {exact:?}");
    assert!((sparse.nlpd - exact.nlpd).abs() < 0.01, "{sparse:?} {exact:?}");
    for covered in [sparse.coverage.length, sparse.coverage.turn, sparse.coverage.duration] {
        assert!((0.86..0.94).contains(&covered), "{sparse:?}");
    }
}
