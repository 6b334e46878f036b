//! Rays through the bounding volume hierarchy on the device, held against all triangles one by one.

use crate::common::*;
use glam::Vec3;
use manylight::graph::{Engine, Execution, Graph, Library};
use manylight::scene::Scene;
use manylight::scene::builtin::{self, Atrium};
use manylight::scene::bvh::Bvh;
use manylight::scene::device_bvh::DeviceBvh;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Two vectors a ray in, one a hit out.
const SHADER: &str = "#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include \"bvh/traverse.glsl\"
layout(local_size_x = 64) in;
layout(scalar) readonly buffer Rays { vec4 at[]; } rays;
layout(scalar) writeonly buffer Hits { vec4 at[]; } hits;
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (2u * i >= uint(rays.at.length())) return;
    vec4 origin = rays.at[2u * i], direction = rays.at[2u * i + 1u];
    Hit hit = traverse(make_ray(origin.xyz, direction.xyz), 0.0, NO_TRIANGLE, direction.w, origin.w != 0.0);
    hits.at[i] = vec4(hit.t, uintBitsToFloat(hit.triangle), hit.weights);
}
";

fn engine() -> Engine {
    let mut sources = BTreeMap::new();
    for folder in ["lib", "bvh"] {
        for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl").join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{folder}/{}", path.file_name().unwrap().to_str().unwrap());
            sources.insert(name, std::fs::read_to_string(&path).unwrap());
        }
    }
    sources.insert("test/rays.comp".into(), SHADER.into());
    Engine::new(
        manylight::gpu::Gpu::new(&manylight::gpu::Options { device: manylight::gpu::DeviceChoice::Cpu, validate: false }).unwrap(),
        Library::from_sources(sources),
    )
}

fn hits(engine: &mut Engine, bvh: &DeviceBvh, rays: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let mut g = Graph::new();
    let handles = bvh.import(&mut g);
    let from = g.upload("test/rays", rays);
    let to = g.buffer::<[f32; 4]>("test/hits", rays.len() as u32 / 2);
    g.compute("test/rays")
        .reads("bvh", handles.data)
        .reads("bvh_nodes", handles.nodes)
        .reads("bvh_triangles", handles.triangles)
        .reads("rays", from)
        .writes("hits", to)
        .dispatch([rays.len() as u32 / 2, 1, 1]);
    let read = g.read_back(to);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let all: Vec<[f32; 4]> = outcome
        .bytes(read)
        .chunks_exact(16)
        .map(|h| std::array::from_fn(|i| f32::from_ne_bytes(h[4 * i..4 * i + 4].try_into().unwrap())))
        .collect();
    for k in 2..4 {
        let mean = all.iter().map(|h| h[k] as f64).sum::<f64>() / all.len() as f64;
        let packet = all.chunks(8).map(|c| c.iter().map(|h| h[k] as f64).fold(0.0, f64::max)).sum::<f64>() / (all.len() / 8) as f64;
        let most = all.iter().map(|h| h[k] as f64).fold(0.0, f64::max);
        println!("mean nodes {mean:.1} packet {packet:.1} most {most}");
    }
    println!("{:.1} ms, {:.3} Mrays/s", outcome.times[0].1, rays.len() as f64 / 2e3 / outcome.times[0].1);
    outcome
        .bytes(read)
        .chunks_exact(16)
        .map(|h| std::array::from_fn(|i| f32::from_ne_bytes(h[4 * i..4 * i + 4].try_into().unwrap())))
        .collect()
}

fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747796405).wrapping_add(2891336453);
    let w = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277803737);
    ((w >> 22) ^ w) as f32 / 4294967296.0
}

#[test]
fn throughput() {
    let which = std::env::var("SCENE").unwrap_or_default();
    let scene: Scene = if which.is_empty() {
        builtin::atrium(&Atrium { triangles: std::env::var("N").map_or(260_000, |n| n.parse().unwrap()), seed: 0 })
    } else {
        manylight::scene::gltf::load(Path::new(&which), None).unwrap().scene
    };
    let start = Instant::now();
    let bvh = Bvh::build(&scene);
    println!(
        "build {:.2} s, depth {}, {} nodes, {} triangles",
        start.elapsed().as_secs_f64(),
        bvh.depth,
        bvh.nodes.len(),
        bvh.triangles.len()
    );
    let mut engine = engine();
    let device = DeviceBvh::upload(&mut engine.gpu, "x", &bvh).unwrap();
    let b = scene.bounds();
    println!("{b:?}");
    let (eye, target) = if which.is_empty() {
        (Vec3::new(-9.5, 2.2, -0.4), Vec3::new(8.0, 3.6, 0.0))
    } else {
        (Vec3::new(-11.5, 2.2, -0.35), Vec3::new(8.0, 3.6, 0.1))
    };
    let f = (target - eye).normalize();
    let r = f.cross(Vec3::Y).normalize();
    let u = r.cross(f);
    let mut rays = vec![];
    let (w, h) = (480i32, 270i32);
    for ty in 0..34 {
        for tx in 0..w / 8 {
            for k in 0..64 {
                let (x, y) = (tx * 8 + k % 8, ty * 8 + k / 8);
                if y >= h {
                    continue;
                }
                let (a, b) = ((x as f32 + 0.5) / w as f32 * 2.0 - 1.0, (y as f32 + 0.5) / h as f32 * 2.0 - 1.0);
                let d = f + r * a * 0.577 * 480.0 / 270.0 - u * b * 0.577;
                rays.extend([[eye.x, eye.y, eye.z, 0.0], [d.x, d.y, d.z, 1e30]]);
            }
        }
    }
    let mut state = 1;
    for kind in ["primary", "bounce", "bounce 2"] {
        println!("{kind}");
        hits(&mut engine, &device, &rays);
        let found = hits(&mut engine, &device, &rays);
        let missed = found.iter().filter(|h| h[1].to_bits() == u32::MAX).count();
        println!("missed {missed} of {}", found.len());
        let mut shadow = vec![];
        let mut next = vec![];
        for (ray, hit) in rays.chunks(2).zip(&found) {
            let id = hit[1].to_bits();
            let (o, d) = (Vec3::new(ray[0][0], ray[0][1], ray[0][2]), Vec3::new(ray[1][0], ray[1][1], ray[1][2]));
            if id == u32::MAX {
                continue;
            }
            let t = bvh.triangles[id as usize];
            let c = |i: usize| Vec3::new(f32::from_bits(t[i]), f32::from_bits(t[i + 1]), f32::from_bits(t[i + 2]));
            let n = (c(4) - c(0)).cross(c(8) - c(0)).normalize_or(Vec3::Y);
            let n = if n.dot(d) > 0.0 { -n } else { n };
            let p = o + d * hit[0] + n * 1e-3;
            let (z, phi) = (1.0 - 2.0 * random(&mut state), 6.2831853 * random(&mut state));
            let s = (1.0f32 - z * z).sqrt();
            let v = (n + Vec3::new(s * phi.cos(), s * phi.sin(), z)).normalize();
            next.extend([[p.x, p.y, p.z, 0.0], [v.x, v.y, v.z, 1e30]]);
            let l = -Vec3::new(0.22, -1.0, 0.3).normalize();
            shadow.extend([[p.x, p.y, p.z, 1.0], [l.x, l.y, l.z, 1e30]]);
        }
        println!("shadow");
        hits(&mut engine, &device, &shadow);
        hits(&mut engine, &device, &shadow);
        rays = next;
    }
}
