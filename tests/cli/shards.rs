//! Trials in shards: the same report, whoever launches them and whatever is killed; wrong parts give no verdict.

use crate::program::{Place, SMALL, Said, timeless};
use serde_json::Value;
use smc::engine::shards::{Head, Part, Plan, Unit};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PROPERTIES: &str = "\
property near = F<=1 s (min(distance(user, a) for a in crowd) < 3 m)
check P(near) >= 0.3 by sprt(indifference = 0.05)
check Q(0.5, min<=1 s (clearance(user))) >= 0.2 m
estimate P(near) within 0.05
estimate P(F<=1 s (clearance(user) < -0.1 m)) by splitting(replicas = 20, runs = 4, plain = 100)
estimate P(F<=1 s (clearance(user) < -0.1 m)) by fixed_effort(replicas = 20, runs = 2, plain = 100)
estimate Q(0.1, 0.5, 0.9, min<=1 s (clearance(user))) by dkw(trials = 200)
estimate E(robustness(near)) in -4 m .. 3 m within 0.3 m
compare P(near) under density = 0.1 /m^2 with density = 0.4 /m^2 within 0.1
rank moves of user by P(near) within 0.1
rank moves of user by P(near) by okamoto(epsilon = 0.3, delta = 0.2)
check P(near) >= 0.3 under every density in 0.1 /m^2, 0.4 /m^2
rank moves of user by P(near) within 0.1 under every density in 0.1 /m^2, 0.4 /m^2
";

/// One table, and a number of trials that is known.
const PLANNED: &str = "estimate P(F<=3 s contact(user)) by clopper_pearson(trials = 2000)\n";

/// Works for hours.
const ENDLESS: &str = "check P(F<=3 s contact(user)) >= 0.17 by sprt(indifference = 0.00001)\n";

/// A launcher that runs one shard after the other.
const LINE: &str = "for i in $(seq 0 {last}); do sh {shard} $i; done";

const CALL: [&str; 3] = ["check", "a.scn", "a.bltl"];

fn place(properties: &str) -> Place {
    Place::new(&[("a.scn", SMALL), ("a.bltl", properties)])
}

fn words<'w>(words: &[&'w str]) -> Vec<&'w str> {
    [&CALL[..], &["-q", "--format", "json", "--max-trials", "2000"], words].concat()
}

/// The report without times.
fn report(said: &Said) -> Value {
    let mut json = said.json();
    timeless(&mut json);
    json
}

/// The parts in a folder.
fn parts(place: &Place, folder: &str) -> Vec<PathBuf> {
    let files = std::fs::read_dir(place.path(folder)).unwrap().map(|file| file.unwrap().path());
    let mut parts: Vec<PathBuf> =
        files.filter(|file| file.extension().is_some_and(|end| end == "part")).collect();
    parts.sort();
    parts
}

fn plan(place: &Place, folder: &str) -> Plan {
    serde_json::from_slice(&std::fs::read(place.path(folder).join("plan.json")).unwrap()).unwrap()
}

/// Trials in all parts of a folder.
fn simulated(place: &Place, folder: &str) -> u64 {
    let head = |file: &PathBuf| Head::read(&std::fs::read(file).unwrap()).unwrap();
    let units = parts(place, folder).iter().flat_map(|file| head(file).units).collect::<Vec<_>>();
    units.iter().filter(|unit| matches!(unit, Unit::Trials(_))).map(Unit::weight).sum()
}

/// Whether a program is installed; says so where it is not.
fn is_installed(program: &str) -> bool {
    let found = Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let there = found.is_ok_and(|status| status.success());
    if !there {
        skipped(&format!("`{program}` is not installed"));
    }
    there
}

/// Says that a test is left out.
fn skipped(why: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stderr(), "SKIPPED: {why}");
}

