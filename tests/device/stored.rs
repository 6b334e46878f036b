//! Stored points: their places, their number, and the maps that they give.

use crate::common::*;
use crate::make::Make;
use crate::points::{config, points, points_rendered};
use glam::{Affine3A, Vec2, Vec3};
use manylight::config::{Builtin, Collect, Config, IsmRenderer, SceneConfig, VisibilityMethod};
use manylight::scene::builder::Mesh;
use manylight::scene::source::load_scene;
use manylight::scene::{Draw, Scene};
use manylight::stages::visibility::stored::{self, HostSegment};
use std::collections::BTreeMap;

/// A globe by longitude and latitude: its triangles are of many sizes.
fn globe() -> Scene {
    let mut mesh = Mesh::default();
    let at = |i: u32, j: u32| {
        let (u, v) = (i as f32 / 60.0 * std::f32::consts::TAU, (j as f32 + 0.02) / 30.04 * std::f32::consts::PI);
        Vec3::new(v.sin() * u.cos(), v.cos(), v.sin() * u.sin()) * (1.0 + 0.3 * (3.0 * u).sin() * v.sin())
    };
    for (i, j) in (0..60).flat_map(|i| (0..30).map(move |j| (i, j))) {
        mesh.quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], [Vec2::ZERO; 4]);
    }
    let mut scene = Scene { name: "globe".into(), ..Scene::default() };
    let material = scene.add_material(matte([0.5; 3]));
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY, Affine3A::from_translation(2.5 * Vec3::X)]);
    scene
}

