//! The panels without a window: widgets are clicked by their labels, and requests are read.

use super::*;
use crate::gpu::Format;
use crate::graph::{Dump, DumpData, Output};
use crate::inspection::Inspected;
use crate::presets;
use crate::scene::{Aabb, Camera};
use crate::window::mailbox::Against;
use crate::world::projection::View;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::Path;

/// A frame that a request could have.
fn shown(request: Request) -> Box<Shown> {
    let preset = presets::find(request.project.config.to_str().unwrap()).unwrap();
    let config = crate::config::parse_preset(preset, Path::new("preset.toml"), &request.project.overrides()).unwrap().config;
    let camera = Camera { name: String::new(), position: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 50.0 };
    let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let image = |name: &str| Output { name: name.to_owned(), is_image: true };
    let areas: Vec<u8> = [0.25_f32, 1.5].iter().flat_map(|area| area.to_ne_bytes()).collect();
    let areas = DumpData::Buffer { element: "float", members: &[], element_bytes: 4, bytes: areas };
    let data = DumpData::Image { format: Format::Rgba8Unorm, size: [2, 1], layers: 1, texels: vec![255, 0, 0, 255, 0, 255, 0, 255] };
    Box::new(Shown {
        view: View::new(&camera, [2, 1], bounds),
        camera,
        bounds,
        last_frame: config.frame.count - 1,
        config,
        times: vec![("gbuffer/draw", 1.0), ("compose/sum", 2.0)],
        frame_ms: 4.0,
        counts: vec![("vpls/lit".to_owned(), 7)],
        memory: vec![("gbuffer/depth".to_owned(), 64)],
        dumps: vec![
            Dump { pass: PICTURE.0, resource: PICTURE.1.to_owned(), data },
            Dump { pass: "vpls/regular", resource: "vpls/areas".to_owned(), data: areas },
        ],
        inspected: Inspected::default(),
        other: None,
        outputs: vec![
            (DEPTH.0, vec![image(DEPTH.1)]),
            ("vpls/regular", vec![Output { name: "vpls/areas".to_owned(), is_image: false }]),
            (PICTURE.0, vec![image(PICTURE.1)]),
        ],
        warnings: vec!["something is not used".to_owned()],
        device: "a device".to_owned(),
        request,
    })
}

