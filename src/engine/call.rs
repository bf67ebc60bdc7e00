//! What a call adds to a study, and the command lines that show what was found.

use crate::kernel::driver::MakeDrivers;
use crate::syntax::parse::split_values;
use crate::syntax::source::Span;

/// What a call adds to a study.
pub struct Call<'c> {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Which of the calls that ask again with this seed it is: an adviser asks in each cycle. Other calls are number 0.
    pub branch: u16,
    /// Whether witnesses of its results are looked for, which takes time.
    pub explains: bool,
    /// Whether its results say how their evidence grew.
    pub shows_evidence: bool,
    /// Whether drivers from outside lead its trials: one in a hundred runs twice.
    pub repeats: bool,
    /// The files and settings of the call, for replay lines.
    pub line: CommandLine,
    /// Indices of the queries to ask; all of them if empty.
    pub only: Vec<usize>,
    /// File and line of a span, for reports.
    pub place: &'c (dyn Fn(Span) -> (String, usize) + Sync),
    /// Makes the drivers of the agents of a world.
    pub drivers: &'c MakeDrivers,
}

/// The files and settings of a call of the program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CommandLine {
    /// The scenario; also its name in reports where it has no title.
    pub scenario: String,
    /// Whether a table of outcomes stands in its place.
    pub outcomes: bool,
    /// Whether a program of the scenario may run.
    pub allow_run: bool,
    /// Property files.
    pub properties: Vec<String>,
    /// Values of `--set`: `density=0.8`, or a sweep, `density=0.1..0.8 by 0.1`, `n=2,4,8`.
    pub settings: Vec<String>,
    /// Values of `--data`.
    pub data: Vec<String>,
    /// Value of `--velocity`.
    pub velocity: Option<String>,
    /// Values of `--models`.
    pub models: Vec<String>,
}

impl CommandLine {
    /// `smc check` with all its settings.
    pub fn check(&self) -> String {
        self.words("check", |_| true)
    }

    /// `smc shard` with all its settings.
    pub fn shard(&self) -> String {
        self.words("shard", |_| true)
    }

    /// `smc check` at a point of its sweeps.
    pub(super) fn check_at(&self, point: &[(String, String)]) -> String {
        let mut words = self.words("check", |set| !is_sweep(set));
        for (name, value) in point {
            words.push_str(&format!(" --set '{name}={value}'"));
        }
        words
    }

    /// `smc simulate` of a trial under some settings. Each replaces that of the call for the same parameter, and the last
    /// of several for one parameter holds.
    pub fn simulate(&self, settings: &[(String, String)], seed: u64, trial: u64) -> String {
        let is_replaced = |set: &str| settings.iter().any(|(name, _)| name == parameter(set));
        let mut words = self.words("simulate", |set| !is_sweep(set) && !is_replaced(set));
        for (k, (name, value)) in settings.iter().enumerate() {
            if settings[k + 1..].iter().all(|(later, _)| later != name) {
                words.push_str(&format!(" --set '{name}={value}'"));
            }
        }
        format!("{words} --seed {seed} --trial {trial}")
    }

    /// The call up to its other options, as a shell would take it.
    fn words(&self, verb: &str, keep: impl Fn(&str) -> bool) -> String {
        let mut words = vec!["smc".to_owned(), verb.to_owned()];
        words.extend(self.outcomes.then(|| "--outcomes".to_owned()));
        words.extend(self.allow_run.then(|| "--allow-run".to_owned()));
        words.push(file(&self.scenario));
        if verb != "simulate" {
            words.extend(self.properties.iter().map(|name| file(name)));
        }
        for set in self.settings.iter().filter(|set| keep(set)) {
            words.extend(["--set".to_owned(), quoted(set)]);
        }
        for data in &self.data {
            words.extend(["--data".to_owned(), quoted(data)]);
        }
        if let Some(velocity) = &self.velocity {
            words.extend(["--velocity".to_owned(), quoted(velocity)]);
        }
        if !self.models.is_empty() {
            words.extend(["--models".to_owned(), quoted(&self.models.join(","))]);
        }
        words.join(" ")
    }
}

/// A trial, or a query, belongs to one setting: the value of a sweep is named with it.
fn is_sweep(set: &str) -> bool {
    set.contains("..") || split_values(set).len() > 1
}

fn parameter(set: &str) -> &str {
    set.split('=').next().unwrap_or_default().trim()
}

/// The name of a file as a shell would take it, and not for an option; `-` alone is the standard input.
fn file(name: &str) -> String {
    if name.len() > 1 && name.starts_with('-') { quoted(&format!("./{name}")) } else { quoted(name) }
}

/// A word as a shell would take it.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(quoted("models/a.scn"), "models/a.scn");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!([file("-"), file("-a b"), file("a-b")], ["-", "'./-a b'", "a-b"]);
    }

    #[test]
    fn a_setting_replaces_that_of_the_call_for_the_same_parameter() {
        let line = CommandLine {
            scenario: "a.scn".into(),
            outcomes: false,
            allow_run: false,
            properties: vec!["a.bltl".into()],
            settings: vec!["n=2".into(), "d=0.1..0.8 by 0.1".into(), "gap=1 m".into()],
            data: vec!["my data".into()],
            velocity: None,
            models: Vec::new(),
        };
        assert_eq!(
            line.check(),
            "smc check a.scn a.bltl --set n=2 --set 'd=0.1..0.8 by 0.1' --set 'gap=1 m' --data 'my data'"
        );
        let own = |pairs: &[(&str, &str)]| {
            pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect::<Vec<_>>()
        };
        assert_eq!(
            line.check_at(&own(&[("d", "0.3")])),
            "smc check a.scn a.bltl --set n=2 --set 'gap=1 m' --data 'my data' --set 'd=0.3'"
        );
        assert_eq!(
            line.simulate(&own(&[("d", "0.3"), ("n", "4"), ("n", "5")]), 7, 12),
            "smc simulate a.scn --set 'gap=1 m' --data 'my data' --set 'd=0.3' --set 'n=5' --seed 7 --trial 12"
        );
    }
}
