//! Traces: formats, replay of witnesses, common random numbers.

use crate::program::{Place, SMALL};
use serde_json::Value;

/// Rows of `smc simulate --format jsonl`.
fn rows(place: &Place, scenario: &str, words: &[&str]) -> Vec<Value> {
    let said = place.call(&[&["simulate", scenario, "--format", "jsonl"], words].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    said.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn formats_agree() {
    let place = Place::new(&[("a.scn", SMALL)]);
    let words = ["--trial", "3", "--trials", "2", "--until", "0.1", "--every", "5"];
    let lines = rows(&place, "a.scn", &words);
    assert_eq!(lines.len(), 2 * 2 * 4, "two trials, two states, four people");
    let json = place.call(&[&["simulate", "a.scn", "--format", "json"], &words[..]].concat()).json();
    let columns = json["columns"].as_array().unwrap();
    let table = json["rows"].as_array().unwrap();
    assert_eq!(table.len(), lines.len());
    for (row, line) in table.iter().zip(&lines) {
        for (k, column) in columns.iter().enumerate() {
            assert_eq!(row[k], line[column.as_str().unwrap()]);
        }
    }
    let csv = place.call(&[&["simulate", "a.scn", "--output", "t.csv"], &words[..]].concat());
    assert_eq!((csv.code, csv.out.as_str()), (Some(0), ""));
    let text = std::fs::read_to_string(place.path("t.csv")).unwrap();
    assert_eq!(text.lines().count(), 1 + lines.len());
    for (line, row) in text.lines().skip(1).zip(&lines) {
        let cells: Vec<&str> = line.split(',').collect();
        // serde_json reads numbers to within one unit in the last place.
        let (cell, number) = (cells[3].parse::<f64>().unwrap(), row["x"].as_f64().unwrap());
        assert!((cell - number).abs() <= f64::EPSILON * number.abs(), "{cell} {number}");
    }
    for words in [&["--until", "-1"][..], &["--move", "jump"], &["--set", "density=0..1 by 0.5"]] {
        assert_eq!(place.call(&[&["simulate", "a.scn"], words].concat()).code, Some(2), "{words:?}");
    }
}

#[test]
fn the_replay_of_a_witness_shows_what_it_names() {
    let place = Place::new(&[
        ("a.scn", SMALL),
        ("a.bltl", "estimate P(F<=3 s (user in hall & position(user).x > 4 m)) by fixed(trials = 40)\n"),
    ]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json", "--seed", "7"]).json();
    let witnesses = json["results"][0]["witnesses"].as_array().unwrap().clone();
    assert!(!witnesses.is_empty());
    for witness in &witnesses {
        let command = witness["command"].as_str().unwrap();
        let words: Vec<&str> = command.strip_prefix("smc simulate a.scn ").unwrap().split(' ').collect();
        let rows = rows(&place, "a.scn", &words);
        let decided = witness["time"].as_f64().unwrap();
        let inside = |row: &Value| {
            let at = |name: &str| row[name].as_f64().unwrap();
            (4.0..=9.0).contains(&at("x")) && (0.0..=3.0).contains(&at("y")) && at("x") > 4.0
        };
        let users: Vec<&Value> = rows.iter().filter(|r| r["agent"] == "user").collect();
        let first = users.iter().find(|row| inside(row)).map(|row| row["time"].as_f64().unwrap());
        if witness["passing"] == true {
            assert_eq!(first, Some(decided), "{witness}");
        } else {
            assert!(first.is_none_or(|time| time > 3.0) && decided == 3.0, "{witness} {first:?}");
        }
    }
}

#[test]
fn an_addition_changes_nobody_elses_draws() {
    let added = format!("{SMALL}agent late: adult {{ at = (20, 20) }}\n");
    let moved = SMALL.replace("stop }", "heading 90 deg; stop }");
    let place = Place::new(&[("a.scn", SMALL), ("b.scn", &added), ("c.scn", &moved)]);
    let words = ["--trials", "20", "--until", "0"];
    let plain = rows(&place, "a.scn", &words);
    let more: Vec<Value> =
        rows(&place, "b.scn", &words).into_iter().filter(|row| row["agent"] != "late").collect();
    assert_eq!(plain.len(), 20 * 4);
    assert_eq!(plain, more, "one more agent");
    assert_eq!(
        rows(&place, "a.scn", &["--trials", "5"]),
        rows(&place, "c.scn", &["--trials", "5"]),
        "one more move"
    );
    assert_ne!(plain, rows(&place, "a.scn", &["--trials", "20", "--until", "0", "--seed", "1"]));
}

#[test]
fn one_more_member_changes_nobody_elses_draws() {
    let text = "horizon = 6 s\nstep = 0.02 s\nparam n = 3\n\
        kind adult: sfm preset helbing2000 { radius = uniform(0.2 m, 0.3 m) }\n\
        behaviour phone { state a { after exponential(1 s) -> b }; state b { speed = uniform(0.5 m/s, 1 m/s) } }\n\
        agents wide[n]: adult with phone { at = uniform in rect (0, 0) .. (900, 900) }\n\
        group pair[n]: adult { at = uniform in rect (0, 2000) .. (900, 2900) }\n\
        process coin[n] { var x: 0 .. 1000 = 0\n when true -> 1/2: x = x | 1/2: x = x + 1 }\n";
    let alone = "horizon = 6\nparam n = 3\n\
        process coin[n] { var x: 0 .. 1000 = 0\n when true -> 1/2: x = x | 1/2: x = x + 1 }\n";
    let place = Place::new(&[("a.scn", text), ("p.scn", alone)]);
    let with = |file: &str, n: &str| rows(&place, file, &["--trials", "3", "--until", "3", "--set", n]);
    let (three, four) = (with("a.scn", "n=3"), with("a.scn", "n=4"));
    assert!(four.len() > three.len());
    // Of those who were there before, and of the processes that were.
    let old = four.iter().filter(|row| !row["agent"].as_str().unwrap().ends_with("[4]"));
    let old: Vec<Value> = old
        .map(|row| {
            let mut row = row.clone();
            assert!(row.as_object_mut().unwrap().remove("coin[4].x").is_some());
            row
        })
        .collect();
    assert!(three == old, "one more member changed something");
    let mut some = false;
    for (three, four) in with("p.scn", "n=3").iter().zip(&with("p.scn", "n=4")) {
        for name in ["time", "coin[1].x", "coin[2].x", "coin[3].x"] {
            assert_eq!(three[name], four[name], "{name}");
        }
        some |= four["coin[4].x"] != three["coin[1].x"];
    }
    assert!(some, "the fourth has draws of its own");
}

#[test]
fn comparisons_use_common_random_numbers() {
    let scenario = SMALL
        .replace("param density", "param push = 2000 N\nparam density")
        .replace("noise = 0.05 m/s", "noise = 0.05 m/s; A = push");
    let query = "compare P(F<=3 s contact(user)) under push = 2000 N with push = 2050 N\n";
    let place = Place::new(&[("a.scn", &scenario), ("a.bltl", query)]);
    let words = ["check", "a.scn", "a.bltl", "-q", "--format", "json", "--max-trials", "400"];
    let run = |seed: &str| place.call(&[&words[..], &["--seed", seed]].concat()).json()["results"][0].clone();
    let result = run("0");
    let count = |side: &str, field: &str| result[side][field].as_f64().unwrap();
    let pairs = count("difference", "trials");
    let discordant = count("difference", "successes") + count("difference", "failures");
    let (p, q) = (count("first", "successes") / pairs, count("second", "successes") / pairs);
    let independent = pairs * (p * (1.0 - q) + q * (1.0 - p));
    assert!(pairs >= 100.0 && p > 0.02 && p < 0.98, "{result}");
    assert!(
        discordant < 0.25 * independent,
        "{discordant} discordant pairs, {independent:.0} if independent"
    );
}

#[test]
fn without_people_every_step_and_every_jump_is_a_row() {
    let place = Place::new(&[
        ("die.scn", include_str!("../../models/die.scn")),
        ("queue.scn", include_str!("../../models/queue.scn")),
        ("queue.bltl", "estimate P(F<=10 s (queue.n == 5)) by fixed(trials = 30)\n"),
    ]);
    let steps = rows(&place, "die.scn", &["--trials", "2", "--until", "3"]);
    let times: Vec<f64> = steps.iter().map(|row| row["time"].as_f64().unwrap()).collect();
    assert_eq!(times, [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]);
    assert!(steps.iter().all(|row| row["die.s"].is_u64() && row["die.d"].is_u64()));
    assert_eq!((&steps[0]["die.s"], &steps[7]["trial"]), (&Value::from(0), &Value::from(1)));

    let jumps = rows(&place, "queue.scn", &["--trial", "1"]);
    let at = |row: &Value| (row["time"].as_f64().unwrap(), row["queue.n"].as_i64().unwrap());
    assert_eq!(at(&jumps[0]), (0.0, 0));
    for pair in jumps.windows(2) {
        let ((before, from), (after, to)) = (at(&pair[0]), at(&pair[1]));
        assert!(before < after && after <= 10.0 && (from - to).abs() == 1, "{pair:?}");
    }
    let some = rows(&place, "queue.scn", &["--trial", "1", "--every", "3", "--until", "5"]);
    let expected: Vec<&Value> = jumps.iter().filter(|row| at(row).0 <= 5.0).step_by(3).collect();
    assert_eq!(some.iter().collect::<Vec<_>>(), expected);
    let csv = place.call(&["simulate", "queue.scn", "--trial", "1"]);
    assert_eq!(csv.out.lines().next(), Some("time,trial,queue.n"));
    assert_eq!(csv.out.lines().count(), 1 + jumps.len());
    let json = place.call(&["simulate", "queue.scn", "--trial", "1", "--format", "json"]).json();
    assert_eq!(json["columns"], serde_json::json!(["time", "trial", "queue.n"]));
    assert_eq!(json["rows"].as_array().unwrap().len(), jumps.len());

    // The replay of a witness shows the jump that decided it.
    let said = place.call(&["check", "queue.scn", "queue.bltl", "-q", "--format", "json"]).json();
    let witnesses = said["results"][0]["witnesses"].as_array().unwrap();
    assert_eq!(witnesses.len(), 2);
    for witness in witnesses {
        let command = witness["command"].as_str().unwrap();
        let words: Vec<&str> = command.strip_prefix("smc simulate queue.scn ").unwrap().split(' ').collect();
        let full = rows(&place, "queue.scn", &words).iter().map(at).find(|(_, n)| *n == 5);
        let decided = witness["time"].as_f64().unwrap();
        match full {
            Some((time, _)) => {
                assert!((time - decided).abs() < 1e-9);
                assert_eq!(witness["what"], "`queue.n == 5` is true");
            }
            None => {
                assert_eq!(decided, 10.0);
                assert_eq!(witness["what"], "`queue.n == 5` was never true");
            }
        }
    }
}

#[test]
fn people_who_come_in_have_rows_while_they_are_there_and_states_have_columns() {
    let place = Place::new(&[("a.scn", include_str!("../../models/distracted.scn"))]);
    let rows = rows(&place, "a.scn", &["--trial", "2", "--until", "12", "--every", "10"]);
    let of = |agent: &str| -> Vec<&Value> { rows.iter().filter(|row| row["agent"] == agent).collect() };
    assert_eq!(of("user").len(), 61);
    assert!(of("user").iter().all(|row| row["phone"] == Value::Null && row["x"].is_number()));
    let crowd: Vec<&str> = of("crowd[3]").iter().map(|row| row["phone"].as_str().unwrap()).collect();
    assert_eq!((crowd.len(), crowd[0]), (61, "attentive"));
    assert!(crowd.iter().all(|state| ["attentive", "looking"].contains(state)));
    let first = of("doors[1]");
    assert!((1..61).contains(&first.len()) && of("doors[30]").is_empty());
    assert!(first[0]["time"].as_f64().unwrap() > 0.0 && first.iter().all(|row| row["present"] == true));
    assert!(rows.iter().all(|row| row.get("heedful").is_none()), "a behaviour without states has no column");
}

#[test]
fn an_agent_that_has_left_keeps_its_rows_without_numbers() {
    let scenario = "horizon = 6 s\nstep = 0.1 s\n\
        process coin { var n: 0 .. 100 = 0; when n < 100 -> n = n + 1 }\n\
        kind adult: sfm preset helbing2000 { noise = 0 m/s; speed = 1 m/s }\n\
        behaviour phone { state idle { after 9 s -> idle } }\n\
        agent gone: adult with phone { at = (0, 0); route = (3, 0) then leave }\n\
        agent stays: adult { at = (0, 5) }\n\
        source doors: adult { at = (0, 10); every = 2 s; limit = 1; route = (1.5, 10) }\n";
    let place = Place::new(&[("a.scn", scenario)]);
    let rows = rows(&place, "a.scn", &[]);
    let of = |agent: &str| -> Vec<&Value> { rows.iter().filter(|row| row["agent"] == agent).collect() };
    assert_eq!((of("gone").len(), of("stays").len()), (61, 61), "a row for each state");
    let (here, left): (Vec<&Value>, Vec<&Value>) =
        of("gone").into_iter().partition(|row| row["present"] == true);
    assert!(!here.is_empty() && !left.is_empty());
    assert!(
        here.iter().all(|row| row["x"].is_number() && row["radius"].is_number() && row["phone"] == "idle")
    );
    for row in left {
        for empty in ["x", "y", "vx", "vy", "speed", "radius", "phone"] {
            assert_eq!(row[empty], Value::Null, "{empty} in {row}");
        }
        assert!(row["time"].is_number() && row["coin.n"].is_number() && row["present"] == false, "{row}");
    }
    // The one place of the source is taken by one person after the other, each under a name of its own.
    assert!(["doors[1]", "doors[2]"].iter().all(|name| !of(name).is_empty()));
    let doors = rows.iter().filter(|row| row["agent"].as_str().unwrap().starts_with("doors"));
    assert!(doors.clone().count() < 61 && doors.clone().all(|row| row["present"] == true));
    let csv = place.call(&["simulate", "a.scn", "--until", "6"]).out;
    assert!(csv.lines().any(|line| line.contains(",gone,,,,,,0,,")), "{csv}");
}

#[test]
fn show_prints_conditions_and_processes_as_written() {
    let place = Place::new(&[
        ("robot.scn", include_str!("../../models/robot.scn")),
        ("queue.scn", include_str!("../../models/queue.scn")),
        ("robot.bltl", include_str!("../../properties/robot.bltl")),
    ]);
    let said = place.call(&["show", "robot.scn", "robot.bltl"]).out;
    for line in [
        "  param outage = 0.004 in 0 .. 1\n",
        "  let drop = if(robot in glare, 3 * outage, outage)\n",
        "  when !works -> 1/75: works = true | 74/75: {}\n",
        "      with wary(1.5 m) (its gap)\n",
        "        walking: when distance(self, robot) < gap -> 0.7: waiting | 0.3: passing\n",
        "        seeing: when !sensor.works -> blind\n",
    ] {
        assert!(said.contains(line), "{line}\n{said}");
    }
    assert!(!said.contains("its condition"), "{said}");
    // A comparison looks at other worlds too; what is shown is the one that was called for.
    assert!(!said.contains("set outage"), "{said}");
    let said = place.call(&["show", "robot.scn", "--set", "outage=0.5"]).out;
    assert!(said.contains("  set outage = 0.5\n"), "{said}");
    let said = place.call(&["show", "queue.scn"]).out;
    assert!(
        said.contains("Process queue\n  var n: 0 .. 5 = 0\n  when n < 5 at lambda -> n = n + 1\n"),
        "{said}"
    );
    assert!(!said.contains("People:"), "{said}");
}

const DOOR: &str = "horizon = 12 s
step = 0.05 s
scene { region hall: rect (0, 0) .. (5, 5) }
kind adult: sfm preset helbing2000 { noise = 0.05 m/s }
agent me: adult { at = (9, 2); route = (20, 2) }
source door: adult { at = uniform in hall; every = exponential(5 s); route = (20, 2) }
";

#[test]
fn witnesses_name_only_who_is_there() {
    let properties = "\
property all = forall a in door: F<=10 s (distance(a, me) < 1 m)
property space = G<=12 s (forall a in door: distance(a, me) > 5 m)
property some = F<=12 s (exists a in door: travelled(a) > 2 m)
property late = F<=4 s (forall a in door: F<=8 s (travelled(a) > 2 m))
estimate P(all) by fixed(trials = 12)
estimate P(space) by fixed(trials = 12)
estimate P(some) by fixed(trials = 12)
estimate P(late) by fixed(trials = 12)
";
    let place = Place::new(&[("a.scn", DOOR), ("a.bltl", properties)]);
    let json = place.call(&["check", "a.scn", "a.bltl", "-q", "--format", "json"]).json();
    let mut named = 0;
    for result in json["results"].as_array().unwrap() {
        for witness in result["witnesses"].as_array().unwrap() {
            let what = witness["what"].as_str().unwrap();
            let trial = witness["trial"].to_string();
            let rows = place.call(&["simulate", "a.scn", "--trial", &trial]).out;
            for k in 1..40 {
                let name = format!("door[{k}]");
                if what.contains(&name) {
                    named += 1;
                    assert!(rows.contains(&name), "{what} in trial {trial}");
                }
            }
            assert!(!what.contains(" holds") && !what.contains(" fails"), "{what}");
        }
    }
    assert!(named > 0);
    assert_eq!(json["results"][0]["witnesses"][0]["what"], "no agent of the quantified set was present");
    let warnings = json["results"][0]["warnings"].to_string();
    assert!(warnings.contains("no agent was present") && !warnings.contains("implications"), "{warnings}");
}

#[test]
fn who_has_nowhere_to_go_feels_the_same_all_around() {
    let scenario = "horizon = 2 s\nstep = 0.01 s\n\
kind p: sfm preset helbing2000 { A = 33.6 N; B = 1.65 m; lambda = 0.12; noise = 0 m/s; radius = 0.25 m; hold = 0 m/s }\n\
agent west: p { at = (0, 0) }\nagent east: p { at = (1, 0) }\n\
agent south: p { at = (99, 0) }\nagent north: p { at = (99, 1) }\n";
    let place = Place::new(&[("a.scn", scenario)]);
    let rows = rows(&place, "a.scn", &["--every", "200"]);
    let at = |name: &str| {
        let row = rows.iter().rfind(|row| row["agent"] == name).unwrap();
        (row["x"].as_f64().unwrap(), row["y"].as_f64().unwrap())
    };
    let ((west, _), (east, _)) = (at("west"), at("east"));
    assert!(west < -0.05 && (west + east - 1.0).abs() < 1e-12, "{west} {east}");
    // The same, turned by a right angle.
    assert!((at("south").1 - west).abs() < 1e-12 && (at("north").1 - east).abs() < 1e-12);
    assert_eq!((at("south").0, at("west").1), (99.0, 0.0));
}

/// The rate is wrong at 5 s.
const LATE: &str = "scenario \"late\"\nhorizon = 20 s\n\
process q { var n: 0 .. 9 = 0; var z: real = 1; when n < 9 after 5 s -> n = n + 1 }\n\
process r { var x: 0 .. 1 = 0; when x == 0 & q.n == 1 at -1 /s * q.z -> x = 1 }\n";

#[test]
fn what_is_wrong_later_than_is_asked_for_is_not_told() {
    let place =
        Place::new(&[("a.scn", LATE), ("a.bltl", "estimate P(F<=2 s (q.n == 1)) by fixed(trials = 3)\n")]);
    assert_eq!(place.call(&["check", "a.scn", "a.bltl", "-q"]).code, Some(0));
    let before = place.call(&["simulate", "a.scn", "--until", "2"]);
    assert_eq!((before.code, before.err.as_str()), (Some(0), ""), "{}", before.out);
    let after = place.call(&["simulate", "a.scn", "--until", "6"]);
    assert_eq!(after.code, Some(2));
    assert!(after.err.contains("ended with an error of the model"), "{}", after.err);
}

#[test]
fn jumps_without_end_between_two_steps_are_told_by_their_process() {
    let model = "scenario \"fast\"\nhorizon = 1 s\nstep = 0.1 s\n\
process blinker { var on = true; when on at 1e9 /s -> on = false; when !on at 1e9 /s -> on = true }\n\
process slow { var n: 0 .. 5 = 0; when n < 5 at 1 /s -> n = n + 1 }\n";
    let place = Place::new(&[
        ("a.scn", model),
        ("a.bltl", "estimate P(F<=0.5 s (slow.n == 1)) by fixed(trials = 1)\n"),
    ]);
    let said = place.call(&["simulate", "a.scn"]).err;
    for part in ["diverged at 0.1 s: more than 1048576 jumps between two steps", "most of them of `blinker`"]
    {
        assert!(said.contains(part), "{said}");
    }
    assert!(!said.contains("somebody"), "{said}");
}

#[test]
fn show_keeps_what_a_minus_is_about() {
    let text = "horizon = 2 s\nstep = 0.1 s\nkind adult: sfm preset helbing2000\n\
        behaviour wary { state a { speed = -(0.1 m/s - speed) * 0.5 } }\n\
        agent me: adult with wary { at = (0, 0) }\n";
    let said = Place::new(&[("a.scn", text)]).call(&["show", "a.scn"]).out;
    assert!(said.contains("        a: speed = (-(0.1 - speed)) * 0.5\n"), "{said}");
}

#[test]
fn show_tells_of_behaviours_and_sources() {
    let place = Place::new(&[("a.scn", include_str!("../../models/distracted.scn"))]);
    let said = place.call(&["show", "a.scn"]);
    for line in [
        "Agents: 13",
        "        on advice: 0.8: follow | 0.2: ignore",
        "        attentive: after exponential(8 s) -> looking",
        "        looking: speed = 0.5 * speed; attention = 0.3; after uniform(2 s, 5 s) -> attentive",
        "  source doors: one every exponential(4 s), at most ",
        "      goes west, then leaves",
    ] {
        assert!(said.out.contains(line), "{line}\n{}", said.out);
    }
}

#[test]
fn a_jam_is_told_of_who_jumps_then() {
    let model = "scenario \"fast\"\nhorizon = 1 s\nstep = 0.1 s\n\
process late { var on = false; when !on after 0.35 s -> on = true }\n\
process early { var n = true; when n & !late.on at 3e6 /s -> n = false; when !n & !late.on at 3e6 /s -> n = true }\n\
process blinker { var b = true; when b & late.on at 1e9 /s -> b = false; when !b & late.on at 1e9 /s -> b = true }\n";
    let said = Place::new(&[("a.scn", model)]).call(&["simulate", "a.scn"]).err;
    assert!(said.contains("at 0.4 s: more than 1048576 jumps") && said.contains("of `blinker`"), "{said}");
}

/// Three agents that go the same way.
const CROWD: &str = "horizon = 1 s\nstep = 0.1 s\n
    kind adult: sfm preset helbing2000 { noise = 0.1 m/s }
    agents crowd[3]: adult { at = uniform in rect (0, 0) .. (5, 5); route = (20, 0) }";

#[test]
fn traces_are_read_again_to_the_last_digit() {
    let place = Place::new(&[("a.scn", CROWD)]);
    let first: Vec<Value> = rows(&place, "a.scn", &["--trial", "2", "--until", "0"]);
    for (file, reader, trials) in
        [("t.csv", "csv", "{ trial = 2 }"), ("t.jsonl", "jsonl", "{ trial = 2 }"), ("t.txt", "pedpy", "")]
    {
        let number = if trials.is_empty() { "1" } else { "2" };
        let words = ["simulate", "a.scn", "--trial", "2", "--trials", number, "-o", file];
        assert_eq!(place.call(&words).code, Some(0), "{file}");
        let again = format!(
            "horizon = 1 s\nstep = 0.1 s\ntracks seen = {reader} \"{file}\" {trials}\n
             kind adult: sfm preset helbing2000\nagents crowd: adult from seen at 0 s"
        );
        std::fs::write(place.path("again.scn"), again).unwrap();
        let second = rows(&place, "again.scn", &["--until", "0"]);
        assert_eq!(second.len(), 3, "{file}");
        for (one, other) in first.iter().zip(&second) {
            for column in ["x", "y"] {
                assert_eq!(one[column].to_string(), other[column].to_string(), "{file} {column}");
            }
        }
    }
    let infer = place.call(&["infer", "t.csv", "--trial", "3", "--format", "csv"]);
    assert_eq!(infer.code, Some(0), "{}", infer.err);
    for (words, part) in [
        (&["infer", "t.csv"][..], "trial"),
        (&["infer", "t.csv", "--trial", "9"], "trial"),
        (&["infer", "t.txt", "--trial", "0"], "`pedpy` has no trials to choose from"),
    ] {
        let said = place.call(words);
        assert_eq!(said.code, Some(2), "{words:?} {}", said.err);
        assert!(said.err.contains(part), "{words:?} {}", said.err);
    }
}

#[test]
fn trials_of_a_verdict_are_kept() {
    let properties = "property slow = G<=1 s (forall a in crowd: speed(a) < 1.2 m/s)\n
        check P(slow) >= 0.5\ncheck P(F<=1 s (contact(crowd[1]))) <= 0.5\nestimate P(slow)";
    let place = Place::new(&[("a.scn", CROWD), ("p.bltl", properties), ("none.bltl", "estimate P(true)")]);
    let call = ["simulate", "a.scn", "p.bltl", "-n", "40", "--until", "0", "--format", "jsonl", "--keep"];
    let kept = |which: &str| {
        let said = place.call(&[&call[..], &[which]].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        let trials: std::collections::BTreeSet<u64> = said
            .out
            .lines()
            .map(|line| serde_json::from_str::<Value>(line).unwrap()["trial"].as_u64().unwrap())
            .collect();
        assert!(said.err.contains(&format!("kept {} of 40 trials", trials.len())), "{}", said.err);
        trials
    };
    let (violated, satisfied) = (kept("violated=slow"), kept("satisfied=slow"));
    assert!(violated.is_disjoint(&satisfied) && violated.len() + satisfied.len() == 40);
    assert_eq!(kept("satisfied=0"), satisfied);
    for (file, which, part) in [
        ("p.bltl", "violated", "there are 2 checks of a probability"),
        ("p.bltl", "violated=slwo", "did you mean `slow`?"),
        ("none.bltl", "violated", "needs a check of a probability"),
    ] {
        let said = place.call(&["simulate", "a.scn", file, "--keep", which]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{which}");
        assert!(said.err.contains(part), "{}", said.err);
    }
}

#[test]
fn what_a_format_of_traces_cannot_hold_is_refused() {
    let place =
        Place::new(&[("a.scn", CROWD), ("die.scn", "horizon = 3 steps\nprocess d { var s: 0 .. 1 = 0 }")]);
    for (words, part) in [
        (&["simulate", "a.scn", "-o", "t.xls"][..], "no format of traces has files that end with `.xls`"),
        (&["simulate", "a.scn", "-n", "2", "-o", "t.txt"], "`pedpy` holds one trial in a file (got 2)"),
        (&["simulate", "die.scn", "-o", "t.txt"], "the scenario has no agents"),
        (&["simulate", "a.scn", "-o", "missing/t.csv"], "missing/t.csv"),
        (&["simulate", "a.scn", "-o", "a.scn", "--format", "csv"], "a.scn"),
        (&["simulate", "a.scn", "-o", "t.html", "--format", "csv", "--report", "t.html"], "two results"),
    ] {
        let said = place.call(words);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}");
        assert!(said.err.contains(part), "{words:?} {}", said.err);
    }
    let said = place.call(&["simulate", "a.scn", "-n", "2", "-o", "t-{trial}.txt"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        place.path("t-0.txt").exists() && place.path("t-1.txt").exists() && !place.path("t.txt").exists()
    );
}

/// The formats of a build: those that no feature has left out.
fn is_built(name: &str) -> bool {
    smc::data::table::FORMATS.iter().any(|format| format.name == name && format.open.is_some())
}

#[test]
fn a_format_that_was_left_out_says_how_to_build_it() {
    let place = Place::new(&[("a.scn", CROWD)]);
    for name in ["parquet", "sqlite"].into_iter().filter(|name| !is_built(name)) {
        for words in [["--format".to_owned(), name.to_owned()], ["-o".to_owned(), format!("t.{name}")]] {
            let said = place.call(&["simulate", "a.scn", &words[0], &words[1]]);
            assert_eq!(said.code, Some(2), "{name}");
            assert!(said.err.contains(&format!("`--features {name}`")), "{}", said.err);
        }
    }
}

#[test]
fn pedpy_reads_what_is_written_for_it() {
    let Some(python) = crate::measures::python_with_pedpy() else {
        println!("skipped: PedPy is not installed; set SMC_PEDPY_PYTHON to a Python that has it");
        return;
    };
    let scenario = "scenario \"a walk in cm, framerate: 3\"\nhorizon = 2 s\nstep = 0.05 s\nscene {
        wall (-1, -1) -- (9, -1) -- (9, 6) -- (-1, 6) -- (-1, -1); obstacle desk: rect (6, 2) .. (7, 3); wall (3, 6) -- (3, 5) }
        kind adult: sfm preset helbing2000 { noise = 0.1 m/s }
        agent cm: adult { at = (1, 1); route = (8, 1) }
        agents framerate[4]: adult { at = uniform in rect (0, 0) .. (5, 4); route = (8, 5) }";
    let place = Place::new(&[("a.scn", scenario)]);
    let table = rows(&place, "a.scn", &["--every", "2"]);
    let mut names: Vec<&str> = Vec::new();
    let mut expected = String::new();
    for row in &table {
        let name = row["agent"].as_str().unwrap();
        if !names.contains(&name) {
            names.push(name);
        }
        let id = names.iter().position(|known| *known == name).unwrap() + 1;
        let frame = (row["time"].as_f64().unwrap() / 0.1).round();
        expected += &format!("{id} {frame} {} {}\n", row["x"], row["y"]);
    }
    place.write("expected", expected.as_bytes());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cli/traces.py");
    for (file, name) in [("a.txt", "pedpy"), ("a.sqlite", "sqlite")] {
        if !is_built(name) {
            println!("skipped: the feature `{name}` is off");
            continue;
        }
        let said = place.call(&["simulate", "a.scn", "--every", "2", "-o", file]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        let path = place.path(file);
        let words = [script, path.to_str().unwrap(), place.path("expected").to_str().unwrap(), "10"]
            .map(str::to_owned);
        let said = std::process::Command::new(&python).args(words).output().unwrap();
        assert!(said.status.success(), "{file}: {}", String::from_utf8_lossy(&said.stderr));
    }
}

#[test]
fn a_trial_of_a_table_is_replayed() {
    let replayed = "horizon = 1 s\nstep = 0.1 s\ntracks seen = csv \"t.csv\" { trial = TRIAL }\n\
        kind adult: sfm preset helbing2000\nagent user: adult from seen at 0.1 s id 1\n\
        agents others: adult from seen at 0.1 s except 1\n";
    let properties = "property near = F<=0.5 s (exists a in others: distance(user, a) < 1 m)\n";
    let place = Place::new(&[("a.scn", CROWD), ("p.bltl", properties)]);
    assert_eq!(place.call(&["simulate", "a.scn", "-n", "3", "-o", "t.csv"]).code, Some(0));
    for (trial, code) in [("1", 0), ("7", 2), ("0.5", 2), ("1 s", 2)] {
        place.write("b.scn", replayed.replace("TRIAL", trial).as_bytes());
        let said = place.call(&["monitor", "b.scn", "p.bltl", "--tracks", "seen"]);
        assert_eq!(said.code, Some(code), "{trial}: {}", said.err);
        assert_eq!(code == 2, said.err.contains("trial"), "{}", said.err);
    }
}