/// Waits until something is so.
fn wait_for(what: &str, is_so: impl Fn() -> bool) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < Duration::from_mins(2), "never: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn shards_report_what_one_thread_reports() {
    let place = place(PROPERTIES);
    for more in [&["--set", "density=0.2"][..], &["--set", "density=0.1..0.3 by 0.1", "--only", "0"]] {
        let alone = place.call(&words(&[more, &["-j", "1"]].concat()));
        for launch in [&["--launch", "local", "-j", "2"][..], &["--launch", LINE, "--shards", "7"]] {
            let led = place.call(&words(&[more, launch].concat()));
            assert_eq!(led.err, "", "{launch:?}");
            assert_eq!(led.code, alone.code, "{launch:?}");
            assert!(report(&led) == report(&alone), "{launch:?}\n{}\n{}", led.out, alone.out);
        }
    }
    let left = std::fs::read_dir(place.path(".")).unwrap().count();
    assert_eq!(left, 2, "a folder that no one named is removed");
}

#[test]
fn plans_shards_and_merges_by_hand_come_to_the_same() {
    let place = place(PROPERTIES);
    std::fs::create_dir(place.path("parts")).unwrap();
    let alone = place.call(&words(&["-j", "1"]));
    let merge = [
        "merge",
        "a.scn",
        "a.bltl",
        "parts",
        "-q",
        "--format",
        "json",
        "--max-trials",
        "2000",
        "--shards",
        "3",
    ];
    let mut rounds = 0;
    loop {
        let merged = place.call(&merge);
        let is_open =
            report(&merged)["results"].as_array().unwrap().iter().any(|one| one["stopped_by"] == "missing");
        if !is_open {
            assert_eq!((merged.code, report(&merged)), (alone.code, report(&alone)));
            break;
        }
        // No `check` is violated before its last round, so that the exit code says that something is open.
        assert!([Some(1), Some(3), Some(4)].contains(&merged.code), "{:?}", merged.code);
        let count = plan(&place, "parts").shards.len();
        assert!(count <= 3);
        // In any order.
        for index in (0..count).rev() {
            let index = index.to_string();
            let said = place.call(&[
                "shard",
                "a.scn",
                "a.bltl",
                "--round",
                "parts/plan.json",
                "--index",
                &index,
                "-o",
                "parts",
            ]);
            assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
        }
        rounds += 1;
        assert!(rounds < 50);
    }
    assert!(rounds > 1);
}

#[test]
fn wrong_parts_give_no_verdict() {
    let place = place(PLANNED);
    let launch = ["--launch", LINE, "--parts", "parts", "--shards", "4"];
    let whole = place.call(&words(&launch));
    let all = parts(&place, "parts");
    assert_eq!(all.len(), 4);
    let merge = || {
        place.call(&["merge", "a.scn", "a.bltl", "parts", "-q", "--format", "json", "--max-trials", "2000"])
    };
    assert_eq!(report(&merge()), report(&whole));
    let good = std::fs::read(&all[1]).unwrap();
    // Cut short anywhere, or with any byte changed, a part is named and not used.
    let mut wrong: Vec<Vec<u8>> = (0..good.len()).step_by(97).map(|end| good[..end].to_vec()).collect();
    wrong.extend((0..good.len()).step_by(53).map(|at| {
        let mut bytes = good.clone();
        bytes[at] ^= 1 << (at % 8);
        bytes
    }));
    wrong.truncate(24);
    for bytes in wrong {
        std::fs::write(&all[1], bytes).unwrap();
        let said = merge();
        assert_eq!(said.code, Some(4));
        assert!(said.err.contains("W0722") && said.err.contains("0001-000001.part"), "{}", said.err);
        assert!(said.err.contains("trials 504 to 1007"), "{}", said.err);
        assert_eq!(
            (&said.json()["results"][0]["trials"], &said.json()["results"][0]["stopped_by"]),
            (&504.into(), &"missing".into())
        );
        std::fs::remove_file(place.path("parts").join("plan.json")).unwrap();
        // The plan of the first round is what names the part.
        let first = Plan { round: 1, ..first_plan(&place) };
        place.write("parts/plan.json", &serde_json::to_vec(&first).unwrap());
    }
    // A part that is missing is named by its range, and is all that is planned.
    std::fs::remove_file(&all[1]).unwrap();
    let said = merge();
    assert!(said.err.contains("parts are missing: 1 (trials 504 to 1007 of world 0)"), "{}", said.err);
    let units: Vec<Unit> = plan(&place, "parts").shards.concat();
    assert_eq!(units.iter().map(Unit::weight).sum::<u64>(), 504);
    // The same part twice is read once; of two that differ neither is believed.
    std::fs::write(&all[1], &good).unwrap();
    let twice = all[1].with_file_name("0009-000000.part");
    std::fs::write(&twice, &good).unwrap();
    assert_eq!(report(&merge()), report(&whole));
    let mut other = Part::read(&std::fs::read(&all[0]).unwrap()).unwrap();
    other.head.units = Part::read(&good).unwrap().head.units;
    std::fs::write(&twice, other.bytes().unwrap()).unwrap();
    let said = merge();
    assert_eq!((said.code, said.json()["results"].as_array().unwrap().len()), (Some(2), 0));
    assert!(said.err.contains("E0724") && said.err.contains("0009-000000.part"), "{}", said.err);
}

