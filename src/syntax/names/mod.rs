//! Where the names of a scenario and its property files are declared and used, so that an editor leads from one place to the
//! other. The trees say it, nothing is compiled; a part that could not be read has no names.
//!
//! ```text
//! const WIDTH = 4 m                        WIDTH: a constant of the file
//! process queue { var n: 0 .. 5 = 0 }      queue: of the file; n: inside of queue
//! property short = G (queue.n < WIDTH)     `n` is looked for inside of what stands before the point
//! ```

mod expression;
mod items;
mod questions;

use super::ast::{Expr, Ident, PropertyFile, ScenarioFile};
use super::source::Span;
use std::collections::BTreeMap;

/// A name that is declared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declared {
    /// The name.
    pub name: String,
    /// The place of the name.
    pub span: Span,
    /// The place of the whole declaration, as far as the tree knows it.
    pub whole: Span,
    /// The word that declares it: `const`, `agent`, `region`, `var`; `argument` of what is bound in an expression.
    pub noun: &'static str,
    /// The declaration inside of which it stands: a process, a behaviour, a level.
    pub inside: Option<usize>,
    /// Names of its arguments.
    pub arguments: Vec<String>,
    /// The place of its value, if it has one.
    pub value: Option<Span>,
}

/// A name that is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Used {
    /// Where.
    pub span: Span,
    /// The declaration that it means.
    pub means: usize,
}

/// All names.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Declarations, those of the scenario first.
    pub declared: Vec<Declared>,
    /// Uses, in no order.
    pub used: Vec<Used>,
    /// The names of a file, from 0 for the scenario, or inside of a declaration.
    known: BTreeMap<(Scope, String), usize>,
}

/// Where a name is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Scope {
    File(usize),
    Inside(usize),
}

impl Names {
    /// The names of a scenario and of property files.
    pub fn of(scenario: &ScenarioFile, properties: &[PropertyFile]) -> Self {
        let mut walk =
            Walk { names: Self::default(), file: 0, inside: None, bound: Vec::new(), declares: true };
        // Order does not matter: all declarations are known before the first use is looked at.
        for declares in [true, false] {
            walk.declares = declares;
            walk.file = 0;
            scenario.items.iter().for_each(|item| walk.item(item));
            for (number, file) in properties.iter().enumerate() {
                walk.file = number + 1;
                file.items.iter().for_each(|item| walk.property_item(item));
            }
        }
        walk.names
    }

    /// The declaration that a place names: it stands there, or is meant there.
    pub fn at(&self, source: Span) -> Option<usize> {
        let here = |span: Span| span.holds(source);
        let used = self.used.iter().filter(|used| here(used.span));
        let own = self.declared.iter().position(|declared| here(declared.span));
        used.min_by_key(|used| used.span.end - used.span.start).map(|used| used.means).or(own)
    }

    /// All places of a name, that of its declaration first.
    pub fn places(&self, declaration: usize) -> Vec<Span> {
        let own = self.declared.get(declaration).map(|declared| declared.span);
        let used = self.used.iter().filter(|used| used.means == declaration).map(|used| used.span);
        let mut places: Vec<Span> = own.into_iter().chain(used).collect();
        places[1.min(own.iter().len())..].sort_unstable();
        places.dedup();
        places
    }
}

struct Walk {
    names: Names,
    /// The file that is walked: 0 is the scenario.
    file: usize,
    /// The declaration inside of which the walk is.
    inside: Option<usize>,
    /// Arguments and agents of quantifiers around, with their declarations.
    bound: Vec<(String, usize)>,
    /// Whether declarations are collected, or uses.
    declares: bool,
}

impl Walk {
    /// Declares a name, or finds its declaration again.
    fn declare(&mut self, noun: &'static str, name: &Ident, whole: Span, value: Option<&Expr>) -> usize {
        let scope = self.inside.map_or(Scope::File(self.file), Scope::Inside);
        let key = (scope, name.name.clone());
        if !self.declares {
            let own = |one: &Declared| one.span == name.span;
            return self.names.declared.iter().position(own).unwrap_or(usize::MAX);
        }
        let declared = Declared {
            name: name.name.clone(),
            span: name.span,
            whole: name.span.to(whole),
            noun,
            inside: self.inside,
            arguments: Vec::new(),
            value: value.map(|value| value.span),
        };
        self.names.declared.push(declared);
        let at = self.names.declared.len() - 1;
        self.names.known.entry(key).or_insert(at);
        at
    }

    /// The declaration that a name means where the walk is.
    fn look_up(&self, name: &str) -> Option<usize> {
        let known = |scope| self.names.known.get(&(scope, name.to_owned())).copied();
        let bound = self.bound.iter().rev().find(|(bound, _)| bound == name).map(|(_, at)| *at);
        let inside = || self.inside.and_then(|at| known(Scope::Inside(at)));
        bound.or_else(inside).or_else(|| known(Scope::File(self.file))).or_else(|| known(Scope::File(0)))
    }

