//! The window of `manylight view`: it shows frames, takes requests, and renders nothing itself.
//!
//! - [`Mailbox`] carries the latest request to the thread that renders; a [`Message`] comes back as an event of the window. Input is
//!   answered at once, however long a frame takes.
//! - [`Project`] is what is shown: a config and the changes over it, each a `--set`. A picture at rest is the one that `render` makes of
//!   them, byte by byte.
//! - [`flight`] moves the camera, [`recording`] makes keyframes of its way, [`look`] makes images of passes visible, [`panels`] are the
//!   widgets, [`painter`] draws them by a graph.

mod app;
mod flight;
mod look;
mod mailbox;
mod pace;
mod painter;
mod panels;
mod project;
mod recording;

pub use mailbox::{Against, Mailbox, Message, Other, Request, Shown, Taken, Truth};
pub use project::Project;

use crate::fail;
use crate::gpu::DeviceChoice;
use anyhow::Result;
use std::sync::Arc;
use std::thread::JoinHandle;
use winit::event_loop::EventLoop;

/// Pass and image of the picture itself.
pub const PICTURE: (&str, &str) = ("compose/sum", "compose/image");
/// Pass and image of the depth of the surfaces in sight.
pub const DEPTH: (&str, &str) = ("gbuffer/draw", "gbuffer/depth");

/// Hands a message to the window.
pub type Tell = Box<dyn Fn(Message) + Send>;

/// Opens the window, and `start`s the thread that renders for it. Returns that thread once the window is closed.
///
/// # Errors
/// `NoDevice` without a display, or without a device that shows pictures on it; and those of `start`.
pub fn open<T>(
    project: Project,
    device: Option<&DeviceChoice>,
    validate: bool,
    start: impl FnOnce(Arc<Mailbox>, Tell) -> Result<JoinHandle<T>>,
) -> Result<JoinHandle<T>> {
    let events = EventLoop::<Message>::with_user_event().build().map_err(|error| {
        // The words before the last colon are a place in the library's source.
        let error = error.to_string();
        let why = error.rsplit_once(": ").map_or(error.as_str(), |(_, why)| why).trim_end_matches('.');
        fail!(NoDevice, "no window can be opened: {why}; `manylight render` makes the same pictures without a display")
    })?;
    let mailbox = Arc::new(Mailbox::default());
    let proxy = events.create_proxy();
    // Ignored: once the window is closed, nobody reads messages.
    let render_thread = start(mailbox.clone(), Box::new(move |message| drop(proxy.send_event(message))))?;
    let mut app = app::App::new(project, mailbox.clone(), device.cloned(), validate);
    let ran = events.run_app(&mut app).map_err(|error| fail!(NoDevice, "the window ended: {error}"));
    mailbox.close();
    app.ended().and(ran)?;
    Ok(render_thread)
}
