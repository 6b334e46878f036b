//! Metropolis-Hastings chains in large scenes under six lights: the light of their VPLs is what the map of importance says.

use crate::common::*;
use crate::population::{CHAINS, Population, mean_and_error, vpls};
use glam::{Vec2, Vec3};
use manylight::config::{Config, FilterKind, Importance, Numbers, VisibilityMethod, VplSampler, Weights};
use manylight::presets;
use manylight::renderer::Renderer;
use manylight::scene::pack;
use manylight::stages::vpls::VplPlace;
use std::path::Path;

const SEEDS: u32 = 4;

/// A view under six lights with so few pixels and texels that all pairs of them can be worked out.
fn view(name: &str) -> Config {
    let (_, view) = presets::views().into_iter().find(|(known, _)| *known == name).unwrap();
    let text = format!("base = \"barak.toml\"\n{view}");
    let mut config = manylight::config::parse(&text, Path::new("view.toml"), &[]).unwrap_or_else(|error| panic!("{error:#}")).config;
    config.frame.size = [48, 27];
    config.rsm.size = [24, 24];
    config.vpls.numbers = Numbers::Random;
    config.filter.kind = FilterKind::None;
    config
}

/// Light that each texel of the maps brings to all pixels together, shadowed by rays, in the order of the population.
fn lights_of_texels(renderer: &mut Renderer, config: &Config, population: &Population) -> Vec<f64> {
    let mut every = config.clone();
    (every.vpls.sampler, every.vpls.importance) = (VplSampler::EveryTexel, Importance::None);
    every.visibility.method = VisibilityMethod::RayTraced;
    every.gather.interleave = 1.into();
    let rendered = dump(renderer, &every, 0, &["gbuffer/draw", "vpls/every-texel", "visibility/ray-traced"]);
    let picture = rendered.picture.as_ref().unwrap();
    let (places, intensities): (Vec<VplPlace>, Vec<[f32; 3]>) = (pod(&rendered, "vpls/places"), pod(&rendered, "vpls/intensities"));
    let areas: Vec<f32> = pod(&rendered, "vpls/areas");
    let (depths, normals): (Vec<f32>, Vec<u32>) = (pod(&rendered, "gbuffer/depth"), pod(&rendered, "gbuffer/normal"));
    let visible: Vec<u32> = pod(&rendered, "visibility/visible");
    let view = picture.view;
    let receivers: Vec<Option<(Vec3, Vec3)>> = (0..depths.len())
        .map(|i| {
            let pixel = Vec2::new((i as u32 % view.width) as f32, (i as u32 / view.width) as f32);
            let ndc = (pixel + 0.5) / Vec2::new(view.width as f32, view.height as f32) * 2.0 - 1.0;
            let ray = Vec3::from(view.forward) + ndc.x * Vec3::from(view.right) - ndc.y * Vec3::from(view.up);
            let surface = (Vec3::from(view.position) + ray * (view.near / depths[i]), pack::octahedral_snorm16_inverse(normals[i]));
            (depths[i] > 0.0).then_some(surface)
        })
        .collect();
    let least = f64::from(config.gather.min_distance).powi(2);
    let mut of_texels = vec![0.0; population.len()];
    for (i, place) in places.iter().enumerate().filter(|(i, _)| areas[*i] > 0.0) {
        let (position, facing) = (Vec3::from(place.position), pack::octahedral_snorm16_inverse(place.normal).as_dvec3());
        let at_pixels = receivers.iter().enumerate().filter_map(|(pixel, receiver)| {
            let (at, normal) = (*receiver)?;
            let seen = visible[i / 32 * receivers.len() + pixel] >> (i % 32) & 1 == 1;
            let way = (position - at).as_dvec3();
            let (squared, leaves, arrives) = (way.length_squared(), -facing.dot(way), normal.as_dvec3().dot(way));
            (seen && leaves > 0.0 && arrives > 0.0).then(|| leaves * arrives / (squared * squared.max(least)))
        });
        let intensity = intensities[i].iter().copied().map(f64::from).sum::<f64>();
        of_texels[population.texel(position)] = intensity * at_pixels.sum::<f64>();
    }
    let of_picture: f64 = picture.irradiance.rgb().map(|c| f64::from(c.x) + f64::from(c.y) + f64::from(c.z)).sum();
    let all: f64 = of_texels.iter().sum();
    assert!((all / of_picture - 1.0).abs() < 2e-3, "the texels bring {all} to the pixels, and the picture has {of_picture}");
    of_texels
}

