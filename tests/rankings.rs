//! Options of rankings: named routes, values of parameters and their products. Each row of the table in
//! `docs/semantics.md` has its test.

use crate::cli::formats::validated;
use crate::program::{Place, timeless, written};
use serde_json::Value;

/// `c.x` ends as 1 with probability `p`, `d.x` with probability `q`.
const COINS: &str = "scenario \"coins\"\nhorizon = 1 steps\nparam p = 0.3 in 0 .. 1\nparam q = 50 % in 0 .. 1\n\
    process c {\n  var x: 0 .. 2 = 0\n  when x == 0 -> p: x = 1 | 1 - p: x = 2\n}\n\
    process d {\n  var x: 0 .. 2 = 0\n  when x == 0 -> q: x = 1 | 1 - q: x = 2\n}\n";

/// A robot with routes, and others on its way.
const HALL: &str = "scenario \"hall\"\nhorizon = 6 s\nstep = 0.02 s\nparam lane = 2 m in 0 m .. 4 m\n\
    scene {\n  wall (0, 0) -- (12, 0)\n  wall (0, 4) -- (12, 4)\n  region hall: rect (5, 0.5) .. (11, 3.5)\n\
    region west: rect (0, 0) .. (1, 4)\n  region goal: rect (6, 1) .. (8, 3)\n}\n\
    kind person: sfm preset helbing2000 { noise = 0.05 m/s }\n\
    agents crowd[3]: person { at = uniform in hall; route = west }\n";

const ROBOT: &str = "agent robot: person { at = (1, 2); route = (4 m, lane) -> goal }\n\
    moves robot for 1 s {\n  route left = (3, 3.4) -> goal\n  route pause = wait 2 s -> (3, 0.6) -> goal then leave\n\
    route there = goal\n  heading 20 deg\n  stop\n}\n";

fn called(scenario: &str, properties: &str, words: &[&str]) -> Value {
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", properties)]);
    let said = place.call(&[&["check", "a.scn", "a.bltl", "-q", "--format", "json"], words].concat());
    assert!(matches!(said.code, Some(0 | 1 | 4)), "{}{}", said.out, said.err);
    let mut json = said.json();
    validated(&json);
    timeless(&mut json);
    json
}

fn results(scenario: &str, properties: &str, words: &[&str]) -> Vec<Value> {
    called(scenario, properties, words)["results"].as_array().unwrap().clone()
}

fn labels(result: &Value) -> Vec<&str> {
    result["options"].as_array().unwrap().iter().map(|option| option["option"].as_str().unwrap()).collect()
}

/// The table that a line of a report shows.
fn shown(scenario: &str, line: &str) -> Vec<String> {
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", "let unused = 1\n")]);
    // As a shell takes it.
    let mut call: Vec<String> = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => call.push(String::new()),
            c => call.last_mut().unwrap().push(c),
        }
    }
    let words: Vec<&str> = call.iter().skip(1).map(String::as_str).collect();
    let said = place.call(&words);
    assert_eq!(said.code, Some(0), "{line}: {}", said.err);
    said.out.lines().map(str::to_owned).collect()
}

/// A value is a world as `under` makes it, with the random numbers of all others.
#[test]
fn values_are_the_worlds_that_under_sets() {
    let measure = "P(F (c.x == 1))";
    let text = format!(
        "rank p in 0.2, 0.5, 0.8 by {measure} within 0.1\n\
         rank p in 0.2 .. 0.8 by 0.3 by {measure} by okamoto(epsilon = 0.4, delta = 0.1)\n\
         rank p in 0.2 .. 0.8 by 0.3 by {measure} within 0.1 by one_challenger\n\
         rank p in 0.2 .. 0.8 by 0.3 by E(c.x at end) in 0 .. 2 within 0.1\n"
    );
    for result in results(COINS, &text, &[]) {
        let by_mean = result["query"].as_str().unwrap().contains("E(");
        assert_eq!(result["choice"], if by_mean { "p = 0.2" } else { "p = 0.8" }, "{result:#}");
        assert!(result["tied"] == false && result["certifies"] != "");
        for option in result["options"].as_array().unwrap() {
            assert_eq!(option["option"], format!("p = {}", written(&option["settings"]["p"])));
            if by_mean {
                continue;
            }
            let under = format!(
                "estimate {measure} by clopper_pearson(trials = {}) under {}\n",
                option["trials"],
                option["option"].as_str().unwrap()
            );
            let alone = &results(COINS, &under, &[])[0];
            assert_eq!(alone["successes"], option["successes"], "{under}");
        }
    }
}

