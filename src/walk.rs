//! Walks: the frames of a config one after another, and how much they flicker.

use crate::config::Config;
use crate::fail;
use crate::graph::Execution;
use crate::metrics::flicker::{Flicker, Matches, Pair, Surfaces, matches};
use crate::metrics::{Content, Image, Intensity, rmse};
use crate::output::{Picture, Plane};
use crate::renderer::Renderer;
use anyhow::{Context, Result};
use serde::Serialize;

/// The flicker from one frame to the next, and what stands beside it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Step {
    pub previous: u32,
    pub next: u32,
    #[serde(flatten)]
    pub pair: Pair,
    /// The reference's own flicker over the same matches.
    pub reference: Option<f64>,
    /// What the frames flicker more than their reference: the difference of the two.
    pub excess: Option<f64>,
}

/// What a walk gave.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Walk {
    /// A step a pair of frames.
    pub steps: Vec<Step>,
    /// Over all of them.
    pub flicker: Flicker,
    /// The reference's own, over the same matches.
    pub reference: Option<Flicker>,
    /// The difference of the pooled `flicker` of the two.
    pub excess: Option<f64>,
    /// Of each frame against its reference, over pixels and channels; empty without a reference.
    pub rmse: Vec<f64>,
    /// Root of the mean of their squares.
    pub rmse_of_walk: Option<f64>,
}

/// A frame of a walk as it goes by.
pub struct Visit<'v> {
    pub frame: u32,
    pub picture: &'v Picture,
    /// How it follows from the frame before; the first one has none.
    pub step: Option<&'v Step>,
    /// Against its reference, where there is one.
    pub rmse: Option<f64>,
    before: Option<(&'v Matches, &'v [f32])>,
    intensities: &'v [f32],
}

impl Visit<'_> {
    /// How the intensity of each pixel of the frame before changed; see [`Matches::differences`]. `None` at the first frame.
    pub fn differences(&self) -> Option<Vec<Option<f64>>> {
        self.before.map(|(matches, before)| matches.differences(before, self.intensities))
    }
}

/// A frame's picture of the reference, by the frame's number.
pub type ReferenceFrames<'r> = &'r dyn Fn(u32) -> Result<Image>;

/// What is kept of a frame until the next one is measured.
struct Kept {
    surfaces: Surfaces,
    intensities: Vec<f32>,
    reference: Option<Vec<f32>>,
}

/// Renders the frames 0 to `frame.count` - 1 of a config, without those of its warm-up, and measures how much they flicker. Two
/// frames are in memory at a time; `on_frame` sees each of them as it is made.
///
/// # Errors
/// `BadInput` where there are fewer than two frames, where a frame or its reference is not all finite numbers, where the sizes of
/// the two differ, and where no frame shows anything of the one before; and whatever rendering and `on_frame` fail with.
pub fn flicker_of_walk(
    renderer: &mut Renderer,
    config: &Config,
    layer: Intensity,
    reference: Option<ReferenceFrames>,
    execution: &Execution,
    on_frame: &mut dyn FnMut(&Visit) -> Result<()>,
) -> Result<Walk> {
    check(config)?;
    let (mut steps, mut of_reference, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    let mut before: Option<Kept> = None;
    for frame in 0..config.frame.count {
        let rendered = renderer.render(config, frame, true, execution)?;
        let Some(picture) = &rendered.picture else { unreachable!("the picture was asked for") };
        let image = image(intensities(picture, layer), picture.size).with_context(|| format!("frame {frame}: layer {}", layer.name()))?;
        let truth = reference.map(|read| read(frame)).transpose()?;
        let error = truth.as_ref().map(|truth| rmse(&image, truth)).transpose();
        let error = error.with_context(|| format!("frame {frame} and its reference: layer {}", layer.name()))?;
        errors.extend(error);
        let now = Kept {
            surfaces: Surfaces { view: picture.view, positions: picture.positions(), normals: picture.normals() },
            intensities: image.luminances(),
            reference: truth.as_ref().map(Image::luminances),
        };
        let matched = before.as_ref().map(|before| (matches(&before.surfaces, &now.surfaces), before));
        let step = matched.as_ref().map(|(matched, before)| {
            let pair = matched.pair(&before.intensities, &now.intensities);
            let truth = before.reference.as_ref().zip(now.reference.as_ref()).map(|(was, is)| matched.pair(was, is));
            of_reference.extend(truth);
            let reference = truth.and_then(|truth| truth.flicker);
            let excess = pair.flicker.zip(reference).map(|(flicker, reference)| flicker - reference);
            Step { previous: frame - 1, next: frame, pair, reference, excess }
        });
        on_frame(&Visit {
            frame,
            picture,
            step: step.as_ref(),
            rmse: error,
            before: matched.as_ref().map(|(matched, before)| (matched, before.intensities.as_slice())),
            intensities: &now.intensities,
        })?;
        steps.extend(step);
        before = Some(now);
    }
    let pairs: Vec<Pair> = steps.iter().map(|step| step.pair).collect();
    let flicker = Flicker::over(&pairs).ok_or_else(|| {
        fail!(BadInput, "no frame shows anything of the one before it; raise frame.fps, or let the camera move more slowly")
    })?;
    let reference = Flicker::over(&of_reference);
    Ok(Walk {
        excess: reference.map(|reference| flicker.flicker - reference.flicker),
        rmse_of_walk: reference.map(|_| (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()),
        steps,
        flicker,
        reference,
        rmse: errors,
    })
}

/// Refuses a config that has no two frames.
///
/// # Errors
/// `BadInput`.
pub fn check(config: &Config) -> Result<()> {
    match config.frame.count {
        0 | 1 => Err(fail!(BadInput, "frame.count: flicker needs 2 frames or more; raise it, or give --frames")),
        _ => Ok(()),
    }
}

/// Whether neither the camera nor a light of a config moves by keyframes: if the scene does not either, its frames show how much a method flickers by itself.
pub fn stands_still(config: &Config) -> bool {
    use crate::config::LightConfig;
    let lit_by_keyframes = |light: &LightConfig| match light {
        LightConfig::Directional { keyframes, .. } | LightConfig::Spot { keyframes, .. } | LightConfig::Point { keyframes, .. } => {
            !keyframes.is_empty()
        }
        LightConfig::Environment { .. } => false,
    };
    config.camera.as_ref().is_none_or(|camera| camera.keyframes.is_empty()) && !config.light.iter().any(lit_by_keyframes)
}

fn intensities(picture: &Picture, layer: Intensity) -> &Plane {
    match layer {
        Intensity::Radiance => &picture.radiance,
        Intensity::Direct => &picture.direct,
        Intensity::Indirect => &picture.indirect,
        Intensity::Irradiance => &picture.irradiance,
    }
}

fn image(plane: &Plane, size: [u32; 2]) -> Result<Image> {
    let values = plane.rgb().flat_map(|color| color.to_array()).collect();
    Image::new(size[0] as usize, Content::Radiance, &["R", "G", "B"], values)
}
