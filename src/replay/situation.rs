//! A model with a recording, compiled at one instant after the other.

use super::Diagnosed;
use super::cast::Cast;
use super::course::{Beyond, course};
use super::formulas::Formulas;
use super::instants::{Instant, instants};
use super::source::source;
use crate::advise::groups;
use crate::base::geometry::Vec2;
use crate::compile::study::Study;
use crate::compile::{Files, Input, Seen, Setting, Sighting, Site, examine};
use crate::data::tracks::{PersonState, Recording, Velocity};
use crate::model::{Agent, AgentId};
use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::{Source, SourceId};

/// Who is the user of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    /// Whom the model names.
    Written,
    /// Somebody else.
    Person(u32),
    /// One after the other, everybody.
    Everybody,
}

/// A model with a recording.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Name of the tracks.
    pub tracks: String,
    /// The recording, with the velocities that the people of the model have.
    pub recording: Recording,
    /// The recording as it is in the file.
    pub(super) recorded: Recording,
    /// Whose instants they are.
    pub whose: Whose,
    /// The properties.
    pub formulas: Formulas,
    pub(super) scenario: ScenarioFile,
    /// All texts; those of properties and kinds come last.
    pub sources: Vec<Source>,
    cast: Cast,
    files: Files,
    settings: Vec<Setting>,
}

impl Replay {
    /// A model with the recording of its tracks of a name.
    ///
    /// # Errors
    /// Where the model or the recording cannot be read, they do not fit together, or there is nothing to ask.
    pub fn new(input: &Input<'_>, tracks: &str, velocity: Velocity, whose: Whose) -> Diagnosed<Self> {
        Self::at_site(input, tracks, velocity, whose, |_| Ok(None))
    }

    /// The same, with the laws of a site that the recording itself tells.
    ///
    /// # Errors
    /// As `new`, and those of the laws.
    pub fn at_site(
        input: &Input<'_>,
        tracks: &str,
        velocity: Velocity,
        whose: Whose,
        site: impl FnOnce(&Self) -> Result<Option<Site>, Diagnostic>,
    ) -> Diagnosed<Self> {
        let file = source(input.scenario, input.files, tracks).map_err(|one| vec![one])?;
        let recorded = file.recording().map_err(|error| vec![error])?;
        let cast = Cast::of(input.scenario, tracks)?;
        let who = match whose {
            Whose::Written => Some(cast.person),
            Whose::Person(id) => Some(id),
            Whose::Everybody => None,
        };
        if who != Some(cast.person) {
            cast.is_open().map_err(|error| vec![error])?;
        }
        if let Some(id) = who.filter(|id| recorded.person(*id).is_none()) {
            let error = Diagnostic::placeless(Code::E0703, format!("person {id} is not in the recording"));
            return Err(vec![error.hint("choose another with `--user`")]);
        }
        let mut replay = Self {
            tracks: tracks.to_owned(),
            recording: recorded.clone().with(velocity),
            recorded,
            whose,
            formulas: Formulas::default(),
            scenario: input.scenario.clone(),
            sources: input.sources.to_vec(),
            cast,
            files: without_tracks(input, tracks),
            settings: input.settings.to_vec(),
        };
        replay.files.columns = Some(replay.recording.columns().map(str::to_owned).collect());
        if let Some(site) = site(&replay).map_err(|error| vec![error])? {
            replay.files.site = Some(site);
        }
        replay.ask(input)?;
        Ok(replay)
    }

    /// Asks for all properties, and reports what is wrong with the model at the first instant.
    fn ask(&mut self, input: &Input<'_>) -> Diagnosed<()> {
        self.formulas = Formulas::of(input.properties, SourceId(self.sources.len() as u16));
        self.sources.push(self.formulas.source.clone());
        if self.formulas.names.is_empty() && !self.formulas.has_numbers && !input.properties.is_empty() {
            let error = Diagnostic::placeless(Code::E0705, "the property files name no property");
            let hint = "write one: `property safe = G<=4.8 s (distance(user, friend) > 0.5 m)`";
            return Err(vec![error.hint(hint)]);
        }
        let first = self.instants(self.recording.step(), (f64::NEG_INFINITY, f64::INFINITY)).first().copied();
        match first.map(|first| self.study_at(first)) {
            Some(Err(errors)) if !errors.iter().all(is_of_a_place) => Err(errors),
            _ => Ok(()),
        }
    }

