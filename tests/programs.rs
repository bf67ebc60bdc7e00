//! Programs that stand in the place of a model: their trials are asked as those of a scenario, and nothing of a program that
//! misbehaves is believed.
#![cfg(unix)]

use crate::program::{Place, Said, timeless};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A scenario whose program is `sh p.sh`, with words and lines of its own.
fn scenario(words: &str, lines: &str) -> String {
    // A choice that nothing uses is an error.
    let side = if words.contains("{side}") { "param side = left in left, right\n" } else { "" };
    format!(
        "horizon = 1 s\nstep = 0.5 s\nparam width = 120 cm\nparam number = 3\n{side}\
         program sim {{\n  run = \"sh p.sh {words}\"\n{lines}\n}}\n"
    )
}

const SIGNAL: &str = "signal v = column(\"v\") * 1 m/s";
const ALWAYS: &str = "check P(G<=1 s (v > 0 m/s)) >= 0.5";

/// Checks a property of a program that is this script.
fn check(script: &str, (words, lines): (&str, &str), queries: &str, more: &[&str]) -> Said {
    let scenario = scenario(words, lines);
    let place = Place::new(&[("p.sh", script), ("a.scn", &scenario), ("a.bltl", queries)]);
    place.call(&[&["check", "a.scn", "a.bltl", "--allow-run"], more].concat())
}

fn ask(script: &str, more: &[&str]) -> Said {
    check(script, ("{seed}", SIGNAL), ALWAYS, more)
}

/// Three rows in which `v` is what `awk` makes of the seed.
const DRAW: &str = r#"
awk -v seed="$1" 'BEGIN { srand(seed); rand(); v = rand() < 0.8; print "t,v"; for (k = 0; k < 3; k++) print k / 2 "," v }'
"#;

#[test]
fn any_number_of_threads_and_of_shards_gives_the_same_results() {
    let results = |more: &[&str]| {
        let said = ask(DRAW, &[&["--format", "json", "--seed", "7"], more].concat());
        let mut json = said.json();
        timeless(&mut json);
        assert_eq!(json["results"][0]["verdict"], "satisfied", "{}", said.err);
        json["results"].take()
    };
    let one = results(&["-j", "1"]);
    assert!(
        one[0]["given"].as_str().unwrap().starts_with("the given program, if its trials are independent")
    );
    assert_eq!(one, results(&["-j", "3"]));
    assert_eq!(one, results(&["--launch", "local", "-j", "2"]));
}

#[test]
fn nothing_runs_that_was_not_allowed() {
    let model = scenario("{seed}", SIGNAL);
    let place = Place::new(&[("p.sh", "touch ran"), ("a.scn", &model), ("a.bltl", ALWAYS)]);
    for words in [
        &["check", "a.scn", "a.bltl"][..],
        &["check", "a.scn", "a.bltl", "--forecast"],
        &["simulate", "a.scn"],
        &["simulate", "a.scn", "--report", "a.html"],
    ] {
        let said = place.call(words);
        assert_eq!(said.code, Some(2), "{words:?} {}", said.out);
        assert!(
            said.err.contains("error[E0729]: the program `sim` would run `sh p.sh {seed}`"),
            "{}",
            said.err
        );
    }
    let shown = place.call(&["show", "a.scn", "a.bltl"]);
    assert!(shown.out.contains("Program sim\n  run sh p.sh {seed}\n"), "{}", shown.out);
    assert_eq!(place.call(&["fmt", "a.scn"]).code, Some(0));
    assert!(!place.path("ran").exists());
}

