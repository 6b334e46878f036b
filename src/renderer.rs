//! Renderer of a scene under a config, frame by frame: shared by the commands and the tests.

use crate::config::{Config, TimingMode};
use crate::fail;
use crate::frame::{Frame, frame};
use crate::gpu::{Adapter, Feature, Gpu, Options};
use crate::graph::{Dump, Engine, Execution, Graph, Image, Library, Output, Pool, ReadBack, Timing};
use crate::inspection::{Inspected, Wanted};
use crate::output::{Picture, Plane};
use crate::scene::{Camera, Light, Scene};
use crate::stages::facts::Facts;
use crate::stages::residents::Residents;
use crate::stages::{self, gather};
use crate::trace;
use crate::world::projection::View;
use crate::world::{Inspection, Lighting, Needs, Shot, World};
use anyhow::{Result, bail};
use serde_json::Value;
use std::collections::BTreeMap;

/// Requirements of a config on the world.
pub fn needs(config: &Config) -> Needs {
    Needs { rays: stages::needs_rays(config) }
}

/// State of a sequence of frames. Sequences that take turns on one [`Renderer`] do not disturb each other.
#[derive(Default)]
pub struct Lane {
    pool: Pool,
    /// The shot of the frame before.
    before: Option<Shot>,
}

impl Lane {
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the sequence: the next frame starts anew, with [`Graph::history`] zeroed.
    pub fn cut(&mut self) {
        self.before = None;
    }

    /// The shot of the frame before; `None` if the next frame starts anew.
    pub fn before(&self) -> Option<&Shot> {
        self.before.as_ref()
    }
}

/// A scene on a device, with shaders, pipelines and the stages' residents.
pub struct Renderer {
    engine: Engine,
    world: World,
    residents: Residents,
    /// The sequence of [`Self::render`], and its config.
    batch: Lane,
    batch_config: Option<Config>,
}

