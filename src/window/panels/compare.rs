//! The picture beside another one: a picture that was held, another preset, or the path tracer.

use super::Panels;
use crate::color::srgb_to_linear;
use crate::metrics::{self, Content, Image};
use crate::presets;
use crate::window::PICTURE;
use crate::window::look::Texels;
use crate::window::mailbox::Shown;
use crate::window::mailbox::{Against, Other};
use anyhow::Result;
use egui::{Color32, ColorImage, ComboBox, Context, Grid, RichText, TextureHandle, TextureOptions, Ui};
use std::sync::mpsc::{Receiver, channel};

/// How two pictures are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// The picture on the left of a line, the other one on its right.
    #[default]
    Split,
    /// The other picture alone.
    Other,
    /// FLIP, the difference that is seen when the two are flipped between.
    Difference,
}

/// What is chosen to compare with.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Choice {
    #[default]
    Nothing,
    Held,
    Preset(String),
    Reference,
}

/// State of the comparison.
#[derive(Default)]
pub struct Compare {
    pub choice: Choice,
    pub mode: Mode,
    /// Place of the line, as a share of the picture's width.
    pub split: Option<f32>,
    bounces: Option<u32>,
    other: Option<Other>,
    texture: Option<TextureHandle>,
    difference: Option<TextureHandle>,
    figures: Option<Result<Figures, String>>,
    /// Figures in the making.
    awaited: Option<Receiver<Result<Compared, String>>>,
    is_stale: bool,
}

/// Errors of the shown pictures.
#[derive(Debug, Clone, Copy)]
struct Figures {
    rmse: f64,
    energy: Option<f64>,
    flip: Option<f64>,
}

/// Figures, and the map of FLIP with its size.
struct Compared {
    figures: Figures,
    map: Vec<f32>,
    size: [usize; 2],
}

/// Bounces of the path tracer, unless another number is given.
const BOUNCES: u32 = 4;

impl Compare {
    /// What a request is compared with.
    pub fn against(&self, panels: &Panels) -> Against {
        match &self.choice {
            Choice::Nothing | Choice::Held => Against::Nothing,
            Choice::Reference => Against::Reference { bounces: self.bounces.unwrap_or(BOUNCES) },
            Choice::Preset(preset) => match panels.whole_config() {
                Ok(config) => Against::Project(panels.project.by_preset(preset, &config)),
                Err(_) => Against::Nothing,
            },
        }
    }

    /// Takes over another picture.
    pub fn take(&mut self, other: Other, context: &Context) {
        let size = other.size.map(|side| side as usize);
        let pixels = other.image.chunks_exact(4).map(|texel| Color32::from_rgb(texel[0], texel[1], texel[2])).collect();
        let image = ColorImage::new(size, pixels);
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::NEAREST),
            None => self.texture = Some(context.load_texture("other", image, TextureOptions::NEAREST)),
        }
        (self.other, self.is_stale) = (Some(other), true);
    }

    /// A new frame has come: figures are of an older one.
    pub fn shown(&mut self) {
        self.is_stale = true;
    }

    /// The texture beside the picture, and whether it takes all of its place.
    pub fn beside(&self) -> Option<(&TextureHandle, bool)> {
        if self.choice == Choice::Nothing {
            return None;
        }
        match self.mode {
            Mode::Split => self.texture.as_ref().map(|texture| (texture, false)),
            Mode::Other => self.texture.as_ref().map(|texture| (texture, true)),
            Mode::Difference => self.difference.as_ref().map(|texture| (texture, true)),
        }
    }

    fn forget(&mut self) {
        (self.other, self.texture, self.difference, self.figures) = (None, None, None, None);
    }

    /// Takes over figures that are made, and begins new ones if the pictures have changed.
    fn measure(&mut self, shown: &Shown, context: &Context) {
        if let Some(compared) = self.awaited.as_ref().and_then(|awaited| awaited.try_recv().ok()) {
            self.awaited = None;
            self.figures = Some(compared.map(|compared| {
                let colors = metrics::heatmap(&compared.map);
                let pixels = colors.chunks_exact(3).map(|color| Color32::from_rgb(color[0], color[1], color[2])).collect();
                let image = ColorImage::new(compared.size, pixels);
                match &mut self.difference {
                    Some(texture) => texture.set(image, TextureOptions::NEAREST),
                    None => self.difference = Some(context.load_texture("difference", image, TextureOptions::NEAREST)),
                }
                compared.figures
            }));
        }
        // Figures of smaller pictures are others.
        if !self.is_stale || self.awaited.is_some() || shown.request.scale < 1.0 {
            return;
        }
        let (Some(other), Some(picture)) = (&self.other, picture_of(shown)) else { return };
        self.is_stale = false;
        let (other, context) = (other.clone(), context.clone());
        let (send, receive) = channel();
        self.awaited = Some(receive);
        rayon::spawn(move || {
            // Ignored: the window may be closed.
            let _ = send.send(compared(&picture, &other).map_err(|error| format!("{error:#}")));
            context.request_repaint();
        });
    }
}

