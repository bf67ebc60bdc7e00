//! Codes of errors and warnings: each one that the sources use has a page, each page belongs to a code in use,
//! its examples are wrong and right, and `smc explain` prints it.

use smc::syntax::codes::Code;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The sources, without their tests.
fn sources(directory: &Path, text: &mut String) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("parse/code.rs") {
            let code = std::fs::read_to_string(&path).unwrap();
            text.push_str(code.split("#[cfg(test)]").next().unwrap());
        }
    }
}

#[test]
fn every_code_is_in_use() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut text = String::new();
    sources(&root, &mut text);
    let text: String = text.split_whitespace().collect();
    let written =
        |code: &&Code| text.contains(&format!("Code::{code}")) || text.contains(&format!("error!({code},"));
    let idle: Vec<_> = Code::ALL.iter().filter(|code| !written(code)).collect();
    assert!(idle.is_empty(), "pages that no error leads to: {idle:?}");
    // A page without a code would never be printed.
    let pages = std::fs::read_dir(root.join("../docs/errors")).unwrap();
    for page in pages {
        let name = page.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned();
        assert!(name.parse::<Code>().is_ok(), "{name} is no code");
    }
}

#[test]
fn every_page_has_a_title_and_a_wrong_and_a_right_example() {
    for code in Code::ALL {
        let page = code.page();
        let has = |words: [&str; 2]| words.iter().any(|w| page.contains(w));
        assert!(page.starts_with(&format!("# {code}: ")), "{code}");
        assert!(has(["\nWrong:\n", "\nProbably wrong:\n"]), "{code}");
        assert!(has(["\nRight:\n", "\nClear:\n"]), "{code}");
        assert!(!code.title().ends_with('.'), "{code}");
        assert!(page.lines().all(|line| line.chars().count() <= 130), "{code} is too wide");
    }
}

/// What examples take for granted, a declaration a line; what an example declares itself is left out.
const SCENARIO: &str = "scenario \"Frame\"
horizon = 60 s
step = 0.02 s
param density = 0.4 /m^2 in 0 /m^2 .. 2 /m^2
region hall: rect (30, 0.3) .. (39, 9.7)
region exit: rect (18.5, 0) .. (20, 4)
kind adult: sfm preset helbing2000
agent user: adult { at = (-1, 2); route = exit }
agent friend: adult { at = (-1, 3) }
agents crowd[3]: adult { at = uniform in hall }
process die { var s: 0 .. 7 = 0 }
process sensor { var failed = false }
";
/// The same for examples about a queue, in continuous time.
const QUEUE: &str = "horizon = 10 s
process queue { var n: 0 .. 5 = 0; when n < 5 at 1 /s -> n = n + 1 }
";
/// The same in a property file. What is about agents is left out beside a queue.
const PROPERTIES: &str = "property safe = G<=5 s (clearance(user) > 0 m)
property arrives = F<=5 s (user in exit)
property a = F<=5 s contact(user)
property b = F<=5 s contact(friend)
let slow = speed(user) < 1 m/s
let gap = clearance(user)
";

/// The first word of a line, and the name that the line declares, if it does.
fn declared(line: &str) -> (&str, Option<&str>) {
    let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    let keyword = words.next().unwrap_or("");
    let name = match keyword {
        "scenario" | "horizon" | "step" | "moves" | "when" => Some(keyword),
        "property" | "let" | "const" | "param" | "kind" | "agent" | "agents" | "group" | "process"
        | "behaviour" | "source" | "region" | "obstacle" => words.next(),
        _ => None,
    };
    (keyword, name)
}