/// Results of a frame.
pub struct Rendered {
    /// Milliseconds of each pass, in order.
    pub times: Vec<(&'static str, f64)>,
    /// Counters of the passes, by name ([`Graph::count`]).
    pub counts: Vec<(String, u64)>,
    /// Bytes of each of the frame's own resources, by name ([`Graph::memory`]).
    pub memory: Vec<(String, u64)>,
    pub dumps: Vec<Dump>,
    /// Pass, image, and number of texels that are not finite.
    pub non_finite: Vec<(&'static str, String, u32)>,
    /// The frame's images, if they were requested.
    pub picture: Option<Picture>,
    /// Answers to what was asked about the frame.
    pub inspected: Inspected,
}

impl Rendered {
    /// Warnings about this frame.
    pub fn warnings(&self) -> Vec<String> {
        stages::warnings_of_frame(&self.counts)
    }
}

impl Renderer {
    /// Uploads a scene to a device. `may_need` covers the requirements ([`needs`]) of all configs that will be rendered.
    ///
    /// # Errors
    /// As [`World::bring`].
    pub fn new(gpu: Gpu, scene: Scene, may_need: Needs) -> Result<Self> {
        let _span = trace::span("bringing the scene to the device");
        let mut engine = Engine::new(gpu, Library::new()?);
        let world = World::bring(&mut engine.gpu, scene, may_need)?;
        Ok(Self { engine, world, residents: Residents::default(), batch: Lane::new(), batch_config: None })
    }

    /// Opens a device and uploads a scene to it.
    pub fn open(options: &Options, scene: Scene, may_need: Needs) -> Result<Self> {
        Self::new(Gpu::new(options)?, scene, may_need)
    }

    pub fn gpu(&self) -> &Gpu {
        &self.engine.gpu
    }

    /// Key of all shaders: [`Library::key_of_all`].
    pub fn shaders(&self) -> String {
        self.engine.shaders_key().to_hex().to_string()
    }

    pub fn engine(&mut self) -> &mut Engine {
        &mut self.engine
    }

    pub fn world(&self) -> &World {
        &self.world
    }

    /// Moves the acceleration structure to a time of the scene's animation, seconds.
    ///
    /// # Errors
    /// The device's own, when memory runs out, and limits of the scene's size.
    pub fn set_time_of_rays(&mut self, seconds: f64) -> Result<()> {
        self.world.set_time_of_rays(&mut self.engine.gpu, seconds)
    }

    /// Makes missing parts of the world: [`World::ensure`].
    pub fn ensure(&mut self, needs: Needs) -> Result<()> {
        let _span = trace::span("bringing what rays need");
        self.world.ensure(&mut self.engine.gpu, needs)
    }

    /// Reads the map of a config's environment, if it has one and it is not there yet.
    ///
    /// # Errors
    /// `BadInput` for a file that is no such map, and the device's own.
    pub fn ensure_sky(&mut self, config: &Config) -> Result<()> {
        self.world.ensure_sky(&mut self.engine.gpu, config)
    }

    /// Makes missing parts of the world and missing residents of the stages for a config.
    fn ensure_for(&mut self, config: &Config) -> Result<()> {
        self.world.ensure(&mut self.engine.gpu, needs(config))?;
        self.ensure_sky(config)?;
        self.residents.bring(&mut self.engine.gpu, &mut self.world, config)
    }

    /// Choices that the config leaves to the program, by key, resolved for this device.
    pub fn choices(&self, config: &Config) -> BTreeMap<&'static str, Value> {
        gather::choices(config, &self.engine.gpu.adapter)
    }

    /// Lights of a frame.
    pub fn lights(&self, config: &Config, frame_index: u32) -> Vec<Light> {
        self.world.lights(config, frame_index)
    }

    /// Camera view of a frame.
    pub fn view(&self, config: &Config, frame_index: u32) -> Result<View> {
        self.world.view(config, frame_index)
    }

    /// Camera of a frame, as the config or the scene has it.
    pub fn camera(&self, config: &Config, frame_index: u32) -> Result<Camera> {
        self.world.camera(config, frame_index)
    }

    /// View, lighting and time of a frame.
    pub fn shot(&self, config: &Config, frame_index: u32) -> Result<Shot> {
        Shot::of(config, &self.world, &self.engine.gpu.adapter, frame_index)
    }

    /// Refuses configs that the device cannot run; errors name the key: [`stages::check`].
    pub fn check(&self, config: &Config) -> Result<()> {
        let adapter = &self.engine.gpu.adapter;
        let maps = Lighting::of(config, &self.world, adapter, 0)?.projectors.len() as u32;
        stages::check(config, &Facts::of(config, adapter, maps))
    }

    /// Number of virtual point lights of the first bounce; 0 without a light that has a map.
    pub fn vpl_count(&self, config: &Config) -> u32 {
        let lighting = Lighting::of(config, &self.world, &self.engine.gpu.adapter, 0);
        match lighting.map_or(1, |lighting| lighting.projectors.len() as u32) {
            0 => 0,
            layers => config.vpl_count(layers),
        }
    }

    /// Number of light caches of all instances, once a frame of the config has been prepared; `None` if it has none.
    pub fn light_cache_count(&self, config: &Config) -> Option<u64> {
        self.residents.light_cache_count(config)
    }

    /// Warnings about a config.
    pub fn warnings(&self, config: &Config) -> Vec<String> {
        stages::warnings(config, self.world.scene(), &self.world.lights(config, 0), config.vpl_count(1))
    }

    /// Compiles the shaders and creates all pipelines of a config, also for parts of the scene that no view sees yet, so that no frame has
    /// to.
    ///
    /// Refuses names in `dump` that are not passes of the frame.
    pub fn prepare(&mut self, config: &Config, dump: &[String]) -> Result<()> {
        let _span = trace::span("preparing the shaders");
        self.ensure_for(config)?;
        let shot = self.shot(config, 0)?;
        self.world.set_time(&mut self.engine.gpu, shot.seconds, needs(config))?;
        let mut g = Graph::warming_up();
        self.describe(&mut g, &shot, config);
        if let Some(unknown) = dump.iter().find(|name| !g.pass_names().any(|pass| pass == *name)) {
            let names = g.pass_names().collect::<Vec<_>>().join(", ");
            return Err(fail!(BadInput, "--dump {unknown}: there is no such pass; there are {names}"));
        }
        self.engine.prepare(&g)
    }

    /// Reads the shaders again, and keeps them if they make a config's pipelines; else the ones before stay. Returns whether they had
    /// changed.
    ///
    /// # Errors
    /// As [`Engine::reload`].
    pub fn reload(&mut self, config: &Config) -> Result<bool> {
        self.ensure_for(config)?;
        let shot = self.shot(config, 0)?;
        let mut g = Graph::warming_up();
        self.describe(&mut g, &shot, config);
        self.engine.reload(|engine| engine.prepare(&g))
    }

    /// Names of a config's passes, and of the resources and told numbers of its frames.
    pub fn names(&mut self, config: &Config) -> Result<(Vec<&'static str>, Vec<String>)> {
        self.ensure_for(config)?;
        let shot = self.shot(config, 0)?;
        let mut g = Graph::new();
        self.describe(&mut g, &shot, config);
        let resources = g.memory().into_iter().map(|(name, _)| name);
        Ok((g.pass_names().collect(), resources.chain(g.told_names().map(str::to_owned)).collect()))
    }

    /// Passes of a config's frame 0, in order, with the images and buffers that each writes.
    pub fn outputs(&mut self, config: &Config) -> Result<Vec<(&'static str, Vec<Output>)>> {
        self.ensure_for(config)?;
        let shot = self.shot(config, 0)?;
        let mut g = Graph::new();
        self.describe(&mut g, &shot, config);
        Ok(g.outputs())
    }

    /// Runs frame 0 with a triangle of every kind that the scene draws, so that no later frame is the first to use a pipeline. It cuts the
    /// sequence of [`Self::render`].
    pub fn warm_up(&mut self, config: &Config, execution: &Execution) -> Result<()> {
        self.ensure_for(config)?;
        let shot = self.shot(config, 0)?;
        self.world.set_time(&mut self.engine.gpu, shot.seconds, needs(config))?;
        let mut g = Graph::warming_up();
        self.describe(&mut g, &shot, config);
        self.batch.cut();
        self.engine.run(&mut self.batch.pool, &g, execution).map(|_| ())
    }

    fn describe(&self, g: &mut Graph, shot: &Shot, config: &Config) -> Frame {
        let _span = trace::span("describing");
        frame(g, &self.world, &self.residents, shot, config)
    }

    /// Renders frame `frame_index` of a config's sequence; its images are read back only if `pictured`. A frame that directly follows the
    /// frame before it of the same config continues its history. Any other frame starts anew, so that earlier renders do not change it.
    ///
    /// # Errors
    /// As [`Self::shoot`].
    pub fn render(&mut self, config: &Config, frame_index: u32, pictured: bool, execution: &Execution) -> Result<Rendered> {
        self.inspect(config, frame_index, Inspection::default(), pictured, execution)
    }

    /// Renders a frame as [`Self::render`] does, and answers questions about it. The picture is the same.
    ///
    /// # Errors
    /// As [`Self::shoot`].
    ///
    /// # Panics
    /// If a pixel is outside of the picture, or if the scene was brought without what its rays need.
    pub fn inspect(
        &mut self,
        config: &Config,
        frame_index: u32,
        inspection: Inspection,
        pictured: bool,
        execution: &Execution,
    ) -> Result<Rendered> {
        if let Some(pixel) = inspection.pixel {
            let size = config.frame.size;
            assert!(pixel[0] < size[0] && pixel[1] < size[1], "pixel {pixel:?} is outside of a picture of {size:?}");
            self.ensure(Needs { rays: true })?;
        }
        self.ensure_for(config)?;
        let shot = Shot { inspection, ..self.shot(config, frame_index)? };
        let mut lane = std::mem::take(&mut self.batch);
        let follows = lane.before().is_some_and(|before| before.index + 1 == frame_index);
        if !follows || self.batch_config.as_ref() != Some(config) {
            lane.cut();
            self.batch_config = Some(config.clone());
        }
        let rendered = self.shoot(&mut lane, shot, config, pictured, execution);
        self.batch = lane;
        rendered
    }

    /// Renders a shot as the next frame of a lane, even if the view, the lights or keys of the config have changed. Its images are read
    /// back only if `pictured`. [`Self::prepare`] was called for the config.
    ///
    /// # Errors
    /// The device's own, with the pass; the lane is cut then.
    pub fn shoot(&mut self, lane: &mut Lane, shot: Shot, config: &Config, pictured: bool, execution: &Execution) -> Result<Rendered> {
        self.world.set_time(&mut self.engine.gpu, shot.seconds, needs(config).and(Needs { rays: shot.inspection.pixel.is_some() }))?;
        if lane.before.take().is_none() {
            lane.pool.cut();
        }
        let mut g = Graph::new();
        let frame = self.describe(&mut g, &shot, config);
        let images = [
            frame.composed.image,
            frame.composed.radiance,
            frame.direct,
            frame.composed.indirect,
            frame.indirect.irradiance,
            frame.gbuffer.albedo,
            frame.gbuffer.normal,
            frame.gbuffer.depth,
        ];
        let read: Vec<ReadBack> = if pictured { images.iter().map(|image| g.read_back(*image)).collect() } else { Vec::new() };
        let wanted = Wanted::of(&mut g, &frame, shot.inspection);
        let outcome = self.engine.run(&mut lane.pool, &g, execution)?;
        let _span = pictured.then(|| trace::span("decoding the images"));
        let picture = match read.as_slice() {
            [image, planes @ ..] => {
                let plane = |(image, read): (&Image, &ReadBack)| Plane::decode(image.format, outcome.bytes(*read));
                let decoded: Vec<Plane> = images[1..].iter().zip(planes).map(plane).collect();
                let Ok([radiance, direct, indirect, irradiance, albedo, normal, depth]) = <[Plane; 7]>::try_from(decoded) else {
                    bail!("the frame's images did not all come back");
                };
                let image = outcome.bytes(*image).to_vec();
                let (size, view) = ([shot.view.width, shot.view.height], shot.view);
                Some(Picture { size, view, image, radiance, direct, indirect, irradiance, albedo, normal, depth })
            }
            [] => None,
        };
        let inspected = wanted.read(&outcome, &shot.view);
        lane.before = Some(shot);
        Ok(Rendered {
            times: outcome.times,
            counts: outcome.counts,
            memory: g.memory(),
            dumps: outcome.dumps,
            non_finite: outcome.non_finite,
            picture,
            inspected,
        })
    }
}

/// Timing mode of the config, or [`Timing::Serial`] on a device without timestamps.
pub fn timing(config: &Config, adapter: &Adapter) -> Timing {
    match config.frame.timing {
        _ if !adapter.has(Feature::Timestamps) => Timing::Serial,
        TimingMode::Isolated => Timing::Isolated,
        TimingMode::Overlapped => Timing::Overlapped,
        TimingMode::Serial => Timing::Serial,
    }
}
