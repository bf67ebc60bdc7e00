//! The cap of jumps, made small.

use super::*;
use crate::engine::trials::tests::asked;
use crate::trials::budget::Budget;
use crate::trials::cell::Reading;
use crate::trials::runner::Runner;

const RESTLESS: &str = r#"scenario "Restless"
horizon = 10 s
process calm { var n: 0 .. 9 = 0
 when n < 9 at 0.1 /s -> n = n + 1 }
process blinker[2] { var on = false
 when !on at 1500 /s -> on = true
 when on at 1500 /s -> on = false }
"#;

fn prepared(question: &str) -> PreparedWorld {
    asked(RESTLESS, question)
}

#[test]
fn a_trial_of_too_many_jumps_is_unresolved_and_the_process_is_named() {
    let mut prepared = prepared("estimate P(F (calm.n == 9)) within 0.1\n");
    assert_eq!(prepared.setup.most_jumps, 1 << 26);
    prepared.setup.most_jumps = 500;
    let mut runner = Runner::general(&prepared, &[0]).unwrap();
    let mut items = Item::run(0, 3).into_iter().enumerate();
    let finished = runner.run(7, &mut || items.next(), &Budget::new(u64::MAX, None));
    assert_eq!(finished.cells.len(), 3);
    for cell in &finished.cells {
        assert_eq!((cell.reading, cell.steps), (Reading::Unresolved, 500));
    }
    let item = Item { index: 0, advice: None };
    let words = unresolved(&prepared, 0, item, (7, &Budget::new(u64::MAX, None)));
    assert!(
        words.contains("too many jumps: 500 jumps by 0.") && words.contains("most of them of `blinker["),
        "{words}"
    );
    assert!(words.contains("at a rate of 1500 /s"), "{words}");
    // Not so many are made again.
    (prepared.setup.most_jumps, prepared.jumps_again) = (900, 400);
    let words = unresolved(&prepared, 0, item, (7, &Budget::new(u64::MAX, None)));
    assert!(words.contains("run again: 400 jumps by 0.") && words.contains("of `blinker["), "{words}");
    prepared.jumps_again = 1 << 20;
    // Enough jumps: no cause is reported.
    prepared.setup.most_jumps = 100_000;
    assert_eq!(unresolved(&prepared, 0, item, (7, &Budget::new(u64::MAX, None))), "");
}
