//! The language server from outside, as an editor speaks to it: messages over its standard input and output.

use crate::mistakes::every_mistake;
use crate::program::{Place, SMALL};
use serde_json::{Value, json};
use smc::compile::dimension::UNITS;
use smc::compile::{BUILT_IN, DISTRIBUTIONS};
use smc::model::BuiltIn;
use smc::stats::PROCEDURES;
use smc::syntax::keywords::{Declares, KEYWORDS, Keyword, OPERATORS, OTHERS, is_measure};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

const PROPERTIES: &str = "\
// é𝄞: characters of two and four bytes
let gap(a) = distance(user, a)
property arrives = F<=2 s (user in goal)
check P(arrives) >= 0.2
estimate E(speed(user) at 1 s) in 0 m/s .. 3 m/s
";

const SCENARIO: &str = "\
scenario \"Hall\"
horizon = 4 s
step = 0.05 s
const WIDTH = 3 m
scene {
  region hall: rect (0, 0) .. (6, WIDTH)
  region goal: rect (4, 0) .. (6, WIDTH)
}
kind adult: sfm preset smc2 { }
agent user: adult { at = uniform in hall; route = goal }
agents crowd[2]: adult { at = uniform in hall; route = goal }
";

/// An editor that has started a server.
struct Editor {
    server: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    last: i64,
    /// Messages that nobody has waited for yet.
    unread: Vec<Value>,
}

#[expect(clippy::needless_pass_by_value, reason = "parameters are written where they are passed")]
impl Editor {
    fn start(place: &Place) -> Self {
        let mut command = place.command(&["lsp"]);
        let mut server = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (input, output) = (server.stdin.take().unwrap(), BufReader::new(server.stdout.take().unwrap()));
        let mut editor = Self { server, input, output, last: 0, unread: Vec::new() };
        editor.ask(
            "initialize",
            json!({ "processId": null, "rootUri": null, "capabilities": {},
            "initializationOptions": { "threads": 2, "webview": true } }),
        );
        editor.tell("initialized", json!({}));
        editor
    }

    fn send(&mut self, mut message: Value) {
        message["jsonrpc"] = json!("2.0");
        let body = message.to_string();
        write!(self.input, "Content-Length: {}\r\n\r\n{body}", body.len()).unwrap();
        self.input.flush().unwrap();
    }

    fn tell(&mut self, method: &str, parameters: Value) {
        self.send(json!({ "method": method, "params": parameters }));
    }

    fn begin(&mut self, method: &str, parameters: Value) -> i64 {
        self.last += 1;
        self.send(json!({ "id": self.last, "method": method, "params": parameters }));
        self.last
    }

    /// The next message for which something holds.
    fn wait(&mut self, is_it: impl Fn(&Value) -> bool) -> Value {
        if let Some(at) = self.unread.iter().position(&is_it) {
            return self.unread.remove(at);
        }
        loop {
            let mut length = 0;
            loop {
                let mut line = String::new();
                assert_ne!(self.output.read_line(&mut line).unwrap(), 0, "the server has ended");
                match line.trim().split_once(": ") {
                    Some((_, number)) => length = number.parse().unwrap(),
                    None => break,
                }
            }
            let mut body = vec![0; length];
            self.output.read_exact(&mut body).unwrap();
            let message: Value = serde_json::from_slice(&body).unwrap();
            if is_it(&message) {
                return message;
            }
            self.unread.push(message);
        }
    }

