//! glTF 2.0 files (.glb, or .gltf with buffers and images beside it or embedded) as a [`Scene`].
//!
//! Only objects that the chosen scene uses are read: its nodes' meshes, their materials and images. A file is never trusted:
//! every index, offset, count and size is checked before its use, and an error is one sentence that names the object. Legal
//! content that cannot be shown becomes a warning.

mod accessors;
mod animations;
mod bends;
mod buffers;
mod container;
mod geometry;
mod images;
mod influences;
mod lights;
mod materials;
mod nodes;
mod skins;
mod textures;
mod triangles;

use super::Scene;
use anyhow::{Context, Result};
use bends::Bends;
use buffers::Buffers;
use gltf_json::{Index, Root};
use std::path::Path;

/// Returns a [`BadInput`](crate::error::Exit::BadInput) failure from the function.
macro_rules! refuse {
    ($($message:tt)+) => {
        return Err($crate::fail!(BadInput, $($message)+))
    };
}
use refuse;

/// Choice of scene and animation in a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Choice {
    /// The file's default scene if `None`.
    pub scene: Option<SceneChoice>,
    pub animation: AnimationChoice,
}

/// Choice of the animation that moves the scene.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum AnimationChoice {
    /// The first animation, if there is one.
    #[default]
    First,
    /// No animation: every node keeps its own transform.
    None,
    /// An index in the file's order, from zero.
    Index(usize),
    /// The first animation of this name.
    Name(String),
}

/// Choice of the scene to load.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneChoice {
    /// An index in the file's order, from zero.
    Index(usize),
    /// The first scene of this name.
    Name(String),
}

/// A loaded scene, and warnings about everything left out.
#[derive(Debug)]
pub struct Loaded {
    pub scene: Scene,
    /// One sentence each, for the user, without repetitions.
    pub warnings: Vec<String>,
}

/// Loads the file's default scene with its first animation, or those in `choice`. Referenced files are searched beside it.
///
/// The scene is at the animation's time 0.
///
/// # Errors
/// [`BadInput`](crate::error::Exit::BadInput), beginning with the path, if a file cannot be read or is no valid glTF 2.0 file,
/// requires an unknown extension, or shows no triangle.
pub fn load(path: &Path, choice: Option<&Choice>) -> Result<Loaded> {
    let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    buffers::read_file(path, u64::MAX)
        .and_then(|bytes| read(&bytes, Some(path.parent().unwrap_or(Path::new(""))), &name, choice))
        .with_context(|| path.display().to_string())
}

/// Loads a scene from the bytes of a .glb or .gltf file. `base` is the folder of referenced files; without one, such references
/// are refused. `name` begins every error, and names the scene.
///
/// # Errors
/// See [`load`].
pub fn load_slice(bytes: &[u8], base: Option<&Path>, name: &str, choice: Option<&Choice>) -> Result<Loaded> {
    read(bytes, base, name, choice).with_context(|| name.to_string())
}

/// The opened file, for lookups by all parts of the loader.
struct File<'a> {
    root: Root,
    buffers: Buffers<'a>,
    base: Option<&'a Path>,
    /// Whether vertex attributes may be integers (KHR_mesh_quantization).
    quantized: bool,
}

impl File<'_> {
    /// The object at an index, checked.
    fn get<T>(&self, index: Index<T>, kind: &str) -> Result<&T>
    where
        Root: AsRef<[T]>,
    {
        let all: &[T] = self.root.as_ref();
        let Some(object) = all.get(index.value()) else {
            refuse!("{kind} {index} does not exist, the file has {}", all.len());
        };
        Ok(object)
    }
}

/// Warnings by kind: the first object's sentence, and the number of objects.
#[derive(Default)]
struct Warnings(Vec<(Warning, String, usize)>);

/// Kinds of warnings.
#[derive(Clone, Copy, PartialEq)]
enum Warning {
    Extension,
    Animation,
    Joints,
    Weightless,
    MorphTangents,
    HiddenNode,
    Mirrored,
    LightRange,
    Orthographic,
    UvSets,
    NoUvs,
    Blending,
    PointsAndLines,
    Normals,
}

impl Warnings {
    fn add(&mut self, kind: Warning, sentence: impl Into<String>) {
        match self.0.iter_mut().find(|(known, ..)| *known == kind) {
            Some((_, _, count)) => *count += 1,
            None => self.0.push((kind, sentence.into(), 1)),
        }
    }

    fn sentences(self) -> Vec<String> {
        self.0.into_iter().map(|(_, text, count)| if count > 1 { format!("{text} ({} more like this)", count - 1) } else { text }).collect()
    }
}

/// An object's label in messages: kind, index and, if it has one, name.
fn label(kind: &str, index: usize, name: Option<&String>) -> String {
    name.map_or_else(|| format!("{kind} {index}"), |name| format!("{kind} {index} ({name:?})"))
}

fn read(bytes: &[u8], base: Option<&Path>, name: &str, choice: Option<&Choice>) -> Result<Loaded> {
    let mut warnings = Warnings::default();
    let container = container::split(bytes)?;
    let root = container::parse(container.json, &mut warnings)?;
    let buffers = Buffers::load(&root, container.bin, base)?;
    let quantized = root.extensions_used.iter().chain(&root.extensions_required).any(|name| name == "KHR_mesh_quantization");
    let file = File { root, buffers, base, quantized };

    let default = Choice::default();
    let choice = choice.unwrap_or(&default);
    let played = animations::read(&file, &choice.animation, &mut warnings)?;
    let moving = played.as_ref().map(|played| played.label.clone());
    let mut placed = nodes::walk(&file, choice.scene.as_ref(), played, &mut warnings)?;
    let bends = Bends::new(&file, skins::read(&file, &mut placed)?, std::mem::take(&mut placed.weights));
    let nodes::Placed { meshes, lights, cameras, animation, .. } = placed;
    let mut scene = Scene { name: name.to_string(), lights, cameras, animation, ..Scene::default() };
    let materials = materials::read(&file, &meshes, &mut scene, &mut warnings)?;
    images::decode(&file, &materials.textures.images, &mut scene)?;
    let bending = geometry::build(&file, &meshes, &materials, bends, &mut scene, &mut warnings)?;
    if scene.draws.is_empty() {
        refuse!("the scene has no triangles");
    }
    bends::finish(&mut scene, bending)?;
    scene.animation = scene.animation.take().filter(|animation| animation.moves() || scene.bending.is_some());
    animations::check_reach(&scene).with_context(|| moving.unwrap_or_default())?;
    Ok(Loaded { scene, warnings: warnings.sentences() })
}
