//! Why a pixel is lit: the VPLs' shares sum to the picture, and rays are the truth.

use crate::common::*;
use glam::Vec3;
use manylight::config::{Block, Builtin, Config, Culling, GatherMethod, SceneConfig, VisibilityMethod, VplSampler};
use manylight::inspection::Explanation;
use manylight::renderer::Renderer;
use manylight::scene::source::load_scene;
use manylight::world::Inspection;

fn config() -> Config {
    let mut config = Config { scene: SceneConfig { builtin: Some(Builtin::Cornell), ..SceneConfig::default() }, ..Config::default() };
    config.frame.size = [96, 72];
    config.rsm.size = [128, 128];
    config.vpls.count = 333;
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    config.visibility.ism.point_count = 4000;
    config
}

fn cornell() -> Renderer {
    traced(load_scene(&config().scene).unwrap().0)
}

fn ask(renderer: &mut Renderer, config: &Config, pixel: [u32; 2]) -> Explanation {
    let inspection = Inspection { pixel: Some(pixel), vpls: false };
    let rendered = renderer.inspect(config, 0, inspection, false, &Default::default()).unwrap_or_else(|error| panic!("{error:#}"));
    rendered.inspected.explanation.unwrap()
}

fn pixels() -> impl Iterator<Item = [u32; 2]> {
    (0..6).flat_map(|y| (0..6).map(move |x| [7 + 15 * x, 5 + 12 * y]))
}

/// Fails unless two colours are within the rounding of 16-bit floats.
fn assert_same(found: Vec3, expected: Vec3, what: &str) {
    let most = expected.abs().max_element();
    assert!((found - expected).abs().max_element() <= 2e-3 * most + 1e-5, "{what}: {found} against {expected}");
}

#[test]
fn shares_sum_to_the_irradiance_before_the_filter_and_that_leads_to_the_picture() {
    let mut renderer = cornell();
    for culling in [Culling::None, Culling::Tiled, Culling::Clustered] {
        for interleave in [1, 4] {
            let mut config = config();
            config.gather.method = GatherMethod::PerPixel;
            config.gather.per_pixel.culling = culling;
            config.gather.interleave = Block::from(interleave);
            let pictured = renderer.render(&config, 0, true, &Default::default()).unwrap().picture.unwrap();
            let mut lit = 0;
            for pixel in pixels() {
                let what = format!("{culling:?}, {interleave}x{interleave}, pixel {pixel:?}");
                let asked = ask(&mut renderer, &config, pixel);
                let sums = asked.sums();
                assert_same(sums.light, asked.gathered, &what);
                assert_eq!(asked.bounces.iter().map(Vec::len).collect::<Vec<_>>(), [333]);
                let at = pixel[1] as usize * 96 + pixel[0] as usize;
                let color = |values: [f32; 4]| Vec3::new(values[0], values[1], values[2]);
                assert_eq!(asked.irradiance, color(pictured.irradiance.at(at)), "{what}");
                assert_eq!(asked.radiance, color(pictured.radiance.at(at)), "{what}");
                assert_same(asked.direct + asked.indirect, asked.radiance, &what);
                assert_same(asked.irradiance * asked.albedo * asked.visible / std::f32::consts::PI, asked.indirect, &what);
                if interleave == 1 {
                    assert_same(sums.seen.unwrap(), sums.light, &what);
                    assert_eq!(asked.irradiance, asked.gathered, "nothing is filtered");
                }
                lit += usize::from(sums.light.min_element() > 0.0);
            }
            assert!(lit > 25, "{lit} pixels are lit");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn rays_say_what_ray_traced_visibility_sees() {
    let mut renderer = cornell();
    let mut config = config();
    config.visibility.method = VisibilityMethod::RayTraced;
    config.gather.interleave = Block::from(2);
    let (mut seen, mut hidden) = (0, 0);
    for pixel in pixels() {
        let asked = ask(&mut renderer, &config, pixel);
        assert_same(asked.sums().light, asked.gathered, &format!("pixel {pixel:?}"));
        for light in asked.lighting().iter().filter(|light| light.share.is_of_set == 1) {
            // A VPL in the receiver's plane has no cosine that rounding leaves its sign.
            if light.from > 1e-3 && light.to > 1e-3 {
                assert_eq!(light.share.seen, light.share.by_rays, "pixel {pixel:?}, VPL {}", light.index);
                seen += usize::from(light.share.seen > 0.0);
                hidden += usize::from(light.share.seen == 0.0);
            }
        }
    }
    assert!(seen > 500 && hidden > 50, "{seen} seen, {hidden} hidden");
    finish(renderer.gpu());
}

#[test]
fn the_brightest_vpl_comes_first_with_its_distance_and_cosines() {
    let mut renderer = cornell();
    let mut config = config();
    config.gather.interleave = Block::from(1);
    config.visibility.method = VisibilityMethod::None;
    let asked = pixels().map(|pixel| ask(&mut renderer, &config, pixel)).max_by_key(|asked| asked.lighting().len()).unwrap();
    let all = asked.lighting();
    assert!(all.len() > 50, "{}", all.len());
    let lights: Vec<f32> = all.iter().map(|light| Vec3::from(light.share.light).dot(Vec3::new(0.2126, 0.7152, 0.0722))).collect();
    assert!(lights.is_sorted_by(|a, b| a >= b));
    let least = config.gather.min_distance;
    for light in &all {
        let facing = Vec3::from(light.share.intensity) * light.to / light.distance.max(least).powi(2);
        assert_same(light.share.open.into(), facing, &format!("VPL {}", light.index));
        assert!(light.from > 0.0 && light.to > 0.0);
    }
    finish(renderer.gpu());
}

#[test]
fn area_lights_of_light_caches_are_those_that_shine_on_a_pixel_itself() {
    let mut renderer = cornell();
    let mut config = config();
    config.gather.interleave = Block::from(1);
    config.vpls.sampler = VplSampler::EveryTexel;
    config.rsm.size = [48, 48];
    let (mut caches, mut points) = (Vec3::ZERO, Vec3::ZERO);
    for pixel in pixels() {
        config.gather.method = GatherMethod::PerPixel;
        let by_points = ask(&mut renderer, &config, pixel);
        config.gather.method = GatherMethod::LightCaches;
        let by_caches = ask(&mut renderer, &config, pixel);
        for (disk, point) in by_caches.bounces.iter().flatten().zip(by_points.bounces.iter().flatten()) {
            assert_eq!((disk.position, disk.by_rays), (point.position, point.by_rays), "pixel {pixel:?}");
        }
        caches += by_caches.sums().by_rays;
        points += by_points.sums().by_rays;
    }
    // Small disks are points, seen from afar; from nearby they are dimmer.
    let ratio = caches / points;
    println!("disks have {ratio} of the light of points");
    assert!(ratio.min_element() > 0.995 && ratio.max_element() < 1.0, "{ratio}");
    finish(renderer.gpu());
}

#[test]
fn the_sky_has_no_vpls() {
    let mut renderer = cornell();
    let mut config = config();
    config.camera =
        Some(manylight::config::CameraConfig { position: Some([0.0, 1.0, 20.0]), target: Some([0.0, 1.0, 30.0]), ..Default::default() });
    let asked = ask(&mut renderer, &config, [48, 36]);
    assert_eq!((asked.surface, asked.sums().open), (None, Vec3::ZERO));
    assert!(asked.lighting().is_empty());
    finish(renderer.gpu());
}