impl Panels {
    pub(super) fn compare(&mut self, ui: &mut Ui) {
        let before = self.compare.choice.clone();
        let label = ui.label("Compare the picture with").id;
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.compare.choice, Choice::Nothing, "nothing");
            let reference = ui.selectable_value(&mut self.compare.choice, Choice::Reference, "the path tracer");
            reference.on_hover_text("Our own reference: it traces paths as long as nothing changes");
            let hint = "Keep the picture as it is now, and compare what comes with it";
            if ui.button("hold this picture").on_hover_text(hint).clicked()
                && let Some(mut held) = self.shown.as_ref().and_then(|shown| picture_of(shown))
            {
                self.compare.forget();
                held.name = format!("held: {}", held.name);
                self.compare.take(held, ui.ctx());
                self.compare.choice = Choice::Held;
            }
        });
        let chosen = if let Choice::Preset(preset) = &self.compare.choice { preset.clone() } else { "another preset".to_owned() };
        let list = ComboBox::from_id_salt("other").height(420.0).selected_text(chosen).show_ui(ui, |ui| {
            for (preset, text) in presets::all() {
                let choice = Choice::Preset(preset.to_owned());
                ui.selectable_value(&mut self.compare.choice, choice, preset).on_hover_text(presets::title(text));
            }
        });
        list.response.labelled_by(label);
        if self.compare.choice != before && self.compare.choice != Choice::Held {
            self.compare.forget();
        }
        if self.compare.choice == Choice::Nothing {
            return;
        }
        if self.compare.choice == Choice::Reference {
            let mut bounces = self.compare.bounces.unwrap_or(BOUNCES);
            ui.horizontal(|ui| {
                let label = ui.label("bounces of indirect light").id;
                ui.add(egui::DragValue::new(&mut bounces).range(0..=crate::reference::MOST_BOUNCES)).labelled_by(label);
            });
            self.compare.bounces = Some(bounces);
        }
        ui.separator();
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.compare.mode, Mode::Split, "split");
            ui.selectable_value(&mut self.compare.mode, Mode::Other, "the other");
            ui.selectable_value(&mut self.compare.mode, Mode::Difference, "FLIP");
        });
        if self.compare.mode == Mode::Split {
            let mut split = self.compare.split.unwrap_or(0.5);
            ui.add(egui::Slider::new(&mut split, 0.0..=1.0).text("line").show_value(false));
            self.compare.split = Some(split);
        }
        ui.separator();
        if let Some(other) = &self.compare.other {
            ui.label(RichText::new(&other.name).strong());
        } else {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label("waiting for the other picture");
            });
        }
        match &self.compare.figures {
            None => {}
            Some(Err(why)) => drop(ui.label(RichText::new(why).color(ui.visuals().error_fg_color))),
            Some(Ok(figures)) => {
                let row = |ui: &mut Ui, name: &str, figure: Option<f64>, hint: &str| {
                    ui.label(name).on_hover_text(hint);
                    ui.label(figure.map_or("-".to_owned(), |figure| format!("{figure:.4}")));
                    ui.end_row();
                };
                Grid::new("figures").num_columns(2).striped(true).show(ui, |ui| {
                    row(ui, "FLIP", figures.flip, "Mean of the difference that is seen when the pictures are flipped between, 0 to 1");
                    row(ui, "RMSE", Some(figures.rmse), "Of the shown pictures' linear colours, after exposure and tone mapping");
                    row(ui, "energy", figures.energy, "Mean luminance of the picture over that of the other one");
                });
                ui.label(RichText::new("Figures of the pictures as they are shown, tone-mapped to 8 bits").weak());
            }
        }
    }

    /// Keeps the comparison's figures up to date.
    pub(super) fn measure(&mut self, context: &Context) {
        if let Some(shown) = self.shown.as_ref().filter(|_| self.compare.choice != Choice::Nothing) {
            self.compare.measure(shown, context);
        }
    }
}

/// The frame's picture, if it was brought back.
fn picture_of(shown: &Shown) -> Option<Other> {
    let dump = shown.dumps.iter().find(|dump| (dump.pass, dump.resource.as_str()) == PICTURE)?;
    let texels = Texels::of(&dump.data)?;
    Some(Other { name: shown.request.project.config.display().to_string(), size: texels.size, image: texels.all().to_vec() })
}

fn compared(picture: &Other, other: &Other) -> Result<Compared> {
    let image = |of: &Other| {
        let values = of.image.chunks_exact(4).flat_map(|texel| [0, 1, 2].map(|c| srgb_to_linear(f32::from(texel[c]) / 255.0))).collect();
        Image::new(of.size[0] as usize, Content::Shown, &["R", "G", "B"], values)
    };
    let compared = metrics::compare(&image(picture)?, &image(other)?)?;
    let metrics::Measures { rmse, energy, flip, .. } = compared.measures;
    Ok(Compared { figures: Figures { rmse, energy, flip }, map: compared.map, size: picture.size.map(|side| side as usize) })
}
