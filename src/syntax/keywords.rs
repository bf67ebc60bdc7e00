//! The keywords of both languages: one row each, read by the parser, by its hints, by the errors that follow from a part
//! that could not be read, and by the pages that show a text.
//!
//! A keyword is one only in its place: `line` may be the name of a door, and `radius = 0.3 m` sets a field.

/// The parts of files that hold items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A scenario itself.
    Scenario,
    /// A property file.
    Properties,
    /// `scene { … }`
    Scene,
    /// `process p { … }`
    Process,
    /// `program p { … }`
    Program,
    /// `behaviour b { … }`
    Behaviour,
    /// `state s { … }`
    State,
    /// `moves a for 2 s { … }`
    Moves,
    /// The fields of a declaration.
    Fields,
    /// Any other block: updates, answers, paths.
    Other,
}
use Place::{Behaviour, Moves, Process, Program, Properties, Scenario, Scene, State};

/// The name behind a keyword that begins an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declares {
    /// No name of its own.
    Nothing,
    /// The name of a value, which may stand in any expression.
    Value,
    /// The name of something else.
    Thing,
}

/// A keyword.
pub struct Keyword {
    /// As it is written.
    pub word: &'static str,
    /// The parts whose items it begins.
    pub begins: &'static [Place],
    /// The name that follows it there.
    pub declares: Declares,
    /// Whether it only goes on with an item: a line that begins with it is none of its own.
    pub continues: bool,
}

const fn starting(word: &'static str, begins: &'static [Place], declares: Declares) -> Keyword {
    Keyword { word, begins, declares, continues: false }
}

const fn continuing(word: &'static str) -> Keyword {
    Keyword { word, begins: &[], declares: Declares::Nothing, continues: true }
}

const fn within(word: &'static str) -> Keyword {
    Keyword { word, begins: &[], declares: Declares::Nothing, continues: false }
}

/// The keywords; of those that begin the items of a part hints name them in this order.
pub const KEYWORDS: [Keyword; 89] = [
    starting("scenario", &[Scenario], Declares::Nothing),
    starting("horizon", &[Scenario], Declares::Nothing),
    starting("step", &[Scenario], Declares::Nothing),
    starting("property", &[Properties], Declares::Thing),
    starting("state", &[Behaviour], Declares::Thing),
    starting("on", &[Behaviour], Declares::Thing),
    starting("var", &[Process], Declares::Value),
    starting("let", &[Scenario, Properties, Process, Behaviour], Declares::Value),
    starting("const", &[Scenario, Properties], Declares::Value),
    starting("param", &[Scenario], Declares::Value),
    starting("label", &[Process], Declares::Value),
    starting("signal", &[Program], Declares::Value),
    starting("tracks", &[Scenario], Declares::Thing),
    starting("scene", &[Scenario], Declares::Nothing),
    starting("kind", &[Scenario], Declares::Thing),
    starting("agent", &[Scenario], Declares::Thing),
    starting("agents", &[Scenario, Program], Declares::Thing),
    starting("group", &[Scenario], Declares::Thing),
    starting("groups", &[Scenario], Declares::Thing),
    starting("moves", &[Scenario], Declares::Nothing),
    starting("paths", &[Scenario], Declares::Nothing),
    starting("process", &[Scenario], Declares::Value),
    starting("program", &[Scenario], Declares::Value),
    starting("behaviour", &[Scenario], Declares::Thing),
    starting("source", &[Scenario], Declares::Thing),
    starting("family", &[Properties], Declares::Nothing),
    starting("check", &[Properties], Declares::Nothing),
    starting("estimate", &[Properties], Declares::Nothing),
    starting("compare", &[Properties], Declares::Nothing),
    starting("rank", &[Properties], Declares::Nothing),
    starting("pareto", &[Properties], Declares::Nothing),
    starting("wall", &[Scene], Declares::Thing),
    starting("obstacle", &[Scene], Declares::Thing),
    starting("region", &[Scene], Declares::Thing),
    starting("point", &[Scene], Declares::Thing),
    starting("line", &[Scene], Declares::Thing),
    starting("door", &[Scene], Declares::Thing),
    starting("import", &[Scene], Declares::Nothing),
    starting("periodic", &[Scene], Declares::Nothing),
    starting("level", &[Scene], Declares::Thing),
    starting("stairs", &[Scene], Declares::Thing),
    starting("after", &[State], Declares::Nothing),
    starting("when", &[Process, State], Declares::Nothing),
    starting("choose", &[Process], Declares::Nothing),
    starting("heading", &[Moves], Declares::Nothing),
    starting("route", &[Moves], Declares::Nothing),
    starting("stop", &[Moves], Declares::Nothing),
    continuing("as"),
    continuing("at"),
    continuing("by"),
    continuing("confidence"),
    continuing("except"),
    continuing("for"),
    continuing("from"),
    continuing("hole"),
    continuing("id"),
    continuing("in"),
    continuing("of"),
    continuing("preset"),
    continuing("radius"),
    continuing("subject"),
    continuing("then"),
    continuing("to"),
    continuing("under"),
    continuing("where"),
    continuing("with"),
    continuing("within"),
    within("across"),
    within("along"),
    within("alternatives"),
    within("circle"),
    within("count"),
    within("end"),
    within("exists"),
    within("forall"),
    within("learned"),
    within("leave"),
    within("limit"),
    within("log"),
    within("near"),
    within("particle"),
    within("polygon"),
    within("rect"),
    within("roadmap"),
    within("search"),
    within("stream"),
    within("uniform"),
    within("wait"),
    within("walkable"),
];

