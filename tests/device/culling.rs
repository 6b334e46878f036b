//! Culling in the gather: VPLs that cannot shine on pixels are left out, and the picture never changes.

use crate::common::*;
use glam::Vec3;
use manylight::config::{Block, Builtin, CameraConfig, Config, Culling, FilterKind, LightConfig, SceneConfig, Tile, VisibilityMethod};
use manylight::output::Plane;
use manylight::renderer::Renderer;
use manylight::scene::Scene;
use manylight::scene::source::load_scene;

fn config(size: [u32; 2], position: [f32; 3], target: [f32; 3]) -> Config {
    let mut config = Config {
        camera: Some(CameraConfig { position: Some(position), target: Some(target), ..CameraConfig::default() }),
        ..Config::default()
    };
    config.frame.size = size;
    config.vpls.count = 1000;
    config.filter.kind = FilterKind::None;
    config
}

fn culled(renderer: &mut Renderer, config: &Config, culling: Culling) -> Plane {
    let mut config = config.clone();
    config.gather.per_pixel.culling = culling;
    picture(renderer, &config).irradiance
}

/// Compares both culling methods with none.
fn same(renderer: &mut Renderer, config: &Config, what: &str) {
    let all = culled(renderer, config, Culling::None);
    for tile in [Tile::Wide, Tile::Square] {
        let mut config = config.clone();
        config.gather.per_pixel.tile = tile;
        let tiled = culled(renderer, &config, Culling::Tiled);
        assert!(all.values == tiled.values, "{what}: culling in tiles, {tile:?}, changed the picture");
    }
    let clustered = culled(renderer, config, Culling::Clustered);
    // With fewer sets than parts of a list, VPLs are summed in another order; values are stored as halves.
    let exact = config.gather.interleave.0.iter().product::<u32>() >= 16;
    for (i, (a, b)) in all.values.iter().zip(&clustered.values).enumerate() {
        let same = if exact { a == b } else { (a - b).abs() <= 2e-3 * a.abs() };
        assert!(same, "{what}: clustered culling made {b} of {a} in value {i}");
    }
}

fn atrium() -> Scene {
    load_scene(&SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, ..SceneConfig::default() }).unwrap().0
}

#[test]
fn light_lists_are_counted_hold_all_that_shine_and_leave_out_others() {
    let mut renderer = renderer(atrium());
    for block in [[1, 1], [4, 4]].map(Block) {
        let mut config = config([333, 187], [-8.2, 1.9, -6.2], [0.0, 2.2, -5.4]);
        config.gather.interleave = block;
        let mut counts = |culling: Culling| {
            config.gather.per_pixel.culling = culling;
            config.gather.per_pixel.statistics = false;
            let plain = picture(&mut renderer, &config);
            config.gather.per_pixel.statistics = true;
            let rendered = render(&mut renderer, &config, 0);
            assert!(rendered.picture.as_ref().unwrap().image == plain.image, "{culling:?}, {block}: counting changes the picture");
            ["pixels", "diffuse-listed", "diffuse-lit", "diffuse-wrong"].map(|name| count(&rendered, &format!("gather/{name}")))
        };
        let [pixels, all, lit, wrong] = counts(Culling::None);
        let sets = u64::from(block.0.iter().product::<u32>());
        assert!((all * sets).abs_diff(pixels * 1000) < pixels * sets, "{pixels} pixels have {all} VPLs");
        assert_eq!(all - lit, wrong);
        for culling in [Culling::Tiled, Culling::Clustered] {
            let [_, listed, shining, wrong] = counts(culling);
            assert_eq!(shining, lit, "{culling:?}, {block}: who shines is no matter of lists");
            assert!(lit <= listed && listed < all * 9 / 10, "{culling:?}, {block}: {listed} of {all} are listed, {lit} shine");
            assert_eq!(listed - shining, wrong);
        }
    }
    finish(renderer.gpu());
}

