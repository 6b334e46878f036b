//! Points of imperfect shadow maps on surfaces with alpha masks.

use crate::common::*;
use crate::points::{WAYS, config as config_of_points, points_of, points_rendered};
use glam::{Affine3A, Vec2, Vec3};
use manylight::config::{Collect, Config, FrameConfig, VisibilityMethod};
use manylight::scene::builder::Mesh;
use manylight::scene::{Filter, Map, Material, Scene, Texture};
use std::collections::BTreeMap;

/// Squares across and down the card's mask: holes and surface by turns. A third of the rows is holes throughout.
const SQUARES: u32 = 6;

fn is_hole_at(uv: Vec2) -> bool {
    let [x, y] = (uv.clamp(Vec2::ZERO, Vec2::splat(0.9999)) * SQUARES as f32).to_array().map(|n| n as u32);
    (x + y) % 2 == 1 || y % 3 == 2
}

/// Share of the card that is there.
fn share() -> f64 {
    let at = |i: u32| Vec2::new((i % SQUARES) as f32 + 0.5, (i / SQUARES) as f32 + 0.5) / SQUARES as f32;
    (0..SQUARES * SQUARES).filter(|i| !is_hole_at(at(*i))).count() as f64 / f64::from(SQUARES * SQUARES)
}

/// What makes the card's holes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Holes {
    Mask,
    /// Squares of the card are left out.
    Shape,
    None,
}

/// A floor, a ceiling four metres above, and a card of some triangles between them.
fn hall(holes: Holes, triangles: u32) -> Scene {
    let mut scene = Scene { name: "hall".into(), ..Scene::default() };
    let square = |y: f32, side: f32, up: bool| {
        let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, z]| Vec3::new(side * x, y, side * z));
        if up { corners } else { [corners[3], corners[2], corners[1], corners[0]] }
    };
    add_quad(&mut scene, square(0.0, 3.0, true), matte([0.7; 3]));
    add_quad(&mut scene, square(4.0, 3.0, false), matte([0.7; 3]));
    let texels = (0..SQUARES * SQUARES).flat_map(|i| {
        let at = Vec2::new((i % SQUARES) as f32 + 0.5, (i / SQUARES) as f32 + 0.5) / SQUARES as f32;
        [255, 255, 255, if is_hole_at(at) { 0 } else { 255 }]
    });
    let texture = Texture { name: "mask".into(), width: SQUARES, height: SQUARES, srgb: true, texels: texels.collect() };
    let texture = scene.add_texture(texture);
    let map = Map { filter: Filter::Nearest, ..Map::new(texture) };
    let material =
        Material { double_sided: true, base_color_map: Some(map), alpha_cutoff: (holes == Holes::Mask).then_some(0.5), ..matte([0.5; 3]) };
    let material = scene.add_material(material);
    let mut mesh = Mesh::default();
    let n = (triangles / 2).isqrt();
    let at = |i: u32, j: u32| Vec2::new(i as f32, j as f32) / n as f32;
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        if holes == Holes::Shape && is_hole_at(at(i, j) + 0.5 / n as f32) {
            continue;
        }
        let uvs = [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j), at(i, j)];
        mesh.quad(uvs.map(|uv| Vec3::new(5.0 * uv.x - 2.5, 1.5, 5.0 * uv.y - 2.5)), uvs);
    }
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY]);
    scene
}

const POINTS: u32 = 320_000;

/// The ceiling, seen from below the middle of the card's edge; a spot light makes VPLs on the floor.
fn config() -> Config {
    let light = spot(Vec3::new(0.0, 1.0, 0.0), Vec3::NEG_Y, [10.0; 3], 60.0, 70.0);
    let mut config = plain([64, 48], Vec3::new(0.0, 2.0, 2.9), Vec3::new(0.0, 4.0, -0.5), 70.0, light);
    config.vpls.count = 256;
    config.rsm.size = [128, 128];
    config.visibility.ism.point_count = POINTS;
    config
}

fn energy(scene: Scene, config: &Config) -> f64 {
    let mut renderer = traced(scene);
    let mut of_seed = |seed| -> f64 {
        let config = Config { frame: FrameConfig { seed, ..config.frame.clone() }, ..config.clone() };
        picture(&mut renderer, &config).indirect.rgb().map(|rgb| f64::from(rgb.element_sum())).sum()
    };
    let energy = (0..4).map(&mut of_seed).sum();
    finish(renderer.gpu());
    energy
}

