//! Rays through the bounding volume hierarchy on the device, against all triangles one by one.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::graph::{Engine, Execution, Graph, Library};
use manylight::scene::Scene;
use manylight::scene::builtin::{self, Atrium};
use manylight::world::bvh::Bvh;
use manylight::world::device_bvh::DeviceBvh;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// Rays in, as origin and direction; distance, triangle and weights of the hit out. If the origin's fourth number is not 0, any
/// hit before the direction's fourth number counts.
const SHADER: &str = "#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include \"bvh/traverse.glsl\"
layout(local_size_x = 64) in;
layout(scalar) readonly buffer Rays { vec4 at[]; } rays;
layout(scalar) readonly buffer Root { uint it; } root;
layout(scalar) writeonly buffer Hits { vec4 at[]; } hits;
bool is_hole(uint mask, vec2 weights) { return false; }
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (2u * i >= uint(rays.at.length())) return;
    vec4 origin = rays.at[2u * i], direction = rays.at[2u * i + 1u];
    Hit hit = traverse(make_ray(origin.xyz, direction.xyz), root.it, 0.0, direction.w, origin.w != 0.0, false);
    if (unfinished) hit.t = -1.0;
    hits.at[i] = vec4(hit.t, uintBitsToFloat(hit.triangle), hit.weights);
}
";

struct Ray {
    origin: Vec3,
    direction: Vec3,
    /// Distance before which any hit counts.
    any_before: Option<f32>,
}

struct Found {
    t: f32,
    triangle: Option<usize>,
    weights: [f32; 2],
}

fn trace(bvh: &Bvh, rays: &[Ray]) -> Vec<Found> {
    trace_under(0, bvh, rays)
}

fn trace_under(root: u32, bvh: &Bvh, rays: &[Ray]) -> Vec<Found> {
    let mut sources = BTreeMap::new();
    for folder in ["lib", "bvh"] {
        for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl").join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{folder}/{}", path.file_name().unwrap().to_str().unwrap());
            sources.insert(name, std::fs::read_to_string(&path).unwrap());
        }
    }
    sources.insert("test/rays.comp".into(), SHADER.into());
    let mut engine = Engine::new(gpu(), Library::from_sources(sources));
    let device = DeviceBvh::upload(&mut engine.gpu, "test", bvh.clone()).unwrap();
    let numbers = |ray: &Ray| {
        let (o, d) = (ray.origin, ray.direction);
        [[o.x, o.y, o.z, f32::from(ray.any_before.is_some())], [d.x, d.y, d.z, ray.any_before.unwrap_or(1e30)]]
    };
    let mut g = Graph::new();
    let handles = device.import(&mut g);
    let from = g.upload("test/rays", rays.iter().flat_map(numbers).collect::<Vec<_>>().as_slice());
    let root = g.upload("test/root", &[root]);
    let to = g.buffer::<[f32; 4]>("test/hits", rays.len() as u32);
    g.compute("test/rays")
        .reads("bvh", handles.data)
        .reads("bvh_nodes", handles.nodes)
        .reads("bvh_triangles", handles.triangles)
        .reads("rays", from)
        .reads("root", root)
        .writes("hits", to)
        .constant("MASKS", true)
        .constant("SINGLE_SIDES", true)
        .dispatch([rays.len() as u32, 1, 1]);
    let read = g.read_back(to);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let hits: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(outcome.bytes(read));
    finish(&engine.gpu);
    assert!(hits.iter().all(|hit| hit[0] >= 0.0), "a traversal did not end");
    let found = |hit: [f32; 4]| Found {
        t: hit[0],
        triangle: (hit[1].to_bits() != u32::MAX).then_some(hit[1].to_bits() as usize),
        weights: [hit[2], hit[3]],
    };
    hits.into_iter().map(found).collect()
}

fn corners(bvh: &Bvh, triangle: usize) -> [DVec3; 3] {
    let record = &bvh.triangles[triangle];
    [0, 4, 8].map(|at| Vec3::new(f32::from_bits(record[at]), f32::from_bits(record[at + 1]), f32::from_bits(record[at + 2])).as_dvec3())
}

/// Distance to a triangle, in 64 bits (Möller and Trumbore 1997).
fn meets([a, b, c]: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = (origin - *a) / determinant;
    let (u, q) = (s.dot(p), s.cross(ab));
    let v = direction.dot(q);
    let t = ac.dot(q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(t)
}

fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / 4_294_967_296.0
}