    fn answer(&mut self, id: i64) -> Value {
        self.wait(|message| message["id"] == id && message["method"].is_null())
    }

    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        let id = self.begin(method, parameters);
        self.answer(id)["result"].clone()
    }

    /// Opens a text, and waits for what is wrong with it.
    fn open(&mut self, uri: &str, text: &str) -> Value {
        let language = if uri.ends_with("bltl") { "bltl" } else { "scn" };
        self.tell(
            "textDocument/didOpen",
            json!({ "textDocument":
            { "uri": uri, "languageId": language, "version": 1, "text": text } }),
        );
        self.errors(uri)
    }

    fn change(&mut self, uri: &str, text: &str) -> Value {
        self.unread.retain(|message| message["params"]["uri"] != uri);
        self.tell(
            "textDocument/didChange",
            json!({ "textDocument": { "uri": uri, "version": 2 },
            "contentChanges": [{ "text": text }] }),
        );
        self.errors(uri)
    }

    fn errors(&mut self, uri: &str) -> Value {
        let shown =
            self.wait(|m| m["method"] == "textDocument/publishDiagnostics" && m["params"]["uri"] == uri);
        shown["params"]["diagnostics"].clone()
    }

    /// Asks something about the first place of a word.
    fn about(&mut self, method: &str, (uri, text): (&str, &str), word: &str, more: &Value) -> Value {
        let at = text.find(word).unwrap();
        let before = text[..at].rsplit('\n').next().unwrap();
        let place =
            json!({ "line": text[..at].matches('\n').count(), "character": before.encode_utf16().count() });
        let mut parameters = json!({ "textDocument": { "uri": uri }, "position": place });
        for (key, value) in more.as_object().into_iter().flatten() {
            parameters[key] = value.clone();
        }
        self.ask(&format!("textDocument/{method}"), parameters)
    }

    fn labels(&mut self, file: (&str, &str), word: &str) -> BTreeSet<String> {
        let found = self.about("completion", file, word, &Value::Null);
        found.as_array().unwrap().iter().map(|one| one["label"].as_str().unwrap().to_owned()).collect()
    }

    fn lenses(&mut self, uri: &str) -> Vec<String> {
        let found = self.ask("textDocument/codeLens", json!({ "textDocument": { "uri": uri } }));
        found
            .as_array()
            .unwrap()
            .iter()
            .map(|lens| lens["command"]["title"].as_str().unwrap().to_owned())
            .collect()
    }

    fn end(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        assert!(self.server.wait().unwrap().success());
    }
}

fn address(place: &Place, name: &str) -> String {
    format!("file://{}", place.path(name).display())
}

fn changed(text: &str, edits: &Value) -> String {
    let mut edits: Vec<&Value> = edits.as_array().unwrap().iter().collect();
    let byte = |at: &Value| {
        let start: usize =
            text.split_inclusive('\n').take(at["line"].as_u64().unwrap() as usize).map(str::len).sum();
        let mut left = at["character"].as_u64().unwrap() as usize;
        let rest = text[start..].char_indices().find(|(_, c)| {
            let is_there = left == 0;
            left = left.saturating_sub(c.len_utf16());
            is_there
        });
        rest.map_or(text.len(), |(k, _)| start + k)
    };
    edits.sort_by_key(|edit| std::cmp::Reverse(byte(&edit["range"]["start"])));
    let mut changed = text.to_owned();
    for edit in edits {
        let (from, to) = (byte(&edit["range"]["start"]), byte(&edit["range"]["end"]));
        changed.replace_range(from..to, edit["newText"].as_str().unwrap());
    }
    changed
}

#[test]
fn an_editor_shows_what_the_command_line_says() {
    let place = Place::new(&[]);
    let mut editor = Editor::start(&place);
    let mut compared = 0;
    for (number, (scenario, properties)) in every_mistake().into_iter().enumerate() {
        let names = [format!("m{number}.scn"), format!("m{number}.bltl")];
        let mut found = BTreeSet::new();
        for (name, text) in names.iter().zip([&scenario, &properties]) {
            place.write(name, text.as_bytes());
            let uri = address(&place, name);
            editor.open(&uri, text);
        }
        for name in &names {
            // Both are checked again as soon as both are open.
            let uri = address(&place, name);
            let errors = editor.change(&uri, if *name == names[0] { &scenario } else { &properties });
            for one in errors.as_array().unwrap() {
                let start = &one["range"]["start"];
                found.insert((
                    name.clone(),
                    [&start["line"], &start["character"]].map(|n| n.as_u64().unwrap() + 1),
                    one["code"].as_str().unwrap().to_owned(),
                ));
            }
        }
        let said = place.call(&["check", &names[0], &names[1], "--format", "json"]);
        let told: BTreeSet<_> = said.json()["diagnostics"]
            .as_array()
            .into_iter()
            .flatten()
            .filter(|one| one["line"].is_u64())
            .map(|one| {
                let file = one["file"].as_str().unwrap().to_owned();
                (
                    file,
                    ["line", "column"].map(|n| one[n].as_u64().unwrap()),
                    one["code"].as_str().unwrap().to_owned(),
                )
            })
            .collect();
        if !told.is_empty() {
            let apart: Vec<_> = found.symmetric_difference(&told).collect();
            assert!(apart.is_empty(), "{apart:?}\n{scenario}\n{properties}");
            compared += 1;
        }
        for name in &names {
            let uri = address(&place, name);
            editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
        }
    }
    assert!(compared > 100, "{compared}");
    editor.end();
}

