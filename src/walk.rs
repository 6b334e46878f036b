//! Walks: all frames of a config in order, and how much they flicker.

use crate::config::Config;
use crate::fail;
use crate::graph::Execution;
use crate::metrics::flicker::{Flicker, Matches, Pair, Surfaces, matches};
use crate::metrics::{Content, Image, Intensity, rmse};
use crate::output::{Picture, Plane};
use crate::renderer::Renderer;
use anyhow::{Context, Result};
use serde::Serialize;

/// Flicker between two consecutive frames, with the reference's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Step {
    pub previous: u32,
    pub next: u32,
    #[serde(flatten)]
    pub pair: Pair,
    /// Flicker of the reference over the same matches.
    pub reference: Option<f64>,
    /// Excess of the frames' flicker over the reference's.
    pub excess: Option<f64>,
}

/// Results of a walk.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Walk {
    /// Steps, one a pair of frames.
    pub steps: Vec<Step>,
    /// Flicker over all steps.
    pub flicker: Flicker,
    /// Flicker of the reference over the same matches.
    pub reference: Option<Flicker>,
    /// Excess of the pooled `flicker` over the reference's.
    pub excess: Option<f64>,
    /// RMSE of each frame against its reference, over pixels and channels; empty without a reference.
    pub rmse: Vec<f64>,
    /// Root mean square of `rmse`.
    pub rmse_of_walk: Option<f64>,
}

/// A frame of a walk, for the callback.
pub struct Visit<'v> {
    pub frame: u32,
    pub picture: &'v Picture,
    /// Step from the frame before; the first frame has none.
    pub step: Option<&'v Step>,
    /// RMSE against its reference, if there is one.
    pub rmse: Option<f64>,
    before: Option<(&'v Matches, &'v [f32])>,
    intensities: &'v [f32],
}

impl Visit<'_> {
    /// Change of each pixel's intensity since the frame before; see [`Matches::differences`]. `None` at the first frame.
    pub fn differences(&self) -> Option<Vec<Option<f64>>> {
        self.before.map(|(matches, before)| matches.differences(before, self.intensities))
    }
}

/// Reference pictures by frame number.
pub type ReferenceFrames<'r> = &'r dyn Fn(u32) -> Result<Image>;

/// Data of a frame that the next frame is compared with.
struct Kept {
    surfaces: Surfaces,
    intensities: Vec<f32>,
    reference: Option<Vec<f32>>,
}

/// Renders the frames 0 to `frame.count` - 1 of a config, without its warm-up frames, and measures their flicker. Two frames are in memory
/// at a time; `on_frame` gets each frame when it is made.
///
/// # Errors
/// `BadInput` if there are fewer than two frames, if a frame or its reference has values that are not finite, if their sizes differ, or if
/// no frame shows surfaces of the one before. Errors of rendering and of `on_frame` are passed on.
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

/// Refuses a config with fewer than two frames.
///
/// # Errors
/// `BadInput`.
pub fn check(config: &Config) -> Result<()> {
    match config.frame.count {
        0 | 1 => Err(fail!(BadInput, "frame.count: flicker needs 2 frames or more; raise it, or give --frames")),
        _ => Ok(()),
    }
}

/// Whether no keyframes move the camera or a light of a config. If the scene does not move either, its frames show a method's own flicker.
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
