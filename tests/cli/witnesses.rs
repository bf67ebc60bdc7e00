//! What witnesses say: the smallest parts of a condition that decided, and the agents these are about.

use crate::program::Place;

const PEOPLE: &str = r#"scenario "Witnesses"
horizon = 6 s
step = 0.1 s
scene {
  region room: rect (4, 0) .. (8, 4)
  region exit: rect (3, 0) .. (20, 4)
}
kind person: sfm preset helbing2000 { speed = 1 m/s }
agent me: person { at = (1, 2); velocity = (1, 0) m/s; route = exit }
agent you: person { at = (6, 1); velocity = (0, 0) m/s; route = room }
agents crowd[1]: person { at = (9, 1); velocity = (0, 0) m/s }
process lamp { choose
  var on = false
  var n: 0 .. 5 = 0
  when !on -> on = true
  label bright = on & n > 2 }
process bulb[3] {
  var k: 0 .. 9 = 0
  when k < 9 -> k = k + 1
  let good = k < 3 | k > 7
  let low(z) = k < z
  let most(z) = low(z) | k > 9
  let odd = most(2) | low(1) }
"#;

/// Names of properties of them.
const NAMED: &str = "let f(p, r, t) = F<=t (p in r)
let near(p, q, d) = distance(p, q) < d
let close(p) = near(p, me, 2 m) & speed(p) < 3 m/s
let twice(v) = 2 * v
let least(p) = min<=2 s (distance(p, me))
let lonely(p) = !(exists a in crowd: distance(a, p) < 1 m & speed(a) < 9 m/s & a in exit)
let alone(p) = !(exists a in others(p): near(a, p, 100 m) & speed(a) < 9 m/s)
let less(v, w) = v < w & v + v > w
let h0(v) = speed(v) > 9 m/s & v in room
property slow = speed(me) < 0.1 m/s & x(position(me)) > 0.5 m
property quick = !slow
property fine = quick | you in room
";

const MACHINES: &str = r#"scenario "Machines"
horizon = 20 s
process machine[2] { var up = true
  var jobs: 0 .. 4 = 0
  when up after 3 s -> up = false
  when jobs < 4 after 1 s -> jobs = jobs + 1 }
process door { var open = false
  when !open after 2 s -> open = true
  label shut = !open }
let ok(which, n) = which.up | which.jobs < n
"#;

/// What decided the first trial, for each formula.
fn told(scenario: &str, cases: &[(&str, &str)]) {
    let queries: String = cases.iter().map(|(formula, _)| format!("check P({formula}) >= 0.5\n")).collect();
    let through: String = (1..=70).map(|k| format!("let h{k}(v) = h{}(v)\n", k - 1)).collect();
    let properties = if scenario == PEOPLE { format!("{NAMED}{through}{queries}") } else { queries };
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", &properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "1"]);
    assert!(said.code != Some(2), "{}", said.err);
    let json = said.json();
    for (k, (formula, expected)) in cases.iter().enumerate() {
        assert_eq!(json["results"][k]["witnesses"][0]["what"], *expected, "{formula}");
    }
}