fn corners(scene: &Scene, draw: &Draw) -> Vec<[Vec3; 3]> {
    let places: Vec<Vec3> = scene.draw_vertices(draw).map(|v| draw.transform.transform_point3(v.position.into())).collect();
    places.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

fn area([a, b, c]: [Vec3; 3]) -> f64 {
    0.5 * f64::from((b - a).cross(c - a).length())
}

fn surface(scene: &Scene) -> f64 {
    scene.draws.iter().flat_map(|draw| corners(scene, draw)).map(area).sum()
}

const ALL: u64 = u64::MAX;

#[test]
fn every_triangle_has_its_share_of_the_stored_points() {
    let scene = globe();
    let surface = surface(&scene);
    let lots = [(10_000, [ALL, ALL]), (100_000, [30_000, ALL]), (100_000, [ALL, 1000]), (500, [ALL, 100])];
    for ((count, most), thin) in lots.into_iter().flat_map(|lot| [(lot, true), (lot, false)]) {
        let segments: Vec<HostSegment> = stored::make(&scene, count, thin, most).collect();
        let again: Vec<HostSegment> = stored::make(&scene, count, thin, most).collect();
        assert!(segments == again, "{count}: other points at the second time");
        let (mut of_triangles, mut stand_for) = (BTreeMap::new(), 0.0);
        for (records, triangles) in &segments {
            assert!(records.len() as u64 <= most[0] && triangles.len() as u64 <= most[1], "{} {}", records.len(), triangles.len());
            for record in records {
                let triangle = &triangles[record.triangle as usize];
                assert!((record.weights & 0xffff) + (record.weights >> 16) <= 0xffff, "outside of the triangle: {record:?}");
                let transform = scene.draws[triangle.draw as usize].transform;
                let corners = triangle.corners.map(|i| transform.transform_point3(scene.vertices[i as usize].position.into()));
                stand_for += area(corners) * f64::from(triangle.share);
                of_triangles.entry((triangle.draw, triangle.corners)).or_insert((0, area(corners))).0 += 1;
            }
        }
        let held: u32 = of_triangles.values().map(|(held, _)| held).sum();
        assert_eq!(held, count);
        assert!((stand_for / surface - 1.0).abs() < 1e-4, "{count}: they stand for {stand_for} of {surface} m^2");
        for (held, area) in of_triangles.values() {
            let share = area / surface * f64::from(count);
            // Where small triangles have one point each, less is left to the others.
            let close = if thin { (f64::from(*held) - share).abs() < 2.0 } else { f64::from(*held) > 0.7 * share - 2.0 };
            assert!(close, "{held} points on a triangle whose share is {share}");
        }
        if !thin && count > 7200 {
            let areas = scene.draws.iter().flat_map(|draw| corners(&scene, draw)).map(area);
            assert_eq!(of_triangles.len(), areas.filter(|area| *area > 0.0).count(), "every triangle has a point");
        }
        println!("{count}, thinned {thin}: {} segments, {} triangles", segments.len(), of_triangles.len());
        assert!(segments.len() > usize::from(most != [ALL, ALL]));
    }
}

/// A run of the order is spread over all surfaces: the points of a map hit each of many equal parts of the surface.
#[test]
fn any_run_of_stored_points_is_spread_over_all_surfaces() {
    let scene = globe();
    let (records, triangles) = stored::make(&scene, 40_000, true, [ALL, ALL]).next().unwrap();
    let each = 400;
    for run in records.chunks_exact(each) {
        // Triangles are in the order of the running sum of areas, in which the points are equally dense.
        let mut places: Vec<f64> = run.iter().map(|record| f64::from(record.triangle) / triangles.len() as f64).collect();
        places.sort_by(f64::total_cmp);
        let widest = places.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(widest < 8.0 / each as f64, "a gap of {widest} in a run of {each} points");
    }
}

/// Two plates that turn while one of them is stretched along an axis.
fn plates_in_motion() -> Scene {
    let mut make = Make::square();
    make.json["materials"] = serde_json::json!([{"doubleSided": true, "pbrMetallicRoughness": {"metallicFactor": 0}}]);
    make.primitive()["material"] = serde_json::json!(0);
    make.json["nodes"] = serde_json::json!([{"mesh": 0, "scale": [1, 0.1, 1]}, {"mesh": 0, "translation": [-2, 0, -1]}]);
    make.json["scenes"][0]["nodes"] = serde_json::json!([0, 1]);
    let h = std::f32::consts::FRAC_1_SQRT_2;
    make.animate(0, "scale", "LINEAR", &[0.0, 2.0], &[1.0, 0.1, 1.0, 1.0, 3.0, 1.0]);
    make.animate(1, "rotation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 1.0, 0.0, h, 0.0, h]);
    make.scene()
}

#[test]
fn stored_points_move_with_their_triangles_and_their_areas_sum_to_the_surface() {
    for (name, scene, frames) in
        [("globe", globe(), &[0][..]), ("plates", plates_in_motion(), &[0, 1, 2, 3]), ("figure", figure(), &[0, 1, 3])]
    {
        let mut host = scene.clone();
        let (records, triangles) = stored::make(&scene, 50_000, false, [ALL, ALL]).next().unwrap();
        let mut renderer = renderer(scene);
        let mut config = config(50_000);
        config.frame.fps = 2.0;
        config.visibility.ism.collect = Collect::Stored;
        let diagonal = renderer.world().device().bounds.size().length();
        for frame in frames {
            host.set_time(f64::from(*frame) / 2.0);
            let rendered = points_rendered(&mut renderer, &config, *frame);
            assert_eq!((count(&rendered, "visibility/made-points"), count(&rendered, "visibility/asked-points")), (50_000, 50_000));
            let found = crate::points::points_of(&rendered);
            assert_eq!(found.len(), records.len());
            let mut sum = 0.0;
            for (point, record) in found.iter().zip(&records) {
                let triangle = &triangles[record.triangle as usize];
                let transform = host.draws[triangle.draw as usize].transform;
                let [a, b, c] = triangle.corners.map(|i| transform.transform_point3(host.vertices[i as usize].position.into()));
                let weights = Vec2::new((record.weights & 0xffff) as f32, (record.weights >> 16) as f32) / 65_535.0;
                let expected = a + (b - a) * weights.x + (c - a) * weights.y;
                assert!(point.position.distance(expected) < 1e-4 * diagonal, "{name}, frame {frame}: {point:?}, not at {expected}");
                sum += point.area(diagonal);
            }
            let surface = surface(&host);
            println!("{name}, frame {frame}: {sum} of {surface} m^2");
            assert!((sum / surface - 1.0).abs() < 1e-3, "{name}, frame {frame}: {sum} of {surface} m^2");
        }
        finish(renderer.gpu());
    }
}

/// The figure bends by a skin and a morph target, and turns.
fn figure() -> Scene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/figure.glb");
    manylight::scene::gltf::load(&path, None).unwrap().scene
}

#[test]
fn points_of_meshes_that_bend_are_as_many_and_their_areas_sum_to_the_surface() {
    let scene = figure();
    let mut host = scene.clone();
    let mut renderer = renderer(scene);
    let mut config = config(60_000);
    config.frame.fps = 2.0;
    let diagonal = renderer.world().device().bounds.size().length();
    for frame in [0, 1, 3] {
        host.set_time(f64::from(frame) / 2.0);
        let surface = surface(&host);
        for collect in [Collect::Compute, Collect::Tessellation, Collect::Stored] {
            config.visibility.ism.collect = collect;
            let found = points(&mut renderer, &config, frame);
            let sum: f64 = found.iter().map(|point| point.area(diagonal)).sum();
            println!("frame {frame}, {collect:?}: {} points, {sum} of {surface} m^2", found.len());
            assert!((found.len() as f64 / 60_000.0 - 1.0).abs() < 0.05, "frame {frame}, {collect:?}: {} points", found.len());
            // Radii are stored in steps of 0.7 %. Those of stored points are rounded up or down by lot; all of the floor's are rounded alike.
            let most = if collect == Collect::Stored { 1e-3 } else { 7.5e-3 };
            assert!((sum / surface - 1.0).abs() < most, "frame {frame}, {collect:?}: {sum} of {surface} m^2");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn all_ways_of_collecting_make_as_many_points_as_asked_for() {
    let scene = SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, ..SceneConfig::default() };
    for (name, scene) in [("atrium", load_scene(&scene).unwrap().0), ("globe", globe())] {
        let surface = surface(&scene);
        let mut renderer = renderer(scene);
        let diagonal = renderer.world().device().bounds.size().length();
        for (collect, renders) in [
            (Collect::Compute, IsmRenderer::SinglePixel),
            (Collect::Tessellation, IsmRenderer::SinglePixel),
            (Collect::Tessellation, IsmRenderer::Splat),
            (Collect::Stored, IsmRenderer::SinglePixel),
            (Collect::Stored, IsmRenderer::Splat),
        ] {
            for asked in [10_000, 326_000] {
                let mut config = config(asked);
                (config.visibility.ism.collect, config.visibility.ism.renderer) = (collect, renders);
                config.visibility.ism.thin = true;
                let rendered = render(&mut renderer, &config, 0);
                let made = count(&rendered, "visibility/made-points");
                println!("{name} {collect:?} {renders:?}: {made} of {asked}");
                // Small triangles are drawn by lot.
                let most = if collect == Collect::Stored { 0 } else { u64::from(asked) / 100 };
                assert!(made.abs_diff(u64::from(asked)) <= most, "{name} {collect:?} {renders:?}: {made} of {asked}");
                assert!(rendered.warnings().is_empty(), "{:?}", rendered.warnings());
                if name == "globe" && renders == IsmRenderer::SinglePixel && collect != Collect::Stored && asked > 100_000 {
                    // Every triangle keeps its points.
                    config.visibility.ism.thin = false;
                    let sum: f64 = points(&mut renderer, &config, 0).iter().map(|point| point.area(diagonal)).sum();
                    println!("{collect:?}: {sum} of {surface} m^2");
                    assert!((sum / surface - 1.0).abs() < 1e-3, "{collect:?}: {sum} of {surface} m^2");
                }
            }
        }
        let mut config = config(2_000);
        config.visibility.ism.thin = false;
        let rendered = render(&mut renderer, &config, 0);
        let [warning] = rendered.warnings().try_into().unwrap();
        assert!(warning.contains("visibility.ism.point_count: 2000 points"), "{warning}");
        finish(renderer.gpu());
    }
}

/// Error of the indirect layer against exact visibility of the same VPLs.
fn relmse(test: &[Vec3], truth: &[Vec3]) -> f64 {
    let channels = test.iter().zip(truth).flat_map(|(t, r)| (0..3).map(|c| (f64::from(t[c]), f64::from(r[c]))));
    channels.map(|(t, r)| (t - r).powi(2) / (r * r + 0.01)).sum::<f64>() / (3 * test.len()) as f64
}

#[test]
fn the_maps_of_all_ways_err_alike() {
    let scene = SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, ..SceneConfig::default() };
    let mut renderer = traced(load_scene(&scene).unwrap().0);
    let mut config = Config { scene, ..Config::default() };
    config.frame.size = [160, 90];
    config.vpls.count = 1024;
    config.visibility.ism.point_count = 326_000;
    for renders in [IsmRenderer::SinglePixel, IsmRenderer::Splat] {
        let ways: &[Collect] = match renders {
            IsmRenderer::SinglePixel => &[Collect::Compute, Collect::Tessellation, Collect::Stored],
            IsmRenderer::Splat => &[Collect::Tessellation, Collect::Stored],
        };
        let mut errors = vec![0.0; ways.len()];
        for seed in 0..8 {
            config.frame.seed = seed;
            config.visibility.method = VisibilityMethod::RayTraced;
            let truth: Vec<Vec3> = picture(&mut renderer, &config).indirect.rgb().collect();
            config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
            config.visibility.ism.renderer = renders;
            for (error, collect) in errors.iter_mut().zip(ways) {
                config.visibility.ism.collect = *collect;
                let test: Vec<Vec3> = picture(&mut renderer, &config).indirect.rgb().collect();
                *error += relmse(&test, &truth) / 8.0;
            }
        }
        println!("{renders:?}: {ways:?} {errors:?}");
        let (least, most) = errors.iter().fold((f64::INFINITY, 0.0f64), |(least, most), e| (least.min(*e), most.max(*e)));
        assert!(most <= 1.1 * least, "{renders:?}: {ways:?} {errors:?}");
    }
    finish(renderer.gpu());
}

#[test]
fn points_that_no_buffer_holds_are_drawn_in_batches() {
    let mut renderer = renderer(globe());
    let mut config = config(50_000);
    config.vpls.count = 24;
    config.visibility.ism.normals = true;
    let mut maps = |capacity, collect| {
        config.visibility.ism.capacity = capacity;
        config.visibility.ism.collect = collect;
        let rendered = dump(&mut renderer, &config, 0, &["visibility/push-0"]);
        let buffers = rendered.memory.iter().filter(|(name, _)| name.starts_with("visibility/points")).count();
        assert!(rendered.memory.iter().all(|(_, bytes)| *bytes <= 128 << 20), "{:?}", rendered.memory);
        (buffers, count(&rendered, "visibility/made-points"), dumped(&rendered, "visibility/maps").to_vec())
    };
    for collect in [Collect::Compute, Collect::Tessellation] {
        let (one, many) = (maps(None, collect), maps(Some(1 << 20), collect));
        // 8 partitions of a million points of 16 bytes fit into 128 MiB.
        assert_eq!((one.0, many.0), (1, 3));
        assert!(one.1 == many.1 && one.2 == many.2, "{collect:?}: {} points, {} in batches", one.1, many.1);
    }
    finish(renderer.gpu());
}

#[test]
fn a_scene_without_area_has_no_points() {
    let mut scene = Scene { name: "a line".into(), ..Scene::default() };
    let mut mesh = Mesh::default();
    let [a, b, c] = [0.0, 1.0, 2.0].map(|x| mesh.vertex(Vec3::new(x, 0.0, 0.0), Vec3::Y, Vec2::ZERO));
    mesh.indices.extend([a, b, c]);
    let material = scene.add_material(matte([0.5; 3]));
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY]);
    let mut renderer = renderer(scene);
    for (renders, pass) in [(IsmRenderer::SinglePixel, "visibility/push-0"), (IsmRenderer::Splat, "visibility/splat-distances")] {
        for collect in [Collect::Compute, Collect::Tessellation, Collect::Stored] {
            let mut config = config(1000);
            (config.visibility.ism.collect, config.visibility.ism.renderer) = (collect, renders);
            let rendered = dump(&mut renderer, &config, 0, &[pass]);
            assert_eq!(count(&rendered, "visibility/made-points"), 0, "{collect:?} {renders:?}");
            assert!(words(dumped(&rendered, "visibility/maps")).all(|word| word == 1f32.to_bits()), "{collect:?} {renders:?}");
        }
    }
    finish(renderer.gpu());
}
