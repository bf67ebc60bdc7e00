//! The pages of `--report`: what the player is given, that nothing gets out of its element, and that they work in a browser.

use crate::program::{Place, at_root};
use base64::Engine as _;
use serde_json::Value;
use sha2::Digest as _;
use std::process::Command;

/// A user meets a crowd in a corridor, and comes too near to somebody in nearly every trial.
const MEETING: &str = r#"
scenario "Meeting"
horizon = 8 s
step    = 0.02 s
param people = 3 in 1 .. 9
scene {
  wall south: (0, 0) -- (12, 0)
  wall north: (0, 3) -- (12, 3)
  obstacle pillar: circle (6, 2.6) radius 0.2 m
  region east: rect (11, 0) .. (12, 3)
  region west: rect (0, 0) .. (1, 3)
}
kind adult: sfm preset helbing2000 { speed = 1.2 m/s; radius = 0.25 m; noise = 0.1 m/s }
agent user: adult { at = (1, 1.5); route = east }
agents oncoming[people]: adult { at = uniform in rect (8, 0.5) .. (11, 2.5); route = west }
moves user for 2 s { stop; heading 20 deg }
"#;
const NEAR: &str = "let gap(a) = distance(user, a) - 0.5 m
property apart = G<=6 s (forall a in oncoming: gap(a) > 0.3 m)
check P(apart) >= 0.95
";

fn meeting(properties: &str) -> Place {
    Place::new(&[("m.scn", MEETING), ("m.bltl", properties)])
}

fn checked(place: &Place, more: &[&str]) -> (Value, String) {
    let words = ["check", "m.scn", "m.bltl", "-q", "--seed", "3", "--format", "json", "--report", "m.html"];
    let said = place.call(&[&words, more].concat());
    let page = std::fs::read_to_string(place.path("m.html")).unwrap_or_else(|_| panic!("{}", said.err));
    (said.json(), page)
}

/// What stands between the tags of the only element that begins so.
fn element<'p>(page: &'p str, start: &str, end: &str) -> &'p str {
    assert_eq!(page.matches(start).count(), 1, "{start}");
    page.split_once(start).unwrap().1.split_once(end).unwrap().0
}

/// The data of the player.
fn data(page: &str) -> Value {
    let text = element(page, "<script type=\"application/json\" id=\"data\">", "</script>");
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn list<'v>(value: &'v Value, name: &str) -> &'v [Value] {
    value[name].as_array().unwrap_or_else(|| panic!("{name}: {value}"))
}

/// The sums of differences: millimetres.
fn sums(differences: &Value) -> Vec<i64> {
    let mut last = 0;
    let add = |change: &Value| {
        last += change.as_i64().unwrap();
        last
    };
    differences.as_array().unwrap().iter().map(add).collect()
}

#[test]
fn a_page_says_who_decided_and_when() {
    let place = meeting(NEAR);
    let (report, page) = checked(&place, &[]);
    let result = &report["results"][0];
    assert_eq!(result["verdict"], "violated");
    let witness = &result["witnesses"][0];
    let data = data(&page);
    let entry = &data["entries"][0];
    assert_eq!(entry["decided"], witness["time"], "{witness}");
    let deciding: Vec<&str> = list(entry, "agents").iter().map(|name| name.as_str().unwrap()).collect();
    assert!(deciding.iter().any(|name| name.starts_with("oncoming[")), "{deciding:?}");
    let names: Vec<&Value> = list(&data["traces"][0], "tracks").iter().map(|track| &track["name"]).collect();
    for name in deciding {
        assert!(names.iter().any(|known| **known == name), "{name}: {names:?}");
    }
    // The atom holds from the start until it decides.
    let bar = &list(entry, "bars")[0];
    assert!(bar["text"].as_str().unwrap().contains("gap(a) > 0.3 m"), "{bar}");
    let changes: Vec<f64> = list(bar, "changes").iter().map(|time| time.as_f64().unwrap()).collect();
    assert_eq!(changes[..2], [0.0, witness["time"].as_f64().unwrap()]);
    // The verdict, its figures and its guarantee come before the player, its command behind it.
    let (head, rest) = page.split_once("id=\"player\"").unwrap();
    for said in ["violated", "<th scope=\"col\">how sure", "certified, error at most"] {
        assert!(head.contains(said), "{said}");
    }
    assert!(rest.contains("smc check m.scn m.bltl --only 0 --seed 3") && rest.contains("class=\"copy\""));
    assert!(page.contains("States every 0.1 s, positions to 1 mm."));
}

