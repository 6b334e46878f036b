//! Animations of a file: the chosen one's channels as tracks of nodes.

use super::accessors::Attribute;
use super::geometry::{MAX_DISTANCE, is_near};
use super::{AnimationChoice, File, Warning, Warnings, label, refuse};
use crate::scene::Scene;
use crate::scene::track::{Course, Track};
use anyhow::{Context, Result};
use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler};
use gltf_json::validation::Checked;
use gltf_json::{Index, Mesh, Node};
use std::collections::HashMap;

/// Limit of an animation's keys: a small file in which many samplers share accessors would fill the memory with tracks.
const MAX_KEYS: usize = 1 << 23;

/// The chosen animation, before its nodes' draws, lights and cameras are known.
pub struct Played {
    /// Label in messages.
    pub label: String,
    pub name: String,
    /// Duration, s; over 0.
    pub duration: f64,
    pub tracks: Vec<Track>,
    /// Animated nodes, by index.
    pub nodes: HashMap<usize, Moved>,
    /// Tracks of the weights of nodes' morph targets, by the node's index: one a target.
    pub weights: HashMap<usize, Vec<usize>>,
}

/// Tracks of a node's properties.
#[derive(Debug, Clone, Copy, Default)]
pub struct Moved {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

/// Reads the chosen animation. `None` if none is wanted, if the file has none and none was named, or if it is empty.
pub fn read(file: &File<'_>, choice: &AnimationChoice, warnings: &mut Warnings) -> Result<Option<Played>> {
    let Some(index) = chosen(&file.root.animations, choice)? else { return Ok(None) };
    let animation = &file.root.animations[index];
    let label = label("animation", index, animation.name.as_ref());
    let name = animation.name.clone().unwrap_or_else(|| label.clone());
    let (known, nodes, weights) = (HashMap::new(), HashMap::new(), HashMap::new());
    let mut reader = Reader { file, animation, tracks: Vec::new(), known, nodes, weights, keys: 0 };
    for (i, channel) in animation.channels.iter().enumerate() {
        reader.channel(channel, warnings).with_context(|| format!("channel {i}")).with_context(|| label.clone())?;
    }
    let Reader { tracks, nodes, weights, .. } = reader;
    let duration = tracks.iter().filter_map(|track| track.times().last().copied()).fold(0.0, f32::max);
    Ok((!tracks.is_empty()).then_some(Played { label, name, duration: duration.into(), tracks, nodes, weights }))
}

/// The index of the chosen animation.
fn chosen(animations: &[Animation], choice: &AnimationChoice) -> Result<Option<usize>> {
    let (found, wanted) = match choice {
        AnimationChoice::None => return Ok(None),
        AnimationChoice::First => return Ok((!animations.is_empty()).then_some(0)),
        AnimationChoice::Index(index) => ((*index < animations.len()).then_some(*index), format!("{index}")),
        AnimationChoice::Name(name) => (animations.iter().position(|animation| animation.name.as_ref() == Some(name)), format!("{name:?}")),
    };
    if found.is_none() {
        let list: Vec<_> = animations.iter().enumerate().map(|(i, animation)| label("animation", i, animation.name.as_ref())).collect();
        refuse!("it has no animation {wanted}; there is {}", if list.is_empty() { "none".to_string() } else { list.join(", ") });
    }
    Ok(found)
}

struct Reader<'a> {
    file: &'a File<'a>,
    animation: &'a Animation,
    tracks: Vec<Track>,
    /// Tracks by sampler, and whether the track is a rotation.
    known: HashMap<(usize, bool), usize>,
    nodes: HashMap<usize, Moved>,
    weights: HashMap<usize, Vec<usize>>,
    /// Keys of all tracks so far.
    keys: usize,
}

