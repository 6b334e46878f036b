//! `manylight view CONFIG`: a window on the frames that `render` makes.

use super::measure::{check_validation, write_picture};
use super::progress::Progress;
use super::setup::{On, Setup, execution, open};
use crate::cli::ViewArgs;
use crate::config::{Config, SceneConfig};
use crate::error::{Exit, exit_code};
use crate::fail;
use crate::files::prepare_folder;
use crate::gpu::DeviceChoice;
use crate::graph::{self, DumpData, Output, Reuse};
use crate::reference::{Settings, Sum, Sums, Tracer, develop};
use crate::renderer::{Lane, Renderer};
use crate::scene::Scene;
use crate::window::{self, Against, Mailbox, Message, Other, Project, Request, Shown, Taken, Truth};
use crate::world::{Inspection, Needs};
use anyhow::Result;
use glam::Vec3;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// Opens the window, and renders on a thread of its own what it requests for.
pub fn run(args: &ViewArgs) -> Result<()> {
    let project = Project::new(&args.config, args.overrides());
    // A config that cannot be read ends the program before a window opens.
    let setup = Setup::load(&project.config, &project.overrides())?;
    let progress = Progress::new(false);
    setup.warnings.iter().for_each(|warning| progress.warn(warning));
    let (device, validate) = (args.device.clone(), args.validate);
    let start = |mailbox: Arc<Mailbox>, tell: window::Tell| {
        let mut render_thread = RenderThread { device, validate, mailbox, tell, stage: None, last: None, failed: String::new() };
        thread::Builder::new()
            .name("rendering".to_owned())
            .spawn(move || render_thread.work())
            .map_err(|error| fail!(OutOfMemory, "a thread: {error}"))
    };
    let render_thread = window::open(project, args.device.as_ref(), args.validate, start)?;
    match render_thread.join() {
        Ok(ended) => ended,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// The thread that renders.
struct RenderThread {
    device: Option<DeviceChoice>,
    validate: bool,
    mailbox: Arc<Mailbox>,
    tell: window::Tell,
    stage: Option<Stage>,
    last: Option<Request>,
    /// What was wrong with a file when it was looked at last.
    failed: String,
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        if thread::panicking() {
            (self.tell)(Message::Ended("rendering has ended by a bug of this program; the terminal says more".to_owned()));
        }
    }
}

/// Time between looks at the files.
const WATCH: Duration = Duration::from_millis(300);
/// Time between pictures of the path tracer.
const TELL: Duration = Duration::from_millis(500);
/// Paths a pixel after which the path tracer rests.
const MOST_PATHS: u32 = 65_536;

/// A scene on the device, and the config whose pipelines are made.
struct Stage {
    scene: SceneConfig,
    renderer: Renderer,
    warnings: Vec<String>,
    prepared: Option<Config>,
    /// The config of the last frame, as its files have it.
    config: Option<Config>,
    /// Changes with the prepared config.
    number: u64,
    /// Passes of the prepared config, with the images and buffers that each writes.
    outputs: Vec<(&'static str, Vec<Output>)>,
    /// Frames of the project that the picture is compared with, and its prepared config.
    other: (Lane, Option<Config>),
    tracing: Option<Tracing>,
}

/// The path tracer at work.
struct Tracing {
    tracer: Tracer,
    config: Config,
    settings: Settings,
    /// Number of the request that it is for.
    number: u64,
    /// The pixel that is asked about.
    asked: Option<[u32; 2]>,
    told: Option<Instant>,
}

impl Stage {
    /// Renders another project's picture of a request's frame.
    fn other(&mut self, project: &Project, request: &Request) -> Result<Other> {
        let mut whole = Setup::load(&project.config, &project.overrides())?.config;
        // A preset may split edges, which changes no surface; the triangles that are there serve both.
        whole.scene.split = self.scene.split;
        let config = scaled(&whole, request.scale);
        if config.scene != self.scene {
            return Err(fail!(BadInput, "{} has another scene, and is not compared", project.config.display()));
        }
        self.renderer.check(&config)?;
        let still = still(&whole);
        let (lane, prepared) = &mut self.other;
        if prepared.as_ref() != Some(&still) {
            self.renderer.prepare(&config, &[])?;
            *prepared = Some(still);
        }
        lane.cut();
        let shot = self.renderer.shot(&config, request.frame)?;
        let mut execution = execution(&config, &self.renderer);
        execution.dump = vec![window::PICTURE.0.to_owned()];
        let rendered = self.renderer.shoot(lane, shot, &config, false, &execution)?;
        let image = rendered.dumps.into_iter().find(|dump| dump.resource == window::PICTURE.1).map(|dump| dump.data);
        let Some(DumpData::Image { size, texels, .. }) = image else { unreachable!("a frame has a picture") };
        Ok(Other { name: project.config.display().to_string(), size, image: texels })
    }

    /// Begins to trace paths for a frame, unless it is the one that is traced already.
    fn follow(&mut self, config: &Config, request: &Request, bounces: u32) -> Result<()> {
        let settings = Settings { bounces, frame_index: request.frame, min_distance: 0.0, centered: false };
        let (number, asked) = (request.number, request.inspection.pixel);
        // Methods make no difference to the truth.
        let Config { scene, camera, light, frame, materials, sky, compose, .. } = config.clone();
        let truth = Config { scene, camera, light, frame, materials, sky, compose, ..Config::default() };
        if let Some(tracing) = &mut self.tracing
            && (&tracing.config, tracing.settings) == (&truth, settings)
        {
            (tracing.number, tracing.asked, tracing.told) = (number, asked, None);
            return Ok(());
        }
        self.stop_tracing();
        self.renderer.ensure(Needs { rays: true })?;
        let mut tracer = Tracer::new(&mut self.renderer, &truth, settings, None)?;
        tracer.prepare(&mut self.renderer)?;
        self.tracing = Some(Tracing { tracer, config: truth, settings, number, asked, told: None });
        Ok(())
    }

    fn stop_tracing(&mut self) {
        if let Some(tracing) = self.tracing.take() {
            tracing.tracer.free(&mut self.renderer);
        }
    }
}

/// What the reference has at a pixel.
fn truth_at(sums: &Sums, pixel: [u32; 2]) -> Truth {
    let at = pixel[1] as usize * sums.size[0] as usize + pixel[0] as usize;
    let color = |layer: Sum| {
        let [r, g, b, _] = sums.mean_at(layer, at);
        Vec3::new(r, g, b)
    };
    Truth {
        pixel,
        samples: sums.samples,
        radiance: color(Sum::Radiance),
        error: Vec3::from(sums.variance_at(at)).map(f32::sqrt),
        direct: color(Sum::Direct),
        bounces: (1..=sums.bounces).map(|bounce| color(Sum::Bounce(bounce))).collect(),
        irradiance: color(Sum::Irradiance),
    }
}

/// The last frame of a sequence: of the config, of its keyframes, or of the scene's animation.
fn last_frame(config: &Config, scene: &Scene) -> u32 {
    let of_camera = config.camera.iter().flat_map(|camera| &camera.keyframes).map(|key| key.time);
    let of_lights = config.light.iter().flat_map(|light| light.keyframes()).map(|key| key.time);
    let of_scene = scene.animation.iter().map(|animation| animation.duration as f32);
    let seconds = of_camera.chain(of_lights).chain(of_scene).fold(0.0, f32::max);
    ((seconds * config.frame.fps).ceil() as u32).max(config.frame.count.max(1) - 1)
}

/// A config with a share of its picture's sides.
fn scaled(config: &Config, scale: f32) -> Config {
    let mut config = config.clone();
    config.frame.size = config.frame.size.map(|side| ((side as f32 * scale).round() as u32).max(1));
    config
}

/// A config without its camera. The passes of a frame are the same wherever that is, and however large its picture: a pipeline that is not
/// is made when it is used.
fn still(config: &Config) -> Config {
    Config { camera: None, ..config.clone() }
}

impl RenderThread {
    /// Renders until the window closes.
    fn work(&mut self) -> Result<()> {
        let mailbox = self.mailbox.clone();
        loop {
            // Paths are traced as long as nothing else is wanted.
            let patience = if self.stage.as_ref().is_some_and(|stage| stage.tracing.is_some()) { Duration::ZERO } else { WATCH };
            let request = match mailbox.take(patience) {
                Taken::Request(request) => Some(*request),
                Taken::Nothing => self.changed_files(),
                Taken::Closed => break,
            };
            let Some(request) = request else {
                self.trace()?;
                continue;
            };
            self.last = Some(Request { save: None, depth: false, ..request.clone() });
            match self.fulfil(request) {
                Ok(shown) => (self.tell)(Message::Frame(Box::new(shown))),
                Err(error) if exit_code(&error) == Exit::DeviceLost => {
                    (self.tell)(Message::Ended(format!("{error:#}")));
                    return Err(error);
                }
                Err(error) => {
                    self.failed = format!("{error:#}");
                    (self.tell)(Message::Failed(self.failed.clone()));
                }
            }
        }
        self.stage.as_ref().map_or(Ok(()), |stage| check_validation(&stage.renderer))
    }

    /// Traces another path through every pixel, if the window wants the reference, and shows the picture so far now and then.
    fn trace(&mut self) -> Result<()> {
        let Some(stage) = &mut self.stage else { return Ok(()) };
        let Some(tracing) = &mut stage.tracing else { return Ok(()) };
        let execution = execution(&tracing.config, &stage.renderer);
        let traced = if tracing.tracer.samples() < MOST_PATHS {
            tracing.tracer.sample(&mut stage.renderer, &execution).map(|_| ())
        } else {
            std::thread::sleep(WATCH);
            Ok(())
        };
        let told = tracing.told.is_some_and(|at| at.elapsed() < TELL);
        let sums = match traced {
            Ok(()) if told => return Ok(()),
            Ok(()) => tracing.tracer.sums(&mut stage.renderer),
            Err(error) => Err(error),
        };
        match sums {
            Ok(sums) => {
                tracing.told = Some(Instant::now());
                let name = format!("path tracer, {} paths a pixel", sums.samples);
                let other = Other { name, size: sums.size, image: develop(&sums, &tracing.config.compose) };
                let truth = tracing.asked.map(|pixel| truth_at(&sums, pixel));
                (self.tell)(Message::Reference(tracing.number, other, truth));
                Ok(())
            }
            Err(error) if exit_code(&error) == Exit::DeviceLost => {
                (self.tell)(Message::Ended(format!("{error:#}")));
                Err(error)
            }
            Err(error) => {
                stage.stop_tracing();
                (self.tell)(Message::Failed(format!("{error:#}")));
                Ok(())
            }
        }
    }

    /// The last request again, if the config's files or the shaders have changed since. A shader that does not compile is told of, and the
    /// one before stays.
    fn changed_files(&mut self) -> Option<Request> {
        let last = self.last.clone()?;
        let stage = self.stage.as_mut()?;
        let again = if std::env::var_os(graph::SHADERS).is_some() { stage.renderer.reload(stage.config.as_ref()?) } else { Ok(false) };
        let again = again.and_then(|shaders| {
            // Results of other shaders are not taken over.
            stage.number += u64::from(shaders);
            let config = Setup::load(&last.project.config, &last.project.overrides())?.config;
            Ok(shaders || stage.config.as_ref() != Some(&config))
        });
        match again {
            Ok(again) => {
                self.failed.clear();
                again.then_some(last)
            }
            Err(error) => {
                let error = format!("{error:#}");
                if self.failed != error {
                    self.failed.clone_from(&error);
                    (self.tell)(Message::Failed(error));
                }
                None
            }
        }
    }

    fn fulfil(&mut self, request: Request) -> Result<Shown> {
        let started = Instant::now();
        let setup = Setup::load(&request.project.config, &request.project.overrides())?;
        let config = scaled(&setup.config, request.scale);
        if self.stage.as_ref().is_none_or(|stage| stage.scene != config.scene) {
            (self.tell)(Message::Doing("loading the scene"));
            // Two large scenes may not fit.
            self.stage = None;
            let opened = open(&config, On { device: self.device.as_ref(), validate: self.validate })?;
            let warnings = opened.warnings.clone();
            (self.tell)(Message::Doing("bringing the scene to the device"));
            // Any method may be chosen later.
            let renderer = opened.bring(Needs { rays: true })?;
            self.stage = Some(Stage {
                scene: config.scene.clone(),
                renderer,
                warnings,
                prepared: None,
                config: None,
                number: 0,
                outputs: Vec::new(),
                other: (Lane::new(), None),
                tracing: None,
            });
        }
        let Some(stage) = &mut self.stage else { unreachable!("the stage was just set up") };
        stage.config = Some(setup.config.clone());
        stage.renderer.check(&config)?;
        let still = still(&setup.config);
        if stage.prepared.as_ref() != Some(&still) {
            (self.tell)(Message::Doing("preparing the shaders"));
            (stage.prepared, stage.number) = (None, stage.number + 1);
            stage.renderer.prepare(&config, &[])?;
            stage.outputs = stage.renderer.outputs(&config)?;
            stage.prepared = Some(still);
        }
        let pass = match stage.outputs.iter().any(|(pass, _)| *pass == request.pass) {
            true => request.pass,
            false => window::PICTURE.0,
        };
        let mut execution = execution(&config, &stage.renderer);
        // A whole frame runs every pass, so that every time is there; one of a moving camera takes over what does not hang on it.
        let number = stage.number.wrapping_mul(1 << 20).wrapping_add(u64::from(request.frame));
        execution.reuse = if request.moving { Reuse::Apply(number) } else { Reuse::Remember(number) };
        execution.dump = [Some(pass), request.depth.then_some(window::DEPTH.0)].into_iter().flatten().map(str::to_owned).collect();
        let pictured = request.save.is_some();
        let inside = |pixel: &[u32; 2]| pixel[0] < config.frame.size[0] && pixel[1] < config.frame.size[1];
        let inspection = Inspection { pixel: request.inspection.pixel.filter(inside), ..request.inspection };
        let rendered = stage.renderer.inspect(&config, request.frame, inspection, pictured, &execution)?;
        let other = match &request.against {
            Against::Nothing => None,
            Against::Project(project) => match stage.other(project, &request) {
                Err(error) if exit_code(&error) == Exit::DeviceLost => return Err(error),
                other => Some(other.map_err(|error| format!("{error:#}"))),
            },
            Against::Reference { .. } if request.moving => {
                stage.stop_tracing();
                None
            }
            Against::Reference { bounces } => {
                stage.follow(&config, &request, *bounces)?;
                None
            }
        };
        if !matches!(request.against, Against::Reference { .. }) {
            stage.stop_tracing();
        }
        if let (Some(folder), Some(picture)) = (&request.save, &rendered.picture) {
            prepare_folder(folder)?;
            let from = setup.provenance(&stage.renderer);
            write_picture(&folder.join("image.exr"), &folder.join("image.png"), picture, &config, &from)?;
            (self.tell)(Message::Saved(folder.clone()));
        }
        let from = setup.provenance(&stage.renderer);
        let warnings = [setup.warnings, stage.warnings.clone(), stage.renderer.warnings(&config), rendered.warnings()].concat();
        Ok(Shown {
            camera: stage.renderer.camera(&config, request.frame)?,
            view: stage.renderer.view(&config, request.frame)?,
            bounds: stage.renderer.world().device().bounds,
            last_frame: last_frame(&config, stage.renderer.world().scene()),
            request,
            config,
            times: rendered.times,
            frame_ms: started.elapsed().as_secs_f64() * 1e3,
            counts: rendered.counts,
            memory: rendered.memory,
            dumps: rendered.dumps,
            inspected: rendered.inspected,
            other,
            outputs: stage.outputs.clone(),
            warnings,
            device: format!("{}, {} {}, {}", from.device.name, from.device.driver, from.device.driver_version, from.timing_mode),
        })
    }
}
