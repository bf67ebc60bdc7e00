//! `smc verify`: whether the results of a certificate follow from its outcomes, and whether some of these are those of their
//! trials.

use super::arguments::VerifyCommand;
use super::terminal::{Colors, print};
use super::values::{Model, TextFormat, parse_velocity, threads};
use super::{complaint, inputs};
use crate::base::visible::visible;
use crate::engine::Threads;
use crate::library::program::playing;
use crate::library::verify::{Audit, Mismatch, audit, follows, is_asked};
use crate::model::Scenario;
use crate::report::ExitCode as Exit;
use crate::report::certificate::{self, Entry, Head};
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use crate::{gait, library};
use serde_json::{Value, json};
use std::hash::{BuildHasher, RandomState};

/// Probability with which the share of forged outcomes that is named escapes an audit.
const ESCAPES: f64 = 0.01;

/// What was found.
struct Verified<'a> {
    head: &'a Head,
    entries: &'a [Entry],
    /// For each result why it does not follow, if it does not.
    faults: Vec<Option<String>>,
    audit: Option<Audit>,
}

/// Runs the command.
pub(super) fn run(arguments: &VerifyCommand, colors: Colors) -> Exit {
    complaint::end(verify(arguments, colors), &[], colors)
}

fn verify(arguments: &VerifyCommand, colors: Colors) -> Result<Exit, Vec<Diagnostic>> {
    let name = &arguments.certificate;
    let wrong = |reason: &str| complaint::certificate(format!("`{name}` is no certificate: {reason}"));
    let bytes = inputs::read(name).map_err(complaint::input)?;
    let text = std::str::from_utf8(&bytes).map_err(|_| wrong("it is not UTF-8 text"))?;
    let (head, entries) = certificate::read(text).map_err(|error| wrong(&error.to_string()))?;
    let threads = threads(arguments.cores.threads)?;
    let faults = entries.iter().map(|entry| follows(&head, entry, &threads).err()).collect();
    let audit = match arguments.files.as_slice() {
        [] => None,
        _ => beside(arguments, (&head, &entries), &threads, colors)?,
    };
    let found = Verified { head: &head, entries: &entries, faults, audit };
    print(&match arguments.format {
        TextFormat::Text => visible(&found.text()).into_owned(),
        TextFormat::Json => format!("{:#}\n", found.json()),
    })?;
    Ok(if found.is_right() { Exit::Success } else { Exit::Violated })
}

/// Compares a certificate with the inputs that it names, and runs some of its trials again.
fn beside(
    arguments: &VerifyCommand,
    (head, entries): (&Head, &[Entry]),
    threads: &Threads,
    colors: Colors,
) -> Result<Option<Audit>, Vec<Diagnostic>> {
    let model = Model {
        scenario: arguments.files[0].clone(),
        set: head.settings.clone(),
        data: arguments.data.clone(),
        models: head.models.clone(),
        calibration: arguments.calibration.clone(),
        allow_run: arguments.allow_run,
        velocity: head.velocity.as_deref().and_then(|velocity| parse_velocity(velocity).ok()),
    };
    // What is wrong with them is told with its place.
    let Some((mut study, loaded)) = inputs::load_or_tell(&model, &arguments.files[1..], colors) else {
        return Err(Vec::new());
    };
    let other = |title: String| vec![complaint::certificate(title)];
    let prints: Vec<String> = loaded.inputs.prints.iter().map(|(_, print)| print.to_string()).collect();
    for (file, print) in &head.inputs {
        if !prints.contains(print) {
            return Err(other(format!("the certificate is of another `{file}`: no input has its digest")));
        }
    }
    let ways = Ways::default();
    let doubts = library::survey(&mut study, &[], head.seed, &ways);
    complaint::tell_all(&doubts, &loaded.inputs.sources, colors);
    if library::is_refused(&doubts) {
        return Err(Vec::new());
    }
    if let Some(entry) = entries.iter().find(|entry| !is_asked(&study, entry)) {
        let query = entry.queries.first().map_or("", |query| query.text.as_str());
        return Err(other(format!("the property files do not ask `{query}` as the certificate has it")));
    }
    let Some(draws) = arguments.audit else { return Ok(None) };
    let key = arguments.audit_seed.unwrap_or_else(|| RandomState::new().hash_one("audit"));
    let programs = inputs::programs(&model, &study, || false)?;
    let drivers = move |scenario: &Scenario, seed: u64| {
        playing(gait::drivers(&ways, scenario, seed), programs.as_ref())
    };
    let found = audit((&study, &drivers), (head, entries), (draws, key), threads);
    found.map(Some).map_err(|fault| library::refusals(&fault))
}

impl Verified<'_> {
    fn is_right(&self) -> bool {
        let is_audited = self.audit.as_ref().is_none_or(|audit| audit.differ.is_empty());
        is_audited && self.faults.iter().all(Option::is_none)
    }

    /// Each result with its fault.
    fn results(&self) -> impl Iterator<Item = (&str, &str, Option<&str>)> {
        self.entries.iter().zip(&self.faults).map(|(entry, fault)| {
            let [query, certifies] =
                ["query", "certifies"].map(|name| entry.result[name].as_str().unwrap_or_default());
            (query, certifies, fault.as_deref())
        })
    }

    fn text(&self) -> String {
        let mut text =
            format!("{}, seed {}, version {}\n", self.head.scenario, self.head.seed, self.head.version);
        for (file, print) in &self.head.inputs {
            text += &format!("  {file} {print}\n");
        }
        for (query, certifies, fault) in self.results() {
            text += &match fault {
                None if certifies.is_empty() => format!("right      {query}: certifies nothing\n"),
                None => format!("right      {query}: {certifies}\n"),
                Some(fault) => format!("refused    {query}: {fault}\n"),
            };
        }
        let Some(audit @ Audit { draws, key, differ }) = &self.audit else { return text };
        for one in differ {
            let query = self.entries[one.entry].result["query"].as_str().unwrap_or_default();
            text +=
                &format!("refused    {query}: trial {} is {:?}, not {:?}\n", one.trial, one.found, one.told);
        }
        text + &format!(
            "audit      {draws} outcomes drawn, {} differ; {:.2} % forged outcomes escape with a probability of 1 % (--audit-seed {key})\n",
            differ.len(),
            100.0 * audit.escapes(ESCAPES),
        )
    }

    fn json(&self) -> Value {
        let result = |(query, certifies, fault): (&str, &str, Option<&str>)| json!({ "query": query, "certifies": certifies, "right": fault.is_none(), "fault": fault });
        let audit = self.audit.as_ref().map(|audit| {
            let one = |one: &Mismatch| {
                json!({ "query": self.entries[one.entry].result["query"], "trial": one.trial })
            };
            let differ: Vec<Value> = audit.differ.iter().map(one).collect();
            json!({ "drawn": audit.draws, "seed": audit.key, "escapes": audit.escapes(ESCAPES), "differ": differ })
        });
        json!({
            "schema": 1,
            "scenario": self.head.scenario,
            "right": self.is_right(),
            "results": self.results().map(result).collect::<Vec<_>>(),
            "audit": audit,
        })
    }
}