    fn note(&mut self, span: Span, means: Option<usize>) -> Option<usize> {
        if let Some(means) = means.filter(|_| !self.declares) {
            self.names.used.push(Used { span, means });
        }
        means
    }

    fn used(&mut self, name: &Ident) -> Option<usize> {
        self.note(name.span, self.look_up(&name.name))
    }

    fn all_used<'i>(&mut self, names: impl IntoIterator<Item = &'i Ident>) {
        for name in names {
            self.used(name);
        }
    }

    /// A name inside of a declaration.
    fn member(&mut self, of: Option<usize>, member: &Ident) -> Option<usize> {
        let known = |at| self.names.known.get(&(Scope::Inside(at), member.name.clone())).copied();
        let own = of.and_then(known);
        // `user.phone`: the behaviour of an agent.
        let behaviour =
            || self.look_up(&member.name).filter(|at| self.names.declared[*at].noun == "behaviour");
        self.note(member.span, own.or_else(behaviour))
    }

    /// Walks something in which names are bound.
    fn binding(&mut self, names: &[Ident], walk: impl FnOnce(&mut Self)) {
        let before = self.bound.len();
        if self.declares {
            return walk(self);
        }
        for name in names {
            self.names.declared.push(Declared {
                name: name.name.clone(),
                span: name.span,
                whole: name.span,
                noun: "argument",
                inside: self.inside,
                arguments: Vec::new(),
                value: None,
            });
            self.bound.push((name.name.clone(), self.names.declared.len() - 1));
        }
        walk(self);
        self.bound.truncate(before);
    }

    /// Walks what stands inside of a declaration.
    fn within(&mut self, declaration: usize, walk: impl FnOnce(&mut Self)) {
        let around = self.inside.replace(declaration);
        walk(self);
        self.inside = around;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::parse::{parse_properties, parse_scenario};
    use crate::syntax::source::{Source, SourceId};

    /// The declaration of each use: `name@line -> noun@line`.
    fn uses(scenario: &str, properties: &str) -> Vec<String> {
        let sources =
            [Source::new(SourceId(0), "a.scn", scenario), Source::new(SourceId(1), "a.bltl", properties)];
        let names = Names::of(&parse_scenario(&sources[0]).0, &[parse_properties(&sources[1]).0]);
        let mut found = names.used.clone();
        found.sort_by_key(|used| used.span);
        let line = |span: Span| sources[usize::from(span.source.0)].line(span.start);
        let text = |span: Span| sources[usize::from(span.source.0)].slice(span).to_owned();
        let told = |used: &Used| {
            let means = &names.declared[used.means];
            format!("{}@{} -> {}@{}", text(used.span), line(used.span), means.noun, line(means.span))
        };
        found.iter().map(told).collect()
    }

    #[test]
    fn each_use_leads_to_its_declaration() {
        let scenario = "const N = 2\nprocess q {\n  var n: 0 .. N = 0\n  when n < N -> n = n + 1\n}\n\
             agents crowd[N]: adult { at = (0, 0) }\nkind adult: sfm { }\nagent n: adult { at = (N, 1) }";
        let properties =
            "let N(a) = speed(a)\nproperty p = forall n in crowd: N(n) < 1 m/s & q.n < 2\ncheck P(p) >= 0.5";
        assert_eq!(
            uses(scenario, properties),
            [
                "N@3 -> const@1",
                "n@4 -> var@3",
                "N@4 -> const@1",
                "n@4 -> var@3",
                "n@4 -> var@3",
                "N@6 -> const@1",
                "adult@6 -> kind@7",
                "adult@8 -> kind@7",
                "N@8 -> const@1",
                "a@1 -> argument@1",
                "crowd@2 -> agents@6",
                "N@2 -> let@1",
                "n@2 -> argument@2",
                "q@2 -> process@2",
                "n@2 -> var@3",
                "p@3 -> property@2",
            ]
        );
    }

    #[test]
    fn states_are_those_of_their_behaviour() {
        let scenario = "behaviour phone {\n  state looking { after 2 s -> attentive }\n  state attentive { }\n}\n\
             kind adult: sfm { }\nagent user: adult with phone { at = (0, 0) }";
        let found = uses(scenario, "property p = F (user.phone == looking)");
        assert_eq!(
            found,
            [
                "attentive@2 -> state@3",
                "adult@6 -> kind@5",
                "phone@6 -> behaviour@1",
                "user@1 -> agent@6",
                "phone@1 -> behaviour@1",
                "looking@1 -> state@2",
            ]
        );
    }
}
