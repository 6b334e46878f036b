//! A device watched by the validation layer, scenes made by code, and their pictures.

use glam::{Affine3A, DVec3, Vec2, Vec3};
use manylight::config::{CameraConfig, Config, FilterKind, LightConfig, Shadows};
use manylight::gpu::{DeviceChoice, Gpu, Options};
use manylight::graph::{DumpData, Execution};
use manylight::output::Picture;
use manylight::reference::{Settings, Sums, Tracer};
use manylight::renderer::{Rendered, Renderer};
use manylight::scene::builder::Mesh;
use manylight::scene::{Material, Scene};
use manylight::world::Needs;
use std::cell::RefCell;
use std::f64::consts::PI;
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lock that gives devices to one test at a time. The software driver takes all cores for one test, and the validation layer
/// sometimes throws if one thread records while another makes or destroys an instance.
static TURN: Mutex<()> = Mutex::new(());

thread_local! {
    /// The thread's lock, released when the test's thread ends, after everything that it made.
    static TAKEN: RefCell<Option<MutexGuard<'static, ()>>> = const { RefCell::new(None) };
}

pub fn gpu() -> Gpu {
    TAKEN.with_borrow_mut(|taken| {
        taken.get_or_insert_with(|| TURN.lock().unwrap_or_else(PoisonError::into_inner));
    });
    let options = Options { device: DeviceChoice::Cpu, validate: true, ..Options::default() };
    Gpu::new(&options).unwrap_or_else(|error| panic!("{error:#}"))
}

/// Ends a test's use of a device: the validation layer must be silent.
pub fn finish(gpu: &Gpu) {
    let messages = gpu.validation_messages();
    assert!(messages.is_empty(), "the validation layer says:\n{}", messages.join("\n"));
}

pub fn renderer(scene: Scene) -> Renderer {
    Renderer::new(gpu(), scene, Needs::default()).unwrap_or_else(|error| panic!("{error:#}"))
}

/// [`renderer`] with ray tracing structures.
pub fn traced(scene: Scene) -> Renderer {
    let rays = Needs { rays: true };
    let mut renderer = Renderer::new(gpu(), scene, rays).unwrap_or_else(|error| panic!("{error:#}"));
    renderer.ensure(rays).unwrap_or_else(|error| panic!("{error:#}"));
    renderer
}

/// A scene from the folder beside the project. A missing one is reported as a skipped test.
pub fn shared_scene(name: &str) -> Option<Scene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(name);
    if !path.exists() {
        // Written directly, since the test harness hides the printed output of passing tests.
        let mut stderr = std::io::stderr();
        writeln!(stderr, "SKIPPED: {} is not there", path.display()).unwrap();
        return None;
    }
    Some(manylight::scene::gltf::load(&path, None).unwrap_or_else(|error| panic!("{error:#}")).scene)
}

/// Sums of `samples` paths per pixel.
pub fn reference(renderer: &mut Renderer, config: &Config, settings: Settings, samples: u32) -> Sums {
    let mut tracer = Tracer::new(renderer, config, settings, None).unwrap_or_else(|error| panic!("{error:#}"));
    for _ in 0..samples {
        tracer.sample(renderer, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    }
    let sums = tracer.sums(renderer).unwrap_or_else(|error| panic!("{error:#}"));
    tracer.free(renderer);
    sums
}

/// Settings of a reference with this many bounces.
pub fn bounces(bounces: u32) -> Settings {
    Settings { bounces, frame_index: 0, min_distance: 0.0, centered: false }
}

/// [`bounces`] with paths through pixel centres, for comparison with rasterized frames: their jagged edges would otherwise be
/// the largest difference.
pub fn centered(bounces: u32) -> Settings {
    Settings { centered: true, ..self::bounces(bounces) }
}

/// Mean of the chosen pixels' channels.
pub fn mean(texels: &[[f32; 4]], chosen: impl Fn(usize) -> bool) -> f64 {
    let values: Vec<f64> = (0..texels.len()).filter(|i| chosen(*i)).flat_map(|i| texels[i][..3].to_vec()).map(f64::from).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// A frame of the config, with the resources that these passes wrote.
pub fn dump(renderer: &mut Renderer, config: &Config, frame: u32, passes: &[&str]) -> Rendered {
    renderer.check(config).unwrap_or_else(|error| panic!("{error:#}"));
    let execution = Execution { dump: passes.iter().map(|pass| (*pass).to_owned()).collect(), ..Execution::default() };
    renderer.render(config, frame, true, &execution).unwrap_or_else(|error| panic!("{error:#}"))
}

/// A frame of the config.
pub fn render(renderer: &mut Renderer, config: &Config, frame: u32) -> Rendered {
    dump(renderer, config, frame, &[])
}

/// The picture of frame 0.
pub fn picture(renderer: &mut Renderer, config: &Config) -> Picture {
    render(renderer, config, 0).picture.unwrap_or_else(|| panic!("the picture was asked for"))
}

/// The irradiance of frame 0, row by row.
pub fn irradiance(renderer: &mut Renderer, config: &Config) -> Vec<Vec3> {
    picture(renderer, config).irradiance.rgb().collect()
}

/// A frame's count of this name.
pub fn count(rendered: &Rendered, name: &str) -> u64 {
    rendered.counts.iter().find(|(known, _)| known == name).map(|(_, count)| *count).unwrap_or_else(|| panic!("nothing counts {name}"))
}

/// Bytes of a dumped resource: texels or elements.
pub fn dumped<'r>(rendered: &'r Rendered, resource: &str) -> &'r [u8] {
    let dump = rendered.dumps.iter().find(|dump| dump.resource == resource).unwrap_or_else(|| panic!("{resource} was not dumped"));
    match &dump.data {
        DumpData::Image { texels, .. } => texels,
        DumpData::Buffer { bytes, .. } => bytes,
    }
}

