//! The scene of a config: a glTF file or a built-in.

use super::Scene;
use super::builtin::{self, Atrium, Caustics, Courtyard, Street};
use super::gltf::{self, AnimationChoice, Choice, SceneChoice};
use crate::config::{Builtin, SceneConfig, SceneSelector};
use crate::trace;
use anyhow::Result;

/// Loads or makes the config's scene. Beside it come warnings for the user.
pub fn load_scene(config: &SceneConfig) -> Result<(Scene, Vec<String>)> {
    let _span = trace::span("loading the scene");
    if let Some(path) = &config.file {
        let scene = config.scene.as_ref().map(|selector| match selector {
            SceneSelector::Index(index) => SceneChoice::Index(*index as usize),
            SceneSelector::Name(name) => SceneChoice::Name(name.clone()),
        });
        let animation = match &config.animation {
            None => AnimationChoice::First,
            Some(SceneSelector::Name(name)) if name == "none" => AnimationChoice::None,
            Some(SceneSelector::Name(name)) => AnimationChoice::Name(name.clone()),
            Some(SceneSelector::Index(index)) => AnimationChoice::Index(*index as usize),
        };
        let mut loaded = gltf::load(path, Some(&Choice { scene, animation }))?;
        prepare_triangles(&mut loaded.scene, config);
        return Ok((loaded.scene, loaded.warnings));
    }
    let mut scene = match config.builtin.unwrap_or_default() {
        Builtin::Atrium => builtin::atrium(&Atrium { triangles: config.triangles, seed: config.seed }),
        Builtin::Caustics => builtin::caustics(&Caustics { triangles: config.triangles, roughness: config.roughness }),
        Builtin::Cornell => builtin::cornell(),
        Builtin::Courtyard => builtin::courtyard(&Courtyard { triangles: config.triangles, seed: config.seed }),
        Builtin::Street => builtin::street(&Street { triangles: config.triangles, seed: config.seed }),
    };
    prepare_triangles(&mut scene, config);
    Ok((scene, Vec::new()))
}

fn prepare_triangles(scene: &mut Scene, config: &SceneConfig) {
    if let Some(part) = config.split {
        scene.split_triangles(part);
    }
    scene.sort_triangles();
}
