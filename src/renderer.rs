//! Renders a scene under a config, frame by frame: what the commands and the tests share.

use crate::config::{Config, Culling, Rasterization, Reflection, Shadows, TimingMode, VisibilityMethod};
use crate::fail;
use crate::frame::{Frame, Lighting, frame};
use crate::gpu::{Adapter, Feature, Gpu, Options};
use crate::graph::{Dump, Engine, Execution, Graph, Image, Library, ReadBack, Timing};
use crate::output::{Picture, Plane};
use crate::scene::device::DeviceScene;
use crate::scene::projection::{Projector, View};
use crate::scene::traced::TracedScene;
use crate::scene::{Aabb, Light, Scene, view};
use crate::stages::bounce::has_clusters;
use crate::stages::{self, METHODS, bounce, gather, visibility};
use crate::trace;
use anyhow::{Result, bail};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Whether frames of a config trace rays, which a renderer must be made for ([`Renderer::traced`]).
pub fn needs_rays(config: &Config) -> bool {
    config.visibility_methods().any(|method| method == VisibilityMethod::RayTraced) || config.direct.shadows == Shadows::RayTraced
}

/// A scene on a device, and everything that stays from frame to frame.
pub struct Renderer {
    engine: Engine,
    scene: Scene,
    device_scene: DeviceScene,
    traced: Option<TracedScene>,
    /// Where the scene's animation was when the hierarchy was built, seconds; unknown after one that failed.
    time_of_rays: Option<f64>,
    /// The frame before, which the next goes on from where it is the next one of the same config.
    last: Option<(Config, u32)>,
}