#[test]
fn names_lead_to_their_declarations_and_are_renamed_everywhere() {
    let place = Place::new(&[("hall.scn", SCENARIO), ("hall.bltl", PROPERTIES)]);
    let mut editor = Editor::start(&place);
    let (scn, bltl) = (address(&place, "hall.scn"), address(&place, "hall.bltl"));
    assert_eq!(editor.open(&bltl, PROPERTIES), json!([]));
    let said = editor.about("hover", (&bltl, PROPERTIES), "gap", &Value::Null);
    assert!(said["contents"]["value"].as_str().unwrap().contains("gap(a)"), "{said}");
    let said = editor.about("hover", (&bltl, PROPERTIES), "speed(", &Value::Null);
    assert!(said["contents"]["value"].as_str().unwrap().contains("a speed (m/s)"), "{said}");
    editor.open(&scn, SCENARIO);
    let said = editor.about("hover", (&scn, SCENARIO), "WIDTH)\n", &Value::Null);
    assert!(said["contents"]["value"].as_str().unwrap().contains("a length (m), 3 m"), "{said}");
    let said = editor.about("hover", (&scn, SCENARIO), "user", &Value::Null);
    assert!(said["contents"]["value"].as_str().unwrap().contains("speed normal(1.34 m/s"), "{said}");
    let computed = SCENARIO.replace("WIDTH = 3 m", "WIDTH = HALF + 1.5 m\nconst HALF = 1.5 m");
    editor.change(&scn, &computed);
    let asked = json!({ "textDocument": { "uri": scn }, "range": null });
    let hints = editor.ask("textDocument/inlayHint", asked);
    assert_eq!((hints.as_array().unwrap().len(), &hints[0]["label"]), (1, &json!("= 3 m")), "{hints}");
    editor.change(&scn, SCENARIO);
    let found = editor.about("definition", (&bltl, PROPERTIES), "goal)", &Value::Null);
    assert_eq!((&found["uri"], &found["range"]["start"]["line"]), (&json!(scn), &json!(6)));
    let context = json!({ "context": { "includeDeclaration": true } });
    let found = editor.about("references", (&scn, SCENARIO), "user", &context);
    assert_eq!(found.as_array().unwrap().len(), 4, "{found}");
    // A name that is taken, a word of the language and no name at all are refused.
    for new in ["crowd", "forall", "two words", "2"] {
        assert!(
            editor.about("rename", (&scn, SCENARIO), "user", &json!({ "newName": new })).is_null(),
            "{new}"
        );
    }
    let before = place.call(&["show", "hall.scn", "hall.bltl"]).out;
    let edits = editor.about("rename", (&scn, SCENARIO), "user", &json!({ "newName": "visitor" }));
    for (name, text) in [("hall.scn", SCENARIO), ("hall.bltl", PROPERTIES)] {
        place.write(name, changed(text, &edits["changes"][address(&place, name)]).as_bytes());
    }
    let after = place.call(&["show", "hall.scn", "hall.bltl"]).out;
    assert_ne!(before, after);
    assert_eq!(before.replace("user", "visitor"), after);
    editor.end();
}

