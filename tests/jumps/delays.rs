//! What takes so long takes so long, whenever it begins: fixed delays after random times, against bounds of just that length.

use super::traces::trace;
use super::{compiled, count};
use smc::kernel::Program;

const JOBS: &str = "horizon = 20 s
process job {
  var k: 0 .. 2 = 0
  when k == 0 at 1 /s   -> k = 1
  when k == 1 after 2 s -> k = 2
}
process parts {
  var k: 0 .. 4 = 0
  when k == 0 at 1 /s        -> k = 1
  when k == 1 after 1.7 s    -> k = 2
  when k == 2 after 0.2 s    -> k = 3
  when k == 3 after 1 s / 10 -> k = 4
}
process thirds {
  var k: 0 .. 4 = 0
  when k == 0 at 1 /s       -> k = 1
  when k == 1 after 1 s / 3 -> k = 2
  when k == 2 after 2 s / 3 -> k = 3
  when k == 3 after 1 s     -> k = 4
}
process door  { var s: 0 .. 2 = 0; when job.k >= 1 & s == 0 after 2 s -> s = 2 }
process timer { var s: 0 .. 2 = 0; when job.k >= 1 & s == 0 after 0.5 s -> s = 1; when s == 1 after 1.5 s -> s = 2 }
";

#[test]
fn bounds_of_just_that_length_hold_always_and_shorter_ones_never() {
    for (formula, truth) in [
        ("G<=10 s (job.k == 1 => F<=2 s (job.k == 2))", true),
        ("F<=10 s (job.k == 1 & G[2 s, 2 s] (job.k == 1))", false),
        ("G<=10 s (job.k == 1 => F<=1.999999999 s (job.k == 2))", false),
        ("G<=10 s (parts.k == 1 => F<=2 s (parts.k == 4))", true),
        ("F<=10 s (parts.k == 1 & G[2 s, 2 s] (parts.k == 3))", false),
        ("G<=10 s (thirds.k == 1 => F<=2 s (thirds.k == 4))", true),
        ("G<=10 s (thirds.k == 1 => F<=(4 s / 3) (thirds.k >= 3))", true),
        ("G<=10 s (thirds.k == 1 => F<=1.3333333333 s (thirds.k >= 3))", true),
        ("G<=10 s (thirds.k == 1 => F<=1.999999999 s (thirds.k == 4))", false),
        // Two that begin together end together, however one is cut.
        ("G<=15 s (door.s == 2 <=> timer.s == 2)", true),
        ("time_until(door.s == 2) <= 20 s => time_until(timer.s == 2) <= 20 s", true),
    ] {
        // Who begins before the tenth second: nearly all, and nothing is asked of the others.
        let held = count(JOBS, formula, 400);
        let kept = if truth { held == 400 } else { held <= 1 };
        assert!(kept, "{formula}: {held} of 400");
    }
}

#[test]
fn what_is_asked_moves_no_jump() {
    let program = |queries: &str| {
        let study = compiled(JOBS, queries).unwrap_or_else(|error| panic!("{error}"));
        Program::new(study.worlds[0].scenario.clone())
    };
    let (plain, thirds) = (program(""), program("estimate P(F<=(1 s / 7) (job.k == 1))\n"));
    assert_ne!(plain.scenario.clock, thirds.scenario.clock);
    for index in 0..40 {
        assert_eq!(trace(&plain, 3, index), trace(&thirds, 3, index));
    }
}

#[test]
fn a_process_with_delays_moves_no_jump_of_others() {
    let rates = "horizon = 200 s\nprocess a { var n: 0 .. 9 = 0; when n < 9 at 0.7 /s -> n = n + 1; when n > 0 at 1 /s -> n = n - 1 }\n";
    let more = format!(
        "{rates}process b {{ var on = false; when !on after 50 s -> on = true; when on after 1 s / 7 -> on = false }}\n"
    );
    let of = |text: &str| {
        let study = compiled(text, "").unwrap_or_else(|error| panic!("{error}"));
        Program::new(study.worlds[0].scenario.clone())
    };
    let (plain, more) = (of(rates), of(&more));
    for index in 0..20 {
        let own = |program: &Program| {
            let mut states: Vec<(f64, f64)> =
                trace(program, 3, index).into_iter().map(|(time, values)| (time, values[0])).collect();
            states.dedup_by_key(|(_, n)| *n);
            states
        };
        assert_eq!(own(&plain), own(&more), "{index}");
    }
}

