//! Stochastic light culling: glossy VPLs, stochastic ranges, and culling by them.

use crate::common::*;
use glam::{Affine3A, DVec3, Vec2, Vec3};
use manylight::config::{
    Block, Bounds, Builtin, Config, Dielectric, GatherMethod, Rasterization, Receiver, Reflection, RouletteChoice, SceneConfig,
    StochasticCulling, VisibilityMethod, VplSampler,
};
use manylight::gpu::Format;
use manylight::graph::{Engine, Execution, Graph, Library};
use manylight::output::Picture;
use manylight::reference::{Settings, Sum};
use manylight::renderer::Renderer;
use manylight::scene::builder::Mesh;
use manylight::scene::source::load_scene;
use manylight::scene::{Aabb, Camera, Material, Scene};
use manylight::shader_struct;
use manylight::stages::gather;
use manylight::stages::gather::shells::{CONSERVATIVE, Shell, Shells};
use manylight::world::projection::View;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

/// Metal objects on a floor; each texel of a small map is two VPLs.
fn metal(roughness: f32) -> (Scene, Config) {
    let scene = SceneConfig { builtin: Some(Builtin::Caustics), triangles: 8_190, roughness, ..SceneConfig::default() };
    let mut config = Config { scene, ..Config::default() };
    config.frame.size = [240, 136];
    config.rsm.size = [64, 64];
    stochastic(&mut config);
    (load_scene(&config.scene).unwrap().0, config)
}

fn stochastic(config: &mut Config) {
    config.vpls.sampler = VplSampler::EveryTexel;
    config.vpls.reflection = Reflection::Both;
    config.gather.interleave = 4.into();
    (config.gather.method, config.gather.stochastic.culling) = (GatherMethod::Stochastic, StochasticCulling::Tiled);
    config.gather.stochastic.delta = 0.01;
    config.gather.min_distance = 0.05;
    config.filter.kind = manylight::config::FilterKind::None;
}

/// Without stochastic ranges and least distance, with ray-traced shadows: the result is the light of all VPLs.
fn exact(config: &mut Config) {
    config.gather.interleave = 1.into();
    config.gather.min_distance = 0.0;
    config.gather.stochastic.delta = 1e-6;
    config.visibility.method = VisibilityMethod::RayTraced;
}

/// Mean indirect radiance of the surfaces at chosen places.
fn light(renderer: &mut Renderer, config: &Config, chosen: impl Fn(DVec3) -> bool) -> f64 {
    let picture = picture(renderer, config);
    let found: Vec<[f32; 4]> = (0..picture.positions().len()).map(|i| picture.indirect.at(i)).collect();
    mean_of_surfaces(&picture, &found, chosen)
}

/// The mean of [`light`] by the path tracer, with one bounce and this many paths per pixel.
fn light_of_paths(renderer: &mut Renderer, config: &Config, samples: u32, chosen: impl Fn(DVec3) -> bool) -> f64 {
    let settings = Settings { min_distance: config.gather.min_distance, ..centered(1) };
    let expected = reference(renderer, config, settings, samples).mean(Sum::Bounce(1));
    let mut quick = config.clone();
    quick.visibility.method = VisibilityMethod::None;
    quick.gather.interleave = 8.into();
    mean_of_surfaces(&picture(renderer, &quick), &expected, chosen)
}

fn mean_of_surfaces(picture: &Picture, light: &[[f32; 4]], chosen: impl Fn(DVec3) -> bool) -> f64 {
    let positions = picture.positions();
    mean(light, |i| picture.depth.at(i)[0] > 0.0 && chosen(positions[i].as_dvec3()))
}

/// Whether a place in a room of this size is off its wall at z = 0 and away from edges, where single texels light spots.
fn away_from_edges(x: DVec3, size: DVec3) -> bool {
    x.z > 0.3 && [x, size - x].iter().flat_map(|d| d.to_array()).filter(|d| *d < 0.3).count() <= 1
}

/// Number of pixels that differ by more than the order of sums and rounding to halves explain.
fn apart(a: &[Vec3], b: &[Vec3]) -> usize {
    a.iter().zip(b).filter(|(a, b)| (**a - **b).abs().max_element() > 2e-3 * a.max_element().max(b.max_element()) + 1e-5).count()
}