#[test]
fn of_a_condition_of_several_parts_those_are_named_that_decided() {
    told(
        PEOPLE,
        &[
            (
                "F<=1 s slow",
                "`slow` is false because `speed(me) < 0.1 m/s` is false: 1 m/s of me at (2, 2) m",
            ),
            (
                "G<=1 s quick",
                "`quick` is true because `speed(me) < 0.1 m/s` is false: 1 m/s of me at (2, 2) m",
            ),
            ("G<=1 s fine", "`fine` is true because `speed(me) < 0.1 m/s` is false: 1 m/s of me at (2, 2) m"),
            (
                "F<=1 s !fine",
                "`!fine` is false because `speed(me) < 0.1 m/s` is false: 1 m/s of me at (2, 2) m",
            ),
            (
                "G<=1 s (me in exit | you in room)",
                "`me in exit | you in room` is true because `you in room` is true: you at (6, 1) m",
            ),
            (
                "F<=1 s (me in exit | distance(me, you) < 1 m)",
                "`me in exit | distance(me, you) < 1 m` is false because `me in exit` is false and `distance(me, you) < 1 m` is false: 4.123 m of me at (2, 2) m to you",
            ),
            (
                "G<=1 s (speed(me) < 9 m/s & you in room & speed(you) < 9 m/s)",
                "`speed(me) < 9 m/s & you in room & speed(you) < 9 m/s` is true: me at (2, 2) m, you",
            ),
            (
                "G<=1 s (me in room <=> you in room)",
                "`me in room <=> you in room` is false because `me in room` is false and `you in room` is true: me at (1, 2) m, you",
            ),
            (
                "G<=1 s (you in room => me in room)",
                "`you in room` is true: you at (6, 1) m; `me in room` is false: me at (1, 2) m",
            ),
            // A chain is one, however it nests.
            (
                "F<=1 s (me in room | me in exit | lamp.n > 3 | crowd[1] in room)",
                "`me in room | me in exit | lamp.n > 3 | crowd[1] in room` is false: me at (2, 2) m, crowd[1]",
            ),
            (
                "F<=0.5 s time_until(me in exit) < time_until(you in room)",
                "`time_until(me in exit) < time_until(you in room)` is false: `me in exit` is true: me at (3.1, 2) m at 2.1 s and `you in room` is true: you at (6, 1) m at 0.5 s",
            ),
            ("if(me in exit, 1, 0) == 1", "`if(me in exit, 1, 0) == 1` is false: me at (1, 2) m"),
            (
                "distance(me, you) < 1 m",
                "`distance(me, you) < 1 m` is false: 5.099 m of me at (1, 2) m to you",
            ),
            (
                "mean<=1 s (distance(me, you)) < 1 m",
                "`mean<=1 s (distance(me, you)) < 1 m` is false: me at (1, 2) m, you",
            ),
            (
                "time_until(you in room & speed(me) > 0.1 m/s) < 1 s",
                "`you in room & speed(me) > 0.1 m/s` is true because `you in room` is true and `speed(me) > 0.1 m/s` is true: you at (6, 1) m, me",
            ),
        ],
    );
}

#[test]
fn of_a_quantifier_it_is_the_first_of_whom_it_is_said_and_the_part_that_decided() {
    told(
        PEOPLE,
        &[
            (
                "G<=1 s (forall a in crowd: speed(a) < 9 m/s & a in room)",
                "`forall a in crowd: speed(a) < 9 m/s & a in room` is false because `a in room` is false: crowd[1] at (9, 1) m",
            ),
            (
                "F<=1 s (exists a in crowd: a in room | a in exit)",
                "`exists a in crowd: a in room | a in exit` is true because `a in exit` is true: crowd[1] at (9, 1) m",
            ),
            // Nobody wrote the `!` that an implication is made of.
            (
                "G<=1 s (forall a in crowd: a in exit => a in room)",
                "`forall a in crowd: a in exit => a in room` is false because `a in exit` is true and `a in room` is false: crowd[1] at (9, 1) m",
            ),
            // Nobody wrote that there is no case.
            ("G<=1 s (forall a in crowd: close(a) => a in exit)", "`exists a in crowd: close(a)` is false"),
            ("G<=1 s (forall a in crowd: a in room => a in exit)", "`exists a in crowd: a in room` is false"),
        ],
    );
}

