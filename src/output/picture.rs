//! A frame's images on the host, decoded to numbers.

use super::exr::{ExrLayer, Precision};
use crate::config::Layer;
use crate::gpu::Format;
use crate::scene::pack::octahedral_inverse;
use crate::world::projection::View;
use glam::{Vec2, Vec3};

/// A frame's images on the host, row by row from the top.
pub struct Picture {
    pub size: [u32; 2],
    pub view: View,
    /// sRGB-encoded RGBA bytes.
    pub image: Vec<u8>,
    pub radiance: Plane,
    pub direct: Plane,
    pub indirect: Plane,
    pub irradiance: Plane,
    pub albedo: Plane,
    pub normal: Plane,
    pub depth: Plane,
}

/// Texels of one image, decoded to the format's channels.
pub struct Plane {
    pub channels: usize,
    pub values: Vec<f32>,
}

impl Plane {
    /// Decodes texels of a format.
    pub fn decode(format: Format, bytes: &[u8]) -> Self {
        let channels = format.channels();
        let values = bytes.chunks_exact(format.texel_bytes()).flat_map(|texel| format.decode(texel).into_iter().take(channels)).collect();
        Self { channels, values }
    }

    /// The channels of a pixel by its index; missing channels are 0.
    pub fn at(&self, pixel: usize) -> [f32; 4] {
        let mut texel = [0.0; 4];
        texel[..self.channels].copy_from_slice(&self.values[pixel * self.channels..][..self.channels]);
        texel
    }

    /// The first three channels of every pixel.
    pub fn rgb(&self) -> impl Iterator<Item = Vec3> {
        (0..self.values.len() / self.channels).map(|pixel| {
            let [r, g, b, _] = self.at(pixel);
            Vec3::new(r, g, b)
        })
    }
}

impl Picture {
    /// World position of each pixel's surface; the origin for pixels without surface.
    pub fn positions(&self) -> Vec<Vec3> {
        let width = self.size[0];
        let position = |(i, depth): (usize, &f32)| {
            if *depth > 0.0 { self.view.position_at(i as u32 % width, i as u32 / width, *depth) } else { Vec3::ZERO }
        };
        self.depth.values.iter().enumerate().map(position).collect()
    }

    /// Distance of each pixel's surface along the view's axis, m; 0 for pixels without surface.
    pub fn distances(&self) -> Vec<f32> {
        self.depth.values.iter().map(|depth| if *depth > 0.0 { self.view.near / depth } else { 0.0 }).collect()
    }

    /// World normal of each pixel's surface; zero for pixels without surface.
    pub fn normals(&self) -> Vec<Vec3> {
        let normal = |(i, depth): (usize, &f32)| {
            let [x, y, ..] = self.normal.at(i);
            if *depth > 0.0 { octahedral_inverse(Vec2::new(x, y)) } else { Vec3::ZERO }
        };
        self.depth.values.iter().enumerate().map(normal).collect()
    }

    /// The layers of the frame's EXR: radiance without a name, then those in `wanted`.
    pub fn layers(&self, wanted: &[Layer]) -> Vec<ExrLayer> {
        let color = |name: &str, plane: &Plane| ExrLayer::interleaved(name, "RGB", plane.channels, &plane.values, Precision::Half);
        let radiance = &self.radiance;
        let mut layers = vec![ExrLayer::interleaved("", "RGBA", radiance.channels, &radiance.values, Precision::Half)];
        let vectors = |name: &str, vectors: Vec<Vec3>| {
            let values: Vec<f32> = vectors.iter().flat_map(|v| v.to_array()).collect();
            ExrLayer::interleaved(name, "XYZ", 3, &values, Precision::Float)
        };
        layers.extend(wanted.iter().map(|layer| match layer {
            Layer::Direct => color("direct", &self.direct),
            Layer::Indirect => color("indirect", &self.indirect),
            Layer::Irradiance => color("irradiance", &self.irradiance),
            Layer::Albedo => color("albedo", &self.albedo),
            Layer::Normal => vectors("N", self.normals()),
            Layer::Position => vectors("P", self.positions()),
            Layer::Depth => ExrLayer::interleaved("", "Z", 1, &self.distances(), Precision::Float),
        }));
        layers
    }
}
