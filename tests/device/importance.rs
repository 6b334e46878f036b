//! VPLs by importance to the view (Barák, Bittner and Havran 2013): estimates, chains, densities and the numbers they hang on.

use crate::common::*;
use crate::population::*;
use glam::{DVec3, Vec3};
use manylight::config::{
    Acceptance, Config, Dielectric, Evaluate, GatherMethod, Importance, LightConfig, Numbers, Reflection, Scan, ViewLight, VplSampler,
    Weights,
};
use manylight::renderer::{Rendered, Renderer};

const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);
/// Texels of each of the two maps.
const MAP: [u32; 2] = [16, 8];
/// Draws of the inverse transform in each of four ways: ten million together.
const DRAWS: u32 = 2_500_000;

fn lamps() -> Vec<LightConfig> {
    vec![
        spot(Vec3::new(1.0, 1.5, 1.0), Vec3::new(1.0, -0.6, 1.0), [10.0; 3], 30.0, 60.0),
        spot(Vec3::new(3.0, 2.0, 4.0), Vec3::new(-1.0, 0.2, -0.4), [4.0, 6.0, 9.0], 20.0, 55.0),
    ]
}

/// A box under two lamps, seen from a corner, with so few texels that their whole distribution can be worked out.
fn two_lamps() -> (Renderer, Config) {
    let albedos = [[0.7, 0.1, 0.1], [0.1, 0.7, 0.1], [0.5, 0.5, 0.5], [0.8, 0.8, 0.8], [0.3, 0.3, 0.6], [0.6, 0.6, 0.3]].map(DVec3::from);
    let renderer = renderer(room(&walls(SIZE, albedos)));
    let mut config = plain([24, 16], Vec3::new(0.4, 1.6, 4.6), Vec3::new(3.0, 1.0, 0.5), 70.0, lamps().remove(0));
    config.light = lamps();
    config.gather.min_distance = 0.3;
    config.rsm.size = MAP;
    config.vpls.sampler = VplSampler::MetropolisHastings;
    config.vpls.importance = Importance::View;
    config.vpls.view_importance.samples = 64;
    // Every lit texel is important to some degree.
    config.vpls.view_importance.defensive = 0.1;
    config.vpls.numbers = Numbers::Random;
    (renderer, config)
}

/// Pearson's statistic of counts against shares, in standard deviations over its mean; texels that expect few are merged.
fn chi_square(counts: &[u64], shares: &[f64]) -> f64 {
    let total = counts.iter().sum::<u64>() as f64;
    let (mut statistic, mut bins, mut rest) = (0.0, 0.0, (0.0, 0.0));
    for (count, share) in counts.iter().zip(shares) {
        let expected = share * total;
        if expected < 5.0 {
            rest = (rest.0 + *count as f64, rest.1 + expected);
        } else {
            statistic += (*count as f64 - expected).powi(2) / expected;
            bins += 1.0;
        }
    }
    if rest.1 >= 5.0 {
        statistic += (rest.0 - rest.1).powi(2) / rest.1;
        bins += 1.0;
    }
    (statistic - (bins - 1.0)) / f64::sqrt(2.0 * (bins - 1.0))
}