#[test]
fn arguments_are_told_as_what_they_stand_for() {
    told(
        PEOPLE,
        &[
            ("f(me, room, 1 s)", "`me in room` is false: me at (2, 2) m"),
            // Both functions call their argument `p`.
            (
                "F<=1 s close(you)",
                "`close(you)` is false because `distance(you, me) < 2 m` is false: 4.123 m of you at (6, 1) m to me",
            ),
            (
                "G<=1 s (close(you) | close(crowd[1]))",
                "`close(you) | close(crowd[1])` is false because `distance(you, me) < 2 m` is false and `distance(crowd[1], me) < 2 m` is false: you at (6, 1) m, me, crowd[1]",
            ),
            (
                "F<=1 s (twice(distance(me, you) - 1 m) < 1 m)",
                "`twice(distance(me, you) - 1 m) < 1 m` is false: me at (2, 2) m, you",
            ),
            (
                "min<=1 s (twice(distance(me, you) - 1 m)) < 1 m",
                "`min<=1 s (twice(distance(me, you) - 1 m)) < 1 m` is false: `twice(distance(me, you) - 1 m)` is 6.246 m at 1 s: me, you",
            ),
            (
                "least(you) > 9 m",
                "`least(you) > 9 m` is false: `distance(you, me)` is 5.099 m at 0 s: you, me",
            ),
            // One `a` is another than the other, so both are told by their own names.
            (
                "G<=1 s (forall a in crowd: lonely(a))",
                "`forall a in crowd: lonely(a)` is false because `distance(crowd[1], crowd[1]) < 1 m & speed(crowd[1]) < 9 m/s & crowd[1] in exit` is true: crowd[1] at (9, 1) m",
            ),
            (
                "G<=1 s (forall a in crowd: alone(a))",
                "`forall a in crowd: alone(a)` is false because `distance(me, crowd[1]) < 100 m` is true and `speed(me) < 9 m/s` is true: crowd[1] at (9, 1) m, me",
            ),
            // What is long is cut, between words and outside of brackets.
            (
                "F<=1 s less(distance(me, you) + distance(you, crowd[1]) + speed(me) * 1 s + distance(crowd[1], me), 1 m)",
                "`less(distance(me, you) + distance(you, crowd[1]) + speed(me) * 1 s + distance(crowd[1], me), 1 m)` is false because `distance(me, you) + distance(you, crowd[1]) + speed(me) * 1 s + … < 1 m` is false: 15.19 m of me at (2, 2) m, you, crowd[1]",
            ),
            // However many functions it goes through.
            (
                "F<=1 s h70(you)",
                "`h70(you)` is false because `speed(you) > 9 m/s` is false: 0 m/s of you at (6, 1) m",
            ),
        ],
    );
}

#[test]
fn names_inside_processes_are_told_as_outside() {
    told(
        PEOPLE,
        &[
            ("F<=1 s lamp.bright", "`lamp.bright` is false because `lamp.n > 2` is false"),
            (
                "G<=1 s (forall b in bulb: b.good)",
                "`forall b in bulb: b.good` is false because `bulb[1].k < 3` is false and `bulb[1].k > 7` is false: bulb[1]",
            ),
            (
                "G<=1 s (forall b in bulb: F<=1 s (b.k > 3 & b.odd))",
                "`bulb[1].k > 3 & bulb[1].odd` is false because `bulb[1].most(2) | bulb[1].low(1)` is false: bulb[1]",
            ),
            // Each is named once.
            (
                "F<=1 s (bulb[2].k + bulb[1].k > 30 | bulb[2].k + bulb[1].k > 40)",
                "`bulb[2].k + bulb[1].k > 30 | bulb[2].k + bulb[1].k > 40` is false because `bulb[2].k + bulb[1].k > 30` is \
                 false and `bulb[2].k + bulb[1].k > 40` is false: bulb[1], bulb[2]",
            ),
        ],
    );
    told(
        MACHINES,
        &[
            (
                "G<=10 s (forall k in machine: ok(k, 3))",
                "`forall k in machine: ok(k, 3)` is false because `machine[1].up` is false and `machine[1].jobs < 3` is \
                 false: machine[1]",
            ),
            ("G<=10 s (forall k in machine: k.up)", "`forall k in machine: k.up` is false: machine[1]"),
            (
                "G<=10 s (machine[2].jobs < 4 & door.shut)",
                "`machine[2].jobs < 4 & door.shut` is false because `door.open` is true",
            ),
            (
                "F[5 s, 6 s] (machine[1].up & door.open)",
                "`machine[1].up & door.open` is false since 3 s because `machine[1].up` is false since 3 s",
            ),
            (
                "F<=1 s (machine[1].up & door.open)",
                "`machine[1].up & door.open` was never true because `door.open` was never true",
            ),
        ],
    );
}