#[test]
fn culling_loses_nothing_whatever_bounds_it_by_and_whoever_culls() {
    for (roughness, dielectric) in [(0.02, Dielectric::Lambert), (0.3, Dielectric::Lambert), (0.3, Dielectric::Ggx)] {
        let (scene, mut config) = metal(roughness);
        config.materials.dielectric = dielectric;
        let mut renderer = renderer(scene);
        config.gather.stochastic.bounds = Bounds::None;
        let every = irradiance(&mut renderer, &config);
        assert!(every.iter().filter(|e| e.max_element() > 0.0).count() > every.len() / 2);
        for bounds in [Bounds::Ellipsoid, Bounds::SphereEllipsoid, Bounds::SphereVpl] {
            config.gather.stochastic.bounds = bounds;
            assert!(irradiance(&mut renderer, &config) == every, "{bounds:?} bounds lose light at roughness {roughness}");
        }
        config.gather.stochastic.bounds = Bounds::Ellipsoid;
        for culling in [StochasticCulling::Splatting, StochasticCulling::ConservativeClusters] {
            config.gather.stochastic.culling = culling;
            let rendered = render(&mut renderer, &config, 0);
            let found: Vec<Vec3> = rendered.picture.as_ref().unwrap().irradiance.rgb().collect();
            let pixels = apart(&found, &every);
            assert!(pixels == 0, "{culling:?} differs in {pixels} pixels at roughness {roughness}");
            if culling == StochasticCulling::ConservativeClusters {
                assert!(count(&rendered, "gather/lost") == 0 && count(&rendered, "gather/nodes") > 10_000);
            }
        }
        let by_extension = renderer.gpu().adapter.missing(CONSERVATIVE).is_empty();
        let way = if by_extension { "extension" } else { "geometry-shader" };
        assert_eq!(renderer.choices(&config), BTreeMap::from([("gather.conservative_clusters.rasterization", way.into())]));
        if !by_extension {
            // Written directly, since the test harness hides the printed output of passing tests.
            writeln!(std::io::stderr(), "SKIPPED in part: {} does not rasterize conservatively by itself", renderer.gpu().adapter.name)
                .unwrap();
            finish(renderer.gpu());
            continue;
        }
        let mut by = |rasterization| {
            config.gather.conservative_clusters.rasterization = rasterization;
            assert!(renderer.choices(&config).is_empty());
            let rendered = render(&mut renderer, &config, 0);
            (rendered.picture.as_ref().unwrap().irradiance.rgb().collect::<Vec<Vec3>>(), count(&rendered, "gather/nodes"))
        };
        let ((extension, listed), (shader, most)) = (by(Rasterization::Extension), by(Rasterization::GeometryShader));
        println!("lists of {listed} nodes by the extension, {most} by the geometry shader");
        assert!(apart(&extension, &every) == 0 && apart(&shader, &every) == 0);
        // The device may find more tiles than those touched, by a part of a tile.
        assert!(listed as f64 > 0.98 * most as f64 && (listed as f64) < 1.5 * most as f64);
        finish(renderer.gpu());
    }
}

shader_struct! {
    /// Layout of `glsl/lib/range.glsl`.
    struct Spheroid {
        row0: [f32; 3],
        depth: f32,
        row1: [f32; 3],
        centre: [f32; 3],
    }
}

/// Sample places per row of a tile, and rows. The extension's shaders are rasterized at each place, and together the places find about
/// the tiles of conservative rasterization.
const PLACES: u32 = 24;

/// The engine's shaders. The extension's vertices are moved to the sample place of their instance.
fn library() -> Library {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl");
    let mut sources = BTreeMap::new();
    for folder in ["gather", "lib"].map(|name| folder.join(name)) {
        for file in std::fs::read_dir(&folder).unwrap() {
            let path = file.unwrap().path();
            let name = format!("{}/{}", folder.file_name().unwrap().display(), path.file_name().unwrap().display());
            sources.insert(name, std::fs::read_to_string(&path).unwrap());
        }
    }
    let vertex = sources.get_mut("gather/shells-extension.vert").unwrap();
    let places = PLACES * PLACES;
    for (of, with) in [
        ("index = gl_InstanceIndex,", format!("place_in_tile = gl_InstanceIndex % {places}u, index = gl_InstanceIndex / {places}u,")),
        (
            "view.it.near, point.z);",
            format!(
                "view.it.near, point.z);\n    vec2 moved = vec2(place_in_tile % {PLACES}u, place_in_tile / {PLACES}u) / {PLACES}.0 - 0.4999;\n    \
                 gl_Position.xy += moved * 2.0 / vec2(tiles * block_size()) * point.z;"
            ),
        ),
    ] {
        assert_eq!(vertex.matches(of).count(), 1, "{of}");
        *vertex = vertex.replace(of, &with);
    }
    Library::from_sources(sources)
}

