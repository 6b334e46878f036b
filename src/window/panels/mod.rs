//! The panels around the picture, and what they are set to.

mod compare;
mod handles;
mod keys;
mod light;
mod passes;
mod picture;
mod status;
#[cfg(test)]
mod tests;
mod times;
mod top;
mod vpls;

use self::compare::Compare;
use self::light::Question;
use self::vpls::Overlay;
use super::flight::Flight;
use super::look::{Look, Texels};
use super::mailbox::{Against, Message, Request, Shown};
use super::pace::Pace;
use super::project::Project;
use super::recording::{self, Key, Recording};
use super::{DEPTH, PICTURE};
use crate::world::Inspection;
use egui::{Context, TextureHandle, TextureOptions, Ui};
use glam::Vec3;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Frames whose times are kept.
const FRAMES: usize = 200;
/// Share of the scene's diagonal by which a recorded flight may miss the one that was flown.
const TOLERANCE: f32 = 5e-4;
/// Time after the last move until the frame is whole again.
const REST: Duration = Duration::from_millis(150);

/// Panel on the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tab {
    Passes,
    Compare,
    Light,
    Times,
    Warnings,
}

/// All settings of the window.
pub struct Panels {
    project: Project,
    frame: u32,
    is_playing: bool,
    pass: &'static str,
    /// Image of the pass that is shown.
    image: String,
    look: Look,
    fits: bool,
    smooth: bool,
    tab: Tab,
    search: String,
    waits_for_display: bool,

    flight: Option<Flight>,
    moved: Option<Instant>,
    pace: Pace,
    /// Place in the picture whose depth was asked for, to be orbited.
    aim: Option<[u32; 2]>,
    /// Texel under the cursor.
    under_cursor: Option<[u32; 2]>,

