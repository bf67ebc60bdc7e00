//! The crate as a library: the same results as the program, errors as it shows them, and the states of a trial.

use smc::engine::outcome::{Certified, Verdict};
use smc::kernel::driver::{Driver, Memory, Plan, Situation};
use smc::kernel::fault::Fault;
use smc::report::Format;
use smc::stats::Claim;
use smc::{Draft, Model, Options};
use std::process::Command;
use std::sync::Arc;

const SCENARIO: &str = "horizon = 6 s\nstep = 0.05 s\nparam n = 2\n\
    kind adult: sfm preset helbing2000 { noise = 0.1 m/s }\n\
    agent user: adult { at = (0, 0); route = (20, 0) }\n\
    agents crowd[n]: adult { at = uniform in rect (5, -2) .. (9, 2); route = (-5, 0) }\n";

#[test]
fn a_model_gives_the_results_of_the_program() {
    let place = crate::program::Place::new(&[
        ("model.scn", SCENARIO),
        (
            "model.bltl",
            "check P(F<=6 s (travelled(user) > 4 m)) >= 0.8\nestimate P(F<=6 s contact(user)) within 0.1\n",
        ),
    ]);
    let said = place.call(&["check", "model.scn", "model.bltl", "--format", "json", "--seed", "5"]);
    let model = Model::parse(SCENARIO).unwrap();
    let queries = std::fs::read_to_string(place.path("model.bltl")).unwrap();
    let report = model.check(&queries, &Options::default().seed(5).threads(1)).unwrap();
    let mut own: serde_json::Value = serde_json::from_str(&report.render(Format::Json)).unwrap();
    let mut theirs = said.json();
    for json in [&mut own, &mut theirs] {
        let object = json.as_object_mut().unwrap();
        object.remove("elapsed_s");
        for result in object["results"].as_array_mut().unwrap() {
            result.as_object_mut().unwrap().remove("elapsed_s");
        }
    }
    assert_eq!(own, theirs);
    assert_eq!(report.verdict(), Some(Verdict::Satisfied));
    let certificates: Vec<_> = report.results().iter().map(|r| r.certificate.clone().unwrap()).collect();
    assert_eq!(certificates[0].claim, Certified::Decided(Claim::AtLeast(0.8)));
    let (low, high) = (report.results()[1].low, report.results()[1].high);
    assert_eq!(certificates[1].claim, Certified::Between { low, high });
    assert!(high - low <= 0.2 + 1e-12 && certificates[1].error <= 0.05);
}

#[test]
fn a_trial_yields_its_states() {
    let model = Model::parse(SCENARIO).unwrap();
    let mut trial = model.trial(5, 3).unwrap();
    let states: Vec<_> = trial.by_ref().collect();
    assert_eq!(states.len(), 121);
    assert_eq!((states[0].time, states[120].time), (0.0, 6.0));
    assert!(trial.end().is_some() && trial.next().is_none());
    assert_eq!(states[0].agents.len(), 3);
    // The rows of `smc simulate` are these states.
    let place = crate::program::Place::new(&[("model.scn", SCENARIO)]);
    let said = place.call(&["simulate", "model.scn", "--seed", "5", "--trial", "3"]);
    let last = said.out.lines().rev().find(|line| line.contains("user")).unwrap();
    let user = states[120].agent("user").unwrap();
    assert!(last.contains(&format!("{},{}", user.position.x, user.position.y)), "{last}\n{user:?}");
}

#[test]
fn errors_are_those_of_the_command_line() {
    let wrong = SCENARIO.replace("helbing2000", "helbing2001");
    let error = Model::parse(&wrong).unwrap_err();
    assert!(error.has_error() && error.to_string().contains("did you mean"), "{error}");
    let place = crate::program::Place::new(&[("model.scn", wrong.as_str())]);
    assert_eq!(place.call(&["show", "model.scn"]).err.trim_end(), error.to_string().trim_end());
    let model = Model::parse(SCENARIO).unwrap();
    assert!(model.check("check P(nobody) >= 0.5", &Options::default()).is_err());
    assert!(model.with("m", "3").is_err(), "there is no such parameter");
    assert!(model.check("estimate P(F<=1 s contact(user))", &Options::default().only("other")).is_err());
    let crowded = SCENARIO.replace("crowd[n]", "crowd[400]");
    let error = Model::parse(&crowded).unwrap_err();
    assert!(error.to_string().contains("E0801"), "{error}");
}

#[test]
fn a_draft_has_parameters_and_files() {
    let text = format!("{SCENARIO}scene {{ import \"walls.wkt\" }}\n");
    let draft = Draft::new("a.scn", &text).set("n", "3").file("walls.wkt", "LINESTRING (-1 3, 9 3)");
    let model = draft.parse().unwrap();
    assert_eq!(model.scenario().agents.len(), 4);
    assert_eq!(model.scenario().scene.barriers.len(), 1);
    assert_eq!(model.with("n", "1").unwrap().scenario().agents.len(), 2);
    let error = Draft::new("a.scn", &text).parse().unwrap_err();
    assert!(error.to_string().contains("Draft::file"), "{error}");
}

