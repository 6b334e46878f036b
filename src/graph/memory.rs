//! Memory of a frame's resources.

use super::{Graph, Resource, Source};

impl Graph {
    /// Bytes of each of the frame's own resources by name, in the order of description: texels of all layers, or elements, without the
    /// device's overhead. Imported resources and kept buffers, such as the scene's, are not the frame's own.
    pub fn memory(&self) -> Vec<(String, u64)> {
        let is_own = |source: &Source| !matches!(source, Source::ImportedBuffer(_) | Source::ImportedImage(_) | Source::KeptBuffer(_));
        let own = self.slots.iter().filter(|slot| is_own(&slot.source));
        own.map(|slot| (slot.name.clone(), self.bytes(slot.resource))).collect()
    }

    /// Bytes of a resource's texels or elements.
    pub(super) fn bytes(&self, resource: Resource) -> u64 {
        match resource {
            Resource::Image(image) => {
                let [width, height] = image.size.map(u64::from);
                width * height * u64::from(image.layers) * image.format.texel_bytes() as u64
            }
            Resource::Buffer(buffer) => self.buffer_bytes(buffer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::Format;

    #[test]
    fn a_resource_takes_its_texels_of_all_layers_or_its_elements() {
        let mut g = Graph::new();
        g.layered_image("rsm/flux", Format::Rgba32Float, [8, 4], 3);
        g.image("gbuffer/normal", Format::Rg16Snorm, [64, 64]);
        g.buffer::<[f32; 3]>("vpls/intensities", 5);
        g.upload("gbuffer/arguments", &[0u32; 10]);
        g.count("vpls/lit");
        let expected = [
            ("rsm/flux", 8 * 4 * 3 * 16),
            ("gbuffer/normal", 64 * 64 * 4),
            ("vpls/intensities", 60),
            ("gbuffer/arguments", 40),
            ("vpls/lit", 4),
        ];
        assert_eq!(g.memory(), expected.map(|(name, bytes)| (name.to_owned(), bytes)));
    }
}
