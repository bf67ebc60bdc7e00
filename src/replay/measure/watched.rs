//! The scenario in which a recording is shown: a scene, a slot for each person, and the numbers that are read in each state.

use super::{Ground, Measuring, Number};
use crate::base::geometry::Vec2;
use crate::base::random::TrialKey;
use crate::compile::study::{Ask, MeasureKind, World};
use crate::compile::{Input, compile};
use crate::data::tracks::Recording;
use crate::kernel::{Code, Program, Readings, Run};
use crate::logic::{Root, Term, TermId};
use crate::model::{AgentId, Scene};
use crate::replay::Diagnosed;
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code as ErrorCode;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::parse::{parse_properties, parse_scenario};
use crate::syntax::source::{Source, SourceId};
use std::sync::Arc;

/// Flows have at most this window, however short the recording is, s.
const LONGEST_WINDOW: f64 = 3600.0;

/// Where nobody of the recording is ever put: a source needs a place.
const AWAY: &str = "(123456, 123456)";

/// How a number of a state is read.
#[derive(Clone, Copy, Debug)]
enum Reading {
    Signal(usize),
    Constant(f64),
}

/// A scene with numbers, ready to be shown a recording.
pub(super) struct Prepared {
    program: Program,
    code: Code,
    pub(super) numbers: Vec<Number>,
    readings: Vec<Reading>,
    /// Other columns that a number may name.
    columns: Vec<String>,
}

impl Prepared {
    /// Compiles the scene of some ground with a slot for each person.
    pub(super) fn new(
        recording: &Recording,
        ground: &mut Ground,
        options: &Measuring,
        frames: usize,
    ) -> Diagnosed<Self> {
        ground.files.columns = Some(recording.columns().map(str::to_owned).collect());
        let people = recording.people().len().max(1);
        let (step, radius) = (recording.step(), options.radius);
        let ticks = frames + (LONGEST_WINDOW / step).ceil() as usize;
        // Who is shown is moved by nobody.
        let text = format!(
            "horizon = {ticks} * {step} s\nstep = {step} s\n\
             kind recorded_person: sfm preset helbing2000 {{ A = 0 N; k1 = 0 kg/s^2; k2 = 0 kg/(m s); noise = 0 m/s; tau = 1000 s; radius = {radius} m }}\n\
             source recorded_people: recorded_person {{ at = {AWAY}; every = 1 s; route = {AWAY}; limit = {people} }}\n"
        );
        let shown = Source::new(SourceId(ground.sources.len() as u16), "the recording", text);
        ground.sources.push(shown.clone());
        let mut scenario = ground.scenario.clone();
        let is_ground =
            |item: &Item| matches!(item, Item::Scene(_) | Item::Param { .. } | Item::Const { .. });
        scenario.items.retain(is_ground);
        scenario.items.extend(parse_scenario(&shown).0.items);
        // A window is a whole number of frames, whatever their rate is.
        let window = (options.window, (options.window / step).round().max(1.0) as u64);
        let numbers = match options.numbers.as_slice() {
            [] => of_scene(&world_of(&scenario, ground, None)?.0.scenario.scene, window),
            given => given.iter().map(|number| (number.clone(), number.clone())).collect(),
        };
        let queries: String =
            numbers.iter().map(|(_, number)| format!("estimate Q(0.5, {number} at end)\n")).collect();
        let asked = Source::new(SourceId(ground.sources.len() as u16), "--number", queries);
        ground.sources.push(asked.clone());
        let (world, asked) = world_of(&scenario, ground, Some(&asked))?;
        let reading = |(k, (column, _)): (usize, &(usize, String))| {
            reading(&world, *column).ok_or_else(|| {
                let said = format!("`{}` is not a number of one state", numbers[k].0);
                let hint = "measure what a state says, such as `density(hall)` or `flow(door, 10 s)`";
                vec![Diagnostic::placeless(ErrorCode::E0705, said).hint(hint)]
            })
        };
        let readings: Vec<Reading> = asked.iter().enumerate().map(reading).collect::<Result<_, _>>()?;
        let program = Program::new(Arc::clone(&world.scenario));
        let code = Code::compile(&world.scenario, &[], &world.signals);
        let numbers =
            numbers.into_iter().zip(asked).map(|((name, _), (_, unit))| Number { name, unit }).collect();
        // Numbers of the scene itself name none.
        let columns = ground.files.columns.take().filter(|_| !options.numbers.is_empty()).unwrap_or_default();
        Ok(Self { program, code, numbers, readings, columns })
    }

