//! A scenario under one combination of parameter values.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::files::Files;
use super::lower::{BUILT_IN, OPERATORS};
use super::moments;
use super::number::Number;
use super::people::People;
use super::process::Declared;
use super::symbols::Meaning;
use super::told::{self, Told};
use crate::base::decimal::Decimal;
use crate::base::tick::{Clock, Tick};
use crate::model::{BehaviourId, BuiltIn, Kind, Scenario};
use crate::syntax::ast::{Expr, ExprKind, Ident, Item, PropertyFile, PropertyItem, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic};
use crate::syntax::source::{Source, Span};
use std::collections::BTreeMap;

/// Most ticks of a trial.
const MOST_TICKS: u64 = 1 << 32;

impl<'a> Elaborator<'a> {
    /// Elaborates a scenario with some parameters set, and declares the names of property files.
    pub(super) fn elaborate(
        sources: &'a [Source],
        scenario: &'a ScenarioFile,
        properties: &'a [PropertyFile],
        files: &Files,
        settings: BTreeMap<String, Number>,
        measured: &[Decimal],
    ) -> (Self, Option<Scenario>) {
        let mut this = Self::new(sources, settings);
        this.measured = measured.to_vec();
        this.declare(scenario);
        this.declare_properties(properties);
        let broken = scenario.broken.iter().chain(properties.iter().flat_map(|file| &file.broken));
        this.torn = broken.map(|item| item.span).collect();
        this.unread = this.torn.iter().map(|head| (head.source, head.end)).collect();
        this.doubt_defaults(scenario);
        this.warn_of_meanings();
        let built = this.build(scenario, files).ok();
        (this, built)
    }

    fn declare(&mut self, file: &'a ScenarioFile) {
        for item in &file.items {
            let (name, meaning) = match item {
                Item::Const { name, value } => (name, Meaning::Constant(value)),
                Item::Param { name, value, range } => (name, Meaning::Param { value, range: range.as_ref() }),
                Item::Let(decl) => (&decl.name, Meaning::Let(decl)),
                Item::Kind(decl) => (&decl.name, Meaning::Kind(decl)),
                Item::Agents(decl) => (&decl.name, Meaning::Declared),
                Item::Group(decl) => (&decl.name, Meaning::Declared),
                Item::Scene(items) => {
                    self.declare_scene(items);
                    continue;
                }
                Item::Title(_)
                | Item::Setting { .. }
                | Item::Tracks { .. }
                | Item::Moves(_)
                | Item::Paths(_) => continue,
                Item::Process(decl) => {
                    self.processes.push(Declared::new(decl));
                    (&decl.name, Meaning::Process(self.processes.len() as u32 - 1))
                }
                Item::Behaviour(decl) => {
                    let id = BehaviourId(self.behaviours.len() as u32);
                    self.declare_behaviour(decl);
                    (&decl.name, Meaning::Behaviour(id))
                }
                Item::Source(decl) => (&decl.name, Meaning::Declared),
            };
            let reserved = match (&meaning, name.name.as_str()) {
                (Meaning::Kind(_), name) => Kind::named(name)
                    .map(|kind| format!("`{}` is the name of {}", kind.name(), kind.meaning())),
                (_, "self") => Some("`self` is the agent that has a behaviour".to_owned()),
                _ => None,
            };
            if let Some(text) = reserved {
                self.note(error!(E0202, name.span, "{text}"; hint: "choose another name"));
            }
            self.enter(name, meaning);
        }
    }

    fn declare_properties(&mut self, files: &'a [PropertyFile]) {
        for file in files {
            let mut scope = super::symbols::Scope::default();
            for item in &file.items {
                let (name, meaning) = match item {
                    PropertyItem::Let(decl) => (&decl.name, Meaning::Let(decl)),
                    PropertyItem::Const { name, value } => (name, Meaning::Constant(value)),
                    PropertyItem::Property { name, formula } => (name, Meaning::Property(formula)),
                    PropertyItem::Family { .. } | PropertyItem::Query(_) => continue,
                };
                if let Some(first) = self.scopes[0].get(&name.name) {
                    let error = error!(E0202, name.span, "`{}` is already a name of the scenario", name.name)
                        .related(first.span, "declared here");
                    self.note(error);
                    // Its meaning in this file is uncertain, so its uses cause no further errors.
                    self.broken.insert((self.scopes.len(), name.name.clone()));
                    self.doubt(self.scopes.len(), &name.name);
                    let _ = scope.declare(&name.name, name.span, meaning);
                } else if let Err(error) = scope.declare(&name.name, name.span, meaning) {
                    self.note(error);
                    self.doubt(self.scopes.len(), &name.name);
                }
            }
            self.scopes.push(scope);
        }
    }

