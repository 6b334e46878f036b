//! Points that samples are drawn at: how a seed moves them, and the bases of Halton points.

use super::super::wants::Wants;
use crate::config::{Numbers, VplsConfig};
use crate::shader_struct;

shader_struct! {
    /// `glsl/vpls/params.glsl`.
    pub(super) struct TexelParams {
        pub size: [u32; 2],
        pub lights: u32,
        pub count: u32,
        pub shift: [f32; 4],
        pub bases: [u32; 4],
        pub start: u32,
        pub seed: u32,
    }
}

impl TexelParams {
    /// Parameters of a sampler of `count` chains with `steps` proposals each.
    pub(super) fn new(size: [u32; 2], lights: u32, count: u32, steps: u32, wants: &Wants) -> Self {
        let seed = wants.seed;
        Self {
            size,
            lights,
            count,
            shift: shift(seed),
            bases: bases(if steps > 1 { count } else { 1 }, wants.interleave.sets()),
            // Points go on where another seed's end.
            start: seed.wrapping_mul(count).wrapping_mul(steps),
            seed,
        }
    }
}

/// Part of the shaders that makes a config's points.
pub(super) fn part(config: &VplsConfig) -> &'static str {
    match config.numbers {
        Numbers::Halton => "vpls/points-halton",
        Numbers::ShiftedHalton => "vpls/points-shifted-halton",
        Numbers::Random => "vpls/points-random",
    }
}

/// Rotation of a point set modulo 1 by a seed, in [0, 1); none by seed 0.
pub(in crate::stages) fn shift(seed: u32) -> [f32; 4] {
    // Multiples of the inverses of the golden ratio of two dimensions and its square (Roberts 2018), then of the golden ratio and of the
    // silver one: seeds share out the unit square evenly, so a mean of few seeds is a good one.
    [0.754_877_666_246_692_8_f64, 0.569_840_290_998_053_3, 0.618_033_988_749_895, 0.414_213_562_373_095_1]
        .map(|step| (f64::from(seed) * step).fract() as f32)
        .map(|x| x.min(1.0 - f32::EPSILON / 2.0))
}

/// Bases of Halton points: the smallest primes that divide neither the number of chains nor that of the sample sets. A chain takes every
/// `chains`-th point, and a sample set every `sets`-th. In a base that divides such a stride, all of them would have the same digit.
fn bases(chains: u32, sets: u32) -> [u32; 4] {
    let prime = |n: &u32| (2..*n).all(|d| !n.is_multiple_of(d));
    let mut bases = (2..).filter(prime).filter(|base| !chains.is_multiple_of(*base) && !sets.is_multiple_of(*base));
    std::array::from_fn(|_| bases.next().expect("there are more primes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_divide_neither_the_chains_nor_the_sample_sets() {
        assert_eq!(bases(1024, 8), [3, 5, 7, 11]);
        assert_eq!(bases(1000, 8), [3, 7, 11, 13]);
        assert_eq!(bases(729, 1), [2, 5, 7, 11]);
        assert_eq!(bases(1, 1), [2, 3, 5, 7]);
        assert_eq!(bases(2 * 3 * 5 * 7, 16), [11, 13, 17, 19]);
    }

    /// `glsl/lib/halton.glsl`.
    fn radical_inverse(mut k: u32, base: u32) -> f64 {
        let (mut reversed, mut scale) = (0.0, 1.0);
        while k > 0 {
            (reversed, scale) = (reversed * f64::from(base) + f64::from(k % base), scale * f64::from(base));
            k /= base;
        }
        reversed / scale
    }

    #[test]
    fn most_chains_propose_several_lights_and_columns_whatever_their_number() {
        const STEPS: u32 = 5;
        for chains in [256, 512, 729, 1000, 1024] {
            let bases = bases(chains, 8);
            // Whole numbers of light, column and row, and tenths of the number that accepts.
            let scales = [6.0, 256.0, 256.0, 10.0];
            let proposes_several = |chain: &u32| {
                let proposals = |axis: usize| -> std::collections::BTreeSet<u32> {
                    (0..STEPS).map(|step| (radical_inverse(chain + step * chains + 1, bases[axis]) * scales[axis]) as u32).collect()
                };
                (0..4).all(|axis| proposals(axis).len() >= 2)
            };
            let several = (0..chains).filter(proposes_several).count();
            assert!(several * 2 > chains as usize, "{several} of {chains} chains propose several, in bases {bases:?}");
        }
    }

    #[test]
    fn seeds_rotate_points_evenly_and_seed_0_leaves_them() {
        assert_eq!(shift(0), [0.0; 4]);
        let shifts: Vec<[f32; 4]> = (0..64).map(shift).collect();
        for axis in 0..4 {
            let mut along: Vec<f32> = shifts.iter().map(|shift| shift[axis]).collect();
            along.sort_by(f32::total_cmp);
            assert!(along.windows(2).all(|pair| pair[1] - pair[0] < 4.0 / 64.0), "axis {axis}: {along:?}");
        }
        assert!(shift(u32::MAX).iter().all(|x| (0.0..1.0).contains(x)));
    }
}