/// Slices of tiles that bounds cross, on near and far sides: by the geometry shader, and by the extension's shaders.
fn slices(spheres: &[[f32; 4]], spheroids: &[Spheroid], glossy: bool) -> [Vec<u32>; 2] {
    const BLOCK: [u32; 2] = [4, 2];
    let size = [640u32, 360];
    let mut gpu = gpu();
    let shells = Shells::upload(&mut gpu).unwrap();
    let mut engine = Engine::new(gpu, library());
    let camera = Camera { name: String::new(), position: Vec3::ZERO, target: Vec3::Z, up: Vec3::Y, fov_y_deg: 60.0 };
    let view = View::new(&camera, size, Aabb { min: Vec3::splat(-5.0), max: Vec3::splat(5.0) });
    let tiles = [0, 1].map(|axis| size[axis].div_ceil(BLOCK[axis]).div_ceil(16));
    let by = [Shell::Twenty, Shell::Corners].map(|shell| {
        let mut g = Graph::new();
        let view = g.upload("view", &[view]);
        let (spheres_there, spheroids_there) = (g.upload("spheres", spheres), g.upload("spheroids", spheroids));
        let marks = [0, 1].map(|i| g.zeroed::<[u32; 2]>(&format!("marks {i}"), spheres.len() as u32 * tiles[0] * tiles[1]));
        let touched = g.image("touched", Format::R32Float, [0, 1].map(|axis| tiles[axis] * BLOCK[axis]));
        let places = if shell == Shell::Corners { PLACES * PLACES } else { 1 };
        let shells = shells.import(&mut g);
        let list = shells.list(&mut g, "bounds", shell, places * spheres.len() as u32, false, vec![("GLOSSY", u32::from(glossy))]);
        let corners = shells.corners(&mut g, "corners");
        let pass = match shell {
            Shell::Corners => g.raster("gather/shells").shader("gather/shells-extension").reads("corners", corners),
            _ => g.raster("gather/shells"),
        };
        pass.reads("view", view)
            .reads("spheres", spheres_there)
            .reads("spheroids", spheroids_there)
            .updates("diffuse_shells", marks[0])
            .updates("glossy_shells", marks[1])
            .constant("BLOCK_ACROSS", BLOCK[0])
            .constant("BLOCK_DOWN", BLOCK[1])
            .color("touched", touched, [0.0; 4])
            .draw(vec![list]);
        let read = g.read_back(marks[usize::from(glossy)]);
        let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
        words(outcome.bytes(read)).collect()
    });
    finish(&engine.gpu);
    by
}

