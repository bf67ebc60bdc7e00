//! Runs the validation suite for every preset and writes `docs/validation.md`.
//!
//! `cargo run --release --example validate` from the root of the repository. Each test is a scenario and a property file in
//! `validation/`. The first line of the scenario names the source, the first line of the properties the criterion. Two more
//! comments may follow there: `// Settings: n = 1, 2` asks for several values of a parameter, `// Trials: 600` is the budget
//! of a query (120 unless given). A number as argument, as in `-- 20`, is the largest budget of all. Another argument is the
//! folder of the recordings of ETH/BIWI: then every preset is also compared with people who were recorded.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]
#![allow(clippy::disallowed_methods, reason = "an example opens its own files")]

#[path = "validate/recorded.rs"]
mod recorded;

#[path = "validate/figures.rs"]
mod figures;

use figures::Figures;
use smc::compile::presets::PRESETS;
use smc::engine::outcome::Verdict;
use smc::{Draft, Options, Report};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The preset that the scenarios name.
const NAMED: &str = "sfm preset smc1";

const TRIALS: u64 = 120;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (numbers, folders): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word.parse::<u64>().is_ok());
    let most = numbers.first().map_or(Ok(u64::MAX), |most| most.parse())?;
    let folder = Path::new("validation");
    let names: BTreeSet<String> = fs::read_dir(folder)?
        .filter_map(|entry| {
            Some(entry.ok()?.file_name().into_string().ok()?.strip_suffix(".bltl")?.to_string())
        })
        .collect();
    let mut page = fs::read_to_string(folder.join("head.md"))?;
    page.push_str(&recorded::section(folders.first().map(Path::new), most.min(TRIALS))?);
    let (mut figures, mut tests) = (Figures::default(), String::new());
    let presets: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    writeln!(
        page,
        "\n## Verdicts\n\n| test | {} |\n| --- {}|",
        presets.join(" | "),
        "| --- ".repeat(presets.len())
    )?;
    for name in &names {
        let scenario = fs::read_to_string(folder.join(format!("{name}.scn")))?;
        let properties = fs::read_to_string(folder.join(format!("{name}.bltl")))?;
        eprintln!("{name}");
        let started = std::time::Instant::now();
        let (text, tallies) = section((name, &scenario, &properties), most, &mut figures)?;
        let tallies: Vec<String> = tallies.iter().map(Tally::words).collect();
        writeln!(page, "| [{name}](#{name}) | {} |", tallies.join(" | "))?;
        tests.push_str(&text);
        tests.push_str(&figures.below(name)?);
        eprintln!("  {:.0} s", started.elapsed().as_secs_f64());
    }
    page.push_str(&tests);
    page.push_str(&fs::read_to_string(folder.join("missing.md"))?);
    fs::write("docs/validation.md", page)?;
    Ok(())
}

/// What a comment of a text says after a word.
fn comment<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    text.lines().find_map(|line| line.strip_prefix("// ")?.strip_prefix(word))
}

/// How many checks of a test a preset meets.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    checks: usize,
    met: usize,
    violated: usize,
}

impl Tally {
    fn add(&mut self, verdict: Option<Verdict>) {
        self.checks += 1;
        self.met += usize::from(verdict == Some(Verdict::Satisfied));
        self.violated += usize::from(verdict == Some(Verdict::Violated));
    }

    fn words(&self) -> String {
        let open = self.checks - self.met - self.violated;
        let parts = [(self.met, "satisfied"), (self.violated, "violated"), (open, "undecided")];
        let parts: Vec<String> = parts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(
                |(count, word)| if self.checks == 1 { (*word).to_owned() } else { format!("{count} {word}") },
            )
            .collect();
        if parts.is_empty() { "numbers only".into() } else { parts.join(", ") }
    }
}

/// A test: its source, its criterion, and a table of queries by presets; and what each preset meets.
fn section(
    (name, scenario, properties): (&str, &str, &str),
    most: u64,
    figures: &mut Figures,
) -> Result<(String, Vec<Tally>), Box<dyn std::error::Error>> {
    let mut out = format!("\n## {name}\n\n");
    writeln!(out, "{} {}\n", comment(scenario, "").unwrap_or(""), comment(properties, "").unwrap_or(""))?;
    let presets: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    writeln!(out, "| query | {} |", presets.join(" | "))?;
    writeln!(out, "| --- {}|", "| --- ".repeat(presets.len()))?;
    let settings = match comment(properties, "Settings: ").and_then(|all| all.split_once(" = ")) {
        Some((parameter, values)) => values.split(", ").map(|value| Some((parameter, value))).collect(),
        None => vec![None],
    };
    let trials = comment(properties, "Trials: ").map_or(Ok(TRIALS), str::parse)?;
    let options = Options::default().max_trials(trials.min(most));
    let mut tallies = vec![Tally::default(); presets.len()];
    for setting in settings {
        let of = |preset: &&str| {
            let text = scenario.replace(NAMED, &format!("preset {preset}"));
            let source = Draft::new(name, text);
            let source = setting.map_or(source.clone(), |(parameter, value)| source.set(parameter, value));
            source.parse()?.check(properties, &options)
        };
        let reports: Vec<_> = presets.iter().map(of).collect();
        for (preset, report) in presets.iter().zip(&reports) {
            let report = report.as_ref().ok();
            figures.note(
                (name, preset),
                setting.map(|(_, value)| value),
                report.map_or(&[], Report::results),
            );
        }
        let queries =
            properties.lines().filter(|line| line.starts_with("check ") || line.starts_with("estimate "));
        for (k, query) in queries.enumerate() {
            let given =
                setting.map_or(String::new(), |(parameter, value)| format!("{parameter} = {value}: "));
            write!(out, "| {given}`{query}` |")?;
            for (tally, report) in tallies.iter_mut().zip(&reports) {
                if query.starts_with("check") {
                    tally.add(report.as_ref().ok().and_then(|report| report.results().get(k)?.verdict));
                }
                let cell = report.as_ref().map_or_else(
                    |refused| {
                        let code = refused.iter().next().map(|first| first.code.name());
                        format!("cannot begin ({})", code.unwrap_or(""))
                    },
                    |report| cell(report, k),
                );
                write!(out, " {cell} |")?;
            }
            out.push('\n');
        }
    }
    Ok((out, tallies))
}

/// Verdict, estimate and interval of a query.
fn cell(report: &Report, query: usize) -> String {
    let Some(result) = report.results().get(query) else { return "-".into() };
    let verdict = result.verdict.map_or(String::new(), |verdict| format!("**{}** ", verdict.name()));
    let estimate = result.estimate.map_or("-".into(), |value| format!("{value:.2}"));
    let trials = result.consumed.counts.trials;
    format!("{verdict}{estimate} [{:.2}, {:.2}], {trials} trials", result.low, result.high)
}