/// What lasts a millionth of a second in a year lasts that long.
#[test]
fn brief_states_count_however_late_they_come() {
    let model = "horizon = 31536000 s
process a { var k: 0 .. 2 = 0; when k == 0 at 0.000001 /s -> k = 1; when k == 1 at 1000000 /s -> k = 2 }
process c { var k: 0 .. 2 = 0; when k == 0 after 1000000 s -> k = 1; when k == 1 after 0.00000003 s -> k = 2 }
process b { var n: 0 .. 1 = 0; when n == 0 after 1 s -> n = 1 }
";
    assert!(count(model, "F (a.k == 1)", 1000) >= 990);
    assert_eq!(count(model, "F (c.k == 1)", 10), 10);
}

/// The last instant is in the trial, though two factors of it round beyond.
#[test]
fn what_comes_at_the_horizon_comes() {
    for last in ["1.07", "8.3", "1.1", "16.1", "2.14"] {
        let model = format!(
            "horizon = {last} s\nprocess p {{ var n: 0 .. 3 = 0; when n == 0 after {last} s -> n = 1 }}\n"
        );
        for formula in [
            format!("F<={last} s (p.n == 1)"),
            format!("time_until(p.n == 1) <= {last} s"),
            format!("F[0 s, {last} s] (G[0 s, 0 s] (p.n == 1))"),
        ] {
            assert_eq!(count(&model, &formula, 4), 4, "{formula}");
        }
    }
}

#[test]
fn what_comes_at_one_time_comes_in_the_order_in_which_it_is_written() {
    let model = "horizon = 1001 s
process b { var k: 0 .. 9 = 0; when k < 9 after 0.001 s -> k = k + 1; when k == 9 after 0.001 s -> k = 0 }
process a { var m: 0 .. 10 = 10; when m == 10 after 1000 s -> m = b.k }
";
    assert_eq!(count(model, "F<=1000.5 s (a.m == 0)", 1), 1);
}

/// Sums that fall halfway between two doubles are the same time, however one is cut; of most that begin by chance one in
/// eight does.
#[test]
fn what_begins_by_chance_keeps_its_order_too() {
    let model = "horizon = 20 s
process job    { var k: 0 .. 1 = 0; when k == 0 at 1 /s -> k = 1 }
process ninths { var n: 0 .. 9 = 0; when job.k == 1 & n < 9 after 1 s / 9 -> n = n + 1 }
process tenths { var n: 0 .. 10 = 0; when job.k == 1 & n < 10 after 0.1 s -> n = n + 1 }
process door {
  var s: 0 .. 1 = 0
  var nine: 0 .. 9 = 0
  var ten: 0 .. 10 = 0
  when job.k == 1 & s == 0 after 1 s -> { s = 1; nine = ninths.n; ten = tenths.n }
}
process late { var n: 0 .. 14 = 0; when job.k == 1 & n < 14 after 1 s / 14 -> n = n + 1 }
";
    for (formula, truth) in [
        ("G<=15 s (door.s == 1 => door.nine == 9 & door.ten == 10)", true),
        // Asked directly, and of stored pieces.
        ("G<=15 s (door.s == 1 <=> ninths.n == 9)", true),
        ("G<=15 s F<=0 s (door.s == 1 <=> ninths.n == 9)", true),
        ("G<=15 s (door.s == 1 <=> late.n == 14)", true),
        ("F<=15 s (door.s == 0 & ninths.n == 9)", false),
        ("F<=15 s (G[0 s, 0 s] (door.s == 0 & ninths.n == 9))", false),
    ] {
        assert_eq!(count(model, formula, 600), if truth { 600 } else { 0 }, "{formula}");
    }
}

