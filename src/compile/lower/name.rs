//! Names and members of sets.

use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::failures::Vain;
use super::super::process::Declared;
use super::super::symbols::{Meaning, ScopeId, unknown};
use super::super::typed::Typed;
use super::super::weight::Weight;
use super::super::wording::{Frame, Given, Use};
use super::{BUILT_IN, counted_arguments};
use crate::model::{Set, Who};
use crate::syntax::ast::{Expr, ExprKind, Ident, LetDecl};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Label};
use crate::syntax::source::Span;
use std::sync::Arc;

use super::super::dimension::Dimension;

/// The depth to which calls with unknown arguments are followed.
const FOLLOWED: u32 = 400;
/// Most calls that are shown of an error inside functions that call each other.
const MOST_CALLS: usize = 4;

impl<'a> Elaborator<'a> {
    /// Finds a name: in the file's own table, then in the scenario's.
    pub(in crate::compile) fn find(&self, name: &str, scope: ScopeId) -> Option<(ScopeId, Meaning<'a>)> {
        let own =
            self.scopes.get(scope).and_then(|table| table.get(name)).map(|e| (scope, e.meaning.clone()));
        let found = own.or_else(|| self.scopes[0].get(name).map(|e| (0, e.meaning.clone())));
        found.map(|(scope, meaning)| {
            (scope, if self.is_doubtful(scope, name) { Meaning::Doubtful } else { meaning })
        })
    }

    pub(super) fn lower_name(&mut self, name: &str, span: Span, locals: &Locals) -> Lowered<Typed> {
        if let Some(at) = locals.names.iter().rposition(|(bound, _)| bound == name) {
            let typed = locals.names[at].1.as_ref().ok_or(Reported)?;
            if let Some((_, meant)) = locals.written.iter().find(|(argument, _)| *argument == at) {
                self.aliases.insert(span, *meant);
            }
            if self.temporal {
                self.uses.at.insert(span, Use::Given(at as u32));
            }
            self.count_copy(Weight::of(typed), span)?;
            return Ok((**typed).clone());
        }
        if let Some(process) = locals.process
            && let Some(inside) = self.lower_inside(process, name, span)
        {
            self.note_inside(span);
            return inside;
        }
        if let Some(inside) = self.lower_inside_behaviour(name, span, locals) {
            return inside;
        }
        let Some((scope, meaning)) = self.find(name, locals.scope) else {
            return match name {
                "time" if self.clock.is_jumps() => {
                    let error = error!(E0508, span, "`time` is not available in continuous time";
                            hint: "use a bound such as `F[4 s, 5 s]`, or `time_until(…)`");
                    self.report(error)
                }
                "time" => Ok(Typed::Num(crate::model::Num::Time, self.time_dimension())),
                "everyone" => {
                    Ok(Typed::Agents { set: Set { members: self.everyone(), except: None }, particle: false })
                }
                "pi" => Ok(Typed::Number(super::Number::rounded(std::f64::consts::PI, Dimension::NONE))),
                _ => match self.lower_settling(name, span, locals) {
                    Some(lowered) => lowered,
                    None => self.unknown_name(name, span, locals),
                },
            };
        };
        if let Meaning::Constant(value) | Meaning::Param { value, .. } = &meaning
            && matches!(&value.kind, ExprKind::Quantity(quantity) if quantity.unit.is_none())
            // A declaration that is looked at by its name is no use of it.
            && value.span != span
        {
            self.bare.insert(span, value.span);
        }
        match meaning {
            Meaning::Constant(value) => self.constant(scope, name, span, |this| {
                let lowered = this.timeless(value, &Locals::of(scope));
                this.unchanging(lowered, value)
            }),
            Meaning::Param { value, .. } => {
                if let Some(set) = self.settings.get(name) {
                    return Ok(Typed::Number(*set));
                }
                self.constant(scope, name, span, |this| {
                    this.number(value, &Locals::of(scope)).map(Typed::Number)
                })
            }
            Meaning::Let(decl) => {
                if !decl.arguments.is_empty() {
                    return self.report(error!(E0204, span, "`{name}` is a function of {}", counted_arguments(decl.arguments.len());
                        hint: "call it: `{name}(…)`"));
                }
                let inner = Locals { running: locals.running, ..Locals::of(scope) };
                self.expand_once(scope, name, span, |this| this.lower(&decl.body, &inner))
            }
            Meaning::Property(_) if !self.temporal => {
                let text = format!("a number is needed here, but `{name}` is a property");
                self.report(error!(E0305, span, "{text}"))
            }
            Meaning::Property(formula) => {
                let inner = Locals { running: locals.running, ..Locals::of(scope) };
                self.expand_once(scope, name, span, |this| match this.lower(formula, &inner)? {
                    typed @ (Typed::Truth(..) | Typed::Formula(_)) => Ok(typed),
                    // Said where it is declared, however often it is used.
                    found => this.mismatch(formula.span, "a condition", &found),
                })
            }
            Meaning::Region(id, _) => Ok(Typed::Region(id)),
            Meaning::Barrier(id) => Ok(Typed::Barrier(id)),
            Meaning::Line(id) => Ok(Typed::Line(id)),
            Meaning::Point(at) => self.constant(scope, name, span, |this| this.lower(at, &Locals::of(scope))),
            Meaning::Process(process) => {
                let is_array = self.processes.get(process as usize).is_some_and(Declared::is_array);
                Ok(if is_array { Typed::Processes(process) } else { Typed::Process { process, copy: 0 } })
            }
            Meaning::Agent(id) => Ok(Typed::Agent(Who::Agent(id))),
            Meaning::Agents { members, particle } => {
                Ok(Typed::Agents { set: Set { members, except: None }, particle })
            }
            Meaning::Doubtful => {
                self.unknowns += 1;
                Err(Reported)
            }
            Meaning::Declared => self.report(
                error!(E0205, span, "`{name}` is not available here";
                    hint: "numbers of agents and parameters cannot depend on agents")
                .about(About::Unsettled),
            ),
            Meaning::Kind(_) | Meaning::Tracks(_) | Meaning::Behaviour(_) => {
                self.report(error!(E0206, span, "`{name}` is {} and has no value", meaning.noun()))
            }
        }
    }

