//! Directions sampled from a surface's reflection: their energy, and their density against the claimed one.

use crate::functions::{ggx, numbers};
use glam::DVec3;
use std::f64::consts::PI;

/// Low-discrepancy points in the unit cube (Roberts's R3 sequence, shifted by one half).
fn points(count: usize) -> Vec<[f64; 3]> {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    (0..count).map(|i| [1.0, 2.0, 3.0].map(|power: f64| (0.5 + i as f64 / ROOT.powf(power)).fract())).collect()
}

/// Albedo of a metal of base colour 1, by its BRDF. Fresnel's term is 1, so it is the energy that single scattering keeps.
fn single_scattering(alpha: f64, nv: f64) -> f64 {
    const N: usize = 4096;
    const AROUND: usize = 512;
    let v = DVec3::new((1.0 - nv * nv).sqrt(), 0.0, nv);
    let mut sum = 0.0;
    for i in 0..N {
        // Half vectors by the inverse transform of D nh.
        let xi = (i as f64 + 0.5) / N as f64;
        let nh = ((1.0 - xi) / (1.0 + (alpha * alpha - 1.0) * xi)).sqrt();
        let d = ggx(alpha, nh, 1.0, 1.0) * 4.0;
        let sh = (1.0 - nh * nh).sqrt();
        for k in 0..AROUND {
            let phi = (k as f64 + 0.5) / AROUND as f64 * 2.0 * PI;
            let h = DVec3::new(sh * phi.cos(), sh * phi.sin(), nh);
            let vh = v.dot(h);
            let l = 2.0 * vh * h - v;
            if vh > 0.0 && l.z > 0.0 {
                sum += ggx(alpha, nh, l.z, nv) * l.z * 4.0 * vh / (d * nh);
            }
        }
    }
    sum / (N * AROUND) as f64
}

#[test]
fn what_the_sampler_of_ggx_loses_is_what_single_scattering_loses() {
    for roughness in [0.05f32, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0] {
        for nv in [0.1f32, 0.35, 0.7, 0.98] {
            let inputs: Vec<[f32; 4]> = points(60_000).iter().map(|u| [u[0] as f32, u[1] as f32, roughness, nv]).collect();
            let body = "vec3 n = vec3(0.0, 0.0, 1.0), view = vec3(sqrt(1.0 - v.w * v.w), 0.0, v.w);
                vec3 l = sample_brdf(vec3(v.xy, 0.5), 1.0, v.z, false, n, view);
                float density = brdf_density(1.0, v.z, false, n, l, view);
                if (density > 0.0) r.x = brdf(vec3(1.0), 1.0, v.z, false, n, l, view).x * max(l.z, 0.0) / density;";
            let weights = numbers(body, &inputs);
            let found = weights.iter().map(|w| f64::from(w[0])).sum::<f64>() / weights.len() as f64;
            let expected = single_scattering(f64::from(roughness * roughness).max(1e-3), nv.into());
            println!("roughness {roughness}, cosine {nv}: {found:.4}, single scattering {expected:.4}");
            assert!(found <= 1.0 + 1e-3, "roughness {roughness}, cosine {nv}: {found} is more than all");
            assert!((found / expected - 1.0).abs() < 0.01, "roughness {roughness}, cosine {nv}: {found} instead of {expected}");
            assert!(weights.iter().all(|w| w[0] <= 1.0 + 1e-3), "no sample weighs more than all");
        }
    }
}

