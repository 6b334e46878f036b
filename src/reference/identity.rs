//! Identity of a ground truth.

use super::Settings;
use crate::config::{Config, LightConfig};
use crate::scene::Scene;
use crate::scene::bend::Bending;
use std::path::PathBuf;

/// Hash of all parts of a scene that light depends on.
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
    if let Some(Bending { rest, influences, deltas, joints, meshes, pose: _ }) = &scene.bending {
        hasher.update(bytemuck::cast_slice(rest)).update(bytemuck::cast_slice(influences)).update(bytemuck::cast_slice(deltas));
        hasher.update(format!("{joints:?} {meshes:?}").as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

/// Condition for resuming a run: a hash of the `digest` and of all other inputs that light depends on, except the shader. The digest is the
/// [`scene_digest`], and that of the environment's map ([`SkyMap::digest`](crate::scene::sky::SkyMap)) after it if there is one.
pub fn identity(config: &Config, settings: Settings, digest: &str) -> String {
    blake3::hash(identified(config, settings, digest).as_bytes()).to_hex().to_string()
}

/// Text that [`identity`] hashes. A test pins it: ground truths are kept for years under it, and renaming a type must not invalidate them.
fn identified(config: &Config, settings: Settings, digest: &str) -> String {
    let mut lights = config.light.clone();
    for light in &mut lights {
        if let LightConfig::Environment { map: Some(map), .. } = light {
            // The digest has the map's content. Where the file lies does not matter.
            *map = PathBuf::new();
        }
    }
    let config = (&config.camera, &lights, &config.materials, config.frame.size, config.frame.fps, config.frame.seed);
    let text = format!("{digest} {config:?} {settings:?}");
    // Keys that came later are left out where they have no effect.
    text.replace(", map: None, rotation_deg: 0.0", "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;
    use std::path::Path;

    #[test]
    fn a_truth_is_known_by_the_same_words_as_ever() {
        let text = "frame.size = [64, 32]\nmaterials.dielectric = \"ggx\"\n\
            [camera]\nfov_y_deg = 50\nkeyframes = [{ time = 0, position = [0, 1, 2], target = [0, 0, 0] }]\n\
            [[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nirradiance = [1, 1, 1]\n\
            [[light]]\nkind = \"spot\"\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nintensity = [1, 1, 1]\n\
            [[light.keyframes]]\ntime = 1\nposition = [1, 3, 0]\n\
            [[light]]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity = [1, 1, 1]\n\
            [[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n";
        let config = config::parse(text, Path::new("x.toml"), &[]).unwrap().config;
        let settings = Settings { bounces: 2, frame_index: 3, min_distance: 0.5, centered: true };
        let expected = "digest (Some(CameraConfig { position: None, target: None, up: None, fov_y_deg: Some(50.0), node: None, interpolation: Linear, \
            keyframes: [CameraKeyframe { time: 0.0, position: [0.0, 1.0, 2.0], target: [0.0, 0.0, 0.0], fov_y_deg: None }] }), \
            [Directional { direction: Some([0.0, -1.0, 0.0]), position: None, target: None, irradiance: [1.0, 1.0, 1.0], keyframes: [] }, \
            Spot { position: [0.0, 3.0, 0.0], direction: None, target: Some([0.0, 0.0, 0.0]), intensity: [1.0, 1.0, 1.0], inner_deg: None, \
            outer_deg: 40.0, keyframes: [LightKeyframe { time: 1.0, position: Some([1.0, 3.0, 0.0]), direction: None, target: None, \
            intensity: None, irradiance: None }] }, Point { position: [0.0, 3.0, 0.0], intensity: [1.0, 1.0, 1.0], keyframes: [] }, \
            Environment { radiance: [1.0, 1.0, 1.0] }], MaterialsConfig { dielectric: Ggx }, [64, 32], 30.0, 0) \
            Settings { bounces: 2, frame_index: 3, min_distance: 0.5, centered: true }";
        assert_eq!(identified(&config, settings, "digest"), expected);
        // A map is known by its content, wherever it lies.
        let at = |map: &str| {
            let text = format!("[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\nmap = \"{map}\"\nrotation_deg = 5");
            config::parse(&text, Path::new("x.toml"), &[]).unwrap().config
        };
        assert_eq!(identified(&at("a.exr"), settings, "digest"), identified(&at("b/c.exr"), settings, "digest"));
        assert!(identified(&at("a.exr"), settings, "digest").contains("map: Some(\"\"), rotation_deg: 5.0"));
    }
}