    /// The scene.
    pub(super) fn scene(&self) -> &Scene {
        &self.program.scenario.scene
    }
}

/// A world, and the column and the unit of each query.
type Asked = (World, Vec<(usize, String)>);

/// The world of a scenario, with the queries of a source.
fn world_of(scenario: &ScenarioFile, ground: &Ground, queries: Option<&Source>) -> Diagnosed<Asked> {
    let properties: Vec<_> = queries.iter().map(|source| parse_properties(source)).collect();
    let wrong = |found: &[Diagnostic]| -> Vec<Diagnostic> {
        found.iter().filter(|one| one.severity == Severity::Error).cloned().collect()
    };
    let errors = properties.iter().map(|(_, found)| wrong(found)).find(|errors| !errors.is_empty());
    if let Some(errors) = errors {
        return Err(errors);
    }
    let properties: Vec<_> = properties.into_iter().map(|(file, _)| file).collect();
    let Ground { sources, files, settings, .. } = ground;
    let input = Input { sources, scenario, properties: &properties, files, settings };
    let (study, found) = compile(&input);
    if let Some(beyond) = found.iter().find(|one| one.code == ErrorCode::E0502) {
        let of_a_state = "measure what a state says, such as `density(hall)` or `flow(door, 10 s)`";
        let place = beyond.place.clone().map(|place| place.span);
        let said = "this is not a number of one state";
        let error = place.map_or_else(
            || Diagnostic::placeless(ErrorCode::E0705, said),
            |span| Diagnostic::error(ErrorCode::E0705, span, said),
        );
        return Err(vec![error.hint(of_a_state)]);
    }
    let Some(mut study) = study else { return Err(wrong(&found)) };
    let of = |ask: &Ask| match ask {
        Ask::Estimate { measure, .. } => match &measure.kind {
            MeasureKind::Quantile { dimension, .. } => Some((measure.target.column, dimension.to_string())),
            _ => None,
        },
        _ => None,
    };
    let asked = study.queries.iter().filter_map(|query| of(&query.ask)).collect();
    let base = study.base;
    Ok((study.worlds.swap_remove(base), asked))
}

/// How the number of a column is read from a state.
fn reading(world: &World, column: usize) -> Option<Reading> {
    let Root::Metric(term) = world.columns[column].root else { return None };
    let of = |term: TermId| &world.tree.terms[term.0 as usize];
    let Term::AtEnd(inner) = of(term) else { return None };
    match of(*inner) {
        Term::Signal(signal) => Some(Reading::Signal(signal.0 as usize)),
        Term::Constant(value) => Some(Reading::Constant(*value)),
        _ => None,
    }
}

/// The numbers of all regions and lines of a scene whose names can be written: their names, and what is asked. Flows have a
/// window, s, of so many frames.
fn of_scene(scene: &Scene, (window, frames): (f64, u64)) -> Vec<(String, String)> {
    let is_name = |name: &str| {
        let mut letters = name.chars();
        letters.next().is_some_and(|first| first.is_alphabetic() || first == '_')
            && letters.all(|c| c.is_alphanumeric() || c == '_')
    };
    let regions = scene.regions.iter().map(|region| &region.name).filter(|name| is_name(name));
    let lines = scene.lines.iter().map(|line| &line.name).filter(|name| is_name(name));
    let of_region = |name: &String| {
        ["density", "voronoi_density", "mean_speed", "level_of_service"]
            .map(|number| format!("{number}({name})"))
    };
    let alike = |number: String| (number.clone(), number);
    let of_line = |name: &String| {
        [
            alike(format!("crossings({name})")),
            (format!("flow({name}, {window} s)"), format!("flow({name}, #{frames})")),
        ]
    };
    regions.flat_map(of_region).map(alike).chain(lines.flat_map(of_line)).collect()
}