/// The plan of the parts of `PLANNED`, as the first round had it.
fn first_plan(place: &Place) -> Plan {
    let all = parts(place, "parts");
    let heads: Vec<Head> =
        all.iter().filter_map(|file| Head::read(&std::fs::read(file).unwrap()).ok()).collect();
    let mut shards: Vec<Vec<Unit>> = heads.iter().map(|head| head.units.clone()).collect();
    let Unit::Trials(trials) = &shards[0][0] else { panic!() };
    let lost = smc::engine::shards::Trials { from: 504, to: 1008, ..trials.clone() };
    shards.insert(1, vec![Unit::Trials(lost)]);
    Plan { origin: heads[0].origin.clone(), round: 1, max_trials: 2000, shards }
}

#[test]
fn parts_and_plans_of_other_calls_are_refused() {
    let place = place(PLANNED);
    place.write("b.scn", SMALL.replace("crowd[round(density", "crowd[1 + round(density").as_bytes());
    place.write("b.bltl", b"estimate P(F<=2 s contact(user)) by clopper_pearson(trials = 2000)\n");
    let launch = ["-q", "--max-trials", "2000", "--launch", LINE, "--parts", "parts", "--shards", "4"];
    assert_eq!(place.call(&[&CALL[..], &launch].concat()).code, Some(0));
    let file = parts(&place, "parts").remove(0);
    // Another seed, model, property, setting.
    for (call, why) in [
        (&["a.scn", "a.bltl", "--seed", "1"][..], "seed 0 instead of 1"),
        (&["a.scn", "b.bltl"], "another model"),
        (&["a.scn", "a.bltl", "--set", "density=0.3"], "another model"),
    ] {
        let said = place.call(&[&["check"], call, &launch].concat());
        assert_eq!(said.code, Some(2), "{call:?}");
        assert!(
            said.err.contains("E0724") && said.err.contains(why) && said.err.contains("plan.json"),
            "{}",
            said.err
        );
        let plan = ["--round", "parts/plan.json", "--index", "0", "-o", "other"];
        if !call.contains(&"--seed") {
            let said = place.call(&[&["shard"], call, &plan].concat());
            assert!(said.code == Some(2) && said.err.contains("E0724"), "{}", said.err);
        }
    }
    // A foreign part beside the right ones, here of another version.
    let mut part = Part::read(&std::fs::read(&file).unwrap()).unwrap();
    part.head.origin.version = "0.0.9".to_owned();
    place.write("parts/0007-000000.part", &part.bytes().unwrap());
    let said = place.call(&["merge", "a.scn", "a.bltl", "parts", "--format", "json"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("0007-000000.part") && said.err.contains("version 0.0.9"), "{}", said.err);
    assert_eq!(said.json()["results"].as_array().unwrap().len(), 0);
    // A plan that is none, a shard that is none, a folder that is none.
    place.write("parts/plan.json", b"{");
    let said = place.call(&["merge", "a.scn", "a.bltl", "parts"]);
    assert!(said.code == Some(2) && said.err.contains("plan.json"), "{}", said.err);
    let said = place.call(&["merge", "a.scn", "a.bltl", "nowhere"]);
    assert!(said.code == Some(2) && said.err.contains("`nowhere` does not exist"), "{}", said.err);
}

#[test]
fn an_empty_folder_gets_the_first_plan() {
    let place = place(PLANNED);
    std::fs::create_dir(place.path("parts")).unwrap();
    let said = place.call(&["merge", "a.scn", "a.bltl", "parts", "--shards", "8"]);
    assert_eq!((said.code, said.err.as_str()), (Some(4), ""));
    assert!(said.out.contains("not begun"), "{}", said.out);
    assert_eq!(plan(&place, "parts").shards.len(), 8);
    let said = place.call(&[
        "shard",
        "a.scn",
        "a.bltl",
        "--round",
        "parts/plan.json",
        "--index",
        "8",
        "-o",
        "parts",
    ]);
    assert!(said.code == Some(2) && said.err.contains("no shard 8"), "{}", said.err);
}

#[test]
fn a_launcher_that_fails_is_quoted() {
    let place = place(PLANNED);
    let said = place.call(&words(&["--launch", "echo no queue here; exit 7"]));
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("E0725") && said.err.contains("no queue here"), "{}", said.err);
    assert_eq!(said.json()["results"].as_array().unwrap().len(), 0);
}

