//! The mailbox between the window and the thread that renders. It holds one request at a time, the latest.

use super::project::Project;
use crate::config::Config;
use crate::graph::{Dump, Output};
use crate::inspection::Inspected;
use crate::scene::{Aabb, Camera};
use crate::world::Inspection;
use crate::world::projection::View;
use glam::Vec3;
use std::path::PathBuf;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// A frame that the window wants.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Grows from request to request.
    pub number: u64,
    pub project: Project,
    pub frame: u32,
    /// The pass whose outputs are shown.
    pub pass: &'static str,
    /// Share of the picture's sides: below 1 while the camera moves on a slow device.
    pub scale: f32,
    /// Whether the camera moves, so that passes that do not hang on it need not run.
    pub moving: bool,
    /// Whether the depth of the surfaces in sight is wanted, too.
    pub depth: bool,
    /// What is asked about the frame.
    pub inspection: Inspection,
    /// What the picture is compared with.
    pub against: Against,
    /// Folder to write the picture and its layers to, as `render` does.
    pub save: Option<PathBuf>,
}

/// What a picture is compared with.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Against {
    #[default]
    Nothing,
    /// The same view of another project.
    Project(Project),
    /// The path tracer, which gathers paths as long as nothing changes.
    Reference {
        /// Bounces of a path at most.
        bounces: u32,
    },
}

/// A picture that another one is compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct Other {
    pub name: String,
    pub size: [u32; 2],
    /// sRGB-encoded RGBA bytes.
    pub image: Vec<u8>,
}

/// The reference at a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    pub pixel: [u32; 2],
    /// Paths a pixel.
    pub samples: u32,
    /// Radiance, W/(m^2 sr), and the standard error of its mean.
    pub radiance: Vec3,
    pub error: Vec3,
    pub direct: Vec3,
    /// Radiance of each bounce, from the first.
    pub bounces: Vec<Vec3>,
    /// Indirect irradiance, W/m^2, of surfaces that reflect diffusely.
    pub irradiance: Vec3,
}

/// A frame that was rendered for a [`Request`].
#[derive(Debug)]
pub struct Shown {
    pub request: Request,
    pub config: Config,
    pub view: View,
    /// The camera of the view.
    pub camera: Camera,
    /// Bounds of the scene, metres.
    pub bounds: Aabb,
    /// The last frame of the sequence: of the config, of its keyframes, or of the scene's animation.
    pub last_frame: u32,
    /// Milliseconds of each pass, in order.
    pub times: Vec<(&'static str, f64)>,
    /// Milliseconds from the request to its frame.
    pub frame_ms: f64,
    pub counts: Vec<(String, u64)>,
    /// Bytes of each resource of the frame.
    pub memory: Vec<(String, u64)>,
    pub dumps: Vec<Dump>,
    /// Answers to what was asked about the frame.
    pub inspected: Inspected,
    /// The picture of [`Against::Project`], or why there is none.
    pub other: Option<Result<Other, String>>,
    /// Passes of the frame, with the images and buffers that each writes.
    pub outputs: Vec<(&'static str, Vec<Output>)>,
    pub warnings: Vec<String>,
    /// The device, its driver and the timing mode.
    pub device: String,
}

/// A message from the thread that renders.
#[derive(Debug)]
pub enum Message {
    /// It does something that takes a while.
    Doing(&'static str),
    Frame(Box<Shown>),
    /// The path tracer's picture so far, for the request of this number, and what it has at the pixel that is asked about.
    Reference(u64, Other, Option<Truth>),
    /// Picture and layers were written to this folder.
    Saved(PathBuf),
    /// A request could not be fulfilled, in one sentence. The last frame stays.
    Failed(String),
    /// The device is lost, or rendering ended otherwise: nothing follows.
    Ended(String),
}

/// What the mailbox holds.
#[derive(Debug)]
pub enum Taken {
    Request(Box<Request>),
    Nothing,
    /// The window was closed.
    Closed,
}

#[derive(Debug, Default)]
struct Contents {
    request: Option<Request>,
    saving: Option<Request>,
    is_closed: bool,
}

/// The latest request, from the window to the thread that renders.
#[derive(Debug, Default)]
pub struct Mailbox {
    contents: Mutex<Contents>,
    comes: Condvar,
}

impl Mailbox {
    /// Puts a request in the place of the older one. A request that saves stays beside later ones, and comes before them.
    pub fn put(&self, request: Request) {
        let mut contents = self.contents.lock().unwrap_or_else(PoisonError::into_inner);
        match request.save {
            // An older picture would come after it, and stay.
            Some(_) => (contents.saving, contents.request) = (Some(request), None),
            None => contents.request = Some(request),
        }
        self.comes.notify_all();
    }

    /// Takes the next request, and waits for it for at most this long.
    pub fn take(&self, patience: Duration) -> Taken {
        let contents = self.contents.lock().unwrap_or_else(PoisonError::into_inner);
        let is_empty = |contents: &mut Contents| contents.request.is_none() && contents.saving.is_none() && !contents.is_closed;
        let (mut contents, _) = self.comes.wait_timeout_while(contents, patience, is_empty).unwrap_or_else(PoisonError::into_inner);
        let first = contents.saving.take();
        match (contents.is_closed, first.or_else(|| contents.request.take())) {
            (true, _) => Taken::Closed,
            (false, Some(request)) => Taken::Request(Box::new(request)),
            (false, None) => Taken::Nothing,
        }
    }

    /// Ends the work.
    pub fn close(&self) {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner).is_closed = true;
        self.comes.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn request(number: u64, save: Option<PathBuf>) -> Request {
        let project = Project::new(Path::new("linke"), Vec::new());
        let against = Against::Nothing;
        Request {
            number,
            project,
            frame: 0,
            pass: "compose/sum",
            scale: 1.0,
            moving: false,
            depth: false,
            inspection: Inspection::default(),
            against,
            save,
        }
    }

    #[test]
    fn the_latest_wish_counts_and_what_is_to_be_saved_is_not_forgotten_for_it() {
        let mailbox = Mailbox::default();
        mailbox.put(request(1, None));
        mailbox.put(request(2, Some("out".into())));
        mailbox.put(request(3, None));
        mailbox.put(request(4, None));
        let next = || match mailbox.take(Duration::ZERO) {
            Taken::Request(request) => Some(request.number),
            Taken::Nothing | Taken::Closed => None,
        };
        assert_eq!([next(), next(), next()], [Some(2), Some(4), None]);
        mailbox.put(request(5, None));
        mailbox.put(request(6, Some("out".into())));
        assert_eq!([next(), next()], [Some(6), None]);
        mailbox.close();
        assert!(matches!(mailbox.take(Duration::from_secs(9)), Taken::Closed));
    }
}
