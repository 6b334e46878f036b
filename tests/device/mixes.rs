//! Presets take each other's parts: a mix renders, or is refused with a reason.

use crate::common::*;
use glam::Vec3;
use manylight::config::{CameraConfig, Config, GatherMethod, Kind, keys};
use manylight::graph::{Execution, Reuse};
use manylight::output::Picture;
use manylight::renderer::Renderer;
use manylight::world::Inspection;
use std::path::PathBuf;

/// Sections whose names are mixed.
const MIXED: [&str; 9] = ["vpls.", "bounce.", "visibility.", "gather.", "filter.", "ssao.", "sky.", "direct.", "materials."];

/// Sizes at which a mix takes a moment, of a scene that has all that methods ask for.
const SMALL: [&str; 10] = [
    "scene.builtin=cornell",
    "frame.size=[48,32]",
    "frame.count=1",
    "rsm.size=[32,32]",
    "vpls.count=64",
    "vpls.view_importance.samples=32",
    "visibility.ism.point_count=2000",
    "visibility.ism.map_size=32",
    "gather.light_caches.distance=0.7",
    "sky.count=64",
];

const MIXES: usize = 60;

/// Presets that are a frame's methods, and not a walk.
fn presets() -> Vec<PathBuf> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/configs"));
    let mut presets: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml") && !path.to_str().unwrap().contains("walk"))
        .collect();
    presets.sort();
    presets
}

/// Renders a config, then another view of it that takes over what it can. Its picture must be that of a frame without anything before it.
/// Returns the number of passes that did not run again.
fn kept_by_a_moved_camera(renderer: &mut Renderer, config: &Config, number: u64, mix: &str) -> anyhow::Result<usize> {
    let reusing = |reuse| Execution { reuse, ..Execution::default() };
    renderer.render(config, 0, false, &reusing(Reuse::Remember(number)))?;
    let mut moved = config.clone();
    let camera = renderer.camera(config, 0)?;
    let (position, target) = (camera.position + 0.1, camera.target - 0.2);
    moved.camera = Some(CameraConfig { position: Some(position.into()), target: Some(target.into()), ..CameraConfig::default() });
    moved.frame.size = [40, 30];
    let kept = renderer.render(&moved, 0, true, &reusing(Reuse::Apply(number)))?;
    let whole = renderer.render(&moved, 0, true, &reusing(Reuse::Never))?;
    let [picture, expected] = [kept.picture.as_ref().unwrap(), whole.picture.as_ref().unwrap()];
    assert!(picture.image == expected.image && picture.radiance.values == expected.radiance.values, "{mix}: a kept result is another one");
    assert_eq!(kept.counts, whole.counts, "{mix}");
    Ok(whole.times.len() - kept.times.len())
}

/// Asks why pixels are lit. The picture must stay as it is, and the VPLs' shares must sum to the gather's light.
fn explains_a_pixel(renderer: &mut Renderer, config: &Config, expected: &Picture, mix: &str) -> anyhow::Result<()> {
    for pixel in [[11, 21], [30, 9]] {
        let rendered = renderer.inspect(config, 0, Inspection { pixel: Some(pixel), vpls: true }, true, &Execution::default())?;
        assert!(rendered.picture.unwrap().image == expected.image, "{mix}: a question changes the picture");
        let asked = rendered.inspected.explanation.unwrap();
        assert!(!asked.bounces.is_empty() && asked.bounces.iter().all(|bounce| !bounce.is_empty()), "{mix}: there are no VPLs");
        let sums = asked.sums();
        // Light caches sum elsewhere.
        if config.gather.method == GatherMethod::LightCaches {
            continue;
        }
        // Every bounce's sum rounds to 16-bit floats.
        let off = (sums.light - asked.gathered).abs().max_element();
        assert!(
            off <= 3e-3 * asked.gathered.max_element() + 1e-5,
            "{mix}: pixel {pixel:?} has {}, its VPLs {}",
            asked.gathered,
            sums.light
        );
        if let Some([before, _]) = asked.reflection {
            let reflected: Vec3 = asked.bounces.iter().flatten().map(|share| Vec3::from(share.reflected)).sum();
            let off = (reflected - before).abs().max_element();
            assert!(off <= 3e-3 * before.max_element() + 1e-5, "{mix}: pixel {pixel:?} reflects {before}, its VPLs {reflected}");
        }
    }
    Ok(())
}

#[test]
fn sixty_random_mixes_of_all_methods_render_or_are_refused_with_a_reason() {
    let names: Vec<(&str, Vec<&str>)> = keys()
        .iter()
        .filter(|info| MIXED.iter().any(|section| info.key.starts_with(section)))
        .filter_map(|info| match &info.kind {
            Kind::Choice(choices) => Some((info.key.as_str(), choices.iter().map(|choice| choice.name.as_str()).collect())),
            _ => None,
        })
        .collect();
    assert!(names.len() > 30, "{names:?}");
    let presets = presets();
    let mut scene = manylight::scene::builtin::cornell();
    scene.split_triangles(0.1);
    let mut renderer = traced(scene);
    let numbers: Vec<f32> = random_numbers(4 * MIXES).into_iter().flatten().collect();
    let mut numbers = numbers.into_iter();
    let mut below = |n: usize| ((numbers.next().unwrap() * n as f32) as usize).min(n - 1);
    let (mut rendered, mut refused, mut kept) = (0, 0, 0);
    for number in 0..MIXES {
        let preset = &presets[below(presets.len())];
        let mut sets: Vec<String> = SMALL.map(str::to_owned).into();
        for _ in 0..5 {
            let (key, choices) = &names[below(names.len())];
            sets.push(format!("{key}=\"{}\"", choices[below(choices.len())]));
        }
        let mix = format!("{} --set {}", preset.file_stem().unwrap().to_str().unwrap(), sets[SMALL.len()..].join(" --set "));
        let mut tried = |config: &Config| -> anyhow::Result<()> {
            renderer.check(config)?;
            let picture = renderer.render(config, 0, true, &Default::default())?.picture.unwrap();
            let light: f32 = picture.radiance.rgb().map(|light| light.element_sum()).sum();
            assert!(light.is_finite() && light > 0.0, "{mix}: the picture has {light}");
            kept += kept_by_a_moved_camera(&mut renderer, config, number as u64, &mix)?;
            explains_a_pixel(&mut renderer, config, &picture, &mix)?;
            Ok(())
        };
        match manylight::config::load(preset, &sets).and_then(|loaded| tried(&loaded.config)) {
            Ok(()) => rendered += 1,
            Err(error) => {
                refused += 1;
                let message = format!("{error:#}");
                println!("{mix}: {message}");
                assert!(keys().iter().any(|info| message.contains(&format!("{}: ", info.key))), "{mix}: {message} names no key");
            }
        }
        let messages = renderer.gpu().validation_messages();
        assert!(messages.is_empty(), "{mix}: the validation layer says:\n{}", messages.join("\n"));
    }
    println!("{rendered} mixes rendered, {refused} were refused, a moved camera kept {kept} passes");
    assert!(rendered >= MIXES / 2, "{rendered} mixes rendered, {refused} were refused");
    assert!(kept > 3 * rendered, "a moved camera kept {kept} passes of {rendered} mixes");
    finish(renderer.gpu());
}
