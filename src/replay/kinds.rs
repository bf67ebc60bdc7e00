//! The same model with people of another kind.

use super::Diagnosed;
use super::situation::Replay;
use crate::compile::presets::PRESETS;
use crate::model::Kind;
use crate::syntax::ast::{Field, Ident, Item, Recorded, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::parse::parse_scenario;
use crate::syntax::source::{Source, SourceId, Span};

/// The kind without forces: everybody keeps the velocity. Its radius is that of the user.
pub const CONSTANT: &str = "constant";

/// The kind of a plain Langevin walker: no forces, and a noise of 0.2 m/s around the recorded velocity, which we chose.
pub const LANGEVIN: &str = "langevin";
const LANGEVIN_NOISE: f64 = 0.2;

/// The preset of a kind that names none.
const USUAL: &str = "helbing2000";

/// Fields of agents and groups that would change the velocity.
const CHANGING: [&str; 4] = ["heading", "speed", "route", "attraction"];

/// Parameters of the kinds without forces: no force, and the time in which velocities return to the recorded ones.
const FREE: [(&str, &str); 7] = [
    ("A", "0 N"),
    ("A2", "0 N"),
    ("k1", "0 kg/s^2"),
    ("k2", "0 kg/(m s)"),
    ("headway", "0 s"),
    ("composure", "0"),
    ("tau", "0.5 s"),
];

/// A scenario all of whose people have the kind of a name: one that it declares, a preset or the beginning of the name of
/// one, `constant` or `langevin`. Where the kind is not declared, its text is a source of its own.
///
/// # Errors
/// Where there is no such kind.
fn with_kind(
    file: &ScenarioFile,
    name: &str,
    id: SourceId,
) -> Result<(ScenarioFile, Option<Source>), Diagnostic> {
    let mut changed = file.clone();
    let declared: Vec<&str> = (file.items.iter())
        .filter_map(|item| if let Item::Kind(kind) = item { Some(kind.name.name.as_str()) } else { None })
        .collect();
    let mut radius = None;
    let added = match (declared.contains(&name), preset(name)) {
        (true, _) => None,
        (false, _) if is_free(name) => {
            let noise = if name == LANGEVIN { LANGEVIN_NOISE } else { 0.0 };
            let (preset, own) = body_of_user(file);
            // Only a kind of forces has forces to be without; of another one the radius alone is taken over.
            let is_forced = PRESETS.iter().any(|known| known.name == preset && known.model == Kind::Sfm);
            let preset = if is_forced { preset } else { USUAL };
            radius = own.cloned();
            let free: String = FREE.iter().map(|(name, value)| format!("{name} = {value}; ")).collect();
            Some(format!("kind {name}: sfm preset {preset} {{ {free}noise = {noise} m/s }}\n"))
        }
        (false, Some(preset)) => Some(format!("kind {name}: preset {preset} {{ }}\n")),
        (false, None) => {
            let presets = PRESETS.iter().map(|preset| preset.name);
            let known: Vec<&str> = declared.into_iter().chain(presets).chain([CONSTANT, LANGEVIN]).collect();
            let said = format!("there is no kind `{name}`");
            return Err(
                Diagnostic::placeless(Code::E0705, said).hint(format!("the kinds are {}", known.join(", ")))
            );
        }
    };
    let source = added.map(|text| Source::new(id, format!("--kinds {name}"), text));
    if let Some(source) = &source {
        let (mut kind, _) = parse_scenario(source);
        if let Some(Item::Kind(kind)) = kind.items.first_mut() {
            kind.body.extend(radius);
        }
        changed.items.splice(0..0, kind.items);
    }
    for item in &mut changed.items {
        let (kind, body) = match item {
            Item::Agents(decl) if decl.recorded.is_some() => (&mut decl.kind, &mut decl.body),
            Item::Group(decl) if decl.recorded.is_some() => (&mut decl.kind, &mut decl.body),
            _ => continue,
        };
        name.clone_into(&mut kind.name);
        if is_free(name) {
            let is_free = |name: &str| name == "noise" || FREE.iter().any(|(free, _)| *free == name);
            body.retain(|Field { name, .. }| !CHANGING.contains(&name.name.as_str()) && !is_free(&name.name));
        }
    }
    Ok((changed, source))
}

/// The preset of the kind of the user, and the radius that the kind sets.
fn body_of_user(file: &ScenarioFile) -> (&str, Option<&Field>) {
    let (mut next, mut radius) = (kind_of_user(file), None);
    // A kind starts from one that is declared; no more steps than there are declarations, whatever circle there is.
    for _ in &file.items {
        let kind = file.items.iter().find_map(|item| match item {
            Item::Kind(kind) if Some(kind.name.name.as_str()) == next => Some(kind),
            _ => None,
        });
        let Some(kind) = kind else { break };
        radius = radius.or_else(|| kind.body.iter().find(|field| field.name.name == "radius"));
        if let Some(preset) = &kind.preset {
            return (&preset.name, radius);
        }
        next = kind.base.as_ref().map(|base| base.name.as_str());
    }
    (USUAL, radius)
}

/// Whether people of a kind feel nobody.
fn is_free(name: &str) -> bool {
    matches!(name, CONSTANT | LANGEVIN)
}

impl Replay {
    /// The same with people who all have the kind of a name.
    ///
    /// # Errors
    /// Where there is no such kind.
    pub fn with_kind(&self, name: &str) -> Diagnosed<Self> {
        let id = SourceId(self.sources.len() as u16);
        let (scenario, source) = with_kind(&self.scenario, name, id).map_err(|error| vec![error])?;
        let mut own = self.clone();
        own.scenario = scenario;
        own.sources.extend(source);
        Ok(own)
    }

    /// What a kind starts from: a kind of the model by its name, or else a preset.
    pub fn base_of(&self, name: &str) -> String {
        let is_own = |item: &Item| matches!(item, Item::Kind(kind) if kind.name.name == name);
        match preset(name).filter(|_| !self.scenario.items.iter().any(is_own)) {
            Some(preset) => format!("sfm preset {preset}"),
            None => name.to_owned(),
        }
    }

    /// Where the tracks are declared.
    pub fn place_of_tracks(&self) -> Option<Span> {
        self.scenario.items.iter().find_map(|item| match item {
            Item::Tracks { name, .. } if name.name == self.tracks => Some(name.span),
            _ => None,
        })
    }
}

/// The name of the tracks of the first people of a model who were recorded.
pub fn first_tracks(file: &ScenarioFile) -> Option<String> {
    file.items.iter().find_map(|item| Some(recorded(item)?.1.tracks.name.clone()))
}

/// The kind of the first people of a model.
pub fn user_kind(replay: &Replay) -> Option<String> {
    kind_of_user(&replay.scenario).map(str::to_owned)
}

fn kind_of_user(file: &ScenarioFile) -> Option<&str> {
    file.items.iter().find_map(|item| Some(recorded(item)?.0.name.as_str()))
}

/// The kind of people who were recorded, and from where they are.
fn recorded(item: &Item) -> Option<(&Ident, &Recorded)> {
    match item {
        Item::Agents(decl) => Some((&decl.kind, decl.recorded.as_ref()?)),
        Item::Group(decl) => Some((&decl.kind, decl.recorded.as_ref()?)),
        _ => None,
    }
}

/// The preset of a name, or the only one whose name begins so.
fn preset(name: &str) -> Option<&'static str> {
    let mut found = PRESETS.iter().map(|preset| preset.name).filter(|known| known.starts_with(name));
    match (found.next(), found.next()) {
        (Some(one), None) => Some(one),
        _ => PRESETS.iter().map(|preset| preset.name).find(|known| *known == name),
    }
}