/// The examples are programs of their own; the test command builds them.
#[test]
fn the_examples_run() {
    let folder = std::env::current_exe().unwrap();
    let folder = folder.parent().and_then(|deps| deps.parent()).unwrap().join("examples");
    for (name, expected) in
        [("check", "trials"), ("sweep", "1.2 m,"), ("trajectories", "t,agent,x,y"), ("driver", "satisfied")]
    {
        let program = folder.join(name);
        if !program.exists() {
            eprintln!("SKIPPED: example {name} is not built; `cargo test` without `--test` builds it");
            continue;
        }
        let output = Command::new(program).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains(expected), "{name}: {text}");
    }
}

#[test]
fn results_print_and_serialize_as_the_command_line_does() {
    let text = "horizon = 10 steps\nparam n = 3\nprocess p { var x: 0 .. 9 = 0; when x < n -> x = x + 1 }";
    let model = smc::Model::parse(text).unwrap();
    let report = model.check("check P(F<=5 steps (p.x == 3)) >= 0.9", &smc::Options::default()).unwrap();
    let shown = report.to_string();
    assert!(
        shown.contains("certified: P(F<=5 steps (p.x == 3)) >= 0.9") && !shown.ends_with('\n'),
        "{shown}"
    );
    let result = &report.results()[0];
    assert!(shown.contains(result.to_string().lines().next().unwrap()), "{result}");
    assert_eq!(result.certificate.as_ref().unwrap().to_string(), "P >= 0.9, error at most 0.01");
    let json = serde_json::to_value(&report).unwrap();
    let printed: serde_json::Value = serde_json::from_str(&report.render(smc::report::Format::Json)).unwrap();
    assert_eq!(json, printed);
    assert_eq!(serde_json::to_value(result).unwrap(), json["results"][0]);
    // An error of a parameter names it, and no option of the command line.
    let wrong = model.with("m", "3").unwrap_err().to_string();
    assert!(wrong.contains("parameter m:1:1") && !wrong.contains("--set"), "{wrong}");
}

/// Goes straight on, fails in every third trial, and is wrong in one.
#[derive(Debug)]
struct Sometimes {
    wrong: u64,
}

impl Driver for Sometimes {
    fn plan(&self, seen: &Situation<'_>, _: &mut Memory) -> Plan {
        match seen.key.index {
            index if index == self.wrong => Plan::Failed(Some(Fault::Unsteady { agent: seen.agent })),
            index if index % 3 == 2 => Plan::Failed(None),
            _ => Plan::Straight,
        }
    }
}

#[test]
fn a_driver_from_outside_conditions_results_and_its_failures_are_unresolved() {
    let query = "estimate P(F<=6 s (travelled(user) > 4 m)) by okamoto(epsilon = 0.2, delta = 0.1)";
    let options = Options::default().seed(5).threads(1);
    let model = Model::parse(SCENARIO).unwrap();
    let driven = |wrong| model.clone().with_driver(Some("user"), Arc::new(Sometimes { wrong })).unwrap();
    let report = driven(u64::MAX).check(query, &options).unwrap();
    let result = &report.results()[0];
    let counts = &result.consumed.counts;
    let unresolved = counts.unresolved as f64 / counts.trials as f64;
    assert!(unresolved > 0.3 && result.high - result.low > unresolved, "{} .. {}", result.low, result.high);
    assert!(report.to_string().contains("the given drivers of user"), "{report}");
    // A fault is an error of the model: no trial of it can be trusted.
    let report = driven(0).check(query, &options).unwrap();
    let said = report.to_string() + &report.warnings().to_string();
    assert!(!report.is_satisfied() && said.contains("E0915"), "{said}");
    for (name, wrong) in [("nobody", "there is no agent"), ("crowd[3]", "there is no agent")] {
        let refused = model.clone().with_driver(Some(name), Arc::new(Sometimes { wrong: 0 })).unwrap_err();
        assert!(refused.to_string().contains(wrong), "{refused}");
    }
    let storeys = "horizon = 6 s\nstep = 0.05 s\nkind adult: sfm preset helbing2000\n\
        scene { level ground { region hall: rect (0, 0) .. (9, 9) } }\n\
        agent user: adult { at = ground (1, 1); route = ground.hall }\n";
    let refused =
        Model::parse(storeys).unwrap().with_driver(None, Arc::new(Sometimes { wrong: 0 })).unwrap_err();
    assert!(refused.to_string().contains("know no levels"), "{refused}");
}
