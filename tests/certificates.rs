//! Certificates from the outside: `smc verify`, and `tools/verify.py`, which shares nothing with the program, compute results again
//! from their outcomes, and refuse what does not follow from them.

use crate::program::Place;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::process::{Command, Output};

/// What a verifier says of a file.
fn said((program, words): (&str, &[&str]), file: &Path) -> Option<(i32, String)> {
    let Output { status, stdout, stderr, .. } = Command::new(program).args(words).arg(file).output().ok()?;
    Some((status.code()?, String::from_utf8_lossy(&[stdout, stderr].concat()).into_owned()))
}

/// What `smc verify` and `tools/verify.py` say of a file; the first one alone where Python is missing.
fn verified(file: &Path) -> Vec<(i32, String)> {
    let own = said((env!("CARGO_BIN_EXE_smc"), &["verify"]), file).unwrap();
    let python = said(("python3", &["tools/verify.py"]), file);
    if python.is_none() {
        eprintln!("SKIPPED: python3 is not installed");
    }
    std::iter::once(own).chain(python).collect()
}

/// A change of the lines of a certificate.
type Mutant = Box<dyn Fn(&mut Vec<Value>)>;

/// Ten throws of a coin in continuous time.
const COIN: &str = "
horizon = 10 s
step = 1 s
param p = 0.7 in 0 .. 1
process coin { var heads = 0; when heads < 10 at p * 1 /s -> heads = heads + 1 }
";

/// One query for each rule that can be computed again.
const RULES: &str = "
property heads = F<=1 s (coin.heads >= 1)
check P(heads) >= 0.3
check P(heads) < 0.7 by sprt(alpha = 0.02, beta = 0.01, indifference = 0.05)
check P(heads) > 0.3 by sprt2(alpha = 0.01, beta = 0.01, indifference = 0.1)
check P(heads) >= 0.4 by plan(alpha = 0.01, beta = 0.01, indifference = 0.05)
check P(heads) >= 0.5 by three_way(alpha = 0.05, indifference = 0.1)
estimate P(heads) within 0.05
estimate P(heads) by okamoto(epsilon = 0.05, delta = 0.05)
estimate P(heads) by clopper_pearson(trials = 321)
estimate P(heads) by spending(epsilon = 0.05, delta = 0.05)
estimate E(coin.heads at 5 s) in 0 .. 10 within 0.3
estimate E(coin.heads at 5 s) in 0 .. 10 by okamoto(epsilon = 0.5, delta = 0.05)
estimate Q(0.9, time_until(coin.heads >= 3))
estimate Q(0.5, time_until(coin.heads >= 3)) by dkw(trials = 500)
check E(coin.heads at 5 s) in 0 .. 10 >= 3
rank p in 0.5, 0.7, 0.9 by P(heads) within 0.1
compare P(heads) under p = 0.5 with p = 0.9 within 0.1
compare E(coin.heads at 5 s) in 0 .. 10 under p = 0.5 with p = 0.9
";

/// The lines of a certificate of the coin, without the digest.
fn lines(place: &Place, words: &[&str]) -> Vec<Value> {
    let said =
        place.call(&[&["check", "coin.scn", "rules.bltl", "--certificate", "coin.smcc"], words].concat());
    assert!(said.code.is_some_and(|code| code < 2 || code == 3), "{}", said.err);
    let text = std::fs::read_to_string(place.path("coin.smcc")).unwrap();
    let mut lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let digest = lines.pop().unwrap();
    assert!(digest["digest"].as_str().unwrap().starts_with("sha256:"));
    lines
}

/// Writes lines with the digest that fits them.
fn forged(place: &Place, lines: &[Value]) {
    let mut text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    let digest: String = Sha256::digest(&text).iter().map(|byte| format!("{byte:02x}")).collect();
    text += &format!("{}\n", json!({ "digest": format!("sha256:{digest}") }));
    place.write("coin.smcc", text.as_bytes());
}

#[test]
fn a_stranger_computes_every_result_again() {
    let place = Place::new(&[("coin.scn", COIN), ("rules.bltl", RULES)]);
    for (seed, words) in [("0", &[][..]), ("7", &[]), ("3", &["--max-trials", "100"])] {
        lines(&place, &[&["--seed", seed], words].concat());
        for (code, said) in verified(&place.path("coin.smcc")) {
            assert_eq!(code, 0, "{said}");
        }
    }
}