#[test]
fn positions_are_those_of_simulate_to_a_millimetre() {
    let place = meeting(NEAR);
    let (_, page) = checked(&place, &[]);
    let data = data(&page);
    for trace in list(&data, "traces") {
        let trial = trace["trial"].to_string();
        let table = place.call(&["simulate", "m.scn", "--seed", "3", "--trial", &trial, "--every", "5"]);
        let rows: Vec<Vec<&str>> = table.out.lines().skip(1).map(|line| line.split(',').collect()).collect();
        for track in list(trace, "tracks") {
            let own: Vec<&Vec<&str>> = rows.iter().filter(|row| track["name"] == row[2]).collect();
            let (x, y) = (sums(&track["x"]), sums(&track["y"]));
            assert!(x.len() > 10 && own.len() >= x.len(), "{} of {}", x.len(), own.len());
            for (frame, row) in own.iter().take(x.len()).enumerate() {
                let time = frame as f64 * trace["spacing"].as_f64().unwrap();
                assert!((row[0].parse::<f64>().unwrap() - time).abs() < 1e-9, "{row:?}");
                for (known, written) in [(x[frame], row[3]), (y[frame], row[4])] {
                    let metres: f64 = written.parse().unwrap();
                    assert!((known as f64 / 1000.0 - metres).abs() <= 0.001, "{row:?}: {known}");
                }
            }
        }
    }
}

#[test]
fn each_option_and_each_point_shows_its_first_eight_trials() {
    let place = meeting(&format!("{NEAR}rank moves of user by P(apart) within 0.2 confidence 90 %\n"));
    let (_, page) = checked(&place, &["--set", "people=2,4", "--max-trials", "200"]);
    let data = data(&page);
    let entries = |part: &str| {
        let of = |entry: &&Value| entry["group"].as_str().unwrap().contains(part);
        list(&data, "entries").iter().filter(of).collect::<Vec<_>>()
    };
    for point in ["(people = 2)", "(people = 4)"] {
        let shown: Vec<&Value> = entries(point);
        let checks =
            shown.iter().filter(|entry| entry["group"].as_str().unwrap().starts_with("check")).count();
        assert!(checks >= 8, "{point}: {checks}");
        for option in ["stop", "heading 20 deg"] {
            let of = |entry: &&&Value| entry["label"].as_str().unwrap().starts_with(&format!("{option}: "));
            assert!(shown.iter().filter(of).count() >= 8, "{point}, {option}");
        }
    }
    // Of two numbers of people there are two scenes.
    let agents: Vec<&Value> = list(&data, "scenes").iter().map(|scene| &scene["agents"]).collect();
    assert_eq!(agents, [3, 5]);
}

#[test]
fn nothing_gets_out_of_its_element() {
    let hostile = "</script><script>alert('1')</script><!-- \u{2028}\u{202e} \u{1f600}";
    let long = "n".repeat(3000);
    let scenario = MEETING.replace("\"Meeting\"", &format!("\"{hostile} {long}\""));
    let place =
        Place::new(&[("m.scn", &scenario), ("m.bltl", &format!("// </pre></script>{hostile}\n{NEAR}"))]);
    let (_, page) = checked(&place, &[]);
    assert_eq!(page.matches("<script").count(), 2, "the data and the script");
    assert_eq!(page.matches("</script").count(), 2);
    assert!(!page.contains("<!-- "));
    assert!(!list(&data(&page), "entries").is_empty());
    // The policy allows just the style and the script that are there.
    let policy = element(&page, "http-equiv=\"Content-Security-Policy\" content=\"", "\"");
    assert!(policy.starts_with("default-src 'none'; "), "{policy}");
    for (name, start) in [("script", "<script>"), ("style", "<style>")] {
        let text = element(&page, start, &format!("</{name}>"));
        let hash = base64::engine::general_purpose::STANDARD.encode(sha2::Sha256::digest(text));
        assert!(policy.contains(&format!("{name}-src 'sha256-{hash}'")), "{name}: {policy}");
    }
    assert!(
        !page.contains(" style=\"") && !page.contains(" onclick="),
        "the policy forbids attributes that do something"
    );
}

