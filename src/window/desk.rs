//! The desk between the window and the thread that renders: one wish lies on it at a time, the latest.

use super::project::Project;
use crate::config::Config;
use crate::graph::Dump;
use crate::scene::{Aabb, Camera};
use crate::world::projection::View;
use std::path::PathBuf;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// A frame that the window wants.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// Grows from wish to wish.
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

/// A frame that was rendered for a [`Wish`].
#[derive(Debug)]
pub struct Shown {
    pub wish: Wish,
    pub config: Config,
    pub view: View,
    /// The camera of the view.
    pub camera: Camera,
    /// Bounds of the scene, metres.
    pub bounds: Aabb,
    /// Milliseconds of each pass, in order.
    pub times: Vec<(&'static str, f64)>,
    /// Milliseconds from the wish to its frame.
    pub frame_ms: f64,
    pub counts: Vec<(String, u64)>,
    /// Bytes of each resource of the frame.
    pub memory: Vec<(String, u64)>,
    pub dumps: Vec<Dump>,
    /// The picture of [`Against::Project`].
    pub other: Option<Other>,
    /// Passes of the frame, with the images that each writes.
    pub outputs: Vec<(&'static str, Vec<String>)>,
    pub warnings: Vec<String>,
    /// The device, its driver and the timing mode.
    pub device: String,
}

/// News from the thread that renders.
#[derive(Debug)]
pub enum News {
    /// It does something that takes a while.
    Doing(&'static str),
    Frame(Box<Shown>),
    /// The path tracer's picture so far, for the wish of this number.
    Reference(u64, Other),
    /// Picture and layers were written to this folder.
    Saved(PathBuf),
    /// A wish could not be fulfilled, in one sentence. The last frame stays.
    Failed(String),
    /// The device is lost, or rendering ended otherwise: nothing follows.
    Ended(String),
}

/// What lies on the desk.
#[derive(Debug)]
pub enum Taken {
    Wish(Box<Wish>),
    Nothing,
    /// The window was closed.
    Closed,
}

#[derive(Debug, Default)]
struct Lies {
    wish: Option<Wish>,
    saving: Option<Wish>,
    is_closed: bool,
}

/// The latest wish, from the window to the thread that renders.
#[derive(Debug, Default)]
pub struct Desk {
    lies: Mutex<Lies>,
    comes: Condvar,
}

impl Desk {
    /// Puts a wish in the place of the one that lies there. One that saves stays there beside the next ones, and comes before them.
    pub fn put(&self, wish: Wish) {
        let mut lies = self.lies.lock().unwrap_or_else(PoisonError::into_inner);
        match wish.save {
            // An older picture would come after it, and stay.
            Some(_) => (lies.saving, lies.wish) = (Some(wish), None),
            None => lies.wish = Some(wish),
        }
        self.comes.notify_all();
    }

    /// Takes the next wish, and waits for it for at most this long.
    pub fn take(&self, patience: Duration) -> Taken {
        let lies = self.lies.lock().unwrap_or_else(PoisonError::into_inner);
        let is_empty = |lies: &mut Lies| lies.wish.is_none() && lies.saving.is_none() && !lies.is_closed;
        let (mut lies, _) = self.comes.wait_timeout_while(lies, patience, is_empty).unwrap_or_else(PoisonError::into_inner);
        let first = lies.saving.take();
        match (lies.is_closed, first.or_else(|| lies.wish.take())) {
            (true, _) => Taken::Closed,
            (false, Some(wish)) => Taken::Wish(Box::new(wish)),
            (false, None) => Taken::Nothing,
        }
    }

    /// Ends the work.
    pub fn close(&self) {
        self.lies.lock().unwrap_or_else(PoisonError::into_inner).is_closed = true;
        self.comes.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn wish(number: u64, save: Option<PathBuf>) -> Wish {
        let project = Project::new(Path::new("linke"), Vec::new());
        let against = Against::Nothing;
        Wish { number, project, frame: 0, pass: "compose/sum", scale: 1.0, moving: false, depth: false, against, save }
    }

    #[test]
    fn the_latest_wish_counts_and_what_is_to_be_saved_is_not_forgotten_for_it() {
        let desk = Desk::default();
        desk.put(wish(1, None));
        desk.put(wish(2, Some("out".into())));
        desk.put(wish(3, None));
        desk.put(wish(4, None));
        let next = || match desk.take(Duration::ZERO) {
            Taken::Wish(wish) => Some(wish.number),
            Taken::Nothing | Taken::Closed => None,
        };
        assert_eq!([next(), next(), next()], [Some(2), Some(4), None]);
        desk.put(wish(5, None));
        desk.put(wish(6, Some("out".into())));
        assert_eq!([next(), next()], [Some(6), None]);
        desk.close();
        assert!(matches!(desk.take(Duration::from_secs(9)), Taken::Closed));
    }
}