#[test]
fn the_extensions_shaders_mark_what_the_geometry_shader_does() {
    // Spheres around the eye, beside the picture, from a part of a tile to most of the picture, and long spheroids.
    let numbers = |i: u32| [1, 2, 3, 4, 5].map(|k: u32| (i.wrapping_mul(k * k).wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32);
    let spheres: Vec<[f32; 4]> =
        (0..256).map(numbers).map(|[a, b, c, d, _]| [16.0 * a - 8.0, 10.0 * b - 5.0, 12.0 * c - 1.0, 0.02 + 3.0 * d * d]).collect();
    let spheroids: Vec<Spheroid> = spheres
        .iter()
        .zip(0..)
        .map(|([x, y, z, radius], i)| {
            let ([a, b, c, ..], s) = (numbers(1000 + i), 1.0 / radius);
            let (row0, row1, depth) = ([s, 0.0, s * (2.0 * a - 1.0)], [0.0, s * (1.0 + 9.0 * b), s * c], s);
            let dot = |row: [f32; 3]| row[0] * x + row[1] * y + row[2] * z;
            Spheroid { row0, depth, row1, centre: [dot(row0), dot(row1), depth * z] }
        })
        .collect();
    for glossy in [false, true] {
        let [shader, extension] = slices(&spheres, &spheroids, glossy);
        let beyond: u32 = shader.iter().zip(&extension).map(|(all, some)| (some & !all).count_ones()).sum();
        let [all, some] = [&shader, &extension].map(|marks| marks.iter().map(|bits| bits.count_ones()).sum::<u32>());
        println!("{some} of {all} slices, {beyond} beyond");
        assert!(all > 5000 && beyond == 0, "{beyond} slices of {all} that the geometry shader does not find");
        // The other slices are slivers between the sample places.
        assert!(f64::from(some) > 0.9 * f64::from(all), "{some} of {all} slices");
    }
}

#[test]
fn lists_are_shorter_than_all_lights_lose_none_and_repeat_their_bytes() {
    let (scene, mut config) = metal(0.1);
    config.gather.stochastic.statistics = true;
    config.vpls.reflection = Reflection::Glossy;
    let mut renderer = renderer(scene);
    let rendered = render(&mut renderer, &config, 0);
    let again = render(&mut renderer, &config, 0);
    assert!(rendered.picture.unwrap().irradiance.values == again.picture.as_ref().unwrap().irradiance.values);
    config.gather.stochastic.bounds = Bounds::None;
    let every = render(&mut renderer, &config, 0);
    assert_eq!(count(&again, "gather/glossy-lit"), count(&every, "gather/glossy-lit"));
    assert!(count(&again, "gather/glossy-listed") < count(&every, "gather/glossy-listed"));
    assert_eq!(count(&again, "gather/diffuse-listed"), 0);
    config.gather.stochastic.bounds = Bounds::Ellipsoid;
    config.gather.stochastic.culling = StochasticCulling::ConservativeClusters;
    assert_eq!(count(&render(&mut renderer, &config, 0), "gather/glossy-lit"), count(&every, "gather/glossy-lit"));
    finish(renderer.gpu());
}

#[test]
fn ellipsoids_list_a_tenth_of_the_wrong_vpls_that_spheres_around_vpls_list() {
    for roughness in [0.02, 0.05, 0.1] {
        let (scene, mut config) = metal(roughness);
        config.gather.stochastic.statistics = true;
        // A tile covers as large a part of the picture as the preset's at 1920 x 1080, and a pixel has as many VPLs, of four
        // times the flux.
        config.frame.size = [960, 540];
        config.rsm.size = [128, 128];
        config.gather.stochastic.delta = 0.004;
        config.vpls.reflection = Reflection::Glossy;
        let mut renderer = renderer(scene);
        let mut wrong = |bounds| {
            config.gather.stochastic.bounds = bounds;
            let rendered = render(&mut renderer, &config, 0);
            let listed = count(&rendered, "gather/glossy-listed");
            (listed - count(&rendered, "gather/glossy-lit"), listed, count(&rendered, "gather/pixels"))
        };
        let (ellipsoid, listed, pixels) = wrong(Bounds::Ellipsoid);
        let (around, ..) = wrong(Bounds::SphereEllipsoid);
        let (sphere, all, _) = wrong(Bounds::SphereVpl);
        println!(
            "roughness {roughness}: {:.1} VPLs a pixel on lists by ellipsoids, of which {:.0} % wrong; {:.1} by spheres; wrong ones are {:.3} of those, {:.3} of spheres around ellipsoids",
            listed as f64 / pixels as f64,
            100.0 * ellipsoid as f64 / listed as f64,
            all as f64 / pixels as f64,
            ellipsoid as f64 / sphere as f64,
            ellipsoid as f64 / around as f64
        );
        assert!(ellipsoid as f64 <= 0.1 * sphere as f64, "{ellipsoid} of {sphere} wrong ones are left at roughness {roughness}");
        finish(renderer.gpu());
    }
}

#[test]
fn chance_takes_no_light_away_on_average_and_clamped_ranges_do() {
    let (scene, mut config) = metal(0.1);
    config.frame.size = [64, 36];
    config.rsm.size = [32, 32];
    config.gather.interleave = 1.into();
    // With a larger delta, rare lights would not occur in so many realisations, and their variance would be unknown.
    config.gather.stochastic.delta = 0.005;
    let mut renderer = renderer(scene);
    const REALISATIONS: u32 = 256;
    let mut sums = vec![[DVec3::ZERO; 2]; 64 * 36];
    for seed in 0..REALISATIONS {
        config.frame.seed = seed;
        for (sum, e) in sums.iter_mut().zip(irradiance(&mut renderer, &config)) {
            let e = e.as_dvec3();
            *sum = [sum[0] + e, sum[1] + e * e];
        }
    }
    config.gather.stochastic.roulette = RouletteChoice::None;
    let clamped = irradiance(&mut renderer, &config);
    config.gather.stochastic.delta = 1e-6;
    let full = irradiance(&mut renderer, &config);
    let n = f64::from(REALISATIONS);
    let (mut inside, mut all, mut variances, mut squares) = (0, 0, 0.0, 0.0);
    for ([sum, squared], full) in sums.iter().zip(&full) {
        let full = full.as_dvec3();
        if full.max_element() <= 0.0 {
            continue;
        }
        let mean = *sum / n;
        let variance = (*squared / n - mean * mean).max(DVec3::ZERO) * (n / (n - 1.0));
        // Halves have eleven significant bits.
        let allowed = 3.0 * (variance / n).map(f64::sqrt) + full * 2f64.powi(-11);
        all += 1;
        inside += u32::from((mean - full).abs().cmple(allowed).all());
        variances += variance.element_sum();
        squares += (full * full).element_sum();
    }
    let total = |values: &[Vec3]| values.iter().map(|v| v.as_dvec3().element_sum()).sum::<f64>();
    let means: f64 = sums.iter().map(|[sum, _]| sum.element_sum() / n).sum();
    println!(
        "{inside} of {all} pixels' means of {REALISATIONS} lie within three standard errors of the full sum; relative variance {:.2e}; energy {:.4}, clamped {:.4}",
        variances / squares,
        means / total(&full),
        total(&clamped) / total(&full)
    );
    assert!(f64::from(inside) >= 0.997 * f64::from(all), "{inside} of {all} within three standard errors");
    assert!((means / total(&full) - 1.0).abs() < 0.01);
    assert!(total(&clamped) < 0.9 * total(&full), "clamped ranges keep {} of the light", total(&clamped) / total(&full));
    finish(renderer.gpu());
}

#[test]
fn a_wall_of_rough_metal_lights_a_box_as_the_path_tracer_says() {
    const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);
    let mut scene = room(&walls(SIZE, [DVec3::ZERO; 6]));
    // A metal wall reflects the lamp's light to the other walls.
    let wall = scene.draws[4].material as usize;
    scene.materials[wall] =
        Material { base_color: [0.9, 0.7, 0.4, 1.0], metallic: 1.0, roughness: 0.3f32.sqrt(), ..scene.materials[wall].clone() };
    for i in [0, 1, 2, 3, 5] {
        let material = scene.draws[i].material as usize;
        scene.materials[material].base_color = [0.5, 0.5, 0.5, 1.0];
    }
    let lamp = spot(Vec3::new(2.4, 2.0, 3.6), Vec3::new(-0.25, -0.3, -1.0), [30.0, 25.0, 20.0], 20.0, 30.0);
    let mut config = plain([64, 64], Vec3::new(3.6, 1.7, 4.6), Vec3::new(1.0, 0.4, 2.5), 95.0, lamp);
    config.rsm.size = [128, 128];
    stochastic(&mut config);
    exact(&mut config);
    let mut scene_without = scene.clone();
    let mut renderer = traced(scene);
    let matte = |x| away_from_edges(x, SIZE);
    let all = light_of_paths(&mut renderer, &config, 512, matte);
    let ratio = light(&mut renderer, &config, matte) / all;
    // Light of the metal alone, against the difference of path-traced pictures with the wall and with a black one.
    config.vpls.reflection = Reflection::Glossy;
    let glossy = light(&mut renderer, &config, matte);
    finish(renderer.gpu());
    drop(renderer);
    scene_without.materials[wall].base_color = [0.0, 0.0, 0.0, 1.0];
    let mut without = traced(scene_without);
    let by_metal = all - light_of_paths(&mut without, &config, 512, matte);
    let of_metal = glossy / by_metal;
    println!("{ratio:.4} of the path tracer's; of the metal's light alone {of_metal:.4}; it is {:.2} of all", by_metal / all);
    assert!((ratio - 1.0).abs() < 0.03, "{ratio} of the path tracer's");
    assert!((of_metal - 1.0).abs() < 0.03, "{of_metal} of the path tracer's light from metal");
    assert!(by_metal > 0.5 * all, "the metal is too little to tell");
    finish(without.gpu());
}