#[test]
fn a_shard_that_always_crashes_is_named_and_the_others_go_on() {
    let place = place(
        "estimate P(F<=3 s contact(user)) by clopper_pearson(trials = 2000)\nestimate P(F<=1 s contact(user)) by clopper_pearson(trials = 64) under density = 0.3 /m^2\n",
    );
    // Whoever has trial 1024 dies.
    let line = "for i in $(seq 0 {last}); do \
        python3 -c 'import json,sys; s=json.load(open(sys.argv[1]))[\"shards\"][int(sys.argv[2])]; \
        sys.exit(any(u[\"Trials\"][\"world\"]==0 and u[\"Trials\"][\"from\"]<=1024<u[\"Trials\"][\"to\"] for u in s))' {plan} $i \
        && sh {shard} $i; done; true";
    if !is_installed("python3") {
        return;
    }
    let said = place.call(&words(&["--launch", line, "--shards", "4"]));
    assert_eq!(said.code, Some(4));
    let json = said.json();
    assert_eq!(json["results"][0]["stopped_by"], "missing");
    assert!(
        json["results"][0]["trials"].as_u64().is_some_and(|trials| (1..=1024).contains(&trials)),
        "{json}"
    );
    assert_eq!(
        (&json["results"][1]["stopped_by"], &json["results"][1]["trials"]),
        (&"plan".into(), &64.into())
    );
    let warning = json["warnings"][0].as_str().unwrap();
    assert!(
        warning.contains("no shard brought these back: trials") && warning.contains("of world 0"),
        "{warning}"
    );
    assert_eq!(said.err.matches("W0722").count(), 3, "{}", said.err);
}

