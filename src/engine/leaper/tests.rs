//! Random small processes with rates and formulas: the cells are those of the jumper.

use super::super::cell::{Item, Reading};
use super::super::runner::Runner;
use super::super::walker::tests::subject;
use super::*;
use proptest::prelude::*;

/// The cells of the trials, in order, and the jumps made: by the jumper, or by a leaper in blocks of so many trials.
fn cells(
    subject: &Subject,
    columns: &[usize],
    (from, seed): (u64, u64),
    count: u64,
    size: Option<usize>,
) -> (Vec<Cell>, u64) {
    let budget = Budget::new(u64::MAX, None);
    let items = Item::run(from, count);
    let width = columns.len();
    let mut out = vec![Cell::BLANK; items.len() * width];
    if let Some(size) = size {
        let mut leaper = Leaper::of(subject, columns).unwrap();
        for (items, cells) in items.chunks(size).zip(out.chunks_mut(size * width)) {
            let mut finished = vec![false; items.len()];
            leaper.run(subject, seed, &mut Block { items, cells, finished: &mut finished }, &budget);
            assert!(finished.iter().all(|finished| *finished));
        }
        return (out, leaper.steps);
    }
    let mut list = items.iter().copied().enumerate();
    let mut runner = Runner::general(subject, columns).unwrap();
    let finished = runner.run(seed, &mut || list.next(), &budget);
    for (k, place) in finished.places.iter().enumerate() {
        out[place * width..][..width].copy_from_slice(&finished.cells[k * width..][..width]);
    }
    (out, runner.take_steps())
}

/// A command of a random process: from which state, its rate, how a coin of sevenths moves the state, and whether
/// it looks at `u`.
type Wish = (u8, u8, u8, u8, u8, bool);

fn process(commands: &[Wish]) -> String {
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

fn formula() -> impl Strategy<Value = String> {
    let state = prop_oneof![
        (0..4u8).prop_map(|k| format!("(p.s == {k})")),
        (0..4u8).prop_map(|k| format!("(p.s > {k} | p.u)")),
        (0..4u8).prop_map(|k| format!("(p.s < {k} & !(p.u))")),
    ];
    let window = (0..4u8, 0..4u8, 0..3u8).prop_map(|(from, more, how)| match how {
        0 => String::new(),
        1 => format!("[{}.{from} s, {}.5 s]", from / 2, from / 2 + more.min(2)),
        _ => format!("<={more}.25 s"),
    });
    (state.clone(), state, window, 0..6u8).prop_map(|(x, y, w, how)| match how {
        0 => format!("F{w} {x}"),
        1 => format!("G{w} {x}"),
        2 => format!("!(G{w} {x})"),
        3 => format!("!({x} U{w} {y})"),
        4 => format!("{x} W{w} {y}"),
        _ => format!("{x} U{w} {y}"),
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn cells_are_those_of_the_jumper(
        commands in prop::collection::vec((0..4u8, 0..9u8, 1..7u8, 0..4u8, 0..4u8, any::<bool>()), 3..9),
        formulas in prop::collection::vec(formula(), 1..4),
        from in prop_oneof![Just(0u64), Just((1 << 32) - 5)],
        seed in any::<u64>(),
        most in prop_oneof![Just(6u64), Just(1 << 20)],
    ) {
        let mut subject = subject(&process(&commands), &formulas);
        subject.most_jumps = most;
        let all: Vec<usize> = (0..subject.columns.len()).collect();
        let fits = |column: &usize| Leaper::of(&subject, &[*column]).is_some();
        let columns: Vec<usize> = all.into_iter().filter(fits).collect();
        prop_assume!(!columns.is_empty());
        let general = cells(&subject, &columns, (from, seed), 21, None);
        for size in [21, 8, 3] {
            prop_assert_eq!(&cells(&subject, &columns, (from, seed), 21, Some(size)), &general);
        }
    }
}

const QUEUE: &str = "scenario \"t\"\nhorizon = 20 s\nprocess q {\n  var n: 0 .. 3 = 0\n\
                     when n < 3 at 2 /s -> n = n + 1\n  when n > 0 at 3 /s -> n = n - 1\n}\n";

#[test]
fn one_small_process_takes_the_chain_and_others_do_not() {
    let fits =
        |scenario: &str, formula: &str| Leaper::of(&subject(scenario, &[formula.to_owned()]), &[0]).is_some();
    for formula in ["F<=5 s q.n == 3", "G (q.n < 3)", "(q.n < 3) U[1 s, 4 s] (q.n == 1)", "!(F (q.n == 2))"] {
        assert!(fits(QUEUE, formula), "{formula}");
    }
    // Windows inside windows, watched implications.
    for formula in ["F<=4 s G<=2 s q.n == 1", "G (q.n == 1 => q.n < 2)"] {
        assert!(!fits(QUEUE, formula), "{formula}");
    }
    // A second process, a delay, a variable without end, rates without measure.
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

#[test]
fn a_long_block_is_a_block_of_its_trials() {
    let formulas = ["F<=5 s q.n == 3", "(q.n < 3) U[1 s, 4 s] (q.n == 1)"].map(str::to_owned);
    let subject = subject(QUEUE, &formulas);
    let general = cells(&subject, &[0, 1], (0, 3), 2000, None);
    assert_eq!(cells(&subject, &[0, 1], (0, 3), 2000, Some(1024)), general);
    assert!(general.0.iter().any(|cell| cell.reading == Reading::Truth(false)));
    let plain = {
        let mut plain = subject;
        plain.program.processes = plain.program.processes.clone().at_baseline();
        plain
    };
    assert_eq!(cells(&plain, &[0, 1], (0, 3), 2000, Some(1024)), general);
}

#[test]
fn leaps_stop_when_told() {
    let subject = subject(QUEUE, &["F q.n == 3".to_owned()]);
    let mut leaper = Leaper::of(&subject, &[0]).unwrap();
    let items = Item::run(0, 100);
    let (mut cells, mut finished) = (vec![Cell::BLANK; 100], vec![false; 100]);
    let mut run = |budget: &Budget| {
        finished.fill(false);
        let mut block = Block { items: &items, cells: &mut cells, finished: &mut finished };
        leaper.run(&subject, 7, &mut block, budget);
        finished.iter().filter(|finished| **finished).count()
    };
    assert_eq!(run(&Budget::new(u64::MAX, Some(std::time::Duration::ZERO))), 0);
    assert_eq!(run(&Budget::new(u64::MAX, None)), 100);
    let interrupted = Budget::new(u64::MAX, None);
    interrupted.interrupt();
    assert_eq!(run(&interrupted), 0);
}