    shown: Option<Box<Shown>>,
    texture: Option<TextureHandle>,
    /// Range that the texture shows.
    range: [f32; 2],
    is_stale: bool,
    times: VecDeque<Vec<(&'static str, f64)>>,

    compare: Compare,
    has_handles: bool,
    /// A flight in the making, and when it began.
    recording: Option<(Recording, Instant)>,
    /// The last flight that was recorded.
    recorded: Vec<Key>,
    question: Question,
    overlay: Overlay,
    doing: Option<(&'static str, Instant)>,
    failed: Option<String>,
    said: Option<String>,
    has_ended: bool,
    save: Option<std::path::PathBuf>,
    asked: Option<Request>,
    number: u64,
}

impl Panels {
    pub fn new(project: Project) -> Self {
        Self {
            project,
            frame: 0,
            is_playing: false,
            pass: PICTURE.0,
            image: PICTURE.1.to_owned(),
            look: Look::default(),
            fits: true,
            smooth: false,
            tab: Tab::Passes,
            search: String::new(),
            waits_for_display: true,
            flight: None,
            moved: None,
            pace: Pace::default(),
            aim: None,
            under_cursor: None,
            shown: None,
            texture: None,
            range: [0.0, 1.0],
            is_stale: false,
            times: VecDeque::new(),
            compare: Compare::default(),
            has_handles: false,
            recording: None,
            recorded: Vec::new(),
            question: Question::default(),
            overlay: Overlay::default(),
            doing: None,
            failed: None,
            said: None,
            has_ended: false,
            save: None,
            asked: None,
            number: 0,
        }
    }

    /// Whether pictures wait for the display's refresh.
    pub fn waits_for_display(&self) -> bool {
        self.waits_for_display
    }

    /// Title of the window: what the last frame shows.
    pub fn title(&self) -> String {
        match &self.shown {
            Some(shown) => format!("{} - manylight", shown.request.project.config.display()),
            None => "manylight".to_owned(),
        }
    }

    /// Takes over a message.
    pub fn take(&mut self, message: Message, context: &Context) {
        match message {
            Message::Doing(what) => self.doing = Some((what, Instant::now())),
            Message::Saved(folder) => self.said = Some(format!("written: {}", folder.join("image.png").display())),
            Message::Failed(why) => {
                (self.doing, self.failed, self.is_playing) = (None, Some(why), false);
            }
            Message::Ended(why) => {
                // What was made here is not lost with the device.
                self.save_config();
                let saved = self.said.take().map_or_else(String::new, |said| format!(" ({said})"));
                (self.doing, self.failed, self.has_ended, self.is_playing) = (None, Some(format!("{why}{saved}")), true, false);
            }
            Message::Reference(number, other, truth) => {
                if self.asked.as_ref().is_some_and(|asked| asked.number == number) {
                    self.compare.take(other, context);
                    self.question.take(truth);
                }
            }
            Message::Frame(shown) => self.take_frame(shown, context),
        }
    }

    fn take_frame(&mut self, mut shown: Box<Shown>, context: &Context) {
        (self.doing, self.failed) = (None, None);
        self.times.push_back(shown.times.clone());
        if self.times.len() > FRAMES {
            self.times.pop_front();
        }
        // Times of the passes, and not of what a first frame waits for.
        self.pace.measured(shown.request.scale, shown.request.moving, shown.times.iter().map(|(_, ms)| ms).sum());
        if let Some(place) = self.aim.filter(|_| shown.request.depth) {
            self.aim = None;
            if let (Some(target), Some(flight)) = (surface_at(&shown, place), &mut self.flight) {
                flight.aim(target);
            }
        }
        // A frame of an older request would take the camera back.
        if !self.is_moving() && shown.request.project == self.project {
            self.flight = Some(match self.flight.take() {
                Some(old) => Flight { speed: old.speed, ..Flight::from(&shown.camera, shown.bounds) },
                None => Flight::from(&shown.camera, shown.bounds),
            });
        }
        if shown.outputs.iter().all(|(pass, _)| *pass != self.pass) {
            (self.pass, self.image, self.look) = (PICTURE.0, PICTURE.1.to_owned(), Look::default());
        }
        if self.is_playing {
            self.frame = (self.frame + 1) % (shown.last_frame + 1);
        }
        match shown.other.take() {
            Some(Ok(other)) => self.compare.take(other, context),
            Some(Err(why)) => self.failed = Some(why),
            None => {}
        }
        self.overlay.take(&mut shown);
        // What the reference had of another picture says nothing of this one.
        let before = self.shown.as_ref().map(|shown| (&shown.request.project, shown.request.frame));
        let traced = matches!(shown.request.against, Against::Reference { .. });
        if !traced || before != Some((&shown.request.project, shown.request.frame)) {
            self.question.take(None);
        }
        self.compare.shown();
        (self.shown, self.is_stale) = (Some(shown), true);
        context.request_repaint();
    }

    /// Whether the camera moves, so that a frame may be smaller than the config's.
    fn is_moving(&self) -> bool {
        self.moved.is_some_and(|at| at.elapsed() < REST)
    }

    /// All panels.
    pub fn show(&mut self, ui: &mut Ui) {
        self.measure(ui.ctx());
        egui::Panel::top("top").show(ui, |ui| self.top(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        egui::Panel::left("keys").default_size(370.0).size_range(260.0..=600.0).show(ui, |ui| self.keys(ui));
        egui::Panel::right("passes").default_size(400.0).size_range(240.0..=600.0).show(ui, |ui| {
            ui.horizontal(|ui| {
                let count = self.shown.as_ref().map_or(0, |shown| shown.warnings.len());
                let warnings = if count == 0 { "Warnings".to_owned() } else { format!("Warnings ({count})") };
                ui.selectable_value(&mut self.tab, Tab::Passes, "Passes");
                ui.selectable_value(&mut self.tab, Tab::Compare, "Compare");
                ui.selectable_value(&mut self.tab, Tab::Light, "Light").on_hover_text("Why is this pixel lit?");
                ui.selectable_value(&mut self.tab, Tab::Times, "Times");
                ui.selectable_value(&mut self.tab, Tab::Warnings, warnings);
            });
            ui.separator();
            match self.tab {
                Tab::Passes => self.passes(ui),
                Tab::Compare => self.compare(ui),
                Tab::Light => self.light(ui),
                Tab::Times => self.times(ui),
                Tab::Warnings => self.warnings(ui),
            }
        });
        egui::CentralPanel::default().frame(egui::Frame::NONE.fill(ui.visuals().extreme_bg_color)).show(ui, |ui| self.picture(ui));
        if let (Some((recording, began)), Some(flight)) = (&mut self.recording, &self.flight) {
            recording.record(began.elapsed().as_secs_f32(), flight);
        }
        if let Some(at) = self.moved {
            match REST.checked_sub(at.elapsed()) {
                Some(rest) => ui.ctx().request_repaint_after(rest),
                None => self.moved = None,
            }
        }
    }

    /// The frame that is wanted now, if it is another than the last one.
    pub fn request(&mut self) -> Option<Request> {
        if self.has_ended {
            return None;
        }
        let save = self.save.take();
        if save.is_some() {
            // After the input of this picture, so that the config is the picture's.
            self.save_config();
        }
        // What is saved is whole.
        let moving = self.is_moving() && save.is_none();
        let request = Request {
            number: self.number,
            project: self.project.clone(),
            frame: self.frame,
            pass: self.pass,
            scale: if moving { self.pace.scale() } else { 1.0 },
            moving,
            depth: self.aim.is_some() || (self.overlay.shows && !moving),
            inspection: Inspection { pixel: self.asked_pixel().filter(|_| !moving), vpls: self.overlay.shows && !moving },
            against: self.compare.against(self),
            save,
        };
        if self.asked.as_ref().is_some_and(|asked| *asked == request) {
            return None;
        }
        self.number += 1;
        let request = Request { number: self.number, ..request };
        self.asked = Some(Request { save: None, ..request.clone() });
        Some(request)
    }

    /// Hands the camera of the flight to the config.
    fn move_camera(&mut self) {
        let Some(flight) = &self.flight else { return };
        let vector = |v: Vec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
        // A recorded flight is kept, and left.
        self.project.reset("camera.keyframes");
        self.project.set("camera.position", vector(flight.position));
        self.project.set("camera.target", vector(flight.target));
        self.project.set("camera.up", vector(flight.up));
        self.project.set("camera.fov_y_deg", format!("{:?}", flight.fov_y_deg));
        self.moved = Some(Instant::now());
    }

    /// Begins to record the camera's flight, or ends it and shows it.
    fn toggle_recording(&mut self) {
        let Some((recording, _)) = self.recording.take() else {
            self.recording = Some((Recording::default(), Instant::now()));
            return;
        };
        let diagonal = self.shown.as_ref().map_or(1.0, |shown| shown.bounds.size().length());
        match recording.finish(TOLERANCE * diagonal) {
            None => self.failed = Some("no flight was recorded: the camera did not move".to_owned()),
            Some(keys) => {
                self.recorded = keys;
                self.show_flight();
            }
        }
    }

    /// Makes the recorded flight the camera's path.
    fn show_flight(&mut self) {
        let (Some(last), Some(shown)) = (self.recorded.last(), &self.shown) else { return };
        let frames = (last.time * shown.config.frame.fps).ceil() as u32 + 1;
        ["camera.position", "camera.target"].iter().for_each(|key| self.project.reset(key));
        self.project.set("camera.keyframes", recording::toml(&self.recorded));
        self.project.set("frame.count", frames.to_string());
        self.said = Some(format!("a flight of {:.1} s in {} keyframes, {frames} frames", last.time, self.recorded.len()));
        (self.flight, self.moved, self.frame) = (None, None, 0);
    }

    /// The image that is shown, of the last frame.
    fn texels(&self) -> Option<Texels<'_>> {
        let dumps = &self.shown.as_ref()?.dumps;
        let of_pass = || dumps.iter().filter(|dump| dump.pass == self.pass);
        let dump =
            of_pass().find(|dump| dump.resource == self.image).or_else(|| of_pass().find(|dump| Texels::of(&dump.data).is_some()))?;
        Texels::of(&dump.data)
    }

    /// Makes the texture of the image anew if the image or its look has changed.
    fn bring_texture(&mut self, context: &Context) {
        if !std::mem::take(&mut self.is_stale) {
            return;
        }
        let Some(texels) = self.texels() else { return };
        let (picture, range) = texels.picture(&self.look);
        let options = if self.smooth { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        self.range = range;
        match &mut self.texture {
            Some(texture) => texture.set(picture, options),
            None => self.texture = Some(context.load_texture("picture", picture, options)),
        }
    }
}

/// World position of the surface at a place of the picture.
fn surface_at(shown: &Shown, [x, y]: [u32; 2]) -> Option<Vec3> {
    let dump = shown.dumps.iter().find(|dump| (dump.pass, dump.resource.as_str()) == DEPTH)?;
    let depth = Texels::of(&dump.data)?.at(x, y, 0)?[0];
    (depth > 0.0).then(|| shown.view.position_at(x, y, depth))
}