/// Exact expectation of the sum of `lights` at the texels of chains of `steps`, for each texel of a uniform sample.
fn expectation(population: &Population, lights: &[f64], steps: u32, weights: Weights) -> f64 {
    let f = &population.importance;
    let mean_importance = f.iter().sum::<f64>() / population.len() as f64;
    let (ends, sums) = population.chain(steps);
    // A chain that meets no importance weighs as a uniform sample, or with a common weight not at all.
    let of_texel = |v: usize| match (weights, f[v] > 0.0) {
        (Weights::None, true) => lights[v] * mean_importance * ends[v] / f[v],
        (Weights::None, false) => 0.0,
        (_, true) => lights[v] * sums[v] / (f64::from(steps) * f[v]),
        (_, false) => lights[v] * ends[v],
    };
    (0..population.len()).map(of_texel).sum()
}

#[test]
fn chains_in_sibenik_and_sponza_bring_the_light_that_the_map_of_importance_expects() {
    for (file, name) in [("sibenik.glb", "sibenik-six"), ("sponza_crytek.glb", "crytek-sponza-six")] {
        let Some(scene) = shared_scene(file) else { continue };
        let mut renderer = traced(scene);
        let mut config = view(name);
        // A seed moves the view samples too, so each has a map of its own.
        let populations: Vec<Population> = (0..SEEDS)
            .map(|seed| {
                config.frame.seed = seed;
                Population::of(&mut renderer, &config)
            })
            .collect();
        let lights = lights_of_texels(&mut renderer, &config, &populations[0]);
        // Of all texels, 1.
        let scale = lights.len() as f64 / lights.iter().sum::<f64>();
        let lights: Vec<f64> = lights.iter().map(|light| light * scale).collect();
        config.visibility.method = VisibilityMethod::None;
        config.gather.interleave = 8.into();
        config.vpls.count = CHAINS;
        for (steps, weights) in [(1, Weights::Mean), (1, Weights::None), (5, Weights::Mean), (5, Weights::None), (20, Weights::Mean)] {
            (config.vpls.metropolis_hastings.steps, config.vpls.metropolis_hastings.weights) = (steps, weights);
            let (mut found, mut expected) = (Vec::new(), 0.0);
            for (seed, population) in (0..SEEDS).zip(&populations) {
                config.frame.seed = seed;
                let drawn = population.weights(&vpls(&mut renderer, &config));
                found.extend(drawn.iter().map(|(texel, weight)| weight * lights[*texel]));
                expected += expectation(population, &lights, steps, weights) / f64::from(SEEDS);
            }
            let (energy, error) = mean_and_error(found.into_iter(), (SEEDS * CHAINS) as usize);
            let what = format!("{name}, {steps} steps, {weights:?}: energy {energy:.4} +- {error:.4}, expected {expected:.4}");
            println!("{what}");
            // A single step is uniform sampling, which varies the more the fewer texels the pixels have their light of.
            let most = if steps == 1 { 1e-2 } else { 3e-3 };
            assert!((energy - expected).abs() < 4.0 * error + 1e-4 && error < most, "{what}");
            if weights == Weights::Mean {
                assert!((expected - 1.0).abs() < 0.03, "{what}");
            } else if steps == 1 {
                assert!((expected - 1.0).abs() > 0.1, "{what}");
            }
        }
        finish(renderer.gpu());
    }
}