#[test]
fn a_wall_of_plastic_lights_a_box_as_the_path_tracer_says() {
    const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);
    // Black plastic reflects only by its gloss.
    for (base, reflection) in [([0.0; 3], Reflection::Glossy), ([0.5; 3], Reflection::Both)] {
        let mut scene = room(&walls(SIZE, [DVec3::splat(0.5); 6]));
        let wall = scene.draws[4].material as usize;
        scene.materials[wall] = Material { roughness: 0.3f32.sqrt(), ..matte(base) };
        // The lamp lights only the plastic wall.
        let lamp = spot(Vec3::new(3.0, 2.2, 2.4), Vec3::new(-0.45, -0.3, -1.0), [3000.0, 2500.0, 2000.0], 15.0, 20.0);
        let mut config = plain([64, 64], Vec3::new(3.6, 1.7, 4.6), Vec3::new(1.0, 0.4, 2.5), 95.0, lamp);
        config.rsm.size = [128, 128];
        stochastic(&mut config);
        exact(&mut config);
        config.materials.dielectric = Dielectric::Ggx;
        config.vpls.reflection = reflection;
        config.gather.stochastic.receiver = Receiver::Ggx;
        let mut renderer = traced(scene);
        let away = |x| away_from_edges(x, SIZE);
        let expected = light_of_paths(&mut renderer, &config, 512, away);
        let ratio = light(&mut renderer, &config, away) / expected;
        println!("of base colour {base:?} {ratio:.4} of the path tracer's, whose mean is {expected:.2e}");
        assert!(expected > 0.01);
        assert!((ratio - 1.0).abs() < 0.02, "{ratio} of the path tracer's");
        finish(renderer.gpu());
    }
}