/// Elements of a dumped resource.
pub fn pod<T: bytemuck::Pod>(rendered: &Rendered, resource: &str) -> Vec<T> {
    bytemuck::pod_collect_to_vec(dumped(rendered, resource))
}

/// Pseudorandom numbers in [0, 1), the same in every run.
pub fn random_numbers(count: usize) -> Vec<[f32; 4]> {
    let mut state = 0x853c_49e6_748f_ea9b_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    (0..count).map(|_| std::array::from_fn(|_| next())).collect()
}

/// Bytes as 32-bit numbers.
pub fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]]))
}

/// A config without approximations: no shadows, no interleaving, no filter, no bound on the singularity.
pub fn plain(size: [u32; 2], position: Vec3, target: Vec3, fov_y_deg: f32, light: LightConfig) -> Config {
    let camera = CameraConfig {
        position: Some(position.into()),
        target: Some(target.into()),
        fov_y_deg: Some(fov_y_deg),
        ..CameraConfig::default()
    };
    let mut config = Config { camera: Some(camera), light: vec![light], ..Config::default() };
    config.frame.size = size;
    config.gather.interleave = 1.into();
    config.gather.min_distance = 0.0;
    config.filter.kind = FilterKind::None;
    config.direct.shadows = Shadows::None;
    config
}

pub fn directional(direction: Vec3, irradiance: [f32; 3]) -> LightConfig {
    LightConfig::Directional { direction: Some(direction.into()), position: None, target: None, irradiance, keyframes: Vec::new() }
}

pub fn spot(position: Vec3, direction: Vec3, intensity: [f32; 3], inner_deg: f32, outer_deg: f32) -> LightConfig {
    LightConfig::Spot {
        position: position.into(),
        direction: Some(direction.into()),
        target: None,
        intensity,
        inner_deg: Some(inner_deg),
        outer_deg,
        keyframes: Vec::new(),
    }
}

/// Falloff of radiant intensity at an angle to a spot's axis; all angles are in radians.
pub fn linear_falloff(angle: f64, inner: f64, outer: f64) -> f64 {
    ((outer - angle) / (outer - inner)).clamp(0.0, 1.0)
}

pub fn matte(albedo: [f32; 3]) -> Material {
    let [r, g, b] = albedo;
    Material { base_color: [r, g, b, 1.0], ..Material::default() }
}

/// Adds a parallelogram with its own material; corners are counter-clockwise seen from its front.
pub fn add_quad(scene: &mut Scene, corners: [Vec3; 4], material: Material) {
    let mut mesh = Mesh::default();
    mesh.quad(corners, [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO]);
    let material = scene.add_material(material);
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY]);
}

/// One wall of a box in 64 bits, for computations without the engine.
#[derive(Debug, Clone, Copy)]
pub struct Wall {
    pub corner: DVec3,
    pub u: DVec3,
    pub v: DVec3,
    pub normal: DVec3,
    pub albedo: DVec3,
}

/// The walls of the box from the origin to `size`, facing inwards, in the order -X, +X, -Y, +Y, -Z, +Z.
pub fn walls(size: DVec3, albedos: [DVec3; 6]) -> [Wall; 6] {
    std::array::from_fn(|i| {
        let (axis, far) = (i / 2, i % 2 == 1);
        let mut along = [DVec3::ZERO; 3];
        for (k, vector) in along.iter_mut().enumerate() {
            vector[k] = size[k];
        }
        let mut normal = DVec3::ZERO;
        normal[axis] = if far { -1.0 } else { 1.0 };
        let (mut u, mut v) = (along[(axis + 1) % 3], along[(axis + 2) % 3]);
        if far {
            std::mem::swap(&mut u, &mut v);
        }
        Wall { corner: if far { along[axis] } else { DVec3::ZERO }, u, v, normal, albedo: albedos[i] }
    })
}

/// The scene of some walls, which reflect only on their inside.
pub fn room(walls: &[Wall]) -> Scene {
    let mut scene = Scene { name: "room".into(), ..Scene::default() };
    for wall in walls {
        let corners = [wall.corner, wall.corner + wall.u, wall.corner + wall.u + wall.v, wall.corner + wall.v];
        let inwards = wall.u.cross(wall.v).normalize();
        assert!((inwards - wall.normal).length() < 1e-9, "a wall faces inwards");
        add_quad(&mut scene, corners.map(|c| c.as_vec3()), matte(wall.albedo.as_vec3().into()));
    }
    scene
}

/// Irradiance at `x` on a surface of normal `n` from walls that reflect the irradiance `lit` once, by the midpoints of n x n
/// patches of each wall, without occlusion. Distances are clamped to `nearest`.
pub fn one_bounce(walls: &[Wall], nearest: f64, n: u32, x: DVec3, normal: DVec3, lit: impl Fn(&Wall, DVec3) -> DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for wall in walls {
        let area = wall.u.cross(wall.v).length() / f64::from(n * n);
        for i in 0..n * n {
            let (a, b) = ((f64::from(i % n) + 0.5) / f64::from(n), (f64::from(i / n) + 0.5) / f64::from(n));
            let y = wall.corner + wall.u * a + wall.v * b;
            let d = y - x;
            let cosines = d.dot(normal).max(0.0) * (-d.dot(wall.normal)).max(0.0);
            if cosines > 0.0 {
                let squared = d.length_squared();
                sum += lit(wall, y) * wall.albedo / PI * (cosines / (squared * squared.max(nearest * nearest)) * area);
            }
        }
    }
    sum
}