#[test]
fn completions_are_what_the_place_takes() {
    let place = Place::new(&[("hall.scn", SCENARIO)]);
    let mut editor = Editor::start(&place);
    let (scn, bltl) = (address(&place, "hall.scn"), address(&place, "hall.bltl"));
    editor.open(&bltl, PROPERTIES);
    editor.open(&scn, SCENARIO);
    let cases = [
        ("bltl", "check P(▮", &["arrives", "distance", "user"][..], &["sprt", "check"][..]),
        ("bltl", "check P(arrives) >= 0.5 by ▮", &["sprt", "eprocess"], &["okamoto", "user"]),
        ("bltl", "check P(arrives) >= 0.5 by sprt(▮", &["alpha", "beta"], &["delta"]),
        ("bltl", "▮", &["check", "estimate", "property"], &["agent", "horizon"]),
        ("scn", "▮", &["agent", "horizon", "scene"], &["check", "wall"]),
        ("scn", "agent other: ▮", &["adult", "sfm"], &["hall", "user"]),
        ("scn", "kind child: adult { ▮ }", &["speed", "radius", "mass"], &["user", "route"]),
        ("scn", "const L = 3 ▮", &["m", "km", "s"], &["user"]),
    ];
    for (language, line, with, without) in cases {
        let (uri, base) = if language == "scn" { (&scn, SCENARIO) } else { (&bltl, PROPERTIES) };
        let text = format!("{base}{}\n", line.replace('▮', ""));
        editor.change(uri, &text);
        // The word that is looked for is the mark itself, in a text of the same shape.
        let found = editor.labels((uri, &format!("{base}{line}\n")), "▮");
        for name in with {
            assert!(found.contains(*name), "`{line}` without `{name}`: {found:?}");
        }
        for name in without {
            assert!(!found.contains(*name), "`{line}` with `{name}`");
        }
        editor.change(uri, base);
    }
    let whole = editor.ask("completionItem/resolve", json!({ "label": "distance" }));
    assert!(whole["documentation"]["value"].as_str().unwrap().starts_with("distance(p, q) (m)"), "{whole}");
    editor.end();
}

#[test]
fn remedies_are_applied_and_texts_are_formatted() {
    let place = Place::new(&[]);
    let mut editor = Editor::start(&place);
    let uri = address(&place, "hall.scn");
    let wrong = SCENARIO
        .replace("step = 0.05 s", "step = 0.05")
        .replace("route = goal }\nagents", "rout = gaol }\nagents");
    let mut text = wrong.replace('\n', "\r\n");
    assert_eq!(editor.open(&uri, &text).as_array().unwrap().len(), 3);
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    for _ in 0..3 {
        let asked =
            json!({ "textDocument": { "uri": uri }, "range": whole, "context": { "diagnostics": [] } });
        let found = editor.ask("textDocument/codeAction", asked);
        text = changed(&text, &found[0]["edit"]["changes"][&uri]);
        editor.change(&uri, &text);
    }
    assert!(text.contains("step = 0.05 s") && text.contains("route = goal }\r\nagents"), "{text}");
    assert_eq!(editor.change(&uri, &text), json!([]));
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let text = text.replace('\r', "").replace("agents crowd[2]: adult {", "agents   crowd[2] : adult{");
    editor.change(&uri, &text);
    let edits =
        editor.ask("textDocument/formatting", json!({ "textDocument": { "uri": uri }, "options": options }));
    place.write("hall.scn", text.as_bytes());
    place.call(&["fmt", "hall.scn"]);
    assert_eq!(changed(&text, &edits), std::fs::read_to_string(place.path("hall.scn")).unwrap());
    // Lines outside of a range stay as they are.
    let line = json!({ "start": { "line": 10, "character": 0 }, "end": { "line": 10, "character": 70 } });
    let asked = json!({ "textDocument": { "uri": uri }, "range": line, "options": options });
    let edits = editor.ask("textDocument/rangeFormatting", asked);
    assert_eq!(
        changed(&text, &edits),
        text.replace("agents   crowd[2] : adult{", "agents crowd[2]: adult {")
    );
    editor.end();
}