/// Further queries, with the other procedures.
const MORE: &str = "
property heads = F<=1 s (coin.heads >= 1)
check P(heads) >= 0.4
check Q(0.9, time_until(coin.heads >= 3)) <= 9 s
estimate P(heads) by massart(epsilon = 0.05, delta = 0.05)
estimate P(heads) by gbas(epsilon = 0.2, delta = 0.05)
estimate CVaR(0.9, coin.heads at 5 s) in 0 .. 10
check CVaR(0.9, coin.heads at 5 s) in 0 .. 10 >= 3
estimate P(F<=t (coin.heads >= 1)) for t in 0 s .. 5 s by 1 s
check P(heads) >= 0.3 under every p in 0.7, 0.9
rank p in 0.5, 0.7, 0.9 by P(heads) within 0.1 by okamoto()
rank p in 0.5, 0.7, 0.9 by P(heads) subject to P(F<=1 s (coin.heads >= 2)) <= 0.3
pareto p in 0.5, 0.7, 0.9 by P(heads), E(coin.heads at 5 s) in 0 .. 10 within 0.1, 1
estimate P(F<=5 s (coin.heads >= 10)) by splitting(replicas = 100, runs = 10)
";

#[test]
fn the_program_computes_every_procedure_again() {
    let place = Place::new(&[("coin.scn", COIN), ("rules.bltl", MORE)]);
    let whole = lines(&place, &[]);
    let file = place.path("coin.smcc");
    for (code, said) in verified(&file) {
        assert_eq!(code, 0, "{said}");
    }
    // Nor can the evidence of a test be another one.
    for at in (0..whole.len()).filter(|k| whole[*k].get("evidence").is_some()) {
        let mut lines = whole.clone();
        lines[at]["evidence"][1][0] = json!(whole[at]["evidence"][1][0].as_f64().unwrap() + 0.01);
        forged(&place, &lines);
        for (code, said) in verified(&file) {
            assert!(code == 1 && said.contains("evidence"), "{said}");
        }
    }
    // No number of a result can be changed.
    let mut tried = 0;
    for at in (0..whole.len()).filter(|k| whole[*k].get("result").is_some()) {
        let fields = whole[at]["result"].as_object().unwrap();
        for name in fields.iter().filter(|(_, value)| value.is_f64()).map(|(name, _)| name) {
            let mut lines = whole.clone();
            lines[at]["result"][name] = json!(fields[name].as_f64().unwrap() + 1e-3);
            forged(&place, &lines);
            let (code, said) = &verified(&file)[0];
            assert_eq!((*code, said.matches("refused").count()), (1, 1), "{name}\n{said}");
            tried += 1;
        }
    }
    assert!(tried > 20, "{tried}");
}

/// A forged outcome of a fixed size fits its claim once that is forged as well; an audit finds it.
#[test]
fn an_audit_finds_forged_outcomes_and_another_seed() {
    let words = "estimate P(F<=1 s (coin.heads >= 1)) by clopper_pearson(trials = 300)";
    let place = Place::new(&[("coin.scn", COIN), ("rules.bltl", words)]);
    let audit = |draws: &str| {
        let said = place.call(&[
            "verify",
            "coin.smcc",
            "coin.scn",
            "rules.bltl",
            "--audit",
            draws,
            "--audit-seed",
            "5",
        ]);
        (said.code.unwrap(), said.out)
    };
    lines(&place, &["--seed", "1"]);
    assert_eq!(audit("50").0, 0);
    // The certificate of another seed, which names the first one.
    let mut whole = lines(&place, &["--seed", "2"]);
    whole[0]["seed"] = json!(1);
    forged(&place, &whole);
    assert_eq!(verified(&place.path("coin.smcc"))[0].0, 0, "only an audit finds it");
    let (code, said) = audit("50");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("outcomes drawn, ") && !said.contains(" 0 differ"), "{said}");
    // Other files, and queries that the certificate does not answer.
    lines(&place, &["--seed", "1"]);
    place.write("other.bltl", b"estimate P(F<=2 s (coin.heads >= 1))");
    place.write("other.scn", COIN.replace("0.7", "0.8").as_bytes());
    for files in [["coin.scn", "other.bltl"], ["other.scn", "rules.bltl"]] {
        let said = place.call(&[&["verify", "coin.smcc"], &files[..]].concat());
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(said.err.contains("E0730"), "{}", said.err);
    }
}