#[test]
fn bent_metal_lights_a_floor_as_the_path_tracer_says() {
    for (parts, roughness, within) in [(64, 0.1f32, 0.01), (16, 0.1, 0.01), (6, 0.3, 0.03)] {
        // Half a cylinder, hollow towards the lamp, of flat parts with interpolated normals.
        let mut bent = Mesh::default();
        for i in 0..=parts {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / parts as f32).sin_cos();
            for y in [0.0, 0.7] {
                bent.vertex(Vec3::new(cos, y, -sin), Vec3::new(-cos, 0.0, sin), Vec2::ZERO);
            }
        }
        bent.indices = (0..parts).flat_map(|i| [0, 1, 2, 2, 1, 3].map(|k| 2 * i + k)).collect();
        let mut scene = Scene { name: "bent metal".into(), ..Scene::default() };
        let floor = [(-2.0, 2.0), (2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
        add_quad(&mut scene, floor, matte([0.5; 3]));
        let metal = scene.add_material(Material { metallic: 1.0, roughness: roughness.sqrt(), ..matte([0.9, 0.7, 0.4]) });
        scene.add_mesh(&bent, metal, &[Affine3A::IDENTITY]);
        let lamp = spot(Vec3::new(0.6, 1.6, 1.8), Vec3::new(-0.55, -1.25, -2.3), [30.0, 25.0, 20.0], 25.0, 30.0);
        let mut config = plain([96, 96], Vec3::new(0.0, 3.5, 1.0), Vec3::new(0.0, 0.0, 0.0), 60.0, lamp);
        config.rsm.size = [128, 128];
        stochastic(&mut config);
        exact(&mut config);
        let mut renderer = traced(scene);
        let on_floor = |x: DVec3| x.y.abs() < 1e-3 && x.length() < 0.9;
        let expected = light_of_paths(&mut renderer, &config, 512, on_floor);
        let ratio = light(&mut renderer, &config, on_floor) / expected;
        println!("of {parts} parts, roughness {roughness}: {ratio:.4} of the path tracer's, whose mean is {expected:.3}");
        assert!(expected > 0.01);
        assert!((ratio - 1.0).abs() < within, "{ratio} of the path tracer's with {parts} parts");
        finish(renderer.gpu());
    }
}

#[test]
fn all_vpls_that_one_pixel_may_have_shine_on_it() {
    // A half-metallic floor that fills the map, so that each texel is a diffuse and a glossy VPL; and a ceiling that faces it.
    let mut scene = Scene { name: "floor and ceiling".into(), ..Scene::default() };
    let floor = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let mut ceiling = floor.map(|corner| corner * 0.2 + Vec3::Y);
    ceiling.reverse();
    add_quad(&mut scene, floor, Material { metallic: 0.5, roughness: 0.6, ..matte([0.8, 0.7, 0.5]) });
    add_quad(&mut scene, ceiling, matte([0.5; 3]));
    let mut config = plain([40, 40], Vec3::new(0.0, 0.1, 0.0), Vec3::new(0.0, 1.0, 0.01), 20.0, directional(Vec3::NEG_Y, [3.0, 2.5, 2.0]));
    config.rsm.size = [141, 141];
    stochastic(&mut config);
    config.gather.interleave = 1.into();
    config.gather.stochastic.delta = 1e-6;
    config.gather.stochastic.statistics = true;
    let mut renderer = renderer(scene);
    let both = render(&mut renderer, &config, 0);
    let [pixels, diffuse, glossy] = ["pixels", "diffuse-lit", "glossy-lit"].map(|name| count(&both, &format!("gather/{name}")));
    println!("{} diffuse and {} glossy VPLs light a pixel", diffuse / pixels, glossy / pixels);
    assert!(diffuse == glossy && diffuse > 18_000 * pixels && pixels == 1_600);
    let both: Vec<Vec3> = both.picture.unwrap().irradiance.rgb().collect();
    let [diffuse, glossy] = [Reflection::Diffuse, Reflection::Glossy].map(|reflection| {
        config.vpls.reflection = reflection;
        irradiance(&mut renderer, &config)
    });
    let sum: Vec<Vec3> = diffuse.iter().zip(&glossy).map(|(a, b)| *a + *b).collect();
    assert_eq!(apart(&both, &sum), 0);
    assert_eq!(gather::MOST_TURNS / 3, 20_000, "the map is to have about as many texels as a pixel may have VPLs");
    finish(renderer.gpu());
}

#[test]
fn light_lists_that_are_cut_short_say_how_much_is_lost() {
    let (scene, mut config) = metal(0.1);
    config.gather.stochastic.culling = StochasticCulling::ConservativeClusters;
    let mut renderer = renderer(scene);
    let whole = render(&mut renderer, &config, 0);
    assert!(whole.warnings().is_empty());
    let all = count(&whole, "gather/nodes");
    config.gather.conservative_clusters.nodes = all as u32 / 2;
    let cut = render(&mut renderer, &config, 0);
    assert_eq!(count(&cut, "gather/nodes"), all);
    assert_eq!(count(&cut, "gather/lost"), all - all / 2);
    assert!(cut.warnings()[0].contains(&format!("{} nodes found no room", all - all / 2)), "{:?}", cut.warnings());
    // The remaining lights are part of the same lists.
    let [cut, whole] = [&cut, &whole].map(|rendered| rendered.picture.as_ref().unwrap().irradiance.rgb().collect::<Vec<Vec3>>());
    assert!(cut.iter().zip(&whole).all(|(cut, whole)| cut.cmple(*whole * 1.002 + 1e-5).all()));
    let [left, all] = [cut, whole].map(|values| values.iter().map(|e| f64::from(e.element_sum())).sum::<f64>());
    assert!((0.1..0.9).contains(&(left / all)), "{} of the light is left", left / all);
    finish(renderer.gpu());
}

#[test]
fn a_floor_of_rough_metal_reflects_vpls_as_the_path_tracer_says() {
    const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);
    let mut scene = room(&walls(SIZE, [DVec3::splat(0.6); 6]));
    let floor = scene.draws[2].material as usize;
    scene.materials[floor] =
        Material { base_color: [0.9, 0.7, 0.4, 1.0], metallic: 1.0, roughness: 0.4f32.sqrt(), ..scene.materials[floor].clone() };
    let lamp = spot(Vec3::new(2.4, 1.2, 2.0), Vec3::new(-0.25, 0.2, -1.0), [30.0, 25.0, 20.0], 20.0, 30.0);
    let mut config = plain([64, 64], Vec3::new(2.0, 1.8, 4.7), Vec3::new(2.0, 0.0, 2.0), 70.0, lamp);
    config.rsm.size = [128, 128];
    stochastic(&mut config);
    exact(&mut config);
    config.gather.stochastic.receiver = Receiver::Ggx;
    let mut renderer = traced(scene);
    let on_metal = |x: DVec3| x.y < 0.01 && x.z > 0.4;
    assert!(picture(&mut renderer, &config).positions().iter().filter(|x| on_metal(x.as_dvec3())).count() > 500);
    let ratio = light(&mut renderer, &config, on_metal) / light_of_paths(&mut renderer, &config, 256, on_metal);
    println!("the floor reflects {ratio:.4} of what the path tracer's does");
    assert!((ratio - 1.0).abs() < 0.03, "the floor reflects {ratio} of what the path tracer's does");
    finish(renderer.gpu());
}