#[test]
fn verdicts_stand_in_the_margin_until_a_text_changes() {
    let place = Place::new(&[("hall.scn", SCENARIO)]);
    let mut editor = Editor::start(&place);
    let (scn, bltl) = (address(&place, "hall.scn"), address(&place, "hall.bltl"));
    editor.open(&scn, SCENARIO);
    editor.open(&bltl, PROPERTIES);
    assert_eq!(editor.lenses(&scn), ["▷ play a trial", "plan"]);
    assert_eq!(editor.lenses(&bltl).len(), 4);
    let run = |number: u32| json!({ "command": "smc.run", "arguments": [bltl, number, null] });
    let answer = editor.ask("workspace/executeCommand", run(0));
    let said = answer["verdict"].as_str().unwrap().to_owned();
    place.write("hall.bltl", PROPERTIES.as_bytes());
    let brief = place.call(&["check", "hall.scn", "hall.bltl", "--only", "0", "--format", "json"]).json();
    let result = &brief["results"][0];
    assert!(said.starts_with(result["verdict"].as_str().unwrap()), "{said}");
    assert!(said.ends_with(&format!(", {} trials", result["trials"])), "{said} {result}");
    assert_eq!(editor.lenses(&bltl)[0], said);
    editor.change(&scn, &SCENARIO.replace("crowd[2]", "crowd[3]"));
    assert_eq!(editor.lenses(&bltl)[0], format!("stale: {said}"));
    editor.change(&scn, &SCENARIO.replace("crowd[2]", "crwd["));
    assert!(editor.ask("workspace/executeCommand", run(0)).is_null(), "files with errors do not run");
    editor.change(&scn, SCENARIO);
    // The second query would take a minute.
    editor.change(&scn, &SCENARIO.replace("step = 0.05 s", "step = 0.001 s"));
    let long = PROPERTIES.replace("0 m/s .. 3 m/s", "0 m/s .. 3 m/s within 0.0002 m/s");
    editor.change(&bltl, &long);
    let id = editor.begin("workspace/executeCommand", run(1));
    let token = json!(format!("smc-{id}"));
    let is_report = |m: &Value| m["params"]["token"] == token && m["params"]["value"]["kind"] == "report";
    editor.wait(is_report);
    assert!(editor.lenses(&bltl).contains(&"… sampling".to_owned()));
    editor.tell("window/workDoneProgress/cancel", json!({ "token": token }));
    let answer = editor.answer(id);
    assert!(answer["result"]["verdict"].as_str().unwrap().starts_with("cancelled: "), "{answer}");
    for command in ["smc.play", "smc.plan"] {
        let page = editor.ask("workspace/executeCommand", json!({ "command": command, "arguments": [scn] }));
        let path = page["page"].as_str().unwrap().strip_prefix("file://").unwrap().to_owned();
        assert!(std::fs::read_to_string(&path).unwrap().contains("<svg"));
        std::fs::remove_file(path).unwrap();
    }
    editor.end();
}

#[test]
fn a_property_file_finds_its_scenario() {
    let place = Place::new(&[("hall.scn", SCENARIO)]);
    let named = format!("// First of all:\nfor \"hall.scn\"\n{PROPERTIES}");
    place.write("other.bltl", named.as_bytes());
    let own = place.call(&["check", "other.bltl", "--format", "json"]);
    let both = place.call(&["check", "hall.scn", "other.bltl", "--format", "json"]);
    let certified = |said: &Value| {
        let results = said["results"].as_array().unwrap();
        results.iter().map(|one| one["certifies"].to_string()).collect::<Vec<_>>()
    };
    assert_eq!(certified(&own.json()), certified(&both.json()));
    assert_eq!(place.call(&["show", "other.bltl"]).out, place.call(&["show", "hall.scn", "other.bltl"]).out);
    let mut editor = Editor::start(&place);
    let uri = address(&place, "other.bltl");
    assert_eq!(editor.open(&uri, &named), json!([]));
    let errors = editor.change(&uri, &named.replace("user in goal", "user in gaol"));
    assert_eq!(errors[0]["code"], "E0201", "{errors}");
    assert_eq!(editor.change(&uri, " \n"), json!([]), "errors of a text that is gone are gone");
    let errors = editor.change(&uri, &named.replace("hall.scn", "hill.scn"));
    assert_eq!((&errors[0]["code"], &errors[0]["range"]["start"]["line"]), (&json!("E0701"), &json!(1)));
    // Without a scenario, and without a file, words alone are checked.
    let loose = "untitled:Untitled-1.bltl";
    assert_eq!(editor.open(loose, PROPERTIES), json!([]));
    assert_eq!(editor.change(loose, "property = 3\n")[0]["code"], "E0101");
    editor.end();
}