/// Two times that have one double are two times.
#[test]
fn what_lasts_less_than_a_double_tells_lasts() {
    let model = "horizon = 31536000 s
process job {
  var k: 0 .. 3 = 0
  when k == 0 at 0.0000001 /s       -> k = 1
  when k == 1 after 0.000000001 s   -> k = 2
  when k == 2 after 2 s             -> k = 3
}
process late { var k: 0 .. 2 = 0; when k == 0 after 31000000 s -> k = 1; when k == 1 after 0.000000001 s -> k = 2 }
";
    for (formula, truth) in [
        ("G<=31000000 s (job.k == 2 => F<=2 s (job.k == 3))", true),
        ("F (job.k == 2) => F (job.k == 1)", true),
        ("F<=31000000 s (late.k == 2)", false),
        ("F<=31000000 s (late.k == 1)", true),
        ("F<=31000001 s (late.k == 2)", true),
        ("F<=31000001 s (G[0 s, 0 s] (late.k == 1))", true),
        ("time_until(late.k == 2) > 31000000 s", true),
    ] {
        assert_eq!(count(model, formula, 300), if truth { 300 } else { 0 }, "{formula}");
    }
}

/// What is drawn of a list is as long as it is written, however many digits that takes: `3 * 0.1 s` is 0.3 s.
#[test]
fn drawn_delays_meet_bounds_of_just_their_length() {
    let model = "horizon = 86400 s
process tenths { var k: 0 .. 1 = 0; when k == 0 after uniform_int(3, 3) * 0.1 s -> k = 1 }
process thirds { var k: 0 .. 2 = 0; when k == 0 at 0.001 /s -> k = 1; when k == 1 after uniform_int(7, 7) * (1 s / 3) -> k = 2 }
process cut    { var k: 0 .. 1 = 0; when k == 0 after uniform_int(1, 9) * 0.1 s in 0.7 s .. 0.75 s -> k = 1 }
process long   { var k: 0 .. 2 = 0; when k == 0 at 0.001 /s -> k = 1; when k == 1 after choice(9000.1 s, 9000.1 s) -> k = 2 }
process mixed  { var k: 0 .. 1 = 0; when k == 0 after 0.1 s * choice(3, pi / 3) -> k = 1 }
process still  { var k: 0 .. 2 = 0; when k == 0 at 0.001 /s -> k = 1; when k == 1 after normal(9000.1 s, 0 s) -> k = 2 }
process triple { var k: 0 .. 2 = 0; when k == 0 at 0.001 /s -> k = 1; when k == 1 after 2 * choice(1.1, 1.1) * 1.5 s -> k = 2 }
process digits {
  var k: 0 .. 3 = 0
  when k == 0 at 0.001 /s                 -> k = 1
  when k == 1 after 0.12345678901234567 s -> k = 2
  when k == 2 after 1.87654321098765433 s -> k = 3
}
";
    for formula in [
        "F<=0.3 s (tenths.k == 1)",
        "G<=0.29 s (tenths.k == 0)",
        "G<=70000 s (thirds.k == 1 => F<=(7 s / 3) (thirds.k == 2))",
        "F<=0.7 s (cut.k == 1)",
        // What is rounded beside it rounds nothing else.
        "F<=0.3 s (mixed.k == 1)",
        "G<=70000 s (still.k == 1 => F<=9000.1 s (still.k == 2))",
        "G<=70000 s (long.k == 1 => F<=9000.1 s (long.k == 2))",
        "G<=70000 s (triple.k == 1 => F<=3.3 s (triple.k == 2))",
        "G<=70000 s (digits.k == 1 => F<=2 s (digits.k == 3))",
    ] {
        assert_eq!(count(model, formula, 300), 300, "{formula}");
    }
    // Steps and continuous time agree.
    let law = "process job { var k: 0 .. 1 = 0; when k == 0 after poisson(4) * 0.1 s -> k = 1 }\n";
    for bound in ["0.3 s", "0.6 s", "0.7 s"] {
        let formula = format!("F<={bound} (job.k == 1)");
        let held = ["horizon = 20 s\n", "horizon = 20 s\nstep = 0.1 s\n"]
            .map(|head| count(&format!("{head}{law}"), &formula, 400));
        assert_eq!(held[0], held[1], "{formula}");
    }
}