/// Rays from random points in the scene's bounds in random directions.
fn random_rays(scene: &Scene, count: usize) -> Vec<Ray> {
    let bounds = scene.bounds();
    let mut state = 1;
    let mut anywhere = || Vec3::new(random(&mut state), random(&mut state), random(&mut state));
    let ray = |i: usize| {
        let mut direction = (anywhere() * 2.0 - 1.0) * if i.is_multiple_of(5) { 40.0 } else { 1.0 };
        // Some rays have components that are exactly 0.
        if i.is_multiple_of(17) {
            direction[i % 3] = 0.0;
        }
        if i.is_multiple_of(51) {
            direction[(i + 1) % 3] = 0.0;
        }
        Ray { origin: bounds.min + anywhere() * bounds.size(), direction, any_before: None }
    };
    (0..count).map(ray).filter(|ray| ray.direction != Vec3::ZERO).collect()
}

fn compare(name: &str, scene: &Scene) {
    let bvh = Bvh::build(scene);
    let all = scene.triangle_count() as usize;
    // The root of all triangles, and the root of emitting triangles, which are stored last.
    if bvh.emitting.root == 0 {
        assert_eq!(bvh.triangles.len(), all, "{name}");
    } else {
        assert_eq!(bvh.emitting.first, all, "{name}");
        compare_under(&format!("{name}, what emits"), scene, &bvh, bvh.emitting.root, all..bvh.triangles.len());
    }
    compare_under(name, scene, &bvh, 0, 0..all);
}

fn compare_under(name: &str, scene: &Scene, bvh: &Bvh, root: u32, numbers: Range<usize>) {
    let (first, few) = (numbers.start, numbers.start > 0);
    let triangles: Vec<[DVec3; 3]> = numbers.map(|i| corners(bvh, i)).collect();
    let mut rays = random_rays(scene, 10_000);
    if few {
        // Rays are aimed at triangles, since random rays seldom hit small ones.
        for (ray, [a, b, c]) in rays.iter_mut().zip(triangles.iter().cycle()) {
            ray.direction = ((a * 0.5 + b * 0.3 + c * 0.2) - ray.origin.as_dvec3()).as_vec3();
        }
    }
    let nearest: Vec<Option<f64>> = rays
        .par_iter()
        .map(|ray| {
            let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            triangles.iter().filter_map(|triangle| meets(triangle, origin, direction)).min_by(f64::total_cmp)
        })
        .collect();
    let hits = trace_under(root, bvh, &rays);
    assert!(
        nearest.iter().flatten().count() > if few { 100 } else { 5000 },
        "{name}: {} hits are too few to tell",
        nearest.iter().flatten().count()
    );
    for ((ray, found), expected) in rays.iter().zip(&hits).zip(&nearest) {
        let ray = (ray.origin, ray.direction);
        let Some(expected) = *expected else {
            assert!(found.triangle.is_none(), "{name}: {ray:?} meets a triangle at {} and should not", found.t);
            continue;
        };
        let triangle = found.triangle.unwrap_or_else(|| panic!("{name}: {ray:?} misses, and should meet a triangle at {expected}"));
        let [a, b, c] = triangles[triangle - first];
        // The distance is the less exact, the more a ray grazes the triangle.
        let cosine = (b - a).cross(c - a).normalize_or_zero().dot(ray.1.as_dvec3().normalize()).abs();
        let tolerance = 1e-4 * expected.max(1e-2) * (0.2 / cosine.max(1e-3)).max(1.0);
        assert!((f64::from(found.t) - expected).abs() <= tolerance, "{name}: {ray:?}: {} instead of {expected}", found.t);
        // The weights give the same point.
        let [v, w] = found.weights.map(f64::from);
        let place = a * (1.0 - v - w) + b * v + c * w;
        let along = ray.0.as_dvec3() + ray.1.as_dvec3() * expected;
        assert!(
            place.distance(along) < 1e-3 * (0.2 / cosine.max(1e-3)).max(1.0),
            "{name}: {ray:?}: at {place} by the weights, at {along} by the distance"
        );
    }
    // A shadow ray is only stopped by hits before its end.
    for (ray, expected) in rays.iter_mut().zip(&nearest) {
        ray.any_before = Some(expected.map_or(1e30, |t| t as f32 * if ray.origin.x > 0.0 { 1.01 } else { 0.99 }));
    }
    for ((ray, found), expected) in rays.iter().zip(trace_under(root, bvh, &rays)).zip(&nearest) {
        let stopped = expected.is_some() && ray.origin.x > 0.0;
        assert_eq!(found.triangle.is_some(), stopped, "{name}: a shadow ray from {} along {}", ray.origin, ray.direction);
    }
}

