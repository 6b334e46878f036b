//! Influences of joints and displacements of morph targets, from accessors.

use super::accessors::Attribute;
use super::bends::{BendKey, Bends, Influenced};
use super::geometry::read;
use super::{Warning, Warnings, refuse};
use crate::scene::Vertex;
use crate::scene::bend::{Delta, Influences};
use anyhow::{Context, Result};
use glam::Vec3;

/// Limit of displacements, over all targets: a small file in which many targets share accessors would fill the memory.
const MAX_DELTAS: usize = 1 << 24;

impl Bends<'_> {
    pub(super) fn influences(
        &mut self,
        key: &BendKey,
        (count, sources): (usize, &[u32]),
        warnings: &mut Warnings,
    ) -> Result<Option<Influenced>> {
        let mut most = (0, 0);
        if key.sets.is_empty() {
            return Ok(None);
        }
        let mut sets = Vec::new();
        for ([joints, weights], set) in key.sets.iter().zip(0..) {
            let joints: Vec<[f32; 4]> = read(self.file, Some(*joints), Attribute::Joints(set), Some(count))?;
            let weights: Vec<[f32; 4]> = read(self.file, Some(*weights), Attribute::Weights(set), Some(count))?;
            if let Some(bad) = weights.iter().position(|weights| weights.iter().any(|weight| *weight < 0.0)) {
                refuse!("WEIGHTS_{set} of vertex {bad} are {:?}, weights cannot be below 0", weights[bad]);
            }
            sets.push((joints, weights));
        }
        // A second set without weights would cost time for nothing.
        if sets.len() > 1 && sets[1].1.as_flattened().iter().all(|weight| *weight == 0.0) {
            sets.truncate(1);
        }
        let first = self.made.influences.len() as u32;
        let mut weightless = 0;
        for vertex in sources.iter().map(|source| *source as usize) {
            let joints: Vec<u16> = sets.iter().flat_map(|(joints, _)| joints[vertex]).map(|joint| joint as u16).collect();
            let weights: Vec<f32> = sets.iter().flat_map(|(_, weights)| weights[vertex]).collect();
            let shares = shares(&weights).unwrap_or_else(|| {
                weightless += 1;
                std::iter::once(65535).chain(std::iter::repeat(0)).take(weights.len()).collect()
            });
            // A joint without a weight may be any number; the device reads its matrix.
            let joints: Vec<u16> = joints.iter().zip(&shares).map(|(joint, share)| if *share > 0 { *joint } else { 0 }).collect();
            most = joints.iter().fold(most, |most, joint| if *joint > most.0 { (*joint, vertex) } else { most });
            let fours = joints.as_chunks().0.iter().zip(shares.as_chunks().0);
            self.made.influences.extend(fours.map(|(joints, weights)| Influences { joints: *joints, weights: *weights }));
        }
        if weightless > 0 {
            warnings.add(Warning::Weightless, "some vertices have a skin and no weights: they follow the first of their joints");
        }
        Ok(Some(Influenced { first, fours: sets.len() as u32, most }))
    }

    pub(super) fn deltas(
        &mut self,
        key: &BendKey,
        vertices: &[Vertex],
        (count, sources): (usize, &[u32]),
    ) -> Result<Option<(u32, usize, bool)>> {
        if key.targets.is_empty() {
            return Ok(None);
        }
        let first = self.made.deltas.len();
        if key.targets.len().saturating_mul(vertices.len()).saturating_add(first) > MAX_DELTAS {
            refuse!("with it, the morph targets displace more than {MAX_DELTAS} vertices");
        }
        for (target, [positions, normals]) in key.targets.iter().enumerate() {
            let context = || format!("target {target}");
            let positions: Vec<[f32; 3]> = read(self.file, *positions, Attribute::Position, Some(count)).with_context(context)?;
            let normals: Vec<[f32; 3]> = read(self.file, *normals, Attribute::Normal, Some(count)).with_context(context)?;
            let at = |all: &[[f32; 3]], source: u32| all.get(source as usize).copied().unwrap_or_default();
            let own = sources.iter().map(|source| Delta { position: at(&positions, *source), normal: at(&normals, *source) });
            self.made.deltas.extend(own);
            if key.flat {
                flatten(vertices, &mut self.made.deltas[first + target * vertices.len()..]);
            }
        }
        let normals = self.made.deltas[first..].iter().any(|delta| delta.normal != [0.0; 3]);
        Ok(Some((first as u32, key.targets.len(), normals)))
    }
}

/// Weights as unsigned normalized 16-bit numbers that sum to 65535; `None` if all weights are 0.
fn shares(weights: &[f32]) -> Option<Vec<u16>> {
    let sum: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
    if sum <= 0.0 {
        return None;
    }
    let exact: Vec<f64> = weights.iter().map(|weight| f64::from(*weight) / sum * 65535.0).collect();
    let mut shares: Vec<u16> = exact.iter().map(|exact| *exact as u16).collect();
    // What rounding down left over goes to the largest remainders.
    let mut order: Vec<usize> = (0..weights.len()).collect();
    order.sort_by(|a, b| exact[*b].fract().total_cmp(&exact[*a].fract()));
    let missing = 65535 - shares.iter().map(|share| usize::from(*share)).sum::<usize>();
    order.iter().cycle().take(missing).for_each(|i| shares[*i] += 1);
    Some(shares)
}

/// Gives each triangle's corners the displacement of its flat normal. A triangle that a target flattens to nothing keeps its normal.
fn flatten(vertices: &[Vertex], deltas: &mut [Delta]) {
    for (corners, deltas) in vertices.as_chunks::<3>().0.iter().zip(deltas.as_chunks_mut::<3>().0) {
        let rest = corners.map(|vertex| Vec3::from(vertex.position).as_dvec3());
        let bent: [_; 3] = std::array::from_fn(|k| rest[k] + Vec3::from(deltas[k].position).as_dvec3());
        let [before, after] = [rest, bent].map(|[a, b, c]| (b - a).cross(c - a).try_normalize());
        let normal = before.zip(after).map_or(Vec3::ZERO, |(before, after)| (after - before).as_vec3());
        deltas.iter_mut().for_each(|delta| delta.normal = normal.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_weights_that_sum_to_one_exactly() {
        for weights in [vec![0.1, 0.2, 0.3, 0.4], vec![1.0, 1.0, 1.0, 0.0], vec![1e-9; 8], vec![3e38; 8], vec![0.5, 0.25, 0.125, 1e-7]] {
            let sum: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
            let shares = shares(&weights).unwrap();
            assert_eq!(shares.iter().map(|share| u32::from(*share)).sum::<u32>(), 65535, "{weights:?}");
            for (share, weight) in shares.iter().zip(&weights) {
                assert!((f64::from(*share) / 65535.0 - f64::from(*weight) / sum).abs() <= 1.0 / 65535.0, "{weights:?}: {shares:?}");
            }
        }
        assert_eq!(shares(&[0.0; 4]), None);
    }
}