/// What an estimate of a quantile says of its lowest trial.
fn lowest(scenario: &str, metric: &str) -> String {
    let query = format!("estimate Q(0.5, {metric}) by fixed(trials = 3)\n");
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", &query)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]);
    assert!(said.code == Some(0), "{}", said.err);
    said.json()["results"][0]["witnesses"][0]["what"].as_str().unwrap_or_default().to_owned()
}

const STEPS: &str = "scenario \"Steps\"\nhorizon = 20 steps
process n { var n: 0 .. 9 = 0; when n < 9 -> n = n + 1 }\n";
const JUMPS: &str = "scenario \"Jumps\"\nhorizon = 6 s
process p { var s: 0 .. 3 = 0; when s == 0 after 2 s -> s = 1; when s == 1 after 0 s -> s = 0 }
process q { var n: 0 .. 3 = 0; when n == 0 after 2 s -> n = 1 }
process r { var n: 0 .. 3 = 0 }\n";

#[test]
fn each_of_the_times_that_a_number_is_made_of_is_told() {
    assert_eq!(
        lowest(STEPS, "time_until(n.n == 8) - time_until(n.n == 3)"),
        "5 steps: `n.n == 8` is true at step 8 and `n.n == 3` is true at step 3"
    );
    assert_eq!(
        lowest(STEPS, "time_until(n.n == 8) + 1 step / n.n"),
        "∞ steps: `n.n == 8` is true at step 8 and `1 step / n.n` is ∞ steps at step 0"
    );
}

#[test]
fn what_lasts_no_time_is_no_reason_and_an_infinity_that_is_no_time_is_none() {
    told(
        JUMPS,
        &[
            ("G<=3 s (p.s == 0)", "`p.s == 0` was true throughout"),
            ("F<=5 s (p.s == 1) | (F<=5 s (q.n == 1))", "`q.n == 1` is true"),
        ],
    );
    assert_eq!(lowest(STEPS, "time_until(n.n > 9) - time_until(n.n == 3)"), "∞ steps");
    assert_eq!(lowest(JUMPS, "time_until(q.n == 1) + 1 s / r.n"), "∞ s");
}

#[test]
fn conditions_have_parts_however_many_they_are() {
    const MANY: &str = "scenario \"Many\"\nhorizon = 5 steps
process m[600] { var k: 0 .. 9 = 0; when k < 9 -> k = k + 1 }\n";
    let chain: Vec<String> = (0..70).map(|k| format!("p.k < {}", 100 + k)).collect();
    let chain = format!("let chain(p) = {} & p.k > 8\n", chain.join(" & "));
    let queries = "check P(forall a in m: F<=2 steps (a.k < 9 | a.k > 7)) >= 0.5
check P(forall a in m: F<=2 steps (a.k < 8 | a.k > 6)) >= 0.5
check P(F<=2 steps (m[600].k > 3 & m[1].k < 9)) >= 0.5\ncheck P(F<=2 steps chain(m[2])) >= 0.5\n";
    let place = Place::new(&[("a.scn", MANY), ("a.bltl", &format!("{chain}{queries}"))]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "1"]);
    assert!(said.code != Some(2), "{}", said.err);
    let json = said.json();
    let what = |k: usize| json["results"][k]["witnesses"][0]["what"].as_str().unwrap_or_default().to_owned();
    assert_eq!(what(2), "`m[600].k > 3 & m[1].k < 9` is false because `m[600].k > 3` is false: m[600]");
    assert_eq!(what(3), "`chain(m[2])` is false because `m[2].k > 8` is false: m[2]");
}