#[test]
fn what_is_no_certificate_is_an_error() {
    let place = Place::new(&[("coin.scn", COIN), ("rules.bltl", RULES)]);
    let whole = lines(&place, &["--only", "0"]);
    let file = place.path("coin.smcc");
    let count = whole.iter().position(|line| line.get("count").is_some()).unwrap();
    let mutants: [(&str, Mutant); 4] = [
        ("another version", Box::new(|lines| lines[0]["smc"] = json!("certificate 2"))),
        ("10^9 outcomes", Box::new(move |lines| lines[count]["count"] = json!(1_000_000_000_u64))),
        ("fewer outcomes", Box::new(move |lines| lines[count]["count"] = json!(3))),
        (
            "an unresolved trial beyond",
            Box::new(move |lines| lines[count]["unresolved"] = json!([1_u64 << 40])),
        ),
    ];
    for (name, mutant) in mutants {
        let mut lines = whole.clone();
        mutant(&mut lines);
        forged(&place, &lines);
        let (code, said) = &verified(&file)[0];
        assert_eq!(*code, 2, "{name}: {said}");
    }
    for text in ["", "\n", "{}\n", "{\"digest\":3}\n"] {
        place.write("coin.smcc", text.as_bytes());
        for (code, said) in verified(&file) {
            assert_eq!(code, 2, "{text:?}: {said}");
        }
    }
}

#[test]
fn what_does_not_follow_from_the_outcomes_is_refused() {
    let place = Place::new(&[("coin.scn", COIN), ("rules.bltl", RULES)]);
    let whole = lines(&place, &[]);
    let results: Vec<usize> = (0..whole.len()).filter(|k| whole[*k].get("result").is_some()).collect();
    let file = place.path("coin.smcc");
    // A changed byte, and a file that is cut short.
    let bytes = std::fs::read(&file).unwrap();
    for damaged in [[&bytes[..300], b"9", &bytes[301..]].concat(), bytes[..bytes.len() / 2].to_vec()] {
        place.write("coin.smcc", &damaged);
        for (code, said) in verified(&file) {
            assert_eq!(code, 2, "{said}");
        }
    }
    let mut tried = 0;
    for &at in &results {
        let kind = whole[at]["result"]["kind"].as_str().unwrap().to_owned();
        let mut mutants: Vec<Mutant> = vec![
            // One trial less, or a narrower claim.
            Box::new(move |lines| {
                let trials = lines[at]["result"]["trials"].as_u64().unwrap();
                lines[at]["result"]["trials"] = json!(trials - 1);
            }),
            Box::new(move |lines| {
                let high = lines[at]["result"]["high"].as_f64().unwrap();
                lines[at]["result"]["high"] = json!(high - 1e-3);
            }),
        ];
        if kind == "rank" {
            // The interval of the choice is no part of its claim.
            mutants.truncate(0);
            mutants.push(Box::new(move |lines| lines[at]["claim"]["claim"]["Best"]["gap"] = json!(0.02)));
            mutants.push(Box::new(move |lines| {
                lines[at]["claim"]["claim"]["Best"]["choice"] = json!("p = 0.5");
            }));
        }
        if kind == "check" {
            mutants.push(Box::new(move |lines| {
                let satisfied = lines[at]["result"]["verdict"] == "satisfied";
                lines[at]["result"]["verdict"] = json!(if satisfied { "violated" } else { "satisfied" });
            }));
            mutants.push(Box::new(move |lines| {
                let error = lines[at]["claim"]["error"].as_f64().unwrap();
                lines[at]["claim"]["error"] = json!(error / 10.0);
            }));
        }
        for mutant in mutants {
            let mut lines = whole.clone();
            mutant(&mut lines);
            forged(&place, &lines);
            for (code, said) in verified(&file) {
                assert_eq!((code, said.matches("refused").count()), (1, 1), "{}\n{said}", lines[at]);
            }
            tried += 1;
        }
    }
    assert!(tried > 35, "{tried}");
}

/// Few trials of every shipped model: stops by budget are part of a certificate, too.
#[test]
fn results_of_shipped_models_follow_from_their_outcomes() {
    let place = Place::new(&[]);
    let (file, folder) =
        (place.path("out.smcc"), std::env::var("SMC_DATA").unwrap_or("../shared/data".into()));
    let data = Path::new(&folder).join("eth-biwi");
    let mut tried = 0;
    for properties in std::fs::read_dir("properties").unwrap().map(|entry| entry.unwrap().path()) {
        let model = Path::new("models").join(properties.with_extension("scn").file_name().unwrap());
        if !model.exists() || model.to_string_lossy().contains("hotel") && !data.is_dir() {
            eprintln!("SKIPPED: {} needs a model or data that is not here", properties.display());
            continue;
        }
        let mut command = Command::new(env!("CARGO_BIN_EXE_smc"));
        command.arg("check").args([&model, &properties]).args(["-q", "--max-trials", "8", "--certificate"]);
        command.arg(&file).args(data.is_dir().then(|| format!("--data={}", data.display())));
        let output = command.output().unwrap();
        assert!(output.status.code().is_some_and(|code| code != 2), "{model:?}: {output:?}");
        for (code, said) in verified(&file) {
            assert!(matches!(code, 0 | 3) && !said.contains("refused"), "{model:?}: {said}");
        }
        tried += 1;
    }
    assert!(tried > 20, "{tried}");
}
