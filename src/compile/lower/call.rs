//! Functions: those declared with `let`, and the built-in ones.

use super::super::dimension::Dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::number::Number;
use super::super::symbols::{Meaning, unknown};
use super::super::typed::Typed;
use super::super::weight::Weight;
use super::builtin::DISTRIBUTIONS;
use super::{coordinates, counted_arguments, legs};
use crate::logic::Term;
use crate::model::function::{Rule, Signature, Special};
use crate::model::{Arithmetic, Axis, Bool, BuiltIn, Collective, Field, Function, Num, Place, Set};
use crate::syntax::ast::{Expr, Ident};
use crate::syntax::codes::Code;
use crate::syntax::parse::foreign_word;
use crate::syntax::source::Span;

impl Elaborator<'_> {
    pub(super) fn lower_call(
        &mut self,
        expr: &Expr,
        function: &Ident,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        // `now()` of a name without arguments is the name.
        if arguments.is_empty() && self.is_named(&function.name, locals) {
            return self.lower_name(&function.name, function.span, locals);
        }
        if let Some(decl) = self.function_inside(&function.name, locals) {
            self.note_inside(function.span);
            return self.lower_let((0, decl), expr.span, arguments, locals);
        }
        if let Some(called) = self.call_inside_behaviour(function, expr.span, arguments, locals) {
            return called;
        }
        let found = self.find(&function.name, locals.scope);
        if matches!(found, Some((_, Meaning::Doubtful))) {
            return self.lower_all(arguments, locals).and(Err(Reported));
        }
        if let Some((scope, meaning)) = found
            && let Meaning::Let(decl) = meaning
            && !decl.arguments.is_empty()
        {
            return self.lower_let((scope, decl), expr.span, arguments, locals);
        }
        if let Some(built_in) = BuiltIn::find(&function.name) {
            return self.built_in(built_in, (expr, function), arguments, locals);
        }
        if DISTRIBUTIONS.contains(&function.name.as_str()) {
            return self.report(error!(E0404, expr.span, "the distribution `{}` cannot be part of an expression", function.name;
                hint: "use it as the value of a field or of `after`; it may have a factor: `poisson(4) * (1 s / 3)`"));
        }
        self.unknown_function(function, expr.span, arguments, locals)
    }

    fn unknown_function(
        &mut self,
        function: &Ident,
        span: Span,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        let name = function.name.as_str();
        self.unknowns += 1;
        if self.is_said(Code::E0203, function.span) {
            return Err(Reported);
        }
        // A unit that is misspelt reads as a call, and what follows it is what it is.
        if self.is_said(Code::E0113, function.span) {
            return self.lower_all(arguments, locals).and(Err(Reported));
        }
        if let Some((_, meaning)) = self.find(name, locals.scope) {
            let hidden = self.scopes[0].get(name).is_some_and(|e| takes_arguments(&e.meaning));
            // That a name of the scenario was taken was said where that was done; and what is wrong with it
            // may be just that it lacks its arguments.
            if !hidden && self.lower_name(name, function.span, locals).is_ok() {
                let text = format!("`{name}` is {} and has no arguments", meaning.noun());
                self.note(error!(E0204, span, "{text}"));
            }
            return self.lower_all(arguments, locals).and(Err(Reported));
        }
        let mut known: Vec<&str> = BuiltIn::names().chain(DISTRIBUTIONS).collect();
        let declared: Vec<String> = [locals.scope, 0]
            .iter()
            .filter(|_| self.looks_for_names())
            .filter_map(|s| self.scopes.get(*s))
            .flat_map(super::super::symbols::Scope::entries)
            .filter(|(_, e)| takes_arguments(&e.meaning))
            .map(|(n, _)| n.to_owned())
            .collect();
        known.extend(declared.iter().map(String::as_str));
        let error = unknown("function", name, function.span, Code::E0203, known.into_iter());
        let within = arguments.iter().map(|argument| self.text(argument.span)).collect::<Vec<_>>();
        self.note(match foreign_word(name, &within.join(", ")) {
            Some(hint) => error.hint(hint),
            None => error,
        });
        // Whatever it is, its arguments are what they are.
        let _ = self.lower_all(arguments, locals);
        Err(Reported)
    }

    /// A built-in function, by what the table says that it takes.
    fn built_in(
        &mut self,
        built_in: &'static BuiltIn,
        (expr, function): (&Expr, &Ident),
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        match built_in.signature {
            Signature::Special(Special::Extremum(operator)) => {
                return self.extremum(expr, (function, operator), arguments, locals);
            }
            Signature::Special(Special::Contact) => return self.contact(expr, function, arguments, locals),
            Signature::Special(Special::TimeUntil) => {
                return self.time_until(expr, function, arguments, locals);
            }
            Signature::Special(Special::Leg(measure)) if let [agent, number] = arguments => {
                return self.leg(built_in, measure, (expr, [agent, number]), locals);
            }
            Signature::Special(Special::Flow) if let [line, window] = arguments => {
                return self.flow(built_in, [line, window], locals);
            }
            Signature::Special(Special::Robustness) => {
                return self.report(error!(E0504, expr.span, "`robustness` is allowed only directly inside `E(…)`, `Q(…)` and `P(…)`";
                    hint: "write `E(robustness(safe)) in -1 m .. 1 m` or `P(robustness(safe) >= 0.2 m)`"));
            }
            _ if !built_in.takes(arguments.len()) => {
                let wanted = counted_arguments(built_in.arguments.0);
                return self.arity(function, expr.span, &wanted, (arguments, locals));
            }
            _ => {}
        }
        match arguments {
            [argument] => match built_in.signature {
                Signature::Number(apply, takes) => self.of_number((built_in, apply, takes), argument, locals),
                _ => self.of_one(built_in, function, argument, locals),
            },
            [left, right] => {
                let sides = (self.lower(left, locals), self.lower(right, locals));
                let (a, b) = (sides.0?, sides.1?);
                let sides = [(a, left.span), (b, right.span)];
                match built_in.signature {
                    Signature::Numbers(operator) => self.of_two(built_in, operator, sides, expr.span),
                    Signature::Agents(pair) => {
                        let [a, b] = sides.map(|(typed, span)| self.as_agent(typed, span));
                        Ok(Typed::Num(Num::OfTwo(pair, a?, b?), built_in.gives()))
                    }
                    Signature::Special(Special::Dwell) => self.dwell(built_in, sides),
                    _ => self.distance(sides, expr.span),
                }
            }
            _ => self.choice(expr, function, arguments, locals),
        }
    }

    fn time_until(
        &mut self,
        expr: &Expr,
        function: &Ident,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        let [formula] = arguments else {
            let given = (arguments, locals);
            return self.inside_a_formula(|this| this.arity(function, expr.span, "1 argument", given));
        };
        if !self.temporal || locals.running > 0 {
            return self.report(error!(E0504, expr.span, "`time_until` is about a trace, but a value of one state is needed here";
                hint: "write it in a metric or a comparison of a property file, outside of folds over agents"));
        }
        let typed = self.inside_a_formula(|this| this.lower(formula, locals));
        let node = self.as_formula(typed?, formula.span)?;
        let dimension = self.time_dimension();
        Ok(Typed::Term(self.term(Term::TimeUntil(node)), dimension))
    }

    /// Whether a name stands for an expression without arguments.
    fn is_named(&self, name: &str, locals: &Locals) -> bool {
        if self.is_inside(name, locals) {
            return self.is_without_arguments(name, locals);
        }
        let found = self.find(name, locals.scope);
        matches!(found, Some((_, Meaning::Let(decl))) if decl.arguments.is_empty())
    }

    /// Functions of one agent, set, region or point.
    fn of_one(
        &mut self,
        built_in: &BuiltIn,
        function: &Ident,
        argument: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        let typed = self.lower(argument, locals)?;
        let span = argument.span;
        let special = match (built_in.signature, typed) {
            // Of a set, those of its mean velocity.
            (Signature::Agent(Field::Speed), Typed::Agents { set, particle: false }) => {
                let (x, y) = mean_velocity(&set);
                return Ok(Typed::Num(norm(x, y), built_in.gives()));
            }
            (Signature::Agent(Field::Heading), Typed::Agents { set, particle: false }) => {
                let (x, y) = mean_velocity(&set);
                let angle = Num::Combine(Arithmetic::Atan2, Box::new(y), Box::new(x));
                return Ok(Typed::Num(angle, built_in.gives()));
            }
            (Signature::Agent(field), typed) => {
                return Ok(Typed::Num(Num::Of(field, self.as_agent(typed, span)?), built_in.gives()));
            }
            (Signature::Set(collective), typed) => {
                return Ok(Typed::Num(Num::OfSet(collective, self.as_set(typed, span)?), built_in.gives()));
            }
            (Signature::Special(special), typed) => (special, typed),
            // The others take numbers, or two agents.
            _ => return Err(Reported),
        };
        Ok(match special {
            (Special::Done, typed) => legs::done(self.as_agent(typed, span)?),
            (Special::Present, typed) => Typed::truth(Bool::Present(self.as_agent(typed, span)?)),
            (Special::Position, Typed::Agents { set, particle: false }) => centroid(set),
            (Special::Position, typed) => {
                let (x, y, dimension) = self.as_vector(typed, span)?;
                Typed::Vector(x, y, dimension)
            }
            (Special::Velocity, Typed::Agents { set, particle: false }) => {
                let (x, y) = mean_velocity(&set);
                Typed::Vector(x, y, Dimension::SPEED)
            }
            (Special::Velocity, typed) => {
                let who = self.as_agent(typed, span)?;
                Typed::Vector(
                    Num::Of(Field::VelocityX, who),
                    Num::Of(Field::VelocityY, who),
                    Dimension::SPEED,
                )
            }
            (Special::Component(axis), Typed::Point(x, y)) => {
                Typed::Number(if axis == Axis::X { x } else { y })
            }
            (Special::Component(axis), typed) => {
                let (x, y, dimension) = self.as_vector(typed, span)?;
                Typed::Num(if axis == Axis::X { x } else { y }, dimension)
            }
            (Special::Norm, Typed::Point(x, y)) => {
                let length = (x.value * x.value + y.value * y.value).sqrt();
                return self.computed(length, x.dimension, built_in.name, span);
            }
            (Special::Norm, typed) => {
                let (x, y, dimension) = self.as_vector(typed, span)?;
                // Each is squared, and so written twice.
                self.count_copy(Weight::of_num(&x), span)?;
                self.count_copy(Weight::of_num(&y), span)?;
                Typed::Num(norm(x, y), dimension)
            }
            (Special::Centroid, typed) => centroid(self.as_set(typed, span)?),
            (Special::Members, typed) => Typed::Agents { set: self.as_set(typed, span)?, particle: false },
            (Special::Count, typed) => {
                let set = self.as_set(typed, span)?;
                Typed::Num(Num::Count(set, Box::new(Bool::Constant(true))), built_in.gives())
            }
            (Special::Others, typed) => {
                let who = self.as_agent(typed, span)?;
                let set = Set { members: self.everyone(), except: Some(who) };
                Typed::Agents { set, particle: false }
            }
            (Special::Area, typed) => return self.area(typed, span).map(Typed::Number),
            (Special::Crossings, typed) => {
                let line = self.counted_line(typed, span)?;
                Typed::Num(Num::Crossings(line, None), built_in.gives())
            }
            (
                special @ (Special::Density
                | Special::LevelOfService
                | Special::MeanSpeed
                | Special::VoronoiDensity),
                typed,
            ) => Typed::Num(self.of_region(special, typed, span, locals)?, built_in.gives()),
            _ => {
                let name = built_in.name;
                return self.report(error!(E0305, function.span, "`{name}` needs a set or a time window";
                    hint: "write `{name}(… for a in crowd)` or `{name}<=10 s (…)`"));
            }
        })
    }

    pub(super) fn area(&mut self, typed: Typed, span: Span) -> Lowered<Number> {
        match typed {
            Typed::Region(region) => {
                let shape = self.region_shape(region, span)?;
                Ok(Number::rounded(shape.area(), Dimension::AREA))
            }
            found => self.mismatch(span, "a region", &found),
        }
    }

    fn of_number(
        &mut self,
        (built_in, apply, takes): (&BuiltIn, Function, Option<Dimension>),
        argument: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        let typed = self.lower(argument, locals)?;
        if let (Typed::Term(term, dimension), Function::Abs) = (&typed, apply) {
            let term = self.term(Term::Abs(*term));
            return Ok(Typed::Term(term, *dimension));
        }
        let known = if let Typed::Number(number) = &typed { Some(*number) } else { None };
        let (num, given) = self.as_num(typed, argument.span)?;
        if let Some(expected) = takes.filter(|expected| *expected != given) {
            return self.wrong_dimension(argument.span, expected, given);
        }
        let dimension = match built_in.dimension {
            Rule::Always(dimension) => dimension,
            Rule::Root => match given.root() {
                Some(root) => root,
                None => {
                    return self
                        .report(error!(E0303, argument.span, "the square root of `{given}` has no unit"));
                }
            },
            _ => given,
        };
        match known {
            Some(number) => self.computed(apply.of(number.value), dimension, built_in.name, argument.span),
            None => Ok(Typed::Num(Num::Apply(apply, Box::new(num)), dimension)),
        }
    }

    /// What a function gives for what is known now: exact where it is whole.
    fn computed(&mut self, value: f64, dimension: Dimension, function: &str, span: Span) -> Lowered<Typed> {
        if !value.is_finite() {
            let text = format!("`{function}` of this value is not finite");
            return self.report(error!(E0405, span, "{text}"));
        }
        let whole = value.fract() == 0.0 && value.abs() < 9e15;
        let exact = whole.then(|| crate::base::decimal::Decimal::whole(value as i64));
        Ok(Typed::Number(Number { value, exact, dimension }))
    }

    fn of_two(
        &mut self,
        built_in: &BuiltIn,
        operator: Arithmetic,
        [(a, left), (b, right)]: [(Typed, Span); 2],
        span: Span,
    ) -> Lowered<Typed> {
        let known = matches!((&a, &b), (Typed::Number(_), Typed::Number(_)));
        let sides = (self.as_num(a, left), self.as_num(b, right));
        let ((a, da), (b, db)) = (sides.0?, sides.1?);
        if da != db {
            return self.wrong_dimension(right, da, db);
        }
        let dimension = if let Rule::Always(dimension) = built_in.dimension { dimension } else { da };
        if let (true, Num::Constant(a), Num::Constant(b)) = (known, &a, &b) {
            if operator == Arithmetic::Modulo && *b == 0.0 {
                return self.report(error!(E0405, right, "division by zero"));
            }
            return self.computed(operator.of(*a, *b), dimension, built_in.name, span);
        }
        Ok(Typed::Num(Num::Combine(operator, Box::new(a), Box::new(b)), dimension))
    }

    fn distance(&mut self, [(a, left), (b, right)]: [(Typed, Span); 2], span: Span) -> Lowered<Typed> {
        if let (Typed::Point(ax, ay), Typed::Point(bx, by)) = (&a, &b)
            && ax.dimension == Dimension::LENGTH
            && bx.dimension == Dimension::LENGTH
        {
            let (dx, dy) = (ax.value - bx.value, ay.value - by.value);
            let length = (dx * dx + dy * dy).sqrt();
            return self.computed(length, Dimension::LENGTH, "distance", span);
        }
        let places = (self.as_place(a, left), self.as_place(b, right));
        let (a, b) = (places.0?, places.1?);
        let extended = |p: &Place| matches!(p, Place::Region(_) | Place::Barrier(_));
        if extended(&a) && extended(&b) {
            let said = "one side of a distance must be an agent or a point";
            return self.report(error!(E0305, span, "{said}"));
        }
        Ok(Typed::Num(Num::Distance(a, b), Dimension::LENGTH))
    }

    fn contact(
        &mut self,
        expr: &Expr,
        function: &Ident,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        self.note_margin(Dimension::LENGTH, expr.span);
        if !matches!(arguments.len(), 1 | 2) {
            return self.arity(function, expr.span, "1 or 2 arguments", (arguments, locals));
        }
        let mut agent = |argument: &Expr| {
            let typed = self.lower(argument, locals)?;
            self.as_agent(typed, argument.span)
        };
        let agents: Vec<_> = arguments.iter().map(&mut agent).collect();
        let agents = agents.into_iter().collect::<Lowered<Vec<_>>>()?;
        Ok(Typed::truth(match agents[..] {
            [one, other] => Bool::Touching(one, other),
            _ => Bool::Contact(agents[0]),
        }))
    }
}

/// Whether a name stands for a function.
fn takes_arguments(meaning: &Meaning<'_>) -> bool {
    matches!(meaning, Meaning::Let(decl) if !decl.arguments.is_empty())
}

fn mean_velocity(set: &Set) -> (Num, Num) {
    let along = |axis| Num::OfSet(Collective::MeanVelocity(axis), set.clone());
    (along(Axis::X), along(Axis::Y))
}

fn centroid(set: Set) -> Typed {
    let (x, y) = coordinates(Place::Centroid(set));
    Typed::Vector(x, y, Dimension::LENGTH)
}

/// Length of a vector.
fn norm(x: Num, y: Num) -> Num {
    let square = |n: Num| Num::Combine(Arithmetic::Multiply, Box::new(n.clone()), Box::new(n));
    let sum = Num::Combine(Arithmetic::Add, Box::new(square(x)), Box::new(square(y)));
    Num::Apply(Function::Sqrt, Box::new(sum))
}