    fn unknown_name(&mut self, name: &str, span: Span, locals: &Locals) -> Lowered<Typed> {
        self.unknowns += 1;
        if self.is_said(Code::E0201, span) || self.is_said(Code::E0113, span) {
            return Err(Reported);
        }
        let mut known: Vec<String> = Vec::new();
        if self.looks_for_names() {
            known.extend(locals.names.iter().map(|(n, _)| n.clone()));
            known.extend(self.names_inside(locals));
            for scope in [locals.scope, 0] {
                known.extend(self.scopes.get(scope).into_iter().flat_map(|s| s.names().map(str::to_owned)));
            }
            known.extend(BUILT_IN.map(str::to_owned));
        }
        let error = unknown("name", name, span, Code::E0201, known.iter().map(String::as_str));
        self.report(match self.misread_name(name) {
            Some(hint) => error.hint(hint),
            None => error,
        })
    }

    /// Dimension of the clock: seconds, or steps where steps have no length.
    pub(in crate::compile) fn time_dimension(&self) -> Dimension {
        match self.clock {
            crate::base::tick::Clock::Steps => Dimension::STEPS,
            _ => Dimension::TIME,
        }
    }

    /// The value of a constant, computed once.
    fn constant(
        &mut self,
        scope: ScopeId,
        name: &str,
        span: Span,
        compute: impl FnOnce(&mut Self) -> Lowered<Typed>,
    ) -> Lowered<Typed> {
        let key = (scope, name.to_owned());
        // A condition has a margin at each place where it is asked for.
        let asks = self.margins.is_some();
        let has_margin = |known: &Lowered<Typed>| asks && matches!(known, Ok(Typed::Truth(..)));
        if let Some(known) = self.constants.get(&key).filter(|known| !has_margin(known)) {
            let weight = known.as_ref().map(Weight::of).map_err(|reported| *reported)?;
            self.count_copy(weight, span)?;
            return self.constants.get(&key).cloned().unwrap_or(Err(Reported));
        }
        let value = self.expand(scope, name, span, compute);
        if value.is_err() {
            self.journal.push((Vain::Constant, key.clone()));
        }
        // Who is among people is not settled before all are.
        if !matches!(value, Ok(Typed::Agents { .. })) && !has_margin(&value) {
            self.constants.insert(key, value.clone());
        }
        value
    }

