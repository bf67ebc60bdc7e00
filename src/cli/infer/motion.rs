//! The model of motion of a call: `--motion`, and for the social force `--kind`, `--scene` and `--data`.

use super::arguments::{InferCommand, MotionModel};
use crate::cli::complaint;
use crate::cli::inputs;
use crate::cli::terminal::Colors;
use crate::cli::values::Model;
use crate::compile::presets::PRESETS;
use crate::compile::study::World;
use crate::model::{Barrier, Scene};
use crate::perception::{ConstantVelocity, Motion, SocialForce, Standing};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;
use std::path::PathBuf;

/// The preset of people without `--kind`.
const PRESET: &str = "smc1";

/// A model of motion, and where it comes from.
pub(super) struct ChosenMotion {
    pub(super) motion: Box<dyn Motion>,
    /// The preset or kind of people, if it matters.
    pub(super) kind: Option<String>,
    /// The scene of `--scene`.
    pub(super) scene: Scene,
    /// The texts and files that were read for it.
    pub(super) sources: Vec<Source>,
    pub(super) paths: Vec<PathBuf>,
}

/// The model of motion that a call asks for.
///
/// # Errors
/// An option that does not fit, or an unknown kind. What is wrong with the scene is written at once, with its text, and
/// leaves no error to write.
pub(super) fn chosen(arguments: &InferCommand, colors: Colors) -> Result<ChosenMotion, Vec<Diagnostic>> {
    let without_scene = |motion, kind| ChosenMotion {
        motion,
        kind,
        scene: Scene::default(),
        sources: Vec::new(),
        paths: Vec::new(),
    };
    let plain = |motion| Ok(without_scene(motion, None));
    if arguments.motion != MotionModel::SocialForce {
        let given = [("--kind", &arguments.kind), ("--scene", &arguments.scene)];
        if let Some((option, _)) = given.iter().find(|(_, value)| value.is_some()) {
            let said = format!("`{option}` needs the social force");
            return Err(complaint::argument(said, "add `--motion social-force`").into());
        }
    }
    match arguments.motion {
        MotionModel::Constant => plain(Box::new(ConstantVelocity)),
        MotionModel::Standing => plain(Box::new(Standing)),
        MotionModel::SocialForce => {
            let kind = arguments.kind.as_deref().unwrap_or(PRESET);
            if let Some(scenario) = &arguments.scene {
                return in_scene(arguments, (scenario, kind), colors);
            }
            Ok(without_scene(of_kind(kind, None, Vec::new())?, Some(kind.to_owned())))
        }
    }
}

fn in_scene(
    arguments: &InferCommand,
    (scenario, kind): (&str, &str),
    colors: Colors,
) -> Result<ChosenMotion, Vec<Diagnostic>> {
    let model = Model { scenario: scenario.to_owned(), data: arguments.data.clone(), ..Model::default() };
    let (study, inputs::Loaded { inputs, paths }) =
        inputs::load_or_tell(&model, &[], colors).ok_or_else(Vec::new)?;
    let world = study.worlds.get(study.base).ok_or_else(Vec::new)?;
    let scene = world.scenario.scene.clone();
    let motion = of_kind(kind, Some(world), scene.barriers.clone())?;
    Ok(ChosenMotion { motion, kind: Some(kind.to_owned()), scene, sources: inputs.sources, paths })
}

/// People of a kind of a scene, or else with the parameters of a preset.
fn of_kind(name: &str, scene: Option<&World>, barriers: Vec<Barrier>) -> Result<Box<dyn Motion>, Diagnostic> {
    let declared = scene.and_then(|world| world.kinds.get(name));
    let motion = match declared {
        Some(body) => SocialForce::new(body, barriers),
        None => SocialForce::preset(name, barriers),
    };
    if let Some(motion) = motion {
        return Ok(Box::new(motion));
    }
    let kinds = scene.into_iter().flat_map(|world| &world.kinds);
    let forced = kinds.filter(|(_, body)| SocialForce::new(body, Vec::new()).is_some());
    let known: Vec<&str> =
        forced.map(|(name, _)| name.as_str()).chain(PRESETS.iter().map(|preset| preset.name)).collect();
    if declared.is_some() {
        let said = format!("no force moves agents of the kind `{name}`");
        return Err(complaint::argument(said, format!("write one of {}", known.join(", "))));
    }
    let said = if scene.is_some() {
        format!("`{name}` is neither a preset nor a kind of the scene with all parameters")
    } else {
        format!("unknown preset `{name}`; kinds are declared in a `--scene`")
    };
    Err(complaint::argument(said, complaint::meant(name, &known, "write one of")))
}
