//! Processes: variables, names and commands.
//!
//! Variables are settled first, so that everything can read them; commands last, because they read
//! everything.

mod commands;
mod names;
mod parts;
mod reachable;
mod timing;

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::number::Number;
use super::people::People;
use super::symbols::unknown;
use super::typed::Typed;
use crate::model::{Bool, Command, Domain, Num, Process, Processes, Timing, Variable, VariableId};
use crate::syntax::ast::process::{self as ast, Domain as Written, ProcessDecl, ProcessItem};
use crate::syntax::ast::{Expr, Ident, Item, LetDecl, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use parts::Writing;
use reachable::Lines;
use std::collections::BTreeMap;
use std::ops::Range;

/// Most copies of a process.
const MOST_COPIES: i64 = 1000;

/// A name inside a process.
#[derive(Clone, Copy, Debug)]
enum Inside<'a> {
    /// Its n-th variable.
    Variable(usize),
    /// A variable that is not settled yet.
    Early,
    /// A named expression or function.
    Let(&'a LetDecl),
    /// A named condition.
    Label(&'a Expr),
    /// A variable whose declaration is wrong, which was reported.
    Lost,
}

impl<'a> Inside<'a> {
    /// The name that an item declares, if it does; what its variable is is given.
    fn of(item: &'a ProcessItem, variable: Self) -> Option<(&'a Ident, Self)> {
        match item {
            ProcessItem::Var(var) => Some((&var.name, variable)),
            ProcessItem::Let(decl) => Some((&decl.name, Self::Let(decl))),
            ProcessItem::Label { name, value } => Some((name, Self::Label(value))),
            ProcessItem::Command(_) | ProcessItem::Choose(_) => None,
        }
    }
}

/// The ends of ranges are below this, so that all sums and differences of them are exact.
const LARGEST: i64 = 1 << 52;

/// A process under elaboration.
pub(super) struct Declared<'a> {
    decl: &'a ProcessDecl,
    /// Number of copies, of an array.
    pub(super) copies: Option<u32>,
    /// Whether that number is not known yet, or has an error.
    pub(super) uncounted: bool,
    /// Whether its variables have errors, so their values are unknown.
    is_unknown: bool,
    /// First variable of the first copy.
    first: u32,
    /// Dimension and domain of each variable of a copy.
    variables: Vec<(Dimension, Domain)>,
    names: BTreeMap<&'a str, Inside<'a>>,
}

impl<'a> Declared<'a> {
    pub(super) fn new(decl: &'a ProcessDecl) -> Self {
        let mut names = BTreeMap::new();
        for (name, inside) in decl.items.iter().filter_map(|item| Inside::of(item, Inside::Early)) {
            names.entry(name.name.as_str()).or_insert(inside);
        }
        Self {
            decl,
            copies: None,
            uncounted: decl.count.is_some(),
            is_unknown: false,
            first: 0,
            variables: Vec::new(),
            names,
        }
    }

    /// Whether it is an array, of however many copies.
    pub(super) fn is_array(&self) -> bool {
        self.decl.count.is_some()
    }

    /// The variables of a copy.
    fn of_copy(&self, copy: u32) -> Range<usize> {
        let (first, count) = (self.first as usize, self.variables.len());
        let start = first + copy as usize * count;
        start..start + count
    }

    fn variable(&self, copy: u32, place: usize) -> VariableId {
        VariableId(self.first + copy * self.variables.len() as u32 + place as u32)
    }

    /// The name of a variable, if it is one of real numbers of this process.
    fn real(&self, id: VariableId) -> Option<&'a str> {
        let at = id.0.checked_sub(self.first)? as usize;
        if at >= self.variables.len() * self.copies.unwrap_or(1) as usize {
            return None;
        }
        let place = at % self.variables.len();
        let is_it = |inside: &Inside| matches!(inside, Inside::Variable(k) if *k == place);
        let (name, _) = self.names.iter().find(|(_, inside)| is_it(inside))?;
        (self.variables[place].1 == Domain::Real).then_some(*name)
    }
}