    /// An expression in which, whoever asks, operators over time are known: what is wrong with them is said of a whole.
    pub(in crate::compile) fn timeless(&mut self, value: &Expr, locals: &Locals) -> Lowered<Typed> {
        let temporal = std::mem::replace(&mut self.temporal, locals.scope > 0);
        let lowered = self.lower(value, locals);
        self.temporal = temporal;
        lowered
    }

    /// The value of a constant, if it is the same in all states of all trials.
    pub(in crate::compile) fn unchanging(&mut self, lowered: Lowered<Typed>, value: &Expr) -> Lowered<Typed> {
        let found = lowered?;
        let (is_fixed, is_drawn) = match &found {
            Typed::Num(num, _) => (num.is_fixed(), num.is_drawn()),
            Typed::Vector(x, y, _) => (x.is_fixed() && y.is_fixed(), x.is_drawn() && y.is_drawn()),
            Typed::Truth(truth, _) => (truth.is_fixed(), truth.is_drawn()),
            Typed::Term(..) | Typed::Formula(_) | Typed::Tally(_) => (false, false),
            _ => (true, true),
        };
        if is_fixed {
            return Ok(found);
        }
        let label = match found {
            _ if is_drawn => format!("{} that is drawn in each trial", found.noun()),
            Typed::Truth(..) => "a condition that changes during a trial".to_owned(),
            _ => format!("{} that changes during a trial", found.noun()),
        };
        let error = error!(E0304, value.span, "the value must be known before a trial starts");
        self.report(error.label(label).hint(if is_drawn {
            "name a value that is drawn in each trial with `let`"
        } else {
            "name a value that changes during a trial with `let`"
        }))
    }

    /// Computes what a name stands for; an error where that needs the name itself.
    pub(in crate::compile) fn expand(
        &mut self,
        scope: ScopeId,
        name: &str,
        span: Span,
        compute: impl FnOnce(&mut Self) -> Lowered<Typed>,
    ) -> Lowered<Typed> {
        if self.broken.contains(&(scope, name.to_owned())) {
            self.unknowns += 1;
            return Err(Reported);
        }
        if self.expanding.iter().any(|(s, n)| *s == scope && n == name) {
            if self.circles.iter().any(|n| n == name) {
                return Err(Reported);
            }
            let way: Vec<&str> = self
                .expanding
                .iter()
                .map(|(_, n)| n.as_str())
                .skip_while(|n| *n != name)
                .chain([name])
                .collect();
            self.circles.extend(way.iter().map(|n| (*n).to_owned()));
            let error = error!(E0205, span, "`{name}` depends on itself").label(way.join(" → "));
            let error = error.about(About::Circle);
            return self.report(error);
        }
        self.expanding.push((scope, name.to_owned()));
        let value = compute(self);
        self.expanding.pop();
        value
    }

    /// As `expand`, for what means the same at each use: what failed once is not looked at again.
    fn expand_once(
        &mut self,
        scope: ScopeId,
        name: &str,
        span: Span,
        compute: impl FnOnce(&mut Self) -> Lowered<Typed>,
    ) -> Lowered<Typed> {
        let value = self.expand(scope, name, span, compute);
        if value.is_err() {
            self.give_up(scope, name.to_owned());
        }
        value
    }