    /// Warns of names that mean something else, too.
    fn warn_of_meanings(&mut self) {
        let mut found = Vec::new();
        for (number, scope) in self.scopes.iter().enumerate() {
            for (name, entry) in scope.entries() {
                let calls = matches!(&entry.meaning, Meaning::Let(decl) if !decl.arguments.is_empty());
                let hint = if BUILT_IN.contains(&name) || calls && BuiltIn::find(name).is_some() {
                    "it hides the built-in meaning; choose another name"
                } else if number == 0 && OPERATORS.contains(&name) {
                    "it is an operator in property files, so formulas there cannot use it; choose another name"
                } else {
                    continue;
                };
                let text = format!("the name `{name}` has another meaning");
                found.push(Diagnostic::warning(Code::W0201, entry.span, text).hint(hint));
            }
        }
        for warning in found {
            self.note(warning);
        }
    }

    fn build(&mut self, file: &'a ScenarioFile, files: &Files) -> Lowered<Scenario> {
        let mut told = if told::is_stepped(file) { Told::Stepped } else { Told::Nothing };
        let clock = self.settle_clock(file, &mut told);
        self.told = if told == Told::Nothing && clock.is_ok() { Told::Whole } else { told };
        let variables = self.settle_variables();
        self.settle_periods(file);
        for item in &file.items {
            if let Item::Tracks { name, file, body } = item {
                let hint = "declare the agents one by one";
                if self.refuse_if_periodic(name.span, "recordings", hint).is_err() {
                    self.enter(name, Meaning::Doubtful);
                    continue;
                }
                self.tracks(name, file.as_ref(), body, files);
            }
        }
        self.grouping = files.grouping;
        self.settle_gaits(file, files);
        let (mut barrier, mut line) = (0, 0);
        for item in &file.items {
            if let Item::Scene(items) = item {
                self.settle_scene(items, files, (&mut barrier, &mut line));
            }
        }
        let mut people = People::default();
        for item in &file.items {
            match item {
                Item::Agents(decl) => self.agents(decl, &mut people),
                Item::Group(decl) => self.group(decl, &mut people),
                _ => {}
            }
        }
        self.leave_by_moves(file);
        let mut sources = self.never_arriving(&people);
        for item in &file.items {
            if let Item::Source(decl) = item {
                sources.extend(self.source(decl, &mut people));
            }
        }
        let count = variables.len();
        let processes = self.settle_commands(variables, &mut people);
        let behaviours = self.settle_behaviours(&mut people, count);
        let moves = self.all_moves(file, &people);
        self.check_unused(file);
        self.check_titles(file);
        self.check_places(&mut people);
        if clock.is_err() || self.failed() {
            self.keep_starts(people, sources);
            return Err(Reported);
        }
        self.check_step(file, &people.agents);
        let title = file
            .items
            .iter()
            .find_map(|item| if let Item::Title(text) = item { Some(text.value.clone()) } else { None });
        self.places = people.places;
        Ok(Scenario {
            title: title.unwrap_or_default(),
            clock: self.clock,
            horizon: self.horizon,
            scene: self.scene.clone(),
            agents: people.agents,
            groups: people.groups,
            moves,
            processes,
            behaviours,
            sources,
        })
    }

    /// A scenario has one title.
    fn check_titles(&mut self, file: &ScenarioFile) {
        let titles = file.items.iter().filter_map(|item| match item {
            Item::Title(text) => Some(text.span),
            _ => None,
        });
        let titles: Vec<Span> = titles.collect();
        if let [first, others @ ..] = titles.as_slice() {
            for other in others {
                let error = error!(E0202, *other, "a scenario can have only one title");
                self.note(error.related(*first, "first title").hint("remove one of them"));
            }
        }
    }