    /// The one whose instants they are; `None` where everybody is the user in turn.
    pub fn only(&self) -> Option<u32> {
        match self.whose {
            Whose::Written => Some(self.cast.person),
            Whose::Person(id) => Some(id),
            Whose::Everybody => None,
        }
    }

    /// All instants of everybody, every so many seconds.
    pub(super) fn everybody(&self, every: f64) -> Vec<Instant> {
        instants(&self.recording, every, None, (f64::NEG_INFINITY, f64::INFINITY))
    }

    /// All instants between two times, s, every so many seconds.
    pub fn instants(&self, every: f64, between: (f64, f64)) -> Vec<Instant> {
        instants(&self.recording, every, self.only(), between)
    }

    /// The id that a person has in the model: whoever is the user changes places with the one whom the model names.
    pub(super) fn written(&self, user: u32, id: u32) -> u32 {
        match id {
            id if id == user => self.cast.person,
            id if id == self.cast.person => user,
            id => id,
        }
    }

    /// The place of the user among the agents of the model.
    pub(super) fn place_of_user(&self, agents: &[Agent]) -> usize {
        agents.iter().position(|agent| agent.start.seen.contains(&self.cast.person)).unwrap_or(0)
    }

    /// The model with those who are there at an instant.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn study_at(&self, instant: Instant) -> Diagnosed<Study> {
        let Instant { time, person } = instant;
        let present = self.recording.at(time).into_iter();
        let mut people: Vec<_> = present.map(|one| sighting(self.written(person, one.id), &one)).collect();
        people.sort_by_key(|one| one.id);
        let past = people.iter().map(|one| (one.id, self.past(self.written(person, one.id), time))).collect();
        let seen = Seen { groups: groups(&people), people, past };
        let mut files = self.files.clone();
        files.see(self.tracks.clone(), seen);
        let examined = examine(&Input {
            sources: &self.sources,
            scenario: &self.scenario,
            properties: &self.formulas.files,
            files: &files,
            settings: &self.settings,
        });
        let errors: Vec<Diagnostic> =
            examined.found.into_iter().filter(|one| one.severity == Severity::Error).collect();
        examined.study.filter(|_| errors.is_empty()).ok_or(errors)
    }

    /// The model at an instant; `None` where its people have no place there.
    pub(super) fn study_if_placed(&self, instant: Instant) -> Diagnosed<Option<Study>> {
        match self.study_at(instant) {
            Ok(study) => Ok(Some(study)),
            Err(errors) if !errors.is_empty() && errors.iter().all(is_of_a_place) => Ok(None),
            Err(errors) => Err(errors),
        }
    }

    /// Where a person is at a time of the recording.
    pub(super) fn place_at(&self, id: u32, time: f64) -> Option<Vec2> {
        Some(course(&self.recording, id, time, Beyond::Unresolved)?.0)
    }

    /// The agents that are one recorded person, with the person that each is where `user` is the user.
    pub(super) fn persons(&self, user: u32, agents: &[Agent]) -> impl Iterator<Item = (AgentId, u32)> {
        agents.iter().enumerate().filter_map(move |(k, agent)| match agent.start.seen[..] {
            [id] => Some((AgentId(k as u32), self.written(user, id))),
            _ => None,
        })
    }

    /// Times, s, and positions, m, of somebody up to a time.
    fn past(&self, id: u32, time: f64) -> Vec<(f64, Vec2)> {
        let Some(person) = self.recording.person(id) else { return Vec::new() };
        let all = person.samples.iter().map(|sample| (self.recording.time_of(sample.frame), sample.position));
        all.take_while(|(then, _)| *then <= time + 1e-6).collect()
    }
}

/// The files of a model but for the recording, which is seen instant by instant.
fn without_tracks(input: &Input<'_>, tracks: &str) -> Files {
    let mut files = input.files.clone();
    for item in &input.scenario.items {
        if let Item::Tracks { name, file: Some((_, path)), .. } = item
            && name.name == tracks
        {
            files.provide(path.value.clone(), Ok(Vec::new()));
        }
    }
    files
}

/// Whether an error is about where somebody stands: another instant may have none.
fn is_of_a_place(error: &Diagnostic) -> bool {
    matches!(error.code, Code::E0409 | Code::E0801 | Code::E0802 | Code::E0803)
}

/// A person as a model sees them.
pub(super) fn sighting(id: u32, PersonState { position, velocity, .. }: &PersonState) -> Sighting {
    Sighting::new(id, *position, *velocity)
}
