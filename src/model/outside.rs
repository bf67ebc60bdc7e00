//! A program that stands in the place of a model: it runs elsewhere and writes a trace.

use super::agent::AgentId;

/// A program, and how its traces are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Outside {
    /// Its name in the scenario.
    pub name: String,
    /// The words with which it is run; the first one is the program itself.
    pub words: Vec<Vec<CallPart>>,
    /// How it writes its trace on standard output.
    pub format: TraceForm,
    /// The column of the time.
    pub time: String,
    /// The columns of the variables of the scenario, in their order.
    pub columns: Vec<String>,
    /// The people whom it shows.
    pub people: Option<ShownPeople>,
    /// Whether the last state lasts up to the horizon; if not, a trace that ends before it is unresolved.
    pub is_held: bool,
    /// How long one trial may run, s.
    pub limit: f64,
}

/// A part of a word.
#[derive(Clone, Debug, PartialEq)]
pub enum CallPart {
    /// As it is written, or the value of a parameter.
    Text(String),
    /// The seed of the trial.
    Seed,
    /// The number of the trial.
    Trial,
    /// The move that is followed.
    Move,
}

/// How a trace is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceForm {
    /// Comma-separated values below a line of heads.
    Csv,
    /// An object of JSON on each line.
    Jsonl,
}

impl TraceForm {
    /// Both, each with its name in a scenario.
    pub const ALL: [(&'static str, Self); 2] = [("csv", Self::Csv), ("jsonl", Self::Jsonl)];
}

/// The people whom a program shows.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownPeople {
    /// The columns of the id and of the place, and those of the velocity where there are any.
    pub columns: Vec<String>,
    /// Places for them, in the order in which they are seen first.
    pub members: Vec<AgentId>,
}

impl Outside {
    /// The call of a trial, word by word.
    pub fn call(&self, seed: u64, trial: u64, option: &str) -> Vec<String> {
        self.said(&seed.to_string(), &trial.to_string(), option)
    }

    /// The call as it is told: with names in the place of what differs from trial to trial.
    pub fn told(&self) -> String {
        self.said("{seed}", "{trial}", "{move}").join(" ")
    }

    fn said(&self, seed: &str, trial: &str, option: &str) -> Vec<String> {
        let part = |part: &CallPart| match part {
            CallPart::Text(text) => text.clone(),
            CallPart::Seed => seed.to_owned(),
            CallPart::Trial => trial.to_owned(),
            CallPart::Move => option.to_owned(),
        };
        self.words.iter().map(|word| word.iter().map(part).collect()).collect()
    }
}
