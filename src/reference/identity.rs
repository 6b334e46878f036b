//! What a truth is of.

use super::Settings;
use crate::config::Config;
use crate::scene::Scene;

/// A hash of all of a scene that light depends on.
pub fn scene_digest(scene: &Scene) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytemuck::cast_slice(&scene.vertices)).update(bytemuck::cast_slice(&scene.indices));
    for texture in &scene.textures {
        hasher.update(&texture.texels);
    }
    let textures: Vec<_> = scene.textures.iter().map(|t| (t.width, t.height, t.srgb)).collect();
    let rest = (&scene.draws, &scene.materials, textures, &scene.cameras, &scene.lights);
    hasher.update(format!("{rest:?}").as_bytes());
    if let Some(animation) = &scene.animation {
        hasher.update(format!("{animation:?}").as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

/// What must be the same for a run to go on from an earlier one: a hash of the scene's [`scene_digest`] and of all else that its
/// light depends on, beside the shader.
pub fn identity(config: &Config, settings: Settings, digest: &str) -> String {
    let config = (&config.camera, &config.light, &config.materials, config.frame.size, config.frame.fps, config.frame.seed);
    blake3::hash(format!("{digest} {config:?} {settings:?}").as_bytes()).to_hex().to_string()
}
