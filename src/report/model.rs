//! How a scenario and its questions were understood, in units, for `smc show`.

use super::behaviours;
use super::number::counted;
use super::scenery::{self, area_on, place, point};
use crate::base::geometry::Vec2;
use crate::base::tick::Clock;
use crate::compile::Written;
use crate::compile::methods::PLANNED_TRIALS;
use crate::compile::study::{Ask, MeasureKind, Role, Study, World};
use crate::engine::at_most;
use crate::model::parameter::Shown;
use crate::model::{
    Agent, AgentId, Family, GaitRule, Goal, Law, Leg, Move, Outside, Parameter, Particle, Position,
    RoadmapRule, Route, Scenario, SearchRule,
};
use crate::stats::Chosen;
use std::fmt::Write;

/// Longest list of values that is shown in full.
const MOST_LISTED: usize = 16;
/// How many values of a longer one are shown.
const FEW_LISTED: usize = 8;

/// The part of the description that is about a name: its line, as `region exit: rect …`, or its lines, as those of an agent.
pub fn about(study: &Study, name: &str) -> Option<String> {
    let text = describe(study);
    let mut lines = text.lines().skip_while(|line| {
        let words: Vec<&str> = line.split([' ', ':', '[']).filter(|word| !word.is_empty()).take(2).collect();
        let is_it = words.first() == Some(&name) || words.get(1) == Some(&name) && line.contains(": ");
        !(is_it && line.starts_with("  "))
    });
    let first = lines.next()?;
    let indent = |line: &str| line.len() - line.trim_start().len();
    let below = lines.take_while(|line| indent(line) > indent(first));
    Some(
        std::iter::once(first).chain(below).map(|line| &line[indent(first)..]).collect::<Vec<_>>().join("\n"),
    )
}

/// Everything that was understood.
pub fn describe(study: &Study) -> String {
    let mut out = String::new();
    let Some(world) = study.worlds.get(study.base) else { return out };
    scenario(&mut out, world);
    if !study.queries.is_empty() {
        let _ = writeln!(out, "\nQueries");
    }
    for query in &study.queries {
        let _ = writeln!(out, "  {}  {}", query.index, query.text);
        for (name, value) in &query.settings {
            let _ = writeln!(out, "     {name} = {value}");
        }
        let _ = writeln!(out, "     {}", procedure(&query.ask));
        if let Some(horizon) = &query.horizon {
            let _ = writeln!(out, "     within the horizon of {horizon}");
        }
    }
    out
}

fn scenario(out: &mut String, world: &World) {
    let scenario = &world.scenario;
    let title = if scenario.title.is_empty() { "(without a title)" } else { &scenario.title };
    let _ = writeln!(out, "{title}");
    let end = scenario.clock.seconds(scenario.horizon);
    let steps = scenario.horizon.0;
    let _ = match scenario.clock {
        Clock::Stepped(step) => writeln!(out, "  horizon {end} s, step {step} s: {steps} steps"),
        Clock::Steps => writeln!(out, "  horizon {steps} steps"),
        Clock::Jumps(_) => writeln!(out, "  horizon {end} s, continuous time"),
    };
    for (name, value) in &world.settings {
        let _ = writeln!(out, "  set {name} = {value}");
    }
    let written = &world.written;
    for parameter in &written.parameters {
        let _ = writeln!(out, "  param {parameter}");
    }
    for name in &written.names {
        let _ = writeln!(out, "  let {name}");
    }
    processes(out, written);
    let scene = scenery::scene(scenario);
    if !scene.is_empty() {
        let _ = write!(out, "\nScene\n{scene}");
    }
    if let Some(outside) = scenario.processes.outside.as_deref() {
        program(out, outside);
    } else if !scenario.agents.is_empty() || written.processes.is_empty() {
        people(out, world);
    }
}

/// The program that stands for the model.
fn program(out: &mut String, outside: &Outside) {
    let _ = writeln!(out, "\nProgram {}\n  run {}", outside.name, outside.told());
    if let Some(people) = &outside.people {
        let (most, columns) = (people.members.len(), people.columns.join(", "));
        let _ = writeln!(out, "  at most {most} people, from the columns {columns}");
    }
    let end = if outside.is_held { "the last state lasts" } else { "a shorter trace is unresolved" };
    let _ = writeln!(out, "  {} s for a trial; {end}", number(outside.limit));
}

/// The processes as they were written: what is read is the state, and names say which.
fn processes(out: &mut String, written: &Written) {
    for (head, lines) in &written.processes {
        let _ = writeln!(out, "\nProcess {head}");
        for line in lines {
            let _ = writeln!(out, "  {line}");
        }
    }
}