    /// A call of a function declared with `let`.
    pub(super) fn lower_let(
        &mut self,
        (scope, decl): (ScopeId, &LetDecl),
        span: Span,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        let mut inner = Locals { running: locals.running, ..Locals::of(scope) };
        if self.function_inside(&decl.name.name, locals).is_some() {
            inner.process = locals.process;
        }
        let name = &decl.name.name;
        let path =
            inner.process.and_then(|(at, _)| self.inside_path(at, name)).unwrap_or_else(|| name.clone());
        self.lower_function(decl, (inner, path), span, arguments, locals)
    }

    /// A call of a function that sees some names and is known by its path.
    pub(in crate::compile) fn lower_function(
        &mut self,
        decl: &LetDecl,
        (mut inner, path): (Locals, String),
        span: Span,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        if arguments.len() != decl.arguments.len() {
            let wanted = counted_arguments(decl.arguments.len());
            return self.arity(&decl.name, span, &wanted, (arguments, locals));
        }
        let Ok(values) = self.lower_all(arguments, locals) else {
            self.follow(decl, (inner, path), span);
            return Err(Reported);
        };
        for ((name, value), argument) in decl.arguments.iter().zip(values).zip(arguments) {
            inner.written.push((inner.names.len(), argument.span));
            inner.bind(&name.name, value);
        }
        if self.temporal {
            let process = inner.process.and_then(|process| self.label(process));
            let written = |(at, span): &(usize, Span)| (*at as u32, Given::Written(*span));
            let given = inner.written.iter().map(written).collect();
            inner.frame = Some(Arc::new(Frame { caller: locals.frame.clone(), given, process }));
        }
        let (before, unknowns) = (self.diagnostics.len(), self.unknowns);
        let value = self.expand(inner.scope, &path, span, |this| this.lower(&decl.body, &inner));
        if value.is_err() {
            // With an unknown name in it nothing comes of any other call.
            if self.unknowns > unknowns {
                self.give_up(inner.scope, path);
            }
            if !inner.names.is_empty() {
                self.called(before, decl, span, &inner);
            }
        }
        value
    }

    /// Reports the errors of a function that no argument can correct, even if it is never called.
    pub(in crate::compile) fn look_into(&mut self, decl: &LetDecl, locals: &Locals) {
        let mut inner = locals.clone();
        for argument in &decl.arguments {
            inner.bind_unknown(&argument.name);
        }
        self.check_arguments(&decl.arguments);
        let around = std::mem::replace(&mut self.looking, true);
        let _ = self.lower(&decl.body, &inner);
        self.looking = around;
    }

    /// Follows a call with unknown arguments, each function once, because it may be recursive.
    fn follow(&mut self, decl: &LetDecl, (mut inner, path): (Locals, String), span: Span) {
        // Functions through hundreds of others are too deep only if somebody calls them.
        if !self.looking || self.depth > FOLLOWED {
            return;
        }
        let key = (inner.scope, path.clone());
        let _ = self.expand(inner.scope, &path, span, |this| {
            if !this.followed.insert(key.clone()) {
                return Err(Reported);
            }
            this.journal.push((Vain::Call, key));
            for argument in &decl.arguments {
                inner.bind_unknown(&argument.name);
            }
            this.lower(&decl.body, &inner)
        });
    }

    /// That no two arguments of a function or behaviour have one name.
    pub(in crate::compile) fn check_arguments(&mut self, arguments: &[Ident]) {
        for (k, argument) in arguments.iter().enumerate() {
            if let Some(first) = arguments[..k].iter().find(|first| first.name == argument.name) {
                let text = format!("the argument `{}` is declared twice", argument.name);
                let error = error!(E0202, argument.span, "{text}");
                self.note(error.related(first.span, "first declared here").hint("rename one of them"));
            }
        }
    }