#[test]
fn light_passes_through_the_holes_of_a_card() {
    let mut config = config();
    config.visibility.method = VisibilityMethod::RayTraced;
    let truth = energy(hall(Holes::Mask, 2), &config);
    let closed = energy(hall(Holes::None, 2), &config);
    config.visibility.method = VisibilityMethod::None;
    let open = energy(hall(Holes::Mask, 2), &config);
    println!("rays: {truth}; a card without holes lets {:.3} of it through, no card {:.3}", closed / truth, open / truth);
    assert!(closed < 0.75 * truth && open > 1.2 * truth);
    let shape = {
        config.visibility.method = VisibilityMethod::RayTraced;
        energy(hall(Holes::Shape, 2 * SQUARES.pow(2)), &config) / truth
    };
    assert!((shape - 1.0).abs() < 1e-3, "squares let {shape} of the light of the mask's holes through");
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    let mut wrong = false;
    for (collect, points, renderer) in WAYS {
        (config.visibility.ism.collect, config.visibility.ism.points, config.visibility.ism.renderer) = (collect, points, renderer);
        for triangles in [2 * SQUARES.pow(2), 2 * (16 * SQUARES).pow(2)] {
            // As dense as on the whole card: floor and ceiling have 36 m^2 each, the card has 25.
            config.visibility.ism.point_count = (f64::from(POINTS) * (72.0 + 25.0 * share()) / 97.0) as u32;
            let shape = energy(hall(Holes::Shape, triangles), &config) / truth;
            config.visibility.ism.point_count = POINTS;
            let found = energy(hall(Holes::Mask, triangles), &config) / truth;
            println!("{collect:?} {points:?} {renderer:?}, {triangles} triangles: {found:.4} by a mask, {shape:.4} by squares");
            wrong |= (found - shape).abs() > 0.03;
        }
    }
    assert!(!wrong);
}

#[test]
fn the_points_that_are_left_lie_where_the_surface_is() {
    for (triangles, collect) in [2, 20_000].into_iter().flat_map(|n| WAYS[..3].iter().map(move |way| (n, way.0))) {
        let mut renderer = renderer(hall(Holes::Mask, triangles));
        let mut config = config_of_points(60_000);
        config.light = self::config().light;
        config.visibility.ism.collect = collect;
        let rendered = points_rendered(&mut renderer, &config, 0);
        let (made, holes) = (count(&rendered, "visibility/made-points"), count(&rendered, "visibility/points-in-holes"));
        let left: Vec<Vec3> = points_of(&rendered).into_iter().filter(|point| point.packed != 0).map(|point| point.position).collect();
        assert_eq!(left.len() as u64, made - holes);
        let card: Vec<Vec3> = left.into_iter().filter(|place| (place.y - 1.5).abs() < 1e-3).collect();
        for place in &card {
            let uv = (Vec2::new(place.x, place.z) + 2.5) / 5.0;
            // Points at the very edge of a square may round to either side.
            let within = uv * SQUARES as f32;
            let off = (within - within.round()).abs().min_element();
            assert!(!is_hole_at(uv) || off < 1e-3, "{triangles}, {collect:?}: a point in a hole, {uv}");
        }
        let kept = card.len() as f64 / (card.len() as u64 + holes) as f64;
        println!("{triangles} triangles, {collect:?}: {kept:.4} of the card's points are left, {:.4} of the card is there", share());
        assert!((kept - share()).abs() < 0.015, "{triangles} triangles, {collect:?}: {kept} of the card's points are left");
        finish(renderer.gpu());
    }
}

/// Both make the same points of masked surfaces, up to rounding at the edges of holes.
#[test]
fn the_tessellator_and_the_compute_pass_leave_the_same_points_out() {
    for triangles in [2, 5_000] {
        let mut renderer = renderer(hall(Holes::Mask, triangles));
        let mut config = config_of_points(30_000);
        config.light = self::config().light;
        let [computed, tessellated] = [Collect::Compute, Collect::Tessellation].map(|collect| {
            config.visibility.ism.collect = collect;
            let mut partitions: BTreeMap<usize, Vec<Vec3>> = BTreeMap::new();
            for point in points_of(&points_rendered(&mut renderer, &config, 0)) {
                partitions.entry(point.partition).or_default().push(point.position);
            }
            partitions
        });
        let count = |partitions: &BTreeMap<usize, Vec<Vec3>>| partitions.values().map(Vec::len).sum::<usize>();
        let has_twin = |partition, place: &Vec3| computed[partition].iter().any(|other| other.distance(*place) < 1e-3);
        let alone = tessellated.iter().flat_map(|(partition, places)| places.iter().map(move |place| (partition, place)));
        let alone = alone.filter(|(partition, place)| !has_twin(partition, place)).count();
        println!("{triangles} triangles: {} and {} points, {alone} alone", count(&computed), count(&tessellated));
        assert!(count(&computed).abs_diff(count(&tessellated)) < 20 && alone < 20, "{triangles} triangles: {alone} without a twin");
        finish(renderer.gpu());
    }
}
