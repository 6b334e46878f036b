//! Counts and memory of frames, and pipelines that a warm-up makes in advance.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::config::{BoxConfig, CameraConfig, CameraKeyframe, Config, LightConfig, LightKeyframe};
use manylight::graph::{Execution, Timing};
use manylight::report::Memory;
use manylight::scene::{Material, Scene};

#[test]
fn all_vpls_of_a_light_in_a_closed_box_are_lit() {
    let mut renderer = renderer(room(&walls(DVec3::new(4.0, 3.0, 5.0), [DVec3::splat(0.5); 6])));
    let light = LightConfig::Point { position: [2.0, 1.5, 2.0], intensity: [1.0; 3], keyframes: Vec::new() };
    let mut config = plain([16, 16], Vec3::new(1.0, 1.0, 4.0), Vec3::ZERO, 60.0, light);
    config.rsm.size = [16, 16];
    // More than a workgroup, and no multiple of one.
    config.vpls.count = 1001;
    for timing in [Timing::Isolated, Timing::Overlapped, Timing::Serial] {
        let rendered = renderer.render(&config, 0, false, &Execution { timing, ..Execution::default() }).unwrap();
        assert_eq!(count(&rendered, "vpls/lit"), 1001, "{timing:?}");
    }
    config.vpls.count = 6;
    assert_eq!(count(&render(&mut renderer, &config, 0), "vpls/lit"), 6);
    finish(renderer.gpu());
}