/// The members of one declaration that differ only in their number, together.
pub(super) fn declared(agents: &[Agent]) -> impl Iterator<Item = &[Agent]> {
    fn stem(agent: &Agent) -> Option<&str> {
        agent.name.split('[').next()
    }
    agents.chunk_by(|a, b| stem(a) == stem(b) && a.body == b.body && a.start == b.start && a.route == b.route)
}

fn people(out: &mut String, world: &World) {
    let scenario = &*world.scenario;
    let coming: usize = scenario.sources.iter().map(|source| source.members.len()).sum();
    let _ = writeln!(out, "\nAgents: {}", scenario.agents.len() - coming);
    let mut number_of_first = 0;
    for members in declared(&scenario.agents) {
        let (first, last) = (&members[0], &members[members.len() - 1]);
        let stem = first.name.split('[').next().unwrap_or("");
        let name = match members {
            [one] => one.name.clone(),
            _ => format!("{} to {}", first.name, last.name),
        };
        let _ = match scenario.sources.iter().find(|source| source.name == stem) {
            Some(source) => {
                let (count, every) = (source.members.len(), law(&source.every, "s"));
                writeln!(out, "  source {stem}: one every {every}, at most {count} at once")
            }
            None => writeln!(out, "  {name}"),
        };
        agent(out, scenario, first);
        behaviours::describe(out, world, AgentId(number_of_first));
        number_of_first += members.len() as u32;
    }
    for group in &scenario.groups {
        let (name, members, attraction) = (&group.name, group.members.len(), number(group.attraction));
        let _ = writeln!(out, "  group {name}: {members} members, attraction {attraction} N");
    }
    for moves in &scenario.moves {
        let told = |(label, option): &(String, Move)| match option {
            Move::Route(number) => {
                let route = moves.routes.get(*number);
                route.map_or_else(String::new, |route| format!("{label} ({})", way(scenario, route)))
            }
            Move::Heading(_) | Move::Stop | Move::Own | Move::Path(_) => label.clone(),
        };
        let name = &scenario.agents[moves.agent.0 as usize].name;
        if moves.paths.is_some() {
            let _ = writeln!(out, "\nPaths of {name}: at most {} on its roadmap", moves.options.len());
            continue;
        }
        let labels: Vec<String> = moves.options.iter().map(told).collect();
        let seconds = number(scenario.clock.seconds(moves.duration));
        let _ = writeln!(out, "\nMoves of {name} for {seconds} s: {}", labels.join(", "));
    }
}

fn agent(out: &mut String, scenario: &Scenario, agent: &Agent) {
    let is = |parameter: Parameter, value: f64| agent.body[parameter] == Law::Constant(value);
    let shown: Vec<String> = Parameter::of_kind(agent.body.kind)
        .filter(|parameter| match parameter.description().shown {
            Shown::Always => true,
            Shown::UnlessDefault => {
                parameter.description().default.is_none_or(|value| !is(*parameter, value))
            }
            Shown::With(strength) => !is(strength, 0.0),
        })
        .map(|parameter| format!("{} {}", parameter.name(), law(&agent.body[parameter], &parameter.unit())))
        .collect();
    for line in shown.chunks(4) {
        let _ = writeln!(out, "      {}", line.join(", "));
    }
    if let Some(planner) = &agent.body.planner {
        let _ = writeln!(
            out,
            "      roadmap {}, clearance {} m, profile {}, rounding {}{}{}",
            roadmap(scenario, &planner.roadmap),
            number(planner.clearance),
            planner.profile.name(),
            planner.rounding.name(),
            if planner.reciprocal { ", others avoided by orca" } else { "" },
            if planner.speed_follows { ", speed drawn with its limit" } else { "" }
        );
    }
    if let Some(stepper) = &agent.body.stepper {
        let gait = match &stepper.gait {
            GaitRule::Synthetic => "synthetic".to_owned(),
            GaitRule::Learned { file, .. } => format!("learned, {file}"),
        };
        let search = match stepper.search {
            SearchRule::Guided { candidates } => format!("guided by {candidates} candidates"),
            SearchRule::HybridAStar { cell, starters, successors } => format!(
                "hybrid A* in cells of {} m, {starters} starters, {successors} successors",
                number(cell)
            ),
            SearchRule::GridAStar => "A* on a grid".to_owned(),
            SearchRule::AsPublished => "as published".to_owned(),
        };
        let _ = writeln!(out, "      gait {gait}; search {search}");
    }
    if let Some(p) = agent.particle {
        let (persons, radius) =
            (counted(p.persons.into(), "person"), width(&p, agent.body[Parameter::Radius].bounds().1));
        let [tau, repulsion, friction] = [p.tau_factor, p.repulsion, p.friction].map(number);
        let _ = writeln!(
            out,
            "      one body for {persons}: radius {radius}, tau times {tau}, repulsion times {repulsion}, friction {friction} kg/(m s)"
        );
    }
    let place = match &agent.start.position {
        Position::Point(p) => place(&scenario.scene, *p),
        Position::Within(s) => format!("anywhere in {}", area_on(&scenario.scene, s)),
        Position::Near { agent, within } => {
            format!("within {} m of {}", number(*within), scenario.agents[agent.0 as usize].name)
        }
    };
    let _ = writeln!(out, "      starts {place}, {}", velocity(agent.start.velocity));
    let has_direction = !scenario.scene.periods.are_none() && agent.route == Route::Onward;
    let _ = match &agent.start.turn {
        Law::Constant(turn) if has_direction => {
            writeln!(out, "      walks in the direction {} deg", number(turn.to_degrees()))
        }
        turn if has_direction => writeln!(out, "      walks in the direction {}", law(turn, "rad")),
        _ => writeln!(out, "      {}", way(scenario, &agent.route)),
    };
    if agent.start.turn != Law::Constant(0.0) {
        let _ = writeln!(out, "      turned from the recorded heading by {}", law(&agent.start.turn, "rad"));
    }
}