#[test]
fn chains_end_and_weigh_as_their_exact_expectation_says() {
    let (mut renderer, mut config) = two_lamps();
    config.gather.interleave = 8.into();
    config.vpls.count = CHAINS;
    let population = Population::of(&mut renderer, &config);
    let lit = population.importance.iter().filter(|f| **f > 0.0).count();
    assert!(lit > 150, "{lit} texels are important");
    let mean_importance = population.importance.iter().sum::<f64>() / population.len() as f64;
    for steps in [1, 2, 5, 20] {
        config.vpls.metropolis_hastings.steps = steps;
        let (ends, sums) = population.chain(steps);
        let important = |texel: &usize| population.importance[*texel] > 0.0;
        for (weights, acceptance) in [
            (Weights::Mean, Acceptance::Metropolis),
            (Weights::Single, Acceptance::Metropolis),
            (Weights::None, Acceptance::Metropolis),
            (Weights::Mean, Acceptance::Reservoir),
        ] {
            (config.vpls.metropolis_hastings.weights, config.vpls.metropolis_hastings.acceptance) = (weights, acceptance);
            let found = population.weights(&vpls(&mut renderer, &config));
            let (mean, error) = mean_and_error(found.iter().map(|(_, weight)| *weight), CHAINS as usize);
            // The integrand is 1 where there is light.
            let truth = lit as f64 / population.len() as f64;
            let over = |sum: &dyn Fn(usize) -> f64| (0..population.len()).filter(important).map(sum).sum::<f64>();
            let expected = match (weights, acceptance) {
                (Weights::Mean, Acceptance::Metropolis) => over(&|v| sums[v] / (f64::from(steps) * population.importance[v])),
                (Weights::None, _) => over(&|v| mean_importance * ends[v] / population.importance[v]),
                _ => truth,
            };
            println!("{steps} steps, {weights:?}, {acceptance:?}: {mean:.5} +- {error:.5}, expected {expected:.5} of {truth:.5}");
            assert!((mean - expected).abs() < 4.0 * error + 1e-6, "{steps} steps, {weights:?}, {acceptance:?}: {mean} of {expected}");
            if weights == Weights::Mean && acceptance == Acceptance::Metropolis && steps == 2 {
                // In closed form, over pairs of important texels.
                let f: Vec<f64> = population.importance.iter().copied().filter(|f| *f > 0.0).collect();
                let pairs = f.iter().flat_map(|a| f.iter().map(move |b| (1.0 - a.min(*b) / a.max(*b)).powi(2)));
                let bias = -0.25 * pairs.sum::<f64>() / (population.len() as f64).powi(2);
                println!("bias of two steps: {:.5}, exactly {bias:.5}", mean - truth);
                assert!((mean - truth - bias).abs() < 4.0 * error && bias < -8.0 * error, "bias {} of {bias} +- {error}", mean - truth);
            }
            if weights == Weights::Mean && acceptance == Acceptance::Metropolis && steps == 5 {
                assert!((mean - truth).abs() > 5.0 * error, "the paper's weight is biased, and this one is not: {mean} of {truth}");
            }
            if weights == Weights::None && steps == 1 {
                assert!((mean - truth).abs() > 0.1 * truth, "a common weight is biased, and this one is not: {mean} of {truth}");
            }
            if weights == Weights::Mean && acceptance == Acceptance::Metropolis {
                let mut counts = vec![0; population.len()];
                found.iter().for_each(|(texel, _)| counts[*texel] += 1);
                let shares = over(&|v| ends[v]);
                let shares: Vec<f64> = (0..ends.len()).map(|v| if important(&v) { ends[v] / shares } else { 0.0 }).collect();
                let off = chi_square(&counts, &shares);
                println!("{steps} steps: chi square is off by {off:.2} standard deviations");
                assert!(off < 5.0, "{steps} steps: chi square is off by {off} standard deviations");
            }
        }
    }
    finish(renderer.gpu());
}

#[test]
fn the_inverse_transform_draws_texels_by_their_importance() {
    let (mut renderer, mut config) = two_lamps();
    config.vpls.view_importance.defensive = 0.0;
    config.gather.interleave = 8.into();
    config.vpls.sampler = VplSampler::InverseTransform;
    config.vpls.count = DRAWS;
    let population = Population::of(&mut renderer, &config);
    let total: f64 = population.importance.iter().sum();
    let shares: Vec<f64> = population.importance.iter().map(|f| f / total).collect();
    assert!(shares.contains(&0.0), "some texels are not important");
    for (dimensions, numbers) in [(3, Numbers::Random), (2, Numbers::Random), (3, Numbers::Halton), (2, Numbers::ShiftedHalton)] {
        config.vpls.inverse_transform.dimensions = dimensions;
        config.vpls.numbers = numbers;
        let found = population.weights(&vpls(&mut renderer, &config));
        assert_eq!(found.len(), DRAWS as usize, "{dimensions} numbers: none is drawn that has no importance");
        let mut counts = vec![0; population.len()];
        for (texel, weight) in found {
            assert!(population.importance[texel] > 0.0, "{dimensions} numbers: texel {texel} has no importance");
            let expected = total / population.len() as f64 / population.importance[texel];
            assert!((weight / expected - 1.0).abs() < 1e-4, "texel {texel} weighs {weight}, not {expected}");
            counts[texel] += 1;
        }
        let off = chi_square(&counts, &shares);
        println!("{dimensions} numbers, {numbers:?}: chi square is off by {off:.2} standard deviations");
        assert!(off < 5.0, "{dimensions} numbers, {numbers:?}: chi square is off by {off} standard deviations");
        let half = population.len() / 2;
        let of_first = |numbers: &mut dyn Iterator<Item = f64>| numbers.take(half).sum::<f64>();
        let first = of_first(&mut counts.iter().map(|count| *count as f64 / f64::from(DRAWS)));
        let expected = of_first(&mut shares.iter().copied());
        let error = (expected * (1.0 - expected) / f64::from(DRAWS)).sqrt();
        assert!((first - expected).abs() < 3.5 * error, "{dimensions} numbers: a light gets {first}, not {expected}");
    }
    finish(renderer.gpu());
}