#[test]
fn culling_never_changes_the_picture_whatever_the_view_and_the_block() {
    let mut renderer = traced(atrium());
    let views = [
        ("along the court", [333, 187], [-8.2, 1.9, -6.2], [0.0, 2.2, -5.4]),
        ("near a wall", [161, 90], [-5.7, 1.9, -5.8], [-5.0, 0.5, -7.0]),
        ("from outside", [130, 129], [40.0, 30.0, 45.0], [0.0, 2.0, 0.0]),
        ("at the sky", [64, 64], [0.0, 2.0, 0.0], [0.1, 50.0, 0.2]),
    ];
    for (name, size, position, target) in views {
        for block in [[1, 1], [2, 2], [4, 2], [4, 4], [2, 8], [8, 8]].map(Block) {
            let mut config = config(size, position, target);
            config.gather.interleave = block;
            same(&mut renderer, &config, &format!("{name}, {block}"));
        }
    }
    for method in [VisibilityMethod::RayTraced, VisibilityMethod::ImperfectShadowMaps] {
        let mut config = config([150, 83], [-8.2, 1.9, -6.2], [0.0, 2.2, -5.4]);
        config.visibility.method = method;
        config.visibility.ism.point_count = 50_000;
        for block in [[2, 2], [4, 2], [4, 4]].map(Block) {
            config.gather.interleave = block;
            same(&mut renderer, &config, &format!("{method:?}, {block}"));
        }
    }
    finish(renderer.gpu());
}

#[test]
fn culling_never_changes_the_picture_whatever_the_count_and_the_lights() {
    let mut renderer = renderer(atrium());
    // Numbers of lists have 8 bits up to 4,096 VPLs, since blocks have 16 pixels here at most.
    for count in [1, 17, 1000, 4096, 6001] {
        let mut config = config([140, 100], [-2.4, 1.9, -2.2], [6.5, 3.4, 1.0]);
        config.vpls.count = count;
        same(&mut renderer, &config, &format!("{count} VPLs"));
    }
    let mut config = config([140, 100], [-2.4, 1.9, -2.2], [6.5, 3.4, 1.0]);
    config.light = vec![
        directional(Vec3::new(0.2, -1.0, 0.3), [20.0; 3]),
        spot(Vec3::new(0.0, 4.0, 0.0), Vec3::new(1.0, -0.5, 0.2), [80.0, 20.0, 10.0], 10.0, 30.0),
        LightConfig::Point { position: [3.0, 3.0, 1.0], intensity: [10.0; 3], keyframes: Vec::new() },
    ];
    same(&mut renderer, &config, "three lights");
    finish(renderer.gpu());
}

#[test]
fn as_many_vpls_as_a_pixel_may_have_are_all_summed() {
    let mut renderer = renderer(atrium());
    // A view along the court, whose pixels are in many froxels.
    let mut config = config([40, 24], [-8.2, 1.9, -6.2], [0.0, 2.2, -5.4]);
    config.rsm.size = [512, 512];
    config.gather.interleave = 1.into();
    for (culling, most) in [(Culling::None, 80_000), (Culling::Tiled, 60_000), (Culling::Clustered, 2_500)] {
        config.gather.per_pixel.culling = culling;
        config.vpls.count = most + 1;
        let error = renderer.check(&config).unwrap_err().to_string();
        assert!(error.contains(&format!("over the {most} that every driver sums")), "{error}");
        config.vpls.count = most;
        // Sixteen sets of the same VPLs are short loops: their mean over a block is that of all.
        let all = culled(&mut renderer, &config, culling);
        let mut parts = config.clone();
        parts.gather.interleave = 4.into();
        let mean = |plane: &Plane| plane.values.iter().map(|value| f64::from(*value)).sum::<f64>();
        let ratio = mean(&all) / mean(&culled(&mut renderer, &parts, Culling::None));
        assert!((ratio - 1.0).abs() < 0.02, "{culling:?}, {most} VPLs: {ratio} of the light of the same in short loops");
        if culling != Culling::None {
            let unculled = culled(&mut renderer, &config, Culling::None);
            let ratio = mean(&all) / mean(&unculled);
            assert!((ratio - 1.0).abs() < 1e-4, "{culling:?}, {most} VPLs: {ratio} of the light without culling");
        }
    }
    finish(renderer.gpu());
}