#[test]
fn trials_without_results_are_played() {
    let place = meeting(NEAR);
    let said = place.call(&["simulate", "m.scn", "-n", "3", "--trial", "5", "--report", "s.html"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""), "{}", said.err);
    let data = data(&std::fs::read_to_string(place.path("s.html")).unwrap());
    let trials: Vec<&Value> = list(&data, "traces").iter().map(|trace| &trace["trial"]).collect();
    assert_eq!(trials, [5, 6, 7]);
    assert_eq!(data["traces"][0]["frames"], 81);
}

#[test]
fn a_crowd_is_thinned_and_the_page_says_so() {
    let scenario = "horizon = 12 s\nstep = 0.1 s\nscene { region hall: rect (0, 0) .. (160, 160) }\n\
        kind adult: sfm preset helbing2000 { speed = 1.2 m/s; radius = 0.2 m }\n\
        agents crowd[5000]: adult { at = uniform in hall; route = (2000, 80) }\n";
    let place = Place::new(&[("c.scn", scenario)]);
    let said = place.call(&["simulate", "c.scn", "--report", "c.html"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let page = std::fs::read_to_string(place.path("c.html")).unwrap();
    assert!(page.len() < 2_600_000, "{} bytes", page.len());
    let data = data(&page);
    let spacing = data["traces"][0]["spacing"].as_f64().unwrap();
    assert!(spacing > 0.15, "{spacing}");
    assert!(
        page.contains(&format!("States every {spacing} s")),
        "the page says how far apart the states are"
    );
    let crowd = element(&page, "<section id=\"crowd\"", "</section>");
    assert!(crowd.contains("Presence: ") && crowd.contains("Speed against density."));
    assert!(crowd.len() < 500_000, "{} bytes", crowd.len());
}

#[test]
fn a_model_without_agents_has_bars_alone() {
    let place = Place::new(&[
        ("m.scn", "horizon = 20 steps\nprocess p { var x: 0 .. 9 = 0; when x < 9 -> x = x + 1 }\n"),
        ("m.bltl", "check P(F<=15 steps (p.x == 9)) >= 0.5\n"),
    ]);
    let (_, page) = checked(&place, &[]);
    let data = data(&page);
    assert_eq!(data["scenes"][0]["agents"], 0);
    let bar = &data["entries"][0]["bars"][0];
    assert_eq!((&bar["text"], &bar["changes"]), (&"p.x == 9".into(), &serde_json::json!([9.0])));
    assert!(page.contains("No agent is present."));
}

#[test]
fn a_missing_folder_is_named_and_no_file_is_left() {
    let place = meeting(NEAR);
    place.write("m.csv", "time,id,x,y\n1,1,0,0\n2,1,1,0\n".as_bytes());
    for words in [
        &["check", "m.scn", "m.bltl", "-q", "--report", "none/m.html"][..],
        &["simulate", "m.scn", "--report", "none/m.html"],
        &["infer", "m.csv", "-o", "m.json", "--report", "none/m.html"],
    ] {
        let said = place.call(words);
        assert_eq!(said.code, Some(2), "{words:?}");
        let title = "error[E0706]: `none/m.html` cannot be written: the folder `none` does not exist";
        assert!(said.err.starts_with(title), "{}", said.err);
    }
    assert!(!place.path("none").exists());
}

/// Eight people go through a door, 1.2 m/s each, with a hair's breadth between the crossings of the first two.
fn through_a_door() -> Place {
    let scene = "horizon = 1 s\nstep = 0.02 s\nscene { wall (2, -3) -- (2, -0.6)\n wall (2, 0.6) -- (2, 3)\n \
        obstacle column: circle (0.5, 2) radius 0.3 m\n line door: (2, -0.6) -- (2, 0.6)\n \
        region hall: rect (-4, -3) .. (2, 3) }\n";
    let mut table = "time,id,x,y\n".to_owned();
    for frame in 0..30 {
        for person in 0..8 {
            let (time, late) = (0.2 * f64::from(frame), 0.4 * f64::from(person));
            let x = 1.2 * (time - late);
            let y = if person % 2 == 0 { 0.2 } else { -0.2 };
            table += &format!("{time:.1},{},{x:.3},{y}\n", person + 1);
        }
    }
    Place::new(&[("door.scn", scene), ("it's <b>\"ü.csv", &table)])
}

#[test]
fn inferred_traces_are_played_and_drawn() {
    let place = through_a_door();
    let words = ["infer", "it's <b>\"ü.csv", "--format", "json", "-o", "i.json", "--report", "i.html"];
    let scene = ["--motion", "social-force", "--scene", "door.scn"];
    let said = place.call(&[&words[..], &scene].concat());
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""), "{}", said.err);
    let page = std::fs::read_to_string(place.path("i.html")).unwrap();
    assert!(!page.contains("<b>"), "the name of the file is a text");
    assert!(page.contains("<td>traces</td><td>8</td>") && page.contains("<td>IDF1</td><td>100 %</td>"));
    let data = data(&page);
    let trace = &data["traces"][0];
    assert_eq!(
        (&trace["spacing"], &trace["frames"], list(trace, "tracks").len()),
        (&0.2.into(), &30.into(), 8)
    );
    assert_eq!(data["entries"][0]["label"], "recording");
    assert_eq!(list(&data["scenes"][0], "walls").len(), 2);
    // Members of groups of the file of results have their groups in the player.
    let json: Value = serde_json::from_str(&std::fs::read_to_string(place.path("i.json")).unwrap()).unwrap();
    let joint = list(&json, "groups").iter().any(|group| list(group, "members").len() > 1);
    let is_some = list(trace, "memberships").iter().any(|one| !one[2].is_null());
    assert_eq!(is_some, joint);
    insta::assert_snapshot!("page_crowd", element(&page, "<section id=\"crowd\"", "</section>"));
    let said = place.call(&["infer", "it's <b>\"ü.csv", "-o", "i.html", "--report", "i.html"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("two results are to be written to `i.html`"), "{}", said.err);
}

#[test]
fn a_replay_with_advice_is_played_beside_its_advice() {
    let place = Place::new(&[]);
    let path = place.path("a.html");
    let words = ["models/square.scn", "properties/square.bltl", "--tracks", "here", "--total-trials", "200"];
    let page = |more: &[&str]| {
        let call = [&["advise"][..], &words, more, &["--report", path.to_str().unwrap()]].concat();
        let said = at_root(&call);
        assert_eq!(said.code, Some(0), "{}", said.err);
        (said.out, std::fs::read_to_string(&path).unwrap())
    };
    let (lines, recorded) = page(&["--from", "4s", "--to", "6s"]);
    let cycles: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let table = element(&recorded, "<tbody>", "</tbody>");
    assert_eq!(table.matches("<tr>").count(), cycles.len());
    for cycle in cycles.iter().filter(|cycle| !cycle["move"].is_null()) {
        let (status, chosen) = (cycle["status"].as_str().unwrap(), cycle["move"].as_str().unwrap());
        assert!(table.contains(&format!("<td>{status}</td><td>{chosen}</td>")), "{cycle}");
    }
    let named = |page: &str| -> Vec<String> {
        let tracks = data(page)["traces"][0]["tracks"].as_array().unwrap().clone();
        tracks.iter().map(|track| track["name"].as_str().unwrap().to_owned()).collect()
    };
    assert!(
        named(&recorded).contains(&"user".to_owned()) && named(&recorded).contains(&"person[1]".to_owned())
    );
    assert_eq!(data(&recorded)["entries"][0]["label"], "recording, from 4 s on");
    let (_, followed) = page(&["--from", "4s", "--to", "6s", "--follow"]);
    assert!(named(&followed).contains(&"user as recorded".to_owned()));
    assert!(followed.contains("<td>as advised</td>"));
    assert!(!followed.contains("id=\"crowd\""), "the user would count twice");
}

#[test]
fn texts_and_results_are_linked() {
    let place = meeting(&format!("{NEAR}check P(apart) <= 0.99\n"));
    let (_, page) = checked(&place, &[]);
    let ids: Vec<&str> = page.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    let unique: std::collections::BTreeSet<&&str> = ids.iter().collect();
    assert_eq!(unique.len(), ids.len(), "{ids:?}");
    for target in page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(ids.contains(&target), "nothing has the anchor {target}");
    }
    // A property leads to its first result, a query to its own, and each result to its line.
    assert!(page.contains("<a href=\"#result-0\">apart</a>"));
    for (number, line) in [(0, 3), (1, 4)] {
        assert!(page.contains(&format!("<a id=\"line-1-{line}\" href=\"#result-{number}\">")), "{line}");
        assert!(page.contains(&format!("<a href=\"#line-1-{line}\">m.bltl:{line}</a>")), "{line}");
    }
    for name in ["user", "oncoming", "east"] {
        assert!(page.contains(&format!("<a href=\"#player\">{name}</a>")), "{name}");
    }
}

