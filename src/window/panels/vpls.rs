//! The VPLs over what is shown, and the shadow map of the one under the pointer.

use super::Panels;
use crate::color::{linear_to_srgb8, luminance};
use crate::inspection::{BounceVpls, PlacedVpl, VplMaps};
use crate::metrics::heatmap;
use crate::window::DEPTH;
use crate::window::look::Texels;
use crate::window::mailbox::Shown;
use egui::{Color32, ColorImage, Painter, Pos2, Rect, Response, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, Vec2, pos2};
use glam::Vec3;

/// What a VPL's colour tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tells {
    /// The colour of its light.
    #[default]
    Light,
    /// The bounce that it is of.
    Bounce,
    /// The shadow map that it shares with others, or its cluster.
    Map,
}

impl Tells {
    pub fn name(self) -> &'static str {
        match self {
            Self::Light => "their light",
            Self::Bounce => "bounce",
            Self::Map => "shadow map or cluster",
        }
    }
}

/// State of the VPLs over the picture.
#[derive(Default)]
pub struct Overlay {
    pub shows: bool,
    pub tells: Tells,
    /// VPLs of the last frame that had them: those of a moving camera are of the frame before it.
    bounces: Vec<BounceVpls>,
    /// The map that the texture shows: bounce, map.
    tile: Option<(usize, u32)>,
    texture: Option<TextureHandle>,
}

/// VPLs that are drawn at most; more would hide the picture.
const MOST_DRAWN: usize = 16_384;
/// Radii of the dimmest and of the brightest VPL, points.
const RADII: [f32; 2] = [1.2, 7.0];
/// Distance to the pointer within which a VPL is pointed at, points.
const REACH: f32 = 9.0;
/// Share of the distance by which a VPL may lie behind the surface in sight and still be on it.
const BEHIND: f64 = 0.02;

/// A VPL on the screen.
struct Drawn<'o> {
    bounce: usize,
    index: usize,
    vpl: &'o PlacedVpl,
    at: Pos2,
    is_hidden: bool,
}

impl Overlay {
    /// Takes over the VPLs of a frame, if it has them.
    pub fn take(&mut self, shown: &mut Shown) {
        if !shown.inspected.bounces.is_empty() || !self.shows {
            self.bounces = std::mem::take(&mut shown.inspected.bounces);
            self.tile = None;
        }
    }

