//! The contract that all samplers' VPLs keep: `src/stages/README.md`.

use crate::common::*;
use glam::{DVec3, Vec2, Vec3};
use manylight::config::{Config, Dielectric, GatherMethod, Importance, LightConfig, Reflection, RsmAlbedo, VplSampler, choices};
use manylight::graph::Execution;
use manylight::renderer::{Rendered, Renderer};
use manylight::scene::builder::Mesh;
use manylight::scene::{Map, Material, Scene, Texture, Wrap, pack};
use manylight::stages::vpls::{Lobe, VplPlace};

const LIGHT: Vec3 = Vec3::new(1.0, 1.5, 1.0);

/// A box with one black wall, and a spot light whose map reaches past the box's open side: some texels have no surface, some no
/// light.
fn room_with_dark_parts() -> (Renderer, Config) {
    let mut albedos = [DVec3::splat(0.5); 6];
    albedos[1] = DVec3::ZERO;
    let renderer = renderer(room(&walls(DVec3::new(4.0, 3.0, 5.0), albedos)[..5]));
    let light = LightConfig::Spot {
        position: LIGHT.into(),
        direction: Some([1.0, -0.2, 1.0]),
        target: None,
        intensity: [10.0; 3],
        inner_deg: Some(20.0),
        outer_deg: 60.0,
        keyframes: Vec::new(),
    };
    let mut config = plain([16, 16], Vec3::new(1.0, 1.0, 4.0), Vec3::ZERO, 60.0, light);
    config.rsm.size = [32, 32];
    config.vpls.count = 333;
    (renderer, config)
}

#[test]
fn vpls_of_every_sampler_keep_the_contract() {
    let (mut renderer, mut config) = room_with_dark_parts();
    for name in choices("vpls.sampler") {
        config.vpls.sampler = serde_json::from_value(name.into()).unwrap();
        for importance in [Importance::None, Importance::PassedFlux, Importance::View] {
            if !go_together(config.vpls.sampler, importance) {
                continue;
            }
            for reflection in [Reflection::Diffuse, Reflection::Glossy, Reflection::Both] {
                config.vpls.importance = importance;
                config.vpls.reflection = reflection;
                config.materials.dielectric = if reflection == Reflection::Diffuse { Dielectric::Lambert } else { Dielectric::Ggx };
                config.gather.method = if reflection == Reflection::Diffuse { GatherMethod::PerPixel } else { GatherMethod::Stochastic };
                let what = format!("{name}, {importance:?}, {reflection:?}");
                renderer.check(&config).unwrap();
                let (passes, _) = renderer.names(&config).unwrap();
                let dump = passes.into_iter().filter(|pass| pass.starts_with("vpls/")).map(str::to_owned).collect();
                let rendered = renderer.render(&config, 0, false, &Execution { dump, ..Execution::default() }).unwrap();
                keeps_the_contract(&rendered, renderer.vpl_count(&config) as usize, reflection, importance, &what);
            }
        }
    }
    finish(renderer.gpu());
}

/// Whether a sampler draws by an importance.
fn go_together(sampler: VplSampler, importance: Importance) -> bool {
    match importance {
        Importance::None => true,
        Importance::PassedFlux => sampler == VplSampler::Hammersley,
        Importance::View => !matches!(sampler, VplSampler::Uniform | VplSampler::EveryTexel),
    }
}

#[test]
fn the_flux_of_every_sampler_is_that_of_all_texels() {
    let (mut renderer, mut config) = room_with_dark_parts();
    // Maps so fine that a sample more or less in a bright part is no matter.
    config.rsm.size = [128, 128];
    config.vpls.count = 4096;
    // Without a share by power, texels beyond the view would have no VPLs.
    config.vpls.view_importance.defensive = 0.3;
    let mut flux = |name: &str, importance: Importance| {
        config.vpls.sampler = serde_json::from_value(name.into()).unwrap();
        config.vpls.importance = importance;
        renderer.check(&config).unwrap();
        let (passes, _) = renderer.names(&config).unwrap();
        let dump = passes.into_iter().filter(|pass| pass.starts_with("vpls/")).map(str::to_owned).collect();
        let rendered = renderer.render(&config, 0, false, &Execution { dump, ..Execution::default() }).unwrap();
        pod::<[f32; 3]>(&rendered, "vpls/intensities").iter().map(|intensity| f64::from(intensity[0])).sum::<f64>()
    };
    let all = flux("every-texel", Importance::None);
    for name in choices("vpls.sampler") {
        for importance in [Importance::None, Importance::View] {
            if go_together(serde_json::from_value(name.into()).unwrap(), importance) {
                let share = flux(name, importance) / all;
                println!("{name}, {importance:?}: {share}");
                assert!((share - 1.0).abs() < 0.05, "{name}, {importance:?}: {share} of the flux of all texels");
            }
        }
    }
    finish(renderer.gpu());
}

