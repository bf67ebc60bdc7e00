//! Whether a formula or metric can be watched: that it looks no farther than the horizon, and that there is a monitor for it.

use crate::base::tick::Clock;
use crate::compile::context::{Context, Lowered, clock::Told};
use crate::logic::{Invalid, Monitor, Node, Part, Robustness, Root, SignalMonitor, SignalRobustness, reach};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Whether there is a monitor for it.
pub(crate) fn watchable(context: &mut Context<'_>, root: Root, span: Span) -> Lowered<()> {
    let (tree, horizon, clock) = (&context.observed.tree, context.time.horizon, context.time.clock);
    let made = match (clock, root) {
        // Bounds between ticks are not right yet.
        (Clock::Jumps(_), _) if !context.time.between.is_empty() => None,
        (Clock::Jumps(tick), Root::Formula(node)) => SignalMonitor::formula(tree, node, horizon, tick).err(),
        (Clock::Jumps(tick), Root::Metric(term)) => SignalMonitor::metric(tree, term, horizon, tick).err(),
        (Clock::Jumps(tick), Root::Robustness(node, _)) => {
            SignalRobustness::new(tree, node, horizon, tick).err()
        }
        (_, Root::Formula(node)) => Monitor::formula(tree, node, horizon, clock).err(),
        (_, Root::Metric(term)) => Monitor::metric(tree, term, horizon, clock).err(),
        (_, Root::Robustness(node, _)) => Robustness::new(tree, node, horizon, clock).err(),
    };
    match made {
        None => Ok(()),
        Some(reason @ (Invalid::TooLarge { .. } | Invalid::TooMany { .. })) => {
            let hint = if matches!(reason, Invalid::TooMany { .. }) {
                "write a bound for the sum or mean, or evaluate it in fewer states"
            } else {
                "use a longer step, shorter windows, or fewer nested windows"
            };
            context.report(error!(E0509, span, "{}", reason.to_string(); hint: "{hint}"))
        }
        // The horizon is unknown.
        Some(Invalid::BeyondHorizon { .. }) if context.sink.told < Told::Whole => Ok(()),
        Some(reason @ Invalid::BeyondHorizon { .. }) => {
            context.report(error!(E0502, span, "{}", reason.to_string()))
        }
        Some(reason) => {
            let code = if clock.is_jumps() { Code::E0508 } else { Code::E0504 };
            context.report(Diagnostic::error(code, span, reason.to_string()))
        }
    }
}

/// Whether a part ranges up to the horizon; an error where it looks beyond.
pub(crate) fn within_horizon(context: &mut Context<'_>, part: Part, span: Span) -> Lowered<bool> {
    let reach = match reach(&context.observed.tree, part, context.time.horizon, context.time.clock) {
        Ok(reach) => reach,
        Err(reason) => return context.report(error!(E0504, span, "{}", reason.to_string())),
    };
    if reach.ticks <= context.time.horizon.0 || context.sink.told < Told::Whole {
        return Ok(reach.unbounded);
    }
    let (needed, horizon) = (context.time.duration(reach.ticks), context.time.whole());
    let mut error = error!(E0502, span, "the formula needs {needed}, but the horizon is {horizon}");
    // One that begins beyond has no bounded one inside to blame.
    let begins = match part {
        Part::Node(node) => match &context.observed.tree.nodes[node.0 as usize] {
            Node::Finally(window, _) | Node::Globally(window, _) => window.from.0 >= reach.ticks,
            _ => false,
        },
        Part::Term(_) => false,
    };
    error = if reach.unbounded && !begins {
        error.hint("an operator without a bound, including `time_until`, evaluates its operand up to the horizon, and the bounded operator inside extends beyond it; write a bound for the outer operator, or use a condition of one state inside")
    } else {
        error.hint(format!("set `horizon = {needed}` in the scenario, or shorten the bounds"))
    };
    if !context.names.hangs_on_parameters(span) {
        error = context.time.clock_at.iter().copied().fold(error.formal(), Diagnostic::hanging_on);
    }
    context.report(error)
}
