//! Where agents start, and with which velocity.

use super::dimension::{Dimension, describe};
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::laws::value_span;
use super::people::People;
use super::symbols::{Entry, Meaning};
use super::typed::Typed;
use crate::base::geometry::Vec2;
use crate::model::{Position, Start, TOP_SPEED, Who};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, Value};
use crate::syntax::diagnostic::About;

impl Elaborator<'_> {
    pub(super) fn start(
        &mut self,
        name: &Ident,
        fields: &[&Field],
        people: &People,
        required: bool,
    ) -> Lowered<Start> {
        let position = match fields.iter().find(|f| f.name.name == "at") {
            Some(field) if self.misread_placement(&field.value) => Err(Reported),
            Some(field) => self.position(name, &field.value, people),
            None if required => self.report(
                error!(E0209, name.span, "`{}` has no `at`", name.name;
                    hint: "write `at = ` with a point, `uniform in` a shape, or `near` another agent")
                .about(About::Start),
            ),
            None => Err(Reported),
        };
        let velocity = match fields.iter().find(|f| f.name.name == "velocity").map(|f| &f.value) {
            Some(Value::Plain(expr)) => self.velocity_of(expr),
            Some(other) => {
                let said = "expected a velocity such as `(1, 0) m/s`";
                self.report(error!(E0305, value_span(other), "{said}"))
            }
            None => Ok(Vec2::zeros()),
        };
        Ok(Start { position: position?, velocity: velocity?, ..Start::at_rest(Vec2::zeros()) })
    }

    fn velocity_of(&mut self, expr: &Expr) -> Lowered<Vec2> {
        let velocity = match self.lower(expr, &Locals::default())? {
            Typed::Point(x, y) if x.dimension == Dimension::SPEED => Vec2::new(x.value, y.value),
            Typed::Point(x, _) => {
                let found = describe(x.dimension);
                let error = error!(E0303, expr.span, "expected a velocity, found {found}";
                        hint: "write the unit after the parentheses: `(1, 0) m/s`");
                return self.report(error);
            }
            found => return self.mismatch(expr.span, "a velocity such as `(1, 0) m/s`", &found),
        };
        if velocity.norm() > TOP_SPEED {
            let speed = (velocity.norm() * 1e3).round() / 1e3;
            let text = format!(
                "the initial speed exceeds {TOP_SPEED} m/s, the limit for a person (got {speed} m/s)"
            );
            return self.report(error!(E0405, expr.span, "{text}";
                hint: "every trial would diverge; write a smaller velocity"));
        }
        Ok(velocity)
    }

    /// Reports an anchor that is declared later or arrives by a source.
    fn declared_before(&mut self, of: &Ident, agent: &Expr) -> Lowered<()> {
        let whose = if let ExprKind::Index(base, _) = &agent.kind { &**base } else { agent };
        let ExprKind::Name(name) = &whose.kind else { return Ok(()) };
        let Some(Entry { span, meaning: Meaning::Declared }) = self.scopes[0].get(name) else {
            return Ok(());
        };
        let (title, hint) = if *span == of.span {
            (format!("`{name}` cannot start near itself"), "start near another agent, or at a place")
        } else if span.start > of.span.start {
            let hint = "an agent must be declared after the agent near which it starts";
            ("the agent is declared later".to_owned(), hint)
        } else {
            // All others that stand before are known.
            let said = format!("agents from source `{name}` are not present at the start");
            (said, "start near an agent, or at a place")
        };
        self.report(error!(E0403, agent.span, "{title}"; hint: "{hint}"))
    }

    /// The start of who is declared by a name.
    pub(super) fn position(&mut self, of: &Ident, value: &Value, people: &People) -> Lowered<Position> {
        match value {
            Value::UniformIn(shape) => self.shape(shape, &Locals::default()).map(Position::Within),
            Value::Near { agent, within } => {
                let distance = match self.number_of(within, Dimension::LENGTH, &Locals::default()) {
                    Ok(distance) if distance.value <= 0.0 => {
                        let said = "the distance must be positive";
                        self.report(error!(E0405, within.span, "{said}"))
                    }
                    far => far.and_then(|d| self.in_reach(within.span, Vec2::new(d.value, 0.0)).map(|_| d)),
                };
                self.declared_before(of, agent)?;
                let typed = self.lower(agent, &Locals::default())?;
                let Who::Agent(id) = self.as_agent(typed, agent.span)? else { return Err(Reported) };
                let distance = distance?;
                // Who could not be declared stands nowhere; that is said already.
                if self.undeclared.contains(&id) || id.0 as usize >= people.agents.len() {
                    return Err(Reported);
                }
                Ok(Position::Near { agent: id, within: distance.value })
            }
            Value::Plain(expr) => match self.lower(expr, &Locals::default())? {
                Typed::Point(x, y) => self.place(expr.span, (x, y)).map(Position::Point),
                // A region as a start means its inside.
                Typed::Region(id) => self.region_shape(id, expr.span).map(Position::Within),
                found => self.mismatch(expr.span, "a point, a region or `uniform in` a shape", &found),
            },
            other => self.report(error!(E0305, value_span(other), "expected a place to start from")),
        }
    }
}