    /// VPLs in sight, of a picture that takes `place`.
    fn drawn(&self, shown: &Shown, place: Rect) -> Vec<Drawn<'_>> {
        let (view, depth) = (&shown.view, depth_of(shown));
        let count: usize = self.bounces.iter().map(|bounce| bounce.vpls.len()).sum();
        let step = count.div_ceil(MOST_DRAWN).max(1);
        let all =
            self.bounces.iter().zip(1..).flat_map(|(bounce, number)| bounce.vpls.iter().enumerate().map(move |(i, vpl)| (number, i, vpl)));
        let drawn = |(bounce, index, vpl): (usize, usize, &'_ PlacedVpl)| {
            let (pixel, distance) = view.pixel_of(vpl.position)?;
            let size = [view.width, view.height].map(f64::from);
            if vpl.intensity == Vec3::ZERO || pixel.x < 0.0 || pixel.y < 0.0 || pixel.x >= size[0] || pixel.y >= size[1] {
                return None;
            }
            let surface = depth.as_ref().and_then(|depth| depth.at(pixel.x as u32, pixel.y as u32, 0)).map_or(0.0, |value| value[0]);
            let is_hidden = surface > 0.0 && distance * (1.0 - BEHIND) > f64::from(view.near / surface);
            let at =
                pos2(place.min.x + (pixel.x / size[0]) as f32 * place.width(), place.min.y + (pixel.y / size[1]) as f32 * place.height());
            Some((bounce, index, at, is_hidden))
        };
        all.step_by(step)
            .filter_map(|(bounce, index, vpl)| {
                let (bounce, index, at, is_hidden) = drawn((bounce, index, vpl))?;
                Some(Drawn { bounce, index, vpl, at, is_hidden })
            })
            .collect()
    }

    fn color(&self, vpl: &PlacedVpl, bounce: usize) -> Color32 {
        match self.tells {
            Tells::Light => {
                let brightest = vpl.intensity.max_element().max(1e-20);
                let [r, g, b] = (vpl.intensity / brightest).to_array().map(|value| linear_to_srgb8(f64::from(value)));
                Color32::from_rgb(r, g, b)
            }
            Tells::Bounce => told_apart(bounce as u32 - 1),
            Tells::Map => vpl.map.map_or(Color32::GRAY, told_apart),
        }
    }

    /// The maps of a bounce, from 1.
    fn maps(&self, bounce: usize) -> Option<&VplMaps> {
        self.bounces.get(bounce - 1)?.maps.as_ref()
    }

    /// The texture of a map.
    fn texture(&mut self, ui: &Ui, bounce: usize, map: u32) -> Option<TextureHandle> {
        if self.tile != Some((bounce, map)) {
            let maps = self.maps(bounce)?;
            let image = picture_of(maps, map)?;
            match &mut self.texture {
                Some(texture) => texture.set(image, TextureOptions::NEAREST),
                None => self.texture = Some(ui.ctx().load_texture("shadow map", image, TextureOptions::NEAREST)),
            }
            self.tile = Some((bounce, map));
        }
        self.texture.clone()
    }
}

/// Colours that are told apart, by number.
fn told_apart(number: u32) -> Color32 {
    // The golden ratio spreads hues for any number of them.
    let hue = (number as f32 * 0.618_034).fract();
    egui::ecolor::Hsva::new(hue, 0.75, 1.0, 1.0).into()
}

fn depth_of(shown: &Shown) -> Option<Texels<'_>> {
    let dump = shown.dumps.iter().find(|dump| (dump.pass, dump.resource.as_str()) == DEPTH)?;
    Texels::of(&dump.data)
}

/// A map in false colours over the range of its distances; grey where it sees nothing.
fn picture_of(maps: &VplMaps, map: u32) -> Option<ColorImage> {
    let texels = maps.map(map)?;
    let most = texels.iter().copied().filter(|value| *value < 1.0).fold(1e-6, f32::max);
    let colors = heatmap(&texels.iter().map(|value| (value / most).min(1.0)).collect::<Vec<_>>());
    let color = |(value, color): (&f32, &[u8])| match *value < 1.0 {
        true => Color32::from_rgb(color[0], color[1], color[2]),
        false => Color32::from_gray(40),
    };
    let pixels = texels.iter().zip(colors.chunks_exact(3)).map(color).collect();
    Some(ColorImage::new([maps.size as usize; 2], pixels))
}

