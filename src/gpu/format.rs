//! Texel formats: size, meaning, and decoding to numbers for files and tests.

use crate::color::srgb_to_linear;
use ash::vk;
use half::f16;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    R8Unorm,
    Rg8Unorm,
    Rgba8Unorm,
    /// sRGB-encoded RGB, linear when sampled.
    Rgba8Srgb,
    Rg16Snorm,
    Rgba16Float,
    /// Unsigned floats of 11, 11 and 10 bits: radiance without alpha.
    R11G11B10Float,
    R32Uint,
    /// Two words of data other than colour.
    Rg32Uint,
    R32Float,
    Rg32Float,
    Rgba32Float,
    /// Four words of data other than colour.
    Rgba32Uint,
    Depth32,
}

impl Format {
    /// Bytes of one texel.
    pub fn texel_bytes(self) -> usize {
        match self {
            Self::R8Unorm => 1,
            Self::Rg8Unorm => 2,
            Self::Rgba8Unorm | Self::Rgba8Srgb | Self::Rg16Snorm | Self::R11G11B10Float => 4,
            Self::R32Uint | Self::R32Float | Self::Depth32 => 4,
            Self::Rgba16Float | Self::Rg32Float | Self::Rg32Uint => 8,
            Self::Rgba32Float | Self::Rgba32Uint => 16,
        }
    }

    /// Channels of one texel.
    pub fn channels(self) -> usize {
        match self {
            Self::R8Unorm | Self::R32Uint | Self::R32Float | Self::Depth32 => 1,
            Self::Rg8Unorm | Self::Rg16Snorm | Self::Rg32Float | Self::Rg32Uint => 2,
            Self::R11G11B10Float => 3,
            Self::Rgba8Unorm | Self::Rgba8Srgb | Self::Rgba16Float | Self::Rgba32Float | Self::Rgba32Uint => 4,
        }
    }

    /// Whether texels can be infinite or NaN.
    pub fn is_float(self) -> bool {
        matches!(self, Self::Rgba16Float | Self::R11G11B10Float | Self::R32Float | Self::Rg32Float | Self::Rgba32Float | Self::Depth32)
    }

    pub fn is_depth(self) -> bool {
        self == Self::Depth32
    }

    /// Values of one texel as a shader reads them; channels that the format lacks are 0. Integers are converted to floats.
    pub fn decode(self, texel: &[u8]) -> [f32; 4] {
        let word = |i: usize| u32::from_le_bytes([texel[4 * i], texel[4 * i + 1], texel[4 * i + 2], texel[4 * i + 3]]);
        let short = |i: usize| u16::from_le_bytes([texel[2 * i], texel[2 * i + 1]]);
        let unorm = |i: usize| f32::from(texel[i]) / 255.0;
        match self {
            Self::R8Unorm => [unorm(0), 0.0, 0.0, 0.0],
            Self::Rg8Unorm => [unorm(0), unorm(1), 0.0, 0.0],
            Self::Rgba8Unorm => [unorm(0), unorm(1), unorm(2), unorm(3)],
            Self::Rgba8Srgb => [srgb_to_linear(unorm(0)), srgb_to_linear(unorm(1)), srgb_to_linear(unorm(2)), unorm(3)],
            Self::Rg16Snorm => [0, 1].map(|i| (f32::from(short(i) as i16) / 32767.0).max(-1.0)).with_zeros(),
            Self::Rgba16Float => [0, 1, 2, 3].map(|i| f16::from_bits(short(i)).to_f32()),
            Self::R11G11B10Float => {
                let bits = word(0);
                // An unsigned small float is a half without sign and without the mantissa's last bits.
                let small = |value: u32, mantissa: u32| f16::from_bits((value << (10 - mantissa)) as u16).to_f32();
                [small(bits & 0x7ff, 6), small(bits >> 11 & 0x7ff, 6), small(bits >> 22, 5), 0.0]
            }
            Self::R32Uint => [word(0) as f32, 0.0, 0.0, 0.0],
            Self::Rg32Uint => [0, 1].map(|i| word(i) as f32).with_zeros(),
            Self::R32Float | Self::Depth32 => [f32::from_bits(word(0)), 0.0, 0.0, 0.0],
            Self::Rg32Float => [0, 1].map(|i| f32::from_bits(word(i))).with_zeros(),
            Self::Rgba32Float => [0, 1, 2, 3].map(|i| f32::from_bits(word(i))),
            Self::Rgba32Uint => [0, 1, 2, 3].map(|i| word(i) as f32),
        }
    }

    pub(super) fn vk(self) -> vk::Format {
        match self {
            Self::R8Unorm => vk::Format::R8_UNORM,
            Self::Rg8Unorm => vk::Format::R8G8_UNORM,
            Self::Rgba8Unorm => vk::Format::R8G8B8A8_UNORM,
            Self::Rgba8Srgb => vk::Format::R8G8B8A8_SRGB,
            Self::Rg16Snorm => vk::Format::R16G16_SNORM,
            Self::Rgba16Float => vk::Format::R16G16B16A16_SFLOAT,
            Self::R11G11B10Float => vk::Format::B10G11R11_UFLOAT_PACK32,
            Self::R32Uint => vk::Format::R32_UINT,
            Self::Rg32Uint => vk::Format::R32G32_UINT,
            Self::R32Float => vk::Format::R32_SFLOAT,
            Self::Rg32Float => vk::Format::R32G32_SFLOAT,
            Self::Rgba32Float => vk::Format::R32G32B32A32_SFLOAT,
            Self::Rgba32Uint => vk::Format::R32G32B32A32_UINT,
            Self::Depth32 => vk::Format::D32_SFLOAT,
        }
    }

    pub(super) fn aspect(self) -> vk::ImageAspectFlags {
        if self.is_depth() { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR }
    }
}

trait WithZeros {
    fn with_zeros(self) -> [f32; 4];
}

impl WithZeros for [f32; 2] {
    fn with_zeros(self) -> [f32; 4] {
        [self[0], self[1], 0.0, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_decode_to_the_numbers_that_they_stand_for() {
        let cases: [(Format, Vec<u8>, [f32; 4]); 6] = [
            (Format::Rg16Snorm, vec![0xff, 0x7f, 0x01, 0x80], [1.0, -1.0, 0.0, 0.0]),
            (Format::Rgba16Float, vec![0, 0x3c, 0, 0xbc, 0, 0, 0, 0x40], [1.0, -1.0, 0.0, 2.0]),
            // 1.0 in 11 bits is exponent 15, mantissa 0: 0x3c0; in 10 bits 0x1e0.
            (Format::R11G11B10Float, (0x3c0u32 | 0x3c0 << 11 | 0x1e0 << 22).to_le_bytes().to_vec(), [1.0, 1.0, 1.0, 0.0]),
            (Format::Rgba8Unorm, vec![0, 51, 255, 102], [0.0, 0.2, 1.0, 0.4]),
            (Format::Rgba8Srgb, vec![0, 255, 0, 255], [0.0, 1.0, 0.0, 1.0]),
            (Format::Rg32Float, [1.5f32.to_le_bytes(), (-2.0f32).to_le_bytes()].concat(), [1.5, -2.0, 0.0, 0.0]),
        ];
        for (format, bytes, expected) in cases {
            assert_eq!(bytes.len(), format.texel_bytes());
            let decoded = format.decode(&bytes);
            assert!(decoded.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{format:?}: {decoded:?}");
        }
    }
}
