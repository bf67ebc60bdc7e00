//! Functions: those declared with `let`, and the built-in ones.

use super::super::dimension::Dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::number::Number;
use super::super::symbols::{Meaning, unknown};
use super::super::typed::Typed;
use super::super::weight::Weight;
use super::builtin::{DISTRIBUTIONS, FUNCTIONS};
use super::coordinates;
use crate::base::math;
use crate::logic::Term;
use crate::model::{Arithmetic, Axis, Bool, Field, Function, Num, Place, Set, Who};
use crate::syntax::ast::{Expr, Ident};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
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
        match function.name.as_str() {
            "min" | "max" => self.extremum(expr, function, arguments, locals),
            "abs" | "sqrt" | "floor" | "ceil" | "round" | "exp" | "ln" | "sin" | "cos" => {
                self.of_number(expr, function, arguments, locals)
            }
            "distance" | "time_to_collision" | "atan2" | "modulo" => {
                self.of_two(expr, function, arguments, locals)
            }
            "if" => self.choice(expr, function, arguments, locals),
            "contact" => self.contact(expr, function, arguments, locals),
            "time_until" => {
                let [formula] = arguments else {
                    let given = (arguments, locals);
                    return self
                        .inside_a_formula(|this| this.arity(function, expr.span, "1 argument", given));
                };
                if !self.temporal || locals.running > 0 {
                    let error = Diagnostic::error(
                        Code::E0504,
                        expr.span,
                        "`time_until` is about a trace, but a value of one state is needed here",
                    )
                    .hint("write it in a metric or a comparison of a property file, outside of folds over agents");
                    return self.report(error);
                }
                let typed = self.inside_a_formula(|this| this.lower(formula, locals));
                let node = self.as_formula(typed?, formula.span)?;
                let dimension = self.time_dimension();
                Ok(Typed::Term(self.term(Term::TimeUntil(node)), dimension))
            }
            "robustness" => {
                let error = Diagnostic::error(
                    Code::E0504,
                    expr.span,
                    "`robustness` is allowed only directly inside `E(…)`, `Q(…)` and `P(…)`",
                )
                .hint("write `E(robustness(safe)) in -1 m .. 1 m` or `P(robustness(safe) >= 0.2 m)`");
                self.report(error)
            }
            name if DISTRIBUTIONS.contains(&name) => {
                let error = Diagnostic::error(
                    Code::E0404,
                    expr.span,
                    format!("the distribution `{name}` cannot be part of an expression"),
                )
                .hint("use it as the value of a field or of `after`; it may have a factor: `poisson(4) * (1 s / 3)`");
                self.report(error)
            }
            name if FUNCTIONS.contains(&name) => {
                let [argument] = arguments else {
                    return self.arity(function, expr.span, "1 argument", (arguments, locals));
                };
                self.of_one(function, argument, locals)
            }
            name => {
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
                        self.note(Diagnostic::error(Code::E0204, expr.span, text));
                    }
                    return self.lower_all(arguments, locals).and(Err(Reported));
                }
                let mut known: Vec<&str> = FUNCTIONS.into_iter().chain(DISTRIBUTIONS).collect();
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
        }
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
    fn of_one(&mut self, function: &Ident, argument: &Expr, locals: &Locals) -> Lowered<Typed> {
        let typed = self.lower(argument, locals)?;
        let span = argument.span;
        let field = |field, dimension| (field, dimension);
        let (field, dimension) = match function.name.as_str() {
            "speed" => match typed {
                Typed::Agents { set, particle: false } => {
                    let (x, y) = mean_velocity(&set);
                    return Ok(Typed::Num(norm(x, y), Dimension::SPEED));
                }
                _ => field(Field::Speed, Dimension::SPEED),
            },
            "heading" => match typed {
                Typed::Agents { set, particle: false } => {
                    let (x, y) = mean_velocity(&set);
                    let angle = Num::Combine(Arithmetic::Atan2, Box::new(y), Box::new(x));
                    return Ok(Typed::Num(angle, Dimension::ANGLE));
                }
                _ => field(Field::Heading, Dimension::ANGLE),
            },
            "radius" => field(Field::Radius, Dimension::LENGTH),
            "mass" => field(Field::Mass, Dimension::MASS),
            "driving_speed" => field(Field::DrivingSpeed, Dimension::SPEED),
            "travelled" => field(Field::Travelled, Dimension::LENGTH),
            "present" => return Ok(Typed::truth(Bool::Present(self.as_agent(typed, span)?))),
            "clearance" => {
                return Ok(Typed::Num(Num::Clearance(self.as_agent(typed, span)?), Dimension::LENGTH));
            }
            "position" => {
                let (x, y, dimension) = match typed {
                    Typed::Agents { set, particle: false } => {
                        let (x, y) = coordinates(Place::Centroid(set));
                        (x, y, Dimension::LENGTH)
                    }
                    other => self.as_vector(other, span)?,
                };
                return Ok(Typed::Vector(x, y, dimension));
            }
            "velocity" => {
                let (x, y) = match typed {
                    Typed::Agents { set, particle: false } => mean_velocity(&set),
                    other => {
                        let who = self.as_agent(other, span)?;
                        (Num::Of(Field::VelocityX, who), Num::Of(Field::VelocityY, who))
                    }
                };
                return Ok(Typed::Vector(x, y, Dimension::SPEED));
            }
            "x" | "y" | "norm" => {
                if let Typed::Point(x, y) = typed {
                    return match function.name.as_str() {
                        "x" => Ok(Typed::Number(x)),
                        "y" => Ok(Typed::Number(y)),
                        name => {
                            let length = (x.value * x.value + y.value * y.value).sqrt();
                            self.computed(length, x.dimension, name, span)
                        }
                    };
                }
                let (x, y, dimension) = self.as_vector(typed, span)?;
                let value = match function.name.as_str() {
                    "x" => x,
                    "y" => y,
                    _ => {
                        // Each is squared, and so written twice.
                        self.count_copy(Weight::of_num(&x), span)?;
                        self.count_copy(Weight::of_num(&y), span)?;
                        norm(x, y)
                    }
                };
                return Ok(Typed::Num(value, dimension));
            }
            "centroid" => {
                let set = self.as_set(typed, span)?;
                let (x, y) = coordinates(Place::Centroid(set));
                return Ok(Typed::Vector(x, y, Dimension::LENGTH));
            }
            "spread" => return Ok(Typed::Num(Num::Spread(self.as_set(typed, span)?), Dimension::LENGTH)),
            "members" => {
                let set = self.as_set(typed, span)?;
                return Ok(Typed::Agents { set, particle: false });
            }
            "count" => {
                let set = self.as_set(typed, span)?;
                return Ok(Typed::Num(Num::Count(set, Box::new(Bool::Constant(true))), Dimension::NONE));
            }
            "others" => {
                let who = self.as_agent(typed, span)?;
                return Ok(Typed::Agents {
                    set: Set { members: self.everyone(), except: Some(who) },
                    particle: false,
                });
            }
            "area" => return self.area(typed, span).map(Typed::Number),
            "density" => {
                let Typed::Region(region) = typed else { return self.mismatch(span, "a region", &typed) };
                let area = self.area(Typed::Region(region), span)?;
                let everyone = Set { members: self.everyone(), except: None };
                let inside = Num::Count(everyone, Box::new(Bool::In(Who::Running(locals.running), region)));
                let density =
                    Num::Combine(Arithmetic::Divide, Box::new(inside), Box::new(Num::Constant(area.value)));
                return Ok(Typed::Num(density, Dimension::DENSITY));
            }
            name => {
                let error = Diagnostic::error(
                    Code::E0305,
                    function.span,
                    format!("`{name}` needs a set or a time window"),
                )
                .hint(format!("write `{name}(… for a in crowd)` or `{name}<=10 s (…)`"));
                return self.report(error);
            }
        };
        Ok(Typed::Num(Num::Of(field, self.as_agent(typed, span)?), dimension))
    }

    fn area(&mut self, typed: Typed, span: Span) -> Lowered<Number> {
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
        expr: &Expr,
        function: &Ident,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        let [argument] = arguments else {
            return self.arity(function, expr.span, "1 argument", (arguments, locals));
        };
        let typed = self.lower(argument, locals)?;
        if let (Typed::Term(term, dimension), "abs") = (&typed, function.name.as_str()) {
            let term = self.term(Term::Abs(*term));
            return Ok(Typed::Term(term, *dimension));
        }
        let known = if let Typed::Number(number) = &typed { Some(*number) } else { None };
        let (num, given) = self.as_num(typed, argument.span)?;
        let expected = match function.name.as_str() {
            "sin" | "cos" => Some(Dimension::ANGLE),
            "exp" | "ln" | "floor" | "ceil" | "round" => Some(Dimension::NONE),
            _ => None,
        };
        if let Some(expected) = expected
            && expected != given
        {
            return self.wrong_dimension(argument.span, expected, given);
        }
        let dimension = match function.name.as_str() {
            "sqrt" => match given.root() {
                Some(root) => root,
                None => {
                    let error = Diagnostic::error(
                        Code::E0303,
                        argument.span,
                        format!("the square root of `{given}` has no unit"),
                    );
                    return self.report(error);
                }
            },
            "sin" | "cos" => Dimension::NONE,
            _ => given,
        };
        let (apply, compute): (Function, fn(f64) -> f64) = match function.name.as_str() {
            "abs" => (Function::Abs, f64::abs),
            "sqrt" => (Function::Sqrt, f64::sqrt),
            "floor" => (Function::Floor, f64::floor),
            "ceil" => (Function::Ceil, f64::ceil),
            "round" => (Function::Round, f64::round),
            "exp" => (Function::Exp, math::exp),
            "ln" => (Function::Ln, math::ln),
            "sin" => (Function::Sin, |x| math::sin_cos(x).0),
            _ => (Function::Cos, |x| math::sin_cos(x).1),
        };
        match known {
            Some(number) => self.computed(compute(number.value), dimension, &function.name, argument.span),
            None => Ok(Typed::Num(Num::Apply(apply, Box::new(num)), dimension)),
        }
    }

    /// What a function gives for what is known now: exact where it is whole.
    fn computed(&mut self, value: f64, dimension: Dimension, function: &str, span: Span) -> Lowered<Typed> {
        if !value.is_finite() {
            let text = format!("`{function}` of this value is not finite");
            return self.report(Diagnostic::error(Code::E0405, span, text));
        }
        let whole = value.fract() == 0.0 && value.abs() < 9e15;
        let exact = whole.then(|| crate::base::decimal::Decimal::whole(value as i64));
        Ok(Typed::Number(Number { value, exact, dimension }))
    }

    fn of_two(
        &mut self,
        expr: &Expr,
        function: &Ident,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Lowered<Typed> {
        let [left, right] = arguments else {
            return self.arity(function, expr.span, "2 arguments", (arguments, locals));
        };
        let sides = (self.lower(left, locals), self.lower(right, locals));
        let (a, b) = (sides.0?, sides.1?);
        match function.name.as_str() {
            "distance" => {
                if let (Typed::Point(ax, ay), Typed::Point(bx, by)) = (&a, &b)
                    && ax.dimension == Dimension::LENGTH
                    && bx.dimension == Dimension::LENGTH
                {
                    let (dx, dy) = (ax.value - bx.value, ay.value - by.value);
                    let length = (dx * dx + dy * dy).sqrt();
                    return self.computed(length, Dimension::LENGTH, &function.name, expr.span);
                }
                let places = (self.as_place(a, left.span), self.as_place(b, right.span));
                let (a, b) = (places.0?, places.1?);
                let extended = |p: &Place| matches!(p, Place::Region(_) | Place::Barrier(_));
                if extended(&a) && extended(&b) {
                    let error = Diagnostic::error(
                        Code::E0305,
                        expr.span,
                        "one side of a distance must be an agent or a point",
                    );
                    return self.report(error);
                }
                Ok(Typed::Num(Num::Distance(a, b), Dimension::LENGTH))
            }
            "time_to_collision" => {
                let agents = (self.as_agent(a, left.span), self.as_agent(b, right.span));
                Ok(Typed::Num(Num::TimeToCollision(agents.0?, agents.1?), Dimension::TIME))
            }
            _ => {
                let known = matches!((&a, &b), (Typed::Number(_), Typed::Number(_)));
                let sides = (self.as_num(a, left.span), self.as_num(b, right.span));
                let ((a, da), (b, db)) = (sides.0?, sides.1?);
                if da != db {
                    return self.wrong_dimension(right.span, da, db);
                }
                let (op, dimension) = if function.name == "atan2" {
                    (Arithmetic::Atan2, Dimension::ANGLE)
                } else {
                    (Arithmetic::Modulo, da)
                };
                if let (true, Num::Constant(a), Num::Constant(b)) = (known, &a, &b) {
                    if op == Arithmetic::Modulo && *b == 0.0 {
                        return self.report(Diagnostic::error(Code::E0405, right.span, "division by zero"));
                    }
                    return self.computed(op.of(*a, *b), dimension, &function.name, expr.span);
                }
                Ok(Typed::Num(Num::Combine(op, Box::new(a), Box::new(b)), dimension))
            }
        }
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
    (Num::MeanVelocity(Axis::X, set.clone()), Num::MeanVelocity(Axis::Y, set.clone()))
}

/// Length of a vector.
fn norm(x: Num, y: Num) -> Num {
    let square = |n: Num| Num::Combine(Arithmetic::Multiply, Box::new(n.clone()), Box::new(n));
    let sum = Num::Combine(Arithmetic::Add, Box::new(square(x)), Box::new(square(y)));
    Num::Apply(Function::Sqrt, Box::new(sum))
}
