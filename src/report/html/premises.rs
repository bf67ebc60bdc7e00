//! The premises of an evacuation, as those who approve a building ask for them: the building, its occupants, the model of
//! people, and the runs.

use super::table::Table;
use crate::base::geometry::Segment;
use crate::engine::outcome::CallResult;
use crate::model::{Agent, Leg, Parameter, Route, Scenario};
use crate::report::model::{declared, law, number, way};
use crate::report::number::counted;
use crate::report::{phrase, text};

fn leaves(agent: &Agent) -> bool {
    matches!(agent.route, Route::Legs { then_leave: true, .. })
}

/// The table of a scene that people leave between walls; none of other scenes.
pub(super) fn table(scenario: &Scenario, run: &CallResult) -> Option<Table> {
    let scene = &scenario.scene;
    if scene.barriers.is_empty() || !scenario.agents.iter().any(leaves) {
        return None;
    }
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut row = |name: String, value: String| rows.push(vec![name, value]);
    let walls = scene.walls().map(Segment::length).sum();
    let solids = counted(scene.solids().count() as u64, "obstacle");
    row("building".into(), format!("{} m of walls, {solids}", number(walls)));
    for line in &scene.lines {
        let barrier = scene.barriers.iter().position(|barrier| barrier.name == line.name);
        let changes = |k| scene.doors.iter().any(|door| door.0 as usize == k);
        let state = match barrier {
            Some(k) if changes(k) => ", opens or closes during a trial",
            Some(_) => ", closed",
            None => "",
        };
        row(
            format!("door or line {}", line.name),
            format!("{} m wide{state}", number(line.segment.length())),
        );
    }
    row("occupants".into(), counted(scenario.agents.len() as u64, "person"));
    for members in declared(&scenario.agents) {
        let first = &members[0];
        let speed = law(&first.body[Parameter::Speed], &Parameter::Speed.unit());
        let name = first.name.split('[').next().unwrap_or_default();
        let count = counted(members.len() as u64, "person");
        // The premovement is the first leg of the route.
        let premovement = first.body.premovement.as_ref().map(|time| law(time, "s"));
        let premovement = premovement.unwrap_or_else(|| "none".to_owned());
        let mut route = first.route.clone();
        if let (Some(time), Route::Legs { legs, .. }) = (&first.body.premovement, &mut route)
            && legs.first() == Some(&Leg::Wait(time.clone()))
        {
            legs.remove(0);
        }
        let route = way(scenario, &route);
        row(format!("{name}: {count}"), format!("premovement {premovement}, speed {speed}, {route}"));
    }
    if !run.people.is_empty() {
        let people = run.people.join(", ");
        row("model".into(), format!("{people}; how right it is: docs/people.md, docs/validation.md"));
    }
    row("program".into(), format!("smc {}, seed {}", run.version, run.seed));
    for result in &run.results {
        let certified = phrase::certified(result);
        let stated = if certified.is_empty() { "nothing is certified".to_owned() } else { certified };
        row(result.asked.text.clone(), format!("{}; {stated}", text::trials(result)));
    }
    Some(Table {
        title: "Premises".into(),
        note: "The building, who is in it, the model of people, and how many runs there are and why they are enough.".into(),
        columns: vec!["what", "value"],
        rows,
    })
}