#[test]
fn the_hierarchy_finds_the_hits_that_all_triangles_have() {
    compare("cornell", &builtin::cornell());
    let mut atrium = builtin::atrium(&Atrium { triangles: 20_000, seed: 0 });
    compare("atrium", &atrium);
    // A material with few triangles emits light.
    let few = atrium.draws.iter().filter(|draw| draw.index_count < 3000).max_by_key(|draw| draw.index_count).unwrap().material;
    atrium.materials[few as usize].emission = [1.0; 3];
    assert_ne!(Bvh::build(&atrium).emitting.root, 0, "the test wants a tree of what emits");
    compare("atrium with lights", &atrium);
    if let Some(scene) = shared_scene("sponza_dabrovic.glb") {
        compare("Sponza", &scene);
    }
}

/// Rays from inside a closed surface at its very vertices and edges: none slips through.
#[test]
fn no_ray_slips_through_between_two_triangles() {
    // A sphere of few triangles, with corners that floats cannot represent exactly.
    let mut mesh = manylight::scene::builder::Mesh::default();
    const N: u32 = 16;
    let place = |i: u32, j: u32| {
        let (theta, phi) = (j as f32 / N as f32 * std::f32::consts::PI, (i % N) as f32 / N as f32 * std::f32::consts::TAU);
        Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()) * 3.3
    };
    for j in 0..N {
        for i in 0..N {
            let corners = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
            let first = corners.map(|p| mesh.vertex(p, p.normalize_or(Vec3::Y), glam::Vec2::ZERO));
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                let [a, b, c] = triangle.map(|k: usize| corners[k]);
                if (b - a).cross(c - a).length() > 1e-6 {
                    mesh.indices.extend(triangle.map(|k| first[k]));
                }
            }
        }
    }
    let mut scene = Scene::default();
    let material = scene.add_material(matte([0.5; 3]));
    scene.add_mesh(&mesh, material, &[glam::Affine3A::IDENTITY]);
    let bvh = Bvh::build(&scene);
    let mut rays = Vec::new();
    for origin in [Vec3::ZERO, Vec3::new(0.3, -0.7, 0.11), Vec3::new(-1.9, 0.4, 1.3)] {
        for triangle in 0..bvh.triangles.len() {
            let [a, b, c] = corners(&bvh, triangle).map(|corner| corner.as_vec3());
            for k in 0..20 {
                let s = k as f32 / 19.0;
                for target in [a.lerp(b, s), b.lerp(c, s), c.lerp(a, s)] {
                    rays.push(Ray { origin, direction: target - origin, any_before: None });
                }
            }
        }
    }
    let missed = trace(&bvh, &rays).iter().filter(|found| found.triangle.is_none()).count();
    assert_eq!(missed, 0, "of {} rays", rays.len());
}

#[test]
fn a_scene_of_one_triangle_or_none_has_a_hierarchy_too() {
    let empty = Bvh::build(&Scene::default());
    let inside = Ray { origin: Vec3::ZERO, direction: Vec3::ONE, any_before: None };
    assert!(trace(&empty, &[inside])[0].triangle.is_none());
    let up = |x: f32| Ray { origin: Vec3::new(x, -1.0, 0.1), direction: Vec3::Y, any_before: None };
    assert!(trace(&empty, &[up(0.1)])[0].triangle.is_none());
    let mut scene = Scene::default();
    let mut mesh = manylight::scene::builder::Mesh::default();
    let corners = [Vec3::ZERO, Vec3::Z, Vec3::X].map(|p| mesh.vertex(p, Vec3::Y, glam::Vec2::ZERO));
    mesh.indices.extend(corners);
    let material = scene.add_material(matte([0.5; 3]));
    scene.add_mesh(&mesh, material, &[glam::Affine3A::IDENTITY]);
    let hits = trace(&Bvh::build(&scene), &[up(0.1), up(2.0)]);
    assert_eq!((hits[0].triangle, hits[1].triangle), (Some(0), None));
    assert!((hits[0].t - 1.0).abs() < 1e-6);
}