#[test]
fn a_full_disk_leaves_no_part() {
    let place = place(PLANNED);
    std::fs::create_dir(place.path("parts")).unwrap();
    place.call(&["merge", "a.scn", "a.bltl", "parts", "--shards", "1"]);
    // A limit on the size of files acts as a disk that is full.
    let line = format!(
        "trap '' XFSZ; ulimit -f 0; exec {} shard a.scn a.bltl --round parts/plan.json --index 0 -o parts",
        env!("CARGO_BIN_EXE_smc")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(place.path(".")).output().unwrap();
    let said = Said::of(&output);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("E0706") && said.err.contains("0001-000000.part"), "{}", said.err);
    let left: Vec<_> =
        std::fs::read_dir(place.path("parts")).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert_eq!(left, ["plan.json"]);
    let line = format!(
        "trap '' XFSZ; ulimit -f 0; exec {} check a.scn a.bltl -q --launch local --parts full",
        env!("CARGO_BIN_EXE_smc")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(place.path(".")).output().unwrap();
    let said = Said::of(&output);
    assert!(said.code == Some(2) && said.err.contains("E0706"), "{:?} {}", said.code, said.err);
}

#[test]
fn a_call_that_is_killed_goes_on_where_it_was() {
    let place = place(PLANNED);
    let alone = place.call(&words(&["-j", "1"]));
    // The first call runs three of four shards and is killed with its launcher.
    let line = "for i in 0 1 2; do sh {shard} $i; done; touch done; sleep 600";
    let mut command = place.command(&words(&["--launch", line, "--parts", "parts", "--shards", "4"]));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for("the shards are run", || place.path("done").exists());
    child.kill().unwrap();
    child.wait().unwrap();
    let before = parts(&place, "parts");
    assert_eq!(before.len(), 3);
    let led = place.call(&words(&["--launch", "local", "-j", "2", "--parts", "parts"]));
    assert_eq!(report(&led), report(&alone));
    assert_eq!(simulated(&place, "parts"), 2000, "what was there is not run again");
}

#[test]
fn threads_that_are_killed_leave_parts_that_are_not_run_again() {
    let place = place(ENDLESS);
    let local = ["--launch", "local", "--parts", "parts", "--shards", "2"];
    let call = |most: &str, more: &[&str]| {
        place.command(&[&CALL[..], &["-q", "--format", "json", "--max-trials", most], more].concat())
    };
    let mut command = call("1000000000", &local);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for("a part is there", || place.path("parts").is_dir() && !parts(&place, "parts").is_empty());
    child.kill().unwrap();
    child.wait().unwrap();
    let before = simulated(&place, "parts");
    let most = (before + 1000).to_string();
    let alone = Said::of(&call(&most, &["-j", "1"]).output().unwrap());
    let led = Said::of(&call(&most, &local).output().unwrap());
    assert_eq!((led.code, report(&led)), (alone.code, report(&alone)), "{}", led.err);
    assert_eq!(simulated(&place, "parts"), before + 1000);
    // Another seed finds parts that are not its own; a part that is changed is named and run again.
    let said = Said::of(&call(&most, &[&local[..], &["--seed", "1"]].concat()).output().unwrap());
    assert!(said.code == Some(2) && said.err.contains("E0724"), "{}", said.err);
    let mut bytes = std::fs::read(&parts(&place, "parts")[0]).unwrap();
    let last = bytes.len() - 9;
    bytes[last] ^= 1;
    std::fs::write(&parts(&place, "parts")[0], bytes).unwrap();
    let again = Said::of(&call(&most, &local).output().unwrap());
    assert!(again.err.contains("W0722") && report(&again) == report(&alone), "{}", again.err);
}

#[test]
fn time_and_trials_are_limited_over_all_rounds() {
    let place = place(ENDLESS);
    let said = place.call(
        &[&CALL[..], &["-q", "--format", "json", "--launch", "sleep 600", "--timeout", "300ms"]].concat(),
    );
    assert_eq!((said.code, &said.json()["results"][0]["stopped_by"]), (Some(3), &"deadline".into()));
    let said = place.call(&words(&["--launch", "local", "--parts", "parts"]));
    assert_eq!((said.code, &said.json()["results"][0]["stopped_by"]), (Some(3), &"cap".into()));
    assert_eq!(said.json()["results"][0]["trials"], 2000);
    assert_eq!(simulated(&place, "parts"), 2000);
}

#[test]
fn little_is_simulated_in_vain() {
    for properties in [
        "estimate P(F<=3 s contact(user)) within 0.02\n",
        "check P(F<=3 s contact(user)) >= 0.16 by sprt(indifference = 0.01)\n",
        "compare P(F<=3 s contact(user)) under density = 0.1 /m^2 with density = 0.4 /m^2 within 0.03\n",
    ] {
        let place = place(properties);
        let said = place.call(
            &[&CALL[..], &["-q", "--format", "json", "--launch", "local", "--parts", "parts"]].concat(),
        );
        let consumed = said.json()["results"][0]["trials"].as_u64().unwrap();
        assert!(consumed > 1000, "{properties}");
        let vain = simulated(&place, "parts") - consumed;
        assert!(4 * vain < consumed, "{properties}: {vain} beside {consumed}");
    }
}

#[test]
fn an_interruption_ends_the_launcher_and_reports_what_is_there() {
    let place = place(ENDLESS);
    let line = "sh {shard} 0; touch done; sleep 600 & echo $! > pid; wait";
    let mut command =
        place.command(&[&CALL[..], &["-q", "--format", "json", "--launch", line, "--shards", "1"]].concat());
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let told = || std::fs::read_to_string(place.path("pid")).is_ok_and(|pid| pid.ends_with('\n'));
    wait_for("the shard is run", told);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let said = Said::of(&child.wait_with_output().unwrap());
    assert_eq!((said.code, &said.json()["results"][0]["stopped_by"]), (Some(130), &"interrupt".into()));
    assert!(said.json()["results"][0]["trials"].as_u64() > Some(0));
    let pid = std::fs::read_to_string(place.path("pid")).unwrap();
    let gone =
        || !Command::new("kill").args(["-0", pid.trim()]).stderr(Stdio::null()).status().unwrap().success();
    wait_for("the launcher is ended", gone);
}

#[test]
fn a_job_for_kubernetes_is_printed() {
    let place = place(PLANNED);
    let said = place.call(&[&CALL[..], &["--launch", "k8s", "--shards", "5"]].concat());
    assert_eq!(said.code, Some(0));
    assert!(
        said.out.contains("completions: 5\n") && said.out.contains("completionMode: Indexed"),
        "{}",
        said.out
    );
    assert_eq!(plan(&place, "parts").shards.len(), 5);
    // Its index comes from the environment.
    let script = std::fs::read_to_string(place.path("parts/shard.sh"))
        .unwrap()
        .replace("\nsmc ", &format!("\n{} ", env!("CARGO_BIN_EXE_smc")));
    place.write("parts/shard.sh", script.as_bytes());
    for index in 0..5 {
        let status = Command::new("sh")
            .arg("parts/shard.sh")
            .env("JOB_COMPLETION_INDEX", index.to_string())
            .current_dir(place.path("."))
            .status();
        assert!(status.unwrap().success());
    }
    let said = place.call(&[&CALL[..], &["--launch", "k8s", "--format", "json"]].concat());
    assert_eq!((said.code, &said.json()["results"][0]["trials"]), (Some(0), &2000.into()));
}

#[test]
fn gnu_parallel_runs_the_shards() {
    if !is_installed("parallel") {
        return;
    }
    let place = place(PROPERTIES);
    let alone = place.call(&words(&["-j", "1"]));
    let led = place.call(&words(&["--launch", "seq 0 {last} | parallel -j 2 sh {shard}", "--shards", "6"]));
    assert_eq!(report(&led), report(&alone), "{}", led.err);
}

/// A Python that has the wheel of `HyperQueue`: that of `SMC_HQ_PYTHON`, or else `python3`.
fn hyperqueue() -> Option<String> {
    let python = std::env::var("SMC_HQ_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python).args(["-c", "import hyperqueue"]).stderr(Stdio::null()).status();
    let there = found.is_ok_and(|status| status.success());
    if !there {
        skipped(&format!("`{python}` has no HyperQueue (pip install hyperqueue; set SMC_HQ_PYTHON)"));
    }
    there.then_some(python)
}

/// A process that is ended with the test.
struct Ended(std::process::Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A server and workers in one process; it is up when this returns.
fn cluster(place: &Place, python: &str, folder: &str) -> Ended {
    std::fs::create_dir(place.path(folder)).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/queues/cluster.py");
    let mut command = Command::new(python);
    command.arg(script).arg(place.path(folder)).arg("3").stdout(Stdio::null()).stderr(Stdio::null());
    let child = Ended(command.spawn().unwrap());
    wait_for("the cluster is up", || place.path(folder).join("ready").exists());
    child
}

#[cfg(unix)]
#[test]
fn hyperqueue_runs_the_shards_and_may_be_killed() {
    use std::os::unix::fs::PermissionsExt as _;
    let Some(python) = hyperqueue() else { return };
    let place = place(PROPERTIES);
    let alone = place.call(&words(&["-j", "1"]));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/queues/hq.py");
    std::fs::create_dir(place.path("bin")).unwrap();
    place.write("bin/hq", format!("#!/bin/sh\nexec '{python}' '{script}' \"$@\"\n").as_bytes());
    std::fs::set_permissions(place.path("bin/hq"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", place.path("bin").display(), std::env::var("PATH").unwrap_or_default());
    let call = |server: &str| {
        let mut command = place.command(&words(&["--launch", "hq", "--parts", "parts", "--shards", "5"]));
        command.env("PATH", &path).env("HQ_SERVER_DIR", place.path(server));
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    // The server and its workers are killed in the first round.
    let killed = cluster(&place, &python, "killed");
    let child = call("killed").spawn().unwrap();
    let has_part = || place.path("parts").is_dir() && !parts(&place, "parts").is_empty();
    wait_for("a part is there", has_part);
    drop(killed);
    let first = Said::of(&child.wait_with_output().unwrap());
    assert!(first.code == Some(2) && first.err.contains("E0725"), "{:?} {}", first.code, first.err);
    // With another cluster the call goes on.
    let _cluster = cluster(&place, &python, "second");
    let led = Said::of(&call("second").output().unwrap());
    assert_eq!(led.code, alone.code, "{}", led.err);
    assert!(report(&led) == report(&alone), "{}\n{}", led.out, alone.out);
}

#[test]
fn slurm_runs_the_shards_and_repeats_one_that_it_ended() {
    let up = Command::new("sinfo").arg("-h").stderr(Stdio::null()).output();
    if !up.is_ok_and(|said| said.status.success() && !said.stdout.is_empty()) {
        return skipped("no Slurm cluster answers `sinfo`");
    }
    let place = place(PROPERTIES);
    let alone = place.call(&words(&["-j", "1"]));
    let led = place.call(&words(&["--launch", "slurm", "--shards", "4"]));
    assert!(report(&led) == report(&alone), "{}\n{}", led.out, alone.out);
    // Slurm ends the second shard of the first round, as it does at a time limit.
    place.write(
        "slow.sh",
        b"#!/bin/sh\nif [ \"$SLURM_ARRAY_TASK_ID\" = 1 ] && mkdir once 2>/dev/null; then\n\
          scancel --signal=KILL --full \"${SLURM_ARRAY_JOB_ID}_1\"; sleep 600; fi\nexec sh parts/shard.sh\n",
    );
    let line = "sbatch --wait --array=0-{last} --output=/dev/null slow.sh";
    let led = place.call(&words(&["--launch", line, "--parts", "parts", "--shards", "4"]));
    assert!(report(&led) == report(&alone), "{}\n{}", led.out, alone.out);
    assert!(led.err.contains("W0722") && led.err.contains("parts are missing: 1"), "{}", led.err);
}