#[test]
fn several_parameters_are_ranked_in_all_combinations() {
    let text = "rank p in 0.2, 0.8, q in 10 % .. 90 % by 40 % by P(F (c.x == 1 & d.x == 1)) within 0.1\n";
    let result = &results(COINS, text, &[])[0];
    assert_eq!(result["choice"], "p = 0.8, q = 90 %");
    let mut found = labels(result);
    found.sort_unstable();
    let all = ["0.2", "0.8"].map(|p| ["10", "50", "90"].map(|q| format!("p = {p}, q = {q} %")));
    assert_eq!(found, all.concat());
    let settings = &result["options"][0]["settings"];
    assert_eq!([written(&settings["p"]), written(&settings["q"])], ["0.8", "90 %"]);
}

#[test]
fn decades_have_as_many_values_as_they_say() {
    let text = "rank p in 0.001 .. 0.2 by log 3 by P(F (c.x == 1)) within 0.1\n";
    let result = &results(COINS, text, &["--max-trials", "1"])[0];
    let mut found: Vec<f64> =
        labels(result).iter().map(|label| label.trim_start_matches("p = ").parse().unwrap()).collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found, [0.001, 0.002_154_43, 0.004_641_59, 0.01, 0.021_544_3, 0.046_415_9, 0.1]);
    // The last one is there where it is meant.
    let swept =
        results(COINS, "estimate P(F (c.x == 1))\n", &["--set", "p=0.01..1 by log 1", "--max-trials", "1"]);
    let values: Vec<String> = swept.iter().map(|r| written(&r["settings"]["p"])).collect();
    assert_eq!(values, ["0.01", "0.1", "1"]);
    let listed = results(
        COINS,
        "estimate P(F (c.x == 1))\n",
        &["--set", "p=0.1,0.7", "--set", "q=max(0.1, 0.2)", "--max-trials", "1"],
    );
    let values: Vec<String> = listed.iter().map(|r| written(&r["settings"]["p"])).collect();
    assert_eq!(values, ["0.1", "0.7"]);
}

/// Of options that all carry the certificate the first one that was written is chosen.
#[test]
fn ties_of_values_and_routes_go_by_order_of_writing() {
    for (values, first) in [("0.9, 0.1, 0.4", "q = 90 %"), ("0.4, 0.9, 0.1", "q = 40 %")] {
        let text = format!("rank q in {values} by P(F (c.x == 1)) within 0.1\n");
        let result = &results(COINS, &text, &[])[0];
        assert_eq!((&result["choice"], &result["tied"]), (&first.into(), &true.into()), "{result:#}");
    }
    // All moves are alike for those who are far away.
    let far = format!("{HALL}agent robot: person {{ at = (1, 2) }}\nmoves robot for 1 s");
    let ties = |moves: &str| {
        let text = "rank moves of robot by P(F<=1 s (x(robot) < 12 m)) within 0.3\n";
        results(&format!("{far} {{ {moves} }}\n"), text, &[])[0]["choice"].as_str().unwrap().to_owned()
    };
    assert_eq!(ties("heading 40 deg; route b = goal; route a = goal; heading 10 deg"), "own way");
    let text = "rank moves of robot by P(F<=1 s (x(robot) < 12 m)) within 0.3\n";
    let all =
        &results(&format!("{far} {{ route b = goal; route a = goal; stop }}\n"), text, &[])[0]["options"];
    let order: Vec<&str> =
        all.as_array().unwrap().iter().map(|one| one["option"].as_str().unwrap()).collect();
    assert_eq!(order, ["own way", "route b", "route a", "stop"]);
}

/// A named route replaces the own one: the trial is that of an agent which was declared with it.
#[test]
fn a_named_route_is_as_if_it_were_the_own_one() {
    let declared = |route: &str| format!("{HALL}agent robot: person {{ at = (1, 2); route = {route} }}\n");
    let scenario = format!("{HALL}{ROBOT}");
    for (name, route) in [
        ("route left", "(3, 3.4) -> goal"),
        ("route pause", "wait 2 s -> (3, 0.6) -> goal then leave"),
        ("route there", "goal"),
    ] {
        for trial in ["0", "5"] {
            let call = format!("smc simulate a.scn --trial {trial}");
            let moved = shown(&scenario, &format!("{call} --move '{name}'"));
            assert!(moved.len() > 300 && moved == shown(&declared(route), &call), "{name}");
            assert_ne!(moved, shown(&scenario, &call), "{name}");
        }
    }
    // Who leaves by a move may be absent: a formula about everybody asks about those who are there.
    let text = "rank moves of robot by P(F<=6 s (count(a in everyone) == 3)) within 0.3\n";
    assert_eq!(results(&scenario, text, &[])[0]["choice"], "route pause");
}