#[test]
fn vpls_where_the_map_misses_the_scene_are_not_lit() {
    let mut scene = Scene { name: "floor".into(), ..Scene::default() };
    let corners = [[-4.0, 4.0], [4.0, 4.0], [4.0, -4.0], [-4.0, -4.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    add_quad(&mut scene, corners, matte([0.5; 3]));
    let mut renderer = renderer(scene);
    let mut config = plain([16, 16], Vec3::new(0.0, 5.0, 1.0), Vec3::ZERO, 60.0, directional(Vec3::NEG_Y, [1.0; 3]));
    config.rsm.size = [64, 32];
    config.rsm.bounds = Some(BoxConfig { min: [-4.0, -1.0, -4.0], max: [12.0, 1.0, 4.0] });
    // One VPL per texel. The map has a margin of a texel on each side of the box, and texels count by their centres.
    config.vpls.count = 64 * 32;
    let middles = |texels: u32, half: f64| {
        let half_map = half * (1.0 + 2.0 / f64::from(texels));
        (0..texels).map(move |i| (f64::from(i) + 0.5) / f64::from(texels) * 2.0 * half_map - half_map)
    };
    let columns = middles(64, 8.0).filter(|x| (x + 4.0).abs() < 4.0).count();
    let rows = middles(32, 4.0).filter(|z| z.abs() < 4.0).count();
    assert_eq!(count(&render(&mut renderer, &config, 0), "vpls/lit"), (columns * rows) as u64);
    assert!((columns * rows) < 64 * 32 / 2, "the floor is less than half of the map");
    finish(renderer.gpu());
}

#[test]
fn the_resources_of_a_known_frame_take_what_their_texels_do() {
    let mut renderer = renderer(room(&walls(DVec3::splat(4.0), [DVec3::splat(0.5); 6])));
    let light = LightConfig::Point { position: [2.0; 3], intensity: [1.0; 3], keyframes: Vec::new() };
    let mut config = plain([64, 64], Vec3::new(1.0, 1.0, 3.5), Vec3::ONE, 60.0, light);
    config.rsm.size = [32, 16];
    config.vpls.count = 100;
    let first = render(&mut renderer, &config, 0);
    let memory = Memory::of(&first.memory);
    let pixels = 64 * 64;
    // Depth, octahedral normal, albedo, metallic-roughness, emission; the rest is the view and the draws' arguments.
    let view = memory.resources["gbuffer/view"];
    let arguments = memory.resources["gbuffer/arguments"];
    assert_eq!(arguments % 20, 0);
    assert_eq!(memory.stages["gbuffer"], pixels * (4 + 4 + 8 + 2 + 8) + view + arguments);
    // Six maps of depth, normal, flux and albedo.
    let maps = ["depth", "normal", "flux", "albedo"].map(|name| memory.resources[&format!("rsm/{name}")]);
    assert_eq!(maps, [4, 4, 16, 8].map(|texel| 6 * 32 * 16 * texel));
    assert_eq!((memory.stages["vpls"], memory.stages["gather"]), (100 * (16 + 12 + 4) + 4, pixels * 8));
    // Every stage with resources has passes of its name, save the sky, whose radiance the last pass reads. Imported resources do not
    // count as the frame's.
    let stages: Vec<&str> = memory.stages.keys().map(String::as_str).collect();
    assert_eq!(stages, ["compose", "direct", "gather", "gbuffer", "rsm", "sky", "vpls"]);
    assert_eq!(render(&mut renderer, &config, 0).memory, first.memory);
    finish(renderer.gpu());
}

/// Walls to the north, east and south of the origin, each with another kind of material. A camera and a light at the origin
/// turn from one to the next in each frame.
fn turning() -> (Scene, Config) {
    let mut scene = Scene { name: "three walls".into(), ..Scene::default() };
    let plain_matte = matte([0.5; 3]);
    let materials = [
        plain_matte.clone(),
        Material { double_sided: true, ..plain_matte.clone() },
        Material { alpha_cutoff: Some(0.5), double_sided: true, ..plain_matte },
    ];
    let directions = [Vec3::NEG_Z, Vec3::X, Vec3::Z];
    for (direction, material) in directions.into_iter().zip(materials) {
        let (middle, right) = (direction * 5.0, direction.cross(Vec3::Y));
        let corners = [-right - Vec3::Y, right - Vec3::Y, right + Vec3::Y, Vec3::Y - right].map(|corner| middle + corner);
        add_quad(&mut scene, corners, material);
    }
    let mut light = spot(Vec3::ZERO, directions[0], [10.0; 3], 20.0, 30.0);
    if let LightConfig::Spot { keyframes, .. } = &mut light {
        let key = |(i, direction): (usize, &Vec3)| LightKeyframe {
            time: i as f32,
            direction: Some(direction.to_array()),
            position: None,
            target: None,
            intensity: None,
            irradiance: None,
        };
        keyframes.extend(directions.iter().enumerate().map(key));
    }
    let mut config = plain([32, 32], Vec3::ZERO, directions[0], 40.0, light);
    let key = |(i, direction): (usize, &Vec3)| CameraKeyframe {
        time: i as f32,
        position: [0.0; 3],
        target: direction.to_array(),
        fov_y_deg: None,
    };
    let keyframes = directions.iter().enumerate().map(key).collect();
    config.camera = Some(CameraConfig { fov_y_deg: Some(40.0), keyframes, ..CameraConfig::default() });
    config.frame.fps = 1.0;
    config.rsm.size = [32, 32];
    config.vpls.count = 64;
    (scene, config)
}

#[test]
fn after_a_warm_up_no_frame_of_a_path_makes_a_pipeline() {
    let (scene, config) = turning();
    // Without a warm-up, walls that come into view need new pipelines: the test can fail.
    let mut cold = renderer(scene.clone());
    let mut made = Vec::new();
    let pictures: Vec<_> = (0..3)
        .map(|frame| {
            let rendered = render(&mut cold, &config, frame);
            assert!(count(&rendered, "vpls/lit") > 0, "frame {frame} shows a lit wall");
            made.push(cold.engine().pipelines_made());
            rendered.picture.unwrap()
        })
        .collect();
    assert!(made[0] < made[1] && made[1] < made[2], "{made:?}");
    finish(cold.gpu());
    drop(cold);

    let mut warm = renderer(scene);
    warm.prepare(&config, &[]).unwrap();
    let prepared = warm.engine().pipelines_made();
    assert_eq!(prepared, made[2]);
    warm.warm_up(&config, &Execution::default()).unwrap();
    for (frame, expected) in pictures.iter().enumerate() {
        let picture = render(&mut warm, &config, frame as u32).picture.unwrap();
        assert!(picture.image == expected.image && picture.radiance.values == expected.radiance.values, "frame {frame} is another");
    }
    assert_eq!(warm.engine().pipelines_made(), prepared);
    finish(warm.gpu());
}