/// Lengths of the parts of used froxels' light lists, and the number of these froxels.
fn lists(renderer: &mut Renderer, config: &Config) -> (Vec<u32>, usize) {
    let mut config = config.clone();
    config.gather.per_pixel.culling = Culling::Clustered;
    let rendered = dump(renderer, &config, 0, &["gather/light-lists"]);
    let lists: Vec<u32> = words(dumped(&rendered, "gather/lists")).collect();
    let used = count(&rendered, "gather/used-froxels") as usize;
    // Four numbers a word, after the part's count.
    let (parts, stride) = (16, 1 + config.vpls.count.div_ceil(16).div_ceil(4) as usize);
    let [across, down] = config.frame.size.map(|n| n.div_ceil(128) as usize);
    assert_eq!(lists.len(), across * down * 16 * parts * stride);
    ((0..used * parts).map(|part| lists[part * stride]).collect(), used)
}

#[test]
fn lists_are_short_where_vpls_face_away_and_a_full_one_spoils_no_neighbour() {
    // A floor lit by the sun: its VPLs all face everything above it, and every list is full.
    let mut floor = Scene::default();
    add_quad(&mut floor, [[-4.0, 4.0], [4.0, 4.0], [4.0, -4.0], [-4.0, -4.0]].map(|[x, z]| Vec3::new(x, 0.0, z)), matte([0.7; 3]));
    let corners = [[-4.0, 0.0], [4.0, 0.0], [4.0, 2.0], [-4.0, 2.0]].map(|[x, y]| Vec3::new(x, y, -4.0));
    add_quad(&mut floor, corners, matte([0.7; 3]));
    let mut full = renderer(floor);
    let mut open = config([300, 200], [0.0, 1.5, 3.5], [0.0, 0.7, 0.0]);
    open.light = vec![directional(Vec3::NEG_Y, [5.0; 3])];
    open.vpls.count = 1024;
    let (numbers, used) = lists(&mut full, &open);
    assert!(used > 1 && numbers.iter().all(|number| *number == 64), "{used} clusters: {numbers:?}");
    same(&mut full, &open, "full lists");
    finish(full.gpu());

    let mut renderer = renderer(atrium());
    let config = config([333, 187], [-8.2, 1.9, -6.2], [0.0, 2.2, -5.4]);
    let (numbers, used) = lists(&mut renderer, &config);
    let listed = numbers.iter().sum::<u32>() as usize;
    println!("{used} clusters, {listed} entries of {}", used * 1000);
    assert!(listed > 0 && listed < used * 800, "{listed} of {}", used * 1000);
    finish(renderer.gpu());
}

#[test]
fn without_interleaving_every_pixel_gathers_every_vpl() {
    let mut renderer = renderer(atrium());
    let mut config = config([48, 27], [-8.2, 1.9, -6.2], [0.0, 2.2, -5.4]);
    config.gather.interleave = 1.into();
    config.vpls.count = 300;
    for culling in [Culling::None, Culling::Tiled, Culling::Clustered] {
        config.gather.per_pixel.culling = culling;
        let rendered = dump(&mut renderer, &config, 0, &["vpls/regular"]);
        let floats = |name: &str| -> Vec<f32> { words(dumped(&rendered, name)).map(f32::from_bits).collect() };
        let (points, intensities) = (floats("vpls/places"), floats("vpls/intensities"));
        let picture = rendered.picture.unwrap();
        let (positions, normals) = (picture.positions(), picture.normals());
        let mut checked = 0;
        for pixel in (0..positions.len()).step_by(31) {
            if picture.depth.values[pixel] == 0.0 {
                continue;
            }
            let mut sum = 0.0;
            for (point, intensity) in points.chunks_exact(4).zip(intensities.chunks_exact(3)) {
                let way = Vec3::from_slice(point) - positions[pixel];
                let facing = manylight::scene::pack::octahedral_snorm16_inverse(point[3].to_bits());
                let cosines = normals[pixel].dot(way).max(0.0) * -facing.dot(way).min(0.0);
                let squared = way.length_squared();
                sum += intensity[0] * cosines / (squared * squared.max(config.gather.min_distance.powi(2))).max(1e-20);
            }
            let found = picture.irradiance.at(pixel)[0];
            assert!((found - sum).abs() <= 2e-3 * sum + 1e-6, "{culling:?}, pixel {pixel}: {found} is not {sum}");
            checked += usize::from(sum > 0.0);
        }
        assert!(checked > 10, "{checked} pixels have light");
    }
    finish(renderer.gpu());
}