#[test]
fn words_name_parameters_moves_seeds_and_trials() {
    let script = r#"
echo "$*" >> calls
echo t,id,x,y,v
for t in 0 0.5 1; do echo $t,a,1,2,1; done
"#;
    let lines = "signal v = column(\"v\")\nagents people[2] = columns(\"id\", \"x\", \"y\")";
    let model = scenario("--w={width} {side} {number} {trial} {move} {seed}", lines)
        + "moves people[1] for 1 s { stop }\n";
    let queries = "rank moves of people[1] by P(F<=1 s (v > 0)) within 0.5\n";
    let place = Place::new(&[("p.sh", script), ("a.scn", &model), ("a.bltl", queries)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "--allow-run", "--set", "side=right", "-q"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let calls = std::fs::read_to_string(place.path("calls")).unwrap();
    let mut seeds = std::collections::BTreeMap::new();
    for call in calls.lines() {
        let (rest, seed) = call.rsplit_once(' ').unwrap();
        let trial: u64 = rest.split(' ').nth(3).unwrap().parse().unwrap();
        assert!(
            rest == format!("--w=1.2 right 3 {trial} stop")
                || rest == format!("--w=1.2 right 3 {trial} own way"),
            "{call}"
        );
        // A trial has one seed whatever move is followed.
        assert_eq!(*seeds.entry(trial).or_insert(seed.to_owned()), seed);
    }
    let different: std::collections::BTreeSet<&String> = seeds.values().collect();
    assert!(seeds.len() > 3 && different.len() == seeds.len(), "{seeds:?}");
}

#[test]
fn people_are_where_their_columns_say() {
    // Two walk through a line at 2 m/s and 1 m/s; the second one comes later and leaves.
    let script = r#"
echo "t,id,x,y"
echo "0,a,0,1"
echo "0.5,a,1,1"; echo "0.5,b,4,1"
echo "1,a,2,1"
"#;
    let lines = "agents people[2] = columns(\"id\", \"x\", \"y\")\nradius = 30 cm";
    let model = scenario("{seed}", lines)
        + "scene { line gate: (1.5, 0) -- (1.5, 2); region end: rect (1.9, 0) .. (3, 2); wall (0, 2) -- (9, 2) }\n";
    let queries = [
        ("E(crossings(gate) at end) in 0 .. 9", 1.0),
        ("E(speed(people[1]) at 0 s) in 0 m/s .. 9 m/s", 2.0),
        ("E(speed(people[1]) at end) in 0 m/s .. 9 m/s", 2.0),
        ("E(distance(people[1], people[2]) at 0.5 s) in 0 m .. 9 m", 3.0),
        ("E(count(a in people: true) at 0.5 s) in 0 .. 9", 2.0),
        ("E(count(a in people: true) at end) in 0 .. 9", 1.0),
        ("E(travelled(people[1]) at end) in 0 m .. 9 m", 2.0),
        ("E(clearance(people[1]) at end) in 0 m .. 9 m", 0.7),
        ("E(time_until(people[1] in end)) in 0 s .. 1 s", 1.0),
        ("E(radius(people[1]) at end) in 0 m .. 9 m", 0.3),
    ];
    let text: String =
        queries.iter().map(|(query, _)| format!("estimate {query} by fixed(trials = 2)\n")).collect();
    let place = Place::new(&[("p.sh", script), ("a.scn", &model), ("a.bltl", &text)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "--allow-run", "--format", "json"]);
    let json = said.json();
    for (k, (query, wanted)) in queries.iter().enumerate() {
        let found = json["results"][k]["estimate"].as_f64();
        assert!(found.is_some_and(|found| (found - wanted).abs() < 1e-9), "{query}: {found:?} {}", said.err);
    }
    // `b` has not come at the start.
    let place = Place::new(&[
        ("p.sh", script),
        ("a.scn", &model),
        ("a.bltl", "estimate P(F<=1 s (x(people[2]) > 3 m))"),
    ]);
    assert_eq!(place.call(&["check", "a.scn", "a.bltl", "--allow-run", "-q"]).code, Some(0));
    // Rows of `simulate` are those of the program.
    let rows = place.call(&["simulate", "a.scn", "--allow-run"]).out;
    assert!(
        rows.contains("0.5,0,people[2],4,1,") && rows.contains("1,0,people[1],2,1,2,0,2,1,0.3"),
        "{rows}"
    );
}

#[test]
fn jsonl_holds_the_same_as_csv() {
    let jsonl = r#"
for t in 0 0.5 1; do echo "{\"t\": $t, \"v\": true, \"id\": 7, \"x\": 1.5, \"y\": 2}"; done
"#;
    let lines = "trace = jsonl\nsignal v = column(\"v\") == 1\nagents people = columns(\"id\", \"x\", \"y\")";
    let queries = "check P(G<=1 s (v & x(people[1]) > 1.4 m)) >= 0.5";
    let said = check(jsonl, ("{seed}", lines), queries, &["-q"]);
    assert!(said.code == Some(0) && said.out.contains("satisfied"), "{}{}", said.out, said.err);
}

#[test]
fn a_trial_of_a_program_that_misbehaves_is_unresolved() {
    let rows = |rows: &str| format!("printf '{rows}'");
    for (script, wanted) in [
        (
            "echo t,v; echo 'ValueError: no door' >&2; exit 3".to_owned(),
            "exit code 3; its standard error ends with: ValueError: no door",
        ),
        ("kill -9 $$".to_owned(), "ended by a signal"),
        ("true".to_owned(), "the output is empty"),
        (rows("t,w\\n0,1\\n"), "there is no column `v`; the columns are t, w"),
        (rows("t,v\\n0,1\\n0.5,nan\\n"), "line 3: `v` is `nan`, which is no finite number"),
        (rows("t,v\\n0,fast\\n"), "line 2: `v` is `fast`"),
        (rows("t,v\\n0,1\\n1,1\\n"), "line 3 has the time 1, and the next state is at 0.5"),
        (rows("t,v\\n0,1\\n0.3,1\\n"), "line 3 has the time 0.3"),
        (rows("t,v\\n0.5,1\\n"), "line 2 has the time 0.5, and the next state is at 0"),
        (rows("t,v\\n0,1\\n0,1\\n"), "line 3 is a second row at 0"),
        (rows("t,v\\n0,1\\n0.5\\n"), "line 3: there is no `v`"),
        (rows("t,v\\n0,1\\n0.5,1\\n"), "ends at 0.5, before the horizon at 1"),
        (rows("\\377\\376,v\\n0,1\\n"), "UTF-8"),
    ] {
        let said = ask(&script, &["-q", "--max-trials", "40"]);
        assert_eq!(said.code, Some(3), "{script}: {}{}", said.out, said.err);
        assert!(said.out.contains(wanted) && said.out.contains("no result"), "{script}: {}", said.out);
    }
    let held = rows("t,v\\n0,1\\n");
    let said = check(&held, ("{seed}", &format!("{SIGNAL}\nends = held")), ALWAYS, &["-q"]);
    assert!(said.out.contains("satisfied"), "{}", said.out);
    for (rows, wanted) in [
        ("0,a,1,2,1\\n0,a,1,2,1\\n", "line 3: `a` is there twice at 0"),
        ("0,a,1,2,1\\n0,b,1,2,2\\n", "line 3: `v` is 2 here and 1 in another row of this time"),
        ("0,a,1,2,1\\n0,b,1,2,1\\n0,c,1,2,1\\n", "`c` is one more than the 2 people for whom there is room"),
        ("0,a,,2,1\\n", "line 2: `x` is ``"),
    ] {
        let lines = format!("{SIGNAL}\nagents people[2] = columns(\"id\", \"x\", \"y\")");
        let script = format!("printf 't,id,x,y,v\\n{rows}'");
        let said = check(&script, ("{seed}", &lines), ALWAYS, &["-q", "--max-trials", "40"]);
        assert!(said.code == Some(3) && said.out.contains(wanted), "{rows}: {}{}", said.out, said.err);
    }
}

#[test]
fn a_program_that_ignores_its_seed_or_is_not_there_is_an_error() {
    let unsteady = "echo x >> count; n=$(wc -l < count); printf \"t,v\\n0,$n\\n0.5,1\\n1,1\\n\"";
    let said = ask(unsteady, &["-q"]);
    assert_eq!(said.code, Some(2), "{}", said.out);
    assert!(said.err.contains("error[E0915]") && said.err.contains("trial 0"), "{}", said.err);
    let model = scenario("{seed}", SIGNAL).replace("sh p.sh", "./nowhere");
    let place = Place::new(&[("a.scn", &model), ("a.bltl", ALWAYS)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "--allow-run"]);
    assert_eq!(said.code, Some(2), "{}", said.out);
    assert!(said.err.contains("error[E0916]"), "{}", said.err);
    // Equal traces under all seeds may be chance, so that is a warning.
    let said = ask("printf 't,v\\n0,1\\n0.5,1\\n1,1\\n'", &["-q"]);
    assert!(said.code == Some(0) && said.out.contains("are equal; does the program draw"), "{}", said.out);
}

#[test]
fn outcomes_that_depend_on_each_other_are_told() {
    // What comes out changes every fifty trials.
    let script = "v=$(( $1 / 50 % 2 )); printf \"t,v\\n0,$v\\n0.5,$v\\n1,$v\\n\"";
    let queries = "estimate P(G<=1 s (v > 0 m/s)) by clopper_pearson(trials = 400)";
    let said = check(script, ("{trial}", SIGNAL), queries, &["-q"]);
    assert!(said.out.contains("depend on each other: 400 of them have 8 runs"), "{}", said.out);
    for more in [["--certificate", "a.smcc"], ["--launch", "local"]] {
        let said = check(script, ("{trial}", SIGNAL), queries, &[&["-q"], &more[..]].concat());
        assert!(said.out.contains("400 of them have 8 runs"), "{more:?}: {}", said.out);
    }
    // The same for each move of a ranking.
    let script = "v=$(( $1 / 20 % 2 )); echo t,id,x,y,v; for t in 0 0.5 1; do echo $t,a,1,2,$v; done";
    let lines = "signal v = column(\"v\")\nagents people[1] = columns(\"id\", \"x\", \"y\")\n}\n\
                 moves people[1] for 1 s { stop ";
    let ranked = "rank moves of people[1] by P(F<=1 s (v > 0)) within 0.15";
    let said = check(script, ("{trial} {move}", lines), ranked, &["-q"]);
    assert!(said.out.contains("depend on each other"), "{}{}", said.out, said.err);
    let said = check(DRAW, ("{seed}", SIGNAL), queries, &["-q"]);
    assert!(!said.out.contains("depend on each other"), "{}", said.out);
}

#[test]
fn wrong_declarations_are_refused() {
    for (words, lines, more, wanted) in [
        ("", SIGNAL, "", "error[E0411]: the program is not told its seed"),
        ("{seed} {wdith}", SIGNAL, "", "error[E0201]: unknown parameter `wdith`"),
        ("{seed} {width", SIGNAL, "", "error[E0411]: `{width` opens a brace"),
        ("{seed}", "trace = xml", "", "error[E0305]: expected `csv` or `jsonl`"),
        ("{seed}", "ends = held\nlimit = 0 s", "", "error[E0305]: expected a value above 0"),
        ("{seed}", "ends = held; ends = held", "", "error[E0202]: `ends` is set twice"),
        ("{seed}", "speed = 3", "", "error[E0207]: unknown field `speed`"),
        (
            "{seed}",
            "agents people = columns(\"id\", \"x\")",
            "",
            "error[E0305]: expected `columns(\"id\", \"x\", \"y\")`",
        ),
        (
            "{seed}",
            "agents a = columns(\"i\", \"x\", \"y\"); agents b = columns(\"i\", \"x\", \"y\")",
            "",
            "error[E0118]",
        ),
        ("{seed}", SIGNAL, "process q { var n = 0 }", "error[E0411]: `q` has no part in the program `sim`"),
        (
            "{seed}",
            SIGNAL,
            "program two { run = \"x {seed}\" }",
            "error[E0411]: a scenario can have only one program",
        ),
    ] {
        let model = scenario(words, lines) + more + "\n";
        let place = Place::new(&[("a.scn", &model)]);
        let said = place.call(&["show", "a.scn"]);
        assert!(said.code == Some(2) && said.err.contains(wanted), "{wanted}: {}", said.err);
    }
    let model = scenario("{seed}", SIGNAL).replace("run =", "time =");
    let said = Place::new(&[("a.scn", &model)]).call(&["show", "a.scn"]);
    assert!(said.err.contains("error[E0209]: program `sim` has no `run`"), "{}", said.err);
    let split = "estimate P(F<=1 s (v > 0 m/s)) by splitting(replicas = 100)";
    let said = check(DRAW, ("{seed}", SIGNAL), split, &[]);
    assert!(
        said.code == Some(2) && said.err.contains("error[E0603]: trials of a program cannot be split"),
        "{}",
        said.err
    );
}

/// Whether a process still runs with this word.
fn runs(word: &str) -> bool {
    let all = Command::new("ps").args(["-eo", "args"]).output().unwrap();
    String::from_utf8_lossy(&all.stdout).lines().any(|line| line.starts_with("sleep") && line.contains(word))
}

#[test]
fn no_process_is_left_behind() {
    let wait_until = |is_so: &dyn Fn() -> bool| {
        let end = Instant::now() + Duration::from_secs(20);
        while !is_so() && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(20));
        }
        assert!(is_so());
    };
    // A program that goes on in the background, one beyond its limit, and one beyond the time of the call.
    let said = ask("sleep 4711.1 & printf 't,v\\n0,1\\n0.5,1\\n1,1\\n'", &["-q", "--max-trials", "4"]);
    assert!(said.out.contains("4 trials (4 hold"), "{}", said.out);
    let lines = format!("{SIGNAL}\nlimit = 100 ms");
    let said = check("sleep 4711.2", ("{seed}", &lines), ALWAYS, &["-q", "--max-trials", "4"]);
    assert!(said.out.contains("took longer than 0.1 s"), "{}", said.out);
    let said = ask("sleep 4711.3", &["-q", "--timeout", "200ms"]);
    assert_eq!(said.code, Some(3), "{}", said.out);
    for word in ["4711.1", "4711.2", "4711.3"] {
        wait_until(&|| !runs(word));
    }
    // An interruption is waited for, a second one is not.
    let model = scenario("{seed}", SIGNAL);
    let place = Place::new(&[("p.sh", "sleep 4711.4"), ("a.scn", &model), ("a.bltl", ALWAYS)]);
    let mut call = place.command(&["check", "a.scn", "a.bltl", "--allow-run", "-q"]);
    let mut child = call.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_until(&|| runs("4711.4"));
    let interrupt = || Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    interrupt();
    interrupt();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    wait_until(&|| !runs("4711.4"));
}