/// Words that are operators in property files, and no names.
pub const OPERATORS: [&str; 8] = ["forall", "exists", "F", "G", "X", "U", "W", "R"];
/// The measures of queries, the folds over windows and sets, and the truth values.
pub const OTHERS: [&str; 10] = ["P", "E", "Q", "CVaR", "min", "max", "sum", "mean", "true", "false"];

/// Whether a word is a measure of a query.
pub fn is_measure(word: &str) -> bool {
    OTHERS[..4].contains(&word)
}

/// Whether a word is an operator over time in property files.
pub fn is_temporal(word: &str) -> bool {
    OPERATORS[2..].contains(&word)
}

/// A keyword by its word.
pub fn keyword(word: &str) -> Option<&'static Keyword> {
    KEYWORDS.iter().find(|keyword| keyword.word == word)
}

/// Whether a line that begins with a word goes on with the line before.
pub fn continues(word: &str) -> bool {
    keyword(word).is_some_and(|keyword| keyword.continues)
}

/// Whether a word and what follows it surely begin an item, whatever stands before: a keyword and the name or measure
/// that goes with it, or another mark.
pub fn begins(word: &str, next: &str) -> bool {
    let is_name =
        next.starts_with(|c: char| c.is_alphabetic() || c == '_') && !matches!(next, "in" | "U" | "W" | "R");
    match word {
        "check" | "estimate" | "compare" => is_measure(next),
        "scene" => next == "{",
        "scenario" | "import" => next.starts_with('"'),
        "moves" | "paths" | "rank" | "pareto" | "family" | "periodic" => is_name,
        _ => is_name && keyword(word).is_some_and(|keyword| keyword.declares != Declares::Nothing),
    }
}

/// The words that begin the items of a part.
pub fn beginning(place: Place) -> impl Iterator<Item = &'static str> {
    KEYWORDS.iter().filter(move |keyword| keyword.begins.contains(&place)).map(|keyword| keyword.word)
}

/// Whether a word has a meaning of its own somewhere, be it as a keyword or as an operator.
pub fn is_marked(word: &str) -> bool {
    keyword(word).is_some() || OPERATORS.contains(&word) || OTHERS.contains(&word)
}