/// Who does not follow advice keeps the own route.
#[test]
fn a_named_route_is_advice() {
    let with = |share: &str| {
        format!(
            "{HALL}behaviour heedful {{\n  state s {{ }}\n  on advice {{ choose {{ {share}: follow | 1 - {share}: ignore }} }}\n}}\n{}",
            ROBOT.replace("robot: person", "robot: person with heedful")
        )
    };
    let named = "smc simulate a.scn --trial 2 --move 'route left'";
    let own = "smc simulate a.scn --trial 2";
    let plain = format!("{HALL}{ROBOT}");
    let places = |scenario: &str, line: &str| -> Vec<String> {
        let rows = shown(scenario, line);
        rows.iter().map(|row| row.split(',').take(9).collect::<Vec<_>>().join(",")).collect()
    };
    assert_eq!(places(&with("1"), named), places(&plain, named));
    assert_eq!(places(&with("0"), named), places(&plain, own));
    assert_ne!(places(&plain, named), places(&plain, own));
}

/// A pause is addressed by the name of its route, so other moves change nothing of it.
#[test]
fn pauses_of_a_named_route_have_addresses_of_their_own() {
    let with = |moves: &str| {
        let robot = "agent robot: person { at = (1, 2); route = wait uniform(0 s, 3 s) -> goal }\n";
        let scenario = format!("{HALL}{robot}moves robot for 1 s {{ {moves} }}\n");
        let line = |name: &str| shown(&scenario, &format!("smc simulate a.scn --trial 3 --move '{name}'"));
        (line("route a"), line("route b"))
    };
    let law = "wait uniform(0 s, 3 s) -> goal";
    let (a, b) = with(&format!("route a = {law}; route b = {law}"));
    assert_ne!(a, b);
    assert_eq!(with(&format!("stop; route c = {law}; route b = {law}; route a = {law}")), (a, b));
}

/// The lines of a report show the trials of its options.
#[test]
fn witnesses_of_options_are_shown_by_their_lines() {
    let text = "rank p in 0.2, 0.8 by P(F (c.x == 1)) within 0.1 under q = 0.25\n";
    for witness in results(COINS, text, &[])[0]["witnesses"].as_array().unwrap() {
        let line = witness["command"].as_str().unwrap();
        assert!(line.contains("--set 'p=0.8'") && line.contains("--set 'q=25 %'"), "{line}");
        let rows = shown(COINS, line);
        let last = rows.last().unwrap();
        assert_eq!(
            last.split(',').nth(2),
            Some(if witness["shows"] == "holds" { "1" } else { "2" }),
            "{last}"
        );
    }
    let text = "rank moves of robot by P(F<=4 s (y(robot) > 2.8 m)) within 0.2\n";
    let result = &results(&format!("{HALL}{ROBOT}"), text, &[])[0];
    assert_eq!(result["choice"], "route left", "{result:#}");
    let line = result["witnesses"][0]["command"].as_str().unwrap();
    assert!(line.ends_with("--move 'route left'"), "{line}");
    let rows = shown(&format!("{HALL}{ROBOT}"), line);
    let y = |row: &String| row.split(',').nth(4).and_then(|y| y.parse::<f64>().ok()).unwrap();
    let highest = rows.iter().filter(|row| row.contains(",robot,")).map(y).fold(0.0, f64::max);
    assert!(highest > 2.7, "{highest}");
}

const MANY: &str = "\
rank lane in 0.5 m .. 3.5 m by 1 m by P(G<=2 s (clearance(robot) > 0.3 m)) within 0.1
rank lane in 0.5 m, 3.5 m by E(min<=2 s (clearance(robot))) in -1 m .. 5 m within 0.2 m
rank moves of robot by P(G<=2 s (clearance(robot) > 0.3 m)) within 0.1
rank moves of robot by P(G<=2 s (clearance(robot) > 0.3 m)) within 0.1 under lane = 1 m
rank lane in 0.5 m, 3.5 m by P(F<=3 s (x(robot) > 3 m)) by okamoto(epsilon = 0.3, delta = 0.2)
";

