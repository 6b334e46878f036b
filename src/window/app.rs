//! The window's events.

use super::mailbox::{Mailbox, Message};
use super::painter::Painter;
use super::panels::Panels;
use super::project::Project;
use crate::fail;
use crate::gpu::{DeviceChoice, Presented};
use anyhow::Result;
use egui::{ViewportId, ViewportInfo};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::{Window, WindowId};

/// Size of a new window, points.
const SIZE: [f64; 2] = [1480.0, 860.0];
/// Time until a picture that the display did not take is offered again.
const AGAIN: Duration = Duration::from_millis(50);

/// The application.
pub struct App {
    panels: Panels,
    mailbox: Arc<Mailbox>,
    device: Option<DeviceChoice>,
    validate: bool,
    egui: egui::Context,
    open: Option<Open>,
    /// Why the window was closed, if not by the user.
    error: Option<anyhow::Error>,
}

/// An open window.
struct Open {
    window: Arc<Window>,
    input: egui_winit::State,
    painter: Painter,
    info: ViewportInfo,
    /// When the window is drawn again without an event.
    redraw_at: Option<Instant>,
    waits_for_display: bool,
}

impl App {
    pub fn new(project: Project, mailbox: Arc<Mailbox>, device: Option<DeviceChoice>, validate: bool) -> Self {
        let panels = Panels::new(project);
        Self { panels, mailbox, device, validate, egui: egui::Context::default(), open: None, error: None }
    }

    /// Result of the window, once it is closed.
    pub fn ended(&mut self) -> Result<()> {
        let messages = self.open.take().map(|open| open.painter.validation_messages()).unwrap_or_default();
        match (self.error.take(), messages.first()) {
            (Some(error), _) => Err(error),
            (None, Some(first)) => {
                Err(fail!(ComparisonFailed, "the validation layer has {} messages about the window, the first: {first}", messages.len()))
            }
            (None, None) => Ok(()),
        }
    }

    fn open(&self, events: &ActiveEventLoop) -> Result<Open> {
        let attributes = Window::default_attributes().with_title("manylight").with_inner_size(LogicalSize::new(SIZE[0], SIZE[1]));
        let window = events.create_window(attributes).map_err(|error| fail!(NoDevice, "no window can be opened: {error}"))?;
        let window = Arc::new(window);
        let painter = Painter::open(window.clone(), self.device.as_ref(), self.validate)?;
        let (scale, theme) = (Some(window.scale_factor() as f32), window.theme());
        let largest = Some(painter.largest_texture());
        let input = egui_winit::State::new(self.egui.clone(), ViewportId::ROOT, &window, scale, theme, largest);
        window.request_redraw();
        Ok(Open { window, input, painter, info: ViewportInfo::default(), redraw_at: None, waits_for_display: true })
    }

    fn draw(&mut self) -> Result<()> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if self.panels.waits_for_display() != open.waits_for_display {
            open.waits_for_display = self.panels.waits_for_display();
            let size = open.window.inner_size();
            open.painter.resize([size.width, size.height], open.waits_for_display);
        }
        egui_winit::update_viewport_info(&mut open.info, &self.egui, &open.window, false);
        let mut input = open.input.take_egui_input(&open.window);
        input.viewports.insert(ViewportId::ROOT, open.info.clone());
        let output = self.egui.run_ui(input, |ui| self.panels.show(ui));
        if let Some(request) = self.panels.request() {
            self.mailbox.put(request);
        }
        open.input.handle_platform_output(&open.window, output.platform_output);
        let triangles = self.egui.tessellate(output.shapes, output.pixels_per_point);
        let size = open.window.inner_size();
        let shown = open.painter.paint(&triangles, output.textures_delta, output.pixels_per_point, [size.width, size.height])?;
        let delay = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        let delay = if shown == Presented::No && size.width > 0 && size.height > 0 { delay.min(AGAIN) } else { delay };
        open.redraw_at = Instant::now().checked_add(delay);
        if delay.is_zero() {
            open.window.request_redraw();
        }
        Ok(())
    }
}

impl ApplicationHandler<Message> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open(events) {
            Ok(open) => self.open = Some(open),
            Err(error) => {
                self.error = Some(error);
                events.exit();
            }
        }
    }

    fn user_event(&mut self, _events: &ActiveEventLoop, message: Message) {
        self.panels.take(message, &self.egui);
        if let Some(open) = &self.open {
            open.window.set_title(&self.panels.title());
            open.window.request_redraw();
        }
    }

    fn new_events(&mut self, _events: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &mut self.open) {
            open.redraw_at = None;
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _id: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.input.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(size) => {
                open.painter.resize([size.width, size.height], open.waits_for_display);
                open.window.request_redraw();
            }
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.draw() {
                    self.error = Some(error);
                    events.exit();
                }
            }
            _ if response.repaint => open.window.request_redraw(),
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let at = self.open.as_ref().and_then(|open| open.redraw_at);
        events.set_control_flow(at.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