    /// Checks unused declarations as well.
    fn check_unused(&mut self, file: &'a ScenarioFile) {
        let locals = Locals::of(0);
        for item in &file.items {
            match item {
                Item::Const { name, value } => {
                    let lowered = self.lower_declared(name, value);
                    let _ = self.unchanging(lowered, value);
                }
                Item::Param { name, value, range } => {
                    let declared = self.lower_declared(name, value);
                    if let Some(range) = range {
                        self.check_range(name, (declared, value), range);
                    }
                }
                Item::Kind(decl)
                    if self.scopes[0].get(&decl.name.name).is_some_and(|e| e.span == decl.name.span) =>
                {
                    let _ = self.kind(&decl.name);
                }
                Item::Kind(decl) => {
                    let _ = self.own_kind(decl);
                }
                Item::Let(decl) => {
                    self.temporal = true;
                    if decl.arguments.is_empty() {
                        let _ = self.lower_declared(&decl.name, &decl.body);
                    } else {
                        self.look_into(decl, &locals);
                    }
                    self.temporal = false;
                }
                _ => {}
            }
        }
    }

    /// The range of a parameter, and whether its default lies in it.
    fn check_range(
        &mut self,
        name: &Ident,
        (declared, value): (Lowered<super::typed::Typed>, &Expr),
        range: &(Expr, Expr),
    ) {
        let (locals, (low, high)) = (Locals::of(0), range);
        if self.fault_of_default(name, value, range).is_some() {
            return;
        }
        // What it is set to is judged where that is done.
        let default = declared.and_then(|_| self.number(value, &locals));
        let Ok(number) = default else {
            let _ = (self.number(low, &locals), self.number(high, &locals));
            return;
        };
        let place = low.span.to(high.span);
        // A default that something else takes the place of need not lie in its range where one of them follows from what
        // is set.
        let is_replaced = self.settings.contains_key(&name.name)
            && (self.hangs_on_parameters(place) || self.hangs_on_parameters(value.span));
        let ends =
            (self.number_of(low, number.dimension, &locals), self.number_of(high, number.dimension, &locals));
        let (Ok(low), Ok(high)) = ends else { return };
        if low.value > high.value {
            self.any_start = true;
            self.note(error!(E0405, place, "the range is empty"));
        } else if !is_replaced && (number.value < low.value || number.value > high.value) {
            let text = format!("the default of `{}` is outside its range", name.name);
            self.any_start = true;
            self.note(error!(E0405, value.span, "{text}").hanging_on(place));
        }
    }

    fn lower_declared(&mut self, name: &Ident, value: &Expr) -> Lowered<super::typed::Typed> {
        let is_taken = self.scopes[0].get(&name.name).is_some_and(|entry| entry.span != name.span);
        if is_taken || self.is_doubtful(0, &name.name) {
            // It stands for something else, or who knows.
            return self.lower(value, &Locals::of(0));
        }
        let expr = Expr { kind: ExprKind::Name(name.name.clone()), span: value.span };
        self.lower(&expr, &Locals::of(0))
    }