#[test]
fn sums_by_doubling_draw_texels_by_their_importance_too() {
    let (mut renderer, mut config) = two_lamps();
    config.rsm.size = [50, 31];
    config.gather.interleave = 8.into();
    config.vpls.sampler = VplSampler::InverseTransform;
    config.vpls.count = 400_000;
    config.vpls.inverse_transform.scan = Scan::Doubling;
    let population = Population::of(&mut renderer, &config);
    let total: f64 = population.importance.iter().sum();
    let shares: Vec<f64> = population.importance.iter().map(|f| f / total).collect();
    let found = population.weights(&vpls(&mut renderer, &config));
    let mut counts = vec![0; population.len()];
    for (texel, weight) in found {
        let expected = total / population.len() as f64 / population.importance[texel];
        assert!((weight / expected - 1.0).abs() < 1e-4, "texel {texel} weighs {weight}, not {expected}");
        counts[texel] += 1;
    }
    let drawn: u64 = counts.iter().sum();
    assert!(drawn as f64 > 0.9999 * 400_000.0, "{drawn} of 400000 are drawn where there is importance");
    let off = chi_square(&counts, &shares);
    println!("chi square is off by {off:.2} standard deviations");
    assert!(off < 5.0, "chi square is off by {off} standard deviations");
    finish(renderer.gpu());
}

#[test]
fn light_that_arrives_counts_whatever_the_material_that_it_arrives_at() {
    // All walls are alike, so that what arrives is what is reflected over their albedo.
    let renderer_of = |albedo: f64| renderer(room(&walls(SIZE, [DVec3::splat(albedo); 6])));
    let (_, mut config) = two_lamps();
    config.vpls.sampler = VplSampler::InverseTransform;
    config.vpls.view_importance.defensive = 0.0;
    let mut renderer = renderer_of(0.25);
    let mut map = |config: &Config| -> Vec<f32> { pod(&dump(&mut renderer, config, 0, &["vpls/importance-map"]), "vpls/importance-map") };
    let reflected = map(&config);
    config.vpls.view_importance.light = ViewLight::Arriving;
    let arriving = map(&config);
    assert!(reflected.iter().filter(|f| **f > 0.0).count() > 100);
    for (reflected, arriving) in reflected.iter().zip(&arriving) {
        assert!((0.25 * arriving - reflected).abs() <= 0.01 * reflected, "{arriving} arrives where {reflected} is reflected");
    }
    // Glossy receivers do not matter either.
    (config.gather.method, config.gather.stochastic.receiver) = (GatherMethod::Stochastic, manylight::config::Receiver::Ggx);
    assert!(map(&config) == arriving, "the importance hangs on the receivers' gloss");
    finish(renderer.gpu());
}

/// All that a sampler leaves in the VPLs' buffers.
fn bytes(rendered: &Rendered) -> [Vec<u8>; 3] {
    ["vpls/places", "vpls/intensities", "vpls/areas"].map(|name| dumped(rendered, name).to_vec())
}

#[test]
fn a_chain_of_one_step_is_uniform_sampling_and_a_map_changes_nothing() {
    let (mut renderer, mut config) = two_lamps();
    for (lights, count, size) in [(1, 100, [50, 31]), (2, 1000, [50, 31]), (2, 333, [64, 64])] {
        config.light = lamps()[..lights].to_vec();
        (config.vpls.count, config.rsm.size) = (count, size);
        for numbers in [Numbers::Halton, Numbers::ShiftedHalton, Numbers::Random] {
            config.vpls.numbers = numbers;
            let mut uniform = config.clone();
            (uniform.vpls.sampler, uniform.vpls.importance) = (VplSampler::Uniform, Importance::None);
            let uniform = bytes(&vpls(&mut renderer, &uniform));
            for (steps, samples) in [(1, 256), (5, 100), (3, 4097)] {
                config.vpls.metropolis_hastings.steps = steps;
                config.vpls.view_importance.samples = samples;
                for (weights, acceptance) in [
                    (Weights::Mean, Acceptance::Metropolis),
                    (Weights::Single, Acceptance::Metropolis),
                    (Weights::Mean, Acceptance::Reservoir),
                ] {
                    (config.vpls.metropolis_hastings.weights, config.vpls.metropolis_hastings.acceptance) = (weights, acceptance);
                    let [lazily, mapped] = [Evaluate::Proposals, Evaluate::Map].map(|evaluate| {
                        config.vpls.metropolis_hastings.evaluate = evaluate;
                        bytes(&vpls(&mut renderer, &config))
                    });
                    let what = format!("{lights} lights, {count} VPLs, {numbers:?}, {steps} steps, {weights:?}, {acceptance:?}");
                    assert!(lazily == mapped, "{what}: the map gives other VPLs");
                    assert_eq!(lazily == uniform, steps == 1, "{what}");
                }
            }
        }
    }
    finish(renderer.gpu());
}

