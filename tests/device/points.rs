//! Points of imperfect shadow maps on triangles, by the tessellator and by a compute pass.

use crate::common::*;
use glam::{Vec2, Vec3};
use manylight::config::{Builtin, Collect, Config, IsmRenderer, PointSet, SceneConfig, VisibilityMethod};
use manylight::renderer::{Rendered, Renderer};
use manylight::scene::Scene;
use manylight::scene::pack::octahedral_inverse;
use manylight::scene::source::load_scene;
use std::collections::{BTreeMap, BTreeSet};

/// A point as in the buffers, by `glsl/visibility/point.glsl`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub position: Vec3,
    pub packed: u32,
    pub partition: usize,
}

impl Point {
    /// Area that the point stands for, m^2, in a scene of this diagonal.
    pub fn area(&self, diagonal: f32) -> f64 {
        let radius = f64::from(diagonal) * ((f64::from(self.packed >> 20 & 2047) - 2047.0) / 96.0).exp2();
        std::f64::consts::PI * radius * radius
    }

    fn normal(&self) -> Vec3 {
        octahedral_inverse((Vec2::new((self.packed & 1023) as f32, (self.packed >> 10 & 1023) as f32) - 512.0) / 511.0)
    }

    /// Whether normal, radius and sides agree up to their packing.
    fn looks_like(&self, other: &Self) -> bool {
        let radii = [self, other].map(|point| (point.packed >> 20 & 2047) as i32);
        self.normal().distance(other.normal()) < 0.01 && (radii[0] - radii[1]).abs() <= 1 && self.packed >> 31 == other.packed >> 31
    }
}

/// All ways to the points of imperfect shadow maps.
pub const WAYS: [(Collect, PointSet, IsmRenderer); 6] = [
    (Collect::Compute, PointSet::Uniform, IsmRenderer::SinglePixel),
    (Collect::Tessellation, PointSet::Uniform, IsmRenderer::SinglePixel),
    (Collect::Stored, PointSet::Uniform, IsmRenderer::SinglePixel),
    (Collect::Compute, PointSet::Adaptive, IsmRenderer::SinglePixel),
    (Collect::Tessellation, PointSet::Uniform, IsmRenderer::Splat),
    (Collect::Stored, PointSet::Uniform, IsmRenderer::Splat),
];

pub fn config(points: u32) -> Config {
    let mut config = plain([64, 36], Vec3::new(0.1, 1.0, 0.2), Vec3::new(0.3, 0.9, -1.0), 60.0, directional(Vec3::NEG_Y, [1.0; 3]));
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    config.visibility.ism.point_count = points;
    config.visibility.ism.map_size = 16;
    config.vpls.count = 64;
    config
}

/// The points of a frame, by partition.
pub fn points(renderer: &mut Renderer, config: &Config, frame: u32) -> Vec<Point> {
    points_of(&points_rendered(renderer, config, frame))
}

/// A frame with its points.
pub fn points_rendered(renderer: &mut Renderer, config: &Config, frame: u32) -> Rendered {
    let pass = match config.visibility.ism.collect {
        Collect::Compute => "visibility/points-computed",
        Collect::Tessellation => "visibility/points-tessellated",
        Collect::Stored => "visibility/points-stored",
    };
    dump(renderer, config, frame, &[pass])
}

pub fn points_of(rendered: &Rendered) -> Vec<Point> {
    let words = |name: &str| -> Vec<u32> { words(dumped(rendered, name)).collect() };
    let buffer = words("visibility/points");
    if rendered.dumps.iter().all(|dump| dump.resource != "visibility/fill") {
        // Stored points, all in one piece.
        return buffer.chunks_exact(4).map(|p| point(p, 0)).collect();
    }
    let fill = words("visibility/fill");
    let capacity = buffer.len() / 4 / fill.len();
    let mut all = Vec::new();
    for (partition, held) in fill.iter().enumerate() {
        assert!(*held as usize <= capacity, "partition {partition} holds {held} of {capacity}");
        for p in buffer[4 * partition * capacity..].chunks_exact(4).take(*held as usize) {
            all.push(point(p, partition));
        }
    }
    all
}

fn point(words: &[u32], partition: usize) -> Point {
    Point { position: Vec3::from_array([words[0], words[1], words[2]].map(f32::from_bits)), packed: words[3], partition }
}