#[test]
fn who_is_called_like_a_name_within_is_not_taken_for_it() {
    let model = PEOPLE.replace(
        "agents crowd[1]",
        "agent a: person { at = (15, 3); velocity = (0, 0) m/s }\nagents crowd[1]",
    );
    let properties = "let has(p) = exists a in crowd: distance(a, p) < 1 cm
check P(G<=1 s (forall a in others(me): x(position(a)) < 14 m | has(a))) >= 0.5\n";
    let place = Place::new(&[("a.scn", &model), ("a.bltl", properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "1"]);
    assert_eq!(
        said.json()["results"][0]["witnesses"][0]["what"],
        "`forall a in others(me): x(position(a)) < 14 m | has(a)` is false: 15 m of a at (15, 3) m"
    );
}

#[test]
fn the_number_that_decided_and_its_place_are_those_of_the_trace() {
    let properties = "let gap(a) = distance(me, a) - radius(me) - radius(a)
check P(G<=2 s (forall a in others(me): gap(a) > 4 m)) >= 0.5
check P(G<=2 s (clearance(you) > 4 m)) >= 0.5
check P(G<=2 s (min(gap(a) for a in others(me)) > 4 m)) >= 0.5\n";
    let place = Place::new(&[("a.scn", PEOPLE), ("a.bltl", properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "1"]);
    let json = said.json();
    let trace = place.call(&["simulate", "a.scn", "--seed", "0"]).out;
    let mut rows = csv::Reader::from_reader(trace.as_bytes());
    let heads: Vec<String> = rows.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    for k in [0, 1, 2] {
        let witness = &json["results"][k]["witnesses"][0];
        let by = &witness["decided_by"];
        let time = witness["time"].as_f64().unwrap();
        let number = |agent: &str, head: &str| {
            let column = |head: &str| heads.iter().position(|name| name == head).unwrap();
            let is_it = |row: &&csv::StringRecord| {
                let then: f64 = row[column("time")].parse().unwrap();
                (then - time).abs() < 1e-9 && &row[column("agent")] == agent
            };
            rows.iter().find(is_it).unwrap()[column(head)].parse::<f64>().unwrap()
        };
        let agent = by["agent"].as_str().unwrap();
        let other = by["other"].as_str().unwrap_or("me");
        let at = [number(agent, "x"), number(agent, "y")];
        let distance = f64::hypot(at[0] - number(other, "x"), at[1] - number(other, "y"));
        let gap = distance - number(agent, "radius") - number(other, "radius");
        let near = |said: &serde_json::Value, value: f64| (said.as_f64().unwrap() - value).abs() < 1e-9;
        assert!(near(&by["place"][0], at[0]) && near(&by["place"][1], at[1]), "{by} {at:?}");
        assert!(near(&by["value"], gap) && by["unit"] == "m", "{by} {gap}");
        assert!(gap < 4.0, "{gap}");
        let what = witness["what"].as_str().unwrap();
        assert!(what.contains(&format!(" at ({}, {}) m", round(at[0]), round(at[1]))), "{what}");
    }
    assert_eq!(json["results"][1]["witnesses"][0]["decided_by"]["agent"], "you");
}

fn round(length: f64) -> f64 {
    (length * 100.0).round() / 100.0
}

/// A time that is compared with the present one is none that decided.
#[test]
fn a_route_is_done_or_not() {
    let scenario = "horizon = 6 s\nstep = 0.1 s\nkind p: sfm preset smc1 { noise = 0 m/s; speed = 1 m/s }\n\
        agent a: p { at = (1, 1); route = (3, 1) }\n";
    let place = Place::new(&[
        ("a.scn", scenario),
        ("a.bltl", "check P(F<=1 s done(a)) >= 0.5\ncheck P(F<=6 s (done(a) & x(a) > 0 m)) >= 0.5\n"),
    ]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]).out;
    assert!(said.contains("`done(a)` is false: a at ("), "{said}");
    assert!(said.contains("`done(a)` is true and `x(a) > 0 m` is true: a at ("), "{said}");
    assert!(!said.contains("against") && !said.contains('∞'), "{said}");
}
