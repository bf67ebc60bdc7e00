//! Random small chains and formulas: the cells are those of the general worker.

use super::super::cell::Item;
use super::super::runner::Runner;
use super::*;
use crate::compile::{Files, Input, compile};
use crate::syntax::parse::{parse_properties, parse_scenario};
use crate::syntax::source::{Source, SourceId};
use proptest::prelude::*;

/// The subject of a scenario with one question for each formula, and the columns of the questions.
pub(in crate::engine) fn subject(scenario: &str, formulas: &[String]) -> Subject {
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

/// The cells of the trials, in order, and the steps made: by the general worker, or by a walker in blocks of so many
/// trials.
fn cells(
    subject: &Subject,
    columns: &[usize],
    from: u64,
    count: u64,
    size: Option<usize>,
) -> (Vec<Cell>, u64) {
    let budget = Budget::new(u64::MAX, None);
    let items = Item::run(from, count);
    let width = columns.len();
    let mut out = vec![Cell::BLANK; items.len() * width];
    if let Some(size) = size {
        let mut walker = Walker::of(subject, columns).unwrap();
        for (items, cells) in items.chunks(size).zip(out.chunks_mut(size * width)) {
            let mut finished = vec![false; items.len()];
            walker.run(subject, 7, &mut Block { items, cells, finished: &mut finished }, &budget);
            assert!(finished.iter().all(|finished| *finished));
        }
        return (out, walker.steps);
    }
    let mut list = items.iter().copied().enumerate();
    let mut worker = Runner::general(subject, columns).unwrap();
    let finished = worker.run(7, &mut || list.next(), &budget);
    for (k, place) in finished.places.iter().enumerate() {
        out[place * width..][..width].copy_from_slice(&finished.cells[k * width..][..width]);
    }
    (out, worker.take_steps())
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
        let general = cells(&subject, &columns, from, 21, None);
        for size in [21, 8, 3] {
            prop_assert_eq!(&cells(&subject, &columns, from, 21, Some(size)), &general);
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
fn a_state_that_is_never_left_decides_at_its_tick() {
    // After two heads nothing happens any more; windows end before and after that.
    let formulas = ["F[#3, #7] c.s == 2", "F c.s == 3", "G<=#6 (c.s < 3)", "(c.s < 3) U[#8, #9] (c.s == 2)"];
    let scenario = COIN.replace("0 .. 2", "0 .. 3");
    let subject = subject(&scenario, &formulas.map(str::to_owned));
    let columns: Vec<usize> = (0..formulas.len()).collect();
    let general = cells(&subject, &columns, 0, 300, None);
    assert_eq!(cells(&subject, &columns, 0, 300, Some(300)), general);
    let ticks = |column: usize| general.0.iter().skip(column).step_by(4).map(|cell| cell.steps).max();
    assert_eq!([0, 1, 2, 3].map(ticks), [Some(7), Some(9), Some(6), Some(9)]);
    let mut plain = subject;
    plain.program.processes = plain.program.processes.clone().at_baseline();
    assert_eq!(cells(&plain, &columns, 0, 300, Some(300)), general);
}

#[test]
fn a_walk_stops_when_told() {
    let subject = subject(COIN, &["F c.s == 2".to_owned()]);
    let mut walker = Walker::of(&subject, &[0]).unwrap();
    let items = Item::run(0, 100);
    let (mut cells, mut finished) = (vec![Cell::BLANK; 100], vec![false; 100]);
    let mut run = |budget: &Budget| {
        finished.fill(false);
        walker.run(
            &subject,
            7,
            &mut Block { items: &items, cells: &mut cells, finished: &mut finished },
            budget,
        );
        finished.iter().filter(|finished| **finished).count()
    };
    assert_eq!(run(&Budget::new(u64::MAX, Some(std::time::Duration::ZERO))), 0);
    assert_eq!(run(&Budget::new(u64::MAX, None)), 100);
    let interrupted = Budget::new(u64::MAX, None);
    interrupted.interrupt();
    assert_eq!(run(&interrupted), 0);
}