/// The pool of points that adaptive maps draw from, without its empty places, and the points drawn for the VPLs' maps.
fn pool(renderer: &mut Renderer, config: &Config) -> (Vec<Point>, Vec<Point>) {
    let mut config = config.clone();
    config.visibility.ism.points = PointSet::Adaptive;
    let rendered = dump(renderer, &config, 0, &["visibility/pool-scan", "visibility/pool-points", "visibility/points-adaptive"]);
    let words = |name: &str| words(dumped(&rendered, name)).collect::<Vec<u32>>();
    let (places, drawn) =
        (*words("visibility/pool-begins").last().unwrap() as usize, words("visibility/fill").iter().sum::<u32>() as usize);
    let all = |name: &str, count: usize| words(name).chunks_exact(4).take(count).map(|p| point(p, 0)).collect::<Vec<_>>();
    let pool = all("visibility/pool", places).into_iter().filter(|point| point.packed != 0).collect();
    (pool, all("visibility/points", drawn))
}

/// Triangles so large that they are split before tessellation.
fn huge() -> Scene {
    let mut scene = Scene::default();
    add_quad(
        &mut scene,
        [Vec3::new(-3.0, 0.0, 2.0), Vec3::new(4.0, 0.0, 3.0), Vec3::new(5.0, 1.0, -4.0), Vec3::new(-2.0, 1.0, -5.0)],
        matte([0.5; 3]),
    );
    scene
}

fn scenes() -> Vec<(&'static str, Scene, u32)> {
    let builtin = |builtin, triangles| load_scene(&SceneConfig { builtin: Some(builtin), triangles, ..SceneConfig::default() }).unwrap().0;
    let some = SceneConfig::default().triangles;
    vec![
        ("two triangles", huge(), 20_000),
        ("cornell", builtin(Builtin::Cornell, some), 5_000),
        ("cornell, finer", builtin(Builtin::Cornell, some), 60_000),
        ("cornell, finest", builtin(Builtin::Cornell, some), 326_000),
        ("atrium", builtin(Builtin::Atrium, 20_000), 60_000),
    ]
}

#[test]
fn both_ways_of_collecting_make_the_same_points() {
    for (name, scene, count) in scenes() {
        let mut renderer = renderer(scene);
        let mut config = config(count);
        let mut sets = [Collect::Compute, Collect::Tessellation].map(|collect| {
            config.visibility.ism.collect = collect;
            let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
            let points = points(&mut renderer, &config, 0);
            points.iter().for_each(|point| *counts.entry(point.partition).or_default() += 1);
            (points, counts)
        });
        let [(computed, by_compute), (tessellated, by_tessellator)] = &mut sets;
        println!("{name}: {} computed, {} tessellated", computed.len(), tessellated.len());
        assert_eq!(computed.len(), tessellated.len(), "{name}");
        assert_eq!(by_compute, by_tessellator, "{name}: points of each partition");
        // Every point has a twin in the same partition.
        let extent = renderer.world().device().bounds.size().length();
        let mut partitions: BTreeMap<usize, Vec<Point>> = BTreeMap::new();
        computed.iter().for_each(|point| partitions.entry(point.partition).or_default().push(*point));
        for point in tessellated.iter() {
            let is_twin = |other: &&Point| other.position.distance(point.position) < 1e-4 * extent && other.looks_like(point);
            assert!(partitions[&point.partition].iter().any(|other| is_twin(&other)), "{name}: {point:?} has no twin");
        }
        finish(renderer.gpu());
    }
}

#[test]
fn small_triangles_are_thinned_for_adaptive_points_as_for_uniform_ones() {
    // The scene has far more triangles than points.
    let scene = SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, ..SceneConfig::default() };
    let mut renderer = renderer(load_scene(&scene).unwrap().0);
    let mut config = config(2_000);
    let sorted = |points: &[Point]| {
        let mut bits: Vec<_> = points.iter().map(|point| (point.position.to_array().map(f32::to_bits), point.packed)).collect();
        bits.sort_unstable();
        bits
    };
    let counts = [false, true].map(|thin| {
        config.visibility.ism.thin = thin;
        let rendered = points_rendered(&mut renderer, &config, 0);
        let uniform = points_of(&rendered);
        let (pool, drawn) = pool(&mut renderer, &config);
        assert_eq!(sorted(&uniform), sorted(&pool), "thinned: {thin}");
        let places: BTreeSet<[u32; 3]> = pool.iter().map(|point| point.position.to_array().map(f32::to_bits)).collect();
        assert!(drawn.len() > 1000 && drawn.iter().all(|point| places.contains(&point.position.to_array().map(f32::to_bits))));
        // Leaves have holes.
        let (made, holes) = (count(&rendered, "visibility/made-points"), count(&rendered, "visibility/points-in-holes"));
        assert!(holes > 0 && made == pool.len() as u64 + holes, "{made} points, {holes} in holes, {} left", pool.len());
        made
    });
    println!("{} points, thinned {}", counts[0], counts[1]);
    assert!(counts[0] >= 20_000 && (1_800..2_200).contains(&counts[1]), "{counts:?}");
    finish(renderer.gpu());
}
