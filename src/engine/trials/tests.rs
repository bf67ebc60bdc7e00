//! Random small chains and formulas: the cells are those of the general batch.

use crate::compile::{Files, Input, compile};
use crate::engine::trials::prepared::PreparedWorld;
use crate::syntax::parse::{parse_properties, parse_scenario};
use crate::syntax::source::{Source, SourceId};
use crate::trials::budget::Budget;
use crate::trials::cell::{Block, Cell, Item, Reading};
use crate::trials::runner::Runner;
use proptest::prelude::*;

/// The prepared world of a scenario with one question for each formula, and the columns of the questions.
pub(in crate::engine) fn prepared(scenario: &str, formulas: &[String]) -> PreparedWorld {
    let questions: Vec<String> = formulas.iter().map(|f| format!("estimate P({f}) within 0.1\n")).collect();
    asked(scenario, &questions.concat())
}

/// The prepared world of a scenario with the queries of a property file.
pub(in crate::engine) fn asked(scenario: &str, properties: &str) -> PreparedWorld {
    let sources =
        [Source::new(SourceId(0), "m.scn", scenario), Source::new(SourceId(1), "p.bltl", properties)];
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
    PreparedWorld::new(&study.unwrap_or_else(|| panic!("{faults:?}")).worlds[0])
}

/// The cells of the trials, in order, and the steps or jumps made: by the general batch, or by a chain in blocks of so many
/// trials.
fn cells(
    prepared: &PreparedWorld,
    columns: &[usize],
    (from, seed): (u64, u64),
    count: u64,
    size: Option<usize>,
) -> (Vec<Cell>, u64) {
    let budget = Budget::new(u64::MAX, None);
    let items = Item::run(from, count);
    let width = columns.len();
    let mut out = vec![Cell::BLANK; items.len() * width];
    let mut runner = Runner::new(prepared, columns).unwrap();
    if let Some(size) = size {
        assert!(runner.takes_blocks());
        for (items, cells) in items.chunks(size).zip(out.chunks_mut(size * width)) {
            let mut finished = vec![false; items.len()];
            runner.run_block(seed, &mut Block { items, cells, finished: &mut finished }, &budget);
            assert!(finished.iter().all(|finished| *finished));
        }
    } else {
        runner = Runner::general(prepared, columns).unwrap();
        let mut list = items.iter().copied().enumerate();
        let finished = runner.run(seed, &mut || list.next(), &budget);
        for (k, place) in finished.places.iter().enumerate() {
            out[place * width..][..width].copy_from_slice(&finished.cells[k * width..][..width]);
        }
    }
    let steps = runner.take_steps();
    (out, steps)
}

/// Whether a chain takes the question about a formula.
fn fits(scenario: &str, formula: &str) -> bool {
    Runner::new(&prepared(scenario, &[formula.to_owned()]), &[0]).unwrap().takes_blocks()
}

/// The columns of a prepared world that a chain takes have the same cells in it, in blocks of any size.
fn same(prepared: &PreparedWorld, (from, seed): (u64, u64)) -> Result<(), TestCaseError> {
    let takes = |column: &usize| Runner::new(prepared, &[*column]).unwrap().takes_blocks();
    let columns: Vec<usize> = (0..prepared.columns.len()).filter(takes).collect();
    prop_assume!(!columns.is_empty());
    let general = cells(prepared, &columns, (from, seed), 21, None);
    for size in [21, 8, 3] {
        prop_assert_eq!(&cells(prepared, &columns, (from, seed), 21, Some(size)), &general);
    }
    Ok(())
}