/// What a frame gave.
pub struct Rendered {
    /// Milliseconds of each pass, in order.
    pub times: Vec<(&'static str, f64)>,
    /// What passes counted, by name ([`Graph::count`]).
    pub counts: Vec<(String, u64)>,
    /// Bytes of every resource of the frame's own, by name ([`Graph::memory`]).
    pub memory: Vec<(String, u64)>,
    pub dumps: Vec<Dump>,
    /// Pass, image, and how many of its texels are not finite.
    pub non_finite: Vec<(&'static str, String, u32)>,
    /// The frame's images, if they were asked for.
    pub picture: Option<Picture>,
}

impl Rendered {
    /// What a user should know of how this frame went.
    pub fn warnings(&self) -> Vec<String> {
        // Of each bounce's maps.
        let dropped = self.counts.iter().filter(|(name, count)| name.starts_with("visibility/dropped-points") && *count > 0);
        let warning = |(_, count): &(String, u64)| {
            format!(
                "visibility.capacity: {count} points came to partitions that do not hold as many and were left out; raise it, or leave it to the program"
            )
        };
        let lost = self.counts.iter().filter(|(name, count)| name.starts_with("gather/lost") && *count > 0).map(|(_, count)| {
            format!("gather.culling: {count} nodes found no room in the clusters' light lists, and their light is missing; raise gather.delta or gather.interleave")
        });
        dropped.map(warning).chain(lost).collect()
    }
}

impl Renderer {
    /// Brings a scene to a device.
    pub fn new(gpu: Gpu, scene: Scene) -> Result<Self> {
        Self::bring(gpu, scene, false)
    }

    /// Brings a scene to a device, and what rays need of it.
    pub fn traced(gpu: Gpu, scene: Scene) -> Result<Self> {
        Self::bring(gpu, scene, true)
    }

    fn bring(gpu: Gpu, mut scene: Scene, traced: bool) -> Result<Self> {
        let _span = trace::span("bringing the scene to the device");
        let mut engine = Engine::new(gpu, Library::new()?);
        scene.set_time(0.0);
        let device_scene = DeviceScene::upload(&mut engine.gpu, &scene)?;
        let traced = if traced { Some(TracedScene::upload(&mut engine.gpu, &scene)?) } else { None };
        // What frames need of it from here on: lights and cameras, where draws move their transforms, and all for a hierarchy.
        let scene = match (&scene.animation, &traced) {
            (None, _) => Scene { name: scene.name, lights: scene.lights, cameras: scene.cameras, ..Scene::default() },
            (Some(_), None) => Scene { vertices: Vec::new(), indices: Vec::new(), textures: Vec::new(), ..scene },
            (Some(_), Some(_)) => scene,
        };
        Ok(Self { engine, scene, device_scene, traced, time_of_rays: Some(0.0), last: None })
    }

    /// Opens a device and brings a scene to it.
    pub fn open(options: &Options, scene: Scene) -> Result<Self> {
        Self::new(Gpu::new(options)?, scene)
    }

    pub fn gpu(&self) -> &Gpu {
        &self.engine.gpu
    }

    /// The key of all shaders: [`Library::key_of_all`].
    pub fn shaders(&self) -> String {
        self.engine.shaders_key().to_hex().to_string()
    }

    pub fn engine(&mut self) -> &mut Engine {
        // What others run on it is between the frames.
        self.last = None;
        &mut self.engine
    }

    pub fn device_scene(&self) -> &DeviceScene {
        &self.device_scene
    }

    /// What the config leaves to the program, by key, and what that chooses on this device: `gather.rasterization`.
    pub fn choices(&self, config: &Config) -> BTreeMap<&'static str, Value> {
        let mut choices = BTreeMap::new();
        if config.gather.culling == Culling::ConservativeClusters && config.gather.rasterization == Rasterization::Automatic {
            choices.insert("gather.rasterization", json!(config.gather.rasterization.resolved(self.device_scene.shells.conservative)));
        }
        choices
    }

    /// What rays need of the scene, where it was brought too.
    pub fn traced_scene(&self) -> Option<&TracedScene> {
        self.traced.as_ref()
    }

    /// Whether the scene has an animation that moves it.
    pub fn moves(&self) -> bool {
        self.scene.animation.is_some()
    }

    /// Moves what rays meet to where the scene's animation has it at a time; does nothing where it is there.
    ///
    /// Fails where the device cannot hold it.
    pub fn set_time_of_rays(&mut self, seconds: f64) -> Result<()> {
        let Some(traced) = &mut self.traced else { return Ok(()) };
        if self.scene.animation.is_some() && self.time_of_rays != Some(seconds) {
            let _span = trace::span("moving what rays meet");
            self.scene.set_time(seconds);
            self.time_of_rays = None;
            traced.follow(&mut self.engine.gpu, &self.scene)?;
            self.time_of_rays = Some(seconds);
        }
        Ok(())
    }

    /// Moves all that a frame needs to its time.
    fn set_time(&mut self, config: &Config, frame_index: u32) -> Result<()> {
        if self.scene.animation.is_none() {
            return Ok(());
        }
        let seconds = view::seconds(config, frame_index);
        if needs_rays(config) {
            self.set_time_of_rays(seconds)?;
        }
        self.scene.set_time(seconds);
        self.device_scene.follow(&self.scene);
        Ok(())
    }

    /// The lights of a frame.
    pub fn lights(&self, config: &Config, frame_index: u32) -> Vec<Light> {
        view::lights(config, &self.scene, frame_index)
    }

    /// How a frame is seen.
    pub fn view(&self, config: &Config, frame_index: u32) -> Result<View> {
        let camera = view::camera(config, &self.scene, self.device_scene.bounds, frame_index)?;
        Ok(View::new(&camera, config.frame.size, self.device_scene.bounds))
    }

    /// Refuses what the device cannot do under this config, by the keys that ask for it.
    pub fn check(&self, config: &Config) -> Result<()> {
        let adapter = &self.engine.gpu.adapter;
        let limits = &adapter.limits;
        let [width, height] = config.frame.size;
        let [max_width, max_height] = limits.framebuffer_size.map(|n| n.min(limits.image_size));
        if width > max_width || height > max_height {
            return Err(fail!(BadInput, "frame.size: {width}x{height} is over the {max_width}x{max_height} that {} allows", adapter.name));
        }
        let map = config.rsm.size;
        if map[0] > max_width || map[1] > max_height {
            return Err(fail!(
                BadInput,
                "rsm.size: {}x{} is over the {max_width}x{max_height} that {} allows",
                map[0],
                map[1],
                adapter.name
            ));
        }
        check_methods(adapter, config)?;
        if needs_rays(config) && self.traced.is_none() {
            bail!("{}: the config traces rays, and the scene was brought without what they need (Renderer::traced)", self.scene.name);
        }
        let maps = self.lighting(config, 0)?.projectors.len() as u64;
        let texels = maps * u64::from(map[0]) * u64::from(map[1]);
        let count = u64::from(config.vpl_count(maps as u32));
        if count < maps || count > texels {
            return Err(fail!(
                BadInput,
                "vpls.count: {count} is out of range, expected {maps} to {texels}: at least one for each shadow map, at most one a texel"
            ));
        }
        if has_clusters(config) {
            let counts = [("vpls.count", count as u32), ("bounce.vpls", config.bounce.vpls)];
            for (key, count) in &counts[..if config.bounce.count > 2 { 2 } else { 1 }] {
                if bounce::most_rounds(*count, config.bounce.clusters) == 0 {
                    return Err(fail!(
                        BadInput,
                        "{key}: {count} VPLs are too many to be put into {} clusters on every driver; lower either",
                        config.bounce.clusters
                    ));
                }
            }
        }
        if let Some(shared) = config.shared_maps()
            && texels / u64::from(shared).max(maps).max(1) > visibility::MOST_TEXELS_A_MAP
        {
            return Err(fail!(
                BadInput,
                "visibility.shared_maps: {shared} leave {} texels to each, over the {} that every driver takes; raise it",
                texels / u64::from(shared).max(maps).max(1),
                visibility::MOST_TEXELS_A_MAP
            ));
        }
        let most = u64::from(limits.image_layers) * u64::from(visibility::BITS);
        let lists = [("vpls.count", count as u32), ("bounce.vpls", if config.bounce.count > 1 { config.bounce.vpls } else { 0 })];
        for ((key, count), method) in lists.into_iter().zip(config.visibility_methods()) {
            let each = u64::from(gather::vpls_a_pixel(count, config.gather.interleave));
            if method == VisibilityMethod::RayTraced && each > most {
                return Err(fail!(
                    BadInput,
                    "gather.interleave: {} leaves {each} VPLs to each pixel, over the {most} that \"ray-traced\" visibility keeps on {}; raise it or lower {key}",
                    config.gather.interleave,
                    adapter.name
                ));
            }
            let lists = if config.vpls.reflection == Reflection::Both { 2 } else { 1 };
            if config.gather.culling.is_stochastic() && each > gather::MOST_TURNS / (lists + 1) {
                return Err(fail!(
                    BadInput,
                    "gather.interleave: {} leaves {each} VPLs to each pixel, over the {} that every driver culls by chance; raise it or lower {key}",
                    config.gather.interleave,
                    gather::MOST_TURNS / (lists + 1)
                ));
            }
            let pairs = u64::from(width) * u64::from(height) * each;
            if config.gather.statistics && pairs > u64::from(u32::MAX) {
                return Err(fail!(
                    BadInput,
                    "gather.statistics: pictures of {width}x{height} may have {pairs} pairs of pixels and VPLs, over the {} that are counted; raise gather.interleave or take a smaller picture",
                    u32::MAX
                ));
            }
            if config.gather.culling == Culling::ConservativeClusters {
                let bytes = gather::shell_bytes(config.frame.size, config.gather.interleave, count);
                if bytes > limits.storage_buffer_bytes {
                    return Err(fail!(
                        BadInput,
                        "gather.culling: \"conservative-clusters\" needs {} MB for {count} VPLs in pictures of {width}x{height}, over the {} MB that {} allows a buffer; raise gather.interleave",
                        bytes >> 20,
                        limits.storage_buffer_bytes >> 20,
                        adapter.name
                    ));
                }
            }
            if each > gather::MOST_VPLS_A_PIXEL {
                return Err(fail!(
                    BadInput,
                    "gather.interleave: {} leaves {each} VPLs to each pixel, over the {} that every driver sums; raise it or lower {key}",
                    config.gather.interleave,
                    gather::MOST_VPLS_A_PIXEL
                ));
            }
        }
        Ok(())
    }

    /// Virtual point lights of the first bounce.
    pub fn vpl_count(&self, config: &Config) -> u32 {
        config.vpl_count(self.lighting(config, 0).map_or(1, |lighting| lighting.projectors.len() as u32))
    }

    fn lighting(&self, config: &Config, frame_index: u32) -> Result<Lighting> {
        let lights = view::lights(config, &self.scene, frame_index);
        let bounds = self.device_scene.bounds;
        let target = config.rsm.bounds.map_or(bounds, |b| Aabb { min: b.min.into(), max: b.max.into() });
        let projectors = Projector::of_lights(&lights, config.rsm.size, target, bounds);
        let limits = &self.engine.gpu.adapter.limits;
        let most = limits.image_layers.min(limits.framebuffer_layers).min(Projector::MAX as u32);
        if projectors.is_empty() {
            return Err(fail!(
                BadInput,
                "light: {} has no directional, spot or point light; add a [[light]] table to the config",
                self.scene.name
            ));
        }
        if projectors.len() > most as usize {
            return Err(fail!(
                BadInput,
                "light: {} shadow maps (a point light takes six) are over the {most} that fit on {}; take fewer [[light]] tables",
                projectors.len(),
                self.engine.gpu.adapter.name
            ));
        }
        let environment = lights.iter().filter_map(|light| match light {
            Light::Environment { radiance } => Some(*radiance),
            _ => None,
        });
        Ok(Lighting { projectors, environment: environment.sum() })
    }

    /// What a user should know of how this config is rendered.
    pub fn warnings(&self, config: &Config) -> Vec<String> {
        let lights = view::lights(config, &self.scene, 0);
        let environment = lights.iter().any(|light| matches!(light, Light::Environment { .. }));
        let warning = "light: an environment is seen by the camera, but lights nothing in a rasterized frame";
        let wide = |light: &Light| matches!(light, Light::Spot { outer, .. } if *outer > Projector::WIDEST_SPOT);
        let cut = "light: a spot light is wider than 80 degrees to each side; beyond them it lights nothing";
        let bent = "scene.split: is not set, and the maps of clusters bend the edges of large triangles; 0.02 is a good value";
        let slow =
            "bounce.rounds: so many VPLs and clusters have fewer rounds of k-means a frame; clusters may be unsettled for some frames";
        let few = has_clusters(config) && bounce::most_rounds(config.vpl_count(1), config.bounce.clusters) < config.bounce.rounds;
        let warnings = [
            environment.then_some(warning),
            lights.iter().any(wide).then_some(cut),
            (has_clusters(config) && config.scene.split.is_none()).then_some(bent),
            few.then_some(slow),
        ];
        warnings.into_iter().flatten().map(str::to_owned).collect()
    }

    /// Compiles the shaders and makes the pipelines of this config, those of what no view sees yet too, so that no frame has to.
    ///
    /// Refuses names of passes to dump that the frame does not have.
    pub fn prepare(&mut self, config: &Config, dump: &[String]) -> Result<()> {
        let _span = trace::span("preparing the shaders");
        self.set_time(config, 0)?;
        let mut g = Graph::warming_up();
        self.describe(&mut g, config, 0)?;
        if let Some(unknown) = dump.iter().find(|name| !g.pass_names().any(|pass| pass == *name)) {
            let names = g.pass_names().collect::<Vec<_>>().join(", ");
            return Err(fail!(BadInput, "--dump {unknown}: there is no such pass; there are {names}"));
        }
        self.engine.prepare(&g)
    }

    /// The names of a config's passes, and of the resources of its frames.
    pub fn names(&self, config: &Config) -> Result<(Vec<&'static str>, Vec<String>)> {
        let mut g = Graph::new();
        self.describe(&mut g, config, 0)?;
        Ok((g.pass_names().collect(), g.memory().into_iter().map(|(name, _)| name).collect()))
    }

    /// Runs frame 0 with a triangle of every kind that the scene draws, so that no later frame is the first to use a pipeline.
    pub fn warm_up(&mut self, config: &Config, execution: &Execution) -> Result<()> {
        self.set_time(config, 0)?;
        let mut g = Graph::warming_up();
        self.describe(&mut g, config, 0)?;
        self.last = None;
        self.engine.execute(&g, execution).map(|_| ())
    }

    /// The frame's graph, and the view that it is seen by.
    fn describe(&self, g: &mut Graph, config: &Config, frame_index: u32) -> Result<(Frame, View)> {
        let _span = trace::span("describing");
        let view = self.view(config, frame_index)?;
        let lighting = self.lighting(config, frame_index)?;
        Ok((frame(g, &self.device_scene, self.traced.as_ref(), &view, &lighting, config, frame_index), view))
    }

    /// Renders frame `frame_index`; its images are only brought back where `pictured`. A frame that comes right after the one before it of the same
    /// config goes on from it ([`Graph::history`]); any other starts anew, so that what was rendered before it changes nothing.
    pub fn render(&mut self, config: &Config, frame_index: u32, pictured: bool, execution: &Execution) -> Result<Rendered> {
        self.set_time(config, frame_index)?;
        if !self.last.take().is_some_and(|(last, index)| last == *config && index + 1 == frame_index) {
            self.engine.forget();
        }
        let mut g = Graph::new();
        let (frame, view) = self.describe(&mut g, config, frame_index)?;
        let images = [
            frame.composed.image,
            frame.composed.radiance,
            frame.direct,
            frame.composed.indirect,
            frame.irradiance,
            frame.gbuffer.albedo,
            frame.gbuffer.normal,
            frame.gbuffer.depth,
        ];
        let read: Vec<ReadBack> = if pictured { images.iter().map(|image| g.read_back(*image)).collect() } else { Vec::new() };
        let outcome = self.engine.execute(&g, execution)?;
        self.last = Some((config.clone(), frame_index));
        let _span = pictured.then(|| trace::span("decoding the images"));
        let picture = match read.as_slice() {
            [image, planes @ ..] => {
                let plane = |(image, read): (&Image, &ReadBack)| Plane::decode(image.format, outcome.bytes(*read));
                let decoded: Vec<Plane> = images[1..].iter().zip(planes).map(plane).collect();
                let Ok([radiance, direct, indirect, irradiance, albedo, normal, depth]) = <[Plane; 7]>::try_from(decoded) else {
                    bail!("the frame's images did not all come back");
                };
                let image = outcome.bytes(*image).to_vec();
                Some(Picture { size: config.frame.size, view, image, radiance, direct, indirect, irradiance, albedo, normal, depth })
            }
            [] => None,
        };
        Ok(Rendered {
            times: outcome.times,
            counts: outcome.counts,
            memory: g.memory(),
            dumps: outcome.dumps,
            non_finite: outcome.non_finite,
            picture,
        })
    }
}

/// How the config wants its passes timed, as far as the device can.
pub fn timing(config: &Config, adapter: &Adapter) -> Timing {
    match config.frame.timing {
        _ if !adapter.has(Feature::Timestamps) => Timing::Serial,
        TimingMode::Isolated => Timing::Isolated,
        TimingMode::Overlapped => Timing::Overlapped,
        TimingMode::Serial => Timing::Serial,
    }
}

/// Refuses a config whose methods need what the device lacks.
fn check_methods(adapter: &Adapter, config: &Config) -> Result<()> {
    let values = serde_json::to_value(config).unwrap_or_else(|error| panic!("a config that JSON has no words for: {error}"));
    let maps = config.visibility_methods().any(|method| method == VisibilityMethod::ImperfectShadowMaps);
    let idle = |key: &str| {
        (!maps && stages::OF_MAPS.contains(&key))
            || (!has_clusters(config) && stages::OF_CLUSTERS.contains(&key))
            || (config.gather.culling != Culling::ConservativeClusters && stages::OF_SHELLS.contains(&key))
    };
    let chosen = |key: &str, name: &str| match values.pointer(&format!("/{}", key.replace('.', "/"))) {
        Some(Value::String(value)) => value == name && !idle(key),
        _ => true, // there is but one way
    };
    for method in METHODS.iter().filter(|method| chosen(method.slot, method.name)) {
        let missing = method.missing(adapter);
        if !missing.is_empty() {
            let list = missing.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            return Err(fail!(
                NoDevice,
                "{} = \"{}\" needs {list}, which {} lacks; `manylight doctor` shows what runs here",
                method.slot,
                method.name,
                adapter.name
            ));
        }
    }
    Ok(())
}