/// Pearson's chi-square test in bins of equal solid angle over the hemisphere; directions below are one bin.
#[test]
fn directions_fall_as_densely_as_the_sampler_claims() {
    const HEIGHTS: usize = 16;
    const AROUND: usize = 24;
    const COUNT: usize = 100_000;
    const FINE: usize = 48;
    for (metallic, roughness, glossy, nv) in [
        (0.0f32, 1.0f32, false, 0.5f32),
        (1.0, 0.3, false, 0.4),
        (1.0, 0.6, false, 0.9),
        (1.0, 1.0, false, 0.2),
        (0.4, 0.5, false, 0.6),
        (0.0, 0.4, true, 0.7),
    ] {
        // Pseudorandom numbers: a low-discrepancy sequence would fit too well for the test.
        let mut state = 9u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
            (((word >> 22) ^ word) >> 8) as f32 / 16_777_216.0
        };
        let inputs: Vec<[f32; 4]> = (0..COUNT).map(|_| [random(), random(), random(), nv]).collect();
        let surface = format!("{metallic:?}, {roughness:?}, {glossy}");
        let view = "vec3 n = vec3(0.0, 0.0, 1.0), view = vec3(sqrt(1.0 - v.w * v.w), 0.0, v.w);";
        let drawn = numbers(&format!("{view} r.xyz = sample_brdf(v.xyz, {surface}, n, view);"), &inputs);
        let bin = |x: f64, y: f64, z: f64| {
            let around = ((y.atan2(x) / (2.0 * PI)).rem_euclid(1.0) * AROUND as f64) as usize;
            ((z * HEIGHTS as f64) as usize).min(HEIGHTS - 1) * AROUND + around.min(AROUND - 1)
        };
        let mut counts = vec![0.0; HEIGHTS * AROUND];
        let mut below = 0.0;
        for l in &drawn {
            let [x, y, z] = [l[0], l[1], l[2]].map(f64::from);
            if z > 0.0 { counts[bin(x, y, z)] += 1.0 } else { below += 1.0 }
        }
        // The claimed density, integrated over each bin with the device's own function.
        let mut places = Vec::new();
        for i in 0..HEIGHTS * FINE {
            for k in 0..AROUND * FINE / 4 {
                let (z, phi) = ((i as f64 + 0.5) / (HEIGHTS * FINE) as f64, (k as f64 + 0.5) / (AROUND * FINE / 4) as f64 * 2.0 * PI);
                let s = (1.0 - z * z).sqrt();
                places.push([(s * phi.cos()) as f32, (s * phi.sin()) as f32, z as f32, nv]);
            }
        }
        let densities = numbers(&format!("{view} r.x = brdf_density({surface}, n, v.xyz, view);"), &places);
        let cell = 2.0 * PI / places.len() as f64;
        let mut expected = vec![0.0; HEIGHTS * AROUND];
        for (place, density) in places.iter().zip(&densities) {
            let [x, y, z] = [place[0], place[1], place[2]].map(f64::from);
            expected[bin(x, y, z)] += f64::from(density[0]) * cell * COUNT as f64;
        }
        let claimed: f64 = expected.iter().sum();
        let mut bins: Vec<(f64, f64)> = counts.into_iter().zip(expected).collect();
        bins.push((below, (COUNT as f64 - claimed).max(0.0)));
        // Bins with too few expected samples are pooled.
        let (full, rare): (Vec<_>, Vec<_>) = bins.into_iter().partition(|(_, expected)| *expected >= 8.0);
        let pooled = rare.iter().fold((0.0, 0.0), |sum, bin| (sum.0 + bin.0, sum.1 + bin.1));
        let square = |(count, expected): &(f64, f64)| (count - expected).powi(2) / expected.max(1.0);
        let chi_square = full.iter().map(square).sum::<f64>() + square(&pooled);
        let freedom = full.len() as f64;
        // A correct sampler exceeds this limit about once in ten thousand runs (Wilson and Hilferty 1931).
        let limit = freedom * (1.0 - 2.0 / (9.0 * freedom) + 3.8 * (2.0 / (9.0 * freedom)).sqrt()).powi(3);
        println!("metallic {metallic}, roughness {roughness}: chi-square {chi_square:.0} of {freedom} bins, the limit is {limit:.0}");
        assert!(full.len() > 20 && chi_square < limit, "metallic {metallic}, roughness {roughness}: {chi_square} of {freedom}");
    }
}

#[test]
fn a_random_number_depends_on_its_place_alone_and_is_as_likely_everywhere() {
    let inputs: Vec<[f32; 4]> = (0..4096).map(|i| [(i % 64) as f32, (i / 64) as f32, 3.0, 7.0]).collect();
    let body = "r = random(uint(v.x), uint(v.y), uint(v.z), uint(v.w));";
    let first = numbers(body, &inputs);
    assert_eq!(first, numbers(body, &inputs));
    let other = numbers("r = random(uint(v.x), uint(v.y), uint(v.z), 8u);", &inputs);
    assert!(first.iter().zip(&other).all(|(a, b)| a != b), "another seed gives other numbers");
    for k in 0..4 {
        let (mean, squares) = first.iter().fold((0.0, 0.0), |(m, s), v| (m + f64::from(v[k]), s + f64::from(v[k]).powi(2)));
        let (mean, squares) = (mean / 4096.0, squares / 4096.0);
        assert!((mean - 0.5).abs() < 0.02 && (squares - 1.0 / 3.0).abs() < 0.02, "number {k}: {mean}, {squares}");
        assert!(first.iter().all(|v| (0.0..1.0).contains(&v[k])));
        let next = (k + 1) % 4;
        let product = first.iter().map(|v| f64::from(v[k]) * f64::from(v[next])).sum::<f64>() / 4096.0;
        assert!((product - 0.25).abs() < 0.02, "numbers {k} and {next} go together: {product}");
    }
}