#[test]
fn threads_change_no_byte() {
    let scenario = format!("{HALL}{ROBOT}");
    let run =
        |words: &[&str]| called(&scenario, MANY, &[&["--max-trials", "150"], words].concat()).to_string();
    let one = run(&["-j", "1"]);
    for words in [&["-j", "2"][..], &["-j", "8"]] {
        assert_eq!(run(words), one, "{words:?}");
    }
}

/// A query that sets the swept parameter in all its worlds is asked once, and others for each value.
#[test]
fn what_a_sweep_cannot_change_is_asked_once() {
    let once = [
        "compare P(F (c.x == 1)) under p = 0.2 with p = 0.8 within 0.2",
        "rank p in 0.2, 0.8 by P(F (c.x == 1)) within 0.2",
        "rank q in 0.2, 0.8 by P(F (c.x == 1 & d.x == 1)) within 0.2 under p = 0.5",
        "estimate P(F (c.x == 1)) within 0.2 under p = 0.5",
    ];
    let often = [
        "compare P(F (c.x == 1)) under p = p with p = 0.8 within 0.2",
        "compare P(F (c.x == 1 & d.x == 1)) under q = 0.2 with q = 0.8 within 0.2",
        "rank q in 0.2, 0.8 by P(F (c.x == 1 & d.x == 1)) within 0.2",
    ];
    let text = once.iter().chain(&often).map(|query| format!("{query}\n")).collect::<String>();
    for (words, points) in [(&["--set", "p=0.1..0.5 by 0.2"][..], 3), (&["--set", "p=0.1,0.3"], 2)] {
        let json = called(COINS, &text, words);
        let found = json["results"].as_array().unwrap();
        let count = |index: usize| found.iter().filter(|result| result["index"] == index).count();
        let counts: Vec<usize> = (0..once.len() + often.len()).map(count).collect();
        assert_eq!(counts, [[1; 4].as_slice(), &[points; 3]].concat());
        // As without the sweep, but for the line that runs it again.
        for (result, alone) in found.iter().zip(results(COINS, &text, &[])).take(once.len()) {
            for field in ["query", "settings", "estimate", "trials", "choice", "options", "certifies"] {
                assert_eq!(result[field], alone[field], "{field}");
            }
        }
    }
}

#[test]
fn forecasts_and_formats_know_values_and_routes() {
    let place = Place::new(&[("a.scn", &format!("{HALL}{ROBOT}")), ("a.bltl", MANY)]);
    let said = |words: &[&str]| {
        let said = place.call(&[&["check", "a.scn", "a.bltl", "--max-trials", "40"], words].concat());
        assert!(matches!(said.code, Some(0 | 4)), "{}", said.err);
        said.out
    };
    assert!(said(&["--forecast"]).contains("rank lane in 0.5 m .. 3.5 m by 1 m by"));
    for (format, mark) in [("text", "lane = 2.5 m"), ("junit", "rank lane in"), ("github", "")] {
        assert!(said(&["-q", "--format", format]).contains(mark), "{format}");
    }
    said(&["-q", "--report", "page.html"]);
    let page = std::fs::read_to_string(place.path("page.html")).unwrap();
    assert!(page.contains("lane = 2.5 m") && page.contains("route pause"));
    let shown = place.call(&["show", "a.scn"]).out;
    assert!(shown.contains("route left (goes (3, 3.4) -> goal)"), "{shown}");
}

/// The lower one of two options whose joint intervals do not meet is beaten, also where the budget cuts the first round.
#[test]
fn statuses_follow_the_intervals() {
    let mut beaten = 0;
    for total in ["9", "15", "30", "48", "90", "400"] {
        for by in ["P(F<=1 c.x == 1)", "E(if(c.x == 1, 1, 0) at end) in 0 .. 1"] {
            let line = format!("rank p in 0, 0.5, 0.9, 1 by {by} within 0.1\n");
            let result = &results(COINS, &line, &["--total-trials", total])[0];
            let options = result["options"].as_array().unwrap();
            let number = |option: &Value, field: &str| option[field].as_f64().unwrap();
            let best = options.iter().map(|option| number(option, "low")).fold(0.0, f64::max);
            for option in options {
                let below = number(option, "high") < best;
                assert!(!below || option["status"] == "beaten", "{total} {by}: {result}");
                beaten += usize::from(option["status"] == "beaten");
            }
        }
    }
    assert!(beaten > 6, "{beaten}");
}