#[test]
fn after_an_odd_number_of_view_samples_there_is_one_without_a_surface() {
    let (mut renderer, mut config) = two_lamps();
    for (samples, expected) in [(63usize, 64), (513, 514)] {
        config.vpls.view_importance.samples = samples as u32;
        let rendered = dump(&mut renderer, &config, 0, &["vpls/view-samples"]);
        let words: Vec<u32> = words(dumped(&rendered, "vpls/view-samples")).collect();
        // A sample is seven numbers, of which the fourth is its albedo.
        let albedos: Vec<f32> = words.as_chunks::<7>().0.iter().map(|sample| f32::from_bits(sample[3])).collect();
        assert!(albedos.len() >= expected, "{samples} samples: {} have room", albedos.len());
        assert!(albedos[..samples].iter().any(|albedo| *albedo > 0.0), "{samples} samples: none is on a surface");
        assert_eq!(albedos[samples], -1.0, "{samples} samples");
    }
    finish(renderer.gpu());
}

#[test]
fn a_map_changes_nothing_for_glossy_vpls_and_receivers_either() {
    let (mut renderer, mut config) = two_lamps();
    (config.vpls.count, config.rsm.size) = (1000, [50, 31]);
    (config.gather.method, config.gather.stochastic.receiver) = (GatherMethod::Stochastic, manylight::config::Receiver::Ggx);
    for (dielectric, reflection) in
        [(Dielectric::Lambert, Reflection::Diffuse), (Dielectric::Ggx, Reflection::Glossy), (Dielectric::Ggx, Reflection::Both)]
    {
        (config.materials.dielectric, config.vpls.reflection) = (dielectric, reflection);
        for defensive in [0.0, 0.1] {
            config.vpls.view_importance.defensive = defensive;
            let [lazily, mapped] = [Evaluate::Proposals, Evaluate::Map].map(|evaluate| {
                config.vpls.metropolis_hastings.evaluate = evaluate;
                let rendered = vpls(&mut renderer, &config);
                assert!(count(&rendered, "vpls/lit") > 500, "{dielectric:?}, {reflection:?}, {defensive}: VPLs are dark");
                let lobes = if reflection == Reflection::Diffuse { Vec::new() } else { dumped(&rendered, "vpls/lobes").to_vec() };
                (bytes(&rendered), lobes)
            });
            assert!(lazily == mapped, "{dielectric:?}, {reflection:?}, {defensive}: the map gives other VPLs");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn texels_that_are_all_as_important_have_the_weight_of_uniform_sampling() {
    let (mut renderer, mut config) = two_lamps();
    let population = Population::of(&mut renderer, &config);
    config.vpls.importance = Importance::None;
    config.vpls.count = 4096;
    config.gather.interleave = 4.into();
    for sampler in [VplSampler::InverseTransform, VplSampler::MetropolisHastings] {
        config.vpls.sampler = sampler;
        for weights in [Weights::Mean, Weights::Single, Weights::None] {
            config.vpls.metropolis_hastings.weights = weights;
            for (_, weight) in population.weights(&vpls(&mut renderer, &config)) {
                assert!((weight - 1.0).abs() < 1e-4, "{sampler:?}, {weights:?}: a weight is {weight}");
            }
        }
    }
    finish(renderer.gpu());
}

#[test]
fn the_mean_of_seeds_is_the_light_of_all_texels() {
    const SEEDS: u32 = 256;
    // Far apart: shifts of seeds in a row are spread evenly, which is less than the chance that standard errors are of.
    let seeds: Vec<u32> = random_numbers(SEEDS as usize).iter().map(|u| (f64::from(u[0]) * f64::from(u32::MAX)) as u32).collect();
    let (mut renderer, mut config) = two_lamps();
    config.vpls.count = 64;
    let mut every = config.clone();
    (every.vpls.sampler, every.vpls.importance) = (VplSampler::EveryTexel, Importance::None);
    let luminance = |pixels: Vec<Vec3>| -> Vec<f64> { pixels.iter().map(|c| f64::from(c.x + c.y + c.z)).collect() };
    let truth = luminance(irradiance(&mut renderer, &every));
    let of_truth = truth.iter().sum::<f64>();
    for (sampler, importance, numbers, weights, acceptance, dimensions) in [
        (VplSampler::Uniform, Importance::None, Numbers::Random, Weights::Mean, Acceptance::Metropolis, 3),
        (VplSampler::InverseTransform, Importance::View, Numbers::Random, Weights::Mean, Acceptance::Metropolis, 3),
        (VplSampler::InverseTransform, Importance::View, Numbers::ShiftedHalton, Weights::Mean, Acceptance::Metropolis, 2),
        (VplSampler::MetropolisHastings, Importance::View, Numbers::Random, Weights::Single, Acceptance::Metropolis, 3),
        (VplSampler::MetropolisHastings, Importance::View, Numbers::ShiftedHalton, Weights::Mean, Acceptance::Reservoir, 3),
        (VplSampler::MetropolisHastings, Importance::View, Numbers::Random, Weights::Mean, Acceptance::Reservoir, 3),
        (VplSampler::Hammersley, Importance::View, Numbers::Halton, Weights::Mean, Acceptance::Metropolis, 3),
        (VplSampler::Regular, Importance::View, Numbers::Halton, Weights::Mean, Acceptance::Metropolis, 3),
        (VplSampler::Hammersley, Importance::None, Numbers::Halton, Weights::Mean, Acceptance::Metropolis, 3),
        (VplSampler::Regular, Importance::None, Numbers::Halton, Weights::Mean, Acceptance::Metropolis, 3),
    ] {
        (config.vpls.sampler, config.vpls.importance, config.vpls.numbers) = (sampler, importance, numbers);
        (config.vpls.metropolis_hastings.weights, config.vpls.metropolis_hastings.acceptance) = (weights, acceptance);
        config.vpls.inverse_transform.dimensions = dimensions;
        let mut sums = vec![[0.0; 2]; truth.len()];
        let mut energies = Vec::new();
        for seed in &seeds {
            config.frame.seed = *seed;
            let pixels = luminance(irradiance(&mut renderer, &config));
            sums.iter_mut().zip(&pixels).for_each(|(sum, x)| *sum = [sum[0] + x, sum[1] + x * x]);
            energies.push(pixels.iter().sum::<f64>() / of_truth);
        }
        let (energy, error) = mean_and_error(energies.iter().copied(), energies.len());
        let n = f64::from(SEEDS);
        let within = |(sum, truth): (&[f64; 2], &f64)| {
            let mean = sum[0] / n;
            // Halves have 11 bits.
            (mean - truth).abs() < 3.0 * ((sum[1] / n - mean * mean).max(0.0) / n).sqrt() + truth * 5e-4
        };
        let share = sums.iter().zip(&truth).filter(|pair| within(*pair)).count() as f64 / truth.len() as f64;
        let what = format!("{sampler:?}, {importance:?}, {numbers:?}, {weights:?}, {acceptance:?}, {dimensions}");
        println!("{what}: energy {energy:.4} +- {error:.4}, {:.1} % of the pixels", share * 100.0);
        assert!((energy - 1.0).abs() < 3.0 * error + 2e-3, "{what}: the energy is {energy} +- {error}");
        assert!(share >= 0.98, "{what}: only {share} of the pixels are within three standard errors");
    }
    finish(renderer.gpu());
}

#[test]
fn glossy_vpls_and_receivers_are_chosen_by_what_they_reflect() {
    let (mut renderer, mut config) = two_lamps();
    config.materials.dielectric = Dielectric::Ggx;
    config.gather.method = GatherMethod::Stochastic;
    config.gather.stochastic.receiver = manylight::config::Receiver::Ggx;
    config.gather.stochastic.delta = 1e-6;
    config.vpls.count = 64;
    config.vpls.metropolis_hastings.acceptance = Acceptance::Reservoir;
    let mean = |renderer: &mut Renderer, config: &Config| {
        let picture = picture(renderer, config);
        (0..384).map(|i| f64::from(picture.indirect.at(i)[1])).sum::<f64>() / 384.0
    };
    for reflection in [Reflection::Glossy, Reflection::Both] {
        config.vpls.reflection = reflection;
        let mut every = config.clone();
        (every.vpls.sampler, every.vpls.importance) = (VplSampler::EveryTexel, Importance::None);
        let truth = mean(&mut renderer, &every);
        for sampler in [VplSampler::MetropolisHastings, VplSampler::InverseTransform] {
            config.vpls.sampler = sampler;
            let energies: Vec<f64> = (0..128)
                .map(|seed| {
                    config.frame.seed = seed;
                    mean(&mut renderer, &config) / truth
                })
                .collect();
            let (energy, error) = mean_and_error(energies.iter().copied(), energies.len());
            println!("{reflection:?}, {sampler:?}: energy {energy:.4} +- {error:.4}");
            assert!((energy - 1.0).abs() < 3.5 * error + 2e-3, "{reflection:?}, {sampler:?}: the energy is {energy} +- {error}");
            assert!(error < 0.012, "{reflection:?}, {sampler:?}: the standard error of the energy is {error}");
        }
        config.frame.seed = 0;
    }
    finish(renderer.gpu());
}

#[test]
fn a_view_that_finds_nothing_important_takes_all_texels_alike() {
    let (_, mut config) = two_lamps();
    // A wall of metal, which reflects nothing diffusely.
    let mut scene = room(&walls(SIZE, [DVec3::splat(0.6); 6]));
    scene.materials[1].metallic = 1.0;
    let mut renderer = renderer(scene);
    config.rsm.size = [32, 32];
    config.vpls.count = 500;
    let away = ([0.0, 0.0, 50.0], [0.0, 0.0, 100.0]);
    let metal = ([2.0, 1.5, 2.5], [4.0, 1.5, 2.5]);
    for (position, target) in [away, metal] {
        let camera = config.camera.as_mut().unwrap();
        (camera.position, camera.target, camera.fov_y_deg) = (Some(position), Some(target), Some(30.0));
        for (sampler, weights) in [
            (VplSampler::InverseTransform, Weights::Mean),
            (VplSampler::MetropolisHastings, Weights::Mean),
            (VplSampler::MetropolisHastings, Weights::Single),
            (VplSampler::MetropolisHastings, Weights::None),
            (VplSampler::Hammersley, Weights::Mean),
            (VplSampler::Regular, Weights::Mean),
        ] {
            (config.vpls.sampler, config.vpls.metropolis_hastings.weights) = (sampler, weights);
            for defensive in [0.0, 0.1] {
                config.vpls.view_importance.defensive = defensive;
                let rendered = vpls(&mut renderer, &config);
                let areas: Vec<f32> = pod(&rendered, "vpls/areas");
                let what = format!("from {position:?}, {sampler:?}, {weights:?}, {defensive}");
                assert!(areas.iter().all(|area| area.is_finite() && *area >= 0.0), "{what}: {areas:?}");
                let lit = count(&rendered, "vpls/lit");
                let none = weights == Weights::None && defensive == 0.0;
                assert_eq!(lit > 200, !none, "{what}: {lit} VPLs are lit");
            }
        }
    }
    finish(renderer.gpu());
}

#[test]
fn a_seed_moves_the_vpls_of_every_sampler_that_leaves_any_out() {
    let (mut renderer, mut config) = two_lamps();
    config.rsm.size = [64, 64];
    config.vpls.count = 100;
    for name in manylight::config::choices("vpls.sampler") {
        config.vpls.sampler = serde_json::from_value(name.into()).unwrap();
        if config.vpls.sampler == VplSampler::EveryTexel {
            continue;
        }
        for numbers in [Numbers::Halton, Numbers::ShiftedHalton, Numbers::Random] {
            (config.vpls.importance, config.vpls.numbers) = (Importance::None, numbers);
            let mut with = |seed| {
                config.frame.seed = seed;
                bytes(&vpls(&mut renderer, &config))
            };
            let [first, second, again, far] = [1, 2, 1, u32::MAX].map(&mut with);
            assert!(first == again, "{name}, {numbers:?}: a seed has other VPLs the second time");
            assert!(first != second && first != far, "{name}, {numbers:?}: seeds have the same VPLs");
        }
    }
    finish(renderer.gpu());
}