impl Reader<'_> {
    fn channel(&mut self, channel: &Channel, warnings: &mut Warnings) -> Result<()> {
        let Checked::Valid(property) = channel.target.path else {
            refuse!("its path is none of translation, rotation, scale and weights");
        };
        let attribute = match property {
            Property::Translation => Attribute::Translation,
            Property::Rotation => Attribute::Rotation,
            Property::Scale => Attribute::Scale,
            Property::MorphTargetWeights => return self.weights_channel(channel, warnings),
        };
        let index = channel.target.node;
        let node: &Node = self.file.get(index, "node")?;
        let called = || label("node", index.value(), node.name.as_ref());
        if node.matrix.is_some() {
            refuse!("{} has a matrix: what is animated has translation, rotation and scale instead", called());
        }
        let track = self.track(channel.sampler, attribute).with_context(|| format!("sampler {}", channel.sampler))?;
        let moved = self.nodes.entry(index.value()).or_default();
        let slot = match attribute {
            Attribute::Translation => &mut moved.translation,
            Attribute::Rotation => &mut moved.rotation,
            _ => &mut moved.scale,
        };
        if slot.replace(track).is_some() {
            refuse!("the {attribute} of {} is that of another channel already", called());
        }
        Ok(())
    }

    /// Weights of a node's morph targets, a track a target.
    fn weights_channel(&mut self, channel: &Channel, warnings: &mut Warnings) -> Result<()> {
        let index = channel.target.node;
        let node: &Node = self.file.get(index, "node")?;
        let called = || label("node", index.value(), node.name.as_ref());
        let targets = match node.mesh {
            Some(mesh) => morph_targets(self.file.get(mesh, "mesh")?),
            None => 0,
        };
        if targets == 0 {
            warnings.add(Warning::Animation, format!("{} has no morph targets: the animation of their weights is not played", called()));
            return Ok(());
        }
        let first = self.tracks.len();
        self.weight_tracks(channel.sampler, targets).with_context(|| format!("sampler {}", channel.sampler))?;
        if self.weights.insert(index.value(), (first..first + targets).collect()).is_some() {
            refuse!("the weights of {} are those of another channel already", called());
        }
        Ok(())
    }

    fn weight_tracks(&mut self, index: Index<Sampler>, targets: usize) -> Result<()> {
        let sampler = self.sampler(index)?;
        let (course, times) = self.keys(sampler, targets)?;
        let each = Track::values_a_key(course);
        let expected = times.len() as u64 * each as u64 * targets as u64;
        let found = self.file.count(sampler.output)?;
        if found != expected {
            refuse!(
                "its {} keys of {targets} targets need {expected} values, its output (accessor {}) has {found}",
                times.len(),
                sampler.output
            );
        }
        let values: Vec<f32> = self.file.floats::<1>(sampler.output, Attribute::MorphWeights)?.into_flattened();
        for target in 0..targets {
            let own = values.iter().skip(target).step_by(targets).map(|value| [*value, 0.0, 0.0, 0.0]).collect();
            self.tracks.push(Track::new(course, times.clone(), own));
            self.keys += times.len();
        }
        Ok(())
    }

    fn sampler(&self, index: Index<Sampler>) -> Result<&Sampler> {
        let Some(sampler) = self.animation.samplers.get(index.value()) else {
            refuse!("it does not exist, the animation has {}", self.animation.samplers.len());
        };
        Ok(sampler)
    }

    fn track(&mut self, index: Index<Sampler>, attribute: Attribute) -> Result<usize> {
        let key = (index.value(), attribute == Attribute::Rotation);
        if let Some(known) = self.known.get(&key) {
            return Ok(*known);
        }
        self.tracks.push(self.read(self.sampler(index)?, attribute)?);
        self.keys += self.tracks.last().map_or(0, |track| track.times().len());
        self.known.insert(key, self.tracks.len() - 1);
        Ok(self.tracks.len() - 1)
    }

    /// Interpolation and times of a sampler's keys, of which `tracks` tracks will be made.
    fn keys(&self, sampler: &Sampler, tracks: usize) -> Result<(Course, Vec<f32>)> {
        let course = match sampler.interpolation {
            Checked::Valid(Interpolation::Step) => Course::Step,
            Checked::Valid(Interpolation::Linear) => Course::Linear,
            Checked::Valid(Interpolation::CubicSpline) => Course::Cubic,
            Checked::Invalid => refuse!("its interpolation is none of STEP, LINEAR and CUBICSPLINE"),
        };
        if self.file.count(sampler.input)?.saturating_mul(tracks as u64).saturating_add(self.keys as u64) > MAX_KEYS as u64 {
            refuse!("with it, the animation has more than {MAX_KEYS} keys");
        }
        let times: Vec<f32> = self.file.floats::<1>(sampler.input, Attribute::Time)?.into_flattened();
        if times.is_empty() {
            refuse!("it has no keys");
        }
        if let Some(bad) = (0..times.len()).find(|i| times[*i] < if *i > 0 { times[i - 1] } else { 0.0 }) {
            refuse!("the time {} of key {bad} is below 0 or before that of the key before it", times[bad]);
        }
        Ok((course, times))
    }

    fn read(&self, sampler: &Sampler, attribute: Attribute) -> Result<Track> {
        let (course, times) = self.keys(sampler, 1)?;
        let expected = times.len() * Track::values_a_key(course);
        if self.file.count(sampler.output)? != expected as u64 {
            let found = self.file.count(sampler.output)?;
            refuse!("its {} keys need {expected} values, its output (accessor {}) has {found}", times.len(), sampler.output);
        }
        let values: Vec<[f32; 4]> = if attribute == Attribute::Rotation {
            self.file.floats(sampler.output, attribute)?
        } else {
            let vectors: Vec<[f32; 3]> = self.file.floats(sampler.output, attribute)?;
            vectors.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect()
        };
        if attribute == Attribute::Rotation {
            let own = values.iter().skip(usize::from(course == Course::Cubic)).step_by(Track::values_a_key(course));
            let is_none = |q: &[f32; 4]| !q.iter().any(|c| c.abs() > 1e-3);
            if let Some(bad) = own.into_iter().position(is_none) {
                refuse!("the rotation of key {bad} is not a unit quaternion");
            }
        }
        Ok(Track::new(course, times, values))
    }
}

/// Number of a mesh's morph targets, by its first primitive.
pub fn morph_targets(mesh: &Mesh) -> usize {
    mesh.primitives.first().and_then(|primitive| primitive.targets.as_ref()).map_or(0, Vec::len)
}

/// Refuses a scene whose animation moves a mesh too far away.
pub fn check_reach(scene: &Scene) -> Result<()> {
    match scene.swept_bounds().into_iter().find(|(_, swept)| !is_near(*swept)) {
        Some((draw, _)) => {
            let material = &scene.materials[scene.draws[draw].material as usize].name;
            refuse!("a mesh of material {material:?} gets farther than {MAX_DISTANCE:e} m from the origin")
        }
        None => Ok(()),
    }
}
