//! Random numbers and periodic noise. Both are functions of their arguments alone, so that a scene has the same bytes in every
//! run.

/// A well-mixed 32-bit hash (the finalizer of MurmurHash3 over a multiplied combination).
pub fn hash(x: u32, y: u32, seed: u32) -> u32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77).rotate_left(13) ^ seed.wrapping_mul(0xc2b2_ae3d);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}

/// Random number in [0, 1) of a lattice point.
pub fn unit(x: u32, y: u32, seed: u32) -> f32 {
    (hash(x, y, seed) >> 8) as f32 / (1 << 24) as f32
}

/// A sequence of random numbers.
pub struct Random {
    seed: u32,
    next: u32,
}

impl Random {
    pub fn new(seed: u32) -> Self {
        Self { seed, next: 0 }
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        self.next += 1;
        unit(self.next, 0x5bd1, self.seed)
    }

    pub fn range(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.unit()
    }
}

/// A square tile of periodic fractal value noise in [0, 1] with mean near one half, made once and looked up often.
pub struct Tile {
    /// A power of two: textures look up noise many million times, and a remainder would take longer than all else.
    size: usize,
    values: Vec<f32>,
}

impl Tile {
    /// Fractal noise with `cells` lattice cells across the lowest octave. Each further octave has twice as many, weighted by
    /// `gain`.
    pub fn fractal(size: usize, cells: usize, octaves: usize, gain: f32, seed: u32) -> Self {
        use rayon::prelude::*;
        assert!(size.is_power_of_two());
        let mut values = vec![0.0f32; size * size];
        let total: f32 = (0..octaves).map(|o| gain.powi(o as i32)).sum();
        values.par_chunks_mut(size).enumerate().for_each(|(y, row)| {
            for octave in 0..octaves {
                let n = cells << octave;
                if n > size {
                    break;
                }
                let weight = gain.powi(octave as i32) / total;
                let step = n as f32 / size as f32;
                let fy = y as f32 * step;
                let (y0, ty) = (fy as usize, smooth(fy.fract()));
                let y1 = (y0 + 1) % n;
                let salt = seed.wrapping_add(octave as u32 * 977);
                let corner = |x: usize| {
                    let x = (x % n) as u32;
                    let (a, b) = (unit(x, y0 as u32, salt), unit(x, y1 as u32, salt));
                    a + (b - a) * ty
                };
                let (mut cell, mut left, mut right) = (0, corner(0), corner(1));
                for (x, value) in row.iter_mut().enumerate() {
                    let fx = x as f32 * step;
                    if fx as usize != cell {
                        cell = fx as usize;
                        (left, right) = (right, corner(cell + 1));
                    }
                    *value += weight * (left + (right - left) * smooth(fx.fract()));
                }
            }
        });
        Self { size, values }
    }

    /// Value at a texel of the repeated tile.
    pub fn texel(&self, x: usize, y: usize) -> f32 {
        let mask = self.size - 1;
        self.values[(y & mask) * self.size + (x & mask)]
    }
}

/// Cubic smoothstep of [0, 1].
pub fn smooth(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// Smoothstep: 0 up to `from`, 1 from `to` on.
pub fn step(from: f32, to: f32, x: f32) -> f32 {
    smooth(((x - from) / (to - from)).clamp(0.0, 1.0))
}