#[test]
fn two_editors_and_one_that_vanishes_are_served() {
    let place = Place::new(&[]);
    let (mut one, mut other) = (Editor::start(&place), Editor::start(&place));
    let uri = address(&place, "small.scn");
    assert_eq!(one.open(&uri, SMALL), json!([]));
    assert_eq!(other.open(&uri, "horizon = \n")[0]["severity"], 1);
    // Ten thousand errors: of each kind a hundred are shown.
    let many = "agent x: nobody { }\n".repeat(10_000);
    assert!(one.change(&uri, &many).as_array().unwrap().len() > 100);
    let Editor { mut server, input, .. } = other;
    drop(input);
    assert!(server.wait().unwrap().success());
    one.end();
}

/// The words of the languages by their kinds, from the tables that the program reads.
fn words() -> Value {
    let keywords = |is_it: &dyn Fn(&Keyword) -> bool| -> Vec<&str> {
        KEYWORDS.iter().filter(|one| is_it(one)).map(|one| one.word).collect()
    };
    let sorted = |words: Vec<&'static str>| words.into_iter().collect::<BTreeSet<_>>();
    let constants: Vec<&str> = ["true", "false"].into_iter().chain(BUILT_IN).collect();
    let begins = |one: &Keyword| !one.begins.is_empty();
    json!({
        "items": keywords(&begins),
        "declares": keywords(&|one| begins(one) && one.declares != Declares::Nothing),
        "continues": keywords(&|one| one.continues),
        "inner": keywords(&|one| !one.continues && !begins(one)),
        "operators": OPERATORS,
        "measures": OTHERS.into_iter().filter(|word| is_measure(word)).collect::<Vec<_>>(),
        "functions": sorted(BuiltIn::names().chain(DISTRIBUTIONS).collect()),
        "constants": constants,
        "procedures": sorted(PROCEDURES.iter().map(|one| one.name).collect()),
        "units": UNITS.into_iter().chain(["step"]).collect::<Vec<_>>(),
    })
}

#[test]
fn the_grammars_of_editors_follow_the_tables_of_the_language() {
    let words = words();
    let list = |words: &Value| {
        words.as_array().unwrap().iter().map(|w| w.as_str().unwrap()).collect::<Vec<_>>().join("|")
    };
    let lines: Vec<String> = words
        .as_object()
        .unwrap()
        .iter()
        .map(|(kind, list)| format!("  \"{kind}\": {}", list.to_string().replace("\",\"", "\", \"")))
        .collect();
    let mut files = vec![("editors/keywords.json".to_owned(), format!("{{\n{}\n}}\n", lines.join(",\n")))];
    let template = std::fs::read_to_string("editors/vscode/syntaxes/smc.tmLanguage.template.json").unwrap();
    for language in ["scn", "bltl"] {
        let mut grammar = template.replace("{{language}}", language);
        for (kind, words) in words.as_object().unwrap() {
            grammar = grammar.replace(&format!("{{{{{kind}}}}}"), &list(words));
        }
        assert!(!grammar.contains("{{"), "a place holder is left");
        files.push((format!("editors/vscode/syntaxes/{language}.tmLanguage.json"), grammar));
    }
    let mut old = Vec::new();
    for (file, text) in files {
        if std::fs::read_to_string(&file).ok().as_ref() != Some(&text) {
            std::fs::write(&file, text).unwrap();
            old.push(file);
        }
    }
    assert!(old.is_empty(), "{old:?} were older than the tables; they are written anew");
}