/// Moves of two agents together: each pair is an option, and its command shows it.
#[test]
fn moves_of_two_agents_are_ranked_together() {
    let scenario = "horizon = 8 s\nstep = 0.02 s\n\
        scene { wall (0, 0) -- (12, 0); wall (0, 1.2) -- (12, 1.2); region east: rect (10, 0) .. (12, 1.2)\n\
        region west: rect (0, 0) .. (2, 1.2) }\n\
        kind cart: sfm preset helbing2000 { radius = 0.25 m; speed = 1.2 m/s; noise = 0 m/s }\n\
        agent a: cart { at = (2.5, 0.6); route = east }\nagent b: cart { at = (9.5, 0.6); route = west }\n\
        moves a for 8 s { stop }\nmoves b for 8 s { stop }\n";
    let ask = "property apart = G<=7 s (distance(a, b) > 5 m)\nrank moves of a, moves of b by P(apart) within 0.1\n";
    let result = &results(scenario, ask, &[])[0];
    // Only if both stand they stay apart.
    assert_eq!(result["choice"], "a: stop and b: stop", "{result:#}");
    assert_eq!(labels(result).len(), 4);
    let command = result["witnesses"][0]["command"].as_str().unwrap();
    assert!(command.ends_with("--move 'a: stop and b: stop'"), "{command}");
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", ask)]);
    let table = place.call(&["simulate", "a.scn", "--move", "a: stop and b: own way", "--every", "350"]).out;
    let x = |name: &str| -> Vec<f64> {
        let rows = table.lines().filter(|line| line.split(',').nth(2) == Some(name));
        rows.map(|line| line.split(',').nth(3).unwrap().parse().unwrap()).collect()
    };
    let (a, b) = (x("a"), x("b"));
    assert!((a[0] - 2.5).abs() < 1e-9 && a[1] < 3.2 && b[1] < 8.0, "{table}");
    for (text, said) in [
        ("rank moves of a, moves of a by P(true)\n", "listed twice"),
        ("rank moves of a, moves of b, moves of a by P(true)\n", "listed twice"),
        ("rank moves of a, paths of b by P(true)\n", "the scenario declares no paths for `b`"),
    ] {
        place.write("a.bltl", text.as_bytes());
        let found = place.call(&["check", "a.scn", "a.bltl", "-q"]);
        assert!(found.code == Some(2) && found.err.contains(said), "{text}{}", found.err);
    }
    let unknown = place.call(&["simulate", "a.scn", "--move", "a: stop and c: stop"]);
    assert!(unknown.code == Some(2) && unknown.err.contains("unknown moves"), "{}", unknown.err);
}

/// Three agents, of whom one chooses among paths: all combinations, each with its name and its command.
#[test]
fn paths_and_moves_of_three_agents_are_ranked_together() {
    let scenario = "horizon = 20 s\nstep = 0.02 s\n\
        scene { wall (0, 0) -- (12, 0); wall (0, 6) -- (12, 6); obstacle block: rect (5, 2) .. (7, 4)\n\
        region east: rect (10, 0) .. (12, 6); region west: rect (0, 0) .. (2, 6) }\n\
        kind planner: planned { roadmap = prm(samples = 300); limit speed = 1.4 m/s }\n\
        kind cart: sfm preset helbing2000 { speed = 1.2 m/s; noise = 0 m/s }\n\
        agent a: planner { at = (1, 3); route = east }\n\
        agent b: cart { at = (11, 3); route = west }\nagent c: cart { at = (11, 1); route = west }\n\
        paths a { roadmap alternatives 2 }\nmoves b for 20 s { stop }\nmoves c for 20 s { stop }\n";
    let ask = "rank paths of a, moves of b, moves of c by P(F<=15 s (a in east) & G<=9 s (distance(b, c) > 1 m)) within 0.2\n";
    let result = &results(scenario, ask, &[])[0];
    let all = labels(result);
    assert_eq!(all.len() % 4, 0, "{all:?}");
    assert!(all.iter().all(|label| label.starts_with("a: path ") && label.contains(" and c: ")), "{all:?}");
    let command = result["witnesses"][0]["command"].as_str().unwrap();
    assert!(command.contains(&format!("--move '{}'", result["choice"].as_str().unwrap())), "{command}");
}