    /// Settles the clock, and notes how much of it is certain.
    fn settle_clock(&mut self, file: &'a ScenarioFile, told: &mut Told) -> Lowered<()> {
        let mut found: [Option<(&Expr, Span)>; 2] = [None, None];
        // What a slip of the pen was probably meant to set.
        let mut meant = [false; 2];
        let mut sure = [true; 2];
        let mut failed = false;
        for item in &file.items {
            let Item::Setting { name, value } = item else { continue };
            let slot = match name.name.as_str() {
                "horizon" => 0,
                "step" => 1,
                _ => {
                    let error = super::symbols::unknown(
                        "setting",
                        &name.name,
                        name.span,
                        Code::E0207,
                        ["horizon", "step"].into_iter(),
                    );
                    let near = super::nearest::nearest(&name.name, ["horizon", "step"].into_iter());
                    meant = [meant[0] || near == Some("horizon"), meant[1] || near == Some("step")];
                    let general =
                        "the settings of a scenario are `horizon` and `step`; a constant begins with `const`";
                    let hint = match &error.hint {
                        Some(near) => format!("{near} {general}"),
                        None => general.to_owned(),
                    };
                    self.note(error.hint(hint));
                    failed = true;
                    continue;
                }
            };
            if let Some((_, first)) = found[slot] {
                let error =
                    error!(E0202, name.span, "`{}` is set twice", name.name).related(first, "first set here");
                self.note(error);
                failed = true;
            }
            sure[slot] &= found[slot].is_none();
            found[slot] = Some((value, name.span));
            self.clock_at.push(value.span);
        }
        if file.items.is_empty() {
            return Err(Reported);
        }
        let [horizon, step] = found;
        let title = file.items.iter().find_map(|item| match item {
            Item::Title(text) => Some(text.span),
            _ => None,
        });
        let start = self.sources.first().map(|source| Span::new(source.id, 0, 0));
        let place = title.or(start).unwrap_or_default();
        let mut missing = Vec::new();
        // Processes alone need no step: they have their own, or rates.
        let free = step.is_none() && !self.processes.is_empty() && !told::has_bodies(file);
        if !free {
            // Should the step or the horizon be wrong: bounds in seconds still make sense.
            self.clock = Clock::Stepped(Decimal::ONE);
        }
        if step.is_none() && !free && !meant[1] {
            missing.push(("step", "0.02 s"));
        }
        if horizon.is_none() && !meant[0] {
            missing.push(("horizon", "30 s"));
        }
        if !missing.is_empty() {
            let names: Vec<&str> = missing.iter().map(|(name, _)| *name).collect();
            let lines: Vec<String> =
                missing.iter().map(|(name, value)| format!("`{name} = {value}`")).collect();
            self.note(
                error!(E0505, place, "the scenario has no {}", names.join(" and no ");
                hint: "write {}", lines.join(" and "))
                .about(About::Clock),
            );
            failed = true;
        }
        if free {
            self.clock = Clock::Steps;
            let Some((horizon, _)) = horizon else { return Err(Reported) };
            if Self::has_timing(file) {
                return self.settle_continuous(horizon, failed);
            }
            return self.settle_horizon(horizon, failed);
        }
        let Some((step, _)) = step else {
            // What is wrong with the one that is there is said too.
            let _ = horizon.map(|(horizon, _)| self.number_of(horizon, Dimension::TIME, &Locals::of(0)));
            return Err(Reported);
        };
        let length = self.number_of(step, Dimension::TIME, &Locals::of(0));
        let sure_step = sure[1] && !meant[1];
        if (length.is_err() || !sure_step)
            && let Some((horizon, _)) = horizon
            && !self.text(horizon.span).contains("step")
        {
            // What is wrong with the horizon is said too.
            let _ = self.number_of(horizon, Dimension::TIME, &Locals::of(0));
        }
        let Some(exact) = length?.exact.filter(|e| !e.is_zero() && !e.is_negative()) else {
            return self.report(error!(E0505, step.span, "the step must be a positive time"));
        };
        self.clock = Clock::Stepped(exact);
        if !sure_step {
            return Err(Reported);
        }
        *told = Told::Step;
        let Some((horizon, _)) = horizon else { return Err(Reported) };
        let settled = self.settle_horizon(horizon, failed);
        // It was found, though something else is wrong.
        if sure[0] && !meant[0] && self.horizon > Tick(0) {
            *told = Told::Whole;
        }
        settled
    }

    /// Continuous time up to a horizon.
    fn settle_continuous(&mut self, horizon: &Expr, failed: bool) -> Lowered<()> {
        let end = self.number_of(horizon, Dimension::TIME, &Locals::of(0))?;
        if end.value <= 0.0 {
            return self.report(error!(E0505, horizon.span, "the horizon must be positive"));
        }
        let tick = moments::tick(end.exact, end.value, &self.measured);
        let Some((tick, last)) = tick.and_then(|(tick, end)| Some((tick, end.div(tick)?.as_whole()?))) else {
            return self.report(error!(E0501, horizon.span, "the time is out of range"));
        };
        self.clock = Clock::Jumps(tick);
        self.horizon = Tick(last as u64);
        if failed { Err(Reported) } else { Ok(()) }
    }

    fn settle_horizon(&mut self, horizon: &Expr, failed: bool) -> Lowered<()> {
        let end = self.time(horizon, &Locals::of(0))?;
        match end {
            Some(Tick(0)) => self.report(error!(E0505, horizon.span, "the horizon must be positive")),
            Some(tick) if tick.0 <= MOST_TICKS => {
                self.horizon = tick;
                if failed { Err(Reported) } else { Ok(()) }
            }
            _ => self.report(error!(E0505, horizon.span, "a trial can have at most {MOST_TICKS} steps")),
        }
    }
}