fn keeps_the_contract(rendered: &Rendered, count: usize, reflection: Reflection, importance: Importance, what: &str) {
    let places: Vec<VplPlace> = pod(rendered, "vpls/places");
    let intensities: Vec<[f32; 3]> = pod(rendered, "vpls/intensities");
    let areas: Vec<f32> = pod(rendered, "vpls/areas");
    assert_eq!((places.len(), intensities.len(), areas.len()), (count, count, count), "{what}");
    let glossy = reflection != Reflection::Diffuse;
    let there = |name: &str| rendered.dumps.iter().any(|dump| dump.resource == name);
    assert_eq!(there("vpls/lobes"), glossy, "{what}");
    assert_eq!(there("vpls/kept"), importance == Importance::PassedFlux, "{what}");
    let lobes: Vec<Lobe> = if glossy { pod(rendered, "vpls/lobes") } else { Vec::new() };
    assert_eq!(lobes.len(), if glossy { count } else { 0 }, "{what}");
    let mut lit = 0;
    for i in 0..count {
        let shines = intensities[i] != [0.0; 3] || lobes.get(i).is_some_and(|lobe| lobe.flux != [0.0; 3]);
        assert_eq!(areas[i] > 0.0, shines, "{what}: VPL {i} has the area {} and the intensity {:?}", areas[i], intensities[i]);
        assert!(areas[i] >= 0.0 && areas[i].is_finite(), "{what}: VPL {i} has the area {}", areas[i]);
        if shines {
            lit += 1;
            let normal = pack::octahedral_snorm16_inverse(places[i].normal);
            assert!(places[i].position.iter().all(|x| x.is_finite()), "{what}: VPL {i} is at {:?}", places[i].position);
            let to_light = LIGHT - Vec3::from(places[i].position);
            assert!(normal.dot(to_light) > 0.0, "{what}: VPL {i} at {:?} has the normal {normal}", places[i].position);
        }
    }
    assert!(lit > 0, "{what}: none is lit");
    // Importance to the view leaves dark texels out, where it is known before a texel is drawn.
    if importance != Importance::View {
        assert!(lit < count, "{what}: all of {count} are lit, and some should be dark");
    }
    let counted = rendered.counts.iter().find(|(name, _)| name == "vpls/lit").map(|(_, count)| *count);
    assert_eq!(counted, Some(lit as u64), "{what}");
}

#[test]
fn vpls_have_the_colour_of_their_footprint_or_of_the_whole_texture() {
    // A floor that is black on one side and white on the other.
    let mut scene = Scene { name: "floor".into(), ..Scene::default() };
    let texels = (0..64 * 64).flat_map(|i| [if i % 64 < 32 { 0 } else { 255 }; 3].into_iter().chain([255]));
    let texture = scene.add_texture(Texture { name: "halves".into(), width: 64, height: 64, srgb: true, texels: texels.collect() });
    let map = Map { wrap_u: Wrap::ClampToEdge, wrap_v: Wrap::ClampToEdge, ..Map::new(texture) };
    let material = scene.add_material(Material { base_color_map: Some(map), ..matte([1.0; 3]) });
    let mut mesh = Mesh::default();
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let [a, b, c, d] = corners.map(|[u, v]| mesh.vertex(Vec3::new(4.0 * u - 2.0, 0.0, 4.0 * v - 2.0), Vec3::Y, Vec2::new(u, v)));
    mesh.indices.extend([a, b, c, a, c, d]);
    scene.add_mesh(&mesh, material, &[glam::Affine3A::IDENTITY]);
    let mut renderer = renderer(scene);
    let mut config = plain([16, 16], Vec3::new(0.0, 3.0, 3.0), Vec3::ZERO, 60.0, directional(Vec3::NEG_Y, [3.0; 3]));
    config.rsm.size = [64, 64];
    config.vpls.count = 64;
    let mut intensities = |albedo| {
        config.rsm.albedo = albedo;
        let rendered = dump(&mut renderer, &config, 0, &["vpls/regular"]);
        pod::<[f32; 3]>(&rendered, "vpls/intensities").into_iter().map(|rgb| f64::from(rgb[0])).collect::<Vec<_>>()
    };
    let (footprint, whole) = (intensities(RsmAlbedo::Footprint), intensities(RsmAlbedo::Material));
    let mean = whole.iter().sum::<f64>() / whole.len() as f64;
    assert!(mean > 0.0 && whole.iter().all(|own| (own / mean - 1.0).abs() < 0.01), "{whole:?}");
    let is_half = |share: f64| footprint.iter().filter(|own| (*own / mean - share).abs() < 0.02).count() >= 24;
    assert!(is_half(0.0) && is_half(2.0), "{footprint:?} around {mean}");
    finish(renderer.gpu());
}