/// A window's panels, and the requests that they make. A frame comes for every request.
struct User(Harness<'static, (Panels, Vec<Request>)>);

impl User {
    fn of(preset: &str) -> Self {
        let panels = Panels::new(Project::new(Path::new(preset), Vec::new()));
        let show = |ui: &mut Ui, (panels, requests): &mut (Panels, Vec<Request>)| {
            panels.show(ui);
            if let Some(request) = panels.request() {
                panels.take(Message::Frame(shown(request.clone())), ui.ctx());
                requests.push(request);
            }
        };
        let harness = Harness::builder().with_size([1400.0, 3000.0]).build_ui_state(show, (panels, Vec::new()));
        let mut user = Self(harness);
        user.0.run_steps(6);
        user
    }

    fn click(&mut self, label: &str) -> &mut Self {
        self.0.get_by_label(label).click();
        self.0.run_steps(6);
        self
    }

    /// The last request.
    fn request(&self) -> &Request {
        self.0.state().1.last().unwrap()
    }

    fn changes(&self) -> Vec<String> {
        self.request().project.overrides()
    }
}

#[test]
fn a_change_by_a_widget_is_a_set_and_can_be_taken_back() {
    let mut user = User::of("linke");
    assert_eq!(user.changes(), [""; 0]);
    user.click("ism.distortion");
    assert_eq!(user.changes(), ["visibility.ism.distortion=false"]);
    user.click("reset");
    assert_eq!(user.changes(), [""; 0]);
}

#[test]
fn a_name_is_chosen_from_a_list() {
    let mut user = User::of("linke");
    user.click("sampler").click("hammersley");
    assert_eq!(user.changes(), ["vpls.sampler=\"hammersley\""]);
}

#[test]
fn another_preset_keeps_the_scene_and_its_camera() {
    let mut user = User::of("street");
    let street = user.0.state().0.shown.as_ref().unwrap().config.clone();
    user.click("preset").click("ssvp");
    let config = &user.0.state().0.shown.as_ref().unwrap().config;
    assert_eq!((&config.scene.builtin, &config.camera, &config.light), (&street.scene.builtin, &street.camera, &street.light));
    assert_ne!(config.bounce.count, street.bounce.count);
}

#[test]
fn a_pass_is_shown_until_the_method_that_has_it_is_gone() {
    let mut user = User::of("linke");
    user.click("gbuffer/depth");
    assert_eq!(user.request().pass, DEPTH.0);
    user.click("Back to the picture");
    assert_eq!(user.request().pass, PICTURE.0);
}

#[test]
fn a_buffer_is_a_table_of_its_numbers() {
    let mut user = User::of("linke");
    user.click("vpls/areas");
    assert_eq!(user.request().pass, "vpls/regular");
    user.0.get_by_label_contains("vpls/areas: 2 elements");
    user.0.get_by_label_contains("1.50000");
}

#[test]
fn a_flight_is_recorded_as_keyframes_that_can_be_flown_again() {
    let mut user = User::of("linke");
    user.click("Record");
    user.0.key_down(egui::Key::W);
    user.0.run_steps(20);
    user.0.key_up(egui::Key::W);
    user.0.run_steps(2);
    user.click("Stop");
    let keyframes = |user: &User| user.changes().into_iter().find(|change| change.starts_with("camera.keyframes=[{ time = 0.0"));
    let flown = keyframes(&user).unwrap();
    assert!(user.0.state().0.shown.as_ref().unwrap().config.camera.as_ref().unwrap().keyframes.len() > 1, "{flown}");
    // Another movement leaves the flight, which is kept.
    user.0.key_down(egui::Key::D);
    user.0.run_steps(4);
    user.0.key_up(egui::Key::D);
    user.0.run_steps(2);
    assert_eq!(keyframes(&user), None);
    user.click("Fly it again");
    assert_eq!(keyframes(&user), Some(flown));
}

#[test]
fn a_light_is_dragged_by_its_handle() {
    let mut user = User::of("street-evening");
    user.click("lights");
    let handle = user.0.get_by_label("direction of light 0").rect().center();
    user.0.drag_at(handle);
    user.0.run_steps(2);
    user.0.hover_at(handle + egui::vec2(6.0, 3.0));
    user.0.run_steps(2);
    user.0.drop_at(handle + egui::vec2(6.0, 3.0));
    user.0.run_steps(4);
    assert!(user.changes().iter().any(|change| change.starts_with("light.0.direction=[")), "{:?}", user.changes());
}

#[test]
fn the_timing_mode_is_switched_beside_the_times() {
    let mut user = User::of("linke");
    user.click("Times").click("timing").click("overlapped");
    assert_eq!(user.changes(), ["frame.timing=\"overlapped\""]);
}

#[test]
fn a_pixel_that_is_clicked_is_asked_about_while_its_tab_is_open() {
    let mut user = User::of("linke");
    let middle = user.0.ctx.content_rect().center();
    let click = |user: &mut User| {
        user.0.hover_at(middle);
        user.0.run_steps(1);
        user.0.drag_at(middle);
        user.0.run_steps(1);
        user.0.drop_at(middle);
        user.0.run_steps(6);
    };
    click(&mut user);
    assert_eq!(user.request().inspection.pixel, None);
    user.click("Light");
    click(&mut user);
    assert!(user.request().inspection.pixel.is_some());
    user.click("VPLs");
    assert!(user.request().inspection.vpls && user.request().depth);
    user.click("forget");
    assert_eq!(user.request().inspection.pixel, None);
}

#[test]
fn every_tab_shows_what_it_is_for() {
    let mut user = User::of("linke");
    user.click("Times").0.get_by_label_contains("Memory of the frame");
    user.click("Warnings (1)").0.get_by_label("something is not used");
    user.click("Compare").click("the path tracer");
    assert_eq!(user.request().against, Against::Reference { bounces: 4 });
    user.click("hold this picture").0.get_by_label("held: linke");
    assert_eq!(user.request().against, Against::Nothing);
}

#[test]
fn a_key_that_is_held_counts_once() {
    let mut user = User::of("linke");
    assert!(user.0.state().0.fits);
    for _ in 0..2 {
        user.0.key_down(egui::Key::Num1);
        user.0.run_steps(2);
    }
    assert!(!user.0.state().0.fits);
}