#[test]
fn jupedsim_under_check_and_rank() {
    // The interpreter that has it comes first on the path, if one is named.
    let path = std::env::var("PATH").unwrap_or_default();
    let named = std::env::var("SMC_JUPEDSIM_PYTHON").unwrap_or_default();
    let path =
        Path::new(&named).parent().map_or(path.clone(), |folder| format!("{}:{path}", folder.display()));
    let mut has = Command::new("python3");
    has.args(["-c", "import jupedsim"]).env("PATH", &path).stderr(Stdio::null());
    if !has.status().is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED: python3 has no jupedsim");
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/programs");
    let mut call = Command::new(env!("CARGO_BIN_EXE_smc"));
    call.args(["check", "bottleneck.scn", "bottleneck.bltl", "--allow-run", "-q", "--format", "json"]);
    let said = Said::of(&call.current_dir(folder).env("PATH", &path).stdin(Stdio::null()).output().unwrap());
    let json = said.json();
    assert_eq!(json["results"][0]["verdict"], "satisfied", "{}", said.err);
    let time = json["results"][1]["estimate"].as_f64().unwrap();
    assert!((12.0..=16.0).contains(&time), "{time}");
    assert!(said.out.contains("width = 1.2 m"));
}

#[test]
fn the_library_runs_programs_that_it_is_allowed_to() {
    let place = Place::new(&[("p.sh", DRAW)]);
    let draft = smc::Draft::new("a.scn", scenario("{seed}", SIGNAL));
    let options = smc::Options::default().max_trials(200);
    let refused = draft.clone().parse().unwrap().check(ALWAYS, &options).unwrap_err();
    assert!(refused.to_string().contains("E0729"), "{refused}");
    let model = draft.allow_run(place.path("")).parse().unwrap();
    let report = model.check(ALWAYS, &options).unwrap();
    assert!(report.results()[0].verdict.is_some());
    let states: Vec<f64> = model.trial(0, 1).unwrap().map(|state| state.variable("sim.v").unwrap()).collect();
    assert!(states.len() == 3 && states.iter().all(|v| *v == states[0]), "{states:?}");
}