/// The scenario and the property file around the lines of an example; none where it is about something else.
fn framed(lines: &[&str], asks: bool) -> Option<[String; 2]> {
    let (mut scenario, mut scene, mut properties) = (String::new(), String::new(), String::new());
    let queue = lines.iter().any(|line| line.contains("queue."));
    let names: Vec<_> = lines.iter().filter_map(|line| declared(line).1).collect();
    let frame = if queue { [QUEUE, ""] } else { [SCENARIO, PROPERTIES] };
    let lacks = |line: &&str| declared(line).1.is_none_or(|name| !names.contains(&name));
    for line in lines.iter().copied().chain(frame.iter().flat_map(|text| text.lines()).filter(lacks)) {
        let (target, line) = match declared(line).0 {
            _ if line.contains('…') => return None,
            "region" | "obstacle" => (&mut scene, line.to_owned()),
            "property" | "let" | "const" | "check" | "estimate" | "rank" | "family" => {
                (&mut properties, line.to_owned())
            }
            "mass" | "speed" | "route" => {
                (&mut scenario, format!("agent other: adult {{ at = (-9, -9); {line} }}"))
            }
            "when" => (
                &mut scenario,
                format!("process other {{ var s: 0 .. 7 = 0; var n: 0 .. 7 = 0; var up = true; {line} }}"),
            ),
            "state" => (
                &mut scenario,
                format!(
                    "behaviour other {{ {line}; state attentive {{ }} }}\n\
                     agent another: adult with other {{ at = (-9, -9) }}"
                ),
            ),
            _ if declared(line).1.is_some() => (&mut scenario, line.to_owned()),
            _ => return None,
        };
        target.push_str(&line);
        target.push('\n');
    }
    if asks && !queue {
        properties.push_str("check P(safe) >= 0.5\n");
    }
    if !scene.is_empty() {
        scenario = format!("{scenario}scene {{\n{scene}}}\n");
    }
    Some([scenario, properties])
}

/// The codes that a call says of the two files, and all that it says.
fn said([scenario, properties]: &[String; 2]) -> (BTreeSet<String>, String) {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("model.scn"), scenario).unwrap();
    std::fs::write(directory.path().join("prop.bltl"), properties).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_smc"))
        .args(["check", "model.scn", "prop.bltl", "--max-trials", "20"])
        .current_dir(directory.path())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    let heads = text.lines().filter_map(|line| line.strip_prefix("error[").or(line.strip_prefix("warning[")));
    (heads.map(|head| head[..5].to_owned()).collect(), format!("{scenario}{properties}{text}"))
}

/// Examples that consist of declarations and queries; those about calls and other files are not tried.
#[test]
fn what_is_wrong_is_refused_and_what_is_right_is_not() {
    fn lines(text: &str) -> Vec<&str> {
        text.lines().map(str::trim).filter(|line| !line.is_empty()).collect()
    }
    let (mut tried, mut faults) = (0, Vec::new());
    for code in Code::ALL {
        let page = code.page();
        // They are about what lacks, what the parser refuses before, a name that is a unit, many trials, and another call.
        if code.is_of("E07") || [Code::E0505, Code::E0115, Code::E0802, Code::W0804].contains(code) {
            continue;
        }
        let asks = *code != Code::W0602;
        let (wrong, right) = ["Right:\n", "Clear:\n"].iter().find_map(|word| page.split_once(word)).unwrap();
        let wrong: Vec<&str> = lines(wrong.split_once("rong:\n").unwrap().1);
        let right: Vec<&str> = lines(right);
        // What declares a name again shows another way.
        let mut ways: Vec<Vec<&str>> = vec![Vec::new()];
        for line in right {
            let fresh = |way: &&mut Vec<&str>| {
                let name = declared(line).1;
                name.is_none() || way.iter().all(|other| declared(other).1 != name)
            };
            match ways.last_mut().filter(fresh) {
                Some(way) => way.push(line),
                None => ways.push(vec![line]),
            }
        }
        let ways: Option<Vec<_>> = ways.iter().map(|way| framed(way, asks)).collect();
        let (Some(wrong), Some(ways)) = (framed(&wrong, asks), ways) else { continue };
        let (codes, text) = said(&wrong);
        if !codes.iter().eq([code.name()]) {
            faults.push(format!("{code} is not what is wrong:\n{text}"));
        }
        for way in &ways {
            let (codes, text) = said(way);
            if !codes.iter().all(|said| said.starts_with('W') && said != code.name()) {
                faults.push(format!("{code} is not right:\n{text}"));
            }
        }
        tried += 1;
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(tried > 60, "{tried}");
}

#[test]
fn explain_prints_the_page() {
    let explain =
        |code: &str| Command::new(env!("CARGO_BIN_EXE_smc")).args(["explain", code]).output().unwrap();
    for code in Code::ALL {
        let output = explain(code.name());
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(String::from_utf8(output.stdout).unwrap(), code.page()[2..], "{code}");
    }
    assert_eq!(explain("e0303").status.code(), Some(0), "lower case is the same");
    let output = explain("E0333");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("E0303"), "the nearest code is named");
}