impl Panels {
    /// Draws the VPLs over the picture that takes `place`, and tells of the one under the pointer.
    pub(super) fn vpls(&mut self, ui: &Ui, response: &Response, painter: &Painter, place: Rect) {
        let (true, Some(shown)) = (self.overlay.shows, &self.shown) else { return };
        let size = self.texels().map_or([0; 2], |texels| texels.size);
        if size != [shown.view.width, shown.view.height] {
            self.map_under_pointer(response, painter, place, size);
            return;
        }
        let overlay = &self.overlay;
        let drawn = overlay.drawn(shown, place);
        let power = |vpl: &PlacedVpl| luminance(&vpl.intensity.to_array()).max(0.0) as f32;
        let most = drawn.iter().map(|drawn| power(drawn.vpl)).fold(1e-20, f32::max);
        let mut pointed: Option<(f32, &Drawn<'_>)> = None;
        for one in &drawn {
            let radius = RADII[0] + (RADII[1] - RADII[0]) * (power(one.vpl) / most).sqrt();
            let color = overlay.color(one.vpl, one.bounce);
            if one.is_hidden {
                painter.circle_stroke(one.at, radius, (1.0, color.gamma_multiply(0.35)));
            } else {
                painter.circle(one.at, radius, color, (1.0, Color32::BLACK));
            }
            let away = response.hover_pos().map_or(f32::MAX, |pointer| pointer.distance(one.at));
            if away < REACH && !one.is_hidden && pointed.is_none_or(|(nearest, _)| away < nearest) {
                pointed = Some((away, one));
            }
        }
        let Some((_, one)) = pointed else { return };
        painter.circle_stroke(one.at, RADII[1] + 3.0, (2.0, Color32::WHITE));
        let (bounce, index, vpl) = (one.bounce, one.index, *one.vpl);
        let shares = |map: u32| self.overlay.bounces[bounce - 1].vpls.iter().filter(|other| other.map == Some(map)).count();
        let shared = vpl.map.map(|map| (map, shares(map)));
        let texture = vpl.map.and_then(|map| self.overlay.texture(ui, bounce, map));
        response.clone().on_hover_ui_at_pointer(|ui| {
            ui.label(format!("VPL {index}{}", if bounce == 1 { String::new() } else { format!(" of bounce {bounce}") }));
            let Vec3 { x, y, z } = vpl.intensity;
            ui.label(format!("{x:.4}, {y:.4}, {z:.4} W/sr"));
            if let (Some((map, shared)), Some(texture)) = (shared, texture) {
                ui.label(if shared > 1 { format!("map {map}, of {shared} VPLs") } else { format!("map {map}") });
                ui.image((texture.id(), Vec2::splat(160.0)));
            }
        });
    }

    /// Tells of the map under the pointer, if the image that is shown is that of the maps.
    fn map_under_pointer(&self, response: &Response, painter: &Painter, place: Rect, size: [u32; 2]) {
        let Some([x, y]) = self.under_cursor.filter(|_| response.hovered()) else { return };
        let of_bounces = self.overlay.bounces.iter().zip(1..);
        let Some((maps, bounce)) =
            of_bounces.filter_map(|(of, bounce)| Some((of.maps.as_ref()?, bounce))).find(|(maps, _)| maps.image == size)
        else {
            return;
        };
        let map = if maps.image == [maps.size; 2] { self.look.layer } else { maps.map_at([x, y]) };
        let ([left, top], _) = maps.corner(map);
        let scale = place.width() / size[0] as f32;
        let tile = Rect::from_min_size(place.min + Vec2::new(left as f32, top as f32) * scale, Vec2::splat(maps.size as f32 * scale));
        painter.rect_stroke(tile, 0.0, Stroke::new(1.5, Color32::WHITE), StrokeKind::Outside);
        let of: Vec<usize> =
            self.overlay.bounces[bounce - 1].vpls.iter().enumerate().filter(|(_, vpl)| vpl.map == Some(map)).map(|(i, _)| i).collect();
        let text = match of.as_slice() {
            [] => format!("map {map}, of no VPL"),
            [vpl] => format!("map {map}, of VPL {vpl}"),
            vpls => format!("map {map}, of {} VPLs", vpls.len()),
        };
        response.clone().on_hover_text_at_pointer(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_shown_by_its_own_distances() {
        let maps = VplMaps { image: [4, 2], size: 2, columns: 2, texels: vec![0.5, 0.5, 0.1, 0.2, 0.5, 0.5, 0.2, 1.0] };
        let picture = picture_of(&maps, 1).unwrap();
        assert_eq!(picture.size, [2, 2]);
        assert_eq!((picture.pixels[1], picture.pixels[3]), (picture.pixels[2], Color32::from_gray(40)));
        assert_ne!(picture.pixels[0], picture.pixels[1]);
        assert!(picture_of(&maps, 2).is_none());
    }
}