    /// Adds to the errors inside a function, which were found since `before`, where and with what it was called.
    fn called(&mut self, before: usize, decl: &LetDecl, span: Span, inner: &Locals) {
        let with: Vec<String> = inner
            .names
            .iter()
            .filter(|(name, _)| decl.arguments.iter().any(|argument| argument.name == *name))
            .filter_map(|(name, value)| Some(format!("`{name}` is {}", value.as_ref()?.noun())))
            .collect();
        let body = decl.body.span;
        let inside =
            |place: Span| place.source == body.source && place.start >= body.start && place.end <= body.end;
        for diagnostic in &mut self.diagnostics[before..] {
            // Names that are unknown, or lead in circles, are so with any arguments.
            if diagnostic.code.is_of("E02") {
                continue;
            }
            let from = diagnostic.related.last().or(diagnostic.place.as_ref());
            if from.is_some_and(|label| inside(label.span)) && diagnostic.related.len() < MOST_CALLS {
                diagnostic.related.push(Label { span, text: format!("in this call, {}", with.join(", ")) });
            }
        }
    }

    /// `crowd[3]`; members count from 1.
    pub(super) fn lower_index(&mut self, base: &Expr, index: &Expr, locals: &Locals) -> Lowered<Typed> {
        let lowered = self.lower(base, locals);
        if lowered.is_err() {
            let _ = self.number(index, locals);
        }
        let set = match lowered? {
            Typed::Agents { set, particle: false } => set,
            Typed::Processes(process) => return self.lower_copy(process, base, index, locals),
            Typed::Agents { particle: true, .. } => {
                return self.report(
                    error!(E0206, base.span, "a group `as particle` is one body and has no members";
                    hint: "remove `as particle` to simulate the members"),
                );
            }
            found => return self.mismatch(base.span, "a set of agents", &found),
        };
        // The number of agents whose declaration failed is unknown.
        if let [only] = set.members[..]
            && self.undeclared.contains(&only)
        {
            let _ = self.number_of(index, Dimension::NONE, locals);
            return Ok(Typed::Agent(Who::Agent(only)));
        }
        let left_out = match set.except {
            None => None,
            Some(Who::Agent(id)) => Some(id),
            Some(Who::Running(_)) => {
                return self.report(error!(E0304, base.span, "the members of this set differ for each value of the quantifier";
                    hint: "choose a member of a fixed set such as `crowd[1]`, or quantify over this set"));
            }
        };
        let members: Vec<_> = set.members.iter().filter(|id| Some(**id) != left_out).copied().collect();
        let place = self.member(base, index, members.len(), locals)?;
        Ok(Typed::Agent(Who::Agent(members[place])))
    }

    /// One copy of an array of processes.
    fn lower_copy(&mut self, process: u32, base: &Expr, index: &Expr, locals: &Locals) -> Lowered<Typed> {
        if self.processes.get(process as usize).is_some_and(|process| process.uncounted) {
            let _ = self.number(index, locals);
            return Ok(Typed::Process { process, copy: 0 });
        }
        let count = self.copies(process).count();
        let copy = self.member(base, index, count, locals)? as u32;
        Ok(Typed::Process { process, copy })
    }

    /// The place, from 0, of a member counted from 1.
    fn member(&mut self, base: &Expr, index: &Expr, count: usize, locals: &Locals) -> Lowered<usize> {
        let number = self.number_of(index, Dimension::NONE, locals)?;
        let member = number.as_whole().and_then(|n| usize::try_from(n).ok());
        match member {
            Some(n) if (1..=count).contains(&n) => Ok(n - 1),
            _ => {
                let error =
                    error!(E0212, index.span, "`{1}` has no member {0}", number.value, self.text(base.span))
                        .hint(match count {
                            0 => "the set is empty".to_owned(),
                            1 => "the only member is `[1]`".to_owned(),
                            count => {
                                let name = self.text(base.span);
                                format!("the members are `{name}[1]` to `{name}[{count}]`")
                            }
                        });
                self.report(error)
            }
        }
    }
}