impl Elaborator<'_> {
    /// Whether some command of the file has a rate or a delay.
    pub(super) fn has_timing(file: &ScenarioFile) -> bool {
        file.items.iter().any(|item| match item {
            Item::Process(decl) => decl
                .items
                .iter()
                .any(|item| matches!(item, ProcessItem::Command(command) if command.timing.is_some())),
            _ => false,
        })
    }

    /// Settles the variables of all processes.
    pub(super) fn settle_variables(&mut self) -> Vec<Variable> {
        let mut variables = Vec::new();
        for at in 0..self.processes.len() {
            self.settle(at, &mut variables);
        }
        variables
    }

    fn settle(&mut self, at: usize, variables: &mut Vec<Variable>) {
        let decl = self.processes[at].decl;
        let locals = Locals { settling: Some(at as u32), ..Locals::of(0) };
        if let Some(count) = &decl.count {
            let number = self.number_of(count, Dimension::NONE, &locals);
            let whole = number.map(Number::as_whole);
            self.processes[at].uncounted = !matches!(whole, Ok(Some(1..=MOST_COPIES)));
            self.processes[at].copies = Some(match whole {
                Ok(Some(n @ 1..=MOST_COPIES)) => n as u32,
                Err(Reported) => 1,
                Ok(_) => {
                    self.note(error!(
                        E0402,
                        count.span, "the number of copies must be a whole number from 1 to {MOST_COPIES}"
                    ));
                    1
                }
            });
        }
        let mut spans: BTreeMap<&str, Span> = BTreeMap::new();
        let mut initials = Vec::new();
        for item in &decl.items {
            let declared = Inside::of(item, Inside::Variable(initials.len()));
            let Some((name, inside)) = declared else { continue };
            if let Some(first) = spans.insert(&name.name, name.span) {
                let error = error!(E0202, name.span, "`{}` is declared twice", name.name)
                    .related(first, "first declared here")
                    .hint("rename one of them");
                self.note(error);
                self.processes[at].is_unknown = true;
                if let ProcessItem::Var(var) = item {
                    let _ = self.variable(var, &locals);
                }
                continue;
            }
            if let ProcessItem::Var(var) = item {
                let Ok((dimension, domain, initial)) = self.variable(var, &locals) else {
                    self.processes[at].names.insert(&name.name, Inside::Lost);
                    self.processes[at].is_unknown = true;
                    continue;
                };
                // Whatever is wrong with the start, what the commands do with the variable can be checked.
                self.processes[at].is_unknown |= initial.is_err();
                self.processes[at].variables.push((dimension, domain));
                let start = initial.unwrap_or_else(|_| domain.values().map_or(0.0, |(least, _)| least));
                initials.push((var.name.name.as_str(), domain, start));
            }
            self.processes[at].names.insert(&name.name, inside);
        }
        self.processes[at].first = variables.len() as u32;
        for copy in 0..self.processes[at].copies.unwrap_or(1) {
            let owner = self.copy_name(at, copy);
            for (name, domain, initial) in &initials {
                self.origins.variables.push(spans.get(name).copied().unwrap_or(decl.name.span));
                variables.push(Variable {
                    name: format!("{owner}.{name}"),
                    domain: *domain,
                    initial: *initial,
                });
            }
        }
    }

    /// The values that a variable can have.
    pub(in crate::compile) fn domain(&self, variable: VariableId) -> Option<Domain> {
        self.processes.iter().find_map(|process| {
            let at = variable.0.checked_sub(process.first)? as usize;
            let count = process.variables.len();
            let is_own = at < count * process.copies.unwrap_or(1) as usize;
            is_own.then(|| process.variables[at % count].1)
        })
    }

    fn copy_name(&self, at: usize, copy: u32) -> String {
        let process = &self.processes[at];
        match process.copies {
            Some(_) => format!("{}[{}]", process.decl.name.name, copy + 1),
            None => process.decl.name.name.clone(),
        }
    }

    /// Dimension and domain of a variable, and its value at the start.
    fn variable(
        &mut self,
        var: &ast::VarDecl,
        locals: &Locals,
    ) -> Lowered<(Dimension, Domain, Lowered<f64>)> {
        let initial = self.lower(&var.initial, locals);
        let span = var.initial.span;
        let number = |this: &mut Self, typed: Typed| match typed {
            Typed::Number(number) if number.value.is_finite() => Ok(number),
            Typed::Num(..) => {
                this.report(error!(E0304, span, "the initial value must be known before a trial starts"))
            }
            found => this.mismatch(span, "a number", &found),
        };
        let truth = |this: &mut Self, typed: Typed| match typed {
            Typed::Truth(Bool::Constant(value), _) => Ok(f64::from(value)),
            Typed::Truth(..) => {
                this.report(error!(E0304, span, "the initial value must be known before a trial starts"))
            }
            found => this.mismatch(span, "`true` or `false`", &found),
        };
        match &var.domain {
            Some(Written::Range(low, high)) => {
                let low_end = self.whole(low, locals);
                let high_end = self.whole(high, locals);
                let (low_end, high_end) = (low_end?, high_end?);
                if low_end > high_end {
                    return self.report(error!(E0405, low.span.to(high.span), "the range is empty"));
                }
                let domain = Domain::Whole { low: low_end, high: high_end };
                let initial = initial
                    .and_then(|initial| number(self, initial))
                    .and_then(|number| self.initial(var, number, domain));
                Ok((Dimension::NONE, domain, initial))
            }
            Some(Written::Named(name)) => match name.name.as_str() {
                "bool" => {
                    let initial = initial.and_then(|initial| truth(self, initial));
                    Ok((Dimension::NONE, Domain::Truth, initial))
                }
                "real" => {
                    let initial = initial?;
                    let number = number(self, initial)?;
                    Ok((number.dimension, Domain::Real, Ok(number.value)))
                }
                "int" => {
                    let error = error!(E0405, name.span, "an integer variable needs a range";
                            hint: "write `var {}: 0 .. 10 = …`", var.name.name);
                    self.report(error)
                }
                _ => {
                    let known = ["bool", "real"].into_iter();
                    let error = unknown("type of variable", &name.name, name.span, Code::E0207, known);
                    self.report(error.hint("the types are `lo .. hi`, `bool` and `real`"))
                }
            },
            None => match initial? {
                typed @ Typed::Truth(..) => Ok((Dimension::NONE, Domain::Truth, Ok(truth(self, typed)?))),
                typed => {
                    let number = number(self, typed)?;
                    Ok((number.dimension, Domain::Real, Ok(number.value)))
                }
            },
        }
    }

    /// The value at the start of a variable with a range.
    fn initial(&mut self, var: &ast::VarDecl, number: Number, domain: Domain) -> Lowered<f64> {
        let span = var.initial.span;
        if !number.dimension.is_none() {
            return self.wrong_dimension(span, Dimension::NONE, number.dimension);
        }
        match domain {
            Domain::Whole { low, high } if !domain.contains(number.value) => self.report(error!(
                E0903,
                span, "`{}` must be a whole number from {low} to {high}", var.name.name
            )),
            _ => Ok(domain.kept(number.value)),
        }
    }

    fn whole(&mut self, expr: &Expr, locals: &Locals) -> Lowered<i64> {
        let number = self.number_of(expr, Dimension::NONE, locals)?;
        match number.as_whole() {
            Some(whole) if whole.abs() < LARGEST => Ok(whole),
            _ if number.value.fract() == 0.0 => {
                let said = format!("`{}` is too large for an end of a range", self.text(expr.span));
                let error = error!(E0405, expr.span, "{said}")
                    .label(format!("the limit is ±{}", LARGEST - 1))
                    .hint("for a number of any size write `real` instead of a range");
                self.report(error)
            }
            _ => self.report(error!(E0405, expr.span, "the ends of a range must be whole numbers")),
        }
    }

    /// Lowers the commands of all processes.
    pub(super) fn settle_commands(&mut self, variables: Vec<Variable>, people: &mut People) -> Processes {
        let mut out = Processes { variables, list: Vec::new() };
        let mut writings = Vec::new();
        for at in 0..self.processes.len() {
            let decl = self.processes[at].decl;
            let copies = self.processes[at].copies.unwrap_or(1);
            let Ok(first) = self.entities(people, &decl.name.name, copies, decl.name.span) else { break };
            self.check_names(at);
            let choose = decl.items.iter().any(|item| matches!(item, ProcessItem::Choose(_)));
            let process = &self.processes[at];
            let mut is_sound = !process.uncounted && !process.is_unknown && !self.is_torn_within(decl.span);
            for copy in 0..copies {
                let locals = Locals { process: Some((at as u32, copy)), ..Locals::of(0) };
                let mut commands = Vec::new();
                let mut lines = Vec::new();
                let mut broken = Vec::new();
                for item in &decl.items {
                    let ProcessItem::Command(command) = item else { continue };
                    match self.command(at, copy, command, &locals) {
                        Ok(lowered) => {
                            commands.push(lowered);
                            lines.push(Lines::of(command));
                        }
                        Err(guard) => broken.push((guard, command)),
                    }
                }
                is_sound &= self.one_kind(decl, &commands);
                let is_whole = is_sound && broken.is_empty();
                for (guard, command) in broken {
                    // Who knows when one is enabled knows when what follows is not known.
                    let Ok(guard) = guard else {
                        is_sound = false;
                        continue;
                    };
                    let timing =
                        if self.clock.is_jumps() { Timing::Rate(Num::Constant(0.0)) } else { Timing::Step };
                    commands.push(Command { guard, timing, branches: Vec::new() });
                    lines.push(Lines::broken(command));
                }
                let name = self.copy_name(at, copy);
                out.list.push(Process { name, entity: first + copy, commands, choose });
                let variables = self.processes[at].of_copy(copy);
                writings.push(Writing { lines, variables, is_sound });
                if !is_whole {
                    // What is wrong with one copy is wrong with the others.
                    break;
                }
            }
        }
        self.check_reachable(&out, &writings);
        let of_commands =
            |writing: Writing| writing.lines.into_iter().map(|line| line.command).collect::<Vec<_>>();
        self.origins.commands = writings.into_iter().map(of_commands).collect();
        out
    }

    /// Whether part of a declaration was not read.
    fn is_torn_within(&self, declaration: Span) -> bool {
        let meets = |torn: &Span| {
            torn.source == declaration.source && torn.start < declaration.end && declaration.start < torn.end
        };
        self.torn.iter().any(meets)
    }

    /// Checks unused names too.
    fn check_names(&mut self, at: usize) {
        let locals = Locals { process: Some((at as u32, 0)), ..Locals::of(0) };
        for item in &self.processes[at].decl.items {
            match item {
                ProcessItem::Let(decl) => self.look_into(decl, &locals),
                ProcessItem::Label { value, .. } => {
                    if let Ok(typed) = self.lower(value, &locals) {
                        let _ = self.as_truth(typed, value.span);
                    }
                }
                ProcessItem::Var(_) | ProcessItem::Command(_) | ProcessItem::Choose(_) => {}
            }
        }
    }
}

/// Truth values of variables are 0 and 1.
pub(super) fn as_number(truth: Bool) -> Num {
    match truth {
        Bool::Constant(value) => Num::Constant(f64::from(value)),
        truth => Num::If(Box::new(truth), Box::new(Num::Constant(1.0)), Box::new(Num::Constant(0.0))),
    }
}
