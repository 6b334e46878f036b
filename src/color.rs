//! sRGB encoding and decoding, and luminance.

/// Luminance of a linear sRGB colour (Rec. 709).
pub fn luminance(rgb: &[f32]) -> f64 {
    0.2126 * f64::from(rgb[0]) + 0.7152 * f64::from(rgb[1]) + 0.0722 * f64::from(rgb[2])
}

/// Linear value of an sRGB value, both from 0 to 1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    let encoded = f64::from(encoded);
    (if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }) as f32
}

/// sRGB byte of a linear value, clamped to 0 to 1.
pub fn linear_to_srgb8(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_to_light_and_back() {
        for byte in 0..=255 {
            assert_eq!(linear_to_srgb8(f64::from(srgb_to_linear(f32::from(byte) / 255.0))), byte);
        }
    }

    #[test]
    fn srgb_has_its_known_values() {
        assert_eq!((srgb_to_linear(0.0), srgb_to_linear(1.0)), (0.0, 1.0));
        assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-6);
        assert_eq!([-1.0, 0.215_861, 7.0].map(linear_to_srgb8), [0, 128, 255]);
        assert_eq!(luminance(&[1.0; 3]), 1.0);
    }
}
