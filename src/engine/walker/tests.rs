//! Random small chains and formulas: the cells are those of the general worker.

use super::super::worker::Worker;
use super::*;
use crate::compile::{Files, Input, compile};
use crate::syntax::parse::{parse_properties, parse_scenario};
use crate::syntax::source::{Source, SourceId};
use proptest::prelude::*;

/// The subject of a scenario with one question for each formula, and the columns of the questions.
fn subject(scenario: &str, formulas: &[String]) -> Subject {
    let questions: Vec<String> = formulas.iter().map(|f| format!("estimate P({f}) within 0.1\n")).collect();
    let sources =
        [Source::new(SourceId(0), "m.scn", scenario), Source::new(SourceId(1), "p.bltl", questions.concat())];
    let (scenario, _) = parse_scenario(&sources[0]);
    let (properties, _) = parse_properties(&sources[1]);
    let input = Input {
        sources: &sources,
        scenario: &scenario,
        properties: &[properties],
        files: &Files::default(),
        settings: &[],
    };
    let (study, faults) = compile(&input);
    Subject::new(&study.unwrap_or_else(|| panic!("{faults:?}")).worlds[0])
}

/// The cells of the trials, in order: how is 0 for the general worker, else the number of walkers.
fn cells(subject: &Subject, columns: &[usize], from: u64, count: u64, walkers: u64) -> (Vec<Cell>, u64) {
    let budget = Budget::new(u64::MAX, None);
    let items = Item::run(from, count);
    let mut out = vec![Cell::BLANK; items.len() * columns.len()];
    let mut steps = 0;
    for part in 0..walkers.max(1) {
        let mine = |place: &usize| *place as u64 % walkers.max(1) == part;
        let mut list = (0..items.len()).filter(mine).map(|place| (place, items[place]));
        let mut next = || list.next();
        let finished = if walkers == 0 {
            let mut worker = Worker::new(subject, columns).unwrap();
            let finished = worker.run(subject, 7, &mut next, &budget);
            steps += worker.steps;
            finished
        } else {
            let mut walker = Walker::of(subject, columns).unwrap();
            let finished = walker.run(subject, 7, &mut next, &budget);
            steps += walker.steps;
            finished
        };
        for (k, place) in finished.places.iter().enumerate() {
            let width = columns.len();
            out[place * width..][..width].copy_from_slice(&finished.cells[k * width..][..width]);
        }
    }
    (out, steps)
}

/// A process `name` of three states whose commands may look at the other one's state.
fn process(name: &str, other: &str, wish: &[(u8, u8, u8, bool)]) -> String {
    let commands: String = wish
        .iter()
        .enumerate()
        .map(|(s, (sevenths, a, b, looks))| {
            let (guard, p) = (if *looks { format!(" & {other}.s != 1") } else { String::new() }, sevenths);
            format!("  when s == {s}{guard} -> {p}/7: s = {a} | {}/7: {{ s = {b}; u = !u }}\n", 7 - p)
        })
        .collect();
    format!("process {name} {{\n  var s: -1 .. 2 = 0\n  var u: bool = false\n{commands}}}\n")
}

fn state() -> impl Strategy<Value = String> {
    let atom = prop_oneof![
        (0..3u8).prop_map(|k| format!("a.s == {k}")),
        (0..3u8).prop_map(|k| format!("b.s + a.s > {k}")),
        Just("a.u".to_owned()),
        Just("!(b.u)".to_owned()),
    ];
    (atom.clone(), atom, 0..3u8).prop_map(|(x, y, how)| match how {
        0 => x,
        1 => format!("({x} & {y})"),
        _ => format!("({x} | {y})"),
    })
}

fn formula() -> impl Strategy<Value = String> {
    #[allow(clippy::match_bool, reason = "both cases are of one kind")]
    let window = (0..4u8, 0..6u8, any::<bool>()).prop_map(|(from, more, ends)| match ends {
        true => format!("[#{from}, #{}]", from + more),
        false => String::new(),
    });
    (state(), state(), window, 0..5u8).prop_map(|(x, y, w, how)| match how {
        0 => format!("F{w} ({x})"),
        1 => format!("G{w} ({x})"),
        2 => format!("!(G{w} ({x}))"),
        3 => format!("!(({x}) U{w} ({y}))"),
        _ => format!("({x}) U{w} ({y})"),
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn cells_are_those_of_the_general_worker(
        a in prop::collection::vec((1..7u8, 0..3u8, 0..3u8, any::<bool>()), 3),
        b in prop::collection::vec((1..7u8, 0..3u8, 0..3u8, any::<bool>()), 3),
        formulas in prop::collection::vec(formula(), 1..4),
        from in prop_oneof![Just(0u64), Just((1 << 32) - 5)],
    ) {
        let scenario =
            format!("scenario \"t\"\nhorizon = 12 steps\n{}{}", process("a", "b", &a), process("b", "a", &b));
        let subject = subject(&scenario, &formulas);
        let all: Vec<usize> = (0..subject.columns.len()).collect();
        let fits = |column: &usize| Walker::of(&subject, &[*column]).is_some();
        let columns: Vec<usize> = all.into_iter().filter(fits).collect();
        prop_assume!(!columns.is_empty());
        let (general, steps) = cells(&subject, &columns, from, 21, 0);
        for walkers in [1, 3] {
            prop_assert_eq!(&cells(&subject, &columns, from, 21, walkers), &(general.clone(), steps));
        }
    }
}

const COIN: &str = "scenario \"t\"\nhorizon = 9 steps\nprocess c {\n  var s: 0 .. 2 = 0\n\
                    when s < 2 -> 1/2: s = s + 1 | 1/2: s = s\n}\n";

#[test]
fn common_shapes_take_the_chain_and_others_do_not() {
    let fits =
        |scenario: &str, formula: &str| Walker::of(&subject(scenario, &[formula.to_owned()]), &[0]).is_some();
    for formula in ["F<=#5 c.s == 2", "G (c.s < 2)", "(c.s < 2) U[#1, #4] (c.s == 1)", "!(F (c.s == 2))"] {
        assert!(fits(COIN, formula), "{formula}");
    }
    // Windows inside windows, what the first state decides, watched implications.
    for formula in ["F<=#4 G<=#2 c.s == 1", "c.s == 0", "F<=#5 c.s == 0", "G (c.s == 1 => c.s < 2)"] {
        assert!(!fits(COIN, formula), "{formula}");
    }
    // A variable without end.
    assert!(!fits(
        &COIN.replace("var s: 0 .. 2 = 0", "var s: 0 .. 2 = 0\nvar r: real = 0"),
        "F<=#5 c.s == 2"
    ));
}

#[test]
fn a_walk_stops_when_told() {
    let subject = subject(COIN, &["F c.s == 2".to_owned()]);
    let mut walker = Walker::of(&subject, &[0]).unwrap();
    let budget = Budget::new(u64::MAX, Some(std::time::Duration::ZERO));
    let mut index = 0;
    let mut endless = || {
        index += 1;
        Some((0, Item { advice: None, index }))
    };
    walker.run(&subject, 7, &mut endless, &budget);
    assert!(walker.steps <= u64::from(CLOCK_EVERY) * LANES as u64);
}