/// How wide the body of a group is, of persons whose radius is at most `drawn`.
fn width(particle: &Particle, drawn: f64) -> String {
    let mut text = format!("times {}", number(particle.radius_factor));
    if particle.spread > 0.0 {
        text += &format!(", or plus {} m if that is more", number(particle.spread));
    }
    if particle.room < (Particle { room: f64::INFINITY, ..*particle }).radius(drawn) {
        text += &format!(", but no wider than {} m, the distance to a barrier", number(particle.room));
    }
    text
}

/// How a roadmap is drawn, in words.
fn roadmap(scenario: &Scenario, rule: &RoadmapRule) -> String {
    match rule {
        RoadmapRule::Prm { samples, bridge, separation, neighbours } => format!(
            "prm of {samples} samples ({}), {} m apart, {neighbours} neighbours",
            if *bridge { "bridge" } else { "uniform" },
            number(*separation)
        ),
        RoadmapRule::Rrt { root, samples, step, bias } => {
            let root = match root {
                Goal::Region(id) => scenario.scene.regions[id.0 as usize].name.clone(),
                Goal::Point(p) => point(*p),
            };
            format!("rrt of {samples} samples from {root}, step {} m, bias {}", number(*step), number(*bias))
        }
    }
}

fn velocity(v: Vec2) -> String {
    if v == Vec2::default() { "at rest".to_owned() } else { format!("with velocity {} m/s", point(v)) }
}

/// A route in words.
pub(super) fn way(scenario: &Scenario, route: &Route) -> String {
    match route {
        Route::Onward => "keeps its initial direction".to_owned(),
        Route::OneOf { legs, .. } => format!("goes to one of {} destinations", legs.len()),
        Route::Legs { legs, .. } if legs.is_empty() => "stands".to_owned(),
        Route::Legs { legs, then_leave } => {
            let legs: Vec<String> = legs
                .iter()
                .map(|leg| match leg {
                    Leg::To(Goal::Region(id)) => scenario.scene.regions[id.0 as usize].name.clone(),
                    Leg::To(Goal::Point(p)) => point(*p),
                    Leg::Wait(time) => format!("wait {}", law(time, "s")),
                })
                .collect();
            format!("goes {}{}", legs.join(" -> "), if *then_leave { ", then leaves" } else { "" })
        }
    }
}

/// A number without noise of rounding.
pub(super) fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 {
        return super::number::plain(value);
    }
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// A law as one would write it.
pub fn law(law: &Law, unit: &str) -> String {
    let with = |value: f64| in_unit(value, unit);
    match law {
        Law::Constant(value) => with(*value),
        Law::Random { family, low, high } => {
            let name = self::family(family, unit);
            if low.is_finite() && high.is_finite() {
                format!("{name} in {} .. {}", with(*low), with(*high))
            } else {
                name
            }
        }
    }
}

fn in_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
}