/// A recording that is shown, frame by frame.
pub(super) struct Watched<'p> {
    prepared: &'p Prepared,
    run: Run<'p>,
    read: Readings,
    /// Persons by the time of their first sample, who come next, and who may be there; each with the number of the slot.
    coming: Vec<(f64, f64, u32, usize)>,
    next: usize,
    present: Vec<(f64, u32, usize)>,
    slots: Vec<Option<(Vec2, Vec2)>>,
    seen: Vec<(Vec2, Vec2)>,
}

impl<'p> Watched<'p> {
    /// Before the first frame.
    pub(super) fn new(recording: &Recording, prepared: &'p Prepared) -> Diagnosed<Self> {
        let run = Run::given(&prepared.program, TrialKey::default())
            .map_err(|_| vec![Diagnostic::placeless(ErrorCode::E0705, "the scene cannot be shown")])?;
        let all = recording.people().iter().enumerate();
        let mut coming: Vec<(f64, f64, u32, usize)> = all
            .filter_map(|(slot, person)| {
                let (from, to) = recording.presence(person.id)?;
                Some((from, to, person.id, slot))
            })
            .collect();
        coming.sort_by(|a, b| a.0.total_cmp(&b.0));
        let slots = vec![None; coming.len()];
        Ok(Self {
            prepared,
            run,
            read: Readings::default(),
            coming,
            next: 0,
            present: Vec::new(),
            slots,
            seen: Vec::new(),
        })
    }

    /// Shows a frame; where everybody is, and how fast.
    pub(super) fn show(&mut self, recording: &Recording, tick: u64, time: f64) -> &[(Vec2, Vec2)] {
        while let Some((_, to, id, slot)) =
            self.coming.get(self.next).filter(|(from, ..)| *from <= time + 1e-6)
        {
            self.present.push((*to, *id, *slot));
            self.next += 1;
        }
        for (_, _, slot) in &self.present {
            self.slots[*slot] = None;
        }
        self.present.retain(|(to, ..)| *to >= time - 1e-6);
        self.seen.clear();
        for (_, id, slot) in &self.present {
            if let Some(state) = recording.person_at(*id, time) {
                self.slots[*slot] = Some((state.position, state.velocity));
                self.seen.push((state.position, state.velocity));
            }
        }
        let slots = &self.slots;
        self.run.show(tick, |AgentId(slot)| slots.get(slot as usize).copied().flatten());
        let columns = &self.prepared.columns;
        self.run.tell(columns.len(), |column, AgentId(slot)| {
            let shown = slots.get(slot as usize).is_some_and(Option::is_some);
            let person = recording.people().get(slot as usize).filter(|_| shown);
            person.and_then(|one| recording.column(&columns[column], one.id, time)).unwrap_or(f64::NAN)
        });
        &self.seen
    }

    /// The numbers of the state that is shown.
    pub(super) fn read(&mut self) -> Vec<f64> {
        self.run.read(&self.prepared.code, None, &mut self.read);
        let read = &self.read;
        let value = |reading: &Reading| match reading {
            Reading::Constant(value) => *value,
            Reading::Signal(k) if read.missing.1.get(*k).is_some_and(|lanes| lanes.has(0)) => f64::NAN,
            Reading::Signal(k) => read.signals[*k].0[0],
        };
        self.prepared.readings.iter().map(value).collect()
    }
}