/// The moves of a group that is simulated member by member: all of them take the same option, each from its own direction.
#[test]
fn the_moves_of_a_group_are_those_of_all_its_members() {
    let scenario = "horizon = 6 s\nstep = 0.02 s\nscene { region east: rect (20, 0) .. (22, 8) }\n\
        kind calm: sfm preset helbing2000 { A = 0 N; noise = 0 m/s }\n\
        group party[3]: calm { at = uniform in rect (1, 2) .. (3, 5); route = east; attraction = 0 N }\n\
        agents crowd[2]: calm { at = uniform in rect (8, 2) .. (9, 5); route = (0, 3) }\n\
        moves party for 5 s { heading 90 deg; stop }\n";
    let ask = "rank moves of party by P(G<=4 s (forall a in party: travelled(a) < 0.5 m)) within 0.1\n";
    let result = &results(scenario, ask, &[])[0];
    assert_eq!(result["choice"], "stop", "{result:#}");
    assert_eq!(labels(result).len(), 3);
    let place = Place::new(&[("a.scn", scenario), ("a.bltl", ask)]);
    let table = place.call(&["simulate", "a.scn", "--move", "heading 90 deg", "--every", "200"]).out;
    for name in ["party[1]", "party[2]", "party[3]"] {
        let rows = table.lines().filter(|line| line.split(',').nth(2) == Some(name));
        let y: Vec<f64> = rows.map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
        assert!(y[1] - y[0] > 3.0, "{name}: {y:?}");
    }
    for (text, said) in [
        ("rank moves of party[1] by P(true)\n", "declares no moves for `party[1]`"),
        ("rank moves of crowd by P(true)\n", "expected an agent"),
    ] {
        place.write("a.bltl", text.as_bytes());
        let found = place.call(&["check", "a.scn", "a.bltl", "-q"]);
        assert!(found.code == Some(2) && found.err.contains(said), "{text}{}", found.err);
    }
}

/// Moves and values together: every combination is an option, under one certificate, and its witness repeats it.
#[test]
fn moves_and_values_are_ranked_together() {
    let scenario = "horizon = 6 s\nstep = 0.02 s\nparam pace = 1 m/s in 0.5 m/s .. 2 m/s\n\
        scene { region goal: rect (5, 0) .. (8, 4) }\n\
        kind cart: sfm preset helbing2000 { speed = pace; noise = 0 m/s }\n\
        agent robot: cart { at = (1, 2); route = goal }\nmoves robot for 3 s { stop }\n";
    // 4 m take 2.7 s and 4.5 s with 1.5 m/s and 0.9 m/s, and 3 s more after a stop.
    let ask =
        "rank moves of robot, pace in 0.6 m/s, 0.9 m/s, 1.5 m/s by P(F<=4 s (robot in goal)) within 0.1\n";
    let result = &results(scenario, ask, &[])[0];
    assert_eq!(result["choice"], "own way, pace = 1.5 m/s", "{result:#}");
    let mut all = labels(result);
    all.sort_unstable();
    let wanted: Vec<String> = ["own way", "stop"]
        .iter()
        .flat_map(|option| [0.6, 0.9, 1.5].map(|pace| format!("{option}, pace = {pace} m/s")))
        .collect();
    assert_eq!(all, wanted);
    let options = result["options"].as_array().unwrap();
    assert!(
        options[1..].iter().all(|option| option["estimate"] == 0 && option["status"] == "beaten"),
        "{result:#}"
    );
    let command = result["witnesses"][0]["command"].as_str().unwrap();
    assert!(command.contains("--set 'pace=1.5 m/s'") && command.ends_with("--move 'own way'"), "{command}");
    // The best move is the same in a ranking of that pace alone.
    let alone =
        &results(scenario, &ask.replace(", pace in 0.6 m/s, 0.9 m/s, 1.5 m/s", ""), &["--set", "pace=1.5"])
            [0];
    assert_eq!(alone["choice"], "own way", "{alone:#}");
    // The own way at the first value is chosen among equal ones.
    let equal = &results(scenario, &ask.replace("<=4 s", "<=6 s").replace("0.6 m/s, ", ""), &[])[0];
    assert_eq!(equal["choice"], "own way, pace = 0.9 m/s", "{equal:#}");
    for (text, said) in [
        (
            "rank moves of robot, pace in 0.5 m/s .. 1.5 m/s by 0.0015 m/s by P(true) within 0.1\n",
            "at most 1000 options",
        ),
        ("rank moves of robot, speed in 1, 2 by P(true) within 0.1\n", "unknown parameter"),
        ("rank moves of cart, pace in 1 m/s, 2 m/s by P(true) within 0.1\n", "`cart`"),
    ] {
        let place = Place::new(&[("a.scn", scenario), ("a.bltl", text)]);
        let found = place.call(&["check", "a.scn", "a.bltl", "-q"]);
        assert!(found.code == Some(2) && found.err.contains(said), "{text}{}", found.err);
    }
}