/// Where there are Chromium and Node.js, a page is played: see `tests/browser/page.mjs`.
#[test]
fn a_page_works_in_a_browser() {
    let is_there =
        |name: &str| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success());
    let browser = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(|name| is_there(name));
    let Some(browser) = browser.filter(|_| is_there("node")) else {
        eprintln!("SKIPPED: no Chromium or no Node.js on this machine");
        return;
    };
    // The first trials hold: the one that fails is not the first of all.
    let place = meeting(&NEAR.replace("> 0.3 m", "> 0 m"));
    let (report, _) = checked(&place, &[]);
    assert!(report["results"][0]["witnesses"][0]["trial"].as_u64() > Some(0), "{report}");
    // Charts of a sweep and of a ranking, a distribution function, and how evidence grew.
    let median = "estimate Q(0.5, time_until(user in east)) by fixed(trials = 40)";
    let ranking = "rank moves of user by P(apart) within 0.2 confidence 90 %";
    place.write("all.bltl", format!("{NEAR}{median}\n{ranking}\n").as_bytes());
    let file = |name: &str| format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
    let (plaza, workplace) = (file("models/plaza.scn"), file("models/workplace.scn"));
    let (square, seen) = (file("models/square.scn"), file("models/square.csv"));
    let asked = file("properties/square.bltl");
    let calls: [(&str, &[&str]); 5] = [
        ("all.html", &["check", "m.scn", "all.bltl", "-q", "--set", "people=2,4", "--max-trials", "100"]),
        ("path.html", &["path", &plaza]),
        ("walk.html", &["walk", &workplace]),
        ("infer.html", &["infer", &seen]),
        (
            "advise.html",
            &["advise", &square, &asked, "--tracks", "here", "--to", "2s", "--total-trials", "200"],
        ),
    ];
    for (page, words) in calls {
        let said = place.call(&[words, &["--report", page]].concat());
        assert!(place.path(page).is_file(), "{words:?}\n{}", said.err);
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/browser/page.mjs");
    std::thread::scope(|scope| {
        for page in calls.iter().map(|(page, _)| *page).chain(["m.html"]) {
            let path = place.path(page);
            scope.spawn(move || {
                let said = Command::new("node").arg(script).arg(browser).arg(path).output().unwrap();
                assert!(said.status.success(), "{page}: {}", String::from_utf8_lossy(&said.stdout));
            });
        }
    });
}

/// People of a stream without ids are played by the traces that are inferred of them.
#[test]
fn a_page_of_a_stream_plays_people_without_an_id() {
    let place = Place::new(&[
        ("lidar.scn", include_str!("../examples/cookbook/lidar.scn")),
        ("square.bltl", include_str!("../properties/square.bltl")),
        ("square.jsonl", include_str!("../models/square.jsonl")),
    ]);
    let words = ["advise", "lidar.scn", "square.bltl", "--tracks", "lidar", "--to", "2s"];
    let said = place.call(&[&words[..], &["--total-trials", "60", "--report", "l.html"]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    let data = data(&std::fs::read_to_string(place.path("l.html")).unwrap());
    let names: Vec<&str> =
        list(&data["traces"][0], "tracks").iter().map(|track| track["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"user"), "{names:?}");
    assert!(names.iter().filter(|name| name.starts_with("trace[")).count() >= 5, "{names:?}");
}
