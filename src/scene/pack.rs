//! Packing of vertex attributes. The shaders' inverses are in `glsl/lib/packing.glsl`.

use glam::{Vec2, Vec3};

/// Maps a unit vector to the square [-1, 1]^2 by the octahedral mapping (Cigolle et al. 2014).
pub fn octahedral(v: Vec3) -> Vec2 {
    let p = Vec2::new(v.x, v.y) / (v.x.abs() + v.y.abs() + v.z.abs());
    if v.z >= 0.0 { p } else { (Vec2::ONE - Vec2::new(p.y.abs(), p.x.abs())) * sign(p) }
}

/// The unit vector of a point of the octahedral square.
pub fn octahedral_inverse(p: Vec2) -> Vec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let xy = if z >= 0.0 { p } else { (Vec2::ONE - Vec2::new(p.y.abs(), p.x.abs())) * sign(p) };
    Vec3::new(xy.x, xy.y, z).normalize()
}

fn sign(p: Vec2) -> Vec2 {
    Vec2::new(if p.x >= 0.0 { 1.0 } else { -1.0 }, if p.y >= 0.0 { 1.0 } else { -1.0 })
}

/// A unit vector as two octahedral coordinates, signed normalized 16-bit numbers, x in the low half.
pub fn octahedral_snorm16(v: Vec3) -> u32 {
    let p = (octahedral(v).clamp(Vec2::NEG_ONE, Vec2::ONE) * 32767.0).round();
    u32::from(p.x as i16 as u16) | u32::from(p.y as i16 as u16) << 16
}

/// The unit vector packed by [`octahedral_snorm16`].
pub fn octahedral_snorm16_inverse(packed: u32) -> Vec3 {
    let p = Vec2::new((packed as u16 as i16) as f32, ((packed >> 16) as u16 as i16) as f32) / 32767.0;
    octahedral_inverse(p.clamp(Vec2::NEG_ONE, Vec2::ONE))
}

/// Four numbers in [0, 1] as unsigned normalized bytes, the first in the lowest byte.
pub fn unorm8x4(v: [f32; 4]) -> u32 {
    u32::from_le_bytes(v.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8))
}

/// A unit tangent and its handedness (`bitangent = handedness * cross(normal, tangent)`): two octahedral coordinates of 15 bits
/// each, unsigned normalized, x lowest; bit 31 is set if the handedness is negative.
pub fn tangent(v: Vec3, handedness: f32) -> u32 {
    let p = ((octahedral(v).clamp(Vec2::NEG_ONE, Vec2::ONE) * 0.5 + 0.5) * 32767.0).round();
    p.x as u32 | (p.y as u32) << 15 | u32::from(handedness < 0.0) << 31
}

/// The unit tangent and the handedness packed by [`tangent`].
pub fn tangent_inverse(packed: u32) -> (Vec3, f32) {
    let p = Vec2::new((packed & 0x7fff) as f32, (packed >> 15 & 0x7fff) as f32) / 32767.0 * 2.0 - 1.0;
    (octahedral_inverse(p), if packed >> 31 != 0 { -1.0 } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_directions_come_back_to_a_ten_thousandth() {
        for i in 0..10_000 {
            // Points of a spherical Fibonacci set, in every octant and near both poles.
            let z = 1.0 - (2.0 * i as f32 + 1.0) / 10_000.0;
            let phi = i as f32 * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            let v = Vec3::new(r * phi.cos(), r * phi.sin(), z);
            let back = octahedral_snorm16_inverse(octahedral_snorm16(v));
            assert!(v.distance(back) < 1e-4, "{v} came back as {back}");
        }
        for (v, w) in [(Vec3::new(0.6, 0.0, -0.8), -1.0), (Vec3::Y, 1.0)] {
            let (back, handedness) = tangent_inverse(tangent(v, w));
            assert!(v.distance(back) < 2e-4 && handedness == w, "{v} came back as {back}");
        }
        for v in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
            assert!(v.distance(octahedral_snorm16_inverse(octahedral_snorm16(v))) < 1e-6);
        }
    }
}