/// A family as one would write it. Of a long list the first values stand for all.
fn family(family: &Family, unit: &str) -> String {
    let with = |value: f64| in_unit(value, unit);
    match family {
        Family::Normal { mean, sd } => format!("normal({}, {})", with(*mean), with(*sd)),
        Family::LogNormal { mean, sd } => format!("lognormal({}, {})", with(*mean), with(*sd)),
        Family::Uniform { low, high } => format!("uniform({}, {})", with(*low), with(*high)),
        Family::UniformInt { low, high } => format!("uniform_int({low}, {high})"),
        Family::Exponential { mean } => format!("exponential({})", with(*mean)),
        Family::Poisson { mean } => format!("poisson({})", number(*mean)),
        Family::Bernoulli { p } => format!("bernoulli({})", number(*p)),
        Family::Beta { mean, sd } => format!("beta({}, {})", with(*mean), with(*sd)),
        Family::Gamma { mean, sd } => format!("gamma({}, {})", with(*mean), with(*sd)),
        Family::Weibull { mean, sd } => format!("weibull({}, {})", with(*mean), with(*sd)),
        Family::Multiple { of, by, .. } => format!("{} * {}", self::family(of, ""), with(*by)),
        Family::Choice(options) => {
            let listed = if options.len() > MOST_LISTED { FEW_LISTED } else { options.len() };
            let mut values: Vec<String> = options[..listed].iter().map(|(value, _)| with(*value)).collect();
            if listed < options.len() {
                values.push(format!("… of {} values", options.len()));
            }
            format!("choice({})", values.join(", "))
        }
    }
}

/// A procedure with the values of its arguments.
fn summary(chosen: &Chosen) -> String {
    chosen.numbers().fold(chosen.spec.summary.to_owned(), |text, (argument, value)| {
        let value = if argument.is_error() { at_most(value).to_string() } else { number(value) };
        text.replace(&format!("{{{}}}", argument.name), &value)
    })
}

fn procedure(ask: &Ask) -> String {
    match ask {
        Ask::Check { test, threshold, .. } => format!("against {}: {}", number(*threshold), summary(test)),
        Ask::Estimate { measure, estimator, .. } => {
            let what = match measure.kind {
                MeasureKind::Probability => "probability",
                MeasureKind::Expectation { level: Some(_), .. } => "mean of the largest values",
                MeasureKind::Expectation { .. } => "expectation",
                MeasureKind::Curve { .. } => "curve",
                MeasureKind::Quantile { .. } => "quantile",
            };
            format!("{what}: {}", summary(estimator))
        }
        Ask::Compare { within, delta, .. } => {
            let trials = match within {
                Some(within) => format!("to ± {}", number(*within)),
                None => format!("from {PLANNED_TRIALS} pairs"),
            };
            format!("difference {trials}, error {}, common random numbers", at_most(*delta))
        }
        Ask::Rank { ranking, measure, beside, .. } => {
            let (epsilon, error) = (number(ranking.value("epsilon")), at_most(ranking.value("delta")));
            let (mut aims, mut constraints) = (vec![epsilon.clone()], Vec::new());
            for one in beside {
                match &one.role {
                    Role::Constraint { text, .. } => constraints.push(format!("{} {text}", one.said)),
                    Role::Aim { epsilon } => aims.push(number(*epsilon)),
                }
            }
            match (constraints.is_empty(), beside.is_empty()) {
                (false, _) => {
                    let all = constraints.join(" and ");
                    format!("best within {epsilon} of those with {all}, error {error}: paired betting")
                }
                (true, false) => format!("front, widths {}, error {error}: paired betting", aims.join(", ")),
                (true, true) if measure.kind.share().is_some() => {
                    format!("best within {epsilon}, error {error}: joint intervals")
                }
                (true, true) => summary(ranking),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law as it was written, whatever it is drawn as.
    #[test]
    fn laws_are_shown_as_they_were_written() {
        let free = |family| Law::Random { family, low: f64::NEG_INFINITY, high: f64::INFINITY };
        let shown = |family: &Family, by: f64, unit| law(&free(family.scaled(by).unwrap()), unit);
        assert_eq!(shown(&Family::Bernoulli { p: 0.1 }, 1.0, "m/s"), "bernoulli(0.1) * 1 m/s");
        assert_eq!(shown(&Family::Poisson { mean: 4.0 }, 0.5, "s"), "poisson(4) * 0.5 s");
        assert_eq!(shown(&Family::UniformInt { low: 1, high: 6 }, 2.0, ""), "uniform_int(1, 6) * 2");
        assert_eq!(shown(&Family::LogNormal { mean: 1.0, sd: 0.1 }, 2.0, "s"), "lognormal(2 s, 0.2 s)");
        let cut =
            Law::Random { family: Family::Poisson { mean: 4.0 }.scaled(1.0).unwrap(), low: 1.0, high: 9.0 };
        assert_eq!(law(&cut, "s"), "poisson(4) * 1 s in 1 s .. 9 s");
        let list = |n: u32| Family::Choice((1..=n).map(|k| (f64::from(k), 1.0 / f64::from(n))).collect());
        assert_eq!(law(&free(list(3)), "m"), "choice(1 m, 2 m, 3 m)");
        assert_eq!(law(&free(list(40)), ""), "choice(1, 2, 3, 4, 5, 6, 7, 8, … of 40 values)");
    }
}