#[test]
fn nothing_is_lost_at_any_interleaving_odd_size_and_light() {
    let (scene, mut config) = metal(0.1);
    let point = manylight::config::LightConfig::Point { position: [0.3, 1.4, 0.6], intensity: [8.0, 7.0, 6.0], keyframes: Vec::new() };
    let sun = directional(Vec3::new(-0.4, -1.0, -0.3), [4.0, 4.0, 3.5]);
    let mut renderer = renderer(scene);
    for (interleave, size, lights) in [
        ([1, 1], [77, 51], vec![sun.clone()]),
        ([2, 2], [131, 67], vec![point.clone()]),
        ([4, 2], [131, 67], vec![point.clone()]),
        ([8, 8], [203, 117], vec![sun, point]),
    ] {
        config.frame.size = size;
        config.gather.interleave = Block(interleave);
        config.light = lights;
        config.rsm.size = [32, 24];
        (config.gather.method, config.gather.stochastic.culling) = (GatherMethod::Stochastic, StochasticCulling::Tiled);
        config.gather.stochastic.bounds = Bounds::None;
        let every = irradiance(&mut renderer, &config);
        config.gather.stochastic.bounds = Bounds::Ellipsoid;
        assert!(irradiance(&mut renderer, &config) == every, "{size:?} by {interleave:?} loses light");
        for culling in [StochasticCulling::Splatting, StochasticCulling::ConservativeClusters] {
            config.gather.stochastic.culling = culling;
            let pixels = apart(&irradiance(&mut renderer, &config), &every);
            assert!(pixels == 0, "{culling:?} differs in {pixels} pixels of {size:?} by {interleave:?}");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn maps_that_neighbours_share_see_about_what_rays_do() {
    let scene = SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, ..SceneConfig::default() };
    let mut config = Config { scene, ..Config::default() };
    config.frame.size = [96, 54];
    config.rsm.size = [96, 96];
    stochastic(&mut config);
    config.vpls.reflection = Reflection::Diffuse;
    config.gather.min_distance = 0.3;
    config.gather.stochastic.delta = 1e-4;
    config.filter.kind = manylight::config::FilterKind::Bilateral;
    config.visibility.ism.points = manylight::config::PointSet::Adaptive;
    config.visibility.ism.normals = true;
    let mut renderer = traced(load_scene(&config.scene).unwrap().0);
    let mut with = |method, maps| {
        config.visibility.method = method;
        config.visibility.ism.shared_maps = maps;
        irradiance(&mut renderer, &config)
    };
    let rays = with(VisibilityMethod::RayTraced, 1024);
    let unshadowed = with(VisibilityMethod::None, 1024);
    let shared = with(VisibilityMethod::ImperfectShadowMaps, 1024);
    let few = with(VisibilityMethod::ImperfectShadowMaps, 64);
    let total = |values: &[Vec3]| values.iter().map(|v| f64::from(v.element_sum())).sum::<f64>();
    let off = |values: &[Vec3]| values.iter().zip(&rays).map(|(a, b)| f64::from((*a - *b).abs().element_sum())).sum::<f64>() / total(&rays);
    println!(
        "energy of 1024 shared maps {:.3}, of 64 {:.3}, unshadowed {:.3}; off by {:.3}, {:.3}, {:.3}",
        total(&shared) / total(&rays),
        total(&few) / total(&rays),
        total(&unshadowed) / total(&rays),
        off(&shared),
        off(&few),
        off(&unshadowed)
    );
    assert!((total(&shared) / total(&rays) - 1.0).abs() < 0.1);
    assert!(off(&shared) < off(&few) && off(&few) < off(&unshadowed));
    assert!(off(&shared) < 0.4 * off(&unshadowed));
    finish(renderer.gpu());
}

#[test]
fn the_preset_has_the_light_of_the_path_tracer_where_rays_make_its_shadows() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/configs/stochastic-culling.toml"));
    let sets = [
        "gather.stochastic.delta=1e-6", // At the preset's one realisation's light is off by a few percent.
        "scene.builtin=cornell",
        "frame.size=[96,96]",
        "gather.stochastic.statistics=true",
        "gather.stochastic.receiver=ggx",
        "visibility.method=ray-traced",
    ];
    let config = manylight::config::load(path, &sets.map(str::to_owned)).unwrap_or_else(|error| panic!("{error:#}")).config;
    let mut renderer = traced(load_scene(&config.scene).unwrap().0);
    let rendered = render(&mut renderer, &config, 0);
    let [diffuse, glossy, pixels] = ["diffuse-lit", "glossy-lit", "pixels"].map(|name| count(&rendered, &format!("gather/{name}")));
    assert!(diffuse > 100 * pixels && glossy > 100 * pixels, "{diffuse} diffuse and {glossy} glossy VPLs light {pixels} pixels");
    assert!(rendered.picture.unwrap().image == render(&mut renderer, &config, 0).picture.unwrap().image);
    let ratio = light(&mut renderer, &config, |_| true) / light_of_paths(&mut renderer, &config, 256, |_| true);
    println!("{ratio:.4} of the path tracer's light; {diffuse} diffuse and {glossy} glossy VPLs light {pixels} pixels");
    assert!((ratio - 1.0).abs() < 0.02, "{ratio} of the path tracer's light");
    finish(renderer.gpu());
}

#[test]
fn chance_is_the_same_in_every_frame_unless_it_is_to_be_another() {
    let (scene, mut config) = metal(0.1);
    config.rsm.size = [32, 32];
    config.gather.stochastic.delta = 0.1;
    let mut renderer = renderer(scene);
    let mut frames = |config: &Config| -> Vec<Vec<Vec3>> {
        let mut frame = |index| render(&mut renderer, config, index).picture.unwrap();
        [0, 1].map(&mut frame).into_iter().map(|picture| picture.irradiance.rgb().collect()).collect()
    };
    let fixed = frames(&config);
    assert!(fixed[0] == fixed[1]);
    config.gather.stochastic.roulette = RouletteChoice::PerFrame;
    let new = frames(&config);
    assert!(apart(&new[0], &new[1]) > 100);
    assert!(frames(&config) == new);
    finish(renderer.gpu());
}

#[test]
fn nothing_is_seen_through_the_corners_of_the_room_of_caustics() {
    for triangles in [8_190, 260_000] {
        let scene = SceneConfig { builtin: Some(Builtin::Caustics), triangles, ..SceneConfig::default() };
        let mut config = Config { scene, ..Config::default() };
        config.frame.size = [960, 540];
        config.rsm.size = [16, 16];
        config.vpls.count = 16;
        let mut renderer = renderer(load_scene(&config.scene).unwrap().0);
        let depth = picture(&mut renderer, &config).depth;
        let holes = (0..960 * 540).filter(|i| depth.at(*i)[0] <= 0.0).count();
        assert_eq!(holes, 0, "pixels show what is behind the room of {triangles} triangles");
        finish(renderer.gpu());
    }
}