/// A process `name` of three states whose commands may look at the other one's state.
fn steps(name: &str, other: &str, wish: &[(u8, u8, u8, bool)]) -> String {
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

/// A command of a random process with rates: from which state, its rate, how a coin of sevenths moves the state, and whether
/// it looks at `u`.
type Wish = (u8, u8, u8, u8, u8, bool);

fn rates(commands: &[Wish]) -> String {
    let commands: String = commands
        .iter()
        .map(|(s, rate, sevenths, a, b, looks)| {
            let guard = if *looks { " & u" } else { "" };
            let other = 7 - sevenths;
            format!(
                "  when s == {s}{guard} at {rate} /s -> {sevenths}/7: s = {a} | {other}/7: {{ s = {b}; u = !u }}\n"
            )
        })
        .collect();
    format!(
        "scenario \"t\"\nhorizon = 4 s\nprocess p {{\n  var s: -1 .. 3 = 0\n  var u: bool = true\n{commands}}}\n"
    )
}

/// A formula of two states and a window.
fn formula(
    state: impl Strategy<Value = String> + Clone,
    window: impl Strategy<Value = String>,
    kinds: u8,
) -> impl Strategy<Value = String> {
    (state.clone(), state, window, 0..kinds).prop_map(|(x, y, w, how)| match how {
        0 => format!("F{w} ({x})"),
        1 => format!("G{w} ({x})"),
        2 => format!("!(G{w} ({x}))"),
        3 => format!("!(({x}) U{w} ({y}))"),
        4 => format!("({x}) U{w} ({y})"),
        _ => format!("({x}) W{w} ({y})"),
    })
}

fn formula_of_steps() -> impl Strategy<Value = String> {
    let atom = prop_oneof![
        (0..3u8).prop_map(|k| format!("a.s == {k}")),
        (0..3u8).prop_map(|k| format!("b.s + a.s > {k}")),
        Just("a.u".to_owned()),
        Just("!(b.u)".to_owned()),
    ];
    let state = (atom.clone(), atom, 0..3u8).prop_map(|(x, y, how)| match how {
        0 => x,
        1 => format!("({x} & {y})"),
        _ => format!("({x} | {y})"),
    });
    #[allow(clippy::match_bool, reason = "both cases are of one kind")]
    let window = (0..4u8, 0..6u8, any::<bool>()).prop_map(|(from, more, ends)| match ends {
        true => format!("[#{from}, #{}]", from + more),
        false => String::new(),
    });
    formula(state.boxed(), window, 5)
}

fn formula_of_jumps() -> impl Strategy<Value = String> {
    let state = prop_oneof![
        (0..4u8).prop_map(|k| format!("p.s == {k}")),
        (0..4u8).prop_map(|k| format!("p.s > {k} | p.u")),
        (0..4u8).prop_map(|k| format!("p.s < {k} & !(p.u)")),
    ];
    let window = (0..4u8, 0..4u8, 0..3u8).prop_map(|(from, more, how)| match how {
        0 => String::new(),
        1 => format!("[{}.{from} s, {}.5 s]", from / 2, from / 2 + more.min(2)),
        _ => format!("<={more}.25 s"),
    });
    formula(state.boxed(), window, 6)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn cells_of_a_chain_of_steps_are_those_of_the_general_batch(
        a in prop::collection::vec((1..7u8, 0..3u8, 0..3u8, any::<bool>()), 3),
        b in prop::collection::vec((1..7u8, 0..3u8, 0..3u8, any::<bool>()), 3),
        formulas in prop::collection::vec(formula_of_steps(), 1..4),
        from in prop_oneof![Just(0u64), Just((1 << 32) - 5)],
        seed in any::<u64>(),
    ) {
        let processes = steps("a", "b", &a) + &steps("b", "a", &b);
        let prepared = prepared(&format!("scenario \"t\"\nhorizon = 12 steps\n{processes}"), &formulas);
        same(&prepared, (from, seed))?;
    }

    #[test]
    fn cells_of_a_chain_of_jumps_are_those_of_the_general_batch(
        commands in prop::collection::vec((0..4u8, 0..9u8, 1..7u8, 0..4u8, 0..4u8, any::<bool>()), 3..9),
        formulas in prop::collection::vec(formula_of_jumps(), 1..4),
        from in prop_oneof![Just(0u64), Just((1 << 32) - 5)],
        seed in any::<u64>(),
        most in prop_oneof![Just(6u64), Just(1 << 20)],
    ) {
        let mut prepared = prepared(&rates(&commands), &formulas);
        prepared.setup.most_jumps = most;
        same(&prepared, (from, seed))?;
    }
}

const COIN: &str = "scenario \"t\"\nhorizon = 9 steps\nprocess c {\n  var s: 0 .. 2 = 0\n\
                    when s < 2 -> 1/2: s = s + 1 | 1/2: s = s\n}\n";

#[test]
fn small_processes_with_steps_take_the_chain_and_others_do_not() {
    for formula in ["F<=#5 c.s == 2", "G (c.s < 2)", "(c.s < 2) U[#1, #4] (c.s == 1)", "!(F (c.s == 2))"] {
        assert!(fits(COIN, formula), "{formula}");
    }
    // Windows inside windows, what the first state decides, watched implications.
    for formula in ["F<=#4 G<=#2 c.s == 1", "c.s == 0", "F<=#5 c.s == 0", "G (c.s == 1 => c.s < 2)"] {
        assert!(!fits(COIN, formula), "{formula}");
    }
    // A variable with infinitely many values.
    let real = COIN.replace("var s: 0 .. 2 = 0", "var s: 0 .. 2 = 0\nvar r: real = 0");
    assert!(!fits(&real, "F<=#5 c.s == 2"));
}

const QUEUE: &str = "scenario \"t\"\nhorizon = 20 s\nprocess q {\n  var n: 0 .. 3 = 0\n\
                     when n < 3 at 2 /s -> n = n + 1\n  when n > 0 at 3 /s -> n = n - 1\n}\n";

#[test]
fn one_small_process_with_rates_takes_the_chain_and_others_do_not() {
    for formula in ["F<=5 s q.n == 3", "G (q.n < 3)", "(q.n < 3) U[1 s, 4 s] (q.n == 1)", "!(F (q.n == 2))"] {
        assert!(fits(QUEUE, formula), "{formula}");
    }
    // Windows inside windows, watched implications.
    for formula in ["F<=4 s G<=2 s q.n == 1", "G (q.n == 1 => q.n < 2)"] {
        assert!(!fits(QUEUE, formula), "{formula}");
    }
    // A second process, a delay, a variable with infinitely many values, rates beyond all measure.
    let second = "process r {\n  var m: 0 .. 1 = 0\n  when m == 0 at 1 /s -> m = 1\n}\n";
    let scenarios = [
        format!("{QUEUE}{second}"),
        QUEUE.replace("at 3 /s", "after 1 s"),
        QUEUE.replace("= 0\n", "= 0\nvar r: real = 0\n"),
        QUEUE.replace("at 3 /s", "at 1000000000000000 /s"),
    ];
    for scenario in scenarios {
        assert!(!fits(&scenario, "F<=5 s q.n == 2"), "{scenario}");
    }
}

/// The cells in one block are those of the general batch, with the plainest vectors of the machine too.
fn same_in_one_block(mut prepared: PreparedWorld, columns: &[usize], count: u64) -> Vec<Cell> {
    let general = cells(&prepared, columns, (0, 3), count, None);
    assert_eq!(cells(&prepared, columns, (0, 3), count, Some(1024)), general);
    prepared.setup.program.processes = prepared.program.processes.clone().at_baseline();
    assert_eq!(cells(&prepared, columns, (0, 3), count, Some(1024)), general);
    general.0
}

#[test]
fn a_state_that_is_never_left_decides_at_its_tick() {
    // After two heads nothing happens any more; windows end before and after that.
    let formulas = ["F[#3, #7] c.s == 2", "F c.s == 3", "G<=#6 (c.s < 3)", "(c.s < 3) U[#8, #9] (c.s == 2)"];
    let scenario = COIN.replace("0 .. 2", "0 .. 3");
    let prepared = prepared(&scenario, &formulas.map(str::to_owned));
    let cells = same_in_one_block(prepared, &[0, 1, 2, 3], 300);
    let ticks = |column: usize| cells.iter().skip(column).step_by(4).map(|cell| cell.steps).max();
    assert_eq!([0, 1, 2, 3].map(ticks), [Some(7), Some(9), Some(6), Some(9)]);
}

#[test]
fn a_long_block_is_a_block_of_its_trials() {
    let formulas = ["F<=5 s q.n == 3", "(q.n < 3) U[1 s, 4 s] (q.n == 1)"].map(str::to_owned);
    let cells = same_in_one_block(prepared(QUEUE, &formulas), &[0, 1], 2000);
    assert!(cells.iter().any(|cell| cell.reading == Reading::Truth(false)));
}

#[test]
fn a_chain_stops_at_the_end_of_its_budget() {
    for (scenario, formula) in [(COIN, "F c.s == 2"), (QUEUE, "F q.n == 3")] {
        let prepared = prepared(scenario, &[formula.to_owned()]);
        let mut runner = Runner::new(&prepared, &[0]).unwrap();
        let items = Item::run(0, 100);
        let (mut cells, mut finished) = (vec![Cell::BLANK; 100], vec![false; 100]);
        let mut run = |budget: &Budget| {
            finished.fill(false);
            runner.run_block(
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
}
